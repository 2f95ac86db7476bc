"""``cspace allowed``: which links never meet and which always meet, proved for all joint values."""

import argparse
from typing import Any

from cspace.arms import allowed
from cspace.cli.chosen import add_robot
from cspace.cli.terminal import deliver, progress_line
from cspace.export.formats import json_text
from cspace.model.robotfile import is_urdf, load_robot
from cspace.urdf.arm import balls_inside, import_urdf


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "allowed",
        help="which links of an arm can never meet? proved, written as SRDF",
        description="Prove of every two links of an arm of balls, neighbours and pairs that no\n"
        "boundary names included, that they meet never, over all joint values within the limits;\n"
        "of a URDF, whose shapes are known, also that they meet always. 'never' is proved, not\n"
        "sampled. Of other pairs the answer says what the spheres do that cover the links.",
        epilog="exit status: 0 it is decided what the spheres of every pair do, 3 of some it is\n"
        "not; 2 bad input\n"
        "needs cspace[arms] for a URDF\n"
        "example: cspace allowed ur5.urdf --srdf ur5-allowed.srdf",
    )
    add_robot(parser)
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument(
        "--srdf",
        metavar="FILE",
        dest="disabled",
        help="write disable_collisions for what is proved; - for standard output",
    )
    parser.add_argument(
        "--cells",
        type=int,
        default=allowed.CELLS,
        metavar="N",
        help=f"cells for a pair of links before it is not decided (default {allowed.CELLS})",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Decide all pairs of links; return 0 if it is known what all spheres do, else 3."""
    if options.cells < 1:
        raise ValueError(f"--cells {options.cells}: 1 or more are wanted")
    if is_urdf(options.robot):
        imported = import_urdf(options.robot)
        robot, inside = imported.robot, balls_inside(imported)
    else:
        robot, inside = load_robot(options.robot), ()
    shown: Any = None

    def progress(done: int, total: int) -> None:
        nonlocal shown
        shown = shown or progress_line("pairs of links", total)
        shown(done)

    found = allowed.allowed_collisions(robot, inside=inside, cells=options.cells, progress=progress)
    document = (options.json, lambda: json_text(allowed.allowed_document(robot, found)))
    srdf = (options.disabled, lambda: allowed.srdf_text(robot, found))
    deliver([document, srdf], allowed.allowed_lines(robot, found))
    return 3 if any(each.spheres is allowed.Spheres.UNDECIDED for each in found) else 0
