"""Certificates that no path leads from one configuration to another.

Either a joint cannot pass some values, whatever the other joints do; or boxes of up to three joints
are in the way while the other joints are held. Both proofs are a tree over the joints that move.
Each leaf on which a thing is violated throughout has a place of two hulls. The computation is in
doubles; the checker decides.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Bools, Floats, Ints
from cspace.model.robot import Robot
from cspace.proofs import Verdict
from cspace.proofs.certificates import witness
from cspace.proofs.certificates.certify import Certificate, Subject
from cspace.proofs.certificates.inequality import BoundedArm
from cspace.proofs.certificates.search import margins
from cspace.proofs.certificates.statements import within_limits
from cspace.proofs.exact.bounds import Cells as DyadicCells
from cspace.proofs.subdivide import Boxes, Cells, Judged, best_cuts, subdivide
from cspace.proofs.subpaving.connection import all_round, joined, touching
from cspace.proofs.subpaving.forbidden import BlockedRange
from cspace.proofs.subpaving.paving import Paving

MOST_CELLS = 50_000
"""Boxes that a search opens before it gives up."""

TRIED = 2
"""Things that are tried on a box: those that violate most of the cells that it meets."""

SAMPLES = 65
"""Values of a joint at which a range is looked at."""

THIN = 2.0**-40
"""Part of a joint's range that a leaf has to cover."""


def certify_no_path(
    subject: str | Robot | Subject, one: ArrayLike, other: ArrayLike, ranges: Sequence[BlockedRange]
) -> Certificate:
    """Certify that no path leads from one configuration to another, because a joint is blocked.

    Not in the paper.

    Parameters
    ----------
    subject : str, Robot or Subject
        The robot, as `certify` takes it.
    one, other : array_like, shape (n,)
        rad or length; the file has these values rounded to decimals.
    ranges : sequence of BlockedRange
        Ranges of one joint: one range between its two values; for a joint without limits two ranges
        with one of the values between them, on any turn.

    Returns
    -------
    Certificate
        Proved, or undecided if the checker does not confirm the proof.

    Raises
    ------
    ValueError
        If `one` or `other` is not a configuration of the robot.
    """
    subject = Subject.of(subject)
    ends, j = _ends(subject.robot, one, other), ranges[0].joint
    kinds = ["moves" if k == j else "any" for k in range(ends.shape[1])]
    task = _Task(BoundedArm(subject.form), kinds, ends[0])
    names = [[k for k, name in enumerate(task.arm.names) if name == r.boundary] for r in ranges]
    rows = [task.deepest_value(j, r.low, r.high, own) for r, own in zip(ranges, names, strict=True)]
    low = np.zeros((len(rows), ends.shape[1]))
    low[:, j] = rows
    high = low.copy()
    high[:, j] += THIN
    things = sorted({k for own in names for k in own})
    depth = np.array([[float(k in own) for k in things] for own in names])
    return _certified(subject, task, ends, low, high, things, depth)


def certify_disconnected(
    subject: str | Robot | Subject, one: ArrayLike, other: ArrayLike, paving: Paving
) -> Certificate:
    """Certify that no path joins two configurations while joints with equal values are held.

    Not in the paper.

    Parameters
    ----------
    subject : str, Robot or Subject
        The robot, as `certify` takes it.
    one, other : array_like, shape (n,)
        rad or length; the file has these values rounded to decimals.
    paving : Paving
        A paving of the moving joints, one to three, that separates the two configurations.

    Returns
    -------
    Certificate
        Proved, or undecided if the checker does not confirm the proof.

    Raises
    ------
    ValueError
        If `one` or `other` is not a configuration of the robot, or the paving does not separate
        them.
    """
    subject = Subject.of(subject)
    ends = _ends(subject.robot, one, other)
    names = [f"{joint.name}.lower" for joint in subject.robot.joints]
    moving = [names.index(name) for name, _ in paving.problem.limits]
    kinds = ["moves" if k in moving else "held" for k in range(ends.shape[1])]
    task = _Task(BoundedArm(subject.form), kinds, ends[0])
    things = [k for k, needed in enumerate(task.arm.needed) if needed]

    def spread(values: Floats) -> Floats:
        """Write values of the joints that move among those of all joints."""
        rows = np.zeros((len(values), len(kinds)))
        rows[:, moving] = values
        return rows

    def depths(low: Floats, high: Floats) -> Floats:
        middle = task.placed(Boxes.between(spread(low), spread(high))).centres
        return np.maximum(-margins(task.arm, things, middle), 0) / task.arm.size

    start, goal = ends[:, moving]
    found = separator(paving, start, goal, depths)
    low, high = spread(found.low), spread(found.high)
    return _certified(subject, task, ends, low, high, things, found.depth)


def _ends(robot: Robot, one: ArrayLike, other: ArrayLike) -> Floats:
    return np.stack([robot.configuration(q) for q in (one, other)])


def _certified(
    subject: Subject,
    task: _Task,
    ends: Floats,
    low: Floats,
    high: Floats,
    things: Sequence[int],
    depth: Floats,
) -> Certificate:
    """Cover cells by leaves, and write the certificate."""
    judge = _Judge(task, low, high, things, depth)
    moving = np.array([kind == "moves" for kind in task.kinds])
    whole = Boxes.between(np.zeros((1, len(moving))), 1.0 * moving[None])
    found = subdivide(whole, [0], judge, MOST_CELLS)[0]
    if found.left:
        return Certificate(Verdict.UNDECIDED, "", f"undecided: {found.left} boxes")
    claim = {
        "set": "no path",
        "margin": "0",
        "points": [within_limits(subject.robot, ends)],
        "joints": task.kinds,
    }
    proof = {"places": judge.places, "tree": found.trees[0]}
    return subject.confirmed(claim, Verdict.PROVED, proof=proof)


class _Task:
    """An arm and its moving joints; boxes are given as fractions of these joints' ranges."""

    def __init__(self, arm: BoundedArm, kinds: list[str], start: Floats) -> None:
        self.arm, self.kinds = arm, kinds
        self.free = [kind == "any" for kind in kinds]
        whole = 180.0 if arm.form["angle_unit"] == "deg" else 3.1416
        rows = [joint["limits"] or (-whole, whole) for joint in arm.form["joints"]]
        low, high = np.array(rows, dtype=float).T * arm.units
        moves, free = (np.array([k == kind for k in kinds]) for kind in ("moves", "any"))
        self.low = np.where(moves, low, np.where(free, (low + high) / 2, start))
        self.size = np.where(moves, high - low, 0)

    def placed(self, boxes: Boxes) -> Boxes:
        """Return boxes in rad or length, shape (N, n)."""
        return Boxes(self.low + self.size * boxes.centres, self.size * boxes.halfwidths)

    def deepest_value(self, j: int, low: float, high: float, things: Sequence[int]) -> float:
        """Return where in a range of joint j things are violated most, as fractions of it."""
        end = self.low[j] + self.size[j]
        if self.arm.form["joints"][j]["limits"] is None:
            back = math.floor((low - self.low[j]) / math.tau) * math.tau
            low, high = low - back, high - back
        else:
            low, high = max(low, self.low[j]), min(high, end)
        q = np.tile(self.low, (SAMPLES, 1))
        q[:, j] = np.linspace(low, high, SAMPLES + 2)[1:-1]
        if self.arm.form["joints"][j]["limits"] is None:
            q[:, j] -= np.where(q[:, j] > end, math.tau, 0)
        points, best = Boxes(q, np.zeros_like(q)), np.full(SAMPLES, -np.inf)
        for k in things:
            best = np.maximum(best, self.values(np.full(SAMPLES, k), points)[0])
        return float((q[best.argmax(), j] - self.low[j]) / self.size[j])

    def values(
        self, things: Ints, cells: Boxes, known: Sequence[witness.Contacts] | None = None
    ) -> tuple[Floats, list[witness.Contacts]]:
        """Return by how much things are violated all over cells, and the places that show this."""
        values, shown = np.zeros(len(things)), dict[int, witness.Contacts]()
        for kind, positions, rows in self.arm.by_kind(things):
            own = cells[positions]
            if known is None:
                found = witness.contacts(self.arm, kind, rows, own)
            else:
                found = witness.Contacts.joined([known[k] for k in positions])
            values[positions] = witness.violated(self.arm, kind, rows, own, found, self.free)
            shown |= {int(at): found[k : k + 1] for k, at in enumerate(positions)}
        return values, [shown[k] for k in range(len(things))]


class _Judge:
    """Judges boxes: closed if a box meets no cell or a thing is violated on it, else cut.

    Parameters
    ----------
    low, high : ndarray, shape (S, n)
        The cells that leaves with a place have to cover, as fractions of the ranges.
    depth : ndarray, shape (S, things)
        How deep each thing is violated in the middle of each cell; 0 if it is kept.
    """

    def __init__(
        self, task: _Task, low: Floats, high: Floats, things: Sequence[int], depth: Floats
    ) -> None:
        moving = np.flatnonzero([kind == "moves" for kind in task.kinds])
        self.task, self.moving, self.things = task, moving, np.array(things)
        self.low, self.high, self.depth = low[:, moving], high[:, moving], depth
        self.places = list[witness.Evidence]()
        self.numbers = dict[str, int]()

    def __call__(self, cells: Cells, _: NDArray[Any]) -> Judged:
        assert isinstance(cells, Boxes)
        met = self._met(cells)
        leaves = np.where(met.any(axis=1), "", ".").astype(object)
        cuts = np.full(len(cells), -1)
        left = np.flatnonzero(met.any(axis=1))
        if len(left):
            things, values, shown = self._best(cells[left], met[left])
            closed = values > self.task.arm.spare
            for k in np.flatnonzero(closed).tolist():
                leaves[left[k]] = self._leaf(int(things[k]), shown[k])
            rest = np.flatnonzero(~closed)
            if len(rest):
                own = [shown[k] for k in rest]
                cuts[left[rest]] = self._cuts(cells[left[rest]], things[rest], own)
        return Judged(leaves.tolist(), cuts, np.zeros(len(cells)), cells.centres)

    def _met(self, cells: Boxes) -> Bools:
        """Tell which boxes meet which cells, shape (N, S)."""
        met = np.ones((len(cells), len(self.low)), dtype=bool)
        for k, j in enumerate(self.moving):
            met &= cells.low[:, j, None] < self.high[:, k]
            met &= cells.high[:, j, None] > self.low[:, k]
        return met

    def _best(self, cells: Boxes, met: Bools) -> tuple[Ints, Floats, list[witness.Contacts]]:
        """Return a thing for each box, by how much it is violated throughout, and where.

        The thing that is violated on most cells that the box meets is taken, unless another one
        closes the box.
        """
        count = met.sum(axis=1, keepdims=True)
        score = met @ (self.depth > 0) / count + met @ self.depth / count
        ranks = self.things[np.argsort(-score, axis=1)[:, :TRIED]]
        placed, things = self.task.placed(cells), ranks[:, 0].copy()
        best, shown = self.task.values(things, placed)
        for rank in range(1, ranks.shape[1]):
            left = np.flatnonzero(best <= self.task.arm.spare)
            if len(left):
                values, found = self.task.values(ranks[left, rank], placed[left])
                for k in np.flatnonzero(values > self.task.arm.spare).tolist():
                    row = left[k]
                    things[row], best[row], shown[row] = ranks[row, rank], values[k], found[k]
        return things, best, shown

    def _cuts(self, cells: Boxes, things: Ints, shown: Sequence[witness.Contacts]) -> Ints:
        """Choose a joint that moves for each box; a half that meets no cell is closed."""
        twice, known = np.repeat(things, 2), [each for each in shown for _ in range(2)]

        def worth(_: Ints, halves: Cells) -> Floats:
            assert isinstance(halves, Boxes)
            values, _contacts = self.task.values(twice, self.task.placed(halves), known)
            return np.where(self._met(halves).any(axis=1), values, np.inf)

        tried = np.tile(np.isin(np.arange(cells.cuts), self.moving), (len(cells), 1))
        return best_cuts(cells, tried, worth, self.task.arm.spare, self.task.arm.size)

    def _leaf(self, thing: int, shown: witness.Contacts) -> str:
        place = witness.place_of(self.task.arm, thing, shown)
        number = self.numbers.setdefault(str(place), len(self.places))
        if number == len(self.places):
            self.places.append(place)
        return f"{number}."


# --- few boxes that separate ----------------------------------------------------------------------
# A paving that separates has thousands of cells, most of them small, along the surfaces of what is
# feasible. A certificate needs a separator of the two configurations alone, and that may lie deep
# in what is infeasible, where cells are large. So infeasible cells are given up, the smallest and
# shallowest first, as long as the other cells still separate the two configurations.

Depths = Callable[[Floats, Floats], Floats]
"""From low and high corners, in parts of the joints' ranges, to how deep each thing to keep is
violated in the middle: shape (s, things), 0 where it is kept."""


@dataclass(frozen=True, eq=False)
class Separator:
    """Infeasible cells that separate two configurations; no cell can be left out.

    Attributes
    ----------
    low, high : ndarray, shape (s, n)
        Corners of the cells, as fractions of each joint's range; exact.
    depth : ndarray, shape (s, things)
    """

    low: Floats
    high: Floats
    depth: Floats


def separator(paving: Paving, one: ArrayLike, other: ArrayLike, depths: Depths) -> Separator:
    """Choose infeasible cells of a paving that separate two configurations, large ones if possible.

    Not in the paper.

    Parameters
    ----------
    paving : Paving
        A paving that separates the two configurations, see `connection.separated`.
    one, other : array_like, shape (n,)
        rad or length.
    depths : callable
        Function from cells to depths; of equally large cells the shallowest are given up first.

    Raises
    ------
    ValueError
        If the paving does not separate the two configurations.

    Examples
    --------
    >>> from cspace.proofs.subpaving.connection import connection
    >>> from cspace.proofs.exact.problem import exact_problem, exact_robot
    >>> ends = [0.0, 0.0], [0.2, 2.5]
    >>> found = connection(exact_problem(exact_robot("minervabot-v2")), *ends)
    >>> chosen = separator(found.paving, *ends, lambda low, high: np.ones((len(low), 1)))
    >>> len(chosen.low) < found.paving.cells / 10
    True
    """
    closed = paving.infeasible[::-1]  # the smallest first
    cells = (*paving.feasible, paving.undecided, *closed)
    first = np.cumsum([0, *map(len, cells)])
    edges = touching(cells, all_round(paving), corners=True)
    ends = [
        np.flatnonzero(np.concatenate([paving.containing(c, q) for c in cells]))
        for q in (one, other)
    ]
    counts = first[-1 - len(closed) :]
    opened, label = _open_sizes(edges, counts, [found[found < counts[0]] for found in ends])
    if not len(label):
        raise ValueError("the paving does not separate the two configurations")
    left, groups = closed[opened:], int(label.max()) + 1
    low, high = _corners(left)
    depth = depths(low, high)
    levels = np.repeat([c.level for c in left], [len(c) for c in left])
    order = groups + np.lexsort([depth.max(axis=1), -levels])
    edges = np.concatenate([label, groups + np.arange(len(depth))])[edges]
    sides = [set(label[found[found < counts[0]]].tolist()) for found in ends]
    kept = _kept(edges[(edges >= groups).any(axis=1)], groups, order.tolist(), sides)
    chosen = np.array(kept) - groups
    return Separator(low[chosen], high[chosen], depth[chosen])


def _open_sizes(edges: Ints, counts: Ints, ends: Sequence[Ints]) -> tuple[int, Ints]:
    """Open all infeasible cells of a size, size after size, as long as the other cells separate.

    Parameters
    ----------
    edges : ndarray of int, shape (e, 2)
        Pairs of touching cells. Cells that are open from the start have the lowest numbers, then
        the infeasible ones follow, size after size.
    counts : ndarray of int
        Number of cells that are open from the start, and then with each size.
    ends : two ndarrays of int
        The open cells that hold either configuration.

    Returns
    -------
    opened : int
        Number of sizes that are opened.
    label : ndarray of int
        The group of each open cell.
    """
    found = 0, np.zeros(0, dtype=np.int64)
    for opened, count in enumerate(counts.tolist()):
        label = joined(count, edges[(edges < count).all(axis=1)])
        if np.isin(label[ends[0]], label[ends[1]]).any():
            break
        found = opened, label
    return found


def _corners(cells: Sequence[DyadicCells]) -> tuple[Floats, Floats]:
    """Return low and high corners of cells, as fractions of the ranges."""
    low = np.concatenate([each.index / 2.0**each.bits for each in cells])
    return low, np.concatenate([(each.index + 1) / 2.0**each.bits for each in cells])


def _kept(
    edges: Ints, groups: int, order: Sequence[int], ends: Sequence[Iterable[int]]
) -> list[int]:
    """Open closed cells one after the other; return the cells that would join the two sides.

    Parameters
    ----------
    edges : ndarray of int, shape (e, 2)
        Pairs of touching cells; numbers below `groups` are groups of open ones.
    order : sequence of int
        Closed cells, in the order in which they are opened.
    ends : two sequences of int
        The groups on either side.
    """
    near: dict[int, list[int]] = {k: [] for k in order}
    for a, b in edges.tolist():
        for one, other in ((a, b), (b, a)):
            if one in near:
                near[one].append(other)
    leader = list(range(groups + len(order)))
    sides = {k: side for side, labels in enumerate(ends) for k in labels}

    def lead(k: int) -> int:
        while leader[k] != k:
            leader[k] = leader[leader[k]]
            k = leader[k]
        return k

    closed, kept = set(order), []
    for k in order:
        met = {lead(other) for other in near[k] if other not in closed}
        side = {sides[m] for m in met if m in sides}
        if len(side) > 1:
            kept.append(k)
            continue
        closed.remove(k)
        for m in met:
            leader[m] = k
            if m in sides:
                sides[k] = sides[m]
    return kept
