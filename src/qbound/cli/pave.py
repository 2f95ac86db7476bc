"""``qbound pave``: certified inner and outer pavings of a region, with the undecided volume."""

from __future__ import annotations

import argparse
import math
from typing import Any

from qbound import __version__
from qbound.cli.chosen import add_robot, add_slice
from qbound.cli.values import held, json_text, write_text
from qbound.model.robotfile import load_robot
from qbound.proofs.balls import above, below
from qbound.proofs.exact import exact_problem, exact_robot
from qbound.proofs.paving import Paving, pave


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "pave",
        help="bracket a region of any number of joints by cells, each proved",
        epilog="example: qbound pave minervabot-v2 --tolerance 0.001",
    )
    add_robot(parser)
    parser.add_argument(
        "--tolerance",
        type=float,
        default=0.01,
        metavar="PART",
        help="undecided part of the joint range at which to stop (default 0.01)",
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    add_slice(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Pave; 0 if the tolerance is met, 3 if cells ran out before."""
    if not (math.isfinite(options.tolerance) and options.tolerance > 0):
        raise ValueError(f"--tolerance {options.tolerance}: a positive number is wanted")
    values = held(load_robot(options.robot), options.slice)
    paving = pave(exact_problem(exact_robot(options.robot), values), options.tolerance)
    content = paving_content(options.robot, paving)
    if options.json:
        write_text(options.json, json_text(content))
    if options.json != "-":
        _say(content)
    return 0 if paving.undecided_fraction <= options.tolerance else 3


def paving_content(robot: str, paving: Paving) -> dict[str, Any]:
    """Return the JSON form of a paving, schema qbound/paving/1: cells by level and index.

    A cell of level L has halved joint j (counted from 0) ``(L + n - 1 - j) // n`` times; its index
    counts cells of that width from the lower end of the range.
    """
    inner, outer = paving.bracket
    return {
        "schema": "qbound/paving/1",
        "robot": load_robot(robot).name,
        "version": __version__,
        "volume": {"inner": below(inner), "outer": above(outer)},
        "undecided": float(paving.undecided_fraction),
        "range": [[float(low), float(high)] for low, high in paving.room.ends],
        "cells": {
            word: [{"level": c.level, "index": c.index.tolist()} for c in groups]
            for word, groups in (
                ("feasible", paving.feasible),
                ("infeasible", paving.infeasible),
                ("undecided", (paving.undecided,)),
            )
        },
    }


def _say(content: dict[str, Any]) -> None:
    volume, cells = content["volume"], content["cells"]
    counts = {word: sum(len(c["index"]) for c in groups) for word, groups in cells.items()}
    print(f"volume between {volume['inner']:.9g} and {volume['outer']:.9g}")
    print(f"{100 * content['undecided']:.3g} % of the range is undecided")
    print(", ".join(f"{n} cells {word}" for word, n in counts.items()))
