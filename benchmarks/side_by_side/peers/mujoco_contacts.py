"""MuJoCo: kinematics and collision stages alone, contacts of the scene's pairs alone.

"mj_kinematics" and "mj_collision" are the stages of the documented pipeline that contacts need
(chapter "Simulation", "Forward dynamics"); explicit contact pairs are the documented way to choose
what is tested (XML reference, "contact/pair").
"""

from __future__ import annotations

from typing import Any

import numpy as np
import scenes
from serve import Refused, serve
from streams import Judge, stream_tasks

SMALL = 0.1


def model(scene: str) -> Any:
    """Return the compiled model: bodies with balls, walls as planes, pairs."""
    import mujoco

    told = scenes.plain(scene)
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    frames = {told["base"]: spec.worldbody}
    for joint in told["joints"]:
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, np.array(joint["mount"]).reshape(-1))
        body = frames[joint["parent"]].add_body(name=joint["frame"], pos=joint["origin"], quat=quat)
        body.add_joint(name=joint["name"], type=mujoco.mjtJoint.mjJNT_HINGE, axis=joint["axis"])
        body.mass, body.inertia = 1.0, [1.0, 1.0, 1.0]
        body.explicitinertial = True
        frames[joint["frame"]] = body
    used = {name for pair in told["pairs"] for name in pair["points"]}
    used |= {wall["point"] for wall in told["walls"]}
    radii = {point["name"]: point["radius"] or SMALL for point in told["points"]}
    for point in told["points"]:
        if point["name"] in used:
            _ball(mujoco, frames[point["frame"]], point, radii[point["name"]])
    for i, pair in enumerate(told["pairs"]):
        spec.add_pair(name=f"pair {i}", geomname1=pair["points"][0], geomname2=pair["points"][1])
    for i, wall in enumerate(told["walls"]):
        _plane(mujoco, spec.worldbody, f"wall {i}", wall, radii[wall["point"]])
        spec.add_pair(name=f"at wall {i}", geomname1=f"wall {i}", geomname2=wall["point"])
    return spec.compile()


def _ball(mujoco: Any, body: Any, point: dict[str, Any], radius: float) -> None:
    body.add_geom(
        name=point["name"],
        type=mujoco.mjtGeom.mjGEOM_SPHERE,
        pos=point["at"],
        size=[radius, 0, 0],
        contype=0,
        conaffinity=0,
    )


def _plane(mujoco: Any, body: Any, name: str, wall: dict[str, Any], radius: float) -> None:
    normal = np.array(wall["normal"])
    body.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        pos=normal * (wall["level"] - radius),
        quat=_upright(mujoco, normal),
        size=[0, 0, 1],
        contype=0,
        conaffinity=0,
    )


def _upright(mujoco: Any, normal: np.ndarray) -> np.ndarray:
    """Return the turn that carries the z axis, a plane's normal, to another one."""
    quat = np.empty(4)
    mujoco.mju_quatZ2Vec(quat, normal)
    return quat


def one(scene: str) -> Judge:
    import mujoco

    told = model(scene)
    data = mujoco.MjData(told)
    position, kinematics, collision = data.qpos, mujoco.mj_kinematics, mujoco.mj_collision

    def judge(q: np.ndarray) -> bool:
        position[:] = q
        kinematics(told, data)
        collision(told, data)
        return data.ncon == 0

    if told.nq != len(scenes.robot(scene).joints):
        raise Refused("the model has other joints")
    return judge


def many(scene: str) -> Judge:
    judge = one(scene)
    return lambda q: np.fromiter((judge(row) for row in q), dtype=bool, count=len(q))


if __name__ == "__main__":
    serve("MuJoCo", {"mujoco": "mujoco"}, stream_tasks(many, one))
