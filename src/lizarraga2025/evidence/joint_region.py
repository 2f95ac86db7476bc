"""The region of joint space, by the paper's windows and by clearances, and the scaled polygon."""

from __future__ import annotations

from functools import cache

import numpy as np

from cspace import find_region
from cspace.arrays import Bools, Floats
from cspace.geometry import polygon
from cspace.measures import bodies, scaling
from cspace.measures.scaling import SafeScale
from cspace.model.robot import Robot
from cspace.region import Component, Region, paper_rule, solve
from cspace.sampling import Sample, sample
from lizarraga2025 import closed_form
from lizarraga2025.evidence.arms import floor, half_spaces, robot, tool_form

SCALE = 0.95
"""The book's scale: the paper states none."""

X_IN_CM = "x_min read in cm, which T-5.2 leaves open"


@cache
def by_windows() -> Component:
    """Return the exact region by the paper's rule."""
    (region,) = solve(paper_rule.problem(robot()), robot().home).components
    return region


@cache
def by_clearances() -> Region:
    """Return all regions by the clearance rule."""
    return find_region(robot())


@cache
def vertices(of: Robot | None = None) -> Floats:
    """Return the six points of Figure 5, rad, shape (6, 2)."""
    return np.array([corner.q for corner in closed_form.vertices(of or robot())])


@cache
def scaled(factor: float | None = None, of: Robot | None = None) -> Floats:
    """Return the polygon scaled about the centroid of its area, rad; by `SCALE` if no factor."""
    factor = SCALE if factor is None else factor
    return polygon.scaled(vertices(of), factor, polygon.centroid(vertices(of)))


@cache
def largest_scale(centre: str = "area") -> SafeScale:
    """Return the largest scale about either centroid at which the polygon keeps the floor."""
    p = vertices()
    about = polygon.centroid(p) if centre == "area" else p.mean(axis=0)
    return scaling.largest_safe_scale(p, about, floor()[None])


def least_height(factor: float) -> float:
    """Return the least height of the tool above its limit on the scaled polygon's edges, cm."""
    return scaling.least_along_edges(floor(), scaled(factor))[0]


def depth_below_edges() -> Floats:
    """Return how far the tool is below its limit, at most, on each edge of the polygon, cm."""
    heights = floor()(polygon.along_edges(vertices(), np.linspace(0, 1, 4001)))
    return np.asarray(-heights.min(axis=1))


def body_gap(q: Floats, of: Robot | None = None) -> Floats:
    """Return the least gap of any two bodies at configurations of shape (..., 2), cm."""
    found = bodies.gaps(of or robot(), q)
    return np.asarray(np.min(list(found.values()), axis=0))


@cache
def least_gap_in_home_region() -> float:
    """Return the least gap of two bodies in forty copies of the home region's outline, cm.

    The copies are shrunk about the centroid, the largest by a thousandth: on the outline itself
    bodies may touch.
    """
    home = by_clearances().components[0]
    middle = np.array(home.centroid, dtype=float)
    outline = np.concatenate([arc.points for arc in home.loops[0]])
    factors = np.linspace(0, 0.999, 40)[:, None, None]
    return float(body_gap(middle + factors * (outline - middle)).min())


def gap_of_base_and_link_2(n: int = 121) -> tuple[float, float]:
    """Return the least gap of base and link 2 on a grid over the windows, and its error, cm.

    Between grid points the gap falls by at most what a corner of link 2 moves on the way there.
    """
    box, arm = paper_rule.box(robot()), robot()
    axes = np.linspace(box.lower, box.upper, n).T
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    between = float(bodies.gaps(arm, q)["0", "2"].min())
    last = next(body for body in arm.bodies if body.frame == "2")
    length = float(np.linalg.norm(last.shape.places, axis=-1).max())
    radii = np.array([np.linalg.norm(arm.joints[1].origin) + length, length])
    return between, float(radii @ (box.upper - box.lower) / (n - 1) / 2)


def bodies_allow(q: Floats) -> Bools:
    """Tell where no two bodies overlap and the tool keeps its limit."""
    return np.asarray((body_gap(q) > 0) & (floor()(q) >= 0))


def in_base_box(q: Floats) -> Bools:
    """Tell where the tool is in the box round the base that B5, B6 and B7 would bound together."""
    right, left, top = (half.offset for half in half_spaces())
    x, _, z = np.moveaxis(tool_form()(q), -1, 0)
    return np.asarray((left < x) & (x < right) & (z < top))


@cache
def square(n: int = 360) -> Floats:
    """Return the middles of an n by n grid of one turn of both joints, rad, shape (n, n, 2)."""
    middles = (np.arange(n) + 0.5) * (2 * np.pi / n) - np.pi
    return np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1)


def within_the_windows() -> Floats:
    """Return the configurations of `square` that the windows of the point pairs leave, rad."""
    box, q = paper_rule.box(robot()), square()
    return np.asarray(q[((box.lower <= q) & (q <= box.upper)).all(axis=-1)])


@cache
def drawn() -> Sample:
    """Return the book's draw of 100,000 configurations, judged by the paper's rule."""
    return sample(robot(), 100_000, paper_rule.feasible, seed=11)


def distance_of_the_draw() -> float:
    """Return how near the draw comes to a bound: rad to a side of the box, cm to the limit."""
    q, box = drawn().q, paper_rule.box(robot())
    return float(np.abs(np.stack([*(q - box.lower).T, *(box.upper - q).T, floor()(q)])).min())


def share_of_square() -> float:
    """Return the part of one turn of both joints that the paper's rule leaves free."""
    return by_windows().area / (2 * np.pi) ** 2
