"""Collision shapes of a URDF as data; lengths in metres."""

from __future__ import annotations

from dataclasses import dataclass

from qbound.arrays import Floats
from qbound.urdf.poses import Pose
from qbound.urdf.xml import Element, Source


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
class Box:
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


Solid = Sphere | Capsule | Cylinder | Box | Mesh | Triangles


@dataclass(frozen=True, eq=False)
class Collision:
    """A shape of a link, where it stands, and what of the file it was read from."""

    pose: Pose
    solid: Solid
    element: Element
