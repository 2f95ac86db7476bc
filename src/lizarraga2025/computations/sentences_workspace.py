"""Sentences of Section 4 on the geometric workspace, its traversals, and sampling."""

from __future__ import annotations

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence import effort
from lizarraga2025.evidence.arms import robot, symmetric, tool_form
from lizarraga2025.evidence.joint_region import SCALE, drawn, scaled, share_of_square
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import (
    LEFT,
    RIGHT,
    aspect,
    det_jacobian,
    is_cut_by_the_singular_line,
    neighbour_sequences,
    other_posture,
    path_through,
    simple_neighbours,
    simple_sequences,
    stretched,
    workspace,
)
from lizarraga2025.verdicts import Outcome, judge, require
from qbound.region import paper_rule
from qbound.sampling import sample


@computes("S-30")
def greatest_reach() -> Outcome:
    q2 = np.linspace(-np.pi, np.pi, 7201)
    places = tool_form()(np.stack([0 * q2, q2], -1)) - robot().joints[0].origin
    reach = np.linalg.norm(places, axis=-1)
    best, at = float(reach.max()), float(q2[reach.argmax()])
    links = np.linalg.norm(robot().joints[1].origin) + np.linalg.norm(robot().point("3").at)
    return Outcome(
        judge(holds=bool(abs(at - stretched()) < 1e-3 and best <= links + SMALL)),
        f"The distance of the tool from joint 1 is greatest at q2 = {np.degrees(stretched()):.4f}°,"
        f" where it is {links:.4f} cm, the sum of both links.",
    )


@computes("S-31")
def stretched_is_singular() -> Outcome:
    q = np.array([[0.3, stretched()], [-1.0, stretched()], [0.3, stretched() + 0.1]])
    det = det_jacobian(q)
    return Outcome(
        judge(holds=bool(np.abs(det[:2]).max() < SMALL < abs(det[2]))),
        f"det J vanishes on the line q2 = {np.degrees(stretched()):.4f}° for every q1 (to {SMALL:g}"
        f" cm²) and is {det[2]:.2f} cm² a tenth of a radian beside it.",
    )


@computes("S-32")
def scaling_settles_nothing() -> Outcome:
    side = {s: aspect(scaled(s)) for s in (1.0, 0.96, SCALE, 0.9, 0.5, 0.1)}
    parts = {s: (int((x < 0).sum()), int((x > 0).sum())) for s, x in side.items()}
    require(set(parts.values()) == {(3, 3)}, "three points on either side of the singular line")
    passing = sum(is_cut_by_the_singular_line(path_through(o).q) for o in neighbour_sequences())
    return Outcome(
        judge(holds=passing == 0),
        "At every scale tried, 1 to 0.1, three points lie on either side of the singular line, so"
        f" any five of them lie on both: all walks cross it, among them the {passing} sequences of"
        " neighbours.",
    )


@computes("S-33")
def two_ways() -> Outcome:
    free = simple_neighbours()
    mirror = (3, 4, 5, 0, 1, 2)
    paired = {o for o in free if tuple(mirror[i] for i in o) in free}
    forward = {min(o, o[::-1]) for o in paired}
    return Outcome(
        judge(holds=len(simple_sequences()) == 2, under=len(forward) == 2),
        f"{len(simple_sequences())} orders of five points do not cross themselves. If the five are"
        f" to be neighbours and the two ways mirror images, {len(forward)} are left (and their"
        " reverses): 6-1-2-3-4 on the right, 3-4-5-6-1 on the left.",
    )


@computes("S-34")
def choice_decides_the_pose() -> Outcome:
    ends = [np.degrees(path_through(o).final_pose) for o in (RIGHT, LEFT)]
    text = " and ".join(f"({a:.4f}°, {b:.4f}°)" for a, b in ends)
    return Outcome(
        judge(holds=bool(np.abs(ends[0] - ends[1]).max() > 1)),
        f"The right-hand and the left-hand way end at {text}.",
    )


@computes("S-35")
def choice_decides_the_reach() -> Outcome:
    reach = {arm: [float(path_through(o, SCALE, arm).reach[-1]) for o in (RIGHT, LEFT)]
             for arm in (robot(), symmetric())}  # fmt: skip
    printed, exact = reach.values()
    spread = [float(path_through(o).reach[-1]) for o in neighbour_sequences()]
    return Outcome(
        judge(holds=abs(exact[0] - exact[1]) > SMALL, under=max(spread) - min(spread) > 1),
        f"Among all sequences the final reach runs from {min(spread):.4f} to {max(spread):.4f} cm."
        f" Between right and left it differs by the rounded data alone: {printed[0]:.4f} and"
        f" {printed[1]:.4f} cm as printed, {exact[0]:.4f} cm for both on the symmetric arm.",
    )


@computes("S-36")
def mirrored_pose_on_one_trajectory() -> Outcome:
    p = scaled(SCALE, symmetric())
    turned = np.radians([-60.0, -120.0]) - p[0]  # the arm mirrored at the z axis
    straight = p[0] + np.linspace(0, 1, 2001)[:, None] * (p[3] - p[0])
    allowed = bool(paper_rule.feasible(symmetric(), straight).all())
    mirrored = bool(np.allclose(turned, p[3], atol=SMALL))
    apart = aspect(p[[0, 3]], symmetric())
    require(apart[0] * apart[1] < 0, "mirrored poses on either side of the singular line")
    right = path_through(RIGHT)
    return Outcome(
        judge(holds=not (allowed and mirrored)),
        "On the symmetric arm point 4 is the mirror image of point 1, and the straight joint path"
        f" between them is feasible throughout ({len(straight)} poses checked). The book's"
        " right-hand way visits both too, stretched on the way (q2 from"
        f" {np.degrees(right.q[:, 1].min()):.2f}° to {np.degrees(right.q[:, 1].max()):.2f}°).",
    )


@computes("S-37")
def figure_10_for_11() -> Outcome:
    number, subject = paper.NAMED_FIGURE
    showing = [figure for figure, shows in paper.CAPTIONS.items() if shows == subject]
    return Outcome(
        judge(holds=showing == [number], corrected=len(showing) == 1),
        f"The sentence names Figure {number}, whose caption announces {paper.CAPTIONS[number]};"
        f" {subject} are announced by the caption of Figure {showing[0]} alone.",
    )


@computes("S-38")
def sampling_is_costly() -> Outcome:
    rows = []
    for k in (2, 3, 6):
        error = 10.0**-k
        rows.append((k, effort.samples_needed(error), effort.closed_form_evaluations(error)))
    text = "; ".join(f"1e-{k}: {drawn:.3g} against {solved}" for k, drawn, solved in rows)
    return Outcome(
        judge(holds=all(drawn > 100 * solved for _, drawn, solved in rows)),
        "At equal accuracy, configurations judged against solutions of Theorem 2, for a relative"
        f" error of the area of {text}. At the accuracy of a picture the cost is no obstacle.",
    )


@computes("S-39")
def no_continuous_boundary() -> Outcome:
    errors = {n: effort.contour_error(n) for n in (50, 100, 200, 400)}
    closed = all(effort.contour_is_closed(n) for n in errors)
    text = ", ".join(f"{n * n}: {e:.2g}" for n, e in errors.items())
    on_it = (paper_rule.box(robot()).lower == drawn().q).any()
    return Outcome(
        judge(holds=not closed, under=not on_it),
        "True of drawn points. The same predicate on a grid gives one closed contour by marching"
        f" squares; error of its area by evaluations: {text}.",
    )


@computes("S-40")
def efficiency_and_volume() -> Outcome:
    part = share_of_square()
    sizes = np.array([100, 1000, 10_000])
    free = [
        [sample(robot(), n, paper_rule.feasible, seed=s).fraction_free for s in range(40)]
        for n in sizes
    ]
    errors = np.sqrt(np.mean((np.array(free) / part - 1) ** 2, axis=1))
    slope = float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])
    return Outcome(
        judge(holds=-0.6 < slope < -0.4),
        f"The error of the area falls as the number of samples to the power {slope:.3f} (40 draws"
        " each of 100, 1000 and 10,000): one more digit costs a hundredfold.",
    )


@computes("S-41")
def overlap_comes_from_postures() -> Outcome:
    areas, draw = workspace(), drawn()
    free = draw.q[draw.free]
    alone = ~paper_rule.feasible(robot(), other_posture(free))
    weight = np.abs(det_jacobian(free))
    drawn_area = float((weight * alone).sum() / len(draw.q) * (2 * np.pi) ** 2)
    return Outcome(
        judge(holds=abs(drawn_area / areas["once"] - 1) < 0.05),
        "A place shows both colours exactly where one of its two postures is safe:"
        f" {areas['once']:.2f} cm² of the {areas['union']:.2f} cm² of safe places, without"
        f" sampling. The draw gives {drawn_area:.1f} cm².",
    )


@computes("S-42")
def lobes_show() -> Outcome:
    areas = workspace()
    same = abs(areas["enclosed"] - areas["once"]) < 1e-3
    return Outcome(
        judge(holds=same),
        f"What the path round the region encloses, {areas['enclosed']:.2f} cm² in two lobes, is"
        f" just the part with one safe posture ({areas['once']:.2f} cm²): the lateral shapes are"
        " the places of both colours.",
    )
