"""Where the tool goes: paths through the scaled polygon's points, postures, the workspace."""

from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.evidence.arms import floor, robot, tool_form
from lizarraga2025.evidence.joint_region import by_windows, scaled, vertices
from lizarraga2025.evidence.rounding import SMALL
from qbound import Robot, Workspace, planar_arm, polygon, scaling, traversal, traverse
from qbound.arrays import Floats
from qbound.traversal import Traversal
from qbound.workspace import PLANE, PlanarArm

AROUND = (0, 1, 2, 3, 4, 5, 0)
"""Once round all six points and back."""


def opposite(order: Sequence[int]) -> tuple[int, ...]:
    """Return the sequence through the points across the hexagon: point 4 for point 1, and so on."""
    return tuple((i + 3) % 6 for i in order)


def path_through(
    order: Sequence[int], factor: float | None = None, of: Robot | None = None
) -> Traversal:
    """Visit points of the scaled polygon in an order, from 0; by the book's scale if no factor."""
    return traverse(of or robot(), scaled(factor, of)[list(order)])


def crossings(path: Traversal) -> int:
    """Count how often the tool's path crosses itself."""
    return len(polygon.self_crossings(path.tool))


@cache
def simple_sequences() -> tuple[tuple[int, ...], ...]:
    """Return the orders of five points whose tool path does not cross itself."""
    return tuple(traversal.simple_orders(robot(), scaled(), 5))


@cache
def neighbour_sequences() -> tuple[tuple[int, ...], ...]:
    """Return the sequences of five neighbouring points, in both directions: twelve for six."""
    return tuple(traversal.neighbour_orders(len(vertices()), 5))


def simple_neighbours(factor: float | None = None) -> list[tuple[int, ...]]:
    """Return the sequences of five neighbours whose tool path does not cross itself."""
    return [order for order in neighbour_sequences() if _is_simple(order, factor)]


def structured_neighbours(factor: float | None = None) -> list[tuple[int, ...]]:
    """Return the sequences of five neighbours that are feasible and do not cross themselves."""
    return [order for order in feasible_neighbours(factor) if _is_simple(order, factor)]


def _is_simple(order: tuple[int, ...], factor: float | None) -> bool:
    return _crossings_either_way(min(order, order[::-1]), factor) == 0


@cache
def _crossings_either_way(order: tuple[int, ...], factor: float | None) -> int:
    return crossings(path_through(order, factor))


def is_feasible(order: Sequence[int], factor: float | None = None) -> bool:
    """Tell whether the whole joint path through points of the scaled polygon keeps every bound.

    The windows of Table 6 hold between two points that they hold at; of the tool's limit the least
    height on each leg counts.
    """
    stops, box = scaled(factor)[list(order)], by_windows().box
    inside = (stops >= box.lower - SMALL) & (stops <= box.upper + SMALL)
    heights = [_least_on_leg(*sorted(leg), factor) for leg in pairwise(order)]
    return bool(inside.all() and min(heights) > -SMALL)


@cache
def _least_on_leg(i: int, j: int, factor: float | None) -> float:
    """Return the least height of the tool above its limit between two scaled points, cm."""
    return scaling.least_along(floor(), *scaled(factor)[[i, j]]).value


def feasible_neighbours(factor: float | None = None) -> list[tuple[int, ...]]:
    """Return the sequences of five neighbours whose whole joint path is feasible."""
    return [order for order in neighbour_sequences() if is_feasible(order, factor)]


def asymmetry(of: Robot, factor: float, about: Floats | None = None) -> float:
    """Return the Hausdorff distance of the left path from the mirrored right one, cm.

    The six points are scaled about the centroid of the area, unless another place is given.
    """
    about = polygon.centroid(vertices(of)) if about is None else about
    points = polygon.scaled(vertices(of), factor, about)
    right, left = (points[list(order)] for order in (RIGHT, LEFT))
    return traversal.asymmetry(of, right, left, step=0.01)


def asymmetry_about_the_middle() -> float:
    """Return the asymmetry, cm, where the points are scaled about the pose in the middle.

    The middle is the pose that is its own mirror image. The scale is `SCALE`.
    """
    lean = float(np.arctan2(*robot().joints[1].origin[[0, 2]]))
    return asymmetry(robot(), SCALE, np.array([-lean, lean - np.pi / 2]))


def spread_of_middles(of_points: Floats) -> float:
    """Return how far apart the middles between opposite points of six are: zero for one centre.

    A point reflection that exchanges the right-hand and the left-hand path takes each stop to the
    opposite one, so its centre is the middle of all three pairs.
    """
    middles = (of_points[:3] + of_points[3:]) / 2
    return float(np.linalg.norm(middles[:, None] - middles, axis=-1).max())


# --- postures -------------------------------------------------------------------------------------


@cache
def arm() -> PlanarArm:
    """Return the tool of the paper's robot in polar coordinates about joint 1."""
    return planar_arm(robot())


def stretched() -> float:
    """Return q2 of the stretched pose that lies in the region, rad."""
    return arm().stretched


def reach(order: Sequence[int], of: Robot | None = None) -> Floats:
    """Return the distance of the tool from joint 1 on a path through scaled points, cm."""
    return planar_arm(of or robot()).reach(path_through(order, None, of).q)


def aspect(q: Floats) -> Floats:
    """Return on which side of the singular line q2 = `stretched` a configuration lies, -1 or 1."""
    return np.asarray(np.sign(q[..., 1] - stretched()))


def stretched_poses(factor: float | None = None) -> Floats:
    """Return where the outline of the scaled polygon meets the singular line, rad."""
    p = scaled(factor)
    ends = np.stack([p, np.roll(p, -1, axis=0)], axis=1)
    before, after = ends[:, 0, 1] - stretched(), ends[:, 1, 1] - stretched()
    cut = before * after < 0
    t = before[cut] / (before[cut] - after[cut])
    return np.asarray(ends[cut, 0] + t[:, None] * (ends[cut, 1] - ends[cut, 0]))


def is_cut_by_the_singular_line(q: Floats) -> bool:
    """Tell whether configurations lie on both sides of the singular line, or on it."""
    return bool(np.ptp(aspect(q)) > 0)


def scale_without_singular_poses() -> float:
    """Return the scale below which the polygon leaves the singular line outside.

    The lowest point lies below the line and the centroid above it; scaled by s the segment between
    them meets the line exactly for s at least the ratio of their distances in q2. Infinite where
    the line does not meet the polygon at all.
    """
    q2, middle = vertices()[:, 1], polygon.centroid(vertices())[1]
    toward = q2.min() if middle > stretched() else q2.max()
    ratio = float((stretched() - middle) / (toward - middle))
    return ratio if ratio <= 1 else np.inf


def det_jacobian(q: Floats) -> Floats:
    """Return the determinant of the tool's Jacobian in the plane, cm^2."""
    return np.asarray(np.linalg.det(tool_form().gradient(q)[..., PLANE, :]))


# --- the workspace --------------------------------------------------------------------------------


@cache
def workspace() -> Workspace:
    """Return what the tool reaches from the region."""
    return Workspace(by_windows())
