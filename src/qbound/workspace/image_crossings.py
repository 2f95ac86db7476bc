"""Where a boundary reached in one posture crosses one that is reached in the other.

Both postures of a place lie at the same distance u from the singularity (`planar`), and at the same
place along the circle or line on which the first joint moves the tool. For fixed u each form
becomes a one-joint form of that place; two of them share a root only where a resultant vanishes,
one univariate polynomial of u a pair. Its degree is known, so that as many values determine it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.polynomial import chebyshev, polynomial
from numpy.typing import NDArray

from qbound.arrays import Complexes, Floats
from qbound.forms.harmonic import HarmonicForm, basis
from qbound.tolerances import NEAR_CIRCLE, NEGLIGIBLE
from qbound.workspace.planar import PlanarArm

NODES: Final = 32
"""Values of u that determine a resultant; its degree is 8 in cos u and sin u (second joint
revolute), or 12 in u (prismatic)."""


def crossing_distances(
    arm: PlanarArm, forms: HarmonicForm, ends: Sequence[float], farthest: float
) -> Floats:
    """Return every distance u from the singularity at which both postures' boundaries may cross.

    Some are spurious, which costs time. Boundaries that coincide for every u, as walls for the tool
    itself do, give none.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Of the two joints.
    ends : sequence of float
        Ends of the first joint's range, boundaries too.
    farthest : float
        Largest u of interest; rad or length.
    """
    if arm.singularity is None:
        return np.zeros(0)
    u = farthest * _nodes(arm) if arm.kinds[1] == "prismatic" else _nodes(arm)
    table = _first_joint_forms(arm, forms, ends)
    one, other = (_along(arm, table, side, u) for side in (1, -1))
    # The pair (j, i) is the pair (i, j) at -u, which swaps the postures.
    i, j = np.triu_indices(len(table))
    resultant = _circle_resultant if arm.period else _line_resultant
    squared = np.abs(basis(arm.kinds[1], arm.second(1, u)) @ arm.v) ** 2
    values = resultant(one[i], other[j], squared / squared.max())
    found = [np.zeros(0), *(_roots(arm, row) for row in values)]
    distances = np.abs(np.concatenate(found))
    if arm.kinds[1] == "prismatic":
        distances = farthest * distances
    return np.asarray(distances[distances < farthest])


def _nodes(arm: PlanarArm) -> Floats:
    """Return the values of u, or of u by the farthest, from which a resultant is interpolated."""
    if arm.kinds[1] == "revolute":
        return np.arange(NODES) * math.tau / NODES
    return chebyshev.chebpts1(NODES)


def _first_joint_forms(arm: PlanarArm, forms: HarmonicForm, ends: Sequence[float]) -> Floats:
    """Return the forms that depend on the first joint, and one for each end of its range.

    Shape (m, 3, 3): coefficients in the second joint, then in the first.
    """
    table = np.swapaxes(np.asarray(forms.coefficients, dtype=float), 1, 2)
    table = table[table[:, :, 1:].any(axis=(1, 2))]
    limits = np.zeros((len(ends), 3, 3))
    for form, end in zip(limits, ends, strict=True):
        # sin(q1 - end), which is zero half a turn away too, or q1 - end
        form[0] = (0, -math.sin(end), math.cos(end)) if arm.period else (-end, 1, 0)
    return np.concatenate([table, limits])


def _along(arm: PlanarArm, table: Floats, side: int, u: Floats) -> Complexes:
    """Return each form's coefficients in the place along the circle or line, shape (m, 2 or 3, n).

    Circle: c0 and the complex amplitude times abs(v). Line: the powers 1, x, x^2.
    """
    columns = basis(arm.kinds[1], arm.second(side, u))
    c0, c1, c2 = np.moveaxis(np.einsum("nb,mbl->lmn", columns, table), 0, 0)
    v = columns @ arm.v
    if arm.period:  # q1 = along - arg v
        stacked = np.stack([c0 + 0j, (c1 + 1j * c2) * v / np.abs(v).max()], axis=1)
    else:  # q1 = along - Re v
        x = v.real
        stacked = np.stack([c0 - c1 * x + c2 * x * x, c1 - 2 * c2 * x, c2], axis=1) + 0j
    return np.asarray(stacked / np.abs(stacked).max(axis=(1, 2), keepdims=True))


def _circle_resultant(a: Complexes, b: Complexes, squared: Floats) -> Floats:
    """Vanish where two forms c0 abs(v) + Re(amplitude exp(-i along)) share a root."""
    determinant = (a[:, 1].conj() * b[:, 1]).imag
    ends = ~np.any((a[:, 0] != 0) | (b[:, 0] != 0), axis=1)
    numerator = np.abs(a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]) ** 2
    # Two ends of the range have c0 = 0: the square would double their roots.
    return np.asarray(
        np.where(ends[:, None], determinant, squared * numerator - determinant * determinant)
    )


def _line_resultant(a: Complexes, b: Complexes, _: Floats) -> Floats:
    """Vanish where two forms of degree 1 or 2 in the place along a line share a root."""
    (a0, a1, a2), (b0, b1, b2) = np.moveaxis(a.real, 1, 0), np.moveaxis(b.real, 1, 0)
    p, q = a1 * b0 - a0 * b1, a2 * b0 - a0 * b2
    affine = ~np.any((a2 != 0) | (b2 != 0), axis=1)
    return np.asarray(np.where(affine[:, None], p, q * q - (a2 * b1 - a1 * b2) * p))


def _roots(arm: PlanarArm, values: Floats) -> Floats:
    """Return the real roots of a polynomial given by its values at the nodes."""
    if np.abs(values).max() <= NEGLIGIBLE:  # the boundaries coincide
        return np.zeros(0)
    if arm.kinds[1] == "prismatic":
        c = _trimmed(chebyshev.chebfit(_nodes(arm), values, NODES - 1))
        x = chebyshev.chebroots(c)
        return np.asarray(x.real[np.abs(x.imag) <= NEAR_CIRCLE])
    c = np.fft.fftshift(np.fft.fft(values)) / NODES
    z = polynomial.polyroots(_trimmed(_trimmed(c)[::-1])[::-1])
    return np.asarray(np.angle(z[np.abs(np.abs(z) - 1) <= NEAR_CIRCLE]))


def _trimmed(c: NDArray[Any]) -> NDArray[Any]:
    """Drop coefficients at the upper end that are rounding of zero."""
    kept = np.flatnonzero(np.abs(c) > NEGLIGIBLE * np.abs(c).max())
    return c[: kept[-1] + 1]
