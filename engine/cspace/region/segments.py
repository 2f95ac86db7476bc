"""Segments: pieces of roots that may bound something, found by feature; and their crossings.

A segment is (curve, slope, turn, first event, last event). Each feature is cut at its own events; a
piece is kept where its side conditions hold, because a false segment would part free space. Whether
a gap between segments is free is decided later, by the clauses of all pairs.

Two segments can only cross where their boxes meet, so segments are cut where they turn back along
the lift. What is left is asked of the resultant.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cspace.arrays import Array, Bools, Floats, Ints, begins, distinct, ranges
from cspace.region.algebra import along_base, basis, fold, lift_roots, nearest
from cspace.region.events import POSSIBLE, Lines, Parts, common_zeros, roots_at
from cspace.region.exact import Exact, Root
from cspace.region.kinds import CROSS, FOLD, LIMIT, SHARE, SIDE, Columns, made, matches, taken
from cspace.region.scene import Scene
from cspace.tolerances import UNIT
from qbound.circle import TURN

ROUNDS, CUTS = 2, (0.22, 0.47, 0.73)
"""How often the boxes of two segments are cut, and where."""

GONE = 1e-9
"""Coefficients along the lift below this vanish on a line, if they all do so somewhere."""

FOLDED = 64 * UNIT
"""Part of the squared coefficients that is rounding of a fold."""

DOUBT = 1e-4
"""How near an end of the lift a root between two lines that are nearly one is asked exactly."""

SLACK = 1e-7
"""By how much boxes are enlarged."""


@dataclass(frozen=True, eq=False)
class Segments(Columns):
    """Pieces of roots, one in each row.

    Attributes
    ----------
    curve, slope, turn : ndarray of int, shape (n,)
    pair : ndarray of int, shape (n,)
        Pair of convex parts; negative for a form of its own. Segments of one pair do not cross,
        because convex parts touch in a point or along an edge.
    start, end : ndarray of int, shape (n,)
        Events, by number.
    feature : ndarray of int, shape (n,)
        The feature, of united ones the first.
    """

    curve: Ints
    slope: Ints
    turn: Ints
    pair: Ints
    start: Ints
    end: Ints
    feature: Ints

    def __len__(self) -> int:
        """Count the segments."""
        return len(self.curve)

    def root(self, k: int) -> Root:
        """Return the named root of a segment; a negative number stands for an end of the lift."""
        return (int(self.curve[k]), int(self.slope[k]), int(self.turn[k])) if k >= 0 else (k, 0, 0)


NO_SEGMENTS = Segments(*[np.zeros(0, dtype=np.int64)] * 7)


def along(scene: Scene, segments: Segments, k: Ints, t: Floats) -> Floats:
    """Return the lift's coefficients of segments k over base values t, (n,): (3, n)."""
    rows = scene.table[segments.curve[k]]
    return np.asarray(np.einsum("in,nij->jn", basis(scene.turns[0], t), rows))


def follow(scene: Scene, segments: Segments, k: Ints, t: Floats) -> Floats:
    """Return lift values of segments k over base values t, (n,), continuous within a segment."""
    return named(scene, segments, k, along(scene, segments, k, t))


def named(
    scene: Scene, segments: Segments, k: Ints, c: Floats, folded: Bools | None = None
) -> Floats:
    """Return the roots of coefficients along the lift, (3, n), that segments k name (sentence 1).

    Where it is said that a root folds back, both roots are one.
    """
    curve = segments.curve[k]
    double = scene.double[curve] if folded is None else scene.double[curve] | folded
    rising, falling = lift_roots(scene.turns[1], c, double)
    v = np.where(segments.slope[k] > 0, rising, falling)
    if scene.turns[1]:
        return scene.in_turn(curve, v) + TURN * segments.turn[k]
    low, high = scene.ends[1]
    # Between two lines as near as rounding a root may be infinite.
    return np.asarray(np.clip(np.nan_to_num(v, nan=low), low - 1.0, high + 1.0))


def end_value(scene: Scene, segments: Segments, k: Ints, t: Floats, other: Floats) -> Floats:
    """Return lift values at an end t of base intervals, as limits from inside (sentence 1).

    At an end an angle may jump by a turn. A form that vanishes on the whole fibre has no root
    there: the root beside it is extrapolated.
    """
    curve, c = segments.curve[k], along(scene, segments, k, t)
    whole = np.flatnonzero((np.abs(c) <= GONE).all(axis=0) & scene.gone[curve])
    folded = np.abs(fold(c, scene.turns[1])) <= FOLDED * np.abs(c).sum(axis=0) ** 2
    v = named(scene, segments, k, c, folded & ~scene.affine[curve])
    if scene.turns[1]:
        inset = np.where(np.abs(other - t) > 1e-6, 1e-5, 0.5)
        beside = follow(scene, segments, k, t + inset * (other - t))
        v = nearest(v, beside)
    if len(whole):
        width = (other - t)[whole]
        near, next_, last, middle = (
            follow(scene, segments, k[whole], t[whole] + part * width)
            for part in (1e-4, 2e-4, 3e-4, 0.5)
        )
        v[whole] = np.where(np.abs(width) > 1e-6, 3 * near - 3 * next_ + last, middle)
    return v


def both_ends(scene: Scene, segments: Segments, k: Ints, a: Floats, b: Floats) -> Floats:
    """Return the lift values of segments at both ends of base intervals, as `end_value`: (2, n)."""
    ends = np.concatenate([a, b]), np.concatenate([b, a])
    return end_value(scene, segments, np.tile(k, 2), *ends).reshape(2, -1)


# --- feature by feature (sentence 6) --------------------------------------------------------------


def find_segments(
    scene: Scene,
    exact: Exact,
    lines: Lines,
    windows: Ints,
    features: Ints,
    where: Parts,
) -> tuple[Segments, Segments, Ints]:
    """Cut each feature at its own lines, and keep what is a contact (sentence 6).

    Parameters
    ----------
    windows : ndarray of int, shape (w, 2)
        Pairs of events between which something is looked for.
    where : tuple of ndarray
        As of `existing`.

    Returns
    -------
    united, parts : Segments
        Segments whose roots are told apart, and those of each feature on its own.
    passed : ndarray of int, shape (p, 2)
        Segments that go on over an event of their feature, and the event: two of them touch there.
    """
    f, w, a, b, hard = _pieces(scene, lines, windows, features, where)
    events, line = lines.events, lines.line
    number, curve = features[f], scene.curve[features[f]]
    width = lines.t[line[b]] - lines.t[line[a]]
    t = lines.t[line[a]] + SHARE * width
    doubt = np.abs(width) <= 8 * (events["radius"][a] + events["radius"][b])
    v, error, rest, blurred = roots_at(scene, curve, t)
    affine = scene.affine[curve]
    exists = (rest > blurred) | affine
    for k in np.flatnonzero(((np.abs(rest) <= blurred) | doubt) & ~affine).tolist():
        exists[k] = exact.exists(int(curve[k]), int(line[a[k]]), int(line[b[k]]))
    near = np.maximum(error, np.where(doubt, DOUBT, 0.0))[:, None]
    size = np.abs(scene.sides[number]).sum(axis=(2, 3))
    off = (4 * scene.side_eps[number] * size)[:, None]
    bottom, top = scene.ends[1]
    found, over = [], []
    for turn in range(int((top - bottom) / TURN) + 1 if scene.turns[1] else 1):
        value = v + TURN * turn * scene.turns[1]
        unsure = (np.abs(value - bottom) < near) | (np.abs(value - top) < near)
        if scene.turns[1]:  # a root beside a multiple of a turn may be named a turn lower
            unsure |= np.abs(v - bottom - np.pi) > np.pi - near
        there = exists[:, None] & (unsure | ((value > bottom) & (value < top)))
        unsure &= there
        for k, s in np.argwhere(unsure).tolist():
            root = int(curve[k]), (1, -1)[s], turn
            there[k, s] = exact.inside(root, int(line[a[k]]), int(line[b[k]]))
        sides = scene.sides_at(number, t, v)
        vague = np.maximum(64 * error + 1e-13, np.where(doubt, 1e-6, 0.0))[:, None, None] + off
        ok = there & (sides > -vague).all(axis=2)
        for k, s in np.argwhere(ok & (sides <= vague).any(axis=2)).tolist():
            root = int(curve[k]), (1, -1)[s], turn
            ok[k, s] = exact.holds(int(number[k]), root, int(line[a[k]]), int(line[b[k]]))
        for s, slope in ((0, 1), (1, -1)):
            here = ok[:, s]
            follows = here[1:] & here[:-1] & (f[1:] == f[:-1]) & (w[1:] == w[:-1]) & ~hard[1:]
            passed = _vanishing(
                scene, exact, lines, number, turn, s, a, np.flatnonzero(follows) + 1
            )
            ones = np.ones(len(passed), dtype=np.int64)
            over.append((curve[passed], slope * ones, turn * ones, a[passed]))
            begin = np.flatnonzero(here & ~np.append(False, follows)[: len(here)])
            end = np.flatnonzero(here & ~np.append(follows, False)[: len(here)])
            own, same = number[begin], np.ones(len(begin), dtype=np.int64)
            found.append(
                (curve[begin], slope * same, turn * same, scene.pair[own], a[begin], b[end], own)
            )
    parts = Segments(*(np.concatenate(x) for x in zip(*found, strict=True)))
    united = _united(parts, line)
    if not any(len(passed) for *_, passed in over):
        return united, parts, np.zeros((0, 2), dtype=np.int64)
    known: dict[Root, list[int]] = {}
    for n in range(len(united)):
        known.setdefault(united.root(n), []).append(n)
    start, end = line[united.start], line[united.end]
    both = [
        (n, e)
        for *root, e in zip(
            *(np.concatenate(x).tolist() for x in zip(*over, strict=True)), strict=True
        )
        for n in known[root[0], root[1], root[2]]
        if start[n] < line[e] < end[n]
    ]
    return united, parts, np.array(both, dtype=np.int64).reshape(-1, 2)


def _vanishing(
    scene: Scene,
    exact: Exact,
    lines: Lines,
    number: Ints,
    turn: int,
    s: int,
    event: Ints,
    chosen: Ints,
) -> Ints:
    """Keep the pieces over whose first event a side condition vanishes on this very root.

    A curve has two roots over the event's base value, and the side condition vanishes on one.
    """
    if not len(chosen):
        return chosen
    f, e = number[chosen], event[chosen]
    t = lines.t[lines.line[e]]
    v = roots_at(scene, scene.curve[f], t).v
    sides = np.abs(scene.sides_at(f, t, v)[:, s])
    own = scene.keys[f] == lines.events["key"][e][:, None]
    kept = []
    for n in np.flatnonzero((own & (sides < POSSIBLE)).any(axis=1)).tolist():
        root = int(scene.curve[f[n]]), (1, -1)[s], turn
        row = lines.events[e[n]]
        if any(exact.vanishes_on(int(f[n]), k, root, row) for k in np.flatnonzero(own[n]).tolist()):
            kept.append(n)
    return chosen[np.array(kept, dtype=np.int64)]


def _pieces(
    scene: Scene,
    lines: Lines,
    windows: Ints,
    features: Ints,
    where: Parts,
) -> tuple[Ints, Ints, Ints, Ints, Bools]:
    """Cut features at their own lines, in windows in which they exist (sentence 6).

    Return feature and window of each piece, by number, its two events, and whether it begins hard:
    at a fold or a limit, so that the pieces on both sides are two segments.
    """
    events, line = lines.events, lines.line
    low, high = line[windows[:, 0]], line[windows[:, 1]]
    own = np.flatnonzero((events["kind"] == FOLD) | (events["kind"] == LIMIT))
    which, k = matches(events["i"][own], scene.curve[features])
    cuts = [(which, own[k], np.ones(len(k), dtype=np.bool_))]
    keyed = distinct(lines.point[events["key"] >= 0])
    for keys in scene.keys[features].T:
        which, k = matches(events["key"][keyed], np.where(keys >= 0, keys, -7))
        cuts.append((which, keyed[k], np.zeros(len(k), dtype=np.bool_)))
    f, e, hard = (np.concatenate(x) for x in zip(*cuts, strict=True))
    w = np.searchsorted(low, line[e], "right") - 1
    inside = (w >= 0) & (line[e] > low[np.maximum(w, 0)]) & (line[e] < high[np.maximum(w, 0)])
    f, e, hard, w = taken(inside, f, e, hard, w)
    which, k = matches(where[0], scene.curve[features])
    own = np.concatenate([where[1][k], w[hard]])
    every = distinct(np.concatenate([which, f[hard]]) * len(low) + own)
    f, e, hard, w = taken(np.isin(f * len(low) + w, every), f, e, hard, w)
    every, each = np.divmod(every, len(low))
    f, w = np.concatenate([every, every, f]), np.concatenate([each, each, w])
    e = np.concatenate([windows[each, 0], windows[each, 1], e])
    hard = np.concatenate([np.ones(2 * len(every), dtype=np.bool_), hard])
    order = np.lexsort([~hard, line[e], w, f])
    f, w, e, hard = f[order], w[order], e[order], hard[order]
    f, w, e, hard = taken(begins(f, w, line[e]), f, w, e, hard)
    k = np.flatnonzero(~begins(f, w)[1:])
    return f[k], w[k], e[k], e[k + 1], hard[k]


def _united(segments: Segments, line: Ints) -> Segments:
    """Unite segments of one root that overlap: parts of an outline may have the same corner."""
    order = np.lexsort([line[segments.start], segments.turn, segments.slope, segments.curve])
    s = segments[order]
    if len(s) < 2:
        return s
    same = ~begins(s.curve, s.slope, s.turn)[1:]
    if not (same & (line[s.start[1:]] < line[s.end[:-1]])).any():
        return s
    keep: list[int] = []
    end, pair = s.end.copy(), s.pair.copy()
    for k in range(len(s)):
        if keep and same[k - 1] and line[s.start[k]] < line[end[keep[-1]]]:
            if line[end[k]] > line[end[keep[-1]]]:
                end[keep[-1]] = end[k]
            if pair[k] != pair[keep[-1]]:
                pair[keep[-1]] = -(10**9) - k  # it crosses segments of both pairs
        else:
            keep.append(k)
    kept = np.array(keep)
    return replace(s[kept], pair=pair[kept], end=end[kept])


# --- crossings (sentence 7) -----------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Boxes(Columns):
    """Pieces of segments that do not turn back along the lift, with what they cannot leave.

    Attributes
    ----------
    segment : ndarray of int
    start, end : ndarray
        Base values.
    low, high : ndarray
        Lift values.
    wide : ndarray of bool
        Whether the lift values are unknown.
    """

    segment: Ints
    start: Floats
    end: Floats
    low: Floats
    high: Floats
    wide: Bools


def _boxes(scene: Scene, segments: Segments, t0: Floats, t1: Floats) -> Boxes:
    """Cut segments where they turn back along the lift; return boxes by start (sentence 7)."""
    n = len(segments)
    moved = np.flatnonzero(scene.table[segments.curve][:, 1:].any(axis=(1, 2)))
    table, eps = scene.table[segments.curve[moved]], scene.eps[segments.curve[moved]]
    slopes, windows = along_base(scene.turns[0], table), np.stack([t0, t1])[:, moved]

    def where(k: Ints, known: tuple[Bools, Bools] | None = None) -> tuple[Ints, Floats, Ints]:
        one, other, (a, b) = (table[k], eps[k]), (slopes[k], 2 * eps[k]), windows[:, k]
        row, t, _, vague = common_zeros(scene, one, other, (a, b), known)
        return k[row], t, k[vague]

    k, t, vague = where(np.arange(len(moved)))
    if len(vague):  # some may turn back at their ends
        v = both_ends(scene, segments, moved[vague], *windows[:, vague])
        places = zip(windows[:, vague], v, strict=True)
        factors = ((basis(turn, x) for turn, x in zip(scene.turns, q, strict=True)) for q in places)
        flat = [np.abs(np.einsum("in,nij,jn->n", a, slopes[vague], b)) < SLACK for a, b in factors]
        more, at, vague = where(vague, (flat[0], flat[1]))
        k, t = np.concatenate([k, more]), np.concatenate([t, at])
    which = np.concatenate([np.arange(n), np.arange(n), moved[k]])
    at = np.concatenate([t0, t1, t])
    order = np.lexsort([at, which])
    which, at = which[order], at[order]
    k = np.flatnonzero((which[1:] == which[:-1]) & (at[1:] > at[:-1]))
    which, start, end = which[k], at[k], at[k + 1]
    ends = both_ends(scene, segments, which, start, end)
    low, high = ends.min(axis=0), ends.max(axis=0)
    wide = np.isin(which, moved[vague])
    low[wide], high[wide] = scene.ends[1]
    slack = SLACK * (1 + np.abs(high))
    return Boxes(which, start, end, low - slack, high + slack, wide)[
        np.argsort(start, kind="stable")
    ]


def _meeting(boxes: Boxes, pair: Ints) -> tuple[Ints, Ints]:
    """Return which two boxes meet, of segments of different pairs of parts (sentence 7)."""
    start, found = boxes.start, []
    last = np.searchsorted(start, boxes.end, "left")
    block = max(1, 2**22 // max(len(start), 1))
    for a in range(0, len(start), block):
        k = np.arange(a, min(a + block, len(start)))
        i, j = ranges(k + 1, last[k])
        i += a
        hit = (boxes.low[i] <= boxes.high[j]) & (boxes.low[j] <= boxes.high[i])
        hit &= pair[boxes.segment[i]] != pair[boxes.segment[j]]
        found.append(np.stack([i[hit], j[hit]]))
    i, j = np.concatenate(found, axis=1) if found else np.zeros((2, 0), dtype=np.int64)
    return i, j


def find_crossings(
    scene: Scene, exact: Exact, segments: Segments, lines: Lines
) -> tuple[Array, Ints]:
    """Return where segments of different pairs cross; both segments and their event (sentence 7).

    The resultant vanishes where any roots of both forms meet. A zero counts if the order of these
    two changes there; exact numbers decide where doubles do not see that, such as at a tangency.
    """
    t0, t1 = lines.t[lines.line[segments.start]], lines.t[lines.line[segments.end]]
    boxes = _boxes(scene, segments, t0, t1)
    k, m = _meeting(boxes, segments.pair)
    i, j, a, b = _possible(scene, segments, boxes, k, m)
    if not len(i):
        return made(CROSS, i, 0.0, 0), np.zeros((0, 3), dtype=np.int64)
    one, other = segments.curve[i], segments.curve[j]
    known = [
        _handed_over(lines, x[i], x[j]) & (edge == t[i])
        for x, edge, t in ((segments.start, a, t0), (segments.end, b, t1))
    ]
    # Segments that differ by turns only cross at the same values: these are computed once.
    asked = np.stack([one, other, a, b, *known], axis=1)
    _, first, same = np.unique(asked, axis=0, return_index=True, return_inverse=True)
    tables = [(scene.table[c[first]], scene.eps[c[first]]) for c in (one, other)]
    ends = (known[0][first], known[1][first])
    windows = a[first], b[first]
    row, t, radius, vague = common_zeros(scene, tables[0], tables[1], windows, ends)
    vague = np.flatnonzero(np.isin(same, vague))
    k, n = matches(row, same)
    t, radius = taken(n, t, radius)
    # A zero of the resultant is a crossing of these two if their order changes there.
    step = np.maximum(1e-6 * (b - a)[k], 64 * radius)
    beside = np.clip(np.stack([t - step, t + step]), a[k], b[k]).ravel()
    v, w = end_value(
        scene, segments, np.concatenate([i[k], i[k], j[k], j[k]]), np.tile(beside, 2), np.tile(t, 4)
    ).reshape(2, 2, -1)
    orders = np.where(np.abs(v - w) > 1e-14 * (1 + np.abs(v)), np.sign(v - w), 0)
    apart = np.abs(follow(scene, segments, i[k], t) - follow(scene, segments, j[k], t)) > 1e-3
    no = ((orders[0] == orders[1]) & (orders[0] != 0)) | apart
    sure = orders[0] * orders[1] == -1
    doubtful = distinct(np.concatenate([vague, k[~no & ~sure]]))
    keep = ~no & ~np.isin(k, doubtful)
    k, n, t, radius = taken(keep, k, n, t, radius)
    _, first, number = np.unique(n, return_index=True, return_inverse=True)
    curves = np.sort(np.stack([one, other]), axis=0)[:, k[first]]
    found = [made(CROSS, t[first], radius[first], *curves)]
    owners, count = [np.stack([i[k], j[k], number], axis=1)], len(first)
    for k in doubtful.tolist():
        both = int(i[k]), int(j[k])
        more = exact.zeros(CROSS, *sorted((int(one[k]), int(other[k]))))
        low, high = max(t0[[*both]]), min(t1[[*both]])
        inside = (more["t"] >= low - 1e-9) & (more["t"] <= high + 1e-9)
        roots = [segments.root(s) for s in both]
        met = [
            e for e in more[inside] if exact.meet(e, roots, 1 if 2 * e["t"] < low + high else -1)
        ]
        found.append(np.array(met, dtype=more.dtype))
        owners += [np.array([[*both, count + m]]) for m in range(len(met))]
        count += len(met)
    return np.concatenate(found), np.concatenate(owners).astype(np.int64)


def _handed_over(lines: Lines, one: Ints, other: Ints) -> Bools:
    """Tell which two events are one event at which features hand over to each other."""
    point, events = lines.point, lines.events
    keyed = (events["key"][one] >= 0) & (events["kind"][one] == SIDE)
    return np.asarray((point[one] == point[other]) & keyed)


def _possible(
    scene: Scene, segments: Segments, boxes: Boxes, k: Ints, m: Ints
) -> tuple[Ints, Ints, Floats, Floats]:
    """Cut boxes that meet, and return what is left: two segments and an interval each."""
    i, j = boxes.segment[k], boxes.segment[m]
    a, b = boxes.start[m], np.minimum(boxes.end[k], boxes.end[m])
    fixed = boxes.wide[k] | boxes.wide[m]
    crosses = ~_is_tangent(scene, segments, i, j)
    i, j, a, b, fixed = taken(crosses, i, j, a, b, fixed)
    for _ in range(ROUNDS):
        at = np.stack([a, *(a + cut * (b - a) for cut in CUTS), b])
        a, b = at[:-1].ravel(), at[1:].ravel()
        i, j, fixed = taken(np.tile(np.arange(len(i)), len(CUTS) + 1), i, j, fixed)
        own = np.concatenate([i, j]), np.tile(a, 2), np.tile(b, 2)
        ends = both_ends(scene, segments, *own).reshape(2, 2, -1)  # a or b, i or j
        least, most = ends.min(axis=0), ends.max(axis=0)
        over = (least <= most[::-1] + SLACK * (1 + np.abs(ends[0, 0]))).all(axis=0)
        i, j, a, b, fixed = taken(over | fixed, i, j, a, b, fixed)
    low, high = np.minimum(i, j), np.maximum(i, j)
    order = np.lexsort([a, high, low])
    i, j, a, b = low[order], high[order], a[order], b[order]
    new = np.append(True, (i[1:] != i[:-1]) | (j[1:] != j[:-1]) | (a[1:] > b[:-1]))[: len(i)]
    first = np.flatnonzero(new)
    last: Floats = np.maximum.reduceat(b, first) if len(first) else b
    return i[first], j[first], a[first], last


def _is_tangent(scene: Scene, segments: Segments, i: Ints, j: Ints) -> Bools:
    """Tell which two segments are an edge's line and the circle about one of the edge's ends.

    These touch and do not cross.
    """
    f, g = segments.feature[i], segments.feature[j]
    x, y = scene.tangent[f], scene.tangent[g]
    shares = (x[:, :1] == y).any(axis=1) | (x[:, 1:] == y).any(axis=1)
    unlike = scene.corners[f] != scene.corners[g]
    return np.asarray(shares & unlike & (x >= 0).any(axis=1))
