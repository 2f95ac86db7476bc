"""Where does the tool go? Paths through the scaled polygon's points, postures, the workspace."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from lizarraga2025.evidence.arms import robot, symmetric, tool_form
from lizarraga2025.evidence.joint_region import SCALE, by_windows, scaled
from qbound.geometry.polylines import self_crossings
from qbound.model.robot import Robot
from qbound.paths.traversal import Traversal, simple_orders, traverse
from qbound.region import paper_rule
from qbound.workspace.areas import find_workspace
from qbound.workspace.planar import planar_arm

Floats = NDArray[np.float64]

RIGHT, LEFT = (5, 0, 1, 2, 3), (2, 3, 4, 5, 0)
"""The book's sequences for Figures 8 and 9, points from 0: 6-1-2-3-4 and 3-4-5-6-1."""

AROUND = (0, 1, 2, 3, 4, 5, 0)
"""Once round all six points and back."""

PLANE = [0, 2]
"""x and z of a place."""


def path_through(order: Sequence[int], factor: float = SCALE, of: Robot | None = None) -> Traversal:
    """Visit points of the scaled polygon in an order, from 0."""
    return traverse(of or robot(), scaled(factor, of)[list(order)])


def crossings(path: Traversal) -> int:
    """Count how often the tool's path crosses itself."""
    return len(self_crossings(path.tool[:, PLANE]))


@cache
def simple_sequences() -> tuple[tuple[int, ...], ...]:
    """Return the orders of five points whose tool path does not cross itself."""
    return tuple(simple_orders(robot(), scaled(), 5))


@cache
def neighbour_sequences() -> tuple[tuple[int, ...], ...]:
    """Return the twelve sequences of five neighbouring points, in both directions."""
    return tuple(tuple((s + d * i) % 6 for i in range(5)) for s in range(6) for d in (1, -1))


def simple_neighbours(factor: float = SCALE) -> list[tuple[int, ...]]:
    """Return the sequences of five neighbours whose tool path does not cross itself."""
    return [o for o in neighbour_sequences() if crossings(path_through(o, factor)) == 0]


def asymmetry(of: Robot, factor: float) -> float:
    """Return the Hausdorff distance of the left path from the mirrored right one, cm."""
    import shapely

    right, left = (path_through(order, factor, of).tool[:, PLANE] for order in (RIGHT, LEFT))
    one, other = shapely.LineString(right * [-1, 1]), shapely.LineString(left)
    return float(other.hausdorff_distance(one))


@cache
def asymmetry_of_the_symmetric() -> float:
    """Return the largest asymmetry of the symmetric arm, unscaled and scaled, cm."""
    return max(asymmetry(symmetric(), factor) for factor in (1.0, SCALE, 0.8))


# --- postures -------------------------------------------------------------------------------------


@cache
def stretched(of: Robot | None = None) -> float:
    """Return q2 of the stretched pose that lies in the region, rad."""
    x, z = (of or robot()).joints[1].origin[PLANE]
    return -float(np.arctan2(z, x))


def aspect(q: Floats, of: Robot | None = None) -> Floats:
    """Return on which side of the singular line q2 = `stretched` a configuration lies, -1 or 1."""
    return np.asarray(np.sign(q[..., 1] - stretched(of)))


def is_cut_by_the_singular_line(q: Floats) -> bool:
    """Tell whether configurations lie on both sides of the singular line, or on it."""
    return bool(np.ptp(aspect(q)) > 0)


def det_jacobian(q: Floats) -> Floats:
    """Return the determinant of the tool's Jacobian in the plane, cm^2."""
    return np.asarray(np.linalg.det(tool_form().gradient(q)[..., PLANE, :]))


def other_posture(q: Floats) -> Floats:
    """Return the second configuration with the tool at the same place, within one turn of zero."""

    def direction(q2: Floats) -> Floats:
        place = tool_form()(np.stack([0 * q2, q2], -1)) - robot().joints[0].origin
        return np.asarray(np.arctan2(place[..., 0], place[..., 2]))

    q2 = 2 * stretched() - q[..., 1]
    q1 = q[..., 0] + direction(q[..., 1]) - direction(q2)
    return np.asarray((np.stack([q1, q2], -1) + np.pi) % (2 * np.pi) - np.pi)


# --- the workspace --------------------------------------------------------------------------------


@cache
def workspace() -> dict[str, float]:
    """Return areas of the geometric workspace of the exact region by the paper's rule, cm^2.

    ``union`` of the images of both aspects, of this ``twice`` covered by both and ``once`` by one,
    by the exact workspace; ``enclosed`` by the image of the region's boundary alone, by faces of
    that closed path, whose outline is followed in 4,000 steps an arc.
    """
    import shapely

    exact = find_workspace(planar_arm(robot()), paper_rule.problem(robot()), robot().home)
    s = np.linspace(0, 1, 4001)[:-1]
    path = np.concatenate([tool_form()(arc.at(s))[:, PLANE] for arc in by_windows().loops[0]])
    ring = shapely.LinearRing(path)
    faces = shapely.union_all(shapely.polygonize([shapely.node(ring)]))
    return {
        "union": exact.area,
        "twice": exact.covered_twice,
        "once": exact.area - exact.covered_twice,
        "enclosed": float(faces.area),
    }
