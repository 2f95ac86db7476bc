"""Put Python, the library and the chapters' cells beside a built book, as classic scripts.

    python tools/live/pack.py FILES HTML

FILES is the folder of `fetch.py`, HTML the built pages. Each file becomes a script that hands over
base64 of gzip, because a page from the file system can load scripts and nothing else. Last of all
the list of the files is written, which tells the pages that they can run.
"""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import shutil
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fetch import is_there, wanted
from library import ROOT, library

HERE = Path(__file__).resolve().parent
FOLDER = "_live"
LIST = Path("_static", "rerun-files.js")
HIDES = LIST.with_suffix(".css")
"""Hides what needs Python, as long as there is none."""
LICENCES = "LICENCES.txt"
WORDS = ("LICEN", "COPYING", "NOTICE", "AUTHORS")

HEAD = """What this folder holds, and under which licence

These files let a page of the book run Python. Each script holds one file of another project,
unchanged, as base64 of gzip; `tools/live/files.toml` of the book's sources names its origin and its
SHA-256. python-flint (with FLINT, MPFR and GMP, which are LGPL) is a script of its own: who builds
another one can put it in its place. Pyodide is under the Mozilla Public License 2.0, whose text is
at mozilla.org/MPL/2.0. Its sources are in the npm package that the lock names.
"""


def script(name: str, content: bytes) -> str:
    """Return the script that hands over a file."""
    text = base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()
    return f"rerunTake({json.dumps(name)},{json.dumps(text)});\n"


def engine_files(folder: Path) -> Iterator[tuple[str, str, bytes]]:
    """Yield name, part and bytes of the files that every page shares."""
    yield "worker.js", "engine", (HERE / "worker.js").read_bytes()
    for file in for_pages():
        if not is_there(folder, file):
            raise SystemExit(f"{file['name']} is not in {folder}: run fetch.py first.")
        yield file["name"], file["part"], (folder / file["name"]).read_bytes()
    yield "library.zip", "library", library()
    yield "kernel.py", "kernel", (HERE / "kernel.py").read_bytes()
    yield "check_desk.py", "check", (HERE / "check_desk.py").read_bytes()
    yield "try_desk.py", "try", (HERE / "try_desk.py").read_bytes()
    yield "check.py", "check", (ROOT / "engine" / "cspace" / "check.py").read_bytes()


def for_pages() -> list[dict[str, Any]]:
    """Return the files of the lock without those that only tests need."""
    return [file for file in wanted() if file["part"] != "tests"]


def chapter(notebook: Path) -> dict[str, Any]:
    """Return the cells of a chapter, and how many results are recorded."""
    name = notebook.stem.partition("_")[2]
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    file = ROOT / "results" / f"{name}.json"
    recorded = json.loads(file.read_text(encoding="utf-8"))["results"] if file.is_file() else []
    return {
        "recorded": len(recorded),
        "cells": [
            {"index": k, "source": "".join(cell["source"])}
            for k, cell in enumerate(cells)
            if cell["cell_type"] == "code"
        ],
    }


def needs() -> dict[str, list[str]]:
    """Return the parts that each chapter needs."""
    return tomllib.loads((HERE / "chapters.toml").read_text(encoding="utf-8"))


def pages(html: Path) -> Iterator[tuple[str, str, bytes]]:
    """Yield the cells of each chapter that the book has."""
    for notebook in sorted((ROOT / "notebooks").glob("[0-9]*_*.ipynb")):
        if (html / "chapters" / f"{notebook.stem}.html").is_file():
            yield notebook.stem, "cells", json.dumps(chapter(notebook)).encode()


def licences(folder: Path) -> str:
    """Return one notice with the licences of all files."""
    parts = [HEAD]
    for file in for_pages():
        place = folder / file["name"]
        texts = [f"{'=' * 78}\n{file['name']}\n{file['licence']}\nSHA-256 {file['sha256']}\n"]
        if place.suffix == ".whl":
            with zipfile.ZipFile(place) as archive:
                names = [name for name in archive.namelist() if is_licence(name)]
                texts += [
                    f"--- {name}\n{archive.read(name).decode('utf-8', 'replace')}" for name in names
                ]
        parts.append("\n".join(texts))
    parts.append(f"{'=' * 78}\nqbound\n\n{(ROOT / 'LICENSE').read_text(encoding='utf-8')}")
    return "\n".join(parts)


def is_licence(name: str) -> bool:
    """Tell whether a member of a wheel is one of its licences."""
    return ".dist-info/" in name and any(word in name.upper() for word in WORDS)


def pack(folder: Path, html: Path) -> int:
    """Write the scripts and the list, and return how many bytes they take."""
    target = html / FOLDER
    shutil.rmtree(target, ignore_errors=True)
    target.mkdir()
    told, whole = list[dict[str, Any]](), 0
    for name, part, content in [*engine_files(folder), *pages(html)]:
        text = script(name, content)
        # The hash in the address: a browser never takes an older file for this one.
        file = f"{name}-{hashlib.sha256(content).hexdigest()[:8]}.js"
        (target / file).write_text(text, encoding="ascii")
        told.append({"name": name, "part": part, "script": file, "bytes": len(text)})
        if part == "cells":  # shown before the download: its size
            told[-1]["needs"] = needs().get(name.partition("_")[2], [])
        whole += len(text)
    (target / LICENCES).write_text(licences(folder), encoding="utf-8")
    listed = json.dumps({"folder": FOLDER, "files": told}, indent=1)
    (html / LIST).write_text(f"window.rerunFiles = {listed};\n", encoding="utf-8")
    (html / HIDES).write_text("", encoding="utf-8")
    return whole


if __name__ == "__main__":
    size = pack(Path(sys.argv[1]), Path(sys.argv[2]))
    print(f"   {size / 1e6:.0f} MB beside the book, in {FOLDER}/")
