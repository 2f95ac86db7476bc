"""Distance of one path of the tool from the mirror image of another, with a stated error."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats
from qbound.boundary.functions import position
from qbound.extras import require
from qbound.model.robot import Robot
from qbound.paths.traversal import traverse


def asymmetry(robot: Robot, one: ArrayLike, other: ArrayLike, error: float = 1e-3) -> float:
    """Return the Hausdorff distance, within 2 `error`, of one path's mirror image from another.

    Parameters
    ----------
    one, other : array_like, shape (m, n)
        Configurations that the paths visit along straight lines of joint space; all joints turn.
        The paths of the tool are seen in the plane of x and z and mirrored at the z axis.
    error : float
        Half of the largest error of the result; length.

    Notes
    -----
    The cost grows as the distance falls: of paths that are mirror images every stretch as short as
    the error is looked at.

    Raises
    ------
    ValueError
        If a joint slides, the error is not above zero, or as `qbound.paths.traversal.traverse`.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2-symmetric")
    >>> asymmetry(robot, [[0.0, 0.5], [0.5, 0.0]], [[0.0, 0.5], [0.5, 0.0]]) > 10
    True

    Mirroring this arm takes q to (s, 2 s) - q, where s is the second joint's value in the stretched
    pose:

    >>> import numpy as np
    >>> s = -np.arctan2(robot.joints[1].origin[2], robot.joints[1].origin[0])
    >>> path = np.array([[0.0, 0.5], [0.5, 0.0]])
    >>> asymmetry(robot, path, [s, 2 * s] - path, error=0.1) < 0.2
    True
    """
    if not all(joint.turns for joint in robot.joints):
        raise ValueError("joints that slide are not provided for: what they move is not bounded")
    one, other = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return max(_strays(robot, one, other, error), _strays(robot, other, one, error))


def _strays(robot: Robot, stops: Floats, other: Floats, error: float) -> float:
    """Return how far a path goes at most from the mirror image of another one.

    A stretch whose middle is at a distance d from the other path stays within d plus what the tool
    moves in half of it. Stretches that cannot beat the best middle are dropped, others halved.
    """
    require("shapely")
    import shapely

    drawn = traverse(robot, other, deviation=error).tool[:, [0, 2]] * [-1, 1]
    line, path = shapely.LineString(drawn), traverse(robot, stops, step=1.0)
    shapely.prepare(line)
    tool = position(robot, robot.tool)
    half = 0.5 / 16
    middle = np.arange(half, len(stops) - 1, 2 * half)
    # No joint moves the tool faster per radian than the links in line, from the first joint on.
    reach = robot.stretched(robot.tool) - np.linalg.norm(robot.joints[0].origin)
    speed = reach * np.abs(np.diff(stops, axis=0)).sum(axis=1).max()
    best = 0.0
    while len(middle):
        distance = shapely.distance(shapely.points(tool(path.at(middle))[:, [0, 2]]), line)
        best = max(best, float(distance.max()))
        middle = middle[distance + speed * half > best + error]
        half /= 2
        middle = np.concatenate([middle - half, middle + half])
    return best
