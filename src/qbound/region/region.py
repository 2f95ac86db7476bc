"""The feasible region of two joints, complete: components, labelled arcs, vertices, measures.

By the clearance rule every boundary in use keeps its distance. By the paper's rule the windows of
Table 6 are limits and the half-spaces cut; the same decomposition serves both.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, islice

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.boundary.functions import clearance, pair_vector
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import HalfSpace, Pair, Robot
from qbound.region.arcs import NODES, Arc, legendre, ordered
from qbound.region.cells import Complex
from qbound.region.decomposition import TURN, Plane, Range, decompose
from qbound.region.loops import Layout, Sheets, Walk, behind
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

    def safe(self, q: Floats) -> bool:
        """Tell whether a configuration lies strictly within the ranges and keeps every form."""
        inside = all(r is None or r[0] < x < r[1] for x, r in zip(q, self.ranges, strict=True))
        return inside and bool((self.forms(q) > 0).all())

    def with_form(self, name: str, coefficients: Floats) -> Problem:
        """Return the problem with one more form, of coefficients (3, 3), as its last."""
        table = np.concatenate([self.forms.coefficients, coefficients[None]])
        forms = HarmonicForm(table, self.forms.kinds)
        return replace(self, forms=forms, names=(*self.names, name))


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
    """All components, the one with the home pose first, the others by falling area.

    Attributes
    ----------
    components : tuple of Component
    problem : Problem
    cells : Complex
        The cells that make them up.
    base : int
        Which joint is the base of the cells.
    owner : dict of int to int
        Component of each cell.
    """

    components: tuple[Component, ...]
    problem: Problem
    cells: Complex
    base: int
    owner: dict[int, int]

    @property
    def home(self) -> Component | None:
        """The component with the home pose."""
        return next((c for c in self.components if c.contains_home), None)

    @property
    def area(self) -> float:
        """Sum of all components' areas."""
        return sum(component.area for component in self.components)

    def holding(self, q: ArrayLike) -> int | None:
        """Return the index of the component that holds a configuration, modulo full turns (eq. 9).

        None on a boundary and beyond it: components are open.
        """
        place = np.asarray(q, dtype=float)
        found = self.cells.holding(ordered(place, self.base)) if self.problem.safe(place) else None
        return None if found is None else self.owner[found[0]]


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


def solve(problem: Problem, home: ArrayLike, base: int | None = None) -> Region:
    """Find every component of { all forms > 0, within the ranges }.

    Parameters
    ----------
    home : array_like, shape (2,)
        Configuration that names the first component and around which it is unrolled.
    base : int, optional
        Which joint is the base of the cells; the components do not depend on it.

    Notes
    -----
    A component is open; touching in points or curves neither joins components nor makes one.
    """
    if base is None:  # the lift of the two kinds slides
        base = 1 if problem.forms.kinds == ("prismatic", "revolute") else 0
    cells = Complex(decompose(Plane(problem.forms, problem.ranges, base)))
    found = _measured(cells, problem, np.asarray(home, dtype=float), base)
    walks = [[Walk(w, f.sheets, f.shift) for w in cells.loops(f.sheets)] for f in found]
    loops = iter(Layout(cells, base, problem.names, problem.limits).arcs(list(chain(*walks))))
    components = [
        (_component(f, base, list(islice(loops, len(own)))), f.sheets)
        for f, own in zip(found, walks, strict=True)
    ]
    components.sort(key=lambda item: (not item[0].contains_home, -item[0].area))
    owner = {k: i for i, (_, sheets) in enumerate(components) for k in sheets}
    return Region(tuple(component for component, _ in components), problem, cells, base, owner)


def find_region(robot: Robot, held: Mapping[int, float] | None = None) -> Region:
    """Return the region of two joints by the clearance rule; arguments as `clearance_problem`."""
    held = held or {}
    home = [value for j, value in enumerate(robot.home) if j not in held]
    return solve(clearance_problem(robot, held), home)


def margins(robot: Robot, q: ArrayLike) -> list[tuple[str, float]]:
    """Return the margin of a configuration to every boundary in use and to every joint limit.

    Margins are lengths for boundaries (``|B| - d_min``, or the depth inside a wall), joint units
    for limits; negative where violated (eqs. 9-12).
    """
    q = np.asarray(q, dtype=float)
    found = [(b.name, _margin(robot, b, q)) for b in robot.boundaries if b.used]
    for joint, value in zip(robot.joints, q, strict=True):
        if joint.limits is not None:
            found.append((f"{joint.name}.lower", float(value - joint.limits[0])))
            found.append((f"{joint.name}.upper", float(joint.limits[1] - value)))
    return found


def violated(robot: Robot, q: ArrayLike) -> list[tuple[str, float]]:
    """Return those of the `margins` of a configuration that are negative; none: feasible."""
    return [(name, margin) for name, margin in margins(robot, q) if margin < 0]


def _margin(robot: Robot, boundary: Pair | HalfSpace, q: Floats) -> float:
    if isinstance(boundary, HalfSpace):
        return float(clearance(robot, boundary)(q))
    distance = np.linalg.norm(pair_vector(robot, boundary)(q))
    return float(distance) - robot.required_distance(boundary)


# --- from cells to components ---------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Found:
    """A component before its boundary is laid out; base before lift."""

    sheets: Sheets
    wraps: tuple[bool, bool]
    area: float
    middle: Floats
    shift: Floats
    contains_home: bool


def _measured(cells: Complex, problem: Problem, home: Floats, base: int) -> list[_Found]:
    """Measure every component, and choose the turns at which it is shown."""
    moments = _cell_moments(cells)
    inside = (problem.forms(home) > 0).all()  # else on a boundary or beyond: in no component
    home = ordered(home, base)
    at_home = cells.holding(home) if inside else None
    circles = np.array([r is None for r in (cells.plane.base_range, cells.plane.lift_range)])
    found = []
    for sheets, wraps in cells.components():
        turns = TURN * np.array(list(sheets.values()), dtype=float)
        areas, firsts = moments[list(sheets), 0], moments[list(sheets), 1:]
        middle = (firsts + areas[:, None] * turns).sum(axis=0) / areas.sum()
        shift, contains_home = np.zeros(2), at_home is not None and at_home[0] in sheets
        if at_home is not None and contains_home:
            shift = home - at_home[1] - TURN * np.array(sheets[at_home[0]])
        elif not any(wraps):
            shift = -TURN * np.ceil((middle - math.pi) / TURN) * circles
        found.append(_Found(sheets, wraps, areas.sum(), middle, shift, contains_home))
    return found


def _component(found: _Found, base: int, loops: list[tuple[Arc, ...]]) -> Component:
    centroid = None if any(found.wraps) else ordered(found.middle + found.shift, base)
    wraps = found.wraps[base], found.wraps[1 - base]
    corners = tuple(_vertices(loops))
    return Component(found.area, centroid, wraps, tuple(loops), corners, found.contains_home)


def _vertices(loops: Sequence[Sequence[Arc]]) -> Iterator[Vertex]:
    for arcs in loops:
        for before, arc in zip(behind(arcs), arcs, strict=True):
            if before.boundary != arc.boundary:
                yield Vertex(arc.start, (before.boundary, arc.boundary))


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
    start, end = cells.spans(chosen).T[:, :, None]
    half, angle = (end - start) / 2, nodes * math.pi / 2
    t = (start + end) / 2 + half * np.sin(angle)
    low, high = cells.interval(chosen, t)
    strip = weights * math.pi / 2 * half * np.cos(angle) * (high - low)
    moments = np.stack([strip, strip * t, strip * (low + high) / 2], axis=-1)
    return np.asarray(moments.sum(axis=1))
