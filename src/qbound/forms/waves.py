r"""Harmonic forms as sums of waves: amplitudes, wave vectors, and powers of sliding joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from qbound.arrays import Array
from qbound.forms.factors import FACTORS, Kind

DROPPED = 1e-15
"""Amplitudes this small beside a form's largest are rounding."""


@dataclass(frozen=True, eq=False)
class Waves:
    r"""Forms as :math:`\sum_k \mathrm{Re}\,A_k e^{i w_k \cdot q} \prod_j q_j^{p_{kj}}`.

    Attributes
    ----------
    amplitudes : ndarray of complex, shape (..., m)
        Axes before the last stack forms.
    turns : ndarray of int, shape (m, n)
        The wave vectors w: -1, 0, 1 for a revolute joint, 0 for a prismatic one.
    powers : ndarray of int, shape (m, n)
        The exponents p: 0, 1, 2 for a prismatic joint, 0 for a revolute one.
    """

    amplitudes: Array
    turns: Array
    powers: Array


def to_waves(coefficients: Array, kinds: Sequence[Kind]) -> Waves:
    """Write forms as waves; of each wave and its mirror image one is kept.

    Parameters
    ----------
    coefficients, kinds
        Those of a `HarmonicForm` of floats.
    """
    rows, n = [FACTORS[kind] for kind in kinds], len(kinds)
    first = coefficients.ndim - n
    c = coefficients.astype(complex)
    for axis, row in enumerate(rows, start=first):
        c = np.moveaxis(np.tensordot(row.waves, c, axes=([1], [axis])), 0, axis)
    index = np.indices((3,) * n).reshape(n, -1)
    turns = np.array([row.turns[i] for row, i in zip(rows, index, strict=True)]).T
    powers = np.array([row.powers[i] for row, i in zip(rows, index, strict=True)]).T
    lead = np.array([next((x for x in row if x), 0) for row in turns])
    amplitudes = np.where(lead > 0, 2, 1) * c.reshape(*c.shape[:first], 3**n)
    size = np.abs(amplitudes)
    seen = (size > DROPPED * size.max(axis=-1, keepdims=True)).reshape(-1, len(lead)).any(axis=0)
    kept = (lead >= 0) & seen
    return Waves(amplitudes[..., kept], turns[kept], powers[kept])
