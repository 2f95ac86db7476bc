"""Output to the terminal: answers on standard output, messages and warnings on standard error.

Only this module prints. Every line is made `printable` here, because files, names and options may
bring anything into it. Content for ``-`` is made printable by its writer.

A line shows the progress of long work on standard error, if that is a terminal.

Every command shows such a line after two seconds (`waiting`), or a better line of its own.

Files of a command are written whole, all of them or none; ``-`` is standard output.
"""

from __future__ import annotations

import io
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from cspace.files import target, write_together
from cspace.printable import printable

if TYPE_CHECKING:
    from pathlib import Path

HALF = 1000
"""Letters that a long complaint keeps of either end."""

BLANK_LINE = "\r\033[K"
"""Takes away what stands on the line, such as progress."""


def say(*lines: str) -> None:
    """Print lines to standard output, after removing the line of progress."""
    if lines and is_terminal() and sys.stdout is not None and sys.stdout.isatty():
        print(BLANK_LINE, end="", file=sys.stderr, flush=True)
    for line in lines:
        print(printable(line))


def complain(text: object) -> None:
    """Print one line to standard error, with the program's name; ignore a closed stream."""
    if sys.stderr is not None:
        blank, line = BLANK_LINE if is_terminal() else "", printable(text)
        if len(line) > 2 * HALF:
            line = f"{line[:HALF]} ... {line[-HALF:]}"
        with suppress(OSError):
            print(f"{blank}cspace: {line}", file=sys.stderr)


@contextmanager
def plain_terminal() -> Iterator[None]:
    """Print only letters that the terminal can show, and warnings as single lines."""
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
    """Flush the output; if nobody reads it, leave nothing that could fail after the end.

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
    """Tell whether standard error is a terminal."""
    return sys.stderr is not None and sys.stderr.isatty()


# --- progress -------------------------------------------------------------------------------------


EVERY = 0.2  # seconds

PATIENCE = 10
"""Times `EVERY` after which a command that has shown nothing shows how long it has taken."""

_shown = {"when": 0.0}
"""When a line was shown last."""


def progress_line(what: str, total: int) -> Callable[[int], None]:
    """Return a function to call with the amount of work done."""
    start = last = time.monotonic()

    def progress(done: int) -> None:
        nonlocal last
        now = time.monotonic()
        if not is_terminal() or (now - last < EVERY and done < total) or now - start < EVERY:
            return
        last = now
        _show("" if done >= total else f"{what}: {100 * done // total} %")

    return progress


@contextmanager
def waiting(what: str) -> Iterator[None]:
    """Show the elapsed time of a command while nothing else is shown; Ctrl-C ends it as usual."""
    if not is_terminal():
        yield
        return
    import threading

    over, start = threading.Event(), time.monotonic()

    def tick() -> None:
        while not over.wait(5 * EVERY):
            now = time.monotonic()
            if now - max(start, _shown["when"]) > PATIENCE * EVERY:
                _show(f"{what}: {now - start:.0f} s")

    ticker = threading.Thread(target=tick, daemon=True)
    ticker.start()
    try:
        yield
    finally:
        over.set()
        ticker.join()
        if _shown["when"] > start:
            _show("")


def _show(text: str) -> None:
    _shown["when"] = time.monotonic()
    print(f"{BLANK_LINE}{printable(text)}", end="", file=sys.stderr, flush=True)


# --- files ----------------------------------------------------------------------------------------


Content = str | bytes
Output = tuple[str | None, Callable[[], Content]]
"""A file, or None where none was asked for, and what makes its content."""


def deliver(outputs: Sequence[Output], lines: Iterable[str]) -> None:
    """Make and write the files; print the lines unless a file goes to standard output.

    The last line names the files.
    """
    write_all([(file, make()) for file, make in outputs if file is not None])
    files = [file for file, _ in outputs if file is not None]
    if "-" not in files:
        say(*lines, *([f"written: {', '.join(files)}"] if files else []))


def write_all(outputs: Sequence[tuple[str, Content]]) -> None:
    """Write several files, all of them whole or none; ``-`` is standard output, written last."""
    check_targets([file for file, _ in outputs])
    contents = [
        (file, content if isinstance(content, bytes) else content.encode())
        for file, content in outputs
    ]
    write_together([(file, content) for file, content in contents if file != "-"])
    for content in (content for file, content in contents if file == "-"):
        if b"\0" in content and sys.stdout.isatty():
            raise ValueError("-: these are no letters for a terminal; name a file")
        sys.stdout.flush()
        sys.stdout.buffer.write(content)


def check_targets(
    files: Sequence[str | None], kinds: Sequence[str] = (), sources: Sequence[str | None] = ()
) -> None:
    """Refuse, before any work, files that cannot be written; None means no file.

    Parameters
    ----------
    kinds : sequence of str, optional
        Endings that are allowed, such as ``svg``.
    sources : sequence of (str or None), optional
        Files that are read and must not be overwritten.

    Raises
    ------
    ValueError
        If two are the same, one is a source, or an ending is unknown.
    OSError
        If a folder is missing, or a target is not a regular file or may not be written.
    """
    written = [file for file in files if file is not None]
    if not written:
        return
    from pathlib import Path  # slow to import, and most commands write nothing

    read = {Path(file).resolve() for file in sources if file is not None and Path(file).is_file()}
    seen = set()
    for file in written:
        path = _open_output() if file == "-" else target(file)
        if path in seen:
            raise ValueError(f"{file}: two outputs go to this one place")
        if path in read:
            raise ValueError(f"{file}: is read here, and would be written over")
        seen.add(path)
        if kinds and path.suffix.removeprefix(".").lower() not in kinds:
            wanted = f"wanted: .{', .'.join(kinds)}"
            raise ValueError(f"{file}: unknown ending {path.suffix!r}; {wanted}")


def _open_output() -> Path:
    if sys.stdout is None:
        raise ValueError("-: standard output is closed")
    from pathlib import Path

    return Path("-")
