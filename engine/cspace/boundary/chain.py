"""Points carried along the chain, seen from the base or from a joint, for many configurations.

Every frame is turned so that the axis of its joint is z. Then a joint mixes two columns of a pose
by its cosine and sine, or adds a multiple of the third column. The other way along the chain undoes
the same step, so a joint can be the observer as well as the base.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cspace.arrays import Floats, Indices
from cspace.model.robot import Point, Robot

Pose = tuple[Floats, Floats]
"""Axes as columns, shape (3, 3, n), and origin, shape (3, n); n is 1 of what nothing moves."""


class Chain:
    """The chain of a robot with points on its frames, those nearer to the base first.

    Attributes
    ----------
    points : tuple of Point
        By the depth of their frames, else in the order given.
    depths : ndarray of int, shape (m,)
        How many steps move each point: a joint is one step, a parallelogram two.
    """

    def __init__(self, robot: Robot, points: Sequence[Point]) -> None:
        self.steps, self.depth = robot.steps, robot.steps_to
        self.points = tuple(sorted(points, key=lambda point: self.depth(point.frame)))
        self.depths = np.array([self.depth(point.frame) for point in self.points], dtype=np.intp)
        self._turned = [np.eye(3), *(axis_last(step.axis) for step in self.steps)]
        turned = self._turned
        numbered = list(enumerate(self.steps))
        self._moves = [turned[k].T @ step.origin for k, step in numbered]
        self._turns = [turned[k].T @ step.mount @ turned[k + 1] for k, step in numbered]
        at = np.array([p.at for p in self.points], dtype=float).reshape(-1, 3)
        ends = np.searchsorted(self.depths, np.arange(len(turned) + 1))
        self._slices = [slice(*ends[k : k + 2]) for k in range(len(turned))]
        self._places = [at[s] @ turn for s, turn in zip(self._slices, turned, strict=True)]

    def groups(self, joint: int) -> Indices:
        """Say on which side of a joint each point is, shape (m,).

        0 before the joint, 1 behind it. For a parallelogram: 1 on the bar, 2 on what the bar
        carries.
        """
        mine = [k for k, step in enumerate(self.steps) if step.joint == joint]
        return np.clip(self.depths - mine[0], 0, len(mine))

    def crank(self, joint: int) -> Floats | None:
        """Return the crank of a parallelogram, which turns: from its axis to what the bar carries.

        Seen from the joint, shape (3, 1, 1); None for other types of joints.
        """
        mine = [k for k, step in enumerate(self.steps) if step.joint == joint]
        return self._moves[mine[1]][:, None, None] if len(mine) > 1 else None

    def poses(self, q: Floats, joint: int | None = None) -> list[Pose]:
        """Return the pose of every frame, by its depth, seen from the base or from a joint.

        Parameters
        ----------
        q : ndarray, shape (joints, n)
            Configurations as columns.
        joint : int, optional
            The observer: this joint at its zero, at its frame's origin, z along its axis. Its own
            value is not read: what it moves stands as at 0. Of a parallelogram the frame is the
            bar's. Default the base.
        """
        values = [step.sense * q[step.joint] for step in self.steps]
        first = 0
        if joint is not None:
            mine = [k for k, step in enumerate(self.steps) if step.joint == joint]
            first = mine[0] + 1
            for k in mine:
                values[k] = np.zeros(1)
        here = np.eye(3)[..., None], np.zeros((3, 1))
        poses = [here]
        for k in range(first, len(self.steps)):
            poses.append(self._onward(poses[-1], k, values[k]))
        for k in reversed(range(first)):
            poses.insert(0, self._back(poses[0], k, values[k]))
        return poses

    def places(self, poses: Sequence[Pose]) -> Floats:
        """Return the coordinates of all points, shape (3, m, n)."""
        n = max(part.shape[-1] for pose in poses for part in pose)
        result = np.empty((3, len(self.points), n))
        for (axes, origin), here, at in zip(poses, self._slices, self._places, strict=True):
            if len(at):
                result[:, here] = at @ axes + origin[:, None]
        return result

    def _onward(self, pose: Pose, k: int, q: Floats) -> Pose:
        """Go beyond step k: translate, turn by its mount, then turn or slide by its value."""
        axes, origin = pose
        origin = origin + self._moves[k] @ axes
        axes = self._turns[k].T @ axes
        if self.steps[k].slides:
            return axes, origin + q * axes[:, 2]
        return _turned(axes, np.cos(q), np.sin(q)), origin

    def _back(self, pose: Pose, k: int, q: Floats) -> Pose:
        """Go from beyond step k to the frame before it."""
        axes, origin = pose
        if self.steps[k].slides:
            origin = origin - q * axes[:, 2]
        else:
            axes = _turned(axes, np.cos(q), -np.sin(q))
        axes = self._turns[k] @ axes
        return axes, origin - self._moves[k] @ axes


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
