"""``qbound check``: check a certificate, as ``python check.py`` does."""

from __future__ import annotations

import argparse
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

from qbound import check
from qbound.cli.terminal import say
from qbound.model.robotfile import robot_text
from qbound.proofs import check_arb
from qbound.proofs.reports import folded


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "check",
        help="check a certificate in exact arithmetic",
        epilog="example: qbound check cert.json minervabot-v2",
    )
    parser.add_argument("certificate")
    parser.add_argument("robot", nargs="?", help="the robot that it must be about")
    parser.add_argument("--sha256", metavar="HASH", help="the hash of that robot's file")
    parser.add_argument("--arb", action="store_true", help="check with python-flint as well")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Check; 0 proved, 1 refuted, 2 neither."""
    if options.robot is not None and options.sha256 is not None:
        raise ValueError("a robot and --sha256: give one of them")
    if "" in (options.robot, options.sha256):
        raise ValueError("an empty robot or hash pins nothing: name the robot or leave it out")
    pin = [] if options.sha256 is None else ["--sha256", options.sha256]
    if options.robot is not None:
        pin = ["--sha256", check.digest(robot_text(options.robot)[0])]
    with redirect_stdout(StringIO()) as said:
        status = check.main([options.certificate, *pin])
    say(*folded(said.getvalue()))
    if not options.arb or status > 1:
        return status
    try:
        answer = check_arb.verify(Path(options.certificate).read_bytes())
    except ValueError as error:
        say(f"python-flint: not proved: {error}")
        return 2
    say(f"python-flint: {answer}")
    return status
