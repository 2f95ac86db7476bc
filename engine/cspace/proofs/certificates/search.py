"""The search for a proof that all distances are kept on a whole set: a direction for each leaf.

Leaves share a direction that proves all of them. A direction has the fewest digits that still prove
its leaf. The search uses doubles and is not trusted.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats, Ints
from cspace.proofs.certificates.inequality import BoundedArm, Kind, Seen
from cspace.proofs.subdivide import Cells, Judged, Progress, Search, best_cuts, silent, subdivide

FIRST_LOOK = 1000
"""Cells opened for one thing once another is violated: enough to see what else is."""

DIGITS = (1, 2, 3, 4, 6, 9)
"""Of the integers of a direction, in turn."""

NARROW = 0.1
"""Part of the longest motion along an edge below which an edge is not cut: cells stay compact."""

VIOLATED = 100
"""Spares by which a thing has to be violated to stop the search."""

ROWS = 200_000
"""Trees that grow together."""

BLOCK = 2**20
"""Numbers in the largest array of a batch."""


def search(
    arm: BoundedArm, cells: Cells, most: int, progress: Progress = silent
) -> tuple[dict[int, Search], list[list[int]]]:
    """Search a tree for each thing that needs a proof, on each cell.

    Returns
    -------
    searches : dict of int to Search
        The search of each thing, by the number of the thing.
    directions : list of [int, int, int]
    """
    things = [k for k, needed in enumerate(arm.needed) if needed]
    judge, found = _Judge(arm), dict[int, Search]()
    together = max(1, ROWS // max(len(cells), 1))
    for first in range(0, len(things), together):
        part = things[first : first + together]

        def told(done: float, first: int = first, count: int = len(part)) -> None:
            progress((first + count * done) / len(things))

        found |= subdivide(cells, part, judge, most, FIRST_LOOK, told)
    return found, judge.directions.rows


class Directions:
    """The list of directions of a proof."""

    def __init__(self) -> None:
        self.rows = list[list[int]]()
        self.numbers = dict[tuple[int, ...], int]()
        self.units = np.zeros((0, 3))

    def named(self, seen: Seen, cells: Cells, u: Floats, spare: float) -> list[str]:
        """Return a leaf for each row that a direction near u proves; empty for other rows."""
        found = np.full(len(u), -1)
        usable = np.arange(len(self.units))
        if seen.along is not None:
            usable = np.flatnonzero(self.units[:, seen.along] == 0)
        if len(usable):
            nearest = usable[(u @ self.units[usable].T).argmax(axis=1)]
            proved = seen.kept(self.units[nearest], cells) > spare
            found[proved] = nearest[proved]
        size = np.abs(u).max(axis=1, keepdims=True)
        for digits in DIGITS:
            left = np.flatnonzero(found < 0)
            whole = np.rint(u[left] / size[left] * (10**digits - 1))
            rounded = whole / np.linalg.norm(whole, axis=1, keepdims=True)
            proved = seen[left].kept(rounded, cells[left]) > spare
            if proved.any():
                rows, back = np.unique(whole[proved].astype(int), axis=0, return_inverse=True)
                numbers = np.array([self._number(row) for row in rows.tolist()])
                found[left[proved]] = numbers[back.ravel()]
        return [f"{k}." if k >= 0 else "" for k in found.tolist()]

    def _number(self, row: list[int]) -> int:
        number = self.numbers.setdefault(tuple(row), len(self.rows))
        if number == len(self.rows):
            self.rows.append(row)
            self.units = np.vstack([self.units, np.array(row) / np.linalg.norm(row)])
        return number


class _Judge:
    """Judges cells: closed if a direction proves a thing, else cut where that helps most."""

    def __init__(self, arm: BoundedArm) -> None:
        self.arm, self.directions = arm, Directions()

    def __call__(self, cells: Cells, things: Ints) -> Judged:
        count = len(things)
        leaves = np.full(count, "", dtype=object)
        cuts, margins = np.full(count, -1), np.zeros(count)
        places = cells.centres.copy()
        for kind, positions, rows in self.arm.by_kind(things):
            step = batch(kind, cells.centres.shape[1])
            for k in range(0, len(positions), step):
                at, own = positions[k : k + step], rows[k : k + step]
                found = self._judged(kind, own, cells[at])
                leaves[at], cuts[at], margins[at] = found.leaves, found.cuts, found.margins
                places[at] = found.places
        return Judged(leaves.tolist(), cuts, margins, places)

    def _judged(self, kind: Kind, rows: Ints, cells: Cells) -> Judged:
        seen, spare = self.arm.seen(kind, rows, cells), self.arm.spare
        u, value = seen.refined(cells)
        leaves = np.full(len(rows), "", dtype=object)
        closed = np.flatnonzero(value > spare)
        if kind.normals is not None:
            leaves[closed] = "."
        elif len(closed):
            own = seen[closed], cells[closed], u[closed]
            leaves[closed] = self.directions.named(*own, spare)
        left = np.flatnonzero(leaves == "")
        cuts, margins = np.full(len(rows), -1), np.zeros(len(rows))
        places = cells.centres.copy()
        if len(left):
            own_cells, part = cells[left], seen[left]
            cuts[left] = self._cuts(kind, rows[left], own_cells, part)
            # the margins at the middle, or at the apparently lowest corner, where below 0
            middle = part.margins(part.directions())
            corners = own_cells.centres + part.support(u[left], own_cells)[1]
            at_corner = margins_at(self.arm, kind, rows[left], corners)
            least = np.minimum(at_corner, middle)
            margins[left] = np.where(least < -VIOLATED * spare, least, 0)
            places[left] = np.where((at_corner < middle)[:, None], corners, own_cells.centres)
        return Judged(leaves.tolist(), cuts, margins, places)

    def _cuts(self, kind: Kind, rows: Ints, cells: Cells, seen: Seen) -> NDArray[Any]:
        """Choose a cut of each cell, but never an edge along which little or nothing moves."""
        moved = np.einsum("ten,tncx->tecx", cells.edges, seen.slopes)
        moved = np.linalg.norm(moved, axis=3).max(axis=2)
        wide = (moved > 0) & (moved >= NARROW * moved.max(axis=1, keepdims=True))

        def worth(tried: Ints, halves: Cells) -> Floats:
            return self.arm.seen(kind, np.repeat(rows[tried], 2), halves).refined(halves)[1]

        return best_cuts(cells, wide, worth, self.arm.spare, self.arm.size)


def batch(kind: Kind, joints: int) -> int:
    """Return how many cells are judged at a time."""
    m, c = kind.places.shape[1], kind.corners.shape[1]
    numbers = (m * c + 2 * (m + c)) * (m + c + 3) + 10 * c * joints
    return max(1, int(BLOCK // numbers))


def margins_at(arm: BoundedArm, kind: Kind, rows: Ints, q: Floats) -> Floats:
    """Return the margins of things at configurations, shape (T, n); below 0 if violated."""
    found = np.zeros(len(q))
    step = batch(kind, q.shape[1])
    for k in range(0, len(q), step):
        seen = arm.still(kind, rows[k : k + step], q[k : k + step])
        found[k : k + step] = seen.margins(seen.directions())
    return found


def margins(arm: BoundedArm, things: Sequence[int], q: Floats) -> Floats:
    """Return the margins of things at configurations, shape (N, things)."""
    found = np.zeros((len(q), len(things)))
    for kind, positions, rows in arm.by_kind(np.asarray(things)):
        every = np.tile(rows, len(q))
        values = margins_at(arm, kind, every, np.repeat(q, len(rows), axis=0))
        found[:, positions] = values.reshape(len(q), len(rows))
    return found
