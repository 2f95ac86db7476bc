"""``cspace why``, or ``connected``: whether the arm can get from start to goal, and why."""

import argparse
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from cspace import check
from cspace.arms.why import Why, why, why_bytes, why_document, why_lines
from cspace.cli.chosen import FEWER, add_memory, add_robot, sized_robot
from cspace.cli.terminal import Output, deliver
from cspace.cli.values import configuration
from cspace.export.formats import json_text
from cspace.export.routes import path_csv
from cspace.figures.why import why_picture
from cspace.proofs.certificates.statements import length_decimal
from cspace.units import joint_text

STATUS = {"connected": 0, "separated": 1, "infeasible": 1, "undecided": 3}


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "why",
        aliases=["connected"],
        help="can the arm get from start to goal? a path, proved, or what separates them",
        description="Can the arm get from START to GOAL? First: does either violate a boundary?\n"
        "Then: can one joint not pass a range, whatever the others do? Then a path is searched\n"
        "and proved. Else, of two joints, the region is proved; of up to three joints, the\n"
        "others held, a paving is made. Certificates take at most 7 joints and 2,000 boundaries.",
        epilog="exit status: 0 connected, 1 separated or infeasible, 3 undecided; 2 bad input\n"
        "needs cspace[proofs] for what is proved by cells\n"
        "example: cspace why minervabot-v2 0deg 0deg 0deg 130deg -o certificate.json",
    )
    add_robot(parser)
    parser.add_argument(
        "values",
        nargs="+",
        metavar="VALUE",
        help="start and goal, one after the other: 20deg, 0.3m; a plain number is in the unit of"
        " the robot file, of a URDF deg and m",
    )
    parser.add_argument(
        "--hold",
        action="store_true",
        help="ask only about paths on which joints with one value at both ends stay there",
    )
    parser.add_argument(
        "--seed", type=int, default=0, metavar="S", help="of the search, 0 or above (default 0)"
    )
    parser.add_argument(
        "--margin",
        default="0",
        metavar="LENGTH",
        help="to keep beside all the way: 5mm, or a plain number of the robot file's unit"
        " (default 0)",
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="write the certificate; - for output"
    )
    parser.add_argument(
        "--csv", metavar="FILE", help="write the corners of the proved path, as traverse does"
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the ranges, or margins along the path")
    add_memory(parser)
    parser.set_defaults(run=run, endings=("json",))


def run(options: argparse.Namespace) -> int:
    """Answer the question; return 0 if connected, 1 if separated or infeasible, 3 if undecided."""
    robot = sized_robot(options, why_bytes)
    n = len(robot.joints)
    if len(options.values) != 2 * n:
        raise ValueError(f"{len(options.values)} values; two configurations have {2 * n}")
    if options.seed < 0:
        raise ValueError(f"--seed {options.seed}: a seed is 0 or above")
    start, goal = (configuration(robot, options.values[k : k + n]) for k in (0, n))
    margin = length_decimal(robot, "--margin", options.margin)
    if Fraction(margin) < 0:
        raise ValueError(f"--margin {options.margin}: a length of 0 or more is wanted")
    asked = {"seed": options.seed, "hold": options.hold, "margin": margin}
    found = why(robot, start, goal, **asked)
    outputs: list[Output] = [
        (options.json, lambda: json_text(why_document(found))),
        (options.svg, lambda: why_picture(found)),
    ]
    path = found.path
    if path is not None:
        outputs.append((options.csv, lambda: path_csv(robot, path)))
    if found.certificate is not None:
        text = found.certificate.text
        outputs.append((options.output, lambda: text))
    answer, *reasons = why_lines(found)
    ends = [f"  from {joint_text(robot, start)}", f"  to {joint_text(robot, goal)}"]
    deliver(outputs, [answer, *ends, *reasons, *_of_files(options, found)])
    return STATUS[found.answer]


def _of_files(options: argparse.Namespace, why: Why) -> Iterator[str]:
    """Yield sentences about the certificate, or that there is none, and about a path's table."""
    file = options.output
    if options.csv is not None and why.path is None:
        yield f"{options.csv}: not written: no path is proved"
    if why.certificate is None and why.no_certificate:
        advice = f"; {FEWER}" if len(why.robot.used) > check.MAX_BOUNDARIES else ""
        yield f"no certificate: {why.no_certificate}{advice}"
    if file is not None and why.certificate is None:
        yield f"{file}: not written: of this answer there is no certificate"
    elif file is not None:
        yield f"{file} is a certificate; check it with cspace check"
