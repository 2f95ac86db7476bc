"""Types of joints, one class each: its motion, unit, limits and table in a robot file.

A joint of the library yields motions, from which frames and forms come. Here it also has steps,
for chains, poses and balls: turns about one axis, or slides along it, by its value or back by it.
A new type that turns or slides needs a class here and its name in `JointRow.type`.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, TypeVar

import numpy as np
from msgspec import UNSET, Meta, UnsetType, structs

import qbound.robot
from cspace.arrays import Array, cross
from cspace.model.rows import (
    LARGEST,
    Direction,
    Label,
    Number,
    Row,
    Vector,
    plain,
    quotient,
    unit_vector,
)
from cspace.model.schema import shown
from qbound.forms import Kind, combine, constant
from qbound.frames import IDENTITY, Frame, axis_rotation, roll_pitch_yaw
from qbound.robot import Motion, PointForms, Turn

MOST_TURNS = 100
"""Largest distance of a revolute joint's limits, in turns: a region is listed turn by turn."""

MANY_TURNS = 4
"""More turns than a robot's joint has: limits that are wider may be degrees, read as radians."""

AnyJoint = TypeVar("AnyJoint", bound="Joint")


class Step(NamedTuple):
    """A motion of one frame in the one before it, by the value of a joint.

    Attributes
    ----------
    joint : int
        Index of the joint.
    parent, frame : str
        Labels of the frames before and after it.
    sense : int
        -1 if the step goes back by the value.
    slides : bool
    origin, mount, axis : ndarray
        As in `Joint`.
    """

    joint: int
    parent: str
    frame: str
    sense: int
    slides: bool
    origin: Array
    mount: Array
    axis: Array


@dataclass(frozen=True, eq=False)
class Circle(Motion):
    """A frame that a crank carries round the axis and does not turn; `origin` is on the axis.

    Attributes
    ----------
    crank : ndarray, shape (3,)
        From the axis to the frame at joint value 0, seen from the mount.
    """

    crank: Array

    def frame_at(self, q: Array) -> Frame:
        """Return the frame at values q of the joint, rad."""
        carried = self.mount @ axis_rotation(self.axis, q) @ self.crank
        return Frame(self.frame, self.parent, self.mount, self.origin + carried)

    def moved(self, point: PointForms) -> PointForms:
        """Add the turned crank c(q) to u: ``|u + c(q)|^2 = |u|^2 + 2 c(q) . u + |c|^2``."""
        along = self.axis * (self.axis @ self.crank)
        parts = along, self.crank - along, cross(self.axis, self.crank)  # by 1, cos q and sin q
        circle = combine(self.joint, *(constant(part, self.kinds) for part in parts))
        gained = combine(self.joint, *(point.position.dot(2 * part) for part in parts))
        squared = point.squared + gained + self.crank @ self.crank
        return PointForms(point.position + circle, squared)


@dataclass(frozen=True, eq=False)
class Joint(qbound.robot.Joint):
    """A joint of the library with a speed, and with what a robot file says of its type.

    Attributes
    ----------
    velocity : float, optional
        Largest speed, rad/s or length/s; kept, and used by nothing here.
    """

    type_name: ClassVar[str]
    """How a file spells it."""
    own_keys: ClassVar[tuple[str, ...]] = ()
    """Keys of a file that joints of this type must have and others must not."""

    velocity: float | None = None

    def __post_init__(self) -> None:
        """Check nothing: `robotcheck` has looked at the file; exact numbers stay as they are."""

    def steps(self, joint: int) -> Iterator[Step]:
        """Yield the joint's steps, the one nearest to the base first; `joint` is its index."""
        straight = self.origin, self.mount, self.axis
        yield Step(joint, self.parent, self.frame, 1, not self.turns, *straight)

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of all frames that the joint moves, its own last."""
        return tuple(step.frame for step in self.steps(0))

    @classmethod
    def further(cls, row: "JointRow") -> dict[str, Any]:
        """Return the attributes that only this type has, from its table."""
        return {}

    @property
    def many_turns(self) -> float:
        """Number of turns between the limits if it is more than `MANY_TURNS`; else 0."""
        low, high = self.limits or (0.0, 0.0)
        turns = (high - low) / (2 * math.pi)
        return turns if self.turns and turns > MANY_TURNS else 0.0

    @property
    def farthest(self) -> float:
        """Length that the joint itself adds: a slide's farther limit, a parallelogram's crank."""
        return 0.0 if self.turns or self.limits is None else max(map(abs, self.limits))

    def unit(self, length_unit: str, angle_unit: str = "rad") -> str:
        """Return the unit of the joint's values: the given one of angle, or of length."""
        return angle_unit if self.turns else length_unit

    @property
    def shown_scale(self) -> float:
        """Number of shown units (degrees, lengths) in one unit of the library."""
        return math.degrees(1.0) if self.turns else 1.0

    @classmethod
    def scale(cls, angle: float) -> float:
        """Return one unit of a file in the library's units; the file's angle is `angle` radians."""
        return angle if cls.kind == "revolute" else 1.0

    @classmethod
    def limits_fault(cls, limits: Sequence[float] | None, turn: float) -> str | None:
        """Return what is wrong with limits in a file, whose full turn is `turn`, or None."""
        if limits is None or limits[0] < limits[1]:
            return None
        return f"{shown(limits)} does not rise; wanted: [lowest, highest]"

    def as_type(self, kind: type[AnyJoint], **changes: Any) -> AnyJoint:
        """Return a joint of another type with the same attributes, some of them changed."""
        names = {each.name for each in fields(Joint)} - {"kind"}
        kept = {name: getattr(self, name) for name in names}
        return kind(**kept | changes)

    def row(self, angle: float) -> "JointRow":
        """Return its table of a file whose unit of angle is `angle` radians."""
        scale = self.scale(angle)
        straight = np.array_equal(self.mount, np.eye(3))
        return JointRow(
            name=self.name,
            type=self.type_name,  # type: ignore[arg-type]  # one of `JOINT_TYPES`
            parent=self.parent,
            frame=self.frame,
            origin=plain(self.origin),
            axis=plain(self.axis),
            rpy=UNSET if straight else [quotient(x, angle) for x in _rpy(self.mount)],
            limits=UNSET if self.limits is None else [quotient(x, scale) for x in self.limits],
            velocity=UNSET if self.velocity is None else quotient(self.velocity, scale),
        )


class Revolute(Joint):
    """A joint that turns about its axis; without limits all the way round."""

    type_name = "revolute"

    @classmethod
    def limits_fault(cls, limits: Sequence[float] | None, turn: float) -> str | None:
        """Check as every joint does; also refuse a span of hundreds of turns."""
        turns = 0.0 if limits is None else (limits[1] - limits[0]) / turn
        if turns > MOST_TURNS:
            text = f"{shown(limits)} is {turns:.0f} turns wide; at most {MOST_TURNS}"
            return f"{text}; are these degrees where radians are wanted?"
        return super().limits_fault(limits, turn)


class Continuous(Revolute):
    """A joint that turns about its axis without limits, as URDF calls it."""

    type_name = "continuous"

    @classmethod
    def limits_fault(cls, limits: Sequence[float] | None, turn: float) -> str | None:
        """Refuse limits."""
        return None if limits is None else f"{shown(limits)} limits a joint that has no limits"


@dataclass(frozen=True, eq=False)
class Prismatic(Joint):
    """A joint that slides along its axis."""

    type_name = "prismatic"
    kind: Kind = "prismatic"

    @classmethod
    def limits_fault(cls, limits: Sequence[float] | None, turn: float) -> str | None:
        """Check as every joint does; also refuse missing limits."""
        if limits is None:
            return f"missing; a {cls.type_name} joint needs [lowest, highest]"
        return super().limits_fault(limits, turn)


@dataclass(frozen=True, eq=False)
class Parallelogram(Revolute):
    """A joint that carries its frame round a circle and keeps the frame's orientation.

    The joint stands for two joints on parallel axes. The bar turns about the first axis, and the
    frame that the bar carries turns back about the second by the same angle. Places of both are of
    degree one in (1, cos q, sin q).

    Attributes
    ----------
    crank : ndarray, shape (3,)
        From the first axis to the frame at joint value 0, seen from the mount; length.
    bar : str
        Label of the frame of the bar, which turns about the first axis.
    """

    type_name = "parallelogram"
    own_keys = ("crank", "bar")

    crank: Array = field(default_factory=lambda: np.zeros(3))
    bar: str = ""

    def steps(self, joint: int) -> Iterator[Step]:
        """Yield a turn of the bar, and a turn back of the frame that it carries."""
        yield Step(joint, self.parent, self.bar, 1, False, self.origin, self.mount, self.axis)
        yield Step(joint, self.bar, self.frame, -1, False, self.crank, IDENTITY, self.axis)

    def motions(self, index: int, kinds: tuple[Kind, ...]) -> Iterator[Motion]:
        """Yield the turn of the bar, and the way of the frame round a circle."""
        straight = kinds, self.origin, self.mount, self.axis
        yield Turn(index, self.parent, self.bar, *straight)
        yield Circle(index, self.parent, self.frame, *straight, self.crank)

    @property
    def farthest(self) -> float:
        """Length of the crank."""
        return float(np.linalg.norm(np.asarray(self.crank, dtype=float)))

    @classmethod
    def further(cls, row: "JointRow") -> dict[str, Any]:
        """Read crank and bar, which `robotcheck` asks for."""
        return {"crank": np.array(row.crank, dtype=float), "bar": row.bar}

    def row(self, angle: float) -> "JointRow":
        """Write crank and bar too."""
        return structs.replace(super().row(angle), crank=plain(self.crank), bar=self.bar)


JOINT_TYPES: dict[str, type[Joint]] = {
    cls.type_name: cls for cls in (Revolute, Prismatic, Parallelogram, Continuous)
}
"""From a file's spelling to the class."""

Limits = Annotated[
    list[Number],
    Meta(min_length=2, max_length=2, description="a list of 2 numbers, the lowest and the highest"),
]
Speed = Annotated[float, Meta(gt=0, le=LARGEST)]


class JointRow(Row, kw_only=True):
    """A table [[joint]]."""

    name: Label
    type: Literal["revolute", "prismatic", "parallelogram", "continuous"]
    parent: Label
    frame: Label
    origin: Vector
    rpy: Vector | UnsetType = UNSET
    axis: Direction
    limits: Limits | UnsetType = UNSET
    velocity: Speed | UnsetType = UNSET
    crank: Vector | UnsetType = UNSET
    bar: Label | UnsetType = UNSET

    def joint(self, angle: float) -> Joint:
        """Return the joint: radians, a unit axis; the file's unit of angle is `angle` radians."""
        joint_type = JOINT_TYPES[self.type]
        scale = joint_type.scale(angle)
        low, high = self.limits or (0.0, 0.0)
        rpy = None if self.rpy is UNSET else [x * angle for x in self.rpy]
        return joint_type(
            name=self.name,
            parent=self.parent,
            frame=self.frame,
            origin=np.array(self.origin, dtype=float),
            mount=np.eye(3) if rpy is None else roll_pitch_yaw(*rpy),
            axis=unit_vector(self.axis),
            limits=(low * scale, high * scale) if self.limits else None,
            velocity=None if self.velocity is UNSET else self.velocity * scale,
            **joint_type.further(self),
        )


def _rpy(mount: Array) -> tuple[float, float, float]:
    """Return roll, pitch and yaw of a rotation.

    Roll is read after yaw is undone, so that a pitch of a quarter turn needs no case of its own.
    """
    m = np.asarray(mount, dtype=float)
    yaw = math.atan2(m[1, 0], m[0, 0])
    c, s = math.cos(yaw), math.sin(yaw)
    pitch = math.atan2(-m[2, 0], c * m[0, 0] + s * m[1, 0])
    roll = math.atan2(s * m[0, 2] - c * m[1, 2], c * m[1, 1] - s * m[0, 1])
    return roll, pitch, yaw
