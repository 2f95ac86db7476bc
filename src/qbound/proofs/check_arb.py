"""Check a certificate of qbound a second time, in ball arithmetic (Arb), on another way.

It is written from the book's page "The certificate" and shares no line with `check`: `grammar`
reads the file into exact rationals; `interpolation` finds a boundary function from its values at
third parts of a turn; trees are walked with a stack of cells. On each leaf it proves the inequality
of that page (`leaves`). Boxes that separate two configurations are checked in
`check_disconnected`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import product
from typing import Any

from qbound.proofs.cells import Box, Cell, Simplex, cells_of
from qbound.proofs.check_disconnected import check_disconnected
from qbound.proofs.flat_balls import Core, Features, FlatArm, cores_of
from qbound.proofs.grammar import Barrier, Blocked, Content, Witness, read_certificate
from qbound.proofs.grammar_robot import Boundary, Place, Robot
from qbound.proofs.grammar_values import refuse, shown
from qbound.proofs.interpolation import (
    Wave,
    Waves,
    boundary_value,
    exact,
    joints_of,
    reach_of,
    units,
    values_of,
    waves_of,
)
from qbound.proofs.leaves import (
    WAVES_WORK,
    Functions,
    Leaf,
    Work,
    beyond_limits,
    covers,
    without_number,
)
from qbound.proofs.verdict import Verdict

BITS = 160
"""Bits of the balls: a leaf has 1e-13 of its amplitudes to spare, ``2**-43``."""

WITNESS_BITS = 640
"""Bits at a witness, which may violate a boundary in the fortieth digit only."""

PART_WORK = 2
"""Products for each corner of a part and each of its edges."""

MOST_FUNCTIONS = 2_000
"""Functions of the features of two parts that are kept."""


def verify(text: str | bytes) -> Verdict:
    """Return what a certificate proves: that its statement is true, or that it is not.

    Parameters
    ----------
    text : str or bytes
        The certificate, grammar 1, 2, 3, 4 or 5.

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
    if content.barrier is not None:
        _check_barrier(content, content.barrier)
        return content.verdict
    if content.disconnected is not None:
        check_disconnected(content, content.disconnected)
        return content.verdict
    cells = _exact_cells(content)
    asked = _Asked(content)
    if content.witness is not None:
        _check_witness(asked, cells, content.witness)
    else:
        _check_proof(asked, cells)
    return content.verdict


def _exact_cells(content: Content) -> list[Cell]:
    """Return the cells of the set with Arb's rationals, which are faster than Python's."""
    cells = cells_of(content.statement, content.grammar)
    rows = [[tuple(map(exact, corner)) for corner in cell.corners] for cell in cells]
    if isinstance(cells[0], Box):
        return [Box(*rows[0])]
    return [Simplex(tuple(row)) for row in rows]


# --- the proof ------------------------------------------------------------------------------------


def _check_proof(asked: _Asked, cells: Sequence[Cell]) -> None:
    content, robot, work = asked.content, asked.robot, asked.work
    margin = content.statement.margin
    for point in content.statement.points:
        beyond = beyond_limits(robot, [exact(x) for x in point])
        if beyond:
            refuse(f"a point of the set is beyond {shown(beyond[0])}")
    needed = [b for b in robot.boundaries if b.used and _can_be_violated(b, margin)]
    if {boundary.name for boundary in needed} != set(content.proof):
        refuse("the boundaries of the proof are not those that need one")
    asked.count_singles(needed)
    for boundary in needed:
        trees = content.proof[boundary.name]
        pairs = asked.pairs(boundary)
        if len(trees) != pairs * len(cells):
            refuse(f"{shown(boundary.name)}: {len(trees)} trees for {pairs} x {len(cells)} cells")
        for k, functions in enumerate(asked.of(boundary)):
            own = trees[k * len(cells) : (k + 1) * len(cells)]
            for cell, tree in zip(cells, own, strict=True):
                if not covers(functions, cell, tree, work):
                    refuse(f"{shown(boundary.name)}: not proved on every leaf")


def _can_be_violated(boundary: Boundary, margin: Any) -> bool:
    """Tell whether a distance of 0 is asked of what can be nearer than that, by crossing."""
    crossing = boundary.apart and sum(len(body.places) for body in boundary.bodies) > 3
    return boundary.normal is not None or crossing or boundary.least + margin != 0


class _Asked:
    """What has to be positive, for each boundary, or for each pair of parts of two bodies."""

    def __init__(self, content: Content) -> None:
        self.content, self.work, self.robot = content, Work(), content.robot
        self.reach = reach_of(self.robot, content.statement.points)
        self.cores = self._cores()

    @cached_property
    def arm(self) -> FlatArm:
        """The arm in its plane of motion."""
        return FlatArm(self.robot)

    def _cores(self) -> dict[str, list[Core]]:
        """Return the convex cores of all bodies that are kept from others, by their names."""
        found, parts = dict[str, list[Core]](), self.content.parts
        bodies = [
            b for pair in self.robot.boundaries if pair.used and pair.apart for b in pair.bodies
        ]
        for body in bodies:
            if body.name not in found:
                own = parts.get(body.name)
                self.work.add(PART_WORK * sum(len(part) ** 2 for part in own or ()))
                found[body.name] = cores_of(self.arm, body, own)
        return found

    def pairs(self, boundary: Boundary) -> int:
        """Return how many proofs a boundary needs for each cell."""
        return math.prod(len(self.cores[b.name]) for b in boundary.bodies) if boundary.apart else 1

    def count_singles(self, boundaries: Sequence[Boundary]) -> None:
        """Count the work of all functions that have no features, before any is made."""
        singles = [b for b in boundaries if not b.apart]
        for b in singles:
            values = values_of(self.robot, b) * max(1, sum(len(body.places) for body in b.bodies))
            self.work.add(WAVES_WORK * values)

    def of(self, boundary: Boundary) -> Iterator[Functions]:
        """Return the functions of a boundary for each pair of parts, else once."""
        if not boundary.apart:
            margin = self.content.statement.margin
            waves = [
                waves_of(self.robot, single, margin, self.reach)
                for single in self.singles(boundary)
            ]
            leaves = [Leaf(self.robot, wave, self.work) for wave in waves]
            yield partial(without_number, leaves)
            return
        for one, other in product(*(self.cores[body.name] for body in boundary.bodies)):
            yield _ByNumber(self, self.features(boundary, one, other))

    def features(self, boundary: Boundary, one: Core, other: Core) -> Features:
        """Return the features of two cores."""
        gap = exact(boundary.least + self.content.statement.margin)
        return Features(self.arm, one, other, gap, self.reach)

    def singles(self, boundary: Boundary) -> list[Boundary]:
        """Return the half-spaces of all places of a body; any other boundary as it is."""
        if not boundary.bodies:
            return [boundary]
        [body] = boundary.bodies
        return [
            replace(boundary, places=(Place("", body.frame, (x, y, z), body.radius),), bodies=())
            for x, y, z in self.arm.in_space(body)
        ]


class _ByNumber:
    """The functions of features, each made when a leaf first names it."""

    def __init__(self, asked: _Asked, features: Features) -> None:
        self.asked, self.features = asked, features
        self.known: dict[int, list[Leaf]] = {}

    def __call__(self, number: str) -> list[Leaf]:
        if not number or int(number) >= self.features.count:
            refuse("a leaf names no feature of its parts")
        k = int(number)
        if k not in self.known:
            if sum(map(len, self.known.values())) > MOST_FUNCTIONS:
                self.known.clear()
            self.asked.work.add(WAVES_WORK * self.features.size(k))
            robot, work = self.asked.robot, self.asked.work
            self.known[k] = [Leaf(robot, waves, work) for waves in self.features.waves(k)]
        return self.known[k]


# --- no path --------------------------------------------------------------------------------------


def _check_barrier(content: Content, barrier: Barrier) -> None:
    """Verify that every path between two configurations violates one of the boundaries named."""
    robot, j, work = content.robot, barrier.joint, Work()
    start, goal = ([exact(x) for x in point] for point in content.statement.points)
    for point in (start, goal):
        beyond = beyond_limits(robot, point)
        if beyond:
            refuse(f"a configuration is beyond {shown(beyond[0])}")
    for blocked in barrier.blocked:
        if j not in joints_of(blocked.boundary):
            refuse(f"{shown(blocked.boundary.name)} does not depend on the joint")
        work.add(WAVES_WORK * values_of(robot, blocked.boundary))
        ends = [[*start[:j], exact(end), *start[j + 1 :]] for end in (blocked.low, blocked.high)]
        waves = _violation(content, barrier, blocked)
        functions = partial(without_number, [Leaf(robot, waves, work)])
        if not covers(functions, Box(*map(tuple, ends)), blocked.tree, work):
            refuse(f"{shown(blocked.boundary.name)}: not violated all the way")
    if not _is_between(robot, barrier, start[j], goal[j]):
        refuse("both configurations are on one side of what is blocked")


def _violation(content: Content, barrier: Barrier, blocked: Blocked) -> Waves:
    """Return a function of the joint alone that is at most minus the boundary function."""
    from flint import arb

    robot, j = content.robot, barrier.joint
    ends = [joint.limits or (Fraction(1),) for joint in robot.joints]
    ends[j] = (blocked.low, blocked.high)
    reach = [
        arb(1) if joint.turns else arb(exact(max(map(abs, pair))))
        for joint, pair in zip(robot.joints, ends, strict=True)
    ]
    whole = waves_of(robot, blocked.boundary, content.statement.margin, reach)
    place, rows, rest = whole.joints.index(j), list[Wave](), whole.rest
    for wave in whole.rows:
        k, p = wave.turns[place], wave.powers[place]
        if sum(map(abs, wave.turns)) + sum(wave.powers) == abs(k) + p:
            rows.append(Wave(-wave.amplitude, (k,), (p,)))
        else:
            lengths = zip((reach[i] for i in whole.joints), wave.powers, strict=True)
            rest += math.prod((x**p for x, p in lengths if p), start=abs(wave.amplitude))
    return Waves(range(j, j + 1), rows, rest)


def _is_between(robot: Robot, barrier: Barrier, start: Any, goal: Any) -> bool:
    """Tell whether the joint passes something blocked on every way, round the joint included."""
    from flint import arb, fmpq

    ends = [(exact(b.low), exact(b.high)) for b in barrier.blocked]
    if len(ends) == 1:
        [(low, high)] = ends
        return bool(min(start, goal) < low and high < max(start, goal))
    turn = arb(360) if robot.degrees else 2 * arb.pi()
    (low, high), (next_low, next_high) = ends
    away = arb(fmpq(goal - start))
    k = math.floor(float(away / turn))
    lifted = [away - (k + i) * turn for i in (-1, 0, 1)]  # the goal, seen from the start
    return bool(start < low and next_high - start < turn) and any(
        bool(high - start < x < next_low - start) for x in lifted
    )


# --- the witness ----------------------------------------------------------------------------------


def _check_witness(asked: _Asked, cells: Sequence[Cell], witness: Witness) -> None:
    from flint import ctx

    point, robot = _place(cells, witness), asked.robot
    if witness.boundary in beyond_limits(robot, point):
        return
    for boundary in robot.boundaries:
        if boundary.name == witness.boundary and boundary.used:
            with ctx.workprec(WITNESS_BITS):
                if _is_violated(_Asked(asked.content), boundary, point, witness):
                    return
    refuse("the witness violates nothing")


def _is_violated(asked: _Asked, boundary: Boundary, point: Sequence[Any], witness: Witness) -> bool:
    robot, margin = asked.robot, asked.content.statement.margin
    if not boundary.apart:
        return any(
            boundary_value(robot, single, margin, point) < 0 for single in asked.singles(boundary)
        )
    cores, weights = [], []
    for body, (part, numbers) in zip(boundary.bodies, witness.places, strict=True):
        if part >= len(asked.cores[body.name]):
            refuse("places: there is no such part")
        cores.append(asked.cores[body.name][part])
        weights.append(_mean(numbers, len(cores[-1].places)))
    q = [unit * x for unit, x in zip(units(robot), point, strict=True)]
    return asked.features(boundary, *cores).overlap(weights, q)


def _mean(numbers: Sequence[Any], count: int) -> list[Any]:
    """Return weights as Arb's rationals, if they are those of a mean of so many corners."""
    weights = [exact(w) for w in numbers]
    if len(weights) != count or min(weights) < 0 or sum(weights) != 1:
        refuse("the weights are not those of a mean of corners")
    return weights


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
    corners = cells[witness.cell].corners
    weights = _mean(witness.weights, len(corners))
    return tuple(
        sum(x * w for x, w in zip(column, weights, strict=True))
        for column in zip(*corners, strict=True)
    )
