"""Margins by kinematics and distances: those of the compiled forms, and of the robot's frames."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from qbound import clearance, load_robot
from qbound.boundary.balls import BLOCK, Balls
from qbound.boundary.chain import axis_last
from qbound.boundary.evaluator import evaluator
from qbound.model.robot import Pair, Point
from support.ball_arms import arm_of_balls, drawn

ARMS = [*map(arm_of_balls, range(7)), load_robot("minervabot-v2"), load_robot("pp-portal")]
NAMED = {"argvalues": ARMS, "ids": lambda robot: robot.name}


@pytest.mark.parametrize("robot", **NAMED)
def test_margins_are_those_of_the_compiled_forms(robot):
    q, compiled, balls = drawn(robot, 400), evaluator(robot, limits=False), Balls.of(robot)
    assert balls.names == compiled.names
    assert_allclose(balls.margins(q), compiled.margins(q), atol=1e-7)  # a root near distance 0
    clear = np.abs(compiled.margins(q)).min(axis=1) > 1e-9
    expected = (compiled.margins(q) >= 0).all(axis=1)
    assert_array_equal(balls.feasible(q)[clear], expected[clear])


@pytest.mark.parametrize("robot", **NAMED)
def test_centres_are_those_of_the_frames(robot):
    q = drawn(robot, 2 * BLOCK + 3)
    frames, found = robot.frames(q), Balls.of(robot).centres(q)
    for point, places in zip(robot.points, np.moveaxis(found, 1, 0), strict=True):
        expected = frames.position(robot.base, point.name, robot.base)
        assert_allclose(places, np.broadcast_to(expected, places.shape), atol=1e-13)


@pytest.mark.parametrize("robot", **NAMED)
def test_forms_along_a_joint_are_those_of_the_whole_form(robot):
    q = drawn(robot, 40)
    for j in range(len(robot.joints)):
        found = Balls.of(robot).along(robot.joints[j].name, q)
        for k, boundary in list(enumerate(robot.used))[j % 5 :: 5]:
            expected = clearance(robot, boundary).along(j, q)
            size = np.abs(expected).max() + 1
            assert_allclose(found[:, k], expected, atol=1e-13 * size, err_msg=boundary.name)


@pytest.mark.parametrize("robot", **NAMED)
def test_a_pair_on_one_side_of_a_joint_is_constant_along_it(robot):
    balls, q = Balls.of(robot), drawn(robot, 5)
    for j in range(len(robot.joints)):
        moving = {*balls.pairs[balls.across(j)], *balls.walls[balls.beyond(j)]}
        still = [k for k in range(len(balls.names)) if k not in moving]
        assert (balls.along(j, q)[:, still, 1:] == 0).all()


@pytest.mark.parametrize("robot", ARMS[4:7], ids=lambda robot: robot.name)
def test_any_shape_of_configurations_is_one_after_the_other(robot):
    q, balls = drawn(robot, 2 * BLOCK + 2), Balls.of(robot)
    shaped = q.reshape(2, BLOCK + 1, -1)
    for ask in (balls.margins, balls.centres, balls.feasible, lambda q: balls.along(0, q)):
        many = ask(q)
        assert_array_equal(ask(shaped), many.reshape(2, BLOCK + 1, *many.shape[1:]))
        assert_allclose(ask(q[BLOCK]), many[BLOCK], atol=1e-12)
        assert ask(q[:0]).shape == (0, *many.shape[1:])


def test_limits_count_and_what_touches_is_feasible():
    robot = load_robot("pr-gantry-arm")
    balls = Balls.of(robot)
    low, high = robot.joints[0].limits
    inside = drawn(robot, 200)
    q = inside[balls.feasible(inside)][0]
    ends = [[low, q[1]], [high, q[1]], [low - 1e-9, q[1]], [high + 1e-9, q[1]]]
    walls = evaluator(robot, limits=False).feasible(ends)
    assert_array_equal(balls.feasible(ends), walls & [True, True, False, False])


def test_two_balls_that_always_touch_are_feasible():
    """A ball on the axis, another that turns about it: what keeps them apart is rounding alone."""
    robot = load_robot("minervabot-v2")
    radius, at = 0.1, np.array([0.1, 0.2, 0.3])
    points = (
        Point("on the axis", robot.base, robot.joints[0].origin, radius),
        Point("turning", robot.joints[0].frame, at, np.sqrt(0.14) - radius),
    )
    pair = Pair("touching", ("on the axis", "turning"))
    still = replace(robot, points=points, boundaries=(pair,), tool="turning")
    q = np.linspace([-3, 0], [3, 0], 100)
    assert Balls.of(still).feasible(q).all()
    assert_array_equal(Balls.of(still).margins(q).min(), 0.0)


def test_a_boundary_about_bodies_is_refused_by_name():
    with pytest.raises(ValueError, match="about bodies"):
        Balls.of(load_robot("two-links-on-a-table"))


@pytest.mark.parametrize("q", [[0.1], [[0.1, np.nan]], "home"])
def test_what_is_no_configuration_is_refused(q):
    balls = Balls.of(load_robot("minervabot-v2"))
    for ask in (balls.margins, balls.feasible, balls.centres, lambda q: balls.along(0, q)):
        with pytest.raises(ValueError, match=r"joint|numbers"):
            ask(q)


@pytest.mark.parametrize("axis", [[0, 0, 1], [0, -1, 0], [0.6, 0.0, 0.8], [1e-9, 1, 0]])
def test_an_axis_becomes_the_last_column_of_a_rotation(axis):
    axis = np.array(axis, dtype=float) / np.linalg.norm(axis)
    turned = axis_last(axis)
    assert_allclose(turned @ turned.T, np.eye(3), atol=1e-15)
    assert_allclose(turned[:, 2], axis)
    assert np.linalg.det(turned) == pytest.approx(1)
