"""Cells of two joints in which every form is positive: a cylindrical decomposition.

For a fixed value of one joint, the base, each form is a one-joint form in the other, the lift, and
Theorem 2 (or the quadratic formula) gives its roots. How these roots lie to each other changes only
at critical base values, and each kind of these is a root of one univariate polynomial. Between two
critical values the cells are read off at the midpoint. No grid, no sample, no starting guess.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, turns_up_to, turns_within
from qbound.forms.circle import polar
from qbound.forms.harmonic import HarmonicForm, Kind, basis
from qbound.tolerances import (
    BEYOND_JUMP,
    BLANK,
    NEAR_CIRCLE,
    NEGLIGIBLE,
    POSITIVE,
    ROUNDING,
    SAME_CRITICAL,
    SAME_POINT,
    TANGENT,
    UNCHANGED,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Complexes = NDArray[np.complex128]
Range = tuple[float, float] | None

PROBES = np.array([0.29, 0.5, 0.77])

BLOCK = 2**14
"""Polynomials that are solved at once: fast enough, small enough for any memory."""


class Root(NamedTuple):
    """A root of one form along the lift, as a function of the base within a slab.

    Attributes
    ----------
    form : int
        Index of the form; -1 and -2 are the lower and the upper end of the lift's range.
    branch : int
        -1 / +1: theta - / + arccos, or the lower / upper root of a quadratic; 0 for an end.
    turns : int
        Full turns added.
    """

    form: int
    branch: int
    turns: int = 0


LOWEST, HIGHEST = Root(-1, 0), Root(-2, 0)


class Cell(NamedTuple):
    """A piece of the plane over one slab, between two roots, in which every form is positive.

    On a lift that turns round, a cell from end to end is the whole fibre and has no boundary.
    """

    slab: int
    lower: Root
    upper: Root


class Plane:
    """Forms of two joints, scaled to largest coefficient 1, with one joint as base.

    A prismatic joint is measured in its farthest limit for this (`scaled`); `table` is the same
    forms in the joints' own units.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Of two joints.
    ranges : sequence of two (low, high) or None
        None for a revolute joint that turns all the way round.
    base : int
        0 or 1.
    """

    def __init__(self, forms: HarmonicForm, ranges: Sequence[Range], base: int) -> None:
        table = np.asarray(forms.coefficients, dtype=float)
        table = table if base == 0 else np.swapaxes(table, 1, 2)
        self.base_kind: Kind = forms.kinds[base]
        self.lift_kind: Kind = forms.kinds[1 - base]
        self.base_range, self.lift_range = ranges[base], ranges[1 - base]
        self.ends = self.base_range or (-math.pi, math.pi)
        self.lift_ends = self.lift_range or (-math.pi, math.pi)
        # In mm the high powers of a slide have coefficients that would pass for rounding.
        self.base_unit = _unit(self.base_kind, self.ends)
        self.lift_unit = _unit(self.lift_kind, self.lift_ends)
        powers = np.outer(self.base_unit ** np.arange(3), self.lift_unit ** np.arange(3))
        table = table * powers
        largest = np.abs(table).max(axis=(1, 2), keepdims=True)
        table = table / np.where(largest > 0, largest, 1.0)
        self.scaled: Floats = np.where(np.abs(table) > NEGLIGIBLE, table, 0.0)
        self.table: Floats = self.scaled / powers
        # Largest values of the coefficients along the lift: what is rounding is so beside these.
        self.sizes: Floats = np.abs(self.scaled).sum(axis=1) / self.lift_unit ** np.arange(3)
        # Ends of the lift's range are roots of forms -1 and -2: two rows of zeros at the end.
        self._rows = np.concatenate([self.table, np.zeros((2, 3, 3))])
        self._row_sizes = np.concatenate([self.sizes, np.zeros((2, 3))])
        slides = self.lift_kind == "prismatic"
        self.affine = [slides and not any(row) for row in self.table[:, :, 2].tolist()]

    def along_lift(self, t: Floats) -> Floats:
        """Return the coefficients of every form along the lift, shape (len(t), m, 3)."""
        m, factors = len(self.table), basis(self.base_kind, t)
        table = np.moveaxis(self.table, 1, 0).reshape(3, 3 * m)
        return _settled((factors @ table).reshape(len(t), m, 3), self.sizes, self.lift_kind)

    def positive(self, t: Floats, v: Floats, least: float) -> Bools:
        """Tell whether every form exceeds `least` at paired base and lift values, (len(t),)."""
        products = basis(self.base_kind, t)[:, :, None] * basis(self.lift_kind, v)[:, None, :]
        products, left = products.reshape(-1, 9), np.arange(len(t))
        for forms in np.split(self.table.reshape(-1, 9), range(16, len(self.table), 16)):
            left = left[(products[left] @ forms.T > least).all(axis=1)]  # few survive many forms
        return np.isin(np.arange(len(t)), left)

    def open(self, t: Floats, low: Floats, high: Floats, least: float) -> Bools:
        """Tell whether forms that do not change sign there are positive between lift values, (k,).

        One place may be where a form touches zero, so there are three, at uneven parts.
        """
        v = low[:, None] + (high - low)[:, None] * PROBES
        found = self.positive(np.repeat(t, len(PROBES)), v.ravel(), least)
        return np.asarray(found.reshape(-1, len(PROBES)).any(axis=1))

    def roots(self, t: Floats) -> Floats:
        """Return both roots of every form over base values, shape (2, len(t), m), NaN where none.

        Revolute: theta - alpha and theta + alpha, theta in (-pi, pi]; a double root is theta twice
        or theta -+ pi, two ends that keep their order. Prismatic: the lower and the upper root of
        a quadratic; the one root of an affine form stands first.
        """
        c0, c1, c2 = np.moveaxis(self.along_lift(t), -1, 0)
        if self.lift_kind == "prismatic":
            return _quadratic_roots(c0, c1, c2)
        theta, alpha, ratio = polar(c1, c2, -c0)
        found = (np.abs(ratio) <= 1) & ((c1 != 0) | (c2 != 0))
        return np.where(found, np.stack([theta - alpha, theta + alpha]), np.nan)

    def follow(self, roots: Sequence[Root], t: Floats) -> Floats:
        """Evaluate roots, each over its own row of base values inside its slab, shape as t (k, n).

        A root that leaves its form just there (at a fold, but for rounding) stays at the fold.
        """
        form, branch, turns = np.array(roots, dtype=np.int64).reshape(-1, 3).T[:, :, None]
        c0, c1, c2 = np.moveaxis(_settled(*self._lifted(roots, t), self.lift_kind), -1, 0)
        if self.lift_kind == "revolute":
            theta, alpha, _ = polar(c1, c2, -c0)
            values = theta + branch * alpha + TURN * turns
        else:
            lower, upper = _quadratic_roots(c0, c1, c2, folds=True)
            values = np.clip(np.where(branch < 0, lower, upper), *self.lift_ends)
        ends = np.array(self.lift_ends)[(form == HIGHEST.form).astype(int)]
        return np.asarray(np.where(form < 0, ends, values))

    def blank(self, roots: Sequence[Root], t: Floats) -> Bools:
        """Tell where the forms of roots vanish on the whole fibre, shape as t (k, n)."""
        c, size = self._lifted(roots, t)
        return np.asarray((np.abs(c) <= BLANK * size).all(axis=-1) & (size > 0).any(axis=-1))

    def _lifted(self, roots: Sequence[Root], t: Floats) -> tuple[Floats, Floats]:
        """Coefficients along the lift, (k, n, 3), and their sizes, (k, 1, 3); of ends all zero."""
        forms = [root.form for root in roots]
        return basis(self.base_kind, t) @ self._rows[forms], self._row_sizes[forms][:, None]


def _settled(c: Floats, size: Floats, kind: Kind) -> Floats:
    """Make double roots exact where coefficients, sums of terms of these sizes, cannot tell.

    Where terms cancel, as at a point in which a form touches zero along a curve, what is left of
    the discriminant is rounding.
    """
    (c0, c1, c2), (e0, e1, e2) = np.moveaxis(c, -1, 0), np.moveaxis(ROUNDING * size, -1, 0)
    if kind == "revolute":
        d = np.hypot(c1, c2)
        double, exact = np.abs(np.abs(c0) - d) <= e0 + e1 + e2, np.copysign(d, c0)
    else:
        doubt = 2 * np.abs(c1) * e1 + 4 * (np.abs(c0) * e2 + np.abs(c2) * e0)
        double = (np.abs(c1 * c1 - 4 * c0 * c2) <= doubt) & (c2 != 0)
        exact = c1 * c1 / np.where(double, 4 * c2, 1.0)
    return np.stack([np.where(double, exact, c0), c1, c2], axis=-1)


def _unit(kind: Kind, ends: tuple[float, float]) -> float:
    return 1.0 if kind == "revolute" else max(map(abs, ends))


@dataclass(frozen=True, eq=False)
class Decomposition:
    """Slabs between critical base values, and the feasible cells over them.

    Attributes
    ----------
    lines : ndarray, shape (s + 1,)
        Critical base values, ascending; slab i lies between lines i and i + 1.
    cells : list of Cell
    """

    plane: Plane
    lines: Floats
    cells: list[Cell]


def decompose(plane: Plane) -> Decomposition:
    """Find all critical base values and all feasible cells."""
    lines = critical_values(plane)
    cells = _cells(plane, (lines[:-1] + lines[1:]) / 2)
    return _without_idle_lines(Decomposition(plane, lines, cells))


# --- critical base values -------------------------------------------------------------------------


def critical_values(plane: Plane) -> Floats:
    """Return every base value at which the order of roots may change, with both ends of the range.

    Some are spurious, which costs time; none is missing, which would cost the answer.
    """
    events = _events(plane)
    found = _roots_in_range(events, plane)
    low, high = plane.ends
    inner = found[(found > low + SAME_CRITICAL) & (found < high - SAME_CRITICAL)]
    lines = np.sort(np.concatenate([[low, high], inner]))
    return np.asarray(lines[np.concatenate([[True], np.diff(lines) > SAME_CRITICAL])])


def _events(plane: Plane) -> list[Complexes]:
    """Return the univariate polynomials whose roots are critical, as stacks of equal length."""
    c = _univariate(plane.scaled, plane.base_kind)  # (m, 3 lift coefficients, length)
    lifts = plane.scaled[:, :, 1:].any(axis=(1, 2))
    fixed, c = c[~lifts, 0], c[lifts]  # a form without the lift vanishes on whole fibres
    c0, c1, c2 = c[:, 0], c[:, 1], c[:, 2]
    i, j = np.triu_indices(len(c), k=1)
    if plane.lift_kind == "revolute":
        events = [
            _times(c1, c1) + _times(c2, c2) - _times(c0, c0),
            c2,
            *_circle_resultants(c, i, j),
        ]
    else:
        events = [_times(c1, c1) - 4 * _times(c0, c2), c1, c2, *_line_resultants(c, i, j)]
    if plane.lift_range is not None:
        at = basis(plane.lift_kind, np.asarray(plane.lift_range) / plane.lift_unit)
        events += [np.einsum("j,mjl->ml", factor, c) for factor in at]
    return [fixed, *events]


def _circle_resultants(c: Complexes, i: Ints, j: Ints) -> list[Complexes]:
    """Resultant of two equations linear in (cos, sin), on the unit circle (Cramer's rule).

    Where the two are parallel for every base value, as for two points on one ray of a link, it is
    the sum of two squares with only double roots; their common roots are then those of each term.
    """
    (a0, a1, a2), (b0, b1, b2) = np.moveaxis(c[i], 1, 0), np.moveaxis(c[j], 1, 0)
    determinant = _times(a1, b2) - _times(a2, b1)
    cosine = _times(a2, b0) - _times(a0, b2)
    sine = _times(a0, b1) - _times(a1, b0)
    parallel = (np.abs(determinant) <= NEGLIGIBLE).all(axis=-1)
    resultant = _times(cosine, cosine) + _times(sine, sine) - _times(determinant, determinant)
    # Two forms that share one root for every base value share the other where they are parallel.
    sharing = ~parallel & (np.abs(resultant) <= NEGLIGIBLE).all(axis=-1)
    return [resultant[~parallel], cosine[parallel], sine[parallel], determinant[sharing]]


def _line_resultants(c: Complexes, i: Ints, j: Ints) -> list[Complexes]:
    """Resultants of polynomials of degree 2 or less at their actual degrees.

    The formal resultant of two affine forms is identically zero, so each pair is taken at its own.
    """
    square = np.abs(c[:, 2]).max(axis=-1, initial=0.0) > 0
    (a0, a1, a2), (b0, b1, b2) = np.moveaxis(c[i], 1, 0), np.moveaxis(c[j], 1, 0)
    p = _times(a1, b0) - _times(a0, b1)
    q = _times(a2, b0) - _times(a0, b2)
    apart = _times(a2, b1) - _times(a1, b2)
    both = _times(q, q) - _times(apart, p)
    # Two quadratics that share one root for every base value share the other where sums agree.
    sharing = square[i] & square[j] & (np.abs(both) <= NEGLIGIBLE).all(axis=-1)
    first = _times(_times(a2, b0), b0) - _times(_times(a1, b0), b1) + _times(_times(a0, b1), b1)
    second = _times(_times(b2, a0), a0) - _times(_times(b1, a0), a1) + _times(_times(b0, a1), a1)
    one, other = square[i], square[j]
    return [
        p[~one & ~other],
        both[one & other],
        first[one & ~other],
        second[~one & other],
        apart[sharing],
    ]


def _univariate(table: Floats, kind: Kind) -> Complexes:
    """Turn (m, 3, 3) coefficients into polynomials of the base, (m, 3, 3), in ascending powers.

    Revolute: of z = exp(i q), times z. Prismatic: of q itself.
    """
    c = np.moveaxis(table, 1, -1).astype(complex)
    if kind == "prismatic":
        return c
    one, cosine, sine = np.moveaxis(c, -1, 0)
    return np.stack([(cosine + 1j * sine) / 2, one, (cosine - 1j * sine) / 2], axis=-1)


def _times(p: Complexes, q: Complexes) -> Complexes:
    """Multiply stacked polynomials, coefficients on the last axis."""
    product = np.zeros((*p.shape[:-1], p.shape[-1] + q.shape[-1] - 1), dtype=complex)
    for k in range(p.shape[-1]):
        product[..., k : k + q.shape[-1]] += p[..., k : k + 1] * q
    return product


def _roots_in_range(events: Sequence[Complexes], plane: Plane) -> Floats:
    """Return the real base values at which any of the polynomials vanishes.

    A block at a time: of thousands of boundaries there are millions of pairs.
    """
    blocks = (s[k : k + BLOCK] for s in events for k in range(0, len(s), BLOCK))
    found = [_base_values(block, plane) for block in blocks]
    return np.concatenate([np.zeros(0), *found])


def _base_values(stack: Complexes, plane: Plane) -> Floats:
    circle = plane.base_kind == "revolute"
    if not circle:
        z = np.append(_polynomial_roots(stack), 0)  # a root at zero is trimmed with its coefficient
        near = np.abs(z.imag) <= NEAR_CIRCLE * (1 + np.abs(z.real))
        return np.asarray(plane.base_unit * z.real[near])
    z = _polynomial_roots(stack)
    t = np.angle(z[np.abs(np.abs(z) - 1) <= NEAR_CIRCLE])
    low, high = plane.ends
    turns = np.array(turns_within(low, high, [-math.pi, math.pi]))
    return np.asarray((t[:, None] + TURN * turns).ravel())


def _polynomial_roots(stack: Complexes) -> Complexes:
    """Return all roots of stacked polynomials, equal degrees by one call of the eigenvalue solver.

    Both ends are trimmed relative to the largest coefficient: a fixed degree would send roots to
    zero or infinity and spoil the others.
    """
    size = np.abs(stack).max(axis=-1)
    stack = stack[size > NEGLIGIBLE]
    kept = np.abs(stack) > NEGLIGIBLE * np.abs(stack).max(axis=-1, keepdims=True)
    first = kept.argmax(axis=-1)
    last = stack.shape[-1] - 1 - kept[:, ::-1].argmax(axis=-1)
    roots = [np.zeros(0, dtype=complex)]
    for low, high in set(zip(first.tolist(), last.tolist(), strict=True)):
        if high > low:
            chosen = stack[(first == low) & (last == high), low : high + 1]
            roots.append(_companion_roots(chosen))
    return np.concatenate(roots)


def _companion_roots(stack: Complexes) -> Complexes:
    """Return all roots of polynomials with non-zero ends; the mean of close ones once more."""
    degree = stack.shape[1] - 1
    matrices = np.zeros((len(stack), degree, degree), dtype=complex)
    matrices[:, np.arange(1, degree), np.arange(degree - 1)] = 1
    matrices[:, :, -1] = -stack[:, :-1] / stack[:, -1:]
    z = np.asarray(np.linalg.eigvals(matrices), dtype=complex)
    close = np.abs(z[:, :, None] - z[:, None, :]) < 1e-6
    count = close.sum(axis=-1)
    # The errors of a double root's two halves cancel in their mean.
    means = np.einsum("kij,kj->ki", close, z) / count
    return np.concatenate([_polished(stack, z).ravel(), means[count > 1]])


def _polished(stack: Complexes, z: Complexes) -> Complexes:
    """Two steps of Newton; a step is taken only where the root is simple enough to gain by it."""
    powers = np.arange(stack.shape[1])
    slopes = (stack * powers)[:, 1:]
    for _ in range(2):
        value, slope = _horner(stack, z), _horner(slopes, z)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = value / slope
        z = np.where(np.abs(step) < 1e-6, z - step, z)
    return z


def _horner(stack: Complexes, z: Complexes) -> Complexes:
    result = np.zeros_like(z)
    for k in reversed(range(stack.shape[1])):
        result = result * z + stack[:, k : k + 1]
    return result


# --- lifting --------------------------------------------------------------------------------------


def _cells(plane: Plane, middles: Floats) -> list[Cell]:
    """Return the feasible cells over one base value inside each slab."""
    slab, values, roots = _fibre_roots(plane, middles)
    after, tops = np.arange(1, len(slab) + 1), np.append(values[1:], np.nan)
    if plane.lift_range is None:  # a circle closes: after its last root comes the first, a turn on
        edges = np.flatnonzero(np.diff(slab, prepend=-1, append=len(middles)))
        first, last = edges[:-1], edges[1:] - 1
        after[last], tops[last] = first, values[first] + TURN
    wide = np.flatnonzero(tops > values)
    free = wide[plane.open(middles[slab[wide]], values[wide], tops[wide], NEGLIGIBLE)]
    cells = []
    for k in free.tolist():
        lower, upper = (Root(*map(int, roots[i])) for i in (k, after[k]))
        upper = upper if after[k] > k else upper._replace(turns=upper.turns + 1)
        cells.append(Cell(int(slab[k]), lower, upper if upper.form >= 0 else HIGHEST))
    return cells


def _fibre_roots(plane: Plane, t: Floats) -> tuple[Ints, Floats, Ints]:
    """Return what bounds cells over each base value, ascending: slab, value and root, (k, 3).

    They are the roots in the lift's range and its ends; on a circle without roots, its cut.
    """
    found = plane.roots(t)
    branch, slab, form = np.nonzero(np.isfinite(found))
    values, (low, high) = found[branch, slab, form], plane.lift_ends
    turns = np.zeros(len(values), dtype=np.int64)
    if plane.lift_kind == "revolute":
        first, end = (turns_up_to(x, values).astype(np.int64) for x in (low, high))
        end = first + 1 if plane.lift_range is None else end  # by rounding a root could have none
        pick, turns = _ranges(first, end)
        values, slab, form, branch = (
            values[pick] + TURN * turns,
            slab[pick],
            form[pick],
            branch[pick],
        )
    roots = np.stack([form, 2 * branch - 1, turns], axis=-1)
    every = np.arange(len(t))
    if plane.lift_range is None:
        cut = np.setdiff1d(every, slab)
        ends = [(cut, low, LOWEST)]
    else:
        inside = (values > low) & (values < high)
        slab, values, roots = slab[inside], values[inside], roots[inside]
        ends = [(every, low, LOWEST), (every, high, HIGHEST)]
    slab = np.concatenate([slab, *(where for where, _, _ in ends)])
    values = np.concatenate([values, *(np.full(len(where), v) for where, v, _ in ends)])
    roots = np.concatenate([roots, *(np.tile(root, (len(where), 1)) for where, _, root in ends)])
    order = np.lexsort([values, slab])
    return slab[order], values[order], roots[order]


def _ranges(start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """Return index and value of every integer in range(start, end), for each entry in turn."""
    count = np.maximum(end - start, 0)
    pick = np.repeat(np.arange(len(count)), count)
    return pick, start[pick] + np.arange(len(pick)) - (np.cumsum(count) - count)[pick]


def _without_idle_lines(found: Decomposition) -> Decomposition:
    """Drop the critical lines at which no feasible cell changes, and join the cells across."""
    plane, lines = found.plane, found.lines
    over: list[list[tuple[Root, Root]]] = [[] for _ in lines[1:]]
    for slab, lower, upper in found.cells:
        over[slab].append((lower, upper))
    same = [i for i in range(1, len(over)) if over[i - 1] == over[i]]
    at = np.repeat(same, [len(over[i]) for i in same]).astype(np.int64)
    changed = at[~_goes_on(plane, lines, at, [pair for i in same for pair in over[i]])]
    idle = np.setdiff1d(same, changed).astype(np.int64)
    kept = np.setdiff1d(np.arange(len(lines)), idle)
    cells = [Cell(i, *pair) for i, slab in enumerate(kept[:-1]) for pair in over[slab]]
    return Decomposition(plane, lines[kept], cells)


def _goes_on(plane: Plane, lines: Floats, at: Ints, pairs: Sequence[tuple[Root, Root]]) -> Bools:
    """Tell whether cells between the same two roots on both sides of a line are one, open on it."""
    zero = np.zeros(len(at))
    widths = np.stack([lines[at] - lines[at - 1], zero, lines[at + 1] - lines[at]], axis=-1)
    step = np.maximum(UNCHANGED**2 * widths, np.minimum(widths / 2, BEYOND_JUMP))
    t = lines[at][:, None] + step * np.array([-1, 0, 1])
    bottoms, tops = [lower for lower, _ in pairs], [upper for _, upper in pairs]
    lower, upper = plane.follow(bottoms, t), plane.follow(tops, t)
    smooth = np.ptp(lower, axis=1) + np.ptp(upper, axis=1) < UNCHANGED * (upper - lower).min(axis=1)
    wide = (upper - lower).min(axis=1) > SAME_POINT * plane.lift_unit
    going = smooth & wide & plane.open(lines[at], lower[:, 1], upper[:, 1], POSITIVE)
    return np.asarray(going & _simple(plane, bottoms, t) & _simple(plane, tops, t))


def _simple(plane: Plane, roots: Sequence[Root], t: Floats) -> Bools:
    """Tell whether roots keep away from the other root of their form: where both meet is a kink."""
    gap = plane.follow(roots, t) - plane.follow([r._replace(branch=-r.branch) for r in roots], t)
    gap = np.sin(gap / 2) if plane.lift_kind == "revolute" else gap
    alone = np.array([r.form < 0 or plane.affine[r.form] for r in roots], dtype=np.bool_)
    return np.asarray(alone | (np.abs(gap).min(axis=1) > UNCHANGED))


def _quadratic_roots(c0: Floats, c1: Floats, c2: Floats, *, folds: bool = False) -> Floats:
    """Return the lower and the upper root of c0 + c1 v + c2 v^2; an affine root stands first.

    With `folds` the vertex stands for roots that are not real, and the affine root stands twice.
    """
    discriminant = _discriminant(c0, c1, c2)
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(discriminant, 0) if folds else discriminant)
        half = -(c1 + np.copysign(root, c1)) / 2
        pair = np.sort(np.stack([half / c2, np.where(root == 0, half / c2, c0 / half)]), axis=0)
        single = -c0 / c1
    singles = np.stack([single, single if folds else np.full_like(single, np.nan)])
    roots = np.where(c2 == 0, singles, pair)
    return np.nan_to_num(roots) if folds else np.where(np.isfinite(roots), roots, np.nan)


def _discriminant(c0: Floats, c1: Floats, c2: Floats) -> Floats:
    """Return c1^2 - 4 c0 c2, zero where it is rounding: a double root is a root."""
    square, product = c1 * c1, 4 * c0 * c2
    size = square + np.abs(product)
    return np.where(np.abs(square - product) <= TANGENT * size, 0.0, square - product)
