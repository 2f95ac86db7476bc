"""The feasible region of two joints, complete: components, labelled arcs, vertices, measures.

By the clearance rule every boundary in use keeps its distance. By the paper's rule the windows of
Table 6 are limits and the half-spaces cut; the same decomposition serves both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arcs import NODES, Arc, Pieces, legendre
from qbound.boundary import clearance, pair_vector, required_distance
from qbound.cells import Complex, Step
from qbound.decomposition import TURN, Plane, Range, Root, decompose
from qbound.harmonic import HarmonicForm, basis, basis_slope
from qbound.robot import HalfSpace, Pair, Robot
from qbound.tolerances import QUADRATURE, TRANSVERSAL

Floats = NDArray[np.float64]
Sheets = dict[int, tuple[int, int]]
Item = TypeVar("Item")


@dataclass(frozen=True, eq=False)
class Problem:
    """Forms of two joints with names, and the ranges within which they count.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
    names : tuple of str
        One a form.
    ranges : tuple of two (low, high) or None
        None for a joint that turns all the way round.
    limits : tuple of two (str, str)
        Names of the lower and the upper end of each range.
    """

    forms: HarmonicForm
    names: tuple[str, ...]
    ranges: tuple[Range, Range]
    limits: tuple[tuple[str, str], tuple[str, str]]


@dataclass(frozen=True, eq=False)
class Vertex:
    """A point of the boundary where two boundaries meet."""

    q: Floats
    boundaries: tuple[str, str]


@dataclass(frozen=True, eq=False)
class Component:
    """A connected piece of the region.

    Attributes
    ----------
    area : float
        Product of the two joints' units.
    centroid : ndarray, shape (2,), or None
        Of the area; None where the component goes round a joint.
    wraps : tuple of two bool
        Whether it goes all the way round each joint.
    loops : tuple of tuple of Arc
        The closed walks that bound it, the component on the left.
    vertices : tuple of Vertex
        In the order of the loops.
    contains_home : bool
    """

    area: float
    centroid: Floats | None
    wraps: tuple[bool, bool]
    loops: tuple[tuple[Arc, ...], ...]
    vertices: tuple[Vertex, ...]
    contains_home: bool


@dataclass(frozen=True, eq=False)
class Region:
    """All components, the one with the home pose first, the others by falling area."""

    components: tuple[Component, ...]
    problem: Problem

    @property
    def home(self) -> Component | None:
        """The component with the home pose."""
        return next((c for c in self.components if c.contains_home), None)

    @property
    def area(self) -> float:
        """Sum of all components' areas."""
        return sum(component.area for component in self.components)


def clearance_problem(robot: Robot, held: Mapping[int, float] | None = None) -> Problem:
    """State the clearance rule: every boundary in use, and the joints' limits (eqs. 10-12).

    Parameters
    ----------
    held : mapping of int to float, optional
        Values of the joints that are held, all but two; rad or length.

    Raises
    ------
    ValueError
        If not exactly two joints are left free.
    """
    held = held or {}
    free = [joint for j, joint in enumerate(robot.joints) if j not in held]
    if len(free) != 2:
        raise ValueError(f"a region has two joints; {robot.name} has {len(free)} that are not held")
    used = [boundary for boundary in robot.boundaries if boundary.used]
    limits = [(f"{joint.name}.lower", f"{joint.name}.upper") for joint in free]
    return state(robot, used, [joint.limits for joint in free], limits, held)


def state(
    robot: Robot,
    used: Sequence[Pair | HalfSpace],
    ranges: Sequence[Range],
    limits: Sequence[tuple[str, str]],
    held: Mapping[int, float] | None = None,
) -> Problem:
    """Gather the clearance forms of some boundaries within given ranges of two joints."""
    forms = np.array([clearance(robot, boundary).coefficients for boundary in used])
    stacked = HarmonicForm(forms.reshape(-1, *(3,) * len(robot.joints)), robot.kinds)
    names = tuple(boundary.name for boundary in used)
    stacked = stacked.restrict(held) if held else stacked
    return Problem(stacked, names, (ranges[0], ranges[1]), (limits[0], limits[1]))


def solve(problem: Problem, home: ArrayLike) -> Region:
    """Find every component of { all forms > 0, within the ranges }.

    Parameters
    ----------
    home : array_like, shape (2,)
        Configuration that names the first component and around which it is unrolled.

    Notes
    -----
    A component is open; touching in points or curves neither joins components nor makes one.
    """
    base = 1 if problem.forms.kinds == ("prismatic", "revolute") else 0
    plane = Plane(problem.forms, problem.ranges, base)
    builder = _Builder(problem, Complex(decompose(plane)), base, np.asarray(home, dtype=float))
    components = builder.components()
    return Region(tuple(sorted(components, key=lambda c: (not c.contains_home, -c.area))), problem)


def find_region(robot: Robot, held: Mapping[int, float] | None = None) -> Region:
    """Return the region of two joints by the clearance rule; arguments as `clearance_problem`."""
    held = held or {}
    home = [value for j, value in enumerate(robot.home) if j not in held]
    return solve(clearance_problem(robot, held), home)


def violated(robot: Robot, q: ArrayLike) -> list[tuple[str, float]]:
    """Return the boundaries that a configuration violates, with their margins (negative).

    Margins are lengths for boundaries (``|B| - d_min``, or the depth beyond a wall), joint units
    for limits. An empty list: feasible.
    """
    q = np.asarray(q, dtype=float)
    margins = [(b.name, _margin(robot, b, q)) for b in robot.boundaries if b.used]
    for joint, value in zip(robot.joints, q, strict=True):
        if joint.limits is not None:
            margins.append((f"{joint.name}.lower", float(value - joint.limits[0])))
            margins.append((f"{joint.name}.upper", float(joint.limits[1] - value)))
    return [(name, margin) for name, margin in margins if margin < 0]


def _margin(robot: Robot, boundary: Pair | HalfSpace, q: Floats) -> float:
    if isinstance(boundary, HalfSpace):
        return float(clearance(robot, boundary)(q))
    distance = np.linalg.norm(pair_vector(robot, boundary)(q))
    return float(distance) - required_distance(robot, boundary)


class _Builder:
    """Turns components' cells into arcs, vertices and measures, in the order of the joints."""

    def __init__(self, problem: Problem, cells: Complex, base: int, home: Floats) -> None:
        self.problem, self.cells, self.base = problem, cells, base
        self.plane = cells.plane
        self.circles = np.array([r is None for r in (self.plane.base_range, self.plane.lift_range)])
        self.home = self._ordered(home)
        self.at_home = self._cell_of_home() if (problem.forms(home) > 0).all() else None
        self.moments = _cell_moments(cells)

    def components(self) -> list[Component]:
        return [self._component(*found) for found in self.cells.components()]

    def _component(self, sheets: Sheets, wraps: tuple[bool, bool]) -> Component:
        chosen, turns = list(sheets), TURN * np.array(list(sheets.values()), dtype=float)
        areas, firsts = self.moments[chosen, 0], self.moments[chosen, 1:]
        area = float(areas.sum())
        middle = (firsts + areas[:, None] * turns).sum(axis=0) / area
        shift = np.zeros(2)
        if self.at_home is not None and self.at_home[0] in sheets:
            shift = self.home - self.at_home[1] - TURN * np.array(sheets[self.at_home[0]])
        elif not any(wraps):
            shift = -TURN * np.ceil((middle - math.pi) / TURN) * self.circles
        loops = self._loops(sheets, shift)
        return Component(
            area,
            None if any(wraps) else self._ordered(middle + shift),
            (wraps[self.base], wraps[1 - self.base]),
            loops,
            tuple(_vertices(loops)),
            self.at_home is not None and self.at_home[0] in sheets,
        )

    def _ordered(self, place: Floats) -> Floats:
        """From (base, lift) to the order of the joints, and back."""
        return place if self.base == 0 else place[..., ::-1]

    def _cell_of_home(self) -> tuple[int, Floats] | None:
        """Return the cell with the home pose and where home is in the cell's own coordinates."""
        t, v = self.home
        low = self.plane.ends[0]
        t = t - TURN * math.floor((t - low) / TURN) if self.circles[0] else t
        start, end = self.cells.spans(range(len(self.cells.cells))).T
        chosen = np.flatnonzero((start <= t) & (t <= end))
        inset = 1e-12 * (end - start)[chosen]  # on a line an angle may jump by a turn
        inside = np.clip(t, start[chosen] + inset, end[chosen] - inset)
        lower, upper = self.cells.interval(chosen.tolist(), inside[:, None])[..., 0]
        turns = TURN * np.ceil((lower - v) / TURN) * self.circles[1]
        for k in np.flatnonzero((lower <= v + turns) & (v + turns <= upper)):
            return int(chosen[k]), np.array([t, v + turns[k]])
        return None

    # --- arcs -----------------------------------------------------------------------------------

    def _loops(self, sheets: Sheets, shift: Floats) -> tuple[tuple[Arc, ...], ...]:
        return tuple(tuple(self._arcs(walk, sheets, shift)) for walk in self.cells.loops(sheets))

    def _arcs(self, walk: list[Step], sheets: Sheets, shift: Floats) -> list[Arc]:
        """Merge the steps of a walk that stay on one branch of one boundary."""
        labels = [self._label(step) for step in walk]
        first = next((i for i in range(len(walk)) if labels[i] != labels[i - 1]), 0)
        walk, labels = walk[first:] + walk[:first], labels[first:] + labels[:first]
        if self.base == 1:  # seen with the joints in their order, the walk runs backwards
            walk, labels = walk[::-1], labels[::-1]
        pieces = self._pieces(walk, sheets, shift)
        groups = [list(g) for _, g in groupby(range(len(walk)), key=labels.__getitem__)]
        spans = [slice(group[0], group[-1] + 1) for group in groups]
        self._polish(pieces, [labels[span.start][0] for span in spans], spans)
        points = pieces.places(np.linspace(-math.pi / 2, math.pi / 2, 33))
        few = np.array(pieces.straight())
        return [
            Arc(*labels[span.start], _polyline(points[span], few[span]), pieces[span])
            for span in spans
        ]

    def _label(self, step: Step) -> tuple[str, int | None]:
        if step.kind in ("up", "down"):
            return self._wall_label(step)
        cell = self.cells.cells[step.cell]
        root = cell.lower if step.kind == "lower" else cell.upper
        if root.form < 0:
            return self.problem.limits[1 - self.base][-1 - root.form], None
        branch = root.branch if self.plane.lift_kind == "revolute" else None
        return self.problem.names[root.form], branch

    def _wall_label(self, step: Step) -> tuple[str, int | None]:
        """Name a piece of a critical line: a limit of the base, or a form without the lift."""
        plane, t = self.plane, self.cells.abscissae[step.line]
        side = 0 if step.kind == "down" else 1
        if plane.base_range is not None and t == plane.ends[side]:
            return self.problem.limits[self.base][side], None
        low, high = self.cells.bounds(self.cells.lines[step.line], step.element)
        rows = plane.along_lift(np.array([t]))[0]
        form = int(np.abs(rows @ basis(plane.lift_kind, (low + high) / 2)).argmin())
        # A form falls along the base at theta + arccos; there the component lies before it.
        branch = (1 if step.kind == "up" else -1) if plane.base_kind == "revolute" else None
        return self.problem.names[form], branch

    def _pieces(self, walk: list[Step], sheets: Sheets, shift: Floats) -> Pieces:
        """Lay the steps one behind the other; a walk round a joint changes sheets."""
        roots: list[Root | None] = []
        starts: list[Floats] = []
        ends: list[Floats] = []
        turns: list[Floats] = []
        for step in walk:
            root, start, end = self._step(step)
            start, end = (start, end) if self.base == 0 else (end, start)
            offset = TURN * np.array(sheets[step.cell]) + shift
            if ends:
                offset += TURN * np.round((ends[-1] - start - offset) / TURN) * self.circles
            roots.append(root)
            starts.append(start + offset)
            ends.append(end + offset)
            turns.append(offset)
        pieces = Pieces(self.plane, self.base, roots, *map(np.array, (starts, ends, turns)))
        # At a fold both sides stop a rounding's square root short of each other.
        gaps = np.roll(pieces.end, 1, axis=0) - pieces.start
        gaps -= TURN * np.round(gaps / TURN) * self.circles
        pieces.start[:] += gaps / 2
        pieces.end[:] -= np.roll(gaps, -1, axis=0) / 2
        return pieces

    def _step(self, step: Step) -> tuple[Root | None, Floats, Floats]:
        """Return what a step follows and where it starts and ends, in the cell's coordinates."""
        cell, ends = self.cells.cells[step.cell], self.cells.ends[step.cell]
        left, right = self.cells.abscissae[cell.slab : cell.slab + 2]
        if step.kind == "lower":
            return cell.lower, np.array([left, ends[0][0]]), np.array([right, ends[1][0]])
        if step.kind == "upper":
            return cell.upper, np.array([right, ends[1][1]]), np.array([left, ends[0][1]])
        side = 1 if step.kind == "up" else 0
        low, high = self.cells.bounds(self.cells.lines[step.line], step.element)
        turns = TURN * (self.cells.turns_into(step.cell, side, (low + high) / 2) or 0)
        t, bottom, top = right if side else left, low + turns, high + turns
        start, end = (bottom, top) if side else (top, bottom)
        return None, np.array([t, start]), np.array([t, end])

    def _polish(self, pieces: Pieces, names: list[str], spans: list[slice]) -> None:
        """Bring the corners where two forms meet onto both."""
        known = {name: row for row, name in enumerate(self.problem.names)}
        corners = [
            (known[a], known[b], before.stop - 1, span.start)
            for a, b, before, span in zip(_behind(names), names, _behind(spans), spans, strict=True)
            if a != b and a in known and b in known
        ]
        if corners:
            one, other, ends, starts = np.array(corners).T
            moved = _newton(self.plane, np.stack([one, other], axis=-1), pieces.start[starts])
            pieces.end[ends] += moved - pieces.start[starts]
            pieces.start[starts] = moved


def _newton(plane: Plane, pairs: NDArray[np.int64], q: Floats) -> Floats:
    """Two steps of Newton on pairs of forms, (k, 2), from base and lift values near, (k, 2)."""
    table = plane.table[pairs]
    for _ in range(2):
        t, v = q.T
        base, lift = basis(plane.base_kind, t)[:, None, None], basis(plane.lift_kind, v)
        slopes = basis_slope(plane.base_kind, t)[:, None, None], basis_slope(plane.lift_kind, v)
        over, steep = (base @ table)[:, :, 0], (slopes[0] @ table)[:, :, 0]
        value, along_lift = np.einsum("kfj,rkj->rkf", over, np.stack([lift, slopes[1]]))
        along_base = np.einsum("kfj,kj->kf", steep, lift)
        det = along_base[:, 0] * along_lift[:, 1] - along_base[:, 1] * along_lift[:, 0]
        size = np.maximum(np.abs(along_base), np.abs(along_lift)).max(axis=1)
        firm = np.abs(det) > TRANSVERSAL * size**2  # a tangency gives Newton nothing to hold on to
        safe = np.where(firm, det, np.inf)
        by_base = (value[:, 0] * along_lift[:, 1] - value[:, 1] * along_lift[:, 0]) / safe
        by_lift = (along_base[:, 0] * value[:, 1] - along_base[:, 1] * value[:, 0]) / safe
        q = q - np.stack([by_base, by_lift], axis=-1)
    return np.asarray(q)


def _vertices(loops: Sequence[Sequence[Arc]]) -> Iterator[Vertex]:
    for arcs in loops:
        for before, arc in zip(_behind(arcs), arcs, strict=True):
            if before.boundary != arc.boundary:
                yield Vertex(arc.points[0], (before.boundary, arc.boundary))


def _behind(ring: Sequence[Item]) -> list[Item]:
    """Return for each entry of a ring the one before it."""
    return [ring[-1], *ring[:-1]]


def _polyline(points: Floats, straight: NDArray[np.bool_]) -> Floats:
    """Join pieces' points, (k, n, 2), to one line; of straight pieces the ends suffice."""
    parts = [p[[0, -1]] if only_ends else p for p, only_ends in zip(points, straight, strict=True)]
    line = np.concatenate(parts)
    new = np.concatenate([[True], np.abs(np.diff(line, axis=0)).max(axis=1) > 1e-12])
    new[-1], new[:-1] = True, new[:-1] & (np.abs(line[:-1] - line[-1]).max(axis=1) > 1e-12)
    return np.asarray(line[new] if new.sum() > 1 else line[[0, -1]])


def _cell_moments(cells: Complex) -> Floats:
    """Return area and first moments about base and lift of each cell, shape (k, 3).

    Gauss-Legendre in t = m + h sin(angle), where a fold's square root is smooth, n doubled for
    those cells whose moments still change.
    """
    result = np.full((len(cells.cells), 3), np.inf)
    left = np.arange(len(cells.cells))
    for n in NODES:
        now = _moments(cells, left.tolist(), n)
        settled = np.abs(now - result[left]) <= QUADRATURE * (1 + np.abs(now))
        result[left] = now
        left = left[~settled.all(axis=1)]
        if not len(left):
            break
    return result


def _moments(cells: Complex, chosen: list[int], n: int) -> Floats:
    nodes, weights = legendre(n)
    middle, half = (cells.spans(chosen) @ np.array([[0.5, -0.5], [0.5, 0.5]])).T[:, :, None]
    angle = nodes * math.pi / 2
    t = middle + half * np.sin(angle)
    low, high = cells.interval(chosen, t)
    strip = weights * math.pi / 2 * half * np.cos(angle) * (high - low)
    moments = np.stack([strip, strip * t, strip * (low + high) / 2], axis=-1)
    return np.asarray(moments.sum(axis=1))
