"""From the value of a form to a margin: what a pair, or a point over a wall, has left."""

from __future__ import annotations

import numpy as np

from qbound.arrays import Floats

Denominator = tuple[Floats, Floats, Floats]

NO_DISTANCE = 2.0**-1000
"""Stands for the distance 0 in a denominator: 0 / 0 would be NaN where two points meet."""


def denominators(distance: Floats) -> Denominator:
    r"""Return (a, b, d) of ``sqrt(a value + b) + d``: :math:`|B| + d_{\min}`, or 1 without one.

    Parameters
    ----------
    distance : ndarray
        :math:`d_{\min}` of the pairs; NaN where the value is a length.
    """
    pair = ~np.isnan(distance)
    d = np.where(pair, np.maximum(distance, NO_DISTANCE), 0.0)
    return pair.astype(float), np.where(pair, d * d, 1.0), d


def lengths(values: Floats, rounding: Floats, denominator: Denominator) -> Floats:
    """Return the margins of values of forms, shape (..., m); what rounding makes negative is 0.

    The values may be changed.
    """
    if values.size and values.min() < 0:
        values[(values < 0) & (values >= -rounding)] = 0
    a, b, d = denominator
    return np.asarray(values / (np.sqrt(np.maximum(a * values + b, 0)) + d))
