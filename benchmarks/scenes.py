"""Compare regions of arms among obstacles with shapely, configuration by configuration.

`python benchmarks/scenes.py --scenes 1000 --configurations 100000`: half of the scenes at random,
half in whole numbers, of all four kinds of joints. Where neighbours among the first tenth of the
configurations lie on two sides of a boundary, both are moved up to it by bisection. With either
joint as the base of the cells the region is the same; `--one-base` looks at the usual one alone.
The suite has 30 such scenes.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from qbound.model.robot import Robot
from qbound.region.region import Region, clearance_problem, solve
from support import scenes

SAME_AREA = 1e-9
"""Areas that two bases find may come apart by this."""


def regions_of(robot: Robot, bases: Sequence[int | None]) -> list[Region]:
    """Find the region with each of some joints as the base of the cells."""
    problem = clearance_problem(robot)
    return [solve(problem, base=base) for base in bases]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--configurations", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    parser.add_argument("--one-base", action="store_true")
    options = parser.parse_args()
    wrong, told, near = list[str](), 0, 0
    start = time.process_time()
    for number in range(options.first, options.first + options.scenes):
        make = scenes.drawn_scene if number % 2 else scenes.random_scene
        robot = make(number // 2)
        regions = regions_of(robot, (None,) if options.one_base else (0, 1))
        q = scenes.configurations(robot, options.configurations, number)
        both = scenes.near_the_boundary(robot, q[: options.configurations // 10])
        every = np.concatenate([q, both])
        hit = scenes.hits(robot, every)
        found = [scenes.wrongly_told(robot, region, every, hit=hit) for region in regions]
        touching = [int(scenes.touching_in_cells(robot, region, q).sum()) for region in regions]
        told, near = told + len(q) + len(both), near + len(both)
        apart = float(np.ptp([region.area for region in regions]))
        if any(map(len, found)) or any(touching) or apart > SAME_AREA:
            counts = [len(rows) for rows in found]
            wrong.append(
                f"{robot.name}: {counts} wrong, {touching} touching, areas {apart:.2g} apart"
            )
            print(wrong[-1], np.concatenate(found)[:1].tolist(), flush=True)
    print(f"{options.scenes} scenes, {told} configurations, {near} of them beside the boundary")
    print(f"{len(wrong)} scenes wrong; {time.process_time() - start:.0f} s of processor time")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
