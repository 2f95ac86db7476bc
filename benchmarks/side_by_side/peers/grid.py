"""Grid of margins and marching squares: contourpy's filled contours above zero.

As its documentation has it: one `contour_generator(x, y, z)`, then `filled(lower, upper)`; the
default algorithm "serial", polygons with their holes as `FillType.OuterOffset`
(https://contourpy.readthedocs.io/en/v1.3.3/user_guide/name.html and ``fill_type.html``).
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
from planar import arm
from quality import packed
from serve import Refused, Timed, serve, timed

STEP = 2.0
"""Cells are this often as wide as the accuracy that is asked for: corners are cut by a cell."""
MOST = 4e7
"""Margins, at most: with more, arrays and contours no longer fit the memory."""


def region(scene: str, accuracy: float) -> Timed:
    """Answer with polygons of the region, its boundary within a cell."""
    from contourpy import FillType, contour_generator

    form = arm(scene)
    counts = [math.ceil(np.ptp(ends) / (STEP * accuracy)) for ends in form.ranges]
    if math.prod(counts) > MOST:
        raise Refused(f"{math.prod(counts):.2g} margins are more than {MOST:.0e}")

    def work() -> Any:
        axes = (np.linspace(*ends, n + 1) for ends, n in zip(form.ranges, counts, strict=True))
        x, y = axes
        margins = form.over_grid(x, y)
        contours = contour_generator(y, x, margins, fill_type=FillType.OuterOffset)
        return contours.filled(0.0, math.inf)

    seconds, processor, (points, offsets) = timed(work)
    rings = [
        [corners[a : b - 1, ::-1] for a, b in pairwise(cuts)]
        for corners, cuts in zip(points, offsets, strict=True)
    ]
    return seconds, processor, {"margins": math.prod(counts), "rings": packed(rings)}


if __name__ == "__main__":
    needs = {"contourpy": "contourpy", "numpy": "numpy"}
    serve("grid + marching squares", needs, {"region": region})
