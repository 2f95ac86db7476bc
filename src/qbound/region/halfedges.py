"""Half-edges round cells, and the closed loops of them that bound each component.

Each has its cell on the left: along the lower root of a cell, up or down the critical lines at its
sides, back along the upper root. Of a component those are left that lie where nothing is joined.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np

from qbound.arrays import Ints
from qbound.region.cells import CellComplex
from qbound.region.plane import ranges, runs, which

LOWER, UP, UPPER, DOWN = range(4)
"""Half-edges round a cell, in the order of the loop: along a root, or along a critical line."""


@dataclass(frozen=True, eq=False)
class HalfEdges:
    """What bounds cells, those of a cell together, in their order round it, one a row.

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


def half_edges(cells: CellComplex) -> HalfEdges:
    """Return the half-edges round all cells.

    A cell that is a whole circle has two cycles of them; any other has one.
    """
    found, along = cells.elements, which(~cells.whole)
    up, down = which(found.cell[0] >= 0), which(found.cell[1] >= 0)
    right, left = found.cell[0, up], found.cell[1, down]
    count, none = [len(along), len(up), len(along), len(down)], np.full(len(along), -1)
    kind = np.array([LOWER, UP, UPPER, DOWN]).repeat(count)
    cell = np.concatenate([along, right, along, left])
    element = np.concatenate([none, up, none, down])
    heights = cells.in_order(right, 1, up), cells.in_order(left, 0, down)
    order = np.lexsort([np.concatenate([none, heights[0], none, -heights[1]]), kind, cell])
    kind, cell, element = kind[order], cell[order], element[order]
    first, last = runs(2 * cell + (cells.whole[cell] & (kind == DOWN)))
    after = np.arange(1, len(cell) + 1)
    after[last] = first
    return HalfEdges(kind, cell, element, after, _twins(cells, kind, element))


def _twins(cells: CellComplex, kind: Ints, element: Ints) -> Ints:
    """Return of each half-edge the one on the other side, -1 where nothing is joined."""
    place = np.full((2, len(cells.elements.line)), -1)  # of each element's half-edges
    for row, way in enumerate((UP, DOWN)):
        here = which(kind == way)
        place[row, element[here]] = here
    across = which(element >= 0)
    joined = across[cells.elements.joined[element[across]]]
    twin = np.full(len(kind), -1)
    twin[joined] = place[(kind[joined] == UP).astype(int), element[joined]]
    return twin


def find_loops(cells: CellComplex, edges: HalfEdges) -> list[list[Ints]]:
    """Return of each component the closed loops that bound it, the component on the left.

    Rows of half-edges. Where two cells are joined over an element of a line, each other's half-edge
    is the way past it: what is left are the loops.
    """
    left = dict.fromkeys(_bounding(cells, edges).tolist())
    after = _next_bounding(edges).tolist()
    loops = []
    while left:
        row = start = next(iter(left))
        loop: list[int] = []
        while not loop or row != start:
            loop.append(row)
            del left[row]
            row = after[row]
        loops.append(loop)
    return _by_component(cells, edges, loops)


def _bounding(cells: CellComplex, edges: HalfEdges) -> Ints:
    """Return the half-edges that bound components, one component after the other."""
    chosen = np.array(list(chain(*cells.parts.cells)), dtype=np.int64)
    _, rows = ranges(edges.cell.searchsorted(chosen), edges.cell.searchsorted(chosen + 1))
    return np.asarray(rows[edges.twin[rows] < 0])


def _next_bounding(edges: HalfEdges) -> Ints:
    """Return which half-edge comes next where one bounds a component, past joined elements."""
    bounding = edges.twin < 0  # round a point inside a component one would go for ever
    after = np.where(bounding, edges.after, 0)
    while len(inner := which(bounding & (edges.twin[after] >= 0))):
        after[inner] = edges.after[edges.twin[after[inner]]]
    return after


def _by_component(cells: CellComplex, edges: HalfEdges, loops: list[list[int]]) -> list[list[Ints]]:
    """Sort loops by component."""
    found: list[list[Ints]] = [[] for _ in cells.parts.cells]
    owner = cells.parts.of_cells()
    for loop in loops:
        found[int(owner[edges.cell[loop[0]]])].append(np.array(loop))
    return found
