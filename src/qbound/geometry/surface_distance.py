"""Lower bounds of the distance to a surface, from samples of it, with a bounded amount of work.

Samples are put into groups. One sample and the radius of a group bound the distance of the whole
group from a place. So the number of samples that a search has to look at is known in advance. That
matters near the middle of a sphere, where a search has to look at all of them: a tree takes a
hundred times as long there as elsewhere. Where the number is too large, the bound from the groups
is the answer.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Bools, Floats, Indices
from qbound.tolerances import OUTWARD

MOST_GROUPS = 1_000
"""Groups of samples, about."""

MOST_ENTRIES = 4_000_000
"""Entries of a table."""

MOST_VISITS = 200_000_000
"""Distances from samples in all searches together, some 4 ns each."""

MOST_ROUGH = 30_000
"""Samples, about, that are enough to find where balls lie: the surface bends little between."""

SHARE = 0.25
"""Part of those left that one search may take which is not the last."""


def one_a_cell(places: Floats, most: int, size: float) -> tuple[Indices, Indices]:
    """Put places into the cells of a grid, of size or, where that makes too many, coarser.

    Parameters
    ----------
    places : ndarray, shape (n, 3)
    most : int
        Cells at most.
    size : float
        Above 0; length.

    Returns
    -------
    ndarray of int, shape (cells,)
        A place of each cell.
    ndarray of int, shape (n,)
        The cell of each place.

    Examples
    --------
    >>> import numpy as np
    >>> places = np.array([[0.0, 0, 0], [0.1, 0, 0], [1.0, 0, 0], [9.0, 0, 0]])
    >>> [found.tolist() for found in one_a_cell(places, 10, 0.5)]
    [[0, 2, 3], [0, 0, 1, 2]]
    >>> one_a_cell(places, 2, 0.5)[0].tolist()
    [0, 3]
    """
    chosen, cell = np.arange(len(places)), np.arange(len(places))
    if not len(places):
        return chosen, cell
    low, high = places.min(axis=0), places.max(axis=0)
    size = max(size, float((high - low).max()) / 2**20)  # numbers of 63 bits
    while True:
        cells = np.floor((places[chosen] - low) / size).astype(np.int64)
        first, rank = _first_of_each(cells)
        chosen, cell = chosen[first], rank[cell]
        if len(chosen) <= most:
            return chosen, cell
        size *= max(1.05, (len(chosen) / most) ** 0.5)


def _first_of_each(cells: NDArray[np.int64]) -> tuple[Indices, Indices]:
    """Return the first row of each kind of rows of small whole numbers, and the kind of each."""
    shape = cells.max(axis=0) + 1
    number = (cells[:, 0] * shape[1] + cells[:, 1]) * shape[2] + cells[:, 2]
    if shape.prod() > MOST_ENTRIES:
        number = np.unique(number, return_inverse=True)[1].ravel()
    rows = np.arange(len(cells))
    first = np.full(int(number.max()) + 1, -1)
    first[number[::-1]] = rows[::-1]  # of several the last that is written stays
    first = np.sort(first[first >= 0])
    rank = np.empty(int(number.max()) + 1, dtype=np.intp)
    rank[number[first]] = np.arange(len(first))
    return first, rank[number]


class SurfaceDistance:
    """Distances from a surface that is known from samples of it.

    Parameters
    ----------
    samples : ndarray, shape (n, 3)
        Places of the surface, n > 0.
    spread : float
        Every place of the surface is within it of a sample.
    """

    def __init__(self, samples: Floats, spread: float) -> None:
        self.spread = spread
        self.visits_left = MOST_VISITS
        first, group = one_a_cell(samples, MOST_GROUPS, spread)
        order = np.argsort(group, kind="stable")  # the samples of a group one after the other
        self.samples = samples[order]
        self._ends = np.append(0, np.cumsum(np.bincount(group)))
        self._heads = self._ends[:-1]
        away = np.linalg.norm(samples - samples[first][group], axis=1)
        self._radii = np.zeros(len(first))
        np.maximum.at(self._radii, group, away)
        self._radii *= 1 + OUTWARD

    def rough(self) -> SurfaceDistance:
        """Return the same of fewer samples, by which to search: its depths would be too large."""
        few, _ = one_a_cell(self.samples, MOST_ROUGH, self.spread)
        return SurfaceDistance(self.samples[few], self.spread)

    def within(self, places: Floats, radii: Floats) -> Indices:
        """Find a sample that lies in each ball by more than the spread.

        Parameters
        ----------
        places : ndarray, shape (m, 3)
        radii : ndarray, shape (m,)

        Returns
        -------
        ndarray of int, shape (m,)
            Rows of `samples`; -1 where none was found.
        """
        apart = self._from_groups(places)
        limits = radii - self.spread
        best = apart.argmin(axis=0)
        found = np.where(apart[best, np.arange(len(places))] < limits, self._heads[best], -1)
        rest = np.flatnonzero(found < 0)
        _, found[rest], _ = self._searched(places[rest], apart[:, rest], limits[rest], SHARE)
        return found

    def depths(self, places: Floats) -> Floats:
        """Return lengths that the surface is no nearer than, shape (m,); of no meaning below 0."""
        apart = self._from_groups(places)
        near, _, least = self._searched(places, apart, np.full(len(places), np.inf), 1.0)
        return np.asarray(np.minimum(near, least) * (1 - OUTWARD) - self.spread)

    def _from_groups(self, places: Floats) -> Floats:
        """Return the distances of places from one sample of each group, shape (groups, m)."""
        from scipy.spatial.distance import cdist

        return np.asarray(cdist(self.samples[self._heads], places))

    def _searched(
        self, places: Floats, apart: Floats, limits: Floats, share: float
    ) -> tuple[Floats, Indices, Floats]:
        """Look for the nearest sample, in those groups alone that may have one within a limit.

        Returns the least distance found, or the limit; the sample that has it, or -1; and what the
        samples are no nearer than that were not looked at.
        """
        near, index = limits.copy(), np.full(len(places), -1)
        low = apart - self._radii[:, None]
        open_ones = np.zeros(apart.shape, dtype=bool)
        open_ones[apart.argmin(axis=0), np.arange(len(places))] = True
        self._look(places, open_ones, near, index)
        low[open_ones] = np.inf
        open_ones = low < near
        counts = np.diff(self._ends) @ open_ones
        order = np.argsort(counts, kind="stable")
        total = np.cumsum(counts[order])
        most = np.searchsorted(total, share * self.visits_left, side="right")
        open_ones[:, order[most:]] = False
        if most:
            self.visits_left -= int(total[most - 1])
            self._look(places, open_ones, near, index)
        low[open_ones] = np.inf
        return near, index, low.min(axis=0, initial=np.inf)

    def _look(self, places: Floats, open_ones: Bools, near: Floats, index: Indices) -> None:
        """Compare places with all samples of the groups that are open to them."""
        from scipy.spatial.distance import cdist

        for group in np.flatnonzero(open_ones.any(axis=1)):
            rows = np.flatnonzero(open_ones[group])
            start, end = self._ends[group : group + 2]
            apart = cdist(places[rows], self.samples[start:end])
            best = apart.argmin(axis=1)
            least = apart[np.arange(len(rows)), best]
            better = least < near[rows]
            near[rows[better]] = least[better]
            index[rows[better]] = start + best[better]
