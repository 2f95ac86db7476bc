"""Entries for which all components of a region are found, or all corners by another method."""

from dataclasses import replace
from typing import Final, get_args

import numpy as np

from cspace.model.robot import Robot
from cspace.region import find_region
from lizarraga2025 import printed as paper
from lizarraga2025.beyond import evidence
from lizarraga2025.beyond.evidence import FILES, by_clearances, decomposed, robot, with_clearance
from lizarraga2025.computations.region import sides_of_the_box
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import pairs
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
        f"Of the robot studied {len(stated) or 'no'} limits are printed. Limits beyond the ends of"
        f" the windows, {box[0, 0]:.2f}° and {box[1, 0]:.2f}°, {box[0, 1]:.2f}° and"
        f" {box[1, 1]:.2f}°, fit all that is printed and change nothing: the area around home is"
        f" {', '.join(f'{a:.6f} rad² with limits {name}' for name, a in area.items())}.",
    )


@computes("E-11")
def least_distance() -> Outcome:
    gaps = [closest_approach(robot(), pair).gap for pair in pairs()]
    seen, fits = [], {}
    for d in (0.01, 0.1, 0.5):
        area, corners = _home(with_clearance(robot(), d))
        walls = sum(gap < d for gap in gaps)
        fits[str(d)] = walls == len(gaps) and corners == 6
        seen.append(f"d_min = {d} cm: {walls} walls, {corners} corners, {area:.6f} rad²")
    stated = any(o.label == "d_{min}" for o in paper.OFFSETS)
    return Outcome(
        judge(holds=True) if stated else undetermined(fits),
        f"Of the robot studied {'a' if stated else 'no'} distance is printed, and the pairs come as"
        f" close as {min(gaps):.4f} to {max(gaps):.4f} cm, so d_min = 0 makes no wall at all."
        f" {'; '.join(seen)}. The largest gap is the doing of one digit (T-4.2).",
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
        judge(holds=len(vertices()) == 6 and evidence.corners_agree() and max(residuals) < SMALL),
        f"{len(vertices())} corners in closed form; both components vanish in each, but for"
        " rounding, and a complete decomposition of the region finds the same corners.",
    )


@computes("S-9")
def three_kinds_of_constraints() -> Outcome:
    first = replace(robot().joints[0], limits=tuple(np.radians([-60.0, 60.0])))
    arm = replace(robot(), joints=(first, *robot().joints[1:]))
    names = {arc.boundary for loop in find_region(arm).home_component.loops for arc in loop}
    bound = {
        "joint limits": sorted(name for name in names if name.startswith("q1.")),
        "point pairs": sorted(names & {pair.name for pair in arm.used_pairs}),
        "half-spaces": sorted(names & {half.name for half in arm.used_half_spaces}),
    }
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
        judge(
            holds=evidence.corners_agree() and gives["arctan"],
            under=evidence.corners_agree() and gives["atan2"],
        ),
        f"With atan2 Table 6 gives the sides of the box of windows and the {len(vertices())}"
        " corners that a complete decomposition of the region finds, as closed formulas of the"
        " offsets. With arctan it gives other sides.",
    )


@computes("S-22")
def several_regions() -> Outcome:
    from scipy.ndimage import label

    points, near = by_clearances().components, by_clearances(SMALLEST).components
    whole = int(label(evidence.bodies_allow(square(180)))[1])
    areas = ", ".join(f"{c.area:.4f}" for c in points)
    return of_readings(
        f"By the clearances of the points there are {len(points)} ({areas} rad²), with a d_min of"
        f" {pairs()[0].clearance:g} cm, as the text prints none (E-11); with {SMALLEST:g} cm, less"
        f" than any pair comes close, {len(near)}. By the rebuilt bodies of the links there is"
        f" {whole}, on a grid of 180 by 180.",
        reading(
            "regions of the points", holds=min(len(points), len(near)) > 1, under=len(points) > 1
        ),
        reading("regions of the whole links", holds=whole > 1),
    )


SMALLEST: Final = 1e-4
"""A distance of points, cm, that the printed offsets let no pair come to."""


@computes("S-23", "S-23.2")
def other_regions_are_out_of_reach() -> Outcome:
    regions, near = by_clearances().components, len(by_clearances(SMALLEST).components)
    names = sorted({arc.boundary for loop in regions[0].loops for arc in loop})
    home, *others = (one.contains_home for one in regions)
    alone = home and bool(others) and not any(others)
    return Outcome(
        judge(holds=alone and near == len(regions), under=alone),
        f"Of the {len(regions)} connected pieces of what the clearances leave {home + sum(others)}"
        f" contains home. It is bounded by {', '.join(names)}, so every way out of it crosses one."
        f" With {SMALLEST:g} cm for d_min the pairs make no wall, and there is"
        f" {counted(near, 'region')} (S-22).",
    )


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
