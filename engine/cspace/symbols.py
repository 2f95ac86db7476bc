"""A robot with letters for its lengths and joint values: its forms are then printed formulas."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from cspace.arrays import Array
from cspace.extras import require
from cspace.model.robot import Robot
from qbound.arrays import whole_numbers

if TYPE_CHECKING:
    import sympy


def joint_symbols(robot: Robot) -> tuple[sympy.Symbol, ...]:
    r"""Return a real SymPy symbol for each joint: :math:`q_1, q_2, \ldots`."""
    require("sympy")
    import sympy

    return tuple(sympy.Symbol(_subscripted(joint.name), real=True) for joint in robot.joints)


def with_symbols(robot: Robot) -> tuple[Robot, dict[sympy.Symbol, float]]:
    r"""Replace every non-zero offset by its label, such as :math:`x_{a,b}` (rule 8 of Section 2).

    The offset of a half-space along an axis becomes :math:`x_{\min,1}, x_{\min,2}, \ldots` as in
    Table 5.

    Returns
    -------
    Robot
        The same robot with SymPy symbols for lengths; its forms are the printed formulas.
    dict
        The value of each symbol, in the robot's length unit.
    """
    require("sympy")
    values: dict[sympy.Symbol, float] = {}
    joints = tuple(
        replace(j, origin=_labelled(j.parent, j.frame, j.origin, values)) for j in robot.joints
    )
    points = tuple(replace(p, at=_labelled(p.frame, p.name, p.at, values)) for p in robot.points)
    exact = tuple(
        replace(j, axis=whole_numbers(j.axis), mount=whole_numbers(j.mount)) for j in joints
    )
    label = _numbered(values)
    boundaries = tuple(boundary.with_labels(label) for boundary in robot.boundaries)
    return replace(robot, joints=exact, points=points, boundaries=boundaries), values


def _labelled(a: str, b: str, vector: Array, values: dict[sympy.Symbol, float]) -> Array:
    import sympy

    result = np.zeros(3, dtype=object)
    for i, (letter, value) in enumerate(zip("xyz", vector, strict=True)):
        if value:
            symbol = sympy.Symbol(f"{letter}_{{{a},{b}}}", real=True)
            result[i], values[symbol] = symbol, float(value)
    return result


def _numbered(values: dict[sympy.Symbol, float]) -> Callable[[str, float], sympy.Symbol]:
    """Return a function that makes labels x_{min,1}, x_{min,2}, ..., and notes their values."""
    import sympy

    counts: Counter[str] = Counter()

    def label(letter: str, value: float) -> sympy.Symbol:
        counts[letter] += 1
        symbol = sympy.Symbol(f"{letter}_{{min,{counts[letter]}}}", real=True)
        values[symbol] = value
        return symbol

    return label


def _subscripted(name: str) -> str:
    letters = name.rstrip("0123456789")
    return f"{letters}_{name[len(letters) :]}" if letters and letters != name else name
