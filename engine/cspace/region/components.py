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
from cspace.region.exact import Between, Name, Place
from cspace.tolerances import TOUCH, UNIT
from qbound.circle import TURN

SIDE_ERROR = 1e-9
"""A side condition beyond this has a sign."""

CUT = -3
"""In place of a segment: the end of a part of a wall."""


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
    ends : tuple of End
        The same, as ends of cells or of walls; empty over the cut of the lift.
    """

    one: int
    other: int
    base: int
    lift: int
    low: float
    high: float
    ends: tuple[End, ...] = ()


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
    """An end of a cell on a line: lift value, segment, cell, side of the cell, lower or upper.

    Or an end of a part of a wall: lift value, and its exact place.
    """

    v: float
    segment: int = CUT
    cell: int = -1
    side: int = 0
    upper: int = 0
    cut: Place | None = None


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
                for own in _open_parts(cells, line, start, end):
                    yield Join(a, b, int(line != before), 0, own[0].v, own[1].v, own)
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
    if one.segment == other.segment != CUT and (one.segment < 0 or line == before):
        return 0
    both = {one.segment, other.segment}
    if any(both <= own for k in {line, before} for own in cells.meets.get(k, ())):
        return 0
    places = [place_of(cells, end) for end in (one, other)]
    if places[0][0] == places[1][0] and line != before:
        return 0  # one root, over the cut
    return cells.exact.compared(*places)


def place_of(cells: Cells, end: End) -> Place:
    """Return an end as exact numbers take it."""
    return end.cut or cells.place(end.cell, end.side, end.upper)


def half_way(cells: Cells, low: End, high: End) -> Between:
    """Return the lift value between two ends, or of ends that are nearly one both, exactly."""
    if high.v - low.v > TOUCH:
        return (low.v + high.v) / 2
    return place_of(cells, low), place_of(cells, high)


def _open_parts(cells: Cells, line: int, low: End, high: End) -> Iterator[tuple[End, End]]:
    """Yield the parts of an edge on a line that no wall covers (sentence 10)."""
    walls = cells.walls.get(line)
    if not walls:
        yield low, high
        return
    scene = cells.scene
    if any(c < scene.count for c in walls):
        return
    f = np.flatnonzero(np.isin(scene.curve, list(walls)) & scene.live)
    for a, b in pairwise(wall_cuts(cells, line, f, low, high)):
        if not standing(cells, line, f, half_way(cells, a, b)):
            yield a, b


def standing(cells: Cells, line: int, f: Ints, at: Between) -> list[int]:
    """Return which features forbid a place on a line (sentence 10)."""
    found, vague = f[:0], f
    if isinstance(at, float):
        t = cells.lines.t[[line]].repeat(len(f))
        least = cells.scene.sides_at(f, t, np.full((len(f), 2), at)).min(axis=(1, 2))
        found, vague = f[least > SIDE_ERROR], f[np.abs(least) <= SIDE_ERROR]
    return [*found.tolist(), *(k for k in vague.tolist() if cells.exact.covers(k, line, at))]


def wall_cuts(cells: Cells, line: int, f: Ints, low: End, high: End) -> list[End]:
    """Return where features may begin or end to forbid something along a line; with both ends.

    There a side condition vanishes, or the form's slope along the base.
    """
    scene = cells.scene
    curves = distinct(scene.curve[f])
    tables = [*scene.sides[f].reshape(-1, 3, 3), *along_base(scene.turns[0], scene.table[curves])]
    names: list[Name] = [(k, s) for k in f.tolist() for s in range(scene.sides.shape[1])]
    names += [(c, None) for c in curves.tolist()]
    base = basis(scene.turns[0], np.float64(cells.lines.t[line]))
    rows = np.einsum("i,nij->jn", base, np.reshape(tables, (-1, 3, 3)))
    # Less is the rounding of a zero row.
    some = np.flatnonzero(fold(rows, scene.turns[1]) > (64 * UNIT) ** 2)
    roots = lift_roots(scene.turns[1], rows[:, some], np.zeros(len(some), dtype=np.bool_))
    found = [low]
    for falling, k in np.ndindex(*roots.shape):
        v, least = float(roots[falling, k]), low.v - TOUCH
        turns = range(1)
        if scene.turns[1]:
            v = least + (v - least) % TURN
            turns = range(int((high.v + TOUCH - v) // TURN) + 1)
        for x in (v + TURN * turn for turn in turns):
            here = End(x, cut=((names[some[k]], (1, -1)[falling], x), line, 0))
            at = len(found)
            while at and (order := compare(cells, line, line, here, found[at - 1])) < 0:
                at -= 1
            if order > 0 and compare(cells, line, line, here, high) < 0:
                found.insert(at, here)
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
