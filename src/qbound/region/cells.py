"""From cells to components: which cells are adjacent over an open interval.

Two neighbouring cells are joined across a critical line only over an open interval on which every
form is positive on that line.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.boundary.contacts import SIDES
from qbound.forms.angles import TURN, first_from, turns_up_to, whole_turns
from qbound.region.decomposition import Cell, Decomposition, turned_root, vanishes_on
from qbound.region.plane import Plane, ranges, runs, which
from qbound.region.precise import NUMBER, UndecidedError, in_order
from qbound.tolerances import SAME_POINT, TOUCH, UNIT

INSET = 1e-4 * np.arange(4)
"""Where cells are looked at beside their lines, in parts of their width."""


FOLDS = NUMBER["fold circle"], NUMBER["fold line"]
"""Events at which both branches of a curve meet."""


class Placed(NamedTuple):
    """A cell that holds a configuration, or nearly.

    Attributes
    ----------
    cell : int
    place : ndarray, shape (2,)
        Base and lift value in the cell's own turns.
    off : ndarray, shape (2,)
        From there to the cell's closure; zero inside.
    """

    cell: int
    place: Floats
    off: Floats


@dataclass(frozen=True, eq=False)
class Elements:
    """Pieces of critical lines between ends of cells, one a row, by line and upwards.

    Attributes
    ----------
    line : ndarray of int, shape (n,)
    low, high : ndarray, shape (n,)
        Where it lies; within one turn, but for the last, where the lift is a circle.
    cell : ndarray of int, shape (2, n)
        The cells to its left and to its right; -1 where there is none.
    turns : ndarray of int, shape (2, n)
        Full turns that bring it into these cells.
    joined : ndarray of bool, shape (n,)
        Whether the two cells hang together over it.
    """

    line: Ints
    low: Floats
    high: Floats
    cell: Ints
    turns: Ints
    joined: Bools


class Parts(NamedTuple):
    """Components as sets of cells.

    Attributes
    ----------
    cells : list of list of int
        Those of each component.
    wraps : list of two bool
        Whether a component goes round the base, and round the lift.
    windings : ndarray of int, shape (cells, 2)
        Turns of base and lift at which each cell lies within its component.
    """

    cells: list[list[int]]
    wraps: list[tuple[bool, bool]]
    windings: Ints

    def of_cells(self) -> Ints:
        """Return the component of each cell, by index."""
        part = np.empty(len(self.windings), dtype=np.int64)
        counts = list(map(len, self.cells))
        part[list(chain(*self.cells))] = np.arange(len(counts)).repeat(counts)
        return part


class _Ends(NamedTuple):
    """Ends of cells on lines, and other places at which lines are cut.

    Line, value, a bound of its error, whether the cell lies to the right (0) or left (1), and root.
    """

    line: Ints
    v: Floats
    error: Floats
    side: Ints
    root: Ints

    def ball(self, found: Decomposition, k: int, near: float, bits: int) -> Any:
        """Return an end as a ball, on the turn that is near to a value."""
        form, branch, _ = self.root[k].tolist()
        base, side = found.critical.ball(int(self.line[k]), bits), 1 if self.side[k] == 0 else -1
        return turned_root(found.precise, form, branch, base, bits, near, side)


class CellComplex:
    """The cells of a decomposition and how they hang together."""

    def __init__(self, decomposition: Decomposition) -> None:
        self.decomposition = decomposition
        self.plane: Plane = decomposition.plane
        self.abscissae = decomposition.lines
        self.slabs, self.roots = decomposition.slabs, decomposition.roots
        self.wrapped = self.plane.base_range is None
        self.circle = self.plane.lift_range is None
        self.touch = TOUCH * self.plane.lift_unit
        self.n_lines = len(self.abscissae) - (1 if self.wrapped else 0)
        self.whole: Bools = self.circle & (self.roots[:, 0, 0] < 0)
        self.ends, self._errors = self._ends()
        self.elements: Elements = self._elements()
        self._join()

    @property
    def cells(self) -> list[Cell]:
        """The cells, one by one."""
        return self.decomposition.cells

    # --- places ---------------------------------------------------------------------------------

    def interval(self, chosen: Sequence[int] | Ints, t: Floats) -> Floats:
        """Return lower and upper root of chosen cells, each over its own row of t; (2, k, n)."""
        bounding = self.roots[np.asarray(chosen, dtype=np.int64)].swapaxes(0, 1)
        values = self.plane.follow(bounding, t)
        np.maximum(values[0], values[1], out=values[1])
        return values

    def spans(self, chosen: Sequence[int] | Ints) -> Floats:
        """Return the base values between which chosen cells lie, shape (k, 2)."""
        slabs = self.slabs[np.asarray(chosen, dtype=np.int64)]
        return np.asarray(self.abscissae[np.array([slabs, slabs + 1]).T])

    def placed(self, place: Floats) -> list[Placed]:
        """Return the cells within reach of base and lift values, those that hold them first.

        Reach is `TOUCH` in the units of base and lift.
        """
        t, v = map(float, place)
        bases = [t]
        if self.wrapped:  # beyond the cut of the circle, too
            low, high = self.plane.ends
            t = float(first_from(low, t))
            near = TOUCH * self.plane.base_unit
            bases = [t, *[t - TURN] * (t >= high - near), *[t + TURN] * (t <= low + near)]
        found = [one for t in bases for one in self._placed(t, v)]
        return sorted(found, key=lambda one: float(np.abs(one.off).max()))

    def _placed(self, t: float, v: float) -> list[Placed]:
        units = np.array([self.plane.base_unit, self.plane.lift_unit])
        near = TOUCH * self.plane.base_unit
        first, last = self.abscissae.searchsorted([t - near, t + near])
        begin, stop = self.slabs.searchsorted([first - 1, last])
        chosen = np.arange(begin, stop)
        if not len(chosen):
            return []
        start, end = self.spans(chosen).T
        low, high = self._interval_at(chosen, start, end, t)
        turns = TURN * turns_up_to(low - self.touch, v) * self.circle
        inside = np.minimum(np.maximum(v + turns, low), high)
        inside = np.where(self.whole[chosen], v + turns, inside)
        off = np.array([np.minimum(np.maximum(t, start), end) - t, inside - v - turns]).T
        reached = (np.abs(off) <= TOUCH * units).all(axis=-1)
        return [Placed(int(chosen[k]), np.array([t, v + turns[k]]), off[k]) for k in which(reached)]

    def _interval_at(self, chosen: Ints, start: Floats, end: Floats, t: float) -> Floats:
        """Lower and upper root of cells at one base value; on a line what is meant is `ends`."""
        inset = SAME_POINT * (end - start)
        inside = np.minimum(np.maximum(t, start + inset), end - inset)
        found, ends = self.interval(chosen, inside[:, None])[..., 0], self.ends[chosen]
        found = np.where(t <= start + inset, ends[:, 0].T, found)
        return np.where(t >= end - inset, ends[:, 1].T, found)

    def _ends(self) -> tuple[Floats, Floats]:
        """Lower and upper root of every cell at its left and its right line, and their errors.

        Shape (k, 2, 2) both. There an angle may jump by a turn, and where a form vanishes on a
        whole fibre it has no roots to speak of: their limit from inside the slab is meant. Of a
        slab so narrow that no double is surely inside, it is the turn that was counted that tells.
        """
        lines = self.decomposition.critical
        start, end = self.abscissae[:-1][self.slabs, None], self.abscissae[1:][self.slabs, None]
        inset = (end - start) * INSET
        t = np.concatenate([start + inset, end - inset], axis=1)
        roots = self.roots.swapaxes(0, 1)
        c = self.plane.coefficients(roots[..., 0], t)
        values = self.plane.values(roots, c).reshape(2, -1, 2, 4)
        at, near = values[..., 0], values[..., 1]
        radius = lines.radius[self.slabs[:, None] + np.array([0, 1])]
        if self.plane.lift_kind == "revolute":
            counted = self.plane.follow(roots, self.decomposition.inside[self.slabs, None])
            doubt = 8 * radius + 64 * UNIT * np.abs(t[:, ::4])
            near = np.where(inset[:, 1:2] > doubt, near, counted)
            at = at + TURN * whole_turns(near - at)
        blank = self.plane.blank(roots[..., 0], c[..., ::4])
        if blank.any():
            at = np.where(blank, 3 * near - 3 * values[..., 2] + values[..., 3], at)
        radius = radius / self.plane.base_unit
        form = np.maximum(roots[..., 0], 0)[..., None] * np.ones(2, dtype=np.int64)
        if len(self.plane.eps):
            _, errors, _ = self.plane.roots_and_errors(form, c[..., ::4], 2 * radius)
            error = np.where(roots[..., 1, None] < 0, errors[0], errors[1])
            error = np.where(blank, 1.0, error)
        else:
            error = np.zeros_like(at)
        error = np.where(roots[..., 0, None] < 0, 2 * UNIT * np.abs(at), error)
        ends = np.array([at[0], np.maximum(*at)]).transpose(1, 2, 0)
        return ends, np.minimum(error, self.plane.lift_unit).transpose(1, 2, 0)

    # --- lines ----------------------------------------------------------------------------------

    def _elements(self) -> Elements:
        """Cut the lines where cells end, and tell which cells lie on both sides of each part.

        Those with cells on both sides are joined, as far as is known here.
        """
        kept = which(~self.whole)
        cuts = self._cut(kept)
        line, low = cuts.line, cuts.v
        begin, last = runs(line)
        count = np.bincount(line, minlength=self.n_lines)
        self._begin, self._count = np.searchsorted(line, np.arange(self.n_lines)), count
        owner = np.full((2, len(line)), -1)
        for s in (0, 1):  # the left line of a cell is on its right-hand side
            at = self.slabs[kept] + s
            at = at % self.n_lines if self.wrapped else at
            self._own(owner[1 - s], kept, at, self._place[kept, s], s)
        high, elements = np.append(low[1:], 0.0)[: len(low)], np.ones(len(line), dtype=np.bool_)
        upper = np.arange(1, len(line) + 1)
        upper[last] = begin
        if self.circle:  # a line on which nothing ends is one element
            high[last] = low[begin] + TURN
            without = which(count == 0)
            line = np.concatenate([line, without])
            low = np.concatenate([low, np.full(len(without), -math.pi)])
            high = np.concatenate([high, np.full(len(without), math.pi)])
            owner = np.concatenate([owner, np.full((2, len(without)), -1)], axis=1)
            elements = np.ones(len(line), dtype=np.bool_)
        else:
            elements[last] = False
        self._fill_whole(owner, line)
        self._number = np.where(elements, elements.cumsum() - 1, -1)
        self._cuts, self._following = cuts, upper
        line, low, high, owner = line[elements], low[elements], high[elements], owner[:, elements]
        turns = self._turns(line, (low + high) / 2, owner)
        return Elements(line, low, high, owner, turns, np.asarray((owner >= 0).all(axis=0)))

    def _join(self) -> None:
        """Leave those elements joined that are free between the two cells."""
        found, own = self.elements, which(self.elements.joined)
        found.joined[own] = self.decomposition.joined(
            found.line[own], lambda k, part: self.place(int(own[k]), part)
        )

    def place(self, element: int, part: float) -> Any:
        """Return a lift value a part of the way up an element, exact: see `Decomposition.joined`.

        It is a double where these tell both ends apart, and else a function of the number of bits.
        """
        low, high = float(self.elements.low[element]), float(self.elements.high[element])
        lower, cuts = int(self._spot[element]), self._cuts
        if lower >= len(cuts.line):  # a whole circle
            return low + part * (high - low)
        upper = int(self._following[lower])
        if high - low > 1e3 * (cuts.error[lower] + cuts.error[upper]):
            return low + part * (high - low)

        def between(bits: int) -> Any:
            one = cuts.ball(self.decomposition, lower, low, bits)
            return one + part * (cuts.ball(self.decomposition, upper, high, bits) - one)

        return between

    def _cut(self, kept: Ints) -> _Ends:
        """Return the places at which lines are cut, by line and upwards, one end for each.

        And note for each cell at which of them its two ends are, on either line: `_place`.
        """
        own, marks = self._cell_ends(kept), self._marks()
        every: list[Any] = [np.concatenate(x) for x in zip(own, marks, strict=True)]
        order = np.lexsort([every[1], every[0]])
        sorted_ends = _Ends(*(x[order] for x in every))
        rank, v = _Ranks(self.decomposition, sorted_ends, self.circle).ranked()
        first = np.full(rank.max(initial=-1) + 1, -1)
        first[rank[::-1]] = np.arange(len(rank))[::-1]
        number = (first >= 0).cumsum() - 1
        first = first[first >= 0]
        place = np.empty(len(order), dtype=np.int64)
        place[order] = number[rank]
        self._place: Ints = np.full((len(self.slabs), 2, 2), -1)
        self._place[kept] = place[: len(own.line)].reshape(-1, 2, 2)
        cuts: list[Any] = [x[first] for x in sorted_ends._replace(v=v)]
        return _Ends(*cuts)

    def _cell_ends(self, kept: Ints) -> _Ends:
        """Return both ends of cells at their left and at their right line."""
        line = self.slabs[kept, None] + np.array([0, 1])
        line = line % self.n_lines if self.wrapped else line
        value = self.ends[kept].reshape(-1)
        side, end = (np.tile(x, len(kept)) for x in ([0, 0, 1, 1], [0, 1, 0, 1]))
        return _Ends(
            line.repeat(2, axis=1).reshape(-1),
            self._turned(value),
            self._errors[kept].reshape(-1),
            side,
            self.roots[kept.repeat(4), end],
        )

    def _turned(self, v: Floats) -> Floats:
        """Bring angles of a lift that closes into (-pi, pi]."""
        return np.asarray(math.pi - (math.pi - v) % TURN if self.circle else v)

    def _marks(self) -> _Ends:
        """Return where contacts along a fibre may begin or end: their side conditions vanish.

        One that vanishes on the whole fibre begins and ends nothing.
        """
        plane, found = self.plane, self.decomposition
        first = plane.count + len(plane.contacts.forms)
        last = self.n_lines if self.wrapped else -1  # the first line, a turn on
        marked = [
            (line, SIDES * (row - plane.count) + side)
            for line, rows in found.standing.items()
            for row in rows
            for side in range(SIDES)
            if line != last
            and row >= plane.count
            and plane.sides[row - plane.count, side, :, 1:].any()
        ]
        marked = [
            (line, number)
            for line, number in marked
            if not vanishes_on(found.critical, line, first + number, found.precise)
        ]
        line, number = np.array(marked, dtype=np.int64).reshape(-1, 2).T
        t, radius = self.abscissae[line], found.critical.radius[line]
        values, errors, real = plane.side_roots(number, t, radius)
        branch, k = np.nonzero(np.isfinite(values) & (real >= 0))
        v, (low, high) = values[branch, k], plane.lift_ends
        inside = np.arange(len(v)) if self.circle else which((v > low) & (v < high))
        branch, k, v = branch[inside], k[inside], v[inside]
        root = np.stack([first + number[k], 2 * branch - 1, np.zeros_like(k)], axis=1)
        return _Ends(line[k], self._turned(v), errors[branch, k], np.zeros_like(k), root)

    def _own(self, owner: Ints, kept: Ints, line: Ints, place: Ints, side: int) -> None:
        """Write each cell into the parts of a line between its two ends."""
        start, stop = place[:, 0], place[:, 1]
        first, count = self._begin[line], self._count[line]
        steps = stop - start
        if self.circle:
            tall = (self.ends[kept, side, 1] - self.ends[kept, side, 0]) > math.pi
            steps = np.where((steps < 0) | ((steps == 0) & tall), steps + count, steps)
        if (steps < 0).any():
            raise UndecidedError("a cell ends above its upper end")
        cell, step = ranges(np.zeros_like(steps), steps)
        spot = first[cell] + (start[cell] - first[cell] + step) % np.maximum(count[cell], 1)
        if np.bincount(spot, minlength=1).max() > 1:
            raise UndecidedError("two cells overlap on a critical line")
        owner[spot] = kept[cell]

    def _fill_whole(self, owner: Ints, line: Ints) -> None:
        """Write cells that are whole circles into all parts of their lines."""
        for cell in which(self.whole).tolist():
            slab = int(self.slabs[cell])
            for s, at in ((1, slab), (0, slab + 1)):
                own = at % self.n_lines if self.wrapped else at
                owner[s, line == own] = cell

    def _turns(self, line: Ints, middle: Floats, owner: Ints) -> Ints:
        """Return the full turns that bring parts of lines into the cells beside them, (2, n)."""
        turns = np.zeros(owner.shape, dtype=np.int64)
        if not self.circle or not len(self.slabs):
            return turns
        for s in (0, 1):  # a cell on the left ends at its right line
            cell = owner[s]
            low = self.ends[np.maximum(cell, 0), 1 - s, 0]
            found = np.ceil((low - middle) / TURN - TOUCH)
            turns[s] = np.where(cell >= 0, found, 0)
        return turns

    def in_order(self, cell: Ints, side: int, element: Ints) -> Ints:
        """Count the elements beside cells, on their left (0) or right (1), upwards from each."""
        line = self.elements.line[element]
        count = np.maximum(self._count[line], 1)
        spot = self._spot[element]
        start = np.where(self.whole[cell], self._begin[line], self._place[cell, side, 0])
        return np.asarray((spot - start) % count)

    @cached_property
    def is_circle(self) -> Bools:
        """Which elements are whole circles: of lines on which no cell ends."""
        return np.asarray(self._count[self.elements.line] == 0)

    @cached_property
    def _spot(self) -> Ints:
        """The place of each element's lower end."""
        spot = np.zeros(len(self.elements.line), dtype=np.int64)
        kept = which(self._number >= 0)
        spot[self._number[kept]] = kept
        return spot

    # --- components -----------------------------------------------------------------------------

    def _neighbours(self) -> list[list[tuple[int, int, int]]]:
        """Return of each cell those joined to it, and the base and lift turns to their windings."""
        k, found = which(self.elements.joined), self.elements
        base = ((found.line[k] == 0) & self.wrapped).astype(int)
        lift = found.turns[0, k] - found.turns[1, k]
        neighbours: list[list[tuple[int, int, int]]] = [[] for _ in self.slabs]
        joins = zip(*found.cell[:, k].tolist(), base.tolist(), lift.tolist(), strict=True)
        for a, b, base_turns, lift_turns in joins:
            neighbours[a].append((b, base_turns, lift_turns))
            neighbours[b].append((a, -base_turns, -lift_turns))
        return neighbours

    @cached_property
    def parts(self) -> Parts:
        """The components as sets of cells."""
        neighbours, whole = self._neighbours(), self.whole
        windings, cells, wraps = dict[int, tuple[int, int]](), [], []
        for start in range(len(self.slabs)):
            if start not in windings:
                own, around_base, around_lift = _spread(start, neighbours, windings)
                cells.append(own)
                wraps.append((around_base, around_lift or bool(whole[own].any())))
        table = np.zeros((len(self.slabs), 2), dtype=np.int64)
        if windings:
            table[list(windings)] = list(windings.values())
        return Parts(cells, wraps, table)


class _Ranks:
    """The order of ends of cells on critical lines; ends that are one have one rank.

    Parameters
    ----------
    found : Decomposition
    ends : _Ends
        By line and upwards.
    circle : bool
        Whether the lift closes.
    """

    def __init__(self, found: Decomposition, ends: _Ends, circle: bool) -> None:
        self.found, self.circle, self.ends = found, circle, ends
        self.line, self.v, self.error, self.side, self.root = ends

    def ranked(self) -> tuple[Ints, Floats]:
        """Return of each end the number of the first that is one with it, in order; and values.

        Numbers ascend along each line from the lowest value; ends that are one with those a turn
        below, across the cut of a circle, have the number of the first.
        """
        line, v, error, n = self.line, self.v.copy(), self.error, len(self.line)
        rank = np.arange(n)
        if not n:
            return rank, v
        close = np.zeros(n, dtype=np.bool_)
        close[1:] = (line[1:] == line[:-1]) & ((v - error)[1:] <= (v + error)[:-1])
        first, last = runs(line)
        clusters = [list(range(a, b + 1)) for a, b in zip(*runs((~close).cumsum()), strict=True)]
        clusters = [own for own in clusters if len(own) > 1]
        seams = []
        if self.circle:
            wraps = (last > first) & ((v + error)[last] >= (v - error)[first] + TURN)
            seams = [(int(first[k]), int(last[k])) for k in which(wraps)]
        shift = dict[int, float]()
        for a, b in seams:
            tail = next((c for c in clusters if c[-1] == b), [b])
            head = next((c for c in clusters if c[0] == a), [a])
            if tail[0] == a:
                continue
            clusters = [c for c in clusters if c is not tail and c is not head]
            clusters.append(tail + head)
            shift |= dict.fromkeys(tail, -TURN)
        position = np.arange(n, dtype=float)
        for own in clusters:
            groups = self._groups(own, [float(v[k]) + shift.get(k, 0.0) for k in own])
            # Groups stand one behind the other between the rows before and behind the cluster.
            low = min(k for k in own if k not in shift) - any(k in shift for k in own)
            for g, group in enumerate(groups):
                best = min(group, key=lambda k: error[k])
                value = v[best] + shift.get(best, 0.0)
                position[group] = low + (g + 1) / (len(groups) + 1)
                v[group] = value
        order = np.lexsort([position, line])
        change = np.ones(n, dtype=np.bool_)
        change[1:] = (np.diff(position[order]) != 0) | (np.diff(line[order]) != 0)
        rank[order] = change.cumsum() - 1
        return rank, v

    def _groups(self, own: list[int], values: list[float]) -> list[list[int]]:
        """Return ends of one line in their true order, those that are one together."""
        if self._are_one(own):
            return [own]
        near = dict(zip(own, values, strict=True))

        def ball(k: int, bits: int) -> Any:
            return self.ends.ball(self.found, k, near[k], bits)

        names = [(*self.root[k, :2].tolist(), int(self.side[k])) for k in own]
        return [group for _, group in in_order(own, ball, names)]

    def _are_one(self, own: list[int]) -> bool:
        """Tell whether the line's events themselves say that ends are one.

        Where curves meet, one branch of each does; both branches of one meet where it folds.
        """
        found, line = self.found, int(self.line[own[0]])
        ends = {(self._curve(int(self.root[k, 0])), int(self.root[k, 1])) for k in own}
        curves = {curve for curve, _ in ends}
        if len(ends) == 1:
            return True
        if line in found.critical.known:  # balls decided it: leave this to them, too
            return False
        events, members = found.critical.events, found.critical.members[line]
        plane = found.plane
        first = plane.count + len(plane.contacts.forms)
        groups: dict[Any, set[Any]] = {}
        folds: set[Any] = set()
        for k in members:
            key = int(events.key[k])
            together = groups.setdefault(("key", key) if key >= 0 else ("event", k), set())
            rows = events.what[k, 1:].tolist()
            if events.what[k, 0] in FOLDS:
                folds.add(self._curve(int(rows[0])))
            if key >= 0:  # a contact goes over from any of these to any other
                rows += (plane.count + which((plane.contacts.keys == key).any(axis=1))).tolist()
            together |= {self._curve(int(row)) for row in rows if row < first}
        both = {curve for curve in curves if {(curve, -1), (curve, 1)} <= ends}
        return both <= folds and any(curves <= group for group in groups.values())

    def _curve(self, form: int) -> tuple[int, int]:
        count, contacts = self.found.plane.count, self.found.plane.contacts
        if form >= count + len(contacts.forms):
            return 2, form
        if form >= count:
            return 1, int(self.found.plane.contacts.curves[form - count])
        return 0, form


def _spread(
    start: int,
    neighbours: list[list[tuple[int, int, int]]],
    windings: dict[int, tuple[int, int]],
) -> tuple[list[int], bool, bool]:
    """Give the cells of a component their windings; return them, and what it goes round.

    It goes round base or lift where two ways to a cell end at different windings.
    """
    windings[start] = 0, 0
    cells, queue = [start], [start]
    around_base = around_lift = False
    while queue:
        a = queue.pop()
        base, lift = windings[a]
        for b, base_turns, lift_turns in neighbours[a]:
            winding = base + base_turns, lift + lift_turns
            known = windings.setdefault(b, winding)
            if known is winding:
                cells.append(b)
                queue.append(b)
            elif known != winding:
                around_base |= known[0] != winding[0]
                around_lift |= known[1] != winding[1]
    return cells, around_base, around_lift
