"""Roots of stacks of polynomials, each with a bound of its error."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Bools, Complexes, Floats, Ints
from qbound.tolerances import UNIT

FAR = 2.0
"""Roots farther than this from 0 are not wanted: bases are scaled to the unit circle or [-1, 1]."""

DERIVATIVES = 4
"""Derivatives that bound the error of a root; one more than the multiplicity that is well known."""


class Roots(NamedTuple):
    """Roots of polynomials, one a row.

    Attributes
    ----------
    row : ndarray of int, shape (k,)
        Which polynomial.
    z : ndarray of complex, shape (k,)
    radius : ndarray, shape (k,)
        A root of every polynomial within its error lies no farther from z.
    crowded : ndarray of bool, shape (k,)
        Whether another root of the same polynomial may lie within that distance.
    """

    row: Ints
    z: Complexes
    radius: Floats
    crowded: Bools


def polynomial_roots(stack: Complexes, errors: Floats, *, circle: bool) -> Roots:
    """Return the roots of stacked polynomials near the unit disc, those of equal degree at once.

    Roots are eigenvalues of companion matrices, polished by Newton. Coefficients at either end that
    are zero within their error are left out, because they would send roots to infinity and spoil
    the others. Not in the paper.

    Parameters
    ----------
    stack : ndarray of complex, shape (n, d + 1)
        Coefficients, ascending powers.
    errors : ndarray, shape (n,)
        Bound of the sum of all coefficients' errors.
    circle : bool
        Whether only roots near the unit circle are wanted: then the lowest coefficients are left
        out, too.

    Notes
    -----
    A polynomial of degree d with Taylor coefficients a_k at z has a root within
    ``(binomial(d, k) abs(a_0 / a_k))**(1/k)`` of z, for each k (Henrici 1974, Theorem 6.4e). The
    least of these bounds is taken, with all errors on the bad side.

    Examples
    --------
    >>> import numpy as np
    >>> stack = np.poly([0.3, 0.4, -0.5])[None, ::-1].astype(complex)
    >>> found = polynomial_roots(stack, np.array([1e-15]), circle=False)
    >>> sorted(found.z.real.round(14).tolist()), bool((found.radius < 1e-12).all())
    ([-0.5, 0.3, 0.4], True)
    """
    rows, moved, degree = _trimmed(stack, errors, circle)
    z = np.full((len(rows), stack.shape[1] - 1), np.nan, dtype=complex)
    for d in set(degree.tolist()) - {0}:
        chosen = degree == d
        z[chosen, :d] = _companion_roots(moved[chosen, : d + 1])
    z = _polished(moved, z)
    radius = _radii(moved, z, degree, errors[rows])
    near = np.abs(z[:, :, None] - z[:, None, :]) <= radius[:, :, None] + radius[:, None, :]
    crowded = near.sum(axis=2) > 1
    with np.errstate(invalid="ignore"):
        wanted = np.abs(z) <= FAR
        if circle:
            wanted &= np.abs(np.abs(z) - 1) <= radius
        else:
            wanted &= np.abs(z.imag) <= radius
    of, place = np.nonzero(wanted)
    return Roots(rows[of], z[of, place], radius[of, place], crowded[of, place])


def _trimmed(stack: Complexes, errors: Floats, circle: bool) -> tuple[Ints, Complexes, Ints]:
    """Return rows that are not zero, their polynomials from the first coefficient, and degrees."""
    sizes = np.abs(stack)
    rows = np.flatnonzero((sizes > errors[:, None]).any(axis=1))
    kept = sizes[rows] > errors[rows, None]
    first = kept.argmax(axis=1) if circle else np.zeros(len(rows), dtype=np.int64)
    last = stack.shape[1] - 1 - kept[:, ::-1].argmax(axis=1)
    degree = last - first
    term = np.arange(degree.max(initial=1) + 1)
    place = np.minimum(first[:, None] + term, last[:, None])
    moved = np.where(term <= degree[:, None], stack[rows[:, None], place], 0.0)
    return rows, moved, degree


def _companion_roots(stack: Complexes) -> Complexes:
    """Return the roots, (n, degree), of polynomials with a leading coefficient."""
    degree = stack.shape[1] - 1
    if degree == 2:
        return _quadratic_roots(*stack.T)
    matrices = np.empty((len(stack), degree, degree), dtype=complex)
    matrices[:] = np.eye(degree, k=-1)
    matrices[:, :, -1] = -stack[:, :-1] / stack[:, -1:]
    return np.asarray(np.linalg.eigvals(matrices), dtype=complex)


def _quadratic_roots(c0: Complexes, c1: Complexes, c2: Complexes) -> Complexes:
    """Return both roots, (n, 2), of c0 + c1 z + c2 z^2; the larger first, which nothing cancels."""
    root = np.sqrt(c1 * c1 - 4 * c0 * c2)
    root = np.where((c1.conj() * root).real < 0, -root, root)
    half = -(c1 + root) / 2
    other = np.divide(c0, half, out=np.zeros_like(c0), where=half != 0)
    return np.array([half / c2, other]).T


def _polished(stack: Complexes, z: Complexes) -> Complexes:
    """Two steps of Newton; a step is taken only where it is short."""
    both = np.zeros((2, *stack.shape), dtype=complex)
    both[0], both[1, :, :-1] = stack, stack[:, 1:] * np.arange(1, stack.shape[1])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for _ in range(2):
            value, slope = _horner(both, z)
            step = value / slope
            z = np.where(np.abs(step) < 1e-6, z - step, z)
    return z


def _radii(stack: Complexes, z: Complexes, degree: Ints, errors: Floats) -> Floats:
    """Bound the distances of roots from the nearest true ones, (n, d)."""
    most = stack.shape[1] - 1
    with np.errstate(all="ignore"):
        # Rounding of Horner's rule, and the coefficients' errors.
        far = np.maximum(np.abs(z), 1.0) ** degree[:, None]
        doubt = (errors + 4 * most * UNIT * np.abs(stack).sum(axis=1))[:, None] * far
        value = np.abs(_horner(stack, z)) + doubt
        radius = np.full(z.shape, np.inf)
        for k in range(1, min(most, DERIVATIVES) + 1):
            ways = np.array([math.comb(d, k) for d in range(most + 1)], dtype=float)[degree][
                :, None
            ]
            slope = np.abs(_horner(_taylor(stack, k), z)) - ways * doubt
            bound = (ways * value / np.maximum(slope, 1e-300)) ** (1 / k)
            radius = np.where(slope > 0, np.minimum(radius, bound), radius)
    return np.where(np.isnan(z), 0.0, radius)


def _taylor(stack: Complexes, j: int) -> Complexes:
    """Return the polynomials' j-th derivatives over j!, ascending powers."""
    return np.asarray(stack[:, j:] * [math.comb(k, j) for k in range(j, stack.shape[1])])


def _horner(stack: NDArray[np.inexact], z: NDArray[np.inexact]) -> NDArray[np.inexact]:
    """Evaluate polynomials (..., n, d + 1) at places, a row of them each, (n, k)."""
    result = np.empty((*stack.shape[:-1], z.shape[1]), dtype=z.dtype)
    result[...] = stack[..., -1:]
    for k in reversed(range(stack.shape[-1] - 1)):
        result *= z
        result += stack[..., k : k + 1]
    return result
