"""Routes: paths along the numbered vertices or arcs of a component, with names of stops and legs.

Vertices and arcs count from 1 in the order of the component's loops, components from 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from qbound.geometry import polygon
from qbound.model.robot import Robot
from qbound.paths.traversal import Leg, Traversal, follow, straight
from qbound.region import Component, Region
from qbound.region.arcs import Arc
from qbound.tolerances import TOUCH

Floats = NDArray[np.float64]
NamedLegs = list[tuple[str, Leg]]


@dataclass(frozen=True, eq=False)
class Route:
    """A path with what it was asked to be, and the names of its stops and legs.

    Attributes
    ----------
    region : Region
    component : int
        Whose vertices or arcs it visits.
    order : tuple of int
        Their numbers.
    along : {"lines", "arcs"}
    scale : float
        Of the vertices, about their polygon's centroid.
    path : Traversal
    stops, legs : tuple of str
        Names: numbers of vertices, or of the visit; ``3 to 4`` or ``arc 2``.
    """

    region: Region
    component: int
    order: tuple[int, ...]
    along: Literal["lines", "arcs"]
    scale: float
    path: Traversal
    stops: tuple[str, ...]
    legs: tuple[str, ...]

    def leg_of(self, s: float) -> str:
        """Return the name of the leg at a place of the path (as in `Traversal.s`)."""
        return self.legs[min(int(s), len(self.legs) - 1)]


def route_along_vertices(
    region: Region,
    order: Sequence[int],
    *,
    component: int = 0,
    closed: bool = False,
    scale: float = 1.0,
    deviation: float | None = None,
) -> Route:
    """Visit vertices of a component along straight lines in joint space (Figures 7 to 9).

    Parameters
    ----------
    order : sequence of int
        Numbers of vertices, from 1.
    closed : bool
        Whether to return to the first vertex.
    scale : float
        Of the vertices, about the centroid of their polygon.
    deviation : float, optional
        As `follow` takes it; default: a ten-thousandth of the stretched arm.

    Raises
    ------
    ValueError
        If a number is of no component or vertex, there are fewer than two, or the scale or the
        deviation is not above zero.
    """
    vertices = nth_component(region, component).vertices
    _refuse_unknown(order, len(vertices), "vertex", component)
    visited = [*order, *order[:1]] if closed else list(order)
    if len(visited) < 2:
        raise ValueError("a path needs two vertices or more")
    if not scale > 0:
        raise ValueError(f"a scale must be above 0, found {scale:g}")
    corners = np.array([vertex.q for vertex in vertices])
    if scale != 1:
        corners = polygon.scaled(corners, scale, polygon.centroid(corners))
    robot = region.robot
    q = robot.with_held(corners, region.problem.held)
    named = [(f"{a} to {b}", straight(robot, q[a - 1], q[b - 1])) for a, b in pairwise(visited)]
    names, path = _followed(robot, named, deviation)
    stops = tuple(map(str, visited))
    return Route(region, component, tuple(order), "lines", scale, path, stops, names)


def route_along_arcs(
    region: Region,
    order: Sequence[int],
    *,
    component: int = 0,
    closed: bool = False,
    deviation: float | None = None,
) -> Route:
    """Follow arcs of a component; a straight line joins two that do not meet.

    Parameters
    ----------
    order : sequence of int
        Numbers of arcs, from 1; -2 runs arc 2 backwards.
    component, closed, deviation
        As for `route_along_vertices`.

    Raises
    ------
    ValueError
        If a number is of no component or arc, there is none, or the deviation is not above zero.
    """
    arcs = [arc for loop in nth_component(region, component).loops for arc in loop]
    if not order:
        raise ValueError("a path needs an arc or more")
    _refuse_unknown([abs(number) for number in order], len(arcs), "arc", component)
    robot, held = region.robot, region.problem.held
    legs = [_arc_leg(robot, held, arcs[abs(number) - 1], number < 0) for number in order]
    names, path = _followed(robot, list(_joined(robot, order, legs, closed)), deviation)
    stops = tuple(str(number) for number in range(1, len(names) + 2))
    return Route(region, component, tuple(order), "arcs", 1.0, path, stops, names)


def nth_component(region: Region, k: int) -> Component:
    """Return a component by its number, from 0 as in the JSON."""
    count = len(region.components)
    if not 0 <= k < count:
        raise ValueError(f"no component {k}; there are {count}, numbered from 0")
    return region.components[k]


def stretched_length(robot: Robot) -> float:
    """Return the length of the arm stretched out: all links, longest slides, and the tool."""
    links = [float(np.linalg.norm(joint.origin)) for joint in robot.joints]
    slides = [max(map(abs, j.limits)) for j in robot.joints if j.kind == "prismatic" and j.limits]
    return sum(links) + sum(slides) + float(np.linalg.norm(robot.point(robot.tool).at))


def _followed(
    robot: Robot, named: NamedLegs, deviation: float | None
) -> tuple[tuple[str, ...], Traversal]:
    """Return the names of the legs and the path along them."""
    if deviation is None:
        deviation = 1e-4 * stretched_length(robot) or 1e-4
    path = follow(robot, [leg for _, leg in named], deviation)
    return tuple(name for name, _ in named), path


def _joined(
    robot: Robot, order: Sequence[int], legs: Sequence[Leg], closed: bool
) -> Iterator[tuple[str, Leg]]:
    """Put a straight line between arcs that do not meet; a closed path ends where it began."""
    ends = [(_place(leg, 0.0), _place(leg, 1.0)) for leg in legs]
    here = first = ends[0][0]
    for number, leg, (start, end) in zip(order, legs, ends, strict=True):
        if np.abs(start - here).max() > TOUCH:
            yield f"line to arc {abs(number)}", straight(robot, here, start)
        yield f"arc {abs(number)}" + " backwards" * (number < 0), leg
        here = end
    if closed and np.abs(first - here).max() > TOUCH:
        yield "line to the start", straight(robot, here, first)


def _arc_leg(robot: Robot, held: Mapping[int, float], arc: Arc, backwards: bool) -> Leg:
    def at(s: Floats) -> Floats:
        return robot.with_held(arc.at(1 - s if backwards else s), held)

    return Leg(at, parts=len(arc.pieces.roots))


def _place(leg: Leg, s: float) -> Floats:
    return np.asarray(leg.at(np.array([s]))[0])


def _refuse_unknown(numbers: Sequence[int], count: int, what: str, component: int) -> None:
    for number in numbers:
        if not 1 <= number <= count:
            there = f"it has {count}, numbered from 1" if count else f"it has no {what}"
            raise ValueError(f"no {what} {number} in component {component}: {there}")
