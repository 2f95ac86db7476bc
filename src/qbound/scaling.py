"""How far a polygon in joint space must shrink until it is feasible (Figure 6)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound import polygon
from qbound.arrays import Floats
from qbound.forms import HarmonicForm

STARTS: Final = 400
"""Pieces of an edge between whose ends the search for the least value starts."""


@dataclass(frozen=True, eq=False)
class Least:
    """The least value of a form on a line or polygon, and the joint values q, shape (n,), there."""

    value: float
    q: Floats


def least_along(form: HarmonicForm, start: ArrayLike, end: ArrayLike) -> Least:
    """Return the least value of a form on a straight line in joint space.

    The least of 401 points of the line is moved by Newton's method to where the slope along the
    line is zero.

    Parameters
    ----------
    start, end : array_like, shape (n,)
        Joint values.

    Examples
    --------
    >>> from qbound import clearance, load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> least = least_along(clearance(robot, robot.boundary("B7")), [0.8, -0.5], [0.9, 0.5])
    >>> round(least.value, 3), least.q.round(3).tolist()
    (-9.057, [0.9, 0.5])
    """
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    step, points = end - start, np.linspace(0, 1, STARTS + 1)
    t = points[int(np.argmin(form(start + points[:, None] * step)))]
    for _ in range(8):
        q = start + t * step
        slope, curvature = form.gradient(q) @ step, step @ form.hessian(q) @ step
        if curvature <= 0:
            break  # least at an end
        t = np.clip(t - slope / curvature, 0, 1)
    q = start + t * step
    return Least(float(form(q)), q)


def least_on_edges(form: HarmonicForm, vertices: ArrayLike) -> Least:
    """Return the least value of a form on the edges of a closed polygon, shape (m, n).

    Examples
    --------
    >>> from qbound import clearance, load_robot, window_region
    >>> robot = load_robot("minervabot-v2")
    >>> height = clearance(robot, robot.boundary("B7"))
    >>> round(least_on_edges(height, window_region(robot).polygon).value, 3)
    -3.023
    """
    p = np.asarray(vertices, dtype=float)
    edges = zip(p, np.roll(p, -1, axis=0), strict=True)
    return min((least_along(form, *edge) for edge in edges), key=lambda least: least.value)


@dataclass(frozen=True, eq=False)
class Scale:
    """The largest feasible scale, and the point q at which the scaled polygon touches."""

    scale: float
    q: Floats


def largest_scale(form: HarmonicForm, vertices: ArrayLike, centre: ArrayLike) -> Scale:
    r"""Return the scale s at which the least value of a form on ``g + s (p - g)`` is zero.

    Newton's method from s = 1. As the polygon shrinks, the point q of the least value moves towards
    the centre g, so the least value changes by :math:`\nabla\beta(q) \cdot (q - g) / s`. For a
    convex polygon that holds its centre every smaller scale is feasible too.

    Parameters
    ----------
    form : HarmonicForm
        Not negative where feasible, such as `clearance`.
    vertices : array_like, shape (m, n)
    centre : array_like, shape (n,)

    Raises
    ------
    ValueError
        If no scale above 0 is found.

    Examples
    --------
    >>> from qbound import clearance, load_robot, window_region
    >>> robot = load_robot("minervabot-v2")
    >>> p = window_region(robot).polygon
    >>> height = clearance(robot, robot.boundary("B7"))
    >>> round(largest_scale(height, p, polygon.centroid(p)).scale, 6)
    0.964038
    """
    p, g, scale = np.asarray(vertices, dtype=float), np.asarray(centre, dtype=float), 1.0
    for _ in range(50):
        least = least_on_edges(form, polygon.scaled(p, scale, g))
        change = least.value / (form.gradient(least.q) @ (least.q - g) / scale)
        scale -= float(change)
        if not scale > 0:
            break
        if abs(change) < 1e-14:
            return Scale(scale, least.q)
    raise ValueError("no scale above 0 makes the polygon feasible: is its centre feasible?")
