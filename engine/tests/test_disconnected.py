"""Certificates that no path leads from start to goal: written by the provers, checked twice."""

import json
import re
import tomllib
from functools import cache
from importlib import resources

import numpy as np
import pytest
from jsonschema import validate

from cspace import check
from cspace.arms.separations import separation, separations
from cspace.model.robotfile import parse_robot, robot_text
from cspace.proofs.certificates.no_path import certify_disconnected, certify_no_path
from cspace.proofs.certificates.statements import units
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.subpaving.connection import connection
from cspace.proofs.subpaving.forbidden import blocked_ranges
from engine_support import brute_force, planar, second_checker
from engine_support.elbow import SLIDE, arm

HELD = {
    "one joint round": (planar.turning("deg"), ["70"], ["-100"], [0]),
    "one joint round, radians": (planar.turning("rad"), ["1.2"], ["-1.9"], [0]),
    "two joints round": (planar.round_both("deg"), ["50", "110"], ["166", "0"], [0, 1]),
    "two joints round, radians": (planar.round_both("rad"), ["0.9", "2"], ["2.9", "0"], [0, 1]),
    "three joints": (planar.caged("deg"), ["0", "110", "0"], ["0", "-110", "10"], [0, 1, 2]),
    "wrist held": (planar.caged("deg"), ["0", "110", "20"], ["9", "-110", "20"], [0, 1]),
    "wrist held, radians": (planar.caged("rad"), ["0", "2", "0.3"], ["0", "-2", "0.3"], [0, 1]),
    "shoulder held": (planar.caged("deg"), ["5", "110", "20"], ["5", "-110", "0"], [1, 2]),
    "slide held": (planar.telescope(), ["0", "-0.3"], ["175", "-0.3"], [0]),
    "turning and sliding": (planar.telescope(), ["0", "-0.3"], ["175", "-0.3"], [0, 1]),
    "sliding, a turn held": (SLIDE, ["-1", "5"], ["1", "5"], [0]),
}
"""Robot, start, goal, joints that move; the others are held."""

RADIANS = arm(unit="rad").replace("[-360, 360]", "[-6.5, 6.5]").replace("[-180, 180]", "[-3, 3]")
ANY = {
    "an elbow that folds": (arm(), [0.1, 1.0, 0], [0.2, 4.0, 0.3]),
    "the same in radians": (RADIANS, [0.1, 1.0, 0], [0.2, 4.0, 0.3]),
    "round a joint": (robot_text("minervabot-v2")[0], [0.0, 0.0], [0.0, 2.3]),
    "a slide": (SLIDE, [-1.0, 0], [1.0, 2.0]),
}
"""Robot, start and goal, rad or lengths: a joint cannot pass, whatever the others do."""


def disconnected(text, start, goal, free):
    robot = parse_robot(tomllib.loads(text))
    ends = np.array([start, goal], dtype=float) * units(robot)
    held = {j: ends[0, j] for j in range(len(start)) if j not in free}
    found = connection(exact_problem(exact_robot(robot), held), *ends[:, free])
    return found, ends


@cache
def certificate(name):
    if name in HELD:
        text, start, goal, free = HELD[name]
        found, ends = disconnected(text, start, goal, free)
        assert found.answer == "separated"
        return certify_disconnected(text, *ends, found.paving)
    text, start, goal = ANY[name]
    robot = parse_robot(tomllib.loads(text))
    found = separation(separations(robot), start, goal)
    return certify_no_path(text, start, goal, [block.ranges[0] for block in found.blocks])


def data_of(name):
    return json.loads(certificate(name).text)


@cache
def schema():
    file = resources.files("cspace") / "schemas" / "certificate.schema.json"
    return json.loads(file.read_text())


def accepted(checker, data):
    try:
        checker(json.dumps(data))
    except ValueError:
        return False
    return True


def answers(data):
    return accepted(check.check, data), accepted(second_checker.verify, data)


def closed_leaves(data):
    return len(re.findall("[0-9]+[.]", data["proof"]["tree"]))


# --- what is written ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", [*HELD, *ANY])
def test_both_checkers_the_schema_and_brute_force_accept_it(name):
    found, data = certificate(name), data_of(name)
    assert found.verdict == "proved", found.said
    assert answers(data) == (True, True)
    validate(data, schema())
    assert brute_force.tells_the_truth(data)
    kinds = data["claim"]["joints"]
    if name in HELD:
        free = HELD[name][3]
        assert kinds == ["moves" if j in free else "held" for j in range(len(kinds))]
    else:
        assert sorted({*kinds}) == ["any", "moves"]
        assert kinds.count("moves") == 1


def test_trees_are_small():
    """The paving of the cage has thousands of cells; a wall needs a handful."""
    assert closed_leaves(data_of("three joints")) < 20
    assert max(closed_leaves(data_of(name)) for name in ANY) < 5


def test_what_is_joined_is_not_certified():
    text, start, _, free = HELD["two joints round"]
    found, ends = disconnected(text, start, ["60", "100"], free)
    assert found.answer == "connected"
    with pytest.raises(ValueError, match="does not separate"):
        certify_disconnected(text, *ends, found.paving)


@pytest.mark.parametrize(
    ("elbow", "goal"),
    [("", 4.0), ("limits = [-360, 360]", 2.0), ("limits = [-360, 360]", 3.1)],
    ids=["one range round a joint", "both on one side", "a goal in the range"],
)
def test_a_separation_that_is_none_is_not_written(elbow, goal):
    robot = parse_robot(tomllib.loads(arm(elbow)))
    ranges = [r for r in blocked_ranges(robot) if r.joint == 1]
    assert certify_no_path(arm(elbow), [0, 1, 0], [0, goal, 0], ranges).verdict == "undecided"


FOREARMS = {
    "outline": "polygon = [[0.1, -0.05], [0.8, -0.05], [0.8, 0.05], [0.1, 0.05]]",
    "capsule": "capsule = { from = [0.1, 0], to = [0.8, 0], radius = 0.05 }",
}
POSTS = {
    "square": "polygon = [[1.0, -0.1], [1.3, -0.1], [1.3, 0.1], [1.0, 0.1]]",
    "notch": "polygon = [[0.8, -0.1], [1.3, -0.1], [1.3, 0.2], [1.1, 0.0], [0.8, 0.2]]",
    "disc": "disc = { at = [1.1, 0], radius = 0.15 }",
    "capsule": "capsule = { from = [0.9, -0.05], to = [1.3, 0.05], radius = 0.05 }",
}


@pytest.mark.parametrize("post", POSTS)
@pytest.mark.parametrize("forearm", FOREARMS)
def test_a_body_in_the_way_is_certified(tmp_path, forearm, post):
    """Two links that cannot go past a post on either side of it."""
    text = f"""schema = 1
name = "bodies"
length_unit = "m"
angle_unit = "deg"
home = {{ q1 = 90, q2 = 0 }}
tool = "tip"
collisions = "all"
clearance = 0.01
joint = [
  {{ name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0],
    axis = [0, 0, 1], limits = [-170, 170] }},
  {{ name = "q2", type = "revolute", parent = "1", frame = "2", origin = [1, 0, 0],
    axis = [0, 0, 1], limits = [-60, 60] }},
]
point = [{{ name = "tip", frame = "2", at = [0.8, 0, 0] }}]
[[body]]
name = "upper arm"
frame = "1"
polygon = [[0.3, -0.05], [1, -0.05], [1, 0.05], [0.3, 0.05]]
[[body]]
name = "forearm"
frame = "2"
{FOREARMS[forearm]}
[[obstacle]]
name = "post"
{POSTS[post]}
""".replace(",\n    axis", ", axis")
    file = tmp_path / "arm.toml"
    file.write_text(text)
    ends = np.radians([[60, 10], [-60, -10]])
    found = connection(exact_problem(exact_robot(file)), *ends)
    answer = certify_disconnected(text, *ends, found.paving)
    assert (found.answer, answer.verdict) == ("separated", "proved"), answer.said
    data = json.loads(answer.text)
    assert answers(data) == (True, True)
    assert brute_force.tells_the_truth(data)
    assert closed_leaves(data) < 40


# --- which leaves touch ---------------------------------------------------------------------------
