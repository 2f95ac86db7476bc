"""Facts about one configuration, as plain data for JSON, with few imports."""

from collections.abc import Sequence
from typing import Any

from numpy.typing import ArrayLike

from cspace.boundary.poses import bounds_bodies
from cspace.export.formats import pose_heading
from cspace.measures.nearest import nearest_boundary
from cspace.model.robot import Robot
from cspace.order import ordered_by
from cspace.region import Region, find_region, margins
from cspace.tolerances import TIED


def configuration_document(robot: Robot, facts: dict[str, Any]) -> dict[str, Any]:
    """Return the facts of `configuration_facts` as data for JSON, schema qbound/contains/1."""
    return {**pose_heading("qbound/contains/1", robot), **facts}


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
    found = ordered_by(margins(robot, q), [lambda row: (row[1], TIED * abs(row[1]))])
    content: dict[str, Any] = {
        "q": list(q),
        "feasible": all(margin >= 0 for _, margin in found),
        "component": None,
        "components": None,
        "contains_home": None,
        "margins": [_margin_content(robot, q, name, margin) for name, margin in found],
        "nearest": None,
    }
    if region and len(robot.joints) == 2:
        content |= _place_content(find_region(robot), q, weights)
    return content


def _margin_content(robot: Robot, q: Sequence[float], name: str, margin: float) -> dict[str, Any]:
    """Return a margin; for bodies also which of their corners and edges are nearest, and where."""
    content: dict[str, Any] = {"boundary": name, "margin": margin}
    boundary = next((each for each in robot.used if each.name == name), None)
    if boundary is None or not bounds_bodies(boundary):
        return content
    from cspace.boundary.separation import nearest_features  # only for robots with bodies

    near = nearest_features(robot, boundary, q)
    return content | {
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
