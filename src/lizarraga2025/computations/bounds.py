"""The 22 bounds of Table 6, each from its printed formula."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes_each
from lizarraga2025.evidence.arms import corrected, pairs, robot
from lizarraga2025.evidence.rounding import at_a_root, degrees
from lizarraga2025.verdicts import Outcome, judge, require
from qbound import HarmonicForm, circle_roots, components, pair_vector
from qbound.boundary.functions import closest_approach
from qbound.forms.angles import nearest_turn
from qbound.model.robot import Pair, Robot
from qbound.symbols import joint_symbols, with_symbols

Floats = NDArray[np.float64]

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
    contact = closest_approach(of, pair)[0]
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
    return float(paper.expression(text, arctan=reading).subs(with_symbols(of)[1]))


@computes_each({_id(label): label for label in paper.TABLE_6 if paper.indices(label)[0] < 5})
def bound_of_a_pair(label: str) -> Outcome:
    found, right = pair_bound(label), pair_bound(label, corrected_digit=True)
    placed = found.value > 0 if _side(label) == "upper" else found.value < 0
    is_root = found.residual < RESIDUAL
    as_printed = is_root and found.plain_residual < RESIDUAL
    text = f"{degrees(found.value)} with atan2"
    if not as_printed:
        text += f"; {degrees(found.plain)} with arctan, where the component is"
        text += f" {found.plain_residual:.2f} cm"
    text += f". The component vanishes there and the points are {found.distance:.4f} cm apart"
    text += f"; rounding allows {found.allowed:.4f} cm."
    if right.meets and not found.meets:
        text += f" With x_{{2,13}} = 9.09 they are {right.distance:.4f} cm apart."
    if not found.at_contact:
        require(_meets_at_the_other_root(label), f"with the other sign the points of {label} meet")
        text += f" They meet at the root left out, {degrees(found.other)},"
        text += f" {found.other_distance:.4f} cm apart."
    return Outcome(
        judge(
            holds=placed and as_printed and found.meets, under=placed and is_root and right.meets
        ),
        text,
    )


def _other_sign(label: str) -> str:
    """Return the printed formula with the other sign before arccos: the other root."""
    text = paper.TABLE_6[label]
    old, new = ("- acos", "+ acos") if "- acos" in text else ("+ acos", "- acos")
    return text.replace(old, new)


def _meets_at_the_other_root(label: str) -> bool:
    """Tell whether the points meet at the bound with the sign (and the digit) corrected."""
    of = corrected()
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
        q2 = _of_q1(paper.TABLE_6[label])(q1)
    there = np.isfinite(q2)
    q = np.stack([q1[there], q2[there]], -1)
    form = _component(label)
    slope = form.gradient(q)[:, 1]
    return HalfSpaceBound(q, 100 * float(there.mean()), float(np.abs(form(q)).max()), slope)


@computes_each({_id(label): label for label in paper.TABLE_6 if paper.indices(label)[0] > 4})
def bound_of_a_half_space(label: str) -> Outcome:
    found, is_upper = half_space_bound(label), _side(label) == "upper"
    right_side = bool((found.slope <= 0).all() if is_upper else (found.slope >= 0).all())
    if not right_side:
        require(_is_lower_end(label), f"with the other sign {label} is the lower end of the arc")
    return Outcome(
        judge(
            holds=found.part == 100 and right_side, under=found.residual < RESIDUAL and right_side
        ),
        f"A root of the component for the {found.part:.1f} % of a turn of the first joint where it"
        " exists: elsewhere the wall does not cut the circle of the second joint. The component is"
        f" {'positive' if right_side else 'negative'} just {'below' if is_upper else 'above'}"
        f" it.{'' if right_side else _counterexample(label)}",
    )


def _counterexample(label: str) -> str:
    """Name a configuration inside the printed window whose component is negative, exactly."""
    i, j, _ = paper.indices(label)
    q1 = {5: 0.0, 6: np.pi}[i]  # the half-space's constant vanishes there
    upper, lower = (float(_of_q1(paper.TABLE_6[f"beta_{{{i},{j},{k}}}"])(q1)) for k in (1, 2))
    q2 = lower + np.pi / 2
    value = float(_component(label)([q1, q2]))
    q1, q2, low, high = (round(np.degrees(x), 9) + 0 for x in (q1, q2, lower, upper))
    return (
        f" At q1 = {q1:g}° the printed window runs from {low:g}° to {high:g}°; at q2 = {q2:g}° in"
        f" it the component is {round(value, 9):g} cm."
    )


def _is_lower_end(label: str) -> bool:
    """Tell whether the bound with the other sign is a root above which the component rises."""
    q1 = half_space_bound(label).q[:, 0]
    q = np.stack([q1, _of_q1(_other_sign(label))(q1)], -1)
    form = _component(label)
    return bool((form.gradient(q)[:, 1] >= 0).all() and np.abs(form(q)).max() < RESIDUAL)


def _component(label: str) -> HarmonicForm:
    i, j, _ = paper.indices(label)
    return components(robot(), robot().boundary(f"B{i}"))[j - 1]


def _of_q1(text: str) -> Callable[[Any], Any]:
    """Return a printed formula, or one like it, as a function of q_1."""
    import sympy as sp

    bound = paper.expression(text).subs(with_symbols(robot())[1])
    function: Callable[[Any], Any] = sp.lambdify(joint_symbols(robot())[0], bound, "numpy")
    return function
