"""Distance of two convex cores of the plane, or the depth of their overlap.

A core is a point, a segment or a convex polygon. Everything follows from the corners of each core
as seen from the edges of the other: how far beyond the line of the edge, and how far along it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Bools, Floats
from cspace.geometry.polygon import cross
from cspace.tolerances import UNIT, ZERO_AMPLITUDE


class Edges(NamedTuple):
    """Edges of a core: 1 for a segment, m for a polygon; a point is an edge of length 0.

    Edge i goes from corner i to the next. The normal is a unit vector, outward of a polygon.
    """

    middle: Floats
    """Shape (..., e, 2)."""
    tangent: Floats
    normal: Floats
    half: Floats
    """Half the length, shape (..., e)."""


class Closest(NamedTuple):
    """The features at which two cores are nearest, or overlap the least."""

    distance: float
    """As `signed` has it."""
    features: tuple[str, str]
    """Of each core: "corner 2", or "edge 3", which goes from corner 3 to the next; from 0."""
    places: Floats
    """Of each core, shape (2, 2); where they overlap, what has to come together to part them."""
    direction: Floats
    """Unit vector, shape (2,): the second core is moved along it to part them."""


class View(NamedTuple):
    """Corners of one core seen from the edges of another."""

    across: Floats
    """How far beyond the line of the edge, shape (e, k, ...)."""
    along: Floats
    """How far from the edge's middle along it, shape (e, k, ...)."""
    half: Floats
    """Half the length of the edge, shape (e, 1, ...)."""
    solid: bool
    """Whether the edges are those of a polygon, which has an inside."""


def edges(core: ArrayLike) -> Edges:
    """Return the edges of a core, shape (..., m, 2).

    Raises
    ------
    ValueError
        If a polygon is not convex, has no area, or repeats a corner; if a number is not finite.
    """
    p = np.asarray(core, dtype=float)
    if p.shape[-1:] != (2,) or p.ndim < 2 or p.shape[-2] == 0:
        raise ValueError(f"corners have the shape (..., m, 2), m at least 1; found {p.shape}")
    if not np.isfinite(p).all():
        raise ValueError("a corner is NaN or infinite")
    solid = p.shape[-2] >= 3
    step = np.roll(p, -1, axis=-2) - p
    outward = _sense(p, step) if solid else np.ones(p.shape[:-2])
    if not solid:
        p, step = p[..., :1, :], step[..., :1, :]
    length = np.hypot(step[..., 0], step[..., 1])
    if solid and not length.all():
        raise ValueError("an outline repeats a corner")
    unit = np.where(length[..., None] > 0, step, [1.0, 0.0])
    unit = unit / np.where(length > 0, length, 1.0)[..., None]
    normal = np.stack([unit[..., 1], -unit[..., 0]], axis=-1) * outward[..., None, None]
    return Edges(p + step / 2, unit, normal, length / 2)


def views(p: Floats, r: Floats) -> list[View]:
    """Return the corners of each core as seen from the edges of the other."""
    of_p, of_r = edges(p), edges(r)
    found = [seen(of_p, r, p.shape[-2])] if p.shape[-2] > 1 or r.shape[-2] == 1 else []
    return [*found, seen(of_r, p, r.shape[-2])] if r.shape[-2] > 1 else found


def seen(of: Edges, corners: Floats, count: int) -> View:
    """Return corners, shape (..., k, 2), as the edges of a core of `count` corners see them."""
    offset = corners[..., None, :, :] - of.middle[..., :, None, :]
    across = (offset * of.normal[..., :, None, :]).sum(axis=-1)
    along = (offset * of.tangent[..., :, None, :]).sum(axis=-1)
    half = np.broadcast_to(of.half[..., :, None], (*across.shape[:-1], 1))
    across, along, half = (np.moveaxis(x, (-2, -1), (0, 1)) for x in (across, along, half))
    return View(across, along, half, count >= 3)


def signed(seen: Sequence[View]) -> Floats:
    """Return the signed distance of two cores from their `views`, with the batch's shape.

    The signed distance is the Euclidean distance of cores that are apart, zero where they touch,
    and minus the length of the shortest translation that separates cores that overlap.

    Two cores that are apart are nearest at a corner of one and an edge of the other. The shortest
    translation that separates overlapping cores is along a normal of an edge, because the edges of
    their Minkowski difference are the edges of both cores (separating axes).

    Examples
    --------
    >>> box = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]])
    >>> places = [np.array([[7.0, 6.0]]), np.array([[2.0, 1.5]])]
    >>> [float(signed(views(box, place))) for place in places]
    [5.0, -0.5]
    """
    beyond = depths(seen)
    return np.where(apart(seen, beyond), np.sqrt(squared_distance(seen)), beyond)


def depths(seen: Sequence[View]) -> Floats:
    """Return the largest gap along a normal of any edge; for an overlap, minus its depth."""
    return np.asarray(np.maximum.reduce([axis_gaps(view).max(axis=0) for view in seen]))


def closest(one: ArrayLike, other: ArrayLike) -> Closest:
    """Return which features of two single cores, shapes (m, 2) and (k, 2), are nearest, and where.

    Raises
    ------
    ValueError
        As `edges` does.

    Examples
    --------
    >>> found = closest([[0, 0], [4, 0], [4, 2], [0, 2]], [[2, 5], [3, 6]])
    >>> found.distance, found.features, found.places.tolist()
    (3.0, ('edge 2', 'corner 0'), [[2.0, 2.0], [2.0, 5.0]])
    """
    cores = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    all_seen = views(*cores)
    distance = float(signed(all_seen))
    first = 0 if len(cores[0]) > 1 or len(cores[1]) == 1 else 1
    reached = [(*_reached(view, distance), i) for i, view in enumerate(all_seen, first)]
    _, edge, corner, sense, which = min(reached)
    place = cores[1 - which][corner]
    foot, feature, normal = _foot(cores[which], edge, place, distance)
    if sense < 0 and feature == "edge 0":  # a segment has an edge on either side
        feature = "edge 1"
    outward = sense * normal if distance <= 0 else (place - foot) / distance
    turned = 1 - 2 * which
    features, places = (feature, f"corner {corner}"), np.array([foot, place])
    if which == 1:
        features, places = (features[1], features[0]), places[::-1]
    return Closest(distance, features, places, turned * outward + 0.0)


def _reached(view: View, distance: float) -> tuple[float, int, int, int]:
    """Find the edge and corner that fit a distance best; return misfit, edge, corner and sense.

    The sense is -1 if the corner is on the back of a segment.
    """
    if distance >= 0:
        off = np.sqrt(_squares(view)) - distance
        edge, corner = divmod(int(np.argmin(off)), off.shape[1])
        sense = 1 if view.solid or view.across[edge, corner] >= 0 else -1
        return float(off[edge, corner]), edge, corner, sense
    gaps = axis_gaps(view)
    edge = int(np.argmax(gaps))
    sense = 1 if view.solid or view.across[edge].min() == gaps[edge] else -1
    corner = int(np.argmin(sense * view.across[edge]))
    return float(distance - gaps[edge]), edge, corner, sense


def _foot(core: Floats, edge: int, place: Floats, distance: float) -> tuple[Floats, str, Floats]:
    """Return the point of an edge nearest to a place, its feature, and the normal of the edge."""
    of = edges(core)
    middle, tangent, normal, half = (
        of.middle[edge],
        of.tangent[edge],
        of.normal[edge],
        of.half[edge],
    )
    along = float((place - middle) @ tangent)
    if distance < 0 or abs(along) < half:
        return np.asarray(middle + along * tangent), f"edge {edge}", normal
    corner = edge if along < 0 or half == 0 else (edge + 1) % len(core)
    return np.asarray(core[corner]), f"corner {corner}", normal


def axis_gaps(view: View) -> Floats:
    """Return the gap along the normal of each edge; for a segment the larger of both sides."""
    least: Floats = np.asarray(view.across.min(axis=1))
    return least if view.solid else np.maximum(least, -view.across.max(axis=1))


def squared_distance(seen: Sequence[View]) -> Floats:
    """Return the square of the least distance of a corner from an edge."""
    return np.asarray(np.minimum.reduce([_squares(view).min(axis=(0, 1)) for view in seen]))


def apart(seen: Sequence[View], beyond: Floats) -> Bools:
    """Tell where two cores do not overlap; `beyond` is the result of `depths`.

    Two segments on one line may be apart along it although both normals show only rounding.
    """
    found = np.asarray(beyond >= 0)
    if any(view.solid for view in seen):
        return found
    for view in seen:
        low, high = view.along[0].min(axis=0), view.along[0].max(axis=0)
        found = found | (np.maximum(low, -high) > view.half[0, 0])
    return np.asarray(found)


def _squares(view: View) -> Floats:
    """Return the squared distance of each corner from each edge."""
    past = np.maximum(np.abs(view.along) - view.half, 0.0)
    return np.asarray(view.across**2 + past**2)


def _sense(p: Floats, step: Floats) -> Floats:
    """Return 1 for an outline that goes anticlockwise, -1 for clockwise; refuse all others."""
    beyond = cross(step[..., :, None, :], p[..., None, :, :] - p[..., :, None, :])
    longest = np.hypot(step[..., 0], step[..., 1]).max(axis=-1)  # for each outline separately
    reach = np.abs(p).max(axis=(-2, -1))
    rounding = (longest * (ZERO_AMPLITUDE * longest + 4 * UNIT * reach))[..., None, None]
    left, right = ((sense * beyond >= -rounding).all(axis=(-1, -2)) for sense in (1, -1))
    if not (left ^ right).all():
        raise ValueError("the outline of a body must be convex, with an inside")
    return np.where(left, 1.0, -1.0)
