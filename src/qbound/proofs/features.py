"""What separates two convex cores, as harmonic forms in floats: for the search for a proof.

The features of two cores are numbered as the book's page "The certificate" does: the edges of one,
the edges of the other, then the pairs of corners. A feature separates the cores where all of its
forms are positive. Nothing here is trusted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, reduce
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.boundary.functions import position
from qbound.forms.harmonic import HarmonicForm, Kind
from qbound.model.boundaries import BodyPair, Boundary, HalfSpace
from qbound.model.robot import Robot
from qbound.model.shapes import Point
from qbound.proofs import grammar_robot, parts

Floats = NDArray[np.float64]
Key = tuple[int, ...]
"""For each joint the k of its factor: exp(i k q) where it turns, q to the k where it slides."""

Waves = dict[Key, complex]
"""A place of the plane, or a dot product: amplitudes by their keys."""

Parts = Mapping[str, Sequence[Sequence[int]]]
"""Corners of the convex parts of outlines, by the name of the body."""


@dataclass(frozen=True, eq=False)
class Features:
    """Forms, and which of them belong together.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
        Lengths, or squares of lengths less a square.
    groups : tuple of ndarray of int
        For each feature the forms that are positive where it separates.
    squared : ndarray, shape (m,)
        The length whose square was taken from a square; NaN for a form that is a length.
    edges : int
        So many features come first that are edges.
    gap : float or None
        The distance that two cores keep; None for a half-space, whose one feature has no number.
    """

    forms: HarmonicForm
    groups: tuple[NDArray[np.intp], ...]
    squared: Floats
    edges: int
    gap: float | None

    @property
    def numbered(self) -> bool:
        """Whether leaves name a feature."""
        return self.gap is not None

    @cached_property
    def sizes(self) -> Floats:
        """Sum of the amplitudes of each form, shape (m,): rounding is a small part of it."""
        return np.asarray(np.abs(self.forms.waves.amplitudes).sum(axis=-1))

    def lengths(self, q: Floats) -> Floats:
        """Return the least of each feature's forms as a length, shape (..., features)."""
        values = self.forms(q)
        distances = np.sqrt(np.maximum(values + np.nan_to_num(self.squared) ** 2, 0)) - self.squared
        values = np.where(np.isnan(self.squared), values, distances)
        return np.stack([values[..., group].min(axis=-1) for group in self.groups], axis=-1)

    def margins(self, q: Floats) -> Floats:
        """Return by how much the cores are apart beyond what is asked for; length, shape (...).

        Where they overlap it is, below 0, by how far they would have to move.
        """
        lengths = self.lengths(q)
        apart = lengths.max(axis=-1)
        if self.gap is None or not self.edges:
            return np.asarray(apart)
        beyond = lengths[..., : self.edges].max(axis=-1)
        return np.asarray(np.where(beyond < -self.gap, beyond, apart))


@dataclass(frozen=True, eq=False)
class Core:
    """A convex part of a body: corners in the plane at joint values 0, anticlockwise, complex."""

    frame: int
    corners: tuple[complex, ...]

    @property
    def normals(self) -> list[complex]:
        """Outward unit normals of the edges from each corner to the next; two of a segment."""
        if len(self.corners) == 1:
            return []
        steps = [b - a for a, b in zip(self.corners, _next(self.corners), strict=True)]
        sense = -1j if len(steps) == 2 or _area(self.corners) > 0 else 1j
        return [sense * step / abs(step) for step in steps]

    def around(self, i: int) -> list[complex]:
        """Return the directions from a corner to its neighbours."""
        n = len(self.corners)
        steps = [
            self.corners[k] - self.corners[i] for k in sorted({(i - 1) % n, (i + 1) % n} - {i})
        ]
        return [step / abs(step) for step in steps]


def _next(corners: Sequence[complex]) -> list[complex]:
    return [*corners[1:], corners[0]]


def _area(corners: Sequence[complex]) -> float:
    return sum((a.conjugate() * b).imag for a, b in zip(corners, _next(corners), strict=True))


class FlatArm:
    """An arm in its plane of motion: what each joint does to a complex number.

    Raises
    ------
    ValueError
        If it does not move in a plane.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot, self.plane = robot, robot.plane
        self.kinds = robot.kinds
        self.origins = [self._flat(j.parent, j.origin) for j in robot.joints]
        self.slides = [self._flat(j.frame, j.axis) for j in robot.joints]
        self.still: Key = (0,) * len(robot.joints)

    def _flat(self, frame: str, place: Any) -> complex:
        x, y = self.plane.flat(frame, np.asarray(place, dtype=float)[None])[0]
        return complex(x, y)

    def cores(self, name: str, cut: Parts) -> list[Core]:
        """Return the cores of a body."""
        body = self.robot.body(name)
        places = [complex(x, y) for x, y in self.plane.flat(body.frame, body.shape.places)]
        frame = self.robot.depth(body.frame)
        every = [range(len(places))]
        return [Core(frame, tuple(places[k] for k in part)) for part in cut.get(name, every)]

    def carried(self, near: int, frame: int, z: complex, *, direction: bool = False) -> Waves:
        """Return a place of a frame, or a direction, as it is seen from a frame before it."""
        found = {self.still: z}
        for j in reversed(range(near, frame)):
            if self.robot.joints[j].turns:
                found = {_with(key, j, self.plane.senses[j]): a for key, a in found.items()}
            elif not direction:
                found[_with(self.still, j, 1)] = self.slides[j]
            if not direction:
                found[self.still] = found.get(self.still, 0) + self.origins[j]
        return found

    def dot(self, u: Waves, v: Waves) -> Floats:
        """Return the coefficients of the dot product of two vectors."""
        total = np.zeros((3,) * len(self.kinds))
        for (one, x), (other, y) in product(u.items(), v.items()):
            key = tuple(
                b - a if kind == "revolute" else a + b
                for a, b, kind in zip(one, other, self.kinds, strict=True)
            )
            total += (x.conjugate() * y * _monomial(key, self.kinds)).real
        return total


def _with(key: Key, j: int, k: int) -> Key:
    return (*key[:j], k, *key[j + 1 :])


@lru_cache(maxsize=10_000)
def _monomial(key: Key, kinds: tuple[Kind, ...]) -> NDArray[np.complex128]:
    """Return the coefficients of a product of factors exp(i k q) and q to the k."""
    rows = [
        np.array([k == 0, k != 0, 1j * k]) if kind == "revolute" else np.eye(3)[k]
        for k, kind in zip(key, kinds, strict=True)
    ]
    return np.asarray(reduce(np.multiply.outer, rows), dtype=complex)


def _minus(u: Waves, v: Waves) -> Waves:
    return {key: u.get(key, 0) - v.get(key, 0) for key in {**u, **v}}


def features_of(arm: FlatArm, one: Core, other: Core, gap: float) -> Features:
    """Return the features of two cores that keep `gap` apart, in the order of their numbers."""
    near = min(one.frame, other.frame)
    places = {
        core: [arm.carried(near, core.frame, z) for z in core.corners] for core in (one, other)
    }
    rows: list[Floats] = []
    groups, squared = list[list[int]](), list[float]()

    def add(forms: Sequence[Floats], lengths: Sequence[float]) -> None:
        groups.append([*range(len(rows), len(rows) + len(forms))])
        rows.extend(forms)
        squared.extend(lengths)

    for core, far in ((one, other), (other, one)):
        for normal, a in zip(core.normals, places[core], strict=False):
            n = arm.carried(near, core.frame, normal, direction=True)
            forms = [_shifted(arm.dot(n, _minus(p, a)), -gap) for p in places[far]]
            add(forms, [np.nan] * len(forms))
    edges = len(groups)
    for (i, p), (j, r) in product(enumerate(places[one]), enumerate(places[other])):
        step = _minus(r, p)
        ahead = [
            sign * arm.dot(arm.carried(near, core.frame, e, direction=True), step)
            for core, k, sign in ((one, i, -1), (other, j, 1))
            for e in core.around(k)
        ]
        square = _shifted(arm.dot(step, step), -(gap**2))
        add([square, *ahead], [gap, *[np.nan] * len(ahead)])
    stack = HarmonicForm(np.array(rows), arm.kinds)
    return Features(stack, tuple(map(np.array, groups)), np.array(squared), edges, gap)


def _shifted(coefficients: Floats, constant: float) -> Floats:
    coefficients[(0,) * coefficients.ndim] += constant
    return coefficients


def half_space_features(robot: Robot, boundary: HalfSpace) -> Features:
    """Return the heights of all places of a body over a plane: one feature without a number."""
    body = robot.body(str(boundary.body))
    radius = max(part.radius for part in body.parts)
    rows = []
    for place in body.shape.places:
        point = Point("\0", body.frame, place)
        height = position(_with_point(robot, point), point.name).dot(boundary.normal)
        rows.append((height - (boundary.offset + radius)).coefficients)
    forms = HarmonicForm(np.array(rows), robot.kinds)
    every = np.arange(len(rows))
    return Features(forms, (every,), np.full(len(rows), np.nan), 0, None)


def _with_point(robot: Robot, point: Point) -> Robot:
    return replace(robot, points=(*robot.points, point))


def asked_distance(robot: Robot, boundary: BodyPair) -> float:
    """Return the distance that the cores of two bodies keep: both radii and the clearance."""
    radii = (robot.body(name).parts[0].radius for name in boundary.bodies)
    return boundary.clearance + sum(radii)


def parts_of(robot: Robot, exact: grammar_robot.Robot) -> Parts | None:
    """Cut all outlines that boundaries keep apart into convex parts; None without pairs of bodies.

    Raises
    ------
    ValueError
        If an outline cannot be cut, or the robot has no plane of motion.
    """
    pairs = [b for b in exact.boundaries if b.used and b.apart]
    outlines = {body.name: body for b in pairs for body in b.bodies if len(body.places) > 2}
    if not pairs:
        return None
    frames = [robot.base, *(joint.frame for joint in robot.joints)]
    found = {}
    for name, body in outlines.items():
        own = robot.plane.flat_coordinate(frames[body.frame])
        if own is None:
            raise ValueError(f"{name}: its frame has no axis along that of the joints")
        rows = [p if len(p) == 2 else (*p[:own], *p[own + 1 :]) for p in body.places]
        found[name] = parts.cut(rows)
    return found


def is_of_bodies(boundary: Boundary) -> bool:
    """Tell whether a boundary is about whole bodies, and has no single form."""
    return isinstance(boundary, BodyPair) or getattr(boundary, "body", None) is not None


def all_features(robot: Robot, boundary: Boundary, cut: Parts) -> list[Features]:
    """Return the features of a boundary of bodies: for each pair of parts, in their order."""
    if isinstance(boundary, HalfSpace):
        return [half_space_features(robot, boundary)]
    arm = FlatArm(robot)
    assert isinstance(boundary, BodyPair)
    gap = asked_distance(robot, boundary)
    cores = [arm.cores(name, cut) for name in boundary.bodies]
    return [features_of(arm, one, other, gap) for one, other in product(*cores)]
