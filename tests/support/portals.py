"""Robots of three slides: joint space is the space in which the hand moves."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from qbound.model.robot import HalfSpace, Point, Prismatic, Robot

AXES = np.eye(3)
NAMES = ["q0", "q1", "q2"]


def point(name, frame, at=(0, 0, 0), radius=0.0) -> Point:
    return Point(name, frame, np.array(at, dtype=float), radius)


def portal(points, boundaries, limits=(-1.0, 1.0)) -> Robot:
    """Three slides along the axes: what is forbidden is the obstacle itself."""
    joints = tuple(
        Prismatic(f"q{k}", str(k), str(k + 1), np.zeros(3), np.eye(3), AXES[k], limits)
        for k in range(3)
    )
    return Robot("portal", joints, points, boundaries, np.full(3, 0.9), "hand", "m", "rad")


def dice() -> Robot:
    """The hand stays within a cube of edge 1 that is turned."""
    turn = Rotation.from_euler("xyz", [0.3, 0.5, 0.2]).as_matrix()
    sides = [(k, sign) for k in range(3) for sign in (1, -1)]
    walls = tuple(HalfSpace(f"side {s}{k}", "hand", s * turn[k], -0.5) for k, s in sides)
    return portal((point("hand", "3"),), walls)
