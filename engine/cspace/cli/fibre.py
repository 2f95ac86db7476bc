"""``cspace fibre``: tell how far one joint may move while the others stay where they are."""

import argparse
from typing import Any

from cspace.arms.fibres import fibre_document, fibre_lines, fibres
from cspace.cli.chosen import add_robot
from cspace.cli.terminal import deliver
from cspace.cli.values import configuration, joint
from cspace.export.formats import json_text
from cspace.model.robotfile import load_robot


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "fibre",
        help="how far may one joint move, the others held? exactly, and what ends it",
        description="Print every interval in which a joint may be while the others are held, and\n"
        "the boundary or limit that ends it on either side. For any number of joints, of arms\n"
        "of points and balls; of bodies in a plane, cspace region has what ends either joint.",
        epilog="exit status: 0 listed, 1 the joint may be nowhere; 2 bad input\n"
        "example: cspace fibre minervabot-v2 q2 20deg -45deg",
    )
    add_robot(parser)
    parser.add_argument("joint", metavar="JOINT", help="the joint that moves, by name or index")
    parser.add_argument(
        "values",
        nargs="*",
        metavar="VALUE",
        help="a value for each joint, 20deg, 0.35rad, a length; default: home",
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print the intervals; return 1 if no value of the joint is feasible."""
    robot = load_robot(options.robot)
    q = configuration(robot, options.values) if options.values else robot.home.tolist()
    found = fibres(robot, joint(robot, options.joint), q)
    document = (options.json, lambda: json_text(fibre_document(found, q)))
    deliver([document], fibre_lines(found, q))
    return 0 if found[0] else 1
