"""Sentences of Section 4 on the geometric workspace, its traversals, and sampling."""

from __future__ import annotations

import numpy as np

from lizarraga2025.ledger import effort
from lizarraga2025.ledger.entries import Finding, entry, judge, require
from lizarraga2025.ledger.facts import SMALL, robot
from lizarraga2025.ledger.walks import (
    LEFT,
    PLANE,
    RIGHT,
    SCALE,
    by_windows,
    crossings,
    drawn,
    neighbours,
    other_posture,
    scaled,
    simple,
    stretched,
    symmetric,
    tool_form,
    walk,
    workspace,
)
from qbound.region import paper_rule
from qbound.sampling import sample


@entry(
    "S-30", "sentence", "Section 4, after Figure 8",
    "The reach is greatest where the links are collinear.",
    test="test_traversal.py::test_reach_is_greatest_with_the_links_in_line",
    chapter="08_workspace#five-points",
)  # fmt: skip
def greatest_reach() -> Finding:
    q2 = np.linspace(-np.pi, np.pi, 7201)
    places = tool_form()(np.stack([0 * q2, q2], -1)) - robot().joints[0].origin
    reach = np.linalg.norm(places, axis=-1)
    best, at = float(reach.max()), float(q2[reach.argmax()])
    links = np.linalg.norm(robot().joints[1].origin) + np.linalg.norm(robot().point("3").at)
    return Finding(
        judge(holds=bool(abs(at - stretched()) < 1e-3 and best <= links + SMALL)),
        f"The distance of the tool from joint 1 is greatest at q2 = {np.degrees(stretched()):.4f}°,"
        f" where it is {links:.4f} cm, the sum of both links.",
    )


@entry(
    "S-31", "sentence", "Section 4, after Figure 8",
    "There the arm is singular.",
    test="test_statements.py::test_the_arm_is_singular_where_it_is_stretched",
    chapter="08_workspace#the-stretched-pose",
)  # fmt: skip
def stretched_is_singular() -> Finding:
    q = np.array([[0.3, stretched()], [-1.0, stretched()], [0.3, stretched() + 0.1]])
    det = np.linalg.det(tool_form().gradient(q)[:, PLANE])
    return Finding(
        judge(holds=bool(np.abs(det[:2]).max() < SMALL < abs(det[2]))),
        f"det J vanishes on the line q2 = {np.degrees(stretched()):.4f}° for every q1 (to {SMALL:g}"
        f" cm²) and is {det[2]:.2f} cm² a tenth of a radian beside it.",
    )


@entry(
    "S-32", "sentence", "Section 4, after Figure 8",
    "The scaling settles the singular poses indirectly.",
    test="test_statements.py::test_every_walk_of_five_points_is_stretched_on_the_way",
    chapter="08_workspace#the-stretched-pose",
    mended="Every walk through five of the six points passes through a stretched pose.",
)  # fmt: skip
def scaling_settles_nothing() -> Finding:
    side = {s: np.sign(scaled(s)[:, 1] - stretched()) for s in (1.0, 0.96, SCALE, 0.9, 0.5, 0.1)}
    parts = {s: (int((x < 0).sum()), int((x > 0).sum())) for s, x in side.items()}
    require(set(parts.values()) == {(3, 3)}, "three points on either side of the singular line")
    passing = sum(bool(np.ptp(np.sign(walk(o).q[:, 1] - stretched()))) for o in neighbours())
    return Finding(
        judge(holds=passing == 0),
        "At every scale tried, 1 to 0.1, three points lie on either side of the singular line, so"
        " any"
        f" five of them lie on both: all walks cross it, among them the {passing} sequences of"
        " neighbours.",
    )


@entry(
    "S-33", "sentence", "Section 4, before Figure 9",
    "Two distinct ways lead round the geometric workspace, on the right or on the left.",
    test="test_traversal.py::test_orders_without_crossing_are_shapelys",
    chapter="08_workspace#five-points",
)  # fmt: skip
def two_ways() -> Finding:
    free = [o for o in neighbours() if crossings(walk(o)) == 0]
    mirror = (3, 4, 5, 0, 1, 2)
    paired = {o for o in free if tuple(mirror[i] for i in o) in free}
    forward = {min(o, o[::-1]) for o in paired}
    return Finding(
        judge(holds=len(simple()) == 2, under=len(forward) == 2),
        f"{len(simple())} orders of five points do not cross themselves. If the five are to be"
        f" neighbours and the two ways mirror images, {len(forward)} are left (and their reverses):"
        " 6-1-2-3-4 on the right, 3-4-5-6-1 on the left.",
    )


@entry(
    "S-34", "sentence", "Section 4, before Figure 9",
    "The choice decides the final pose.",
    test="test_traversal.py::test_joint_path_is_straight_from_stop_to_stop",
    chapter="08_workspace#five-points",
)  # fmt: skip
def choice_decides_the_pose() -> Finding:
    ends = [np.degrees(walk(o).final_pose) for o in (RIGHT, LEFT)]
    text = " and ".join(f"({a:.4f}°, {b:.4f}°)" for a, b in ends)
    return Finding(
        judge(holds=bool(np.abs(ends[0] - ends[1]).max() > 1)),
        f"The right-hand and the left-hand way end at {text}.",
    )


@entry(
    "S-35", "sentence", "Section 4, before Figure 9",
    "The choice between right and left decides the reach.",
    test="test_statements.py::test_right_and_left_reach_equally_far_on_the_symmetric_arm",
    chapter="08_workspace#five-points",
)  # fmt: skip
def choice_decides_the_reach() -> Finding:
    reach = {arm: [float(walk(o, SCALE, arm).reach[-1]) for o in (RIGHT, LEFT)]
             for arm in (robot(), symmetric())}  # fmt: skip
    printed, exact = reach.values()
    spread = [float(walk(o).reach[-1]) for o in neighbours()]
    return Finding(
        judge(holds=abs(exact[0] - exact[1]) > SMALL, under=max(spread) - min(spread) > 1),
        f"Among all sequences the final reach runs from {min(spread):.4f} to {max(spread):.4f} cm."
        f" Between right and left it differs by the rounded data alone: {printed[0]:.4f} and"
        f" {printed[1]:.4f} cm as printed, {exact[0]:.4f} cm for both on the symmetric arm.",
    )


@entry(
    "S-36", "sentence", "Section 4, before Figure 9",
    "The last link cannot come to its mirrored pose on one trajectory.",
    test="test_statements.py::test_the_mirrored_pose_is_reached_through_the_stretched_one",
    chapter="08_workspace#the-stretched-pose",
    mended="It cannot without passing through the stretched, singular pose.",
)  # fmt: skip
def mirrored_pose_on_one_trajectory() -> Finding:
    p = scaled(SCALE, symmetric())
    turned = np.radians([-60.0, -120.0]) - p[0]  # the arm mirrored at the z axis
    straight = p[0] + np.linspace(0, 1, 2001)[:, None] * (p[3] - p[0])
    allowed = bool(paper_rule.feasible(symmetric(), straight).all())
    mirrored = bool(np.allclose(turned, p[3], atol=SMALL))
    apart = np.sign([q[1] - stretched(symmetric()) for q in (p[0], p[3])])
    require(apart[0] * apart[1] < 0, "mirrored poses on either side of the singular line")
    right = walk(RIGHT)
    return Finding(
        judge(holds=not (allowed and mirrored)),
        "On the symmetric arm point 4 is the mirror image of point 1, and the straight joint path"
        f" between them is feasible throughout ({len(straight)} poses checked). The book's"
        " right-hand"
        " way visits both too, stretched on the way (q2 from"
        f" {np.degrees(right.q[:, 1].min()):.2f}°"
        f" to {np.degrees(right.q[:, 1].max()):.2f}°).",
    )


@entry(
    "S-37", "sentence", "Section 4, after Figure 10",
    "Figure 10 shows the traditional numerical methods at work.",
    test="test_statements.py::test_the_figure_meant_is_the_one_whose_caption_says_so",
    chapter="09_sampling#answer",
    mended="Figure 11 does.",
)  # fmt: skip
def figure_10_for_11() -> Finding:
    named = [number for number, shows in CAPTIONS.items() if shows == NAMED[1]]
    return Finding(
        judge(holds=named == [NAMED[0]], mended=len(named) == 1),
        f"The sentence names Figure {NAMED[0]}, whose caption announces {CAPTIONS[NAMED[0]]};"
        f" {NAMED[1]} are announced by the caption of Figure {named[0]} alone.",
    )


CAPTIONS = {
    7: "the path of six points",
    8: "a path of five points",
    9: "a path of five points",
    10: "an overlay of two paths",
    11: "random configurations",
}
"""What the captions of Section 4's last figures announce."""

NAMED = (10, "random configurations")
"""The figure that the text names, and what it says is seen there."""


@entry(
    "S-38", "sentence", "Section 4, on numerical methods",
    "Random sampling costs much computation.",
    test="test_statements.py::test_the_closed_form_needs_few_evaluations",
    chapter="09_sampling#at-equal-accuracy",
)  # fmt: skip
def sampling_is_costly() -> Finding:
    rows = []
    for k in (2, 3, 6):
        nodes = next(n for n in range(1, 99) if effort.closed_form_error(n) < 10.0**-k)
        rows.append((k, effort.samples_needed(10.0**-k), effort.CLOSED_FORM_START + 2 * nodes))
    text = "; ".join(f"1e-{k}: {drawn:.3g} against {solved}" for k, drawn, solved in rows)
    return Finding(
        judge(holds=all(drawn > 100 * solved for _, drawn, solved in rows)),
        "At equal accuracy, configurations judged against solutions of Theorem 2, for a relative"
        f" error of the area of {text}. At the accuracy of a picture the cost is no obstacle.",
    )


@entry(
    "S-39", "sentence", "Section 4, on numerical methods",
    "Numerical methods give no continuous boundary in joint space.",
    test="test_statements.py::test_a_contour_on_a_grid_is_one_closed_curve_near_the_region",
    chapter="09_sampling#at-equal-accuracy",
)  # fmt: skip
def no_continuous_boundary() -> Finding:
    errors = {n: effort.contour_error(n) for n in (50, 100, 200, 400)}
    closed = all(
        len(effort.contour_of_grid(n)) == 1
        and np.allclose(effort.contour_of_grid(n)[0][0], effort.contour_of_grid(n)[0][-1])
        for n in errors
    )
    text = ", ".join(f"{n * n}: {e:.2g}" for n, e in errors.items())
    on_it = (paper_rule.box(robot()).lower == drawn().q).any()
    return Finding(
        judge(holds=not closed, under=not on_it),
        "True of drawn points. The same predicate on a grid gives one closed contour by marching"
        f" squares; error of its area by evaluations: {text}.",
    )


@entry(
    "S-40", "sentence", "Section 4, on numerical methods",
    "The efficiency of sampling depends directly on the volume of data.",
    test="test_sampling.py::test_standard_error_is_binomial",
    chapter="09_sampling#what-sampling-costs",
)  # fmt: skip
def efficiency_and_volume() -> Finding:
    part = by_windows().area / (2 * np.pi) ** 2
    sizes = np.array([100, 1000, 10_000])
    errors = [
        np.sqrt(
            np.mean(
                [
                    (sample(robot(), n, paper_rule.feasible, seed=s).fraction_free / part - 1) ** 2
                    for s in range(40)
                ]
            )
        )
        for n in sizes
    ]
    slope = float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
    return Finding(
        judge(holds=-0.6 < slope < -0.4),
        f"The error of the area falls as the number of samples to the power {slope:.3f} (40 draws"
        " each"
        " of 100, 1000 and 10,000): one more digit costs a hundredfold.",
    )


@entry(
    "S-41", "sentence", "Section 4, before Figure 11",
    "The overlap of colours in the plane comes from the poses of Figures 8 and 9.",
    test="test_statements.py::test_the_overlap_is_where_one_posture_alone_is_safe",
    chapter="09_sampling#why-the-colours-overlap-in-the-plane",
)  # fmt: skip
def overlap_comes_from_postures() -> Finding:
    areas, draw = workspace(), drawn()
    once = areas["union"] - areas["twice"]
    free = draw.q[draw.free]
    alone = ~paper_rule.feasible(robot(), other_posture(free))
    weight = np.abs(np.linalg.det(tool_form().gradient(free)[:, PLANE]))
    drawn_area = float((weight * alone).sum() / len(draw.q) * (2 * np.pi) ** 2)
    return Finding(
        judge(holds=abs(drawn_area / once - 1) < 0.05),
        f"A place shows both colours exactly where one of its two postures is safe: {once:.2f}"
        " cm² of the"
        f" {areas['union']:.2f} cm² of safe places, without sampling. The draw gives"
        f" {drawn_area:.1f} cm².",
    )


@entry(
    "S-42", "sentence", "Section 4, before Figure 11",
    "The lateral shapes of the workspace show as in Figure 7.",
    test="test_statements.py::test_the_image_of_the_boundary_encloses_a_part_of_the_workspace",
    chapter="08_workspace#what-the-path-does-not-enclose",
)  # fmt: skip
def lobes_show() -> Finding:
    areas = workspace()
    once = areas["union"] - areas["twice"]
    same = abs(areas["enclosed"] - once) < 1e-3
    return Finding(
        judge(holds=same),
        f"What the path round the region encloses, {areas['enclosed']:.2f} cm² in two lobes, is"
        " just the"
        f" part with one safe posture ({once:.2f} cm²): the lateral shapes are the places of both"
        " colours.",
    )
