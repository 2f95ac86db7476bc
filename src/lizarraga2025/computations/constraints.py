"""Equations (9) to (12): the sign of a component, joint limits, least distance, limits in space."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence import rounding as third_components
from lizarraga2025.evidence.arms import (
    corrected,
    half_spaces,
    printed_function,
    robot,
    tool_form,
)
from lizarraga2025.evidence.joint_region import by_windows, square, vertices
from lizarraga2025.evidence.rounding import SMALL, degrees
from lizarraga2025.verdicts import Outcome, judge, of_readings
from qbound import clearance
from qbound.symbols import offset_values


@computes("E-9")
def sign_of_a_component() -> Outcome:
    inside, outside = np.radians([-90.0, 0.0]), np.radians([-140.0, 0.0])
    path = np.linspace(robot().home, inside, 1001)
    free = all((clearance(robot(), b)(path) > 0).all() for b in robot().used)
    allowed = free and bool(by_windows().contains(inside))
    beyond = not by_windows().contains(outside)
    bounding = {label.rpartition(",")[0] + "}" for label in paper.FIGURE_4_BOUNDS}
    pairs = [name for name in paper.EQUATION_29 if paper.indices(name)[0] < 5]
    negative = {name: x for name in pairs if (x := float(_printed(name)(*inside))) < 0}
    of_2 = {name: float(_printed(name)(*outside)) for name in pairs if name.startswith("beta_{2")}
    sides = [paper.greek(name) for name in negative if name in bounding]
    return of_readings(
        "a rule for every component",
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
    return of_readings(
        "positive where its own limit is kept",
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
@computes("S-21.1")
def kinds_of_bound() -> Outcome:
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
