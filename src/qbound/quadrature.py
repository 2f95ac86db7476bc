"""Integrals of functions with kinks and jumps, by Lobatto's rule on parts of the interval.

A part is halved until the rule gives the same value for the whole part and for its halves. So the
parts become small where the function has a kink. The rule has nodes at the ends of a part, so that
a jump just inside an end is not overlooked.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from qbound.arrays import Floats

PARTS: Final = 192
"""Parts at the start. A peak that is narrower than the distance of two nodes may be missed."""

AGREEMENT: Final = 1e-14
"""A part is done when its halves change its value by less than this times the largest part."""

ROUNDING: Final = 4 * np.finfo(float).eps * np.sqrt(PARTS)
"""Relative error of a sum of so many parts, each wrong by a few units in its last place."""

HALVINGS: Final = 60
"""A part is halved at most so often, because it is then shorter than the rounding of its ends."""


@dataclass(frozen=True, eq=False)
class Integral:
    """The value of an integral, and a bound of its error that is tested and not proved.

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
        Takes x, shape (n,), to values, shape (n, ...): several functions are integrated at once.

    Examples
    --------
    A function with a kink:

    >>> from qbound.quadrature import integral
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
    # Parts that never agreed are added with their whole value as error.
    error = error + np.abs(whole).sum(axis=0) + rounding
    return Integral(np.asarray(total + whole.sum(axis=0)), np.asarray(error))


@cache
def lobatto_rule() -> tuple[Floats, Floats]:
    """Return the nodes in [-1, 1] and the weights of Lobatto's rule, exact up to degree 23.

    The thirteen nodes are the ends and the zeros of the derivative of Legendre's P_12. A weight is
    2 / (n (n - 1) P_12²) for n = 13.
    """
    last = np.polynomial.legendre.Legendre.basis(12)
    nodes = np.concatenate([[-1.0], np.sort(last.deriv().roots().real), [1.0]])
    return nodes, 2 / (12 * 13 * last(nodes) ** 2)


def _lobatto(function: Callable[[Floats], Floats], start: Floats, end: Floats) -> Floats:
    """Apply the rule to parts, (m,) each: values of shape (m, ...)."""
    nodes, weights = lobatto_rule()
    middle, half = (start + end) / 2, (end - start) / 2
    values = function((middle[:, None] + half[:, None] * nodes).ravel())
    values = values.reshape(len(start), len(nodes), *values.shape[1:])
    sums = np.tensordot(weights, values, axes=([0], [1]))
    return np.asarray(sums * half.reshape(-1, *(1,) * (sums.ndim - 1)))
