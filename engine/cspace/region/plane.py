"""Forms of two joints over a base: their roots along the other joint, the lift, and their signs.

For a fixed value of the base each form is a one-joint form of the lift, and Theorem 2 (or the
quadratic formula) gives its roots. `Plane` computes these in doubles, with bounds of their errors.

Where two numbers are nearer to each other than their errors, `Precise` computes them again in balls
(Arb): from exact coefficients (`ExactRows`), at 128 bits, then at 1,024. Numbers whose balls still
overlap count as equal; all others are different, however near.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Array, Bools, Floats, Ints
from cspace.boundary.contacts import NO_CONTACTS, SIDES, Contacts
from cspace.boundary.exact_contacts import ExactContacts, Feature
from cspace.boundary.functions import clearance
from cspace.forms.factors import FACTORS
from cspace.model.exact import ExactNumbers, frozen, rational, rationals, written_numbers
from cspace.model.robot import Robot
from cspace.region.problem import Problem
from cspace.tolerances import BLANK, NEGLIGIBLE, ROUNDING, TANGENT, UNIT, ZERO_AMPLITUDE
from qbound.circle import TURN
from qbound.forms import HarmonicForm, Kind, basis

Made = TypeVar("Made")

Ball = Any
"""An `arb`."""


class _Flint:
    """python-flint, imported when balls are first needed: a command without them starts sooner."""

    def __getattr__(self, name: str) -> Any:
        """Return a name of the module, and keep it."""
        import flint

        setattr(self, name, getattr(flint, name))
        return getattr(flint, name)


flint: Final[Any] = _Flint()


BITS = 1280
"""Precision of what is no rational; what is left after a few hundred operations is 1,152 bits."""


class ExactRows:
    """Coefficients of the forms of a problem as rationals (fmpq) or balls (arb), one row at a time.

    Rows are computed when first needed, and only once. Forms of a robot come from the decimals of
    its file (`cspace.model.exact`). Other forms, and the values of held joints, count as exact
    doubles. A row is the problem's row times a positive number.

    Parameters
    ----------
    problem : Problem

    Examples
    --------
    >>> from cspace import load_robot
    >>> from cspace.region import clearance_problem
    >>> rows = ExactRows(clearance_problem(load_robot("pp-portal")))
    >>> rows.form(0)[0, 0], rows.range(1)
    (-10, (0, 500.000000000000))
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._made: dict[tuple[str, int], Any] = {}

    def __reduce__(self) -> tuple[Any, ...]:
        """Leave the rows out of a copy, which makes its own when it needs them."""
        return ExactRows, (self._problem,)

    def form(self, row: int) -> Array:
        """Return a row of the problem's forms, shape (3, 3), its first joint the first axis."""
        return self._once("form", row, self._form)

    def feature(self, k: int) -> Feature:
        """Return form (3, 3) and side conditions (s, 3, 3) of a row of the problem's contacts.

        There are at most four side conditions, in the order of the contacts; the constants for
        missing ones are left out.
        """
        return self._once("feature", k, self._contacts.feature)

    def range(self, joint: int) -> tuple[Ball, Ball] | None:
        """Return the ends of the range of free joint 0 or 1; None if it turns all the way round.

        A limit is that of the file. Any other end, such as that of a window, is an exact double.
        """
        return self._once("range", joint, self._range)

    def _once(self, kind: str, row: int, make: Callable[[int], Made]) -> Made:
        if (kind, row) not in self._made:
            with _precision():
                self._made[kind, row] = make(row)
        made: Made = self._made[kind, row]
        return made

    def _form(self, row: int) -> Array:
        problem = self._problem
        boundary = problem.origins[row] if row < len(problem.origins) else None
        if boundary is None or problem.robot is None:
            return rationals(problem.forms.coefficients[row])
        return clearance(self._free_robot, self._numbers.boundary(boundary)).coefficients

    @cached_property
    def _numbers(self) -> ExactNumbers:
        return written_numbers(self._robot)

    @property
    def _robot(self) -> Robot:
        assert self._problem.robot is not None  # forms without a robot need none
        return self._problem.robot

    @cached_property
    def _free_robot(self) -> Robot:
        """The robot with exact numbers, without the joints that are held."""
        held = {j: flint.arb(value) for j, value in self._problem.held.items()}
        robot = self._numbers.robot
        return frozen(robot, held) if held else robot

    @cached_property
    def _contacts(self) -> ExactContacts:
        problem = self._problem
        return ExactContacts(self._robot, problem.held, problem.bodies, problem.contacts)

    def _range(self, joint: int) -> tuple[Ball, Ball] | None:
        problem = self._problem
        ends = problem.ranges[joint]
        if ends is None:
            return None
        low, high = (flint.arb(rational(end)) for end in ends)
        if problem.robot is None:
            return low, high
        exact = self._numbers.joint(self._robot.joints[problem.joints[joint]]).limits
        if exact is None:
            return low, high
        one, other = (
            x if abs(float(x) - own) <= ROUNDING * abs(own) else given
            for x, own, given in zip(exact, map(float, ends), (low, high), strict=True)
        )
        return one, other


def shared_rows(problem: Problem) -> tuple[ExactRows, Contacts]:
    """Return a problem's exact rows, made once for both bases, and its contacts by their curves.

    They are kept with this very object. An equal problem may have other rows, because its file may
    have other decimals of the same doubles.
    """
    kept = vars(problem)
    if "_shared_rows" not in kept:
        kept["_shared_rows"] = _rows_and_contacts(problem)
    shared: tuple[ExactRows, Contacts] = kept["_shared_rows"]
    return shared


def _rows_and_contacts(problem: Problem) -> tuple[ExactRows, Contacts]:
    """Return exact rows, and contacts of which those with one curve share its number.

    Obstacles in line have features with different names but the same form. Doubles propose such
    features. They are one curve if their rational coefficients are equal up to a positive factor.
    Then their common points need not be told apart.
    """
    rows, contacts = ExactRows(problem), problem.contacts
    curves, first = np.unique(contacts.curves, return_index=True)
    if not len(first):
        return rows, contacts
    tables = contacts.forms[first].reshape(-1, 9)
    place = np.abs(tables).argmax(axis=1)
    largest = np.abs(np.take_along_axis(tables, place[:, None], axis=1))
    near = np.round(tables / np.where(largest > 0, largest, 1.0) * 2.0**30) + 0.0
    _, alike, count = np.unique(near, axis=0, return_inverse=True, return_counts=True)
    number, known = np.arange(len(first)), dict[Any, int]()
    moved = near[:, 1:].any(axis=1)  # a form that no joint moves has no curve
    for k in np.flatnonzero(moved & (count[alike] > 1)).tolist():
        exact = rows.feature(int(first[k]))[0].reshape(-1)
        if all(isinstance(x, flint.fmpq | int) for x in exact) and exact[place[k]] != 0:
            form = tuple(flint.fmpq(x) / abs(exact[place[k]]) for x in exact)
            number[k] = known.setdefault((int(alike[k]), form), k)
    merged = curves[number][np.searchsorted(curves, contacts.curves)]
    return rows, replace(contacts, curves=merged)


def _precision() -> AbstractContextManager[None]:
    context: AbstractContextManager[None] = flint.ctx.workprec(BITS)
    return context


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
        -1 or +1: theta - arccos or theta + arccos, or lower or upper root of a quadratic; 0 for an
        end.
    turns : int
        Full turns added.
    """

    form: int
    branch: int
    turns: int = 0


LOWEST, HIGHEST = Root(-1, 0), Root(-2, 0)


class Plane:
    """Forms of two joints, scaled to largest coefficient 1, with one joint as base.

    In `scaled`, the unit of a prismatic joint is its farthest limit; `table` has the same forms in
    the joints' own units. The first forms must all be positive. Then come the forms of contact
    features, which need not be positive.

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
        Factor by which all errors are enlarged.
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
        self.pairs = len(contacts.boundaries)
        self.base_kind: Kind = forms.kinds[base]
        self.lift_kind: Kind = forms.kinds[1 - base]
        self.base_range, self.lift_range = ranges[base], ranges[1 - base]
        self.ends = self.base_range or (-math.pi, math.pi)
        self.lift_ends = self.lift_range or (-math.pi, math.pi)
        # In mm the high powers of a slide have coefficients that would look like rounding.
        self.base_unit: float = _unit(self.base_kind, self.ends)
        self.lift_unit: float = _unit(self.lift_kind, self.lift_ends)
        self.powers: Floats = np.outer(
            self.base_unit ** np.arange(3), self.lift_unit ** np.arange(3)
        )
        own = np.asarray(forms.coefficients, dtype=float)
        self.scaled: Floats = self.scale(np.concatenate([own, contacts.forms]))
        self.table: Floats = self.scaled / self.powers
        self.scaled_size: Floats = np.abs(self.scaled).sum(axis=(1, 2))
        # Largest values of the coefficients along the lift, to which rounding is relative.
        self.sizes: Floats = np.abs(self.scaled).sum(axis=1) / self.lift_unit ** np.arange(3)
        # Ends of the lift's range are roots of forms -1 and -2: two zero rows at the end.
        rows = np.concatenate([self.table, np.zeros((2, 3, 3))])
        self._rows: Floats = self.table[: self.count].reshape(-1, 9).T
        self._columns: Floats = rows.transpose(1, 2, 0).copy()
        self._column_sizes: Floats = np.concatenate([self.sizes, np.zeros((2, 3))]).T.copy()
        # Rounding of a coefficient along the lift; on a circle the rounding of all three together.
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

        Positive means beyond the form's own doubt, shape (m,). Also tell whether none is negative
        beyond its doubt.
        """
        products, m = self.products(t, v), self.count
        surely, maybe = np.zeros((2, len(t)), dtype=np.bool_)
        left = np.arange(len(t))
        for at in range(0, m, FEW):  # few places are left after many forms
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
        """Return both roots of rows, from coefficients (3, ..., n) along the lift, with errors.

        Parameters
        ----------
        slack : ndarray, optional
            Further error of the coefficients, relative to the row's largest value.

        Returns
        -------
        values, errors : ndarray, shape (2, ..., n)
            Both roots and bounds of their errors; a double root is known to half of the digits.
        real : ndarray of int, shape (..., n)
            1 where there are two roots, -1 where there are none, 0 where doubles cannot tell.
        """
        doubt = (self.eps[row] + 8 * UNIT + slack) * self.scaled_size[row]
        return self._roots(c, doubt)

    def side_roots(self, side: Ints, t: Floats, radius: Floats) -> Any:
        """Return the same of side conditions, by number, over base values of some error."""
        tables = self.sides.reshape(-1, 3, 3)[side]
        return self.table_roots(tables, self.side_eps.reshape(-1)[side], t, radius)

    def table_roots(self, tables: Floats, eps: Floats, t: Floats, radius: Floats) -> Any:
        """Return the same of tables (n, 3, 3) that are scaled as forms are, with their errors."""
        factors = basis(self.base_kind, t / self.base_unit)
        c = np.einsum("ni,nij->jn", factors, tables)
        c = c / (self.lift_unit ** np.arange(3))[:, None]
        slack = 2 * radius / self.base_unit
        values, errors, real = self._roots(
            c, (eps + 8 * UNIT + slack) * np.abs(tables).sum(axis=(1, 2))
        )
        if self.lift_kind == "prismatic":
            values = np.where((c[2] == 0) & (c[1] == 0), np.nan, values)
            values[1] = np.where(c[2] == 0, np.nan, values[1])
        return values, errors, real

    def _roots(self, c: Floats, doubt: Floats) -> Any:
        if self.lift_kind == "revolute":
            theta, alpha, _ = _polar(c, np.zeros_like(doubt))
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

        Several roots, shape (..., k, 3), may share the same values, (k, n). A root that ends just
        there by rounding, at a fold, stays at the fold.
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

        With `first`, only the coefficients from this number on have to vanish.
        """
        size = self._column_sizes[first:, form, None]
        blank: Bools = np.asarray((np.abs(c) <= BLANK * size).all(axis=0))
        return blank & (size > 0).any(axis=0) if blank.any() else blank


def normalised(tables: Floats) -> Floats:
    """Return tables (..., 3, 3) with largest coefficient 1; a table of zeros is not changed."""
    largest = np.abs(tables).max(axis=(-2, -1), keepdims=True, initial=0.0)
    return np.asarray(tables / np.where(largest > 0, largest, 1.0))


def which(found: Any) -> Ints:
    """Return where an array, shape (n,), is true; for short arrays faster than `np.flatnonzero`."""
    return np.asarray(found.nonzero()[0])


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
    """Put rows on lines in their true order; doubles decide where they can, `decide` the rest.

    Parameters
    ----------
    line, v, error : ndarray, shape (n,)
        Line, value and a bound of its error, by line and upwards.
    circle : bool
        Whether lines are circles; then the last rows of a line may equal its first, a turn earlier.
    decide : callable
        Function of rows whose order doubles do not tell, and their values; returns these rows in
        order, equal ones together.
    name : ndarray of int, shape (n,), optional
        Rows with equal names that doubles do not separate are equal.

    Returns
    -------
    order, group : ndarray of int, shape (n,)
        Rows in order, and a number for each in that order, the same for equal rows.
    turned : list of int
        Rows that belong a turn earlier, at the beginning of their line.
    """
    n, low, high = len(line), v - error, v + error
    close = np.zeros(n, dtype=np.bool_)  # whether a row may be no higher than the one before
    close[1:] = (line[1:] == line[:-1]) & (low[1:] <= high[:-1])
    begin, number = which(~close), (~close).cumsum() - 1
    end, leader, turned = np.append(begin[1:], n), begin[number], list[int]()
    doubtful = close if name is None else close & (name != np.roll(name, 1))
    clusters = {
        int(begin[k]): list(range(begin[k], end[k]))
        for k in dict.fromkeys(number[doubtful].tolist())
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
        # They come between the rows before and behind; rows a turn earlier come before the first.
        flat = [row for group in groups for row in group]
        position[flat] = a - (own[0] in shift) + np.arange(1, len(flat) + 1) / (len(flat) + 1)
    order = np.lexsort([position, line])
    leader, line = leader[order], line[order]
    change = np.ones(n, dtype=np.bool_)
    change[1:] = (leader[1:] != leader[:-1]) | (line[1:] != line[:-1])
    return order, change.cumsum() - 1, turned


class PartingTests:
    """Separating tests of pairs of bodies: one clause of a pair is enough, if all its forms hold.

    Parameters
    ----------
    plane : Plane
        The plane of the features.
    pairs : ndarray of bool, shape (pairs,), optional
        The pairs to test; default: all.

    Attributes
    ----------
    pairs : ndarray of int
    doubt : float
        A height that is no farther from zero than this has no sign.
    """

    def __init__(self, plane: Plane, pairs: Bools | None = None) -> None:
        contacts = plane.contacts
        chosen = np.full(plane.pairs, True) if pairs is None else pairs
        self.plane, self.pairs = plane, which(chosen)
        self.discs: Floats = (plane.scale(contacts.discs[self.pairs]) / plane.powers).reshape(-1, 9)
        doubts = (plane.eps[plane.count :] + 16 * UNIT) * plane.scaled_size[plane.count :]
        self.doubt = float(doubts[chosen[contacts.pair]].max(initial=0.0))

    def heights(self, t: Floats, v: Floats) -> Floats:
        """Return the height of each pair's best test at base and lift values, (len(t), pairs).

        A height is a value of a scaled form, positive where the bodies are apart. Discs decide for
        most pairs.
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
        """Return the height of the best test of one pair, from the nine factors, (n, 9) to (n,)."""
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

    If terms cancel, for example where a form touches zero along a curve, the discriminant is only
    rounding. Coefficients with such errors cannot tell two roots from one, and it counts as one.
    """
    c0, c1, c2 = c
    d, height = np.hypot(c1, c2), np.abs(c0)
    ratio = -c0 / np.maximum(d, ZERO_AMPLITUDE * height + TINY)
    double = (np.abs(height - d) <= (TANGENT * d if doubt is None else doubt)) & (d > 0)
    ratio = np.where(double, np.copysign(1.0, ratio), ratio)
    alpha = np.arccos(np.minimum(np.maximum(ratio, -1.0), 1.0))
    return np.arctan2(c2, c1), alpha, ratio


def _settled(c: Floats, doubt: Floats) -> tuple[Floats, Floats, Floats]:
    """Make double roots of quadratics exact where coefficients cannot decide, as in `_polar`."""
    (c0, c1, c2), (e0, e1, e2) = c, doubt
    wide = 2 * np.abs(c1) * e1 + 4 * (np.abs(c0) * e2 + np.abs(c2) * e0)
    double = (np.abs(c1 * c1 - 4 * c0 * c2) <= wide) & (c2 != 0)
    return np.where(double, c1 * c1 / np.where(double, 4 * c2, 1.0), c0), c1, c2


def _unit(kind: Kind, ends: tuple[float, float]) -> float:
    return 1.0 if kind == "revolute" else max(map(abs, ends))


def _quadratic_roots(c0: Floats, c1: Floats, c2: Floats, *, folds: bool = False) -> Floats:
    """Return the lower and the upper root of c0 + c1 v + c2 v^2; an affine root stands first.

    With `folds`, the vertex replaces roots that are not real, and an affine root is given twice.
    """
    discriminant = _discriminant(c0, c1, c2)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        root = np.sqrt(np.maximum(discriminant, 0) if folds else discriminant)
        half = -(c1 + np.copysign(root, c1)) / 2
        pair = np.sort(np.stack([half / c2, np.where(root == 0, half / c2, c0 / half)]), axis=0)
        single = -c0 / c1
    singles = np.stack([single, single if folds else np.full_like(single, np.nan)])
    roots = np.where(c2 == 0, singles, pair)
    return np.nan_to_num(roots) if folds else np.where(np.isfinite(roots), roots, np.nan)


def _discriminant(c0: Floats, c1: Floats, c2: Floats) -> Floats:
    """Return c1^2 - 4 c0 c2, or zero where it is rounding, because a double root is a root."""
    square, product = c1 * c1, 4 * c0 * c2
    size = square + np.abs(product)
    return np.where(np.abs(square - product) <= TANGENT * size, 0.0, square - product)


LEVELS: Final = (128, 1024)
"""Bits that are tried in turn."""

ORDERS: Final = 12
"""Derivatives that are looked at, above the multiplicity of any zero of an event."""

HALVINGS: Final = 24
"""Times an interval is halved before an event counts as zero all over it."""


class UndecidedError(ArithmeticError):
    """Error: the structure of a region could not be decided; the message says where."""


@contextmanager
def precision(bits: int, orders: int = ORDERS) -> Iterator[None]:
    """Compute with this precision in bits, and with power series of this length."""
    before, cap = flint.ctx.prec, flint.ctx.cap
    flint.ctx.prec, flint.ctx.cap = bits, orders + 1
    try:
        yield
    finally:
        flint.ctx.prec, flint.ctx.cap = before, cap


# --- events ---------------------------------------------------------------------------------------

Product = Callable[[Any, Any], Any]


def _fold_circle(a: Any, _: Any, x: Product) -> Any:
    return x(a[1], a[1]) + x(a[2], a[2]) - x(a[0], a[0])


def _fold_line(a: Any, _: Any, x: Product) -> Any:
    return x(a[1], a[1]) - 4 * x(a[0], a[2])


def _end(a: Any, b: Any, x: Product) -> Any:
    return x(a[0], b[0]) + x(a[1], b[1]) + x(a[2], b[2])


def _determinant(a: Any, b: Any, x: Product) -> Any:
    return x(a[1], b[2]) - x(a[2], b[1])


def _cosine(a: Any, b: Any, x: Product) -> Any:
    return x(a[2], b[0]) - x(a[0], b[2])


def _sine(a: Any, b: Any, x: Product) -> Any:
    return x(a[0], b[1]) - x(a[1], b[0])


def _resultant_circle(a: Any, b: Any, x: Product) -> Any:
    one, other, both = _cosine(a, b, x), _sine(a, b, x), _determinant(a, b, x)
    return x(one, one) + x(other, other) - x(both, both)


def _resultant_line(a: Any, b: Any, x: Product) -> Any:
    q = _cosine(a, b, x)
    return x(q, q) - x(-_determinant(a, b, x), -_sine(a, b, x))


def _under(a: Any, b: Any, x: Product) -> Any:
    """Resultant of a quadratic a and an affine b."""
    return x(x(a[2], b[0]), b[0]) - x(x(a[1], b[0]), b[1]) + x(x(a[0], b[1]), b[1])


def _over(a: Any, b: Any, x: Product) -> Any:
    return _under(b, a, x)


@dataclass(frozen=True)
class EventKind:
    """A function of the base whose zeros are events of one form or of two forms.

    Attributes
    ----------
    formula : callable
        Takes both forms' three coefficients along the lift, and a product; the same code serves
        polynomials, numbers and power series.
    size : callable
        The same with all signs positive, for bounds of the coefficients.
    degrees : (int, int)
        Degrees in the coefficients of the first form and of the second.
    """

    formula: Callable[[Any, Any, Product], Any]
    size: Callable[[Any, Any], Any]
    degrees: tuple[int, int]


def _crossed(i: int, j: int) -> Callable[[Any, Any], Any]:
    return lambda a, b: a[i] * b[j] + a[j] * b[i]


_ONE, _TWO, _BOTH = _crossed(2, 0), _crossed(0, 1), _crossed(1, 2)


def _size_under(a: Any, b: Any) -> Any:
    return a[2] * b[0] ** 2 + a[1] * b[0] * b[1] + a[0] * b[1] ** 2


KINDS: Final = {
    "fold circle": EventKind(_fold_circle, lambda a, b: a[0] ** 2 + a[1] ** 2 + a[2] ** 2, (2, 0)),
    "fold line": EventKind(_fold_line, lambda a, b: a[1] ** 2 + 4 * a[0] * a[2], (2, 0)),
    "constant": EventKind(lambda a, b, x: a[0], lambda a, b: a[0], (1, 0)),
    "first": EventKind(lambda a, b, x: a[1], lambda a, b: a[1], (1, 0)),
    "second": EventKind(lambda a, b, x: a[2], lambda a, b: a[2], (1, 0)),
    "lower end": EventKind(_end, lambda a, b: a[0] + a[1] + a[2], (1, 0)),
    "upper end": EventKind(_end, lambda a, b: a[0] + a[1] + a[2], (1, 0)),
    "determinant": EventKind(_determinant, _BOTH, (1, 1)),
    "cosine": EventKind(_cosine, _ONE, (1, 1)),
    "sine": EventKind(_sine, _TWO, (1, 1)),
    "resultant circle": EventKind(
        _resultant_circle,
        lambda a, b: _ONE(a, b) ** 2 + _TWO(a, b) ** 2 + _BOTH(a, b) ** 2,
        (2, 2),
    ),
    "resultant line": EventKind(
        _resultant_line, lambda a, b: _ONE(a, b) ** 2 + _BOTH(a, b) * _TWO(a, b), (2, 2)
    ),
    "under": EventKind(_under, _size_under, (1, 2)),
    "over": EventKind(_over, lambda a, b: _size_under(b, a), (2, 1)),
}
"""What may happen at a base value.

A fold: two roots of a form meet. First, second, constant: that coefficient along the lift vanishes.
An end: a root passes an end of the lift's range. The others: two forms may share a root.
"""

NAMES: Final = tuple(KINDS)
NUMBER: Final = {name: k for k, name in enumerate(NAMES)}


@dataclass(frozen=True, eq=False)
class Zero:
    """A zero of a derivative of an event, isolated.

    Attributes
    ----------
    event : (int, int, int) or None
        Kind, and both rows; None for a fixed number.
    order : int
        The derivative that vanishes; above 0 for a zero of several derivatives.
    ball : arb
        Ball that holds this zero, and no other zero of that derivative.
    """

    event: tuple[int, int, int] | None
    order: int
    ball: Ball

    def __reduce__(self) -> tuple[Any, ...]:
        """Write a ball as whole numbers, because Arb's balls have no state to copy."""
        if not isinstance(self.ball, flint.arb):
            return Zero, (self.event, self.order, self.ball)
        ends = (map(int, part.man_exp()) for part in (self.ball.mid(), self.ball.rad()))
        return _zero_of, (self.event, self.order, *map(tuple, ends))


def _zero_of(event: tuple[int, int, int] | None, order: int, middle: Any, radius: Any) -> Zero:
    return Zero(event, order, flint.arb(middle, radius))


class Precise:
    """A plane with exact coefficients, for decisions that its doubles cannot make.

    Rows are numbered as in `Plane`: forms, then features. The side conditions come after them,
    together for each feature. -1 and -2 are the ends of the lift's range.
    """

    @classmethod
    def of(cls, problem: Problem, base: int, caution: float = 1.0) -> Precise:
        """Return a problem's plane over a joint with its exact coefficients."""
        rows, contacts = shared_rows(problem)
        plane = Plane(problem.forms, problem.ranges, base, contacts, problem.errors, caution)
        return cls(plane, rows)

    def __init__(self, plane: Plane, rows: ExactRows) -> None:
        self.plane, self.rows = plane, rows
        self.features = plane.count + len(plane.contacts.forms)
        self.decided = 0
        self._tables: dict[tuple[int, int], list[list[Ball]]] = {}
        self._exact: dict[int, NDArray[Any]] = {}
        self._zeros: dict[tuple[Any, ...], list[Zero]] = {}

    def __getstate__(self) -> dict[str, Any]:
        """Leave exact numbers out of a copy: they are found again, and some go by identities."""
        return vars(self) | {"_tables": {}, "_exact": {}, "_zeros": {}}

    # --- coefficients ---------------------------------------------------------------------------

    def table(self, row: int, bits: int) -> list[list[Ball]]:
        """Return coefficients, base before lift, as balls."""
        found = self._tables.get((row, bits))
        if found is None:
            exact = self._exact_table(row)
            found = [[flint.arb(x) for x in line] for line in exact]
            self._tables[row, bits] = found
        return found

    def _exact_table(self, row: int) -> NDArray[Any]:
        if row not in self._exact:
            count = self.plane.count
            if row < count:
                self._exact[row] = self._turned(self.rows.form(row))
            elif row < self.features:
                self._exact[row] = self._turned(self.rows.feature(row - count)[0])
            else:
                k, side = divmod(row - self.features, SIDES)
                self._exact[row] = self._turned(self.rows.feature(k)[1][side])
        return self._exact[row]

    def _turned(self, table: NDArray[Any]) -> NDArray[Any]:
        return table if self.plane.base == 0 else table.T

    def is_still(self, row: int) -> bool:
        """Tell whether a row, or an end of the lift's range, surely does not depend on the base."""
        return row < 0 or all(x == 0 for x in self._exact_table(row)[1:].reshape(-1))

    def ends(self, joint: str) -> tuple[Ball, Ball]:
        """Return the exact ends of the range of "base" or "lift"; for a circle of one turn."""
        index = self.plane.base if joint == "base" else 1 - self.plane.base
        found = self.rows.range(index)
        return (-flint.arb.pi(), flint.arb.pi()) if found is None else found

    def along_lift(self, row: int, t: Ball, bits: int) -> list[Ball]:
        """Return a row's three coefficients along the lift over a base value."""
        return _combined(self.table(row, bits), *_factors(self.plane.base_kind, t))

    def series(self, rows: Sequence[int], t: Ball, bits: int) -> list[list[Ball]]:
        """Return the three coefficients along the lift of rows as power series about a base value.

        With one order they are numbers.
        """
        kind, cap = self.plane.base_kind, flint.ctx.cap
        tables = [self.table(row, bits) for row in rows]
        if cap > 2:
            near = _factors(kind, flint.arb_series([t, 1]))
            return [[flint.arb_series(x) for x in _combined(table, *near)] for table in tables]
        one, other = _factors(kind, t)
        values = [_combined(table, one, other) for table in tables]
        if cap == 1:
            return values
        # For a value and a slope no products of series are needed.
        step = (-other, one) if kind == "revolute" else (1, 2 * t)
        slopes = [_combined([_NOTHING, *table[1:]], *step) for table in tables]
        return [
            [flint.arb_series([*pair]) for pair in zip(*both, strict=True)]
            for both in zip(values, slopes, strict=True)
        ]

    def value(self, row: int, t: Ball, v: Ball, bits: int) -> Ball:
        """Return the value of a row at base and lift."""
        c, (one, other) = self.along_lift(row, t, bits), _factors(self.plane.lift_kind, v)
        return c[0] + c[1] * one + c[2] * other

    def sign(self, row: int, t: Any, v: Any) -> int:
        """Return the sign of a row at a place; 0 where 1,024 bits do not tell it from zero.

        Base and lift value are numbers, or functions of the number of bits.
        """
        for bits in LEVELS:
            with precision(bits):
                place = _at(v, bits)  # None if these bits do not decide
                found = 0 if place is None else _sign(self.value(row, _at(t, bits), place, bits))
            if found:
                return found
        return 0

    def sides(self, row: int, t: Any, v: Any) -> tuple[int, int]:
        """Return the signs of a row just before and just behind a base value; as `sign`.

        Where the row vanishes, its first nonzero derivative along the base decides.
        """
        found, second = self.sign(row, t, v), 0
        for bits in LEVELS if not found else ():
            with precision(bits, orders=2):
                place = _at(v, bits)
                if place is None:
                    continue
                (c,) = self.series([row], _at(t, bits), bits)
                one, other = _factors(self.plane.lift_kind, place)
                # The degree along the base is at most 2, or 1 in an angle, so higher derivatives
                # are not needed.
                first, second = (_sign(c[0][k] + c[1][k] * one + c[2][k] * other) for k in (1, 2))
            if first:
                return -first, first
        return found or second, found or second

    def holds(self, feature: int, t: Any, v: Any) -> bool:
        """Tell whether no side condition of a feature is negative at a place, as `sign` decides."""
        sides = self.plane.sides[feature]
        for side, constant in enumerate(~sides.reshape(SIDES, 9)[:, 1:].any(axis=1)):
            number = self.features + SIDES * feature + side
            if sides[side, 0, 0] < 0 if constant else self.sign(number, t, v) < 0:
                return False
        return True

    # --- events ---------------------------------------------------------------------------------

    def taylor(self, event: tuple[int, int, int], t: Ball, bits: int, n: int) -> list[Ball]:
        """Return the first n derivatives of an event at t, each over its factorial."""
        cap, flint.ctx.cap = flint.ctx.cap, n
        try:
            found = self._formula(event, self.series(_rows(event), t, bits))
        finally:
            flint.ctx.cap = cap
        return [found] if n == 1 else [found[k] for k in range(n)]

    def _formula(self, event: tuple[int, int, int], both: list[list[Any]]) -> Any:
        """Return an event from the coefficients along the lift of its one or two rows."""
        name = NAMES[event[0]]
        if name in ("lower end", "upper end"):
            end = self.ends("lift")[name == "upper end"]
            both = [*both, [flint.arb(1), *_factors(self.plane.lift_kind, end)]]
        return KINDS[name].formula(both[0], both[-1], operator.mul)

    def vanishes(self, event: tuple[int, int, int]) -> bool:
        """Tell whether an event is zero at every base value.

        Each coefficient has degree at most 2 along the base, or 1 in an angle, so the number of
        zeros in a turn is bounded. If the event is zero at one more place than that, it is zero
        everywhere.
        """
        key = ("vanishes", *event)
        if key not in self._zeros:
            count = 2 * sum(KINDS[NAMES[event[0]]].degrees) + 1
            with precision(LEVELS[-1]):
                values = (self._at_ratio(event, flint.fmpq(k + 1, count)) for k in range(count))
                every = all(x.contains(0) if isinstance(x, flint.arb) else x == 0 for x in values)
            self._zeros[key] = [] if every else [Zero(event, 0, 0)]
        return not self._zeros[key]

    def _at_ratio(self, event: tuple[int, int, int], x: Any) -> Any:
        """Return an event where a base that slides is at x, else where tan(q / 2) is x.

        There sine and cosine are rational, so what is made of rational rows is exact.
        """
        square = x * x
        turned = (1 - square) / (1 + square), 2 * x / (1 + square)
        factors = turned if self.plane.base_kind == "revolute" else (x, square)
        rows = [_combined(self._exact_table(row).tolist(), *factors) for row in _rows(event)]
        return self._formula(event, rows)

    def zeros(
        self, event: tuple[int, int, int], low: float, high: float, bits: int
    ) -> list[Zero] | None:
        """Return the zeros of an event within an interval; None if it is zero all over it."""
        self.decided += 1
        with precision(bits):
            whole = flint.arb((low + high) / 2, (high - low) / 2)
            return self._in(event, whole, bits)

    def _in(self, event: tuple[int, int, int], whole: Ball, bits: int) -> list[Zero] | None:
        found, open_ = list[Zero](), [(whole, 0)]
        while open_:
            part, depth = open_.pop()
            zeros = self._monotone(event, part, bits)
            if zeros is not None:
                found += [Zero(event, k, ball) for k, ball in zeros]
                continue
            if depth == HALVINGS:
                return None
            middle, half = part.mid(), part.rad() / 2
            radius = half.upper()
            for side in (middle - half, middle + half):
                open_.append((flint.arb(side.mid(), radius), depth + 1))
        return _apart(found)

    def _monotone(
        self, event: tuple[int, int, int], part: Ball, bits: int
    ) -> list[tuple[int, Ball]] | None:
        """Return the zeros within a ball from those of derivatives; None if no derivative helps.

        Between two zeros of its derivative a function is monotone, so its signs there tell whether
        it has a zero between. If a sign is not known, the place counts as a zero of both.
        """
        for way in range(3):
            if way < 2:  # most zeros are simple ones
                over = self.taylor(event, part, bits, ORDERS if way else 2)
            else:
                over = self._centred(event, part, bits)
            top = next((k for k, value in enumerate(over) if _sign(value)), None)
            if top is not None:
                break
        else:
            return None
        ends = [part.lower(), part.upper()]
        zeros: list[tuple[int, Ball]] = []
        for k in reversed(range(top)):
            marks = [(k, ends[0]), *zeros, (k, ends[1])]
            signs = [_sign(self.taylor(event, x, bits, k + 1)[k]) for _, x in marks]
            found = [mark for mark, sign in zip(marks[1:-1], signs[1:-1], strict=True) if not sign]
            for (_, a), (_, b), one, other in zip(marks, marks[1:], signs, signs[1:], strict=False):
                if one * other < 0:
                    found.append((k, self._between(event, k, a, b, one, bits)))
            for mark, sign in ((marks[0], signs[0]), (marks[-1], signs[-1])):
                if not sign:
                    found.append(mark)
            zeros = sorted(found, key=lambda item: float(item[1].mid()))
        return zeros

    def _centred(self, event: tuple[int, int, int], part: Ball, bits: int) -> list[Ball]:
        """Return narrow derivatives over a ball, by Taylor's formula from its middle.

        Taylor's polynomial, its last term with the derivative over the whole ball.
        """
        n = 2 * ORDERS
        middle = self.taylor(event, part.mid(), bits, n)
        last = self.taylor(event, part, bits, n + 1)[n]
        step, found = flint.arb(0, part.rad()), []
        for k in range(ORDERS):
            value = last * math.comb(n, k)
            for j in reversed(range(k, n)):
                value = value * step + middle[j] * math.comb(j, k)
            found.append(value)
        return found

    def _between(
        self, event: tuple[int, int, int], k: int, a: Ball, b: Ball, sign: int, bits: int
    ) -> Ball:
        """Return the zero of a monotone derivative between two places of opposite sign."""
        low, high = a.upper(), b.lower()
        if low > high:
            low, high = a.mid(), b.mid()
        for _ in range(4 * bits):
            box = low.union(high)
            slope = (k + 1) * self.taylor(event, box, bits, k + 2)[k + 1]
            middle = box.mid()
            value = self.taylor(event, middle, bits, k + 1)[k]
            if _sign(slope):
                new = (
                    (middle - value / slope).intersection(box)
                    if ((middle - value / slope).overlaps(box))
                    else middle
                )
                if new.rad() * 2 < box.rad():
                    low, high = new.lower(), new.upper()
                    continue
                if _sign(value) == 0:
                    return new
            here = _sign(value)
            if not here:  # perhaps the zero itself: look on both sides
                off = box.rad() / 2
                left, right = (middle - off).mid(), (middle + off).mid()
                begins = _sign(self.taylor(event, left, bits, k + 1)[k]) == sign
                ends = _sign(self.taylor(event, right, bits, k + 1)[k]) == -sign
                if not (begins or ends):
                    return box
                low, high = left if begins else low, right if ends else high
                continue
            low, high = (middle, high) if here == sign else (low, middle)
            if high - low < flint.arb(2) ** (8 - bits):
                return low.union(high)
        return low.union(high)

    def refined(self, zero: Zero, bits: int) -> Ball:
        """Return a zero to nearly the given number of bits."""
        if zero.event is None:
            with precision(bits):
                return zero.ball() if callable(zero.ball) else flint.arb(zero.ball)
        key = (id(zero), bits)
        if key not in self._zeros:
            known = (self._zeros.get((id(zero), fewer)) for fewer in reversed(LEVELS))
            start = next((found[1] for found in known if found is not None), zero.ball)
            self._zeros[key] = [zero, self._newton(zero, start, bits)]
        return self._zeros[key][1]

    def _newton(self, zero: Zero, start: Ball, bits: int) -> Ball:
        """Return the zero in a ball about it, to nearly the given number of bits."""
        event, k = zero.event, zero.order
        assert event is not None
        with precision(bits + 32):
            box = flint.arb(start)
            least = flint.arb(2) ** -bits * self.plane.base_unit
            for _ in range(200):
                if box.rad() < least:
                    break
                slope = (k + 1) * self.taylor(event, box, bits + 32, k + 2)[k + 1]
                if not _sign(slope):
                    break
                middle = box.mid()
                step = middle - self.taylor(event, middle, bits + 32, k + 1)[k] / slope
                if not step.overlaps(box):
                    break
                new = step.intersection(box)
                if not new.rad() * 2 < box.rad():
                    return new
                box = new
            return box

    # --- roots along the lift -------------------------------------------------------------------

    def root(self, row: int, branch: int, t: Ball, bits: int, side: int = 0) -> Ball | None:
        """Return a root along the lift over a base value, as `Plane.follow` does.

        Parameters
        ----------
        side : int
            -1 or +1: if the row vanishes on the whole fibre, the limit from that side is returned.

        Returns
        -------
        arb or None
            None if not even the direction can be decided.
        """
        if row < 0:
            return self.ends("lift")[int(row == HIGHEST.form)]
        c = self.along_lift(row, t, bits)
        if side and all(x.contains(0) for x in c):
            (series,) = self.series([row], t, bits)
            for k in range(1, ORDERS):
                c = [x[k] * side**k for x in series]
                if not all(x.contains(0) for x in c):
                    break
        if self.plane.lift_kind == "revolute":
            return self._on_circle(c, branch)
        return self._on_line(c, branch)

    def _on_circle(self, c: Sequence[Ball], branch: int) -> Ball | None:
        c0, c1, c2 = c
        square = c1 * c1 + c2 * c2
        if not square > 0:
            return None
        rest = square - c0 * c0
        height = flint.arb(0) if rest < 0 else rest.nonnegative_part().sqrt()
        if rest.contains(0):
            height = _around_root(rest)
        # Beside the negative axis the angle is taken from the other one, which has no cut there.
        angle, pi = flint.arb.atan2, flint.arb.pi()
        theta = angle(c2, c1) if not c1 < 0 else angle(-c2, -c1) + (-pi if c2 < 0 else pi)
        alpha = angle(height, -c0) if not c0 > 0 else pi - angle(height, c0)
        return theta + branch * alpha

    def _on_line(self, c: Sequence[Ball], branch: int) -> Ball | None:
        c0, c1, c2 = c
        if c2.is_zero():
            return None if c1.contains(0) else -c0 / c1
        if c2.contains(0):
            return None if c1.contains(0) else self._near_line(c0, c1, c2, branch)
        rest = c1 * c1 - 4 * c0 * c2
        root = _around_root(rest) if rest.contains(0) else rest.nonnegative_part().sqrt()
        sign = branch if c2 > 0 else -branch
        return (-c1 + sign * root) / (2 * c2)

    def _near_line(self, c0: Ball, c1: Ball, c2: Ball, branch: int) -> Ball | None:
        """Return the finite root of a quadratic that may be affine."""
        rest = (c1 * c1 - 4 * c0 * c2).nonnegative_part().sqrt()
        half = c1 + (rest if c1 > 0 else -rest)
        return -2 * c0 / half

    def real(self, row: int, t: Any) -> int:
        """Return the sign of the discriminant along the lift: 1 for two roots, 0 for a double."""
        for bits in LEVELS:
            with precision(bits):
                c = self.along_lift(row, _at(t, bits), bits)
                if self.plane.lift_kind == "revolute":
                    rest = c[1] * c[1] + c[2] * c[2] - c[0] * c[0]
                else:
                    rest = c[1] * c[1] - 4 * c[0] * c[2]
                if _sign(rest):
                    return _sign(rest)
        return 0


def _rows(event: tuple[int, int, int]) -> tuple[int, ...]:
    """Return the one or two rows of an event."""
    return event[1:] if KINDS[NAMES[event[0]]].degrees[1] else event[1:2]


_NOTHING = (0, 0, 0)


def _combined(lines: Sequence[Sequence[Any]], one: Any, other: Any) -> list[Any]:
    """Return the sums of three lines with factors 1, `one` and `other`, skipping zeros."""
    found = []
    for a, b, c in zip(*lines, strict=True):
        value = a if b.is_zero() else a + b * one
        found.append(value if c.is_zero() else value + c * other)
    return found


def _factors(kind: str, t: Any) -> tuple[Any, Any]:
    if kind == "revolute":
        sine, cosine = t.sin_cos()
        return cosine, sine
    return t, t * t


def _at(x: Any, bits: int) -> Ball:
    """Return a number, or a function of the number of bits, as a ball."""
    return x(bits) if callable(x) else flint.arb(x)


def _sign(x: Ball) -> int:
    return 1 if x > 0 else -1 if x < 0 else 0


def _around_root(rest: Ball) -> Ball:
    """Return the square root of a ball that holds zero: from 0 to the root of its upper end."""
    top = rest.upper().nonnegative_part().sqrt()
    return flint.arb(0).union(top)


def _apart(zeros: list[Zero]) -> list[Zero]:
    """Return zeros ascending, one for zeros that overlap, as at the ends of halves."""
    kept: list[Zero] = []
    for zero in sorted(zeros, key=lambda item: float(item.ball.mid())):
        if kept and kept[-1].ball.overlaps(zero.ball):
            if zero.order < kept[-1].order:
                kept[-1] = zero
            continue
        kept.append(zero)
    return kept


def in_order(
    items: Sequence[Any], ball_of: Callable[[Any, int], Ball], names: Sequence[Any] | None = None
) -> list[tuple[Ball, list[Any]]]:
    """Put items in the order of their numbers; items that 1,024 bits do not separate are together.

    Parameters
    ----------
    ball_of : callable
        Function of an item and the number of bits.
    names : sequence, optional
        Items with equal names have equal numbers and need not be compared.

    Returns
    -------
    list of (arb, list)
        Ascending: a ball, and the items whose number it holds.
    """
    names = range(len(items)) if names is None else names
    groups: list[tuple[Ball, list[int]]] = []
    for bits in LEVELS:
        with precision(bits):
            known: dict[Any, Ball] = {}
            for item, name in zip(items, names, strict=True):
                if name not in known:
                    known[name] = ball_of(item, bits)
            order = sorted(range(len(items)), key=lambda k: _Exactly(known[names[k]].mid()))
            groups, vague = [], False
            for k in order:
                ball = known[names[k]]
                if groups and groups[-1][0].overlaps(ball):
                    vague |= any(names[j] != names[k] for j in groups[-1][1])
                    groups[-1] = groups[-1][0].union(ball), [*groups[-1][1], k]
                else:
                    groups.append((ball, [k]))
        if not vague:
            break
    return [(ball, [items[k] for k in own]) for ball, own in groups]


class _Exactly:
    """A key of exact numbers for sorting."""

    def __init__(self, value: Ball) -> None:
        self.value = value

    def __lt__(self, other: _Exactly) -> bool:
        return bool(self.value < other.value)


def midpoint(a: Ball, b: Ball) -> Ball:
    """Return an exact number between two balls."""
    return flint.arb(((a + b) / 2).mid())


def to_float(x: Ball) -> float:
    """Return the double nearest to the middle of a ball."""
    return float(x.mid())
