"""Is a function positive on every leaf of a tree? In balls, with the work counted; for `check_arb`.

On each leaf it proves the inequality of the book's page "The certificate".
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any

from qbound.proofs.cells import Box, Cell
from qbound.proofs.grammar_robot import Robot
from qbound.proofs.grammar_values import refuse
from qbound.proofs.interpolation import Waves, exact, units

DEEPEST = 120
"""Cuts on top of each other."""

MOST_WORK = 32_000_000
"""Products that a check may take, some 15 seconds; counted before they are made."""

WAVES_WORK, CUT_WORK = 30, 50
"""Products for each value of a boundary function that is interpolated, and for each letter."""


class Work:
    """What a check has cost, in products; it stops where the cost is too high."""

    def __init__(self) -> None:
        self.done = 0

    def add(self, count: int) -> None:
        """Count work that is about to be done."""
        self.done += count
        if self.done > MOST_WORK:
            refuse("it asks for too much work")


Functions = Callable[[str], list["Leaf"]]
"""From what stands before the point of a leaf to the functions that are positive there."""


def without_number(leaves: list[Leaf], number: str) -> list[Leaf]:
    """Return what is positive on a leaf that has no number, and refuse one that has."""
    if number:
        refuse("a leaf names a feature where there are none")
    return leaves


def covers(functions: Functions, cell: Cell, tree: str, work: Work) -> bool:
    """Tell whether a tree ends with its last leaf, and all is positive on every leaf."""
    todo = [(cell, 0)]
    work.add(CUT_WORK * len(tree))
    for letter in re.findall("[a-z]|[0-9]*[.]", tree):
        if not todo:
            refuse("something follows a tree")
        top, depth = todo.pop()
        if letter.endswith("."):
            if not all(leaf.is_positive(top) for leaf in functions(letter[:-1])):
                return False
        elif depth == DEEPEST:
            refuse(f"more than {DEEPEST} cuts on top of each other")
        else:
            first, second = top.halves(ord(letter) - ord("a"))
            todo += [(second, depth + 1), (first, depth + 1)]
    if todo:
        refuse("a tree ends before its last leaf")
    return True


class Leaf:
    """One boundary function, to be bounded from below on leaf after leaf."""

    def __init__(self, robot: Robot, waves: Waves, work: Work) -> None:
        self.waves, self.work = waves, work
        self.units = [units(robot)[j] for j in waves.joints]

    def is_positive(self, cell: Cell) -> bool:
        """Tell whether the concave bound is positive at every corner."""
        from flint import arb_mat

        waves, joints = self.waves, self.waves.joints
        steps = [self._scaled(step) for step in cell.steps(joints)]
        n = len(joints)
        self.work.add(len(waves.rows) * (n + 6) + len(steps) * (2 * n + 4) + len(waves.slides) * 12)
        middle = cell.centre
        value, slope = waves.expanded(self._scaled([middle[j] for j in joints]))
        if waves.slides:
            corners = [self._scaled([corner[j] for j in joints]) for corner in cell.corners]
            value -= waves.bending(corners, steps[-1:] if isinstance(cell, Box) else steps) / 2
        rows = arb_mat(steps)
        rises = (rows * arb_mat(n, 1, slope)).entries()
        for step, rise, bent in zip(steps, rises, (rows * waves.matrix).tolist(), strict=True):
            bend = sum((x * y for x, y in zip(step, bent, strict=True)), 0)
            if not value + rise - bend / 2 > 0:
                return False
        return True

    def _scaled(self, values: Sequence[Any]) -> list[Any]:
        """Turn the file's units into radians and lengths."""
        return [unit * x for unit, x in zip(self.units, values, strict=True)]


def beyond_limits(robot: Robot, point: Sequence[Any]) -> list[str]:
    """Return the names of all limits that a configuration is beyond: exact."""
    found = []
    for joint, x in zip(robot.joints, point, strict=True):
        if joint.limits is not None:
            low, high = map(exact, joint.limits)
            found += [f"{joint.name}.lower"] * (x < low) + [f"{joint.name}.upper"] * (x > high)
    return found
