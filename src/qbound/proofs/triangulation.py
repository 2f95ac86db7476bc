"""Triangles that fill a polygon exactly: ears are clipped by exact signs (not in the paper)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import pairwise

Place = tuple[Fraction, Fraction]
Triangle = tuple[int, int, int]


def triangulate(loops: Sequence[Sequence[Place]]) -> list[Triangle]:
    """Fill a polygon, convex or not, with or without holes, by triangles of its own corners.

    Parameters
    ----------
    loops : sequence of sequence of (Fraction, Fraction)
        Corners with the inside on the left: the outline anticlockwise, holes clockwise.

    Returns
    -------
    list of (int, int, int)
        Indices into all corners, loop after loop; each triangle anticlockwise.

    Raises
    ------
    ValueError
        If a loop crosses itself or another one, or does not have the inside on its left.
    """
    places = [place for loop in loops for place in loop]
    starts = [sum(map(len, loops[:i])) for i in range(len(loops))]
    rings = [
        list(range(start, start + len(loop))) for start, loop in zip(starts, loops, strict=True)
    ]
    outline, *holes = sorted(rings, key=lambda ring: -_area([places[i] for i in ring]))
    for hole in sorted(holes, key=lambda ring: -max(places[i][0] for i in ring)):
        outline = _bridged(places, outline, hole, [ring for ring in rings if ring != outline])
    return _ears(places, outline)


def cross(a: Place, b: Place, c: Place) -> Fraction:
    """Return twice the signed area of a triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _area(places: Sequence[Place]) -> Fraction:
    origin = places[0]
    return sum((cross(origin, b, c) for b, c in pairwise(places)), Fraction(0))


def _ears(places: Sequence[Place], ring: list[int]) -> list[Triangle]:
    """Clip ears until a triangle is left."""
    ring, found, start = list(ring), [], 0
    while len(ring) > 2:
        turns = [(start + i) % len(ring) for i in range(len(ring))]
        ear = next((i for i in turns if _is_ear(places, ring, i)), None)
        if ear is None:
            raise ValueError("the polygon crosses itself, or its inside is not on the left")
        found.append((ring[ear - 1], ring[ear], ring[(ear + 1) % len(ring)]))
        del ring[ear]
        start = ear  # next to the last ear, so that triangles do not all share one corner
    return found


def _is_ear(places: Sequence[Place], ring: list[int], i: int) -> bool:
    """Tell whether corner i turns left and no other corner lies in its closed triangle."""
    a, b, c = (places[ring[(i + k) % len(ring)]] for k in (-1, 0, 1))
    if cross(a, b, c) <= 0:
        return False
    others = (p for p in (places[k] for k in ring) if p not in (a, b, c))
    return not any(
        cross(a, b, p) >= 0 and cross(b, c, p) >= 0 and cross(c, a, p) >= 0 for p in others
    )


def _bridged(
    places: Sequence[Place], outline: list[int], hole: list[int], rings: Sequence[list[int]]
) -> list[int]:
    """Join a hole to the outline by the shortest bridge that crosses no edge, there and back."""
    walks = [*rings, outline]
    edges = [(places[w[k - 1]], places[w[k]]) for w in walks for k in range(len(w))]
    pairs = [(i, k) for i in range(len(outline)) for k in range(len(hole))]
    pairs.sort(key=lambda ik: _distance(places[outline[ik[0]]], places[hole[ik[1]]]))
    for i, k in pairs:
        if not any(_meet(places[outline[i]], places[hole[k]], *edge) for edge in edges):
            return outline[: i + 1] + hole[k:] + hole[: k + 1] + outline[i:]
    raise ValueError("the loops of the polygon cross each other")


def _distance(a: Place, b: Place) -> Fraction:
    return (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2


def _meet(a: Place, b: Place, c: Place, d: Place) -> bool:
    """Tell whether two segments meet elsewhere than in a common end."""
    if {a, b} & {c, d}:
        return False
    return (
        cross(a, b, c) * cross(a, b, d) <= 0
        and cross(c, d, a) * cross(c, d, b) <= 0
        and any((cross(a, b, c), cross(a, b, d)))
    )
