"""Components and their boundaries: half-edges round cells, closed loops, labelled arcs, measures.

Half-edges go round each cell, with the cell on the left: along its lower root, up or down the
critical lines at its sides, back along the upper root. Half-edges where no cells are joined make
the closed loops that bound a component. Half-edges on one branch of one boundary are merged into an
arc. The corners where two forms meet are moved onto both forms.

An arc runs along roots of one form (or one end of a joint's range), piece by piece between
critical values. Along a piece the base is ``middle + half sin(angle)``: where a root folds back,
its square root is smooth in this angle. So places along arcs are exact, and line integrals are
right to machine precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from itertools import chain, pairwise
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Bools, Floats, Ints, ranges
from cspace.forms.factors import basis_and_slope, whole_turns
from cspace.model.robot import real_numbers
from cspace.order import Key, ordered_by
from cspace.printable import printable
from cspace.region.cells import CellComplex, Placed, apart
from cspace.region.plane import TINY, Plane, UndecidedError, runs, which
from cspace.region.problem import Problem
from cspace.tolerances import (
    AGREE,
    NEWTON_DONE,
    POLISHED,
    QUADRATURE,
    SAME_POINT,
    TIED,
    TOUCH,
    TRANSVERSAL,
    UNIT,
)
from qbound.circle import TURN, first_from, nearest_turn
from qbound.forms import HarmonicForm, basis

LOWER, UP, UPPER, DOWN = range(4)
"""Half-edges round a cell, in the order of the loop: along a root, or along a critical line."""


@dataclass(frozen=True, eq=False)
class HalfEdges:
    """Half-edges round cells, one in each row; those of a cell together, in order round it.

    Attributes
    ----------
    kind : ndarray of int, shape (n,)
        `LOWER`, `UP`, `UPPER` or `DOWN`.
    cell : ndarray of int, shape (n,)
    element : ndarray of int, shape (n,)
        The element, for half-edges along a critical line; -1 along a root.
    after : ndarray of int, shape (n,)
        The half-edge that follows round the cell.
    twin : ndarray of int, shape (n,)
        The half-edge on the other side of a joined element; -1 where nothing is joined.
    """

    kind: Ints
    cell: Ints
    element: Ints
    after: Ints
    twin: Ints


def half_edges(cells: CellComplex) -> HalfEdges:
    """Return the half-edges round all cells.

    A cell that is a whole circle has two cycles of them; any other has one.
    """
    found, along = cells.elements, which(~cells.whole)
    up, down = which(found.cell[0] >= 0), which(found.cell[1] >= 0)
    right, left = found.cell[0, up], found.cell[1, down]
    count, none = [len(along), len(up), len(along), len(down)], np.full(len(along), -1)
    kind = np.array([LOWER, UP, UPPER, DOWN]).repeat(count)
    cell = np.concatenate([along, right, along, left])
    element = np.concatenate([none, up, none, down])
    heights = cells.in_order(right, 1, up), cells.in_order(left, 0, down)
    order = np.lexsort([np.concatenate([none, heights[0], none, -heights[1]]), kind, cell])
    kind, cell, element = kind[order], cell[order], element[order]
    first, last = runs(2 * cell + (cells.whole[cell] & (kind == DOWN)))
    after = np.arange(1, len(cell) + 1)
    after[last] = first
    return HalfEdges(kind, cell, element, after, _twins(cells, kind, element))


def _twins(cells: CellComplex, kind: Ints, element: Ints) -> Ints:
    """Return for each half-edge the one on the other side; -1 where nothing is joined."""
    place = np.full((2, len(cells.elements.line)), -1)  # the half-edges of each element
    for row, way in enumerate((UP, DOWN)):
        here = which(kind == way)
        place[row, element[here]] = here
    across = which(element >= 0)
    joined = across[cells.elements.joined[element[across]]]
    twin = np.full(len(kind), -1)
    twin[joined] = place[(kind[joined] == UP).astype(int), element[joined]]
    return twin


def find_loops(cells: CellComplex, edges: HalfEdges) -> list[list[int]]:
    """Return the closed loops that bound components, one component after the other.

    Loops are rows of half-edges with the component on their left. If two cells are joined over an
    element of a line, the walk passes the element by the other cell's half-edge. The remaining
    half-edges form the loops.
    """
    chosen = np.array(list(chain(*cells.parts.cells)), dtype=np.int64)
    _, rows = ranges(edges.cell.searchsorted(chosen), edges.cell.searchsorted(chosen + 1))
    left = dict.fromkeys(rows[edges.twin[rows] < 0].tolist())
    after = _next_bounding(edges).tolist()
    loops = []
    while left:
        row = start = next(iter(left))
        loop: list[int] = []
        while not loop or row != start:
            loop.append(row)
            del left[row]
            row = after[row]
        loops.append(loop)
    return loops


def _next_bounding(edges: HalfEdges) -> Ints:
    """Return the next half-edge on the boundary of a component, past joined elements."""
    bounding = edges.twin < 0  # a walk round a point inside a component would never end
    after = np.where(bounding, edges.after, 0)
    while len(inner := which(bounding & (edges.twin[after] >= 0))):
        after[inner] = edges.after[edges.twin[after[inner]]]
    return after


FIBRE: Final = -3
"""Stands for the form of a root where a piece follows none."""

LEAST: Final = 64 * UNIT
"""A base value this near to an end, in units of the joint, is that end."""

NODES: Final = (24, 48, 96, 192, 384, 768)
"""Numbers of Gauss-Legendre nodes that are tried in turn."""

MOST_PARTS: Final = 256
"""Parts of an arc that are looked at before none is halved: a near kink takes two a halving."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of boundary, in the order of the loop.

    Attributes
    ----------
    plane : Plane
    base : int
        Which joint is the base; places are given in the order of the joints.
    roots : ndarray of int, shape (k, 3)
        The root that each piece follows, as in `Root`; its form is `FIBRE` for a straight piece
        along the lift.
    start, end : ndarray, shape (k, 2)
        Base and lift value at both ends.
    turns : ndarray, shape (k, 2)
        Full turns that were added to the base and lift values of the plane, rad.
    """

    plane: Plane
    base: int
    roots: Ints
    start: Floats
    end: Floats
    turns: Floats

    def __getitem__(self, chosen: slice | Ints) -> Pieces:
        """Return some of the pieces."""
        return Pieces(
            self.plane,
            self.base,
            self.roots[chosen],
            self.start[chosen],
            self.end[chosen],
            self.turns[chosen],
        )

    def straight(self) -> list[bool]:
        """Tell whether each piece is straight: along a fibre, or at an end of a range."""
        found: list[bool] = (self.roots[:, 0] < 0).tolist()
        return found

    def places(self, angle: Floats) -> Floats:
        """Return joint values at angles from -pi/2 (start) to pi/2 (end), shape (k, n, 2)."""
        part = (1 + np.sin(angle))[:, None] / 2
        start, end = self.start[:, None], self.end[:, None]
        q = np.where(part < 1, start + (end - start) * part, end)
        curved = np.flatnonzero(self.roots[:, 0] != FIBRE)
        turns, along = self.turns[curved][:, None], q[curved][..., 0]
        values = self.plane.follow(self.roots[curved], along - turns[..., 0]) + turns[..., 1]
        gaps = [np.abs(along - x[curved][..., 0]) for x in (start, end)]
        # At an end an angle may jump by a turn, and the root of a quadratic may jump to its other
        # branch.
        turns_round = self.plane.lift_kind == "revolute"
        reach = (TOUCH if turns_round else SAME_POINT) * self.plane.base_unit
        for gap, x in zip(gaps, (start, end), strict=True):
            off = values - x[curved][..., 1]
            if turns_round:
                off = TURN * whole_turns(off)
            else:
                off[np.abs(off) <= AGREE * self.plane.lift_unit] = 0.0
            values -= np.where(gap <= reach, off, 0)
        # The ends are given, because a form that vanishes on the whole fibre has no root there.
        least = np.minimum(LEAST * self.plane.base_unit, np.abs(end - start)[curved][..., 0] / 1e3)
        q[curved, :, 1] = np.where(np.minimum(*gaps) > least, values, q[curved][..., 1])
        return ordered(q, self.base)

    def halved(self) -> Pieces:
        """Return the halves of all pieces, cut at the middle of their base values."""
        middle = ordered(self.places(np.zeros(1))[:, 0], self.base)
        both = self[np.arange(len(self.roots)).repeat(2)]
        both.end[::2] = both.start[1::2] = middle
        return both

    def nodes(self, n: int) -> tuple[Floats, Floats]:
        """Return Gauss-Legendre nodes and steps dq with their weights, both of shape (k, n, 2).

        The steps are those of the polynomial through nodes and ends. So no slope is needed, which
        would be infinite at a fold, and the steps of a piece add up to its end minus its start.
        """
        x, steps = _steps(n)
        q = self.places(x * math.pi / 2)
        return q[:, 1:-1], steps @ q


@dataclass(frozen=True, eq=False)
class Arc:
    """A piece of boundary on which one form vanishes, or one joint is at its limit.

    Attributes
    ----------
    boundary : str
    branch : int or None
        -1 or +1: the root theta - arccos or theta + arccos of Theorem 2; None if there is no such
        root.
    laid : Pieces
        Pieces of boundary, among them those of the arc, the region on their left.
    span : tuple of two int
        Index of the arc's first piece, and the index after its last one.
    feature : str
        For two bodies, what touches, the first body's feature first: "corner 2 on edge 3".
    row : int
        Row of the form that vanishes along the arc, in the pieces' plane; negative at a joint
        limit.
    also : tuple of (str, str)
        Other boundaries and features that vanish along the whole arc, because they coincide there.
    vague : float
        Error of the arc's start, in units of a joint.
    """

    boundary: str
    branch: int | None
    laid: Pieces
    span: tuple[int, int]
    feature: str = ""
    row: int = -1
    also: tuple[tuple[str, str], ...] = ()
    vague: float = 0.0

    def __repr__(self) -> str:
        """Show the boundary and the ends of the arc on one line."""
        branch = "" if self.branch is None else f" ({self.branch:+d})"
        start, end = (", ".join(f"{x:.6g}" for x in q) for q in (self.start, self.end))
        feature = f": {self.feature}" if self.feature else ""
        return printable(f"<Arc of {self.boundary}{feature}{branch} from ({start}) to ({end})>")

    @property
    def label(self) -> tuple[str, str]:
        """Boundary and feature of the arc; a vertex is where they change."""
        return self.boundary, self.feature

    @cached_property
    def pieces(self) -> Pieces:
        """The pieces of the arc, with the region on their left."""
        return self.laid[slice(*self.span)]

    @property
    def form(self) -> HarmonicForm | None:
        """The form that vanishes along the arc, largest coefficient 1; None at a joint limit.

        For two bodies it is the form of the feature that touches there. It tells nothing about the
        bodies at other places.
        """
        return self.laid.plane.form(self.row) if self.row >= 0 else None

    @property
    def start(self) -> Floats:
        """Joint values at the start, shape (2,)."""
        return ordered(self.laid.start[self.span[0]], self.laid.base)

    @property
    def end(self) -> Floats:
        """Joint values at the end, shape (2,)."""
        return ordered(self.laid.end[self.span[1] - 1], self.laid.base)

    @cached_property
    def points(self) -> Floats:
        """Joint values along the arc, exact, its two ends first and last, shape (k, 2)."""
        places = self.pieces.places(np.linspace(-math.pi / 2, math.pi / 2, 33))
        ends_suffice = self.pieces.straight()
        parts = [p[[0, -1]] if s else p for p, s in zip(places, ends_suffice, strict=True)]
        line = np.concatenate(parts)
        moves = np.abs(np.diff(line, axis=0)).max(axis=1) > SAME_POINT
        return np.concatenate([line[:1], line[1:-1][moves[:-1]], line[-1:]])

    def at(self, s: ArrayLike) -> Floats:
        """Return joint values at parameters in [0, 1], shape (...) to (..., 2); exact, ends too.

        Pieces between critical values have equal parts of [0, 1]. A parameter beyond gives an end.

        Raises
        ------
        ValueError
            If a parameter is NaN or complex.
        """
        parameters = real_numbers(s)
        if np.isnan(parameters).any():
            raise ValueError("a parameter along an arc is NaN")
        x = np.clip(parameters, 0, 1).reshape(-1) * len(self.pieces.roots)
        piece = np.minimum(x.astype(np.int64), len(self.pieces.roots) - 1)
        q = np.empty((len(x), 2))
        for k in np.unique(piece):
            mine = piece == k
            q[mine] = self.pieces[k : k + 1].places((x[mine] - k - 0.5) * math.pi)[0]
        return q.reshape(*parameters.shape, 2)

    def nodes(self, n: int = 48) -> tuple[Floats, Floats]:
        """Return Gauss-Legendre nodes q and weighted steps dq, each of shape (n pieces, 2).

        The sum of ``P(q) dq_1 + Q(q) dq_2`` is the integral of P dq_1 + Q dq_2 along the arc.
        """
        q, dq = self.pieces.nodes(n)
        return q.reshape(-1, 2), dq.reshape(-1, 2)


def ordered(place: Floats, base: int) -> Floats:
    """Bring places, shape (..., 2), from (base, lift) to the order of the joints, or back."""
    return place if base == 0 else place[..., ::-1]


def integrate(arcs: Sequence[Arc], form: Callable[[Floats, Floats], ArrayLike]) -> Floats:
    """Integrate along arcs, nodes doubled until nothing changes.

    Parameters
    ----------
    form : callable
        (q, dq), both of shape (n, 2) -> the integrand's contributions, shape (n, ...).

    Returns
    -------
    ndarray, shape (...)
        The sum over all arcs. Changes are measured relative to the sum of absolute contributions,
        so joint values and integrands may be in any units.
    """
    if not arcs:
        return np.zeros(())
    rough = [np.abs(form(*arc.nodes(NODES[0]))).sum(axis=0) for arc in arcs]
    smallest = QUADRATURE * np.sum(rough, axis=0)
    found = [_integral(arc.pieces, form, smallest) for arc in arcs]
    return np.asarray(np.sum(found, axis=0))


def _integral(
    pieces: Pieces, form: Callable[[Floats, Floats], ArrayLike], smallest: Floats
) -> Floats:
    """Integrate along pieces; halve pieces without convergence, such as one near a saddle.

    Pieces are not halved if only rounding changes, such as for a small component far from 0.
    """

    def over(part: Pieces, n: int) -> Floats:
        q, dq = (x.reshape(-1, 2) for x in part.nodes(n))
        return np.asarray(np.asarray(form(q, dq)).sum(axis=0))

    total, left, looked_at = np.zeros(np.shape(smallest)), [pieces], 0
    while left:
        part, looked_at = left.pop(), looked_at + 1
        found, change = _settling(partial(over, part), smallest)
        if (change > smallest).any() and looked_at < MOST_PARTS:
            q = part.nodes(NODES[0])[0].reshape(-1, 2)
            rounding = np.abs(form(q, 32 * UNIT * np.abs(q))).sum(axis=0)
            if (change > smallest + rounding).any():
                halves = part.halved()
                left += [halves[k : k + 1] for k in range(len(halves.roots))]
                continue
        total = total + found
    return total


def converged(sums: Callable[[int], Floats], smallest: Floats | float) -> Floats:
    """Return sums over n nodes, n doubled until they change by no more than `smallest`."""
    return _settling(sums, smallest)[0]


def _settling(sums: Callable[[int], Floats], smallest: Floats | float) -> tuple[Floats, Floats]:
    """Return the same sums, and by how much they changed last."""
    before = sums(NODES[0])
    for n in NODES[1:]:
        now = sums(n)
        change = np.abs(now - before)
        if (change <= smallest).all():
            break
        before = now
    return now, change


@cache
def legendre(n: int) -> tuple[Floats, Floats]:
    """Return nodes and weights of Gauss-Legendre quadrature on [-1, 1].

    Newton's method on the angles of the nodes, from Tricomi's; it needs no library and no matrix.
    """
    angle = np.pi * (np.arange(1, (n + 1) // 2 + 1) - 0.25) / (n + 0.5)
    for last in (False, False, False, True):
        x, before = np.cos(angle), np.ones(len(angle))
        value = x
        for k in range(2, n + 1):  # the recurrence of Legendre's polynomials
            before, value = value, ((2 * k - 1) * x * value - (k - 1) * before) / k
        slope = n * (before - x * value)  # times the square of the sine; level at a node
        angle = angle if last else angle + value * np.sin(angle) / slope
    weights = 2 * (np.sin(angle) / slope) ** 2
    mirrored = slice(None, None, -1) if n % 2 == 0 else slice(-2, None, -1)
    return np.concatenate([-x, x[mirrored]]), np.concatenate([weights, weights[mirrored]])


@cache
def _steps(n: int) -> tuple[Floats, Floats]:
    """Return -1, n Gauss-Legendre nodes and 1, and the matrix of weighted steps, (n, n + 2).

    Rows times values at the n + 2 places are the derivatives of the polynomial through them at the
    nodes, times the weights (barycentric form; the factors are 1 / P_n' at the nodes, from the
    quadrature's weights).
    """
    nodes, weights = legendre(n)
    signs = (-1.0) ** np.arange(n + 2)
    inner = np.sqrt(weights / (2 * (1 - nodes**2)))
    factors = signs * np.concatenate([[0.5], inner, [0.5]])
    x = np.concatenate([[-1.0], nodes, [1.0]])
    gaps = x[1:-1, None] - x
    rows, same = np.arange(n), np.arange(1, n + 1)
    gaps[rows, same] = 1
    slopes = factors / factors[1:-1, None] / gaps
    slopes[rows, same] = 0
    slopes[rows, same] = -slopes.sum(axis=1)
    return x, weights[:, None] * slopes


Item = TypeVar("Item")


@dataclass(frozen=True, eq=False)
class _Laid:
    """Half-edges of all loops, one behind the other, one in each row.

    Attributes
    ----------
    edges : ndarray of int, shape (n,)
    turns : ndarray, shape (n, 2)
        Added to base and lift values of its cell, rad.
    first : ndarray of bool, shape (n,)
        Whether it begins a loop.
    before, after : ndarray of int, shape (n,)
        The half-edges before and after it in its loop.
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
        The half-edges round the cells.
    problem : Problem
        A problem with the same rows as the cells' plane.
    """

    def __init__(self, cells: CellComplex, edges: HalfEdges, problem: Problem) -> None:
        self.cells, self.edges, self.plane = cells, edges, cells.plane
        self.base, contacts = cells.plane.base, cells.plane.contacts
        self.names = [*problem.names, *(contacts.boundaries[k] for k in contacts.pair.tolist())]
        self.features = [*[""] * len(problem.names), *contacts.names]
        self.limits = [*problem.limits[self.base], *problem.limits[1 - self.base]]
        self._numbers = {rows: k for k, rows in enumerate(cells.decomposition.names)}

    def arcs(
        self, loops: list[list[int]], shifts: Floats
    ) -> list[tuple[tuple[Arc, ...], list[bool]]]:
        """Return the arcs of each loop, component on the left, and which begin at a vertex.

        Cells are shifted by their windings; `shifts`, (loops, 2), are added to base and lift, rad.
        """
        if not loops:
            return []
        laid = self._laid(loops, shifts)
        changes = (laid.label != laid.label[laid.before]).any(axis=1)
        begin = which(laid.first | changes)
        pieces = self._pieces(laid, begin)
        vague = self._vague(laid, begin, pieces).tolist()
        order, corners = _from_lowest(laid, begin, pieces, vague)
        spans, labels = list(pairwise([*begin.tolist(), len(changes)])), laid.label[begin].tolist()
        arcs = [self._arc(labels[k], pieces, spans[k], vague[k]) for k in order]
        place = pairwise([*which(laid.first[begin]).tolist(), len(arcs)])
        at_vertex = [corners[k] for k in order]
        return [(tuple(arcs[i:j]), at_vertex[i:j]) for i, j in place]

    def _vague(self, laid: _Laid, begin: Ints, pieces: Pieces) -> Floats:
        """Bound the errors of the starts of arcs, in units of a joint.

        Where two curves cross at an angle, the error is their errors over the sine of the angle.
        Where they are tangent, or one turns back, it is the square root of their errors.
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

    def _laid(self, loops: list[list[int]], shifts: Floats) -> _Laid:
        """Put all loops one behind the other, each from where an arc begins."""
        rows = np.concatenate(loops)
        length = np.array([len(loop) for loop in loops])
        loop, start = np.arange(len(loops)).repeat(length), length.cumsum() - length
        label, number = self._labels(rows), np.arange(len(rows)) - start[loop]
        before = start[loop] + (number - 1) % length[loop]
        new = which((label != label[before]).any(axis=1))
        shift = np.zeros(len(loops), dtype=np.int64)
        shift[loop[new][::-1]] = number[new][::-1]  # written last, so the first one stays
        order = start[loop] + (number + shift[loop]) % length[loop]
        if self.base == 1:  # seen with the joints in their order, the loop runs backwards
            order = order[start[loop] + length[loop] - 1 - number]
        turns = TURN * self.cells.parts.windings[self.edges.cell[rows]] + shifts[loop]
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
        """Label pieces of critical lines: a limit of the base, or rows that vanish on the fibre."""
        plane, found = self.plane, self.cells.elements
        # If the base is a circle, the last line is the first one, a turn later.
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
        """Return the rows that vanish on an element of a line and forbid one side of it.

        The component lies before the line (`up`) or behind it, and the rows are positive there.
        Rows of pairs that are in collision on the other side are preferred.
        """
        plane, found = self.plane, self.cells.decomposition
        line, precise = int(self.cells.elements.line[element]), found.precise
        count, beyond = plane.count, 1 if up else -1

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
        if len(touching) == 1:  # nothing to decide: no ball is needed
            return tuple(touching)
        turning = [row for row in touching if precise.sides(row, t, v) == (beyond, -beyond)]
        pairs = {int(plane.contacts.pair[row - count]) for row in turning if row >= count}
        met = {pair for pair in pairs if not apart(precise, pair, t, v, beyond)}
        shut = [row for row in turning if row < count or plane.contacts.pair[row - count] in met]
        return tuple(shut or turning or touching)  # touching bodies may be apart on both sides

    # --- places ---------------------------------------------------------------------------------

    def _pieces(self, laid: _Laid, begin: Ints) -> Pieces:
        """Place the half-edges one behind the other; a loop round a joint changes windings."""
        circles = np.array([self.plane.base_range is None, self.plane.lift_range is None])
        roots, start, end = self._places(laid.edges)
        # Between half-edges the windings may change by whole turns, which add up.
        jumps = whole_turns((end + laid.turns)[laid.before] - start - laid.turns) * circles
        jumps[laid.first] = 0
        jumps = jumps.cumsum(axis=0)
        jumps -= jumps[laid.first][laid.first.cumsum() - 1]
        turns = laid.turns + TURN * jumps
        starts, ends = start + turns, end + turns
        # At a fold both sides end short of each other, by the square root of rounding.
        gaps = ends[laid.before] - starts
        gaps -= TURN * whole_turns(gaps) * circles
        starts, ends = starts + gaps / 2, ends - gaps[laid.after] / 2
        self._polish(laid, begin, starts, ends)
        return Pieces(self.plane, self.base, roots, starts, ends, turns)

    def _places(self, rows: Ints) -> tuple[Ints, Floats, Floats]:
        """Return the roots of half-edges, and start and end in the cell's coordinates, (n, 2)."""
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
        """Move the corners where two forms meet onto both forms, all at once."""
        form = laid.label[:, 0]
        corner, last = begin, laid.before[begin]
        pair = np.array([form[last], form[corner]]).T
        met = (pair[:, 0] != pair[:, 1]) & (pair >= 0).all(axis=1)
        if not met.any():
            return
        corner, last = corner[met], last[met]
        before = starts[corner]
        q = _newton(self.plane, pair[met], before)
        # If both forms are flat there, Newton's method has no direction; the place is accurate
        # enough.
        units = np.array([self.plane.base_unit, self.plane.lift_unit])
        near = (np.abs(q - before) <= POLISHED * units).all(axis=1)
        better = _off(self.plane, pair[met], q) <= _off(self.plane, pair[met], before)
        q = np.where((near & better)[:, None], q, before)
        ends[last] += q - starts[corner]  # a neighbour may be some turns away
        starts[corner] = q


def _from_lowest(
    laid: _Laid, begin: Ints, pieces: Pieces, vague: Sequence[float]
) -> tuple[list[int], list[bool]]:
    """Let each loop begin at its lowest vertex: by the last joint, then the first (Figure 5).

    Return the order of the arcs that begin at these rows, and which begin at a vertex. A loop that
    goes round a joint is not changed. `vague` has the errors of the starts, in units of a joint.
    """
    loop, start = laid.first[begin].cumsum() - 1, pieces.start[begin]
    label = laid.label[:, [0, 2, 3]]  # a change of branch is not a vertex
    corner = (label[begin] != label[laid.before[begin]]).any(axis=1).tolist()
    q = ordered(start, pieces.base).tolist()
    plane = pieces.plane
    units = ordered(np.array([plane.base_unit, plane.lift_unit]), pieces.base).tolist()

    def key(joint: int) -> Key[int]:
        return lambda k: (q[k][joint], max(TIED, vague[k]) * units[joint])

    order: list[int] = []
    for first, last in zip(*(rows.tolist() for rows in runs(loop)), strict=True):
        around = np.abs(pieces.end[laid.before[begin[first]]] - start[first]).max() >= math.pi
        vertices = [k for k in range(first, last + 1) if corner[k]]
        lowest = first if around or not vertices else ordered_by(vertices, [key(1), key(0)])[0]
        order += [*range(lowest, last + 1), *range(first, lowest)]
    return order, corner


def behind(ring: Sequence[Item]) -> list[Item]:
    """Return for each entry of a ring the entry before it."""
    return [ring[-1], *ring[:-1]]


def _newton(plane: Plane, pairs: Ints, q: Floats) -> Floats:
    """Two Newton steps on pairs of forms, (k, 2), from nearby base and lift values, (k, 2)."""
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

    At a tangency or a double root only the least step towards both is known.
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


CELL_NODES: Final = (NODES[0], 32, *NODES[1:4])
"""Numbers of nodes that are tried in turn in a cell: of most the second says what the first did."""

HALVINGS: Final = 40
"""Times a cell may be halved for its moments."""

ROOM: Final = 1.25
"""No fibre of a cell is taller than so many times the tallest one at its nodes.

Roots are analytic between critical values, and the nodes lie densest at both ends. Where a fibre
were taller, a sample would have a little less of it.
"""


@dataclass(frozen=True, eq=False)
class Vertex:
    """A point of the boundary where two boundaries meet.

    Attributes
    ----------
    q : ndarray, shape (2,)
        Joint values.
    boundaries : tuple of two str
    error : float
        Error of a joint value, in units of a joint: rad, or a slide's farthest limit. If two curves
        are tangent, only half of the digits are known.
    """

    q: Floats
    boundaries: tuple[str, str]
    error: float = 0.0

    def __repr__(self) -> str:
        """Show the place of the vertex and its boundaries on one line."""
        place = ", ".join(f"{x:.6g}" for x in self.q)
        vague = f" within {self.error:.1g}" if self.error > 1e-9 else ""
        return printable(f"<Vertex of {' and '.join(self.boundaries)} at ({place}){vague}>")


@dataclass(frozen=True, eq=False)
class Component:
    """A connected piece of the region.

    Attributes
    ----------
    area : float
        Product of the two joints' units.
    centroid : ndarray, shape (2,), or None
        Of the area; None where the component goes round a joint.
    wraps : tuple of two bool
        Whether the component goes all the way round each joint.
    loops : tuple of tuple of Arc
        The closed loops that bound the component, which is on their left.
    vertices : tuple of Vertex
        In the order of the loops.
    contains_home : bool
    area_unit : str
        The product of both joints' units.

    Notes
    -----
    Questions that need more than a component are answered by its region:
    ``region.component_of(q) == k`` tells where configurations lie in component k,
    ``region.plot(component=k)`` draws it alone, and ``region.to_shapely(component=k)`` returns its
    polygons.
    """

    area: float
    centroid: Floats | None
    wraps: tuple[bool, bool]
    loops: tuple[tuple[Arc, ...], ...]
    vertices: tuple[Vertex, ...]
    contains_home: bool
    area_unit: str = ""

    def __repr__(self) -> str:
        """Show the size and the boundaries of the component on one line."""
        home = ", with home" if self.contains_home else ""
        loops = f"{len(self.loops)} loop{'s' * (len(self.loops) != 1)}"
        sizes = f"{len(self.vertices)} vertices, {loops}"
        return f"<Component: area {self.area:.6g} {self.area_unit}, {sizes}{home}>"


def closures(problem: Problem, cells: CellComplex, base: int, q: Floats) -> list[Placed]:
    """Return the cells in whose closure a configuration lies.

    A configuration slightly beside a cell, by the rounding of a fold, belongs to the cell if
    nothing is violated half-way.
    """
    if q.shape != (2,):
        raise ValueError(f"one configuration of two joint values is wanted, found shape {q.shape}")
    feasible = problem.evaluator.feasible
    if not feasible(q):
        return []
    return [
        one
        for one in cells.placed(ordered(q, base))
        if not one.off.any() or feasible(q + ordered(one.off, base) / 2)
    ]


def numbered(
    problem: Problem, cells: CellComplex, base: int, owner: Mapping[int, int], q: Floats
) -> Ints:
    """Return the number of the component of each configuration, shape (n, 2) to (n,); -1: none.

    Infeasible configurations are in no component, whatever the cells say. Configurations well
    inside a cell are decided all at once. For the others the first one of `closures` is taken.
    """
    found = np.full(len(q), -1)
    feasible = np.flatnonzero(problem.evaluator.feasible(q))
    t, v = ordered(q[feasible], base).T
    if cells.wrapped:
        t = first_from(cells.plane.ends[0], t)
    slab = np.searchsorted(cells.abscissae, t) - 1
    order = np.argsort(slab, kind="stable")
    first = np.searchsorted(slab[order], np.arange(len(cells.abscissae) + 1))
    near = TOUCH * cells.plane.base_unit
    for cell, component in owner.items():
        here = order[first[cells.slabs[cell]] : first[cells.slabs[cell] + 1]]
        if not len(here):
            continue
        start, end = cells.spans([cell])[0]
        here = here[(start + near < t[here]) & (t[here] < end - near)]
        if len(here) and not cells.whole[cell]:
            low, high = cells.interval([cell], t[None, here])[:, 0]
            lift = first_from(low, v[here]) if cells.circle else v[here]
            here = here[(low + cells.touch < lift) & (lift < high - cells.touch)]
        found[feasible[here]] = component
    for k in feasible[found[feasible] < 0]:
        placed = closures(problem, cells, base, q[k])
        found[k] = min((owner[one.cell] for one in placed if one.cell in owner), default=-1)
    return found


def drawn(
    problem: Problem, cells: CellComplex, base: int, own: Ints, n: int, rng: np.random.Generator
) -> Floats:
    """Draw n places evenly over some cells, shape (n, 2); full-turn angles are in (-pi, pi].

    A cell is chosen with probability proportional to its area; then a base value by rejection,
    proportional to the height of the cell.
    """
    areas = _cell_moments(cells)[own, 0]
    sines, _ = _smooth_rules((NODES[1],))
    start, end = cells.spans(own).T
    low, high = cells.interval(own, (start + end)[:, None] / 2 + (end - start)[:, None] / 2 * sines)
    tallest = ROOM * (high - low).max(axis=1)
    chosen = rng.choice(len(own), n, p=areas / areas.sum())
    place, left = np.empty((n, 2)), np.arange(n)
    while len(left):
        k = chosen[left]
        t = rng.uniform(start[k], end[k])
        low, high = cells.interval(own[k], t[:, None])[..., 0]
        place[left] = np.stack([t, rng.uniform(low, high)], axis=-1)
        left = left[rng.uniform(size=len(left)) * tallest[k] > high - low]
    q = ordered(place, base)
    return np.where([ends is None for ends in problem.ranges], nearest_turn(q, 0), q)


def outlined(
    problem: Problem, searched: Problem, cells: CellComplex, home: Floats
) -> list[tuple[Component, list[int]]]:
    """Return the components, each with its boundary, and the cells of each.

    The components with the home pose come first, the others as `in_canonical_order` puts them.

    Parameters
    ----------
    problem : Problem
        The problem that was asked.
    searched : Problem
        The part of it that was searched; its rows are those of the cells' plane.
    home : ndarray, shape (2,)
        A component that holds the home pose is placed on its turns; others are placed with their
        centroid in (-pi, pi], up to `TIED`.
    """
    base, parts, part = cells.plane.base, cells.parts, cells.parts.of_cells()
    areas, middles = _moments_of_parts(cells)
    circles = np.array([r is None for r in (cells.plane.base_range, cells.plane.lift_range)])
    around = np.array(parts.wraps, dtype=np.bool_).reshape(-1, 2)
    bounded: Bools = np.asarray(~around.any(axis=1))
    shifts = (nearest_turn(middles, TIED) - middles) * circles * bounded[:, None]
    at_home: dict[int, Placed] = {}
    for one in {one.cell: one for one in closures(problem, cells, base, home)}.values():
        at_home.setdefault(int(part[one.cell]), one)
    for k, one in at_home.items():
        shifts[k] = ordered(home, base) - one.place - TURN * parts.windings[one.cell]
    edges = half_edges(cells)
    loops = find_loops(cells, edges)
    owner = np.array([part[edges.cell[loop[0]]] for loop in loops], dtype=np.int64)
    arcs = Layout(cells, edges, searched).arcs(loops, shifts[owner])
    found = []
    for k, (wraps, own) in enumerate(zip(parts.wraps, parts.cells, strict=True)):
        rings = [arcs[loop] for loop in which(owner == k)]
        component = Component(
            float(areas[k]),
            ordered(middles[k] + shifts[k], base) if bounded[k] else None,
            (wraps[base], wraps[1 - base]),
            tuple(ring for ring, _ in rings),
            tuple(vertex for ring, corners in rings for vertex in _vertices(ring, corners)),
            k in at_home,
            problem.area_unit,
        )
        found.append((component, own))
    units = ordered(np.array([cells.plane.base_unit, cells.plane.lift_unit]), base)
    rounds = [ends is None for ends in problem.ranges]
    return in_canonical_order(found, units, (rounds[0], rounds[1]))


WithCells = tuple[Component, list[int]]
"""A component, and its cells."""


def in_canonical_order(
    components: Sequence[WithCells], units: Floats, rounds: tuple[bool, bool]
) -> list[WithCells]:
    """Put components in their order, which depends neither on rounding nor on units or the base.

    Those with the home pose come first, then by falling area. Areas that may be equal are told
    apart by the centroid's value of the first joint, then of the second; values of joints that turn
    all the way round are in (-pi, pi]. A component that goes round a joint has -pi for this joint,
    and its least value for the other one. Where even these may be equal, the least values of the
    outline decide, seen from the centroid.

    Parameters
    ----------
    units : ndarray, shape (2,)
        Of both joints.
    rounds : tuple of two bool
        Whether each joint turns all the way round.

    Notes
    -----
    The error of an area is `TIED` of it and `QUADRATURE` of the units' product. The error of a
    place is `TIED` of the joint's unit, and what the error of the area makes of it. The error of a
    least value is `TOUCH` of the joint's unit.
    """

    def area(item: WithCells) -> tuple[float, float]:
        return -item[0].area, TIED * item[0].area + QUADRATURE * float(units.prod())

    def place(joint: int) -> Key[WithCells]:
        def value(item: WithCells) -> tuple[float, float]:
            x, error = _place_of(item[0], rounds)[joint], TIED
            if x is None:
                return -math.pi, 0.0
            if not any(item[0].wraps):
                error += QUADRATURE * float(units.prod()) / max(item[0].area, TINY)
            error *= float(units[joint])
            if rounds[joint]:
                x = float(nearest_turn(x, 0))
                x += TURN * (x <= error - math.pi)  # the seam counts as pi
            return x, error

        return value

    def least(joint: int) -> Key[WithCells]:
        def value(item: WithCells) -> tuple[float, float]:
            middle, along = item[0].centroid, np.eye(2)[joint]
            if middle is None:
                return 0.0, 0.0
            return _least(item[0], along) - middle[joint], TOUCH * float(units[joint])

        return value

    home: Key[WithCells] = lambda item: (float(not item[0].contains_home), 0.0)  # noqa: E731
    return ordered_by(components, [home, area, place(0), place(1), least(0), least(1)])


def _place_of(component: Component, rounds: tuple[bool, bool]) -> tuple[float | None, float | None]:
    """Return the centroid; of a component that goes round a joint its least value beside it.

    A loop that goes m times round the first joint and n times round the second one moves along
    (m, n): what counts is the least value across, of n q_1 - m q_2 or m q_2 - n q_1.
    """
    if component.centroid is not None:
        return float(component.centroid[0]), float(component.centroid[1])
    ends = [np.rint((loop[-1].end - loop[0].start) / TURN) * rounds for loop in component.loops]
    ways = [np.array([n, -m]) for m, n in ends if m or n]
    if not ways:  # there is no other component that goes round both joints
        return None, None
    way = ways[0] if (ways[0][0] or ways[0][1]) > 0 else -ways[0]
    across = _least(component, way)
    return (across, None) if way[0] else (None, across)


def _least(component: Component, way: Floats) -> float:
    """Return the least product of joint values with a vector along the outline of a component."""
    found = []
    for arc in chain(*component.loops):
        low, high, n = 0.0, 1.0, 32 * len(arc.pieces.roots) + 1
        for _ in range(5):
            s = np.linspace(low, high, n)
            values = arc.at(s) @ way
            k = int(values.argmin())
            low, high, n = s[max(k - 1, 0)], s[min(k + 1, n - 1)], 33
        found.append(float(values.min()))
    return min(found)


def _vertices(ring: tuple[Arc, ...], corners: list[bool]) -> Iterator[Vertex]:
    """Yield the vertices of a loop: the starts of those of its arcs that begin at one."""
    for before, arc, corner in zip(behind(ring), ring, corners, strict=True):
        if corner:
            yield Vertex(arc.start, (before.boundary, arc.boundary), arc.vague)


def _moments_of_parts(cells: CellComplex) -> tuple[Floats, Floats]:
    """Return area (n,) and centroid (n, 2), base before lift, of each component."""
    moments, parts = _cell_moments(cells), cells.parts
    moments[:, 1:] += moments[:, :1] * TURN * parts.windings
    starts = np.cumsum([0, *map(len, parts.cells)])[:-1]
    sums = np.add.reduceat(moments[list(chain(*parts.cells))], starts) if len(starts) else moments
    return sums[:, 0], sums[:, 1:] / np.where(sums[:, :1] > 0, sums[:, :1], 1.0)


def _cell_moments(cells: CellComplex) -> Floats:
    """Return area and first moments about base and lift of each cell, shape (k, 3).

    The integration is Gauss-Legendre in t = m + h sin(angle), in which a fold's square root is
    smooth. The number of nodes grows for cells whose moments still change. Cells that do not
    converge, for example near a saddle, are halved.
    """
    every = np.arange(len(cells.slabs))
    found = np.zeros((len(every), 3))
    of, spans = every, cells.spans(every)
    for _ in range(HALVINGS):
        moments, settled = _settled_moments(cells, of, spans)
        np.add.at(found, of[settled], moments[settled])
        of, spans = of[~settled], spans[~settled]
        if not len(of):
            return found
        middle = spans.mean(axis=1)
        first, second = spans.copy(), spans.copy()
        first[:, 1] = second[:, 0] = middle
        of, spans = np.concatenate([of, of]), np.concatenate([first, second])
    np.add.at(found, of, _moments(cells, of, spans, CELL_NODES[-1:])[0])
    return found


def _settled_moments(cells: CellComplex, of: Ints, spans: Floats) -> tuple[Floats, Bools]:
    """Return the moments of parts of cells, and which of them no longer change.

    Changes are measured in the joints' units, because a slide's values may be millions.
    """
    base, lift = cells.plane.base_unit, cells.plane.lift_unit
    least = base * lift * np.array([1.0, base, lift])
    left = np.arange(len(of))
    before, now = _moments(cells, of, spans, CELL_NODES[:2])
    result, done = now.copy(), np.zeros(len(of), dtype=np.bool_)
    for n in CELL_NODES[2:]:
        same = (np.abs(now - before) <= QUADRATURE * (least + np.abs(now))).all(axis=1)
        done[left[same]] = True
        left = left[~same]
        if not len(left):
            break
        before, (now,) = result[left], _moments(cells, of[left], spans[left], (n,))
        result[left] = now
    return result, done


def _moments(cells: CellComplex, chosen: Ints, spans: Floats, nodes: tuple[int, ...]) -> Floats:
    """Return the moments of cells between base values by rules of some nodes, (rules, k, 3)."""
    sines, weights = _smooth_rules(nodes)
    start, end = spans.T[:, :, None]
    half = (end - start) / 2
    t = (start + end) / 2 + half * sines
    low, high = cells.interval(chosen, t)
    height = high - low
    moments = np.array([height, height * t, height * (low + high) / 2])
    return np.asarray((moments @ weights).T * half)


@cache
def _smooth_rules(nodes: tuple[int, ...]) -> tuple[Floats, Floats]:
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
