"""A folder that a command fills: made if it is missing, and taken away if that fails."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def check_folder(name: str) -> None:
    """Refuse, before any work, a folder that is none and could not be made."""
    folder = Path(name)
    if folder.is_dir():
        return
    if folder.exists() or folder.is_symlink():
        raise ValueError(f"{name}: is no folder")
    if not folder.resolve().parent.is_dir():
        raise ValueError(f"{name}: No such file or directory: {folder.resolve().parent}")


@contextmanager
def made_folder(name: str) -> Iterator[None]:
    """Make a folder if it is missing, for as long as what is written into it succeeds."""
    folder = Path(name)
    new = not folder.is_dir()
    folder.mkdir(exist_ok=True)
    try:
        yield
    except BaseException:
        if new:
            folder.rmdir()
        raise
