"""Sentences of Section 4 on the geometric workspace, its traversals, and sampling."""

from __future__ import annotations

from typing import Final

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence import effort
from lizarraga2025.evidence.arms import corrected, floor, robot, rounded, symmetric, tool_form
from lizarraga2025.evidence.joint_region import (
    by_windows,
    distance_of_the_draw,
    drawn,
    largest_scale,
    share_of_square,
)
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.evidence.tool_paths import (
    arm,
    crossings,
    det_jacobian,
    feasible_neighbours,
    is_cut_by_the_singular_line,
    is_feasible,
    neighbour_sequences,
    opposite,
    path_through,
    reach,
    simple_sequences,
    stretched,
    stretched_poses,
    workspace,
)
from lizarraga2025.readings import in_windows
from lizarraga2025.verdicts import Outcome, Verdict, judge, of_readings
from qbound import polygon, sample
from qbound.arrays import Floats


@computes("S-30")
def greatest_reach() -> Outcome:
    q2 = np.linspace(-np.pi, np.pi, 7201)
    places = tool_form()(np.stack([0 * q2, q2], -1)) - robot().joints[0].origin
    distances = np.linalg.norm(places, axis=-1)
    best, at = float(distances.max()), float(q2[distances.argmax()])
    links = np.linalg.norm(robot().joints[1].origin) + np.linalg.norm(robot().point("3").at)
    return Outcome(
        judge(holds=bool(abs(at - stretched()) < 1e-3 and abs(best - links) < 1e-6)),
        f"The distance of the tool from joint 1 is greatest at q2 = {np.degrees(stretched()):.4f}°,"
        f" where it is {links:.4f} cm, the sum of both links.",
    )


@computes("S-31")
def stretched_is_singular() -> Outcome:
    q = np.array([[0.3, stretched()], [-1.0, stretched()], [0.3, stretched() + 0.1]])
    det = det_jacobian(q)
    return Outcome(
        judge(holds=bool(np.abs(det[:2]).max() < SMALL < abs(det[2]))),
        f"det J vanishes on the line q2 = {np.degrees(stretched()):.4f}°, for every q1, and is"
        f" {det[2]:.2f} cm² a tenth of a radian beside it.",
    )


@computes("S-2")
@computes("S-32")
def scaling_settles_the_stretched_pose() -> Outcome:
    least, feasible = heights_of_the_pass(), {s: len(feasible_neighbours(s)) for s in (1.0, SCALE)}
    passing = [is_cut_by_the_singular_line(path_through(o).q) for o in neighbour_sequences()]
    return of_readings(
        "a path that keeps off the stretched pose",
        {
            "a path in joint space that passes it with every bound kept": pass_keeps_bounds(),
            "a path that keeps off the stretched pose": judge(holds=not all(passing)),
        },
        "Where the outline of the six points passes the stretched pose, the tool's height above"
        f" its limit is {least[1.0]:.4f} cm at the least; at scale {SCALE:g} it is"
        f" {least[SCALE]:.4f} cm, and {feasible[SCALE]} of {len(passing)} sequences of five"
        f" neighbours are feasible, unscaled {feasible[1.0]}; the limit is scale"
        f" {largest_scale().scale:.6f}. {sum(passing)} of them pass the stretched pose.",
    )


def pass_keeps_bounds() -> Verdict:
    """Judge whether scaling makes a path feasible where it passes the stretched pose."""
    least = heights_of_the_pass()
    return judge(
        holds=least[1.0] < 0 < least[0.99] and bool(feasible_neighbours(0.99)),
        under=least[1.0] < 0 < least[SCALE] and bool(feasible_neighbours(SCALE)),
    )


def heights_of_the_pass() -> dict[float, float]:
    """Return the least height, cm, of the tool where the outline passes the stretched pose."""
    scales = (1.0, 0.99, SCALE)
    return {s: float(floor()(stretched_poses(s)).min(initial=np.inf)) for s in scales}


@computes("S-33")
def two_ways() -> Outcome:
    sides = [float(np.sign(path_through(o).tool[-1, 0])) for o in (RIGHT, LEFT)]
    ordered = all(is_feasible(o) and not crossings(path_through(o)) for o in (RIGHT, LEFT))
    number = len(simple_sequences())
    return of_readings(
        "there being one on either side",
        {
            "there being one on either side": judge(holds=ordered and sides == [1, -1]),
            "there being these two and no more": judge(holds=number == 2),
        },
        "The paths 6-1-2-3-4, which ends on the right, and 3-4-5-6-1, which ends on the left, are"
        f" feasible at scale {SCALE:g} and do not cross themselves. They are two of {number} orders"
        " of five points that do not.",
    )


@computes("S-35")
def choice_decides_the_reach() -> Outcome:
    arms = robot(), corrected(), rounded(symmetric()), symmetric()
    ways = [[reach(o, arm) for o in (RIGHT, LEFT)] for arm in arms]
    final = [[float(way[-1]) for way in pair] for pair in ways]
    printed, one_digit, of_rounding, _ = (abs(right - left) for right, left in final)
    largest = [float(way.max()) for way in ways[0]]
    spread = [float(reach(o)[-1]) for o in neighbour_sequences()]
    other = [float(reach(o)[-1]) for o in (ANOTHER, opposite(ANOTHER))]
    apart, far = _places_apart(*(path_through(o).tool for o in (RIGHT, LEFT)))
    return of_readings(
        "the reach in the final pose",
        {
            "which places are reached": judge(holds=apart > 1),
            "the reach in the final pose": judge(
                holds=one_digit > of_rounding + SMALL, under=printed > of_rounding + SMALL
            ),
            "the largest reach on the way": judge(holds=bool(np.ptp(largest) > 0.01)),
        },
        f"The tool's paths on the right and on the left are up to {apart:.1f} cm apart, and"
        f" {100 * far:.0f} % of the length of the left one is more than 1 cm from the right one."
        " The distance in"
        f" the final pose is, at scale {SCALE:g}, {final[0][0]:.4f} cm on the right and"
        f" {final[0][1]:.4f} cm on the left with the printed x_{{2,13}} = 9.00, {final[1][0]:.4f}"
        f" and {final[1][1]:.4f} cm with 9.09 (T-4.2). Rounding the offsets of the exactly"
        f" symmetric arm, whose reach is {final[3][0]:.4f} cm on both sides, to hundredths causes"
        " the same difference. It depends on the pair chosen too: 1-6-5-4-3 and 4-3-2-1-6 end at"
        f" {other[0]:.2f} and {other[1]:.2f} cm. Over all sequences of neighbours it runs from"
        f" {min(spread):.4f} to {max(spread):.4f} cm (S-4). The largest reach on the way is"
        f" {largest[0]:.4f} cm on either.",
    )


ANOTHER: Final = (0, 5, 4, 3, 2)
"""A sequence that fits the text as well as the book's, with its opposite: 1-6-5-4-3."""


def _places_apart(one: Floats, other: Floats) -> tuple[float, float]:
    """Return the largest distance of two paths, cm, and the part of the second 1 cm from the first.

    The second path is looked at in as many places as it has steps.
    """
    distances = polygon.distances(other, one)
    steps = np.linalg.norm(np.diff(other, axis=0), axis=-1)
    far = (distances[1:] > 1) & (distances[:-1] > 1)
    return polygon.hausdorff(one, other), float(steps[far].sum() / steps.sum())


@computes("S-37")
def figure_10_for_11() -> Outcome:
    number, words = paper.ON_NUMERICAL_METHODS
    said = {
        figure: [word for word in words if word in caption.lower()]
        for figure, caption in paper.CAPTIONS_AS_PRINTED.items()
    }
    whole = [figure for figure, found in said.items() if len(found) == len(words)]
    return Outcome(
        judge(holds=whole == [number], corrected=len(whole) == 1 and not said[number]),
        f"Of the words {', '.join(words)}, by which the text says what is seen, the caption of"
        f" Figure {number} has {len(said[number])} and that of Figure"
        f" {', '.join(map(str, whole))} all {len(words)}. The next paragraph names Figure 11 for"
        " the experiment.",
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
        "At equal accuracy, configurations judged against roots by Theorem 2 restated (TH-2), for"
        f" a relative error of the area of {text}. At the accuracy of a picture the cost is no"
        " obstacle.",
    )


GENERAL, RANDOM = "numerical methods in general", "the random draws that the paper evaluates"


@computes_each({"S-6": GENERAL, "S-8.1": GENERAL, "S-39": RANDOM})
def no_continuous_boundary(likeliest: str) -> Outcome:
    grids = (50, 100, 200, 400)
    errors = {n: effort.contour_error(n) for n in grids if effort.contour_is_closed(n)}
    text = "; ".join(f"{n * n}: {e:.2g}" for n, e in errors.items())
    of_draws = distance_of_the_draw() > 0
    return of_readings(
        likeliest,
        {
            GENERAL: judge(holds=len(errors) < len(grids), under=of_draws),
            RANDOM: judge(holds=of_draws),
        },
        "The same test on a grid, which like a draw knows of a configuration only whether it is"
        " feasible, gives one closed contour by marching squares; relative error of its area by"
        f" evaluations: {text}."
        f" Random draws by themselves give none: none of {len(drawn().q)} lies on the"
        " boundary, as is to be expected of any draw.",
    )


@computes("S-40")
def efficiency_and_volume() -> Outcome:
    part = share_of_square()
    sizes = np.array([100, 1000, 10_000])
    free = [[sample(robot(), n, in_windows, seed=s).fraction for s in range(40)] for n in sizes]
    errors = np.sqrt(np.mean((np.array(free) / part - 1) ** 2, axis=1))
    law = np.sqrt(max(0.0, 1 - part) / part / sizes)
    holds = part < 1 and bool((np.abs(errors / law - 1) < 0.5).all())
    text = "; ".join(f"{n}: {e:.1g}" for n, e in zip(sizes, errors, strict=True))
    return Outcome(
        judge(holds=holds),
        "The relative error of the area falls as the square root of the number of samples"
        f" (root mean square of 40 draws, by samples: {text}), so one more digit costs a"
        " hundredfold.",
    )


@computes("S-41")
def overlap_comes_from_postures() -> Outcome:
    once, draw = workspace().area - workspace().covered_twice, drawn()
    alone = ~by_windows().contains(arm().other_posture(draw.q)) & draw.allowed
    share = np.abs(det_jacobian(draw.q)) * alone * (2 * np.pi) ** 2
    drawn_area, error = float(share.mean()), float(share.std() / np.sqrt(len(share)))
    return Outcome(
        judge(holds=once > SMALL and abs(drawn_area - once) < 4 * error),
        "A position shows both colours exactly where one of its two postures is allowed:"
        f" {once:.2f} cm² of the {workspace().area:.2f} cm² that the tool reaches, without"
        f" sampling. The draw gives {drawn_area:.0f} cm², with a standard error of {error:.0f}.",
    )
