"""Sentences of Section 4 on boundary functions and on the feasible joint region."""

from __future__ import annotations

import numpy as np

from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import (
    corrected,
    every_component,
    floor,
    half_spaces,
    pairs,
    robot,
    symmetric,
    tool_form,
)
from lizarraga2025.evidence.joint_region import (
    X_IN_CM,
    areas_by_walls,
    by_windows,
    depth_below_edges,
    edges,
    in_base_box,
    largest_scale,
    least_height,
    scaled,
    square,
    within_the_windows,
)
from lizarraga2025.evidence.rounding import SMALL, contact
from lizarraga2025.verdicts import Outcome, judge, of_readings, undetermined
from qbound import Pair, clearance, closest_approach, pair_vector, polygon
from qbound.arrays import Floats
from qbound.circle import TURN, circle_roots
from qbound.scaling import least_along, least_on_edges


@computes("S-17.1")
def joint_limits_are_captured() -> Outcome:
    forms, q = every_component(), robot().home
    turned = q + TURN * np.eye(len(q))
    growing = sum(bool((np.abs(form(turned) - form(q)) > SMALL).any()) for form in forms)
    return Outcome(
        judge(holds=growing > 0),
        "A joint value less its limit grows by a turn when the joint makes one. Of the"
        f" {len(forms)} components of the seven functions {growing or 'none'} does: they have the"
        " same value after a turn. Joint limits are eq. (10), for which no number is printed.",
    )


@computes("S-12.1")
def sides_from_pairs_of_points() -> Outcome:
    of_pairs = [edge.bound.boundary in {b.name for b in pairs()} for edge in edges()]
    return Outcome(
        judge(holds=all(of_pairs), under=any(of_pairs)),
        f"{sum(of_pairs)} of the {len(of_pairs)} sides of the joint region come from vectors"
        " between two points of the chain, the others from the limit of the tool, B7.",
    )


@computes("S-23.3")
def many_functions_no_unique_solution() -> Outcome:
    q = square()
    forms = every_component()
    signs = np.stack([form(q) > 0 for form in forms], axis=-1)
    patterns = len(np.unique(signs.reshape(-1, len(forms)), axis=0))
    region = len(np.unique(signs[by_windows().contains(q)], axis=0))
    return Outcome(
        judge(holds=patterns > region > 1),
        "The components' zero lines cut the square of one turn into pieces with"
        f" {patterns} different combinations of signs; the selected region has {region} of them, so"
        " no combination of signs tells it from the rest.",
    )


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
    return of_readings(
        "each of them being a condition by itself",
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
    areas = areas_by_walls()
    kept = [bool(np.isclose(area, areas[0], rtol=1e-9)) for area in areas[1:]]
    q = square()
    inside = int(in_base_box(q[by_windows().contains(q)]).sum())
    anyway = in_base_box(within_the_windows()).any()
    return of_readings(
        "three half-spaces, of which the caption of Figure 4 names one",
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


@computes("S-23.1")
def home_pose_is_not_printed() -> Outcome:
    poses = {"both joints at zero": (0, 0), "the arm upright": (-30, -60), "q1 alone": (45, 0)}
    within = {name: bool(by_windows().contains(np.radians(q))) for name, q in poses.items()}
    seen = ", ".join(f"{name} ({q1}°, {q2}°)" for name, (q1, q2) in poses.items() if within[name])
    return Outcome(
        undetermined(within),
        f"The selected region holds {sum(within.values())} of {len(within)} candidates: {seen}. Any"
        " pose in it gives the same region, so nothing hangs on it; the robot file takes the pose"
        " in which Tables 1 and 2 are read off, both joints at zero.",
    )


@computes("S-25")
def nonlinear_functions_are_violated() -> Outcome:
    depth = depth_below_edges()
    match = all(
        (d > SMALL) == (edge.bound.boundary == "B7") for d, edge in zip(depth, edges(), strict=True)
    )
    worst = sorted(depth)[-2:]
    return Outcome(
        judge(holds=bool(depth.max() > SMALL) and match),
        "Just the two edges between points of B7, the only function of two joints, leave the"
        f" region, by {worst[1]:.4f} and {worst[0]:.4f} cm; the four on straight lines do not.",
    )


@computes("S-26")
def tangents_mend_it() -> Outcome:
    inner = {n: by_windows().with_points(n, tangents=True) for n in (2, 3, 5)}
    least = {n: least_on_edges(floor(), p).value for n, p in inner.items()}
    kept = 100 * polygon.area(inner[5]) / by_windows().area
    chord = by_windows().with_points(33, tangents=False)
    deep = -least_on_edges(floor(), chord).value
    return Outcome(
        judge(holds=min(least.values()) > -SMALL),
        f"Corners of tangents at five points of each curve keep every bound and {kept:.3f} % of the"
        " region's area, without a margin. Points on the curve itself, joined by chords, do not:"
        f" with {len(chord)} points the tool is still {deep:.4f} cm too low.",
    )


@computes("F-6.1")
@computes("S-3")
@computes("S-27")
def scaling_mends_it() -> Outcome:
    safe = largest_scale()
    margins = [least_height(s) for s in np.linspace(0.05, safe.scale - 1e-9, 20)]
    p = scaled(safe.scale)
    legs = zip(p, np.roll(p, -1, axis=0), strict=True)
    edge = int(np.argmin([least_along(floor(), *leg).value for leg in legs]))
    return Outcome(
        judge(holds=least_height(0.98) > 0, under=min(margins) > -SMALL),
        f"From scale {safe.scale:.6f} down; edge {edge + 1} to {edge + 2} binds, at q1 ="
        f" {np.degrees(safe.q[0]):.4f}°, q2 = {np.degrees(safe.q[1]):.4f}°. The text states no"
        " factor, so a reader has to find it.",
    )
