"""What disconnects two configurations: few, large boxes, each violating one boundary throughout.

A paving that separates has thousands of cells, most of them small, along the surfaces of what is
feasible. A certificate needs a separator of the two configurations alone, and that may lie deep in
what is infeasible, where cells are large. So infeasible cells are given up, the smallest and
shallowest first, as long as those that are left separate the two; these are covered by the leaves
of a tree. Doubles: the checkers decide.
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
"""How often a cell may be halved in each joint: the checkers' bound is not that of a paving."""

ROOM = 1e-9
"""Part of a form's size that a bound leaves on each leaf: more than rounding to decimals takes."""


@dataclass(frozen=True, eq=False)
class Separator:
    """Infeasible cells that separate two configurations; none of them can be left out.

    Attributes
    ----------
    low, high : ndarray of int, shape (s, n)
        Corners of the cells, in units of which `2**bits` fill each joint's range.
    bits : int
    depth : ndarray, shape (s, m)
        How far each form is certainly below 0 on each cell, in parts of its size; else 0.
    """

    low: Ints
    high: Ints
    bits: int
    depth: Floats


def separator(paving: Paving, one: ArrayLike, other: ArrayLike) -> Separator:
    """Choose infeasible cells of a paving that separate two configurations, large ones if possible.

    Not in the paper.

    Parameters
    ----------
    paving : Paving
        Separates the two, see `connection.separated`; without bodies.
    one, other : array_like, shape (n,)
        rad or length.

    Raises
    ------
    ValueError
        If the paving does not separate them.

    Examples
    --------
    >>> from qbound.proofs.connection import connection
    >>> from qbound.proofs.exact import exact_problem, exact_robot
    >>> ends = [0.0, 0.0], [0.2, 2.5]
    >>> found = connection(exact_problem(exact_robot("minervabot-v2")), *ends)
    >>> chosen = separator(found.paving, *ends)
    >>> len(chosen.low) < found.paving.cells / 10
    True
    """
    closed = paving.infeasible[::-1]  # the smallest first
    cells = (*paving.feasible, paving.undecided, *closed)
    first = np.cumsum([0, *map(len, cells)])
    edges = touching(cells, all_round(paving), corners=True)
    ends = [
        np.flatnonzero(np.concatenate([paving.containing(c, q) for c in cells]))
        for q in (one, other)
    ]
    counts = first[-1 - len(closed) :]
    opened, label = _open_sizes(edges, counts, [found[found < counts[0]] for found in ends])
    if not len(label):
        raise ValueError("the paving does not separate the two configurations")
    left, groups = closed[opened:], int(label.max()) + 1
    depth = np.concatenate([_depths(paving, c) for c in left])
    levels = np.repeat([c.level for c in left], [len(c) for c in left])
    order = groups + np.lexsort([depth.max(axis=1), -levels])
    edges = np.concatenate([label, groups + np.arange(len(depth))])[edges]
    sides = [set(label[found[found < counts[0]]].tolist()) for found in ends]
    kept = _kept(edges[(edges >= groups).any(axis=1)], groups, order.tolist(), sides)
    return _of_cells(left, np.array(kept) - groups, depth)


def _open_sizes(edges: Ints, counts: Ints, ends: Sequence[Ints]) -> tuple[int, Ints]:
    """Open all infeasible cells of a size, size after size, as long as the rest separates.

    Parameters
    ----------
    edges : ndarray of int, shape (e, 2)
        Touching cells; those that are open at first come first, then size after size.
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
    table = paving.bounds.table.coefficients[:, 0]
    size = np.abs(table).reshape(len(table), -1).sum(axis=1)
    return np.asarray(np.maximum(-high, 0) / np.where(size > 0, size, 1))


def _kept(
    edges: Ints, groups: int, order: Sequence[int], ends: Sequence[Iterable[int]]
) -> list[int]:
    """Open closed cells one after the other; return those that would join the two sides.

    Parameters
    ----------
    edges : ndarray of int, shape (e, 2)
        Pairs of touching cells; numbers below `groups` are groups of open ones.
    order : sequence of int
        Closed cells, in the order in which they are opened.
    ends : two sequences of int
        The groups on either side.
    """
    near: dict[int, list[int]] = {k: [] for k in order}
    for a, b in edges.tolist():
        for one, other in ((a, b), (b, a)):
            if one in near:
                near[one].append(other)
    leader = list(range(groups + len(order)))
    sides = {k: side for side, labels in enumerate(ends) for k in labels}

    def lead(k: int) -> int:
        while leader[k] != k:
            leader[k] = leader[leader[k]]
            k = leader[k]
        return k

    closed, kept = set(order), []
    for k in order:
        met = {lead(other) for other in near[k] if other not in closed}
        side = {sides[m] for m in met if m in sides}
        if len(side) > 1:
            kept.append(k)
            continue
        closed.remove(k)
        for m in met:
            leader[m] = k
            if m in sides:
                sides[k] = sides[m]
    return kept


def _of_cells(groups: Sequence[Cells], chosen: Ints, depth: Floats) -> Separator:
    """Return some of the cells, numbered through, in the units of the finest."""
    bits = max(int(cells.bits.max()) for cells in groups)
    low = np.concatenate([cells.index << (bits - cells.bits) for cells in groups])
    high = np.concatenate([(cells.index + 1) << (bits - cells.bits) for cells in groups])
    return Separator(low[chosen], high[chosen], bits, depth[chosen])


# --- the tree -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Covering:
    """A tree whose leaves with a number cover a separator.

    Attributes
    ----------
    tree : str
        Letters by the joints of the paving; numbers are those of forms.
    left : int
        Boxes on which no form was proved negative.
    """

    tree: str
    left: int


def covering(cells: Separator, forms: HarmonicForm, low: Floats, high: Floats) -> Covering:
    """Cut a box until each part meets no cell, or one form is negative all over it.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Floats, in the order of the separator's.
    low, high : ndarray, shape (n,)
        The whole box, rad or length.
    """
    search = _Search(cells, forms, low, high)
    while search.boxes:
        search.sort()
    (tree,) = search.forest.trees()
    return Covering(tree, search.left)


@dataclass(frozen=True, eq=False)
class _Box:
    """A part of the whole: its number in the forest, its ends, the cells that it meets."""

    number: int
    low: Ints
    high: Ints
    cells: Ints


class _Search:
    """The boxes of one depth, and the forest of all cuts."""

    def __init__(self, cells: Separator, forms: HarmonicForm, low: Floats, high: Floats) -> None:
        units, n = 2 ** (cells.bits + FINER), len(low)
        self.depth, self.forms = cells.depth, forms
        self.low, self.step = low, (high - low) / units
        self.cell_low, self.cell_high = cells.low << FINER, cells.high << FINER
        self.bounds: dict[int, BoxBound] = {}
        self.forest, self.left = Forest(1), 0
        ends = np.zeros(n, dtype=np.int64), np.full(n, units, dtype=np.int64)
        self.boxes = [_Box(0, *ends, np.arange(len(cells.low)))]

    def sort(self) -> None:
        """Close what is done, and cut the rest."""
        empty = [box for box in self.boxes if not len(box.cells)]
        self.forest.close([box.number for box in empty])
        full = [box for box in self.boxes if len(box.cells)]
        best = np.array([self._best(box) for box in full], dtype=np.int64)
        cuts = list[tuple[_Box, int]]()
        for form in np.unique(best).tolist():
            mine = [box for box, k in zip(full, best, strict=True) if k == form]
            proved, joints = self._bound(form, mine)
            done = [box.number for box, is_proved in zip(mine, proved, strict=True) if is_proved]
            self.forest.close(done, [f"{form}."] * len(done))
            rows = zip(mine, proved, joints.tolist(), strict=True)
            cuts += [(box, self._cut(box, j)) for box, is_proved, j in rows if not is_proved]
        self.boxes = self._halves(cuts)

    def _best(self, box: _Box) -> int:
        """Return the form that is below 0 on most cells of a box, and deepest."""
        depth = self.depth[box.cells]
        return int(((depth > 0).mean(axis=0) + depth.min(axis=0) + depth.mean(axis=0)).argmax())

    def _bound(self, form: int, boxes: Sequence[_Box]) -> tuple[Bools, Ints]:
        """Tell where a form is negative throughout, and which joint takes most off the bound."""
        if form not in self.bounds:
            free = np.ones(len(self.low), dtype=bool)
            self.bounds[form] = BoxBound(-self.forms[form], free)
        bound = self.bounds[form]
        low, high = (np.array([getattr(box, end) for box in boxes]) for end in ("low", "high"))
        centres, halves = self.low + self.step * (low + high) / 2, self.step * (high - low) / 2
        least, _ = bound.least(centres, halves)
        joints = bound.losses(centres, halves).argmax(axis=1)
        return np.asarray(least > ROOM * bound.size), np.asarray(joints)

    def _cut(self, box: _Box, joint: int) -> int:
        """Return the joint to cut: the widest of which one half meets no cell, else a given one."""
        middle = (box.low + box.high) // 2
        low, high = self.cell_low[box.cells].min(axis=0), self.cell_high[box.cells].max(axis=0)
        free = np.flatnonzero((low >= middle) | (high <= middle))
        return int(free[(box.high - box.low)[free].argmax()]) if len(free) else joint

    def _halves(self, cuts: Sequence[tuple[_Box, int]]) -> list[_Box]:
        """Cut boxes at the middle of a joint; leave those that are too small."""
        fine = [(box, j) for box, j in cuts if box.high[j] - box.low[j] > 1]
        self.left += len(cuts) - len(fine)
        numbers, joints = [box.number for box, _ in fine], np.array([j for _, j in fine], dtype=int)
        new, found = self.forest.cut(numbers, joints).tolist(), list[_Box]()
        for k, (box, j) in enumerate(fine):
            middle = (box.low[j] + box.high[j]) // 2
            below, above = box.high.copy(), box.low.copy()
            below[j] = above[j] = middle
            lower = box.cells[self.cell_low[box.cells, j] < middle]
            upper = box.cells[self.cell_high[box.cells, j] > middle]
            found.append(_Box(new[2 * k], box.low, below, lower))
            found.append(_Box(new[2 * k + 1], above, box.high, upper))
        return found
