"""Points of joint space visited in an order, and the path of the tool (Figures 7 to 10).

The paper visits the corners of the scaled polygon: all six (Figure 7), or five in one of two orders
(Figures 8 and 9). Straight lines in joint space are curves of the tool.
"""

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
        Path in joint space, rad or length.
    tool : ndarray, shape (m, 2)
        Path of the tool: x and z, seen from the base, in the robot's unit of length.
    stops : ndarray of int
        Rows of `q` and `tool` at which lines begin and end, from 0 to m - 1.
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
        Largest change of a joint from one row of the path to the next, rad or length.

    Returns
    -------
    Traversal

    Raises
    ------
    ValueError
        If the points do not have the shape (m, n), with one value for each joint.

    Examples
    --------
    From the home pose two lines, of 0.5 rad and of 1 rad:

    >>> from qbound import load_robot, traverse
    >>> path = traverse(load_robot("minervabot-v2"), [[0.0, 0.0], [0.5, 0.0], [0.5, -1.0]])
    >>> path.stops.tolist(), path.tool[0].round(2).tolist()
    ([0, 50, 150], [40.0, 48.48])
    """
    corners = np.asarray(points, dtype=float)
    if corners.ndim != 2:
        raise ValueError(f"points must have the shape (m, n), found {corners.shape}")
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
    """Return the orders in which k neighbouring vertices of a polygon of n are visited one by one.

    Each vertex is a start, in both directions.

    Examples
    --------
    >>> from qbound.traversal import neighbour_orders
    >>> neighbour_orders(3, 2)
    [(0, 1), (0, 2), (1, 2), (1, 0), (2, 0), (2, 1)]
    """
    return [tuple((start + way * i) % n for i in range(k)) for start in range(n) for way in (1, -1)]


def simple_orders(
    robot: Robot, points: ArrayLike, k: int, step: float = 0.01
) -> list[tuple[int, ...]]:
    """Return the orders of k of the points whose tool path does not cross itself.

    An order and its reverse have the same path; one of both is returned. Whether the paths of two
    lines cross does not depend on the order, so each pair of lines is tried once.

    Parameters
    ----------
    points : array_like, shape (m, n)
        Joint values, rad or length.
    k : int
        Number of points that are visited, each once.
    step : float
        As in `traverse`.

    Returns
    -------
    list of tuple of int
        Numbers of the points, from 0.

    Examples
    --------
    >>> from qbound import load_robot
    >>> from qbound.traversal import simple_orders
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
        # Its lines, named and sorted like the keys of `lines`.
        own = sorted((min(pair), max(pair)) for pair in pairwise(order))
        if crossed.isdisjoint(own) and crossing.isdisjoint(combinations(own, 2)):
            found.append(order)
    return found


def asymmetry(robot: Robot, one: ArrayLike, other: ArrayLike, step: float = 0.005) -> float:
    """Return the Hausdorff distance of one tool path from the mirror image of another (Figure 10).

    Parameters
    ----------
    one, other : array_like, shape (m, n)
        Points of joint space, visited along straight lines. The first path is mirrored at x = 0.
    step : float
        As in `traverse`. The error is of the order of the reach times step².

    Returns
    -------
    float
        In the robot's unit of length.

    Examples
    --------
    An arm that stands upright and turns to both sides draws mirror images:

    >>> from qbound import load_robot, planar_arm
    >>> from qbound.traversal import asymmetry
    >>> robot = load_robot("minervabot-v2")
    >>> q2 = planar_arm(robot).stretched
    >>> upright = -float(planar_arm(robot).direction(q2))
    >>> sides = ([[upright, q2], [upright + side, q2]] for side in (0.5, -0.5))
    >>> round(asymmetry(robot, *sides), 9)
    0.0
    """
    paths = [traverse(robot, points, step=step).tool for points in (one, other)]
    return polygon.hausdorff(paths[0] * [-1, 1], paths[1])
