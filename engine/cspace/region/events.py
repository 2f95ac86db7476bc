"""Events: base values at which roots may appear, meet, pass an end, or stop being contacts.

They are zeros of polynomials, which doubles find with bounds of errors (sentences 2 and 3). What
doubles leave open is asked of exact numbers (sentence 4).

Equal events lie on one line (sentence 5). Where a contact passes from one feature to the next, the
events of both are one by construction: they have the same key. All others are compared in doubles,
and exactly where their errors overlap.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import Any, NamedTuple

import numpy as np

from cspace.arrays import Array, Bools, Floats, Ints, begins, distinct, ranges
from cspace.region.algebra import (
    basis,
    blur,
    crossed,
    fold,
    lift_roots,
    parallel_resultant,
    resultant,
)
from cspace.region.exact import Exact
from cspace.region.kinds import (
    END,
    FOLD,
    LIMIT,
    SHARE,
    SIDE,
    VAGUE,
    WALL,
    clusters,
    made,
    matches,
    taken,
)
from cspace.region.scene import Scene, is_varied
from cspace.region.zeros import SHARP, isolate
from cspace.tolerances import UNIT
from qbound.circle import TURN

POSSIBLE = 1e-5
"""How far a side condition may be negative at a contact that is perhaps one."""

FINE = 1e-10
"""Roots that rounding moves by more are followed about a place of their own."""

VANISHES = 1e-6
"""A form this small along a whole fibre may vanish there."""

Parts = tuple[Ints, Ints, Floats, Floats]
"""Parts of windows: curve, window, both ends."""

Table = tuple[Floats, Floats]
"""Forms (n, 3, 3), and the errors of their coefficients (n,)."""


# --- roots and zeros over the base (sentences 1 and 3) --------------------------------------------


class Roots(NamedTuple):
    """Both roots of curves over base values, (n, 2): rising, falling; angles in the first turn.

    Attributes
    ----------
    v : ndarray, shape (n, 2)
    error : ndarray, shape (n,)
        Of both roots.
    rest, doubt : ndarray, shape (n,)
        Positive where there are roots; and its error.
    """

    v: Floats
    error: Floats
    rest: Floats
    doubt: Floats


def roots_at(scene: Scene, curve: Ints, t: Floats) -> Roots:
    """Return the roots of curves (n,), each over its own base value (sentence 1).

    An error e of the form is an error e / slope of the root, or sqrt(e / bending) at a fold, where
    the slope is zero. Of a form that may vanish on the whole fibre the root may be anywhere.
    """
    c = scene.along(scene.table[curve], t[:, None])[..., 0]
    rest, double = fold(c, scene.turns[1]), scene.double[curve]
    v = lift_roots(scene.turns[1], c, double)
    doubt = 3 * scene.errors[curve]
    if scene.turns[1]:
        v = scene.in_turn(curve, v)
        bent = np.maximum(np.hypot(c[1], c[2]), 1e-300)
    else:
        v, bent = np.where(np.isnan(v), 0.0, v), np.abs(c[2])
    steep = np.where(double, bent, np.sqrt(np.maximum(rest, 0)))
    error = 4 * doubt / np.maximum(steep, np.sqrt(doubt * bent) + 1e-300) + 16 * UNIT
    error[(np.abs(c) <= doubt).all(axis=0)] = np.inf
    return Roots(v.T, error, rest, scene.fold_errors[curve])


def is_rough(scene: Scene, curve: Ints, t: Floats) -> Bools:
    """Tell which roots lose so many digits that they are followed about a place of their own.

    What counts is the rounding of the form, not what is known of its coefficients.
    """
    lost = 8 * UNIT / (scene.eps[curve] + 8 * UNIT)
    return np.asarray(roots_at(scene, curve, t).error * lost > FINE)


Formula = Callable[..., Any]
"""Of coefficients of forms and ``minus``, as `fold`."""


def zeros(
    scene: Scene,
    formula: Formula,
    degree: int,
    tables: list[Table],
    windows: tuple[Floats, Floats],
    known: tuple[Bools, Bools] | None = None,
) -> tuple[Ints, Floats, Floats, Ints]:
    """Return the zeros of a formula of forms, each row of tables in its own window (sentence 3).

    Parameters
    ----------
    degree : int
        How many coefficients of forms the formula multiplies.
    known : pair of ndarray of bool, optional
        Whether there is a known zero at the start, at the end, of a window.

    Returns
    -------
    row, t, radius : ndarray
    undecided : ndarray of int
        Rows of which doubles do not isolate all zeros; of these none is returned.
    """
    if degree == 1:
        return _simple_zeros(scene, formula, *tables[0], windows)
    low, high = windows
    longest = pi / 2 if scene.turns[0] else max(scene.ends[0][1] - scene.ends[0][0], 1e-300) / 4
    count = np.maximum(np.ceil((high - low) / longest * 0.999999), 1).astype(np.int64)
    part, number = ranges(np.zeros_like(count), count)
    width = ((high - low) / count)[part]
    start = low[part] + number * width
    last = number + 1 == count[part]
    end = np.where(last, high[part], start + width)
    none = np.zeros(len(part), dtype=np.bool_)
    at_ends = (known[0][part] & (number == 0), known[1][part] & last) if known else (none, none)

    def values(which: Ints, t: Floats) -> Floats:
        row = part[which]
        return np.asarray(formula(*(scene.along(table[row], t) for table, _ in tables), -1))

    bounds = [scene.bounds_along(*own) for own in tables]

    def doubts(which: Ints, t: Floats) -> Floats:
        row, near = part[which], []
        for (table, _), (size, most) in zip(
            tables, (x.swapaxes(0, 1) for x in bounds), strict=True
        ):
            a = np.abs(scene.along(table[row], t[:, None])[..., 0])
            near.append(np.stack([a, a + (most - size)[:, row]], axis=1))
        return blur(formula, *near)

    errors = blur(formula, *bounds)[part]
    which, t, radius, vague = isolate(
        values, doubts, errors, 2 * degree, start, end, scene.turns[0], at_ends
    )
    row = part[which]
    if not vague:
        return row, t, radius, row[:0]
    undecided = distinct(part[np.array(sorted(vague), dtype=np.int64)])
    keep = ~np.isin(row, undecided)
    return row[keep], t[keep], radius[keep], undecided


def _simple_zeros(
    scene: Scene, formula: Formula, table: Floats, eps: Floats, windows: tuple[Floats, Floats]
) -> tuple[Ints, Floats, Floats, Ints]:
    """Return the zeros of a formula of one form that is linear in its coefficients, as `zeros`.

    Along the base it is a form like those along the lift: its zeros are those of Theorem 2
    (sentence 1).
    """
    (low, high), turns = windows, scene.turns[0]
    c = np.stack([formula(row, -1) for row in table.transpose(1, 2, 0)])
    size = np.abs(table).transpose(1, 2, 0)
    most = size + (eps + 8 * UNIT) * size.sum(axis=(0, 1))
    doubt = sum(blur(formula, np.stack(both, axis=1)) for both in zip(size, most, strict=True))
    bounds = np.stack([np.abs(c), np.abs(c) + doubt], axis=1)
    rest, off = fold(c, turns), blur(lambda a, minus: fold(a, turns, minus), bounds)
    possible = np.abs(c[0]) <= np.abs(c[1]) + np.abs(c[2]) + 3 * doubt
    t = lift_roots(turns, c, np.zeros(len(rest), dtype=np.bool_))
    if turns:
        t = low + (t - low) % TURN
        count = int((high - low).max(initial=0.0) / TURN) + 2
        t = np.concatenate([t + TURN * k for k in range(-1, count)])
    radius = 2 * doubt / np.sqrt(np.maximum(rest, 1e-300)) + 8 * UNIT * (1 + np.abs(t))
    there = possible & (rest > off) & np.isfinite(t)
    with np.errstate(invalid="ignore"):
        edge = np.minimum(np.abs(t - low), np.abs(t - high)) <= radius
        inside = there & (t > low) & (t < high)
    vague = (possible & (np.abs(rest) <= off)) | (there & (edge | (inside & (radius > SHARP)))).any(
        0
    )
    n, row = np.nonzero(inside & ~vague)
    return row, t[n, row], radius[n, row], np.flatnonzero(vague)


def common_zeros(
    scene: Scene,
    one: Table,
    other: Table,
    windows: tuple[Floats, Floats],
    known: tuple[Bools, Bools] | None = None,
) -> tuple[Ints, Floats, Floats, Ints]:
    """Return where two forms share a root: zeros of their resultant, as `zeros` (sentence 2).

    Of two forms with parallel amplitudes (a body's corner is at the joint; parallel edges) the
    resultant is a square: its root is taken, times the amplitude of a form that has one. Of two
    affine forms the resultant is zero; they share a root where a0 b1 is a1 b0.
    """
    level = _have_parallel_amplitudes(scene, one, other)
    turns, still = scene.turns[1], ~other[0][:, :, 1:].any(axis=(1, 2))
    factor: Formula = parallel_resultant if turns else lambda a, b, m: crossed(a, b, m)[2]
    whole: Formula = lambda a, b, m: resultant(a, b, turns, m)  # noqa: E731
    none, low = np.zeros(0, dtype=np.int64), 3 if turns else 2
    found = [(none, np.zeros(0), np.zeros(0), none)]
    for chosen, degree, formula, both in (
        (~level, 4, whole, (one, other)),
        (level & ~still, low, factor, (one, other)),
        (level & still, low, factor, (other, one)),
    ):
        own = np.flatnonzero(chosen)
        if not len(own):
            continue
        ends = (known[0][own], known[1][own]) if known else None
        tables = [(table[own], eps[own]) for table, eps in both]
        inside = windows[0][own], windows[1][own]
        k, t, radius, vague = zeros(scene, formula, degree, tables, inside, ends)
        found.append((own[k], t, radius, own[vague]))
    row, t, radius, vague = (np.concatenate(x) for x in zip(*found, strict=True))
    return row, t, radius, vague


def _have_parallel_amplitudes(scene: Scene, one: Table, other: Table) -> Bools:
    """Tell of which two forms the amplitudes along the lift are parallel over every base value."""
    if not scene.turns[1]:
        bent = one[0][:, :, 2].any(axis=1) | other[0][:, :, 2].any(axis=1)
        return np.asarray(~bent)
    low, high = scene.ends[0]
    t = np.tile(low + (high - low) * np.array([0.11, 0.29, 0.43, 0.61, 0.83]), (len(one[0]), 1))
    x = crossed(scene.along(one[0], t), scene.along(other[0], t))[0]
    level: Formula = lambda a, b, minus: crossed(a, b, minus)[0]  # noqa: E731
    doubt = blur(level, *(scene.bounds_along(*own) for own in (one, other)))
    return np.asarray((np.abs(x) <= doubt[:, None]).all(axis=1))


# --- events of one curve or one feature (sentence 2) ----------------------------------------------


def find_walls(scene: Scene, exact: Exact) -> Array:
    """Return the walls of forms without the lift at which a contact is possible (sentence 2)."""
    still = ~scene.lifted & scene.table[:, 1:, 0].any(axis=1)
    f = np.flatnonzero(scene.live & still[scene.curve])
    if not len(f):
        return made(WALL, f, 0.0, 0)
    rows = distinct(scene.curve[f])
    low, high = (np.full(len(rows), end) for end in scene.ends[0])
    table = scene.table[rows], scene.eps[rows]
    k, t, radius, vague = zeros(scene, lambda a, _: a[0], 1, [table], (low, high))
    found = made(WALL, t, radius, rows[k])
    found = np.concatenate([found, *(exact.zeros(WALL, int(rows[k]), 0) for k in vague)])
    event, k = matches(scene.curve[f], found["i"])
    possible = np.ones(len(event), dtype=np.bool_)
    for s in range(scene.sides.shape[1]):
        a0, a1, a2 = scene.along(scene.sides[f[k], s], found["t"][event][:, None])[..., 0]
        most = np.hypot(a1, a2) if scene.turns[1] else np.abs(a1) + np.abs(a2)
        possible &= a0 + most > -1e-9
    return found[distinct(event[possible])]


def curve_events(scene: Scene, exact: Exact, curves: Ints, low: Floats, high: Floats) -> Array:
    """Return folds and limits of curves in windows low..high (sentence 2)."""
    turns, ends = scene.turns[1], scene.ends[1]
    asked: list[tuple[int, int, int, Formula]] = [(FOLD, 0, 2, lambda a, m: fold(a, turns, m))]
    for end in range(1 if scene.round[1] else 2):
        one, other = (float(x) for x in basis(turns, np.float64(ends[end]))[1:])
        asked.append((LIMIT, end, 1, _at_lift(one, other, 4 * UNIT * (1 + abs(ends[end])))))
    edges, found = np.sort(np.concatenate([low, high])), []
    for kind, j, degree, formula in asked:
        own = curves[~scene.affine[curves]] if kind == FOLD else curves
        tables, every = [(scene.table[own], scene.eps[own])], np.ones(len(own))
        whole = edges[0] * every, edges[-1] * every
        k, t, radius, vague = zeros(scene, formula, degree, tables, whole)
        after = edges.searchsorted(t)
        near = np.minimum(edges[after] - t, t - edges[after - 1]) <= radius
        lost = distinct(own[np.concatenate([vague, k[near]])])
        sure = (after % 2 == 1) & ~np.isin(own[k], lost)
        found.append(made(kind, t[sure], radius[sure], own[k][sure], j))
        found += [exact.zeros(kind, row, j) for row in lost.tolist()]
    return np.concatenate(found)


def _at_lift(one: float, other: float, error: float) -> Formula:
    """Return the formula of a form's value at a fixed lift value."""
    x, y = (np.array([[abs(value)], [abs(value) + error]]) for value in (one, other))
    return lambda a, minus: (
        a[0] + a[1] * (one if minus < 0 else x) + a[2] * (other if minus < 0 else y)
    )


def whole_fibres(scene: Scene, exact: Exact, events: Array) -> Array:
    """Return as walls the folds and limits at which a form vanishes on the whole fibre.

    Forms that depend on the lift have walls there only (sentence 2).
    """
    c = events["i"]
    sizes = np.abs(scene.along(scene.table[c], events["t"][:, None])[..., 0])
    near = events[(sizes < VANISHES).all(axis=0)]
    vanish = np.array([exact.vanishes(event) for event in near], dtype=np.bool_)
    found = near[vanish]
    return made(WALL, found["t"], found["radius"], found["i"])


def relevant(scene: Scene, events: Array, features: Ints) -> Array:
    """Keep the folds and limits at which some feature of the curve may be a contact."""
    event, k = matches(scene.curve[features], events["i"])
    t = events["t"][event]
    v = roots_at(scene, events["i"][event], t).v
    limit = events["kind"][event] == LIMIT
    v[limit] = np.array(scene.ends[1])[events["j"][event[limit]], None]
    return events[distinct(event[may_touch(scene, features[k], t, v)])]


def may_touch(scene: Scene, f: Ints, t: Floats, v: Floats) -> Bools:
    """Tell where a root of a feature may be a contact, or its form vanishes on the whole fibre."""
    c = scene.along(scene.table[scene.curve[f]], t[:, None])[..., 0]
    whole = (np.abs(c) < VANISHES).all(axis=0)
    with np.errstate(invalid="ignore", over="ignore"):
        near = (scene.sides_at(f, t, v).min(axis=2) > -POSSIBLE).any(axis=1)
    return np.asarray(near | whole)


def existing(scene: Scene, curves: Ints, events: Array, low: Floats, high: Floats) -> Parts:
    """Return the parts of windows over which curves have a root within the lift.

    A part no wider than the errors of its ends may have one.
    """
    c, w = np.repeat(curves, len(low)), np.tile(np.arange(len(low)), len(curves))
    # An event that may be beyond the end of a window is in both.
    reach = events["radius"] * np.array([[-1], [1]])
    inner = np.searchsorted(low, events["t"] + reach, "right") - 1
    inside = (inner >= 0) & (events["t"] + reach < high[np.maximum(inner, 0)])
    inside[1] &= ~inside[0] | (inner[1] != inner[0])
    own, inner = np.tile(np.arange(len(events)), (2, 1))[inside], inner[inside]
    owner = np.concatenate([c, c, events["i"][own]])
    window = np.concatenate([w, w, inner])
    t = np.concatenate([low[w], high[w], np.clip(events["t"][own], low[inner], high[inner])])
    radius = np.concatenate([np.zeros(2 * len(w)), events["radius"][own]])
    order = np.lexsort([t, window, owner])
    owner, window, t, radius = taken(order, owner, window, t, radius)
    k = np.flatnonzero(~begins(owner, window)[1:])
    owner, window, start, end = owner[k], window[k], t[k], t[k + 1]
    thin = end - start <= radius[k] + radius[k + 1]
    v, error, rest, doubt = roots_at(scene, owner, (start + end) / 2)
    bottom, top = scene.ends[1]
    near = error[:, None]
    within = (v > bottom - near) & (v < top + near)
    if scene.turns[1]:  # a root beside the lower end may be named a turn higher
        within |= v > bottom + TURN - near
    there = thin | ((rest >= -doubt) & within.any(axis=1))
    return owner[there], window[there], start[there], end[there]


def side_events(
    scene: Scene,
    exact: Exact,
    features: Ints,
    where: Parts,
) -> Array:
    """Return the events at which side conditions vanish on their features' curves (sentence 2).

    Parameters
    ----------
    where : tuple of ndarray
        As of `existing`.
    """
    curve, _, start, end = where
    which, part = matches(curve, scene.curve[features])
    f, low, high = features[which], start[part], end[part]
    k, s = np.nonzero(is_varied(scene.sides[f]) & ~scene.corners[f][:, None])
    f, low, high = f[k], low[k], high[k]
    if not len(f):
        return made(SIDE, f, 0.0, 0)
    c, key = scene.curve[f], scene.keys[f, s]
    one, other = (scene.table[c], scene.eps[c]), (scene.sides[f, s], scene.side_eps[f, s])
    k, t, radius, vague = common_zeros(scene, one, other, (low, high))
    found = made(SIDE, t, radius, f[k], s[k], key[k])
    for i, j in sorted(set(zip(f[vague].tolist(), s[vague].tolist(), strict=True))):
        found = found[(found["i"] != i) | (found["j"] != j)]
        found = np.concatenate([found, exact.zeros(SIDE, i, j, scene.keys[i, j])])
    v = roots_at(scene, scene.curve[found["i"]], found["t"]).v
    return found[may_touch(scene, found["i"], found["t"], v)]


# --- lines (sentence 5) ---------------------------------------------------------------------------


class Lines(NamedTuple):
    """Events in order, equal ones on one line.

    Attributes
    ----------
    events : structured array
    point : ndarray of int
        For each event the first one at the same point of the plane, as far as keys tell.
    line : ndarray of int
        The line of each event.
    best : ndarray of int
        The event of each line that is known best.
    t : ndarray
        Base value of each line.
    """

    events: Array
    point: Ints
    line: Ints
    best: Ints
    t: Floats

    @property
    def radius(self) -> Floats:
        """Error of each line's base value."""
        return np.asarray(self.events["radius"][self.best])

    @property
    def between(self) -> Floats:
        """Where each slab is looked at, as `Exact.between`, unless the slab is vague."""
        return np.asarray(self.t[:-1] + SHARE * np.diff(self.t))

    @property
    def vague(self) -> Bools:
        """Whether a slab is not much wider than the errors of its lines."""
        return np.asarray(np.diff(self.t) <= VAGUE * (self.radius[1:] + self.radius[:-1]))

    def last(self) -> tuple[int, int]:
        """Return the lines of both ends of the base."""
        ends = np.flatnonzero(self.events["kind"] == END)
        return int(self.line[ends].min()), int(self.line[ends].max())


def in_lines(scene: Scene, exact: Exact, events: Array) -> Lines:
    """Put events in order: in doubles, and exactly where their errors overlap (sentence 5).

    `exact` is told the events and lines, about which it is asked from then on.
    """
    point = _joined_by_key(exact, events)
    kept = np.flatnonzero(point == np.arange(len(events)))
    kept = kept[np.argsort(events["t"][kept], kind="stable")]
    t, radius = events["t"][kept], events["radius"][kept]
    new = clusters(t - radius, t + radius)
    line = np.empty(len(events), dtype=np.int64)
    best: list[int] = []
    sharp: list[int] = []
    starts = np.flatnonzero(new).tolist()
    for a, b in zip(starts, [*starts[1:], len(kept)], strict=True):
        groups = [[0]] if b - a == 1 else exact.in_order(events[kept[a:b]])
        for group in groups:
            rows = kept[[a + k for k in group]].tolist()
            line[rows] = len(best)
            best.append(min(rows, key=lambda k: (events["kind"][k] != END, events["radius"][k])))
            if b - a > 1 and events["kind"][best[-1]] != END:
                sharp.append(best[-1])
    chosen = np.array(best, dtype=np.int64)
    if sharp:  # their order in doubles is that of exact numbers
        events = events.copy()
        at = np.array([exact.place_of(event) for event in events[sharp]])
        events["t"][sharp], events["radius"][sharp] = at, 8 * UNIT * (1 + np.abs(at))
    exact.events, exact.best = events, chosen
    return Lines(events, point, line[point], chosen, events["t"][chosen])


def _joined_by_key(exact: Exact, events: Array) -> Ints:
    """Return for each event the first one at the same point: equal keys at one place are one."""
    order = np.lexsort([events["t"], events["key"]])
    e = events[order]
    same = (e["key"][1:] == e["key"][:-1]) & (e["key"][1:] >= 0)
    same &= e["t"][1:] - e["t"][:-1] <= e["radius"][1:] + e["radius"][:-1]
    chain = np.cumsum(np.append(True, ~same)[: len(e)])
    rows = np.stack([chain, e["i"], e["j"]])[:, np.lexsort([e["j"], e["i"], chain])]
    for n in distinct(rows[0, 1:][(rows[:, 1:] == rows[:, :-1]).all(axis=0)]):
        # Two zeros of one polynomial are two points.
        own = np.flatnonzero(chain == n)
        groups = exact.in_order(e[own])
        order[own] = order[own[[k for group in groups for k in group]]]
        same[own[:-1]] = [x for group in groups for x in (False, *[True] * (len(group) - 1))][1:]
    first = np.append(True, ~same)[: len(order)]
    point = np.empty(len(events), dtype=np.int64)
    point[order] = order[np.flatnonzero(first)][np.cumsum(first) - 1]
    return point
