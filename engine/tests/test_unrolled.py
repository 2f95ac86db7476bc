# ruff: noqa: E501  (rows of robot files, one a line)
"""Components that go all the way round a joint: cut open, proved, and every angle is in them."""

import tomllib
from fractions import Fraction

import numpy as np
import pytest

from cspace import check, find_region
from cspace.geometry import polygon
from cspace.model.robotfile import parse_robot
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.certify import certify
from engine_support import second_checker

ARM = """schema = 1
name = "round"
length_unit = "cm"
angle_unit = "{unit}"
home = {{ q1 = 0, q2 = 0 }}
tool = "tip"
joint = [
  {{ name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 1, 0] }},
  {{ name = "q2", type = "revolute", parent = "1", frame = "2", origin = [10, 0, 0], axis = [0, 1, 0]{limits} }},
]
point = [
  {{ name = "tip", frame = "2", at = [6, 0, 0] }},
  {{ name = "base", frame = "0", at = [0, 0, 0] }},
  {{ name = "post", frame = "0", at = [0, 0, 14] }},
]
{boundaries}"""
PAIR = '[[boundary]]\nname = "{0}"\ntype = "pair"\npoints = ["tip", "{0}"]\nclearance = {1}\n'
BASE, POST = PAIR.format("base", 8), PAIR.format("post", 1)
WALL = '[[boundary]]\nname = "wall"\ntype = "half-space"\npoint = "tip"\nnormal = {}\noffset = {}\n'
LIMITS = ", limits = [-100, 90]"

ARMS = {
    "a ring": (ARM.format(unit="deg", limits="", boundaries=BASE), "q1"),
    "a ring in radians": (ARM.format(unit="rad", limits="", boundaries=BASE), "q1"),
    "a ring with holes": (ARM.format(unit="deg", limits="", boundaries=BASE + POST), "q1"),
    "a ring between limits": (ARM.format(unit="deg", limits=LIMITS, boundaries=POST), "q1"),
    "a ring with a hole on the cut": (
        ARM.format(unit="deg", limits="", boundaries=BASE + POST).replace(
            "[0, 0, 14]", "[-14, 0, 0]"
        ),
        "q1",
    ),
    "a ring about the other joint": (
        ARM.format(unit="deg", limits="", boundaries=WALL.format([1, 0, 0], 1)),
        "q2",
    ),
    "all but a hole": (ARM.format(unit="deg", limits="", boundaries=POST), "q1 q2"),
    "all": (ARM.format(unit="deg", limits="", boundaries=WALL.format([1, 0, 0], -99)), "q1 q2"),
}


@pytest.mark.parametrize("name", ARMS)
def test_a_component_that_goes_round_is_proved_and_said_to_go_round(name):
    text, joints = ARMS[name]
    robot = parse_robot(tomllib.loads(text))
    component = find_region(robot).home_component
    assert component.wraps == tuple(joint in joints.split() for joint in ("q1", "q2"))
    statement = statements.inner_polygon(robot, 0.3)
    answer = certify(text, statement)
    assert answer.verdict == "proved"
    assert second_checker.verify(answer.text) == "proved"
    said = check.check(answer.text).said
    assert [f"'{q}' takes every angle" in said for q in ("q1", "q2")] == list(component.wraps)
    degrees = robot.angle_unit == "deg"
    points = [tuple(map(Fraction, point)) for loop in statement["points"] for point in loop]
    widths = [max(column) - min(column) for column in zip(*points, strict=True)]
    turn = Fraction(360) if degrees else Fraction("6.283185307179586476925286766559005768394")
    for width, wraps in zip(widths, component.wraps, strict=True):
        assert not wraps or (
            width == turn if degrees else turn <= width < turn + Fraction(1, 10**9)
        )
    loops = [np.array(loop, dtype=float) * statements.units(robot) for loop in statement["points"]]
    assert 0.8 * component.area < sum(map(polygon.area, loops)) <= component.area * (1 + 1e-9)


def test_a_component_that_goes_round_has_no_polygon_to_scale():
    robot = parse_robot(tomllib.loads(ARMS["a ring"][0]))
    with pytest.raises(ValueError, match="no polygon to scale; ask for the region"):
        statements.home_polygon(robot)
