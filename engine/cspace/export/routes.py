"""Routes as a table, as a report in JSON (qbound/traverse/3), and in sentences."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

from cspace.arrays import Floats
from cspace.export.formats import csv_text, pose_columns, pose_heading
from cspace.model.robot import Robot
from cspace.paths.traversal import Margin, ParameterPoint, PathReport, Route
from cspace.tolerances import ON_BOUNDARY
from cspace.units import amount, counted, joint_text
from qbound.boundary import position


def route_csv(route: Route) -> str:
    """Return a row for each row of the path: joint values and the tool."""
    return path_csv(route.region.robot, route.path.q, route.path.tool)


def path_csv(robot: Robot, q: Floats, tool: Floats | None = None) -> str:
    """Return a row for each configuration, shape (k, n), rad or length: its values and the tool."""
    tool = position(robot, robot.tool)(q) if tool is None else tool
    rows = zip(q.tolist(), tool.tolist(), strict=True)
    return csv_text(pose_columns(robot), ([*values, *place] for values, place in rows))


def route_document(report: PathReport) -> dict[str, Any]:
    """Return the JSON form of a report."""
    route, path = report.route, report.route.path
    stops = zip(
        route.stops, path.q[path.stops].tolist(), path.tool[path.stops].tolist(), strict=True
    )
    return {
        **pose_heading("qbound/traverse/3", route.region.robot),
        "component": route.component,
        "order": list(route.order),
        "along": route.along,
        "scale": route.scale,
        "feasible": report.feasible,
        "stops": [{"name": name, "q": q, "tool": tool} for name, q, tool in stops],
        "rows": len(path.q),
        "deviation": {"value": path.deviation, "proved": path.proved},
        "plane": report.plane and ["xyz"[i] for i in report.plane],
        "self_crossings": None
        if report.crossings is None
        else [
            {"point": c.point.tolist(), "passes": [_place(route, x) for x in (c.first, c.second)]}
            for c in report.crossings
        ],
        "singular_crossings": None
        if report.singular is None
        else [_place(route, place) for place in report.singular],
        "margins": [
            {
                "boundary": least.boundary.name,
                "margin": least.value,
                "unit": least.boundary.unit,
                "at": _place(route, least.place),
                "leaves": least.leaves and _place(route, least.leaves),
            }
            for least in report.margins
        ],
        "final": {
            "q": path.final_pose.tolist(),
            "tool": path.tool[-1].tolist(),
            "reach": float(path.reach[-1]),
        },
        "largest_reach": {"reach": report.largest_reach, "at": _place(route, report.farthest)},
    }


Labels = Mapping[str, str]
"""What boundaries are called, where that is not their names: several may be one, such as balls."""


def route_lines(report: PathReport, labels: Labels | None = None) -> Iterator[str]:
    """Yield sentences about a route and what it meets, in the units of the robot file."""
    route, path = report.route, report.route.path
    robot, unit = route.region.robot, route.region.robot.length_unit
    known = "at most" if path.proved else "measured"
    legs, rows = counted(len(path.legs), "leg"), counted(len(path.q), "row")
    yield f"{legs}: {', '.join(route.legs)}"
    yield f"{rows}; the tool's path deviates {path.deviation:.3g} {unit} ({known})"
    yield f"final pose: {joint_text(robot, path.final_pose)}"
    yield f"final tool: {_triple(path.tool[-1])} {unit}; reach {path.reach[-1]:.6g} {unit}"
    yield f"largest reach: {report.largest_reach:.6g} {unit}, {_where(route, report.farthest)}"
    for crossing in report.crossings or ():
        legs = f"{_where(route, crossing.first)} and {_where(route, crossing.second)}"
        yield f"the tool crosses its path at {_triple(crossing.point)} {unit}, {legs}"
    for place in report.singular or ():
        yield f"singular: {joint_text(robot, place.q)}, {_where(route, place)}"
    least, left = _worst(report, labels)
    for label, margin in least.items():
        where = _where(route, margin.place)
        yield f"smallest margin of {label}: {_margin_text(margin)}, {where}"
    for label, leaves in left.items():
        yield f"outside: {label} from {joint_text(robot, leaves.q)}, {_where(route, leaves)}"


def infeasible_line(report: PathReport, labels: Labels | None = None) -> str:
    """Return the sentence where a path leaves the region; it is always printed."""
    out = _worst(report, labels)[1]
    legs = dict.fromkeys(report.route.leg_of(place.s) for place in out.values())
    return f"the path is not feasible: it violates {'; '.join(out)}, first on {', '.join(legs)}"


def _worst(
    report: PathReport, labels: Labels | None
) -> tuple[dict[str, Margin], dict[str, ParameterPoint]]:
    """Return by label the least margin, and where the path first leaves what is feasible."""
    least, left = dict[str, Margin](), dict[str, ParameterPoint]()
    for margin in report.margins:
        label = (labels or {}).get(margin.boundary.name, margin.boundary.name)
        if label not in least or margin.value < least[label].value:
            least[label] = margin
        if margin.leaves is not None and (label not in left or margin.leaves.s < left[label].s):
            left[label] = margin.leaves
    return least, left


def _margin_text(least: Margin) -> str:
    """Write a margin with its unit, angles in degrees."""
    unit, rounding = least.boundary.unit, ON_BOUNDARY * least.boundary.scale
    if unit == "rad":
        return amount(math.degrees(least.value), "deg", math.degrees(rounding))
    return amount(least.value, unit, rounding)


def _place(route: Route, place: ParameterPoint) -> dict[str, Any]:
    return {"leg": route.leg_of(place.s), "q": place.q.tolist()}


def _where(route: Route, place: ParameterPoint) -> str:
    return f"on {route.leg_of(place.s)}"


def _triple(place: Floats) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in place) + ")"
