"""A line that tells how far long work is: on a terminal, to standard error, and nowhere else."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

EVERY = 0.2  # seconds


def progress(what: str, total: int) -> Callable[[int], None]:
    """Return a function to be told how much is done."""
    start = last = time.monotonic()

    def tell(done: int) -> None:
        nonlocal last
        now = time.monotonic()
        if not sys.stderr.isatty() or (now - last < EVERY and done < total) or now - start < EVERY:
            return
        last = now
        end = "\r\033[K" if done >= total else ""
        print(f"\r{what}: {100 * done // total} %{end}", end="", file=sys.stderr, flush=True)

    return tell
