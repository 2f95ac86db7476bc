"""Whole links instead of points: outlines in the plane of motion and the gaps between them.

Not in the paper, which prints points. The paper's points are corners of bodies, so its region can
be compared with a check of the bodies themselves. For arms that move in a plane.
"""

from collections.abc import Sequence
from itertools import combinations, product

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.boundary.poses import flat_parts
from cspace.boundary.separation import BodyMargins
from cspace.model.robot import Body, BodyPair, Robot
from cspace.tolerances import CONTACT


def outline(robot: Robot, body: Body, q: ArrayLike) -> Floats:
    """Return a body's outline at configurations of shape (..., n), in the plane of motion.

    Returns
    -------
    ndarray, shape (..., m, 2)
        Coordinates of `Robot.plane`, or x and z of a robot without one; length. For a body of the
        base the shape is (m, 2) for any `q`.
    """
    frames = robot.frames(np.asarray(q, dtype=float))
    turn = np.asarray(frames.rotation(robot.base, body.frame), dtype=float)
    origin = np.asarray(frames.position(robot.base, body.frame, robot.base), dtype=float)
    corners = outline_in_frame(robot, body)
    seen = corners @ np.swapaxes(turn, -1, -2) + origin[..., None, :]
    try:
        across = robot.plane.across
    except ValueError:
        across = np.eye(3)[[0, 2]]
    return np.asarray(seen @ across.T)


def outline_in_frame(robot: Robot, body: Body) -> Floats:
    """Return a body's outline seen from its frame, shape (m, 3)."""
    try:
        normal = robot.plane.normal_seen_from(body.frame)
    except ValueError:
        normal = np.eye(3)[1]
    return np.asarray(body.shape.outline(normal))


def gaps(robot: Robot, q: ArrayLike) -> dict[tuple[str, str], Floats]:
    """Return the gap of every two bodies on different frames by their names, each of shape (...).

    The gap is the margin of a pair of bodies with clearance 0, whatever the boundaries require.

    Parameters
    ----------
    q : array_like, shape (..., n)

    Raises
    ------
    ValueError
        If the robot leaves every plane, or a joint value is not finite.
    """
    pairs = [
        _pair(one, other)
        for one, other in combinations((*robot.bodies, *robot.obstacles), 2)
        if one.frame != other.frame
    ]
    margins = BodyMargins(robot, boundaries=pairs).margins(q)
    return {pair.bodies: margins[..., k] for k, pair in enumerate(pairs)}


def overlap_pairs(robot: Robot) -> list[tuple[str, str]]:
    """Return the pairs of bodies on different frames that are apart at home.

    An overlap of such a pair is an error.
    Neighbouring links that share a joint overlap at home too, because they are built so. The result
    is empty if the robot or its bodies leave every plane.
    """
    try:
        found = gaps(robot, robot.home)
    except ValueError:
        return []
    return [pair for pair, value in found.items() if value >= -CONTACT]


def overlaps(robot: Robot, q: ArrayLike) -> dict[tuple[str, str], float]:
    """Return how deep the bodies of `overlap_pairs` are inside each other; length.

    Parameters
    ----------
    q : array_like, shape (n,)

    Returns
    -------
    dict of (str, str) to float
        Only the pairs that overlap; empty if all bodies are apart.
    """
    pairs = overlap_pairs(robot)
    found = gaps(robot, q) if pairs else {}
    return {pair: -float(found[pair]) for pair in pairs if found[pair] < -CONTACT}


def contact_free_interval(robot: Robot, joint: int) -> tuple[float, float]:
    """Return the joint values around home between which two neighbouring links stay apart.

    Both ends come from conservative advancement: no place of either link moves faster about the
    joint than its distance from the axis, so a step of the gap over that speed passes no contact.

    Parameters
    ----------
    joint : int
        The joint between the two links. The other joints stand at home; their values do not matter.

    Returns
    -------
    tuple of float
        Low and high end, rad or length. If nothing touches, a full turn to either side, or the
        joint's limits.

    Raises
    ------
    ValueError
        If either link has no body, or the robot leaves every plane.
    """
    moved = robot.joints[joint]
    near, far = (_bodies(robot, frame) for frame in (moved.parent, moved.frame))
    separation = BodyMargins(robot, boundaries=[_pair(*both) for both in product(near, far)])
    speed = _largest_motion(robot, near, far, joint)
    home = float(robot.home[joint])
    low, high = moved.limits or (home - 2 * np.pi, home + 2 * np.pi)
    return (
        max(low, _advance(separation, speed, joint, -1, home - low)),
        min(high, _advance(separation, speed, joint, +1, high - home)),
    )


def _advance(separation: BodyMargins, speed: float, joint: int, sense: int, most: float) -> float:
    """Go from home until the links touch or `most` is passed; return the joint value."""
    q = np.array(separation.robot.home, dtype=float)
    start = q[joint]
    while abs(q[joint] - start) < most:
        apart = float(separation.margins(q).min())
        if apart <= CONTACT * speed:
            break
        q[joint] += sense * apart / speed
    return float(q[joint])


def _largest_motion(robot: Robot, near: Sequence[Body], far: Sequence[Body], joint: int) -> float:
    """Return the most that a place of either link moves, seen from the other, a unit of joint."""
    moved = robot.joints[joint]
    if not moved.turns:
        return 1.0
    axis = robot.plane.flat(moved.parent, moved.origin[None])
    reach = [
        float(np.linalg.norm(core - centre, axis=-1).max()) + radius
        for bodies, centre in ((near, axis), (far, np.zeros(2)))
        for body in bodies
        for core, radius in flat_parts(robot, body)
    ]
    return max(reach)


def _bodies(robot: Robot, frame: str) -> list[Body]:
    found = [body for body in robot.bodies if body.frame == frame]
    if not found:
        raise ValueError(f"{robot.name} has no body in frame {frame!r}")
    return found


def _pair(one: Body, other: Body) -> BodyPair:
    return BodyPair(f"{one.name}, {other.name}", (one.name, other.name))
