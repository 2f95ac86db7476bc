"""Traversals: vertices or arcs visited in an order, the joint path and the tool's path."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, permutations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arrays import Floats
from qbound.boundary.functions import position
from qbound.geometry.polylines import Curve, flatten, self_crossings, too_fine
from qbound.model.robot import Robot

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
        How far each joint goes, rad or length, where all go at a constant rate.
    """

    at: Curve
    bend: float | None = None
    parts: int = 2
    rates: Floats | None = None


@dataclass(frozen=True, eq=False)
class Traversal:
    """A path through joint space, leg by leg, and what the tool does.

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
        Place of each row on the path: legs behind it, plus the parameter on its own.
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
        Largest change of any joint from one row to the next, where no `deviation` is given.
    deviation : float, optional
        Largest distance of the tool's path from the polyline through its rows; length. Rows are
        as close as a bound on the second derivative asks for (not in the paper).

    Raises
    ------
    ValueError
        If there are fewer than two vertices or a value is not finite.

    Examples
    --------
    >>> from qbound import find_region, load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> vertices = [vertex.q for vertex in find_region(robot).home.vertices]
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
    """Go along legs one after the other, in rows that keep to the tool's path (not in the paper).

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
    """Return in how many a curve of length 1 in s is cut; a chord is off by bend / (8 n^2)."""
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


def simple_orders(
    robot: Robot, vertices: ArrayLike, length: int, plane: tuple[int, int] = (0, 2)
) -> list[tuple[int, ...]]:
    """Return the orders of `length` of the vertices whose open tool path does not cross itself.

    Each order is given once, in the direction that starts with the smaller index.
    """
    q = np.asarray(vertices, dtype=float)
    orders = (o for o in permutations(range(len(q)), length) if o[0] < o[-1])
    walks = ((o, traverse(robot, q[list(o)], step=0.03).tool[:, plane]) for o in orders)
    return [order for order, tool in walks if not len(self_crossings(tool))]


def _bend(robot: Robot, a: Floats, b: Floats) -> float:
    """Sum over the links up to the tool; see `straight`."""
    point = robot.point(robot.tool)
    bend = turning = 0.0
    carrier = robot.base
    for joint, low, high in zip(robot.joints, a, b, strict=True):
        if carrier == point.frame:
            break
        slide = np.zeros(3) if joint.turns else joint.mount @ joint.axis
        ends = (np.linalg.norm(joint.origin + q * slide) for q in (low, high))
        bend += turning**2 * float(max(ends))
        if joint.turns:
            turning += abs(high - low)
        else:
            bend += 2 * turning * abs(high - low)
        carrier = joint.frame
    return float(bend + turning**2 * np.linalg.norm(point.at))


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
