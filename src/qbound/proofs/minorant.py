r"""Lower bounds of a boundary function over simplices of joint space (not in the paper).

A harmonic form is a sum of waves :math:`A_k \cos(w_k \cdot q + \varphi_k)`, times products of the
sliding joints. Three bounds from below: by the second derivative, which the certificates use, and
two simpler ones to compare it with.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.forms.harmonic import HarmonicForm

Floats = NDArray[np.float64]
Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Waves:
    r"""A form as :math:`\sum_k \mathrm{Re}\,A_k e^{i w_k \cdot q} \prod_j q_j^{e_{kj}}`.

    Attributes
    ----------
    amplitudes : ndarray of complex, shape (m,)
    turns : ndarray, shape (m, n)
        The wave vectors w: -1, 0, 1 for a revolute joint, 0 for a prismatic one.
    powers : ndarray of int, shape (m, n)
        The exponents e: 0, 1, 2 for a prismatic joint, 0 for a revolute one.
    """

    amplitudes: Array
    turns: Array
    powers: Array


Bound = Callable[[Waves, Floats], Floats]
"""From waves and cells, shape (N, k, n), to a number below the form on each cell, shape (N,)."""


def to_waves(form: HarmonicForm) -> Waves:
    """Write one form as waves; of each wave and its mirror image one is kept.

    Parameters
    ----------
    form : HarmonicForm, shape ()
    """
    halves = np.array([[1, 0, 0], [0, 0.5, -0.5j], [0, 0.5, 0.5j]])  # 1, exp(iq), exp(-iq)
    c = form.coefficients.astype(complex)
    for j, kind in enumerate(form.kinds):
        if kind == "revolute":
            c = np.moveaxis(np.tensordot(halves, c, axes=([1], [j])), 0, j)
    index = np.indices(c.shape).reshape(c.ndim, -1).T
    turning = np.array([kind == "revolute" for kind in form.kinds])
    w = np.where(turning, np.array([0, 1, -1])[index], 0)
    lead = np.array([next((x for x in row if x), 0) for row in w])
    amplitudes = np.where(lead > 0, 2, 1) * c.ravel()
    kept = (lead >= 0) & (np.abs(amplitudes) > 1e-15 * np.abs(amplitudes).max())
    return Waves(amplitudes[kept], w[kept].astype(float), np.where(turning, 0, index)[kept])


def second_order(waves: Waves, cells: Floats) -> Floats:
    r"""Bound by the second derivative: the certificates' bound.

    For the centre m of a cell and each corner m + d,
    :math:`\beta(m) + \nabla\beta(m) \cdot d - \frac12 \sum_k |A_k| (w_k \cdot d)^2` is concave in
    d and below the form, so that its least value over the corners is below the form on the cell.
    """
    centre, steps, angles = _about_centres(waves, cells)
    value, slope = _along(waves, centre, steps, angles)
    return np.asarray((value[:, None] + slope - _bend(waves, cells, steps, angles) / 2).min(axis=1))


def lipschitz(waves: Waves, cells: Floats) -> Floats:
    r"""Bound by the slope: :math:`\beta(m) - \sum_k |A_k| |w_k \cdot d|`. Revolute joints only."""
    centre, steps, angles = _about_centres(waves, cells)
    value, _ = _along(waves, centre, steps, angles)
    return np.asarray((value[:, None] - np.abs(angles) @ np.abs(waves.amplitudes)).min(axis=1))


def natural(waves: Waves, cells: Floats) -> Floats:
    """Bound by interval arithmetic: each wave by its least value on the cell. Revolute joints only.

    Already better than the natural extension of products of sines and cosines, which forgets that
    the factors belong together.
    """
    phases = cells @ waves.turns.T + np.angle(waves.amplitudes)
    low, high = phases.min(axis=1), phases.max(axis=1)
    trough = np.floor((high - math.pi) / (2 * math.pi)) >= np.ceil((low - math.pi) / (2 * math.pi))
    least = np.where(trough, -1.0, np.minimum(np.cos(low), np.cos(high)))
    return np.asarray(least @ np.abs(waves.amplitudes))


def longest_edges(waves: Waves, cells: Floats) -> NDArray[np.intp]:
    """Return for each cell the edge along which the form may bend most, index among all pairs."""
    i, k = np.triu_indices(cells.shape[1], 1)
    edges = cells[:, i] - cells[:, k]
    angles = edges @ waves.turns.T
    bend = _bend(waves, cells, edges, angles, each=True)
    length = np.square(edges).sum(axis=2)
    flat = bend.max(axis=1, keepdims=True) <= 0
    return np.asarray(np.where(flat, length, bend).argmax(axis=1))


def _about_centres(waves: Waves, cells: Floats) -> tuple[Floats, Floats, Floats]:
    """Centres (N, n), steps to the corners (N, k, n), and their turns of each wave (N, k, m)."""
    centre = cells.mean(axis=1)
    steps = cells - centre[:, None]
    return centre, steps, steps @ waves.turns.T


def _along(waves: Waves, centre: Floats, steps: Floats, angles: Floats) -> tuple[Floats, Floats]:
    """Value at the centres, (N,), and derivative along the steps, (N, k)."""
    z = waves.amplitudes * np.exp(1j * (centre @ waves.turns.T))
    x, dx = z.real[:, None] + 0 * angles, (1j * z)[:, None].real * angles
    for j, power in _slides(waves):
        q, d = centre[:, None, j, None], steps[:, :, j, None]
        x, dx = np.where(power, x * q, x), np.where(power, dx * q + x * d, dx)
    return np.asarray(x[:, 0].sum(axis=1)), np.asarray(dx.sum(axis=2))


def _bend(
    waves: Waves, cells: Floats, steps: Floats, angles: Floats, *, each: bool = False
) -> Floats:
    """Bound of minus the second derivative along each step, (N, k).

    A wave with slides is no longer concave in the step: the largest step counts, unless `each`.
    """
    size = np.abs(waves.amplitudes)
    u, sliding = np.abs(angles), waves.powers.any(axis=1)
    if not sliding.any():
        return np.asarray(np.square(u) @ size)
    far = np.abs(steps)
    if not each:
        u = np.where(sliding, u.max(axis=1, keepdims=True), u)
        far = np.broadcast_to(far.max(axis=1, keepdims=True), far.shape)
    y, dy, ddy = size + 0 * u, size * u, size * np.square(u)
    for j, power in _slides(waves):
        q, d = np.abs(cells[:, :, j]).max(axis=1)[:, None, None], far[:, :, j, None]
        ddy = np.where(power, ddy * q + 2 * dy * d, ddy)
        y, dy = np.where(power, y * q, y), np.where(power, dy * q + y * d, dy)
    lone = (waves.powers.max(axis=1) == 2) & (waves.powers.sum(axis=1) == 2)
    upwards = lone & ~waves.turns.any(axis=1) & (waves.amplitudes.real > 0)
    return np.asarray(np.where(upwards, 0, ddy).sum(axis=2))


def _slides(waves: Waves) -> list[tuple[int, Array]]:
    """Every sliding joint as often as its power, with the waves that have the factor."""
    joints = range(waves.powers.shape[1])
    found = [(j, waves.powers[:, j] > power) for j in joints for power in (0, 1)]
    return [(j, has) for j, has in found if has.any()]
