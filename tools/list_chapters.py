"""Write notebooks/README.md: the chapters, and where each item of the paper is in them.

Titles come from the chapters, items from book/traceability.md. `python3 run.py renumber` writes it;
with ``--check`` it is only compared.
"""

from __future__ import annotations

import re
import sys

from chapter_files import NOTEBOOKS, ROOT, finish

TARGET = NOTEBOOKS / "README.md"
ROW = re.compile(
    r"^\| \{[\w:]+\}`(\w+):(\w+)` \| ([^|]+) \| \[[^\]]+\]\(chapters/(\w+)\.ipynb\)", re.M
)
TITLE = re.compile(r"^# ((?:\d+|[A-Z])\. .+)$", re.M)

HEAD = """\
# The chapters

Each chapter is a notebook (`.ipynb`) and, beside it, the same as text (`.md`). The book shows them
executed; here they stand without outputs. To run them and try things, take copies of your own:

```shell
python3 run.py lab      # JupyterLab, with all that the chapters need
```

Elsewhere they need this package with its extra `notebooks`. Nothing that you run in them changes a
recorded result; only `python3 run.py book` does. This list is written by `python3 run.py renumber`.
"""
ITEMS = {
    "Labelling": [("eq", str(n)) for n in range(1, 9)],
    "Theorems": [("thm", "1"), ("thm", "2")],
    "Tables": [("tab", str(n)) for n in range(1, 7)],
    "Figures": [("fig", str(n)) for n in range(1, 12)],
}
NAMES = {"eq": "Equation ({})", "thm": "Theorem {}", "tab": "Table {}", "fig": "Figure {}"}


def main(arguments: list[str]) -> int:
    """Write the list, or with --check compare it."""
    new = listed()
    old = TARGET.read_text(encoding="utf-8") if TARGET.exists() else ""
    done = f"{TARGET.relative_to(ROOT)} lists {len(titles())} chapters."
    return finish({TARGET: new} if new != old else {}, arguments, "is not up to date", done)


def listed() -> str:
    """Return the text of the list."""
    return "\n".join([HEAD, "## In the order of the book\n", *chapters(), "", *by_item()])


def titles() -> dict[str, str]:
    """Return the title of each chapter, by the name of its files."""
    files = sorted(NOTEBOOKS.glob("[0-9][0-9]_*.md"))
    return {file.stem: TITLE.findall(file.read_text(encoding="utf-8"))[0] for file in files}


def chapters() -> list[str]:
    """Return a line for each chapter."""
    return [f"- [{title}]({stem}.ipynb)" for stem, title in titles().items()]


def by_item() -> list[str]:
    """Return a table of the paper's items, equations of the labelling in one row."""
    page = (ROOT / "book" / "traceability.md").read_text(encoding="utf-8")
    rows = {(kind, number): rest for kind, number, *rest in ROW.findall(page)}
    lines = ["## By item of the paper\n", "| paper | what it is | chapter |", "|---|---|---|"]
    for group, items in ITEMS.items():
        if group == "Labelling":
            stems = {rows[item][1] for item in items}
            links = ", ".join(link(stem) for stem in sorted(stems))
            lines.append(
                f"| Equations (1) to ({items[-1][1]}) | labels of vectors and frames | {links} |"
            )
            continue
        for kind, number in items:
            what, stem = rows[kind, number]
            lines.append(f"| {NAMES[kind].format(number)} | {what} | {link(stem)} |")
    return [*lines, ""]


def link(stem: str) -> str:
    """Return a link to a chapter by its title."""
    return f"[{titles()[stem]}]({stem}.ipynb)"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
