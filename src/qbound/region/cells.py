"""From cells to components: which cells are adjacent over an open interval.

Two neighbouring cells are joined across a critical line only over an open interval on which every
form is positive on that line.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, first_from, turns_up_to, whole_turns
from qbound.region.decomposition import Cell, Decomposition
from qbound.region.plane import Plane, ranges, runs, which
from qbound.tolerances import SAME_POINT, TOUCH

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

INSET = 1e-4 * np.arange(4)
"""Where cells are looked at beside their lines, in parts of their width."""


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


class Parts(NamedTuple):
    """Components as sets of cells.

    Attributes
    ----------
    cells : list of list of int
        Those of each component.
    wraps : list of two bool
        Whether a component goes round the base, and round the lift.
    windings : ndarray of int, shape (cells, 2)
        Turns of base and lift at which each cell lies within its component.
    """

    cells: list[list[int]]
    wraps: list[tuple[bool, bool]]
    windings: Ints

    def of_cells(self) -> Ints:
        """Return the component of each cell, by index."""
        part = np.empty(len(self.windings), dtype=np.int64)
        counts = list(map(len, self.cells))
        part[list(chain(*self.cells))] = np.arange(len(counts)).repeat(counts)
        return part


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
        bounding = self.roots[np.asarray(chosen, dtype=np.int64)].swapaxes(0, 1)
        values = self.plane.follow(bounding, t)
        np.maximum(values[0], values[1], out=values[1])
        return values

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
            low, high = self.plane.ends
            t = float(first_from(low, t))
            near = TOUCH * self.plane.base_unit
            bases = [t, *[t - TURN] * (t >= high - near), *[t + TURN] * (t <= low + near)]
        found = [one for t in bases for one in self._placed(t, v)]
        return sorted(found, key=lambda one: float(np.abs(one.off).max()))

    def _placed(self, t: float, v: float) -> list[Placed]:
        units = np.array([self.plane.base_unit, self.plane.lift_unit])
        near = TOUCH * self.plane.base_unit
        first, last = self.abscissae.searchsorted([t - near, t + near])
        begin, stop = self.slabs.searchsorted([first - 1, last])
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
        return [Placed(int(chosen[k]), np.array([t, v + turns[k]]), off[k]) for k in which(reached)]

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
        inset = (end - start) * INSET
        t = np.concatenate([start + inset, end - inset], axis=1)
        roots = self.roots.swapaxes(0, 1)
        c = self.plane.coefficients(roots[..., 0], t)
        values = self.plane.values(roots, c).reshape(2, -1, 2, 4)
        at, near = values[..., 0], values[..., 1]
        if self.plane.lift_kind == "revolute":
            at = at + TURN * whole_turns(near - at)
        blank = self.plane.blank(roots[..., 0], c[..., ::4])
        if blank.any():
            at = np.where(blank, 3 * near - 3 * values[..., 2] + values[..., 3], at)
        return np.array([at[0], np.maximum(*at)]).transpose(1, 2, 0)

    # --- lines ----------------------------------------------------------------------------------

    def _elements(self) -> Elements:
        line, low, high = self._cut_lines()
        middle = (low + high) / 2
        cell, turns = self._owners(line, middle)
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
        line, v = at.ravel().repeat(2), self.ends[kept].ravel()
        v = math.pi - (math.pi - v) % TURN if self.circle else v
        order = np.lexsort([v, line])
        line, v = line[order], v[order]
        new = np.ones(len(line), dtype=np.bool_)
        new[1:] = (line[1:] > line[:-1]) | (v[1:] - v[:-1] > self.touch)
        line, low = line[new], v[new]
        if not self.circle:
            k = which(line[1:] == line[:-1])
            return line[k], low[k], low[k + 1]
        first, last = runs(line)
        high = np.empty(len(low))
        high[:-1], high[last] = low[1:], low[first] + TURN
        double = last[(last > first) & (high[last] - low[last] <= self.touch)]
        if len(double):
            high[double - 1] = high[double]
            line, low, high = (np.delete(x, double) for x in (line, low, high))
        if len(first) < self.n_lines:
            without = which(np.bincount(line, minlength=self.n_lines) == 0)
            at = np.searchsorted(line, without)
            line = np.insert(line, at, without)
            low, high = np.insert(low, at, -math.pi), np.insert(high, at, math.pi)
        return line, low, high

    def _owners(self, line: Ints, middle: Floats) -> tuple[Ints, Ints]:
        """Return the first cells on the left and right of places, -1 for none, and turns, (2, n).

        The turns bring a place into the cell's own interval at that line.
        """
        n = len(line)
        owner, turns = np.full(2 * n, -1), np.zeros(2 * n, dtype=np.int64)
        slab = np.concatenate([line - 1, line])
        slab = slab % self.n_lines if self.wrapped else slab
        at, k = ranges(self.slabs.searchsorted(slab), self.slabs.searchsorted(slab + 1))
        low, high = self.ends[k, (at < n).astype(int)].T
        v = middle[at % n]
        turn = turns_up_to(low, v) * self.circle
        v = v + TURN * turn
        held = which(((low < v) & (v < high)) | self.whole[k])[::-1]
        owner[at[held]], turns[at[held]] = k[held], turn[held]  # the first comes last
        return owner.reshape(2, n), turns.reshape(2, n)

    # --- components -----------------------------------------------------------------------------

    def _neighbours(self) -> list[list[tuple[int, int, int]]]:
        """Return of each cell those joined to it, and the base and lift turns to their windings."""
        k, found = which(self.elements.joined), self.elements
        base = ((found.line[k] == 0) & self.wrapped).astype(int)
        lift = found.turns[0, k] - found.turns[1, k]
        neighbours: list[list[tuple[int, int, int]]] = [[] for _ in self.slabs]
        joins = zip(*found.cell[:, k].tolist(), base.tolist(), lift.tolist(), strict=True)
        for a, b, base_turns, lift_turns in joins:
            neighbours[a].append((b, base_turns, lift_turns))
            neighbours[b].append((a, -base_turns, -lift_turns))
        return neighbours

    @cached_property
    def parts(self) -> Parts:
        """The components as sets of cells."""
        neighbours, whole = self._neighbours(), self.whole
        windings, cells, wraps = dict[int, tuple[int, int]](), [], []
        for start in range(len(self.slabs)):
            if start not in windings:
                own, around_base, around_lift = _spread(start, neighbours, windings)
                cells.append(own)
                wraps.append((around_base, around_lift or bool(whole[own].any())))
        table = np.zeros((len(self.slabs), 2), dtype=np.int64)
        if windings:
            table[list(windings)] = list(windings.values())
        return Parts(cells, wraps, table)


def _spread(
    start: int,
    neighbours: list[list[tuple[int, int, int]]],
    windings: dict[int, tuple[int, int]],
) -> tuple[list[int], bool, bool]:
    """Give the cells of a component their windings; return them, and what it goes round.

    It goes round base or lift where two ways to a cell end at different windings.
    """
    windings[start] = 0, 0
    cells, queue = [start], [start]
    around_base = around_lift = False
    while queue:
        a = queue.pop()
        base, lift = windings[a]
        for b, base_turns, lift_turns in neighbours[a]:
            winding = base + base_turns, lift + lift_turns
            known = windings.setdefault(b, winding)
            if known is winding:
                cells.append(b)
                queue.append(b)
            elif known != winding:
                around_base |= known[0] != winding[0]
                around_lift |= known[1] != winding[1]
    return cells, around_base, around_lift
