"""Sentences of Section 4 on boundary functions and on the feasible joint region."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lizarraga2025 import closed_form
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import (
    corrected,
    floor,
    half_spaces,
    pairs,
    robot,
    symmetric,
    tool_form,
)
from lizarraga2025.evidence.joint_region import (
    bodies_allow,
    by_clearances,
    by_windows,
    depth_below_edges,
    largest_scale,
    least_height,
    square,
)
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import AROUND, crossings, path_through
from lizarraga2025.verdicts import Outcome, judge, undetermined
from qbound import circle_roots, pair_vector
from qbound.boundary.functions import closest_approach
from qbound.geometry import polygon
from qbound.measures import bodies, scaling
from qbound.model.robot import Pair, Robot
from qbound.region import paper_rule

Floats = NDArray[np.float64]


@computes("S-18")
def all_components_at_once() -> Outcome:
    alone = [
        float(np.linalg.norm(pair_vector(robot(), pair)(q)))
        for pair in pairs()
        for q in _roots_of_one_component(pair)
    ]
    apart = [d for d in alone if d > 0.5]
    return Outcome(
        judge(holds=len(apart) > 0),
        f"One component alone does not make a contact: its {len(alone)} roots include {len(apart)}"
        f" at which the two points are more than 0.5 cm apart, up to {max(alone):.4f} cm. Table 6"
        " uses roots of single components.",
    )


def _roots_of_one_component(pair: Pair) -> list[Floats]:
    """Return where one component of a pair's vector vanishes, all other joints at home."""
    vector = pair_vector(robot(), pair)
    (joint,) = vector.joints()
    found = []
    for component in (0, 2):
        c0, a, b = vector[component].along(joint, robot().home)
        for root in circle_roots(a, b, -c0).q:
            q = np.array(robot().home)
            q[joint] = root
            found.append(q)
    return found


@computes("S-19")
def exactly_where_it_meets_itself() -> Outcome:
    printed = [closest_approach(robot(), pair)[1] for pair in pairs()]
    exact = [closest_approach(symmetric(), pair)[1] for pair in pairs(symmetric())]
    return Outcome(
        judge(holds=max(printed) < SMALL, under=max(exact) < SMALL),
        f"With the printed digits no pair meets (least distances {min(printed):.4f} to"
        f" {max(printed):.4f} cm); with the unrounded shape all four do, to {SMALL:g} cm.",
    )


@computes("S-20")
def half_spaces_are_independent() -> Outcome:
    place = tool_form()(square(180))
    signs = np.stack([place @ half.normal >= half.offset for half in half_spaces()], axis=-1)
    patterns = {tuple(p) for p in np.unique(signs.reshape(-1, 3), axis=0).tolist()}
    never = [p for p in np.ndindex(2, 2, 2) if tuple(map(bool, p)) not in patterns]
    nested = all(p[0] == 1 and p[1] == 0 for p in never)
    return Outcome(
        judge(holds=not never, under=nested and len(never) == 2),
        f"{len(patterns)} of 8 combinations occur. B5 asks x >= 15 and B6 x >= -15 cm of the same"
        " point, so B5 implies B6; with B7 either is independent.",
    )


@computes("S-21")
def combinations_of_cosine_and_sine() -> Outcome:
    q = np.random.default_rng(4).uniform(-3, 3, (50, 2))
    worst, count = 0.0, 0
    for pair in pairs():
        vector = pair_vector(robot(), pair)
        (joint,) = vector.joints()
        c0, a, b = np.moveaxis(vector.along(joint, q), -1, 0)
        angle = q[:, joint, None]
        rest = vector(q) - (a * np.cos(angle) + b * np.sin(angle) + c0)
        worst, count = max(worst, float(np.abs(rest).max())), count + 2
    return Outcome(
        judge(holds=worst < SMALL),
        f"The {count} components of the point pairs are, of one joint each; the three of the walls"
        " are too along either joint, with coefficients that depend on the other.",
    )


@computes("S-22")
def several_regions() -> Outcome:
    from skimage.measure import label

    points = by_clearances().components
    whole = int(label(bodies_allow(square()), connectivity=1).max())  # type: ignore[no-untyped-call]
    areas = ", ".join(f"{c.area:.4f}" for c in points)
    return Outcome(
        judge(holds=whole > 1, under=len(points) > 1),
        f"By the clearances of the points there are {len(points)} ({areas} rad²). By the bodies of"
        f" the links there is {whole}: in the others the bodies overlap throughout.",
    )


@computes("S-23")
def other_regions_are_out_of_reach() -> Outcome:
    home, *others = by_clearances().components
    with_home = [c.contains_home for c in by_clearances().components]
    names = sorted({arc.boundary for loop in home.loops for arc in loop})
    return Outcome(
        judge(holds=with_home == [True, *([False] * len(others))]),
        "The regions are the connected pieces of what the clearances leave; home is in one of"
        f" {len(with_home)}, walled in by {', '.join(names)}.",
    )


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
        "Six by the paper's rule, for the printed, the mended and the symmetric offsets alike; by"
        f" the clearances the home region has {count} too.",
    )


def _robots() -> dict[str, Robot]:
    return {"printed": robot(), "mended": corrected(), "symmetric": symmetric()}


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
        judge(holds=match),
        "Exactly the two edges between points of B7, the only function of two joints, leave the"
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
        f"Corners of tangents at five points a curve keep every bound and {kept:.3f} % of the"
        " region's area, without a margin. Chords through points on the curve do not: with"
        f" {len(chord)} points the tool is still {deep:.5f} cm too low.",
    )


@computes("S-27")
def scaling_mends_it() -> Outcome:
    safe = largest_scale()
    margins = [least_height(s) for s in np.linspace(0.05, safe.scale - 1e-9, 20)]
    return Outcome(
        judge(holds=least_height(0.98) > 0, under=min(margins) > -SMALL),
        f"From scale {safe.scale:.9f} down; edge {safe.edge + 1} to {safe.edge + 2} binds, at q1 ="
        f" {np.degrees(safe.q[0]):.4f}°, q2 = {np.degrees(safe.q[1]):.4f}°. A reader has to find"
        " the factor: none is printed.",
    )


@computes("S-28")
def contact_on_the_boundary() -> Outcome:
    worst = {}
    for name, arm in _robots().items():
        box = paper_rule.box(arm)
        rooms = np.array([bodies.contact_free_interval(arm, joint) for joint in (0, 1)])
        worst[name] = float(np.degrees(np.abs(rooms - np.stack([box.lower, box.upper], -1)).max()))
    return Outcome(
        judge(holds=worst["printed"] < 1e-6, under=worst["symmetric"] < 1e-6),
        "Exactly so for the unrounded shape: on all four sides of the box two bodies touch. As"
        f" printed, the side of B4 stops {worst['printed']:.4f}° before the contact, with one digit"
        f" mended no side by more than {worst['mended']:.4f}°.",
    )


@computes("S-29")
def order_is_not_kept() -> Outcome:
    around = path_through(AROUND)
    simple_in_joints = len({tuple(p) for p in np.round(around.q[around.stops][:-1], 9)}) == 6
    return Outcome(
        judge(holds=simple_in_joints and crossings(around) > 0),
        "The six points are visited once each, and the tool's path crosses itself"
        f" {crossings(around)} time.",
    )
