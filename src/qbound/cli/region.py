"""``qbound region``: all regions of two joints, on the screen, as JSON, as a picture."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from qbound import __version__, paper_rule
from qbound.cli.values import held, write_text, write_whole
from qbound.region import Component, Region, find_region, solve, violated
from qbound.robot import Robot
from qbound.robotfile import load_robot


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "region",
        help="all regions of two joints",
        epilog="example: qbound region minervabot-v2 --json -",
    )
    parser.add_argument("robot", help="a robot file, or a packaged robot's name")
    parser.add_argument("--rule", choices=("clearance", "paper"), default="clearance")
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the components")
    parser.add_argument(
        "--slice", nargs="+", default=[], metavar="q3=20deg", help="hold joints at values"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Find the region; 1 if the home pose is not in it."""
    robot = load_robot(options.robot)
    values = held(robot, options.slice)
    region = region_by_rule(robot, options.rule, values)
    content = region_content(robot, region, options.rule, values)
    if options.svg:
        _draw(options.svg, region, content["joints"], robot.length_unit)
    if options.json:
        write_text(options.json, json.dumps(content, indent=1) + "\n")
    if options.json != "-":
        _say(region, content)
    return 0 if content["home"]["feasible"] else 1


def region_by_rule(robot: Robot, rule: str, values: dict[int, float]) -> Region:
    """Find the region by the clearance rule or by the paper's."""
    if rule == "clearance":
        return find_region(robot, values)
    if values:
        raise ValueError("--slice: the paper's rule knows two joints only")
    return solve(paper_rule.problem(robot), robot.home)


def region_content(
    robot: Robot, region: Region, rule: str, values: dict[int, float]
) -> dict[str, Any]:
    """Return the JSON form of a region, schema qbound/region/1."""
    q = np.array(robot.home)
    q[list(values)] = list(values.values())
    found = violated(robot, q)
    feasible = region.home is not None if rule == "paper" else not found
    return {
        "schema": "qbound/region/1",
        "robot": robot.name,
        "version": __version__,
        "rule": rule,
        "joints": [joint.name for j, joint in enumerate(robot.joints) if j not in values],
        "home_component": None if region.home is None else 0,
        "feasible_area": region.area,
        "home": {
            "q": q.tolist(),
            "feasible": feasible,
            "violated": [{"boundary": name, "margin": margin} for name, margin in found],
        },
        "components": [_component_content(component) for component in region.components],
        "workspace": None,
        "workspace_reason": "this version does not compute the exact workspace",
    }


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
        "loops": [
            {
                "arcs": [
                    {
                        "boundary": arc.boundary,
                        "branch": arc.branch,
                        "from": arc.points[0].tolist(),
                        "to": arc.points[-1].tolist(),
                    }
                    for arc in loop
                ]
            }
            for loop in component.loops
        ],
    }


def _say(region: Region, content: dict[str, Any]) -> None:
    for violation in content["home"]["violated"]:
        print(f"home violates {violation['boundary']}, margin {violation['margin']:.6g}")
    print(f"{len(region.components)} components, area {region.area:.9g} in all")
    for component in region.components:
        home = ", with the home pose" if component.contains_home else ""
        vertices = len(component.vertices)
        print(f"  area {component.area:.9g}, {vertices} vertices{home}")


def _draw(file: str, region: Region, joints: Sequence[str], unit: str) -> None:
    from qbound.figures import save_region

    write_whole(file, lambda draft: save_region(draft, region, joints, unit))
