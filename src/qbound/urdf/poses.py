"""Poses of one frame in another: a rotation and a translation, and their composition."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from qbound.arrays import Floats


class Pose(NamedTuple):
    """A frame seen from another: its rotation, shape (3, 3), and its origin, shape (3,)."""

    rotation: Floats
    origin: Floats

    @classmethod
    def still(cls) -> Pose:
        """Return that of a frame in itself."""
        return cls(np.eye(3), np.zeros(3))

    def then(self, other: Pose) -> Pose:
        """Return the pose, seen from here, of what `other` says seen from this frame."""
        return Pose(self.rotation @ other.rotation, self.places(other.origin))

    def inverse(self) -> Pose:
        """Return the observer's frame, seen from this one."""
        return Pose(self.rotation.T, -(self.rotation.T @ self.origin))

    def places(self, x: Floats) -> Floats:
        """Return places of this frame, shape (..., 3), as the observer sees them."""
        return np.asarray(self.origin + x @ self.rotation.T)
