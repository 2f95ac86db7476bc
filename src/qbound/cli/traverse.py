"""``qbound traverse``: vertices or arcs in an order; what the path meets; the path as files."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from qbound.cli import route
from qbound.cli.chosen import add_robot, add_rule, add_slice
from qbound.cli.pathreport import Report, report, report_content
from qbound.cli.route import Route
from qbound.cli.values import (
    Content,
    check_targets,
    csv_text,
    joint_units,
    json_text,
    shown,
    write_all,
)
from qbound.model.robot import Robot
from qbound.model.robotfile import load_robot
from qbound.paths.trajectory import (
    Trajectory,
    joint_speeds,
    lasting,
    ros_trajectory,
    row_times,
    stretched,
    timed,
)
from qbound.paths.traversal import Traversal


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "traverse",
        help="visit vertices or arcs of a region in an order",
        description="Visit vertices of a component along straight lines in joint space, or follow\n"
        "its arcs. Vertices and arcs count from 1; `qbound draw` shows the numbers of vertices.",
        epilog="example: qbound traverse minervabot-v2 1 2 3 4 5 6 --scale 0.9 --csv path.csv\n"
        "example: qbound traverse minervabot-v2 --arcs 4 -1 --svg path.svg",
    )
    add_robot(parser)
    parser.add_argument("order", nargs="+", type=int, metavar="ORDER", help="numbers, from 1")
    add_rule(parser)
    parser.add_argument(
        "--component", type=int, default=0, metavar="K", help="from 0, as in the JSON (default 0)"
    )
    parser.add_argument(
        "--arcs",
        action="store_true",
        help="numbers are of arcs; -2 runs arc 2 backwards; lines join arcs that do not meet",
    )
    parser.add_argument("--closed", action="store_true", help="return to the start")
    parser.add_argument(
        "--scale", type=float, default=1.0, metavar="S", help="of the vertices, about the centroid"
    )
    add_slice(parser)
    parser.add_argument(
        "--deviation", type=float, metavar="D",
        help="largest distance of the tool's path from its rows, length (default: 1e-4 of the arm)",
    )  # fmt: skip
    parser.add_argument(
        "--speed-scale", type=float, default=1.0, metavar="F", help="part of the joints' velocities"
    )
    parser.add_argument("--duration", type=float, metavar="T", help="seconds for the whole path")
    parser.add_argument("--csv", metavar="FILE", help="write time, joints and tool")
    parser.add_argument("--ros", metavar="FILE", help="write the points of a ROS JointTrajectory")
    parser.add_argument("--json", metavar="FILE", help="write the report; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the path")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Go along the path; 1 if it leaves the region."""
    files = [options.csv, options.ros, options.svg, options.json]
    check_targets([file for file in files if file])
    robot = load_robot(options.robot)
    way = route.plan(robot, options)
    times = _in_time(robot, way.walk, options)
    found = report(robot, way, options.rule)
    write_all(_outputs(options, robot, way, times, found))
    if "-" not in files:
        _say(robot, way, times, found)
    return 0 if found.feasible else 1


def _in_time(robot: Robot, walk: Traversal, options: argparse.Namespace) -> Trajectory | None:
    """Time the path; None where nothing asks for times and the file states no velocities."""
    if not 0 < options.speed_scale <= 1:
        raise ValueError(f"--speed-scale {options.speed_scale:g}: above 0, at most 1")
    if options.duration is not None:
        if options.speed_scale != 1:
            raise ValueError("--duration and --speed-scale: the one decides the other")
        return lasting(robot, walk, options.duration)
    if options.ros is None and any(joint.velocity is None for joint in robot.joints):
        return None
    return stretched(timed(walk, joint_speeds(robot)), 1 / options.speed_scale)


def _outputs(
    options: argparse.Namespace, robot: Robot, way: Route, times: Trajectory | None, found: Report
) -> list[tuple[str, Content]]:
    outputs = list[tuple[str, Content]]()
    if options.csv:
        outputs.append((options.csv, _csv(robot, way.walk, times)))
    if options.ros and times is not None:
        outputs.append((options.ros, json.dumps(ros_trajectory(robot, times)) + "\n"))
    if options.svg:
        outputs.append((options.svg, _picture(robot, way, found.plane or (0, 2))))
    if options.json:
        content = report_content(robot, way, found, options)
        content["duration"] = None if times is None else float(times.t[-1])
        outputs.append((options.json, json_text(content)))
    return outputs


def _csv(robot: Robot, walk: Traversal, times: Trajectory | None) -> str:
    """Return a row for each row of the path; the time is empty where no velocity is known."""
    t = [""] * len(walk.q) if times is None else row_times(walk, times).tolist()
    units = zip(robot.joints, joint_units(robot), strict=True)
    header = ["t_s", *(f"{joint.name}_{unit}" for joint, unit in units)]
    header += [f"{axis}_{robot.length_unit}" for axis in "xyz"]
    rows = zip(t, walk.q.tolist(), walk.tool.tolist(), strict=True)
    return csv_text(header, ([time, *q, *tool] for time, q, tool in rows))


def _picture(robot: Robot, way: Route, plane: tuple[int, int]) -> bytes:
    from qbound.figures.pictures import Chart, traversal_picture

    first, second = robot.free(way.held)
    return traversal_picture(robot, Chart(way.region, (first, second)), way.walk, way.stops, plane)


def _say(robot: Robot, way: Route, times: Trajectory | None, found: Report) -> None:
    unit, walk = robot.length_unit, way.walk
    known = "at most" if walk.proved else "measured"
    print(f"{len(walk.legs)} legs: {', '.join(way.legs)}")
    print(f"{len(walk.q)} rows; the tool's path deviates {walk.deviation:.3g} {unit} ({known})")
    if times is not None:
        print(f"{times.t[-1]:.6g} s")
    print(f"final pose: {_pose(robot, walk.final_pose)}")
    print(f"final tool: {_triple(walk.tool[-1])} {unit}; reach {walk.reach[-1]:.6g} {unit}")
    print(f"largest reach: {found.farthest:.6g} {unit}, {way.where(found.farthest_at.s)}")
    for crossing in found.crossings or ():
        legs = " and ".join(way.where(place.s) for place in (crossing.first, crossing.second))
        print(f"the tool crosses its path at {_triple(crossing.point)} {unit}, {legs}")
    for place in found.singular or ():
        print(f"singular: {_pose(robot, place.q)}, {way.where(place.s)}")
    for margin in found.margins:
        text = f"smallest margin of {margin.boundary.name}: {margin.value:.6g} "
        print(f"{text}{margin.boundary.unit}, {way.where(margin.place.s)}")
    for margin in found.margins:
        if margin.leaves is not None:
            pose, where = _pose(robot, margin.leaves.q), way.where(margin.leaves.s)
            print(f"outside: {margin.boundary.name} from {pose}, {where}")


def _pose(robot: Robot, q: Sequence[float] | np.ndarray[Any, Any]) -> str:
    return ", ".join(shown(robot, j, float(value)) for j, value in enumerate(q))


def _triple(place: np.ndarray[Any, Any]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in place) + ")"
