"""What does a user type? The command ``qbound``: one thin module a command; radians on the way out.

- commands: `region`, `workspace`, `contains`, `connected`, `traverse`, `sample`, `pave`, `certify`,
  `check`, `draw`, `explore`, `robots`;
- `chosen` (robot, rule and slice, which several commands share), `values` (joint values as people
  type them), `files` (written whole or not at all), `progress` (a line while work is long).
"""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points

from qbound import __version__
from qbound.cli import (
    certify,
    check,
    connected,
    contains,
    draw,
    explore,
    pave,
    region,
    robots,
    sample,
    traverse,
    workspace,
)
from qbound.extras import explained

COMMANDS = (
    region,
    workspace,
    contains,
    connected,
    traverse,
    sample,
    pave,
    certify,
    check,
    draw,
    explore,
    robots,
)
"""In the order of the help; after them come those of the entry-point group."""

GROUP = "qbound.commands"
"""Entry points of this group are modules with an `add_to`, as those above."""

STOPPED, NO_READER = 130, 141
"""Exit status after Ctrl-C, and where nobody reads the output any more, as shells have it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 done or proved, 1 infeasible or refuted, 2 bad input, 3 undecided."""
    words = sys.argv[1:] if arguments is None else arguments
    options = command_line().parse_args([_shielded(word) for word in words])
    try:
        status = int(options.run(options))
        sys.stdout.flush()
    except BrokenPipeError:  # as in `qbound region ... | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return NO_READER
    except (ValueError, OSError, ImportError) as error:
        print(f"qbound: {explained(error)}", file=sys.stderr)
        return 2
    except MemoryError:
        print("qbound: this asks for more memory than there is", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("qbound: stopped", file=sys.stderr)
        return STOPPED
    return status


def command_line() -> argparse.ArgumentParser:
    """Return the parser of the whole command."""
    return _parsers()[0]


def command_parsers() -> dict[str, argparse.ArgumentParser]:
    """Return the parser of each command, by its name; the book shows their help."""
    return _parsers()[1]


def _parsers() -> tuple[argparse.ArgumentParser, dict[str, argparse.ArgumentParser]]:
    parser = argparse.ArgumentParser(prog="qbound", description="Feasible workspaces of robots.")
    parser.add_argument("--version", action="version", version=f"qbound {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    others = [found.load() for found in sorted(entry_points(group=GROUP), key=lambda e: e.name)]
    for command in (*COMMANDS, *others):
        command.add_to(commands)
    for subparser in commands.choices.values():
        subparser.formatter_class = argparse.RawDescriptionHelpFormatter  # examples stay in line
    return parser, dict(commands.choices)


def _shielded(word: str) -> str:
    """Let ``-45deg`` be a value: argparse knows plain negative numbers only."""
    return f" {word}" if re.match(r"-\.?\d", word) else word
