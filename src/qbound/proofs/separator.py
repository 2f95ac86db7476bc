"""What disconnects two configurations: few, large boxes, each violating one boundary throughout.

A paving that separates has thousands of cells, most of them small, along the surfaces of what is
feasible. A certificate needs a separator of the two configurations alone, and that may lie deep in
what is infeasible, where cells are large. So infeasible cells are given up, the smallest and
shallowest first, as long as those that are left separate the two.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats, Ints
from qbound.proofs.connection import all_round, joined, touching
from qbound.proofs.dyadic import Cells
from qbound.proofs.paving import Paving

Depths = Callable[[Floats, Floats], Floats]
"""From low and high corners, in parts of the joints' ranges, to how deep each thing to keep is
violated in the middle: shape (s, things), 0 where it is kept."""


@dataclass(frozen=True, eq=False)
class Separator:
    """Infeasible cells that separate two configurations; none of them can be left out.

    Attributes
    ----------
    low, high : ndarray, shape (s, n)
        Corners of the cells, in parts of each joint's range: exact.
    depth : ndarray, shape (s, things)
    """

    low: Floats
    high: Floats
    depth: Floats


def separator(paving: Paving, one: ArrayLike, other: ArrayLike, depths: Depths) -> Separator:
    """Choose infeasible cells of a paving that separate two configurations, large ones if possible.

    Not in the paper.

    Parameters
    ----------
    paving : Paving
        Separates the two, see `connection.separated`.
    one, other : array_like, shape (n,)
        rad or length.
    depths : callable
        Of cells of one size the shallowest are given up first.

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
    >>> chosen = separator(found.paving, *ends, lambda low, high: np.ones((len(low), 1)))
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
    low, high = _corners(left)
    depth = depths(low, high)
    levels = np.repeat([c.level for c in left], [len(c) for c in left])
    order = groups + np.lexsort([depth.max(axis=1), -levels])
    edges = np.concatenate([label, groups + np.arange(len(depth))])[edges]
    sides = [set(label[found[found < counts[0]]].tolist()) for found in ends]
    kept = _kept(edges[(edges >= groups).any(axis=1)], groups, order.tolist(), sides)
    chosen = np.array(kept) - groups
    return Separator(low[chosen], high[chosen], depth[chosen])


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


def _corners(cells: Sequence[Cells]) -> tuple[Floats, Floats]:
    """Return low and high corners of cells, in parts of the ranges."""
    low = np.concatenate([each.index / 2.0**each.bits for each in cells])
    return low, np.concatenate([(each.index + 1) / 2.0**each.bits for each in cells])


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
