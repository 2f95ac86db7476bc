"""The packages as an archive for Pyodide: modules, robots, recorded results, measurements.

    python tools/live/library.py TARGET

The archive holds the same bytes for the same sources. It does what a wheel would do, without a
build: a page unpacks it beside the other packages.
"""

from __future__ import annotations

import io
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KEPT = {".py", ".toml", ".json", ".urdf", ".srdf", ".js", ".css", ".html", ".svg", ".typed"}


def contents() -> Iterator[tuple[str, bytes]]:
    """Return the path and the bytes of each file of the archive."""
    for package in (ROOT / "engine/cspace", ROOT / "src/lizarraga2025", ROOT / "src/qbound"):
        for file in sorted(package.rglob("*")):
            if file.is_file() and (file.suffix in KEPT or file.name == "py.typed"):
                yield file.relative_to(package.parent).as_posix(), file.read_bytes()
    for file in sorted((ROOT / "results").glob("*.json")):
        yield f"lizarraga2025/recorded_results/{file.name}", file.read_bytes()
    measured = ROOT / "engine" / "benchmarks" / "side_by_side.json"
    yield f"lizarraga2025/{measured.name}", measured.read_bytes()
    for folder in (ROOT, ROOT / "engine"):
        project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        name, version = project["name"], project["version"]
        head = f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"
        yield f"{name}-{version}.dist-info/METADATA", head.encode()
    yield "LICENSE-qbound", (ROOT / "LICENSE").read_bytes()


def library() -> bytes:
    """Return the archive."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return made.getvalue()


if __name__ == "__main__":
    Path(sys.argv[1]).write_bytes(library())
