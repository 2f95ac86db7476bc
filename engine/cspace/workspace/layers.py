"""The feasible values of the first joint, laid over each other on the circles or lines of the tool.

The region is a set of intervals of the first joint, one for each value of the second: its fibres.
The first joint moves the tool along a circle or a line, so each fibre covers intervals of it. The
ends of all intervals cut the circle into pieces; an interval holds a piece or it does not. The
lengths of unions and intersections are sums over pieces. Their order changes only at critical
distances from the singularity, among them the crossings of the images of two postures' boundaries.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from itertools import pairwise
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev, polynomial
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Bools, Complexes, Floats
from cspace.region import Problem, Region, UnresolvedError, solve
from cspace.region.algebra import HIGH, LOW
from cspace.region.arcs import NODES, converged, legendre
from cspace.tolerances import CHORD, NEAR_CIRCLE, NEGLIGIBLE, QUADRATURE, SAME_CRITICAL, TOUCH
from cspace.workspace.planar import NoPlanarWorkspaceError, PlanarArm, Range, values_within
from qbound.circle import TURN, nearest_turn
from qbound.forms import HarmonicForm, basis

UNSAFE: Final = -1
"""In place of an aspect: configurations that are in none."""


class Interval(NamedTuple):
    """Places along n circles or lines that one posture reaches.

    Attributes
    ----------
    side : int
        Sign of det J.
    aspect : int
        Index of the aspect on that side that reaches the places in a feasible posture, or `UNSAFE`.
    low, high : ndarray, shape (n,)
        Ends, angle or length; continuous from one circle to the next.
    """

    side: int
    aspect: int
    low: Floats
    high: Floats


@dataclass(frozen=True, eq=False)
class Cover:
    """n circles or lines cut into pieces, and which intervals hold each piece.

    Attributes
    ----------
    start : ndarray, shape (n,)
        Place on each circle or line from which the ends are measured.
    ends : ndarray, shape (e + 1, n)
        Ends of the pieces, ascending.
    inside : ndarray of bool, shape (k, e, n)
        Which of the k intervals hold each piece.
    width : ndarray, shape (k, n)
        Width of each interval; more than a full turn if it overlaps itself.
    side, aspect : ndarray of int, shape (k,)
        Side and aspect of each interval.
    """

    start: Floats
    ends: Floats
    inside: Bools
    width: Floats
    side: NDArray[np.int64]
    aspect: NDArray[np.int64]

    @property
    def safe(self) -> Bools:
        """Tell which intervals are feasible, shape (k,)."""
        return np.asarray(self.aspect != UNSAFE)

    def by(self, side: int, aspect: int | None = None) -> Bools:
        """Tell which intervals have one sign of det J and belong to one, or any, aspect."""
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
    # A gap without width is not an end: a fibre that is a whole circle leaves such a gap.
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


@dataclass(frozen=True, eq=False)
class Fibres(Region):
    """A region whose cells have the second joint as their base."""

    @property
    def lines(self) -> Floats:
        """Values of the second joint between which the fibres keep their form."""
        return self.cells.lines

    def over(self, q2: float) -> tuple[float, list[int]]:
        """Return the cells over a value of the second joint, by rising first joint.

        Returns
        -------
        shift : float
            Full turns to subtract from the second joint to come into the cells' own range.
        cells : list of int
        """
        low = self.lines[0]
        turns = math.floor((q2 - low) / TURN) if self.problem.ranges[1] is None else 0
        t = q2 - TURN * turns
        start, end = self.cells.lines[self.cells.span].T
        cells = np.flatnonzero((start < t) & (t <= end))
        low = self.cells.interval(cells, np.full((len(cells), 1), t))[0, :, 0]
        return TURN * turns, cells[np.argsort(low)].tolist()

    def intervals(self, cells: list[int], q2: Floats) -> Floats:
        """Return the ends of cells' intervals of the first joint over their slab, (2, k, n)."""
        return self.cells.interval(cells, np.broadcast_to(q2, (len(cells), len(q2))))

    def inside(self, component: int) -> Floats:
        """Return a configuration well inside a component: the middle of its widest cell."""
        own = np.flatnonzero(self.cells.owner == component)
        spans = self.cells.spans(own)
        middles = spans.mean(axis=1, keepdims=True)
        low, high = self.cells.interval(own, middles)[..., 0]
        widest = np.minimum(high - low, np.diff(spans)[:, 0]).argmax()
        return np.array([(low + high)[widest] / 2, middles[widest, 0]])


def find_fibres(problem: Problem, home: ArrayLike) -> Fibres:
    """Decompose a problem over its second joint; arguments as `cspace.region.region.solve`.

    Raises
    ------
    UnresolvedError
        If the structure could be decided over the first joint only.
    """
    region = solve(problem, home, base=1)
    if region.base != 1:
        raise UnresolvedError("the fibres over the second joint could not be decided")
    return Fibres(**vars(region))


SAMPLES: Final = 32
"""Values of u that determine a resultant; its degree is 8 in cos u and sin u (second joint
revolute), or 12 in u (prismatic)."""


def crossing_distances(
    arm: PlanarArm, forms: HarmonicForm, ends: Sequence[float], farthest: float
) -> Floats:
    """Return every distance u from the singularity at which both postures' boundaries may cross.

    Some results are spurious, which only costs time. Boundaries that coincide for every u give
    none; walls for the tool itself are such boundaries.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Of the two joints.
    ends : sequence of float
        Ends of the first joint's range, boundaries too.
    farthest : float
        Largest u of interest; rad or length.
    """
    if arm.singularity is None:
        return np.zeros(0)
    u = farthest * _nodes(arm) if arm.kinds[1] == "prismatic" else _nodes(arm)
    table = _first_joint_forms(arm, forms, ends)
    one, other = (_along(arm, table, side, u) for side in (1, -1))
    # The pair (j, i) is the pair (i, j) at -u, which swaps the postures.
    i, j = np.triu_indices(len(table))
    resultant = _circle_resultant if arm.period else _line_resultant
    squared = np.abs(basis(arm.kinds[1], arm.second(1, u)) @ arm.v) ** 2
    values = resultant(one[i], other[j], squared / squared.max())
    found = [np.zeros(0), *(_roots(arm, row) for row in values)]
    distances = np.abs(np.concatenate(found))
    if arm.kinds[1] == "prismatic":
        distances = farthest * distances
    return np.asarray(distances[distances < farthest])


def _nodes(arm: PlanarArm) -> Floats:
    """Return the values of u, or of u divided by the farthest u, for interpolating a resultant."""
    if arm.kinds[1] == "revolute":
        return np.arange(SAMPLES) * math.tau / SAMPLES
    return chebyshev.chebpts1(SAMPLES)


def _first_joint_forms(arm: PlanarArm, forms: HarmonicForm, ends: Sequence[float]) -> Floats:
    """Return the forms that depend on the first joint, and one for each end of its range.

    Shape (m, 3, 3): coefficients in the second joint, then in the first.
    """
    table = np.swapaxes(np.asarray(forms.coefficients, dtype=float), 1, 2)
    table = table[table[:, :, 1:].any(axis=(1, 2))]
    limits = np.zeros((len(ends), 3, 3))
    for form, end in zip(limits, ends, strict=True):
        # sin(q1 - end), which is zero half a turn away too, or q1 - end
        form[0] = (0, -math.sin(end), math.cos(end)) if arm.period else (-end, 1, 0)
    return np.concatenate([table, limits])


def _along(arm: PlanarArm, table: Floats, side: int, u: Floats) -> Complexes:
    """Return each form's coefficients in the place along the circle or line, shape (m, 2 or 3, n).

    Circle: c0 and the complex amplitude times abs(v). Line: the powers 1, x, x^2.
    """
    columns = basis(arm.kinds[1], arm.second(side, u))
    c0, c1, c2 = np.moveaxis(np.einsum("nb,mbl->lmn", columns, table), 0, 0)
    v = columns @ arm.v
    if arm.period:  # q1 = along - arg v
        stacked = np.stack([c0 + 0j, (c1 + 1j * c2) * v / np.abs(v).max()], axis=1)
    else:  # q1 = along - Re v
        x = v.real
        stacked = np.stack([c0 - c1 * x + c2 * x * x, c1 - 2 * c2 * x, c2], axis=1) + 0j
    return np.asarray(stacked / np.abs(stacked).max(axis=(1, 2), keepdims=True))


def _circle_resultant(a: Complexes, b: Complexes, squared: Floats) -> Floats:
    """Vanish where two forms c0 abs(v) + Re(amplitude exp(-i along)) share a root."""
    determinant = (a[:, 1].conj() * b[:, 1]).imag
    ends = ~np.any((a[:, 0] != 0) | (b[:, 0] != 0), axis=1)
    numerator = np.abs(a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]) ** 2
    # Two ends of the range have c0 = 0: the square would double their roots.
    return np.asarray(
        np.where(ends[:, None], determinant, squared * numerator - determinant * determinant)
    )


def _line_resultant(a: Complexes, b: Complexes, _: Floats) -> Floats:
    """Vanish where two forms of degree 1 or 2 in the place along a line share a root."""
    (a0, a1, a2), (b0, b1, b2) = np.moveaxis(a.real, 1, 0), np.moveaxis(b.real, 1, 0)
    p, q = a1 * b0 - a0 * b1, a2 * b0 - a0 * b2
    affine = ~np.any((a2 != 0) | (b2 != 0), axis=1)
    return np.asarray(np.where(affine[:, None], p, q * q - (a2 * b1 - a1 * b2) * p))


def _roots(arm: PlanarArm, values: Floats) -> Floats:
    """Return the real roots of a polynomial given by its values at the nodes."""
    if np.abs(values).max() <= NEGLIGIBLE:  # the boundaries coincide
        return np.zeros(0)
    if arm.kinds[1] == "prismatic":
        c = _trimmed(chebyshev.chebfit(_nodes(arm), values, SAMPLES - 1))
        x = chebyshev.chebroots(c)
        return np.asarray(x.real[np.abs(x.imag) <= NEAR_CIRCLE])
    c = np.fft.fftshift(np.fft.fft(values)) / SAMPLES
    z = polynomial.polyroots(_trimmed(_trimmed(c)[::-1])[::-1])
    return np.asarray(np.angle(z[np.abs(np.abs(z) - 1) <= NEAR_CIRCLE]))


def _trimmed(c: NDArray[Any]) -> NDArray[Any]:
    """Drop coefficients at the upper end that are rounding of zero."""
    kept = np.flatnonzero(np.abs(c) > NEGLIGIBLE * np.abs(c).max())
    return c[: kept[-1] + 1]


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
        The components of these regions that count as feasible.
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
            If there are more than `MOST_BOUNDING`.
        """
        found = [np.zeros((0, 9))]
        for part in self.sides.values():
            rows, curves = part.cells.row, part.cells.curves
            for row in np.unique(rows[rows >= 0]).tolist():
                form = curves.form(row).coefficients.reshape(1, 9)
                found.append(form / form[0, np.abs(form[0]).argmax()])
        tables = np.concatenate(found)
        _, first = np.unique(tables.round(12) + 0.0, axis=0, return_index=True)
        if len(first) > MOST_BOUNDING:
            raise NoPlanarWorkspaceError(
                f"the workspace is not computed: {len(first)} boundaries bound the"
                f" region, and any two may cross; {MOST_BOUNDING} are the most"
            )
        return HarmonicForm(tables[np.sort(first)].reshape(-1, 3, 3), problem.forms.kinds)

    def _met(self, lines: Floats, crossing: Floats) -> Iterator[Floats]:
        """Yield those distances of possible crossings at which ends of both postures meet.

        Two boundaries may also cross where neither ends an interval; that only costs one more slab.
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
        fine = [converged(over, smallest)[0] for over in sums]
        return [float(value) for value in np.sum(fine, axis=0)]

    def cover(self, u: Floats, slab: Slab) -> Cover:
        """Lay all intervals over each other, for values of u within a slab."""
        return cover(list(self._intervals(u, sum(slab) / 2)), len(u), self.arm.period)

    def patches(self, n: int = 33) -> Iterator[tuple[int, Floats]]:
        """Yield pieces of the plane: feasible postures, 1 or 2, and the outline, shape (m, 2).

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
            wide = np.diff(laid.ends, axis=0).max(axis=1) > NEGLIGIBLE  # more than rounding
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
            return values_within(kind, q2, self.square[1])
        return values_within(kind, q2, inner) or [q2]

    def _fibre(self, side: int, q2: Floats, middle: float) -> list[Interval]:
        """Return the kept intervals of the first joint over values of the second, ascending."""
        part = self.sides[side]
        shift, cells = part.over(middle)
        owner = part.cells.owner.tolist()
        kept = [k for k in cells if owner[k] in self.kept[side]]
        ends = zip(*part.intervals(kept, q2 - shift), strict=True) if kept else ()
        found = [Interval(side, owner[k], *pair) for k, pair in zip(kept, ends, strict=True)]
        rows = part.cells.row[kept]
        if len(kept) > 1 and part.cells.round[1] and rows[0, 0] == LOW and rows[-1, 1] == HIGH:
            # An interval over the cut of the circle is two cells.
            (first, *rest), last = found[:-1], found[-1]
            return [*rest, last._replace(high=first.high + TURN)]
        return found

    def _gaps(self, side: int, fibre: list[Interval], zero: Floats) -> Iterator[Interval]:
        """Yield the gaps of a fibre in the first joint's square, around the circle if it turns."""
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
    """Return values ascending, each one once up to rounding."""
    u = np.sort(u)
    return np.asarray(u[np.diff(u, prepend=-np.inf) > SAME_CRITICAL])


def _quadrature(density: Callable[[Floats, Slab], Floats], slab: Slab, n: int) -> Floats:
    """Integrate over a slab with u = m + h sin(angle): a square root at its ends is smooth then."""
    nodes, weights = legendre(n)
    angle = nodes * math.pi / 2
    middle, half = sum(slab) / 2, (slab[1] - slab[0]) / 2
    weights = weights * math.pi / 2 * half * np.cos(angle)
    return np.asarray(density(middle + half * np.sin(angle), slab) @ weights)
