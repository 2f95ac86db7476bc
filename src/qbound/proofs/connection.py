"""Proofs that two configurations are joined, or that nothing joins them.

Joined: a chain of cells, each proved feasible throughout, each sharing a face with the next; the
straight way from one to the other stays inside. Separated: the cells that are not proved infeasible
fall into groups that do not touch, not even in a corner, and the two configurations lie in
different groups; every path between them meets a cell on which some boundary is violated
throughout. Joints that turn all the way round close the range on itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.proofs.dyadic import DEEPEST, Cells
from qbound.proofs.exact import ExactProblem
from qbound.proofs.paving import Paving, start

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Answer = Literal["connected", "separated", "infeasible", "undecided"]

MOST_CELLS = 200_000
"""Undecided cells at which a search for a connection gives up."""


@dataclass(frozen=True, eq=False)
class Connection:
    """What is proved about two configurations, and by what; not in the paper.

    Attributes
    ----------
    answer : {"connected", "separated", "infeasible", "undecided"}
    paving : Paving
        The cells that prove it.
    path : ndarray, shape (k, n), or None
        Where connected: corners of a path, the two configurations first and last, unrolled. Each
        leg lies in one feasible cell.
    infeasible : tuple of int
        Which of the two (0, 1) lies in a cell that is proved infeasible.
    """

    answer: Answer
    paving: Paving
    path: Floats | None = None
    infeasible: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Groups:
    """Cells and the group that each belongs to.

    Attributes
    ----------
    cells : tuple of Cells
    label : tuple of ndarray of int
        One array for each entry of `cells`: equal where a chain of touching cells leads over.
    edges : ndarray of int, shape (e, 2)
        Touching cells, numbered through all entries.
    """

    cells: tuple[Cells, ...]
    label: tuple[Ints, ...]
    edges: Ints

    def holding(self, paving: Paving, q: ArrayLike) -> set[int]:
        """Return the labels of all groups in which a configuration may lie."""
        found = (
            label[paving.holding(c, q)] for c, label in zip(self.cells, self.label, strict=True)
        )
        return {int(x) for labels in found for x in labels}


def connection(
    problem: ExactProblem, one: ArrayLike, other: ArrayLike, most: int = MOST_CELLS
) -> Connection:
    """Prove that two configurations are connected, or that they are not.

    Parameters
    ----------
    problem : ExactProblem
    one, other : array_like, shape (n,)
        Joint values, rad or length; each double counts as it is.
    most : int
        Undecided cells at which to give up.

    Raises
    ------
    ValueError
        If a configuration is none, or lies outside the limits.
    """
    for q in (one, other):
        values = np.asarray(q, dtype=float)
        if values.shape != (len(problem.kinds),) or not np.isfinite(values).all():
            raise ValueError(f"{q} is no configuration of {len(problem.kinds)} joints")
    paving = start(problem)
    while True:
        bad = tuple(k for k, q in enumerate((one, other)) if _words(paving, q) == {"infeasible"})
        if bad:
            return Connection("infeasible", paving, infeasible=bad)
        if paving.level % len(problem.kinds) == 0:
            found = _judged(paving, one, other)
            if found is not None:
                return found
        if 2 * len(paving.undecided) > most or paving.level >= DEEPEST or not len(paving.undecided):
            return _judged(paving, one, other) or Connection("undecided", paving)
        paving = paving.refined()


def outer_groups(paving: Paving) -> Groups:
    """Group the cells not proved infeasible: cells that share as much as a corner hang together."""
    return _groups(paving, (*paving.feasible, paving.undecided), corners=True)


def inner_groups(paving: Paving) -> Groups:
    """Group the cells proved feasible: cells that share a part of a face hang together."""
    return _groups(paving, paving.feasible, corners=False)


def separated(paving: Paving, one: ArrayLike, other: ArrayLike) -> bool:
    """Tell whether a paving proves that no feasible path joins two configurations."""
    groups = outer_groups(paving)
    return not groups.holding(paving, one) & groups.holding(paving, other)


def wall(paving: Paving, q: ArrayLike) -> tuple[Cells, ...]:
    """Return the infeasible cells that enclose the group of a configuration: what separates it.

    Every cell that touches the group and is not of it is among them.
    """
    groups = outer_groups(paving)
    held = groups.holding(paving, q)
    own = np.concatenate([np.isin(label, list(held)) for label in groups.label])
    circles = [r is None for r in paving.problem.ranges]
    everything = (*groups.cells, *paving.infeasible)
    edges = _touching(everything, circles, corners=True)
    inside = np.concatenate([own, np.zeros(sum(map(len, paving.infeasible)), dtype=bool)])
    one, other = edges.T
    met = np.zeros(len(inside), dtype=bool)
    met[other[inside[one]]] = met[one[inside[other]]] = True
    ends = np.cumsum([len(c) for c in everything])[:-1]
    chosen = np.split(met & ~inside, ends)[len(groups.cells) :]
    return tuple(c[k] for c, k in zip(paving.infeasible, chosen, strict=True) if k.any())


def _words(paving: Paving, q: ArrayLike) -> set[str]:
    words = {word for word, _ in paving.cells_of(q)}
    if not words:
        values = ", ".join(f"{x:.6g}" for x in np.asarray(q, dtype=float))
        raise ValueError(f"({values}) lies outside the joints' limits")
    return words


def _judged(paving: Paving, one: ArrayLike, other: ArrayLike) -> Connection | None:
    if separated(paving, one, other):
        return Connection("separated", paving)
    if all(_words(paving, q) == {"feasible"} for q in (one, other)):
        path = _path(paving, np.asarray(one, dtype=float), np.asarray(other, dtype=float))
        return None if path is None else Connection("connected", paving, path)
    return None


# --- which cells touch ----------------------------------------------------------------------------


def _groups(paving: Paving, cells: Sequence[Cells], *, corners: bool) -> Groups:
    circles = [r is None for r in paving.problem.ranges]
    edges = _touching(cells, circles, corners=corners)
    count = sum(map(len, cells))
    label = np.split(_labels(count, edges), np.cumsum([len(c) for c in cells])[:-1])
    return Groups(tuple(cells), tuple(label), edges)


def _touching(cells: Sequence[Cells], circles: Sequence[bool], *, corners: bool) -> Ints:
    """Return all pairs of touching cells, numbered through.

    Of two touching cells the larger holds a neighbour, of the smaller one's size, of the smaller.
    """
    n = len(circles)
    steps = [
        s
        for s in product((-1, 0, 1), repeat=n)
        if sum(map(abs, s)) in range(1, n + 1 if corners else 2)
    ]
    first = np.cumsum([0, *(len(c) for c in cells)])
    keys = [_key(c.index, c.bits) for c in cells]
    orders = [np.argsort(k) for k in keys]
    edges = [np.zeros((0, 2), dtype=np.int64)]
    for a, small in enumerate(cells):
        for step in steps:
            index, there = _stepped(small, np.array(step), circles)
            for b, large in enumerate(cells):
                if large.level <= small.level:
                    wanted = _key(index >> (small.bits - large.bits), large.bits)
                    place = np.searchsorted(keys[b], wanted, sorter=orders[b])
                    match = (
                        orders[b][np.minimum(place, len(large) - 1)] if len(large) else place * 0
                    )
                    hit = there & (keys[b][match] == wanted) if len(large) else there & False
                    pair = np.flatnonzero(hit)
                    edges.append(np.stack([first[a] + pair, first[b] + match[pair]], axis=-1))
    return np.concatenate(edges)


def _stepped(cells: Cells, step: Ints, circles: Sequence[bool]) -> tuple[Ints, NDArray[np.bool_]]:
    """Return the neighbours' indices one step away, and which of them exist."""
    size = 2**cells.bits
    index = cells.index + step
    outside = (index < 0) | (index >= size)
    return index % size, ~(outside & ~np.array(circles)).any(axis=1)


def _key(index: Ints, bits: Ints) -> Ints:
    """Return one number for each index."""
    key = np.zeros(len(index), dtype=np.int64)
    for column, b in zip(index.T, bits, strict=True):
        key = (key << int(b)) | column
    return key


def _labels(count: int, edges: Ints) -> Ints:
    """Return the smallest number of each connected set: take neighbours' until none changes."""
    label = np.arange(count)
    while True:
        least = label.copy()
        low = np.minimum(label[edges[:, 0]], label[edges[:, 1]])
        np.minimum.at(least, label[edges[:, 0]], low)
        np.minimum.at(least, label[edges[:, 1]], low)
        while (least != least[least]).any():
            least = least[least]
        new = least[label]
        if (new == label).all():
            return label
        label = new


# --- a path through feasible cells ----------------------------------------------------------------


def _path(paving: Paving, one: Floats, other: Floats) -> Floats | None:
    """Return a path from centre to centre through shared faces, or None."""
    groups = inner_groups(paving)
    start_at, end_at = (_numbers(paving, groups, q) for q in (one, other))
    chain = _chain(groups, start_at, end_at)
    if chain is None:
        return None
    low, high = (
        np.concatenate(p) for p in zip(*map(paving.room.places, groups.cells), strict=True)
    )
    circles = np.array([r is None for r in paving.problem.ranges])
    corners = [one]
    for a, b in pairwise(chain):
        gate = _gate(low[a], high[a], low[b], high[b], circles)
        corners += [_near(centre, corners[-1], circles) for centre in ((low[a] + high[a]) / 2,)]
        corners += [_near(gate, corners[-1], circles)]
    corners += [_near((low[chain[-1]] + high[chain[-1]]) / 2, corners[-1], circles)]
    corners += [_near(other, corners[-1], circles)]
    return np.array(corners)


def _numbers(paving: Paving, groups: Groups, q: Floats) -> set[int]:
    """Return the numbers of the feasible cells that may hold a configuration."""
    held = np.concatenate([paving.holding(c, q) for c in groups.cells])
    return set(np.flatnonzero(held).tolist())


def _chain(groups: Groups, ones: set[int], others: set[int]) -> list[int] | None:
    """Return the shortest chain of touching cells, by breadth-first search from all of `ones`."""
    neighbours: dict[int, list[int]] = {}
    for a, b in groups.edges.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    before: dict[int, int | None] = dict.fromkeys(ones)
    queue = list(ones)
    for a in queue:
        if a in others:
            return _back(before, a)
        for b in neighbours.get(a, ()):
            if b not in before:
                before[b] = a
                queue.append(b)
    return None


def _back(before: dict[int, int | None], last: int) -> list[int]:
    chain, step = [], before[last]
    chain.append(last)
    while step is not None:
        chain.append(step)
        step = before[step]
    return chain[::-1]


def _gate(low_a: Floats, high_a: Floats, low_b: Floats, high_b: Floats, circles: Floats) -> Floats:
    """Return the middle of the face that two cells share, near the first."""
    shift = np.where(
        circles, 2 * np.pi * np.round(((low_a + high_a) - (low_b + high_b)) / (4 * np.pi)), 0.0
    )
    return np.asarray((np.maximum(low_a, low_b + shift) + np.minimum(high_a, high_b + shift)) / 2)


def _near(q: Floats, place: Floats, circles: Floats) -> Floats:
    """Shift a configuration by full turns next to a place."""
    return np.asarray(q + np.where(circles, 2 * np.pi * np.round((place - q) / (2 * np.pi)), 0.0))
