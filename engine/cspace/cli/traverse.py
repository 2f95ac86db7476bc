"""``cspace traverse``: vertices or arcs in an order; what the path meets; the path as files."""

import argparse
from typing import Any

from cspace.arms.links import link_pair, unchecked_lines
from cspace.cli import chosen
from cspace.cli.terminal import Output, complain, deliver
from cspace.cli.values import held
from cspace.export.formats import json_text
from cspace.export.routes import infeasible_line, route_csv, route_document, route_lines
from cspace.figures.pictures import traversal_picture
from cspace.model.rows import LARGEST
from cspace.paths.traversal import plan_route, report

MOST_LISTED = 24
"""Margins above which those of balls are summed up by their links."""


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "traverse",
        help="visit vertices or arcs of a region in an order",
        description="Visit vertices of a component along straight lines in joint space, or follow\n"
        "its arcs. Vertices and arcs count from 1; `cspace draw` shows the numbers of vertices.\n"
        "A path that leaves the region is written, too: the status is 1, and a line says so.",
        epilog="exit status: 0 the path stays in the region, 1 it leaves it, 3 the region is\n"
        "unresolved; 2 bad input\n"
        "example: cspace traverse minervabot-v2 1 2 3 4 5 6 --scale 0.9 --csv path.csv\n"
        "example: cspace traverse minervabot-v2 --arcs 4 -1 --svg path.svg",
    )
    chosen.add_robot(parser)
    parser.add_argument("order", nargs="+", type=int, metavar="ORDER", help="numbers, from 1")
    parser.add_argument(
        "--component", type=int, default=0, metavar="K", help="from 0, as in the JSON (default 0)"
    )
    parser.add_argument(
        "--arcs",
        action="store_true",
        help="numbers are of arcs; -2 runs arc 2 backwards; lines join arcs that do not meet",
    )
    parser.add_argument("--closed", action="store_true", help="return to the start")
    parser.add_argument(
        "--scale", type=float, default=1.0, metavar="S", help="of the vertices, about the centroid"
    )
    chosen.add_slice(parser)
    parser.add_argument(
        "--deviation", type=float, metavar="D",
        help="largest distance of the tool's path from its rows, length (default: 1e-4 of the arm)",
    )  # fmt: skip
    parser.add_argument("--csv", metavar="FILE", help="write joints and tool")
    parser.add_argument("--json", metavar="FILE", help="write the report; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the path")
    chosen.add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Follow the path; return 1 if it leaves the region."""
    robot = chosen.sized_robot(options)
    if options.arcs and options.scale != 1:
        raise ValueError("--scale and --arcs: a scaled arc is none of the region's")
    if not 0 < options.scale <= LARGEST:
        raise ValueError(f"--scale {options.scale:g}: a scale is above 0, {LARGEST:g} at most")
    route = plan_route(
        chosen.region_of(robot, held(robot, options.slice)),
        options.order,
        along="arcs" if options.arcs else "lines",
        component=options.component,
        closed=options.closed,
        scale=options.scale,
        deviation=options.deviation,
    )
    found = report(route)
    outputs: list[Output] = [
        (options.csv, lambda: route_csv(route)),
        (options.svg, lambda: traversal_picture(found)),
        (options.json, lambda: json_text(route_document(found))),
    ]
    many = len(found.margins) > MOST_LISTED
    labels = {b.name: link_pair(robot, b) for b in robot.used} if many else None
    deliver(outputs, [*route_lines(found, labels), *unchecked_lines(robot)])
    if not found.feasible:
        complain(infeasible_line(found, labels))
        return 1
    return 0
