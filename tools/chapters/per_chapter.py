"""For pytest, in the run in which nbmake executes a copy of a chapter.

With ``QBOUND_TWICE=1`` each short cell runs twice: a cell that depends on its own earlier run is
found. If the process that started this one is killed, this one ends too, as kernels do.
"""

import os
import signal
import threading
import time

import twice
from nbclient import NotebookClient


def is_run_twice() -> bool:
    return os.environ.get("QBOUND_TWICE") == "1"


def end_with(parent: int) -> None:
    """End this process as soon as its parent has ended."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


def pytest_configure() -> None:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C: the one who started this says so
    threading.Thread(target=end_with, args=[os.getppid()], daemon=True).start()
    execute = NotebookClient.async_execute_cell
    NotebookClient.async_execute_cell = twice.twice(execute, is_run_twice)
