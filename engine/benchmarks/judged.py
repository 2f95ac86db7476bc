"""Let a judge that shares nothing with the library look at regions of bodies, by the thousand.

`python engine/benchmarks/judged.py --scenes 10000`: each scene over both joints, its arcs and
components by `engine/tests/engine_support/region_judge.py`. With `--copies 2` also in two exact
copies each, in turn of all: lengths times 1e-9, 1e-3, 1e3 and 1e9, mirrored, turned by a right
angle and by the matrix of 0.6 and 0.8. With `--kernels` also under the machine code of older
processors, in processes of their own. `--cheap` leaves out the flood fill. What was found is
printed and written down, with the seeds.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import signal
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from cspace.model.robotfile import parse_robot
from cspace.region import Region, clearance_problem, solve
from engine_support import body_scenes
from engine_support.region_judge import Outline, agreement, area_difference, faults

PROCESSES = 2
PATIENCE = 20.0
"""Processor time after which a region counts as never found, s."""

KERNELS = {"native": (), "Haswell": ("X86_V3",), "Nehalem": None}
"""What of NumPy's machine code stays on, beside what every processor has; None: nothing."""

POWERS = (9, 3, -3, -9)
"""Of ten: by how much the lengths of copies are longer."""

Row = dict[str, Any]


# --- one scene ------------------------------------------------------------------------------------


def regions_of(text: str) -> tuple[list[Region], list[float]]:
    """Find the region of a file over each joint, and how long each took: processor time, s."""
    problem = clearance_problem(parse_robot(text))
    found, seconds = [], []
    for base in (0, 1):
        start = time.process_time()
        signal.setitimer(signal.ITIMER_VIRTUAL, PATIENCE)
        found.append(solve(problem, base=base))
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        seconds.append(time.process_time() - start)
    return found, seconds


def lost_patience(*_: object) -> None:
    raise TimeoutError(f"no region after {PATIENCE} s of processor time")


def chosen(seed: int, text: str, number: int) -> list[tuple[str, tuple[str, int]]]:
    """Return copies of the scene of a seed: the first is another one for the next seed."""
    every = list(body_scenes.copies(text, POWERS).items()) if number else []
    return (2 * every)[seed % len(every) :][:number] if every else []


def look_at(seed: int, *, flooded: bool, copies: int, judging: bool) -> Row:
    """Judge the scene of a seed; what is wrong is a text that says where, and its kind."""
    text = body_scenes.scene(seed)
    table = body_scenes.read(text)
    row: Row = {"seed": seed, "name": table["name"], "obstacles": len(table["obstacle"])}
    try:
        regions, row["seconds"] = regions_of(text)
        outlines = [Outline.of(region) for region in regions]
        row["wrong"] = [f"bases, {each}" for each in agreement(outlines)]
        if judging:
            for base, region in enumerate(regions):
                each = faults(text, region, flooded=flooded)
                row["wrong"] += [f"base {base}, {fault}" for fault in each]
        slides = sum(joint["type"] == "prismatic" for joint in table["joint"])
        for name, (copy, places) in chosen(seed, text, copies):
            again, _ = regions_of(copy)
            factors = [1.0, float(10.0 ** (places * slides))]
            for base, pair in enumerate(zip(outlines, map(Outline.of, again), strict=True)):
                each = agreement(pair, factors)
                row["wrong"] += [f"{name}, base {base}, {fault}" for fault in each]
                row["copies"] = max(row.get("copies", 0.0), area_difference(pair, factors))
            for base, region in enumerate(again):
                each = faults(copy, region, flooded=False)
                row["wrong"] += [f"{name}, base {base}, {fault}" for fault in each]
        row["outlines"] = [asdict(outline) for outline in outlines]
        row["areas"] = area_difference(outlines)
    except (ArithmeticError, AssertionError, LookupError, OSError, TypeError, ValueError) as error:
        row["wrong"] = [f"crash, {type(error).__name__}: {str(error)[:200]}"]
    return row


# --- processes ------------------------------------------------------------------------------------


def switched_off(kernel: str) -> list[str]:
    """Return the names of NumPy's machine code that a kernel does without."""
    kept = KERNELS[kernel] or ()
    on = [name for name in __cpu_dispatch__ if __cpu_features__[name]]
    return [] if kernel == "native" else [name for name in on if name not in kept]


def blas_kernel() -> str:
    """Return the name of the kernel that OpenBLAS has chosen, as far as it can be asked."""
    maps = Path("/proc/self/maps")
    lines = maps.read_text().splitlines() if maps.exists() else []
    for path in {line.split()[-1] for line in lines if "openblas" in line}:
        library = ctypes.CDLL(path)
        for name in ("scipy_openblas_get_corename64_", "openblas_get_corename"):
            if hasattr(library, name):
                asked = getattr(library, name)
                asked.restype = ctypes.c_char_p
                return str(asked().decode())
    return "unknown"


def child(options: argparse.Namespace) -> None:
    """Look at some of the seeds; a line of JSON each."""
    off = os.environ.get("NPY_DISABLE_CPU_FEATURES", "").split()
    assert not any(__cpu_features__[name] for name in off), off
    wanted, found = os.environ.get("OPENBLAS_CORETYPE"), blas_kernel()
    assert wanted is None or found.lower() in (wanted.lower(), "unknown"), found
    print(json.dumps({"blas": found, "off": off}), flush=True)
    signal.signal(signal.SIGVTALRM, lost_patience)
    native = options.child == "native"
    for seed in range(options.first, options.first + options.scenes)[options.share :: PROCESSES]:
        copies = options.copies if native else 0
        row = look_at(seed, flooded=not options.cheap, copies=copies, judging=native)
        print(json.dumps(row), flush=True)


def run(options: argparse.Namespace, kernel: str) -> Iterator[Row]:
    """Yield what the processes of one kernel print."""
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    if kernel != "native":
        off = " ".join(switched_off(kernel))
        environment |= {"OPENBLAS_CORETYPE": kernel, "NPY_DISABLE_CPU_FEATURES": off}
    command = [sys.executable, __file__, *sys.argv[1:], "--child", kernel]
    children = [
        subprocess.Popen(
            [*command, "--share", str(k)], env=environment, stdout=subprocess.PIPE, text=True
        )
        for k in range(PROCESSES)
    ]
    waiting = [one.stdout for one in children if one.stdout is not None]
    while waiting:
        for pipe in list(waiting):
            line = pipe.readline()
            if line:
                yield json.loads(line)
            else:
                waiting.remove(pipe)
    if any(one.wait() for one in children):
        raise RuntimeError(f"a process under {kernel} failed")


# --- all of them ----------------------------------------------------------------------------------


def summary(rows: dict[int, Row], seconds: float) -> Row:
    """Gather seeds by what is wrong with their scenes."""
    wrong = defaultdict(set)
    for seed, row in rows.items():
        for fault in row["wrong"]:
            wrong[fault.partition(":")[0]].add(seed)
    unresolved = {s for kind, seeds in wrong.items() if "unresolved" in kind for s in seeds}
    faulty = {s for kind, seeds in wrong.items() if "unresolved" not in kind for s in seeds}
    times = [t for row in rows.values() for t in row.get("seconds", [])]
    classes = sorted({row["name"].split()[0] for row in rows.values()})
    return {
        "scenes": len(rows),
        "with 100 obstacles": sum(row["obstacles"] >= 100 for row in rows.values()),
        "wrong": len(faulty),
        "wrong by class": {
            name: sum(rows[s]["name"].startswith(name) for s in faulty) for name in classes
        },
        "unresolved": sorted(unresolved),
        "largest difference of areas, of their sum": {
            "bases": max((row.get("areas", 0.0) for row in rows.values()), default=0.0),
            "copies": max((row.get("copies", 0.0) for row in rows.values()), default=0.0),
        },
        "processor time of a region / s": {
            "median": median(times) if times else None,
            "largest": max(times, default=None),
        },
        "wall clock / s": round(seconds),
        "seeds by fault": {kind: sorted(seeds) for kind, seeds in sorted(wrong.items())},
        "examples": {
            str(seed): row["wrong"][:3] for seed, row in sorted(rows.items()) if row["wrong"]
        },
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="seed of the first scene")
    parser.add_argument("--copies", type=int, default=0, help="how many of each scene, of 7")
    parser.add_argument("--kernels", action="store_true")
    parser.add_argument("--cheap", action="store_true", help="no flood fill")
    parser.add_argument("--json", type=Path, default=Path(__file__).with_name("judged.json"))
    parser.add_argument("--child", choices=KERNELS, help=argparse.SUPPRESS)
    parser.add_argument("--share", type=int, default=0, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        child(options)
        return 0
    start, rows, processors = time.monotonic(), dict[int, Row](), {}
    for kernel in KERNELS if options.kernels else ["native"]:
        for row in run(options, kernel):
            if "blas" in row:
                processors[kernel] = row
                continue
            seed = row["seed"]
            if kernel == "native":
                rows[seed] = row
                if row["wrong"]:
                    print(f"{row['name']}: {row['wrong'][:3]}", flush=True)
                if len(rows) % 100 == 0:
                    print(f"{len(rows)} scenes, {time.monotonic() - start:.0f} s", flush=True)
                continue
            both = zip(*(each.get("outlines", []) for each in (rows[seed], row)), strict=False)
            for pair in both:
                found = agreement([Outline(**outline) for outline in pair])
                rows[seed]["wrong"] += [f"{kernel}, {each}" for each in found]
    told = summary(rows, time.monotonic() - start)
    asked = {key: value for key, value in vars(options).items() if key in ("first", "copies")}
    asked |= {"flood fill": not options.cheap, "kernels": processors, "numpy": np.__version__}
    options.json.write_text(json.dumps(asked | told, indent=1) + "\n", encoding="utf-8")
    for kind, seeds in told["seeds by fault"].items():
        print(f"{kind}: {len(seeds)} ({', '.join(map(str, seeds[:15]))}...)")
    print(f"{told['wrong']} of {len(rows)} scenes wrong, {len(told['unresolved'])} unresolved")
    return 1 if told["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
