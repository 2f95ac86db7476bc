"""Subdivision of boxes and simplices of joint values, and the trees that say how they were cut.

One driver serves all searches for a proof: cells are judged level by level; cells that are not
closed are halved. Cells have joint values in rad or length. All numbers are doubles; the checker
decides.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Bools, Floats, Ints
from cspace.geometry import simplices

Progress = Callable[[float], None]
"""Is told how far work is, from 0 to 1."""

DEEPEST = 100
"""Cuts on top of each other before a search gives up; the checker follows 120."""


def silent(part: float) -> None:
    """Do nothing; the default for `progress`."""
    del part


class Rows:
    """Base of dataclasses of arrays that have one row for each of some things."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    def __len__(self) -> int:
        """Return the number of rows."""
        return next(len(x) for x in vars(self).values() if isinstance(x, np.ndarray))

    def __getitem__(self, chosen: Any) -> Self:
        """Take some of the rows; attributes that are not arrays belong to all rows."""
        fields = (getattr(self, name) for name in self.__dataclass_fields__)
        return type(self)(*(x[chosen] if isinstance(x, np.ndarray) else x for x in fields))

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Put the rows of several tables one after the other."""
        columns = ([getattr(part, name) for part in parts] for name in cls.__dataclass_fields__)
        return cls(*map(np.concatenate, columns))


@dataclass(frozen=True, eq=False)
class Boxes(Rows):
    """Boxes by their centres and half widths, shape (N, n); joint j is cut by number j."""

    centres: Floats
    halfwidths: Floats

    @classmethod
    def between(cls, low: Floats, high: Floats) -> Boxes:
        """Return the boxes with these corners, shape (N, n)."""
        return cls((low + high) / 2, (high - low) / 2)

    @property
    def reach(self) -> Floats:
        """Largest distance of each joint from the middle, shape (N, n)."""
        return self.halfwidths

    @property
    def cuts(self) -> int:
        """Number of ways to halve a box."""
        return int(self.centres.shape[1])

    @property
    def edges(self) -> Floats:
        """What each cut halves, as steps of the joints, shape (N, cuts, n)."""
        return np.asarray(2 * self.halfwidths[:, :, None] * np.eye(self.cuts))

    @property
    def low(self) -> Floats:
        """Lower corners."""
        return self.centres - self.halfwidths

    @property
    def high(self) -> Floats:
        """Upper corners."""
        return self.centres + self.halfwidths

    def least(self, slopes: Floats) -> Floats:
        """Return the least of slope . step over the steps to all corners.

        Parameters
        ----------
        slopes : ndarray, shape (N, n, ...)
        """
        return np.asarray(-np.einsum("nj...,nj->n...", np.abs(slopes), self.halfwidths))

    def lowest(self, slopes: Floats) -> Floats:
        """Return the step to a corner where slope . step is least; shape (N, n), as the slopes."""
        return np.asarray(-np.sign(slopes) * self.halfwidths)

    @property
    def steps(self) -> Floats:
        """Steps from the centres to the corners, along joints in which the boxes have a width."""
        wide: Bools = np.asarray((self.halfwidths > 0).any(axis=0))
        signs = np.array([*product(*((-1.0, 1.0) if x else (0.0,) for x in wide.tolist()))])
        return np.asarray(self.halfwidths[:, None] * signs)

    def halves(self, cuts: NDArray[Any]) -> Boxes:
        """Cut each at the middle of one joint: the lower half, then the upper one."""
        rows = np.arange(len(self))
        centres = np.repeat(self.centres, 2, axis=0)
        halfwidths = self.halfwidths.copy()
        halfwidths[rows, cuts] /= 2
        step = halfwidths[rows, cuts]
        centres[2 * rows, cuts] -= step
        centres[2 * rows + 1, cuts] += step
        return Boxes(centres, np.repeat(halfwidths, 2, axis=0))


@dataclass(frozen=True, eq=False)
class Simplices(Rows):
    """Simplices by their corners, shape (N, k, n); cuts number the edges as the page does."""

    corners: Floats

    @cached_property
    def centres(self) -> Floats:
        """Means of the corners, shape (N, n)."""
        return np.asarray(self.corners.mean(axis=1))

    @cached_property
    def steps(self) -> Floats:
        """Steps from the centres to the corners."""
        return np.asarray(self.corners - self.centres[:, None])

    @cached_property
    def reach(self) -> Floats:
        """Largest distance of each joint from the middle, shape (N, n)."""
        return np.asarray(np.abs(self.steps).max(axis=1))

    @property
    def cuts(self) -> int:
        """Number of edges."""
        k = int(self.corners.shape[1])
        return k * (k - 1) // 2

    @property
    def edges(self) -> Floats:
        """What each cut halves, as steps of the joints, shape (N, cuts, n)."""
        return simplices.edges(self.corners)

    def least(self, slopes: Floats) -> Floats:
        """Return the least of slope . step over the steps to all corners, as `Boxes.least`."""
        return np.asarray(np.einsum("nkj,nj...->nk...", self.steps, slopes).min(axis=1))

    def lowest(self, slopes: Floats) -> Floats:
        """Return the step to a corner where slope . step is least, as `Boxes.lowest`."""
        corner = np.einsum("nkj,nj->nk", self.steps, slopes).argmin(axis=1)
        return np.asarray(self.steps[np.arange(len(self)), corner])

    def halves(self, cuts: NDArray[Any]) -> Simplices:
        """Cut each at the middle of one edge."""
        return Simplices(simplices.halved(self.corners, cuts))


Cells = Boxes | Simplices


class Forest:
    """The cuts of all cells, made level by level and written in preorder."""

    def __init__(self, size: int) -> None:
        self.size, self.letters = size, ["?"] * size
        self.children: dict[int, int] = {}

    def close(self, numbers: Sequence[int] | NDArray[Any], leaves: Sequence[str]) -> None:
        """Note that cells are leaves, and how each is written."""
        for number, leaf in zip(numbers, leaves, strict=True):
            self.letters[number] = leaf

    def cut(self, numbers: Sequence[int] | NDArray[Any], cuts: NDArray[Any]) -> NDArray[Any]:
        """Note the cuts and return the numbers of the halves."""
        first = len(self.letters)
        for k, (number, cut) in enumerate(zip(numbers, cuts, strict=True)):
            self.letters[number] = chr(ord("a") + int(cut))
            self.children[int(number)] = first + 2 * k
        self.letters += ["?"] * (2 * len(numbers))
        return np.arange(first, len(self.letters))

    def trees(self) -> list[str]:
        """Write the cuts of each cell in preorder."""
        return [self._tree(root) for root in range(self.size)]

    def _tree(self, root: int) -> str:
        written, todo = [], [root]
        while todo:
            number = todo.pop()
            written.append(self.letters[number])
            if number in self.children:
                todo += [self.children[number] + 1, self.children[number]]
        return "".join(written)


# --- the driver -----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Judged:
    """The verdict on some cells: leaf, cut, or given up.

    Attributes
    ----------
    leaves : sequence of str
        How each cell is written as a leaf; empty for one that is cut.
    cuts : ndarray of int, shape (N,)
        The cut of each other cell; -1 if the cell is given up.
    margins : ndarray, shape (N,)
        Below 0 if a configuration of the cell shows that no proof exists.
    places : ndarray, shape (N, n)
        These configurations.
    """

    leaves: Sequence[str]
    cuts: NDArray[Any]
    margins: Floats
    places: Floats


Judge = Callable[[Cells, NDArray[Any]], Judged]
"""Judges cells; the second argument is the number of the thing that each is about."""


@dataclass(frozen=True, eq=False)
class Search:
    """The result of a search for a proof about one thing.

    Attributes
    ----------
    trees : tuple of str
        For each cell its cuts in preorder, see the page "The certificate".
    leaves : int
        Cells that are closed.
    left : int
        Cells that are undecided.
    part_left : float
        Fraction of the whole set that they fill.
    violation : (int, ndarray) or None
        A cell, and a configuration in it that shows that no proof exists; rad or length.
    left_at : ndarray or None
        The middle of a largest cell that is undecided.
    """

    trees: tuple[str, ...]
    leaves: int
    left: int
    part_left: float
    violation: tuple[int, Floats] | None = None
    left_at: Floats | None = None


def best_cuts(
    cells: Cells,
    tried: Bools,
    worth: Callable[[Ints, Cells], Floats],
    enough: float,
    size: float,
) -> Ints:
    """Choose the cut of each cell that closes most halves, then the one that leaves least lacking.

    Parameters
    ----------
    tried : ndarray of bool, shape (N, cuts)
    worth : callable
        Function from numbers of cells and their halves to a value for each half; a half with more
        than `enough` is closed.
    size : float
        A value that is large.

    Returns
    -------
    ndarray of int, shape (N,)
        Index of the cut; -1 if none is tried.
    """
    scores = np.full(tried.shape, -np.inf)
    for cut in np.flatnonzero(tried.any(axis=0)).tolist():
        rows = np.flatnonzero(tried[:, cut])
        values = worth(rows, cells[rows].halves(np.full(len(rows), cut))).reshape(-1, 2)
        lacks = np.minimum(values, 0).sum(axis=1) / size
        scores[rows, cut] = 1e6 * (values > enough).sum(axis=1) + lacks
    return np.where(tried.any(axis=1), scores.argmax(axis=1), -1)


def subdivide(
    roots: Cells,
    things: Sequence[int],
    judge: Judge,
    most: int,
    first_look: int | None = None,
    progress: Progress = silent,
) -> dict[int, Search]:
    """Halve cells until all are closed, for several things at once.

    Parameters
    ----------
    things : sequence of int
        Things; a proof of each is searched for on all roots.
    most : int
        Cells that are opened for one thing before it is left undecided.
    first_look : int, optional
        The same limit after one thing was found to have no proof; enough to find other such things.

    Returns
    -------
    dict of int to Search
        The search of each thing.
    """
    count, about = len(roots), np.asarray(things, dtype=np.int64)
    rows = np.tile(np.arange(count), len(about))
    cells, forest = roots[rows], Forest(len(rows))
    root, numbers = np.arange(len(rows)), np.arange(len(rows))
    parts = np.ones(len(rows))
    leaves, left, undecided = (np.zeros(len(rows)) for _ in range(3))
    opened = np.zeros(len(about), dtype=np.int64)
    violations: dict[int, tuple[float, int, Floats]] = {}
    left_at: dict[int, Floats] = {}
    for depth in range(DEEPEST + 1):
        if not len(cells):
            break
        own = root // max(count, 1)
        found = judge(cells, about[own])
        for row in np.flatnonzero(found.margins < 0).tolist():
            thing, margin = int(own[row]), float(found.margins[row])
            if thing not in violations or margin < violations[thing][0]:
                violations[thing] = margin, int(root[row] % count), found.places[row]
        closed = np.array([leaf != "" for leaf in found.leaves], dtype=bool)
        forest.close(numbers[closed], [leaf for leaf in found.leaves if leaf])
        np.add.at(leaves, root[closed], 1)
        opened += np.bincount(own, minlength=len(about))
        limit = most if first_look is None or not violations else min(most, first_look)
        over = (opened > limit) | np.isin(np.arange(len(about)), [*violations])
        stopped = ~closed & (over[own] | (found.cuts < 0) | (depth == DEEPEST))
        for row in np.flatnonzero(stopped).tolist():  # the largest come first
            left_at.setdefault(int(own[row]), cells.centres[row])
        np.add.at(left, root[stopped], 1)
        np.add.at(undecided, root[stopped], parts[stopped])
        cut = ~closed & ~stopped
        numbers = forest.cut(numbers[cut], found.cuts[cut])
        cells = cells[cut].halves(found.cuts[cut])
        root, parts = np.repeat(root[cut], 2), np.repeat(parts[cut] / 2, 2)
        progress(1 - float(parts.sum()) / forest.size)
    trees = forest.trees()
    result = {}
    for k, thing in enumerate(about.tolist()):
        mine = slice(k * count, (k + 1) * count)
        result[thing] = Search(
            tuple(trees[mine]),
            int(leaves[mine].sum()),
            int(left[mine].sum()),
            float(undecided[mine].sum() / max(count, 1)),
            violations[k][1:] if k in violations else None,
            left_at.get(k),
        )
    return result
