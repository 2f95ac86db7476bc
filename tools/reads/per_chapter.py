"""For pytest, in the run that executes the chapters: each gets a folder of its own.

It holds the results that the chapter writes, in ``reads`` what its process read, and ``ran`` when
all is done and written. If ``run.py`` is killed, this run ends too. With ``QBOUND_TWICE=1`` each
cell runs twice, so that a cell that depends on its own earlier run is found.
"""

import os
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import twice
from nbclient import NotebookClient


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Name the folder to the kernel that this chapter is going to start."""
    folder = Path(os.environ["QBOUND_MADE"], item.path.stem)
    folder.mkdir(parents=True)
    os.environ["QBOUND_RESULTS"] = str(folder)
    os.environ["QBOUND_READS"] = str(folder / "reads")
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Mark a chapter that has run to its end; what it became is written by then."""
    yield
    Path(os.environ["QBOUND_MADE"], item.path.stem, "ran").touch()


def is_run_twice() -> bool:
    """Tell whether the cells run twice."""
    return os.environ.get("QBOUND_TWICE") == "1"


def pytest_configure() -> None:
    """Watch the process that started this one: run.py, or for a worker the run; kernels do so."""
    execute = NotebookClient.async_execute_cell
    NotebookClient.async_execute_cell = twice.twice(execute, is_run_twice)
    threading.Thread(target=end_with, args=[os.getppid()], daemon=True).start()


def end_with(parent: int) -> None:
    """End this process as soon as it has another parent."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)
