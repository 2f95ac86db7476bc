"""From loops round components to labelled arcs, in the order of the joints.

A loop's half-edges are laid one behind the other, those on one branch of one boundary are merged to
an arc, and the corners where two forms meet are brought onto both. All loops are laid at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.forms.angles import TURN, whole_turns
from qbound.forms.factors import basis, basis_and_slope
from qbound.region.arcs import FIBRE, Arc, Pieces, ordered
from qbound.region.cells import CellComplex
from qbound.region.decomposition import apart
from qbound.region.halfedges import DOWN, UP, UPPER, HalfEdges
from qbound.region.plane import Plane, runs, which
from qbound.region.precise import UndecidedError
from qbound.tolerances import NEWTON_DONE, POLISHED, TRANSVERSAL, UNIT

Item = TypeVar("Item")


@dataclass(frozen=True, eq=False)
class BoundaryLoop:
    """A closed loop round a component, and where the component is shown.

    Attributes
    ----------
    edges : ndarray of int, shape (n,)
        Rows of the cells' half-edges.
    shift : ndarray, shape (2,)
        Added to base and lift values of all its cells, rad.
    """

    edges: Ints
    shift: Floats


@dataclass(frozen=True, eq=False)
class _Laid:
    """Half-edges of all loops, one behind the other, one a row.

    Attributes
    ----------
    edges : ndarray of int, shape (n,)
    turns : ndarray, shape (n, 2)
        Added to base and lift values of its cell, rad.
    first : ndarray of bool, shape (n,)
        Whether it begins a loop.
    before, after : ndarray of int, shape (n,)
        The one before and the one after it in its loop.
    label : ndarray of int, shape (n, 4)
        Form, branch, which end of a range, and which rows vanish; equal along an arc.
    """

    edges: Ints
    turns: Floats
    first: Bools
    before: Ints
    after: Ints
    label: Ints


class Layout:
    """Lays out the loops of one decomposition.

    Parameters
    ----------
    cells : CellComplex
    edges : HalfEdges
        Those round the cells.
    base : int
        Which joint is the base.
    names : sequence of str
        One a form.
    limits : sequence of two (str, str)
        Names of the ends of each joint's range.
    """

    def __init__(
        self,
        cells: CellComplex,
        edges: HalfEdges,
        base: int,
        names: Sequence[str],
        limits: Sequence[tuple[str, str]],
    ) -> None:
        self.cells, self.edges, self.plane, self.base = cells, edges, cells.plane, base
        contacts = cells.plane.contacts
        self.names = [*names, *(contacts.boundaries[k] for k in contacts.pair.tolist())]
        self.features = [*[""] * len(names), *contacts.names]
        self.limits = [*limits[base], *limits[1 - base]]
        self._numbers = {rows: k for k, rows in enumerate(cells.decomposition.names)}

    def arcs(
        self, loops: Sequence[BoundaryLoop], windings: Ints
    ) -> list[tuple[tuple[Arc, ...], list[bool]]]:
        """Return the arcs of each loop, the component on their left, and which begin at a vertex.

        Cells lie at their windings, (cells, 2): turns of base and lift.
        """
        if not loops:
            return []
        laid = self._laid(loops, windings)
        changes = (laid.label != laid.label[laid.before]).any(axis=1)
        begin = which(laid.first | changes)
        pieces = self._pieces(laid, begin)
        order, corners = _from_lowest(laid, begin, pieces)
        spans, labels = list(pairwise([*begin.tolist(), len(changes)])), laid.label[begin].tolist()
        vague = self._vague(laid, begin, pieces).tolist()
        arcs = [self._arc(labels[k], pieces, spans[k], vague[k]) for k in order.tolist()]
        place = pairwise([*which(laid.first[begin]).tolist(), len(arcs)])
        at_vertex = corners[order].tolist()
        return [(tuple(arcs[i:j]), at_vertex[i:j]) for i, j in place]

    def _vague(self, laid: _Laid, begin: Ints, pieces: Pieces) -> Floats:
        """Bound how far the starts of arcs may be off, in units of a joint.

        Two curves that cross at an angle are known there by their errors over its sine; where they
        are tangent, or one turns back, by the square root of them.
        """
        plane, units = self.plane, np.array([self.plane.base_unit, self.plane.lift_unit])
        q = pieces.start[begin] - pieces.turns[begin]
        slopes, errors = np.zeros((2, len(begin), 2)), np.full((2, len(begin)), UNIT)
        for side, rows in enumerate((laid.before[begin], begin)):
            form = laid.label[rows, 0]
            limit = laid.label[rows, 2]
            slopes[side] = np.where((limit < 2)[:, None], [1.0, 0.0], [0.0, 1.0])
            k = which(form >= 0)
            base, lift = (
                basis_and_slope(kind, q[k, j])
                for j, kind in enumerate((plane.base_kind, plane.lift_kind))
            )
            both = base @ plane.table[form[k]] @ lift.swapaxes(1, 2)
            slopes[side, k] = np.stack([both[:, 1, 0], both[:, 0, 1]], axis=1) * units
            errors[side, k] = (plane.eps[form[k]] + 8 * UNIT) * plane.scaled_size[form[k]]
        steep = np.abs(slopes[0, :, 0] * slopes[1, :, 1] - slopes[0, :, 1] * slopes[1, :, 0])
        wide = errors.max(axis=0) * np.linalg.norm(slopes, axis=2).max(axis=0)
        return np.asarray(2 * wide / np.maximum(np.maximum(steep, np.sqrt(wide)), UNIT) + 16 * UNIT)

    def _arc(
        self, label: Sequence[int], pieces: Pieces, span: tuple[int, int], vague: float
    ) -> Arc:
        form, branch, end, number = label
        if form < 0:
            return Arc(self.limits[end], branch or None, pieces, span, "", form, (), vague)
        rows = list(self._numbers)[number]
        own = self.names[form], self.features[form]
        also = sorted({(self.names[row], self.features[row]) for row in rows} - {own})
        return Arc(own[0], branch or None, pieces, span, own[1], form, tuple(also), vague)

    def _laid(self, loops: Sequence[BoundaryLoop], windings: Ints) -> _Laid:
        """Put all loops one behind the other, each from where an arc begins."""
        rows = np.concatenate([loop.edges for loop in loops])
        length = np.array([len(loop.edges) for loop in loops])
        loop, start = np.arange(len(loops)).repeat(length), length.cumsum() - length
        label, number = self._labels(rows), np.arange(len(rows)) - start[loop]
        before = start[loop] + (number - 1) % length[loop]
        new = which((label != label[before]).any(axis=1))
        shift = np.zeros(len(loops), dtype=np.int64)
        shift[loop[new][::-1]] = number[new][::-1]  # the first of each loop comes last
        order = start[loop] + (number + shift[loop]) % length[loop]
        if self.base == 1:  # seen with the joints in their order, the loop runs backwards
            order = order[start[loop] + length[loop] - 1 - number]
        winding = windings[self.edges.cell[rows]]
        turns = TURN * winding + np.array([one.shift for one in loops])[loop]
        after = start[loop] + (number + 1) % length[loop]
        return _Laid(rows[order], turns[order], number == 0, before, after, label[order])

    # --- labels ---------------------------------------------------------------------------------

    def _labels(self, rows: Ints) -> Ints:
        """Return the labels of half-edges: branch 0 for none, form -1 at an end of a range."""
        edges, plane = self.edges, self.plane
        kind, cell, element = edges.kind[rows], edges.cell[rows], edges.element[rows]
        label = np.zeros((len(rows), 4), dtype=np.int64)
        side = (kind == UPPER).astype(int)
        root = self.cells.roots[cell, side]
        label[:, 0] = root[:, 0]
        label[:, 1] = root[:, 1] if plane.lift_kind == "revolute" else 0
        label[:, 3] = self.cells.decomposition.sets[cell, side]
        ends = which(root[:, 0] < 0)
        if len(ends):
            label[ends, 2] = 1 - root[ends, 0]  # 2 and 3: of the lift
            label[ends, :2] = [-1, 0]
        line = which(element >= 0)
        if len(line):
            label[line] = self._line_labels(element[line], kind[line] == UP)
        return label

    def _line_labels(self, element: Ints, up: Bools) -> Ints:
        """Name pieces of critical lines: a limit of the base, or what vanishes on the fibre."""
        plane, found = self.plane, self.cells.elements
        # Of a base that turns round the last line is the first, a turn on.
        line = found.line[element]
        t = self.cells.abscissae[line]
        label = np.zeros((len(element), 4), dtype=np.int64)
        if plane.base_range is not None:
            label[:, 2] = up
            label[:, 0] = np.where(t == np.array(plane.ends)[up.astype(int)], -1, 0)
        inner = which(label[:, 0] == 0)
        for k in inner.tolist():
            rows = self._standing(int(element[k]), bool(up[k]))
            label[k, 0] = rows[0]
            label[k, 3] = self._numbers.setdefault(rows, len(self._numbers))
        # A form falls along the base at theta + arccos; there the component lies before it.
        if plane.base_kind == "revolute":
            label[inner, 1] = np.where(up[inner], 1, -1)
        label[inner, 2] = 0
        return label

    def _standing(self, element: int, up: bool) -> tuple[int, ...]:
        """Return the rows that vanish on an element of a line and forbid what is beside it.

        The component lies before the line (`up`) or behind it: there the rows are positive. Where
        there are any, they are of pairs that are in collision on the other side.
        """
        plane, found = self.plane, self.cells.decomposition
        line, precise = int(self.cells.elements.line[element]), found.precise
        count, here, beyond = plane.count, *((-1, 1) if up else (1, -1))

        def t(bits: int) -> Any:
            return found.critical.ball(line, bits)

        v = self.cells.place(element, 0.5)
        touching = [
            row
            for row in found.standing.get(line, ())
            if row < count or precise.holds(row - count, t, v)
        ]
        if not touching:
            raise UndecidedError(f"which boundary stands at base value {float(t(64).mid()):.17g}")
        turning = [
            row
            for row in touching
            if precise.sign(row, t, v, beyond) < 0 < precise.sign(row, t, v, here)
        ]
        pairs = {int(plane.contacts.pair[row - count]) for row in turning if row >= count}
        met = {pair for pair in pairs if not apart(precise, pair, t, v, beyond)}
        shut = [row for row in turning if row < count or plane.contacts.pair[row - count] in met]
        return tuple(shut or turning or touching)  # bodies may touch, and be apart on both sides

    # --- places ---------------------------------------------------------------------------------

    def _pieces(self, laid: _Laid, begin: Ints) -> Pieces:
        """Lay the half-edges behind each other; a loop round a joint changes windings."""
        circles = np.array([self.plane.base_range is None, self.plane.lift_range is None])
        roots, start, end = self._places(laid.edges)
        # From one to the next the windings may change by whole turns, which add up.
        jumps = whole_turns((end + laid.turns)[laid.before] - start - laid.turns) * circles
        jumps[laid.first] = 0
        jumps = jumps.cumsum(axis=0)
        jumps -= jumps[laid.first][laid.first.cumsum() - 1]
        turns = laid.turns + TURN * jumps
        starts, ends = start + turns, end + turns
        # At a fold both sides stop a rounding's square root short of each other.
        gaps = ends[laid.before] - starts
        gaps -= TURN * whole_turns(gaps) * circles
        starts, ends = starts + gaps / 2, ends - gaps[laid.after] / 2
        self._polish(laid, begin, starts, ends)
        return Pieces(self.plane, self.base, roots, starts, ends, turns)

    def _places(self, rows: Ints) -> tuple[Ints, Floats, Floats]:
        """Return what half-edges follow, and start and end in the cell's coordinates, (n, 2)."""
        cells, edges = self.cells, self.edges
        kind, cell, element = edges.kind[rows], edges.cell[rows], edges.element[rows]
        side = ((kind == UP) | (kind == UPPER)).astype(int)
        roots, across = cells.roots[cell, side], element >= 0
        roots[across] = FIBRE, 0, 0
        n, found = len(rows), cells.elements
        places = np.empty((2, n, 2))  # low end first
        places[:, :, 0] = cells.abscissae[cells.slabs[cell] + np.array([[0], [1]])]
        places[:, :, 1] = cells.ends[cell, :, side].T
        k = which(across)
        at, right = element[k], side[k]
        places[:, k, 0] = places[right, k, 0]
        places[:, k, 1] = [found.low[at], found.high[at]]
        places[:, k, 1] += TURN * found.turns[1 - right, at]
        backwards = (kind == UPPER) | (kind == DOWN)
        if self.base == 1:
            backwards = ~backwards
        start = np.where(backwards[:, None], places[1], places[0])
        return roots, start, np.where(backwards[:, None], places[0], places[1])

    def _polish(self, laid: _Laid, begin: Ints, starts: Floats, ends: Floats) -> None:
        """Bring the corners where two forms meet onto both, all at once."""
        form = laid.label[:, 0]
        corner, last = begin, laid.before[begin]
        pair = np.array([form[last], form[corner]]).T
        met = (pair[:, 0] != pair[:, 1]) & (pair >= 0).all(axis=1)
        if not met.any():
            return
        corner, last = corner[met], last[met]
        before = starts[corner]
        q = _newton(self.plane, pair[met], before)
        # Where both are flat there Newton has no direction; the place is known well enough.
        units = np.array([self.plane.base_unit, self.plane.lift_unit])
        near = (np.abs(q - before) <= POLISHED * units).all(axis=1)
        better = _off(self.plane, pair[met], q) <= _off(self.plane, pair[met], before)
        q = np.where((near & better)[:, None], q, before)
        ends[last] += q - starts[corner]  # which may be some turns away
        starts[corner] = q


def _from_lowest(laid: _Laid, begin: Ints, pieces: Pieces) -> tuple[Ints, Bools]:
    """Let each loop begin at its lowest vertex, by the last joint, then the first, as in Figure 5.

    Of arcs that begin at these rows: their order, and which of them begin at a vertex. A loop that
    goes round a joint is left alone.
    """
    loop, start = laid.first[begin].cumsum() - 1, pieces.start[begin]
    first, last = runs(loop)
    label = laid.label[:, [0, 2, 3]]  # at a change of branch alone is no vertex
    corner: Bools = np.asarray((label[begin] != label[laid.before[begin]]).any(axis=1))
    q1, q2 = np.round(ordered(start, pieces.base), 9).T
    lowest = np.lexsort([q1, q2, ~corner, loop])[first]
    around = np.abs(pieces.end[laid.before[begin[first]]] - start[first]).max(axis=1) >= math.pi
    shift, length = np.where(corner[lowest] & ~around, lowest - first, 0), last + 1 - first
    number = np.arange(len(loop)) - first[loop]
    return first[loop] + (number + shift[loop]) % length[loop], corner


def behind(ring: Sequence[Item]) -> list[Item]:
    """Return for each entry of a ring the one before it."""
    return [ring[-1], *ring[:-1]]


def _newton(plane: Plane, pairs: Ints, q: Floats) -> Floats:
    """Two steps of Newton on pairs of forms, (k, 2), from base and lift values near, (k, 2)."""
    table = plane.table[pairs]
    for _ in range(2):
        base = basis_and_slope(plane.base_kind, q[:, 0])
        lift = basis_and_slope(plane.lift_kind, q[:, 1])
        both = base[:, None] @ table @ lift[:, None].swapaxes(2, 3)  # values and slopes
        value, slopes = both[:, :, 0, 0], np.array([both[:, :, 1, 0], both[:, :, 0, 1]])
        step = _least_step(slopes.transpose(1, 2, 0), value)
        q = q - step
        if (np.abs(step) <= NEWTON_DONE).all():
            break
    return q


def _off(plane: Plane, pairs: Ints, q: Floats) -> Floats:
    """Return how far the larger of two forms is from zero at base and lift values, (k,)."""
    base, lift = basis(plane.base_kind, q[:, 0]), basis(plane.lift_kind, q[:, 1])
    return np.asarray(
        np.abs(np.einsum("ki,kpij,kj->kp", base, plane.table[pairs], lift)).max(axis=1)
    )


def _least_step(slopes: Floats, value: Floats) -> Floats:
    """Solve pairs of equations, (k, 2, 2) and (k, 2).

    At a tangency or a double root the least step towards both is all that is known.
    """
    (a, b), (c, d) = slopes.transpose(1, 2, 0)
    determinant = a * d - b * c
    flat = np.abs(determinant) <= TRANSVERSAL * (slopes * slopes).sum(axis=(1, 2))
    x, y = value.T
    step = np.array([d * x - b * y, a * y - c * x]) / np.where(flat, 1.0, determinant)
    if flat.any():
        inverse = np.linalg.pinv(slopes[flat], rcond=TRANSVERSAL)
        step[:, flat] = (inverse @ value[flat][..., None])[..., 0].T
    return step.T
