"""Polygons of a component: rings through exact points of its arcs, for drawing and export.

The region itself is bounded by arcs; a polygon is an output, with its largest deviation stated.
Not in the paper, which joins the vertices by straight lines.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats
from qbound.forms.angles import TURN
from qbound.geometry import polygon
from qbound.geometry.polylines import flatten
from qbound.region import Component


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
    """Return the polygons of a component, and how far the exact arcs are from them at most.

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
    >>> from qbound import find_region, load_robot
    >>> home = find_region(load_robot("minervabot-v2")).home
    >>> pieces, deviation = polygons(home, 0.001)
    >>> len(pieces), deviation <= 0.001, round(area(pieces), 3), round(home.area, 3)
    (1, True, 11.781, 11.78)

    Smaller deviations take more corners:

    >>> finer, _ = polygons(home, 0.0001)
    >>> len(finer[0].outer) > len(pieces[0].outer)
    True
    """
    measured, rings = 0.0, []
    for loop in component.loops:
        parts = []
        for arc in loop:
            s, off = flatten(arc.at, deviation, len(arc.pieces.roots))
            measured = max(measured, off)
            parts.append(arc.at(s))
        rings.append(np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]]))
    pieces = _assembled(rings, component.wraps, np.asarray(window, dtype=float))
    return pieces, measured


def area(pieces: Sequence[Piece]) -> float:
    """Return the area of polygons with holes; product of the joints' units."""
    rings = [ring for piece in pieces for ring in (piece.outer, *piece.holes)]
    return sum(polygon.area(ring) for ring in rings)


def _assembled(rings: list[Floats], wraps: tuple[bool, bool], window: Floats) -> list[Piece]:
    """Cut closed loops at a window and join what is left along its edge (the left is inside)."""
    closed, chains = [], []
    for ring in rings:
        parts = list(_cut(ring, wraps, window[:, 0]))
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
    if not outers:  # nothing meets the window's edge: it is all inside
        (x0, x1), (y0, y1) = edge
        outers = [np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])]
    return [Piece(o, tuple(h for h in holes if polygon.contains(o, h[0]))) for o in outers]


def _cut(ring: Floats, wraps: tuple[bool, bool], low: Floats) -> Iterator[Floats]:
    """Cut a loop wherever a joint passes the window's edge, and bring all parts into the window."""
    shape = np.array(wraps, dtype=float)
    points = _with_cuts(ring, wraps, low)
    tiles = np.floor(((points[:-1] + points[1:]) / 2 - low) / TURN) * shape
    runs = [[i for i, _ in run] for _, run in groupby(enumerate(tiles), key=lambda x: tuple(x[1]))]
    net = np.round((ring[-1] - ring[0]) / TURN) * shape
    if len(runs) > 1 and (tiles[-1] - net == tiles[0]).all():
        start = points[runs[0][0] : runs[0][-1] + 2] - TURN * tiles[0]
        end = points[runs[-1][0] : runs[-1][-1] + 2] - TURN * tiles[-1]
        yield np.concatenate([end[:-1], start])
        runs = runs[1:-1]
    for run in runs:
        yield points[run[0] : run[-1] + 2] - TURN * tiles[run[0]]


def _with_cuts(ring: Floats, wraps: tuple[bool, bool], low: Floats) -> Floats:
    """Insert the points at which a loop passes the window's edge, there exactly."""
    result = [ring[0]]
    for a, b in pairwise(ring):
        cuts = []
        for j in (0, 1):
            x, y = sorted(((a[j] - low[j]) / TURN, (b[j] - low[j]) / TURN))
            lines = range(math.floor(x) + 1, math.ceil(y)) if wraps[j] else range(0)
            for line in lines:
                t = (low[j] + TURN * line - a[j]) / (b[j] - a[j])
                point = a + t * (b - a)
                point[j] = low[j] + TURN * line
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
