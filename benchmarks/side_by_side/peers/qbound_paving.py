"""Our own certified pavings."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import scenes
from serve import Timed, serve, timed

from qbound.proofs.exact.problem import exact_problem, exact_robot
from qbound.proofs.subpaving.paving import pave


@lru_cache(maxsize=8)
def prepared(scene: str) -> Any:
    """Return the exact problem of a scene."""
    return exact_problem(exact_robot(scenes.robot(scene)))


def paving(scene: str, undecided: float, eps: float = 0) -> Timed:
    """Halve boxes until at most a part of the box of joints is undecided."""
    problem = prepared(scene)
    wall, processor, found = timed(lambda: pave(problem, undecided))
    answer = {
        "undecided": float(found.undecided_fraction),
        "inner": float(found.inner_fraction),
        "boxes": found.cells,
        "enough": found.undecided_fraction <= undecided,
    }
    return wall, processor, answer


if __name__ == "__main__":
    needs = {"numpy": "numpy", "flint": "python-flint"}
    serve("qbound, paving", needs, {"paving": paving})
