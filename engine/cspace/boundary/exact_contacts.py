"""Contact features in exact numbers, one at a time; `contacts` has the same features in floats.

A form and its side conditions are those of the same row of `Contacts` times a positive number: no
edge is brought to length 1, so that whole numbers stay rational. Vectors of the plane of motion are
pairs (x, y), in axes of any length (`poses.Axes`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from cspace.arrays import Array, cross
from cspace.boundary.contacts import Contacts, anticlockwise, edge_and_corner, two_corners
from cspace.boundary.poses import Axes, Move, Pose, Vector, bounded_bodies
from cspace.forms.harmonic import add_constant
from cspace.model.exact import ExactNumbers, rational, rationals, root, sine_cosine, written_numbers
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot, Step
from cspace.tolerances import ROUNDING, ZERO_AMPLITUDE


@dataclass(frozen=True)
class PlaneAxes(Axes):
    r"""Axes of the plane of motion, turned as those of `Robot.plane` are.

    Attributes
    ----------
    first, second : ndarray, shape (3,)
        Seen from the base; the second is the product of the normal and the first.
    """

    first: Any = None
    second: Any = None

    @classmethod
    def across(cls, normal: Array) -> PlaneAxes:
        """Return axes at right angles to a normal of any length."""
        base = rationals(np.eye(3, dtype=int)[int(np.argmin(np.abs(normal.astype(float))))])
        first, square = cross(base, normal), normal @ normal
        return cls(first @ first, square, root(square), first, cross(normal, first))

    def flat(self, vector: Array) -> Vector:
        """Return the plane's coordinates of a vector of the base, shape (3,)."""
        return self.first @ vector / self.size, self.second @ vector / (self.size * self.ratio)


class ExactChain:
    """The chain of a robot with exact numbers in its plane of motion; frames by the steps to them.

    Parameters
    ----------
    steps : sequence of Step
    axes : PlaneAxes
        Of the plane.
    senses : sequence of int
        +1 or -1 for a turn, from the first axis to the second or back; 0 for a slide.
    free : sequence of int
        Joints that are not held.
    held : mapping of int to number
        Values of the others, exact or balls.
    """

    def __init__(
        self,
        steps: Sequence[Step],
        axes: PlaneAxes,
        senses: Sequence[int],
        free: Sequence[int],
        held: Mapping[int, Any],
    ) -> None:
        self.axes, self._steps, self._senses = axes, steps, senses
        self._free, self._held, self._mounts = free, held, mounts(steps)
        self._poses: dict[tuple[int, int], Pose] = {}

    def flat(self, k: int, place: Array) -> Vector:
        """Return a place of a frame in the axes of the plane, turned as at all joint values 0."""
        return self.axes.flat(self._mounts[k] @ place)

    def pose(self, near: int, far: int) -> Pose:
        """Return the pose of a frame seen from one before it."""
        if (near, far) not in self._poses:
            none = np.full((3,) * len(self._free), rational(0), dtype=object)
            moves = [self._move(k) for k in range(near, far)]
            self._poses[near, far] = Pose.after(moves, self.axes, none)
        return self._poses[near, far]

    def _move(self, k: int) -> Move:
        """Return a step as it moves in the plane."""
        step, sense = self._steps[k], self._senses[k]
        origin = self.flat(k, step.origin)
        along = self.flat(k + 1, step.axis * step.sense / _length(step.axis))
        if step.joint in self._free:
            return Move(origin, sense, along, self._free.index(step.joint))
        value = self._held[step.joint]
        if not sense:
            return Move(origin, sense, along, None, (value,))
        sine, cosine = sine_cosine(value)
        return Move(origin, sense, along, None, (cosine, sine / self.axes.stretch))


def mounts(steps: Sequence[Step]) -> list[Array]:
    """Return the rotation of each frame at all joint values 0, seen from the base."""
    found = [rationals(np.eye(3, dtype=int))]
    for step in steps:
        found.append(found[-1] @ step.mount)
    return found


class ExactCore(NamedTuple):
    """A convex core in its frame: corners as `contacts.Core` numbers them, and its radius."""

    corners: list[Vector]
    radius: Any

    @property
    def edges(self) -> int:
        """Number of edges; a segment has one on either side."""
        return len(self.corners) if len(self.corners) > 1 else 0

    def step(self, k: int) -> Vector:
        """Return the vector from corner k to the next."""
        here, there = self.corners[k], self.corners[(k + 1) % len(self.corners)]
        return there[0] - here[0], there[1] - here[1]

    def around(self, k: int) -> list[Vector]:
        """Return the vectors from corner k to its neighbours: the next, and the one before."""
        if not self.edges:
            return []
        x, y = self.step(k - 1)
        return [self.step(k), (-x, -y)]


Feature = tuple[Array, Array]
"""A form (3, 3), and its side conditions (s, 3, 3)."""


class ExactContacts:
    """The features of a robot's bodies by their rows, made one at a time.

    The cores of each body are kept, and so is what makes the features of each pair of parts.
    Numbers that are not rational are balls of the precision that is set.

    Parameters
    ----------
    robot : Robot
    held : mapping of int to float
        Values of all joints but two, by index; each counts as the binary fraction that it is.
    boundaries : sequence of Boundary
        The boundaries about bodies.
    contacts : Contacts
        Their features in floats.
    """

    def __init__(
        self,
        robot: Robot,
        held: Mapping[int, float],
        boundaries: Sequence[Boundary],
        contacts: Contacts,
    ) -> None:
        self._robot, self._held, self._contacts = robot, held, contacts
        self._boundaries = {boundary.name: boundary for boundary in boundaries}
        self._cores: dict[str, list[ExactCore]] = {}
        self._pairs: dict[int, tuple[int, Callable[[int], Feature]]] = {}

    def feature(self, k: int) -> Feature:
        """Return form and side conditions of a row of the contacts."""
        form, sides = self._unscaled(k)
        if self._chain.axes.stretch == 1:
            return form, sides
        joints = [self._robot.joints[j] for j in self._robot.free(self._held)]
        one = rational(1)
        factors = [
            np.array([one, one, one / self._chain.axes.stretch if joint.turns else one])
            for joint in joints
        ]
        factor = np.multiply.outer(*factors)
        return form * factor, sides * factor

    def _unscaled(self, k: int) -> Feature:
        """Return a row with the coefficients of sines divided by the stretch."""
        pair = int(self._contacts.pair[k])
        if pair not in self._pairs:
            self._pairs[pair] = self._pair(pair)
        first, make = self._pairs[pair]
        return make(k - first)

    def _pair(self, pair: int) -> tuple[int, Callable[[int], Feature]]:
        """Return the first row of a pair of convex parts, and a function that makes a feature."""
        first = int(np.searchsorted(self._contacts.pair, pair))
        name = self._contacts.boundaries[pair]
        boundary = self._boundaries[name]
        part = pair - self._contacts.boundaries.index(name)
        if isinstance(boundary, HalfSpace):
            return first, lambda _: self._height(boundary, part)
        assert isinstance(boundary, BodyPair)  # only boundaries about bodies have features
        bodies = sorted(
            bounded_bodies(self._robot, boundary), key=lambda b: self._robot.steps_to(b.frame)
        )
        near, far = (self._cores_of(body) for body in bodies)
        one, other = near[part // len(far)], far[part % len(far)]
        moved = self._chain.pose(*(self._robot.steps_to(body.frame) for body in bodies))
        keep = one.radius + other.radius + self._clearance(boundary)
        return first, partial(_feature, one, other, moved, keep)

    def _clearance(self, boundary: BodyPair) -> Any:
        exact: Any = self._numbers.boundary(boundary)
        return exact.clearance

    def _height(self, wall: HalfSpace, corner: int) -> Feature:
        """Return a corner of a body above a half-space: ``normal . r >= level``."""
        (body,) = bounded_bodies(self._robot, wall)
        exact: Any = self._numbers.boundary(wall)
        moved = self._chain.pose(0, self._robot.steps_to(body.frame))
        cores = self._cores_of(body)
        at, radius = [(c, core.radius) for core in cores for c in core.corners][corner]
        level = (exact.offset + radius) * _length(exact.normal)
        form = add_constant(
            moved.axes.dot(self._chain.flat(0, exact.normal), moved.seen(at)), -level
        )
        return form, np.empty((0, 3, 3), dtype=object)

    @cached_property
    def _numbers(self) -> ExactNumbers:
        return written_numbers(self._robot, unit=False)

    @cached_property
    def _steps(self) -> list[Step]:
        """The steps of the chain with exact numbers."""
        joints = map(self._numbers.joint, self._robot.joints)
        return [step for j, joint in enumerate(joints) for step in joint.steps(j)]

    @cached_property
    def _chain(self) -> ExactChain:
        """The chain in axes of the plane, turned as those of the robot's plane in floats."""
        plane, free = self._robot.plane, self._robot.free(self._held)
        normal = self._normal()
        way = np.sign(normal.astype(float) @ cross(*plane.across))
        axes = PlaneAxes.across(normal * rational(int(way)))
        held = {j: rational(value) for j, value in self._held.items()}
        return ExactChain(self._steps, axes, plane.senses, free, held)

    def _normal(self) -> Array:
        """Return a normal of the plane, of any length, chosen as `plane_of_motion` does."""
        turned = zip(mounts(self._steps)[1:], self._steps, strict=True)
        axes = [mount @ step.axis for mount, step in turned]
        turning = [axis for axis, step in zip(axes, self._steps, strict=True) if not step.slides]
        if turning:
            return np.asarray(turning[0])
        for axis in axes[1:]:
            normal = cross(axes[0], axis)
            sizes = (axes[0] @ axes[0]) * (axis @ axis)
            if float(normal @ normal) > ZERO_AMPLITUDE**2 * float(sizes):
                return normal
        return rationals(self._robot.plane.normal)

    def _cores_of(self, body: Body) -> list[ExactCore]:
        """Return the convex cores of a body."""
        if body.name not in self._cores:
            shape = self._numbers.body(body).shape
            radius = getattr(shape, "radius", rational(0))
            frame = self._robot.steps_to(body.frame)
            at = [self._chain.flat(frame, place) for place in shape.places]
            cores = []
            for loop in body.shape.loops:
                corners = [at[k] for k in loop]
                order = anticlockwise(np.array(corners, dtype=object))
                cores.append(ExactCore([corners[k] for k in order], radius))
            self._cores[body.name] = cores
        return self._cores[body.name]


# --- one feature ----------------------------------------------------------------------------------


def _feature(one: ExactCore, other: ExactCore, moved: Pose, keep: Any, row: int) -> Feature:
    """Return a row of `contacts.features`: edges of one, edges of the other, pairs of corners."""
    m, n = len(one.corners), len(other.corners)
    if row < one.edges * n:
        edge, corner = divmod(row, n)
        rims = [moved.turned(step) for step in other.around(corner)]
        return _on_edge(moved, one, edge, moved.seen(other.corners[corner]), rims, keep)
    row -= one.edges * n
    if row < other.edges * m:
        edge, corner = divmod(row, m)
        rims = [moved.turned_back(step) for step in one.around(corner)]
        return _on_edge(moved, other, edge, moved.seen_back(one.corners[corner]), rims, keep)
    i, k = divmod(row - other.edges * m, n)
    p, u = one.corners[i], other.corners[k]
    form, sides = two_corners(moved, p, u, one.around(i), other.around(k), keep)
    return form, _stacked(sides)


def _on_edge(
    moved: Pose, core: ExactCore, edge: int, seen: Vector, rims: Sequence[Vector], keep: Any
) -> Feature:
    """Return a corner, seen from a core's frame, on one of its edges."""
    axes, along = moved.axes, core.step(edge)
    reach = axes.dot(along, along)
    kept = keep * root(reach) / axes.stretch if keep != 0 else keep
    form, sides = edge_and_corner(axes, along, core.corners[edge], reach, seen, rims, kept)
    return form, _stacked(sides)


def _length(direction: Array) -> Any:
    """Return the length of a direction; exactly 1 for a unit vector up to rounding."""
    square = direction @ direction
    return rational(1) if abs(float(square) - 1) <= ROUNDING else root(square)


def _stacked(sides: Sequence[Array]) -> Array:
    return np.array(sides, dtype=object).reshape(-1, 3, 3)
