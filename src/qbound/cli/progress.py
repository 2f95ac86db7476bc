"""A line that tells how far long work is: on a terminal, to standard error, and nowhere else.

Every command has one after two seconds (`waiting`); work that can tell more shows its own.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from qbound.cli.terminal import BLANK_LINE, is_terminal
from qbound.printable import printable

EVERY = 0.2  # seconds

PATIENCE = 10
"""Times `EVERY` after which a command that has shown nothing shows how long it has taken."""

_shown = {"when": 0.0}
"""When a line was shown last."""


def progress(what: str, total: int) -> Callable[[int], None]:
    """Return a function to be told how much is done."""
    start = last = time.monotonic()

    def tell(done: int) -> None:
        nonlocal last
        now = time.monotonic()
        if not is_terminal() or (now - last < EVERY and done < total) or now - start < EVERY:
            return
        last = now
        _show("" if done >= total else f"{what}: {100 * done // total} %")

    return tell


@contextmanager
def working(what: str) -> Iterator[None]:
    """Show how long work has taken that cannot tell how far it is; Ctrl-C ends it as ever."""
    with _ticking(what, lambda now, start: True):
        yield


@contextmanager
def waiting(what: str) -> Iterator[None]:
    """Show how long a command has taken, while nothing else is shown."""

    def silent(now: float, start: float) -> bool:
        return now - max(start, _shown["when"]) > PATIENCE * EVERY

    with _ticking(what, silent):
        yield


@contextmanager
def _ticking(what: str, shows: Callable[[float, float], bool]) -> Iterator[None]:
    if not is_terminal():
        yield
        return
    import threading

    over, start = threading.Event(), time.monotonic()

    def tick() -> None:
        while not over.wait(5 * EVERY):
            now = time.monotonic()
            if shows(now, start):
                _show(f"{what}: {now - start:.0f} s")

    ticker = threading.Thread(target=tick, daemon=True)
    ticker.start()
    try:
        yield
    finally:
        over.set()
        ticker.join()
        if _shown["when"] > start:
            _show("")


def _show(text: str) -> None:
    _shown["when"] = time.monotonic()
    print(f"{BLANK_LINE}{printable(text)}", end="", file=sys.stderr, flush=True)
