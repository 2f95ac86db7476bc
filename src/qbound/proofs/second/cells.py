"""Exact cells of a set, their halves and trees, and the check that triangles fill loops."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, product
from typing import Any

from qbound.proofs.second.reading import MOST_BYTES, Claim, Point, Work, demand, refuse, text_of

DEEPEST = 120
"""Cuts on top of each other."""

CUT_WORK = 10

TREE = re.compile(r"(?:[a-g]|(?:0|[1-9][0-9]{0,8})?[.])+")
TOKEN = re.compile(r"[a-g]|[0-9]*[.]")

Loop = Sequence[Point]
"""Places in a plane: two rationals each."""


@dataclass(frozen=True, eq=False)
class Cell:
    """A segment or a triangle by its corners; the letters of its cuts are its edges."""

    corners: tuple[Point, ...]

    @property
    def middle(self) -> Point:
        """The mean of the corners."""
        return tuple(sum(column) / len(self.corners) for column in zip(*self.corners, strict=True))

    def steps(self, joints: Sequence[int]) -> list[list[Any]]:
        """Return the steps from the middle to each corner, in some of the joints."""
        middle = self.middle
        return [[corner[j] - middle[j] for j in joints] for corner in self.corners]

    def cuts(self, joints: Sequence[int]) -> list[tuple[int, list[Any]]]:
        """Return the letters of all cuts, and the steps along what they cut."""
        edges = enumerate(combinations(self.corners, 2))
        return [(k, [a[j] - b[j] for j in joints]) for k, (a, b) in edges]

    def halves(self, letter: int) -> tuple[Cell, Cell]:
        """Cut across an edge: the half that keeps its first corner, then the other half."""
        edges = list(combinations(range(len(self.corners)), 2))
        demand(letter < len(edges), "a tree cuts an edge that its cell does not have")
        i, k = edges[letter]
        first, second = [*self.corners], [*self.corners]
        first[k] = second[i] = Cell((self.corners[i], self.corners[k])).middle
        return Cell(tuple(first)), Cell(tuple(second))


class Box(Cell):
    """All values between two corners; the letters of its cuts are the joints of the robot."""

    def steps(self, joints: Sequence[int]) -> list[list[Any]]:
        """Return the different steps to the corners in some of the joints."""
        halves = [high for _, high in zip(*super().steps(joints), strict=True)]
        return [list(step) for step in product(*((-h, h) if h else (h,) for h in halves))]

    def cuts(self, joints: Sequence[int]) -> list[tuple[int, list[Any]]]:
        """Return the letters of all cuts, and the steps along what they cut."""
        low, high = self.corners
        wide = [j for j in joints if low[j] != high[j]]
        return [(j, [(high[i] - low[i]) * (i == j) for i in joints]) for j in wide]

    def halves(self, letter: int) -> tuple[Cell, Cell]:
        """Halve a joint: the lower half, then the upper one."""
        low, high = self.corners
        wide = letter < len(low) and low[letter] != high[letter]
        demand(wide, "a tree cuts a joint that its box does not")
        cut = self.middle[letter : letter + 1]
        second, first = (end[:letter] + cut + end[letter + 1 :] for end in self.corners)
        return Box((low, first)), Box((second, high))


@dataclass(frozen=True, eq=False)
class Node:
    """A cell of a tree: a leaf, with its number or empty, or a cell that is cut."""

    cell: Cell
    depth: int
    number: str | None


def nodes(cell: Cell, tree: Any, work: Work) -> Iterator[Node]:
    """Yield the cells of a tree in preorder; its last leaf must be its end."""
    letters = text_of(tree, "tree", MOST_BYTES)
    work.add(CUT_WORK * len(letters))
    demand(TREE.fullmatch(letters), "a tree is written with the letters a to g, points and numbers")
    todo = [(cell, 0)]
    for token in TOKEN.finditer(letters):
        demand(todo, "something follows a tree")
        top, depth = todo.pop()
        letter = token.group()
        if letter[-1] == ".":
            yield Node(top, depth, letter[:-1])
            continue
        demand(depth < DEEPEST, f"more than {DEEPEST} cuts on top of each other")
        first, second = top.halves(ord(letter) - ord("a"))
        todo += [(second, depth + 1), (first, depth + 1)]
        yield Node(top, depth, None)
    demand(not todo, "a tree ends before its last leaf")


HOLDS = -1


def holds(cell: Cell, attempt: Callable[[Cell], int | None], deepest: int, why: str) -> None:
    """Refuse unless an inequality holds on a cell, or on all parts after repeated halving.

    `attempt` returns `HOLDS`, or the letter of the best cut, or None if cuts cannot help.
    """
    todo = [(cell, 0)]
    while todo:
        top, depth = todo.pop()
        answer = attempt(top)
        if answer is None or (answer != HOLDS and depth == deepest):
            refuse(why)
        if answer != HOLDS:
            todo += [(half, depth + 1) for half in top.halves(answer)]


def cells_of(claim: Claim) -> list[Cell]:
    """Return the cells of a set, in their order."""
    if claim.kind == "box":
        return [Box(tuple(claim.lists[0]))]
    if claim.kind == "path":
        return [Cell(ends) for points in claim.lists for ends in pairwise(points)]
    points = claim.points
    plane = [j for j, column in enumerate(zip(*points, strict=True)) if min(column) != max(column)]
    demand(len(plane) == 2, f"a polygon in which {len(plane)} joints differ, and not 2")
    places = [tuple(point[j] for j in plane) for point in points]
    loops, rest = [], iter(places)
    for points_of_loop in claim.lists:
        loops.append([next(rest) for _ in points_of_loop])
        once = len({*numbered(loops[-1])}) == len(loops[-1])
        demand(once, "a loop passes a configuration twice")
    check_filled(loops, [[places[k] for k in row] for row in claim.triangles], "triangles")
    return [Cell(tuple(points[k] for k in row)) for row in claim.triangles]


def check_filled(loops: Sequence[Loop], pieces: Sequence[Loop], where: str) -> None:
    """Refuse pieces that are not convex and anticlockwise, or do not fill loops exactly."""
    for piece in pieces:
        for (a, b), (c, d) in around(piece):
            left = [(c - a) * (y - b) - (d - b) * (x - a) for x, y in piece]
            demand(min(left) >= 0 and any(left), f"{where}: one is not convex, or is clockwise")
    numbers = iter(numbered([place for loop in (*loops, *pieces) for place in loop]))
    outline, sides = (
        [edge for loop in group for edge in around([next(numbers) for _ in loop])]
        for group in (loops, pieces)
    )
    inner, outer = {*sides}, {*outline}
    once = len(inner) == len(sides) and len(outer) == len(outline)
    demand(once, f"{where}: an edge stands twice")
    alone = {(a, b) for a, b in inner if (b, a) not in inner}
    demand(outer <= alone, f"{where}: an edge of a loop is not the edge of one of them alone")
    demand(alone <= outer, f"{where}: they do not fill the loops")


def around(loop: Sequence[Any]) -> list[tuple[Any, Any]]:
    """Return the pairs of neighbours around a loop."""
    return list(zip(loop, [*loop[1:], *loop[:1]], strict=True))


def numbered(points: Sequence[Point]) -> list[int]:
    """Return a number for each point, equal for equal points.

    The points are sorted and not hashed, because a hostile file can choose rationals with equal
    hashes.
    """
    order = sorted(range(len(points)), key=lambda k: points[k])
    found, number = [0] * len(points), 0
    for before, k in pairwise([order[0], *order]):
        number += points[before] != points[k]
        found[k] = number
    return found
