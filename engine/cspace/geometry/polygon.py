"""Polygons in joint space, and polylines: crossings; area and centroid are qbound's.

Curves by a parameter become polylines of a stated deviation. Not in the paper, which does not say
how finely it draws its paths.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from cspace.arguments import number_above_zero
from cspace.arrays import Bools, Floats, Indices, ranges
from cspace.tolerances import ON_BOUNDARY
from qbound.polygon import area, centroid, cross, scaled

__all__ = [
    "Curve",
    "along_edges",
    "area",
    "centroid",
    "contains",
    "cross",
    "crossing_pieces",
    "deviations",
    "flatten",
    "near_boxes",
    "scaled",
    "tangent_corners",
    "too_fine",
]


def along_edges(vertices: ArrayLike, t: ArrayLike) -> Floats:
    """Return points at fractions `t` of every edge of the closed polygon, shape (m, len(t), 2)."""
    p = np.asarray(vertices, dtype=float)
    step = np.roll(p, -1, axis=0) - p
    return np.asarray(p[:, None] + np.asarray(t)[None, :, None] * step[:, None])


def contains(vertices: ArrayLike, places: ArrayLike) -> Bools:
    """Tell whether places lie inside a polygon: a ray from each crosses the edges an odd number.

    Parameters
    ----------
    vertices : array_like, shape (m, 2)
    places : array_like, shape (..., 2)

    Returns
    -------
    ndarray of bool, shape (...)

    Examples
    --------
    >>> bowl = [[0, 0], [4, 0], [4, 4], [2, 1], [0, 4]]
    >>> contains(bowl, [[2.0, 0.5], [2.0, 3.0]]).tolist()
    [True, False]
    """
    p, at = np.asarray(vertices, dtype=float), np.asarray(places, dtype=float)
    x, y = at.reshape(-1, 2).T
    order = np.argsort(y)
    # An edge counts for heights from its lower end up to, but not including, its upper end.
    step = np.roll(p, -1, axis=0) - p
    first, last = np.searchsorted(y[order], np.sort([p[:, 1], p[:, 1] + step[:, 1]], axis=0))
    edge, k = ranges(first, last)
    place, start, slope = order[k], p[edge], step[edge, 0] / step[edge, 1]
    ahead = x[place] < start[:, 0] + (y[place] - start[:, 1]) * slope
    odd = np.bincount(place[ahead], minlength=len(x)) % 2 == 1
    return np.asarray(odd.reshape(at.shape[:-1]))


# --- polylines ------------------------------------------------------------------------------------


Curve = Callable[[Floats], Floats]
"""Parameters in [0, 1], shape (k,), to places, shape (k, d)."""

PART, FINEST = 4, 2.0**-30
MOST = 2**17
"""Points of a curve: more than any drawing needs, and what memory has room for many times."""

BETWEEN = np.array([0.25, 0.5, 0.75])
ROWS = 512
"""Boxes that are looked at together."""


def flatten(curve: Curve, tolerance: float, parts: int = 2) -> tuple[Floats, float]:
    """Choose parameters so that the polyline through their places stays near the curve.

    Pieces are halved until the curve, checked at three places of each piece, is within half the
    tolerance of its chord. The other half is kept for the curve between these places.

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
        If the tolerance is not above zero, needs more than `MOST` points, or is not reached by
        pieces of 1e-9 of the curve.
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
    """Return the message of a deviation that needs too many points."""
    return f"a deviation of {deviation:g} takes some {cost:.0f} points where {most} are the most"


def deviations(curve: Curve, s: Floats) -> Floats:
    """Return the distance of each piece from its chord, at three places of it, shape (k - 1,)."""
    ends = curve(s)
    middles = (s[:-1, None] + np.diff(s)[:, None] * BETWEEN).ravel()
    places = curve(middles).reshape(len(s) - 1, len(BETWEEN), -1)
    along = places - ends[:-1, None]
    return np.asarray(_off(along, np.diff(ends, axis=0)[:, None]).max(axis=1))


def _off(along: Floats, chord: Floats) -> Floats:
    """Return the distances of places from chords; both are seen from the start of the chord."""
    length = np.maximum((chord**2).sum(axis=-1), np.finfo(float).tiny)
    t = np.clip((along * chord).sum(axis=-1) / length, 0, 1)
    return np.asarray(np.linalg.norm(along - t[..., None] * chord, axis=-1))


def crossing_pieces(p: Floats, beyond: float = 0.0) -> tuple[Indices, Indices, Floats, Floats]:
    """Return the pieces i, j of a plane path that cross, and at which fractions t, s of them.

    Parameters
    ----------
    p : ndarray, shape (m, 2)
    beyond : float
        Each piece may be extended at both ends by this part of its length.
    """
    start, step = p[:-1], np.diff(p, axis=0)
    i, j = near_boxes(start - beyond * step, p[1:] + beyond * step)
    i, j = i[j > i + 1], j[j > i + 1]
    gap, turn = start[j] - start[i], cross(step[i], step[j])
    with np.errstate(divide="ignore", invalid="ignore"):
        t, s = cross(gap, step[j]) / turn, cross(gap, step[i]) / turn
    low, high = -beyond, 1 + beyond
    met = (t > low) & (t < high) & (s > low) & (s < high)
    return i[met], j[met], t[met], s[met]


def near_boxes(corner: Floats, opposite: Floats) -> tuple[Indices, Indices]:
    """Return the pairs i < j of upright boxes that have a point in common, in order.

    Parameters
    ----------
    corner, opposite : ndarray, shape (m, 2)
        Of each box: the ends of a segment are those of its box.
    """
    low, high = np.minimum(corner, opposite), np.maximum(corner, opposite)
    order = np.argsort(low[:, 0], kind="stable")
    last = np.searchsorted(low[order, 0], high[order, 0], side="right")
    pairs = [np.empty((2, 0), dtype=np.intp)]
    for first in range(0, len(order), ROWS):
        rows = np.arange(first, min(first + ROWS, len(order)))
        pick, other = ranges(rows + 1, last[rows])
        i, j = order[rows[pick]], order[other]
        met = (low[i, 1] <= high[j, 1]) & (low[j, 1] <= high[i, 1])
        pairs.append(np.sort([i[met], j[met]], axis=0))
    found = np.concatenate(pairs, axis=1)
    i, j = found[:, np.lexsort(found[::-1])]
    return i, j


def tangent_corners(q: Floats, normal: Floats) -> Floats:
    """Return where the tangents at neighbouring points of a curve meet, shape (m - 1, 2).

    Tangents along one straight line meet in the middle.

    Parameters
    ----------
    q, normal : ndarray, shape (m, 2)
        Points of the curve, and normal vectors of any length there.
    """
    size = np.abs(normal).max(axis=-1, keepdims=True)
    normal = normal / np.where(size > 0, size, 1)
    pair = np.stack([normal[:-1], normal[1:]], axis=1)
    level = (pair * np.stack([q[:-1], q[1:]], axis=1)).sum(axis=-1)
    flat = np.abs(np.linalg.det(pair)) <= ON_BOUNDARY  # one straight line
    pair[flat] = np.eye(2)
    met = np.linalg.solve(pair, level[..., None])[..., 0]
    return np.asarray(np.where(flat[:, None], (q[:-1] + q[1:]) / 2, met))
