"""For pytest, in the run that executes the chapters: each gets a folder of its own.

It holds the results that the chapter writes and, in ``reads``, what its process read.
"""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Name the folder to the kernel that this chapter is going to start."""
    folder = Path(os.environ["QBOUND_MADE"], item.path.stem)
    folder.mkdir(parents=True)
    os.environ["QBOUND_RESULTS"] = str(folder)
    os.environ["QBOUND_READS"] = str(folder / "reads")
    return (yield)
