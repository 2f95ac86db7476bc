"""Measures of a region: moments and the nearest boundary point.

Not in the paper. Everything is taken on the exact arcs. For the nearest point, each piece between
two of an arc's points is parametrised by its chord. The form gives the distance of the curve from
the chord. It is looked at in 64 parts of each chord: a nearer point within less is missed.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.forms.factors import basis_and_slope
from cspace.model.robot import real_numbers
from cspace.order import Key, ordered_by
from cspace.region import Component, Problem, Region
from cspace.region.arcs import Arc, integrate
from cspace.tolerances import TIED
from qbound.circle import TURN, nearest_turn
from qbound.forms import HarmonicForm

HEAVIEST = 1e100
"""Largest weight of a joint, and one over the smallest: their squares stay within floats."""

PLACES = np.linspace(0, 1, 65)
"""Parts of a chord at which the distance is asked whether it falls or rises there."""

FLAT = 1e-12
"""Part of a distance by which two places differ by rounding."""

THINNEST = 2.0**-30
"""Part of a length that is taken across it where an arc is straight: more than rounding."""


@dataclass(frozen=True, eq=False)
class Moments:
    """Area, centroid and second moments of a component.

    Attributes
    ----------
    area : float
        Product of the two joints' units.
    centroid : ndarray, shape (2,)
        Of the area; rad or length.
    second : ndarray, shape (2, 2)
        Second moments about the centroid, the integral of (q - centroid) (q - centroid)^T.
    """

    area: float
    centroid: Floats
    second: Floats


@dataclass(frozen=True, eq=False)
class BoundaryPoint:
    """The point of a boundary that is nearest to a configuration.

    Attributes
    ----------
    q : ndarray, shape (2,)
        The nearest point, on the same full turn as the configuration.
    boundary : str
        Name of the boundary or of the joint limit.
    feature : str
        For two bodies, what touches there, such as "corner 2 on edge 3".
    component : int
        Index of the component that the boundary belongs to.
    distance : float
        Distance in the weighted metric that was asked for.
    """

    q: Floats
    boundary: str
    component: int
    distance: float
    feature: str = ""


# --- on an arc ------------------------------------------------------------------------------------


def along(arc: Arc, fractions: ArrayLike) -> tuple[Floats, Floats]:
    """Return exact points of an arc and the derivatives along it, piece by piece.

    Parameters
    ----------
    fractions : array_like, shape (m,) or (k - 1, m)
        Fractions in [0, 1] of each of the k - 1 chords between the arc's points.

    Returns
    -------
    q, dq : ndarray, shape (k - 1, m, 2)
        Where the normal of the chord at the fraction meets the arc, rad or length, and the
        derivative of that point by the fraction. The point is smooth at folds too. If one joint
        turns and the other slides, the normal is taken in units of the arc's own extent, because
        rad and length have no common measure.
    """
    ends = arc.points[:-1], arc.points[1:]
    pieces = len(ends[0])
    u = np.broadcast_to(fractions, (pieces, np.shape(fractions)[-1]))
    return _over_chords(arc, *ends, u)


def _over_chords(arc: Arc, start: Floats, end: Floats, u: Floats) -> tuple[Floats, Floats]:
    """Points and derivatives as in `along`, over chords (n, 2) at fractions (n, m)."""
    chord = (end - start)[:, None]
    q = start[:, None] + u[..., None] * chord
    form = arc.form
    if form is None:  # the arc of a limit is straight
        return q, np.broadcast_to(chord, q.shape)
    one, other = _extent(arc)
    normal = chord[..., ::-1] * np.array([-one / other, other / one])
    for _ in range(3):
        value, gradient = _value_and_gradient(form, q)
        rise = _quotient(value, _dot(gradient, normal))
        q = q - np.minimum(np.maximum(rise, -0.5), 0.5)[..., None] * normal
    _, gradient = _value_and_gradient(form, q)
    turn = _quotient(_dot(gradient, chord), _dot(gradient, normal))
    return q, chord - turn[..., None] * normal


def _extent(arc: Arc) -> Floats:
    """Return a unit for each joint in which to measure an arc, shape (2,), above zero.

    Two joints of one kind share one unit. Otherwise the unit is how far the arc extends along each
    joint.
    """
    if arc.form is None or len(set(arc.form.kinds)) == 1:
        return np.ones(2)
    extent = np.ptp(arc.points, axis=0)
    return np.asarray(np.maximum(extent, THINNEST * (extent.max() or 1.0)))


def _value_and_gradient(form: HarmonicForm, q: Floats) -> tuple[Floats, Floats]:
    """Return values of a form of two joints, shape (...), and its gradients, (..., 2)."""
    one, other = (basis_and_slope(kind, q[..., j]) for j, kind in enumerate(form.kinds))
    both = one @ form.coefficients @ other.swapaxes(-1, -2)
    return both[..., 0, 0], np.stack([both[..., 1, 0], both[..., 0, 1]], axis=-1)


def _quotient(a: Floats, b: Floats) -> Floats:
    """Return a / b, or 0 where b is 0, because the gradient vanishes only at the end of an arc."""
    return np.divide(a, b, out=np.zeros_like(b), where=b != 0)


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray((a * b).sum(axis=-1))


# --- moments --------------------------------------------------------------------------------------


def moments(problem: Problem, component: Component) -> Moments:
    """Return area, centroid and second moments of a component by Green on its arcs.

    Raises
    ------
    ValueError
        If the component goes round a joint: it has no inside in the plane, hence no centroid.

    """
    if any(component.wraps) or not component.loops:
        raise ValueError("a component that goes round a joint has no moments in the plane")
    origin = component.loops[0][0].points[0]
    arcs = [arc for loop in component.loops for arc in loop]
    area, x, y, xx, xy, yy = integrate(arcs, lambda q, dq: _green(q - origin, dq))
    mean = np.array([x, y]) / area
    second = np.array([[xx, xy], [xy, yy]]) - area * np.outer(mean, mean)
    return Moments(float(area), origin + mean, second)


def _green(q: Floats, dq: Floats) -> Floats:
    """Return terms whose sum round a boundary is the integrals of 1, x, y, x^2, xy, y^2 inside."""
    (x, y), (dx, dy) = q.T, dq.T
    parts = [
        (x * dy - y * dx) / 2,
        x * x / 2 * dy,
        -y * y / 2 * dx,
        x**3 / 3 * dy,
        x * x * y / 2 * dy,
        -(y**3) / 3 * dx,
    ]
    return np.stack(parts, axis=-1)


# --- the nearest boundary point -------------------------------------------------------------------


def nearest_boundary(
    region: Region,
    q: ArrayLike,
    component: int | None = None,
    weights: Sequence[float] = (1.0, 1.0),
) -> BoundaryPoint:
    r"""Return the point of the boundary nearest to a configuration, and the boundary's name.

    The distance is :math:`\sqrt{\sum_j (w_j \Delta q_j)^2}`. With the weights 1 it is in rad for
    two revolute joints and a length for two prismatic ones; for one of each it adds unlike units,
    so give weights, such as the length of the arm for the joint that turns.

    Parameters
    ----------
    q : array_like, shape (2,)
        rad or length; feasible or not.
    component : int, optional
        Use only the boundary of this component; default: of all components.
    weights : sequence of two float
        Above zero.

    Raises
    ------
    ValueError
        If there is no boundary, or a weight or joint value is not allowed.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> region = find_region(load_robot("minervabot-v2"))
    >>> point = nearest_boundary(region, [0.2, -0.5])
    >>> point.boundary, point.q.round(3).tolist(), round(point.distance, 3)
    ('B7', [0.898, -0.223], 0.751)

    An infeasible configuration has a nearest boundary too, which is the way back:

    >>> nearest_boundary(region, [1.5, 0.0]).boundary
    'B7'
    """
    q, w = real_numbers(q), real_numbers(weights)
    if q.shape != (2,) or not np.isfinite(q).all():
        raise ValueError("a configuration is two finite joint values")
    if w.shape != (2,) or not ((w > 0) & (w >= 1 / HEAVIEST) & (w <= HEAVIEST)).all():
        raise ValueError(f"weights are two finite numbers above zero, {HEAVIEST:g} at most")
    chosen = range(len(region.components)) if component is None else [component]
    arcs = [(i, arc) for i in chosen for loop in region.components[i].loops for arc in loop]
    arcs.sort(key=lambda item: _point_gap(region.problem, item[1], q, w))
    farthest = max((np.hypot(*(w * arc.points).T).max() for _, arc in arcs), default=0.0)
    least, slack, found = math.inf, FLAT * float(farthest), list[BoundaryPoint]()
    for i, arc in arcs:
        for p, distance in _nearest_on(region.problem, arc, q, w, least, slack):
            least = min(least, distance)
            found.append(BoundaryPoint(p, arc.boundary, i, distance, arc.feature))
    if not found:
        raise ValueError("there is no boundary: every configuration is feasible, or none is")
    # Of places that are equally near, such as those of a symmetric scene, rounding must not choose.
    near = [point for point in found if point.distance <= least + slack]
    error = TIED * np.abs([point.q for point in near]).max(axis=0)
    keys: list[Key[BoundaryPoint]] = [
        lambda point: (point.component, 0.0),
        lambda point: (point.q[0], error[0]),
        lambda point: (point.q[1], error[1]),
    ]
    return ordered_by(sorted(near, key=lambda point: point.boundary), keys)[0]


def _point_gap(problem: Problem, arc: Arc, q: Floats, w: Floats) -> float:
    """Distance from the nearest of the arc's points, on any turn."""
    rounds = [limits is None for limits in problem.ranges]
    gaps = arc.points - q
    gaps = np.where(rounds, nearest_turn(gaps, 0), gaps)
    return float(np.hypot(*(w * gaps).T).min())


def _nearest_on(
    problem: Problem, arc: Arc, q: Floats, w: Floats, limit: float, slack: float
) -> Iterator[tuple[Floats, float]]:
    """Yield places of an arc, on the turn of q, and their distances: the nearest if below a limit.

    Other places may be among them, and all that are farther than the nearest by less than `slack`.
    """
    for shift in _turns(problem, arc, q, w, limit + slack):
        for p in _candidates(arc, q + shift, w, limit + slack):
            distance = float(np.hypot(*(w * (p - q - shift))))
            if distance <= limit + slack:
                limit = min(limit, distance)
                yield p - shift, distance


def _turns(problem: Problem, arc: Arc, q: Floats, w: Floats, limit: float) -> Iterator[Floats]:
    """Yield the shifts by full turns for which q is near enough to the box around an arc."""
    low, high = arc.points.min(axis=0), arc.points.max(axis=0)
    steps = [
        [0.0]
        if limits is not None or kind == "prismatic"
        else TURN * np.arange(math.floor((a - x) / TURN), math.ceil((b - x) / TURN) + 1)
        for limits, kind, a, b, x in zip(
            problem.ranges, problem.forms.kinds, low, high, q, strict=True
        )
    ]
    for shift in np.array(list(product(*steps))):
        beyond = np.maximum(np.maximum(low - q - shift, q + shift - high), 0)
        slack = np.abs(np.diff(arc.points, axis=0)).max()  # a curve may leave its box by this
        if np.hypot(*(w * np.maximum(beyond - slack, 0))) < limit:
            yield shift


def _candidates(arc: Arc, q: Floats, w: Floats, limit: float) -> Floats:
    """Return the nearest of many places of the arc, and those between where the distance turns.

    Where it turns is found by false position (Illinois). Pieces between two of the arc's points
    are left out where both ends are farther than the limit, or than the nearest of these points,
    by more than twice the chord.
    """
    gaps = np.hypot(*(w * (arc.points - q)).T)
    best = min(limit, float(gaps.min()))
    start, end = arc.points[:-1], arc.points[1:]
    near = np.minimum(gaps[:-1], gaps[1:]) - 2 * np.hypot(*(w * (end - start)).T) <= best
    start, end = start[near], end[near]
    p, slope = _slope(arc, start, end, PLACES[None], q, w)
    places = np.concatenate([arc.points, p.reshape(-1, 2)])
    nearest = places[[np.hypot(*(w * (places - q)).T).argmin()]]
    k, i = np.nonzero((slope[:, :-1] < 0) & (slope[:, 1:] > 0))
    if not len(k):
        return nearest
    low, high, below, above = (
        x[:, None] for x in (PLACES[i], PLACES[i + 1], slope[k, i], slope[k, i + 1])
    )
    start, end = start[k], end[k]
    falls = above < below  # nowhere
    # The slope is a product of two such lengths, and no nearer to zero than that is rounded.
    rounding = 2.0**-50 * np.hypot(*(w * (end - start)).T) * np.hypot(*(w * (start - q)).T)
    for _ in range(60):
        u = (low * above - high * below) / (above - below)
        p, slope = _slope(arc, start, end, u, q, w)
        if (np.abs(slope) <= np.maximum(2.0**-50 * (above - below), rounding[:, None])).all():
            break
        before, falls = falls, slope < 0  # an end that stays twice loses half its weight
        below = np.where(falls, slope, np.where(~falls & ~before, below / 2, below))
        above = np.where(falls, np.where(falls & before, above / 2, above), slope)
        low, high = np.where(falls, u, low), np.where(falls, high, u)
    return np.concatenate([nearest, p[:, 0]])


def _slope(
    arc: Arc, start: Floats, end: Floats, u: Floats, q: Floats, w: Floats
) -> tuple[Floats, Floats]:
    """Points over chords, and the derivative of half the squared distance from q there."""
    u = np.broadcast_to(u, (len(start), u.shape[1]))
    p, dp = _over_chords(arc, start, end, u)
    return p, _dot(w * w * (p - q), dp)
