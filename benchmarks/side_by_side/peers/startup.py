"""What it costs to begin: time and memory of an import and of a command, size on disk.

Each import and command is a process of its own; processor time and peak memory are the system's
account of it. Bare Python ("nothing") is among them.
"""

from __future__ import annotations

import importlib.metadata
import os
import re
import subprocess
import sys
import time
from functools import lru_cache
from pathlib import Path

from serve import Missing, Timed, serve

IMPORTS = {"nothing": "pass", "qbound": "from qbound import *"}
"""What is no plain import: qbound loads nothing until a name is asked for, so all are."""

COMMANDS = {"contains": ["-m", "qbound", "contains", "minervabot-v2", "20deg", "-45deg"]}
KIB = 1 if sys.platform == "darwin" else 1024  # of ru_maxrss


def run(words: list[str]) -> Timed:
    """Run Python with these words; return wall and processor seconds, and the peak memory.

    It runs once before, so that compiled modules are there, as they are for a user.
    """
    command = [sys.executable, "-s", *words]
    warm(tuple(words))
    start = time.perf_counter()
    process = subprocess.Popen(
        command, env=plain_environment(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    )
    _, status, used = os.wait4(process.pid, 0)
    seconds = time.perf_counter() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    said = process.stderr.read().decode(errors="replace") if process.stderr else ""
    if process.returncode != 0:
        raise Missing(said.strip().splitlines()[-1] if said.strip() else "it failed")
    return seconds, used.ru_utime + used.ru_stime, {"memory": used.ru_maxrss * KIB}


@lru_cache(maxsize=64)
def warm(words: tuple[str, ...]) -> None:
    """Run Python once, whatever comes of it, so that its modules are compiled."""
    command = [sys.executable, "-s", *words]
    subprocess.run(command, env=plain_environment(), capture_output=True, check=False)


def plain_environment() -> dict[str, str]:
    """Return the environment without what changes Python, such as one that keeps no bytecode."""
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


def imported(scene: str) -> Timed:
    """Time the import of a module in a new process."""
    return run(["-c", IMPORTS.get(scene, f"import {scene}")])


def command(scene: str) -> Timed:
    """Time a command from the shell."""
    return run(COMMANDS[scene])


def size(scene: str) -> Timed:
    """Sum the sizes of a package's files and those of all that it needs; no time is taken."""
    packages = sorted(needs(scene))
    return 0.0, 0.0, {"bytes": sum(map(size_of, packages)), "packages": packages}


def needs(package: str) -> set[str]:
    """Return a package and all that it needs, extras left out, as far as they are installed."""
    found, left = set[str](), [package]
    while left:
        name = left.pop()
        if name in found or (name != package and not is_installed(name)):
            continue
        found.add(name)
        wanted = importlib.metadata.requires(name) or []
        left += [plain(text) for text in wanted if not re.search(r"\bextra\s*==", text)]
    return found


def plain(requirement: str) -> str:
    """Return the normalised name of a requirement."""
    name = re.match(r"[A-Za-z0-9._-]+", requirement)
    return re.sub(r"[-_.]+", "-", name.group() if name else requirement).lower()


def is_installed(package: str) -> bool:
    return next(importlib.metadata.distributions(name=package), None) is not None


def size_of(package: str) -> int:
    """Return the bytes of a package's files; of qbound those of its sources."""
    try:
        files = importlib.metadata.files(package) or []
    except importlib.metadata.PackageNotFoundError as error:
        raise Missing(str(error)) from error
    places = [Path(str(file.locate())) for file in files]
    if package == "qbound":
        import qbound

        sources = Path(qbound.__file__).parents[1]
        places = [path for path in sources.rglob("*") if not {"__pycache__"} & set(path.parts)]
    skipped = {".pyc"}
    return sum(p.stat().st_size for p in places if p.is_file() and p.suffix not in skipped)


if __name__ == "__main__":
    serve("start-up", {}, {"import": imported, "command": command, "size": size})
