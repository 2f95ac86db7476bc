"""From cells to components: closures, areas and centroids, and the loops' vertices."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate, chain
from typing import Final

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.forms.angles import TURN, first_from, nearest_turn
from qbound.printable import printable
from qbound.region.arcs import NODES, Arc, legendre, ordered
from qbound.region.cells import CellComplex, Placed
from qbound.region.loops import behind
from qbound.region.problem import Problem
from qbound.tolerances import QUADRATURE, TOUCH

CELL_NODES: Final = (NODES[0], 32, *NODES[1:4])
"""Numbers of nodes that are tried in turn in a cell: of most the second says what the first did."""

HALVINGS: Final = 40
"""Times a cell may be halved for its moments."""

ROOM: Final = 1.25
"""No fibre of a cell is taller than so many times the tallest one at its nodes.

Roots are analytic between critical values, and the nodes lie densest at both ends. Where a fibre
were taller, a sample would have a little less of it.
"""


@dataclass(frozen=True, eq=False)
class Vertex:
    """A point of the boundary where two boundaries meet.

    Attributes
    ----------
    q : ndarray, shape (2,)
        Joint values.
    boundaries : tuple of two str
    error : float
        How far a joint value may be off, in units of a joint: rad, or a slide's farthest limit.
        Where two curves are tangent only half the digits are known.
    """

    q: Floats
    boundaries: tuple[str, str]
    error: float = 0.0

    def __repr__(self) -> str:
        """Say in a line where it is and what meets there."""
        place = ", ".join(f"{x:.6g}" for x in self.q)
        vague = f" within {self.error:.1g}" if self.error > 1e-9 else ""
        return printable(f"<Vertex of {' and '.join(self.boundaries)} at ({place}){vague}>")


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
        The closed loops that bound it, the component on the left.
    vertices : tuple of Vertex
        In the order of the loops.
    contains_home : bool
    area_unit : str
        The product of both joints' units.

    Notes
    -----
    What needs more than a component is asked of its region: ``region.component_of(q) == k`` tells
    where configurations lie in component k, ``region.plot(component=k)`` draws it alone, and
    ``region.to_shapely(component=k)`` returns its polygons.
    """

    area: float
    centroid: Floats | None
    wraps: tuple[bool, bool]
    loops: tuple[tuple[Arc, ...], ...]
    vertices: tuple[Vertex, ...]
    contains_home: bool
    area_unit: str = ""

    def __repr__(self) -> str:
        """Say in a line how large it is and what bounds it."""
        home = ", with home" if self.contains_home else ""
        loops = f"{len(self.loops)} loop{'s' * (len(self.loops) != 1)}"
        sizes = f"{len(self.vertices)} vertices, {loops}"
        return f"<Component: area {self.area:.6g} {self.area_unit}, {sizes}{home}>"


def closures(problem: Problem, cells: CellComplex, base: int, q: Floats) -> list[Placed]:
    """Return the cells in whose closure a configuration lies.

    One that is a little beside a cell, by the rounding of a fold, belongs to it if nothing is
    violated half-way.
    """
    if q.shape != (2,):
        raise ValueError(f"one configuration of two joint values is wanted, found shape {q.shape}")
    feasible = problem.evaluator.feasible
    if not feasible(q):
        return []
    return [
        one
        for one in cells.placed(ordered(q, base))
        if not one.off.any() or feasible(q + ordered(one.off, base) / 2)
    ]


def numbered(
    problem: Problem, cells: CellComplex, base: int, owner: Mapping[int, int], q: Floats
) -> Ints:
    """Return the number of the component of each configuration, shape (n, 2) to (n,); -1: none.

    What is well inside a cell is told at once for all; of the others `closures` says the first.
    """
    found = np.full(len(q), -1)
    feasible = np.flatnonzero(problem.evaluator.feasible(q))
    t, v = ordered(q[feasible], base).T
    if cells.wrapped:
        t = first_from(cells.plane.ends[0], t)
    slab = np.searchsorted(cells.abscissae, t) - 1
    order = np.argsort(slab, kind="stable")
    first = np.searchsorted(slab[order], np.arange(len(cells.abscissae) + 1))
    near = TOUCH * cells.plane.base_unit
    for cell, component in owner.items():
        here = order[first[cells.slabs[cell]] : first[cells.slabs[cell] + 1]]
        start, end = cells.spans([cell])[0]
        here = here[(start + near < t[here]) & (t[here] < end - near)]
        if len(here) and not cells.whole[cell]:
            low, high = cells.interval([cell], t[None, here])[:, 0]
            lift = first_from(low, v[here]) if cells.circle else v[here]
            here = here[(low + cells.touch < lift) & (lift < high - cells.touch)]
        found[feasible[here]] = component
    for k in feasible[found[feasible] < 0]:
        placed = closures(problem, cells, base, q[k])
        found[k] = min((owner[one.cell] for one in placed if one.cell in owner), default=-1)
    return found


def drawn(
    problem: Problem, cells: CellComplex, base: int, own: Ints, n: int, rng: np.random.Generator
) -> Floats:
    """Draw n places evenly over some cells, shape (n, 2); angles of full turns in (-pi, pi].

    A cell is chosen by its area, then a base value by the height over it, by rejection.
    """
    areas = _cell_moments(cells)[own, 0]
    sines, _ = _smooth_rules((NODES[1],))
    start, end = cells.spans(own).T
    low, high = cells.interval(own, (start + end)[:, None] / 2 + (end - start)[:, None] / 2 * sines)
    tallest = ROOM * (high - low).max(axis=1)
    chosen = rng.choice(len(own), n, p=areas / areas.sum())
    place, left = np.empty((n, 2)), np.arange(n)
    while len(left):
        k = chosen[left]
        t = rng.uniform(start[k], end[k])
        low, high = cells.interval(own[k], t[:, None])[..., 0]
        place[left] = np.stack([t, rng.uniform(low, high)], axis=-1)
        left = left[rng.uniform(size=len(left)) * tallest[k] > high - low]
    q = ordered(place, base)
    return np.where([ends is None for ends in problem.ranges], nearest_turn(q, 0), q)


@dataclass(frozen=True, eq=False)
class Found:
    """A component before its boundary is laid out; base before lift."""

    part: int
    wraps: tuple[bool, bool]
    area: float
    middle: Floats
    shift: Floats
    contains_home: bool


def measured(cells: CellComplex, problem: Problem, home: Floats, base: int) -> list[Found]:
    """Measure every component, and choose the turns at which it is shown."""
    moments = _cell_moments(cells)
    at_home = {one.cell: one for one in closures(problem, cells, base, home)}
    home = ordered(home, base)
    circles = np.array([r is None for r in (cells.plane.base_range, cells.plane.lift_range)])
    parts = cells.parts
    moments[:, 1:] += moments[:, :1] * TURN * parts.windings
    first = list(accumulate(map(len, parts.cells[:-1]), initial=0))
    sums = np.add.reduceat(moments[list(chain(*parts.cells))], first)
    middles = sums[:, 1:] / np.where(sums[:, :1] > 0, sums[:, :1], 1.0)
    nearest = (nearest_turn(middles, 0) - middles) * circles
    found = []
    for k, wraps in enumerate(parts.wraps):
        own = next((at_home[cell] for cell in at_home if cell in parts.cells[k]), None)
        shift = np.zeros(2)
        if own is not None:
            shift = home - own.place - TURN * parts.windings[own.cell]
        elif not any(wraps):
            shift = nearest[k]
        area = float(sums[k, 0])
        found.append(Found(k, wraps, area, middles[k], shift, own is not None))
    return found


def bounded(
    found: Found, base: int, loops: Sequence[tuple[tuple[Arc, ...], list[bool]]], unit: str
) -> Component:
    """Return a component with its boundary: loops of arcs, which of these begin at a vertex."""
    centroid = None if any(found.wraps) else ordered(found.middle + found.shift, base)
    wraps = found.wraps[base], found.wraps[1 - base]
    vertices = tuple(
        Vertex(arc.start, (before.boundary, arc.boundary), arc.vague)
        for arcs, corners in loops
        for before, arc, corner in zip(behind(arcs), arcs, corners, strict=True)
        if corner
    )
    rings = tuple(arcs for arcs, _ in loops)
    return Component(found.area, centroid, wraps, rings, vertices, found.contains_home, unit)


def _cell_moments(cells: CellComplex) -> Floats:
    """Return area and first moments about base and lift of each cell, shape (k, 3).

    Gauss-Legendre in t = m + h sin(angle), where a fold's square root is smooth, n raised for
    those cells whose moments still change; what has not settled then, as beside a saddle that is
    just missed, is halved.
    """
    every = np.arange(len(cells.slabs))
    found = np.zeros((len(every), 3))
    of, spans = every, cells.spans(every)
    for _ in range(HALVINGS):
        moments, settled = _settled_moments(cells, of, spans)
        np.add.at(found, of[settled], moments[settled])
        of, spans = of[~settled], spans[~settled]
        if not len(of):
            return found
        middle = spans.mean(axis=1)
        first, second = spans.copy(), spans.copy()
        first[:, 1] = second[:, 0] = middle
        of, spans = np.concatenate([of, of]), np.concatenate([first, second])
    np.add.at(found, of, _moments(cells, of, spans, CELL_NODES[-1:])[0])
    return found


def _settled_moments(cells: CellComplex, of: Ints, spans: Floats) -> tuple[Floats, Bools]:
    """Return the moments of parts of cells, and which of them no longer change.

    What counts as a change is measured in the joints' units: a slide's values may be millions.
    """
    base, lift = cells.plane.base_unit, cells.plane.lift_unit
    least = base * lift * np.array([1.0, base, lift])
    left = np.arange(len(of))
    before, now = _moments(cells, of, spans, CELL_NODES[:2])
    result, done = now.copy(), np.zeros(len(of), dtype=np.bool_)
    for n in CELL_NODES[2:]:
        same = (np.abs(now - before) <= QUADRATURE * (least + np.abs(now))).all(axis=1)
        done[left[same]] = True
        left = left[~same]
        if not len(left):
            break
        before, (now,) = result[left], _moments(cells, of[left], spans[left], (n,))
        result[left] = now
    return result, done


def _moments(cells: CellComplex, chosen: Ints, spans: Floats, nodes: tuple[int, ...]) -> Floats:
    """Return the moments of cells between base values by rules of some nodes, (rules, k, 3)."""
    sines, weights = _smooth_rules(nodes)
    start, end = spans.T[:, :, None]
    half = (end - start) / 2
    t = (start + end) / 2 + half * sines
    low, high = cells.interval(chosen, t)
    height = high - low
    moments = np.array([height, height * t, height * (low + high) / 2])
    return np.asarray((moments @ weights).T * half)


@cache
def _smooth_rules(nodes: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return sin(angle) at Gauss-Legendre nodes of the angle, and weights, for [-1, 1].

    Nodes of all rules together, shape (n,); of each rule the weights are a column, (n, rules), with
    zeros at the others' nodes.
    """
    rules = [legendre(n) for n in nodes]
    angle = np.concatenate([x for x, _ in rules]) * math.pi / 2
    weights = np.zeros((len(angle), len(nodes)))
    ends = np.cumsum([0, *nodes])
    for k, (_, own) in enumerate(rules):
        weights[ends[k] : ends[k + 1], k] = own
    return np.sin(angle), weights * math.pi / 2 * np.cos(angle)[:, None]
