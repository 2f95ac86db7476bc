"""A closed form in NumPy for a planar arm of any number of joints: judged, and on a full grid."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
from planar import Floats, arm
from serve import Refused, Timed, serve, timed
from streams import Judge, stream_tasks

MOST = 1e8
"""Configurations, at most: with more it takes over 20 s."""


def judge(scene: str) -> Judge:
    """Return what judges configurations, shape (n, joints)."""
    form = arm(scene)
    return lambda q: form.of(np.ascontiguousarray(q.T)) >= 0


def part(scene: str, step: float) -> Timed:
    """Answer with the feasible part of joint space, by the middles of a grid's cells."""
    form = arm(scene)
    counts = [math.ceil(np.ptp(ends) / step) for ends in form.ranges]
    if math.prod(counts) > MOST:
        raise Refused(f"{math.prod(counts):.2g} configurations are more than {MOST:.0e}")
    axes = [middles(ends, n) for ends, n in zip(form.ranges, counts, strict=True)]

    def work() -> Any:
        return sum(int((form.margin(q) >= 0).sum()) for q in rows(axes)) / math.prod(counts)

    seconds, processor, found = timed(work)
    return seconds, processor, {"configurations": math.prod(counts), "part": found}


def middles(ends: Floats, count: int) -> Floats:
    """Return the middles of equal parts of a range."""
    low, high = ends
    return np.asarray(low + (np.arange(count) + 0.5) * (high - low) / count)


def rows(axes: list[Floats]) -> Iterator[list[Floats]]:
    """Yield the grid so that three joints at most run at once, as arrays that broadcast."""
    outer, inner = axes[:-3], axes[-3:]
    n = len(inner)
    spread = [axis.reshape([-1 if i == k else 1 for i in range(n)]) for k, axis in enumerate(inner)]
    for held in product(*outer):
        yield [*(np.full([1] * n, value) for value in held), *spread]


if __name__ == "__main__":
    tasks = {"part": part, **stream_tasks(judge, judge)}
    serve("closed form of a planar arm, NumPy", {"numpy": "numpy"}, tasks)
