"""Cells of two joints in which every form is positive and all bodies are apart; which are adjacent.

A cylindrical decomposition. For a fixed value of one joint, the base, each form is a one-joint form
in the other, the lift, and Theorem 2 (or the quadratic formula) gives its roots. The order of these
roots changes only at critical base values, and each kind of critical value is a root of a
univariate polynomial (`events`). For bodies only contacts count (`ContactPieces`): at each contact
along the lift, the number of pairs in collision goes up or down by one. The method needs no grid,
no sample and no starting guess.

Two neighbouring cells are joined across a critical line only over an open interval on which every
form is positive on that line. The components are the sets of cells that are joined in this way.

Doubles decide where their error bounds allow it; balls decide the rest (`plane.Precise`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from cspace.arrays import Bools, Floats, Ints, ranges
from cspace.boundary.contacts import SIDES
from cspace.forms.factors import turns_up_to, whole_turns
from cspace.region.events import (
    END,
    INSIDE,
    NO_EVENTS,
    ContactPieces,
    CriticalLines,
    Finder,
    along_base,
    find_events,
    find_lines,
)
from cspace.region.plane import (
    HIGHEST,
    LEVELS,
    LOWEST,
    NUMBER,
    TINY,
    PartingTests,
    Plane,
    Precise,
    UndecidedError,
    flint,
    in_order,
    midpoint,
    normalised,
    precision,
    ranked,
    runs,
    which,
)
from cspace.tolerances import BEYOND_JUMP, SAME_POINT, TOUCH, UNCHANGED, UNIT
from qbound.circle import TURN, first_from

Rows = tuple[Ints, Floats, Floats, Ints, Ints]
"""Slab, lift value, its error, root and contact of roots."""

PLACES = (0.29, 0.5, 0.77)
"""Parts of an element at which it is asked whether bodies touch there; one place may be special."""


@dataclass(frozen=True, eq=False)
class Decomposition:
    """Slabs between critical base values, and the feasible cells over them.

    Attributes
    ----------
    plane : Plane
    critical : CriticalLines
        Slab i lies between lines i and i + 1.
    inside : ndarray, shape (s,)
        A base value inside each slab, at which the full turns of roots are counted.
    slabs : ndarray of int, shape (k,)
        Slab of each cell, ascending.
    roots : ndarray of int, shape (k, 2, 3)
        Lower and upper root of each cell, as `Root`.
    sets : ndarray of int, shape (k, 2)
        Which rows vanish along both roots: an index into `names`.
    names : list of tuple of int
        Rows that coincide along a curve.
    standing : dict of int to tuple of int
        For each line on whose whole fibre a form vanishes: these rows.
    """

    plane: Plane
    critical: CriticalLines
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
        """Exact coefficients, for decisions that doubles cannot make."""
        return self.critical.finder.precise

    def joined(self, line: Ints, place: Callable[[int, float], Any]) -> Bools:
        """Tell whether parts of lines are free, given that both sides are free.

        A form is zero on such a line only if it vanishes on the whole fibre. Bodies may touch on a
        part.

        Parameters
        ----------
        place : callable
            Function of a row and a fraction from 0 to 1; returns the lift value at this fraction
            between both ends, as a number or a function of the number of bits.
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
    """Find all events and all feasible cells of a plane.

    Raises
    ------
    UndecidedError
        If the structure could not be decided.
    """
    return find_cells(*find_events(precise))


def nothing_in(precise: Precise) -> Decomposition:
    """Return a decomposition without cells."""
    lines = find_lines(Finder(precise.plane, precise), NO_EVENTS)
    none = np.zeros((0, 2, 3), dtype=np.int64)
    inside = np.zeros(len(lines.t) - 1)
    return Decomposition(precise.plane, lines, inside, none[:, 0, 0], none, none[:, :, 0], [], {})


# --- critical base values -------------------------------------------------------------------------


def find_cells(lines: CriticalLines, pieces: ContactPieces) -> Decomposition:
    """Return the feasible cells between critical lines.

    Raises
    ------
    UndecidedError
        If the structure could not be decided.
    """
    plane, fibres = lines.finder.plane, _Fibres(lines, pieces)
    cells, standing = fibres.cells(), _standing(plane, lines, pieces)
    return _without_idle_lines(Decomposition(plane, lines, fibres.t, *cells, standing))


SINGLE = "fold circle", "fold line", "first", "second", "constant", "lower end", "upper end"
"""Events of one form; where it vanishes on the whole fibre one of them is there, or always is."""


def _standing(
    plane: Plane, lines: CriticalLines, pieces: ContactPieces
) -> dict[int, tuple[int, ...]]:
    """Return for each line the rows that vanish on its whole fibre, if there are any."""
    found: dict[int, set[int]] = {}
    for line, row in zip(lines.of[pieces.walls], pieces.events.what[pieces.walls, 1], strict=True):
        if line >= 0:
            found.setdefault(int(line), set()).add(int(row))
    own = {NUMBER[kind] for kind in SINGLE}
    lifts: Any = plane.scaled[: plane.count, :, 1:].any(axis=(1, 2))
    what = lines.events.what.tolist()
    asked = {
        (line, row)
        for line, members in enumerate(lines.members)
        for kind, row, _ in (what[k] for k in members)
        if row < plane.count and kind in own
    }
    rows = np.array(sorted(asked), dtype=np.int64).reshape(-1, 2)
    for line, row in rows[_nearly_blank(plane, lines, *rows.T) | ~lifts[rows[:, 1]]].tolist():
        if not lifts[row] or vanishes_on(lines, line, row):
            found.setdefault(line, set()).add(row)
    last = len(lines.t) - 1
    if plane.base_range is None and (0 in found or last in found):
        found[0] = found[last] = found.get(0, set()) | found.get(last, set())
    return {line: tuple(sorted(rows)) for line, rows in found.items()}


def _nearly_blank(plane: Plane, lines: CriticalLines, line: Ints, row: Ints) -> Bools:
    """Tell by doubles which forms may vanish on the whole fibre over a line."""
    c = plane.coefficients(row, lines.t[line][:, None])[..., 0]
    scaled = np.abs(c) * (plane.lift_unit ** np.arange(3))[:, None]
    doubt = plane.eps[row] + 16 * UNIT + 4 * lines.radius[line] / plane.base_unit
    return np.asarray((scaled <= doubt * np.maximum(1.0, plane.scaled_size[row])).all(axis=0))


def vanishes_on(lines: CriticalLines, line: int, row: int) -> bool:
    """Tell in balls whether a row, also of a side condition, vanishes on the fibre over a line."""
    precise = lines.finder.precise
    for bits in LEVELS:
        with precision(bits):
            over = precise.along_lift(row, lines.ball(line, bits), bits)
            if not all(x.contains(0) for x in over):
                return False
    return True


# --- fibres ---------------------------------------------------------------------------------------


def curves_of(plane: Plane, row: Ints) -> Ints:
    """Return a number for the curve of each row; features of one curve share a number."""
    curves, feature = plane.contacts.curves, row - plane.count
    number = np.append(curves, 0)[np.clip(feature, 0, len(curves))]
    shared = (feature >= 0) & (feature < len(curves))
    return np.where(shared, plane.count + number, row)


def apart(precise: Precise, pair: int, t: Any, v: Any, beside: int = 0) -> bool:
    """Tell in balls whether a pair of bodies is apart at a configuration, shown by one clause.

    Touching does not count as apart. `t` and `v` are numbers, or functions of the number of bits.
    With `beside` -1 or +1, the answer is for just before or just behind that base value.
    """
    contacts, plane = precise.plane.contacts, precise.plane
    rows = which(contacts.pair == pair)
    first, side = plane.count, plane.count + len(contacts.forms)

    def sign(row: int) -> int:
        return precise.sides(row, t, v)[beside > 0] if beside else precise.sign(row, t, v)

    for clause in np.unique(contacts.clause[rows]):
        own = rows[contacts.clause[rows] == clause].tolist()
        if all(sign(first + k) > 0 for k in own) and all(
            sign(side + SIDES * k + s) >= 0
            for k in own
            if contacts.corners[k]
            for s in range(SIDES)
            if contacts.keys[k, s] >= 0
        ):
            return True
    return False


class _Fibres:
    """The roots that bound cells over one base value inside each slab, ordered and grouped.

    Attributes
    ----------
    t : ndarray, shape (slabs,)
        Base values, one inside each slab.
    exact : dict of int to arb
        Exact base values that no double can express.
    slab, values, errors : ndarray, shape (n,)
        The slab of each root, ascending in each slab; lift values, and bounds of their errors.
    roots : ndarray of int, shape (n, 3)
        As `Root`.
    piece : ndarray of int, shape (n,)
        Index of the contact; -1 for a root of a form that stands alone, and for an end.
    group : ndarray of int, shape (n,)
        Roots with equal numbers are one place, as far as 1,024 bits can tell.
    circle : bool
        Whether the lift is a circle, so that a slab's first root follows its last one, a turn
        later.
    """

    def __init__(self, lines: CriticalLines, pieces: ContactPieces) -> None:
        self.lines, self.pieces = lines, pieces
        self.plane, self.precise = lines.finder.plane, lines.finder.precise
        self.circle = self.plane.lift_range is None
        self._known: dict[Any, list[list[int]]] = {}
        self.t, self.exact = self._bases()
        self._gather()
        self.curve = 3 * curves_of(self.plane, self.roots[:, 0]) + self.roots[:, 1]
        self._order()

    def _bases(self) -> tuple[Floats, dict[int, Any]]:
        """Return a base value inside each slab; an exact one where doubles are too near."""
        lines, exact = self.lines, dict[int, Any]()
        # Where bodies touch, the place is not the middle, because symmetric scenes may touch there.
        part = INSIDE if self.plane.pairs else 0.5
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
        found = self.exact.get(slab)
        return flint.arb(float(self.t[slab])) if found is None else found

    def _gather(self) -> None:
        """Find the roots in the lift's range and its ends; on a circle without roots, its cut."""
        parts = [self._of_forms()]
        if self.plane.pairs:
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
        """Return roots on every full turn within the lift's range, and the two ends of the range.

        On a circle each root comes once, on the first turn from the cut.
        """
        slab, values, errors, roots, piece = rows
        every, (low, high) = np.arange(len(self.t)), self.plane.lift_ends
        if self.circle:
            roots[:, 2] = turns_up_to(low, values).astype(np.int64)
            values = values + TURN * roots[:, 2]
            ends = [(which(np.bincount(slab, minlength=len(every)) == 0), low, LOWEST)]
        else:
            first, beyond = np.zeros((2, len(values)), dtype=np.int64)
            beyond += 1
            if self.plane.lift_kind == "revolute":
                first = turns_up_to(low - errors, values).astype(np.int64)
                beyond = turns_up_to(high + errors, values).astype(np.int64)
            pick, turns = ranges(first, beyond)
            values = values[pick] + TURN * turns
            inside = (values > low - errors[pick]) & (values < high + errors[pick])
            pick, turns, values = pick[inside], turns[inside], values[inside]
            slab, errors, roots, piece = (x[pick] for x in (slab, errors, roots, piece))
            roots[:, 2] = turns
            ends = [(every, low, LOWEST), (every, high, HIGHEST)]
        parts: list[Rows] = [(slab, values, errors, roots, piece)]
        for where, value, root in ends:
            n = len(where)
            both = np.tile(root, (n, 1)).astype(np.int64)
            error = np.full(n, 2 * UNIT * abs(value))
            parts.append((where, np.full(n, value), error, both, np.full(n, -1)))
        found: Any = [np.concatenate(x) for x in zip(*parts, strict=True)]
        return tuple(found)

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
        """Give numbers to the places of roots: doubles decide where they can, balls the rest."""
        order, group, turned = ranked(
            self.slab, self.values, self.errors, self.circle, self._ranked, self.curve
        )
        self.values[turned] -= TURN
        self.roots[turned, 2] -= 1
        if not self.circle and len(order):  # contacts beyond an end of the range
            form, slab = self.roots[order, 0], self.slab[order]
            low, high = (group[form == end.form][slab] for end in (LOWEST, HIGHEST))
            kept = (low <= group) & (group <= high)
            order, group = order[kept], group[kept]
        self._take(order)
        self.group = (np.diff(group, prepend=group[:1]) != 0).cumsum()

    def _ranked(self, rows: list[int], values: list[float]) -> list[list[int]]:
        """Return rows of one slab in their true order, equal ones together."""
        curves = self.curve[rows].tolist()
        if len(set(curves)) == 1:  # features of one curve have one root
            return [rows]
        base = self.base(int(self.slab[rows[0]]))
        # Roots that do not change with the base have one order over all slabs.
        key = tuple(
            (*self.roots[row, :2].tolist(), round(8 * near))
            for row, near in zip(rows, values, strict=True)
        )
        found = self._known.get(key)
        if found is None:
            groups = in_order(
                range(len(rows)), lambda k, bits: self.root(rows[k], base, bits, values[k]), curves
            )
            found = [own for _, own in groups]
            if all(self.precise.is_still(form) for form, _, _ in key):
                self._known[key] = found
        return [[rows[k] for k in own] for own in found]

    def root(self, row: int, base: Any, bits: int, near: float) -> Any:
        """Return a root as a ball, on the turn that is near to a value."""
        form, branch, _ = self.roots[row].tolist()
        return turned_root(self.precise, form, branch, base, bits, near)

    # --- cells ----------------------------------------------------------------------------------

    def cells(self) -> tuple[Ints, Ints, Ints, list[tuple[int, ...]]]:
        """Return the feasible cells: slabs, both roots, and the rows that coincide along them."""
        self.start, _ = runs(self.group)
        slab = self.gap_slab = self.slab[self.start]
        bottoms = self.bottoms = self.values[self.start]
        n, (first, last) = len(slab), runs(slab)
        self.after, self.tops = np.arange(1, n + 1), np.append(bottoms[1:], np.nan)
        gap = np.ones(n, dtype=np.bool_)  # whether there is one above
        if self.circle:
            self.after[last], self.tops[last] = first, bottoms[first] + TURN
        else:
            gap[last] = False
        self.double = self._doubles()
        if self.plane.pairs:
            gap &= self._apart(gap, first, last)
        free = which(gap)
        free = free[self._positive(free)]
        above = self.after[free]
        lower, upper = self._bounding(free, lower=True), self._bounding(above, lower=False)
        roots = np.stack([self.roots[lower[0]], self.roots[upper[0]]], axis=1)
        roots[above <= free, 1, 2] += 1  # past the cut of the circle
        roots[roots[:, 1, 0] == LOWEST.form, 1] = HIGHEST
        return slab[free], roots, *_numbered(roots[:, :, 0], lower[1], upper[1])

    def _bounding(self, groups: Ints, *, lower: bool) -> tuple[Ints, dict[int, tuple[int, ...]]]:
        """Return the row of each group that bounds a cell above it, or below.

        Also returns all rows that vanish there, by the index in `groups`, if there are several.
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
        """Return for groups of coinciding rows the pairs in collision on the other side."""
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
        """Tell which rows are double roots of a form, which only touches there."""
        name = self.group * (len(self.plane.eps) + 2) + self.roots[:, 0] + 2
        order = np.argsort(name, kind="stable")
        same = (np.diff(name[order]) == 0) & (self.roots[order[1:], 0] >= 0)
        double = np.zeros(len(name), dtype=np.bool_)
        double[order[1:][same]] = double[order[:-1][same]] = True
        return double

    def _acting(self, rows: Sequence[int], closed: set[int], lower: bool) -> list[int]:
        """Return the coinciding rows that separate a cell above them, or below, from the rest.

        For bodies these are contacts of pairs in collision on the other side. If there are none,
        they are contacts whose form is negative there, if any.
        """
        pieces, contacts, found = self.pieces, self.plane.contacts, list[int]()
        for row in rows:
            k = int(self.piece[row])
            pair = -1 if k < 0 else int(contacts.pair[pieces.feature[k]])
            if k < 0 or (pair in closed and pieces.enters[k] != lower):
                found.append(row)
        if not found:  # bodies only touch: pairs that would collide further on
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
        """Tell whether all bodies are apart in the gap above each group.

        The number of pairs in collision is tested in the widest gap of the slab and counted from
        there. If the count round a circle does not return to its start, or differs from a second
        test at an end of the range, each gap of the slab is tested.
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

        Several features of one pair may touch at one place, which is one contact. If a pair seems
        to enter and leave collision at once, it may only touch, so both sides are tested.
        """
        pieces, pairs = self.pieces, self.plane.pairs
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
        """Tell for gaps, each with one pair, whether this pair is not apart there."""
        found = np.zeros(len(gaps), dtype=np.bool_)
        order = np.argsort(pairs, kind="stable")
        for first, last in zip(*runs(pairs[order]), strict=True):
            chosen = np.zeros(self.plane.pairs, dtype=np.bool_)
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
        tests = PartingTests(plane, pairs)
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
    with precision(bits):
        found = precise.root(form, branch, base, bits, side)
        if found is None:
            if bits < LEVELS[-1]:
                return flint.arb(near, 1e-3)
            raise UndecidedError(f"a root near base value {float(base.mid()):.17g}")
        if form >= 0 and precise.plane.lift_kind == "revolute":
            turns = round((near - float(found.mid())) / TURN)
            found = found + 2 * turns * flint.arb.pi()
    return found


def _numbered(
    forms: Ints, lower: dict[int, tuple[int, ...]], upper: dict[int, tuple[int, ...]]
) -> tuple[Ints, list[tuple[int, ...]]]:
    """Return numbers for the sets of rows along both roots of cells; most sets are one row."""
    alone, sets = np.unique(forms, return_inverse=True)
    sets = sets.reshape(forms.shape)
    numbers: dict[tuple[int, ...], int] = {(form,): k for k, form in enumerate(alone.tolist())}
    for side, several in enumerate((lower, upper)):
        for k, rows in several.items():
            sets[k, side] = numbers.setdefault(rows, len(numbers))
    return sets, list(numbers)


def _first_largest(widths: Floats, start: Ints, slab: Ints) -> Ints:
    """Return in each slab the position of the largest width, the first one if there are several."""
    most = np.maximum.reduceat(widths, start)
    where = which(widths == most[slab])
    _, first = np.unique(slab[where], return_index=True)
    return where[first] - start


# --- lines that are none --------------------------------------------------------------------------


def _without_idle_lines(decomposition: Decomposition) -> Decomposition:
    """Drop the critical lines at which no feasible cell changes, and join the cells across."""
    lines, slabs, roots, sets = (
        decomposition.lines,
        decomposition.slabs,
        decomposition.roots,
        decomposition.sets,
    )
    count = np.bincount(slabs, minlength=len(lines) - 1)
    # Cell by cell: does the slab before have the same cell, in the same order?
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
    same[slabs[k[~_goes_on(decomposition, slabs[k], roots[k])]]] = False
    kept = ~same
    renumbered, left = kept.cumsum() - 1, kept[slabs]
    standing = {int(renumbered[k]): rows for k, rows in decomposition.standing.items() if kept[k]}
    return replace(
        decomposition,
        critical=decomposition.critical.only(kept),
        inside=decomposition.inside[kept[:-1]],
        slabs=renumbered[slabs[left]],
        roots=roots[left],
        sets=sets[left],
        standing=standing,
    )


def _goes_on(decomposition: Decomposition, at: Ints, roots: Ints) -> Bools:
    """Tell whether cells between the same two roots on both sides of a line form one open cell."""
    plane, lines = decomposition.plane, decomposition.lines
    widths = np.array([lines[at] - lines[at - 1], np.zeros(len(at)), lines[at + 1] - lines[at]]).T
    step = np.maximum(UNCHANGED**2 * widths, np.minimum(widths / 2, BEYOND_JUMP))
    t = lines[at][:, None] + step * np.array([-1, 0, 1])
    own = roots.swapaxes(0, 1)  # all lower ones, then all upper
    twins = own * np.array([1, -1, 1])  # of the other branch
    values = plane.follow(np.concatenate([own, twins]), t)
    height = (values[1] - values[0]).min(axis=1)
    smooth = np.ptp(values[:2], axis=2).sum(axis=0) < UNCHANGED * height
    going = smooth & (height > SAME_POINT * plane.lift_unit)
    going &= _simple(plane, own[..., 0], values[:2] - values[2:]).all(axis=0)
    # If bodies touch along a part of the line, the ends of this part still have to be found.
    return np.asarray(going & ~np.isin(at, list(decomposition.standing)))


def _simple(plane: Plane, form: Ints, gap: Floats) -> Bools:
    """Tell whether roots keep away from the other root of their form; where both meet is a kink.

    Forms have shape (2, n), gaps (2, n, places), the result (2, n).
    """
    gap = np.sin(gap / 2) if plane.lift_kind == "revolute" else gap
    alone = (form < 0) | plane.affine[np.maximum(form, 0)] if len(plane.affine) else form < 0
    return np.asarray(alone | (np.abs(gap).min(axis=2) > UNCHANGED))


INSET = 1e-4 * np.arange(4)
"""Where cells are looked at beside their lines, in parts of their width."""

VAGUE = 3.0
"""No angle at an end of a cell is farther off, rad: less than half a turn, as turns are known."""


FOLDS = NUMBER["fold circle"], NUMBER["fold line"]
"""Events at which both branches of a curve meet."""


class Placed(NamedTuple):
    """A cell that holds a configuration, exactly or nearly.

    Attributes
    ----------
    cell : int
    place : ndarray, shape (2,)
        Base and lift value in the cell's own turns.
    off : ndarray, shape (2,)
        Step from there to the cell's closure; zero inside.
    """

    cell: int
    place: Floats
    off: Floats


@dataclass(frozen=True, eq=False)
class Elements:
    """Pieces of critical lines between ends of cells, one in each row, by line and upwards.

    Attributes
    ----------
    line : ndarray of int, shape (n,)
    low, high : ndarray, shape (n,)
        Ends of each piece; within one turn, except for the last piece if the lift is a circle.
    cell : ndarray of int, shape (2, n)
        The cells to its left and to its right; -1 where there is none.
    turns : ndarray of int, shape (2, n)
        Full turns that bring it into these cells.
    joined : ndarray of bool, shape (n,)
        Whether the two cells are joined over it.
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
        Cells of each component.
    wraps : list of two bool
        Whether a component goes round the base, and round the lift.
    windings : ndarray of int, shape (cells, 2)
        Full turns of base and lift at which each cell lies within its component.
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

    def ball(self, decomposition: Decomposition, k: int, near: float, bits: int) -> Any:
        """Return an end as a ball, on the turn that is near to a value."""
        form, branch, _ = self.root[k].tolist()
        base, side = (
            decomposition.critical.ball(int(self.line[k]), bits),
            1 if self.side[k] == 0 else -1,
        )
        return turned_root(decomposition.precise, form, branch, base, bits, near, side)


class CellComplex:
    """The cells of a decomposition, joined along critical lines."""

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

        The reach is `TOUCH` in the units of base and lift.
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
        """Lower and upper root of cells at one base value; on a line their `ends` count.

        Close to a line an angle may jump by a turn if its cosine and sine are only rounding; the
        turn of the end is taken.
        """
        inset = SAME_POINT * (end - start)
        inside = np.minimum(np.maximum(t, start + inset), end - inset)
        ends = self.ends[chosen].transpose(1, 2, 0)
        found = self.plane.follow(self.roots[chosen].swapaxes(0, 1), inside[:, None])[..., 0]
        if self.plane.lift_kind == "revolute":
            near = TOUCH * self.plane.base_unit
            for line, own in zip((start, end), ends, strict=True):
                off = TURN * whole_turns(own - found)
                found = found + np.where(np.abs(t - line) <= near, off, 0.0)
        found = np.where(t <= start + inset, ends[0], [found[0], np.maximum(*found)])
        return np.where(t >= end - inset, ends[1], found)

    def _ends(self) -> tuple[Floats, Floats]:
        """Lower and upper root of every cell at its left and its right line, and their errors.

        Both have shape (k, 2, 2). At a line an angle may jump by a turn, and a form that vanishes
        on a whole fibre has no roots there. So the limit of the roots from inside the slab is
        taken. If a slab is so narrow that no double is certainly inside, the counted turn decides.
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
        turns_round = self.plane.lift_kind == "revolute"
        if turns_round:
            counted = self.plane.follow(roots, self.decomposition.inside[self.slabs, None])
            doubt = 8 * radius + 64 * UNIT * np.abs(t[:, ::4])
            near = np.where(inset[:, 1:2] > doubt, near, counted)
            at = at + TURN * whole_turns(near - at)
        else:  # if a quadratic becomes affine, either branch may be the root that stays finite
            other = self.plane.values(roots * np.array([1, -1, 1]), c[..., ::4])
            affine = self.plane.blank(roots[..., 0], c[2:, ..., ::4], 2)
            at = np.where(affine & (np.abs(other - near) < np.abs(at - near)), other, at)
        blank = self.plane.blank(roots[..., 0], c[..., ::4])
        if blank.any():
            at = np.where(blank, 3 * near - 3 * values[..., 2] + values[..., 3], at)
        radius = radius / self.plane.base_unit
        form = np.maximum(roots[..., 0], 0)[..., None] * np.ones(2, dtype=np.int64)
        if len(self.plane.eps):
            _, errors, _ = self.plane.roots_and_errors(form, c[..., ::4], 2 * radius)
            error = np.where(roots[..., 1, None] < 0, errors[0], errors[1])
            error = np.where(blank, np.inf, error)  # the finite limit may be anywhere
        else:
            error = np.zeros_like(at)
        error = np.where(roots[..., 0, None] < 0, 2 * UNIT * np.abs(at), error)
        ends = np.array([at[0], np.maximum(*at)]).transpose(1, 2, 0)
        most = VAGUE if turns_round else np.diff(self.plane.lift_ends)[0]
        return ends, np.minimum(error, most).transpose(1, 2, 0)

    # --- lines ----------------------------------------------------------------------------------

    def _elements(self) -> Elements:
        """Cut the lines where cells end, and tell which cells lie on both sides of each part.

        Elements with cells on both sides are marked as joined; `_join` decides.
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
        """Keep only those elements joined that are free between the two cells."""
        found, own = self.elements, which(self.elements.joined)
        found.joined[own] = self.decomposition.joined(
            found.line[own], lambda k, part: self.place(int(own[k]), part)
        )

    def place(self, element: int, part: float) -> Any:
        """Return a lift value a part of the way up an element, exact: see `Decomposition.joined`.

        The value is a double if doubles tell both ends apart, else a function of the number of
        bits.
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

        Also note for each cell which places its two ends are, on either line: `_place`.
        """
        own, marks = self._cell_ends(kept), self._marks()
        every: list[Any] = [np.concatenate(x) for x in zip(own, marks, strict=True)]
        order = np.lexsort([every[1], every[0]])
        sorted_ends = _Ends(*(x[order] for x in every))
        ranks = _Ranks(self.decomposition, sorted_ends, self.circle)
        best = np.lexsort([sorted_ends.error, ranks.rank])  # of those that are one
        new = np.ones(len(best), dtype=np.bool_)
        new[1:] = np.diff(ranks.rank[best]) > 0
        place = np.empty(len(order), dtype=np.int64)
        place[order[best]] = new.cumsum() - 1
        self._place: Ints = np.full((len(self.slabs), 2, 2), -1)
        self._place[kept] = place[: len(own.line)].reshape(-1, 2, 2)
        kept_ends: list[Any] = [x[best[new]] for x in sorted_ends._replace(v=ranks.v)]
        cuts = _Ends(*kept_ends)
        self._settle(cuts)
        return cuts

    def _settle(self, cuts: _Ends) -> None:
        """Give inaccurate ends the value of equal ends that are known better.

        If a form vanishes on its whole line, or has no root there, its own value is meaningless.
        """
        vague = self._errors > self.touch
        if not vague.any():
            return
        vague &= self._place >= 0
        cut, own = self._place[vague], self.ends[vague]
        v = cuts.v[cut] + TURN * whole_turns(own - cuts.v[cut]) * self.circle
        self.ends[vague] = np.where(cuts.error[cut] < self._errors[vague], v, own)

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
        """Return the places along lines where touching bodies or vanishing forms may change.

        Contacts begin and end where their side conditions vanish. If several pairs of bodies touch
        on a line, one pair may overlap behind only a part of the line, which ends at roots of its
        features.
        """
        plane, found = self.plane, self.decomposition
        last = self.n_lines if self.wrapped else -1  # the first line, a turn later
        standing = {
            line: [row - plane.count for row in rows if row >= plane.count]
            for line, rows in found.standing.items()
            if line != last
        }
        sides = [
            (line, SIDES * feature + side)
            for line, features in standing.items()
            for feature in features
            for side in range(SIDES)
            if self._ends_at(line, feature, side)
        ]
        several = [
            (line, feature)
            for line, features in standing.items()
            if len({*plane.contacts.pair[features].tolist()}) > 1
            for feature in features
        ]
        line, number = np.array(sides, dtype=np.int64).reshape(-1, 2).T
        t, radius = self.abscissae[line], found.critical.radius[line]
        first = plane.count + len(plane.contacts.forms)
        roots = plane.side_roots(number, t, radius)
        parts = [self._marked(line, first + number, roots, roots[2] >= 0)]
        line, feature = np.array(several, dtype=np.int64).reshape(-1, 2).T
        if len(line):
            t, radius = self.abscissae[line], found.critical.radius[line]
            row = plane.count + feature
            slopes = along_base(plane, plane.scaled[row])
            large = np.maximum(np.abs(slopes).max(axis=(1, 2)), TINY)
            roots = plane.table_roots(normalised(slopes), 2 * plane.eps[row] / large, t, radius)
            parts.append(self._marked(line, row, roots, roots[2] > 0))
        every: list[Any] = [np.concatenate(x) for x in zip(*parts, strict=True)]
        return _Ends(*every)

    def _ends_at(self, line: int, feature: int, side: int) -> bool:
        """Tell whether a side condition of a feature vanishes at places of a line, but not on all.

        A side condition that vanishes on the whole fibre has no begin and no end.
        """
        plane, found = self.plane, self.decomposition
        number = plane.count + len(plane.contacts.forms) + SIDES * feature + side
        varied = plane.sides[feature, side, :, 1:].any()
        return bool(varied and not vanishes_on(found.critical, line, number))

    def _marked(self, line: Ints, row: Ints, roots: Any, kept: Bools) -> _Ends:
        """Return the roots of kept rows on all turns within the lift's range."""
        (values, errors, _), plane = roots, self.plane
        branch, k = np.nonzero(np.isfinite(values) & kept)
        v, (low, high) = values[branch, k], plane.lift_ends
        turns = np.zeros_like(k)
        if not self.circle:
            if plane.lift_kind == "revolute":  # the range may be wider than a turn
                first = turns_up_to(low, v).astype(np.int64)
                own, turns = ranges(first, turns_up_to(high, v).astype(np.int64) + 1)
                branch, k, v = branch[own], k[own], v[own] + TURN * turns
            inside = which((v > low) & (v < high))
            branch, k, v, turns = branch[inside], k[inside], v[inside], turns[inside]
        root = np.stack([row[k], 2 * branch - 1, turns], axis=1)
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
        """Return the full turns that move parts of lines into the cells beside them, (2, n)."""
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
        """Which elements are whole circles, on lines where no cell ends."""
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
        """Return for each cell the cells joined to it, with the turns to their windings."""
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
    """The order of ends of cells on critical lines; equal ends share a rank.

    Attributes
    ----------
    rank : ndarray of int, shape (n,)
        Ascending along each line from the lowest value. An end that equals one a turn below, across
        the cut of a circle, has the rank of that one.
    v : ndarray, shape (n,)
        Values; of equal ends that with the least error counts.
    """

    def __init__(self, decomposition: Decomposition, ends: _Ends, circle: bool) -> None:
        self.decomposition, self.ends, self.v = decomposition, ends, ends.v.copy()
        self.line, self.side = ends.line, ends.side
        self.root: Ints = ends.root * np.array([1, 1, 0] if circle else [1, 1, 1])
        self.curves = curves_of(decomposition.plane, self.root[:, 0])
        rows = decomposition.plane.count + len(decomposition.plane.contacts.forms)
        self.curve_of = curves_of(decomposition.plane, np.arange(rows)).tolist()
        named = np.stack([self.curves, *self.root[:, 1:].T], axis=1)
        _, name = np.unique(named, axis=0, return_inverse=True)
        order, group, _ = ranked(ends.line, ends.v, ends.error, circle, self._groups, name)
        self.rank = np.empty_like(order)
        self.rank[order] = group

    def _groups(self, own: list[int], values: list[float]) -> list[list[int]]:
        """Return ends of one line in their true order, equal ones together."""
        near = dict(zip(own, values, strict=True))

        def ball(k: int, bits: int) -> Any:
            return self.ends.ball(self.decomposition, k, near[k], bits)

        names = [(*self.root[k].tolist(), int(self.side[k])) for k in own]
        one = self._are_one(own)
        groups = [own] if one else [group for _, group in in_order(own, ball, names)]
        for group in groups:
            self.v[group] = near[min(group, key=lambda k: self.ends.error[k])]
        return groups

    def _are_one(self, own: list[int]) -> bool:
        """Tell whether the events of the line imply that ends are equal.

        If curves meet, one branch of each curve meets the others. At a fold both branches of one
        curve meet.
        """
        decomposition, line = self.decomposition, int(self.line[own[0]])
        on_turns = {*zip(self.curves[own].tolist(), *self.root[own, 1:].T.tolist(), strict=True)}
        ends = {(curve, branch) for curve, branch, _ in on_turns}
        curves = {curve for curve, _ in ends}
        if len(on_turns) == 1:
            return True
        if len(on_turns) > len(ends):  # one root on several turns
            return False
        if line in decomposition.critical.known:  # balls decided the line: they decide this too
            return False
        events, members = decomposition.critical.events, decomposition.critical.members[line]
        plane, curve = decomposition.plane, self.curve_of
        groups: dict[Any, set[Any]] = {}
        folds: set[int] = set()
        for k in members:
            kind, *rows = events.what[k].tolist()
            key = int(events.key[k])
            together = groups.setdefault(("key", key) if key >= 0 else ("event", k), set())
            if kind in FOLDS:
                folds.add(curve[rows[0]])
            if key >= 0:  # a contact can pass from any of these to any other
                rows += (plane.count + which((plane.contacts.keys == key).any(axis=1))).tolist()
            together |= {curve[row] for row in rows if row < len(curve)}
        both = {curve for curve in curves if {(curve, -1), (curve, 1)} <= ends}
        return both <= folds and any(curves <= group for group in groups.values())


def _spread(
    start: int,
    neighbours: list[list[tuple[int, int, int]]],
    windings: dict[int, tuple[int, int]],
) -> tuple[list[int], bool, bool]:
    """Give the cells of a component their windings; return the cells, and what it goes round.

    A component goes round base or lift if two ways to a cell end at different windings.
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
