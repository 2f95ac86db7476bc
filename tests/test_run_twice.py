"""A chapter can be run as a reader runs it: each cell twice, and under another hash seed.

`run.py book` executes each cell once, under seed 0. Here each cell that is not long runs twice in a
row, under seed 1, and pictures, tables and results must come out the same, byte for byte.
"""

from __future__ import annotations

import os
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient
from nbformat import NotebookNode

ROOT = Path(__file__).resolve().parent.parent
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SEED = "1"
LONG = timedelta(seconds=2)  # a cell that took longer in the book is not run again
EVENTS = ("iopub.execute_input", "shell.execute_reply")
KINDS = ("image/svg+xml", "text/html", "text/markdown", "text/latex")


class Twice(NotebookClient):
    """Runs each cell of a notebook twice in a row, and notes which shows something else then."""

    differing: list[str]
    long: set[int]

    async def async_execute_cell(
        self, cell: NotebookNode, cell_index: int, *arguments: Any, **options: Any
    ) -> NotebookNode:
        first = await super().async_execute_cell(cell, cell_index, *arguments, **options)
        if cell_index in self.long:
            return first
        once = shown(cell)
        again = await super().async_execute_cell(cell, cell_index, *arguments, **options)
        if shown(cell) != once:
            self.differing.append(cell.source)
        return again


@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda path: path.stem)
def test_each_cell_twice_and_another_hash_seed_show_the_same(chapter: Path, tmp_path: Path) -> None:
    book = ROOT / "book" / "chapters" / chapter.name
    if not book.is_file():
        pytest.skip("the book has not been made")
    place = {"metadata": {"path": str(chapter.parent)}}
    client = Twice(nbformat.read(chapter, as_version=4), timeout=None, resources=place)
    client.differing, client.long = [], long_cells(nbformat.read(book, as_version=4))
    own = {"PYTHONHASHSEED": SEED, "QBOUND_RESULTS": str(tmp_path)}
    again = client.execute(env={**os.environ, **own})
    assert client.differing == []
    assert all_shown(again) == all_shown(nbformat.read(book, as_version=4))
    written = {file.name: file.read_bytes() for file in tmp_path.glob("*.json")}
    assert written
    assert written == {name: (ROOT / "results" / name).read_bytes() for name in written}


def long_cells(notebook: NotebookNode) -> set[int]:
    """Return the cells that took long when the book was made: twice they would double the pass."""
    taken = {
        i: [datetime.fromisoformat(cell.metadata.execution[event]) for event in EVENTS]
        for i, cell in enumerate(notebook.cells)
        if "execution" in cell.metadata
    }
    return {i for i, (start, end) in taken.items() if end - start > LONG}


def shown(cell: NotebookNode) -> list[str]:
    """Return what a code cell shows and a reader sees: pictures, tables, formulas."""
    outputs = cell.get("outputs", [])
    return [out.data[kind] for out in outputs for kind in KINDS if kind in out.get("data", {})]


def all_shown(notebook: NotebookNode) -> list[list[str]]:
    return [shown(cell) for cell in notebook.cells if cell.cell_type == "code"]
