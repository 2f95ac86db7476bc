"""How far a polygon in joint space must shrink until it is feasible (Figure 6).

The polygon through the corners of the region has straight edges where the region has curves, so
parts of it are not feasible. The paper scales it about its centroid g: each point p becomes
``g + s (p - g)``. Figure 6 shows one scale s; here the largest one is found.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound import polygon
from qbound.arrays import Floats
from qbound.forms import HarmonicForm

STARTS: Final = 400
"""The search for the least value on an edge starts at the least of so many points, and one more."""

SCALES: Final = 128
"""Scales between 0 and 1 that are tried, in ascending order, for the first infeasible one."""

SAMPLES: Final = 64
"""Points of each edge at which a scale is tried."""


@dataclass(frozen=True, eq=False)
class Least:
    """The least value of a form on a line or polygon, and the joint values q, shape (n,), there.

    The value has the unit of the form: a length of a half-space, a length squared of a pair.
    """

    value: float
    q: Floats


def least_along(form: HarmonicForm, start: ArrayLike, end: ArrayLike) -> Least:
    """Return the least value of a form on a straight line in joint space.

    The least of 401 points of the line is moved by Newton's method to where the slope along the
    line is zero.

    Parameters
    ----------
    form : HarmonicForm
        A single form, such as `clearance`.
    start, end : array_like, shape (n,)
        Joint values.

    Examples
    --------
    >>> from qbound import clearance, load_robot
    >>> from qbound.scaling import least_along
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
            break  # no minimum within the line is near: the least value is at an end
        t = np.clip(t - slope / curvature, 0, 1)
    q = start + t * step
    return Least(float(form(q)), q)


def least_on_edges(form: HarmonicForm, vertices: ArrayLike) -> Least:
    """Return the least value of a form on the edges of a closed polygon, shape (m, n).

    Examples
    --------
    On the polygon of Figure 5 the tool is up to 3.023 cm below its limit:

    >>> from qbound import clearance, load_robot, window_region
    >>> from qbound.scaling import least_on_edges
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
    """The largest feasible scale, and the point q, shape (n,), at which the scaled polygon touches.

    If no scale is infeasible, the scale is infinite and q is NaN.
    """

    scale: float
    q: Floats


def largest_scale(form: HarmonicForm, vertices: ArrayLike, centre: ArrayLike) -> Scale:
    r"""Return the largest scale s up to which no edge of ``g + s (p - g)`` has a negative value.

    All smaller scales are feasible too. So the form is not negative in the whole scaled polygon, if
    the polygon is convex and holds the centre. The scale is above 1 if the polygon can grow. For
    several boundaries take the least of their scales.

    The scales 1/128, 2/128, ... are tried at 64 points of each edge until one is infeasible. An
    infeasible part of joint space that lies between these points is missed. From that scale on,
    Newton's method looks for the scale at which the least value is 0. As the polygon shrinks, the
    point q of the least value moves towards the centre g, so the least value changes with s at the
    rate :math:`\nabla\beta(q) \cdot (q - g) / s`. A step that leaves the interval between a
    feasible and an infeasible scale is replaced by the middle of this interval.

    Parameters
    ----------
    form : HarmonicForm
        A single form, not negative where feasible, such as `clearance`.
    vertices : array_like, shape (m, n)
        Vertices p of the polygon, rad or length.
    centre : array_like, shape (n,)
        The point g, in the paper the centroid of the polygon.

    Raises
    ------
    ValueError
        If the form is not positive at the centre.

    Examples
    --------
    >>> from qbound import clearance, largest_scale, load_robot, polygon, window_region
    >>> robot = load_robot("minervabot-v2")
    >>> p = window_region(robot).polygon
    >>> height = clearance(robot, robot.boundary("B7"))
    >>> round(largest_scale(height, p, polygon.centroid(p)).scale, 6)
    0.964038

    The least scale of all boundaries, here still that of B7:

    >>> forms = [clearance(robot, boundary) for boundary in robot.used]
    >>> g = polygon.centroid(p)
    >>> round(min(largest_scale(form, p, g).scale for form in forms), 6)
    0.964038
    """
    p, g = np.asarray(vertices, dtype=float), np.asarray(centre, dtype=float)
    at_centre = float(form(g))
    if not at_centre > 0:
        raise ValueError(
            "no scale above 0 makes the polygon feasible: is its centre feasible? "
            f"The form is {at_centre:.6g} there"
        )
    feasible, infeasible = 0.0, _first_infeasible(form, p, g)
    if infeasible == np.inf:
        return Scale(np.inf, np.full_like(g, np.nan))
    scale = infeasible
    for _ in range(100):
        least = least_on_edges(form, polygon.scaled(p, scale, g))
        if least.value < 0:
            infeasible = scale
        else:
            feasible = scale
        rate = float(form.gradient(least.q) @ (least.q - g)) / scale
        following = scale - least.value / rate if rate < 0 else np.nan
        if not feasible <= following <= infeasible:
            following = (feasible + infeasible) / 2
        change, scale = following - scale, following
        if abs(change) < 1e-14 * max(1.0, scale):
            break
    return Scale(scale, least.q)


def _first_infeasible(form: HarmonicForm, p: Floats, g: Floats) -> float:
    """Return the first scale of those tried at which a point of an edge has a negative value."""
    t = np.linspace(0, 1, SAMPLES, endpoint=False)[:, None, None]
    samples = p + t * (np.roll(p, -1, axis=0) - p)
    for largest in 2.0 ** np.arange(11):  # coarser steps farther out
        for scale in np.linspace(0, largest, SCALES + 1)[1:].tolist():
            if (form(polygon.scaled(samples, scale, g)) < 0).any():
                return float(scale)
    return np.inf
