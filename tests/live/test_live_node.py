"""Pyodide in Node, where integers of NumPy have 32 bits: every chapter, and the core tests."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from lizarraga2025 import recorded

ROOT = Path(__file__).resolve().parents[2]
LIVE = ROOT / "tools" / "live"
SITE = "/lib/python3.14/site-packages"
LOCK = tomllib.loads((LIVE / "files.toml").read_text(encoding="utf-8"))["file"]
NEEDS = tomllib.loads((LIVE / "chapters.toml").read_text(encoding="utf-8"))
LIBRARIES = {
    "lxml": "lxml",
    "matplotlib": "matplotlib",
    "scipy": "scipy",
    "sympy": "sympy",
    "tomlkit": "tomlkit",
    "trimesh": "trimesh",
}
"""Parts of the lock, by the name that is imported."""

LACK = {"bodies": {"python-fcl"}}
"""Libraries that cannot be had in a page, by the chapters whose cells need them."""

CORE = [
    "tests/qbound/test_circle.py",
    "tests/qbound/test_frames.py",
    "engine/tests/test_harmonic.py",
    "engine/tests/test_zeros.py",
    "engine/tests/test_decomposition.py",
]


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    made = tmp_path_factory.mktemp("library") / "library.zip"
    subprocess.run([sys.executable, LIVE / "library.py", made], check=True)
    return made


@pytest.fixture
def in_node(files, library, tmp_path):
    """Run a job in Node and return what it says."""
    node = Path(sys.executable).with_name("node")
    program = node if node.exists() else shutil.which("node")

    def run(parts, **job):
        wheels = [files / each["name"] for each in LOCK if each["part"] in parts]
        mounts = {
            "/kernel": LIVE,
            "/engine/tests": ROOT / "engine" / "tests",
            "/tests/qbound": ROOT / "tests" / "qbound",
            "/results": tmp_path,
        }
        told = {
            "archives": [*map(str, wheels), str(library)],
            "site": SITE,
            "mounts": {inside: str(outside) for inside, outside in mounts.items()},
            "script": str(Path(__file__).with_name("in_node.py")),
            "env": {"MPLBACKEND": "agg"},
            **job,
        }
        (tmp_path / "job.json").write_text(json.dumps(told), encoding="utf-8")
        command = [program, LIVE / "node.mjs", files, tmp_path / "job.json"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        result = tmp_path / "done.json"
        assert result.is_file(), done.stdout[-3000:] + done.stderr[-3000:]
        return json.loads(result.read_text(encoding="utf-8")), done.stdout + done.stderr

    return run


@pytest.mark.parametrize("name", recorded.CHAPTERS)
def test_a_chapter_runs_whole_and_its_numbers_agree(in_node, name):
    notebook = ROOT / "notebooks" / f"{recorded.file_stem(name)}.ipynb"
    told = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    code = [(k, "".join(c["source"])) for k, c in enumerate(told) if c["cell_type"] == "code"]
    parts = {"base", *LIBRARIES.values()}
    done, _ = in_node(parts, chapter=name, cells=code)
    lost = set()
    for (number, _), answer in zip(code, done["answers"], strict=True):
        error = answer["error"] or {"what": "", "absent": ""}
        lost |= {error["absent"]} - {""}
        assert not error["what"] or (lost and (error["absent"] or "NameError" in error["what"])), (
            f"cell {number + 1}: {error}"
        )
    assert lost == LACK.get(name, set())
    compared = {each["id"]: each for answer in done["answers"] for each in answer["compared"]}
    wrong = [each for each in compared.values() if not each["agrees"]]
    assert wrong == []
    own = [each for each in recorded.results() if recorded.chapter_of(each["chapter"]) == name]
    expected = {each["id"] for each in own}
    assert lost or compared.keys() == expected
    if lost:
        return
    used = {LIBRARIES[each] for each in done["libraries"] if each in LIBRARIES}
    assert set(NEEDS.get(name, [])) == used


@pytest.mark.parametrize("name", CORE)
def test_the_core_computes_with_32_bits(in_node, name):
    parts = {"base", "matplotlib", "scipy", "sympy", "tomlkit", "tests"}
    done, said = in_node(parts, tests=[f"/{name}"])
    assert done["status"] == 0, said[-4000:]
