"""The tool: Figures 7 to 11, traversals, singular poses, sampling, and the outlook."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import permutations, product
from typing import Final

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.computations.region import PICTURE
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.computations.theorem_2 import interval
from lizarraga2025.evidence import effort
from lizarraga2025.evidence import joint_region as region
from lizarraga2025.evidence import tool_paths as tool
from lizarraga2025.evidence.arms import corrected, floor, robot, rounded, symmetric, tool_form
from lizarraga2025.evidence.joint_region import by_windows, scaled
from lizarraga2025.evidence.proofs import general, vanishes
from lizarraga2025.evidence.rounding import SMALL, counted, degrees
from lizarraga2025.readings import in_windows
from lizarraga2025.verdicts import Outcome, Verdict, judge, of_readings, reading, undetermined
from qbound import Robot, polygon, position, sample
from qbound.circle import TURN
from qbound.workspace import PLANE

# --- which points, in which order: Figures 6 to 9 -------------------------------------------------

ROUNDS: Final = {
    f"{start + 1}{'+' if sense > 0 else '-'}{' and back' if back else ''}": tuple(
        (start + sense * i) % 6 for i in range(6 + back)
    )
    for start in range(6)
    for sense in (1, -1)
    for back in (0, 1)
}
"""The 24 walks round the six points: from each, in both directions, open or back to the start."""

Walks = Mapping[str, tuple[int, ...]]


def _stated(figure: int, walks: Walks) -> Walks:
    """Return the walks that agree with the order that the text gives: all, where it gives none."""
    order = paper.ORDERS[figure]
    points = None if order is None else tuple(number - 1 for number in order)
    return {name: walk for name, walk in walks.items() if points in (None, walk)}


def _fives() -> Walks:
    """Return the simple walks through five points, each in both directions."""
    return {str(order): order for o in tool.simple_sequences() for order in (o, o[::-1])}


def _end(order: tuple[int, ...]) -> float:
    """Return where the tool is at the end of a walk, cm to the right of the base."""
    return float(tool.path_through(order).tool[-1, 0])


@computes("F-6.5")
def which_order_of_the_six_points() -> Outcome:
    closed = {name: walk for name, walk in ROUNDS.items() if walk[0] == walk[-1]}
    fits = {
        name: bool(by_windows().contains(tool.path_through(walk).q).all())
        for name, walk in _stated(6, closed).items()
    }
    return Outcome(
        undetermined(fits),
        f"The text names neither start nor direction. The {sum(fits.values())} closed walks along"
        f" the region's edges all stay feasible at scale {SCALE}. {PICTURE}",
    )


@computes("F-7.1", "S-29")
def tool_path_of_the_six_points() -> Outcome:
    """Judge the walks, one for all that draw the same curve: a reverse, another start of a loop."""
    scales = (1.0, SCALE, 0.8)
    curves = [tool.AROUND if w[0] == w[-1] else min(w, w[::-1]) for w in ROUNDS.values()]
    counts = {
        curve: [tool.crossings(tool.path_through(curve, s)) for s in scales]
        for curve in sorted({*curves})
    }
    plain = ["-".join(str(i + 1) for i in curve) for curve, n in counts.items() if min(n) == 0]
    crossed = sum(min(counts[curve]) > 0 for curve in curves)
    return Outcome(
        judge(holds=crossed > 0),
        f"Of {len(ROUNDS)} walks round the region {crossed} give a path of the tool that crosses"
        f" itself at each of the scales {', '.join(f'{s:g}' for s in scales)}. All closed walks do,"
        f" in {counted(min(counts[tool.AROUND]), 'place')}. Of the open ones only"
        f" {' and '.join(plain) or 'none'} do not cross, in either direction.",
    )


@computes_each({"F-7.2": 7, "F-8.3": 8})
def final_pose(figure: int) -> Outcome:
    walks = _stated(figure, ROUNDS if figure == 7 else _fives())
    kinds = {tuple(np.round(tool.path_through(walk).q[-1], 9)) for walk in walks.values()}
    what = "walks round the six points" if figure == 7 else "orders of five points"
    return Outcome(
        undetermined({str(pose): True for pose in kinds}),
        f"The text states neither start nor direction: {len(walks)} {what} fit, with {len(kinds)}"
        f" different final poses. {PICTURE}",
    )


@computes("F-8.1")
def which_five_points() -> Outcome:
    fits = _stated(8, {str(order): order for order in tool.simple_sequences()})
    both = _fives().values()
    pairs = [o for o in both if tool.opposite(o) in both and _end(o) > 0 > _end(tool.opposite(o))]
    return Outcome(
        undetermined(dict.fromkeys(fits, True)),
        "The text does not name the points. Of 360 orders of five of the six (a walk and its"
        f" reverse counted once) {len(fits)} give a path of the tool that does not cross itself;"
        f" of the {len(tool.neighbour_sequences())} walks through five neighbours, in either"
        f" direction, {len(tool.simple_neighbours())}. Those that end on the right, with an"
        f" opposite for Figure 9 that ends on the left, are {len(pairs)}, counted in both"
        f" directions. {PICTURE}",
    )


@computes("F-8.2")
def five_points_stay_open() -> Outcome:
    places = tool_form()(np.array([scaled(1.0), scaled(SCALE), scaled(0.8)]))[..., PLANE]
    apart = np.linalg.norm(places[:, :, None] - places[:, None], axis=-1)
    points = places.shape[1]
    least = float(apart[:, ~np.eye(points, dtype=bool)].min())
    number = len(list(permutations(range(points), 5)))
    return Outcome(
        judge(holds=number > 0 and least > SMALL),
        f"All {number} sequences: five different points have first and last places of the tool at"
        f" least {least:.4f} cm apart, at scales 1, {SCALE} and 0.8.",
    )


@computes("F-9")
def a_second_sequence() -> Outcome:
    orders = [
        tuple(number - 1 for number in paper.ORDERS[figure] or ()) or ours
        for figure, ours in ((8, RIGHT), (9, LEFT))
    ]
    paths = [tool.path_through(order) for order in orders]
    feasible = all(by_windows().contains(path.q).all() for path in paths)
    right, left = map(_end, orders)
    return Outcome(
        judge(holds=feasible and not any(map(tool.crossings, paths))),
        f"3-4-5-6-1 and 6-1-2-3-4 both stay feasible at scale {SCALE} and do not cross themselves;"
        f" the tool ends at x = {left:.4f} cm and at x = {right:.4f} cm.",
    )


@computes("F-9.1")
def opposite_paths() -> Outcome:
    first, second = (_stated(figure, _fives()).values() for figure in (8, 9))
    opposites = [o for o in first if tool.opposite(o) in second]
    return Outcome(
        judge(holds=len(opposites) == len(first) > 0, under=bool(opposites)),
        f"The text names no points. Of {len(first)} orders for Figure 8, counted in both"
        f" directions, that do not cross themselves, {len(opposites)} have an opposite that does"
        " not either.",
    )


@computes("S-33")
def two_ways() -> Outcome:
    sides = [float(np.sign(_end(order))) for order in (RIGHT, LEFT)]
    ordered = all(
        tool.is_feasible(o) and not tool.crossings(tool.path_through(o)) for o in (RIGHT, LEFT)
    )
    number = len(tool.simple_sequences())
    return of_readings(
        "The paths 6-1-2-3-4, which ends on the right, and 3-4-5-6-1, which ends on the left, are"
        f" feasible at scale {SCALE:g} and do not cross themselves. They are two of {number} orders"
        " of five points that do not.",
        reading("there being one on either side", holds=ordered and sides == [1, -1]),
        reading("there being these two and no more", holds=number == 2),
    )


# --- Figure 10: two paths laid over each other ----------------------------------------------------


@computes("F-10.1")
def the_regions_are_not_symmetric() -> Outcome:
    printed, one_digit, of_rounding = (
        tool.asymmetry(of, SCALE) for of in (robot(), corrected(), rounded(symmetric()))
    )
    return Outcome(
        judge(holds=one_digit > of_rounding + SMALL, under=printed > of_rounding + SMALL),
        "The mirrored right path of the book's pair and the left one are up to"
        f" {printed:.4f} cm apart, and {one_digit:.4f} cm with x_{{2,13}} = 9.09, no more than the"
        f" {of_rounding:.4f} cm of the exactly symmetric arm with rounded offsets.",
    )


SCALES: Final = (1.0, SCALE, 0.8)


@computes("F-10.2")
def asymmetry_from_scaling() -> Outcome:
    printed, exact = ([tool.asymmetry(of, s) for s in SCALES] for of in (robot(), symmetric()))
    brought_in = any(one[0] < SMALL < max(one) for one in (printed, exact))
    about_it = tool.asymmetry_about_the_middle()
    return of_readings(
        f"Unscaled, the paths are {printed[0]:.4f} cm apart, at scale {SCALE} {printed[1]:.4f} cm:"
        " scaling changes the asymmetry and does not bring it in. About the pose that is its own"
        f" mirror image in place of the centroid they would be {about_it:.3f} cm apart. On the"
        f" exactly symmetric arm they are {max(exact):.3f} cm apart at most.",
        reading("the scaling brings it in", holds=brought_in),
        reading(
            "its centre, the centroid, adds to it", holds=False, under=printed[1] > about_it + SMALL
        ),
    )


@computes("F-10.3")
def asymmetry_from_nonlinearity() -> Outcome:
    path, places = tool.path_through(RIGHT, SCALE, symmetric()), scaled(SCALE, symmetric())
    bend = polygon.hausdorff(path.tool, path.tool[path.stops])
    of_joints = tool.spread_of_middles(places)
    of_tool = tool.spread_of_middles(position(symmetric())(places))
    return Outcome(
        judge(holds=tool.asymmetry(symmetric(), SCALE) > SMALL),
        "The exactly symmetric arm is as nonlinear: its paths bend away from their chords by up to"
        f" {bend:.2f} cm. Yet its two paths are mirror images. What the nonlinearity does break is"
        " another symmetry: its joint paths are point reflections of each other, with the middles"
        f" of opposite points {round(of_joints, 9):.2g} rad apart, and the middles of the tool's"
        f" opposite places are {of_tool:.2f} cm apart.",
    )


@computes("S-36.2", "S-55")
def causes_of_asymmetry() -> Outcome:
    exact, printed = ({s: tool.asymmetry(of, s) for s in SCALES} for of in (symmetric(), robot()))
    nonlinearity, scaling = exact[1.0] > SMALL, max(exact.values()) > SMALL
    about_it = tool.asymmetry_about_the_middle()
    text = "; ".join(f"{s:g}: {off:.3f}" for s, off in printed.items())
    return of_readings(
        "The symmetric arm is scaled and as nonlinear, and its two paths, one mirrored, are"
        f" {max(exact.values()):.3f} cm apart at most; those of the printed arm, by scale, {text}"
        f" cm. About the pose that is its own mirror image these would be {about_it:.3f} cm apart"
        f" at scale {SCALE:g}, so the centre adds {100 * (printed[SCALE] / about_it - 1):.0f} %.",
        reading(
            "no mirror images, by either",
            holds=nonlinearity and scaling,
            under=nonlinearity or scaling,
        ),
        reading(
            "no mirror images, but without scaling they would be",
            holds=printed[1.0] < SMALL < printed[SCALE],
        ),
        reading("less of mirror images by the scaling", holds=printed[SCALE] > printed[1.0]),
        reading(
            "less of mirror images about the centroid than about the centre of symmetry",
            holds=False,
            under=printed[SCALE] > about_it + SMALL,
        ),
    )


# --- reach and final pose -------------------------------------------------------------------------


@computes("S-4", "S-34", "S-54")
def strong_dependence() -> Outcome:
    ends = np.array([tool.path_through(o).q[-1] for o in tool.neighbour_sequences()])
    final = np.array([tool.reach(o)[-1] for o in tool.neighbour_sequences()])
    spread = np.degrees(np.ptp(ends, axis=0))
    return Outcome(
        judge(holds=bool(spread.min() > 90 and np.ptp(final) / final.max() > 0.2)),
        f"At scale {SCALE:g}, over the {len(final)} sequences of neighbours, the final joint values"
        f" spread over {spread[0]:.2f}° and {spread[1]:.2f}° and the final reach from"
        f" {final.min():.4f} to {final.max():.4f} cm.",
    )


@computes("S-35")
def choice_decides_the_reach() -> Outcome:
    arms = robot(), corrected(), rounded(symmetric()), symmetric()
    final = [[float(tool.reach(o, of)[-1]) for o in (RIGHT, LEFT)] for of in arms]
    printed, one_digit, of_rounding, _ = (abs(right - left) for right, left in final)
    largest = [float(tool.reach(o).max()) for o in (RIGHT, LEFT)]
    right, left = (tool.path_through(o).tool for o in (RIGHT, LEFT))
    apart = polygon.hausdorff(right, left)
    return of_readings(
        f"The tool's paths on the right and on the left are up to {apart:.1f} cm apart. The"
        f" distance in the final pose is, at scale {SCALE:g}, {final[0][0]:.4f} cm on the right and"
        f" {final[0][1]:.4f} cm on the left, {final[1][0]:.4f} and {final[1][1]:.4f} cm with"
        " x_{2,13} = 9.09 (T-4.2). Rounding the offsets of the exactly symmetric arm, whose reach"
        f" is {final[3][0]:.4f} cm on both sides, causes the same difference. The largest reach on"
        f" the way is {largest[0]:.4f} cm on either.",
        reading(
            "the reach in the final pose",
            holds=one_digit > of_rounding + SMALL,
            under=printed > of_rounding + SMALL,
        ),
        reading("which places are reached", holds=apart > 1),
        reading("the largest reach on the way", holds=bool(np.ptp(largest) > 0.01)),
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


@computes("S-53")
def structured_paths_come_from_scaling() -> Outcome:
    number = {s: len(tool.structured_neighbours(s)) for s in (1.0, 0.97, 0.96, 0.95)}
    text = "; ".join(f"{s:g}: {len(tool.feasible_neighbours(s))} and {number[s]}" for s in number)
    return Outcome(
        judge(
            holds=number[1.0] == 0 < number[0.97],
            under=number[1.0] == 0 < min(number[0.96], number[0.95]),
        ),
        f"Of {len(tool.neighbour_sequences())} sequences of neighbours, by scale, those that are"
        f" feasible, and of these those that do not cross themselves: {text}.",
    )


# --- singular poses -------------------------------------------------------------------------------


@computes("S-30")
def greatest_reach() -> Outcome:
    q2 = np.linspace(-np.pi, np.pi, 7201)
    places = tool_form()(np.stack([0 * q2, q2], -1)) - robot().joints[0].origin
    distances = np.linalg.norm(places, axis=-1)
    best, at = float(distances.max()), float(q2[distances.argmax()])
    links = np.linalg.norm(robot().joints[1].origin) + np.linalg.norm(robot().point("3").at)
    return Outcome(
        judge(holds=bool(abs(at - tool.stretched()) < 1e-3 and abs(best - links) < 1e-6)),
        f"The distance of the tool from joint 1 is greatest at q2 = {degrees(tool.stretched())},"
        f" where it is {links:.4f} cm, the sum of both links.",
    )


@computes("S-31")
def stretched_is_singular() -> Outcome:
    q = np.array([[0.3, tool.stretched()], [-1.0, tool.stretched()], [0.3, tool.stretched() + 0.1]])
    det = tool.det_jacobian(q)
    return Outcome(
        judge(holds=bool(np.abs(det[:2]).max() < SMALL < abs(det[2]))),
        f"det J vanishes on the line q2 = {degrees(tool.stretched())}, for every q1, and is"
        f" {det[2]:.2f} cm² a tenth of a radian beside it.",
    )


@computes("S-10.1")
def singular_poses_are_avoided() -> Outcome:
    least = tool.scale_without_singular_poses()
    used = [tool.is_cut_by_the_singular_line(scaled(s)) for s in (0.96, 0.95, 0.9)]
    return Outcome(
        judge(holds=least >= 1, under=not any(used)),
        f"The singular line q2 = {degrees(tool.stretched())} passes close to the centroid, at q2 ="
        f" {degrees(polygon.centroid(region.vertices())[1])}: a region scaled about it leaves the"
        f" line outside only below scale {least:.6f}.",
    )


@computes("S-2", "S-32")
def scaling_settles_the_stretched_pose() -> Outcome:
    least, feasible = (
        _heights_of_the_pass(),
        {s: len(tool.feasible_neighbours(s)) for s in (1.0, SCALE)},
    )
    passing = [
        tool.is_cut_by_the_singular_line(tool.path_through(o).q) for o in tool.neighbour_sequences()
    ]
    return of_readings(
        "Where the outline of the six points passes the stretched pose, the tool's height above"
        f" its limit is {least[1.0]:.4f} cm at the least; at scale {SCALE:g} it is"
        f" {least[SCALE]:.4f} cm, and {feasible[SCALE]} of {len(passing)} sequences of five"
        f" neighbours are feasible, unscaled {feasible[1.0]}; the limit is scale"
        f" {region.largest_scale().scale:.6f}. {sum(passing)} of them pass the stretched pose.",
        reading("a path that keeps off the stretched pose", holds=not all(passing)),
        ("a path in joint space that passes it with every bound kept", pass_keeps_bounds()),
    )


def pass_keeps_bounds() -> Verdict:
    """Judge whether scaling makes a path feasible where it passes the stretched pose."""
    least = _heights_of_the_pass()
    return judge(
        holds=least[1.0] < 0 < least[0.99] and bool(tool.feasible_neighbours(0.99)),
        under=least[1.0] < 0 < least[SCALE] and bool(tool.feasible_neighbours(SCALE)),
    )


def _heights_of_the_pass() -> dict[float, float]:
    """Return the least height, cm, of the tool where the outline passes the stretched pose."""
    scales = (1.0, 0.99, SCALE)
    return {s: float(floor()(tool.stretched_poses(s)).min(initial=np.inf)) for s in scales}


@computes("S-52")
def scaling_resolves_singularities() -> Outcome:
    scales = (0.96, 0.95, 0.9)
    inside = [tool.is_cut_by_the_singular_line(scaled(s)) for s in scales]
    passing = [
        tool.is_cut_by_the_singular_line(tool.path_through(o, s).q)
        for s in scales
        for o in tool.neighbour_sequences()
    ]
    least = {s: float(np.abs(tool.det_jacobian(scaled(s))).min()) for s in (1.0, *scales)}
    return of_readings(
        "The region keeps its singular poses at every scale above"
        f" {tool.scale_without_singular_poses():.6f}, and {sum(passing) // len(scales)} of"
        f" {len(tool.neighbour_sequences())} sequences of neighbours pass one. The least |det J|"
        f" of the six points is {least[1.0]:.2f} cm² unscaled and {least[0.95]:.2f} cm² at scale"
        " 0.95.",
        reading("paths that meet none", holds=not any(passing)),
        ("a path that passes the pose with every bound kept (S-32)", pass_keeps_bounds()),
        reading("a region without singular poses", holds=not any(inside)),
        reading("points farther from them", holds=min(least.values()) == least[1.0]),
    )


# --- sampling and numerical methods ---------------------------------------------------------------


@computes("F-11.5")
def how_many_samples_over_which_range() -> Outcome:
    box = by_windows().box
    turn = np.full((2, 2), np.pi) * [[-1], [1]]
    ranges = {"one turn": turn, "the box of Table 6": np.array([box.lower, box.upper])}
    part = (region.drawn().q + np.pi) / TURN
    fits = {}
    for number, (name, (low, high)) in product((1_000, 10_000, 100_000), ranges.items()):
        if paper.SAMPLES["number"] in (None, number) and paper.SAMPLES["range"] in (None, name):
            free = by_windows().contains(low + part[:number] * (high - low))
            fits[f"{number} over {name}"] = bool(free.any() and not free.all())
    return Outcome(
        undetermined(fits),
        "The text draws n configurations and gives neither n nor the range of each joint. All"
        f" {sum(fits.values())} choices tried show both colours: {', '.join(fits)}. {PICTURE}",
    )


@computes("S-37")
def figure_10_for_11() -> Outcome:
    number, words = paper.ON_NUMERICAL_METHODS
    said = {
        figure: sum(word in caption.lower() for word in words)
        for figure, caption in paper.CAPTIONS_AS_PRINTED.items()
    }
    whole = [figure for figure, found in said.items() if found == len(words)]
    return Outcome(
        judge(holds=whole == [number], corrected=len(whole) == 1 and not said[number]),
        f"Of the words {', '.join(words)}, by which the text says what is seen, the caption of"
        f" Figure {number} has {said[number]} and that of Figure {', '.join(map(str, whole))} all"
        f" {len(words)}. The next paragraph names Figure 11 for the experiment.",
    )


def _against_draws(digits: tuple[int, ...]) -> tuple[float, str]:
    """Compare random draws with roots by Theorem 2 restated, at equal accuracy of the area.

    Returns the least ratio of both, and the numbers in words.
    """
    needed = {
        k: (effort.samples_needed(10.0**-k), effort.closed_form_evaluations(10.0**-k))
        for k in digits
    }
    text = "; ".join(
        f"1e-{k}: {drawn:.3g} against {solved}" for k, (drawn, solved) in needed.items()
    )
    return min(drawn / solved for drawn, solved in needed.values()), text


@computes("S-38")
def sampling_is_costly() -> Outcome:
    ratio, text = _against_draws((2, 3, 6))
    return Outcome(
        judge(holds=ratio > 100),
        "At equal accuracy, configurations judged against roots by Theorem 2 restated (TH-2), for"
        f" a relative error of the area of {text}. At the accuracy of a picture the cost is no"
        " obstacle.",
    )


@computes("S-7")
def accuracy_and_effort() -> Outcome:
    ratio, text = _against_draws((3, 6, 9))
    return of_readings(
        f"As in S-38, for a relative error of {text}. Eq. (31) as printed bounds no area.",
        reading(
            "done with eq. (38) and atan2, or Theorem 2 restated", holds=False, under=ratio > 1
        ),
        reading("done with Theorem 2 as printed", holds=interval(31).excludes),
    )


@computes("S-7.2")
def lack_of_precision() -> Outcome:
    part = region.share_of_square()
    closed = {k: effort.closed_form_evaluations(10.0**-k) for k in (3, 9)}
    drawn = {k: np.sqrt(max(0.0, 1 - part) / part / n) for k, n in closed.items()}
    text = " and ".join(f"{closed[k]} draws err by {100 * drawn[k]:.0f} %" for k in closed)
    return Outcome(
        judge(holds=False, under=all(error > 10.0**-k for k, error in drawn.items())),
        f"At equal numbers of evaluations: for the area of the joint region {text} (standard error"
        " of random sampling), where the closed form has three and nine digits. More draws give any"
        " precision that is asked for (S-38).",
    )


GENERAL, RANDOM = "numerical methods in general", "the random draws that the paper evaluates"


@computes_each({"S-6": GENERAL, "S-8.1": GENERAL, "S-39": RANDOM})
def no_continuous_boundary(likeliest: str) -> Outcome:
    grids = (50, 100, 200, 400)
    errors = {n: effort.contour_error(n) for n in grids if effort.contour_is_closed(n)}
    text = "; ".join(f"{n * n}: {e:.2g}" for n, e in errors.items())
    of_draws = region.distance_of_the_draw() > 0
    readings = [
        reading(GENERAL, holds=len(errors) < len(grids), under=of_draws),
        reading(RANDOM, holds=of_draws),
    ]
    return of_readings(
        "The same test on a grid gives one closed contour by marching squares; relative error of"
        f" its area by evaluations: {text}. Random draws by themselves give none: none of"
        f" {len(region.drawn().q)} lies on the boundary, as is to be expected of any draw.",
        *sorted(readings, key=lambda one: one[0] != likeliest),
    )


@computes("S-40")
def efficiency_and_volume() -> Outcome:
    part = region.share_of_square()
    sizes = np.array([100, 1000, 10_000])
    free = [[sample(robot(), n, in_windows, seed=s).fraction for s in range(40)] for n in sizes]
    errors = np.sqrt(np.mean((np.array(free) / part - 1) ** 2, axis=1))
    law = np.sqrt(max(0.0, 1 - part) / part / sizes)
    text = "; ".join(f"{n}: {e:.1g}" for n, e in zip(sizes, errors, strict=True))
    return Outcome(
        judge(holds=part < 1 and bool((np.abs(errors / law - 1) < 0.5).all())),
        "The relative error of the area falls as the square root of the number of samples"
        f" (root mean square of 40 draws, by samples: {text}).",
    )


@computes("S-41")
def overlap_comes_from_postures() -> Outcome:
    once, draw = tool.workspace().area - tool.workspace().covered_twice, region.drawn()
    alone = ~by_windows().contains(tool.arm().other_posture(draw.q)) & draw.allowed
    share = np.abs(tool.det_jacobian(draw.q)) * alone * TURN**2
    drawn_area, error = float(share.mean()), float(share.std() / np.sqrt(len(share)))
    return Outcome(
        judge(holds=once > SMALL and abs(drawn_area - once) < 4 * error),
        "A position shows both colours exactly where one of its two postures is allowed:"
        f" {once:.2f} cm² of the {tool.workspace().area:.2f} cm² that the tool reaches, without"
        f" sampling. The draw gives {drawn_area:.0f} cm², with a standard error of {error:.0f}.",
    )


# --- outlook --------------------------------------------------------------------------------------


@computes("S-56")
def spatial_manipulators() -> Outcome:
    g = general()
    seen = vanishes(g.chain.position("a+n", "b+m", "0") - g.R_0a @ g.B)
    first = replace(robot().joints[0], axis=np.array([0.0, 0.0, 1.0]))
    spatial: Robot = replace(robot(), joints=(first, robot().joints[1]))
    q = np.radians(np.stack(np.meshgrid(*[np.arange(-180, 180, 10)] * 2), axis=-1))
    leaves = float(np.abs(position(spatial, "3")(q)[..., 1]).max())
    return Outcome(
        judge(holds=seen and leaves > 1),
        "Eq. (16) is an identity in two general rotations of space. With the first joint of the arm"
        f" turned about z, for example, the tool leaves its plane by {leaves:.0f} cm.",
    )
