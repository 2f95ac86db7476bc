"""A chapter can be run as a reader runs it: each cell twice, and under another hash seed.

`run.py book` executes each cell once, under seed 0. In `.ci/run` each short cell runs twice in a
row, under seed 1, and results are compared with the committed ones.
"""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import nbformat
import pytest
from nbformat import NotebookNode

from engine_support.scripts import load_script

per_chapter = load_script("tools/chapters/per_chapter.py")


def run_cell(outputs: list[str]) -> NotebookNode:
    """Run a cell that shows these one after the other, as a chapter's cells run twice."""
    cell = nbformat.v4.new_code_cell("counter")

    async def execute(_: Any, cell: NotebookNode) -> NotebookNode:
        data = {"text/html": outputs.pop(0)}
        cell.outputs = [nbformat.v4.new_output("display_data", data=data)]
        return cell

    # A thread of its own: a browser of this process may run a loop in the first.
    with ThreadPoolExecutor() as threads:
        return threads.submit(asyncio.run, per_chapter.twice(execute)(None, cell)).result()


def test_a_cell_that_shows_something_else_the_second_time_is_named() -> None:
    assert run_cell(["1", "1"]).outputs[0].data["text/html"] == "1"
    with pytest.raises(RuntimeError, match="something else:\ncounter"):
        run_cell(["1", "2"])
