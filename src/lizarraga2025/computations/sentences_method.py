"""Sentences of the abstract, the introduction and Sections 2 and 3."""

from __future__ import annotations

import re
from typing import Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.choices import SCALE
from lizarraga2025.computations.registry import computes
from lizarraga2025.computations.theorem_2 import interval
from lizarraga2025.evidence import effort
from lizarraga2025.evidence.arms import floor, pairs, robot, symbolic_robot, tool_form
from lizarraga2025.evidence.joint_region import (
    by_windows,
    depth_below_edges,
    edges,
    largest_scale,
    least_height,
    scaled,
    share_of_square,
    vertices,
)
from lizarraga2025.evidence.proofs import is_identity, theorem_2
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import (
    is_cut_by_the_singular_line,
    scale_without_singular_poses,
    stretched,
)
from lizarraga2025.verdicts import Outcome, judge, of_readings, undetermined
from qbound import components, polygon
from qbound.scaling import least_on_edges
from qbound.symbols import joint_symbols

# --- abstract -------------------------------------------------------------------------------------


@computes("S-1")
def intersections_give_a_continuous_boundary() -> Outcome:
    closed = bool(edges())
    outside = int((depth_below_edges() > SMALL).sum())
    return Outcome(
        judge(holds=closed),
        f"The {len(vertices())} points are found in closed form, and the functions between them"
        f" close {'one' if closed else 'no'} curve, the boundary of the region. Straight lines"
        f" between them close a curve too; {outside} of them leave the region, for which the paper"
        " gives two remedies.",
    )


@computes("S-6.1")
def better_than_what() -> Outcome:
    inside = by_windows().with_points(5, tangents=True)
    kept = {
        "straight paths between the points": depth_below_edges().max() <= SMALL,
        "paths inside tangents at the boundary": least_on_edges(floor(), inside).value > -SMALL,
    }
    fits = {name: True for name in kept if paper.COMPARED in (None, name)}
    told = "; ".join(f"{name} {'do' if keeps else 'do not'}" for name, keeps in kept.items())
    return of_readings(
        "better than a planning that is not named",
        {
            "better than a planning that is not named": undetermined(fits),
            "better than random draws, which give no path": judge(
                holds=least_height(0.99) > 0, under=least_height(SCALE) > 0
            ),
        },
        "The sentence names no planning of paths; the one before it names numerical methods and"
        " their boundaries, and random draws give no path. A path in the scaled region keeps every"
        f" bound up to scale {largest_scale().scale:.6f}. Of other plannings with boundary"
        f" functions, {told}.",
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
    return of_readings(
        "done with eq. (38) and atan2, or Theorem 2 restated",
        {
            "done with eq. (38) and atan2, or Theorem 2 restated": judge(
                holds=False, under=all(closed[k] < random[k] for k in closed)
            ),
            "done with Theorem 2 as printed": judge(holds=interval(31).excludes),
        },
        "Roots, by Theorem 2 restated (TH-2), for the area of the joint region within a relative"
        f" error of {text}. Eq. (31) as printed leaves no angle out, so it bounds no area.",
    )


@computes("S-7.2")
def lack_of_precision() -> Outcome:
    part = share_of_square()
    closed = {k: effort.closed_form_evaluations(10.0**-k) for k in (3, 9)}
    drawn = {k: np.sqrt(max(0.0, 1 - part) / part / n) for k, n in closed.items()}
    text = " and ".join(f"{closed[k]} draws err by {100 * drawn[k]:.0f} %" for k in closed)
    return Outcome(
        judge(holds=False, under=all(error > 10.0**-k for k, error in drawn.items())),
        f"At equal numbers of evaluations: for the area of the joint region {text} (standard error"
        " of random sampling), where the closed form has three and nine digits. More draws give any"
        " precision that is asked for (S-38).",
    )


@computes("S-7.1")
def theorems_that_bound_q() -> Outcome:
    steps = theorem_2()
    return of_readings(
        "Theorem 2 restated",
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
        "It holds of the two indices of a vector, for its start and its end:"
        f" {sum('min' not in name for name in labels)} of the {len(labels)} lengths in eq. (29)"
        " have them, and the others are limits. The observer, the third part of a label, is marked"
        f" in eqs. {', '.join(f'({n})' for n in paper.OBSERVERS)}, on the"
        f" {' and on the '.join(sides)} of the symbol, and in"
        f" {len(later) or 'no'} equation after Section 2.",
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


@computes("S-14")
def without_homogeneous_matrices() -> Outcome:
    turn = sp.Matrix(3, 3, sp.symbols("R:9"))
    step, point = (sp.Matrix(sp.symbols(f"{name}:3")) for name in "rp")
    block = sp.Matrix(sp.BlockMatrix([[turn, step], [sp.zeros(1, 3), sp.ones(1, 1)]]))
    same = sp.expand((block * sp.Matrix([*point, 1]))[:3, :] - (turn * point + step))
    products = {"R and r": len(turn), "the 4 by 4 matrix": len(block)}
    joints = {b.name: len(components(robot(), b).joints()) for b in robot().boundaries}
    of_pairs = max(joints[pair.name] for pair in pairs())
    far = [name for name, number in joints.items() if number > 1]
    fewer = same == sp.zeros(3, 1) and len(turn) < len(block)
    vary = sum(not entry.is_number for entry in block[:3, :3])
    return of_readings(
        "against the full 4 by 4 matrix from the base",
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


@computes("S-17")
def four_tables() -> Outcome:
    tables = {o.table for o in paper.OFFSETS if o.table > 1 and "min" not in o.label}
    number = len(pairs())
    return of_readings(
        "four tabulated functions, each with its offsets",
        {
            "four tabulated functions, each with its offsets": judge(holds=number == 4),
            "four tables with a number": judge(holds=len(tables) == 4, corrected=number == 4),
        },
        f"The offsets of the {number} pairs stand in {number} parts of {len(tables)} numbered"
        " tables, as the same section says two paragraphs on. The diagrams were not at hand.",
    )
