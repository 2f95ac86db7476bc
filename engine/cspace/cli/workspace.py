"""``cspace workspace``: the exact geometric workspace, postures of a place, passages."""

import argparse
from typing import Any

from cspace.arms.links import unchecked_lines
from cspace.cli import chosen
from cspace.cli.terminal import Output, complain, deliver
from cspace.cli.values import held, place, pose
from cspace.export.document import workspace_document, workspace_lines
from cspace.export.formats import json_text
from cspace.figures.pictures import workspace_picture
from cspace.region import NoHomeError
from cspace.workspace.areas import workspace_report


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "workspace",
        help="the exact geometric workspace",
        epilog="exit status: 0 done, 1 home, a place or the passage asked for is not feasible;\n"
        "3 the region is unresolved; 2 bad input\n"
        "example: cspace workspace minervabot-v2 --at=-20,40",
    )
    chosen.add_robot(parser)
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the workspace")
    chosen.add_slice(parser)
    parser.add_argument(
        "--at",
        action="append",
        default=[],
        metavar="X,Z",
        help="list the postures of a place: -20,40 or -20cm,40cm",
    )
    parser.add_argument(
        "--go", nargs=2, metavar="Q1,Q2", help="can the arm go from the one pose to the other?"
    )
    chosen.add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Compute the workspace; return 1 if home, or a requested place or passage, is not feasible."""
    robot = chosen.sized_robot(options)
    values = held(robot, options.slice)
    places = [place(robot, text) for text in options.at]
    poses = [pose(robot, robot.free(values), text) for text in options.go or ()]
    region = chosen.region_of(robot, values)
    try:
        found = workspace_report(region, places, poses)
    except NoHomeError as reason:
        for line in chosen.home_lines(region):
            complain(line)
        complain(f"{reason}; cspace draw shows both, and a robot file may name another home")
        return 1
    outputs: list[Output] = [
        (options.svg, lambda: workspace_picture(found.workspace, robot.length_unit)),
        (options.json, lambda: json_text(workspace_document(found))),
    ]
    deliver(outputs, [*workspace_lines(found), *unchecked_lines(robot)])
    return 0 if found.all_safe else 1
