"""Points of joint space visited in an order, and the path of the tool (Figures 7 to 10)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, pairwise, permutations

import numpy as np
from numpy.typing import ArrayLike

from qbound import polygon
from qbound.arrays import Floats, Ints
from qbound.boundary import position
from qbound.robot import Robot
from qbound.workspace import PLANE


@dataclass(frozen=True, eq=False)
class Traversal:
    """A path of straight lines in joint space, each joint at a constant rate on each line.

    Attributes
    ----------
    q : ndarray, shape (m, n)
        Joint path, rad or length.
    tool : ndarray, shape (m, 2)
        Path of the tool: x and z, seen from the base.
    stops : ndarray of int
        Rows at which lines begin and end.
    """

    q: Floats
    tool: Floats
    stops: Ints


def traverse(
    robot: Robot, points: ArrayLike, *, closed: bool = False, step: float = 0.01
) -> Traversal:
    r"""Visit points of joint space in the order given, on lines :math:`q + t\,(q' - q)`.

    Parameters
    ----------
    points : array_like, shape (m, n)
        Joint values, rad or length.
    closed : bool
        Whether the path returns to its first point.
    step : float
        Largest change of a joint from one row of the path to the next.

    Examples
    --------
    >>> from qbound import load_robot
    >>> path = traverse(load_robot("minervabot-v2"), [[0.0, 0.0], [0.5, 0.0], [0.5, -1.0]])
    >>> path.stops.tolist(), path.tool[0].round(2).tolist()
    ([0, 50, 150], [40.0, 48.48])
    """
    corners = np.asarray(points, dtype=float)
    if closed:
        corners = np.concatenate([corners, corners[:1]])
    rows, stops = [corners[:1]], [0]
    for start, end in pairwise(corners):
        n = max(1, int(np.ceil(np.abs(end - start).max() / step)))
        rows.append(start + np.linspace(0, 1, n + 1)[1:, None] * (end - start))
        stops.append(stops[-1] + n)
    q = np.concatenate(rows)
    return Traversal(q, position(robot)(q)[:, PLANE], np.array(stops))


def neighbour_orders(n: int, k: int) -> list[tuple[int, ...]]:
    """Return the orders of k neighbouring vertices of a polygon of n, in both directions.

    Examples
    --------
    >>> neighbour_orders(3, 2)
    [(0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1)]
    """
    return [tuple((start + way * i) % n for i in range(k)) for start in range(n) for way in (1, -1)]


def simple_orders(
    robot: Robot, points: ArrayLike, k: int, step: float = 0.01
) -> list[tuple[int, ...]]:
    """Return the orders of k points whose tool path does not cross itself, without reverses.

    Whether two lines cross does not depend on the order that they are in, so each pair of lines is
    tried once.

    Parameters
    ----------
    points : array_like, shape (m, n)
        Joint values.
    step : float
        As in `traverse`.

    Examples
    --------
    >>> from qbound import load_robot
    >>> simple_orders(load_robot("minervabot-v2"), [[0.0, 0.0], [0.5, 0.0], [0.5, -1.0]], 3)
    [(0, 1, 2), (0, 2, 1), (1, 0, 2)]
    """
    p = np.asarray(points, dtype=float)
    lines = {}
    for pair in combinations(range(len(p)), 2):
        lines[pair] = traverse(robot, p[list(pair)], step=step).tool
    crossed = {pair for pair, path in lines.items() if len(polygon.self_crossings(path))}
    crossing = set()
    for one, other in combinations(lines, 2):
        if len(polygon.crossings(lines[one], lines[other])):
            crossing.add((one, other))
    found = []
    for order in permutations(range(len(p)), k):
        if order[0] > order[-1]:
            continue  # the reverse of an order that is tried
        own = sorted((min(pair), max(pair)) for pair in pairwise(order))
        if crossed.isdisjoint(own) and crossing.isdisjoint(combinations(own, 2)):
            found.append(order)
    return found


def asymmetry(robot: Robot, one: ArrayLike, other: ArrayLike, step: float = 0.005) -> float:
    """Return the Hausdorff distance of one tool path from the mirror image of another (Figure 10).

    Parameters
    ----------
    one, other : array_like, shape (m, n)
        Points of joint space, visited along straight lines. The x axis is mirrored.
    step : float
        As in `traverse`. The error is of the order of the reach times step².

    Examples
    --------
    An arm that stands upright and turns to both sides draws mirror images:

    >>> from qbound import load_robot
    >>> from qbound.workspace import planar_arm
    >>> robot = load_robot("minervabot-v2")
    >>> q2 = planar_arm(robot).stretched
    >>> upright = -float(planar_arm(robot).direction(q2))
    >>> sides = ([[upright, q2], [upright + side, q2]] for side in (0.5, -0.5))
    >>> round(asymmetry(robot, *sides), 9)
    0.0
    """
    paths = [traverse(robot, points, step=step).tool for points in (one, other)]
    return polygon.hausdorff(paths[0] * [-1, 1], paths[1])
