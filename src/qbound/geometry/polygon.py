"""Polygons in joint space, and polylines: area, centroid, scaling about a point.

Curves by a parameter become polylines of a stated deviation. Not in the paper, which draws its
paths without a word on how finely.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arguments import number_above_zero
from qbound.arrays import Floats
from qbound.tolerances import ON_BOUNDARY


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


# --- polylines ------------------------------------------------------------------------------------


Curve = Callable[[Floats], Floats]
"""Parameters in [0, 1], shape (k,), to places, shape (k, d)."""

PART, FINEST = 4, 2.0**-30
MOST = 2**17
"""Points of a curve: more than any drawing needs, and what memory has room for many times."""

BETWEEN = np.array([0.25, 0.5, 0.75])


def flatten(curve: Curve, tolerance: float, parts: int = 2) -> tuple[Floats, float]:
    """Choose parameters so that the polyline through their places stays near the curve.

    Pieces are halved until the curve, looked at in three places of each, is within half of the
    tolerance of its chord: the other half is room for what lies between these places.

    Parameters
    ----------
    parts : int
        Equal parts of [0, 1] on each of which the curve is smooth.

    Returns
    -------
    s : ndarray, shape (k,)
        Rising from 0 to 1.
    deviation : float
        Largest distance measured, at most `tolerance`.

    Raises
    ------
    ValueError
        If the tolerance is not above zero, takes more than `MOST` points, or is not reached by
        pieces of a thousand-millionth of the curve.
    """
    number_above_zero("deviation", tolerance)
    s = np.linspace(0.0, 1.0, PART * parts + 1)
    while True:
        off = deviations(curve, s)
        wide = np.nonzero(off > tolerance / 2)[0]
        if not len(wide):
            return s, float(off.max())
        if len(s) + len(wide) > MOST:
            cost = np.sqrt(2 * off / tolerance).clip(1).sum()  # a chord is off by its square
            raise ValueError(too_fine(tolerance, cost, MOST))
        if np.diff(s)[wide].min() < FINEST:
            raise ValueError(f"the curve cannot be followed to {tolerance:g}: it is not smooth")
        s = np.insert(s, wide + 1, (s[wide] + s[wide + 1]) / 2)


def too_fine(deviation: float, cost: float, most: int) -> str:
    """Say what a deviation costs in points."""
    return f"a deviation of {deviation:g} takes some {cost:.0f} points where {most} are the most"


def deviations(curve: Curve, s: Floats) -> Floats:
    """Return the distance of each piece from its chord, at three places of it, shape (k - 1,)."""
    ends = curve(s)
    middles = (s[:-1, None] + np.diff(s)[:, None] * BETWEEN).ravel()
    places = curve(middles).reshape(len(s) - 1, len(BETWEEN), -1)
    chord = np.diff(ends, axis=0)[:, None]
    along = places - ends[:-1, None]
    length = np.maximum((chord**2).sum(axis=-1), np.finfo(float).tiny)
    t = np.clip((along * chord).sum(axis=-1) / length, 0, 1)
    return np.asarray(np.linalg.norm(along - t[..., None] * chord, axis=-1).max(axis=1))


def self_crossings(path: ArrayLike) -> Floats:
    """Return the points at which a plane path crosses itself, shape (k, 2).

    Two pieces cross where each has its ends on different sides of the other. A path that only
    touches itself, as a closed one does at its start, does not cross; nor is a crossing counted
    that passes exactly through a corner.

    Parameters
    ----------
    path : array_like, shape (m, 2)
    """
    p = np.asarray(path, dtype=float)
    i, _, t, _ = crossing_pieces(p)
    return np.asarray(p[i] + t[:, None] * (p[i + 1] - p[i]))


def crossing_pieces(
    p: Floats, beyond: float = 0.0
) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats, Floats]:
    """Return the pieces i, j of a plane path that cross, and at which fractions t, s of them.

    Parameters
    ----------
    p : ndarray, shape (m, 2)
    beyond : float
        Part of its length by which each piece may be taken longer at both ends.
    """
    start, step = p[:-1], np.diff(p, axis=0)
    t, s = meetings(start, step, start, step)
    later = np.triu(np.ones(t.shape, dtype=bool), k=2)
    low, high = -beyond, 1 + beyond
    i, j = np.nonzero(later & (t > low) & (t < high) & (s > low) & (s < high))
    return i, j, t[i, j], s[i, j]


def meetings(a: Floats, u: Floats, b: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Solve ``a_i + t u_i = b_j + s v_j`` for every pair of lines; t and s, not finite if parallel.

    Parameters
    ----------
    a, u : ndarray, shape (m, 2)
    b, v : ndarray, shape (n, 2)

    Returns
    -------
    t, s : ndarray, shape (m, n)
    """
    gap = b[None, :] - a[:, None]
    turn = cross(u[:, None], v[None, :])
    with np.errstate(divide="ignore", invalid="ignore"):
        return cross(gap, v[None, :]) / turn, cross(gap, u[:, None]) / turn


def tangent_corners(q: Floats, normal: Floats) -> Floats:
    """Return where the tangents at neighbouring points of a curve meet, shape (m - 1, 2).

    Tangents along one straight line meet in the middle.

    Parameters
    ----------
    q, normal : ndarray, shape (m, 2)
        Points of the curve and what is normal to it there, of any length.
    """
    size = np.abs(normal).max(axis=-1, keepdims=True)
    normal = normal / np.where(size > 0, size, 1)
    pair = np.stack([normal[:-1], normal[1:]], axis=1)
    level = (pair * np.stack([q[:-1], q[1:]], axis=1)).sum(axis=-1)
    flat = np.abs(np.linalg.det(pair)) <= ON_BOUNDARY  # one straight line
    pair[flat] = np.eye(2)
    met = np.linalg.solve(pair, level[..., None])[..., 0]
    return np.asarray(np.where(flat[:, None], (q[:-1] + q[1:]) / 2, met))


def cross(u: Floats, v: Floats) -> Floats:
    """Return ``u_x v_y - u_y v_x`` of plane vectors, shape (..., 2) to (...)."""
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
