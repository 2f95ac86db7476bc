r"""Forms that can bound a region; the others are proved irrelevant and take no part.

An arm of many joints has hundreds of boundaries, and in one slice only a few bound anything. Boxes
of the two joints' ranges are halved until of each is known: some form is negative all over it,
which forbids it, or every form that is left out is positive all over it. A form that is left out
is then needed nowhere: the region of the forms that are kept is the region of all. Bounds are the
amplitudes, then the value and slope at a box's middle with the bound on bending (`bending`). Not in
the paper.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.boundary.evaluator import Range
from qbound.forms.angles import TURN
from qbound.forms.bending import bending
from qbound.forms.harmonic import HarmonicForm
from qbound.region.problem import Problem
from qbound.tolerances import UNCERTAIN_SIGN

FEW: Final = 64
"""Forms up to which none is left out: they cost less than the proof."""

ACROSS: Final = 32
"""Boxes along each joint to begin with."""

HALVINGS: Final = 4
"""How often an undecided box is halved both ways; forms that are undecided then are kept."""


def without_irrelevant(problem: Problem) -> tuple[Problem, tuple[str, ...]]:
    """Leave out of many forms those that bound nothing, and say which; few forms stay as they are.

    Returns
    -------
    problem : Problem
        Of the same region.
    names : tuple of str
        Of what is left out, in its order; those of boundaries about bodies are never among them.
    """
    if len(problem.names) <= FEW:
        return problem, ()
    kept = relevant_forms(problem.forms, problem.ranges)
    dropped = np.setdiff1d(np.arange(len(problem.names)), kept).tolist()
    return problem.without(dropped), tuple(problem.names[k] for k in dropped)


def relevant_forms(forms: HarmonicForm, ranges: Sequence[Range]) -> Ints:
    r"""Return forms of two joints that are positive together just where all are (not in the paper).

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Of two joints; floats.
    ranges : sequence of two (low, high) or None
        Where it counts, ends included, rad or length; None for a joint that turns all the way
        round.

    Returns
    -------
    ndarray of int
        Rows, ascending. Each of the others is positive, by more than rounding, all over every box
        on which no kept form is negative throughout. Some of the rows may be needless: what is
        undecided is kept.

    Notes
    -----
    One that comes closer to zero than `UNCERTAIN_SIGN` of the size of its terms counts as
    undecided: bounds are rounded outward by far more than they err.

    Examples
    --------
    A wall, another behind it, and one that is never reached:

    >>> import numpy as np
    >>> from qbound import HarmonicForm
    >>> walls = np.zeros((3, 3, 3))
    >>> walls[:, 0, 0], walls[:, 1, 0] = [0.5, 0.7, 2.0], 1.0
    >>> relevant_forms(HarmonicForm(walls, ("revolute", "revolute")), [None, None]).tolist()
    [0]
    """
    ends = [_whole(kind, ends) for kind, ends in zip(forms.kinds, ranges, strict=True)]
    reach = [max(map(abs, pair)) for pair in ends]
    doubt = UNCERTAIN_SIGN * forms.size(reach)
    open_ = np.flatnonzero(_lowest(forms, reach) <= doubt)
    found = _Search(forms[open_], doubt[open_])
    found.look(*_first_boxes(ends))
    return np.asarray(open_[found.kept_with_cover()])


def _whole(kind: str, ends: Range) -> tuple[float, float]:
    """Return a range; one turn of an angle that has more."""
    if kind == "revolute" and (ends is None or ends[1] - ends[0] >= TURN):
        return -math.pi, math.pi
    if ends is None:
        raise ValueError("a sliding joint needs limits")
    return ends


def _lowest(forms: HarmonicForm, reach: Sequence[float]) -> Floats:
    """Bound forms from below by their constant and amplitudes, shape (m,)."""
    waves = forms.waves
    still = ~(waves.turns.any(axis=1) | waves.powers.any(axis=1))
    sizes = np.abs(waves.amplitudes) * np.prod(np.asarray(reach) ** waves.powers, axis=1)
    constant = waves.amplitudes.real[:, still].sum(axis=1)
    return np.asarray(constant - sizes[:, ~still].sum(axis=1))


def _first_boxes(ends: Sequence[tuple[float, float]]) -> tuple[Floats, Floats]:
    """Return the middles of a grid of boxes, shape (n, 2), and half their sides, shape (2,)."""
    lines = [np.linspace(*pair, 2 * ACROSS + 1)[1::2] for pair in ends]
    half = np.array([(high - low) / (2 * ACROSS) for low, high in ends])
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2), half


def box_bounds(forms: HarmonicForm, middles: Floats, half: Floats) -> tuple[Floats, Floats, Floats]:
    """Return lower bounds, values at the middle and upper bounds of forms on boxes, (n, m) each."""
    values = forms(middles)
    steps = half * np.array([[1.0, 1.0], [1.0, -1.0]])
    boxes = middles if forms.waves.powers.any() else middles[:1]  # angles bend alike everywhere
    corners = np.concatenate([boxes[:, None] + steps, boxes[:, None] - steps], axis=1)
    steps = np.broadcast_to(steps, (len(boxes), 2, 2))
    bend = bending(forms, corners, steps, upwards=True).max(axis=1) / 2
    change = np.abs(forms.gradient(middles)) @ half + bend
    return values - change, values, values + change


@dataclass(eq=False)
class _Search:
    """What is known of some forms while boxes are looked at.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
    doubt : ndarray, shape (m,)
        A value this near to zero has no sign.
    """

    forms: HarmonicForm
    doubt: Floats

    def __post_init__(self) -> None:
        """Begin with nothing kept and nothing forbidden."""
        self.kept: Bools = np.zeros(len(self.doubt), dtype=np.bool_)
        self.forbidden: list[Bools] = []

    def look(
        self, middles: Floats, half: Floats, columns: Ints | None = None, depth: int = 0
    ) -> None:
        """Settle boxes of one size, and the quarters of those that are undecided."""
        columns = np.arange(len(self.doubt)) if columns is None else columns
        if not len(middles) or not len(columns):
            return
        low, value, high = box_bounds(self.forms[columns], middles, half)
        doubt = self.doubt[columns]
        negative = high < -doubt
        closed = negative.any(axis=1)
        self._forbid(negative[closed], columns)
        # A form that alone is negative somewhere bounds the region: no proof will drop it.
        alone = value[(value <= doubt).sum(axis=1) == 1] <= doubt
        self.kept[columns[alone.any(axis=0)]] = True
        vague = low[~closed] <= doubt
        left = (vague & ~self.kept[columns]).any(axis=1)
        if depth == HALVINGS:
            self.kept[columns[vague.any(axis=0)]] = True
            return
        quarters = np.array(list(product((-0.5, 0.5), repeat=2))) * half
        inner = (middles[~closed][left][:, None] + quarters).reshape(-1, 2)
        self.look(inner, half / 2, columns[vague[left].any(axis=0)], depth + 1)

    def _forbid(self, negative: Bools, columns: Ints) -> None:
        rows = np.zeros((len(negative), len(self.doubt)), dtype=np.bool_)
        rows[:, columns] = negative
        self.forbidden.append(rows)

    def kept_with_cover(self) -> Bools:
        """Return what is kept, with a form that forbids each box that is to stay forbidden."""
        kept = self.kept.copy()
        rows = _rows(self.forbidden, len(kept))
        while len(rows := rows[~(rows & kept).any(axis=1)]):
            kept[rows.sum(axis=0).argmax()] = True
        return kept


def _rows(stacks: Iterable[Bools], width: int) -> Bools:
    return np.concatenate([np.zeros((0, width), dtype=np.bool_), *stacks])
