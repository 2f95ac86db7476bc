"""Captions of Figures 7 to 11: paths of the tool, and sampling."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from lizarraga2025.collisions import keeps_components_positive, keeps_geometric, misses_points
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import corrected, robot, symmetric, tool_form
from lizarraga2025.evidence.joint_region import (
    SCALE,
    bodies_allow,
    by_clearances,
    drawn,
    scaled,
    share_of_square,
    vertices,
)
from lizarraga2025.evidence.rounding import HALF_DIGIT, SMALL
from lizarraga2025.evidence.tool_paths import (
    AROUND,
    LEFT,
    PLANE,
    RIGHT,
    asymmetry,
    asymmetry_of_the_symmetric,
    crossings,
    other_posture,
    path_through,
    simple_sequences,
    stretched,
    workspace,
)
from lizarraga2025.verdicts import Finding, judge, require, undetermined
from qbound.geometry import polygon
from qbound.model.robot import Robot
from qbound.region import paper_rule
from qbound.sampling import keeps_clear


@computes("F-7.1")
def tool_path_of_the_six_points() -> Finding:
    counts = [crossings(path_through(AROUND, s)) for s in (1.0, 0.96, SCALE, 0.9, 0.8)]
    return Finding(
        judge(holds=min(counts) > 0),
        f"The closed path of the tool crosses itself once, at every scale tried ({counts[0]}"
        " crossing each from scale 1 to 0.8).",
    )


@computes("F-7.2")
def final_pose_of_the_six_points() -> Finding:
    ends = {
        f"from {start + 1} {name}": path_through(
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
        f" with {len(kinds)} different final poses.",
    )


@computes("F-8.1")
def which_five_points() -> Finding:
    fits = {"-".join(str(i + 1) for i in order): True for order in simple_sequences()}
    return Finding(
        undetermined(fits),
        f"Of 360 orders of five of the six points (a walk and its reverse counted once) {len(fits)}"
        " give a path of the tool that does not cross itself. The book shows 6-1-2-3-4.",
    )


@computes("F-8.2")
def five_points_stay_open() -> Finding:
    places = tool_form()(np.array([scaled(1.0), scaled(SCALE), scaled(0.8)]))[..., PLANE]
    apart = np.linalg.norm(places[:, :, None] - places[:, None], axis=-1)
    least = float(apart[:, ~np.eye(6, dtype=bool)].min())
    number = len(list(permutations(range(6), 5)))
    return Finding(
        judge(holds=least > SMALL),
        f"All {number} sequences: five different points have first and last places of the tool at"
        f" least {least:.4f} cm apart, at scales 1, 0.95 and 0.8.",
    )


@computes("F-9")
def a_second_sequence() -> Finding:
    right, left = path_through(RIGHT), path_through(LEFT)
    feasible = all(paper_rule.feasible(robot(), w.q).all() for w in (right, left))
    ends = [float(w.tool[-1, 0]) for w in (right, left)]
    ordered = crossings(right) == crossings(left) == 0
    return Finding(
        judge(holds=feasible and ordered and ends[0] > 0 > ends[1]),
        "3-4-5-6-1 and 6-1-2-3-4 both stay feasible at scale 0.95 and do not cross themselves; the"
        f" tool ends at x = {ends[1]:.4f} cm and at x = {ends[0]:.4f} cm.",
    )


@computes("F-10.1")
def the_regions_are_not_symmetric() -> Finding:
    printed, one_digit = (asymmetry(arm, SCALE) for arm in (robot(), corrected()))
    rounding = 2 * np.hypot(HALF_DIGIT, HALF_DIGIT)
    return Finding(
        judge(holds=printed > rounding),
        f"The mirrored right path and the left one are up to {printed:.4f} cm apart with the"
        f" printed offsets, {one_digit:.4f} cm with x_{{2,13}} mended to 9.09 cm.",
    )


@computes("F-10.2")
def asymmetry_from_scaling() -> Finding:
    unscaled = asymmetry(robot(), 1.0)
    exact = asymmetry_of_the_symmetric()
    require(exact < SMALL, "symmetric paths of the symmetric arm")
    return Finding(
        judge(holds=unscaled < SMALL < exact),
        f"Without scaling the paths are {unscaled:.4f} cm apart already; on the exactly symmetric"
        f" arm they agree to {SMALL:g} cm at scales 1, 0.95 and 0.8.",
    )


@computes("F-10.3")
def asymmetry_from_nonlinearity() -> Finding:
    bends = [_bend(arm) for arm in (robot(), symmetric())]
    exact = asymmetry(symmetric(), SCALE)
    require(exact < SMALL, "symmetric paths of the symmetric arm")
    return Finding(
        judge(holds=exact > SMALL or min(bends) < SMALL),
        f"The tool's path bends away from its chords by up to {bends[0]:.4f} cm on the printed arm"
        f" and {bends[1]:.4f} cm on the symmetric one: as nonlinear, and yet symmetric to {SMALL:g}"
        " cm.",
    )


@computes("F-10.4")
def paths_bound_the_workspace() -> Finding:
    import shapely

    areas, lines = workspace(), [path_through(order).tool[:, PLANE] for order in (RIGHT, LEFT)]
    closed = shapely.node(shapely.MultiLineString([[*line, line[0]] for line in lines]))
    within = shapely.union_all(shapely.polygonize([closed]))
    pose = np.array([polygon.centroid(vertices())[0], stretched()])
    out = float(within.distance(shapely.Point(tool_form()(pose)[PLANE])))
    rest = areas["enclosed"] - areas["once"]
    require(abs(rest) < 1e-3, "what the path round the region leaves out both postures reach")
    require(bool(paper_rule.feasible(robot(), pose)), "the witness is feasible")
    return Finding(
        judge(holds=out == 0),
        f"The feasible pose q1 = {np.degrees(pose[0]):.4f}°, q2 = {np.degrees(pose[1]):.4f}° puts"
        f" the tool {out:.2f} cm outside of all that the two paths, closed, enclose. The path round"
        f" the whole region encloses {areas['enclosed']:.2f} of {areas['union']:.2f} cm² that are"
        " reached.",
    )


def _bend(arm: Robot) -> float:
    """Farthest that the tool's path on the right is from the straight lines between its stops."""
    import shapely

    path = path_through(RIGHT, SCALE, arm)
    line, chords = path.tool[:, PLANE], path.tool[path.stops][:, PLANE]
    return float(shapely.LineString(line).hausdorff_distance(shapely.LineString(chords)))


@computes("F-11.1")
def what_a_red_point_is() -> Finding:
    q = drawn().q
    free = {
        "coincidence of points, eq. (17)": misses_points(robot(), q),
        "the tool's limit alone, eq. (12)": keeps_geometric(robot(), q),
        "clearances, eqs. (11) and (12)": keeps_clear(robot(), q),
        "windows of Table 6": paper_rule.feasible(robot(), q),
        "signs of all components, eq. (9)": keeps_components_positive(robot(), q),
        "whole bodies and the tool's limit": bodies_allow(q),
    }
    parts = ", ".join(f"{name}: {100 * x.mean():.2f} %" for name, x in free.items())
    return Finding(
        undetermined({name: bool(x.any() and not x.all()) for name, x in free.items()}),
        f"The test is not stated. Free parts of one draw of {len(q)}: {parts}. The first draws no"
        " red point at all; each of the others could be meant.",
    )


@computes("F-11.2")
def both_colours_at_one_place() -> Finding:
    draw = drawn()
    second = other_posture(draw.q)
    same = np.allclose(tool_form()(second), draw.tool, atol=SMALL)
    other = paper_rule.feasible(robot(), second)
    mixed = other[draw.free].mean(), other[~draw.free].mean()
    return Finding(
        judge(holds=bool(same and mixed[0] < 1 and mixed[1] > 0)),
        f"Every place has two postures. Of the free configurations {100 * (1 - mixed[0]):.2f} %"
        f" have a colliding second posture, of the colliding ones {100 * mixed[1]:.2f} % a free"
        " one.",
    )


@computes("F-11.3")
def lateral_shapes() -> Finding:
    places = drawn().tool[drawn().free]
    low = places[places[:, 2] < robot().joints[0].origin[2]]
    sides = [int((low[:, 0] > 0).sum()), int((low[:, 0] < 0).sum())]
    inner = float(np.abs(low[:, 0]).min())
    return Finding(
        judge(holds=min(sides) > 100 and inner > robot().point("6").at[0]),
        f"Below joint 1 the free places fall apart into two lobes, {sides[0]} places of the draw on"
        f" the right and {sides[1]} on the left, and none within {inner:.2f} cm of the middle.",
    )


@computes("F-11.4")
def sampling_shows_the_region() -> Finding:
    part, draw = share_of_square(), drawn()
    off = abs(draw.fraction_free - part) / draw.standard_error
    return Finding(
        judge(holds=bool(off < 3)),
        f"{100 * draw.fraction_free:.3f} % of the draw are free by the paper's rule,"
        f" {100 * part:.4f} % of the square exactly: {off:.2f} standard errors apart. The clearance"
        f" rule, a different test, leaves {100 * by_clearances().area / (2 * np.pi) ** 2:.2f} %.",
    )
