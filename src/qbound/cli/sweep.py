"""``qbound sweep``: measures of many arms that differ in some numbers, on many processes."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from qbound.cli.chosen import add_memory, refuse_memory
from qbound.cli.terminal import check_targets, deliver, progress
from qbound.printable import printable
from qbound.sweeps import Swept, sweep
from qbound.sweeps.run import with_unit
from qbound.sweeps.specification import arm_bytes, read_specification
from qbound.units import counted

SHOWN = 10
"""Arms without a value that are named; the array `reason` has them all."""


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "sweep",
        help="measures of many arms that differ in some numbers, on many processes",
        epilog="exit status: 0 every arm has every measure, 1 some lack one; 2 bad input\n"
        "needs qbound[cluster], and qbound[figures] for --svg\n"
        "example: qbound sweep reach.toml -o reach --workers 2 --svg reach.svg",
    )
    parser.add_argument("specification", help="a TOML file: robot, vary, measure")
    parser.add_argument(
        "-o", "--folder", required=True, metavar="DIR", help="new, or of the same sweep: it goes on"
    )
    parser.add_argument(
        "--scheduler", metavar="ADDRESS", help="a Dask scheduler of your own, as tcp://host:8786"
    )
    parser.add_argument(
        "--workers",
        type=int,
        metavar="N",
        help="processes on this machine, where no scheduler is given (default 1)",
    )
    parser.add_argument("--svg", metavar="FILE", help="draw the measures of one or two numbers")
    add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the sweep; return 0 if every arm has every measure, else 1."""
    if options.scheduler is not None and options.workers is not None:
        raise ValueError("--workers: the scheduler that is given has workers of its own")
    workers = 1 if options.workers is None else options.workers
    if workers < 1:
        raise ValueError(f"--workers {workers}: one or more are wanted")
    check_targets([options.svg], sources=[options.specification])
    needed = workers * arm_bytes(read_specification(options.specification))
    refuse_memory(options, needed, "hold joints with 'slice', or take fewer workers")
    found = sweep(
        options.specification,
        options.folder,
        scheduler=options.scheduler,
        workers=workers,
        tell=_teller(),
    )
    deliver([(options.svg, lambda: _picture(found))], _lines(found, options.folder))
    return 0 if found.whole else 1


def _teller() -> Callable[[int, int], None]:
    shown: list[Callable[[int], None]] = []

    def tell(done: int, total: int) -> None:
        if not shown:
            shown.append(progress("sweeping", total))
        shown[0](done)

    return tell


def _lines(found: Swept, folder: str) -> Iterator[str]:
    specification = found.study.specification
    arms = int(np.prod([len(axis) for axis in found.axes]))
    yield f"{counted(arms, 'arm')}, {counted(len(specification.measure), 'measure')}"
    for name, values in found.values.items():
        best = found.best(name)
        if best is not None:
            span = f"{np.nanmin(values):.9g} to {np.nanmax(values):.9g}"
            span = with_unit(span, found.measure_unit(name))
            yield f"  {name}: {span}, largest at {found.arm_text(best)}"
    if found.reasons:
        yield f"{counted(len(found.reasons), 'arm')} without a value:"
        for index, reason in list(found.reasons.items())[:SHOWN]:
            yield printable(f"  {found.arm_text(index)}: {reason}")
        if len(found.reasons) > SHOWN:
            yield f"  and {len(found.reasons) - SHOWN} more; the array 'reason' has them all"
    for chunk, why in found.missing.items():
        yield f"chunk {', '.join(map(str, chunk))} is missing: {why}; the same command goes on"
    yield f"the values are in the folder {folder}"


def _picture(found: Swept) -> bytes:
    from qbound.figures.sweeps import sweep_picture

    return sweep_picture(found)
