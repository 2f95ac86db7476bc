"""What the entries on figures and text start from: regions, the scaled polygon, walks, samples."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from lizarraga2025.ledger.facts import robot, vertices
from qbound import clearance, find_region, load_robot
from qbound.boundary.functions import position
from qbound.forms.harmonic import HarmonicForm
from qbound.geometry import polygon
from qbound.measures import bodies, scaling
from qbound.measures.scaling import SafeScale
from qbound.model.robot import Robot
from qbound.paths.traversal import Traversal, self_crossings, simple_orders, traverse
from qbound.region import Component, Region, paper_rule, solve
from qbound.sampling import Sample, sample
from qbound.workspace.areas import find_workspace
from qbound.workspace.planar import planar_arm

Floats = NDArray[np.float64]

SCALE = 0.95
"""The book's scale: the paper states none."""

RIGHT, LEFT = (5, 0, 1, 2, 3), (2, 3, 4, 5, 0)
"""The book's sequences for Figures 8 and 9, points from 0: 6-1-2-3-4 and 3-4-5-6-1."""

PLANE = [0, 2]
"""x and z of a place."""


@cache
def symmetric() -> Robot:
    """Return the exactly symmetric robot behind the rounded offsets."""
    return load_robot("minervabot-v2-symmetric")


@cache
def corners(of: Robot | None = None) -> Floats:
    """Return the six points of a robot, rad, shape (6, 2)."""
    if of is None:
        return vertices()
    return np.array([corner.q for corner in paper_rule.vertices(of)])


@cache
def scaled(factor: float = SCALE, of: Robot | None = None) -> Floats:
    """Return the polygon scaled about the centroid of its area, rad."""
    return polygon.scaled(corners(of), factor, polygon.centroid(corners(of)))


@cache
def floor() -> HarmonicForm:
    """Return the height of the tool above its limit, cm (B7)."""
    return clearance(robot(), robot().boundary("B7"))


@cache
def by_points() -> Region:
    """Return all regions by the clearance rule."""
    return find_region(robot())


@cache
def by_windows() -> Component:
    """Return the exact region by the paper's rule."""
    (region,) = solve(paper_rule.problem(robot()), robot().home).components
    return region


@cache
def largest_scale(centre: str = "area") -> SafeScale:
    """Return the largest safe scale of the polygon about either centroid."""
    p = vertices()
    about = polygon.centroid(p) if centre == "area" else p.mean(axis=0)
    return scaling.largest_safe_scale(p, about, [floor()])


def least_height(factor: float) -> float:
    """Return the least height of the tool above its limit on the scaled polygon's edges, cm."""
    return scaling.least_along_edges(floor(), scaled(factor))[0]


def body_gap(q: Floats, of: Robot | None = None) -> Floats:
    """Return the least gap of any two bodies at configurations of shape (..., 2), cm."""
    found = bodies.gaps(of or robot(), q)
    return np.asarray(np.min(list(found.values()), axis=0))


def walk(order: Sequence[int], factor: float = SCALE, of: Robot | None = None) -> Traversal:
    """Visit points of the scaled polygon in an order, from 0."""
    return traverse(of or robot(), scaled(factor, of)[list(order)])


def crossings(of: Traversal) -> int:
    """Count how often the tool's path crosses itself."""
    return len(self_crossings(of.tool[:, PLANE]))


@cache
def simple() -> tuple[tuple[int, ...], ...]:
    """Return the orders of five points whose tool path does not cross itself."""
    return tuple(simple_orders(robot(), scaled(), 5))


@cache
def neighbours() -> tuple[tuple[int, ...], ...]:
    """Return the twelve sequences of five neighbouring points, in both directions."""
    return tuple(tuple((s + d * i) % 6 for i in range(5)) for s in range(6) for d in (1, -1))


@cache
def stretched(of: Robot | None = None) -> float:
    """Return q2 of the stretched pose that lies in the region, rad."""
    x, z = (of or robot()).joints[1].origin[PLANE]
    return -float(np.arctan2(z, x))


@cache
def tool_form(of: Robot | None = None) -> HarmonicForm:
    """Return the place of the tool, cm."""
    arm = of or robot()
    return position(arm, arm.tool)


def other_posture(q: Floats) -> Floats:
    """Return the second configuration with the tool at the same place, within one turn of zero."""

    def direction(q2: Floats) -> Floats:
        place = tool_form()(np.stack([0 * q2, q2], -1)) - robot().joints[0].origin
        return np.asarray(np.arctan2(place[..., 0], place[..., 2]))

    q2 = 2 * stretched() - q[..., 1]
    q1 = q[..., 0] + direction(q[..., 1]) - direction(q2)
    return np.asarray((np.stack([q1, q2], -1) + np.pi) % (2 * np.pi) - np.pi)


@cache
def drawn() -> Sample:
    """Return the book's draw of 100,000 configurations, judged by the paper's rule."""
    return sample(robot(), 100_000, paper_rule.feasible, seed=11)


def asymmetry(of: Robot, factor: float) -> float:
    """Return the Hausdorff distance of the left path from the mirrored right one, cm."""
    import shapely

    right, left = (walk(order, factor, of).tool[:, PLANE] for order in (RIGHT, LEFT))
    one, other = shapely.LineString(right * [-1, 1]), shapely.LineString(left)
    return float(other.hausdorff_distance(one))


@cache
def workspace() -> dict[str, float]:
    """Return areas of the geometric workspace of the exact region by the paper's rule, cm^2.

    ``union`` of the images of both aspects and ``twice`` covered by both, by the exact workspace;
    ``enclosed`` by the image of the region's boundary alone, by faces of that closed path, whose
    outline is followed in 4,000 steps an arc.
    """
    import shapely

    exact = find_workspace(planar_arm(robot()), paper_rule.problem(robot()), robot().home)
    s = np.linspace(0, 1, 4001)[:-1]
    path = np.concatenate([tool_form()(arc.at(s))[:, PLANE] for arc in by_windows().loops[0]])
    ring = shapely.LinearRing(path)
    faces = shapely.union_all(shapely.polygonize([shapely.node(ring)]))
    return {"union": exact.area, "twice": exact.covered_twice, "enclosed": float(faces.area)}
