"""Contacts of bodies: pieces of the curves of features, each a contact from end to end.

The curve of a feature's form bounds what its pair forbids only where no side condition is negative.
Between the feature's own events (folds, jumps, ends of the lift, common roots with its own side
conditions; never with other features) a root is a contact or none, and one place inside decides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from qbound.arrays import Bools, Floats, Ints
from qbound.boundary.contacts import SIDES
from qbound.forms.angles import TURN, whole_turns
from qbound.forms.harmonic import basis
from qbound.region.critical import NO_EVENTS, Events, Finder, shifted
from qbound.region.plane import Plane, normalised, ranges, ranked, which
from qbound.region.precise import KINDS, Zero, in_order, midpoint, precision
from qbound.tolerances import AGREE, BOX, NEAR, UNIT, WALL

INSIDE = 0.43
"""Where an interval is looked at: off its middle, which may be a place of symmetry."""

PAIRS = 2**20
"""Pairs of pieces that are looked at together, about: some 60 MB."""

DRIFT = 64.0
"""Side conditions, whose largest coefficient is 1, change by at most so much with each unit."""

END = -2
"""Stands for the event of an interval's end that is an end of the base's range."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Contacts over intervals of the base, one a row, and what stands across the base.

    Attributes
    ----------
    feature : ndarray of int, shape (k,)
    branch : ndarray of int, shape (k,)
        -1 / +1, as of a `Root`.
    start, end : ndarray, shape (k,)
        Base values.
    first, last : ndarray of int, shape (k,)
        The events at both, in `events`; `END` at the ends of the base's range.
    enters : ndarray of bool, shape (k,)
        Whether one comes into collision there, going up the lift.
    low, high : ndarray, shape (k,)
        Lift values between which the contact lies; of an angle the lower one may be any turn.
    events : Events
        At which a contact begins, ends or jumps, or bodies may touch along a fibre.
    lines : ndarray of int
        Those of the events that are lines.
    walls : ndarray of int
        Those of the events at which a form of a feature vanishes along a fibre.
    base_only : ndarray of bool, shape (pairs,)
        Pairs that the lift does not move.
    idle : ndarray of bool, shape (pairs,)
        Pairs that never touch: apart, or in collision, everywhere.
    resting : ndarray of bool, shape (pairs,)
        Pairs of which a feature's form vanishes everywhere, as of a slide along an edge: they may
        touch, with no overlap, on open sets.
    """

    feature: Ints
    branch: Ints
    start: Floats
    end: Floats
    first: Ints
    last: Ints
    enters: Bools
    low: Floats
    high: Floats
    events: Events
    lines: Ints
    walls: Ints
    base_only: Bools
    idle: Bools
    resting: Bools

    def roots(self, plane: Plane, k: Ints) -> Ints:
        """Return the root that each of some contacts follows, as `Root`, shape (len(k), 3)."""
        return np.stack([plane.count + self.feature[k], self.branch[k], np.zeros_like(k)], axis=1)


def find_pieces(plane: Plane, finder: Finder) -> Pieces:
    """Find all contacts of the bodies of a plane, and the walls."""
    contacts = plane.contacts
    if not contacts.pairs:
        none, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
        no = np.zeros(0, dtype=np.bool_)
        rows = (none, none, nothing, nothing, none, none, no, nothing, nothing)
        return Pieces(*rows, NO_EVENTS, none, none, no, no, no)
    forms, sides = plane.scaled[plane.count :], plane.sides
    doubt = 16 * plane.eps[plane.count :]
    low, high = _bounds(plane, forms)
    most = _bounds(plane, sides)[1]
    alive = contacts.touching & (low <= doubt) & (high >= -doubt)
    alive &= (most >= -16 * plane.side_eps).all(axis=1)
    lifts = forms[:, :, 1:].any(axis=(1, 2))
    moved: Bools = np.asarray(lifts | sides[:, :, :, 1:].any(axis=(1, 2, 3)))
    base_only = ~_any_of(moved, contacts.pair, contacts.pairs)
    idle = ~_any_of(alive, contacts.pair, contacts.pairs)
    resting = _any_of(alive & ~forms.any(axis=(1, 2)), contacts.pair, contacts.pairs)
    walls = _walls(plane, finder, np.flatnonzero(alive))
    found = _Contacts(plane, finder, np.flatnonzero(alive & lifts))
    events = Events.joined([found.events, walls])
    at_walls = len(found.events) + np.arange(len(walls))
    return Pieces(
        *found.rows,
        events,
        np.concatenate([found.lines, at_walls]),
        at_walls,
        base_only,
        idle,
        resting,
    )


def _any_of(found: Bools, group: Ints, count: int) -> Bools:
    return np.bincount(group[found], minlength=count) > 0


def _bounds(plane: Plane, tables: Floats) -> tuple[Floats, Floats]:
    """Return values that scaled forms (..., 3, 3) do not leave, whatever the joints do.

    Turns move a form by the length of their two coefficients at most, slides by their sum.
    """
    circles = plane.base_kind == "revolute", plane.lift_kind == "revolute"
    first, second, product = tables[..., 1:, 0], tables[..., 0, 1:], tables[..., 1:, 1:]
    by_base, by_lift = (
        np.hypot(c[..., 0], c[..., 1]) if circle else np.abs(c).sum(axis=-1)
        for c, circle in zip((first, second), circles, strict=True)
    )
    if all(circles):  # the largest singular value
        both = np.sqrt((product**2).sum(axis=(-2, -1)) / 2 + _gap_of_squares(product) / 2)
    else:
        over = np.hypot(product[..., 0], product[..., 1]) if circles[1] else np.abs(product).sum(-1)
        both = np.hypot(over[..., 0], over[..., 1]) if circles[0] else over.sum(axis=-1)
    reach = by_base + by_lift + both
    return tables[..., 0, 0] - reach, tables[..., 0, 0] + reach


def _gap_of_squares(m: Floats) -> Floats:
    """Return the difference of the squared singular values of 2 x 2 matrices."""
    a, b, c, d = m[..., 0, 0], m[..., 0, 1], m[..., 1, 0], m[..., 1, 1]
    return np.asarray(np.hypot(a * a + b * b - c * c - d * d, 2 * (a * c + b * d)))


# --- pieces ---------------------------------------------------------------------------------------


class _Contacts:
    """The contacts of some features: `rows` as `Pieces` has them first, their events, and lines."""

    def __init__(self, plane: Plane, finder: Finder, chosen: Ints) -> None:
        self.plane, self.finder, self.chosen = plane, finder, chosen
        m, contacts = plane.count, plane.contacts
        own = finder.events(finder.own(m + chosen))
        # Features of one curve have their folds and jumps at one place.
        curve = contacts.curves[own.what[:, 1] - m]
        own.key[:] = contacts.keys.max(initial=0) + 1 + len(KINDS) * curve + own.what[:, 0]
        first_side = m + len(contacts.forms)
        side_of = first_side + SIDES * chosen[:, None] + np.arange(SIDES)
        varies = plane.sides[chosen].reshape(len(chosen), SIDES, 9)[:, :, 1:].any(axis=2)
        # Two corners let go where an edge with one of its ends does: that event is a simple one.
        varies &= ~contacts.corners[chosen][:, None]
        k, s = np.nonzero(varies)
        met = finder.events(finder.meetings(m + chosen[k], side_of[k, s]))
        side = met.what[:, 1:].max(axis=1, initial=0) - first_side
        met.key[:] = contacts.keys.reshape(-1)[side]
        feature = np.searchsorted(chosen, side // SIDES)
        given, taken = self._handed_over(met)
        of = np.concatenate([np.searchsorted(chosen, own.what[:, 1] - m), feature, given])
        found = Events.joined([own, met, met[taken]])
        kept = which(self._matters(of, found))
        of, found = finder.isolated(found[kept], of[kept])
        self._cut(of, found)

    def _handed_over(self, met: Events) -> tuple[Ints, Ints]:
        """Return which features of two corners share events of edges, and which events."""
        contacts, chosen = self.plane.contacts, self.chosen
        corners = which(contacts.corners[chosen])
        keys = contacts.keys[chosen[corners]]
        k, side = np.nonzero(keys >= 0)
        key, feature = keys[k, side], corners[k]
        pairs = np.unique(np.stack([key, feature], axis=1), axis=0)
        order = np.argsort(met.key, kind="stable")
        start = np.searchsorted(met.key[order], pairs[:, 0])
        end = np.searchsorted(met.key[order], pairs[:, 0] + 1)
        pick, event = ranges(start, end)
        return pairs[pick, 1], order[event]

    def _matters(self, of: Ints, found: Events) -> Bools:
        """Tell at which events a root of the feature may be a contact.

        Elsewhere a side condition of both roots is negative by more than it can change so near.
        """
        plane, feature = self.plane, self.chosen[of]
        row = plane.count + feature
        c = np.einsum("ni,nij->jn", basis(plane.base_kind, found.t), plane.table[row])
        slack = 4 * found.radius / plane.base_unit
        values, errors, real = plane.roots_and_errors(row, c, slack)
        over, _ = _sides_over(plane, feature, found.t, values)
        moved = np.sqrt(found.radius / plane.base_unit) + np.minimum(errors / plane.lift_unit, 1.0)
        drift = DRIFT * (moved + 1e-9)
        held = (over >= -drift.T[:, :, None]).all(axis=2)
        return np.asarray(held.any(axis=1) & (real >= 0))

    def _cut(self, of: Ints, found: Events) -> None:
        """Cut the base at each feature's events, and keep the intervals that are contacts."""
        plane, low, high = self.plane, *self.plane.ends
        of, found = self._in_order(of, found)
        n, every = len(self.chosen), np.arange(len(self.chosen))
        t = np.concatenate([found.t, np.full(n, low), np.full(n, high)])
        owner = np.concatenate([of, every, every])
        number = np.concatenate([np.arange(len(of)), np.full(2 * n, END)])
        # Events that balls have put in order keep it, although their doubles may not show it.
        place = np.concatenate([np.arange(len(of)) + n, every, len(of) + n + every])
        order = np.lexsort([place, owner])
        owner, t, number = owner[order], t[order], number[order]
        begin = which(owner[1:] == owner[:-1])
        self.events = found
        f, start, end = owner[begin], t[begin], t[begin + 1]
        first, last = number[begin], number[begin + 1]
        at, exact = self._inside(start, end, first, last)
        touching = self._touching(f, at, exact)
        strict = np.array([self._is_strict(found)]).reshape(-1)
        kind = np.append(strict, True)[np.where(first == END, len(strict), first)]
        near = self._near(f, start)
        rows, lines = [], [np.zeros(0, dtype=np.int64)]
        enters = _falls(plane, plane.table[plane.count :][self.chosen[f]], at)
        after = np.append(f[1:] == f[:-1], False)[: len(f)]
        for branch in (0, 1):
            here = touching[:, branch]
            hard = kind | near[:, branch]
            follows = here & after & np.append(here[1:], False)[: len(here)]
            goes_on = follows & ~np.append(hard[1:], True)[: len(here)]
            went_on = np.append(False, goes_on[:-1])[: len(here)]
            a, b = which(here & ~went_on), which(here & ~goes_on)
            sign = np.full(len(a), 2 * branch - 1)
            rows.append(
                (self.chosen[f[a]], sign, start[a], end[b], first[a], last[b], enters[a, branch])
            )
            lines += [first[a][first[a] >= 0], last[b][last[b] >= 0]]
        feature, sign, starts, ends, one, other, sense = (
            np.concatenate(x) for x in zip(*rows, strict=True)
        )
        low_v, high_v = self._boxes(feature, sign, starts, ends)
        self.rows = feature, sign, starts, ends, one, other, sense, low_v, high_v
        self.lines = np.unique(np.concatenate(lines))

    def _is_strict(self, found: Events) -> Bools:
        """Tell which events end a piece in any case: an angle may jump there, or roots meet."""
        first = self.plane.count + len(self.plane.contacts.forms)
        return np.asarray(found.what[:, 1:].max(axis=1, initial=0) < first)

    def _in_order(self, of: Ints, found: Events) -> tuple[Ints, Events]:
        """Sort events by feature and base value; balls decide what doubles do not."""
        low, high = self.plane.ends
        inside = (found.t >= low - found.radius) & (found.t <= high + found.radius)
        order = np.lexsort([found.t, of])
        order = order[inside[order]]
        of, found = of[order], found[order]
        lost: list[int] = []  # what balls say is no event

        def decide(rows: list[int], _: list[float]) -> list[list[int]]:
            groups = self._ranked(found, rows)
            lost.extend({*rows}.difference(*groups))
            return groups

        order, group, _ = ranked(of, found.t, found.radius, False, decide)
        # Of events that are one the first that ends a piece stands for all.
        order = order[np.lexsort([~self._is_strict(found)[order], group])]
        order = order[np.unique(group, return_index=True)[1]]
        before = found.t.copy()
        near_end = (before - found.radius <= low) | (before + found.radius >= high)
        kept = np.array(
            [
                row
                for row in order[~np.isin(order, lost)].tolist()
                if not near_end[row] or self._within(found, row)
            ],
            dtype=np.int64,
        )
        # On a circle some lie a turn away now, at the other end of their feature's events.
        kept = kept[np.lexsort([np.sign(found.t - before)[kept], of[kept]])]
        return of[kept], found[kept]

    def _ranked(self, found: Events, rows: list[int]) -> list[list[int]]:
        """Return events that overlap in their true order, those that are one together."""
        if len({int(found.key[r]) for r in rows}) == 1 and found.key[rows[0]] >= 0:
            return [rows]
        zeros = [(r, self.finder.zero(found, r)) for r in rows]
        for r, zero in zeros:  # what is known now need not be found again
            if zero is not None and found.exact[r] < 0:
                found.exact[r] = len(self.finder.zeros)
                self.finder.zeros.append(zero)
        known = [(r, zero) for r, zero in zeros if zero is not None]
        groups = in_order(known, lambda item, bits: self.finder.precise.refined(item[1], bits))
        return [[r for r, _ in group] for _, group in groups]

    def _within(self, found: Events, row: int) -> bool:
        """Tell whether an event beside an end of the range lies inside; on the end it does not.

        Of a circle the end is its cut: an event beyond lies a turn away, within the other end.
        """
        plane, precise = self.plane, self.finder.precise
        zero = self.finder.zero(found, row)
        if zero is None:
            return False
        upper = bool(found.t[row] > sum(plane.ends) / 2)
        end = Zero(None, 0, lambda: precise.ends("base")[int(upper)])
        groups = in_order([zero, end], precise.refined)
        if len(groups) == 1:
            return False
        inside = (groups[0][1][0] is zero) == upper
        if not inside and plane.base_range is None:
            turns = -1 if upper else 1
            found.t[row] += turns * TURN
            found.exact[row] = len(self.finder.zeros)
            self.finder.zeros.append(shifted(precise, zero, turns))
            return True
        return inside

    def _inside(
        self, start: Floats, end: Floats, first: Ints, last: Ints
    ) -> tuple[Floats, dict[int, Any]]:
        """Return a base value inside each interval, and exact ones where doubles are too near."""
        events = self.events
        radius = np.append(events.radius, 0.0)
        doubt = radius[np.maximum(first, -1)] + radius[np.maximum(last, -1)]  # 0 at an end
        at = start + INSIDE * (end - start)
        exact: dict[int, Any] = {}
        for k in which(end - start <= 8 * doubt + 64 * UNIT * np.abs(at)).tolist():
            a, b = (self._ball_of(e, upper) for e, upper in ((first[k], 0), (last[k], 1)))
            if a is not None and b is not None:
                with precision(1024):
                    exact[k] = midpoint(a, b)
        return at, exact

    def _ball_of(self, event: int, upper: int) -> Any:
        precise = self.finder.precise
        if event == END:
            with precision(1024):
                return precise.ends("base")[int(upper)]
        zero = self.finder.zero(self.events, event)
        return None if zero is None else precise.refined(zero, 1024)

    # --- what is a contact ----------------------------------------------------------------------

    def _touching(self, f: Ints, t: Floats, exact: dict[int, Any]) -> Bools:
        """Tell of both roots of features over base values whether they are contacts, (n, 2)."""
        plane, feature = self.plane, self.chosen[f]
        row = plane.count + feature
        c = np.einsum("ni,nij->jn", basis(plane.base_kind, t), plane.table[row])
        values, errors, real = plane.roots_and_errors(row, c)
        over, lift_slopes = _sides_over(plane, feature, t, values)
        off = np.minimum(errors.T, 8 * plane.lift_unit)
        side_doubt = 16 * plane.side_eps[feature][:, None, :] + off[:, :, None] * lift_slopes
        held = over > side_doubt
        missed = over < -side_doubt
        constant = ~plane.sides.reshape(-1, SIDES, 9)[feature][:, :, 1:].any(axis=2)
        held |= (constant & (plane.sides[feature][:, :, 0, 0] >= 0))[:, None, :]
        result = np.asarray(held.all(axis=2) & (real > 0)[:, None])
        unknown = ~missed.any(axis=2) & ~result & (real >= 0)[:, None]
        for k, branch in np.argwhere(unknown).tolist() + [
            [k, b] for k in exact for b in (0, 1) if not unknown[k, b]
        ]:
            result[k, branch] = self._decided(int(feature[k]), branch, exact.get(k, t[k]))
        if plane.lift_kind == "prismatic":
            result[plane.affine[row], 1] = False
        return result

    def _decided(self, feature: int, branch: int, at: Any) -> bool:
        """Tell in balls whether a root of a feature is a contact at a base value."""
        from flint import arb

        plane, precise = self.plane, self.finder.precise
        row = plane.count + feature
        with precision(1024):
            t = arb(at)
        if precise.real(row, lambda bits: t) < 0:
            return False
        if plane.lift_kind == "prismatic" and plane.affine[row] and branch:
            return False

        def root(bits: int) -> Any:
            return precise.root(row, 2 * branch - 1, t, bits)

        varied = plane.sides[feature].reshape(SIDES, 9)[:, 1:].any()
        with precision(256):
            if varied and root(256) is None:
                return False
        return precise.holds(feature, t, root)

    def _near(self, f: Ints, t: Floats) -> Bools:
        """Tell at which starts a side condition of a root may touch zero: two contacts may meet."""
        plane, feature = self.plane, self.chosen[f]
        row = plane.count + feature
        c = np.einsum("ni,nij->jn", basis(plane.base_kind, t), plane.table[row])
        values, _, _ = plane.roots_and_errors(row, c)
        over, _ = _sides_over(plane, feature, t, values)
        varied: Any = plane.sides.reshape(-1, SIDES, 9)[feature][:, :, 1:].any(axis=2)
        return np.asarray(((np.abs(over) <= WALL) & varied[:, None]).any(axis=2))

    def _boxes(
        self, feature: Ints, branch: Ints, start: Floats, end: Floats
    ) -> tuple[Floats, Floats]:
        """Return lift values between which pieces lie: at both ends and where they turn back."""
        plane = self.plane
        used = np.unique(feature)
        turns = self._turning(used)
        of, at = turns
        order = np.lexsort([at, of])
        of, at = of[order], at[order]
        k = np.searchsorted(used, feature)
        big = 4 * (plane.ends[1] - plane.ends[0]) + 1
        index = of * big + (at - plane.ends[0])
        first = np.searchsorted(index, k * big + (start - plane.ends[0]))
        last = np.searchsorted(index, k * big + (end - plane.ends[0]))
        pick, event = ranges(first, last)
        inset = 1e-9 * (end - start)
        owner = np.concatenate([np.arange(len(feature))] * 2 + [pick])
        t = np.concatenate([start + inset, end - inset, at[event]])
        # Two places more, because an angle may go up to a turn between its ends.
        for part in (1 / 3, 2 / 3):
            owner = np.concatenate([owner, np.arange(len(feature))])
            t = np.concatenate([t, start + part * (end - start)])
        order = np.lexsort([t, owner])
        owner, t = owner[order], t[order]
        rows = np.stack([plane.count + feature, branch, np.zeros_like(branch)], axis=1)[owner]
        v = plane.follow(rows, t[:, None])[:, 0]
        if plane.lift_kind == "revolute":  # pieces do not jump: steps of less than half a turn
            step = np.diff(v, prepend=v[:1])
            new = np.append(True, owner[1:] != owner[:-1])[: len(owner)]
            jumps = np.where(new, 0.0, -TURN * whole_turns(step)).cumsum()
            v = v + jumps - jumps[which(new)][new.cumsum() - 1] if len(v) else v
        begin = np.searchsorted(owner, np.arange(len(feature)))
        if not len(feature):
            return np.zeros(0), np.zeros(0)
        return np.minimum.reduceat(v, begin), np.maximum.reduceat(v, begin)

    def _turning(self, features: Ints) -> tuple[Ints, Floats]:
        """Return where curves of features turn back along the lift: number of the feature, base."""
        plane = self.plane
        if not len(features):
            return np.zeros(0, dtype=np.int64), np.zeros(0)
        slopes = _along_base(plane, plane.scaled[plane.count + features])
        own = Finder(_Slopes(plane, features, slopes), self.finder.precise)  # type: ignore[arg-type]
        n = len(features)
        return own.quick(np.arange(n), n + np.arange(n))


class _Slopes:
    """A plane of some features' forms and their derivatives along the base: for boxes only."""

    def __init__(self, plane: Plane, features: Ints, slopes: Floats) -> None:
        rows = plane.count + features
        self.scaled = np.concatenate([plane.scaled[rows], slopes])
        self.eps = np.concatenate([plane.eps[rows], np.full(len(slopes), 8 * UNIT)])
        self.base_kind, self.lift_kind = plane.base_kind, plane.lift_kind
        self.ends, self.base_range = plane.ends, plane.base_range
        self.lift_range, self.lift_ends = plane.lift_range, plane.lift_ends
        self.base_unit, self.lift_unit = plane.base_unit, plane.lift_unit


def _along_base(plane: Plane, tables: Floats) -> Floats:
    """Return the derivative of scaled forms along the base, scaled to largest coefficient 1."""
    slope = np.zeros_like(tables)
    if plane.base_kind == "revolute":
        slope[:, 1], slope[:, 2] = tables[:, 2], -tables[:, 1]
    else:
        slope[:, 0], slope[:, 1] = tables[:, 1], 2 * tables[:, 2]
    return normalised(slope)


def _sides_over(plane: Plane, feature: Ints, t: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Return side conditions of features at lift values (2, n) over base values, (n, 2, sides).

    And the sizes of their slopes along the lift, a unit of the lift each.
    """
    factors = basis(plane.base_kind, t / plane.base_unit)
    over = np.einsum("ni,nsij->nsj", factors, plane.sides[feature])
    place = np.nan_to_num(v.T / plane.lift_unit)
    values = np.einsum("nsj,nrj->nrs", over, basis(plane.lift_kind, place))
    swing = np.abs(over[..., 1]) + 2 * np.abs(over[..., 2])
    return values, np.broadcast_to(swing[:, None], values.shape) / plane.lift_unit


def _falls(plane: Plane, tables: Floats, t: Floats) -> Bools:
    """Tell at both roots, (n, 2), whether a form falls along the lift.

    On a circle it is positive from theta - alpha to theta + alpha, even where the two are one.
    """
    if plane.lift_kind == "revolute":
        return np.tile([False, True], (len(t), 1))
    c = np.einsum("ni,nij->nj", basis(plane.base_kind, t), tables)
    bends = np.where(c[:, 2] == 0, -c[:, 1], c[:, 2])  # an affine root stands first
    return np.stack([bends > 0, bends < 0], axis=1)


# --- walls ----------------------------------------------------------------------------------------


def _walls(plane: Plane, finder: Finder, alive: Ints) -> Events:
    """Return base values at which a feature's form vanishes on the whole fibre.

    Where one of its side conditions is negative on the whole fibre, too, it is no wall.
    """
    rows = plane.count + alive
    table = plane.scaled[rows]
    size = np.abs(table).sum(axis=1)
    largest = size[:, 1:].max(axis=1, initial=0.0)
    part = np.where(largest > 0, 1 + size[:, 1:].argmax(axis=1), 0)
    requests = [
        finder.of_kind(kind, rows[part == k])
        for k, kind in enumerate(("constant", "first", "second"))
    ]
    events = finder.events(requests)
    row = events.what[:, 1]
    factors = basis(plane.base_kind, events.t / plane.base_unit)
    left = np.abs(np.einsum("ni,nij->nj", factors, plane.scaled[row]))
    doubt = 32 * plane.eps[row] + 4 * events.radius / plane.base_unit
    blank = (left <= doubt[:, None]).all(axis=1)
    over = np.einsum("ni,nsij->nsj", factors, plane.sides[row - plane.count])
    swing = np.hypot(over[..., 1], over[..., 2])
    if plane.lift_kind == "prismatic":
        swing = np.abs(over[..., 1]) + np.abs(over[..., 2])
    slack = 16 * plane.side_eps[row - plane.count] + 4 * events.radius[:, None] / plane.base_unit
    possible = (over[..., 0] + swing >= -slack).all(axis=1)
    return finder.isolated(events[which(blank & possible)])[1]


# --- crossings ------------------------------------------------------------------------------------


def crossings(plane: Plane, pieces: Pieces, finder: Finder) -> Events:
    """Return events at which contacts of different pairs cross, or a contact and a form.

    Only pieces whose boxes meet are paired. Some events are spurious; none is missing.
    """
    m, contacts = plane.count, plane.contacts
    one, other = _meeting_boxes(plane, pieces)
    one, other = _crossing(plane, pieces, one, other)
    size = m + len(contacts.forms)
    of_curve = _first_of_curve(contacts.curves)
    a, b = of_curve[pieces.feature[one]], of_curve[pieces.feature[other]]
    key, group = np.unique(np.minimum(a, b) * size + np.maximum(a, b), return_inverse=True)
    first, second = m + key // size, m + key % size
    found = finder.events(finder.meetings(first, second))
    # An event of one row alone, where a form of degree one loses its root, names no pair of pieces.
    alone = found.what[:, 1] == found.what[:, 2]
    lone, found = found[which(alone)], found[which(~alone)]
    keys = _shared(contacts.keys[found.what[:, 1] - m], contacts.keys[found.what[:, 2] - m])
    found.key[:] = keys
    # Every zero is looked at by all pieces of its two features.
    lowest = np.minimum(found.what[:, 1], found.what[:, 2]) - m
    rows = np.searchsorted(key, lowest * size + found.what[:, 1:].max(axis=1, initial=0) - m)
    order = np.argsort(group, kind="stable")
    begin = np.searchsorted(group[order], np.arange(len(key) + 1))
    pick, k = ranges(begin[rows], begin[rows + 1])
    i, j, t, radius = one[order[k]], other[order[k]], found.t[pick], found.radius[pick]
    slack = NEAR * plane.base_unit + radius
    near = np.ones(len(t), dtype=np.bool_)
    for end in (i, j):
        near &= (t >= pieces.start[end] - slack) & (t <= pieces.end[end] + slack)
    i, j, t, pick = i[near], j[near], t[near], pick[near]
    apart = _values(plane, pieces, i, t) - _values(plane, pieces, j, t)
    if plane.lift_kind == "revolute":
        apart -= TURN * whole_turns(apart)
    kept = np.unique(pick[np.abs(apart) <= AGREE * plane.lift_unit])
    return Events.joined([lone, found[kept], _crossed_forms(plane, pieces, finder)])


def _first_of_curve(curves: Ints) -> Ints:
    """Return of each feature the first one of its curve: it stands for all."""
    _, first, back = np.unique(curves, return_index=True, return_inverse=True)
    return np.asarray(first[back])


def _shared(one: Ints, other: Ints) -> Ints:
    """Return a key that two rows of keys share, -1 where there is none."""
    same = (one[:, :, None] == other[:, None, :]) & (one[:, :, None] >= 0)
    found = np.where(same, one[:, :, None], -1).max(axis=(1, 2), initial=-1)
    return np.asarray(found)


def _crossing(plane: Plane, pieces: Pieces, one: Ints, other: Ints) -> tuple[Ints, Ints]:
    """Leave out pairs of pieces that have nothing in common but what is an event already.

    These are pieces of one curve, and features that end at one pair of corners: there their forms
    touch, and have no other common zero, unless two edges keep a distance.
    """
    contacts = plane.contacts
    a, b = pieces.feature[one], pieces.feature[other]
    same = contacts.curves[a] == contacts.curves[b]
    ends = contacts.ends[a][:, :, None] == contacts.ends[b][:, None, :]
    touching = (ends & (contacts.ends[a] >= 0)[:, :, None]).any(axis=(1, 2))
    touching &= contacts.corners[a] | contacts.corners[b] | contacts.sharp[a]
    kept = ~same & ~touching
    return one[kept], other[kept]


def _meeting_boxes(plane: Plane, pieces: Pieces) -> tuple[Ints, Ints]:
    """Return pairs of pieces, of different pairs of bodies, whose boxes meet."""
    pair = plane.contacts.pair[pieces.feature]
    every = np.arange(len(pair))
    middle = (pieces.low + pieces.high) / 2
    half = (pieces.high - pieces.low) / 2 + BOX * plane.lift_unit
    near = NEAR * plane.base_unit
    found = [(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))]
    order = np.argsort(pieces.start, kind="stable")
    last = np.searchsorted(pieces.start[order], pieces.end[order] + near, side="right")
    many = np.cumsum(last - every - 1)
    cuts = np.arange(PAIRS, many.max(initial=0), PAIRS)
    for at in np.split(every, np.searchsorted(many, cuts)):
        pick, j = ranges(at + 1, last[at])
        i, j = order[at[pick]], order[j]
        apart = np.abs(middle[j] - middle[i])
        if plane.lift_kind == "revolute":
            apart = np.abs(apart - TURN * np.round(apart / TURN))
        met = (apart <= half[i] + half[j]) & (pair[j] != pair[i])
        found.append((i[met], j[met]))
    first, second = (np.concatenate(x) for x in zip(*found, strict=True))
    return first, second


def _values(plane: Plane, pieces: Pieces, k: Ints, t: Floats) -> Floats:
    """Return lift values of pieces over base values, each kept within its piece, (n,)."""
    t = np.clip(t, pieces.start[k], pieces.end[k])
    return plane.follow(pieces.roots(plane, k), t[:, None])[:, 0]


def _crossed_forms(plane: Plane, pieces: Pieces, finder: Finder) -> Events:
    """Return events at which a contact may cross a form that stands alone."""
    m = plane.count
    lifts = np.flatnonzero(plane.scaled[:m, :, 1:].any(axis=(1, 2)))
    feature = _first_of_curve(plane.contacts.curves)[pieces.feature]
    features = np.unique(feature)
    i, j = (x.ravel() for x in np.meshgrid(lifts, m + features, indexing="ij"))
    found = finder.events(finder.meetings(i, j))
    alone = found.what[:, 1] == found.what[:, 2]
    lone, found = found[which(alone)], found[which(~alone)]
    of = found.what[:, 1:].max(axis=1, initial=0) - m
    order = np.argsort(feature, kind="stable")
    begin = np.searchsorted(feature[order], of)
    end = np.searchsorted(feature[order], of + 1)
    pick, k = ranges(begin, end)
    k, t = order[k], found.t[pick]
    slack = NEAR * plane.base_unit + found.radius[pick]
    near = (t >= pieces.start[k] - slack) & (t <= pieces.end[k] + slack)
    return Events.joined([lone, found[np.unique(pick[near])]])
