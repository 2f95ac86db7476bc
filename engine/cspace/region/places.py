"""Cells as data: where configurations lie, areas, and even samples.

A cell lies between two roots, or ends of the lift, over an interval of the base. Values here are
joint values, base before lift; an angle of a root lies in the turn above its `floor`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final, NamedTuple

import numpy as np

from cspace.arrays import Floats, Ints, ranges
from cspace.region.algebra import HIGH, LOW, nearest
from cspace.region.arcs import Curves, legendre, ordered
from cspace.region.problem import Problem
from cspace.tolerances import QUADRATURE, SAME_POINT, TOUCH
from qbound.circle import TURN, first_from, nearest_turn

CELL_NODES: Final = (24, 32)
"""Numbers of nodes in a cell: mostly the second rule says what the first one did."""

CUTS: Final = np.array([0.0, 0.1, 0.5, 0.9, 1.0])
"""Where a cell is cut for its moments, as parts of its width."""

CUT_AGAIN: Final = 16
"""Times a cell may be cut."""

MOST_CELLS: Final = 2**14
"""Cells, or parts of them, that may be cut at once."""

BLOCK: Final = 2**18
"""Configurations that are looked at together."""

ROOM: Final = 1.25
"""No fibre of a cell is taller than so many times the tallest one at its nodes.

Roots are analytic inside a cell, and the nodes lie densest at both ends. Where a fibre were taller,
a sample would have a little less of it.
"""


class Placed(NamedTuple):
    """A cell that holds a configuration, exactly or nearly.

    Attributes
    ----------
    cell : int
    place : ndarray, shape (2,)
        Base and lift value in the cell's own turns.
    off : ndarray, shape (2,)
        Step from there to the cell's closure; zero inside.
    """

    cell: int
    place: Floats
    off: Floats


@dataclass(frozen=True, eq=False)
class CellMap:
    """The cells of a region, and the component of each.

    Attributes
    ----------
    curves : Curves
    round : pair of bool
        Whether base and lift turn all the way round; then they are cut open at their ends.
    range : ndarray, shape (2, 2)
        Ends of base and lift.
    lines : ndarray, shape (s,)
        Base values at which something changes, ascending.
    span : ndarray of int, shape (k, 2)
        First and last line of each cell.
    row, slope : ndarray of int, shape (k, 2)
        Curve and slope of both roots; `LOW` and `HIGH` are the ends of the lift.
    floor : ndarray, shape (k, 2)
        The angle up from which each root lies within a turn.
    ends : ndarray, shape (k, 2, 2)
        Lift values, [first or last line, lower or upper root].
    turns : ndarray of int, shape (k, 2)
        Turns by which each cell is moved to lie next to its neighbours.
    owner : ndarray of int, shape (k,)
        The component of each cell, by index.
    joined : ndarray of int, shape (j, 2)
        Cells that share an open edge on a line, left and right.
    edge : ndarray, shape (j, 2)
        Lift values of the ends of this edge.
    """

    curves: Curves
    round: tuple[bool, bool]
    range: Floats
    lines: Floats
    span: Ints
    row: Ints
    slope: Ints
    floor: Floats
    ends: Floats
    turns: Ints
    owner: Ints
    joined: Ints
    edge: Floats

    def spans(self, chosen: Sequence[int] | Ints) -> Floats:
        """Return the base values between which cells lie, shape (k, 2)."""
        return np.asarray(self.lines[self.span[np.asarray(chosen, dtype=np.int64)]])

    def interval(self, chosen: Sequence[int] | Ints, t: Floats) -> Floats:
        """Return lower and upper root of cells, each over its own row of base values: (2, k, n)."""
        k = np.asarray(chosen, dtype=np.int64)
        found, edges = np.empty((2, *t.shape)), self.spans(k)
        row = self.row[k].T
        found[row == LOW], found[row == HIGH] = self.range[1]
        e, n = np.nonzero(row >= 0)
        own, at = k[n], t[n]
        v = self.curves.follow(row[e, n], self.slope[own, e], at)
        if self.curves.turns[1]:
            floor = self.floor[own, e][:, None]
            v = floor + (v - floor) % TURN
            for side in (0, 1):
                near = np.abs(at - edges[n, side, None]) <= TOUCH * self.curves.scale[0]
                if near.any():
                    v = np.where(near, nearest(v, self.ends[own, side, e][:, None]), v)
        else:  # between two lines as near as rounding a root may be infinite
            v = np.clip(np.nan_to_num(v), *self.range[1])
        found[e, n] = v
        np.maximum(found[0], found[1], out=found[1])
        return found

    def surround(self, place: Floats, room: float) -> bool:
        """Tell whether base and lift values are inside a cell, with room on all sides, in units."""
        t, v = (float(x) for x in place)
        around = room * np.array(self.curves.scale)
        edges = self.lines[self.span] + around[0] * np.array([1, -1])
        k = np.flatnonzero((edges[:, 0] < t) & (t < edges[:, 1]))
        low, high = self.interval(k, np.full((len(k), 1), t))[..., 0]
        return bool(((low + around[1] < v) & (v < high - around[1])).any())

    # --- where a configuration lies ---------------------------------------------------------------

    def placed(self, place: Floats) -> list[Placed]:
        """Return the cells within reach of base and lift values, those that hold them first.

        The reach is `TOUCH` in the units of base and lift.
        """
        values = [
            self._beside_the_cut(j, float(x)) for j, x in enumerate(np.asarray(place, dtype=float))
        ]
        found = [one for t in values[0] for v in values[1] for one in self._placed(t, v)]
        return sorted(found, key=lambda one: float(np.abs(one.off).max()))

    def _beside_the_cut(self, j: int, x: float) -> list[float]:
        """Return a joint value within the range; near the cut of a circle on both sides of it."""
        if not self.round[j]:
            return [x]
        low, high = self.range[j].tolist()
        x = float(first_from(low, x))
        return [x, *[x - TURN] * (x >= high - TOUCH), *[x + TURN] * (x <= low + TOUCH)]

    def _placed(self, t: float, v: float) -> list[Placed]:
        reach = TOUCH * np.array(self.curves.scale)
        edges = self.lines[self.span]
        k = np.flatnonzero((edges[:, 0] <= t + reach[0]) & (t <= edges[:, 1] + reach[0]))
        if not len(k):
            return []
        start, end = edges[k].T
        inset = SAME_POINT * (end - start)
        inside = np.clip(t, start + inset, end - inset)
        roots = self.interval(k, inside[:, None])[..., 0]
        roots = np.where(t <= start + inset, self.ends[k, 0].T, roots)
        low, high = np.where(t >= end - inset, self.ends[k, 1].T, roots)
        off = np.stack([np.clip(t, start, end) - t, np.clip(v, low, np.maximum(low, high)) - v])
        reached = np.flatnonzero((np.abs(off) <= reach[:, None]).all(axis=0))
        return [Placed(int(k[n]), np.array([t, v]), off[:, n]) for n in reached]

    def closures(self, problem: Problem, q: Floats) -> list[Placed]:
        """Return the cells in whose closure a configuration lies.

        A configuration slightly beside a cell, by the rounding of a fold, belongs to the cell if
        nothing is violated half-way.
        """
        if q.shape != (2,):
            raise ValueError(
                f"one configuration of two joint values is wanted, found shape {q.shape}"
            )
        feasible, base = problem.evaluator.feasible, self.curves.base
        if not feasible(q):
            return []
        return [
            one
            for one in self.placed(ordered(q, base))
            if not one.off.any() or feasible(q + ordered(one.off, base) / 2)
        ]

    def numbered(self, problem: Problem, q: Floats) -> Ints:
        """Return the number of the component of each configuration, (n, 2) to (n,); -1: none.

        Infeasible configurations are in no component, whatever the cells say. Configurations well
        inside a cell are decided all at once; of the others the first of `closures` is taken.
        """
        found = np.full(len(q), -1)
        feasible = np.flatnonzero(problem.evaluator.feasible(q))
        place = ordered(q[feasible], self.curves.base).copy()
        for j in np.flatnonzero(self.round):
            place[:, j] = first_from(self.range[j, 0], place[:, j])
        order = np.argsort(place[:, 0], kind="stable")
        t, v = place[order].T
        base_near, lift_near = TOUCH * np.array(self.curves.scale)
        edges = self.lines[self.span] + base_near * np.array([1, -1])
        first, last = t.searchsorted(edges[:, 0], "right"), t.searchsorted(edges[:, 1], "left")
        count = np.maximum(last - first, 0)
        for own in np.array_split(np.flatnonzero(count), 1 + count.sum() // BLOCK):
            which, at = ranges(first[own], last[own])
            k = own[which]
            low, high = self.interval(k, t[at, None])[..., 0]
            inside = (low + lift_near < v[at]) & (v[at] < high - lift_near)
            found[feasible[order[at[inside]]]] = self.owner[k[inside]]
        for n in feasible[found[feasible] < 0]:
            owners = [self.owner[one.cell] for one in self.closures(problem, q[n])]
            found[n] = min(owners, default=-1)
        return found

    # --- measures ---------------------------------------------------------------------------------

    def moments(self) -> Floats:
        """Return area and first moments about base and lift of each cell, shape (k, 3).

        Gauss-Legendre in t = m + h sin(angle), in which a fold is smooth (sentence 12), by two
        rules. Cells in which these differ, for example near a saddle, are cut.
        Changes are measured in the joints' units, because a slide's values may be millions.
        """
        base, lift = self.curves.scale
        least = base * lift * np.array([1.0, base, lift])
        of, spans = np.arange(len(self.span)), self.lines[self.span]
        found = np.zeros((len(of), 3))
        for n in range(CUT_AGAIN):
            rough, now = self._moments(of, spans, CELL_NODES)
            changed = (np.abs(now - rough) > QUADRATURE * (least + np.abs(now))).any(axis=1)
            changed &= n < CUT_AGAIN - 1 and len(of) < max(MOST_CELLS, 2 * len(self.span))
            np.add.at(found, of[~changed], now[~changed])
            of, spans = of[changed].repeat(len(CUTS) - 1), spans[changed]
            if not len(of):
                break
            at = spans[:, :1] * (1 - CUTS) + spans[:, 1:] * CUTS
            spans = np.stack([at[:, :-1].ravel(), at[:, 1:].ravel()], axis=1)
        return found

    def _moments(self, of: Ints, spans: Floats, nodes: tuple[int, ...]) -> Floats:
        """Return the moments of cells between base values by rules of some nodes: (rules, k, 3)."""
        sines, weights = smooth_rules(nodes)
        start, end = spans.T[:, :, None]
        half = (end - start) / 2
        t = (start + end) / 2 + half * sines
        low, high = self.interval(of, t)
        height = high - low
        moments = np.array([height, height * t, height * (low + high) / 2])
        return np.asarray((moments @ weights).T * half)

    def drawn(self, problem: Problem, n: int, rng: np.random.Generator) -> Floats:
        """Draw n places evenly over all cells, shape (n, 2); full-turn angles are in (-pi, pi].

        A cell is chosen with probability proportional to its area; then a base value by rejection,
        proportional to the height of the cell.
        """
        areas = self.moments()[:, 0]
        start, end = self.lines[self.span].T
        middle, half = (start + end)[:, None] / 2, (end - start)[:, None] / 2
        low, high = self.interval(np.arange(len(areas)), middle + half * smooth_rules((48,))[0])
        tallest = ROOM * (high - low).max(axis=1)
        chosen = rng.choice(len(areas), n, p=areas / areas.sum())
        place, left = np.empty((n, 2)), np.arange(n)
        while len(left):
            k = chosen[left]
            t = rng.uniform(start[k], end[k])
            low, high = self.interval(k, t[:, None])[..., 0]
            place[left] = np.stack([t, rng.uniform(low, high)], axis=-1)
            left = left[rng.uniform(size=len(left)) * tallest[k] > high - low]
        q = ordered(place, self.curves.base)
        return np.where([ends is None for ends in problem.ranges], nearest_turn(q, 0), q)


@cache
def smooth_rules(nodes: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return sin(angle) at Gauss-Legendre nodes of the angle, and weights, for [-1, 1].

    The nodes of all rules are joined, shape (n,). The weights of each rule are a column, (n,
    rules), with zeros at the other rules' nodes.
    """
    rules = [legendre(n) for n in nodes]
    angle = np.concatenate([x for x, _ in rules]) * math.pi / 2
    weights = np.zeros((len(angle), len(nodes)))
    ends = np.cumsum([0, *nodes])
    for k, (_, own) in enumerate(rules):
        weights[ends[k] : ends[k + 1], k] = own
    return np.sin(angle), weights * math.pi / 2 * np.cos(angle)[:, None]
