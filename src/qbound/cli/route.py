"""From numbers of vertices or arcs to a path: what ``qbound traverse`` is asked for."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from qbound.cli.chosen import component_of, region_by_rule
from qbound.cli.values import held
from qbound.geometry import polygon
from qbound.model.robot import Robot
from qbound.paths.traversal import Leg, Traversal, follow, straight
from qbound.region import Component, Region
from qbound.region.arcs import Arc
from qbound.tolerances import TOUCH

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Route:
    """A path with the names of its stops and legs.

    Attributes
    ----------
    walk : Traversal
    region : Region
    held : dict of int to float
        Joints that do not move, and their values.
    stops, legs : list of str
        Names: numbers of vertices, or of the visit; ``3 to 4`` or ``arc 2``.
    """

    walk: Traversal
    region: Region
    held: dict[int, float]
    stops: list[str]
    legs: list[str]

    def leg_of(self, s: float) -> str:
        """Return the name of the leg at a place of the path."""
        return self.legs[min(int(s), len(self.legs) - 1)]

    def where(self, s: float) -> str:
        """Return the leg for a reader."""
        return f"on {self.leg_of(s)}"


def plan(robot: Robot, options: argparse.Namespace) -> Route:
    """Find the region, look the numbers up, and go."""
    values = held(robot, options.slice)
    deviation = default_deviation(robot) if options.deviation is None else options.deviation
    region = region_by_rule(robot, options.rule, values)
    component = component_of(region, options.component)
    make = _along_arcs if options.arcs else _along_lines
    stops, named = make(robot, component, values, options)
    names, legs = [name for name, _ in named], [leg for _, leg in named]
    return Route(follow(robot, legs, deviation), region, values, stops, names)


def default_deviation(robot: Robot) -> float:
    """Return a ten-thousandth of the stretched arm: all links and longest slides; length."""
    links = [float(np.linalg.norm(joint.origin)) for joint in robot.joints]
    slides = [
        max(map(abs, joint.limits))
        for joint in robot.joints
        if joint.kind == "prismatic" and joint.limits
    ]
    tool = float(np.linalg.norm(robot.point(robot.tool).at))
    return 1e-4 * (sum(links) + sum(slides) + tool) or 1e-4


def _along_lines(
    robot: Robot, component: Component, values: dict[int, float], options: argparse.Namespace
) -> tuple[list[str], list[tuple[str, Leg]]]:
    """Straight from vertex to vertex."""
    order = [*options.order, options.order[0]] if options.closed else options.order
    corners = np.array([vertex.q for vertex in component.vertices]).reshape(-1, 2)
    _refuse_unknown(order, len(corners), "vertex", options.component)
    if len(order) < 2:
        raise ValueError("a path needs two vertices or more")
    if not options.scale > 0:
        raise ValueError(f"--scale {options.scale:g}: a scale is above 0")
    if options.scale != 1:
        corners = polygon.scaled(corners, options.scale, polygon.centroid(corners))
    q = robot.with_held(corners, values)
    legs = [(f"{a} to {b}", straight(robot, q[a - 1], q[b - 1])) for a, b in pairwise(order)]
    return [str(number) for number in order], legs


def _along_arcs(
    robot: Robot, component: Component, values: dict[int, float], options: argparse.Namespace
) -> tuple[list[str], list[tuple[str, Leg]]]:
    """Along the arcs, from the end of each straight to the start of the next if they are apart."""
    if options.scale != 1:
        raise ValueError("--scale and --arcs: a scaled arc is none of the region's")
    order: list[int] = options.order
    arcs = [arc for loop in component.loops for arc in loop]
    _refuse_unknown([abs(number) for number in order], len(arcs), "arc", options.component)
    legs = [_arc_leg(robot, values, arcs[abs(number) - 1], number < 0) for number in order]
    named = list(_joined(robot, order, legs, options.closed))
    return [str(number) for number in range(1, len(named) + 2)], named


def _joined(
    robot: Robot, order: Sequence[int], legs: Sequence[Leg], closed: bool
) -> Iterator[tuple[str, Leg]]:
    """Put a straight line between arcs that do not meet; a closed path ends where it began."""
    here, first = _place(legs[0], 0.0), _place(legs[0], 0.0)
    for number, leg in zip(order, legs, strict=True):
        start = _place(leg, 0.0)
        if np.abs(start - here).max() > TOUCH:
            yield f"line to arc {abs(number)}", straight(robot, here, start)
        yield f"arc {abs(number)}" + " backwards" * (number < 0), leg
        here = _place(leg, 1.0)
    if closed and np.abs(first - here).max() > TOUCH:
        yield "line to the start", straight(robot, here, first)


def _arc_leg(robot: Robot, values: dict[int, float], arc: Arc, backwards: bool) -> Leg:
    def at(s: Floats) -> Floats:
        return robot.with_held(arc.at(1 - s if backwards else s), values)

    return Leg(at, parts=len(arc.pieces.roots))


def _place(leg: Leg, s: float) -> Floats:
    return np.asarray(leg.at(np.array([s]))[0])


def _refuse_unknown(order: Sequence[int], count: int, what: str, component: int) -> None:
    for number in order:
        if not 1 <= number <= count:
            there = f"it has {count}, numbered from 1" if count else f"it has no {what}"
            raise ValueError(f"no {what} {number} in component {component}: {there}")
