"""How are the triangles of a mesh covered by few balls? Proved, triangle by triangle.

A ball about a place of the solid, at least a depth d below its surface, sticks out of the solid by
its radius less d at most. So every place has a largest ball for an excess. Balls are chosen
greedily from those of a grid and of the surface itself to hold samples of the triangles; what
halving then finds uncovered is asked for too, until nothing is.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from qbound.extras import require
from qbound.geometry.covering import Cover, few, uncovered, within
from qbound.geometry.simplices import edges, halved
from qbound.tolerances import OUTWARD

Floats = NDArray[np.float64]

MOST_SAMPLES = 300_000
"""Samples of the triangles, about, from which depths are known."""

MOST_DEMANDS = 3_000
"""Samples, about, that balls are chosen to hold at first."""

MOST_PLACES = 6_000
"""Centres inside, about, that are tried."""

NEARLY = 0.02
"""Part of a distance by which the search for the nearest sample may err: exact ones are slow on the
axis of a tube, from which all samples are equally far."""

ROUNDS = 12
"""So often balls are chosen again, to hold what was found uncovered too."""

MOST_ADDED = 400
"""Balls that are added in the end, one by one, for what is still uncovered."""


def mesh_cover(triangles: Floats, closed: bool, excess: float) -> Cover:
    """Cover the triangles of a mesh: all of them, but not what they enclose.

    A body meets them before it lies in what they enclose: a motion that starts clear of the solid
    and stays clear of its surface is clear of the solid.

    Parameters
    ----------
    triangles : ndarray, shape (N, 3, 3)
    closed : bool
        Whether they are the whole surface of a solid. If not, the excess is that beyond their
        convex hull.
    excess : float
        Above 0.

    Raises
    ------
    ValueError
        If the mesh is too large for the excess.
    ModuleNotFoundError
        If there is no SciPy; it comes with ``qbound[arms]``.
    """
    require("scipy", "covering a mesh")
    corners = triangles.reshape(-1, 3)
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    moved = triangles - middle
    size = float(np.abs(triangles).max()) + float(np.abs(moved).max())
    allowed = excess - 8 * OUTWARD * size
    if allowed <= 0:
        raise ValueError(f"an excess of {excess:g} is rounding beside a mesh of size {size:g}")
    surface, spread = _samples(moved, allowed)
    centres, depths = _places(moved, closed, surface, spread, allowed)
    centres, radii = _chosen(moved, centres, depths + allowed, surface, allowed)
    return Cover(centres + middle, radii + 4 * OUTWARD * size, excess)


def _samples(triangles: Floats, excess: float) -> tuple[Floats, float]:
    """Return places of the triangles, and a length within which of one all others are."""
    sides = edges(triangles)
    area = float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum()) / 2
    longest = max(excess / 8, math.sqrt(2 * area / MOST_SAMPLES))
    if longest > excess / 2 or np.abs(sides).max() > MOST_SAMPLES * longest:
        raise ValueError(f"the mesh is too large for an excess of {excess:g}; allow more")
    cells, done = triangles, []
    while len(cells):
        lengths = np.linalg.norm(edges(cells), axis=-1)
        short = lengths.max(axis=1) <= longest
        done.append(cells[short].mean(axis=1))
        cells = halved(cells[~short], lengths[~short].argmax(axis=1))
    return np.concatenate(done), longest * 2 / 3  # two thirds of a median, which is no longer


def _thinned(places: Floats, most: int, size: float) -> Floats:
    """Keep one place of each cell of a grid as fine as `most` allows, but no finer than `size`."""
    while True:
        cells = np.floor(places / size).astype(np.int64)
        cells -= cells.min(axis=0)
        number = np.ravel_multi_index(tuple(cells.T), tuple(cells.max(axis=0) + 1))
        _, first = np.unique(number, return_index=True)
        if len(first) <= most:
            return np.asarray(places[np.sort(first)])
        size *= 1.5


def _places(
    triangles: Floats, closed: bool, surface: Floats, spread: float, excess: float
) -> tuple[Floats, Floats]:
    """Return centres, of a grid inside and of the surface, and how deep each lies at least."""
    on_it = _thinned(surface, MOST_PLACES // 4, excess / 2)
    inner = _inside if closed else _inside_hull
    centres, depths = inner(triangles, surface, spread, excess)
    return np.vstack([centres, on_it]), np.append(depths, np.zeros(len(on_it)))


def _grid(triangles: Floats, excess: float) -> tuple[Floats, float]:
    """Return a grid over the bounding box and beyond it, shape (i, j, k, 3), and its step."""
    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    volume = float(np.prod(np.maximum(high - low, excess)))
    step = max(excess / 3, (volume / MOST_PLACES) ** (1 / 3))
    axes = [np.arange(a - 1.5 * step, b + 2 * step, step) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1), step


def _inside(
    triangles: Floats, surface: Floats, spread: float, excess: float
) -> tuple[Floats, Floats]:
    """Return places inside a closed mesh and a lower bound of how deep each is.

    Neighbours on the grid that are both deeper than half a step are on one side of the surface:
    one place of such a group tells for all of it.
    """
    from scipy.ndimage import label
    from scipy.spatial import cKDTree

    grid, step = _grid(triangles, excess)
    near = np.asarray(cKDTree(surface).query(grid, eps=NEARLY)[0], dtype=float)
    depths = near / (1 + NEARLY) * (1 - OUTWARD) - spread
    groups, count = label(depths > step / 2)
    _, first = np.unique(groups, return_index=True)
    first = first[-count:] if count else first[:0]
    turns = winding_numbers(triangles, grid.reshape(-1, 3)[first])
    inside = np.isin(groups, 1 + np.flatnonzero(turns))
    return grid[inside], depths[inside]


def _inside_hull(
    triangles: Floats, surface: Floats, spread: float, excess: float
) -> tuple[Floats, Floats]:
    """Return places inside the convex hull of a mesh, and how deep in it each is."""
    from scipy.spatial import ConvexHull, QhullError

    grid, _ = _grid(triangles, excess)
    try:
        hull = ConvexHull(triangles.reshape(-1, 3)).equations
    except QhullError:  # a flat one has no inside
        return np.zeros((0, 3)), np.zeros(0)
    places = grid.reshape(-1, 3)
    depths = -(places @ hull[:, :3].T + hull[:, 3]).max(axis=1) - spread
    return places[depths > 0], depths[depths > 0]


def _chosen(
    triangles: Floats, centres: Floats, radii: Floats, surface: Floats, excess: float
) -> tuple[Floats, Floats]:
    """Choose balls until all triangles are proved to be covered.

    What is found uncovered is asked for in the next round; what is still uncovered after the last
    gets balls of its own, as large as the excess.
    """
    demands = _thinned(surface, MOST_DEMANDS, excess / 4)
    held = within(demands, centres, radii - excess / 50)
    for _ in range(ROUNDS):
        chosen = few(held.T)
        left = uncovered(triangles, centres[chosen], radii[chosen])
        if not len(left):
            return centres[chosen], radii[chosen]
        missed = _thinned(left.reshape(-1, 3), MOST_DEMANDS, excess / 20)
        held = np.vstack([held, within(missed, centres, radii - excess / 50)])
    centres, radii = centres[chosen], radii[chosen]
    for _ in range(MOST_ADDED):
        centres = np.vstack([centres, left[0].mean(axis=0)])
        radii = np.append(radii, excess)
        left = uncovered(triangles, centres, radii)
        if not len(left):
            return centres, radii
    raise ValueError(f"the mesh is not covered to an excess of {excess:g}; allow more")


def winding_numbers(triangles: Floats, places: Floats) -> NDArray[np.int64]:
    r"""Return how often a closed surface goes round each place: 0 outside of the solid.

    The sum of the solid angles of its triangles over :math:`4\pi` (van Oosterom and Strackee).

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> tetrahedron = corners[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]
    >>> winding_numbers(tetrahedron, np.array([[0.1, 0.1, 0.1], [1.0, 1.0, 1.0]])).tolist()
    [1, 0]
    """
    total = np.zeros(len(places))
    step = max(1, 2_000_000 // max(1, len(places)))
    for k in range(0, len(triangles), step):
        a, b, c = (
            corner - places[:, None] for corner in np.swapaxes(triangles[k : k + step], 0, 1)
        )
        x, y, z = (np.linalg.norm(side, axis=-1) for side in (a, b, c))
        volume = np.einsum("...i,...i", a, np.cross(b, c))
        dots = [np.einsum("...i,...i", one, other) for one, other in ((a, b), (b, c), (c, a))]
        below = x * y * z + dots[0] * z + dots[1] * x + dots[2] * y
        total += np.arctan2(volume, below).sum(axis=1)
    return np.asarray(np.rint(total / (2 * math.pi)), dtype=np.int64)
