"""``qbound workspace``: the exact geometric workspace, postures of a place, passages."""

from __future__ import annotations

import argparse
import sys
from typing import Any

from qbound import __version__
from qbound.cli.chosen import add_robot, add_rule, add_slice, region_by_rule
from qbound.cli.values import Content, check_targets, held, joint_value, json_text, shown, write_all
from qbound.export.document import loop_content
from qbound.model.robot import Robot
from qbound.model.robotfile import load_robot
from qbound.workspace.areas import NoHomeError, Workspace, find_workspace, overlap
from qbound.workspace.passage import Passage, find_passage
from qbound.workspace.planar import planar_arm


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "workspace",
        help="the exact geometric workspace",
        epilog="example: qbound workspace minervabot-v2 --rule paper --at=-20,40",
    )
    add_robot(parser)
    add_rule(parser)
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the workspace")
    add_slice(parser)
    parser.add_argument(
        "--at", action="append", default=[], metavar="X,Z", help="list the postures of a place"
    )
    parser.add_argument(
        "--go", nargs=2, metavar="Q1,Q2", help="can the arm go from the one pose to the other?"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Compute the workspace; 1 if home, a place or a passage that was asked for is not safe."""
    robot = load_robot(options.robot)
    files = [file for file in (options.svg, options.json) if file]
    check_targets(files)
    values = held(robot, options.slice)
    free = robot.free(values)
    places = [_place(text) for text in options.at]
    poses = [_pose(robot, free, text) for text in options.go or ()]
    arm, home = planar_arm(robot, values), robot.home[free]
    problem = region_by_rule(robot, options.rule, values).problem
    try:
        workspace = find_workspace(arm, problem, home)
    except NoHomeError as reason:
        print(f"qbound: {reason}", file=sys.stderr)
        return 1
    square = robot.joints[free[0]].limits, robot.joints[free[1]].limits
    content = {
        "schema": "qbound/workspace/1",
        "robot": robot.name,
        "version": __version__,
        "rule": options.rule,
        "joints": [robot.joints[j].name for j in free],
        "length_unit": robot.length_unit,
        **_content(workspace, overlap(arm, problem, home, square)),
        "at": [_at_content(workspace, place) for place in places],
        "go": _go_content(find_passage(workspace.region, *poses)) if poses else None,
    }
    write_all(_outputs(options, workspace, content))
    if "-" not in files:
        _say(content, robot, free)
    unsafe = any(not place["safe_postures"] for place in content["at"])
    return 1 if unsafe or (content["go"] and not content["go"]["possible"]) else 0


def _outputs(
    options: argparse.Namespace, workspace: Workspace, content: dict[str, Any]
) -> list[tuple[str, Content]]:
    outputs = list[tuple[str, Content]]()
    if options.svg:
        from qbound.figures.pictures import workspace_picture

        outputs.append((options.svg, workspace_picture(workspace, content["length_unit"])))
    if options.json:
        outputs.append((options.json, json_text(content)))
    return outputs


def _content(workspace: Workspace, mixed: float) -> dict[str, Any]:
    return {
        "plane": workspace.arm.axes.tolist(),
        "workspace": {
            "area": workspace.area,
            "covered_twice": workspace.covered_twice,
            "sides": {f"{side:+d}": area for side, area in workspace.sides.items()},
            "safe_and_unsafe": mixed,
        },
        "aspects": [
            {
                "component": aspect.component,
                "side": aspect.side,
                "image": aspect.image,
                "swept": aspect.swept,
                "loops": [loop_content(loop) for loop in aspect.region.loops],
            }
            for aspect in workspace.aspects
        ],
    }


def _at_content(workspace: Workspace, place: list[float]) -> dict[str, Any]:
    return {
        "place": place,
        "safe_postures": workspace.safe_postures(place),
        "postures": [
            {"q": posture.q.tolist(), "side": posture.side, "component": component}
            for posture, component in workspace.postures(place)
        ],
    }


def _go_content(passage: Passage) -> dict[str, Any]:
    left = passage.exit
    return {
        "possible": passage.possible,
        "components": [passage.start, passage.goal],
        "separated_by": [loop_content(loop) for loop in passage.loops],
        "straight_path_leaves": left and {"q": left.q.tolist(), "boundary": left.boundary},
    }


def _say(content: dict[str, Any], robot: Robot, free: list[int]) -> None:
    unit, found = content["length_unit"], content["workspace"]
    print(f"area {found['area']:.9g} {unit}^2, {found['covered_twice']:.9g} in both postures")
    print(f"reached both safely and not: {found['safe_and_unsafe']:.9g} {unit}^2")
    for aspect in content["aspects"]:
        print(f"  det J {'>' if aspect['side'] > 0 else '<'} 0: image {aspect['image']:.9g}")
    for place in content["at"]:
        x, z = place["place"]
        print(f"at ({x:g}, {z:g}): safe postures {place['safe_postures']}")
        for posture in place["postures"]:
            owner = posture["component"]
            state = "not safe" if owner is None else f"component {owner}"
            print(f"  {_shown(robot, free, posture['q'])}: {state}")
    if content["go"]:
        _say_go(content["go"], robot, free)


def _say_go(go: dict[str, Any], robot: Robot, free: list[int]) -> None:
    names = ["not safe" if k is None else f"component {k}" for k in go["components"]]
    print(f"go: {'yes' if go['possible'] else 'no'}, from {names[0]} to {names[1]}")
    loops = go["separated_by"]
    if loops:
        walls = dict.fromkeys(arc["boundary"] for loop in loops for arc in loop["arcs"])
        what = "the loop" if len(loops) == 1 else f"one of {len(loops)} loops"
        print(f"  every path crosses {what} of {', '.join(walls)}")
    if go["straight_path_leaves"]:
        place = go["straight_path_leaves"]
        where = _shown(robot, free, place["q"])
        print(f"  the straight path leaves at {where}, through {place['boundary']}")


def _shown(robot: Robot, free: list[int], q: list[float]) -> str:
    return ", ".join(shown(robot, j, value) for j, value in zip(free, q, strict=True))


def _place(text: str) -> list[float]:
    """Read ``X,Z``, lengths in the robot file's unit."""
    try:
        place = [float(number) for number in text.split(",")]
    except ValueError:
        place = []
    if len(place) != 2:
        raise ValueError(f"--at {text}: a place is two lengths, such as --at=-20,40")
    return place


def _pose(robot: Robot, free: list[int], text: str) -> list[float]:
    """Read ``Q1,Q2``: values of the joints that are not held."""
    numbers = text.split(",")
    if len(numbers) != len(free):
        raise ValueError(f"--go {text}: {len(free)} joint values are needed, as 20deg,-45deg")
    return [joint_value(robot, j, number) for j, number in zip(free, numbers, strict=True)]
