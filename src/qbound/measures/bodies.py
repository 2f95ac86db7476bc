"""Whole links instead of points: convex outlines in the plane of motion and the gap between them.

Not in the paper, which prints points. The points are corners of bodies, so its region can be held
against a check of the bodies themselves. For arms that move in a plane.
"""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.geometry.polylines import cross
from qbound.model.robot import Body, Polygon, Robot
from qbound.tolerances import CONTACT, ZERO_AMPLITUDE

Floats = NDArray[np.float64]


def outline(robot: Robot, body: Body, q: ArrayLike, deviation: float | None = None) -> Floats:
    """Return a body's outline at configurations of shape (..., n), in the plane of motion.

    Parameters
    ----------
    deviation : float, optional
        Largest distance of a chord from a round end, length; default: one that no eye can see.

    Returns
    -------
    ndarray, shape (..., m, 2)
        Coordinates of `Robot.plane`, or x and z of a robot without one; length. For a body of the
        base, shape (m, 2) whatever `q` is.
    """
    frames = robot.frames(np.asarray(q, dtype=float))
    turn = np.asarray(frames.rotation(robot.base, body.frame), dtype=float)
    origin = np.asarray(frames.position(robot.base, body.frame, robot.base), dtype=float)
    corners = outline_in_frame(robot, body, deviation)
    seen = corners @ np.swapaxes(turn, -1, -2) + origin[..., None, :]
    try:
        across = robot.plane.across
    except ValueError:
        across = np.eye(3)[[0, 2]]
    return np.asarray(seen @ across.T)


def outline_in_frame(robot: Robot, body: Body, deviation: float | None = None) -> Floats:
    """Return a body's outline seen from its frame, shape (m, 3); `deviation` as in `outline`."""
    try:
        normal = robot.plane.normal_seen_from(body.frame)
    except ValueError:
        normal = np.eye(3)[1]
    return np.asarray(body.shape.outline(deviation, normal))


def gap(one: ArrayLike, other: ArrayLike) -> Floats:
    """Return how far two convex outlines are apart, negative by how deep they overlap.

    It is the largest gap that any edge's normal shows (separating axis theorem): at most the
    distance where it is positive, zero where they touch, and the shortest way out where it is
    negative.

    Parameters
    ----------
    one, other : array_like, shapes (..., m, 2) and (..., k, 2)
        Corners in order, either way round; broadcast against each other.

    Raises
    ------
    ValueError
        If an outline is not convex.
    """
    p, r = _anticlockwise(one), _anticlockwise(other)
    return np.asarray(np.maximum(_beyond_edges(p, r), _beyond_edges(r, p)))


def gaps(robot: Robot, q: ArrayLike) -> dict[tuple[str, str], Floats]:
    """Return the gap of every two bodies on different frames by their names, each of shape (...).

    Parameters
    ----------
    q : array_like, shape (..., n)

    Raises
    ------
    ValueError
        If a body is no convex polygon.
    """
    q = np.asarray(q, dtype=float)
    return {
        (one.name, other.name): np.broadcast_to(
            gap(_corners(robot, one, q), _corners(robot, other, q)), q.shape[:-1]
        )
        for one, other in combinations((*robot.bodies, *robot.obstacles), 2)
        if one.frame != other.frame
    }


def contact_free_interval(robot: Robot, joint: int) -> tuple[float, float]:
    """Return the joint values around home between which two neighbouring bodies stay apart.

    Both ends come from conservative advancement: no corner of either body moves faster about the
    joint than its distance from the axis, so a step of the gap over that speed passes no contact.

    Parameters
    ----------
    joint : int
        The joint between the two bodies; the others stand at home, which does not matter to them.

    Returns
    -------
    tuple of float
        rad or length; a full turn to either side, or the joint's limits, where nothing touches.

    Raises
    ------
    ValueError
        If either link has no body, or several, or one that is no convex polygon.
    """
    moved = robot.joints[joint]
    near, far = (_body(robot, frame) for frame in (moved.parent, moved.frame))
    home = float(robot.home[joint])
    low, high = moved.limits or (home - 2 * np.pi, home + 2 * np.pi)
    return (
        max(low, _advance(robot, near, far, joint, -1, home - low)),
        min(high, _advance(robot, near, far, joint, +1, high - home)),
    )


def _advance(robot: Robot, near: Body, far: Body, joint: int, sense: int, most: float) -> float:
    """Go from home until the bodies touch or `most` is passed; return the joint value."""
    q = np.array(robot.home, dtype=float)
    speed = _largest_motion(robot, near, far, joint)
    start = q[joint]
    while abs(q[joint] - start) < most:
        apart = float(gap(_corners(robot, near, q), _corners(robot, far, q)))
        if apart <= CONTACT * speed:
            break
        q[joint] += sense * apart / speed
    return float(q[joint])


def _largest_motion(robot: Robot, near: Body, far: Body, joint: int) -> float:
    """Return the most that a corner of either body moves, seen from the other, a unit of joint."""
    if not robot.joints[joint].turns:
        return 1.0
    frames = robot.frames(robot.home)
    axis = robot.plane.across @ frames.position(robot.base, robot.joints[joint].frame, robot.base)
    corners = [outline(robot, body, robot.home) for body in (near, far)]
    return float(np.linalg.norm(np.concatenate(corners) - axis, axis=-1).max())


def _body(robot: Robot, frame: str) -> Body:
    found = [body for body in robot.bodies if body.frame == frame]
    if len(found) != 1:
        count = f"{len(found)} bodies" if found else "no body"
        raise ValueError(f"{robot.name} has {count} in frame {frame!r}; one is wanted")
    return found[0]


def _corners(robot: Robot, body: Body, q: ArrayLike) -> Floats:
    """Return the corners of a body that is a polygon, as `outline` does."""
    if not isinstance(body.shape, Polygon):
        text = f"body {body.name!r} is a {body.shape.key}; gaps are of convex polygons alone"
        raise ValueError(text)
    return outline(robot, body, q)


def _anticlockwise(outline: ArrayLike) -> Floats:
    """Return the corners anticlockwise; refuse an outline that is not convex."""
    p = np.asarray(outline, dtype=float)
    step = np.roll(p, -1, axis=-2) - p
    turn = cross(step, np.roll(step, -1, axis=-2))
    rounding = ZERO_AMPLITUDE * (step**2).sum(axis=-1).max()
    left, right = ((sense * turn >= -rounding).all(axis=-1) for sense in (1, -1))
    if not (left | right).all():
        raise ValueError("the outline of a body must be convex")
    return np.asarray(np.where(left[..., None, None], p, p[..., ::-1, :]))


def _beyond_edges(p: Floats, r: Floats) -> Any:
    """Largest, over the edges of p, of the least distance of r's corners beyond that edge."""
    step = np.roll(p, -1, axis=-2) - p
    normal = np.stack([step[..., 1], -step[..., 0]], axis=-1)
    normal = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
    edge = (normal * p).sum(axis=-1)
    beyond = np.einsum("...ei,...ci->...ec", normal, r) - edge[..., None]
    return beyond.min(axis=-1).max(axis=-1)
