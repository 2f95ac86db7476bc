"""``qbound contains``: tell whether a configuration is safe, by how much, and where it ends."""

from __future__ import annotations

import argparse
from typing import Any

from qbound.boundary.evaluator import limit_names
from qbound.cli.chosen import add_robot
from qbound.cli.files import write_text
from qbound.cli.values import configuration
from qbound.export.document import configuration_document
from qbound.export.formats import json_text
from qbound.model.robot import Joint, Robot
from qbound.model.robotfile import load_robot


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "contains",
        help="is a configuration safe, and by how much?",
        epilog="example: qbound contains minervabot-v2 20deg -45deg",
    )
    add_robot(parser)
    parser.add_argument("values", nargs="+", metavar="VALUE", help="20deg, 0.35rad, or a length")
    parser.add_argument(
        "--weights",
        nargs=2,
        type=float,
        default=[1.0, 1.0],
        metavar="W",
        help="weights of the two joints in the distance to the boundary (default 1 1)",
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Say what the configuration's margins are; 1 if any is negative."""
    robot = load_robot(options.robot)
    content = configuration_document(robot, configuration(robot, options.values), options.weights)
    if options.json:
        write_text(options.json, json_text(content))
    if options.json != "-":
        _say(robot, content)
    return 0 if content["feasible"] else 1


def _say(robot: Robot, content: dict[str, Any]) -> None:
    violated = [item for item in content["margins"] if item["margin"] < 0]
    for item in violated:
        print(f"violated: {item['boundary']}, margin {_amount(robot, item)}")
    if not violated:
        print("feasible" + _component(content))
    for item in content["margins"]:
        if item["margin"] >= 0:
            print(f"  margin {_amount(robot, item)}: {item['boundary']}")
    if content["nearest"]:
        print(_nearest_line(robot, content["nearest"]))


def _component(content: dict[str, Any]) -> str:
    if content["components"] is None:
        return ""
    if content["component"] is None:
        touched = [item["boundary"] for item in content["margins"] if item["margin"] == 0]
        return f", but in no component: it touches {', '.join(touched)}"
    home = "with the home pose" if content["contains_home"] else "without the home pose"
    numbered = f"component {content['component']} (of {content['components']}, counted from 0)"
    return f", in {numbered}, {home}"


def _amount(robot: Robot, item: dict[str, Any]) -> str:
    """Write a margin with its unit: a length, or that of a joint limit."""
    for joint in robot.joints:
        if item["boundary"] in limit_names(joint.name):
            return _joint_text(robot, joint, item["margin"])
    return f"{item['margin']:.6g} {robot.length_unit}"


def _joint_text(robot: Robot, joint: Joint, value: float) -> str:
    return f"{value * joint.shown_scale:.6g} {joint.unit(robot.length_unit, 'deg')}"


def _nearest_line(robot: Robot, nearest: dict[str, Any]) -> str:
    joints = robot.joints
    place = ", ".join(
        f"{joint.name} = {_joint_text(robot, joint, x)}"
        for joint, x in zip(joints, nearest["q"], strict=True)
    )
    distance = f"{nearest['distance']:.6g}"
    if nearest["weights"] == [1.0, 1.0] and joints[0].kind == joints[1].kind:
        distance = _joint_text(robot, joints[0], nearest["distance"])
    return f"nearest boundary: {nearest['boundary']} at {place}, distance {distance}"
