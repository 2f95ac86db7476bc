"""The region of joint space by the windows of Table 6, and the scaled polygon."""

from dataclasses import replace
from functools import cache

import numpy as np

from lizarraga2025.choices import SCALE
from lizarraga2025.evidence.arms import floor, half_spaces, robot, tool_form
from lizarraga2025.readings import in_windows
from qbound import HalfSpace, Region, Robot, clearance, polygon, sample, scaling, window_region
from qbound.arrays import Bools, Floats
from qbound.region import Cut, Edge
from qbound.sampling import Sample
from qbound.scaling import Scale

X_IN_CM = "x_min read in cm, which T-5.2 leaves open"


@cache
def by_windows() -> Region:
    """Return the region by the windows of Table 6."""
    return window_region(robot())


@cache
def edges(of: Robot | None = None) -> tuple[Edge, ...]:
    """Return the edges of the region; none where the rule names no polygon."""
    try:
        return window_region(of or robot()).edges
    except ValueError:
        return ()


def vertices(of: Robot | None = None) -> Floats:
    """Return the six points of Figure 5, rad, shape (6, 2); none where there are no edges."""
    return np.array([edge.start.q for edge in edges(of)]).reshape(-1, 2)


def areas_by_walls() -> list[float]:
    """Return the areas that the windows leave with B7, then B6 and B7, then all in force, rad²."""
    return [_area_within(half_spaces()[first:]) for first in (2, 1, 0)]


def _area_within(walls: tuple[HalfSpace, ...]) -> float:
    cuts = (Cut(wall.name, 0, clearance(robot(), wall)) for wall in walls)
    return replace(by_windows(), cuts=tuple(cuts)).area


@cache
def scaled(factor: float | None = None, of: Robot | None = None) -> Floats:
    """Return the polygon scaled about the centroid of its area, rad; by `SCALE` if no factor."""
    factor = SCALE if factor is None else factor
    return polygon.scaled(vertices(of), factor, polygon.centroid(vertices(of)))


@cache
def largest_scale(centre: str = "area") -> Scale:
    """Return the largest scale about either centroid at which the polygon keeps the floor."""
    p = vertices()
    about = polygon.centroid(p) if centre == "area" else p.mean(axis=0)
    return scaling.largest_scale(floor(), p, about)


def least_height(factor: float) -> float:
    """Return the least height of the tool above its limit on the scaled polygon's edges, cm."""
    return scaling.least_on_edges(floor(), scaled(factor)).value


def along_edges(p: Floats, n: int) -> Floats:
    """Return n points of every edge of a closed polygon, its ends included; shape (m, n, 2)."""
    t = np.linspace(0, 1, n)[:, None]
    return np.asarray(p[:, None] + t * (np.roll(p, -1, axis=0) - p)[:, None])


def depth_below_edges() -> Floats:
    """Return how far the tool is below its limit, at most, on each edge of the polygon, cm."""
    return np.asarray(-floor()(along_edges(vertices(), 4001)).min(axis=1))


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
    return np.asarray(square()[by_windows().box.contains(square())])


@cache
def drawn() -> Sample:
    """Return the book's draw of 100,000 configurations, judged by the windows of Table 6."""
    return sample(robot(), 100_000, in_windows, seed=11)


def distance_of_the_draw() -> float:
    """Return how near the draw comes to a bound: rad to a side of the box, cm to the limit."""
    q, box = drawn().q, by_windows().box
    return float(np.abs(np.stack([*(q - box.lower).T, *(box.upper - q).T, floor()(q)])).min())


def share_of_square() -> float:
    """Return the part of one turn of both joints that the rule by windows leaves free."""
    return by_windows().area / (2 * np.pi) ** 2
