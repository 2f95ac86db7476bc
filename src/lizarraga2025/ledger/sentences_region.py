"""Sentences of Section 4 on boundary functions and on the feasible joint region."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from lizarraga2025.ledger.entries import Finding, entry, judge, undetermined
from lizarraga2025.ledger.facts import SMALL, mended, pairs, robot, square, vertices, walls
from lizarraga2025.ledger.walks import (
    body_gap,
    by_points,
    by_windows,
    crossings,
    floor,
    largest_scale,
    least_height,
    symmetric,
    tool_form,
    walk,
)
from qbound import circle_roots, pair_vector
from qbound.boundary.functions import closest_approach
from qbound.geometry import polygon
from qbound.measures import bodies, scaling
from qbound.model.robot import Pair, Robot
from qbound.region import paper_rule

Floats = NDArray[np.float64]


@entry(
    "S-18", "sentence", "Section 4, second paragraph",
    "Two points collide only where all components vanish at once.",
    test="test_boundary.py::test_converse_of_theorem_1",
    chapter="03_theorem_1#answer",
)  # fmt: skip
def all_components_at_once() -> Finding:
    alone = [
        float(np.linalg.norm(pair_vector(robot(), pair)(q)))
        for pair in pairs()
        for q in _roots_of_one_component(pair)
    ]
    apart = [d for d in alone if d > 0.5]
    return Finding(
        judge(holds=len(apart) > 0),
        f"One component alone does not make a contact: its {len(alone)} roots include"
        f" {len(apart)} at"
        f" which the two points are more than 0.5 cm apart, up to {max(alone):.4f} cm. Table 6 uses"
        " roots of single components.",
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


@entry(
    "S-19", "sentence", "Section 4, second paragraph",
    "The constraints tell exactly where the manipulator meets itself.",
    test="test_boundary.py::test_printed_points_never_quite_meet",
    chapter="05_boundary_functions#where-the-points-come-closest",
)  # fmt: skip
def exactly_where_it_meets_itself() -> Finding:
    printed = [closest_approach(robot(), pair)[1] for pair in pairs()]
    exact = [closest_approach(symmetric(), pair)[1] for pair in pairs(symmetric())]
    return Finding(
        judge(holds=max(printed) < SMALL, under=max(exact) < SMALL),
        f"With the printed digits no pair meets (least distances {min(printed):.4f} to"
        f" {max(printed):.4f} cm); with the unrounded shape all four do, to {SMALL:g} cm.",
    )


@entry(
    "S-20", "sentence", "Section 4, third paragraph",
    "Geometric boundary functions may be satisfied independently of each other.",
    test="test_statements.py::test_walls_5_and_6_are_nested",
    chapter="05_boundary_functions#the-tables",
)  # fmt: skip
def walls_are_independent() -> Finding:
    height = tool_form()(square(180))
    signs = np.stack([height @ wall.normal >= wall.offset for wall in walls()], axis=-1)
    patterns = {tuple(p) for p in np.unique(signs.reshape(-1, 3), axis=0).tolist()}
    never = [p for p in np.ndindex(2, 2, 2) if tuple(map(bool, p)) not in patterns]
    nested = all(p[0] == 1 and p[1] == 0 for p in never)
    return Finding(
        judge(holds=not never, under=nested and len(never) == 2),
        f"{len(patterns)} of 8 combinations occur. B5 asks x >= 15 and B6 x >= -15 cm of the same"
        " point, so B5 implies B6; with B7 either is independent.",
    )


@entry(
    "S-21", "sentence", "Section 4, sentence before Theorem 2",
    "Several boundary functions are linear combinations of a cosine and a sine.",
    test="test_harmonic.py::test_along_a_joint_is_the_form_with_the_others_held",
    chapter="06_theorem_2#answer",
)  # fmt: skip
def combinations_of_cosine_and_sine() -> Finding:
    q = np.random.default_rng(4).uniform(-3, 3, (50, 2))
    worst, count = 0.0, 0
    for pair in pairs():
        vector = pair_vector(robot(), pair)
        (joint,) = vector.joints()
        c0, a, b = np.moveaxis(vector.along(joint, q), -1, 0)
        angle = q[:, joint, None]
        rest = vector(q) - (a * np.cos(angle) + b * np.sin(angle) + c0)
        worst, count = max(worst, float(np.abs(rest).max())), count + 2
    return Finding(
        judge(holds=worst < SMALL),
        f"The {count} components of the point pairs are, of one joint each; the three of the"
        " walls are"
        " too along either joint, with coefficients that depend on the other.",
    )


@entry(
    "S-22", "sentence", "Section 4, after Figure 4",
    "Several feasible regions exist.",
    test="test_region.py::test_the_papers_robot_has_five_components_with_these_areas",
    chapter="17_bodies#a-check-of-the-whole-bodies",
)  # fmt: skip
def several_regions() -> Finding:
    from skimage.measure import label

    points = by_points().components
    q = square()
    free = (body_gap(q) > 0) & (floor()(q) >= 0)
    whole = int(label(free, connectivity=1).max())  # type: ignore[no-untyped-call]
    areas = ", ".join(f"{c.area:.4f}" for c in points)
    return Finding(
        judge(holds=whole > 1, under=len(points) > 1),
        f"By the clearances of the points there are {len(points)} ({areas} rad²). By the bodies"
        " of the"
        f" links there is {whole}: in the others the bodies overlap throughout.",
    )


@entry(
    "S-23", "sentence", "Section 4, after Figure 4",
    "From home the other regions cannot be reached without crossing a boundary function.",
    test="test_region.py::test_only_the_first_component_holds_home",
    chapter="17_bodies#a-check-of-the-whole-bodies",
)  # fmt: skip
def other_regions_are_out_of_reach() -> Finding:
    home, *others = by_points().components
    holding = [c.contains_home for c in by_points().components]
    names = sorted({arc.boundary for loop in home.loops for arc in loop})
    return Finding(
        judge(holds=holding == [True, *([False] * len(others))]),
        "The regions are the connected pieces of what the clearances leave; home is in one of"
        f" {len(holding)}, walled in by {', '.join(names)}.",
    )


@entry(
    "S-23.1", "sentence", "Section 4, after Figure 4",
    "The robot has a home pose; its joint values are not printed.",
    test="test_robot.py::test_home_pose_holds_the_tool_where_the_offsets_add_up",
    chapter="04_planar_robot#the-home-pose",
)  # fmt: skip
def home_pose_is_not_printed() -> Finding:
    poses = {"both joints at zero": (0, 0), "the arm upright": (-30, -60), "q1 alone": (45, 0)}
    within = {name: bool(paper_rule.feasible(robot(), np.radians(q))) for name, q in poses.items()}
    seen = ", ".join(f"{name} ({q1}°, {q2}°)" for name, (q1, q2) in poses.items() if within[name])
    return Finding(
        undetermined(within),
        f"The selected region holds {sum(within.values())} of {len(within)} candidates: {seen}. Any"
        " pose in it gives the same region, so nothing hangs on it; the robot file takes the pose"
        " in which Tables 1 and 2 are read off, both joints at zero.",
    )


@entry(
    "S-24", "sentence", "Section 4, after Figure 4",
    "The region's boundary is defined by six intersection points.",
    test="test_paper_rule.py::test_six_vertices_use_six_curves_each_twice",
    chapter="07_joint_region#six-points",
)  # fmt: skip
def six_intersection_points() -> Finding:
    by_rule = {name: len(paper_rule.vertices(arm)) for name, arm in _robots().items()}
    home = by_points().home
    count = len(home.vertices) if home else 0
    return Finding(
        judge(holds=set(by_rule.values()) == {6} and len(by_windows().vertices) == 6),
        "Six by the paper's rule, for the printed, the mended and the symmetric offsets alike;"
        " by the"
        f" clearances the home region has {count} too.",
    )


def _robots() -> dict[str, Robot]:
    return {"printed": robot(), "mended": mended(), "symmetric": symmetric()}


@entry(
    "S-25", "sentence", "Section 4, after Figure 5",
    "Because some functions are not linear, constraints are violated along the straight boundary.",
    test="test_scaling.py::test_straight_edges_of_the_six_vertices_leave_the_region",
    chapter="07_joint_region#do-the-edges-stay-inside",
)  # fmt: skip
def nonlinear_functions_are_violated() -> Finding:
    t = np.linspace(0, 1, 4001)
    depth = -floor()(polygon.along_edges(vertices(), t)).min(axis=1)
    corners = paper_rule.vertices(robot())
    shared = [
        next(iter(set(one.bounds) & set(other.bounds))).boundary
        for one, other in zip(corners, corners[1:] + corners[:1], strict=True)
    ]
    match = all((d > SMALL) == (name == "B7") for d, name in zip(depth, shared, strict=True))
    worst = sorted(depth)[-2:]
    return Finding(
        judge(holds=match),
        "Exactly the two edges between points of B7, the only function of two joints, leave the"
        f" region, by {worst[1]:.4f} and {worst[0]:.4f} cm; the four on straight lines do not.",
    )


@entry(
    "S-26", "sentence", "Section 4, first remedy",
    "Additional tangent points where constraints are violated mend the boundary.",
    test="test_statements.py::test_tangents_stay_inside_and_chords_do_not",
    chapter="07_joint_region#first-remedy-more-points-on-the-curves",
)  # fmt: skip
def tangents_mend_it() -> Finding:
    inner = {n: paper_rule.refined(robot(), n, tangents=True) for n in (2, 3, 5)}
    least = {n: scaling.least_along_edges(floor(), p)[0] for n, p in inner.items()}
    kept = 100 * polygon.area(inner[5]) / by_windows().area
    chord = paper_rule.refined(robot(), 33, tangents=False)
    deep = -scaling.least_along_edges(floor(), chord)[0]
    return Finding(
        judge(holds=min(least.values()) > -SMALL),
        f"Corners of tangents at five points a curve keep every bound and {kept:.3f} % of the"
        " region's"
        f" area, without a margin. Chords through points on the curve do not: with {len(chord)}"
        " points"
        f" the tool is still {deep:.5f} cm too low.",
    )


@entry(
    "S-27", "sentence", "Section 4, second remedy",
    "Scaling about the centroid mends the boundary.",
    test="test_scaling.py::test_floor_of_the_papers_polygon_against_brute_force",
    chapter="07_joint_region#second-remedy-scaling-about-the-centroid",
)  # fmt: skip
def scaling_mends_it() -> Finding:
    safe = largest_scale()
    margins = [least_height(s) for s in np.linspace(0.05, safe.scale - 1e-9, 20)]
    return Finding(
        judge(holds=least_height(0.98) > 0, under=min(margins) > -SMALL),
        f"From scale {safe.scale:.9f} down; edge {safe.edge + 1} to {safe.edge + 2} binds, at q1 ="
        f" {np.degrees(safe.q[0]):.4f}°, q2 = {np.degrees(safe.q[1]):.4f}°. A reader has to find"
        " the"
        " factor: none is printed.",
    )


@entry(
    "S-28", "sentence", "Section 4, after Figure 6",
    "On a boundary function itself a collision is at hand.",
    test="test_bodies.py::test_on_the_symmetric_robot_points_and_bodies_leave_the_same_region",
    chapter="17_bodies#exactly",
)  # fmt: skip
def contact_on_the_boundary() -> Finding:
    worst = {}
    for name, arm in _robots().items():
        box = paper_rule.box(arm)
        rooms = np.array([bodies.room(arm, joint) for joint in (0, 1)])
        worst[name] = float(np.degrees(np.abs(rooms - np.stack([box.lower, box.upper], -1)).max()))
    return Finding(
        judge(holds=worst["printed"] < 1e-6, under=worst["symmetric"] < 1e-6),
        "Exactly so for the unrounded shape: on all four sides of the box two bodies touch. As"
        f" printed, the side of B4 stops {worst['printed']:.4f}° before the contact, with one digit"
        f" mended no side by more than {worst['mended']:.4f}°.",
    )


@entry(
    "S-29", "sentence", "Section 4, before Figure 7",
    "An ordered walk round the joint region does not give an ordered path of the tool.",
    test="test_traversal.py::test_crossings_of_known_paths",
    chapter="08_workspace#all-six-points",
)  # fmt: skip
def order_is_not_kept() -> Finding:
    around = walk((0, 1, 2, 3, 4, 5, 0))
    simple_in_joints = len({tuple(p) for p in np.round(around.q[around.stops][:-1], 9)}) == 6
    return Finding(
        judge(holds=simple_in_joints and crossings(around) > 0),
        "The six points are visited once each, and the tool's path crosses itself"
        f" {crossings(around)}"
        " time.",
    )
