"""Outlines: closed loops round components, their labels, corners and vertices.

A walk goes round each cell with the cell on the left: along its lower root, up the line at its end,
back along the upper root, down the line at its start. Where cells are joined it goes on round the
other cell. What is left are the closed loops that bound a component.

A piece of boundary is labelled with the features that vanish along it and separate the component
from what they forbid, and with the branch of their root. Pieces with one label are one arc. A
vertex is where the features change; at a fold only the branch does (sentence 11).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np

from cspace.arrays import Bools, Floats, Ints, distinct
from cspace.forms.factors import basis_and_slope
from cspace.order import Key, ordered_by
from cspace.region.algebra import LOW
from cspace.region.arcs import STRAIGHT, Arc, Component, Curves, Pieces, Vertex, behind, ordered
from cspace.region.cells import Cells
from cspace.region.components import End, Join, Part, compare, half_way, standing, wall_cuts
from cspace.region.events import is_rough, roots_at
from cspace.region.exact import Between, Spot
from cspace.region.places import CellMap, Placed
from cspace.region.problem import Problem
from cspace.region.segments import follow
from cspace.tolerances import QUADRATURE, TIED, TOUCH, UNIT
from qbound.circle import TURN, nearest_turn
from qbound.forms import Kind

BOTTOM, RIGHT, TOP, LEFT = range(4)
"""Sides of a cell, in the order of the walk."""

ROOMY = 1e-9
"""A gap of this part of the ranges is looked at in doubles."""

BESIDE = 1e-7
"""How far beside a piece of boundary along a line it is asked what is forbidden there."""


class Edge(NamedTuple):
    """A piece of a cell's boundary at which the cell is joined to nothing.

    Attributes
    ----------
    cell, side : int
    ends : tuple of End
        Of a piece along a line; empty along a root.
    """

    cell: int
    side: int
    ends: tuple[End, ...] = ()


class Label(NamedTuple):
    """What makes pieces one arc.

    Attributes
    ----------
    features : tuple of int
        Features that vanish; none at a limit.
    branch : int
        -1 or +1 as `Arc.branch`, 0 for None.
    limit : int
        0 and 1 for the ends of the base, 2 and 3 for those of the lift; -1 for none.
    """

    features: tuple[int, ...]
    branch: int = 0
    limit: int = -1


class Piece(NamedTuple):
    """A piece of boundary with one label, in the direction of the loop, in the scene's units.

    It follows the lower or the upper root of a cell, or is straight.
    """

    cell: int
    upper: int
    curve: int
    slope: int
    turn: int
    start: tuple[float, float]
    end: tuple[float, float]
    label: Label

    def reversed(self) -> Piece:
        """Return the piece in the other direction."""
        return self._replace(start=self.end, end=self.start)


# --- loops (sentence 11) --------------------------------------------------------------------------


def find_loops(cells: Cells, joins: Sequence[Join]) -> list[list[Edge]]:
    """Return the closed loops round components, with these on their left (sentence 11)."""
    beside: dict[tuple[int, int], list[tuple[float, float, int]]] = {}
    rank = cells.rank.tolist()
    twin: dict[tuple[int, int, int], tuple[int, int, int]] = {}
    for n, join in enumerate(joins):
        one, other = (TOP, BOTTOM) if join.lift else (RIGHT, LEFT)
        keys = (join.low, join.low) if join.lift else (rank[join.other][0], rank[join.one][1])
        beside.setdefault((join.one, one), []).append((keys[0], join.low, n))
        beside.setdefault((join.other, other), []).append((keys[1], join.low, n))
        twin[join.one, one, n] = join.other, other, n
        twin[join.other, other, n] = join.one, one, n
    after: dict[object, object] = {}
    left: dict[object, None] = {}
    for k in range(len(cells.span)):
        ring: list[object] = []
        for side in (BOTTOM, RIGHT, TOP, LEFT):
            own = [n for _, _, n in sorted(beside.get((k, side), []))]
            edges = list(_round(cells, joins, k, side, own))
            ring += edges if side in (BOTTOM, RIGHT) else edges[::-1]
        after.update(zip(ring, [*ring[1:], *ring[:1]], strict=True))
        left.update(dict.fromkeys(edge for edge in ring if isinstance(edge, Edge)))
    loops = []
    while left:
        start = edge = next(iter(left))
        loop: list[Edge] = []
        while edge != start or not loop:
            assert isinstance(edge, Edge)
            loop.append(edge)
            del left[edge]
            edge = after[edge]
            while not isinstance(edge, Edge):
                edge = after[twin[edge]]  # type: ignore[index]
        loops.append(loop)
    return loops


def _round(
    cells: Cells, joins: Sequence[Join], k: int, side: int, own: list[int]
) -> Iterator[Edge | tuple[int, int, int]]:
    """Yield what lies along one side of a cell, from low to high: edges, and joins by number."""
    if side in (BOTTOM, TOP):
        if cells.roots[k, int(side == TOP)] >= 0 or not cells.scene.round[1]:
            yield Edge(k, side)
        yield from ((k, side, n) for n in own)
        return
    right = int(side == RIGHT)
    line = int(cells.span[k, right])
    roots, ends = cells.roots[k].tolist(), cells.ends[k, right].tolist()
    low, high = (End(ends[e], roots[e], k, right, e) for e in (0, 1))
    bounded = line in cells.walls or _is_limit(cells, line)
    for n in own:
        start, end = joins[n].ends
        if bounded and compare(cells, line, line, low, start) < 0:
            yield Edge(k, side, (low, start))
        yield k, side, n
        low = end
    if bounded and compare(cells, line, line, low, high) < 0:
        yield Edge(k, side, (low, high))


def _is_limit(cells: Cells, line: int) -> bool:
    """Tell whether a line is an end of the base's range."""
    return not cells.scene.round[0] and line in cells.lines.last()


# --- labels (sentence 11) -------------------------------------------------------------------------


class Labels:
    """Labels of the pieces of boundary of some cells (sentence 11)."""

    def __init__(self, cells: Cells) -> None:
        self.cells, self.scene = cells, cells.scene
        parts, line = cells.parts, cells.lines.line
        self.first, self.last = line[parts.start].tolist(), line[parts.end].tolist()
        self.feature: list[int] = parts.feature.tolist()
        self.of_root: dict[tuple[int, int, int], list[int]] = {}
        roots = zip(parts.curve.tolist(), parts.slope.tolist(), parts.turn.tolist(), strict=True)
        for k, root in enumerate(roots):
            self.of_root.setdefault(root, []).append(k)
        self.starts: list[int] = line[cells.segments.start].tolist()
        self.ends: list[int] = line[cells.segments.end].tolist()
        self.walls: dict[int, Ints] = {}
        self.is_free_in = cache(self._is_free_in)

    def pieces(self, loop: Sequence[Edge]) -> Iterator[Piece]:
        """Yield the pieces of a loop."""
        for edge in loop:
            if edge.side in (BOTTOM, TOP):
                found = list(self._along_root(edge.cell, int(edge.side == TOP)))
            else:
                found = list(self._along_line(edge))
            backwards = edge.side in (TOP, LEFT)
            yield from (piece.reversed() for piece in found[::-1]) if backwards else found

    def _along_root(self, k: int, upper: int) -> Iterator[Piece]:
        """Yield the pieces of a cell's lower or upper end, from its first line to its last."""
        cells, t = self.cells, self.cells.lines.t
        segment, (a, b) = int(cells.roots[k, upper]), cells.span[k].tolist()
        ends: list[float] = cells.ends[k, :, upper].tolist()
        start, end = (float(t[a]), ends[0]), (float(t[b]), ends[1])
        if segment < 0:
            limit = Label((), 0, 2 if segment == LOW else 3)
            yield Piece(k, upper, STRAIGHT, 0, 0, start, end, limit)
            return
        curve, slope, turn = cells.segments.root(segment)
        branch = -slope if self.scene.turns[1] else 0
        own = {
            p
            for s in cells.sharing.get(segment, (segment,))
            for p in self.of_root[cells.segments.root(s)]
            if self.first[p] < min(b, self.ends[s]) and self.last[p] > max(a, self.starts[s])
        }
        at = start
        labels = list(self._acting(segment, upper, own, a, b))
        for (until, features), (_, later) in zip(labels, [*labels[1:], (0, None)], strict=True):
            if features != later:
                place = end
                if until < b:
                    v = follow(self.scene, cells.segments, np.array([segment]), t[[until]])
                    place = float(t[until]), float(v[0])
                yield Piece(k, upper, curve, slope, turn, at, place, Label(features, branch))
                at = place

    def _acting(
        self, segment: int, upper: int, parts: set[int], first: int, last: int
    ) -> Iterator[tuple[int, tuple[int, ...]]]:
        """Yield what separates a cell from what is beyond its root: features, and up to which line.

        These are features of pairs in collision on the other side. If there are none, bodies only
        touch, and features count whose form is negative there.
        """
        if len({self.feature[p] for p in parts}) == 1:
            yield last, (self.feature[next(iter(parts))],)
            return
        for slab in range(first, last):
            own = [p for p in parts if self.first[p] <= slab < self.last[p]]
            slopes = {(self.feature[p], int(self.cells.parts.slope[p])) for p in own}
            features = sorted({f for f, _ in slopes}, key=self.scene.source.row)
            if len(features) > 1:
                way = -1 if upper else 1
                turned = [f for f in features if (f, way) in slopes and (f, -way) not in slopes]
                gap = self._beyond(segment, upper, slab)
                met = [f for f in turned if gap is None or not self.is_free_in(f, gap)]
                features = met or turned or features
            yield slab + 1, tuple(features)

    @cached_property
    def beside(self) -> dict[tuple[int, int], list[int]]:
        """The gaps below (0) and above (1) each segment, by the numbers of side and segment."""
        found: dict[tuple[int, int], list[int]] = {}
        for side, bounds in enumerate((self.cells.gaps.upper, self.cells.gaps.lower)):
            for k, segment in enumerate(bounds.tolist()):
                found.setdefault((side, segment), []).append(k)
        return found

    def _beyond(self, segment: int, upper: int, slab: int) -> int | None:
        """Return the number of the gap beyond a segment in a slab; None: no gap."""
        span = self.cells.gaps.span
        beside = self.beside.get((upper, segment), ())
        return next((k for k in beside if span[k, 0] <= slab <= span[k, 1]), None)

    def _is_free_in(self, f: int, gap: int) -> bool:
        """Tell whether a feature's boundary is free in a gap beyond its root."""
        gaps, slab = self.cells.gaps, self.cells.gaps.slab[gap]
        t, v = float(self.cells.lines.between[slab]), float(gaps.middle[gap])
        spot = gaps.spot(gap, self.cells.segments)
        return self._is_free(f, spot, t, v, bool(gaps.room[gap] > ROOMY))

    def _is_free(self, f: int, spot: Spot, t: float, v: float, roomy: bool) -> bool:
        """Tell whether a feature's boundary is free beyond its root: by doubles if it is roomy."""
        scene, exact, pair = self.scene, self.cells.exact, int(self.scene.pair[f])
        if pair < 0:
            return False  # the form itself falls through zero there
        products = scene.products(np.array([t]), np.array([v]))
        sure, maybe = scene.source.clauses(pair).apart(products)
        if roomy and (sure[0] or not maybe[0]):
            return bool(sure[0])
        return exact.is_apart(pair, spot)

    def _along_line(self, edge: Edge) -> Iterator[Piece]:
        """Yield the pieces of a line that bound a cell."""
        cells, scene, up = self.cells, self.scene, edge.side == RIGHT
        line = int(cells.span[edge.cell, int(up)])
        t = float(cells.lines.t[line])
        if line not in self.walls:
            own = np.isin(scene.curve, list(cells.walls.get(line, ()))) & scene.live
            self.walls[line] = np.flatnonzero(own)
        f, cuts = self.walls[line], [*edge.ends]
        branch = (1 if up else -1) if scene.turns[0] else 0
        if _is_limit(cells, line):
            labels = [Label((), 0, int(up))]
        elif len(f) == 1:
            labels = [Label((int(f[0]),), branch)]
        else:
            cuts = wall_cuts(cells, line, f, *cuts)
            middles = [half_way(cells, low, high) for low, high in pairwise(cuts)]
            labels = [Label(self._standing(line, f, at, up), branch) for at in middles]
        for label, (low, high) in zip(labels, pairwise(cuts), strict=True):
            yield Piece(edge.cell, 0, STRAIGHT, 0, 0, (t, low.v), (t, high.v), label)

    def _standing(self, line: int, f: Ints, at: Between, up: bool) -> tuple[int, ...]:
        """Return which features along a line forbid its other side at a lift value."""
        cells, scene, exact = self.cells, self.scene, self.cells.exact
        found = standing(cells, line, f, at) or f.tolist()
        features = sorted(found, key=scene.source.row)
        if len(features) < 2:
            return tuple(features)
        side = 1 if up else -1
        turned = [x for x in features if side * exact.slope(int(scene.curve[x]), line, at) < 0]
        t, v = cells.lines.t[line], at if isinstance(at, float) else 0.0
        gaps = np.abs(cells.lines.t - t)
        alone = isinstance(at, float) and bool(gaps[gaps > 0].min(initial=1.0) > BESIDE)
        place = (line, side, at), float(t + side * BESIDE), v, alone
        met = [x for x in turned if not self._is_free(x, *place)]
        return tuple(met or turned or features)


# --- arcs (sentence 11) ---------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Laid:
    """The pieces of all loops, one behind the other, in joint values.

    Attributes
    ----------
    pieces : Pieces
    first : ndarray of bool, shape (n,)
        Whether a piece begins a loop.
    before : ndarray of int, shape (n,)
        The piece before it in its loop.
    label : list of Label
    """

    pieces: Pieces
    first: Bools
    before: Ints
    label: list[Label]


def lay(cells: Cells, own: CellMap, loops: Sequence[Sequence[Piece]], shifts: Floats) -> Laid:
    """Put the pieces of all loops one behind the other, each loop from where an arc begins.

    Parameters
    ----------
    own : CellMap
        The cells as data.
    shifts : ndarray, shape (loops, 2)
        Added to base and lift values of each loop, rad.
    """
    scene, chosen = cells.scene, list[Piece]()
    for given in loops:
        loop = [piece.reversed() for piece in given[::-1]] if scene.base == 1 else list(given)
        new = next((k for k in range(len(loop)) if loop[k].label != loop[k - 1].label), 0)
        chosen += [*loop[new:], *loop[:new]]
    count = np.array([len(loop) for loop in loops])
    starts, of = np.cumsum(count) - count, np.arange(len(loops)).repeat(count)
    before = np.arange(len(chosen)) - 1
    before[starts] += count
    first = before >= np.arange(len(chosen))
    scale = np.array(scene.scale)
    moved = TURN * own.turns[[p.cell for p in chosen]] + shifts[of]
    start = np.array([p.start for p in chosen]) * scale + moved
    end = np.array([p.end for p in chosen]) * scale + moved
    # Where a loop goes round a joint it passes a cut: it goes on a turn further.
    circles = np.array(scene.round)
    jumps = np.rint((end[before] - start) / TURN) * circles
    jumps[starts] = 0
    jumps = jumps.cumsum(axis=0)
    jumps -= jumps[starts][of]
    start, end, moved = (x + TURN * jumps for x in (start, end, moved))
    pieces = Pieces(
        own.curves,
        np.array([STRAIGHT if p.curve < 0 else own.row[p.cell, p.upper] for p in chosen]),
        np.array([p.slope for p in chosen]),
        own.floor[[p.cell for p in chosen], [p.upper for p in chosen]] + moved[:, 1],
        start,
        end,
    )
    label = [p.label for p in chosen]
    _meet(cells, pieces, before, label, moved)
    return Laid(pieces, first, before, label)


def _meet(cells: Cells, pieces: Pieces, before: Ints, label: list[Label], moved: Floats) -> None:
    """Let each piece begin where the one before it ends; on a limit exactly."""
    scene, start, end = cells.scene, pieces.start, pieces.end
    after = np.empty_like(before)
    after[before] = np.arange(len(before))
    gaps = end[before] - start
    gaps -= TURN * np.rint(gaps / TURN) * np.array(scene.round)
    scale = np.array(scene.scale)
    own, other = (
        _root_errors(cells, pieces.row, (x - moved)[:, 0] / scale[0]) for x in (start, end)
    )
    other = other[before]  # the better an end is known, the more it counts
    share = own / (own + other)
    start += gaps * share[:, None]
    end -= (gaps * (1 - share)[:, None])[after]
    at = start - moved
    pinned = np.full((len(label), 2), np.nan)
    for n, (_, _, limit) in enumerate(label):
        if limit >= 0:
            pinned[n, limit // 2] = scene.ends[limit // 2][limit % 2]
        elif pieces.row[n] < 0:
            pinned[n, 0] = (pieces.start[n, 0] - moved[n, 0]) / scale[0]
    # A limit is that of the file, to the last digit.
    pin = np.where(np.isnan(pinned), pinned[before], pinned) * scale
    at = np.where(np.isnan(pin), at, pin)
    for j in (0, 1):
        if not scene.round[j]:
            low, high = np.array(scene.ends[j]) * scale[j]
            at[:, j] = np.clip(at[:, j], low, high)
    step = at + moved - start
    start += step
    end[before] += step


def _root_errors(cells: Cells, row: Ints, t: Floats) -> Floats:
    """Return the errors of roots at base values; of straight pieces nothing is known."""
    found, count = np.full(len(row), 1e6), len(cells.scene.table)
    k = np.flatnonzero((row >= 0) & (row < count))
    found[row >= count] = 16 * UNIT
    found[k] = np.minimum(roots_at(cells.scene, row[k], t[k]).error, found[k])
    return found


def find_arcs(cells: Cells, laid: Laid, problem: Problem) -> list[tuple[tuple[Arc, ...], Bools]]:
    """Return each loop's arcs, from its lowest vertex; which begin at a vertex (sentence 11)."""
    scene, label = cells.scene, laid.label
    begin = np.array(
        [k for k in range(len(label)) if laid.first[k] or label[k] != label[laid.before[k]]]
    )
    vague = _errors(cells, laid, begin)
    limits = [*problem.limits[scene.base], *problem.limits[1 - scene.base]]
    arcs, corners = [], []
    for k, end, error in zip(begin, [*begin[1:], len(label)], vague.tolist(), strict=True):
        pieces, (features, branch, limit) = laid.pieces[k:end], label[k]
        other = label[laid.before[k]]
        corners.append((features, limit) != (other.features, other.limit))
        if not features:
            arcs.append(Arc(limits[limit], branch or None, pieces, vague=error))
            continue
        names = [scene.labels[f] for f in features]
        also = tuple(sorted(set(names) - {names[0]}))
        row = int(scene.curve[features[0]])
        arcs.append(Arc(names[0][0], branch or None, pieces, names[0][1], row, also, error))
    place = [*np.flatnonzero(laid.first[begin]).tolist(), len(arcs)]
    units = _units(problem)
    found = []
    for a, b in pairwise(place):
        order = _from_lowest(arcs[a:b], corners[a:b], units)
        found.append((tuple(arcs[a + k] for k in order), np.array([corners[a + k] for k in order])))
    return found


def _units(problem: Problem) -> Floats:
    """Return the unit of both joints: 1 rad, or a slide's farthest limit."""
    ends = zip(problem.forms.kinds, problem.ranges, strict=True)
    units = [1.0 if kind == "revolute" or r is None else max(map(abs, r)) for kind, r in ends]
    return np.array([unit or 1.0 for unit in units])


def _errors(cells: Cells, laid: Laid, begin: Ints) -> Floats:
    """Bound the errors of the starts of arcs, in units of a joint.

    Where two curves cross at an angle, the error is their errors over the sine of the angle. Where
    they are tangent, or one turns back, it is the square root of their errors.
    """
    scene, pieces = cells.scene, laid.pieces
    q = pieces.start[begin] / np.array(scene.scale)
    slopes, errors = np.zeros((2, len(begin), 2)), np.full((2, len(begin)), UNIT)
    kinds: list[Kind] = ["revolute" if turn else "prismatic" for turn in scene.turns]
    for side, rows in enumerate((laid.before[begin], begin)):
        own = [laid.label[k] for k in rows]
        limit = np.array([label.limit for label in own])
        slopes[side] = np.where((limit < 2)[:, None], [1.0, 0.0], [0.0, 1.0])
        form = np.array([scene.curve[x.features[0]] if x.features else STRAIGHT for x in own])
        k = np.flatnonzero(form >= 0)
        base, lift = (basis_and_slope(kind, q[k, j]) for j, kind in enumerate(kinds))
        both = base @ scene.table[form[k]] @ lift.swapaxes(1, 2)
        slopes[side, k] = np.stack([both[:, 1, 0], both[:, 0, 1]], axis=1)
        errors[side, k] = (scene.eps[form[k]] + 8 * UNIT) * scene.size[form[k]]
    steep = np.abs(slopes[0, :, 0] * slopes[1, :, 1] - slopes[0, :, 1] * slopes[1, :, 0])
    wide = errors.max(axis=0) * np.linalg.norm(slopes, axis=2).max(axis=0)
    return np.asarray(2 * wide / np.maximum(np.maximum(steep, np.sqrt(wide)), UNIT) + 16 * UNIT)


def _from_lowest(arcs: list[Arc], corners: list[bool], units: Floats) -> list[int]:
    """Let a loop begin at its lowest vertex: by the last joint, then the first (Figure 5).

    A loop that goes round a joint is not changed.
    """
    vertices = [k for k, corner in enumerate(corners) if corner]
    around = np.abs(arcs[-1].end - arcs[0].start).max() >= math.pi
    if around or not vertices:
        return list(range(len(arcs)))

    def key(joint: int) -> Key[int]:
        unit = float(units[joint])
        return lambda k: (float(arcs[k].start[joint]), max(TIED, arcs[k].vague) * unit)

    lowest = ordered_by(vertices, [key(1), key(0)])[0]
    return [*range(lowest, len(arcs)), *range(lowest)]


# --- components -----------------------------------------------------------------------------------


def outlined(
    cells: Cells,
    joins: Sequence[Join],
    parts: Sequence[Part],
    searched: Problem,
    problem: Problem,
    home: Floats,
) -> tuple[tuple[Component, ...], CellMap]:
    """Return the components with their boundaries, and their cells (sentences 11 and 12).

    The components with the home pose come first, the others as `in_canonical_order` puts them. A
    component that holds the home pose is placed on its turns; others are placed with their centroid
    in (-pi, pi], up to `TIED`.
    """
    base, circles = cells.scene.base, np.array(cells.scene.round)
    own = cell_map(cells, joins, parts)
    moments = own.moments()
    moments[:, 1:] += moments[:, :1] * TURN * own.turns
    sums = np.zeros((len(parts), 3))
    np.add.at(sums, own.owner, moments)
    areas, middles = sums[:, 0], sums[:, 1:] / np.where(sums[:, :1] > 0, sums[:, :1], 1.0)
    bounded = np.array([not any(part.wraps) for part in parts], dtype=np.bool_)
    shifts = (nearest_turn(middles, TIED) - middles) * circles * bounded[:, None]
    at_home: dict[int, Placed] = {}
    for one in own.closures(problem, home):
        at_home.setdefault(int(own.owner[one.cell]), one)
    for k, one in at_home.items():
        shifts[k] = ordered(home, base) - one.place - TURN * own.turns[one.cell]
    loops, labels = find_loops(cells, joins), Labels(cells)
    of = own.owner[[loop[0].cell for loop in loops]] if loops else own.owner[:0]
    rings: list[list[tuple[tuple[Arc, ...], Bools]]] = [[] for _ in parts]
    if loops:
        pieces = [list(labels.pieces(loop)) for loop in loops]
        laid = lay(cells, own, pieces, shifts[of])
        for k, ring in zip(of.tolist(), find_arcs(cells, laid, searched), strict=True):
            rings[k].append(ring)
    found = [
        Component(
            float(areas[k]),
            ordered(middles[k] + shifts[k], base) if bounded[k] else None,
            (part.wraps[base], part.wraps[1 - base]),
            tuple(ring for ring, _ in rings[k]),
            tuple(vertex for ring in rings[k] for vertex in _vertices(*ring)),
            k in at_home,
            problem.area_unit,
        )
        for k, part in enumerate(parts)
    ]
    rounds = problem.ranges[0] is None, problem.ranges[1] is None
    order = in_canonical_order(found, _units(problem), rounds)
    number = np.argsort(np.array(order, dtype=np.int64))
    own = replace(own, owner=number[own.owner] if len(parts) else own.owner)
    return tuple(found[k] for k in order), own


def cell_map(cells: Cells, joins: Sequence[Join] = (), parts: Sequence[Part] = ()) -> CellMap:
    """Return the cells as data, in joint values; the curves are those of the scene."""
    scene, segments, roots = cells.scene, cells.segments, cells.roots
    scale = np.array(scene.scale)
    k, e = np.nonzero(roots >= 0)
    row, slope, turn = roots.copy(), np.zeros_like(roots), np.zeros_like(roots)
    for column, own in ((row, segments.curve), (slope, segments.slope), (turn, segments.turn)):
        column[k, e] = own[roots[k, e]]
    owner, turns = np.zeros(len(roots), dtype=np.int64), np.zeros((len(roots), 2), dtype=np.int64)
    for n, part in enumerate(parts):
        owner[part.cells], turns[part.cells] = n, part.turns
    over = [join for join in joins if not join.lift]
    # Lines at which no cell begins or ends are left out.
    lines = distinct([*cells.span.ravel().tolist(), *cells.lines.last()])
    t = cells.lines.t[cells.span[k]].mean(axis=1)
    vague = is_rough(scene, row[k, e], t)
    k, e = k[vague], e[vague]
    of, origin = row[k, e], np.stack([t[vague], cells.ends[k, :, e].mean(axis=1)], axis=1)
    about = [
        cells.exact.about(c, (place[0], place[1]))
        for c, place in zip(of.tolist(), origin.tolist(), strict=True)
    ]
    row[k, e] = len(scene.table) + np.arange(len(k))
    floor = scene.ends[1][0] * scale[1] + TURN * turn
    if scene.turns[1]:  # a root that stays on its floor would jump by a turn with rounding
        off = cells.ends - floor[:, None]
        near = (np.minimum(np.abs(off), np.abs(off - TURN)) < TOUCH).all(axis=1)
        k, e = np.nonzero(near & (roots >= 0))
        v = follow(scene, segments, roots[k, e], cells.lines.t[cells.span[k]].mean(axis=1))
        stays = np.abs((v - floor[k, e] + math.pi) % TURN - math.pi) < TOUCH
        k, e = k[stays], e[stays]
        floor[k, e] = cells.ends[k, 0, e] - math.pi
    return CellMap(
        curves=Curves(
            scene.base,
            scene.turns,
            scene.scale,
            scene.table,
            scene.double,
            origin,
            np.array(about).reshape(-1, 3, 3),
            of,
        ),
        round=scene.round,
        range=np.array(scene.ends) * scale[:, None],
        lines=cells.lines.t[lines] * scale[0],
        span=np.searchsorted(lines, cells.span),
        row=row,
        slope=slope,
        floor=floor,
        ends=cells.ends * scale[1],
        turns=turns,
        owner=owner,
        joined=np.array([j[:2] for j in over], dtype=np.int64).reshape(-1, 2),
        edge=np.array([(j.low, j.high) for j in over]).reshape(-1, 2) * scale[1],
    )


def _vertices(ring: tuple[Arc, ...], corners: Bools) -> Iterator[Vertex]:
    """Yield the vertices of a loop: the starts of those of its arcs that begin at one."""
    for before, arc, corner in zip(behind(ring), ring, corners, strict=True):
        if corner:
            yield Vertex(arc.start, (before.boundary, arc.boundary), arc.vague)


def in_canonical_order(
    components: Sequence[Component], units: Floats, rounds: tuple[bool, bool]
) -> list[int]:
    """Return the order of components, which depends neither on rounding, on units, nor on the base.

    Those with the home pose come first, then by falling area. Areas that may be equal are told
    apart by the centroid's value of the first joint, then of the second; values of joints that turn
    all the way round are in (-pi, pi]. A component that goes round a joint has -pi for this joint,
    and its least value for the other one. Where even these may be equal, the least values of the
    outline decide, seen from the centroid.

    Parameters
    ----------
    units : ndarray, shape (2,)
        Of both joints.
    rounds : tuple of two bool
        Whether each joint turns all the way round.

    Notes
    -----
    The error of an area is `TIED` of it and `QUADRATURE` of the units' product. The error of a
    place is `TIED` of the joint's unit, and what the error of the area makes of it. The error of a
    least value is 1e-6 of the joint's unit.
    """
    product = float(units.prod())

    def area(k: int) -> tuple[float, float]:
        return -components[k].area, TIED * components[k].area + QUADRATURE * product

    def place(joint: int) -> Key[int]:
        def value(k: int) -> tuple[float, float]:
            x, error = _place_of(components[k], rounds)[joint], TIED
            if x is None:
                return -math.pi, 0.0
            if not any(components[k].wraps):
                error += QUADRATURE * product / max(components[k].area, 1e-300)
            error *= float(units[joint])
            if rounds[joint]:
                x = float(nearest_turn(x, 0))
                x += TURN * (x <= error - math.pi)  # the seam counts as pi
            return x, error

        return value

    def least(joint: int) -> Key[int]:
        def value(k: int) -> tuple[float, float]:
            middle, along = components[k].centroid, np.eye(2)[joint]
            if middle is None:
                return 0.0, 0.0
            found = _least(components[k], along) - float(middle[joint])
            return found, TOUCH * float(units[joint])

        return value

    home: Key[int] = lambda k: (float(not components[k].contains_home), 0.0)  # noqa: E731
    keys = [home, area, place(0), place(1), least(0), least(1)]
    return ordered_by(range(len(components)), keys)


def _place_of(component: Component, rounds: tuple[bool, bool]) -> tuple[float | None, float | None]:
    """Return the centroid; of a component that goes round a joint its least value beside it.

    A loop that goes m times round the first joint and n times round the second one moves along
    (m, n): what counts is the least value across, of n q_1 - m q_2 or m q_2 - n q_1.
    """
    if component.centroid is not None:
        return float(component.centroid[0]), float(component.centroid[1])
    ends = [np.rint((loop[-1].end - loop[0].start) / TURN) * rounds for loop in component.loops]
    ways = [np.array([n, -m]) for m, n in ends if m or n]
    if not ways:  # there is no other component that goes round both joints
        return None, None
    way = ways[0] if (ways[0][0] or ways[0][1]) > 0 else -ways[0]
    across = _least(component, way)
    return (across, None) if way[0] else (None, across)


def _least(component: Component, way: Floats) -> float:
    """Return the least product of joint values with a vector along the outline of a component."""
    found = []
    for arc in chain(*component.loops):
        low, high, n = 0.0, 1.0, 32 * len(arc.pieces) + 1
        for _ in range(5):
            s = np.linspace(low, high, n)
            values = arc.at(s) @ way
            k = int(values.argmin())
            low, high, n = s[max(k - 1, 0)], s[min(k + 1, n - 1)], 33
        found.append(float(values.min()))
    return min(found)
