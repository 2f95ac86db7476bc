"""Convex parts of an outline, exact: cut for a certificate.

An outline is a list of corners with two rational coordinates; parts are lists of their numbers, in
the sense of the outline. A corner in the middle of a straight edge stays a corner, so that inner
edges meet whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from qbound.geometry.convex import (
    Whole,
    ahead,
    convex_parts,
    doubled_area,
    edges_of,
    in_whole_numbers,
    side,
)
from qbound.model.robot import BodyPair, Robot
from qbound.printable import printable

Corner = tuple[Fraction, ...]


def cut(corners: Sequence[Corner]) -> list[list[int]]:
    """Cut an outline into convex parts.

    Raises
    ------
    ValueError
        If it crosses itself.
    """
    whole = in_whole_numbers(corners)
    parts = [_with_straight_corners(whole, part) for part in convex_parts(whole, exact=True)]
    return parts if doubled_area(whole) > 0 else [part[::-1] for part in parts]


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


def _with_straight_corners(corners: Sequence[Whole], part: Sequence[int]) -> list[int]:
    """Put back the corners of the outline that lie within the edges of a part."""
    found = []
    for i, k in edges_of(part):
        start, end = corners[i], corners[k]
        on = {
            m: ahead(start, end, corner)
            for m, corner in enumerate(corners)
            if side(start, end, corner) == 0
        }
        within = [m for m, far in on.items() if 0 < far < ahead(start, end, end)]
        found += [i, *sorted(within, key=lambda m: on[m])]
    return found
