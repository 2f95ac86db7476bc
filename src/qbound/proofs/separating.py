"""The search for a proof that two bodies keep apart: one feature a leaf, another on the next.

At the centre of a cell the features are ranked by how far they hold there; the best few are bounded
over the cell. A cell on which none is positive is cut where the best one bends most. Floats, and
untrusted, as all of the search.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.forms.bending import second_order, worst_edges
from qbound.geometry import simplices
from qbound.proofs import boxes
from qbound.proofs.features import Features
from qbound.proofs.forest import Forest, Search, Tell, silent
from qbound.tolerances import NEGLIGIBLE

Floats = NDArray[np.float64]

TRIED = 3
"""Features that are bounded on a cell."""

DEEPEST = 60
"""Cuts on top of each other before a search gives up; the checkers follow 120."""


@dataclass(frozen=True, eq=False)
class Simplices:
    """Simplices by their corners, shape (N, k, n), rad or length."""

    corners: Floats

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.corners)

    def __getitem__(self, chosen: Any) -> Simplices:
        """Take some of them."""
        return Simplices(self.corners[chosen])

    @cached_property
    def centres(self) -> Floats:
        """Their centres, shape (N, n)."""
        return np.asarray(self.corners.mean(axis=1))

    def bounds(self, features: Features, number: int) -> Floats:
        """Bound the forms of a feature from below, shape (N, forms)."""
        return second_order(features.forms[features.groups[number]], self.corners)

    def cuts(self, features: Features, form: int) -> NDArray[Any]:
        """Return the edges to cut for the sake of a form."""
        return worst_edges(features.forms[form], self.corners)

    def halves(self, cuts: NDArray[Any]) -> Simplices:
        """Cut each."""
        return Simplices(simplices.halved(self.corners, cuts))


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes by their centres and half widths, shape (N, n), rad or length."""

    centres: Floats
    halfwidths: Floats
    free: NDArray[np.bool_]

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.centres)

    def __getitem__(self, chosen: Any) -> Boxes:
        """Take some of them."""
        return Boxes(self.centres[chosen], self.halfwidths[chosen], self.free)

    def bounds(self, features: Features, number: int) -> Floats:
        """Bound the forms of a feature from below, shape (N, forms)."""
        found = [self._bound(features, form) for form in features.groups[number]]
        least = [bound.least(self.centres, self.halfwidths)[0] for bound in found]
        return np.stack(least, axis=-1)

    def cuts(self, features: Features, form: int) -> NDArray[Any]:
        """Return the joints to cut for the sake of a form."""
        return self._bound(features, form).worst_joints(self.centres, self.halfwidths)

    def _bound(self, features: Features, form: int) -> boxes.BoxBound:
        return boxes.BoxBound(features.forms[int(form)], self.free)

    def halves(self, cuts: NDArray[Any]) -> Boxes:
        """Cut each."""
        return Boxes(*boxes.halved(self.centres, self.halfwidths, cuts), self.free)


Cells = Simplices | Boxes


def box_cell(low: Floats, high: Floats) -> Boxes:
    """Return the one cell of a box."""
    return Boxes((low + high)[None] / 2, (high - low)[None] / 2, high > low)


def search_features(features: Features, cells: Cells, most: int, tell: Tell = silent) -> Search:
    """Cut cells until on each a feature holds.

    Parameters
    ----------
    most : int
        Cells that are opened before the answer is left open.
    """
    rounding = NEGLIGIBLE * _length_of(features)
    forest = Forest(len(cells))
    numbers, roots, parts = np.arange(len(cells)), np.arange(len(cells)), np.ones(len(cells))
    leaves, opened = 0, 0
    for _ in range(DEEPEST):
        margins = features.margins(cells.centres)
        if len(cells) and margins.min() < -rounding:
            worst, left = int(margins.argmin()), float(parts.sum() / forest.size)
            return Search((), leaves, len(cells), left, (int(roots[worst]), cells.centres[worst]))
        feature, worst_form = _bounded(features, cells)
        proved = feature >= 0
        forest.close(numbers[proved], [_leaf(features, k) for k in feature[proved]])
        leaves, opened = leaves + int(proved.sum()), opened + len(cells)
        cells, left_forms = cells[~proved], worst_form[~proved]
        numbers, roots, parts = numbers[~proved], roots[~proved], parts[~proved]
        tell(1 - float(parts.sum()) / forest.size)
        if not len(cells) or opened > most:
            break
        cuts = np.zeros(len(cells), dtype=np.intp)
        for form in np.unique(left_forms):
            own = left_forms == form
            cuts[own] = cells[own].cuts(features, int(form))
        cells, numbers = cells.halves(cuts), forest.cut(numbers, cuts)
        roots, parts = np.repeat(roots, 2), np.repeat(parts / 2, 2)
    return Search(forest.trees(), leaves, len(cells), float(parts.sum() / max(forest.size, 1)))


def _length_of(features: Features) -> float:
    """Return a length beside which rounding is a small part."""
    is_square = ~np.isnan(features.squared)
    return float(np.where(is_square, np.sqrt(features.sizes), features.sizes).max())


def _leaf(features: Features, number: int) -> str:
    return f"{number}." if features.numbered else "."


def _bounded(features: Features, cells: Cells) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return for each cell a feature that holds all over it, or -1, and the form to cut it for."""
    ranks = np.argsort(-features.lengths(cells.centres), axis=1)[:, :TRIED]
    found, worst_form = np.full(len(cells), -1), np.zeros(len(cells), dtype=np.intp)
    for rank in range(ranks.shape[1]):
        for number in np.unique(ranks[found < 0, rank]):
            own = np.flatnonzero((found < 0) & (ranks[:, rank] == number))
            group = features.groups[number]
            spare = cells[own].bounds(features, int(number)) - NEGLIGIBLE * features.sizes[group]
            found[own[(spare > 0).all(axis=1)]] = number
            if rank == 0:
                worst_form[own] = group[spare.argmin(axis=1)]
    return found, worst_form


def together(searches: list[Search]) -> Search:
    """Return the searches for all pairs of parts of two bodies as one."""
    violations = [found.violation for found in searches if found.violation is not None]
    first = searches[0]
    return replace(
        first,
        trees=tuple(tree for found in searches for tree in found.trees),
        leaves=sum(found.leaves for found in searches),
        left=sum(found.left for found in searches),
        part_left=max(found.part_left for found in searches),
        violation=violations[0] if violations else None,
    )
