"""Random configurations for an alpha shape: how many, which are feasible, how large their gaps."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

import numpy as np
from closed_form import PlanarArm
from planar import Floats

SEED = 15
PER_AREA = 1.0
"""Configurations in a square with the accuracy as its side."""


def count_for(form: PlanarArm, accuracy: float) -> int:
    """Return how many configurations come as near to each other as the accuracy, on average."""
    return math.ceil(PER_AREA * math.prod(np.ptp(form.ranges, axis=1)) / accuracy**2)


def largest_gap(form: PlanarArm, count: int) -> float:
    """Return a radius (rad) that hardly any disc without a configuration has.

    Of n in an area A a disc of area a has none with probability exp(-n a / A): the largest without
    has some a = A log(n) / n. With a half more of it a hole inside the shape is rare.
    """
    whole = math.prod(np.ptp(form.ranges, axis=1))
    return math.sqrt(1.5 * whole * math.log(count) / (math.pi * count))


def feasible(form: PlanarArm, count: int, gap: float) -> Floats:
    """Draw configurations and return those that are feasible, shape (n, 2).

    Those beside the cut of a joint that turns all the way round are repeated beyond it: else the
    shape would end before the cut.
    """
    low, high = form.ranges.T
    drawn = np.random.default_rng(SEED).uniform(low, high, (count, 2))
    kept = drawn[form.of(np.ascontiguousarray(drawn.T)) >= 0]
    shifts = product(*((0.0, -2 * np.pi, 2 * np.pi) if t else (0.0,) for t in form.turning))
    copies = (kept + np.array(shift) for shift in shifts)
    beside = 2 * gap
    return np.concatenate(
        [c[((c > low - beside) & (c < high + beside)).all(axis=1)] for c in copies]
    )


def polygon_rings(shape: Any) -> list[list[Floats]]:
    """Return the rings of a shapely polygon or several."""
    import shapely

    return [
        [shapely.get_coordinates(ring)[:-1] for ring in (part.exterior, *part.interiors)]
        for part in shapely.get_parts(shape)
        if part.geom_type == "Polygon"
    ]
