"""Proof that balls cover a shape, by halving simplices; and a choice of few balls that do.

A ball is convex, so a simplex with all corners in one ball lies in that ball. A simplex that lies
in no single ball is halved. Every comparison leaves room for rounding, so a shape that is called
covered is covered.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Bools, Floats
from cspace.geometry.simplices import edges, halved
from cspace.tolerances import OUTWARD

HALVINGS = 60
"""Rounds of halving after which a simplex is given up."""

MOST_CELLS = 2_000_000
"""Simplices at once at which the proof is given up."""

AT_ONCE = 4_000_000
"""Distances of a chunk."""

IN_CACHE = 50_000
"""Distances of a chunk of which several arrays are held at once."""

PER_CORNER = 40
"""Distances that take as long as all else that is done about a corner of a simplex."""

MOST_TRIED = 200
"""Sets that may take another's place at most, of all that could evenly many."""

MOST_GAINS = 100_000
"""Missing elements, times such sets."""


class Work:
    """Elementary steps left for a task, some nanoseconds each; they are counted, not timed.

    Parameters
    ----------
    most : int
        Number of steps after which the task is given up.
    why : str
        Message of the error that is raised then.
    """

    def __init__(self, most: int, why: str) -> None:
        self.left, self.why = most, why

    def spend(self, steps: int) -> None:
        """Subtract steps before they are done; ValueError if fewer are left."""
        self.left -= steps
        if self.left < 0:
            raise ValueError(self.why)


class Cover(NamedTuple):
    """Balls that cover a shape.

    Attributes
    ----------
    centres : ndarray, shape (n, 3)
    radii : ndarray, shape (n,)
    excess : float
        No point of a ball is farther from the shape than this; length.
    """

    centres: Floats
    radii: Floats
    excess: float


def joined(covers: Iterable[Cover]) -> Cover:
    """Join the covers of several shapes."""
    found = [*covers]
    if not found:
        return Cover(np.zeros((0, 3)), np.zeros(0), 0.0)
    centres, radii = (np.concatenate(parts) for parts in zip(*(c[:2] for c in found), strict=True))
    return Cover(centres, radii, max(cover.excess for cover in found))


def uncovered(
    simplices: Floats, centres: Floats, radii: Floats, work: Work | None = None
) -> Floats:
    """Return the simplices that are not proved to lie in the union of balls; empty if none.

    Parameters
    ----------
    simplices : ndarray, shape (N, k, n)
    centres : ndarray, shape (m, n)
    radii : ndarray, shape (m,)
    work : Work, optional
        A step is the distance of a corner from a centre; halving costs `PER_CORNER`.

    Returns
    -------
    ndarray, shape (M, k, n)
        Parts of the simplices given: those with a corner outside of every ball, which refute the
        cover, and those that were given up.

    Notes
    -----
    Each radius is first made smaller by `OUTWARD` of the largest coordinate: this is more than
    halvings and distances can lose to rounding, some 70 units in the last place.

    Examples
    --------
    Two balls cover a segment, and a third of a radius less leaves its middle out:

    >>> import numpy as np
    >>> segment, centres = np.array([[[-1.0], [1.0]]]), np.array([[-0.6], [0.6]])
    >>> len(uncovered(segment, centres, np.array([0.7, 0.7])))
    0
    >>> len(uncovered(segment, centres, np.array([0.5, 0.5]))) > 0
    True
    """
    size = max((float(np.abs(x).max()) for x in (simplices, centres) if x.size), default=0.0)
    shrunk = radii - OUTWARD * size
    left: list[Floats] = []
    cells = np.asarray(simplices, dtype=float)
    for _ in range(HALVINGS):
        if not len(cells) or len(cells) > MOST_CELLS:
            break
        if work is not None:
            work.spend(cells.shape[0] * cells.shape[1] * (len(centres) + PER_CORNER))
        inside, outside = _judged(cells, centres, shrunk)
        left.append(cells[outside])
        cells = cells[~inside & ~outside]
        longest = np.linalg.norm(edges(cells), axis=-1).argmax(axis=1)
        cells = halved(cells, longest)
    return np.concatenate([*left, cells])


def _judged(cells: Floats, centres: Floats, radii: Floats) -> tuple[Bools, Bools]:
    """Tell which simplices lie in one ball, and which have a corner in none."""
    inside, outside = np.zeros(len(cells), dtype=bool), np.ones(len(cells), dtype=bool)
    step = max(1, AT_ONCE // max(1, len(centres) * cells.shape[1]))
    for k in range(0, len(cells) if len(centres) else 0, step):
        corners = cells[k : k + step]
        one_by_one = within(corners.reshape(-1, corners.shape[-1]), centres, radii)
        held: Bools = one_by_one.reshape(len(corners), corners.shape[1], len(centres))
        inside[k : k + step] = np.any(np.all(held, axis=1), axis=1)
        outside[k : k + step] = ~np.all(np.any(held, axis=2), axis=1)
    return inside, outside


def within(points: Floats, centres: Floats, radii: Floats) -> Bools:
    """Tell which points lie in which balls, shape (points, balls)."""
    found = np.zeros((len(points), len(centres)), dtype=bool)
    limits = np.where(radii > 0, radii, -1.0)  # no distance is below a negative radius
    limits *= np.abs(limits)
    step = max(1, IN_CACHE // max(1, len(centres)))
    for k in range(0, len(points), step):
        part = points[k : k + step]
        squared = np.zeros((len(part), len(centres)))
        for i in range(points.shape[1]):
            away = part[:, i, None] - centres[:, i]
            squared += np.square(away, out=away)
        np.less_equal(squared, limits, out=found[k : k + step])
    return found


def few(covers: Bools, costs: Floats | None = None, most: int | None = None) -> NDArray[Any]:
    """Choose few of many sets that together have every element of all sets.

    Greedy: the set with the most new elements for its cost comes first. Sets that became needless
    are left out at the end.

    Parameters
    ----------
    covers : ndarray of bool, shape (sets, elements)
    costs : ndarray, shape (sets,), optional
        Above 0; default: 1 each.
    most : int, optional
        Number of sets after which the choice stops unfinished, because more would be too many
        anyway.

    Returns
    -------
    ndarray of int
        Indices of the sets.
    """
    price = np.ones(len(covers)) if costs is None else costs
    open_elements = covers.any(axis=0)
    counts = np.count_nonzero(covers, axis=1)
    chosen: list[int] = []
    while open_elements.any():
        best = int((counts / price).argmax())
        new = covers[best] & open_elements
        counts = counts - np.count_nonzero(covers.T[new], axis=0)
        open_elements &= ~new
        chosen.append(best)
        if most is not None and len(chosen) > most:
            return np.array(chosen, dtype=int)
    return np.array(_needed(covers, chosen), dtype=int)


def _needed(covers: Bools, chosen: list[int]) -> list[int]:
    """Leave out each set whose elements the other sets have, the last set first."""
    times = covers[chosen].sum(axis=0)
    kept = []
    for each in reversed(chosen):
        if (times[covers[each]] > 1).all():
            times = times - covers[each]
        else:
            kept.append(each)
    return kept[::-1]


def fewer(covers: Bools, chosen: NDArray[Any], steps: int) -> NDArray[Any]:
    """Search for a smaller choice of sets that together have all that a choice has.

    One set is left out. While elements are missing, the set whose removal loses least is replaced
    by a set with the element that has been missing longest (local search with weights: Gao, Weise,
    Li, 2015).

    Parameters
    ----------
    covers : ndarray of bool, shape (sets, elements)
    chosen : ndarray of int
    steps : int
        Largest number of exchanges in all.

    Returns
    -------
    ndarray of int
        Indices of the smallest choice that was found.

    Examples
    --------
    Two sets do what a greedy choice does with three:

    >>> import numpy as np
    >>> texts = ["11110001111000", "00001100000110", "00000010000001", "1" * 7 + "0" * 7]
    >>> sets = np.array([[*map(int, text)] for text in [*texts, "0" * 7 + "1" * 7]], dtype=bool)
    >>> few(sets).tolist(), sorted(fewer(sets, few(sets), 10).tolist())
    ([0, 1, 2], [3, 4])
    """
    held = covers[chosen].any(axis=0)
    now = _Choice(covers if held.all() else covers[:, held], chosen)
    best = np.array(chosen, dtype=int)
    for _ in range(steps):
        while len(now.sets) > 1 and (now.times > 0).all():
            best = np.array(now.sets, dtype=int)
            now.drop_least()
        if (now.times > 0).all():
            break
        now.drop_least()
        now.add_for_longest_missing()
        now.weights[now.times == 0] += 1
    return np.array(now.sets, dtype=int) if (now.times > 0).all() else best


class _Choice:
    """A choice of sets, its count of each element, and weights that grow for missing elements."""

    def __init__(self, covers: Bools, chosen: NDArray[Any]) -> None:
        self.covers = covers
        self.sets = [int(each) for each in chosen]
        self.times = covers[self.sets].sum(axis=0)
        self.owners = (covers[self.sets] * np.array(self.sets)[:, None]).sum(axis=0)
        self.weights = np.ones(covers.shape[1])
        self.moved = np.zeros(len(covers), dtype=np.int64)
        self.count = 1

    def drop_least(self) -> None:
        """Leave out the set that alone holds the least weight; of equals the one moved earliest."""
        alone = np.flatnonzero(self.times == 1)  # in one set: the sum is its number
        losses = np.bincount(self.owners[alone], self.weights[alone], len(self.covers))[self.sets]
        losses[np.flatnonzero(self.moved[self.sets] == self.count)] = np.inf
        out = self.sets.pop(int(np.lexsort((self.moved[self.sets], losses))[0]))
        self._change(out, -1)

    def add_for_longest_missing(self) -> None:
        """Add the set that gains most of those with the heaviest missing element, not the last."""
        missing = np.flatnonzero(self.times == 0)
        wanted = missing[self.weights[missing].argmax()]
        able = np.flatnonzero(self.covers[:, wanted] & (self.moved < self.count))
        if not len(able):
            able = np.flatnonzero(self.covers[:, wanted])
        able = able[:: 1 + len(able) // max(1, min(MOST_TRIED, MOST_GAINS // len(missing)))]
        gains = self.covers[able[:, None], missing] @ self.weights[missing]
        best = int(able[np.lexsort((self.moved[able], -gains))[0]])
        self.sets.append(best)
        self._change(best, 1)

    def _change(self, number: int, sense: int) -> None:
        self.times += sense * self.covers[number]
        self.owners += sense * number * self.covers[number]
        self.count += 1
        self.moved[number] = self.count
