"""Time: no joint is too fast between its rows, straight or by cubics; ROS gets its own units."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.interpolate import CubicHermiteSpline

from qbound import find_region, load_robot
from qbound.model.robotfile import parse_robot
from qbound.paths.trajectory import (
    joint_speeds,
    lasting,
    ros_trajectory,
    row_times,
    stretched,
    timed,
    top_speeds,
)
from qbound.paths.traversal import Leg, follow, traverse

MINERVA = load_robot("minervabot-v2")
STOPS = st.lists(
    st.tuples(*[st.integers(-30, 30).map(lambda k: k / 10)] * 2), min_size=2, max_size=5
)
SPEEDS = st.tuples(st.floats(0.1, 10), st.floats(0.1, 10))


def along_the_boundary():
    component = find_region(MINERVA).components[0]
    return follow(MINERVA, [Leg(a.at, parts=len(a.pieces.roots)) for a in component.loops[0]], 0.01)


@settings(max_examples=30, deadline=None)
@given(STOPS, SPEEDS)
def test_no_joint_is_too_fast_whichever_way_rows_are_joined(stops, speeds) -> None:
    """SciPy's cubics through positions and velocities, and straight lines, at many places."""
    walk = traverse(MINERVA, stops, deviation=0.5)
    trajectory = timed(walk, speeds)
    assume(len(trajectory.t) > 1)
    assert (np.diff(trajectory.t) > 0).all()
    straight = np.abs(np.diff(trajectory.q, axis=0)) / np.diff(trajectory.t)[:, None]
    assert (straight <= np.array(speeds) * (1 + 1e-9)).all()
    cubic = CubicHermiteSpline(trajectory.t, trajectory.q, trajectory.velocity)
    dense = np.abs(cubic.derivative()(np.linspace(0, trajectory.t[-1], 4001)))
    assert (dense <= np.array(speeds) * (1 + 1e-6)).all()
    assert_allclose(dense.max(axis=0), top_speeds(trajectory), rtol=2e-2, atol=1e-9)


def test_arcs_are_timed_as_safely() -> None:
    trajectory = timed(along_the_boundary(), [1.0, 2.0])
    cubic = CubicHermiteSpline(trajectory.t, trajectory.q, trajectory.velocity)
    dense = np.abs(cubic.derivative()(np.linspace(0, trajectory.t[-1], 40_001)))
    assert (dense <= np.array([1.0, 2.0]) * (1 + 1e-9)).all()
    assert top_speeds(trajectory) == pytest.approx([1, 2], rel=0.2)


def test_a_bend_between_rows_slows_the_whole_path() -> None:
    """A circle of joint space in few rows: cubics overshoot, by more than a thousandth."""

    def circle(s):
        return np.stack([np.cos(6 * s), np.sin(6 * s)], axis=-1)

    trajectory = timed(follow(MINERVA, [Leg(circle)], 5.0), [1.0, 1.0])
    fastest = np.abs(np.diff(trajectory.q, axis=0)).max(axis=1) / np.diff(trajectory.t)
    assert fastest[1:-1].max() < 0.999
    assert top_speeds(trajectory).max() == pytest.approx(1.0)


@settings(max_examples=30, deadline=None)
@given(STOPS, SPEEDS)
def test_time_is_the_shortest_but_for_gathering_speed_and_braking(stops, speeds) -> None:
    stops = np.array(stops)
    legs = np.abs(np.diff(stops, axis=0))
    assume((legs.max(axis=1) > 0).all())
    walk = traverse(MINERVA, stops, deviation=1e-4)
    shortest = (legs / np.array(speeds)).max(axis=1).sum()
    assert shortest < timed(walk, speeds).t[-1] <= shortest * 1.1


def test_a_straight_leg_stays_straight_in_the_cubics() -> None:
    trajectory = timed(traverse(MINERVA, [[0, 0], [1.0, -0.5]], deviation=0.05), [1, 1])
    cubic = CubicHermiteSpline(trajectory.t, trajectory.q, trajectory.velocity)
    q = cubic(np.linspace(0, trajectory.t[-1], 999))
    assert_allclose(q[:, 1], -q[:, 0] / 2, atol=1e-12)
    assert_allclose(trajectory.velocity[[0, -1]], 0)


def test_the_robot_rests_at_every_stop() -> None:
    walk = traverse(MINERVA, [[0, 0], [1, 0], [1, 1]], deviation=0.05)
    trajectory = timed(walk, [1, 1])
    at_stops = np.isin(trajectory.rows, walk.stops)
    assert (trajectory.velocity[at_stops] == 0).all()
    assert (np.abs(trajectory.velocity[~at_stops]).max(axis=1) > 0.99).all()


def test_rows_without_motion_take_no_time() -> None:
    walk = traverse(MINERVA, [[0, 0], [0, 0], [1, 0]], deviation=0.05)
    trajectory = timed(walk, [1, 1])
    assert (np.diff(trajectory.t) > 0).all()
    times = row_times(walk, trajectory)
    assert len(times) == len(walk.q)
    assert times[0] == times[1] == 0
    assert times[-1] == trajectory.t[-1]


def test_a_duration_is_kept_and_a_speed_too() -> None:
    walk = traverse(MINERVA, [[0, 0], [1, 0.5]], deviation=0.05)
    trajectory = lasting(MINERVA, walk, 7.5)
    assert trajectory.t[-1] == pytest.approx(7.5)
    slow = replace(MINERVA, joints=tuple(replace(j, velocity=0.1) for j in MINERVA.joints))
    with pytest.raises(ValueError, match=r"7\.5 s is too short: q1"):
        lasting(slow, walk, 7.5)
    assert lasting(slow, walk, timed(walk, [0.1, 0.1]).t[-1]).t[-1] > 10


@pytest.mark.parametrize("bad", [0, -1, np.inf, np.nan])
def test_a_duration_is_above_zero(bad) -> None:
    with pytest.raises(ValueError, match="duration"):
        lasting(MINERVA, traverse(MINERVA, [[0, 0], [1, 0]]), bad)


def test_missing_speeds_are_named() -> None:
    with pytest.raises(ValueError, match="no `velocity` for q1, q2"):
        joint_speeds(MINERVA)


def sliding_table():
    return {
        "schema": 1, "name": "slide", "length_unit": "mm", "angle_unit": "deg",
        "home": {"a": 0.0, "s": 100.0}, "tool": "t",
        "joint": [
            {"name": "a", "type": "revolute", "parent": "0", "frame": "1",
             "origin": [0, 0, 0], "axis": [0, 1, 0], "velocity": 90},
            {"name": "s", "type": "prismatic", "parent": "1", "frame": "2",
             "origin": [0, 0, 0], "axis": [1, 0, 0], "limits": [50, 400], "velocity": 200},
        ],
        "point": [{"name": "t", "frame": "2", "at": [10, 0, 0]}],
    }  # fmt: skip


def test_ros_gets_radians_metres_and_whole_nanoseconds() -> None:
    robot = parse_robot(sliding_table())
    assert joint_speeds(robot) == pytest.approx([np.pi / 2, 200])
    walk = traverse(robot, [[0, 100], [1.0, 300]], deviation=1.0)
    trajectory = timed(walk, joint_speeds(robot))
    message = ros_trajectory(robot, trajectory)
    assert message["joint_names"] == ["a", "s"]
    first, last = message["points"][0], message["points"][-1]
    assert first == {
        "positions": [0.0, 0.1], "velocities": [0.0, 0.0],
        "time_from_start": {"sec": 0, "nanosec": 0},
    }  # fmt: skip
    assert last["positions"] == pytest.approx([1.0, 0.3])
    times = [p["time_from_start"]["sec"] * 10**9 + p["time_from_start"]["nanosec"]
             for p in message["points"]]  # fmt: skip
    assert all(b > a for a, b in pairwise(times))
    assert times[-1] * 1e-9 == pytest.approx(trajectory.t[-1], abs=1e-6)
    assert times[-1] * 1e-9 >= trajectory.t[-1] - 1e-12
    assert all(0 <= p["time_from_start"]["nanosec"] < 10**9 for p in message["points"])
    for speed in np.array([p["velocities"] for p in message["points"]]):
        assert (np.abs(speed) <= [np.pi / 2 + 1e-9, 0.2 + 1e-9]).all()


def test_half_the_speed_takes_twice_the_time() -> None:
    trajectory = timed(traverse(MINERVA, [[0, 0], [1, 0]]), [1, 1])
    slow = stretched(trajectory, 2)
    assert slow.t[-1] == pytest.approx(2 * trajectory.t[-1])
    assert top_speeds(slow) == pytest.approx(top_speeds(trajectory) / 2)
