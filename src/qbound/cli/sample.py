"""``qbound sample``: random configurations, judged; the method that the exact region replaces."""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

from qbound import sampling
from qbound.cli.chosen import add_robot, add_rule
from qbound.cli.progress import progress
from qbound.cli.values import (
    Content,
    check_targets,
    csv_text,
    heading,
    joint_units,
    npz_bytes,
    write_all,
)
from qbound.model.robot import Robot
from qbound.model.robotfile import load_robot
from qbound.region import paper_rule
from qbound.sampling import Sample


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "sample",
        help="random configurations and whether they are free",
        description="Draw configurations evenly and judge each. The same seed draws the same ones.",
        epilog="example: qbound sample minervabot-v2 -n 1000 --seed 1 --csv sample.csv",
    )
    add_robot(parser)
    parser.add_argument("-n", type=int, required=True, metavar="N", help="how many")
    parser.add_argument("--seed", type=int, required=True, metavar="S", help="0 or above")
    add_rule(parser)
    parser.add_argument(
        "--csv", metavar="FILE", help="write configurations, tool places, free or not"
    )
    parser.add_argument("--npz", metavar="FILE", help="the same as NumPy arrays q, tool, free")
    parser.add_argument("--json", metavar="FILE", help="the same as JSON; - for standard output")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Draw and judge; always 0: a sample proves nothing."""
    if options.n < 1:
        raise ValueError(f"-n {options.n}: a sample has one configuration or more")
    if options.seed < 0:
        raise ValueError(f"--seed {options.seed}: a seed is 0 or above")
    robot = load_robot(options.robot)
    files = [options.csv, options.npz, options.json]
    check_targets([file for file in files if file])
    judge = sampling.keeps_clear if options.rule == "clearance" else paper_rule.feasible
    told = progress("sampling", options.n)
    drawn = sampling.sample(robot, options.n, judge, seed=options.seed, progress=told)
    write_all(_outputs(options, robot, drawn))
    if "-" not in files:
        free, n = int(drawn.free.sum()), options.n
        print(f"{free} of {n} are free: {drawn.fraction_free:.6g} +- {drawn.standard_error:.2g}")
    return 0


def _outputs(options: argparse.Namespace, robot: Robot, drawn: Sample) -> list[tuple[str, Content]]:
    outputs = list[tuple[str, Content]]()
    if options.csv:
        outputs.append((options.csv, _csv(robot, drawn)))
    if options.npz:
        outputs.append((options.npz, _npz(robot, drawn)))
    if options.json:
        outputs.append((options.json, _json(robot, drawn, options)))
    return outputs


def _csv(robot: Robot, drawn: Sample) -> str:
    units = zip(robot.joints, joint_units(robot), strict=True)
    header = [f"{joint.name}_{unit}" for joint, unit in units]
    header += [f"{axis}_{robot.length_unit}" for axis in "xyz"] + ["free"]
    rows = zip(drawn.q.tolist(), drawn.tool.tolist(), drawn.free.tolist(), strict=True)
    return csv_text(header, ([*q, *tool, int(free)] for q, tool, free in rows))


def _npz(robot: Robot, drawn: Sample) -> bytes:
    names = np.array([joint.name for joint in robot.joints])
    arrays = {"q": drawn.q, "tool": drawn.tool, "free": drawn.free, "joints": names}
    return npz_bytes(arrays | {"units": np.array([*joint_units(robot), robot.length_unit])})


def _json(robot: Robot, drawn: Sample, options: argparse.Namespace) -> str:
    content = {
        **heading("qbound/sample/1", robot, options.rule),
        "ranges": sampling.joint_ranges(robot).tolist(),
        "n": len(drawn.free),
        "seed": options.seed,
        "free": int(drawn.free.sum()),
        "fraction_free": drawn.fraction_free,
        "standard_error": drawn.standard_error,
        "configurations": {
            "q": drawn.q.tolist(),
            "tool": drawn.tool.tolist(),
            "free": drawn.free.tolist(),
        },
    }
    return json.dumps(content) + "\n"
