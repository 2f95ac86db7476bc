"""Write the parts that chapters share: numbers of references, first cells.

`python3 run.py renumber` edits the texts (``.md``) and then pairs their notebooks by jupytext. With
``--check`` nothing is written; the files in which something is left to do are named.

- References: ``[Figure 5](#fig:5)``, ``[(31)](#eq:31)`` and ``{prf:ref}`Theorem 2 <thm:2>` `` read
  alike in the book, in JupyterLab and on GitHub; a bare ``{numref}`fig:5` `` does in the book
  alone. A label that names an object of the paper carries its number; the book's own are counted
  in reading order, as book/_ext/paper_numbers.py does.
- First cells: every chapter begins with the same cell of code. Where qbound is missing, this cell
  names what to install, or, on Colab, installs it from the address that pyproject.toml states.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BOOK, NOTEBOOKS = ROOT / "book", ROOT / "notebooks"
INDEX = BOOK / "index.md"

Texts = dict[Path, str]
"""The new text of each file that has to change."""


def main(arguments: list[str]) -> int:
    """Write what has to change, or with --check only name it."""
    check = "--check" in arguments
    wrong = sorted(write(referenced(), check) | write(with_first_cells(), check))
    if check:
        for path in wrong:
            print(f"{path.relative_to(ROOT)} is not up to date: run `python3 run.py renumber`.")
        return int(bool(wrong))
    if wrong:
        pair = [sys.executable, "-m", "jupytext", "--quiet", "--update", "--to", "ipynb"]
        subprocess.run([*pair, *map(str, wrong)], check=True)
    print(f"{len(wrong)} chapters written.")
    return 0


def write(changes: Texts, check: bool) -> set[Path]:
    """Write the files, unless they are only checked; return which have to change."""
    for path, text in () if check else changes.items():
        path.write_text(text, encoding="utf-8", newline="\n")
    return set(changes)


def chapter_texts() -> list[Path]:
    """Return the texts of all chapters."""
    return sorted(path for path in NOTEBOOKS.glob("*.md") if path.stem != "README")


def rewritten(texts: Texts) -> Texts:
    """Return those texts that differ from their files."""
    return {path: text for path, text in texts.items() if text != path.read_text(encoding="utf-8")}


# --- references -----------------------------------------------------------------------------------

PAGE = re.compile(r"^(?:chapters/)?[a-z0-9_]+$")
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
NUMBERED_LINK = re.compile(
    r"\[((?:Figures? |Tables? |Theorems? )?\(?N?\d+[a-z]?\)?)\]\(#([\w:-]+)\)"
)
NUMBER = re.compile(r"N?\d+[a-z]?")


def referenced() -> Texts:
    """Turn roles into links, and put the numbers right."""
    known = numbers()
    texts = {path: path.read_text(encoding="utf-8") for path in chapter_texts()}
    return rewritten({path: with_numbers(text, known) for path, text in texts.items()})


def pages() -> list[Path]:
    """Return the text of every page in reading order, the front page first."""
    trees = "\n".join(TREE.findall(INDEX.read_text(encoding="utf-8")))
    names = [line.strip() for line in trees.splitlines() if PAGE.match(line.strip())]
    files = {name: BOOK / f"{name}.md" for name in names}
    files |= {n: NOTEBOOKS / f"{n[9:]}.md" for n in names if n.startswith("chapters/")}
    return [INDEX, *files.values()]


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

    return NUMBERED_LINK.sub(from_link, ROLE.sub(from_role, text))


# --- first cells ----------------------------------------------------------------------------------

TAGS = ["hide-input", "first-cell"]

BEGIN = """\
# What this chapter needs: Python 3.11 or newer, and qbound with its extra "notebooks".
import importlib.util
"""
WITHOUT_ADDRESS = """
if importlib.util.find_spec("qbound") is None:
    raise ModuleNotFoundError("in a copy of the repository: pip install '.[notebooks]'")
"""
WITH_ADDRESS = """\
import sys

SOURCE = "qbound[notebooks] @ git+{address}"
if importlib.util.find_spec("qbound") is None:
    if "google.colab" not in sys.modules:
        raise ModuleNotFoundError(f'to install it: pip install "{{SOURCE}}"')
    import subprocess  # prepared for Colab; it was not tried there

    subprocess.run([sys.executable, "-m", "pip", "install", "--quiet", SOURCE], check=True)
"""


def with_first_cells() -> Texts:
    """Put the cell before the first cell of code of every chapter."""
    code = first_cell((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    texts = {path: path.read_text(encoding="utf-8") for path in chapter_texts()}
    return rewritten({path: with_first_cell(text, code) for path, text in texts.items()})


def first_cell(pyproject: str) -> str:
    """Return the code of the cell, for the address of the repository, if there is one."""
    address = tomllib.loads(pyproject)["project"]["urls"].get("Repository")
    return (BEGIN + (WITH_ADDRESS.format(address=address) if address else WITHOUT_ADDRESS)).strip()


def with_first_cell(text: str, code: str) -> str:
    """Return a chapter's text with the cell before its first cell of code."""
    begin, end = "```{code-cell} ipython3\n", "```\n\n"
    head = f"---\njupyter:\n  source_hidden: true\ntags: [{', '.join(TAGS)}]\n---\n"
    before, found, after = text.partition(begin)
    if not found:
        return text
    if after.startswith(head):
        after = after.partition(end)[2].removeprefix(begin)
    return before + begin + head + code + "\n" + end + begin + after


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
