"""Compare two working trees: what their commands say, and how much processor time calls take.

Run with ``python engine/benchmarks/guard.py OLD NEW [--only documents|timings]``; both are folders
with a checkout, such as worktrees of git. Nothing is recorded: the old tree is the record. This is
the guard of a change that moves code and must change nothing else.

- Documents: exit statuses are the same, and so are JSON documents, numbers to 1e-9 of their size.
- Timings: processes of both trees in turns; the ratio of the medians is at most `SLOWER`.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

TWO = ("minervabot-v2", "pp-portal", "pr-gantry-arm", "rp-telescopic-boom")
BODIES = ("minervabot-v2-bodies", "two-joint-arm-with-walls", "two-links-on-a-table")
COMMANDS = (
    *(f"region {name} --json -" for name in (*TWO, *BODIES)),
    *(f"workspace {name} --json -" for name in TWO),
    *(f"contains {name} 0.1 0.1 --json -" for name in (*TWO, *BODIES)),
    "why minervabot-v2 0deg 0deg 0deg 130deg --json -",
    "why minervabot-v2 -2.6 0.2 1.6 -2.3 --json -",
    "why two-links-on-a-table 1.74532925rad -1.04719755rad -1.2584rad -0.4858rad --json -",
    "why ur5 0 -90deg 0 -90deg 0 0 30deg -60deg 0 -90deg 0 0 --json -",
    *(f"certify minervabot-v2 --scale {scale}" for scale in (0.96, 1)),
    *(f"certify {name} --region" for name in ("minervabot-v2-bodies", "pr-gantry-arm")),
    "fibre ur5 elbow_joint 0 -90deg 0 -90deg 0 0 --json -",
    "allowed ur5 --json -",
    "traverse minervabot-v2 1 2 3 --json -",
    "claims --json",
    "region nothing-of-this-name",
    "contains minervabot-v2 1e999 0",
    "check nothing.json",
)

LOAD = "from cspace import *; r = load_robot({!r})"
CALLS = {
    "import cspace": ("pass", "import cspace"),
    "find_region, points": (LOAD.format(TWO[0]) + "; find_region(r)", "find_region(r)"),
    "find_region, bodies": (LOAD.format(BODIES[0]) + "; find_region(r)", "find_region(r)"),
    "contains, 10^5 configurations": (
        LOAD.format(TWO[0]) + "; import numpy as np; g = find_region(r);"
        " q = np.random.default_rng(0).uniform(-3, 3, (100000, 2)); g.contains(q)",
        "g.contains(q)",
    ),
    "keeps_clear, UR5, 10^4": (
        LOAD.format("ur5") + "; import numpy as np;"
        " q = np.random.default_rng(0).uniform(-3, 3, (10000, 6)); keeps_clear(r, q)",
        "keeps_clear(r, q)",
    ),
    "keeps_clear, compiled, UR5, 10^5": (
        LOAD.format("ur5") + "; import numpy as np;"
        " q = np.random.default_rng(0).uniform(-3, 3, (100000, 6));"
        " keeps_clear(r, q, compiled=True)",
        "keeps_clear(r, q, compiled=True)",
    ),
    "find_region, 30 obstacles": (
        LOAD.format(TWO[0]) + "; from engine_support.body_scenes import ordinary, robot;"
        " r = robot(ordinary(5, obstacles=30)); find_region(r)",
        "find_region(r)",
    ),
    "workspace": (
        "from cspace.cli import main; w = ['workspace', 'minervabot-v2', '--json', '-']; main(w)",
        "main(w)",
    ),
    "fibres, UR5, 10^3": (
        LOAD.format("ur5") + "; import numpy as np;"
        " q = np.random.default_rng(0).uniform(-3, 3, (1000, 6)); fibres(r, 2, q)",
        "fibres(r, 2, q)",
    ),
    "why": (LOAD.format(TWO[0]) + "; why(r, [0, 0], [0, 2.3])", "why(r, [0, 0], [0, 2.3])"),
    "certify": (
        "from cspace.cli import main; w = ['certify', 'minervabot-v2', '--scale', '0.96']; main(w)",
        "main(w)",
    ),
}
"""By name: what is done once, and what is timed; an old tree's package is put in."""

RUNS, SLOWER = 15, 1.10
"""Runs of a call in either tree; the largest ratio of their medians."""


def engine(tree: Path) -> str:
    """Return the name of a tree's engine: before it moved, it was the package qbound."""
    return "cspace" if (tree / "engine" / "cspace").is_dir() else "qbound"


def before_the_move(lines: str) -> str:
    """Return lines of Python with the names that an old tree has."""
    return lines.replace("cspace", "qbound").replace("engine_support", "support")


def program(tree: Path, command: str) -> str:
    """Return the module that has a command in a tree: before the engine moved, it had all."""
    of_the_companion = command.partition(" ")[0] in ("claims", "results")
    return "lizarraga2025" if of_the_companion and engine(tree) == "cspace" else engine(tree)


def python(tree: Path, *words: str, check: bool = False) -> subprocess.CompletedProcess[str]:
    """Run Python with a tree's package and what supports its tests, in a folder of its own."""
    paths = os.pathsep.join(str(tree / name) for name in ("src", "engine", "tests", "engine/tests"))
    settings = {"OPENBLAS_NUM_THREADS": "1", "COLUMNS": "100", "PYTHONPATH": paths}
    with tempfile.TemporaryDirectory() as folder:
        return subprocess.run(
            [sys.executable, *words],
            env=os.environ | settings,
            cwd=folder,
            capture_output=True,
            text=True,
            check=check,
        )


def differences(old: Any, new: Any, where: str = "") -> Iterator[str]:
    """Yield where two documents differ."""
    if isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
        for key in old:
            yield from differences(old[key], new[key], f"{where}.{key}")
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for k, pair in enumerate(zip(old, new, strict=True)):
            yield from differences(*pair, f"{where}[{k}]")
    elif isinstance(old, float) and isinstance(new, float):
        if not math.isclose(old, new, rel_tol=1e-9, abs_tol=1e-12):
            yield f"{where}: {old}, now {new}"
    elif old != new:
        yield f"{where}: {str(old)[:80]}, now {str(new)[:80]}"


def documents(old: Path, new: Path) -> Iterator[str]:
    """Run every command in both trees and yield what differs."""
    for command in COMMANDS:
        was, now = (
            python(tree, "-m", program(tree, command), *command.split()) for tree in (old, new)
        )
        print(f"{now.returncode}  {program(new, command)} {command}", flush=True)
        if was.returncode != now.returncode:
            yield f"{command}: status {was.returncode}, now {now.returncode}"
        elif "--json" in command and was.stdout:
            pair = (json.loads(done.stdout) for done in (was, now))
            yield from (f"{command}: {each}" for each in list(differences(*pair))[:5])


def timings(old: Path, new: Path) -> Iterator[str]:
    """Time every call in both trees and yield what has become slower."""
    for name, (before, call) in CALLS.items():
        clock = f"import sys, time; t = time.process_time()\n{call}\nt = time.process_time() - t"
        lines = f"{before}\n{clock}\nsys.stderr.write(str(t))"
        seconds: dict[Path, list[float]] = {old: [], new: []}
        for _ in range(RUNS):
            for tree, found in seconds.items():
                mine = lines if engine(tree) == "cspace" else before_the_move(lines)
                found.append(float(python(tree, "-c", mine, check=True).stderr))
        was, now = median(seconds[old]), median(seconds[new])
        print(f"{name}: {1e3 * was:.3g} ms, now {1e3 * now:.3g} ms, {now / was:.2f}", flush=True)
        if now > SLOWER * was:
            yield f"{name}: {now / was:.2f} times as long"


def main() -> int:
    """Compare; 1 if anything differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--only", choices=("documents", "timings"))
    options = parser.parse_args()
    trees = options.old.resolve(), options.new.resolve()
    checks = {"documents": documents, "timings": timings}
    faults = [f for name, c in checks.items() if options.only in (None, name) for f in c(*trees)]
    print("\n".join(faults) or "nothing differs")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
