"""Configurations that refute a statement: where a thing or a limit is violated, and how deep.

Nothing here is trusted: the checkers look at the configuration that is written down.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.proofs.certificates.contact import Contacts, contacts
from qbound.proofs.certificates.inequality import Arm
from qbound.proofs.certificates.search import margins
from qbound.proofs.certificates.statements import Statement, corners_of, decimal
from qbound.proofs.subdivide import Boxes, Simplices

Evidence = dict[str, Any]
"""The witness as a certificate writes it."""

SIDES = ("lower", "upper")

SHRINK = 0.75 ** np.arange(80)
"""Sizes of the neighbourhoods in which the deepest configuration is looked for."""

CELLS = 50
"""Cells in which it is looked for: those that are deepest in the middle."""


@dataclass(frozen=True, eq=False)
class Witness:
    """A configuration of the set, in the file's units, and what it violates by how much.

    The depth is a length for a boundary, in the joint's unit of the file for a limit.
    """

    boundary: str
    q: tuple[float, ...]
    depth: float


def cells_of(arm: Arm, statement: Statement) -> Boxes | Simplices:
    """Return the cells of a statement, rad or length."""
    corners = np.array(corners_of(statement), dtype=float) * arm.units
    if statement["set"] == "box":
        return Boxes.between(corners[:, 0], corners[:, 1])
    return Simplices(corners)


def beyond_limits(arm: Arm, statement: Statement) -> Evidence | None:
    """Return the corner that is farthest beyond a limit of a joint, if any: exact."""
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


def deepest(arm: Arm, statement: Statement, violated: Mapping[int, tuple[int, Floats]]) -> Evidence:
    """Follow each violated boundary to where it is violated most, and return the deepest.

    Parameters
    ----------
    violated : mapping of int to (int, ndarray)
        By the number of a thing a cell, and a configuration in it that violates the thing.
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
            lowest = _lowest_in_box(least, cells.low[0], cells.high[0], q)
            written = _within(statement["points"][0], lowest / arm.units)
            at: Evidence = {"at": written}
        else:
            cell, weights = _lowest(least, cells.corners, start, q)
            lowest = weights @ cells.corners[cell]
            at = {"cell": cell, "weights": _decimals(weights)}
        own = margins(arm, things, lowest[None])[0]
        thing = things[int(own.argmin())]
        found.append((float(own.min()), {**at, "place": _shown(arm, thing, lowest)}))
    return min(found, key=lambda row: row[0])[1]


def witness(arm: Arm, statement: Statement, evidence: Evidence) -> Witness:
    """Read the configuration and its depth out of what the file says."""
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


def place_of(arm: Arm, thing: int, found: Contacts) -> Evidence:
    """Write a place of the two hulls of a thing, the one row of `found`."""
    row, hulls = arm.form["keep"][thing], arm.form["hulls"]
    far = _folded(found.far[0], len(hulls[row["far"]]["corners"]))
    if "normal" in row:
        return {"keep": thing, "near": [], "far": _decimals(far)}
    near = _folded(found.near[0], len(hulls[row["near"]]["corners"]))
    written = {"keep": thing, "near": _decimals(near), "far": _decimals(far)}
    radii = [decimal(max(float(x) - 1e-12, 0)) for x in found.inside[0]]
    return written if radii == ["0", "0"] else {**written, "inside": radii}


def _shown(arm: Arm, thing: int, q: Floats) -> Evidence:
    """Return places of both hulls of a thing that show that it is violated."""
    kind, rows = arm.kinds[arm.kind_of[thing]], arm.row_of[[thing]]
    return place_of(arm, thing, contacts(arm, kind, rows, Boxes(q[None], np.zeros((1, len(q))))))


def _folded(weights: Floats, count: int) -> Floats:
    """Add the weights of padded corners to that of the corner which they repeat."""
    return np.append(weights[: count - 1], weights[count - 1 :].sum())


def _lowest_in_box(
    margin: Callable[[Floats], Floats], low: Floats, high: Floats, q: Floats
) -> Floats:
    """Search around the lowest configuration so far, in boxes that shrink."""
    rng = np.random.default_rng(0)
    for size in SHRINK:
        step = size * (high - low) * rng.uniform(-1, 1, (60, len(q)))
        tries = np.concatenate([q[None], np.clip(q + step, low, high)])
        q = tries[int(margin(tries).argmin())]
    return q


def _within(ends: Sequence[Sequence[str]], q: Floats) -> list[str]:
    """Write a configuration in decimals that lie within a box, whose ends are decimals."""
    rows = zip(map(float, q), *ends, strict=True)
    return [sorted((decimal(x), low, high), key=Fraction)[1] for x, low, high in rows]


def _lowest(
    margin: Callable[[Floats], Floats], cells: Floats, cell: int, q: Floats
) -> tuple[int, Floats]:
    """Return the cell, and the weights of its corners, where a margin is lowest: a local search.

    In each cell a copy of it shrinks around the lowest of its corners, middles and centre so far;
    the search starts at the centres and, in one cell, at a configuration that is known to be low.
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
