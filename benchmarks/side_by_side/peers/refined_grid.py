"""Marching squares on cells that are halved only where the boundary can be.

A cell is halved if its least margin, with the arm's reach as its greatest slope, may be zero: no
part of the boundary is lost that way. Of the last ones, too many for that, a sign must change, or
the margins at the corners must be small beside how they differ.
Cells beyond the ends of the joints have negative margins: contours close along the ends.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from planar import Floats, arm
from quality import packed
from serve import Refused, Timed, serve, timed

Integers = NDArray[np.int64]

FIRST = 64
"""Cells a joint to begin with."""
SURE = 2e-3
"""Width (rad) to which cells are halved by the slope; below, by the margins at their corners."""
STEP = 2.0
"""Cells are this often as wide as the accuracy that is asked for: corners are cut by a cell."""
MOST = 2e6
"""Cells at the end, at most: with more it takes over 20 s."""
CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])


def region(scene: str, accuracy: float) -> Timed:
    """Answer with polygons of the region, its boundary within a cell."""
    cells = Cells(scene)

    def work() -> list[Floats]:
        widest = max(np.ptp(cells.form.ranges, axis=1)) / FIRST
        rounds = max(0, math.ceil(math.log2(widest / (STEP * accuracy))))
        for left in reversed(range(rounds)):
            cells.halve()
            if max(cells.width) <= SURE and len(cells.at) * 2.0**left > MOST:
                raise Refused(f"{len(cells.at) * 2.0**left:.1g} cells are more than {MOST:.0e}")
        return cells.contours()

    seconds, processor, rings = timed(work)
    return seconds, processor, {"margins": cells.asked, "rings": packed(_nested(rings))}


class Cells:
    """Cells of one size that the boundary may pass, by the numbers of column and row."""

    def __init__(self, scene: str) -> None:
        self.form, self.count, self.asked = arm(scene), FIRST, 0
        every = np.arange(-1, FIRST + 1)
        self.at: Integers = np.stack(np.meshgrid(every, every), axis=-1).reshape(-1, 2)
        self._drop()

    @property
    def width(self) -> Floats:
        """Width and height of a cell, rad."""
        return np.asarray(np.ptp(self.form.ranges, axis=1) / self.count)

    def halve(self) -> None:
        """Halve all cells both ways, and keep those that the boundary may pass."""
        self.at = (2 * self.at[:, None] + CORNERS).reshape(-1, 2)
        self.count *= 2
        inside = (self.at >= -1) & (self.at <= self.count)
        self.at = self.at[inside.all(axis=1)]
        self._drop()

    def _drop(self) -> None:
        if max(self.width) > SURE:
            slope = float(np.dot(self.form.slopes, self.width)) / 2
            middle = self._margins(self.at + 0.5)
            beyond = ((self.at < 0) | (self.at >= self.count)).any(axis=1)
            kept = (np.abs(middle) <= slope) | beyond & (middle > 0)
        else:
            number, margins = self._corner_margins()
            low, high = margins[number].min(axis=1), margins[number].max(axis=1)
            kept = np.maximum(low, -high) <= (high - low) / 2
        self.at = self.at[kept]

    def _margins(self, place: Floats) -> Floats:
        """Return margins at places counted in cells; those beyond the ends as on them."""
        self.asked += len(place)
        return self.form.of(self._angles(place).T.copy())

    def _angles(self, place: Floats) -> Floats:
        low = self.form.ranges[:, 0]
        return np.asarray(low + np.clip(place, 0, self.count) * self.width)

    def _corner_margins(self) -> tuple[Integers, Floats]:
        """Return the numbers of each cell's corners, and margins by number."""
        corners = (self.at[:, None] + CORNERS).reshape(-1, 2)
        keys = (corners[:, 0] + 1) * (self.count + 3) + corners[:, 1] + 1
        _, first, number = np.unique(keys, return_index=True, return_inverse=True)
        place = corners[first]
        margins = self._margins(place.astype(float))
        beyond = ((place < 0) | (place > self.count)).any(axis=1)
        margins[beyond] = -1.0
        self._places = place
        return number.reshape(-1, 4), margins

    def contours(self) -> list[Floats]:
        """Return closed contours, what is feasible on their left."""
        number, margins = self._corner_margins()
        signs = margins[number] >= 0
        ends = np.stack([number, np.roll(number, -1, axis=1)], axis=-1)  # of a cell's four edges
        into = ~signs & np.roll(signs, -1, axis=1)
        out = signs & ~np.roll(signs, -1, axis=1)
        starts, stops = _segments(out, into)
        edges = np.sort(ends[starts], axis=1), np.sort(ends[stops], axis=1)
        keys = [edge[:, 0] * len(margins) + edge[:, 1] for edge in edges]
        unique, number_of = np.unique(np.concatenate(keys), return_inverse=True)
        follows = np.arange(len(unique))
        follows[number_of[: len(keys[0])]] = number_of[len(keys[0]) :]
        one, other = np.divmod(unique, len(margins))
        part = (margins[one] / (margins[one] - margins[other]))[:, None]
        places = [self._angles(self._places[end]) for end in (one, other)]
        crossing = places[0] + part * (places[1] - places[0])
        return [crossing[loop] for loop in _loops(follows.tolist())]


def _segments(out: NDArray[np.bool_], into: NDArray[np.bool_]) -> tuple[Any, Any]:
    """Return cell and edge where each contour enters a cell, and where it leaves it.

    Of the edges anticlockwise, one on which a margin turns negative (`out`) starts a piece with the
    feasible corners on its left; it ends on the nearest before it that turns feasible (`into`).
    """
    cell, edge = np.nonzero(out)
    back = into[cell[:, None], (edge[:, None] - np.arange(1, 4)) % 4]
    return (cell, edge), (cell, (edge - 1 - back.argmax(axis=1)) % 4)


def _loops(follows: list[int]) -> list[list[int]]:
    """Return the closed ways through numbers that follow each other."""
    seen, loops = bytearray(len(follows)), []
    for first in range(len(follows)):
        loop, k = [], first
        while not seen[k]:
            seen[k] = 1
            loop.append(k)
            k = follows[k]
        if len(loop) > 2:
            loops.append(loop)
    return loops


def _nested(rings: list[Floats]) -> list[list[Floats]]:
    """Put clockwise rings, holes, behind the smallest ring that holds them."""
    import shapely

    shapes = [shapely.Polygon(ring) for ring in rings]
    outer = [i for i, shape in enumerate(shapes) if shape.exterior.is_ccw and shape.area > 0]
    parts = {i: [rings[i]] for i in outer}
    for i, shape in enumerate(shapes):
        if not shape.exterior.is_ccw and shape.area > 0:
            corner = shapely.Point(rings[i][0])
            around = [j for j in outer if shapes[j].covers(corner)]
            parts[min(around, key=lambda j: shapes[j].area)].append(rings[i])
    return list(parts.values())


if __name__ == "__main__":
    serve(
        "refined grid + marching squares",
        {"shapely": "shapely", "numpy": "numpy"},
        {"region": region},
    )
