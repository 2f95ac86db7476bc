"""For pytest, in the run that executes the chapters: each has a folder of its own.

It holds the executed copy and the results that the chapter writes; the mark that ``run.py`` has
put there gets its name once all is done and written. If ``run.py`` is killed, this run ends too.
With ``QBOUND_TWICE=1`` each cell runs twice: a cell that depends on its own earlier run is found.
"""

import os
import threading
import time
from collections.abc import Iterator

import pytest
import twice
from nbclient import NotebookClient


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Tell the kernel of this chapter which folder to write results to."""
    os.environ["QBOUND_RESULTS"] = str(item.path.parent)
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Mark a chapter that has run to its end; its executed copy is written by then."""
    yield
    item.path.with_name("made-from.part").rename(item.path.with_name("made-from"))


def is_run_twice() -> bool:
    """Tell whether the cells run twice."""
    return os.environ.get("QBOUND_TWICE") == "1"


def pytest_configure() -> None:
    """Watch the process that started this one (run.py, or pytest for a worker), as kernels do."""
    execute = NotebookClient.async_execute_cell
    NotebookClient.async_execute_cell = twice.twice(execute, is_run_twice)
    threading.Thread(target=end_with, args=[os.getppid()], daemon=True).start()


def end_with(parent: int) -> None:
    """End this process as soon as its parent has ended."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)
