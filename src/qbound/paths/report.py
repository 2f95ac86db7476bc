"""What a route meets, gathered: crossings, singular poses, margins, how far the arm reaches."""

from __future__ import annotations

from dataclasses import dataclass

from qbound.paths.encounters import (
    Crossing,
    Margin,
    ParameterPoint,
    boundaries,
    least_margin,
    lowest,
    plane_of_motion,
    singular_crossings,
    tool_crossings,
)
from qbound.paths.route import Route
from qbound.paths.traversal import reach


@dataclass(frozen=True, eq=False)
class PathReport:
    """What a route meets.

    Attributes
    ----------
    route : Route
    plane : tuple of two int, or None
        Coordinates that the tool moves in; None where it keeps to no plane.
    crossings : list of Crossing, or None
        Where the tool crosses its own path; None without a plane.
    singular : list of ParameterPoint, or None
        Where the path crosses the singular curve; None where there is none.
    margins : list of Margin
        The smallest of every boundary.
    largest_reach : float
        Largest distance of the tool from the first joint's frame; length.
    farthest : ParameterPoint
        Where it has that.
    """

    route: Route
    plane: tuple[int, int] | None
    crossings: list[Crossing] | None
    singular: list[ParameterPoint] | None
    margins: list[Margin]
    largest_reach: float
    farthest: ParameterPoint

    @property
    def feasible(self) -> bool:
        """Whether the path keeps every boundary."""
        return all(margin.leaves is None for margin in self.margins)


def report(route: Route) -> PathReport:
    """Look along a route: every boundary, limit, crossing and singular pose that it meets."""
    region, robot, path = route.region, route.region.robot, route.path
    plane = plane_of_motion(robot)
    minus_reach, farthest = lowest(path, lambda q: -reach(robot, q))
    return PathReport(
        route,
        plane,
        None if plane is None else tool_crossings(robot, path, plane),
        singular_crossings(robot, path, region.problem.held),
        [least_margin(path, boundary) for boundary in boundaries(region)],
        -minus_reach,
        farthest,
    )
