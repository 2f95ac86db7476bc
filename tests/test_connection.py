"""Connected or not: against the float engine's components, round the torus, through narrow gaps."""

import json
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from qbound import find_region, load_robot
from qbound.boundary.evaluator import evaluator
from qbound.cli import main
from qbound.proofs.connection import connection, outer_groups, separated, separating_cells
from qbound.proofs.exact import exact_problem, exact_robot
from qbound.proofs.paving import pave, start
from qbound.proofs.straight import along_straight_line
from qbound.proofs.verdict import Verdict
from qbound.region import solve
from support.exact import stated
from support.forms import RR
from support.robots import random_robot

PAPER = exact_problem(exact_robot("minervabot-v2"))
REGION = find_region(load_robot("minervabot-v2"))
CENTRES = [c.centroid for c in REGION.components]


def test_all_five_components_of_the_paper_robot_are_separated():
    paving = connection(PAPER, CENTRES[0], CENTRES[1]).paving
    groups = outer_groups(paving)
    held = [groups.containing(paving, q) for q in CENTRES]
    assert all(held)
    assert not any(one & other for one, other in combinations(held, 2))
    assert separated(paving, CENTRES[0], CENTRES[4])


def test_every_path_is_feasible_at_a_thousand_points_of_each_leg():
    found = connection(PAPER, [0, 0], [-2.2, -0.6])
    assert found.answer == "connected"
    assert np.allclose(found.path[0], [0, 0])
    assert np.allclose(found.path[-1], [-2.2, -0.6])
    s = np.linspace(0, 1, 1000)[:, None]
    for a, b in zip(found.path, found.path[1:], strict=False):
        assert (REGION.problem.forms(a + s * (b - a)) > 0).all()


@settings(max_examples=15)
@given(st.integers(0, 10**6))
def test_answers_never_contradict_the_float_engine(seed):
    robot = random_robot(seed)
    region, problem = find_region(robot), exact_problem(exact_robot(robot))
    rng = np.random.default_rng(seed)
    centres = [c.centroid for c in region.components if c.centroid is not None][:3]
    places = [*centres, rng.uniform(-1, 1, 2)]
    for one, other in combinations(places, 2):
        if not all(inside(problem, q) for q in (one, other)):
            continue
        answer = connection(problem, one, other, most=4000).answer
        same = component_of(region, one), component_of(region, other)
        if answer == "infeasible":
            assert None in same
        elif answer != "undecided" and None not in same:
            assert (answer == "connected") == (same[0] == same[1])


def inside(problem, q) -> bool:
    return all(
        r is None or r[0] < x < r[1] for x, r in zip(map(float, q), problem.ranges, strict=True)
    )


def component_of(region, q):
    """Which component holds a configuration: solve again with it as home."""
    home = solve(region.problem, q).home
    if home is None:
        return None
    areas = [abs(c.area - home.area) for c in region.components]
    return int(np.argmin(areas))


STRIP = {"00": 0.5, "10": -1}  # cos q1 < 1/2: forbids |q1| < 60 deg


def test_the_only_way_leads_round_the_joint():
    free = stated(RR, [STRIP])
    assert connection(free, [-1.5, 0], [1.5, 0]).answer == "connected"
    held = stated(RR, [STRIP], ((-3.1, 3.1), None))
    assert connection(held, [-1.5, 0], [1.5, 0]).answer == "separated"


def test_a_path_round_the_joint_is_unrolled():
    path = connection(stated(RR, [STRIP]), [-1.5, 0], [1.5, 0]).path
    assert np.abs(np.diff(path, axis=0)).max() < np.pi
    assert abs(abs(path[-1, 0] - path[0, 0]) - (2 * np.pi - 3)) < 1e-12


def test_regions_that_touch_in_a_point_are_undecided():
    saddle = stated(RR, [{"11": 1}])  # cos q1 cos q2 > 0
    assert connection(saddle, [0, 0], [3, 3], most=3000).answer == "undecided"


@pytest.mark.parametrize(("gap", "answer"), [(1e-3, "connected"), (-1e-3, "separated")])
def test_a_door_is_found_while_it_is_open_and_a_wall_when_it_is_shut(gap, answer):
    """cos q2 - cos q1 + gap > 0: at q1 = 0 only |q2| < sqrt(2 gap) is left."""
    door = stated(RR, [{"00": gap, "10": -1, "01": 1}], ((-3.1, 3.1), None))
    assert connection(door, [-1.5, 0], [1.5, 0]).answer == answer


def test_poses_outside_the_limits_are_refused():
    held = stated(RR, [STRIP], ((-3.1, 3.1), None))
    with pytest.raises(ValueError, match="limits"):
        connection(held, [-3.2, 0], [1.5, 0])


@pytest.mark.parametrize("pose", [[0.0, np.nan], [np.inf, 0.0], [0.0], [0.0, 0.0, 0.0]])
def test_what_is_no_configuration_is_refused(pose):
    with pytest.raises(ValueError, match="no configuration of 2 joints"):
        connection(PAPER, [0.0, 0.0], pose)


def test_an_angle_of_astronomical_size_is_never_decided_wrongly():
    assert connection(PAPER, [0.0, 0.0], [1e300, 0.0], most=500).answer == "undecided"
    turns = 2 * np.pi * 1000  # as a double: 1000 turns and a hair
    assert connection(PAPER, [0.0, 0.0], [turns, 0.0]).answer == "connected"


def test_the_wall_alone_separates_by_an_independent_flood_fill():
    found = connection(PAPER, CENTRES[0], CENTRES[1])
    n = 1024
    blocked = np.zeros((n, n), dtype=bool)
    for cells in separating_cells(found.paving, CENTRES[0]):
        low, high = (
            np.rint((p + np.pi) / (2 * np.pi) * n).astype(int)
            for p in found.paving.bounds.places(cells)
        )
        for (a, b), (c, d) in zip(low, high, strict=True):
            blocked[a:c, b:d] = True
    tiled, _ = label(~np.tile(blocked, (2, 2)))  # twice in each direction: the torus unrolled
    places = ((np.array(CENTRES[:2]) + np.pi) / (2 * np.pi) * n).astype(int)
    assert not blocked[tuple(places[0])]
    homes = {tiled[x + i, y + j] for x, y in places[:1] for i in (0, n) for j in (0, n)}
    others = {tiled[x + i, y + j] for x, y in places[1:] for i in (0, n) for j in (0, n)}
    assert not homes & others


def test_groups_close_round_the_torus():
    paving = pave(stated(RR, [STRIP]), 0.02)
    (labels,) = {frozenset(np.concatenate(outer_groups(paving).label).tolist())}
    assert len(labels) == 1


@pytest.mark.parametrize(
    ("values", "status", "word"),
    [
        (["0", "0", "20", "30"], 0, "connected"),
        (["0deg", "0deg", "92deg", "226.65deg"], 1, "separated"),
        (["0", "0", "0", "180"], 1, "infeasible"),
        (["0", "0", "0"], 2, "two poses of 2 joints"),
        (["0", "0", "0", "nan"], 2, "no value"),
    ],
)
def test_the_command_says_it_and_its_status_too(values, status, word, capsys):
    assert main(["connected", "minervabot-v2", *values]) == status
    said = capsys.readouterr()
    assert word in said.out + said.err


def test_the_command_writes_its_evidence(capsys):
    main(["connected", "minervabot-v2", "0", "0", "92", "226.65", "--json", "-"])
    content = json.loads(capsys.readouterr().out)
    assert content["answer"] == "separated"
    assert len(content["wall"]) > 100
    forms = REGION.problem.forms
    for box in content["wall"][::50]:
        assert (forms([box["from"], box["to"]]) < 0).any(axis=-1).all()


# --- the straight line ----------------------------------------------------------------------------


def test_a_straight_line_is_proved_where_and_only_where_it_is_safe():
    rng = np.random.default_rng(622)
    paving, found = start(PAPER), []
    for one, other in rng.uniform(-3, 3, (120, 2, 2)):
        proof = along_straight_line(paving, one, other)
        values = REGION.problem.forms(one + np.linspace(0, 1, 3000)[:, None] * (other - one))
        least = values.min()
        assert proof is None or least > 0
        assert proof is not None or least < 1
        found.append(proof is not None)
        if proof is not None:  # each place of it lies in a feasible cell
            for s in np.linspace(0, 1, 7):
                assert Verdict.PROVED in proof.verdicts(one + s * (other - one))
    assert 5 < sum(found) < 60
    assert connection(PAPER, [0.0, 0.0], [0.1, -0.4], line=True).path.tolist() == [
        [0.0, 0.0],
        [0.1, -0.4],
    ]


def test_a_straight_line_goes_round_the_joint_and_stays_within_its_limits():
    free = stated(RR, [STRIP])
    there = connection(free, [-2.5, 0.2], [2.5, 3.0], line=True)
    assert there.path.shape == (2, 2)
    assert np.allclose(there.path[1], [2.5 - 2 * np.pi, 3.0])
    assert connection(free, [2.5 + 8 * np.pi, 0.2], [-2.5, 3.0], line=True).path.shape == (2, 2)
    held = stated(RR, [STRIP], ((-3.1, 3.1), None))
    assert connection(held, [-2.5, 0.2], [-2.0, 3.0], line=True).path.shape == (2, 2)
    assert along_straight_line(start(held), np.array([-1.2, 0]), np.array([1.2, 0])) is None
    same = connection(free, [2.0, 0.0], [2.0, 0.0], line=True)
    assert (same.answer, len(same.path)) == ("connected", 2)


def test_an_angle_that_rounds_turns_off_has_no_straight_line():
    for huge in (1e300, -1e12):
        assert connection(PAPER, [0.0, 0.0], [huge, 0.0], most=500, line=True).answer == "undecided"


def test_a_straight_line_along_the_border_is_not_claimed():
    saddle = stated(RR, [{"11": 1}])  # cos q1 cos q2 > 0: 0 where q1 is a quarter turn
    edge = np.pi / 2
    for one, other in ([[edge, -1], [edge, 1]], [[0, 0], [edge, 0]], [[-1, -2], [-1, 2]]):
        assert along_straight_line(start(saddle), np.array(one), np.array(other)) is None
    inner = along_straight_line(start(saddle), np.array([edge - 1e-3, -1]), np.array([0, 0]))
    assert inner is not None
    assert not len(inner.undecided)


def test_a_straight_line_between_bodies_keeps_them_apart():
    robot = load_robot("two-links-on-a-table")
    problem, compiled = exact_problem(exact_robot("two-links-on-a-table")), evaluator(robot)
    low, high = np.array([[float(x) for x in r] if r else [-3, 3] for r in problem.ranges]).T
    rng, found = np.random.default_rng(623), 0
    for one, other in rng.uniform(low, high, (25, 2, 2)):
        way = one + np.linspace(0, 1, 500)[:, None] * (other - one)
        proof = along_straight_line(start(problem), one, other)
        assert proof is None or compiled.feasible(way).all()
        found += proof is not None
    assert found > 1
