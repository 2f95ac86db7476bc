"""The compiled boundaries of a robot: margins of one configuration, of many, by kinematics."""

import tomllib

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from qbound import load_robot
from qbound.boundary.evaluator import BLOCK, evaluator
from qbound.boundary.functions import clearance, margin_of, position, squared_distance
from qbound.model.robot import HalfSpace, Robot
from qbound.model.robotfile import parse_robot
from qbound.region import clearance_problem, find_region
from support.arms import three_joints
from support.robots import random_robot

ROBOTS = [*map(random_robot, range(12)), three_joints(), load_robot("minervabot-v2")]


def configurations(robot: Robot, *shape: int) -> np.ndarray:
    ends = np.array([joint.limits or (-4.0, 4.0) for joint in robot.joints])
    return np.random.default_rng(5).uniform(*(ends.T * 1.2), size=(*shape, len(ends)))


def by_kinematics(robot: Robot, q: np.ndarray) -> dict[str, np.ndarray]:
    """Distances of the points themselves, less what is to be kept; depths inside the limits."""
    frames, found = robot.frames(q), {}
    for b in (b for b in robot.boundaries if b.used):
        names = (b.point,) if isinstance(b, HalfSpace) else b.points
        places = [frames.position(robot.base, p, robot.base) for p in names]
        radii = sum(robot.point(p).radius for p in names)
        if isinstance(b, HalfSpace):
            found[b.name] = places[0] @ b.normal - b.offset - radii
        else:
            apart = np.linalg.norm(places[1] - places[0], axis=-1)
            found[b.name] = apart - radii - b.clearance
    for j, joint in enumerate(robot.joints):
        if joint.limits is not None:
            found[f"{joint.name}.lower"] = q[..., j] - joint.limits[0]
            found[f"{joint.name}.upper"] = joint.limits[1] - q[..., j]
    return found


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_margins_are_those_of_forward_kinematics(robot) -> None:
    q, compiled = configurations(robot, 300), evaluator(robot)
    expected = by_kinematics(robot, q)
    assert list(expected) == list(compiled.names)
    for b in (b for b in robot.boundaries if b.used):
        found = margin_of(robot, b, clearance(robot, b)(q))
        assert_allclose(found, expected[b.name], atol=1e-7, err_msg=b.name)
    for found, name in zip(compiled.margins(q).T, compiled.names, strict=True):
        assert_allclose(found, expected[name], atol=1e-7, err_msg=name)  # a root near distance 0


@pytest.mark.parametrize("robot", ROBOTS[-3:], ids=lambda robot: robot.name)
def test_a_batch_of_any_shape_is_one_configuration_after_the_other(robot) -> None:
    q, compiled = configurations(robot, 2, BLOCK // 2 + 3), evaluator(robot)
    margins, feasible = compiled.margins(q), compiled.feasible(q)
    assert margins.shape == (*q.shape[:-1], len(compiled.names))
    assert_array_equal(feasible.shape, q.shape[:-1])
    for place in ((0, 0), (0, 17), (1, BLOCK // 2 - 4), (1, BLOCK // 2 - 3), (1, BLOCK // 2 + 2)):
        assert_allclose(margins[place], compiled.margins(q[place]), atol=1e-9)
        assert feasible[place] == compiled.feasible(q[place])
    clear = np.abs(margins).min(axis=-1, initial=np.inf) > 1e-9
    assert_array_equal(feasible[clear], (margins >= 0).all(axis=-1)[clear])


@pytest.mark.parametrize("ask", ["margins", "feasible"])
@pytest.mark.parametrize("q", [0.5, [0.5], [0.1, 0.2, 0.3], [[0.1], [0.2]]])
def test_another_number_of_joint_values_is_refused(ask, q) -> None:
    with pytest.raises(ValueError, match="expected 2 joint values on the last axis, found"):
        getattr(evaluator(load_robot("minervabot-v2")), ask)(q)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_a_squared_distance_is_from_the_base_unless_a_centre_is_given(robot) -> None:
    q, tool = configurations(robot, 50), robot.tool
    place = position(robot, tool)(q)
    for centre in (np.zeros(3), np.array([0.3, -0.2, 1.1])):
        there = squared_distance(robot, tool, centre=centre)(q)
        assert_allclose(there, ((place - centre) ** 2).sum(axis=-1), rtol=1e-9, atol=1e-9)
    assert_allclose(squared_distance(robot, tool)(q), (place**2).sum(axis=-1), rtol=1e-9, atol=1e-9)


# --- ties that only rounding breaks ---------------------------------------------------------------

TIE = """
schema = 1
name = "a tie"
length_unit = "m"
angle_unit = "deg"
home = { a = 10, b = 20 }
tool = "tip"
joint = [
  { name = "a", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 0, 1] },
  { name = "b", type = "revolute", parent = "1", frame = "2", origin = [1, 0, 0], axis = [0, 0, 1] },
]
"""  # noqa: E501
POINTS = """
point = [
  {{ name = "post", frame = "0", at = [0, 0, {low}], radius = {a} }},
  {{ name = "tip", frame = "1", at = [0, 0, {high}], radius = {b} }},
]
boundary = [
  {{ name = "pair", type = "pair", points = ["post", "tip"] }},
  {{ name = "floor", type = "half-space", point = "tip", normal = [0, 0, 1], offset = {level} }},
]
"""
BODIES = """
point = [{{ name = "tip", frame = "1", at = [0, 0, 0] }}]
body = [{{ name = "hub", frame = "1", disc = {{ at = [0, 0], radius = {a} }} }}]
obstacle = [{{ name = "ring", disc = {{ at = [{c}, 0], radius = {b} }} }}]
boundary = [{{ name = "bodies", type = "bodies", bodies = ["hub", "ring"] }}]
"""


@pytest.mark.parametrize("tenths", [0, 77, -1003], ids="from {} tenths".format)
def test_points_that_touch_everywhere_in_decimals_touch_in_floats(tenths) -> None:
    """Radii a and b at the distance a + b, all one-digit decimals: 0.3^2 - (0.1 + 0.2)^2 < 0.

    The coordinates may be far larger than the distance: their rounding is in it, too.
    """
    low, broken = tenths / 10, 0
    for a, b in np.ndindex(9, 9):
        one, other = (a + 1) / 10, (b + 1) / 10
        high, level = (tenths + a + b + 2) / 10, (tenths + a + 1) / 10
        text = POINTS.format(low=low, high=high, a=one, b=other, level=level)
        robot = parse_robot(tomllib.loads(TIE + text))
        broken += float(evaluator(robot).table[0, 0]) < 0
        for compiled in (evaluator(robot), clearance_problem(robot).evaluator):
            margins = compiled.margins([0.3, 0.4])
            assert margins.min() >= 0
            assert margins.max() <= 1e-12 * (1 + abs(low)) ** 2 / (one + other)
            assert compiled.feasible([0.3, 0.4])
        assert clearance_problem(robot).constants == {0: 0.0, 1: 0.0}
    assert broken  # by rounding some forms are negative


def test_bodies_that_touch_everywhere_in_decimals_touch_in_floats() -> None:
    for a, b in np.ndindex(9, 9):
        text = BODIES.format(a=(a + 1) / 10, b=(b + 1) / 10, c=(a + b + 2) / 10)
        robot = parse_robot(tomllib.loads(TIE + text))
        assert 0 <= evaluator(robot).margins([0.3, 0.4])[0] <= 1e-15
        assert evaluator(robot).feasible([0.3, 0.4])


def test_points_that_overlap_by_more_than_rounding_do_not_touch() -> None:
    for low, by in ((0.0, 1e-12), (-100.3, 1e-9)):
        text = POINTS.format(low=low, high=low + 0.3 - by, a=0.1, b=0.2, level=low + 0.1)
        robot = parse_robot(tomllib.loads(TIE + text))
        assert not find_region(robot).contains([0.3, 0.4])
        assert evaluator(robot).margins([0.3, 0.4])[0] == pytest.approx(-by, rel=1e-3)
