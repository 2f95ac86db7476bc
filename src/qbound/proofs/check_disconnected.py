"""Do boxes on which a boundary is violated separate two configurations? In balls.

For `check_arb`: grammar 5 of the book's page "The certificate". The tree is kept as a tree:
pairs of cells that touch are cut down to pairs of leaves, and leaves without a number that touch
are put together. A joint without limits is compared with itself a turn on, in balls: what is not
certainly apart touches.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations_with_replacement, product
from typing import Any

from qbound.proofs.cells import Box
from qbound.proofs.grammar import Content, Disconnected
from qbound.proofs.grammar_robot import LARGEST_ANGLE, Robot
from qbound.proofs.grammar_values import refuse, shown
from qbound.proofs.interpolation import Wave, Waves, exact, joints_of, reach_of, units, waves_of
from qbound.proofs.leaves import DEEPEST, WAVES_WORK, Leaf, Work, beyond_limits

HALF_TURN = {True: Fraction(180), False: Fraction("3.1416")}
"""Both ends of a joint without limits, by whether angles are in degrees: a turn, or a bit more."""

LETTER_WORK, PAIR_WORK = 200, 8
"""Products for each letter, whose cell is kept, and for each pair of cells that is compared."""

WORD = 256
"""Bits of a limit that cost no more than one; ten times as many take ten times as long."""


@dataclass(eq=False, slots=True)
class _Cell:
    """A cell of the tree; `number` is None of one that is cut, "" of a leaf without a number."""

    box: Box
    depth: int
    number: str | None = None
    halves: tuple[_Cell, ...] = ()
    is_open: bool = False
    """Whether it is a leaf without a number, or has one in it."""
    leader: _Cell | None = None
    """Another leaf of its group; None of the one that stands for all."""


def check_disconnected(content: Content, disconnected: Disconnected) -> None:
    """Verify that no path of the joints that move leads from one configuration to the other."""
    robot, work, tree = content.robot, Work(), disconnected.tree
    ends = [tuple(map(exact, point)) for point in content.statement.points]
    for point in ends:
        beyond = beyond_limits(robot, point)
        if beyond:
            refuse(f"a configuration is beyond {shown(beyond[0])}")
    words = _words(content)
    work.add(LETTER_WORK * words * len(tree))
    box = _whole(content)
    cells = _cells(box, tree)
    _check_violated(_Violations(content, disconnected, box, work), cells)
    seams = _Seams(robot, content.statement.free, work, words)
    seams.unite(cells[0])
    start, goal = (seams.groups(cells[0], point) for point in ends)
    if not start or not goal:
        refuse("a configuration lies in no leaf without a number")
    if start & goal:
        refuse("leaves without a number join both configurations")


def _whole(content: Content) -> Box:
    """Return the box of all values of the joints that move; the others have one value."""
    robot, statement = content.robot, content.statement
    low, high = (list(map(exact, statement.points[0])) for _ in range(2))
    for j in statement.free:
        joint, half = robot.joints[j], HALF_TURN[robot.degrees]
        ends = joint.limits or (-half, half)
        if joint.turns and max(map(abs, ends)) > LARGEST_ANGLE[robot.degrees]:
            refuse(f"{shown(joint.name)}: a limit is too large an angle")
        low[j], high[j] = map(exact, ends)
    return Box(tuple(low), tuple(high))


def _words(content: Content) -> int:
    """Return how long the limits of the joints that move are: all ends of cells are, too."""
    found = 1
    for j in content.statement.free:
        ends = content.robot.joints[j].limits or ()
        bits = sum(k.bit_length() for x in ends for k in x.as_integer_ratio())
        found = max(found, 1 + bits // WORD)
    return found


def _cells(box: Box, tree: str) -> list[_Cell]:
    """Return all cells of a tree, the whole box first, halves after what they are halves of."""
    root = _Cell(box, 0)
    todo, found = [root], list[_Cell]()
    for letter in re.findall("[a-z]|[0-9]*[.]", tree):
        if not todo:
            refuse("something follows a tree")
        cell = todo.pop()
        found.append(cell)
        if letter.endswith("."):
            cell.number = letter[:-1]
        elif cell.depth == DEEPEST:
            refuse(f"more than {DEEPEST} cuts on top of each other")
        else:
            halves = cell.box.halves(ord(letter) - ord("a"))
            cell.halves = tuple(_Cell(half, cell.depth + 1) for half in halves)
            todo += reversed(cell.halves)
    if todo:
        refuse("a tree ends before its last leaf")
    for cell in reversed(found):
        cell.is_open = cell.number == "" or any(half.is_open for half in cell.halves)
    return found


# --- what is violated -----------------------------------------------------------------------------


class _Violations:
    """Minus the boundary functions at the held values, each made when a leaf first names it."""

    def __init__(self, content: Content, disconnected: Disconnected, box: Box, work: Work) -> None:
        self.content, self.disconnected, self.work = content, disconnected, work
        self.reach = reach_of(content.robot, [box.low, box.high])
        self.known: dict[int, Leaf] = {}
        free, scale = content.statement.free, units(content.robot)
        start = content.statement.points[0]
        self.held = {j: scale[j] * exact(x) for j, x in enumerate(start) if j not in free}

    def of(self, number: str) -> Leaf:
        """Return what is positive where the boundary of this number is violated."""
        k = int(number)
        if k >= len(self.disconnected.boundaries):
            refuse(f"a leaf names boundary {k}, which is not there")
        if k not in self.known:
            boundary, robot = self.disconnected.boundaries[k], self.content.robot
            self.work.add(WAVES_WORK * 3 ** sum(j not in self.held for j in joints_of(boundary)))
            margin = self.content.statement.margin
            kept = waves_of(robot, boundary, margin, self.reach, self.held)
            rows = [Wave(-wave.amplitude, wave.turns, wave.powers) for wave in kept.rows]
            self.known[k] = Leaf(robot, Waves(kept.joints, rows, kept.rest), self.work)
        return self.known[k]


def _check_violated(violations: _Violations, cells: Sequence[_Cell]) -> None:
    for cell in cells:
        if cell.number and not violations.of(cell.number).is_positive(cell.box):
            name = violations.disconnected.boundaries[int(cell.number)].name
            refuse(f"{shown(name)}: not violated all over a leaf")


# --- what touches ---------------------------------------------------------------------------------


class _Seams:
    """Which cells touch, with joints without limits glued a turn apart."""

    def __init__(self, robot: Robot, free: Sequence[int], work: Work, words: int) -> None:
        self.robot, self.free, self.work = robot, free, work
        self.pair_work = PAIR_WORK * words
        self.glued = [robot.joints[j].limits is None for j in free]

    @cached_property
    def turn(self) -> Any:
        """A full turn in the file's units."""
        from flint import arb, fmpq

        return fmpq(360) if self.robot.degrees else 2 * arb.pi()

    def unite(self, root: _Cell) -> None:
        """Put leaves without a number that touch into one group; each pair of turns once."""
        steps = product(*((-1, 0, 1) if glued else (0,) for glued in self.glued))
        for turns in steps:
            if turns >= (0,) * len(turns):
                for one, other in self.touching(root, root, turns):
                    first, second = _leader(one), _leader(other)
                    if first is not second:
                        first.leader = second

    def groups(self, root: _Cell, point: Sequence[Any]) -> set[int]:
        """Return the groups of all leaves without a number that may hold a configuration."""
        place = _Cell(Box(tuple(point), tuple(point)), 0, "", is_open=True)
        away = [self._turns_to(point[j]) if g else 0 for j, g in self._each()]
        found = set()
        for steps in product(*((-1, 0, 1) if glued else (0,) for glued in self.glued)):
            turns = tuple(a + b for a, b in zip(away, steps, strict=True))
            for _, leaf in self.touching(place, root, turns):
                found.add(id(_leader(leaf)))
        return found

    def _each(self) -> Iterator[tuple[int, bool]]:
        return zip(self.free, self.glued, strict=True)

    def _turns_to(self, x: Any) -> int:
        """Return about how many turns lie between 0 and a value."""
        from flint import arb

        return math.floor(float(arb(x) / self.turn))

    def touching(
        self, one: _Cell, other: _Cell, turns: Sequence[int]
    ) -> Iterator[tuple[_Cell, _Cell]]:
        """Yield the leaves without a number of two cells that touch, the other some turns on."""
        todo = [(one, other)]
        while todo:
            self.work.add(self.pair_work)
            a, b = todo.pop()
            if not (a.is_open and b.is_open) or self._apart(a.box, b.box, turns):
                continue
            if a is b and a.halves and not any(turns):  # each pair once
                todo += combinations_with_replacement(a.halves, 2)
            elif a.halves and (a.depth <= b.depth or not b.halves):
                todo += [(half, b) for half in a.halves]
            elif b.halves:
                todo += [(a, half) for half in b.halves]
            else:
                yield a, b

    def _apart(self, one: Box, other: Box, turns: Sequence[int]) -> bool:
        """Tell whether two closed boxes are certainly apart, the other some turns on."""
        for j, k in zip(self.free, turns, strict=True):
            low, high = other.low[j], other.high[j]
            if k:
                low, high = low + k * self.turn, high + k * self.turn
            if one.high[j] < low or high < one.low[j]:
                return True
        return False


def _leader(leaf: _Cell) -> _Cell:
    """Return the leaf that stands for a group, and shorten the way to it."""
    while leaf.leader is not None:
        leaf.leader = leaf.leader.leader or leaf.leader
        leaf = leaf.leader
    return leaf
