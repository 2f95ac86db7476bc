"""Cells: the free gaps of the fibres, between two segments each, over as many slabs as they last.

The roots of each fibre are put in order: doubles decide, and exact numbers where errors overlap. A
gap between the same two segments in neighbouring slabs is one gap, unless a wall, or a touching of
the two, is between (sentence 8). Whether a gap is free is asked once, at its roomiest place, of
all forms and of the clauses of all pairs, discs first (sentence 9).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from itertools import permutations

import numpy as np

from cspace.arrays import Bools, Floats, Ints, begins, distinct, ranges
from cspace.region.algebra import HIGH, LOW, along_base, basis, fold
from cspace.region.events import (
    Lines,
    curve_events,
    existing,
    find_walls,
    in_lines,
    is_rough,
    relevant,
    roots_at,
    side_events,
    whole_fibres,
)
from cspace.region.exact import Exact, Place, Spot
from cspace.region.kinds import END, LIMIT, SIDE, WALL, Columns, clusters, made
from cspace.region.scene import Scene
from cspace.region.segments import (
    NO_SEGMENTS,
    Segments,
    along,
    both_ends,
    end_value,
    find_crossings,
    find_segments,
    named,
)
from cspace.tolerances import TOUCH, UNIT
from qbound.circle import TURN

THIN = 1e-10
"""A gap thinner than this part of the ranges is decided exactly."""

DISCS_APART = 1e-6
"""A scaled form of two discs above this parts the discs at a place in a thin gap."""

APART = 1e-3
"""Two roots of a curve farther apart than this are told apart without more ado."""

BLOCK = 2**17
"""Roots of fibres that are looked at together."""


@dataclass(frozen=True, eq=False)
class Gaps(Columns):
    """Gaps between neighbouring roots, each over one slab or over several.

    Attributes
    ----------
    lower, upper : ndarray of int, shape (n,)
        The segments that bound the gap; `LOW` and `HIGH` are ends of the lift.
    span, rank : ndarray of int, shape (n, 2)
        First and last slab, and places among the gaps of each.
    slab : ndarray of int, shape (n,)
        The slab in which the gap is roomiest.
    middle, room : ndarray, shape (n,)
        Lift value half-way up the gap there; its width or height, the smaller part of the range.
    """

    lower: Ints
    upper: Ints
    span: Ints
    rank: Ints
    slab: Ints
    middle: Floats
    room: Floats

    def __len__(self) -> int:
        """Count the gaps."""
        return len(self.slab)

    def spot(self, k: int, segments: Segments) -> Spot:
        """Return where a gap is roomiest, by names, for exact numbers."""
        lower, upper = (segments.root(int(x[k])) for x in (self.lower, self.upper))
        return (int(self.slab[k]), int(self.slab[k]) + 1), lower, upper


@dataclass(frozen=True, eq=False)
class Cells:
    """Free cells of a scene, and what joins and labels them.

    Attributes
    ----------
    scene : Scene
    exact : Exact
    lines : Lines
    segments, parts : Segments
        The roots that bound cells; and those of each feature on its own, for labels.
    meets : dict of int to list of set of int
        The points of each line at which segments meet.
    walls : dict of int to set of int
        The curves that vanish along a line.
    gaps : Gaps
    sharing : dict of int to set of int
        For a segment those that are one root with it in some slab: only one of them bounds cells.
    span : ndarray of int, shape (k, 2)
        First and last line of each cell.
    roots : ndarray of int, shape (k, 2)
        Lower and upper segment, `LOW` or `HIGH`.
    rank : ndarray of int, shape (k, 2)
        Places among the gaps of its first and of its last slab.
    ends : ndarray, shape (k, 2, 2)
        Lift values, [first or last line, lower or upper root].
    """

    scene: Scene
    exact: Exact
    lines: Lines
    segments: Segments
    parts: Segments
    meets: dict[int, list[set[int]]]
    walls: dict[int, set[int]]
    gaps: Gaps
    sharing: dict[int, set[int]]
    span: Ints
    roots: Ints
    rank: Ints
    ends: Floats

    def place(self, cell: int, side: int, upper: int) -> Place:
        """Return an end of a cell as exact numbers take it."""
        root = self.segments.root(int(self.roots[cell, upper]))
        return root, int(self.span[cell, side]), 1 - 2 * side


def find_cells(scene: Scene) -> Cells:
    """Decompose a scene: lines, segments, gaps, and which gaps are free (sentences 2 to 9).

    Lines are found in three rounds: walls; events of single curves and features, in *windows*, the
    slabs that forms and pairs without the lift leave free; crossings of the segments.
    """
    exact = Exact(scene)
    scene = _with_corners_in_line(scene, exact)
    low, high = scene.ends[0]
    ends = made(END, np.array([low, high]), 4 * UNIT * np.abs([low, high]), np.array([0, 1]))
    walls = find_walls(scene, exact)
    named = with_one_name(scene, exact, walls["i"])
    if named is not scene:
        scene, walls = named, find_walls(named, exact)
    lines = in_lines(scene, exact, np.concatenate([ends, walls]))
    windows = free_windows(scene, exact, lines)
    if not len(windows):
        return no_cells(scene)
    features = np.flatnonzero(scene.live & scene.lifted[scene.curve])
    scene = with_one_name(scene, exact, scene.curve[features])
    scene = with_special_roots(scene, exact, distinct(scene.curve[features]))
    a, b = lines.events["t"][windows].T
    curves = distinct(scene.curve[features])
    own = curve_events(scene, exact, curves, a, b)
    whole = whole_fibres(scene, exact, own)
    gone = np.isin(np.arange(len(scene.table)), whole["i"])
    exact.scene = scene = replace(scene, gone=gone)
    where = existing(scene, curves, own, a, b)
    features = features[np.isin(scene.curve[features], where[0])]
    sides = side_events(scene, exact, features, where)
    events = np.concatenate([lines.events, whole, relevant(scene, own, features), sides])
    lines = in_lines(scene, exact, events)
    segments, parts, passed = find_segments(scene, exact, lines, windows, features, where)
    crossings, owners = find_crossings(scene, exact, segments, lines)
    used = events["kind"] <= WALL
    used[windows] = used[passed[:, 1]] = True
    for s in (segments, parts):
        used[s.start] = used[s.end] = True
    place = np.cumsum(used) - 1
    windows = place[windows]
    segments, parts = (
        replace(s, start=place[s.start], end=place[s.end]) for s in (segments, parts)
    )
    number = np.count_nonzero(used) + owners[:, 2]
    lines = in_lines(scene, exact, np.concatenate([events[used], crossings]))
    both = [np.stack([own, number], axis=1) for own in owners[:, :2].T]
    passing = np.concatenate([np.stack([passed[:, 0], place[passed[:, 1]]], axis=1), *both])
    return _free_cells(scene, exact, lines, windows, segments, parts, passing)


def _with_corners_in_line(scene: Scene, exact: Exact) -> Scene:
    """Let corners part segments that lie on one line in all configurations: no edge does."""
    some = scene.table[scene.curve].any(axis=(1, 2))
    edges = (scene.pair >= 0) & ~scene.corners
    in_line = np.isin(scene.pair, scene.pair[edges]) & ~np.isin(
        scene.pair, scene.pair[edges & some]
    )
    always = ~np.isin(np.arange(len(scene.idle)), scene.pair[some])  # they touch everywhere
    always[scene.pair[in_line]] = True
    if always.any():
        live = scene.live | (in_line & scene.corners)
        exact.scene = scene = replace(scene, live=live, idle=scene.idle & ~always)
    return scene


def no_cells(scene: Scene) -> Cells:
    """Return a decomposition without a cell."""
    exact, ends = Exact(scene), np.array(scene.ends[0])
    lines = in_lines(scene, exact, made(END, ends, 0.0, np.array([0, 1])))
    none, pairs = np.zeros(0, dtype=np.int64), np.zeros((0, 2), dtype=np.int64)
    gaps = Gaps(none, none, pairs, pairs, none, np.zeros(0), np.zeros(0))
    no = NO_SEGMENTS
    return Cells(
        scene, exact, lines, no, no, {}, {}, gaps, {}, pairs, pairs, pairs, np.zeros((0, 2, 2))
    )


def with_one_name(scene: Scene, exact: Exact, curves: Ints) -> Scene:
    """Give equal curves one number: doubles propose, exact coefficients decide (sentence 4)."""
    curves = distinct(curves)
    if len(curves) < 2:
        return scene
    near = np.round(scene.table[curves] * 2.0**30) + 0.0
    number = np.arange(len(scene.table))
    known: dict[bytes, list[int]] = {}
    for c, table in zip(curves.tolist(), near, strict=True):
        own = known.setdefault(table.tobytes(), [])
        number[c] = next((other for other in own if exact.is_equal(c, other)), c)
        if number[c] == c:
            own.append(c)
    if (number[curves] != curves).any():
        exact.scene = scene = replace(scene, curve=number[scene.curve])
    return scene


def with_special_roots(scene: Scene, exact: Exact, curves: Ints) -> Scene:
    """Find the curves whose two roots are one, or of which one is an end of the lift.

    Doubles propose, exact coefficients decide (sentence 4).
    """
    ending = scene.ending.copy()
    if scene.turns[1]:
        at_end = scene.table[curves] @ basis(True, np.float64(scene.ends[1][0]))
        for c in curves[np.abs(at_end).max(axis=1, initial=0.0) <= scene.errors[curves]].tolist():
            ending[c] = exact.share(LOW, c)
    if ending.any():
        exact.scene = scene = replace(scene, ending=ending)
    curves = curves[~scene.affine[curves]]
    low, high = scene.ends[0]
    t = np.tile(low + (high - low) * np.array([0.13, 0.37, 0.71]), (len(curves), 1))
    rest = fold(scene.along(scene.table[curves], t), scene.turns[1])
    near = (np.abs(rest) <= scene.fold_errors[curves, None]).all(axis=1)
    double = scene.double.copy()
    for c in curves[near].tolist():
        double[c] = exact.is_double(c)
    if double.any():
        exact.scene = scene = replace(scene, double=double)
    return scene


# --- what is free (sentence 9) --------------------------------------------------------------------

SpotOf = Callable[[int], Spot]


def free_windows(scene: Scene, exact: Exact, lines: Lines) -> Ints:
    """Return windows: slabs, as two events, that forms and pairs without the lift leave free.

    Along a fibre these are free everywhere or nowhere (sentence 9).
    """
    t = lines.between
    (low, high), (bottom, top) = scene.ends
    v = np.full(len(t), 0.3 * bottom + 0.7 * top)
    first, last = lines.last()
    free: Bools = (np.arange(len(t)) >= first) & (np.arange(len(t)) < last)

    def spot(k: int) -> Spot:
        if lines.t[k + 1] - lines.t[k] > THIN * (high - low):
            return float(t[k]), float(v[k])
        return (k, k + 1), (LOW, 0, 0), (HIGH, 0, 0)

    still = np.flatnonzero(~scene.lifted[: scene.count])
    pairs = np.flatnonzero(scene.base_only & ~scene.idle)
    clear(scene, exact, free, (t, v), still, pairs, spot)
    return np.stack([lines.best[:-1][free], lines.best[1:][free]], axis=1)


def clear(
    scene: Scene,
    exact: Exact,
    free: Bools,
    places: tuple[Floats, Floats],
    curves: Ints,
    pairs: Ints,
    spot: SpotOf,
) -> None:
    """Clear `free` at places where some forms are not positive, or pairs not apart (sentence 9).

    Discs about both parts of a pair are asked first, then the clauses.

    Parameters
    ----------
    curves : ndarray of int
        Some of the first curves.
    """
    products = scene.products(*places)
    values = products @ scene.table[curves].reshape(-1, 9).T
    doubt = 4 * (scene.eps[curves] + 8 * UNIT) * scene.size[curves]
    vague = free & (np.abs(values) <= doubt).any(axis=1)
    free &= (values > -doubt).all(axis=1)
    for k in np.flatnonzero(vague & free).tolist():
        unsure = curves[values[k] <= doubt].tolist()
        free[k] = all(exact.is_positive(c, spot(k)) for c in unsure)
    block = max(1, 2**21 // max(len(pairs), 1))
    for start in range(0, len(free), block):
        here = start + np.flatnonzero(free[start : start + block])
        near = products[here] @ scene.discs[pairs].T <= scene.disc_doubt[pairs]
        for n in np.flatnonzero(near.any(axis=0)).tolist():
            own = here[near[:, n]]
            own = own[free[own]]
            if not len(own):
                continue
            sure, maybe = scene.source.clauses(int(pairs[n])).apart(products[own])
            free[own[~maybe]] = False
            for k in own[maybe & ~sure].tolist():
                free[k] = exact.is_apart(int(pairs[n]), spot(k))


# --- gaps and cells (sentences 8 and 9) -----------------------------------------------------------


def _free_cells(
    scene: Scene,
    exact: Exact,
    lines: Lines,
    windows: Ints,
    segments: Segments,
    parts: Segments,
    passing: Ints,
) -> Cells:
    """Find the gaps of all fibres, which of them are one (sentence 8), and which are free.

    Parameters
    ----------
    passing : ndarray of int, shape (p, 2)
        Segments that go on over an event, and the event.
    """
    events, line = lines.events, lines.line
    walls: dict[int, set[int]] = {}
    for e in np.flatnonzero(events["kind"] == WALL).tolist():
        walls.setdefault(int(line[e]), set()).add(int(events["i"][e]))
    is_open = np.zeros(len(lines.t), dtype=np.bool_)
    for a, b in line[windows].tolist():
        is_open[a:b] = True
    meets = _meets(scene, exact, lines, segments, passing)
    gaps, sharing = find_gaps(
        scene, exact, lines, segments, is_open, _cuts(len(lines.t), len(segments), walls, meets)
    )
    if not len(gaps):
        return no_cells(scene)
    thin = (gaps.room < THIN) | lines.vague[gaps.slab]
    free = gaps[np.flatnonzero(_is_free(scene, exact, lines, segments, gaps, thin))]
    span = free.span + np.array([0, 1])
    roots = np.stack([free.lower, free.upper], axis=1)
    return Cells(
        scene,
        exact,
        lines,
        segments,
        parts,
        meets,
        walls,
        gaps,
        sharing,
        span,
        roots,
        free.rank,
        _cell_ends(scene, exact, lines, segments, span, roots),
    )


def _meets(
    scene: Scene, exact: Exact, lines: Lines, segments: Segments, passing: Ints
) -> dict[int, list[set[int]]]:
    """Return the points of each line at which segments meet (sentence 10).

    Ends of windows and walls are left out, because all segments end there. Of several handovers of
    one feature on a line each of its two roots has its own.
    """
    line, point, kind = lines.line, lines.point, lines.events["kind"]
    side = distinct(point[kind == SIDE])
    several = np.bincount(line[side], minlength=len(lines.t)) > 1
    on_line: dict[int, list[int]] = {}
    for p in side[several[line[side]]].tolist():
        on_line.setdefault(int(line[p]), []).append(p)

    def own_points(k: int, e: int) -> list[int]:
        f, rows = int(segments.feature[k]), lines.events
        keys = scene.keys[f]
        own = [p for p in on_line.get(int(line[e]), ()) if rows["key"][p] in keys]
        if kind[e] != SIDE or len(own) < 2:
            return [int(point[e])]
        root = segments.root(k)
        here = [
            p
            for p in own
            for s in np.flatnonzero(keys == rows["key"][p]).tolist()
            if exact.vanishes_on(f, s, root, rows[p])
        ]
        return here or [int(point[e])]

    points: dict[tuple[int, int, int], set[int]] = {}
    slope = segments.slope.tolist()
    limited = _limited(scene, lines, segments)
    for k, both in enumerate(zip(segments.start.tolist(), segments.end.tolist(), strict=True)):
        for e in both:
            if kind[e] > WALL:  # of a curve's two roots one passes the limit
                own = slope[k] if kind[e] == LIMIT else 0
                for p in own_points(k, e):
                    met = points.setdefault((int(line[e]), p, own), set())
                    met |= {k, limited.get((k, e), k)}
    for k, e in passing.tolist():
        points.setdefault((int(line[e]), int(point[e]), 0), set()).add(k)
    found: dict[int, list[set[int]]] = {}
    for (k, _, _), meeting in points.items():
        if len(meeting) > 1:
            found.setdefault(k, []).append(meeting)
    return found


def _limited(scene: Scene, lines: Lines, segments: Segments) -> dict[tuple[int, int], int]:
    """Return the ends of the lift that segments meet at their limits: by segment and event.

    Of a curve's two roots one passes the limit. Where both are near it, nothing is said.
    """
    both = np.stack([segments.start, segments.end])
    side, k = np.nonzero(lines.events["kind"][both] == LIMIT)
    if not len(k):
        return {}
    t = lines.t[lines.line[both]]
    e, at = both[side, k], t[side, k]
    v = end_value(scene, segments, k, at, t[1 - side, k])
    roots = roots_at(scene, segments.curve[k], at).v
    gap = np.abs(roots[:, 1] - roots[:, 0])
    gap = np.minimum(gap, np.abs(gap - TURN)) if scene.turns[1] else gap
    alone = scene.affine[segments.curve[k]] | (gap > APART)
    upper: Ints = (np.abs(v - scene.ends[1][1]) < np.abs(v - scene.ends[1][0])).astype(np.int64)
    near = np.abs(v - np.array(scene.ends[1])[upper]) < APART / 8
    met = alone & near & (scene.round[1] | (upper == lines.events["j"][e]))
    return {(int(k[n]), int(e[n])): (LOW, HIGH)[upper[n]] for n in np.flatnonzero(met)}


def _cuts(
    lines: int, segments: int, walls: Iterable[int], meets: dict[int, list[set[int]]]
) -> Callable[[Gaps], Bools]:
    """Return what tells which gaps begin at a wall, or where both their roots meet (sentence 8).

    Parameters
    ----------
    lines, segments : int
        How many there are.
    """
    pairs = [
        (line, *pair)
        for line, points in meets.items()
        for own in points
        for pair in permutations(own, 2)
    ]

    def number(line: Ints, lower: Ints, upper: Ints) -> Ints:
        count = segments - HIGH
        return np.asarray((line * count + lower - HIGH) * count + upper - HIGH)

    met = number(*np.array([*sorted(pairs), (lines, 0, 0)], dtype=np.int64).T)
    is_wall = np.isin(np.arange(lines), list(walls))

    def cut(gaps: Gaps) -> Bools:
        start = gaps.span[:, 0]
        own = number(start, gaps.lower, gaps.upper)
        return np.asarray(is_wall[start] | (met[met.searchsorted(own)] == own))

    return cut


def _over_slabs(gaps: Gaps, cut: Callable[[Gaps], Bools]) -> Gaps:
    """Make one of the same gap in neighbouring slabs, unless it is cut (sentence 8)."""
    if not len(gaps):
        return gaps
    g = gaps[np.lexsort([gaps.span[:, 0], gaps.upper, gaps.lower])]
    new = begins(g.lower, g.upper) | cut(g)
    new[1:] |= g.span[1:, 0] != g.span[:-1, 1] + 1
    begin = np.flatnonzero(new)
    end = np.append(begin[1:], len(new)) - 1
    roomiest = np.lexsort([g.room, np.cumsum(new)])[end]
    span, rank = (np.stack([x[begin, 0], x[end, 1]], axis=1) for x in (g.span, g.rank))
    return replace(g[roomiest], span=span, rank=rank)


def _is_free(
    scene: Scene, exact: Exact, lines: Lines, segments: Segments, gaps: Gaps, thin: Bools
) -> Bools:
    """Tell which gaps are free; thin ones are asked exactly (sentence 9)."""
    t, v = lines.between[gaps.slab], gaps.middle

    def spot(k: int) -> Spot:
        return gaps.spot(k, segments) if thin[k] else (float(t[k]), float(v[k]))

    free = ~thin
    points = np.flatnonzero(scene.lifted[: scene.count])
    pairs = np.flatnonzero(~scene.base_only & ~scene.idle)
    clear(scene, exact, free, (t, v), points, pairs, spot)
    for k in np.flatnonzero(thin).tolist():
        place = exact.in_doubles(spot(k))
        near = pairs[scene.discs[pairs] @ scene.products(*place)[0] <= DISCS_APART]
        free[k] = all(exact.is_positive(int(c), spot(k)) for c in points) and all(
            exact.is_apart(int(p), spot(k)) for p in near
        )
    return free


def find_gaps(
    scene: Scene,
    exact: Exact,
    lines: Lines,
    segments: Segments,
    is_open: Bools,
    cut: Callable[[Gaps], Bools],
) -> tuple[Gaps, dict[int, set[int]]]:
    """Return the gaps of all open slabs, and segments that are one root somewhere (sentence 8)."""
    first, last = lines.line[segments.start], lines.line[segments.end]
    some = np.flatnonzero(first < last)
    slabs = np.flatnonzero(is_open[:-1])
    at = lines.between
    moved = np.where(lines.vague, lines.radius[1:] + lines.radius[:-1], 0.0)
    load = np.zeros(len(lines.t) + 1, dtype=np.int64)  # roots of each slab
    np.add.at(load, first[some], 1)
    np.add.at(load, last[some], -1)
    load = np.where(is_open, np.cumsum(load)[: len(lines.t)] + 2, 0)[:-1]
    cuts = np.searchsorted(np.cumsum(load), np.arange(BLOCK, load.sum() + BLOCK, BLOCK), "left")
    results: list[Gaps] = []
    sharing: dict[int, set[int]] = {}
    start = count = 0
    width, height = np.diff(lines.t) / np.ptp(scene.ends[0]), np.ptp(scene.ends[1])
    for stop in distinct(np.minimum(cuts + 1, len(lines.t) - 1)).tolist():
        here = some[(first[some] < stop) & (last[some] > start)]
        a, b = np.maximum(first[here], start), np.minimum(last[here], stop)
        which, slab = ranges(a, b)
        s = here[which]
        v, error = _root_values(scene, segments, s, at[slab], moved[slab])
        off = np.abs(v - scene.ends[1][0] - TURN * segments.turn[s] - np.pi)
        for k in np.flatnonzero((off >= np.pi - error) & scene.turns[1]).tolist():
            v[k] = exact.value(segments.root(int(s[k])), int(slab[k]), int(slab[k]) + 1)
        own = slabs[(slabs >= start) & (slabs < stop)]
        n = len(own)
        s = np.concatenate([s, np.full(n, LOW), np.full(n, HIGH)])
        slab = np.concatenate([slab, own, own])
        v = np.concatenate([v, np.full(n, scene.ends[1][0]), np.full(n, scene.ends[1][1])])
        error = np.concatenate([error, np.zeros(2 * n)])
        order = np.lexsort([v, slab])
        s, slab, v, error = s[order], slab[order], v[order], error[order]
        kept = _settle(exact, segments, (s, slab, v, error), sharing)
        s, slab, v = s[kept], slab[kept], v[kept]
        gap = np.flatnonzero(slab[1:] == slab[:-1])
        below, above, slab = v[gap], v[gap + 1], slab[gap]
        middle, room = (below + above) / 2, np.minimum(width[slab], (above - below) / height)
        span, rank = (x[:, None].repeat(2, axis=1) for x in (slab, count + np.arange(len(gap))))
        found = Gaps(s[gap], s[gap + 1], span, rank, slab, middle, room)
        results.append(_over_slabs(found, cut))
        start, count = stop, count + len(gap)
    return _over_slabs(Gaps.joined(results), cut), sharing


def _settle(
    exact: Exact,
    segments: Segments,
    fibre: tuple[Ints, Ints, Floats, Floats],
    sharing: dict[int, set[int]],
) -> Bools:
    """Put roots whose errors overlap in their exact order; return which are kept (sentence 8).

    Of equal roots one stands for all: an end of the lift, else the smallest number.
    """
    s, slab, v, error = fibre
    begin = np.flatnonzero(clusters(v - error, v + error, slab))
    end = np.append(begin[1:], len(s))
    kept = np.ones(len(s), dtype=np.bool_)
    for k in np.flatnonzero(end - begin > 1).tolist():
        rows, line = np.arange(begin[k], end[k]), int(slab[begin[k]])
        names = s[rows].tolist()
        groups, values = exact.ranked([segments.root(x) for x in names], line, line + 1)
        order = [x for group in groups for x in group]
        chosen = {min(group, key=lambda x: (names[x] >= 0, names[x])) for group in groups}
        s[rows], v[rows] = [names[x] for x in order], [values[x] for x in order]
        kept[rows] = [x in chosen for x in order]
        for group in groups:
            own = {names[x] for x in group if names[x] >= 0}
            for name in own if len(own) > 1 else ():
                sharing.setdefault(name, {name}).update(own)
    return kept


def _root_values(
    scene: Scene, segments: Segments, s: Ints, t: Floats, moved: Floats
) -> tuple[Floats, Floats]:
    """Return lift values of segments and their errors, that of the base value included.

    At a double root the slope is zero, and the bending counts.
    """
    curve, c = segments.curve[s], along(scene, segments, s, t)
    v = named(scene, segments, s, c)
    base, lift = basis(scene.turns[0], t), basis(scene.turns[1], v)
    _, a1, a2 = c
    steep = np.abs(a2 * lift[1] - a1 * lift[2]) if scene.turns[1] else np.abs(a1 + 2 * a2 * v)
    bent = np.hypot(a1, a2) if scene.turns[1] else np.abs(a2)
    steep = np.where(scene.double[curve] & (moved == 0), bent, steep)
    doubt = scene.errors[curve] * np.abs(lift).sum(axis=0)
    rows = along_base(scene.turns[0], scene.table[curve])
    slopes = np.einsum("in,nij,jn->n", base, rows, lift)
    doubt = doubt + np.abs(slopes) * moved
    return v, 4 * doubt / np.maximum(steep, 1e-300) + 32 * UNIT * (1 + np.abs(v))


def _cell_ends(
    scene: Scene, exact: Exact, lines: Lines, segments: Segments, span: Ints, roots: Ints
) -> Floats:
    """Return the lift values of both roots of cells on their two lines, as limits from inside.

    A curve that hardly moves with the lift, or is about something tiny, is asked exactly, and so is
    a root in a thin slab that may be a turn away.
    """
    found = np.empty((len(roots), 2, 2))
    for e in (0, 1):
        own = roots[:, e]
        found[own == LOW, :, e], found[own == HIGH, :, e] = scene.ends[1]
    k, root = np.nonzero(roots >= 0)
    s, t = roots[k, root], lines.t[span[k]]
    found[k, :, root] = both_ends(scene, segments, s, *t.T).T
    rough = is_rough(scene, segments.curve[s], t.mean(axis=1))
    thin = (np.ptp(t, axis=1) <= TOUCH) & scene.turns[1]
    for side in (0, 1):
        at = roots_at(scene, segments.curve[s], t[:, side])
        # At a fold a root is the mean of both.
        vague = (at.error > TOUCH) & (np.abs(at.rest) > at.doubt)
        off = found[k, side, root] - scene.ends[1][0] - TURN * segments.turn[s] - np.pi
        for n in np.flatnonzero(rough | vague | (thin & (np.abs(off) > np.pi - TOUCH))).tolist():
            place = segments.root(int(s[n])), int(span[k[n], side]), 1 - 2 * side
            found[k[n], side, root[n]] = exact.limit(place)
    return found
