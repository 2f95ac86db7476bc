r"""Sectors of one turning joint in which forms are proved positive, or negative, over cells.

A form along the joint is :math:`a \cos x + b \sin x + c = d \cos(x - \theta) + c`: positive on one
sector of the circle, negative on the rest (Theorem 2). Over a cell of the other joints both sectors
shrink: a slab around each root stays undecided. If the slabs are not proved apart, the undecided
part comes from bounds of the form over the whole cell. Not in the paper.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from qbound.arrays import Bools, Floats
from qbound.forms.factors import TURN
from qbound.proofs.exact.numbers import ERROR, cosine_sine

Interval = tuple[Floats, Floats]

MARGIN = 1e-12
"""Taken off every sector for the rounding of its ends and of whole turns, rad."""

ROUNDING = 2.0**-44
"""Taken off every bound for the rounding of the few operations that make it, in parts."""

EVERYWHERE = 1e6
"""Length of a sector that is the whole circle, over and over, rad."""

ROUNDS = 4
"""Of the search for a slab's thickness; what it finds is verified."""


@dataclass(frozen=True, eq=False)
class Sectors:
    """Sectors of each form over each cell; two arrays: at the centre, and all over the cell.

    Attributes
    ----------
    centre : ndarray, shape (k, n - 1)
        Centres of the cells.
    positive, negative : ndarray, shape (2, 2, k, m)
        First and last angle between which the form is proved positive, or negative; rad. A sector
        is empty if the last angle is not greater.
    tilts : ndarray, shape (2, k, m, n - 1)
        How the ends at the rising and the falling root move with the cell's joints.
    everywhere, nowhere : ndarray of bool, shape (k, m)
        Where the form is proved positive, or negative, for every angle.
    slopes : ndarray, shape (k, n - 1)
        How much the undecided forms change across each joint of the cell.
    """

    centre: Floats
    positive: Floats
    negative: Floats
    tilts: Floats
    everywhere: Bools
    nowhere: Bools
    slopes: Floats

    def not_positive(self, which: int) -> Interval:
        """Return where a form may be 0 or less: at the cell's centre (0), or anywhere on it (1)."""
        first, last = self.positive[which]
        some = last > first
        low = np.where(some, last, 0.0) - MARGIN
        high = np.where(some, first + TURN, EVERYWHERE) + MARGIN
        return np.where(self.everywhere, 0.0, low), np.where(self.everywhere, 0.0, high)

    def negative_sector(self, which: int) -> Interval:
        """Return where a form is proved negative: at the cell's centre (0), or all over it (1)."""
        first, last = self.negative[which]
        low = np.where(self.nowhere, 0.0, first + MARGIN)
        high = np.where(self.nowhere, EVERYWHERE, np.maximum(last - MARGIN, low))
        return low, high

    def open_zones(self) -> list[Interval]:
        """Return where a form's sign is left open on some part of the cell."""
        low, high = self.not_positive(1)
        first, last = self.negative_sector(1)
        some, decided = last > first, self.everywhere | self.nowhere
        middle = np.where(some, first, high), np.where(some, last, high)
        zones = [(low, middle[0]), (middle[1], high)]
        return [(np.where(decided, 0.0, a), np.where(decided, 0.0, b)) for a, b in zones]

    def told(self, base: Floats, angle: float) -> tuple[Bools, Bools]:
        """Tell over which cells a configuration is proved feasible, or infeasible, shape (k,)."""
        tilt = np.einsum("skmj,kj->skm", self.tilts, base - self.centre)
        rising, falling = tilt
        inside = _within(angle, self.positive[0, 0] + rising, self.positive[0, 1] + falling)
        outside = _within(angle, self.negative[0, 0] + falling, self.negative[0, 1] + rising)
        good = (self.everywhere | (inside & ~self.nowhere)).all(axis=1)
        bad = (self.nowhere | (outside & ~self.everywhere)).any(axis=1)
        return np.asarray(good & ~bad), np.asarray(bad)


def sectors_of(
    at: Floats,
    slack: Floats,
    curvature: Floats,
    half: Floats,
    base: Sequence[int],
    lift: int,
    centre: Floats,
) -> Sectors:
    """Solve forms along the lift over cells; not in the paper.

    Parameters
    ----------
    at : ndarray, shape (k, m, 1 + n, 3)
        Coefficients of 1, cos x and sin x, of the forms and their slopes at the centres.
    slack : ndarray, shape (m, 1 + n)
        Bounds of the rounding of these coefficients, and of their sums with cosine and sine.
    curvature : ndarray, shape (m, n, n)
        Bounds of the second derivatives over the whole range.
    half, centre : ndarray, shape (k, n - 1)
        Half the width of each cell, rounded up, and its middle.
    base : sequence of int
        The joints of the cells.
    lift : int
        The joint that is solved for.
    """
    wave = _Waves(at, slack, curvature, half, list(base), lift)
    spread = wave.spread()
    everywhere = wave.c - wave.size > spread
    nowhere = wave.c + wave.size < -spread
    positive, negative = wave.bounded(spread)
    tilts = np.zeros((2, *wave.c.shape, len(base)))
    # Slabs are taken where they are proved apart and leave less undecided.
    ok, ends, thick, reach, tilt = wave.slabs(~(everywhere | nowhere))
    open_before = TURN - np.maximum(positive[1] - positive[0], 0)
    open_before -= np.maximum(negative[1] - negative[0], 0)
    ok &= 2 * thick.sum(axis=0) < open_before
    both = [positive, positive], [negative, negative]
    for which, width in enumerate((thick, reach)):
        slab = np.stack([ends[0] + width[0], ends[1] - width[1]])
        rest = np.stack([ends[1] + width[1], ends[0] + TURN - width[0]])
        both[0][which] = np.where(ok, slab, positive)
        both[1][which] = np.where(ok, rest, negative)
    tilts = np.where(ok[..., None], tilt, tilts)
    undecided = ~(everywhere | nowhere)
    slopes = (np.where(undecided[..., None], wave.steepest, 0) * half[:, None]).max(
        axis=1, initial=0
    )
    return Sectors(centre, np.stack(both[0]), np.stack(both[1]), tilts, everywhere, nowhere, slopes)


class _Waves:
    """Forms along the lift over cells, and bounds of these forms."""

    def __init__(
        self,
        at: Floats,
        slack: Floats,
        curvature: Floats,
        half: Floats,
        base: list[int],
        lift: int,
    ) -> None:
        self.half = half
        self.c, self.a, self.b = np.moveaxis(at[:, :, 0], -1, 0)
        self.size = np.hypot(self.a, self.b) * (1 + ROUNDING)
        self.along = at[:, :, 1 + lift]
        self.across = np.stack([at[:, :, 1 + j] for j in base], axis=2)
        self.slack, self.slack_along = slack[:, 0], slack[:, 1 + lift]
        self.slack_across = slack[:, [1 + j for j in base]]
        self.bend = 0.5 * np.einsum("mij,ki,kj->km", curvature[:, base][:, :, base], half, half)
        self.mixed = np.einsum("mj,kj->km", curvature[:, base, lift], half)
        self.bend_along = curvature[:, lift, lift]
        waves = np.hypot(self.across[..., 1], self.across[..., 2])
        self.steepest = np.abs(self.across[..., 0]) + waves + self.slack_across

    def spread(self) -> Floats:
        """Bound how far a form is from its wave at the centre, anywhere on the cell."""
        total = np.einsum("kmj,kj->km", self.steepest, self.half) + self.bend + self.slack
        return np.asarray(total * (1 + ROUNDING) + ROUNDING * (np.abs(self.c) + self.size))

    def bounded(self, spread: Floats) -> tuple[Floats, Floats]:
        """Return the sectors about crest and trough in which the sign holds despite the spread.

        With theta as a double, the wave is size * cos(x - theta) up to a remainder.
        """
        theta = np.arctan2(self.b, self.a)
        cosine, sine = cosine_sine(theta)
        over = np.abs(self.size * cosine - self.a) + np.abs(self.size * sine - self.b)
        over = over * (1 + ROUNDING) + 4 * ERROR * self.size
        above_all, below_all = spread - self.c + over, -spread - self.c - over
        crest = self._arc(above_all)
        trough = self._arc(below_all, -1.0)
        positive = np.stack([theta - crest, theta + crest])
        negative = np.stack([theta + trough, theta + TURN - trough])
        some = [crest > 0, trough < np.pi]
        return np.where(some[0], positive, theta), np.where(some[1], negative, theta + np.pi)

    def _arc(self, level: Floats, sign: float = 1.0) -> Floats:
        """Return an angle from the crest at which size * cos is proved above a level, or below."""
        size = np.where(self.size > 0, self.size, 1.0)
        aim = np.clip(level / size + sign * 8 * ERROR, -1.0, 1.0)
        angle = np.arccos(aim)
        value = self.size * (cosine_sine(angle)[0] - sign * 2 * ERROR)
        proved = value > level if sign > 0 else value < level
        return np.where(proved, angle, 0.0 if sign > 0 else np.pi)

    def slabs(self, wanted: Bools) -> tuple[Bools, Floats, Floats, Floats, Floats]:
        """Return where both roots have slabs of their own, and these.

        The slabs have a middle, half the thickness, and half of the extent over the cell, shape (2,
        k, m), rising root first; and a tilt, shape (2, k, m, n - 1).
        """
        ratio = np.divide(-self.c, self.size, out=np.full_like(self.c, 2.0), where=self.size > 0)
        wanted = wanted & (np.abs(ratio) < 1)
        theta, alpha = np.arctan2(self.b, self.a), np.arccos(np.clip(ratio, -1, 1))
        ends = np.stack([theta - alpha, theta + alpha])
        cosine, sine = cosine_sine(ends)
        value = np.abs(self.c + self.a * cosine + self.b * sine)
        slope = self._at(self.along[None], cosine, sine)
        across = self._at(self.across[None], cosine[..., None], sine[..., None])
        steep = np.where(slope == 0, 1.0, slope)
        tilt = -across / steep[..., None]
        thick, reach, proved = self._thickness(value, slope, across, tilt)
        apart = (ends[0] + reach[0] + MARGIN < ends[1] - reach[1] - MARGIN) & (
            ends[1] + reach[1] + MARGIN < ends[0] + TURN - reach[0] - MARGIN
        )
        ok = wanted & proved.all(axis=0) & (slope[0] > 0) & (slope[1] < 0) & apart
        return (
            ok,
            ends,
            np.where(ok, thick, 0),
            np.where(ok, reach, 0),
            np.where(ok[..., None], tilt, 0),
        )

    @staticmethod
    def _at(rows: Floats, cosine: Floats, sine: Floats) -> Floats:
        return np.asarray(rows[..., 0] + rows[..., 1] * cosine + rows[..., 2] * sine)

    def _thickness(
        self, value: Floats, slope: Floats, across: Floats, tilt: Floats
    ) -> tuple[Floats, Floats, Bools]:
        """Return half thicknesses at which the form is proved to have changed its sign.

        By Taylor's formula: on a face of the slab, the slope along the lift times the thickness
        exceeds the rest of the value and of the slopes across, all rounding, and the bending.
        """
        size, h = np.abs(slope), self.half[None, :, None]
        lean = (np.abs(tilt) * h).sum(axis=-1) * (1 + ROUNDING)
        left = np.abs(across + slope[..., None] * tilt) + self.slack_across
        left = left + ROUNDING * (np.abs(across) + self.slack_along[:, None] * np.abs(tilt))
        fixed = value + self.slack + (left * h).sum(axis=-1) + self.bend

        def needed(thick: Floats) -> tuple[Floats, Floats]:
            reach = lean + thick
            bend = reach * (self.slack_along + self.mixed + 0.5 * self.bend_along * reach)
            return (fixed + bend) * (1 + ROUNDING), reach

        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            thick = np.zeros_like(value)
            for _ in range(ROUNDS):
                thick = 1.02 * needed(thick)[0] / size
            least, reach = needed(thick)
            proved = size * thick * (1 - ROUNDING) > least
        return thick, reach * (1 + ROUNDING), np.asarray(proved & np.isfinite(reach))


def pieces(low: Floats, high: Floats, first: float, last: float) -> Interval:
    """Return the parts of sectors in a joint's range, shape (k, pieces) each; empty as 0 to 0."""
    begin = low - TURN * np.floor((low - first) / TURN)
    end = begin + (high - low)
    found = []
    for turn in range(-1, max(1, int(np.ceil((last - first) / TURN)))):
        a = np.clip(begin + TURN * turn, first, last)
        b = np.clip(end + TURN * turn, first, last)
        found.append((np.where(b > a, a, first), np.where(b > a, b, first)))
    return (
        np.concatenate([a for a, _ in found], axis=1),
        np.concatenate([b for _, b in found], axis=1),
    )


def covered(low: Floats, high: Floats) -> Floats:
    """Return the length of the union of intervals, row by row."""
    order = np.argsort(low, axis=1)
    low, high = np.take_along_axis(low, order, axis=1), np.take_along_axis(high, order, axis=1)
    before = np.maximum.accumulate(high, axis=1)
    start = low.copy()
    start[:, 1:] = np.maximum(low[:, 1:], before[:, :-1])
    return np.asarray(np.maximum(high - start, 0.0).sum(axis=1))


def hidden(low: Floats, high: Floats, first: Floats, last: Floats) -> Bools:
    """Tell which intervals lie within one of some other intervals, row by row."""
    inside = (first[:, None] <= low[..., None]) & (high[..., None] <= last[:, None])
    return np.asarray(inside.any(axis=-1))


def _within(angle: float, low: Floats, high: Floats) -> Bools:
    """Tell whether an angle, on any turn, lies within sectors, with a margin."""
    place: Any = np.mod(angle - low, TURN)
    return np.asarray((place > MARGIN) & (place < high - low - MARGIN))
