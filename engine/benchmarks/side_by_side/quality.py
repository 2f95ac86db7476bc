"""Quality of answers: verdicts compared with ours, one by one; areas with the exact region.

A region or a part of one is answered as a geometry of shapely in the plane of both joints, rad. It
is laid into one turn of every joint that turns all the way round. What lies on the seam, where such
a joint is cut at -pi and pi, is no boundary.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from scenes import ends, robot

from cspace import find_region

OURS = "qbound_numpy"
SHOWN = 3
"""Configurations judged otherwise that the file names."""
TURN = 2 * math.pi
DRAWN = 1e-7
"""Largest distance (rad) of the polygons that stand for the exact region from its arcs."""
SPACING = 0.01
"""Largest distance (rad) of the places on an answer's boundary."""
MOST = 50_000
"""Places on a boundary that are looked at, at most: evenly chosen."""
SEAM = 1e-9
"""What is this near (rad) to the cut of a turning joint is on it."""
OVERLAP = 0.5
"""Boundaries are repeated so far (rad) beyond the cuts: the nearest place may lie there."""
SHARED = 1e-6
"""Pieces of an answer that share as much (rad) of a cut are one component."""

Answers = Mapping[str, dict[str, Any]]


def compared(scene: str, answers: Answers) -> dict[str, dict[str, Any]]:
    """Return what the file keeps of the answers of all peers to the same request."""
    kept = {}
    for name, answer in answers.items():
        told = {key: value for key, value in answer.items() if key not in ("free", "shape")}
        if "free" in answer:
            free = answer["free"]
            told |= {"count": len(free), "free": int(free.sum())}
            if OURS in answers and name != OURS:
                apart = np.flatnonzero(free != answers[OURS]["free"])
                told |= {"different": len(apart), "first different": apart[:SHOWN].tolist()}
        if "shape" in answer:
            told["all"] = quality(scene, answer["shape"])
            if "stated" in told:  # the answer is arcs: distances of the polygons are not theirs
                told["all"]["distance"] = told["stated"]
            if "at" in told:  # of the component that it is in, as that is all that it looks for
                told["own"] = quality(scene, answer["shape"], told["at"])
        kept[name] = told
    return kept


def quality(scene: str, shape: Any, at: Sequence[float] | None = None) -> dict[str, Any]:
    """Compare an answer with the exact region, or with its component at a configuration alone.

    Returns
    -------
    dict
        ``area`` and ``true_area`` (rad^2), ``area_error`` (their difference over the true one);
        ``covered``, the part of the region that is claimed, and ``beyond``, what is claimed and
        not feasible, in parts of the region; ``distance``, the largest one (rad) from either
        boundary to the other, None where nothing was answered; ``components`` and
        ``true_components``.
    """
    area, truth, components = true_region(scene, None if at is None else tuple(at))
    answer = laid_out(scene, shape)
    covered = answer.intersection(truth).area / truth.area
    distance = None
    if not answer.is_empty:
        missed = distances(scene, truth, answer)
        invented = distances(scene, answer, truth) - DRAWN
        distance = float(max(missed.max(), invented.max(), 0.0))
    return {
        "area": answer.area,
        "true_area": area,
        "area_error": abs(answer.area - area) / area,
        "covered": covered,
        "beyond": max(0.0, answer.area / truth.area - covered),
        "distance": distance,
        "components": components_of(scene, answer),
        "true_components": components,
    }


@lru_cache(maxsize=8)
def true_region(scene: str, at: tuple[float, ...] | None = None) -> tuple[float, Any, int]:
    """Return area, polygons and number of components of a region, or of the one at a place."""
    region = find_region(robot(scene))
    number = None if at is None else region.component_of(at)
    parts = region.components if number is None else [region.components[number]]
    drawn = laid_out(scene, region.to_shapely(DRAWN, number))
    return sum(part.area for part in parts), drawn, len(parts)


def turns(scene: str, most: int) -> list[tuple[float, ...]]:
    """Return the shifts by up to so many turns of the joints that turn all the way round."""
    every = [TURN * k for k in range(-most, most + 1)]
    return list(product(*([0.0] if joint.limits else every for joint in robot(scene).joints)))


def laid_out(scene: str, shape: Any) -> Any:
    """Bring polygons into one turn of every joint that turns all the way round, and join them."""
    import shapely
    from shapely.affinity import translate

    frame, valid = shapely.box(*ends(robot(scene)).ravel()), shapely.make_valid(shape)
    parts = [translate(valid, *shift).intersection(frame) for shift in turns(scene, 2)]
    joined = shapely.get_parts(shapely.union_all(parts))
    return shapely.MultiPolygon([part for part in joined if part.geom_type == "Polygon"])


def boundary(scene: str, polygons: Any) -> Any:
    """Return the boundary of polygons without what is on a cut."""
    import shapely

    (x0, y0), (x1, y1) = ends(robot(scene))
    cuts = (
        [[(x0, y0), (x0, y1)], [(x1, y0), (x1, y1)]],
        [[(x0, y0), (x1, y0)], [(x0, y1), (x1, y1)]],
    )
    joints = robot(scene).joints
    seam = [
        cut for pair, joint in zip(cuts, joints, strict=True) if not joint.limits for cut in pair
    ]
    return polygons.boundary.difference(shapely.MultiLineString(seam).buffer(SEAM))


def distances(scene: str, one: Any, other: Any) -> np.ndarray:
    """Return how far places on the boundary of one are from that of the other, across cuts too."""
    import shapely

    lines = shapely.segmentize(boundary(scene, one), SPACING)
    places = shapely.get_coordinates(lines)
    parts = shapely.get_parts(boundary(scene, other))
    to, of = shapely.get_coordinates(parts, return_index=True)
    edges = np.stack([to[:-1], to[1:]], axis=1)[of[:-1] == of[1:]]
    every = np.concatenate([edges + np.array(shift) for shift in turns(scene, 1)])
    low, high = ends(robot(scene)) + np.array([[-OVERLAP], [OVERLAP]])
    near = (every.max(axis=1) > low).all(axis=1) & (every.min(axis=1) < high).all(axis=1)
    tree = shapely.STRtree(shapely.linestrings(every[near]))
    points = shapely.points(places[:: -(-len(places) // MOST)])
    return tree.query_nearest(points, all_matches=False, return_distance=True)[1]


def components_of(scene: str, answer: Any) -> int:
    """Count the components of an answer; pieces that meet across a cut are one."""
    from shapely.affinity import translate

    pieces, meet = list(answer.geoms), list[tuple[int, int]]()
    for shift in turns(scene, 1):
        if sum(map(bool, shift)) == 1 and sum(shift) > 0:
            for i, piece in enumerate(pieces):
                moved = translate(piece, *shift)
                shared = (moved.intersection(other).length for other in pieces)
                meet += [(i, j) for j, length in enumerate(shared) if length > SHARED]
    group = list(range(len(pieces)))
    for i, j in meet:
        group = [group[j] if k == group[i] else k for k in group]
    return len(set(group))
