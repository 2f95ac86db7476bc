"""The arms that are judged: the paper's robot as printed, and the variants for comparison."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from lizarraga2025 import printed as paper
from qbound import HalfSpace, HarmonicForm, Pair, Robot, clearance, components, load_robot, position
from qbound.symbols import joint_symbols, offset_values, with_symbols

if TYPE_CHECKING:
    import sympy as sp


@cache
def robot() -> Robot:
    """Return the paper's robot with the printed offsets."""
    return load_robot("minervabot-v2")


@cache
def corrected() -> Robot:
    """Return the robot with the one digit corrected: x_{2,13} = 9.09 cm."""
    return load_robot("minervabot-v2-corrected")


@cache
def symmetric() -> Robot:
    """Return the exactly symmetric robot behind the rounded offsets."""
    return load_robot("minervabot-v2-symmetric")


def rounded(of: Robot) -> Robot:
    """Return the robot with its offsets rounded to two decimals, as the tables print them."""
    points = tuple(replace(point, at=point.at.round(2)) for point in of.points)
    joints = tuple(replace(joint, origin=joint.origin.round(2)) for joint in of.joints)
    return replace(of, points=points, joints=joints)


@cache
def symbolic_robot() -> tuple[Robot, dict[sp.Symbol, float]]:
    """Return the robot with symbols for lengths, and their printed values in cm."""
    return with_symbols(robot()), offset_values(robot())


def printed_function(text: str, joints: int = 1) -> Callable[..., Any]:
    """Return a printed formula, its offsets put in, as a function of so many first joints."""
    import sympy as sp  # not at the top: chapters that only sample run without it

    form = paper.expression(text).subs(symbolic_robot()[1])
    names = joint_symbols(robot())[:joints]
    function: Callable[..., Any] = sp.lambdify(names, form, "numpy")
    return function


def in_millimetres(of: Robot) -> Robot:
    """Return an arm with points 12 and 13 in millimetres, as Table 4 prints them."""
    points = (replace(p, at=p.at / 10) if p.name in ("12", "13") else p for p in of.points)
    return replace(of, points=tuple(points))


def pairs(of: Robot | None = None) -> tuple[Pair, ...]:
    """Return the point pairs, of the paper's robot B1 to B4 (Tables 3 and 4)."""
    return tuple(b for b in (of or robot()).boundaries if isinstance(b, Pair))


@cache
def half_spaces() -> tuple[HalfSpace, ...]:
    """Return the three half-spaces, B5 to B7 (Table 5)."""
    return tuple(b for b in robot().boundaries if isinstance(b, HalfSpace))


@cache
def floor() -> HarmonicForm:
    """Return the height of the tool above its limit, cm (B7)."""
    return clearance(robot(), robot().boundary("B7"))


def every_component() -> list[HarmonicForm]:
    """Return the three components of each of the seven boundary functions, zeros among them."""
    vectors = [components(robot(), pair) for pair in pairs()]
    vectors += [components(robot(), half) for half in half_spaces()]
    return [vector[j] for vector in vectors for j in range(3)]


@cache
def tool_form() -> HarmonicForm:
    """Return the place of the tool, cm."""
    return position(robot(), robot().tool)
