"""Loops of a polygon, filled with triangles, or cut open where they go round a joint.

Joint values of a certificate are numbers, not angles modulo a turn. So a component that goes all
the way round a joint is cut at one value of this joint, and its polygons reach from there to the
same value one turn later. In the file's units a turn is 360 degrees exactly, or a decimal just
above 2 pi.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats
from cspace.geometry import polygon
from cspace.geometry.convex import in_whole_numbers
from cspace.geometry.triangulation import triangulated

Polygon = list[Floats]
"""An outline, anticlockwise, and its holes, clockwise."""

PERIODS = 4
"""Copies of a loop on each side of the cut: more than one that winds about a joint needs."""

SHIFTS = 3
"""Turns by which a loop may be shown away from its neighbours."""

FAR = 1e6
"""Farther than any joint value of a certificate, in the file's units."""

ON_THE_CUT = 1e-9
"""What is this near to the cut, in the file's unit, lies on it."""

SAME_AREA = 0.02
"""Part by which polygons through a few points of each arc may differ from the area they show."""


@dataclass(frozen=True, eq=False)
class Loop:
    """A loop with the component on its left.

    Attributes
    ----------
    points : ndarray, shape (m, 2)
        In the file's units, unrolled; the first is not repeated.
    winding : ndarray of int, shape (2,)
        How often it goes round each joint.
    """

    points: Floats
    winding: NDArray[np.int64]


def turn_of(degrees: bool) -> float:
    """Return a full turn in the file's unit, as a decimal that is not less than the exact turn."""
    return 360.0 if degrees else math.ceil(2e12 * math.pi) / 1e12


def cut_open(
    loops: Sequence[Loop], turns: Sequence[float | None], cut: Floats, area: float
) -> list[Polygon]:
    """Cut a component open along the values `cut` of the joints that it goes round.

    Parameters
    ----------
    loops : sequence of Loop
    turns : sequence of two (float or None)
        A full turn of each joint in the file's units; None where it does not turn all the way.
    cut : ndarray, shape (2,)
        Values at which to cut, in the file's units.
    area : float
        Area of the component, in the file's units, which decides on which turn its loops fit
        together.

    Raises
    ------
    ValueError
        If the loops bound no component of this area.
    """
    around = [loop for loop in loops if loop.winding.any()]
    rings = _copies([loop.points for loop in loops if not loop.winding.any()], turns)
    curves: list[Floats] = []
    low, high = np.full(2, -FAR), np.full(2, FAR)
    axes = [j for j, turn in enumerate(turns) if turn]
    if around:
        axes = [0 if around[0].winding[0] else 1]
        holes = -sum(polygon.area(loop.points) for loop in loops if not loop.winding.any())
        curves = _facing(around, axes[0], turns, float(cut[axes[0]]), area + holes)
        rings = [ring for ring in rings if _is_between(ring[0], curves, axes[0])]
        lengths = np.array([(turn or 0.0) for turn in turns]) * abs(around[0].winding)
    else:
        lengths = np.array([turn or 0.0 for turn in turns])
    for j in axes:
        low[j], high[j] = cut[j], cut[j] + lengths[j]
    return _polygons(*_within(curves, rings, axes, low, high), low, high)


def _copies(holes: Sequence[Floats], turns: Sequence[float | None]) -> list[Floats]:
    """Return the holes on all turns around the cut."""
    ranges = [range(-PERIODS, PERIODS + 1) if turn else range(1) for turn in turns]
    steps = [np.array(k) * [turn or 0.0 for turn in turns] for k in product(*ranges)]
    return [hole + step for hole in holes for step in steps]


def _facing(
    around: Sequence[Loop], axis: int, turns: Sequence[float | None], cut: float, area: float
) -> list[Floats]:
    """Return the two curves that bound a component which goes round a joint, over several turns.

    The second curve is shifted by full turns of the other joint so that the area between is right.
    """
    if len(around) != 2:
        raise ValueError("the home component goes round a joint in a way that no polygon shows")
    curves = []
    for loop in around:
        period = loop.winding * np.array([turn or 0.0 for turn in turns])
        steps = range(-PERIODS, PERIODS + 1)
        curves.append(np.concatenate([loop.points + k * period for k in steps]))
    length = (turns[axis] or 0.0) * abs(int(around[0].winding[axis]))
    shown = sum(_area_beside(curve, axis, cut, cut + length) for curve in curves)
    other = turns[1 - axis] or 0.0
    sense = int(np.sign(around[1].winding[axis])) * (1 if axis == 1 else -1)
    off = {k: abs(shown + sense * k * other * length - area) for k in range(-SHIFTS, SHIFTS + 1)}
    best = min(off, key=lambda k: (off[k], abs(k)))
    if off[best] > SAME_AREA * area:
        raise ValueError("the home component goes round a joint in a way that no polygon shows")
    curves[1][:, 1 - axis] += best * other
    return curves


def _area_beside(curve: Floats, axis: int, low: float, high: float) -> float:
    """Return the integral of the other joint along a curve between two values of a joint.

    The sign is that of an area on the left of the curve.
    """
    x, y = curve[:, axis], curve[:, 1 - axis]
    a, b = x[:-1], x[1:]
    step = np.where(b == a, 1.0, b - a)
    u, v = (np.clip(ends, low, high) for ends in (a, b))
    slope = np.diff(y) / step
    middle = y[:-1] + slope * ((u + v) / 2 - a)
    whole = float(((v - u) * middle).sum())
    return whole if axis == 1 else -whole


def _is_between(place: Floats, curves: Sequence[Floats], axis: int) -> bool:
    """Tell whether a place lies between two curves that go round a joint."""
    below = []
    for curve in curves:
        x, y = curve[:, axis] - place[axis], curve[:, 1 - axis] - place[1 - axis]
        across = (x[:-1] <= 0) != (x[1:] <= 0)
        a, b, c, d = (each[across] for each in (x[:-1], x[1:], y[:-1], y[1:]))
        below.append(int((c - a * (d - c) / (b - a) < 0).sum()) % 2)
    return sum(below) == 1


def _within(
    curves: Sequence[Floats],
    rings: Sequence[Floats],
    axes: Sequence[int],
    low: Floats,
    high: Floats,
) -> tuple[list[Floats], list[Floats]]:
    """Return the parts of curves and rings in a window: chains from edge to edge, rings."""
    chains, whole = list(curves), list(rings)
    for axis in axes:
        for value, sign in ((low[axis], 1.0), (high[axis], -1.0)):
            kept: list[Floats] = []
            for chain in chains:
                kept += _inside(chain, axis, value, sign)
            left: list[Floats] = []
            for ring in whole:
                inside = sign * (ring[:, axis] - value) >= 0
                if inside.all():
                    left.append(ring)
                elif inside.any():
                    start = int(np.flatnonzero(~inside)[0])
                    opened = np.concatenate([ring[start:], ring[: start + 1]])
                    kept += _inside(opened, axis, value, sign)
            chains, whole = kept, left
    return chains, whole


def _inside(chain: Floats, axis: int, value: float, sign: float) -> list[Floats]:
    """Return the pieces of a chain on one side of a line, each cut off on the line itself."""
    inside = sign * (chain[:, axis] - value) >= 0
    change = np.flatnonzero(inside[1:] != inside[:-1])
    a, b = chain[change], chain[change + 1]
    part = (value - a[:, axis]) / (b[:, axis] - a[:, axis])
    cuts = a + part[:, None] * (b - a)
    cuts[:, axis] = value
    ends = [0, *(change + 1).tolist(), len(chain)]
    found = []
    for k, (first, last) in enumerate(pairwise(ends)):
        if inside[first]:
            before, after = cuts[k - 1 : k] if k else cuts[:0], cuts[k : k + 1]
            found.append(np.concatenate([before, chain[first:last], after]))
    return [piece for piece in found if np.ptp(piece, axis=0).max() > ON_THE_CUT]


def _polygons(
    chains: Sequence[Floats], rings: Sequence[Floats], low: Floats, high: Floats
) -> list[Polygon]:
    """Join chains along the window's edge to outlines, and give each outline its holes."""
    corners = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    starts = np.array([_along(chain[0], low, high) for chain in chains])
    left, outlines = set(range(len(chains))), list[Floats]()
    while left:
        first = k = min(left)
        parts = []
        while k in left:
            left.remove(k)
            chain, end = chains[k], _along(chains[k][-1], low, high)
            k = int(np.argmin((starts - end) % 4))
            on = end + float((starts[k] - end) % 4)
            passed = [corners[c % 4] for c in range(math.floor(end) + 1, math.ceil(on))]
            parts += [chain, *(corner[None] for corner in passed)]
        if k != first:
            raise ValueError("the home component goes round a joint in a way that no polygon shows")
        outlines.append(np.concatenate(parts))
    if not chains:
        outlines = [corners]
    ends = list(zip(low.tolist(), high.tolist(), strict=True))
    large = [ring for ring in map(_tidy, outlines) if polygon.area(ring) > ON_THE_CUT]
    holes = {k: [h for h in rings if polygon.contains(ring, h[0])] for k, ring in enumerate(large)}
    return [[_snapped(each, ends) for each in (ring, *holes[k])] for k, ring in enumerate(large)]


def _along(place: Floats, low: Floats, high: Floats) -> float:
    """Return how far round the window's edge a place is, from its low corner on: 0 to 4."""
    x, y = (place - low) / (high - low)
    if place[1] == low[1]:
        return float(x)
    if place[0] == high[0]:
        return float(1 + y)
    return float(3 - x) if place[1] == high[1] else float(4 - y)


def _tidy(ring: Floats) -> Floats:
    """Drop corners that repeat the corner before."""
    apart = np.abs(ring - np.roll(ring, 1, axis=0)).max(axis=1) > ON_THE_CUT / 1000
    return np.asarray(ring[apart])


def _snapped(ring: Floats, ends: Sequence[tuple[float, float]]) -> Floats:
    ring = ring.copy()
    for j, end in product(range(2), (0, 1)):
        value = ends[j][end]
        ring[np.abs(ring[:, j] - value) < ON_THE_CUT, j] = value
    return ring


# --- triangles that fill a polygon ----------------------------------------------------------------

Corner = tuple[Fraction, Fraction]
Triangle = tuple[int, int, int]


class CrossesItself(ValueError):
    """Error: loops cross themselves or each other, or do not have the inside on their left."""


def triangulate(loops: Sequence[Sequence[Corner]]) -> list[Triangle]:
    """Fill a polygon, convex or not, with or without holes, with triangles of its own corners.

    Parameters
    ----------
    loops : sequence of sequence of (Fraction, Fraction)
        Corners with the inside on the left: the outline anticlockwise, holes clockwise.

    Returns
    -------
    list of (int, int, int)
        Indices into all corners, loop after loop; each triangle anticlockwise.

    Raises
    ------
    CrossesItself
        A `ValueError`.

    Notes
    -----
    Decimals times a power of ten are whole numbers, and these are triangulated exactly.
    """
    if min(map(len, loops)) < 3:
        raise ValueError("a loop of a polygon has 3 corners or more")
    places = iter(in_whole_numbers([place for loop in loops for place in loop]))
    try:
        return triangulated([[next(places) for _ in loop] for loop in loops])
    except ValueError as error:
        why = "the polygon crosses itself, or its inside is not on the left"
        raise CrossesItself(f"{why}: {error}") from None
