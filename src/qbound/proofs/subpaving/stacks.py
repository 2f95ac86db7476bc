r"""Certified pavings by columns: over cells of all joints but one, the last joint is solved for.

Along one turning joint x, the lift, every form is :math:`a \cos x + b \sin x + c` (Theorem 2). Over
a cell of the other joints its two roots stay within slabs that tilt as the roots do: across a slab
the form is proved to change its sign, so both roots lie in slabs, and beside the slabs the sign is
proved. The thickness of a slab comes from the bend of the form and falls with the square of the
cell's width. With `paving` the undecided part of a cell falls only with the width. Where the two
roots are not proved apart, near a fold, bounds of the form all over the cell decide.

Not in the paper. The bounds are those of `bounds`: sums and products of doubles, less their
rounding, with cosines and sines by `numbers`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from qbound.arrays import Bools, Floats
from qbound.export.formats import heading
from qbound.model.robot import Robot
from qbound.proofs import Verdict
from qbound.proofs.exact.bounds import BITS, BoxBounds
from qbound.proofs.exact.numbers import ERROR, FARTHEST, above, basis_of_doubles, below, precision
from qbound.proofs.exact.problem import ExactProblem
from qbound.proofs.subdivide import Rows
from qbound.proofs.subpaving.paving import Clock, bracket_lines, part_done, volume_unit
from qbound.proofs.subpaving.sectors import Sectors, covered, hidden, pieces, sectors_of
from qbound.units import counted

MOST_COLUMNS = 2_000_000
"""Cells at which a paving stops on its own."""

FIRST = 64
"""Cells to begin with."""

BLOCK = 2**18
"""Forms over cells that are looked at together."""

WORST = 0.7
"""Part of the undecided volume whose cells are halved in a round."""

FUZZ = 1e-9
"""What is added to volumes for the rounding of their sums, in parts."""


@dataclass(frozen=True, eq=False)
class Columns(Rows):
    """Cells of all joints but the lift, with proved volumes over each cell.

    Attributes
    ----------
    low, high : ndarray, shape (k, n - 1)
        Closed cells, rad or length, as exact doubles. Together they fill the range of their joints,
        up to the rounding of its ends.
    undecided, feasible : ndarray, shape (k,)
        For each column over a cell: an upper bound of its undecided volume, and a lower bound of
        its feasible volume.
    slopes : ndarray, shape (k, n - 1)
        How much the forms change across each joint of the cell.
    """

    low: Floats
    high: Floats
    undecided: Floats
    feasible: Floats
    slopes: Floats


@dataclass(frozen=True, eq=False)
class ColumnPaving:
    """A paving by columns over the whole range of every joint; not in the paper.

    Attributes
    ----------
    problem : ExactProblem
    lift : int
        The joint that is solved for.
    bounds : BoxBounds
    columns : Columns
    """

    problem: ExactProblem
    lift: int
    bounds: BoxBounds
    columns: Columns

    @property
    def volume(self) -> float:
        """Volume of the whole range, rounded."""
        low, high = _inner_ends(self.bounds)
        return float(np.prod(high - low))

    @property
    def undecided_fraction(self) -> float:
        """Part of the range that is undecided, rounded up."""
        return float(self.columns.undecided.sum()) / self.volume * (1 + FUZZ) + FUZZ

    @property
    def bracket(self) -> tuple[float, float]:
        """Lower and upper bound of the region's volume; product of the joints' units."""
        inner = float(self.columns.feasible.sum())
        outer = inner + float(self.columns.undecided.sum())
        rounding = FUZZ * self.volume
        return max(0.0, inner * (1 - FUZZ) - rounding), outer * (1 + FUZZ) + rounding

    def verdicts(self, q: Any) -> set[Verdict]:
        """Return the verdicts, feasible or not, of all cells that hold a configuration.

        Outside the range there are none.

        Parameters
        ----------
        q : array_like, shape (n,)
            rad or length.
        """
        place = np.asarray(q, dtype=float)
        base, low, high = np.delete(place, self.lift), self.columns.low, self.columns.high
        holding = np.flatnonzero(((low <= base) & (base <= high)).all(axis=1))
        ends = _lift_ends(self)
        if not ends[0] <= place[self.lift] <= ends[1]:
            return set()
        found = _sectors(self, low[holding], high[holding])
        inside, outside = found.told(base, float(place[self.lift]))
        words = np.where(inside, 1, np.where(outside, -1, 0)).tolist()
        names = {1: Verdict.PROVED, -1: Verdict.REFUTED, 0: Verdict.UNDECIDED}
        return {names[word] for word in words}


def pave_columns(
    problem: ExactProblem,
    tolerance: float,
    *,
    lift: int | None = None,
    most: int = MOST_COLUMNS,
    tell: Callable[[float], None] = lambda part: None,
    seconds: float = math.inf,
) -> ColumnPaving:
    """Halve cells until the undecided parts of the columns over them fill no more than asked.

    Parameters
    ----------
    problem : ExactProblem
        A problem of two or more joints, one of which turns; without bodies.
    tolerance : float
        Largest undecided part of the range.
    lift : int, optional
        The turning joint that is solved for; default the last one.
    most : int
        Cells at which to stop early; `ColumnPaving.undecided_fraction` tells.
    tell : callable
        Called with the progress, from 0 to 1.
    seconds : float
        Limit of time, as in `paving.pave`.

    Raises
    ------
    ValueError
        If the tolerance is not positive, no joint turns, a joint turns beyond `FARTHEST`, or bodies
        are to keep apart.

    Examples
    --------
    >>> from qbound.proofs.exact.problem import exact_problem, exact_robot
    >>> paving = pave_columns(exact_problem(exact_robot("minervabot-v2")), 1e-3)
    >>> inner, outer = paving.bracket
    >>> paving.undecided_fraction <= 1e-3, inner < 25.8433 < outer
    (True, True)
    """
    if not tolerance > 0:
        raise ValueError(f"a tolerance of {tolerance} cannot be met; it has to be positive")
    paving, clock = _start(problem, _lift(problem, lift)), Clock(seconds)
    while paving.undecided_fraction > tolerance and len(paving.columns) < most and clock.has_time():
        finer = _refined(paving)
        if len(finer.columns) == len(paving.columns):
            break
        paving = finer
        tell(part_done(paving.undecided_fraction, tolerance))
    tell(1.0)
    return paving


def _lift(problem: ExactProblem, lift: int | None) -> int:
    """Return the joint to solve for; ValueError if there is none."""
    turning = [j for j, kind in enumerate(problem.kinds) if kind == "revolute"]
    if problem.bodies:
        raise ValueError("columns are of boundaries of points; this robot's bodies take cells")
    if len(problem.kinds) < 2 or not turning:
        raise ValueError("columns take two joints or more, one of which turns; others take cells")
    if lift is not None and lift not in turning:
        raise ValueError(f"joint {lift} does not turn: columns are solved for one that does")
    return turning[-1] if lift is None else lift


def _start(problem: ExactProblem, lift: int) -> ColumnPaving:
    """Return a coarse paving."""
    with precision(BITS):
        bounds = BoxBounds(problem.forms, problem.ends)
    low, high = _inner_ends(bounds)
    if not bool((low < high).all()):
        raise ValueError("the range of a joint is empty")
    for joint, kind in enumerate(problem.kinds):
        if kind == "revolute" and max(abs(low[joint]), abs(high[joint])) > FARTHEST:
            raise ValueError(f"joint {joint}: its limits reach beyond {FARTHEST:g} rad")
    base = np.delete(np.arange(len(low)), lift)
    count = max(1, round(FIRST ** (1 / len(base))))
    edges = [np.linspace(low[j], high[j], count + 1) for j in base]
    corners = [np.stack(np.meshgrid(*side, indexing="ij"), axis=-1) for side in _sides(edges)]
    none, no_cells = np.zeros(0), np.zeros((0, len(base)))
    empty = Columns(no_cells, no_cells, none, none, no_cells)
    paving = ColumnPaving(problem, lift, bounds, empty)
    cells = (c.reshape(-1, len(base)) for c in corners)
    return replace(paving, columns=_looked_at(paving, *cells))


def _sides(edges: list[Floats]) -> tuple[list[Floats], list[Floats]]:
    return [e[:-1] for e in edges], [e[1:] for e in edges]


def _refined(paving: ColumnPaving) -> ColumnPaving:
    """Halve the cells over which most is undecided."""
    columns = paving.columns
    order = np.argsort(-columns.undecided, kind="stable")
    upto = np.cumsum(columns.undecided[order])
    chosen = order[: int(np.searchsorted(upto, WORST * upto[-1])) + 1]
    old, joint = columns[chosen], np.argmax(columns.slopes[chosen], axis=1)
    rows = np.arange(len(chosen))
    middle = (old.low[rows, joint] + old.high[rows, joint]) / 2
    room = (old.low[rows, joint] < middle) & (middle < old.high[rows, joint])
    rows, joint, middle, old = np.arange(room.sum()), joint[room], middle[room], old[room]
    first, second = old.high.copy(), old.low.copy()
    first[rows, joint], second[rows, joint] = middle, middle
    low, high = np.concatenate([old.low, second]), np.concatenate([first, old.high])
    kept = np.ones(len(columns), dtype=bool)
    kept[chosen[room]] = False
    return replace(paving, columns=Columns.joined([columns[kept], _looked_at(paving, low, high)]))


def _looked_at(paving: ColumnPaving, low: Floats, high: Floats) -> Columns:
    """Bound the undecided and the feasible volume over cells, some at a time."""
    step = max(1, BLOCK // max(1, len(paving.problem.names)))
    parts = [slice(k, k + step) for k in range(0, len(low), step)]
    empty = Columns(low[:0], high[:0], low[:0, 0], low[:0, 0], low[:0])
    return Columns.joined([empty, *(_measured(paving, low[part], high[part]) for part in parts)])


def _measured(paving: ColumnPaving, low: Floats, high: Floats) -> Columns:
    """Bound volumes over cells by lengths along the lift, at the middle or all over the cell."""
    found, ends = _sectors(paving, low, high), _lift_ends(paving)
    whole = ends[1] - ends[0]
    shut = [pieces(*sector, *ends) for sector in (found.not_positive(0), found.negative_sector(0))]
    wide = [pieces(*sector, *ends) for sector in (found.not_positive(1), found.negative_sector(1))]
    zones = [pieces(*zone, *ends) for zone in found.open_zones()]
    generic = _apart(zones, wide[1], *ends, turning=_turns(paving))
    lengths = [
        np.where(generic, covered(*middle), covered(*outer))
        for middle, outer in zip(shut, wide, strict=True)
    ]
    area = np.prod(high - low, axis=1)
    undecided = np.maximum(lengths[0] - lengths[1], 0.0)
    feasible = np.maximum(whole - lengths[0], 0.0)
    return Columns(low, high, area * undecided, area * feasible, found.slopes)


def _apart(
    zones: list[tuple[Floats, Floats]],
    forbidden: tuple[Floats, Floats],
    low: float,
    high: float,
    *,
    turning: bool,
) -> Bools:
    """Tell over which cells the visible zones keep their order all over the cell.

    Over such cells the lengths at the middle are the means over the cell, because every end of a
    zone is a root, which tilts linearly, or a bound, which does not change.
    """
    first = np.concatenate([zone[0] for zone in zones], axis=1)
    last = np.concatenate([zone[1] for zone in zones], axis=1)
    seen = (first < last) & ~hidden(first, last, *forbidden)
    first, last = np.where(seen, first, np.inf), np.where(seen, last, np.inf)
    order = np.argsort(first, axis=1)
    first, last = (np.take_along_axis(x, order, axis=1) for x in (first, last))
    with np.errstate(invalid="ignore"):
        apart = (first[:, 1:] > last[:, :-1]) | np.isinf(first[:, 1:])
    good: Bools = np.asarray(apart.all(axis=1))
    if not turning:
        touches = seen.any(axis=1) & ((first <= low) | (np.isfinite(last) & (last >= high))).any(1)
        good &= ~touches
    return good


def _turns(paving: ColumnPaving) -> bool:
    """Tell whether the lift turns all the way round."""
    return paving.problem.ranges[paving.lift] is None


def _inner_ends(bounds: BoxBounds) -> tuple[Floats, Floats]:
    """Return doubles within the range of every joint."""
    ends = bounds.ends
    return np.array([above(low) for low, _ in ends]), np.array([below(high) for _, high in ends])


def _lift_ends(paving: ColumnPaving) -> tuple[float, float]:
    low, high = _inner_ends(paving.bounds)
    return float(low[paving.lift]), float(high[paving.lift])


def _sectors(paving: ColumnPaving, low: Floats, high: Floats) -> Sectors:
    """Solve all forms along the lift, over cells: the forms and their slopes at the centres."""
    bounds, lift = paving.bounds, paving.lift
    kinds = paving.problem.kinds
    base = [j for j in range(len(kinds)) if j != lift]
    centre = low + (high - low) / 2
    half = np.nextafter(np.maximum(high - centre, centre - low), np.inf)
    at = np.moveaxis(bounds.table.coefficients, 2 + lift, -1)
    factors = [basis_of_doubles(kinds[j], centre[:, k]) for k, j in enumerate(base)]
    at = np.tensordot(factors[0], at, axes=(1, 2))
    for factor in factors[1:]:
        at = np.einsum("kmrs...,ks->kmr...", at, factor)
    slack = bounds.slack + 2 * len(kinds) * ERROR * _sizes(bounds)
    return sectors_of(at, slack, bounds.curvature, half, base, lift, centre)


def _sizes(bounds: BoxBounds) -> Floats:
    """Bound the forms and their slopes over the whole range."""
    reach = [max(abs(above(low)), abs(above(high))) for low, high in bounds.ends]
    return np.asarray(bounds.table.size([math.nextafter(r, math.inf) for r in reach]))


# --- as others read it ----------------------------------------------------------------------------

COLUMN = ("low", "high", "feasible", "undecided")
"""What a document tells of each column."""


def columns_document(robot: Robot, paving: ColumnPaving, free: Sequence[int]) -> dict[str, Any]:
    """Return the JSON form of a paving of columns, schema qbound/columns/1; rad, or length.

    A column is a closed cell of all joints but one, the lift. Its volumes are a lower bound of the
    feasible volume and an upper bound of the undecided volume.

    Parameters
    ----------
    free : sequence of int
        Indices of the robot's joints that move.
    """
    inner, outer = paving.bracket
    names, lift = [robot.joints[j].name for j in free], paving.lift
    return {
        **heading("qbound/columns/1", robot),
        "volume": {"inner": inner, "outer": outer},
        "undecided": paving.undecided_fraction,
        "joints": names,
        "range": [[float(low), float(high)] for low, high in paving.bounds.ends],
        "lift": names[lift],
        "columns": [
            {"from": low, "to": high, "feasible": feasible, "undecided": undecided}
            for low, high, feasible, undecided in zip(
                *(getattr(paving.columns, name).tolist() for name in COLUMN), strict=True
            )
        ],
    }


def columns_lines(robot: Robot, paving: ColumnPaving) -> Iterator[str]:
    """Yield sentences about the volume that a paving of columns encloses."""
    unit = volume_unit(robot, paving.problem.kinds)
    yield from bracket_lines(unit, *paving.bracket, paving.undecided_fraction)
    yield counted(len(paving.columns), "column")
