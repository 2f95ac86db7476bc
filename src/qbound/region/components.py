"""From cells to components: closures, areas and centroids, and the loops' vertices."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, nearest_turn
from qbound.printable import printable
from qbound.records import dataclass
from qbound.region.arcs import NODES, Arc, legendre, ordered
from qbound.region.cells import CellComplex, Placed
from qbound.region.loops import Windings, behind
from qbound.region.problem import Problem
from qbound.tolerances import QUADRATURE

CELL_NODES: Final = (NODES[0], 32, *NODES[1:])
"""Numbers of nodes that are tried in turn in a cell: of most the second says what the first did."""

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Vertex:
    """A point of the boundary where two boundaries meet."""

    q: Floats
    boundaries: tuple[str, str]

    def __repr__(self) -> str:
        """Say in a line where it is and what meets there."""
        place = ", ".join(f"{x:.6g}" for x in self.q)
        return printable(f"<Vertex of {' and '.join(self.boundaries)} at ({place})>")


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
    """

    area: float
    centroid: Floats | None
    wraps: tuple[bool, bool]
    loops: tuple[tuple[Arc, ...], ...]
    vertices: tuple[Vertex, ...]
    contains_home: bool

    def __repr__(self) -> str:
        """Say in a line how large it is and what bounds it."""
        home = ", with home" if self.contains_home else ""
        loops = f"{len(self.loops)} loop{'s' * (len(self.loops) != 1)}"
        sizes = f"{len(self.vertices)} vertices, {loops}"
        return f"<Component: area {self.area:.6g}, {sizes}{home}>"


def closures(problem: Problem, cells: CellComplex, base: int, q: Floats) -> list[Placed]:
    """Return the cells in whose closure a configuration lies.

    One that is a little beside a cell, by the rounding of a fold, belongs to it if nothing is
    violated half-way.
    """
    if q.shape != (2,):
        raise ValueError(f"one configuration of two joint values is wanted, found shape {q.shape}")
    if not problem.evaluator.feasible(q):
        return []
    return [
        one
        for one in cells.placed(ordered(q, base))
        if problem.evaluator.feasible(q + ordered(one.off, base) / 2)
    ]


@dataclass(frozen=True, eq=False)
class Found:
    """A component before its boundary is laid out; base before lift."""

    windings: Windings
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
    parts = cells.components()
    table = winding_table(cells, [windings for windings, _ in parts])
    count = [len(windings) for windings, _ in parts]
    owner, order = np.repeat(np.arange(len(parts)), count), [k for one, _ in parts for k in one]
    moments[:, 1:] += moments[:, :1] * TURN * table
    sums = np.array([np.bincount(owner, column[order], len(parts)) for column in moments.T])
    middles = (sums[1:] / sums[0]).T
    nearest = (nearest_turn(middles, 0) - middles) * circles
    found = []
    for k, (windings, wraps) in enumerate(parts):
        own = next((one for cell, one in at_home.items() if cell in windings), None)
        shift = np.zeros(2)
        if own is not None:
            shift = home - own.place - TURN * np.array(windings[own.cell])
        elif not any(wraps):
            shift = nearest[k]
        area = float(sums[0, k])
        found.append(Found(windings, wraps, area, middles[k], shift, own is not None))
    return found


def winding_table(cells: CellComplex, windings: Sequence[Windings]) -> Ints:
    """Return the winding of every cell, shape (cells, 2), of those of all components."""
    table = np.zeros((len(cells.slabs), 2), dtype=np.int64)
    for one in windings:
        table[list(one)] = list(one.values())
    return table


def bounded(found: Found, base: int, loops: list[tuple[Arc, ...]]) -> Component:
    """Return a component with its boundary; each loop begins at its lowest vertex."""
    centroid = None if any(found.wraps) else ordered(found.middle + found.shift, base)
    wraps = found.wraps[base], found.wraps[1 - base]
    loops = [_from_lowest(loop) for loop in loops]
    corners = tuple(_vertices(loops))
    return Component(found.area, centroid, wraps, tuple(loops), corners, found.contains_home)


def _from_lowest(loop: tuple[Arc, ...]) -> tuple[Arc, ...]:
    """Let a loop begin at its lowest vertex, by the last joint, then the first, as in Figure 5.

    One that goes round a joint is left alone.
    """
    starts = [i for i, arc in enumerate(loop) if loop[i - 1].label != arc.label]
    (q1, q2), (p1, p2) = loop[-1].end.tolist(), loop[0].start.tolist()
    if not starts or max(abs(q1 - p1), abs(q2 - p2)) >= math.pi:
        return loop
    k = min(starts, key=lambda i: [round(x, 9) for x in loop[i].start[::-1].tolist()])
    return loop[k:] + loop[:k]


def _vertices(loops: Sequence[Sequence[Arc]]) -> Iterator[Vertex]:
    for arcs in loops:
        for before, arc in zip(behind(arcs), arcs, strict=True):
            if before.label != arc.label:
                yield Vertex(arc.start, (before.boundary, arc.boundary))


def _cell_moments(cells: CellComplex) -> Floats:
    """Return area and first moments about base and lift of each cell, shape (k, 3).

    Gauss-Legendre in t = m + h sin(angle), where a fold's square root is smooth, n raised for
    those cells whose moments still change.
    """
    result = np.full((len(cells.slabs), 3), np.inf)
    left = np.arange(len(cells.slabs))
    for n in CELL_NODES:
        now = _moments(cells, left, n)
        settled = np.abs(now - result[left]) <= QUADRATURE * (1 + np.abs(now))
        result[left] = now
        left = left[~settled.all(axis=1)]
        if not len(left):
            break
    return result


def _moments(cells: CellComplex, chosen: Ints, n: int) -> Floats:
    sines, weights = _smooth_rule(n)
    start, end = cells.spans(chosen).T[:, :, None]
    half = (end - start) / 2
    t = (start + end) / 2 + half * sines
    low, high = cells.interval(chosen, t)
    height = high - low
    moments = np.array([height, height * t, height * (low + high) / 2])
    return np.asarray((moments @ weights).T * half)


@cache
def _smooth_rule(n: int) -> tuple[Floats, Floats]:
    """Return sin(angle) at Gauss-Legendre nodes of the angle, and weights, for [-1, 1]."""
    nodes, weights = legendre(n)
    angle = nodes * math.pi / 2
    return np.sin(angle), weights * math.pi / 2 * np.cos(angle)
