"""Certified pavings: cells proved feasible, cells proved infeasible, and undecided cells.

A cell is feasible if every form is positive all over it, and for every two bodies some feature
separates them all over it. A cell is infeasible if one form is negative all over it, or if every
feature of some two bodies has a form that is negative all over it. The region lies between the
inner paving (feasible cells) and the outer one (feasible and undecided cells); the undecided volume
is measured. Any number of joints.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import prod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Bools, Ints
from cspace.boundary.contacts import ExactSeparation
from cspace.proofs import Verdict
from cspace.proofs.exact.bounds import BITS, DEEPEST, BoxBounds, Cells
from cspace.proofs.exact.numbers import arb, ball, below, precision
from cspace.proofs.exact.problem import ExactProblem

Run = tuple[int, Ints]

LONGEST_RUN, SHORTEST_RUN = 2048, 256
"""Cells that are looked at together: few, so that few forms may vanish among them."""

MOST_CELLS = 2_000_000
"""Undecided cells at which a paving stops on its own: about a gigabyte of bounds."""

BLOCK = 2**20
"""Bounds of bodies' forms that are held at once."""


@dataclass(frozen=True, eq=False)
class SeparationBounds:
    """Bounds of the separating features of two convex parts, over dyadic cells.

    Attributes
    ----------
    bounds : BoxBounds
        Bounds of the forms of all features.
    starts : ndarray of int
        First form of each feature.
    """

    bounds: BoxBounds
    starts: NDArray[np.intp]

    def proved(self, cells: Cells) -> tuple[Bools, Bools]:
        """Tell on which closed cells a feature separates everywhere, and on which none does.

        The second holds if each feature has a form that is negative all over the cell.
        """
        step = max(1, BLOCK // len(self.bounds.slack))
        apart, together = np.zeros(len(cells), dtype=bool), np.zeros(len(cells), dtype=bool)
        for k in range(0, len(cells), step):
            low, high = self.bounds.bounds(cells[k : k + step])
            apart[k : k + step] = (self._least(low) > 0).any(axis=1)
            together[k : k + step] = (self._least(high) < 0).all(axis=1)
        return apart, together

    def _least(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.minimum.reduceat(values, self.starts, axis=1))


@dataclass(frozen=True, eq=False)
class Paving:
    """Cells that fill the whole range of every joint without overlap; not in the paper.

    Attributes
    ----------
    problem : ExactProblem
    bounds : BoxBounds
    feasible, infeasible : tuple of Cells
        One entry for each size. Every form is positive on every closed feasible cell, and every two
        bodies are separated; on every closed infeasible cell some form is negative throughout, or
        two bodies are nowhere separated.
    undecided : Cells
        The cells about which nothing is claimed.
    runs : tuple of (int, ndarray of int)
        Runs of undecided cells: their number, and the forms that are open there. All other forms
        are proved positive on these cells, and so on all of their parts.
    bodies : tuple of SeparationBounds
        Bounds for each pair of parts of bodies that are to keep apart.
    unseparated : ndarray of bool, shape (undecided cells, pairs)
        Which pairs are not proved apart on an undecided cell; only these pairs are checked on its
        halves.
    """

    problem: ExactProblem
    bounds: BoxBounds
    feasible: tuple[Cells, ...]
    infeasible: tuple[Cells, ...]
    undecided: Cells
    runs: tuple[Run, ...]
    bodies: tuple[SeparationBounds, ...]
    unseparated: Bools

    @property
    def level(self) -> int:
        """How often the undecided cells have been halved."""
        return self.undecided.level

    @property
    def cells(self) -> int:
        """Count of all cells."""
        return sum(map(len, (*self.feasible, *self.infeasible, self.undecided)))

    @property
    def inner_fraction(self) -> Fraction:
        """Part of the range that is proved feasible: exact."""
        return sum(map(_fraction, self.feasible), Fraction(0))

    @property
    def undecided_fraction(self) -> Fraction:
        """Part of the range that is undecided: exact."""
        return _fraction(self.undecided)

    @property
    def bracket(self) -> tuple[arb, arb]:
        """Inner and outer volume as balls; the region's volume lies between them."""
        inner, undecided = self.inner_fraction, self.undecided_fraction
        return self.volume(inner), self.volume(inner + undecided)

    def volume(self, part: Fraction) -> arb:
        """Return the volume of a fraction of the range as a ball; product of the joints' units."""
        with precision(BITS):
            whole = prod(high - low for low, high in self.bounds.ends)
            return ball(whole * part.numerator) / part.denominator

    def refined(self) -> Paving:
        """Halve every undecided cell and sort the halves.

        Raises
        ------
        ValueError
            If the cells are too small to be told apart in a 64-bit index.
        """
        if self.level >= DEEPEST:
            raise ValueError(f"cells have been halved {DEEPEST} times: no smaller ones")
        halves = _in_order(self.undecided.halves())
        return _sorted(self, halves, _doubled(self.runs), np.repeat(self.unseparated, 2, axis=0))

    def verdicts(self, q: ArrayLike) -> set[Verdict]:
        """Return the verdicts, feasible or not, of all cells that may hold a configuration.

        On the border of cells the verdicts may differ. Outside the range there are none.

        Parameters
        ----------
        q : array_like, shape (n,)
            rad or length; each double counts as an exact binary fraction. For a joint that turns
            all the way round any turn is allowed.
        """
        groups = (
            (Verdict.PROVED, self.feasible),
            (Verdict.REFUTED, self.infeasible),
            (Verdict.UNDECIDED, (self.undecided,)),
        )
        return {word for word, cells in groups if any(self.containing(c, q).any() for c in cells)}

    def containing(self, cells: Cells, q: ArrayLike) -> NDArray[np.bool_]:
        """Tell which closed cells may hold a configuration, including all that do."""
        inside = np.ones(len(cells), dtype=bool)
        for j, value in enumerate(np.asarray(q, dtype=float).tolist()):
            low, high = self._places(j, value, int(cells.bits[j]))
            index, size = cells.index[:, j], 2 ** int(cells.bits[j])
            if self.problem.ranges[j] is None:
                near = range(low, min(high, low + size) + 1)  # a huge angle may lie anywhere
                inside &= np.isin(index, [k % size for k in near])
            else:
                inside &= (index >= low) & (index <= high)
        return inside

    def _places(self, joint: int, value: float, bits: int) -> tuple[int, int]:
        """Return the first and the last index of cells that may hold a joint value."""
        with precision(BITS):
            low, high = self.bounds.ends[joint]
            place = (ball(value) - low) / (high - low) * 2**bits
            ends = place.lower().ceil().unique_fmpz(), place.upper().floor().unique_fmpz()
        if None in ends:  # rounding spans whole turns: it may lie anywhere
            return 0, 2**bits - 1
        return int(ends[0]) - 1, int(ends[1])


def pave(problem: ExactProblem, tolerance: float, most: int = MOST_CELLS) -> Paving:
    """Halve undecided cells until they fill at most a given fraction of the range.

    Parameters
    ----------
    problem : ExactProblem
        A problem of any number of joints.
    tolerance : float
        Largest undecided fraction of the range.
    most : int
        Undecided cells at which to stop early; `Paving.undecided_fraction` tells.

    Raises
    ------
    ValueError
        If the tolerance is not positive.

    Examples
    --------
    >>> from cspace.proofs.exact.problem import exact_problem, exact_robot
    >>> paving = pave(exact_problem(exact_robot("minervabot-v2")), 0.1)
    >>> float(paving.undecided_fraction) <= 0.1
    True
    >>> inner, outer = (float(volume) for volume in paving.bracket)
    >>> inner < 25.8433 < outer
    True
    """
    if not tolerance > 0:
        raise ValueError(f"a tolerance of {tolerance} cannot be met; it has to be positive")
    paving = start(problem)
    while paving.undecided_fraction > tolerance and 2 * len(paving.undecided) <= most:
        if paving.level >= DEEPEST:
            break
        paving = paving.refined()
    return paving


def start(problem: ExactProblem) -> Paving:
    """Return the paving of one cell: the whole range."""
    with precision(BITS):
        bounds = BoxBounds(problem.forms, problem.ends)
        for (low, high), names in zip(bounds.ends, problem.limits, strict=True):
            if not below(high - low) > 0:
                raise ValueError(f"{names[0]} and {names[1]}: the range is empty")
        bodies = tuple(_of_bodies(found, bounds) for found in problem.bodies)
    whole, every = bounds.whole(), np.arange(len(problem.names))
    open_pairs = np.ones((1, len(bodies)), dtype=bool)
    empty = Paving(problem, bounds, (), (), whole, (), bodies, open_pairs)
    return _sorted(empty, whole, [(len(whole), every)], open_pairs)


def _of_bodies(separation: ExactSeparation, bounds: BoxBounds) -> SeparationBounds:
    """Prepare the bounds of a pair; cosines and sines are computed once for all."""
    return SeparationBounds(
        BoxBounds(separation.forms, bounds.ends, bounds.rows), separation.starts
    )


def _in_order(halves: Cells) -> Cells:
    """Put the two halves of each cell beside each other: neighbours stay together."""
    return halves[np.arange(len(halves)).reshape(2, -1).T.ravel()]


def _doubled(runs: Iterable[Run]) -> list[Run]:
    return [(2 * count, forms) for count, forms in runs]


def _sorted(paving: Paving, cells: Cells, runs: Sequence[Run], unseparated: Bools) -> Paving:
    """Sort new cells into a paving; they replace its undecided ones.

    The work goes run by run, so that only forms that may vanish are checked; long runs are divided.
    """
    feasible, infeasible = (np.zeros(len(cells), dtype=bool) for _ in range(2))
    unseparated = unseparated.copy()
    left, start = list[Run](), 0
    for length, forms in runs:
        for first in range(start, start + length, LONGEST_RUN):
            part = slice(first, min(first + LONGEST_RUN, start + length))
            low, high = paving.bounds.bounds(cells[part], forms)
            bad: Bools = np.asarray((high < 0).any(axis=1))
            _separate(paving.bodies, cells[part], unseparated[part], bad)
            good = (low > 0).all(axis=1) & ~unseparated[part].any(axis=1) & ~bad
            feasible[part], infeasible[part] = good, bad
            open_cells = ~good & ~bad
            if open_cells.any():
                may = forms[(low[open_cells] <= 0).any(axis=0)]
                left.append((int(open_cells.sum()), may))
        start += length
    open_cells = ~feasible & ~infeasible
    return replace(
        paving,
        feasible=(*paving.feasible, *_some(cells[feasible])),
        infeasible=(*paving.infeasible, *_some(cells[infeasible])),
        undecided=cells[open_cells],
        runs=tuple(_joined(left)),
        unseparated=unseparated[open_cells],
    )


def _separate(
    bodies: Sequence[SeparationBounds], cells: Cells, unseparated: Bools, infeasible: Bools
) -> None:
    """Clear, in place, pairs proved separated; mark cells where two bodies never are."""
    for k, pair in enumerate(bodies):
        asked = np.flatnonzero(unseparated[:, k] & ~infeasible)
        if len(asked):
            apart, together = pair.proved(cells[asked])
            unseparated[asked[apart], k] = False
            infeasible[asked[together]] = True


def _joined(runs: Sequence[Run]) -> list[Run]:
    """Join short neighbouring runs, because a handful of cells is not worth a call."""
    found = list[Run]()
    for count, forms in runs:
        if found and found[-1][0] + count <= SHORTEST_RUN:
            before, known = found.pop()
            found.append((before + count, np.union1d(known, forms)))
        else:
            found.append((count, forms))
    return found


def _some(cells: Cells) -> tuple[Cells, ...]:
    return (cells,) if len(cells) else ()


def _fraction(cells: Cells) -> Fraction:
    return Fraction(len(cells), 2**cells.level)
