"""``cspace explore``: a page in which one drags the arm through its region."""

import argparse
from typing import Any

from cspace.arms.links import unchecked_lines
from cspace.cli import chosen
from cspace.cli.terminal import complain, deliver, progress_line
from cspace.cli.values import held, strip
from cspace.explorer.page import explorer_page
from cspace.model.robot import Robot
from cspace.region import Slices, find_slices
from cspace.tolerances import SAME_POINT


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "explore",
        help="a page to drag the arm through its region",
        description="Write one HTML file, for any browser, without a network. Of more than two\n"
        "joints, those that --slice does not hold move; without --slice\n"
        "every joint after the second is held at home.",
        epilog="exit status: 0 made, 1 home is in no component, 3 the region is unresolved;\n"
        "2 bad input\n"
        "example: cspace explore minervabot-v2 -o minervabot.html",
    )
    chosen.add_robot(parser)
    parser.add_argument("-o", metavar="FILE", dest="output", required=True, help="the page")
    chosen.add_slice(parser)
    parser.add_argument(
        "--strip",
        metavar="q3[=LOW..HIGH:COUNT]",
        help="a held joint whose slider shows exact slices: so many values (25 over its range)",
    )
    chosen.add_memory(parser)
    parser.set_defaults(run=run, endings=("html", "htm"))


def run(options: argparse.Namespace) -> int:
    """Write the page; return 1 if the home pose is in no component."""
    robot = chosen.sized_robot(options)
    values = (
        held(robot, options.slice)
        if options.slice
        else dict(enumerate(robot.home.tolist()[2:], start=2))
    )
    row = None if options.strip is None else _row(robot, options, values)
    region = chosen.region_of(robot, values)
    deliver([(options.output, lambda: explorer_page(region, row=row))], unchecked_lines(robot))
    if not region.has_home:
        for line in chosen.home_lines(region):
            complain(line)
        complain("home is in no component, so the page opens with an arm that is not feasible")
    return 0 if region.has_home else 1


def _row(robot: Robot, options: argparse.Namespace, values: dict[int, float]) -> Slices:
    """Find the slices along a joint, including the slice that the page shows first.

    The joint is removed from the held joints. The page opens at its held value, or at home.
    """
    along, shown = strip(robot, options.strip, {})
    opened = values.setdefault(along, float(robot.home[along]))
    others = {j: value for j, value in values.items() if j != along}
    shown = sorted([*(q for q in shown if abs(q - opened) > SAME_POINT), opened])
    return find_slices(robot, along, shown, others, progress_line("slices", len(shown)))
