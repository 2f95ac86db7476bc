"""A region verifies itself: its arcs, vertices, cells and loops, by margins that it did not use.

The engine decides structure from forms and features. Here the answer is asked of the evaluator of
margins, which knows robots and distances only; where its doubles do not decide, of balls.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.forms.angles import TURN
from qbound.region.cells import CellComplex, apart, turned_root
from qbound.region.outline import numbered, ordered
from qbound.region.plane import which
from qbound.region.precise import LEVELS, Precise, precision
from qbound.tolerances import ON_ARC, UNIT

if TYPE_CHECKING:
    from qbound.region.region import Region

PLACES = (-1.2, -0.4, 0.3, 1.0)
"""Where arcs are looked at: angles of their parametrization, from -pi/2 to pi/2."""

INSIDE = 0.43
"""Part of a cell's width at which it is looked at."""

BESIDE = (1e-6, 1e-9, 1e-12)
"""How far beside an arc it is asked what lies there, in units of a joint; then balls are asked."""

SPREAD_OUT = np.modf(np.outer(np.arange(1, 65), [0.7548776662466927, 0.5698402909980532]))[0]
"""Places in the unit square that are spread evenly (Roberts's sequence), shape (64, 2)."""

CLEAR = 64.0
"""A margin beyond so many times its rounding has a sign."""


def faults(found: Region) -> list[str]:
    """Return what is wrong with a region, a sentence each; none where it is right.

    Asked is whether each arc and vertex lies on its boundaries, whether each cell is free in its
    middle and its boundaries are violated just beyond, and whether loops are as many as Euler's
    count of the cells allows.
    """
    return [*_off(found), *_Cells(found).faults(), *_loops(found), *_lost(found)]


def _lost(found: Region) -> list[str]:
    """Ask places all over the ranges: one that is free beyond rounding lies in a cell."""
    if found.problem.blocked:  # what touches everywhere is feasible, and in no component
        return []
    ends = [(-np.pi, np.pi) if r is None else r for r in found.problem.ranges]
    low, high = np.array(ends).T
    q = low + (high - low) * SPREAD_OUT
    evaluator = found.problem.evaluator
    free = evaluator.at_least(q, CLEAR * evaluator.margin_rounding).all(axis=1)
    part = numbered(found.problem, found.cells, found.base, found.owner, q[free])
    missed = q[free][part < 0]
    return [f"({x:.9g}, {y:.9g}) is free and in no cell" for x, y in missed.tolist()]


def _off(found: Region) -> Iterator[str]:
    """Yield the arcs and vertices that do not lie on their boundaries."""
    arcs = [arc for part in found.found for loop in part.loops for arc in loop]
    if not arcs:
        return
    column = {name: k for k, name in enumerate(found.problem.evaluator.names)}
    laid = arcs[0].laid  # all arcs are laid behind one another
    first, end = np.array([arc.span for arc in arcs]).T
    begun = ordered(laid.start[first], laid.base)[:, None]
    q = np.concatenate([laid[(first + end - 1) // 2].places(np.array(PLACES)), begun], axis=1)
    starts = {tuple(arc.start.tolist()) for arc in arcs}
    for vertex in (vertex for part in found.found for vertex in part.vertices):
        if tuple(vertex.q.tolist()) not in starts:
            yield f"a vertex of {' and '.join(vertex.boundaries)} is not where an arc starts"
    limited = np.array([arc.row < 0 for arc in arcs])
    rows = np.array([0 if arc.row < 0 else column[arc.boundary] for arc in arcs])
    evaluator = found.problem.evaluator
    within = ON_ARC * evaluator.sizes
    held, more = (evaluator.at_least(q, least) for least in (-within, np.nextafter(within, np.inf)))
    off = np.take_along_axis(~held | more, rows[:, None, None], axis=2)[..., 0]
    if limited.any():
        off[limited] = _to_limits(found, q[limited]) > ON_ARC
    for k, place in np.argwhere(off).tolist():
        at = ", ".join(f"{x:.9g}" for x in q[k, place])
        if limited[k]:
            by = float(_to_limits(found, q[k, place]))
        else:
            by = abs(float(evaluator.margins(q[k, place])[rows[k]]))
        yield f"an arc of {arcs[k].boundary} is {by:.2g} off it at ({at})"
    for k, place, column_number in np.argwhere(~held).tolist():
        at = ", ".join(f"{x:.9g}" for x in q[k, place])
        name = evaluator.names[column_number]
        yield f"an arc of {arcs[k].boundary} runs where {name} is violated, at ({at})"


def _to_limits(found: Region, q: Floats) -> Floats:
    """Return how far configurations, (..., 2), are from the nearest limit, in units of a joint."""
    plane, gaps = found.cells.plane, []
    units = plane.base_unit, plane.lift_unit
    for j, limits in enumerate(found.problem.ranges):
        unit = units[0] if j == found.base else units[1]
        gaps += [(q[..., j] - end) / unit for end in limits or ()]
    return np.asarray(np.abs(gaps).min(axis=0))


class _Cells:
    """What the cells of a region are asked: free in the middle, and not beyond their ends."""

    def __init__(self, found: Region) -> None:
        self.cells, self.plane, inner = found.cells, found.cells.plane, found.inner
        self.found = found.cells.decomposition
        evaluator = found.problem.evaluator
        self.evaluator, self.doubt = evaluator, CLEAR * evaluator.margin_rounding
        self.column = {name: k for k, name in enumerate(evaluator.names)}
        self.names = [*inner.names, *(inner.contacts.boundaries[k] for k in inner.contacts.pair)]

    def faults(self) -> list[str]:
        """Return what is wrong."""
        cells = self.cells
        every = np.arange(len(cells.slabs))
        if not len(every):
            return []
        start, end = cells.spans(every).T
        t = start + INSIDE * (end - start)
        low, high = cells.interval(every, t[:, None])[..., 0]
        middle = low + INSIDE * (high - low)
        found, q = list[str](), self._ordered(t, middle)
        vague = which(~self.evaluator.at_least(q, self.doubt).all(axis=1))
        kept = self.evaluator.at_least(q[vague], -self.doubt)
        for k, held in zip(vague.tolist(), kept, strict=True):
            if not (held.all() and self._is_free(k, t[k], start[k], end[k])):
                found.append(f"a cell about {self._place(t[k], middle[k])} is not free")
        for side, value, sense in ((0, low, -1.0), (1, high, 1.0)):
            rows = which(cells.roots[:, side, 0] >= 0)
            names = [self.found.names[s] for s in self.found.sets[rows, side].tolist()]
            shut = self._shut(names, t[rows], value[rows], np.zeros(len(rows)), sense)
            for k in rows[~shut].tolist():
                if not self._is_shut(k, side, t[k], start[k], end[k]):
                    place = self._place(t[k], value[k])
                    found.append(f"beyond a cell's end at {place} nothing is violated")
        return found + self._standing()

    def _standing(self) -> list[str]:
        """Look on both sides of what stands on a fibre."""
        cells, elements = self.cells, self.cells.elements
        found = []
        for side, sense in ((0, 1.0), (1, -1.0)):
            rows = which(~elements.joined & (elements.cell[side] >= 0))
            line = elements.line[rows]
            t = cells.abscissae[line]
            ends = np.asarray(self.plane.ends)
            if self.plane.base_range is not None:
                kept = ~np.isin(t, ends)
                rows, line, t = rows[kept], line[kept], t[kept]
            v = (elements.low[rows] + elements.high[rows]) / 2
            standing = [self.found.standing.get(k, ()) for k in line.tolist()]
            other = elements.cell[1 - side][rows] >= 0  # it only touches: free on both sides
            shut = self._shut(standing, t, v, np.full(len(rows), sense), 0.0) | other
            for k in which(~shut).tolist():
                if not standing[k]:
                    found.append(f"nothing bounds a cell at {self._place(t[k], v[k])}")
        return found

    def _ordered(self, t: Floats, v: Floats) -> Floats:
        return ordered(np.stack([t, v], axis=1), self.plane.base)

    def _place(self, t: float, v: float) -> str:
        one, other = (t, v) if self.plane.base == 0 else (v, t)
        return f"({one:.9g}, {other:.9g})"

    def _shut(
        self, rows: list[tuple[int, ...]], t: Floats, v: Floats, along: Floats, up: float
    ) -> Bools:
        """Tell where some row's boundary is violated a little beside places, beyond rounding."""
        shut = np.zeros(len(rows), dtype=np.bool_)
        for step in BESIDE:
            left = which(~shut)
            if not len(left):
                break
            base = t[left] + step * self.plane.base_unit * along[left]
            q = self._ordered(base, v[left] + step * self.plane.lift_unit * up)
            violated = ~self.evaluator.at_least(q, -self.doubt)
            for k, own in zip(left.tolist(), violated, strict=True):
                shut[k] = any(own[self.column[self.names[row]]] for row in rows[k])
        return shut

    # --- in balls -------------------------------------------------------------------------------

    def _exactly(self, k: int, t: float, start: float, end: float) -> Any:
        """Return an exact base value inside a cell's slab."""
        from flint import arb

        lines, slab = self.found.critical, int(self.cells.slabs[k])
        if end - start > 1e3 * UNIT * max(abs(start), abs(end)):
            return arb(t)
        with precision(LEVELS[-1]):
            ends = [lines.ball(line, LEVELS[-1]) for line in (slab, slab + 1)]
            return arb((sum(ends) / 2).mid())

    def _is_free(self, k: int, t: float, start: float, end: float) -> bool:
        """Tell in balls whether a cell's middle is free."""
        precise, base = self.found.precise, self._exactly(k, t, start, end)

        def middle(bits: int) -> Any:
            low, high = (self._root(k, side, base, bits) for side in (0, 1))
            with precision(bits):
                return low + (high - low) * 3 / 7

        return _free(precise, base, middle)

    def _root(self, k: int, side: int, base: Any, bits: int) -> Any:
        form, branch, _ = self.cells.roots[k, side].tolist()
        near = self.cells.interval([k], np.array([[float(base.mid())]]))[side, 0, 0]
        return turned_root(self.found.precise, form, branch, base, bits, float(near))

    def _is_shut(self, k: int, side: int, t: float, start: float, end: float) -> bool:
        """Tell in balls whether a cell's boundary is violated just beyond one of its ends."""
        precise, base = self.found.precise, self._exactly(k, t, start, end)

        def beyond(bits: int) -> Any:
            from flint import arb

            with precision(bits):
                step = arb(2) ** -min(bits // 4, 100) * self.plane.lift_unit
                return self._root(k, side, base, bits) + (step if side else -step)

        count, contacts = self.plane.count, self.plane.contacts
        for row in self.found.names[int(self.found.sets[k, side])]:
            if row < count:
                if precise.sign(row, base, beyond) < 0:
                    return True
            elif not apart(precise, int(contacts.pair[row - count]), base, beyond):
                return True
        return self._goes_on(k, side, base)

    def _goes_on(self, k: int, side: int, base: Any) -> bool:
        """Tell whether another cell begins where a cell ends: a curve is only touched there."""
        cells, t = self.cells, np.array([[float(base.mid())]])
        own = which(cells.slabs == cells.slabs[k])
        ends = cells.interval(own, np.broadcast_to(t, (len(own), 1)))[..., 0]
        here = ends[side, own == k][0]
        gap = ends[1 - side] - here
        if cells.circle:
            gap -= TURN * np.round(gap / TURN)
        return bool((np.abs(gap) <= BESIDE[0] * self.plane.lift_unit).any())


def _free(precise: Precise, base: Any, place: Any) -> bool:
    """Tell in balls whether every form is positive at a place and all bodies are apart."""
    plane = precise.plane
    return all(precise.sign(row, base, place) > 0 for row in range(plane.count)) and all(
        apart(precise, pair, base, place) for pair in range(plane.contacts.pairs)
    )


def _loops(found: Region) -> list[str]:
    """Compare the number of loops of each component with Euler's count of its cells.

    A component is cells joined over open elements of lines. A cell counts 1, an element -1, both 0
    where they are whole circles, and a point between two elements that join the same cells 1. In a
    plane or on a cylinder as many loops bound it as 2 less that count; on a torus, of which it is
    all but some holes, 2 less.
    """
    cells, owner = found.cells, found.owner
    part = np.array([owner.get(k, -1) for k in range(len(cells.slabs))], dtype=np.int64)
    part[part >= len(found.found)] = -1
    wrong = [] if (part >= 0).all() else ["a cell is in no component"]
    if len(found.found) != len(cells.parts.cells):
        wrong.append(f"{len(found.found)} components, but {len(cells.parts.cells)} of cells")
    count = np.bincount(part[part >= 0], (~cells.whole[part >= 0]).astype(float), len(found.found))
    elements = cells.elements
    joined = which(elements.joined & ~cells.is_circle)
    for rows, change in ((joined, -1), (_between(cells), 1)):
        parts = part[elements.cell[0, rows]]
        np.add.at(count, parts[parts >= 0], change)
    for k, component in enumerate(found.found[: len(count)]):
        wanted = {2 - int(count[k])} | ({-int(count[k])} if all(component.wraps) else set())
        if len(component.loops) not in wanted:
            wrong.append(f"component {k} has {len(component.loops)} loops, not {min(wanted)}")
    return wrong


def _between(cells: CellComplex) -> Ints:
    """Return the elements whose upper end lies between it and the next, both joining one pair."""
    elements = cells.elements
    n = len(elements.line)
    if not n:
        return np.zeros(0, dtype=np.int64)
    following = np.arange(1, n + 1)
    new = np.append(elements.line[1:] != elements.line[:-1], True)
    first = np.append(True, new[:-1])
    last = which(new)
    following[last] = which(first) if cells.circle else last
    same = (elements.cell == elements.cell[:, following]).all(axis=0)
    alone = following == np.arange(n)
    # Of a circle that is one element nothing lies between: it has no end.
    return which(same & elements.joined & elements.joined[following] & ~alone)
