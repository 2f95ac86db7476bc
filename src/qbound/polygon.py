"""Polygons in joint space, and polylines in the plane of the tool."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats

INSIDE: Final = 1e-9
"""A crossing this near to an end of a piece, as part of its length, is a common end point."""

BLOCK: Final = 2**20
"""So many distances are computed at once, so that memory stays below tens of megabytes."""


def area(vertices: ArrayLike) -> float:
    r"""Return the signed area :math:`\frac12 \sum_i (x_i y_{i+1} - x_{i+1} y_i)` of a polygon.

    Parameters
    ----------
    vertices : array_like, shape (m, 2)
        Anticlockwise for a positive area.

    Examples
    --------
    >>> from qbound.polygon import area
    >>> area([[0, 0], [1, 0], [1, 1], [0, 1]])
    1.0
    """
    p = np.asarray(vertices, dtype=float)
    return float(cross(p, np.roll(p, -1, axis=0)).sum() / 2)


def centroid(vertices: ArrayLike) -> Floats:
    r"""Return the centroid of a polygon's area, shape (2,), by Green's theorem.

    .. math:: g = \frac{1}{6A} \sum_i (p_i + p_{i+1})(x_i y_{i+1} - x_{i+1} y_i)

    Raises
    ------
    ValueError
        If the polygon has no area.

    Examples
    --------
    >>> from qbound.polygon import centroid
    >>> centroid([[0, 0], [3, 0], [0, 3]]).tolist()
    [1.0, 1.0]
    """
    p = np.asarray(vertices, dtype=float)
    near = p.mean(axis=0)  # moments about a near point lose fewer digits
    start, end = p - near, np.roll(p - near, -1, axis=0)
    doubled = cross(start, end)
    if doubled.sum() == 0:
        raise ValueError("a polygon without area has no centroid")
    return np.asarray(near + doubled @ (start + end) / (3 * doubled.sum()))


def scaled(vertices: ArrayLike, factor: float, centre: ArrayLike) -> Floats:
    """Return ``g + s (p - g)`` of each vertex p, with factor s and centre g (Figure 6).

    Parameters
    ----------
    vertices : array_like, shape (m, n)
    factor : float
        The factor s: below 1 the polygon shrinks.
    centre : array_like, shape (n,)
        The point g that stays; in the paper the centroid of the polygon.

    Returns
    -------
    ndarray, shape (m, n)

    Examples
    --------
    >>> from qbound.polygon import scaled
    >>> scaled([[0, 0], [4, 0], [0, 4]], 0.5, [2, 2]).tolist()
    [[1.0, 1.0], [3.0, 1.0], [1.0, 3.0]]
    """
    p, g = np.asarray(vertices, dtype=float), np.asarray(centre, dtype=float)
    return np.asarray(g + factor * (p - g))


def tangent_corners(q: Floats, normal: Floats) -> Floats:
    """Return where the tangents at neighbouring points of a curve meet, shape (m - 1, 2).

    Parameters
    ----------
    q : ndarray, shape (m, 2)
        Points of the curve.
    normal : ndarray, shape (m, 2)
        A normal vector of any length at each point, such as the gradient of a form.

    Raises
    ------
    numpy.linalg.LinAlgError
        If two neighbouring tangents are parallel.

    Examples
    --------
    >>> from qbound.polygon import tangent_corners
    >>> tangent_corners(np.array([[1.0, 0.0], [0.0, 1.0]]), np.eye(2)).tolist()
    [[1.0, 1.0]]
    """
    # The tangent at q has the points x with n . x = n . q; two such equations have one solution.
    both = np.stack([normal[:-1], normal[1:]], axis=1)
    level = (both * np.stack([q[:-1], q[1:]], axis=1)).sum(axis=-1)
    return np.asarray(np.linalg.solve(both, level[..., None])[..., 0])


# --- polylines ------------------------------------------------------------------------------------


def crossings(one: ArrayLike, other: ArrayLike) -> Floats:
    """Return the points at which two plane polylines, shape (m, 2) each, cross, shape (k, 2).

    A common end point of two pieces is not a crossing. Every piece is compared with every piece.

    Examples
    --------
    >>> from qbound.polygon import crossings
    >>> crossings([[0, 0], [2, 2]], [[0, 2], [2, 0]]).tolist()
    [[1.0, 1.0]]
    """
    p, r = (np.asarray(x, dtype=float) for x in (one, other))
    u, v = np.diff(p, axis=0)[:, None], np.diff(r, axis=0)[None]
    # The pieces p + t u and r + s v meet where t u x v = (r - p) x v and s u x v = (r - p) x u.
    gap, turn = r[None, :-1] - p[:-1, None], cross(u, v)
    with np.errstate(divide="ignore", invalid="ignore"):  # parallel pieces do not cross
        t, s = cross(gap, v) / turn, cross(gap, u) / turn
    inside = [(x > INSIDE) & (x < 1 - INSIDE) for x in (t, s)]  # of both pieces
    i, j = np.nonzero(inside[0] & inside[1])
    return np.asarray(p[i] + t[i, j][:, None] * u[i, 0])


def self_crossings(path: ArrayLike) -> Floats:
    """Return the points at which a plane polyline, shape (m, 2), crosses itself, shape (k, 2).

    Examples
    --------
    >>> from qbound.polygon import self_crossings
    >>> self_crossings([[0, 0], [2, 2], [2, 0], [0, 2]]).tolist()
    [[1.0, 1.0]]
    """
    p = np.asarray(path, dtype=float)
    if len(p) < 3:
        return np.empty((0, 2))
    # A crossing lies between the two halves of the path, or within one of them.
    k = len(p) // 2
    one, other = p[: k + 1], p[k:]
    return np.concatenate([crossings(one, other), self_crossings(one), self_crossings(other)])


def hausdorff(one: ArrayLike, other: ArrayLike) -> float:
    """Return the largest distance of a corner of either polyline from the other polyline.

    For polylines with many short pieces this is close to their Hausdorff distance.

    Parameters
    ----------
    one, other : array_like, shape (m, 2)

    Examples
    --------
    >>> from qbound.polygon import hausdorff
    >>> hausdorff([[0, 0], [4, 0]], [[0, 1], [2, 3], [4, 1]])
    3.0
    """
    return max(float(distances(one, other).max()), float(distances(other, one).max()))


def distances(points: ArrayLike, path: ArrayLike) -> Floats:
    """Return how far points, shape (n, 2), are from a plane polyline, shape (m, 2); shape (n,).

    Examples
    --------
    >>> from qbound.polygon import distances
    >>> distances([[1, 1], [5, 4]], [[0, 0], [2, 0]]).tolist()
    [1.0, 5.0]
    """
    p, line = np.asarray(points, dtype=float), np.asarray(path, dtype=float)
    start, step = line[:-1], np.diff(line, axis=0)
    # The squared lengths of the pieces, never 0: a piece may be a point.
    squared = np.maximum((step**2).sum(axis=-1), np.finfo(float).tiny)
    found = [np.empty(0)]
    for some in np.array_split(p, max(1, len(p) * len(line) // BLOCK)):
        from_start = some[:, None] - start
        t = np.clip((from_start * step).sum(axis=-1) / squared, 0, 1)
        found.append(np.linalg.norm(from_start - t[..., None] * step, axis=-1).min(axis=1))
    return np.concatenate(found)


def cross(u: Floats, v: Floats) -> Floats:
    """Return ``u_x v_y - u_y v_x`` of plane vectors, shape (..., 2) to (...)."""
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
