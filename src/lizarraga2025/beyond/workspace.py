"""Entries on what a path of the tool encloses in its plane."""

from typing import Any

import numpy as np
import shapely

from lizarraga2025.beyond.evidence import corners_agree, decomposed, enclosed, enclosed_by
from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import tool_form
from lizarraga2025.evidence.joint_region import by_windows, drawn, scaled, vertices
from lizarraga2025.evidence.rounding import SMALL, counted
from lizarraga2025.evidence.tool_paths import arm, aspect, path_through, stretched, workspace
from lizarraga2025.verdicts import Outcome, judge
from qbound import polygon
from qbound.arrays import Floats
from qbound.workspace import PLANE


@computes("S-1.1", "S-8", "S-50")
def boundary_of_the_workspace() -> Outcome:
    region, inside = decomposed(), enclosed().area
    union, twice = workspace().area, workspace().covered_twice
    whole, rest = (bool(np.isclose(inside + more, union, rtol=1e-6)) for more in (0.0, twice))
    in_joint_space = len(region.loops) == 1 and corners_agree()
    return Outcome(
        judge(holds=in_joint_space and whole, under=in_joint_space and rest),
        "It holds in joint space, where the boundary is"
        f" {counted(len(region.loops), 'closed curve')} through {len(region.vertices)} points in"
        f" closed form. Its image in the plane of the tool encloses {inside:.2f} of {union:.2f} cm²"
        " that are reached; the rest, reached in both postures, ends outside at the image of the"
        " singular line.",
    )


@computes("S-30.1")
def why_the_path_stays_open() -> Outcome:
    inside, union = enclosed().area, workspace().area
    rest = union - inside
    outside = rest > SMALL and bool(np.isclose(rest, workspace().covered_twice, rtol=1e-6))
    middle = np.array([polygon.centroid(vertices())[0], stretched()])
    reached = bool(by_windows().contains(middle))
    apart = min(_least_apart(scaled()[aspect(scaled()) == side]) for side in (-1, 1))
    return Outcome(
        judge(holds=reached and outside and apart < SMALL, under=reached and outside),
        f"The path round the region encloses {inside:.2f} of {union:.2f} cm²; the rest, reached in"
        " both postures, ends at the stretched arm, and no path through the points draws this edge."
        " Five points stay open for another reason (F-8.2): the three points on either side of the"
        f" singular line put the tool at places at least {apart:.2f} cm apart, at scale {SCALE:g}.",
    )


def _least_apart(q: Floats) -> float:
    """Return the least distance of any two of the tool's places, cm; infinite for fewer."""
    places = tool_form()(q)
    apart = np.linalg.norm(places[:, None] - places, axis=-1)
    return float(apart[~np.eye(len(q), dtype=bool)].min(initial=np.inf))


@computes("S-36.1")
def regions_of_figures_8_and_9() -> Outcome:
    opened, closed = ([_enclosed((*o, *o[:back])) for o in (RIGHT, LEFT)] for back in (0, 1))
    share, areas = min(map(_feasible_share, closed)), [part.area for part in opened + closed]
    least, none = min(areas[2:]), min(areas[:2])
    return Outcome(
        judge(holds=none > 0, under=least > 1 and share == 1),
        f"The two open paths enclose {max(areas[:2]):.0f} cm² each. Closed by the straight joint"
        f" path back they enclose {least:.1f} cm² or more, where of the places of the draw"
        f" {100 * share:.4g} % have a feasible posture.",
    )


def _enclosed(order: tuple[int, ...]) -> Any:
    """Return what the tool's path through points of the scaled polygon encloses, cm."""
    path = path_through(order).tool
    if order[0] == order[-1]:
        path[-1] = path[0]  # it is, but for rounding
    return enclosed_by(path)


def _feasible_share(inside: Any) -> float:
    """Return of the draw's places inside a polygon the part that has a feasible posture."""
    q = drawn().q[shapely.contains_xy(inside, drawn().tool[:, PLANE])]
    either = by_windows().contains(q) | by_windows().contains(arm().other_posture(q))
    return float(either.mean())


@computes("F-11.3", "S-42")
def lobes_show() -> Outcome:
    parts, inside = shapely.get_parts(enclosed()), enclosed().area
    once = workspace().area - workspace().covered_twice
    same = abs(inside - once) < 1e-3
    sides = sorted(float(np.sign(part.centroid.x)) for part in parts)
    return Outcome(
        judge(holds=same and sides == [-1, 1]),
        f"What the image of the region's boundary encloses, {inside:.2f} cm² in {len(parts)}"
        f" parts, is just the part with one allowed posture ({once:.2f} cm²): the lateral"
        " shapes, one on either side, are the places of both colours.",
    )
