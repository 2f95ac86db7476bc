r"""What separates two bodies of a planar arm, as exact forms: for pavings and connections.

Two convex cores are more than R apart exactly if one of their features separates them: an edge with
all corners of the other core more than R beyond it, or two corners that are the nearest places of
both cores and more than R apart. So a cell is feasible where some feature's forms are all positive
throughout, and infeasible where every feature has a form that is negative throughout.

All comes from places of the far body seen from the near one's frame, and from their squared
distances from its origin: a step d of the far frame from a place c to c + d has, seen from here,
:math:`|c + d|^2 - |c|^2 = 2 c \cdot d + |d|^2`.

No edge is brought to length 1: that would cost the exact numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Array
from qbound.boundary.contacts import SIDES
from qbound.boundary.functions import position, squared_distance
from qbound.boundary.parts import bounded_bodies, bounds_bodies
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import Body, BodyPair, Boundary, HalfSpace, Point, Robot
from qbound.printable import printable
from qbound.proofs.exact import parts
from qbound.proofs.exact.numbers import ball


@dataclass(frozen=True, eq=False)
class ExactSeparation:
    """The features of two convex parts, or the corners of a body above a half-space.

    Attributes
    ----------
    name : str
        The boundary's.
    forms : HarmonicForm, shape (m,)
        Coefficients (dtype object) are rationals or balls.
    starts : ndarray of int, shape (features,)
        First form of each feature; it separates where all of its forms are positive.
    contacts : HarmonicForm, shape (c, 5)
        Each way in which the parts can touch: they do so where the first form vanishes and the
        other four are not negative. The first one grows as they part.
    inner : ndarray of bool, shape (c,)
        Contacts of an edge along which a body was cut, where nothing keeps a distance: there the
        part beyond is hit as well, or the place is a corner of the body.
    """

    name: str
    forms: HarmonicForm
    starts: NDArray[np.intp]
    contacts: HarmonicForm
    inner: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Core:
    """A convex core in a frame, exact: its corners, and for each edge its step and its normal.

    Attributes
    ----------
    corners, steps, normals : tuple of ndarray, shape (3,)
        Steps lead from a corner to the next; normals point outwards and are as long as the steps.
    inner : tuple of bool
        Whether the body was cut along an edge.
    """

    frame: str
    corners: tuple[Array, ...]
    steps: tuple[Array, ...]
    normals: tuple[Array, ...]
    inner: tuple[bool, ...]

    def around(self, i: int) -> list[Array]:
        """Return the steps from a corner to its neighbours."""
        if len(self.corners) < 3:
            return [self.steps[i]] if self.steps else []
        return [self.steps[i], -self.steps[i - 1]]

    def is_straight(self, i: int) -> bool:
        """Tell whether both edges at a corner are in line: what touches it touches them as well.

        Its neighbours do not tell on which side of it the core lies, so it is no contact itself.
        """
        return len(self.corners) > 2 and bool(self.normals[i] @ self.steps[i - 1] == 0)

    def beside(self, i: int) -> list[int]:
        """Return the numbers of a corner's neighbours."""
        count = len(self.corners)
        return sorted({(i + 1) % count, (i - 1) % count} - {i})


def exact_separations(
    robot: Robot, boundaries: Sequence[Boundary], held: Mapping[int, Any] | None = None
) -> tuple[ExactSeparation, ...]:
    """Return what separates the bodies that boundaries are about; not in the paper.

    Parameters
    ----------
    robot : Robot
        From `exact_robot`.
    held : mapping of int to ball, optional
        Values of joints that are held, rad or length.

    Raises
    ------
    ValueError
        If an outline cannot be cut into convex parts, or the joints do not move the bodies exactly
        in one plane across an axis of the base and of their frames.
    """
    about = [boundary for boundary in boundaries if bounds_bodies(boundary)]
    if not about:
        return ()
    flat = _flat_coordinates(robot)
    cores: dict[str, list[Core]] = {}
    for body in (body for boundary in about for body in bounded_bodies(robot, boundary)):
        if body.name not in cores:
            cores[body.name] = list(_cores(body, flat[body.frame]))
    found = []
    for boundary in about:
        for tests, contacts, inner in _of(boundary, robot, cores):
            flat_tests = np.array([form for test in tests for form in test])
            stacks = [HarmonicForm(np.array(x), robot.kinds) for x in (flat_tests, contacts)]
            stacks = [stack.restrict(held) for stack in stacks] if held else stacks
            starts = np.cumsum([0, *map(len, tests)])[:-1]
            found.append(ExactSeparation(boundary.name, stacks[0], starts, stacks[1], inner))
    return tuple(found)


Tests = list[list[Array]]
"""Of each feature the forms that are to be positive."""


def _of(
    boundary: Boundary, robot: Robot, cores: Mapping[str, Sequence[Core]]
) -> Iterator[tuple[Tests, list[Array], NDArray[np.bool_]]]:
    """Yield the tests of each pair of parts, and its contacts with what `inner` says of them."""
    if isinstance(boundary, HalfSpace):
        yield _heights(robot, boundary, cores[str(boundary.body)])
    elif isinstance(boundary, BodyPair):
        bodies = bounded_bodies(robot, boundary)
        keep = boundary.clearance + sum(_radius(body) for body in bodies)
        one, other = sorted(bodies, key=lambda body: robot.depth(body.frame))
        for near, far in product(cores[one.name], cores[other.name]):
            # What is kept at no distance from a point forbids nothing, unless it has an inside.
            if ball(keep) > 0 or len(near.corners) + len(far.corners) > 3:
                yield _features(robot, near, far, keep)


def _radius(body: Body) -> Any:
    return body.parts[0].radius if len(body.shape.places) < 3 else 0


# --- cores ----------------------------------------------------------------------------------------


def _flat_coordinates(robot: Robot) -> dict[str, int]:
    """Return the coordinate of each frame that is across the plane of motion, checked exactly."""
    turned = np.array([[ball(int(i == k)) for k in range(3)] for i in range(3)])
    rotations, axes = {robot.base: turned}, []
    for joint in robot.joints:
        turned = turned @ joint.mount
        axes.append((joint.turns, turned @ joint.axis))
        rotations[joint.frame] = turned
    for normal in (1, 2, 0):
        across = [k for k in range(3) if k != normal]
        gone = [axis[k] for turns, axis in axes for k in (across if turns else [normal])]
        if not all(x == 0 for x in gone):
            continue
        own = {
            name: [k for k in range(3) if all(rotation[i, k] == 0 for i in across)]
            for name, rotation in rotations.items()
        }
        if all(own.values()):
            return {name: found[0] for name, found in own.items()}
    raise ValueError(
        "a proof about bodies needs joints that move them exactly in a plane across x, y or z of"
        " every frame; a mount in rad is rounded, one in degrees is not"
    )


def _cores(body: Body, flat: int) -> Iterator[Core]:
    """Yield the convex cores of a body."""
    places = list(body.shape.places)
    if any(place[flat] != places[0][flat] for place in places):
        raise ValueError(f"{printable(body.name)}: its places lie in no plane of motion")
    seen = [k for k in range(3) if k != flat]
    corners = [tuple(_fraction(place[k]) for k in seen) for place in places]
    cut = parts.cut(corners, body.name) if len(places) > 2 else [list(range(len(places)))]
    sense = 1 if len(places) < 3 or parts.turns_left(corners) else -1
    edges = {edge for part in cut if len(part) > 2 for edge in _around(part)}
    for part in cut:
        own = [places[k] for k in part]
        count = len(own) if len(own) > 1 else 0
        steps = [own[(k + 1) % len(own)] - own[k] for k in range(count)]
        normals = []
        for step in steps:
            normal = step * 0
            normal[seen[0]], normal[seen[1]] = sense * step[seen[1]], -sense * step[seen[0]]
            normals.append(normal)
        inner = [(after, before) in edges for before, after in _around(part)]
        yield Core(body.frame, tuple(own), tuple(steps), tuple(normals), tuple(inner))


def _around(part: Sequence[int]) -> list[tuple[int, int]]:
    """Return the edges of a part, by the numbers of their ends."""
    return list(zip(part, [*part[1:], part[0]], strict=True))


def _fraction(x: Any) -> Fraction:
    return Fraction(int(x.p), int(x.q))


# --- features -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Seen:
    """A place of the far frame, seen from the near one: three forms, and its square."""

    place: Array
    squared: Array


def _seen(robot: Robot, near: str, frame: str, at: Array) -> _Seen:
    point = Point("\0", frame, at)
    with_point = replace(robot, points=(*robot.points, point))
    return _Seen(
        position(with_point, point.name, near).coefficients,
        squared_distance(with_point, point.name, near).coefficients,
    )


def _dot(u: Array, forms: Array) -> Array:
    return np.asarray(np.tensordot(u, forms, axes=1))


def _plus(form: Array, constant: Any) -> Array:
    form = form.copy()
    form[(0,) * form.ndim] += constant
    return form


def _features(
    robot: Robot, near: Core, far: Core, keep: Any
) -> tuple[Tests, list[Array], NDArray[np.bool_]]:
    """Return the tests of all features of two cores, and their contacts."""
    corners = [_seen(robot, near.frame, far.frame, at) for at in far.corners]

    def across(d: Array, k: int) -> tuple[Array, Array]:
        """Return a direction of the far frame seen from here, and its product with corner k."""
        end = _seen(robot, near.frame, far.frame, far.corners[k] + d)
        here = corners[k]
        return end.place - here.place, _plus(end.squared - here.squared, -(d @ d)) / 2

    def above(core: Core, k: int) -> Iterator[list[Array]]:
        """Yield the products of the other core's corners with an edge's normal, and its step."""
        for d in (core.normals[k], core.steps[k]):
            if core is near:
                yield [_plus(_dot(d, c.place), -(d @ near.corners[k])) for c in corners]
            else:
                seen, on = across(d, k)
                yield [_dot(u, seen) - on for u in near.corners]

    tests: Tests = []
    contacts, inner = [], []
    apart = bool(ball(keep) > 0)
    for core, other in ((near, far), (far, near)):
        for k, (normal, step) in enumerate(zip(core.normals, core.steps, strict=True)):
            heights, along = above(core, k)
            tests.append([_plus(height, -keep * _length(normal)) for height in heights])
            for i, (height, place) in enumerate(zip(tests[-1], along, strict=True)):
                if other.is_straight(i):
                    continue
                rims = [heights[j] - heights[i] for j in other.beside(i)]
                contacts.append(_contact(height, [place, _plus(-place, step @ step), *rims]))
                inner.append(core.inner[k] and not apart)
    ahead = [[across(step, k) for step in far.around(k)] for k in range(len(corners))]
    for (i, p), (k, corner) in product(enumerate(near.corners), enumerate(corners)):
        square = _plus(corner.squared - 2 * _dot(p, corner.place), p @ p - keep * keep)
        behind = [_plus(-_dot(step, corner.place), step @ p) for step in near.around(i)]
        beyond = [on - _dot(p, seen) for seen, on in ahead[k]]
        tests.append([square, *behind, *beyond])
        if apart and not near.is_straight(i) and not far.is_straight(k):
            contacts.append(_contact(square, [*behind, *beyond]))
            inner.append(False)
    return tests, contacts, np.array(inner)


def _contact(form: Array, sides: Sequence[Array]) -> Array:
    """Return a form and four that are not to be negative, 1 where there are fewer."""
    free = [_plus(form * 0, 1)] * (SIDES - len(sides))
    return np.array([form, *sides, *free])


def _heights(
    robot: Robot, wall: HalfSpace, cores: Sequence[Core]
) -> tuple[Tests, list[Array], NDArray[np.bool_]]:
    """Return the heights of all corners of a body above a half-space: one feature."""
    level = wall.offset + _radius(robot.body(str(wall.body)))
    places = [_seen(robot, robot.base, c.frame, at) for c in cores for at in c.corners]
    heights = [_plus(_dot(wall.normal, seen.place), -level) for seen in places]
    contacts = [_contact(height, []) for height in heights]
    return [heights], contacts, np.zeros(len(contacts), dtype=np.bool_)


def _length(vector: Array) -> Any:
    return ball(vector @ vector).sqrt()
