"""Where do polynomials vanish? Roots of stacks of them, a multiple root once and as it is.

Roots are eigenvalues of companion matrices. Rounding spreads an m-fold one by its own m-th root,
1e-8 of a double one: two curves that touch would part there, or miss each other. But an m-fold root
is a simple one of the (m - 1)-th derivative, and of that Newton finds all digits.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from qbound.tolerances import MULTIPLE, NEGLIGIBLE, SPREAD

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Complexes = NDArray[np.complex128]


def polynomial_roots(stack: Complexes) -> tuple[Ints, Complexes]:
    """Return rows and roots of stacked polynomials, equal degrees by one call of the solver.

    Both ends are trimmed relative to the largest coefficient: a fixed degree would send roots to
    zero or infinity and spoil the others. Not in the paper.

    Parameters
    ----------
    stack : ndarray of complex, shape (n, d + 1)
        Coefficients, ascending powers, of terms of size 1 or less.

    Returns
    -------
    tuple of ndarray
        Row and place of each root, shape (k,), in no order; a multiple root stands there once.

    Examples
    --------
    >>> import numpy as np
    >>> rows, z = polynomial_roots(np.poly([0.3, 0.3, -0.5])[None, ::-1].astype(complex))
    >>> sorted(z.real.round(14).tolist())
    [-0.5, 0.3]
    """
    rows, stack, degree, zero = _trimmed(stack)
    z = np.full((len(rows), stack.shape[1] - 1), np.nan, dtype=complex)
    for d in set(degree.tolist()) - {0}:
        chosen = degree == d
        z[chosen, :d] = _companion_roots(stack[chosen, : d + 1])
    where, multiple, simple = _multiple_roots(stack, z)
    of, place = np.nonzero(simple)
    found = np.zeros(len(zero)), multiple, _polished(stack, z)[of, place]
    return np.concatenate([zero, rows[where], rows[of]]), np.concatenate(found)


def _trimmed(stack: Complexes) -> tuple[Ints, Complexes, Ints, Ints]:
    """Return rows that are not zero, their polynomials from the first coefficient, and degrees.

    Zeros stand behind the last coefficient. Of the rows that were trimmed in front comes a list:
    they had the root zero.
    """
    sizes = np.abs(stack)
    largest = sizes.max(axis=1, initial=0.0)
    rows = np.flatnonzero(largest > NEGLIGIBLE)
    kept = sizes[rows] > NEGLIGIBLE * largest[rows, None]
    first = kept.argmax(axis=1)
    last = stack.shape[1] - 1 - kept[:, ::-1].argmax(axis=1)
    degree = last - first
    term = np.arange(degree.max(initial=1) + 1)
    place = np.minimum(first[:, None] + term, last[:, None])
    moved = np.where(term <= degree[:, None], stack[rows[:, None], place], 0.0)
    return rows, moved, degree, rows[first > 0]


def _companion_roots(stack: Complexes) -> Complexes:
    """Return the roots, (n, degree), of polynomials with non-zero ends."""
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
    return np.array([half / c2, c0 / half]).T


def _multiple_roots(stack: Complexes, z: Complexes) -> tuple[Ints, Complexes, Bools]:
    """Return rows and places of multiple roots, and which of the computed roots (n, d) are none.

    Rows with fewer roots end with NaN.
    """
    simple: Bools = np.asarray(~np.isnan(z))
    found = [(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=complex))]
    gaps = np.abs(z[:, :, None] - z[:, None, :])
    company = (gaps <= _spread(z.shape[1])).sum(axis=-1).max(axis=-1, initial=0)
    for m in range(int(company.max(initial=0)), 1, -1):
        near = np.flatnonzero(company >= m)
        k, one = np.nonzero((gaps[near] <= _spread(m)).sum(axis=-1) >= m)
        if not len(k):
            continue
        rows = near[k]
        own = np.argsort(gaps[rows, one], axis=-1)[:, :m]  # the root itself, and its nearest
        _, first = np.unique(rows * 2 ** z.shape[1] + (2**own).sum(axis=1), return_index=True)
        rows, own = rows[first], own[first]  # each of the parts has the same ones
        place, rounded = _m_fold(stack[rows], np.take_along_axis(z[rows], own, axis=1), m)
        new = rounded & simple[rows[:, None], own].all(axis=1)
        simple[rows[new, None], own[new]] = False
        found.append((rows[new], place[new]))
    rows, places = (np.concatenate(x) for x in zip(*found, strict=True))
    return rows, places, simple


def _spread(m: int) -> float:
    """Return how far from each other rounding may leave the m parts of one root."""
    return float(SPREAD * NEGLIGIBLE ** (1 / m))


def _m_fold(stack: Complexes, parts: Complexes, m: int) -> tuple[Complexes, Bools]:
    """Return the root that m computed ones (k, m) would be, and whether but for rounding they are.

    They are if of the Taylor coefficients there the first m cannot be told from zero.
    """
    tables = [_taylor(stack, j) for j in range(m + 1)]
    place = parts.mean(axis=1, keepdims=True)
    for _ in range(3):
        value, slope = _horner(tables[m - 1], place), m * _horner(tables[m], place)
        step = np.divide(value, slope, out=np.zeros_like(value), where=slope != 0)
        place = np.where(np.abs(step) <= _spread(m), place - step, place)
    rounded = np.ones(len(stack), dtype=np.bool_)
    for table in tables[:m]:
        size = 1 + _horner(np.abs(table), np.abs(place))
        rounded &= (np.abs(_horner(table, place)) <= MULTIPLE * size)[:, 0]
    return place[:, 0], rounded


def _taylor(stack: Complexes, j: int) -> Complexes:
    """Return the polynomials' j-th derivatives over j!, ascending powers."""
    return np.asarray(stack[:, j:] * [math.comb(k, j) for k in range(j, stack.shape[1])])


def _polished(stack: Complexes, z: Complexes) -> Complexes:
    """Two steps of Newton; a step is taken only where the root is simple enough to gain by it."""
    both = np.zeros((2, *stack.shape), dtype=complex)
    both[0], both[1, :, :-1] = stack, stack[:, 1:] * np.arange(1, stack.shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(2):
            value, slope = _horner(both, z)
            step = value / slope
            z = np.where(np.abs(step) < 1e-6, z - step, z)
    return z


def _horner(stack: NDArray[np.inexact], z: NDArray[np.inexact]) -> NDArray[np.inexact]:
    """Evaluate polynomials (..., n, d + 1) at places, a row of them each, (n, k)."""
    result = np.empty((*stack.shape[:-1], z.shape[1]), dtype=z.dtype)
    result[...] = stack[..., -1:]
    for k in reversed(range(stack.shape[-1] - 1)):
        result *= z
        result += stack[..., k : k + 1]
    return result
