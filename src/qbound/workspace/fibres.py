"""The region of two joints as fibres: for each value of the second joint, intervals of the first.

The decomposition with the second joint as its base is exactly that.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats
from qbound.forms.angles import TURN
from qbound.region import Problem, Region, UnresolvedError, solve


@dataclass(frozen=True, eq=False)
class Fibres(Region):
    """A region whose cells have the second joint as their base."""

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


def find_fibres(problem: Problem, home: ArrayLike) -> Fibres:
    """Decompose a problem over its second joint; arguments as `qbound.region.region.solve`.

    Raises
    ------
    UnresolvedError
        If the structure could be decided over the first joint only.
    """
    region = solve(problem, home, base=1)
    if region.base != 1:
        raise UnresolvedError("the fibres over the second joint could not be decided")
    return Fibres(**vars(region))
