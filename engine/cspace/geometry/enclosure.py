"""The area that a plane path encloses: all places that the path separates from infinity.

The path may cross itself, touch itself, and run along itself. Its crossings are fractions of whole
numbers, so nothing is rounded before the places of the answer.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import cmp_to_key
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Bools, Floats
from cspace.geometry import polygon
from cspace.geometry.convex import ahead, in_whole_numbers, meet, side

Node = tuple[Any, Any]
"""A place in whole numbers, or in fractions where pieces cross."""
Graph = dict[Node, set[Node]]


def enclosed(path: ArrayLike) -> list[Floats]:
    """Return the outlines of the area that a plane path encloses: simple loops, anticlockwise.

    Two loops have at most corners in common, and none lies in another. A closed path repeats its
    start at its end. An open path encloses the area between its crossings.

    Parameters
    ----------
    path : array_like, shape (m, 2)

    Examples
    --------
    >>> [loop.tolist() for loop in enclosed([[0, 0], [2, 2], [2, 0], [0, 2]])]
    [[[1.0, 1.0], [2.0, 0.0], [2.0, 2.0]]]
    >>> square = [[0, 0], [1, 0], [1, 1], [0, 1], [0, 0]]
    >>> area(enclosed(square)), enclosed(square[:-1])
    (1.0, [])
    """
    p = np.asarray(path, dtype=float)
    p = p[np.append((np.diff(p, axis=0) != 0).any(axis=1), True)]
    corners = in_whole_numbers(p)
    places: dict[Node, Floats] = dict(zip(corners, p, strict=True))
    on_piece: list[set[Node]] = [set(ends) for ends in pairwise(corners)]
    for i, j in zip(*(k.tolist() for k in polygon.near_boxes(p[:-1], p[1:])), strict=True):
        a, b, c, d = corners[i], corners[i + 1], corners[j], corners[j + 1]
        if (b == c and side(a, b, d)) or not meet(a, b, c, d):
            continue
        from_a, from_b = side(c, d, a), side(c, d, b)
        common: list[Node]
        if from_a == from_b:  # both run along each other
            common = sorted((a, b, c, d))[1:3]
        else:
            t = Fraction(from_a, from_a - from_b)
            common = [(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]))]
            places.setdefault(common[0], p[i] + float(t) * (p[i + 1] - p[i]))
        on_piece[i].update(common)
        on_piece[j].update(common)
    graph: Graph = defaultdict(set)
    for nodes in on_piece:
        for one, other in pairwise(sorted(nodes)):  # in order along the piece
            graph[one].add(other)
            graph[other].add(one)
    loops = _simple(_round(graph)) if graph else []
    return [np.array([places[node] for node in loop]) for loop in loops]


def area(loops: Iterable[Floats]) -> float:
    """Return the area within some loops of `enclosed`."""
    return float(sum(polygon.area(loop) for loop in loops))


def contains(loops: Iterable[Floats], places: ArrayLike) -> Bools:
    """Tell whether places, shape (..., 2), lie in one of some loops of `enclosed`."""
    at = np.asarray(places, dtype=float)
    inside = np.zeros(at.shape[:-1], dtype=np.bool_)
    for loop in loops:
        inside |= polygon.contains(loop, at)
    return inside


def _round(graph: Graph) -> Iterator[Node]:
    """Walk round all edges with the outside on the right, from the leftmost node back to it."""
    start = here = min(graph)
    before: Node = (start[0] - 1, start[1])
    first = None
    while True:
        after = _rightmost(before, here, graph[here])
        if first is None:
            first = after
        elif (here, after) == (start, first):
            return
        yield here
        before, here = here, after


def _rightmost(before: Node, here: Node, choices: set[Node]) -> Node:
    """Return the next node of a walk: the rightmost way, and back only at an end."""

    def turn(one: Node, other: Node) -> Any:
        return quarter(one) - quarter(other) or side(here, other, one)

    def quarter(node: Node) -> int:  # anticlockwise from where the walk came from
        left = side(here, before, node)
        if left:
            return 0 if left > 0 else 2
        return 3 if ahead(here, before, node) > 0 else 1

    return min(choices, key=cmp_to_key(turn))


def _simple(walk: Iterable[Node]) -> Iterator[list[Node]]:
    """Cut a closed walk into loops that visit no node twice; drop ways to an end and back."""
    taken, number = list[Node](), dict[Node, int]()
    for node in walk:
        k = number.setdefault(node, len(taken))
        if k < len(taken):
            loop = taken[k:]
            if len(loop) > 2:
                yield loop
            for left in taken[k + 1 :]:
                del number[left]
            del taken[k + 1 :]
        else:
            taken.append(node)
    if len(taken) > 2:
        yield taken
