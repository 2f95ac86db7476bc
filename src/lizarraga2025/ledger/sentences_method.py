"""Sentences of the abstract, the introduction and Sections 2 and 3."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.ledger import effort
from lizarraga2025.ledger.entries import Finding, entry, judge, require
from lizarraga2025.ledger.facts import SMALL, lettered, pairs, robot, vertices, walls
from lizarraga2025.ledger.walks import (
    SCALE,
    body_gap,
    by_points,
    by_windows,
    drawn,
    floor,
    largest_scale,
    least_height,
    neighbours,
    scaled,
    stretched,
    tool_form,
    walk,
    workspace,
)
from qbound import clearance
from qbound.boundary.functions import closest_approach
from qbound.geometry import polygon
from qbound.measures.bodies import gaps
from qbound.model.robot import Body, Prismatic, joint_symbols
from qbound.paths.traversal import traverse
from qbound.region import paper_rule


@entry(
    "S-1", "sentence", "Abstract, third sentence",
    "Key intersection points of boundary functions give a continuous boundary of the joint region.",
    test="test_region.py::test_the_papers_rule_comes_out_of_the_same_engine",
    chapter="07_joint_region#six-points",
)  # fmt: skip
def intersections_give_a_continuous_boundary() -> Finding:
    loops, t = by_windows().loops, np.linspace(0, 1, 2001)
    straight = floor()(polygon.along_edges(vertices(), t)).min() > -SMALL
    arcs = loops[0]
    met = [
        np.abs(a.points[-1] - b.points[0]).max()
        for a, b in zip(arcs, arcs[1:] + arcs[:1], strict=True)
    ]
    return Finding(
        judge(holds=bool(straight), under=len(loops) == 1 and max(met) < SMALL),
        f"The six points and the arcs of the functions between them make {len(loops)} closed curve;"
        " straight lines between them, as drawn, make one that leaves the region twice.",
    )


@entry(
    "S-2", "sentence", "Abstract, fourth sentence",
    "Scaling about the centroid addresses the singular poses.",
    test="test_statements.py::test_no_useful_scale_leaves_out_the_singular_poses",
    chapter="08_workspace#the-stretched-pose",
    mended="The scaled region holds singular poses at every scale above 0.0095.",
)  # fmt: skip
def scaling_and_singular_poses() -> Finding:
    middle = polygon.centroid(vertices())[1]
    needed = (stretched() - middle) / (vertices()[:, 1].min() - middle)
    inside = [np.ptp(np.sign(scaled(s)[:, 1] - stretched())) > 0 for s in (1.0, SCALE, 0.5, 0.01)]
    require(all(inside) and needed < 0.0095, "singular poses inside at every scale above 0.0095")
    return Finding(
        judge(holds=needed > SCALE),
        f"The arm is singular on the line q2 = {np.degrees(stretched()):.4f}°; the centroid lies at"
        f" {np.degrees(middle):.4f}°. The scaled polygon leaves the line outside only below scale"
        f" {needed:.6f}.",
    )


@entry(
    "S-3", "sentence", "Abstract, fourth sentence",
    "The scaled region gives a well-defined trajectory.",
    test="test_scaling.py::test_floor_of_the_papers_polygon_against_brute_force",
    chapter="07_joint_region#second-remedy-scaling-about-the-centroid",
)  # fmt: skip
def scaled_region_gives_a_trajectory() -> Finding:
    safe = largest_scale().scale
    below = [least_height(s) for s in (safe - 1e-6, 0.96, SCALE, 0.5)]
    return Finding(
        judge(holds=least_height(0.99) > 0, under=min(below) > 0),
        f"The walk round the scaled points keeps every bound up to scale {safe:.6f} and no further;"
        " no scale is stated.",
    )


@entry(
    "S-4", "sentence", "Abstract, fifth sentence",
    "Final pose and reach depend on the traversal path.",
    test="test_traversal.py::test_tool_and_reach_are_forward_kinematics",
    chapter="08_workspace#five-points",
)  # fmt: skip
def final_pose_depends_on_the_path() -> Finding:
    walks = [walk(order) for order in neighbours()]
    poses = {tuple(np.round(w.final_pose, 9)) for w in walks}
    reach = [float(w.reach[-1]) for w in walks]
    return Finding(
        judge(holds=len(poses) > 1 and np.ptp(reach) > 1),
        f"The {len(walks)} sequences of five neighbours end in {len(poses)} poses, with the tool"
        f" {min(reach):.4f} to {max(reach):.4f} cm from joint 1.",
    )


@entry(
    "S-5", "sentence", "Abstract, fifth sentence",
    "That the final pose depends on the path shows the workspace to be nonlinear.",
    test="test_statements.py::test_the_final_place_depends_on_the_order_under_a_linear_map_too",
    chapter="08_workspace#five-points",
    mended="The bent path of the tool between two points shows it.",
)  # fmt: skip
def order_and_nonlinearity() -> Finding:
    slides = replace(
        robot(),
        joints=tuple(
            j.as_type(Prismatic, axis=np.array(axis), limits=(-9.0, 9.0))
            for j, axis in zip(robot().joints, ([1.0, 0, 0], [0, 0, 1.0]), strict=True)
        ),
    )
    ends = {tuple(np.round(traverse(slides, scaled()[list(o)]).tool[-1], 9)) for o in neighbours()}
    one = walk((0, 1))
    chord = one.tool[0] + np.linspace(0, 1, len(one.tool))[:, None] * (one.tool[-1] - one.tool[0])
    bend = float(np.linalg.norm(one.tool - chord, axis=-1).max())
    require(bend > 1, "a bent path between two points")
    return Finding(
        judge(holds=len(ends) == 1),
        "A walk that ends at another point ends in another place under any map: with two slides in"
        f" place of the joints, a linear map, the sequences end in {len(ends)} places too. What a"
        f" linear map lacks is the bend: between points 1 and 2 the tool is up to {bend:.4f} cm"
        " from"
        " the place that a straight, even motion would give.",
    )


@entry(
    "S-6", "sentence", "Abstract, sixth sentence",
    "Traditional numerical methods cannot produce a continuous boundary.",
    test="test_statements.py::test_a_contour_on_a_grid_is_one_closed_curve_near_the_region",
    chapter="09_sampling#at-equal-accuracy",
)  # fmt: skip
def numerical_methods_and_a_boundary() -> Finding:
    rings = effort.contour_of_grid(200)
    closed = len(rings) == 1 and np.allclose(rings[0][0], rings[0][-1])
    q = drawn().q
    box = paper_rule.box(robot())
    near = np.abs(np.stack([*(q - box.lower).T, *(box.upper - q).T, floor()(q)])).min()
    return Finding(
        judge(holds=not closed, under=bool(near > 0)),
        f"True of random points alone: none of {len(q)} lies on the boundary. A contour of the same"
        " functions on a grid of 200 by 200 is one closed curve, whose area is off by"
        f" {100 * effort.contour_error(200):.4f} %.",
    )


@entry(
    "S-7", "sentence", "Introduction, first paragraph",
    "Boundary functions determine the region more accurately and with less computation.",
    test="test_statements.py::test_the_closed_form_needs_few_evaluations",
    chapter="09_sampling#at-equal-accuracy",
)  # fmt: skip
def accuracy_and_effort() -> Finding:
    nodes = {k: next(n for n in range(1, 99) if effort.closed_form_error(n) < 10.0**-k)
             for k in (3, 6, 9)}  # fmt: skip
    closed = {k: effort.CLOSED_FORM_START + 2 * n for k, n in nodes.items()}
    drawn_for = {k: effort.samples_needed(10.0**-k) for k in nodes}
    text = "; ".join(
        f"1e-{k}: {closed[k]} against {drawn_for[k]:.2g} random samples" for k in nodes
    )
    return Finding(
        judge(holds=all(closed[k] < drawn_for[k] for k in nodes)),
        "Solutions of Theorem 2 for the area of the joint region within a relative error of"
        f" {text}.",
    )


@entry(
    "S-8", "sentence", "Introduction, summary of the contribution",
    "The boundaries of the workspace come out continuous and analytically tractable.",
    test="test_statements.py::test_the_image_of_the_boundary_encloses_a_part_of_the_workspace",
    chapter="08_workspace#what-the-path-does-not-enclose",
)  # fmt: skip
def boundary_of_the_workspace() -> Finding:
    areas = workspace()
    whole = np.isclose(areas["enclosed"], areas["union"], rtol=1e-6)
    split = np.isclose(areas["enclosed"] + areas["twice"], areas["union"], rtol=1e-6)
    return Finding(
        judge(holds=bool(whole), under=bool(split)),
        "True in joint space: six closed formulas and two arcs of Theorem 2. In the plane of the"
        " tool"
        f" the image of that boundary encloses {areas['enclosed']:.2f} of {areas['union']:.2f}"
        " cm²; the"
        " rest is bounded outside by the image of the singular line, which has to be added.",
    )


@entry(
    "S-9", "sentence", "Introduction, summary of the contribution",
    "The framework joins kinematic, collision and geometric constraints.",
    test="test_sampling.py::test_ranges_are_the_limits_or_a_full_turn",
    chapter="03_theorem_1#answer",
)  # fmt: skip
def three_kinds_of_constraints() -> Finding:
    limits = sum(joint.limits is not None for joint in robot().joints)
    counts = {"point pairs": len(pairs()), "walls": len(walls()), "joint limits": limits}
    text = ", ".join(f"{n} {name}" for name, n in counts.items())
    return Finding(
        judge(holds=min(counts.values()) > 0, under=counts["point pairs"] * counts["walls"] > 0),
        f"Two of the three kinds are put to use in the case study: {text}. Eq. (10) stays without a"
        " number.",
    )


@entry(
    "S-10", "sentence", "Introduction, outline",
    "The region is adjusted so that it has a safety margin and avoids singular poses.",
    test="test_statements.py::test_no_useful_scale_leaves_out_the_singular_poses",
    chapter="08_workspace#the-stretched-pose",
)  # fmt: skip
def margin_and_singular_poses() -> Finding:
    margin = least_height(SCALE)
    singular = float(np.linalg.det(tool_form().gradient(np.array([0.0, stretched()]))[[0, 2]]))
    avoided = bool((np.sign(scaled()[:, 1] - stretched()) == 1).all())
    return Finding(
        judge(holds=margin > 0 and avoided, under=margin > 0),
        f"The margin is there ({margin:.4f} cm above the tool's limit at scale 0.95); the singular"
        f" line q2 = {np.degrees(stretched()):.4f}°, on which det J is {abs(singular):.1g}, stays"
        " inside.",
    )


@entry(
    "S-11", "sentence", "Section 2, item 2",
    "Orthonormal direction vectors are perpendicular to each other and of unit length.",
    test="test_frames.py::test_symbolic_rotations_are_orthogonal_by_identity",
    chapter="02_vector_labelling#answer",
)  # fmt: skip
def orthonormal_directions() -> Finding:
    import sympy as sp

    frames = lettered()[0].frames(joint_symbols(robot()))
    names = ("1", "2")
    gram = [
        sp.Matrix(frames.rotation("0", n)).T * sp.Matrix(frames.rotation("0", n)) for n in names
    ]
    return Finding(
        judge(holds=all(sp.simplify(g) == sp.eye(3) for g in gram)),
        "For both moving frames of the chain the nine dot products are those of the identity"
        " matrix,"
        " for all joint values, by identity.",
    )


@entry(
    "S-12", "sentence", "Section 3, second paragraph",
    "Collisions arise between points of a link and points of the next one.",
    test="test_bodies.py::test_the_base_and_link_2_stay_far_apart_in_the_whole_region",
    chapter="17_bodies#exactly",
)  # fmt: skip
def adjacent_links_suffice() -> Finding:
    box = paper_rule.box(robot())
    axes = [np.linspace(low, high, 121) for low, high in zip(box.lower, box.upper, strict=True)]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    between = float(gaps(robot(), q)["0", "2"].min())
    plate = Body("0", np.array([(-40.0, 0.0), (40.0, 0.0), (40.0, 2.0), (-40.0, 2.0)]))
    wide = gaps(replace(robot(), bodies=(plate, *robot().bodies[1:])), q)
    apart, hit = float(wide["0", "1"].min()), float(wide["0", "2"].min())
    return Finding(
        judge(holds=between > 0 and (apart < 0 or hit > 0), under=between > 0),
        "For this robot it is enough: where neighbours stay apart, base and link 2 keep"
        f" {between:.2f} cm or more. It is no general truth: on a foot plate 80 cm wide and 2 cm"
        " high"
        f" link 2 overlaps the base by {-hit:.2f} cm while all neighbours stay {apart:.2f} cm"
        f" apart.",
    )


@entry(
    "S-13", "sentence", "Section 3, list of constraints",
    "A least distance between key points prevents the links from intersecting.",
    test="test_statements.py::test_clearances_allow_links_that_overlap",
    chapter="17_bodies#a-check-of-the-whole-bodies",
)  # fmt: skip
def distance_of_points_and_of_links() -> Finding:
    home, *others = by_points().components
    middles = np.array([c.centroid for c in others])
    overlaps = body_gap(middles)
    middle = np.array(home.centroid, dtype=float)
    ring = np.concatenate([arc.points for arc in home.loops[0]])
    inside = middle + 0.999 * (ring - middle)
    return Finding(
        judge(
            holds=bool(overlaps.min() > 0),
            under=bool(min(body_gap(middle), body_gap(inside).min()) > 0),
        ),
        f"In the region of the home pose it does. In the {len(others)} other regions that the"
        " clearances"
        f" allow the bodies overlap, at the four centroids by {-overlaps.max():.2f} to"
        f" {-overlaps.min():.2f} cm.",
    )


@entry(
    "S-14", "sentence", "Section 3, remark after Theorem 1",
    "The formulation does without complete transformation matrices and is more efficient.",
    test="test_boundary.py::test_theorem_1_holds_for_any_chain_and_either_order",
    chapter="03_theorem_1#answer",
)  # fmt: skip
def without_homogeneous_matrices() -> Finding:
    import sympy as sp

    turn = sp.Matrix(3, 3, sp.symbols("R:9"))
    step, point = (sp.Matrix(sp.symbols(f"{name}:3")) for name in "rp")
    block = sp.Matrix(sp.BlockMatrix([[turn, step], [sp.zeros(1, 3), sp.ones(1, 1)]]))
    same = sp.expand((block * sp.Matrix([*point, 1]))[:3, :] - (turn * point + step))
    entries = block.free_symbols == turn.free_symbols | step.free_symbols
    products = {"eq. (16)": 3 * 3, "the 4 by 4 matrix": 4 * 4}
    return Finding(
        judge(
            holds=not entries, under=same == sp.zeros(3, 1) and products["the 4 by 4 matrix"] > 9
        ),
        "R and r of eq. (16) are the twelve entries of the homogeneous matrix that vary: the same"
        f" numbers. What is saved is its constant row, {products['eq. (16)']} products a point for"
        f" {products['the 4 by 4 matrix']}.",
    )


@entry(
    "S-15", "sentence", "Section 3, case study",
    "The robot has two degrees of freedom, both rotations about y.",
    test="test_robot.py::test_direct_kinematics_are_table_2",
    chapter="04_planar_robot#table-2-row-by-row",
)  # fmt: skip
def two_rotations_about_y() -> Finding:
    axes = [joint.axis.tolist() for joint in robot().joints]
    middle = tool_form().coefficients[1]
    return Finding(
        judge(holds=axes == [[0, 1, 0]] * 2 and not middle.any()),
        f"{len(axes)} revolute joints with axes {axes[0]} make every row of Table 2; the tool's y"
        " is"
        " zero by identity.",
    )


@entry(
    "S-16", "sentence", "Section 4, first paragraph",
    "Theorem 1 gives the conditions that are necessary for a collision in the chain.",
    test="test_statements.py::test_clearances_allow_links_that_overlap",
    chapter="17_bodies#a-check-of-the-whole-bodies",
)  # fmt: skip
def necessary_for_a_collision() -> Finding:
    pose = np.array(by_points().components[1].centroid)
    apart = [float(np.sqrt(clearance(robot(), p)(pose) + p.clearance**2)) for p in pairs()]
    deep = -float(body_gap(pose))
    gap = max(closest_approach(robot(), p)[1] for p in pairs())
    return Finding(
        judge(holds=deep <= 0, under=gap < 0.1),
        "Necessary for two points to meet, and at the first contact from home bodies do meet in"
        " these"
        f" points (within {gap:.4f} cm as printed). Past it they are not: at q1 ="
        f" {np.degrees(pose[0]):.1f}°, q2 = {np.degrees(pose[1]):.1f}° the bodies overlap by"
        f" {deep:.2f} cm and no pair is closer than {min(apart):.2f} cm.",
    )


@entry(
    "S-17", "sentence", "Section 4, second paragraph",
    "Four tables present the point boundary functions.",
    test="test_paper.py::test_counts_are_the_papers",
    chapter="05_boundary_functions#the-tables",
    mended="Four point boundary functions are presented, in two tables.",
)  # fmt: skip
def four_tables() -> Finding:
    tables = {o.table for o in paper.OFFSETS if o.table > 1 and "min" not in o.label}
    return Finding(
        judge(holds=len(tables) == 4, mended=len(pairs()) == 4),
        f"The offsets of the {len(pairs())} pairs stand in {len(tables)} tables, as the same"
        " section says"
        " two paragraphs on.",
    )
