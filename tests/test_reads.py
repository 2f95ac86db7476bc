"""What the process of a chapter read is noted, whatever way it was read."""

from __future__ import annotations

import hashlib
import json
import os
import select
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from support.scripts import load_script

ROOT = Path(__file__).resolve().parent.parent
READS = ROOT / "tools" / "reads"


def noted(tmp_path: Path, lines: str, folder: Path = ROOT) -> list[list[str | None]]:
    """Run lines of Python as the kernel of a chapter runs, and return what was noted."""
    target = tmp_path / "reads"
    own = {"PYTHONPATH": str(READS), "QBOUND_READS": str(target), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-c", lines]
    subprocess.run(command, cwd=folder, env=os.environ | own, check=True, capture_output=True)
    return [json.loads(line) for line in target.read_text(encoding="utf-8").splitlines()]


def sha(name: str) -> str:
    return hashlib.sha256((ROOT / name).read_bytes()).hexdigest()


@pytest.mark.parametrize(
    "lines",
    [
        "open('CITATION.cff')",
        "open(b'CITATION.cff', 'rb')",
        "open('CITATION.cff', 'r+')",
        "import pathlib; pathlib.Path('CITATION.cff').read_text(encoding='utf-8')",
        "import os; os.open('CITATION.cff', os.O_RDONLY)",
        "import os; os.chdir('tests'); open('../CITATION.cff')",
        "import numpy; numpy.fromfile('CITATION.cff', dtype='u1')",
        "import threading as t; x = t.Thread(target=open, args=['CITATION.cff']); x.start()",
        "import subprocess, sys; subprocess.run([sys.executable, '-c', 'open(\"CITATION.cff\")'])",
    ],
)
def test_a_file_is_noted_with_its_hash(tmp_path: Path, lines: str) -> None:
    assert ["file", "CITATION.cff", sha("CITATION.cff")] in noted(tmp_path, lines)


def test_a_link_from_elsewhere_leads_to_what_is_noted(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(ROOT / "CITATION.cff")
    lines = f"open({str(tmp_path / 'link')!r})"
    assert ["file", "CITATION.cff", sha("CITATION.cff")] in noted(tmp_path, lines)


def test_a_module_is_noted_as_its_source_compiled_or_not(tmp_path: Path) -> None:
    name = "src/qbound/tolerances.py"
    subprocess.run([sys.executable, "-c", "import qbound.tolerances"], check=True)
    found = noted(tmp_path, "import qbound.tolerances")
    assert ["file", name, sha(name)] in found
    assert not [name for _, name, *_ in found if str(name).endswith(".pyc")]
    assert "src/qbound" in [name for kind, name, *_ in found if kind == "folder"]


def test_what_is_not_there_is_noted_as_absent(tmp_path: Path) -> None:
    lines = "import contextlib\nwith contextlib.suppress(OSError): open('src/nothing')"
    assert ["file", "src/nothing", None] in noted(tmp_path, lines)


def test_a_folder_is_noted_with_its_names_as_run_py_sees_them(tmp_path: Path) -> None:
    run: ModuleType = load_script("run.py")
    for lines in (
        "import os; os.listdir('src/qbound')",
        "import pathlib; list(pathlib.Path('src/qbound').glob('*.toml'))",
        "import os; next(os.walk('src/qbound'))",
    ):
        wanted = ["folder", "src/qbound", run.names_in(ROOT / "src/qbound")]
        assert wanted in noted(tmp_path, lines), lines


def test_programs_are_noted(tmp_path: Path) -> None:
    lines = (
        "import os, subprocess, sys; subprocess.run([sys.executable, '-V']); os.system('exit 0')"
    )
    found = [name for kind, name, *_ in noted(tmp_path, lines) if kind == "program"]
    assert found == [Path(sys.executable).name, "exit 0"]


def test_what_is_written_or_lies_elsewhere_is_not_noted(tmp_path: Path) -> None:
    """Nor what belongs to the environment: its packages are known by the lock."""
    lines = f"""
import numpy, os
own = {str(tmp_path / "own")!r}
open(own, "w").write("mine")
open(own).read()
open(os.devnull).read()
"""
    names = [name for kind, name, *_ in noted(tmp_path, lines, tmp_path) if kind == "file"]
    assert [name for name in names if not str(name).endswith("entry_points.txt")] == []


def test_copies_in_the_next_book_count_as_their_sources(tmp_path: Path) -> None:
    recorder = load_script("tools/reads/sitecustomize.py")
    named = {
        ".next/book/conf.py": "book/conf.py",
        ".next/made/01_a/a.json": None,
        "src/qbound/__pycache__/tolerances.cpython-311.pyc": "src/qbound/tolerances.py",
        ".git/HEAD": None,
        "src/../CITATION.cff": "CITATION.cff",
    }
    assert {path: recorder.below(ROOT / path) for path in named} == named


def test_without_a_file_to_write_to_nothing_is_watched(tmp_path: Path) -> None:
    own = {name: value for name, value in os.environ.items() if name != "QBOUND_READS"}
    lines = "open('CITATION.cff')"
    command = [sys.executable, "-c", lines]
    subprocess.run(command, cwd=ROOT, env=own | {"PYTHONPATH": str(READS)}, check=True)
    assert list(tmp_path.iterdir()) == []


CEILING = 180  # s: for a process that does not end; one that does ends in two


@pytest.mark.skipif(os.name == "nt", reason="a process keeps its parent's number there")
def test_the_run_that_executes_the_chapters_ends_with_the_one_that_started_it() -> None:
    """Whoever kills run.py and starts it again would have two runs that write the same files."""
    child = "import per_chapter as p; print(flush=True); p.end_with(p.os.getppid())"
    reading, writing = os.pipe()  # its end is read when the last process that holds it ends
    parent = f"""
import subprocess, sys
command = [sys.executable, "-c", {child!r}]
child = subprocess.Popen(command, stdout=subprocess.PIPE, pass_fds=[{writing}])
child.stdout.readline()
"""
    own = os.environ | {"PYTHONPATH": str(READS)}
    subprocess.run([sys.executable, "-c", parent], env=own, check=True, pass_fds=[writing])
    os.close(writing)
    ended, _, _ = select.select([reading], [], [], CEILING)
    os.close(reading)
    assert ended
