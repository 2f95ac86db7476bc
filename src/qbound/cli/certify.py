"""``qbound certify``: prove or refute that a set of configurations is safe, and write the proof."""

from __future__ import annotations

import argparse
import tomllib
from typing import Any

from qbound.check import number
from qbound.cli.chosen import add_robot
from qbound.cli.files import check_targets, write_text
from qbound.cli.terminal import say
from qbound.cli.values import box, held
from qbound.model.robot import Robot
from qbound.model.robotfile import parse_robot, robot_text
from qbound.proofs import statements
from qbound.proofs.certify import Bracket, bracket_scale, certify
from qbound.proofs.points import as_decimal, read_points
from qbound.proofs.reports import certificate_lines

STATUS = {"proved": 0, "refuted": 1, "undecided": 3}


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "certify",
        help="prove that every configuration of a set is safe",
        epilog="example: qbound certify minervabot-v2 --scale 0.96 -o cert.json",
    )
    add_robot(parser)
    sets = parser.add_mutually_exclusive_group()
    sets.add_argument(
        "--scale", metavar="S", help="the polygon of home's vertices, scaled (default 1)"
    )
    sets.add_argument("--region", action="store_true", help="home's region but for --inset")
    sets.add_argument("--box", nargs="+", metavar="q1=-20deg:30deg", help="all joints in ranges")
    sets.add_argument("--path", metavar="CSV", help="straight segments between joint values")
    sets.add_argument("--polygon", metavar="CSV", help="a polygon of joint values, either sense")
    sets.add_argument(
        "--largest-scale", action="store_true", help="a proof and a witness around the largest"
    )
    parser.add_argument(
        "--margin", default="0", metavar="LENGTH", help="to keep beside (default 0)"
    )
    parser.add_argument(
        "--inset", type=float, metavar="LENGTH", help="of --region (default: of the reach, 1 %%)"
    )
    parser.add_argument("--slice", nargs="+", default=[], metavar="q3=20deg", help="hold joints")
    parser.add_argument("-o", "--output", metavar="FILE", help="write the certificate")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Answer; 0 proved, 1 refuted, 3 undecided."""
    check_targets([options.output])
    text, _ = robot_text(options.robot)
    robot = parse_robot(tomllib.loads(text))
    margin = as_decimal("--margin", options.margin)
    if number(margin) < 0:
        raise ValueError(f"--margin {margin}: a length of 0 or more is wanted")
    if options.largest_scale:
        if options.margin != "0" or options.slice:
            raise ValueError(
                "--largest-scale: for the robot as it is, without --margin and --slice"
            )
        return _say_bracket(robot, bracket_scale(text), options.output)
    answer = certify(text, statement(robot, options))
    if options.output and answer.text:
        write_text(options.output, answer.text)
    if options.output != "-" or not answer.text:
        say(answer.said, *certificate_lines(robot, answer))
    return STATUS[answer.verdict]


def statement(robot: Robot, options: argparse.Namespace) -> statements.Statement:
    """State what the options ask for."""
    values = held(robot, options.slice)
    if options.inset is not None and not options.region:
        raise ValueError("--inset: only --region is proved but for an inset")
    if options.box:
        return statements.box(*box(robot, options.box), options.margin)
    if options.path:
        return statements.path(read_points(robot, options.path), options.margin)
    if options.polygon:
        loop = statements.anticlockwise(read_points(robot, options.polygon))
        return statements.filled([loop], options.margin)
    if options.region:
        inset = statements.usual_inset(robot) if options.inset is None else options.inset
        return statements.inner_polygon(robot, inset, margin=options.margin, held=values)
    scale = float(number(as_decimal("--scale", options.scale or "1")))
    return statements.home_polygon(robot, scale, options.margin, values)


def _say_bracket(robot: Robot, found: Bracket, output: str | None) -> int:
    """Print both ends; the file is the proof of the lower one."""
    safe, proof = found.safe
    unsafe, refutation = found.unsafe
    if proof is not None and proof.verdict == "proved":
        say(f"scale {safe}: proved", *certificate_lines(robot, proof))
        if output:
            write_text(output, proof.text)
    if refutation is not None and refutation.verdict == "refuted":
        say(f"scale {unsafe}: refuted", *certificate_lines(robot, refutation))
    both = [answer and answer.verdict for answer in (proof, refutation)]
    return 0 if both[0] == "proved" and both[1] in ("refuted", None) else 3
