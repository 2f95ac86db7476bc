"""At which base values can two forms share a root along the lift? Roots of univariate polynomials.

Every kind of event is one polynomial of the base: of z = exp(i t) on a circle, of t itself on a
line. They are solved in stacks (`polynomials`); each root is returned with the row it belongs to.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, turns_within
from qbound.forms.factors import FACTORS, Kind, basis
from qbound.region.plane import Plane
from qbound.region.polynomials import polynomial_roots
from qbound.tolerances import NEAR_CIRCLE, NEGLIGIBLE

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Complexes = NDArray[np.complex128]

BLOCK = 2**14
"""Polynomials that are solved at once: fast enough, small enough for any memory."""

FEW = 2**9
"""Polynomials of a kind up to which they are solved with others: one call costs more than they."""

NEXT, LAST = [1, 2, 0], [2, 0, 1]
"""Of three coefficients, those that each entry of a cross product is made of."""

Events = Iterator[tuple[Ints, Complexes]]
"""Rows and their polynomials, stacks of equal length; a row may occur in several."""


def univariate(plane: Plane, table: Floats) -> Complexes:
    """Turn scaled (m, 3, 3) coefficients into polynomials of the base, (m, 3 of the lift, 3).

    Ascending powers. Revolute: of z = exp(i q), times z. Prismatic: of q itself.
    """
    return np.asarray(table.swapaxes(1, 2) @ _by_power(plane.base_kind))


@cache
def _by_power(kind: Kind) -> Complexes:
    """Return the matrix that turns a joint's three coefficients into those of ascending powers."""
    factor = FACTORS[kind]
    return np.asarray(factor.waves[np.argsort(factor.turns + factor.powers)].T, dtype=complex)


def own_events(plane: Plane, c: Complexes) -> Events:
    """Yield where a form's roots appear, jump, or pass an end of the lift's range."""
    rows = np.arange(len(c))
    c0, c1, c2 = c[:, 0], c[:, 1], c[:, 2]
    if plane.lift_kind == "revolute":
        yield rows, _excess(c)
    else:
        yield rows, _times(c1, c1) - 4 * _times(c0, c2)
        yield rows, c1
    yield rows, c2
    if plane.lift_range is not None:
        at = basis(plane.lift_kind, np.asarray(plane.lift_range) / plane.lift_unit)
        for factor in at:
            yield rows, np.einsum("j,mjl->ml", factor, c)


def meetings(plane: Plane, a: Complexes, b: Complexes) -> Events:
    """Yield where paired forms, two stacks (k, 3, 3), may share a root along the lift."""
    yield from (_circle if plane.lift_kind == "revolute" else _line)(a, b)


def _circle(a: Complexes, b: Complexes) -> Events:
    """Resultant of two equations linear in (cos, sin), on the unit circle (Cramer's rule).

    Where the two are parallel for every base value, as for two points on one ray of a link, it is
    the sum of two squares with only double roots; their common roots are then those of each term.
    Where both have no constant part it is the square of the determinant.
    """
    rows = np.arange(len(a))
    crossed = _times(a[:, NEXT], b[:, LAST]) - _times(a[:, LAST], b[:, NEXT])
    determinant, cosine, sine = crossed.swapaxes(0, 1)
    resultant = _excess(crossed)
    none: Bools = np.asarray((np.abs(crossed) <= NEGLIGIBLE).all(axis=-1))
    parallel, plain = none[:, 0], none[:, 1] & none[:, 2]
    # Two forms that share one root for every base value share the other where they are parallel.
    sharing = ~parallel & (np.abs(resultant) <= NEGLIGIBLE).all(axis=-1)
    apart = ~parallel & ~plain
    yield rows[apart], resultant[apart]
    yield rows[parallel], cosine[parallel]
    yield rows[parallel], sine[parallel]
    yield rows[sharing | plain], determinant[sharing | plain]


def _excess(c: Complexes) -> Complexes:
    """Return c1^2 + c2^2 - c0^2 of rows of three polynomials, shape (k, 3, length).

    It vanishes where c0 + c1 cos + c2 sin has a double root, or c0 times (cos, sin) is (c1, c2).
    """
    first, second, third = _times(c, c).swapaxes(0, 1)
    return np.asarray(second + third - first)


def _line(a: Complexes, b: Complexes) -> Events:
    """Resultants of polynomials of degree 2 or less at their actual degrees.

    The formal resultant of two affine forms is identically zero, so each pair is taken at its own.
    """
    rows = np.arange(len(a))
    (a0, a1, a2), (b0, b1, b2) = np.moveaxis(a, 1, 0), np.moveaxis(b, 1, 0)
    one, other = (np.abs(c).max(axis=-1, initial=0.0) > 0 for c in (a2, b2))
    p = _times(a1, b0) - _times(a0, b1)
    q = _times(a2, b0) - _times(a0, b2)
    apart = _times(a2, b1) - _times(a1, b2)
    both = _times(q, q) - _times(apart, p)
    # Two quadratics that share one root for every base value share the other where sums agree.
    sharing = one & other & (np.abs(both) <= NEGLIGIBLE).all(axis=-1)
    first = _times(_times(a2, b0), b0) - _times(_times(a1, b0), b1) + _times(_times(a0, b1), b1)
    second = _times(_times(b2, a0), a0) - _times(_times(b1, a0), a1) + _times(_times(b0, a1), a1)
    # An affine form whose root a quadratic always has changes sign at the other where it vanishes.
    under, over = (
        (np.abs(c) <= NEGLIGIBLE).all(axis=-1) & quadratic & ~affine
        for c, quadratic, affine in ((first, one, other), (second, other, one))
    )
    for chosen, polynomials in (
        (~one & ~other, p),
        (one & other, both),
        (one & ~other, first),
        (~one & other, second),
        (sharing, apart),
        (under, b1),
        (over, a1),
    ):
        yield rows[chosen], polynomials[chosen]


def _times(p: Complexes, q: Complexes) -> Complexes:
    """Multiply stacked polynomials, coefficients on the last axis."""
    m, n = p.shape[-1], q.shape[-1]
    if p.size > FEW:
        product = np.zeros((*p.shape[:-1], m + n - 1), dtype=complex)
        for k in range(m):
            product[..., k : k + n] += p[..., k : k + 1] * q
        return product
    products = (p[..., :, None] * q[..., None, :]).reshape(*p.shape[:-1], m * n)
    return np.asarray(products @ _degrees(m, n))


@cache
def _degrees(m: int, n: int) -> Complexes:
    """Return the matrix that adds up products of coefficients, (m n, m + n - 1), by degree."""
    degree = np.arange(m)[:, None] + np.arange(n)
    return np.asarray(degree.reshape(-1, 1) == np.arange(m + n - 1), dtype=complex)


def base_values(plane: Plane, events: Events) -> tuple[Ints, Floats]:
    """Return the rows and the real base values at which any of the polynomials vanishes.

    A block at a time: of thousands of boundaries there are millions of pairs.
    """
    found = [(np.zeros(0, dtype=np.int64), np.zeros(0))]
    for rows, stack in _blocks(events):
        where, t = _real(plane, stack)
        found.append((rows[where], t))
    return np.concatenate([rows for rows, _ in found]), np.concatenate([t for _, t in found])


def _blocks(events: Events) -> Events:
    """Yield the same polynomials with few of them together, padded to one length, many in parts."""
    few: list[tuple[Ints, Complexes]] = []
    for rows, stack in events:
        if len(stack) > FEW:
            yield from (
                (rows[k : k + BLOCK], stack[k : k + BLOCK]) for k in range(0, len(stack), BLOCK)
            )
        elif len(stack):
            few.append((rows, stack))
    if few:
        owner = np.concatenate([rows for rows, _ in few])
        padded = np.zeros((len(owner), max(stack.shape[1] for _, stack in few)), dtype=complex)
        at = 0
        for _, stack in few:
            padded[at : at + len(stack), : stack.shape[1]] = stack
            at += len(stack)
        yield owner, padded


def _real(plane: Plane, stack: Complexes) -> tuple[Ints, Floats]:
    rows, z = polynomial_roots(stack)
    if plane.base_kind == "prismatic":
        near = np.abs(z.imag) <= NEAR_CIRCLE * (1 + np.abs(z.real))
        return rows[near], np.asarray(plane.base_unit * z.real[near])
    near = np.abs(np.abs(z) - 1) <= NEAR_CIRCLE
    rows, t = rows[near], np.angle(z[near])
    turns = np.array(turns_within(*plane.ends, [-math.pi, math.pi]))
    return rows.repeat(len(turns)), (t[:, None] + TURN * turns).ravel()
