"""Who tells of configurations whether they are free: of many at once, and of one in a call.

Each peer is set up as its own documentation has it, with the fastest setting that it documents.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from math import cos, sin
from typing import Any

import numpy as np
import scenes
from asking import Timed, timed

from cspace import Robot

Judge = Callable[[np.ndarray], Any]


def judge(make: Callable[[str, bool], Judge]) -> Callable[..., Timed]:
    """Turn the maker of a judge, of a batch or of one configuration, into a peer."""
    made = lru_cache(maxsize=8)(make)

    @wraps(make)
    def peer(task: str, scene: str, count: int) -> Timed:
        free, q = made(scene, task == "stream"), drawn(scene, count)
        if task == "stream":
            free(q[:100])  # what is compiled or allocated at the first call
            q.sum()  # memory that the system has put aside between rounds comes back
            seconds, processor, found = timed(lambda: free(q))
        else:
            rows = list(q)
            free(rows[0])
            seconds, processor, found = timed(lambda: [free(row) for row in rows])
        return seconds, processor, {"free": np.asarray(found, dtype=bool)}

    return peer


@lru_cache(maxsize=1)
def drawn(scene: str, count: int) -> np.ndarray:
    return scenes.configurations(scene, count)


def row_by_row(free: Judge) -> Judge:
    """Return a judge of a batch: a loop in Python."""
    return lambda q: np.fromiter((free(row) for row in q), dtype=bool, count=len(q))


@judge
def qbound_numpy(scene: str, batch: bool) -> Judge:
    from cspace.boundary.evaluator import evaluator

    return evaluator(scenes.robot(scene)).feasible


@judge
def qbound_compiled(scene: str, batch: bool) -> Judge:
    from cspace.boundary.compiled import compiled_feasible

    return compiled_feasible(scenes.robot(scene))


@judge
def qbound_compiled_two(scene: str, batch: bool) -> Judge:
    from cspace.boundary.compiled import compiled_feasible

    return compiled_feasible(scenes.robot(scene), threads=2)


@judge
def pinocchio_coal(scene: str, batch: bool) -> Judge:
    """Stop at the first collision of each configuration.

    A batch goes to `computeCollisionsInParallel` with a pool of geometries, which the reference
    documents ("parallel/geometry.hpp").
    """
    import coal
    import pinocchio as pin

    arm = scenes.robot(scene)
    told, model, frames = scenes.balls(arm), pin.Model(), {arm.base: 0}
    turning = {
        (1, 0, 0): pin.JointModelRX,
        (0, 1, 0): pin.JointModelRY,
        (0, 0, 1): pin.JointModelRZ,
    }
    for joint in arm.joints:
        aligned = turning.get(tuple(joint.axis))
        moves = aligned() if aligned else pin.JointModelRevoluteUnaligned(joint.axis)
        place = pin.SE3(np.asarray(joint.mount, dtype=float), joint.origin)
        frames[joint.frame] = model.addJoint(frames[joint.parent], moves, place, joint.name)
    shapes, index = pin.GeometryModel(), {}
    for name, radius in told.radii.items():
        point = arm.point(name)
        place = pin.SE3(np.eye(3), point.at)
        ball = pin.GeometryObject(name, frames[point.frame], place, coal.Sphere(radius))
        index[name] = shapes.addGeometryObject(ball)
    for pair in told.pairs:
        shapes.addCollisionPair(pin.CollisionPair(*sorted(index[name] for name in pair)))
    for i, (name, normal, level) in enumerate(told.walls):
        half = coal.Halfspace(normal, level)
        wall = shapes.addGeometryObject(
            pin.GeometryObject(f"wall {i}", 0, pin.SE3.Identity(), half)
        )
        shapes.addCollisionPair(pin.CollisionPair(index[name], wall))
    if batch:
        pool = pin.GeometryPool(model, shapes, 1)
        return lambda q: (
            ~pin.computeCollisionsInParallel(1, pool, np.asfortranarray(q.T), True, False)
        )
    data, state = model.createData(), shapes.createData()
    return lambda q: not pin.computeCollisions(model, data, shapes, state, q, True)


@judge
def python_fcl(scene: str, batch: bool) -> Judge:
    """Move the balls to where NumPy has them, then `fcl.collide` pair by pair, as the README does.

    Spheres need no turn: `setTranslation` moves them.
    """
    import fcl

    arm = scenes.robot(scene)
    told = scenes.balls(arm)
    balls = {name: fcl.CollisionObject(fcl.Sphere(radius)) for name, radius in told.radii.items()}
    meetings: list[tuple[Any, Any]] = [(balls[one], balls[other]) for one, other in told.pairs]
    for name, normal, level in told.walls:
        meetings.append((balls[name], fcl.CollisionObject(fcl.Halfspace(normal, level))))
    request, result, collide = fcl.CollisionRequest(), fcl.CollisionResult(), fcl.collide

    def many(q: np.ndarray) -> np.ndarray:
        found = np.empty(len(q), dtype=bool)
        for i, centres in enumerate(places(arm, list(balls), q)):
            for ball, centre in zip(balls.values(), centres, strict=True):
                ball.setTranslation(centre)
            found[i] = not any(collide(a, b, request, result) for a, b in meetings)
        return found

    return many if batch else lambda q: bool(many(q[None])[0])


def places(arm: Robot, names: list[str], q: np.ndarray) -> np.ndarray:
    """Return where points are, seen from the base, shape (n, points, 3), by Rodrigues' formula."""
    turns = {arm.base: np.broadcast_to(np.eye(3), (len(q), 3, 3))}
    origins = {arm.base: np.zeros((len(q), 3))}
    for joint, angle in zip(arm.joints, q.T, strict=True):
        (x, y, z), turn = joint.axis, turns[joint.parent]
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
        turned = np.eye(3) + s * cross + (1 - c) * (cross @ cross)
        origins[joint.frame] = origins[joint.parent] + turn @ joint.origin
        turns[joint.frame] = turn @ np.asarray(joint.mount, dtype=float) @ turned
    points = [arm.point(name) for name in names]
    return np.stack([origins[p.frame] + turns[p.frame] @ p.at for p in points], axis=1)


@judge
def mujoco_contacts(scene: str, batch: bool) -> Judge:
    """Run the stages of kinematics and collision alone, with contacts of the scene's pairs alone.

    "mj_kinematics" and "mj_collision" are the stages of the documented pipeline that contacts need
    (chapter "Simulation", "Forward dynamics"); explicit contact pairs are the documented way to
    choose what is tested (XML reference, "contact/pair").
    """
    import mujoco

    arm, spec, quat = scenes.robot(scene), mujoco.MjSpec(), np.empty(4)
    told, frames = scenes.balls(arm), {arm.base: spec.worldbody}
    spec.compiler.degree = False
    alone = {"contype": 0, "conaffinity": 0}
    for joint in arm.joints:
        mujoco.mju_mat2Quat(quat, np.asarray(joint.mount, dtype=float).reshape(-1))
        body = frames[joint.parent].add_body(name=joint.frame, pos=joint.origin, quat=quat)
        body.add_joint(name=joint.name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=joint.axis)
        body.mass, body.inertia = 1.0, [1.0, 1.0, 1.0]
        body.explicitinertial = True
        frames[joint.frame] = body
    for name, radius in told.radii.items():
        point, ball = arm.point(name), mujoco.mjtGeom.mjGEOM_SPHERE
        body = frames[point.frame]
        body.add_geom(name=name, type=ball, pos=point.at, size=[radius, 0, 0], **alone)
    for i, pair in enumerate(told.pairs):
        spec.add_pair(name=f"pair {i}", geomname1=pair[0], geomname2=pair[1])
    for i, (name, normal, level) in enumerate(told.walls):
        mujoco.mju_quatZ2Vec(quat, normal)  # carries the z axis, a plane's normal, to this one
        wall, plane = f"wall {i}", {"type": mujoco.mjtGeom.mjGEOM_PLANE, "size": [0, 0, 1]}
        spec.worldbody.add_geom(name=wall, pos=normal * level, quat=quat, **plane, **alone)
        spec.add_pair(name=f"at {wall}", geomname1=wall, geomname2=name)
    model = spec.compile()
    data = mujoco.MjData(model)
    position, kinematics, collision = data.qpos, mujoco.mj_kinematics, mujoco.mj_collision

    def free(q: np.ndarray) -> bool:
        position[:] = q
        kinematics(model, data)
        collision(model, data)
        return data.ncon == 0

    return row_by_row(free) if batch else free


@judge
def shapely_points(scene: str, batch: bool) -> Judge:
    """Ask polygons by `contains_xy`, the documented vectorised way.

    The polygons are our region's, 1e-3 rad from its arcs at most, prepared once: what a user has
    who made the region once, wrote it to GeoJSON, and judges points by shapely.
    """
    import shapely
    from quality import laid_out

    from cspace import find_region

    polygons = laid_out(scene, find_region(scenes.robot(scene)).to_shapely(1e-3))
    shapely.prepare(polygons)
    return lambda q: shapely.contains_xy(polygons, q[..., 0], q[..., 1])


LEAST, FLOOR, REACH = 0.1**2, 11.32, 1.83 - 0.5


def paper(q1: float, q2: float) -> bool:
    """Tell where the paper's robot is safe, B1 to B4 and B7, typed by hand from its file."""
    s1, c1 = sin(q1), cos(q1)
    if (11.5 * c1 + 4.91 * s1 - 7.5) ** 2 + (10.0 - 11.5 * s1 + 4.91 * c1) ** 2 < LEAST:
        return False
    if (-1.5 * c1 + 12.41 * s1 + 7.5) ** 2 + (10.0 + 1.5 * s1 + 12.41 * c1) ** 2 < LEAST:
        return False
    s2, c2 = sin(q2), cos(q2)
    if (9.09 * c2 - 5.25 * s2 - 2.82) ** 2 + (10.11 - 9.09 * s2 - 5.25 * c2) ** 2 < LEAST:
        return False
    if (9.0 * c2 + 5.25 * s2 + 10.17) ** 2 + (2.61 - 9.0 * s2 + 5.25 * c2) ** 2 < LEAST:
        return False
    return 22.5 - 15.0 * s1 + 25.98 * c1 - 25.0 * (s1 * c2 + c1 * s2) >= FLOOR


def walls(q1: float, q2: float) -> bool:
    """Tell where the ball is between the walls."""
    return abs(2.0 * sin(q1) + sin(q1 + q2)) <= REACH


TYPED = {"paper": paper, "walls": walls}


@judge
def closed_form_numba(scene: str, batch: bool) -> Judge:
    """Compile a closed form typed by hand: a loop, as the first page of Numba's guide has it.

    The documented faster sines (Intel's SVML) need a build of llvmlite that the package index does
    not have.
    """
    import numba

    free = numba.njit(TYPED[scene])
    if not batch:
        return numba.njit(lambda q: free(q[0], q[1]))

    @numba.njit
    def loop(q: np.ndarray, found: np.ndarray) -> None:
        for i in range(len(q)):
            found[i] = free(q[i, 0], q[i, 1])

    def many(q: np.ndarray) -> np.ndarray:
        found = np.empty(len(q), dtype=np.bool_)
        loop(q, found)
        return found

    return many
