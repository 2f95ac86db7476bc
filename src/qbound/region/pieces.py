"""Where do bodies touch? Pieces of the curves of features, each a contact from end to end.

The curve of a feature's form bounds what its pair forbids only where no side condition is negative.
Between the feature's own events (folds, jumps, ends of the lift, common roots with its own side
conditions; never with other features) a root is a contact or none, and one place inside decides.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from qbound.forms.angles import TURN, whole_turns
from qbound.forms.harmonic import basis
from qbound.records import dataclass
from qbound.region.critical import Complexes, base_values, meetings, own_events, univariate
from qbound.region.plane import Plane, normalised, ranges
from qbound.tolerances import AGREE, BOX, CONTACT_SIDE, NEAR, NEGLIGIBLE, SAME_CRITICAL, WALL

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

INSIDE = 0.43
"""Where an interval is looked at: off its middle, which may be a place of symmetry."""

PAIRS = 2**20
"""Pairs of pieces that are looked at together, about: some 60 MB."""

NONE, BACK, OWN = 0, 1, 2
"""What happens at an event: a side condition may change; the curve turns back; more."""


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
    enters : ndarray of bool, shape (k,)
        Whether one comes into collision there, going up the lift.
    lines : ndarray
        Base values at which a contact begins, ends or jumps.
    walls : ndarray
        Base values at which bodies may touch along a fibre.
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
    enters: Bools
    lines: Floats
    walls: Floats
    base_only: Bools
    idle: Bools
    resting: Bools

    def roots(self, plane: Plane, k: Ints) -> Ints:
        """Return the root that each of some contacts follows, as `Root`, shape (len(k), 3)."""
        return np.stack([plane.count + self.feature[k], self.branch[k], np.zeros_like(k)], axis=1)


def find_pieces(plane: Plane) -> Pieces:
    """Find all contacts of the bodies of a plane, and the walls."""
    contacts = plane.contacts
    if not contacts.pairs:
        none, nothing = np.zeros(0, dtype=np.int64), np.zeros(0)
        no = np.zeros(0, dtype=np.bool_)
        return Pieces(none, none, nothing, nothing, no, nothing, nothing, no, no, no)
    forms, sides = plane.scaled[plane.count :], plane.sides
    low, high = _bounds(plane, forms)
    most = _bounds(plane, sides)[1]
    alive = contacts.touching & (low <= 0) & (high >= 0) & (most >= -CONTACT_SIDE).all(axis=1)
    lifts = forms[:, :, 1:].any(axis=(1, 2))
    moved: Bools = np.asarray(lifts | sides[:, :, :, 1:].any(axis=(1, 2, 3)))
    base_only = ~_any_of(moved, contacts.pair, contacts.pairs)
    idle = ~_any_of(alive, contacts.pair, contacts.pairs)
    resting = _any_of(alive & ~forms.any(axis=(1, 2)), contacts.pair, contacts.pairs)
    walls = _walls(plane, np.flatnonzero(alive), forms, sides)
    chosen = np.flatnonzero(alive & lifts)
    return Pieces(*_contacts(plane, chosen, forms, sides), walls, base_only, idle, resting)


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
    reach = by_base + by_lift + both + NEGLIGIBLE
    return tables[..., 0, 0] - reach, tables[..., 0, 0] + reach


def _gap_of_squares(m: Floats) -> Floats:
    """Return the difference of the squared singular values of 2 x 2 matrices."""
    a, b, c, d = m[..., 0, 0], m[..., 0, 1], m[..., 1, 0], m[..., 1, 1]
    return np.asarray(np.hypot(a * a + b * b - c * c - d * d, 2 * (a * c + b * d)))


# --- pieces ---------------------------------------------------------------------------------------


def _contacts(
    plane: Plane, chosen: Ints, forms: Floats, sides: Floats
) -> tuple[Ints, Ints, Floats, Floats, Bools, Floats]:
    """Return feature, branch, start, end and sense of contacts of some features, and the lines."""
    of, start, end, event = _intervals(plane, chosen, forms, sides)
    after = np.append(of[1:] == of[:-1], False)[: len(of)]
    before = np.append(False, after[:-1])[: len(of)]
    t = start + INSIDE * (end - start)
    held = (_sides_at(plane, chosen[of], t) >= -CONTACT_SIDE).all(axis=2)
    touching: Bools = np.asarray(held)
    # Where a side condition touches zero, and a contact goes on, two of them may meet.
    near: Bools = np.asarray(np.abs(_sides_at(plane, chosen[of], start)) <= WALL)
    varied: Bools = np.asarray(sides.reshape(len(sides), -1, 9)[chosen[of], :, 1:].any(axis=2))
    met: Bools = np.asarray((near & varied[:, None]).any(axis=2))
    enters = _falls(plane, plane.table[plane.count :][chosen[of]], t)
    found, lines = [], [np.zeros(0)]
    for branch in (0, 1):
        here = touching[:, branch]
        kind = np.where(met[:, branch], OWN, event)
        following = np.append(kind[1:], OWN)[: len(kind)]
        goes_on = here & after & np.append(here[1:], False)[: len(here)]
        went_on = here & before & np.append(False, here[:-1])[: len(here)]
        first = np.flatnonzero(here & ~(went_on & (kind == NONE)))
        last = np.flatnonzero(here & ~(goes_on & (following == NONE)))
        sign = np.full(len(first), 2 * branch - 1)
        found.append((chosen[of[first]], sign, start[first], end[last], enters[first, branch]))
        # A contact that only turns back along the lift goes on: that is no line.
        lines += [start[here & ~(went_on & (kind != OWN))]]
        lines += [end[here & ~(goes_on & (following != OWN))]]
    feature, branches, starts, ends, senses = (np.concatenate(x) for x in zip(*found, strict=True))
    return feature, branches, starts, ends, senses, np.concatenate(lines)


def _intervals(
    plane: Plane, chosen: Ints, forms: Floats, sides: Floats
) -> tuple[Ints, Floats, Floats, Ints]:
    """Cut the base at each feature's own events: feature, start, end, and what happens at start.

    A contact must end there if an angle may jump or a root pass an end of the lift's range (`OWN`),
    and for its box to be that of its ends where it turns back along the lift (`BACK`).
    """
    c = univariate(plane, forms[chosen])
    rows, at = base_values(plane, own_events(plane, c))
    g = univariate(plane, sides[chosen].reshape(-1, 3, 3))
    varies = sides[chosen].reshape(-1, 9)[:, 1:].any(axis=1)
    kept = np.flatnonzero(varies)
    of_side = kept // sides.shape[1]
    meet, there = base_values(plane, meetings(plane, c[of_side], g[kept]))
    steep = univariate(plane, _along_base(plane, forms[chosen]))
    turn, back = base_values(plane, meetings(plane, c, steep))
    low, high = plane.ends
    every = np.arange(len(chosen))
    of = np.concatenate([rows, turn, of_side[meet], every, every])
    t = np.concatenate([at, back, there, np.full(len(every), low), np.full(len(every), high)])
    kind = np.repeat([OWN, BACK, NONE], [len(rows), len(turn), len(there) + 2 * len(every)])
    inside = (t >= low) & (t <= high)
    of, t, kind = of[inside], t[inside], kind[inside]
    order = np.lexsort([t, of])
    of, t, kind = of[order], t[order], kind[order]
    wide = (np.diff(t) > SAME_CRITICAL) & (np.diff(of) == 0)
    # Of events that are one by rounding the strictest counts.
    group = np.cumsum(np.append(False, wide | (np.diff(of) != 0))[: len(of)])
    strictest = np.zeros(len(kind), dtype=np.int64)
    np.maximum.at(strictest, group, kind)
    k = np.flatnonzero(wide)
    return of[k], t[k], t[k + 1], strictest[group[k]]


def _along_base(plane: Plane, tables: Floats) -> Floats:
    """Return the derivative of scaled forms along the base, scaled to largest coefficient 1."""
    slope = np.zeros_like(tables)
    if plane.base_kind == "revolute":
        slope[:, 1], slope[:, 2] = tables[:, 2], -tables[:, 1]
    else:
        slope[:, 0], slope[:, 1] = tables[:, 1], 2 * tables[:, 2]
    return normalised(slope)


def _sides_at(plane: Plane, feature: Ints, t: Floats) -> Floats:
    """Return the side conditions of features at both roots over base values, (n, 2, sides).

    NaN where there is no root.
    """
    tables = plane.table[plane.count :][feature]
    c = np.einsum("ni,nij->nj", basis(plane.base_kind, t), tables)
    lift = basis(plane.lift_kind, plane.roots_of(c.T).T / plane.lift_unit)
    factors = basis(plane.base_kind, t / plane.base_unit)
    over = np.einsum("ni,nsij->nsj", factors, plane.sides[feature])
    return np.asarray(np.einsum("nsj,nrj->nrs", over, lift))


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


def _walls(plane: Plane, alive: Ints, forms: Floats, sides: Floats) -> Floats:
    """Return base values at which a feature's form vanishes on the whole fibre.

    Where one of its side conditions is negative on the whole fibre, too, it is no wall.
    """
    c = univariate(plane, forms[alive])
    table = forms[alive]
    sizes = np.abs(table).sum(axis=1)
    largest = sizes[:, 1:].max(axis=1, initial=0.0)
    which = np.where(largest > 0, 1 + sizes[:, 1:].argmax(axis=1), 0)
    rows, t = base_values(plane, iter([(np.arange(len(c)), c[np.arange(len(c)), which])]))
    factors = basis(plane.base_kind, t / plane.base_unit)
    left = np.abs(np.einsum("ni,nij->nj", factors, table[rows]))
    blank = (left <= WALL).all(axis=1)
    over = np.einsum("ni,nsij->nsj", factors, sides[alive[rows]])
    swing = np.hypot(over[..., 1], over[..., 2])
    if plane.lift_kind == "prismatic":
        swing = np.abs(over[..., 1]) + np.abs(over[..., 2])
    possible = (over[..., 0] + swing >= -CONTACT_SIDE).all(axis=1)
    low, high = plane.ends
    inside = (t >= low) & (t <= high)
    return np.unique(t[blank & possible & inside])


# --- crossings ------------------------------------------------------------------------------------


def crossings(plane: Plane, pieces: Pieces) -> Floats:
    """Return base values at which contacts of different pairs cross, or a contact and a form.

    Only pieces whose boxes meet are paired. Some values are spurious; none is missing.
    """
    m, pair = plane.count, plane.contacts.pair[pieces.feature]
    c = univariate(plane, plane.scaled)
    one, other = _meeting_boxes(plane, pieces, pair)
    key, group = np.unique(
        pieces.feature[one] * len(c) + pieces.feature[other], return_inverse=True
    )
    first, second = m + key // len(c), m + key % len(c)
    rows, t = base_values(plane, meetings(plane, c[first], c[second]))
    # Every root is looked at by all pieces of its two features.
    order = np.argsort(group, kind="stable")
    begin = np.searchsorted(group[order], np.arange(len(key) + 1))
    pick, k = ranges(begin[rows], begin[rows + 1])
    i, j, t = one[order[k]], other[order[k]], t[pick]
    near = np.ones(len(t), dtype=np.bool_)
    for end in (i, j):
        near &= (t >= pieces.start[end] - NEAR) & (t <= pieces.end[end] + NEAR)
    i, j, t = i[near], j[near], t[near]
    apart = _values(plane, pieces, i, t) - _values(plane, pieces, j, t)
    if plane.lift_kind == "revolute":
        apart -= TURN * whole_turns(apart)
    found = t[np.abs(apart) <= AGREE * plane.lift_unit]
    return np.concatenate([found, _crossed_forms(plane, pieces, c)])


def _meeting_boxes(plane: Plane, pieces: Pieces, pair: Ints) -> tuple[Ints, Ints]:
    """Return pairs of pieces, of different pairs of bodies, whose boxes meet."""
    every = np.arange(len(pair))
    inset = SAME_CRITICAL * 100 * (pieces.end - pieces.start)
    one, other = (
        _values(plane, pieces, every, t) for t in (pieces.start + inset, pieces.end - inset)
    )
    middle, half = (one + other) / 2, np.abs(one - other) / 2 + BOX * plane.lift_unit
    found = [(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64))]
    order = np.argsort(pieces.start, kind="stable")
    last = np.searchsorted(pieces.start[order], pieces.end[order] + NEAR, side="right")
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


def _crossed_forms(plane: Plane, pieces: Pieces, c: Complexes) -> Floats:
    """Return base values at which a contact may cross a form that stands alone."""
    m = plane.count
    lifts = np.flatnonzero(plane.scaled[:m, :, 1:].any(axis=(1, 2)))
    features = np.unique(pieces.feature)
    i, j = (x.ravel() for x in np.meshgrid(lifts, features, indexing="ij"))
    rows, t = base_values(plane, meetings(plane, c[i], c[m + j]))
    order = np.argsort(pieces.feature, kind="stable")
    ends = np.searchsorted(pieces.feature[order], [j[rows], j[rows] + 1]) if len(rows) else (i, i)
    pick, k = ranges(ends[0], ends[1])
    k, t = order[k], t[pick]
    return t[(t >= pieces.start[k] - NEAR) & (t <= pieces.end[k] + NEAR)]
