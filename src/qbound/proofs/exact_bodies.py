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

from qbound.boundary.functions import position, squared_distance
from qbound.boundary.parts import bounded_bodies, bounds_bodies
from qbound.forms.harmonic import HarmonicForm
from qbound.geometry.convex import convex_parts
from qbound.model.robot import Body, BodyPair, Boundary, HalfSpace, Point, Robot
from qbound.printable import printable
from qbound.proofs import parts
from qbound.proofs.balls import ball

Array = NDArray[Any]


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
    """

    name: str
    forms: HarmonicForm
    starts: NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Core:
    """A convex core in a frame, exact: its corners, and for each edge its step and its normal.

    Attributes
    ----------
    corners, steps, normals : tuple of ndarray, shape (3,)
        Steps lead from a corner to the next; normals point outwards and are as long as the steps.
    """

    frame: str
    corners: tuple[Array, ...]
    steps: tuple[Array, ...]
    normals: tuple[Array, ...]

    def around(self, i: int) -> list[Array]:
        """Return the steps from a corner to its neighbours."""
        if len(self.corners) < 3:
            return [self.steps[i]] if self.steps else []
        return [self.steps[i], -self.steps[i - 1]]


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
        for forms, starts in _of(boundary, robot, cores):
            stack = HarmonicForm(np.array(forms), robot.kinds)
            stack = stack.restrict(held) if held else stack
            found.append(ExactSeparation(boundary.name, stack, np.array(starts)))
    return tuple(found)


def _of(
    boundary: Boundary, robot: Robot, cores: Mapping[str, Sequence[Core]]
) -> Iterator[tuple[list[Array], list[int]]]:
    """Yield the forms of each pair of parts, and where each feature begins."""
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
    cut = _cut(corners, body.name) if len(places) > 2 else [list(range(len(places)))]
    sense = 1 if len(places) < 3 or parts.turns_left(corners) else -1
    for part in cut:
        own = [places[k] for k in part]
        count = len(own) if len(own) > 1 else 0
        steps = [own[(k + 1) % len(own)] - own[k] for k in range(count)]
        normals = []
        for step in steps:
            normal = step * 0
            normal[seen[0]], normal[seen[1]] = sense * step[seen[1]], -sense * step[seen[0]]
            normals.append(normal)
        yield Core(body.frame, tuple(own), tuple(steps), tuple(normals))


def _cut(corners: Sequence[tuple[Fraction, ...]], name: str) -> Sequence[Sequence[int]]:
    """Cut an outline into convex parts; those of one with long decimals are verified."""
    try:
        return parts.cut(corners)
    except ValueError:
        found = convex_parts(np.array(corners, dtype=float))
        own = found if parts.turns_left(corners) else [part[::-1] for part in found]
        parts.check_parts(corners, own, name)
        return own


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


def _features(robot: Robot, near: Core, far: Core, keep: Any) -> tuple[list[Array], list[int]]:
    """Return the forms of all features of two cores, and where each feature begins."""
    corners = [_seen(robot, near.frame, far.frame, at) for at in far.corners]
    groups: list[list[Array]] = []
    for start, normal in zip(near.corners, near.normals, strict=False):
        level = normal @ start + keep * _length(normal)
        groups.append([_plus(_dot(normal, corner.place), -level) for corner in corners])

    def across(d: Array, k: int) -> tuple[Array, Array]:
        """Return a direction of the far frame seen from here, and its product with corner k."""
        end = _seen(robot, near.frame, far.frame, far.corners[k] + d)
        here = corners[k]
        return end.place - here.place, _plus(end.squared - here.squared, -(d @ d)) / 2

    for k, normal in enumerate(far.normals):
        seen, on = across(normal, k)
        level = keep * _length(normal)
        groups.append([_plus(_dot(u, seen) - on, -level) for u in near.corners])
    ahead = [[across(step, k) for step in far.around(k)] for k in range(len(corners))]
    for (i, p), (k, corner) in product(enumerate(near.corners), enumerate(corners)):
        square = _plus(corner.squared - 2 * _dot(p, corner.place), p @ p - keep * keep)
        behind = [_plus(-_dot(step, corner.place), step @ p) for step in near.around(i)]
        beyond = [on - _dot(p, seen) for seen, on in ahead[k]]
        groups.append([square, *behind, *beyond])
    starts = np.cumsum([0, *map(len, groups)])[:-1]
    return [form for group in groups for form in group], starts.tolist()


def _heights(robot: Robot, wall: HalfSpace, cores: Sequence[Core]) -> tuple[list[Array], list[int]]:
    """Return the heights of all corners of a body above a half-space: one feature."""
    level = wall.offset + _radius(robot.body(str(wall.body)))
    places = [_seen(robot, robot.base, c.frame, at) for c in cores for at in c.corners]
    return [_plus(_dot(wall.normal, seen.place), -level) for seen in places], [0]


def _length(vector: Array) -> Any:
    return ball(vector @ vector).sqrt()
