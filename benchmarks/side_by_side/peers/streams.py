"""The two tasks of whoever judges configurations: many at once, and one at a time."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import scenes
from packing import bits
from serve import Task, Timed, timed

Judge = Callable[[np.ndarray], Any]


def stream_tasks(
    many: Callable[[str], Judge] | None, one: Callable[[str], Judge] | None
) -> dict[str, Task]:
    """Return the tasks "stream" and "one" of a peer.

    Parameters
    ----------
    many : callable, optional
        From a scene's name to what judges configurations, shape (n, joints) to n booleans.
    one : callable, optional
        From a scene's name to what judges one configuration, shape (joints,).
    """
    tasks: dict[str, Task] = {}
    if many is not None:
        tasks["stream"] = _many(lru_cache(maxsize=8)(many))
    if one is not None:
        tasks["one"] = _one(lru_cache(maxsize=8)(one))
    return tasks


@lru_cache(maxsize=1)
def drawn(scene: str, count: int, seed: int) -> np.ndarray:
    return scenes.configurations(scene, count, seed)


def _many(make: Callable[[str], Judge]) -> Task:
    def stream(scene: str, count: int, seed: int) -> Timed:
        judge, q = make(scene), drawn(scene, count, seed)
        judge(q[:100])  # what is compiled or allocated at the first call
        q.sum()  # memory that the system has put aside between rounds comes back
        seconds, processor, free = timed(lambda: judge(q))
        return seconds, processor, {"count": count, "bits": bits(free)}

    return stream


def _one(make: Callable[[str], Judge]) -> Task:
    def one(scene: str, count: int, seed: int) -> Timed:
        judge, rows = make(scene), list(drawn(scene, count, seed))
        judge(rows[0])
        seconds, processor, free = timed(lambda: [judge(row) for row in rows])
        return seconds, processor, {"count": count, "bits": bits(free)}

    return one
