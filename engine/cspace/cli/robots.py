"""``cspace robots``: the packaged robots."""

import argparse
from typing import Any

from cspace.cli.terminal import say
from cspace.model.robotfile import packaged_robots, robot_text


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "robots",
        help="the packaged robots",
        epilog="exit status: 0 printed; 2 bad input\nexample: cspace robots show minervabot-v2",
    )
    parser.add_argument("show", nargs="?", choices=("show",))
    parser.add_argument("name", nargs="?")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """List the robots, or print the file of one."""
    if options.show is None:
        say(*packaged_robots())
        return 0
    if options.name is None:
        raise ValueError(f"show: name one of {', '.join(packaged_robots())}")
    if options.name not in packaged_robots():
        raise ValueError(f"no robot {options.name!r}; there are {', '.join(packaged_robots())}")
    say(*robot_text(options.name)[0].splitlines())
    return 0
