"""``qbound connected``: prove that one can move from one pose to another, or that one cannot."""

from __future__ import annotations

import argparse
from typing import Any

from qbound.cli.chosen import add_robot
from qbound.cli.files import deliver
from qbound.cli.progress import working
from qbound.cli.values import configuration
from qbound.export.formats import json_text
from qbound.model.robotfile import load_robot
from qbound.proofs.connection import connection
from qbound.proofs.exact import exact_problem, exact_robot
from qbound.proofs.reports import connection_document, connection_line

STATUS = {"connected": 0, "separated": 1, "infeasible": 1, "undecided": 3}


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "connected",
        help="can the arm go from one pose to another? proved either way",
        epilog="exit status: 0 connected, 1 separated, 3 undecided, 2 bad input\n"
        "example: qbound connected minervabot-v2 0deg 0deg 92deg -133deg",
    )
    add_robot(parser)
    parser.add_argument(
        "values", nargs="+", metavar="VALUE", help="both poses, one after the other: 20deg, 0.35rad"
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Prove it; 0 connected, 1 not, 3 undecided."""
    robot = load_robot(options.robot)
    n = len(robot.joints)
    if len(options.values) != 2 * n:
        raise ValueError(f"{len(options.values)} values; two poses of {n} joints have {2 * n}")
    one, other = (configuration(robot, options.values[k : k + n]) for k in (0, n))
    problem = exact_problem(exact_robot(options.robot))
    with working("looking for a passage"):
        found = connection(problem, one, other, line=True)
    document = (options.json, lambda: json_text(connection_document(robot, [one, other], found)))
    deliver([document], [connection_line(found)])
    return STATUS[found.answer]
