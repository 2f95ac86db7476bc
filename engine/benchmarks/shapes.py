"""Ask judges of shapes whether anything meets in a pose that the library calls feasible.

    python engine/benchmarks/shapes.py [FOLDER ...]

Looked at are the packaged robots and URDFs, the URDFs of the tests, and all in the folders. A robot
file is judged by its own reader, turns of single points and shapely
(`engine/tests/engine_support/brute_force.py`): every margin, both ways, and every two bodies that
are not left out. A URDF is judged by its own reader and the true shapes
(`engine/tests/engine_support/urdf_judge.py`): python-fcl, or coal where it is installed.

Poses are random ones, and as many at the edge: the last feasible place, found by halving, between a
feasible random pose and one that is not. Exit status 1: a pose is called feasible, and shapes meet.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from time import process_time
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from engine_support.judged_poses import Found, judged_file, judged_urdf
from engine_support.urdf_judge import LIBRARY

ROOT = Path(__file__).parents[2]
PACKAGED = [ROOT / "engine" / "cspace" / "robots", ROOT / "src" / "qbound" / "robots"]
TESTS = Path(__file__).parents[1] / "tests" / "urdfs"


def arms(folders: list[Path]) -> Iterator[tuple[str, Callable[[int], Found]]]:
    """Yield the name of every arm, and what judges it."""
    for folder in (*PACKAGED, TESTS, *folders):
        for file in sorted(folder.glob("*.toml")):
            yield file.name, partial(judged_file, file)
        for file in sorted(folder.glob("*.urdf")):
            srdf, last = file.with_suffix(".srdf"), {"camera": "lower", "post": "lower"}
            options: dict[str, Any] = {"chain": (None, last.get(file.stem))}
            disabled = options | {"srdf": srdf} if srdf.exists() else options
            yield file.name, partial(judged_urdf, file, **disabled)
            yield (
                f"{file.name} --neighbours",
                partial(judged_urdf, file, neighbours=True, **options),
            )
    meshes = TESTS / "arm_description" / "urdf" / "same.urdf"
    yield "arm of meshes", partial(judged_urdf, meshes, packages=(meshes.parents[1],))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=10_000, help="random poses of each arm")
    options = parser.parse_args()
    faults = 0
    print(
        "| arm | pairs | left out | feasible | least distance | wrong | lost | s |\n"
        + "| --- " * 8
        + "|"
    )
    for name, judge in arms(options.folders):
        start = process_time()
        try:
            f = judge(options.count)
        except (LookupError, ValueError) as error:
            print(f"{name}: {error}", flush=True)
            continue
        faults += len(f.wrong)
        counts = f"{f.pairs} | {f.left_out} | {f.feasible:,} | {f.least:.2g} | {len(f.wrong)}"
        print(f"| {name} | {counts} | {f.lost:,} | {process_time() - start:.0f} |", flush=True)
        for at, what, depth in f.wrong[:3]:
            print(f"  {what}: {depth:.3g} at {at}")
    print(f"{LIBRARY} for shapes of URDFs; {faults} poses wrong")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
