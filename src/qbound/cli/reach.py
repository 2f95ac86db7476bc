"""``qbound reach``: map where the tool of an arm gets to, with the volume and its error."""

from __future__ import annotations

import argparse
import math
from typing import Any

from qbound.arms.reach import Reach, map_bytes, reach, reach_document, reach_lines, reach_npz
from qbound.cli.chosen import add_memory, add_robot, refuse_memory
from qbound.cli.terminal import Output, check_targets, deliver, working
from qbound.export.formats import json_text
from qbound.model.robotfile import load_robot
from qbound.units import parse_length


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "reach",
        help="where does the tool get to? a map of voxels, and its volume",
        description="Map the places of the tool over all feasible configurations. One joint's\n"
        "travel is exact, the others are drawn: a voxel that is marked is reached. The same\n"
        "seed gives the same map. Of arms of points and balls; of bodies in a plane, qbound\n"
        "workspace measures two joints.",
        epilog="exit status: 0 mapped, 1 nothing feasible was found; 2 bad input\n"
        "needs qbound[proofs], and qbound[figures] for --svg\n"
        "example: qbound reach ur5 --voxel 25cm --svg reach.svg",
    )
    add_robot(parser)
    parser.add_argument(
        "--voxel",
        metavar="LENGTH",
        help="edge of a voxel: 5cm; a plain number is in the file's unit",
    )
    parser.add_argument("--seed", type=int, default=0, metavar="S", help="0 or above (default 0)")
    parser.add_argument(
        "--axis",
        metavar="X,Y,Z",
        help="a direction of the tool's frame: tell apart where it points (reachability index)",
    )
    parser.add_argument(
        "--section",
        default="y=0",
        metavar="y=0",
        help="the plane of the picture: x, y or z and a length (default y=0)",
    )
    parser.add_argument("--svg", metavar="FILE", help="draw that section")
    parser.add_argument("--npz", metavar="FILE", help="write the voxels as NumPy arrays")
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Make the map; return 1 if no feasible configuration is found."""
    check_targets([options.svg], ("svg", "png"))
    robot, plane = load_robot(options.robot), _plane(options.section)
    axis = None if options.axis is None else _numbers(options.axis)
    edge = None
    if options.voxel is not None:
        edge = parse_length(options.voxel, robot.length_unit, "--voxel")
    estimate = map_bytes(robot, edge, directions=axis is not None)
    refuse_memory(options, estimate, "take longer voxels")
    with working("mapping"):
        found = reach(robot, edge, seed=options.seed, axis=axis)
    outputs: list[Output] = [
        (options.svg, lambda: _picture(found, plane, options.svg)),
        (options.npz, lambda: reach_npz(found)),
        (options.json, lambda: json_text(reach_document(found))),
    ]
    deliver(outputs, reach_lines(found))
    return 0 if found.reached.any() else 1


def _picture(found: Reach, plane: tuple[int, float], file: str) -> bytes:
    from qbound.figures.pictures import reach_picture

    return reach_picture(found, *plane, kind=file.rpartition(".")[2].lower())


def _plane(text: str) -> tuple[int, float]:
    """Read ``y=0``."""
    name, _, number = text.partition("=")
    try:
        return ["x", "y", "z"].index(name), _finite(number)
    except ValueError:
        raise ValueError(f"--section {text}: x, y or z and a length, such as y=0.25") from None


def _numbers(text: str) -> list[float]:
    """Read ``X,Y,Z``."""
    try:
        x, y, z = (_finite(number) for number in text.split(","))
    except ValueError:
        raise ValueError(f"--axis {text}: three numbers are wanted, such as 0,0,1") from None
    return [x, y, z]


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value
