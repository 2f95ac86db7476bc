r"""Contact features with exact numbers, one at a time: what `contacts` has in floats.

A form and its side conditions are those of the same row of `Contacts` times a positive number: no
edge is brought to length 1, so that whole numbers stay rational. Vectors of the plane of motion are
(x, y) for :math:`x\,e_1 + y\,e_2`, where :math:`e_1` is any vector of the plane with rational
coordinates and :math:`e_2` is its product with the normal n, as that is written. A turn is
:math:`\cos q + \frac{\sin q}{|n|} K` with :math:`K (x, y) = (-|n|^2 y, x)`: tables hold the
coefficients of :math:`\sin q / |n|` until they are done, so that in a plane that is tilted what
is zero is so too, and no ball.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from qbound.arrays import Array
from qbound.boundary.contacts import Contacts, anticlockwise
from qbound.boundary.parts import bounded_bodies
from qbound.forms.factors import FACTORS
from qbound.forms.harmonic import Kind, times_function
from qbound.model.exact import ExactNumbers, rational, rationals, root, sine_cosine, written_numbers
from qbound.model.frames import cross
from qbound.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot, Step
from qbound.tolerances import ROUNDING, ZERO_AMPLITUDE

Vector = tuple[Any, Any]
"""A vector of the plane, of numbers or of tables (3, 3)."""


@dataclass(frozen=True)
class PlaneAxes:
    r"""Axes of the plane of motion, at right angles, turned as those of `Robot.plane` are.

    Attributes
    ----------
    first, second : ndarray, shape (3,)
        Seen from the base; the second is the product of the normal and the first.
    size : number
        Square of the first axis' length.
    ratio : number
        Square of the second axis' length beside it: that of the normal's.
    stretch : number
        Square root of the ratio, by which `quarter` makes a vector longer.
    """

    first: Array
    second: Array
    size: Any
    ratio: Any
    stretch: Any

    @classmethod
    def across(cls, normal: Array) -> PlaneAxes:
        """Return axes at right angles to a normal of any length."""
        base = rationals(np.eye(3, dtype=int)[int(np.argmin(np.abs(normal.astype(float))))])
        first, square = cross(base, normal), normal @ normal
        return cls(first, cross(normal, first), first @ first, square, root(square))

    def flat(self, vector: Array) -> Vector:
        """Return the plane's coordinates of a vector of the base, shape (3,)."""
        return self.first @ vector / self.size, self.second @ vector / (self.size * self.ratio)

    def dot(self, u: Vector, v: Vector) -> Any:
        """Return the scalar product."""
        return (u[0] * v[0] + u[1] * v[1] * self.ratio) * self.size

    def quarter(self, u: Vector) -> Vector:
        """Turn by a quarter turn, from the first axis to the second, and stretch."""
        return -(u[1] * self.ratio), u[0]

    def length(self, u: Vector) -> Any:
        """Return the length of a vector of numbers."""
        return root(self.dot(u, u))


@dataclass(frozen=True)
class ExactPose:
    """Where a frame stands, seen from another one, as tables (3, 3) of the two free joints.

    Attributes
    ----------
    turn : pair of tables
        Cosine and sine of the turn, the sine over the stretch.
    at : pair of tables
        The frame's origin, seen from the other frame.
    back : pair of tables
        The same vector seen from the frame itself.
    squared : table
        Its squared length.
    """

    axes: PlaneAxes
    turn: Vector
    at: Vector
    back: Vector
    squared: Array

    def turned(self, u: Vector) -> Vector:
        """Return a vector of the frame seen from the other one."""
        return self._rotate(u, self.turn)

    def turned_back(self, u: Vector) -> Vector:
        """Return a vector of the other frame seen from this one."""
        return self._rotate(u, (self.turn[0], -self.turn[1]))

    def _rotate(self, u: Vector, turn: Vector) -> Vector:
        c, s = turn
        v = self.axes.quarter(u)
        return c * u[0] + s * v[0], c * u[1] + s * v[1]

    def shifted(self, by: Vector) -> ExactPose:
        """Go on by a fixed vector, seen from the moved frame."""
        axes = self.axes
        return ExactPose(
            axes,
            self.turn,
            _sum(self.at, self.turned(by)),
            (_plus(self.back[0], by[0]), _plus(self.back[1], by[1])),
            _plus(self.squared + axes.dot(by, self.back) * 2, axes.dot(by, by)),
        )

    def rotated(self, c: Any, s: Any) -> ExactPose:
        """Turn by a fixed angle, given by its cosine and its sine over the stretch."""
        cosine, sine = self.turn
        u = self.back
        v = self.axes.quarter(u)
        turn = cosine * c - sine * s * self.axes.ratio, sine * c + cosine * s
        back = u[0] * c - v[0] * s, u[1] * c - v[1] * s
        return ExactPose(self.axes, turn, self.at, back, self.squared)

    def freely_turned(self, sense: int, joint: int, kind: Kind | None) -> ExactPose:
        """Turn by a free joint."""
        on = self.rotated(rational(0), rational(sense))
        turn, back = (
            tuple(
                self._times(one, joint, 1, kind) + self._times(other, joint, 2, kind)
                for one, other in zip(own, quarter, strict=True)
            )
            for own, quarter in ((self.turn, on.turn), (self.back, on.back))
        )
        return ExactPose(self.axes, (turn[0], turn[1]), self.at, (back[0], back[1]), self.squared)

    def freely_slid(self, along: Vector, joint: int, kind: Kind | None) -> ExactPose:
        """Go on along a free slide, by its value times a direction."""
        axes = self.axes
        x, y = self.turned(along)
        ahead = self._times(x, joint, 1, kind), self._times(y, joint, 1, kind)
        one, other = (self._times(_constant(length), joint, 1) for length in along)
        gain = self._times(axes.dot(along, self.back) * 2, joint, 1, kind)
        square = self._times(_constant(axes.dot(along, along)), joint, 2)
        at, back = _sum(self.at, ahead), _sum(self.back, (one, other))
        return ExactPose(axes, self.turn, at, back, self.squared + gain + square)

    def _times(self, table: Array, joint: int, k: int, kind: Kind | None = None) -> Array:
        """Multiply by the cosine of a joint, its sine over the stretch, its value or its square."""
        if kind is None or k == 1 or not FACTORS[kind].turns.any():
            return times_function(table, joint, k, kind)
        parts = np.moveaxis(table, joint, 0)  # the square of this sine has the ratio below it
        scaled = np.stack([parts[0], parts[1], parts[2] / self.axes.ratio])
        return times_function(np.moveaxis(scaled, 0, joint), joint, k, kind)

    @classmethod
    def still(cls, axes: PlaneAxes) -> ExactPose:
        """Return the pose of a frame seen from itself."""
        none, one = _constant(rational(0)), _constant(rational(1))
        return cls(axes, (one, none), (none, none), (none, none), none)


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

    Poses are kept by pairs of frames, cores by bodies. The precision of what is no rational is that
    at hand.

    Parameters
    ----------
    robot : Robot
    held : mapping of int to float
        Values of all joints but two, by index; each counts as the binary fraction that it is.
    boundaries : sequence of Boundary
        Those about bodies.
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
        self._poses: dict[tuple[int, int], ExactPose] = {}
        self._cores: dict[str, list[ExactCore]] = {}

    def feature(self, k: int) -> Feature:
        """Return form and side conditions of a row of the contacts."""
        form, sides = self._unscaled(k)
        if self._axes.stretch == 1:
            return form, sides
        joints = [self._robot.joints[j] for j in self._robot.free(self._held)]
        one = rational(1)
        factors = [
            np.array([one, one, one / self._axes.stretch if joint.turns else one])
            for joint in joints
        ]
        factor = np.multiply.outer(*factors)
        return form * factor, sides * factor

    def _unscaled(self, k: int) -> Feature:
        """Return a row with coefficients of sines over the stretch."""
        pair = int(self._contacts.pair[k])
        name = self._contacts.boundaries[pair]
        boundary = self._boundaries[name]
        part = pair - self._contacts.boundaries.index(name)
        if isinstance(boundary, HalfSpace):
            return self._height(boundary, part)
        assert isinstance(boundary, BodyPair)  # no other has features
        bodies = sorted(
            bounded_bodies(self._robot, boundary), key=lambda b: self._robot.steps_to(b.frame)
        )
        near, far = (self._cores_of(body) for body in bodies)
        one, other = near[part // len(far)], far[part % len(far)]
        moved = self._pose(*(self._robot.steps_to(body.frame) for body in bodies))
        keep = one.radius + other.radius + self._clearance(boundary)
        row = k - int(np.searchsorted(self._contacts.pair, pair))
        return _feature(one, other, moved, keep, row)

    def _clearance(self, boundary: BodyPair) -> Any:
        exact: Any = self._numbers.boundary(boundary)
        return exact.clearance

    def _height(self, wall: HalfSpace, corner: int) -> Feature:
        """Return a corner of a body above a half-space: ``normal . r >= level``."""
        (body,) = bounded_bodies(self._robot, wall)
        exact: Any = self._numbers.boundary(wall)
        axes, moved = self._axes, self._pose(0, self._robot.steps_to(body.frame))
        cores = self._cores_of(body)
        at, radius = [(c, core.radius) for core in cores for c in core.corners][corner]
        seen = _sum(moved.at, moved.turned(at))
        level = (exact.offset + radius) * _length(exact.normal)
        form = _plus(axes.dot(axes.flat(exact.normal), seen), -level)
        return form, np.empty((0, 3, 3), dtype=object)

    @cached_property
    def _numbers(self) -> ExactNumbers:
        return written_numbers(self._robot, unit=False)

    @cached_property
    def _mounts(self) -> list[Array]:
        """The rotation of each frame at all joint values 0, seen from the base, by steps to it."""
        found = [rationals(np.eye(3, dtype=int))]
        for step in self._steps:
            found.append(found[-1] @ step.mount)
        return found

    @cached_property
    def _steps(self) -> list[Step]:
        """The steps of the chain with exact numbers."""
        joints = map(self._numbers.joint, self._robot.joints)
        return [step for j, joint in enumerate(joints) for step in joint.steps(j)]

    @cached_property
    def _axes(self) -> PlaneAxes:
        """Axes of the plane, turned as those of the robot's plane in floats."""
        normal = self._normal()
        way = np.sign(normal.astype(float) @ cross(*self._robot.plane.across))
        return PlaneAxes.across(normal * rational(int(way)))

    def _normal(self) -> Array:
        """Return a normal of the plane, of any length, chosen as `plane_of_motion` does."""
        axes = [self._mounts[k + 1] @ step.axis for k, step in enumerate(self._steps)]
        turning = [axis for axis, step in zip(axes, self._steps, strict=True) if not step.slides]
        if turning:
            return np.asarray(turning[0])
        for axis in axes[1:]:
            normal = cross(axes[0], axis)
            sizes = (axes[0] @ axes[0]) * (axis @ axis)
            if float(normal @ normal) > ZERO_AMPLITUDE**2 * float(sizes):
                return normal
        return rationals(self._robot.plane.normal)

    def _pose(self, near: int, far: int) -> ExactPose:
        """Return the pose of a frame seen from one before it, by the steps to both."""
        if (near, far) not in self._poses:
            found, passed = ExactPose.still(self._axes), set[int]()
            for k in range(near, far):
                found = self._moved(found, k, passed)
                passed.add(self._steps[k].joint)
            self._poses[near, far] = found
        return self._poses[near, far]

    def _moved(self, found: ExactPose, k: int, passed: Collection[int]) -> ExactPose:
        """Go on by a step; some joints have moved the frame before."""
        axes, step = self._axes, self._steps[k]
        sense, free = self._robot.plane.senses[k], self._robot.free(self._held)
        kind = self._robot.joints[step.joint].kind if step.joint in passed else None
        found = found.shifted(axes.flat(self._mounts[k] @ step.origin))
        if sense:
            if step.joint in free:
                return found.freely_turned(sense, free.index(step.joint), kind)
            s, c = sine_cosine(rational(self._held[step.joint]))
            return found.rotated(c, s * sense / axes.stretch)
        axis = self._mounts[k + 1] @ (step.axis * step.sense)
        x, y = axes.flat(axis / _length(step.axis))
        if step.joint in free:
            return found.freely_slid((x, y), free.index(step.joint), kind)
        value = rational(self._held[step.joint])
        return found.shifted((x * value, y * value))

    def _cores_of(self, body: Body) -> list[ExactCore]:
        """Return the convex cores of a body."""
        if body.name not in self._cores:
            shape = self._numbers.body(body).shape
            radius = getattr(shape, "radius", rational(0))
            mount = self._mounts[self._robot.steps_to(body.frame)]
            at = [self._axes.flat(mount @ place) for place in shape.places]
            cores = []
            for loop in body.shape.loops:
                corners = [at[k] for k in loop]
                order = anticlockwise(np.array(corners, dtype=object))
                cores.append(ExactCore([corners[k] for k in order], radius))
            self._cores[body.name] = cores
        return self._cores[body.name]


# --- one feature ----------------------------------------------------------------------------------


def _feature(one: ExactCore, other: ExactCore, moved: ExactPose, keep: Any, row: int) -> Feature:
    """Return a row of `contacts.features`: edges of one, edges of the other, pairs of corners."""
    m, n = len(one.corners), len(other.corners)
    if row < one.edges * n:
        edge, corner = divmod(row, n)
        u = other.corners[corner]
        seen = _sum(moved.at, moved.turned(u))
        rims = [moved.turned(step) for step in other.around(corner)]
        return _on_edge(moved.axes, one, edge, seen, rims, keep)
    row -= one.edges * n
    if row < other.edges * m:
        edge, corner = divmod(row, m)
        seen = _difference(moved.turned_back(one.corners[corner]), moved.back)
        rims = [moved.turned_back(step) for step in one.around(corner)]
        return _on_edge(moved.axes, other, edge, seen, rims, keep)
    return _of_corners(one, other, moved, keep, *divmod(row - other.edges * m, n))


def _on_edge(
    axes: PlaneAxes, core: ExactCore, edge: int, seen: Vector, rims: Sequence[Vector], keep: Any
) -> Feature:
    """Return a corner, seen from a core's frame, on one of its edges.

    The height over the edge is the product of the edge and the way from its start to the corner,
    less what is kept; rims are the corner's own edges, which rise from it.
    """
    along, start = core.step(edge), core.corners[edge]
    way = _plus(seen[0], -start[0]), _plus(seen[1], -start[1])
    form = (way[0] * along[1] - way[1] * along[0]) * axes.size
    form = _plus(form, -(keep * axes.length(along) / axes.stretch)) if keep != 0 else form
    beside = axes.dot(along, way)
    sides = [beside, _plus(-beside, axes.dot(along, along))]
    sides += [x * along[1] - y * along[0] for x, y in rims]
    return form, _stacked(sides)


def _of_corners(
    one: ExactCore, other: ExactCore, moved: ExactPose, keep: Any, i: int, k: int
) -> Feature:
    """Return a corner of one core and one of the other: their squared distance."""
    axes, p, u = moved.axes, one.corners[i], other.corners[k]
    ahead = _sum(moved.at, moved.turned(u))
    squared = moved.squared + (axes.dot(u, moved.back) - axes.dot(p, ahead)) * 2
    form = _plus(squared, axes.dot(p, p) + axes.dot(u, u) - keep * keep)
    back = _difference(moved.turned_back(p), moved.back)
    sides = [
        _plus(-axes.dot(step, seen), axes.dot(step, own))
        for core, corner, seen in ((one, i, ahead), (other, k, back))
        for own in [core.corners[corner]]
        for step in core.around(corner)
    ]
    return form, _stacked(sides)


def _length(direction: Array) -> Any:
    """Return the length of a direction; one that is a unit vector but for rounding has length 1."""
    square = direction @ direction
    return rational(1) if abs(float(square) - 1) <= ROUNDING else root(square)


# --- tables ---------------------------------------------------------------------------------------


def _constant(value: Any) -> Array:
    """Return the table of a value that no joint moves."""
    return _plus(np.full((3, 3), rational(0), dtype=object), value)


def _plus(table: Array, value: Any) -> Array:
    """Add a number to a table's constant."""
    result = table.copy()
    result[0, 0] = result[0, 0] + value
    return result


def _sum(u: Vector, v: Vector) -> Vector:
    return u[0] + v[0], u[1] + v[1]


def _difference(u: Vector, v: Vector) -> Vector:
    return u[0] - v[0], u[1] - v[1]


def _stacked(sides: Sequence[Array]) -> Array:
    return np.array(sides, dtype=object).reshape(-1, 3, 3)
