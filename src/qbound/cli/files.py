"""Files of commands: every one whole, several together or none; ``-`` is standard output."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from qbound.cli.terminal import say
from qbound.files import target, write_together

if TYPE_CHECKING:
    from pathlib import Path

Content = str | bytes
Output = tuple[str | None, Callable[[], Content]]
"""A file, or None where none was asked for, and what makes its content."""


def deliver(outputs: Sequence[Output], lines: Iterable[str]) -> None:
    """Make and write what was asked for; print the lines unless standard output is taken by it.

    The last line names the files.
    """
    write_all([(file, make()) for file, make in outputs if file is not None])
    files = [file for file, _ in outputs if file is not None]
    if "-" not in files:
        say(*lines, *([f"written: {', '.join(files)}"] if files else []))


def write_all(outputs: Sequence[tuple[str, Content]]) -> None:
    """Write several files, every one whole, or none at all; ``-`` is standard output, the last."""
    check_targets([file for file, _ in outputs])
    contents = [(file, _bytes(content)) for file, content in outputs]
    write_together([(file, content) for file, content in contents if file != "-"])
    for content in (content for file, content in contents if file == "-"):
        _put_out(content)


def write_text(file: str, text: str) -> None:
    """Write a text whole or not at all; ``-`` is standard output."""
    write_all([(file, text)])


def check_targets(
    files: Sequence[str | None], kinds: Sequence[str] = (), sources: Sequence[str | None] = ()
) -> None:
    """Refuse, before any work, files that could not be written; None is no file.

    Parameters
    ----------
    kinds : sequence of str, optional
        Endings that are allowed, such as ``svg``.
    sources : sequence of (str or None), optional
        Files that are read, and are not to be written over.

    Raises
    ------
    ValueError
        If two are the same, one is a source, or an ending is unknown.
    OSError
        If a folder is missing, or a target is no regular file or may not be written.
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


def _put_out(content: bytes) -> None:
    """Write to standard output as to a file, in UTF-8; a terminal takes texts only."""
    if b"\0" in content and sys.stdout.isatty():
        raise ValueError("-: these are no letters for a terminal; name a file")
    sys.stdout.flush()
    sys.stdout.buffer.write(content)


def _bytes(content: Content) -> bytes:
    return content if isinstance(content, bytes) else content.encode()
