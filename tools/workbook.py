"""Copy the notebooks for a reader who runs them: python3 tools/workbook.py FOLDER.

JupyterLab numbers equations and theorems anew in each notebook, and shows no captions of a cell's
figures. So the copies carry the book's numbers and captions. A copy that is there is left alone: it
may hold a reader's work.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import renumber

# Front matter of the first cell: no numbers but ours.
PLAIN = "---\nnumbering:\n  equation: false\n---\n\n"
EQUATION = re.compile(r"^\$\$ *\((eq:[\w-]+)\)$", re.M)
THEOREM = re.compile(r"^(```\{prf:theorem\}[^\n]*\n:label: )([\w:-]+)$", re.M)
CITED = re.compile(r"\{cite(?::[tp])?\}`([^`]+)`")


def main(arguments: list[str]) -> int:
    """Copy the notebooks that are not there yet."""
    folder = Path(arguments[0])
    folder.mkdir(parents=True, exist_ok=True)
    known = renumber.numbers()
    sources = [path.with_suffix(".ipynb") for path in renumber.chapter_texts()]
    missing = [source for source in sources if not (folder / source.name).exists()]
    for source in missing:
        content = json.loads(source.read_text(encoding="utf-8"))
        text = json.dumps(reader_copy(content, known), indent=1, ensure_ascii=False) + "\n"
        (folder / source.name).write_text(text, encoding="utf-8", newline="\n")
    print(f"{len(missing)} of {len(sources)} notebooks copied; the others were there.")
    return 0


def reader_copy(notebook: dict[str, Any], known: dict[str, str]) -> dict[str, Any]:
    """Return a notebook as it reads well in JupyterLab."""
    cells = []
    for cell in notebook["cells"]:
        source = "".join(cell["source"])
        if cell["cell_type"] == "markdown":
            source = readable(source, known)
            if not cells:
                source = PLAIN + source
        cells.append(cell | {"source": source.splitlines(keepends=True)})
        figure = cell["metadata"].get("mystnb", {}).get("figure", {})
        if "caption" in figure:
            cells.append(caption(cell.get("id", ""), figure, known))
    return notebook | {"cells": cells}


def readable(text: str, known: dict[str, str]) -> str:
    """Write the book's numbers beside equations and theorems, and into renumber."""

    def tagged(match: re.Match[str]) -> str:
        return f"\\tag{{{known[match[1]]}}}\n$$ ({match[1]})"

    text = EQUATION.sub(tagged, renumber.with_numbers(text, known))
    text = THEOREM.sub(lambda m: f"{m[1]}{m[2]}\n:enumerator: {known[m[2]]}", text)
    return CITED.sub(lambda match: f"({match[1]})", text)


def caption(cell: str, figure: dict[str, str], known: dict[str, str]) -> dict[str, Any]:
    """Return a cell with the caption of the output of the cell before it."""
    label = figure.get("name", "")
    word = "Table" if label.startswith("tab:") else "Figure"
    title = f"**{word} {known[label]}.** " if label in known else ""
    text = title + readable(figure["caption"], known)
    return {
        "cell_type": "markdown",
        "id": f"{cell}-caption",
        "metadata": {},
        "source": text.splitlines(keepends=True),
    }


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
