"""What an arm covers on each circle or line along which its first joint moves the tool.

A distance u of the second joint from the singularity names the circle (`planar`). On it the safe
places of one posture are the fibre of the region, moved along by the phase of the tool; what is
between them is reached, too, but not safely. Laid over each other, the intervals of all postures
tell how long a part of the circle is reached in one posture, in both, safely or not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property, partial
from itertools import pairwise

import numpy as np

from qbound.arrays import Floats
from qbound.forms.angles import nearest_turn
from qbound.forms.harmonic import HarmonicForm
from qbound.region import Problem
from qbound.region.outline import NODES, converged, legendre
from qbound.tolerances import CHORD, NEGLIGIBLE, QUADRATURE, SAME_CRITICAL
from qbound.workspace.cover import UNSAFE, Cover, Interval, cover
from qbound.workspace.fibres import Fibres
from qbound.workspace.image_crossings import crossing_distances
from qbound.workspace.planar import NoPlanarWorkspaceError, PlanarArm, Range, turns_within

Ranges = tuple[Range, Range]
Slab = tuple[float, float]
Measure = Callable[[Cover], Floats]

MEETING = 1e-3
"""Ends that are no nearer than this, in rad or beside the largest, do not meet there."""

MOST_BOUNDING = 300
"""Forms on the region's boundary above which no workspace is computed: each two cost 0.2 ms."""


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
        u = self.arm.distance_to_singularity(np.concatenate([*lines, self.square[1] or ()]))
        if self.arm.singularity is not None:
            farthest = math.pi if self.arm.kinds[1] == "revolute" else float(u.max())
            u = _apart(np.concatenate([u, [0, farthest]]))
            problem = next(iter(self.sides.values())).problem
            ends = {*(problem.ranges[0] or ()), *(self.square[0] or ())}
            forms = self._bounding(problem)
            crossing = crossing_distances(self.arm, forms, sorted(ends), farthest)
            u = np.concatenate([u, *self._met(u, np.sort(crossing))])
        return _apart(u)

    def _bounding(self, problem: Problem) -> HarmonicForm:
        """Return the forms, of boundaries and of features of bodies, that end any interval.

        Raises
        ------
        NoPlanarWorkspaceError
            If they are more than `MOST_BOUNDING`.
        """
        forms, features = set[int](), set[int]()
        for part in self.sides.values():
            kept = () if part.inner is None else part.inner.names
            for cell in part.cells.cells:
                for row in (cell.lower.form, cell.upper.form):
                    if row >= len(kept):
                        features.add(row - len(kept))
                    elif row >= 0:
                        forms.add(problem.names.index(kept[row]))
        if len(forms) + len(features) > MOST_BOUNDING:
            raise NoPlanarWorkspaceError(
                f"the workspace is not computed: {len(forms) + len(features)} boundaries bound the"
                f" region, and any two may cross; {MOST_BOUNDING} are the most"
            )
        tables = problem.forms.coefficients[sorted(forms)], problem.contacts.forms[sorted(features)]
        return HarmonicForm(np.concatenate(tables), problem.forms.kinds)

    def _met(self, lines: Floats, crossing: Floats) -> Iterator[Floats]:
        """Yield of the distances of possible crossings those at which ends of both postures meet.

        Two boundaries may cross where neither ends an interval; that costs a slab for nothing.
        """
        for near, far in pairwise(lines.tolist()):
            u = crossing[(near < crossing) & (crossing < far)]
            found = list(self._intervals(u, (near + far) / 2)) if len(u) else []
            one, other = (
                np.array([end for i in found if i.side == side for end in (i.low, i.high)])
                for side in (1, -1)
            )
            if len(one) and len(other):
                gaps = one[:, None] - other
                period = self.arm.period
                size = 1.0 if period else max(np.abs(one).max(), np.abs(other).max())
                gaps = nearest_turn(gaps, 0) if period else gaps
                yield u[(np.abs(gaps) < MEETING * size).any(axis=(0, 1))]

    def areas(self, *measures: Measure) -> list[float]:
        """Integrate lengths on every circle or line over the plane; length squared each.

        The element of area is abs(det J) du times the element of angle (or length) along.
        """

        def density(u: Floats, slab: Slab) -> Floats:
            laid = self.cover(u, slab)
            return np.asarray(
                self.arm.abs_det_jacobian(u) * [measure(laid) for measure in measures]
            )

        slabs = pairwise(self.distances.tolist())
        sums = [cache(partial(_quadrature, density, slab)) for slab in slabs]
        rough = np.array([over(NODES[0]) for over in sums])
        smallest = QUADRATURE * float(np.abs(rough).sum(axis=0).max(initial=0))
        fine = [converged(over, smallest) for over in sums]
        return [float(value) for value in np.sum(fine, axis=0)]

    def cover(self, u: Floats, slab: Slab) -> Cover:
        """Lay all intervals over each other, for values of u within a slab."""
        return cover(list(self._intervals(u, sum(slab) / 2)), len(u), self.arm.period)

    def patches(self, n: int = 33) -> Iterator[tuple[int, Floats]]:
        """Yield pieces of the plane: safe postures, 1 or 2, and the outline, shape (m, 2).

        The outline runs along a boundary, along a circle, and back; its points are exact.
        """
        angle = np.linspace(-math.pi / 2, math.pi / 2, n)
        step = CHORD if self.arm.period else math.inf
        for near, far in pairwise(self.distances.tolist()):
            u = (near + far) / 2 + (far - near) / 2 * np.sin(angle)
            laid = self.cover(u, (near, far))
            held = [laid.held(laid.by(side)) for side in self.sides]
            postures = np.sum(held, axis=0)[:, n // 2]
            q2, along = self.arm.second(self.arm.sides[0], u), laid.start + laid.ends
            wide = np.diff(laid.ends, axis=0).max(axis=1) > NEGLIGIBLE  # not rounding alone
            for k in np.flatnonzero(wide & (postures > 0)):
                low, high = along[k], along[k + 1]
                far_side = np.arange(low[-1], high[-1], step)
                near_side = np.arange(high[0], low[0], -step)
                walk = [low, far_side, high[::-1], near_side]
                at = np.repeat([q2[-1], q2[0]], [len(far_side), len(near_side)])
                at = np.concatenate([q2, at[: len(far_side)], q2[::-1], at[len(far_side) :]])
                yield int(postures[k]), self.arm.place(at, np.concatenate(walk))

    def _intervals(self, u: Floats, middle: float) -> Iterator[Interval]:
        """Yield every interval along the circle or line of u; `middle` is a u of the same slab."""
        for side, part in self.sides.items():
            q2 = self.arm.second(side, u)
            along = self.arm.phase(q2)
            for turned in self._turned(float(self.arm.second(side, middle)), part):
                shift = turned - float(self.arm.second(side, middle))
                fibre = self._fibre(side, q2 + shift, turned)
                for i in [*fibre, *self._gaps(side, fibre, np.zeros_like(u))]:
                    yield i._replace(low=i.low + along, high=i.high + along)

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
        ends = zip(*part.intervals(kept, q2 - shift), strict=True) if kept else ()
        return [Interval(side, part.owner[k], *pair) for k, pair in zip(kept, ends, strict=True)]

    def _gaps(self, side: int, fibre: list[Interval], zero: Floats) -> Iterator[Interval]:
        """Yield what a fibre leaves of the first joint's square, around the circle if it turns."""
        limits = self.square[0]
        if limits is not None:
            first, last = zero + limits[0], zero + limits[1]
        elif fibre:
            first, last = fibre[0].high, fibre[0].low + math.tau
            fibre = fibre[1:]
        else:
            first, last = zero, zero + math.tau
        starts, stops = [first, *(i.high for i in fibre)], [*(i.low for i in fibre), last]
        for start, stop in zip(starts, stops, strict=True):
            yield Interval(side, UNSAFE, start, stop)


def _apart(u: Floats) -> Floats:
    """Return values ascending, without those that are the same but for rounding."""
    u = np.sort(u)
    return np.asarray(u[np.diff(u, prepend=-np.inf) > SAME_CRITICAL])


def _quadrature(density: Callable[[Floats, Slab], Floats], slab: Slab, n: int) -> Floats:
    """Integrate over a slab with u = m + h sin(angle): a square root at its ends is smooth then."""
    nodes, weights = legendre(n)
    angle = nodes * math.pi / 2
    middle, half = sum(slab) / 2, (slab[1] - slab[0]) / 2
    weights = weights * math.pi / 2 * half * np.cos(angle)
    return np.asarray(density(middle + half * np.sin(angle), slab) @ weights)
