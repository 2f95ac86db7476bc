"""Marching cubes: the surface on which values of a grid change their sign, as triangles.

A cube of the grid has eight corners, each positive or not: 256 cases. On a face of the cube the
surface cuts off every run of positive corners. The cuts of the six faces join to closed loops, and
fans of triangles fill the loops. The cuts on a face depend on that face alone, so the triangles of
neighbouring cubes fit together (Lorensen and Cline, 1987, whose own table left holes).
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from itertools import pairwise

import numpy as np

from cspace.arrays import Bools, Floats, Ints

Corner = tuple[int, int, int]
Edge = tuple[Corner, int]
"""An edge of the cube: its lower corner, and the axis along which it goes."""

CORNERS: tuple[Corner, ...] = tuple((i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1))
EDGES: tuple[Edge, ...] = tuple((c, axis) for axis in range(3) for c in CORNERS if not c[axis])


def marching_cubes(values: Floats) -> tuple[Floats, Ints]:
    """Return the surface between positive and other values of a grid.

    Parameters
    ----------
    values : ndarray, shape (l, m, n)

    Returns
    -------
    places : ndarray, shape (v, 3)
        In steps of the grid. Each place is on an edge of the grid, where linear interpolation
        between both ends gives zero.
    triangles : ndarray of int, shape (t, 3)
        Counter-clockwise seen from the side where values are not positive; each has an area.

    Examples
    --------
    >>> x, y, z = np.meshgrid(*[np.arange(9.0)] * 3, indexing="ij")
    >>> places, triangles = marching_cubes(10.5 - (x - 4) ** 2 - (y - 4) ** 2 - (z - 4) ** 2)
    >>> len(places) - 3 * len(triangles) // 2 + len(triangles)  # Euler's number of a sphere
    2
    """
    positive = np.asarray(values > 0)
    low, axis, numbers = _crossings(positive)
    high = low + np.eye(3, dtype=np.intp)[axis]
    start, end = values[tuple(low.T)], values[tuple(high.T)]
    places = low + np.eye(3)[axis] * (start / (start - end))[:, None]
    triangles = _triangles(positive, numbers)
    a, b, c = (places[column] for column in triangles.T)
    flat = (a == b).all(axis=1) | (b == c).all(axis=1) | (c == a).all(axis=1)
    return places, triangles[~flat]


def _crossings(positive: Bools) -> tuple[Ints, Ints, list[Ints]]:
    """Return lower corner and axis of each crossed edge of the grid, and the numbers of the edges.

    The numbers come as one array for each axis, flat, with a place for each corner of the grid.
    """
    low, axes, numbers, count = [], [], [], 0
    for axis in range(3):
        ahead = np.moveaxis(positive, axis, 0)
        found = np.argwhere(np.moveaxis(ahead[1:] != ahead[:-1], 0, axis))
        number = np.empty(positive.size, dtype=np.intp)  # only entries of crossed edges are read
        number[np.ravel_multi_index(tuple(found.T), positive.shape)] = count + np.arange(len(found))
        count += len(found)
        low.append(found)
        axes.append(np.full(len(found), axis))
        numbers.append(number)
    return np.concatenate(low), np.concatenate(axes), numbers


def _triangles(positive: Bools, numbers: list[Ints]) -> Ints:
    """Return the triangles of all cubes, as numbers of crossed edges."""
    shape = positive.shape
    case = np.zeros([size - 1 for size in shape], dtype=np.uint8)
    for bit, corner in enumerate(CORNERS):
        part = tuple(slice(c, c + size - 1) for c, size in zip(corner, shape, strict=True))
        case |= positive[part].astype(np.uint8) << bit
    cubes = np.nonzero((case > 0) & (case < 255))
    rows = table()[case[cubes]]
    cube, place = np.nonzero(rows[:, :, 0] >= 0)
    edge = rows[cube, place]
    steps = np.array([np.ravel_multi_index(corner, shape) for corner, _ in EDGES])
    at = np.ravel_multi_index(cubes, shape)[cube][:, None] + steps[edge]
    axis = np.array([axis for _, axis in EDGES])[edge]
    found = np.empty_like(edge)
    for k, number in enumerate(numbers):
        found[axis == k] = number[at[axis == k]]
    return found


@cache
def table() -> Ints:
    """Return the triangles of each case, shape (256, most, 3): numbers of `EDGES`; -1: none."""
    cases = [list(_filled(case)) for case in range(256)]
    made = np.full((256, max(map(len, cases)), 3), -1, dtype=np.intp)
    for case, triangles in enumerate(cases):
        made[case, : len(triangles)] = np.array(triangles, dtype=np.intp).reshape(-1, 3)
    return made


def _filled(case: int) -> Iterator[tuple[int, int, int]]:
    """Yield the triangles of a case: fans in the loops of its cuts."""
    positive = {corner for bit, corner in enumerate(CORNERS) if case >> bit & 1}
    following = dict(cut for face in _faces() for cut in _cuts(face, positive))
    while following:
        loop = [next(iter(following))]
        while (after := following.pop(loop[-1])) != loop[0]:
            loop.append(after)
        turns = [loop[k:] + loop[:k] for k in range(len(loop))]
        apex, *others = min(turns, key=_diagonals_on_faces)
        yield from ((apex, one, other) for one, other in pairwise(others))


def _faces() -> Iterator[list[Corner]]:
    """Yield the corners of each face, counter-clockwise seen from outside."""
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for axis in range(3):
        for side in (0, 1):
            face: list[Corner] = []
            for one, other in square if side else square[::-1]:
                corner = [side] * 3
                corner[(axis + 1) % 3], corner[(axis + 2) % 3] = one, other
                face.append((corner[0], corner[1], corner[2]))
            yield face


def _cuts(face: list[Corner], positive: set[Corner]) -> Iterator[tuple[int, int]]:
    """Yield the cuts on a face: from the edge where a run of positive corners starts to its end."""
    around = list(zip(face, face[1:] + face[:1], strict=True))
    for start, (one, other) in enumerate(around):
        if one in positive or other not in positive:
            continue
        run = (around[(start + step) % 4] for step in range(1, 4))
        last = next(each for each in run if each[1] not in positive)
        yield _edge(*around[start]), _edge(*last)


def _edge(one: Corner, other: Corner) -> int:
    low, high = sorted((one, other))
    return EDGES.index((low, next(axis for axis in range(3) if low[axis] != high[axis])))


def _diagonals_on_faces(loop: list[int]) -> int:
    """Count the diagonals of a fan that lie on a face: a neighbour may have the same."""
    return sum(_share_a_face(loop[0], other) for other in loop[2:-1])


@cache
def _share_a_face(one: int, other: int) -> bool:
    """Tell whether two edges lie on one face of the cube."""
    ends = [
        {corner, tuple(c + (k == axis) for k, c in enumerate(corner))}
        for corner, axis in (EDGES[one], EDGES[other])
    ]
    return any(ends[0] | ends[1] <= set(face) for face in _faces())
