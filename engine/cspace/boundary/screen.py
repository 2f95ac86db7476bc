r"""Floating-point filter: signs in single precision where the error bound allows it.

Most configurations are far from every boundary, so their signs need few digits. The filter
evaluates the forms in single precision, four times as fast, and bounds the error. If a value is
within the bound, or a joint value is beyond the range for which the bound holds, double precision
decides. So the answers are those of double precision, by construction.

Notes
-----
Let :math:`u = 2^{-24}`. A joint value of at most R is right to :math:`R u` once it is rounded. So
its sine and cosine are right to :math:`(R + t) u`, where t is their own error (`SINES`). Joint
values and their squares are right to :math:`3 u` of their size. The product of p factors is right
to the sum of these errors and :math:`p u`. A sum of K terms with rounded coefficients adds
:math:`(K + 2) u`. Times the sizes of all terms of a form, this bounds the error of the value,
except for products of errors. `ROOM` covers these products and the rounding of double precision.

Rows that other rows imply are dropped, so that fewer rows are evaluated for each configuration.

A form of one turning joint, :math:`c + a \cos q + b \sin q`, is negative on one arc of its circle
(Theorem 2). If the arcs of other forms and the values beyond the joint's limits cover this arc, the
form never decides and need not be evaluated. The forms that are left bound the free intervals.

Notes
-----
Rows are in units of the bound of their error (`cspace.boundary.screen`). A row that is left out is
at least `CERTAIN` wherever all others are at least `BELOW`. So every way of evaluation finds this
row positive there. The rounding of the arcs is a billionth of the unit between the two levels.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cspace.arrays import Bools, Floats, Singles
from cspace.forms.factors import VALUE, Monomials, padded
from qbound.forms import Kind

UNIT = 2.0**-24
"""Half a unit in the last place of single precision, relative."""

SINES = 16.0
"""Bound of the error of NumPy's sine and cosine in single precision, in `UNIT`. Its tests allow 4
units in the last place, at most 4 of these below 1; over every number from 2**-14 to 32 rad the
largest found is 1.3."""

ROOM = 1.25
"""The bound is this much larger than its first-order terms, themselves at most a thousandth."""

TURNS = 32.0
"""Reach of a revolute joint, rad: five turns either way."""

SIZES = (2.0**-60, 2.0**60)
"""Monomials of these sizes neither over- nor underflow in single precision."""

LEAST = 2.0**-900
"""Least bound of an error: where lengths or their squares underflow, nothing is certain."""

ENTRIES = 2**17
"""Monomials of a block: they stay in the cache."""

PRODUCTS = 2**17
"""Products of one small matrix product: larger ones are cut by the library over all cores, at a
cost above their own."""

WIDTH = 512
"""Configurations of one small matrix product."""


@dataclass(frozen=True, eq=False)
class Screen:
    """A table in single precision, each row divided by the bound of its error.

    A configuration is certainly feasible if every row is at least 1, and certainly not if one row
    is at most -1.

    Attributes
    ----------
    table : ndarray of float32, shape (rows, monomials)
    monomials : Monomials
    reach : ndarray of float32, shape (joints,)
        Largest absolute joint values for which the bounds hold.
    """

    table: Singles
    monomials: Monomials
    reach: Singles

    @cached_property
    def block(self) -> int:
        """Configurations a block, a multiple of `WIDTH`."""
        return WIDTH * max(1, min(16, ENTRIES // (WIDTH * len(self.monomials))))

    @cached_property
    def _groups(self) -> list[Singles]:
        rows = max(1, PRODUCTS // (WIDTH * len(self.monomials)))
        return [self.table[k : k + rows] for k in range(0, len(self.table), rows)]

    def judge(self, q: Floats) -> tuple[Bools, Bools]:
        """Return which configurations are certainly feasible, which undecided: (n, joints) to (n,).

        A configuration with a NaN or an infinite value is undecided.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            columns = padded(q, WIDTH, np.float32)
            least = self._least(columns)[: len(q)]
        feasible = least >= 1
        near = feasible == (least <= -1)  # neither; so for NaN
        if not (np.abs(columns).max(axis=1, initial=0) <= self.reach).all():
            near |= ~(np.abs(columns[:, : len(q)]) <= self.reach[:, None]).all(axis=0)
        return feasible, near

    def _least(self, columns: Singles) -> Singles:
        """Return the least value of any row, shape (joints, n) to (n,)."""
        rows = self.monomials.of_columns(columns)
        parts = rows.reshape(len(rows), -1, WIDTH).transpose(1, 0, 2)
        least = np.full((parts.shape[0], WIDTH), 2, np.float32)
        for group in self._groups:
            np.minimum(least, (group @ parts).min(axis=1), out=least)
        return least.reshape(-1)


def reaches(kinds: Sequence[Kind], ranges: Sequence[tuple[float, float] | None]) -> Floats:
    """Return the largest absolute value screened of each joint: beyond its range, if any."""
    ends = [1.0 if ends is None else max(map(abs, ends)) for ends in ranges]
    turning = [kind == "revolute" for kind in kinds]
    return np.where(turning, np.maximum(TURNS, np.multiply(ends, 1.25)), np.multiply(ends, 2.0))


def screen(
    table: Floats, monomials: Monomials, reach: Floats, sines: float = SINES
) -> Screen | None:
    """Return a table as a `Screen`; None where its monomials are beyond single precision.

    Parameters
    ----------
    table : ndarray, shape (rows, monomials)
        A configuration is feasible where no row has a negative value.
    monomials : Monomials
    reach : ndarray, shape (joints,)
        Largest absolute joint values for which the bounds have to hold.
    sines : float
        Error of sines and cosines, in `UNIT`.
    """
    sizes = np.array(monomials.sizes(reach.tolist()))
    least, most = SIZES
    if not ((sizes >= least) & (sizes <= most)).all():
        return None
    table = table[(table != 0).any(axis=1)]  # a row of zeros holds everywhere
    errors = _errors(monomials, reach, sines) + len(monomials) + 2
    bounds = np.maximum(ROOM * UNIT * (np.abs(table) @ (errors * sizes)), LEAST)
    scaled = table / bounds[:, None]
    asked = binding(scaled, monomials, reach)
    return Screen(scaled[asked].astype(np.float32), monomials, reach.astype(np.float32))


def _errors(monomials: Monomials, reach: Floats, sines: float) -> Floats:
    """Return bounds of each monomial's error, relative to its size, in `UNIT`."""
    errors = [0.0]
    for joint, (kind, _) in monomials.factors:
        errors.append(reach[joint] + sines if kind == "revolute" else 3.0)
    for i, j in monomials.products:
        errors.append(errors[i] + errors[j] + 1)
    return np.array(errors)


# --- rows that decide -----------------------------------------------------------------------------


CERTAIN, BELOW = 2.0, -1.0
"""A row is left out only where it is at least the first; it is so by others that are not below
the second."""

TURN = 2 * math.pi

SEAM = 1e-9
"""Taken off what limits exclude, at both ends, and the least by which an arc carries on, rad."""


def binding(table: Floats, monomials: Monomials, reach: Floats) -> Bools:
    """Tell which rows have to be evaluated, shape (rows,).

    Parameters
    ----------
    table : ndarray, shape (rows, monomials)
        Each row divided by the bound of its error; feasible is >= 0.
    monomials : Monomials
    reach : ndarray, shape (joints,)
        Largest absolute joint values for which the answer has to hold.

    Returns
    -------
    ndarray of bool
        False where a row is certainly positive, or is so wherever the other rows are not negative.
    """
    sizes = np.array(monomials.sizes(reach.tolist()))
    asked = table[:, 0] - np.abs(table[:, 1:]) @ sizes[1:] < CERTAIN
    for joint in range(monomials.joints):
        columns = _columns(monomials, joint)
        if columns is not None:
            _leave_out(table, columns, _excluded(table, monomials, joint), asked)
    return np.asarray(asked)


def _columns(monomials: Monomials, joint: int) -> list[int] | None:
    """Return the monomials cosine and sine of a joint; None if one of them is missing."""
    functions = [(joint, ("revolute", i)) for i in (1, 2)]
    if not all(each in monomials.factors for each in functions):
        return None
    return [1 + monomials.factors.index(each) for each in functions]


def _excluded(table: Floats, monomials: Monomials, joint: int) -> tuple[float, float]:
    """Return the arc, by its start and length, that the limits of a joint exclude; maybe none."""
    if (joint, VALUE) not in monomials.factors:
        return 0.0, 0.0
    value = 1 + monomials.factors.index((joint, VALUE))
    bounds = table[(table[:, value] != 0) & (np.count_nonzero(table[:, 1:], axis=1) == 1)]
    ends, rising = -bounds[:, 0] / bounds[:, value], bounds[:, value] > 0
    if rising.all() or not rising.any():
        return 0.0, 0.0
    low, high = ends[rising].max(), ends[~rising].min()
    return float(high) + SEAM, max(0.0, TURN - float(high - low) - 2 * SEAM)


def _leave_out(
    table: Floats, columns: list[int], excluded: tuple[float, float], asked: Bools
) -> None:
    """Leave out rows of one joint whose arcs others cover, the shortest arcs first."""
    others = np.delete(table, [0, *columns], axis=1)
    rows = np.flatnonzero(asked & ~others.any(axis=1) & table[:, columns].any(axis=1))
    constant, (a, b) = table[rows, 0], table[rows][:, columns].T
    starts, lengths = _arcs(constant - BELOW, a, b)
    wide_starts, wide = _arcs(constant - CERTAIN, a, b)
    starts, lengths = np.append(starts, excluded[0]), np.append(lengths, excluded[1])
    for k in np.argsort(wide, kind="stable").tolist():
        length, lengths[k] = lengths[k], 0.0
        if not wide[k] or _covered(wide_starts[k], wide[k], starts, lengths):
            asked[rows[k]] = False
        else:
            lengths[k] = length


def _arcs(c: Floats, a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return starts and lengths of the arcs on which c + a cos q + b sin q is negative."""
    half = np.arccos(np.clip(c / np.hypot(a, b), -1, 1))
    return np.arctan2(-b, -a) - half, 2 * half


def _covered(start: float, length: float, starts: Floats, lengths: Floats) -> bool:
    """Tell whether other arcs cover an arc, each of them adding more than `SEAM`.

    The loop ends because each arc extends the cover once, and the arc that holds the start twice.
    """
    done = 0.0
    for _ in range(len(lengths) + 1):
        before = np.mod(start + done - starts, TURN)
        further = np.where(before < lengths, lengths - before, 0.0).max(initial=0.0)
        if further <= SEAM:
            return False
        done += float(further)
        if done > length:
            return True
    return False
