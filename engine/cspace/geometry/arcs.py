"""Gaps between intervals, row by row, on a line or round a circle.

Arrays hold thousands of rows. Intervals are open and gaps are closed. A single place between two
intervals that touch does not count as a gap.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, tau
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats, Indices

NONE = -1
"""Stands for an interval where a gap ends at an end of the range, or nowhere."""


class Intervals(NamedTuple):
    """Intervals in rows; each field has shape (m,).

    Attributes
    ----------
    row : ndarray of int
    low, high : ndarray
        Infinite where an interval has no end.
    """

    row: Indices
    low: Floats
    high: Floats


class Gaps(NamedTuple):
    """The gaps that intervals leave, by rows and ascending in each row; each field has shape (m,).

    Attributes
    ----------
    row : ndarray of int
    low, high : ndarray
    below, above : ndarray of int
        The intervals that end a gap, or `NONE`.
    """

    row: Indices
    low: Floats
    high: Floats
    below: Indices
    above: Indices


def on_line(taken: Intervals, rows: int, span: float) -> Gaps:
    """Return the gaps that intervals leave of [0, span] in each row."""
    row = np.concatenate([taken.row, np.arange(rows)])
    low = np.concatenate([taken.low, np.full(rows, span)])  # one more at the end of each row
    high = np.concatenate([taken.high, np.full(rows, np.inf)])
    gaps = _between(Intervals(row, low, high), np.zeros(rows))
    number = len(taken.row)
    return gaps._replace(
        below=np.where(gaps.low > 0, gaps.below, NONE),
        above=np.where(gaps.above < number, gaps.above, NONE),
    )


def on_circle(taken: Intervals, rows: int, span: float | None) -> Gaps:
    """Return the gaps that intervals modulo a full turn leave of [0, span], or of the whole circle.

    Parameters
    ----------
    taken : Intervals
        Shorter than a turn; or without an upper end: such an interval fills the row.
    span : float or None
        It may be longer than a turn. None means the whole circle; a gap then begins within [0, 2
        pi) and may end beyond, and a row without intervals has the gap [0, 2 pi].
    """
    endless = np.isinf(taken.high)
    low = np.where(endless, 0.0, taken.low)
    high = np.where(endless, np.inf, taken.high - low)
    low = np.mod(low, tau)
    high += low
    last = np.full(rows, -np.inf)
    np.maximum.at(last, taken.row, high)
    gaps = _between(Intervals(taken.row, low, high), last - tau)
    if span is None:
        turned = _sorted(_moved(gaps, np.where(gaps.low < 0, tau, 0.0)))
        return _sorted(_joined([turned, _free(last, tau)]))
    copies = [_clipped(_moved(gaps, tau * m), span) for m in range(ceil(span / tau) + 1)]
    return _sorted(_joined([*copies, _free(last, span)]))


def _between(taken: Intervals, first: Floats) -> Gaps:
    """Return the gaps below each interval's start, above all that start before, and `first`.

    `first` is the highest end of each row, one turn back; its interval ends the row's first gap.
    """
    n, order = len(taken.row), np.lexsort((taken.low, taken.row))
    row, low, high = taken.row[order], taken.low[order], taken.high[order]
    by_end = np.argsort(high, kind="stable")
    rank = np.empty(n, dtype=np.intp)
    rank[by_end] = np.arange(n)
    highest = by_end[np.maximum.accumulate(row * n + rank) - row * n]  # of the row, so far
    begins, ends = np.ones((2, n), dtype=np.bool_)
    begins[1:] = ends[:-1] = row[1:] != row[:-1]
    before = np.empty(n, dtype=np.intp)
    before[1:] = highest[:-1]
    before[begins] = highest[ends]
    edge = np.where(begins, -np.inf, high[before])
    around = first[row] >= edge
    edge = np.where(around, first[row], edge)
    below = np.where(around, highest[ends][np.cumsum(begins) - 1], before)
    kept = edge < low
    return Gaps(row[kept], edge[kept], low[kept], order[below[kept]], order[kept])


def _free(last: Floats, span: float) -> Gaps:
    """Return the whole range for each row without intervals."""
    row = np.flatnonzero(last == -np.inf)
    none = np.full(len(row), NONE)
    return Gaps(row, np.zeros(len(row)), np.full(len(row), span), none, none)


def _moved(gaps: Gaps, by: Floats | float) -> Gaps:
    return gaps._replace(low=gaps.low + by, high=gaps.high + by)


def _clipped(gaps: Gaps, span: float) -> Gaps:
    """Return the parts of gaps in [0, span]; an end that is cut has no interval."""
    low, high = np.maximum(gaps.low, 0), np.minimum(gaps.high, span)
    below = np.where(gaps.low < 0, NONE, gaps.below)
    above = np.where(gaps.high > span, NONE, gaps.above)
    return _chosen(Gaps(gaps.row, low, high, below, above), np.flatnonzero(low < high))


def _joined(many: list[Gaps]) -> Gaps:
    row, low, high, below, above = (np.concatenate(each) for each in zip(*many, strict=True))
    return Gaps(row, low, high, below, above)


def _sorted(gaps: Gaps) -> Gaps:
    return _chosen(gaps, np.lexsort((gaps.low, gaps.row)))


def _chosen(gaps: Gaps, which: Indices) -> Gaps:
    row, low, high, below, above = gaps
    return Gaps(row[which], low[which], high[which], below[which], above[which])


# --- bisection ------------------------------------------------------------------------------------


HALVINGS = 52
"""So many halvings leave an interval no wider than the rounding of its length."""


def last_before(
    holds: Callable[[Floats], NDArray[np.bool_]], low: ArrayLike, high: ArrayLike
) -> tuple[Floats, Floats]:
    """Bisect intervals at whose low end a condition holds and at whose high end it does not.

    Parameters
    ----------
    holds : callable
        Places, shape (k,), to bool, shape (k,).
    low, high : array_like, shape (k,)

    Returns
    -------
    low, high : ndarray, shape (k,)
        Neighbouring numbers just before and just behind a change.
    """
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    for _ in range(HALVINGS if len(low) else 0):
        middle = (low + high) / 2
        before = holds(middle)
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return low, high
