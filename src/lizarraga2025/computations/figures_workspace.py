"""Captions of Figures 7 to 11: paths of the tool, and sampling."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import permutations, product
from typing import Final

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.computations.figures_region import PICTURE
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence.arms import (
    corrected,
    robot,
    rounded,
    symmetric,
    tool_form,
)
from lizarraga2025.evidence.joint_region import (
    by_windows,
    drawn,
    scaled,
)
from lizarraga2025.evidence.rounding import SMALL, counted
from lizarraga2025.evidence.tool_paths import (
    AROUND,
    asymmetry,
    asymmetry_about_the_middle,
    crossings,
    neighbour_sequences,
    opposite,
    path_through,
    simple_neighbours,
    simple_sequences,
    spread_of_middles,
)
from lizarraga2025.verdicts import Outcome, judge, of_readings, undetermined
from qbound import Robot, polygon, position
from qbound.circle import TURN
from qbound.traversal import Traversal
from qbound.workspace import PLANE

ROUNDS: Final = {
    f"{start + 1}{'+' if sense > 0 else '-'}{' and back' if back else ''}": tuple(
        (start + sense * i) % 6 for i in range(6 + back)
    )
    for start in range(6)
    for sense in (1, -1)
    for back in (0, 1)
}
"""The 24 walks round the six points: from each, in both directions, open or back to the start."""


def _stated(figure: int, walks: Mapping[str, tuple[int, ...]]) -> dict[str, tuple[int, ...]]:
    """Return the walks that agree with the order that the text gives: all, where it gives none."""
    order = paper.ORDERS[figure]
    points = None if order is None else tuple(number - 1 for number in order)
    return {name: walk for name, walk in walks.items() if points in (None, walk)}


@computes("F-6.5")
def which_order_of_the_six_points() -> Outcome:
    closed = {name: walk for name, walk in ROUNDS.items() if walk[0] == walk[-1]}
    fits = {
        name: bool(by_windows().contains(path_through(walk).q).all())
        for name, walk in _stated(6, closed).items()
    }
    return Outcome(
        undetermined(fits),
        f"The text names neither start nor direction. The {sum(fits.values())} closed walks along"
        f" the region's edges all stay feasible at scale {SCALE}. {PICTURE}",
    )


@computes("F-7.1")
@computes("S-29")
def tool_path_of_the_six_points() -> Outcome:
    scales = (1.0, SCALE, 0.8)
    counts = {
        curve: [crossings(path_through(curve, s)) for s in scales] for curve in sorted(_curves())
    }
    plain = ["-".join(str(i + 1) for i in curve) for curve, n in counts.items() if min(n) == 0]
    crossed = sum(min(counts[_curve(walk)]) > 0 for walk in ROUNDS.values())
    return Outcome(
        judge(holds=crossed > 0),
        f"Of {len(ROUNDS)} walks round the region {crossed} give a path of the tool that crosses"
        f" itself at each of the scales {', '.join(f'{s:g}' for s in scales)}. All closed walks do,"
        f" in {counted(min(counts[AROUND]), 'place')}. Of the open ones only"
        f" {' and '.join(plain) or 'none'} do not cross, in either direction.",
    )


def _curve(walk: tuple[int, ...]) -> tuple[int, ...]:
    """Return one walk for all that draw the same curve: its reverse, another start of a loop."""
    return AROUND if walk[0] == walk[-1] else min(walk, walk[::-1])


def _curves() -> set[tuple[int, ...]]:
    return {_curve(walk) for walk in ROUNDS.values()}


@computes_each({"F-7.2": 7, "F-8.3": 8})
def final_pose(figure: int) -> Outcome:
    fives = {str(order): order for o in simple_sequences() for order in (o, o[::-1])}
    walks = _stated(figure, ROUNDS if figure == 7 else fives)
    kinds = {tuple(np.round(path_through(walk).q[-1], 9)) for walk in walks.values()}
    opposites = sum(opposite(order) in fives.values() for order in fives.values())
    paired = "" if figure == 7 else f" {opposites} of them with an opposite as in Figure 9,"
    what = "walks round the six points" if figure == 7 else "orders of five points"
    return Outcome(
        undetermined({str(pose): True for pose in kinds}),
        f"The text states neither start nor direction: {len(walks)} {what} fit,{paired} with"
        f" {len(kinds)} different final poses. {PICTURE}",
    )


@computes("F-8.1")
def which_five_points() -> Outcome:
    orders = {"-".join(str(i + 1) for i in order): order for order in simple_sequences()}
    fits = dict.fromkeys(_stated(8, orders), True)
    neighbours = len(simple_neighbours())
    both_ways = [order for o in orders.values() for order in (o, o[::-1])]
    pairs = [o for o in both_ways if opposite(o) in both_ways and _end(o) > 0 > _end(opposite(o))]
    return Outcome(
        undetermined(fits),
        f"The text does not name the points. Of 360 orders of five of the six (a walk and its"
        f" reverse counted once) {len(fits)} give a path of the tool that does not cross itself; of"
        f" the {len(neighbour_sequences())} walks through five neighbours, in either direction,"
        f" {neighbours}. Those that end on the right, with an opposite for Figure 9 that ends on"
        f" the left, are {len(pairs)}, counted in both directions. {PICTURE}",
    )


def _end(order: tuple[int, ...]) -> float:
    """Return where the tool is at the end of a walk, cm to the right of the base."""
    return float(path_through(order).tool[-1, 0])


@computes("F-8.2")
def five_points_stay_open() -> Outcome:
    corners = np.array([scaled(1.0), scaled(SCALE), scaled(0.8)])
    places = tool_form()(corners)[..., PLANE]
    apart = np.linalg.norm(places[:, :, None] - places[:, None], axis=-1)
    points = corners.shape[1]
    least = float(apart[:, ~np.eye(points, dtype=bool)].min())
    number = len(list(permutations(range(points), 5)))
    return Outcome(
        judge(holds=number > 0 and least > SMALL),
        f"All {number} sequences: five different points have first and last places of the tool at"
        f" least {least:.4f} cm apart, at scales 1, {SCALE} and 0.8.",
    )


def _shown(figure: int, ours: tuple[int, ...]) -> Traversal:
    """Return the path of five points that a figure shows: the book's, where the text names none."""
    order = paper.ORDERS[figure]
    return path_through(ours if order is None else [number - 1 for number in order])


@computes("F-9")
def a_second_sequence() -> Outcome:
    paths = right, left = _shown(8, RIGHT), _shown(9, LEFT)
    feasible = all(by_windows().contains(path.q).all() for path in paths)
    ordered = crossings(right) == crossings(left) == 0
    ends = [float(path.tool[-1, 0]) for path in paths]
    return Outcome(
        judge(holds=feasible and ordered),
        f"3-4-5-6-1 and 6-1-2-3-4 both stay feasible at scale {SCALE} and do not cross themselves;"
        f" the tool ends at x = {ends[1]:.4f} cm and at x = {ends[0]:.4f} cm.",
    )


@computes("F-9.1")
def opposite_paths() -> Outcome:
    orders = {str(order): order for o in simple_sequences() for order in (o, o[::-1])}
    first, second = (_stated(figure, orders).values() for figure in (8, 9))
    opposites = [o for o in first if opposite(o) in second]
    ends = [_end(order) for order in (RIGHT, LEFT)]
    return Outcome(
        judge(holds=len(opposites) == len(first) > 0, under=bool(opposites)),
        f"The text names no points (F-8.1). Of {len(first)} orders for Figure 8, counted in both"
        f" directions, that do not cross themselves, {len(opposites)} have an opposite that does"
        " not either: each point is the one across the hexagon. The book chooses such a pair,"
        f" 6-1-2-3-4 and 3-4-5-6-1, with the tool at x = {ends[0]:.4f} and {ends[1]:.4f} cm at the"
        " end.",
    )


@computes("F-10.1")
def the_regions_are_not_symmetric() -> Outcome:
    printed, one_digit, of_rounding = (
        asymmetry(arm, SCALE) for arm in (robot(), corrected(), rounded(symmetric()))
    )
    return Outcome(
        judge(holds=one_digit > of_rounding + SMALL, under=printed > of_rounding + SMALL),
        f"The mirrored right path of the book's pair and the left one are up to {printed:.4f} cm"
        " apart with the"
        f" printed x_{{2,13}} = 9.00, {one_digit:.4f} cm with 9.09 (T-4.2). As far apart,"
        f" {of_rounding:.4f} cm, are those of the exactly symmetric arm with its offsets rounded to"
        " hundredths.",
    )


SCALES: Final = (1.0, SCALE, 0.8)


@computes("F-10.2")
def asymmetry_from_scaling() -> Outcome:
    printed, exact = ([asymmetry(arm, s) for s in SCALES] for arm in (robot(), symmetric()))
    brought_in = any(one[0] < SMALL < max(one) for one in (printed, exact))
    about_it = asymmetry_about_the_middle()
    return of_readings(
        "the scaling brings it in",
        {
            "the scaling brings it in": judge(holds=brought_in),
            "the centroid as its centre adds to it": judge(
                holds=False, under=printed[1] > about_it + SMALL
            ),
        },
        f"Unscaled, the paths are {printed[0]:.4f} cm apart, at scale {SCALE} {printed[1]:.4f} cm:"
        " scaling changes the asymmetry and does not bring it in. About the pose that is its own"
        f" mirror image in place of the centroid they would be {about_it:.3f} cm apart. On"
        " the exactly symmetric arm they are mirror images at scales"
        f" {', '.join(f'{s:g}' for s in SCALES)}. The caption names two"
        " causes; the other one, the nonlinearity, is F-10.3.",
    )


@computes("F-10.3")
def asymmetry_from_nonlinearity() -> Outcome:
    exact, spreads = asymmetry(symmetric(), SCALE), spreads_of_middles(SCALE)
    bends = [_bend(arm) for arm in (robot(), symmetric())]
    return Outcome(
        judge(holds=exact > SMALL),
        f"The exactly symmetric arm is as nonlinear: its paths bend away from their chords by up to"
        f" {bends[1]:.2f} cm, those of the printed arm by {bends[0]:.2f} cm. Yet its two paths are"
        " mirror images. What the nonlinearity does break is another symmetry, which nobody looks"
        " for in an overlay of a right and a left region: its joint paths are point reflections of"
        f" each other, with the middles of opposite points {spreads['joints']:.2g} rad apart, and"
        f" the middles of the tool's opposite places are {spreads['tool']:.2f} cm apart.",
    )


def spreads_of_middles(factor: float) -> dict[str, float]:
    """Return how far the middles of opposite points of the symmetric arm are apart, rad and cm.

    Of its joint values, and of the tool's places.
    """
    q = scaled(factor, symmetric())
    return {
        "joints": round(spread_of_middles(q), 9),
        "tool": spread_of_middles(position(symmetric())(q)),
    }


def _bend(arm: Robot) -> float:
    """Return how far the tool's path on the right is from the straight lines between its stops."""
    path = path_through(RIGHT, SCALE, arm)
    return polygon.hausdorff(path.tool, path.tool[path.stops])


@computes("F-11.5")
def how_many_samples_over_which_range() -> Outcome:
    box = by_windows().box
    turn = np.full((2, 2), np.pi) * [[-1], [1]]
    ranges = {"one turn": turn, "the box of Table 6": np.array([box.lower, box.upper])}
    part = (drawn().q + np.pi) / TURN
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
