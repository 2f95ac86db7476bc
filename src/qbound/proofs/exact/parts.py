"""Convex parts of an outline, exact: cut for a certificate.

An outline is a list of corners with two rational coordinates; parts are lists of their numbers, in
the sense of the outline. A corner in the middle of a straight edge stays a corner, so that inner
edges meet whole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from qbound.geometry.convex import convex_parts
from qbound.model.robot import BodyPair, Robot
from qbound.printable import printable

Corner = tuple[Any, ...]


def cut(corners: Sequence[Corner]) -> list[list[int]]:
    """Cut an outline into convex parts.

    Raises
    ------
    ValueError
        If it crosses itself.
    """
    whole = in_whole_numbers(corners)
    parts = [_with_straight_corners(whole, part) for part in convex_parts(whole, exact=True)]
    return parts if turns_left(whole) else [part[::-1] for part in parts]


def parts_of(robot: Robot) -> dict[str, list[list[int]]]:
    """Cut all outlines of pairs in use that are not convex, by the name of their body.

    Raises
    ------
    ValueError
        If an outline cannot be cut, or no axis of its frame is along that of the joints.
    """
    pairs = [boundary for boundary in robot.used if isinstance(boundary, BodyPair)]
    found = {}
    for name in dict.fromkeys(name for pair in pairs for name in pair.bodies):
        body = robot.body(name)
        if len(body.shape.places) < 3:
            continue
        own = robot.plane.flat_coordinate(body.frame)
        if own is None:
            raise ValueError(f"{printable(name)}: its frame has no axis along that of the joints")
        rows = [[x for k, x in enumerate(p) if k != own] for p in body.shape.places.tolist()]
        pieces = cut([tuple(Fraction(repr(x)) for x in row) for row in rows])
        if len(pieces) > 1:
            found[name] = pieces
    return found


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
    return bool(side(a, b, c) == 0 and 0 < ahead < _squared(a, b))


def _squared(a: Corner, b: Corner) -> Any:
    return sum((y - x) ** 2 for x, y in zip(a, b, strict=True))


def side(a: Corner, b: Corner, c: Corner) -> Any:
    """Return a positive number where c lies on the left of the line from a to b."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])


def _around(loop: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
    return zip(loop, [*loop[1:], loop[0]], strict=True)


def turns_left(corners: Sequence[Corner]) -> bool:
    """Tell whether an outline goes anticlockwise; `ValueError` if it has no area."""
    doubled = sum(a[0] * b[1] - b[0] * a[1] for a, b in _around(corners))
    if doubled == 0:
        raise ValueError("robot: an outline without an area")
    return bool(doubled > 0)
