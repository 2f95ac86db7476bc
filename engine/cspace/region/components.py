"""Components: which cells share an open edge, and how often a component goes round the joints.

Over a line two cells touch in a point only if their ends meet in an event of that line; this is
looked up. Otherwise their ends differ, and doubles or exact numbers say which one is higher. A form
that vanishes along a line forbids the line, or the part of it where its side conditions hold. Here
the circles are glued where they were cut (sentence 10).
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from cspace.arrays import Ints, distinct
from cspace.region.algebra import HIGH, LOW, along_base, basis, fold, lift_roots
from cspace.region.cells import Cells
from cspace.tolerances import TOUCH, UNIT
from qbound.circle import TURN

SIDE_ERROR = 1e-9
"""A side condition beyond this has a sign; places along a wall nearer than this are one."""


class Join(NamedTuple):
    """An open edge that two cells share.

    Attributes
    ----------
    one, other : int
        The cell on the left and on the right; over the cut of the lift below and above it.
    base, lift : int
        Turns by which the other cell lies further.
    low, high : float
        Ends of the edge: lift values, or over the cut of the lift base values.
    start, end : End, optional
        The ends of cells that these are; None where a wall begins, and over the cut of the lift.
    """

    one: int
    other: int
    base: int
    lift: int
    low: float
    high: float
    start: End | None = None
    end: End | None = None


class Part(NamedTuple):
    """A component as cells, and whether it goes round base and lift.

    Attributes
    ----------
    cells : list of int
    turns : list of (int, int)
        By how many turns of base and lift each cell is moved, to lie next to its neighbours.
    wraps : pair of bool
    """

    cells: list[int]
    turns: list[tuple[int, int]]
    wraps: tuple[bool, bool]


class End(NamedTuple):
    """An end of a cell on a line: lift value, segment, cell, side of the cell, lower or upper."""

    v: float
    segment: int
    cell: int
    side: int
    upper: int


def find_joins(cells: Cells) -> list[Join]:
    """Return all open edges that two cells share (sentence 10)."""
    found = list(_over_lines(cells))
    return [*found, *_over_the_cut(cells)] if cells.scene.round[1] else found


def _over_lines(cells: Cells) -> Iterator[Join]:
    """Yield the joins over lines: cells on both sides of a line, in order, meet as in a merge."""
    low_line, high_line = cells.lines.last()
    left: dict[int, list[int]] = {}
    right: dict[int, list[int]] = {}
    for k, (a, b) in enumerate(cells.span.tolist()):
        right.setdefault(a, []).append(k)
        left.setdefault(b, []).append(k)
    ends, roots, rank = cells.ends.tolist(), cells.roots.tolist(), cells.rank.tolist()
    for line in sorted(right):
        before = line
        if line == low_line:
            if not cells.scene.round[0]:
                continue
            before = high_line
        one = sorted(left.get(before, ()), key=lambda k: rank[k][1])
        other = sorted(right[line], key=lambda k: rank[k][0])
        i = j = 0
        while i < len(one) and j < len(other):
            a, b = one[i], other[j]
            lower, upper = (End(ends[a][1][e], roots[a][e], a, 1, e) for e in (0, 1))
            other_lower, other_upper = (End(ends[b][0][e], roots[b][e], b, 0, e) for e in (0, 1))
            order = compare(cells, line, before, upper, other_upper)
            start = lower if compare(cells, line, before, lower, other_lower) > 0 else other_lower
            end = upper if order < 0 else other_upper
            if compare(cells, line, before, start, end) < 0:
                for low, high in _open_parts(cells, line, start, end):
                    own = start if low == start.v else None, end if high == end.v else None
                    yield Join(a, b, int(line != before), 0, low, high, *own)
            i, j = i + (order <= 0), j + (order >= 0)


def _over_the_cut(cells: Cells) -> Iterator[Join]:
    """Yield joins of cells below the upper end of the lift with cells above the lower end."""
    span, t = cells.span.tolist(), cells.lines.t
    tops = np.flatnonzero(cells.roots[:, 1] == HIGH).tolist()
    bottoms = np.flatnonzero(cells.roots[:, 0] == LOW).tolist()
    bottoms.sort(key=lambda k: span[k])
    starts = [span[k][0] for k in bottoms]
    for a in tops:
        first = max(int(np.searchsorted(starts, span[a][0], "right")) - 1, 0)
        for b in bottoms[first:]:
            if span[b][0] >= span[a][1]:
                break
            low, high = max(span[a][0], span[b][0]), min(span[a][1], span[b][1])
            if low < high:
                yield Join(a, b, 0, 1, float(t[low]), float(t[high]))


def compare(cells: Cells, line: int, before: int, one: End, other: End) -> int:
    """Return the sign of the difference of two ends of cells on a line; 0 where roots meet.

    Roots that meet on a line do so at one of its events (sentence 10).
    """
    if abs(one.v - other.v) > TOUCH:
        return 1 if one.v > other.v else -1
    if one.segment == other.segment and (one.segment < 0 or line == before):
        return 0
    both = {one.segment, other.segment}
    if any(both <= own for k in {line, before} for own in cells.meets.get(k, ())):
        return 0
    places = [cells.place(end.cell, end.side, end.upper) for end in (one, other)]
    if places[0][0] == places[1][0] and line != before:
        return 0  # one root, over the cut
    return cells.exact.compared(*places)


def _open_parts(cells: Cells, line: int, lower: End, upper: End) -> Iterator[tuple[float, float]]:
    """Yield the parts of an edge on a line that no wall covers (sentence 10)."""
    low, high = lower.v, upper.v
    walls = cells.walls.get(line)
    if not walls:
        yield low, high
        return
    scene = cells.scene
    if any(c < scene.count for c in walls):
        return
    f = np.flatnonzero(np.isin(scene.curve, list(walls)) & scene.live)
    if high - low < TOUCH:
        one, other = (cells.place(end.cell, end.side, end.upper) for end in (lower, upper))
        if not cells.exact.covered(f, one[1], (one, other)):
            yield low, high
        return
    t = cells.lines.t[[line]].repeat(len(f))
    cuts = wall_cuts(cells, line, f, low, high)
    for a, b in pairwise(cuts):
        v = (a + b) / 2
        least = scene.sides_at(f, t, np.full((len(f), 2), v)).min(axis=(1, 2))
        vague = f[np.abs(least) <= SIDE_ERROR]
        if not (least > SIDE_ERROR).any() and not cells.exact.covered(vague, line, v):
            yield a, b


def wall_cuts(cells: Cells, line: int, f: Ints, low: float, high: float) -> list[float]:
    """Return where features may begin or end to forbid something along a line; with both ends.

    There a side condition vanishes, or the form's slope along the base. Places that differ by
    rounding are one. Places near an end of the edge are left out, because at a fold the end is
    known only to the square root of rounding.
    """
    scene = cells.scene
    slopes = along_base(scene.turns[0], scene.table[distinct(scene.curve[f])])
    base = basis(scene.turns[0], np.float64(cells.lines.t[line]))
    every = np.concatenate([scene.sides[f].reshape(-1, 3, 3), slopes])
    rows = np.einsum("i,nij->jn", base, every)
    some = fold(rows, scene.turns[1]) > (64 * UNIT) ** 2  # less is the rounding of a zero row
    v = lift_roots(scene.turns[1], rows[:, some], np.zeros(some.sum(), dtype=np.bool_))
    if scene.turns[1]:
        bottom, top = scene.ends[1]
        turns = np.arange(int((top - bottom) / TURN) + 1)
        v = bottom + (v - bottom) % TURN + TURN * turns[:, None, None]
    found = [low]
    for x in np.sort(v, axis=None).tolist():
        if max(found[-1] + SIDE_ERROR, low + TOUCH) < x < high - TOUCH:
            found.append(x)
    return [*found, high]


def find_parts(cells: Cells, joins: list[Join]) -> list[Part]:
    """Return the components: groups of joined cells, and what they go round (sentence 10)."""
    near: list[list[tuple[int, int, int]]] = [[] for _ in range(len(cells.span))]
    for join in joins:
        near[join.one].append((join.other, join.base, join.lift))
        near[join.other].append((join.one, -join.base, -join.lift))
    known: dict[int, tuple[int, int]] = {}
    found = []
    for start in range(len(near)):
        if start in known:
            continue
        known[start], own, wraps = (0, 0), [start], [False, False]
        for a in own:  # grows
            for b, base, lift in near[a]:
                here = known[a][0] + base, known[a][1] + lift
                if b not in known:
                    known[b] = here
                    own.append(b)
                else:
                    wraps = [w or x != y for w, x, y in zip(wraps, known[b], here, strict=True)]
        found.append(Part(own, [known[k] for k in own], (wraps[0], wraps[1])))
    return found
