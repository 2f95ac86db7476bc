"""What several computations beyond the paper start from: whole bodies, components, enclosed parts.

The arms are those of `lizarraga2025.evidence.arms`, with bodies, by the engine.
"""

from dataclasses import replace
from functools import cache
from typing import Any, Final

import numpy as np

from cspace import find_region, load_robot
from cspace.measures import bodies
from cspace.model.robot import Pair, Robot
from cspace.region import Component, Region, solve, window_problem
from lizarraga2025.evidence.arms import floor, tool_form
from lizarraga2025.evidence.joint_region import vertices
from lizarraga2025.evidence.rounding import SMALL
from qbound import window_region
from qbound.arrays import Bools, Floats
from qbound.windows import window_box
from qbound.workspace import PLANE

FILES: Final = {
    "printed": "minervabot-v2",
    "corrected": "minervabot-v2-corrected",
    "symmetric": "minervabot-v2-symmetric",
}


@cache
def robot(name: str = "printed") -> Robot:
    """Return the paper's robot, or one of its two variants, with bodies."""
    return load_robot(FILES[name])


@cache
def decomposed() -> Component:
    """Return the region by windows as the engine's complete decomposition finds it."""
    (region,) = solve(window_problem(window_region(robot()))).components
    return region


def corners_agree() -> bool:
    """Tell whether the complete decomposition finds the six points of Figure 5."""
    found = sorted(vertex.q.tolist() for vertex in decomposed().vertices)
    wanted = sorted(vertices().tolist())
    return len(found) == len(wanted) and np.allclose(found, wanted, atol=SMALL)


@cache
def by_clearances(gap: float | None = None) -> Region:
    """Return all regions by the clearance rule; with another least distance of pairs, if given."""
    return find_region(robot() if gap is None else with_clearance(robot(), gap))


def with_whole_bodies(of: Robot) -> Robot:
    """Return an arm that keeps its bodies apart, and the tool's limit."""
    return replace(of, boundaries=(of.boundary("B7"),), collisions=True)


@cache
def by_whole_bodies() -> Region:
    """Return the region of the rebuilt bodies, with the tool's limit."""
    return find_region(with_whole_bodies(robot()))


def with_clearance(of: Robot, gap: float) -> Robot:
    """Return an arm whose pairs of points keep another least distance, cm."""
    changed = (replace(b, clearance=gap) if isinstance(b, Pair) else b for b in of.boundaries)
    return replace(of, boundaries=tuple(changed))


@cache
def enclosed() -> Any:
    """Return what the tool's path round the exact region encloses, cm: polygons of shapely.

    The path is followed in 4,000 steps an arc; parts below a thousandth of a cm^2, where two arcs
    run on each other, are left out.
    """
    import shapely  # pages that run have none

    s = np.linspace(0, 1, 4001)[:-1]
    path = np.concatenate([tool_form()(arc.at(s))[:, PLANE] for arc in decomposed().loops[0]])
    parts = shapely.get_parts(enclosed_by(np.append(path, path[:1], axis=0)))
    return shapely.MultiPolygon([part for part in parts if part.area > 1e-3])


def enclosed_by(path: Floats) -> Any:
    """Return all places that a plane path, shape (m, 2), separates from infinity, by shapely."""
    import shapely

    return shapely.union_all(shapely.polygonize([shapely.node(shapely.LineString(path))]))


def body_gap(q: Floats, name: str = "printed") -> Floats:
    """Return the least gap of any two bodies at configurations of shape (..., 2), cm."""
    return np.asarray(np.min(list(bodies.gaps(robot(name), q).values()), axis=0))


def bodies_allow(q: Floats) -> Bools:
    """Tell where no two bodies overlap and the tool keeps its limit."""
    return np.asarray((body_gap(q) > 0) & (floor()(q) >= 0))


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
    box, arm = window_box(robot()), robot()
    axes = np.linspace(box.lower, box.upper, n).T
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    between = float(bodies.gaps(arm, q)["0", "2"].min())
    last = next(body for body in arm.bodies if body.frame == "2")
    length = float(np.linalg.norm(last.shape.places, axis=-1).max())
    radii = np.array([np.linalg.norm(arm.joints[1].origin) + length, length])
    return between, float(radii @ (box.upper - box.lower) / (n - 1) / 2)
