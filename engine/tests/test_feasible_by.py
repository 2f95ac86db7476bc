"""What "feasible" looks at is said: by points, spheres or bodies, and what no boundary checks."""

from __future__ import annotations

import json
from itertools import combinations

import numpy as np
import pytest

from cspace import Robot, find_region, is_feasible, load_robot, packaged_robots
from cspace.arms.why import why, why_document, why_lines
from cspace.explorer.data import figure_data
from cspace.explorer.page import explorer_page
from cspace.measures.bodies import gaps, overlaps
from cspace.model.robotfile import parse_robot
from cspace.sampling import joint_ranges
from cspace.tolerances import CONTACT
from engine_support.commands import follows_schema, run

MINERVA = (("0", "1"), ("0", "2"), ("1", "2"))
ARM = """
schema = 1
name = "arm"
length_unit = "m"
angle_unit = "deg"
home = { a = 90, b = 0 }
tool = "tip"
joint = [{ name = "a", parent = "table", frame = "upper", origin = [0, 0, 0], TURNS },
         { name = "b", parent = "upper", frame = "fore", origin = [0.4, 0, 0], TURNS }]
""".replace("TURNS", 'type = "revolute", axis = [0, 0, 1]')
TIP = 'point = [{ name = "tip", frame = "fore", at = [0.35, 0, 0] }]'
POST = 'obstacle = [{ name = "post", disc = { at = [0.3, 0], radius = 0.1 } }]'
ALL = 'collisions = "all"'
UPPER = '{ frame = "upper", polygon = [[0.05, -0.02], [0.3, -0.02], [0.3, 0.02], [0.05, 0.02]] }'
FORE = '{ frame = "fore", polygon = [[0.05, -0.02], [0.3, -0.02], [0.3, 0.02], [0.05, 0.02]] }'
BASE = '{ frame = "table", polygon = [[-0.05, -0.5], [0.05, -0.5], [0.05, -0.4], [-0.05, -0.4]] }'
THREE = f"body = [{BASE}, {UPPER}, {FORE}]"
FENCE = '{ name = "fence", type = "half-space", normal = [1, 0, 0], offset = -1, %s = "%s" }'
TIP_FENCE, FORE_FENCE = FENCE % ("point", "tip"), FENCE % ("body", "fore")
APART = '{ name = "apart", type = "bodies", bodies = ["table", "%s"]%s }'
BALLS = """point = [{ name = "tip", frame = "fore", at = [0.35, 0, 0] },
         { name = "base/1", frame = "table", at = [0, -0.5, 0], radius = 0.1 },
         { name = "hand/1", frame = "fore", at = [0.35, 0, 0], radius = 0.05 }]"""
BALLS_APART = '{ name = "balls", type = "pair", points = ["base/1", "hand/1"] }'


def pairs(*names: str) -> tuple[tuple[str, str], ...]:
    """Return pairs that are written as "one|other"."""
    return tuple((one, other) for one, _, other in (name.partition("|") for name in names))


def all_pairs(*names: str) -> tuple[tuple[str, str], ...]:
    """Return every pair of these names, in their order."""
    return tuple(combinations(names, 2))


def made(*lines: str) -> Robot:
    """Return the arm with further lines of its file."""
    points = () if any(line.startswith("point") for line in lines) else (TIP,)
    return parse_robot(ARM + "\n".join((*points, *lines)), "arm.toml")


PACKAGED = {
    "minervabot-v2": ("points", MINERVA, False),
    "minervabot-v2-corrected": ("points", MINERVA, False),
    "minervabot-v2-symmetric": ("points", MINERVA, False),
    "minervabot-v2-bodies": ("points and bodies", (), True),
    "pp-portal": ("points", pairs("column|beam"), False),
    "pr-gantry-arm": ("points", pairs("cart|arm"), False),
    "rp-telescopic-boom": ("points", pairs("boom|inner boom"), False),
    "two-joint-arm-with-walls": ("points", all_pairs("base", "upper arm", "forearm"), False),
    "two-links-on-a-table": ("bodies", pairs("upper arm|forearm"), False),
    "ur5": (
        "spheres",
        pairs(
            "base_link|shoulder_link", "shoulder_link|upper_arm_link",
            "upper_arm_link|forearm_link", "forearm_link|wrist_1_link",
            "wrist_1_link|wrist_2_link", "wrist_1_link|wrist_3_link", "wrist_2_link|wrist_3_link",
        ),
        False,
    ),
}  # fmt: skip

TOLD = {
    "nothing bounds it": ((), "joint limits", (), False),
    "a fence for a point": ((f"boundary = [{TIP_FENCE}]",), "points", (), False),
    "bodies that are drawn": (
        (THREE,), "joint limits", all_pairs("table", "upper", "fore"), False,
    ),
    "bodies that keep apart": ((THREE, ALL), "bodies", (), True),
    "a pair that is allowed": (
        (THREE, ALL, 'allowed = [["upper", "fore"]]'), "bodies", pairs("upper|fore"), False,
    ),
    "a boundary of two bodies": (
        (THREE, f"boundary = [{APART % ('fore', '')}]"),
        "bodies", pairs("table|upper", "upper|fore"), False,
    ),
    "a boundary of two bodies that is not used": (
        (THREE, ALL, f"boundary = [{APART % ('fore', ', used = false')}]"),
        "bodies", pairs("table|fore"), False,
    ),
    "a fence for a body": (
        (THREE, f"boundary = [{FORE_FENCE}]"),
        "bodies", all_pairs("table", "upper", "fore"), False,
    ),
    "an obstacle, and no body that it could stop": (
        (POST, ALL), "joint limits", pairs("upper|fore", "upper|post", "fore|post"), False,
    ),
    "an obstacle that is drawn": (
        (THREE, POST), "joint limits",
        (*all_pairs("table", "upper", "fore"), *pairs("upper|post", "fore|post")), False,
    ),
    "an obstacle that stops all": ((THREE, POST, ALL), "bodies", (), True),
    "a forearm without a body": (
        (f"body = [{BASE}, {UPPER}]", POST, ALL),
        "bodies", pairs("table|fore", "upper|fore", "fore|post"), False,
    ),
    "a base without a body": ((f"body = [{UPPER}, {FORE}]", ALL), "bodies", (), False),
    "a link that is missing": ((THREE, ALL, 'left_out = ["camera"]'), "bodies", (), False),
    "spheres that keep apart": ((BALLS, f"boundary = [{BALLS_APART}]"), "spheres", (), False),
    "spheres and an obstacle": (
        (BALLS, f"boundary = [{BALLS_APART}]", POST),
        "spheres", pairs("base|upper", "hand|upper", "hand|post", "upper|post"), False,
    ),
    "all kinds": (
        (BALLS, f"boundary = [{BALLS_APART}, {TIP_FENCE}]", THREE, ALL),
        "points and spheres and bodies",
        pairs("base|upper", "base|fore", "hand|table", "hand|upper"), False,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", packaged_robots())
def test_every_packaged_robot_says_what_it_looks_at(name: str) -> None:
    robot = load_robot(name)
    assert (robot.feasible_by, robot.unchecked, robot.whole_links) == PACKAGED[name]


@pytest.mark.parametrize("case", TOLD)
def test_what_a_file_does_not_check_is_found(case: str) -> None:
    lines, by, unchecked, whole = TOLD[case]
    robot = made(*lines)
    assert (robot.feasible_by, robot.whole_links) == (by, whole)
    assert sorted(robot.unchecked) == sorted(unchecked)


def planar() -> list[Robot]:
    """Return all robots of this file whose bodies an oracle judges: those that move in a plane."""
    robots = [load_robot(name) for name in packaged_robots() if name != "ur5"]
    return robots + [made(*lines) for lines, *_ in TOLD.values()]


@pytest.mark.parametrize("robot", planar(), ids=[*list(packaged_robots())[:-1], *TOLD])
def test_what_overlaps_in_a_feasible_pose_is_named_as_unchecked(robot: Robot) -> None:
    """The oracle measures the gap of every two bodies, whatever boundaries there are."""
    q = np.random.default_rng(5).uniform(*joint_ranges(robot).T, (400, 2))
    q = q[is_feasible(robot, q)]
    assert len(q)
    unchecked = {frozenset(pair) for pair in robot.unchecked}
    overlapping = {frozenset(p) for p, gap in gaps(robot, q).items() if (gap < -CONTACT).any()}
    assert overlapping <= unchecked
    if robot.whole_links:
        assert not overlapping


# --- outputs --------------------------------------------------------------------------------------

BY_POINTS = "feasible means allowed by the points of this file; whole links are not looked at\n"
NAMED = "not checked, because no boundary keeps them apart: 0 and 1; 0 and 2; 1 and 2\n"
LEFT_OUT = {"pairs": [list(pair) for pair in MINERVA], "links": []}


def test_contains_says_by_points_and_names_the_links_that_overlap(capsys) -> None:
    """It said "feasible", five positive margins, and nothing of the links inside each other."""
    depth = overlaps(load_robot("minervabot-v2"), [0.2, 2.5])
    assert list(depth) == [("1", "2")]
    assert depth["1", "2"] == pytest.approx(8.7758, abs=1e-4)
    status, out, _ = run(capsys, "contains minervabot-v2 0.2rad 2.5rad")
    assert status == 0
    assert out.startswith("feasible by points, in component 1 (of 5, counted from 0), without")
    assert out.endswith(BY_POINTS + NAMED)
    status, out, _ = run(capsys, "contains minervabot-v2-bodies 0.2rad 2.5rad")
    assert status == 1
    assert out.startswith("violated: link 1, link 2, margin -8.7758")
    assert "not checked" not in out


ANSWERS = (
    "contains minervabot-v2 0 0",
    "contains minervabot-v2 80deg 0",
    "region minervabot-v2",
    "workspace minervabot-v2",
    "traverse minervabot-v2 1 2 3 --scale 0.9",
    "fibre minervabot-v2 q2",
    "why minervabot-v2 0 0 10 -20",
    "why minervabot-v2 0 0 0 130",
    "why minervabot-v2 0 0 80 0",
    "certify minervabot-v2 --scale 0.9",
    "certify minervabot-v2 --scale 1",
    "certify minervabot-v2 --largest-scale",
    "explore minervabot-v2 -o a.html",
)


@pytest.mark.parametrize("line", ANSWERS)
def test_every_answer_by_points_says_so(line: str, capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    named = line.split(maxsplit=1)[0]
    with_json = named not in ("certify", "explore")
    _, out, err = run(capsys, line + " --json a.json" * with_json)
    assert BY_POINTS + NAMED in out, err
    assert "safe" not in out
    if with_json:
        content = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
        assert (content["feasible_by"], content["left_out"]) == ("points", LEFT_OUT)
        if named != "contains":
            follows_schema(content, named)


def test_a_strip_of_regions_says_by_what(capsys) -> None:
    words = "region ur5 --slice shoulder_pan_joint=0 wrist_1_joint=-90 wrist_2_joint=-90"
    line = f"{words} --strip wrist_3_joint=0..10:2 --json"
    out = run(capsys, f"{line} a.json".replace(" --json a.json", ""))[1]
    assert out.count(", feasible by spheres") == 2
    assert "not checked, because no boundary keeps them apart: base_link and shoulder_link" in out
    content = json.loads(run(capsys, f"{line} -")[1])
    assert content["feasible_by"] == "spheres"
    follows_schema(content, "slices")


def test_the_region_by_bodies_says_so(capsys) -> None:
    out = run(capsys, "region minervabot-v2-bodies")[1]
    assert out.startswith("1 component, ")
    assert ", feasible by points and bodies\n" in out
    assert "not checked" not in out


def test_why_says_what_limits_alone_allow() -> None:
    found = why(made(), [0.0, 0.0], [0.5, 0.5])
    assert "feasible means within the joint limits; this file has no boundary in use" in [
        *why_lines(found)
    ]
    assert why_document(found)["feasible_by"] == "joint limits"


@pytest.mark.parametrize(("case", "safe"), [(case, whole) for case, (*_, whole) in TOLD.items()])
def test_the_page_says_safe_only_where_whole_links_keep_clear(case, safe) -> None:
    """It said "Safe" without any boundary, and where bodies were only kept off a fence."""
    word = figure_data(find_region(made(*TOLD[case][0])))["word"]
    assert (word == "safe") is safe


def test_the_page_says_by_what_its_poses_are_feasible() -> None:
    page = explorer_page(find_region(load_robot("minervabot-v2")))
    assert "<title>MinervaBotV2: feasible poses</title>" in page
    assert "The values of q1 and q2 that are feasible by points form 5 pieces." in page
