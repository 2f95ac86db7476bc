r"""Drop rows that other rows imply, so that a stream of configurations evaluates fewer of them.

A form of one turning joint, :math:`c + a \cos q + b \sin q`, is negative on one arc of its circle
(Theorem 2). If the arcs of other forms and the values beyond the joint's limits cover this arc, the
form never decides and need not be evaluated. The forms that are left bound the free intervals.

Notes
-----
Rows are in units of the bound of their error (`qbound.boundary.screen`). A row that is left out is
at least `CERTAIN` wherever all others are at least `BELOW`. So every way to evaluate it would find
it positive there. The rounding of the arcs is a billionth of the unit between the two levels.
"""

from __future__ import annotations

import math

import numpy as np

from qbound.arrays import Bools, Floats
from qbound.boundary.monomials import VALUE, Monomials

CERTAIN, BELOW = 2.0, -1.0
"""A row is left out only where it is at least the first; it is so by others that are not below
the second."""

TURN = 2 * math.pi

SEAM = 1e-9
"""Taken off what limits exclude, at both ends, and the least by which an arc carries on, rad."""


def binding(table: Floats, monomials: Monomials, reach: Floats) -> Bools:
    """Tell which rows have to be asked, shape (rows,).

    Parameters
    ----------
    table : ndarray, shape (rows, monomials)
        Each row divided by the bound of its error; feasible is >= 0.
    monomials : Monomials
    reach : ndarray, shape (joints,)
        Absolute values of the joints up to which it is to hold.

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
    """Return the monomials cosine and sine of a joint; None where it has not both."""
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
    """Leave out rows of one joint, the shortest arcs first, that others cover."""
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
    """Tell whether an arc lies within the union of others; where only a seam is open, it does not.

    Each arc carries on once, and the one that holds the start a second time.
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
