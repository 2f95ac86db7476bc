"""Poses of a frame in the plane of motion seen from another one, of numbers of any type.

In the axes of the plane a pose is a turn and a translation. Places of one frame seen from the other
one are linear in the pose, so a pose of tables gives forms.

This module also finds the bodies of a boundary, and their convex parts in the plane of motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, NamedTuple

import numpy as np

from cspace.arrays import Array, Floats
from cspace.forms.factors import FACTORS
from cspace.forms.harmonic import add_constant, times_function
from cspace.model.bodycheck import is_oblique, off_plane
from cspace.model.exact import rationals
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Prismatic, Revolute, Robot
from cspace.printable import printable
from qbound.forms import Kind

TURNING: Final = Revolute.kind
SLIDING: Final = Prismatic.kind

Vector = Any
"""Two coordinates in the axes of the plane: numbers, or arrays of tables."""


@dataclass(frozen=True)
class Axes:
    r"""Axes of the plane of motion at right angles, of any length.

    Doubles have unit vectors. Exact numbers take any vector of the plane with rational coordinates
    for the first axis, and its product with the normal n, as that is written, for the second one.
    So a turn is :math:`\cos q + \frac{\sin q}{|n|} K` with :math:`K (x, y) = (-|n|^2 y, x)`: tables
    hold the coefficients of :math:`\sin q / |n|`, so that in a tilted plane a zero is exactly zero,
    and not a ball.

    Attributes
    ----------
    size : number
        Square of the first axis' length.
    ratio : number
        Squared length of the second axis, divided by `size`: the squared length of the normal.
    stretch : number
        Square root of the ratio, by which `quarter` makes a vector longer.
    """

    size: Any = 1
    ratio: Any = 1
    stretch: Any = 1

    def dot(self, u: Vector, v: Vector) -> Any:
        """Return the scalar product."""
        return (u[0] * v[0] + u[1] * v[1] * self.ratio) * self.size

    def cross(self, u: Vector, v: Vector) -> Any:
        """Return how far v is on the right of u, times the length of u over the stretch."""
        return (v[0] * u[1] - v[1] * u[0]) * self.size

    def quarter(self, u: Vector) -> Vector:
        """Turn by a quarter turn, from the first axis to the second, and stretch."""
        return -(u[1] * self.ratio), u[0]

    def times(self, table: Array, joint: int, k: int, kind: Kind | None = None) -> Array:
        """Multiply by the cosine of a joint, by its sine over the stretch, its value or its square.

        `kind` is the kind of the joint, given if the table depends on the joint.
        """
        if kind is not None and k == 2 and FACTORS[kind].turns.any():
            parts = np.moveaxis(table, joint, 0)  # the square of this sine has the ratio below it
            scaled = np.stack([parts[0], parts[1], parts[2] / self.ratio])
            table = np.moveaxis(scaled, 0, joint)
        return times_function(table, joint, k, kind)


class Move(NamedTuple):
    """A step of the chain in the plane.

    Attributes
    ----------
    origin : Vector
        From the frame before to the step's, at joint value 0.
    sense : int
        +1 or -1 for a turn, from the first axis to the second or back; 0 for a slide.
    along : Vector
        Direction of a slide.
    free : int or None
        Which of the free joints it is; None for one that is held.
    value : tuple of numbers
        Of a held joint: cosine, and sine over the stretch; or how far it slides.
    """

    origin: Vector
    sense: int
    along: Vector
    free: int | None
    value: tuple[Any, ...] = ()


@dataclass(frozen=True)
class Pose:
    """Where a frame stands, seen from another one, as tables of the free joints.

    Attributes
    ----------
    turn : pair of tables
        Cosine of the turn, and its sine over the stretch.
    at : pair of tables
        The frame's origin, seen from the other frame.
    back : pair of tables
        The same vector seen from the frame itself.
    squared : table
        The squared length of this vector; a product of tables would hide that it has degree one.
    """

    axes: Axes
    turn: Vector
    at: Vector
    back: Vector
    squared: Array

    @property
    def joints(self) -> int:
        """Number of free joints: each has an axis of every table."""
        return self.squared.ndim

    @cached_property
    def one(self) -> Array:
        """The table of the constant 1."""
        one = np.eye(1, 3**self.joints, dtype=int).reshape(self.squared.shape)
        return rationals(one) if self.squared.dtype == object else one.astype(float)

    def number(self, numbers: Any) -> Any:
        """Return a number, or an array of numbers, as what multiplies tables."""
        found = np.asarray(numbers)
        return found[(..., *(None,) * self.joints)] if found.ndim else found.item()

    def vector(self, places: Array) -> Vector:
        """Return places, shape (..., 2), as a pair of arrays that multiply tables."""
        return self.number(places[..., 0]), self.number(places[..., 1])

    def plus(self, tables: Array, constant: Any) -> Array:
        """Add a `number` to the constant coefficient of tables."""
        first: Any = (..., *(0,) * self.joints)
        each = constant[first] if isinstance(constant, np.ndarray) else constant
        return add_constant(tables, np.broadcast_to(each, tables.shape[: -self.joints]))

    @classmethod
    def after(cls, moves: Sequence[Move], axes: Axes, none: Array) -> Pose:
        """Return the pose of the last frame after moves, one after the other.

        Parameters
        ----------
        none : ndarray, shape (3, ..., 3)
            A table of zeros, with an axis for each free joint.
        """
        found = cls(axes, (add_constant(none, 1), none), (none, none), (none, none), none)
        passed = set[int]()
        for move in moves:
            found = found.shifted(move.origin)
            if move.free is not None:
                again = move.free in passed
                found = (found.turned_by if move.sense else found.slid_by)(move, move.free, again)
                passed.add(move.free)
            elif move.sense:
                cosine, sine = move.value
                found = found.rotated(cosine, move.sense * sine)
            else:
                (value,) = move.value
                found = found.shifted((value * move.along[0], value * move.along[1]))
        return found

    def seen(self, u: Vector) -> Vector:
        """Return a place of the frame seen from the other one."""
        x, y = self.turned(u)
        return self.at[0] + x, self.at[1] + y

    def seen_back(self, u: Vector) -> Vector:
        """Return a place of the other frame seen from this one."""
        x, y = self.turned_back(u)
        return x - self.back[0], y - self.back[1]

    def turned(self, u: Vector) -> Vector:
        """Return a vector of the frame seen from the other one."""
        (c, s), v = self.turn, self.axes.quarter(u)
        return c * u[0] + s * v[0], c * u[1] + s * v[1]

    def turned_back(self, u: Vector) -> Vector:
        """Return a vector of the other frame seen from this one."""
        (c, s), v = self.turn, self.axes.quarter(u)
        return c * u[0] - s * v[0], c * u[1] - s * v[1]

    def shifted(self, by: Vector) -> Pose:
        """Go on by a fixed vector, seen from the moved frame."""
        axes, gain = self.axes, self.axes.dot(by, self.back) * 2
        back = add_constant(self.back[0], by[0]), add_constant(self.back[1], by[1])
        squared = add_constant(self.squared + gain, axes.dot(by, by))
        return Pose(axes, self.turn, self.seen(by), back, squared)

    def rotated(self, c: Any, s: Any) -> Pose:
        """Turn by a fixed angle, given by its cosine and its sine over the stretch."""
        cosine, sine = self.turn
        u, v = self.back, self.axes.quarter(self.back)
        turn = cosine * c - sine * s * self.axes.ratio, sine * c + cosine * s
        back = u[0] * c - v[0] * s, u[1] * c - v[1] * s
        return replace(self, turn=turn, back=back)

    def turned_by(self, move: Move, joint: int, again: bool) -> Pose:
        """Turn by a free joint: cosine times the pose plus sine times its quarter turn."""
        on, kind = self.rotated(0, move.sense), TURNING if again else None
        times = self.axes.times
        turn, back = (
            tuple(
                times(one, joint, 1, kind) + times(other, joint, 2, kind)
                for one, other in zip(own, quarter, strict=True)
            )
            for own, quarter in ((self.turn, on.turn), (self.back, on.back))
        )
        return replace(self, turn=turn, back=back)

    def slid_by(self, move: Move, joint: int, again: bool) -> Pose:
        """Go on along a free slide, by its value times a direction."""
        axes, times, kind = self.axes, self.axes.times, SLIDING if again else None
        (x, y), none = self.turned(move.along), self.squared * 0
        ahead = times(x, joint, 1, kind), times(y, joint, 1, kind)
        own = [times(add_constant(none, length), joint, 1) for length in move.along]
        gain = times(axes.dot(move.along, self.back) * 2, joint, 1, kind)
        square = times(add_constant(none, axes.dot(move.along, move.along)), joint, 2)
        return replace(
            self,
            at=(self.at[0] + ahead[0], self.at[1] + ahead[1]),
            back=(self.back[0] + own[0], self.back[1] + own[1]),
            squared=self.squared + gain + square,
        )


# --- the steps of a chain, and the bodies of a boundary -------------------------------------------


def step_lengths(robot: Robot) -> list[float]:
    """Return the length of each step of a robot's chain, a slide at its farther limit."""
    return [
        float(np.linalg.norm(step.origin))
        + (robot.joints[step.joint].farthest if step.slides else 0.0)
        for step in robot.steps
    ]


def flat_steps(robot: Robot) -> Iterator[tuple[Floats, Floats]]:
    """Yield origin and direction of slide of each step in the axes of the plane, shape (2,) each.

    They are turned as at all joint values 0; the direction of a turn is zero.
    """
    plane = robot.plane
    for step in robot.steps:
        turn = np.asarray(plane.frames.rotation(robot.base, step.parent), dtype=float)
        move = plane.across @ turn
        along = move @ step.mount @ step.axis * (step.sense if step.slides else 0)
        yield move @ step.origin, along


def bounds_bodies(boundary: Boundary) -> bool:
    """Tell whether a boundary is about bodies."""
    return isinstance(boundary, BodyPair) or (
        isinstance(boundary, HalfSpace) and boundary.body is not None
    )


def bounded_bodies(robot: Robot, boundary: Boundary) -> tuple[Body, ...]:
    """Return the bodies that a boundary is about: two, one or none."""
    if isinstance(boundary, BodyPair):
        return robot.body(boundary.bodies[0]), robot.body(boundary.bodies[1])
    if isinstance(boundary, HalfSpace) and boundary.body is not None:
        return (robot.body(boundary.body),)
    return ()


def wall_of(robot: Robot, wall: HalfSpace, body: Body) -> tuple[Floats, float]:
    """Return a half-space in the body's plane: the normal, shape (2,), and the least height."""
    off = robot.plane.height(body.frame, body.parts[0].corners)[0]
    level = wall.offset - off * float(wall.normal @ robot.plane.normal)
    return robot.plane.across @ wall.normal, level


def refuse_off_plane(robot: Robot, boundaries: Sequence[Boundary]) -> None:
    """Refuse bodies, and walls about them, that leave the plane of motion.

    This is checked when a file is read, but not for a robot that is made otherwise. If all joints
    slide along one line, the joints do not decide in which plane the bodies lie.

    Raises
    ------
    ValueError
        If a body or wall leaves the plane, or the robot leaves every plane.
    """
    bodies = {body.name: body for b in boundaries for body in bounded_bodies(robot, b)}
    for body, text in (
        off_plane(robot.plane, list(bodies.values()), robot.length_unit) if bodies else ()
    ):
        raise ValueError(f"{printable(body.name)}: {text}")
    for wall in boundaries:
        if isinstance(wall, HalfSpace) and bounds_bodies(wall) and is_oblique(wall, robot.plane):
            raise ValueError(f"{printable(wall.name)}: it leaves the plane in which the arm moves")


def flat_parts(robot: Robot, body: Body) -> list[tuple[Floats, float]]:
    """Return core, shape (m, 2), and radius of each part, in the plane as `plane.flat` has them."""
    return [
        (np.asarray(robot.plane.flat(body.frame, part.corners), dtype=float), float(part.radius))
        for part in body.parts
    ]
