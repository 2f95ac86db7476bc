"""Apply each wrong change of `mutants.toml` in a worktree of HEAD, and see that its test fails.

A mutant breaks a promise of the library. Who rewrites the code writes a mutant of the same promise.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue

HERE = Path(__file__).resolve().parent
PASSED, FAILED = 0, 1
"""Exit statuses of pytest; the others say that it could not run the tests."""

Mutant = dict[str, str]


def mutants(words: Sequence[str] = ()) -> list[Mutant]:
    """Return the mutants, or those whose promise or function contains one of the words."""
    found = tomllib.loads((HERE / "mutants.toml").read_text(encoding="utf-8"))["mutant"]
    texts = [f"{mutant['promise']} {mutant['function']}".lower() for mutant in found]
    chosen = zip(found, texts, strict=True)
    return [m for m, text in chosen if not words or any(word.lower() in text for word in words)]


@contextmanager
def worktrees(count: int) -> Iterator[list[Path]]:
    """Make worktrees of HEAD in a temporary folder, and remove them at the end."""
    git = ["git", "-C", str(HERE), "worktree"]
    with tempfile.TemporaryDirectory() as temporary:
        folders = [Path(temporary).resolve() / str(k) for k in range(count)]
        try:
            for folder in folders:
                subprocess.run([*git, "add", "--quiet", "--detach", folder, "HEAD"], check=True)
            yield folders
        finally:
            for folder in folders:
                subprocess.run([*git, "remove", "--force", folder], check=False)


def run(folder: Path, *words: str) -> tuple[int, str]:
    """Run Python on the sources of a worktree; return the exit status and the end of the output."""
    paths = os.pathsep.join(
        str(folder / name) for name in ("src", "engine", "tests", "engine/tests")
    )
    # Bytecode is known by its source's size and second, which a mutant may share with the original.
    settings = {"PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1"}
    settings["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"  # loading them takes longer than most tests
    command = [sys.executable, *words]
    done = subprocess.run(
        command,
        cwd=folder,
        env=os.environ | settings,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, (done.stdout + done.stderr)[-2000:]


def run_tests(folder: Path, tests: Sequence[str]) -> tuple[int, str]:
    """Run tests of a worktree until one fails."""
    plugins = ["-p", "_hypothesis_pytestplugin", "-p", "no:cacheprovider"]
    options = ["-q", "-x", "--hypothesis-profile=unshrunk"]
    return run(folder, "-m", "pytest", *plugins, *options, *tests)


def refuse_installed(folder: Path) -> None:
    """Refuse to go on where another package than that of the worktree would be imported."""
    _, said = run(folder, "-c", "import cspace, lizarraga2025 as p; print(cspace, p)")
    if said.count(str(folder)) != 2:
        raise SystemExit(f"the packages of {folder} are not those that Python imports: {said}")


def say(*words: str) -> None:
    """Print a line at once."""
    sys.stdout.write(" ".join(words) + "\n")
    sys.stdout.flush()


def fault(folder: Path, mutant: Mutant) -> str | None:
    """Apply a mutant and run its test; return why it is not killed, or None."""
    path = folder / mutant["file"]
    text = path.read_bytes().decode()
    if (count := text.count(mutant["old"])) != 1:
        return f"the old text stands {count} times in {mutant['file']}, not once"
    path.write_bytes(text.replace(mutant["old"], mutant["new"]).encode())
    try:
        status, said = run_tests(folder, [mutant["test"]])
    finally:
        path.write_bytes(text.encode())
    if status == PASSED:
        return f"{mutant['test']} passes"
    return None if status == FAILED else f"{mutant['test']} did not run (status {status}):\n{said}"


def faults(chosen: Sequence[Mutant], folders: Sequence[Path]) -> int:
    """Run mutants, one at a time in each worktree; print each, and count those not killed."""
    free, count = SimpleQueue[Path](), 0
    for folder in folders:
        free.put(folder)

    def work(mutant: Mutant) -> str | None:
        folder = free.get()
        try:
            return fault(folder, mutant)
        finally:
            free.put(folder)

    with ThreadPoolExecutor(len(folders)) as pool:
        try:
            found = {pool.submit(work, mutant): mutant for mutant in chosen}
            for done in as_completed(found):
                mutant, why = found[done], done.result()
                say("killed" if why is None else "NOT KILLED", mutant["function"])
                if why is not None:
                    say(f"  {mutant['promise']}\n  {why}")
                    count += 1
        finally:  # after Ctrl-C no other mutant begins
            pool.shutdown(cancel_futures=True)
    return count


def main(arguments: Sequence[str]) -> int:
    """Run all mutants, or some, and return the exit status."""
    parser = argparse.ArgumentParser(description="see that every mutant is killed by its test")
    parser.add_argument("words", nargs="*", metavar="WORD", help="in a promise or a function")
    parser.add_argument("--jobs", type=int, default=1, help="how many mutants at a time")
    asked = parser.parse_args(arguments)
    chosen = mutants(asked.words)
    with worktrees(max(1, min(asked.jobs, len(chosen)))) as folders:
        for folder in folders:
            refuse_installed(folder)
        status, said = run_tests(folders[0], sorted({mutant["test"] for mutant in chosen}))
        if status != PASSED:
            concerned = [m["promise"] for m in chosen if m["test"] in said]
            say(f"without a mutant the tests do not pass (status {status}):\n{said}", *concerned)
            return 1
        count = faults(chosen, folders)
    say(f"{len(chosen)} mutants: {len(chosen) - count} killed")
    return 1 if count else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(130)
