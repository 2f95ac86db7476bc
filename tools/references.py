"""Write the numbers of figures, tables, equations and theorems into the chapters' references.

``[Figure 5](#fig:5)``, ``[(31)](#eq:31)`` and ``{prf:ref}`Theorem 2 <thm:2>` `` read alike in the
book, in JupyterLab and on GitHub; a bare ``{numref}`fig:5` `` does in the book alone. A label that
names an object of the paper carries its number; the book's own are counted in reading order, as
book/_ext/paper_numbers.py does. `python3 run.py renumber` turns roles into links and puts the
numbers right; with ``--check`` the chapters in which something is left to do are named instead.
"""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from pathlib import Path

from chapter_files import NOTEBOOKS, ROOT, finish, rewritten

BOOK = ROOT / "book"

ENTRY = re.compile(r"^(?:chapters/)?[a-z0-9_]+$")
TREE = re.compile(r"```\{toctree\}\n(.*?)```", re.S)
PAPER = re.compile(r"(?:eq|fig|tab|thm):(\d+[a-z]?)")
# What is numbered, in the order of the text: equations, theorems, what a cell shows, directives.
NUMBERED = re.compile(
    r"^\$\$ *\((?P<eq>eq:[\w-]+)\)$"
    r"|^```\{prf:theorem\}[^\n]*\n:label: (?P<thm>[\w:-]+)$"
    r"|^  figure:\n    caption:.*?(?:^    name: (?P<cell>[\w:-]+)$|(?=^  \w|^\w|^---$))"
    r"|^(?:```+|:::+)\{(?P<kind>figure|list-table|table)\}[^\n]*\n(?P<options>(?::[^\n]*\n)*)",
    re.M | re.S,
)
NAME = re.compile(r"^:name: ([\w:-]+)$", re.M)
WORDS = {"eq": "({})", "fig": "Figure {}", "tab": "Table {}", "thm": "Theorem {}"}

ROLE = re.compile(r"\{(numref|eq|prf:ref)\}`(?:([^`<]*?) *<([\w:-]+)>|([\w:-]+))`")
LINK = re.compile(r"\[((?:Figures? |Tables? |Theorems? )?\(?N?\d+[a-z]?\)?)\]\(#([\w:-]+)\)")
NUMBER = re.compile(r"N?\d+[a-z]?")


def main(arguments: list[str]) -> int:
    """Write what has to change, or with --check only name it."""
    known = numbers()
    changes = rewritten(
        lambda text: with_numbers(text, known), lambda text: in_notebook(text, known)
    )
    done = f"References of {len(changes)} files written."
    return finish(changes, arguments, "has old references", done)


def pages() -> list[Path]:
    """Return the text of every page in reading order, the front page first."""
    index = BOOK / "index.md"
    trees = "\n".join(TREE.findall(index.read_text(encoding="utf-8")))
    names = [line.strip() for line in trees.splitlines() if ENTRY.match(line.strip())]
    files = {name: BOOK / f"{name}.md" for name in names}
    files |= {n: NOTEBOOKS / f"{n[9:]}.md" for n in names if n.startswith("chapters/")}
    return [index, *files.values()]


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
    """Return what is numbered, and its label if it has one."""
    for kind in ("eq", "thm"):
        if match[kind]:
            return kind, match[kind]
    if match["kind"]:
        name = NAME.search(match["options"])
        return "fig" if match["kind"] == "figure" else "tab", name and name[1]
    return "tab" if (match["cell"] or "").startswith("tab:") else "fig", match["cell"]


def with_numbers(text: str, known: dict[str, str]) -> str:
    """Return a text with links for roles, and with the right numbers in them."""

    def from_role(match: re.Match[str]) -> str:
        role, title, label = match[1], match[2] or "", match[3] or match[4]
        if label not in known:
            return match[0]
        number = known[label]
        form = WORDS[label.partition(":")[0].partition("-")[0]]
        if NUMBER.search(title) or "%s" in title:
            form = NUMBER.sub("{}", title).replace("%s", "{}")
        elif title:
            form = title
        if role == "prf:ref":  # sphinx-proof answers its own role alone
            return f"{{prf:ref}}`{form.format(number)} <{label}>`"
        return f"[{form.format(number)}](#{label})"

    def from_link(match: re.Match[str]) -> str:
        said, label = match.groups()
        return (
            f"[{NUMBER.sub(known.get(label, '?'), said)}](#{label})" if label in known else match[0]
        )

    return LINK.sub(from_link, ROLE.sub(from_role, text))


def in_notebook(text: str, known: dict[str, str]) -> str:
    """Return a notebook with the references of its texts and captions written."""
    notebook = json.loads(text)
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            source = with_numbers("".join(cell["source"]), known)
            cell["source"] = source.splitlines(keepends=True)
        figure = cell["metadata"].get("mystnb", {}).get("figure", {})
        if "caption" in figure:
            figure["caption"] = with_numbers(figure["caption"], known)
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
