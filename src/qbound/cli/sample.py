"""``qbound sample``: random configurations; the method that the exact region replaces."""

from __future__ import annotations

import argparse
from typing import Any

from qbound import sampling
from qbound.boundary.evaluator import forms_bytes
from qbound.cli.chosen import add_memory, add_robot, add_rule, refuse_memory, sized_robot
from qbound.cli.terminal import Output, deliver, progress
from qbound.export.formats import json_text
from qbound.export.samples import sample_bytes, sample_csv, sample_document, sample_npz
from qbound.region import paper_rule

MOST = 20_000_000
"""Configurations of a sample at most."""


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "sample",
        help="random configurations and whether they are free",
        description="Draw configurations evenly and judge each. The same seed draws the same ones.",
        epilog="exit status: 0 drawn: a sample proves nothing; 2 bad input\n"
        "example: qbound sample minervabot-v2 -n 1000 --seed 1 --csv sample.csv",
    )
    add_robot(parser)
    parser.add_argument("-n", type=_count, required=True, metavar="N", help="how many: 1000, 1e6")
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="0 or above (default 0)")
    add_rule(parser)
    parser.add_argument(
        "--csv", metavar="FILE", help="write configurations, tool places, free or not"
    )
    parser.add_argument("--npz", metavar="FILE", help="the same as NumPy arrays q, tool, free")
    parser.add_argument("--json", metavar="FILE", help="the same as JSON; - for standard output")
    add_memory(parser)
    parser.set_defaults(run=run)


def _count(text: str) -> int:
    """Read a whole number, as 1000 or 1e6."""
    try:
        return int(text)
    except ValueError:
        number = float(text)
    if not number.is_integer():
        raise ValueError(text)
    return int(number)


def run(options: argparse.Namespace) -> int:
    """Draw a sample; always return 0, because a sample proves nothing."""
    if options.n < 1:
        raise ValueError(f"-n {options.n}: a sample has one configuration or more")
    if options.n > MOST:
        raise ValueError(f"-n {options.n}: at most {MOST} fit into memory; take several seeds")
    if options.seed < 0:
        raise ValueError(f"--seed {options.seed}: a seed is 0 or above")
    robot, rule, seed = sized_robot(options), options.rule, options.seed
    tables = sum(file is not None for file in (options.csv, options.json))
    estimate = forms_bytes(robot) + sample_bytes(len(robot.joints), options.n, tables)
    refuse_memory(options, estimate, "draw fewer, or write --npz alone")
    judge = sampling.keeps_clear if rule == "clearance" else paper_rule.feasible
    told = progress("sampling", options.n)
    drawn = sampling.sample(robot, options.n, judge, seed=seed, progress=told)
    free, error = int(drawn.free.sum()), drawn.standard_error
    outputs: list[Output] = [
        (options.csv, lambda: sample_csv(robot, drawn)),
        (options.npz, lambda: sample_npz(robot, drawn)),
        (options.json, lambda: json_text(sample_document(robot, drawn, rule, seed), None)),
    ]
    line = f"{free} of {options.n} are free: {drawn.fraction_free:.6g} +- {error:.2g}"
    deliver(outputs, [line])
    return 0
