"""Random sampling and an alpha shape in arrays: scipy's Delaunay triangles, joined by shapely.

The same shape as that of the package alphashape, as someone who knows NumPy would write it: of all
triangles of `scipy.spatial.Delaunay` those whose circumscribed circle is small are kept, and the
edges that one of them alone has are its boundary.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from planar import Floats, arm
from quality import packed
from sampled import count_for, feasible, largest_gap, polygon_rings
from serve import Refused, Timed, serve, timed

MOST = 1_500_000
"""Configurations, at most: they take over 20 s."""


def spatial() -> Any:
    """Return `scipy.spatial`, which loads at the first call."""
    import scipy.spatial

    return scipy.spatial


def region(scene: str, accuracy: float) -> Timed:
    """Answer with the alpha shape of a random sample."""
    form, _ = arm(scene), spatial()
    count = count_for(form, accuracy)
    if count > MOST:
        raise Refused(f"{count:.2g} configurations are more than {MOST:.0e}")
    gap = largest_gap(form, count)
    seconds, processor, shape = timed(lambda: _alpha_shape(feasible(form, count, gap), gap))
    return seconds, processor, {"configurations": count, "rings": packed(polygon_rings(shape))}


def _alpha_shape(points: Floats, radius: float) -> shapely.Geometry:
    """Return the union of all Delaunay triangles with a circumscribed circle below a radius."""
    triangles = spatial().Delaunay(points).simplices.astype(np.int64)
    triangles = triangles[_circumradii(points[triangles]) < radius]
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2))
    keys = edges[:, 0] * len(points) + edges[:, 1]
    _, first, counts = np.unique(keys, return_index=True, return_counts=True)
    outer = first[counts == 1]
    faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(points[edges[outer]])))
    behind = shapely.points(points[triangles[outer // 3]].mean(axis=1))
    kept = shapely.STRtree(faces).query(behind, predicate="within")[1]
    return shapely.union_all(faces[np.unique(kept)])


def _circumradii(corners: Floats) -> Floats:
    """Return the radius of the circle through three points, shape (n, 3, 2) to (n,)."""
    sides = corners - np.roll(corners, 1, axis=1)
    lengths = np.hypot(sides[..., 0], sides[..., 1])
    twice = np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    with np.errstate(divide="ignore"):
        return lengths.prod(axis=1) / (2 * twice)


if __name__ == "__main__":
    needs = {"scipy": "scipy", "shapely": "shapely", "numpy": "numpy"}
    serve("sampling + Delaunay in arrays", needs, {"region": region})
