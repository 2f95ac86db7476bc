"""Base values where the roots along the lift may change their order, and contacts of bodies.

Every kind of event (`KINDS`) is one polynomial of the base: of z = exp(i t) on a circle, of t
itself on a line. Stacks of polynomials are solved in doubles, and each zero has a bound of its
error. If two zeros are nearer than their errors, balls decide their order (`CriticalLines`).

The curve of a contact feature's form bounds what its pair of bodies forbids only where no side
condition is negative. Between the feature's own events (folds, jumps, ends of the lift, common
roots with its own side conditions; never with other features) a root is a contact everywhere or
nowhere, so one place inside decides. `ContactPieces` of these curves are contacts from end to end.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Bools, Complexes, Floats, Ints, ranges
from cspace.boundary.contacts import SIDES
from cspace.forms.factors import FACTORS, turns_within, whole_turns
from cspace.region.plane import (
    KINDS,
    LEVELS,
    NAMES,
    NUMBER,
    Plane,
    Precise,
    UndecidedError,
    Zero,
    flint,
    in_order,
    midpoint,
    normalised,
    precision,
    ranked,
    to_float,
    which,
)
from cspace.tolerances import AGREE, BOX, NEAR, UNIT, WALL
from qbound.circle import TURN
from qbound.forms import Kind, basis

FAR = 2.0
"""Roots farther than this from 0 are not wanted: bases are scaled to the unit circle or [-1, 1]."""

DERIVATIVES = 4
"""Derivatives that bound the error of a root; one more than the multiplicity that is well known."""


class Roots(NamedTuple):
    """Roots of polynomials, one in each row.

    Attributes
    ----------
    row : ndarray of int, shape (k,)
        Index of the polynomial.
    z : ndarray of complex, shape (k,)
    radius : ndarray, shape (k,)
        Every polynomial within the errors has a root within this distance of z.
    crowded : ndarray of bool, shape (k,)
        Whether another root of the same polynomial may lie within that distance.
    """

    row: Ints
    z: Complexes
    radius: Floats
    crowded: Bools


def polynomial_roots(stack: Complexes, errors: Floats, *, circle: bool) -> Roots:
    """Return the roots of stacked polynomials near the unit disc, those of equal degree at once.

    Roots are eigenvalues of companion matrices, polished by Newton. Coefficients at either end that
    are zero within their error are left out, because they would give infinite roots and make the
    other roots inaccurate. Not in the paper.

    Parameters
    ----------
    stack : ndarray of complex, shape (n, d + 1)
        Coefficients, ascending powers.
    errors : ndarray, shape (n,)
        Bound of the sum of all coefficients' errors.
    circle : bool
        Whether only roots near the unit circle are wanted; then lowest coefficients may be left out
        too.

    Notes
    -----
    A polynomial of degree d with Taylor coefficients a_k at z has a root within
    ``(binomial(d, k) abs(a_0 / a_k))**(1/k)`` of z, for each k (Henrici 1974, Theorem 6.4e). The
    least of these bounds is taken, with all errors in the worst direction.

    Examples
    --------
    >>> import numpy as np
    >>> stack = np.poly([0.3, 0.4, -0.5])[None, ::-1].astype(complex)
    >>> found = polynomial_roots(stack, np.array([1e-15]), circle=False)
    >>> sorted(found.z.real.round(14).tolist()), bool((found.radius < 1e-12).all())
    ([-0.5, 0.3, 0.4], True)
    """
    rows, moved, degree = _trimmed(stack, errors, circle)
    z = np.full((len(rows), stack.shape[1] - 1), np.nan, dtype=complex)
    for d in set(degree.tolist()) - {0}:
        chosen = degree == d
        z[chosen, :d] = _companion_roots(moved[chosen, : d + 1])
    z = _polished(moved, z)
    radius = _radii(moved, z, degree, errors[rows])
    near = np.abs(z[:, :, None] - z[:, None, :]) <= radius[:, :, None] + radius[:, None, :]
    crowded = near.sum(axis=2) > 1
    with np.errstate(invalid="ignore"):
        wanted = np.abs(z) <= FAR
        if circle:
            wanted &= np.abs(np.abs(z) - 1) <= radius
        else:
            wanted &= np.abs(z.imag) <= radius
    of, place = np.nonzero(wanted)
    return Roots(rows[of], z[of, place], radius[of, place], crowded[of, place])


def _trimmed(stack: Complexes, errors: Floats, circle: bool) -> tuple[Ints, Complexes, Ints]:
    """Return rows that are not zero, their polynomials from the first coefficient, and degrees."""
    sizes = np.abs(stack)
    rows = np.flatnonzero((sizes > errors[:, None]).any(axis=1))
    kept = sizes[rows] > errors[rows, None]
    first = kept.argmax(axis=1) if circle else np.zeros(len(rows), dtype=np.int64)
    last = stack.shape[1] - 1 - kept[:, ::-1].argmax(axis=1)
    degree = last - first
    term = np.arange(degree.max(initial=1) + 1)
    place = np.minimum(first[:, None] + term, last[:, None])
    moved = np.where(term <= degree[:, None], stack[rows[:, None], place], 0.0)
    return rows, moved, degree


def _companion_roots(stack: Complexes) -> Complexes:
    """Return the roots, (n, degree), of polynomials with a leading coefficient."""
    degree = stack.shape[1] - 1
    if degree == 2:
        return _quadratic_roots(*stack.T)
    matrices = np.empty((len(stack), degree, degree), dtype=complex)
    matrices[:] = np.eye(degree, k=-1)
    matrices[:, :, -1] = -stack[:, :-1] / stack[:, -1:]
    return np.asarray(np.linalg.eigvals(matrices), dtype=complex)


def _quadratic_roots(c0: Complexes, c1: Complexes, c2: Complexes) -> Complexes:
    """Return both roots, (n, 2), of c0 + c1 z + c2 z^2; the larger first, free of cancellation."""
    root = np.sqrt(c1 * c1 - 4 * c0 * c2)
    root = np.where((c1.conj() * root).real < 0, -root, root)
    half = -(c1 + root) / 2
    other = np.divide(c0, half, out=np.zeros_like(c0), where=half != 0)
    return np.array([half / c2, other]).T


def _polished(stack: Complexes, z: Complexes) -> Complexes:
    """Two steps of Newton; a step is taken only where it is short."""
    both = np.zeros((2, *stack.shape), dtype=complex)
    both[0], both[1, :, :-1] = stack, stack[:, 1:] * np.arange(1, stack.shape[1])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for _ in range(2):
            value, slope = _horner(both, z)
            step = value / slope
            z = np.where(np.abs(step) < 1e-6, z - step, z)
    return z


def _radii(stack: Complexes, z: Complexes, degree: Ints, errors: Floats) -> Floats:
    """Bound the distances of roots from the nearest true ones, (n, d)."""
    most = stack.shape[1] - 1
    with np.errstate(all="ignore"):
        # Rounding of Horner's rule, and the coefficients' errors.
        far = np.maximum(np.abs(z), 1.0) ** degree[:, None]
        doubt = (errors + 4 * most * UNIT * np.abs(stack).sum(axis=1))[:, None] * far
        value = np.abs(_horner(stack, z)) + doubt
        radius = np.full(z.shape, np.inf)
        for k in range(1, min(most, DERIVATIVES) + 1):
            ways = np.array([math.comb(d, k) for d in range(most + 1)], dtype=float)[degree][
                :, None
            ]
            slope = np.abs(_horner(_taylor(stack, k), z)) - ways * doubt
            bound = (ways * value / np.maximum(slope, 1e-300)) ** (1 / k)
            radius = np.where(slope > 0, np.minimum(radius, bound), radius)
    return np.where(np.isnan(z), 0.0, radius)


def _taylor(stack: Complexes, j: int) -> Complexes:
    """Return the polynomials' j-th derivatives over j!, ascending powers."""
    return np.asarray(stack[:, j:] * [math.comb(k, j) for k in range(j, stack.shape[1])])


def _horner(stack: NDArray[np.inexact], z: NDArray[np.inexact]) -> NDArray[np.inexact]:
    """Evaluate polynomials (..., n, d + 1) at places, a row of them each, (n, k)."""
    result = np.empty((*stack.shape[:-1], z.shape[1]), dtype=z.dtype)
    result[...] = stack[..., -1:]
    for k in reversed(range(stack.shape[-1] - 1)):
        result *= z
        result += stack[..., k : k + 1]
    return result


BLOCK = 2**14
"""Polynomials that are solved at once: fast enough, small enough for any memory."""

FEW = 2**9
"""Polynomials of a kind up to which they are solved with others: one call costs more than they."""


def univariate(plane: Plane, tables: Floats) -> Complexes:
    """Turn scaled (m, 3, 3) coefficients into polynomials of the base, (m, 3 of the lift, 3).

    Ascending powers. Revolute: of z = exp(i q), times z. Prismatic: of q itself.
    """
    return np.asarray(tables.swapaxes(1, 2) @ _by_power(plane.base_kind))


@cache
def _by_power(kind: Kind) -> Complexes:
    """Return the matrix that turns a joint's three coefficients into those of ascending powers."""
    factor = FACTORS[kind]
    return np.asarray(factor.waves[np.argsort(factor.turns + factor.powers)].T, dtype=complex)


# --- events ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Events:
    """Base values at which the order of roots may change, one in each row.

    Attributes
    ----------
    what : ndarray of int, shape (n, 3)
        Kind of the event, and its one or two rows, as `Precise` numbers them.
    t, radius : ndarray, shape (n,)
        Base value, and a bound of its error.
    crowded : ndarray of bool, shape (n,)
        Whether the same event may have another zero within this distance.
    key : ndarray of int, shape (n,)
        Events with equal keys that are as near as their errors count as one; -1 for no key.
    exact : ndarray of int, shape (n,)
        Index of the zero in balls, in `Finder.zeros`; -1 for none.
    """

    what: Ints
    t: Floats
    radius: Floats
    crowded: Bools
    key: Ints
    exact: Ints

    def __len__(self) -> int:
        """Return their number."""
        return len(self.t)

    def __getitem__(self, rows: Any) -> Events:
        """Return some of them."""
        return Events(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    @classmethod
    def joined(cls, parts: Sequence[Events]) -> Events:
        """Return all events of several lists."""
        return cls(
            *(
                np.concatenate([getattr(part, name) for part in parts])
                for name in cls.__dataclass_fields__
            )
        )


NO_EVENTS = Events(
    np.zeros((0, 3), dtype=np.int64),
    np.zeros(0),
    np.zeros(0),
    np.zeros(0, dtype=np.bool_),
    np.zeros(0, dtype=np.int64),
    np.zeros(0, dtype=np.int64),
)


@dataclass(eq=False)
class _Request:
    """Polynomials of one kind of event: their rows, coefficients and errors."""

    kind: str
    i: Ints
    j: Ints
    stack: Complexes
    errors: Floats

    def __getitem__(self, rows: Any) -> _Request:
        return _Request(self.kind, self.i[rows], self.j[rows], self.stack[rows], self.errors[rows])

    @property
    def blank(self) -> Bools:
        """Whether all coefficients are zero within their errors."""
        return np.asarray((np.abs(self.stack) <= self.errors[:, None]).all(axis=1))


class Finder:
    """Finds the zeros of events of one plane.

    Parameters
    ----------
    plane : Plane
    precise : Precise
        Decides what doubles cannot.
    """

    def __init__(self, plane: Plane, precise: Precise) -> None:
        self.plane, self.precise = plane, precise
        self.zeros: list[Zero] = []
        self._nearest: dict[tuple[Any, ...], Zero | None] = {}
        self._c = univariate(plane, plane.scaled)
        self._size: Floats = np.abs(self._c).sum(axis=2).T
        self._circle = plane.lift_kind == "revolute"

    # --- polynomials ----------------------------------------------------------------------------

    def _rows(self, rows: Ints) -> tuple[Complexes, Floats, Floats]:
        """Return polynomials along the lift, their sizes and errors, of forms or of sides."""
        plane, first_side = self.plane, len(self._c)
        if not (rows >= first_side).any():
            return self._c[rows], self._size[:, rows], plane.eps[rows]
        sides, at = plane.sides.reshape(-1, 3, 3), rows - first_side
        c = univariate(plane, sides[at])
        return c, np.abs(c).sum(axis=2).T, plane.side_eps.reshape(-1)[at]

    def own(self, rows: Ints) -> list[_Request]:
        """Return events where roots of forms appear, jump, or pass an end of the lift's range."""
        kinds = ("fold circle", "second") if self._circle else ("fold line", "first", "second")
        found = [self._request(kind, rows, rows) for kind in kinds]
        if self.plane.lift_range is not None:
            found += [self._request(kind, rows, rows) for kind in ("lower end", "upper end")]
        return found

    def fixed(self, rows: Ints) -> list[_Request]:
        """Return the events at which forms without the lift vanish."""
        return [self._request("constant", rows, rows)]

    def quick(self, i: Ints, j: Ints) -> tuple[Ints, Floats]:
        """Return roughly where paired rows may share a root: the pair's index, and base value."""
        if self._circle:
            requests = [self._request("resultant circle", i, j)]
        else:
            one, other = (np.abs(self._c[rows][:, 2]).max(axis=-1) > 0 for rows in (i, j))
            chosen = {
                "sine": ~one & ~other,
                "resultant line": one & other,
                "under": one & ~other,
                "over": ~one & other,
            }
            requests = [self._request(kind, i[k], j[k]) for kind, k in chosen.items()]
        found = [NO_EVENTS]
        for what, stack, errors in _blocks(requests):
            rows = which((np.abs(stack) > errors[:, None]).any(axis=1))
            found.append(self._of(what[rows], stack[rows], errors[rows]))
        events = Events.joined(found)
        return events.what[:, 1], events.t

    def of_kind(self, kind: str, rows: Ints) -> _Request:
        """Return one kind of event of some rows."""
        return self._request(kind, rows, rows)

    def _request(self, kind: str, i: Ints, j: Ints) -> _Request:
        (a, size_a, eps_a), event = self._rows(i), KINDS[kind]
        a = np.moveaxis(a, 1, 0)
        b: Any = None
        size_b = eps_b = np.zeros((3, len(i)))
        if kind in ("lower end", "upper end"):
            end = self.plane.lift_ends[kind == "upper end"] / self.plane.lift_unit
            b = basis(self.plane.lift_kind, np.asarray(end))
            stack = event.formula(a, b, lambda x, y: x * y)
        else:
            if event.degrees[1]:
                b, size_b, eps_b = self._rows(j)
                b = np.moveaxis(b, 1, 0)
            stack = event.formula(a, b, _times)
        one, other = event.degrees
        doubt = one * eps_a + (other * eps_b if other else 0.0) + 8 * UNIT
        errors = event.size(size_a, size_b) * doubt
        return _Request(kind, i, j, np.asarray(stack), errors)

    def meetings(self, i: Ints, j: Ints) -> list[_Request]:
        """Return the events at which paired rows may share a root along the lift."""
        return self._on_circle(i, j) if self._circle else self._on_line(i, j)

    def _on_circle(self, i: Ints, j: Ints) -> list[_Request]:
        """Resultant of two equations linear in (cos, sin), on the unit circle (Cramer's rule).

        If the two equations are parallel for every base value, as for two points on one ray of a
        link, the resultant is a sum of two squares with only double roots; the common roots of both
        squares are then used. If both have no constant part, the resultant is the square of the
        determinant. Two forms that share one root for every base value share the other one where
        they are parallel.
        """
        crossed = {kind: self._request(kind, i, j) for kind in ("determinant", "cosine", "sine")}
        resultant = self._request("resultant circle", i, j)
        none = {kind: self._none(found) for kind, found in crossed.items()}
        parallel, plain = none["determinant"], none["cosine"] & none["sine"]
        sharing = self._none(resultant) & ~parallel
        apart = ~parallel & ~plain & ~sharing
        return [
            resultant[apart],
            crossed["cosine"][parallel & ~none["cosine"]],
            crossed["sine"][parallel & ~none["sine"]],
            crossed["determinant"][(sharing | plain) & ~parallel],
        ]

    def _on_line(self, i: Ints, j: Ints) -> list[_Request]:
        """Resultants of polynomials of degree 2 or less at their actual degrees.

        The formal resultant of two affine forms is identically zero, so each pair uses its actual
        degrees. Two quadratics that share one root for every base value share the other where their
        sums of roots agree; if an affine form shares one root of a quadratic, an event is where its
        coefficient of the lift vanishes.
        """
        one, other = (np.abs(self._rows(rows)[0][:, 2]).max(axis=-1) > 0 for rows in (i, j))
        affine, both = ~one & ~other, one & other
        resultant = self._request("resultant line", i[both], j[both])
        under = self._request("under", i[one & ~other], j[one & ~other])
        over = self._request("over", i[~one & other], j[~one & other])
        shared, below, above = (self._none(found) for found in (resultant, under, over))
        again = self._request("determinant", i[both][shared], j[both][shared])
        return [
            self._request("sine", i[affine], j[affine]),
            resultant[~shared],
            under[~below],
            over[~above],
            again,
            self._request("first", j[one & ~other][below], j[one & ~other][below]),
            self._request("first", i[~one & other][above], i[~one & other][above]),
        ]

    def _none(self, request: _Request) -> Bools:
        """Tell which polynomials are zero everywhere; doubles propose, balls decide."""
        none = request.blank
        for k in which(none & (request.errors > 0)).tolist():
            event = NUMBER[request.kind], int(request.i[k]), int(request.j[k])
            none[k] = self.precise.vanishes(event)
        return none

    # --- zeros ----------------------------------------------------------------------------------

    def events(self, requests: Sequence[_Request]) -> Events:
        """Return the zeros of polynomials within the base's range, or slightly outside."""
        found = [NO_EVENTS]
        for what, stack, errors in _blocks(requests):
            blank = (np.abs(stack) <= errors[:, None]).all(axis=1)
            # A polynomial without any term is zero everywhere. For others balls decide.
            doubtful = which(blank & (errors > 0))
            found += [self._all_of(tuple(what[k].tolist())) for k in doubtful.tolist()]
            rows = which(~blank)
            found.append(self._of(what[rows], stack[rows], errors[rows]))
        return Events.joined(found)

    def _of(self, what: Ints, stack: Complexes, errors: Floats) -> Events:
        if not len(what):
            return NO_EVENTS
        plane, circle = self.plane, self.plane.base_kind == "revolute"
        roots = polynomial_roots(stack, errors, circle=circle)
        low, high = plane.ends
        if circle:
            t = np.angle(roots.z)
            radius = 2 * roots.radius + 8 * UNIT
            slack = 1e-6 if plane.base_range is not None else 0.0
            turns = np.array(turns_within(low - slack, high + slack, [-math.pi, math.pi]))
            k, t = np.arange(len(t)).repeat(len(turns)), (t[:, None] + TURN * turns).ravel()
        else:
            t, k = plane.base_unit * roots.z.real, np.arange(len(roots.z))
            radius = plane.base_unit * (2 * roots.radius + 8 * UNIT)
        radius = radius[k]
        inside = (t >= low - radius) & (t <= high + radius)
        k, t, radius = k[inside], t[inside], radius[inside]
        none = np.full(len(k), -1)
        return Events(what[roots.row[k]], t, radius, roots.crowded[k], none, none.copy())

    def _all_of(self, event: tuple[int, int, int]) -> Events:
        """Return in balls all zeros of an event that doubles cannot solve."""
        if self.precise.vanishes(event):
            return NO_EVENTS
        low, high = self.plane.ends
        zeros = self.precise.zeros(event, low, high, LEVELS[-1])
        if zeros is None:
            raise UndecidedError(f"the zeros of {NAMES[event[0]]} of rows {event[1:]}")
        return self.exact(zeros)

    def exact(self, zeros: Sequence[Zero], key: int = -1) -> Events:
        """Return zeros that are known in balls, as events."""
        n = len(zeros)
        first = len(self.zeros)
        self.zeros += zeros
        t = np.array([to_float(zero.ball) for zero in zeros], dtype=float)
        radius = np.array([float(zero.ball.rad()) for zero in zeros], dtype=float)
        return Events(
            np.array([zero.event for zero in zeros], dtype=np.int64).reshape(-1, 3),
            t,
            radius * 1.01 + 2 * UNIT * np.abs(t),
            np.zeros(n, dtype=np.bool_),
            np.full(n, key),
            first + np.arange(n),
        )

    def isolated(self, events: Events, of: Ints | None = None) -> tuple[Ints, Events]:
        """Return the same events, with crowded ones replaced by their zeros in balls.

        `of` gives the number of each event; by default none.
        """
        of = np.zeros(len(events), dtype=np.int64) if of is None else of
        crowded = which(events.crowded)
        if not len(crowded):
            return of, events
        order = np.lexsort([events.t[crowded], *events.what[crowded].T, of[crowded]])
        crowded = crowded[order]
        what = np.concatenate([events.what[crowded], of[crowded, None]], axis=1)
        low, high = (events.t + sign * events.radius for sign in (-1, 1))
        alone = which(~events.crowded)
        found, owner = [events[alone]], [of[alone]]
        known: dict[Any, Events] = {}
        group: list[int] = []
        for place, k in enumerate(crowded.tolist()):
            group.append(k)
            following = crowded[place + 1] if place + 1 < len(crowded) else None
            same = following is not None and (what[place + 1] == what[place]).all()
            if same and low[following] <= max(high[i] for i in group):
                continue
            name = *what[place, :3].tolist(), float(low[group].min()), float(high[group].max())
            if name not in known:
                zeros = self._settled(events[group[0]], *name[3:])
                known[name] = self.exact(zeros, int(events.key[group[0]]))
            found.append(known[name])
            owner.append(np.full(len(known[name]), of[group[0]]))
            group = []
        return np.concatenate(owner), Events.joined(found)

    def _settled(self, event: Events, low: float, high: float) -> list[Zero]:
        """Return the zeros of an event within an interval, in balls."""
        what: Any = tuple(event.what.tolist())
        first, last = self.plane.ends  # the first ball of a multiple root may be too wide
        low, high = max(low, first - self.plane.base_unit), min(high, last + self.plane.base_unit)
        for bits in LEVELS:
            zeros = self.precise.zeros(what, low, high, bits)
            if zeros is not None and (bits == LEVELS[-1] or all(z.order == 0 for z in zeros)):
                return zeros
        if self.precise.vanishes(what):
            return []
        raise UndecidedError(f"{NAMES[what[0]]} of rows {what[1:]} near base value {low:.17g}")

    def zero(self, events: Events, k: int) -> Zero | None:
        """Return an event as a zero in balls; None where there is none."""
        if events.exact[k] >= 0:
            return self.zeros[int(events.exact[k])]
        # One event may stand for several features.
        t, radius = float(events.t[k]), float(events.radius[k])
        name = *events.what[k].tolist(), t, radius
        if name not in self._nearest:
            self._nearest[name] = self._near(events[k], t, radius)
        return self._nearest[name]

    def _near(self, event: Events, t: float, radius: float) -> Zero | None:
        for wider in (1, 16, 256):
            found = self._settled(event, t - wider * radius, t + wider * radius)
            if found:
                return min(found, key=lambda zero: abs(to_float(zero.ball) - t))
        return None


def _times(p: Complexes, q: Complexes) -> Complexes:
    """Multiply stacked polynomials, coefficients on the last axis."""
    m, n = p.shape[-1], q.shape[-1]
    if p.size > FEW:
        product = np.zeros((*p.shape[:-1], m + n - 1), dtype=complex)
        for k in range(m):
            product[..., k : k + n] += p[..., k : k + 1] * q
        return product
    products = (p[..., :, None] * q[..., None, :]).reshape(*p.shape[:-1], m * n)
    return np.asarray(products @ _degrees(m, n))


@cache
def _degrees(m: int, n: int) -> Complexes:
    """Return the matrix that adds up products of coefficients, (m n, m + n - 1), by degree."""
    degree = np.arange(m)[:, None] + np.arange(n)
    return np.asarray(degree.reshape(-1, 1) == np.arange(m + n - 1), dtype=complex)


def _blocks(requests: Sequence[_Request]) -> Any:
    """Yield the same polynomials, few of them together and padded to one length, many in parts."""
    few = [r for r in requests if 0 < len(r.i) <= FEW]
    for request in requests:
        if len(request.i) > FEW:
            what = _what(request)
            for k in range(0, len(what), BLOCK):
                part = slice(k, k + BLOCK)
                yield what[part], request.stack[part], request.errors[part]
    if few:
        longest = max(r.stack.shape[1] for r in few)
        padded = np.zeros((sum(len(r.i) for r in few), longest), dtype=complex)
        at = 0
        for r in few:
            padded[at : at + len(r.i), : r.stack.shape[1]] = r.stack
            at += len(r.i)
        yield (
            np.concatenate([_what(r) for r in few]),
            padded,
            np.concatenate([r.errors for r in few]),
        )


def _what(request: _Request) -> Ints:
    return np.stack([np.full(len(request.i), NUMBER[request.kind]), request.i, request.j], axis=1)


# --- lines ----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class CriticalLines:
    """Critical base values, ascending, both ends of the range first and last.

    Attributes
    ----------
    t, radius : ndarray, shape (n,)
        Base value, and a bound of its error.
    of : ndarray of int, shape (events,)
        The line of each event; -1 for an event that is not a line or is outside the range.
    events : Events
    members : list of list of int
        The events of each line.
    """

    finder: Finder
    t: Floats
    radius: Floats
    of: Ints
    events: Events
    members: list[list[int]]
    known: dict[int, Zero] = field(default_factory=dict)

    def ball(self, line: int, bits: int) -> Any:
        """Return a line's base value to nearly the given number of bits."""
        precise = self.finder.precise
        if line not in self.known:
            last = len(self.t) - 1
            found = None
            if line in (0, last):
                found = Zero(None, 0, partial(_end_of, precise, int(line == last)))
            else:
                members = self.members[line]
                best = sorted(
                    members, key=lambda k: (self.events.exact[k] < 0, self.events.radius[k])
                )
                for k in best:
                    found = self.finder.zero(self.events, k)
                    if found is not None:
                        break
            if found is None:  # not an event after all: any place between its neighbours is right
                found = Zero(None, 0, flint.arb(float(self.t[line])))
            self.known[line] = found
        return precise.refined(self.known[line], bits)

    def only(self, kept: Bools) -> CriticalLines:
        """Return some of the lines."""
        number = np.where(kept, kept.cumsum() - 1, -1)
        of = np.where(self.of >= 0, number[self.of], -1)
        members = [own for own, k in zip(self.members, kept.tolist(), strict=True) if k]
        known = {int(number[k]): zero for k, zero in self.known.items() if kept[k]}
        return replace(
            self, t=self.t[kept], radius=self.radius[kept], of=of, members=members, known=known
        )


def find_lines(finder: Finder, events: Events) -> CriticalLines:
    """Put events in order; equal events, or events that cannot be told apart, become one line."""
    low, high = finder.plane.ends
    wrapped, n = finder.plane.base_range is None, len(events)
    # The ends of the range are lines, too: the numbers after those of the events.
    t = np.append(events.t, [low, high])
    radius = np.append(events.radius, np.full(2, 4 * UNIT * max(abs(low), abs(high))))
    if wrapped:  # an event at the cut is the same on both of its sides
        t[:n] = _about_cut(t[:n], radius[:n], low, high)
    found: list[_Line] = []
    for rows in _clusters(t, radius):
        if len(rows) == 1 or _is_one(events, rows, n):
            best = min(rows, key=lambda k: radius[k])
            found.append(_Line(float(t[best]), float(radius[best]), rows))
        else:
            found += _resolved(finder, events, t, rows, n)
    first, last = (next(k for k, one in enumerate(found) if n + end in one.rows) for end in (0, 1))
    chosen = found[first : last + 1]
    if wrapped:  # an event below the cut is moved one turn on
        turned = [one.turned(finder.precise) for one in found[:first]]
        chosen = [*found[first:last], *turned, found[last]]
    members = [[k for k in one.rows if k < n] for one in chosen]
    if wrapped:
        members[-1] = members[0]
    of = np.full(n, -1)
    for k, own in reversed(list(enumerate(members))):
        of[own] = k
    values = np.array([one.t for one in chosen])
    values[0], values[-1] = low, high
    known = {k: one.zero for k, one in enumerate(chosen[1:-1], start=1) if one.zero is not None}
    radii = np.array([one.radius for one in chosen])
    return CriticalLines(finder, np.maximum.accumulate(values), radii, of, events, members, known)


@dataclass(frozen=True, eq=False)
class _Line:
    """A base value, a bound of its error, the events there, and its ball if known."""

    t: float
    radius: float
    rows: list[int]
    zero: Zero | None = None

    def turned(self, precise: Precise) -> _Line:
        """Return the line a turn later."""
        zero = None if self.zero is None else shifted(precise, self.zero, 1)
        return replace(self, t=self.t + TURN, zero=zero)


def _about_cut(t: Floats, radius: Floats, low: float, high: float) -> Floats:
    """Bring events of a circle into its range; events that may equal its cut go to the low end.

    This includes events that may equal such events without reaching the cut themselves.
    """
    t = np.where(t + radius < low, t + TURN, t)
    reach = high
    while (beyond := t + radius >= reach).any():
        t = np.where(beyond, t - TURN, t)
        reach = float((t - radius)[beyond].min()) + TURN
    return t


def _clusters(t: Floats, radius: Floats) -> list[list[int]]:
    """Return groups of base values that may be equal within their errors, ascending."""
    order = np.argsort(t, kind="stable")
    reach = np.maximum.accumulate((t + radius)[order])
    least = np.minimum.accumulate((t - radius)[order][::-1])[::-1]
    cuts = which(least[1:] > reach[:-1]) + 1
    return [rows.tolist() for rows in np.split(order, cuts)]


def shifted(precise: Precise, zero: Zero, turns: int) -> Zero:
    """Return a zero of a circle's base some turns later."""
    return Zero(None, 0, partial(_turned, precise, zero, turns))


def _turned(precise: Precise, zero: Zero, turns: int) -> Any:
    return precise.refined(zero, flint.ctx.prec) + 2 * turns * flint.arb.pi()


def _is_one(events: Events, rows: Sequence[int], n: int) -> bool:
    """Tell whether events are one because they share a key, each kind of event once."""
    if any(k >= n for k in rows):
        return False
    key = events.key[rows[0]]
    if key < 0 or (events.key[rows] != key).any():
        return False
    places = {
        (*what, t)
        for what, t in zip(events.what[rows].tolist(), events.t[rows].tolist(), strict=True)
    }
    return len({place[:3] for place in places}) == len(places)


def _resolved(
    finder: Finder, events: Events, t: Floats, rows: Sequence[int], n: int
) -> list[_Line]:
    """Return the different base values of a cluster, ascending."""
    precise = finder.precise
    owners: list[tuple[list[int], Zero]] = []
    # Of several events that are one because of their key, one represents all.
    groups: dict[Any, list[int]] = {}
    for k in rows:
        if k >= n:
            name: Any = ("end", k)
        elif events.exact[k] >= 0:
            name = ("exact", int(events.exact[k]))
        else:
            name = ("key", int(events.key[k])) if events.key[k] >= 0 else ("event", k)
        groups.setdefault(name, []).append(k)
    for name, own in groups.items():
        if name[0] == "key" and not _is_one(events, own, n):
            for k in own:
                owners += _owned(finder, events, t, [k])
        elif name[0] == "end":
            upper = own[0] - n
            owners.append((own, Zero(None, 0, partial(_end_of, precise, upper))))
        else:
            owners += _owned(finder, events, t, own)
    found = []
    for ball, members in in_order(owners, lambda item, bits: precise.refined(item[1], bits)):
        value = to_float(ball)
        error = float(ball.rad()) * 1.01 + 2 * UNIT * abs(value)
        every = [k for own, _ in members for k in own]
        found.append(_Line(value, error, every, members[0][1]))
    return found


def _end_of(precise: Precise, upper: int) -> Any:
    return precise.ends("base")[upper]


def _owned(
    finder: Finder, events: Events, t: Floats, own: list[int]
) -> list[tuple[list[int], Zero]]:
    best = min(own, key=lambda k: (events.exact[k] < 0, events.radius[k]))
    zero = finder.zero(events, best)
    if zero is None:
        return []
    turns = round(float(t[best] - events.t[best]) / TURN)
    if turns:
        zero = shifted(finder.precise, zero, turns)
    return [(own, zero)]


INSIDE = 0.43
"""Where an interval is looked at: off its middle, which may be a place of symmetry."""

PAIRS = 2**20
"""Pairs of pieces that are looked at together, about: some 60 MB."""

DRIFT = 64.0
"""Side conditions, whose largest coefficient is 1, change by at most so much with each unit."""

END = -2
"""Stands for the event of an interval's end that is an end of the base's range."""


@dataclass(frozen=True, eq=False)
class ContactPieces:
    """Contacts over intervals of the base, one in each row, and pairs that are special throughout.

    Attributes
    ----------
    feature : ndarray of int, shape (k,)
    branch : ndarray of int, shape (k,)
        -1 or +1, as in `Root`.
    start, end : ndarray, shape (k,)
        Base values.
    first, last : ndarray of int, shape (k,)
        The events at start and end, as indices of `events`; `END` at the ends of the base's range.
    enters : ndarray of bool, shape (k,)
        Whether the pair enters collision there, going up the lift.
    low, high : ndarray, shape (k,)
        Lift values between which the contact lies; for an angle `low` may be on any full turn.
    events : Events
        Events at which a contact begins, ends or jumps, or bodies may touch along a fibre.
    lines : ndarray of int
        The events that are lines, ascending.
    walls : ndarray of int
        The events at which a form of a feature vanishes along a whole fibre.
    base_only : ndarray of bool, shape (pairs,)
        Pairs that do not depend on the lift.
    idle : ndarray of bool, shape (pairs,)
        Pairs that never touch, because they are apart, or in collision, everywhere.
    resting : ndarray of bool, shape (pairs,)
        Pairs with a feature whose form vanishes everywhere, for example a slide along an edge. They
        may touch without overlap on open sets.
    """

    feature: Ints
    branch: Ints
    start: Floats
    end: Floats
    first: Ints
    last: Ints
    enters: Bools
    low: Floats
    high: Floats
    events: Events
    lines: Ints
    walls: Ints
    base_only: Bools
    idle: Bools
    resting: Bools

    def roots(self, plane: Plane, k: Ints) -> Ints:
        """Return the root that each of some contacts follows, as `Root`, shape (len(k), 3)."""
        return np.stack([plane.count + self.feature[k], self.branch[k], np.zeros_like(k)], axis=1)


def find_pieces(plane: Plane, finder: Finder) -> ContactPieces:
    """Find all contacts of the bodies of a plane, and the walls (forms that vanish on a fibre)."""
    contacts = plane.contacts
    if not plane.pairs:
        none, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
        no = np.zeros(0, dtype=np.bool_)
        rows = (none, none, nothing, nothing, none, none, no, nothing, nothing)
        return ContactPieces(*rows, NO_EVENTS, none, none, no, no, no)
    forms, sides = plane.scaled[plane.count :], plane.sides
    doubt = 16 * plane.eps[plane.count :]
    low, high = _bounds(plane, forms)
    most = _bounds(plane, sides)[1]
    alive = contacts.touching & (low <= doubt) & (high >= -doubt)
    alive &= (most >= -16 * plane.side_eps).all(axis=1)
    lifts = forms[:, :, 1:].any(axis=(1, 2))
    moved: Bools = np.asarray(lifts | sides[:, :, :, 1:].any(axis=(1, 2, 3)))
    base_only = ~_any_of(moved, contacts.pair, plane.pairs)
    idle = ~_any_of(alive, contacts.pair, plane.pairs)
    resting = _any_of(alive & ~forms.any(axis=(1, 2)), contacts.pair, plane.pairs)
    walls = _walls(plane, finder, np.flatnonzero(alive))
    found = _Contacts(plane, finder, np.flatnonzero(alive & lifts))
    events = Events.joined([found.events, walls])
    at_walls = len(found.events) + np.arange(len(walls))
    return ContactPieces(
        *found.rows,
        events,
        np.concatenate([found.lines, at_walls]),
        at_walls,
        base_only,
        idle,
        resting,
    )


def _any_of(found: Bools, group: Ints, count: int) -> Bools:
    return np.bincount(group[found], minlength=count) > 0


def _bounds(plane: Plane, tables: Floats) -> tuple[Floats, Floats]:
    """Return values that scaled forms (..., 3, 3) do not leave, whatever the joints do.

    A turn changes a form by at most the length of its two coefficients, a slide by their sum.
    """
    circles = plane.base_kind == "revolute", plane.lift_kind == "revolute"
    first, second, product = tables[..., 1:, 0], tables[..., 0, 1:], tables[..., 1:, 1:]
    by_base, by_lift = (
        np.hypot(c[..., 0], c[..., 1]) if circle else np.abs(c).sum(axis=-1)
        for c, circle in zip((first, second), circles, strict=True)
    )
    if all(circles):  # the largest singular value
        both = np.sqrt((product**2).sum(axis=(-2, -1)) / 2 + _gap_of_squares(product) / 2)
    else:
        over = np.hypot(product[..., 0], product[..., 1]) if circles[1] else np.abs(product).sum(-1)
        both = np.hypot(over[..., 0], over[..., 1]) if circles[0] else over.sum(axis=-1)
    reach = by_base + by_lift + both
    return tables[..., 0, 0] - reach, tables[..., 0, 0] + reach


def _gap_of_squares(m: Floats) -> Floats:
    """Return the difference of the squared singular values of 2 x 2 matrices."""
    a, b, c, d = m[..., 0, 0], m[..., 0, 1], m[..., 1, 0], m[..., 1, 1]
    return np.asarray(np.hypot(a * a + b * b - c * c - d * d, 2 * (a * c + b * d)))


# --- pieces ---------------------------------------------------------------------------------------


class _Contacts:
    """The contacts of some features: `rows` (first in `ContactPieces`), their events, and lines."""

    def __init__(self, plane: Plane, finder: Finder, chosen: Ints) -> None:
        self.plane, self.finder, self.chosen = plane, finder, chosen
        m, contacts = plane.count, plane.contacts
        own = finder.events(finder.own(m + chosen))
        # Features of one curve share their folds and jumps.
        curve = contacts.curves[own.what[:, 1] - m]
        own.key[:] = contacts.keys.max(initial=0) + 1 + len(KINDS) * curve + own.what[:, 0]
        first_side = m + len(contacts.forms)
        side_of = first_side + SIDES * chosen[:, None] + np.arange(SIDES)
        varies = plane.sides[chosen].reshape(len(chosen), SIDES, 9)[:, :, 1:].any(axis=2)
        # Two corners stop touching where an edge with one of these corners does; that event is
        # simple.
        varies &= ~contacts.corners[chosen][:, None]
        k, s = np.nonzero(varies)
        met = finder.events(finder.meetings(m + chosen[k], side_of[k, s]))
        side = met.what[:, 1:].max(axis=1, initial=0) - first_side
        met.key[:] = contacts.keys.reshape(-1)[side]
        feature = np.searchsorted(chosen, side // SIDES)
        given, taken = self._handed_over(met)
        of = np.concatenate([np.searchsorted(chosen, own.what[:, 1] - m), feature, given])
        found = Events.joined([own, met, met[taken]])
        kept = which(self._matters(of, found))
        of, found = finder.isolated(found[kept], of[kept])
        self._cut(of, found)

    def _handed_over(self, met: Events) -> tuple[Ints, Ints]:
        """Return which features of two corners share events of edges, and which events."""
        contacts, chosen = self.plane.contacts, self.chosen
        corners = which(contacts.corners[chosen])
        keys = contacts.keys[chosen[corners]]
        k, side = np.nonzero(keys >= 0)
        key, feature = keys[k, side], corners[k]
        pairs = np.unique(np.stack([key, feature], axis=1), axis=0)
        order = np.argsort(met.key, kind="stable")
        start = np.searchsorted(met.key[order], pairs[:, 0])
        end = np.searchsorted(met.key[order], pairs[:, 0] + 1)
        pick, event = ranges(start, end)
        return pairs[pick, 1], order[event]

    def _matters(self, of: Ints, events: Events) -> Bools:
        """Tell at which events a root of the feature may be a contact.

        At all other events a side condition of both roots is negative by more than it can change so
        near.
        """
        plane, feature = self.plane, self.chosen[of]
        row = plane.count + feature
        c = np.einsum("ni,nij->jn", basis(plane.base_kind, events.t), plane.table[row])
        slack = 4 * events.radius / plane.base_unit
        values, errors, real = plane.roots_and_errors(row, c, slack)
        over, _ = _sides_over(plane, feature, events.t, values)
        moved = np.sqrt(events.radius / plane.base_unit) + np.minimum(errors / plane.lift_unit, 1.0)
        drift = DRIFT * (moved + 1e-9)
        held = (over >= -drift.T[:, :, None]).all(axis=2)
        return np.asarray(held.any(axis=1) & (real >= 0))

    def _cut(self, of: Ints, events: Events) -> None:
        """Cut the base at each feature's events, and keep the intervals that are contacts."""
        plane, low, high = self.plane, *self.plane.ends
        of, events = self._in_order(of, events)
        n, every = len(self.chosen), np.arange(len(self.chosen))
        t = np.concatenate([events.t, np.full(n, low), np.full(n, high)])
        owner = np.concatenate([of, every, every])
        number = np.concatenate([np.arange(len(of)), np.full(2 * n, END)])
        # Events that balls have ordered keep this order, even if their doubles do not show it.
        place = np.concatenate([np.arange(len(of)) + n, every, len(of) + n + every])
        order = np.lexsort([place, owner])
        owner, t, number = owner[order], t[order], number[order]
        begin = which(owner[1:] == owner[:-1])
        self.events = events
        f, start, end = owner[begin], t[begin], t[begin + 1]
        first, last = number[begin], number[begin + 1]
        at, exact = self._inside(start, end, first, last)
        touching = self._touching(f, at, exact)
        strict = np.array([self._is_strict(events)]).reshape(-1)
        kind = np.append(strict, True)[np.where(first == END, len(strict), first)]
        near = self._near(f, start)
        rows, lines = [], [np.zeros(0, dtype=np.int64)]
        enters = _falls(plane, plane.table[plane.count :][self.chosen[f]], at)
        after = np.append(f[1:] == f[:-1], False)[: len(f)]
        for branch in (0, 1):
            here = touching[:, branch]
            hard = kind | near[:, branch]
            follows = here & after & np.append(here[1:], False)[: len(here)]
            goes_on = follows & ~np.append(hard[1:], True)[: len(here)]
            went_on = np.append(False, goes_on[:-1])[: len(here)]
            a, b = which(here & ~went_on), which(here & ~goes_on)
            sign = np.full(len(a), 2 * branch - 1)
            rows.append(
                (self.chosen[f[a]], sign, start[a], end[b], first[a], last[b], enters[a, branch])
            )
            lines += [first[a][first[a] >= 0], last[b][last[b] >= 0]]
        feature, sign, starts, ends, one, other, sense = (
            np.concatenate(x) for x in zip(*rows, strict=True)
        )
        low_v, high_v = self._boxes(feature, sign, starts, ends)
        self.rows = feature, sign, starts, ends, one, other, sense, low_v, high_v
        self.lines = np.unique(np.concatenate(lines))

    def _is_strict(self, events: Events) -> Bools:
        """Tell which events always end a piece, because an angle may jump there or roots meet."""
        first = self.plane.count + len(self.plane.contacts.forms)
        return np.asarray(events.what[:, 1:].max(axis=1, initial=0) < first)

    def _in_order(self, of: Ints, events: Events) -> tuple[Ints, Events]:
        """Sort events by feature and base value; balls decide where doubles cannot."""
        low, high = self.plane.ends
        inside = (events.t >= low - events.radius) & (events.t <= high + events.radius)
        order = np.lexsort([events.t, of])
        order = order[inside[order]]
        of, events = of[order], events[order]
        lost: list[int] = []  # balls show that it is not an event

        def decide(rows: list[int], _: list[float]) -> list[list[int]]:
            groups = self._ranked(events, rows)
            lost.extend({*rows}.difference(*groups))
            return groups

        order, group, _ = ranked(of, events.t, events.radius, False, decide)
        # Of equal events, the first that ends a piece represents all.
        order = order[np.lexsort([~self._is_strict(events)[order], group])]
        order = order[np.unique(group, return_index=True)[1]]
        before = events.t.copy()
        near_end = (before - events.radius <= low) | (before + events.radius >= high)
        kept = np.array(
            [
                row
                for row in order[~np.isin(order, lost)].tolist()
                if not near_end[row] or self._within(events, row)
            ],
            dtype=np.int64,
        )
        # On a circle some events are now a turn away, at the other end of their feature's events.
        kept = kept[np.lexsort([np.sign(events.t - before)[kept], of[kept]])]
        return of[kept], events[kept]

    def _ranked(self, events: Events, rows: list[int]) -> list[list[int]]:
        """Return events that overlap in their true order, equal ones together."""
        if _is_one(events, rows, len(events)):
            return [rows]
        zeros = [(r, self.finder.zero(events, r)) for r in rows]
        for r, zero in zeros:  # known zeros need not be found again
            if zero is not None and events.exact[r] < 0:
                events.exact[r] = len(self.finder.zeros)
                self.finder.zeros.append(zero)
        known = [(r, zero) for r, zero in zeros if zero is not None]
        groups = in_order(known, lambda item, bits: self.finder.precise.refined(item[1], bits))
        return [[r for r, _ in group] for _, group in groups]

    def _within(self, events: Events, row: int) -> bool:
        """Tell whether an event beside an end of the range lies inside; on the end counts as no.

        On a circle the end is the cut; an event beyond it lies a turn away, inside the other end.
        """
        plane, precise = self.plane, self.finder.precise
        zero = self.finder.zero(events, row)
        if zero is None:
            return False
        upper = bool(events.t[row] > sum(plane.ends) / 2)
        end = Zero(None, 0, partial(_end_of, precise, int(upper)))
        groups = in_order([zero, end], precise.refined)
        if len(groups) == 1:
            return False
        inside = (groups[0][1][0] is zero) == upper
        if not inside and plane.base_range is None:
            turns = -1 if upper else 1
            events.t[row] += turns * TURN
            events.exact[row] = len(self.finder.zeros)
            self.finder.zeros.append(shifted(precise, zero, turns))
            return True
        return inside

    def _inside(
        self, start: Floats, end: Floats, first: Ints, last: Ints
    ) -> tuple[Floats, dict[int, Any]]:
        """Return a base value inside each interval, and exact ones where doubles are too close."""
        events = self.events
        radius = np.append(events.radius, 0.0)
        doubt = radius[np.maximum(first, -1)] + radius[np.maximum(last, -1)]  # 0 at an end
        at = start + INSIDE * (end - start)
        exact: dict[int, Any] = {}
        for k in which(end - start <= 8 * doubt + 64 * UNIT * np.abs(at)).tolist():
            a, b = (self._ball_of(e, upper) for e, upper in ((first[k], 0), (last[k], 1)))
            if a is not None and b is not None:
                with precision(1024):
                    exact[k] = midpoint(a, b)
        return at, exact

    def _ball_of(self, event: int, upper: int) -> Any:
        precise = self.finder.precise
        if event == END:
            with precision(1024):
                return precise.ends("base")[int(upper)]
        zero = self.finder.zero(self.events, event)
        return None if zero is None else precise.refined(zero, 1024)

    # --- what is a contact ----------------------------------------------------------------------

    def _touching(self, f: Ints, t: Floats, exact: dict[int, Any]) -> Bools:
        """Tell whether both roots of features over base values are contacts, (n, 2)."""
        plane, feature = self.plane, self.chosen[f]
        row = plane.count + feature
        c = np.einsum("ni,nij->jn", basis(plane.base_kind, t), plane.table[row])
        values, errors, real = plane.roots_and_errors(row, c)
        over, lift_slopes = _sides_over(plane, feature, t, values)
        off = np.minimum(errors.T, 8 * plane.lift_unit)
        side_doubt = 16 * plane.side_eps[feature][:, None, :] + off[:, :, None] * lift_slopes
        held = over > side_doubt
        missed = over < -side_doubt
        constant = ~plane.sides.reshape(-1, SIDES, 9)[feature][:, :, 1:].any(axis=2)
        held |= (constant & (plane.sides[feature][:, :, 0, 0] >= 0))[:, None, :]
        result = np.asarray(held.all(axis=2) & (real > 0)[:, None])
        unknown = ~missed.any(axis=2) & ~result & (real >= 0)[:, None]
        for k, branch in np.argwhere(unknown).tolist() + [
            [k, b] for k in exact for b in (0, 1) if not unknown[k, b]
        ]:
            result[k, branch] = self._decided(int(feature[k]), branch, exact.get(k, t[k]))
        if plane.lift_kind == "prismatic":
            result[plane.affine[row], 1] = False
        return result

    def _decided(self, feature: int, branch: int, at: Any) -> bool:
        """Tell in balls whether a root of a feature is a contact at a base value."""
        plane, precise = self.plane, self.finder.precise
        row = plane.count + feature
        with precision(1024):
            t = flint.arb(at)
        if precise.real(row, lambda bits: t) < 0:
            return False
        if plane.lift_kind == "prismatic" and plane.affine[row] and branch:
            return False

        def root(bits: int) -> Any:
            return precise.root(row, 2 * branch - 1, t, bits)

        varied = plane.sides[feature].reshape(SIDES, 9)[:, 1:].any()
        with precision(256):
            if varied and root(256) is None:
                return False
        return precise.holds(feature, t, root)

    def _near(self, f: Ints, t: Floats) -> Bools:
        """Tell at which starts a side condition may touch zero, so that two contacts may meet."""
        plane, feature = self.plane, self.chosen[f]
        row = plane.count + feature
        c = np.einsum("ni,nij->jn", basis(plane.base_kind, t), plane.table[row])
        values, _, _ = plane.roots_and_errors(row, c)
        over, _ = _sides_over(plane, feature, t, values)
        varied: Any = plane.sides.reshape(-1, SIDES, 9)[feature][:, :, 1:].any(axis=2)
        return np.asarray(((np.abs(over) <= WALL) & varied[:, None]).any(axis=2))

    def _boxes(
        self, feature: Ints, branch: Ints, start: Floats, end: Floats
    ) -> tuple[Floats, Floats]:
        """Return lift values between which pieces lie, from their ends and turning points."""
        plane = self.plane
        used = np.unique(feature)
        turns = self._turning(used)
        of, at = turns
        order = np.lexsort([at, of])
        of, at = of[order], at[order]
        k = np.searchsorted(used, feature)
        big = 4 * (plane.ends[1] - plane.ends[0]) + 1
        index = of * big + (at - plane.ends[0])
        first = np.searchsorted(index, k * big + (start - plane.ends[0]))
        last = np.searchsorted(index, k * big + (end - plane.ends[0]))
        pick, event = ranges(first, last)
        inset = 1e-9 * (end - start)
        owner = np.concatenate([np.arange(len(feature))] * 2 + [pick])
        t = np.concatenate([start + inset, end - inset, at[event]])
        # Two more places, because an angle may go up to a turn between its ends.
        for part in (1 / 3, 2 / 3):
            owner = np.concatenate([owner, np.arange(len(feature))])
            t = np.concatenate([t, start + part * (end - start)])
        order = np.lexsort([t, owner])
        owner, t = owner[order], t[order]
        rows = np.stack([plane.count + feature, branch, np.zeros_like(branch)], axis=1)[owner]
        v = plane.follow(rows, t[:, None])[:, 0]
        if plane.lift_kind == "revolute":  # pieces do not jump: steps of less than half a turn
            step = np.diff(v, prepend=v[:1])
            new = np.append(True, owner[1:] != owner[:-1])[: len(owner)]
            jumps = np.where(new, 0.0, -TURN * whole_turns(step)).cumsum()
            v = v + jumps - jumps[which(new)][new.cumsum() - 1] if len(v) else v
        begin = np.searchsorted(owner, np.arange(len(feature)))
        if not len(feature):
            return np.zeros(0), np.zeros(0)
        return np.minimum.reduceat(v, begin), np.maximum.reduceat(v, begin)

    def _turning(self, features: Ints) -> tuple[Ints, Floats]:
        """Return where curves of features turn back along the lift: feature and base value."""
        plane = self.plane
        if not len(features):
            return np.zeros(0, dtype=np.int64), np.zeros(0)
        slopes = normalised(along_base(plane, plane.scaled[plane.count + features]))
        own = Finder(_Slopes(plane, features, slopes), self.finder.precise)  # type: ignore[arg-type]
        n = len(features)
        return own.quick(np.arange(n), n + np.arange(n))


class _Slopes:
    """A plane of some features' forms and their derivatives along the base, used only for boxes."""

    def __init__(self, plane: Plane, features: Ints, slopes: Floats) -> None:
        rows = plane.count + features
        self.scaled = np.concatenate([plane.scaled[rows], slopes])
        self.eps = np.concatenate([plane.eps[rows], np.full(len(slopes), 8 * UNIT)])
        self.base_kind, self.lift_kind = plane.base_kind, plane.lift_kind
        self.ends, self.base_range = plane.ends, plane.base_range
        self.lift_range, self.lift_ends = plane.lift_range, plane.lift_ends
        self.base_unit, self.lift_unit = plane.base_unit, plane.lift_unit


def along_base(plane: Plane, tables: Floats) -> Floats:
    """Return the derivative of scaled forms along the base, in its unit."""
    slope = np.zeros_like(tables)
    if plane.base_kind == "revolute":
        slope[:, 1], slope[:, 2] = tables[:, 2], -tables[:, 1]
    else:
        slope[:, 0], slope[:, 1] = tables[:, 1], 2 * tables[:, 2]
    return slope


def _sides_over(plane: Plane, feature: Ints, t: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Return side conditions of features at lift values (2, n) over base values, (n, 2, sides).

    Also returns the sizes of their slopes along the lift, for a unit of the lift.
    """
    factors = basis(plane.base_kind, t / plane.base_unit)
    over = np.einsum("ni,nsij->nsj", factors, plane.sides[feature])
    place = np.nan_to_num(v.T / plane.lift_unit)
    values = np.einsum("nsj,nrj->nrs", over, basis(plane.lift_kind, place))
    swing = np.abs(over[..., 1]) + 2 * np.abs(over[..., 2])
    return values, np.broadcast_to(swing[:, None], values.shape) / plane.lift_unit


def _falls(plane: Plane, tables: Floats, t: Floats) -> Bools:
    """Tell whether a form falls along the lift at both roots, (n, 2).

    On a circle a form is positive from theta - alpha to theta + alpha, even if both are equal.
    """
    if plane.lift_kind == "revolute":
        return np.tile([False, True], (len(t), 1))
    c = np.einsum("ni,nij->nj", basis(plane.base_kind, t), tables)
    bends = np.where(c[:, 2] == 0, -c[:, 1], c[:, 2])  # an affine root stands first
    return np.stack([bends > 0, bends < 0], axis=1)


# --- walls ----------------------------------------------------------------------------------------


def _walls(plane: Plane, finder: Finder, alive: Ints) -> Events:
    """Return base values at which a feature's form vanishes on the whole fibre.

    If one of its side conditions is negative on the whole fibre, the feature is not a wall.
    """
    rows = plane.count + alive
    table = plane.scaled[rows]
    size = np.abs(table).sum(axis=1)
    largest = size[:, 1:].max(axis=1, initial=0.0)
    part = np.where(largest > 0, 1 + size[:, 1:].argmax(axis=1), 0)
    requests = [
        finder.of_kind(kind, rows[part == k])
        for k, kind in enumerate(("constant", "first", "second"))
    ]
    events = finder.events(requests)
    row = events.what[:, 1]
    factors = basis(plane.base_kind, events.t / plane.base_unit)
    left = np.abs(np.einsum("ni,nij->nj", factors, plane.scaled[row]))
    doubt = 32 * plane.eps[row] + 4 * events.radius / plane.base_unit
    blank = (left <= doubt[:, None]).all(axis=1)
    over = np.einsum("ni,nsij->nsj", factors, plane.sides[row - plane.count])
    swing = np.hypot(over[..., 1], over[..., 2])
    if plane.lift_kind == "prismatic":
        swing = np.abs(over[..., 1]) + np.abs(over[..., 2])
    slack = 16 * plane.side_eps[row - plane.count] + 4 * events.radius[:, None] / plane.base_unit
    possible = (over[..., 0] + swing >= -slack).all(axis=1)
    return finder.isolated(events[which(blank & possible)])[1]


# --- crossings ------------------------------------------------------------------------------------


def crossings(plane: Plane, pieces: ContactPieces, finder: Finder) -> Events:
    """Return events at which contacts of different pairs cross, or a contact and a form.

    Only pieces whose boxes meet are paired. Some events may be spurious, but none is missing.
    """
    m, contacts = plane.count, plane.contacts
    one, other = _meeting_boxes(plane, pieces)
    one, other = _crossing(plane, pieces, one, other)
    size = m + len(contacts.forms)
    of_curve = _first_of_curve(contacts.curves)
    a, b = of_curve[pieces.feature[one]], of_curve[pieces.feature[other]]
    key, group = np.unique(np.minimum(a, b) * size + np.maximum(a, b), return_inverse=True)
    first, second = m + key // size, m + key % size
    found = finder.events(finder.meetings(first, second))
    # An event of a single row, where a form of degree one loses its root, has no pair of pieces.
    alone = found.what[:, 1] == found.what[:, 2]
    lone, found = found[which(alone)], found[which(~alone)]
    keys = _shared(contacts.keys[found.what[:, 1] - m], contacts.keys[found.what[:, 2] - m])
    found.key[:] = keys
    # Every zero is checked for all pieces of its two features.
    lowest = np.minimum(found.what[:, 1], found.what[:, 2]) - m
    rows = np.searchsorted(key, lowest * size + found.what[:, 1:].max(axis=1, initial=0) - m)
    order = np.argsort(group, kind="stable")
    begin = np.searchsorted(group[order], np.arange(len(key) + 1))
    pick, k = ranges(begin[rows], begin[rows + 1])
    i, j, t, radius = one[order[k]], other[order[k]], found.t[pick], found.radius[pick]
    slack = NEAR * plane.base_unit + radius
    near = np.ones(len(t), dtype=np.bool_)
    for end in (i, j):
        near &= (t >= pieces.start[end] - slack) & (t <= pieces.end[end] + slack)
    i, j, t, pick = i[near], j[near], t[near], pick[near]
    apart = _values(plane, pieces, i, t) - _values(plane, pieces, j, t)
    if plane.lift_kind == "revolute":
        apart -= TURN * whole_turns(apart)
    kept = np.unique(pick[np.abs(apart) <= AGREE * plane.lift_unit])
    return Events.joined([lone, found[kept], _crossed_forms(plane, pieces, finder)])


def _first_of_curve(curves: Ints) -> Ints:
    """Return for each feature the first one of its curve, which represents all."""
    _, first, back = np.unique(curves, return_index=True, return_inverse=True)
    return np.asarray(first[back])


def _shared(one: Ints, other: Ints) -> Ints:
    """Return a key that two rows of keys share, or -1."""
    same = (one[:, :, None] == other[:, None, :]) & (one[:, :, None] >= 0)
    found = np.where(same, one[:, :, None], -1).max(axis=(1, 2), initial=-1)
    return np.asarray(found)


def _crossing(plane: Plane, pieces: ContactPieces, one: Ints, other: Ints) -> tuple[Ints, Ints]:
    """Leave out pairs of pieces whose common points are all known as events already.

    These are pieces of one curve, and features that end at the same pair of corners. Forms of such
    features touch there and have no other common zero, unless two edges keep a distance.
    """
    contacts = plane.contacts
    a, b = pieces.feature[one], pieces.feature[other]
    same = contacts.curves[a] == contacts.curves[b]
    ends = contacts.ends[a][:, :, None] == contacts.ends[b][:, None, :]
    touching = (ends & (contacts.ends[a] >= 0)[:, :, None]).any(axis=(1, 2))
    touching &= contacts.corners[a] | contacts.corners[b] | contacts.sharp[a]
    kept = ~same & ~touching
    return one[kept], other[kept]


def _meeting_boxes(plane: Plane, pieces: ContactPieces) -> tuple[Ints, Ints]:
    """Return pairs of pieces, of different pairs of bodies, whose boxes meet."""
    pair = plane.contacts.pair[pieces.feature]
    every = np.arange(len(pair))
    middle = (pieces.low + pieces.high) / 2
    half = (pieces.high - pieces.low) / 2 + BOX * plane.lift_unit
    near = NEAR * plane.base_unit
    found = [(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))]
    order = np.argsort(pieces.start, kind="stable")
    last = np.searchsorted(pieces.start[order], pieces.end[order] + near, side="right")
    many = np.cumsum(last - every - 1)
    cuts = np.arange(PAIRS, many.max(initial=0), PAIRS)
    for at in np.split(every, np.searchsorted(many, cuts)):
        pick, j = ranges(at + 1, last[at])
        i, j = order[at[pick]], order[j]
        apart = np.abs(middle[j] - middle[i])
        if plane.lift_kind == "revolute":
            apart = np.abs(apart - TURN * np.round(apart / TURN))
        met = (apart <= half[i] + half[j]) & (pair[j] != pair[i])
        found.append((i[met], j[met]))
    first, second = (np.concatenate(x) for x in zip(*found, strict=True))
    return first, second


def _values(plane: Plane, pieces: ContactPieces, k: Ints, t: Floats) -> Floats:
    """Return lift values of pieces over base values, each kept within its piece, (n,)."""
    t = np.clip(t, pieces.start[k], pieces.end[k])
    return plane.follow(pieces.roots(plane, k), t[:, None])[:, 0]


def _crossed_forms(plane: Plane, pieces: ContactPieces, finder: Finder) -> Events:
    """Return the events at which a contact may cross a form that stands alone."""
    m = plane.count
    lifts = np.flatnonzero(plane.scaled[:m, :, 1:].any(axis=(1, 2)))
    feature = _first_of_curve(plane.contacts.curves)[pieces.feature]
    features = np.unique(feature)
    i, j = (x.ravel() for x in np.meshgrid(lifts, m + features, indexing="ij"))
    found = finder.events(finder.meetings(i, j))
    alone = found.what[:, 1] == found.what[:, 2]
    lone, found = found[which(alone)], found[which(~alone)]
    of = found.what[:, 1:].max(axis=1, initial=0) - m
    order = np.argsort(feature, kind="stable")
    begin = np.searchsorted(feature[order], of)
    end = np.searchsorted(feature[order], of + 1)
    pick, k = ranges(begin, end)
    k, t = order[k], found.t[pick]
    slack = NEAR * plane.base_unit + found.radius[pick]
    near = (t >= pieces.start[k] - slack) & (t <= pieces.end[k] + slack)
    return Events.joined([lone, found[np.unique(pick[near])]])


# --- all events -----------------------------------------------------------------------------------


def find_events(precise: Precise) -> tuple[CriticalLines, ContactPieces]:
    """Return every base value at which the order of roots may change, and the contacts of bodies.

    The ends of the range are included. Some values may be spurious, which only costs time. None is
    missing, because that would make the answer wrong.
    """
    plane, finder = precise.plane, Finder(precise.plane, precise)
    pieces = find_pieces(plane, finder)
    found = [pieces.events, finder.isolated(finder.events(_of_forms(plane, finder)))[1]]
    if plane.pairs:
        found.append(finder.isolated(crossings(plane, pieces, finder))[1])
    # All events are kept, because pieces refer to them; events that are not lines are not in
    # `lines`.
    events, own = Events.joined(found), len(pieces.events)
    chosen = np.concatenate([pieces.lines, np.arange(own, len(events))])
    lines = find_lines(finder, events[chosen])
    of = np.full(len(events), -1)
    of[chosen] = lines.of
    return replace(lines, of=of), pieces


def _of_forms(plane: Plane, finder: Finder) -> list[Any]:
    """Return the events of forms that stand alone, and the events at which two of them meet."""
    lifts = plane.scaled[: plane.count, :, 1:].any(axis=(1, 2))
    moved = which(lifts)
    i, j = np.nonzero(moved[:, None] < moved)
    meetings = finder.meetings(moved[i], moved[j])
    return [*finder.fixed(which(~lifts)), *finder.own(moved), *meetings]
