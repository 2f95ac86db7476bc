"""What an area costs by each method, counted in evaluations: no clock is read.

The area is that of the region by the windows of Table 6, known exactly. One evaluation is one
configuration judged (sampling, grid) or one solution of Theorem 2 (closed form).
"""

from functools import cache

import numpy as np

from lizarraga2025.evidence.arms import floor, robot
from lizarraga2025.evidence.joint_region import by_windows, share_of_square
from qbound import polygon
from qbound.arrays import Floats

CLOSED_FORM_START = 12
"""Solutions of Theorem 2 before any arc: 8 components of point pairs, 4 sides against B7."""


def samples_needed(relative: float) -> float:
    """Return how many random configurations give the area with this relative standard error."""
    p = share_of_square()
    return float((1 - p) / p / relative**2)


@cache
def contour_of_grid(n: int, *, margins: bool = False) -> tuple[Floats, ...]:
    """Return the outlines that marching squares draws on an n by n grid over one turn, rad.

    The grid carries what a draw knows of a configuration, whether it is feasible; or the least
    margin of any side of the box and of the tool's limit, which are the paper's own functions.
    """
    from contourpy import contour_generator

    lattice = np.linspace(-np.pi, np.pi, n)
    q = np.stack(np.meshgrid(lattice, lattice, indexing="ij"), axis=-1)
    if margins:
        box = by_windows().box
        sides = np.minimum(q - box.lower, box.upper - q).min(axis=-1)
        z = np.minimum(sides, floor()(q) / np.linalg.norm(robot().joints[1].origin))
    else:
        z = by_windows().contains(q) - 0.5
    step = lattice[1] - lattice[0]
    rings = contour_generator(z=z).lines(0.0)  # each place as column and row
    return tuple(np.asarray(ring)[:, ::-1] * step - np.pi for ring in rings)


def contour_is_closed(n: int) -> bool:
    """Tell whether the outlines on an n by n grid are one closed curve."""
    rings = contour_of_grid(n)
    return len(rings) == 1 and np.allclose(rings[0][0], rings[0][-1])


def contour_error(n: int, *, margins: bool = False) -> float:
    """Return the relative error of the area inside the contour of an n by n grid."""
    (ring,) = contour_of_grid(n, margins=margins)
    return abs(abs(polygon.area(ring[:-1])) / by_windows().area - 1)


def closed_form_evaluations(relative: float) -> int:
    """Return how many solutions of Theorem 2 give the area with less than this relative error."""
    nodes = next(n for n in range(1, 99) if closed_form_error(n) < relative)
    return CLOSED_FORM_START + 2 * nodes


def closed_form_error(nodes: int) -> float:
    """Return the relative error of the area with so many Gauss nodes on each of the two arcs."""
    return abs(by_windows().area_by_nodes(nodes) / by_windows().area - 1)
