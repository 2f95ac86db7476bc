"""Reading of files up to a size, and writing: each whole or not at all, several together or none.

Drafts stand beside their files under names that nobody can guess. The drafts are renamed when all
of them are complete. A replaced file keeps its permissions. A link stays a link, and its target is
written. Commands replace only what cspace made (`refuse_replacing`).
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from cspace.printable import printable

if TYPE_CHECKING:
    from pathlib import Path

CIRCLE = "links lead in a circle"


LARGEST_FILE = 10_000_000
"""Bytes of a text file that is read: a robot file of 5,472 pairs of balls has half a million."""

MADE: Final = "Made by cspace"
"""Stands in the first lines of robot files and SRDFs that cspace writes."""

MARKS: Final = (
    rb"\A# " + MADE.encode(),  # robot files
    rb"<!-- " + MADE.encode(),  # SRDF
    rb'\A\{\s*"schema": "qbound/',  # JSON
    rb'\A\{"type": "FeatureCollection", "features": \[(\]|.*?\{"component": \d)',  # GeoJSON
    rb"\Acomponent,piece,ring,|\A[^\n]*,x_(m|cm|mm),y_",  # CSV: outlines, paths
    rb"\APK.{28}points\.npy",  # NumPy arrays
    rb"<dc:title>cspace<|Software\0cspace",  # pictures: SVG, PNG
    rb'<meta name="generator" content="cspace">',  # explorers
)
"""What files that cspace writes have in their first `START` bytes, as regular expressions."""

START: Final = 2000
"""Bytes of a file that are looked at before it is replaced."""


def read_bytes(path: str | Path, most: int = LARGEST_FILE) -> bytes:
    """Return what a file holds, without reading more than its largest size.

    Raises
    ------
    ValueError
        If the file holds more bytes than `most`, or has no end, as a device may. The message has
        no name, because the caller knows how the file is called.
    OSError
        If it cannot be read.
    """
    with open(os.fspath(path), "rb") as file:  # noqa: PTH123
        content = file.read(most + 1)
    if len(content) > most:
        raise ValueError(f"more than {most // 10**6} MB")
    return content


def refuse_replacing(path: str | Path, remedy: str = "choose another name") -> None:
    """Refuse to replace a file that cspace did not make, because it would be lost.

    Raises
    ------
    ValueError
        If the file exists, is not empty, and does not begin as a file of cspace does (`MARKS`).
    """
    try:
        with open(os.fspath(path), "rb") as file:  # noqa: PTH123
            start = file.read(START)
    except OSError:  # it is missing, or writing it will raise the right error
        return
    if start and not any(re.search(mark, start, re.DOTALL) for mark in MARKS):
        made = "not replaced, because cspace did not make this file"
        raise ValueError(printable(f"{path}: {made}; {remedy}"))


def write_whole(path: str | Path, content: bytes) -> None:
    """Write a file, complete or not at all; raises as `write_together`."""
    write_together([(path, content)])


def write_together(contents: Iterable[tuple[str | Path, bytes]]) -> None:
    """Write several files, each complete, or none of them.

    Raises
    ------
    OSError
        If a file cannot be written, with the reason; all files are then unchanged.
    """
    named = [(str(path), target(path), content) for path, content in contents]
    drafts: list[tuple[Path, Path]] = []
    try:
        for name, path, content in named:
            try:
                drafts.append((draft := path.with_name(f".{os.urandom(8).hex()}.part"), path))
                _fill(draft, content, path)
            except OSError as error:
                reason = error.strerror or error
                raise OSError(printable(f"{name}: not written: {reason}")) from None
        for draft, path in drafts:
            draft.replace(path)
    finally:
        for draft, _ in drafts:
            draft.unlink(missing_ok=True)


def target(path: str | Path) -> Path:
    """Return the place of a file to be written, all links followed.

    Raises
    ------
    OSError
        If links lead in a circle, the folder is missing, or the file cannot be replaced.
    """
    from pathlib import Path  # slow to import, and commands that write nothing do not need it

    try:
        found = Path(path).resolve()
        reason = _refusal(found)
    except RuntimeError:  # Python 3.11 and 3.12; later versions return the link unchanged
        reason = CIRCLE
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
    if reason:
        raise OSError(printable(f"{path}: {reason}"))
    return found


def _refusal(path: Path) -> str | None:
    """Return why a file cannot be written there; None if it can."""
    if path.is_symlink():
        return CIRCLE
    if not path.parent.is_dir():
        return f"No such file or directory: {path.parent}"
    if path.exists() and not path.is_file():
        return "is no regular file"
    barred = [place for place in (path, path.parent) if place.exists() and not _writable(place)]
    return f"no permission to write {barred[0]}" if barred else None


def _writable(path: Path) -> bool:
    return os.access(path, os.W_OK)


def _fill(draft: Path, content: bytes, path: Path) -> None:
    """Make the draft, with the permissions of the file that it replaces, if there is one."""
    kept = stat.S_IMODE(path.stat().st_mode) if path.exists() else None
    draft.touch(0o666 if kept is None else 0o600, exist_ok=False)
    draft.write_bytes(content)
    if kept is not None:
        draft.chmod(kept)
