"""The contact features of a robot: of every pair of convex parts that are to keep apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np

from qbound.boundary.contacts import (
    Contacts,
    Core,
    Features,
    Move,
    Pose,
    features,
    gathered,
    heights,
    pose,
)
from qbound.boundary.parts import bounded_bodies, bounds_bodies, flat_parts, refuse_off_plane
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
    moves, poses = _moves(robot, held), dict[tuple[int, int], Pose]()

    def between(near: int, far: int) -> Pose:
        if (near, far) not in poses:
            poses[near, far] = pose(moves[near:far])
        return poses[near, far]

    found: list[Found] = []
    for boundary in about:
        bodies = bounded_bodies(robot, boundary)
        depths = [robot.depth(body.frame) for body in bodies]
        if isinstance(boundary, BodyPair):
            found += _of_pair(robot, boundary, bodies, between(min(depths), max(depths)))
        elif isinstance(boundary, HalfSpace):
            found += _over(robot, boundary, bodies[0], between(0, depths[0]))
    return gathered(found)


def _moves(robot: Robot, held: Mapping[int, float]) -> list[Move]:
    """Return every joint as it moves in the plane, in the axes at all joint values 0."""
    plane, free = robot.plane, robot.free(held)
    return [
        Move(
            origin=plane.flat(joint.parent, joint.origin),
            turn=sense,
            along=np.zeros(2) if sense else plane.flat(joint.parent, joint.mount @ joint.axis),
            free=free.index(j) if j in free else None,
            value=held.get(j, 0.0),
        )
        for j, (joint, sense) in enumerate(zip(robot.joints, plane.senses, strict=True))
    ]


def _of_pair(
    robot: Robot, boundary: BodyPair, bodies: Sequence[Body], moved: Pose
) -> Iterator[Found]:
    """Yield the features of the parts of two bodies, seen from the one nearer to the base."""
    swapped = robot.depth(bodies[0].frame) > robot.depth(bodies[1].frame)
    ordered = bodies[::-1] if swapped else bodies
    near, far = (_cores(robot, body) for body in ordered)
    depths = robot.depth(ordered[0].frame), robot.depth(ordered[1].frame)
    for (one, radius), (other, other_radius) in product(near, far):
        keep = radius + other_radius + boundary.clearance
        yield boundary.name, features(one, other, moved, keep, swapped=swapped), depths


def _over(robot: Robot, wall: HalfSpace, body: Body, moved: Pose) -> Iterator[Found]:
    """Yield the corners of a body that are to stay above a half-space, each a test of its own."""
    normal = robot.plane.across @ wall.normal
    off = robot.plane.height(body.frame, body.parts[0].corners)[0]
    level = wall.offset - off * float(wall.normal @ robot.plane.normal)
    for core, radius in _cores(robot, body):
        for one in heights(core, moved, normal, level + radius):
            yield wall.name, one, (0, robot.depth(body.frame))


def _cores(robot: Robot, body: Body) -> list[tuple[Core, float]]:
    """Return the cores of a body's parts, anticlockwise, and their radii."""
    parts = flat_parts(robot, body)
    called = [f"part {i}, " if len(parts) > 1 else "" for i in range(len(parts))]
    return [
        (Core.of(corners, name, body.name), radius)
        for (corners, radius), name in zip(parts, called, strict=True)
    ]
