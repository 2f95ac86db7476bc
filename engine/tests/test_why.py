"""Why a plan fails: a path that a judge of its own follows, or what separates both ends."""

import json
import math
import tomllib
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from cspace import check, find_region, load_robot
from cspace.arms import why as module
from cspace.arms.links import SPHERES_ONLY, unchecked_lines
from cspace.arms.search import find_path
from cspace.arms.why import relaxed, why, why_document, why_lines
from cspace.boundary.balls import judge
from cspace.cli import main
from cspace.figures.why import why_picture
from cspace.model.robotfile import as_written, parse_robot
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.certify import certify
from cspace.proofs.subpaving.connection import connection
from cspace.region import violated
from engine_support import brute_force, second_checker
from engine_support.arms import joint, robot_table
from engine_support.commands import follows_schema
from engine_support.elbow import arm
from engine_support.gate import HANDS, HOOK, UPPER, gate
from engine_support.planar import caged

BODIES = "two-links-on-a-table"
START, GOAL = [0.0, 1.0, 0.0], [0.3, 4.0, 0.0]


def saved(folder, text):
    path = folder / "arm.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def file(tmp_path):
    return saved(tmp_path, arm())


def valid(found):
    document = why_document(found)
    follows_schema(document, "why")
    return document


def is_kept(text, path):
    """Follow a path densely, by an evaluator that shares no code."""
    table = tomllib.loads(text)
    q = np.concatenate([np.linspace(a, b, 500) for a, b in pairwise(path)])
    q[:, [j["type"] == "revolute" for j in table["joint"]]] *= 180 / math.pi
    return min(m.min() for m in brute_force.margins(table, {"margin": "0"}, q).values())


# --- answers --------------------------------------------------------------------------------------


def test_an_elbow_that_cannot_pass_is_named_with_its_links_and_its_range(file):
    found = why(file, START, GOAL)
    assert found.answer == "separated"
    assert found.separation.travel.name == "elbow"
    (said, ranges, again, spheres, unchecked) = why_lines(found)
    assert spheres == SPHERES_ONLY
    assert valid(found)["spheres_only"]
    assert unchecked.startswith("not checked, because no boundary keeps them apart: ")
    assert "156.93 to 203.07 deg, where upper arm and forearm meet" in said
    assert "3 ranges: -360 to -203.07 deg, -156.93 to 156.93 deg (start)" in ranges
    assert "-130.817 deg" in again  # the goal a turn back
    assert not check.check(found.certificate.text).refuted
    assert valid(found)["separation"]["blocked"][0]["links"] == ["upper arm, forearm"]


def test_a_straight_line_that_is_free_is_the_path(file):
    found = why(file, START, [2.0, -1.0, 1.0])
    assert found.answer == "connected"
    assert np.allclose(found.path, [START, [2.0, -1.0, 1.0]])
    assert 0 < float(found.margin) <= found.least
    assert is_kept(arm(), found.path) > 0
    assert second_checker.verify(found.certificate.text) == "proved"
    assert valid(found)["path"]["proved_margin"] == float(found.margin)


ROUND = {
    "points": '{ name = "post/1", frame = "base", at = [1.5, 0, 0.5], radius = 0.45 }',
    "boundaries": '{ name = "post", type = "pair", points = ["post/1", "tool/1"] }',
}
"""A ball in the way of the stretched arm as its shoulder turns: one has to fold the elbow."""


def test_a_path_round_something_is_found_and_proved(tmp_path):
    text = arm(**ROUND)
    file = saved(tmp_path, text)
    found = why(file, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    assert found.answer == "connected"
    assert len(found.path) > 2
    assert is_kept(text, found.path) > 0
    assert check.check(found.certificate.text).refuted is False
    lines = list(why_lines(found))
    assert len(lines) == 1 + len(found.path) + len(list(unchecked_lines(found.robot)))


def test_held_joints_separate_what_others_do_not(tmp_path):
    """With elbow and wrist held straight the shoulder meets the post; it cannot go round either."""
    text = arm(**ROUND).replace("limits = [-360, 360]", "limits = [-120, 120]", 1)
    file = saved(tmp_path, text)
    found = why(file, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], hold=True)
    assert found.answer == "separated"
    assert found.separation is None
    claim = json.loads(found.certificate.text)["claim"]
    assert claim["joints"] == ["moves", "held", "held"]
    assert second_checker.verify(found.certificate.text) == "proved"
    said, *more = why_lines(found)
    assert more == [SPHERES_ONLY, *unchecked_lines(found.robot)]
    assert "while elbow, wrist are held" in said
    assert valid(found)["held"] == ["elbow", "wrist"]
    assert why(file, [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]).answer == "connected"


def test_a_component_of_two_joints_that_no_joint_parts_is_separated_by_a_paving():
    """The five components of the paper's robot: joints part four, the floor the fifth."""
    centres = [c.centroid for c in find_region(load_robot("minervabot-v2")).components]
    pairs = [*((centres[0], centre) for centre in centres[1:]), centres[3:]]
    found = [why("minervabot-v2", *pair) for pair in pairs]
    assert {each.answer for each in found} == {"separated"}
    assert [each.separation is None for each in found] == [False] * 4 + [True]
    for each in found:
        valid(each)
        assert not check.check(each.certificate.text).refuted


def test_an_end_that_is_infeasible_comes_first_with_the_pair_and_the_depth(file):
    found = why(file, [0, math.pi, 0], [0, 0, 4.0])
    assert found.answer == "infeasible"
    assert [row[:2] for row in found.violated] == [(1, "wrist.upper"), (0, "folded")]
    first, second, *more = why_lines(found)
    assert more == [*unchecked_lines(found.robot)]  # a limit needs no sphere
    assert "the start violates upper arm, forearm, by 0.2 m (boundary folded)" in first
    assert "the goal violates wrist.upper, by 49.1831 deg" in second
    assert check.check(found.certificate.text).refuted
    assert valid(found)["answer"] == "infeasible"


def test_of_bodies_a_paving_decides_what_no_search_finds(monkeypatch):
    robot = load_robot(BODIES)
    goal = robot.home + 0.05
    found = why(BODIES, robot.home, goal)
    assert found.answer == "connected"
    assert second_checker.verify(found.certificate.text) == "proved"
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: None)
    monkeypatch.setattr(module, "_surely_in", lambda *args: None)
    again = why(BODIES, robot.home, goal)
    assert again.answer == "connected"
    assert second_checker.verify(again.certificate.text) == "proved"
    apart = why(BODIES, *APART)
    assert apart.answer == "separated"
    assert apart.held.paving.cells > 1000
    assert second_checker.verify(apart.certificate.text) == "proved"


APART = [1.74532925, -1.04719755], [-1.2584, -0.4858]
"""Of the two links on a table: in different components."""


def test_of_bodies_the_region_decides_where_no_paving_does(monkeypatch):
    monkeypatch.setattr(module, "connection", undecided_paving)
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: None)
    apart = why(BODIES, *APART)
    assert (apart.answer, apart.held, apart.certificate) == ("separated", None, None)
    assert next(why_lines(apart)).endswith("start and goal lie in components 0 and 1 of it")
    valid(apart)
    home = load_robot(BODIES).home
    joined = why(BODIES, home, home + 0.05)
    assert (joined.answer, joined.path, joined.held) == ("connected", None, None)
    assert "start and goal lie in component 0 of it" in next(why_lines(joined))


WALLS = ["two-joint-arm-with-walls", "20deg", "60deg", "-134.26deg", "-130.08deg"]
TABLE = [BODIES, "1.74532925rad", "-1.04719755rad", "-1.2584rad", "-0.4858rad"]


@pytest.mark.parametrize(("words", "status"), [(WALLS, 3), (TABLE, 1)])
def test_both_names_of_the_command_give_one_answer(words, status, capsys, monkeypatch):
    given = partial(module.connection, most=4_000)  # of the first no number of cells decides
    monkeypatch.setattr(module, "connection", lambda *args: given(*args[:3]))
    documents = []
    for name in ("why", "connected"):
        assert main([name, *words, "--json", "-"]) == status
        documents.append(json.loads(capsys.readouterr().out))
    assert documents[0] == documents[1]
    assert documents[0]["schema"] == "qbound/why/1"


@pytest.mark.parametrize("hand", HANDS)
@pytest.mark.parametrize(
    ("top", "answer"),
    [
        ("2.300000001", "connected"),
        ("2.300000000001", "connected"),
        ("2.3", "undecided"),
        ("2.2999999999", "separated"),
        ("2.299999999", "separated"),
    ],
)
def test_a_billionth_decides_whether_a_gate_is_passed(tmp_path, monkeypatch, hand, top, answer):
    """At 2.3 the body touches both walls while it passes, which is feasible: a way of no width."""
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: None)
    monkeypatch.setattr(module, "connection", undecided_paving)
    file = saved(tmp_path, gate(hand, UPPER.format(top)))
    found = why(file, [1.0, 1.0], [3.0, 1.0])
    assert found.answer == answer
    if answer == "undecided":
        assert "in components 0 and 1 of it, which touch, or nearly do" in " ".join(found.tried)
    else:
        places = "component 0" if answer == "connected" else "components 0 and 1"
        said = "the components of the region are decided exactly, and start and goal lie in"
        assert found.tried[-1] == f"{said} {places} of it"


def test_of_polygons_with_dents_it_is_not_said_that_they_part(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "connection", undecided_paving)
    file = tmp_path / "gate.toml"
    text = gate("arrow", HOOK.format("2.2"))
    file.write_text(text, encoding="utf-8")
    found = why(file, [1.0, 1.0], [3.0, 1.0])
    assert found.answer == "undecided"
    assert "two polygons are to keep no distance" in " ".join(found.tried)
    file.write_text(text.replace("schema = 1", "schema = 1\nclearance = 0.01"), encoding="utf-8")
    assert why(file, [1.0, 1.0], [3.0, 1.0]).answer == "separated"


def test_an_end_beside_two_components_lies_in_none_of_them_for_sure(tmp_path, monkeypatch):
    """Two tips touch the disc in the gate, 0.3 micrometres from the start; then 0.5 mm."""
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: None)
    monkeypatch.setattr(module, "connection", undecided_paving)
    file = tmp_path / "gate.toml"
    text = gate("disc", "[2, 2.3], [2.1, 5], [1.9, 5]")
    low = "[2, 1.3], [1.9, -1], [2.1, -1]"
    file.write_text(text.replace("[1.9, -1], [2.1, -1], [2.1, 1.3], [1.9, 1.3]", low))
    for x, reason in ((2 - 3e-7, "an end lies beside"), (2 - 5e-4, "which touch, or nearly do")):
        found = why(file, [x, 1.8], [3.0, 1.0])
        assert found.answer == "undecided"
        assert reason in " ".join(found.tried)


def test_an_unresolved_region_says_nothing(monkeypatch):
    region = module.find_region(load_robot(BODIES))
    unresolved = replace(region, outlined=(), unresolved=("this is not decided",))
    monkeypatch.setattr(module, "find_region", lambda *args: unresolved)
    monkeypatch.setattr(module, "connection", undecided_paving)
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: None)
    found = why(BODIES, *APART)
    assert found.answer == "undecided"
    assert "the region is not decided (this is not decided)" in found.tried


@pytest.mark.parametrize("name", [BODIES, "minervabot-v2", "two-joint-arm-with-walls", "pp-portal"])
def test_whatever_touches_a_boundary_is_free_where_boundaries_are_relaxed(name):
    robot = load_robot(name)
    region, wider = find_region(robot), relaxed(robot)
    assert wider is not None
    arcs = [arc for c in region.components for loop in c.loops for arc in loop if arc.row >= 0]
    places = np.concatenate([arc.points for arc in arcs])
    bounds = len(wider.used)
    assert judge(wider).margins(places)[:, :bounds].min() > 0


def undecided_paving(problem, one, other, most=0):
    return connection(problem, one, other, most=10)


def test_a_region_joins_where_no_path_is_found(monkeypatch):
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: None)
    found = why("minervabot-v2", [0.0, 0.0], [0.2, -0.5])
    assert (found.answer, found.path) == ("connected", None)
    said, *_ = why_lines(found)
    assert said.endswith("start and goal lie in component 0 of it; no path was found")
    valid(found)
    assert why_picture(found).startswith(b"<?xml")


def test_what_nothing_decides_is_not_decided(file, monkeypatch):
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: None)
    monkeypatch.setattr(module, "MOST_PAVED", 1)
    found = why(file, START, [2.0, -1.0, 1.0])
    assert found.answer == "undecided"
    lines = list(why_lines(found))
    assert lines[0].startswith("not decided")
    assert any("a paving takes 1 joints; the ends differ in 3" in line for line in lines)
    valid(found)


def test_a_path_that_cannot_be_proved_is_no_answer(file, monkeypatch):
    through = np.array([START, [0.2, math.pi, 0], [0.2, 1.2, 0]])
    monkeypatch.setattr(module, "find_path", lambda *args, **kwargs: through)
    monkeypatch.setattr(module, "MOST_PAVED", 0)
    found = why(file, START, [0.2, 1.2, 0])
    assert (found.answer, found.path, found.unproved) == ("undecided", None, None)


@pytest.mark.parametrize(("n", "most"), [(7, 0), (8, 2000)])
def test_a_path_that_no_certificate_can_hold_is_shown_as_not_proved(
    tmp_path, monkeypatch, capsys, n, most
):
    """An arm of 5,472 pairs got no path at all, although a straight line was free."""
    path = saved(tmp_path, folding(n))
    monkeypatch.setattr(check, "MAX_BOUNDARIES", most)
    found = why(path, np.full(n, 0.2), np.full(n, 0.3))
    assert (found.answer, found.path, found.certificate) == ("undecided", None, None)
    assert np.array_equal(found.unproved, [np.full(n, 0.2), np.full(n, 0.3)])
    assert valid(found)["unproved_path"] == found.unproved.tolist()
    said = "\n".join(why_lines(found))
    assert "a path that is not proved: nothing is violated at the places that were looked" in said
    assert (TOO_MANY if n == 8 else "certificates take at most") in said
    assert main(["why", str(path), *["12deg"] * n, *["17deg"] * n]) == 3
    said = " ".join(capsys.readouterr().out.split())
    assert ("cspace import makes fewer of them by a larger --excess" in said) == (most == 0)


# --- margins and tables ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("bend", "goal", "margin", "answer", "said"),
    [
        (0.2, 120, "0", "connected", "every boundary keeps 0.08 m on it, proved"),
        (0.2, 120, "0.09", "connected", "every boundary keeps 0.09 m on it, proved"),
        (0.2, 120, "0.15", "infeasible", "infeasible with 0.15 m to spare: the goal violates"),
        (0.2, 270, "0.2", "separated", "separated with 0.2 m to spare: q2 cannot get from 90 deg"),
        (0, 270, "0.1", "separated", "separated with 0.1 m to spare: q2 cannot get from 90 deg"),
    ],
)
@pytest.mark.filterwarnings("ignore:.*never a wall")
def test_a_margin_is_asked_of_the_whole_path(tmp_path, bend, goal, margin, answer, said):
    """The two balls are cos(q2 / 2) apart, less both radii; radii 0 forbid nothing."""
    path = saved(tmp_path, folding(7).replace("radius = 0.2", f"radius = {bend}"))
    start = np.radians([10, 90, 20, 20, 20, 20, 20])
    end = np.radians([10, goal, 20, 20, 20, 20, 20])
    found = why(path, start, end, margin=margin)
    assert found.answer == answer
    assert said in next(why_lines(found))
    assert valid(found).get("asked_margin", 0) == float(margin)
    if answer == "connected":
        assert json.loads(found.certificate.text)["claim"]["margin"] == found.margin
        assert float(found.margin) >= float(margin)
    elif margin != "0":
        assert found.certificate is None
        assert "only of a path" in found.no_certificate


@pytest.mark.parametrize("margin", ["-1", "1e", "nan", "", "1e300", "1e-400"])
def test_a_margin_that_is_no_length_is_refused(file, margin):
    with pytest.raises(ValueError, match="margin"):
        why(file, START, [0, 1.2, 0], margin=margin)


def test_the_command_writes_the_proved_path_as_a_table_that_certify_reads(tmp_path, capsys):
    path, table = saved(tmp_path, arm(**ROUND)), tmp_path / "path.csv"
    ends = ["-1rad", "0", "0", "1rad", "0", "0"]
    assert main(["why", str(path), *ends, "--csv", str(table), "--margin", "1mm"]) == 0
    assert f"written: {table}" in capsys.readouterr().out
    head, *rows = table.read_text().splitlines()
    assert head == "shoulder_rad,elbow_rad,wrist_rad,x_m,y_m,z_m"
    assert len(rows) > 2
    words = ["certify", str(path), "--path", str(table), "--margin", "1mm"]
    assert main(words) == 0


def test_a_table_is_not_written_of_a_path_that_there_is_not(file, tmp_path, capsys):
    table = tmp_path / "path.csv"
    values = ["0", "1rad", "0", "0", "4rad", "0"]
    assert main(["why", str(file), *values, "--csv", str(table)]) == 1
    assert f"{table}: not written: no path is proved" in capsys.readouterr().out
    assert not table.exists()
    assert main(["why", str(file), *values, "--margin=-1mm"]) == 2
    assert "--margin -1mm: a length of 0 or more is wanted" in capsys.readouterr().err


WIDE = """schema = 1
name = "wide"
length_unit = "m"
angle_unit = "deg"
home = { q1 = 0 }
tool = "t"
joint = [{ name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 0, 1], limits = [-3000, 1000] }]
point = [{ name = "t", frame = "1", at = [1, 0, 0] }, { name = "p", frame = "0", at = [0, 1, 0], radius = 0.3 }]
boundary = [{ name = "B", type = "pair", points = ["t", "p"] }]
"""  # noqa: E501


@pytest.mark.parametrize("goal", [-2480, -2000])
@pytest.mark.filterwarnings("ignore:.*turns wide")
def test_ends_beyond_five_turns_have_an_answer_without_a_certificate(tmp_path, capsys, goal):
    """They were refused in words of a certificate that nobody had written."""
    path = saved(tmp_path, WIDE)
    far = "certificates take angles of at most 1800 deg; q1 is at -2500"
    found = why(path, np.radians([-2500]), np.radians([goal]))
    assert found.answer == ("connected" if goal == -2480 else "separated")
    assert found.certificate is None
    assert found.no_certificate.startswith(far)
    assert main(["certify", str(path), f"--box=q1=-2500deg..{goal}deg"]) == 2
    assert far in capsys.readouterr().err


# --- the search -----------------------------------------------------------------------------------


def test_a_joint_without_limits_goes_the_short_way_round():
    robot = parse_robot(tomllib.loads(arm("")))
    path = find_path(robot, [0, 2.5, 0], [0, 2.5 - math.tau, 0])
    assert path.tolist() == [[0, 2.5, 0], [0, 2.5, 0]]


BLOCKS = """
schema = 1
name = "two blocks on crossed rods, B seen from A"
length_unit = "m"
angle_unit = "deg"
home = { x = 5, y = 5 }
tool = "middle"
collisions = "all"
joint = [
  { name = "x", type = "prismatic", parent = "A", frame = "rod", origin = [0, 0, 0], axis = [-1, 0, 0], limits = [-10, 10] },
  { name = "y", type = "prismatic", parent = "rod", frame = "B", origin = [0, 0, 0], axis = [0, 1, 0], limits = [-10, 10] },
]
point = [{ name = "middle", frame = "B", at = [0, 0, 0] }]
body = [{ frame = "B", name = "block B", polygon = [[-1, -1], [1, -1], [1, 1], [-1, 1]] }]
obstacle = [{ name = "block A", polygon = [[-1, -1], [1, -1], [1, 1], [-1, 1]] }]
"""  # noqa: E501

RODS = """
schema = 1
name = "two links among thin rods"
length_unit = "mm"
angle_unit = "deg"
home = { a = 45, b = 0 }
tool = "tip"
collisions = "all"
allowed = [["l1", "l2"]]
joint = [
  { name = "a", type = "revolute", parent = "table", frame = "l1", origin = [0, 0, 0], axis = [0, 0, 1] },
  { name = "b", type = "revolute", parent = "l1", frame = "l2", origin = [500, 0, 0], axis = [0, 0, 1] },
]
point = [{ name = "tip", frame = "l2", at = [400, 0, 0] }]
body = [
  { frame = "l1", capsule = { from = [0, 0], to = [500, 0], radius = 1 } },
  { frame = "l2", capsule = { from = [0, 0], to = [400, 0], radius = 1 } },
]
obstacle = [
  { name = "rod 1", disc = { at = [620, 0], radius = 2 } },
  { name = "rod 2", disc = { at = [0, 620], radius = 2 } },
  { name = "rod 3", disc = { at = [-620, 0], radius = 2 } },
  { name = "rod 4", disc = { at = [0, -620], radius = 2 } },
]
"""  # noqa: E501


THIN = {
    "the corner of a block on slides": (BLOCKS, [5, 0], [-5, 0]),
    "rods among links that turn": (RODS, [math.pi / 4, 0], [5 * math.pi / 4, 0]),
}
"""Each thinner than what the search looks at first: 0.02 rad, or 2 % of a slide."""


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("case", THIN)
def test_a_path_keeps_off_what_is_thin_and_is_proved(tmp_path, case, seed):
    text, *ends = THIN[case]
    file = saved(tmp_path, text)
    found = why(file, *ends, seed=seed)
    assert (found.answer, found.unproved) == ("connected", None)
    assert len(found.path) > 2
    assert second_checker.verify(found.certificate.text) == "proved"


def test_a_path_that_a_proof_refutes_is_forbidden_and_the_search_goes_on(tmp_path, monkeypatch):
    text = arm(**ROUND)
    file = saved(tmp_path, text)
    ends = [-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]
    told = []

    def careless(robot, start, goal, seed, *, refuted, **given):
        told.append([*refuted])
        return find_path(robot, start, goal, seed, refuted=refuted) if refuted else np.array(ends)

    monkeypatch.setattr(module, "find_path", careless)
    found = why(file, *ends)
    assert found.answer == "connected"
    assert is_kept(text, found.path) > 0
    assert [len(each) for each in told] == [0, 1]
    assert violated(load_robot(file), told[1][0])


def test_no_leg_passes_near_what_is_refuted_and_both_ends_stay_free():
    robot = parse_robot(tomllib.loads(arm("")))
    ends = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]
    assert len(find_path(robot, *ends)) == 2
    middle, beside = np.array([0.5, 0.0, 0.0]), np.array([1e-4, 0.0, 0.0])
    path = find_path(robot, *ends, refuted=[middle, beside])
    assert np.array_equal(path[[0, -1]], ends)
    dense = np.concatenate([np.linspace(a, b, 2000) for a, b in pairwise(path)])
    assert np.linalg.norm(dense - middle, axis=1).min() > 0.01
    assert np.linalg.norm(dense - beside, axis=1).min() > 0.4e-4


def test_a_path_that_is_found_but_not_proved_is_told_as_that(tmp_path, monkeypatch):
    """Both ends touch the block, so no proof with cells covers the first and the last leg."""
    monkeypatch.setattr(module, "connection", undecided_paving)
    monkeypatch.setattr(module, "certify", partial(certify, most=300))
    file = saved(tmp_path, BLOCKS)
    assert why(file, [0, 2], [0, -2]).answer == "connected"  # by the region
    monkeypatch.setattr(module, "_surely_in", lambda *args: None)
    found = why(file, [0, 2], [0, -2])
    assert (found.answer, found.path, found.certificate) == ("undecided", None, None)
    assert np.array_equal(found.unproved[[0, -1]], [[0, 2], [0, -2]])
    assert is_kept_by_blocks(found.unproved)
    assert valid(found)["unproved_path"] == found.unproved.tolist()
    said = list(why_lines(found))
    k = next(k for k, line in enumerate(said) if line.startswith("a path that is not proved"))
    assert said[k + 1] == "  x = 0 m, y = 2 m"


def is_kept_by_blocks(path):
    places = np.concatenate([np.linspace(a, b, 5000) for a, b in pairwise(path)])
    return (np.abs(places).max(axis=1) >= 2 - 1e-9).all()


def test_a_search_that_cannot_succeed_ends(file):
    robot = parse_robot(tomllib.loads(arm()))
    assert find_path(robot, START, GOAL, tries=60) is None


# --- picture and command --------------------------------------------------------------------------


@pytest.mark.parametrize("goal", [GOAL, [2.0, -1.0, 1.0], [0.0, 3.1, 0.0]])
def test_there_is_a_picture_of_every_answer_and_always_the_same(file, goal):
    found = why(file, START, goal)
    picture = why_picture(found)
    assert picture.startswith(b"<?xml")
    assert picture == why_picture(found)


ARGUMENTS = [
    (["1rad", "0", "0", "4rad"], 1, "elbow cannot get"),
    (["1rad", "0", "0", "-1rad"], 0, "connected: a straight line"),
    (["1rad", "0", "0", "180"], 1, "infeasible: the goal"),
    (["1rad", "0", "0"], 2, "5 values; two configurations have 6"),
    (["1rad", "0", "0", "nan"], 2, "no value"),
]


@pytest.mark.parametrize(("values", "status", "said"), ARGUMENTS)
def test_the_command_says_it_and_its_status_too(file, capsys, values, status, said):
    assert main(["why", str(file), "0", *values, "0"]) == status
    found = capsys.readouterr()
    assert said in found.out + found.err


def test_both_ends_are_said_with_their_units_and_a_length_has_a_number_for_each(capsys):
    """Plain numbers are in the file's units, which need not be those that were meant."""
    assert main(["why", "rp-telescopic-boom", "-1rad", "1.5", "-50", "170cm"]) == 0
    said, start, goal, *_ = capsys.readouterr().out.splitlines()
    assert "0.127 rad and 0.2 m long" in said
    assert start == "  from lift = -57.2958 deg, slide = 1.5 m"
    assert goal == "  to lift = -50 deg, slide = 1.7 m"


def test_the_command_writes_certificate_document_and_picture(file, tmp_path, capsys):
    files = [tmp_path / name for name in ("c.json", "w.json", "w.svg")]
    values = ["0", "1rad", "0", "0", "4rad", "0"]
    named = zip(("-o", "--json", "--svg"), map(str, files), strict=True)
    options = [word for pair in named for word in pair]
    assert main(["why", str(file), *values, *options]) == 1
    capsys.readouterr()
    assert main(["check", str(files[0]), str(file)]) == 0
    assert second_checker.verify(files[0].read_text()) == "proved"
    assert json.loads(files[1].read_text())["answer"] == "separated"
    assert files[2].read_bytes().startswith(b"<?xml")


def test_the_command_certifies_what_a_paving_separates(tmp_path, capsys):
    file, proof = saved(tmp_path, caged()), tmp_path / "c.json"
    values = ["0", "110", "20", "9", "-110", "20"]
    assert main(["why", str(file), *values, "--hold", "-o", str(proof)]) == 1
    assert "separated, while wrist is held" in capsys.readouterr().out
    assert main(["check", str(proof), str(file)]) == 0
    assert second_checker.verify(proof.read_text()) == "proved"
    assert json.loads(proof.read_text())["claim"]["joints"] == ["moves", "moves", "held"]


def test_the_command_refuses_what_it_cannot_write(file, tmp_path, capsys):
    values = ["0", "1rad", "0", "0", "4rad", "0"]
    assert main(["why", str(file), *values, "--svg", str(tmp_path / "picture.jpeg")]) == 2
    assert main(["why", str(file), *values, "--seed=-1"]) == 2
    assert main(["why", str(file), *values, "--json", str(tmp_path / "no" / "w.json")]) == 2
    assert not list(tmp_path.glob("*.jpeg"))
    capsys.readouterr()


# --- seven joints, and more than certificates take ------------------------------------------------


def folding(joints):
    """Write an arm of whose links two meet where the second joint is at 180 degrees."""
    rows = [
        joint("revolute", str(j - 1), str(j), [min(j - 1, 1), 0, 0], [0, 0, 1], limits=[0, 350])
        for j in range(1, joints + 1)
    ]
    ball = {"at": [0.5, 0, 0], "radius": 0.2}
    points = [{"name": "upper arm", "frame": "1"} | ball, {"name": "forearm", "frame": "2"} | ball]
    points.append({"name": "t", "frame": str(joints), "at": [1, 0, 0]})
    elbow = {"name": "elbow", "type": "pair", "points": ["upper arm", "forearm"]}
    home = {f"q{j}": 90 * (j == 2) for j in range(1, joints + 1)}
    more = {"point": points, "boundary": [elbow], "angle_unit": "deg"}
    return as_written(parse_robot(robot_table(rows, home, str(joints), **more))).source.text


TOO_MANY = "certificates take at most 7 joints; this robot has 8"
ENDS = {
    "separated": (["10deg", "90deg"], ["10deg", "270deg"], 1),
    "infeasible": (["10deg", "90deg"], ["10deg", "180deg"], 1),
    "connected": (["10deg", "90deg"], ["60deg", "120deg"], 0),
}


@pytest.mark.parametrize("joints", [7, 8])
@pytest.mark.parametrize("answer", ENDS)
def test_seven_joints_have_a_certificate_and_eight_an_answer_without(
    tmp_path, capsys, joints, answer
):
    path, proof = saved(tmp_path, folding(joints)), tmp_path / "proof.json"
    wide = ["20deg"] * (joints - 2)
    start, goal, status = ENDS[answer]
    assert main(["why", str(path), *start, *wide, *goal, *wide, "-o", str(proof)]) == status
    said = " ".join(capsys.readouterr().out.split())
    ends = [[float(v.removesuffix("deg")) for v in [*end, *wide]] for end in (start, goal)]
    found = why(path, *np.radians(ends))
    valid(found)
    assert found.answer == answer
    if joints == 7:
        expected = "refuted" if answer == "infeasible" else "proved"
        assert second_checker.verify(proof.read_text()) == found.certificate.verdict == expected
    else:
        assert f"no certificate: {TOO_MANY}" in said
        assert "not written: of this answer there is no certificate" in said
        assert not proof.exists()
        assert (found.certificate, found.no_certificate) == (None, TOO_MANY)
    if answer == "connected":
        assert is_kept(folding(joints), found.path) > 0


def test_certify_tells_the_limit_of_joints_before_the_work(tmp_path, capsys, monkeypatch):
    path = saved(tmp_path, folding(8))
    monkeypatch.setattr("cspace.cli.certify.statement", lambda *_: pytest.fail("it began to work"))
    box = ["q1=1deg:2deg", *(f"q{j}=20deg:21deg" for j in range(2, 9))]
    assert main(["certify", str(path), "--box", *box]) == 2
    assert TOO_MANY in capsys.readouterr().err
    with pytest.raises(ValueError, match="at most 7 joints"):
        certify(folding(8), statements.box(["1"] * 8, ["2"] * 8))


# --- arms that only their limits bound ------------------------------------------------------------


def limited(*kinds: str) -> str:
    """Write an arm without a boundary: a pen arm, a cart with a pole."""
    rows = [
        joint(kind, str(k), str(k + 1), [0.5, 0, 0], [0, k % 2, 1], limits=[-1, 2])
        for k, kind in enumerate(kinds)
    ]
    home, last = {row["name"]: 0 for row in rows}, str(len(kinds))
    pen = {"name": "t", "frame": last, "at": [0.5, 0, 0]}
    table = robot_table(rows, home, last, point=[pen], boundary=[])
    return as_written(parse_robot(table)).source.text


@pytest.mark.parametrize(
    "kinds", [["revolute"], ["prismatic", "revolute"], ["revolute"] * 2, ["revolute"] * 4]
)
@pytest.mark.parametrize("hold", [False, True])
def test_an_arm_with_limits_only_gets_an_answer(tmp_path, capsys, kinds, hold) -> None:
    """It ended with "claim.margin: 'inf' is no decimal number"."""
    file, n = saved(tmp_path, limited(*kinds)), len(kinds)
    found = why(file, [-0.5] * n, [1.5] * n, hold=hold)
    assert (found.answer, found.margin, found.least) == ("connected", "0", math.inf)
    assert second_checker.verify(found.certificate.text) == "proved"
    assert valid(found)["path"]["least_margin_seen"] is None
    words = [f"{x}rad" if k == "revolute" else f"{x}m" for x in (-0.5, 1.5) for k in kinds]
    assert main(["why", str(file), *words, "--svg", str(tmp_path / "path.svg")]) == 0
    assert "there is no boundary" in capsys.readouterr().out
    assert why(file, [-0.5] * n, [2.5] * n).answer == "infeasible"
