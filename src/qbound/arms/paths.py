"""Circles and lines along which one joint carries the tool, with the tool's direction on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.boundary.chain import Chain
from qbound.model.robot import Robot


@dataclass(frozen=True, eq=False)
class Paths:
    """Vectors as forms of one joint, seen from the base: n paths.

    Attributes
    ----------
    place : ndarray, shape (3, 3, n)
        Coefficients of (1, cos q, sin q) or (1, q, 0), by coordinates; length.
    direction : ndarray, shape (3, 3, n)
        Those of a unit vector fixed to the tool's frame.
    turns : bool
        Whether the joint turns.
    """

    place: Floats
    direction: Floats
    turns: bool

    def __getitem__(self, which: NDArray[np.intp]) -> Paths:
        """Take some of the paths."""
        return Paths(self.place[..., which], self.direction[..., which], self.turns)

    def places(self, q: Floats) -> Floats:
        """Return the place on each path at one joint value each, shape (3, n)."""
        return self._at(self.place, q)

    def directions(self, q: Floats) -> Floats:
        """Return the direction on each path at one joint value each, shape (3, n)."""
        return self._at(self.direction, q)

    def _at(self, form: Floats, q: Floats) -> Floats:
        if self.turns:
            return np.asarray(form[0] + np.cos(q) * form[1] + np.sin(q) * form[2])
        return np.asarray(form[0] + q * form[1])


class ToolPaths:
    """The paths of a robot's tool along each joint.

    Parameters
    ----------
    axis : array_like, shape (3,)
        A direction fixed to the tool's frame.
    """

    def __init__(self, robot: Robot, axis: Floats) -> None:
        tool = robot.point(robot.tool)
        self.robot, self.depth = robot, robot.depth(tool.frame)
        self._chain = Chain(robot, [tool])
        self._frame = self._chain.depth(tool.frame)
        self._axis = self._chain.seen(axis, self._frame)

    def along(self, joint: int, q: Floats) -> Paths:
        """Return the paths along a joint that carries the tool.

        Parameters
        ----------
        q : ndarray, shape (joints, n)
            Configurations as columns; the joint's own value is not read.
        """
        poses = self._chain.poses(q, joint)
        (base, origin), (tool_axes, _) = poses[0], poses[self._frame]
        x, u = self._chain.places(poses)[:, 0], self._axis @ tool_axes
        x, u, origin = (np.broadcast_to(each, (3, q.shape[1])) for each in (x, u, origin))
        zero = np.zeros(q.shape[1])
        if self.robot.joints[joint].turns:
            crank = self._chain.crank(joint)
            if crank is not None and self._chain.groups(joint)[0] == 2:
                (a, b), turning = crank[:2, 0] + zero, zero
                ahead = x - origin - np.array([a, b, zero])
            else:
                (a, b), turning = x[:2], zero + 1
                ahead = np.array([zero, zero, x[2]]) - origin
            place = [list(ahead), [a, b, zero], [-b, a, zero]]
            about = [[u[0], u[1], zero], [-u[1], u[0], zero]]
            direction = [list(u - turning * about[0]), *(turning * np.array(about))]
        else:
            place = [list(x - origin), [zero, zero, zero + 1], [zero, zero, zero]]
            direction = [list(u), [zero] * 3, [zero] * 3]
        places, directions = (
            np.einsum("ijn,kin->kjn", base, np.array(each)) for each in (place, direction)
        )
        return Paths(places, directions, self.robot.joints[joint].turns)
