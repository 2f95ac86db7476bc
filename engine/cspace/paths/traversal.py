"""Paths of the arm: vertices or arcs visited in an order, the joint path and the tool's path.

A route goes along numbered vertices or arcs of a component, and names its stops and legs. Vertices
and arcs count from 1 in the order of the component's loops; components count from 0.

Along a path it crosses itself and the singular curve, and margins are least. The rows of a
traversal are only starting points of these places; each is refined on the path itself. The paper
reads them off pictures (Section 5).
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats
from cspace.boundary.evaluator import Evaluator, evaluator
from cspace.boundary.separation import largest_speeds
from cspace.geometry import polygon
from cspace.geometry.arcs import last_before
from cspace.geometry.polygon import Curve, crossing_pieces, flatten, too_fine
from cspace.model.robot import Robot
from cspace.region import Component, Region
from cspace.region.arcs import Arc
from cspace.tolerances import ON_BOUNDARY, ROUNDING, SAME_PLACE, TOUCH
from cspace.units import joint_units
from cspace.workspace.planar import NoPlanarWorkspaceError, singular_form
from qbound.boundary import position

MOST_ROWS = 2**20
"""Rows of a path: a gigabyte while they are written."""


@dataclass(frozen=True, eq=False)
class Leg:
    """A smooth piece of a joint path.

    Attributes
    ----------
    at : callable
        Parameters in [0, 1], shape (k,), to joint values, shape (k, n).
    bend : float or None
        Bound on the second derivative of the tool's place by the parameter, length; None where
        none is known, as on an arc.
    parts : int
        Equal parts of [0, 1] on each of which the leg is smooth.
    rates : ndarray, shape (n,), optional
        How far each joint goes, rad or length, if all joints move at constant rates.
    """

    at: Curve
    bend: float | None = None
    parts: int = 2
    rates: Floats | None = None


@dataclass(frozen=True, eq=False)
class Traversal:
    """A path through joint space, leg by leg, and the path of the tool.

    Attributes
    ----------
    q : ndarray, shape (m, n)
        Joint path, rad or length.
    tool : ndarray, shape (m, 3)
        Tool positions seen from the base; length.
    stops : ndarray of int
        Rows of `q` at which legs begin and end.
    reach : ndarray, shape (m,)
        Distance of the tool from the origin of the first joint's frame; length.
    s : ndarray, shape (m,)
        Position of each row on the path: the number of finished legs plus the parameter on its own
        leg.
    legs : tuple of Leg
    deviation : float
        The tool's path is nowhere farther than this from the polyline through `tool`; length.
    proved : bool
        Whether `deviation` is a bound (straight legs) or measured between the rows (arcs).
    """

    q: Floats
    tool: Floats
    stops: NDArray[np.int64]
    reach: Floats
    s: Floats
    legs: tuple[Leg, ...]
    deviation: float
    proved: bool

    @property
    def final_pose(self) -> Floats:
        """Joint values at the end, shape (n,)."""
        return np.asarray(self.q[-1])

    def at(self, s: ArrayLike) -> Floats:
        """Return the joint values at places of the path (as in `s`), shape (k, n)."""
        s = np.atleast_1d(np.asarray(s, dtype=float))
        index = np.clip(s.astype(int), 0, len(self.legs) - 1)
        q = np.empty((len(s), self.q.shape[1]))
        for i in np.unique(index):
            q[index == i] = self.legs[i].at(s[index == i] - i)
        return q


def traverse(
    robot: Robot,
    vertices: ArrayLike,
    *,
    closed: bool = False,
    step: float = 0.01,
    deviation: float | None = None,
) -> Traversal:
    """Visit vertices in the order given, along straight lines in joint space.

    Parameters
    ----------
    vertices : array_like, shape (m, n)
        Joint values, rad or length.
    closed : bool
        Whether to return to the first vertex.
    step : float
        Largest change of any joint from one row to the next, if no `deviation` is given.
    deviation : float, optional
        Largest distance of the tool's path from the polyline through its rows; length. Rows are
        as close as a bound on the second derivative asks for (not in the paper).

    Raises
    ------
    ValueError
        If there are fewer than two vertices or a value is not finite.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> vertices = [vertex.q for vertex in find_region(robot).home_component.vertices]
    >>> path = traverse(robot, vertices, closed=True, deviation=0.01)
    >>> len(path.legs), path.tool.shape, path.deviation <= 0.01
    (6, (317, 3), True)

    Straight lines between feasible vertices may leave the region: it is not convex.

    >>> bool(find_region(robot).contains(path.q).all())
    False
    """
    stops = np.asarray(vertices, dtype=float)
    if len(stops) < 2 or not np.isfinite(stops).all():
        raise ValueError("a path needs two vertices or more, of finite joint values")
    if closed:
        stops = np.concatenate([stops, stops[:1]])
    legs = [straight(robot, a, b) for a, b in pairwise(stops)]
    if deviation is not None:
        return follow(robot, legs, deviation)
    steps = [max(1, math.ceil(np.abs(b - a).max() / step)) for a, b in pairwise(stops)]
    return _joined(robot, legs, [np.linspace(0, 1, n + 1) for n in steps], 0.0)


def follow(robot: Robot, legs: Sequence[Leg], deviation: float) -> Traversal:
    """Go along legs one after the other, with rows that follow the tool's path (not in the paper).

    Parameters
    ----------
    deviation : float
        Largest distance of the tool's path from the polyline through its rows; length.

    Raises
    ------
    ValueError
        If there is no leg, or the deviation is not above zero or takes more than `MOST_ROWS` rows.
    """
    if not legs:
        raise ValueError("a path needs a leg")
    if not deviation > 0:
        raise ValueError(f"a deviation must be above 0, found {deviation:g}")
    tool = position(robot, robot.tool)
    cost = sum(_chords(leg.bend, deviation) for leg in legs if leg.bend is not None)
    if cost > MOST_ROWS:
        raise ValueError(too_fine(deviation, cost, MOST_ROWS))
    grids, measured = [], 0.0
    for leg in legs:
        if leg.bend is None:
            grid, off = flatten(_image(tool, leg.at), deviation, leg.parts)
            measured = max(measured, off)
        else:
            grid = np.linspace(0, 1, int(_chords(leg.bend, deviation)) + 1)
        grids.append(grid)
    return _joined(robot, legs, grids, measured)


def _chords(bend: float, deviation: float) -> float:
    """Return the number n of chords for a unit of s; a chord is off by bend / (8 n^2)."""
    return max(1.0, float(np.ceil(math.sqrt(bend / (8 * deviation)))))


def straight(robot: Robot, start: ArrayLike, end: ArrayLike) -> Leg:
    r"""Return the straight line between two configurations and the bound on the tool's bend.

    Notes
    -----
    Not in the paper. Along the line each joint moves at the constant rate :math:`d_j`. A vector
    of length l carried by revolute joints of rates :math:`d_j` has a second derivative of at most
    :math:`(\sum |d_j|)^2\, l`; a prismatic joint adds :math:`2 |d| \sum |d_j|`. The tool is the
    sum of the links, so the bound is the sum of theirs.
    """
    a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    rates = np.abs(b - a)
    return Leg(lambda s: (1 - s)[:, None] * a + s[:, None] * b, _bend(robot, a, b), rates=rates)


def reach(robot: Robot, q: ArrayLike) -> Floats:
    """Return the distance of the tool from the origin of the first joint's frame; length."""
    arm = robot.frames(q).position(robot.joints[0].frame, robot.tool, robot.base)
    return np.asarray(np.linalg.norm(arm, axis=-1))


def _bend(robot: Robot, a: Floats, b: Floats) -> float:
    """Sum over the links up to the tool; see `straight`.

    A parallelogram turns its crank, and its second step turns back all that follows.
    """
    point, rates = robot.point(robot.tool), np.abs(b - a)
    turned = np.zeros(len(rates))  # times that each joint's angle turns what comes next
    bend = 0.0
    for step in robot.steps[: robot.steps_to(point.frame)]:
        j, turning = step.joint, float(np.abs(turned) @ rates)
        slide = step.sense * (step.mount @ step.axis) if step.slides else np.zeros(3)
        ends = (np.linalg.norm(step.origin + q * slide) for q in (a[j], b[j]))
        bend += turning**2 * float(max(ends))
        if step.slides:
            bend += 2 * turning * float(rates[j])
        else:
            turned[j] += step.sense
    return float(bend + (np.abs(turned) @ rates) ** 2 * np.linalg.norm(point.at))


def _joined(
    robot: Robot, legs: Sequence[Leg], grids: Sequence[Floats], measured: float
) -> Traversal:
    """Put the rows of all legs together; a stop is one row, that of the leg that begins there."""
    pieces = [leg.at(grid) for leg, grid in zip(legs, grids, strict=True)]
    q = np.concatenate([*(piece[:-1] for piece in pieces), pieces[-1][-1:]])
    places = [i + grid[:-1] for i, grid in enumerate(grids)]
    s = np.concatenate([*places, [float(len(legs))]])
    stops = np.cumsum([0, *(len(grid) - 1 for grid in grids)])
    bounds = (
        leg.bend / (8 * (len(grid) - 1) ** 2)
        for leg, grid in zip(legs, grids, strict=True)
        if leg.bend is not None
    )
    proved = all(leg.bend is not None for leg in legs)
    tool, off = position(robot, robot.tool)(q), max(measured, *bounds, 0.0)
    return Traversal(q, tool, stops, reach(robot, q), s, tuple(legs), off, proved)


def _image(tool: Curve, at: Curve) -> Curve:
    return lambda s: tool(at(s))


Along = Literal["lines", "arcs"]


@dataclass(frozen=True, eq=False)
class Route:
    """A path with the request for it, and the names of its stops and legs.

    Attributes
    ----------
    region : Region
    component : int
        The component whose vertices or arcs the route visits.
    order : tuple of int
        Numbers of the vertices or arcs.
    along : {"lines", "arcs"}
    scale : float
        Scale of the vertices about their polygon's centroid.
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

    The paper's paths are straight lines between vertices (Figures 7 to 9).

    Parameters
    ----------
    order : sequence of int
        Numbers of vertices or arcs, from 1; -2 runs arc 2 backwards. A straight line joins arcs
        that do not meet.
    along : {"lines", "arcs"}
    component : int
        The component with these vertices or arcs, from 0.
    closed : bool
        Whether to return to the start.
    scale : float
        Scale of the vertices about the centroid of their polygon; for arcs only 1.
    deviation : float, optional
        As `follow` takes it; default: a ten-thousandth of the stretched arm.

    Raises
    ------
    ValueError
        If a component, vertex or arc does not exist, there are too few of them, `along` is unknown,
        arcs are to be scaled, or the scale or the deviation is not above zero.

    Examples
    --------
    >>> from cspace import find_region, load_robot
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
        named = list(_named_legs(robot, order, legs, closed))
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


def _named_legs(
    robot: Robot, order: Sequence[int], legs: Sequence[Leg], closed: bool
) -> Iterator[tuple[str, Leg]]:
    """Join arcs that do not meet by straight lines; a closed path ends where it began."""
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

    return Leg(at, parts=len(arc.pieces))


def _place(leg: Leg, s: float) -> Floats:
    return np.asarray(leg.at(np.array([s]))[0])


def _refuse_unknown(numbers: Sequence[int], count: int, what: str, component: int) -> None:
    for number in numbers:
        if not 1 <= number <= count:
            there = f"it has {count}, numbered from 1" if count else f"it has no {what}"
            raise ValueError(f"no {what} {number} in component {component}: {there}")


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
            first, second = (_placed(path, x) for x in pair)
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
    return [_placed(path, s) for s in low]


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

    The search starts at the row with the smallest margin, the first of equal ones. The interval
    around it is divided again and again until it is a point.

    Parameters
    ----------
    grid : ndarray, shape (k,), optional
        Places that are checked first; default: the rows, and 64 even parts of each leg.
    """
    s, found = _grid(path) if grid is None else grid, list[tuple[float, float]]()
    for tied in (ROUNDING, *[0.0] * 12):
        values = function(path.at(s))
        i = int((values <= values.min() + tied * np.abs(values).max()).argmax())
        found.append((float(values[i]), float(s[i])))
        s = np.linspace(s[max(i - 1, 0)], s[min(i + 1, len(s) - 1)], 33)
    value, at = min(found[0], found[-1])
    return value, _placed(path, at)


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
    return _placed(path, high[0])


def _column(compiled: Evaluator, k: int) -> Form:
    alone = compiled.alone(k)
    column = alone.names.index(compiled.names[k])
    return lambda q: np.asarray(alone.margins(q)[..., column])


def _placed(path: Traversal, s: float) -> ParameterPoint:
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
