"""Polygons in joint space: area, centroid, scaling about a point."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats
from qbound.geometry.polylines import cross


def area(vertices: ArrayLike) -> float:
    """Return the signed area of a polygon, positive anticlockwise; product of the joints' units.

    Parameters
    ----------
    vertices : array_like, shape (m, 2)

    Examples
    --------
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    >>> area(square), area(square[::-1])
    (1.0, -1.0)
    """
    p = np.asarray(vertices, dtype=float)
    return float(cross(p, np.roll(p, -1, axis=0)).sum() / 2)


def centroid(vertices: ArrayLike) -> Floats:
    """Return the centroid of the area, shape (2,), by Green's theorem.

    Raises
    ------
    ValueError
        If the polygon has no area.

    Examples
    --------
    >>> centroid([[0, 0], [3, 0], [0, 3]]).tolist()
    [1.0, 1.0]
    >>> centroid([[0, 0], [1, 1], [2, 2]])
    Traceback (most recent call last):
    ValueError: a polygon without area has no centroid of the area
    """
    p = np.asarray(vertices, dtype=float)
    p0 = p.mean(axis=0)  # moments about a near point: less cancellation
    start, end = p - p0, np.roll(p - p0, -1, axis=0)
    doubled = cross(start, end)
    if doubled.sum() == 0:
        raise ValueError("a polygon without area has no centroid of the area")
    return np.asarray(p0 + doubled @ (start + end) / (3 * doubled.sum()))


def scaled(vertices: ArrayLike, factor: float, centre: ArrayLike) -> Floats:
    """Return ``centre + factor (p - centre)`` of each vertex: the second remedy.

    Examples
    --------
    >>> scaled([[0, 0], [4, 0], [0, 4]], 0.5, [0, 0]).tolist()
    [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]
    """
    p, g = np.asarray(vertices, dtype=float), np.asarray(centre, dtype=float)
    return np.asarray(g + factor * (p - g))


def along_edges(vertices: ArrayLike, t: ArrayLike) -> Floats:
    """Return points at fractions `t` of every edge of the closed polygon, shape (m, len(t), 2)."""
    p = np.asarray(vertices, dtype=float)
    step = np.roll(p, -1, axis=0) - p
    return np.asarray(p[:, None] + np.asarray(t)[None, :, None] * step[:, None])


def contains(vertices: ArrayLike, point: ArrayLike) -> bool:
    """Tell whether a point lies inside a polygon: a ray from it crosses the edges an odd number.

    Parameters
    ----------
    vertices : array_like, shape (m, 2)
    point : array_like, shape (2,)

    Examples
    --------
    >>> bowl = [[0, 0], [4, 0], [4, 4], [2, 1], [0, 4]]
    >>> contains(bowl, [2.0, 0.5]), contains(bowl, [2.0, 3.0])
    (True, False)
    """
    p, (x, y) = np.asarray(vertices, dtype=float), np.asarray(point, dtype=float)
    q = np.roll(p, -1, axis=0)
    spans = (p[:, 1] > y) != (q[:, 1] > y)
    p, q = p[spans], q[spans]
    ahead = x < p[:, 0] + (y - p[:, 1]) * (q[:, 0] - p[:, 0]) / (q[:, 1] - p[:, 1])
    return bool(np.count_nonzero(ahead) % 2)
