"""Where do points stand, seen from the base or from a joint? Many configurations at a time.

Every frame is turned here so that the axis of its joint is z: then a joint mixes two columns of a
pose by its cosine and sine, or adds a multiple of the third. The other way along the chain is the
same step undone, so that a joint may be the observer as well as the base. A parallelogram is no
such step: it is refused by name.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from qbound.model.robot import Parallelogram, Point, Robot
from qbound.printable import printable

Floats = NDArray[np.float64]
Pose = tuple[Floats, Floats]
"""Axes as columns, shape (3, 3, n), and origin, shape (3, n); n is 1 of what nothing moves."""


class Chain:
    """The chain of a robot with points on its frames, those nearer to the base first.

    Attributes
    ----------
    points : tuple of Point
        By the depth of their frames, else in the order given.
    depths : ndarray of int, shape (m,)
        How many joints move each of them.

    Raises
    ------
    ValueError
        If a joint is a parallelogram.
    """

    def __init__(self, robot: Robot, points: Sequence[Point]) -> None:
        refuse_parallelograms(robot, "places are carried along turning and sliding joints only")
        self.points = tuple(sorted(points, key=lambda point: robot.depth(point.frame)))
        self.depths = np.array([robot.depth(point.frame) for point in self.points], dtype=np.intp)
        self._sliding = [not joint.turns for joint in robot.joints]
        self._turned = [np.eye(3), *(axis_last(joint.axis) for joint in robot.joints)]
        turned = self._turned
        joints = list(enumerate(robot.joints))
        self._moves = [turned[j].T @ joint.origin for j, joint in joints]
        self._turns = [turned[j].T @ joint.mount @ turned[j + 1] for j, joint in joints]
        at = np.array([p.at for p in self.points], dtype=float).reshape(-1, 3)
        ends = np.searchsorted(self.depths, np.arange(len(turned) + 1))
        self._slices = [slice(*ends[k : k + 2]) for k in range(len(turned))]
        self._places = [at[s] @ turn for s, turn in zip(self._slices, turned, strict=True)]

    def poses(self, q: Floats, joint: int | None = None) -> list[Pose]:
        """Return the pose of every frame, by its depth, seen from the base or from a joint.

        Parameters
        ----------
        q : ndarray, shape (joints, n)
            Configurations as columns.
        joint : int, optional
            The observer: this joint at its zero, at its frame's origin, z along its axis. Its own
            value is not read: what it moves stands as at 0. Default the base.
        """
        first = 0 if joint is None else joint + 1
        here = np.eye(3)[..., None], np.zeros((3, 1))
        poses = [here]
        for j in range(first, len(q)):
            poses.append(self._onward(poses[-1], j, q[j]))
        if joint is not None:
            poses.insert(0, self._back(here, joint, np.zeros(1)))
            for j in reversed(range(joint)):
                poses.insert(0, self._back(poses[0], j, q[j]))
        return poses

    def places(self, poses: Sequence[Pose]) -> Floats:
        """Return the coordinates of all points, shape (3, m, n)."""
        n = max(part.shape[-1] for pose in poses for part in pose)
        result = np.empty((3, len(self.points), n))
        for (axes, origin), here, at in zip(poses, self._slices, self._places, strict=True):
            if len(at):
                result[:, here] = at @ axes + origin[:, None]
        return result

    def seen(self, direction: Floats, depth: int) -> Floats:
        """Return a direction of a robot's frame as the same frame sees it here, shape (3,)."""
        return np.asarray(direction @ self._turned[depth])

    def _onward(self, pose: Pose, j: int, q: Floats) -> Pose:
        """Go beyond joint j: move, turn as it is mounted, then as its value says."""
        axes, origin = pose
        origin = origin + self._moves[j] @ axes
        axes = self._turns[j].T @ axes
        if self._sliding[j]:
            return axes, origin + q * axes[:, 2]
        return _turned(axes, np.cos(q), np.sin(q)), origin

    def _back(self, pose: Pose, j: int, q: Floats) -> Pose:
        """Go from beyond joint j to the frame before it."""
        axes, origin = pose
        if self._sliding[j]:
            origin = origin - q * axes[:, 2]
        else:
            axes = _turned(axes, np.cos(q), -np.sin(q))
        axes = self._turns[j] @ axes
        return axes, origin - self._moves[j] @ axes


def refuse_parallelograms(robot: Robot, why: str) -> None:
    """Refuse, by name, a joint that moves two frames and turns only one of them.

    Parameters
    ----------
    why : str
        What cannot be done with it.

    Raises
    ------
    ValueError
        If there is one.
    """
    for joint in robot.joints:
        if isinstance(joint, Parallelogram):
            raise ValueError(f"joint {printable(joint.name)!r} is a parallelogram: {why}")


def axis_last(axis: Floats) -> Floats:
    """Return a rotation whose third column is a unit vector; whole numbers for whole numbers."""
    axis = np.asarray(axis, dtype=float)
    across = np.eye(3)[np.argmin(np.abs(axis))]
    across = across - (across @ axis) * axis
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(axis, across), axis], axis=1)


def _turned(axes: Floats, c: Floats, s: Floats) -> Floats:
    """Turn axes about their third one."""
    x, y, z = axes[:, 0], axes[:, 1], axes[:, 2]
    x, y = c * x + s * y, c * y - s * x
    return np.stack([x, y, np.broadcast_to(z, x.shape)], axis=1)
