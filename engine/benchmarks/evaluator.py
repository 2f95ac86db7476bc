"""How long boundary functions take: one configuration, and many; medians of one run.

The naive way, one form after the other, is measured beside it in the same run, and machine code
where Numba is installed. Against other programs, on the same scenes: `side_by_side`.
"""

import statistics
import time
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec

import numpy as np

from cspace import clearance, load_robot
from cspace.boundary.compiled import compiled_feasible
from cspace.boundary.evaluator import evaluator
from cspace.model.robot import Robot

ROBOTS = ("minervabot-v2", "two-joint-arm-with-walls", "rp-telescopic-boom", "ur5")
ROUNDS = 9
MANY = 1_000_000
MANY_OF_ARMS = 100_000
NAIVE = 100_000
NAIVE_OF_ARMS = 200
"""Configurations that the naive way is given: a form of six joints is a table of 729 numbers."""


def median_time(call: Callable[[], object], repeat: int) -> float:
    """Median over ROUNDS of the processor time of one call, seconds."""
    call()
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        for _ in range(repeat):
            call()
        times.append((time.process_time() - start) / repeat)
    return statistics.median(times)


def ways(robot: Robot) -> dict[str, Callable[[np.ndarray], object]]:
    """Return what tells where a robot keeps clear, by name; machine code where Numba is."""
    found: dict[str, Callable[[np.ndarray], object]] = {"NumPy": evaluator(robot).feasible}
    if find_spec("numba") is not None:
        found["machine code"] = compiled_feasible(robot)
        found["two threads"] = compiled_feasible(robot, threads=2)
    return found


def measured(robot: Robot) -> dict[str, float]:
    """Return processor times of a robot: each way with one configuration (s) and many (s each)."""
    joints, used = len(robot.joints), [b for b in robot.boundaries if b.used]
    low, high = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints]).T
    count = MANY if joints < 3 else MANY_OF_ARMS
    many = np.random.default_rng(0).uniform(low, high, (count, joints))
    rows = list(many[:1000])
    times = {"margins, one": median_time(lambda: [*map(evaluator(robot).margins, rows)], 1) / 1000}
    for name, feasible in ways(robot).items():
        if name != "two threads":
            times[f"{name}, one"] = median_time(lambda f=feasible: [*map(f, rows)], 1) / 1000
        times[f"{name}, many"] = median_time(partial(feasible, many), 1) / count
    few = many[: NAIVE if joints < 3 else NAIVE_OF_ARMS]
    forms = [partial(clearance(robot, b), few) for b in used]
    naive = median_time(lambda: np.all([form() >= 0 for form in forms], axis=0), 1)
    return times | {"form by form, many": naive / len(few)}


def main() -> None:
    columns: list[str] = []
    for name in ROBOTS:
        times = measured(load_robot(name))
        if not columns:
            columns = list(times)
            units = [f"{c} / {'us' if c.endswith('one') else 'ns'}" for c in columns]
            print("| robot |", " | ".join(units), "|\n|", "---|" * (1 + len(columns)))
        found = [times[c] * (1e6 if c.endswith("one") else 1e9) for c in columns]
        print(f"| {name} |", " | ".join(f"{x:.3g}" for x in found), "|", flush=True)


if __name__ == "__main__":
    main()
