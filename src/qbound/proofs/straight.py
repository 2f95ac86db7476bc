"""Is the straight line between two configurations feasible? Proved over the cells that it meets.

Of a paving only the cells along the line are halved on: those that it certainly does not meet are
dropped. So a line costs some hundred cells where the whole range costs thousands.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from qbound.proofs.dyadic import Cells
from qbound.proofs.paving import Paving

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

MOST_ALONG = 2_000
"""Undecided cells along the line at which it is given up."""

MOST_HALVINGS = 14
"""Halvings of each joint at which it is given up."""

NEARLY = 1e-9
"""Part of a range by which cells count as wider than they are: doubles err by 1e-15 of it."""


def along_straight_line(paving: Paving, one: Floats, other: Floats) -> Paving | None:
    """Prove that a straight line lies in feasible cells.

    Parameters
    ----------
    paving : Paving
        Where it begins; of one cell, as a rule.
    one, other : ndarray, shape (n,)
        Ends, rad or length. A joint that turns all the way round goes from one to the other as
        they say, and not a shorter way.

    Returns
    -------
    Paving or None
        Cells of which the feasible ones hold the line; none is undecided, and cells away from the
        line are missing. None where that is not proved.
    """
    n = len(one)
    while len(paving.undecided):
        if len(paving.undecided) > MOST_ALONG or paving.level >= MOST_HALVINGS * n:
            return None
        paving = paving.refined()
        if any(_met(paving, cells, one, other).any() for cells in paving.infeasible):
            return None
        paving = _kept(paving, _met(paving, paving.undecided, one, other))
    return None if any(_met(paving, c, one, other).any() for c in paving.infeasible) else paving


def _met(paving: Paving, cells: Cells, one: Floats, other: Floats) -> Bools:
    """Tell which closed cells a line may meet; all that it meets are among them."""
    low, high = paving.bounds.places(cells)
    ends = np.array([[float(end) for end in pair] for pair in paving.bounds.ends])
    size = ends[:, 1] - ends[:, 0]
    low, high = low - NEARLY * size, high + NEARLY * size
    met = np.zeros(len(cells), dtype=bool)
    for turns in product(*map(_turns, paving.problem.ranges, ends, zip(one, other, strict=True))):
        shift = np.array(turns) * size
        met |= _crosses(low + shift, high + shift, one, other - one)
    return met


def _turns(limits: object, ends: Floats, values: tuple[float, float]) -> range:
    """Return the full turns by which cells of a joint may have to be shifted to meet a line."""
    if limits is not None:
        return range(1)
    low, size = float(ends[0]), float(ends[1] - ends[0])
    return range(
        int(np.floor((min(values) - low) / size - NEARLY)),
        int(np.floor((max(values) - low) / size + NEARLY)) + 1,
    )


def _crosses(low: Floats, high: Floats, start: Floats, step: Floats) -> Bools:
    """Tell which boxes a segment crosses: joint by joint, the part of it that is within."""
    first, last = np.zeros(len(low)), np.ones(len(low))
    for j, length in enumerate(step):
        if abs(length) <= NEARLY * float(np.abs(high[:, j] - low[:, j]).max(initial=0.0)):
            near = min(start[j], start[j] + length), max(start[j], start[j] + length)
            last[(low[:, j] > near[1]) | (high[:, j] < near[0])] = -1.0
        else:
            ends = (low[:, j] - start[j]) / length, (high[:, j] - start[j]) / length
            first = np.maximum(first, np.minimum(*ends))
            last = np.minimum(last, np.maximum(*ends))
    return np.asarray(first <= last + NEARLY)


def _kept(paving: Paving, chosen: Bools) -> Paving:
    """Keep some of the undecided cells."""
    ends = np.cumsum([count for count, _ in paving.runs], dtype=int)
    counts = [int(part.sum()) for part in np.split(chosen, ends)[:-1]]
    runs = zip(counts, paving.runs, strict=True)
    return replace(
        paving,
        undecided=paving.undecided[chosen],
        runs=tuple((count, forms) for count, (_, forms) in runs if count),
        unseparated=paving.unseparated[chosen],
    )
