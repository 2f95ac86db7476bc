"""Captions of Figures 1 to 6: labels, the chain, the joint region and its scaling."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from itertools import pairwise
from typing import Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import floor, pairs, robot, symbolic_robot
from lizarraga2025.evidence.joint_region import (
    X_IN_CM,
    areas_by_walls,
    by_windows,
    depth_below_edges,
    edges,
    in_base_box,
    largest_scale,
    vertices,
    within_the_windows,
)
from lizarraga2025.evidence.rounding import SMALL, degrees
from lizarraga2025.uncertainty import drawn_arms
from lizarraga2025.verdicts import Outcome, judge, of_readings, undetermined
from qbound import Pair, pair_vector, polygon, scaling
from qbound.arrays import Floats
from qbound.circle import TURN
from qbound.symbols import joint_symbols
from qbound.windows import Box, window_box

PICTURE: Final = "The picture, which was not at hand, may show it."


@computes("F-1")
def labels_close_a_triangle() -> Outcome:
    frames = symbolic_robot()[0].frames(joint_symbols(robot()))

    def seen(a: str, b: str, observer: str) -> sp.Matrix:
        return sp.Matrix(frames.rotation(observer, a)) * sp.Matrix(frames.position(a, b, a))

    sums = {o: seen("0", "1", o) + seen("1", "2", o) - seen("0", "2", o) for o in "012"}
    fits = {o: sp.simplify(left) == sp.zeros(3, 1) for o, left in sums.items()}
    return Outcome(
        undetermined(fits),
        "Labels are enough to compute with: r_{0,1} and r_{1,2} add up to r_{0,2} by identity,"
        f" seen from any of the {sum(fits.values())} frames 0, 1 and 2. Which vectors, observers"
        f" and colours the picture has, the text does not say. {PICTURE}",
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


@computes("F-2.1")
def which_figure_is_isometric() -> Outcome:
    named, view = paper.NAMED_VIEW
    announce_it = [number for number, words in paper.CAPTIONS.items() if view in words]
    fits = {
        f"Figure {number}": number in announce_it if announce_it else True for number in (named, 3)
    }
    return Outcome(
        judge(holds=True) if announce_it == [named] else undetermined(fits),
        f"The text names Figure {named}. Captions that announce an {view} view: {len(announce_it)};"
        f" that of Figure {named} announces {paper.CAPTIONS[named]}, that of Figure 3"
        f" {paper.CAPTIONS[3]}. {' and '.join(fits)} could be meant; only the pictures can tell.",
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
    return {bound.label for bound in by_windows().bounds}


def _components(labels: Iterable[str]) -> set[tuple[int, ...]]:
    """Return the indices i and j, without the k that tells lower from upper."""
    return {paper.indices(label)[:2] for label in labels}


@computes("F-4.1")
def six_curves() -> Outcome:
    named, found = set(paper.FIGURE_4_BOUNDS), _edges()
    same = _components(named) == _components(found) and len(found) == len(named)
    with_arctan = sides_of_the_box("arctan")
    box = by_windows().box
    sides = np.concatenate([box.lower, box.upper])
    agree = sum(
        paper.indices(label)[0] > 4 or bool(np.isclose(_raised(label), sides).any())
        for label in named
    )
    return Outcome(
        judge(holds=same and with_arctan <= named, under=same),
        f"With the inverse tangent as atan2 the region has {len(found)} bounding curves, of the"
        f" components that the caption names; {len(named & found)} of the {len(named)} labels agree"
        f" to the last index (F-4.2), and {agree} with an arctangent to which 180° is added where a"
        " < 0, which is as right: only row 6 of Table 6 is then a turn off (T-6.6). With arctan"
        f" the sides would be {', '.join(paper.greek(label) for label in sorted(with_arctan))}.",
    )


def sides_of_the_box(reading: paper.Reading) -> set[str]:
    """Return the labels of the highest lower and the lowest upper bound of each joint."""
    found = set()
    for of_joint in ((1, 2), (3, 4)):
        values = {
            label: bound_of_a_pair(label, reading)
            for label in paper.TABLE_6
            if paper.indices(label)[0] in of_joint
        }
        upper, lower = ([n for n in values if paper.indices(n)[2] == k] for k in (1, 2))
        found |= {max(lower, key=values.__getitem__), min(upper, key=values.__getitem__)}
    return found


def bound_of_a_pair(label: str, reading: paper.Reading) -> float:
    """Return the value, rad, of a printed bound of a point pair."""
    printed = paper.expression(paper.TABLE_6[label], arctan=reading)
    return float(printed.subs(symbolic_robot()[1]))


def _raised(label: str) -> float:
    """Return a printed bound, rad, by an arctangent to which π is added where a < 0."""
    i, j, _ = paper.indices(label)
    component = pair_vector(robot(), pairs()[i - 1])[j - 1]
    (joint,) = component.joints()
    behind = component.along(joint, robot().home)[1] < 0
    return bound_of_a_pair(label, "arctan") + (np.pi if behind else 0.0)


@computes("F-4.2")
def the_index_of_one_bound() -> Outcome:
    (k,) = {paper.indices(label)[2] for label in paper.FIGURE_4_BOUNDS if "{3,3," in label}
    side = float(by_windows().box.upper[1])
    values = {k: bound_of_a_pair(f"beta_{{3,3,{k}}}", "atan2") for k in (1, 2)}
    raised = {k: _raised(f"beta_{{3,3,{k}}}") for k in (1, 2)}
    fits = {
        "the index is a slip": bool(np.isclose(values[1], side)) and values[2] < 0 < values[1],
        "the row is a slip": bool(np.isclose(raised[2], side)) and 0 < raised[2] < TURN,
    }
    return Outcome(
        judge(holds=True) if np.isclose(values[k], side) else undetermined(fits),
        f"The side lies at {degrees(side)}. With atan2 that is k = 1, and k = 2 is"
        f" {degrees(values[2])}, a turn lower; with an inverse tangent that adds 180° it is k = 2,"
        f" but then the row of Table 6 runs from it to {degrees(raised[1])} and leaves out home."
        " Either the index or that row is a turn off; the line is the same. All hangs on one"
        " index of a converted text.",
    )


@computes("F-4.3")
def red_lines_play_no_part() -> Outcome:
    box, named = by_windows().box, _components(paper.FIGURE_4_BOUNDS)
    cuts_in = [
        label
        for label in paper.TABLE_6
        if paper.indices(label)[0] < 5 and paper.indices(label)[:2] not in named
        if _is_inside(box, pairs()[paper.indices(label)[0] - 1], bound_of_a_pair(label, "atan2"))
    ]
    closes = _components(_edges()) == named
    areas, by_pairs = areas_by_walls(), within_the_windows()
    by_rule = by_pairs[by_windows().contains(by_pairs)]
    return of_readings(
        "lines that would cut nothing off",
        {
            "lines that would cut nothing off": judge(
                holds=closes and not cuts_in and np.ptp(areas) < SMALL, under=closes and not cuts_in
            ),
            "B5 and B6 as sides of a box round the base, whose top is B7": judge(
                holds=bool(in_base_box(by_pairs).any() and not in_base_box(by_rule).any())
            ),
        },
        f"The six lines named close the region alone, and of the other lines of point pairs"
        f" {len(cuts_in) or 'none'} runs through it: of these lines it holds. The walls B5 and B6"
        f" of Table 5 run through it: with B6 in force {areas[1]:.4f} of {areas[0]:.4f} rad² would"
        f" be left, with B5 too {areas[2]:.4f} ({X_IN_CM}). One could read them as sides of a box"
        " that the tool must stay out of. In that case they cut nothing off. Nor would its top, B7,"
        " which is drawn as a bound: the tool cannot enter the box anyway. Why they are left out"
        " the text does not say.",
    )


@computes("F-4.4")
def which_component_is_the_upper_side() -> Outcome:
    arms = drawn_arms(robot())
    first = Counter(window_box(arm).upper_bounds[1].label for arm in arms)
    parts = " and ".join(
        f"{paper.greek(label)} in {100 * number / len(arms):.0f} %"
        for label, number in first.most_common()
    )
    return Outcome(
        undetermined(dict.fromkeys(first, True)),
        f"Of {len(arms)} arms whose lengths are drawn within half a unit of their last printed"
        f" digit the upper side of q_2 is {parts}. Where point 10 meets point 11 both components"
        " vanish, so their bounds nearly coincide, and the digits do not tell which comes first.",
    )


def _is_inside(box: Box, pair: Pair, value: float) -> bool:
    """Tell whether a line at a joint value, or a full turn on or back, runs through the box."""
    (joint,) = pair_vector(robot(), pair).joints()
    copies = value + TURN * np.arange(-2, 3)
    inside = (box.lower[joint] + SMALL < copies) & (copies < box.upper[joint] - SMALL)
    return bool(inside.any())


@computes("F-5.2")
def six_points_joined() -> Outcome:
    depth = depth_below_edges()
    leaving = [str(i + 1) for i, d in enumerate(depth) if d > SMALL]
    along = len(edges()) == 6
    return of_readings(
        "joined by straight lines",
        {
            "joined along the functions": judge(holds=along),
            "joined by straight lines": judge(holds=along and not leaving, under=along),
        },
        f"Along the functions {len(edges())} arcs close one loop around {by_windows().area:.6f}"
        f" rad². The straight lines through points {' and '.join(leaving)} and the next leave it,"
        f" with the tool up to {depth.max():.4f} cm below its limit: the text says so itself and"
        " offers two remedies.",
    )


CENTROIDS: Final = ("area", "points")


@computes("F-6.4")
def which_factor_and_which_centroid() -> Outcome:
    printed = paper.SCALING["factor"], paper.SCALING["centroid"]
    middles = dict(
        zip(CENTROIDS, (polygon.centroid(vertices()), vertices().mean(axis=0)), strict=True)
    )
    fits = {
        f"{factor} about the centroid of the {name}": _is_safe(factor, middles[name])
        for factor in (0.96, 0.95, 0.9, 0.8)
        for name in CENTROIDS
        if printed[0] in (None, factor) and printed[1] in (None, name)
    }
    apart = float(np.degrees(np.linalg.norm(np.subtract(*middles.values()))))
    both = [largest_scale(centre).scale for centre in ("area", "vertices")]
    return Outcome(
        undetermined(fits),
        f"No factor is in the text, nor which centroid: all {len(fits)} combinations tried keep"
        f" the floor. The centroids of the area and of the six points are {apart:.4f}° apart and"
        f" allow scales up to {both[0]:.9f} and {both[1]:.9f}. {PICTURE}",
    )


def _is_safe(factor: float, about: Floats) -> bool:
    return scaling.least_on_edges(floor(), polygon.scaled(vertices(), factor, about)).value > 0
