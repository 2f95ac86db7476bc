"""What has a place in a frame? Points (with a radius, spheres), and outlines of bodies.

A new shape of a body is a class here that has a `polygon`: pictures and checks read no more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from qbound.model.rows import Label, Number, Row, Size, Vector

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Point:
    """A point fixed in a frame; with a radius, the centre of a sphere. Lengths."""

    name: str
    frame: str
    at: Array
    radius: float = 0.0

    def row(self) -> PointRow:
        """Return its table of a file."""
        return PointRow.of(self)


class PointRow(Row, kw_only=True):
    """A table [[point]]."""

    name: Label
    frame: Label
    at: Vector
    radius: Size = 0.0

    def point(self) -> Point:
        """Return the point."""
        return Point(self.name, self.frame, np.array(self.at, dtype=float), self.radius)


@dataclass(frozen=True, eq=False)
class Body:
    """Outline of a link in the plane of motion, shape (m, 2): x and z seen from its frame."""

    frame: str
    polygon: Array

    def row(self) -> BodyRow:
        """Return its table of a file."""
        return BodyRow.of(self)


Corner = Annotated[
    list[Number], Meta(min_length=2, max_length=2, description="a list of 2 numbers, x and z")
]


class BodyRow(Row, kw_only=True):
    """A table [[body]]."""

    frame: Label
    polygon: Annotated[
        list[Corner], Meta(min_length=3, description="a list of 3 or more corners [x, z]")
    ]

    def body(self) -> Body:
        """Return the body."""
        return Body(self.frame, np.array(self.polygon, dtype=float))
