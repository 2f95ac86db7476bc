"""How long slices of arms with many joints take: all pairs of joints, at home and elsewhere.

Run with ``python engine/benchmarks/slices.py --all-forms``, or with robot files of your own behind
it. Medians and largest values of processor time, once the forms of all joints are derived; "all
forms" are the slices at home with none left out.
"""

from __future__ import annotations

import argparse
from itertools import combinations, product
from statistics import median
from time import process_time

import numpy as np

from cspace import find_region, load_robot
from cspace.model.robot import Pair, Point, Revolute, Robot
from cspace.region import Region, problem
from qbound.frames import roll_pitch_yaw

QUARTER = np.pi / 2
UR5 = [  # published kinematics: origin, roll pitch yaw, axis; balls: from, to, radius, count
    ([0, 0, 0], [0, 0, 0.04], 0.075, 2),
    ([0, 0, 0.089159], [0, 0, 0], [0, 0, 1], ([0, 0, 0], [0, 0.08, 0], 0.06, 3)),
    ([0, 0.13585, 0], [0, QUARTER, 0], [0, 1, 0], ([0, 0, 0], [0, 0, 0.425], 0.055, 10)),
    ([0, -0.1197, 0.425], [0, 0, 0], [0, 1, 0], ([0, 0, 0], [0, 0, 0.39225], 0.045, 10)),
    ([0, 0, 0.39225], [0, QUARTER, 0], [0, 1, 0], ([0, 0, 0], [0, 0.093, 0], 0.045, 4)),
    ([0, 0.093, 0], [0, 0, 0], [0, 0, 1], ([0, 0, 0], [0, 0, 0.09465], 0.045, 4)),
    ([0, 0, 0.09465], [0, 0, 0], [0, 1, 0], ([0, 0, 0], [0, 0.08, 0], 0.04, 4)),
]


def balls(frame: str, start, end, radius: float, count: int) -> list[Point]:
    steps = np.linspace(0, 1, count)[:, None]
    places = (1 - steps) * np.array(start) + steps * np.array(end)
    return [Point(f"{frame}/{k + 1}", frame, at, radius) for k, at in enumerate(places)]


def ur5() -> Robot:
    """Return a stand-in of a UR5: balls along its links, a pair for any two not on neighbours."""
    links = [balls("0", *UR5[0])]
    joints = []
    for k, (origin, rpy, axis, row) in enumerate(UR5[1:], 1):
        joints.append(
            Revolute(
                f"q{k}",
                str(k - 1),
                str(k),
                origin=np.array(origin, dtype=float),
                mount=roll_pitch_yaw(*rpy),
                axis=np.array(axis, dtype=float),
                limits=(-2 * np.pi, 2 * np.pi),
            )
        )
        links.append(balls(str(k), *row))
    pairs = [
        Pair(f"{a.name}, {b.name}", (a.name, b.name))
        for i, j in combinations(range(len(links)), 2)
        if j > i + 1
        for a, b in product(links[i], links[j])
    ]
    points = tuple(point for link in links for point in link)
    home = np.array([0, -1.2, 1.0, 0, 0, 0])
    return Robot(
        name="UR5",
        joints=tuple(joints),
        points=points,
        boundaries=tuple(pairs),
        home=home,
        tool=points[-1].name,
        length_unit="m",
        angle_unit="rad",
    )


def held_values(robot: Robot, rng: np.random.Generator):
    """Yield home, quarter turns, and values anywhere within the limits."""
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    yield robot.home
    yield np.clip(np.round(rng.uniform(-2, 2, len(ends))) * QUARTER, *ends.T)
    for _ in range(3):
        yield rng.uniform(*ends.T)


def timed(robot: Robot, held: dict[int, float]) -> tuple[float, Region]:
    start = process_time()
    region = find_region(robot, held)
    return process_time() - start, region


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robots", nargs="*", help="robot files; default: a stand-in of a UR5")
    parser.add_argument(
        "--all-forms",
        action="store_true",
        help="home's slices again with no form left out: minutes",
    )
    options = parser.parse_args()
    print("| arm | pairs | slices | median / s | largest / s | forms kept, most | all forms / s |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for robot in [load_robot(file) for file in options.robots] or [ur5()]:
        find_region(robot, dict.fromkeys(range(2, len(robot.joints)), 0.0))  # the forms, once
        rng, times, kept, whole = np.random.default_rng(0), [], [], []
        for free in combinations(range(len(robot.joints)), 2):
            for k, q in enumerate(held_values(robot, rng)):
                held = {j: float(x) for j, x in enumerate(q) if j not in free}
                took, region = timed(robot, held)
                times.append(took)
                varying = len(region.problem.names) - len(region.problem.constants)
                kept.append(varying - len(region.irrelevant))
                if k == 0 and options.all_forms:
                    problem.MANY, many = 10**9, problem.MANY
                    whole.append(timed(robot, held)[0])
                    problem.MANY = many
        sizes = f"{len(robot.used)} | {len(times)} | {median(times):.2f} | {max(times):.2f}"
        slow = f"{median(whole):.2f}, {max(whole):.1f} at most" if whole else ""
        print(f"| {robot.name} | {sizes} | {max(kept)} | {slow} |")


if __name__ == "__main__":
    main()
