"""``qbound connected``: prove that one can move from one pose to another, or that one cannot."""

from __future__ import annotations

import argparse
from typing import Any

from qbound import __version__
from qbound.cli.chosen import add_robot
from qbound.cli.values import configuration, json_text, write_text
from qbound.model.robot import Robot
from qbound.model.robotfile import load_robot
from qbound.proofs.connection import Connection, connection, wall
from qbound.proofs.exact import exact_problem, exact_robot

STATUS = {"connected": 0, "separated": 1, "infeasible": 1, "undecided": 3}


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "connected",
        help="can the arm go from one pose to another? proved either way",
        epilog="example: qbound connected minervabot-v2 0deg 0deg 92deg -133deg",
    )
    add_robot(parser)
    parser.add_argument(
        "values", nargs="+", metavar="VALUE", help="both poses, one after the other: 20deg, 0.35rad"
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Prove it; 0 connected, 1 not, 3 undecided."""
    robot = load_robot(options.robot)
    n = len(robot.joints)
    if len(options.values) != 2 * n:
        raise ValueError(f"{len(options.values)} values; two poses of {n} joints have {2 * n}")
    one, other = (configuration(robot, options.values[k : k + n]) for k in (0, n))
    found = connection(exact_problem(exact_robot(options.robot)), one, other)
    if options.json:
        content = connection_content(robot, [one, other], found)
        write_text(options.json, json_text(content))
    if options.json != "-":
        _say(found)
    return STATUS[found.answer]


def connection_content(robot: Robot, poses: list[list[float]], found: Connection) -> dict[str, Any]:
    """Return the JSON form of an answer, schema qbound/connection/1."""
    return {
        "schema": "qbound/connection/1",
        "robot": robot.name,
        "version": __version__,
        "joints": [joint.name for joint in robot.joints],
        "poses": poses,
        "answer": found.answer,
        "infeasible_poses": list(found.infeasible),
        "wall": _wall(found, poses[0]) if found.answer == "separated" else None,
        "path": None if found.path is None else found.path.tolist(),
        "cells": found.paving.cells,
        "level": found.paving.level,
    }


def _wall(found: Connection, pose: list[float]) -> list[dict[str, Any]]:
    """Return the infeasible cells around the first pose, as boxes of joint values."""
    places = [found.paving.room.places(cells) for cells in wall(found.paving, pose)]
    return [
        {"from": low.tolist(), "to": high.tolist()}
        for lows, highs in places
        for low, high in zip(lows, highs, strict=True)
    ]


def _say(found: Connection) -> None:
    cells = f"{found.paving.cells} cells"
    if found.answer == "connected" and found.path is not None:
        print(f"connected: a path of {len(found.path) - 1} legs, each in a cell proved feasible")
    elif found.answer == "separated":
        print(f"separated: every path meets a cell proved infeasible ({cells})")
    elif found.answer == "infeasible":
        which = " and ".join(("first", "second")[k] for k in found.infeasible)
        print(f"infeasible: the {which} pose violates a boundary, proved")
    else:
        print(f"undecided after {cells}: the poses, or a passage between them, are too tight")
