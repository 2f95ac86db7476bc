"""Numbers with a proved error: balls, and cosines and sines of arrays of doubles.

The balls are Arb's, through python-flint; a `HarmonicForm` takes them as it takes floats. Precision
is global to the process: it is set within a ``with`` only, by `precision`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from math import factorial
from typing import TYPE_CHECKING, Any

import numpy as np

from cspace.arrays import Array, Floats
from cspace.forms.factors import FACTORS
from qbound.forms import Kind

if TYPE_CHECKING:
    import flint

    arb = flint.arb
else:
    arb = Any  # only for annotations: python-flint is loaded when first called


def precision(bits: int) -> AbstractContextManager[None]:
    """Return python-flint's context in which balls have `bits` bits."""
    from flint import ctx

    context: AbstractContextManager[None] = ctx.workprec(bits)
    return context


def ball(value: Any) -> arb:
    """Return a number as a ball: a double is the binary fraction that it is, not a decimal."""
    from flint import arb

    return value if isinstance(value, arb) else arb(value)


def balls(numbers: Any) -> Array:
    """Return an array of numbers as an array of balls."""
    return np.asarray(np.vectorize(ball, otypes=[object])(numbers))


def pi() -> arb:
    """Return pi at the precision at hand."""
    from flint import arb

    return arb.pi()


def turns(count: int) -> arb:
    """Return `count` full turns, rad."""
    return 2 * count * pi()


def below(value: arb) -> float:
    """Return a double that is certainly not above a ball."""
    return math.nextafter(float(value.lower()), -math.inf)


def above(value: arb) -> float:
    """Return a double that is certainly not below a ball."""
    return math.nextafter(float(value.upper()), math.inf)


def line_roots(kind: Kind, c: Sequence[arb] | Array) -> list[arb] | None:
    """Solve c0 + c1 cos v + c2 sin v = 0, or c0 + c1 v + c2 v² = 0; None if perhaps double."""
    c0, c1, c2 = c
    slides = kind == "prismatic"
    if slides and c2.is_zero():
        return [-c0 / c1] if not c1.contains(0) else ([] if not c0.contains(0) else None)
    square = FACTORS[kind].discriminant(c)
    if square < 0:
        return []
    if not square > 0 or (slides and c2.contains(0)):
        return None
    if slides:
        return [(-c1 + sign * square.sqrt()) / (2 * c2) for sign in (-1, 1)]
    theta, alpha = type(c0).atan2(c2, c1), type(c0).atan2(square.sqrt(), -c0)
    return [theta - alpha, theta + alpha]


# --- cosine and sine of arrays --------------------------------------------------------------------
# NumPy does not guarantee the error of its cosine and sine. The code here uses only sums and
# products of doubles: the angle less a multiple of pi / 2, which is subtracted in two parts, then
# Taylor's sums. The terms that are left out are below 1e-18. `ERROR` bounds the rounding of some
# thirty operations, each of 2^-53, generously.

ERROR = 2.0**-47
"""Bound of the absolute error of `cosine_sine`."""

FARTHEST = 1000.0
"""Largest angle, rad: the first part of its quarter turns is subtracted without rounding."""

QUARTER = 1.57079632673412561417e00, 6.07710050650619224932e-11
"""Half of pi in two doubles: the first has 33 bits, so that small multiples of it are exact."""

COSINES = [(-1.0) ** k / factorial(2 * k) for k in range(9)]
SINES = [(-1.0) ** k / factorial(2 * k + 1) for k in range(9)]


def cosine_sine(angles: Floats) -> tuple[Floats, Floats]:
    """Return cosine and sine, each within `ERROR` of the exact one; not in the paper.

    Parameters
    ----------
    angles : ndarray
        rad; each double counts as the exact binary fraction.

    Raises
    ------
    ValueError
        If an angle is NaN or beyond `FARTHEST`.

    Examples
    --------
    >>> import numpy as np
    >>> cosine, sine = cosine_sine(np.array([1.0]))
    >>> bool(abs(cosine[0] - 0.5403023058681398) < ERROR)
    True
    """
    if not bool((np.abs(angles) <= FARTHEST).all()):
        raise ValueError(f"an angle is NaN or beyond {FARTHEST:g} rad")
    quarters = np.rint(angles / QUARTER[0])
    rest = (angles - quarters * QUARTER[0]) - quarters * QUARTER[1]
    square = rest * rest
    even, odd = _sum(COSINES, square), _sum(SINES, square) * rest
    turn = quarters.astype(np.int64) & 3
    swapped = (turn & 1).astype(bool)
    cosine, sine = np.where(swapped, odd, even), np.where(swapped, even, odd)
    return np.where((turn == 1) | (turn == 2), -cosine, cosine), np.where(turn >= 2, -sine, sine)


def basis_of_doubles(kind: str, values: Floats) -> Floats:
    """Return (1, cos q, sin q) or (1, q, q²) of doubles, shape (k, 3): cosines within `ERROR`."""
    turns = kind == "revolute"
    rows = cosine_sine(values) if turns else (values, values * values)
    return np.stack([np.ones_like(values), *rows], axis=1)


def _sum(coefficients: list[float], x: Floats) -> Floats:
    """Sum a polynomial by Horner's scheme."""
    total = np.full_like(x, coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        total = total * x + coefficient
    return total
