"""Simplices (segments, triangles, ...) as arrays of corners, and their halves."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats


def edges(cells: Floats) -> Floats:
    """Return the edges of simplices (N, k, n) as vectors, one a pair i < j of corners."""
    i, j = np.triu_indices(cells.shape[1], 1)
    return np.asarray(cells[:, i] - cells[:, j])


def halved(cells: Floats, chosen: NDArray[Any]) -> Floats:
    """Cut each simplex at the middle of one edge (i, j): the half with corner i, then that with j.

    Parameters
    ----------
    cells : ndarray, shape (N, k, n)
    chosen : ndarray of int, shape (N,)
        Numbers of edges, in the order of `edges`.
    """
    i, j = (ends[chosen] for ends in np.triu_indices(cells.shape[1], 1))
    rows = np.arange(len(cells))
    middle = (cells[rows, i] + cells[rows, j]) / 2
    halves = np.repeat(cells, 2, axis=0)
    halves[2 * rows, j] = middle
    halves[2 * rows + 1, i] = middle
    return halves
