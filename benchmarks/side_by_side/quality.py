"""How good is an answer to "which joint values are safe?": one measure for all methods.

An answer is a list of components, each a list of rings (the outer one first, then holes), each a
list of [q1, q2] in radians. It is laid into one turn of every joint that turns all the way round,
and compared with the exact region: areas by polygons, distances between the boundaries themselves.
What lies on the seam, where such a joint is cut at -pi and pi, is no boundary of either.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from scenes import robot
from shapely import MultiPolygon, Polygon, STRtree
from shapely.affinity import translate

from qbound import Region, find_region
from qbound.export.outlines import polygons

Floats = NDArray[np.float64]
Rings = Sequence[Sequence[Any]]
"""Components, their rings, the corners of these, shape (n, 2)."""

Packed = Mapping[str, Any]
"""Rings as text: what `packed` makes of them."""

TURN = 2 * math.pi
DRAWN = 1e-7
"""Largest distance (rad) of the polygons that stand for the exact region from its arcs."""
SPACING = 0.01
"""Distance (rad) of the places on the exact arcs, and at most on an answer's edges."""
MOST = 50_000
"""Places on an answer's boundary that are looked at, at most: evenly chosen."""
SEAM = 1e-9
"""What is this near (rad) to the cut of a turning joint is on it."""
OVERLAP = 0.5
"""Boundaries are repeated so far (rad) beyond the cuts: the nearest place may lie there."""
SHARED = 1e-6
"""Pieces of an answer that share as much (rad) of a cut are one component."""
CHAIN = 16
"""Edges that are one entry of the tree of nearest edges."""


@dataclass(frozen=True, eq=False)
class Truth:
    """The exact region, as it is compared with.

    Attributes
    ----------
    area : float
    polygons : MultiPolygon
        Within `DRAWN` of the arcs, in one turn of each joint.
    arcs : ndarray, shape (n, 2)
        Places on the arcs, exact, their ends included.
    components : int
    window : ndarray, shape (2, 2)
        Range of each joint.
    turning : tuple of bool
        Which joints turn all the way round.
    """

    area: float
    polygons: MultiPolygon
    arcs: Floats
    components: int
    window: Floats
    turning: tuple[bool, bool]

    @cached_property
    def boundary(self) -> STRtree:
        """The boundary of the polygons, for its nearest places."""
        return _tree(boundary_lines(self.polygons, self.window, self.turning), self)


def quality(scene: str, rings: Rings | Packed, at: Sequence[float] | None = None) -> dict[str, Any]:
    """Compare an answer with the exact region, or with one of its components alone.

    Parameters
    ----------
    scene : str
        One of `scenes.robot`, of two joints.
    rings : list of list of list of [float, float], or dict
        Components, their rings, the corners of these; or what `packed` makes of them.
    at : sequence of two float, optional
        The component that holds this configuration is all that is wanted.

    Returns
    -------
    dict
        ``area`` and ``true_area`` (rad^2), ``area_error`` (their difference over the true one);
        ``covered``, the part of the region that is claimed, and ``beyond``, what is claimed and
        not feasible, in parts of the region; ``missed``, the largest distance (rad) from the exact
        boundary to the answer's, ``invented``, that from the answer's to the exact one,
        ``distance``, the larger of both, and ``typical``, the root mean square of the first;
        ``components`` and ``true_components``; ``corners`` of the answer. Distances are None where
        nothing was answered. From ``invented`` is taken what the drawn arcs may be off, ``DRAWN``.
    """
    truth = true_region(scene, at if at is None else (at[0], at[1]))
    rings = unpacked(rings) if isinstance(rings, Mapping) else rings
    answer = laid_out([_polygon(part) for part in rings], truth.window, truth.turning)
    result = {
        "area": answer.area,
        "true_area": truth.area,
        "area_error": abs(answer.area - truth.area) / truth.area,
        "covered": _shared(answer, truth.polygons) / truth.polygons.area,
        "components": _count(answer, truth.window, truth.turning),
        "true_components": truth.components,
        "corners": sum(len(ring) for part in rings for ring in part),
        "missed": None,
        "invented": None,
        "distance": None,
        "typical": None,
    }
    result["beyond"] = max(0.0, answer.area / truth.polygons.area - result["covered"])
    lines = boundary_lines(answer, truth.window, truth.turning)
    if lines:
        missed = _distances(truth.arcs, _tree(lines, truth))
        mine = np.concatenate([_spaced(line) for line in lines])
        invented = _distances(mine[:: -(-len(mine) // MOST)], truth.boundary) - DRAWN
        far = float(missed.max()), max(0.0, float(invented.max()))
        result |= {"missed": far[0], "invented": far[1], "distance": max(far)}
        result["typical"] = float(np.sqrt(np.mean(missed**2)))
    return result


@lru_cache(maxsize=4)
def true_region(scene: str, at: tuple[float, float] | None = None) -> Truth:
    """Return what answers about a scene, or the component at a configuration, are compared with."""
    region = find_region(robot(scene))
    ranges = region.problem.ranges
    holder = None if at is None else region.component_of(at)
    turning = tuple(ends is None for ends in ranges)
    window = np.array([ends or (-math.pi, math.pi) for ends in ranges])
    parts = [c for i, c in enumerate(region.components) if at is None or i == holder]
    drawn = [
        Polygon(piece.outer, piece.holes)
        for component in parts
        for piece in polygons(component, DRAWN)[0]
    ]
    arcs = [arc for component in parts for loop in component.loops for arc in loop]
    places = np.concatenate([np.empty((0, 2)), *(_on_arc(arc) for arc in arcs)])
    low = window[:, 0]
    wrapped = low + (places - low) % TURN
    return Truth(
        sum(component.area for component in parts),
        laid_out(drawn, window, turning),
        np.where(turning, wrapped, places),
        len(parts),
        window,
        turning,
    )


def rings_of(region: Region, deviation: float) -> list[list[list[list[float]]]]:
    """Return the answer of `qbound` as others give theirs, drawn within `deviation` (rad)."""
    return [
        [ring.tolist() for ring in (piece.outer, *piece.holes)]
        for component in region.components
        for piece in polygons(component, deviation)[0]
    ]


def packed(rings: Rings) -> dict[str, Any]:
    """Return rings as one text of all corners, and how many each ring has: for a line of JSON."""
    corners = [np.asarray(ring, dtype="<f8").reshape(-1, 2) for part in rings for ring in part]
    text = base64.b64encode(np.concatenate([np.empty((0, 2)), *corners]).tobytes()).decode()
    return {"corners": text, "counts": [[len(ring) for ring in part] for part in rings]}


def unpacked(rings: Packed) -> list[list[Floats]]:
    """Return the rings that `packed` has put together."""
    corners = np.frombuffer(base64.b64decode(rings["corners"]), dtype="<f8").reshape(-1, 2)
    parts, k = [], 0
    for counts in rings["counts"]:
        parts.append([corners[k : (k := k + count)] for count in counts])
    return parts


def laid_out(parts: Sequence[Polygon], window: Floats, turning: Sequence[bool]) -> MultiPolygon:
    """Bring polygons into one turn of every joint that turns all the way round, and join them."""
    (x0, x1), (y0, y1) = window
    frame = shapely.box(x0, y0, x1, y1)
    inside = []
    for part in parts:
        for shift in product(
            *(_turns(k, part, window) if t else (0.0,) for k, t in enumerate(turning))
        ):
            inside.append(shapely.intersection(translate(part, *shift), frame))
    return _areas(shapely.union_all(inside))


def boundary_lines(answer: MultiPolygon, window: Floats, turning: Sequence[bool]) -> list[Floats]:
    """Return the boundary of polygons as lines, shape (n, 2) each, without what is on a cut."""
    lines = []
    for part in answer.geoms:
        for ring in (part.exterior, *part.interiors):
            line = shapely.get_coordinates(ring)
            on_cut = np.zeros(len(line) - 1, dtype=bool)
            for k, turns in enumerate(turning):
                for edge in window[k] if turns else ():
                    near = np.abs(line[:, k] - edge) < SEAM
                    on_cut |= near[1:] & near[:-1]
            kept = np.flatnonzero(~on_cut)
            runs = np.split(kept, np.flatnonzero(np.diff(kept) > 1) + 1)
            lines += [line[run[0] : run[-1] + 2] for run in runs if len(run)]
    return lines


def _polygon(rings: Sequence[Any]) -> Any:
    """Return a polygon; rings that cross themselves are mended by what they enclose."""
    part = Polygon(rings[0], rings[1:])
    return part if part.is_valid else _areas(shapely.make_valid(part))


def _areas(shape: Any) -> MultiPolygon:
    """Return what has an area of any geometry."""
    parts = [part for part in shapely.get_parts(shape) if part.geom_type != "MultiPolygon"]
    parts += [p for m in shapely.get_parts(shape) if m.geom_type == "MultiPolygon" for p in m.geoms]
    return MultiPolygon([part for part in parts if part.geom_type == "Polygon" and part.area > 0])


def _turns(k: int, part: Any, window: Floats) -> list[float]:
    """Return the shifts of joint k that bring some of a polygon into the window."""
    low, high = part.bounds[k], part.bounds[k + 2]
    first, last = math.ceil((window[k, 0] - high) / TURN), math.floor((window[k, 1] - low) / TURN)
    return [TURN * n for n in range(first, last + 1)]


def _shared(one: MultiPolygon, other: MultiPolygon) -> float:
    return float(shapely.intersection(one, other).area)


def _count(answer: MultiPolygon, window: Floats, turning: Sequence[bool]) -> int:
    """Count the components of an answer; pieces that meet across a cut are one."""
    pieces = list(answer.geoms)
    group = list(range(len(pieces)))

    def first(i: int) -> int:
        while group[i] != i:
            i = group[i]
        return i

    tree = STRtree(pieces)
    for k, turns in enumerate(turning):
        for i, piece in enumerate(pieces if turns else ()):
            if piece.bounds[k] > window[k, 0]:
                continue
            moved = translate(piece, *(TURN * (k == joint) for joint in (0, 1)))
            for j in tree.query(moved, predicate="intersects"):
                if shapely.intersection(moved, pieces[j]).length > SHARED:
                    group[first(i)] = first(int(j))
    return len({first(i) for i in range(len(pieces))})


def _on_arc(arc: Any) -> Floats:
    """Return places on an arc, its pieces' ends among them, some `SPACING` apart."""
    pieces = len(arc.pieces.roots)
    length = float(np.abs(np.diff(arc.points, axis=0)).sum())
    n = max(4, math.ceil(length / pieces / SPACING))
    return np.asarray(arc.at(np.linspace(0, 1, pieces * n + 1)))


def _spaced(line: Floats) -> Floats:
    """Return the corners of a line and places between them, at most `SPACING` apart."""
    steps = np.maximum(2, np.ceil(np.hypot(*np.diff(line, axis=0).T) / SPACING)).astype(int)
    edge = np.repeat(np.arange(len(steps)), steps)
    first = np.repeat(np.cumsum(steps) - steps, steps)
    part = (np.arange(len(edge)) - first) / steps[edge]
    return np.asarray(line[edge] + part[:, None] * (line[edge + 1] - line[edge]))


def _tree(lines: Sequence[Floats], truth: Truth) -> STRtree:
    """Return lines in short chains, repeated across the cuts, for their nearest places."""
    shifts = product(*((0, -TURN, TURN) if turns else (0,) for turns in truth.turning))
    low, high = truth.window[:, 0] - OVERLAP, truth.window[:, 1] + OVERLAP
    chains = []
    for shift in shifts:
        for line in lines:
            moved = line + np.array(shift)
            if (moved.max(axis=0) < low).any() or (moved.min(axis=0) > high).any():
                continue
            for k in range(0, len(moved) - 1, CHAIN):
                chain = moved[k : k + CHAIN + 1]
                if (chain.max(axis=0) > low).all() and (chain.min(axis=0) < high).all():
                    chains.append(shapely.linestrings(chain))
    return STRtree(chains)


def _distances(places: Floats, lines: STRtree) -> Floats:
    """Return the distance of each place to the nearest line."""
    points = shapely.points(places)
    _, apart = lines.query_nearest(points, all_matches=False, return_distance=True)
    return np.asarray(apart)
