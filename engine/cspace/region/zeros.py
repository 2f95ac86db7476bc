"""Arrays with bounds of their errors, and the zeros of polynomials on intervals.

The zeros are isolated with Bernstein's coefficients: all of one sign mean no zero, one change of
sign means one zero, else the interval is cut. A coefficient within its error has no sign. With
tan((t - middle) / 2) a trigonometric polynomial is a polynomial, too (sentence 3).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from math import comb
from typing import Any

import numpy as np

from cspace.arrays import Array, Bools, Floats, Ints
from cspace.region.kinds import taken
from cspace.tolerances import UNIT

CHUNK = 8192
"""Intervals that are looked at together: some 10 MB."""

NARROW, SHARP = 1e-5, 1e-6
"""An interval shorter than the one, or a zero with an error above the other, is undecided."""

FEW, CUTS = 256, {2: (0.47,), 4: (0.22, 0.47, 0.73)}
"""Fewer intervals are cut in four, others in two; and where."""

MOST = 100
"""Intervals of one polynomial that are cut; one that asks for more is undecided."""

FLAT = 1e-3
"""A slope below this part of the coefficients tells of another zero near by."""


Values = Callable[[Ints, Floats], Floats]
"""Polynomials by number, (n,), at their own places (n, k)."""

Doubts = Callable[[Ints, Floats], Floats]
"""Bounds of the errors of their values, at one place each, (n,)."""

Zeros = tuple[Ints, Floats, Floats, set[int]]
"""Number of the polynomial, place and error of each zero; and the undecided polynomials."""

Parts = tuple[Any, ...]
"""Polynomials by number, ends of intervals, and whether zeros are known there."""


@cache
def bernstein(degree: int) -> tuple[Floats, Floats, Floats]:
    """Return nodes in [-1, 1], both ends among them, and two matrices (sentence 3).

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
    doubts: Doubts,
    errors: Floats,
    degree: int,
    start: Floats,
    end: Floats,
    circle: bool,
    known: tuple[Bools, Bools],
) -> Zeros:
    """Return the zeros of polynomials of a degree, each in its own interval (sentence 3).

    Parameters
    ----------
    values, doubts : callable
        The polynomials' values, and bounds of the errors of values at one place.
    errors : ndarray, shape (n,)
        Bounds of the errors of each polynomial's values, anywhere.
    circle : bool
        Whether they are trigonometric polynomials, of half the degree.
    known : pair of ndarray of bool
        Whether there is a known zero at the start, at the end; it is left out.
    """
    n, to_powers = len(start), bernstein(degree)[2]
    results = [(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0))]
    vague = set[int]()
    halved = np.zeros(n, dtype=np.int64)
    every: Parts = (np.arange(n), start, end, *known)
    stack = [tuple(x[k : k + CHUNK] for x in every) for k in range(0, n, CHUNK)]
    single: list[tuple[Any, Floats]] = []
    while stack or single:
        if stack:
            parts = stack.pop()
            p, sign = _coefficients(values, errors, degree, parts, circle)
            none = (sign == sign[:, :1]).all(axis=1) & (sign[:, 0] != 0)
            changes = np.abs(sign[:, 1:] - sign[:, :-1]).sum(axis=1)
            one = (changes == 2) & (sign[:, 0] * sign[:, -1] == -1)
            one &= np.count_nonzero(sign, axis=1) >= degree
            if one.any():
                single.append((taken(one, *parts), p[one] @ to_powers))
            rest = ~(none | one)
            if not rest.any():
                continue
            stuck = ~sign.any(axis=1) & rest
            vague.update(parts[0][stuck].tolist())
            rest &= ~stuck
        else:  # zeros that are alone; where a slope is flat there may be another one near by
            parts = tuple(np.concatenate(y) for y in zip(*(own for own, _ in single), strict=True))
            p, single = np.concatenate([p for _, p in single]), []
            rest, t, radius = _refined(values, doubts, parts, p, circle)
            which, good = parts[0][~rest], radius < SHARP
            vague.update(which[~good].tolist())
            results.append((which[good], t[good], radius[good]))
        parts = taken(rest, *parts)
        which, a, b = parts[:3]
        np.add.at(halved, which, 1)
        stuck = (b - a < NARROW) | (halved[which] > MOST)
        if stuck.any():
            vague.update(which[stuck].tolist())
            parts = taken(~stuck, *parts)
        if len(parts[0]):
            stack += _cut(parts)
    of, place, error = (np.concatenate(y) for y in zip(*results, strict=True))
    if vague:
        sure = ~np.isin(of, list(vague))
        of, place, error = of[sure], place[sure], error[sure]
    return of, place, error, vague


def _coefficients(
    values: Values, errors: Floats, degree: int, parts: Parts, circle: bool
) -> tuple[Floats, Array]:
    """Return Bernstein's coefficients of polynomials on intervals, and their signs; 0 in doubt."""
    which, a, b, at_start, at_end = parts
    nodes, to_bernstein, _ = bernstein(degree)
    middle, half = (a + b) / 2, np.tan((b - a) / 4) if circle else (b - a) / 2
    x = half[:, None] * nodes
    p = values(which, middle[:, None] + (2 * np.arctan(x) if circle else x))
    doubt = errors[which]
    if circle:
        p = p * (1 + x * x) ** (degree // 2)
        doubt = doubt * (1 + half * half) ** (degree // 2)
    p = p @ to_bernstein
    limit = doubt[:, None] * np.abs(to_bernstein).sum(axis=0)
    sign = (p > limit).astype(np.int8) - (p < -limit)
    sign[at_start, 0], sign[at_end, -1] = sign[at_start, 1], sign[at_end, -2]
    return p, sign


def _cut(parts: Parts) -> list[Parts]:
    """Cut intervals in four, or, of many, in two."""
    which, a, b, at_start, at_end = parts
    n = 4 if len(which) < FEW else 2
    at = np.stack([a, *(a + cut * (b - a) for cut in CUTS[n]), b])
    ends = np.zeros((2, n, len(which)), dtype=np.bool_)
    ends[0, 0], ends[1, -1] = at_start, at_end
    pieces = np.tile(which, n), at[:-1].ravel(), at[1:].ravel(), *ends.reshape(2, -1)
    if len(pieces[0]) <= 2 * CHUNK:
        return [pieces]
    return list(zip(*(np.array_split(y, 4) for y in pieces), strict=True))


def _refined(
    values: Values, doubts: Doubts, parts: Any, p: Floats, circle: bool
) -> tuple[Bools, Floats, Floats]:
    """Return which of some single zeros are flat, and place and error of the others (sentence 3).

    The last two steps of Newton are taken with the polynomial itself, not with its coefficients
    ``p``, powers of s in [-1, 1]. The size of the last step is part of the error.
    """
    s, slope = _bracketed(p)
    flat = np.abs(slope) < FLAT * np.abs(p).max(axis=1)
    which, a, b = (x[~flat] for x in parts[:3])
    s, slope = s[~flat], slope[~flat]
    half = np.tan((b - a) / 4) if circle else (b - a) / 2
    u, t, steep = half * s, (a + b) / 2, slope / half
    if circle:
        t = t + 2 * np.arctan(u)
        steep = steep / (1 + u * u) ** (p.shape[1] // 2 - 1) / 2
    else:
        t = t + u
    step = np.zeros(len(t))
    for _ in range(2):
        step = values(which, t[:, None])[:, 0] / steep
        t = t - step
    return flat, t, 2 * doubts(which, t) / np.abs(steep) + np.abs(step) + 4 * UNIT * (1 + np.abs(t))


def _bracketed(p: Floats) -> tuple[Floats, Floats]:
    """Return the one zero in (-1, 1) of polynomials (n, powers), and the slope there."""
    slopes = p[:, 1:] * np.arange(1, p.shape[1])
    low, high = np.full(len(p), -1.0), np.ones(len(p))
    first, last = p @ (-1.0) ** np.arange(p.shape[1]), p.sum(axis=1)
    # At an end with a known zero the value is rounding.
    known = np.minimum(np.abs(first), np.abs(last)) < 1e-6 * np.abs(p).max(axis=1)
    new = np.where(known, 0.0, np.clip((first + last) / (first - last), -1, 1))
    rising = last > first
    powers = np.ones_like(p)
    with np.errstate(all="ignore"):
        for _ in range(60):
            s = new
            powers[:, 1:] = s[:, None]
            np.cumprod(powers, axis=1, out=powers)
            value, slope = (p * powers).sum(axis=1), (slopes * powers[:, :-1]).sum(axis=1)
            up = (value < 0) == rising
            low, high = np.where(up, s, low), np.where(up, high, s)
            new = s - value / slope
            new = np.where((new > low) & (new < high), new, (low + high) / 2)
            if np.abs(new - s).max() < 1e-6:  # `_refined` goes on
                break
    return new, slope
