"""Entries on whole links: bodies rebuilt from the points of the tables, and their gaps."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Final

import numpy as np

from cspace.measures import bodies
from lizarraga2025 import printed as paper
from lizarraga2025 import readings
from lizarraga2025.beyond import evidence
from lizarraga2025.beyond.evidence import FILES, body_gap, by_clearances
from lizarraga2025.beyond.evidence import robot as robot_with_bodies
from lizarraga2025.choices import LEFT, RIGHT, SCALE
from lizarraga2025.computations.region import PICTURE
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence import joint_region as region
from lizarraga2025.evidence.arms import floor, pairs, robot, symmetric, tool_form
from lizarraga2025.evidence.joint_region import by_windows, scaled
from lizarraga2025.evidence.proofs import general, vanishes
from lizarraga2025.evidence.rounding import SMALL, contact
from lizarraga2025.evidence.tool_paths import arm, path_through
from lizarraga2025.verdicts import Outcome, judge, of_readings, reading, undetermined
from qbound import Pair, Robot, closest_approach, components, keeps_clear, window_region
from qbound.arrays import Bools, Floats
from qbound.windows import window_box


def _margins(scales: tuple[float, ...]) -> tuple[Floats, Floats, str]:
    """Return the least height of the tool and the least gap of bodies by scale, cm, and a text."""
    heights = np.array([region.least_height(s) for s in scales])
    gaps = np.array([body_gap(region.along_edges(scaled(s), 501)).min() for s in scales])
    rows = zip(scales, heights, gaps, strict=True)
    return heights, gaps, "; ".join(f"{s:g}: {h:.4f} and {gap:.4f} cm" for s, h, gap in rows)


@computes("F-6.2")
def scaling_leaves_a_margin() -> Outcome:
    safe, scales = region.largest_scale().scale, (0.97, 0.96, 0.95, 0.9, 0.8)
    heights, gaps, text = _margins(scales)
    grow = bool((np.diff(heights) > 0).all() and (np.diff(gaps) > 0).all())
    below, free = np.array(scales) < safe, (heights > 0) & (gaps > 0)
    return Outcome(
        judge(
            holds=grow and bool(free.all()), under=grow and bool(below.any() and free[below].all())
        ),
        f"A margin in length, and growing, once the scale is below {safe:.6f}. Least height of the"
        f" tool above its limit and least gap of the rebuilt bodies, by scale: {text}.",
    )


@computes("S-10")
def safety_margin() -> Outcome:
    heights, gaps, text = _margins((0.96, 0.95, 0.9))
    return Outcome(
        judge(holds=region.least_height(0.99) > 0, under=min(*heights, *gaps) > 0),
        f"The tool above its limit and rebuilt bodies from each other keep, by scale: {text}.",
    )


@computes("F-6.3")
def scaled_region_is_free_of_collision() -> Outcome:
    inside = [region.along_edges(scaled(0.999 * f), 41) for f in np.linspace(0.02, 1, 50).tolist()]
    gap = body_gap(np.array(inside))
    touching = float(body_gap(region.along_edges(scaled(1.0), 41)).min())
    return Outcome(
        judge(holds=float(gap.min()) > 0),
        "With the bodies rebuilt from the points: at scale 1 bodies touch (gap"
        f" {abs(touching):.2f} cm); on {gap.size} configurations of the polygons from scale 0.999"
        f" down the least gap is {gap.min():.4f} cm. From {region.largest_scale().scale:.3f} down"
        " the tool keeps its limit too.",
    )


TESTS: Final[Mapping[str, Callable[[Robot, Floats], Bools]]] = {
    "coincidence of points, eq. (17)": readings.misses_points,
    "the tool's limit alone, eq. (12)": readings.keeps_geometric,
    "clearances, eqs. (11) and (12)": keeps_clear,
    "windows of Table 6": readings.in_windows,
    "signs of the components in use, eq. (9)": readings.keeps_components_positive,
    "signs of the third components, eq. (9)": readings.keeps_third_components_positive,
    "rebuilt bodies and the tool's limit": lambda _, q: evidence.bodies_allow(q),
}
"""What can make a point red: the test for a configuration that stays blue, by name."""


@cache
def _colours() -> dict[str, tuple[Bools, Bools]]:
    """Return by test which configurations of the draw are free, and which of their counterparts.

    The counterpart has the tool at the same place in the other posture. Where the text states a
    test, it is the only one.
    """
    q, stated = region.drawn().q, paper.SAMPLES["test"]
    second = arm().other_posture(q)
    return {
        name: (free(robot(), q), free(robot(), second))
        for name, free in TESTS.items()
        if stated in (None, name)
    }


def _mixing() -> list[str]:
    """Return the tests by which some place has a free posture and a colliding one."""
    return [name for name, (free, other) in _colours().items() if (free & ~other).any()]


@computes("F-11.1")
def what_a_red_point_is() -> Outcome:
    parts = "; ".join(f"{100 * free.mean():.1f} % by {n}" for n, (free, _) in _colours().items())
    fits = {name: name in _mixing() for name in _colours()}
    out = " and ".join(name for name, fit in fits.items() if not fit)
    return Outcome(
        undetermined(fits),
        f"The test is not in the text. Of one draw of {len(region.drawn().q)} configurations are"
        f" free, to 0.3 %: {parts}. By {out or 'none'} no place has both colours, as the text says"
        f" some have (F-11.2); each of the other {len(_mixing())} could be meant. {PICTURE}",
    )


@computes("F-11.2")
def both_colours_at_one_place() -> Outcome:
    same = np.allclose(
        tool_form()(arm().other_posture(region.drawn().q)), region.drawn().tool, atol=SMALL
    )
    parts = [
        f"{100 * (free & ~other).sum() / free.sum():.1f} % by {name}"
        for name, (free, other) in _colours().items()
        if name in _mixing()
    ]
    return Outcome(
        judge(holds=bool(same) and bool(_mixing())),
        "Every place has two postures. Of the free configurations of the draw the second posture"
        f" collides for {'; '.join(parts) or 'none'}.",
    )


@computes("S-12")
def adjacent_links_suffice() -> Outcome:
    between, error = evidence.gap_of_base_and_link_2()
    return Outcome(
        judge(holds=between - error > 0),
        "Wherever the windows of the points allow, the base and link 2 keep more than"
        f" {np.floor(between - error):.0f} cm. A robot whose base and last link can meet has the"
        " same functions for their points.",
    )


@computes("S-9.1", "S-13", "S-16.1")
def distance_of_points_and_of_links() -> Outcome:
    others = by_clearances().components[1:]
    overlaps = [-float(body_gap(np.array(c.centroid))) for c in others] or [0.0]
    apart = evidence.least_gap_in_home_region() > 0
    return Outcome(
        judge(holds=apart and not others, under=apart),
        "In the region of the home pose it does: no rebuilt bodies overlap in it. In the"
        f" {len(others)} other regions that the clearances allow they do, at the centroids by"
        f" {min(overlaps):.2f} to {max(overlaps):.2f} cm. No path from home leads there (S-23).",
    )


@computes("S-16")
def necessary_for_a_collision() -> Outcome:
    g = general()
    seen = vanishes(g.chain.position("a+n", "b+m", "a") - g.B)
    turned = vanishes(g.chain.position("a+n", "b+m", "0") - g.R_0a @ g.B)
    pose = np.array(by_clearances().components[-1].centroid)
    apart = min(float(np.linalg.norm(components(robot(), p)(pose))) for p in pairs())
    deep = -float(body_gap(pose))
    return of_readings(
        "Two points meet exactly where B = 0, by identity and for all rotations. Of whole links the"
        " points tell enough in the region of the home pose. Elsewhere they need not: at q1 ="
        f" {np.degrees(pose[0]):.1f}°, q2 = {np.degrees(pose[1]):.1f}° bodies overlap by"
        f" {deep:.2f} cm and no pair of points is closer than {apart:.2f} cm.",
        reading("conditions for the chosen points to meet", holds=seen and turned),
        reading(
            "conditions for whole links to meet",
            holds=deep <= 0,
            under=evidence.least_gap_in_home_region() > 0,
        ),
    )


@computes("S-9.2", "S-20.2", "S-20.4")
def the_complete_workspace() -> Outcome:
    q, free = region.square(120), {}
    for name in FILES:  # by a check of whole bodies, and by the rule
        whole = (body_gap(q, name) > 0) & (floor()(q) >= 0)
        free[name] = whole, window_region(robot_with_bodies(name)).contains(q)
    same = {name: np.array_equal(*both) for name, both in free.items()}
    whole, rule = free["printed"]
    by_bodies, early = evidence.by_whole_bodies().area, _angle_to_contact("printed")
    return Outcome(
        judge(holds=same["printed"], under=same["corrected"] and same["symmetric"]),
        f"A check of the rebuilt bodies frees {by_bodies:.4f} rad². The windows and the tool's"
        f" limit leave out {by_bodies - by_windows().area:.4f} rad² of it, for one side stops"
        f" {early:.4f}° early, and of {whole.size} configurations on a grid they free"
        f" {np.count_nonzero(rule & ~whole) or 'none'} that the check does not. With"
        " x_{2,13} = 9.09 (T-4.2) both free the same.",
    )


@computes("S-28")
def contact_on_the_boundary() -> Outcome:
    contacts = [_gap_of_bodies(pair) < contact(pair) for pair in pairs()]
    worst = {name: _angle_to_contact(name) for name in FILES}
    return of_readings(
        f"On {sum(contacts)} of the {len(contacts)} sides of the box of windows two of the rebuilt"
        " bodies touch, within the rounding of the printed offsets; for the unrounded shape on"
        f" all. As printed, one side stops {worst['printed']:.4f}° before the contact, with one"
        f" digit corrected none by more than {worst['corrected']:.4f}°.",
        reading("a collision that may follow there", holds=any(contacts)),
        reading(
            "a contact on every side",
            holds=worst["printed"] < 1e-6,
            under=worst["symmetric"] < 1e-6,
        ),
    )


def _gap_of_bodies(pair: Pair) -> float:
    """Return how far the bodies of a pair's links are apart where its window ends, cm."""
    joint, box = closest_approach(robot(), pair).joint, by_windows().box
    sides = ((box.lower_bounds[joint], box.lower), (box.upper_bounds[joint], box.upper))
    q = np.array(robot().home, dtype=float)
    q[joint] = next(ends[joint] for bound, ends in sides if bound.boundary == pair.name)
    return abs(float(bodies.gaps(robot_with_bodies(), q)[str(joint), str(joint + 1)]))


def _angle_to_contact(name: str) -> float:
    """Return the largest angle between a side of the box and the contact of bodies, deg."""
    box = window_box(robot_with_bodies(name))
    free = np.array(
        [bodies.contact_free_interval(robot_with_bodies(name), joint) for joint in (0, 1)]
    )
    return float(np.degrees(np.abs(free - np.stack([box.lower, box.upper], -1)).max()))


@computes("S-36")
def mirrored_pose_on_one_trajectory() -> Outcome:
    scales = (1.0, 0.96, SCALE, 0.9, 0.8)
    ends = np.array([path_through(o, s).q[-1] for s in scales for o in (RIGHT, LEFT)])
    flipped = arm().other_posture(ends)
    shut, deep = ~by_windows().contains(flipped), -body_gap(flipped)
    steps = np.linspace(0, 1, 2001)[:, None]  # of the straight joint path to the other posture
    free = [by_windows().contains(q + steps * (arm().other_posture(q) - q)).all() for q in scaled()]
    straight = [str(i + 1) for i, one in enumerate(free) if one]
    return of_readings(
        f"At {len(scales)} scales from 1 to 0.8 the second posture with the tool at the same place"
        f" is infeasible in {int(shut.sum())} of {len(shut)} cases at the ends of the book's paths;"
        f" rebuilt bodies overlap there by {deep.min():.2f} to {deep.max():.2f} cm. At scale"
        f" {SCALE:g} that of points {', '.join(straight) or 'none'} is feasible, and so is the"
        " straight joint path to it. The arm mirrored at the z axis can be reached from the final"
        " pose, through the stretched pose: on the symmetric arm from point 4 to point 1.",
        reading(
            "the last link on the other side of the line from joint 1 to the tool",
            holds=bool(shut.all()) and not straight,
            under=bool(shut.all()),
        ),
        reading("the whole arm mirrored at the z axis", holds=not _mirror_image_is_reached()),
    )


def _mirror_image_is_reached() -> bool:
    """Tell whether the symmetric arm gets from point 1 to its mirror image, point 4, directly."""
    p = scaled(SCALE, symmetric())
    mirrored = np.allclose(np.radians([-60.0, -120.0]) - p[0], p[3], atol=SMALL)
    straight = p[0] + np.linspace(0, 1, 2001)[:, None] * (p[3] - p[0])
    return bool(mirrored and readings.in_windows(symmetric(), straight).all())
