"""Bisection of many intervals at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arrays import Floats

HALVINGS = 52
"""So many halvings leave an interval no wider than the rounding of its length."""


def last_before(
    holds: Callable[[Floats], NDArray[np.bool_]], low: ArrayLike, high: ArrayLike
) -> tuple[Floats, Floats]:
    """Halve intervals at whose low end something holds and at whose high end it does not.

    Parameters
    ----------
    holds : callable
        Places, shape (k,), to bool, shape (k,).
    low, high : array_like, shape (k,)

    Returns
    -------
    low, high : ndarray, shape (k,)
        Neighbouring places, before and behind a change.
    """
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    for _ in range(HALVINGS if len(low) else 0):
        middle = (low + high) / 2
        before = holds(middle)
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return low, high
