"""The region of Figures 4 and 5 in closed form: its bounds as curves, its corners as roots.

Theorem 2 along an edge of the box, or along the last joint: by hand, as the paper draws it, and a
check on the engine that finds every region (`cspace.region.paper_rule.problem`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.boundary.functions import clearance
from cspace.forms.factors import turns_within
from cspace.geometry import polygon
from cspace.geometry.polygon import tangent_corners
from cspace.model.robot import HalfSpace, Robot
from cspace.region.outline import legendre
from cspace.region.paper_rule import LOWER, UPPER, Bound, Box, box, cuts, windows
from cspace.tolerances import ON_BOUNDARY
from qbound.circle import TURN, CircleRoots, circle_roots, first_from, nearest_turn
from qbound.forms import HarmonicForm

PATHS: Final = ((5, 0, 1, 2, 3), (2, 3, 4, 5, 0))
"""Right-hand and left-hand path through the six corners, as the book reads Figures 8 and 9."""


@dataclass(frozen=True, eq=False)
class Vertex:
    """A corner of the region: joint values (rad) and the two bounds that meet there."""

    q: Floats
    bounds: tuple[Bound, Bound]


def geometric_bounds(robot: Robot, boundary: str, q: ArrayLike) -> Floats:
    """Return both roots of a half-space along the last joint, others held at `q` (Table 6, row 7).

    Returns
    -------
    ndarray, shape (2, ...)
        Lower and upper end of the arc of feasible values, rad, around a centre in (-pi, pi];
        NaN where the half-space does not cut the circle.
    """
    roots = _roots_along_last(robot, boundary, q)
    return np.where(roots.count > 0, roots.q, np.nan)


def bound_curves(robot: Robot, ranges: ArrayLike, n: int = 721) -> list[tuple[Bound, Floats]]:
    """Return every bound of Table 6 as a curve of two joints, for drawing.

    Windows are straight lines; a half-space is its two roots along the second joint, turned
    into the range, with NaN where it has none or leaves the range.

    Parameters
    ----------
    ranges : array_like, shape (2, 2)
        Lowest and highest value of each joint, rad.

    Returns
    -------
    list of (Bound, ndarray of shape (m, 2))
    """
    ranges = np.asarray(ranges, dtype=float)
    curves = []
    for window in windows(robot):
        for k, value in ((UPPER, window.upper), (LOWER, window.lower)):
            line = ranges.T.copy()
            line[:, window.joint] = value
            curves.append((Bound(window.boundary, window.component, k), line))
    for half_space in robot.boundaries:
        if isinstance(half_space, HalfSpace):
            curves += _half_space_curves(robot, half_space, ranges, n)
    return curves


def vertices(robot: Robot) -> list[Vertex]:
    """Return the corners of the region of two joints in closed form, anticlockwise.

    They are the corners of the box that no half-space removes, and the points where a half-space
    crosses an edge of the box: Theorem 2 along that edge.

    Raises
    ------
    ValueError
        If the robot has not two joints, or two neighbouring vertices share no bound: a half-space
        then folds, or meets another, inside the box, and the paper's rule names no vertex there.
    """
    if len(robot.joints) != 2:
        raise ValueError(f"the paper's rule draws two joints; {robot.name} has {len(robot.joints)}")
    corners = [vertex for edge in _edges(box(robot)) for vertex in _on_edge(robot, *edge)]
    for one, other in zip(corners, corners[1:] + corners[:1], strict=True):
        if not set(one.bounds) & set(other.bounds):
            names = [bound.label for vertex in (one, other) for bound in vertex.bounds]
            raise ValueError(f"neighbouring vertices share no bound: {', '.join(names)}")
    return corners


def refined(robot: Robot, n: int, *, tangents: bool) -> Floats:
    """Replace every edge that cuts across a half-space's curve (Section 4, the first remedy).

    Parameters
    ----------
    n : int
        Points of each curve, its two ends included; at least 2.
    tangents : bool
        Whether to put the corners of the tangents at these points in place of the edge, or
        the points themselves, joined by chords.

    Returns
    -------
    ndarray, shape (m, 2)
        Joint values, rad, anticlockwise; errors as in `vertices`.
    """
    corners = vertices(robot)
    result = []
    for one, other in zip(corners, corners[1:] + corners[:1], strict=True):
        result.append(one.q)
        (bound,) = set(one.bounds) & set(other.bounds)
        if _is_half_space(robot, bound):
            curve = _curve_between(robot, bound, one.q, other.q, n)
            normal = clearance(robot, robot.boundary(bound.boundary)).gradient(curve)
            result += list(tangent_corners(curve, normal) if tangents else curve[1:-1])
    return np.array(result)


def area(robot: Robot, nodes: int) -> float:
    """Return the area of the region of two joints: its polygon less the slivers under its arcs.

    Parameters
    ----------
    nodes : int
        Gauss nodes on each arc of a half-space, one solution of Theorem 2 each; at least 1.

    Returns
    -------
    float
        In rad²; errors as in `vertices`.
    """
    corners = vertices(robot)
    result = polygon.area([corner.q for corner in corners])
    for one, other in zip(corners, corners[1:] + corners[:1], strict=True):
        (bound,) = set(one.bounds) & set(other.bounds)
        if _is_half_space(robot, bound):
            result -= _sliver(robot, bound, one.q, other.q, nodes)
    return result


def _sliver(robot: Robot, bound: Bound, start: Floats, end: Floats, nodes: int) -> float:
    """Integral of the curve's height over its chord, from start to end."""
    x, weight = legendre(nodes)
    chord = start + (x[:, None] + 1) / 2 * (end - start)
    lower, upper = geometric_bounds(robot, bound.boundary, chord)
    curve = nearest_turn(upper if bound.k == UPPER else lower, chord[:, 1])
    return float(weight @ (curve - chord[:, 1]) * (end - start)[0] / 2)


def _curve_between(robot: Robot, bound: Bound, start: Floats, end: Floats, n: int) -> Floats:
    """Return `n` points of a half-space's bound, evenly spaced in the first joint."""
    q1 = np.linspace(start[0], end[0], n)
    lower, upper = geometric_bounds(robot, bound.boundary, np.stack([q1, q1], -1))
    q2 = np.unwrap(upper if bound.k == UPPER else lower)
    return np.stack([q1, q2 + start[1] - q2[0]], -1)


def _is_half_space(robot: Robot, bound: Bound) -> bool:
    """Tell whether a bound is a half-space's; a joint limit has no component."""
    return bool(bound.component) and isinstance(robot.boundary(bound.boundary), HalfSpace)


def _edges(region: Box) -> Iterator[tuple[Floats, Floats, Bound, Bound]]:
    """Each edge of the box anticlockwise: start, end, its own bound, the bound before it."""
    low, high = region.lower, region.upper
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    (left, bottom), (right, top) = region.lower_bounds, region.upper_bounds
    bounds = [bottom, right, top, left]
    for i in range(4):
        yield corners[i], corners[(i + 1) % 4], bounds[i], bounds[i - 1]


def _on_edge(
    robot: Robot, start: Floats, end: Floats, own: Bound, before: Bound
) -> Iterator[Vertex]:
    """Yield the vertices on an edge in its order, the start included and the end not."""
    walls = cuts(robot)
    found = [(0.0, Vertex(start, (before, own)))]
    for half_space, form in walls:
        for t in _crossings(form, start, end):
            q = start + t * (end - start)
            found.append((t, Vertex(q, (own, _half_space_bound(half_space, form, q)))))
    for _, vertex in sorted(found, key=lambda item: item[0]):
        if all(
            form(vertex.q) >= -ON_BOUNDARY * np.abs(form.coefficients).max() for _, form in walls
        ):
            yield vertex


def _crossings(form: HarmonicForm, start: Floats, end: Floats) -> list[float]:
    """Places 0 < t < 1 of an edge at which a form vanishes: Theorem 2 along the edge's joint."""
    joint = int(np.argmax(np.abs(end - start)))
    c0, a, b = form.along(joint, start)
    roots = circle_roots(a, b, -c0)
    if roots.count <= 0:
        return []
    low, high = sorted((start[joint], end[joint]))
    turned = first_from(low, np.unique(roots.q))
    return [float((q - start[joint]) / (end - start)[joint]) for q in turned if low < q < high]


def _roots_along_last(robot: Robot, boundary: str, q: ArrayLike) -> CircleRoots:
    form = clearance(robot, robot.boundary(boundary))
    c0, a, b = form.along(len(robot.joints) - 1, q)
    return circle_roots(a, b, -c0)


def _half_space_curves(
    robot: Robot, half_space: HalfSpace, ranges: Floats, n: int
) -> Iterator[tuple[Bound, Floats]]:
    """Yield both roots of a half-space over the first joint's range, once per turn in range."""
    component = int(np.argmax(np.abs(half_space.normal))) + 1
    q1 = np.linspace(ranges[0, 0], ranges[0, 1], n)
    for _ in range(3):  # closer and closer to where the roots appear, so that a curve meets itself
        there = np.isfinite(geometric_bounds(robot, half_space.name, np.stack([q1, q1], -1))[0])
        fold = np.nonzero(there[1:] != there[:-1])[0]
        q1 = np.sort(np.concatenate([q1, np.linspace(q1[fold], q1[fold + 1], 42)[1:-1].ravel()]))
    roots = _roots_along_last(robot, half_space.name, np.stack([q1, q1], -1))
    alpha = np.where(roots.count > 0, roots.alpha, np.nan)
    centre = np.unwrap(roots.theta)  # one curve, not one that jumps by a turn
    for k, sign in ((LOWER, -1), (UPPER, +1)):
        for q2 in _copies_within(centre + sign * alpha, *ranges[1]):
            yield Bound(half_space.name, component, k), np.stack([q1, q2], -1)


def _copies_within(q: Floats, low: float, high: float) -> Iterator[Floats]:
    """Yield a curve of angles once per full turn that brings it into a range, NaN outside."""
    for turn in turns_within(low, high, q) if not np.isnan(q).all() else ():
        shifted = q + turn * TURN
        yield np.where((shifted >= low) & (shifted <= high), shifted, np.nan)


def _half_space_bound(half_space: HalfSpace, form: HarmonicForm, q: Floats) -> Bound:
    """Upper bound of the last joint where the form falls along it, lower where it rises."""
    component = int(np.argmax(np.abs(half_space.normal))) + 1
    falls = form.gradient(q)[-1] < 0
    return Bound(half_space.name, component, UPPER if falls else LOWER)
