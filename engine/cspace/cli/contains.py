"""``cspace contains``: whether a configuration is feasible, by how much, and where that ends."""

import argparse
from collections.abc import Iterator, Sequence
from typing import Any

from cspace.arms.links import SPHERES_ONLY, link_pair, on_spheres, unchecked_lines
from cspace.boundary.balls import judge, judge_bytes
from cspace.cli.chosen import add_memory, add_robot, sized_robot
from cspace.cli.terminal import deliver
from cspace.cli.values import configuration
from cspace.export.configuration import configuration_document, configuration_facts
from cspace.export.formats import json_text
from cspace.model.robot import Robot
from cspace.tolerances import SAME_POINT
from cspace.units import joint_amount, joint_text, joint_units, limited_joints, margin_text

Row = tuple[str, dict[str, Any]]
"""A boundary, or a pair of links, and what is known of it."""

MOST_SHOWN = 12
"""Margins that are listed unless all of them are asked for."""


def add_to(commands: Any) -> None:
    """Describe the command."""
    parser = commands.add_parser(
        "contains",
        help="is a configuration feasible, and by how much?",
        epilog="exit status: 0 feasible, 1 a margin is negative; 2 bad input\n"
        "example: cspace contains minervabot-v2 20deg -45deg",
    )
    add_robot(parser)
    parser.add_argument(
        "values",
        nargs="+",
        metavar="VALUE",
        help="20deg, 0.35rad, a length; a plain number is in the unit of the robot file",
    )
    parser.add_argument(
        "--weights",
        nargs=2,
        type=float,
        default=[1.0, 1.0],
        metavar="W",
        help="weights of the two joints in the distance to the boundary (default 1 1)",
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help=f"list every boundary and limit; by default, of more than {MOST_SHOWN}, each pair of"
        " links once, the nearest first; find the component also where limits are many turns wide",
    )
    parser.add_argument("--json", metavar="FILE", help="write JSON; - for standard output")
    add_memory(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Print the margins of a configuration; return 1 if any is negative."""
    robot = sized_robot(options, judge_bytes)
    region = options.all or not _wide(robot)
    values = configuration(robot, options.values)
    content = configuration_facts(robot, values, options.weights, region=region)
    if on_spheres(robot, [row["boundary"] for row in content["margins"] if row["margin"] < 0]):
        content["spheres_only"] = True
    document = (options.json, lambda: json_text(configuration_document(robot, content)))
    deliver([document], _lines(robot, content, everything=options.all))
    return 0 if content["feasible"] else 1


def _wide(robot: Robot) -> list[str]:
    """Return the joints, of a robot with two, whose wide limits make its region slow to find."""
    return [joint.name for joint in robot.joints if joint.many_turns and len(robot.joints) == 2]


def _lines(robot: Robot, content: dict[str, Any], *, everything: bool) -> Iterator[str]:
    amounts = dict(_margins(robot, content))
    rows = [(item["boundary"], item) for item in content["margins"]]
    shown = rows if everything or len(rows) <= MOST_SHOWN else _nearest_of_links(robot, rows)
    violated = [row for row in shown if row[1]["margin"] < 0]
    for label, item in violated:
        yield f"violated: {label}, margin {amounts[item['boundary']]}{_features(item)}"
    if "spheres_only" in content:
        yield f"  {SPHERES_ONLY}"
    if not violated:
        yield f"feasible by {robot.feasible_by}" + _component(content)
    yield f"  at {joint_text(robot, content['q'])}"
    for label, item in shown:
        if item["margin"] >= 0:
            yield f"  margin {amounts[item['boundary']]}: {label}{_features(item)}"
    if len(shown) < len(rows):
        yield f"  the nearest of {len(rows)} boundaries and limits; --all lists every one"
    if (wide := _wide(robot)) and not everything:
        reason = f"limits of {' and '.join(wide)} are many turns wide"
        yield f"  component and nearest boundary are not looked for: {reason}; --all finds them"
    if "unresolved" in content:
        reasons = "; ".join(content["unresolved"])
        yield f"  its component is not known, because the region is unresolved: {reasons}"
    if content["nearest"]:
        yield _nearest_line(robot, content["nearest"])
    yield from unchecked_lines(robot)


def _nearest_of_links(robot: Robot, rows: Sequence[Row]) -> list[Row]:
    """Return the least margin of each pair of links, by their names: the violated, the nearest.

    The rows are by rising margin. Limits come after lengths, because their margins have another
    unit.
    """
    links = {boundary.name: link_pair(robot, boundary) for boundary in robot.used}
    limited = limited_joints(robot)
    found = dict[str, dict[str, Any]]()
    for name, item in sorted(rows, key=lambda row: row[0] in limited):
        found.setdefault(links.get(name, name), item)
    return sorted(found.items(), key=lambda row: row[1]["margin"] >= 0)[:MOST_SHOWN]


def _margins(robot: Robot, content: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield every boundary with its margin in words."""
    judged, limited = judge(robot), limited_joints(robot)
    rounding = dict(zip(judged.names, judged.margin_rounding.tolist(), strict=True))
    for item in content["margins"]:
        name, margin = item["boundary"], item["margin"]
        yield name, margin_text(robot, name, margin, limited, rounding[name])


def _features(item: dict[str, Any]) -> str:
    """Return which corners and edges of two bodies are nearest, or overlap."""
    if "features" not in item:
        return ""
    (one, other), (feature, other_feature) = item["between"], item["features"]
    if other == item["boundary"]:  # a half-space
        return f" ({feature} of {one})"
    verb = "overlaps" if item["distance"] < 0 else "is nearest to"
    return f" ({feature} of {one} {verb} {other_feature} of {other})"


def _component(content: dict[str, Any]) -> str:
    if content["components"] is None:
        return ""
    if content["component"] is None:
        touched = [item["boundary"] for item in content["margins"] if item["margin"] == 0]
        return f", but in no component: it touches {', '.join(touched)}"
    home = "with the home pose" if content["contains_home"] else "without the home pose"
    numbered = f"component {content['component']} (of {content['components']}, counted from 0)"
    return f", in {numbered}, {home}"


def _nearest_line(robot: Robot, nearest: dict[str, Any]) -> str:
    joints = zip(robot.joints, nearest["q"], strict=True)
    place = ", ".join(f"{joint.name} = {joint_amount(robot, joint, x)}" for joint, x in joints)
    distance = _distance(robot, nearest)
    feature = f" ({nearest['feature']})" if "feature" in nearest else ""
    return f"nearest boundary: {nearest['boundary']}{feature} at {place}, distance {distance}"


def _distance(robot: Robot, nearest: dict[str, Any]) -> str:
    """Write the distance in the unit of both joints, or say how their units are weighted."""
    one, other = robot.joints
    distance = nearest["distance"] if nearest["distance"] > SAME_POINT else 0.0
    if nearest["weights"] == [1.0, 1.0] and one.kind == other.kind:
        return joint_amount(robot, one, distance)
    units = zip(nearest["weights"], joint_units(robot), strict=True)
    weighted = ", ".join(f"{weight:g} a {unit}" for weight, unit in units)
    return f"{distance:.6g} (weights: {weighted})"
