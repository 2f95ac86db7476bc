"""The contact features of a robot: of every pair of convex parts that are to keep apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import product

import numpy as np

from qbound.boundary.contacts import Contacts, Core, Features, features, gathered, heights
from qbound.boundary.errors import Sizes
from qbound.boundary.parts import bounded_bodies, bounds_bodies, flat_parts, refuse_off_plane
from qbound.boundary.poses import Axes, Move, Pose, flat_steps
from qbound.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot

Found = tuple[str, Features, tuple[int, int]]


def body_contacts(
    robot: Robot, held: Mapping[int, float], boundaries: Sequence[Boundary]
) -> Contacts:
    """Return the features of all boundaries about bodies, as forms of the two free joints.

    Parameters
    ----------
    held : mapping of int to float
        Values of all joints but two, by index; rad or length.

    Raises
    ------
    ValueError
        If the robot or a body leaves every plane.
    """
    about = [boundary for boundary in boundaries if bounds_bodies(boundary)]
    if not about:
        return gathered([])
    refuse_off_plane(robot, about)
    moves, axes = _moves(robot, held), Axes()

    @cache
    def between(near: int, far: int) -> tuple[Pose, Sizes]:
        part = moves[near:far]
        return Pose.after(part, axes, np.zeros((3, 3))), _sizes(part)

    found: list[Found] = []
    for boundary in about:
        bodies = bounded_bodies(robot, boundary)
        depths = [robot.steps_to(body.frame) for body in bodies]
        if isinstance(boundary, BodyPair):
            found += _of_pair(robot, boundary, bodies, *between(min(depths), max(depths)))
        elif isinstance(boundary, HalfSpace):
            found += _over(robot, boundary, bodies[0], *between(0, depths[0]))
    return gathered(found)


def _moves(robot: Robot, held: Mapping[int, float]) -> list[Move]:
    """Return every step as it moves in the plane, in the axes at all joint values 0."""
    free, found = robot.free(held), []
    flat = zip(robot.steps, robot.plane.senses, flat_steps(robot), strict=True)
    for step, sense, (origin, along) in flat:
        if step.joint in free:
            found.append(Move(origin, sense, along, free.index(step.joint)))
        else:
            value = held[step.joint]
            turn = (np.cos(value), np.sin(value)) if sense else (value,)
            found.append(Move(origin, sense, along, None, turn))
    return found


def _sizes(moves: Sequence[Move]) -> Sizes:
    """Return the lengths that go into the pose after some moves."""
    lengths = [np.hypot(*move.origin) for move in moves]
    held = [move for move in moves if move.free is None and not move.sense]
    lengths += [abs(move.value[0]) * np.hypot(*move.along) for move in held]
    slides = frozenset(move.free for move in moves if move.free is not None and not move.sense)
    return Sizes(float(sum(lengths)), slides, len(moves))


def _of_pair(
    robot: Robot, boundary: BodyPair, bodies: Sequence[Body], moved: Pose, sizes: Sizes
) -> Iterator[Found]:
    """Yield the features of the parts of two bodies, seen from the one nearer to the base."""
    swapped = robot.steps_to(bodies[0].frame) > robot.steps_to(bodies[1].frame)
    ordered = bodies[::-1] if swapped else bodies
    near, far = (_cores(robot, body) for body in ordered)
    depths = robot.steps_to(ordered[0].frame), robot.steps_to(ordered[1].frame)
    for (one, radius), (other, other_radius) in product(near, far):
        keep = radius + other_radius + boundary.clearance
        found = features(one, other, moved, keep, sizes, swapped=swapped)
        yield boundary.name, found, depths


def _over(robot: Robot, wall: HalfSpace, body: Body, moved: Pose, sizes: Sizes) -> Iterator[Found]:
    """Yield the corners of a body that are to stay above a half-space, each a test of its own."""
    normal = robot.plane.across @ wall.normal
    off = robot.plane.height(body.frame, body.parts[0].corners)[0]
    level = wall.offset - off * float(wall.normal @ robot.plane.normal)
    for core, radius in _cores(robot, body):
        for one in heights(core, moved, normal, level + radius, sizes):
            yield wall.name, one, (0, robot.steps_to(body.frame))


def _cores(robot: Robot, body: Body) -> list[tuple[Core, float]]:
    """Return the cores of a body's parts, anticlockwise, and their radii."""
    parts = flat_parts(robot, body)
    called = [f"part {i}, " if len(parts) > 1 else "" for i in range(len(parts))]
    return [
        (Core.of(corners, name, body.name), radius)
        for (corners, radius), name in zip(parts, called, strict=True)
    ]
