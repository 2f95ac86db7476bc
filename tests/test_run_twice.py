"""A chapter can be run as a reader runs it: each cell twice, and under another hash seed.

`run.py book` executes each cell once, under seed 0. In `.ci/run` each short cell runs twice in a
row, under seed 1, and results are compared with the committed ones. Here, where it is asked for,
all chapters run so once more, and pictures, tables and results must be the same, byte for byte.
"""

from __future__ import annotations

import asyncio
import os
import re
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import MethodType
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient
from nbformat import NotebookNode

from support.scripts import load_script

ROOT = Path(__file__).resolve().parent.parent
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SEED = "1"

twice = load_script("tools/chapters/twice.py")


@pytest.mark.skipif(
    os.environ.get("QBOUND_EVERY_CHAPTER") != "1",
    reason="QBOUND_EVERY_CHAPTER=1 executes all chapters once more: do it before a release",
)
@pytest.mark.parametrize("chapter", CHAPTERS, ids=lambda path: path.stem)
def test_each_cell_twice_and_another_hash_seed_show_the_same(chapter: Path, tmp_path: Path) -> None:
    book = ROOT / "book" / "chapters" / chapter.name
    if not book.is_file():
        pytest.skip("the book has not been made")
    made = nbformat.read(book, as_version=4)
    long = [cell.source for cell in made.cells if twice.is_long(cell)]
    client = NotebookClient(
        nbformat.read(chapter, as_version=4),
        timeout=None,
        resources={"metadata": {"path": str(chapter.parent)}},
    )
    again = twice.twice(NotebookClient.async_execute_cell, lambda: True)
    own = {"PYTHONHASHSEED": SEED, "QBOUND_RESULTS": str(tmp_path)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(twice, "is_long", lambda cell: cell.source in long)
        patch.setattr(client, "async_execute_cell", MethodType(again, client))
        executed = client.execute(env={**os.environ, **own})
    assert all_shown(executed) == all_shown(made)
    written = {file.name: file.read_bytes() for file in tmp_path.glob("*.json")}
    assert written
    assert written == {name: (ROOT / "results" / name).read_bytes() for name in written}


def all_shown(notebook: NotebookNode) -> list[list[str]]:
    return [twice.shown(cell) for cell in notebook.cells if cell.cell_type == "code"]


def test_ci_runs_each_cell_twice_under_another_seed() -> None:
    settings = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert re.search(r"^export QBOUND_TWICE=1 QBOUND_HASH_SEED=[1-9]", settings, re.M)


def run_cell(outputs: list[str]) -> NotebookNode:
    """Run a cell that shows these one after the other, as a chapter's cells run twice."""
    cell = nbformat.v4.new_code_cell("counter")

    async def execute(_: Any, cell: NotebookNode) -> NotebookNode:
        data = {"text/html": outputs.pop(0)}
        cell.outputs = [nbformat.v4.new_output("display_data", data=data)]
        return cell

    # A thread of its own: a browser of this process may run a loop in the first.
    with ThreadPoolExecutor() as threads:
        return threads.submit(asyncio.run, twice.twice(execute, lambda: True)(None, cell)).result()


def test_a_cell_that_shows_something_else_the_second_time_is_named() -> None:
    assert run_cell(["1", "1"]).outputs[0].data["text/html"] == "1"
    with pytest.raises(RuntimeError, match="something else:\ncounter"):
        run_cell(["1", "2"])
