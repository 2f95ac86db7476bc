"""Convex parts of an outline, exact: cut for a certificate, and verified for `check_arb`.

An outline is a list of corners with two rational coordinates; parts are lists of their numbers, in
the sense of the outline. A corner in the middle of a straight edge stays a corner, so that inner
edges meet whole.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from qbound.geometry.convex import convex_parts
from qbound.proofs.grammar_values import refuse, shown

Corner = tuple[Any, ...]
Edge = tuple[int, int]

LARGEST_WHOLE = 2**53
"""Whole numbers up to this are floats."""


def cut(corners: Sequence[Corner]) -> list[list[int]]:
    """Cut an outline into convex parts.

    Raises
    ------
    ValueError
        If it crosses itself, or its decimals are too long.
    """
    whole = in_whole_numbers(corners)
    if max(abs(x) for corner in whole for x in corner) > LARGEST_WHOLE:
        raise ValueError("an outline whose decimals are too long to be cut into convex parts")
    parts = [_with_straight_corners(whole, part) for part in convex_parts(whole, exact=True)]
    return parts if turns_left(whole) else [part[::-1] for part in parts]


def in_whole_numbers(corners: Sequence[Corner]) -> list[Corner]:
    """Return corners times a number that makes all coordinates whole."""
    scale = math.lcm(*(x.denominator for corner in corners for x in corner))
    return [tuple(int(x * scale) for x in corner) for corner in corners]


def _with_straight_corners(corners: Sequence[Corner], part: Sequence[int]) -> list[int]:
    """Put back the corners of the outline that lie within the edges of a part."""
    found = []
    for i, k in _around(part):
        on = [
            m
            for m in range(len(corners))
            if m not in (i, k) and _is_within(corners[i], corners[k], corners[m])
        ]
        found += [i, *sorted(on, key=lambda m: _squared(corners[i], corners[m]))]
    return found


def _is_within(a: Corner, b: Corner, c: Corner) -> bool:
    ahead = sum((y - x) * (z - x) for x, y, z in zip(a, b, c, strict=True))
    return bool(_side(a, b, c) == 0 and 0 < ahead < _squared(a, b))


def _squared(a: Corner, b: Corner) -> Any:
    return sum((y - x) ** 2 for x, y in zip(a, b, strict=True))


def _side(a: Corner, b: Corner, c: Corner) -> Any:
    """Return a positive number where c lies on the left of the line from a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])


def _around(loop: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    return zip(loop, [*loop[1:], loop[0]], strict=True)


def turns_left(corners: Sequence[Corner]) -> bool:
    """Tell whether an outline goes anticlockwise; `ValueError` if it has no area."""
    doubled = sum(a[0] * b[1] - b[0] * a[1] for a, b in _around(corners))
    if doubled == 0:
        refuse("robot: an outline without an area")
    return bool(doubled > 0)


def check_parts(corners: Sequence[Corner], parts: Sequence[Sequence[int]], name: str) -> None:
    """Refuse parts that are not convex, do not go with the outline, or do not fill it.

    Edges are compared by the places of their ends.
    """
    where = f"parts of {shown(name)}"
    corners = in_whole_numbers(corners)
    left = turns_left(corners)
    edges: Counter[Edge] = Counter()
    number = {corner: k for k, corner in enumerate(corners)}
    for part in parts:
        for i, k in _around(part):
            sides = [_side(corners[i], corners[k], corners[m]) for m in part]
            sides = sides if left else [-side for side in sides]
            if any(side < 0 for side in sides) or not any(sides):
                refuse(f"{where}: a part is not convex, flat, or goes the other way round")
        edges.update((number[corners[i]], number[corners[k]]) for i, k in _around(part))
    outline = Counter((number[a], number[b]) for a, b in _around(corners))
    if any(count > 1 for count in (*edges.values(), *outline.values())):
        refuse(f"{where}: an edge occurs twice")
    inner = edges - outline
    if any(edges[i, k] == 0 or edges[k, i] for i, k in outline):
        refuse(f"{where}: an edge of the outline is not of one part alone")
    if any(not inner[k, i] for i, k in inner):
        refuse(f"{where}: an inner edge has a part on one side alone")
