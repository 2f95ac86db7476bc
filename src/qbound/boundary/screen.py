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
:math:`(K + 2) u`. Times the sizes of all terms of a form, this bounds the error of the value, but
for products of errors. `ROOM` allows for those and for the rounding of double precision.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from qbound.arrays import Bools, Floats, Singles
from qbound.boundary.binding import binding
from qbound.boundary.monomials import Monomials, padded
from qbound.forms.factors import Kind

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

    A value of at least 1 in every row is feasible for certain; one of at most -1 in any is not.

    Attributes
    ----------
    table : ndarray of float32, shape (rows, monomials)
    monomials : Monomials
    reach : ndarray of float32, shape (joints,)
        Absolute values of the joints up to which the bounds hold.
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
        """Return who is feasible for certain and who is too near to say, (n, joints) to (n,).

        A configuration with a NaN or an infinite value is too near to say.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            columns = padded(q, WIDTH, np.float32)
            least = self._least(columns)[: len(q)]
        feasible = least >= 1
        near = feasible == (least <= -1)  # neither, as of NaN
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
    """Return up to which absolute value each joint is screened: beyond its range, if it has one."""
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
        Absolute values of the joints up to which the bounds are to hold.
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
    """Return bounds of the error of each monomial beside its size, in `UNIT`."""
    errors = [0.0]
    for joint, (kind, _) in monomials.factors:
        errors.append(reach[joint] + sines if kind == "revolute" else 3.0)
    for i, j in monomials.products:
        errors.append(errors[i] + errors[j] + 1)
    return np.array(errors)
