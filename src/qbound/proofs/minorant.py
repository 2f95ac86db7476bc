r"""Lower bounds of a boundary function over simplices of joint space (not in the paper).

Three bounds from below: by the second derivative, which the certificates use, and two simpler ones
to compare it with.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from qbound.forms.bending import second_order
from qbound.forms.harmonic import HarmonicForm

__all__ = ["Bound", "lipschitz", "natural", "second_order"]

Floats = NDArray[np.float64]

Bound = Callable[[HarmonicForm, Floats], Floats]
"""From a form and cells, shape (N, k, n), to a number below the form on each cell, shape (N,)."""


def lipschitz(form: HarmonicForm, cells: Floats) -> Floats:
    r"""Bound by the slope: :math:`\beta(m) - \sum_k |A_k| |w_k \cdot d|`. Revolute joints only."""
    centre, waves = cells.mean(axis=1), form.waves
    angles = np.abs((cells - centre[:, None]) @ waves.turns.T)
    return np.asarray((form(centre)[:, None] - angles @ np.abs(waves.amplitudes)).min(axis=1))


def natural(form: HarmonicForm, cells: Floats) -> Floats:
    """Bound by interval arithmetic: each wave by its least value on the cell. Revolute joints only.

    Already better than the natural extension of products of sines and cosines, which forgets that
    the factors belong together.
    """
    waves = form.waves
    phases = cells @ waves.turns.T + np.angle(waves.amplitudes)
    low, high = phases.min(axis=1), phases.max(axis=1)
    trough = np.floor((high - math.pi) / (2 * math.pi)) >= np.ceil((low - math.pi) / (2 * math.pi))
    least = np.where(trough, -1.0, np.minimum(np.cos(low), np.cos(high)))
    return np.asarray(least @ np.abs(waves.amplitudes))
