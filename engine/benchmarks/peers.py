"""What pinocchio and coal say of imported arms: the same places, the same collisions.

Run with ``python engine/benchmarks/peers.py``, in an environment that has ``pin`` (pinocchio with
coal) and, for the arms of others, ``example-robot-data`` and ``rtb-data``. Each arm is imported,
and pinocchio reads the same URDF for itself. Compared are the places of all balls, seen from the
base, and, by coal's spheres on pinocchio's frames, which configurations collide and which pairs do.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

import coal
import numpy as np
import pinocchio as pin

from cspace.boundary.evaluator import evaluator
from cspace.model.robot import Robot
from cspace.urdf.arm import import_urdf, packaged_or_path

TALOS = ("arm_left_1_link", "wrist_left_ft_tool_link")
CHUNK = 2000
CLOSE = 1e-9
"""Margins (m) within which the rounding of either side may decide."""


class Arm(NamedTuple):
    """An arm to compare: its URDF, SRDF, chain, packages and excess."""

    name: str
    urdf: Path
    srdf: str | Path | None = None
    chain: tuple[str | None, str | None] = (None, None)
    packages: tuple[Path, ...] = ()
    excess: float = 0.02


def arms() -> list[Arm]:
    """Return our own, then those of packages that are installed."""
    own = [("ur5", 0.01), ("panda", 0.02), ("scara", 0.02)]
    found = [Arm(n, packaged_or_path(f"{n}.urdf"), f"{n}.srdf", excess=e) for n, e in own]
    site = Path(sys.prefix, "lib", f"python3.{sys.version_info.minor}", "site-packages")
    data = site / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
    others = [
        *(
            Arm(n, data / f"ur_description/urdf/{n}_robot.urdf", None, ("base_link", "tool0"))
            for n in ("ur3", "ur5", "ur10")
        ),
        Arm("panda", data / "panda_description/urdf/panda.urdf", None, (None, "panda_link8")),
        Arm("talos arm", data / "talos_data/robots/talos_left_arm.urdf", None, TALOS, excess=0.03),
    ]
    puma = site / "rtbdata/xacro/unimation_puma560_description"
    others.append(Arm("puma560", puma / "urdf/puma560_robot.urdf", packages=(puma,)))
    packages = (data, data.parent.parent)
    return [*found, *(arm._replace(packages=(*arm.packages, *packages)) for arm in others)]


def spheres(robot: Robot, model: Any) -> Any:
    """Return coal's spheres for the balls of a robot, and the robot's pairs, on a model."""
    geometry = pin.GeometryModel()
    index = {}
    for point in robot.points:
        frame = model.getFrameId(point.frame, pin.FrameType.BODY)
        place = model.frames[frame].placement * pin.SE3(np.eye(3), point.at)
        parent = model.frames[frame].parentJoint
        ball = pin.GeometryObject(point.name, parent, place, coal.Sphere(point.radius))
        index[point.name] = geometry.addGeometryObject(ball)
    for pair in robot.boundaries:
        geometry.addCollisionPair(pin.CollisionPair(*(index[name] for name in pair.points)))
    return geometry


def true_shapes(arm: Arm, robot: Robot, model: Any) -> Any:
    """Return coal's own shapes of the URDF, with the pairs of links that the robot keeps apart."""
    folders = [str(folder) for folder in arm.packages]
    geometry = pin.buildGeomFromUrdf(model, str(arm.urdf), pin.COLLISION, package_dirs=folders)
    of_link: dict[str, list[int]] = {}
    for i, each in enumerate(geometry.geometryObjects):
        of_link.setdefault(model.frames[each.parentFrame].name, []).append(i)
    links = {tuple(name.rpartition("/")[0] for name in pair.points) for pair in robot.boundaries}
    for one, other in links:
        for i in of_link.get(one, []):
            for j in of_link.get(other, []):
                geometry.addCollisionPair(pin.CollisionPair(i, j))
    return geometry


def compare(arm: Arm, count: int) -> None:
    """Print how far the places differ, and how many configurations are judged differently."""
    start = process_time()
    imported = import_urdf(
        arm.urdf, chain=arm.chain, srdf=arm.srdf, packages=arm.packages, excess=arm.excess
    )
    seconds, robot = process_time() - start, imported.robot
    model = pin.buildModelFromUrdf(str(arm.urdf))
    data, geometry = model.createData(), spheres(robot, model)
    bodies = geometry.createData()
    compiled = evaluator(robot, limits=False)
    shapes = true_shapes(arm, robot, model)
    solids = shapes.createData()
    base = model.getFrameId(robot.base, pin.FrameType.BODY)
    rng = np.random.default_rng(14)
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    places, judged, pairs, close, hits, missed, really = 0.0, 0, 0, 0, 0, 0, 0
    for k in range(0, count, CHUNK):
        q = rng.uniform(*ends.T, (min(CHUNK, count - k), len(robot.joints)))
        values = compiled.margins(q)
        close += int((np.abs(values) < CLOSE).any(axis=1).sum())
        ours = (values < 0).any(axis=1)
        hits += int(ours.sum())
        for row, (x, mine) in enumerate(zip(q, ours, strict=True)):
            full = configuration(model, robot, x)
            judged += bool(mine) != bool(
                pin.computeCollisions(model, data, geometry, bodies, full, True)
            )
            if k == 0 and len(shapes.collisionPairs):
                touch = bool(pin.computeCollisions(model, data, shapes, solids, full, True))
                really += touch
                missed += touch and not mine
            if k == 0 and row < 500:
                pin.computeCollisions(model, data, geometry, bodies, full, False)
                theirs = [bool(each.isCollision()) for each in bodies.collisionResults]
                pairs += int((np.array(theirs) != (values[row] < 0)).sum())
                pin.framesForwardKinematics(model, data, full)
                places = max(places, distance(robot, model, data, base, x))
    print(
        f"{arm.name}: {len(robot.joints)} joints, {len(robot.points) - 1} balls, "
        f"{len(robot.boundaries)} pairs, excess {imported.excess:.4f} m, "
        f"imported in {seconds:.1f} s; "
        f"places within {places:.1e} m; {judged} of {count} configurations judged differently "
        f"({hits} collide, {close} within {CLOSE:g} m of contact), {pairs} pairs of 500; "
        f"of {min(CHUNK, count)}, {really} collide by their true shapes, {missed} of these unseen",
        flush=True,
    )


def configuration(model: Any, robot: Robot, x: np.ndarray) -> np.ndarray:
    """Return pinocchio's configuration; joints without limits are a cosine and a sine there."""
    full = pin.neutral(model)
    for joint, value in zip(robot.joints, x, strict=True):
        theirs = model.joints[model.getJointId(joint.name)]
        values = [value] if theirs.nq == 1 else [np.cos(value), np.sin(value)]
        full[theirs.idx_q : theirs.idx_q + theirs.nq] = values
    return full


def distance(robot: Robot, model: Any, data: Any, base: int, x: np.ndarray) -> float:
    """Return how far the places of the points differ at most, seen from the base."""
    frames = robot.frames(x)
    far = 0.0
    for point in robot.points:
        frame = model.getFrameId(point.frame, pin.FrameType.BODY)
        seen = data.oMf[base].actInv(data.oMf[frame].act(point.at))
        far = max(
            far, float(np.abs(frames.position(robot.base, point.name, robot.base) - seen).max())
        )
    return far


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100_000, help="configurations of each arm")
    parser.add_argument("--only", help="arms whose name holds this")
    options = parser.parse_args()
    for arm in arms():
        if options.only and options.only not in arm.name:
            continue
        try:
            compare(arm, options.count)
        except (ValueError, ImportError) as error:
            print(f"{arm.name}: {error}", flush=True)


if __name__ == "__main__":
    main()
