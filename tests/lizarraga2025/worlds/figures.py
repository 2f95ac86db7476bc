"""Worlds in which the entries of ``statements/figures.toml`` come to other verdicts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from cspace.model.robot import Polygon
from lizarraga2025 import printed as paper
from lizarraga2025.evidence import arms
from support.worlds import World, robot_file, with_boundaries, with_points, world
from worlds.sentences import NEVER_SYMMETRIC, ONE_ASPECT, path_of_slides


def floor_at(height: float) -> World:
    """Return the world of a robot with its floor elsewhere."""
    return world(robots={"minervabot-v2": with_boundaries(robot_file(), B7={"offset": height})})


def labels_read_backwards() -> Any:
    """Return the arm with symbols, R_{a,b} taken for R_{b,a}."""
    arm, values = arms.with_symbols(robot_file()), arms.offset_values(robot_file())

    def frames(q: Any) -> SimpleNamespace:
        found = arm.frames(q)
        turned_back = lambda a, b: found.rotation(b, a)  # noqa: E731
        return SimpleNamespace(rotation=turned_back, position=found.position)

    return SimpleNamespace(frames=frames), values


def with_tool_on_link_1() -> World:
    """Return the world in which the tool is a point of link 1."""
    points = (replace(p, frame="1") if p.name == "3" else p for p in robot_file().points)
    return world(robots={"minervabot-v2": replace(robot_file(), points=tuple(points))})


def with_a_wider_base() -> World:
    """Return the world in which the body of the base is wider than its points."""
    base, *others = robot_file().bodies
    wider = replace(base, shape=Polygon(base.shape.corners * [1.2, 1.0, 1.0]))
    return world(robots={"minervabot-v2": replace(robot_file(), bodies=(wider, *others))})


def named_in_figure_4(old: str, new: str) -> World:
    """Return the world in which the caption of Figure 4 names another bound."""
    labels = tuple(label.replace(old, new) for label in paper.FIGURE_4_BOUNDS)
    assert labels != paper.FIGURE_4_BOUNDS
    return world(printed={"FIGURE_4_BOUNDS": labels})


four_corners = floor_at(-100.0)

WORLDS: dict[str, World] = {
    "F-1": world(replaced={"lizarraga2025.evidence.arms.symbolic_robot": labels_read_backwards}),
    "F-2": world(
        robots={"minervabot-v2": with_boundaries(robot_file(), B1={"points": ("6", "11")})}
    ),
    "F-2.1": world(printed={"CAPTIONS": {2: "an isometric view of a planar robot"}}),
    "F-3": with_tool_on_link_1(),
    "F-4.1": named_in_figure_4("{1,3,1}", "{1,1,1}"),
    "F-4.2": named_in_figure_4("{3,3,2}", "{3,3,1}"),
    "F-4.3": named_in_figure_4("{1,3,1}", "{1,1,1}"),
    "F-4.4": world(robots={"minervabot-v2": with_points(robot_file(), p11=(9.09, 0.0, -5.5))}),
    "F-5.1": four_corners,
    "F-5.2": four_corners,
    "F-6.1": world(
        robots={"minervabot-v2": with_boundaries(robot_file("minervabot-v2"), B7={"offset": 30.0})}
    ),
    "F-6.2": four_corners,
    "F-6.3": with_a_wider_base(),
    "F-6.4": world(printed={"SCALING": {"factor": 0.9, "centroid": "area"}}),
    "F-6.5": world(printed={"ORDERS": {6: (1, 2, 3, 4, 5, 6, 1)}}),
    "F-7.1": world(replaced={"lizarraga2025.evidence.tool_paths.path_through": path_of_slides}),
    "F-7.2": world(printed={"ORDERS": {7: (1, 2, 3, 4, 5, 6, 1)}}),
    "F-8.1": world(printed={"ORDERS": {8: (6, 1, 2, 3, 4)}}),
    "F-8.2": four_corners,
    "F-8.3": world(printed={"ORDERS": {8: (6, 1, 2, 3, 4)}}),
    "F-9": world(printed={"ORDERS": {9: (1, 4, 2, 5, 3)}}),
    "F-9.1": world(printed={"ORDERS": {8: (6, 1, 2, 3, 4), 9: (3, 4, 5, 6, 1)}}),
    "F-10.1": world(robots={"minervabot-v2": robot_file("minervabot-v2-symmetric")}),
    "F-10.2": world(replaced={"qbound.polygon.centroid": lambda vertices: vertices[0]}),
    "F-10.3": NEVER_SYMMETRIC,
    "F-11.1": world(printed={"SAMPLES": {"test": "windows of Table 6"}}),
    "F-11.2": world(printed={"SAMPLES": {"test": "the tool's limit alone, eq. (12)"}}),
    "F-11.3": ONE_ASPECT,
    "F-11.5": world(printed={"SAMPLES": {"number": 10_000, "range": "one turn"}}),
}
