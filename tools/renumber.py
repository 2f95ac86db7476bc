"""Write the parts that chapters share: numbers of references, first cells.

`python3 run.py renumber` edits the texts (``.md``) and then pairs their notebooks by jupytext. With
``--check`` nothing is written; the files in which something is left to do are named.

- References: ``[Figure 5](#fig:5)``, ``[(31)](#eq:31)`` and ``{prf:ref}`Theorem 2 <thm:2>` `` read
  alike in the book, in JupyterLab and on GitHub; any number may be written in a new one. A label
  that names an object of the paper carries its number; the book's own are counted in reading
  order, as book/_ext/paper_numbers.py does.
- First cells: every chapter begins with a cell that names what to install where it is missing. The
  chapters about the paper have that of the first chapter, the others that of the first of them.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

from lizarraga2025 import recorded

ROOT = Path(__file__).resolve().parent.parent
BOOK, NOTEBOOKS = ROOT / "book", ROOT / "notebooks"


def main(arguments: list[str]) -> int:
    """Write what has to change, or with --check only name it."""
    known, cells = numbers(), dict[bool, list[str]]()
    wrong = dict[Path, str]()
    for path in chapter_texts():
        text = path.read_text(encoding="utf-8")
        of_paper = path.stem[3:] in recorded.PAPER
        [cell] = cells.setdefault(of_paper, FIRST_CELL.findall(text))
        right = with_first_cell(with_numbers(text, known), cell)
        if right != text:
            wrong[path] = right
    if "--check" in arguments:
        for path in wrong:
            print(f"{path.relative_to(ROOT)} is not up to date: run `python3 run.py renumber`.")
        return int(bool(wrong))
    for path, right in wrong.items():
        path.write_text(right, encoding="utf-8", newline="\n")
    if wrong:
        pair = [sys.executable, "-m", "jupytext", "--quiet", "--update", "--to", "ipynb"]
        subprocess.run([*pair, *map(str, wrong)], check=True)
    print(f"{len(wrong)} chapters written.")
    return 0


def chapter_texts() -> list[Path]:
    """Return the texts of all chapters."""
    return sorted(path for path in NOTEBOOKS.glob("*.md") if path.stem != "README")


# --- references -----------------------------------------------------------------------------------

PAGE = re.compile(r"^(?:chapters/)?[a-z0-9_]+$")
TREE = re.compile(r"```\{toctree\}\n(.*?)```", re.S)
PAPER = re.compile(r"(?:eq|fig|tab|thm):(\d+[a-z]?)")
# What is numbered, in the order of the text: equations, theorems, what a cell shows, directives.
NUMBERED = re.compile(
    r"^\$\$ *\((?P<eq>eq:[\w-]+)\)$"
    r"|^```\{prf:theorem\}[^\n]*\n:label: (?P<thm>[\w:-]+)$"
    r"|^  figure:\n    caption:.*?(?:^    name: (?P<cell>[\w:-]+)$|(?=^  \w|^\w|^---$))"
    r"|^(?:```+|:::+)\{(?P<kind>figure|list-table|table|choices)\}[^\n]*\n(?P<options>(?::[^\n]*\n)*)",
    re.M | re.S,
)
NAME = re.compile(r"^:name: ([\w:-]+)$", re.M)
# A reference with a number: before it, what is said, between, label.
REFERENCE = re.compile(
    r"(\[|\{prf:ref\}`)((?:Figures? |Tables? |Theorems? )?\(?N?\d+[a-z]?\)?)(\]\(#| <)([\w:-]+)"
)
NUMBER = re.compile(r"N?\d+[a-z]?")


def pages(name: str = "index") -> list[Path]:
    """Return the texts of a page and of those below it, in reading order."""
    is_chapter = name.startswith("chapters/")
    file = NOTEBOOKS / f"{name[9:]}.md" if is_chapter else BOOK / f"{name}.md"
    trees = "\n".join(TREE.findall(file.read_text(encoding="utf-8")))
    below = [line.strip() for line in trees.splitlines() if PAGE.match(line.strip())]
    return [file, *(page for one in below for page in pages(one))]


def numbers() -> dict[str, str]:
    """Return the number of every label, such as 5 for fig:5 and N3 for one of the book's own."""
    own: Counter[str] = Counter()
    found = {}
    for page in pages():
        for match in NUMBERED.finditer(page.read_text(encoding="utf-8")):
            kind, label = kind_and_label(match)
            paper = PAPER.fullmatch(label or "")
            own[kind] += paper is None
            if label:
                found[label] = paper[1] if paper else f"N{own[kind]}"
    return found


def kind_and_label(match: re.Match[str]) -> tuple[str, str | None]:
    """Return the kind of a numbered item, and its label if it has one."""
    for kind in ("eq", "thm"):
        if match[kind]:
            return kind, match[kind]
    if match["kind"]:
        name = NAME.search(match["options"])
        return "fig" if match["kind"] == "figure" else "tab", name and name[1]
    return "tab" if (match["cell"] or "").startswith("tab:") else "fig", match["cell"]


def with_numbers(text: str, known: dict[str, str]) -> str:
    """Return a text with the right numbers in its references."""

    def right(match: re.Match[str]) -> str:
        before, said, between, label = match.groups()
        said = NUMBER.sub(known[label], said) if label in known else said
        return f"{before}{said}{between}{label}"

    return REFERENCE.sub(right, text)


# --- first cells ----------------------------------------------------------------------------------

FIRST_CELL = re.compile(
    r"^```\{code-cell\} ipython3\n---\njupyter:\n.*\ntags: \[.*first-cell\]\n---\n"
    r"(?:[^`].*\n|\n)*```\n\n",
    re.M,
)


def with_first_cell(text: str, cell: str) -> str:
    """Return a chapter's text with the cell before its first cell of code."""
    before, found, after = FIRST_CELL.sub("", text).partition("```{code-cell}")
    return before + cell + found + after if found else text


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
