"""Equations (9) to (12): the sign of a component, joint limits, least distance, limits in space."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final

import numpy as np

from cspace import clearance
from cspace.model.robot import Robot
from cspace.region import find_region, paper_rule
from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence import rounding as third_components
from lizarraga2025.evidence.arms import (
    corrected,
    half_spaces,
    pairs,
    printed_function,
    robot,
    tool_form,
)
from lizarraga2025.evidence.joint_region import square, vertices
from lizarraga2025.evidence.rounding import SMALL, degrees
from lizarraga2025.verdicts import Outcome, judge, strongest, undetermined
from qbound.boundary import closest_approach
from qbound.symbols import offset_values


@computes("E-9")
def sign_of_a_component() -> Outcome:
    inside, outside = np.radians([-90.0, 0.0]), np.radians([-140.0, 0.0])
    path = np.linspace(robot().home, inside, 1001)
    free = all((clearance(robot(), b)(path) > 0).all() for b in robot().used)
    allowed = free and bool(paper_rule.feasible(robot(), inside))
    beyond = not paper_rule.feasible(robot(), outside)
    bounding = {label.rpartition(",")[0] + "}" for label in paper.FIGURE_4_BOUNDS}
    pairs = [name for name in paper.EQUATION_29 if paper.indices(name)[0] < 5]
    negative = {name: x for name in pairs if (x := float(_printed(name)(*inside))) < 0}
    of_2 = {name: float(_printed(name)(*outside)) for name in pairs if name.startswith("beta_{2")}
    sides = [paper.greek(name) for name in negative if name in bounding]
    return strongest(
        {
            "a rule for every component": judge(holds=not (allowed and negative)),
            "a rule for those that bound the selected region": judge(holds=not (allowed and sides)),
            "a rule for all components of a pair at once": judge(
                holds=not (beyond and any(x > 0 for x in of_2.values()))
            ),
        },
        "The pose q = (-90°, 0°) lies in the selected region and is reached from home without"
        f" touching a boundary, and yet {_values(negative)}. Of these {' and '.join(sides)} bounds"
        " the region (caption of Figure 4). The pose (-140°, 0°) lies outside, and yet"
        f" {_values(of_2)} have two signs. The second components, zero in every pose, would put"
        " all of them on the boundary. A remark on this arm: with x_{2,13} = 9.09 (T-4.2) the third"
        " components together do tell the side. Those of B_5 and B_6 are zero throughout, that of"
        " B_7 is the height above the floor, and those of the pairs are all positive for"
        f" {third_components.in_words(corrected())}. The ends differ from those of the windows by"
        f" up to {_largest('apart')}, and on a further strip of q_1, {_largest('rest')} wide, all"
        f" are positive. Rounding of the offsets can cause {_largest('allowed')}. It is no rule:"
        " with frames turned by 90° about y the third components are the old first ones, which"
        f" fail. As printed they are positive for {third_components.in_words(robot())}.",
    )


def _largest(name: str) -> str:
    """Return a measure of the third components, of the joint where it is largest."""
    return degrees(max(getattr(one, name) for one in third_components.sides(corrected())))


def _values(components: Mapping[str, float]) -> str:
    return " and ".join(
        f"{paper.greek(name)} = {value:.2f} cm" for name, value in components.items()
    )


def _printed(name: str) -> Callable[..., Any]:
    """Return a printed component as a function of both joints, cm."""
    return printed_function(paper.EQUATION_29[name], 2)


@computes("E-9.1")
def sign_of_a_half_space() -> Outcome:
    q = square().reshape(-1, 2)[::97]
    tool = tool_form()(q)
    own = all(
        np.allclose(_printed(name)(*q.T), tool @ wall.normal - wall.offset)
        for name, wall in zip(GEOMETRIC, half_spaces(), strict=True)
    )
    least = {name: float(np.min(_printed(name)(*vertices().T))) for name in GEOMETRIC}
    depths = ", ".join(f"{paper.greek(name)} {round(x, 9) + 0:.2f} cm" for name, x in least.items())
    kept = {name: x > -SMALL for name, x in least.items()}
    return strongest(
        {
            "positive where its own limit is kept": judge(holds=own),
            "positive in the selected region": judge(
                holds=all(kept.values()), under=kept["beta_{7,3}"]
            ),
        },
        "Each is the coordinate of the tool less its limit, so its sign tells the side. In the"
        f" selected region {_named(kept, keeps=True)} is positive, {_named(kept, keeps=False)} not"
        f" everywhere. Least values at its six points: {depths}, {_side_walls()}.",
    )


def _named(kept: Mapping[str, bool], *, keeps: bool) -> str:
    """Return the components that keep their limit, or those that do not."""
    return " and ".join(paper.greek(name) for name, one in kept.items() if one is keeps) or "none"


def _side_walls() -> str:
    """Tell where the side walls are taken to be."""
    at = " and ".join(f"{wall.offset:g}" for wall in half_spaces()[:2])
    return f"with x_min of {at} cm, a unit that is open (T-5.2)"


GEOMETRIC: Final = ("beta_{5,1}", "beta_{6,1}", "beta_{7,3}")
"""Components of the geometric boundary functions that are not zero throughout."""


@computes("E-9.2")
def kinds_of_bound() -> Outcome:
    import sympy as sp

    values = offset_values(robot())
    q1 = sp.Symbol("q_1", real=True)
    turn = np.linspace(-np.pi, np.pi, 721)
    above = []
    for i, j in (paper.indices(name) for name in paper.EQUATION_29):
        first, second = (paper.expression(paper.TABLE_6[f"beta_{{{i},{j},{k}}}"]) for k in (1, 2))
        with np.errstate(invalid="ignore"):
            apart = sp.lambdify(q1, (first - second).subs(values), "numpy")(turn) + 0 * turn
        above.append(bool((apart[np.isfinite(apart)] > 0).all()))
    return Outcome(
        judge(holds=all(above)),
        f"In {sum(above)} of {len(above)} rows of Table 6 the bound with k = 1 is the greater one,"
        " wherever both exist. The caption of Figure 4 calls one side β_{3,3,2}; if every window is"
        " to contain the home pose, it is β_{3,3,1}.",
    )


@computes("E-10")
def joint_limits() -> Outcome:
    stated = [o.label for o in paper.OFFSETS if o.label.startswith("q")]
    box = np.degrees([paper_rule.box(robot()).lower, paper_rule.box(robot()).upper])
    area = {}
    for name, limits in (("none", None), ("±180°", (-np.pi, np.pi)), ("±170°", (-2.967, 2.967))):
        joints = tuple(replace(joint, limits=limits) for joint in robot().joints)
        area[name], _ = _home(replace(robot(), joints=joints))
    same = {name: bool(np.isclose(a, area["none"])) for name, a in area.items()}
    return Outcome(
        judge(holds=True) if stated else undetermined(same),
        f"Of the robot studied {len(stated) or 'no'} limits are printed. The windows of Table 6 end"
        f" at {box[0, 0]:.2f}° and {box[1, 0]:.2f}° for the first joint and at {box[0, 1]:.2f}° and"
        f" {box[1, 1]:.2f}° for the second, so limits beyond these fit all that is printed and"
        " change nothing: the area around home is "
        + ", ".join(f"{a:.6f} rad² with limits {name}" for name, a in area.items())
        + ".",
    )


@computes("E-11")
def least_distance() -> Outcome:
    gaps = [closest_approach(robot(), pair).gap for pair in pairs()]
    seen, walls, fits = [], [], {}
    for d in (0.01, 0.1, 0.5):
        area, corners = _home(_at_a_distance(d))
        bounding = sum(gap < d for gap in gaps)
        walls.append(bounding)
        fits[str(d)] = bounding == len(gaps) and corners == 6
        seen.append(f"d_min = {d} cm: {bounding} walls, {corners} corners, {area:.6f} rad²")
    stated = any(o.label == "d_{min}" for o in paper.OFFSETS)
    by_digit = closest_approach(corrected(), pairs(corrected())[-1]).gap
    return Outcome(
        judge(holds=True) if stated else undetermined(fits),
        f"Of the robot studied {'a' if stated else 'no'} distance is printed, and the pairs come as"
        f" close as {min(gaps):.4f} to {max(gaps):.4f} cm, so d_min = 0 makes no wall at all; every"
        f" pair is a wall above {max(gaps):.4f} cm. {'; '.join(seen)}. That the first has only"
        f" {walls[0]} walls is the doing of one digit (T-4.2): with x_{{2,13}} = 9.09 the pair B4"
        f" comes as close as {by_digit:.4f} cm.",
    )


def _at_a_distance(d: float) -> Robot:
    """Return the robot with its pairs kept at a distance, cm."""
    boundaries = (replace(b, clearance=d) if b in pairs() else b for b in robot().boundaries)
    return replace(robot(), boundaries=tuple(boundaries))


def _home(arm: Robot) -> tuple[float, int]:
    """Return area, rad^2, and number of vertices of the region around home; zeros for none."""
    home = find_region(arm).home
    return (0.0, 0) if home is None else (home.area, len(home.vertices))


@computes("E-12")
def limits_in_space() -> Outcome:
    least = {w.name: float(np.min(clearance(robot(), w)(vertices()))) for w in half_spaces()}
    kept = {name: x > -SMALL for name, x in least.items()}
    depths = ", ".join(f"{name} {round(x, 9) + 0:.2f} cm" for name, x in least.items())
    upper = [o.label for o in paper.OFFSETS if "max" in o.label]
    return Outcome(
        judge(holds=all(kept.values()), under=kept["B7"]),
        f"{len(upper) or 'No'} upper limits, two lower ones for x and one for z are printed."
        f" Margins at the six points of the selected region: {depths}, {_side_walls()}. It holds"
        f" there for {', '.join(name for name, keeps in kept.items() if keeps) or 'none'}; the"
        " caption of Figure 4 names B7.",
    )
