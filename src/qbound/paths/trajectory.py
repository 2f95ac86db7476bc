"""Joint paths in time: timed by the joints' largest speeds, and as a ROS trajectory.

Not in the paper, which has paths without times.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arrays import Floats
from qbound.model.robot import Robot
from qbound.paths.traversal import Traversal
from qbound.printable import printable

METRES: Final = {"m": 1.0, "cm": 0.01, "mm": 0.001}
"""Metres in a robot file's length unit."""

NANOSECOND, LONGEST = 1e-9, 2.0**31
"""Of times, in seconds, what ROS can say: 32 bits of seconds, and nanoseconds."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A joint path in time.

    Attributes
    ----------
    t : ndarray, shape (m,)
        Seconds from the start, rising.
    q, velocity : ndarray, shape (m, n)
        Joint values (rad or length) and speeds (a second); the robot rests at every stop.
    rows : ndarray of int, shape (m,)
        The row of the traversal for each entry; rows without motion are left out.
    """

    t: Floats
    q: Floats
    velocity: Floats
    rows: NDArray[np.int64]


def joint_speeds(robot: Robot) -> list[float]:
    """Return the largest speed of every joint, rad/s or length/s.

    Raises
    ------
    ValueError
        If the robot file has no speed for some joint.
    """
    missing = [joint.name for joint in robot.joints if joint.velocity is None]
    if missing:
        raise ValueError(
            f"{printable(robot.name)} states no `velocity` for {printable(', '.join(missing))}: "
            "add it to the robot file, or give the duration"
        )
    return [float(joint.velocity) for joint in robot.joints if joint.velocity is not None]


def timed(path: Traversal, speeds: ArrayLike) -> Trajectory:
    """Run a path as fast as the joints' speeds allow, with a rest at every stop.

    Between two rows the joints move in proportion, so that the path stays where it is; one of
    them is at its largest speed. In the first and the last interval of a leg the robot accelerates
    and brakes evenly. No joint is too fast, neither if positions are joined by straight lines nor
    if they are joined by cubics with the velocities, as in ROS. Except for these intervals the time
    is the shortest possible: the sum of ``max |dq_j| / speed_j``.

    Parameters
    ----------
    speeds : array_like, shape (n,)
        Largest speed of each joint, above zero.
    """
    limit = np.asarray(speeds, dtype=float)
    moved = np.abs(np.diff(path.q, axis=0)).max(axis=1) > 0
    rows = np.concatenate([[0], np.nonzero(moved)[0] + 1])
    q = path.q[rows]
    step = np.diff(q, axis=0)
    shortest = (np.abs(step) / limit).max(axis=1)
    rests = np.isin(path.s[rows], np.arange(len(path.legs) + 1))
    rests[[0, -1]] = True
    # From rest to rest the top speed is 1.5 of the mean, from rest to full speed twice the mean.
    factor = np.array([1.0, 2.0, 1.5])[rests[:-1].astype(int) + rests[1:]]
    time = shortest * factor
    velocity = _velocities(step / shortest[:, None], rests)
    slower = max(1.0, float((_top_speeds(step / time[:, None], velocity) / limit).max(initial=0)))
    t = np.concatenate([[0.0], np.cumsum(time * slower)])
    return Trajectory(t, q, velocity / slower, rows)


def stretched(trajectory: Trajectory, factor: float) -> Trajectory:
    """Run a trajectory slower by a factor (faster if it is below 1)."""
    velocity = trajectory.velocity / factor
    return Trajectory(trajectory.t * factor, trajectory.q, velocity, trajectory.rows)


def lasting(robot: Robot, path: Traversal, duration: float) -> Trajectory:
    """Run a path in a given time, s; joints without a stated speed may have any speed.

    Raises
    ------
    ValueError
        If the duration is not between `NANOSECOND` and `LONGEST`, or too short for a speed that
        the robot states.
    """
    if not NANOSECOND <= duration < LONGEST:
        raise ValueError(
            f"a duration must be above 0 s, a nanosecond or more, and below {LONGEST:g} s, "
            f"found {duration:g}"
        )
    speeds = [joint.velocity or math.inf for joint in robot.joints]
    fastest = timed(path, [speed if math.isfinite(speed) else 1.0 for speed in speeds])
    if len(fastest.t) < 2:
        return fastest
    result = stretched(fastest, duration / fastest.t[-1])
    used = top_speeds(result) / speeds
    if (used > 1 + 1e-9).any():
        j = int(used.argmax())
        raise ValueError(
            f"{duration:g} s is too short: {printable(robot.joints[j].name)} would need "
            f"{used[j]:.3g} times its velocity; {duration * used[j]:.6g} s is enough"
        )
    return result


def top_speeds(trajectory: Trajectory) -> Floats:
    """Return the largest speed of each joint, (n,), for cubics between the rows."""
    means = np.diff(trajectory.q, axis=0) / np.diff(trajectory.t)[:, None]
    return np.asarray(_top_speeds(means, trajectory.velocity).max(axis=0, initial=0))


def ros_trajectory(robot: Robot, trajectory: Trajectory) -> dict[str, Any]:
    """Return `joint_names` and `points` of a ROS JointTrajectory: radians, metres, seconds.

    Times are rounded up to nanoseconds and rise strictly.

    Raises
    ------
    ValueError
        If it lasts longer than a ROS message can hold.
    """
    if not trajectory.t[-1] < LONGEST:
        raise ValueError(f"{trajectory.t[-1]:g} s are more than ROS can say: {LONGEST:g} s")
    unit = [1.0 if joint.turns else METRES[robot.length_unit] for joint in robot.joints]
    steps = np.ceil(np.diff(trajectory.t) * 1e9).astype(np.int64)
    times = [0, *np.cumsum(np.maximum(steps, 1)).tolist()]
    rows = zip(times, trajectory.q * unit, trajectory.velocity * unit, strict=True)
    return {
        "joint_names": [joint.name for joint in robot.joints],
        "points": [_ros_point(time, q, velocity) for time, q, velocity in rows],
    }


def _ros_point(time: int, q: Floats, velocity: Floats) -> dict[str, Any]:
    seconds, nanoseconds = divmod(time, 10**9)
    return {
        "positions": q.tolist(),
        "velocities": velocity.tolist(),
        "time_from_start": {"sec": seconds, "nanosec": nanoseconds},
    }


def _velocities(between: Floats, rests: NDArray[np.bool_]) -> Floats:
    """Mean of the velocities before and after each row, 0 where the robot rests."""
    velocity = np.zeros((len(rests), between.shape[1]))
    velocity[1:-1] = (between[:-1] + between[1:]) / 2
    velocity[rests] = 0.0
    return velocity


def _top_speeds(means: Floats, velocity: Floats) -> Floats:
    """Largest speed of each joint in each interval of cubics with given ends, shape (m - 1, n).

    With u in [0, 1] along the interval the speed is ``a + b u + c u^2``, at most its ends' or
    that at ``-b / 2c``.
    """
    a, end = velocity[:-1], velocity[1:]
    b, c = 6 * means - 4 * a - 2 * end, 3 * (a + end) - 6 * means
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.where(c != 0, -b / (2 * c), 0.0)
    inner = np.where((u > 0) & (u < 1), a + b * u / 2, 0.0)
    return np.asarray(np.maximum(np.maximum(np.abs(a), np.abs(end)), np.abs(inner)))


def row_times(path: Traversal, trajectory: Trajectory) -> Floats:
    """Return the time of each row of a traversal, s; without motion the previous time."""
    index = np.searchsorted(trajectory.rows, np.arange(len(path.q)), side="right")
    return np.asarray(trajectory.t[index - 1])
