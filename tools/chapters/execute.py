"""Execute a copy of a chapter where it is: python tools/chapters/execute.py COPY.ipynb.

Its kernel records results in the folder that ``QBOUND_RESULTS`` names. With ``QBOUND_TWICE=1`` each
short cell runs twice: a cell that depends on its own earlier run is found. If the process that
started this one is killed, this one ends too, as kernels do.
"""

import os
import signal
import sys
import threading
import time
from pathlib import Path

import nbformat
import twice
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError

MINUTES = 15  # for a cell


def is_run_twice() -> bool:
    return os.environ.get("QBOUND_TWICE") == "1"


def end_with(parent: int) -> None:
    """End this process as soon as its parent has ended."""
    while os.getppid() == parent:
        time.sleep(0.5)
    os._exit(1)


def main(copy: Path) -> int:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C: the one who started this says so
    threading.Thread(target=end_with, args=[os.getppid()], daemon=True).start()
    NotebookClient.async_execute_cell = twice.twice(NotebookClient.async_execute_cell, is_run_twice)
    notebook = nbformat.read(copy, as_version=4)
    settings = {
        "timeout": 60 * MINUTES,
        "extra_arguments": ["--log-level=40"],  # it warns that it talks to itself over TCP
        "resources": {"metadata": {"path": str(copy.parent)}},
    }
    try:
        NotebookClient(notebook, **settings).execute()
    except (CellExecutionError, CellTimeoutError, RuntimeError) as error:
        print(f"{copy.name}: {error}", file=sys.stderr)
        return 1
    code = [cell for cell in notebook.cells if cell.cell_type == "code" and cell.source.strip()]
    if any(cell.execution_count is None for cell in code):
        print(f"{copy.name}: cells did not run.", file=sys.stderr)
        return 1
    nbformat.write(notebook, copy)
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
