"""The region of two joints as fibres: for each value of the second joint, intervals of the first.

The decomposition with the second joint as its base is exactly that. Which component holds a
configuration is read off the fibre that it lies on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.cells import Complex
from qbound.decomposition import TURN
from qbound.region import Component, Problem, components_over

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Fibres:
    """Cells of a region whose base is the second joint.

    Attributes
    ----------
    components : tuple of Component
        In the order of `qbound.region.solve`.
    owner : dict of int to int
        Component of each cell.
    """

    problem: Problem
    cells: Complex
    components: tuple[Component, ...]
    owner: dict[int, int]

    @property
    def lines(self) -> Floats:
        """Values of the second joint between which the fibres keep their form."""
        return np.asarray(self.cells.abscissae)

    def over(self, q2: float) -> tuple[float, list[int]]:
        """Return the cells over a value of the second joint, by rising first joint.

        Returns
        -------
        shift : float
            Full turns to subtract from the second joint to come into the cells' own range.
        cells : list of int
        """
        low = self.lines[0]
        turns = math.floor((q2 - low) / TURN) if self.problem.ranges[1] is None else 0
        slab = int(np.searchsorted(self.lines, q2 - TURN * turns)) - 1
        return TURN * turns, [k for k, cell in enumerate(self.cells.cells) if cell.slab == slab]

    def intervals(self, cells: list[int], q2: Floats) -> Floats:
        """Return the ends of cells' intervals of the first joint over their slab, (2, k, n)."""
        return self.cells.interval(cells, np.broadcast_to(q2, (len(cells), len(q2))))

    def inside(self, component: int) -> Floats:
        """Return a configuration well inside a component: the middle of its widest cell."""
        own = [k for k, owner in self.owner.items() if owner == component]
        spans = self.cells.spans(own)
        middles = spans.mean(axis=1, keepdims=True)
        low, high = self.cells.interval(own, middles)[..., 0]
        widest = np.minimum(high - low, np.diff(spans)[:, 0]).argmax()
        return np.array([(low + high)[widest] / 2, middles[widest, 0]])

    def component(self, q: ArrayLike) -> int | None:
        """Return the index of the component that holds a configuration; None: it is not safe."""
        q = np.asarray(q, dtype=float)
        if not (self.problem.forms(q) > 0).all() or not self._within(q):
            return None
        return next(self._holding(q), None)

    def _within(self, q: Floats) -> bool:
        ranges = zip(q, self.problem.ranges, strict=True)
        return all(limits is None or limits[0] < x < limits[1] for x, limits in ranges)

    def _holding(self, q: Floats) -> Iterator[int]:
        """Yield the owners of the cells that hold a safe configuration, at most two."""
        for q2 in (q[1], np.nextafter(q[1], np.inf)):
            shift, cells = self.over(float(q2))
            for k, (low, high) in zip(cells, self._at(cells, q[1] - shift), strict=True):
                turns = math.ceil((low - q[0]) / TURN) if self.problem.ranges[0] is None else 0
                if low <= q[0] + TURN * turns <= high:
                    yield self.owner[k]

    def _at(self, cells: list[int], q2: float) -> Floats:
        return self.intervals(cells, np.array([q2]))[..., 0].T


def find_fibres(problem: Problem, home: ArrayLike) -> Fibres:
    """Decompose a problem over its second joint; arguments as `qbound.region.solve`."""
    cells, found = components_over(problem, home, 1)
    owner = {k: i for i, (_, own) in enumerate(found) for k in own}
    return Fibres(problem, cells, tuple(component for component, _ in found), owner)
