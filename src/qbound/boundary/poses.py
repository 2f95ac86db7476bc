"""Poses of a frame in the plane of motion, seen from another frame, many at a time.

In the axes of the plane a pose is a turn and a translation. The coordinate of a place of one frame
along a direction of the other is linear in the pose: a row of numbers times a column `POSE`.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from qbound.arrays import Floats
from qbound.model.robot import Robot

POSE = 7
"""Rows of a pose: cosine and sine of its turn, its origin (x, y) seen from the observer, the same
vector seen from the turned frame, and 1."""


class PlanePoses:
    """Poses of the frames of a robot in its plane of motion, frames by the steps to them.

    Raises
    ------
    ValueError
        If the robot leaves every plane.
    """

    def __init__(self, robot: Robot) -> None:
        self._senses, self._joints = robot.plane.senses, [step.joint for step in robot.steps]
        self._origins, self._slides = zip(*flat_steps(robot), strict=True)
        self._lengths = [
            float(np.linalg.norm(step.origin))
            + (robot.joints[step.joint].farthest if step.slides else 0.0)
            for step in robot.steps
        ]

    def length(self, near: int, far: int) -> float:
        """Return the length of the chain between two frames, stretched out."""
        return sum(self._lengths[near:far])

    def of(self, q: Floats, pairs: set[tuple[int, int]]) -> dict[tuple[int, int], Floats]:
        """Return the pose of a frame seen from one nearer to the base, for each of some pairs.

        Parameters
        ----------
        q : ndarray, shape (n, joints)
        pairs : set of (near, far)
            Numbers of steps from the base; equal ones are the frame itself.

        Returns
        -------
        dict of (near, far) to ndarray, shape (POSE, n)
        """
        columns = np.ascontiguousarray(q.T)
        steps = {k for near, far in pairs for k in range(near, far) if self._senses[k]}
        turning = {self._joints[k] for k in steps}
        known = {j: (np.cos(columns[j]), np.sin(columns[j])) for j in turning}
        both = ((k, known[self._joints[k]]) for k in steps)
        turns = {k: (cosine, self._senses[k] * sine) for k, (cosine, sine) in both}
        return {pair: self._pose(columns, turns, *pair) for pair in pairs}

    def _pose(
        self, columns: Floats, turns: dict[int, tuple[Floats, Floats]], near: int, far: int
    ) -> Floats:
        c, s, x, y = (np.full(columns.shape[1], value) for value in (1.0, 0.0, 0.0, 0.0))
        for k in range(near, far):
            (u, v), (du, dv) = self._origins[k], self._slides[k]
            value = columns[self._joints[k]]
            u, v = u + du * value, v + dv * value
            x, y = x + c * u - s * v, y + s * u + c * v
            if k in turns:
                ck, sk = turns[k]
                c, s = c * ck - s * sk, s * ck + c * sk
        return np.stack([c, s, x, y, c * x + s * y, c * y - s * x, np.ones_like(c)])


def flat_steps(robot: Robot) -> Iterator[tuple[Floats, Floats]]:
    """Yield origin and direction of slide of each step in the axes of the plane, shape (2,) each.

    They are turned as at all joint values 0; the direction of a turn is zero.
    """
    plane = robot.plane
    for step in robot.steps:
        turn = np.asarray(plane.frames.rotation(robot.base, step.parent), dtype=float)
        move = plane.across @ turn
        along = move @ step.mount @ step.axis * (step.sense if step.slides else 0)
        yield move @ step.origin, along


def of_far_places(direction: Floats, places: Floats, level: Floats) -> Floats:
    """Return rows whose product with a pose is ``direction . (place seen from near) - level``.

    Parameters
    ----------
    direction : ndarray, shape (..., 2)
        Fixed in the nearer frame.
    places : ndarray, shape (..., 2)
        Fixed in the farther frame.
    level : ndarray, shape (...)

    Returns
    -------
    ndarray, shape (..., POSE)
    """
    (nx, ny), (px, py) = np.moveaxis(direction, -1, 0), np.moveaxis(places, -1, 0)
    zero = np.zeros_like(nx)
    terms = (nx * px + ny * py, ny * px - nx * py, nx, ny, zero, zero, -level)
    return np.stack(np.broadcast_arrays(*terms), axis=-1)


def of_near_places(direction: Floats, places: Floats, level: Floats) -> Floats:
    """Return rows as `of_far_places` does, of places of the nearer frame seen from the farther."""
    (nx, ny), (px, py) = np.moveaxis(direction, -1, 0), np.moveaxis(places, -1, 0)
    zero = np.zeros_like(nx)
    terms = (nx * px + ny * py, nx * py - ny * px, zero, zero, -nx, -ny, -level)
    return np.stack(np.broadcast_arrays(*terms), axis=-1)
