"""``qbound pave``: certified inner and outer pavings of a region, with the undecided volume."""

from __future__ import annotations

import argparse
from typing import Any

from qbound.cli.chosen import add_memory, add_robot, add_slice, refuse_memory
from qbound.cli.terminal import deliver, progress
from qbound.cli.values import held
from qbound.export.formats import json_text
from qbound.model.robotfile import load_robot
from qbound.proofs.exact.problem import exact_problem, exact_robot, paving_bytes
from qbound.proofs.subpaving.paving import pave, paving_document, paving_lines
from qbound.proofs.subpaving.stacks import columns_document, columns_lines, pave_columns

STEPS = 1000
"""Of the progress that is shown."""

COLUMNS = 4_000_000
"""Bytes that columns take for each boundary in five minutes; measured on slices of a UR5."""

SECONDS = 300
"""Time after which a paving stops, unless another is asked for."""


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "pave",
        help="bracket a region of any number of joints by cells, each proved",
        description="Halve cells of joint space until those that are undecided are few, or there\n"
        "are too many, or the time is over. What is proved until then holds. Each joint more\n"
        "takes three times the memory and more: hold joints with --slice.",
        epilog="exit status: 0 the tolerance is met, 3 it is not; 2 bad input\n"
        "example: qbound pave minervabot-v2 --tolerance 0.001",
    )
    add_robot(parser)
    parser.add_argument(
        "--tolerance",
        type=float,
        default=0.01,
        metavar="PART",
        help="undecided part of the joint range at which to stop (default 0.01)",
    )
    parser.add_argument(
        "--columns",
        action="store_true",
        help="solve for one joint over cells of the others: many times as fast, not for bodies",
    )
    parser.add_argument(
        "--seconds",
        type=float,
        default=SECONDS,
        metavar="S",
        help=f"time of halving cells after which to stop (default {SECONDS})",
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    add_memory(parser)
    add_slice(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Pave the region; return 0 if the tolerance is met, 3 if cells or time ran out before."""
    if not 0 < options.tolerance < 1:
        raise ValueError(f"--tolerance {options.tolerance}: a part between 0 and 1 is wanted")
    if not options.seconds > 0:
        raise ValueError(f"--seconds {options.seconds}: a time above 0 is wanted")
    robot = load_robot(options.robot)
    values = held(robot, options.slice)
    free = [j for j in range(len(robot.joints)) if j not in values]
    estimate = paving_bytes(len(robot.used), len(free))
    estimate += COLUMNS * len(robot.used) if options.columns else 0
    refuse_memory(options, estimate, "hold some of the joints with --slice")
    problem = exact_problem(exact_robot(robot), values)
    shown = progress("paving", STEPS)

    def tell(part: float) -> None:
        shown(int(part * STEPS))

    if options.columns:
        columns = pave_columns(problem, options.tolerance, tell=tell, seconds=options.seconds)
        document = (options.json, lambda: json_text(columns_document(robot, columns, free)))
        deliver([document], columns_lines(robot, columns))
        return 0 if columns.undecided_fraction <= options.tolerance else 3
    paving = pave(problem, options.tolerance, tell=tell, seconds=options.seconds)
    document = (options.json, lambda: json_text(paving_document(robot, paving)))
    deliver([document], paving_lines(robot, paving))
    return 0 if paving.undecided_fraction <= options.tolerance else 3
