"""Triangles that fill a polygon exactly, by shapely (not in the paper)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

from qbound.extras import require

Corner = tuple[Fraction, Fraction]
Triangle = tuple[int, int, int]


class CrossesItself(ValueError):
    """Of loops that cross themselves or each other, or do not have the inside on their left."""


def triangulate(loops: Sequence[Sequence[Corner]]) -> list[Triangle]:
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
    CrossesItself
        A `ValueError`.

    Notes
    -----
    Decimals times a power of ten are whole numbers, which doubles hold exactly up to ``2**53``,
    more than `statements.DIGITS` need. What longer decimals may spoil the checkers refuse.
    """
    require("shapely", "the proof of a polygon (its triangles)")
    import shapely

    if min(map(len, loops)) < 3:
        raise ValueError("a loop of a polygon has 3 corners or more")
    whole = math.lcm(*(x.denominator for loop in loops for place in loop for x in place))
    rings = [[(float(x * whole), float(y * whole)) for x, y in loop] for loop in loops]
    outline, *holes = sorted(rings, key=lambda ring: -shapely.Polygon(ring).area)
    polygon = shapely.Polygon(outline, holes)
    turned = [shapely.LinearRing(ring).is_ccw for ring in (outline, *holes)]
    if not polygon.is_valid or turned != [True, *(False for _ in holes)]:
        reason = shapely.is_valid_reason(polygon)
        why = "the polygon crosses itself, or its inside is not on the left"
        raise CrossesItself(f"{why}: {reason}")
    triangles = shapely.orient_polygons(shapely.constrained_delaunay_triangles(polygon))
    number = {place: k for k, place in enumerate(place for ring in rings for place in ring)}
    corners = [[number[place] for place in part.exterior.coords[:3]] for part in triangles.geoms]
    return [(a, b, c) for a, b, c in corners]
