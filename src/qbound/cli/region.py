"""``qbound region``: all regions of two joints, on the screen, as JSON, polygons, a picture."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import cache, partial
from typing import Any

from qbound import __version__
from qbound.cli.chosen import add_robot, add_rule, add_slice, region_by_rule
from qbound.cli.files import Output, check_targets, write_asked
from qbound.cli.values import held
from qbound.export.document import loop_content
from qbound.export.formats import json_text
from qbound.export.outlines import (
    find_outlines,
    outlines_csv,
    outlines_geojson,
    outlines_npz,
)
from qbound.model.robot import Robot
from qbound.model.robotfile import load_robot
from qbound.model.units import joint_units
from qbound.region.region import Component, Region, violated
from qbound.workspace.areas import NoHomeError, find_workspace
from qbound.workspace.planar import NoPlanarWorkspaceError, planar_arm


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "region",
        help="all regions of two joints",
        epilog="example: qbound region minervabot-v2 --json -",
    )
    add_robot(parser)
    add_rule(parser)
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the components")
    parser.add_argument("--csv", metavar="FILE", help="write polygons, a row a corner")
    parser.add_argument("--geojson", metavar="FILE", help="write polygons as GeoJSON has them")
    parser.add_argument("--npz", metavar="FILE", help="write polygons as NumPy arrays")
    parser.add_argument(
        "--deviation",
        type=float,
        default=0.001,
        metavar="D",
        help="largest distance of polygons from the exact arcs, joint units (default 0.001)",
    )
    add_slice(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Find the region; 1 if the home pose is not in it."""
    robot = load_robot(options.robot)
    files = [options.svg, options.csv, options.geojson, options.npz, options.json]
    check_targets(files)
    values = held(robot, options.slice)
    region = region_by_rule(robot, options.rule, values)
    content = region_content(robot, region, options.rule, values)
    write_asked(_outputs(options, robot, region, content, values))
    if "-" not in files:
        _say(region, content, joint_units(robot, robot.free(values)))
    return 0 if content["home"]["feasible"] else 1


def _outputs(
    options: argparse.Namespace,
    robot: Robot,
    region: Region,
    content: dict[str, Any],
    values: dict[int, float],
) -> list[Output]:
    """Make what was asked for; files in the order in which they are named here."""
    free = robot.free(values)
    drawn = cache(partial(find_outlines, robot, region, free, options.deviation))
    return [
        (options.svg, lambda: _draw(robot, content["home"]["q"], region, free)),
        (options.csv, lambda: outlines_csv(drawn())),
        (options.geojson, lambda: json_text(outlines_geojson(drawn()), None)),
        (options.npz, lambda: outlines_npz(drawn())),
        (options.json, lambda: json_text(content)),
    ]


def region_content(
    robot: Robot, region: Region, rule: str, values: dict[int, float]
) -> dict[str, Any]:
    """Return the JSON form of a region, schema qbound/region/1."""
    free = robot.free(values)
    q = robot.with_held(robot.home[free], values)
    found = violated(robot, q)
    feasible = region.home is not None if rule == "paper" else not found
    return {
        "schema": "qbound/region/1",
        "robot": robot.name,
        "version": __version__,
        "rule": rule,
        "joints": [robot.joints[j].name for j in free],
        "home_component": None if region.home is None else 0,
        "feasible_area": region.area,
        "home": {
            "q": q.tolist(),
            "feasible": feasible,
            "violated": [{"boundary": name, "margin": margin} for name, margin in found],
        },
        "components": [_component_content(component) for component in region.components],
        **_workspace_content(robot, region, values),
    }


def _workspace_content(robot: Robot, region: Region, values: dict[int, float]) -> dict[str, Any]:
    """Return the workspace of the home component, or the reason why there is none."""
    home = robot.home[robot.free(values)]
    try:
        found = find_workspace(planar_arm(robot, values), region.problem, home)
    except (NoPlanarWorkspaceError, NoHomeError) as reason:
        return {"workspace": None, "workspace_reason": str(reason)}
    return {"workspace": {"area": found.area, "covered_twice": found.covered_twice}}


def _component_content(component: Component) -> dict[str, Any]:
    return {
        "contains_home": component.contains_home,
        "area": component.area,
        "centroid": None if component.centroid is None else component.centroid.tolist(),
        "wraps": list(component.wraps),
        "vertices": [
            {"q": vertex.q.tolist(), "boundaries": list(vertex.boundaries)}
            for vertex in component.vertices
        ],
        "loops": [loop_content(loop) for loop in component.loops],
    }


def _say(region: Region, content: dict[str, Any], units: Sequence[str]) -> None:
    unit = f"{units[0]}^2" if units[0] == units[1] else " ".join(units)
    for violation in content["home"]["violated"]:
        print(f"home violates {violation['boundary']}, margin {violation['margin']:.6g}")
    print(f"{len(region.components)} components, area {region.area:.9g} {unit} in all")
    for component in region.components:
        home = ", with the home pose" if component.contains_home else ""
        vertices = len(component.vertices)
        print(f"  area {component.area:.9g} {unit}, {vertices} vertices{home}")


def _draw(robot: Robot, q: Sequence[float], region: Region, free: Sequence[int]) -> bytes:
    from qbound.figures.pictures import Chart, pose_picture

    numbered = region.components[0] if region.components else None
    return pose_picture(robot, q, Chart(region, (free[0], free[1]), numbered), None)
