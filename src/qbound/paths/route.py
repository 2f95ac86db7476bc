"""Routes: paths along the numbered vertices or arcs of a component, with names of stops and legs.

Vertices and arcs count from 1 in the order of the component's loops, components from 0.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from qbound.arrays import Floats
from qbound.geometry import polygon
from qbound.model.robot import Robot
from qbound.paths.traversal import Leg, Traversal, follow, straight
from qbound.region import Component, Region
from qbound.region.outline import Arc
from qbound.tolerances import TOUCH

Along = Literal["lines", "arcs"]


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
    along: Along
    scale: float
    path: Traversal
    stops: tuple[str, ...]
    legs: tuple[str, ...]

    def leg_of(self, s: float) -> str:
        """Return the name of the leg at a place of the path (as in `Traversal.s`)."""
        return self.legs[min(int(s), len(self.legs) - 1)]


def plan_route(
    region: Region,
    order: Sequence[int],
    *,
    along: Along = "lines",
    component: int = 0,
    closed: bool = False,
    scale: float = 1.0,
    deviation: float | None = None,
) -> Route:
    """Visit vertices of a component along straight lines in joint space, or follow its arcs.

    The paper's paths are of the first kind (Figures 7 to 9).

    Parameters
    ----------
    order : sequence of int
        Numbers of vertices or arcs, from 1; -2 runs arc 2 backwards. A straight line joins arcs
        that do not meet.
    along : {"lines", "arcs"}
    component : int
        Whose they are, from 0.
    closed : bool
        Whether to return to the start.
    scale : float
        Of the vertices, about the centroid of their polygon; of arcs 1 only.
    deviation : float, optional
        As `follow` takes it; default: a ten-thousandth of the stretched arm.

    Raises
    ------
    ValueError
        If a number is of no component, vertex or arc, there are too few of them, `along` is
        neither, arcs are to be scaled, or the scale or the deviation is not above zero.

    Examples
    --------
    >>> from qbound import find_region, load_robot
    >>> region = find_region(load_robot("minervabot-v2"))
    >>> plan_route(region, [1, 2, 3], closed=True, scale=0.9).legs
    ('1 to 2', '2 to 3', '3 to 1')
    >>> plan_route(region, [1, -4], along="arcs").legs
    ('arc 1', 'line to arc 4', 'arc 4 backwards')
    """
    chosen, robot = nth_component(region, component), region.robot
    if along == "lines":
        visited = [*order, *order[:1]] if closed else list(order)
        _refuse_unknown(order, len(chosen.vertices), "vertex", component)
        named = list(_lines(region, visited, chosen, scale))
        stops = map(str, visited)
    elif along == "arcs":
        arcs = [arc for loop in chosen.loops for arc in loop]
        _refuse_unknown([abs(number) for number in order], len(arcs), "arc", component)
        if scale != 1:
            raise ValueError("a scale is of vertices: a scaled arc is none of the region's")
        legs = [_arc_leg(region, arcs[abs(number) - 1], number < 0) for number in order]
        named = list(_joined(robot, order, legs, closed))
        stops = map(str, range(1, len(named) + 2))
    else:
        raise ValueError(f"no way along {along!r}; there are lines and arcs")
    if deviation is None:
        deviation = 1e-4 * robot.stretched(robot.tool) or 1e-4
    path = follow(robot, [leg for _, leg in named], deviation)
    names = tuple(name for name, _ in named)
    return Route(region, component, tuple(order), along, scale, path, tuple(stops), names)


def nth_component(region: Region, k: int) -> Component:
    """Return a component by its number, from 0 as in the JSON."""
    count = len(region.components)
    if not 0 <= k < count:
        raise ValueError(f"no component {k}; there are {count}, numbered from 0")
    return region.components[k]


def _lines(
    region: Region, order: Sequence[int], component: Component, scale: float
) -> Iterator[tuple[str, Leg]]:
    """Go straight from vertex to vertex, scaled about the centroid of their polygon."""
    if len(order) < 2:
        raise ValueError("a path needs two vertices or more")
    if not scale > 0:
        raise ValueError(f"a scale must be above 0, found {scale:g}")
    corners = np.array([vertex.q for vertex in component.vertices])
    if scale != 1:
        corners = polygon.scaled(corners, scale, polygon.centroid(corners))
    q = region.robot.with_held(corners, region.problem.held)
    for a, b in pairwise(order):
        yield f"{a} to {b}", straight(region.robot, q[a - 1], q[b - 1])


def _joined(
    robot: Robot, order: Sequence[int], legs: Sequence[Leg], closed: bool
) -> Iterator[tuple[str, Leg]]:
    """Put a straight line between arcs that do not meet; a closed path ends where it began."""
    if not legs:
        raise ValueError("a path needs an arc or more")
    ends = [(_place(leg, 0.0), _place(leg, 1.0)) for leg in legs]
    here = first = ends[0][0]
    for number, leg, (start, end) in zip(order, legs, ends, strict=True):
        if np.abs(start - here).max() > TOUCH:
            yield f"line to arc {abs(number)}", straight(robot, here, start)
        yield f"arc {abs(number)}" + " backwards" * (number < 0), leg
        here = end
    if closed and np.abs(first - here).max() > TOUCH:
        yield "line to the start", straight(robot, here, first)


def _arc_leg(region: Region, arc: Arc, backwards: bool) -> Leg:
    def at(s: Floats) -> Floats:
        q = arc.at(1 - s if backwards else s)
        return region.robot.with_held(q, region.problem.held)

    return Leg(at, parts=len(arc.pieces.roots))


def _place(leg: Leg, s: float) -> Floats:
    return np.asarray(leg.at(np.array([s]))[0])


def _refuse_unknown(numbers: Sequence[int], count: int, what: str, component: int) -> None:
    for number in numbers:
        if not 1 <= number <= count:
            there = f"it has {count}, numbered from 1" if count else f"it has no {what}"
            raise ValueError(f"no {what} {number} in component {component}: {there}")
