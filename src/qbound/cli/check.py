"""``qbound check``: check a certificate, as ``python check.py`` does."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from qbound import check
from qbound.cli.terminal import say
from qbound.model.robotfile import robot_text
from qbound.proofs import check_arb


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
    status = check.main([options.certificate, *pin])
    if options.arb and status < 2:
        text = Path(options.certificate).read_text(encoding="utf-8")
        say(f"python-flint: {check_arb.verify(text)}")
    return status
