"""What does a user type? The command ``qbound``: one thin module a command; radians on the way out.

- commands: `region`, `workspace`, `contains`, `connected`, `why`, `traverse`, `fibre`, `reach`,
  `sample`, `sweep`, `pave`, `allowed`, `surface`, `certify`, `check`, `draw`, `explore`, `import`
  (`import_urdf`), `robots`;
- `chosen` (robot, rule and slice, which several commands share), `values` (joint values as people
  type them), `files` (written whole or not at all), `terminal` (all that is printed, made safe),
  `progress` (a line while work is long).
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from itertools import pairwise
from typing import Any, NoReturn

from qbound.cli.files import check_targets
from qbound.cli.terminal import complain, finish_output, plain_terminal
from qbound.extras import explained
from qbound.printable import printable

COMMANDS = {
    "region": "region",
    "workspace": "workspace",
    "contains": "contains",
    "connected": "connected",
    "why": "why",
    "traverse": "traverse",
    "fibre": "fibre",
    "reach": "reach",
    "sample": "sample",
    "sweep": "sweep",
    "pave": "pave",
    "allowed": "allowed",
    "surface": "surface",
    "certify": "certify",
    "check": "check",
    "draw": "draw",
    "explore": "explore",
    "import": "import_urdf",
    "robots": "robots",
}
"""Module of each command, in the order of the help; then come those of the entry-point group.

Only the command that is asked for is imported: all of them together take half a second."""

GROUP = "qbound.commands"
"""Entry points of this group are modules with an `add_to`, as those above."""

WRITTEN = ("output", "json", "svg", "csv", "geojson", "npz", "ros", "disabled")
READ = ("robot", "certificate", "path", "polygon", "urdf", "srdf", "specification")
"""Options, by what argparse calls them, that name files: checked here, once for all commands."""

STOPPED, NO_READER = 130, 141
"""Exit status after Ctrl-C, and where nobody reads the output any more, as shells have it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 done or proved, 1 infeasible or refuted, 2 bad input, 3 undecided."""
    with plain_terminal():
        try:
            return _run(sys.argv[1:] if arguments is None else arguments)
        except BrokenPipeError:  # as in `qbound region ... | head`
            return NO_READER
        except (ValueError, OSError, ImportError) as error:
            complain(explained(error))
        except MemoryError:
            complain("this asks for more memory than there is")
        except KeyboardInterrupt:
            complain("stopped")
            return STOPPED
        except Exception:  # a fault of ours must not look like an answer: Python's status is 1
            import traceback

            for line in traceback.format_exc().splitlines():
                complain(line)
        return 2


def _run(words: Sequence[str]) -> int:
    _refuse_empty(words)
    try:
        options = command_line(words[0] if words else None).parse_args(words)
        _check_files(vars(options))
        return int(options.run(options))
    finally:
        finish_output()


def _refuse_empty(words: Sequence[str]) -> None:
    """Refuse words that hold nothing: ``--json ""`` is no option left out, but a slip."""
    for before, word in pairwise(["qbound", *words]):
        if re.fullmatch(r"(-[\w-]+=)?", word):
            where = word.rstrip("=") or before
            raise ValueError(f"{where}: an empty value; give one, or leave the option out")


def _check_files(options: Mapping[str, Any]) -> None:
    """Refuse, before any work, files that could not be written, or are read by the same command."""
    written, read = ([options.get(name) for name in names] for names in (WRITTEN, READ))
    check_targets(
        [file for file in written if isinstance(file, str)],
        sources=[file for file in read if isinstance(file, str)],
    )


def command_line(name: str | None = None) -> argparse.ArgumentParser:
    """Return the parser of the whole command; of `name` alone where it is one of ours."""
    return _parsers({name: COMMANDS[name]} if name in COMMANDS else None)[0]


def command_parsers() -> dict[str, argparse.ArgumentParser]:
    """Return the parser of each command, by its name; the book shows their help."""
    return _parsers()[1]


def _parsers(
    chosen: Mapping[str, str] | None = None,
) -> tuple[argparse.ArgumentParser, dict[str, argparse.ArgumentParser]]:
    parser = _Parser(prog="qbound", description="Feasible workspaces of robots.")
    # Of one command: it comes first on the line, so that nobody reads the version.
    version = _version() if chosen is None else ""
    parser.add_argument("--version", action="version", version=f"qbound {version}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    modules = [import_module(f"qbound.cli.{name}") for name in (chosen or COMMANDS).values()]
    for command in (*modules, *(_others() if chosen is None else ())):
        command.add_to(commands)
    for subparser in commands.choices.values():
        subparser.formatter_class = argparse.RawDescriptionHelpFormatter  # examples stay in line
    return parser, dict(commands.choices)


def _version() -> str:
    from qbound.version import __version__

    return __version__


def _others() -> list[Any]:
    """Load the commands of the entry-point group, by name; ours keep theirs."""
    from importlib.metadata import entry_points  # slow: it reads mail

    others = sorted(entry_points(group=GROUP), key=lambda found: found.name)
    return [found.load() for found in others if found.name not in COMMANDS]


class _Parser(argparse.ArgumentParser):
    """A parser that takes ``-45deg`` for a value, and quotes nothing raw."""

    def __init__(self, *names: Any, **options: Any) -> None:
        """Set what looks like a negative number; argparse knows plain ones only."""
        super().__init__(*names, **options)
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def error(self, message: str) -> NoReturn:
        """Print the usage and the message, and stop with status 2."""
        super().error(printable(message))
