"""Simple polygons, recognized and cut into convex parts by exact predicates.

Floats are fractions whose denominator is a power of two. Multiplied by one of these powers, all
coordinates are whole numbers, and so is the number that tells on which side of a line a corner
lies. Nothing here is rounded. The rounding that is allowed for a user's corners is stated in one
place.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.geometry.polygon import near_boxes

Whole = tuple[int, int]
Loop = tuple[int, ...]
"""Corners by their numbers, in order."""


def polygon_fault(corners: ArrayLike) -> str | None:
    """Return why a closed outline is not a simple polygon, or None if it is one.

    Parameters
    ----------
    corners : array_like, shape (m, 2)
        Corners in order, in either sense; the last is joined to the first. A corner in the middle
        of a straight edge is allowed.

    Examples
    --------
    >>> polygon_fault([[0, 0], [2, 0], [2, 1], [0, 1]]) is None
    True
    >>> polygon_fault([[0, 0], [2, 1], [2, 0], [0, 1]])
    'the edges from corners 0 and 2 cross or touch'
    >>> polygon_fault([[0, 0], [1, 1], [3, 3]])
    'all corners lie on one line: it has no area'
    """
    p = in_whole_numbers(corners)
    n = len(p)
    first: dict[Whole, int] = {}
    for i, corner in enumerate(p):
        if (j := first.setdefault(corner, i)) != i:
            return f"corners {j} and {i} are one place"
    if not any(side(p[0], p[1], corner) for corner in p[2:]):
        return "all corners lie on one line: it has no area"
    if len(_bends(_outline(corners), range(n))) < 3:
        return "it is thinner than rounding beside its size"
    if _is_convex(p):
        return None
    for i in range(n):
        a, b, c = p[i - 1], p[i], p[(i + 1) % n]
        if side(a, b, c) == 0 and ahead(b, a, c) > 0:
            return f"it turns back on itself at corner {i}"
    for i, j in _near_edges(np.asarray(corners, dtype=float)):
        if meet(p[i], p[(i + 1) % n], p[j], p[(j + 1) % n]):
            return f"the edges from corners {i} and {j} cross or touch"
    return None


def convex_parts(corners: ArrayLike, *, exact: bool = False) -> tuple[Loop, ...]:
    """Cut a simple polygon into strictly convex parts that together are exactly the polygon.

    A corner within rounding (2 to the -38 of the polygon's size) of a straight edge counts as on
    it. Ears are cut off one by one. Then a cut is undone if both sides together are convex (Hertel
    and Mehlhorn). The result has at most four times the least possible number of parts.

    Parameters
    ----------
    corners : array_like, shape (m, 2)
        Corners of a simple polygon (`polygon_fault` checks this), in either sense.
    exact : bool
        Whether only corners that lie exactly on an edge count as on it.

    Returns
    -------
    tuple of tuple of int
        The corners of each part by their numbers, anticlockwise. A corner at which a part goes
        straight on is left out.

    Raises
    ------
    ValueError
        If the polygon is not simple.

    Examples
    --------
    >>> convex_parts([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]])
    ((2, 3, 0, 1), (3, 4, 5, 0))
    """
    if (fault := polygon_fault(corners)) is not None:
        raise ValueError(f"no simple polygon: {fault}")
    outline = _outline(corners)
    outline = replace(outline, slack=0) if exact else outline
    loop = _bends(outline, range(len(outline.at)))
    if doubled_area([outline.at[i] for i in loop]) < 0:
        loop = loop[::-1]
    if all(_turn(outline, loop, k) > 0 for k in range(len(loop))):
        return (loop,)
    parts = (_bends(outline, part) for part in _merged(outline, _triangles(outline, loop)))
    return tuple(part for part in parts if len(part) > 2)


def exact_parts(corners: Sequence[tuple[Fraction, ...]]) -> list[list[int]]:
    """Cut a simple polygon into convex parts with nothing rounded, in the sense of the polygon.

    A corner in the middle of a straight edge stays a corner, so that inner edges meet whole.

    Raises
    ------
    ValueError
        If the polygon is not simple.
    """
    at = in_whole_numbers(corners)
    found = []
    for part in convex_parts(at, exact=True):
        loop: list[int] = []
        for i, k in edges_of(part):
            far = {m: ahead(at[i], at[k], p) for m, p in enumerate(at) if not side(at[i], at[k], p)}
            within = [m for m in far if 0 < far[m] < far[k]]
            loop += [i, *sorted(within, key=lambda m: far[m])]
        found.append(loop)
    return found if doubled_area(at) > 0 else [loop[::-1] for loop in found]


@dataclass(frozen=True)
class Outline:
    """Corners in whole numbers.

    Attributes
    ----------
    at : list of (int, int)
    slack : int
        A corner no farther than this, divided by 2 to the 48, from a straight edge is on it.
    """

    at: list[Whole]
    slack: int


def _outline(corners: ArrayLike) -> Outline:
    """Return the corners as whole numbers, and the distance that is rounding for their size.

    The last bits of a typed or turned corner are wrong even if it is meant to lie on an edge. A
    bend there would cut the polygon into splinters whose distances cannot be computed.
    """
    at = in_whole_numbers(corners)
    columns = list(zip(*at, strict=True))
    size = max(max(column) - min(column) for column in columns)
    farthest = max(abs(x) for column in columns for x in column)
    return Outline(at, max(size << 10, farthest))


def in_whole_numbers(corners: ArrayLike | Sequence[tuple[Fraction, ...]]) -> list[Whole]:
    """Return corners, doubles or fractions, times the least number that makes all of them whole."""
    ratios = [x.as_integer_ratio() for x in np.asarray(corners, dtype=object).ravel().tolist()]
    scale = math.lcm(*(denominator for _, denominator in ratios))
    flat = [numerator * (scale // denominator) for numerator, denominator in ratios]
    return list(zip(flat[::2], flat[1::2], strict=True))


def side(a: Whole, b: Whole, c: Whole) -> int:
    """Return a positive number where c lies on the left of a line from a to b, 0 on it."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def ahead(a: Whole, b: Whole, c: Whole) -> int:
    """Return a positive number if the angle between b and c, seen from a, is acute."""
    return (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1])


def _is_convex(p: Sequence[Whole]) -> bool:
    """Tell whether an outline with an area, without repeated corners, is convex and goes once."""
    n = len(p)
    sides = {_sign(side(p[i - 1], p[i], p[(i + 1) % n])) for i in range(n)}
    rising = [p[i - 1] < p[i] for i in range(n)]
    once = sum(rising[i - 1] != rising[i] for i in range(n)) == 2
    return once and not {1, -1} <= sides


def _near_edges(corners: Floats) -> list[tuple[int, int]]:
    """Return pairs of edges without a common corner whose upright boxes have a common point."""
    first, second = near_boxes(corners, np.roll(corners, -1, axis=0))
    apart = (second > first + 1) & (second - first != len(corners) - 1)
    return list(zip(first[apart].tolist(), second[apart].tolist(), strict=True))


def meet(a: Whole, b: Whole, c: Whole, d: Whole) -> bool:
    """Tell whether the closed segments a-b and c-d have a point in common."""
    if _sign(side(a, b, c)) * _sign(side(a, b, d)) > 0:
        return False
    if _sign(side(c, d, a)) * _sign(side(c, d, b)) > 0:
        return False
    return all(
        max(min(a[k], b[k]), min(c[k], d[k])) <= min(max(a[k], b[k]), max(c[k], d[k]))
        for k in (0, 1)
    )


def _sign(x: int) -> int:
    return (x > 0) - (x < 0)


def doubled_area(p: Sequence[Whole]) -> int:
    """Return twice the area of a loop of places, positive if it goes round anticlockwise."""
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in pairwise([*p, p[0]]))


def _turn(outline: Outline, loop: Sequence[int], k: int) -> int:
    """Return 1 where a loop turns left at its k-th corner, -1 right, 0 straight on."""
    a, b, c = (outline.at[i] for i in (loop[k - 1], loop[k], loop[(k + 1) % len(loop)]))
    left = side(a, b, c)
    return 0 if abs(left) << 48 <= outline.slack * _extent(a, c) else _sign(left)


def _bends(outline: Outline, loop: Iterable[int]) -> Loop:
    """Return a loop without the corners at which it goes straight on."""
    left, k = list(loop), 0
    while k < len(left) > 2:
        if _turn(outline, left, k) == 0:
            del left[k]
        else:
            k += 1
    return tuple(left)


def _triangles(outline: Outline, loop: Loop) -> Iterator[Loop]:
    """Cut ears off an anticlockwise loop until a triangle is left.

    An ear holds no other corner inside or on its edges, and a simple polygon always has one. An ear
    that is more than rounding away from all other corners comes first, because it leaves no
    splinters.
    """
    left = list(loop)
    turns = [_turn(outline, left, k) for k in range(len(left))]
    while len(left) > 3:
        reflex = [corner for corner, turn in zip(left, turns, strict=True) if turn <= 0]
        k = next(
            k
            for clear in (True, False)
            for k, turn in enumerate(turns)
            if turn >= clear and _is_ear(outline, left, k, reflex, clear=clear)
        )
        yield left[k - 1], left[k], left[(k + 1) % len(left)]
        del left[k], turns[k]
        for near in (k - 1, k % len(left)):
            turns[near] = _turn(outline, left, near)
    yield tuple(left)


def _is_ear(
    outline: Outline, loop: Sequence[int], k: int, reflex: Sequence[int], *, clear: bool
) -> bool:
    """Tell whether a corner is an ear; only reflex corners need to be checked.

    With `clear`, no corner may be within rounding of the ear either.
    """
    ear = (loop[k - 1], loop[k], loop[(k + 1) % len(loop)])
    a, b, c = (outline.at[i] for i in ear)
    if side(a, b, c) <= 0:
        return False
    room = [-((outline.slack * _extent(*edge)) >> 48) * clear for edge in ((a, b), (b, c), (c, a))]
    return not any(
        side(a, b, p) >= room[0] and side(b, c, p) >= room[1] and side(c, a, p) >= room[2]
        for p in (outline.at[i] for i in reflex if i not in ear)
    )


def _extent(a: Whole, b: Whole) -> int:
    return max(abs(b[0] - a[0]), abs(b[1] - a[1]))


def _merged(outline: Outline, triangles: Iterable[Loop]) -> list[Loop]:
    """Join neighbours over every cut if both together are convex, one cut after the other."""
    by_edge: dict[tuple[int, int], Loop] = {}
    for part in triangles:
        joined = part
        while (found := _neighbour(outline, joined, by_edge)) is not None:
            other, joined = found
            for edge in edges_of(other):
                del by_edge[edge]
        by_edge |= dict.fromkeys(edges_of(joined), joined)
    return list(dict.fromkeys(by_edge.values()))


def _neighbour(
    outline: Outline, part: Loop, by_edge: Mapping[tuple[int, int], Loop]
) -> tuple[Loop, Loop] | None:
    """Find a part that is convex together with this one: that part, and both as one loop."""
    for i, (a, b) in enumerate(edges_of(part)):
        if (other := by_edge.get((b, a))) is None:
            continue
        j = other.index(a)
        on = (*other[j + 1 :], *other[:j])  # from behind a, round the other part, to b
        whole = (*part[i + 1 :], *part[: i + 1], *on[:-1])
        if all(_turn(outline, whole, whole.index(end)) >= 0 for end in (a, b)):
            return other, whole
    return None


def edges_of(loop: Sequence[int]) -> list[tuple[int, int]]:
    """Return the edges of a loop of corners, the last one back to the first corner."""
    return list(pairwise((*loop, loop[0])))
