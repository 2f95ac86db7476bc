"""``cspace draw``: the joint-space region beside the robot in a pose."""

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from cspace.arms.fibres import by_links
from cspace.boundary.evaluator import violated
from cspace.cli import chosen
from cspace.cli.terminal import check_targets, complain, say, write_all
from cspace.cli.values import configuration, held
from cspace.figures import drawn_plane
from cspace.figures.pictures import pose_picture
from cspace.files import refuse_replacing
from cspace.paths.traversal import nth_component, plane_of_motion


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "draw",
        help="a picture of the region and of the robot",
        description="Draw the region of two joints, vertices numbered, and the robot in a pose.",
        epilog="exit status: 0 drawn, 3 the region is unresolved; 2 bad input\n"
        "example: cspace draw minervabot-v2 -o arm.svg --q 20deg -45deg",
    )
    chosen.add_robot(parser)
    parser.add_argument(
        "-o", metavar="FILE", dest="output", help=".svg or .png; default: the robot's name, .svg"
    )
    parser.add_argument("--q", nargs="+", metavar="VALUE", help="the pose; default: home")
    parser.add_argument("--region", action="store_true", help="the region alone")
    parser.add_argument("--robot", action="store_true", dest="arm", help="the robot alone")
    parser.add_argument(
        "--component", type=int, default=0, metavar="K", help="number the vertices of this one"
    )
    chosen.add_slice(parser)
    chosen.add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Draw the picture and say where it is."""
    robot = chosen.sized_robot(options)
    output = f"{Path(options.robot).stem}.svg" if options.output is None else options.output
    check_targets([output], ("svg", "png"))
    refuse_replacing(output)
    values = held(robot, options.slice)
    q = robot.home if options.q is None else np.array(configuration(robot, options.q))
    q = robot.with_held(q[robot.free(values)], values)
    both, kind = options.region == options.arm, Path(output).suffix.removeprefix(".").lower()
    region = plane = numbered = None
    if both or options.region:
        region = chosen.region_of(robot, values)
        numbered = nth_component(region, options.component) if region.components else None
    if both or options.arm:
        plane = plane_of_motion(robot) or drawn_plane(robot)
    write_all([(output, pose_picture(robot, q, region, plane, kind, numbered))])
    if names := by_links(robot, [name for name, _ in violated(robot, q)]):
        complain(f"the pose that is drawn is not feasible: it violates {'; '.join(names)}")
    say(f"written: {output}")
    return 0
