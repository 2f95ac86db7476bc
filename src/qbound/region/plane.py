"""Forms of two joints over a base: their roots along the other joint, the lift, and their signs.

For a fixed value of the base each form is a one-joint form of the lift, and Theorem 2 (or the
quadratic formula) gives its roots.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.boundary.contacts import NO_CONTACTS, SIDES, Contacts
from qbound.forms.angles import TURN
from qbound.forms.factors import FACTORS
from qbound.forms.harmonic import HarmonicForm, Kind, basis
from qbound.tolerances import BLANK, NEGLIGIBLE, ROUNDING, TANGENT, UNIT, ZERO_AMPLITUDE

Range = tuple[float, float] | None

FEW = 16
"""Forms that are looked at together at many places."""

FAR_APART = 1e-9
"""A scaled form of discs above this parts them, whatever its rounding."""

TINY = 1e-300
"""Keeps 0 / 0 at zero where a form has neither amplitude nor constant."""

MOST_VALUES = 2**21
"""Values of features that are held at once: some 16 MB."""


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


class Plane:
    """Forms of two joints, scaled to largest coefficient 1, with one joint as base.

    A prismatic joint is measured in its farthest limit for this (`scaled`); `table` is the same
    forms in the joints' own units. After the forms that must be positive themselves come those of
    the features in which bodies touch, of which none need be.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Of two joints.
    ranges : sequence of two (low, high) or None
        None for a revolute joint that turns all the way round.
    base : int
        0 or 1.
    contacts : Contacts, optional
        Of pairs of bodies that are to keep apart.
    errors : ndarray, shape (m, 3, 3), optional
        Bounds of the errors of the forms' coefficients; default 0.
    caution : float, optional
        By how much all errors are overestimated.
    """

    def __init__(
        self,
        forms: HarmonicForm,
        ranges: Sequence[Range],
        base: int,
        contacts: Contacts = NO_CONTACTS,
        errors: Floats | None = None,
        caution: float = 1.0,
    ) -> None:
        self.caution = caution
        self.count, self.base, self.contacts = len(forms.coefficients), base, contacts
        self.base_kind: Kind = forms.kinds[base]
        self.lift_kind: Kind = forms.kinds[1 - base]
        self.base_range, self.lift_range = ranges[base], ranges[1 - base]
        self.ends = self.base_range or (-math.pi, math.pi)
        self.lift_ends = self.lift_range or (-math.pi, math.pi)
        # In mm the high powers of a slide have coefficients that would pass for rounding.
        self.base_unit: float = _unit(self.base_kind, self.ends)
        self.lift_unit: float = _unit(self.lift_kind, self.lift_ends)
        self.powers: Floats = np.outer(
            self.base_unit ** np.arange(3), self.lift_unit ** np.arange(3)
        )
        own = np.asarray(forms.coefficients, dtype=float)
        self.scaled: Floats = self.scale(np.concatenate([own, contacts.forms]))
        self.table: Floats = self.scaled / self.powers
        self.scaled_size: Floats = np.abs(self.scaled).sum(axis=(1, 2))
        # Largest values of the coefficients along the lift: what is rounding is so beside these.
        self.sizes: Floats = np.abs(self.scaled).sum(axis=1) / self.lift_unit ** np.arange(3)
        # Ends of the lift's range are roots of forms -1 and -2: two of zeros at the end.
        rows = np.concatenate([self.table, np.zeros((2, 3, 3))])
        self._rows: Floats = self.table[: self.count].reshape(-1, 9).T
        self._columns: Floats = rows.transpose(1, 2, 0).copy()
        self._column_sizes: Floats = np.concatenate([self.sizes, np.zeros((2, 3))]).T.copy()
        # How much of a coefficient along the lift is rounding; on a circle of all three together.
        doubt = ROUNDING * self._column_sizes
        self._doubt: Floats = doubt.sum(axis=0) if self.lift_kind == "revolute" else doubt
        self.affine: Bools = np.asarray(~self.table[:, :, 2].any(axis=1))
        if self.lift_kind == "revolute":
            self.affine[:] = False
        given = np.zeros((self.count, 3, 3)) if errors is None else errors
        self.eps: Floats = self._relative(
            np.concatenate([own, contacts.forms]), np.concatenate([given, contacts.errors])
        )

    def _relative(self, tables: Floats, errors: Floats) -> Floats:
        """Bound the errors of scaled coefficients: as they were given, and of scaling them."""
        turned = (x if self.base == 0 else np.swapaxes(x, -1, -2) for x in (tables, errors))
        table, error = (np.abs(x * self.powers).max(axis=(-2, -1), initial=0.0) for x in turned)
        return np.asarray(self.caution * (4 * UNIT + error / np.where(table > 0, table, 1.0)))

    def scale(self, tables: Floats) -> Floats:
        """Return tables (..., 3, 3) base before lift, in units of both, largest coefficient 1."""
        tables = tables if self.base == 0 else np.swapaxes(tables, -1, -2)
        tables = normalised(tables * self.powers)
        return np.where(np.abs(tables) > NEGLIGIBLE, tables, 0.0)

    def form(self, row: int) -> HarmonicForm:
        """Return a row of `table` as a form of the joints in their own order."""
        kinds, table = (self.base_kind, self.lift_kind), self.table[row]
        return HarmonicForm(*((table, kinds) if self.base == 0 else (table.T, kinds[::-1])))

    @cached_property
    def sides(self) -> Floats:
        """Side conditions of all features, scaled, shape (f, 4, 3, 3)."""
        return self.scale(self.contacts.sides)

    @cached_property
    def side_eps(self) -> Floats:
        """Errors of the scaled coefficients of side conditions, shape (f, 4)."""
        return self._relative(self.contacts.sides, self.contacts.side_errors)

    def along_lift(self, t: Floats) -> Floats:
        """Return the coefficients of all forms but features' along the lift, (3, len(t), m)."""
        return self._over(t[:, None], self._columns[:, :, None, : self.count])

    def coefficients(self, form: Ints, t: Floats) -> Floats:
        """Return coefficients of forms (..., k) along the lift over (k, n), (3, ..., k, n)."""
        return self._over(t, self._columns[:, :, form, None])

    def _over(self, t: Floats, columns: Floats) -> Floats:
        """Contract columns (3, 3, ...), base before lift, with the base's factors, (3, ...)."""
        one, other = FACTORS[self.base_kind].functions(t)
        return np.asarray(columns[0] + columns[1] * one + columns[2] * other)

    def positive(self, t: Floats, v: Floats, doubt: Floats) -> tuple[Bools, Bools]:
        """Tell whether every form is positive at paired base and lift values, (len(t),).

        Surely, beyond its own doubt, shape (m,); and whether none is negative beyond that.
        """
        products, m = self.products(t, v), self.count
        surely, maybe = np.zeros((2, len(t)), dtype=np.bool_)
        left = np.arange(len(t))
        for at in range(0, m, FEW):  # few places survive many forms
            part = slice(at, min(at + FEW, m))
            values = products[left] @ self._rows[:, part]
            open_ = (values > -doubt[part]).all(axis=1)
            sure = (values > doubt[part]).all(axis=1)
            surely[left] = sure & (surely[left] if at else True)
            left = left[open_]
        maybe[left] = True
        return surely & maybe, maybe

    def products(self, t: Floats, v: Floats) -> Floats:
        """Return the nine factors of a form at paired base and lift values, (len(t), 9)."""
        found = np.empty((len(t), 3, 3))
        found[:, 0, 0] = 1.0
        found[:, 1, 0], found[:, 2, 0] = FACTORS[self.base_kind].functions(t)
        one, other = FACTORS[self.lift_kind].functions(v)
        np.multiply(found[:, :, 0], one[:, None], out=found[:, :, 1])
        np.multiply(found[:, :, 0], other[:, None], out=found[:, :, 2])
        return found.reshape(-1, 9)

    def roots_and_errors(self, row: Ints, c: Floats, slack: Floats | float = 0.0) -> Any:
        """Return both roots of rows from coefficients (3, ..., n) along the lift, and how sure.

        Parameters
        ----------
        slack : ndarray, optional
            What the coefficients are off besides their own errors, in the row's largest value.

        Returns
        -------
        values, errors : ndarray, shape (2, ..., n)
            The errors bound those of roots; a double root is known to half the digits.
        real : ndarray of int, shape (..., n)
            1 where there are two roots, -1 where there are none, 0 where doubles cannot tell.
        """
        doubt = (self.eps[row] + 8 * UNIT + slack) * self.scaled_size[row]
        return self._roots(c, doubt)

    def side_roots(self, side: Ints, t: Floats, radius: Floats) -> Any:
        """Return the same of side conditions, by number, over base values of some error."""
        tables = self.sides.reshape(-1, 3, 3)[side]
        factors = basis(self.base_kind, t / self.base_unit)
        c = np.einsum("ni,nij->jn", factors, tables)
        c = c / (self.lift_unit ** np.arange(3))[:, None]
        slack = 2 * radius / self.base_unit
        doubt = (self.side_eps.reshape(-1)[side] + 8 * UNIT + slack) * np.abs(tables).sum(
            axis=(1, 2)
        )
        values, errors, real = self._roots(c, doubt)
        if self.lift_kind == "prismatic":
            values = np.where((c[2] == 0) & (c[1] == 0), np.nan, values)
            values[1] = np.where(c[2] == 0, np.nan, values[1])
        return values, errors, real

    def _roots(self, c: Floats, doubt: Floats) -> Any:
        if self.lift_kind == "revolute":
            theta, alpha, _ = _polar(c, 0.0 * doubt)
            d = np.hypot(c[1], c[2])
            beside = doubt / np.maximum(d, TINY)
            part = np.maximum(np.abs(np.sin(alpha)), np.sqrt(np.minimum(beside, 1.0)))
            error = np.where(beside < 0.25, 2 * beside / part + beside, np.inf) + 16 * UNIT
            gap = d - np.abs(c[0])
            real = np.where(gap > 2 * doubt, 1, np.where(gap < -2 * doubt, -1, 0))
            error = np.minimum(error, TURN)
            return np.array([theta - alpha, theta + alpha]), np.array([error, error]), real
        unit = self.lift_unit
        c0, c1, c2 = c[0], c[1] * unit, c[2] * unit**2
        square = c1 * c1 - 4 * c0 * c2
        wide = 8 * doubt * (np.abs(c0) + np.abs(c1) + np.abs(c2) + doubt)
        values = _quadratic_roots(*c, folds=True)
        values = np.clip(values, -1e6 * unit, 1e6 * unit)
        size = doubt * (1 + (np.abs(values) / unit)) ** 2
        steep = np.maximum(np.sqrt(np.maximum(square, 0)), np.sqrt(np.abs(c2) * size))
        steep = np.where(c2 == 0, np.abs(c1), steep)
        off = np.minimum(2 * size, 1e6 * steep) / np.maximum(steep, TINY)
        off = np.where(2 * size > 1e6 * steep, 1e6, off)
        error = unit * (off + 16 * UNIT) + 16 * UNIT * np.abs(values)
        real = np.where(square > wide, 1, np.where(square < -wide, -1, 0))
        real = np.where(c2 == 0, np.where(c1 != 0, 1, -1), real)
        return values, error, real

    def follow(self, roots: Sequence[Root] | Ints, t: Floats) -> Floats:
        """Evaluate roots, each over its own row of base values inside its slab, shape (..., k, n).

        Of roots, shape (..., k, 3), several may be over the same values, (k, n). One that leaves
        its form just there (at a fold, but for rounding) stays at the fold.
        """
        rows = np.asarray(roots, dtype=np.int64)
        return self.values(rows, self.coefficients(rows[..., 0], t))

    def values(self, roots: Ints, c: Floats) -> Floats:
        """Evaluate roots from their forms' coefficients along the lift, as `follow` does."""
        form, branch, turns = roots[..., 0], roots[..., 1], roots[..., 2]
        doubt = self._doubt[..., form, None]
        if self.lift_kind == "revolute":
            theta, alpha, _ = _polar(c, doubt)
            values = theta + branch[..., None] * alpha + (TURN * turns)[..., None]
        else:
            lower, upper = _quadratic_roots(*_settled(c, doubt), folds=True)
            values = np.clip(np.where(branch[..., None] < 0, lower, upper), *self.lift_ends)
        if (form < 0).any():
            for end, value in zip((LOWEST, HIGHEST), self.lift_ends, strict=True):
                values[form == end.form] = value
        return np.asarray(values)

    def blank(self, form: Ints, c: Floats, first: int = 0) -> Bools:
        """Tell where forms, (..., k), with coefficients (3, ..., k, n) vanish on whole fibres.

        Or where the coefficients from the one of number `first` on vanish, if only these are given.
        """
        size = self._column_sizes[first:, form, None]
        blank: Bools = np.asarray((np.abs(c) <= BLANK * size).all(axis=0))
        return blank & (size > 0).any(axis=0) if blank.any() else blank


def normalised(tables: Floats) -> Floats:
    """Return tables (..., 3, 3) with largest coefficient 1; one without any stays as it is."""
    largest = np.abs(tables).max(axis=(-2, -1), keepdims=True, initial=0.0)
    return np.asarray(tables / np.where(largest > 0, largest, 1.0))


def which(found: Any) -> Ints:
    """Return where an array, shape (n,), is true; of ten entries sooner than `np.flatnonzero`."""
    return np.asarray(found.nonzero()[0])


def ranges(start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """Return index and value of every integer in range(start, end), for each entry in turn."""
    count = np.maximum(end - start, 0)
    pick = np.arange(len(count)).repeat(count)
    return pick, np.arange(len(pick)) + (start + count - count.cumsum())[pick]


def runs(values: Ints) -> tuple[Ints, Ints]:
    """Return the first and the last index of each run of equal values."""
    new = np.ones(len(values) + 1, dtype=np.bool_)
    new[1:-1] = values[1:] != values[:-1]
    edges = which(new)
    return edges[:-1], edges[1:] - 1


def ranked(
    line: Ints,
    v: Floats,
    error: Floats,
    circle: bool,
    decide: Callable[[list[int], list[float]], list[list[int]]],
    name: Ints | None = None,
) -> tuple[Ints, Ints, list[int]]:
    """Put rows on lines in their true order: doubles decide what they can.

    Parameters
    ----------
    line, v, error : ndarray, shape (n,)
        Line, value and a bound of its error, by line and upwards.
    circle : bool
        Whether lines close: then the last rows of one may belong to its first, a turn earlier.
    decide : callable
        Of rows whose order doubles do not tell, and their values: these rows in order, those that
        are one together.
    name : ndarray of int, shape (n,), optional
        Rows of one name that doubles do not part are one.

    Returns
    -------
    order, group : ndarray of int, shape (n,)
        Rows in order, and a number for each in that order; one number for rows that are one.
    turned : list of int
        Rows that stand a turn earlier, at the beginning of their line.
    """
    n, low, high = len(line), v - error, v + error
    close = np.zeros(n, dtype=np.bool_)  # whether a row may be no higher than the one before
    close[1:] = (line[1:] == line[:-1]) & (low[1:] <= high[:-1])
    begin, number = which(~close), (~close).cumsum() - 1
    end, leader, turned = np.append(begin[1:], n), begin[number], list[int]()
    doubtful = close if name is None else close & (name != np.roll(name, 1))
    clusters = {
        int(begin[k]): list(range(begin[k], end[k])) for k in np.unique(number[doubtful]).tolist()
    }
    if circle:
        first, last = runs(line)
        for k in which((last > first) & (high[last] >= low[first] + TURN)).tolist():
            a, z = number[first[k]], number[last[k]]
            if a != z:
                tail, head = (list(range(begin[c], end[c])) for c in (z, a))
                clusters.pop(tail[0], None)
                turned += tail
                clusters[head[0]] = tail + head
    if not clusters:
        return np.arange(n), number, turned
    position, shift = np.arange(n, dtype=float), dict.fromkeys(turned, TURN)
    for a, own in clusters.items():
        groups = decide(own, [float(v[k]) - shift.get(k, 0.0) for k in own])
        for group in groups:
            leader[group] = group[0]
        # They stand between the rows before and behind: of rows a turn earlier before the first.
        flat = [row for group in groups for row in group]
        position[flat] = a - (own[0] in shift) + np.arange(1, len(flat) + 1) / (len(flat) + 1)
    order = np.lexsort([position, line])
    leader, line = leader[order], line[order]
    change = np.ones(n, dtype=np.bool_)
    change[1:] = (leader[1:] != leader[:-1]) | (line[1:] != line[:-1])
    return order, change.cumsum() - 1, turned


class Separation:
    """Tests that part pairs of bodies: any one clause of a pair shows it; all its forms must.

    Parameters
    ----------
    plane : Plane
        Whose features these are.
    pairs : ndarray of bool, shape (pairs,), optional
        Which pairs; default all.

    Attributes
    ----------
    pairs : ndarray of int
    doubt : float
        A height this near to zero has no sign.
    """

    def __init__(self, plane: Plane, pairs: Bools | None = None) -> None:
        contacts = plane.contacts
        chosen = np.full(contacts.pairs, True) if pairs is None else pairs
        self.plane, self.pairs = plane, which(chosen)
        self.discs: Floats = (plane.scale(contacts.discs[self.pairs]) / plane.powers).reshape(-1, 9)
        doubts = (plane.eps[plane.count :] + 16 * UNIT) * plane.scaled_size[plane.count :]
        self.doubt = float(doubts[chosen[contacts.pair]].max(initial=0.0))

    def heights(self, t: Floats, v: Floats) -> Floats:
        """Return of each pair, at paired base and lift values, what parts it best, (len(t), pairs).

        A value of a scaled form, positive where the two are apart. Most pairs are parted by discs.
        """
        result = np.empty((len(t), len(self.pairs)))
        step = max(1, MOST_VALUES // max(1, len(self.pairs)))
        for k in range(0, len(t), step):
            products = self.plane.products(t[k : k + step], v[k : k + step])
            values = products @ self.discs.T
            for p in which((values <= FAR_APART).any(axis=0)).tolist():
                near = which(values[:, p] <= FAR_APART)
                values[near, p] = self._height(int(self.pairs[p]), products[near])
            result[k : k + step] = values
        return result

    def _height(self, pair: int, products: Floats) -> Floats:
        """Return what parts one pair best, from the nine factors of a form, (n, 9) to (n,)."""
        plane, contacts = self.plane, self.plane.contacts
        first, last = contacts.pair.searchsorted([pair, pair + 1])
        rows = np.arange(first, last)
        values = products @ plane.table[plane.count + rows].reshape(-1, 9).T
        corners = which(contacts.corners[rows])
        if len(corners):
            sides = (plane.sides[rows[corners]] / plane.powers).reshape(-1, 9)
            lowest = (products @ sides.T).reshape(len(products), -1, SIDES).min(axis=2)
            values[:, corners] = np.where(lowest >= -NEGLIGIBLE, values[:, corners], -np.inf)
        clauses, _ = runs(contacts.clause[rows])
        return np.asarray(np.minimum.reduceat(values, clauses, axis=1).max(axis=1))


def _polar(c: Floats, doubt: Floats | None = None) -> tuple[Floats, Floats, Floats]:
    """Return theta, alpha and the cosine of alpha of Theorem 2, as `circle.polar` does.

    Where terms cancel, as at a point in which a form touches zero along a curve, what is left of
    the discriminant is rounding: coefficients in doubt by so much together cannot tell two roots
    from one, and it is one.
    """
    c0, c1, c2 = c
    d, height = np.hypot(c1, c2), np.abs(c0)
    ratio = -c0 / np.maximum(d, ZERO_AMPLITUDE * height + TINY)
    double = (np.abs(height - d) <= (TANGENT * d if doubt is None else doubt)) & (d > 0)
    ratio = np.where(double, np.copysign(1.0, ratio), ratio)
    alpha = np.arccos(np.minimum(np.maximum(ratio, -1.0), 1.0))
    return np.arctan2(c2, c1), alpha, ratio


def _settled(c: Floats, doubt: Floats) -> tuple[Floats, Floats, Floats]:
    """Make double roots of quadratics exact where coefficients cannot tell, as in `_polar`."""
    (c0, c1, c2), (e0, e1, e2) = c, doubt
    wide = 2 * np.abs(c1) * e1 + 4 * (np.abs(c0) * e2 + np.abs(c2) * e0)
    double = (np.abs(c1 * c1 - 4 * c0 * c2) <= wide) & (c2 != 0)
    return np.where(double, c1 * c1 / np.where(double, 4 * c2, 1.0), c0), c1, c2


def _unit(kind: Kind, ends: tuple[float, float]) -> float:
    return 1.0 if kind == "revolute" else max(map(abs, ends))


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
