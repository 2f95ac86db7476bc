"""Configurations that refute a statement: where a thing or a limit is violated, and how deep.

Below them are places of two hulls that show that the hulls are too near, and discs about them.
Nothing here is trusted, because the checker tests what is written down.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats, Ints
from cspace.geometry.polygon import cross
from cspace.proofs.certificates.inequality import BoundedArm, Kind
from cspace.proofs.certificates.search import margins
from cspace.proofs.certificates.statements import Statement, corners_of, decimal
from cspace.proofs.subdivide import Boxes, Cells, Rows, Simplices

Evidence = dict[str, Any]
"""The witness as a certificate writes it."""

SIDES = ("lower", "upper")

SHRINK = 0.75 ** np.arange(80)
"""Sizes of the neighbourhoods in which the deepest configuration is looked for."""

CELLS = 50
"""Cells in which it is looked for: those that are deepest in the middle."""


@dataclass(frozen=True, eq=False)
class Witness:
    """A configuration of the set, in the file's units, with what it violates and how deep.

    For a boundary the depth is a length. For a limit it is in the file's unit of the joint.
    """

    boundary: str
    q: tuple[float, ...]
    depth: float


def cells_of(arm: BoundedArm, statement: Statement) -> Boxes | Simplices:
    """Return the cells of a statement, rad or length."""
    corners = np.array(corners_of(statement), dtype=float) * arm.units
    if statement["set"] == "box":
        return Boxes.between(corners[:, 0], corners[:, 1])
    return Simplices(corners)


def beyond_limits(arm: BoundedArm, statement: Statement) -> Evidence | None:
    """Return the corner that is farthest beyond a limit of a joint, if any, in exact numbers."""
    found: tuple[Fraction, Evidence] = Fraction(0), {}
    for i, corners in enumerate(corners_of(statement)):
        for k, q in enumerate(corners):
            for j, joint in enumerate(arm.form["joints"]):
                for side, sign, end in zip(SIDES, (1, -1), joint["limits"] or (), strict=False):
                    depth = sign * (Fraction(end) - Fraction(q[j]))
                    if depth > found[0]:
                        at: Evidence = {"at": q}
                        if statement["set"] != "box":
                            weights = ["1" if c == k else "0" for c in range(len(corners))]
                            at = {"cell": i, "weights": weights}
                        found = depth, {**at, "limit": f"{joint['name']}.{side}"}
    return found[1] or None


def deepest(
    arm: BoundedArm, statement: Statement, violated: Mapping[int, tuple[int, Floats]]
) -> Evidence:
    """Follow each violated boundary to where it is violated most, and return the deepest.

    Parameters
    ----------
    violated : mapping of int to (int, ndarray)
        For each number of a thing: a cell, and a configuration in the cell that violates the thing.
    """
    cells, found = cells_of(arm, statement), list[tuple[float, Evidence]]()
    for name in dict.fromkeys(arm.names[k] for k in violated):
        things = [k for k, other in enumerate(arm.names) if other == name and arm.needed[k]]

        def least(q: Floats, things: Sequence[int] = things) -> Floats:
            shape = q.shape[:-1]
            values = margins(arm, things, q.reshape(-1, q.shape[-1])).min(axis=1)
            return np.asarray(values.reshape(shape))

        start, q = next(violated[k] for k in violated if arm.names[k] == name)
        if isinstance(cells, Boxes):
            low, high, rng = cells.low[0], cells.high[0], np.random.default_rng(0)
            for size in SHRINK:
                step = size * (high - low) * rng.uniform(-1, 1, (60, len(q)))
                tries = np.concatenate([q[None], np.clip(q + step, low, high)])
                q = tries[int(least(tries).argmin())]
            lowest, ends = q, statement["points"][0]
            values = zip(map(float, q / arm.units), *ends, strict=True)
            within = (sorted((decimal(x), *limits), key=Fraction) for x, *limits in values)
            at: Evidence = {"at": [middle for _, middle, _ in within]}
        else:
            cell, weights = _lowest(least, cells.corners, start, q)
            lowest = weights @ cells.corners[cell]
            at = {"cell": cell, "weights": _decimals(weights)}
        own = margins(arm, things, lowest[None])[0]
        thing = things[int(own.argmin())]
        found.append((float(own.min()), {**at, "place": _shown(arm, thing, lowest)}))
    return min(found, key=lambda row: row[0])[1]


def witness(arm: BoundedArm, statement: Statement, evidence: Evidence) -> Witness:
    """Return the configuration and its depth, read from the content of the file."""
    if "at" in evidence:
        q = np.array(evidence["at"], dtype=float)
    else:
        corners = np.array(corners_of(statement)[evidence["cell"]], dtype=float)
        q = np.array(evidence["weights"], dtype=float) @ corners
    if "place" in evidence:
        thing = evidence["place"]["keep"]
        depth = -float(margins(arm, [thing], q[None] * arm.units)[0, 0])
        return Witness(arm.names[thing], tuple(q.tolist()), depth)
    name, _, side = evidence["limit"].rpartition(".")
    joints = arm.form["joints"]
    j = [joint["name"] for joint in joints].index(name)
    end = float(joints[j]["limits"][side == "upper"])
    return Witness(evidence["limit"], tuple(q.tolist()), abs(float(q[j] - end)))


def place_of(arm: BoundedArm, thing: int, contacts: Contacts) -> Evidence:
    """Write a place of the two hulls of a thing, the one row of `found`."""
    row, hulls = arm.form["keep"][thing], arm.form["hulls"]
    far = _folded(contacts.far[0], len(hulls[row["far"]]["corners"]))
    if "normal" in row:
        return {"keep": thing, "near": [], "far": _decimals(far)}
    near = _folded(contacts.near[0], len(hulls[row["near"]]["corners"]))
    written = {"keep": thing, "near": _decimals(near), "far": _decimals(far)}
    radii = [decimal(max(float(x) - 1e-12, 0)) for x in contacts.inside[0]]
    return written if radii == ["0", "0"] else {**written, "inside": radii}


def _shown(arm: BoundedArm, thing: int, q: Floats) -> Evidence:
    """Return places of both hulls of a thing that show the violation."""
    kind, rows = arm.kinds[arm.kind_of[thing]], arm.row_of[[thing]]
    return place_of(arm, thing, contacts(arm, kind, rows, Boxes(q[None], np.zeros((1, len(q))))))


def _folded(weights: Floats, count: int) -> Floats:
    """Add the weights of padded corners to the weight of the corner that they repeat."""
    return np.append(weights[: count - 1], weights[count - 1 :].sum())


def _lowest(
    margin: Callable[[Floats], Floats], cells: Floats, cell: int, q: Floats
) -> tuple[int, Floats]:
    """Return the cell, and the weights of its corners, where a margin is lowest: a local search.

    In each cell a smaller copy of the cell shrinks around the lowest of its corners, middles and
    centre so far. The search starts at the centres and, in one cell, at a configuration known to be
    low.
    """
    chosen = np.unique(np.append(margin(cells.mean(axis=1)).argsort()[:CELLS], cell))
    cells, cell = cells[chosen], int(np.flatnonzero(chosen == cell)[0])
    count, k = cells.shape[:2]
    i, j = np.triu_indices(k, 1)
    tries = np.concatenate([np.eye(k), (np.eye(k)[i] + np.eye(k)[j]) / 2, np.full((1, k), 1 / k)])
    lowest, rows = np.full((count, k), 1 / k), np.arange(count)
    lowest[cell] = _weights(cells[cell], q)
    for size in SHRINK:
        near = (1 - size) * lowest[:, None] + size * tries
        around = np.concatenate([lowest[:, None], near], axis=1)
        lowest = around[rows, margin(around @ cells).argmin(axis=1)]
    best = int(margin(np.einsum("nk,nkj->nj", lowest, cells)).argmin())
    return int(chosen[best]), lowest[best]


def _weights(cell: Floats, q: Floats) -> Floats:
    """Write a configuration of a cell as a mean of its corners."""
    system = np.vstack([cell.T, np.ones(len(cell))])
    weights = np.linalg.lstsq(system, np.append(q, 1), rcond=None)[0]
    weights = np.maximum(weights, 0)
    return np.asarray(weights / weights.sum())


def _decimals(weights: NDArray[Any]) -> list[str]:
    """Round weights to decimals whose sum is 1."""
    whole = [round(float(w) * 10**9) for w in weights]
    whole[int(np.argmax(weights))] += 10**9 - sum(whole)
    return [decimal(w / 10**9) for w in whole]


# --- places of two hulls that are too near --------------------------------------------------------
# Two parts with an inside overlap most where the sum of the distances to their edges is largest: a
# disc about that place lies in both parts, and both radii count. Elsewhere the nearest places show
# most. Rows are computed together.


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


def contacts(arm: BoundedArm, kind: Kind, rows: Ints, cells: Cells) -> Contacts:
    """Return the places that best show that things are violated at the middles of cells."""
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
    near, far = (_as_means(hull, best) for hull in hulls)
    return rounded(kind, rows, near, far)


def rounded(kind: Kind, rows: Ints, near: Floats, far: Floats) -> Contacts:
    """Round weights to the written decimals, and find the largest discs about their places."""
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
    arm: BoundedArm,
    kind: Kind,
    rows: Ints,
    cells: Cells,
    contacts: Contacts,
    free: Sequence[bool] | None = None,
) -> Floats:
    """Return by how much the second inequality holds on cells, shape (T,)."""
    far = np.einsum("tc,tcx->tx", contacts.far, kind.corners[rows])[:, None]
    seen = arm.seen(kind, rows, cells, far, free)
    steps = cells.steps
    moved = seen.r + np.einsum("tkj,tjx->tkx", steps, seen.slopes[:, :, 0])
    if kind.normals is not None:
        largest = np.einsum("tkx,tx->tk", moved, kind.normals[rows]).max(axis=1)
    else:
        near = np.einsum("tm,tmx->tx", contacts.near, seen.places)
        largest = np.linalg.norm(moved - near[:, None], axis=2).max(axis=1)
    discs = contacts.inside.sum(axis=1)
    allowed = seen.distances + discs - np.where(discs > 0, NEARLY * arm.size, 0)
    return np.asarray(allowed - largest - seen.bend[:, 0] - seen.spread[:, 0])


# --- places of the plane --------------------------------------------------------------------------


def _deepest(near: Floats, far: Floats) -> Floats:
    """Return the places where the sum of the depths in both hulls is largest, shape (T, 2).

    The sum is concave, so a search finds its maximum on the hull with fewer corners: on a segment
    by sampling, on an outline by steps that shrink.
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
        turn = np.array([[np.cos(k), -np.sin(k)], [np.sin(k), np.cos(k)]])  # others each round
        tries = best[:, None] + size[:, None, None] * 0.75**k * (ways @ turn)
        best = tries[rows, (_depth(one, tries) + _depth(other, tries)).argmax(axis=1)]
    return np.asarray(best)


def _to_edges(hull: Floats, places: Floats) -> tuple[Floats, Floats, Floats]:
    """Compare places, shape (T, k, 2), with the edges of hulls: three arrays (T, k, edges).

    The arrays are: the position of the nearest point along the edge, from 0 to 1; its distance from
    the place; and a number that is positive if the place lies on the left of the edge.
    """
    step = (np.roll(hull, -1, axis=1) - hull)[:, None]
    square = (step**2).sum(axis=-1)
    off = places[:, :, None] - hull[:, None]
    part = np.clip((off * step).sum(axis=-1) / np.where(square > 0, square, 1), 0, 1)
    distance: Floats = np.linalg.norm(off - part[..., None] * step, axis=-1)
    return part, distance, cross(step, off)


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


def _as_means(hull: Floats, places: Floats) -> Floats:
    """Return weights of corners: the place of each hull nearest to a place (T, 2), as a mean."""
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
    whole = cross(b - a, c - a)
    safe = np.where(whole == 0, 1, whole)
    v, w = (cross(places[:, None] - a, c - a) / safe, cross(b - a, places[:, None] - a) / safe)
    fan = np.stack([1 - v - w, v, w], axis=-1)
    fan[whole == 0] = -np.inf
    best = fan.min(axis=-1).argmax(axis=1)
    own = np.maximum(fan[rows, best], 0)
    own /= own.sum(axis=1, keepdims=True)
    filled = np.zeros_like(weights)
    for k, corner in enumerate((np.zeros_like(best), best + 1, best + 2)):
        np.add.at(filled, (rows, corner), own[:, k])
    return np.where(inside[:, None], filled, weights)
