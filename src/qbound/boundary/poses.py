"""Poses of a frame in the plane of motion, seen from another frame, many at a time.

In the axes of the plane a pose is a turn and a translation. The coordinate of a place of one frame
along a direction of the other is linear in the pose: a row of numbers times a column `POSE`.
"""

from __future__ import annotations

import numpy as np

from qbound.arrays import Floats
from qbound.model.robot import Robot

POSE = 7
"""Rows of a pose: cosine and sine of its turn, its origin (x, y) seen from the observer, the same
vector seen from the turned frame, and 1."""


class PlanePoses:
    """Poses of the frames of a robot in its plane of motion, frames by their depth in the chain.

    Raises
    ------
    ValueError
        If the robot leaves every plane.
    """

    def __init__(self, robot: Robot) -> None:
        plane, base = robot.plane, robot.base
        turns = [np.asarray(plane.frames.rotation(base, j.parent), float) for j in robot.joints]
        moves = [plane.across @ turn for turn in turns]
        self._origins = [move @ j.origin for move, j in zip(moves, robot.joints, strict=True)]
        axes = [move @ j.mount @ j.axis for move, j in zip(moves, robot.joints, strict=True)]
        self._slides = [axis * (not j.turns) for axis, j in zip(axes, robot.joints, strict=True)]
        self._senses = plane.senses
        self._lengths = [
            float(np.linalg.norm(j.origin)) + (0.0 if j.turns else j.farthest) for j in robot.joints
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
            Depths; equal ones are the frame itself.

        Returns
        -------
        dict of (near, far) to ndarray, shape (POSE, n)
        """
        columns = np.ascontiguousarray(q.T)
        turning = {j for near, far in pairs for j in range(near, far) if self._senses[j]}
        turns = {j: (np.cos(columns[j]), self._senses[j] * np.sin(columns[j])) for j in turning}
        return {pair: self._pose(columns, turns, *pair) for pair in pairs}

    def _pose(
        self, columns: Floats, turns: dict[int, tuple[Floats, Floats]], near: int, far: int
    ) -> Floats:
        c, s, x, y = (np.full(columns.shape[1], value) for value in (1.0, 0.0, 0.0, 0.0))
        for j in range(near, far):
            (u, v), (du, dv) = self._origins[j], self._slides[j]
            u, v = u + du * columns[j], v + dv * columns[j]
            x, y = x + c * u - s * v, y + s * u + c * v
            if j in turns:
                cj, sj = turns[j]
                c, s = c * cj - s * sj, s * cj + c * sj
        return np.stack([c, s, x, y, c * x + s * y, c * y - s * x, np.ones_like(c)])


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
