"""What an arm covers on each circle or line along which its first joint moves the tool.

A distance u of the second joint from the fold names the circle (`qbound.planar`). On it the safe
places of one posture are the fibre of the region, moved along by the phase of the tool; what is
between them is reached, too, but not safely. Laid over each other, the intervals of all postures
tell how long a part of the circle is reached in one posture, in both, safely or not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from qbound.arcs import NODES, legendre
from qbound.fibres import Fibres
from qbound.image_crossings import crossing_distances
from qbound.planar import PlanarArm, Range, turns_within
from qbound.tolerances import NEGLIGIBLE, QUADRATURE, SAME_CRITICAL, TOUCH

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ranges = tuple[Range, Range]
CHORD = 0.04
"""Angle between points of a circle in an outline: the chord leaves it by 2e-4 of the radius."""

Slab = tuple[float, float]
Interval = tuple[Floats, Floats]


@dataclass(frozen=True, eq=False)
class Cover:
    """Pieces of a circle or line, for n values of u, and the intervals that hold them.

    Attributes
    ----------
    ends : ndarray, shape (e + 1, n)
        Ends of the pieces, ascending.
    inside : ndarray of bool, shape (k, e, n)
        Which of the k intervals hold each piece.
    width : ndarray, shape (k, n)
        Of each interval; more than a full turn where it overlaps itself.
    side : ndarray of int, shape (k,)
        Sign of det J of each interval.
    safe : ndarray of bool, shape (k,)
    """

    ends: Floats
    inside: Bools
    width: Floats
    side: NDArray[np.int64]
    safe: Bools

    def held(self, chosen: Bools) -> Bools:
        """Tell which pieces any of some intervals holds, shape (e, n)."""
        return np.asarray(self.inside[chosen].any(axis=0))

    def reached(self) -> Bools:
        """Tell which pieces are reached safely."""
        return self.held(self.safe)

    def on_side(self, side: int) -> Bools:
        """Tell which pieces are reached safely with one sign of det J."""
        return self.held(self.safe & (self.side == side))

    def twice(self) -> Bools:
        """Tell which pieces are reached safely in both postures."""
        return self.on_side(1) & self.on_side(-1)

    def mixed(self) -> Bools:
        """Tell which pieces are reached both safely and not."""
        return self.reached() & self.held(~self.safe)

    def length(self, pieces: Bools) -> Floats:
        """Add up the lengths of some pieces, shape (n,): angles on a circle."""
        return np.asarray((np.diff(self.ends, axis=0) * pieces).sum(axis=0))

    def swept(self) -> Floats:
        """Add up the widths of the safe intervals, full turns included, shape (n,)."""
        return np.asarray(self.width[self.safe].sum(axis=0))


Measure = Callable[[Cover], Floats]


@dataclass(frozen=True, eq=False)
class Layers:
    """The intervals of every posture on every circle or line.

    Attributes
    ----------
    arm : PlanarArm
    sides : dict of int to Fibres
        The region where det J has a sign, for each of its signs.
    kept : dict of int to frozenset of int
        The components of these regions that count as safe.
    square : pair of (low, high) or None
        Configurations outside it do not exist; None is one full turn.
    """

    arm: PlanarArm
    sides: dict[int, Fibres]
    kept: dict[int, frozenset[int]]
    square: Ranges

    @cached_property
    def distances(self) -> Floats:
        """Values of u between which every length is analytic, ascending."""
        lines = [part.lines for part in self.sides.values()]
        u = self.arm.unfold(np.concatenate([*lines, self.square[1] or ()]))
        if self.arm.fold is not None:
            farthest = math.pi if self.arm.kinds[1] == "revolute" else float(u.max())
            problem = next(iter(self.sides.values())).problem
            u = np.concatenate([u, crossing_distances(self.arm, problem, farthest), [0, farthest]])
        u = np.sort(u)
        return np.asarray(u[np.diff(u, prepend=-np.inf) > SAME_CRITICAL])

    def areas(self, *measures: Measure) -> list[float]:
        """Integrate lengths on every circle or line over the plane; length squared each.

        The element of area is abs(det J) du times the element of angle (or length) along.
        """

        def density(u: Floats, slab: Slab) -> Floats:
            cover = self.cover(u, slab)[1]
            return np.asarray(self.arm.speed(u) * [measure(cover) for measure in measures])

        slabs = list(pairwise(self.distances.tolist()))
        rough = np.array([_quadrature(density, slab, NODES[0]) for slab in slabs])
        smallest = QUADRATURE * float(np.abs(rough).sum(axis=0).max(initial=0))
        fine = [_converged(density, *pair, smallest) for pair in zip(slabs, rough, strict=True)]
        return [float(value) for value in np.sum(fine, axis=0)]

    def cover(self, u: Floats, slab: Slab) -> tuple[Floats, Cover]:
        """Lay all intervals over each other, for values of u within a slab.

        Returns
        -------
        start : ndarray, shape (n,)
            Place along the circle or line from which the ends are counted: an end itself, so that
            on a circle no piece is cut anywhere else.
        cover : Cover
        """
        # What has no width has no end either: a fibre that is a whole circle leaves such a gap.
        pieces = [p for p in self._intervals(u, sum(slab) / 2) if (p[3] - p[2]).max() > NEGLIGIBLE]
        if not pieces:
            return u, Cover(
                u[None],
                np.zeros((0, 0, len(u)), bool),
                np.zeros((0, len(u))),
                np.zeros(0, int),
                np.zeros(0, bool),
            )
        side, safe = np.array([p[0] for p in pieces]), np.array([p[1] for p in pieces])
        low, high = np.array([p[2] for p in pieces]), np.array([p[3] for p in pieces])
        width, period = np.maximum(high - low, 0), self.arm.period
        start, span = low[0], width
        if period is not None:
            whole = width[:, len(u) // 2] >= period - TOUCH
            start = low[int(whole.argmin())]
            low = np.where(whole[:, None], 0, _first_turn(low - start, period))
            span = np.where(whole[:, None], period, width)
        else:
            low = low - start
        high = low + span
        ends = np.concatenate([low, high])
        if period is not None:
            around = np.array([np.zeros_like(u), np.full_like(u, period)])
            ends = np.concatenate([low, _first_turn(high, period), around])
        ends = np.sort(ends, axis=0)
        middles = (ends[:-1] + ends[1:]) / 2
        inside = (low[:, None] < middles) & (middles < high[:, None])
        if period is not None:
            inside |= middles + period < high[:, None]
        return start, Cover(ends, inside, width, side, safe)

    def patches(self, n: int = 33) -> Iterator[tuple[int, Floats]]:
        """Yield pieces of the plane: safe postures, 1 or 2, and the outline, shape (m, 2).

        The outline runs along a boundary, along a circle, and back; its points are exact.
        """
        angle = np.linspace(-math.pi / 2, math.pi / 2, n)
        step = CHORD if self.arm.period else math.inf
        for near, far in pairwise(self.distances.tolist()):
            u = (near + far) / 2 + (far - near) / 2 * np.sin(angle)
            start, cover = self.cover(u, (near, far))
            postures = np.sum([cover.on_side(side) for side in self.sides], axis=0)[:, n // 2]
            q2, along = self.arm.second(self.arm.sides[0], u), start + cover.ends
            for k in np.flatnonzero(postures):
                low, high = along[k], along[k + 1]
                far_side = np.arange(low[-1], high[-1], step)
                near_side = np.arange(high[0], low[0], -step)
                walk = [low, far_side, high[::-1], near_side]
                at = np.repeat([q2[-1], q2[0]], [len(far_side), len(near_side)])
                at = np.concatenate([q2, at[: len(far_side)], q2[::-1], at[len(far_side) :]])
                yield int(postures[k]), self.arm.place(at, np.concatenate(walk))

    def _intervals(self, u: Floats, middle: float) -> Iterator[tuple[int, bool, Floats, Floats]]:
        """Yield side, safety and both ends of every interval along the circle or line."""
        for side, part in self.sides.items():
            q2 = self.arm.second(side, u)
            along = self.arm.phase(q2)
            for turned in self._turned(float(self.arm.second(side, middle)), part):
                shift = turned - float(self.arm.second(side, middle))
                fibre = self._fibre(side, q2 + shift, turned)
                for low, high in fibre:
                    yield side, True, low + along, high + along
                for low, high in self._gaps(fibre, np.zeros_like(u)):
                    yield side, False, low + along, high + along

    def _turned(self, q2: float, part: Fibres) -> list[float]:
        """Return q2 with all its full turns that are in the square."""
        kind, inner = self.arm.kinds[1], part.problem.ranges[1]
        if self.square[1] is not None or kind == "prismatic":
            return turns_within(kind, q2, self.square[1])
        return turns_within(kind, q2, inner) or [q2]

    def _fibre(self, side: int, q2: Floats, middle: float) -> list[Interval]:
        """Return the kept intervals of the first joint over values of the second, ascending."""
        part = self.sides[side]
        shift, cells = part.over(middle)
        kept = [k for k in cells if part.owner[k] in self.kept[side]]
        return list(zip(*part.intervals(kept, q2 - shift), strict=True)) if kept else []

    def _gaps(self, fibre: list[Interval], zero: Floats) -> Iterator[Interval]:
        """Yield what a fibre leaves of the first joint's square, around the circle if it turns."""
        limits = self.square[0]
        if limits is not None:
            first, last = zero + limits[0], zero + limits[1]
        elif fibre:
            first, last = fibre[0][1], fibre[0][0] + math.tau
            fibre = fibre[1:]
        else:
            first, last = zero, zero + math.tau
        starts = [first, *(high for _, high in fibre)]
        stops = [*(low for low, _ in fibre), last]
        yield from zip(starts, stops, strict=True)


def _first_turn(ends: Floats, period: float) -> Floats:
    """Shift ends by full turns, continuous along u, to where their middle is in the first turn.

    An end that coincides with the start stays beside it, on whichever side rounding puts it.
    """
    ends = np.unwrap(ends, axis=1, period=period)
    middle = ends[:, [ends.shape[1] // 2]]
    return np.asarray(ends - period * np.floor((middle + TOUCH) / period))


def _quadrature(density: Callable[[Floats, Slab], Floats], slab: Slab, n: int) -> Floats:
    """Integrate over a slab with u = m + h sin(angle): a square root at its ends is smooth then."""
    nodes, weights = legendre(n)
    angle = nodes * math.pi / 2
    middle, half = sum(slab) / 2, (slab[1] - slab[0]) / 2
    weights = weights * math.pi / 2 * half * np.cos(angle)
    return np.asarray(density(middle + half * np.sin(angle), slab) @ weights)


def _converged(
    density: Callable[[Floats, Slab], Floats], slab: Slab, before: Floats, smallest: float
) -> Floats:
    """Double the nodes until the integrals change by no more than `smallest`."""
    for n in NODES[1:]:
        now = _quadrature(density, slab, n)
        if np.abs(now - before).max() <= smallest:
            break
        before = now
    return now
