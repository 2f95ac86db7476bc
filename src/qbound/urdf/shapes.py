"""What may collide? The shapes of a URDF as data; lengths in metres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from qbound.urdf.poses import Pose
from qbound.urdf.xml import Element

Floats = NDArray[np.float64]


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


Solid = Sphere | Capsule | Cylinder | Box | Mesh


@dataclass(frozen=True, eq=False)
class Collision:
    """A shape of a link and where it stands."""

    pose: Pose
    solid: Solid
    element: Element
