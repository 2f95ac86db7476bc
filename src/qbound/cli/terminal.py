"""What reaches a terminal: answers on standard output, complaints and warnings on the other.

Only this module and `progress` print. Every line is made `printable` here, whatever a file, a
name or an option brought into it; content that goes to ``-`` is made so by what writes it.
"""

from __future__ import annotations

import io
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from qbound.printable import printable

HALF = 1000
"""Letters that a long complaint keeps of either end."""

BLANK_LINE = "\r\033[K"
"""Takes away what stands on the line, such as progress."""


def say(*lines: str) -> None:
    """Print lines to standard output, in place of progress that stands there."""
    if lines and is_terminal() and sys.stdout is not None and sys.stdout.isatty():
        print(BLANK_LINE, end="", file=sys.stderr, flush=True)
    for line in lines:
        print(printable(line))


def complain(text: object) -> None:
    """Print one line to standard error, with the program's name; nobody may be there to read it."""
    if sys.stderr is not None:
        blank = BLANK_LINE if is_terminal() else ""
        with suppress(OSError):
            print(f"{blank}qbound: {_shortened(printable(text))}", file=sys.stderr)


def _shortened(line: str) -> str:
    """Leave out the middle of what quotes a value without end."""
    return line if len(line) <= 2 * HALF else f"{line[:HALF]} ... {line[-HALF:]}"


@contextmanager
def plain_terminal() -> Iterator[None]:
    """Keep to what the terminal can show: its letters, and warnings as single lines."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    shown = warnings.showwarning
    warnings.showwarning = _warn
    try:
        yield
    finally:
        warnings.showwarning = shown


def finish_output() -> None:
    """Write out what is left; where nobody takes it, leave nothing to fail after the end.

    Raises
    ------
    OSError
        If standard output is broken or full.
    """
    if sys.stdout is None:
        return
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    complain(f"warning: {message}")


def is_terminal() -> bool:
    """Tell whether somebody watches standard error."""
    return sys.stderr is not None and sys.stderr.isatty()
