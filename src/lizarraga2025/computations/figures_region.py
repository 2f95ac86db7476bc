"""Captions of Figures 1 to 6: labels, the chain, the joint region and its scaling."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from lizarraga2025 import closed_form
from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import floor, half_spaces, pairs, robot, symbolic_robot
from lizarraga2025.evidence.joint_region import (
    body_gap,
    by_windows,
    depth_below_edges,
    largest_scale,
    least_height,
    scaled,
    vertices,
)
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.verdicts import Outcome, judge, undetermined
from qbound import pair_vector
from qbound.geometry import polygon
from qbound.measures import scaling
from qbound.region import paper_rule, solve, state
from qbound.symbols import joint_symbols


@computes("F-1")
def labels_close_a_triangle() -> Outcome:
    import sympy as sp

    frames = symbolic_robot()[0].frames(joint_symbols(robot()))
    seen = sp.Matrix(frames.rotation("0", "1")) * sp.Matrix(frames.position("1", "2", "1"))
    path = sp.Matrix(frames.position("0", "1", "0")) + seen
    closed = sp.simplify(path - sp.Matrix(frames.position("0", "2", "0"))) == sp.zeros(3, 1)
    return Outcome(
        judge(holds=closed),
        "Labels are enough to compute with: r_{0,1} and r_{1,2}, the second turned by"
        " R_{0,1}, add up to r_{0,2} by identity. The picture itself is drawn anew.",
    )


@computes("F-2")
def points_lie_on_adjacent_links() -> Outcome:
    chain = [robot().base, *(joint.frame for joint in robot().joints)]
    apart = [
        abs(chain.index(robot().point(a).frame) - chain.index(robot().point(b).frame))
        for a, b in (pair.points for pair in pairs())
    ]
    return Outcome(
        judge(holds=set(apart) == {1}),
        f"In all {len(apart)} pairs of Tables 3 and 4 one joint lies between the two points.",
    )


@computes("F-3")
def chain_of_the_robot() -> Outcome:
    frames = robot().frames(robot().home)
    order = ["0", "1", "2", robot().tool]
    precede = all(frames.precedes(a, b) for a, b in pairwise(order))
    return Outcome(
        judge(holds=precede and order[-1] == "3"),
        f"Each of {', '.join(order)} precedes the next; {len(robot().joints)} joints move them.",
    )


def _edges() -> set[str]:
    """Labels of the bounds that bound the region."""
    return {b.label for corner in closed_form.vertices(robot()) for b in corner.bounds}


@computes("F-4.1")
def six_curves() -> Outcome:
    named, found = set(paper.FIGURE_4_BOUNDS), _edges()
    lines = [{label.rpartition(",")[0] for label in labels} for labels in (named, found)]
    return Outcome(
        judge(holds=lines[0] == lines[1] and len(found) == len(named)),
        f"The exact region has {len(found)} bounding curves, of the components that the caption"
        f" names; {len(named & found)} of the six labels agree to the last index.",
    )


@computes("F-4.2")
def the_index_of_one_bound() -> Outcome:
    side = float(paper_rule.box(robot()).upper[1])
    values = {k: _beta_3_3(k, "atan2") for k in (1, 2)}
    raised = {k: _beta_3_3(k, "arctan") + np.pi for k in (1, 2)}  # a < 0: pi is added
    mendings = {
        "the index": np.isclose(values[1], side) and values[2] < 0 < values[1],
        "the window": np.isclose(raised[2], side) and raised[2] - 2 * np.pi < 0 < raised[2],
    }
    return Outcome(
        undetermined({name: bool(fits) for name, fits in mendings.items()}),
        f"The side lies at {np.degrees(side):.4f}°. With atan2 that is k = 1 and k = 2 is"
        f" {np.degrees(values[2]):.4f}°, off the picture; with an inverse tangent that adds 180° it"
        f" is k = 2, but then the row of Table 6 runs from it to {np.degrees(raised[1]):.4f}° and"
        " leaves out home. Either the index or that row is a turn off; the line is the same.",
    )


def _beta_3_3(k: int, reading: paper.Reading) -> float:
    printed = paper.expression(paper.TABLE_6[f"beta_{{3,3,{k}}}"], arctan=reading)
    return float(printed.subs(symbolic_robot()[1]))


@computes("F-4.3")
def red_lines_play_no_part() -> Outcome:
    box = paper_rule.box(robot())
    ranges = list(zip(box.lower.tolist(), box.upper.tolist(), strict=True))
    names = [("q1.lower", "q1.upper"), ("q2.lower", "q2.upper")]
    home = robot().home
    areas = [
        sum(c.area for c in solve(state(robot(), used, ranges, names), home).components)
        for used in (half_spaces()[2:], half_spaces()[1:], half_spaces())
    ]
    windows = paper_rule.windows(robot())
    outside = all(w.lower <= box.lower[w.joint] and w.upper >= box.upper[w.joint] for w in windows)
    return Outcome(
        judge(holds=outside and np.ptp(areas) < SMALL, under=outside),
        f"True of the {len(windows)} windows of the point pairs. The walls B5 and B6 of Table 5"
        f" cross the region: with B6 in force {areas[1]:.4f} of {areas[0]:.4f} rad² would be left,"
        f" with B5 too {areas[2]:.4f}. The paper leaves them out without a word.",
    )


@computes("F-5.1")
def six_points_on_two_curves_each() -> Outcome:
    residuals = []
    for corner in closed_form.vertices(robot()):
        for bound in corner.bounds:
            boundary = robot().boundary(bound.boundary)
            form = (
                pair_vector(robot(), boundary)[bound.component - 1]
                if boundary in pairs()
                else floor()
            )
            residuals.append(abs(float(form(corner.q))))
    exact = sorted(v.q.tolist() for v in by_windows().vertices)
    same = np.allclose(exact, sorted(vertices().tolist()), atol=SMALL)
    return Outcome(
        judge(holds=len(vertices()) == 6 and same and max(residuals) < SMALL),
        f"{len(vertices())} corners in closed form; both components vanish in each to less than"
        f" {SMALL:g} cm, and a complete decomposition of the region finds the same corners.",
    )


@computes("F-5.2")
def six_points_joined() -> Outcome:
    depth = depth_below_edges()
    leaving = [i + 1 for i in range(6) if depth[i] > SMALL]
    arcs = [arc for loop in by_windows().loops for arc in loop]
    ends = np.array([arc.points[[0, -1]] for arc in arcs])
    closed = np.allclose(ends[:, 1], np.roll(ends[:, 0], -1, axis=0), atol=SMALL)
    return Outcome(
        judge(holds=not leaving, under=closed and len(by_windows().loops) == 1),
        f"Joined by straight lines, as drawn, edges {' and '.join(map(str, leaving))} leave the"
        f" region: the tool is up to {depth.max():.4f} cm below its limit. Joined along the"
        f" functions themselves, {len(arcs)} arcs close one loop around {by_windows().area:.6f}"
        " rad².",
    )


@computes("F-6.1")
def scaling_takes_the_region_off() -> Outcome:
    safe = largest_scale()
    bad, good = least_height(0.97), [least_height(s) for s in (0.96, 0.95, 0.9, 0.5)]
    return Outcome(
        judge(holds=bad > 0, under=min(good) > 0 and 0.96 < safe.scale < 0.97),
        f"True from scale {safe.scale:.9f} down. At 0.97 the tool is still {-bad:.4f} cm below its"
        " limit on the way from point 3 to point 4.",
    )


@computes("F-6.2")
def scaling_leaves_a_margin() -> Outcome:
    scales = (0.97, 0.96, 0.95, 0.9, 0.8)
    heights = [least_height(s) for s in scales]
    gaps = [float(body_gap(polygon.along_edges(scaled(s), np.linspace(0, 1, 501))).min())
            for s in scales]  # fmt: skip
    grows = bool((np.diff(heights) > 0).all() and (np.diff(gaps) > 0).all())
    return Outcome(
        judge(holds=min(*heights, *gaps) > 0, under=grows and min(heights[1:]) > 0),
        f"A margin in length, and growing, once the scale is below {largest_scale().scale:.6f}: at"
        f" 0.96 the tool keeps {heights[1]:.4f} cm from its limit and the bodies {gaps[1]:.4f} cm"
        f" from each other, at 0.95 {heights[2]:.4f} and {gaps[2]:.4f} cm.",
    )


@computes("F-6.3")
def scaled_region_is_free_of_collision() -> Outcome:
    t, factors = np.linspace(0, 1, 41), np.linspace(0.02, 1, 50)
    inside = [polygon.along_edges(scaled(float(0.999 * f)), t) for f in factors]
    least = float(body_gap(np.array(inside)).min())
    touching = float(body_gap(polygon.along_edges(scaled(1.0), t)).min())
    return Outcome(
        judge(holds=least > 0),
        f"With the bodies rebuilt from the points: at scale 1 bodies touch (gap {abs(touching):.4f}"
        f" cm), and in all polygons from 0.999 down they are apart, by {least:.4f} cm or more."
        " Below 0.964 the tool keeps its limit too.",
    )


@computes("F-6.4")
def which_factor_and_which_centroid() -> Outcome:
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
    return Outcome(
        undetermined(fits),
        f"No factor is printed, nor which centroid: all {len(fits)} combinations tried are safe."
        f" The two centroids are {apart:.4f}° apart and allow scales up to {both[0]:.9f} and"
        f" {both[1]:.9f}.",
    )
