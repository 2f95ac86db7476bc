"""The command ``qbound``: thin commands on the library, angles in radians on the way out."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from qbound import __version__, paper_rule
from qbound.region import Component, Region, find_region, solve, violated
from qbound.robot import Robot
from qbound.robotfile import load_robot, packaged_robots

EXAMPLES = {
    "region": "example: qbound region minervabot-v2 --json -",
    "contains": "example: qbound contains minervabot-v2 20deg -45deg",
    "robots": "example: qbound robots show minervabot-v2",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 done, 1 infeasible, 2 bad input."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.run(options))
    except (ValueError, OSError, ImportError) as error:
        print(f"qbound: {error}", file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="qbound", description="Feasible workspaces of robots.")
    parser.add_argument("--version", action="version", version=f"qbound {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    region = commands.add_parser(
        "region", help="all regions of two joints", epilog=EXAMPLES["region"]
    )
    region.add_argument("robot", help="a robot file, or a packaged robot's name")
    region.add_argument("--rule", choices=("clearance", "paper"), default="clearance")
    region.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    region.add_argument("--svg", metavar="FILE", help="draw the components")
    region.add_argument(
        "--slice", nargs="+", default=[], metavar="q3=20deg", help="hold joints at values"
    )
    region.set_defaults(run=_region)

    contains = commands.add_parser(
        "contains", help="is a configuration safe?", epilog=EXAMPLES["contains"]
    )
    contains.add_argument("robot")
    contains.add_argument("values", nargs="+", metavar="VALUE", help="20deg, 0.35rad, or a length")
    contains.set_defaults(run=_contains)

    robots = commands.add_parser("robots", help="the packaged robots", epilog=EXAMPLES["robots"])
    robots.add_argument("show", nargs="?", choices=("show",))
    robots.add_argument("name", nargs="?")
    robots.set_defaults(run=_robots)
    return parser


# --- commands -------------------------------------------------------------------------------------


def _region(options: argparse.Namespace) -> int:
    robot = load_robot(options.robot)
    held = _held(robot, options.slice)
    if options.rule == "paper":
        if held:
            raise ValueError("--slice: the paper's rule knows two joints only")
        region = solve(paper_rule.problem(robot), robot.home)
    else:
        region = find_region(robot, held)
    content = _region_content(robot, region, options.rule, held)
    text = json.dumps(content, indent=1) + "\n"
    if options.svg:
        _draw(options.svg, region, content["joints"], robot.length_unit)
    if options.json == "-":
        print(text, end="")
    else:
        if options.json:
            _write(options.json, text)
        _say_region(region, content)
    return 0 if content["home"]["feasible"] else 1


def _contains(options: argparse.Namespace) -> int:
    robot = load_robot(options.robot)
    if len(options.values) != len(robot.joints):
        names = ", ".join(joint.name for joint in robot.joints)
        raise ValueError(f"{len(options.values)} values for {len(robot.joints)} joints: {names}")
    q = [_value(robot, j, text) for j, text in enumerate(options.values)]
    found = violated(robot, q)
    for name, margin in found:
        print(f"violated: {name}, margin {margin:.6g}")
    if not found:
        print("feasible")
    return 1 if found else 0


def _robots(options: argparse.Namespace) -> int:
    if options.show is None:
        print("\n".join(packaged_robots()))
        return 0
    if options.name not in packaged_robots():
        raise ValueError(f"no robot {options.name!r}; there are {', '.join(packaged_robots())}")
    file = resources.files("qbound") / "robots" / f"{options.name}.toml"
    print(file.read_text(encoding="utf-8"), end="")
    return 0


# --- values in ------------------------------------------------------------------------------------


def _held(robot: Robot, texts: Sequence[str]) -> dict[int, float]:
    names = [joint.name for joint in robot.joints]
    held = {}
    for text in texts:
        name, _, value = text.partition("=")
        if name not in names:
            raise ValueError(f"--slice {text}: no joint {name!r}; there are {', '.join(names)}")
        held[names.index(name)] = _value(robot, names.index(name), value)
    return held


def _value(robot: Robot, j: int, text: str) -> float:
    """Read a joint value: with deg or rad, or a plain number in the robot file's own unit."""
    revolute = robot.joints[j].kind == "revolute"
    number, unit = text, robot.angle_unit if revolute else robot.length_unit
    for suffix in ("deg", "rad"):
        if revolute and text.endswith(suffix):
            number, unit = text.removesuffix(suffix), suffix
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{robot.joints[j].name}: {text!r} is no value, such as 20deg or 0.35rad")
    return math.radians(value) if unit == "deg" else value


# --- results out ----------------------------------------------------------------------------------


def _region_content(
    robot: Robot, region: Region, rule: str, held: dict[int, float]
) -> dict[str, Any]:
    """Return the JSON form of a region, schema qbound/region/1."""
    q = np.array(robot.home)
    q[list(held)] = list(held.values())
    found = violated(robot, q)
    feasible = region.home is not None if rule == "paper" else not found
    return {
        "schema": "qbound/region/1",
        "robot": robot.name,
        "version": __version__,
        "rule": rule,
        "joints": [joint.name for j, joint in enumerate(robot.joints) if j not in held],
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


def _say_region(region: Region, content: dict[str, Any]) -> None:
    for violation in content["home"]["violated"]:
        print(f"home violates {violation['boundary']}, margin {violation['margin']:.6g}")
    print(f"{len(region.components)} components, area {region.area:.9g} in all")
    for component in region.components:
        home = ", with the home pose" if component.contains_home else ""
        vertices = len(component.vertices)
        print(f"  area {component.area:.9g}, {vertices} vertices{home}")


def _write(file: str, text: str) -> None:
    """Write a file whole or not at all."""
    target = Path(file)
    draft = target.with_name(target.name + ".part")
    draft.write_text(text, encoding="utf-8")
    draft.replace(target)


def _draw(file: str, region: Region, joints: Sequence[str], unit: str) -> None:
    from qbound.figures import save_region

    target = Path(file)
    draft = target.with_name(target.name + ".part")
    save_region(draft, region, joints, unit)
    draft.replace(target)
