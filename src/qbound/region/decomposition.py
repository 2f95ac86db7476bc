"""Cells of two joints in which every form is positive and all bodies are apart.

A cylindrical decomposition. For a fixed value of one joint, the base, each form is a one-joint form
in the other, the lift, and Theorem 2 (or the quadratic formula) gives its roots. How these roots
lie to each other changes only at critical base values, and each kind of these is a root of one
univariate polynomial (`critical`). Of bodies only contacts count (`pieces`): along the lift the
number of pairs in collision goes up or down by one at each. No grid, no sample, no starting guess.

Doubles decide where their error bounds allow it; balls decide the rest (`precise`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.boundary.contacts import SIDES
from qbound.forms.angles import TURN, turns_up_to
from qbound.region.critical import NO_EVENTS, Events, Finder, Lines, find_lines
from qbound.region.pieces import END, INSIDE, Pieces, crossings, find_pieces
from qbound.region.plane import HIGHEST, LOWEST, Plane, Root, Separation, ranges, runs, which
from qbound.region.precise import (
    LEVELS,
    NUMBER,
    Precise,
    UndecidedError,
    in_order,
    midpoint,
    precision,
)
from qbound.tolerances import BEYOND_JUMP, SAME_POINT, UNCHANGED, UNIT

Rows = tuple[Ints, Floats, Floats, Ints, Ints]
"""Slab, lift value, its error, root and contact of roots."""

PLACES = (0.29, 0.5, 0.77)
"""Parts of an element at which it is asked whether bodies touch there; one place may be special."""


class Cell(NamedTuple):
    """A piece of the plane over one slab, between two roots, in which every form is positive.

    On a lift that turns round, a cell from end to end is the whole fibre and has no boundary.
    """

    slab: int
    lower: Root
    upper: Root


@dataclass(frozen=True, eq=False)
class Decomposition:
    """Slabs between critical base values, and the feasible cells over them.

    Attributes
    ----------
    plane : Plane
    critical : Lines
        Slab i lies between lines i and i + 1.
    inside : ndarray, shape (s,)
        A base value inside each slab: there the full turns of its roots were counted.
    slabs : ndarray of int, shape (k,)
        Slab of each cell, ascending.
    roots : ndarray of int, shape (k, 2, 3)
        Lower and upper root of each cell, as `Root`.
    sets : ndarray of int, shape (k, 2)
        Which rows vanish along both: a number in `names`.
    names : list of tuple of int
        Rows that coincide along a curve.
    standing : dict of int to tuple of int
        Of each line at which a form vanishes on the whole fibre, these rows.
    """

    plane: Plane
    critical: Lines
    inside: Floats
    slabs: Ints
    roots: Ints
    sets: Ints
    names: list[tuple[int, ...]]
    standing: dict[int, tuple[int, ...]]

    @property
    def lines(self) -> Floats:
        """Critical base values, ascending, shape (s + 1,)."""
        return self.critical.t

    @property
    def precise(self) -> Precise:
        """What decides where doubles cannot."""
        return self.critical.finder.precise

    @cached_property
    def cells(self) -> list[Cell]:
        """The cells one by one."""
        rows = zip(self.slabs.tolist(), self.roots.tolist(), strict=True)
        return [Cell(slab, Root(*lower), Root(*upper)) for slab, (lower, upper) in rows]

    def joined(self, line: Ints, place: Callable[[int, float], Any]) -> Bools:
        """Tell whether what is free on both sides of parts of lines is so on them.

        A form is zero there only where it vanishes on the whole fibre; bodies may touch on a part.

        Parameters
        ----------
        place : callable
            Of a row and a number from 0 to 1: lift value so far between both ends, a number or a
            function of the number of bits.
        """
        free = np.ones(len(line), dtype=np.bool_)
        if not self.standing:
            return free
        count = self.plane.count
        for k in which(np.isin(line, list(self.standing))).tolist():
            rows = self.standing[int(line[k])]
            if any(row < count for row in rows):
                free[k] = False
                continue
            pairs = {int(self.plane.contacts.pair[row - count]) for row in rows}
            t, places = self._ball(int(line[k])), [place(k, part) for part in PLACES]
            free[k] = any(all(apart(self.precise, p, t, v) for p in pairs) for v in places)
        return free

    def _ball(self, line: int) -> Any:
        return lambda bits: self.critical.ball(line, bits)


def decompose(precise: Precise) -> Decomposition:
    """Find all critical base values and all feasible cells of a plane.

    Raises
    ------
    UndecidedError
        If something of the structure could not be decided.
    """
    plane = precise.plane
    finder = Finder(plane, precise)
    pieces = find_pieces(plane, finder)
    lines = critical_lines(plane, pieces, finder)
    standing = _standing(plane, lines, pieces, finder)
    fibres = _Fibres(plane, lines, pieces, precise)
    found = Decomposition(plane, lines, fibres.t, *fibres.cells(), standing)
    return _without_idle_lines(found)


def nothing_in(precise: Precise) -> Decomposition:
    """Return a decomposition without cells."""
    plane = precise.plane
    lines = find_lines(Finder(plane, precise), NO_EVENTS)
    none, roots = np.zeros(0, dtype=np.int64), np.zeros((0, 2, 3), dtype=np.int64)
    inside, sets = np.zeros(len(lines.t) - 1), np.zeros((0, 2), dtype=np.int64)
    return Decomposition(plane, lines, inside, none, roots, sets, [], {})


# --- critical base values -------------------------------------------------------------------------


def critical_lines(plane: Plane, pieces: Pieces, finder: Finder) -> Lines:
    """Return every base value at which the order of roots may change, with both ends of the range.

    Some are spurious, which costs time; none is missing, which would cost the answer.
    """
    every = pieces.events
    found = [every, finder.isolated(finder.events(_of_forms(plane, finder)))[1]]
    if plane.contacts.pairs:
        found.append(finder.isolated(crossings(plane, pieces, finder))[1])
    used = np.zeros(len(every), dtype=np.bool_)
    used[pieces.lines] = True
    # All events stay, so that pieces know theirs; those that are no lines are left out of them.
    events = Events.joined(found)
    chosen = np.concatenate([which(used), len(every) + np.arange(len(events) - len(every))])
    lines = find_lines(finder, events[chosen])
    of = np.full(len(events), -1)
    of[chosen] = lines.of
    return replace(lines, of=of)


def _of_forms(plane: Plane, finder: Finder) -> list[Any]:
    """Return the events of forms that stand alone, and those at which two of them meet."""
    table = plane.scaled[: plane.count]
    lifts = table[:, :, 1:].any(axis=(1, 2))
    fixed, moved = which(~lifts), which(lifts)
    every = np.arange(len(moved))
    i, j = np.nonzero(every[:, None] < every)
    return [
        *finder.fixed(fixed),
        *finder.own(moved),
        *finder.meetings(moved[i], moved[j]),
    ]


def _standing(
    plane: Plane, lines: Lines, pieces: Pieces, finder: Finder
) -> dict[int, tuple[int, ...]]:
    """Return for each line the rows that vanish on its whole fibre, where there are such."""
    found: dict[int, set[int]] = {}
    last = len(lines.t) - 1
    for event in pieces.walls.tolist():
        if lines.of[event] >= 0:
            found.setdefault(int(lines.of[event]), set()).add(int(pieces.events.what[event, 1]))
    own = {NUMBER[kind] for kind in ("fold circle", "fold line", "first", "second")}
    what, members = lines.events.what, lines.members
    candidates = [
        (line, int(what[k, 0]), int(what[k, 1]))
        for line, inner in enumerate(members)
        for k in inner
        if what[k, 1] < plane.count and (what[k, 0] in own or what[k, 0] == NUMBER["constant"])
    ]
    lifts: Any = plane.scaled[: plane.count, :, 1:].any(axis=(1, 2))
    for line, _, row in candidates:
        if row in found.get(line, ()):
            continue
        if not lifts[row] or _is_blank(plane, lines, line, row, finder.precise):
            found.setdefault(line, set()).add(row)
    if plane.base_range is None and (0 in found or last in found):
        both = found.get(0, set()) | found.get(last, set())
        found[0] = found[last] = both
    return {line: tuple(sorted(rows)) for line, rows in found.items()}


def _is_blank(plane: Plane, lines: Lines, line: int, row: int, precise: Precise) -> bool:
    """Tell whether a form vanishes on a whole fibre."""
    c = plane.coefficients(np.array([row]), lines.t[line : line + 1][:, None])[:, 0, 0]
    scaled = np.abs(c) * plane.lift_unit ** np.arange(3)
    doubt = plane.eps[row] + 16 * UNIT + 4 * lines.radius[line] / plane.base_unit
    if (scaled > doubt * max(1.0, plane.scaled_size[row])).any():
        return False
    return vanishes_on(lines, line, row, precise)


def vanishes_on(lines: Lines, line: int, row: int, precise: Precise) -> bool:
    """Tell in balls whether a row, also of a side condition, vanishes on the fibre over a line."""
    for bits in LEVELS:
        with precision(bits):
            if not all(
                x.contains(0) for x in precise.along_lift(row, lines.ball(line, bits), bits)
            ):
                return False
    return True


# --- fibres ---------------------------------------------------------------------------------------


def apart(precise: Precise, pair: int, t: Any, v: Any, beside: int = 0) -> bool:
    """Tell in balls whether a pair of bodies is apart at a configuration: a clause of it shows it.

    Touching is not apart. `t` and `v` are numbers, or functions of the number of bits; `beside` is
    that of `Precise.sign`.
    """
    contacts, plane = precise.plane.contacts, precise.plane
    rows = which(contacts.pair == pair)
    first, side = plane.count, plane.count + len(contacts.forms)

    for clause in np.unique(contacts.clause[rows]):
        own = rows[contacts.clause[rows] == clause]
        if all(precise.sign(first + int(k), t, v, beside) > 0 for k in own) and all(
            precise.sign(side + SIDES * int(k) + s, t, v, beside) >= 0
            for k in own
            if contacts.corners[k]
            for s in range(SIDES)
            if contacts.keys[k, s] >= 0
        ):
            return True
    return False


class _Fibres:
    """What bounds cells over one base value inside each slab: roots in order, equal ones together.

    Attributes
    ----------
    t : ndarray, shape (slabs,)
        Base values, one inside each slab.
    exact : dict of int to arb
        Those that no double names.
    slab, values, errors : ndarray, shape (n,)
        Roots by slab, and upwards; lift values, and bounds of their errors.
    roots : ndarray of int, shape (n, 3)
        As `Root`.
    piece : ndarray of int, shape (n,)
        Which contact; -1 for a root of a form that stands alone, and for an end.
    group : ndarray of int, shape (n,)
        Roots with one number are one place, as far as 1,024 bits can tell.
    circle : bool
        Whether the lift closes: after a slab's last root comes its first, a turn on.
    """

    def __init__(self, plane: Plane, lines: Lines, pieces: Pieces, precise: Precise) -> None:
        self.plane, self.lines, self.pieces, self.precise = plane, lines, pieces, precise
        self.circle = plane.lift_range is None
        self._known: dict[Any, list[list[int]]] = {}
        self.t, self.exact = self._bases()
        self._gather()
        self._order()

    def _bases(self) -> tuple[Floats, dict[int, Any]]:
        """Return a base value inside each slab; an exact one where doubles are too near."""
        lines, exact = self.lines, dict[int, Any]()
        # Off the middle where bodies touch, because it may be a place of symmetry.
        part = INSIDE if self.plane.contacts.pairs else 0.5
        widths = lines.t[1:] - lines.t[:-1]
        t = lines.t[:-1] + part * widths
        doubt = 8 * (lines.radius[1:] + lines.radius[:-1]) + 64 * UNIT * np.abs(t)
        for k in which(widths <= doubt).tolist():
            a, b = (lines.ball(line, LEVELS[-1]) for line in (k, k + 1))
            with precision(LEVELS[-1]):
                exact[k] = midpoint(a, b)
            t[k] = float(exact[k].mid())
        return t, exact

    def base(self, slab: int) -> Any:
        """Return the exact base value of a slab."""
        from flint import arb

        found = self.exact.get(slab)
        return arb(float(self.t[slab])) if found is None else found

    def _gather(self) -> None:
        """Find the roots in the lift's range and its ends; on a circle without roots, its cut."""
        parts = [self._of_forms()]
        if self.plane.contacts.pairs:
            parts.append(self._of_contacts())
        rows: list[Any] = [np.concatenate(x) for x in zip(*parts, strict=True)]
        self.slab, self.values, self.errors, self.roots, self.piece = self._in_range(*rows)
        self._take(np.lexsort([self.values, self.slab]))

    def _of_forms(self) -> Rows:
        """Return the roots of forms that stand alone."""
        plane, m = self.plane, self.plane.count
        found, errors, real = plane.roots_and_errors(np.arange(m), plane.along_lift(self.t))
        real = np.where(plane.scaled[:m, :, 1:].any(axis=(1, 2)), real, -1)
        for k, row in np.argwhere(real == 0).tolist():
            base = self.base(k)
            real[k, row] = 1 if self.precise.real(row, lambda bits, b=base: b) >= 0 else -1
        there = np.broadcast_to(real > 0, found.shape).copy()
        if plane.lift_kind == "prismatic":
            there[1] &= ~plane.affine[:m]
        branch, slab, form = np.nonzero(there)
        roots = np.stack([form, 2 * branch - 1, np.zeros_like(form)], axis=1)
        none = np.full(len(form), -1)
        return slab, found[branch, slab, form], errors[branch, slab, form], roots, none

    def _of_contacts(self) -> Rows:
        """Return the roots at which bodies touch."""
        plane, (k, slab) = self.plane, self._alive()
        roots = self.pieces.roots(plane, k)
        c = plane.coefficients(roots[:, 0], self.t[slab][:, None])[:, :, 0]
        values, errors, _ = plane.roots_and_errors(roots[:, 0], c)
        side, every = (roots[:, 1] > 0).astype(int), np.arange(len(k))
        return slab, values[side, every], errors[side, every], roots, k

    def _in_range(self, *rows: Any) -> Rows:
        """Put roots into the lift's range, on as many turns as it has, and its ends with them."""
        slab, values, errors, roots, piece = rows
        plane, every = self.plane, np.arange(len(self.t))
        low, high = plane.lift_ends
        if self.circle:
            roots[:, 2] = turns_up_to(low, values).astype(np.int64)
            values = values + TURN * roots[:, 2]
            ends = [(which(np.bincount(slab, minlength=len(every)) == 0), low, LOWEST)]
        else:
            first = last = np.zeros(len(values), dtype=np.int64)
            if plane.lift_kind == "revolute":
                first = turns_up_to(low - errors, values).astype(np.int64)
                last = turns_up_to(high + errors, values).astype(np.int64)
            else:
                last = last + 1
            pick, turns = ranges(first, last)
            slab, errors, roots, piece = (x[pick] for x in (slab, errors, roots, piece))
            values, roots[:, 2] = values[pick] + TURN * turns, turns
            inside = which((values > low - errors) & (values < high + errors))
            slab, values, errors, roots, piece = (
                x[inside] for x in (slab, values, errors, roots, piece)
            )
            ends = [(every, low, LOWEST), (every, high, HIGHEST)]
        parts: list[Rows] = [(slab, values, errors, roots, piece)]
        for where, value, root in ends:
            n = len(where)
            error = np.full(n, 2 * UNIT * abs(value))
            both = np.tile(root, (n, 1)).astype(np.int64)
            parts.append((where, np.full(n, value), error, both, np.full(n, -1)))
        found: list[Any] = [np.concatenate(x) for x in zip(*parts, strict=True)]
        slab, values, errors, roots, piece = found
        return slab, values, errors, roots, piece

    def _alive(self) -> tuple[Ints, Ints]:
        """Return the pieces over each slab, and the slab, in pairs."""
        pieces, of, last = self.pieces, self.lines.of, len(self.lines.t) - 1
        start = np.append(of, 0)[np.where(pieces.first == END, len(of), pieces.first)]
        end = np.append(of, last)[np.where(pieces.last == END, len(of), pieces.last)]
        if (start < 0).any() or (end < 0).any():
            raise UndecidedError("where a contact begins or ends")
        if self.plane.base_range is None:
            end = np.where((end == 0) & (pieces.last != END), last, end)
        return ranges(start, end)

    def _take(self, rows: Ints) -> None:
        self.slab, self.values, self.errors = self.slab[rows], self.values[rows], self.errors[rows]
        self.roots, self.piece = self.roots[rows], self.piece[rows]

    # --- order ----------------------------------------------------------------------------------

    def _order(self) -> None:
        """Give places of roots their numbers: doubles decide what they can, balls the rest."""
        reach, least = self.values + self.errors, self.values - self.errors
        n, curve = len(self.slab), self._curves()
        close = np.zeros(n, dtype=np.bool_)  # whether a row may be no higher than the one before
        close[1:] = (self.slab[1:] == self.slab[:-1]) & (least[1:] <= reach[:-1])
        self.group = (~close).cumsum() - 1
        # Roots of one curve are one; where others are as near, balls decide.
        doubtful = which(close & (curve != np.roll(curve, 1)))
        first, last = runs(self.slab)
        seams = which(reach[last] >= least[first] + TURN) if self.circle else doubtful[:0]
        seams = seams[last[seams] > first[seams]]
        if not len(doubtful) and not len(seams):
            return
        starts, ends = runs(self.group)
        clusters = {
            int(starts[g]): list(range(starts[g], ends[g] + 1))
            for g in np.unique(self.group[doubtful]).tolist()
        }
        order, leader = list(range(n)), starts[self.group].tolist()
        across: list[tuple[int, list[int], list[int]]] = []  # at the cut of a circle
        for k in seams.tolist():
            a, b = int(first[k]), int(last[k])
            head = list(range(a, ends[self.group[a]] + 1))
            tail = list(range(starts[self.group[b]], b + 1))
            if tail[0] != a:
                clusters.pop(head[0], None)
                clusters.pop(tail[0], None)
                across.append((a, head, tail))
        for cluster in clusters.values():
            flat = self._led(cluster, leader, {})
            for spot, row in zip(cluster, flat, strict=True):
                order[spot] = row
        for a, head, tail in across:  # the tail stands a turn earlier, at the front
            flat = self._led(tail + head, leader, dict.fromkeys(tail, -TURN))
            self.values[tail] -= TURN
            self.roots[tail, 2] -= 1
            rest = order[a + len(head) : tail[0]]
            order[a : tail[-1] + 1] = flat + rest
        if not self.circle:
            dropped = self._beyond_ends(order, leader)
            order = [row for row in order if row not in dropped]
        new = np.array(order)
        led = np.array(leader)[new]
        self._take(new)
        change = np.ones(len(new), dtype=np.bool_)
        change[1:] = led[1:] != led[:-1]
        self.group = change.cumsum() - 1

    def _led(self, cluster: list[int], leader: list[int], shift: dict[int, float]) -> list[int]:
        """Return rows of a cluster in order, and write the first of those that are one for each."""
        values = [float(self.values[row]) + shift.get(row, 0.0) for row in cluster]
        groups = self._ranked(cluster, values)
        for group in groups:
            for row in group:
                leader[row] = group[0]
        return [row for group in groups for row in group]

    def _curves(self) -> Ints:
        """Give the curves that roots follow numbers: features of one curve have one."""
        form, branch, count = self.roots[:, 0], self.roots[:, 1], self.plane.count
        curves = self.plane.contacts.curves
        most = curves.max(initial=0) + 1
        number = np.append(curves, 0)[np.clip(form - count, 0, len(curves))]
        return np.asarray(3 * np.where(form >= count, number, most + 2 + form) + branch)

    def _beyond_ends(self, order: list[int], leader: list[int]) -> set[int]:
        """Return rows that lie below the lower end of the lift's range, or above the upper one."""
        dropped: set[int] = set()
        place = {row: k for k, row in enumerate(order)}
        slab = self.slab
        lows = {int(slab[r]): r for r in which(self.roots[:, 0] == LOWEST.form).tolist()}
        highs = {int(slab[r]): r for r in which(self.roots[:, 0] == HIGHEST.form).tolist()}
        for row in order:
            low, high = lows[int(slab[row])], highs[int(slab[row])]
            below = place[row] < place[low] and leader[row] != leader[low]
            if below or (place[row] > place[high] and leader[row] != leader[high]):
                dropped.add(row)
        return dropped

    def _ranked(self, rows: Sequence[int], values: Sequence[float]) -> list[list[int]]:
        """Return rows of one slab in their true order, those that are one together."""
        base = self.base(int(self.slab[rows[0]]))
        near = dict(zip(rows, values, strict=True))
        # Roots that the base does not move are in one order over all slabs.
        key = tuple((*self.roots[row, :2].tolist(), round(8 * near[row])) for row in rows)
        if key not in self._known:
            places = range(len(rows))
            groups = in_order(
                places,
                lambda k, bits: self.root(rows[k], base, bits, near[rows[k]]),
                [self._curve(row) for row in rows],
            )
            found = [own for _, own in groups]
            if not all(self.precise.is_still(form) for form, _, _ in key):
                return [[rows[k] for k in own] for own in found]
            self._known[key] = found
        return [[rows[k] for k in own] for own in self._known[key]]

    def _curve(self, row: int) -> tuple[int, int, int]:
        """Name the curve that a root follows: features of one curve have one name."""
        form, branch, _ = self.roots[row].tolist()
        count = self.plane.count
        if form >= count:
            return 1, int(self.plane.contacts.curves[form - count]), branch
        return 0, form, branch

    def root(self, row: int, base: Any, bits: int, near: float) -> Any:
        """Return a root as a ball, on the turn that is near to a value."""
        form, branch, _ = self.roots[row].tolist()
        return turned_root(self.precise, form, branch, base, bits, near)

    # --- cells ----------------------------------------------------------------------------------

    def cells(self) -> tuple[Ints, Ints, Ints, list[tuple[int, ...]]]:
        """Return the feasible cells: slabs, both roots, and which rows coincide along these."""
        start, _ = runs(self.group)
        slab, values = self.slab[start], self.values[start]
        n = len(start)
        after, tops = np.arange(1, n + 1), np.full(n, np.nan)
        tops[:-1] = values[1:]
        first, last = runs(slab)
        gap = np.ones(n, dtype=np.bool_)  # whether there is one above
        if self.circle:
            after[last], tops[last] = first, values[first] + TURN
        else:
            gap[last] = False
        self.start, self.after, self.tops, self.gap_slab, self.bottoms = (
            start,
            after,
            tops,
            slab,
            values,
        )
        self.double = self._doubles()
        if self.plane.contacts.pairs:
            gap &= self._apart(gap, first, last)
        free = which(gap)
        free = free[self._positive(free)]
        lower, upper = self._bounding(free, lower=True), self._bounding(after[free], lower=False)
        roots = np.stack([self.roots[lower[0]], self.roots[upper[0]]], axis=1)
        roots[after[free] <= free, 1, 2] += 1  # past the cut of the circle
        alone = roots[:, 1, 0] == LOWEST.form
        roots[alone, 1] = HIGHEST
        return slab[free], roots, *_numbered(roots[:, :, 0], lower[1], upper[1])

    def _bounding(self, groups: Ints, *, lower: bool) -> tuple[Ints, dict[int, tuple[int, ...]]]:
        """Return the row of each group that bounds a cell above it, or below.

        And all rows that vanish there, by the place in `groups`, where there are several.
        """
        begin, end = self.start[groups], np.append(self.start, len(self.slab))[groups + 1]
        chosen, names = begin.copy(), dict[int, tuple[int, ...]]()
        several = which(end - begin > 1).tolist()
        closed = self._closed(groups, begin, end, several, lower)
        for k in several:
            rows = range(int(begin[k]), int(end[k]))
            own = self._acting(rows, closed[k], lower) or list(rows)
            ends = [row for row in own if self.roots[row, 0] < 0]
            best = ends or own
            chosen[k] = min(best, key=lambda row: tuple(self.roots[row].tolist()))
            names[k] = tuple(sorted({int(self.roots[row, 0]) for row in best}))
        return chosen, names

    def _closed(
        self, groups: Ints, begin: Ints, end: Ints, several: list[int], lower: bool
    ) -> dict[int, set[int]]:
        """Return of groups of coinciding rows the pairs that are in collision on the other side."""
        asked = []
        for k in several:
            group = int(groups[k])
            other, pieces = self._below(group) if lower else group, self.piece[begin[k] : end[k]]
            pairs = self.plane.contacts.pair[self.pieces.feature[pieces[pieces >= 0]]]
            if other is not None:
                asked += [(k, other, pair) for pair in set(pairs.tolist())]
        found: dict[int, set[int]] = {k: set() for k in several}
        of, gaps, pairs = np.array(asked, dtype=np.int64).reshape(-1, 3).T
        met = self._met(gaps, pairs)
        for k, pair in zip(of[met].tolist(), pairs[met].tolist(), strict=True):
            found[k].add(pair)
        return found

    def _doubles(self) -> Bools:
        """Tell which rows are one of both roots of a form at one place: it only touches there."""
        name = self.group * (len(self.plane.eps) + 2) + self.roots[:, 0] + 2
        order = np.argsort(name, kind="stable")
        same = (np.diff(name[order]) == 0) & (self.roots[order[1:], 0] >= 0)
        double = np.zeros(len(name), dtype=np.bool_)
        double[order[1:][same]] = double[order[:-1][same]] = True
        return double

    def _acting(self, rows: Sequence[int], closed: set[int], lower: bool) -> list[int]:
        """Return those of coinciding rows that part a cell above them, or below, from the rest.

        Of bodies they are contacts of pairs that are in collision on the other side; where there
        are none, contacts whose form is negative there, if any.
        """
        pieces, contacts, found = self.pieces, self.plane.contacts, list[int]()
        for row in rows:
            k = int(self.piece[row])
            pair = -1 if k < 0 else int(contacts.pair[pieces.feature[k]])
            if k < 0 or (pair in closed and pieces.enters[k] != lower):
                found.append(row)
        if not found:  # bodies only touch: what would come into collision, going on
            found = [row for row in rows if pieces.enters[self.piece[row]] != lower]
        return [row for row in found if not self.double[row]] or found

    def _positive(self, gaps: Ints) -> Bools:
        """Tell whether every form that stands alone is positive in gaps."""
        plane, m = self.plane, self.plane.count
        if not m:
            return np.ones(len(gaps), dtype=np.bool_)
        slab = self.gap_slab[gaps]
        t, low, high = self.t[slab], self.bottoms[gaps], self.tops[gaps]
        v = low + (high - low) / 2
        doubt = (plane.eps[:m] + 16 * UNIT) * plane.scaled_size[:m]
        surely, maybe = plane.positive(t, v, doubt)
        for k in which(maybe & ~surely).tolist():
            base, place = self.base(int(slab[k])), self._middle(int(gaps[k]))
            surely[k] = all(
                self.precise.sign(form, lambda bits, b=base: b, place) > 0 for form in range(m)
            )
        return surely

    def _middle(self, gap: int) -> Any:
        """Return an exact lift value inside a gap."""
        low, high = float(self.bottoms[gap]), float(self.tops[gap])
        a, b = int(self.start[gap]), int(self.start[self.after[gap]])
        if high - low > 1e3 * (self.errors[a] + self.errors[b]):
            return (low + high) / 2
        base = self.base(int(self.gap_slab[gap]))

        def middle(bits: int) -> Any:
            one = self.root(a, base, bits, low)
            return midpoint(one, self.root(b, base, bits, high))

        return middle

    # --- bodies ---------------------------------------------------------------------------------

    def _apart(self, gap: Bools, first: Ints, last: Ints) -> Bools:
        """Tell of the gap above each group whether all bodies are apart in it.

        The number of pairs in collision is counted from the widest gap of the slab, where it is
        tested. Where the count does not return to itself round a circle, or is not what a second
        test finds at an end of a range, each gap of the slab is tested.
        """
        pieces, slabs = self.pieces, len(self.t)
        widths = np.where(gap, self.tops - self.bottoms, -1.0)
        widest = first + _first_largest(widths, first, self.gap_slab)
        change = self._changes()
        count = np.cumsum(change)
        moving = ~pieces.base_only & ~pieces.idle & ~pieces.resting
        found = self._colliding(widest, moving).sum(axis=1)
        blocked: Any = self._colliding(widest, pieces.base_only | pieces.idle).any(axis=1)
        count = count + (found - count[widest])[self.gap_slab]
        doubtful: Any
        if self.circle:
            doubtful = np.bincount(self.gap_slab, change, slabs) != 0
        else:
            top = last - 1
            doubtful = self._colliding(top, moving).sum(axis=1) != count[top]
        doubtful |= np.minimum.reduceat(count, first) < 0
        free: Bools = np.asarray((count == 0) & ~blocked[self.gap_slab] & gap)
        looked = which(gap & doubtful[self.gap_slab] & ~blocked[self.gap_slab])
        if len(looked):
            free[looked] = ~self._colliding(looked, moving).any(axis=1)
        if pieces.resting.any():
            looked = which(free)
            free[looked] = ~self._colliding(looked, pieces.resting).any(axis=1)
        return free

    def _changes(self) -> Ints:
        """Return by how much each group changes the number of pairs in collision.

        Of one pair several features may touch at one place: it is one contact. Where a pair seems
        to come into collision and out of it at once, it may only touch: both sides are tested.
        """
        pieces, pairs = self.pieces, self.plane.contacts.pairs
        rows = which(self.piece >= 0)
        pair = self.plane.contacts.pair[pieces.feature[self.piece[rows]]]
        counted = ~pieces.resting[pair]
        rows, pair = rows[counted], pair[counted]
        enters = pieces.enters[self.piece[rows]]
        key = np.sort((self.group[rows] * pairs + pair) * 2 + enters)
        key = key[np.diff(key, prepend=-1) > 0]
        both = which(np.diff(key // 2) == 0)
        change = np.bincount(key // (2 * pairs), np.where(key % 2, 1.0, -1.0), len(self.start))
        group, own = np.divmod(key[both] // 2, pairs)
        change += np.bincount(group, self._turned_at(group, own), len(change))
        return change.astype(np.int64)

    def _turned_at(self, group: Ints, pair: Ints) -> Ints:
        """Return 1 where a pair is in collision above a group and not below, -1 if only below."""
        under = (self._below(g) for g in group.tolist())
        below = np.array([-1 if k is None else k for k in under], dtype=np.int64)
        inner = below >= 0
        if not self.circle:
            inner &= self.roots[self.start[group], 0] != HIGHEST.form
        found = np.zeros(len(group), dtype=np.int64)
        below, group, pair = below[inner], group[inner], pair[inner]
        found[inner] = self._met(group, pair).astype(int) - self._met(below, pair)
        return found

    def _below(self, group: int) -> int | None:
        """Return the group below one in its slab; round a circle the last is below the first."""
        if group and self.gap_slab[group - 1] == self.gap_slab[group]:
            return group - 1
        last = int(np.searchsorted(self.gap_slab, self.gap_slab[group], side="right")) - 1
        return last if self.circle else None

    def _met(self, gaps: Ints, pairs: Ints) -> Bools:
        """Tell of gaps, each with one pair, whether that pair is not apart there."""
        found = np.zeros(len(gaps), dtype=np.bool_)
        order = np.argsort(pairs, kind="stable")
        for first, last in zip(*runs(pairs[order]), strict=True):
            chosen = np.zeros(self.plane.contacts.pairs, dtype=np.bool_)
            at = order[first : last + 1]
            chosen[pairs[at]] = True
            found[at] = self._colliding(gaps[at], chosen)[:, 0]
        return found

    def _colliding(self, gaps: Ints, pairs: Bools) -> Bools:
        """Tell which of some pairs are not apart in gaps, shape (gaps, pairs)."""
        plane = self.plane
        slab = self.gap_slab[gaps]
        low, high = self.bottoms[gaps], self.tops[gaps]
        v = low + INSIDE * (high - low)
        tests = Separation(plane, pairs)
        heights = tests.heights(self.t[slab], v)
        result = heights <= 0
        doubt = tests.doubt
        for k, p in np.argwhere(np.abs(heights) <= doubt).tolist():
            base = self.base(int(slab[k]))
            place = self._middle(int(gaps[k]))
            result[k, p] = not apart(
                self.precise, int(tests.pairs[p]), lambda bits, b=base: b, place
            )
        return np.asarray(result)


def turned_root(
    precise: Precise, form: int, branch: int, base: Any, bits: int, near: float, side: int = 0
) -> Any:
    """Return a root as a ball, on the turn that is near to a value."""
    from flint import arb

    with precision(bits):
        found = precise.root(form, branch, base, bits, side)
        if found is None:
            if bits < LEVELS[-1]:
                return arb(near, 1e-3)
            raise UndecidedError(f"a root near base value {float(base.mid()):.17g}")
        if form >= 0 and precise.plane.lift_kind == "revolute":
            turns = round((near - float(found.mid())) / TURN)
            found = found + 2 * turns * arb.pi()
    return found


def _numbered(
    forms: Ints, lower: dict[int, tuple[int, ...]], upper: dict[int, tuple[int, ...]]
) -> tuple[Ints, list[tuple[int, ...]]]:
    """Give the sets of rows along both roots of cells numbers: most are one row."""
    alone, sets = np.unique(forms, return_inverse=True)
    sets = sets.reshape(forms.shape)
    numbers: dict[tuple[int, ...], int] = {(form,): k for k, form in enumerate(alone.tolist())}
    for side, several in enumerate((lower, upper)):
        for k, rows in several.items():
            sets[k, side] = numbers.setdefault(rows, len(numbers))
    return sets, list(numbers)


def _first_largest(widths: Floats, start: Ints, slab: Ints) -> Ints:
    """Return in each slab the place of the largest width, the first where there are several."""
    most = np.maximum.reduceat(widths, start)
    where = which(widths == most[slab])
    _, first = np.unique(slab[where], return_index=True)
    return where[first] - start


# --- lines that are none --------------------------------------------------------------------------


def _without_idle_lines(found: Decomposition) -> Decomposition:
    """Drop the critical lines at which no feasible cell changes, and join the cells across."""
    lines, slabs, roots, sets = found.lines, found.slabs, found.roots, found.sets
    count = np.bincount(slabs, minlength=len(lines) - 1)
    # Cell by cell: is there the same, in its turn, over the slab before?
    number = np.arange(len(slabs)) - (count.cumsum() - count)[slabs]
    back = np.concatenate([[0], count])[slabs]
    there = number < back
    k = which(there)
    there[k] = (roots[k] == roots[k - back[k]]).all(axis=(1, 2))
    there[k] &= (sets[k] == sets[k - back[k]]).all(axis=1)
    same = np.zeros(len(lines), dtype=np.bool_)
    same[1:-1] = count[1:] == count[:-1]
    same[slabs[~there]] = False
    k = which(same[slabs])
    same[slabs[k[~_goes_on(found, slabs[k], roots[k])]]] = False
    kept = ~same
    renumbered, left = kept.cumsum() - 1, kept[slabs]
    standing = {int(renumbered[k]): rows for k, rows in found.standing.items() if kept[k]}
    return replace(
        found,
        critical=found.critical.only(kept),
        inside=found.inside[kept[:-1]],
        slabs=renumbered[slabs[left]],
        roots=roots[left],
        sets=sets[left],
        standing=standing,
    )


def _goes_on(found: Decomposition, at: Ints, roots: Ints) -> Bools:
    """Tell whether cells between the same two roots on both sides of a line are one, open on it."""
    plane, lines = found.plane, found.lines
    widths = np.array([lines[at] - lines[at - 1], np.zeros(len(at)), lines[at + 1] - lines[at]]).T
    step = np.maximum(UNCHANGED**2 * widths, np.minimum(widths / 2, BEYOND_JUMP))
    t = lines[at][:, None] + step * np.array([-1, 0, 1])
    own = roots.swapaxes(0, 1)  # all lower ones, then all upper
    twins = own * np.array([1, -1, 1])  # of the other branch
    values = plane.follow(np.concatenate([own, twins]), t)
    (lower, upper), height = values[:2], (values[1] - values[0]).min(axis=1)
    smooth = np.ptp(values[:2], axis=2).sum(axis=0) < UNCHANGED * height
    going = smooth & (height > SAME_POINT * plane.lift_unit)
    going &= _simple(plane, own[..., 0], values[:2] - values[2:]).all(axis=0)
    low, high = lower[going, 1], upper[going, 1]
    going[going] = found.joined(
        at[going], lambda k, part: float(low[k] + part * (high[k] - low[k]))
    )
    return np.asarray(going)


def _simple(plane: Plane, form: Ints, gap: Floats) -> Bools:
    """Tell whether roots keep away from the other root of their form: where both meet is a kink.

    Of forms (2, n) and gaps (2, n, places); (2, n).
    """
    gap = np.sin(gap / 2) if plane.lift_kind == "revolute" else gap
    alone = (form < 0) | plane.affine[np.maximum(form, 0)] if len(plane.affine) else form < 0
    return np.asarray(alone | (np.abs(gap).min(axis=2) > UNCHANGED))
