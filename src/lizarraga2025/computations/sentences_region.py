"""Sentences of Section 4 on boundary functions and on the feasible joint region."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from cspace import clearance, find_region
from cspace.arrays import Floats
from cspace.geometry import polygon
from cspace.geometry.polygon import self_crossings
from cspace.measures import bodies, scaling
from cspace.model.robot import HalfSpace, Pair, Robot
from cspace.region import Region, paper_rule, solve
from cspace.region.problem import Problem, state
from lizarraga2025 import closed_form
from lizarraga2025 import printed as paper
from lizarraga2025.computations.figures_region import bound_of_a_pair, sides_of_the_box
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import (
    corrected,
    floor,
    half_spaces,
    pairs,
    printed_function,
    robot,
    symmetric,
    tool_form,
)
from lizarraga2025.evidence.joint_region import (
    X_IN_CM,
    bodies_allow,
    body_gap,
    by_clearances,
    by_windows,
    depth_below_edges,
    in_base_box,
    largest_scale,
    least_height,
    square,
    within_the_windows,
)
from lizarraga2025.evidence.rounding import SMALL, contact, counted
from lizarraga2025.evidence.tool_paths import AROUND, PLANE, path_through
from lizarraga2025.verdicts import Outcome, judge, strongest, undetermined
from qbound.boundary import closest_approach, pair_vector
from qbound.circle import circle_roots


@computes("S-18")
def all_components_at_once() -> Outcome:
    alone = np.array(
        [
            np.linalg.norm(pair_vector(robot(), pair)(q))
            for pair in pairs()
            for q in _roots_of_one_component(pair)
        ]
    )
    apart = alone[alone > 0.5]
    far = f", up to {apart.max():.2f} cm" if len(apart) else ""
    return Outcome(
        judge(holds=len(apart) > 0),
        f"One component alone does not make a contact: at {len(apart)} of its {len(alone)} roots"
        f" the two points are more than 0.5 cm apart{far}. Table 6 uses roots of single"
        " components.",
    )


def _roots_of_one_component(pair: Pair) -> list[Floats]:
    """Return where one component of a pair's vector vanishes, all other joints at home."""
    vector = pair_vector(robot(), pair)
    (joint,) = vector.joints()
    found = []
    for component in (0, 2):
        c0, a, b = vector[component].along(joint, robot().home)
        roots = circle_roots(a, b, -c0)
        for root in roots.q if roots.count > 0 else ():
            q = np.array(robot().home)
            q[joint] = root
            found.append(q)
    return found


@computes("S-19")
def exactly_where_it_meets_itself() -> Outcome:
    printed = [closest_approach(robot(), pair).gap for pair in pairs()]
    exact = [closest_approach(symmetric(), pair).gap for pair in pairs(symmetric())]
    digit = [closest_approach(corrected(), pair).gap for pair in pairs(corrected())]
    allowed = [contact(pair) for pair in pairs()]
    return Outcome(
        judge(
            holds=all(gap < most for gap, most in zip(printed, allowed, strict=True)),
            under=max(exact) < SMALL
            and all(gap < most for gap, most in zip(digit, allowed, strict=True)),
        ),
        f"With the offsets to two decimals the points of a pair come to within {min(printed):.4f}"
        f" to {max(printed):.4f} cm of each other, with x_{{2,13}} = 9.09 (T-4.2) to within"
        f" {max(digit):.4f} cm; rounding allows {min(allowed):.4f} cm and more. With the unrounded"
        " shape behind them all four pairs meet, at one angle each.",
    )


@computes("S-20")
def half_spaces_are_independent() -> Outcome:
    alone = [_vanishes_alone(i) for i in range(len(half_spaces()))]
    place = tool_form()(square(180))
    signs = np.stack([place @ half.normal >= half.offset for half in half_spaces()], axis=-1)
    patterns = np.unique(signs.reshape(-1, 3), axis=0)
    nested = not (signs[..., 0] & ~signs[..., 1]).any()
    return strongest(
        {
            "each of them being a condition by itself": judge(holds=all(alone)),
            "each being free of what the others say": judge(
                holds=len(patterns) == 8, under=nested and len(patterns) == 6
            ),
        },
        f"{sum(alone)} of the {len(alone)} functions vanish in poses in which no other does. Of the"
        f" 8 combinations of signs {len(patterns)} occur: B5 asks x >= 15 cm and B6 x >= -15 cm of"
        f" the same point ({X_IN_CM}), so B5 implies B6.",
    )


def _vanishes_alone(index: int) -> bool:
    """Tell whether a half-space's function vanishes in some pose in which no other one does."""
    forms = [clearance(robot(), half) for half in half_spaces()]
    q1 = np.linspace(-np.pi, np.pi, 73)
    c0, a, b = forms[index].along(1, np.stack([q1, q1], -1))
    roots = circle_roots(a, b, -c0)
    q = np.stack([q1, roots.q[1]], -1)[roots.count == 2]
    others = [np.abs(form(q)) > SMALL for i, form in enumerate(forms) if i != index]
    return bool(np.all(others, axis=0).any())


@computes("S-20.1")
def limits_are_respected() -> Outcome:
    areas = [
        sum(c.area for c in solve(_limited(walls), robot().home).components)
        for walls in (half_spaces()[2:], half_spaces()[1:], half_spaces())
    ]
    kept = [bool(np.isclose(area, areas[0], rtol=1e-9)) for area in areas[1:]]
    q = square()
    inside = int(in_base_box(q[paper_rule.feasible(robot(), q)]).sum())
    anyway = in_base_box(within_the_windows()).any()
    return strongest(
        {
            "three sides of one box round the base that the tool stays out of": judge(
                holds=inside == 0, constrains=bool(anyway)
            ),
            "three half-spaces, of which the caption of Figure 4 names one": judge(
                holds=all(kept), under=areas[0] > 0
            ),
        },
        "The selected region respects B7, the one that its caption names. B5 and B6 of the same"
        f" table are drawn in red and, as half-spaces, cut it: with B6 in force {areas[1]:.4f} of"
        f" {areas[0]:.4f} rad² would be left, with B5 too {areas[2]:.4f} ({X_IN_CM}). As the sides"
        " of a box from -15 to 15 cm whose top is B7 they are kept, but nothing could violate that:"
        f" of {len(q) ** 2} configurations on a grid {inside or 'none'} in the region has the tool"
        f" in it, and by the windows of the pairs alone {'some have' if anyway else 'none has'}.",
    )


def _limited(walls: tuple[HalfSpace, ...]) -> Problem:
    """State the paper's box of windows with these half-spaces in force."""
    box = paper_rule.box(robot())
    ranges = list(zip(box.lower.tolist(), box.upper.tolist(), strict=True))
    return state(robot(), walls, ranges, [("q1.lower", "q1.upper"), ("q2.lower", "q2.upper")])


@computes("S-9.2")
@computes("S-20.2")
@computes("S-20.4")
def the_complete_workspace() -> Outcome:
    free = {name: _free_by_bodies_and_by_rule(arm) for name, arm in _robots().items()}
    same = {name: np.array_equal(*both) for name, both in free.items()}
    whole, rule = free["printed"]
    angle = {name: _angle_to_contact(arm) for name, arm in _robots().items()}
    return Outcome(
        judge(holds=same["printed"], under=same["corrected"] and same["symmetric"]),
        f"Of {whole.size} configurations on a grid a check of the rebuilt bodies frees"
        f" {np.count_nonzero(whole)}. The windows and the tool's limit leave out"
        f" {np.count_nonzero(whole & ~rule)} of them, for one side stops {angle['printed']:.4f}°"
        f" early, and free {np.count_nonzero(rule & ~whole) or 'none'} of the others. With"
        f" x_{{2,13}} = 9.09 (T-4.2) both free the same, and no side is off by more than"
        f" {angle['corrected']:.4f}°. In the plane of the tool the image of the region is meant,"
        " not what the image of its boundary encloses (S-50).",
    )


def _free_by_bodies_and_by_rule(arm: Robot) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return on a grid of 120 by 120 what a check of the whole bodies frees, and what the rule."""
    q = square(120)
    return (body_gap(q, arm) > 0) & (floor()(q) >= 0), paper_rule.feasible(arm, q)


@computes("S-20.3")
def the_range_is_quantified() -> Outcome:
    box, region = paper_rule.box(robot()), by_windows()
    corners = sorted(corner.q.tolist() for corner in closed_form.vertices(robot()))
    found = sorted(vertex.q.tolist() for vertex in region.vertices)
    same = len(found) == len(corners) and np.allclose(found, corners, atol=SMALL)
    return Outcome(
        judge(holds=same and _gives(box, "arctan"), under=same and _gives(box, "atan2")),
        "With the inverse tangent as atan2 Table 6 gives the four sides of the box of windows, and"
        f" its bounds meet in the {len(corners)} corners that a complete decomposition of the"
        " region finds: closed formulas of the offsets, as precise as these. With arctan it gives"
        " other sides. Whether a contact is where a bound is, is another question (S-28).",
    )


def _gives(box: paper_rule.Box, reading: paper.Reading) -> bool:
    """Tell whether the rows of Table 6 for the pairs give the sides of the box."""
    sides = sorted(bound_of_a_pair(label, reading) for label in sides_of_the_box(reading))
    return np.allclose(sides, sorted([*box.lower, *box.upper]), atol=SMALL)


@computes("S-21")
def combinations_of_cosine_and_sine() -> Outcome:
    q = np.random.default_rng(4).uniform(-3, 3, (50, 2))
    worst, count = 0.0, 0
    for pair in pairs():
        vector = pair_vector(robot(), pair)
        (joint,) = vector.joints()
        c0, a, b = vector.along(joint, q)
        angle = q[:, joint, None]
        rest = vector(q) - (a * np.cos(angle) + b * np.sin(angle) + c0)
        worst, count = max(worst, float(np.abs(rest).max())), count + 2
    return Outcome(
        judge(holds=worst < SMALL),
        f"The {count} components of the pairs are, each of one joint, plus a constant. The"
        f" {len(half_spaces())} of the half-spaces are so along either joint, with coefficients"
        " that depend on the other.",
    )


@computes("S-21.1")
def right_is_upper_and_left_is_lower() -> Outcome:
    q1 = np.linspace(-np.pi, np.pi, 721)
    rows = sorted({label.rpartition(",")[0] for label in paper.TABLE_6})
    ordered = [
        bool((_bound(f"{row},1}}", q1) >= _bound(f"{row},2}}", q1) - SMALL).all()) for row in rows
    ]
    return Outcome(
        judge(holds=all(ordered), under=any(ordered)),
        f"In {sum(ordered)} of {len(ordered)} rows of Table 6 the value with k = 1 is the larger,"
        " whichever arctangent is meant, as both columns have the same one. The caption of Figure 4"
        " names an upper side by k = 2 (F-4.2).",
    )


def _bound(label: str, q1: Floats) -> Floats:
    """Return a bound of Table 6 over the first joint, where it is real, rad; zero elsewhere."""
    with np.errstate(invalid="ignore"):
        value = printed_function(paper.TABLE_6[label])(q1)
    return np.asarray(np.nan_to_num(np.broadcast_to(value, q1.shape)))


@computes("S-22")
def several_regions() -> Outcome:
    from scipy.ndimage import label

    points, near = by_clearances().components, by_small_clearances().components
    whole = int(label(bodies_allow(square(180)))[1])
    areas = ", ".join(f"{c.area:.4f}" for c in points)
    return strongest(
        {
            "regions of the boundary functions": judge(
                holds=min(len(points), len(near)) > 1, under=len(points) > 1
            ),
            "regions of the whole links": judge(holds=whole > 1),
        },
        f"By the clearances of the points there are {len(points)} ({areas} rad²), with the d_min ="
        f" {robot().required_distance(pairs()[0]):g} cm of the robot file, as the text prints none"
        f" (E-11); with {SMALLEST:g} cm, less than any pair comes close, {len(near)}. By the"
        f" rebuilt bodies of the links there is {whole}, on a grid of 180 by 180: in the others the"
        " bodies overlap.",
    )


SMALLEST: Final = 1e-4
"""A distance of points, cm, that the printed offsets let no pair come to."""


@cache
def by_small_clearances() -> Region:
    """Return the regions with a d_min that makes no wall of any pair."""
    boundaries = (replace(b, clearance=SMALLEST) if b in pairs() else b for b in robot().boundaries)
    return find_region(replace(robot(), boundaries=tuple(boundaries)))


@computes("S-23")
@computes("S-23.2")
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
        f" {robot().required_distance(pairs()[0]):g} cm of the robot file, as the text prints none;"
        f" {sum(with_home)} of {len(with_home)} contains home. It is bounded by {', '.join(names)},"
        f" so every way out of it crosses one. With {SMALLEST:g} cm the pairs make no wall, and"
        f" there is {counted(near, 'region')} (S-22).",
    )


def _is_home_alone(with_home: list[bool]) -> bool:
    """Tell whether there are other regions than the first, which alone contains home."""
    return with_home == [True, *([False] * (len(with_home) - 1))] and len(with_home) > 1


@computes("S-23.1")
def home_pose_is_not_printed() -> Outcome:
    poses = {"both joints at zero": (0, 0), "the arm upright": (-30, -60), "q1 alone": (45, 0)}
    within = {name: bool(paper_rule.feasible(robot(), np.radians(q))) for name, q in poses.items()}
    seen = ", ".join(f"{name} ({q1}°, {q2}°)" for name, (q1, q2) in poses.items() if within[name])
    return Outcome(
        undetermined(within),
        f"The selected region holds {sum(within.values())} of {len(within)} candidates: {seen}. Any"
        " pose in it gives the same region, so nothing hangs on it; the robot file takes the pose"
        " in which Tables 1 and 2 are read off, both joints at zero.",
    )


@computes("S-24")
def six_intersection_points() -> Outcome:
    by_rule = {name: len(closed_form.vertices(arm)) for name, arm in _robots().items()}
    home = by_clearances().home
    count = len(home.vertices) if home else 0
    return Outcome(
        judge(holds=set(by_rule.values()) == {6} and len(by_windows().vertices) == 6),
        f"The region has {len(by_windows().vertices)} by the paper's rule, for the printed offsets"
        " as for those with one digit corrected and the symmetric ones; by the clearances the home"
        f" region has {count}.",
    )


def _robots() -> dict[str, Robot]:
    return {"printed": robot(), "corrected": corrected(), "symmetric": symmetric()}


@computes("S-25")
def nonlinear_functions_are_violated() -> Outcome:
    depth = depth_below_edges()
    corners = closed_form.vertices(robot())
    shared = [
        next(iter(set(one.bounds) & set(other.bounds))).boundary
        for one, other in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    match = all((d > SMALL) == (name == "B7") for d, name in zip(depth, shared, strict=True))
    worst = sorted(depth)[-2:]
    return Outcome(
        judge(holds=bool(depth.max() > SMALL) and match),
        "Just the two edges between points of B7, the only function of two joints, leave the"
        f" region, by {worst[1]:.4f} and {worst[0]:.4f} cm; the four on straight lines do not.",
    )


@computes("S-26")
def tangents_mend_it() -> Outcome:
    inner = {n: closed_form.refined(robot(), n, tangents=True) for n in (2, 3, 5)}
    least = {n: scaling.least_along_edges(floor(), p)[0] for n, p in inner.items()}
    kept = 100 * polygon.area(inner[5]) / by_windows().area
    chord = closed_form.refined(robot(), 33, tangents=False)
    deep = -scaling.least_along_edges(floor(), chord)[0]
    return Outcome(
        judge(holds=min(least.values()) > -SMALL),
        f"Corners of tangents at five points of each curve keep every bound and {kept:.3f} % of the"
        " region's area, without a margin. Points on the curve itself, joined by chords, do not:"
        f" with {len(chord)} points the tool is still {deep:.4f} cm too low.",
    )


@computes("S-27")
def scaling_mends_it() -> Outcome:
    safe = largest_scale()
    margins = [least_height(s) for s in np.linspace(0.05, safe.scale - 1e-9, 20)]
    return Outcome(
        judge(holds=least_height(0.98) > 0, under=min(margins) > -SMALL),
        f"From scale {safe.scale:.6f} down; edge {safe.edge + 1} to {safe.edge + 2} binds, at q1 ="
        f" {np.degrees(safe.q[0]):.4f}°, q2 = {np.degrees(safe.q[1]):.4f}°. The text states no"
        " factor, so a reader has to find it.",
    )


@computes("S-28")
def contact_on_the_boundary() -> Outcome:
    contacts = [_gap_of_bodies(pair) < contact(pair) for pair in pairs()]
    worst = {name: _angle_to_contact(arm) for name, arm in _robots().items()}
    return strongest(
        {
            "a collision that may follow there": judge(holds=any(contacts)),
            "a contact that is there on every side": judge(
                holds=worst["printed"] < 1e-6, under=worst["symmetric"] < 1e-6
            ),
        },
        f"On {sum(contacts)} of the {len(contacts)} sides of the box of windows two of the rebuilt"
        " bodies touch,"
        " within the rounding of the printed offsets; for the unrounded shape on all. As printed,"
        f" one side stops {worst['printed']:.4f}° before the contact, with one digit corrected none"
        f" by more than {worst['corrected']:.4f}°.",
    )


def _gap_of_bodies(pair: Pair) -> float:
    """Return how far the bodies of a pair's links are apart where its window ends, cm."""
    (joint,) = pair_vector(robot(), pair).joints()
    box, q = paper_rule.box(robot()), np.array(robot().home, dtype=float)
    sides = ((box.lower_bounds[joint], box.lower), (box.upper_bounds[joint], box.upper))
    q[joint] = next(ends[joint] for bound, ends in sides if bound.boundary == pair.name)
    frames = (str(joint), str(joint + 1))
    return abs(float(bodies.gaps(robot(), q)[frames]))


def _angle_to_contact(arm: Robot) -> float:
    """Return the largest angle between a side of the box and the contact of bodies, deg."""
    box = paper_rule.box(arm)
    free = np.array([bodies.contact_free_interval(arm, joint) for joint in (0, 1)])
    return float(np.degrees(np.abs(free - np.stack([box.lower, box.upper], -1)).max()))


@computes("S-29")
def order_is_not_kept() -> Outcome:
    around = path_through(AROUND)
    once = len({tuple(p) for p in np.round(around.q[around.stops][:-1], 9)}) == 6
    crossed = len(self_crossings(tool_form()(around.q)[:, PLANE]))
    return Outcome(
        judge(holds=once and crossed > 0),
        "Each of the six points is visited once, and the tool's path crosses itself in"
        f" {counted(crossed, 'place')}.",
    )
