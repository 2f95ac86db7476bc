r"""The chain of a planar robot in its plane of motion, in numbers of any type.

The pose of a frame, seen from a frame before it, is a column of eight numbers (`POSE`). Every
place of one frame, seen from the other one, is linear in this column, and so is every distance that
bodies need. Each joint multiplies the column by its cosine and sine, or adds multiples of its
value. So one function carries poses along the chain: at millions of configurations, where an entry
is an array of numbers, and as harmonic forms (Theorem 1), where an entry is a table of
coefficients, in doubles, rationals or balls.

This module also finds the bodies of a boundary, and their convex parts in the plane of motion.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from cspace.arrays import Array, Floats, cross
from cspace.model.bodycheck import is_oblique, off_plane
from cspace.model.exact import rational, rationals, root
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot, Step
from cspace.printable import printable

ONE, X, Y, COSINE, SINE, U, V, SQUARE = range(8)
"""Rows of a pose: 1, its origin (x, y) seen from the observer, cosine and sine (over the stretch of
the axes) of its turn, the same origin (u, v) seen from the turned frame, and its squared length.
As a product of forms the last one would hide that it has degree one in each joint."""

POSE = 8


@dataclass(frozen=True, eq=False)
class Axes:
    r"""Axes of the plane of motion at right angles, of any length.

    Doubles have unit vectors. Exact numbers take any vector of the plane with rational coordinates
    for the first axis, and its product with the normal n, as that is written, for the second one.
    So a turn is :math:`\cos q + \frac{\sin q}{|n|} K` with :math:`K (x, y) = (-|n|^2 y, x)`: tables
    hold the coefficients of :math:`\sin q / |n|`, so that in a tilted plane a zero is exactly zero,
    and not a ball.

    Attributes
    ----------
    across : ndarray, shape (2, 3)
        ``across @ r`` are the coordinates of a vector of the base.
    normal : ndarray, shape (3,)
        Of any length; a turn about it goes from the first axis to the second.
    size : number
        Square of the first axis' length.
    ratio : number
        Squared length of the second axis, divided by `size`: the squared length of the normal.
    stretch : number
        Square root of the ratio, by which `quarter` makes a vector longer.
    """

    across: Array
    normal: Array
    size: Any = 1
    ratio: Any = 1
    stretch: Any = 1

    @classmethod
    def exact(cls, normal: Array) -> Axes:
        """Return axes at right angles to a normal of exact numbers."""
        base = rationals(np.eye(3, dtype=int)[int(np.argmin(np.abs(normal.astype(float))))])
        first, ratio = cross(base, normal), normal @ normal
        size, second = first @ first, cross(normal, first)
        across = np.array([first / size, second / (size * ratio)])
        return cls(across, normal, size, ratio, root(ratio))

    def carrying(self, by: Array) -> Array:
        """Return the matrix that adds to a pose what a vector of the moved frame adds; linear."""
        (a, b), (c, d), along = by, self.quarter(by), self.along(by) * 2
        found = np.zeros((POSE, POSE), by.dtype)
        found[[X, Y], COSINE], found[[X, Y], SINE] = (a, b), (c, d)
        found[[U, V], ONE], found[SQUARE, [U, V]] = (a, b), along
        return found

    def lengthening(self, by: Array) -> Array:
        """Return the matrix that adds the squared length of a vector."""
        found = np.zeros((POSE, POSE), by.dtype)
        found[SQUARE, ONE] = self.along(by) @ by
        return found

    def turning(self) -> Array:
        """Return the matrix that turns the frame of a pose by a quarter turn, and stretches."""
        found = np.zeros((POSE, POSE), self.across.dtype)
        found[SINE, COSINE], found[V, U] = 1, -1
        found[COSINE, SINE], found[U, V] = -self.ratio, self.ratio
        return found

    def quarter(self, u: Array) -> Array:
        """Turn vectors, shape (..., 2), from the first axis to the second, and stretch them."""
        return np.asarray(u[..., ::-1] * [-self.ratio, 1])

    def along(self, u: Array) -> Array:
        """Return what multiplies the coordinates of v in the product of u and v, shape (..., 2)."""
        return np.asarray(u * [self.size, self.size * self.ratio])

    def across_of(self, u: Array) -> Array:
        """Return the same for how far v is on the right of u, times u's length over the stretch."""
        return np.asarray(u[..., ::-1] * [self.size, -self.size])


class Move(NamedTuple):
    """A step of the chain in the plane.

    Attributes
    ----------
    joint : int
    slides : bool
    origin, along : ndarray, shape (2,)
        From the frame before to the step's, and the direction of a slide; at all joint values 0.
    matrices : ndarray, shape (3, POSE, POSE)
        Their sum, times 1, cos q and sin q or 1, q and q², carries a pose over the step.
    circle : ndarray, shape (3, POSE, POSE) or (0,)
        The same over this step and the next one, where that turns back by the same joint.
    """

    joint: int
    slides: bool
    origin: Array
    along: Array
    matrices: Array
    circle: Array


Way = tuple[int, ...]
"""Numbers of steps to two frames, the nearer one first."""

Known = Mapping[int, tuple[Any, Any]]
"""Of joints: cosine, and sine over the stretch of the axes; or value and its square."""


class PlaneChain:
    """The chain of a planar robot in its plane of motion; frames by the number of steps to them.

    Parameters
    ----------
    steps : sequence of Step
        With doubles or exact numbers; slides along unit vectors.
    axes : Axes
        Of the plane.
    """

    def __init__(self, steps: Sequence[Step], axes: Axes) -> None:
        self.axes, self.mounts = axes, mounts(steps)
        self.moves = [self._move(k, step, steps[k + 1 : k + 2]) for k, step in enumerate(steps)]

    @classmethod
    def of(cls, robot: Robot) -> PlaneChain:
        """Return the chain in doubles; ValueError if the robot leaves every plane."""
        across = robot.plane.across
        return cls(robot.steps, Axes(across, cross(*across)))

    def flat(self, k: int, places: Array) -> Array:
        """Return places of a frame, (..., 3), in the plane, turned as at all joint values 0."""
        return np.asarray(places @ (self.axes.across @ self.mounts[k]).T)

    def length(self, way: Way, known: Known) -> float:
        """Return the sum of the lengths that go into a pose of doubles."""
        moves = self.moves[slice(*way)]
        slid = [move for move in moves if move.joint in known and move.slides]
        lengths = [abs(known[move.joint][0]) * np.hypot(*move.along) for move in slid]
        return float(sum(np.hypot(*move.origin) for move in moves) + sum(lengths))

    def pose(self, way: Way, one: Array, known: Known, free: Sequence[int] = ()) -> Array:
        """Return the pose of a frame seen from one before it, shape (POSE, ...).

        Parameters
        ----------
        way : (int, int)
            Numbers of steps to the observer's frame and to the other one.
        one : ndarray
            The number 1: ones, one for each configuration; or the table of the constant 1, with an
            axis for each free joint.
        known : mapping
            Of the joints that are not free; numbers, or arrays with one for each configuration.
        free : sequence of int
            The joints of the table's axes.
        """
        k, far = way
        pose = np.zeros((POSE, *one.shape), one.dtype)
        pose[ONE] = pose[COSINE] = one
        while k < far:
            move = self.moves[k]
            goes_round = len(move.circle) > 0 and k + 1 < far
            matrices = move.circle if goes_round else move.matrices
            carries = move.slides or goes_round
            changed = slice(X, POSE) if carries else slice(COSINE, SQUARE)
            first, second = applied(matrices[1:, changed], pose)
            pose = applied(matrices[0], pose)
            if move.joint in known:
                first, second = map(times, (first, second), known[move.joint])
            else:
                axis = 1 + free.index(move.joint)
                first, second = times_function(first, axis, 1), times_function(second, axis, 2)
            pose[changed] += first
            pose[changed] += second
            k += 1 + goes_round
        return pose

    def _move(self, k: int, step: Step, after: Sequence[Step]) -> Move:
        """Return a step as it moves in the plane, given the next one, if any."""
        axes, same = self.axes, np.eye(POSE, dtype=np.int64)
        origin, axis = self.flat(k, step.origin), self.mounts[k + 1] @ step.axis * step.sense
        along, sense = axes.across @ axis, int(np.sign(float(axis @ axes.normal)))
        there = same + axes.carrying(origin) + axes.lengthening(origin)
        if step.slides:
            matrices = [same, axes.carrying(along), axes.lengthening(along)]
        else:
            turned = np.diag(np.isin(range(POSE), (COSINE, SINE, U, V)).astype(np.int64))
            matrices = [same - turned, turned, axes.turning() * sense]
        circle = np.empty(0)
        if after and after[0].joint == step.joint:
            crank = self.flat(k + 1, after[0].origin)
            still, across = same + axes.lengthening(crank), axes.quarter(crank) * sense
            circle = applied(np.stack([still, axes.carrying(crank), axes.carrying(across)]), there)
        carried = applied(np.stack(matrices), there)
        return Move(step.joint, step.slides, origin, along, carried, circle)


def mounts(steps: Sequence[Step]) -> list[Array]:
    """Return the rotation of each frame at all joint values 0, seen from the base."""
    found: list[Array] = [np.eye(3, dtype=int)]
    for step in steps:
        found.append(found[-1] @ step.mount)
    return found


def projected(along: Array, places: Array, axes: Axes, *, back: bool = False) -> Array:
    """Return rows whose products with a pose are those of vectors and places, shape (..., POSE).

    Parameters
    ----------
    along : ndarray, shape (..., 2)
        Vectors of one frame, as `Axes.along` or `Axes.across_of` has them.
    places : ndarray, shape (..., 2)
        Places of the other frame.
    back : bool
        Whether the places are those of the observer, seen from the turned frame.
    """
    rows = np.zeros((*np.broadcast_shapes(along.shape, places.shape)[:-1], POSE), along.dtype)
    rows[..., COSINE] = (along * places).sum(axis=-1)
    rows[..., SINE] = (along * axes.quarter(places)).sum(axis=-1) * (-1 if back else 1)
    rows[..., [U, V] if back else [X, Y]] = -along if back else along
    return rows


def applied(rows: Array, pose: Array) -> Array:
    """Return the products of rows, shape (..., POSE), with a pose, or with a table of its rows.

    Exact zeros are left out, because a ball times 0, added to a rational, is a ball.
    """
    if object not in (rows.dtype, pose.dtype):
        return np.matmul(rows, pose) if pose.ndim == 2 else np.tensordot(rows, pose, 1)
    table = pose.reshape(POSE, -1)
    found = np.full((rows.size // POSE, table.shape[1]), rational(0), dtype=object)
    places = [[j for j, x in enumerate(own) if not _is_zero(x)] for own in table]
    for row, own in zip(rows.reshape(-1, POSE), found, strict=True):
        for k in (k for k, x in enumerate(row) if not _is_zero(x)):
            for j in places[k]:
                own[j] += row[k] * table[k, j]
    return found.reshape(*rows.shape[:-1], *pose.shape[1:])


def _is_zero(x: Any) -> bool:
    """Tell whether a number is exactly 0; of a ball about 0 neither ``x == 0`` nor ``x != 0``."""
    return bool(x == 0)


def times(rows: Array, factor: Any) -> Array:
    """Multiply by a number, or by one for each configuration; exact zeros stay."""
    if rows.dtype != object:
        rows *= factor
        return rows
    return np.asarray(np.frompyfunc(lambda x: x if _is_zero(x) else x * factor, 1, 1)(rows))


def times_function(tables: Array, axis: int, k: int) -> Array:
    """Multiply tables of forms by a function, 1 or 2, of a joint that they do not depend on."""
    parts = np.moveaxis(tables, axis, 0)
    product = np.zeros_like(parts)
    product[k] = parts[0]
    return np.moveaxis(product, 0, axis)


# --- the steps of a chain, and the bodies of a boundary -------------------------------------------


def step_lengths(robot: Robot) -> list[float]:
    """Return the length of each step of a robot's chain, a slide at its farther limit."""
    return [
        float(np.linalg.norm(step.origin))
        + (robot.joints[step.joint].farthest if step.slides else 0.0)
        for step in robot.steps
    ]


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


def placed_bodies(robot: Robot, boundary: Boundary) -> list[tuple[int, Body]]:
    """Return the bodies that a boundary is about with the steps to each, nearer ones first."""
    bodies = bounded_bodies(robot, boundary)
    return sorted(((robot.steps_to(b.frame), b) for b in bodies), key=lambda placed: placed[0])


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
