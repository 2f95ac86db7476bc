"""Give every chapter the same first cell, which says what has to be installed.

It stands before the chapter's own first cell of code; where qbound is missing it names what to
install, or, on Colab, installs it from the address that pyproject.toml states.
`python3 run.py renumber` writes it; with ``--check`` the chapters that lack it are named instead.
"""

from __future__ import annotations

import json
import sys
import tomllib
from typing import Any

from chapter_files import ROOT, finish, rewritten

OWN = "first-cell"  # the tag by which the cell is known
TAGS = ["hide-input", OWN]

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


def main(arguments: list[str]) -> int:
    """Write what has to change, or with --check only name it."""
    code = first_cell((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    changes = rewritten(lambda text: in_text(text, code), lambda text: in_notebook(text, code))
    return finish(changes, arguments, "begins otherwise", f"{len(changes)} first cells written.")


def first_cell(pyproject: str) -> str:
    """Return the code of the cell, for the address of the repository, if there is one."""
    address = tomllib.loads(pyproject)["tool"]["qbound"]["repository"]
    return (BEGIN + (WITH_ADDRESS.format(address=address) if address else WITHOUT_ADDRESS)).strip()


def in_text(text: str, code: str) -> str:
    """Return a chapter's text with the cell before its first cell of code."""
    begin, end = "```{code-cell} ipython3\n", "```\n\n"
    head = f"---\njupyter:\n  source_hidden: true\ntags: [{', '.join(TAGS)}]\n---\n"
    before, found, after = text.partition(begin)
    if not found:
        return text
    if after.startswith(head):
        after = after.partition(end)[2].removeprefix(begin)
    return before + begin + head + code + "\n" + end + begin + after


def in_notebook(text: str, code: str) -> str:
    """Return a notebook with the cell before its first cell of code."""
    notebook = json.loads(text)
    cells = [c for c in notebook["cells"] if OWN not in c["metadata"].get("tags", [])]
    place = next((i for i, cell in enumerate(cells) if cell["cell_type"] == "code"), None)
    if place is None:
        return text
    own: dict[str, Any] = {"cell_type": "code", "execution_count": None, "id": OWN}
    own |= {"metadata": {"jupyter": {"source_hidden": True}, "tags": TAGS}, "outputs": []}
    own["source"] = code.splitlines(keepends=True)
    notebook["cells"] = [*cells[:place], own, *cells[place:]]
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
