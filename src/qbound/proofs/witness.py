"""Configurations that refute a statement: where a boundary or a limit is violated, and how deep.

Nothing here is trusted: the checkers look at the configuration that is written down.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from qbound.boundary.functions import clearance, margin_of
from qbound.extras import require
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import BodyPair, Boundary, Robot
from qbound.proofs import grammar_robot as exact
from qbound.proofs.cells import Box, Cell
from qbound.proofs.features import Features, FlatArm, Parts, all_features, is_of_bodies
from qbound.proofs.overlap import shown_places
from qbound.proofs.statements import Statement, decimal, units, wider

Floats = NDArray[np.float64]
Evidence = dict[str, Any]
"""The boundary, and the place: as a certificate writes them."""

SIDES = ("lower", "upper")


@dataclass(frozen=True, eq=False)
class Witness:
    """A configuration of the set, in the file's units, and what it violates by how much.

    The depth is a length for a boundary, in the joint's unit of the file for a limit.
    """

    boundary: str
    q: tuple[float, ...]
    depth: float


def beyond_limits(
    robot: exact.Robot, statement: Statement, cells: Sequence[Cell]
) -> Evidence | None:
    """Return the corner that is farthest beyond a limit of a joint, if any: exact."""
    depths = [
        (sign * (end - q[j]), f"{joint.name}.{side}", i, k)
        for j, joint in enumerate(robot.joints)
        for side, sign, end in zip(SIDES, (1, -1), joint.limits or (), strict=False)
        for i, cell in enumerate(cells)
        for k, q in enumerate(cell.corners)
    ]
    depth, name, i, k = max(depths, key=lambda row: row[0], default=(Fraction(0), "", 0, 0))
    if depth <= 0:
        return None
    if isinstance(cells[i], Box):
        return {"boundary": name, "at": statement["points"][0][k]}
    weights = ["1" if c == k else "0" for c in range(len(cells[i].corners))]
    return {"boundary": name, "cell": i, "weights": weights}


def deepest(
    robot: Robot,
    statement: Statement,
    cells: Sequence[Cell],
    violated: Mapping[str, tuple[int, Floats]],
    parts: Parts | None = None,
) -> Evidence:
    """Follow each violated boundary to where it is violated most, and return the deepest.

    Parameters
    ----------
    violated : mapping of str to (int, ndarray)
        A cell, and a configuration in it (rad or length) that violates the boundary.
    parts : mapping, optional
        Of a robot with pairs of bodies, from `features.parts_of`.
    """
    asked, scale = wider(robot, statement), units(robot)
    corners = np.array([cell.corners for cell in cells], dtype=float) * scale
    found = []
    for name, (start, q) in violated.items():
        margin = margin_function(asked, asked.boundary(name), parts)
        if isinstance(cells[0], Box):
            lowest = margin.lowest_in_box(corners[0, 0], corners[0, 1], q)
            place: Evidence = {"at": _within(statement["points"][0], lowest / scale)}
        else:
            cell, weights = _lowest(margin.value, corners, start, q)
            lowest = weights @ corners[cell]
            place = {"cell": cell, "weights": _decimals(weights)}
        found.append((margin.depth(lowest), {"boundary": name, **place, **margin.shown(lowest)}))
    return max(found, key=lambda row: row[0])[1]


class MarginFunction(Protocol):
    """What a boundary looks like from a configuration that may violate it; rad and lengths."""

    def value(self, q: Floats) -> Floats:
        """Return a number that is negative where it is violated, shape (...)."""

    def lowest_in_box(self, low: Floats, high: Floats, q: Floats) -> Floats:
        """Return the configuration of a box where it is violated most; q is one that violates."""

    def depth(self, q: Floats) -> float:
        """Return by how much it is violated, length."""

    def shown(self, q: Floats) -> Evidence:
        """Return what a certificate says beside the configuration."""


def margin_function(robot: Robot, boundary: Boundary, parts: Parts | None) -> MarginFunction:
    """Return the margin function of a boundary."""
    if is_of_bodies(boundary):
        return _OfBodies(robot, boundary, parts or {})
    return _OfPoints(robot, boundary, clearance(robot, boundary))


@dataclass(frozen=True, eq=False)
class _OfPoints:
    """One form."""

    robot: Robot
    boundary: Boundary
    form: HarmonicForm

    def value(self, q: Floats) -> Floats:
        return self.form(q)

    def lowest_in_box(self, low: Floats, high: Floats, q: Floats) -> Floats:
        return _lowest_in_box(self.form, low, high, q)

    def depth(self, q: Floats) -> float:
        return _depth(self.robot, self.boundary.name, float(self.form(q)))

    def shown(self, q: Floats) -> Evidence:
        del q
        return {}


@dataclass(frozen=True, eq=False)
class _OfBodies:
    """The least margin of all pairs of parts."""

    robot: Robot
    boundary: Boundary
    parts: Parts

    @cached_property
    def features(self) -> list[Features]:
        return all_features(self.robot, self.boundary, self.parts)

    def value(self, q: Floats) -> Floats:
        return np.asarray(np.min([pair.margins(q) for pair in self.features], axis=0))

    def lowest_in_box(self, low: Floats, high: Floats, q: Floats) -> Floats:
        """Search around the lowest place so far, in boxes that shrink."""
        rng = np.random.default_rng(0)
        for size in 0.75 ** np.arange(80):
            step = size * (high - low) * rng.uniform(-0.5, 0.5, (40, len(q)))
            tries = np.concatenate([q[None], np.clip(q + step, low, high)])
            q = tries[int(self.value(tries).argmin())]
        return q

    def depth(self, q: Floats) -> float:
        return -float(self.value(q))

    def shown(self, q: Floats) -> Evidence:
        """Name the two parts that are nearest to each other, and a place of each."""
        if not isinstance(self.boundary, BodyPair):
            return {}
        arm, names = FlatArm(self.robot), self.boundary.bodies
        cores = [arm.cores(name, self.parts) for name in names]
        worst = int(np.argmin([pair.margins(q) for pair in self.features]))
        numbers = divmod(worst, len(cores[1]))
        one, other = (own[k] for own, k in zip(cores, numbers, strict=True))
        places = shown_places(arm, one, other, q)
        rows = zip(numbers, places, strict=True)
        return {"places": [{"part": k, "weights": _decimals(w)} for k, w in rows]}


def witness(
    robot: Robot,
    statement: Statement,
    cells: Sequence[Cell],
    evidence: Evidence,
    parts: Parts | None = None,
) -> Witness:
    """Read the configuration and its depth out of what the file says."""
    if "at" in evidence:
        q = np.array(evidence["at"], dtype=float)
    else:
        corners = np.array(cells[evidence["cell"]].corners, dtype=float)
        q = np.array(evidence["weights"], dtype=float) @ corners
    name, asked = evidence["boundary"], wider(robot, statement)
    boundary = next((b for b in asked.used if b.name == name), None)
    if boundary is not None:
        margin = margin_function(asked, boundary, parts)
        return Witness(name, tuple(q.tolist()), margin.depth(q * units(robot)))
    joint, _, side = name.rpartition(".")
    j = [other.name for other in robot.joints].index(joint)
    limits = robot.joints[j].limits or (q[j], q[j])
    end = limits[side == "upper"] / units(robot)[j]
    return Witness(name, tuple(q.tolist()), abs(float(q[j] - end)))


def _lowest_in_box(form: HarmonicForm, low: Floats, high: Floats, q: Floats) -> Floats:
    """Return the configuration of a box where a form is lowest, by a descent from two places."""
    require("scipy")
    from scipy.optimize import minimize

    bounds, found = list(zip(low, high, strict=True)), [q]
    for start in (q, (low + high) / 2):
        end = minimize(form, start, jac=form.gradient, bounds=bounds, method="L-BFGS-B").x
        found.append(np.clip(end, low, high))
    return min(found, key=lambda place: float(form(place)))


def _within(ends: Sequence[Sequence[str]], q: Floats) -> list[str]:
    """Write a configuration in decimals that lie within a box, whose ends are decimals."""
    rows = zip(map(float, q), *ends, strict=True)
    return [sorted((decimal(x), low, high), key=Fraction)[1] for x, low, high in rows]


def _depth(robot: Robot, name: str, value: float) -> float:
    """How far a boundary is violated, length."""
    return -float(margin_of(robot, robot.boundary(name), value))


def _lowest(
    form: Callable[[Floats], Floats], cells: Floats, cell: int, q: Floats
) -> tuple[int, Floats]:
    """Return the cell, and the weights of its corners, where a form is lowest, by a local search.

    In each cell a copy of it shrinks around the lowest of its corners, middles and centre so far;
    the search starts at the centres and, in one cell, at a configuration that is known to be low.
    """
    count, k = cells.shape[:2]
    i, j = np.triu_indices(k, 1)
    tries = np.concatenate([np.eye(k), (np.eye(k)[i] + np.eye(k)[j]) / 2, np.full((1, k), 1 / k)])
    lowest, rows = np.full((count, k), 1 / k), np.arange(count)
    lowest[cell] = _weights(cells[cell], q)
    for size in 0.75 ** np.arange(80):
        near = (1 - size) * lowest[:, None] + size * tries
        around = np.concatenate([lowest[:, None], near], axis=1)
        lowest = around[rows, form(around @ cells).argmin(axis=1)]
    best = int(form(np.einsum("nk,nkj->nj", lowest, cells)).argmin())
    return best, lowest[best]


def _weights(cell: Floats, q: Floats) -> Floats:
    """Write a configuration of a cell as a mean of its corners."""
    system = np.vstack([cell.T, np.ones(len(cell))])
    weights = np.linalg.lstsq(system, np.append(q, 1), rcond=None)[0]
    weights = np.maximum(weights, 0)
    return np.asarray(weights / weights.sum())


def _decimals(weights: Floats) -> list[str]:
    """Round weights to decimals whose sum is 1."""
    whole = [round(float(w) * 10**9) for w in weights]
    whole[int(np.argmax(weights))] += 10**9 - sum(whole)
    return [f"{w // 10**9}.{w % 10**9:09}" for w in whole]
