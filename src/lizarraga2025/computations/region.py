"""The joint region: eqs. (9) to (12), Figures 1 to 6, and the sentences on it."""

from collections import Counter
from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import Any, Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.choices import SCALE
from lizarraga2025.computations.bounds import labels_of, pair_bound
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence import arms
from lizarraga2025.evidence import joint_region as region
from lizarraga2025.evidence.arms import floor, half_spaces, pairs, robot
from lizarraga2025.evidence.joint_region import by_windows, vertices
from lizarraga2025.evidence.rounding import SMALL, contact, degrees
from lizarraga2025.uncertainty import drawn_arms
from lizarraga2025.verdicts import Outcome, judge, of_readings, reading, undetermined
from qbound import clearance, closest_approach, pair_vector, polygon
from qbound.circle import TURN, roots_along
from qbound.scaling import least_along, least_on_edges
from qbound.symbols import joint_symbols
from qbound.windows import window_box

PICTURE: Final = "The picture, which was not at hand, may show it."

# --- signs and limits: eqs. (9) to (12) -----------------------------------------------------------


def _printed(name: str, *q: Any) -> Any:
    """Return a printed component, cm, at values of both joints."""
    return arms.printed_function(paper.EQUATION_29[name], 2)(*q)


def _values(components: Mapping[str, float]) -> str:
    return " and ".join(f"{paper.greek(n)} = {value:.2f} cm" for n, value in components.items())


@computes("E-9")
def sign_of_a_component() -> Outcome:
    inside, outside = np.radians([-90.0, 0.0]), np.radians([-140.0, 0.0])
    path = np.linspace(robot().home, inside, 1001)
    free = all((clearance(robot(), b)(path) > 0).all() for b in robot().used)
    allowed = free and bool(by_windows().contains(inside))
    beyond = not by_windows().contains(outside)
    bounding = {label.rpartition(",")[0] + "}" for label in paper.FIGURE_4_BOUNDS}
    pairs_ = [name for name in paper.EQUATION_29 if paper.indices(name)[0] < 5]
    negative = {name: x for name in pairs_ if (x := float(_printed(name, *inside))) < 0}
    of_2 = {n: float(_printed(n, *outside)) for n in pairs_ if n.startswith("beta_{2")}
    sides = [paper.greek(name) for name in negative if name in bounding]
    return of_readings(
        "The pose q = (-90°, 0°) lies in the selected region and is reached from home without"
        f" touching a boundary, and yet {_values(negative)}. Of these {' and '.join(sides)} bounds"
        " the region (caption of Figure 4). The pose (-140°, 0°) lies outside, and yet"
        f" {_values(of_2)} have two signs. The second components, zero in every pose, would put"
        " all of them on the boundary.",
        reading("a rule for every component", holds=not (allowed and negative)),
        reading("a rule for those that bound the selected region", holds=not (allowed and sides)),
        reading(
            "a rule for all components of a pair",
            holds=not (beyond and any(x > 0 for x in of_2.values())),
        ),
    )


WALLS: Final = {"B5": "beta_{5,1}", "B6": "beta_{6,1}", "B7": "beta_{7,3}"}
"""The component of each geometric boundary function that is not zero throughout."""


def _least_at_the_corners() -> tuple[dict[str, bool], str]:
    """Return which walls the six points of the region keep, and a sentence with the depths, cm."""
    least = {name: float(np.min(_printed(WALLS[name], *vertices().T))) for name in WALLS}
    depths = ", ".join(f"{name} {round(x, 9) + 0:.2f} cm" for name, x in least.items())
    at = " and ".join(f"{wall.offset:g}" for wall in half_spaces()[:2])
    text = f"At the six points of the selected region the least values are: {depths}, with x_min of"
    text += f" {at} cm, a unit that is open (T-5.2)."
    return {name: x > -SMALL for name, x in least.items()}, text


@computes("E-9.1")
def sign_of_a_half_space() -> Outcome:
    q = region.square().reshape(-1, 2)[::97]
    tool = arms.tool_form()(q)
    own = all(
        np.allclose(_printed(WALLS[wall.name], *q.T), tool @ wall.normal - wall.offset)
        for wall in half_spaces()
    )
    kept, text = _least_at_the_corners()
    return of_readings(
        f"Each is the coordinate of the tool less its limit, so its sign tells the side. {text}",
        reading("positive where its own limit is kept", holds=own),
        reading("positive in the selected region", holds=all(kept.values()), under=kept["B7"]),
    )


@computes("E-12")
def limits_in_space() -> Outcome:
    kept, text = _least_at_the_corners()
    upper = sum("max" in o.label for o in paper.OFFSETS)
    return Outcome(
        judge(holds=all(kept.values()), under=kept["B7"]),
        f"{upper or 'No'} upper limits, two lower ones for x and one for z are printed. {text}",
    )


@computes("E-9.2", "S-21.1")
def kinds_of_bound() -> Outcome:
    turn = np.linspace(-np.pi, np.pi, 721)
    above = []
    for i, j in map(paper.indices, paper.EQUATION_29):
        upper, lower = (arms.printed_function(paper.TABLE_6[x]) for x in labels_of(i, j))
        with np.errstate(invalid="ignore"):
            apart = upper(turn) - lower(turn) + 0 * turn
        above.append(bool((apart[np.isfinite(apart)] > 0).all()))
    return Outcome(
        judge(holds=all(above)),
        f"In {sum(above)} of {len(above)} rows of Table 6 the bound with k = 1 is the greater one,"
        " wherever both exist. The caption of Figure 4 calls one side β_{3,3,2}; if every window is"
        " to contain the home pose, it is β_{3,3,1}.",
    )


@computes("S-17.1")
def joint_limits_are_captured() -> Outcome:
    q, box = robot().home, by_windows().box
    turned = q + TURN * np.eye(len(q))
    growing = sum(
        bool((np.abs(form(turned) - form(q)) > SMALL).any()) for form in arms.every_component()
    )
    ends = [degrees(q) for q in (*box.lower, *box.upper)]
    finite = bool(np.isfinite([box.lower, box.upper]).all())
    return of_readings(
        "They give the values at which contacts stop a joint: q_1 from"
        f" {ends[0]} to {ends[2]}, q_2 from {ends[1]} to {ends[3]}. A limit as in eq. (10) grows by"
        f" a turn with its joint, which {growing or 'none'} of the components of the seven"
        " functions does, and no number is printed for one.",
        reading("a limit of a joint, as in eq. (10)", holds=growing > 0),
        reading("the ends of a joint's free range", holds=False, under=finite),
    )


# --- Figures 1 to 3 -------------------------------------------------------------------------------


@computes("F-1")
def labels_close_a_triangle() -> Outcome:
    frames = arms.symbolic_robot()[0].frames(joint_symbols(robot()))

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
    places = [[chain.index(robot().point(p).frame) for p in pair.points] for pair in pairs()]
    return Outcome(
        judge(holds={abs(a - b) for a, b in places} == {1}),
        f"In all {len(places)} pairs of Tables 3 and 4 one joint lies between the two points.",
    )


@computes("F-2.1")
def which_figure_is_isometric() -> Outcome:
    named, view = paper.NAMED_VIEW
    announce_it = [number for number, words in paper.CAPTIONS.items() if view in words]
    fits = {str(number): not announce_it or number in announce_it for number in (named, 3)}
    told = "; ".join(f"that of Figure {n} announces {paper.CAPTIONS[int(n)]}" for n in fits)
    return Outcome(
        judge(holds=True) if announce_it == [named] else undetermined(fits),
        f"The text names Figure {named}. {len(announce_it) or 'No'} captions announce an {view}"
        f" view; {told}. Only the pictures can tell.",
    )


@computes("F-3")
def chain_of_the_robot() -> Outcome:
    frames, order = robot().frames(robot().home), ["0", "1", "2", robot().tool]
    precede = all(frames.precedes(a, b) for a, b in pairwise(order))
    return Outcome(judge(holds=precede and order[-1] == "3"))


# --- Figures 4 and 5: bounds and corners ----------------------------------------------------------


def _components(labels: Iterable[str]) -> set[tuple[int, ...]]:
    """Return the indices i and j, without the k that tells lower from upper."""
    return {paper.indices(label)[:2] for label in labels}


def sides_of_the_box(arctan: paper.Reading) -> dict[str, float]:
    """Return the highest lower and the lowest upper bound of each joint, rad, by their labels."""
    found = {}
    for of_joint in ("12", "34"):
        bounds = {label: pair_bound(label) for label in paper.TABLE_6 if label[6] in of_joint}
        values = {x: one.value if arctan == "atan2" else one.plain for x, one in bounds.items()}
        upper, lower = ([n for n in values if n.endswith(end)] for end in ("1}", "2}"))
        for label in (max(lower, key=values.__getitem__), min(upper, key=values.__getitem__)):
            found[label] = values[label]
    return found


def _raised(label: str) -> float:
    """Return a printed bound, rad, by an arctangent to which π is added where a < 0."""
    i, j, _ = paper.indices(label)
    component = pair_vector(robot(), pairs()[i - 1])[j - 1]
    (joint,) = component.joints()
    behind = component.along(joint, robot().home).a < 0
    return pair_bound(label).plain + (np.pi if behind else 0.0)


@computes("F-4.1")
def six_curves() -> Outcome:
    named, found = set(paper.FIGURE_4_BOUNDS), {bound.label for bound in by_windows().bounds}
    same = _components(named) == _components(found) and len(found) == len(named)
    with_arctan, box = sides_of_the_box("arctan"), by_windows().box
    agree = sum(
        x[6] in "567" or bool(np.isclose(_raised(x), [*box.lower, *box.upper]).any()) for x in named
    )
    return Outcome(
        judge(holds=same and with_arctan.keys() <= named, under=same),
        f"With the inverse tangent as atan2 the region has {len(found)} bounding curves, of the"
        f" components that the caption names; {len(named & found)} of the {len(named)} labels agree"
        f" to the last index (F-4.2), and {agree} with an arctangent to which 180° is added where a"
        " < 0, with which only row 6 of Table 6 is a turn off (T-6.6). With arctan the sides would"
        f" be {', '.join(paper.greek(label) for label in sorted(with_arctan))}.",
    )


@computes("F-4.2")
def the_index_of_one_bound() -> Outcome:
    (k,) = {paper.indices(label)[2] for label in paper.FIGURE_4_BOUNDS if "{3,3," in label}
    side = float(by_windows().box.upper[1])
    values, raised = (
        dict(zip((1, 2), map(value, labels_of(3, 3)), strict=True))
        for value in (lambda label: pair_bound(label).value, _raised)
    )
    fits = {
        "the index is a slip": bool(np.isclose(values[1], side)) and values[2] < 0 < values[1],
        "the row is a slip": bool(np.isclose(raised[2], side)) and 0 < raised[2] < TURN,
    }
    return Outcome(
        judge(holds=True) if np.isclose(values[k], side) else undetermined(fits),
        f"The side lies at {degrees(side)}. With atan2 that is k = 1, and k = 2 is"
        f" {degrees(values[2])}, a turn lower; with an inverse tangent that adds 180° it is k = 2,"
        f" but then the row of Table 6 runs from it to {degrees(raised[1])} and leaves out home."
        " Either the index or that row is a turn off. All hangs on one index of a converted text.",
    )


@computes("F-4.3")
def red_lines_play_no_part() -> Outcome:
    box, named = by_windows().box, _components(paper.FIGURE_4_BOUNDS)
    cuts_in = 0
    for label in (x for x in paper.TABLE_6 if x[6] in "1234" and paper.indices(x)[:2] not in named):
        joint = closest_approach(robot(), pairs()[int(label[6]) - 1]).joint
        copies = pair_bound(label).value + TURN * np.arange(-2, 3)
        inside = (box.lower[joint] + SMALL < copies) & (copies < box.upper[joint] - SMALL)
        cuts_in += bool(inside.any())
    closes = _components(bound.label for bound in by_windows().bounds) == named and not cuts_in
    areas, by_pairs = region.areas_by_walls(), region.within_the_windows()
    in_box = region.in_base_box(by_pairs)
    as_a_box = bool(in_box.any() and not in_box[by_windows().contains(by_pairs)].any())
    return of_readings(
        "The six lines named close the region alone, and of the other lines of point pairs"
        f" {cuts_in or 'none'} runs through it. The walls B5 and B6 of Table 5 do: with B6 in"
        f" force {areas[1]:.4f} of {areas[0]:.4f} rad² would be left, with B5 too {areas[2]:.4f}"
        f" ({region.X_IN_CM}). As sides of a box that the tool must stay out of they cut nothing"
        " off, nor would its top, B7, which is drawn as a bound. Why they are left out the text"
        " does not say.",
        reading(
            "lines that cut nothing off", holds=closes and bool(np.ptp(areas) < SMALL), under=closes
        ),
        reading("sides of a box round the base, whose top is B7", holds=as_a_box),
    )


@computes("S-20.1")
def limits_are_respected() -> Outcome:
    areas = region.areas_by_walls()
    kept = [bool(np.isclose(area, areas[0], rtol=1e-9)) for area in areas[1:]]
    inside = int(region.in_base_box(region.square()[by_windows().contains(region.square())]).sum())
    anyway = bool(region.in_base_box(region.within_the_windows()).any())
    return of_readings(
        "The selected region respects B7, the one that its caption names; as half-spaces B5 and B6"
        f" would cut it. Of {region.square()[..., 0].size} configurations on a grid"
        f" {inside or 'none'} in the region has the tool in the box that the three would bound.",
        reading(
            "three half-spaces, one of them in the caption of Figure 4",
            holds=all(kept),
            under=areas[0] > 0,
        ),
        reading("sides of one box that the tool stays out of", holds=not inside, constrains=anyway),
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


@computes("F-5.2")
def six_points_joined() -> Outcome:
    depth = region.depth_below_edges()
    leaving = [str(i + 1) for i, d in enumerate(depth) if d > SMALL]
    along = len(region.edges()) == 6
    return of_readings(
        f"Along the functions {len(region.edges())} arcs close one loop around"
        f" {by_windows().area:.6f} rad². The straight lines through points {' and '.join(leaving)}"
        f" and the next leave it, with the tool up to {depth.max():.4f} cm below its limit: the"
        " text says so itself and offers two remedies.",
        reading("joined by straight lines", holds=along and not leaving, under=along),
        reading("joined along the functions", holds=along),
    )


@computes("S-1")
def intersections_give_a_continuous_boundary() -> Outcome:
    return Outcome(judge(holds=bool(region.edges())))


@computes("S-12.1")
def sides_from_points_of_the_chain() -> Outcome:
    sides = [edge.bound.boundary for edge in region.edges()]
    of_pairs = sum(name in {pair.name for pair in pairs()} for name in sides)
    of_tool = sum(name in {half.name for half in half_spaces()} for name in sides)
    return of_readings(
        f"{of_pairs} of the {len(sides)} sides of the joint region come from vectors between two"
        f" collision points, and {of_tool} from B7, the vector from the base to the tool.",
        reading(
            "between points of the chain", holds=of_pairs > 0 and of_pairs + of_tool == len(sides)
        ),
        reading("between two collision points", holds=of_tool == 0, under=of_pairs > 0),
    )


@computes("S-19")
def exactly_where_it_meets_itself() -> Outcome:
    printed, exact, digit = (
        [closest_approach(of, pair).gap for pair in pairs(of)]
        for of in (robot(), arms.symmetric(), arms.corrected())
    )
    allowed = [contact(pair) for pair in pairs()]
    meets, with_9_09 = (
        all(gap < most for gap, most in zip(gaps, allowed, strict=True))
        for gaps in (printed, digit)
    )
    return Outcome(
        judge(holds=meets, under=max(exact) < SMALL and with_9_09),
        f"The points of a pair come to within {min(printed):.4f} to {max(printed):.4f} cm of each"
        f" other, with x_{{2,13}} = 9.09 to within {max(digit):.4f} cm; rounding allows"
        f" {min(allowed):.4f} cm and more. Of the unrounded shape all pairs meet.",
    )


@computes("S-20")
def half_spaces_are_independent() -> Outcome:
    forms = [clearance(robot(), half) for half in half_spaces()]
    q1 = np.linspace(-np.pi, np.pi, 73)
    alone = []
    for form in forms:  # in some pose in which it vanishes no other one does
        roots = roots_along(form, 1, np.stack([q1, q1], -1))[1]
        q = np.stack([q1, roots], -1)[np.isfinite(roots)]
        alone.append(np.all([np.abs(one(q)) > SMALL for one in forms if one is not form], 0).any())
    signs = np.stack([form(region.square(180)) >= 0 for form in forms], axis=-1)
    patterns = len(np.unique(signs.reshape(-1, 3), axis=0))
    nested = not (signs[..., 0] & ~signs[..., 1]).any()
    return of_readings(
        f"{sum(alone)} of the {len(alone)} functions vanish in poses in which no other does. Of the"
        f" 8 combinations of signs {patterns} occur: B5 asks x >= 15 cm and B6 x >= -15 cm of"
        f" the same point ({region.X_IN_CM}), so B5 implies B6.",
        reading("each of them being a condition by itself", holds=all(alone)),
        reading(
            "each being independent of the others",
            holds=patterns == 8,
            under=nested and patterns == 6,
        ),
    )


@computes("S-21")
def combinations_of_cosine_and_sine() -> Outcome:
    q = np.random.default_rng(4).uniform(-3, 3, (50, 2))
    worst = 0.0
    for pair in pairs():
        vector = pair_vector(robot(), pair)
        (joint,) = vector.joints()
        c0, a, b = vector.along(joint, q)
        angle = q[:, joint, None]
        rest = vector(q) - (a * np.cos(angle) + b * np.sin(angle) + c0)
        worst = max(worst, float(np.abs(rest).max()))
    return Outcome(
        judge(holds=worst < SMALL),
        f"The {2 * len(pairs())} components of the pairs are, each of one joint, plus a constant."
        f" The {len(half_spaces())} of the half-spaces are so along either joint, with coefficients"
        " that depend on the other.",
    )


@computes("S-23.1")
def home_pose_is_not_printed() -> Outcome:
    poses = {"both joints at zero": (0, 0), "the arm upright": (-30, -60), "q1 alone": (45, 0)}
    within = {name: bool(by_windows().contains(np.radians(q))) for name, q in poses.items()}
    seen = ", ".join(f"{name} ({q1}°, {q2}°)" for name, (q1, q2) in poses.items() if within[name])
    return Outcome(
        undetermined(within),
        f"The selected region holds {sum(within.values())} of {len(within)} candidates: {seen}. Any"
        " pose in it gives the same region; the robot file takes the pose in which Tables 1 and 2"
        " are read off.",
    )


@computes("S-23.3")
def many_functions_no_unique_solution() -> Outcome:
    q, forms = region.square(), arms.every_component()
    signs = np.stack([form(q) > 0 for form in forms], axis=-1)
    patterns = len(np.unique(signs.reshape(-1, len(forms)), axis=0))
    inside = len(np.unique(signs[by_windows().contains(q)], axis=0))
    return Outcome(
        judge(holds=patterns > inside > 1),
        "The components' zero lines cut the square of one turn into pieces: on a grid of"
        f" {len(q)} by {len(q)} poses {patterns} combinations of signs occur, {inside} of them in"
        " the selected region, so no one combination marks it.",
    )


@computes("S-25")
def nonlinear_functions_are_violated() -> Outcome:
    depth = region.depth_below_edges()
    match = all(
        (d > SMALL) == (edge.bound.boundary == "B7")
        for d, edge in zip(depth, region.edges(), strict=True)
    )
    return Outcome(judge(holds=bool(depth.max() > SMALL) and match))


@computes("S-26")
def tangents_mend_it() -> Outcome:
    inner = {n: by_windows().with_points(n, tangents=True) for n in (2, 3, 5)}
    least = min(least_on_edges(floor(), p).value for p in inner.values())
    kept = 100 * polygon.area(inner[5]) / by_windows().area
    chord = by_windows().with_points(33, tangents=False)
    deep = -least_on_edges(floor(), chord).value
    return Outcome(
        judge(holds=least > -SMALL),
        f"Corners of tangents at five points of each curve keep every bound and {kept:.3f} % of the"
        " region's area, without a margin. Points on the curve itself, joined by chords, do not:"
        f" with {len(chord)} points the tool is still {deep:.4f} cm too low.",
    )


@computes("S-6.1")
def better_than_what() -> Outcome:
    inside = by_windows().with_points(5, tangents=True)
    kept = {
        "straight paths between the points": region.depth_below_edges().max() <= SMALL,
        "paths inside tangents at the boundary": least_on_edges(floor(), inside).value > -SMALL,
    }
    fits = {name: True for name in kept if paper.COMPARED in (None, name)}
    told = "; ".join(f"{name} {'do' if keeps else 'do not'}" for name, keeps in kept.items())
    return of_readings(
        "The sentence names no planning of paths, and random draws give no path. A path in the"
        f" scaled region keeps every bound up to scale {region.largest_scale().scale:.6f}. Of other"
        f" plannings with boundary functions, {told}.",
        ("better than a planning that is not named", undetermined(fits)),
        reading(
            "better than random draws, which give no path",
            holds=region.least_height(0.99) > 0,
            under=region.least_height(SCALE) > 0,
        ),
    )


# --- Figure 6: scaling ----------------------------------------------------------------------------


@computes("F-6.1", "S-3", "S-27")
def scaling_mends_it() -> Outcome:
    safe = region.largest_scale()
    margins = [region.least_height(s) for s in np.linspace(0.05, safe.scale - 1e-9, 20)]
    p = region.scaled(safe.scale)
    legs = zip(p, np.roll(p, -1, axis=0), strict=True)
    edge = int(np.argmin([least_along(floor(), *leg).value for leg in legs]))
    return Outcome(
        judge(holds=region.least_height(0.98) > 0, under=min(margins) > -SMALL),
        f"From scale {safe.scale:.6f} down; edge {edge + 1} to {edge + 2} binds, at q1 ="
        f" {degrees(safe.q[0])}, q2 = {degrees(safe.q[1])}. The text states no factor, so a reader"
        " has to find it.",
    )


@computes("F-6.4")
def which_factor_and_which_centroid() -> Outcome:
    of_text = paper.SCALING["factor"], paper.SCALING["centroid"]
    middles = {"area": polygon.centroid(vertices()), "points": vertices().mean(axis=0)}
    fits = {
        f"{factor} about the centroid of the {name}": least_on_edges(
            floor(), polygon.scaled(vertices(), factor, middle)
        ).value
        > 0
        for factor in (0.96, 0.95, 0.9, 0.8)
        for name, middle in middles.items()
        if of_text[0] in (None, factor) and of_text[1] in (None, name)
    }
    apart = float(np.degrees(np.linalg.norm(np.subtract(*middles.values()))))
    both = [region.largest_scale(centre).scale for centre in ("area", "vertices")]
    return Outcome(
        undetermined(fits),
        f"No factor is in the text, nor which centroid: all {len(fits)} combinations tried keep"
        f" the tool's limit. The centroids of the area and of the six points are {apart:.4f}° apart"
        f" and allow scales up to {both[0]:.9f} and {both[1]:.9f}. {PICTURE}",
    )
