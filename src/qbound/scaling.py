"""Scaling a polygon about a point until it is safe, and how far is far enough (Figure 6)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound import polygon

Floats = NDArray[np.float64]
Form = Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class SafeScale:
    """The largest safe scale and what binds it.

    Attributes
    ----------
    scale : float
        No point of the polygon's edges violates a form at this scale or a smaller one.
    q : ndarray, shape (2,)
        Where the scaled polygon touches.
    edge : int
        Index of the edge (from vertex `edge` to the next) that touches.
    form : int
        Index of the form that it touches; -1 where none binds below the scale searched.
    """

    scale: float
    q: Floats
    edge: int
    form: int


def largest_safe_scale(
    vertices: ArrayLike, centre: ArrayLike, forms: list[Form], *, highest: float = 1.0
) -> SafeScale:
    """Return the largest scale up to which a polygon's edges stay where every form is >= 0.

    Each point of an edge moves away from the centre along a ray; the ray's first crossing of a
    form bounds the scale, and the least of these over the edges is refined by narrowing. Forms are
    functions of joint values, shape (..., 2) -> (...).

    Parameters
    ----------
    vertices : array_like, shape (m, 2)
    centre : array_like, shape (2,)
        Every form must be positive there.
    forms : list of callable
    highest : float
        Scales above it are not searched.

    Raises
    ------
    ValueError
        If a form is not positive at the centre.

    Notes
    -----
    Rays are searched at 128 places and edges at 257: a form that dips below zero between two of
    them is missed. The result is a computation, not a proof.
    """
    p, g = np.asarray(vertices, dtype=float), np.asarray(centre, dtype=float)
    if not (np.isfinite(p).all() and np.isfinite(g).all()):
        raise ValueError("vertices and centre must be finite numbers")
    if not all(form(g) > 0 for form in forms):
        raise ValueError("a boundary is violated at the centre already")
    best = SafeScale(highest, p[0], -1, -1)
    for i, form in enumerate(forms):
        for edge in range(len(p)):
            scale, q = _edge_scale(form, p[edge], p[(edge + 1) % len(p)], g, highest)
            if scale < best.scale:
                best = SafeScale(scale, q, edge, i)
    return best


def least_along_edges(form: Form, vertices: ArrayLike, n: int = 2001) -> tuple[float, Floats]:
    """Return the least value of a form on a polygon's edges and where, from `n` points an edge."""
    q = polygon.along_edges(vertices, np.linspace(0, 1, n)).reshape(-1, 2)
    values = form(q)
    return float(values.min()), np.asarray(q[values.argmin()])


def _edge_scale(
    form: Form, start: Floats, end: Floats, centre: Floats, highest: float
) -> tuple[float, Floats]:
    """Least scale at which the edge start-end meets the form; `highest` where it does not."""
    low, high = 0.0, 1.0
    for _ in range(12):
        t = np.linspace(low, high, 257)
        rays = start + t[:, None] * (end - start) - centre
        scales = _first_crossing(form, centre, rays, highest)
        i = int(scales.argmin())
        low, high = t[max(i - 1, 0)], t[min(i + 1, len(t) - 1)]
        if high - low < 1e-12:
            break
    return float(scales[i]), np.asarray(centre + scales[i] * rays[i])


def _first_crossing(form: Form, centre: Floats, rays: Floats, highest: float) -> Floats:
    """Least s in (0, highest] with form(centre + s ray) = 0 for every ray, else `highest`."""
    s = np.linspace(0, highest, 129)
    negative = form(centre + s[:, None, None] * rays) < 0
    hit = negative.any(axis=0)
    first = np.where(hit, negative.argmax(axis=0), len(s) - 1)
    low, high = s[first - 1], s[first]
    for _ in range(52):
        middle = (low + high) / 2
        outside = form(centre + middle[:, None] * rays) < 0
        low, high = np.where(outside, low, middle), np.where(outside, middle, high)
    return np.where(hit, low, highest)
