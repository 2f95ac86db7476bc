"""How long the region of an arm among obstacles takes, and how it grows with their number.

Run with ``python engine/benchmarks/bodies.py``. Medians of processor time in one run, from the
robot to components, arcs and areas: the packaged scene on a table, and two links among random
convex obstacles, both joints as the base of the cells.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from math import log
from statistics import median

import numpy as np
from regions import milliseconds

from cspace import find_region, load_robot
from cspace.model.robot import Body, Disc, Polygon, Robot
from cspace.region import clearance_problem, solve

COUNTS = (5, 10, 30, 100, 300)


def among(count: int, seed: int) -> Robot:
    """Return the packaged two links among random discs and polygons of some 0.1 m."""
    arm, rng = load_robot("two-links-on-a-table"), np.random.default_rng([seed, count])
    blocks = []
    for i in range(count):
        angle, far = rng.uniform(0, 2 * np.pi), rng.uniform(0.3, 1.0)
        place = far * np.array([np.cos(angle), np.sin(angle), 0.0])
        turns = np.sort(rng.uniform(0, 2 * np.pi, 5))
        round_it = np.stack([np.cos(turns), np.sin(turns), np.zeros(5)], axis=1)
        disc = Disc(place, rng.uniform(0.02, 0.06))
        shape = disc if rng.random() < 0.5 else Polygon(place + rng.uniform(0.03, 0.1) * round_it)
        blocks.append(Body(f"obstacle {i}", arm.base, shape))
    return replace(arm, obstacles=tuple(blocks))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=7)
    repeats = parser.parse_args().repeats
    table = load_robot("two-links-on-a-table")
    print("| obstacles | base q1 / ms | base q2 / ms | growth |\n| --- | --- | --- | --- |")
    print(f"| those on the table | {milliseconds(lambda: find_region(table), repeats):.0f} | | |")
    before: tuple[int, float] | None = None
    for count in COUNTS:
        robots = [among(count, seed) for seed in range(5)]
        one, other = (
            median(
                milliseconds(lambda r=robot, b=base: solve(clearance_problem(r), base=b), repeats)
                for robot in robots
            )
            for base in (0, 1)
        )
        growth = f"n^{log(one / before[1]) / log(count / before[0]):.1f}" if before else ""
        print(f"| {count}, median of 5 | {one:.0f} | {other:.0f} | {growth} |")
        before = count, one


if __name__ == "__main__":
    main()
