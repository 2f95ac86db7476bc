"""From cells to components and their boundaries: which cells hang together, and what encloses them.

Two neighbouring cells are joined across a critical line only over an open interval on which every
form is positive on that line. The boundary of a component is walked with the component on the left:
along the lower root of a cell, up or down a critical line where nothing is joined, back along the
upper root.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from qbound.decomposition import TURN, Cell, Decomposition, Plane, Root
from qbound.harmonic import basis
from qbound.tolerances import POSITIVE, TANGENT, TOUCH

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Step:
    """One piece of a boundary: along a root of a cell, or along an element of a critical line.

    Attributes
    ----------
    kind : {"lower", "upper", "up", "down"}
    cell : int
        The cell on its left.
    line, element : int
        Of a vertical piece; -1 otherwise.
    """

    kind: str
    cell: int
    line: int = -1
    element: int = -1


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


class Complex:
    """The cells of a decomposition and how they hang together."""

    def __init__(self, decomposition: Decomposition) -> None:
        self.plane: Plane = decomposition.plane
        self.abscissae = decomposition.lines
        self.cells: list[Cell] = decomposition.cells
        self.wrapped = self.plane.base_range is None
        self.circle = self.plane.lift_range is None
        self.n_lines = len(self.abscissae) - (1 if self.wrapped else 0)
        self.ends = [self._ends(cell) for cell in self.cells]
        self.lines = [self._line(i) for i in range(self.n_lines)]

    # --- places ---------------------------------------------------------------------------------

    def left_line(self, cell: int) -> int:
        """Return the critical line at which a cell begins."""
        return self.cells[cell].slab

    def right_line(self, cell: int) -> int:
        """Return the critical line at which a cell ends; a base that turns round closes."""
        return (
            (self.cells[cell].slab + 1) % self.n_lines
            if self.wrapped
            else self.cells[cell].slab + 1
        )

    def root_values(self, root: Root | None, slab: int, t: Floats) -> Floats:
        """Evaluate a root anywhere in its closed slab, continuous up to both ends."""
        if root is None:
            return np.full_like(t, -math.pi)
        if root.form < 0:
            return np.full_like(t, self.plane.lift_ends[-1 - root.form])
        return _root_values(self.plane, root, t, *self.abscissae[slab : slab + 2])

    def _ends(self, cell: Cell) -> Floats:
        """Lower and upper root of a cell at its left and its right line, shape (2, 2)."""
        t = self.abscissae[cell.slab : cell.slab + 2]
        lower = self.root_values(cell.lower, cell.slab, t)
        upper = lower + TURN if cell.upper is None else self.root_values(cell.upper, cell.slab, t)
        return np.stack([lower, np.maximum(lower, upper)], axis=-1)

    # --- lines ----------------------------------------------------------------------------------

    def _line(self, i: int) -> Line:
        left = [k for k in range(len(self.cells)) if self.right_line(k) == i]
        right = [k for k in range(len(self.cells)) if self.left_line(k) == i]
        places = [self.ends[k][1] for k in left if self.cells[k].lower or not self.circle]
        places += [self.ends[k][0] for k in right if self.cells[k].lower or not self.circle]
        points = _clustered(np.concatenate([np.zeros(0), *places]), self.circle)
        line = Line(points)
        for e in range(self.n_elements(line)):
            middle = self._middle(line, e)
            one, other = self._owner(left, 1, middle), self._owner(right, 0, middle)
            line.left.append(one)
            line.right.append(other)
            line.joined.append(one is not None and other is not None and self._open(i, line, e))
        return line

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
        if self.cells[cell].upper is None:  # a full circle holds every v
            return turns
        return turns if low < v + TURN * turns < high else None

    def _open(self, i: int, line: Line, e: int) -> bool:
        """Tell whether every form is positive on an open part of the element."""
        low, high = self.bounds(line, e)
        v = low + (high - low) * np.array([0.29, 0.5, 0.77])
        values = self.plane.values(np.full(3, self.abscissae[i]), v)
        return bool((values > POSITIVE).all(axis=1).any())

    # --- components -----------------------------------------------------------------------------

    def joins(self) -> Iterator[tuple[int, int, int, int]]:
        """Yield left cell, right cell, and the base and lift turns between their sheets."""
        for i, line in enumerate(self.lines):
            for e, joined in enumerate(line.joined):
                a, b, v = line.left[e], line.right[e], self._middle(line, e)
                if joined and a is not None and b is not None:
                    lift = (self.turns_into(a, 1, v) or 0) - (self.turns_into(b, 0, v) or 0)
                    yield a, b, int(self.wrapped and i == 0), lift

    def components(self) -> list[tuple[dict[int, tuple[int, int]], tuple[bool, bool]]]:
        """Return each component: every cell's sheet (turns), and which joints it goes round."""
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
        sheets = {start: (0, 0)}
        base_goes_round = lift_goes_round = False
        queue = [start]
        while queue:
            a = queue.pop()
            lift_goes_round |= self.cells[a].upper is None
            for b, base, lift in neighbours[a]:
                sheet = sheets[a][0] + base, sheets[a][1] + lift
                if b not in sheets:
                    sheets[b] = sheet
                    queue.append(b)
                base_goes_round |= sheets[b][0] != sheet[0]
                lift_goes_round |= sheets[b][1] != sheet[1] and self.cells[b].upper is not None
        return sheets, (base_goes_round, lift_goes_round)

    # --- boundaries -----------------------------------------------------------------------------

    def loops(self, cells: set[int]) -> list[list[Step]]:
        """Return the closed walks that bound a component, the component on the left."""
        steps = [Step(kind, k) for k in cells for kind in ("lower", "upper") if self.cells[k].lower]
        for i, line in enumerate(self.lines):
            for e, joined in enumerate(line.joined):
                if not joined and line.left[e] in cells:
                    steps.append(Step("up", line.left[e] or 0, i, e))
                if not joined and line.right[e] in cells:
                    steps.append(Step("down", line.right[e] or 0, i, e))
        loops, left_over = [], set(steps)
        for first in steps:
            if first in left_over:
                loops.append(self._walk(first))
                left_over -= set(loops[-1])
        return loops

    def _walk(self, first: Step) -> list[Step]:
        walk = [first]
        while (step := self._next(walk[-1])) != first:
            walk.append(step)
            if len(walk) > 8 * len(self.cells) + 8 * len(self.lines) + 64:
                raise ArithmeticError("the boundary of a component does not close")
        return walk

    def _next(self, step: Step) -> Step:
        if step.kind == "lower":
            return self._after_lower(step.cell)
        if step.kind == "upper":
            return self._after_upper(step.cell)
        line = self.lines[step.line]
        if not line.points:  # a full circle closes on itself
            return step
        n = len(line.points)
        if step.kind == "up":
            top = (step.element + 1) % n
            if (
                self.cells[step.cell].lower
                and self._point(step.line, self.ends[step.cell][1][1]) == top
            ):
                return Step("upper", step.cell)
            return self._turn_right_side(step.line, top)
        if (
            self.cells[step.cell].lower
            and self._point(step.line, self.ends[step.cell][0][0]) == step.element
        ):
            return Step("lower", step.cell)
        return self._turn_left_side(step.line, step.element)

    def _after_lower(self, a: int) -> Step:
        i = self.right_line(a)
        low, high = (self._point(i, v) for v in self.ends[a][1])
        if low == high and self.ends[a][1][1] - self.ends[a][1][0] < math.pi:
            return Step("upper", a)
        return self._turn_right_side(i, low)

    def _after_upper(self, b: int) -> Step:
        i = self.left_line(b)
        low, high = (self._point(i, v) for v in self.ends[b][0])
        if low == high and self.ends[b][0][1] - self.ends[b][0][0] < math.pi:
            return Step("lower", b)
        return self._turn_left_side(i, high)

    def _turn_right_side(self, i: int, p: int) -> Step:
        """Turn clockwise about point p from above on the left: over the line, down, and back."""
        line, below = self.lines[i], (p - 1) % len(self.lines[i].points)
        b = line.right[p]
        if not line.joined[p] or b is None:
            return Step("up", line.left[p] or 0, i, p)
        if self.cells[b].lower and self._point(i, self.ends[b][0][0]) == p:
            return Step("lower", b)
        if not line.joined[below]:
            return Step("down", b, i, below)
        return Step("upper", line.left[below] or 0)

    def _turn_left_side(self, i: int, p: int) -> Step:
        """Turn clockwise about point p from below on the right: over the line, up, and back."""
        line, below = self.lines[i], (p - 1) % len(self.lines[i].points)
        a = line.left[below]
        if not line.joined[below] or a is None:
            return Step("down", line.right[below] or 0, i, below)
        if self.cells[a].lower and self._point(i, self.ends[a][1][1]) == p:
            return Step("upper", a)
        if not line.joined[p]:
            return Step("up", a, i, p)
        return Step("lower", line.right[p] or 0)

    def _point(self, i: int, v: float) -> int:
        """Index of the point of a line nearest to v, on the circle where the lift is one."""
        gaps = np.asarray(self.lines[i].points) - v
        if self.circle:
            gaps = (gaps + math.pi) % TURN - math.pi
        return int(np.abs(gaps).argmin())


def _root_values(plane: Plane, root: Root, t: Floats, start: float, end: float) -> Floats:
    values = _raw_root(plane, root, t)
    at_end = (t <= start) | (t >= end)
    if plane.lift_kind == "revolute" and at_end.any():  # atan2 jumps at most there
        values[at_end] = _end_values(plane, root, t[at_end], start, end, values[at_end])
    return values


def _end_values(
    plane: Plane, root: Root, t: Floats, start: float, end: float, values: Floats
) -> Floats:
    """Bring values at the ends of a slab to the turn, and to the limit, seen from inside."""
    near, far = (
        _raw_root(plane, root, np.clip(t, start + inset, end - inset))
        for inset in (1e-4 * (end - start), 2e-4 * (end - start))
    )
    values = values + TURN * np.round((near - values) / TURN)
    # Where a form vanishes on a whole fibre its roots turn over: theirs is the limit from inside.
    turned = np.abs(values - near) > 1
    limit = near + np.where(np.abs(near - far) < 1, near - far, 0)
    return np.where(turned, limit, values)


def _raw_root(plane: Plane, root: Root, t: Floats) -> Floats:
    c0, c1, c2 = (basis(plane.base_kind, t) @ plane.table[root.form]).T
    if plane.lift_kind == "revolute":
        d = np.hypot(c1, c2)
        ratio = np.divide(-c0, d, out=np.zeros_like(d), where=d > 0)
        ratio = np.where(np.abs(np.abs(ratio) - 1) <= TANGENT, np.sign(ratio), ratio)
        alpha = np.arccos(np.clip(ratio, -1, 1))
        return np.asarray(np.arctan2(c2, c1) + root.branch * alpha + TURN * root.turns)
    low, high = plane.lift_ends
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = np.sqrt(np.maximum(c1 * c1 - 4 * c0 * c2, 0))
        half = -(c1 + np.copysign(spread, c1)) / 2
        pair = np.sort(np.stack([half / c2, c0 / half]), axis=0)[(root.branch + 1) // 2]
        single = -c0 / c1
    affine = not plane.table[root.form, :, 2].any()
    return np.asarray(np.clip(np.nan_to_num(single if affine else pair), low, high))


def _clustered(values: Floats, circle: bool) -> list[float]:
    """Sort values and keep one of each group closer than TOUCH; on a circle within (-pi, pi]."""
    if circle:
        values = math.pi - (math.pi - values) % TURN
    values = np.sort(values)
    kept = [
        float(v)
        for v, gap in zip(values, np.diff(values, prepend=-np.inf), strict=True)
        if gap > TOUCH
    ]
    if circle and len(kept) > 1 and kept[0] + TURN - kept[-1] <= TOUCH:
        kept.pop()
    return kept
