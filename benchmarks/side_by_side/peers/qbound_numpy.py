"""Our own: configurations judged by the evaluator in NumPy."""

from __future__ import annotations

import scenes
from serve import serve
from streams import Judge, stream_tasks

from qbound.boundary.evaluator import evaluator


def feasible(scene: str) -> Judge:
    """Return what judges configurations, one or many."""
    return evaluator(scenes.robot(scene)).feasible


if __name__ == "__main__":
    serve("qbound, NumPy", {"numpy": "numpy"}, stream_tasks(feasible, feasible))
