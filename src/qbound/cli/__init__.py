"""The command ``qbound``: one thin module a command; angles in radians on the way out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from qbound import __version__
from qbound.cli import claims, connected, contains, pave, region, results, robots

COMMANDS = (region, contains, connected, pave, robots, claims, results)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 done or proved, 1 infeasible or refuted, 2 bad input, 3 undecided."""
    parser = argparse.ArgumentParser(prog="qbound", description="Feasible workspaces of robots.")
    parser.add_argument("--version", action="version", version=f"qbound {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add_to(commands)
    options = parser.parse_args(arguments)
    try:
        return int(options.run(options))
    except (ValueError, OSError, ImportError) as error:
        print(f"qbound: {error}", file=sys.stderr)
        return 2
