"""How far may digits be off? Those of the print, what they do to a contact; those of doubles."""

from __future__ import annotations

from typing import Any

import numpy as np

from lizarraga2025.evidence.arms import robot
from qbound.model.robot import Pair, Robot

HALF_DIGIT = 0.005
"""Largest error of a length rounded to two decimals, cm."""

SMALL = 1e-9
"""A length (cm) or angle (rad) that is rounding: offsets carry 1e-2, roundoff leaves 1e-13."""


def degrees(angle: Any) -> str:
    """Write an angle in rad as degrees with four decimals."""
    return f"{np.degrees(float(angle)):.4f}°"


def counted(number: int, noun: str) -> str:
    """Write how many there are of something: one curve, 2 curves."""
    return f"one {noun}" if number == 1 else f"{number} {noun}s"


def _arms(of: Robot, pair: Pair) -> tuple[np.ndarray, np.ndarray]:
    """Return the vectors from the joint between a pair's points to the points, cm, home pose."""
    near, far = (of.point(name) for name in pair.points)
    joint = next(joint for joint in of.joints if joint.frame == far.frame)
    return near.at - joint.origin, far.at


def radii(of: Robot, pair: Pair) -> tuple[float, float]:
    """Return the distances of a pair's points from the joint between them, cm."""
    first, second = (float(np.linalg.norm(arm)) for arm in _arms(of, pair))
    return first, second


def contact(pair: Pair) -> float:
    """Return the largest gap, cm, that rounding of the offsets can leave to points that meet.

    To first order a radius changes by at most the sum of the rounding errors of its components,
    each times its direction cosine. The joint between the points is printed too: its two offsets
    add their own error, as those of a point do.
    """
    first, second = _arms(robot(), pair)
    slopes = (np.abs(v).sum() / np.linalg.norm(v) for v in (first, second, first))
    return float(sum(HALF_DIGIT * slope for slope in slopes))


def at_a_root(slope: np.ndarray, component: int) -> float:
    """Return the largest distance, cm, of points that meet, where one printed component vanishes.

    Each component carries up to four rounded offsets, two of them turned by the joint. The error of
    the vanishing one shifts the root, and the other then changes by the ratio of the slopes.

    Parameters
    ----------
    slope : ndarray, shape (3,)
        Derivative of the pair's vector along the joint, cm.
    component : int
        The component that vanishes.
    """
    error = HALF_DIGIT * (2 + np.sqrt(2))
    return float(error * (1 + np.linalg.norm(np.delete(slope, component)) / abs(slope[component])))


def grid_error(inside: np.ndarray, cell: float) -> float:
    """Bound the error of an area that was counted on a grid of one turn of both joints.

    A cell whose neighbours answer alike is taken for what its middle says; the others may be in or
    out. What is smaller than a cell and missed by every middle is not seen.

    Parameters
    ----------
    inside : ndarray of bool, shape (n, n)
        The answer at the middle of each cell.
    cell : float
        Area of a cell.
    """
    beside = [inside != np.roll(inside, step, axis) for axis in (0, 1) for step in (1, -1)]
    return float(cell * np.any(beside, axis=0).sum())
