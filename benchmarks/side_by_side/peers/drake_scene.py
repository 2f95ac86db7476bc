"""A scene for Drake: a multibody plant in which nothing but the scene's own pairs collides.

Of each pair and each wall the two geometries are its own: two balls of half the distance, or a ball
and a wide box for the half-space, since C-IRIS knows none and the fifteenth ends the process. Each
is welded on as a body of its own, since the checker filters whole bodies. Outlines are prisms
across the plane of motion.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from pydrake.geometry import (
    Box,
    Capsule,
    CollisionFilterDeclaration,
    Convex,
    GeometrySet,
    Shape,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    PrismaticJoint,
    RevoluteJoint,
    SpatialInertia,
    UnitInertia,
)
from pydrake.planning import RobotDiagram, RobotDiagramBuilder, SceneGraphCollisionChecker

WIDE = 1e3
"""Half the width and the depth of the box that stands for a half-space, in the scene's unit."""

THICK = 1.0
"""Half the width of the prism on an outline, across the plane of motion."""

MASS = SpatialInertia(1.0, np.zeros(3), UnitInertia(1.0, 1.0, 1.0))
"""Of every body: nothing is simulated."""


@dataclass
class Geometries:
    """What is registered so far, and which two may collide."""

    plant: MultibodyPlant
    frames: dict[str, Any]
    pairs: list[tuple[Any, Any]] = field(default_factory=list)
    every: list[Any] = field(default_factory=list)

    def add(self, frame: str, shape: Shape, place: RigidTransform) -> Any:
        """Register a shape on the body of a frame."""
        name, friction = f"shape {len(self.every)}", CoulombFriction(0.5, 0.5)
        arm = self.plant.GetModelInstanceByName("arm")
        body = self.plant.AddRigidBody(name, arm, MASS)
        self.plant.WeldFrames(self.frames[frame].body_frame(), body.body_frame(), place)
        made = self.plant.RegisterCollisionGeometry(body, RigidTransform(), shape, name, friction)
        self.every.append(made)
        return made

    def collide(self, one: Any, other: Any) -> None:
        """Let two geometries collide."""
        self.pairs.append((one, other))


def diagram(scene: dict[str, Any]) -> RobotDiagram:
    """Return plant and scene graph of a scene from `scenes.plain`."""
    builder = RobotDiagramBuilder(time_step=0.0)
    plant = builder.plant()
    found = Geometries(plant, _bodies(plant, scene))
    points = {point["name"]: point for point in scene["points"]}
    for pair in scene["pairs"]:
        ball = Sphere(pair["distance"] / 2)
        ends = [points[name] for name in pair["points"]]
        found.collide(*(found.add(p["frame"], ball, RigidTransform(p["at"])) for p in ends))
    for wall in scene["walls"]:
        found.collide(*_wall(found, wall, points[wall["point"]]))
    _add_solids(found, scene)
    plant.Finalize()
    made = builder.Build()
    _filter(made, found)
    return made


def checker(made: RobotDiagram) -> SceneGraphCollisionChecker:
    """Return Drake's collision checker; the arm is the plant's own model instance."""
    arm = made.plant().GetModelInstanceByName("arm")
    return SceneGraphCollisionChecker(model=made, robot_model_instances=[arm], edge_step_size=0.1)


def _bodies(plant: MultibodyPlant, scene: dict[str, Any]) -> dict[str, Any]:
    """Add a body a frame with its joint; return the bodies by frame."""
    arm = plant.AddModelInstance("arm")
    bodies: dict[str, Any] = {scene["base"]: plant.world_body()}
    for joint in scene["joints"]:
        parent = bodies[joint["parent"]]
        body = plant.AddRigidBody(joint["frame"], arm, MASS)
        mount = RigidTransform(RotationMatrix(np.array(joint["mount"])), joint["origin"])
        place = FixedOffsetFrame(f"at {joint['name']}", parent.body_frame(), mount, arm)
        at = plant.AddFrame(place)
        kind = RevoluteJoint if joint["type"] in ("revolute", "continuous") else PrismaticJoint
        if kind is PrismaticJoint and joint["type"] != "prismatic":
            raise ValueError(f"{joint['name']}: no {joint['type']} joint here")
        made = kind(joint["name"], at, body.body_frame(), np.array(joint["axis"], dtype=float))
        plant.AddJoint(made).set_position_limits([joint["low"]], [joint["high"]])
        bodies[joint["frame"]] = body
    return bodies


def _wall(found: Geometries, wall: dict[str, Any], point: dict[str, Any]) -> tuple[Any, Any]:
    """Add a ball at the point, and the wide box that it may not touch."""
    normal, frame = np.array(wall["normal"], dtype=float), next(iter(found.frames))
    radius = max(point["radius"], 0.01)
    length = np.linalg.norm(normal)
    normal, level = normal / length, wall["level"] / length - radius
    place = RigidTransform(RotationMatrix.MakeFromOneVector(normal, 2), normal * (level - WIDE))
    ball = found.add(point["frame"], Sphere(radius), RigidTransform(point["at"]))
    return ball, found.add(frame, Box(2 * WIDE, 2 * WIDE, 2 * WIDE), place)


def _add_solids(found: Geometries, scene: dict[str, Any]) -> None:
    """Add bodies and obstacles; which may touch is as `Robot.used` has it."""
    solids = [*scene["bodies"], *scene["obstacles"]]
    made = [found.add(solid["frame"], *_shape(solid)) for solid in solids]
    allowed = {tuple(sorted(names)) for names in scene["allowed"]}
    for j, other in enumerate(solids):
        for i, one in enumerate(solids[:j]):
            both = tuple(sorted((one["name"], other["name"])))
            if one["frame"] != other["frame"] and both not in allowed:
                found.collide(made[i], made[j])


def _shape(solid: dict[str, Any]) -> tuple[Shape, RigidTransform]:
    """Return shape and place of a capsule, a disc (as a ball) or a polygon (as a prism)."""
    if "capsule" in solid:
        start, end = np.array(solid["capsule"], dtype=float)
        along = end - start
        length = float(np.linalg.norm(along))
        turned = RotationMatrix.MakeFromOneVector(along, 2)
        return Capsule(solid["radius"], length), RigidTransform(turned, (start + end) / 2)
    if "disc" in solid:
        return Sphere(solid["radius"]), RigidTransform(solid["disc"])
    corners = np.array(solid["polygon"], dtype=float)
    across = _across(corners) * THICK
    return Convex(np.concatenate([corners + across, corners - across]).T, solid["name"]), (
        RigidTransform()
    )


def _across(corners: np.ndarray) -> np.ndarray:
    """Return the unit vector across a plane outline."""
    return np.asarray(np.linalg.svd(corners - corners.mean(axis=0))[2][2])


def _filter(made: RobotDiagram, found: Geometries) -> None:
    """Let nothing collide but the pairs, for every context that is made later."""
    manager = made.mutable_scene_graph().collision_filter_manager()
    manager.Apply(CollisionFilterDeclaration().ExcludeWithin(GeometrySet(found.every)))
    for one, other in found.pairs:
        manager.Apply(CollisionFilterDeclaration().AllowBetween(_set(one), _set(other)))


def _set(*members: Any) -> GeometrySet:
    every: Iterable[Any] = members
    return GeometrySet(list(every))
