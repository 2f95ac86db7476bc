"""Arrays with bounds of their errors, and the zeros of polynomials on intervals.

The zeros are isolated with Bernstein's coefficients: all of one sign mean no zero, one change of
sign means one zero, else the interval is halved. A coefficient within its error has no sign. With
tan((t - middle) / 2) a trigonometric polynomial is a polynomial, too.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import comb
from typing import Any

import numpy as np

from cspace.arrays import Bools, Floats, Ints
from cspace.tolerances import UNIT

CHUNK = 8192
"""Intervals that are looked at together: some 10 MB."""

NARROW, SHARP = 1e-5, 1e-8
"""An interval shorter than the one, or a zero with an error above the other, is undecided."""

MOST = 100
"""Times that one polynomial is halved; one that asks for more is undecided."""

FLAT = 1e-3
"""A slope below this part of the coefficients tells of another zero near by."""


class Near:
    """An array and a bound of its error; sums and products bound theirs."""

    __slots__ = ("error", "value")
    __array_ufunc__ = None

    def __init__(self, value: Any, error: Any) -> None:
        self.value, self.error = value, error

    def __add__(self, other: Near) -> Near:
        """Return the sum."""
        value = self.value + other.value
        return Near(value, self.error + other.error + UNIT * np.abs(value))

    def __sub__(self, other: Near) -> Near:
        """Return the difference."""
        value = self.value - other.value
        return Near(value, self.error + other.error + UNIT * np.abs(value))

    def __mul__(self, other: Near | float) -> Near:
        """Return the product; numbers must be powers of two."""
        if isinstance(other, int | float):
            return Near(self.value * other, self.error * abs(other))
        value = self.value * other.value
        error = np.abs(self.value) * other.error + self.error * (np.abs(other.value) + other.error)
        return Near(value, error + UNIT * np.abs(value))

    __rmul__ = __mul__


Values = Callable[[Ints, Floats], Near]
"""Polynomials by number, (n,), at their own places (n, k)."""

Zeros = tuple[Ints, Floats, Floats, set[int]]
"""Number of the polynomial, place and error of each zero; and the undecided polynomials."""


@cache
def bernstein(degree: int) -> tuple[Floats, Floats, Floats]:
    """Return nodes in [-1, 1], both ends among them, and two matrices.

    The first one leads from values at the nodes to Bernstein's coefficients, the second one from
    these to powers of s.
    """
    nodes: Any = -np.cos(np.pi * np.arange(degree + 1) / degree)
    i = np.arange(degree + 1)[:, None]
    binomials = np.array([[comb(degree, k)] for k in range(degree + 1)])
    values = binomials * ((1 + nodes) / 2) ** i * ((1 - nodes) / 2) ** (degree - i)
    inverse: Floats = np.linalg.inv(values)
    powers: Floats = values @ np.linalg.inv(nodes**i)
    return nodes, inverse, powers


def isolate(
    values: Values,
    degree: int,
    start: Floats,
    end: Floats,
    circle: bool,
    known: tuple[Bools | None, Bools | None] = (None, None),
) -> Zeros:
    """Return the zeros of polynomials of a degree, each in its own interval.

    Parameters
    ----------
    circle : bool
        Whether they are trigonometric polynomials, of half the degree.
    known : pair of ndarray of bool, optional
        Whether there is a known zero at the start, at the end; it is left out.
    """
    to_bernstein, n = bernstein(degree)[1], len(start)
    results: list[tuple[Ints, Floats, Floats]] = []
    vague = set[int]()
    halved = np.zeros(n, dtype=np.int64)
    no = np.zeros(n, dtype=np.bool_)
    at_start, at_end = (no if x is None else x for x in known)
    every = (np.arange(n), start, end, at_start, at_end)
    stack: list[Any] = [tuple(x[k : k + CHUNK] for x in every) for k in range(0, n, CHUNK)]
    while stack:
        which, a, b, at_start, at_end = stack.pop()
        middle, half = (a + b) / 2, np.tan((b - a) / 4) if circle else (b - a) / 2
        x = half[:, None] * bernstein(degree)[0]
        t = middle[:, None] + (2 * np.arctan(x) if circle else x)
        weight = (1 + x * x) ** (degree // 2) if circle else 1.0
        found = values(which, t)
        p = (found.value * weight) @ to_bernstein
        doubt = (found.error * weight) @ np.abs(to_bernstein)
        sign = (p > doubt).astype(np.int8) - (p < -doubt)
        sign[at_start, 0], sign[at_end, -1] = sign[at_start, 1], sign[at_end, -2]
        low, high = sign.min(axis=1), sign.max(axis=1)
        none = (low == high) & (low != 0)
        first = sign * sign[:, :1]
        last_same = degree - (first[:, ::-1] == 1).argmax(axis=1)
        one = (sign[:, 0] * sign[:, -1] == -1) & (last_same < (first == -1).argmax(axis=1))
        k = np.flatnonzero(one)
        if len(k):
            flat, t, radius = _refined(values, degree, which[k], middle[k], half[k], p[k], circle)
            one[k[flat]] = False
            k, good = k[~flat], radius < SHARP
            vague.update(which[k[~good]].tolist())
            results.append((which[k[good]], t[good], radius[good]))
        rest = ~(none | one)
        if not rest.any():
            continue
        np.add.at(halved, which[rest], 1)
        stuck = (b - a < NARROW) | ~sign.any(axis=1) | (halved[which] > MOST)
        vague.update(which[rest & stuck].tolist())
        rest &= ~stuck
        which, a, b, at_start, at_end = (y[rest] for y in (which, a, b, at_start, at_end))
        cut, no = a + 0.47 * (b - a), np.zeros(len(which), dtype=np.bool_)
        pairs = ((which, which), (a, cut), (cut, b), (at_start, no), (no, at_end))
        both = tuple(np.concatenate(pair) for pair in pairs)
        parts = 1 if len(both[0]) <= 2 * CHUNK else 4
        if len(which):
            stack += zip(*(np.array_split(y, parts) for y in both), strict=True)
    if not results:
        return np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0), vague
    of, place, error = (np.concatenate(y) for y in zip(*results, strict=True))
    sure = ~np.isin(of, list(vague))
    return of[sure], place[sure], error[sure], vague


def _refined(
    values: Values,
    degree: int,
    which: Ints,
    middle: Floats,
    half: Floats,
    p: Floats,
    circle: bool,
) -> tuple[Bools, Floats, Floats]:
    """Return which of some single zeros are flat, and place and error of the others.

    The last two steps of Newton are taken with the polynomial itself, not with its coefficients.
    The size of the last step is part of the error.
    """
    s, slope = _bracketed(p @ bernstein(degree)[2])
    flat = np.abs(slope) < FLAT * np.abs(p).max(axis=1)
    which, middle, half, s, slope = (x[~flat] for x in (which, middle, half, s, slope))
    u = half * s
    t = middle + (2 * np.arctan(u) if circle else u)
    weight = (1 + u * u) ** (degree // 2) if circle else 1.0
    steep = slope / half / weight * ((1 + u * u) / 2 if circle else 1.0)
    step = error = np.zeros(len(t))
    for _ in range(2):
        best = values(which, t[:, None])
        step, error = best.value[:, 0] / steep, best.error[:, 0]
        t = t - step
    return flat, t, 2 * error / np.abs(steep) + np.abs(step) + 4 * UNIT * (1 + np.abs(t))


def _bracketed(p: Floats) -> tuple[Floats, Floats]:
    """Return the one zero in (-1, 1) of polynomials (n, powers), and the slope there."""
    low, high = np.full(len(p), -1.0), np.ones(len(p))
    first, last = p @ (-1.0) ** np.arange(p.shape[1]), p.sum(axis=1)
    s, rising = np.clip((first + last) / (first - last), -1, 1), first < 0
    for _ in range(60):
        value, slope = _horner(p, s)
        up = (value < 0) == rising
        low, high = np.where(up, s, low), np.where(up, high, s)
        with np.errstate(all="ignore"):
            new = s - value / slope
        new = np.where((new > low) & (new < high), new, (low + high) / 2)
        if np.abs(new - s).max() < 1e-6:  # `_refined` goes on
            break
        s = new
    return new, _horner(p, new)[1]


def _horner(p: Floats, s: Floats) -> tuple[Floats, Floats]:
    """Return values and slopes of polynomials at their own places."""
    value, slope = p[:, -1], np.zeros(len(p))
    for k in range(p.shape[1] - 2, -1, -1):
        value, slope = value * s + p[:, k], slope * s + value
    return value, slope
