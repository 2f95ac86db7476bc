"""Files of commands: every one whole, several together or none; ``-`` is standard output."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

Content = str | bytes
Output = tuple[str | None, Callable[[], Content]]
"""A file, or None where none was asked for, and what makes its content."""


def deliver(outputs: Sequence[Output], lines: Iterable[str]) -> None:
    """Make and write what was asked for; print the lines unless standard output is taken by it."""
    write_all([(file, make()) for file, make in outputs if file])
    if "-" not in (file for file, _ in outputs):
        print("\n".join(lines))


def write_all(outputs: Sequence[tuple[str, Content]]) -> None:
    """Write several files, every one whole, or none at all; ``-`` is standard output, written last.

    Drafts are made beside the files and renamed when all of them are complete.
    """
    check_targets([file for file, _ in outputs])
    targets = [(Path(file).resolve(), _bytes(content)) for file, content in outputs if file != "-"]
    drafts = [path.with_name(f".{path.name}.{os.getpid()}.part") for path, _ in targets]
    try:
        for (path, content), draft in zip(targets, drafts, strict=True):
            try:
                draft.write_bytes(content)
            except OSError as error:
                raise ValueError(f"{path}: not written: {error.strerror or error}") from None
        for (path, _), draft in zip(targets, drafts, strict=True):
            draft.replace(path)
    finally:
        for draft in drafts:
            draft.unlink(missing_ok=True)
    for printed in (content for file, content in outputs if file == "-"):
        if isinstance(printed, bytes):
            sys.stdout.buffer.write(printed)
        else:
            print(printed, end="")


def write_text(file: str, text: str) -> None:
    """Write a text whole or not at all; ``-`` is standard output."""
    write_all([(file, text)])


def check_targets(files: Sequence[str | None], kinds: Sequence[str] = ()) -> None:
    """Refuse, before any work, files that could not be written; None is no file.

    Parameters
    ----------
    kinds : sequence of str, optional
        Endings that are allowed, such as ``svg``.

    Raises
    ------
    ValueError
        If two are the same, a folder is missing, a target is no regular file, or an ending unknown.
    """
    seen = set()
    for file in filter(None, files):
        path = Path(file).resolve() if file != "-" else Path("-")
        if path in seen:
            raise ValueError(f"{file}: two outputs go to this one place")
        seen.add(path)
        if file != "-":
            _check_target(file, path, kinds)


def _check_target(file: str, path: Path, kinds: Sequence[str]) -> None:
    if not path.parent.is_dir():
        raise ValueError(f"{file}: No such file or directory: {path.parent}")
    if path.exists() and not path.is_file():
        raise ValueError(f"{file}: is no regular file")
    if kinds and path.suffix.removeprefix(".").lower() not in kinds:
        raise ValueError(f"{file}: unknown ending {path.suffix!r}; wanted: .{', .'.join(kinds)}")


def _bytes(content: Content) -> bytes:
    return content if isinstance(content, bytes) else content.encode()
