"""The two commands on a fresh machine: what is installed when, and what is made again when.

They run in a small copy of the repository: run.py with a lock of one package, and dodo.py with two
chapters, whose execution, pages and tests are played by a few lines.
"""

from __future__ import annotations

import ast
import hashlib
import inspect
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from engine_support.scripts import load_script

ROOT = Path(__file__).resolve().parents[1]


def write(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")


def make_wheel(folder: str, name: str) -> str:
    """Write the smallest package that can be installed, without a program that builds it."""
    info = f"{name}-1.dist-info"
    parts = {
        f"{name}.py": "",
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    parts[f"{info}/RECORD"] = "".join(f"{part},,\n" for part in [*parts, f"{info}/RECORD"])
    file = f"{name}-1-py3-none-any.whl"
    with zipfile.ZipFile(f"{folder}/{file}", "w") as archive:
        for part, text in parts.items():
            archive.writestr(part, text)
    return file


BACKEND = f"""import zipfile
from collections.abc import Iterator
{inspect.getsource(make_wheel)}
def build_wheel(folder, *_):
    return make_wheel(folder, "house")
build_editable = build_wheel
"""
PYPROJECT = """[project]
name = "house"
version = "1"
[build-system]
requires = []
build-backend = "backend"
backend-path = ["."]
"""


def call(house: Path, *words: str, **settings: str) -> subprocess.CompletedProcess[str]:
    own = {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(house)}
    return subprocess.run(
        [sys.executable, *words],
        cwd=house,
        env=os.environ | own | settings,
        capture_output=True,
        text=True,
        check=False,
    )


# --- run.py: the environment ----------------------------------------------------------------------


def test_run_needs_the_standard_library_alone_and_refuses_an_old_python() -> None:
    text = (ROOT / "run.py").read_text(encoding="utf-8")
    imports = [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Import | ast.ImportFrom)]
    names = {a.name for n in imports if isinstance(n, ast.Import) for a in n.names}
    names |= {str(node.module) for node in imports if isinstance(node, ast.ImportFrom)}
    assert {name.partition(".")[0] for name in names} <= sys.stdlib_module_names
    assert "def " not in text[: text.index("if sys.version_info < (3, 11)")]
    ast.parse(text, feature_version=(3, 7))


ENGINE = {
    "engine/backend.py": BACKEND.replace("house", "engine"),
    "engine/pyproject.toml": PYPROJECT.replace("house", "engine"),
}

SAYS = """import os, sys
import thing
print("did", *sys.argv[1:], os.environ.get("PYTHONPATH"), os.environ["QBOUND_REQUIRE_BROWSER"])
sys.exit(len(sys.argv) - 1)
"""


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy with a lock of one package, in which nothing was installed yet."""
    house = tmp_path_factory.mktemp("bare")
    wheel = make_wheel(str(house), "thing")
    total = hashlib.sha256((house / wheel).read_bytes()).hexdigest()
    shutil.copy(ROOT / "run.py", house)
    lock = f"thing==1 --hash=sha256:{total}\n"
    write(house, {"dodo.py": SAYS, "backend.py": BACKEND, "pyproject.toml": PYPROJECT, **ENGINE})
    write(house, {"requirements.lock": lock, "results/a.json": "{}", "book/_build/x": ""})
    return house


def start(house: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Start run.py where there is no uv."""
    asked = {"PYTHONPATH": "elsewhere", "QBOUND_REQUIRE_BROWSER": "1"}
    return call(house, "run.py", *words, PATH=str(Path(sys.executable).parent), **asked)


def test_an_environment_is_made_once_by_hash_and_a_broken_installation_starts_over(
    bare: Path,
) -> None:
    right = (bare / "requirements.lock").read_text(encoding="utf-8")
    write(bare, {"requirements.lock": re.sub("sha256:.{4}", "sha256:0000", right)})
    done = start(bare, "book")
    assert done.returncode == 1
    assert "Stopped at: Installing the packages of requirements.lock" in done.stdout
    left = bare / ".venv/left"
    left.touch()
    write(bare, {"requirements.lock": right})
    for expected in ("Making .venv", "did"):
        done = start(bare, "book", "-x")
        assert (done.returncode, done.stderr) == (2, "")
        assert done.stdout.splitlines()[-1] == "did book -x None 1"
        assert done.stdout.splitlines()[0].removeprefix("-- ").startswith(expected)
        assert not left.exists()


def test_what_is_no_command_is_refused_before_anything_is_installed(bare: Path) -> None:
    for words in ([], ["frobnicate"], ["boo"]):
        done = start(bare, *words)
        assert done.returncode == 2
        assert "python3 run.py book" in done.stdout


def test_clean_keeps_the_results(bare: Path) -> None:
    assert start(bare, "clean").returncode == 0
    assert not (bare / "book/_build").exists()
    assert not (bare / ".venv").exists()
    assert (bare / "results/a.json").exists()


# --- dodo.py: the book ----------------------------------------------------------------------------

SPHINX = """import os, pathlib
def main(words):
    target = pathlib.Path(words[-1])
    target.mkdir(parents=True)
    results = sorted(pathlib.Path("results").glob("*.json"))
    (target / "index.html").write_text("".join(file.read_text() for file in results))
"""
NUMPY = "import sys; print('Core: Nehalem', file=sys.stderr)"
FEATURES = "__cpu_dispatch__, __cpu_features__ = [], {}"
PYTEST = """import json, os, pathlib, signal, sys, time
if "--nbmake" not in sys.argv:
    print(sys.argv[-2:])
    sys.exit(5)
signal.signal(signal.SIGINT, signal.SIG_DFL)
copy = pathlib.Path(sys.argv[-1])
with open("log", "a") as log:
    log.write(copy.stem + " ")
time.sleep(float(os.environ.get("SLOW", 0)) * (copy.stem == "02_b"))
if os.environ.get("FAIL") == copy.stem:
    sys.exit("a cell failed")
source = pathlib.Path("src/house/__init__.py").read_text()
name = "one" if "SAME" in os.environ else copy.stem
copy.with_name(name + ".json").write_text(source)
count = None if os.environ.get("UNRUN") == copy.stem else 1
cell = {"cell_type": "code", "source": ["1"], "execution_count": count}
copy.write_text(json.dumps({"cells": [cell], "metadata": {"at": time.time()}}))
"""
CELLS = """{"cells": [{"cell_type": "code", "source": ["%s"], "metadata": {}, "outputs": [],
"execution_count": null}], "metadata": {}, "nbformat": 4, "nbformat_minor": 4}
"""
TEXT = "```{code-cell} ipython3\n:tags: [a]\n\n%s\n```\n"
MODULE, PAGE = "src/house/__init__.py", "book/_build/html/index.html"
BOTH = {"01_a", "02_b"}


@pytest.fixture(scope="module")
def made_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    house = tmp_path_factory.mktemp("made")
    for name in ("run.py", "dodo.py"):
        shutil.copy(ROOT / name, house)
    played = {"tools/chapters/per_chapter.py": "", "tools/keep_results.py": ""}
    played |= {"pytest.py": PYTEST, "sphinx/__init__.py": "", "sphinx/cmd/__init__.py": ""}
    played |= {"sphinx/cmd/build.py": SPHINX, "numpy/__init__.py": NUMPY}
    played |= {"numpy/_core/__init__.py": "", "numpy/_core/_multiarray_umath.py": FEATURES}
    played |= {"scipy/__init__.py": "", "scipy/linalg.py": ""}
    sources = {MODULE: "x = 1\n", "requirements.lock": "", "pyproject.toml": PYPROJECT}
    sources |= {"book/index.md": "# A\n", "CITATION.cff": ""}
    sources |= {f"notebooks/{name}.ipynb": CELLS % 1 for name in BOTH}
    write(house, played | sources | {"results/old.json": "{}"})
    assert book(house) == BOTH
    return house


@pytest.fixture
def made(made_once: Path, tmp_path: Path) -> Iterator[Path]:
    """A copy in which the book was made: doit knows files by their paths, so it stays in place."""
    kept = shutil.copytree(made_once, tmp_path / "kept")
    yield made_once
    shutil.rmtree(made_once)
    shutil.copytree(kept, made_once)


def book(house: Path, *words: str, status: int = 0, **settings: str) -> set[str]:
    """Make the book; return the chapters that were executed."""
    (house / "log").write_text("")
    done = call(house, "dodo.py", *(words or ["book"]), **settings)
    assert done.returncode == status, done.stdout + done.stderr
    assert status or done.stdout.splitlines()[-1] == f"The book: {(house / PAGE).as_uri()}"
    return set((house / "log").read_text().split())


def pages(house: Path) -> str:
    return (house / PAGE).read_text(encoding="utf-8")


def edit(name: str, text: str):
    return lambda house: write(house, {name: text})


CHANGES = {
    "nothing": (lambda house: None, set()),
    "the time of a module": (lambda house: (house / MODULE).touch(), set()),
    "a page": (edit("book/index.md", "# B\n"), set()),
    "a result": (edit("results/01_a.json", "by hand"), set()),
    "a page that is gone": (lambda house: (house / PAGE).unlink(), set()),
    "the text of a chapter": (edit("notebooks/01_a.ipynb", CELLS % 2), {"01_a"}),
    "a module": (edit(MODULE, "x = 2\n"), BOTH),
    "a module that comes": (edit("src/house/new.py", ""), BOTH),
    "the lock": (edit("requirements.lock", "\n"), BOTH),
}


@pytest.mark.parametrize("what", CHANGES)
def test_what_a_change_concerns_is_executed_again_and_nothing_else(made: Path, what: str) -> None:
    before, (change, again) = (made / PAGE).stat().st_mtime_ns, CHANGES[what]
    change(made)
    assert book(made) == again
    rebuilt = (made / PAGE).stat().st_mtime_ns != before
    assert rebuilt == (what not in {"nothing", "the time of a module"})
    assert pages(made) == (made / MODULE).read_text() * 2
    assert book(made) == set()
    assert {file.name for file in (made / "results").iterdir()} == {"01_a.json", "02_b.json"}


def test_a_failing_chapter_leaves_the_others_executed_and_the_old_pages(made: Path) -> None:
    write(made, {MODULE: "x = 3\n"})
    assert book(made, status=1, FAIL="01_a") == BOTH
    assert pages(made) == "x = 1\n" * 2
    assert (made / "results/02_b.json").read_text() == "x = 1\n"  # only a whole book replaces it
    assert book(made) == {"01_a"}
    assert pages(made) == "x = 3\n" * 2


@pytest.mark.skipif(os.name == "nt", reason="a signal of POSIX")
def test_a_stopped_book_leaves_the_old_pages_and_can_be_made(made: Path) -> None:
    write(made, {MODULE: "x = 4\n"})
    with subprocess.Popen(
        [sys.executable, "dodo.py", "book"],
        cwd=made,
        env=os.environ | {"SLOW": "60"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as process:
        lines = iter(process.stdout.readline, "")
        assert any("done in" in line and "01_a" in line for line in lines)
        os.killpg(process.pid, signal.SIGINT)
        rest = list(lines)
    assert process.returncode == 130
    assert "Stopped.\n" in rest
    assert pages(made) == "x = 1\n" * 2
    assert "02_b" in book(made)


def test_two_chapters_may_not_record_one_file_and_results_go_with_their_chapter(made: Path) -> None:
    write(made, {MODULE: "x = 5\n"})
    done = call(made, "dodo.py", "book", SAME="1")
    assert (done.returncode, "writes one.json, as another" in done.stdout) == (1, True)
    assert book(made, status=1) == set()
    (made / "notebooks/01_a.ipynb").unlink()
    shutil.rmtree(made / ".executed")
    assert book(made) == {"02_b"}
    assert [file.name for file in (made / "results").iterdir()] == ["02_b.json"]
    assert [file.name for file in (made / "book/chapters").iterdir()] == ["02_b.ipynb"]


def test_a_text_without_its_notebook_stops_the_book_before_anything_is_executed(made: Path) -> None:
    """The book is made from the notebooks: an edit of the text alone would not be seen."""
    write(made, {"notebooks/01_a.md": TEXT % 1, MODULE: "x = 6\n"})
    assert book(made) == BOTH
    write(made, {"notebooks/01_a.md": TEXT % 2, "notebooks/03_c.md": TEXT % 3, MODULE: "x = 7\n"})
    (made / "log").write_text("")
    done = call(made, "dodo.py", "book")
    assert (done.returncode, (made / "log").read_text()) == (1, "")
    assert re.search(
        r"differ: notebooks/01_a\.md notebooks/03_c\.md\.\n.*jupytext --sync", done.stdout
    )


def test_the_tests_make_the_book_first_and_have_the_last_word(made: Path) -> None:
    write(made, {MODULE: "x = 8\n"})
    done = call(made, "dodo.py", "test", "-k", "circle or frames")
    assert done.returncode == 5
    assert done.stdout.splitlines()[-1] == "['-k', 'circle or frames']"
    assert pages(made) == "x = 8\n" * 2


def test_a_chapter_whose_cells_did_not_run_fails(made: Path) -> None:
    edit("notebooks/01_a.ipynb", CELLS % 2)(made)
    done = call(made, "dodo.py", "book", UNRUN="01_a")
    assert done.returncode == 1
    assert "01_a.ipynb: cells did not run." in done.stdout
    assert book(made) == {"01_a"}


# --- one arithmetic -------------------------------------------------------------------------------


def test_the_book_is_computed_in_one_arithmetic_whatever_the_shell_asks_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    dodo = load_script("dodo.py")
    if not dodo.IS_X86:
        pytest.skip("only on an x86 the book has one arithmetic")
    before = dodo.one_arithmetic()
    asked = {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": "", "OMP_DYNAMIC": "TRUE"}
    asked |= {"OPENBLAS_NUM_THREADS": "2", "MKL_CBWR": "AVX2", "NPY_PROMOTION_STATE": "weak"}
    for name, value in asked.items():
        monkeypatch.setenv(name, value)
    dodo.one_arithmetic.cache_clear()
    assert dodo.one_arithmetic() == before
    optional, used, kernels = dodo.arithmetic(before)
    assert len(optional) > 0
    assert (used, kernels) == ([], {"Nehalem"})
    assert dodo.arithmetic(dodo.environment())[2] == {"Haswell"}  # that of the tests is the shell's


RESULT = {"id": "a", "unit": "cm", "value": [1.5, 2.0], "numerical_error": 0.015}


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ([1.5, 2.01], "kept, differs by 0.67 of its error"),
        ([1.5, 2.02], "NOT THE RECORDED ONE, differs by 1.3 of its error"),
    ],
)
def test_a_result_is_kept_within_its_error_and_named(
    value: list[float], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tool = load_script("tools/keep_results.py")
    new = RESULT | {"value": value, "numerical_error": 0.016}
    for name, entry in {"old": RESULT, "new": new}.items():
        content = {"chapter": "c", "results": [entry]}
        write(tmp_path, {f"{name}/c.json": json.dumps(content)})
    assert tool.main(tmp_path / "new", tmp_path / "old") == 0
    [entry] = json.loads((tmp_path / "new/c.json").read_text())["results"]
    assert entry == (RESULT if said.startswith("kept") else new)
    assert capsys.readouterr().out.startswith(f"c/a: {said}")
