"""Shapely: is a point in the region's polygons? `contains_xy` is its documented vectorised way.

The polygons are our region's, 1e-3 rad from its arcs at most, prepared once: what a user has who
made the region once, wrote it to GeoJSON, and judges points by shapely.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import scenes
from serve import Missing, serve
from streams import Judge, stream_tasks

from qbound import find_region

DEVIATION = 1e-3


def in_window(polygons: Any, robot: Any) -> Any:
    """Return polygons as they lie in one turn of every joint without limits."""
    import shapely
    from shapely.affinity import translate

    low, high = scenes.ends(robot)
    turns = [(0,) if joint.limits else (-1, 0, 1) for joint in robot.joints]
    copies = [translate(polygons, *(2 * np.pi * np.array(k))) for k in product(*turns)]
    return shapely.intersection(shapely.union_all(copies), shapely.box(*low, *high))


def many(scene: str) -> Judge:
    import shapely

    robot = scenes.robot(scene)
    if len(robot.joints) != 2:
        raise Missing("polygons are for two joints")
    polygons = in_window(find_region(robot).to_shapely(DEVIATION), robot)
    shapely.prepare(polygons)
    return lambda q: np.asarray(shapely.contains_xy(polygons, q[:, 0], q[:, 1]))


def one(scene: str) -> Judge:
    judge = many(scene)
    return lambda q: bool(judge(q[None])[0])


if __name__ == "__main__":
    serve("shapely, prepared polygons", {"shapely": "shapely"}, stream_tasks(many, one))
