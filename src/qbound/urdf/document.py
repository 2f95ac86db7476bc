"""A URDF as data: links and joints, lengths in metres and angles in radians.

https://docs.ros.org/en/rolling/p/urdfdom defines the format; `capsule` is part of version 1.2.
Visual shapes, inertias, transmissions and extensions of simulators are not read.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from qbound.arrays import Floats
from qbound.model.frames import roll_pitch_yaw
from qbound.model.schema import shown
from qbound.urdf.poses import Pose
from qbound.urdf.shapes import Box, Capsule, Collision, Cylinder, Mesh, Solid, Sphere
from qbound.urdf.xml import Element, Source, read_xml

MOVING = ("revolute", "continuous", "prismatic")
"""Types of joints that an arm of ours may have; "fixed" ones are folded in."""

OTHERS = ("floating", "planar")
"""Types of URDF that no arm of ours has: more than one degree of freedom."""


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: multiplier times its value plus the offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """An element <joint>; `pose` is that of the joint's axes, seen from the parent link."""

    name: str
    type: str
    parent: str
    child: str
    pose: Pose
    axis: Floats
    limits: tuple[float, float] | None
    velocity: float | None
    mimic: Mimic | None
    element: Element


@dataclass(frozen=True, eq=False)
class UrdfLink:
    """An element <link> and what of it may collide."""

    name: str
    collisions: tuple[Collision, ...]
    element: Element


@dataclass(frozen=True, eq=False)
class Urdf:
    """A URDF, read: links and joints by name, in the order of the file."""

    name: str
    file: Path
    source: Source
    links: dict[str, UrdfLink]
    joints: dict[str, UrdfJoint]


Named = TypeVar("Named", UrdfLink, UrdfJoint)


def read_urdf(path: Path) -> Urdf:
    """Read a URDF.

    Raises
    ------
    qbound.model.robotcheck.RobotFileError
        With the first fault and its line.
    """
    root, source = read_xml(path, "robot")
    links = _by_name([_link(element) for element in root.children("link")])
    joints = _by_name([_joint(element) for element in root.children("joint")])
    if not links:
        root.fault("no <link>; wanted: one or more")
    return Urdf(
        name=root.text("name"),
        file=path,
        source=source,
        links=links,
        joints=joints,
    )


def _by_name(items: list[Named]) -> dict[str, Named]:
    found: dict[str, Named] = {}
    for item in items:
        if item.name in found:
            item.element.fault(f"the name {shown(item.name)} is used twice")
        found[item.name] = item
    return found


def _link(element: Element) -> UrdfLink:
    collisions = tuple(map(_collision, element.children("collision")))
    return UrdfLink(element.text("name"), collisions, element)


def _joint(element: Element) -> UrdfJoint:
    kind = element.text("type")
    if kind not in (*MOVING, *OTHERS, "fixed"):
        known = ", ".join((*MOVING, "fixed"))
        element.fault(f"type {shown(kind)} is unknown; wanted: one of {known}")
    axis = element.child("axis")
    direction = np.array([1.0, 0.0, 0.0]) if axis is None else axis.vector("xyz", (1.0, 0.0, 0.0))
    if axis is not None and not direction.any() and kind in MOVING:
        axis.fault("xyz: 0 0 0 has no direction")
    limits, velocity = _limit(element, kind)
    return UrdfJoint(
        name=element.text("name"),
        type=kind,
        parent=_linked(element, "parent"),
        child=_linked(element, "child"),
        pose=_pose(element),
        axis=direction,
        limits=limits,
        velocity=velocity,
        mimic=_mimic(element),
        element=element,
    )


def _linked(element: Element, tag: str) -> str:
    child = element.child(tag)
    if child is None:
        element.fault(f"<{tag}> is missing")
    return child.text("link")


def _limit(element: Element, kind: str) -> tuple[tuple[float, float] | None, float | None]:
    """Return limits, where the file has any that rise or should, and the speed if it is above 0."""
    limit = element.child("limit")
    if limit is None or kind not in MOVING:
        return None, None
    speed = limit.number("velocity") if limit.has("velocity") else 0.0
    velocity = speed if speed > 0 else None
    if kind == "continuous" or not (limit.has("lower") or limit.has("upper")):
        return None, velocity
    low, high = (limit.number(key) if limit.has(key) else 0.0 for key in ("lower", "upper"))
    return (low, high), velocity


def _mimic(element: Element) -> Mimic | None:
    mimic = element.child("mimic")
    if mimic is None:
        return None
    multiplier = mimic.number("multiplier") if mimic.has("multiplier") else 1.0
    offset = mimic.number("offset") if mimic.has("offset") else 0.0
    return Mimic(mimic.text("joint"), multiplier, offset)


def _pose(element: Element) -> Pose:
    origin = element.child("origin")
    if origin is None:
        return Pose.still()
    rpy = origin.vector("rpy", (0.0, 0.0, 0.0))
    turn = roll_pitch_yaw(*rpy) if rpy.any() else np.eye(3)
    return Pose(np.asarray(turn, dtype=float), origin.vector("xyz", (0.0, 0.0, 0.0)))


# --- shapes ---------------------------------------------------------------------------------------


def _collision(element: Element) -> Collision:
    geometry = element.child("geometry")
    if geometry is None:
        element.fault("<geometry> is missing")
    shapes = geometry.children()
    if len(shapes) != 1 or shapes[0].tag not in SOLIDS:
        found = " and ".join(f"<{shape.tag}>" for shape in shapes) or "nothing"
        geometry.fault(f"{found} found; wanted: one of {', '.join(SOLIDS)}")
    return Collision(_pose(element), SOLIDS[shapes[0].tag](shapes[0]), shapes[0])


def _mesh(element: Element) -> Mesh:
    scale = element.vector("scale", (1.0, 1.0, 1.0))
    if not scale.all():
        element.fault("scale: 0 makes the mesh flat; wanted: three numbers that are not 0")
    return Mesh(element.text("filename"), scale)


def _box(element: Element) -> Box:
    size = element.vector("size")
    if not (size > 0).all():
        element.fault("size: wanted: three numbers above 0")
    return Box(size)


SOLIDS: dict[str, Callable[[Element], Solid]] = {
    "sphere": lambda e: Sphere(e.size("radius")),
    "capsule": lambda e: Capsule(e.size("radius"), e.size("length")),
    "cylinder": lambda e: Cylinder(e.size("radius"), e.size("length")),
    "box": _box,
    "mesh": _mesh,
}
"""From an element of <geometry> to its shape."""
