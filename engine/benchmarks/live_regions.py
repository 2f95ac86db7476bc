"""Compare the regions that the page finds among obstacles with the library's, by the thousand.

`python engine/benchmarks/live_regions.py --scenes 10000`: every third scene has a slit, down to
1e-6 rad wide (`engine/tests/engine_support/live_scenes.py`). Equal are scenes with as many regions,
each as large to 0.1 % of all poses. Others are printed with their seeds; `--only SEED` repeats one.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from multiprocessing import Pool
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from cspace.region import UnresolvedError
from engine_support.live_scenes import (
    Scene,
    page,
    random_scene,
    scene_with_slit,
    shares_in_library,
    shares_in_page,
)  # fmt: skip

PROCESSES = 2
LARGEST = 1e-3
"""Difference of two regions that are called equal, as a share of all poses."""

Row = tuple[int, str, float]


def compare(seed: int) -> Row:
    """Return a scene's seed, what was found, and the largest difference of two regions."""
    scene = scene_of(seed)
    try:
        expected = shares_in_library(scene)
    except UnresolvedError:
        return seed, "not resolved by the library", 0.0
    found = shares_in_page(page(), scene)
    if len(found) != len(expected):
        return seed, f"page {found}, library {expected}", 0.0
    apart = max(np.abs(np.subtract(found, expected)), default=0.0)
    return seed, "equal" if apart <= LARGEST else "another area", float(apart)


def scene_of(seed: int) -> Scene:
    """Return the scene with a seed: every third one has a slit."""
    rng = np.random.default_rng([40, seed])
    return scene_with_slit(rng, page()) if seed % 3 == 0 else random_scene(rng)


def main() -> None:
    """Compare as many scenes as are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--only", type=int)
    given = parser.parse_args()
    if given.only is not None:
        print(json.dumps(scene_of(given.only)))
        print(compare(given.only))
        return
    verdicts: Counter[str] = Counter()
    largest = 0.0
    with Pool(PROCESSES) as pool:
        seeds = range(given.first, given.first + given.scenes)
        for seed, verdict, apart in pool.imap_unordered(compare, seeds, chunksize=10):
            largest = max(largest, apart)
            verdicts[verdict if verdict == "equal" else "other"] += 1
            if verdict != "equal":
                print(f"scene {seed}: {verdict}", flush=True)
            if verdicts.total() % 500 == 0:
                print(f"{dict(verdicts)}, areas within {largest:.2g}", flush=True)
    print(f"{dict(verdicts)}, areas within {largest:.2g} of all poses")


if __name__ == "__main__":
    main()
