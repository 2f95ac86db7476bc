"""URDF and SRDF as data: links, joints, collision shapes; lengths in metres, angles in radians.

https://docs.ros.org/en/rolling/p/urdfdom defines the format; quaternions are part of version 1.1,
`capsule` is part of version 1.2. Visual shapes, inertias, transmissions and extensions of
simulators are not read. What could change the geometry and is not known is refused: an arm without
it would be another arm. From an SRDF, the pairs of links that are not checked and the named poses
are read.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np

from cspace.arrays import Floats
from cspace.model.robotcheck import RobotFileError
from cspace.model.schema import one_line, shown
from cspace.urdf.xml import Element, Source, called, read_xml
from qbound.frames import roll_pitch_yaw

MOVING = ("revolute", "continuous", "prismatic")
"""Types of joints that an arm of ours may have; "fixed" ones are folded in."""

OTHERS = ("floating", "planar")
"""Types of URDF that no arm of ours has: more than one degree of freedom."""


VERSIONS = ("1.0", "1.1", "1.2")
"""Versions of URDF that are read; a file without a version is of the first."""

ATTRIBUTES = {
    "origin": "xyz, rpy, quat_xyzw",
    "axis": "xyz",
    "parent": "link",
    "child": "link",
    "limit": "lower, upper, effort, velocity, acceleration, deceleration, jerk",
    "safety_controller": "soft_lower_limit, soft_upper_limit, k_position, k_velocity",
    "mimic": "joint, multiplier, offset",
    "sphere": "radius",
    "capsule": "radius, length",
    "cylinder": "radius, length",
    "box": "size",
    "mesh": "filename, scale",
}
"""Attributes of each element that places, limits or shapes something."""

MISPLACED = frozenset({"xyz", "rpy", "quat_xyzw", "size", "radius", "length", "scale", "filename"})
"""Attributes that belong to one of these elements, and to no other."""

CHILDREN = {
    "link": "collision, visual, inertial",
    "joint": "origin, parent, child, axis, limit, mimic, safety_controller, calibration, dynamics",
    "collision": "origin, geometry",
}
"""Elements of each element that is read."""

SELF_COLLISION = "self_collision_checking"
"""Shapes of a link for contacts with other links, in place of <collision>: no part of URDF."""

HARMLESS = frozenset(
    {"contact", "contact_coefficients", "gazebo", "joint_properties", "material", "sensor"}
    | {SELF_COLLISION, "surface", "verbose"}
)
"""Elements of simulators and of older files, which place nothing."""


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: multiplier times its value plus the offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """An element <joint>; `pose` is the pose of the joint's axes, seen from the parent link.

    `soft` tells whether the limits are narrowed to the soft ones of a safety controller.
    """

    name: str
    type: str
    parent: str
    child: str
    pose: Pose
    axis: Floats
    limits: tuple[float, float] | None
    soft: bool
    velocity: float | None
    mimic: Mimic | None
    element: Element


@dataclass(frozen=True, eq=False)
class UrdfLink:
    """An element <link> with its collision shapes; `visible` if it has visual ones.

    `other_shapes` tells whether it has shapes of its own against the robot's other links.
    """

    name: str
    collisions: tuple[Collision, ...]
    visible: bool
    other_shapes: bool
    element: Element


@dataclass(frozen=True, eq=False)
class Urdf:
    """The content of a URDF: links and joints by name, in the order of the file."""

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
    cspace.model.robotcheck.RobotFileError
        The message has the first fault and its line.
    """
    root, source = read_xml(path, "robot")
    version = root.text("version") if root.has("version") else VERSIONS[0]
    if version not in VERSIONS:
        root.fault(f"version {shown(version)} is not read; known are: {', '.join(VERSIONS)}")
    for element in (*root.children("link"), *root.children("joint")):
        _refuse_unknown(element, version)
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


def _refuse_unknown(element: Element, version: str) -> None:
    """Refuse what is not known in an element, and in its elements, but in visuals and inertias."""
    known, inside = ATTRIBUTES.get(element.tag), CHILDREN.get(element.tag)
    if known is not None:
        element.refuse_others(known.split(", "), known)
    for key in () if inside is None else sorted(MISPLACED):
        if element.has(key):
            element.fault(f"attribute {shown(key)} has no meaning here")
    if element.has("quat_xyzw"):
        if version == VERSIONS[0]:
            element.fault("quat_xyzw belongs to URDF 1.1; <robot> says version 1.0, or none")
        if element.has("rpy"):
            element.fault("both rpy and quat_xyzw; one of them is wanted")
    for child in element.children():
        foreign = "}" in child.tag or child.tag in HARMLESS
        if inside is not None and not foreign and child.tag not in inside.split(", "):
            child.fault(f"<{one_line(child.tag)}> is not read here; known are: {inside}")
        if not foreign and child.tag not in ("visual", "inertial"):
            _refuse_unknown(child, version)


def _by_name(items: list[Named]) -> dict[str, Named]:
    found: dict[str, Named] = {}
    for item in items:
        if item.name in found:
            item.element.fault(f"the name {shown(item.name)} is used twice")
        found[item.name] = item
    return found


def _link(element: Element) -> UrdfLink:
    shapes = map(_collision, element.children("collision"))
    collisions = tuple(shape for shape in shapes if shape is not None)
    visible, other = (bool(element.children(tag)) for tag in ("visual", SELF_COLLISION))
    return UrdfLink(element.text("name"), collisions, visible, other, element)


def _joint(element: Element) -> UrdfJoint:
    kind = element.text("type")
    if kind not in (*MOVING, *OTHERS, "fixed"):
        known = ", ".join((*MOVING, "fixed"))
        element.fault(f"type {shown(kind)} is unknown; wanted: one of {known}")
    axis = element.child("axis")
    direction = np.array([1.0, 0.0, 0.0]) if axis is None else axis.vector("xyz", (1.0, 0.0, 0.0))
    if axis is not None and not direction.any() and kind in MOVING:
        axis.fault("xyz: 0 0 0 has no direction")
    hard, velocity = _limit(element, kind)
    limits = _within_soft(element, kind, hard)
    return UrdfJoint(
        name=element.text("name"),
        type=kind,
        parent=_linked(element, "parent"),
        child=_linked(element, "child"),
        pose=_pose(element),
        axis=direction,
        limits=limits,
        soft=limits != hard,
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
    """Return the limits if the file has any (a missing end is 0), and the speed if above 0."""
    limit = element.child("limit")
    if limit is None or kind not in MOVING:
        return None, None
    speed = limit.number("velocity") if limit.has("velocity") else 0.0
    velocity = speed if speed > 0 else None
    if kind == "continuous" or not (limit.has("lower") or limit.has("upper")):
        return None, velocity
    low, high = (limit.number(key) if limit.has(key) else 0.0 for key in ("lower", "upper"))
    return (low, high), velocity


SOFT = ("soft_lower_limit", "soft_upper_limit")


def _within_soft(
    element: Element, kind: str, hard: tuple[float, float] | None
) -> tuple[float, float] | None:
    """Narrow limits to the soft ones, if there are any (a missing end is 0), as planners do."""
    controller = element.child("safety_controller")
    if controller is None or kind not in MOVING or not any(map(controller.has, SOFT)):
        return hard
    low, high = (controller.number(key) if controller.has(key) else 0.0 for key in SOFT)
    if hard is None and kind == "continuous" and low >= high:
        return None  # a range of no size says that there is none
    hard = hard or (low, high)
    found = (max(low, hard[0]), min(high, hard[1]))
    if found[0] > found[1]:
        controller.fault(f"soft limits {low:g} to {high:g}: none of them is within the limits")
    return found


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
    place = origin.vector("xyz", (0.0, 0.0, 0.0))
    if origin.has("quat_xyzw"):
        return Pose(_quaternion(origin), place)
    rpy = origin.vector("rpy", (0.0, 0.0, 0.0))
    turn = roll_pitch_yaw(*rpy) if rpy.any() else np.eye(3)
    return Pose(np.asarray(turn, dtype=float), place)


UNIT = 1e-2
"""How far the length of a quaternion may be from 1: digits that were cut off, no slip."""


def _quaternion(origin: Element) -> Floats:
    """Return the rotation of a quaternion, scaled to length 1, shape (3, 3)."""
    numbers = origin.vector("quat_xyzw", count=4)
    length = float(np.linalg.norm(numbers))
    if not abs(length - 1) <= UNIT:
        origin.fault(f"quat_xyzw: of length {length:.6g}; wanted: 1")
    x, y, z, w = numbers / length
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


# --- shapes ---------------------------------------------------------------------------------------


def _collision(element: Element) -> Collision | None:
    """Return a shape with its pose; None for a box of size 0 0 0, as some files put at the root."""
    geometry = element.child("geometry")
    if geometry is None:
        element.fault("<geometry> is missing")
    shapes = geometry.children()
    if len(shapes) != 1 or shapes[0].tag not in SOLIDS:
        found = " and ".join(f"<{shape.tag}>" for shape in shapes) or "nothing"
        geometry.fault(f"{found} found; wanted: one of {', '.join(SOLIDS)}")
    solid = SOLIDS[shapes[0].tag](shapes[0])
    if isinstance(solid, Cuboid) and not solid.size.any():
        return None
    return Collision(_pose(element), solid, shapes[0])


def _mesh(element: Element) -> Mesh:
    scale = element.vector("scale", (1.0, 1.0, 1.0))
    if not scale.all():
        element.fault("scale: 0 makes the mesh flat; wanted: three numbers that are not 0")
    return Mesh(element.text("filename"), scale)


def _box(element: Element) -> Cuboid:
    size = element.vector("size")
    if not (size >= 0).all():
        element.fault("size: wanted: three numbers of 0 or more")
    return Cuboid(size)


SOLIDS: dict[str, Callable[[Element], Solid]] = {
    "sphere": lambda e: Sphere(e.size("radius")),
    "capsule": lambda e: Capsule(e.size("radius"), e.size("length")),
    "cylinder": lambda e: Cylinder(e.size("radius"), e.size("length")),
    "box": _box,
    "mesh": _mesh,
}
"""From an element of <geometry> to its shape."""


# --- poses ----------------------------------------------------------------------------------------


class Pose(NamedTuple):
    """A frame seen from another: its rotation, shape (3, 3), and its origin, shape (3,)."""

    rotation: Floats
    origin: Floats

    @classmethod
    def still(cls) -> Pose:
        """Return the pose of a frame seen from itself."""
        return cls(np.eye(3), np.zeros(3))

    def then(self, other: Pose) -> Pose:
        """Return the pose of `other`, given seen from this frame, as the observer sees it."""
        return Pose(self.rotation @ other.rotation, self.places(other.origin))

    def inverse(self) -> Pose:
        """Return the observer's frame, seen from this one."""
        return Pose(self.rotation.T, -(self.rotation.T @ self.origin))

    def places(self, x: Floats) -> Floats:
        """Return places of this frame, shape (..., 3), as the observer sees them."""
        return np.asarray(self.origin + x @ self.rotation.T)


# --- shapes ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Sphere:
    """A ball about the origin."""

    radius: float


@dataclass(frozen=True)
class Capsule:
    """All places within the radius of a segment on the z axis, about the origin."""

    radius: float
    length: float
    """Of the segment: between the centres of both caps."""


@dataclass(frozen=True)
class Cylinder:
    """A solid cylinder along z with flat ends, about the origin."""

    radius: float
    length: float


@dataclass(frozen=True, eq=False)
class Cuboid:
    """A solid box about the origin, its edges along the axes."""

    size: Floats


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of a file."""

    filename: str
    scale: Floats


@dataclass(frozen=True, eq=False)
class Triangles:
    """A mesh, read: corners, shape (N, 3, 3), seen from its own frame."""

    corners: Floats
    closed: bool
    """Whether it is the whole surface of a solid: every edge has two triangles, of one sense."""
    source: Source


Solid = Sphere | Capsule | Cylinder | Cuboid | Mesh | Triangles


@dataclass(frozen=True, eq=False)
class Collision:
    """A shape of a link, its pose, and the element of the file that describes it."""

    pose: Pose
    solid: Solid
    element: Element


# --- SRDF -----------------------------------------------------------------------------------------


HOMES = ("home", "ready")
"""States that are taken for the home pose where nothing else is asked for, in this order."""

OWN = (
    "group", "group_state", "disable_collisions", "disable_default_collisions", "enable_collisions",
    "virtual_joint", "end_effector", "passive_joint",
)  # fmt: skip
"""Elements of which an SRDF has some; a URDF has none of them."""


@dataclass(frozen=True)
class Srdf:
    """The content of an SRDF.

    Attributes
    ----------
    disabled : frozenset of frozenset of str
        Pairs of links.
    silent : frozenset of str
        Links that are checked only in pairs that are enabled.
    enabled : frozenset of frozenset of str
    states : dict of str to dict of str to float
        Joint values of each named state, rad or m.
    source : Source, optional
    """

    disabled: frozenset[frozenset[str]] = frozenset()
    silent: frozenset[str] = frozenset()
    enabled: frozenset[frozenset[str]] = frozenset()
    states: dict[str, dict[str, float]] | None = None
    source: Source | None = None

    @property
    def named(self) -> frozenset[str]:
        """Links of all its pairs."""
        return self.silent.union(*self.disabled, *self.enabled)

    @property
    def joints(self) -> frozenset[str]:
        """Joints of all its states."""
        return frozenset(joint for values in (self.states or {}).values() for joint in values)

    def checks(self, one: str, other: str) -> bool:
        """Tell whether a pair of links is to be kept apart."""
        pair = frozenset((one, other))
        if pair in self.enabled:
            return True
        return pair not in self.disabled and not pair & self.silent

    def home(self, wanted: str | None) -> tuple[str, dict[str, float]]:
        """Return name and joint values of a state, by default of one called home; or of none."""
        states = self.states or {}
        if wanted is not None and wanted not in states:
            known = ", ".join(states) or "none"
            raise ValueError(f"no state {wanted!r}; there are {known}")
        names = HOMES if wanted is None else (wanted,)
        return next(((name, states[name]) for name in names if name in states), ("", {}))


def read_srdf(path: Path) -> Srdf:
    """Read an SRDF.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        The message has the first fault and its line.
    """
    root, source = read_xml(path, "robot")
    if not any(root.children(tag) for tag in OWN):
        raise RobotFileError(
            f"{called(path)}: no group, no state, no pair of links left out; is it an SRDF?"
        )
    states: dict[str, dict[str, float]] = {}
    for state in root.children("group_state"):
        values = states.setdefault(state.text("name"), {})
        for joint in state.children("joint"):
            if len(joint.text("value").split()) == 1:  # a joint of more freedom has more values
                values[joint.text("name")] = joint.number("value")
    return Srdf(
        disabled=_pairs(root, "disable_collisions"),
        silent=frozenset(each.text("link") for each in root.children("disable_default_collisions")),
        enabled=_pairs(root, "enable_collisions"),
        states=states,
        source=source,
    )


def _pairs(root: Element, tag: str) -> frozenset[frozenset[str]]:
    found = root.children(tag)
    return frozenset(frozenset((each.text("link1"), each.text("link2"))) for each in found)
