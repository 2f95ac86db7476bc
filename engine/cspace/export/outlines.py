"""Polygons of a region for other programs: CSV, GeoJSON, NumPy arrays, shapely.

A component becomes rings through exact points of its arcs.

The region itself is bounded by arcs; a polygon is an output, with its largest deviation stated.
Not in the paper, which joins the vertices by straight lines.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.export.formats import csv_text, npz_bytes
from cspace.extras import require
from cspace.geometry import polygon
from cspace.geometry.polygon import flatten
from cspace.region import Component, Region

if TYPE_CHECKING:
    from shapely import MultiPolygon, Polygon

SLIT = 1e-9
"""A part of a polygon's area that counts as none."""


@dataclass(frozen=True, eq=False)
class Outlines:
    """Polygons of every component of a region, within a given deviation of its arcs.

    Attributes
    ----------
    region : Region
    pieces : tuple of list of Piece
        Polygons of each component: one, unless it goes round a joint and is cut.
    deviations : tuple of float
        Largest distance of each component's arcs from its polygons, in the plane of the joints.
    """

    region: Region
    pieces: tuple[list[Piece], ...]
    deviations: tuple[float, ...]

    def rings(self) -> Iterator[tuple[int, int, int, Floats]]:
        """Yield component, piece and ring by number (ring 0 is the outer one) and the corners."""
        for c, pieces in enumerate(self.pieces):
            for p, piece in enumerate(pieces):
                for r, ring in enumerate((piece.outer, *piece.holes)):
                    yield c, p, r, ring


def find_outlines(region: Region, deviation: float = 1e-3) -> Outlines:
    """Draw polygons through the arcs of every component of a region.

    Parameters
    ----------
    deviation : float
        Largest distance of the polygons from the arcs, in the plane of the two joint values.

    Raises
    ------
    ValueError
        If the deviation is not above zero.
    """
    drawn = [polygons(component, deviation) for component in region.components]
    return Outlines(region, tuple(p for p, _ in drawn), tuple(off for _, off in drawn))


def outlines_csv(drawn: Outlines) -> str:
    """Return one row a corner: component, piece and ring (0 the outer one, then holes)."""
    problem = drawn.region.problem
    joints = zip(problem.joint_names, problem.units, strict=True)
    rows = (
        [c, p, r, *corner, drawn.deviations[c]]
        for c, p, r, ring in drawn.rings()
        for corner in ring.tolist()
    )
    return csv_text(["component", "piece", "ring", *map("_".join, joints), "deviation"], rows)


def outlines_geojson(drawn: Outlines) -> dict[str, Any]:
    """Return a GeoJSON FeatureCollection, with joint values instead of places on Earth.

    Every component is a feature; a ring ends where it begins. A component that goes round a joint
    is cut where that joint is -pi or pi; `wraps` names the joint. Properties are numbers, texts,
    truth values and lists of texts: lists of others are not read, or lost, by GeoPandas.
    """
    return {
        "type": "FeatureCollection",
        "features": [_feature(drawn, c) for c in range(len(drawn.pieces))],
    }


def outlines_npz(drawn: Outlines) -> bytes:
    """Return the corners of all rings in one array, with the start and component of each ring.

    Ring i is ``points[start[i]:start[i + 1]]``, of component ``component[i]`` and its piece
    ``piece[i]``; ``ring[i]`` is 0 for an outer one.
    """
    rings = list(drawn.rings())
    c, p, r = np.array([numbers for *numbers, _ in rings], dtype=int).reshape(-1, 3).T
    components, problem = drawn.region.components, drawn.region.problem
    return npz_bytes(
        {
            "points": np.concatenate([np.empty((0, 2)), *(ring for *_, ring in rings)]),
            "start": np.cumsum([0, *(len(ring) for *_, ring in rings)]),
            "component": c,
            "piece": p,
            "ring": r,
            "area": np.array([component.area for component in components]),
            "contains_home": np.array([part.contains_home for part in components], dtype=bool),
            "deviation": np.array(drawn.deviations),
            "joints": np.array(problem.joint_names),
            "units": np.array(problem.units),
        }
    )


def outlines_shapely(drawn: Outlines, component: int | None = None) -> MultiPolygon:
    """Return the polygons of all components, or of one of them, as one shapely geometry.

    Warns where shapely finds that they are not valid; see `Region.to_shapely`.
    """
    require("shapely", "a region as a shapely geometry")
    from shapely import MultiPolygon, is_valid_reason

    chosen = drawn.pieces if component is None else (drawn.pieces[component],)
    found = MultiPolygon([part for pieces in chosen for p in pieces for part in _in_shapely(p)])
    if not found.is_valid:
        warnings.warn(
            f"these polygons are not valid for shapely: {is_valid_reason(found)}. What it makes of"
            " them may be wrong, such as unions and repaired polygons; the region is right",
            stacklevel=3,  # at the caller of `Region.to_shapely`
        )
    return found


def _in_shapely(piece: Piece) -> list[Polygon]:
    """Return a piece as polygons; where its rings touch, a slit without area is left out."""
    from shapely import Polygon, get_parts, union_all

    found = Polygon(piece.outer, piece.holes)
    whole, holes = Polygon(piece.outer), [Polygon(hole) for hole in piece.holes]
    if found.is_valid or not all(own.is_valid for own in (whole, *holes)):
        return [found]
    rest, least = whole.difference(union_all(holes)), SLIT * whole.area
    if abs(rest.area - found.area) > least:
        return [found]
    return [part for part in get_parts(rest) if part.area > least]


def _feature(drawn: Outlines, c: int) -> dict[str, Any]:
    component, problem = drawn.region.components[c], drawn.region.problem
    names = list(problem.joint_names)
    return {
        "type": "Feature",
        "properties": {
            "component": c,
            "contains_home": component.contains_home,
            "area": component.area,
            "deviation": drawn.deviations[c],
            "wraps": [name for name, w in zip(names, component.wraps, strict=True) if w],
            "joints": names,
            "unit": list(problem.units),
        },
        "geometry": {
            "type": "MultiPolygon",
            "coordinates": [_closed(piece) for piece in drawn.pieces[c]],
        },
    }


def _closed(piece: Piece) -> list[list[list[float]]]:
    return [[*ring.tolist(), ring[0].tolist()] for ring in (piece.outer, *piece.holes)]


# --- polygons -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Piece:
    """A polygon with holes.

    Attributes
    ----------
    outer : ndarray, shape (m, 2)
        Anticlockwise; the first point is not repeated. Joint values, rad or length.
    holes : tuple of ndarray, shape (k, 2)
        Clockwise.
    """

    outer: Floats
    holes: tuple[Floats, ...]


def polygons(
    component: Component, deviation: float, window: ArrayLike = ((-math.pi, math.pi),) * 2
) -> tuple[list[Piece], float]:
    """Return the polygons of a component, and the largest distance of the exact arcs from them.

    Parameters
    ----------
    deviation : float
        Largest distance allowed, in the plane of the two joint values.
    window : array_like, shape (2, 2)
        A component that goes round a joint is cut at these values of that joint, a turn apart.

    Returns
    -------
    pieces : list of Piece
        One, unless the component is cut.
    deviation : float
        Measured on the exact arcs, at three places between neighbouring points.

    Raises
    ------
    ValueError
        If the deviation is not above zero.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> home = find_region(load_robot("minervabot-v2")).home_component
    >>> pieces, deviation = polygons(home, 0.001)
    >>> len(pieces), deviation <= 0.001, round(area(pieces), 3), round(home.area, 3)
    (1, True, 11.781, 11.78)

    Smaller deviations need more corners:

    >>> finer, _ = polygons(home, 0.0001)
    >>> len(finer[0].outer) > len(pieces[0].outer)
    True
    """
    measured, rings = 0.0, []
    for loop in component.loops:
        parts = []
        for arc in loop:
            s, off = flatten(arc.at, deviation, len(arc.pieces))
            measured = max(measured, off)
            parts.append(arc.at(s))
        rings.append(np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]]))
    pieces = assembled(rings, component.wraps, np.asarray(window, dtype=float))
    return pieces, measured


def area(pieces: Sequence[Piece]) -> float:
    """Return the area of polygons with holes; product of the joints' units."""
    rings = [ring for piece in pieces for ring in (piece.outer, *piece.holes)]
    return sum(polygon.area(ring) for ring in rings)


def assembled(rings: Sequence[Floats], wraps: tuple[bool, bool], window: Floats) -> list[Piece]:
    """Cut closed loops at a window and join the chains along its edge, inside on the left.

    Parameters
    ----------
    rings : sequence of ndarray, shape (m, 2)
        Loops that end where they begin, or full turns from there.
    wraps : tuple of bool
        Which joints the component goes round; the loops are cut at the window's values of these.
    window : ndarray, shape (2, 2)
        Lowest and highest value of each joint, a full turn apart in the unit of the loops.
    """
    closed, chains = [], []
    for ring in rings:
        parts = list(_cut(ring, wraps, window))
        if len(parts) == 1 and np.allclose(parts[0][0], parts[0][-1], atol=1e-6):
            closed.append(parts[0][:-1])
        else:
            chains += parts
    points = np.concatenate([*closed, *chains, window.T])
    low, high = points.min(axis=0) - 1, points.max(axis=0) + 1  # out of reach of the other joint
    edge = np.where(np.array(wraps)[:, None], window, np.stack([low, high], axis=1))
    closed += _along_edge(chains, edge)
    outers = [ring for ring in closed if polygon.area(ring) > 0]
    holes = [ring for ring in closed if polygon.area(ring) < 0]
    if not outers:  # nothing meets the window's edge: all is inside
        (x0, x1), (y0, y1) = edge
        outers = [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])]
    # A hole may touch the ring about it, so one of its corners does not tell.
    return [
        Piece(o, tuple(h for h in holes if polygon.contains(o, h).mean() > 0.5)) for o in outers
    ]


def _cut(ring: Floats, wraps: tuple[bool, bool], window: Floats) -> Iterator[Floats]:
    """Cut a loop wherever a joint passes the window's edge, and shift all parts into the window."""
    low, turn = window[:, 0], np.diff(window)[:, 0]
    points = _with_cuts(ring, wraps, low, turn)
    tiles = np.floor(((points[:-1] + points[1:]) / 2 - low) / turn) * wraps
    runs = [[i for i, _ in run] for _, run in groupby(enumerate(tiles), key=lambda x: tuple(x[1]))]
    net = np.round((ring[-1] - ring[0]) / turn) * wraps
    if len(runs) > 1 and (tiles[-1] - net == tiles[0]).all():
        start = points[runs[0][0] : runs[0][-1] + 2] - turn * tiles[0]
        end = points[runs[-1][0] : runs[-1][-1] + 2] - turn * tiles[-1]
        yield np.concatenate([end[:-1], start])
        runs = runs[1:-1]
    for run in runs:
        yield points[run[0] : run[-1] + 2] - turn * tiles[run[0]]


def _with_cuts(ring: Floats, wraps: tuple[bool, bool], low: Floats, turn: Floats) -> Floats:
    """Insert the points at which a loop passes the window's edge, exactly on the edge."""
    result = [ring[0]]
    for a, b in pairwise(ring):
        cuts = []
        for j in (0, 1):
            x, y = sorted(((a[j] - low[j]) / turn[j], (b[j] - low[j]) / turn[j]))
            lines = range(math.floor(x) + 1, math.ceil(y)) if wraps[j] else range(0)
            for line in lines:
                t = (low[j] + turn[j] * line - a[j]) / (b[j] - a[j])
                point = a + t * (b - a)
                point[j] = low[j] + turn[j] * line
                cuts.append((t, tuple(point)))
        result += [np.array(point) for _, point in sorted(cuts)] + [b]
    return np.array(result)


def _along_edge(chains: list[Floats], edge: Floats) -> list[Floats]:
    """Join chains into rings: from the end of one, anticlockwise along the edge to the next."""
    starts = [_round_edge(chain[0], edge) for chain in chains]
    ends = [_round_edge(chain[-1], edge) for chain in chains]
    (x0, x1), (y0, y1) = edge
    corners = [np.array(c) for c in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))]
    rings, left = [], set(range(len(chains)))
    while left:
        first = k = min(left)
        ring: list[Floats] = []
        while True:
            left.discard(k)
            ring += list(chains[k])
            here = ends[k]
            k = min([*left, first], key=lambda i: (starts[i] - here) % 4)
            way = (starts[k] - here) % 4
            between = sorted((c - here) % 4 for c in range(4))
            ring += [corners[round(here + d) % 4] for d in between if 0 < d < way]
            if k == first:
                break
        rings.append(np.array(ring))
    return rings


def _round_edge(point: Floats, edge: Floats) -> float:
    """Place of a point on the edge, anticlockwise from the lower left corner: 0 to 4."""
    (x, y), (x0, x1), (y0, y1) = point, *edge
    t, u = (x - x0) / (x1 - x0), (y - y0) / (y1 - y0)
    sides = [(abs(u), t), (abs(t - 1), 1 + u), (abs(u - 1), 3 - t), (abs(t), 4 - u)]
    return float(min(sides)[1])
