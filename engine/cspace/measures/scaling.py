"""The largest feasible scale of a polygon about a point, and least margins over polygons.

The result does not rest on samples. A ray is followed by steps that cannot jump over a root. The
polygon at the scale found is covered by triangles, and on each triangle every form is shown to be
positive.

For bodies, clauses are shown to hold. Two convex parts are apart exactly if one of their clauses
holds: all corners of one part lie beyond an edge of the other, or two corners are the nearest
places and far enough apart. So a configuration is feasible if every condition has a clause in which
every form is positive. Only values are compared, so lower bounds of forms become proofs about
bodies, and safe steps of forms become safe steps of bodies.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats, Ints
from cspace.boundary.contacts import NO_CONTACTS, SIDES, Contacts
from cspace.boundary.functions import clearance, margin_of
from cspace.forms.bending import bending, second_order, worst_edges
from cspace.forms.harmonic import derivatives, size
from cspace.geometry.simplices import edges, halved
from cspace.model.robot import Robot
from cspace.order import ordered_by
from cspace.tolerances import PROVED_SCALE, TANGENT
from qbound.forms import HarmonicForm


@dataclass(frozen=True, eq=False)
class Conditions:
    """Forms of two joints, one in each row, combined into clauses and conditions.

    Attributes
    ----------
    forms : HarmonicForm, shape (rows,)
    clauses : ndarray of int, shape (clauses,)
        First row of each clause.
    starts : ndarray of int, shape (conditions,)
        First clause of each condition.
    """

    forms: HarmonicForm
    clauses: Ints
    starts: Ints

    @cached_property
    def clause_of(self) -> Ints:
        """The clause of each row, shape (rows,)."""
        sizes = np.diff(np.append(self.clauses, len(self.forms.coefficients)))
        return np.repeat(np.arange(len(self.clauses)), sizes)

    @cached_property
    def condition_of(self) -> Ints:
        """The condition of each row, shape (rows,)."""
        return np.searchsorted(self.starts, self.clause_of, side="right") - 1

    def __len__(self) -> int:
        """Return the number of conditions: those of forms, then those of pairs of parts."""
        return len(self.starts)

    def together(self, values: Floats) -> Floats:
        """Return the value of each condition: the most of its clauses, each the least of its forms.

        Shape (..., rows) to (..., conditions).
        """
        least = np.minimum.reduceat(values, self.clauses, axis=-1)
        return np.asarray(np.maximum.reduceat(least, self.starts, axis=-1))

    def worst(self, values: Floats) -> tuple[Ints, Ints]:
        """Return the condition of the least value, and the row that decides; (n, rows) to (n,)."""
        if not len(self):
            none = np.full(len(values), -1)
            return none, none
        least = np.minimum.reduceat(values, self.clauses, axis=1)
        together = np.maximum.reduceat(least, self.starts, axis=1)
        condition = together.argmin(axis=1)
        value = together[np.arange(len(values)), condition, None]
        decides = (values == value) & (least[:, self.clause_of] == value)
        decides &= self.condition_of == condition[:, None]
        return condition, decides.argmax(axis=1)


def conditions(forms: HarmonicForm, contacts: Contacts = NO_CONTACTS) -> Conditions:
    """Gather conditions: one for each form, in order, then one for each pair of convex parts.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Forms of two joints, such as `Problem.forms`. An empty stack is allowed; it still has the
        kinds of the joints, which the tables of contacts lack.
    contacts : Contacts, optional
        Features of bodies that are to keep apart, of the same two joints.

    Raises
    ------
    ValueError
        If the forms are not a stack, or not of two joints.
    """
    if len(forms.kinds) != 2 or len(forms.stack) != 1:
        raise ValueError(
            f"wanted a stack of forms of two joints, such as Problem.forms; found the shape"
            f" {forms.stack} and {len(forms.kinds)} joints"
        )
    own = forms.coefficients
    m, features = len(own), len(contacts.forms)
    # Edges need no side conditions; for corners the constant 1 stands for a missing one.
    silent = (contacts.sides.reshape(-1, SIDES, 9) == np.eye(9)[0]).all(axis=-1)
    said = contacts.corners[:, None] & ~silent
    feature, side = np.nonzero(said)
    of = np.concatenate([np.arange(m), m + np.arange(features), m + feature])
    rows = np.concatenate([own, contacts.forms, contacts.sides[feature, side]])
    order = np.argsort(of, kind="stable")
    clause = np.concatenate([np.arange(m), m + contacts.clause])[of[order]]
    condition = np.concatenate([np.arange(m), m + contacts.pair])[of[order]]
    first = np.flatnonzero(np.diff(clause, prepend=-1))
    starts = np.flatnonzero(np.diff(condition[first], prepend=-1))
    return Conditions(HarmonicForm(rows[order], forms.kinds), first, starts)


ROUNDS, PLACES = 14, 33
MOST_TRIANGLES = 2_000_000
"""Triangles looked at before a proof gives up; the paper's polygon takes about a thousand."""

ROUNDED = 2.0**-50
"""Rounding of a form's value, as a part of its size."""

MOST_TOUCHES = 100
"""Scales that touch, each below the one before, before a search gives up; most find one or two."""

MOST_VALUES, AT_ONCE = 2**22, 2**10
"""Values of forms that are held at once, some 32 MB, and simplices that are looked at together.

The parts of these are looked at next: where there is no end the smallest ones are soon there."""


@dataclass(frozen=True, eq=False)
class SafeScale:
    """The largest feasible scale, and the form that limits it.

    Attributes
    ----------
    scale : float
        At this scale the polygon touches; no smaller scale at which it touches was found.
    proved : float
        Up to this scale no point of the polygon violates a form; subdivision shows this.
    q : ndarray, shape (2,)
        Where the scaled polygon touches.
    edge : int
        Index of the edge (from vertex `edge` to the next) that touches.
    form : int
        Index of the form that it touches; after the forms come the pairs of convex parts, as in
        `Contacts.boundaries`. -1 where none binds below the scale searched.
    """

    scale: float
    proved: float
    q: Floats
    edge: int
    form: int


def largest_safe_scale(
    vertices: ArrayLike,
    centre: ArrayLike,
    forms: HarmonicForm,
    contacts: Contacts = NO_CONTACTS,
) -> SafeScale:
    """Return the largest scale, at most 1, up to which a polygon stays where every form is >= 0.

    Bodies have to keep apart too. The joints' limits are not checked.

    Parameters
    ----------
    vertices : array_like, shape (m, 2)
        rad or length; convex or not.
    centre : array_like, shape (2,)
        Every form must be positive there.
    forms : HarmonicForm, shape (m,)
        Forms of two joints, such as `Problem.forms`; if there are only bodies, an empty stack,
        which has the kinds of the joints.
    contacts : Contacts, optional
        Features of bodies that are to keep apart, as `Problem.contacts` has them.

    Raises
    ------
    ValueError
        If a form is not positive at the centre, a number is not finite, or the forms are not a
        stack.
    ArithmeticError
        If subdivision does not end, because somewhere inside the polygon a form touches zero, or
        bodies touch without overlap; or if smaller touching scales are found again and again.

    Notes
    -----
    A local search over the edges gives a scale at which the polygon touches. Then the polygon,
    scaled by slightly less (`PROVED_SCALE`), is subdivided until a bound of second order, in
    floating point, shows that each triangle is feasible. If a violation is found on the way, the
    search starts again from there.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> from cspace.geometry import polygon
    >>> region = find_region(load_robot("minervabot-v2"))
    >>> problem = region.problem
    >>> vertices = [vertex.q for vertex in region.home_component.vertices]
    >>> centre = polygon.centroid(vertices)
    >>> found = largest_safe_scale(vertices, centre, problem.forms)
    >>> round(found.scale, 6), problem.names[found.form]
    (0.965049, 'B7')

    If nothing binds, the answer is 1 and the form is -1:

    >>> smaller = polygon.scaled(vertices, 0.5, centre)
    >>> found = largest_safe_scale(smaller, centre, problem.forms)
    >>> found.scale, found.form
    (1.0, -1)
    """
    p, g = np.asarray(vertices, dtype=float), np.asarray(centre, dtype=float)
    asked = _checked(forms, contacts, p, g)
    if not (asked.together(asked.forms(g)) > 0).all():
        raise ValueError("a boundary is violated at the centre already")
    best = _coarse(asked, p, g)
    for _ in range(MOST_TOUCHES):
        best = _touch(asked, p, g, best)
        proved = best.scale * (1 - PROVED_SCALE)
        witness = violation(asked, _fan(g + proved * (p - g), g))
        if witness is None:
            if best.form < 0:
                return SafeScale(best.scale, proved, best.q, -1, -1)
            q = _contact(asked.forms[best.row], p, best)
            return SafeScale(best.scale, proved, q, best.edge, best.form)
        best = _ray_through(p, g, witness)
    raise ArithmeticError(f"after {MOST_TOUCHES} scales that touch, smaller ones still do")


def first_exit(
    forms: HarmonicForm,
    centre: ArrayLike,
    rays: ArrayLike,
    contacts: Contacts = NO_CONTACTS,
) -> tuple[Floats, NDArray[np.intp]]:
    """Return how far along each ray every form stays positive, and which form stops the ray.

    Parameters
    ----------
    rays : array_like, shape (n, 2)
        Joint values added to the centre at scale 1.
    contacts : Contacts, optional
        Features of bodies that are to keep apart.

    Returns
    -------
    scale : ndarray, shape (n,)
        The first zero of any form along ``centre + scale ray``, or the first contact of bodies, at
        most 1.
    form : ndarray of int, shape (n,)
        Index of the form that stops the ray, as in `SafeScale`; -1 if none does.
    """
    g, rays = np.asarray(centre, dtype=float), np.asarray(rays, dtype=float)
    asked = _checked(forms, contacts, g + rays, g)
    scales, stopped, _ = _exits(asked, g, rays)
    return scales, stopped


def least(
    form: HarmonicForm, vertices: ArrayLike, centre: ArrayLike, tolerance: float = 1e-12
) -> tuple[float, Floats]:
    """Return the least value of a form over a polygon, and where, to within a tolerance.

    The polygon is the fan of triangles from `centre` to its edges; each is halved until no part
    of it can hold a value below the least one found less `tolerance` of the form's size.
    """
    cells = _fan(np.asarray(vertices, dtype=float), np.asarray(centre, dtype=float))
    _refuse_infinite(form, cells)
    slack, best, where = tolerance * np.abs(form.coefficients).max(), np.inf, cells[0, 0]
    while len(cells):  # halved until none can hold a value below the least one found at a corner
        corners = form(cells)
        i = np.unravel_index(corners.argmin(), corners.shape)
        if corners[i] < best:
            best, where = float(corners[i]), cells[i]
        cells = cells[second_order(form, cells) < best - slack]
        cells = halved(cells, worst_edges(form, cells))
    return best, np.asarray(where)


def worst_margins(
    robot: Robot, vertices: ArrayLike, centre: ArrayLike
) -> dict[str, tuple[float, Floats]]:
    """Return the least margin of every boundary in use over a polygon, and where (eqs. 11, 12).

    Returns
    -------
    dict
        Boundary name to margin (a length, ``|B| - d_min`` or the depth inside a wall) and joint
        values, shape (2,).

    Raises
    ------
    ValueError
        If a boundary is about bodies: it has no single form.
    """
    found = {}
    for boundary in robot.used:
        value, q = least(clearance(robot, boundary), vertices, centre)
        found[boundary.name] = float(margin_of(robot, boundary, value)), q
    return found


# --- all forms at once ----------------------------------------------------------------------------


def _checked(forms: HarmonicForm, contacts: Contacts, points: Floats, centre: Floats) -> Conditions:
    """Gather the conditions, after checking that all values in the box around points are finite."""
    asked = conditions(forms, contacts)
    _refuse_infinite(asked.forms, np.vstack([points, centre]))
    return asked


def _refuse_infinite(form: HarmonicForm, points: Floats) -> None:
    """Refuse NaN, which compares as feasible, and values that are or become infinite."""
    reach = np.abs(points).reshape(-1, 2).max(axis=0)
    with np.errstate(all="ignore"):
        largest = size(form, reach)
    if not (np.isfinite(reach).all() and np.isfinite(largest).all()):
        raise ValueError("joint values and coefficients must be finite numbers")


def _fan(p: Floats, g: Floats) -> Floats:
    """Triangles from a centre to the edges of a closed polygon, shape (m, 3, 2)."""
    return np.stack([np.broadcast_to(g, p.shape), p, np.roll(p, -1, axis=0)], axis=1)


def violation(asked: Conditions, cells: Floats) -> Floats | None:
    """Return a point of some simplices that violates a condition; None if shown not to exist.

    Parameters
    ----------
    cells : ndarray, shape (N, k, 2)
        Corners of triangles, or of segments.

    Raises
    ------
    ArithmeticError
        If subdivision does not end, because somewhere a condition is zero up to rounding.
    """
    looked_at, step = 0, min(AT_ONCE, max(1, MOST_VALUES // (4 * max(1, *asked.forms.stack))))
    noise = ROUNDED * size(asked.forms, np.abs(cells).max(axis=(0, 1), initial=0.0))
    while len(cells):
        now, cells = cells[:step], cells[step:]
        looked_at += len(now)
        values = asked.forms(now)
        least = asked.together(values + noise).min(axis=-1, initial=np.inf)
        if least.min() < 0:
            return np.asarray(now[np.unravel_index(least.argmin(), least.shape)])
        bounds = second_order(asked.forms, now)
        doubtful = ~(asked.together(bounds) > 0).all(axis=1)
        if doubtful.any():
            now, values = now[doubtful], values[doubtful]
            at_zero = (asked.together(values - noise).max(axis=1) <= 0).any()
            if at_zero or looked_at > MOST_TRIANGLES:
                raise ArithmeticError("subdivision comes to no end: a form touches zero inside")
            chosen = _cuts(asked, now, values, bounds[doubtful])
            cells = np.concatenate([halved(now, chosen), cells])
    return None


def _cuts(asked: Conditions, cells: Floats, values: Floats, bounds: Floats) -> NDArray[np.intp]:
    """Return the edge at which to halve each simplex that no bound shows to be feasible.

    If a clause holds at all corners, its bound fails because a form bends; then the edge is that
    along which its form bends most. If no clause does, different clauses hold at different corners,
    and cuts by bending would not end; then the edge is that along which a form of the condition may
    change most. The actual change is not a measure, because a form may fall and rise again, and the
    longest edge would never be cut.
    """
    lowest = values.min(axis=1)
    holds = np.minimum.reduceat(lowest, asked.clauses, axis=1)[:, asked.clause_of] > 0
    condition, row = asked.worst(np.where(holds, bounds, -np.inf))
    chosen = worst_edges(asked.forms, cells, row)
    own = asked.condition_of == condition[:, None]
    turns = ~(own & holds).any(axis=1)
    slopes = size(derivatives(asked.forms), np.abs(cells).max(axis=(0, 1)))
    changes = np.abs(edges(cells[turns])) @ slopes.T
    chosen[turns] = np.where(own[turns, None], changes, 0).max(axis=2, initial=0).argmax(axis=1)
    return chosen


# --- the scale that touches -----------------------------------------------------------------------


def _exits(
    asked: Conditions, g: Floats, rays: Floats
) -> tuple[Floats, NDArray[np.intp], NDArray[np.intp]]:
    """Step along rays as far as a bound of second order allows, so that no root is jumped over.

    Return the scales, and for each ray the condition that stops it and the form that decides.
    """
    forms = asked.forms
    legs = np.stack([np.broadcast_to(g, rays.shape), g + rays], axis=1)
    bend = np.maximum(bending(forms, legs, rays[:, None])[:, 0], 1e-300)
    noise = ROUNDED * size(forms, np.abs(legs).max(axis=(0, 1)))
    s, steps = np.zeros(len(rays)), np.zeros((len(rays), *forms.stack))
    if not len(asked):
        none = np.full(len(rays), -1)
        return np.ones(len(rays)), none, none
    for _ in range(400):
        q = g + s[:, None] * rays
        found = forms(q)
        value = np.where(found <= noise, 0.0, found)
        slope = np.einsum("nmj,nj->nm", derivatives(forms)(q), rays)
        root = np.sqrt(slope**2 + 2 * bend * value)
        # (slope + root) / bend, without subtracting near numbers where the form falls
        steps = np.where(
            slope > 0, (slope + root) / bend, 2 * value / np.maximum(root - slope, 1e-300)
        )
        steps = np.where(found < -noise, 0.0, steps)
        before, s = s, np.minimum(s + asked.together(steps).min(axis=1), 1.0)
        if (s - before <= 2.0**-50).all():
            break
    condition, row = asked.worst(steps)
    stopped = s < 1
    return s, np.where(stopped, condition, -1), np.where(stopped, row, -1)


@dataclass(frozen=True, eq=False)
class _Touch:
    scale: float
    q: Floats
    edge: int
    form: int
    row: int
    low: float
    high: float


def _coarse(asked: Conditions, p: Floats, g: Floats) -> _Touch:
    """Return the best of a few rays to every edge; of equal ones that to the first edge."""
    tries = [_on_edge(asked, p, g, edge, 0.0, 1.0) for edge in range(len(p))]
    return ordered_by(tries, [lambda touch: (touch.scale, PROVED_SCALE / 2 * touch.scale)])[0]


def _touch(asked: Conditions, p: Floats, g: Floats, best: _Touch) -> _Touch:
    """Narrow down the place of an edge that touches first."""
    for _ in range(ROUNDS):
        found = _on_edge(asked, p, g, best.edge, best.low, best.high)
        best = found if found.scale <= best.scale else best
        if best.high - best.low < 1e-12 or found is not best:
            break
    return best


def _contact(form: HarmonicForm, p: Floats, best: _Touch) -> Floats:
    """Return the place of contact to all digits, where form and slope along the edge vanish.

    The scale is flat near its minimum, so narrowing finds the place to half of the digits only. A
    scaled edge keeps its direction, so the place is the same for every centre.
    """
    along = p[(best.edge + 1) % len(p)] - p[best.edge]
    q = best.q
    for _ in range(6):
        slope = form.gradient(q)
        matrix = np.stack([slope, form.hessian(q) @ along])
        if abs(np.linalg.det(matrix)) <= TANGENT * np.abs(matrix).max() ** 2:
            return best.q
        q = q - np.linalg.solve(matrix, [float(form(q)), float(slope @ along)])
    return q if np.linalg.norm(q - best.q) <= 1e-5 * np.linalg.norm(along) else best.q


def _on_edge(asked: Conditions, p: Floats, g: Floats, edge: int, low: float, high: float) -> _Touch:
    t = np.clip(np.linspace(low, high, PLACES), 0.0, 1.0)  # always has the middle as a place
    start, end = p[edge], p[(edge + 1) % len(p)]
    rays = start + t[:, None] * (end - start) - g
    scales, stopped, rows = _exits(asked, g, rays)
    i = int(scales.argmin())
    nearby = float(t[max(i - 1, 0)]), float(t[min(i + 1, len(t) - 1)])
    place, which = g + scales[i] * rays[i], (int(stopped[i]), int(rows[i]))
    return _Touch(float(scales[i]), place, edge, *which, *nearby)


def _ray_through(p: Floats, g: Floats, witness: Floats) -> _Touch:
    """Return the edge, and the place on it, whose ray from the centre passes a violation."""
    ends = np.stack([p - g, np.roll(p, -1, axis=0) - g], axis=-1)  # columns: both ends of an edge
    inside = np.abs(np.linalg.det(ends)) > 0
    share = np.full((len(p), 2), -np.inf)
    share[inside] = np.linalg.solve(
        ends[inside], np.broadcast_to((witness - g)[:, None], (int(inside.sum()), 2, 1))
    )[..., 0]
    edge = int(share.min(axis=1).argmax())
    t = float(share[edge, 1] / share[edge].sum())
    return _Touch(np.inf, witness, edge, -1, -1, t - 0.02, t + 0.02)
