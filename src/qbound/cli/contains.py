"""``qbound contains``: tell whether a configuration is safe."""

from __future__ import annotations

import argparse
from typing import Any

from qbound.cli.values import configuration
from qbound.region import violated
from qbound.robotfile import load_robot


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "contains",
        help="is a configuration safe?",
        epilog="example: qbound contains minervabot-v2 20deg -45deg",
    )
    parser.add_argument("robot", help="a robot file, or a packaged robot's name")
    parser.add_argument("values", nargs="+", metavar="VALUE", help="20deg, 0.35rad, or a length")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Say what the configuration violates; 1 if anything."""
    robot = load_robot(options.robot)
    found = violated(robot, configuration(robot, options.values))
    for name, margin in found:
        print(f"violated: {name}, margin {margin:.6g}")
    if not found:
        print("feasible")
    return 1 if found else 0
