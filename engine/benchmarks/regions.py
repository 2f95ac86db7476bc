"""How long a region takes: the paper's robot from its file, and robots with many boundaries.

Run with ``python engine/benchmarks/regions.py``. Medians of processor time in one run, each beside
that of judging one grid of the same joint space: machines differ, ratios less so. Then how long a
command takes from the shell, beside NumPy alone: processor time of a process of its own.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
from collections.abc import Callable
from itertools import cycle, islice, product
from math import log
from statistics import median
from time import process_time

import numpy as np

from cspace import find_region, load_robot
from cspace.model.robot import HalfSpace, Pair, Point, Revolute, Robot
from cspace.sampling import keeps_clear

COUNTS = (10, 30, 100, 300)

COMMANDS = {
    "`import numpy`": ["-c", "import numpy"],
    "`import cspace`": ["-c", "import cspace"],
    "`cspace contains minervabot-v2 20deg -45deg`": (
        ["-m", "cspace", "contains", "minervabot-v2", "20deg", "-45deg"]
    ),
}

GRID = 1000
"""Places a side of the grid: its cells are 0.36 degrees wide."""


def many_boundaries(count: int, seed: int) -> Robot:
    """Return a planar arm of two free joints with `count` pairs and walls at random places."""
    rng = np.random.default_rng(seed)
    axis, mount = np.array([0.0, 1.0, 0.0]), np.eye(3)
    joints = (
        Revolute("q1", "0", "1", origin=np.array([0.0, 0.0, 1.0]), mount=mount, axis=axis),
        Revolute("q2", "1", "2", origin=np.array([1.0, 0.0, 0.3]), mount=mount, axis=axis),
    )
    places = rng.uniform(-1, 1.3, (3, count, 2))
    points = tuple(
        Point(f"{frame}.{i}", str(frame), np.array([places[frame, i, 0], 0, places[frame, i, 1]]))
        for frame, i in product(range(3), range(count))
    )
    kinds = islice(cycle([("0", "1"), ("1", "2"), None]), count)
    boundaries = [
        Pair(f"B{i}", (f"{pair[0]}.{i}", f"{pair[1]}.{i}"), 0.12) if pair else wall(i, rng)
        for i, pair in enumerate(kinds)
    ]
    return Robot(
        name="many",
        joints=joints,
        points=points,
        boundaries=tuple(boundaries),
        home=np.zeros(2),
        tool="2.0",
        length_unit="m",
        angle_unit="rad",
    )


def wall(i: int, rng: np.random.Generator) -> HalfSpace:
    angle = rng.uniform(0, 2 * np.pi)
    return HalfSpace(f"B{i}", f"2.{i}", np.array([np.cos(angle), 0, np.sin(angle)]), -2.0)


def milliseconds(task: Callable[[], object], repeats: int) -> float:
    task()  # warm
    times = []
    for _ in range(repeats):
        start = process_time()
        task()
        times.append(process_time() - start)
    return 1e3 * median(times)


def grid_of(robot: Robot) -> Callable[[], object]:
    x = np.linspace(-np.pi, np.pi, GRID)
    q = np.stack(np.meshgrid(x, x), axis=-1).reshape(-1, 2)
    return lambda: keeps_clear(robot, q)


def started(words: list[str], repeats: int) -> float:
    """Return the median processor time of a Python process of its own, ms."""
    times = []
    for _ in range(repeats + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *words], check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return 1e3 * median(times[1:])  # the first may compile


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=21)
    repeats = parser.parse_args().repeats
    paper = load_robot("minervabot-v2")
    print(f"| task | median / ms | of a grid of {GRID} x {GRID} |\n| --- | --- | --- |")
    others = iter([load_robot("minervabot-v2") for _ in range(repeats + 1)])
    grid = milliseconds(grid_of(paper), max(3, repeats // 7))
    for name, task in {
        "read the paper's robot": lambda: load_robot("minervabot-v2"),
        "its regions": lambda: find_region(paper),
        "its regions, of a robot not seen before": lambda: find_region(next(others)),
        "both, from file to components, arcs, area and centroid": lambda: find_region(
            load_robot("minervabot-v2")
        ),
    }.items():
        took = milliseconds(task, repeats)
        print(f"| {name} | {took:.2f} | {took / grid:.4f} |")
    before: tuple[int, float] | None = None
    for count in COUNTS:
        robots = [many_boundaries(count, seed) for seed in range(5)]
        took = median(milliseconds(lambda r=robot: find_region(r), 3) for robot in robots)
        grid = milliseconds(grid_of(robots[0]), 1)
        growth = f", k^{log(took / before[1]) / log(count / before[0]):.1f}" if before else ""
        name = f"k = {count} boundaries, median of {len(robots)} robots{growth}"
        print(f"| {name} | {took:.2f} | {took / grid:.4f} |")
        before = count, took
    print("\n| from the shell | median / ms | of NumPy alone |\n| --- | --- | --- |")
    alone = started(COMMANDS["`import numpy`"], repeats)
    for name, words in COMMANDS.items():
        took = started(words, repeats)
        print(f"| {name} | {took:.0f} | {took / alone:.2f} |")


if __name__ == "__main__":
    main()
