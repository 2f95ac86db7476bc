#!/usr/bin/env python3
"""One command for everything: it makes .venv as requirements.lock says, then what is asked for.

    python3 run.py book     execute the chapters that changed, and build the book
    python3 run.py test     run the tests; makes the book first if it is stale (-k name: a part)
    python3 run.py chapter:NN_name  execute one chapter, if it changed
    python3 run.py live     put Python beside the book: its chapters then run inside their pages
    python3 run.py lab      open the notebooks in JupyterLab, as copies of your own
    python3 run.py pdf      print the book to one PDF (needs Chromium)
    python3 run.py lint     check style, types, imports, licences, workflows, JavaScript
    python3 run.py lock     pin every dependency again, by hash
    python3 run.py renumber write numbers of references and first cells into the chapters
    python3 run.py draws    record again what the printed digits leave open (two minutes)
    python3 run.py bench    measure side by side with other tools (--quick: a trial of minutes)
    python3 run.py pack     make the files of a release in dist/, with their checksums
    python3 run.py clean    remove what the other commands made

This file needs Python alone, because a reader who checks the paper may have nothing else. dodo.py
says what is made from what, and runs in .venv.
"""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

# This check is before the first definition, in syntax that Python 3.6 can read.
if sys.version_info < (3, 11):  # noqa: UP036
    sys.exit("qbound needs Python 3.11 or newer; this is Python " + sys.version.split()[0] + ".")

ROOT = Path(__file__).resolve().parent
VENV, LOCK = ROOT / ".venv", ROOT / "requirements.lock"
MADE = [".venv", ".venv-bench", ".executed", ".live", "book/_build", "book/chapters"]
MADE += [
    "book/generated",
    "build",
    "dist",
    "src/qbound.egg-info",
    "engine/build",
    "engine/cspace.egg-info",
    ".hypothesis",
]
MADE += ["tests/javascript/node_modules", ".import_linter_cache", ".mypy_cache"]
MADE += [".pytest_cache", ".ruff_cache"]
# The package is built with the lock's setuptools: no index is asked, nothing is downloaded.
OFFLINE = ["--no-index", "--no-deps", "--no-build-isolation"]

Command = list[str | Path]


class Failed(Exception):
    """Error: a step failed; has the sentence for the reader."""


def say(text: str) -> None:
    print(text, flush=True, file=sys.__stdout__)  # doit collects what a task prints elsewhere


def environment() -> dict[str, str]:
    """Return the shell's environment, without variables that mix in the user's code and settings.

    It must not forbid bytecode either, because each of some thousand processes would compile all
    imports. With one thread a sum has one order of its terms.
    """
    mixes_in = {"PYTHONPATH", "QBOUND_RESULTS", "PYTHONDONTWRITEBYTECODE"}
    kept = {name: value for name, value in os.environ.items() if name not in mixes_in}
    return kept | {
        "IPYTHONDIR": str(VENV / "ipython"),
        "JUPYTER_PREFER_ENV_PATH": "1",
        "MPLCONFIGDIR": str(VENV / "matplotlib"),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "PYTHONHASHSEED": os.environ.get("QBOUND_HASH_SEED", "0"),  # .ci/run takes another
        "PYTHONNOUSERSITE": "1",
    }


def call(title: str, command: Command, base: dict[str, str] | None = None) -> int:
    """Run a step in the repository, say how long it takes, and return its status."""
    say(f"-- {title}")
    start = time.monotonic()
    with subprocess.Popen(command, cwd=ROOT, env=base or environment()) as process:
        while process.poll() is None:
            try:
                process.wait(timeout=15)
            except subprocess.TimeoutExpired:
                say(f"   ... {time.monotonic() - start:.0f} s: {title}")
    if process.returncode >= 0:  # who ends it by a signal, as Ctrl-C does, knows
        outcome = "FAILED" if process.returncode else "done"
        say(f"   {outcome} in {time.monotonic() - start:.1f} s: {title}")
    return process.returncode


def must(title: str, command: Command, base: dict[str, str] | None = None) -> None:
    """Run a step that the next ones need."""
    status = call(title, command, base)
    if status != 0:
        raise Failed(f"Stopped at: {title} (status {status}).")


def in_venv(program: str, venv: Path = VENV) -> Path:
    """Return the path of a program of an environment, on Windows too."""
    return venv / "Scripts" / f"{program}.exe" if os.name == "nt" else venv / "bin" / program


def pip(python: Path, command: str = "install") -> Command:
    return [python, "-m", "pip", command, "--quiet", "--disable-pip-version-check"]


def prepare(venv: Path = VENV, lock: Path = LOCK) -> None:
    """Make an environment as a lock says, with qbound itself.

    The stamp is written last: an installation that was killed starts over. A moved environment is
    stale, as its programs call its old path. The lock is installed by hash, with uv, which is
    faster, or with pip if there is no uv or it fails. Modules are compiled when they are imported,
    because most modules of the tools never are.
    """
    projects = [ROOT / "pyproject.toml", ROOT / "engine" / "pyproject.toml"]
    texts = [file.read_text(encoding="utf-8") for file in (lock, *projects)]
    made_from = "\n".join([*texts, str(sys.version_info[:2]), str(venv)])
    stamp, wanted = venv / "stamp", hashlib.sha256(made_from.encode()).hexdigest()
    if stamp.exists() and stamp.read_text() == wanted:
        return
    shutil.rmtree(venv, ignore_errors=True)
    # Not sys.executable: that may lie in the .venv that is just being replaced.
    base = getattr(sys, "_base_executable", sys.executable)
    if call(f"Making {venv.name}", [base, "-m", "venv", venv]) != 0:
        raise Failed("No virtual environment. On Debian or Ubuntu: apt install python3-venv")
    title = f"Installing the packages of {lock.relative_to(ROOT)} (once; a minute or so)"
    options = ["--require-hashes", "--requirement", lock]
    python, uv = in_venv("python", venv), shutil.which("uv")
    by_uv = [uv, "pip", "install", "--quiet", "--python", python, *options]
    if uv is None or call(title, by_uv) != 0:
        must(title, [*pip(python), "--no-compile", *options])
    must(
        "Installing qbound and cspace themselves",
        [*pip(python), *OFFLINE, "--editable", ROOT, "--editable", ROOT / "engine"],
    )
    stamp.write_text(wanted)


def become(command: Command) -> int:
    """Go on as another program, so that signals are for it alone; Windows can only call it."""
    if os.name != "nt":
        os.chdir(ROOT)
        os.execve(command[0], list(map(str, command)), environment())
    return subprocess.call(command, cwd=ROOT, env=environment())


def clean() -> None:
    for path in map(ROOT.joinpath, MADE):
        shutil.rmtree(path, ignore_errors=True)
    say("Removed the environments, the book and the caches; results/ stays.")


def main(words: list[str]) -> int:
    if not words or words[0].partition(":")[0] not in re.findall(r"run\.py (\w+)", __doc__):
        say(__doc__)
        return 0 if words[:1] in (["-h"], ["--help"]) else 2
    try:
        if words[0] == "clean":
            clean()
            return 0
        prepare()
    except Failed as failure:
        say(str(failure))
        return 1
    except KeyboardInterrupt:
        say("Stopped.")
        return 130
    return become([in_venv("python"), ROOT / "dodo.py", *words])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
