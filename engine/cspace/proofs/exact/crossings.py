"""All points of a plane of two joints where two curves cross, with proof that none is missing.

Curves are zero sets of forms. The plane is halved again and again; a piece on which either form of
a pair cannot vanish is dropped, and on a piece that is small enough Krawczyk's operator

    K(X) = m - Y F(m) + (I - Y F'(X)) (X - m),        Y about the inverse of F'(m)

decides: K(X) inside X proves that X holds exactly one zero; K(X) disjoint from X proves that X
holds none. Pairs that neither settles (curves that touch, coincide or shrink to a point) are
returned by name as undecided.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Array, Ints
from cspace.forms.factors import FACTORS
from cspace.forms.harmonic import derivatives, over
from cspace.proofs import Verdict
from cspace.proofs.exact.bounds import BoxBounds, Cells
from cspace.proofs.exact.numbers import arb, ball, balls, precision, turns
from cspace.proofs.exact.problem import ExactProblem
from qbound.forms import HarmonicForm, Kind

Balls = tuple[arb, arb]

BITS = 212
"""Precision of a crossing: 60 digits, twice what is printed."""

FIRST_TRY = 8
"""Halvings before Krawczyk's operator is tried: a sixteenth of each range."""

MOST_PIECES = 4_000
"""Pieces of one pair left at once after which it is given up: its curves touch or coincide."""

DEEPEST = 44
"""Halvings after which a piece is given up: a four-millionth of each range."""


@dataclass(frozen=True, eq=False)
class Crossing:
    """A point proved to be the only zero of two functions in a box around it.

    Attributes
    ----------
    q : (arb, arb)
        The point, rad or length, within the ranges.
    names : (str, str)
        The boundaries that vanish there.
    curves : tuple of int
        The same by number: forms first, then ends of ranges in the order of `sides`.
    others : Verdict
        Whether all other forms are positive there; refuted if one is proved negative.
    """

    q: Balls
    names: tuple[str, str]
    curves: tuple[int, ...]
    others: Verdict


@dataclass(frozen=True, eq=False)
class Crossings:
    """All crossings of a list of curves.

    Attributes
    ----------
    crossings : tuple of Crossing
    undecided : tuple of str
        Pairs of names for which the list is not proved complete; empty if it is complete.
    """

    crossings: tuple[Crossing, ...]
    undecided: tuple[str, ...]

    @property
    def feasible(self) -> tuple[Crossing, ...]:
        """Crossings at which every other form is positive: the vertices of the region."""
        return tuple(c for c in self.crossings if c.others is Verdict.PROVED)


@dataclass(frozen=True, eq=False)
class Side:
    """One end of a joint's range."""

    joint: int
    value: arb
    name: str


def crossings(problem: ExactProblem, *, within: bool = False) -> Crossings:
    """Find all crossings of two forms, of a form and a limit, and of two limits.

    Not in the paper, which reads its six points off a picture.

    Parameters
    ----------
    problem : ExactProblem
        A problem of two joints.
    within : bool
        Whether pieces on which a third form is negative may be dropped. The list is then complete
        only for the closed region, and curves that touch outside it do no harm.

    Raises
    ------
    ValueError
        If the problem does not have two joints.
    """
    if len(problem.kinds) != 2:
        raise ValueError(f"crossings are points of two joints; here are {len(problem.kinds)}")
    pairs = list(combinations(range(len(problem.names)), 2))
    with precision(BITS):
        zeros, undecided = pair_zeros(problem, problem.forms, pairs, within=within)
        names = [(problem.names[i], problem.names[j]) for i, j in pairs]
        points = [classify(problem, q, names[p], pairs[p]) for p, q in zeros]
        open_names = [" and ".join(names[p]) for p in sorted(undecided)]
        for number, side in enumerate(sides(problem), start=len(problem.names)):
            for i, name in enumerate(problem.names):
                roots = side_roots(problem, i, side)
                if roots is None:
                    open_names.append(f"{name} and {side.name}")
                points += [
                    classify(problem, q, (name, side.name), (i, number)) for q in roots or ()
                ]
        points += _corners(problem)
    return Crossings(tuple(points), tuple(open_names))


def folds(problem: ExactProblem, *, within: bool = False) -> Crossings:
    """Find all points where a form vanishes with its derivative along the second joint.

    At a fold a curve turns back in the first joint. Forms without the second joint are straight
    lines and have no folds. Arguments as in `crossings`; not in the paper.
    """
    m = len(problem.names)
    with precision(BITS):
        slopes = problem.forms.derivative(1)
        forms = np.concatenate([problem.forms.coefficients, slopes.coefficients])
        pairs = [(i, m + i) for i in range(m) if not _vanishes(slopes.coefficients[i])]
        stacked = HarmonicForm(forms, problem.kinds)
        zeros, undecided = pair_zeros(problem, stacked, pairs, within=within)
        names = [(problem.names[i], f"d{problem.names[i]}/dq2") for i, _ in pairs]
        points = [classify(problem, q, names[p], pairs[p][:1]) for p, q in zeros]
    return Crossings(tuple(points), tuple(names[p][0] for p in sorted(undecided)))


# --- zeros of two forms ---------------------------------------------------------------------------


class _Pair:
    """Two forms and their gradients in balls; the zeros found so far, with the boxes of proof."""

    def __init__(self, forms: HarmonicForm, ij: tuple[int, int]) -> None:
        self.forms = HarmonicForm(balls(forms.coefficients[list(ij)]), forms.kinds)
        self.zeros: list[tuple[list[arb], list[arb]]] = []

    def krawczyk(self, x: list[arb]) -> list[arb] | None:
        """Apply the operator to a box; None if the derivative at the middle cannot be inverted."""
        middle = [ball(side.mid()) for side in x]
        inverse = _inverse(over(derivatives(self.forms), middle))
        if inverse is None:
            return None
        spread = np.array([side - m for side, m in zip(x, middle, strict=True)])
        rest = np.eye(2, dtype=int) - inverse @ over(derivatives(self.forms), x)
        image = np.array(middle) - inverse @ over(self.forms, middle) + rest @ spread
        return list(image)

    def settle(self, cell: list[arb], circles: Sequence[bool]) -> bool:
        """Decide whether a cell has no zero, or exactly one, which is noted; False if undecided."""
        box = [ball(side.mid()) + (side - side.mid()) * 5 / 4 for side in cell]
        image = self.krawczyk(box)
        if image is None:
            return False
        if not all(a.overlaps(b) for a, b in zip(image, box, strict=True)):
            return True
        if not all(a.contains_interior(b) for a, b in zip(box, image, strict=True)):
            return False
        point = self.refined(image)
        if not any(_same(point, known, circles) for _, known in self.zeros):
            self.zeros.append((point, box))
        return True

    def refined(self, x: list[arb]) -> list[arb]:
        """Shrink a box that holds one zero until rounding stops it."""
        for _ in range(BITS):  # about a zero at 0 the radius could shrink for ever
            image = self.krawczyk(x)
            if image is None:
                break
            new = [a.intersection(b) for a, b in zip(image, x, strict=True)]
            if not any(a.rad() < b.rad() * 7 / 8 for a, b in zip(new, x, strict=True)):
                return new
            x = new
        return x


def pair_zeros(
    problem: ExactProblem, forms: HarmonicForm, pairs: Sequence[tuple[int, int]], *, within: bool
) -> tuple[list[tuple[int, Balls]], set[int]]:
    """Find all common zeros of pairs of forms in the ranges of a problem.

    Returns
    -------
    zeros : list of (int, (arb, arb))
        Index of the pair, and the point.
    undecided : set of int
        Pairs for which the list is not proved complete.
    """
    bounds, work = BoxBounds(forms, problem.ends), [_Pair(forms, ij) for ij in pairs]
    circles = [r is None for r in problem.ranges]
    ij = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    watched = len(problem.names) if within else 0
    which, cells = np.arange(len(pairs)), bounds.whole()[np.zeros(len(pairs), dtype=np.int64)]
    undecided: set[int] = set()
    while len(cells):
        keep = _may_vanish(bounds, cells, ij[which], watched)
        which, cells = which[keep], cells[keep]
        if cells.level >= FIRST_TRY:
            undecided |= _abandoned(work, which, cells.level)
            keep = np.array(
                [
                    p not in undecided and not work[p].settle(bounds.box(cells, k), circles)
                    for k, p in enumerate(which)
                ],
                dtype=bool,
            )
            which, cells = which[keep], cells[keep]
        which, cells = np.tile(which, 2), cells.halves()
    zeros: list[tuple[int, Balls]] = []
    for p, pair in enumerate(work):
        placed = [within_ranges(problem, point) for point, _ in pair.zeros]
        zeros += [(p, point) for point in placed if point]
        undecided |= {p} if None in placed else set()
    return zeros, undecided


def _may_vanish(bounds: BoxBounds, cells: Cells, ij: Ints, watched: int) -> NDArray[np.bool_]:
    """Tell on which cells both forms of a pair may vanish, and no watched form is negative."""
    found: Any = np.unique(cells.index, axis=0, return_inverse=True)
    different, back = found
    low, high = bounds.bounds(Cells(cells.level, different))
    may = ~((low > 0) | (high < 0))
    outside = np.asarray((high[:, :watched] < 0).any(axis=1))[back]
    return np.asarray(may[back[:, None], ij].all(axis=1) & ~outside)


def _abandoned(work: Sequence[_Pair], which: Ints, level: int) -> set[int]:
    """Return the pairs to give up: proportional forms, too many pieces, or too small ones."""
    left, counts = np.unique(which, return_counts=True)
    return {
        int(p)
        for p, count in zip(left, counts, strict=True)
        if count > MOST_PIECES or level >= DEEPEST or (level == FIRST_TRY and _parallel(work[p]))
    }


def _parallel(pair: _Pair) -> bool:
    """Tell whether two forms may be multiples of each other."""
    one, other = pair.forms.coefficients.reshape(2, -1)
    largest = max(range(len(one)), key=lambda k: abs(float(one[k])))
    return all(
        (one[largest] * y - other[largest] * x).contains(0) for x, y in zip(one, other, strict=True)
    )


def _inverse(matrix: Array) -> Array | None:
    """Return an approximate inverse of a matrix of balls, as exact numbers."""
    (a, b), (c, d) = [[ball(entry.mid()) for entry in row] for row in matrix]
    det = ball((a * d - b * c).mid())
    if det.contains(0):
        return None
    scaled = [[d / det, -b / det], [-c / det, a / det]]
    return np.array([[ball(entry.mid()) for entry in row] for row in scaled])


def _same(point: Sequence[arb], box: Sequence[arb], circles: Sequence[bool]) -> bool:
    """Tell whether a point, turned by whole turns, lies in a box that holds one zero."""
    return all(
        any(side.contains(q + turns(k)) for k in ((-1, 0, 1) if circle else (0,)))
        for q, side, circle in zip(point, box, circles, strict=True)
    )


def _vanishes(coefficients: Array) -> bool:
    return all(c.is_zero() for c in balls(coefficients).flat)


# --- places and signs -----------------------------------------------------------------------------


def within_ranges(problem: ExactProblem, point: Sequence[arb]) -> Balls | tuple[()] | None:
    """Return a point if it is within the ranges, () if it is outside, None if undecided."""
    inside = [
        True if r is None else _between(q, *r) for q, r in zip(point, problem.ranges, strict=True)
    ]
    if False in inside:
        return ()
    return None if None in inside else (point[0], point[1])


def _between(q: arb, low: arb, high: arb) -> bool | None:
    """Tell whether low < q < high; None if undecided."""
    if q > low and q < high:
        return True
    return False if q < low or q > high else None


def classify(
    problem: ExactProblem, q: Balls, names: tuple[str, str], curves: Sequence[int]
) -> Crossing:
    """Make the crossing of a point, with the sign of all forms that do not vanish there."""
    others = np.delete(balls(over(problem.forms, q)), [i for i in curves if i < len(problem.names)])
    word = Verdict.of(all(x > 0 for x in others), any(x < 0 for x in others))
    return Crossing(q, names, tuple(curves), word)


# --- lines of one joint value ---------------------------------------------------------------------


def sides(problem: ExactProblem) -> list[Side]:
    """Return the ends of all ranges."""
    pairs = zip(problem.ranges, problem.limits, strict=True)
    return [
        Side(joint, value, name)
        for joint, (ends, names) in enumerate(pairs)
        for value, name in zip(ends or (), names, strict=False)
    ]


def side_roots(problem: ExactProblem, form: int, side: Side) -> list[Balls] | None:
    """Return the zeros of a form where one joint has a given value: Theorem 2 in balls.

    Returns
    -------
    list of (arb, arb), or None
        None if roots are not proved to be simple, or to lie inside or outside the other range.
    """
    other = 1 - side.joint
    point = np.array([side.value, side.value])
    coefficients = balls(np.stack(problem.forms[form].along(other, point)))
    roots = line_roots(problem.kinds[other], coefficients)
    if roots is None:
        return None
    placed = [_turned(problem, other, root) for root in roots]
    if None in placed:
        return None
    return [placed_at(side.joint, side.value, v) for found in placed for v in found or ()]


def placed_at(joint: int, t: arb, v: arb) -> Balls:
    """Return the point with the value t of one joint and v of the other."""
    return (t, v) if joint == 0 else (v, t)


def line_roots(kind: Kind, c: Sequence[arb] | Array) -> list[arb] | None:
    """Solve c0 + c1 cos v + c2 sin v = 0, or c0 + c1 v + c2 v² = 0; None if perhaps double."""
    c0, c1, c2 = c
    slides = kind == "prismatic"
    if slides and c2.is_zero():
        return [-c0 / c1] if not c1.contains(0) else ([] if not c0.contains(0) else None)
    square = FACTORS[kind].discriminant(c)
    if square < 0:
        return []
    if not square > 0 or (slides and c2.contains(0)):
        return None
    if slides:
        return [(-c1 + sign * square.sqrt()) / (2 * c2) for sign in (-1, 1)]
    theta, alpha = type(c0).atan2(c2, c1), type(c0).atan2(square.sqrt(), -c0)
    return [theta - alpha, theta + alpha]


def _turned(problem: ExactProblem, joint: int, q: arb) -> list[arb] | None:
    """Return every value, modulo full turns, in a joint's range; None if undecided at an end."""
    ends = problem.ranges[joint]
    if ends is None:
        return [q]
    if problem.kinds[joint] == "prismatic":
        candidates = [q]
    else:
        first, last = (float((end - q) / turns(1)) for end in ends)
        candidates = [q + turns(k) for k in range(int(first) - 2, int(last) + 3)]
    inside = [_between(x, *ends) for x in candidates]
    if None in inside:
        return None
    return [x for x, there in zip(candidates, inside, strict=True) if there]


def _corners(problem: ExactProblem) -> list[Crossing]:
    """Return the points where two limits meet."""
    ends = list(enumerate(sides(problem), start=len(problem.names)))
    return [
        classify(problem, (one.value, other.value), (one.name, other.name), (i, j))
        for (i, one), (j, other) in combinations(ends, 2)
        if one.joint < other.joint
    ]
