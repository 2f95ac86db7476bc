"""Check a certificate of qbound a second time, in ball arithmetic (Arb), on another way.

It is written from the book's page "The certificate" and shares no line with `check`: `grammar`
reads the file into exact rationals; `interpolation` finds a boundary function from its values at
third parts of a turn; trees are walked with a stack of cells. On each leaf it proves the inequality
of that page.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from qbound.extras import require
from qbound.proofs.cells import Box, Cell, Simplex, cells_of
from qbound.proofs.grammar import Content, Witness, read_certificate
from qbound.proofs.grammar_robot import Boundary, Robot
from qbound.proofs.grammar_values import refuse, shown
from qbound.proofs.interpolation import (
    Waves,
    boundary_value,
    exact,
    reach_of,
    units,
    values_of,
    waves_of,
)
from qbound.proofs.verdict import Verdict

BITS = 160
"""Bits of the balls: a leaf has 1e-13 of its amplitudes to spare, ``2**-43``."""

WITNESS_BITS = 640
"""Bits at a witness, which may violate a boundary in the fortieth digit only."""

DEEPEST = 120
"""Cuts on top of each other."""

MOST_WORK = 32_000_000
"""Products that a check may take, some 15 seconds; counted before they are made."""

WAVES_WORK, CUT_WORK = 30, 50
"""Products for each value of a boundary function that is interpolated, and for each letter."""


def verify(text: str | bytes) -> Verdict:
    """Return what a certificate proves: that its statement is true, or that it is not.

    Parameters
    ----------
    text : str or bytes
        The certificate, grammar 1 or 2.

    Raises
    ------
    ValueError
        If it does not follow the grammar, or does not prove what it says.
    ModuleNotFoundError
        Without python-flint (the extra `proofs`).

    Examples
    --------
    >>> from qbound.model.robotfile import robot_text
    >>> from qbound.proofs.certify import certify
    >>> from qbound.proofs.statements import box
    >>> text, _ = robot_text("minervabot-v2")
    >>> proof = certify(text, box(["-10", "-10"], ["10", "10"])).text
    >>> verify(proof).value
    'proved'

    A proof of another robot is none:

    >>> verify(proof.replace("11.32", "11.33"))
    Traceback (most recent call last):
    ValueError: the hash is not of this robot
    """
    require("flint")
    from flint import ctx

    with ctx.workprec(BITS):
        try:
            return _verified(text)
        except (ValueError, MemoryError):
            raise
        except Exception as error:  # a fault of ours is no answer
            raise ValueError("the check of this file failed") from error


def _verified(text: str | bytes) -> Verdict:
    content = read_certificate(text)
    cells = _exact_cells(content)
    if content.witness is not None:
        _check_witness(content, cells, content.witness)
    else:
        _check_proof(content, cells)
    return content.verdict


def _exact_cells(content: Content) -> list[Cell]:
    """Return the cells of the set with Arb's rationals, which are faster than Python's."""
    cells = cells_of(content.statement, content.grammar)
    rows = [[tuple(map(exact, corner)) for corner in cell.corners] for cell in cells]
    if isinstance(cells[0], Box):
        return [Box(*rows[0])]
    return [Simplex(tuple(row)) for row in rows]


# --- the proof ------------------------------------------------------------------------------------


class _Work:
    """What a check has cost, in products; it stops where the cost is too high."""

    def __init__(self) -> None:
        self.done = 0

    def add(self, count: int) -> None:
        self.done += count
        if self.done > MOST_WORK:
            refuse("it asks for too much work")


def _check_proof(content: Content, cells: Sequence[Cell]) -> None:
    robot, margin, work = content.robot, content.statement.margin, _Work()
    for point in content.statement.points:
        beyond = _beyond_limits(robot, [exact(x) for x in point])
        if beyond:
            refuse(f"a point of the set is beyond {shown(beyond[0])}")
    needed = [b for b in robot.boundaries if b.used and _can_be_violated(b, margin)]
    if {boundary.name for boundary in needed} != set(content.proof):
        refuse("the boundaries of the proof are not those that need one")
    reach = reach_of(robot, content.statement.points)
    work.add(sum(WAVES_WORK * values_of(robot, boundary) for boundary in needed))
    for boundary in needed:
        trees = content.proof[boundary.name]
        if len(trees) != len(cells):
            refuse(f"{shown(boundary.name)}: {len(trees)} trees for {len(cells)} cells")
        waves = waves_of(robot, boundary, margin, reach)
        leaf = _Leaf(robot, waves, work)
        for cell, tree in zip(cells, trees, strict=True):
            if not _covers(leaf, cell, tree, work):
                refuse(f"{shown(boundary.name)}: not proved on every leaf")


def _can_be_violated(boundary: Boundary, margin: Any) -> bool:
    return boundary.normal is not None or boundary.least + margin != 0


def _covers(leaf: _Leaf, cell: Cell, tree: str, work: _Work) -> bool:
    """Tell whether a tree ends with its last leaf, and the form is positive on every leaf."""
    todo = [(cell, 0)]
    work.add(CUT_WORK * len(tree))
    for letter in tree:
        if not todo:
            refuse("something follows a tree")
        top, depth = todo.pop()
        if letter == ".":
            if not leaf.is_positive(top):
                return False
        elif depth == DEEPEST:
            refuse(f"more than {DEEPEST} cuts on top of each other")
        else:
            first, second = top.halves(ord(letter) - ord("a"))
            todo += [(second, depth + 1), (first, depth + 1)]
    if todo:
        refuse("a tree ends before its last leaf")
    return True


class _Leaf:
    """One boundary function, to be bounded from below on leaf after leaf."""

    def __init__(self, robot: Robot, waves: Waves, work: _Work) -> None:
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


# --- the witness ----------------------------------------------------------------------------------


def _beyond_limits(robot: Robot, point: Sequence[Any]) -> list[str]:
    """Return the names of all limits that a configuration is beyond: exact."""
    found = []
    for joint, x in zip(robot.joints, point, strict=True):
        if joint.limits is not None:
            low, high = map(exact, joint.limits)
            found += [f"{joint.name}.lower"] * (x < low) + [f"{joint.name}.upper"] * (x > high)
    return found


def _check_witness(content: Content, cells: Sequence[Cell], witness: Witness) -> None:
    from flint import ctx

    point, robot = _place(cells, witness), content.robot
    if witness.boundary in _beyond_limits(robot, point):
        return
    for boundary in robot.boundaries:
        if boundary.name == witness.boundary and boundary.used:
            with ctx.workprec(WITNESS_BITS):
                if boundary_value(robot, boundary, content.statement.margin, point) < 0:
                    return
    refuse("the witness violates nothing")


def _place(cells: Sequence[Cell], witness: Witness) -> tuple[Any, ...]:
    """Return the configuration that a witness names; it lies in the set."""
    if witness.at is not None:
        low, high = cells[0].corners
        place = tuple(map(exact, witness.at))
        if any(not a <= x <= b for a, x, b in zip(low, place, high, strict=True)):
            refuse("the witness is not in the box")
        return place
    if witness.cell >= len(cells):
        refuse(f"there is no cell {witness.cell}")
    corners, weights = cells[witness.cell].corners, [exact(w) for w in witness.weights]
    if len(weights) != len(corners) or min(weights) < 0 or sum(weights) != 1:
        refuse("the weights are not those of a mean of the corners of a cell")
    return tuple(
        sum(x * w for x, w in zip(column, weights, strict=True))
        for column in zip(*corners, strict=True)
    )
