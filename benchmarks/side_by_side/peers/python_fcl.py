"""python-fcl: places by NumPy for all at once, then `fcl.collide` pair by pair, as its README does.

Spheres need no turn: `setTranslation` moves them. The first collision of a configuration ends it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scenes
from kinematics import places
from serve import serve
from streams import Judge, stream_tasks

SMALL = 0.1
"""Radius of the ball that stands for a point at a wall: any will do, the wall gives way."""


def feasible(scene: str) -> Judge:
    """Return what judges a batch."""
    import fcl

    told = scenes.plain(scene)
    names = sorted(
        {name for pair in told["pairs"] for name in pair["points"]}
        | {wall["point"] for wall in told["walls"]}
    )
    radii = {point["name"]: point["radius"] or SMALL for point in told["points"]}
    balls = [fcl.CollisionObject(fcl.Sphere(radii[name])) for name in names]
    meetings: list[tuple[Any, Any]] = [
        tuple(balls[names.index(name)] for name in pair["points"]) for pair in told["pairs"]
    ]
    for wall in told["walls"]:
        level = wall["level"] - radii[wall["point"]]
        half = fcl.CollisionObject(fcl.Halfspace(np.array(wall["normal"]), level))
        meetings.append((balls[names.index(wall["point"])], half))
    request, result = fcl.CollisionRequest(), fcl.CollisionResult()
    collide = fcl.collide

    def free(centres: np.ndarray) -> bool:
        for ball, centre in zip(balls, centres, strict=True):
            ball.setTranslation(centre)
        return not any(collide(a, b, request, result) for a, b in meetings)

    def judge(q: np.ndarray) -> np.ndarray:
        found = places(told, names, q)
        return np.fromiter((free(centres) for centres in found), dtype=bool, count=len(q))

    return judge


def one(scene: str) -> Judge:
    judge = feasible(scene)
    return lambda q: bool(judge(q[None])[0])


if __name__ == "__main__":
    serve("python-fcl", {"fcl": "python-fcl"}, stream_tasks(feasible, one))
