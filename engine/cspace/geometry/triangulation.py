"""Polygons with holes, filled with triangles of their own corners by exact predicates.

Coordinates are whole numbers, so nothing is rounded. Bridges join holes to the outline, ears are
cut off until nothing is left, and cuts are flipped until no circle through the corners of a
triangle holds a corner beyond one of its cuts. The result is the constrained Delaunay
triangulation, whose triangles are the roundest. Doubles are only used to choose candidates for the
exact tests.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from cspace.arrays import Floats
from cspace.geometry.convex import Whole, ahead, doubled_area, edges_of, meet, side
from cspace.geometry.polygon import near_boxes

Triangle = tuple[int, int, int]


def triangulated(loops: Sequence[Sequence[Whole]]) -> list[Triangle]:
    """Fill a polygon, convex or not, with or without holes, with triangles.

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
        If the loops cross or touch themselves or each other, or have the inside on the right.

    Notes
    -----
    For m corners the cost is about m times the number of corners that turn right.

    Examples
    --------
    >>> square, hole = [(0, 0), (9, 0), (9, 9), (0, 9)], [(3, 3), (3, 6), (6, 6), (6, 3)]
    >>> len(triangulated([square, hole]))
    8
    >>> triangulated([[(0, 0), (4, -1), (8, 0), (4, 1)]])
    [(0, 1, 3), (1, 2, 3)]
    """
    places = [place for loop in loops for place in loop]
    number = {place: k for k, place in enumerate(places)}
    numbers = [[number[place] for place in loop] for loop in loops]
    if any(len(set(loop)) < len(loop) for loop in numbers):
        raise ValueError("a loop passes a corner twice: it crosses or touches itself")
    edges = [edge for loop in numbers for edge in edges_of(loop)]
    if (fault := crossing(places, edges)) is not None:
        raise ValueError(f"edges cross or touch at {fault}")
    areas = [doubled_area([places[k] for k in loop]) for loop in numbers]
    order = sorted(range(len(numbers)), key=lambda k: -abs(areas[k]))
    outline, *holes = (numbers[k] for k in order)
    if areas[order[0]] <= 0 or any(areas[k] >= 0 for k in order[1:]):
        raise ValueError("the inside of a loop is not on its left")
    for hole in holes:
        others = [loop for loop in holes if loop is not hole]
        if not all(_holds(places, outline, hole)) or any(
            any(_holds(places, other, hole)) for other in others
        ):
            raise ValueError("a hole is not inside the outline, or is inside another hole")
    whole = _bridged(places, outline, holes, edges)
    return _flipped(places, list(_ears(places, whole)), edges)


# --- loops that cross nowhere ---------------------------------------------------------------------


def crossing(places: Sequence[Whole], edges: Sequence[tuple[int, int]]) -> Whole | None:
    """Return a corner near which edges cross, or touch not at a common corner; else None."""
    boxes = _boxes(places, edges)
    near = near_boxes(boxes[:, :2], boxes[:, 2:])
    for one, other in zip(*(k.tolist() for k in near), strict=True):
        first, second = edges[int(one)], edges[int(other)]
        if _touch(places, first, second):
            return places[first[0]]
    return None


def _boxes(places: Sequence[Whole], edges: Sequence[tuple[int, int]]) -> Floats:
    """Return the upright box of each edge, a little too large: low x, low y, high x, high y."""
    at = np.array(places, dtype=float)
    ends = at[np.array(edges, dtype=np.intp)]
    room = 1e-15 * np.abs(at).max()
    return np.hstack([ends.min(axis=1) - room, ends.max(axis=1) + room])


def _touch(places: Sequence[Whole], one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Tell whether two edges have a common point other than a common end."""
    shared = set(one) & set(other)
    if shared:  # neighbours touch only if one goes back over the other
        (common,) = shared if len(shared) == 1 else (min(shared),)
        a, b, c = places[common], *(places[sum(edge) - common] for edge in (one, other))
        return len(shared) == 2 or (side(a, b, c) == 0 and ahead(a, b, c) > 0)
    return meet(*(places[end] for end in (*one, *other)))


def _holds(places: Sequence[Whole], loop: Sequence[int], other: Sequence[int]) -> Iterator[bool]:
    """Tell whether the middle of each edge of another loop lies inside a loop.

    If the loops touch nowhere, the first edge decides for all.
    """
    ends = [sorted((places[i], places[j]), key=lambda place: place[1]) for i, j in edges_of(loop)]
    twice = [((2 * a[0], 2 * a[1]), (2 * b[0], 2 * b[1])) for a, b in ends]
    edges = edges_of(other)
    for i, j in edges if set(loop) & set(other) else edges[:1]:
        at = places[i][0] + places[j][0], places[i][1] + places[j][1]
        above = (a[1] <= at[1] < b[1] and side(a, b, at) > 0 for a, b in twice)
        yield sum(above) % 2 == 1


# --- one loop, and its ears -----------------------------------------------------------------------


def _bridged(
    places: Sequence[Whole],
    outline: list[int],
    holes: Sequence[list[int]],
    edges: Sequence[tuple[int, int]],
) -> list[int]:
    """Join holes to an outline by bridges that are run both ways; one loop, corners repeated.

    The rightmost hole comes first, from its rightmost corner to the nearest corner that it sees. A
    bridge crosses no edge of any loop, and no bridge before it.
    """
    whole, walls = list(outline), list(edges)
    for hole in sorted(holes, key=lambda loop: -max(places[k][0] for k in loop)):
        touched = next((k for k in range(len(whole)) if _opens(places, whole, k, hole)), None)
        if touched is not None:
            at = hole.index(whole[touched])
            whole[touched + 1 : touched + 1] = [*hole[at + 1 :], *hole[: at + 1]]
            continue
        start = max(hole, key=lambda k: places[k])
        x, y = places[start]
        nearest = sorted(
            range(len(whole)),
            key=lambda k: (places[whole[k]][0] - x) ** 2 + (places[whole[k]][1] - y) ** 2,
        )
        boxes = _boxes(places, walls)
        seen = next(k for k in nearest if _sees(places, walls, boxes, start, whole, k))
        turned = hole[hole.index(start) :] + hole[: hole.index(start)]
        walls.append((whole[seen], start))
        whole[seen + 1 : seen + 1] = [*turned, start, whole[seen]]
    return whole


def _opens(places: Sequence[Whole], whole: Sequence[int], k: int, hole: Sequence[int]) -> bool:
    """Tell whether a hole touches a loop in its k-th corner, on the loop's left."""
    if whole[k] not in hole:
        return False
    after = hole[(hole.index(whole[k]) + 1) % len(hole)]
    return _is_left(places, whole, k, places[after])


def _is_left(places: Sequence[Whole], whole: Sequence[int], k: int, at: Whole) -> bool:
    """Tell whether a place, seen from the k-th corner of a loop, lies between its edges, inside."""
    a, b, c = (places[i] for i in (whole[k - 1], whole[k], whole[(k + 1) % len(whole)]))
    left = side(a, b, at) > 0, side(b, c, at) > 0
    return all(left) if side(a, b, c) > 0 else any(left)


def _sees(
    places: Sequence[Whole],
    walls: Sequence[tuple[int, int]],
    boxes: Floats,
    start: int,
    whole: Sequence[int],
    k: int,
) -> bool:
    """Tell whether a bridge from a corner of a hole to corner k of a loop crosses no edge."""
    end = whole[k]
    if not _is_left(places, whole, k, places[start]):
        return False
    bridge = (start, end)
    low_x, low_y, high_x, high_y = _boxes(places, [bridge])[0]
    near = (boxes[:, 0] <= high_x) & (boxes[:, 2] >= low_x)
    near &= (boxes[:, 1] <= high_y) & (boxes[:, 3] >= low_y)
    return not any(_touch(places, bridge, walls[j]) for j in np.flatnonzero(near).tolist())


def _ears(places: Sequence[Whole], loop: Sequence[int]) -> Iterator[Triangle]:
    """Cut ears off a loop, which may repeat corners, until a triangle is left.

    A simple polygon always has an ear: a corner that turns left, no other corner in its triangle.
    Only corners that do not turn left need to be checked for that.
    """
    count = len(loop)
    before, after = [*range(-1, count - 1)], [*range(1, count), 0]
    before[0] = count - 1
    corner = [places[k] for k in loop]

    def turn(k: int) -> int:
        return side(corner[before[k]], corner[k], corner[after[k]])

    # A corner that turns left does so until it is cut off: only the others can hide an ear.
    at = np.array(corner, dtype=float)
    reflex = [turn(k) <= 0 for k in range(count)]
    order = np.array(sorted(np.flatnonzero(reflex).tolist(), key=lambda k: at[k, 0]), dtype=np.intp)
    sorted_at, room = at[order], 1e-15 * np.abs(at).max()

    def hidden(ear: Triangle) -> bool:
        a, b, c = (corner[k] for k in ear)
        box = at[list(ear)]
        (low_x, low_y), (high_x, high_y) = box.min(axis=0) - room, box.max(axis=0) + room
        first, last = np.searchsorted(sorted_at[:, 0], [low_x, high_x])
        y = sorted_at[first:last, 1]
        near = order[first:last][(y >= low_y) & (y <= high_y)].tolist()
        return any(
            p not in (a, b, c) and side(a, b, p) >= 0 and side(b, c, p) >= 0 and side(c, a, p) >= 0
            for p in (corner[k] for k in near if reflex[k])
        )

    here, left, passed = 0, count, 0
    while left > 3:
        i, k = before[here], after[here]
        if reflex[here] or hidden((i, here, k)):
            here, passed = k, passed + 1
            if passed > left:
                raise ValueError("the loops bound no simple polygon")
            continue
        yield loop[i], loop[here], loop[k]
        after[i], before[k], passed, left = k, i, 0, left - 1
        for near in (i, k):
            reflex[near] = turn(near) <= 0
        here = after[k]  # not the next one: a fan about one corner makes splinters
    i, k = before[here], after[here]
    if turn(here) > 0:
        yield loop[i], loop[here], loop[k]


# --- rounder triangles ----------------------------------------------------------------------------


def _flipped(
    places: Sequence[Whole], triangles: Sequence[Triangle], edges: Sequence[tuple[int, int]]
) -> list[Triangle]:
    """Flip every cut whose two triangles have each other's corner in their circles (Lawson)."""
    apex = dict[tuple[int, int], int]()
    for a, b, c in triangles:
        apex |= {(a, b): c, (b, c): a, (c, a): b}
    walls = set(edges)
    waiting = [edge for edge in apex if edge not in walls and edge[0] < edge[1]]
    while waiting:
        a, b = waiting.pop()
        if (a, b) not in apex:
            continue  # flipped since
        c, d = apex[a, b], apex[b, a]
        if not _in_circle(*(places[k] for k in (a, b, c, d))):
            continue
        del apex[a, b], apex[b, a]
        apex |= {(c, d): b, (d, b): c, (b, c): d, (d, c): a, (c, a): d, (a, d): c}
        sides = ((b, c), (c, a), (a, d), (d, b))
        waiting += [(i, j) for i, j in sides if (i, j) not in walls and (j, i) not in walls]
    return sorted({min((i, j, k), (j, k, i), (k, i, j)) for (i, j), k in apex.items()})


def _in_circle(a: Whole, b: Whole, c: Whole, d: Whole) -> bool:
    """Tell whether d lies inside the circle through the anticlockwise triangle a, b, c."""
    rows = [(p[0] - d[0], p[1] - d[1]) for p in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = rows
    aa, bb, cc = (x * x + y * y for x, y in rows)
    return ax * (by * cc - cy * bb) - ay * (bx * cc - cx * bb) + aa * (bx * cy - cx * by) > 0
