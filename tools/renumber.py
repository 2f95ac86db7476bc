"""Number the chapters in the order of the book: files, titles, and every link to them.

The order is that of the toctrees in book/index.md; what stands below the caption "Appendices" is
called by a letter. To put a chapter in the middle, write notebooks/NAME.md (any number, or none,
before the name), name it there as chapters/NAME, and run

    python3 run.py renumber

A chapter is known by its name everywhere else: the ledger, the results and the tests say "region",
not "07_region". ``--check`` writes nothing and fails if something would change.
"""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from chapter_files import ROOT, chapters, report, write

INDEX = ROOT / "book" / "index.md"
ORDER = ROOT / "src" / "lizarraga2025" / "recorded.py"

ENTRY = re.compile(r"^chapters/(?:\d\d_)?(\w+)$", re.M)
APPENDED = re.compile(r"^:caption: Appendices$.*", re.M | re.S)
LISTED = re.compile(r"(?<=^CHAPTERS = \(\n).*?(?=^\)$)", re.M | re.S)
LETTERED = re.compile(r"(?<=^APPENDICES = \().*?(?=\)$)", re.M)
TITLE = re.compile(r'^(\s*"?# )(?:(?:\d+|[A-Z])\. )?', re.M)  # of a file, of a notebook too
LINK = re.compile(r"\[[^\[\]]*\]\((?:\.\./notebooks/|chapters/)?\d\d_(\w+)\.(?:ipynb|md)[^)]*\)")
SAID = re.compile(r"([Cc]hapter|[Aa]ppendix) (?:\d+|[A-Z])\b|(?<=^\[)(?:\d+|[A-Z])(?=\. )")


def main(arguments: list[str]) -> int:
    """Write what has to change, or with --check only name it."""
    index = INDEX.read_text(encoding="utf-8")
    names, appended = ENTRY.findall(index), APPENDED.search(index)
    appendices = ENTRY.findall(appended[0]) if appended else []
    problem = unlisted(names)
    if problem:
        print(problem, file=sys.stderr)
        return 1
    changes = renumbered(names, appendices)
    moves = {old: new for old, new in moved(names).items() if old != new}
    if "--check" in arguments:
        return report([*changes, *moves], "is out of order")
    write(changes)
    rename(moves)
    print(f"{len(names)} chapters; {len(changes)} files written, {len(moves)} renamed.")
    return 0


def unlisted(names: list[str]) -> str:
    """Say which chapters have no place in the order, or no file."""
    files = {name_of(path) for path in chapters()}
    if len(set(names)) < len(names):
        return "book/index.md names a chapter twice."
    if files != set(names):
        return f"book/index.md and notebooks/ differ: {', '.join(sorted(files ^ set(names)))}."
    return ""


def name_of(path: Path) -> str:
    """Return a chapter's name, without its number."""
    return re.sub(r"^\d\d_", "", path.stem)


def moved(names: list[str]) -> dict[Path, Path]:
    """Return the new path of each file of a chapter."""
    stems = {name: f"{number:02d}_{name}" for number, name in enumerate(names, start=1)}
    return {path: path.with_name(stems[name_of(path)] + path.suffix) for path in chapters()}


def called(names: list[str], appendices: list[str]) -> dict[str, str]:
    """Return what a reader calls each chapter: a number, or the letter of an appendix."""
    count = len(names) - len(appendices)
    letters = [chr(ord("A") + k) for k in range(len(appendices))]
    return dict(zip(names, [*map(str, range(1, count + 1)), *letters], strict=True))


def renumbered(names: list[str], appendices: list[str]) -> dict[Path, str]:
    """Return the new text of every file that has to change."""
    numbers = {name: number for number, name in enumerate(names, start=1)}
    calls = called(names, appendices)
    stem = re.compile(rf"\b\d\d_({'|'.join(names)})\b")

    def with_number(match: re.Match[str]) -> str:
        return f"{numbers[match[1]]:02d}_{match[1]}"

    def with_spoken_number(match: re.Match[str]) -> str:
        if match[1] not in calls:
            return match[0]  # no chapter of that name: Sphinx will say so
        call = calls[match[1]]
        word = "chapter" if call.isdigit() else "appendix"

        def said(found: re.Match[str]) -> str:
            if found[1] is None:
                return call
            return f"{word.capitalize() if found[1][0].isupper() else word} {call}"

        return SAID.sub(said, match[0])

    changes, titled = {}, set(chapters())
    for path in texts():
        old = path.read_text(encoding="utf-8")
        new = LINK.sub(with_spoken_number, stem.sub(with_number, old))
        if path == INDEX:
            new = ENTRY.sub(lambda entry: f"chapters/{with_number(entry)}", new)
        if path == ORDER:
            new = LISTED.sub("".join(f'    "{name}",\n' for name in names), new)
            new = LETTERED.sub(", ".join(f'"{name}"' for name in appendices), new)
        if path in titled:
            new = TITLE.sub(rf"\g<1>{calls[name_of(path)]}. ", new, count=1)
        if new != old:
            changes[path] = new
    return changes


def texts() -> list[Path]:
    """Return every text of the repository that may name a chapter; records of the past stay."""
    kinds = {".md", ".ipynb", ".py", ".toml", ".js", ".html", ".yml"}
    past = {"CHANGELOG.md"}
    paths = [path for path in files() if path.suffix in kinds and path.is_file()]
    return sorted(p for p in paths if p.name not in past)


def files() -> list[Path]:
    """Return the files that git tracks or would; without git, all but what tools have made."""
    listing = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    try:
        listed = subprocess.run(listing, cwd=ROOT, capture_output=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        made = {"_build", "chapters", "generated", "workbook", "dist", "build"}
        found = [path.relative_to(ROOT) for path in ROOT.rglob("*")]
        kept = [p for p in found if not any(x in made or x.startswith(".") for x in p.parts)]
        return [ROOT / path for path in kept]
    return [ROOT / name for name in listed.decode().split("\0") if name]


def rename(moves: dict[Path, Path]) -> None:
    """Rename in two steps: chapters may change places with one another."""
    aside = {old: old.with_name(f"moving-{old.name}") for old in moves}
    for old, between in aside.items():
        old.rename(between)
    for old, new in moves.items():
        aside[old].rename(new)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
