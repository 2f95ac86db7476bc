"""The 22 bounds of Table 6, each from its printed formula."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence.arms import corrected, pairs, printed_function, robot
from lizarraga2025.evidence.rounding import at_a_root, degrees
from lizarraga2025.verdicts import Outcome, judge
from qbound import HalfSpace, HarmonicForm, Pair, Robot
from qbound.arrays import Floats
from qbound.boundary import closest_approach, components, pair_vector
from qbound.circle import TURN, circle_roots, nearest_turn
from qbound.symbols import offset_values

RESIDUAL = 1e-9
"""A component, cm, below which its bound counts as a root: offsets carry 1e-2, roundoff 1e-14."""


def _id(label: str) -> str:
    """Return the entry of a bound: B-2.1.2 of beta_{2,1,2}."""
    return "B-{}.{}.{}".format(*paper.indices(label))


def _side(label: str) -> str:
    return "upper" if paper.indices(label)[2] == 1 else "lower"


@dataclass(frozen=True)
class PairBound:
    """A bound of a point pair, computed from its printed formula.

    Attributes
    ----------
    value : float
        With atan2, rad.
    plain : float
        With the arctangent, rad.
    residual, plain_residual : float
        The component there, cm, in either reading.
    distance : float
        Distance of the two points at `value`, cm.
    allowed : float
        Distance that rounding of the offsets can leave at a root where the points meet, cm.
    other : float
        The component's other root, turned next to the closest approach, rad.
    other_distance : float
        Distance of the two points there, cm.
    contact : float
        Joint value of the closest approach, rad.
    """

    value: float
    plain: float
    residual: float
    plain_residual: float
    distance: float
    allowed: float
    other: float
    other_distance: float
    contact: float

    @property
    def at_contact(self) -> bool:
        """Whether of the component's two roots this is the one next to the closest approach."""
        own, other = (
            abs(nearest_turn(q, self.contact) - self.contact) for q in (self.value, self.other)
        )
        return bool(own < other)

    @property
    def meets(self) -> bool:
        """Whether the points meet there, up to the rounding of the print."""
        return self.at_contact and self.distance <= self.allowed


@cache
def pair_bound(label: str, corrected_digit: bool = False) -> PairBound:
    """Compute a bound of a point pair from the print, with the corrected digit if asked."""
    of = corrected() if corrected_digit else robot()
    pair, component = _pair(label, of), paper.indices(label)[1] - 1
    vector = pair_vector(of, pair)
    (joint,) = vector.joints()
    value, plain = (_value(paper.TABLE_6[label], reading, of) for reading in ("atan2", "arctan"))
    c0, a, b = vector[component].along(joint, of.home)
    contact = closest_approach(of, pair).q
    roots = nearest_turn(circle_roots(a, b, -c0).q, contact)
    other = float(max(roots, key=lambda q: abs(nearest_turn(q, value) - value)))
    places = np.tile(of.home, (3, 1))
    places[:, joint] = value, plain, other
    there = vector(places)
    apart = np.linalg.norm(there, axis=-1)
    return PairBound(
        value=value,
        plain=plain,
        residual=float(abs(there[0, component])),
        plain_residual=float(abs(there[1, component])),
        distance=float(apart[0]),
        allowed=at_a_root(vector.gradient(places[0])[:, joint], component),
        other=other,
        other_distance=float(apart[2]),
        contact=contact,
    )


def _pair(label: str, of: Robot) -> Pair:
    return pairs(of)[paper.indices(label)[0] - 1]


def _value(text: str, reading: paper.Reading, of: Robot) -> float:
    """Return the value, rad, of a printed formula of offsets alone."""
    return float(paper.expression(text, arctan=reading).subs(offset_values(of)))


@computes_each({_id(label): label for label in paper.TABLE_6 if paper.indices(label)[0] < 5})
def bound_of_a_pair(label: str) -> Outcome:
    """Judge a bound as a root of its component on its side of home, at which a motion stops."""
    found, right = pair_bound(label), pair_bound(label, corrected_digit=True)
    placed = found.value > 0 if _side(label) == "upper" else found.value < 0
    is_root = placed and found.residual < RESIDUAL
    return Outcome(
        judge(
            holds=is_root and found.plain_residual < RESIDUAL and found.at_contact,
            amended=is_root,
        ),
        f"{degrees(found.value)}{_with_arctan(found)}: {_place(label, found, right)}",
    )


def _with_arctan(bound: PairBound) -> str:
    if bound.plain_residual < RESIDUAL:
        return ""
    return (
        f" with atan2; {degrees(bound.plain)} with arctan, where the component is"
        f" {bound.plain_residual:.2f} cm"
    )


def _place(label: str, bound: PairBound, right: PairBound) -> str:
    """Tell where the bound lies: at the contact, or at the component's other root."""
    root = "a root" if bound.residual < RESIDUAL else f"no root ({bound.residual:.2f} cm)"
    apart = f"{root} of the component, where the points are {bound.distance:.4f} cm apart"
    if bound.meets:
        return f"{apart}; rounding allows {bound.allowed:.4f} cm."
    if bound.at_contact:
        return (
            f"{apart}: of the two roots the one next to the contact, and the component vanishes"
            f" exactly. Rounding allows {bound.allowed:.4f} cm; with x_{{2,13}} = 9.09 they are"
            f" {right.distance:.4f} cm apart (T-4.2)."
        )
    return (
        f"{apart}, so that it stops no motion: the condition is to ask for a root by eq. (38) and"
        f" no more. They meet at the other root, {degrees(bound.other)},"
        f" up to {bound.other_distance:.4f} cm, inside the window"
        f"{_with_the_other_sign(label)}."
    )


def _with_the_other_sign(label: str) -> str:
    if not meets_at_the_other_root(label):
        return ""
    text = "; the formula with the other sign of cos⁻¹ gives it"
    if meets_at_the_other_root(label, robot()):
        return text
    return f"{text}, and with x_{{2,13}} = 9.09 (T-4.2) they meet there within the rounding"


def _other_sign(label: str) -> str:
    """Return the printed formula with the other sign before arccos: the other root."""
    text = paper.TABLE_6[label]
    old, new = ("- acos", "+ acos") if "- acos" in text else ("+ acos", "- acos")
    return text.replace(old, new)


def meets_at_the_other_root(label: str, of: Robot | None = None) -> bool:
    """Tell whether the points meet at the bound with the other sign before the arccosine.

    On the robot with the corrected digit, a finding of its own (T-4.2), unless told otherwise.
    """
    of = of or corrected()
    vector = pair_vector(of, _pair(label, of))
    (joint,) = vector.joints()
    q = np.array(of.home)
    q[joint] = _value(_other_sign(label), "atan2", of)
    apart = float(np.linalg.norm(vector(q)))
    return apart <= at_a_root(vector.gradient(q)[:, joint], paper.indices(label)[1] - 1)


# --- half-spaces ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class HalfSpaceBound:
    """A bound of a half-space over one turn of the first joint.

    Attributes
    ----------
    q : ndarray, shape (m, 2)
        Where it exists, rad.
    part : float
        Part of the turn where it exists, percent.
    residual : float
        Largest component there, cm.
    slope : ndarray, shape (m,)
        Of the component along the second joint, cm.
    """

    q: Floats
    part: float
    residual: float
    slope: Floats


@cache
def half_space_bound(label: str, n: int = 7200) -> HalfSpaceBound:
    """Compute a bound of a half-space from the print, but at its ends, where both bounds meet."""
    q1 = (np.arange(n) + 0.5) * (2 * np.pi / n) - np.pi
    with np.errstate(invalid="ignore"):
        q2 = printed_function(paper.TABLE_6[label])(q1)
    there = np.isfinite(q2)
    q = np.stack([q1[there], q2[there]], -1)
    form = _component(label)
    slope = form.gradient(q)[:, 1]
    return HalfSpaceBound(q, 100 * float(there.mean()), float(np.abs(form(q)).max()), slope)


@computes_each({_id(label): label for label in paper.TABLE_6 if paper.indices(label)[0] > 4})
def bound_of_a_half_space(label: str) -> Outcome:
    """Judge a bound as a root wherever eq. (36) gives one, at which the wall's limit ends."""
    found, is_upper = half_space_bound(label), _side(label) == "upper"
    is_end = bool((found.slope <= 0).all() if is_upper else (found.slope >= 0).all())
    text = (
        f"{limit_of(label)}By eq. (36) it exists for {found.part:.0f} % of a turn of the first"
        " joint: elsewhere the wall does not cut the circle of the second. There it is a root of"
        " the component, which is"
        f" {'positive' if is_end else 'negative'} just {'below' if is_upper else 'above'} it."
    )
    if not is_end and np.allclose(_ends_of_a_row(*paper.indices(label)[:2])[0], TURN):
        text += _copy_of_the_other(label)
    is_root = found.residual < RESIDUAL
    return Outcome(judge(holds=is_root and is_end, amended=is_root), text)


def limit_of(label: str) -> str:
    """Tell which limit is computed with, where the text leaves its unit open."""
    wall = robot().boundary(f"B{paper.indices(label)[0]}")
    if wall.name not in ("B5", "B6") or not isinstance(wall, HalfSpace):
        return ""
    return f"Computed with {wall.offset:g} cm; the unit is open (T-5.2). "


def _copy_of_the_other(label: str) -> str:
    """Tell that a bound is the row's other one a turn away, with a configuration between."""
    i, j, _ = paper.indices(label)
    q1 = NULL_AT.get(i, float(half_space_bound(label).q[0, 0]))
    upper, lower = (
        float(printed_function(paper.TABLE_6[f"beta_{{{i},{j},{k}}}"])(q1)) for k in (1, 2)
    )
    q2 = lower + np.pi / 2
    value = float(_component(label)([q1, q2]))
    q1, q2, low, high = (round(np.degrees(x), 9) + 0 for x in (q1, q2, lower, upper))
    end = " With + before cos⁻¹ it is the other root, the lower end." if is_lower_end(label) else ""
    return (
        " It is the upper bound minus one turn, the same pose. So the window excludes no value of"
        f" q_2: at q_1 = {q1:g}° it runs from {low:g}° to {high:g}°, and at q_2 = {q2:g}° in it the"
        f" component is {round(value, 9):g} cm.{end}"
    )


NULL_AT: Final = {5: 0.0, 6: np.pi}
"""Values of the first joint, rad, at which the argument of the inverse cosine is zero, exactly."""


def is_lower_end(label: str) -> bool:
    """Tell whether the bound with the other sign is a root above which the component rises."""
    q1 = half_space_bound(label).q[:, 0]
    q = np.stack([q1, printed_function(_other_sign(label))(q1)], -1)
    form = _component(label)
    return bool((form.gradient(q)[:, 1] >= 0).all() and np.abs(form(q)).max() < RESIDUAL)


def _component(label: str) -> HarmonicForm:
    i, j, _ = paper.indices(label)
    return components(robot(), robot().boundary(f"B{i}"))[j - 1]


# --- both bounds of a row -------------------------------------------------------------------------


@computes("E-39.1")
def rows_against_the_theorem() -> Outcome:
    rows = {name: _ends_of_a_row(*paper.indices(name)) for name in paper.EQUATION_29}
    a_turn_apart = [name for name, (length, _) in rows.items() if np.allclose(length, TURN)]
    both = [name for name in rows if name not in a_turn_apart]
    are_roots = all(residual < RESIDUAL for _, residual in rows.values())
    rest = " and ".join(paper.greek(name) for name in both)
    return Outcome(
        judge(holds=are_roots and not both, under=are_roots and bool(a_turn_apart)),
        f"{len(a_turn_apart)} of {len(rows)} rows are eq. (39), with θ by atan2: their two bounds"
        " are one root of the component, that of eq. (38), a full turn apart. Where that root is"
        f" not the one at which a motion stops, in the rows of {_of_the_other_root()}, the choice"
        f" comes from eq. (37) (E-37, T-6.4). The row of {rest} is not: its bounds"
        " are the two roots of its component, between which it is positive. No row is eq. (31),"
        " which is longer than a turn.",
    )


@computes("S-20.5")
def every_root_of_table_6() -> Outcome:
    rows = [_ends_of_a_row(*paper.indices(name))[0] for name in paper.EQUATION_29]
    both = sum(not np.allclose(length, TURN) for length in rows)
    return Outcome(
        judge(holds=both == len(rows), under=both == 0),
        f"{both} of {len(rows)} rows of Table 6 {'has' if both == 1 else 'have'} both roots of the"
        " component; the others have one of the two, twice, a full turn apart. So the rows do not"
        " treat their components alike, and half of the solutions of the ten are nowhere.",
    )


def _of_the_other_root() -> str:
    """Return the components whose lower bound would be right with the other sign."""
    found = []
    for i, j in (paper.indices(name) for name in paper.EQUATION_29):
        label = f"beta_{{{i},{j},2}}"
        if i < 5:
            wrong = not pair_bound(label).at_contact
        else:
            wrong = bool((half_space_bound(label).slope < 0).any())
        if wrong:
            found.append(f"β_{{{i},{j}}}")
    return ", ".join(found)


def _ends_of_a_row(i: int, j: int) -> tuple[Floats, float]:
    """Return how far the bounds of a row are apart, rad, and the component's largest value."""
    labels = [f"beta_{{{i},{j},{k}}}" for k in (1, 2)]
    if i < 5:
        upper, lower = map(pair_bound, labels)
        return np.array(upper.value - lower.value), max(upper.residual, lower.residual)
    above, below = map(half_space_bound, labels)
    return above.q[:, 1] - below.q[:, 1], max(above.residual, below.residual)
