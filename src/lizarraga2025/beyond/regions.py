"""Entries for which all components of a region are found, or all corners by another method."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Final, get_args

import numpy as np

from cspace.model.robot import HalfSpace, Pair, Robot
from cspace.region import Region, find_region
from lizarraga2025 import printed as paper
from lizarraga2025.beyond.evidence import (
    FILES,
    bodies_allow,
    by_clearances,
    corners_agree,
    decomposed,
    robot,
    with_clearance,
)
from lizarraga2025.computations.region import sides_of_the_box
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import corrected, pairs
from lizarraga2025.evidence.joint_region import by_windows, square, vertices
from lizarraga2025.evidence.rounding import SMALL, counted
from lizarraga2025.verdicts import Outcome, judge, of_readings, reading, undetermined
from qbound import closest_approach, components


@computes("E-10")
def joint_limits() -> Outcome:
    stated = [o.label for o in paper.OFFSETS if o.label.startswith("q")]
    box = np.degrees([by_windows().box.lower, by_windows().box.upper])
    area = {}
    for name, limits in (("none", None), ("±180°", (-np.pi, np.pi)), ("±170°", (-2.967, 2.967))):
        joints = tuple(replace(joint, limits=limits) for joint in robot().joints)
        area[name], _ = _home(replace(robot(), joints=joints))
    same = {name: bool(np.isclose(a, area["none"])) for name, a in area.items()}
    return Outcome(
        judge(holds=True) if stated else undetermined(same),
        f"Of the robot studied {len(stated) or 'no'} limits are printed. The windows of Table 6 end"
        f" at {box[0, 0]:.2f}° and {box[1, 0]:.2f}° for the first joint and at {box[0, 1]:.2f}° and"
        f" {box[1, 1]:.2f}° for the second, so limits beyond these fit all that is printed and"
        " change nothing: the area around home is "
        + ", ".join(f"{a:.6f} rad² with limits {name}" for name, a in area.items())
        + ".",
    )


@computes("E-11")
def least_distance() -> Outcome:
    gaps = [closest_approach(robot(), pair).gap for pair in pairs()]
    seen, walls, fits = [], [], {}
    for d in (0.01, 0.1, 0.5):
        area, corners = _home(with_clearance(robot(), d))
        bounding = sum(gap < d for gap in gaps)
        walls.append(bounding)
        fits[str(d)] = bounding == len(gaps) and corners == 6
        seen.append(f"d_min = {d} cm: {bounding} walls, {corners} corners, {area:.6f} rad²")
    stated = any(o.label == "d_{min}" for o in paper.OFFSETS)
    by_digit = closest_approach(corrected(), pairs(corrected())[-1]).gap
    return Outcome(
        judge(holds=True) if stated else undetermined(fits),
        f"Of the robot studied {'a' if stated else 'no'} distance is printed, and the pairs come as"
        f" close as {min(gaps):.4f} to {max(gaps):.4f} cm, so d_min = 0 makes no wall at all; every"
        f" pair is a wall above {max(gaps):.4f} cm. {'; '.join(seen)}. That the first has only"
        f" {walls[0]} walls is the doing of one digit (T-4.2): with x_{{2,13}} = 9.09 the pair B4"
        f" comes as close as {by_digit:.4f} cm.",
    )


def _home(arm: Robot) -> tuple[float, int]:
    """Return area, rad^2, and number of vertices of the region around home; zeros for none."""
    region = find_region(arm)
    if not region.has_home:
        return 0.0, 0
    return region.home_component.area, len(region.home_component.vertices)


@computes("F-5.1")
def six_points_on_two_curves_each() -> Outcome:
    residuals = []
    for corner in by_windows().corners:
        for bound in corner.bounds:
            form = components(robot(), robot().boundary(bound.boundary))[bound.component - 1]
            residuals.append(abs(float(form(corner.q))))
    return Outcome(
        judge(holds=len(vertices()) == 6 and corners_agree() and max(residuals) < SMALL),
        f"{len(vertices())} corners in closed form; both components vanish in each, but for"
        " rounding, and a complete decomposition of the region finds the same corners.",
    )


@computes("S-9")
def three_kinds_of_constraints() -> Outcome:
    limits = np.radians([-60.0, 60.0])
    first = replace(robot().joints[0], limits=tuple(limits))
    arm = replace(robot(), joints=(first, *robot().joints[1:]))
    names = {arc.boundary for loop in find_region(arm).home_component.loops for arc in loop}
    kinds = {
        "joint limits": [n for n in names if n.startswith("q1.")],
        "point pairs": [b.name for b in arm.boundaries if isinstance(b, Pair)],
        "half-spaces": [b.name for b in arm.boundaries if isinstance(b, HalfSpace)],
    }
    bound = {kind: sorted(names.intersection(its)) for kind, its in kinds.items()}
    text = "; ".join(f"{kind} {', '.join(its) or 'none'}" for kind, its in bound.items())
    return Outcome(
        judge(holds=all(bound.values()), under=bool(bound["point pairs"] and bound["half-spaces"])),
        "With q1 limited to 60° either way, all three kinds bound one region of the paper's arm:"
        f" {text}. The case study itself prints no number for eq. (10).",
    )


@computes("S-20.3")
def the_range_is_quantified() -> Outcome:
    box, gives = by_windows().box, {}
    for arctan in get_args(paper.Reading):  # whether the rows for the pairs give the sides
        sides = sorted(sides_of_the_box(arctan).values())
        gives[arctan] = np.allclose(sides, sorted([*box.lower, *box.upper]), atol=SMALL)
    return Outcome(
        judge(holds=corners_agree() and gives["arctan"], under=corners_agree() and gives["atan2"]),
        f"With atan2 Table 6 gives the sides of the box of windows and the {len(vertices())}"
        " corners that a complete decomposition of the region finds, as closed formulas of the"
        " offsets. With arctan it gives other sides.",
    )


@computes("S-22")
def several_regions() -> Outcome:
    from scipy.ndimage import label

    points, near = by_clearances().components, by_small_clearances().components
    whole = int(label(bodies_allow(square(180)))[1])
    areas = ", ".join(f"{c.area:.4f}" for c in points)
    return of_readings(
        f"By the clearances of the points there are {len(points)} ({areas} rad²), with the d_min ="
        f" {pairs()[0].clearance:g} cm of the robot file, as the text prints none (E-11); with"
        f" {SMALLEST:g} cm, less than any pair comes close, {len(near)}. By the rebuilt bodies of"
        f" the links there is {whole}, on a grid of 180 by 180: in the others the bodies overlap.",
        reading(
            "regions of the points", holds=min(len(points), len(near)) > 1, under=len(points) > 1
        ),
        reading("regions of the whole links", holds=whole > 1),
    )


SMALLEST: Final = 1e-4
"""A distance of points, cm, that the printed offsets let no pair come to."""


@cache
def by_small_clearances() -> Region:
    """Return the regions with a d_min that makes no wall of any pair."""
    return find_region(with_clearance(robot(), SMALLEST))


@computes("S-23", "S-23.2")
def other_regions_are_out_of_reach() -> Outcome:
    with_home = [c.contains_home for c in by_clearances().components]
    near = len(by_small_clearances().components)
    loops = by_clearances().components[0].loops
    names = sorted({arc.boundary for loop in loops for arc in loop})
    return Outcome(
        judge(
            holds=near == len(with_home) and _is_home_alone(with_home),
            under=_is_home_alone(with_home),
        ),
        "The regions are the connected pieces of what the clearances leave, with the d_min ="
        f" {pairs()[0].clearance:g} cm of the robot file, as the text prints none;"
        f" {sum(with_home)} of {len(with_home)} contains home. It is bounded by {', '.join(names)},"
        f" so every way out of it crosses one. With {SMALLEST:g} cm the pairs make no wall, and"
        f" there is {counted(near, 'region')} (S-22).",
    )


def _is_home_alone(with_home: list[bool]) -> bool:
    """Tell whether there are other regions than the first, which alone contains home."""
    return with_home == [True, *([False] * (len(with_home) - 1))] and len(with_home) > 1


@computes("S-24")
def six_intersection_points() -> Outcome:
    by_rule = {len(vertices(robot(name))) for name in FILES}
    count = len(by_clearances().home_component.vertices)
    return Outcome(
        judge(holds=by_rule == {6} and len(decomposed().vertices) == 6),
        f"The region has {len(decomposed().vertices)} by the windows of Table 6, for the printed"
        " offsets as for those with one digit corrected and the symmetric ones; by the clearances"
        f" the home region has {count}.",
    )
