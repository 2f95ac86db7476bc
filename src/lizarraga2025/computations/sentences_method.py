"""Sentences of the abstract, the introduction and Sections 2 and 3."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence import effort
from lizarraga2025.evidence.arms import (
    floor,
    half_spaces,
    of_slides,
    pairs,
    robot,
    symbolic_robot,
    tool_form,
)
from lizarraga2025.evidence.joint_region import (
    SCALE,
    body_gap,
    by_clearances,
    by_windows,
    depth_below_edges,
    drawn,
    largest_scale,
    least_height,
    scaled,
    vertices,
)
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import (
    det_jacobian,
    is_cut_by_the_singular_line,
    neighbour_sequences,
    path_through,
    stretched,
    workspace,
)
from lizarraga2025.verdicts import Outcome, judge, require
from qbound import clearance
from qbound.boundary.functions import closest_approach
from qbound.geometry import polygon
from qbound.measures.bodies import gaps
from qbound.model.robot import Body
from qbound.paths.traversal import traverse
from qbound.region import paper_rule
from qbound.symbols import joint_symbols


@computes("S-1")
def intersections_give_a_continuous_boundary() -> Outcome:
    loops = by_windows().loops
    straight = depth_below_edges().max() < SMALL
    arcs = loops[0]
    met = [
        np.abs(a.points[-1] - b.points[0]).max()
        for a, b in zip(arcs, arcs[1:] + arcs[:1], strict=True)
    ]
    return Outcome(
        judge(holds=bool(straight), under=len(loops) == 1 and max(met) < SMALL),
        f"The six points and the arcs of the functions between them make {len(loops)} closed curve;"
        " straight lines between them, as drawn, make one that leaves the region twice.",
    )


@computes("S-2")
def scaling_and_singular_poses() -> Outcome:
    middle = polygon.centroid(vertices())[1]
    needed = (stretched() - middle) / (vertices()[:, 1].min() - middle)
    inside = [is_cut_by_the_singular_line(scaled(s)) for s in (1.0, SCALE, 0.5, 0.01)]
    require(all(inside) and needed < 0.0095, "singular poses inside at every scale above 0.0095")
    return Outcome(
        judge(holds=needed > SCALE),
        f"The arm is singular on the line q2 = {np.degrees(stretched()):.4f}°; the centroid lies at"
        f" {np.degrees(middle):.4f}°. The scaled polygon leaves the line outside only below scale"
        f" {needed:.6f}.",
    )


@computes("S-3")
def scaled_region_gives_a_trajectory() -> Outcome:
    safe = largest_scale().scale
    below = [least_height(s) for s in (safe - 1e-6, 0.96, SCALE, 0.5)]
    return Outcome(
        judge(holds=least_height(0.99) > 0, under=min(below) > 0),
        f"The walk round the scaled points keeps every bound up to scale {safe:.6f} and no further;"
        " no scale is stated.",
    )


@computes("S-4")
def final_pose_depends_on_the_path() -> Outcome:
    paths = [path_through(order) for order in neighbour_sequences()]
    poses = {tuple(np.round(w.final_pose, 9)) for w in paths}
    reach = [float(w.reach[-1]) for w in paths]
    return Outcome(
        judge(holds=len(poses) > 1 and np.ptp(reach) > 1),
        f"The {len(paths)} sequences of five neighbours end in {len(poses)} poses, with the tool"
        f" {min(reach):.4f} to {max(reach):.4f} cm from joint 1.",
    )


@computes("S-5")
def order_and_nonlinearity() -> Outcome:
    linear = [traverse(of_slides(), scaled()[list(o)]) for o in neighbour_sequences()]
    ends = {tuple(np.round(path.tool[-1], 9)) for path in linear}
    one = path_through((0, 1))
    chord = one.tool[0] + np.linspace(0, 1, len(one.tool))[:, None] * (one.tool[-1] - one.tool[0])
    bend = float(np.linalg.norm(one.tool - chord, axis=-1).max())
    require(bend > 1, "a bent path between two points")
    return Outcome(
        judge(holds=len(ends) == 1),
        "A walk that ends at another point ends in another place under any map: with two slides in"
        f" place of the joints, a linear map, the sequences end in {len(ends)} places too. What a"
        f" linear map lacks is the bend: between points 1 and 2 the tool is up to {bend:.4f} cm"
        " from the place that a straight, even motion would give.",
    )


@computes("S-6")
def numerical_methods_and_a_boundary() -> Outcome:
    q = drawn().q
    box = paper_rule.box(robot())
    near = np.abs(np.stack([*(q - box.lower).T, *(box.upper - q).T, floor()(q)])).min()
    return Outcome(
        judge(holds=not effort.contour_is_closed(200), under=bool(near > 0)),
        f"True of random points alone: none of {len(q)} lies on the boundary. A contour of the same"
        " functions on a grid of 200 by 200 is one closed curve, whose area is off by"
        f" {100 * effort.contour_error(200):.4f} %.",
    )


@computes("S-7")
def accuracy_and_effort() -> Outcome:
    closed = {k: effort.closed_form_evaluations(10.0**-k) for k in (3, 6, 9)}
    random = {k: effort.samples_needed(10.0**-k) for k in closed}
    text = "; ".join(f"1e-{k}: {closed[k]} against {random[k]:.2g} random samples" for k in closed)
    return Outcome(
        judge(holds=all(closed[k] < random[k] for k in closed)),
        "Solutions of Theorem 2 for the area of the joint region within a relative error of"
        f" {text}.",
    )


@computes("S-8")
def boundary_of_the_workspace() -> Outcome:
    areas = workspace()
    whole = np.isclose(areas["enclosed"], areas["union"], rtol=1e-6)
    split = np.isclose(areas["enclosed"], areas["once"], rtol=1e-6)
    return Outcome(
        judge(holds=bool(whole), under=bool(split)),
        "True in joint space: six closed formulas and two arcs of Theorem 2. In the plane of the"
        f" tool the image of that boundary encloses {areas['enclosed']:.2f} of {areas['union']:.2f}"
        " cm²; the rest is bounded outside by the image of the singular line, which has to be"
        " added.",
    )


@computes("S-9")
def three_kinds_of_constraints() -> Outcome:
    limits = sum(joint.limits is not None for joint in robot().joints)
    counts = {"point pairs": len(pairs()), "walls": len(half_spaces()), "joint limits": limits}
    text = ", ".join(f"{n} {name}" for name, n in counts.items())
    return Outcome(
        judge(holds=min(counts.values()) > 0, under=counts["point pairs"] * counts["walls"] > 0),
        f"Two of the three kinds are put to use in the case study: {text}. Eq. (10) stays without a"
        " number.",
    )


@computes("S-10")
def margin_and_singular_poses() -> Outcome:
    margin = least_height(SCALE)
    singular = float(det_jacobian(np.array([0.0, stretched()])))
    avoided = not is_cut_by_the_singular_line(scaled())
    return Outcome(
        judge(holds=margin > 0 and avoided, under=margin > 0),
        f"The margin is there ({margin:.4f} cm above the tool's limit at scale 0.95); the singular"
        f" line q2 = {np.degrees(stretched()):.4f}°, on which det J is {abs(singular):.1g}, stays"
        " inside.",
    )


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


@computes("S-12")
def adjacent_links_suffice() -> Outcome:
    box = paper_rule.box(robot())
    axes = np.linspace(box.lower, box.upper, 121).T
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    between = float(gaps(robot(), q)["0", "2"].min())
    plate = Body("0", np.array([(-40.0, 0.0), (40.0, 0.0), (40.0, 2.0), (-40.0, 2.0)]))
    wide = gaps(replace(robot(), bodies=(plate, *robot().bodies[1:])), q)
    apart, hit = float(wide["0", "1"].min()), float(wide["0", "2"].min())
    return Outcome(
        judge(holds=between > 0 and (apart < 0 or hit > 0), under=between > 0),
        "For this robot it is enough: where neighbours stay apart, base and link 2 keep"
        f" {between:.2f} cm or more. It is no general truth: on a foot plate 80 cm wide and 2 cm"
        f" high link 2 overlaps the base by {-hit:.2f} cm while all neighbours stay {apart:.2f} cm"
        " apart.",
    )


@computes("S-13")
def distance_of_points_and_of_links() -> Outcome:
    home, *others = by_clearances().components
    middles = np.array([c.centroid for c in others])
    overlaps = body_gap(middles)
    middle = np.array(home.centroid, dtype=float)
    ring = np.concatenate([arc.points for arc in home.loops[0]])
    inside = middle + 0.999 * (ring - middle)
    return Outcome(
        judge(
            holds=bool(overlaps.min() > 0),
            under=bool(min(body_gap(middle), body_gap(inside).min()) > 0),
        ),
        f"In the region of the home pose it does. In the {len(others)} other regions that the"
        f" clearances allow the bodies overlap, at the four centroids by {-overlaps.max():.2f} to"
        f" {-overlaps.min():.2f} cm.",
    )


@computes("S-14")
def without_homogeneous_matrices() -> Outcome:
    import sympy as sp

    turn = sp.Matrix(3, 3, sp.symbols("R:9"))
    step, point = (sp.Matrix(sp.symbols(f"{name}:3")) for name in "rp")
    block = sp.Matrix(sp.BlockMatrix([[turn, step], [sp.zeros(1, 3), sp.ones(1, 1)]]))
    same = sp.expand((block * sp.Matrix([*point, 1]))[:3, :] - (turn * point + step))
    entries = block.free_symbols == turn.free_symbols | step.free_symbols
    products = {"eq. (16)": 3 * 3, "the 4 by 4 matrix": 4 * 4}
    return Outcome(
        judge(
            holds=not entries, under=same == sp.zeros(3, 1) and products["the 4 by 4 matrix"] > 9
        ),
        "R and r of eq. (16) are the twelve entries of the homogeneous matrix that vary: the same"
        f" numbers. What is saved is its constant row, {products['eq. (16)']} products a point for"
        f" {products['the 4 by 4 matrix']}.",
    )


@computes("S-15")
def two_rotations_about_y() -> Outcome:
    axes = [joint.axis.tolist() for joint in robot().joints]
    middle = tool_form().coefficients[1]
    return Outcome(
        judge(holds=axes == [[0, 1, 0]] * 2 and not middle.any()),
        f"{len(axes)} revolute joints with axes {axes[0]} make every row of Table 2; the tool's y"
        " is zero by identity.",
    )


@computes("S-16")
def necessary_for_a_collision() -> Outcome:
    pose = np.array(by_clearances().components[1].centroid)
    apart = [float(np.sqrt(clearance(robot(), p)(pose) + p.clearance**2)) for p in pairs()]
    deep = -float(body_gap(pose))
    gap = max(closest_approach(robot(), p)[1] for p in pairs())
    return Outcome(
        judge(holds=deep <= 0, under=gap < 0.1),
        "Necessary for two points to meet, and at the first contact from home bodies do meet in"
        f" these points (within {gap:.4f} cm as printed). Past it they are not: at q1 ="
        f" {np.degrees(pose[0]):.1f}°, q2 = {np.degrees(pose[1]):.1f}° the bodies overlap by"
        f" {deep:.2f} cm and no pair is closer than {min(apart):.2f} cm.",
    )


@computes("S-17")
def four_tables() -> Outcome:
    tables = {o.table for o in paper.OFFSETS if o.table > 1 and "min" not in o.label}
    return Outcome(
        judge(holds=len(tables) == 4, corrected=len(pairs()) == 4),
        f"The offsets of the {len(pairs())} pairs stand in {len(tables)} tables, as the same"
        " section says two paragraphs on.",
    )
