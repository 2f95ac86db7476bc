r"""Forms along the lift: their roots (Theorem 2), and the formulas whose zeros are events.

One of the two joints is the base, with value t, the other the lift, with value v. A form is

.. math:: f(t, v) = \sum_{i, j} c_{ij} \, e_i(t) \, e_j(v),

with e = (1, cos, sin) for a joint that turns and (1, x, x²) for one that slides. Over a fixed t
the form has three coefficients along the lift, ``a = (a0, a1, a2)``. Formulas of these are written
once, for numbers, arrays, arrays with errors, and polynomials alike.

Over a fixed base value a form has at most two roots, up to full turns: one where it rises through
zero and one where it falls. The name (form, slope) of a root does not change between two events,
also where a quadratic becomes linear (sentence 1).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from cspace.arrays import Array, Bools, Floats
from cspace.tolerances import UNIT
from qbound.circle import TURN

LOW, HIGH = -1, -2
"""In place of a curve: the lower and the upper end of the lift."""


def basis(turns: bool, x: Any) -> Floats:
    """Return (1, cos x, sin x) of a joint that turns, (1, x, x²) of one that slides: (3, ...)."""
    found = np.empty((3, *np.shape(x)))
    found[0] = 1.0
    found[1], found[2] = (np.cos(x), np.sin(x)) if turns else (x, x * x)
    return found


def lift_roots(turns: bool, c: Array, double: Bools) -> Floats:
    """Return the rising and the falling root of coefficients c, (3, ...) to (2, ...) (sentence 1).

    At a fold both roots are one. Where there is no root, the place of the fold stands for both.

    Parameters
    ----------
    double : ndarray of bool
        Forms whose roots are one over every base value: their difference is only rounding.
    """
    if turns:  # Theorem 2: theta - arccos and theta + arccos
        ratio = -c[0] / np.sqrt(np.maximum(c[1] * c[1] + c[2] * c[2], 1e-300))
        ratio = np.where(double, np.sign(ratio), np.minimum(np.maximum(ratio, -1.0), 1.0))
        theta, alpha = np.arctan2(c[2], c[1]), np.arccos(ratio)
        return np.stack([theta - alpha, theta + alpha])
    root = np.sqrt(np.where(double, 0.0, np.maximum(c[1] * c[1] - 4 * c[0] * c[2], 0)))
    half = -(c[1] + np.copysign(root, c[1])) / 2  # no cancellation
    with np.errstate(all="ignore"):
        one, other = half / c[2], c[0] / half
    other = np.where(((half == 0) | double) & (c[2] != 0), one, other)  # a double root at zero
    return np.where(np.signbit(c[1]), [one, other], [other, one])  # slope c1 + 2 c2 v


def nearest(v: Floats, other: Floats) -> Floats:
    """Return angles, each moved by full turns to within half a turn of another angle."""
    return np.asarray(v - TURN * np.rint((v - other) / TURN))


def fold(a: Any, turns: bool, minus: int = -1) -> Any:
    """Return what is positive where a form has two roots, and zero where they are one (sentence 2).

    Here and below ``minus=1`` makes of bounds of coefficients a bound of the value (`blur`).
    """
    if turns:
        return a[1] * a[1] + a[2] * a[2] + minus * (a[0] * a[0])
    return a[1] * a[1] + 4 * minus * (a[0] * a[2])


def crossed(a: Any, b: Any, minus: int = -1) -> tuple[Any, Any, Any]:
    """Return the cross product of the coefficients of two forms, zero where they are parallel.

    Curves that coincide have a resultant that is zero, but not this (sentence 4).
    """
    return (
        a[1] * b[2] + minus * (a[2] * b[1]),
        a[2] * b[0] + minus * (a[0] * b[2]),
        a[0] * b[1] + minus * (a[1] * b[0]),
    )


def resultant(a: Any, b: Any, turns: bool, minus: int = -1) -> Any:
    """Return what vanishes exactly where two forms share a root, maybe complex (sentence 2)."""
    x, y, z = crossed(a, b, minus)
    return y * y + z * z + minus * (x * x) if turns else y * y + minus * (z * x)


def parallel_resultant(a: Any, b: Any, minus: int = -1) -> Any:
    """Return the same for two forms whose amplitudes (a1, a2) and (b1, b2) are parallel.

    Their resultant is a square: this is its root, times the amplitude of b.
    """
    both, own = a[1] * b[1] + a[2] * b[2], b[1] * b[1] + b[2] * b[2]
    return b[0] * both + minus * (a[0] * own)


def blur(formula: Any, *bounds: Floats) -> Floats:
    """Bound the error of a formula's value (sentence 3).

    Parameters
    ----------
    bounds : ndarray, shape (3, 2, n)
        What the coefficients of each form do not exceed, without and with their errors: a formula
        without a minus sign grows with each of them.
    """
    least, most = formula(*bounds, 1)
    return np.asarray(most - least + 16 * UNIT * most)


def along_base(turns: bool, tables: Floats) -> Floats:
    """Return the derivative by the base of forms (n, 3, 3), base before lift."""
    none = np.zeros_like(tables[:, 0])
    if turns:
        return np.stack([none, tables[:, 2], -tables[:, 1]], axis=1)
    return np.stack([tables[:, 1], 2 * tables[:, 2], none], axis=1)
