"""Which balls lie in a solid and touch its surface? Those that lie in no other such ball.

A ball about a place at depth d may be as large as d and the excess allowed. If the surface is
nearest to it at x, moving away from x as long as x stays nearest gives a ball that holds it. So
the balls worth trying stand where no x is nearest alone: on the medial axis. Each is found from a
place of the surface, inward along the normal, its ball shrunk until the surface does not enter it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from qbound.geometry.mesh_solids import Convex, winding_numbers
from qbound.tolerances import OUTWARD

Floats = NDArray[np.float64]

SHRINKINGS = 12
"""Times that a ball is shrunk at most."""

NEARLY = 0.02
"""Part of a distance by which the search for the nearest sample may err: exact ones are slow on the
axis of a tube, from which all samples are equally far."""


def convex_balls(solid: Convex, starts: Floats, normals: Floats) -> tuple[Floats, Floats]:
    r"""Return centres and depths of balls in a convex solid that touch it at places given.

    The ball of radius r about :math:`p - r n` is behind the plane (m, o) while
    :math:`r (1 - m \cdot n) \le -(m \cdot p + o)`.
    """
    radii = np.full(len(starts), np.inf)
    for plane in solid.planes:
        room = np.maximum(-(starts @ plane[:3] + plane[3]), 0.0)
        turned = 1 - normals @ plane[:3]
        away = turned > 1e-9
        radii[away] = np.minimum(radii[away], room[away] / turned[away])
    kept = np.isfinite(radii)
    centres = starts[kept] - radii[kept, None] * normals[kept]
    depths = solid.depths(centres)
    return centres[depths > 0], depths[depths > 0]


def solid_balls(
    triangles: Floats, samples: Floats, spread: float, starts: Floats, normals: Floats
) -> tuple[Floats, Floats]:
    """Return centres and depths, lower bounds, of balls in the solid that a mesh encloses.

    Parameters
    ----------
    samples : ndarray, shape (n, 3)
        Places of the surface; every place of it is within `spread` of one.
    starts, normals : ndarray, shape (m, 3)
        Where balls touch the surface, and its outward normals there.
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(samples)
    radii = np.full(len(starts), float(np.ptp(samples, axis=0).max()))
    open_ones = np.arange(len(starts))
    for _ in range(SHRINKINGS):
        centres = starts[open_ones] - radii[open_ones, None] * normals[open_ones]
        near, index = tree.query(centres, eps=NEARLY)
        enters = near < radii[open_ones] - spread
        open_ones, index = open_ones[enters], index[enters]
        if not len(open_ones):
            break
        apart = starts[open_ones] - samples[index]
        along = 2 * np.einsum("ni,ni->n", apart, normals[open_ones])
        smaller = np.einsum("ni,ni->n", apart, apart) / np.where(along > 0, along, np.inf)
        radii[open_ones] = np.minimum(smaller, 0.999 * radii[open_ones])
    centres = starts - radii[:, None] * normals
    near = np.asarray(tree.query(centres, eps=NEARLY)[0], dtype=float)
    depths = near / (1 + NEARLY) * (1 - OUTWARD) - spread
    kept = depths > 0
    centres, depths = centres[kept], depths[kept]
    inside = _inside(triangles, centres, depths)
    return centres[inside], depths[inside]


def _inside(triangles: Floats, centres: Floats, depths: Floats) -> NDArray[np.bool_]:
    """Tell which places a closed surface goes round, each of which is so far from it at least.

    Places whose balls meet are on one side of the surface: one of them tells for all.
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
    return np.asarray((winding_numbers(triangles, centres[best]) != 0)[group])


def _deepest(group: NDArray[np.int32], depths: Floats, count: int) -> NDArray[np.int64]:
    """Return the deepest place of each group."""
    order = np.lexsort((depths, group))
    last = np.searchsorted(group[order], np.arange(count), side="right") - 1
    return np.asarray(order[last])
