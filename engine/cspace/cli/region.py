"""``cspace region``: all regions of two joints, on the screen, as JSON, polygons, a picture.

With ``--strip`` a third joint goes through several values: a row of regions, a panel each.
"""

import argparse
from collections.abc import Iterator
from functools import cache, partial
from typing import Any

from cspace.arms.links import unchecked_lines
from cspace.cli import chosen
from cspace.cli.terminal import Output, deliver, progress_line
from cspace.cli.values import held, strip
from cspace.export.document import slices_document
from cspace.export.formats import json_text
from cspace.export.outlines import find_outlines, outlines_csv, outlines_geojson, outlines_npz
from cspace.model.robot import Robot
from cspace.region import Region, Slices, find_slices
from cspace.units import counted, joint_text


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "region",
        help="all regions of two joints",
        epilog="exit status: 0 home is in a component, 1 it is in none (with --strip: every slice\n"
        "is empty), 3 it is unresolved; 2 bad input\n"
        "example: cspace region minervabot-v2 --json -",
    )
    chosen.add_robot(parser)
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    parser.add_argument("--svg", metavar="FILE", help="draw the components")
    parser.add_argument("--csv", metavar="FILE", help="write polygons, a row a corner")
    parser.add_argument("--geojson", metavar="FILE", help="write polygons as GeoJSON has them")
    parser.add_argument("--npz", metavar="FILE", help="write polygons as NumPy arrays")
    parser.add_argument(
        "--deviation",
        type=float,
        default=0.001,
        metavar="D",
        help="largest distance of polygons from the exact arcs, joint units (default 0.001)",
    )
    chosen.add_slice(parser)
    parser.add_argument(
        "--strip",
        metavar="q3[=LOW..HIGH:COUNT]",
        help="a region for each of so many values of a third joint, as q3=-90deg..90deg:9 (q3"
        " alone: 25 over its range), --slice holding the others; --svg draws a strip of panels,"
        " --json has them all",
    )
    chosen.add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Find the region; return 1 if home is in none of its components, 3 if it is unresolved.

    For a strip: return 1 if every slice is empty, 3 if one is unresolved.
    """
    robot = chosen.sized_robot(options)
    if options.strip is not None:
        return _strip(robot, options)
    region = chosen.region_of(robot, held(robot, options.slice))
    drawn = cache(partial(find_outlines, region, options.deviation))
    outputs: list[Output] = [
        (options.svg, lambda: _draw(region)),
        (options.csv, lambda: outlines_csv(drawn())),
        (options.geojson, lambda: json_text(outlines_geojson(drawn()), None)),
        (options.npz, lambda: outlines_npz(drawn())),
        (options.json, lambda: json_text(region.to_dict())),
    ]
    deliver(outputs, _lines(region))
    if region.unresolved:
        return 3
    return 0 if region.has_home else 1


def _strip(robot: Robot, options: argparse.Namespace) -> int:
    """Find, write and list the slices of a strip."""
    polygons = next((name for name in ("csv", "geojson", "npz") if getattr(options, name)), None)
    if polygons is not None:
        raise ValueError(f"--{polygons}: polygons are of one region; leave out --strip, or --json")
    fixed = held(robot, options.slice)
    along, values = strip(robot, options.strip, fixed)
    slices = find_slices(robot, along, values, fixed, progress_line("slices", len(values)))
    outputs: list[Output] = [
        (options.svg, lambda: _draw_strip(slices)),
        (options.json, lambda: json_text(slices_document(slices))),
    ]
    deliver(outputs, _strip_lines(slices))
    if any(region.unresolved for region in slices.regions):
        return 3
    return 0 if slices.areas.any() else 1


def _strip_lines(slices: Slices) -> Iterator[str]:
    unit = slices.regions[0].area_unit
    by = slices.robot.feasible_by
    for k, (value, region) in enumerate(zip(slices.values, slices.regions, strict=True)):
        where = joint_text(slices.robot, [value], [slices.along])
        if region.unresolved:
            yield f"{where}: unresolved: {'; '.join(region.unresolved)}"
            continue
        home = ", home lies here" if slices.holds_home(k) and region.has_home else ""
        if region.components:
            parts = counted(len(region.components), "component")
            yield f"{where}: area {region.area:.9g} {unit}, {parts}, feasible by {by}{home}"
        else:
            yield f"{where}: no room is left by {', '.join(region.empty_because)}"
    yield from unchecked_lines(slices.robot)


def _lines(region: Region) -> Iterator[str]:
    unit = region.area_unit
    if region.unresolved:
        yield f"this region is unresolved: {'; '.join(region.unresolved)}"
        return
    yield from chosen.home_lines(region)
    if not region.components:
        yield f"no component: no room is left by {', '.join(region.empty_because)}"
    parts = counted(len(region.components), "component")
    by = region.robot.feasible_by
    yield f"{parts}, area {region.area:.9g} {unit} in all, feasible by {by}"
    home = "home's values of these joints" if chosen.is_elsewhere(region) else "the home pose"
    for component in region.components:
        home_too = f", with {home}" if component.contains_home else ""
        corners = counted(len(component.vertices), "vertex", "vertices")
        yield f"  area {component.area:.9g} {unit}, {corners}{home_too}"
    yield from unchecked_lines(region.robot)


def _draw(region: Region) -> bytes:
    from cspace.figures.pictures import region_picture

    return region_picture(region)


def _draw_strip(slices: Slices) -> bytes:
    from cspace.figures.pictures import strip_picture

    return strip_picture(slices)
