"""Write the parts that chapters share: numbers, references, first cells, their list.

`python3 run.py renumber` edits the texts (``.md``) and then pairs their notebooks by jupytext. With
``--check`` nothing is written; the files in which something is left to do are named.

- Numbers: the order of the chapters is that of the toctrees in book/index.md; what stands below the
  caption "Appendices" is called by a letter. To put a chapter in the middle, write
  notebooks/NAME.md (any number, or none, before the name) and name it there as chapters/NAME.
  Files, titles and links follow. A chapter is known by its name everywhere else: the ledger, the
  results and the tests say "region", not "07_region".
- References: ``[Figure 5](#fig:5)``, ``[(31)](#eq:31)`` and ``{prf:ref}`Theorem 2 <thm:2>` `` read
  alike in the book, in JupyterLab and on GitHub; a bare ``{numref}`fig:5` `` does in the book
  alone. A label that names an object of the paper carries its number; the book's own are counted
  in reading order, as book/_ext/paper_numbers.py does.
- First cells: every chapter begins with the same cell of code. Where qbound is missing, this cell
  names what to install, or, on Colab, installs it from the address that pyproject.toml states.
- The list: notebooks/README.md has the chapters, and where each item of the paper is in them.
  Titles come from the chapters, items from book/traceability.md.
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
ORDER = ROOT / "src" / "lizarraga2025" / "recorded.py"
LIST = NOTEBOOKS / "README.md"

Texts = dict[Path, str]
"""The new text of each file that has to change."""


def main(arguments: list[str]) -> int:
    """Write what has to change, or with --check only name it."""
    names, appendices = order()
    problem = unlisted(names)
    if problem:
        print(problem, file=sys.stderr)
        return 1
    check = "--check" in arguments
    moves = {old: new for old, new in moved(names).items() if old != new}
    wrong = write(renumbered(names, appendices), check) | moves.keys()
    if not check:
        rename(moves)
        wrong = {moves.get(path, path) for path in wrong}
    for step in (referenced, with_first_cells, listed):
        wrong |= write(step(), check)
    if check:
        for path in sorted(wrong):
            print(f"{path.relative_to(ROOT)} is not up to date: run `python3 run.py renumber`.")
        return int(bool(wrong))
    texts = [str(path) for path in chapter_texts() if path in wrong]
    if texts:
        pair = [sys.executable, "-m", "jupytext", "--quiet", "--update", "--to", "ipynb"]
        subprocess.run([*pair, *texts], check=True)
    print(f"{len(names)} chapters; {len(wrong)} files written, {len(moves)} renamed.")
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


# --- numbers of chapters --------------------------------------------------------------------------

CHAPTER = re.compile(r"^chapters/(?:\d\d_)?(\w+)$", re.M)
APPENDED = re.compile(r"^:caption: Appendices$.*", re.M | re.S)
LISTED = re.compile(r"(?<=^CHAPTERS = \(\n).*?(?=^\)$)", re.M | re.S)
LETTERED = re.compile(r"(?<=^APPENDICES = \().*?(?=\)$)", re.M)
TITLE = re.compile(r"^(# )(?:(?:\d+|[A-Z])\. )?", re.M)  # of a file
LINK = re.compile(r"\[[^\[\]]*\]\((?:\.\./notebooks/|chapters/)?\d\d_(\w+)\.(?:ipynb|md)[^)]*\)")
SAID = re.compile(r"([Cc]hapter|[Aa]ppendix) (?:\d+|[A-Z])\b|(?<=^\[)(?:\d+|[A-Z])(?=\. )")


def order() -> tuple[list[str], list[str]]:
    """Return the names of all chapters in the order of the book, and of those in the appendices."""
    index = INDEX.read_text(encoding="utf-8")
    appended = APPENDED.search(index)
    return CHAPTER.findall(index), CHAPTER.findall(appended[0]) if appended else []


def unlisted(names: list[str]) -> str:
    """Say which chapters have no place in the order, or no file."""
    files = {name_of(path) for path in chapter_texts()}
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
    files = [
        p for text in chapter_texts() for p in (text, text.with_suffix(".ipynb")) if p.exists()
    ]
    return {path: path.with_name(stems[name_of(path)] + path.suffix) for path in files}


def called(names: list[str], appendices: list[str]) -> dict[str, str]:
    """Return the name of each chapter for readers: a number, or the letter of an appendix."""
    count = len(names) - len(appendices)
    letters = [chr(ord("A") + k) for k in range(len(appendices))]
    return dict(zip(names, [*map(str, range(1, count + 1)), *letters], strict=True))


def renumbered(names: list[str], appendices: list[str]) -> Texts:
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

    changes, titled = {}, set(chapter_texts())
    for path in texts():
        old = path.read_text(encoding="utf-8")
        new = LINK.sub(with_spoken_number, stem.sub(with_number, old))
        if path == INDEX:
            new = CHAPTER.sub(lambda entry: f"chapters/{with_number(entry)}", new)
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
    kinds = {".md", ".py", ".toml", ".js", ".html", ".yml"}
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


# --- the list of chapters -------------------------------------------------------------------------

ROW = re.compile(
    r"^\| \{[\w:]+\}`(\w+):(\w+)` \| ([^|]+) \| \[[^\]]+\]\(chapters/(\w+)\.ipynb\)", re.M
)
NAMED = re.compile(r"^# ((?:\d+|[A-Z])\. .+)$", re.M)

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


def listed() -> Texts:
    """Write the list."""
    links = [f"- [{title}]({stem}.ipynb)" for stem, title in titles().items()]
    lines = [HEAD, "## In the order of the book\n", *links, "", *by_item()]
    return rewritten({LIST: "\n".join(lines)})


def titles() -> dict[str, str]:
    """Return the title of each chapter, by the name of its files."""
    files = sorted(NOTEBOOKS.glob("[0-9][0-9]_*.md"))
    return {file.stem: NAMED.findall(file.read_text(encoding="utf-8"))[0] for file in files}


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
