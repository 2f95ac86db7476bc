"""What is made from what, for doit: it makes again what is stale, by content.

`python3 run.py` calls this file in .venv. A task is up to date if its sources, and whatever its
`uptodate` names, are those of its last complete run.
"""

import hashlib
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from doit.cmd_base import ModuleTaskLoader
from doit.doit_cmd import DoitMain
from doit.exceptions import BaseFail, UnmetDependency
from doit.reporter import ZeroReporter
from doit.task import Task
from doit.tools import config_changed
from run import (
    LOCK,
    OFFLINE,
    ROOT,
    VENV,
    Command,
    Failed,
    become,
    environment,
    in_venv,
    must,
    pip,
    prepare,
    say,
)

PYTHON, TOOLS = Path(sys.executable), ROOT / "tools"
NOTEBOOKS, RESULTS = ROOT / "notebooks", ROOT / "results"
EXECUTED = ROOT / ".executed"  # executed copies of chapters, with the results that they wrote
CHAPTERS, GENERATED, BUILD = (ROOT / "book" / name for name in ("chapters", "generated", "_build"))
FRONT_PAGE, PDF = BUILD / "html" / "index.html", BUILD / "qbound.pdf"
LIVE, WORKBOOK, DIST = ROOT / ".live", ROOT / "workbook", ROOT / "dist"
COMPARISON = Path("engine", "benchmarks", "side_by_side")
CHECKERS = ROOT / "tests" / "javascript"  # what checks JavaScript: pins and settings
NODE_MODULES = CHECKERS / "node_modules"

# Tasks for which the book is made; what they have made is recorded apart from the others, which may
# run beside them.
MAKE_BOOK = {"book", "claims", "chapter", "test", "live", "pdf", "pack"}
DONE = EXECUTED / "doit.json"

# Chapters that take long, the longest first, so that short ones begin last and both processes end
# at about the same time. A new chapter may be missing here, which only costs time.
LONG = ["workspace", "three_joints", "bodies", "proof", "many_robots"]
LONG += ["obstacles", "sampling", "theorem_1", "real_arm", "vector_labelling"]

Tasks = Iterator[dict[str, Any]]


def files(*patterns: str) -> list[str]:
    """Return the files of some patterns, without what is made among them."""
    made = {"__pycache__", ".ipynb_checkpoints", "_build", "chapters", "generated"}
    made |= {"qbound.egg-info", "cspace.egg-info"}
    found = {path for pattern in patterns for path in ROOT.glob(pattern) if path.is_file()}
    return sorted(str(path) for path in found if not made & set(path.relative_to(ROOT).parts))


SOURCES = files("src/**/*", "engine/cspace/**/*")
SHARED = [
    *SOURCES,
    *files(
        "tools/chapters/*",
        "engine/benchmarks/side_by_side.json",
        "pyproject.toml",
        "engine/pyproject.toml",
    ),
]
SHARED += [str(LOCK)]
PAGES = [*files("book/**/*", "CITATION.cff"), *SHARED]


def remove(path: Path) -> None:
    if path.exists():
        shutil.rmtree(path)


# --- one arithmetic -------------------------------------------------------------------------------

# The book is computed in one arithmetic, which every x86 has: this kernel of OpenBLAS, and NumPy
# without the features that a processor may have or not. A shell's own choice does not count there.
KERNEL = "Nehalem"
CHOOSES = ("OPENBLAS", "NPY_", "MKL_", "OMP_")
FEATURES = """import numpy, scipy.linalg
from numpy._core._multiarray_umath import __cpu_dispatch__ as names, __cpu_features__ as has
print(*names)
print(*(name for name in names if has[name]))"""
# It can be had on an x86; on a Mac, NumPy computes with Apple's own.
IS_X86 = platform.machine() in {"x86_64", "AMD64"} and sys.platform != "darwin"


def arithmetic(base: dict[str, str]) -> tuple[list[str], list[str], set[str]]:
    """Ask how .venv computes in an environment.

    Returns the features that NumPy can do without, those of them in use, and OpenBLAS's kernels.
    """
    asked = base | {"OPENBLAS_VERBOSE": "2"}
    done = subprocess.run(
        [PYTHON, "-c", FEATURES], env=asked, capture_output=True, text=True, check=True
    )
    optional, used = (line.split() for line in done.stdout.splitlines())
    return optional, used, set(re.findall(r"^Core: (\w+)", done.stderr, re.MULTILINE))


@cache
def one_arithmetic() -> dict[str, str]:
    """Return the environment for making the book, in which every x86 computes the same bits.

    NumPy and OpenBLAS ignore unknown names, so the settings in use are checked.
    """
    whole = environment()
    fixed = {name: value for name, value in whole.items() if not name.upper().startswith(CHOOSES)}
    fixed |= {name: whole[name] for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
    if not IS_X86:
        return fixed
    optional, _, _ = arithmetic(fixed)
    fixed |= {"OPENBLAS_CORETYPE": KERNEL, "NPY_DISABLE_CPU_FEATURES": " ".join(optional)}
    _, used, kernels = arithmetic(fixed)
    if used or kernels != {KERNEL}:
        found = " ".join([*sorted(kernels), *used]) or "no OpenBLAS"
        raise Failed(f"The book is computed with {KERNEL}'s arithmetic; it cannot be had: {found}")
    return fixed


def computed_by() -> dict[str, str]:
    """Return what decides the last digits of numbers."""
    return {"python": sys.version, "arithmetic": KERNEL if IS_X86 else platform.machine()}


# --- the verdicts ---------------------------------------------------------------------------------

LEDGER, JUDGED = RESULTS / "claims.json", EXECUTED / "claims.json"
READS_LEDGER = {"10_what_holds", "21_errata"}


def judge() -> None:
    begin()
    command = [PYTHON, "-m", "lizarraga2025", "claims", "--recompute", "--output", JUDGED]
    must("Judging every statement of the paper", command, one_arithmetic())
    shutil.copy(JUDGED, LEDGER)


def is_judged() -> bool:
    """Tell whether results/ has the verdicts that were computed."""
    both = LEDGER, JUDGED
    return all(map(Path.exists, both)) and len({file.read_bytes() for file in both}) == 1


def task_claims() -> dict[str, Any]:
    """Compute the verdict on every statement of the paper, before the chapters that show it."""
    return {
        "actions": [judge],
        "file_dep": [*SOURCES, str(LOCK)],
        "targets": [str(LEDGER)],
        "uptodate": [config_changed(computed_by()), is_judged],
    }


# --- what the printed digits leave open -----------------------------------------------------------

UNCERTAINTIES = RESULTS / "input_uncertainty.json"
NOT_OF_A_CHAPTER = {LEDGER, UNCERTAINTIES}


def draw() -> None:
    command = [PYTHON, "-m", "lizarraga2025.beyond.uncertainty", UNCERTAINTIES]
    must("Moving the printed digits (two minutes on a free core)", command, one_arithmetic())


def task_draws() -> dict[str, Any]:
    """Record what the printed digits leave open: the book reads it, tests draw some again."""
    return {"actions": [draw]}


# --- the chapters ---------------------------------------------------------------------------------


def chapters() -> list[Path]:
    """Return the notebooks, in the order in which they are executed."""

    def when(notebook: Path) -> tuple[int, str]:
        name = notebook.stem.partition("_")[2]
        return LONG.index(name) if name in LONG else len(LONG), name

    return sorted(NOTEBOOKS.glob("*.ipynb"), key=when)


def executed(notebook: Path) -> Path:
    """Return the executed copy of a chapter; its folder holds the chapter's results too."""
    return EXECUTED / notebook.stem / notebook.name


def is_apart(text: Path) -> bool:
    """Tell whether a chapter's text has other cells than its notebook, or no notebook at all."""
    import jupytext  # noqa: PLC0415 - it takes a second, and most runs do not need it

    def cells(path: Path, form: str) -> list[tuple[str, str]]:
        return [(c.cell_type, c.source) for c in jupytext.read(path, fmt=form).cells]

    notebook = text.with_suffix(".ipynb")
    return not notebook.exists() or cells(text, "md:myst") != cells(notebook, "ipynb")


def are_paired() -> None:
    """Refuse texts without their notebooks: the book is made from the notebooks."""
    if apart := [text for text in sorted(NOTEBOOKS.glob("[0-9]*_*.md")) if is_apart(text)]:
        names = " ".join(text.relative_to(ROOT).as_posix() for text in apart)
        advice = f"{in_venv('jupytext').relative_to(ROOT)} --sync {names} takes the newer of each."
        raise Failed(f"The text and the notebook of a chapter differ: {names}.\n{advice}")


def task_pairs() -> dict[str, Any]:
    """Compare the texts of chapters with their notebooks."""
    return {"actions": [are_paired], "file_dep": files("notebooks/[0-9]*")}


@cache
def begin() -> None:
    """Prepare for the first thing that is made: if this run is killed, nothing counts as made."""
    DONE.unlink(missing_ok=True)  # doit has read it, and writes it at the end


def execute(notebook: Path, dependencies: list[str]) -> None:
    """Execute a copy of a chapter, in a folder that takes the old one's place if all went well."""
    begin()
    start = time.time()
    folder, draft = executed(notebook).parent, EXECUTED / "drafts" / notebook.stem
    remove(draft)
    draft.mkdir(parents=True)
    copy = Path(shutil.copy(notebook, draft))
    command = [PYTHON, "-m", "pytest", "-q", "--no-header", "-p", "no:cacheprovider"]
    command += ["-c", ROOT / "pyproject.toml", "-p", "per_chapter"]
    command += ["--nbmake", "--overwrite", "--nbmake-timeout=900", copy]
    base = {"QBOUND_RESULTS": str(draft), "PYTHONPATH": str(TOOLS / "chapters")}
    must(f"Executing {notebook.stem}", command, one_arithmetic() | base)
    refuse_unrun(copy)
    if not IS_X86:
        compare = [PYTHON, TOOLS / "keep_results.py", draft, RESULTS]
        must(f"Comparing the results of {notebook.name} with the recorded ones", compare)
    # doit would take the chapter for made of what its sources are by now.
    if changed := [name for name in dependencies if Path(name).stat().st_mtime > start]:
        raise Failed(f"{changed[0]} changed while {notebook.stem} ran: make the book again.")
    remove(folder)
    draft.rename(folder)


def refuse_unrun(notebook: Path) -> None:
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    code = (c for c in cells if c["cell_type"] == "code" and "".join(c["source"]).strip())
    if any(cell.get("execution_count") is None for cell in code):
        raise Failed(f"{notebook.name}: cells did not run.")


def task_chapter() -> Tasks:
    """Execute a chapter."""
    for notebook in chapters():
        reads = [str(LEDGER)] if notebook.stem in READS_LEDGER else []
        if "Results(" in notebook.read_text(encoding="utf-8"):
            reads.append(str(UNCERTAINTIES))
        yield {
            "name": notebook.stem,
            "actions": [(execute, [notebook])],
            "file_dep": [str(notebook), *SHARED, *reads],
            "targets": [str(executed(notebook))],
            "task_dep": ["pairs"],
            "uptodate": [config_changed(computed_by())],
        }


# --- the pages ------------------------------------------------------------------------------------


def written() -> list[Path]:
    """Return the results that the chapters wrote."""
    return [file for one in chapters() for file in sorted(executed(one).parent.glob("*.json"))]


def take() -> None:
    """Take executed chapters and their results into the book; what is of no chapter goes."""
    results = dict[str, Path]()
    for file in written():
        if results.setdefault(file.name, file) != file:
            raise Failed(f"{file.parent.name} writes {file.name}, as another chapter does.")
    remove(CHAPTERS)
    CHAPTERS.mkdir()
    for notebook in chapters():
        shutil.copy2(executed(notebook), CHAPTERS)
    RESULTS.mkdir(exist_ok=True)
    kept = NOT_OF_A_CHAPTER | {RESULTS / name for name in results}
    for old in set(RESULTS.glob("*.json")) - kept:
        old.unlink()
    for name, file in results.items():
        shutil.copy(file, RESULTS / name)


def is_taken() -> bool:
    """Tell whether results/ has what the chapters wrote."""
    of_chapters = set(RESULTS.glob("*.json")) - NOT_OF_A_CHAPTER
    recorded = {file.name: file.read_bytes() for file in of_chapters}
    return recorded == {file.name: file.read_bytes() for file in written()}


# Ctrl-C ends Sphinx without a report of what it was doing.
SPHINX = """import signal, sys
from sphinx.cmd.build import main
signal.signal(signal.SIGINT, signal.SIG_DFL)
sys.exit(main(sys.argv[1:]))"""


def sphinx(builder: str, target: Path) -> Command:
    strict = ["-W", "-n", "--keep-going", "-q", "-j", "auto", "-b", builder]
    folders = ["-d", target / f"doctrees-{builder}", ROOT / "book", target / builder]
    return [PYTHON, "-c", SPHINX, *strict, *folders]


def build(printed: Path | None = None) -> None:
    """Build the pages beside the old ones, which stay until the new ones are whole.

    A PDF of an older book goes, unless it is the one that was just printed.
    """
    PDF.unlink(missing_ok=True)
    if printed is not None:
        shutil.copy(printed, PDF)
    target = BUILD / "next"
    remove(target)
    remove(GENERATED)
    base = one_arithmetic() | {"QBOUND_RESULTS": str(RESULTS)}
    must("Building the pages", sphinx("html", target), base)
    remove(FRONT_PAGE.parent)
    (target / "html").rename(FRONT_PAGE.parent)
    remove(target)


def task_book() -> dict[str, Any]:
    """Execute the chapters that changed, and build the pages."""
    return {
        "actions": [begin, take, build],
        "file_dep": [*PAGES, *(str(executed(notebook)) for notebook in chapters())],
        "targets": [str(FRONT_PAGE)],
        "uptodate": [is_taken],
        "task_dep": [f"chapter:{notebook.stem}" for notebook in chapters()],
    }


def browsers() -> list[str]:
    """Return the browsers of the family that prints PDFs."""
    names = ["chromium", "chromium-browser", "google-chrome", "chrome", "msedge"]
    return [path for path in map(shutil.which, names) if path]


def is_root() -> bool:
    """Tell whether this runs as root, as in many containers: browser and JupyterLab refuse that."""
    return getattr(os, "geteuid", lambda: 1)() == 0


def print_book() -> None:
    """Print to a side file; a complete PDF goes into the book, with pages that offer it."""
    scratch = BUILD / "pdf"
    remove(scratch)
    must("Building the book as one page", sphinx("singlehtml", scratch), one_arithmetic())
    draft, page = scratch / PDF.name, scratch / "singlehtml" / "index.html"
    options = ["--headless", "--disable-gpu", "--no-pdf-header-footer"]
    options += ["--no-sandbox"] if is_root() else []  # as in CI
    options += ["--virtual-time-budget=600000", "--generate-pdf-document-outline"]
    must("Printing", [browsers()[0], *options, f"--print-to-pdf={draft}", page.as_uri()])
    if not draft.exists():  # a browser may fail and say that all is well
        raise Failed("The browser has printed nothing.")
    build(printed=draft)
    remove(scratch)
    say(f"The PDF: {PDF.as_uri()}")


def task_pdf() -> dict[str, Any]:
    """Print the whole book to one PDF, which its front page then offers."""
    return {"actions": [print_book], "task_dep": ["book"]}


def add_python(folders: list[str]) -> None:
    """Fetch Pyodide and its packages, by hash, and pack them beside the built pages."""
    fetching = "Fetching what runs in a page (once; it takes 55 MB, and its carrier 106)"
    must(fetching, [PYTHON, TOOLS / "live" / "fetch.py", LIVE, *folders])
    packing = [PYTHON, TOOLS / "live" / "pack.py", LIVE, FRONT_PAGE.parent]
    must("Packing it beside the book", packing)


def task_live() -> dict[str, Any]:
    """Put Python beside the book, for pages that run (arguments: folders that have its files)."""
    return {"actions": [add_python], "task_dep": ["book"], "pos_arg": "folders"}


# --- what an author does --------------------------------------------------------------------------


def open_lab() -> None:
    must("Copying the notebooks", [PYTHON, TOOLS / "workbook.py", WORKBOOK])
    say(f"Your copies: {WORKBOOK} (delete one, and the next start brings it anew)")
    command = [PYTHON, "-m", "jupyter", "lab", "--notebook-dir", WORKBOOK]
    command += ["--allow-root"] if is_root() else []
    if status := subprocess.call(command, cwd=ROOT, env=environment()):
        raise Failed(f"JupyterLab has ended with status {status}.")


def task_lab() -> dict[str, Any]:
    """Open the notebooks in JupyterLab: copies of your own in workbook/, which git ignores."""
    return {"actions": [open_lab]}


def task_renumber() -> dict[str, Any]:
    """Write the parts that chapters share: numbers of references, first cells, their list."""
    return {"actions": [(must, ["Renumbering", [PYTHON, TOOLS / "renumber.py"]])]}


NO_NODE = "JavaScript is not checked: there is no Node here. Install nodejs and npm to check it."
SCRIPTS = ["engine/cspace/explorer/figure", "book/_static"]
SCRIPTS += ["tests/book/test_book_browser.js", "tools/live/worker.js"]
PROGRAMS = ["figure", "book", "tests"]  # each sees its own names: CHECKERS has a file for it


def find_node(program: str) -> str | Path | None:
    """Return `node` or `npm`: the environment's, from a wheel, or else the machine's."""
    own = in_venv(program)
    return own if own.exists() else shutil.which(program)


def task_checkers() -> dict[str, Any]:
    """Install the checkers of JavaScript, from their own lock."""
    quietly = ["--ignore-scripts", "--no-audit", "--no-fund", "--loglevel", "error"]
    command = [find_node("npm"), "ci", "--prefix", CHECKERS, *quietly]
    return {
        "actions": [(must, ["Installing the checkers of JavaScript (once)", command])],
        "file_dep": [str(CHECKERS / "package-lock.json")],
        "targets": [str(NODE_MODULES)],
    }


def task_lint() -> Tasks:
    """Check style, types, imports, licences, workflows; JavaScript too where there is Node."""
    checks: dict[str, Command] = {
        "Style (ruff check)": [in_venv("ruff"), "check", "--quiet"],
        "Layout (ruff format)": [in_venv("ruff"), "format", "--check"],
        "Types (mypy)": [in_venv("mypy")],
        "Imports (import-linter)": [in_venv("lint-imports")],
        "Chapters (run.py renumber)": [PYTHON, TOOLS / "renumber.py", "--check"],
        "Workflows (zizmor)": [in_venv("zizmor"), "--offline", "--quiet", ROOT / ".github"],
        "Licences (pip-licenses)": [in_venv("pip-licenses"), f"--output-file={os.devnull}"],
    }
    if not in_venv("zizmor").exists():  # it has no wheel for every system
        del checks["Workflows (zizmor)"]
    node, npm = find_node("node"), find_node("npm")
    if node is not None and npm is not None:
        biome = [node, NODE_MODULES / "@biomejs/biome/bin/biome", "check", "--error-on-warnings"]
        checks["Style of JavaScript (Biome)"] = [*biome, f"--config-path={CHECKERS}", *SCRIPTS]
        tsc = [node, NODE_MODULES / "typescript/bin/tsc", "--project"]
        for name in PROGRAMS:
            checks[f"Types of JavaScript (tsc, {name})"] = [*tsc, CHECKERS / f"{name}.json"]
    else:
        yield {"name": "without Node", "actions": [(say, [NO_NODE])]}
    for title, command in checks.items():
        needs = ["checkers"] if "JavaScript" in title else []
        yield {"name": title, "actions": [(must, [title, command])], "task_dep": needs}


# --- what a maintainer does -----------------------------------------------------------------------

# The extras of the library; the others are tools, of which the newest will do.
LIBRARY = ["symbolic", "figures", "proofs", "polygons", "files", "arms"]


def pin() -> None:
    options = ["--universal", "--python-version", "3.11", "--upgrade", "--quiet"]
    options += ["--fork-strategy", "fewest", "--generate-hashes"]
    options += ["--no-emit-index-url", "--no-emit-find-links", "--no-header", "--no-annotate"]
    lowest = ["--resolution", "lowest-direct", *(f"--extra={extra}" for extra in LIBRARY)]
    paper = ["--extra=notebooks", "--extra=build"]
    uv = shutil.which("uv")
    if uv is None:
        raise Failed("The locks are written by uv, and there is none: install it first.")
    ours, compared = ["pyproject.toml", "engine/pyproject.toml"], [COMPARISON / "requirements.in"]
    for source, target, chosen in (
        (ours, LOCK.name, ["--all-extras"]),
        (ours[:1], "requirements-paper.lock", [*paper, f"--constraint={LOCK.name}"]),
        (ours, "requirements-lowest.lock", lowest),
        (compared, COMPARISON / LOCK.name, []),
    ):
        command = [uv, "pip", "compile", *options, source, *chosen, "--output-file", target]
        must(f"Pinning {target}", command)
    say("The locks are written. Run book and test before you commit them.")


def task_lock() -> dict[str, Any]:
    """Pin every dependency again, by hash: the newest, and the oldest that is allowed."""
    return {"actions": [pin]}


def compare(quick: bool) -> None:
    """Measure in an environment of its own."""
    venv = ROOT / ".venv-bench"
    prepare(venv, ROOT / COMPARISON / LOCK.name)
    runner = [in_venv("python", venv), ROOT / COMPARISON / "run.py"]
    must("Asking everybody in turns (a quarter of an hour)", runner + ["--quick"] * quick)


def task_bench() -> dict[str, Any]:
    """Measure side by side with other tools; --quick is a trial run."""
    quick = {"name": "quick", "long": "quick", "type": bool, "default": False}
    return {"actions": [compare], "params": [quick]}


def pack() -> None:
    """Make the files of a release in dist/, and their checksums. No index is asked."""
    if browsers() and not PDF.exists():
        print_book()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    remove(DIST)
    must(
        "Building the wheels",
        [*pip(PYTHON, "wheel"), *OFFLINE, "--wheel-dir", DIST, ROOT, ROOT / "engine"],
    )
    cited = [ROOT / "LICENSE-text", ROOT / "CITATION.cff"]
    for what, sources in {"book": [FRONT_PAGE.parent], "results": [RESULTS, *cited]}.items():
        pack_folder(f"qbound-{what}-{project['version']}", sources)
    # In the form that `sha256sum --check` reads.
    sums = {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in DIST.iterdir()}
    lines = [f"{total}  {name}\n" for name, total in sorted(sums.items())]
    (DIST / "SHA256SUMS").write_text("".join(lines), encoding="utf-8", newline="\n")
    say(f"The files of the release: {DIST}")


def pack_folder(name: str, sources: list[Path]) -> None:
    """Zip files and folders below one folder of that name."""
    with tempfile.TemporaryDirectory() as scratch:
        target = Path(scratch, name)
        target.mkdir()
        for source in sources:
            copy = shutil.copytree if source.is_dir() else shutil.copy
            copy(source, target / source.name)
        shutil.make_archive(str(DIST / name), "zip", scratch, name)


def task_pack() -> dict[str, Any]:
    """Make the files of a release in dist/, and their checksums."""
    return {"actions": [pack], "task_dep": ["book"]}


# --- doit -----------------------------------------------------------------------------------------


class Reporter(ZeroReporter):
    """Steps say themselves what they do; here is what failed, once all that can be done is done."""

    def add_failure(self, task: Task, fail: BaseFail) -> None:
        if not isinstance(fail, UnmetDependency):
            told = fail.get_msg()
            self.failures.append(told.partition("run.Failed: ")[2] or f"{task.name}: {told}")

    def complete_run(self) -> None:
        say("\n".join(self.failures).strip()) if self.failures else None


def main(words: list[str]) -> int:
    task = words[0].partition(":")[0]
    if task == "pdf" and not browsers():
        say("The PDF is printed by Chromium, and there is none: install it first.")
        return 1
    makes_book = task in MAKE_BOOK
    record = DONE if makes_book else VENV / "doit.json"
    record.parent.mkdir(exist_ok=True)
    # Threads, because doit's processes cannot be had on every system; each waits for a program.
    config = {"dep_file": str(record), "backend": "json", "reporter": Reporter, "continue": True}
    config |= {"par_type": "thread", "num_process": 2} if makes_book else {}
    loader = ModuleTaskLoader(globals() | {"DOIT_CONFIG": config})
    tasks = ["book"] if task == "test" else words
    try:
        if makes_book:
            one_arithmetic()
        status = DoitMain(loader, config_filenames=()).run(["run", *tasks])
    except Failed as failure:
        say(str(failure))
        return 1
    except KeyboardInterrupt:
        say("Stopped.")
        return 130
    if status:
        return 2 if status == 3 else 1
    if task in {"book", "test", "live"}:
        say(f"The book: {FRONT_PAGE.as_uri()}")
    if task != "test":
        return 0
    # Nothing is printed after pytest, so that its summary is the last line. Of three processes on
    # two cores one mostly waits for a browser; each takes files from the others when it is done.
    pytest = [PYTHON, "-m", "pytest", "-n", "3", "--dist", "worksteal"]
    return become([*pytest, *words[1:]])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
