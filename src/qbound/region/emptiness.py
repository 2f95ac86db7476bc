"""Boundaries that together leave no room where a region is empty, as few as it takes.

A place at which only some boundaries are violated shows that these cannot be missing. A few random
places propose boundaries of which each is violated somewhere; the cells that these alone leave give
another place, until they leave none. So the decompositions are of a few boundaries, not of all.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Bools, Floats
from qbound.region.decomposition import decompose
from qbound.region.pieces import INSIDE
from qbound.region.precise import Precise
from qbound.region.problem import Problem

TRIED = 1000
"""Random places at the start."""


def irreducible(problem: Problem, base: int) -> tuple[str, ...]:
    """Return boundaries that leave no room together, but would if any one of them were dropped.

    Parameters
    ----------
    problem : Problem
        Whose region is empty, without forms that depend on neither joint.
    base : int
        Which joint is the base of the cells.

    Returns
    -------
    tuple of str
        Empty where no boundary is to blame: a range has no width.
    """
    names = _names(problem)
    if not len(names):
        return ()  # a range has no width
    rows = _violated(problem, _random_places(problem))
    rows = rows[rows.any(axis=1)]
    while True:
        chosen = _greedy_cover(rows)
        place = _free_place(_only(problem, names[chosen]), base)
        if place is None:
            break
        # What was chosen is free there, although doubles may say that it touches.
        row = _violated(problem, place[None]) & ~chosen
        if not row.any():  # so near to contact only the cells of all decide
            chosen[:] = True
            break
        rows = np.concatenate([rows, row])
    for k in np.flatnonzero(chosen).tolist():
        without = chosen & (np.arange(len(chosen)) != k)
        needed = (~rows[:, without].any(axis=1)).any()
        if not needed and _free_place(_only(problem, names[without]), base) is None:
            chosen = without
    return tuple(names[chosen].tolist())


def _names(problem: Problem) -> NDArray[np.object_]:
    """Return the names of all boundaries, forms first."""
    return np.array([*problem.names, *(body.name for body in problem.bodies)], dtype=object)


def _random_places(problem: Problem) -> Floats:
    ends = np.array([(-np.pi, np.pi) if r is None else r for r in problem.ranges])
    return np.random.default_rng(0).uniform(ends[:, 0], ends[:, 1], (TRIED, 2))


def _violated(problem: Problem, q: Floats) -> Bools:
    """Tell which boundaries are violated at places, or touch, shape (n, boundaries)."""
    found = dict(zip(problem.evaluator.names, problem.evaluator.margins(q).T, strict=True))
    return np.stack([found[name] <= 0 for name in _names(problem)], axis=-1)


def _greedy_cover(rows: Bools) -> Bools:
    """Choose columns so that each row has one of them, each time the one that most rows have."""
    chosen, left = np.zeros(rows.shape[1], dtype=np.bool_), rows
    while len(left):
        best = int(left.sum(axis=0).argmax())
        chosen[best], left = True, left[~left[:, best]]
    return chosen


def _only(problem: Problem, kept: Iterable[str]) -> Problem:
    """Return the problem with some of its boundaries."""
    wanted = set(kept)
    problem = problem.without([k for k, name in enumerate(problem.names) if name not in wanted])
    return problem.without_bodies([b.name for b in problem.bodies if b.name not in wanted])


def _free_place(problem: Problem, base: int) -> Floats | None:
    """Return a place inside a cell, off its middles; None where there is no cell."""
    precise = Precise.of(problem, base)
    plane, found = precise.plane, decompose(precise)
    if not found.cells:
        return None
    # Of the cells over the widest slab, the first.
    slab, lower, upper = max(found.cells, key=lambda cell: np.diff(found.lines)[cell.slab])
    t = found.lines[slab] + INSIDE * (found.lines[slab + 1] - found.lines[slab])
    low, high = (float(plane.follow([root], np.array([[t]]))[0, 0]) for root in (lower, upper))
    v = low + INSIDE * (high - low)
    return np.array([t, v] if base == 0 else [v, t])
