"""Facts about one configuration, as plain data for JSON, with few imports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from numpy.typing import ArrayLike

from cspace.boundary.poses import bounds_bodies
from cspace.export.formats import left_out_content
from cspace.measures.nearest import nearest_boundary
from cspace.model.robot import Boundary, Robot
from cspace.region import Region, find_region, margins

FORMED = 6
"""Most joints for which forms are made, of 3^n numbers each: 0.1 s for 100 pairs of six joints."""


def with_version(robot: Robot, facts: dict[str, Any]) -> dict[str, Any]:
    """Return facts together with the names of the robot and of the version."""
    from cspace.version import __version__

    return {"robot": robot.name, "version": __version__, **left_out_content(robot), **facts}


def configuration_facts(
    robot: Robot,
    q: Sequence[float],
    weights: Sequence[float] = (1.0, 1.0),
    *,
    region: bool = True,
) -> dict[str, Any]:
    """Return facts about a configuration; for two joints with its component and nearest boundary.

    Without the region, which may take long to find, the component and the boundary are None.

    Parameters
    ----------
    q : sequence of float
        One value a joint, rad or length.
    weights : sequence of two float
        Weights of the two joints in the distance to the boundary.
    """
    found = sorted(_margins(robot, q), key=lambda item: item[1])
    used = {boundary.name: boundary for boundary in robot.used}
    content: dict[str, Any] = {
        "q": list(q),
        "feasible": all(margin >= 0 for _, margin in found),
        "component": None,
        "components": None,
        "contains_home": None,
        "margins": [
            {"boundary": name, "margin": margin} | _nearest_features(robot, used.get(name), q)
            for name, margin in found
        ],
        "nearest": None,
    }
    if region and len(robot.joints) == 2:
        content |= _place_content(find_region(robot), q, weights)
    return content


def is_formed(robot: Robot) -> bool:
    """Tell whether margins are taken from forms; if not, distances of balls are quicker."""
    return len(robot.joints) <= FORMED or any(map(bounds_bodies, robot.used))


def _margins(robot: Robot, q: Sequence[float]) -> list[tuple[str, float]]:
    """Return `margins` of one configuration, of many joints by distances: equal up to rounding."""
    if is_formed(robot):
        return margins(robot, q)
    from cspace.boundary.balls import Balls  # only for arms of many joints

    balls, limits = Balls.of(robot), margins(replace(robot, boundaries=()), q)
    return [*zip(balls.names, balls.margins(q).tolist(), strict=True), *limits]


def _nearest_features(
    robot: Robot, boundary: Boundary | None, q: Sequence[float]
) -> dict[str, Any]:
    """Return which corners and edges of two bodies are nearest, and where; else nothing."""
    if boundary is None or not bounds_bodies(boundary):
        return {}
    from cspace.boundary.separation import nearest_features  # only for robots with bodies

    near = nearest_features(robot, boundary, q)
    return {
        "between": list(near.names),
        "features": list(near.features),
        "places": near.places.tolist(),
        "distance": near.distance,
    }


def _place_content(region: Region, q: ArrayLike, weights: Sequence[float]) -> dict[str, Any]:
    if region.unresolved:
        return {"unresolved": list(region.unresolved)}
    where = region.component_of(q)
    nearest = None
    if any(component.loops for component in region.components):
        found = nearest_boundary(region, q, where, weights)
        nearest = {
            "q": found.q.tolist(),
            "boundary": found.boundary,
            **feature_content(found.feature),
            "component": found.component,
            "distance": found.distance,
            "weights": list(weights),
        }
    return {
        "component": where,
        "components": len(region.components),
        "contains_home": None if where is None else region.components[where].contains_home,
        "nearest": nearest,
    }


def feature_content(feature: str) -> dict[str, str]:
    """Return the features that touch, if known."""
    return {"feature": feature} if feature else {}
