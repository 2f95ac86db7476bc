"""What many entries start from, computed once: the paper's robot, its symbols, its region."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qbound import load_robot
from qbound.model.robot import HalfSpace, Pair, Robot, with_symbols
from qbound.region import paper_rule

if TYPE_CHECKING:
    import sympy

Floats = NDArray[np.float64]

SMALL = 1e-9
"""A length (cm) or angle (rad) that is rounding: offsets carry 1e-2, roundoff leaves 1e-13."""


@cache
def robot() -> Robot:
    """Return the paper's robot with the printed offsets."""
    return load_robot("minervabot-v2")


@cache
def mended() -> Robot:
    """Return the robot with the one digit mended: x_{2,13} = 9.09 cm."""
    return load_robot("minervabot-v2-mended")


def pairs(of: Robot | None = None) -> tuple[Pair, ...]:
    """Return the point pairs, of the paper's robot B1 to B4 (Tables 3 and 4)."""
    return tuple(b for b in (of or robot()).boundaries if isinstance(b, Pair))


@cache
def walls() -> tuple[HalfSpace, ...]:
    """Return the three half-spaces, B5 to B7 (Table 5)."""
    return tuple(b for b in robot().boundaries if isinstance(b, HalfSpace))


@cache
def lettered() -> tuple[Robot, dict[sympy.Symbol, float]]:
    """Return the robot with symbols for lengths, and their printed values in cm."""
    return with_symbols(robot())


@cache
def vertices() -> Floats:
    """Return the six points of Figure 5, rad, shape (6, 2)."""
    return np.array([corner.q for corner in paper_rule.vertices(robot())])


@cache
def square(n: int = 360) -> Floats:
    """Return the middles of an n by n grid of one turn of both joints, rad, shape (n, n, 2)."""
    middles = (np.arange(n) + 0.5) * (2 * np.pi / n) - np.pi
    return np.stack(np.meshgrid(middles, middles, indexing="ij"), axis=-1)


def degrees(angle: Any) -> str:
    """Write an angle in rad as degrees with four decimals."""
    return f"{np.degrees(float(angle)):.4f}°"
