"""The solid that a mesh encloses: whether it is convex or a box, and which places are inside.

A mesh that is nearly convex, or nearly a box, is treated as such. The distance by which it differs
is subtracted from every depth, so bounds of depths hold for the mesh itself.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.geometry.covering import AT_ONCE, IN_CACHE
from qbound.tolerances import OUTWARD

MOST_TERMS = 250_000_000
"""Corners times planes of a hull at most; a mesh with more is treated as if it had no hull."""


class Convex(NamedTuple):
    """A convex solid of half-spaces.

    Attributes
    ----------
    planes : ndarray, shape (n, 4)
        Outward unit normals, then offsets: inside where normal . x + offset <= 0.
    error : float
        The mesh is nowhere deeper in it; length.
    """

    planes: Floats
    error: float

    def depths(self, places: Floats) -> Floats:
        """Return how deep places are in the mesh's solid at least; of no meaning if below 0."""
        least = np.full(len(places), np.inf)
        step = max(1, 4 * IN_CACHE // max(1, len(places)))
        for k in range(0, len(self.planes), step):
            least = np.minimum(least, -heights(places, self.planes[k : k + step]).max(axis=1))
        return least - self.error


class OrientedBox(NamedTuple):
    """A box: its middle, its axes as columns of a rotation, and its size along each.

    The mesh lies in it, and no place of it is farther than `error` from the mesh's hull.
    """

    middle: Floats
    axes: Floats
    size: Floats
    error: float


def heights(places: Floats, planes: Floats) -> Floats:
    """Return how far places lie before planes, shape (places, planes).

    Products of so few columns are no faster as one of matrices, whose threads cost twice the time.
    """
    found = np.broadcast_to(planes[:, 3], (len(places), len(planes))).copy()
    for i in range(3):
        found += places[:, i, None] * planes[:, i]
    return found


def hull_of(corners: Floats) -> Convex | None:
    """Return the convex hull of places, or None if they lie in a plane or it has many faces."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(corners)
    except QhullError:  # a flat one has no inside
        return None
    size = float(np.abs(corners).max())
    planes = _distinct(hull.equations, size)
    if len(planes) * len(corners) > MOST_TERMS:
        return None
    outside = -float(Convex(planes, 0.0).depths(corners).min())
    return Convex(planes, max(outside, 0.0) + 16 * OUTWARD * size)


def _distinct(planes: Floats, size: float) -> Floats:
    """Leave one of each group of planes that agree but for rounding."""
    rounded = np.round(planes / [1, 1, 1, size], 9)
    _, first = np.unique(rounded, axis=0, return_index=True)
    return np.asarray(planes[np.sort(first)])


def convex_solid(triangles: Floats, error: float) -> Convex | None:
    """Return the hull of a closed mesh if the mesh is its surface, up to an error; else None.

    If all triangles lie within the error of the hull's surface, no surface parts the places that
    are deeper; if it goes round one of these it goes round all.
    """
    hull = hull_of(np.unique(triangles.reshape(-1, 3), axis=0))
    if hull is None:
        return None
    far = _below_a_face(triangles, hull.planes, error)
    if far > error:
        return None
    within = Convex(hull.planes, hull.error + max(far, 0.0))
    middle = triangles.reshape(-1, 3).mean(axis=0)[None]
    if within.depths(middle)[0] <= 0 or not winding_numbers(triangles, middle)[0]:
        return None
    return within


def _below_a_face(triangles: Floats, planes: Floats, error: float) -> float:
    """Return how deep below one plane a whole triangle lies, at the worst of them; inf if too deep.

    The plane is first sought among those that face as the triangle does.
    """
    from scipy.spatial import cKDTree

    normals, _ = unit_normals(triangles)
    size = float(np.abs(triangles).max()) or 1.0
    offsets = -np.einsum("ni,ni->n", normals, triangles[:, 0])
    own = np.column_stack([normals, offsets]) / [1, 1, 1, size]
    tree = cKDTree(planes / [1, 1, 1, size])
    depth = np.full(len(triangles), np.inf)
    for sense in (own, -own):
        plane = planes[tree.query(sense)[1]]
        places = np.einsum("nki,ni->nk", triangles, plane[:, :3]) + plane[:, 3:]
        depth = np.minimum(depth, -places.min(axis=1))
    doubtful = np.flatnonzero(depth > error)  # as slivers are, whose normals are rounding
    if len(doubtful) * len(planes) > MOST_TERMS:
        return math.inf
    step = max(1, AT_ONCE // (3 * len(planes)))
    for k in range(0, len(doubtful), step):
        some = doubtful[k : k + step]
        below = -heights(triangles[some].reshape(-1, 3), planes).reshape(len(some), 3, -1)
        depth[some] = below.max(axis=1).min(axis=1)
        if depth[some].max() > error:
            return math.inf
    return float(depth.max())


def as_box(solid: Convex, corners: Floats, error: float) -> OrientedBox | None:
    """Return the box that a convex solid is, up to an error, or None.

    Parameters
    ----------
    corners : ndarray, shape (n, 3)
        Of the mesh. The box holds them all, and each corner of it has one of them within the error.
    """
    normals = solid.planes[:, :3]
    first = normals[0]
    second = normals[np.abs(normals @ first).argmin()]
    second = second - (second @ first) * first
    if not (length := float(np.linalg.norm(second))):
        return None
    second = second / length
    axes = np.column_stack([first, second, np.cross(first, second)])
    seen = corners @ axes
    low, high = seen.min(axis=0), seen.max(axis=0)
    ends = np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1)
    far = max(float(np.linalg.norm(seen - end, axis=1).min()) for end in ends.reshape(-1, 3))
    if far > error:
        return None
    slack = 16 * OUTWARD * float(np.abs(corners).max())
    # A line from the middle to a place of the hull meets the mesh where it is no deeper than that.
    depth = solid.depths(corners.mean(axis=0)[None])[0]
    away = solid.error * float(np.linalg.norm(high - low))
    if away > error * depth:
        return None
    middle = axes @ ((low + high) / 2)
    return OrientedBox(middle, axes, high - low + slack, far + slack + away / depth)


def winding_numbers(triangles: Floats, places: Floats) -> NDArray[np.int64]:
    r"""Return how often a closed surface goes round each place: 0 outside of the solid.

    The sum of the solid angles of its triangles over :math:`4\pi` (van Oosterom and Strackee).

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> tetrahedron = corners[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    >>> winding_numbers(tetrahedron, np.array([[0.1, 0.1, 0.1], [1.0, 1.0, 1.0]])).tolist()
    [1, 0]
    """
    total = np.zeros(len(places))
    step = max(1, IN_CACHE // max(1, len(places)))
    for k in range(0, len(triangles), step):
        a, b, c = (
            corner - places[:, None] for corner in np.swapaxes(triangles[k : k + step], 0, 1)
        )
        x, y, z = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
        volume = np.einsum("...i,...i", a, np.cross(b, c))
        dots = [np.einsum("...i,...i", one, other) for one, other in ((a, b), (b, c), (c, a))]
        below = x * y * z + dots[0] * z + dots[1] * x + dots[2] * y
        total += np.arctan2(volume, below).sum(axis=1)
    return np.asarray(np.rint(total / (2 * math.pi)), dtype=np.int64)


def unit_normals(triangles: Floats) -> tuple[Floats, Floats]:
    """Return the normals of triangles, of length 1 or 0 for one of no area, and the areas."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    twice = np.linalg.norm(normals, axis=1)
    return normals / np.where(twice > 0, twice, 1.0)[:, None], twice / 2
