"""Figures 1 to 11: what their captions and the sentences about them say."""

from __future__ import annotations

from itertools import pairwise, permutations

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.ledger.entries import Finding, entry, judge, require, undetermined
from lizarraga2025.ledger.facts import lettered, mended, pairs, robot, vertices
from lizarraga2025.ledger.walks import (
    LEFT,
    PLANE,
    RIGHT,
    SCALE,
    asymmetry,
    body_gap,
    by_points,
    by_windows,
    crossings,
    drawn,
    floor,
    largest_scale,
    least_height,
    other_posture,
    scaled,
    simple,
    stretched,
    symmetric,
    tool_form,
    walk,
    workspace,
)
from qbound import pair_vector
from qbound.geometry import polygon
from qbound.measures import scaling
from qbound.model.robot import Robot, joint_symbols
from qbound.region import paper_rule, solve, state
from qbound.sampling import keeps_clear, keeps_components_positive, keeps_geometric, misses_points

MEETS = 1e-9
"""Value of a component, cm, under which a vertex lies on its bound: offsets carry 1e-2."""

REGION, SPACE, SAMPLES = "07_joint_region", "08_workspace", "09_sampling"


@entry(
    "F-1", "figure", "Figure 1 and caption",
    "The picture shows the labels: a vector says from where to where it runs and who sees it.",
    test="test_frames.py::test_frame_is_the_relative_homogeneous_matrix",
    chapter="02_vector_labelling#fig-1",
)  # fmt: skip
def labels_close_a_triangle() -> Finding:
    import sympy as sp

    frames = lettered()[0].frames(joint_symbols(robot()))
    seen = sp.Matrix(frames.rotation("0", "1")) * sp.Matrix(frames.position("1", "2", "1"))
    path = sp.Matrix(frames.position("0", "1", "0")) + seen
    closed = sp.simplify(path - sp.Matrix(frames.position("0", "2", "0"))) == sp.zeros(3, 1)
    return Finding(
        judge(holds=closed),
        "Labels are enough to compute with: r_{0,1} and r_{1,2}, the second turned by R_{0,1}, add"
        " up to r_{0,2} by identity. The picture itself is drawn anew.",
    )


@entry(
    "F-2", "figure", "Figure 2, caption",
    "Nodes a and b are joints between consecutive links; the points are on adjacent links.",
    test="test_boundary.py::test_theorem_1_holds_for_any_chain_and_either_order",
    chapter="03_theorem_1#fig-2",
)  # fmt: skip
def points_lie_on_adjacent_links() -> Finding:
    chain = [robot().base, *(joint.frame for joint in robot().joints)]
    apart = [
        abs(chain.index(robot().point(a).frame) - chain.index(robot().point(b).frame))
        for a, b in (pair.points for pair in pairs())
    ]
    return Finding(
        judge(holds=set(apart) == {1}),
        f"In all {len(apart)} pairs of Tables 3 and 4 one joint lies between the two points.",
    )


@entry(
    "F-3", "figure", "Figure 3, caption",
    "The kinematic chain of the case study runs through frames 0, 1, 2 and 3.",
    test="test_robot.py::test_direct_kinematics_are_table_2",
    chapter="04_planar_robot#fig-3",
)  # fmt: skip
def chain_of_the_robot() -> Finding:
    frames = robot().frames(robot().home)
    order = ["0", "1", "2", robot().tool]
    precede = all(frames.precedes(a, b) for a, b in pairwise(order))
    return Finding(
        judge(holds=precede and order[-1] == "3"),
        f"Each of {', '.join(order)} precedes the next; {len(robot().joints)} joints move them.",
    )


def _edges() -> set[str]:
    """Labels of the bounds that bound the region."""
    return {b.label for corner in paper_rule.vertices(robot()) for b in corner.bounds}


@entry(
    "F-4.1", "figure", "Figure 4, caption",
    "Six curves determine the region: of B1 and B2 one each, of B3 and B4 one each, of B7 two.",
    test="test_paper_rule.py::test_six_vertices_use_six_curves_each_twice",
    chapter=f"{REGION}#fig-4",
)  # fmt: skip
def six_curves() -> Finding:
    named, found = set(paper.FIGURE_4_BOUNDS), _edges()
    lines = [{label.rpartition(",")[0] for label in labels} for labels in (named, found)]
    return Finding(
        judge(holds=lines[0] == lines[1] and len(found) == len(named)),
        f"The exact region has {len(found)} bounding curves, of the components that the caption"
        f" names; {len(named & found)} of the six labels agree to the last index.",
    )


@entry(
    "F-4.2", "figure", "Figure 4, caption",
    "The bound of component 3 of B3 is the one with k = 2.",
    test="test_paper_rule.py::test_caption_of_figure_4_names_one_bound_a_turn_away",
    chapter="06_theorem_2#the-index-in-the-caption-of-figure-4",
)  # fmt: skip
def the_index_of_one_bound() -> Finding:
    side = float(paper_rule.box(robot()).upper[1])
    values = {k: _beta_3_3(k, "atan2") for k in (1, 2)}
    raised = {k: _beta_3_3(k, "arctan") + np.pi for k in (1, 2)}  # a < 0: pi is added
    mendings = {
        "the index": np.isclose(values[1], side) and values[2] < 0 < values[1],
        "the window": np.isclose(raised[2], side) and raised[2] - 2 * np.pi < 0 < raised[2],
    }
    return Finding(
        undetermined({name: bool(fits) for name, fits in mendings.items()}),
        f"The side lies at {np.degrees(side):.4f}°. With atan2 that is k = 1 and k = 2 is"
        f" {np.degrees(values[2]):.4f}°, off the picture; with an inverse tangent that adds 180° it"
        f" is k = 2, but then the row of Table 6 runs from it to {np.degrees(raised[1]):.4f}° and"
        " leaves out home. Either the index or that row is a turn off; the line is the same.",
    )


def _beta_3_3(k: int, reading: paper.Reading) -> float:
    printed = paper.expression(paper.TABLE_6[f"beta_{{3,3,{k}}}"], arctan=reading)
    return float(printed.subs(lettered()[1]))


@entry(
    "F-4.3", "figure", "Figure 4, caption",
    "The other (red) lines play no part in the region.",
    test="test_paper_rule.py::test_unused_boundaries_do_not_bound",
    chapter=f"{REGION}#fig-4",
)  # fmt: skip
def red_lines_play_no_part() -> Finding:
    walls = [robot().boundary(name) for name in ("B5", "B6", "B7")]
    box = paper_rule.box(robot())
    ranges = list(zip(box.lower.tolist(), box.upper.tolist(), strict=True))
    names = [("q1.lower", "q1.upper"), ("q2.lower", "q2.upper")]
    home = robot().home
    areas = [
        sum(c.area for c in solve(state(robot(), used, ranges, names), home).components)
        for used in (walls[2:], walls[1:], walls)
    ]
    windows = paper_rule.windows(robot())
    outside = all(w.lower <= box.lower[w.joint] and w.upper >= box.upper[w.joint] for w in windows)
    return Finding(
        judge(holds=outside and np.ptp(areas) < MEETS, under=outside),
        f"True of the {len(windows)} windows of the point pairs. The walls B5 and B6 of Table 5"
        " cross"
        f" the region: with B6 in force {areas[1]:.4f} of {areas[0]:.4f} rad² would be left, with"
        " B5"
        f" too {areas[2]:.4f}. The paper leaves them out without a word.",
    )


@entry(
    "F-5.1", "figure", "Figure 5, caption",
    "The region's corners are six points in which two of the selected functions intersect.",
    test="test_paper_rule.py::test_vertex_lies_on_both_named_curves_and_in_every_window",
    chapter=f"{REGION}#six-points",
)  # fmt: skip
def six_points_on_two_curves_each() -> Finding:
    residuals = []
    for corner in paper_rule.vertices(robot()):
        for bound in corner.bounds:
            boundary = robot().boundary(bound.boundary)
            form = (
                pair_vector(robot(), boundary)[bound.component - 1]
                if boundary in pairs()
                else floor()
            )
            residuals.append(abs(float(form(corner.q))))
    exact = sorted(v.q.tolist() for v in by_windows().vertices)
    same = np.allclose(exact, sorted(vertices().tolist()), atol=MEETS)
    return Finding(
        judge(holds=len(vertices()) == 6 and same and max(residuals) < MEETS),
        f"{len(vertices())} corners in closed form; both components vanish in each to less than"
        f" {MEETS:g} cm, and a complete decomposition of the region finds the same corners.",
    )


@entry(
    "F-5.2", "figure", "Figure 5, caption",
    "Joining the six points gives a closed, continuous boundary of a feasible area.",
    test="test_scaling.py::test_straight_edges_of_the_six_vertices_leave_the_region",
    chapter=f"{REGION}#do-the-edges-stay-inside",
    mended="Four straight sides and two arcs of B7 bound the region; both arcs bend inward.",
)  # fmt: skip
def six_points_joined() -> Finding:
    t = np.linspace(0, 1, 4001)
    depth = -floor()(polygon.along_edges(vertices(), t)).min(axis=1)
    leaving = [i + 1 for i in range(6) if depth[i] > MEETS]
    arcs = [arc for loop in by_windows().loops for arc in loop]
    ends = np.array([arc.points[[0, -1]] for arc in arcs])
    closed = np.allclose(ends[:, 1], np.roll(ends[:, 0], -1, axis=0), atol=MEETS)
    return Finding(
        judge(holds=not leaving, under=closed and len(by_windows().loops) == 1),
        f"Joined by straight lines, as drawn, edges {' and '.join(map(str, leaving))} leave the"
        f" region: the tool is up to {depth.max():.4f} cm below its limit. Joined along the"
        " functions"
        f" themselves, {len(arcs)} arcs close one loop around {by_windows().area:.6f} rad².",
    )


@entry(
    "F-6.1", "figure", "Figure 6, caption",
    "Scaling about the centroid takes the region off the boundary functions.",
    test="test_scaling.py::test_floor_of_the_papers_polygon_against_brute_force",
    chapter=f"{REGION}#second-remedy-scaling-about-the-centroid",
)  # fmt: skip
def scaling_takes_the_region_off() -> Finding:
    safe = largest_scale()
    bad, good = least_height(0.97), [least_height(s) for s in (0.96, 0.95, 0.9, 0.5)]
    return Finding(
        judge(holds=bad > 0, under=min(good) > 0 and 0.96 < safe.scale < 0.97),
        f"True from scale {safe.scale:.9f} down. At 0.97 the tool is still {-bad:.4f} cm below its"
        " limit on the way from point 3 to point 4.",
    )


@entry(
    "F-6.2", "figure", "Figure 6, caption",
    "The scaling leaves a safety margin.",
    test="test_scaling.py::test_scaling_about_any_centre_touches_the_nearest_wall",
    chapter=f"{REGION}#second-remedy-scaling-about-the-centroid",
)  # fmt: skip
def scaling_leaves_a_margin() -> Finding:
    scales = (0.97, 0.96, 0.95, 0.9, 0.8)
    heights = [least_height(s) for s in scales]
    gaps = [float(body_gap(polygon.along_edges(scaled(s), np.linspace(0, 1, 501))).min())
            for s in scales]  # fmt: skip
    grows = bool((np.diff(heights) > 0).all() and (np.diff(gaps) > 0).all())
    return Finding(
        judge(holds=min(*heights, *gaps) > 0, under=grows and min(heights[1:]) > 0),
        f"A margin in length, and growing, once the scale is below {largest_scale().scale:.6f}: at"
        f" 0.96 the tool keeps {heights[1]:.4f} cm from its limit and the bodies {gaps[1]:.4f} cm"
        " from"
        f" each other, at 0.95 {heights[2]:.4f} and {gaps[2]:.4f} cm.",
    )


@entry(
    "F-6.3", "figure", "Figure 6, caption",
    "The scale factor keeps the workspace free of collision.",
    test="test_bodies.py::test_no_pose_that_the_papers_rule_allows_makes_bodies_overlap",
    chapter="17_bodies#does-the-scaled-region-keep-the-bodies-apart",
)  # fmt: skip
def scaled_region_is_free_of_collision() -> Finding:
    t, factors = np.linspace(0, 1, 41), np.linspace(0.02, 1, 50)
    inside = [polygon.along_edges(scaled(float(0.999 * f)), t) for f in factors]
    least = float(body_gap(np.array(inside)).min())
    touching = float(body_gap(polygon.along_edges(scaled(1.0), t)).min())
    return Finding(
        judge(holds=least > 0),
        f"With the bodies rebuilt from the points: at scale 1 bodies touch (gap {abs(touching):.4f}"
        f" cm), and in all polygons from 0.999 down they are apart, by {least:.4f} cm or more."
        " Below 0.964 the tool keeps its limit too.",
    )


@entry(
    "F-6.4", "figure", "Figure 6, caption and text",
    "The region is scaled by a certain factor about its centroid.",
    test="test_polygon.py::test_centroid_of_the_area_is_not_that_of_the_vertices",
    chapter=f"{REGION}#second-remedy-scaling-about-the-centroid",
)  # fmt: skip
def which_factor_and_which_centroid() -> Finding:
    middles = polygon.centroid(vertices()), vertices().mean(axis=0)
    fits = {
        f"{factor} about {name}": scaling.least_along_edges(
            floor(), polygon.scaled(vertices(), factor, middle)
        )[0]
        > 0
        for factor in (0.96, 0.95, 0.9, 0.8)
        for name, middle in zip(("the area's centroid", "the points' mean"), middles, strict=True)
    }
    apart = float(np.degrees(np.linalg.norm(np.subtract(*middles))))
    both = [largest_scale(centre).scale for centre in ("area", "vertices")]
    return Finding(
        undetermined(fits),
        f"No factor is printed, nor which centroid: all {len(fits)} combinations tried are safe."
        " The"
        f" two centroids are {apart:.4f}° apart and allow scales up to {both[0]:.9f} and"
        f" {both[1]:.9f}.",
    )


@entry(
    "F-7.1", "figure", "Figure 7, caption and text",
    "The six points, visited in the region's order, give the tool a path that is not in order.",
    test="test_traversal.py::test_crossings_are_those_that_shapely_finds",
    chapter=f"{SPACE}#fig-7",
)  # fmt: skip
def tool_path_of_the_six_points() -> Finding:
    counts = [crossings(walk((0, 1, 2, 3, 4, 5, 0), s)) for s in (1.0, 0.96, SCALE, 0.9, 0.8)]
    return Finding(
        judge(holds=min(counts) > 0),
        f"The closed path of the tool crosses itself once, at every scale tried ({counts[0]}"
        " crossing"
        " each from scale 1 to 0.8).",
    )


@entry(
    "F-7.2", "figure", "Figure 7, caption",
    "The robot is shown in the final pose of that traversal.",
    test="test_traversal.py::test_joint_path_is_straight_from_stop_to_stop",
    chapter=f"{SPACE}#fig-7",
)  # fmt: skip
def final_pose_of_the_six_points() -> Finding:
    ends = {
        f"from {start + 1} {name}": walk(
            [(start + sense * i) % 6 for i in range(6 + back)]
        ).final_pose
        for start in range(6)
        for sense in (1, -1)
        for back, name in ((0, "open"), (1, "closed"))
    }
    kinds = {tuple(np.round(pose, 9)) for pose in ends.values()}
    return Finding(
        undetermined(dict.fromkeys(ends, len(kinds) > 1)),
        f"Start, direction and return are not stated: {len(ends)} walks round the six points fit,"
        " with"
        f" {len(kinds)} different final poses.",
    )


@entry(
    "F-8.1", "figure", "Figure 8, caption",
    "A certain sequence of five points gives the tool an ordered path, on the right.",
    test="test_traversal.py::test_orders_without_crossing_are_shapelys",
    chapter=f"{SPACE}#five-points",
)  # fmt: skip
def which_five_points() -> Finding:
    fits = {"-".join(str(i + 1) for i in order): True for order in simple()}
    return Finding(
        undetermined(fits),
        f"Of 360 orders of five of the six points (a walk and its reverse counted once) {len(fits)}"
        " give a path of the tool that does not cross itself. The book shows 6-1-2-3-4.",
    )


@entry(
    "F-8.2", "figure", "Figure 8, caption",
    "A sequence of five points, though ordered, stays open.",
    test="test_traversal.py::test_tool_and_reach_are_forward_kinematics",
    chapter=f"{SPACE}#fig-8",
)  # fmt: skip
def five_points_stay_open() -> Finding:
    places = tool_form()(np.array([scaled(1.0), scaled(SCALE), scaled(0.8)]))[..., PLANE]
    apart = np.linalg.norm(places[:, :, None] - places[:, None], axis=-1)
    least = float(apart[:, ~np.eye(6, dtype=bool)].min())
    number = len(list(permutations(range(6), 5)))
    return Finding(
        judge(holds=least > MEETS),
        f"All {number} sequences: five different points have first and last places of the tool at"
        f" least {least:.4f} cm apart, at scales 1, 0.95 and 0.8.",
    )


@entry(
    "F-9", "figure", "Figure 9, caption",
    "A second sequence of five points is feasible and runs along the other side.",
    test="test_scaling.py::test_floor_of_the_papers_polygon_against_brute_force",
    chapter=f"{SPACE}#fig-9",
)  # fmt: skip
def a_second_sequence() -> Finding:
    right, left = walk(RIGHT), walk(LEFT)
    feasible = all(paper_rule.feasible(robot(), w.q).all() for w in (right, left))
    ends = [float(w.tool[-1, 0]) for w in (right, left)]
    ordered = crossings(right) == crossings(left) == 0
    return Finding(
        judge(holds=feasible and ordered and ends[0] > 0 > ends[1]),
        "3-4-5-6-1 and 6-1-2-3-4 both stay feasible at scale 0.95 and do not cross themselves; the"
        f" tool ends at x = {ends[1]:.4f} cm and at x = {ends[0]:.4f} cm.",
    )


@entry(
    "F-10.1", "figure", "Figure 10, caption",
    "Laid over each other, the two regions are not symmetric.",
    test="test_paper_rule.py::test_printed_offsets_have_no_mirror_image",
    chapter=f"{SPACE}#right-against-left",
)  # fmt: skip
def the_regions_are_not_symmetric() -> Finding:
    printed, one_digit = (asymmetry(arm, SCALE) for arm in (robot(), mended()))
    rounding = 2 * np.hypot(0.005, 0.005)
    return Finding(
        judge(holds=printed > rounding),
        f"The mirrored right path and the left one are up to {printed:.4f} cm apart with the"
        " printed"
        f" offsets, {one_digit:.4f} cm with x_{{2,13}} mended to 9.09 cm.",
    )


@entry(
    "F-10.2", "figure", "Figure 10, caption",
    "The asymmetry comes from the scaling about the centroid.",
    test="test_paper_rule.py::test_symmetric_robot_has_a_symmetric_region",
    chapter=f"{SPACE}#right-against-left",
    mended="It comes from the data: an exactly symmetric arm has symmetric paths at every scale.",
)  # fmt: skip
def asymmetry_from_scaling() -> Finding:
    unscaled = asymmetry(robot(), 1.0)
    exact = [asymmetry(symmetric(), s) for s in (1.0, SCALE, 0.8)]
    require(max(exact) < MEETS, "symmetric paths of the symmetric arm")
    return Finding(
        judge(holds=unscaled < MEETS < max(exact)),
        f"Without scaling the paths are {unscaled:.4f} cm apart already; on the exactly symmetric"
        " arm"
        f" they agree to {MEETS:g} cm at scales 1, 0.95 and 0.8.",
    )


@entry(
    "F-10.3", "figure", "Figure 10, caption",
    "The asymmetry comes from the nonlinearity of the trajectory.",
    test="test_paper_rule.py::test_mirrored_robot_has_the_mirrored_region",
    chapter=f"{SPACE}#right-against-left",
    mended="It comes from the data: nonlinear kinematics with symmetric offsets is symmetric.",
)  # fmt: skip
def asymmetry_from_nonlinearity() -> Finding:
    bends = [_bend(arm) for arm in (robot(), symmetric())]
    exact = asymmetry(symmetric(), SCALE)
    require(exact < MEETS, "symmetric paths of the symmetric arm")
    return Finding(
        judge(holds=exact > MEETS or min(bends) < MEETS),
        f"The tool's path bends away from its chords by up to {bends[0]:.4f} cm on the printed"
        " arm and"
        f" {bends[1]:.4f} cm on the symmetric one: as nonlinear, and yet symmetric to {MEETS:g}"
        f" cm.",
    )


@entry(
    "F-10.4", "figure", "Figure 10, caption and text",
    "The paths of Figures 8 and 9 bound the feasible geometric regions.",
    test="test_statements.py::test_the_image_of_the_boundary_encloses_a_part_of_the_workspace",
    chapter=f"{SPACE}#what-the-path-does-not-enclose",
    mended="They and the image of the singular line together bound the geometric workspace.",
)  # fmt: skip
def paths_bound_the_workspace() -> Finding:
    import shapely

    areas, lines = workspace(), [walk(order).tool[:, PLANE] for order in (RIGHT, LEFT)]
    closed = shapely.node(shapely.MultiLineString([[*line, line[0]] for line in lines]))
    within = shapely.union_all(shapely.polygonize([closed]))
    pose = np.array([polygon.centroid(vertices())[0], stretched()])
    out = float(within.distance(shapely.Point(tool_form()(pose)[PLANE])))
    rest = areas["enclosed"] + areas["twice"] - areas["union"]
    require(abs(rest) < 1e-3, "what the path round the region leaves out both postures reach")
    require(bool(paper_rule.feasible(robot(), pose)), "the witness is feasible")
    return Finding(
        judge(holds=out == 0),
        f"The feasible pose q1 = {np.degrees(pose[0]):.4f}°, q2 = {np.degrees(pose[1]):.4f}° puts"
        " the"
        f" tool {out:.2f} cm outside of all that the two paths, closed, enclose. The path round the"
        f" whole region encloses {areas['enclosed']:.2f} of {areas['union']:.2f} cm² that are"
        f" reached.",
    )


def _bend(arm: Robot) -> float:
    """Farthest that the tool's path on the right is from the straight lines between its stops."""
    import shapely

    path = walk(RIGHT, SCALE, arm)
    line, chords = path.tool[:, PLANE], path.tool[path.stops][:, PLANE]
    return float(shapely.LineString(line).hausdorff_distance(shapely.LineString(chords)))


@entry(
    "F-11.1", "figure", "Figure 11, caption",
    "Red points are collisions, blue points are not.",
    test="test_sampling.py::test_predicate_is_what_its_equation_says",
    chapter=f"{SAMPLES}#what-is-a-collision",
)  # fmt: skip
def what_a_red_point_is() -> Finding:
    q = drawn().q
    free = {
        "coincidence of points, eq. (17)": misses_points(robot(), q),
        "the tool's limit alone, eq. (12)": keeps_geometric(robot(), q),
        "clearances, eqs. (11) and (12)": keeps_clear(robot(), q),
        "windows of Table 6": paper_rule.feasible(robot(), q),
        "signs of all components, eq. (9)": keeps_components_positive(robot(), q),
        "whole bodies and the tool's limit": (body_gap(q) > 0) & (floor()(q) >= 0),
    }
    parts = ", ".join(f"{name}: {100 * x.mean():.2f} %" for name, x in free.items())
    return Finding(
        undetermined({name: bool(x.any() and not x.all()) for name, x in free.items()}),
        f"The test is not stated. Free parts of one draw of {len(q)}: {parts}. The first draws no"
        " red"
        " point at all; each of the others could be meant.",
    )


@entry(
    "F-11.2", "figure", "Figure 11, caption",
    "In the plane of the tool there are places with both colours.",
    test="test_sampling.py::test_fraction_free_approaches_the_exact_area_of_the_papers_region",
    chapter=f"{SAMPLES}#why-the-colours-overlap-in-the-plane",
)  # fmt: skip
def both_colours_at_one_place() -> Finding:
    draw = drawn()
    second = other_posture(draw.q)
    same = np.allclose(tool_form()(second), draw.tool, atol=MEETS)
    other = paper_rule.feasible(robot(), second)
    mixed = other[draw.free].mean(), other[~draw.free].mean()
    return Finding(
        judge(holds=bool(same and mixed[0] < 1 and mixed[1] > 0)),
        f"Every place has two postures. Of the free configurations {100 * (1 - mixed[0]):.2f} %"
        " have a"
        f" colliding second posture, of the colliding ones {100 * mixed[1]:.2f} % a free one.",
    )


@entry(
    "F-11.3", "figure", "Figure 11, caption",
    "The free places show the lateral shapes of the workspace.",
    test="test_sampling.py::test_tool_is_forward_kinematics",
    chapter=f"{SAMPLES}#the-two-plots",
)  # fmt: skip
def lateral_shapes() -> Finding:
    places = drawn().tool[drawn().free]
    low = places[places[:, 2] < robot().joints[0].origin[2]]
    sides = [int((low[:, 0] > 0).sum()), int((low[:, 0] < 0).sum())]
    inner = float(np.abs(low[:, 0]).min())
    return Finding(
        judge(holds=min(sides) > 100 and inner > robot().point("6").at[0]),
        f"Below joint 1 the free places fall apart into two lobes, {sides[0]} places of the draw"
        " on the"
        f" right and {sides[1]} on the left, and none within {inner:.2f} cm of the middle.",
    )


@entry(
    "F-11.4", "figure", "Figure 11, first plot",
    "Sampling shows the feasible region of joint space.",
    test="test_sampling.py::test_fraction_free_approaches_the_exact_area_of_the_papers_region",
    chapter=f"{SAMPLES}#what-sampling-costs",
)  # fmt: skip
def sampling_shows_the_region() -> Finding:
    part, draw = by_windows().area / (2 * np.pi) ** 2, drawn()
    off = abs(draw.fraction_free - part) / draw.standard_error
    return Finding(
        judge(holds=bool(off < 3)),
        f"{100 * draw.fraction_free:.3f} % of the draw are free by the paper's rule,"
        f" {100 * part:.4f} %"
        f" of the square exactly: {off:.2f} standard errors apart. The clearance rule, a different"
        f" test, leaves {100 * by_points().area / (2 * np.pi) ** 2:.2f} %.",
    )
