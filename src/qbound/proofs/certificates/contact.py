"""A place of each of two hulls that shows that they are too near, and discs about them (untrusted).

Two parts with an inside overlap most where the sum of the distances to their edges is largest: a
disc about that place lies in both parts, and both radii count. Elsewhere the nearest places show
most. Rows are computed together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from qbound.arrays import Floats, Ints
from qbound.proofs.certificates.inequality import Arm, Kind
from qbound.proofs.subdivide import Cells, Rows

ALONG = 17
"""Places of a segment that are compared in a round."""

ROUNDS = 24
"""Rounds of the search for the best place: its steps shrink by a quarter each."""

WITHIN = 1 - 1e-7
"""Part of a disc that is written down: weights are rounded."""

NEARLY = 2.0**-29
"""Part of an arm's length by which discs have to show more, because planes may differ."""

DECIMALS = 9
"""Of a weight."""


@dataclass(frozen=True, eq=False)
class Contacts(Rows):
    """Places of the two hulls of things, T rows.

    Attributes
    ----------
    near, far : ndarray, shapes (T, m) and (T, c)
        Weights of the corners; each row has the sum 1.
    inside : ndarray, shape (T, 2)
        Radii of the discs about the two places.
    """

    near: Floats
    far: Floats
    inside: Floats


def contacts(arm: Arm, kind: Kind, rows: Ints, cells: Cells) -> Contacts:
    """Return places that show best that things are violated at the middles of cells."""
    seen = arm.seen(kind, rows, cells)
    if kind.normals is not None:
        height = np.einsum("tcx,tx->tc", seen.r, kind.normals[rows])
        lowest = np.eye(height.shape[1])[height.argmin(axis=1)]
        return Contacts(np.zeros((len(rows), 0)), lowest, np.zeros((len(rows), 2)))
    if kind.along is None:
        one = np.ones((len(rows), 1))
        return Contacts(one, one, np.zeros((len(rows), 2)))
    across = [k for k in range(3) if k != kind.along]
    hulls = seen.places[..., across], seen.r[..., across]
    best = _deepest(*hulls)
    near, far = (_weights(hull, best) for hull in hulls)
    return rounded(kind, rows, near, far)


def rounded(kind: Kind, rows: Ints, near: Floats, far: Floats) -> Contacts:
    """Round weights as they are written, and put the largest discs about their places."""
    across = [k for k in range(3) if k != kind.along]
    weights, radii = list[Floats](), list[Floats]()
    for exact, hull in ((near, kind.places[rows]), (far, kind.corners[rows])):
        own = np.round(exact, DECIMALS)
        own[np.arange(len(own)), own.argmax(axis=1)] += 1 - own.sum(axis=1)
        flat = hull[..., across]
        place = np.einsum("tk,tkx->tx", own, flat)
        depth = _depth(flat, place[:, None])[:, 0] if flat.shape[1] > 2 else np.zeros(len(own))
        weights.append(own)
        radii.append(np.maximum(depth, 0) * WITHIN)
    return Contacts(weights[0], weights[1], np.stack(radii, axis=1))


def violated(
    arm: Arm,
    kind: Kind,
    rows: Ints,
    cells: Cells,
    found: Contacts,
    free: Sequence[bool] | None = None,
) -> Floats:
    """Return by how much the second inequality holds on cells, shape (T,)."""
    far = np.einsum("tc,tcx->tx", found.far, kind.corners[rows])[:, None]
    seen = arm.seen(kind, rows, cells, far, free)
    steps = cells.steps
    moved = seen.r + np.einsum("tkj,tjx->tkx", steps, seen.slopes[:, :, 0])
    if kind.normals is not None:
        largest = np.einsum("tkx,tx->tk", moved, kind.normals[rows]).max(axis=1)
    else:
        near = np.einsum("tm,tmx->tx", found.near, seen.places)
        largest = np.linalg.norm(moved - near[:, None], axis=2).max(axis=1)
    discs = found.inside.sum(axis=1)
    allowed = seen.distances + discs - np.where(discs > 0, NEARLY * arm.size, 0)
    return np.asarray(allowed - largest - seen.bend[:, 0] - seen.spread[:, 0])


# --- places of the plane --------------------------------------------------------------------------


def _deepest(near: Floats, far: Floats) -> Floats:
    """Return the places where the sum of the depths in both hulls is largest, shape (T, 2).

    The sum is concave. It is looked for on the hull with fewer corners: on a segment by sampling
    it, on an outline by a search in steps that shrink.
    """
    one, other = (near, far) if near.shape[1] <= far.shape[1] else (far, near)
    if one.shape[1] == 1:
        return np.asarray(one[:, 0])
    rows = np.arange(len(one))
    if one.shape[1] == 2:
        low, high = np.zeros(len(one)), np.ones(len(one))
        for _ in range(6):
            part = low[:, None] + np.linspace(0, 1, ALONG) * (high - low)[:, None]
            place = one[:, :1] + part[..., None] * (one[:, 1:] - one[:, :1])
            best = _depth(other, place).argmax(axis=1)
            low, high = (part[rows, np.clip(best + k, 0, ALONG - 1)] for k in (-1, 1))
        middle = ((low + high) / 2)[:, None]
        return np.asarray(one[:, 0] + middle * (one[:, 1] - one[:, 0]))
    starts = np.concatenate([one, other, *(h.mean(axis=1, keepdims=True) for h in (one, other))], 1)
    best = starts[rows, (_depth(one, starts) + _depth(other, starts)).argmax(axis=1)]
    size = np.ptp(one, axis=1).max(axis=1)
    angle = np.arange(8) * np.pi / 4
    ways = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    ways = np.concatenate([np.zeros((1, 2)), ways, ways / 2])
    for k in range(ROUNDS):
        turn = np.array([[np.cos(k), -np.sin(k)], [np.sin(k), np.cos(k)]])  # other ways each round
        tries = best[:, None] + size[:, None, None] * 0.75**k * (ways @ turn)
        best = tries[rows, (_depth(one, tries) + _depth(other, tries)).argmax(axis=1)]
    return np.asarray(best)


def _to_edges(hull: Floats, places: Floats) -> tuple[Floats, Floats, Floats]:
    """Compare places, shape (T, k, 2), with the edges of hulls: three arrays (T, k, edges).

    Where along an edge its nearest point lies, from 0 to 1; how far that is from the place; and
    what is more than 0 if the place lies on the left of the edge.
    """
    step = (np.roll(hull, -1, axis=1) - hull)[:, None]
    square = (step**2).sum(axis=-1)
    off = places[:, :, None] - hull[:, None]
    part = np.clip((off * step).sum(axis=-1) / np.where(square > 0, square, 1), 0, 1)
    distance: Floats = np.linalg.norm(off - part[..., None] * step, axis=-1)
    return part, distance, _cross(step, off)


def _depth(hull: Floats, places: Floats) -> Floats:
    """Return the distances of places (T, k, 2) to the edge of a hull; below 0 outside."""
    _, distances, left = _to_edges(hull, places)
    distance: Floats = distances.min(axis=-1)
    if hull.shape[1] < 3:
        return np.asarray(-distance)
    area = (hull[..., 0] * np.roll(hull[..., 1], -1, 1)).sum(1)
    area -= (hull[..., 1] * np.roll(hull[..., 0], -1, 1)).sum(1)
    inside = (left * np.sign(area)[:, None, None] >= 0).all(axis=-1)
    return np.where(inside, distance, -distance)


def _weights(hull: Floats, places: Floats) -> Floats:
    """Write the places of hulls that are nearest to places (T, 2) as means of their corners."""
    count = hull.shape[1]
    rows = np.arange(len(hull))
    if count == 1:
        return np.ones((len(hull), 1))
    following = np.roll(np.arange(count), -1)
    part, distance = (x[:, 0] for x in _to_edges(hull, places[:, None])[:2])
    edge = distance.argmin(axis=1)
    weights = np.zeros((len(hull), count))
    np.add.at(weights, (rows, edge), 1 - part[rows, edge])
    np.add.at(weights, (rows, following[edge]), part[rows, edge])
    if count < 3:
        return weights
    inside = _depth(hull, places[:, None])[:, 0] >= 0
    a, b, c = hull[:, :1], hull[:, 1:-1], hull[:, 2:]
    whole = _cross(b - a, c - a)
    safe = np.where(whole == 0, 1, whole)
    v, w = (_cross(places[:, None] - a, c - a) / safe, _cross(b - a, places[:, None] - a) / safe)
    fan = np.stack([1 - v - w, v, w], axis=-1)
    fan[whole == 0] = -np.inf
    best = fan.min(axis=-1).argmax(axis=1)
    own = np.maximum(fan[rows, best], 0)
    own /= own.sum(axis=1, keepdims=True)
    filled = np.zeros_like(weights)
    for k, corner in enumerate((np.zeros_like(best), best + 1, best + 2)):
        np.add.at(filled, (rows, corner), own[:, k])
    return np.where(inside[:, None], filled, weights)


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
