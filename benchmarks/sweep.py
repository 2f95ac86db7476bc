"""How much faster are two workers than one? One sweep, alternating, medians by the clock.

Each round has a folder of its own, so that everything is computed. Starting and stopping the
scheduler is part of it; a sweep of one arm tells how much that is. Nothing else should run.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path

from qbound.sweeps import sweep

ROUNDS = 3
SPECIFICATION = """
schema = 1
robot = "minervabot-v2"
measure = ["region.area", "workspace.area"]
vary = [
    {{ number = "joint.q2.origin.0", from = 10, to = {0}, count = {1} }},
    {{ number = "boundary.B1.clearance", from = 0, to = {2}, count = {1} }},
]
"""
SWEEPS = {"1 arm": (10, 1, 0), "400 arms": (20, 20, 2)}


def seconds(specification: Path, workers: int) -> float:
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        found = sweep(specification, Path(folder) / "out", workers=workers)
        taken = time.perf_counter() - start
    if not found.whole:
        raise SystemExit("an arm has no value")
    return taken


def main() -> None:
    print("| sweep | 1 worker / s | 2 workers / s | ratio |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for name, numbers in SWEEPS.items():
            specification = Path(folder) / "sweep.toml"
            specification.write_text(SPECIFICATION.format(*numbers), encoding="utf-8")
            rounds = [[seconds(specification, k) for k in (1, 2)] for _ in range(ROUNDS)]
            one, two = (statistics.median(each) for each in zip(*rounds, strict=True))
            print(f"| {name} | {one:.1f} | {two:.1f} | {one / two:.2f} |")


if __name__ == "__main__":
    main()
