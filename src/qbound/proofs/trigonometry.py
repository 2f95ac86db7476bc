r"""Cosine and sine of arrays with a proved error, which NumPy's own do not promise.

Only sums and products of doubles: the angle less a multiple of :math:`\pi/2`, which is subtracted
in two parts, then Taylor's sums. What is left out of these is below :math:`10^{-18}`; the rounding
of some thirty operations, each of :math:`2^{-53}`, is bounded by `ERROR` with room to spare.
"""

from __future__ import annotations

from math import factorial

import numpy as np

from qbound.arrays import Floats

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
        rad; each double counts as it is.

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


def _sum(coefficients: list[float], x: Floats) -> Floats:
    """Sum a polynomial by Horner's scheme."""
    total = np.full_like(x, coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        total = total * x + coefficient
    return total
