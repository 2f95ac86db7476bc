"""Largest balls that lie in a solid, but for a given excess: the candidates for a cover.

A ball about a place at depth d may have the radius d plus the allowed excess. Let x be the place
of the surface nearest to the centre. If the centre moves away from x while x stays nearest, the new
ball contains the old one. So only centres with two or more nearest places matter: these form the
medial axis. The search starts at a place of the surface, goes inward along the normal, and shrinks
the ball until the surface does not enter it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from qbound.arrays import Floats
from qbound.geometry.covering import IN_CACHE
from qbound.geometry.mesh_solids import Convex, heights, winding_numbers
from qbound.geometry.surface_distance import SurfaceDistance, one_a_cell
from qbound.tolerances import OUTWARD

SHRINKINGS = 12
"""Times that a ball is shrunk at most."""

MOST_SOLID_ANGLES = 5_000_000
"""Triangles times places at most of which it is asked whether the surface goes round them."""


def convex_balls(solid: Convex, starts: Floats, normals: Floats) -> tuple[Floats, Floats]:
    r"""Return centres and depths of balls in a convex solid that touch it at places given.

    The ball of radius r about :math:`p - r n` is behind the plane (m, o) while
    :math:`r (1 - m \cdot n) \le -(m \cdot p + o)`.
    """
    radii = np.full(len(starts), np.inf)
    step = max(1, IN_CACHE // max(1, len(starts)))
    for k in range(0, len(solid.planes), step):
        planes = solid.planes[k : k + step]
        room = np.maximum(-heights(starts, planes), 0.0)
        turned = -heights(normals, planes * [1, 1, 1, 0] - [0, 0, 0, 1])
        room = np.where(turned > 1e-9, room / np.where(turned > 1e-9, turned, 1.0), np.inf)
        radii = np.minimum(radii, room.min(axis=1))
    kept = np.isfinite(radii)
    centres = starts[kept] - radii[kept, None] * normals[kept]
    depths = solid.depths(centres)
    return centres[depths > 0], depths[depths > 0]


def solid_balls(
    triangles: Floats, surface: SurfaceDistance, starts: Floats, normals: Floats, apart: float
) -> tuple[Floats, Floats]:
    """Return centres and depths, lower bounds, of balls in the solid that a mesh encloses.

    Parameters
    ----------
    starts, normals : ndarray, shape (m, 3)
        Where balls touch the surface, and its outward normals there.
    apart : float
        Of centres within about that of each other one is kept; length.
    """
    centres = starts - _shrunk(surface.rough(), starts, normals)[:, None] * normals
    centres = centres[one_a_cell(centres, len(centres), apart)[0]]
    depths = surface.depths(centres)
    kept = depths > 0
    centres, depths = centres[kept], depths[kept]
    inside = _inside(triangles, centres, depths)
    return centres[inside], depths[inside]


def _shrunk(surface: SurfaceDistance, starts: Floats, normals: Floats) -> Floats:
    """Return radii of balls that touch the surface at places given and that it hardly enters."""
    radii = np.full(len(starts), float(np.ptp(surface.samples, axis=0).max()))
    open_ones = np.arange(len(starts))
    for _ in range(SHRINKINGS):
        centres = starts[open_ones] - radii[open_ones, None] * normals[open_ones]
        index = surface.within(centres, radii[open_ones])
        open_ones, index = open_ones[index >= 0], index[index >= 0]
        if not len(open_ones):
            break
        apart = starts[open_ones] - surface.samples[index]
        along = 2 * np.einsum("ni,ni->n", apart, normals[open_ones])
        smaller = np.einsum("ni,ni->n", apart, apart) / np.where(along > 0, along, np.inf)
        radii[open_ones] = np.minimum(smaller, 0.999 * radii[open_ones])
    return radii


def _inside(triangles: Floats, centres: Floats, depths: Floats) -> NDArray[np.bool_]:
    """Tell which places a closed surface goes round, each of which is so far from it at least.

    Places whose balls meet are on one side of the surface: one of them tells for all. Of more such
    groups than may be asked the shallowest count as outside.
    """
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    if not len(centres):
        return np.zeros(0, dtype=bool)
    many = min(9, len(centres))
    apart, other = cKDTree(centres).query(centres, k=many)
    apart, other = apart.reshape(len(centres), -1), other.reshape(len(centres), -1)
    meet = apart < depths[:, None] + depths[other] - OUTWARD * np.abs(centres).max()
    one = np.broadcast_to(np.arange(len(centres))[:, None], other.shape)[meet]
    joined = coo_matrix((np.ones(len(one)), (one, other[meet])), shape=(len(centres),) * 2)
    count, group = connected_components(joined, directed=False)
    best = np.array([depths.argmax()]) if count == 1 else _deepest(group, depths, count)
    asked = np.argsort(-depths[best])[: max(1, MOST_SOLID_ANGLES // len(triangles))]
    inside = np.zeros(count, dtype=bool)
    inside[asked] = winding_numbers(triangles, centres[best[asked]]) != 0
    return np.asarray(inside[group])


def _deepest(group: NDArray[np.int32], depths: Floats, count: int) -> NDArray[np.int64]:
    """Return the deepest place of each group."""
    order = np.lexsort((depths, group))
    last = np.searchsorted(group[order], np.arange(count), side="right") - 1
    return np.asarray(order[last])
