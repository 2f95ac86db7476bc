"""The 22 bounds of Table 6, each from its printed formula."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lizarraga2025 import printed as paper
from lizarraga2025.ledger.entries import Finding, entry, judge, require
from lizarraga2025.ledger.facts import degrees, mended, pairs, robot
from lizarraga2025.ledger.rounding import at_a_root
from qbound import circle_roots, components, pair_vector
from qbound.boundary.functions import closest_approach
from qbound.forms.angles import nearest_turn
from qbound.model.robot import Robot, joint_symbols, with_symbols

Floats = NDArray[np.float64]

SIDES = {1: "upper", 2: "lower"}
RESIDUAL = 1e-9
"""A component, cm, below which its bound counts as a root: offsets carry 1e-2, roundoff 1e-14."""


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


@cache
def pair_bound(label: str, mend: bool = False) -> PairBound:
    """Compute a bound of a point pair from the print, with the mended digit if asked."""
    of = mended() if mend else robot()
    pair = pairs(of)[int(label[6]) - 1]
    component = int(label[8]) - 1
    vector = pair_vector(of, pair)
    (joint,) = vector.joints()
    value, plain = (float(formula(label, reading, of)) for reading in ("atan2", "arctan"))
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


def formula(label: str, reading: paper.Reading, of: Robot | None = None) -> Any:
    """Return the printed formula with the printed offsets put in: a number, or one of q_1."""
    return paper.expression(paper.TABLE_6[label], arctan=reading).subs(
        with_symbols(of or robot())[1]
    )


def _pair_entry(label: str, side: str) -> Callable[[], Finding]:
    def bound() -> Finding:
        found, right = pair_bound(label), pair_bound(label, mend=True)
        k = int(label[10])
        placed = found.value > 0 if k == 1 else found.value < 0
        is_root = found.residual < RESIDUAL
        as_printed = is_root and found.plain_residual < RESIDUAL
        meets = found.at_contact and found.distance <= found.allowed
        met = right.at_contact and right.distance <= right.allowed
        text = f"{degrees(found.value)} with atan2"
        if not as_printed:
            text += f"; {degrees(found.plain)} with arctan, where the component is"
            text += f" {found.plain_residual:.2f} cm"
        text += f". The component vanishes there and the points are {found.distance:.4f} cm apart"
        text += f"; rounding allows {found.allowed:.4f} cm."
        if met and not meets:
            text += f" With x_{{2,13}} = 9.09 they are {right.distance:.4f} cm apart."
        if not found.at_contact:
            require(*_mended_pair_bound(label))
            text += f" They meet at the root left out, {degrees(found.other)},"
            text += f" {found.other_distance:.4f} cm apart."
        return Finding(
            judge(holds=placed and as_printed and meets, under=placed and is_root and met), text
        )

    return bound


def _other_sign(label: str) -> str:
    """Return the printed formula with the other sign before arccos: the other root."""
    text = paper.TABLE_6[label]
    old, new = ("- acos", "+ acos") if "- acos" in text else ("+ acos", "- acos")
    return text.replace(old, new)


def _mended_pair_bound(label: str) -> tuple[bool, str]:
    """Tell whether the points meet at the bound with the sign (and the digit) mended."""
    of = mended()
    pair = pairs(of)[int(label[6]) - 1]
    vector = pair_vector(of, pair)
    (joint,) = vector.joints()
    q = np.array(of.home)
    q[joint] = float(paper.expression(_other_sign(label), arctan="atan2").subs(with_symbols(of)[1]))
    apart = float(np.linalg.norm(vector(q)))
    allowed = at_a_root(vector.gradient(q)[:, joint], int(label[8]) - 1)
    return apart <= allowed, f"with the other sign the points of {label} meet"


# --- walls ----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class WallBound:
    """A bound of a wall over one turn of the first joint.

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
def wall_bound(label: str, n: int = 7200) -> WallBound:
    """Compute a bound of a wall from the print; the fold at its ends, where both meet, left out."""
    q1 = (np.arange(n) + 0.5) * (2 * np.pi / n) - np.pi
    with np.errstate(invalid="ignore"):
        q2 = _of_q1(label)(q1)
    there = np.isfinite(q2)
    q = np.stack([q1[there], q2[there]], -1)
    form = components(robot(), robot().boundary(f"B{label[6]}"))[int(label[8]) - 1]
    slope = form.gradient(q)[:, 1]
    return WallBound(q, 100 * float(there.mean()), float(np.abs(form(q)).max()), slope)


def _wall_entry(label: str, side: str) -> Callable[[], Finding]:
    def bound() -> Finding:
        found = wall_bound(label)
        falls, rises = (found.slope <= 0).all(), (found.slope >= 0).all()
        right_side = bool(falls if side == "upper" else rises)
        beyond = "below" if side == "upper" else "above"
        sign = "positive" if right_side else "negative"
        if not right_side:
            require(*_mended_wall_bound(label))
        return Finding(
            judge(
                holds=found.part == 100 and right_side,
                under=found.residual < RESIDUAL and right_side,
            ),
            f"A root of the component for the {found.part:.1f} % of a turn of the first joint where"
            " it exists: elsewhere the wall does not cut the circle of the second joint. The"
            f" component is {sign} just {beyond} it."
            + ("" if right_side else _counterexample(label)),
        )

    return bound


def _counterexample(label: str) -> str:
    """Name a configuration inside the printed window whose component is negative, exactly."""
    q1 = {"5": 0.0, "6": np.pi}[label[6]]  # the wall's constant vanishes there
    upper, lower = (float(_of_q1(f"{label[:10]}{k}}}")(q1)) for k in (1, 2))
    q2 = lower + np.pi / 2
    value = float(components(robot(), robot().boundary(f"B{label[6]}"))[0]([q1, q2]))
    q1, q2, low, high = (round(np.degrees(x), 9) + 0 for x in (q1, q2, lower, upper))
    return (
        f" At q1 = {q1:g}° the printed window runs from {low:g}° to {high:g}°; at q2 = {q2:g}° in"
        f" it the component is {round(value, 9):g} cm."
    )


def _mended_wall_bound(label: str) -> tuple[bool, str]:
    """Tell whether the bound with the sign mended is a root above which the component rises."""
    q1 = wall_bound(label).q[:, 0]
    q = np.stack([q1, _of_q1(label, _other_sign(label))(q1)], -1)
    form = components(robot(), robot().boundary(f"B{label[6]}"))[0]
    rises = bool((form.gradient(q)[:, 1] >= 0).all() and np.abs(form(q)).max() < RESIDUAL)
    return rises, f"with the other sign {label} is the lower end of the arc"


def _of_q1(label: str, text: str | None = None) -> Callable[[Any], Any]:
    """Return a bound of a wall, the printed one if no other is given, as a function of q_1."""
    import sympy as sp

    bound = paper.expression(text or paper.TABLE_6[label]).subs(with_symbols(robot())[1])
    function: Callable[[Any], Any] = sp.lambdify(joint_symbols(robot())[0], bound, "numpy")
    return function


MENDED = {
    "beta_{2,3": "+ arccos in place of - arccos: the other root, at which the points meet.",
    "beta_{4,3": "+ arccos in place of - arccos: the other root, at which the points meet.",
    "beta_{4,1": "The same formula with x_{2,13} = 9.09 cm.",
    "beta_{5,1": "β_{5,1,2} = -q_1 - π + arccos(...): the other root, as in the row of β_{7,3}.",
    "beta_{6,1": "β_{6,1,2} = -q_1 - π + arccos(...): the other root, as in the row of β_{7,3}.",
}

for _label in paper.TABLE_6:
    _i, _j, _k = int(_label[6]), int(_label[8]), int(_label[10])
    _wall = _i > 4
    entry(
        f"B-{_i}.{_j}.{_k}",
        "bound",
        f"Table 6, β_{{{_i},{_j},{_k}}}",
        f"The {SIDES[_k]} bound of q_{1 if _i < 3 else 2} from the {'xyz'[_j - 1]} component"
        f" of B_{_i}.",
        test="test_paper_rule.py::test_printed_rows_5_to_7_are_among_the_derived_roots"
        if _wall
        else "test_paper_rule.py::test_a_bound_is_a_root_of_its_component",
        chapter="06_theorem_2#the-walls" if _wall else "06_theorem_2#tab-pair-bounds",
        mended=MENDED.get(_label[:9], ""),
    )((_wall_entry if _wall else _pair_entry)(_label, SIDES[_k]))
