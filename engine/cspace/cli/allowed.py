"""``cspace allowed``: which links never meet and which always meet, proved for all joint values."""

from __future__ import annotations

import argparse
from typing import Any

from cspace.arms.allowed import (
    CELLS,
    Contact,
    allowed_collisions,
    allowed_document,
    allowed_lines,
    srdf_text,
)
from cspace.cli.chosen import add_robot
from cspace.cli.terminal import deliver, progress
from cspace.export.formats import json_text
from cspace.model.robotfile import load_robot


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "allowed",
        help="which links of an arm can never meet? proved, written as SRDF",
        description="Decide for every two links of an arm of balls, neighbours and pairs that no\n"
        "boundary names included, whether they are in contact never, always or sometimes, over\n"
        "all joint values within the limits. Of what is never nothing was sampled: it is proved.",
        epilog="exit status: 0 every pair is decided, 3 some are not; 2 bad input\n"
        "example: cspace allowed ur5 --srdf ur5-allowed.srdf",
    )
    add_robot(parser)
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument(
        "--srdf",
        metavar="FILE",
        dest="disabled",
        help="write disable_collisions; - for standard output",
    )
    parser.add_argument(
        "--adjacent",
        action="store_true",
        help="disable neighbours that meet sometimes, too: a planner then misses their fold",
    )
    parser.add_argument(
        "--cells",
        type=int,
        default=CELLS,
        metavar="N",
        help=f"cells for a pair of links before it is not decided (default {CELLS})",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Decide all pairs of links; return 0 if all pairs are decided, 3 if some are not."""
    if options.cells < 1:
        raise ValueError(f"--cells {options.cells}: 1 or more are wanted")
    robot = load_robot(options.robot)
    shown: Any = None

    def tell(done: int, total: int) -> None:
        nonlocal shown
        shown = shown or progress("pairs of links", total)
        shown(done)

    found = allowed_collisions(robot, cells=options.cells, tell=tell)
    document = (options.json, lambda: json_text(allowed_document(robot, found)))
    srdf = (options.disabled, lambda: srdf_text(robot, found, neighbours=options.adjacent))
    deliver([document, srdf], allowed_lines(robot, found))
    return 3 if any(each.contact is Contact.UNDECIDED for each in found) else 0
