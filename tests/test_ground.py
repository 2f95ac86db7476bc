# ruff: noqa: E501  (one table, a case a line)
"""The ground: run.py, the lock, the metadata, the import contract, what the repository may hold."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
import yaml
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from lizarraga2025.ledger import cite
from support.scripts import load_script

ROOT = Path(__file__).resolve().parent.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
LOCK = (ROOT / "requirements.lock").read_text(encoding="utf-8")
PINS = [f"tests/javascript/{name}" for name in ("package.json", "package-lock.json")]


@pytest.fixture
def run() -> ModuleType:
    return load_script("run.py")


@pytest.fixture
def house(run: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A small copy of the repository's layout to which run.py's paths point."""
    for folder in ("src/qbound/forms", "notebooks", "book", "tests/javascript"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "src/qbound/forms/circle.py").write_text("TURN = 6.28\n")
    (tmp_path / "notebooks/01_a.ipynb").write_text(notebook({"source": ["1 + 1"]}))
    (tmp_path / "book/conf.py").write_text("project = 'qbound'\n")
    for name in ("pyproject.toml", "requirements.lock", *PINS):
        shutil.copy(ROOT / name, tmp_path / name)
    book = tmp_path / "book"
    places = {
        "ROOT": tmp_path,
        "VENV": tmp_path / ".venv",
        "LOCK": tmp_path / "requirements.lock",
        "CHAPTERS": book / "chapters",
        "BUILD": book / "_build",
        "GENERATED": book / "generated",
        "FRONT_PAGE": book / "_build/html/index.html",
        "BOOK_STAMP": book / "_build/made-from",
        "PDF": book / "_build/qbound.pdf",
        "RESULTS": tmp_path / "results",
        "EXECUTED": tmp_path / ".executed",
        "WORKBOOK": tmp_path / "workbook",
        "CHECKERS": tmp_path / "tests/javascript",
        "NODE_MODULES": tmp_path / ".venv/javascript/node_modules",
    }
    for name, place in places.items():
        monkeypatch.setattr(run, name, place)
    return tmp_path


def notebook(*cells: dict[str, object]) -> str:
    """The JSON of a notebook of code cells."""
    blank = {"cell_type": "code", "execution_count": None, "outputs": [], "metadata": {}}
    return json.dumps({"cells": [blank | cell for cell in cells], "metadata": {}})


# --- run.py: the command line ---------------------------------------------------------------------


def test_run_needs_the_standard_library_alone() -> None:
    tree = ast.parse((ROOT / "run.py").read_text(encoding="utf-8"))
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
    names = {
        name.split(".")[0]
        for node in imports
        for name in (
            [node.module or ""]
            if isinstance(node, ast.ImportFrom)
            else [alias.name for alias in node.names]
        )
    }
    assert names
    assert names <= sys.stdlib_module_names


def test_an_old_python_can_read_run_far_enough_to_be_refused() -> None:
    source = (ROOT / "run.py").read_text(encoding="utf-8")
    tree = ast.parse(source, feature_version=(3, 7))
    guard = next(i for i, node in enumerate(tree.body) if isinstance(node, ast.If))
    oldest = f"({Requirement('x' + PROJECT['requires-python']).specifier})"
    assert ast.unparse(tree.body[guard]).startswith("if sys.version_info < (3, 11):"), oldest
    assert oldest == "(>=3.11)"
    before = tree.body[1:guard]
    assert all(isinstance(node, ast.Import | ast.ImportFrom) for node in before)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([], "required"),
        (["frobnicate"], "invalid choice"),
        (["book", "-x"], "book takes"),
        (["lint", "src"], "lint takes no arguments, found: src"),
        (["bench", "--nope"], "bench takes --quick and nothing else, found: --nope"),
        (["bench", "--quick", "x"], "bench takes --quick and nothing else, found: --quick x"),
    ],
)
def test_a_wrong_command_line_exits_with_2_and_says_what_is_taken(
    run: ModuleType, words: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        run.read_command_line(words)
    said = capsys.readouterr().err
    assert "usage: run.py" in said
    assert told in said


def test_further_words_of_test_go_to_pytest(run: ModuleType) -> None:
    chosen, rest = run.read_command_line(["test", "-k", "circle or frames", "--pdb"])
    assert chosen.function is run.test
    assert rest == ["-k", "circle or frames", "--pdb"]


# --- run.py: the environment ----------------------------------------------------------------------


def install(run: ModuleType) -> None:
    """What an installation leaves behind, without installing."""
    python = run.in_venv("python")
    python.parent.mkdir(parents=True, exist_ok=True)
    python.touch()


def record_steps(run: ModuleType, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Replace the installation by a list of what it would have done."""
    steps: list[str] = []

    def note(title: str, *_: object, **__: object) -> None:
        steps.append(title)

    monkeypatch.setattr(run, "must", note)
    monkeypatch.setattr(run, "make_venv", lambda _: install(run))
    monkeypatch.setattr(run, "install_lock", lambda: steps.append("lock"))
    return steps


BOTH = ["lock", "Installing qbound itself"]


@pytest.mark.parametrize(
    ("changed", "again"),
    [(None, []), ("requirements.lock", BOTH), ("pyproject.toml", ["Installing qbound itself"])],
)
def test_only_what_changed_is_installed_again(
    run: ModuleType,
    house: Path,
    monkeypatch: pytest.MonkeyPatch,
    changed: str | None,
    again: list[str],
) -> None:
    steps = record_steps(run, monkeypatch)
    run.prepare()
    assert steps == BOTH
    leftover = run.VENV / "leftover"
    leftover.touch()
    if changed is not None:
        with (house / changed).open("a") as file:
            file.write("# changed\n")
    run.prepare()
    assert steps == [*BOTH, *again]
    assert leftover.exists() == (again != BOTH)


def test_an_interrupted_installation_starts_over(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps = record_steps(run, monkeypatch)
    whole = run.install_lock

    def killed() -> None:
        whole()
        raise KeyboardInterrupt

    monkeypatch.setattr(run, "install_lock", killed)
    with pytest.raises(KeyboardInterrupt):
        run.prepare()
    assert run.in_venv("python").exists()
    monkeypatch.setattr(run, "install_lock", whole)
    run.prepare()
    assert steps == ["lock", *BOTH]


@pytest.mark.parametrize(
    ("uv", "uv_status", "expected"),
    [(None, 1, ["pip"]), ("uv", 0, ["uv"]), ("uv", 1, ["uv", "pip"])],
)
def test_uv_installs_where_it_can_and_pip_elsewhere(
    run: ModuleType,
    house: Path,
    monkeypatch: pytest.MonkeyPatch,
    uv: str | None,
    uv_status: int,
    expected: list[str],
) -> None:
    used: list[str] = []

    def call(title: str, command: list[object], quiet: bool = False) -> int:
        used.append("uv" if command[0] == "uv" else "pip")
        assert "--require-hashes" in command
        return uv_status if command[0] == "uv" else 0

    monkeypatch.setattr(run, "call", call)
    monkeypatch.setattr(run.shutil, "which", lambda _: uv)
    run.install_lock()
    assert used == expected


def test_the_code_of_the_user_does_not_mix_in(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", "elsewhere")
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setenv("QBOUND_REQUIRE_BROWSER", "1")
    environment = run.environment()
    assert not environment.keys() & {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE"}
    assert environment["PYTHONNOUSERSITE"] == "1"
    assert environment["QBOUND_REQUIRE_BROWSER"] == "1"


# --- run.py: the arithmetic -----------------------------------------------------------------------


@pytest.fixture
def here(run: ModuleType, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """run.py, where the Python of the tests stands for that of .venv."""
    if not run.is_x86():
        pytest.skip("only on an x86 the book has one arithmetic")
    monkeypatch.setattr(run, "in_venv", lambda _: sys.executable)
    return run


def test_the_book_is_computed_in_one_arithmetic_whatever_the_shell_asks_for(
    here: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = here.one_arithmetic()
    asked = {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": "", "OMP_DYNAMIC": "TRUE"}
    asked |= {"OPENBLAS_NUM_THREADS": "2", "MKL_CBWR": "AVX2", "NPY_PROMOTION_STATE": "weak"}
    for name, value in asked.items():
        monkeypatch.setenv(name, value)
    assert here.one_arithmetic() == before
    optional, used, kernels = here.arithmetic(before)
    assert len(optional) > 0
    assert (used, kernels) == ([], {"Nehalem"})
    assert here.arithmetic(here.environment())[2] == {"Haswell"}  # that of the tests is the shell's


@pytest.mark.parametrize(
    ("name", "word", "wrong"),
    [("KERNEL", "Nehalem", "Nehalen"), ("FEATURES", "print(*names)", "print('AVX2')")],
)
def test_a_switch_that_nobody_obeys_is_noticed(
    here: ModuleType, monkeypatch: pytest.MonkeyPatch, name: str, word: str, wrong: str
) -> None:
    """NumPy 2.4 knows X86_V3 and not AVX2, and says nothing."""
    monkeypatch.setattr(here, name, getattr(here, name).replace(word, wrong))
    with pytest.raises(here.Failed, match="cannot be had: "):
        here.one_arithmetic()


@pytest.mark.parametrize("x86", [True, False])
def test_on_an_x86_no_result_is_kept(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch, x86: bool
) -> None:
    titles = fake_steps(run, monkeypatch)
    monkeypatch.setattr(run, "is_x86", lambda: x86)
    run.make_book()
    compared = "Comparing the results of 01_a.ipynb with the recorded ones"
    assert titles == [EXECUTE_ONE, *([] if x86 else [compared]), BUILD]


RESULT = {"id": "a", "unit": "cm", "value": [1.5, 2.0], "error": 0.015}


@pytest.mark.parametrize(
    ("value", "share", "kept"),
    [([1.5, 2.0], None, True), ([1.5, 2.01], 0.67, True), ([1.5, 2.02], 1.3, False)],
)
def test_on_another_processor_a_result_is_kept_within_its_error_and_named(
    value: list[float],
    share: float | None,
    kept: bool,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    tool = load_script("tools/keep_results.py")
    for name, entry in {"old": RESULT, "new": RESULT | {"value": value, "error": 0.016}}.items():
        (tmp_path / name).mkdir()
        content = {"chapter": "c", "results": [entry]}
        (tmp_path / name / "c.json").write_text(json.dumps(content))
    assert tool.main(tmp_path / "new", tmp_path / "old") == 0
    [entry] = json.loads((tmp_path / "new/c.json").read_text())["results"]
    assert entry == (RESULT if kept else RESULT | {"value": value, "error": 0.016})
    said = capsys.readouterr().out
    assert said.startswith("c/a: kept" if kept else "c/a: NOT THE RECORDED ONE")
    assert share is None or f" {share} of its error" in said


BENCH_LOCK = """\
contourpy==1.3.3 ; python_full_version < '3.12' \\
    --hash=sha256:a
contourpy==1.4.0 ; python_full_version >= '3.12' \\
    --hash=sha256:b
drake==1 \\
    --hash=sha256:c
msgspec==1 \\
    --hash=sha256:d
no-such.package==9 \\
    --hash=sha256:e
numpy==2 \\
    --hash=sha256:f
pin==4 \\
    --hash=sha256:g
setuptools==84 \\
    --hash=sha256:h
shapely==2 \\
    --hash=sha256:i
"""


def test_what_cannot_be_installed_for_the_comparison_is_missing_and_nothing_else(
    run: ModuleType,
    house: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    lock = house / run.COMPARISON / "requirements.lock"
    lock.parent.mkdir(parents=True)
    lock.write_text(BENCH_LOCK)
    installed: list[str] = []
    fails = {"no-such.package": "No matching distribution"}

    def trial(venv: Path, pin: str) -> str:
        assert venv == house / run.BENCH
        installed.append(pin)
        return fails.get(pin.partition("==")[0], "")

    def fail(*_: object) -> None:
        raise run.Failed("Stopped at: the lock")

    monkeypatch.setattr(run, "make_venv", lambda place: place.mkdir())
    monkeypatch.setattr(run, "install_pinned", fail)
    monkeypatch.setattr(run, "install_ourselves", lambda _: None)
    monkeypatch.setattr(run, "trial", trial)
    monkeypatch.setattr(run, "must", lambda *_: None)
    told = "Missing: no-such.package (No matching distribution)"
    for _ in range(2):  # it is not tried again, and told again
        assert run.main(["bench"]) == 0
        assert capsys.readouterr().out.count(told) == 1
    assert json.loads((house / run.BENCH / run.ABSENT).read_text()) == fails
    assert "".join(installed) == BENCH_LOCK  # each once, with its hashes
    fails["numpy"] = "no network"
    (house / run.BENCH / "bench.stamp").unlink()
    assert run.main(["bench"]) == 1
    assert "numpy" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("status", "said", "reason"),
    [
        (0, "WARNING: slow", ""),
        (1, "a\nERROR: no version of it (1, 2)\nERROR: No match for x\n", "No match for x"),
        (1, "  error: metadata-generation-failed\nhint: see above\n", "metadata-generation-failed"),
        (1, "", "no reason told"),
    ],
)
def test_a_trial_installs_by_hash_alone_and_says_why_not(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch, status: int, said: str, reason: str
) -> None:
    def fake(command: list[object], **_: object) -> SimpleNamespace:
        assert {"--require-hashes", "--no-deps"} <= set(command)
        assert Path(str(command[-1])).read_text() == "x==1 --hash=sha256:a\n"
        return SimpleNamespace(returncode=status, stderr=said)

    monkeypatch.setattr(run.subprocess, "run", fake)
    assert run.trial(Path("env"), "x==1 --hash=sha256:a\n") == reason


# --- run.py: the book -----------------------------------------------------------------------------


SOURCES = ["src/qbound/forms/circle.py", "notebooks/01_a.ipynb", "book/conf.py", "pyproject.toml"]
SOURCES += ["requirements.lock", "src/qbound/forms/that_comes.py"]
PRODUCTS = [
    "book/chapters/01_a.ipynb", "book/_build/html/index.html", "book/generated/qbound.rst",
    "src/qbound/__pycache__/circle.pyc", "src/qbound.egg-info/PKG-INFO",
    "notebooks/.ipynb_checkpoints/01_a.ipynb", "results/region.json",
]  # fmt: skip


@pytest.mark.parametrize("place", [*SOURCES, *PRODUCTS])
def test_a_source_that_changes_or_comes_makes_the_book_stale_and_what_was_made_does_not(
    run: ModuleType, house: Path, place: str
) -> None:
    before = run.fingerprint(house)
    (house / place).parent.mkdir(parents=True, exist_ok=True)
    with (house / place).open("a") as file:
        file.write(" \n")
    assert (run.fingerprint(house) != before) == (place in SOURCES)


def test_a_source_that_goes_or_is_renamed_makes_the_book_stale(
    run: ModuleType, house: Path
) -> None:
    module = house / "src/qbound/forms/circle.py"
    before = run.fingerprint(house)
    module.rename(module.with_name("round.py"))
    renamed = run.fingerprint(house)
    module.with_name("round.py").unlink()
    assert len({before, renamed, run.fingerprint(house)}) == 3


PAGE = "src/qbound/forms/circle.py"
EXECUTE_ONE, BUILD = "Executing 1 notebooks", "Building the pages"


def fake_steps(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch, executed: bool = True
) -> list[str]:
    """Replace nbmake and Sphinx by what they leave behind.

    The result of a chapter, and its copy, hold the text of a module.
    """
    titles: list[str] = []

    def must(title: str, command: list[object], quiet: bool = False, **_: object) -> None:
        titles.append(title)
        if title.startswith("Executing") and executed:
            for chapter in (word for word in command if str(word).endswith(".ipynb")):
                execute(Path(str(chapter)))
        if title.startswith("Building the pages"):
            html = run.BUILD / "next/html/index.html"
            for folder in (html.parent, run.BUILD / "next/doctrees-html", run.GENERATED):
                folder.mkdir(parents=True, exist_ok=True)
            shown = sorted(run.RESULTS.glob("*.json"))
            html.write_text("".join(file.read_text() for file in shown))

    def execute(chapter: Path) -> None:
        said = (run.ROOT / PAGE).read_text()
        chapter.write_text(notebook({"source": [said], "execution_count": 1}))
        chapter.with_name(f"{chapter.stem[3:]}.json").write_text(said)
        chapter.with_name("made-from.part").rename(chapter.with_name("made-from"))

    monkeypatch.setattr(run, "must", must)
    monkeypatch.setattr(run, "one_arithmetic", dict)
    monkeypatch.setattr(run, "settings", lambda: {"python": "3.13"})
    return titles


def book_files(house: Path) -> dict[str, bytes]:
    """Everything that a book is, by its path: pages, executed copies, results."""
    places = [house / "book/_build", house / "book/chapters", house / "results"]
    found = [file for place in places for file in place.rglob("*") if file.is_file()]
    return {file.relative_to(house).as_posix(): file.read_bytes() for file in found}


def test_the_book_is_made_once_and_again_when_a_source_changes(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    titles = fake_steps(run, monkeypatch)
    monkeypatch.setattr(run, "prepare", lambda: None)
    monkeypatch.setattr(run.subprocess, "call", lambda *_, **__: 0)
    assert [run.test(), run.test()] == [0, 0]
    assert titles == [EXECUTE_ONE, BUILD]
    (house / PAGE).write_text("TURN = 6.283\n")
    run.test()
    assert titles == [EXECUTE_ONE, BUILD] * 2


def test_the_committed_notebooks_are_not_written(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    committed = house / "notebooks/01_a.ipynb"
    before = committed.read_bytes()
    fake_steps(run, monkeypatch)
    run.make_book()
    assert committed.read_bytes() == before
    assert not run.unrun_cells(run.CHAPTERS / "01_a.ipynb")


def test_a_cell_that_did_not_run_stops_the_book(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    titles = fake_steps(run, monkeypatch, executed=False)
    with pytest.raises(run.Failed, match=r"01_a\.ipynb: cells did not run"):
        run.make_book()
    assert titles == [EXECUTE_ONE]
    assert not run.book_is_fresh()


RAN = {"source": ["1 + 1"], "execution_count": 1}


@pytest.mark.parametrize(
    ("cells", "unrun"),
    [
        ([RAN, {"cell_type": "markdown", "source": ["# A"]}, {"source": ["  \n", ""]}], False),
        ([RAN, {"source": ["2 + 2"]}], True),
        ([{"source": "3 + 3"}, RAN], True),
    ],
)
def test_a_cell_that_did_not_run_is_seen(
    run: ModuleType, tmp_path: Path, cells: list[dict[str, object]], unrun: bool
) -> None:
    path = tmp_path / "a.ipynb"
    path.write_text(notebook(*cells))
    assert run.unrun_cells(path) == unrun


def test_a_text_without_its_notebook_stops_the_book_before_anything_is_executed(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The book is made from the notebooks: an edit of the text alone would not be seen."""
    titles = fake_steps(run, monkeypatch)
    text = house / "notebooks/01_a.md"
    cell = "```{code-cell} ipython3\n---\ntags: [hide-input]\n---\n{}\n```\n"
    head = "---\nkernelspec:\n  name: python3\n---\n\n"
    text.write_text(head + cell.replace("{}", "1 + 1"))
    run.make_book()
    text.write_text(head + cell.replace("{}", "1 + 2"))
    with pytest.raises(run.Failed, match=r"differ: notebooks/01_a\.md\.\n.*jupytext --sync"):
        run.make_book()
    text.rename(house / "notebooks/02_new.md")
    with pytest.raises(run.Failed, match=r"differ: notebooks/02_new\.md"):
        run.make_book()
    assert titles == [EXECUTE_ONE, BUILD]


def test_every_chapter_of_the_book_is_in_step(run: ModuleType) -> None:
    texts = sorted((ROOT / "notebooks").glob("[0-9]*_*.md"))
    assert len(texts) > 10
    assert [text.name for text in texts if run.is_apart(text)] == []


def test_a_source_that_changes_meanwhile_is_noticed(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake_steps(run, monkeypatch)
    step = run.must

    def must(*arguments: object, **settings: object) -> None:
        step(*arguments, **settings)
        (house / "book/conf.py").write_text("project = 'changed'\n")

    monkeypatch.setattr(run, "must", must)
    with pytest.raises(run.Failed, match="changed while"):
        run.make_book()
    assert not run.book_is_fresh()


def test_a_failing_step_ends_the_run_with_its_status(
    run: ModuleType,
    house: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(run, "prepare", lambda: None)
    monkeypatch.setattr(run, "settings", dict)
    monkeypatch.setattr(run, "one_arithmetic", dict)
    monkeypatch.setattr(run, "install_checkers", lambda _: None)
    monkeypatch.setattr(run, "call", lambda *_, **__: 3)
    assert run.main(["book"]) == 3
    assert "Stopped at: Executing 1 notebooks" in capsys.readouterr().out
    assert run.main(["lint"]) == 1


def test_clean_keeps_the_sources_and_the_results(run: ModuleType, house: Path) -> None:
    kept = house / "results/region.json"
    made = [run.VENV, run.EXECUTED, run.CHAPTERS, run.BUILD, house / run.BENCH]
    made += [house / ".mypy_cache", house / "dist"]
    for folder in (kept.parent, *made):
        folder.mkdir(parents=True)
        (folder / "region.json").touch()
    assert run.main(["clean"]) == 0
    assert kept.exists()
    assert (house / "notebooks/01_a.ipynb").exists()
    assert not any(folder.exists() for folder in made)


# --- run.py: only what changed, and the old book until the new one is whole -----------------------


@pytest.fixture
def two(run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """A made book of two chapters; the titles of the steps that come after."""
    (house / "notebooks/02_b.ipynb").write_text(notebook({"source": ["2"]}))
    titles = fake_steps(run, monkeypatch)
    run.make_book()
    assert titles == ["Executing 2 notebooks", BUILD]
    titles.clear()
    return titles


ALL = ["Executing 2 notebooks", BUILD]
STAMP = "book/_build/made-from"
REMAKES: dict[str, tuple[Callable[[Path], object], list[str]]] = {
    "nothing": (lambda house: None, [BUILD]),
    "the time of a module": (lambda house: os.utime(house / PAGE, (0, 0)), [BUILD]),
    "a page": (lambda house: (house / "book/conf.py").write_text("\n"), [BUILD]),
    "a result": (lambda house: (house / "results/a.json").write_text("TURN = 6\n"), [BUILD]),
    "a module": (lambda house: (house / PAGE).write_text("TURN = 7\n"), ALL),
    "a module that comes": (lambda house: (house / PAGE).with_name("x.py").touch(), ALL),
    "the dependencies": (lambda house: (house / "pyproject.toml").write_text("[project]\n"), ALL),
    "the text of a chapter": (lambda house: (house / "notebooks/01_a.ipynb").write_text(notebook({"source": "3"})), [EXECUTE_ONE, BUILD]),
    "a copy that is gone": (lambda house: shutil.rmtree(house / ".executed/01_a"), [EXECUTE_ONE, BUILD]),
    "another mark of a chapter": (lambda house: (house / ".executed/01_a/made-from").write_text("{"), [EXECUTE_ONE, BUILD]),
}  # fmt: skip


@pytest.mark.parametrize("what", REMAKES)
def test_what_a_change_concerns_is_executed_again_and_nothing_else(
    run: ModuleType, two: list[str], what: str
) -> None:
    before = book_files(run.ROOT)
    change, titles = REMAKES[what]
    change(run.ROOT)
    run.make_book()
    assert two == titles
    assert run.book_is_fresh()
    after = book_files(run.ROOT)
    assert titles != [BUILD] or after == before | {STAMP: after[STAMP]}
    assert (run.RESULTS / "a.json").read_text() == (run.ROOT / PAGE).read_text()


def test_other_settings_execute_all(
    run: ModuleType, two: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "settings", lambda: {"python": "3.14"})
    run.make_book()
    assert two == ALL


def test_settings_are_python_lock_packages_and_what_of_the_shell_counts(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run.subprocess, "check_output", lambda *_, **__: "3.13\n")
    found = [run.settings()]

    def differs() -> list[str]:
        found.append(run.settings())
        return [key for key in found[-1] if found[-2][key] != found[-1][key]]

    for name in ("EDITOR", "OPENBLAS_CORETYPE", "OMP_PROC_BIND"):
        monkeypatch.setenv(name, "x")
        assert differs() == []
    for name in ("MPLBACKEND", "LC_ALL", "PYTHONOPTIMIZE"):
        monkeypatch.setenv(name, "x")
        assert differs() == ["environment"]
    run.LOCK.write_text(LOCK + "\n")
    assert differs() == ["lock"]
    (run.VENV / "lib/python3.13/site-packages/numpy-9.dist-info").mkdir(parents=True)
    assert differs() == ["packages"]
    monkeypatch.setattr(run.subprocess, "check_output", lambda *_, **__: "3.14\n")
    assert differs() == ["python"]


def test_two_chapters_may_not_record_one_file(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake_steps(run, monkeypatch)
    (house / "notebooks/02_a.ipynb").write_text(notebook({"source": ["2"]}))
    with pytest.raises(run.Failed, match=r"02_a\.ipynb writes a\.json"):
        run.make_book()


def test_the_results_of_a_chapter_that_is_gone_go(run: ModuleType, two: list[str]) -> None:
    (run.ROOT / "notebooks/02_b.ipynb").unlink()
    run.make_book()
    assert [file.name for file in run.RESULTS.iterdir()] == ["a.json"]
    assert sorted(file.name for file in run.CHAPTERS.glob("*.ipynb")) == ["01_a.ipynb"]


def test_the_pages_are_built_from_the_new_results(run: ModuleType, two: list[str]) -> None:
    (run.ROOT / PAGE).write_text("TURN = 7\n")
    run.make_book()
    assert run.FRONT_PAGE.read_text() == "TURN = 7\n" * 2


@pytest.mark.parametrize("step", ["Executing", "Building"])
def test_a_build_that_is_interrupted_leaves_the_old_pages(
    run: ModuleType, two: list[str], monkeypatch: pytest.MonkeyPatch, step: str
) -> None:
    before, whole = run.FRONT_PAGE.read_text(), run.must
    (run.ROOT / PAGE).write_text("TURN = 7\n")

    def killed(title: str, *arguments: object, **settings: object) -> None:
        whole(title, *arguments, **settings)
        if title.startswith(step):
            raise KeyboardInterrupt

    with monkeypatch.context() as context:
        context.setattr(run, "must", killed)
        with pytest.raises(KeyboardInterrupt):
            run.make_book()
    assert run.FRONT_PAGE.read_text() == before
    assert not run.book_is_fresh()
    run.make_book()
    assert run.book_is_fresh()
    assert run.FRONT_PAGE.read_text() == "TURN = 7\n" * 2


class Killed(BaseException):
    """Nothing is done after it."""


@pytest.mark.parametrize("failure", [KeyboardInterrupt, Killed])
@pytest.mark.parametrize(
    ("step", "ran", "change", "again"),
    [
        ("Executing", ["01_a"], None, [EXECUTE_ONE, BUILD]),
        ("Executing", [], None, ["Executing 2 notebooks", BUILD]),
        ("Building", ["01_a", "02_b"], None, [BUILD]),
        ("Executing", ["01_a", "02_b"], PAGE, ["Executing 2 notebooks", BUILD]),
        ("Executing", ["01_a", "02_b"], "notebooks/01_a.ipynb", [EXECUTE_ONE, BUILD]),
    ],
)
def test_what_a_broken_build_has_executed_is_not_executed_again(
    run: ModuleType,
    two: list[str],
    monkeypatch: pytest.MonkeyPatch,
    failure: type[BaseException],
    step: str,
    ran: list[str],
    change: str | None,
    again: list[str],
) -> None:
    (run.ROOT / PAGE).write_text("TURN = 7\n")
    whole = run.must

    def must(title: str, *arguments: object, **settings: object) -> None:
        whole(title, *arguments, **settings)
        if title.startswith(step):
            for made in run.EXECUTED.glob("*/made-from"):
                if made.parent.name not in ran:
                    made.unlink()
            raise failure

    with monkeypatch.context() as context:
        context.setattr(run, "must", must)
        with pytest.raises(failure):
            run.make_book()
    two.clear()
    if change is not None:
        (run.ROOT / change).write_text(notebook({"source": ["4"]}))
    run.make_book()
    assert two == again
    assert run.book_is_fresh()


# --- run.py: the author's loop and the PDF --------------------------------------------------------


@pytest.mark.parametrize(
    ("changed", "paired", "update"),
    [
        (["book/index.md"], [], True),
        (["notebooks/01_a.md"], ["Pairing 01_a.md"], True),
        (["notebooks/01_a.md", "notebooks/01_a.ipynb"], ["Pairing 01_a.md"], True),
        (["notebooks/02_gone.md"], [], False),
        (["notebooks/01_a.md", "src/qbound/forms/circle.py"], ["Pairing 01_a.md"], False),
        (["book/conf.py"], [], False),
        (["pyproject.toml"], [], False),
    ],
)
def test_where_text_alone_changed_the_other_pages_are_kept(
    run: ModuleType,
    house: Path,
    monkeypatch: pytest.MonkeyPatch,
    changed: list[str],
    paired: list[str],
    update: bool,
) -> None:
    (house / "notebooks/01_a.md").write_text("# A\n")
    (house / "book/index.md").write_text("# The book\n")
    done: list[object] = []
    monkeypatch.setattr(run, "must", lambda title, *_: done.append(title))
    monkeypatch.setattr(run, "make_book", lambda **options: done.append(options["update"]))
    run.remake({Path(name) for name in changed})
    assert done == [*paired, update]


def test_an_update_starts_from_the_pages_that_are_there(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake_steps(run, monkeypatch)
    run.make_book()
    (run.BUILD / "html/other.html").write_text("another page")
    run.make_book(update=True)
    assert (run.BUILD / "html/other.html").exists()
    run.make_book()
    assert not (run.BUILD / "html/other.html").exists()


def test_without_chromium_the_pdf_is_refused_in_a_sentence(
    run: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(run.shutil, "which", lambda _: None)
    monkeypatch.setattr(run, "prepare", lambda: pytest.fail("it asks for the browser first"))
    assert run.main(["pdf"]) == 1
    assert "printed by Chromium, and there is none" in capsys.readouterr().out


@pytest.fixture
def printer(run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, bytes]:
    """A browser that prints what the dictionary holds, onto an old PDF; without it, nothing."""
    fake_steps(run, monkeypatch)
    run.make_book()
    run.PDF.write_bytes(b"of last week")
    prints: dict[str, bytes] = {}
    build = run.must

    def must(title: str, command: list[object], quiet: bool = False, **settings: object) -> None:
        build(title, command, quiet, **settings)
        if title == "Printing" and "pdf" in prints:
            [option] = [str(w) for w in command if str(w).startswith("--print-to-pdf=")]
            draft = Path(option.partition("=")[2])
            draft.parent.mkdir(parents=True, exist_ok=True)
            draft.write_bytes(prints["pdf"])
        if title == "Printing" and prints.get("pdf") == b"half":
            raise KeyboardInterrupt

    monkeypatch.setattr(run, "must", must)
    monkeypatch.setattr(run, "prepare", lambda: None)
    monkeypatch.setattr(run, "browsers", lambda: ["chromium"])
    return prints


def test_a_pdf_belongs_to_its_book(run: ModuleType, printer: dict[str, bytes]) -> None:
    """The pages are built once more, with it; the next book begins without one."""
    printer["pdf"] = b"of today"
    assert run.main(["pdf"]) == 0
    assert run.PDF.read_bytes() == b"of today"
    assert run.book_is_fresh()
    assert not (run.BUILD / "pdf").exists()
    run.make_book(update=True)
    assert not run.PDF.exists()


def test_a_browser_that_prints_nothing_is_a_failure(
    run: ModuleType, printer: dict[str, bytes], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run.main(["pdf"]) == 1
    assert "has printed nothing" in capsys.readouterr().out
    assert run.PDF.read_bytes() == b"of last week"


def test_an_interrupted_printing_leaves_the_old_pdf(
    run: ModuleType, printer: dict[str, bytes]
) -> None:
    printer["pdf"] = b"half"
    assert run.main(["pdf"]) == 130
    assert run.PDF.read_bytes() == b"of last week"


# --- run.py: JavaScript ---------------------------------------------------------------------------


@pytest.fixture
def without_node(run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine without Node on which every step succeeds."""
    for name in ("CI", "QBOUND_REQUIRE_NODE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(run, "prepare", lambda: None)
    monkeypatch.setattr(run, "call", lambda *_, **__: 0)
    monkeypatch.setattr(run.shutil, "which", lambda _: None)


def test_without_node_lint_says_so_and_checks_the_rest(
    run: ModuleType, without_node: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run.main(["lint"]) == 0
    [line] = capsys.readouterr().out.splitlines()
    assert "JavaScript is not checked: there is no Node here." in line


@pytest.mark.parametrize(("name", "value"), [("CI", "true"), ("QBOUND_REQUIRE_NODE", "1")])
def test_where_node_is_required_its_absence_is_a_failure(
    run: ModuleType, without_node: None, monkeypatch: pytest.MonkeyPatch, name: str, value: str
) -> None:
    monkeypatch.setenv(name, value)
    assert run.main(["lint"]) == 1


def test_the_environments_node_comes_first(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run.shutil, "which", lambda name: f"/opt/{name}")
    assert run.find_node("node") == "/opt/node"
    install(run)
    run.in_venv("node").touch()
    assert run.find_node("node") == run.in_venv("node")


def test_the_checkers_are_installed_once_for_a_lock_and_again_after_a_failure(
    run: ModuleType, house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    steps = record_steps(run, monkeypatch)
    works = run.must

    def fails(*_: object, **__: object) -> None:
        works("failed")
        raise run.Failed("no network")

    install(run)
    monkeypatch.setattr(run, "must", fails)
    with pytest.raises(run.Failed):
        run.install_checkers("npm")
    monkeypatch.setattr(run, "must", works)
    for _ in range(2):
        run.install_checkers("npm")
    assert len(steps) == 2
    with (run.CHECKERS / "package-lock.json").open("a") as lock:
        lock.write("\n")
    run.install_checkers("npm")
    assert len(steps) == 3


def test_every_script_of_the_repository_is_checked(run: ModuleType) -> None:
    scripts = {p.relative_to(ROOT) for p in tracked() if p.suffix == ".js"}
    styled = {s for s in scripts for place in map(Path, run.SCRIPTS) if s.is_relative_to(place)}
    typed = {
        path.resolve().relative_to(ROOT)
        for name in run.PROGRAMS
        for pattern in json.loads((run.CHECKERS / f"{name}.json").read_text())["include"]
        for path in run.CHECKERS.glob(pattern)
        if path.suffix == ".js"
    }
    assert len(scripts) > 10
    assert styled == typed == scripts


def test_the_lock_of_the_checkers_pins_by_hash_and_holds_no_address() -> None:
    package, lock = ((ROOT / name).read_text(encoding="utf-8") for name in PINS)
    wanted = json.loads(package)["devDependencies"]
    pins = {name: pin for name, pin in json.loads(lock)["packages"].items() if name}
    assert {name: pins[f"node_modules/{name}"]["version"] for name in wanted} == wanted
    assert all(pin["integrity"].startswith("sha512-") for pin in pins.values())
    assert "://" not in lock
    assert "resolved" not in lock


# --- the lock and the metadata --------------------------------------------------------------------


def locked() -> dict[str, list[tuple[Requirement, int]]]:
    """Every pin of the lock, by name, with the number of its hashes."""
    pins: dict[str, list[tuple[Requirement, int]]] = {}
    for block in re.split(r"\n(?=\S)", LOCK.strip()):
        line, *hashes = block.replace("\\\n", "\n").split("\n")
        requirement = Requirement(line)
        count = sum(bool(re.fullmatch(r"\s+--hash=sha256:[0-9a-f]{64}\s*", h)) for h in hashes)
        assert count == len(hashes), f"not a hash in the block of {requirement.name}"
        pins.setdefault(canonicalize_name(requirement.name), []).append((requirement, count))
    return pins


def test_every_line_of_the_lock_is_a_pin_with_hashes() -> None:
    pins = [pin for found in locked().values() for pin in found]
    assert len(pins) > 100
    for requirement, hashes in pins:
        assert re.fullmatch(r"==[\w.+!]+", str(requirement.specifier)), requirement
        assert hashes > 0, requirement


def test_the_lock_holds_no_address() -> None:
    assert "://" not in LOCK
    assert not re.search(r"^\s*(-i|-f|-e|--index|--extra-index|--find-links|#)", LOCK, re.MULTILINE)


def test_the_lock_answers_every_name_in_pyproject() -> None:
    extras = PROJECT["optional-dependencies"]
    assert {"symbolic", "figures", "book", "test", "lint", "build"} <= set(extras)
    pins = locked()
    for text in (*PROJECT["dependencies"], *(name for names in extras.values() for name in names)):
        wanted = Requirement(text)
        found = pins[canonicalize_name(wanted.name)]
        for pin, _ in found:
            (pinned,) = pin.specifier
            assert wanted.specifier.contains(pinned.version), f"{text}: {pin}"


def test_all_pythons_compute_with_the_same_packages() -> None:
    split = [name for name, pins in locked().items() if len(pins) > 1]
    assert not {"numpy", "sympy", "scipy", "matplotlib", "shapely"} & set(split)


def test_environment_yml_uses_the_lock() -> None:
    conda = yaml.safe_load((ROOT / "environment.yml").read_text(encoding="utf-8"))
    *plain, pip = conda["dependencies"]
    assert pip == {"pip": ["-r requirements.lock"]}
    python = next(name for name in plain if name.startswith("python="))
    oldest = Requirement("x" + PROJECT["requires-python"]).specifier
    assert oldest.contains(python.removeprefix("python="))
    assert all(name.split("=")[0] in ("python", "pip") for name in plain)


def test_the_change_log_begins_with_the_version_and_its_day() -> None:
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    newest = re.search(r"^## \[(\S+)\] - (\S+)$", changes, re.MULTILINE)
    assert newest is not None
    assert newest[2] == str(PYPROJECT["tool"]["qbound"]["released"])
    now = Version(PROJECT["version"])
    assert str(now) == PROJECT["version"] == version("qbound")
    unreleased = changes.partition("## [Unreleased]\n")[2].partition("\n## [")[0]
    if unreleased.strip():  # a citation must not call this the release
        assert now.is_devrelease
        assert now > Version(newest[1])
    else:
        assert newest[1] == PROJECT["version"]


def test_the_citation_has_the_version_and_its_day() -> None:
    """Between releases it names no day: one is that of a release."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == PROJECT["version"]
    released = None if ".dev" in PROJECT["version"] else PYPROJECT["tool"]["qbound"]["released"]
    assert citation.get("date-released") == (released and str(released))
    assert citation["license"] == PROJECT["license"]


def test_the_paper_is_the_same_wherever_it_is_cited() -> None:
    """In BibTeX its letters are TeX's."""
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    [paper] = citation["references"]
    assert PROJECT["urls"]["Paper"] == f"https://doi.org/{paper['doi']}"
    bibliography = (ROOT / "book/references.bib").read_text(encoding="utf-8")
    accents = {"é": r"{\'e}", "á": r"{\'a}", "ó": r"{\'o}", "í": r"{\'i}"}
    fields = {key: paper[key] for key in ("title", "journal", "year", "volume", "doi")}
    fields |= {"number": paper["issue"], "pages": paper["start"]}
    for record in (cite.PAPER, bibliography.split("\n}\n")[0]):
        for key, value in fields.items():
            assert re.search(rf"\b{key} *= \{{{value}\}}", record), key
        for author in paper["authors"]:
            assert "".join(accents.get(c, c) for c in author["family-names"]) in record
        assert len(re.split(r"\sand\s", record.split("title")[0])) == len(paper["authors"])


# --- the package ----------------------------------------------------------------------------------


def build(kind: str, source: Path, target: Path) -> Path:
    """Build a wheel or an sdist of the tree at `source`, without a network."""
    call = f"import sys, setuptools.build_meta as b; print(b.build_{kind}(sys.argv[1]))"
    done = subprocess.run(
        [sys.executable, "-c", call, target], cwd=source, check=True, capture_output=True, text=True
    )
    return target / done.stdout.splitlines()[-1]


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sdist, unpacked."""
    copy, target = (tmp_path_factory.mktemp(name) for name in ("copy", "sdist"))
    skip = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in ("src", "results"):
        shutil.copytree(ROOT / name, copy / name, ignore=skip)
    for name in ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    with tarfile.open(build("sdist", copy, target)) as archive:
        archive.extractall(target, filter="data")
    return target / f"qbound-{PROJECT['version']}"


@pytest.fixture(scope="module")
def wheel(sdist: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel that is built from the sdist, unpacked as an installation would."""
    target = tmp_path_factory.mktemp("wheel")
    file = build("wheel", sdist, target)
    assert file.name == f"qbound-{PROJECT['version']}-py3-none-any.whl"
    with zipfile.ZipFile(file) as archive:
        archive.extractall(target / "site-packages")
    return target / "site-packages"


def files_below(folder: Path) -> dict[str, bytes]:
    return {
        p.relative_to(folder).as_posix(): p.read_bytes() for p in folder.rglob("*.*") if p.is_file()
    }


def of_both_packages(folder: Path) -> dict[str, bytes]:
    """The files of both packages, without what tools leave among them."""
    left = re.compile(r"__pycache__/|\.(egg|dist)-info/|\.pyc$")
    return {name: data for name, data in files_below(folder).items() if not left.search(name)}


def test_the_sdist_holds_every_file_of_both_packages_and_the_results(sdist: Path) -> None:
    assert of_both_packages(sdist / "src") == of_both_packages(ROOT / "src")
    assert files_below(sdist / "results") == files_below(ROOT / "results")
    assert not (sdist / "notebooks").exists()


def test_the_wheel_from_the_sdist_holds_every_file_of_both_packages(wheel: Path) -> None:
    """And results/ itself, so that `qbound claims` needs no repository."""
    results = files_below(ROOT / "results")
    recorded = {f"lizarraga2025/recorded_results/{name}": data for name, data in results.items()}
    sources = of_both_packages(ROOT / "src")
    assert {"qbound/py.typed", "lizarraga2025/py.typed"} <= set(sources)
    assert "lizarraga2025/ledger/statements/equations.toml" in sources
    assert recorded
    assert of_both_packages(wheel) == sources | recorded


ANSWERS = {
    "claims E-34": "E-34  eq. (34)",
    "claims E-34 --bibtex": "qbound-E-34",
    "claims E-5 --recompute": "E-5  eq. (5)",
    "results region/vertex.1": "region/vertex.1 = ",
    "robots show minervabot-v2": 'name = "MinervaBotV2"',
}


def test_the_wheel_answers_without_the_repository(wheel: Path, tmp_path: Path) -> None:
    lines = "from qbound.cli import main\nfor line in sys.argv[1:]: assert not main(line.split())"
    done = run_installed(wheel, tmp_path, lines, *ANSWERS)
    assert (done.returncode, done.stderr) == (0, "")
    assert [said for said in ANSWERS.values() if said not in done.stdout] == []


def test_the_wheel_loads_its_robots_and_all_its_modules(wheel: Path, tmp_path: Path) -> None:
    lines = """
import importlib, pkgutil
import lizarraga2025, qbound
for package in (lizarraga2025, qbound):
    assert package.__file__.startswith(sys.argv[1]), package.__file__
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
robots = [qbound.load_robot(name).name for name in qbound.packaged_robots()]
print(len(robots))
"""
    done = run_installed(wheel, tmp_path, lines, str(wheel))
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) == len(list((ROOT / "src/qbound/robots").glob("*.toml")))


def run_installed(
    wheel: Path, folder: Path, lines: str, *words: str
) -> subprocess.CompletedProcess[str]:
    """Run lines of Python that find the unpacked wheel before anything else."""
    return subprocess.run(
        [sys.executable, "-P", "-c", f"import sys\n{lines}", *words],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(wheel), "PYTHONUTF8": "1"},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


WRONG_IMPORTS = [
    ("qbound.forms.harmonic", "qbound.model.robot", "algebra that knows kinematics"),
    ("qbound.model.frames", "qbound.forms.circle", "kinematics that knows algebra"),
    ("qbound.boundary.functions", "qbound.region.outline", "a call upward"),
    ("qbound.model.robot", "qbound.boundary.functions", "a call upward"),
    ("qbound.measures.scaling", "qbound.figures.pictures", "a call upward"),
    ("qbound.sampling", "qbound.forms.circle", "no fair opponent"),
    ("qbound.sampling", "qbound.region.outline", "no fair opponent"),
    ("qbound.region.paper_rule", "lizarraga2025.printed", "a library that reads the paper"),
    ("qbound.cli.region", "lizarraga2025.ledger.claims", "a library that reads the paper"),
    ("lizarraga2025.results", "lizarraga2025.ledger.claims", "a call upward"),
    ("lizarraga2025.printed", "qbound.geometry.polygon", "data that computes"),
    ("lizarraga2025.evidence.arms", "lizarraga2025.computations.tables", "a call upward"),
    ("lizarraga2025.computations.tables", "lizarraga2025.ledger.claims", "a call upward"),
    ("qbound.check", "qbound.tolerances", "a checker that does not stand alone"),
]
RIGHT_IMPORTS = [
    ("qbound.cli.region", "qbound.figures.pictures"),
    ("qbound.measures.scaling", "qbound.geometry.polygon"),
    ("qbound.region.paper_rule", "qbound.forms.circle"),
    ("qbound.sampling", "qbound.boundary.functions"),
    ("qbound.model.robotfile", "qbound.model.robot"),
    ("lizarraga2025.computations.tables", "lizarraga2025.printed"),
    ("lizarraga2025.computations.tables", "qbound.region.region"),
    ("qbound.forms.circle", "qbound.tolerances"),
]


def check_imports(folder: Path, imports: list[tuple[str, str]]) -> subprocess.CompletedProcess[str]:
    """Write both packages with these imports, and those that a contract lets pass; lint them."""
    contracts = PYPROJECT["tool"]["importlinter"]["contracts"]
    named = [line for contract in contracts for line in contract.get("ignore_imports", ())]
    let_pass = [tuple(line.split(" -> ")) for line in dict.fromkeys(named)]
    for source in (ROOT / "src").rglob("*.py"):
        empty = folder / source.relative_to(ROOT / "src")
        empty.parent.mkdir(parents=True, exist_ok=True)
        empty.touch()
    for importer, imported in [*let_pass, *imports]:
        with (folder / f"{importer.replace('.', '/')}.py").open("a") as module:
            module.write(f"import {imported}\n")
    shutil.copy(ROOT / "pyproject.toml", folder)
    command = "from importlinter.cli import lint_imports_command as c; c()"
    return subprocess.run(
        [sys.executable, "-c", command, "--no-cache"],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "PYTHONUTF8": "1", "COLUMNS": "200"},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )


def test_the_import_contract_keeps_the_drawing(tmp_path: Path) -> None:
    done = check_imports(tmp_path, RIGHT_IMPORTS)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("half", [WRONG_IMPORTS[::2], WRONG_IMPORTS[1::2]], ids=["even", "odd"])
def test_the_import_contract_refuses(tmp_path: Path, half: list[tuple[str, str, str]]) -> None:
    """In a half no import begins where another ends: each is refused for itself."""
    assert not {row[0] for row in half} & {row[1] for row in half}
    done = check_imports(tmp_path, [(importer, imported) for importer, imported, _ in half])
    assert done.returncode == 1, done.stdout + done.stderr
    assert [row for row in half if f"{row[0]} -> {row[1]}" not in done.stdout] == []


def test_the_import_contract_refuses_a_module_without_a_place(tmp_path: Path) -> None:
    done = check_imports(tmp_path, [("qbound.attic", "qbound.forms.circle")])
    assert done.returncode == 1
    assert "attic" in done.stdout


# --- what the repository holds --------------------------------------------------------------------


def tracked() -> list[Path]:
    """Every file that is, or would be, committed."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout: nothing says which files belong to the repository")
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    paths = [ROOT / name for name in listed.split("\0") if name]
    return [path for path in paths if path.is_file()]


# Written in pieces, or this file would be found.
REGISTRIES = [".".join(parts) for parts in (
    ("pypi", "org"), ("pythonhosted", "org"), ("anaconda", "org"), ("npmjs", "org"),
    ("npmjs", "com"), ("jsdelivr", "net"), ("unpkg", "com"), ("deb", "debian", "org"),
)]  # fmt: skip


def test_no_file_names_a_registry_or_a_place_on_this_machine() -> None:
    banned = [*REGISTRIES, str(ROOT) + os.sep, str(Path.home()) + os.sep]
    found = [
        f"{path.relative_to(ROOT)}: {word}"
        for path in tracked()
        for word in banned
        if word.encode() in path.read_bytes()
    ]
    assert not found


def test_no_test_file_imports_another() -> None:
    """What two of them need is in `tests/support`: a file can be changed for its own sake."""
    files = sorted((ROOT / "tests").rglob("*.py"))
    names = {file.stem for file in files if file.stem.startswith(("test_", "conftest"))}
    assert len(names) > 40
    for file in files:
        tree = ast.parse(file.read_text(encoding="utf-8"))
        imports = [node for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)]
        modules = {node.module or "" for node in imports if isinstance(node, ast.ImportFrom)}
        modules |= {alias.name for node in imports for alias in node.names}
        assert not names & {part for module in modules for part in module.split(".")}, file.name


def test_the_products_are_not_committed(run: ModuleType) -> None:
    products = [run.VENV, run.CHAPTERS, run.BUILD, run.GENERATED]
    assert not [p for p in tracked() if any(place in p.parents for place in products)]


def test_the_hooks_download_nothing() -> None:
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text(encoding="utf-8"))
    assert {repo["repo"] for repo in hooks["repos"]} == {"local"}
    languages = {hook["language"] for repo in hooks["repos"] for hook in repo["hooks"]}
    assert languages == {"system"}


@pytest.mark.skipif(os.name == "nt", reason="Windows has no bit for it")
def test_the_check_in_a_clean_clone_can_be_started() -> None:
    assert os.access(ROOT / ".ci/run", os.X_OK)
    assert "QBOUND_REQUIRE_BROWSER=1" in (ROOT / ".ci/run").read_text(encoding="utf-8")


def test_the_lines_of_the_readme_run() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    [lines] = re.findall(r"(?s)```python\n(.*?)```", text)
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", lines], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


PAGES = ("README.md", "CONTRIBUTING.md", "docs/ARCHITECTURE.md")


@pytest.mark.parametrize("page", PAGES)
def test_whatever_a_page_points_to_is_there(page: str) -> None:
    path = ROOT / page
    targets = re.findall(r"\]\(([^)#:]+)\)", path.read_text(encoding="utf-8"))
    assert targets
    assert [target for target in targets if not (path.parent / target).exists()] == []


def test_every_file_that_the_architecture_names_is_there() -> None:
    text = (ROOT / "docs/ARCHITECTURE.md").read_text(encoding="utf-8")
    named = re.findall(r"`([\w./]+/[\w.]*|\w+\.py)`", text)
    assert len(named) > 50
    folders = (ROOT, ROOT / "src/qbound")
    assert [name for name in named if not any((at / name).exists() for at in folders)] == []
