"""Proofs that two configurations are joined, or that nothing joins them.

Joined: a chain of cells, proved feasible and each sharing a face with the next, leads from one to
the other. Separated: the cells that are not proved infeasible form groups that do not touch, not
even in a corner, and the two configurations lie in different groups; every path between them meets
a cell on which some boundary is violated throughout. Joints that turn all the way round close the
range on itself.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats, Ints
from cspace.extras import require
from cspace.proofs import Verdict
from cspace.proofs.exact.bounds import DEEPEST, Cells
from cspace.proofs.exact.problem import ExactProblem
from cspace.proofs.subpaving.paving import Paving, start
from qbound.circle import nearest_turn

Answer = Literal["connected", "separated", "infeasible", "undecided"]

MOST_CELLS = 200_000
"""Undecided cells at which a search for a connection gives up."""


@dataclass(frozen=True, eq=False)
class Connection:
    """The answer whether two configurations are connected, with its proof; not in the paper.

    Attributes
    ----------
    verdict : Verdict
        Whether they are connected.
    paving : Paving
        The cells that prove it.
    path : ndarray, shape (k, n), or None
        If connected: corners of a path, unrolled, from one configuration to the other. Each leg
        lies in one feasible cell.
    infeasible : tuple of int
        Which of the two (0, 1) lies in a cell that is proved infeasible.
    """

    verdict: Verdict
    paving: Paving
    path: Floats | None = None
    infeasible: tuple[int, ...] = ()

    @property
    def answer(self) -> Answer:
        """The verdict in words that say why."""
        if self.verdict is Verdict.UNDECIDED:
            return "undecided"
        if self.verdict is Verdict.PROVED:
            return "connected"
        return "infeasible" if self.infeasible else "separated"


@dataclass(frozen=True, eq=False)
class Groups:
    """Cells and the group that each belongs to.

    Attributes
    ----------
    cells : tuple of Cells
    label : tuple of ndarray of int
        One array for each entry of `cells`; equal labels mean that a chain of touching cells joins
        them.
    edges : ndarray of int, shape (e, 2)
        Touching cells, numbered through all entries.
    """

    cells: tuple[Cells, ...]
    label: tuple[Ints, ...]
    edges: Ints

    def containing(self, paving: Paving, q: ArrayLike) -> set[int]:
        """Return the labels of all groups in which a configuration may lie."""
        found = (
            label[paving.containing(c, q)] for c, label in zip(self.cells, self.label, strict=True)
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
        Joint values, rad or length; each double counts as an exact binary fraction.
    most : int
        Undecided cells at which to give up.

    Raises
    ------
    ValueError
        If a configuration is not allowed, or lies outside the limits.

    Examples
    --------
    >>> from cspace.proofs.exact.problem import exact_problem, exact_robot
    >>> problem = exact_problem(exact_robot("minervabot-v2"))
    >>> connection(problem, [0.0, 0.0], [0.2, -0.5]).answer
    'connected'

    Both poses may be feasible, and yet no feasible path joins them:

    >>> connection(problem, [0.0, 0.0], [0.2, 2.5]).answer
    'separated'
    """
    for q in (one, other):
        values = np.asarray(q, dtype=float)
        if values.shape != (len(problem.kinds),) or not np.isfinite(values).all():
            raise ValueError(f"{q} is no configuration of {len(problem.kinds)} joints")
    paving = start(problem)
    for q in (one, other):
        _verdicts(paving, q)  # refuses what lies outside of the limits
    while True:
        said = [_verdicts(paving, q) for q in (one, other)]
        bad = tuple(k for k, words in enumerate(said) if words == {Verdict.REFUTED})
        if bad:
            return Connection(Verdict.REFUTED, paving, infeasible=bad)
        spent = 2 * len(paving.undecided) > most or paving.level >= DEEPEST
        last = spent or not len(paving.undecided)
        if last or paving.level % len(problem.kinds) == 0:
            found = _classify(paving, one, other)
            if last or found.verdict is not Verdict.UNDECIDED:
                return found
        paving = paving.refined()


def outer_groups(paving: Paving) -> Groups:
    """Group the cells not proved infeasible; cells that share even a corner belong together."""
    return _groups(paving, (*paving.feasible, paving.undecided), corners=True)


def inner_groups(paving: Paving) -> Groups:
    """Group the cells proved feasible; cells that share a part of a face belong together."""
    return _groups(paving, paving.feasible, corners=False)


def separated(paving: Paving, one: ArrayLike, other: ArrayLike) -> bool:
    """Tell whether a paving proves that no feasible path joins two configurations."""
    groups = outer_groups(paving)
    return not groups.containing(paving, one) & groups.containing(paving, other)


def separating_cells(paving: Paving, q: ArrayLike) -> tuple[Cells, ...]:
    """Return the infeasible cells that enclose the group of a configuration and separate it.

    They include every cell that touches the group and does not belong to it.
    """
    groups = outer_groups(paving)
    held = groups.containing(paving, q)
    own = np.concatenate([np.isin(label, list(held)) for label in groups.label])
    everything = (*groups.cells, *paving.infeasible)
    edges = touching(everything, all_round(paving), corners=True)
    inside = np.concatenate([own, np.zeros(sum(map(len, paving.infeasible)), dtype=bool)])
    one, other = edges.T
    met = np.zeros(len(inside), dtype=bool)
    met[other[inside[one]]] = met[one[inside[other]]] = True
    ends = np.cumsum([len(c) for c in everything])[:-1]
    chosen = np.split(met & ~inside, ends)[len(groups.cells) :]
    return tuple(c[k] for c, k in zip(paving.infeasible, chosen, strict=True) if k.any())


def _verdicts(paving: Paving, q: ArrayLike) -> set[Verdict]:
    words = paving.verdicts(q)
    if not words:
        values = ", ".join(f"{x:.6g}" for x in np.asarray(q, dtype=float))
        raise ValueError(f"({values}) lies outside the joints' limits")
    return words


def _classify(paving: Paving, one: ArrayLike, other: ArrayLike) -> Connection:
    """Return what a paving proves about two configurations that are not proved infeasible."""
    if separated(paving, one, other):
        return Connection(Verdict.REFUTED, paving)
    path = None
    if all(paving.verdicts(q) == {Verdict.PROVED} for q in (one, other)):
        path = _path(paving, np.asarray(one, dtype=float), np.asarray(other, dtype=float))
    return Connection(Verdict.of(path is not None, False), paving, path)


# --- which cells touch ----------------------------------------------------------------------------


def _groups(paving: Paving, cells: Sequence[Cells], *, corners: bool) -> Groups:
    edges = touching(cells, all_round(paving), corners=corners)
    label = joined(sum(map(len, cells)), edges)
    ends = np.cumsum([len(c) for c in cells])[:-1]
    return Groups(tuple(cells), tuple(np.split(label, ends)), edges)


def joined(count: int, edges: Ints) -> Ints:
    """Return a number for each cell, equal where a chain of edges leads from one to another."""
    require("scipy")
    from scipy.sparse.csgraph import connected_components

    return np.asarray(connected_components(_graph(count, edges), directed=False)[1])


def _graph(count: int, edges: Ints) -> Any:
    """Return the graph of cells that touch as a sparse matrix."""
    from scipy.sparse import coo_array

    return coo_array((np.ones(len(edges)), tuple(edges.T)), shape=(count, count)).tocsr()


def all_round(paving: Paving) -> NDArray[np.bool_]:
    """Tell which joints turn all the way round."""
    return np.array([r is None for r in paving.problem.ranges])


def touching(cells: Sequence[Cells], circles: NDArray[np.bool_], *, corners: bool) -> Ints:
    """Return all pairs of touching cells, numbered through.

    If two cells touch, the larger one contains a neighbour of the smaller one of the same size.
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
            index, size = small.index + np.array(step), 2**small.bits
            there = ~((index < 0) | (index >= size))[:, ~circles].any(axis=1)
            index %= size
            for b, large in enumerate(cells):
                if large.level <= small.level and len(large):
                    wanted = _key(index >> (small.bits - large.bits), large.bits)
                    place = np.searchsorted(keys[b], wanted, sorter=orders[b])
                    match = orders[b][np.minimum(place, len(large) - 1)]
                    pair = np.flatnonzero(there & (keys[b][match] == wanted))
                    edges.append(np.stack([first[a] + pair, first[b] + match[pair]], axis=-1))
    return np.concatenate(edges)


def _key(index: Ints, bits: Ints) -> Ints:
    """Return one number for each index."""
    key = np.zeros(len(index), dtype=np.int64)
    for column, b in zip(index.T, bits, strict=True):
        key = (key << int(b)) | column
    return key


# --- a path through feasible cells ----------------------------------------------------------------


def _path(paving: Paving, one: Floats, other: Floats) -> Floats | None:
    """Return a path from centre to centre through shared faces, or None."""
    groups = inner_groups(paving)
    chain = _chain(groups, *(_numbers(paving, groups, q) for q in (one, other)))
    if not chain:
        return None
    places = zip(*map(paving.bounds.places, groups.cells), strict=True)
    low, high = (np.concatenate(ends)[chain] for ends in places)
    centres, circles = (low + high) / 2, all_round(paving)
    corners = [one]
    for k, centre in enumerate(centres):
        corners.append(_near(centre, corners[-1], circles))
        if k + 1 < len(chain):
            shift = _near(centres[k + 1], centre, circles) - centres[k + 1]
            face = np.maximum(low[k], low[k + 1] + shift), np.minimum(high[k], high[k + 1] + shift)
            corners.append(_near(sum(face) / 2, corners[-1], circles))
    return np.array([*corners, _near(other, corners[-1], circles)])


def _numbers(paving: Paving, groups: Groups, q: Floats) -> Ints:
    """Return the numbers of the feasible cells that may hold a configuration."""
    return np.flatnonzero(np.concatenate([paving.containing(c, q) for c in groups.cells]))


def _chain(groups: Groups, ones: Ints, others: Ints) -> list[int]:
    """Return a shortest chain of touching cells from one of some cells to one of others."""
    from scipy.sparse.csgraph import dijkstra

    graph = _graph(sum(map(len, groups.cells)), groups.edges)
    steps, before, _ = dijkstra(
        graph,
        directed=False,
        indices=ones,
        unweighted=True,
        min_only=True,
        return_predecessors=True,
    )
    chain = [int(others[steps[others].argmin()])]
    if not np.isfinite(steps[chain[0]]):
        return []
    while steps[chain[-1]]:
        chain.append(int(before[chain[-1]]))
    return chain[::-1]


def _near(q: Floats, place: Floats, circles: NDArray[np.bool_]) -> Floats:
    """Shift a configuration by full turns next to a place."""
    return np.where(circles, nearest_turn(q, place), q)
