"""How long margins and fibres of an arm of six joints take, and what fibres are not for.

The arm is the packaged UR5; medians of processor time. The last table has both ways to the feasible
part of joint space at equal time: points, and fibres, from a scrambled Sobol sequence.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
from scipy.stats import qmc

from cspace import load_robot
from cspace.arms.fibres import fibres
from cspace.boundary.balls import Balls
from cspace.boundary.evaluator import evaluator
from cspace.model.robot import Robot
from cspace.sampling import joint_ranges

ROUNDS, MANY, SCRAMBLES = 5, 8192, 12
REFERENCE = 2**19


def seconds(call: Callable[[], object]) -> float:
    """Median over ROUNDS of the processor time of one call."""
    call()
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return statistics.median(times)


def drawn(robot: Robot, number: int, seed: int) -> np.ndarray:
    low, high = joint_ranges(robot).T
    sobol = qmc.Sobol(len(low), rng=np.random.default_rng(seed))
    return low + (high - low) * sobol.random(number)


def speeds(robot: Robot) -> None:
    q, balls, compiled = drawn(robot, MANY, 0), Balls.of(robot), evaluator(robot)
    print("| a second | by balls | by forms |\n|---|---|---|")
    for name in ("margins", "feasible"):
        both = (
            MANY / seconds(lambda on=on, name=name: getattr(on, name)(q))
            for on in (balls, compiled)
        )
        print(f"| {name} | {' | '.join(f'{x:.0f}' for x in both)} |")
    print("\n| joint | fibres a second | intervals a fibre |\n|---|---|---|")
    for j, joint in enumerate(robot.joints):
        rate = MANY / seconds(lambda j=j: fibres(robot, j, q))
        print(f"| {joint.name} | {rate:.0f} | {len(fibres(robot, j, q).low) / MANY:.2f} |")


def integrators(robot: Robot) -> None:
    """Compare root mean square errors of the feasible part; the reference has far more points."""
    balls = Balls.of(robot)
    truth = balls.feasible(drawn(robot, REFERENCE, 10**6)).mean()
    print(f"\nfeasible part {truth:.5f}\n\n| by | number | ms | error |\n|---|---|---|---|")
    for number in (2**12, 2**14):
        points = [balls.feasible(drawn(robot, 4 * number, s)).mean() for s in range(SCRAMBLES)]
        cost = seconds(lambda number=number: balls.feasible(drawn(robot, 4 * number, 0)))
        row("points", 4 * number, cost, points, truth)
        for j in (1, 2):
            span = np.ptp(joint_ranges(robot)[j])
            some = [fibres(robot, j, drawn(robot, number, s)) for s in range(SCRAMBLES)]
            cost = seconds(lambda number=number, j=j: fibres(robot, j, drawn(robot, number, 0)))
            name = f"fibres along {robot.joints[j].name}"
            row(name, number, cost, [f.length.mean() / span for f in some], truth)


def row(name: str, number: int, cost: float, found: list[float], truth: float) -> None:
    error = np.sqrt(np.mean((np.array(found) - truth) ** 2))
    print(f"| {name} | {number} | {1e3 * cost:.0f} | {error:.1e} |")


if __name__ == "__main__":
    arm = load_robot("ur5")
    speeds(arm)
    integrators(arm)
