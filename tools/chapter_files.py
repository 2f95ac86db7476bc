"""The files of the chapters, and what the tools of `python3 run.py renumber` do with them alike.

A tool says what each file should hold. `finish` writes it, or with ``--check`` names the files that
hold something else.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOTEBOOKS = ROOT / "notebooks"


def chapters() -> list[Path]:
    """Return the files of all chapters: texts and notebooks."""
    found = NOTEBOOKS.iterdir()
    return sorted(p for p in found if p.suffix in {".md", ".ipynb"} and p.stem != "README")


def rewritten(in_text: Callable[[str], str], in_notebook: Callable[[str], str]) -> dict[Path, str]:
    """Return the new text of every chapter's file that has to change."""
    changes = {}
    for path in chapters():
        old = path.read_text(encoding="utf-8")
        new = in_notebook(old) if path.suffix == ".ipynb" else in_text(old)
        if new != old:
            changes[path] = new
    return changes


def finish(changes: dict[Path, str], arguments: list[str], complaint: str, done: str) -> int:
    """Write what has to change, or with --check only name it; return the exit status."""
    if "--check" in arguments:
        return report(changes, complaint)
    write(changes)
    print(done)
    return 0


def report(paths: Iterable[Path], complaint: str) -> int:
    """Say what is wrong with the files; return the exit status."""
    wrong = sorted(set(paths))
    for path in wrong:
        print(f"{path.relative_to(ROOT)} {complaint}: run `python3 run.py renumber`.")
    return 1 if wrong else 0


def write(changes: dict[Path, str]) -> None:
    """Write the new text of each file."""
    for path, text in changes.items():
        path.write_text(text, encoding="utf-8", newline="\n")
