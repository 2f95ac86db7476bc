"""For pytest, in the run in which nbmake executes a copy of a chapter.

With ``QBOUND_TWICE=1`` each short cell runs twice in a row, and what it shows must be the same both
times: a cell that depends on its own earlier run is found. If the process that started this one is
killed, this one ends too, as kernels do.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Awaitable, Callable
from datetime import datetime, timedelta
from typing import Any

from nbclient import NotebookClient
from nbformat import NotebookNode

LONG = timedelta(seconds=0.25)  # such a cell runs once: they are few and would double the time
EVENTS = ("iopub.execute_input", "shell.execute_reply")
KINDS = ("image/svg+xml", "text/html", "text/markdown", "text/latex")

Execute = Callable[..., Awaitable[NotebookNode]]


def end_with(parent: int) -> None:
    """End this process as soon as its parent has ended."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


def pytest_configure() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C: the one who started this says so
    threading.Thread(target=end_with, args=[os.getppid()], daemon=True).start()
    if os.environ.get("QBOUND_TWICE") == "1":
        NotebookClient.async_execute_cell = twice(NotebookClient.async_execute_cell)


def is_long(cell: NotebookNode) -> bool:
    """Tell whether a cell took long when it was last run; the notebook says how long."""
    if "execution" not in cell.metadata:
        return False
    start, end = (datetime.fromisoformat(cell.metadata.execution[event]) for event in EVENTS)
    return end - start > LONG


def shown(cell: NotebookNode) -> list[str]:
    """Return the visible outputs of a code cell: pictures, tables, formulas."""
    outputs = cell.get("outputs", [])
    return [out.data[kind] for out in outputs for kind in KINDS if kind in out.get("data", {})]


def twice(execute: Execute) -> Execute:
    """Return a version of nbclient's `async_execute_cell` that runs each short cell twice."""

    async def execute_cell(client: Any, cell: NotebookNode, *rest: Any, **options: Any) -> Any:
        done = await execute(client, cell, *rest, **options)
        if cell.cell_type != "code" or is_long(cell):
            return done
        once = shown(cell)
        done = await execute(client, cell, *rest, **options)
        if shown(cell) != once:
            raise RuntimeError(f"run again, this cell shows something else:\n{cell.source}")
        return done

    return execute_cell
