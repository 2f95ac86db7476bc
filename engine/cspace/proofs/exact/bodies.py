r"""Separating tests of two bodies of a planar arm as exact forms, for pavings and connections.

Two convex cores are more than R apart exactly if one of their features separates them: an edge with
all corners of the other core more than R beyond it, or two corners that are the nearest places of
both cores and more than R apart. So a cell is feasible where some feature's forms are all positive
throughout, and infeasible where every feature has a form that is negative throughout.

No edge is scaled to length 1, because its numbers would no longer be exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Array
from cspace.boundary.contacts import SIDES, anticlockwise, edge_and_corner, two_corners
from cspace.boundary.exact_contacts import ExactChain, PlaneAxes, mounts
from cspace.boundary.poses import Pose, Vector, bounded_bodies, bounds_bodies
from cspace.forms.harmonic import add_constant
from cspace.geometry.convex import edges_of, exact_parts, in_whole_numbers, side
from cspace.model.exact import rational, rationals
from cspace.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot
from cspace.printable import printable
from cspace.proofs.exact.numbers import ball
from qbound.forms import HarmonicForm


@dataclass(frozen=True, eq=False)
class ExactSeparation:
    """The features of two convex parts, or the corners of a body above a half-space.

    Attributes
    ----------
    name : str
        Name of the boundary.
    forms : HarmonicForm, shape (m,)
        Coefficients (dtype object) are rationals or balls.
    starts : ndarray of int, shape (features,)
        First form of each feature; a feature separates where all of its forms are positive.
    contacts : HarmonicForm, shape (c, 5)
        One row for each way in which the parts can touch. They touch where the first form vanishes
        and the other four are not negative. The first form grows as the parts move apart.
    inner : ndarray of bool, shape (c,)
        Contacts of an edge along which a body was cut, if no distance is required. At such a
        contact the neighbouring part is hit too, or the place is a corner of the body.
    """

    name: str
    forms: HarmonicForm
    starts: NDArray[np.intp]
    contacts: HarmonicForm
    inner: NDArray[np.bool_]


class Core(NamedTuple):
    """A convex core in a frame, exact.

    Attributes
    ----------
    corners : list of Vector
        In the axes of the plane, anticlockwise.
    straight : list of bool
        Whether both edges at a corner are in line. A body that touches the corner also touches the
        edges. The neighbours of the corner do not tell on which side of it the core lies, so the
        corner itself is not a contact.
    inner : list of bool
        Whether the body was cut along the edge that begins at a corner.
    """

    corners: list[Vector]
    straight: list[bool]
    inner: list[bool]

    @property
    def edges(self) -> int:
        """Number of edges; a segment has one on either side."""
        return len(self.corners) if len(self.corners) > 1 else 0

    def step(self, i: int, k: int) -> Vector:
        """Return the vector from one corner to another."""
        (x, y), (u, v) = self.corners[i], self.corners[k % len(self.corners)]
        return u - x, v - y

    def around(self, i: int) -> list[Vector]:
        """Return the vectors from a corner to its neighbours."""
        count = len(self.corners)
        return [self.step(i, k) for k in sorted({(i + 1) % count, (i - 1) % count} - {i})]


def exact_separations(
    robot: Robot, boundaries: Sequence[Boundary], held: Mapping[int, Any] | None = None
) -> tuple[ExactSeparation, ...]:
    """Return the separating tests of the bodies that boundaries are about; not in the paper.

    Parameters
    ----------
    robot : Robot
        A robot from `exact_robot`.
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
    chain = _Chain(robot, held or {})
    cores: dict[str, list[Core]] = {}
    for body in (body for boundary in about for body in bounded_bodies(robot, boundary)):
        if body.name not in cores:
            cores[body.name] = list(_cores(body, robot, chain))
    found = []
    for boundary in about:
        for tests, contacts, inner in _of(boundary, robot, chain, cores):
            flat_tests = np.array([form for test in tests for form in test])
            stacks = [HarmonicForm(np.array(x), chain.kinds) for x in (flat_tests, contacts)]
            starts = np.cumsum([0, *map(len, tests)])[:-1]
            found.append(ExactSeparation(boundary.name, stacks[0], starts, stacks[1], inner))
    return tuple(found)


Tests = list[list[Array]]
"""Of each feature the forms that are to be positive."""


def _of(
    boundary: Boundary, robot: Robot, chain: _Chain, cores: Mapping[str, Sequence[Core]]
) -> Iterator[tuple[Tests, list[Array], NDArray[np.bool_]]]:
    """Yield the tests of each pair of parts, its contacts, and which of them are inner."""
    if isinstance(boundary, HalfSpace):
        yield _heights(robot, boundary, chain, cores[str(boundary.body)])
    elif isinstance(boundary, BodyPair):
        bodies = bounded_bodies(robot, boundary)
        keep = boundary.clearance + sum(_radius(body) for body in bodies)
        one, other = sorted(bodies, key=lambda body: robot.steps_to(body.frame))
        moved = chain.pose(*(robot.steps_to(body.frame) for body in (one, other)))
        for near, far in product(cores[one.name], cores[other.name]):
            # Points and segments with zero clearance add no constraint: touching is allowed.
            if ball(keep) > 0 or len(near.corners) + len(far.corners) > 3:
                yield _features(moved, near, far, keep)


def _radius(body: Body) -> Any:
    return body.parts[0].radius if len(body.shape.places) < 3 else 0


# --- the chain in its plane, and cores ------------------------------------------------------------


class _Chain(ExactChain):
    """The chain of an exact robot in its plane of motion, which lies across an axis of the base.

    Attributes
    ----------
    kinds : tuple of {"revolute", "prismatic"}
        Kinds of the joints that are not held.
    own : dict of str to int
        The coordinate of each frame that is across the plane.
    """

    def __init__(self, robot: Robot, held: Mapping[int, Any]) -> None:
        free, self._robot, self._turned = robot.free(held), robot, mounts(robot.steps)
        self.kinds = tuple(robot.joints[j].kind for j in free)
        turned = zip(self._turned[1:], robot.steps, strict=True)
        axes = [mount @ step.axis for mount, step in turned]
        (i, k), self._along, self.own = self._plane(axes)
        first, second = (rationals(np.eye(3, dtype=int)[x]) for x in (i, k))
        sign = 1 if (k - i) % 3 == 1 else -1  # of e_i x e_k
        senses = [
            0 if step.slides else int(np.sign(float(axis[self._along]))) * step.sense * sign
            for step, axis in zip(robot.steps, axes, strict=True)
        ]
        super().__init__(robot.steps, PlaneAxes(first=first, second=second), senses, free, held)
        self._above = [rational(0)]
        for before, step in zip(self._turned, robot.steps, strict=False):
            self._above.append(self._above[-1] + (before @ step.origin)[self._along])

    def _plane(self, axes: Sequence[Array]) -> tuple[list[int], int, dict[str, int]]:
        """Return the plane's coordinates, the one across it, and that of each frame, exactly."""
        robot = self._robot
        names = [robot.base, *(step.frame for step in robot.steps)]
        for normal in (1, 2, 0):
            across = [k for k in range(3) if k != normal]
            both = zip(axes, robot.steps, strict=True)
            gone = [axis[k] for axis, s in both for k in ([normal] if s.slides else across)]
            if not all(x == 0 for x in gone):
                continue
            own = {
                name: [k for k in range(3) if all(turned[i, k] == 0 for i in across)]
                for name, turned in zip(names, self._turned, strict=True)
            }
            if all(own.values()):
                return across, normal, {name: found[0] for name, found in own.items()}
        raise ValueError(
            "a proof about bodies needs joints that move them exactly in a plane across x, y or z"
            " of every frame; a mount in rad is rounded, one in degrees is not"
        )

    def above(self, frame: str, place: Array, normal: Array) -> Any:
        """Return the part of ``normal . place`` that is across the plane."""
        k = self._robot.steps_to(frame)
        return normal[self._along] * (self._above[k] + (self._turned[k] @ place)[self._along])


def _cores(body: Body, robot: Robot, chain: _Chain) -> Iterator[Core]:
    """Yield the convex cores of a body."""
    places, flat = list(body.shape.places), chain.own[body.frame]
    if any(place[flat] != places[0][flat] for place in places):
        raise ValueError(f"{printable(body.name)}: its places lie in no plane of motion")
    own = [tuple(_fraction(place[k]) for k in range(3) if k != flat) for place in places]
    whole = in_whole_numbers(own)
    frame = robot.steps_to(body.frame)
    seen = [chain.flat(frame, place) for place in places]
    loops = exact_parts(own) if len(places) > 2 else [list(range(len(places)))]
    order = anticlockwise(np.array([[float(x) for x in corner] for corner in seen]))
    if order[0] > order[-1]:
        loops = [loop[::-1] for loop in loops]
    edges = {edge for loop in loops if len(loop) > 2 for edge in edges_of(loop)}
    for loop in loops:
        around = list(zip([loop[-1], *loop[:-1]], loop, [*loop[1:], loop[0]], strict=True))
        yield Core(
            [seen[k] for k in loop],
            [len(loop) > 2 and side(whole[i], whole[k], whole[m]) == 0 for i, k, m in around],
            [(after, before) in edges for before, after in edges_of(loop)],
        )


def _fraction(x: Any) -> Fraction:
    return Fraction(int(x.p), int(x.q))


# --- features -------------------------------------------------------------------------------------


def _features(
    moved: Pose, near: Core, far: Core, keep: Any
) -> tuple[Tests, list[Array], NDArray[np.bool_]]:
    """Return the tests of all features of two cores, and their contacts."""
    tests: Tests = []
    contacts, inner = [], []
    apart, dot = bool(ball(keep) > 0), moved.axes.dot
    ways = ((near, far, moved.seen, moved.turned), (far, near, moved.seen_back, moved.turned_back))
    for core, other, seen, turned in ways:
        places = [seen(corner) for corner in other.corners]
        rims = [[turned(step) for step in other.around(i)] for i in range(len(places))]
        for k in range(core.edges):
            along, start = core.step(k, k + 1), core.corners[k]
            reach = dot(along, along)
            kept = keep * ball(reach).sqrt()
            found = [
                edge_and_corner(moved.axes, along, start, reach, place, own, kept)
                for place, own in zip(places, rims, strict=True)
            ]
            tests.append([height for height, _ in found])
            straight = zip(found, other.straight, strict=True)
            contacts += [_contact(*feature) for feature, is_straight in straight if not is_straight]
            inner += [core.inner[k] and not apart] * other.straight.count(False)
    for i, k in product(range(len(near.corners)), range(len(far.corners))):
        p, u = near.corners[i], far.corners[k]
        square, sides = two_corners(moved, p, u, near.around(i), far.around(k), keep)
        tests.append([square, *sides])
        if apart and not near.straight[i] and not far.straight[k]:
            contacts.append(_contact(square, sides))
            inner.append(False)
    return tests, contacts, np.array(inner)


def _contact(form: Array, sides: Sequence[Array]) -> Array:
    """Return a form and four side forms, which must not be negative; 1 for missing ones."""
    free = [add_constant(form * 0, 1)] * (SIDES - len(sides))
    return np.array([form, *sides, *free])


def _heights(
    robot: Robot, wall: HalfSpace, chain: _Chain, cores: Sequence[Core]
) -> tuple[Tests, list[Array], NDArray[np.bool_]]:
    """Return the heights of all corners of a body above a half-space: one feature."""
    body = robot.body(str(wall.body))
    moved, normal = chain.pose(0, robot.steps_to(body.frame)), chain.flat(0, wall.normal)
    level = wall.offset + _radius(body)
    level = level - chain.above(body.frame, body.shape.places[0], wall.normal)
    places = [moved.seen(corner) for core in cores for corner in core.corners]
    heights = [add_constant(moved.axes.dot(normal, place), -level) for place in places]
    contacts = [_contact(height, []) for height in heights]
    return [heights], contacts, np.zeros(len(contacts), dtype=np.bool_)
