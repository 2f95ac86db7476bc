"""The command ``lizarraga2025``: what holds of the paper, and the numbers of the book.

`claims`: the ledger, shown, computed again, cited.  `results`: the recorded numbers.  `citing`: how
to cite paper and package.
"""

import argparse
import io
import os
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from lizarraga2025.commands import citing, claims, results

NO_READER = 141
"""Exit status where nobody reads the output any more, as shells have it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0 printed, 1 computed otherwise than recorded, 2 bad input."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal may not know every letter
            stream.reconfigure(errors="backslashreplace")
    options = _parsers()[0].parse_args(arguments)
    try:
        status = int(options.run(options))
        sys.stdout.flush()
    except BrokenPipeError:  # as in `lizarraga2025 claims | head`; nothing may fail after the end
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return NO_READER
    except (ValueError, OSError, ImportError) as error:
        print(f"lizarraga2025: {printable(str(error))}", file=sys.stderr)
        return 2
    return status


def printable(text: str) -> str:
    """Return a text on one line, with characters that act on a terminal escaped as in Python."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def command_parsers() -> dict[str, argparse.ArgumentParser]:
    """Return the parser of each command, by its name; the book shows their help."""
    return _parsers()[1]


def _parsers() -> tuple[argparse.ArgumentParser, dict[str, argparse.ArgumentParser]]:
    parser = _Parser(
        prog="lizarraga2025", description="What holds of the paper, and the numbers of the book."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for module in (claims, results, citing):
        module.add_to(commands)
    return parser, dict(commands.choices)


class _Parser(argparse.ArgumentParser):
    """A parser that keeps the lines of examples and makes quoted arguments printable."""

    def __init__(self, *names: Any, **options: Any) -> None:
        """Keep the lines of descriptions and examples."""
        formatter = {"formatter_class": argparse.RawDescriptionHelpFormatter}
        super().__init__(*names, **formatter | options)

    def error(self, message: str) -> NoReturn:
        """Print the usage and the message, and stop with status 2."""
        super().error(printable(message))
