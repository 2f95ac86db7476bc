"""The cells of a set, exact; their halves; trees; and triangles that fill loops."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise, product
from typing import Any, Generic, TypeVar

from qbound.proofs.second.reading import MOST_BYTES, Claim, Point, Work, demand, refuse, text_of

DEEPEST = 120
"""Cuts on top of each other."""

CUT_WORK = 10

TREE = re.compile(r"(?:[a-g]|(?:0|[1-9][0-9]{0,8})?[.])+")
TOKEN = re.compile(r"[a-g]|[0-9]*[.]")


@dataclass(frozen=True, eq=False)
class Simplex:
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

    def halves(self, letter: int) -> tuple[Simplex, Simplex]:
        """Cut across an edge: the half that keeps its first corner, then the other half."""
        edges = list(combinations(range(len(self.corners)), 2))
        demand(letter < len(edges), "a tree cuts an edge that its cell does not have")
        i, k = edges[letter]
        middle = tuple((x + y) / 2 for x, y in zip(self.corners[i], self.corners[k], strict=True))
        first, second = list(self.corners), list(self.corners)
        first[k], second[i] = middle, middle
        return Simplex(tuple(first)), Simplex(tuple(second))


@dataclass(frozen=True, eq=False)
class Box:
    """All values between two corners; the letters of its cuts are the joints of the robot."""

    low: Point
    high: Point

    @property
    def corners(self) -> tuple[Point, ...]:
        """The two corners that bound all others."""
        return self.low, self.high

    @property
    def middle(self) -> Point:
        """The middle."""
        return tuple((a + b) / 2 for a, b in zip(self.low, self.high, strict=True))

    def steps(self, joints: Sequence[int]) -> list[list[Any]]:
        """Return the steps to all corners, as far as some of the joints tell them apart."""
        halves = [(self.high[j] - self.low[j]) / 2 for j in joints]
        return [list(step) for step in product(*((-h, h) if h else (h,) for h in halves))]

    def cuts(self, joints: Sequence[int]) -> list[tuple[int, list[Any]]]:
        """Return the letters of all cuts, and the steps along what they cut."""
        wide = [j for j in joints if self.low[j] != self.high[j]]
        return [(j, [(self.high[i] - self.low[i]) * (i == j) for i in joints]) for j in wide]

    def halves(self, letter: int) -> tuple[Box, Box]:
        """Halve a joint: the lower half, then the upper one."""
        wide = letter < len(self.low) and self.low[letter] != self.high[letter]
        demand(wide, "a tree cuts a joint that its box does not")
        middle = (self.low[letter] + self.high[letter]) / 2
        first, second = (
            (*corner[:letter], middle, *corner[letter + 1 :]) for corner in (self.high, self.low)
        )
        return Box(self.low, first), Box(second, self.high)


Cell = Simplex | Box
AnyCell = TypeVar("AnyCell", Box, Simplex, Cell)


@dataclass(frozen=True, eq=False)
class Node(Generic[AnyCell]):
    """A cell of a tree: a leaf with its number, which may be empty, or one that is cut."""

    cell: AnyCell
    depth: int
    number: str | None


def nodes(cell: AnyCell, tree: Any, work: Work) -> Iterator[Node[AnyCell]]:
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
    """Refuse unless something holds on a cell, or on all halves of its halves.

    `attempt` returns `HOLDS`, or the letter of the best cut, or None where it is hopeless.
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
        return [Box(*claim.lists[0])]
    if claim.kind == "path":
        return [Simplex(ends) for points in claim.lists for ends in pairwise(points)]
    _check_polygon(claim)
    points = claim.points
    return [Simplex(tuple(points[k] for k in triangle)) for triangle in claim.triangles]


def _check_polygon(claim: Claim) -> None:
    """Refuse triangles that do not fill the loops exactly, place by place."""
    points = claim.points
    plane = [j for j, column in enumerate(zip(*points, strict=True)) if min(column) != max(column)]
    demand(len(plane) == 2, f"a polygon in which {len(plane)} joints differ, and not 2")
    place = numbered(points)
    for a, b, c in claim.triangles:
        (x, y), (u, v) = ([points[k][j] - points[a][j] for j in plane] for k in (b, c))
        demand(x * v - y * u > 0, "a triangle is clockwise or flat")
    loops, first = [], 0
    for loop in claim.lists:
        loops.append(place[first : first + len(loop)])
        first += len(loop)
        demand(len({*loops[-1]}) == len(loop), "a loop passes a configuration twice")
    sides = _edges([[place[k] for k in triangle] for triangle in claim.triangles])
    outline = _edges(loops)
    inner, outer = set(sides), set(outline)
    once = len(inner) == len(sides) and len(outer) == len(outline)
    demand(once, "an edge of the polygon or of its triangles stands twice")
    single = all((a, b) in inner and (b, a) not in inner for a, b in outer)
    demand(single, "an edge of a loop is not the edge of one triangle alone")
    demand(all((b, a) in inner for a, b in inner - outer), "the triangles do not fill the polygon")


def _edges(loops: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    return [(loop[k - 1], x) for loop in loops for k, x in enumerate(loop)]


def numbered(points: Sequence[Point]) -> list[int]:
    """Give points numbers, equal ones the same, by sorting: hashes of rationals can be chosen."""
    order = sorted(range(len(points)), key=lambda k: points[k])
    found, number = [0] * len(points), 0
    for before, k in pairwise([order[0], *order]):
        number += points[before] != points[k]
        found[k] = number
    return found
