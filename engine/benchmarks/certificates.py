"""How long a proof takes, and its check: boxes about home of an arm of six joints.

Run with ``python engine/benchmarks/certificates.py``. Wall time of one run each; the arm and its
boxes are those of the tests.
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

sys.path.append(str(Path(__file__).parents[1] / "tests"))

from cspace import check
from cspace.model.robotfile import parse_robot
from cspace.proofs.certificates import search as safe
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.certify import certify
from engine_support.six_joints import around_home, six_joint_arm
from test_boxes import least_margins

LEFT = (None, 0.01, 0.001)
"""Metres that every boundary keeps beyond what the box needs; None: the arm as it is."""


def arm(half: int, left: float | None) -> str:
    """Return the arm, each boundary moved so near that only `left` remains in the box."""
    if left is None:
        return six_joint_arm()
    robot = parse_robot(tomllib.loads(six_joint_arm()))
    least = least_margins(robot, *around_home(half), seed=half)
    return six_joint_arm({name: margin - left for name, margin in least.items()})


def seconds(task: Callable[[], Any]) -> tuple[float, Any]:
    start = perf_counter()
    answer = task()
    return perf_counter() - start, answer


def longest_edges(text: str, statement: dict[str, Any]) -> int:
    """Return the cells that halving the longest edge takes."""
    ours = safe._Judge._cuts
    safe._Judge._cuts = lambda self, kind, rows, cells, seen: cells.halfwidths.argmax(axis=1)  # type: ignore[method-assign]
    try:
        return certify(text, statement, most=100_000).leaves
    finally:
        safe._Judge._cuts = ours  # type: ignore[method-assign]


def main() -> None:
    columns = "box / deg, left / m, answer, cells, longest edge, proof / s, check.py / s"
    print("|", columns.replace(",", " |"), "|")
    print("|" + " --- |" * len(columns.split(",")))
    for half in (5, 20):
        for left in LEFT:
            text, statement = arm(half, left), statements.box(*around_home(half))
            proving, answer = seconds(lambda: certify(text, statement))  # noqa: B023
            checking, _ = seconds(lambda: check.check(answer.text))  # noqa: B023
            row = (f"+-{half}", left or "as it is", answer.verdict, answer.leaves)
            times = (f"{x:.2f}" for x in (proving, checking))
            print("|", " | ".join(map(str, (*row, longest_edges(text, statement), *times))), "|")


if __name__ == "__main__":
    main()
