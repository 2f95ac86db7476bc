"""The feasible region of two joints, complete: components, labelled arcs, vertices, measures.

By the clearance rule every boundary in use keeps its distance. By the paper's rule the windows of
Table 6 are limits and the half-spaces cut; the same decomposition serves both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.boundary import clearance, pair_vector, required_distance
from qbound.cells import Complex, Step
from qbound.decomposition import TURN, Plane, Range, decompose
from qbound.harmonic import HarmonicForm
from qbound.robot import HalfSpace, Pair, Robot
from qbound.tolerances import QUADRATURE

Floats = NDArray[np.float64]


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
class Arc:
    """A piece of boundary on which one form vanishes, or one joint is at its limit.

    Attributes
    ----------
    boundary : str
    branch : int or None
        -1 / +1: the root theta - / + arccos of Theorem 2; None where there is none.
    points : ndarray, shape (k, 2)
        Joint values along the arc, its two ends first and last, the region on the left.
    """

    boundary: str
    branch: int | None
    points: Floats


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
    cells = Complex(decompose(plane))
    target = np.asarray(home, dtype=float)
    builder = _Builder(problem, cells, base, target)
    found = [builder.component(sheets, wraps) for sheets, wraps in cells.components()]
    found.sort(key=lambda c: (not c.contains_home, -c.area))
    return Region(tuple(found), problem)


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
    """Turns a component's cells into arcs, vertices and measures, in the order of the joints."""

    def __init__(self, problem: Problem, cells: Complex, base: int, home: Floats) -> None:
        self.problem, self.cells, self.base, self.home = problem, cells, base, home

    def component(self, sheets: dict[int, tuple[int, int]], wraps: tuple[bool, bool]) -> Component:
        area, first, second = _moments(self.cells, sheets)
        at_home = self._home_sheet(sheets)
        middle = np.array([first, second]) / area
        shift = np.zeros(2)
        if at_home is not None:
            shift = at_home
        elif not any(wraps):
            shift = -TURN * np.ceil((middle - math.pi) / TURN) * self._circles()
        walks = [self._arcs(walk, sheets, shift) for walk in self.cells.loops(set(sheets))]
        loops = tuple(tuple(arcs) for arcs in walks)
        centroid = None if any(wraps) else self._ordered(middle + shift)
        one, other = wraps if self.base == 0 else wraps[::-1]
        return Component(
            area, centroid, (one, other), loops, tuple(self._vertices(loops)), at_home is not None
        )

    def _circles(self) -> Floats:
        plane = self.cells.plane
        return np.array([plane.base_range is None, plane.lift_range is None], dtype=float)

    def _ordered(self, place: Floats) -> Floats:
        """From (base, lift) to the order of the joints."""
        return place if self.base == 0 else place[..., ::-1]

    def _home_sheet(self, sheets: dict[int, tuple[int, int]]) -> Floats | None:
        """Return the shift that brings this component around the home pose, if it holds it."""
        if not (self.problem.forms(self.home) > 0).all():
            return None  # on a boundary or beyond: in no component, however near
        home = self._ordered(self.home)
        circles = self._circles()
        low = self.cells.plane.ends[0]
        t = home[0] - TURN * math.floor((home[0] - low) / TURN) if circles[0] else home[0]
        for k, sheet in sheets.items():
            start, end = self.cells.abscissae[self.cells.cells[k].slab :][:2]
            if start <= t <= end and (turns := self._lift_turns(k, t, home[1])) is not None:
                # in the cell's own coordinates home is (t, home[1] + TURN * turns)
                own = np.array([t, home[1] + TURN * turns]) + TURN * np.array(sheet)
                return home - own
        return None

    def _lift_turns(self, k: int, t: float, v: float) -> int | None:
        lower, upper = self.interval(k, np.array([t]))[:, 0]
        turns = math.ceil((lower - v) / TURN) if self._circles()[1] else 0
        return turns if lower <= v + TURN * turns <= upper else None

    def interval(self, k: int, t: Floats) -> Floats:
        return _interval(self.cells, k, t)

    # --- arcs -----------------------------------------------------------------------------------

    def _arcs(
        self, walk: list[Step], sheets: dict[int, tuple[int, int]], shift: Floats
    ) -> list[Arc]:
        """Merge the steps of a walk that stay on one branch of one boundary."""
        named = [(self._label(step), self._points(step, sheets, shift)) for step in walk]
        start = next((i for i in range(len(named)) if named[i][0] != named[i - 1][0]), 0)
        named = self._unrolled(named[start:] + named[:start])
        arcs = []
        for (name, branch), group in groupby(named, key=lambda item: item[0]):
            points = np.concatenate([points for _, points in group])
            keep = np.concatenate([[True], np.abs(np.diff(points, axis=0)).max(axis=1) > 1e-12])
            points = self._ordered(points[keep] if keep.sum() > 1 else points[[0, -1]])
            arcs.append(Arc(name, branch, points if self.base == 0 else points[::-1]))
        return arcs if self.base == 0 else arcs[::-1]

    def _unrolled(
        self, named: list[tuple[tuple[str, int | None], Floats]]
    ) -> list[tuple[tuple[str, int | None], Floats]]:
        """Let each piece start where the one before ends: a walk round a joint changes sheets."""
        result = named[:1]
        for label, points in named[1:]:
            turns = np.round((result[-1][1][-1] - points[0]) / TURN) * self._circles()
            result.append((label, points + TURN * turns))
        return result

    def _label(self, step: Step) -> tuple[str, int | None]:
        plane, cell = self.cells.plane, self.cells.cells[step.cell]
        if step.kind in ("up", "down"):
            return self._wall_label(step)
        root = cell.lower if step.kind == "lower" else cell.upper
        assert root is not None
        if root.form < 0:
            return self.problem.limits[1 - self.base][-1 - root.form], None
        branch = root.branch if plane.lift_kind == "revolute" else None
        return self.problem.names[root.form], branch

    def _wall_label(self, step: Step) -> tuple[str, int | None]:
        """Name a piece of a critical line: a limit of the base, or a form without the lift."""
        plane = self.cells.plane
        side = 0 if step.kind == "down" else 1
        at_end = self.cells.abscissae[step.line] == plane.ends[side]
        if plane.base_range is not None and at_end:
            return self.problem.limits[self.base][side], None
        low, high = self.cells.bounds(self.cells.lines[step.line], step.element)
        t = self.cells.abscissae[step.line]
        values = plane.values(np.array([t]), np.array([(low + high) / 2]))[0]
        form = int(np.abs(values).argmin())
        # A form falls along the base at theta + arccos; there the component lies before it.
        branch = (1 if step.kind == "up" else -1) if plane.base_kind == "revolute" else None
        return self.problem.names[form], branch

    def _points(
        self, step: Step, sheets: dict[int, tuple[int, int]], shift: Floats, n: int = 33
    ) -> Floats:
        """Joint values along a step, shape (n, 2), in (base, lift)."""
        cell, offset = self.cells.cells[step.cell], TURN * np.array(sheets[step.cell]) + shift
        start, end = self.cells.abscissae[cell.slab : cell.slab + 2]
        if step.kind in ("lower", "upper"):
            angle = np.linspace(-math.pi / 2, math.pi / 2, n)  # close where a fold may be
            t = (start + end) / 2 + (end - start) / 2 * np.sin(angle)
            t[0], t[-1] = start, end
            v = self.interval(step.cell, t)[0 if step.kind == "lower" else 1]
            points = np.stack([t, v], axis=-1) + offset
            return points if step.kind == "lower" else points[::-1]
        side = 1 if step.kind == "up" else 0
        low, high = self.cells.bounds(self.cells.lines[step.line], step.element)
        turns = self.cells.turns_into(step.cell, side, (low + high) / 2) or 0
        v = np.array([low, high]) + TURN * turns
        points = np.stack([np.full(2, end if side else start), v], axis=-1) + offset
        return points if step.kind == "up" else points[::-1]

    def _vertices(self, loops: Sequence[Sequence[Arc]]) -> Iterator[Vertex]:
        for arcs in loops:
            for before, arc in zip([arcs[-1], *arcs[:-1]], arcs, strict=True):
                if before.boundary != arc.boundary:
                    names = before.boundary, arc.boundary
                    yield Vertex(self._polished(arc.points[0], names), names)

    def _polished(self, q: Floats, names: tuple[str, str]) -> Floats:
        """Two steps of Newton on the two forms; a limit holds its joint."""
        rows = [self.problem.names.index(n) for n in names if n in self.problem.names]
        if len(rows) < 2:
            return q
        pair = self.problem.forms[rows]
        for _ in range(2):
            gradient = pair.gradient(q)
            if abs(np.linalg.det(gradient)) < 1e-6 * np.abs(gradient).max() ** 2:
                return q  # tangent: Newton has nothing to hold on to
            q = q - np.linalg.solve(gradient, pair(q))
        return np.asarray(q)


def _interval(cells: Complex, k: int, t: Floats) -> Floats:
    """Lower and upper root of a cell over base values of its slab, shape (2, len(t))."""
    cell = cells.cells[k]
    lower = cells.root_values(cell.lower, cell.slab, t)
    upper = lower + TURN if cell.upper is None else cells.root_values(cell.upper, cell.slab, t)
    return np.stack([lower, np.maximum(lower, upper)])


def _moments(cells: Complex, sheets: dict[int, tuple[int, int]]) -> tuple[float, float, float]:
    """Area and both first moments of a component, unrolled, to machine precision (Green)."""
    total = np.zeros(3)
    for k, sheet in sheets.items():
        total += _cell_moments(cells, k, TURN * np.array(sheet))
    return float(total[0]), float(total[1]), float(total[2])


@cache
def _legendre(n: int) -> tuple[Floats, Floats]:
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return nodes, weights


def _cell_moments(cells: Complex, k: int, offset: Floats) -> Floats:
    """Gauss-Legendre in t = m + h sin(angle): a fold's square root is smooth in the angle."""
    start, end = cells.abscissae[cells.cells[k].slab :][:2]
    before = np.full(3, np.inf)
    for n in (24, 48, 96, 192, 384, 768):
        nodes, weights = _legendre(n)
        angle = nodes * math.pi / 2
        t = (start + end) / 2 + (end - start) / 2 * np.sin(angle)
        weights = weights * math.pi / 2 * (end - start) / 2 * np.cos(angle)
        low, high = _interval(cells, k, t) + offset[1]
        height = high - low
        now = np.array(
            [
                (weights * height).sum(),
                (weights * height * (t + offset[0])).sum(),
                (weights * height * (low + high) / 2).sum(),
            ]
        )
        if np.abs(now - before).max() <= QUADRATURE * (1 + np.abs(now).max()):
            break
        before = now
    return now
