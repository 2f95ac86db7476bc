"""``qbound surface``: the boundary of a region of three joints, as a picture, a page or a mesh."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np

from qbound.arms.surfaces import RESOLUTION, Surface, find_surface, glb_bytes, ply_bytes
from qbound.cli.chosen import add_memory, add_robot, add_slice, sized_robot
from qbound.cli.terminal import Content, check_targets, complain, deliver, working
from qbound.cli.values import held, joint
from qbound.printable import printable
from qbound.units import counted


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "surface",
        help="where safe values of three joints end: a page to turn, a picture, a mesh",
        description="Find the surface that bounds the safe values of three joints, each triangle\n"
        "named by the links that touch there. The ending of the file says what is made: .html (a\n"
        "page to turn by hand), .svg or .png, .ply or .glb. Joints that are neither an axis nor\n"
        "held are at home. What is smaller than a step of the grid may be missing.",
        epilog="exit status: 0 made, 1 nothing is feasible within the ranges; 2 bad input\n"
        "needs qbound[arms], and qbound[figures] for .svg and .png\n"
        "example: qbound surface ur5 --joints shoulder_lift_joint elbow_joint"
        " wrist_1_joint --resolution 20 -o ur5.html",
    )
    add_robot(parser)
    parser.add_argument(
        "--joints", nargs=3, required=True, metavar="JOINT", help="the three axes, by name or index"
    )
    add_slice(parser)
    parser.add_argument(
        "--resolution",
        type=int,
        default=RESOLUTION,
        metavar="N",
        help=f"steps of the grid along each joint (default {RESOLUTION})",
    )
    parser.add_argument(
        "--caps", action="store_true", help="close the surface at joint limits, as a solid"
    )
    parser.add_argument(
        "-o",
        metavar="FILE",
        dest="output",
        help=f"one of {', '.join(f'.{kind}' for kind in KINDS)}",
    )
    add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Find the surface; return 0 if it is made, 1 if nothing is feasible within the ranges."""
    check_targets([options.output], tuple(KINDS))
    robot = sized_robot(options)
    values = held(robot, options.slice)
    axes = [joint(robot, text) for text in options.joints]
    with working("surface"):
        surface = find_surface(
            robot, axes, values, resolution=options.resolution, caps=options.caps
        )
    if not len(surface.triangles):
        where = "every" if surface.feasible_part > 0 else "no"
        complain(f"{where} configuration of the grid is feasible: there is no surface")
        return 0 if surface.feasible_part > 0 else 1
    kind = Path(options.output or "").suffix.removeprefix(".").lower()
    deliver([(options.output, lambda: KINDS[kind](surface))], _lines(surface))
    return 0


def _lines(surface: Surface) -> list[str]:
    """Yield the size of the surface, and the boundaries that it lies on."""
    areas = np.bincount(surface.pair, surface.areas)
    counts = counted(len(surface.triangles), "triangle")
    rough = int((~surface.exact).sum())
    vertices = counted(len(surface.vertices), "vertex", "vertices")
    left = f"all but {rough} on their boundary" if rough else "each on its boundary"
    parts = [
        f"{100 * area / areas.sum():5.1f} %  {printable(name)}"
        for name, area in zip(surface.pairs, areas, strict=True)
    ]
    return [f"{counts}; {vertices}, {left} to 12 digits", *parts]


def _page(surface: Surface) -> Content:
    from qbound.explorer.surface_page import surface_page

    return surface_page(surface)


def _picture(kind: str) -> Callable[[Surface], Content]:
    def picture(surface: Surface) -> Content:
        from qbound.figures.surfaces import surface_picture

        return surface_picture(surface, kind)

    return picture


KINDS: Final[dict[str, Callable[[Surface], Content]]] = {
    "html": _page,
    "svg": _picture("svg"),
    "png": _picture("png"),
    "ply": ply_bytes,
    "glb": glb_bytes,
}
"""What is made, by the ending of the file."""
