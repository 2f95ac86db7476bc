"""Which bodies is a boundary about? They, and their parts in the plane of motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from qbound.model.robot import Body, BodyPair, Boundary, HalfSpace, Robot

Floats = NDArray[np.float64]


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


def flat_parts(robot: Robot, body: Body) -> list[tuple[Floats, float]]:
    """Return core, shape (m, 2), and radius of each part, in the plane as `plane.flat` has them."""
    return [
        (np.asarray(robot.plane.flat(body.frame, part.corners), dtype=float), float(part.radius))
        for part in body.parts
    ]
