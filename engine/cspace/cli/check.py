"""The command ``cspace check``: check a certificate, as ``python -I check.py`` does."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from cspace import check
from cspace.cli.chosen import proved_text
from cspace.cli.terminal import say, write_all
from cspace.proofs.certificates.certify import folded, summed_up


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "check",
        help="check a certificate in exact arithmetic",
        epilog="exit status: 0 proved, 3 refuted, 2 anything else\n"
        "refuted: the certificate is sound, and shows that what it claims is false\n"
        "example: cspace check cert.json minervabot-v2\n"
        "example: cspace check --source > check.py",
    )
    parser.add_argument("certificate", nargs="?")
    parser.add_argument("robot", nargs="?", help="the robot that it must be about")
    parser.add_argument(
        "--all",
        action="store_true",
        help="list every boundary that is kept; by default many of balls are a row for two links",
    )
    parser.add_argument(
        "--source",
        action="store_true",
        help="print check.py, which checks a certificate with Python alone; takes no certificate",
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Check; 0 proved, 3 refuted, 2 anything else, as `check.py`: 1 is no answer."""
    if options.source:
        if options.certificate is not None:
            raise ValueError("--source: prints check.py and checks nothing; leave the rest out")
        write_all([("-", Path(check.__file__).read_bytes())])
        return 0
    if options.certificate is None:
        raise ValueError("name a certificate; --source prints check.py")
    if options.robot == "":
        raise ValueError("an empty robot compares with nothing: name the robot or leave it out")
    pin = None if options.robot is None else proved_text(options.robot)[0]
    with Path(options.certificate).open("rb") as file:
        data = file.read(check.MAX_FILE + 1)
    try:
        answer = check.check(data, pin, options.robot or "")
    except ValueError as error:
        say(*folded(f"not proved: {error}"))
        return check.NO_ANSWER
    verdict = "refuted" if answer.refuted else "proved"
    said = answer.said
    if not options.all:
        content, robot = check.read(data)
        said = summed_up(said, robot if pin is None else check.read_robot(pin, content["parts"]))
    say(verdict, *folded(said), verdict)
    return check.REFUTED if answer.refuted else check.PROVED
