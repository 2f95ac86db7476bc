"""Run each cell of a chapter twice in a row: what it shows must be the same both times.

A cell that took long runs once, because the few long cells would double the time of a book.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from datetime import datetime, timedelta
from typing import Any

LONG = timedelta(seconds=0.25)
EVENTS = ("iopub.execute_input", "shell.execute_reply")
KINDS = ("image/svg+xml", "text/html", "text/markdown", "text/latex")

Cell = Any  # nbformat's NotebookNode; this file is read where nbformat may not be installed
Execute = Callable[..., Awaitable[Cell]]


def is_long(cell: Cell) -> bool:
    """Tell whether a cell took long when it was last run; the notebook says how long."""
    if "execution" not in cell.metadata:
        return False
    start, end = (datetime.fromisoformat(cell.metadata.execution[event]) for event in EVENTS)
    return end - start > LONG


def shown(cell: Cell) -> list[str]:
    """Return the visible outputs of a code cell: pictures, tables, formulas."""
    outputs = cell.get("outputs", [])
    return [out.data[kind] for out in outputs for kind in KINDS if kind in out.get("data", {})]


def twice(execute: Execute, is_wanted: Callable[[], bool]) -> Execute:
    """Return a version of nbclient's `async_execute_cell` that runs a cell twice if wanted."""

    async def execute_cell(client: Any, cell: Cell, *arguments: Any, **options: Any) -> Cell:
        done = await execute(client, cell, *arguments, **options)
        if cell.cell_type != "code" or not is_wanted() or is_long(cell):
            return done
        once = shown(cell)
        done = await execute(client, cell, *arguments, **options)
        if shown(cell) != once:
            raise RuntimeError(f"run again, this cell shows something else:\n{cell.source}")
        return done

    return execute_cell
