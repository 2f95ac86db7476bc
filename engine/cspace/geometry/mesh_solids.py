"""The solid that a mesh encloses: whether it is convex or a box, and which places are inside.

A mesh that is nearly convex, or nearly a box, is treated as such. The distance by which it differs
is subtracted from every depth, so bounds of depths hold for the mesh itself.

`SurfaceDistance` gives lower bounds of the distance to a surface from samples of it.

`solid_balls` and `convex_balls` find largest balls in a solid, up to a given excess, for covers.

A ball about a place at depth d may have the radius d plus the allowed excess. Let x be the place
of the surface nearest to the centre. If the centre moves away from x while x stays nearest, the new
ball contains the old one. So only centres with two or more nearest places matter: these form the
medial axis. The search starts at a place of the surface, goes inward along the normal, and shrinks
the ball until the surface does not enter it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cspace.arrays import Floats, Indices
from cspace.geometry.covering import AT_ONCE, IN_CACHE
from cspace.tolerances import OUTWARD

MOST_TERMS = 250_000_000
"""Corners times planes of a hull at most; a mesh with more is treated as if it had no hull."""


class Convex(NamedTuple):
    """A convex solid of half-spaces.

    Attributes
    ----------
    planes : ndarray, shape (n, 4)
        Outward unit normals, then offsets: a place is inside if normal . x + offset <= 0.
    error : float
        No point of the mesh is deeper than this in the solid; length.
    """

    planes: Floats
    error: float

    def depths(self, places: Floats) -> Floats:
        """Return lower bounds of the depths of places in the mesh's solid; no meaning below 0."""
        least = np.full(len(places), np.inf)
        step = max(1, 4 * IN_CACHE // max(1, len(places)))
        for k in range(0, len(self.planes), step):
            least = np.minimum(least, -heights(places, self.planes[k : k + step]).max(axis=1))
        return least - self.error


class OrientedBox(NamedTuple):
    """A box: its middle, its axes as columns of a rotation, and its size along each.

    The mesh lies in this solid, and no place of the solid is farther than `error` from the hull.
    """

    middle: Floats
    axes: Floats
    size: Floats
    error: float


def heights(places: Floats, planes: Floats) -> Floats:
    """Return how far places lie before planes, shape (places, planes).

    With so few columns a product of matrices is not faster, and its threads would cost twice the
    time.
    """
    found = np.broadcast_to(planes[:, 3], (len(places), len(planes))).copy()
    for i in range(3):
        found += places[:, i, None] * planes[:, i]
    return found


def hull_of(corners: Floats) -> Convex | None:
    """Return the convex hull of places, or None if they lie in a plane or it has many faces."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(corners)
    except QhullError:  # a flat one has no inside
        return None
    size = float(np.abs(corners).max())
    planes = _distinct(hull.equations, size)
    if len(planes) * len(corners) > MOST_TERMS:
        return None
    outside = -float(Convex(planes, 0.0).depths(corners).min())
    return Convex(planes, max(outside, 0.0) + 16 * OUTWARD * size)


def _distinct(planes: Floats, size: float) -> Floats:
    """Keep one of each group of planes that agree up to rounding."""
    rounded = np.round(planes / [1, 1, 1, size], 9)
    _, first = np.unique(rounded, axis=0, return_index=True)
    return np.asarray(planes[np.sort(first)])


def convex_solid(triangles: Floats, error: float) -> Convex | None:
    """Return the hull of a closed mesh if the mesh is its surface, up to an error; else None.

    If all triangles lie within the error of the hull's surface, no triangle separates deeper
    places. So the mesh goes round all of these places, or round none.
    """
    hull = hull_of(np.unique(triangles.reshape(-1, 3), axis=0))
    if hull is None:
        return None
    far = _below_a_face(triangles, hull.planes, error)
    if far > error:
        return None
    within = Convex(hull.planes, hull.error + max(far, 0.0))
    middle = triangles.reshape(-1, 3).mean(axis=0)[None]
    if within.depths(middle)[0] <= 0 or not winding_numbers(triangles, middle)[0]:
        return None
    return within


def _below_a_face(triangles: Floats, planes: Floats, error: float) -> float:
    """Return how deep below one plane a whole triangle lies, at the worst of them; inf if too deep.

    Planes that face the same way as the triangle are tried first.
    """
    from scipy.spatial import cKDTree

    normals, _ = unit_normals(triangles)
    size = float(np.abs(triangles).max()) or 1.0
    offsets = -np.einsum("ni,ni->n", normals, triangles[:, 0])
    own = np.column_stack([normals, offsets]) / [1, 1, 1, size]
    tree = cKDTree(planes / [1, 1, 1, size])
    depth = np.full(len(triangles), np.inf)
    for sense in (own, -own):
        plane = planes[tree.query(sense)[1]]
        places = np.einsum("nki,ni->nk", triangles, plane[:, :3]) + plane[:, 3:]
        depth = np.minimum(depth, -places.min(axis=1))
    doubtful = np.flatnonzero(depth > error)  # slivers need it: their normals are rounding
    if len(doubtful) * len(planes) > MOST_TERMS:
        return math.inf
    step = max(1, AT_ONCE // (3 * len(planes)))
    for k in range(0, len(doubtful), step):
        some = doubtful[k : k + step]
        below = -heights(triangles[some].reshape(-1, 3), planes).reshape(len(some), 3, -1)
        depth[some] = below.max(axis=1).min(axis=1)
        if depth[some].max() > error:
            return math.inf
    return float(depth.max())


def as_box(solid: Convex, corners: Floats, error: float) -> OrientedBox | None:
    """Return the box that a convex solid is, up to an error, or None.

    Parameters
    ----------
    corners : ndarray, shape (n, 3)
        Corners of the mesh. The box holds all of them, and one lies within the error of each corner
        of the box.
    """
    normals = solid.planes[:, :3]
    first = normals[0]
    second = normals[np.abs(normals @ first).argmin()]
    second = second - (second @ first) * first
    if not (length := float(np.linalg.norm(second))):
        return None
    second = second / length
    axes = np.column_stack([first, second, np.cross(first, second)])
    seen = corners @ axes
    low, high = seen.min(axis=0), seen.max(axis=0)
    ends = np.stack(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), axis=-1)
    far = max(float(np.linalg.norm(seen - end, axis=1).min()) for end in ends.reshape(-1, 3))
    if far > error:
        return None
    slack = 16 * OUTWARD * float(np.abs(corners).max())
    # A line from the middle to a place of the hull meets the mesh where it is no deeper than that.
    depth = solid.depths(corners.mean(axis=0)[None])[0]
    away = solid.error * float(np.linalg.norm(high - low))
    if away > error * depth:
        return None
    middle = axes @ ((low + high) / 2)
    return OrientedBox(middle, axes, high - low + slack, far + slack + away / depth)


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
    step = max(1, IN_CACHE // max(1, len(places)))
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


def triangle_distances(triangles: Floats, places: Floats) -> Floats:
    """Return the distance of each place from the nearest of some triangles, shape (m,); length.

    Examples
    --------
    >>> import numpy as np
    >>> triangle = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    >>> triangle_distances(triangle, np.array([[0.2, 0.2, 3.0], [-3.0, -4.0, 0.0]])).tolist()
    [3.0, 5.0]
    """
    nearest = np.full(len(places), np.inf)
    step = max(1, IN_CACHE // max(1, len(places)))
    for k in range(0, len(triangles), step):
        corners = triangles[k : k + step]
        normals, _ = unit_normals(corners)
        above_all = np.ones((len(places), len(corners)), dtype=bool)
        squares = np.full((len(places), len(corners)), np.inf)
        for i in range(3):
            start, side = corners[:, i], corners[:, (i + 1) % 3] - corners[:, i]
            away = places[:, None] - start
            length = np.einsum("ni,ni->n", side, side)
            along = np.einsum("mni,ni->mn", away, side) / np.where(length > 0, length, 1.0)
            foot = away - np.clip(along, 0, 1)[..., None] * side
            squares = np.minimum(squares, np.einsum("mni,mni->mn", foot, foot))
            above_all &= np.einsum("mni,ni->mn", away, np.cross(normals, side)) > 0
        heights_ = np.einsum("mni,ni->mn", places[:, None] - corners[:, 0], normals) ** 2
        squares = np.where(above_all, np.minimum(squares, heights_), squares)
        nearest = np.minimum(nearest, np.sqrt(squares.min(axis=1)))
    return nearest


def unit_normals(triangles: Floats) -> tuple[Floats, Floats]:
    """Return the normals of triangles, of length 1 or 0 for one of no area, and the areas."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    twice = np.linalg.norm(normals, axis=1)
    return normals / np.where(twice > 0, twice, 1.0)[:, None], twice / 2


# --- distance to a surface ------------------------------------------------------------------------


MOST_ROUGH = 30_000
"""Samples, about, that are enough to find where balls lie: the surface bends little between."""

NEARLY = 0.004
"""Part by which a sample may be farther away than the nearest one. Without it a search takes a
hundred times as long near the middle of a sphere, where all samples are equally near."""


def one_a_cell(places: Floats, most: int, size: float) -> tuple[Indices, Indices]:
    """Put places into the cells of a grid, of size or, where that makes too many, coarser.

    Parameters
    ----------
    places : ndarray, shape (n, 3)
    most : int
        Cells at most.
    size : float
        Above 0; length.

    Returns
    -------
    ndarray of int, shape (cells,)
        A place of each cell.
    ndarray of int, shape (n,)
        The cell of each place.

    Examples
    --------
    >>> import numpy as np
    >>> places = np.array([[0.0, 0, 0], [0.1, 0, 0], [1.0, 0, 0], [9.0, 0, 0]])
    >>> [found.tolist() for found in one_a_cell(places, 10, 0.5)]
    [[0, 2, 3], [0, 0, 1, 2]]
    >>> one_a_cell(places, 2, 0.5)[0].tolist()
    [0, 3]
    """
    chosen, cell = np.arange(len(places)), np.arange(len(places))
    if not len(places):
        return chosen, cell
    low, high = places.min(axis=0), places.max(axis=0)
    size = max(size, float((high - low).max()) / 2**20)  # numbers of 63 bits
    while True:
        cells = np.floor((places[chosen] - low) / size).astype(np.int64)
        first, rank = _first_of_each(cells)
        chosen, cell = chosen[first], rank[cell]
        if len(chosen) <= most:
            return chosen, cell
        size *= max(1.05, (len(chosen) / most) ** 0.5)


def _first_of_each(cells: NDArray[np.int64]) -> tuple[Indices, Indices]:
    """Return the first row of each kind of equal rows, and the number of the kind of each row."""
    shape = cells.max(axis=0) + 1
    number = (cells[:, 0] * shape[1] + cells[:, 1]) * shape[2] + cells[:, 2]
    _, first, kind = np.unique(number, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return first[order], rank[kind]


class SurfaceDistance:
    """Distances from a surface that is known from samples of it.

    Parameters
    ----------
    samples : ndarray, shape (n, 3)
        Places of the surface, n > 0.
    spread : float
        Every place of the surface is within this distance of a sample.
    """

    def __init__(self, samples: Floats, spread: float) -> None:
        from scipy.spatial import cKDTree

        self.samples, self.spread = samples, spread
        self._tree = cKDTree(samples)

    def rough(self) -> SurfaceDistance:
        """Return the same with fewer samples, to search with only: its depths are too large."""
        few, _ = one_a_cell(self.samples, MOST_ROUGH, self.spread)
        return SurfaceDistance(self.samples[few], self.spread)

    def within(self, places: Floats, radii: Floats) -> Indices:
        """Find for each ball a sample that lies in it, deeper than the spread; -1 for none."""
        apart, index = self._tree.query(places, eps=NEARLY)
        return np.where(apart < radii - self.spread, index, -1)

    def depths(self, places: Floats) -> Floats:
        """Return lower bounds of distances to the surface, shape (m,); no meaning below 0."""
        apart, _ = self._tree.query(places, eps=NEARLY)
        return np.asarray(apart / (1 + NEARLY) * (1 - OUTWARD) - self.spread)


# --- inner balls ----------------------------------------------------------------------------------


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
        Of centres that are nearer to each other than about this, one is kept; length.
    """
    centres = starts - _shrunk(surface.rough(), starts, normals)[:, None] * normals
    centres = centres[one_a_cell(centres, len(centres), apart)[0]]
    depths = surface.depths(centres)
    kept = depths > 0
    centres, depths = centres[kept], depths[kept]
    inside = _inside(triangles, centres, depths)
    return centres[inside], depths[inside]


def _shrunk(surface: SurfaceDistance, starts: Floats, normals: Floats) -> Floats:
    """Return radii of balls that touch the surface at given places and hardly cross the surface."""
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
    """Tell which places a closed surface encloses, given lower bounds of their distances from it.

    Places whose balls meet are on one side of the surface, so one place decides for its group. If
    there are too many groups, the shallowest count as outside.
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
