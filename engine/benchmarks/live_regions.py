"""Compare the regions that the page finds among obstacles with the library's, by the thousand.

`python engine/benchmarks/live_regions.py --scenes 10000`: every third scene has a slit, down to
1e-6 rad wide (`engine/tests/engine_support/live_scenes.py`). Equal are scenes with as many regions,
each as large to 0.1 % of all poses. Others are printed with their seeds; `--only SEED` repeats one.
`--times`: processor time of a change, with 3, 10 and 30 obstacles on a spiral, instead.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections import Counter
from multiprocessing import Pool
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from cspace.region import UnresolvedError
from engine_support.javascript import JavaScriptError, find_node
from engine_support.live_scenes import (
    Scene,
    figure_script,
    page,
    random_scene,
    scene_with_slit,
    shares_in_library,
    shares_in_page,
)  # fmt: skip

PROCESSES = 2
LARGEST = 1e-3
"""Difference of two regions that are called equal, as a share of all poses."""

TIMES = """
const CORNERS = [0.15, 0, 0.05, 0.14, -0.12, 0.09, -0.12, -0.09, 0.05, -0.14];
const NUMBERS = [["disc", [0.1]], ["box", [0.3, 0.2]], ["polygon", CORNERS]];
const spiral = (count) => Array.from({ length: count }, (_, i) => {
  const [x, y] = polar(0.75 + (1.1 * i) / count, 2.4 * i);
  const [kind, numbers] = NUMBERS[i % 3];
  return checked({ kind, numbers, x, y, angle: i, name: `${i}` });
});
const cost = (change, times) => {
  const all = Array.from({ length: times }, (_, k) => {
    const { user } = process.cpuUsage();
    change(k);
    return (process.cpuUsage().user - user) / 1000;
  });
  return all.sort((a, b) => a - b)[times >> 1].toFixed(1);
};
console.log("| obstacles | one dragged / ms | a link made longer / ms |");
console.log("| --- | --- | --- |");
for (const count of [3, 10, 30]) {
  const [obstacles, known, links] = [spiral(count), {}, sceneOf(FIRST_SCENE).links];
  const show = (next) => robotOf({ links, home: [0, 0], obstacles, ...next }, known);
  const dragged = (k) =>
    show({ obstacles: obstacles.with(1, checked({ ...obstacles[1], x: 0.001 * k - 0.6 })) });
  const longer = (k) => show({ links: links.with(1, { ...links[1], length: 0.8 - 0.001 * k }) });
  console.log(`| ${[count, cost(dragged, 300), cost(longer, 100)].join(" | ")} |`);
}
"""

Row = tuple[int, str, float]


def compare(seed: int) -> Row:
    """Return a scene's seed, what was found, and the largest difference of two regions."""
    scene = scene_of(seed)
    try:
        expected = shares_in_library(scene)
    except UnresolvedError:
        return seed, "not resolved by the library", 0.0
    try:
        found = shares_in_page(page(), scene)
    except (JavaScriptError, TypeError) as error:  # JSON has no other word for NaN than null
        return seed, f"error of the page: {error}", 0.0
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
    parser.add_argument("--times", action="store_true")
    given = parser.parse_args()
    if given.times:
        scripts = (figure_script(f"{name}.js") for name in ("geometry", "space", "live"))
        script = "".join(["const KINDS = {};", *scripts, TIMES])
        subprocess.run([find_node(), "-"], input=script, text=True, check=True)
        return
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
