"""From cells to components: which cells are adjacent over an open interval, and what bounds them.

Two neighbouring cells are joined across a critical line only over an open interval on which every
form is positive on that line. The boundary of a component is a set of loops of half-edges with the
component on the left: along the lower root of a cell, up or down a critical line where nothing is
joined, back along the upper root.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, first_from, turns_up_to, whole_turns
from qbound.region.decomposition import Cell, Decomposition
from qbound.region.plane import Plane, Root
from qbound.tolerances import SAME_POINT, TOUCH

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SIDES: Final = ("lower", "upper")


class Step(NamedTuple):
    """One piece of a boundary: along a root of a cell, or along an element of a critical line.

    Attributes
    ----------
    kind : {"lower", "upper", "up", "down"}
    cell : int
        The cell on its left.
    line, element : int
        Of a vertical piece; -1 otherwise.
    """

    kind: Literal["lower", "upper", "up", "down"]
    cell: int
    line: int = -1
    element: int = -1


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


@dataclass(eq=False)
class Line:
    """What meets at one critical line.

    Attributes
    ----------
    points : list of float
        Ends of cells on the line, ascending (within one turn where the lift is a circle).
    left, right : list of (int or None)
        For the element above each point: the cell on that side that owns it.
    joined : list of bool
        Whether the two owners hang together over that element.
    """

    points: list[float] = field(default_factory=list)
    left: list[int | None] = field(default_factory=list)
    right: list[int | None] = field(default_factory=list)
    joined: list[bool] = field(default_factory=list)


class CellComplex:
    """The cells of a decomposition and how they hang together."""

    def __init__(self, decomposition: Decomposition) -> None:
        self.decomposition = decomposition
        self.plane: Plane = decomposition.plane
        self.abscissae = decomposition.lines
        self.cells: list[Cell] = decomposition.cells
        self.wrapped = self.plane.base_range is None
        self.circle = self.plane.lift_range is None
        self.touch = TOUCH * self.plane.lift_unit
        self.n_lines = len(self.abscissae) - (1 if self.wrapped else 0)
        self.whole = [self.circle and cell.lower.form < 0 for cell in self.cells]
        self.ends: list[list[list[float]]] = self._ends().tolist()
        self.lines = self._lines()

    # --- places ---------------------------------------------------------------------------------

    def left_line(self, cell: int) -> int:
        """Return the critical line at which a cell begins."""
        return self.cells[cell].slab

    def right_line(self, cell: int) -> int:
        """Return the critical line at which a cell ends; a base that turns round closes."""
        after = self.cells[cell].slab + 1
        return after % self.n_lines if self.wrapped else after

    def interval(self, chosen: Sequence[int], t: Floats) -> Floats:
        """Return lower and upper root of chosen cells, each over its own row of t; (2, k, n)."""
        lower, upper = self._roots(chosen, t)
        return np.stack([lower, np.maximum(lower, upper)])

    def _roots(self, chosen: Sequence[int], t: Floats) -> Floats:
        return self.plane.follow(self._bounding(chosen), np.tile(t, (2, 1))).reshape(2, *t.shape)

    def _bounding(self, chosen: Sequence[int]) -> list[Root]:
        return [self.cells[k].lower for k in chosen] + [self.cells[k].upper for k in chosen]

    def spans(self, chosen: Sequence[int]) -> Floats:
        """Return the base values between which chosen cells lie, shape (k, 2)."""
        slabs = np.array([self.cells[k].slab for k in chosen], dtype=np.int64)
        return np.stack([self.abscissae[slabs], self.abscissae[slabs + 1]], axis=-1)

    def placed(self, place: Floats) -> list[Placed]:
        """Return the cells within reach of base and lift values, those that hold them first.

        Reach is `TOUCH` in the units of base and lift.
        """
        t, v = place
        bases = [float(t)]
        if self.wrapped:  # beyond the cut of the circle, too
            t = float(first_from(self.plane.ends[0], t))
            bases = [t, t - TURN, t + TURN]
        found = [one for t in bases for one in self._placed(t, float(v))]
        return sorted(found, key=lambda one: float(np.abs(one.off).max()))

    def _placed(self, t: float, v: float) -> list[Placed]:
        units = np.array([self.plane.base_unit, self.plane.lift_unit])
        start, end = self.spans(range(len(self.cells))).T
        near = TOUCH * self.plane.base_unit
        chosen = np.flatnonzero((start - near <= t) & (t <= end + near))
        if not len(chosen):
            return []
        low, high = self._interval_at(chosen, t)
        turns = TURN * turns_up_to(low - self.touch, v) * self.circle
        inside = np.clip(v + turns, low, high)
        inside = np.where(np.array(self.whole)[chosen], v + turns, inside)
        off = np.stack([np.clip(t, start[chosen], end[chosen]) - t, inside - v - turns], axis=-1)
        reached = (np.abs(off) <= TOUCH * units).all(axis=-1)
        return [
            Placed(int(chosen[k]), np.array([t, v + turns[k]]), off[k])
            for k in np.flatnonzero(reached)
        ]

    def _interval_at(self, chosen: Ints, t: float) -> Floats:
        """Lower and upper root of cells at one base value; on a line what is meant is `ends`."""
        start, end = self.spans(chosen.tolist()).T
        inset = SAME_POINT * (end - start)
        inside = np.clip(t, start + inset, end - inset)
        found = self.interval(chosen.tolist(), inside[:, None])[..., 0]
        ends = np.array([self.ends[k] for k in chosen]).reshape(-1, 2, 2)
        found = np.where(t <= start + inset, ends[:, 0].T, found)
        return np.where(t >= end - inset, ends[:, 1].T, found)

    def _ends(self) -> Floats:
        """Lower and upper root of every cell at its left and its right line, shape (k, 2, 2).

        There an angle may jump by a turn, and where a form vanishes on a whole fibre it has no
        roots to speak of: their limit from inside the slab is meant.
        """
        chosen = range(len(self.cells))
        spans = self.spans(chosen)
        start, width = spans[:, :1], np.diff(spans)
        inset = 1e-4 * np.array([0, 1, 2, 3])
        t = start + width * np.concatenate([inset, 1 - inset])
        values = self._roots(chosen, t).reshape(2, -1, 2, 4)
        at, near, far, farther = np.moveaxis(values, -1, 0)
        if self.plane.lift_kind == "revolute":
            at = at + TURN * whole_turns(near - at)
        blank = self.plane.blank(self._bounding(chosen), np.tile(t[:, [0, 4]], (2, 1)))
        lower, upper = np.where(blank.reshape(at.shape), 3 * near - 3 * far + farther, at)
        return np.stack([lower, np.maximum(lower, upper)], axis=-1)

    # --- lines ----------------------------------------------------------------------------------

    def _lines(self) -> list[Line]:
        left: list[list[int]] = [[] for _ in range(self.n_lines)]
        right: list[list[int]] = [[] for _ in range(self.n_lines)]
        for k in range(len(self.cells)):
            left[self.right_line(k)].append(k)
            right[self.left_line(k)].append(k)
        lines = [self._line(*sides) for sides in zip(left, right, strict=True)]
        self._join(lines)
        return lines

    def _line(self, left: list[int], right: list[int]) -> Line:
        places = [self.ends[k][1] for k in left if not self.whole[k]]
        places += [self.ends[k][0] for k in right if not self.whole[k]]
        line = Line(_clustered(chain.from_iterable(places), self.circle, self.touch))
        for e in range(self.n_elements(line)):
            middle = self._middle(line, e)
            line.left.append(self._owner(left, 1, middle))
            line.right.append(self._owner(right, 0, middle))
            line.joined.append(False)
        return line

    def _join(self, lines: list[Line]) -> None:
        """Join owners over elements on an open part of which every form is positive."""
        shared = [
            (i, e, *self.bounds(line, e))
            for i, line in enumerate(lines)
            for e in range(len(line.joined))
            if line.left[e] is not None and line.right[e] is not None
        ]
        where, low, high = np.array([(i, a, b) for i, _, a, b in shared]).reshape(-1, 3).T
        free = self.decomposition.joined(where.astype(np.int64), low, high)
        for (i, e, *_), joined in zip(shared, free.tolist(), strict=True):
            lines[i].joined[e] = joined

    def n_elements(self, line: Line) -> int:
        """Elements between points; a circle closes, and without points is one element."""
        return max(len(line.points), 1) if self.circle else max(len(line.points) - 1, 0)

    def bounds(self, line: Line, e: int) -> tuple[float, float]:
        """Lower and upper end of an element."""
        if not line.points:
            return -math.pi, math.pi
        low = line.points[e]
        return low, line.points[e + 1] if e + 1 < len(line.points) else line.points[0] + TURN

    def _middle(self, line: Line, e: int) -> float:
        return sum(self.bounds(line, e)) / 2

    def _owner(self, cells: list[int], side: int, v: float) -> int | None:
        return next((k for k in cells if self.turns_into(k, side, v) is not None), None)

    def turns_into(self, cell: int, side: int, v: float) -> int | None:
        """Full turns that bring v into a cell's interval at its left (0) or right (1) line."""
        low, high = self.ends[cell][side]
        turns = math.ceil((low - v) / TURN) if self.circle else 0
        if self.whole[cell]:  # a full circle holds every v
            return turns
        return turns if low < v + TURN * turns < high else None

    # --- components -----------------------------------------------------------------------------

    def joins(self) -> Iterator[tuple[int, int, int, int]]:
        """Yield left cell, right cell, and the base and lift turns between their windings."""
        for i, line in enumerate(self.lines):
            for e, joined in enumerate(line.joined):
                a, b, v = line.left[e], line.right[e], self._middle(line, e)
                if joined and a is not None and b is not None:
                    lift = (self.turns_into(a, 1, v) or 0) - (self.turns_into(b, 0, v) or 0)
                    yield a, b, int(self.wrapped and i == 0), lift

    def components(self) -> list[tuple[dict[int, tuple[int, int]], tuple[bool, bool]]]:
        """Return each component: every cell's winding (turns), and which joints it goes round."""
        neighbours: dict[int, list[tuple[int, int, int]]] = {k: [] for k in range(len(self.cells))}
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
            lift_goes_round |= self.whole[a]
            for b, base, lift in neighbours[a]:
                winding = windings[a][0] + base, windings[a][1] + lift
                if b not in windings:
                    windings[b] = winding
                    queue.append(b)
                base_goes_round |= windings[b][0] != winding[0]
                lift_goes_round |= windings[b][1] != winding[1] and not self.whole[b]
        return windings, (base_goes_round, lift_goes_round)

    # --- boundaries -----------------------------------------------------------------------------

    def loops(self, cells: Collection[int]) -> list[list[Step]]:
        """Return the closed loops that bound a component, the component on the left.

        The half-edges round each cell are a cycle. Where two cells are joined over an element of a
        line, each other's half-edge is the way past it: what is left are the loops. A hole shorter
        round than TOUCH is a point at which a form touches zero: it bounds nothing.
        """
        after = {
            one: other for k in cells for cycle in self._cycles(k) for one, other in _ring(cycle)
        }
        left_over = {step: None for step in after if not self._joined(step)}
        loops = []
        while left_over:
            loop = [next(iter(left_over))]
            while (step := self._past_joined(after, loop[-1])) != loop[0]:
                loop.append(step)
            loops.append(loop)
            for step in loop:
                del left_over[step]
        tiny = all(self._size(k) <= TOUCH for k in cells)
        return [loop for loop in loops if tiny or sum(map(self._length, loop)) > TOUCH]

    def _cycles(self, k: int) -> list[list[Step]]:
        """Return the half-edges round a cell, the cell on the left; a whole one has two cycles."""
        i, j = self.left_line(k), self.right_line(k)
        up = [Step("up", k, j, e) for e in self._elements(j, k, 1)]
        down = [Step("down", k, i, e) for e in reversed(self._elements(i, k, 0))]
        if self.whole[k]:
            return [up, down]
        return [[Step("lower", k), *up, Step("upper", k), *down]]

    def _elements(self, i: int, k: int, side: int) -> list[int]:
        """Return the elements of a line that are a cell's right (1) or left (0) side, upwards."""
        line = self.lines[i]
        owned = [e for e, cell in enumerate(line.left if side else line.right) if cell == k]
        if self.whole[k] or not owned:
            return owned
        low = self.ends[k][side][0] - self.touch
        return sorted(
            owned, key=lambda e: (self._middle(line, e) - low) % TURN if self.circle else e
        )

    def _joined(self, step: Step) -> bool:
        return step.line >= 0 and self.lines[step.line].joined[step.element]

    def _past_joined(self, after: Mapping[Step, Step], step: Step) -> Step:
        """Return what follows a half-edge on the boundary, past joined elements."""
        step = after[step]
        while self._joined(step):
            line = self.lines[step.line]
            up = step.kind == "up"
            other = (line.right if up else line.left)[step.element]
            twin = Step("down" if up else "up", other or 0, step.line, step.element)
            step = after[twin]
        return step

    def _size(self, k: int) -> float:
        """Width or height of a cell, whichever is more, in the units of base and lift."""
        left, right = self.abscissae[self.cells[k].slab :][:2]
        height = max(high - low for low, high in self.ends[k])
        return float(max((right - left) / self.plane.base_unit, height / self.plane.lift_unit))

    def _length(self, step: Step) -> float:
        """Length of a step between its ends, in the units of base and lift together."""
        if step.line >= 0:
            low, high = self.bounds(self.lines[step.line], step.element)
            return (high - low) / self.plane.lift_unit
        slab, k = self.cells[step.cell].slab, SIDES.index(step.kind)
        (left, right), ends = self.abscissae[slab : slab + 2], self.ends[step.cell]
        along = (right - left) / self.plane.base_unit
        return float(along + abs(ends[1][k] - ends[0][k]) / self.plane.lift_unit)


def _ring(cycle: Sequence[Step]) -> Iterator[tuple[Step, Step]]:
    """Yield each half-edge of a cycle with the one after it."""
    return zip(cycle, [*cycle[1:], *cycle[:1]], strict=True)


def _clustered(values: Iterable[float], circle: bool, touch: float) -> list[float]:
    """Sort values and keep one of each group closer than `touch`; on a circle within (-pi, pi]."""
    kept: list[float] = []
    before = -math.inf
    for v in sorted(math.pi - (math.pi - v) % TURN for v in values) if circle else sorted(values):
        if v - before > touch:
            kept.append(v)
        before = v
    if circle and len(kept) > 1 and kept[0] + TURN - kept[-1] <= touch:
        kept.pop()
    return kept
