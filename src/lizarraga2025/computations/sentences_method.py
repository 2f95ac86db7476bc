"""Sentences of the abstract, the introduction and Sections 2 and 3."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Final

import numpy as np

from cspace import find_region
from cspace.geometry import polygon
from cspace.model.robot import HalfSpace, Pair
from lizarraga2025 import closed_form
from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.computations.theorem_2 import interval
from lizarraga2025.evidence import effort
from lizarraga2025.evidence.arms import of_points, pairs, robot, symbolic_robot, tool_form
from lizarraga2025.evidence.joint_region import (
    SCALE,
    body_gap,
    by_clearances,
    by_windows,
    depth_below_edges,
    gap_of_base_and_link_2,
    largest_scale,
    least_gap_in_home_region,
    least_height,
    scaled,
    vertices,
)
from lizarraga2025.evidence.proofs import general, is_identity, theorem_2, vanishes
from lizarraga2025.evidence.rounding import SMALL, counted
from lizarraga2025.evidence.tool_paths import (
    is_cut_by_the_singular_line,
    neighbour_sequences,
    path_through,
    scale_without_singular_poses,
    stretched,
    workspace,
)
from lizarraga2025.verdicts import Outcome, judge, strongest
from qbound.boundary import components
from qbound.symbols import joint_symbols

# --- abstract -------------------------------------------------------------------------------------


@computes("S-1")
def intersections_give_a_continuous_boundary() -> Outcome:
    loops = by_windows().loops
    corners = [corner.q for corner in closed_form.vertices(robot())]
    ends = np.array([arc.points[[0, -1]] for arc in loops[0]])
    closed = np.allclose(ends[:, 1], np.roll(ends[:, 0], -1, axis=0), atol=SMALL)
    met = np.allclose(sorted(ends[:, 0].tolist()), sorted(map(list, corners)), atol=SMALL)
    outside = int((depth_below_edges() > SMALL).sum())
    return Outcome(
        judge(holds=len(loops) == 1 and closed and met),
        f"The {len(corners)} points are found in closed form, and the functions between them close"
        f" {counted(len(loops), 'curve')}, the boundary of the region. Straight lines between them"
        f" close a curve too; {outside} of them leave the region, for which the paper gives two"
        " remedies.",
    )


@computes("S-3")
@computes("S-6.1")
def scaled_region_gives_a_trajectory() -> Outcome:
    safe = largest_scale().scale
    below = [least_height(s) for s in (safe - 1e-6, 0.96, 0.95, 0.5)]
    return Outcome(
        judge(holds=least_height(0.99) > 0, under=min(below) > 0),
        f"The path round the scaled points keeps every bound up to scale {safe:.6f} and no further;"
        " no scale is stated.",
    )


@computes("S-4")
def final_pose_depends_on_the_path() -> Outcome:
    paths = [path_through(order) for order in neighbour_sequences()]
    poses = {tuple(np.round(w.final_pose, 9)) for w in paths}
    reach = [float(w.reach[-1]) for w in paths]
    return Outcome(
        judge(holds=len(poses) > 1 and np.ptp(reach) > 1),
        f"At scale {SCALE:g} the {len(paths)} sequences of five neighbours end in {len(poses)}"
        f" poses, with the tool {min(reach):.4f} to {max(reach):.4f} cm from joint 1.",
    )


@computes("S-5")
def nonlinear_workspace() -> Outcome:
    start, end = scaled()[:2]
    even = np.linspace(0, 1, 2001)[:, None]
    places = tool_form()(start + even * (end - start))
    straight = places[0] + even * (places[-1] - places[0])
    bend = float(np.linalg.norm(places - straight, axis=-1).max())
    return Outcome(
        judge(holds=bend > 1),
        "On the straight joint path from point 1 to point 2 the tool is up to"
        f" {bend:.2f} cm from where a linear map with the same ends would put it.",
    )


# --- introduction ---------------------------------------------------------------------------------


@computes("S-7")
def accuracy_and_effort() -> Outcome:
    closed = {k: effort.closed_form_evaluations(10.0**-k) for k in (3, 6, 9)}
    random = {k: effort.samples_needed(10.0**-k) for k in closed}
    text = "; ".join(f"1e-{k}: {closed[k]} against {random[k]:.2g} random samples" for k in closed)
    return strongest(
        {
            "done with eq. (38) and atan2, or Theorem 2 restated": judge(
                holds=all(closed[k] < random[k] for k in closed)
            ),
            "done with Theorem 2 as printed": judge(holds=interval(31).excludes),
        },
        "Roots, by Theorem 2 restated (TH-2), for the area of the joint region within a relative"
        f" error of {text}. Eq. (31) as printed leaves no angle out, so it bounds no area.",
    )


@computes("S-7.1")
def theorems_that_bound_q() -> Outcome:
    steps = theorem_2()
    return strongest(
        {
            "Theorem 2 restated": judge(
                holds=interval(31).excludes, under=bool(steps) and all(steps.values())
            ),
            "Theorem 2 as printed": judge(holds=True, constrains=interval(31).excludes),
        },
        "The text names no theorem so; of its two Theorem 2 bounds q. As printed its interval"
        " leaves no angle out; restated, it has as its ends the two roots, and"
        f" {sum(steps.values())} of the {len(steps)} steps of its proof are identities.",
    )


@computes("S-1.1")
@computes("S-8")
@computes("S-50")
def boundary_of_the_workspace() -> Outcome:
    region, areas = by_windows(), workspace()
    found = sorted(vertex.q.tolist() for vertex in region.vertices)
    wanted = sorted(vertices().tolist())
    same = len(found) == len(wanted) and np.allclose(found, wanted, atol=SMALL)
    whole, rest = (
        bool(np.isclose(areas["enclosed"] + more, areas["union"], rtol=1e-6))
        for more in (0.0, areas["twice"])
    )
    in_joint_space = len(region.loops) == 1 and same
    return Outcome(
        judge(holds=in_joint_space and whole, under=in_joint_space and rest),
        "It holds in joint space. There the boundary is"
        f" {counted(len(region.loops), 'closed curve')} through"
        f" {len(found)} points, which Theorem 2, restated with atan2, gives in closed form as a"
        " complete decomposition finds them. Its image in the plane of the tool encloses"
        f" {areas['enclosed']:.2f} of {areas['union']:.2f} cm² that are reached; the rest,"
        " reached in both postures, ends outside at the image of the singular line. For the"
        " geometric workspace this line has to be added.",
    )


@computes("S-9")
def three_kinds_of_constraints() -> Outcome:
    limits = np.radians([-60.0, 60.0])
    first = replace(robot().joints[0], limits=tuple(limits))
    arm = replace(robot(), joints=(first, *robot().joints[1:]))
    home = find_region(arm).home
    names = {arc.boundary for loop in (home.loops if home else ()) for arc in loop}
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


@computes("S-10")
def safety_margin() -> Outcome:
    scales = (0.96, 0.95, 0.9)
    heights = [least_height(s) for s in scales]
    t = np.linspace(0, 1, 501)
    apart = [float(body_gap(polygon.along_edges(scaled(s), t)).min()) for s in scales]
    text = "; ".join(
        f"{s:g}: {h:.4f} and {a:.4f} cm" for s, h, a in zip(scales, heights, apart, strict=True)
    )
    return Outcome(
        judge(holds=least_height(0.99) > 0, under=min(*heights, *apart) > 0),
        f"From scale {largest_scale().scale:.6f} down there is a margin. Least height of the tool"
        " above its limit and least gap of the rebuilt bodies of the links along the outline, by"
        f" scale: {text}.",
    )


@computes("S-10.1")
def singular_poses_are_avoided() -> Outcome:
    least = scale_without_singular_poses()
    used = [is_cut_by_the_singular_line(scaled(s)) for s in (0.96, 0.95, 0.9)]
    return Outcome(
        judge(holds=least >= 1, under=not any(used)),
        f"The singular line q2 = {np.degrees(stretched()):.4f}° passes close to the centroid, at q2"
        f" = {np.degrees(polygon.centroid(vertices())[1]):.4f}°: a region scaled about"
        f" it leaves the line outside only below scale {least:.6f}. At scales 0.96, 0.95 and 0.9"
        f" it is {'in' if all(used) else 'not always in'}side.",
    )


# --- Section 2 ------------------------------------------------------------------------------------


@computes("S-11")
def orthonormal_directions() -> Outcome:
    import sympy as sp

    frames = symbolic_robot()[0].frames(joint_symbols(robot()))
    names = ("1", "2")
    gram = [
        sp.Matrix(frames.rotation("0", n)).T * sp.Matrix(frames.rotation("0", n)) for n in names
    ]
    return Outcome(
        judge(holds=all(sp.simplify(g) == sp.eye(3) for g in gram)),
        "For both moving frames of the chain the nine dot products are those of the identity"
        " matrix, for all joint values, by identity.",
    )


@computes("E-3.1")
@computes("S-11.1")
def one_observer() -> Outcome:
    ends = ("a+n", "b+m")
    literally = {n: is_identity(n, ends, seen, seen) for n, seen in ((15, "a"), (19, "0"))}
    turned = is_identity(15, ends, "a") and is_identity(25, ends, "0")
    return Outcome(
        judge(holds=all(literally.values()), under=literally[19] and turned),
        "Where no matrix stands, as in eq. (19), it holds. A vector behind a matrix is seen from"
        " its own first index: seen from a instead, eq. (15) fails. Once the matrix has turned it,"
        " all terms of an equation are seen from one frame: a in eq. (15), the base in eq. (25).",
    )


@computes("S-11.2")
def convention_is_applied_throughout() -> Outcome:
    later = [number for number in paper.OBSERVERS if number > SECTION_2]
    sides = sorted(set(paper.OBSERVERS.values()))
    labels = [name for text in paper.EQUATION_29.values() for name in re.findall(r"[xz]_\w+", text)]
    two = all(re.fullmatch(r"[xz]_(\d+|min)_\d+", name) for name in labels)
    return Outcome(
        judge(holds=bool(later) and len(sides) == 1, under=two),
        f"It holds of the two indices of a vector, for its start and its end: all {len(labels)}"
        " lengths in eq. (29) have them. The observer, the third part of a label, is marked in"
        f" eqs. {', '.join(f'({n})' for n in paper.OBSERVERS)}, on the {' and on the '.join(sides)}"
        f" of the symbol, and in {len(later) or 'no'} equation after Section 2.",
    )


SECTION_2: Final = 8
"""The last equation of Section 2."""


@computes("S-11.3")
def letters_as_subscripts() -> Outcome:
    names = {n for text in paper.THEOREM_1.values() for n in re.findall(r"[rR]_(\w+)", text)}
    letters = sum(any(c.isalpha() for c in name) for name in names)
    return Outcome(
        judge(holds=letters > 0),
        f"{letters} of {len(names)} labels of Theorem 1 have letters; those of the robot have"
        " numbers.",
    )


@computes("S-11.4")
def components_of_a_vector() -> Outcome:
    lengths = [o for o in paper.OFFSETS if o.table in (3, 4)]
    same = 0
    for one in lengths:
        axis, _, point = re.findall(r"[xz]|\d+", one.label)
        same += bool(robot().point(point).at["xyz".index(axis)] == one.value)
    return Outcome(
        judge(holds=same == len(lengths)),
        f"{same} of the {len(lengths)} lengths of Tables 3 and 4 are the components, of those"
        " names, of the points' vectors.",
    )


# --- Section 3 ------------------------------------------------------------------------------------


@computes("S-12")
def adjacent_links_suffice() -> Outcome:
    between, error = gap_of_base_and_link_2()
    return Outcome(
        judge(holds=between - error > 0),
        "For the paper's robot it misses nothing: wherever the windows of its points allow, the"
        f" base and link 2 keep more than {np.floor(between - error):.0f} cm. Theorem 1 does not"
        " ask for neighbours, so a robot whose base and last link can meet has the same functions"
        " for their points.",
    )


@computes("S-9.1")
@computes("S-13")
@computes("S-16.1")
def distance_of_points_and_of_links() -> Outcome:
    others = by_clearances().components[1:]
    overlaps = [-float(body_gap(np.array(c.centroid))) for c in others] or [0.0]
    apart = least_gap_in_home_region() > 0
    return Outcome(
        judge(holds=apart and not others, under=apart),
        "In the region of the home pose it does: no rebuilt bodies overlap in it. In the"
        f" {len(others)} other regions that the clearances allow they do, at the centroids by"
        f" {min(overlaps):.2f} to {max(overlaps):.2f} cm. No path from home leads there (S-23).",
    )


@computes("S-14")
def without_homogeneous_matrices() -> Outcome:
    import sympy as sp

    turn = sp.Matrix(3, 3, sp.symbols("R:9"))
    step, point = (sp.Matrix(sp.symbols(f"{name}:3")) for name in "rp")
    block = sp.Matrix(sp.BlockMatrix([[turn, step], [sp.zeros(1, 3), sp.ones(1, 1)]]))
    same = sp.expand((block * sp.Matrix([*point, 1]))[:3, :] - (turn * point + step))
    products = {"R and r": len(turn), "the 4 by 4 matrix": len(block)}
    joints = {b.name: len(components(robot(), b).joints()) for b in of_points(robot()).boundaries}
    of_pairs = max(joints[pair.name] for pair in pairs())
    far = [name for name, number in joints.items() if number > 1]
    fewer = same == sp.zeros(3, 1) and len(turn) < len(block)
    vary = sum(not entry.is_number for entry in block[:3, :3])
    return strongest(
        {
            "against the full 4 by 4 matrix from the base": judge(
                holds=fewer and not far, under=fewer and of_pairs == 1
            ),
            "against a 4 by 4 matrix whose constant row is not computed": judge(
                holds=len(turn) < vary
            ),
        },
        "For the pairs of points eq. (16) needs no 4 by 4 matrix and none from the base: with"
        f" consecutive links each depends on {of_pairs} of {len(robot().joints)} joints, and a"
        f" point costs {products['R and r']} products instead of {products['the 4 by 4 matrix']}."
        f" {', '.join(far)} do not relate consecutive systems: they use r_{{0,3}} through"
        " R_{0,2}, from the base, over both joints. If its constant row is skipped, the 4 by 4"
        " matrix needs as many products.",
    )


@computes("S-15")
def two_rotations_about_y() -> Outcome:
    axes = [joint.axis.tolist() for joint in robot().joints]
    middle = tool_form().coefficients[1]
    return Outcome(
        judge(holds=axes == [[0, 1, 0]] * 2 and not middle.any()),
        f"{len(axes)} revolute joints with the axis y make every row of Table 2; the tool's y is"
        " zero by identity.",
    )


# --- Section 4, first paragraphs ------------------------------------------------------------------


@computes("S-16")
def necessary_for_a_collision() -> Outcome:
    g = general()
    seen = vanishes(g.chain.position("a+n", "b+m", "a") - g.B)
    turned = vanishes(g.chain.position("a+n", "b+m", "0") - g.R_0a @ g.B)
    pose = np.array(by_clearances().components[-1].centroid)
    apart = min(float(np.linalg.norm(components(robot(), p)(pose))) for p in pairs())
    deep = -float(body_gap(pose))
    return strongest(
        {
            "the conditions for the chosen points to meet": judge(holds=seen and turned),
            "the conditions for whole links, with rebuilt bodies, to meet": judge(
                holds=deep <= 0, under=least_gap_in_home_region() > 0
            ),
        },
        "Two points meet exactly where B = 0, by identity and for all rotations. Of whole links the"
        " points tell enough in the region of the home pose. Elsewhere they need not: at q1 ="
        f" {np.degrees(pose[0]):.1f}°, q2 = {np.degrees(pose[1]):.1f}° bodies overlap by"
        f" {deep:.2f} cm and no pair of points is closer than {apart:.2f} cm.",
    )


@computes("S-17")
def four_tables() -> Outcome:
    tables = {o.table for o in paper.OFFSETS if o.table > 1 and "min" not in o.label}
    number = len(pairs())
    return strongest(
        {
            "four tabulated functions, each with its offsets": judge(holds=number == 4),
            "four tables with a number": judge(holds=len(tables) == 4, corrected=number == 4),
        },
        f"The offsets of the {number} pairs stand in {number} parts of {len(tables)} numbered"
        " tables, as the same section says two paragraphs on. The diagrams were not at hand.",
    )
