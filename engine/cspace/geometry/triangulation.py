"""Polygons with holes, filled with triangles of their own corners; exact numbers look them over."""

from __future__ import annotations

from collections.abc import Sequence

from cspace.extras import require
from cspace.geometry.convex import Whole, doubled_area, edges_of

Triangle = tuple[int, int, int]


def triangulated(loops: Sequence[Sequence[Whole]]) -> list[Triangle]:
    """Fill a polygon, convex or not, with or without holes, with triangles.

    Shapely finds the triangles (constrained Delaunay) from corners that are doubles there; that
    every triangle has an area, and all together the area of the polygon, is asked of the corners.

    Parameters
    ----------
    loops : sequence of sequence of (int, int)
        Corners with the inside on the left: one outline anticlockwise, holes clockwise, each of
        three corners or more. A corner may lie on the straight line between its neighbours. Loops
        may touch in a common corner; triangles then use the higher one of its two numbers.

    Returns
    -------
    list of (int, int, int)
        Numbers of corners, loop after loop; each triangle anticlockwise and with an area.

    Raises
    ------
    ValueError
        If the loops cross or touch themselves or each other, or have the inside on the right, or
        if their corners have more digits than doubles.
    ModuleNotFoundError
        If shapely is missing; it comes with ``cspace[proofs]``.

    Examples
    --------
    >>> square, hole = [(0, 0), (9, 0), (9, 9), (0, 9)], [(3, 3), (3, 6), (6, 6), (6, 3)]
    >>> len(triangulated([square, hole]))
    8
    >>> triangulated([[(0, 0), (4, -1), (8, 0), (4, 1)]])
    [(0, 1, 3), (1, 2, 3)]
    """
    require("shapely", "a certificate of a polygon")
    from shapely import Polygon, constrained_delaunay_triangles, is_valid_reason

    if any(len(set(loop)) < len(loop) for loop in loops):
        raise ValueError("a loop passes a corner twice: it crosses or touches itself")
    outline, *holes = sorted(loops, key=lambda loop: -abs(doubled_area(loop)))
    if doubled_area(outline) <= 0 or any(doubled_area(hole) >= 0 for hole in holes):
        raise ValueError("the inside of a loop is not on its left")
    try:
        whole = Polygon(outline, holes)
    except OverflowError:
        raise ValueError("corners have more digits than doubles") from None
    if not whole.is_valid:
        raise ValueError(is_valid_reason(whole))
    places = [place for loop in loops for place in loop]
    number = {(float(x), float(y)): k for k, (x, y) in enumerate(places)}
    numbers = [[number[float(x), float(y)] for x, y in loop] for loop in loops]
    walls = {edge for loop in numbers for edge in edges_of(loop)}
    found, covered = list[Triangle](), 0
    for triangle in constrained_delaunay_triangles(whole).geoms:
        i, j, k = (number[x, y] for x, y in triangle.exterior.coords[:3])
        area = doubled_area([places[i], places[j], places[k]])
        j, k = (j, k) if area > 0 else (k, j)
        walls -= {(i, j), (j, k), (k, i)}
        found.append(min((i, j, k), (j, k, i), (k, i, j)))
        covered += abs(area) if area else doubled_area(outline)
    if walls or covered != sum(map(doubled_area, loops)):
        raise ValueError("a corner touches an edge, or is too near to it for its digits")
    return sorted(found)
