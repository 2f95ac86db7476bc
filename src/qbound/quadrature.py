"""Integrals of functions with kinks and jumps: Lobatto's rule, on parts halved until it agrees.

The rule has nodes at the ends of a part, so that a jump just inside an end is not overlooked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from qbound.arrays import Floats

_LAST = np.polynomial.legendre.Legendre.basis(12)
NODES: Final = np.concatenate([[-1.0], np.sort(_LAST.deriv().roots().real), [1.0]])
WEIGHTS: Final = 2 / (12 * 13 * _LAST(NODES) ** 2)
"""Thirteen nodes in [-1, 1]; exact for polynomials up to degree 23."""

PARTS: Final = 192
"""Parts at the start: what happens within less than a part may be missed."""

AGREEMENT: Final = 1e-14
"""A part is done when its halves change its value by less than this times the largest part."""

ROUNDING: Final = 4 * np.finfo(float).eps * np.sqrt(PARTS)
"""Error of a sum of so many parts, each a few units in the last place off."""

HALVINGS: Final = 60
"""More often a part is not halved: it is then no longer than rounding."""


@dataclass(frozen=True, eq=False)
class Integral:
    """The value of an integral and a bound of its error, by experience, not proved.

    Attributes
    ----------
    value, error : ndarray, shape (...)
        The shape of one value of the function.
    """

    value: Floats
    error: Floats


def integral(function: Callable[[Floats], Floats], low: float, high: float) -> Integral:
    r"""Return :math:`\int_{low}^{high} f(x)\,dx`.

    Parameters
    ----------
    function : callable
        Takes x, shape (n,), to values, shape (n, ...).

    Examples
    --------
    >>> found = integral(lambda x: np.abs(x - 0.3), 0.0, 1.0)
    >>> round(float(found.value), 12), bool(found.error < 1e-12)
    (0.29, True)
    """
    edges = np.linspace(low, high, PARTS + 1)
    start, end = edges[:-1], edges[1:]
    whole = _lobatto(function, start, end)
    largest = np.abs(whole).max(axis=0)
    total, error = np.zeros_like(largest), np.zeros_like(largest)
    for _ in range(HALVINGS):
        middle = (start + end) / 2
        left, right = _lobatto(function, start, middle), _lobatto(function, middle, end)
        change = np.abs(left + right - whole)
        done = (change <= AGREEMENT * largest).reshape(len(start), -1).all(axis=-1)
        total = total + (left + right)[done].sum(axis=0)
        error = error + change[done].sum(axis=0)
        start = np.concatenate([start[~done], middle[~done]])
        end = np.concatenate([middle[~done], end[~done]])
        whole = np.concatenate([left[~done], right[~done]])
        if not len(start):
            break
    rounding = ROUNDING * np.abs(total)
    error = error + np.abs(whole).sum(axis=0) + rounding  # of parts that never agreed: all
    return Integral(np.asarray(total + whole.sum(axis=0)), np.asarray(error))


def _lobatto(function: Callable[[Floats], Floats], start: Floats, end: Floats) -> Floats:
    """Apply the rule to parts, (m,) each: values of shape (m, ...)."""
    middle, half = (start + end) / 2, (end - start) / 2
    values = function((middle[:, None] + half[:, None] * NODES).ravel())
    values = values.reshape(len(start), len(NODES), *values.shape[1:])
    sums = np.tensordot(WEIGHTS, values, axes=([0], [1]))
    return np.asarray(sums * half.reshape(-1, *(1,) * (sums.ndim - 1)))
