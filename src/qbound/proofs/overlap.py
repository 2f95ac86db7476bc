"""Where two bodies are too near: a place of each that shows it, for a witness (untrusted)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.proofs.features import Core, FlatArm

Floats = NDArray[np.float64]


def shown_places(arm: FlatArm, one: Core, other: Core, q: Floats) -> tuple[Floats, Floats]:
    """Return weights of the corners of either core: of a common place, or of the nearest two.

    Parameters
    ----------
    q : ndarray, shape (n,)
        Rad or length.
    """
    near = min(one.frame, other.frame)
    placed = [
        [_value(arm, arm.carried(near, core.frame, z), q) for z in core.corners]
        for core in (one, other)
    ]
    p, r = _common(*placed) or _nearest(*placed)
    return weights_of(placed[0], p), weights_of(placed[1], r)


def _value(arm: FlatArm, waves: dict[Any, complex], q: Floats) -> complex:
    turning = np.array([joint.turns for joint in arm.robot.joints])
    total = 0j
    for key, amplitude in waves.items():
        k = np.array(key)
        factor = np.exp(1j * (k[turning] @ q[turning])) * np.prod(q[~turning] ** k[~turning])
        total += amplitude * complex(factor)
    return total


def _cross(u: complex, v: complex) -> float:
    return (u.conjugate() * v).imag


def _common(one: Sequence[complex], other: Sequence[complex]) -> tuple[complex, complex] | None:
    """Return a place well inside both cores, if one is an outline and they overlap."""
    if len(other) < 3:
        one, other = other, one
    if len(other) < 3:
        return None
    left = list(one)
    area = sum(_cross(a - other[0], b - other[0]) for a, b in zip(other, _next(other), strict=True))
    for a, b in zip(other, _next(other), strict=True):
        left = _clipped(left, a, (b - a) * np.sign(area))
    if not left:
        return None
    middle = sum(left) / len(left)
    return middle, middle


def _next(corners: Sequence[complex]) -> list[complex]:
    return [*corners[1:], *corners[:1]]


def _clipped(corners: Sequence[complex], a: complex, along: complex) -> list[complex]:
    """Keep what lies on the left of a line (Sutherland and Hodgman)."""
    found = []
    for p, r in zip(corners, _next(corners), strict=True):
        here, there = _cross(along, p - a), _cross(along, r - a)
        if here >= 0:
            found.append(p)
        if here * there < 0:
            found.append(p + (r - p) * here / (here - there))
    return found


def _nearest(one: Sequence[complex], other: Sequence[complex]) -> tuple[complex, complex]:
    """Return the nearest two places of two cores that do not overlap, or of crossing segments."""
    found = []
    for p, (a, b) in product(one, zip(other, _next(other), strict=True)):
        found.append((p, _on(p, a, b)))
    for r, (a, b) in product(other, zip(one, _next(one), strict=True)):
        found.append((_on(r, a, b), r))
    if len(one) == len(other) == 2:
        found += _crossing(one, other)
    return min(found, key=lambda pair: abs(pair[0] - pair[1]))


def _on(p: complex, a: complex, b: complex) -> complex:
    """Return the place of a segment that is nearest to another."""
    step = b - a
    if not step:
        return a
    return a + step * min(max(((p - a) * step.conjugate()).real / abs(step) ** 2, 0.0), 1.0)


def _crossing(one: Sequence[complex], other: Sequence[complex]) -> list[tuple[complex, complex]]:
    (a, b), (c, d) = one, other
    if not (across := _cross(b - a, d - c)):
        return []
    s, t = _cross(c - a, d - c) / across, _cross(c - a, b - a) / across
    return [(a + s * (b - a),) * 2] if 0 <= s <= 1 and 0 <= t <= 1 else []


def weights_of(corners: Sequence[complex], place: complex) -> Floats:
    """Write a place of a convex core as a mean of its corners."""
    n = len(corners)
    triangles: list[tuple[int, ...]] = [(0, k, k + 1) for k in range(1, n - 1)]
    triangles = triangles or [tuple(range(n))]
    best, found = np.inf, np.zeros(n)
    for triangle in triangles:
        own = np.array([corners[k] for k in triangle])
        system = np.array([own.real, own.imag, np.ones(len(own))])
        weights = np.maximum(
            np.linalg.lstsq(system, [place.real, place.imag, 1.0], rcond=None)[0], 0
        )
        weights /= weights.sum()
        if (off := abs(weights @ own - place)) < best:
            best, found = off, np.zeros(n)
            found[list(triangle)] = weights
    return found
