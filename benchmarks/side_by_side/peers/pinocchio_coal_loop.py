"""Pinocchio with coal in a loop of Python, as most scripts call it."""

from __future__ import annotations

import numpy as np
from pinocchio_coal import one
from serve import serve
from streams import Judge, stream_tasks


def loop(scene: str) -> Judge:
    """Return what judges a batch one by one."""
    judge = one(scene)
    return lambda q: np.fromiter((judge(row) for row in q), dtype=bool, count=len(q))


if __name__ == "__main__":
    needs = {"pinocchio": "pin", "coal": "coal"}
    serve("pinocchio + coal, loop in Python", needs, stream_tasks(loop, None))
