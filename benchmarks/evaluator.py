"""How long boundary functions take: one configuration, and a million; medians of one run.

The naive way, one form after the other, is measured beside it in the same run.
"""

import statistics
import time
from collections.abc import Callable

import numpy as np

from qbound import clearance, load_robot
from qbound.boundary.evaluator import evaluator

ROBOTS = ("minervabot-v2", "two-joint-arm-with-walls", "rp-telescopic-boom")
ROUNDS = 9


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


def main() -> None:
    print(
        "| robot | one / us | a million / ms | form by form / ms | ratio |\n|---|---|---|---|---|"
    )
    for name in ROBOTS:
        robot = load_robot(name)
        compiled, used = evaluator(robot), [b for b in robot.boundaries if b.used]
        low, high = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints]).T
        many = np.random.default_rng(0).uniform(low, high, (1_000_000, len(robot.joints)))

        def one_by_one(robot=robot, used=used, many=many) -> object:
            return np.all([clearance(robot, b)(many) >= 0 for b in used], axis=0)

        one = median_time(lambda: compiled.margins(many[0]), 5000)  # noqa: B023
        million = median_time(lambda: compiled.feasible(many), 1)  # noqa: B023
        naive = median_time(one_by_one, 1)
        ratio = naive / million
        print(
            f"| {name} | {1e6 * one:.1f} | {1e3 * million:.0f} | {1e3 * naive:.0f} | {ratio:.1f} |"
        )


if __name__ == "__main__":
    main()
