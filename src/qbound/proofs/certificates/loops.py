"""Loops of a polygon, filled with triangles, or cut open where they go round a joint (by shapely).

Joint values of a certificate are numbers on the line. So a component that
goes all the way round a joint is cut along one value of
the joint that it goes round, and its polygons reach from there to the same value a turn later. In
the file's units a turn is 360 degrees exactly, or a decimal just above 2 pi.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.extras import require

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
    """Return a full turn in the file's unit, as a decimal that is not less."""
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
        Of the component, in the file's units: it tells on which turn its loops belong together.

    Raises
    ------
    ValueError
        If the loops bound no component of this area.
    """
    require("shapely")
    import shapely

    around = [loop for loop in loops if loop.winding.any()]
    holes = _copies([loop.points for loop in loops if not loop.winding.any()], turns)
    if not around:
        ends = [(c, c + (turn or 0)) for c, turn in zip(cut, turns, strict=True)]
        window = shapely.box(ends[0][0], ends[1][0], ends[0][1], ends[1][1])
        return _polygons(window.difference(holes), ends)
    axis = 0 if around[0].winding[0] else 1
    lower, upper = sorted(around, key=lambda loop: -loop.winding[axis])
    length = (turns[axis] or 0.0) * int(lower.winding[axis])
    ends = [(-FAR, FAR), (-FAR, FAR)]
    ends[axis] = (float(cut[axis]), float(cut[axis]) + length)
    window = shapely.box(ends[0][0], ends[1][0], ends[0][1], ends[1][1])
    inside = _side(lower, axis, turns).intersection(window).difference(holes)
    shifts = {k * (turns[1 - axis] or 0.0) for k in range(-SHIFTS, SHIFTS + 1)}
    found = [inside.intersection(_side(upper, axis, turns, shift)) for shift in sorted(shifts)]
    best = min(found, key=lambda shape: abs(shape.area - area))
    if abs(best.area - area) > SAME_AREA * area:
        raise ValueError("the home component goes round a joint in a way that no polygon shows")
    return _polygons(best, ends)


def _side(loop: Loop, axis: int, turns: Sequence[float | None], shift: float = 0) -> Any:
    """Return what lies on the left of a loop that goes round, over several turns.

    The curve is cut where it is farthest back and farthest on, so that straight lines from there to
    a distant line on its left cross it nowhere.
    """
    import shapely

    sense = np.sign(loop.winding[axis])
    period = loop.winding * np.array([turn or 0.0 for turn in turns])
    curve = np.concatenate([loop.points + k * period for k in range(-PERIODS, PERIODS + 1)])
    curve[:, 1 - axis] += shift
    along = curve[:, axis] * sense
    curve = curve[along.argmin() : along.argmax() + 1]
    ends = curve[[-1, 0]].copy()
    ends[:, 1 - axis] = FAR * sense * (1 if axis == 0 else -1)
    return shapely.Polygon(np.concatenate([curve, ends]))


def _copies(holes: Sequence[Floats], turns: Sequence[float | None]) -> Any:
    """Return the holes on all turns around the cut."""
    import shapely

    ranges = [range(-PERIODS, PERIODS + 1) if turn else range(1) for turn in turns]
    steps = [np.array(k) * [turn or 0.0 for turn in turns] for k in product(*ranges)]
    return shapely.union_all([shapely.Polygon(hole + step) for hole in holes for step in steps])


def _polygons(shape: Any, ends: Sequence[tuple[float, float]]) -> list[Polygon]:
    """Return the polygons of a shape, what lies almost on the cut brought onto it."""
    import shapely

    parts = [part for part in shapely.get_parts(shape) if part.area > ON_THE_CUT]
    found = []
    for part in shapely.orient_polygons(parts):
        rings = [shapely.get_coordinates(ring)[:-1] for ring in (part.exterior, *part.interiors)]
        found.append([_snapped(ring, ends) for ring in rings])
    return found


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
    """Of loops that cross themselves or each other, or do not have the inside on their left."""


def triangulate(loops: Sequence[Sequence[Corner]]) -> list[Triangle]:
    """Fill a polygon, convex or not, with or without holes, by triangles of its own corners.

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
    Decimals times a power of ten are whole numbers, which doubles hold exactly up to ``2**53``,
    more than `statements.DIGITS` need. What longer decimals may spoil the checkers refuse.
    """
    require("shapely", "the proof of a polygon (its triangles)")
    import shapely

    if min(map(len, loops)) < 3:
        raise ValueError("a loop of a polygon has 3 corners or more")
    whole = math.lcm(*(x.denominator for loop in loops for place in loop for x in place))
    rings = [[(float(x * whole), float(y * whole)) for x, y in loop] for loop in loops]
    outline, *holes = sorted(rings, key=lambda ring: -shapely.Polygon(ring).area)
    polygon = shapely.Polygon(outline, holes)
    turned = [shapely.LinearRing(ring).is_ccw for ring in (outline, *holes)]
    if not polygon.is_valid or turned != [True, *(False for _ in holes)]:
        reason = shapely.is_valid_reason(polygon)
        why = "the polygon crosses itself, or its inside is not on the left"
        raise CrossesItself(f"{why}: {reason}")
    triangles = shapely.orient_polygons(shapely.constrained_delaunay_triangles(polygon))
    number = {place: k for k, place in enumerate(place for ring in rings for place in ring)}
    corners = [[number[place] for place in part.exterior.coords[:3]] for part in triangles.geoms]
    return [(a, b, c) for a, b, c in corners]
