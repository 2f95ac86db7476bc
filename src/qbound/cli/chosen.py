"""What several commands choose alike: rule, slice, component; and the region that they mean."""

from __future__ import annotations

import argparse
from dataclasses import replace

from qbound.export.polygons import from_lowest
from qbound.model.robot import Robot
from qbound.region import paper_rule
from qbound.region.region import Region, find_region, solve


def add_robot(parser: argparse.ArgumentParser) -> None:
    """Add the robot."""
    parser.add_argument("robot", help="a robot file, or a packaged robot's name")


def add_rule(parser: argparse.ArgumentParser) -> None:
    """Add the rule."""
    parser.add_argument(
        "--rule",
        choices=("clearance", "paper"),
        default="clearance",
        help="clearance: every boundary keeps its distance (default); paper: windows of Table 6",
    )


def add_slice(parser: argparse.ArgumentParser) -> None:
    """Add the slice."""
    parser.add_argument(
        "--slice", nargs="+", default=[], metavar="q3=20deg", help="hold joints at values"
    )


def region_by_rule(robot: Robot, rule: str, values: dict[int, float]) -> Region:
    """Find the region by a rule; loops and vertices begin at the lowest vertex."""
    if rule == "clearance":
        region = find_region(robot, values)
    elif values:
        raise ValueError("--slice: the paper's rule knows two joints only")
    else:
        region = solve(paper_rule.problem(robot), robot.home)
    return replace(region, components=tuple(map(from_lowest, region.components)))
