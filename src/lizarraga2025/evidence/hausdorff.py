"""How far apart are two paths of the tool? Their Hausdorff distance, to within a stated error."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from qbound.boundary.functions import position
from qbound.model.robot import Robot
from qbound.paths.traversal import traverse

Floats = NDArray[np.float64]

ERROR = 1e-3
"""Half of the error of `apart`, cm."""


def apart(robot: Robot, one: Floats, other: Floats) -> float:
    """Return the Hausdorff distance, within 2 `ERROR`, of one path's mirror image from another.

    Parameters
    ----------
    one, other : ndarray, shape (m, 2)
        Configurations that the paths visit along straight lines of joint space, rad.
    """
    return max(_strays(robot, one, other), _strays(robot, other, one))


def _strays(robot: Robot, stops: Floats, other: Floats) -> float:
    """Return how far a path goes at most from the mirror image of another one.

    A stretch whose middle is at a distance d from the other path stays within d plus what the tool
    moves in half of it. Stretches that cannot beat the best middle are dropped, others halved.
    """
    import shapely

    drawn = traverse(robot, other, deviation=ERROR).tool[:, [0, 2]] * [-1, 1]
    line, path = shapely.LineString(drawn), traverse(robot, stops, step=1.0)
    shapely.prepare(line)
    tool = position(robot, robot.tool)
    half = 0.5 / 16
    middle = np.arange(half, len(stops) - 1, 2 * half)
    speed = _reach(robot) * np.abs(np.diff(stops, axis=0)).sum(axis=1).max()
    best = 0.0
    while len(middle):
        distance = shapely.distance(shapely.points(tool(path.at(middle))[:, [0, 2]]), line)
        best = max(best, float(distance.max()))
        middle = middle[distance + speed * half > best + ERROR]
        half /= 2
        middle = np.concatenate([middle - half, middle + half])
    return best


def _reach(robot: Robot) -> float:
    """Return the length of both links in line, cm: no joint moves the tool faster per radian."""
    return float(np.linalg.norm(robot.joints[1].origin) + np.linalg.norm(robot.point("3").at))
