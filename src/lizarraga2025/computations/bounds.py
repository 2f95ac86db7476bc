"""The 22 bounds of Table 6, each from its printed formula."""

from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence.arms import corrected, pairs, printed_function, robot
from lizarraga2025.evidence.rounding import at_a_root, degrees
from lizarraga2025.verdicts import Outcome, formula, judge, of_readings, reading
from qbound import HarmonicForm, Robot
from qbound.arrays import Floats
from qbound.boundary import closest_approach, components, pair_vector
from qbound.circle import TURN, nearest_turn, roots_along
from qbound.symbols import offset_values

RESIDUAL = 1e-9
"""A component, cm, below which its bound counts as a root: offsets carry 1e-2, roundoff 1e-14."""


def id_of(label: str) -> str:
    """Return the entry of a bound: B-2.1.2 of beta_{2,1,2}."""
    return "B-{}.{}.{}".format(*paper.indices(label))


def labels_of(i: int, j: int) -> tuple[str, str]:
    """Return the labels of a row of Table 6, upper bound first."""
    return f"beta_{{{i},{j},1}}", f"beta_{{{i},{j},2}}"


def with_the_other_sign(label: str) -> str:
    """Return the printed formula with the other sign before arccos: the other root."""
    text = paper.TABLE_6[label]
    old, new = ("- acos", "+ acos") if "- acos" in text else ("+ acos", "- acos")
    return text.replace(old, new)


# --- point pairs ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class PairBound:
    """A bound of a point pair, computed from its printed formula.

    Attributes
    ----------
    value, plain : float
        With atan2, and with the arctangent, rad.
    residual, plain_residual : float
        The component there, cm, in either reading.
    other : float
        The component's other root, turned next to the closest approach, rad.
    distance, other_distance : float
        Distance of the two points at `value` and at `other`, cm.
    allowed : float
        Distance that rounding of the offsets can leave at a root where the points meet, cm.
    contact : float
        Joint value of the closest approach, rad.
    """

    value: float
    plain: float
    residual: float
    plain_residual: float
    other: float
    distance: float
    other_distance: float
    allowed: float
    contact: float

    @property
    def at_contact(self) -> bool:
        """Whether of the component's two roots this is the one next to the closest approach."""
        roots = (self.value, self.other)
        own, other = (abs(nearest_turn(q, self.contact) - self.contact) for q in roots)
        return bool(own < other)


@cache
def pair_bound(label: str, text: str = "", of: Robot | None = None) -> PairBound:
    """Compute a bound of a pair from the print, from another formula, or for another arm."""
    of, text = of or robot(), text or paper.TABLE_6[label]
    i, j, _ = paper.indices(label)
    vector, nearest = pair_vector(of, pairs(of)[i - 1]), closest_approach(of, pairs(of)[i - 1])
    value, plain = (
        float(paper.expression(text, arctan=arctan).subs(offset_values(of)))
        for arctan in ("atan2", "arctan")
    )
    roots = nearest_turn(roots_along(vector[j - 1], nearest.joint, of.home), nearest.q)
    other = float(max(roots, key=lambda q: abs(nearest_turn(q, value) - value)))
    places = np.tile(of.home, (3, 1))
    places[:, nearest.joint] = value, plain, other
    there, slope = vector(places), vector.gradient(places[0])[:, nearest.joint]
    residual, plain_residual, _ = np.abs(there[:, j - 1]).tolist()
    distance, _, other_distance = np.linalg.norm(there, axis=-1).tolist()
    return PairBound(
        *(value, plain, residual, plain_residual, other, distance, other_distance),
        allowed=at_a_root(slope, j - 1),
        contact=nearest.q,
    )


@computes_each({id_of(label): label for label in paper.TABLE_6 if paper.indices(label)[0] < 5})
def bound_of_a_pair(label: str) -> Outcome:
    """Judge a bound as a root of its component on its side of home, at which a motion stops."""
    found = pair_bound(label)
    placed = found.value > 0 if label.endswith("1}") else found.value < 0
    is_root = placed and found.residual < RESIDUAL
    root = "a root" if found.residual < RESIDUAL else f"no root ({found.residual:.2f} cm)"
    text = degrees(found.value)
    if found.plain_residual >= RESIDUAL:
        text += f" with atan2; {degrees(found.plain)} with arctan, where the component is"
        text += f" {found.plain_residual:.2f} cm"
    text += f": {root} of the component, where the points are {found.distance:.4f} cm apart"
    if not found.at_contact:
        text += f"; they come closest at the other root, {degrees(found.other)}, to"
        text += f" {found.other_distance:.4f} cm, inside the window"
        if meets_at_the_other_root(label):
            text += "; the formula with the other sign of cos⁻¹ gives it"
    else:
        text += f"; rounding allows {found.allowed:.4f} cm"
        if found.distance > found.allowed:
            without_slip = pair_bound(label, of=corrected())
            text += f", and with x_{{2,13}} = 9.09 (T-4.2) it is {without_slip.distance:.4f} cm"
    return formula(
        holds=is_root and found.plain_residual < RESIDUAL and found.at_contact,
        amended=is_root,
        computed=f"{text}.",
    )


def meets_at_the_other_root(label: str) -> bool:
    """Tell whether the points meet at the bound with the other sign before the arccosine.

    On the robot with the corrected digit, a finding of its own (T-4.2).
    """
    other = pair_bound(label, with_the_other_sign(label), corrected())
    return other.distance <= other.allowed


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

    def is_end(self, label: str) -> bool:
        """Whether the component falls there, for an upper bound, or rises, for a lower one."""
        return bool((self.slope <= 0 if label.endswith("1}") else self.slope >= 0).all())


@cache
def half_space_bound(label: str, text: str = "", n: int = 7200) -> HalfSpaceBound:
    """Compute a bound of a half-space from the print, but at its ends, where both bounds meet."""
    q1 = (np.arange(n) + 0.5) * (2 * np.pi / n) - np.pi
    with np.errstate(invalid="ignore"):
        q2 = printed_function(text or paper.TABLE_6[label])(q1)
    there = np.isfinite(q2)
    q, form = np.stack([q1[there], q2[there]], -1), component_of(label)
    residual = float(np.abs(form(q)).max())
    return HalfSpaceBound(q, 100 * float(there.mean()), residual, form.gradient(q)[:, 1])


def component_of(label: str) -> HarmonicForm:
    """Return the component that a bound is of."""
    i, j, _ = paper.indices(label)
    return components(robot(), robot().boundary(f"B{i}"))[j - 1]


@computes_each({id_of(label): label for label in paper.TABLE_6 if paper.indices(label)[0] > 4})
def bound_of_a_half_space(label: str) -> Outcome:
    """Judge a bound as a root wherever eq. (36) gives one, at which the wall's limit ends."""
    found, (i, j, k) = half_space_bound(label), paper.indices(label)
    text = f"{limit_of(label)}By eq. (36) it exists for {found.part:.0f} % of a turn of the first"
    text += " joint. There it is a root of the component, which is"
    text += f" {'positive' if found.is_end(label) else 'negative'} just"
    text += f" {'below' if k == 1 else 'above'} it."
    if not found.is_end(label) and np.allclose(ends_of_a_row(i, j)[0], TURN):
        text += " It is the upper bound minus one turn, the same pose, so the window excludes no"
        text += f" value of q_2. {_negative_between(label)}"
        if is_lower_end(label):
            text += " With + before cos⁻¹ it is the other root, the lower end."
    is_root = found.residual < RESIDUAL
    return formula(holds=is_root and found.is_end(label), amended=is_root, computed=text)


def limit_of(label: str) -> str:
    """Tell which limit is computed with, where the text leaves its unit open."""
    wall = robot().boundary(f"B{paper.indices(label)[0]}")
    if wall.name not in ("B5", "B6"):
        return ""
    return f"Computed with {wall.offset:g} cm; the unit is open (T-5.2). "


def _negative_between(label: str) -> str:
    """Tell a configuration between the bounds of a row, and the component there."""
    i, j, _ = paper.indices(label)
    q1 = NULL_AT.get(i, float(half_space_bound(label).q[0, 0]))
    upper, lower = (float(printed_function(paper.TABLE_6[x])(q1)) for x in labels_of(i, j))
    q2 = lower + np.pi / 2
    value = round(float(component_of(label)([q1, q2])), 9)
    q1, q2, low, high = (round(np.degrees(x), 9) + 0 for x in (q1, q2, lower, upper))
    return (
        f"At q_1 = {q1:g}° it runs from {low:g}° to {high:g}°, and at q_2 = {q2:g}° in it the"
        f" component is {value:g} cm."
    )


NULL_AT: Final = {5: 0.0, 6: np.pi}
"""Values of the first joint, rad, at which the argument of the inverse cosine is zero, exactly."""


def is_lower_end(label: str) -> bool:
    """Tell whether the bound with the other sign is a root above which the component rises."""
    other = half_space_bound(label, with_the_other_sign(label))
    return other.is_end(label) and other.residual < RESIDUAL


# --- both bounds of a row -------------------------------------------------------------------------


@cache
def ends_of_a_row(i: int, j: int) -> tuple[Floats, float]:
    """Return how far the bounds of a row are apart, rad, and the component's largest value."""
    if i < 5:
        upper, lower = map(pair_bound, labels_of(i, j))
        return np.array(upper.value - lower.value), max(upper.residual, lower.residual)
    above, below = map(half_space_bound, labels_of(i, j))
    return above.q[:, 1] - below.q[:, 1], max(above.residual, below.residual)


def _rows() -> tuple[list[str], bool]:
    """Return the rows whose bounds are not a turn apart, and whether all bounds are roots."""
    rows = {name: ends_of_a_row(*paper.indices(name)) for name in paper.EQUATION_29}
    both = [name for name, (length, _) in rows.items() if not np.allclose(length, TURN)]
    return both, all(residual < RESIDUAL for _, residual in rows.values())


@computes("E-39.1")
def rows_against_the_theorem() -> Outcome:
    both, are_roots = _rows()
    total, rest = len(paper.EQUATION_29), " and ".join(map(paper.greek, both))
    other = []
    for i, j in map(paper.indices, paper.EQUATION_29):
        lower = f"beta_{{{i},{j},2}}"
        right = pair_bound(lower).at_contact if i < 5 else half_space_bound(lower).is_end(lower)
        other += [] if right else [f"β_{{{i},{j}}}"]
    return Outcome(
        judge(holds=are_roots and not both, under=are_roots and len(both) < total),
        f"{total - len(both)} of {total} rows are eq. (39), with θ by atan2: their two bounds are"
        " one root of the component, that of eq. (38), a full turn apart, which is not the one at"
        f" which a motion stops in the rows of {', '.join(other)} (T-6.4). The bounds in the row of"
        f" {rest} are the two roots of its component, between which it is positive.",
    )


@computes("S-20.5")
def every_root_of_table_6() -> Outcome:
    both, are_roots = _rows()
    return of_readings(
        f"Of {len(paper.EQUATION_29)} rows of Table 6 the bounds are both roots of the component in"
        f" {len(both)}; in the others one of the two stands twice, a full turn apart."
        " The sides of the region and its six corners are among the bounds, with atan2 (S-20.3).",
        reading("every root of every component", holds=len(both) == len(paper.EQUATION_29)),
        reading("the sides of the feasible region", holds=False, under=are_roots),
    )
