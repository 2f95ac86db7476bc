"""Compare regions of arms among obstacles with shapely, configuration by configuration.

`python benchmarks/scenes.py --scenes 1000 --configurations 100000`: half of the scenes at random,
half in whole numbers, of all four kinds of joints. Where neighbours among the first tenth of the
configurations lie on two sides of a boundary, both are moved up to it by bisection. The suite has
30 such scenes.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from qbound.region import find_region
from support import scenes


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--configurations", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first scene")
    options = parser.parse_args()
    wrong, told, near = list[str](), 0, 0
    start = time.process_time()
    for number in range(options.first, options.first + options.scenes):
        make = scenes.drawn_scene if number % 2 else scenes.random_scene
        robot = make(number // 2)
        region = find_region(robot)
        q = scenes.configurations(robot, options.configurations, number)
        both = scenes.near_the_boundary(robot, q[: options.configurations // 10])
        found = scenes.wrongly_told(robot, region, np.concatenate([q, both]))
        touching = int(scenes.touching_in_cells(robot, region, q).sum())
        told, near = told + len(q) + len(both), near + len(both)
        if len(found) or touching:
            wrong.append(f"{robot.name}: {len(found)} wrong, {touching} touching")
            print(wrong[-1], found[:1].tolist(), flush=True)
    print(f"{options.scenes} scenes, {told} configurations, {near} of them beside the boundary")
    print(f"{len(wrong)} scenes wrong; {time.process_time() - start:.0f} s of processor time")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
