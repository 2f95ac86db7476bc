"""The bodies of a boundary, and their convex parts in the plane of motion."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from qbound.arrays import Floats
from qbound.model.bodycheck import is_oblique, off_plane
from qbound.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot
from qbound.printable import printable


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


def refuse_off_plane(robot: Robot, boundaries: Sequence[Boundary]) -> None:
    """Refuse bodies, and walls about them, that leave the plane of motion.

    A file has been asked this when it was read, a robot that is made otherwise has not: where all
    joints slide along one line they do not settle in which plane the bodies lie.

    Raises
    ------
    ValueError
        If one does, or the robot leaves every plane.
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
