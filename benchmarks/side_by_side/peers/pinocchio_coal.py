"""Pinocchio with coal: spheres on the links, half-spaces at the base, the scene's pairs alone.

Many configurations go to `computeCollisionsInParallel` with a pool of geometries, the batch that
its reference documents ("parallel/geometry.hpp"), stopping at the first collision of each; one goes
to `computeCollisions(..., stop_at_first_collision=True)`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scenes
from serve import serve
from streams import Judge, stream_tasks

SMALL = 0.1
"""Radius of the ball that stands for a point at a wall: any will do, the wall gives way."""


def models(scene: str) -> tuple[Any, Any]:
    """Return the model of the arm and of its balls and walls."""
    import coal
    import pinocchio as pin

    told = scenes.plain(scene)
    model, frames = pin.Model(), {told["base"]: 0}
    for joint in told["joints"]:
        place = pin.SE3(np.array(joint["mount"]), np.array(joint["origin"]))
        frames[joint["frame"]] = model.addJoint(
            frames[joint["parent"]], _turning(pin, joint["axis"]), place, joint["name"]
        )
    shapes, index = pin.GeometryModel(), {}
    used = {name for pair in told["pairs"] for name in pair["points"]}
    used |= {wall["point"] for wall in told["walls"]}
    radii = {}
    for point in told["points"]:
        if point["name"] in used:
            radii[point["name"]] = point["radius"] or SMALL
            place = pin.SE3(np.eye(3), np.array(point["at"]))
            ball = coal.Sphere(radii[point["name"]])
            item = pin.GeometryObject(point["name"], frames[point["frame"]], place, ball)
            index[point["name"]] = shapes.addGeometryObject(item)
    for pair in told["pairs"]:
        one, other = sorted(index[name] for name in pair["points"])
        shapes.addCollisionPair(pin.CollisionPair(one, other))
    for wall in told["walls"]:
        level = wall["level"] - radii[wall["point"]]
        half = coal.Halfspace(np.array(wall["normal"]), level)
        item = pin.GeometryObject(wall["name"], 0, pin.SE3.Identity(), half)
        place = shapes.addGeometryObject(item)
        shapes.addCollisionPair(pin.CollisionPair(index[wall["point"]], place))
    return model, shapes


def _turning(pin: Any, axis: list[float]) -> Any:
    aligned = {
        (1, 0, 0): pin.JointModelRX,
        (0, 1, 0): pin.JointModelRY,
        (0, 0, 1): pin.JointModelRZ,
    }
    found = aligned.get(tuple(axis))
    return found() if found else pin.JointModelRevoluteUnaligned(np.array(axis))


def many(threads: int) -> Any:
    """Return the maker of what judges a batch with so many threads."""

    def make(scene: str) -> Judge:
        import pinocchio as pin

        model, shapes = models(scene)
        pool = pin.GeometryPool(model, shapes, threads)

        def judge(q: np.ndarray) -> np.ndarray:
            columns = np.asfortranarray(q.T)
            return ~pin.computeCollisionsInParallel(threads, pool, columns, True, False)

        return judge

    return make


def one(scene: str) -> Judge:
    import pinocchio as pin

    model, shapes = models(scene)
    data, state = model.createData(), shapes.createData()
    collide = pin.computeCollisions
    return lambda q: not collide(model, data, shapes, state, q, True)


if __name__ == "__main__":
    needs = {"pinocchio": "pin", "coal": "coal"}
    serve("pinocchio + coal", needs, stream_tasks(many(1), one))
