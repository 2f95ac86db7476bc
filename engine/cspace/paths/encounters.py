"""Events along a path: crossings with itself and the singular curve, least margins of boundaries.

The rows of a traversal are only starting points; every place is refined on the path itself. The
paper reads these places off pictures (Section 5).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats
from cspace.boundary.evaluator import Evaluator, evaluator
from cspace.boundary.separation import largest_speeds
from cspace.geometry.arcs import last_before
from cspace.geometry.polygon import crossing_pieces
from cspace.model.robot import Robot
from cspace.paths.traversal import Route, Traversal, reach
from cspace.region import Region
from cspace.tolerances import ON_BOUNDARY, SAME_PLACE, TOUCH
from cspace.units import joint_units
from cspace.workspace.planar import NoPlanarWorkspaceError, singular_form
from qbound.boundary import position

Form = Callable[[Floats], Floats]

ROWS_OF_A_LEG = 65
MOST_PLACES = 2**14
NEARLY_LOWEST = 1e-6
"""Of the size of a margin: the lowest place is not mistaken for one this much higher."""


@dataclass(frozen=True)
class MarginFunction:
    """A margin that must not be negative, as a function of joint values.

    Attributes
    ----------
    name : str
    unit : str
        Unit of the margin: the robot's length unit, or the joint's unit for a joint limit.
    margin : callable
        Joint values, shape (k, n), to margins, shape (k,).
    scale : float
        Size of the lengths or angles whose difference the margin is; its rounding is relative to
        it.
    speeds : ndarray, shape (n,), optional
        Bounds of the margin's change for a unit of each joint; None if unknown.
    """

    name: str
    unit: str
    margin: Form
    scale: float
    speeds: Floats | None = None


@dataclass(frozen=True, eq=False)
class ParameterPoint:
    """A place of a path: `s` as in `Traversal.s`, and the joint values there."""

    s: float
    q: Floats


@dataclass(frozen=True, eq=False)
class Crossing:
    """A point of the plane of motion that a path passes twice, in two directions."""

    point: Floats
    first: ParameterPoint
    second: ParameterPoint


@dataclass(frozen=True, eq=False)
class Margin:
    """The smallest margin of one boundary along a path.

    Attributes
    ----------
    boundary : MarginFunction
    value : float
        Negative where the path is outside.
    place : ParameterPoint
        Where the margin is smallest.
    leaves : ParameterPoint or None
        Where the path first violates the boundary; None if it keeps the boundary.
    """

    boundary: MarginFunction
    value: float
    place: ParameterPoint
    leaves: ParameterPoint | None


def plane_of_motion(robot: Robot) -> tuple[int, int] | None:
    """Return the two coordinates (0, 1, 2 for x, y, z) that the tool moves in; None if not two."""
    tool = position(robot, robot.tool)
    moving = [i for i in range(3) if tool[i].joints()]
    return (moving[0], moving[1]) if len(moving) == 2 else None


def tool_crossings(robot: Robot, path: Traversal, plane: tuple[int, int]) -> list[Crossing]:
    """Find where the tool's path crosses itself, by Newton from the crossings of a polyline.

    A stop that is visited twice is not a crossing, and neither is a piece that is run twice.
    """
    place = position(robot, robot.tool)[list(plane)]

    def tool(s: Floats) -> Floats:
        return np.asarray(place(path.at(s)))

    found, stops = list[Crossing](), path.q[path.stops]
    n = ROWS_OF_A_LEG - 1
    grid = np.arange(len(path.legs) * n + 1) / n
    i, j, t, u = crossing_pieces(tool(grid), beyond=0.5)
    for start in zip(grid[i] + t / n, grid[j] + u / n, strict=True):
        pair = _newton(tool, np.array(start), len(path.legs))
        if pair is None or any(np.abs(stops - path.at(x)).max(axis=1).min() < TOUCH for x in pair):
            continue
        if all(abs(pair - (c.first.s, c.second.s)).max() >= SAME_PLACE for c in found):
            first, second = (_place(path, x) for x in pair)
            found.append(Crossing(tool(pair[:1])[0], first, second))
    return sorted(found, key=lambda c: (c.first.s, c.second.s))


def singular_crossings(
    robot: Robot, path: Traversal, held: Mapping[int, float] | None = None
) -> list[ParameterPoint] | None:
    """Find where a path crosses the singular curve: det J of two joints changes its sign there.

    None if the tool leaves every plane, or moves on a curve only. Signs are compared at the rows,
    so two changes between neighbouring rows are missed.

    Parameters
    ----------
    held : mapping of int to float, optional
        Joints that do not move and their values, all but two.
    """
    held = held or {}
    try:
        form = singular_form(robot, held)
    except NoPlanarWorkspaceError:
        return None
    free = robot.free(held)

    def det(q: Floats) -> Floats:
        return np.asarray(form(q[..., free]))

    grid = _grid(path)
    rounding = ON_BOUNDARY * np.abs(form.coefficients).max()
    grid = grid[np.abs(det(path.at(grid))) > rounding]
    signs = np.sign(det(path.at(grid)))
    changes = np.nonzero(signs[1:] != signs[:-1])[0]

    def as_before(s: Floats) -> NDArray[np.bool_]:
        return np.asarray(np.sign(det(path.at(s))) == signs[changes])

    low, _ = last_before(as_before, grid[changes], grid[changes + 1])
    return [_place(path, s) for s in low]


def boundaries(region: Region) -> list[MarginFunction]:
    """Return the boundaries and limits of a region as margins of all joint values (eqs. 9-12).

    These are every boundary in use and every joint limit. Where windows stand for some boundaries
    (`window_problem`), they are the forms of the problem, and the ends of its ranges.
    """
    robot, problem = region.robot, region.problem
    by_windows = bool(problem.unstated)
    if not by_windows:
        compiled = evaluator(robot)
        limited = zip(joint_units(robot), (joint.limits for joint in robot.joints), strict=True)
    else:
        compiled, limited = problem.evaluator, zip(problem.units, problem.ranges, strict=True)
    ends = [unit for unit, limits in limited if limits is not None for _ in limits]
    lengths = [robot.length_unit] * (len(compiled.names) - len(ends))
    sizes = compiled.sizes.tolist()
    columns = enumerate(zip(compiled.names, [*lengths, *ends], sizes, strict=True))
    used = () if by_windows else robot.used
    speeds = {boundary.name: largest_speeds(robot, boundary) for boundary in used}
    return [
        MarginFunction(name, unit, _column(compiled, k), size, speeds.get(name))
        for k, (name, unit, size) in columns
    ]


def least_margin(path: Traversal, boundary: MarginFunction) -> Margin:
    """Find the smallest margin along a path, and where the path leaves if it does.

    No contact is missed between two rows of a straight leg, because the speed of a margin is
    bounded.
    """
    grid = _grid(path) if boundary.speeds is None else _close_grid(path, boundary)
    value, place = lowest(path, boundary.margin, grid)
    return Margin(boundary, value, place, _leaves(path, boundary, grid, place.s))


def lowest(
    path: Traversal, function: Form, grid: Floats | None = None
) -> tuple[float, ParameterPoint]:
    """Return the smallest value of a function of the joint values along a path, and its place.

    The search starts at the row with the smallest margin. The interval around it is divided again
    and again until it is a point.

    Parameters
    ----------
    grid : ndarray, shape (k,), optional
        Places that are checked first; default: the rows, and 64 even parts of each leg.
    """
    s, found = _grid(path) if grid is None else grid, list[tuple[float, float]]()
    for _ in range(13):
        values = function(path.at(s))
        i = int(values.argmin())
        found.append((float(values[i]), float(s[i])))
        s = np.linspace(s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)], 33)
    value, at = min(found[0], found[-1])
    return value, _place(path, at)


def _leaves(
    path: Traversal, boundary: MarginFunction, grid: Floats, least: float
) -> ParameterPoint | None:
    """First place where the margin is negative beyond rounding; it is smallest at `least`."""

    def inside(s: Floats) -> NDArray[np.bool_]:
        return np.asarray(boundary.margin(path.at(s)) >= -ON_BOUNDARY * boundary.scale)

    grid = np.sort(np.append(grid, least))
    kept = inside(grid)
    if kept.all():
        return None
    i = int(kept.argmin())
    _, high = last_before(inside, grid[[max(i - 1, 0)]], grid[[i]])
    return _place(path, high[0])


def _column(compiled: Evaluator, k: int) -> Form:
    return lambda q: np.asarray(compiled.margins(q)[..., k])


def _place(path: Traversal, s: float) -> ParameterPoint:
    return ParameterPoint(float(s), path.at(s)[0])


def _grid(path: Traversal) -> Floats:
    """Rows of the path and more places, so that no turning point hides between two of them."""
    even = np.arange(len(path.legs) * (ROWS_OF_A_LEG - 1) + 1) / (ROWS_OF_A_LEG - 1)
    return np.asarray(np.unique(np.concatenate([path.s, even])))


def _close_grid(path: Traversal, boundary: MarginFunction) -> Floats:
    """Return places so close that first exit and minimum cannot lie between two of them.

    Between two places the margin falls below their mean by at most half of the change that its
    speed allows. Legs that are not straight keep their rows. So do stretches for which
    `MOST_PLACES` are not enough, for example where bodies slide along each other.
    """
    s = _grid(path)
    values = boundary.margin(path.at(s))
    own = np.zeros(1) if boundary.speeds is None else boundary.speeds
    speeds = np.array([0.0 if leg.rates is None else leg.rates @ own for leg in path.legs])
    outside, slack = ON_BOUNDARY * boundary.scale, NEARLY_LOWEST * boundary.scale
    while len(s) < MOST_PLACES:
        middle, width = (s[:-1] + s[1:]) / 2, np.diff(s)
        least = (values[:-1] + values[1:] - speeds[middle.astype(int)] * width) / 2
        left = values < -outside
        first = s[left.argmax()] if left.any() else np.inf
        doubtful = (least < values.min() - slack) | ((least < -outside) & (s[1:] <= first))
        doubtful &= (speeds[middle.astype(int)] > 0) & (width > SAME_PLACE)
        if not doubtful.any():
            break
        s = np.concatenate([s, middle[doubtful]])
        values = np.concatenate([values, boundary.margin(path.at(middle[doubtful]))])
        order = np.argsort(s)
        s, values = s[order], values[order]
    return s


def _newton(curve: Form, pair: Floats, legs: int) -> Floats | None:
    """Parameters of the crossing near a pair; None if there is none, or it is beyond the legs."""
    leg = np.clip(np.floor(pair), 0, legs - 1)
    h = 1e-6
    for _ in range(20):
        inner = np.clip(pair, leg + h, leg + 1 - h)
        ahead, behind = curve(inner + h * (1 - 1e-9)), curve(inner - h * (1 - 1e-9))
        (u, v), (a, b) = (ahead - behind) / (2 * h), curve(np.clip(pair, leg, leg + 1 - 1e-12))
        matrix = np.stack([u, -v], axis=1)
        if abs(np.linalg.det(matrix)) <= SAME_PLACE * np.linalg.norm(u) * np.linalg.norm(v):
            return None  # parallel or touching: no crossing
        step = np.linalg.solve(matrix, a - b)
        pair = pair - step
        if (np.abs(pair - leg - 0.5) > 0.6).any():
            return None
        if np.abs(step).max() < 1e-13:
            break
    apart = pair[1] - pair[0] > SAME_PLACE
    inside = (np.floor(pair) == leg).all()
    return pair if apart and inside and np.abs(step).max() < SAME_PLACE else None


@dataclass(frozen=True, eq=False)
class PathReport:
    """The events along a route: least margins, crossings, singular poses.

    Attributes
    ----------
    route : Route
    plane : tuple of two int, or None
        The two coordinates in which the tool moves; None if it leaves every plane.
    crossings : list of Crossing, or None
        Where the tool crosses its own path; None without a plane.
    singular : list of ParameterPoint, or None
        Where the path crosses the singular curve; None if there is no such curve.
    margins : list of Margin
        The smallest margin of each boundary.
    largest_reach : float
        Largest distance of the tool from the first joint's frame; length.
    farthest : ParameterPoint
        Where the tool has this distance.
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
    """Report every boundary, limit, crossing and singular pose that a route meets."""
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
