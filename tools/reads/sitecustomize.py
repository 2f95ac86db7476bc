"""Note what a process reads of this repository, so that a change of it can be seen.

Python imports this file when it starts, where this folder is on its path; ``run.py book`` puts it
there for the processes that execute the chapters. It does nothing unless QBOUND_READS names a file.
That file gets a line of JSON for each thing that is read, at the moment when it is read:

- ``["file", NAME, HASH]``: a file below the repository, or null for one that is not there; a
  compiled module counts as its source;
- ``["folder", NAME, HASH]``: a folder whose names were listed, as every import does;
- ``["program", NAME]``: a program that was started, which may read anything.

The environment is left out, because the lock names its packages. Two things are not seen: a file
that C code opens by itself, and the question whether a file exists if the file is not opened.
"""

import hashlib
import json
import os
import sys
import threading
from importlib.util import source_from_cache

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
OWN = "/qbound-"  # of the environment: the commands of this package
NEXT = ".next/"  # where the book is made: copies of the sources, which count as these
CHAPTERS = "book/chapters"
MADE = "made/"  # of NEXT: what a chapter writes
NO_SOURCE = {"__pycache__", ".ipynb_checkpoints", ".git"}
STARTS = {"subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.spawn"}
LISTS = {"os.listdir", "os.scandir"}
WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT


def start(target: str) -> None:
    """Watch this process; a child that it forks goes on with it."""
    seen: set[tuple[str, str]] = set()
    written: set[str] = set()
    own = threading.local()

    def note(kind: str, name: str, *more: str | None) -> None:
        if (kind, name) not in seen:
            seen.add((kind, name))
            with open(target, "a", encoding="utf-8") as file:
                file.write(json.dumps([kind, name, *more]) + "\n")

    def look(event: str, arguments: tuple) -> None:
        if event in STARTS:
            words = [word for word in arguments if isinstance(word, str | bytes | os.PathLike)]
            note("program", os.path.basename(os.fsdecode(words[0])) if words else "?")
        elif event in LISTS:
            folder = below(arguments[0] or ".")
            if folder is not None and folder != CHAPTERS:  # they come while this one runs
                note("folder", folder, names_in(folder))
        elif isinstance(arguments[0], str | bytes | os.PathLike):
            name = below(arguments[0])
            if name is None:
                return
            if writes(*arguments[1:3]):
                written.add(name)
            elif name not in written:
                note("file", name, content_of(name))

    def hook(event: str, arguments: tuple) -> None:
        if event != "open" and event not in STARTS and event not in LISTS:
            return
        if getattr(own, "busy", False):
            return
        own.busy = True
        try:
            look(event, arguments)
        finally:
            own.busy = False

    sys.addaudithook(hook)


def below(path: str | bytes | os.PathLike) -> str | None:
    """Return the name of a source in the repository, or None for what is none."""
    if isinstance(path, int):
        return None
    full = os.path.abspath(os.fsdecode(path))
    if not full.startswith(ROOT + os.sep) and full != ROOT:
        full = os.path.realpath(full)
    if full.endswith(".pyc") and os.path.basename(os.path.dirname(full)) == "__pycache__":
        full = source_from_cache(full)
    if full != ROOT and not full.startswith(ROOT + os.sep):
        return None
    name = os.path.relpath(full, ROOT).replace(os.sep, "/").removeprefix(NEXT)
    installed = (full + os.sep).startswith(sys.prefix + os.sep)
    if installed and not (OWN in name and name.endswith("/entry_points.txt")):
        return None
    return None if NO_SOURCE & set(name.split("/")) or name.startswith(MADE) else name


def writes(mode: str | None, flags: int) -> bool:
    """Tell whether a file is opened to be written and not to be read first."""
    if mode is not None:
        return any(letter in mode for letter in "wxa")
    return bool(flags & WRITING)


def content_of(name: str) -> str | None:
    """Return the hash of a file, or None where there is no file."""
    try:
        with open(os.path.join(ROOT, name), "rb") as file:
            return hashlib.sha256(file.read()).hexdigest()
    except OSError:
        return None


def names_in(folder: str) -> str | None:
    """Return the hash of the names in a folder, or None where there is no folder."""
    try:
        names = os.listdir(os.path.join(ROOT, folder))
    except OSError:
        return None
    return hashlib.sha256("\n".join(sorted(set(names) - NO_SOURCE)).encode()).hexdigest()


if os.environ.get("QBOUND_READS"):
    start(os.environ["QBOUND_READS"])
