"""Proofs of contact everywhere or nowhere, over cells that fill the ranges of the joints.

Bounds of forms over cells come from `qbound.proofs.exact.bounds` and include rounding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from qbound.arms.pair_forms import PairForms
from qbound.arrays import Bools, Floats
from qbound.forms.harmonic import HarmonicForm
from qbound.proofs import Verdict
from qbound.proofs.exact.bounds import BITS, DEEPEST, BoxBounds, Cells
from qbound.proofs.exact.numbers import ball, precision

BATCH: Final = 8192
"""Cells that are bounded at a time."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What a search for a proof over all cells ended with.

    Attributes
    ----------
    verdict : Verdict
    cells : int
        That were bounded.
    place : ndarray or None, shape (n,)
        Of refuted: a configuration that refutes, by its value in floats.
    """

    verdict: Verdict
    cells: int
    place: Floats | None = None


Sort = Callable[[Floats, Floats], tuple[Bools, Bools]]
"""From bounds below and above, (k, m) each, to the cells that prove and to those that refute."""


def apart_everywhere(pair: PairForms, gap: float, most: int) -> Answer:
    """Prove that all balls keep a gap over the whole ranges, each two by cells of their own.

    Parameters
    ----------
    gap : float
        Length, 0 or more.
    most : int
        Cells that are bounded at most.
    """
    total = 0
    for k in np.argsort(pair.gaps(_middle(pair)[None])[0]):
        one = pair.single(int(k))
        answer = _searched(_lowered(one, gap), _positive, most - total)
        total += answer.cells
        if answer.verdict is not Verdict.PROVED:
            place = answer.place
            return replace(answer, cells=total, place=_filled(pair, one, place))
    return Answer(Verdict.PROVED, total)


def touching_everywhere(pair: PairForms, most: int) -> Answer:
    """Prove that on each cell of the ranges two of the balls overlap, on another other ones."""
    return _searched(pair, _some_negative, most)


def _positive(low: Floats, high: Floats) -> tuple[Bools, Bools]:
    return np.asarray((low > 0).all(axis=1)), np.asarray((low + high < 0).any(axis=1))


def _some_negative(low: Floats, high: Floats) -> tuple[Bools, Bools]:
    return np.asarray((high < 0).any(axis=1)), np.asarray((low + high > 0).all(axis=1))


def _searched(pair: PairForms, sort: Sort, most: int) -> Answer:
    """Halve cells until each proves, or the centre of one refutes."""
    if not pair.joints:
        return _of_constants(pair, sort)
    bounds = BoxBounds(pair.forms, pair.ends)
    cells, opened = bounds.whole(), 0
    while len(cells):
        if opened + len(cells) > most or cells.level >= DEEPEST * len(pair.joints):
            return Answer(Verdict.UNDECIDED, opened)
        opened += len(cells)
        left = []
        for part in (cells[k : k + BATCH] for k in range(0, len(cells), BATCH)):
            proved, refuted = sort(*bounds.bounds(part))
            if refuted.any():
                low, high = bounds.places(part[refuted][:1])
                return Answer(Verdict.REFUTED, opened, (low[0] + high[0]) / 2)
            left.append(part.index[~proved])
        cells = Cells(cells.level, np.concatenate(left)).halves()
    return Answer(Verdict.PROVED, opened)


def _of_constants(pair: PairForms, sort: Sort) -> Answer:
    """Decide forms that no joint changes."""
    values = pair.exact(np.empty(0))
    signs = np.array([[float(value > 0) - float(value < 0) for value in values]])
    proved, refuted = sort(signs, signs)
    return Answer(Verdict.of(bool(proved[0]), bool(refuted[0])), 1, np.empty(0))


def _lowered(pair: PairForms, gap: float) -> PairForms:
    """Return the forms less what they are at a gap: positive where the balls keep it."""
    with precision(BITS):
        asked = [(ball(d) + ball(gap)) ** 2 - ball(d) ** 2 for d in pair.distances.tolist()]
        forms = pair.forms - np.array(asked, dtype=object)
    return replace(pair, forms=HarmonicForm(forms.coefficients, pair.forms.kinds))


def _middle(pair: PairForms) -> Floats:
    low, high = pair.box
    return np.asarray((low + high) / 2)


def _filled(pair: PairForms, one: PairForms, place: Floats | None) -> Floats | None:
    """Return a configuration of fewer joints as one of all that matter to the pair."""
    if place is None:
        return None
    q = _middle(pair)
    q[[pair.joints.index(j) for j in one.joints]] = place
    return q
