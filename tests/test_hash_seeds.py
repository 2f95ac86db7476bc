"""The book is the same under another hash seed: pictures, tables and results, byte for byte.

`run.py book` executes the chapters under seed 0. Here each runs once more, under another one.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

ROOT = Path(__file__).resolve().parent.parent
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SEED = "1"
KINDS = ("image/svg+xml", "text/html", "text/markdown", "text/latex")


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda path: path.stem)
def test_a_chapter_is_the_same_under_another_hash_seed(chapter: Path, tmp_path: Path) -> None:
    book = ROOT / "book" / "chapters" / chapter.name
    if not book.is_file():
        pytest.skip("the book has not been made")
    again = executed(chapter, tmp_path)
    assert shown(again) == shown(nbformat.read(book, as_version=4))
    written = {file.name: file.read_bytes() for file in tmp_path.glob("*.json")}
    assert written
    assert written == {name: (ROOT / "results" / name).read_bytes() for name in written}


def executed(chapter: Path, results: Path) -> Any:
    """Run a chapter in a kernel of another seed; its results go elsewhere."""
    notebook = nbformat.read(chapter, as_version=4)
    place = {"metadata": {"path": str(chapter.parent)}}
    client = NotebookClient(notebook, timeout=None, resources=place)
    own = {"PYTHONHASHSEED": SEED, "QBOUND_RESULTS": str(results)}
    return client.execute(env={**os.environ, **own})


def shown(notebook: Any) -> list[list[str]]:
    """Return what the cells show and a reader sees: pictures, tables, formulas."""
    outputs = [cell.outputs for cell in notebook.cells if cell.cell_type == "code"]
    return [
        [output.data[kind] for output in cell for kind in KINDS if kind in output.get("data", {})]
        for cell in outputs
    ]
