"""Cells that make up the set of a certificate, exact, and their halves.

As the book's page "The certificate" defines them; `check_arb` and the producers use these, `check`
has its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise, permutations, product
from typing import Any

from qbound.proofs.grammar import Point, Statement
from qbound.proofs.grammar_values import refuse


@dataclass(frozen=True, eq=False)
class Simplex:
    """A segment, a triangle, ... by its corners; the letters of its cuts are its edges."""

    corners: tuple[Point, ...]

    @property
    def centre(self) -> Point:
        """The mean of the corners."""
        return tuple(sum(column) / len(self.corners) for column in zip(*self.corners, strict=True))

    def steps(self, joints: Sequence[int]) -> list[list[Any]]:
        """Return the steps from the centre to each corner, in some of the joints."""
        centre = self.centre
        return [[corner[j] - centre[j] for j in joints] for corner in self.corners]

    def halves(self, letter: int) -> tuple[Simplex, Simplex]:
        """Cut across an edge: the half that keeps its first corner, then the other half."""
        edges = list(combinations(range(len(self.corners)), 2))
        if letter >= len(edges):
            refuse("a tree cuts an edge that its cell does not have")
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
    def centre(self) -> Point:
        """The middle."""
        return tuple((a + b) / 2 for a, b in zip(self.low, self.high, strict=True))

    def steps(self, joints: Sequence[int]) -> list[list[Any]]:
        """Return the steps to all corners, as far as some of the joints tell them apart."""
        halves = [(self.high[j] - self.low[j]) / 2 for j in joints]
        return [list(step) for step in product(*((-h, h) if h else (h,) for h in halves))]

    def halves(self, letter: int) -> tuple[Box, Box]:
        """Halve a joint: the lower half, then the upper one."""
        if letter >= len(self.low) or self.low[letter] == self.high[letter]:
            refuse("a tree cuts a joint that is held, or none")
        middle = self.centre[letter]
        ends = [
            (*corner[:letter], middle, *corner[letter + 1 :]) for corner in (self.high, self.low)
        ]
        return replace(self, high=ends[0]), replace(self, low=ends[1])


Cell = Simplex | Box


def cells_of(statement: Statement, grammar: int) -> list[Cell]:
    """Return the cells of the set, in their order."""
    if statement.kind == "path":
        return [Simplex(ends) for points in statement.lists for ends in pairwise(points)]
    if statement.kind == "polygon":
        check_polygon(statement)
        points = statement.points
        return [Simplex((points[a], points[b], points[c])) for a, b, c in statement.triangles]
    low, high = statement.lists[0]
    return [Box(low, high)] if grammar > 1 else list(_risings(low, high))


def _risings(low: Point, high: Point) -> Iterator[Simplex]:
    """Cut a box into the simplices along which its joints rise one after the other."""
    wide = [j for j, (a, b) in enumerate(zip(low, high, strict=True)) if a != b]
    for order in permutations(wide):
        corners = [low]
        for j in order:
            last = corners[-1]
            corners.append((*last[:j], high[j], *last[j + 1 :]))
        yield Simplex(tuple(corners))


def check_polygon(statement: Statement) -> None:
    """Refuse triangles that do not fill the loops exactly, place by place."""
    points = statement.points
    plane = [j for j, column in enumerate(zip(*points, strict=True)) if len(set(column)) > 1]
    if len(plane) != 2:
        refuse(f"a polygon in which {len(plane)} joints differ, and not 2")
    number = {point: k for k, point in enumerate(points)}  # equal points have one number
    same = [number[point] for point in points]
    for a, b, c in statement.triangles:
        (x, y), (u, v) = ([points[k][j] - points[a][j] for j in plane] for k in (b, c))
        if not x * v - y * u > 0:
            refuse("a triangle is clockwise or flat")
    sides = [
        (same[triangle[k]], same[triangle[k - 2]])
        for triangle in statement.triangles
        for k in range(3)
    ]
    outline = list(_outline(statement, same))
    inner, outer = set(sides), set(outline)
    if len(inner) != len(sides) or len(outer) != len(outline):
        refuse("an edge of the polygon or of its triangles occurs twice")
    if any((a, b) not in inner or (b, a) in inner for a, b in outer):
        refuse("an edge of a loop is not the edge of one triangle alone")
    if any((b, a) not in inner for a, b in inner - outer):
        refuse("the triangles do not fill the polygon")


def _outline(statement: Statement, same: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Return the edges of the loops, each by the numbers of its ends."""
    first = 0
    for loop in statement.lists:
        ring = same[first : first + len(loop)]
        yield from zip(ring, (*ring[1:], ring[0]), strict=True)
        first += len(loop)
