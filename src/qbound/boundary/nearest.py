"""The nearest places of two bodies at a configuration: their corners, edges and coordinates."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats
from qbound.boundary.parts import bounded_bodies, bounds_bodies, flat_parts
from qbound.boundary.poses import PlanePoses
from qbound.geometry.distance import closest
from qbound.model.robot import Body, Boundary, HalfSpace, Robot

Placed = tuple[str, Floats, float]


class Nearest(NamedTuple):
    """The features of two bodies, or of a body and a half-space, that are nearest."""

    names: tuple[str, str]
    """Of the bodies; of a half-space the boundary's."""
    features: tuple[str, str]
    """Such as "corner 2" and "edge 3" of their outlines, counted from 0, with the part where a
    body has several; a half-space has only its "edge"."""
    places: Floats
    """One of each, shape (2, 2), in the plane's coordinates seen from the base; length."""
    distance: float
    """Between these places; negative by the depth where the bodies overlap."""


def nearest_features(robot: Robot, boundary: Boundary, q: ArrayLike) -> Nearest:
    """Return where the bodies of a boundary are nearest, or deepest in each other.

    Parameters
    ----------
    boundary : Boundary
        About two bodies, or a half-space that keeps a body.
    q : array_like, shape (n,)
        One configuration.

    Raises
    ------
    ValueError
        If the boundary is about points, the robot leaves every plane, or `q` is no configuration.
    """
    if not bounds_bodies(boundary):
        raise ValueError(f"{boundary.name}: it is about points, not about bodies")
    values = robot.configuration(q)
    if values.ndim != 1:
        raise ValueError(f"one configuration is wanted, found the shape {values.shape}")
    bodies = bounded_bodies(robot, boundary)
    placed = [list(_placed(robot, body, values)) for body in bodies]
    if isinstance(boundary, HalfSpace):
        return _above(robot, boundary, bodies[0], placed[0])
    names = bodies[0].name, bodies[1].name
    found = (_between(names, one, other) for one, other in product(*placed))
    return min(found, key=lambda nearest: nearest.distance)


def _between(names: tuple[str, str], one: Placed, other: Placed) -> Nearest:
    """Compare two parts."""
    (part, p, p_radius), (other_part, r, r_radius) = one, other
    found = closest(p, r)
    offsets = np.array([p_radius, -r_radius])[:, None] * found.direction
    return Nearest(
        names=names,
        features=(part + found.features[0], other_part + found.features[1]),
        places=found.places + offsets,
        distance=found.distance - p_radius - r_radius,
    )


def _above(robot: Robot, wall: HalfSpace, body: Body, parts: list[Placed]) -> Nearest:
    """Find the lowest place of a body over a half-space."""
    normal = robot.plane.across @ wall.normal
    off = robot.plane.height(body.frame, body.parts[0].corners)[0] * robot.plane.normal
    level = wall.offset - float(wall.normal @ off)
    heights = [corners @ normal - radius - level for _, corners, radius in parts]
    lowest = int(np.argmin([height.min() for height in heights]))
    (part, corners, radius), corner = parts[lowest], int(np.argmin(heights[lowest]))
    distance = float(heights[lowest][corner])
    size = float(np.hypot(*normal))
    unit = normal / size if size > 0 else normal
    place = corners[corner] - radius * unit
    foot = place - distance * unit
    features = (f"{part}corner {corner}", "edge")
    return Nearest((body.name, wall.name), features, np.array([place, foot]), distance)


def _placed(robot: Robot, body: Body, q: Floats) -> Iterator[Placed]:
    """Yield what each part of a body is called, its core where it stands, and its radius."""
    pair = (0, robot.steps_to(body.frame))
    c, s, x, y, *_ = PlanePoses(robot).of(q[None], {pair})[pair][:, 0]
    turn = np.array([[c, s], [-s, c]])
    parts = flat_parts(robot, body)
    for i, (core, radius) in enumerate(parts):
        yield f"part {i}, " if len(parts) > 1 else "", core @ turn + [x, y], radius
