"""Options that several commands share: robot and slice, and the region that they define."""

import argparse
import math
from collections.abc import Callable, Iterator
from typing import Final

from cspace.boundary.evaluator import forms_bytes, limit_names
from cspace.boundary.poses import bounded_bodies, bounds_bodies
from cspace.model.robot import Robot
from cspace.model.robotfile import as_written, is_urdf, load_robot, robot_text
from cspace.region import Region, find_region
from cspace.units import joint_text, margin_text

MEMORY: Final = 2
"""Gigabytes that a command takes without being asked to."""


CONTACT: Final = 1_200_000
"""Bytes a pair of convex parts takes in a region of a thousand obstacles; measured."""

FEWER: Final = "keep fewer pairs apart (cspace import makes fewer of them by a larger --excess)"
"""What to do about a robot of too many boundaries for its number of joints."""


def add_robot(parser: argparse.ArgumentParser) -> None:
    """Add the argument of the robot."""
    parser.add_argument(
        "robot", help="a robot file, a packaged robot's name, or a URDF, imported as by default"
    )


def add_slice(parser: argparse.ArgumentParser) -> None:
    """Add the option of the slice."""
    parser.add_argument(
        "--slice",
        nargs="+",
        action="extend",
        default=[],
        metavar="q3=20deg",
        help="hold joints at values",
    )


def region_of(robot: Robot, values: dict[int, float]) -> Region:
    """Find the region of the joints that `--slice` leaves."""
    if len(free := robot.free(values)) != 2:
        names = ", ".join(robot.joints[j].name for j in free)
        moving = f"{len(free)} that are not held ({names})"
        raise ValueError(f"a region has two joints; here are {moving}: hold all but two by --slice")
    return find_region(robot, values)


def add_memory(parser: argparse.ArgumentParser) -> None:
    """Add the option that limits the memory of a command."""
    parser.add_argument(
        "--memory",
        type=float,
        default=MEMORY,
        metavar="GB",
        help=f"most memory to use, as it is estimated before the work (default {MEMORY})",
    )


def region_bytes(robot: Robot) -> int:
    """Estimate the memory of a region, or of a slice: forms, and contacts of bodies."""
    contacts = (
        math.prod(len(body.parts) for body in bounded_bodies(robot, boundary))
        for boundary in robot.used
        if bounds_bodies(boundary)
    )
    return forms_bytes(robot) + CONTACT * sum(contacts)


def sized_robot(
    options: argparse.Namespace, estimate: Callable[[Robot], float] = region_bytes
) -> Robot:
    """Load the robot; refuse one that takes more memory than `--memory` allows."""
    robot = load_robot(options.robot)
    refuse_memory(options, estimate(robot), FEWER)
    return robot


def proved_text(name: str) -> tuple[str, str]:
    """Return the text of a robot file, or of the robot file made from a URDF, and its name."""
    if not is_urdf(name):
        return robot_text(name)
    source = as_written(load_robot(name)).source
    return source.text if source else "", name


def refuse_memory(options: argparse.Namespace, estimate: float, instead: str) -> None:
    """Refuse work that would take more memory than `--memory` allows.

    Parameters
    ----------
    estimate : float
        Bytes.
    instead : str
        Advice what to do instead, as an imperative.

    Raises
    ------
    ValueError
        If the estimate is larger than `--memory`, or `--memory` is not a positive number.
    """
    if not options.memory > 0:
        raise ValueError(f"--memory {options.memory}: a number of GB above 0 is wanted")
    needed = estimate / 1e9
    if needed > options.memory:
        size = f"{needed:.1f}" if needed >= 1 else f"{needed:.1g}"
        raise ValueError(
            f"this takes about {size} GB of memory, and --memory allows {options.memory:g};"
            f" {instead}, or allow it with --memory {math.ceil(needed)}"
        )


def home_lines(region: Region) -> Iterator[str]:
    """Yield what the home pose violates, or touches if it is feasible but in no component."""
    from cspace.export.document import home_content  # with the workspace: slow to import

    robot, limited = region.robot, region.limited
    home = home_content(region)
    beyond = {n: j for j in region.problem.held for n in limit_names(robot.joints[j].name)}
    violates = "home's values of these joints violate" if is_elsewhere(region) else "home violates"
    for item in home["violated"]:
        name = item["boundary"]
        margin = margin_text(robot, name, item["margin"], limited)
        if name in beyond:
            held = joint_text(robot, [region.problem.held[beyond[name]]], [beyond[name]])
            yield f"the slice holds {held}, which violates {name}, margin {margin}"
        else:
            yield f"{violates} {name}, margin {margin}"
    if region.components and "touches" in home:
        yield f"home is feasible, but in no component: it touches {', '.join(home['touches'])}"


def is_elsewhere(region: Region) -> bool:
    """Tell whether a joint is held away from home."""
    home = region.robot.home
    return any(value != home[j] for j, value in region.problem.held.items())
