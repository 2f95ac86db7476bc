"""Cells of two joints in which every form is positive and all bodies are apart.

A cylindrical decomposition. For a fixed value of one joint, the base, each form is a one-joint form
in the other, the lift, and Theorem 2 (or the quadratic formula) gives its roots. How these roots
lie to each other changes only at critical base values, and each kind of these is a root of one
univariate polynomial (`critical`). Of bodies only contacts count (`pieces`): along the lift the
number of pairs in collision goes up or down by one at each. No grid, no sample, no starting guess.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, turns_up_to
from qbound.region.critical import base_values, meetings, own_events, univariate
from qbound.region.pieces import INSIDE, Pieces, crossings, find_pieces
from qbound.region.plane import HIGHEST, LOWEST, Plane, Root, Separation, ranges, runs, which
from qbound.tolerances import (
    BEYOND_JUMP,
    NEGLIGIBLE,
    POSITIVE,
    SAME_CRITICAL,
    SAME_POINT,
    THIN,
    UNCHANGED,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


class Cell(NamedTuple):
    """A piece of the plane over one slab, between two roots, in which every form is positive.

    On a lift that turns round, a cell from end to end is the whole fibre and has no boundary.
    """

    slab: int
    lower: Root
    upper: Root


@dataclass(frozen=True, eq=False)
class Decomposition:
    """Slabs between critical base values, and the feasible cells over them.

    Attributes
    ----------
    lines : ndarray, shape (s + 1,)
        Critical base values, ascending; slab i lies between lines i and i + 1.
    slabs : ndarray of int, shape (k,)
        Slab of each cell, ascending.
    roots : ndarray of int, shape (k, 2, 3)
        Lower and upper root of each cell, as `Root`.
    walls : ndarray
        Base values at which bodies may touch along a fibre.
    """

    plane: Plane
    lines: Floats
    slabs: Ints
    roots: Ints
    walls: Floats

    @cached_property
    def cells(self) -> list[Cell]:
        """The cells one by one."""
        rows = zip(self.slabs.tolist(), self.roots.tolist(), strict=True)
        return [Cell(slab, Root(*lower), Root(*upper)) for slab, (lower, upper) in rows]

    def joined(self, line: Ints, low: Floats, high: Floats) -> Bools:
        """Tell whether what is free on both sides of lines is so on them, between lift values."""
        t = self.lines[line]
        free = self.plane.open(t, low, high, POSITIVE)
        if len(self.walls):
            near = np.abs(self.walls[:, None] - t).min(axis=0) <= 2 * SAME_CRITICAL
            wall = which(free & near)
            free[wall] = self.plane.apart(t[wall], low[wall], high[wall], POSITIVE)
        return free


def decompose(plane: Plane) -> Decomposition:
    """Find all critical base values and all feasible cells.

    A slab so narrow that only the rounding of critical values can have made it, in which contacts
    contradict each other, is left to its neighbour.
    """
    pieces = find_pieces(plane)
    lines = critical_values(plane, pieces)
    while True:
        # Off the middle where bodies touch: it may be a place of symmetry.
        part = INSIDE if plane.contacts.pairs else 0.5
        widths = lines[1:] - lines[:-1]
        slabs, roots, doubtful = _cells(plane, lines[:-1] + part * widths, pieces)
        unreal = which(doubtful & (widths < BEYOND_JUMP))
        if not len(unreal):
            return _without_idle_lines(Decomposition(plane, lines, slabs, roots, pieces.walls))
        last = len(lines) - 1
        lines = np.delete(
            lines, np.where(unreal + 1 == last, unreal, unreal + 1) if last > 1 else []
        )


# --- critical base values -------------------------------------------------------------------------


def critical_values(plane: Plane, pieces: Pieces | None = None) -> Floats:
    """Return every base value at which the order of roots may change, with both ends of the range.

    Some are spurious, which costs time; none is missing, which would cost the answer.
    """
    found = [_of_forms(plane)]
    if pieces is not None and plane.contacts.pairs:
        found += [pieces.lines, pieces.walls, crossings(plane, pieces)]
    values, (low, high) = np.concatenate(found), plane.ends
    inner = np.sort(values[(values > low + SAME_CRITICAL) & (values < high - SAME_CRITICAL)])
    lines = np.concatenate([[low], inner, [high]])
    return np.concatenate([lines[:1], lines[1:][lines[1:] - lines[:-1] > SAME_CRITICAL]])


def _of_forms(plane: Plane) -> Floats:
    """Return the base values at which forms that stand alone have events, or meet."""
    table = plane.scaled[: plane.count]
    c = univariate(plane, table)
    lifts = table[:, :, 1:].any(axis=(1, 2))
    fixed, c = c[~lifts, 0], c[lifts]  # a form without the lift vanishes on whole fibres
    every = np.arange(len(c))
    i, j = np.nonzero(every[:, None] < every)
    alone = iter([(np.arange(len(fixed)), fixed)])
    return base_values(plane, chain(alone, own_events(plane, c), meetings(plane, c[i], c[j])))[1]


# --- lifting --------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Fibres:
    """What bounds cells over one base value inside each slab, ascending; one a row.

    Attributes
    ----------
    t : ndarray, shape (slabs,)
    slab : ndarray of int, shape (n,)
    values : ndarray, shape (n,)
        Lift values.
    roots : ndarray of int, shape (n, 3)
        As `Root`.
    piece : ndarray of int, shape (n,)
        Which contact; -1 for a root of a form that stands alone, and for an end.
    circle : bool
        Whether the lift closes: after a slab's last root comes its first, a turn on.
    """

    t: Floats
    slab: Ints
    values: Floats
    roots: Ints
    piece: Ints
    circle: bool

    def only(self, rows: Ints) -> _Fibres:
        """Return some of the rows."""
        slab, values, roots = self.slab[rows], self.values[rows], self.roots[rows]
        return _Fibres(self.t, slab, values, roots, self.piece[rows], self.circle)

    def gaps(self) -> tuple[Ints, Floats]:
        """Return of each row the next one, and its value; NaN above the last of a range."""
        n = len(self.slab)
        after, tops = np.arange(1, n + 1), np.full(n, np.nan)
        tops[:-1] = self.values[1:]
        first, last = runs(self.slab)
        if self.circle:
            after[last], tops[last] = first, self.values[first] + TURN
        else:
            tops[last] = np.nan
        return after, tops


def _cells(plane: Plane, middles: Floats, pieces: Pieces) -> tuple[Ints, Ints, Bools]:
    """Return the feasible cells over one base value in each slab, and which slabs are doubtful.

    Of the cells there are slab and both roots, shape (k,) and (k, 2, 3).
    """
    fibres = _fibres(plane, middles, pieces)
    doubtful = np.zeros(len(middles), dtype=np.bool_)
    if plane.contacts.pairs:
        fibres, doubtful = _once(plane, fibres, pieces)
    after, tops = fibres.gaps()
    wide = which(tops > fibres.values)
    if plane.contacts.pairs:
        apart, doubtful = _apart(plane, fibres, pieces, tops, doubtful)
        wide = wide[apart[wide]]
    t, low, high = middles[fibres.slab[wide]], fibres.values[wide], tops[wide]
    free = wide[plane.open(t, low, high, NEGLIGIBLE)]
    roots = fibres.roots[np.array([free, after[free]]).T]
    roots[after[free] <= free, 1, 2] += 1  # past the cut of the circle
    roots[roots[:, 1, 0] < 0, 1] = HIGHEST
    return fibres.slab[free], roots, doubtful


def _fibres(plane: Plane, t: Floats, pieces: Pieces) -> _Fibres:
    """Return the roots in the lift's range and its ends; on a circle without roots, its cut."""
    found = plane.roots(t)
    branch, slab, form = np.nonzero(np.isfinite(found))
    values, (low, high) = found[branch, slab, form], plane.lift_ends
    roots, piece = np.zeros((len(form), 3), dtype=np.int64), np.full(len(form), -1)
    roots[:, 0], roots[:, 1] = form, 2 * branch - 1
    if plane.contacts.pairs:
        k, over = ranges(np.searchsorted(t, pieces.start), np.searchsorted(t, pieces.end))
        touching = pieces.roots(plane, k)
        values = np.concatenate([values, plane.follow(touching, t[over][:, None])[:, 0]])
        roots = np.concatenate([roots, touching])
        slab, piece = np.concatenate([slab, over]), np.concatenate([piece, k])
    if plane.lift_kind == "revolute":
        first = turns_up_to(low, values).astype(np.int64)
        if plane.lift_range is None:  # by rounding a root could have no place, or two
            values, roots[:, 2] = values + TURN * first, first
        else:
            pick, turns = ranges(first, turns_up_to(high, values).astype(np.int64))
            values = values[pick] + TURN * turns
            slab, roots, piece = slab[pick], roots[pick], piece[pick]
            roots[:, 2] = turns
    every = np.arange(len(t))
    if plane.lift_range is None:
        ends = [(which(np.bincount(slab, minlength=len(t)) == 0), low, LOWEST)]
    else:
        inside = (values > low) & (values < high)
        slab, values, roots, piece = slab[inside], values[inside], roots[inside], piece[inside]
        ends = [(every, low, LOWEST), (every, high, HIGHEST)]
    for where, value, root in ends:
        if len(where):
            slab = np.concatenate([slab, where])
            values = np.concatenate([values, np.full(len(where), value)])
            roots = np.concatenate([roots, np.tile(root, (len(where), 1))])
            piece = np.concatenate([piece, np.full(len(where), -1)])
    order = np.lexsort([values, slab])
    circle = plane.lift_range is None
    return _Fibres(t, slab, values, roots, piece, circle).only(order)


# --- bodies ---------------------------------------------------------------------------------------


def _once(plane: Plane, fibres: _Fibres, pieces: Pieces) -> tuple[_Fibres, Bools]:
    """Keep one of contacts that are one: along a fibre a pair comes into collision and out in turn.

    Two convex bodies collide on intervals of the lift; where two features meet, and along parallel
    edges, one contact is found twice. A slab in which a pair comes in, or out, twice at places that
    are apart is left as it is, and said to be doubtful; so is one in which a pair comes in and out
    at one place, as where bodies only touch: these are in no order.
    """
    touching = _counted(plane, fibres, pieces)
    piece = fibres.piece[touching]
    group = (
        fibres.slab[touching] * plane.contacts.pairs + plane.contacts.pair[pieces.feature[piece]]
    )
    order = np.argsort(group, kind="stable")
    rows, group = touching[order], group[order]
    enters, values = pieces.enters[fibres.piece[rows]], fibres.values[rows]
    before = np.roll(np.arange(len(rows)), 1)
    first, last = runs(group)
    before[first] = last  # on a circle the first comes after the last
    gap = np.abs(values - values[before])
    again = (enters == enters[before]) & (before != np.arange(len(rows)))
    back = (enters != enters[before]) & (gap <= THIN * plane.lift_unit)
    if fibres.circle:
        gap[first] = TURN - gap[first]
    else:
        again[first] = False
    back[first] = False
    doubtful = np.zeros(len(fibres.t), dtype=np.bool_)
    doubtful[fibres.slab[rows[back]]] = True
    doubtful[fibres.slab[rows[again & (gap > THIN * plane.lift_unit)]]] = True
    dropped = rows[again & ~doubtful[fibres.slab[rows]]]
    kept = np.ones(len(fibres.slab), dtype=np.bool_)
    kept[dropped] = False
    return fibres.only(which(kept)), doubtful


def _apart(
    plane: Plane, fibres: _Fibres, pieces: Pieces, tops: Floats, doubtful: Bools
) -> tuple[Bools, Bools]:
    """Tell of the gap above each row whether all bodies are apart in it, and of slabs if doubtful.

    The number of pairs in collision is counted from the widest gap of the slab, where it is tested.
    A slab in which the count does not return to itself round a circle, or is not what a second test
    finds at an end of a range, is doubtful, too. Such slabs are tested gap by gap, and so is what
    is thin, and pairs at rest: where one only touches, at both ends of an edge it slides along, it
    comes in and goes out again at once.
    """
    slabs, widths = len(fibres.t), np.nan_to_num(tops - fibres.values, nan=-1.0)
    start = np.searchsorted(fibres.slab, np.arange(slabs))
    places = [start + _first_largest(widths, start, fibres.slab)]
    if not fibres.circle:
        places += [start, np.append(start[1:], len(fibres.slab)) - 2]
    moving = Separation(plane, ~pieces.base_only & ~pieces.idle & ~pieces.resting)
    change, found = _changes(plane, fibres, pieces), []
    count = np.cumsum(change)
    for row in places:
        middle = fibres.values[row] + INSIDE * widths[row]
        found.append((moving.heights(fibres.t, middle) <= NEGLIGIBLE).sum(axis=1))
        if row is places[0]:
            still = Separation(plane, pieces.base_only | pieces.idle)
            blocked = np.asarray((still.heights(fibres.t, middle) <= NEGLIGIBLE).any(axis=1))
            count = count + (found[0] - count[row])[fibres.slab]
        else:
            doubtful = doubtful | (
                (found[-1] != count[row]) & (widths[row] > THIN * plane.lift_unit)
            )
    if fibres.circle:
        doubtful = doubtful | (np.bincount(fibres.slab, change, slabs) != 0)
    possible = ~blocked[fibres.slab] & (widths > 0)
    thin = (count == 0) & (widths < THIN * plane.lift_unit)
    looked = which(possible & (thin | doubtful[fibres.slab]))
    apart: Bools = np.asarray(possible & (count == 0))
    t, low = fibres.t[fibres.slab[looked]], fibres.values[looked]
    apart[looked] = plane.apart(t, low, tops[looked], NEGLIGIBLE)
    if pieces.resting.any():
        resting, looked = Separation(plane, pieces.resting), which(apart)
        middle = fibres.values[looked] + INSIDE * (tops - fibres.values)[looked]
        heights = resting.heights(fibres.t[fibres.slab[looked]], middle)
        apart[looked] = (heights > NEGLIGIBLE).all(axis=1)
    return apart, doubtful & ~blocked


def _counted(plane: Plane, fibres: _Fibres, pieces: Pieces) -> Ints:
    """Return the rows that are contacts of pairs that are counted: those at rest are tested."""
    touching = which(fibres.piece >= 0)
    pair = plane.contacts.pair[pieces.feature[fibres.piece[touching]]]
    return touching[~pieces.resting[pair]]


def _first_largest(widths: Floats, start: Ints, slab: Ints) -> Ints:
    """Return in each slab the place of the largest width, the first where there are several."""
    most = np.maximum.reduceat(widths, start)
    where = which(widths == most[slab])
    _, first = np.unique(slab[where], return_index=True)
    return where[first] - start


def _changes(plane: Plane, fibres: _Fibres, pieces: Pieces) -> Ints:
    """Return by how much each row changes the number of pairs in collision."""
    change = np.zeros(len(fibres.slab), dtype=np.int64)
    touching = _counted(plane, fibres, pieces)
    change[touching] = np.where(pieces.enters[fibres.piece[touching]], 1, -1)
    return change


def _without_idle_lines(found: Decomposition) -> Decomposition:
    """Drop the critical lines at which no feasible cell changes, and join the cells across."""
    plane, lines, slabs, roots = found.plane, found.lines, found.slabs, found.roots
    count = np.bincount(slabs, minlength=len(lines) - 1)
    # Cell by cell: is there the same, in its turn, over the slab before?
    number = np.arange(len(slabs)) - (count.cumsum() - count)[slabs]
    back = np.concatenate([[0], count])[slabs]
    there = number < back
    k = which(there)
    there[k] = (roots[k] == roots[k - back[k]]).all(axis=(1, 2))
    same = np.zeros(len(lines), dtype=np.bool_)
    same[1:-1] = count[1:] == count[:-1]
    same[slabs[~there]] = False
    k = which(same[slabs])
    same[slabs[k[~_goes_on(found, slabs[k], roots[k])]]] = False
    kept = ~same
    renumbered, left = kept.cumsum() - 1, kept[slabs]
    return Decomposition(plane, lines[kept], renumbered[slabs[left]], roots[left], found.walls)


def _goes_on(found: Decomposition, at: Ints, roots: Ints) -> Bools:
    """Tell whether cells between the same two roots on both sides of a line are one, open on it."""
    plane, lines = found.plane, found.lines
    widths = np.array([lines[at] - lines[at - 1], np.zeros(len(at)), lines[at + 1] - lines[at]]).T
    step = np.maximum(UNCHANGED**2 * widths, np.minimum(widths / 2, BEYOND_JUMP))
    t = lines[at][:, None] + step * np.array([-1, 0, 1])
    own = roots.swapaxes(0, 1)  # all lower ones, then all upper
    twins = own * np.array([1, -1, 1])  # of the other branch
    values = plane.follow(np.concatenate([own, twins]), t)
    (lower, upper), height = values[:2], (values[1] - values[0]).min(axis=1)
    smooth = np.ptp(values[:2], axis=2).sum(axis=0) < UNCHANGED * height
    going = smooth & (height > SAME_POINT * plane.lift_unit)
    going &= _simple(plane, own[..., 0], values[:2] - values[2:]).all(axis=0)
    going[going] = found.joined(at[going], lower[going, 1], upper[going, 1])
    return np.asarray(going)


def _simple(plane: Plane, form: Ints, gap: Floats) -> Bools:
    """Tell whether roots keep away from the other root of their form: where both meet is a kink.

    Of forms (2, n) and gaps (2, n, places); (2, n).
    """
    gap = np.sin(gap / 2) if plane.lift_kind == "revolute" else gap
    alone = (form < 0) | plane.affine[np.maximum(form, 0)] if len(plane.affine) else form < 0
    return np.asarray(alone | (np.abs(gap).min(axis=2) > UNCHANGED))
