"""From loops round components to labelled arcs, in the order of the joints.

A loop's steps are laid one behind the other, those on one branch of one boundary are merged to an
arc, and the corners where two forms meet are brought onto both.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, whole_turns
from qbound.forms.harmonic import basis, basis_slope
from qbound.region.arcs import Arc, Pieces
from qbound.region.cells import CellComplex, Step
from qbound.region.plane import Plane, Root
from qbound.tolerances import TRANSVERSAL

Floats = NDArray[np.float64]
Item = TypeVar("Item")
Label = tuple[str, int | None, int]
"""Boundary, branch, and which form; -1 of an end of a range."""

BaseLift = tuple[float, float]
Windings = Mapping[int, tuple[int, int]]


@dataclass(frozen=True)
class BoundaryLoop:
    """A closed loop round a component, and where the component's cells lie.

    Attributes
    ----------
    steps : list of Step
    windings : mapping of cell to (base turns, lift turns)
    shift : ndarray, shape (2,)
        Added to base and lift values of all cells, rad.
    """

    steps: list[Step]
    windings: Windings
    shift: Floats


@dataclass(frozen=True, eq=False)
class _Ring:
    """A loop laid out: its pieces, and which of them make an arc of which label."""

    pieces: Pieces
    spans: list[slice]
    labels: list[Label]


class Layout:
    """Lays out the loops of one decomposition.

    Parameters
    ----------
    cells : CellComplex
    base : int
        Which joint is the base.
    names : sequence of str
        One a form.
    limits : sequence of two (str, str)
        Names of the ends of each joint's range.
    """

    def __init__(
        self, cells: CellComplex, base: int, names: Sequence[str], limits: Sequence[tuple[str, str]]
    ) -> None:
        self.cells, self.plane, self.base = cells, cells.plane, base
        contacts = cells.plane.contacts
        self.names = [*names, *(contacts.boundaries[k] for k in contacts.pair.tolist())]
        self.features = [*[""] * len(names), *contacts.names]
        self.limits = limits

    def arcs(self, loops: Sequence[BoundaryLoop]) -> list[tuple[Arc, ...]]:
        """Return the arcs of each loop, the component on their left."""
        rings = [self._laid(loop) for loop in loops]
        self._polish(rings)
        return [
            tuple(
                Arc(name, branch, ring.pieces[span], self.features[form] if form >= 0 else "", form)
                for (name, branch, form), span in zip(ring.labels, ring.spans, strict=True)
            )
            for ring in rings
        ]

    def _laid(self, loop: BoundaryLoop) -> _Ring:
        steps = loop.steps
        labels = [self._label(step) for step in steps]
        first = next((i for i in range(len(steps)) if labels[i] != labels[i - 1]), 0)
        steps, labels = steps[first:] + steps[:first], labels[first:] + labels[:first]
        if self.base == 1:  # seen with the joints in their order, the loop runs backwards
            steps, labels = steps[::-1], labels[::-1]
        groups = [list(group) for _, group in groupby(range(len(steps)), key=labels.__getitem__)]
        spans = [slice(group[0], group[-1] + 1) for group in groups]
        return _Ring(self._pieces(steps, loop), spans, [labels[span.start] for span in spans])

    # --- labels ---------------------------------------------------------------------------------

    def _label(self, step: Step) -> Label:
        if step.kind in ("up", "down"):
            return self._line_label(step)
        cell = self.cells.cells[step.cell]
        root = cell.lower if step.kind == "lower" else cell.upper
        if root.form < 0:
            return self.limits[1 - self.base][-1 - root.form], None, -1
        branch = root.branch if self.plane.lift_kind == "revolute" else None
        return self.names[root.form], branch, root.form

    def _line_label(self, step: Step) -> Label:
        """Name a piece of a critical line: a limit of the base, or a form without the lift."""
        plane, t = self.plane, self.cells.abscissae[step.line]
        side = 0 if step.kind == "down" else 1
        if plane.base_range is not None and t == plane.ends[side]:
            return self.limits[self.base][side], None, -1
        low, high = self.cells.bounds(self.cells.lines[step.line], step.element)
        form = plane.vanishing(float(t), (low + high) / 2)
        # A form falls along the base at theta + arccos; there the component lies before it.
        branch = (1 if step.kind == "up" else -1) if plane.base_kind == "revolute" else None
        return self.names[form], branch, form

    # --- places ---------------------------------------------------------------------------------

    def _pieces(self, steps: Sequence[Step], loop: BoundaryLoop) -> Pieces:
        """Lay the steps one behind the other; a loop round a joint changes windings."""
        circles = self.plane.base_range is None, self.plane.lift_range is None
        shift = loop.shift.tolist()
        roots: list[Root | None] = []
        rows: list[tuple[BaseLift, BaseLift, BaseLift]] = []
        for step in steps:
            root, start, end = self._step(step)
            start, end = (start, end) if self.base == 0 else (end, start)
            winding = loop.windings[step.cell]
            turns = [TURN * winding[j] + shift[j] for j in (0, 1)]
            for j in (0, 1) if rows else ():
                turns[j] += TURN * circles[j] * round((rows[-1][1][j] - start[j] - turns[j]) / TURN)
            places = [(x[0] + turns[0], x[1] + turns[1]) for x in (start, end)]
            roots.append(root)
            rows.append((places[0], places[1], (turns[0], turns[1])))
        starts, ends, offsets = np.moveaxis(np.array(rows), 1, 0)
        # At a fold both sides stop a rounding's square root short of each other.
        gaps = np.roll(ends, 1, axis=0) - starts
        gaps -= TURN * whole_turns(gaps) * circles
        ends = ends - np.roll(gaps, -1, axis=0) / 2
        return Pieces(self.plane, self.base, roots, starts + gaps / 2, ends, offsets)

    def _step(self, step: Step) -> tuple[Root | None, BaseLift, BaseLift]:
        """Return what a step follows and where it starts and ends, in the cell's coordinates."""
        cell, ends = self.cells.cells[step.cell], self.cells.ends[step.cell]
        left, right = map(float, self.cells.abscissae[cell.slab : cell.slab + 2])
        if step.kind == "lower":
            return cell.lower, (left, ends[0][0]), (right, ends[1][0])
        if step.kind == "upper":
            return cell.upper, (right, ends[1][1]), (left, ends[0][1])
        side = 1 if step.kind == "up" else 0
        low, high = self.cells.bounds(self.cells.lines[step.line], step.element)
        turns = TURN * (self.cells.turns_into(step.cell, side, (low + high) / 2) or 0)
        if side:
            return None, (right, low + turns), (right, high + turns)
        return None, (left, high + turns), (left, low + turns)

    def _polish(self, rings: Sequence[_Ring]) -> None:
        """Bring the corners where two forms meet onto both, all at once."""
        corners = [
            (ring.pieces, before.stop - 1, span.start, a, b)
            for ring in rings
            for (*_, a), (*_, b), before, span in zip(
                behind(ring.labels), ring.labels, behind(ring.spans), ring.spans, strict=True
            )
            if a != b and a >= 0 and b >= 0
        ]
        if not corners:
            return
        rough = np.array([pieces.start[start] for pieces, _, start, _, _ in corners])
        meeting = np.array([(a, b) for *_, a, b in corners])
        for (pieces, end, start, _, _), q in zip(
            corners, _newton(self.plane, meeting, rough), strict=True
        ):
            pieces.end[end] += q - pieces.start[start]  # which may be some turns away
            pieces.start[start] = q


def behind(ring: Sequence[Item]) -> list[Item]:
    """Return for each entry of a ring the one before it."""
    return [ring[-1], *ring[:-1]]


def _newton(plane: Plane, pairs: NDArray[np.int64], q: Floats) -> Floats:
    """Two steps of Newton on pairs of forms, (k, 2), from base and lift values near, (k, 2)."""
    table = plane.table[pairs]
    for _ in range(2):
        t, v = q.T[:, :, None, None]
        base, steep = basis(plane.base_kind, t), basis_slope(plane.base_kind, t)
        lift, slope = basis(plane.lift_kind, v), basis_slope(plane.lift_kind, v)
        over, along_base = base @ table, ((steep @ table) * lift).sum(axis=(2, 3))
        value, along_lift = (over * lift).sum(axis=(2, 3)), (over * slope).sum(axis=(2, 3))
        slopes = np.stack([along_base, along_lift], axis=-1)
        # At a tangency or a double root the least step towards both is all that is known.
        q = q - (np.linalg.pinv(slopes, rcond=TRANSVERSAL) @ value[..., None])[..., 0]
    return np.asarray(q)
