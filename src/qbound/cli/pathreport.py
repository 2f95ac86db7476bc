"""What a path meets, gathered for ``qbound traverse``; as JSON, schema qbound/traverse/1."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import Any

import numpy as np

from qbound.cli.route import Route
from qbound.cli.values import heading
from qbound.model.robot import Robot
from qbound.paths.encounters import (
    Boundary,
    Crossing,
    Margin,
    Place,
    boundaries,
    least_margin,
    plane_of_motion,
    singular_crossings,
    stated_boundaries,
    tool_crossings,
)


@dataclass(frozen=True, eq=False)
class Report:
    """Crossings (None where the tool keeps to no plane), margins, and the largest reach."""

    plane: tuple[int, int] | None
    crossings: list[Crossing] | None
    singular: list[Place] | None
    margins: list[Margin]
    farthest: float
    farthest_at: Place

    @property
    def feasible(self) -> bool:
        """Whether the path keeps every boundary."""
        return all(margin.leaves is None for margin in self.margins)


def report(robot: Robot, way: Route, rule: str) -> Report:
    """Look along the path."""
    plane, walk = plane_of_motion(robot), way.walk
    if rule == "clearance":
        bounds = boundaries(robot)
    else:
        bounds = stated_boundaries(robot, way.region.problem)
    crossings = None if plane is None else tool_crossings(robot, walk, plane)
    singular = singular_crossings(robot, walk, way.held)
    far = least_margin(walk, _short_of(robot))
    return Report(
        plane,
        crossings,
        singular,
        [least_margin(walk, boundary) for boundary in bounds],
        -far.value,
        far.place,
    )


def report_content(
    robot: Robot, way: Route, found: Report, options: argparse.Namespace
) -> dict[str, Any]:
    """Return the JSON form of a traversal."""
    walk, plane = way.walk, found.plane
    return {
        **heading("qbound/traverse/1", robot, options.rule),
        "component": options.component,
        "order": options.order,
        "along": "arcs" if options.arcs else "lines",
        "scale": options.scale,
        "feasible": found.feasible,
        "stops": [
            {"name": name, "q": walk.q[row].tolist(), "tool": walk.tool[row].tolist()}
            for name, row in zip(way.stops, walk.stops, strict=True)
        ],
        "rows": len(walk.q),
        "deviation": {"value": walk.deviation, "proved": walk.proved},
        "plane": None if plane is None else ["xyz"[i] for i in plane],
        "self_crossings": None
        if found.crossings is None
        else [
            {
                "point": crossing.point.tolist(),
                "passes": [_place(way, place) for place in (crossing.first, crossing.second)],
            }
            for crossing in found.crossings
        ],
        "singular_crossings": None
        if found.singular is None
        else [_place(way, place) for place in found.singular],
        "margins": [
            {
                "boundary": margin.boundary.name,
                "margin": margin.value,
                "unit": margin.boundary.unit,
                "at": _place(way, margin.place),
                "leaves": None if margin.leaves is None else _place(way, margin.leaves),
            }
            for margin in found.margins
        ],
        "final": {
            "q": walk.final_pose.tolist(),
            "tool": walk.tool[-1].tolist(),
            "reach": float(walk.reach[-1]),
        },
        "largest_reach": {"reach": found.farthest, "at": _place(way, found.farthest_at)},
    }


def _place(way: Route, place: Place) -> dict[str, Any]:
    return {"leg": way.leg_of(place.s), "q": place.q.tolist()}


def _short_of(robot: Robot) -> Boundary:
    """Minus the reach: its least value is the largest reach."""

    def minus_reach(q: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        frames = robot.frames(q)
        shoulder = robot.joints[0].frame
        away = frames.position(robot.base, robot.tool, robot.base)
        away = away - frames.position(robot.base, shoulder, robot.base)
        return np.asarray(-np.linalg.norm(away, axis=-1))

    return Boundary("reach", robot.length_unit, minus_reach, np.inf)
