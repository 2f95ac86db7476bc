"""``cspace sweep``: measures of many arms that differ in some numbers, on many processes."""

import argparse
import math
import os
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from cspace.boundary.evaluator import forms_bytes
from cspace.cli.chosen import add_memory, refuse_memory
from cspace.cli.terminal import progress_line, say
from cspace.order import first_largest
from cspace.sweeps import POINTS, Swept, read_specification, sweep
from cspace.units import counted


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "sweep",
        help="measures of many arms that differ in some numbers, on many processes",
        epilog="exit status: 0 every arm has every measure, 1 some lack one; 2 bad input\n"
        "needs cspace[cluster]\n"
        "example: cspace sweep lengths.toml -o lengths --workers 2",
    )
    parser.add_argument("specification", help="a TOML file: robot, vary, measure")
    parser.add_argument(
        "-o", "--folder", required=True, metavar="DIR", help="new, or of this sweep"
    )
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of Dask, such as tcp://host:8786")
    parser.add_argument("--workers", type=int, metavar="N", help="processes (default: all cores)")
    add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the sweep; return 0 if every arm has every measure, else 1."""
    asked, robot = read_specification(options.specification)
    workers = options.workers or min(os.cpu_count() or 1, math.prod(asked.shape))
    if workers < 1:
        raise ValueError(f"--workers {workers}: one or more are wanted")
    refuse_memory(options, workers * forms_bytes(robot), "take fewer workers")
    progress = progress_line("sweeping", math.prod(asked.shape))
    found = sweep(options.specification, options.folder, options.scheduler, workers, progress)
    say(*_lines(found, options.folder))
    return 1 if found.reasons or found.missing else 0


def _lines(swept: Swept, folder: str) -> Iterator[str]:
    def arm(index: Sequence[int]) -> str:
        values = zip(swept.axes.items(), index, strict=True)
        return ", ".join(f"{name} = {axis[i]:.6g}" for (name, axis), i in values)

    for name, values in swept.values.items():
        if not np.isnan(values).all():
            best = [int(k) for k in np.unravel_index(first_largest(values), values.shape)]
            span = f"{np.nanmin(values):.9g} to {np.nanmax(values):.9g}"
            yield f"  {name}: {span}, largest at {arm(best)}"
    for index, reason in [*swept.reasons.items()][:10]:  # the file has all
        yield f"no value at {arm(index)}: {reason}"
    if swept.missing:
        yield f"{counted(swept.missing, 'arm')} missing: workers died; the same command goes on"
    yield f"{counted(len(swept.reasons), 'arm')} without a value"
    yield f"a line for each arm is in {folder}/{POINTS}"
