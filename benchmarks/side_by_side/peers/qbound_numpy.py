"""Our own: configurations judged by the evaluator in NumPy."""

from __future__ import annotations

import scenes
from serve import serve
from streams import Judge, stream_tasks

from qbound.boundary.balls import Balls
from qbound.boundary.evaluator import evaluator

MANY_JOINTS = 4


def feasible(scene: str) -> Judge:
    """Return what judges configurations: by forms, or by balls where a form is a large table."""
    robot = scenes.robot(scene)
    if len(robot.joints) >= MANY_JOINTS:
        return Balls.of(robot).feasible
    return evaluator(robot).feasible


if __name__ == "__main__":
    serve("qbound, NumPy", {"numpy": "numpy"}, stream_tasks(feasible, feasible))
