r"""The search for a proof over one box, in any number of joints (not in the paper).

As over simplices, :math:`\beta(m) + \nabla\beta(m) \cdot d - \tfrac12 d^T M d` is a bound from
below that is concave in the step d: it is least at a corner of the box. M is the same for all boxes
of a form, so that a cell costs one value, one gradient and its corners. A cell is halved along the
joint whose halving takes most from the largest :math:`d^T M d`: plain longest edges need up to a
thousand times as many cells, and the checkers look at every leaf (docs/decisions/0420).
"""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from qbound.forms.bending import with_slides
from qbound.forms.harmonic import HarmonicForm
from qbound.proofs.forest import Forest, Search, Tell, silent
from qbound.tolerances import NEGLIGIBLE

Floats = NDArray[np.float64]

DEEPEST = 60
"""Cuts on top of each other before a search gives up; the checkers follow 120."""

BATCH = 4096
"""Cells that are bounded at a time: each has up to 32 pairs of corners."""


def search_box(
    form: HarmonicForm, low: Floats, high: Floats, most: int, tell: Tell = silent
) -> Search:
    """Halve a box until the bound is positive on each part.

    Parameters
    ----------
    low, high : ndarray, shape (n,)
        Corners, rad or length.
    most : int
        Cells that are opened before the answer is left open.
    """
    bound = BoxBound(form, high > low)
    forest, leaves, opened = Forest(1), 0, 0
    centres, halves = (low + high)[None] / 2, (high - low)[None] / 2
    numbers, parts = np.arange(1), np.ones(1)
    for _ in range(DEEPEST):
        least, corners = bound.least(centres, halves)
        violation = bound.violation(np.concatenate([centres, np.clip(corners, low, high)]))
        if violation is not None:
            return Search((), leaves, len(centres), float(parts.sum()), (0, violation))
        proved = least > bound.slack
        forest.close(numbers[proved])
        leaves, opened = leaves + int(proved.sum()), opened + len(centres)
        centres, halves, numbers, parts = (x[~proved] for x in (centres, halves, numbers, parts))
        tell(1 - float(parts.sum()))
        if not len(centres) or opened > most:
            break
        joints = bound.worst_joints(centres, halves)
        numbers, parts = forest.cut(numbers, joints), np.repeat(parts / 2, 2)
        centres, halves = halved(centres, halves, joints)
    return Search(forest.trees(), leaves, len(centres), float(parts.sum()))


def halved(centres: Floats, halves: Floats, joints: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Cut each box at the middle of one joint: the lower part, then the upper one."""
    rows = np.arange(len(centres))
    halves = halves.copy()
    halves[rows, joints] /= 2
    centres, halves = np.repeat(centres, 2, axis=0), np.repeat(halves, 2, axis=0)
    step = halves[2 * rows, joints]
    centres[2 * rows, joints] -= step
    centres[2 * rows + 1, joints] += step
    return centres, halves


class BoxBound:
    """The concave bound of one form over boxes.

    Parameters
    ----------
    free : ndarray of bool, shape (n,)
        Joints that are not held.
    """

    def __init__(self, form: HarmonicForm, free: NDArray[np.bool_]) -> None:
        waves = form.waves
        size, sliding = np.abs(waves.amplitudes), waves.powers.any(axis=1)
        turns = waves.turns[~sliding]
        self.form, self.sliding = form, sliding
        self.size = float(size.sum())
        self.slack = NEGLIGIBLE * size.sum()
        self.matrix = np.einsum("k,ki,kj->ij", size[~sliding], turns, turns)
        self.largest = np.einsum("k,ki,kj->ij", size[~sliding], abs(turns), abs(turns))
        lone = (waves.powers == 2).any(axis=1) & (waves.powers.sum(axis=1) == 2)
        upwards = lone & ~waves.turns.any(axis=1) & (waves.amplitudes.real > 0)
        self.sizes = np.where(upwards, 0, size)[sliding]
        self.spread = size[sliding]  # a tangent is far below a square that bends upwards, too
        used = np.isin(np.arange(len(free)), form.joints()) & free
        self.signs = np.array(list(product(*((-1, 1) if x else (0,) for x in used))), dtype=float)
        self.signs = self.signs[: (len(self.signs) + 1) // 2]  # opposite corners bend alike

    def least(self, centres: Floats, halves: Floats) -> tuple[Floats, Floats]:
        """Return the bound's least value on each box, and the corner where it is taken."""
        batches = [slice(k, k + BATCH) for k in range(0, len(centres), BATCH)]
        found = [self._least(centres[b], halves[b]) for b in batches]
        least, corners = zip(*found, strict=True)
        return np.concatenate(least), np.concatenate(corners)

    def _least(self, centres: Floats, halves: Floats) -> tuple[Floats, Floats]:
        steps = halves[:, None] * self.signs
        slope = np.einsum("nsj,nj->ns", steps, self.form.gradient(centres))
        bend = ((steps @ self.matrix) * steps).sum(axis=2)
        rise = -np.abs(slope) - bend / 2
        rows, worst = np.arange(len(centres)), rise.argmin(axis=1)
        step = steps[rows, worst] * -np.sign(slope[rows, worst])[:, None]
        least = (
            self.form(centres) + rise[rows, worst] - self._slides(centres, halves, self.sizes) / 2
        )
        return least, centres + step

    def violation(self, places: Floats) -> Floats | None:
        """Return the configuration where the form is lowest, if it is negative there."""
        values = self.form(places)
        worst = int(values.argmin())
        return places[worst] if values[worst] < -self.slack else None

    def worst_joints(self, centres: Floats, halves: Floats) -> NDArray[np.intp]:
        """Return the joint of each box to cut: that which leaves the least bending behind."""
        totals = []
        for j in range(halves.shape[1]):
            cut = halves.copy()
            cut[:, j] /= 2
            totals.append(np.where(halves[:, j] > 0, self._bending(centres, cut), np.inf))
        total = np.stack(totals, axis=1)
        flat = np.isclose(total.min(axis=1), self._bending(centres, halves), rtol=1e-9, atol=0)
        return np.asarray(np.where(flat, halves.argmax(axis=1), total.argmin(axis=1)))

    def losses(self, centres: Floats, halves: Floats) -> Floats:
        """Return what each joint takes off the bound, by slope and by bending, shape (N, n)."""
        bend = halves * (halves @ self.largest) / 2
        return np.asarray(np.abs(self.form.gradient(centres)) * halves + bend)

    def _bending(self, centres: Floats, halves: Floats) -> Floats:
        bend = ((halves @ self.largest) * halves).sum(axis=1)
        return np.asarray(bend + self._slides(centres, halves, self.spread))

    def _slides(self, centres: Floats, halves: Floats, sizes: Floats) -> Floats:
        """Bound the second derivative of the waves with slides, on each box as a whole."""
        if not self.sliding.any():
            return np.zeros(len(centres))
        waves = self.form.waves
        u = (halves @ np.abs(waves.turns).T)[:, None]
        bend = with_slides(waves, np.abs(centres) + halves, u, halves[:, None])[:, 0]
        return np.asarray(bend[:, self.sliding] @ sizes)
