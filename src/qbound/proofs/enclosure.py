"""What parts two configurations: few, large boxes, on each of which one boundary is violated.

A paving that separates has thousands of cells, most of them small, along the surfaces of what is
feasible. A certificate needs a wall between the two configurations alone, and that may stand deep
in what is infeasible, where cells are large. So infeasible cells are given up, the smallest and
shallowest first, as long as those that are left part the two; these are covered by the leaves of a
tree. Doubles: the checkers decide.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.forms.harmonic import HarmonicForm
from qbound.proofs.boxes import BoxBound
from qbound.proofs.connection import all_round, joined, touching
from qbound.proofs.dyadic import Cells
from qbound.proofs.forest import Forest
from qbound.proofs.paving import Paving

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

FINER = 12
"""How often a cell of the wall may be halved in one joint: the checkers' bound is another one."""

ROOM = 1e-9
"""Part of a form's size that a bound leaves on each leaf: more than rounding to decimals takes."""


@dataclass(frozen=True, eq=False)
class Wall:
    """Infeasible cells that part two configurations; none of them can be left out.

    Attributes
    ----------
    low, high : ndarray of int, shape (w, n)
        Corners of the cells, in units of which `2**bits` fill each joint's range.
    bits : int
    depth : ndarray, shape (w, m)
        How far each form is certainly below 0 on each cell, in parts of its size; else 0.
    """

    low: Ints
    high: Ints
    bits: int
    depth: Floats


def wall(paving: Paving, one: ArrayLike, other: ArrayLike) -> Wall:
    """Choose infeasible cells of a paving that part two configurations, as large as may be.

    Parameters
    ----------
    paving : Paving
        Separates the two, see `connection.separated`; without bodies.
    """
    closed = paving.infeasible[::-1]  # the smallest first
    cells = (*paving.feasible, paving.undecided, *closed)
    edges = touching(cells, all_round(paving), corners=True)
    first = np.cumsum([0, *map(len, cells)])
    ends = [
        np.concatenate(
            [
                start + np.flatnonzero(paving.containing(c, q))
                for start, c in zip(first, cells, strict=False)
            ]
        )
        for q in (one, other)
    ]
    ends = [found[found < first[-1 - len(closed)]] for found in ends]
    opened, label = _whole_sizes(edges, first[-1 - len(closed) :], ends)
    left = closed[opened:]
    depth = np.concatenate([_depths(paving, c) for c in left])
    levels = np.repeat([c.level for c in left], [len(c) for c in left])
    order = np.lexsort([depth.max(axis=1), -levels])
    groups = int(label.max()) + 1
    edges = np.concatenate([label, groups + np.arange(len(depth))])[edges]
    edges = edges[(edges >= groups).any(axis=1)]
    kept = _kept(edges, groups, (order + groups).tolist(), [set(label[e].tolist()) for e in ends])
    return _of_cells(left, np.array(kept) - groups, depth)


def _whole_sizes(edges: Ints, counts: Ints, ends: Sequence[Ints]) -> tuple[int, Ints]:
    """Open all closed cells of a size, size after size, as long as the rest parts the two.

    Parameters
    ----------
    edges : ndarray of int, shape (e, 2)
        Touching cells; open ones come first, then closed ones by their sizes.
    counts : ndarray of int
        How many cells are open at first, and with each size.
    ends : two ndarrays of int
        The open cells that hold either configuration.

    Returns
    -------
    opened : int
        How many sizes.
    label : ndarray of int
        The group of each open cell.
    """
    found = 0, np.zeros(0, dtype=np.int64)
    for opened, count in enumerate(counts.tolist()):
        label = joined(count, edges[(edges < count).all(axis=1)])
        if np.isin(label[ends[0]], label[ends[1]]).any():
            break
        found = opened, label
    return found


def _depths(paving: Paving, cells: Cells) -> Floats:
    """Return how far below 0 each form certainly is on each cell, in parts of its size."""
    _, high = paving.bounds.bounds(cells)
    size = np.abs(paving.bounds.table.coefficients[:, 0]).reshape(high.shape[1], -1).sum(axis=1)
    return np.asarray(np.maximum(-high, 0) / np.where(size > 0, size, 1))


def _kept(
    edges: Ints, first: int, order: Sequence[int], ends: Sequence[Iterable[int]]
) -> list[int]:
    """Open closed cells one after the other; keep those that would join the two sides.

    Parameters
    ----------
    edges : ndarray of int, shape (e, 2)
        Pairs of touching cells; numbers below `first` are groups of open ones.
    order : sequence of int
        Closed cells, in the order in which they are opened.
    ends : two sequences of int
        The groups on either side.
    """
    near: dict[int, list[int]] = {k: [] for k in order}
    for a, b in edges.tolist():
        if a >= first:
            near[a].append(b)
        if b >= first:
            near[b].append(a)
    leader = list(range(first))
    sides = [0] * first
    for side, labels in enumerate(ends, 1):
        for k in labels:
            sides[k] = side
    leader += range(first, first + len(order))
    sides += [0] * len(order)
    is_open = [k < first for k in range(len(leader))]

    def lead(k: int) -> int:
        while leader[k] != k:
            leader[k] = leader[leader[k]]
            k = leader[k]
        return k

    kept = []
    for k in order:
        met = {lead(other) for other in near[k] if is_open[other]}
        if len({sides[m] for m in met} - {0}) > 1:
            kept.append(k)
            continue
        is_open[k] = True
        for m in met:
            leader[m] = k
            sides[k] = sides[k] or sides[m]
    return kept


def _of_cells(groups: Sequence[Cells], chosen: Ints, depth: Floats) -> Wall:
    """Return some of the cells, numbered through, in the units of the finest."""
    bits = max(int(cells.bits.max()) for cells in groups)
    low = np.concatenate([cells.index << (bits - cells.bits) for cells in groups])
    high = np.concatenate([(cells.index + 1) << (bits - cells.bits) for cells in groups])
    return Wall(low[chosen], high[chosen], bits, depth[chosen])


# --- the tree -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Covered:
    """A tree whose leaves with a number cover a wall.

    Attributes
    ----------
    tree : str
        Letters by the joints of the paving; numbers are those of forms.
    leaves : int
        How many leaves have a number.
    left : int
        Cells on which no form was found to be negative.
    """

    tree: str
    leaves: int
    left: int


def covered(wall: Wall, forms: HarmonicForm, low: Floats, high: Floats) -> Covered:
    """Cut a box until each part meets no cell of a wall, or one form is negative all over it.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Floats, in the order of the wall's.
    low, high : ndarray, shape (n,)
        The whole box, rad or length.
    """
    search = _Search(wall, forms, low, high)
    while search.boxes:
        search.sort()
    (tree,) = search.forest.trees()
    return Covered(tree, search.leaves, search.left)


@dataclass(frozen=True, eq=False)
class _Box:
    """A part of the whole: its number in the forest, its ends, the cells of the wall in it."""

    number: int
    low: Ints
    high: Ints
    cells: Ints


class _Search:
    """The boxes of one depth, and the forest of all cuts."""

    def __init__(self, wall: Wall, forms: HarmonicForm, low: Floats, high: Floats) -> None:
        self.wall, self.forms, self.low = wall, forms, low
        self.units = 2 ** (wall.bits + FINER)
        self.step = (high - low) / self.units
        self.cell_low, self.cell_high = wall.low << FINER, wall.high << FINER
        self.bounds: dict[int, BoxBound] = {}
        self.forest, self.leaves, self.left = Forest(1), 0, 0
        n = len(low)
        whole = np.zeros(n, dtype=np.int64), np.full(n, self.units)
        self.boxes = [_Box(0, *whole, np.arange(len(wall.low)))]

    def sort(self) -> None:
        """Close what is done, and cut the rest."""
        empty = [box for box in self.boxes if not len(box.cells)]
        self.forest.close([box.number for box in empty])
        full = [box for box in self.boxes if len(box.cells)]
        best = np.array([self._best(box) for box in full], dtype=np.int64)
        proved = np.zeros(len(full), dtype=bool)
        joints = np.zeros(len(full), dtype=np.int64)
        for form in np.unique(best):
            mine = np.flatnonzero(best == form)
            proved[mine], joints[mine] = self._bound(int(form), [full[k] for k in mine])
        done = [full[k].number for k in np.flatnonzero(proved)]
        self.forest.close(done, [f"{form}." for form in best[proved]])
        self.leaves += len(done)
        self.boxes = self._halves([(full[k], int(joints[k])) for k in np.flatnonzero(~proved)])

    def _best(self, box: _Box) -> int:
        """Return the form that is below 0 on most cells of a box, and deepest."""
        depth = self.wall.depth[box.cells]
        return int(((depth > 0).mean(axis=0) + depth.min(axis=0) + depth.mean(axis=0)).argmax())

    def _bound(self, form: int, boxes: Sequence[_Box]) -> tuple[Bools, Ints]:
        """Tell on which boxes a form is negative throughout, and which joint is to be cut."""
        if form not in self.bounds:
            free = np.ones(len(self.low), dtype=bool)
            self.bounds[form] = BoxBound(-self.forms[form], free)
        bound = self.bounds[form]
        ends = [np.array([getattr(box, end) for box in boxes]) for end in ("low", "high")]
        centres = self.low + self.step * (ends[0] + ends[1]) / 2
        halves = self.step * (ends[1] - ends[0]) / 2
        least, _ = bound.least(centres, halves)
        proved = least > ROOM * bound.size
        joints = bound.losses(centres, halves).argmax(axis=1)
        for k, box in enumerate(boxes):
            trimmed = self._trimmed(box)
            if trimmed is not None:
                joints[k] = trimmed
        return np.asarray(proved), np.asarray(joints)

    def _trimmed(self, box: _Box) -> int | None:
        """Return a joint of which one half of the box has no cell of the wall."""
        middle = (box.low + box.high) // 2
        low, high = self.cell_low[box.cells].min(axis=0), self.cell_high[box.cells].max(axis=0)
        halves = np.flatnonzero((low >= middle) | (high <= middle))
        return int(halves[(box.high - box.low)[halves].argmax()]) if len(halves) else None

    def _halves(self, cuts: Sequence[tuple[_Box, int]]) -> list[_Box]:
        """Cut boxes at the middle of a joint."""
        fine = [(box, j) for box, j in cuts if box.high[j] - box.low[j] > 1]
        self.left += len(cuts) - len(fine)
        numbers = [box.number for box, _ in fine]
        new = self.forest.cut(numbers, np.array([j for _, j in fine], dtype=np.int64))
        found = []
        for k, (box, j) in enumerate(fine):
            middle = (box.low[j] + box.high[j]) // 2
            below, above = box.high.copy(), box.low.copy()
            below[j] = above[j] = middle
            lower = box.cells[self.cell_low[box.cells, j] < middle]
            upper = box.cells[self.cell_high[box.cells, j] > middle]
            found += [
                _Box(int(new[2 * k]), box.low, below, lower),
                _Box(int(new[2 * k + 1]), above, box.high, upper),
            ]
        return found
