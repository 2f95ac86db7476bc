"""From cells to components: which cells are adjacent over an open interval, and what bounds them.

Two neighbouring cells are joined across a critical line only over an open interval on which every
form is positive on that line. The boundary of a component is a set of loops of half-edges with the
component on the left: along the lower root of a cell, up or down a critical line where nothing is
joined, back along the upper root.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, first_from, turns_up_to, whole_turns
from qbound.records import dataclass
from qbound.region.decomposition import Cell, Decomposition
from qbound.region.plane import Plane, ranges
from qbound.tolerances import SAME_POINT, TOUCH

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

INSET = 1e-4 * np.arange(4)
"""Where cells are looked at beside their lines, in parts of their width."""


LOWER, UP, UPPER, DOWN = range(4)
"""Half-edges round a cell, in the order of the loop: along a root, or along a critical line."""


class Placed(NamedTuple):
    """A cell that holds a configuration, or nearly.

    Attributes
    ----------
    cell : int
    place : ndarray, shape (2,)
        Base and lift value in the cell's own turns.
    off : ndarray, shape (2,)
        From there to the cell's closure; zero inside.
    """

    cell: int
    place: Floats
    off: Floats


@dataclass(frozen=True, eq=False)
class Elements:
    """Pieces of critical lines between ends of cells, one a row, by line and upwards.

    Attributes
    ----------
    line : ndarray of int, shape (n,)
    low, high : ndarray, shape (n,)
        Where it lies; within one turn, but for the last, where the lift is a circle.
    cell : ndarray of int, shape (2, n)
        The cells to its left and to its right; -1 where there is none.
    turns : ndarray of int, shape (2, n)
        Full turns that bring it into these cells.
    joined : ndarray of bool, shape (n,)
        Whether the two cells hang together over it.
    """

    line: Ints
    low: Floats
    high: Floats
    cell: Ints
    turns: Ints
    joined: Bools


@dataclass(frozen=True, eq=False)
class HalfEdges:
    """What bounds cells, each with its cell on the left, one a row.

    Attributes
    ----------
    kind : ndarray of int, shape (n,)
        `LOWER`, `UP`, `UPPER` or `DOWN`.
    cell : ndarray of int, shape (n,)
    element : ndarray of int, shape (n,)
        Of those along a critical line; -1 along a root.
    after : ndarray of int, shape (n,)
        The half-edge that follows round the cell.
    twin : ndarray of int, shape (n,)
        The half-edge on the other side of a joined element; -1 where nothing is joined.
    """

    kind: Ints
    cell: Ints
    element: Ints
    after: Ints
    twin: Ints


class CellComplex:
    """The cells of a decomposition and how they hang together."""

    def __init__(self, decomposition: Decomposition) -> None:
        self.decomposition = decomposition
        self.plane: Plane = decomposition.plane
        self.abscissae = decomposition.lines
        self.slabs, self.roots = decomposition.slabs, decomposition.roots
        self.wrapped = self.plane.base_range is None
        self.circle = self.plane.lift_range is None
        self.touch = TOUCH * self.plane.lift_unit
        self.n_lines = len(self.abscissae) - (1 if self.wrapped else 0)
        self.whole: Bools = self.circle & (self.roots[:, 0, 0] < 0)
        self.ends: Floats = self._ends()
        self.elements: Elements = self._elements()

    @property
    def cells(self) -> list[Cell]:
        """The cells, one by one."""
        return self.decomposition.cells

    # --- places ---------------------------------------------------------------------------------

    def interval(self, chosen: Sequence[int] | Ints, t: Floats) -> Floats:
        """Return lower and upper root of chosen cells, each over its own row of t; (2, k, n)."""
        values = self._roots(chosen, t)
        np.maximum(values[0], values[1], out=values[1])
        return values

    def _roots(self, chosen: Sequence[int] | Ints, t: Floats) -> Floats:
        bounding = self.roots[np.asarray(chosen, dtype=np.int64)].swapaxes(0, 1)
        return self.plane.follow(bounding, t)

    def spans(self, chosen: Sequence[int] | Ints) -> Floats:
        """Return the base values between which chosen cells lie, shape (k, 2)."""
        slabs = self.slabs[np.asarray(chosen, dtype=np.int64)]
        return np.asarray(self.abscissae[np.array([slabs, slabs + 1]).T])

    def placed(self, place: Floats) -> list[Placed]:
        """Return the cells within reach of base and lift values, those that hold them first.

        Reach is `TOUCH` in the units of base and lift.
        """
        t, v = map(float, place)
        bases = [t]
        if self.wrapped:  # beyond the cut of the circle, too
            t = float(first_from(self.plane.ends[0], t))
            low, high = self.plane.ends
            near = TOUCH * self.plane.base_unit
            bases = [t, *[t - TURN] * (t >= high - near), *[t + TURN] * (t <= low + near)]
        found = [one for t in bases for one in self._placed(t, v)]
        return sorted(found, key=lambda one: float(np.abs(one.off).max()))

    def _placed(self, t: float, v: float) -> list[Placed]:
        units = np.array([self.plane.base_unit, self.plane.lift_unit])
        near = TOUCH * self.plane.base_unit
        first, last = np.searchsorted(self.abscissae, [t - near, t + near])
        begin, stop = np.searchsorted(self.slabs, [first - 1, last])
        chosen = np.arange(begin, stop)
        if not len(chosen):
            return []
        start, end = self.spans(chosen).T
        low, high = self._interval_at(chosen, start, end, t)
        turns = TURN * turns_up_to(low - self.touch, v) * self.circle
        inside = np.minimum(np.maximum(v + turns, low), high)
        inside = np.where(self.whole[chosen], v + turns, inside)
        off = np.array([np.minimum(np.maximum(t, start), end) - t, inside - v - turns]).T
        reached = (np.abs(off) <= TOUCH * units).all(axis=-1)
        return [
            Placed(int(chosen[k]), np.array([t, v + turns[k]]), off[k])
            for k in np.flatnonzero(reached)
        ]

    def _interval_at(self, chosen: Ints, start: Floats, end: Floats, t: float) -> Floats:
        """Lower and upper root of cells at one base value; on a line what is meant is `ends`."""
        inset = SAME_POINT * (end - start)
        inside = np.minimum(np.maximum(t, start + inset), end - inset)
        found, ends = self.interval(chosen, inside[:, None])[..., 0], self.ends[chosen]
        found = np.where(t <= start + inset, ends[:, 0].T, found)
        return np.where(t >= end - inset, ends[:, 1].T, found)

    def _ends(self) -> Floats:
        """Lower and upper root of every cell at its left and its right line, shape (k, 2, 2).

        There an angle may jump by a turn, and where a form vanishes on a whole fibre it has no
        roots to speak of: their limit from inside the slab is meant.
        """
        start, end = self.abscissae[:-1][self.slabs, None], self.abscissae[1:][self.slabs, None]
        t = np.concatenate([start + (end - start) * INSET, end - (end - start) * INSET], axis=1)
        values = self._roots(np.arange(len(self.slabs)), t).reshape(2, -1, 2, 4)
        at, near = values[..., 0], values[..., 1]
        if self.plane.lift_kind == "revolute":
            at = at + TURN * whole_turns(near - at)
        blank = self.plane.blank(self.roots[:, :, 0].T, t[:, ::4])
        if blank.any():
            at = np.where(blank, 3 * near - 3 * values[..., 2] + values[..., 3], at)
        return np.array([at[0], np.maximum(*at)]).transpose(1, 2, 0)

    # --- lines ----------------------------------------------------------------------------------

    def _elements(self) -> Elements:
        line, low, high = self._cut_lines()
        middle = (low + high) / 2
        sides = [self._owner(line, middle, side) for side in (0, 1)]
        cell, turns = np.array([own for own, _ in sides]), np.array([turn for _, turn in sides])
        joined: Bools = np.asarray((cell >= 0).all(axis=0))
        free = self.decomposition.joined(line[joined], low[joined], high[joined])
        joined[joined] = free
        return Elements(line, low, high, cell, turns, joined)

    def _cut_lines(self) -> tuple[Ints, Floats, Floats]:
        """Cut critical lines where cells end: line, lower and upper end of each element.

        A circle closes, and without ends of cells it is one element.
        """
        kept = ~self.whole
        at = self.slabs[kept, None] + np.array([0, 1])
        at = at % self.n_lines if self.wrapped else at
        line, v = np.repeat(at.ravel(), 2), self.ends[kept].ravel()
        v = math.pi - (math.pi - v) % TURN if self.circle else v
        order = np.lexsort([v, line])
        line, v = line[order], v[order]
        new = (np.diff(line, prepend=-1) > 0) | (np.diff(v, prepend=0.0) > self.touch)
        line, v = line[new], v[new]
        first = np.flatnonzero(np.diff(line, prepend=-1))
        last = np.concatenate([first[1:], [len(line)]])[: len(first)] - 1
        if not self.circle:
            inner = np.ones(len(line), dtype=np.bool_)
            inner[last] = False
            k = np.flatnonzero(inner)
            return line[k], v[k], v[k + 1]
        high = np.append(v[1:], 0.0)[: len(v)]
        high[last] = v[first] + TURN
        double = (last > first) & (high[last] - v[last] <= self.touch)
        high[last[double] - 1] = high[last[double]]
        left = np.ones(len(line), dtype=np.bool_)
        left[last[double]] = False
        without = np.flatnonzero(np.bincount(line, minlength=self.n_lines) == 0)
        line = np.concatenate([line[left], without])
        low = np.concatenate([v[left], np.full(len(without), -math.pi)])
        high = np.concatenate([high[left], np.full(len(without), math.pi)])
        order = np.argsort(line, kind="stable")
        return line[order], low[order], high[order]

    def _owner(self, line: Ints, middle: Floats, side: int) -> tuple[Ints, Ints]:
        """Return the first cell on the left (0) or right (1) of each place, -1 for none, and turns.

        The turns bring the place into the cell's own interval at that line.
        """
        owner, turns = np.full(len(line), -1), np.zeros(len(line), dtype=np.int64)
        slab = line - 1 if side == 0 else line
        slab = slab % self.n_lines if self.wrapped else slab
        element, k = ranges(*np.searchsorted(self.slabs, [slab, slab + 1]))
        low, high = self.ends[k, 1 - side].T
        v = middle[element]
        turn = turns_up_to(low, v) * self.circle
        v = v + TURN * turn
        held = np.flatnonzero(((low < v) & (v < high)) | self.whole[k])[::-1]
        owner[element[held]], turns[element[held]] = k[held], turn[held]  # the first comes last
        return owner, turns

    # --- components -----------------------------------------------------------------------------

    def joins(self) -> Iterator[tuple[int, int, int, int]]:
        """Yield left cell, right cell, and the base and lift turns between their windings."""
        k, found = np.flatnonzero(self.elements.joined), self.elements
        base = (found.line[k] == 0) & self.wrapped
        lift = found.turns[0, k] - found.turns[1, k]
        yield from zip(*found.cell[:, k].tolist(), base.tolist(), lift.tolist(), strict=True)

    def components(self) -> list[tuple[dict[int, tuple[int, int]], tuple[bool, bool]]]:
        """Return each component: every cell's winding (turns), and which joints it goes round."""
        neighbours: dict[int, list[tuple[int, int, int]]] = {k: [] for k in range(len(self.slabs))}
        for a, b, base, lift in self.joins():
            neighbours[a].append((b, base, lift))
            neighbours[b].append((a, -base, -lift))
        found, seen = [], set[int]()
        for start in neighbours:
            if start not in seen:
                found.append(self._spread(start, neighbours))
                seen |= found[-1][0].keys()
        return found

    def _spread(
        self, start: int, neighbours: dict[int, list[tuple[int, int, int]]]
    ) -> tuple[dict[int, tuple[int, int]], tuple[bool, bool]]:
        windings = {start: (0, 0)}
        base_goes_round = lift_goes_round = False
        queue = [start]
        while queue:
            a = queue.pop()
            lift_goes_round |= bool(self.whole[a])
            for b, base, lift in neighbours[a]:
                winding = windings[a][0] + base, windings[a][1] + lift
                if b not in windings:
                    windings[b] = winding
                    queue.append(b)
                base_goes_round |= windings[b][0] != winding[0]
                lift_goes_round |= windings[b][1] != winding[1] and not self.whole[b]
        return windings, (base_goes_round, lift_goes_round)

    # --- boundaries -----------------------------------------------------------------------------

    def loops(self, cells: Collection[int]) -> list[Ints]:
        """Return the closed loops that bound a component, the component on the left.

        Rows of `half_edges`. Where two cells are joined over an element of a line, each other's
        half-edge is the way past it: what is left are the loops. A hole shorter round than TOUCH is
        a point at which a form touches zero: it bounds nothing.
        """
        first, (after, bounding, lengths) = self._first_edges, self._boundary
        rows = (row for k in cells for row in range(first[k], first[k + 1]))
        left = {row: None for row in rows if bounding[row]}
        loops = []
        while left:
            loop = [next(iter(left))]
            while (row := after[loop[-1]]) != loop[0]:
                loop.append(row)
            for row in loop:
                del left[row]
            loops.append(loop)
        long = [sum(lengths[row] for row in loop) > TOUCH for loop in loops]
        tiny = not all(long) and bool((self._sizes(cells) <= TOUCH).all())
        return [np.array(loop) for loop, kept in zip(loops, long, strict=True) if kept or tiny]

    @cached_property
    def half_edges(self) -> HalfEdges:
        """All half-edges, those of a cell together, in their order round it.

        A cell that is a whole circle has two cycles of them; any other has one.
        """
        found = self.elements
        right, left = (np.flatnonzero(found.cell[side] >= 0) for side in (0, 1))
        along = np.flatnonzero(~self.whole)
        kind = np.repeat([LOWER, UP, UPPER, DOWN], [len(along), len(right), len(along), len(left)])
        cell = np.concatenate([along, found.cell[0, right], along, found.cell[1, left]])
        element = np.full(len(kind), -1)
        element[kind == UP], element[kind == DOWN] = right, left
        order = np.lexsort([self._heights(kind, cell, element), kind, cell])
        kind, cell, element = kind[order], cell[order], element[order]
        cycle = 2 * cell + (self.whole[cell] & (kind == DOWN))
        first = np.flatnonzero(np.diff(cycle, prepend=-1))
        after = np.arange(1, len(cycle) + 1)
        after[np.concatenate([first[1:], [len(cycle)]])[: len(first)] - 1] = first
        place = np.full((2, len(found.line) + 1), -1)  # of each element's half-edges
        for row, way in enumerate((UP, DOWN)):
            here = np.flatnonzero(kind == way)
            place[row, element[here]] = here
        joined = (element >= 0) & np.append(found.joined, False)[element]
        twin = np.where(joined, place[(kind == UP).astype(int), element], -1)
        return HalfEdges(kind, cell, element, after, twin)

    def _heights(self, kind: Ints, cell: Ints, element: Ints) -> Floats:
        """Return numbers that put the half-edges on either side of a cell in order."""
        found = self.elements
        middle = np.append((found.low + found.high) / 2, 0.0)[element]
        if self.circle:
            side = (kind == UP).astype(int)
            turned = (middle - self.ends[cell, side, 0] + self.touch) % TURN
            middle = np.where(self.whole[cell], middle, turned)
        return np.where(kind == DOWN, -middle, middle)

    @cached_property
    def _first_edges(self) -> list[int]:
        """Where the half-edges of each cell begin, and where those of the last end."""
        cell, every = self.half_edges.cell, np.arange(len(self.slabs) + 1)
        found: list[int] = np.searchsorted(cell, every).tolist()
        return found

    @cached_property
    def _boundary(self) -> tuple[list[int], list[bool], list[float]]:
        """Of each half-edge: what follows past joined elements; whether it bounds; its length."""
        edges = self.half_edges
        bounding = edges.twin < 0  # round a point inside a component one would go for ever
        after = np.where(bounding, edges.after, 0)
        while len(inner := np.flatnonzero(bounding & (edges.twin[after] >= 0))):
            after[inner] = edges.after[edges.twin[after[inner]]]
        return after.tolist(), bounding.tolist(), self._lengths().tolist()

    def _sizes(self, chosen: Collection[int]) -> Floats:
        """Width or height of cells, whichever is more, in the units of base and lift."""
        k = np.array(list(chosen), dtype=np.int64)
        widths = np.diff(self.spans(k))[:, 0] / self.plane.base_unit
        heights = np.diff(self.ends[k], axis=2).max(axis=(1, 2)) / self.plane.lift_unit
        return np.asarray(np.maximum(widths, heights))

    def _lengths(self) -> Floats:
        """Length of each half-edge between its ends, in the units of base and lift together."""
        edges, found = self.half_edges, self.elements
        side = (edges.kind == UPPER).astype(int)
        heights = np.append(found.high - found.low, 0.0)[edges.element]
        widths = np.diff(self.abscissae)[self.slabs[edges.cell]] / self.plane.base_unit
        rise = np.abs(self.ends[edges.cell, 1, side] - self.ends[edges.cell, 0, side])
        lift = self.plane.lift_unit
        return np.where(edges.element >= 0, heights / lift, widths + rise / lift)
