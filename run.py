#!/usr/bin/env python3
"""One command for everything: make the book, run the tests, lint, lock, clean.

    python3 run.py quick    a first trial: environment, the claims of Table 6, two chapters
    python3 run.py book     execute the notebooks that changed and build the book (--live: see live)
    python3 run.py live     put Python beside the book: its chapters then run inside their pages
    python3 run.py test     run the tests (further arguments go to pytest)
    python3 run.py serve    show the book in a browser and follow what an author changes
    python3 run.py lab      open the notebooks in JupyterLab, as copies of your own
    python3 run.py pdf      print the book to one PDF (needs Chromium)
    python3 run.py lint     check style, types and the direction of imports, of JavaScript too
    python3 run.py lock     pin every dependency again, by hash
    python3 run.py renumber write numbers, references, first cells and the list of the chapters
    python3 run.py licences list the licence of everything that is installed in .venv
    python3 run.py bench    measure side by side with other tools (--quick: a trial of minutes)
    python3 run.py pack     make the files of a release in dist/, with their checksums
    python3 run.py clean    remove what the other commands made

It needs Python alone, because a reader who checks the paper may have nothing else. The tools are
installed once, in .venv, as requirements.lock pins them.
"""

import argparse
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
from collections.abc import Callable
from pathlib import Path

# This check is before the first definition, in syntax that Python 3.6 can read.
if sys.version_info < (3, 11):  # noqa: UP036
    sys.exit("qbound needs Python 3.11 or newer; this is Python " + sys.version.split()[0] + ".")

import tomllib  # which an older Python does not have

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
LOCK = ROOT / "requirements.lock"
LOWEST = ROOT / "requirements-lowest.lock"  # the oldest versions that pyproject.toml allows
TOOLS = ROOT / "tools"
CHAPTERS = ROOT / "book" / "chapters"
BUILD = ROOT / "book" / "_build"
GENERATED = ROOT / "book" / "generated"
FRONT_PAGE = BUILD / "html" / "index.html"
BOOK_STAMP = BUILD / "made-from"
PDF = BUILD / "qbound.pdf"  # the front page offers it where it is
RESULTS = ROOT / "results"
EXECUTED = ROOT / ".executed"  # executed copies of chapters, with the results that they wrote
LIVE = ROOT / ".live"  # files with which a page runs Python, by hash, from a lock of their own
WORKBOOK = ROOT / "workbook"  # a reader's copies of the notebooks
CHECKERS = ROOT / "tests" / "javascript"  # what checks JavaScript: pins and settings
NODE_MODULES = VENV / "javascript" / "node_modules"

# Sources of the book (a change of one makes the book stale), and files that are not sources.
SOURCES = ["src", "notebooks", "book", "pyproject.toml", LOCK.name, "CITATION.cff", "run.py"]
SOURCES += ["tools/chapters", "benchmarks/side_by_side.json"]
PRODUCTS = {"__pycache__", ".ipynb_checkpoints", "_build", "chapters", "generated"}
CACHES = [".hypothesis", ".import_linter_cache", ".mypy_cache", ".pytest_cache", ".ruff_cache"]
DIST = ROOT / "dist"
BENCH = ".venv-bench"  # the environment of the comparison with other tools
COMPARISON = Path("benchmarks", "side_by_side")
ABSENT = "not-installed.json"  # of that environment: packages of its lock, each with the reason
NEEDED = ["numpy", "msgspec", "setuptools"]  # by ourselves
CITED = ["LICENSE-text", "CITATION.cff"]  # beside the results of a release
BUILT = ["build", DIST.name, "src/qbound.egg-info"]

# Variables of the shell that may change a result, by the beginning of their names.
COUNTS = ("PYTHON", "IPYTHON", "JUPYTER", "MPL", "NUMPY", "LANG", "LC_", "TZ")
# The book is computed in one arithmetic, which every x86 has: this kernel of OpenBLAS, and NumPy
# without the features that a processor may have or not. A shell's own choice does not count there.
KERNEL = "Nehalem"
CHOOSES = ("OPENBLAS", "NPY_", "MKL_", "OMP_")
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}  # one order of a sum's terms
FEATURES = """import numpy, scipy.linalg
from numpy._core._multiarray_umath import __cpu_dispatch__ as names, __cpu_features__ as has
print(*names)
print(*(name for name in names if has[name]))"""
# Chapters that take long, the longest first, so that short ones begin last and both processes end
# at about the same time. A new chapter may be missing here, which only costs time.
LONG = ["workspace", "errata", "what_holds", "three_joints", "bodies", "proof", "many_robots"]
LONG += ["obstacles", "every_region", "sampling", "theorem_1", "real_arm", "vector_labelling"]
TRIED = ["06_theorem_2", "07_region"]  # the chapters of `run.py quick`
TABLE = "Table 6"  # and the part of the paper whose claims it computes again
# Sources that every chapter is computed with; a change executes all chapters.
SHARED = ("src/", "tools/", "benchmarks/", "pyproject.toml")

SCRIPTS = [
    "src/qbound/explorer/web",
    "book/_static",
    "benchmarks/live.js",
    "tests/test_book_browser.js",
    "tools/live/worker.js",
]
PROGRAMS = ["explorer", "book", "tests"]  # each sees its own names: CHECKERS has a file for it

NO_NODE = "JavaScript is not checked: there is no Node here. Install nodejs and npm to check it."

PORT = 8000  # of the author's local page

# The package is built with the lock's setuptools: no index is asked, nothing is downloaded.
OFFLINE = ["--no-index", "--no-deps", "--no-build-isolation"]
# The extras of the library; the others are tools, of which the newest will do.
LIBRARY = ["symbolic", "figures", "proofs", "polygons", "files", "arms"]

# A cell of code in a chapter's text: its source, without the fence and the metadata.
CELL = re.compile(
    r"^```\{code-cell\}[^\n]*\n(?:---\n.*?^---\n|(?::[^\n]*\n)*)(.*?)^```$", re.M | re.S
)

Command = list[str | Path]


class Failed(Exception):
    """Error: a step failed; has the message for the reader and the exit status."""

    def __init__(self, message: str, status: int = 1) -> None:
        super().__init__(message)
        self.status = status


# --- saying and calling ---------------------------------------------------------------------------


def say(text: str) -> None:
    print(text, flush=True)


def call(
    title: str,
    command: Command,
    quiet: bool = False,
    base: dict[str, str] | None = None,
    **settings: object,
) -> int:
    """Run a step in the repository, say how long it took, and return its exit status.

    A quiet command gets a sign of life every 15 seconds; the others show their own progress.
    Settings are added to its environment, which is `environment()` unless another is the base.
    """
    say(f"-- {title}")
    start = time.monotonic()
    whole = (base or environment()) | {name: str(value) for name, value in settings.items()}
    with subprocess.Popen(command, cwd=ROOT, env=whole) as process:
        while process.poll() is None:
            try:
                process.wait(timeout=15 if quiet else None)
            except subprocess.TimeoutExpired:
                say(f"   ... {time.monotonic() - start:.0f} s")
    outcome = "done" if process.returncode == 0 else "FAILED"
    say(f"   {outcome} in {time.monotonic() - start:.1f} s")
    return process.returncode


def must(title: str, command: Command, quiet: bool = False, **settings: object) -> None:
    """Run a step that the next ones need."""
    status = call(title, command, quiet, **settings)
    if status != 0:
        raise Failed(f"Stopped at: {title}.", status)


def environment() -> dict[str, str]:
    """Return the shell's environment, without variables that mix in the user's code and settings.

    It must not forbid bytecode either, because each of some thousand processes would compile all
    imports.
    """
    mixes_in = {"PYTHONPATH", "QBOUND_RESULTS", "PYTHONDONTWRITEBYTECODE"}
    kept = {name: value for name, value in os.environ.items() if name not in mixes_in}
    return kept | {
        "IPYTHONDIR": str(VENV / "ipython"),
        "JUPYTER_PREFER_ENV_PATH": "1",
        "MPLCONFIGDIR": str(VENV / "matplotlib"),
        **ONE_THREAD,
        "PYTHONHASHSEED": os.environ.get("QBOUND_HASH_SEED", "0"),  # .ci/run takes another
        "PYTHONNOUSERSITE": "1",
    }


def one_arithmetic() -> dict[str, str]:
    """Return the environment for making the book, in which every x86 computes the same bits.

    NumPy and OpenBLAS ignore unknown names, so the settings in use are checked.
    """
    fixed = {k: v for k, v in environment().items() if not k.upper().startswith(CHOOSES)}
    fixed |= ONE_THREAD
    if not is_x86():
        return fixed
    optional, _, _ = arithmetic(fixed)
    fixed |= {"OPENBLAS_CORETYPE": KERNEL, "NPY_DISABLE_CPU_FEATURES": " ".join(optional)}
    _, used, kernels = arithmetic(fixed)
    if used or kernels != {KERNEL}:
        found = " ".join([*sorted(kernels), *used]) or "no OpenBLAS"
        raise Failed(f"The book is computed with {KERNEL}'s arithmetic; it cannot be had: {found}")
    return fixed


def is_x86() -> bool:
    """Tell whether the one arithmetic can be had; on a Mac, NumPy computes with Apple's own."""
    return platform.machine() in {"x86_64", "AMD64"} and sys.platform != "darwin"


def arithmetic(base: dict[str, str]) -> tuple[list[str], list[str], set[str]]:
    """Ask how .venv computes in an environment.

    Returns the features that NumPy can do without, those of them in use, and OpenBLAS's kernels.
    """
    done = subprocess.run(
        [in_venv("python"), "-c", FEATURES],
        cwd=ROOT,
        env=base | {"OPENBLAS_VERBOSE": "2"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise Failed(f"NumPy cannot be imported:\n{done.stderr}")
    optional, used = (line.split() for line in done.stdout.splitlines())
    return optional, used, set(re.findall(r"^Core: (\w+)", done.stderr, re.MULTILINE))


def remove(path: Path) -> None:
    if path.exists():
        shutil.rmtree(path)


def digest(*parts: object) -> str:
    return hashlib.sha256("\n".join(map(str, parts)).encode()).hexdigest()


# --- the environment ------------------------------------------------------------------------------


def prepare() -> None:
    """Make .venv as the lock says. Each stamp is written last: a killed install starts over."""
    if not is_stamped("lock"):
        remove(VENV)
        make_venv(VENV)
        install_lock()
        stamp("lock").write_text(wanted("lock"))
    if not is_stamped("package"):
        install_ourselves(VENV)
        stamp("package").write_text(wanted("package"))


def stamp(name: str) -> Path:
    return VENV / f"{name}.stamp"


def is_stamped(name: str) -> bool:
    made = in_venv("python").exists() and stamp(name).exists()
    return made and stamp(name).read_text() == wanted(name)


def wanted(name: str) -> str:
    """Return the stamp of an up-to-date .venv; a moved one is stale, as it calls its old path."""
    if name == "lock":
        return digest(LOCK.read_text(encoding="utf-8"), sys.version_info[:2], VENV)
    if name == "javascript":
        return digest((CHECKERS / "package-lock.json").read_text(encoding="utf-8"))
    return digest((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def install_lock() -> None:
    install_pinned(VENV, LOCK)


def install_pinned(venv: Path, lock: Path) -> None:
    """Install with uv, which is faster; with pip if there is no uv or it fails.

    Modules are compiled when they are imported, because most modules of the tools never are.
    """
    title = "Installing the packages of requirements.lock (once; a minute or so)"
    options = ["--require-hashes", "--requirement", lock]
    uv = shutil.which("uv")
    if uv is not None:
        command = [uv, "pip", "install", "--quiet", "--python", in_venv("python", venv), *options]
        if call(title, command, quiet=True) == 0:
            return
    must(title, [*pip(venv), "--no-compile", *options], quiet=True)


def install_what_can_be(venv: Path, lock: Path) -> dict[str, str]:
    """Install a lock package by package; return those that cannot be installed, each with why.

    Hashes are kept, and dependencies are in the lock like all else.
    """
    blocks = re.split(r"^(?=[A-Za-z0-9])", lock.read_text(encoding="utf-8"), flags=re.MULTILINE)
    pins = dict[str, str]()
    for block in blocks[1:]:
        name = block.partition("==")[0]
        pins[name] = pins.get(name, "") + block  # twice, where Pythons need their own
    say(f"-- Installing {len(pins)} packages one by one")
    tried = {name: trial(venv, pin) for name, pin in pins.items()}
    missing = {name: why for name, why in tried.items() if why}
    if not missing.keys().isdisjoint(NEEDED):
        raise Failed(f"Not installed: {missing}. Without {', '.join(NEEDED)} nothing is measured.")
    return missing


def trial(venv: Path, pin: str) -> str:
    """Install a pinned package without dependencies; return why it failed, or nothing."""
    with tempfile.TemporaryDirectory() as scratch:
        part = Path(scratch, "part.lock")
        part.write_text(pin, encoding="utf-8")
        options = ["--no-compile", "--no-deps", "--require-hashes", "--requirement", part]
        command = [*pip(venv), *options]
        done = subprocess.run(
            command, env=environment(), stderr=subprocess.PIPE, text=True, check=False
        )
    errors = re.findall(r"(?im)^ *error: *(.+)", done.stderr) or ["no reason told"]
    return errors[-1] if done.returncode else ""


def install_ourselves(venv: Path) -> None:
    must("Installing qbound itself", [*pip(venv), *OFFLINE, "--editable", "."], quiet=True)


def make_venv(place: Path) -> None:
    # Not sys.executable: that may lie in the .venv that is just being replaced.
    python = getattr(sys, "_base_executable", sys.executable)
    if call(f"Making {place.name}", [python, "-m", "venv", place]) != 0:
        remove(place)
        raise Failed("No virtual environment. On Debian or Ubuntu: apt install python3-venv")


def in_venv(program: str, place: Path | None = None) -> Path:
    """Return the path of a program of the environment, on Windows too."""
    venv = place or VENV
    return venv / "Scripts" / f"{program}.exe" if os.name == "nt" else venv / "bin" / program


def find_node(program: str) -> str | Path | None:
    """Return `node` or `npm`: the environment's, from a wheel, or else the machine's."""
    own = in_venv(program)
    return own if own.exists() else shutil.which(program)


def install_checkers(npm: str | Path) -> None:
    """Install the checkers of JavaScript from their own lock, beside the environment's packages."""
    if is_stamped("javascript"):
        return
    remove(NODE_MODULES.parent)
    NODE_MODULES.parent.mkdir()
    for name in ["package.json", "package-lock.json"]:
        shutil.copy(CHECKERS / name, NODE_MODULES.parent)
    quietly = ["--ignore-scripts", "--no-audit", "--no-fund", "--loglevel", "error"]
    command = [npm, "ci", "--prefix", NODE_MODULES.parent, *quietly]
    must("Installing the checkers of JavaScript (once)", command, quiet=True)
    stamp("javascript").write_text(wanted("javascript"))


def pip(venv: Path, command: str = "install") -> Command:
    quietly = ["--quiet", "--disable-pip-version-check"]
    return [in_venv("python", venv), "-m", "pip", command, *quietly]


# --- the book -------------------------------------------------------------------------------------


def make_book(update: bool = False, printed: Path | None = None) -> None:
    """Execute the chapters that changed, then build the pages and replace the old ones.

    The pages are built anew; with `update` only those whose own text changed, which is enough for
    an author who writes. A PDF of an older book is removed, unless it is passed on as `printed`.
    The stamp is removed first and written last, so that an incomplete book is made again.
    """
    made_from = fingerprint(ROOT)
    BOOK_STAMP.unlink(missing_ok=True)
    take(make_chapters())
    if printed is None:
        PDF.unlink(missing_ok=True)
    else:
        shutil.copy(printed, PDF)
    build_pages(update)
    if fingerprint(ROOT) != made_from:
        remove(EXECUTED)  # the sources of the chapters are unknown
        raise Failed("The sources changed while the book was made: make it again.")
    BOOK_STAMP.write_text(stamped(made_from))


def build_pages(update: bool) -> None:
    """Build the pages beside the old ones, which stay until the new ones are whole."""
    target = BUILD / "next"
    remove(target)
    parts = [FRONT_PAGE.parent, BUILD / "doctrees-html"]
    if update and all(part.exists() for part in [*parts, GENERATED]):
        for part in parts:
            shutil.copytree(part, target / part.name)
    else:
        remove(GENERATED)
    command = sphinx("html", ROOT / "book", target)
    must("Building the pages", command, quiet=True, base=one_arithmetic(), QBOUND_RESULTS=RESULTS)
    for part in parts:
        remove(part)
        (target / part.name).rename(part)
    remove(target)


def sphinx(builder: str, source: Path, target: Path) -> Command:
    strict = ["-W", "-n", "--keep-going", "-q", "-j", "auto", "-b", builder]
    doctrees = ["-d", target / f"doctrees-{builder}"]
    return [in_venv("python"), "-m", "sphinx", *strict, *doctrees, source, target / builder]


# --- the chapters ---------------------------------------------------------------------------------


def make_chapters() -> list[Path]:
    """Execute the chapters that changed; return all executed ones."""
    notebooks = sorted((ROOT / "notebooks").glob("*.ipynb"))
    if not notebooks:
        raise Failed("There is no notebook in notebooks/: this copy is incomplete.")
    apart = [text for text in sorted((ROOT / "notebooks").glob("[0-9]*_*.md")) if is_apart(text)]
    if apart:
        names = " ".join(text.relative_to(ROOT).as_posix() for text in apart)
        advice = f"{in_venv('jupytext').relative_to(ROOT)} --sync {names} takes the newer of each."
        raise Failed(f"The text and the notebook of a chapter differ: {names}.\n{advice}")
    shared = made_with()
    changed = [notebook for notebook in notebooks if not is_current(notebook, shared)]
    if len(changed) < len(notebooks):
        said = f"{len(notebooks) - len(changed)} of {len(notebooks)} notebooks"
        say(f"-- {said}, and what they are computed with, are unchanged")
    if changed:
        execute(changed, shared)
    return [executed(notebook) for notebook in notebooks]


def is_apart(text: Path) -> bool:
    """Tell whether a chapter's text has other lines than its notebook, or no notebook at all."""

    def lines(source: str) -> list[str]:
        return [line.rstrip() for line in source.splitlines() if line.strip() and line != "+++"]

    notebook = text.with_suffix(".ipynb")
    if not notebook.exists():
        return True
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    body = text.read_text(encoding="utf-8").partition("\n---\n")[2]
    return lines(CELL.sub(r"\1", body)) != lines("\n".join("".join(c["source"]) for c in cells))


def execute(notebooks: list[Path], shared: str) -> None:
    """Execute copies of the notebooks; the committed ones stay without outputs.

    A chapter that ran to its end is marked at once with its sources. If another chapter fails, or
    the run is killed, the marked chapter is not executed again.
    """
    for cache in list((ROOT / "src").rglob("__pycache__")):
        remove(cache)  # bytecode counts as current by time and size of its source alone
    for notebook in notebooks:
        remove(executed(notebook).parent)
        executed(notebook).parent.mkdir(parents=True)
        shutil.copy(notebook, executed(notebook))
        mark(notebook).with_suffix(".part").write_text(wanted_of(notebook, shared))
    chapters = sorted(map(executed, notebooks), key=when_executed)
    must(
        f"Executing {len(chapters)} notebooks",
        executing(chapters),
        base=one_arithmetic(),
        PYTHONPATH=TOOLS / "chapters",
    )
    for chapter in chapters:
        if unrun_cells(chapter):
            remove(chapter.parent)
            raise Failed(f"{chapter.name}: cells did not run.")
        if not is_x86():
            must(f"Comparing the results of {chapter.name} with the recorded ones", keep(chapter))


def executing(chapters: list[Path]) -> Command:
    """Return the command that executes copies of notebooks where they are."""
    nbmake = ["--nbmake", "--overwrite", "--nbmake-timeout=900", "-p", "no:cacheprovider"]
    pytest = [in_venv("python"), "-m", "pytest", "-n", "2", "-v", "--no-header"]
    pytest += ["--maxschedchunk=1"]  # no chapter waits while a process is free
    return [*pytest, "-c", ROOT / "pyproject.toml", "-p", "per_chapter", *nbmake, *chapters]


def keep(chapter: Path) -> Command:
    """Return the command that keeps the recorded results with which those of a chapter agree."""
    return [in_venv("python"), TOOLS / "keep_results.py", chapter.parent, RESULTS]


def when_executed(chapter: Path) -> tuple[int, str]:
    """Return the key that sorts the chapters: those that take long come first."""
    name = chapter.stem.partition("_")[2]
    return LONG.index(name) if name in LONG else len(LONG), chapter.stem


def executed(notebook: Path) -> Path:
    """Return the executed copy of a chapter; its folder holds the chapter's results too."""
    return EXECUTED / notebook.stem / notebook.name


def mark(notebook: Path) -> Path:
    """Return the file that records the sources of an executed chapter."""
    return executed(notebook).with_name("made-from")


def made_with() -> str:
    """Return one hash of everything that all chapters are computed with."""
    hashes = {name.as_posix(): total for name, total in source_hashes(ROOT).items()}
    used = [f"{name} {total}" for name, total in hashes.items() if name.startswith(SHARED)]
    return digest(*settings().values(), *used)


def wanted_of(notebook: Path, shared: str) -> str:
    return digest(shared, hash_of(notebook))


def is_current(notebook: Path, shared: str) -> bool:
    """Tell whether a chapter was executed with its present text and sources."""
    made = mark(notebook)
    return made.is_file() and made.read_text() == wanted_of(notebook, shared)


def take(chapters: list[Path]) -> None:
    """Take executed chapters and their results into the book."""
    results = dict[str, Path]()
    for chapter in chapters:
        for file in sorted(chapter.parent.glob("*.json")):
            if results.setdefault(file.name, file) != file:
                raise Failed(f"{chapter.name} writes {file.name}, as another chapter does.")
    remove(CHAPTERS)
    CHAPTERS.mkdir()
    for chapter in chapters:
        shutil.copy2(chapter, CHAPTERS)
    RESULTS.mkdir(exist_ok=True)
    for old in RESULTS.glob("*.json"):
        if old.name not in results:
            old.unlink()
    for name, file in results.items():
        shutil.copy(file, RESULTS / name)


def hash_of(file: Path) -> str | None:
    """Return the hash of a file, or None where there is no file."""
    return hashlib.sha256(file.read_bytes()).hexdigest() if file.is_file() else None


def settings() -> dict[str, str]:
    """Return everything else that chapters depend on, besides the sources."""
    question = "import sys, platform; print(sys.version, sys.platform, platform.machine())"
    python = subprocess.check_output([in_venv("python"), "-c", question], cwd=ROOT, text=True)
    places = [VENV / "Lib" / "site-packages", *VENV.glob("lib/python*/site-packages")]
    found = {path.name for place in places for path in place.glob("*.dist-info")}
    counts = {k: v for k, v in environment().items() if k.upper().startswith(COUNTS)}
    return {
        "python": python.strip(),
        "lock": digest(LOCK.read_text(encoding="utf-8")),
        "packages": digest(*sorted(found)),
        "arithmetic": KERNEL if is_x86() else platform.machine(),
        "environment": digest(*(f"{name}={counts[name]}" for name in sorted(counts))),
    }


def unrun_cells(notebook: Path) -> bool:
    """Tell whether a code cell has not run."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    code = (c for c in cells if c["cell_type"] == "code" and "".join(c["source"]).strip())
    return any(cell.get("execution_count") is None for cell in code)


def fingerprint(root: Path) -> str:
    """Return one hash of everything that the book is made from."""
    hashes = source_hashes(root)
    return digest(*map(Path.as_posix, hashes), *hashes.values())


def source_hashes(root: Path) -> dict[Path, str]:
    """Return the hash of each source, by its path in the repository."""
    found = [path for name in SOURCES for path in [root / name, *(root / name).rglob("*")]]
    names = sorted(path.relative_to(root) for path in found if path.is_file())
    sources = [name for name in names if not is_product(name)]
    return {name: hashlib.sha256((root / name).read_bytes()).hexdigest() for name in sources}


def is_product(name: Path) -> bool:
    return any(part in PRODUCTS or part.endswith(".egg-info") for part in name.parts)


def book_is_fresh() -> bool:
    made = FRONT_PAGE.exists() and BOOK_STAMP.exists()
    return made and BOOK_STAMP.read_text() == stamped(fingerprint(ROOT))


def stamped(made_from: str) -> str:
    """Return the stamp of a book: hashes of its sources and of its results."""
    files = sorted(RESULTS.glob("*.json"))
    return digest(made_from, *(f"{file.name} {hash_of(file)}" for file in files))


# --- a first trial --------------------------------------------------------------------------------


def quick() -> int:
    """Try the installation in under three minutes: environment, Table 6, two chapters."""
    prepare()
    start = time.monotonic()
    for title, step in trials().items():
        say(f"-- {title}")
        began = time.monotonic()
        found = step()
        say(f"   SUCCESS in {time.monotonic() - began:.0f} s: {found}")
    say(f"All {len(trials())} steps succeeded in {time.monotonic() - start:.0f} s.")
    say("Next: `python3 run.py book` makes the whole book.")
    return 0


def trials() -> dict[str, Callable[[], str]]:
    """Return the steps of `quick` by their titles; each returns what it found, or fails."""
    return {
        "Is the environment whole?": try_environment,
        f"Are the claims about {TABLE} computed again as recorded?": try_claims,
        f"Do {len(TRIED)} chapters run, and give the recorded numbers?": try_chapters,
    }


def try_environment() -> str:
    """Check that the packages fit together, and that NumPy computes in the book's arithmetic."""
    answer([in_venv("python"), "-m", "pip", "check"])
    one_arithmetic()
    return answer([in_venv("qbound"), "--version"]) + ", every package fits the others"


def try_claims() -> str:
    """Compute the claims about a table of the paper again."""
    content = json.loads((RESULTS / "claims.json").read_text(encoding="utf-8"))
    names = [claim["id"] for claim in content["claims"] if claim["where"].startswith(TABLE)]
    command = [in_venv("qbound"), "claims", *names, "--recompute"]
    return answer(command, base=one_arithmetic()).splitlines()[-1]


def try_chapters() -> str:
    """Execute copies of some chapters, and compare their numbers with the recorded ones."""
    with tempfile.TemporaryDirectory() as scratch:
        chapters = [Path(scratch, name, f"{name}.ipynb") for name in TRIED]
        for chapter in chapters:
            chapter.parent.mkdir()
            shutil.copy(ROOT / "notebooks" / chapter.name, chapter)
            chapter.with_name("made-from.part").touch()
        answer(executing(chapters), base=one_arithmetic(), PYTHONPATH=TOOLS / "chapters")
        numbers = 0
        for chapter in chapters:
            if unrun_cells(chapter):
                raise Failed(f"{chapter.name}: cells did not run.")
            said = answer(keep(chapter))
            for file in sorted(chapter.parent.glob("*.json")):
                if file.read_bytes() != (RESULTS / file.name).read_bytes():
                    raise Failed(f"{file.name} differs from the recorded results.\n{said}")
                numbers += len(json.loads(file.read_text(encoding="utf-8"))["results"])
    return f"{' and '.join(TRIED)} ran, {numbers} numbers as recorded in {RESULTS.name}/"


def answer(command: Command, base: dict[str, str] | None = None, **settings: object) -> str:
    """Return the output of a step; if it fails, show all of its output to the reader."""
    whole = (base or environment()) | {name: str(value) for name, value in settings.items()}
    done = subprocess.run(command, cwd=ROOT, env=whole, capture_output=True, text=True, check=False)
    if done.returncode:
        raise Failed(f"FAILED: {done.stdout}{done.stderr}", done.returncode)
    return done.stdout.strip()


# --- the author's loop and the PDF ----------------------------------------------------------------


def remake(changed: set[Path]) -> None:
    """Make again what depends on the changed sources; only few pages if only text changed."""
    texts = {name for name in changed if name.suffix in {".md", ".ipynb"}}
    here = sorted(name for name in texts if (ROOT / name).exists())
    for name in here:
        if name.parts[0] == "notebooks" and name.suffix == ".md" and name.stem != "README":
            pair = [in_venv("jupytext"), "--quiet", "--to", "ipynb", ROOT / name]
            must(f"Pairing {name.name}", pair)
    make_book(update=set(here) == changed)


def browsers() -> list[str]:
    """Return the browsers of the family that prints PDFs."""
    names = ["chromium", "chromium-browser", "google-chrome", "chrome", "msedge"]
    return [path for path in map(shutil.which, names) if path]


def find_browser() -> str:
    if not browsers():
        raise Failed("The PDF is printed by Chromium, and there is none: install it first.")
    return browsers()[0]


# --- the commands ---------------------------------------------------------------------------------


def book(*options: str) -> int:
    """Execute the notebooks and build the book; with --live its chapters run inside their pages."""
    prepare()
    make_book()
    if options:
        add_python(LIVE)
    say(f"The book: {FRONT_PAGE.as_uri()}")
    return 0


def live(*folders: str) -> int:
    """Put Python beside the book, for pages that run (arguments: folders that have its files)."""
    for folder in folders:
        if not Path(folder).is_dir():
            raise Failed(f"live: {folder} is not a folder.", 2)
    prepare()
    if not book_is_fresh():
        make_book()
    add_python(LIVE, *folders)
    say(f"The book: {FRONT_PAGE.as_uri()}")
    return 0


def add_python(files: Path, *folders: str) -> None:
    """Fetch Pyodide and its packages, by hash, and pack them beside the built pages."""
    fetching = "Fetching what runs in a page (once; it takes 55 MB, and its carrier 106)"
    must(fetching, [in_venv("python"), TOOLS / "live" / "fetch.py", files, *folders])
    packing = [in_venv("python"), TOOLS / "live" / "pack.py", files, FRONT_PAGE.parent]
    must("Packing it beside the book", packing)


def test(*arguments: str) -> int:
    """Run the tests; further arguments go to pytest (run.py test -k name)."""
    prepare()
    if not book_is_fresh():
        say("The tests read the book, and it is not up to date.")
        make_book()
    say(f"The book: {FRONT_PAGE.as_uri()}")
    # Nothing is printed after pytest, so that its summary is the last line. Of three processes on
    # two cores one mostly waits for a browser; each takes files from the others when it is done.
    command = [in_venv("python"), "-m", "pytest", "-n", "3", "--dist", "worksteal", *arguments]
    return subprocess.call(command, cwd=ROOT, env=environment())


def serve() -> int:
    """Show the book at a local address and make it again when a source changes; Ctrl-C ends it."""
    prepare()
    if not book_is_fresh():
        make_book()
    server = [in_venv("python"), "-m", "http.server", "--bind", "127.0.0.1", str(PORT)]
    with subprocess.Popen(
        [*server, "--directory", FRONT_PAGE.parent], env=environment()
    ) as process:
        try:
            say(f"The book: http://127.0.0.1:{PORT}/ (Ctrl-C ends it)")
            watch()
        finally:
            process.terminate()
    return 0


def watch() -> None:
    known = source_hashes(ROOT)
    while True:
        time.sleep(1)
        now = source_hashes(ROOT)
        changed = {name for name in known.keys() | now.keys() if known.get(name) != now.get(name)}
        if changed:
            try:
                remake(changed)
            except Failed as failure:
                say(str(failure))
            known = source_hashes(ROOT)  # pairing writes notebooks


def pdf() -> int:
    """Print the whole book to one PDF, which its front page then offers."""
    browser = find_browser()
    prepare()
    if not book_is_fresh():
        make_book()
    print_book(browser)
    say(f"The PDF: {PDF.as_uri()}")
    return 0


def print_book(browser: str) -> None:
    """Print to a side file; a complete PDF goes into the book, with pages that offer it."""
    scratch = BUILD / "pdf"
    remove(scratch)
    command = sphinx("singlehtml", ROOT / "book", scratch)
    must("Building the book as one page", command, quiet=True, base=one_arithmetic())
    draft, page = scratch / PDF.name, scratch / "singlehtml" / "index.html"
    options = ["--headless", "--disable-gpu", "--no-pdf-header-footer"]
    options += ["--no-sandbox"] if getattr(os, "geteuid", lambda: 1)() == 0 else []  # as in CI
    patience = ["--virtual-time-budget=600000", "--generate-pdf-document-outline"]
    printing = [browser, *options, *patience, f"--print-to-pdf={draft}", page.as_uri()]
    must("Printing", printing, quiet=True)
    if not draft.exists():  # a browser may fail and say that all is well
        raise Failed("The browser has printed nothing.")
    make_book(update=True, printed=draft)
    remove(scratch)


def lab() -> int:
    """Open the notebooks in JupyterLab: copies of your own in workbook/, which git ignores."""
    prepare()
    must("Copying the notebooks", [in_venv("python"), TOOLS / "workbook.py", WORKBOOK])
    say(f"Your copies: {WORKBOOK} (delete one, and the next start brings it anew)")
    command = [in_venv("python"), "-m", "jupyter", "lab", "--notebook-dir", WORKBOOK]
    return subprocess.call(command, cwd=ROOT, env=environment())


def lint() -> int:
    """Check style, types and the direction of imports, of JavaScript too where there is Node."""
    prepare()
    checks: dict[str, Command] = {
        "Style (ruff check)": [in_venv("ruff"), "check", "--quiet"],
        "Layout (ruff format)": [in_venv("ruff"), "format", "--check"],
        "Types (mypy)": [in_venv("mypy")],
        "Imports (import-linter)": [in_venv("lint-imports")],
        "Chapters (run.py renumber)": [in_venv("python"), TOOLS / "renumber.py", "--check"],
        **javascript_checks(),
    }
    failed = [title for title, command in checks.items() if call(title, command) != 0]
    if failed:
        raise Failed("Lint failed: " + ", ".join(failed))
    return 0


def javascript_checks() -> dict[str, Command]:
    """Return the checks of JavaScript; none where there is no Node, unless it is required."""
    node, npm = find_node("node"), find_node("npm")
    if node is None or npm is None:
        if os.environ.get("CI") == "true" or os.environ.get("QBOUND_REQUIRE_NODE") == "1":
            raise Failed(NO_NODE)
        say(f"-- {NO_NODE}")
        return {}
    install_checkers(npm)
    biome = [node, NODE_MODULES / "@biomejs/biome/bin/biome", "check", "--error-on-warnings"]
    tsc = [node, NODE_MODULES / "typescript/bin/tsc", "--project"]
    return {
        "Style of JavaScript (Biome)": [*biome, f"--config-path={CHECKERS}", *SCRIPTS],
        **{
            f"Types of JavaScript (tsc, {name})": [*tsc, CHECKERS / f"{name}.json"]
            for name in PROGRAMS
        },
    }


def lock() -> int:
    """Pin every dependency again, by hash: the newest, and the oldest that is allowed."""
    options = ["--universal", "--python-version", "3.11", "--upgrade", "--quiet"]
    options += ["--fork-strategy", "fewest", "--generate-hashes"]
    options += ["--no-emit-index-url", "--no-emit-find-links", "--no-header", "--no-annotate"]
    lowest = ["--resolution", "lowest-direct", *(f"--extra={extra}" for extra in LIBRARY)]
    with tempfile.TemporaryDirectory() as scratch:
        uv = find_uv(Path(scratch, "uv"))
        command = [uv, "pip", "compile", "pyproject.toml", *options, "--output-file"]
        must("Pinning the dependencies", [*command, LOCK.name, "--all-extras"], quiet=True)
        must("Pinning the oldest", [*command, LOWEST.name, *lowest], quiet=True)
        compared = [uv, "pip", "compile", COMPARISON / "requirements.in", *options, "--output-file"]
        must("Pinning the comparison", [*compared, COMPARISON / LOCK.name], quiet=True)
    say(f"{LOCK.name} and {LOWEST.name} are written. Run book and test before you commit them.")
    return 0


def find_uv(scratch: Path) -> str | Path:
    """Return the uv of this machine, or one installed for the moment."""
    found = shutil.which("uv")
    if found is None:
        make_venv(scratch)
        must("Installing uv for the moment", [*pip(scratch), "uv"], quiet=True)
    return found or in_venv("uv", scratch)


def renumber() -> int:
    """Write the parts that chapters share: numbers, references, first cells, their list."""
    prepare()
    return subprocess.call([in_venv("python"), TOOLS / "renumber.py"], cwd=ROOT)


def licences() -> int:
    """List the licence of everything that is installed in .venv; an unknown one is a failure."""
    prepare()
    return subprocess.call([in_venv("python"), TOOLS / "licences.py"], env=environment())


def pack() -> int:
    """Make the files of a release in dist/, and their checksums. No index is asked."""
    prepare()
    if not book_is_fresh():
        make_book()
    if browsers() and not PDF.exists():
        print_book(find_browser())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    name = f"qbound-{{}}-{project['version']}"
    remove(DIST)
    wheel = [*pip(VENV, "wheel"), *OFFLINE, "--wheel-dir", DIST, ROOT]
    must("Building the wheel", wheel, quiet=True)
    pack_folder(name.format("book"), [BUILD / "html"])
    pack_folder(name.format("results"), [ROOT / "results", *map(ROOT.joinpath, CITED)])
    write_checksums()
    say(f"The files of the release: {DIST}")
    return 0


def pack_folder(name: str, sources: list[Path]) -> None:
    """Zip files and folders below one folder of that name."""
    with tempfile.TemporaryDirectory() as scratch:
        target = Path(scratch, name)
        target.mkdir()
        for source in sources:
            copy = shutil.copytree if source.is_dir() else shutil.copy
            copy(source, target / source.name)
        shutil.make_archive(str(DIST / name), "zip", scratch, name)


def write_checksums() -> None:
    """Write SHA256SUMS in the form that `sha256sum --check` reads."""
    sums = {file.name: hashlib.sha256(file.read_bytes()).hexdigest() for file in DIST.iterdir()}
    lines = [f"{total}  {name}\n" for name, total in sorted(sums.items())]
    (DIST / "SHA256SUMS").write_text("".join(lines), encoding="utf-8", newline="\n")


def bench(*words: str) -> int:
    """Measure side by side with other tools; --quick is a trial run."""
    venv = prepare_bench()
    runner = [in_venv("python", venv), ROOT / COMPARISON / "run.py", *words]
    must("Asking everybody in turns (a quarter of an hour)", runner)
    return 0


def prepare_bench() -> Path:
    """Make an environment of its own for the comparison, as its lock says, and return it."""
    venv, lock = ROOT / BENCH, ROOT / COMPARISON / LOCK.name
    ours = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    made_from = digest(lock.read_text(encoding="utf-8"), ours, sys.version_info[:2], venv)
    made = venv / "bench.stamp"
    if not (made.exists() and made.read_text() == made_from):
        remove(venv)
        make_venv(venv)
        try:
            install_pinned(venv, lock)
            missing = {}
        except Failed:
            missing = install_what_can_be(venv, lock)
        (venv / ABSENT).write_text(json.dumps(missing), encoding="utf-8")
        install_ourselves(venv)
        made.write_text(made_from)
    for name, why in json.loads((venv / ABSENT).read_text(encoding="utf-8")).items():
        say(f"Missing: {name} ({why})")
    return venv


def clean() -> int:
    """Remove the environments, the book and the caches; results/ stays."""
    made = [ROOT / name for name in [BENCH, *CACHES, *BUILT]]
    for path in [VENV, EXECUTED, LIVE, CHAPTERS, BUILD, GENERATED, *made]:
        remove(path)
    say("Removed the environments, the book and the caches.")
    return 0


COMMANDS = [quick, book, live, test, serve, lab, pdf, lint, lock, renumber, licences]
COMMANDS += [bench, pack, clean]


def read_command_line(words: list[str]) -> tuple[argparse.Namespace, list[str]]:
    parser = argparse.ArgumentParser(prog="run.py", description=(__doc__ or "").split("\n")[0])
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for function in COMMANDS:
        text = function.__doc__
        commands.add_parser(
            function.__name__, help=text, description=text, allow_abbrev=False
        ).set_defaults(function=function)
    chosen, rest = parser.parse_known_args(words)
    options = {bench: "--quick", book: "--live"}
    option = options.get(chosen.function)
    known = chosen.function in (test, live) or rest == [option]
    if rest and not known:
        taken = f"{option} and nothing else" if option else "no arguments"
        parser.error(f"{chosen.command} takes {taken}, found: {' '.join(rest)}")
    return chosen, rest


def main(words: list[str]) -> int:
    chosen, rest = read_command_line(words)
    try:
        return chosen.function(*rest)
    except Failed as failure:
        say(str(failure))
        return failure.status
    except KeyboardInterrupt:
        say("Stopped.")
        return 130


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
