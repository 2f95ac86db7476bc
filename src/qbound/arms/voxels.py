"""Voxels that a path goes through: all of them, exactly, by its crossings with their faces."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from math import tau
from typing import NamedTuple

import numpy as np

from qbound.arms.paths import Paths
from qbound.arrays import Bools, Floats, Indices


@dataclass(frozen=True, eq=False)
class Grid:
    """Cubes of one edge.

    Attributes
    ----------
    origin : ndarray, shape (3,)
        The lowest corner; length.
    edge : float
        Length.
    shape : tuple of int
        How many along x, y, z.
    """

    origin: Floats
    edge: float
    shape: tuple[int, int, int]

    def flat_index(self, places: Floats) -> Indices:
        """Return the number of the voxel of each place, shape (3, m) to (m,)."""
        index = np.floor((places - self.origin[:, None]) / self.edge).astype(np.intp)
        index = np.clip(index, 0, np.array(self.shape)[:, None] - 1)  # rounding at the last face
        return np.asarray(np.ravel_multi_index(tuple(index), self.shape))

    def at_edge(self, touched: Bools) -> Indices:
        """Return the numbers of voxels, of those touched, that have a face to one that is not."""
        padded = np.pad(touched.reshape(self.shape), 1)
        inner = padded.copy()
        for axis in range(3):
            inner &= np.roll(padded, 1, axis) & np.roll(padded, -1, axis)
        return np.flatnonzero((padded & ~inner)[1:-1, 1:-1, 1:-1])


def enclosed_volume(touched: Bools, edge: float) -> float:
    r"""Return the volume of a body that touches these voxels and no others, shape (n, n, n).

    It is that of the voxels less their surplus, which is in proportion to the edge but for terms of
    second order: :math:`2 V_h - V_{2h}`, where the coarse voxels lie in each of eight ways.
    """
    coarse = np.mean([each.sum() for each in coarsened(touched)])
    return float((2 * touched.sum() - 8 * coarse) * edge**3)


def coarsened(touched: Bools) -> Iterator[Bools]:
    """Yield which voxels of twice the edge are touched, as they lie in each of eight ways."""
    for shift in product((0, 1), repeat=3):
        ends = [(s, (n + s) % 2) for n, s in zip(touched.shape, shift, strict=True)]
        padded = np.pad(touched, ends)
        pairs = padded.reshape([part for size in padded.shape for part in (size // 2, 2)])
        yield np.asarray(pairs.any(axis=(1, 3, 5)))


class Crossed(NamedTuple):
    """Voxels that paths go through, one after the other; one may come several times.

    Attributes
    ----------
    voxel : ndarray of int, shape (m,)
        Number of `Grid.flat_index`.
    path : ndarray of int, shape (m,)
    q : ndarray, shape (m,)
        Joint value half-way through the voxel.
    """

    voxel: Indices
    path: Indices
    q: Floats


def crossed(grid: Grid, paths: Paths, low: Floats, high: Floats) -> Crossed:
    """Return the voxels that paths go through.

    Parameters
    ----------
    paths : Paths
    low, high : ndarray, shape (n,)
        From where to where the joint moves along each.
    """
    if paths.turns:
        high = np.minimum(high, low + tau)
    number = np.arange(len(low))
    cuts = [(number, low), (number, high)]
    for coordinate in range(3):
        cuts += _at_faces(grid, coordinate, paths, low, high)
    path, q = (np.concatenate(each) for each in zip(*cuts, strict=True))
    order = np.lexsort((q, path))
    path, q = path[order], q[order]
    inside = np.flatnonzero(path[1:] == path[:-1])
    path, q = path[inside], (q[inside] + q[inside + 1]) / 2
    return Crossed(grid.flat_index(paths[path].places(q)), path, q)


def _at_faces(
    grid: Grid, coordinate: int, paths: Paths, low: Floats, high: Floats
) -> list[tuple[Indices, Floats]]:
    """Return the paths and joint values at which one coordinate is that of a face."""
    c, a, b = paths.place[:, coordinate]
    start, edge = grid.origin[coordinate], grid.edge
    size = np.hypot(a, b)
    if paths.turns:
        lowest, highest = c - size, c + size
    else:
        lowest, highest = (pick(c + a * low, c + a * high) for pick in (np.minimum, np.maximum))
    first = np.ceil((lowest - start) / edge)
    count = np.maximum(np.floor((highest - start) / edge) - first + 1, 0).astype(np.intp)
    path = np.repeat(np.arange(len(c)), count)
    face = first[path] + np.arange(len(path)) - np.repeat(np.cumsum(count) - count, count)
    rise = start + edge * face - c[path]
    moves = size[path] > 0
    path, rise = path[moves], rise[moves]
    if not paths.turns:
        return [(path, np.clip(rise / a[path], low[path], high[path]))]
    half = np.arccos(np.clip(rise / size[path], -1, 1))
    theta = np.arctan2(b, a)[path]
    return [_within(path, theta + side * half, low, high) for side in (-1, 1)]


def _within(path: Indices, q: Floats, low: Floats, high: Floats) -> tuple[Indices, Floats]:
    """Turn angles into a path's range, and leave out those that do not come to lie in it."""
    q = low[path] + np.mod(q - low[path], tau)
    kept = q < high[path]
    return path[kept], q[kept]
