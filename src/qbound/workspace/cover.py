"""Intervals laid over each other on a circle or a line, for many circles at once.

The ends of all intervals cut the circle into pieces; an interval holds a piece or it does not. The
lengths of unions and intersections are sums over pieces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Bools, Floats
from qbound.tolerances import NEGLIGIBLE, TOUCH

UNSAFE: Final = -1
"""In place of an aspect: configurations that are in none."""


class Interval(NamedTuple):
    """Places along n circles or lines that one posture reaches.

    Attributes
    ----------
    side : int
        Sign of det J.
    aspect : int
        Index of the aspect on that side that reaches them safely, or `UNSAFE`.
    low, high : ndarray, shape (n,)
        Ends, angle or length; continuous from one circle to the next.
    """

    side: int
    aspect: int
    low: Floats
    high: Floats


@dataclass(frozen=True, eq=False)
class Cover:
    """Pieces of n circles or lines, and the intervals that hold them.

    Attributes
    ----------
    start : ndarray, shape (n,)
        Place from which the ends are counted.
    ends : ndarray, shape (e + 1, n)
        Ends of the pieces, ascending.
    inside : ndarray of bool, shape (k, e, n)
        Which of the k intervals hold each piece.
    width : ndarray, shape (k, n)
        Of each interval; more than a full turn where it overlaps itself.
    side, aspect : ndarray of int, shape (k,)
        Of each interval.
    """

    start: Floats
    ends: Floats
    inside: Bools
    width: Floats
    side: NDArray[np.int64]
    aspect: NDArray[np.int64]

    @property
    def safe(self) -> Bools:
        """Tell which intervals are safe, shape (k,)."""
        return np.asarray(self.aspect != UNSAFE)

    def by(self, side: int, aspect: int | None = None) -> Bools:
        """Tell which intervals have one sign of det J, and belong to one aspect or to any."""
        of_aspect = self.safe if aspect is None else self.aspect == aspect
        return np.asarray(of_aspect & (self.side == side))

    def held(self, chosen: Bools) -> Bools:
        """Tell which pieces any of some intervals holds, shape (e, n)."""
        return np.asarray(self.inside[chosen].any(axis=0))

    def length(self, pieces: Bools) -> Floats:
        """Add up the lengths of some pieces, shape (n,)."""
        return np.asarray((np.diff(self.ends, axis=0) * pieces).sum(axis=0))

    def reached(self, chosen: Bools) -> Floats:
        """Return the length of the union of some intervals, shape (n,)."""
        return self.length(self.held(chosen))

    def swept(self, chosen: Bools) -> Floats:
        """Return the sum of the widths of some intervals, full turns included, shape (n,)."""
        return np.asarray(self.width[chosen].sum(axis=0))


def cover(intervals: Sequence[Interval], n: int, period: float | None) -> Cover:
    """Lay intervals over each other on n circles of a period, or on n lines (None).

    The order of ends may be different at the first circle and the last only if they coincide.
    """
    # What has no width has no end either: a fibre that is a whole circle leaves such a gap.
    kept = [i for i in intervals if (i.high - i.low).max() > NEGLIGIBLE]
    if not kept:
        nothing = np.zeros(0, dtype=np.int64)
        none = np.zeros((0, n))
        return Cover(np.zeros(n), np.zeros((1, n)), np.zeros((0, 0, n), bool), none, *2 * [nothing])
    side, aspect = (
        np.array(column) for column in zip(*((i.side, i.aspect) for i in kept), strict=True)
    )
    low, high = np.array([i.low for i in kept]), np.array([i.high for i in kept])
    laid = _on_lines(low, high) if period is None else _on_circles(low, high, period)
    return Cover(*laid, np.maximum(high - low, 0), side, aspect)


def _on_lines(low: Floats, high: Floats) -> tuple[Floats, Floats, Bools]:
    """Return start, ends and which interval holds which piece."""
    ends = np.sort(np.concatenate([low, high]), axis=0)
    middles = (ends[:-1] + ends[1:]) / 2
    inside = (low[:, None] < middles) & (middles < high[:, None])
    return np.zeros(low.shape[1]), ends, inside


def _on_circles(low: Floats, high: Floats, period: float) -> tuple[Floats, Floats, Bools]:
    """Return start, ends and which interval holds which piece.

    The circle is cut at an end of an interval, so that no other end moves across the cut; an
    interval that is the whole circle has no end.
    """
    width = np.maximum(high - low, 0)
    whole = width[:, low.shape[1] // 2] >= period - TOUCH
    start = low[int(whole.argmin())]
    low = np.where(whole[:, None], 0, _first_turn(low - start, period))
    high = low + np.where(whole[:, None], period, width)
    around = np.array([np.zeros_like(start), np.full_like(start, period)])
    ends = np.sort(np.concatenate([low, _first_turn(high, period), around]), axis=0)
    middles = (ends[:-1] + ends[1:]) / 2
    inside = (low[:, None] < middles) & (middles < high[:, None])
    return start, ends, inside | (middles + period < high[:, None])


def _first_turn(ends: Floats, period: float) -> Floats:
    """Shift ends by full turns, continuous along n, to where their middle is in the first turn.

    An end that coincides with the cut stays beside it, on whichever side rounding puts it.
    """
    ends = np.unwrap(ends, axis=1, period=period)
    middle = ends[:, [ends.shape[1] // 2]]
    return np.asarray(ends - period * np.floor((middle + TOUCH) / period))
