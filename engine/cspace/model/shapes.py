"""Points (spheres, if they have a radius) and bodies with a shape, fixed to a frame.

A shape is a class. Distances use its convex `parts`; pictures use its `outline`. A new shape needs
a class and a table here, and a row in `SHAPES`.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from msgspec import UNSET, Meta, UnsetType
from numpy.typing import ArrayLike

import qbound.robot
from cspace.arrays import Array
from cspace.geometry.convex import convex_parts, polygon_fault
from cspace.model.rows import Label, Number, Row, Size, Vector, plain
from cspace.tolerances import CHORD

Y: tuple[float, float, float] = (0.0, 1.0, 0.0)
"""Normal of the plane of x and z, in which an outline is drawn unless another is named."""

CHORDS = 2 * math.ceil(math.pi / CHORD)
"""Chords of a whole circle in an outline: even, and more than an eye can tell apart."""


@dataclass(frozen=True, eq=False)
class Point(qbound.robot.Point):
    """A point of the library; with a radius, the centre of a sphere. Lengths."""

    radius: float = 0.0

    def __post_init__(self) -> None:
        """Check nothing: `robotcheck` has looked at the file."""

    @property
    def covers(self) -> str:
        """The link that this point helps to cover, if it is a ball named LINK/k; else empty."""
        return self.name.rpartition("/")[0] if self.radius else ""

    def row(self) -> "PointRow":
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
class Part:
    """A convex core thickened by a radius: all places no farther than the radius from the core.

    Attributes
    ----------
    corners : ndarray, shape (m, 3)
        Corners seen from the body's frame; length. One corner is a point, two are a segment, three
        or more a strictly convex polygon in order, in either sense.
    radius : float
        Length, at least 0.
    """

    corners: Array
    radius: float = 0.0


@dataclass(frozen=True, eq=False)
class Polygon:
    """A simple polygon, convex or not; `corners` of shape (m, 3) in order, either way round.

    Every shape has the `key` by which a file calls it, the `places` that define it, the convex
    `parts` that together are exactly the shape, their corners as indices of places (`loops`), the
    reason why it is not allowed (`fault`), and the closed `outline` to draw.
    """

    key: ClassVar[str] = "polygon"
    corners: Array

    @classmethod
    def of(cls, corners: Iterable[Sequence[float]], flat: int = 1) -> "Polygon":
        """Make a polygon of corners with three numbers, or two and a 0 as coordinate number `flat`.

        Examples
        --------
        >>> Polygon.of([[0, 0], [2, 0], [2, 1]]).corners.tolist()
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 1.0]]
        """
        return cls(np.array([_place(corner, flat) for corner in corners]))

    @property
    def places(self) -> Array:
        """The corners."""
        return self.corners

    @cached_property
    def parts(self) -> tuple[Part, ...]:  # computed once
        """Convex parts; corners in the middle of a straight edge are left out.

        Raises
        ------
        ValueError
            If the polygon crosses itself or has no area (`fault` says so without raising).
        """
        return tuple(Part(self.corners[list(loop)]) for loop in self.loops)

    @cached_property
    def loops(self) -> tuple[tuple[int, ...], ...]:
        """The corners of each convex part by their numbers; errors as `parts`."""
        return convex_parts(self._flat)

    @property
    def fault(self) -> str | None:
        """Reason why it is not a simple polygon; None if it is."""
        return polygon_fault(self._flat)

    def with_numbers(self, places: Array, radius: Any) -> "Polygon":
        """Return the polygon of other corners."""
        return Polygon(places)

    @staticmethod
    def written(value: Any) -> tuple[Sequence[Sequence[Any]], Any]:
        """Return the corners, and no radius."""
        return value, 0

    @property
    def _flat(self) -> Array:
        """Two coordinates of the corners, shape (m, 2): the shadow along the third coordinate.

        The shadow is convex or simple if the polygon is. Nothing is computed, so nothing is
        rounded.
        """
        still = [k for k in (1, 2, 0) if (self.corners[:, k] == self.corners[0, k]).all()]
        along = still[0] if still else int(np.argmax(np.abs(_newell(self.corners))))
        return np.delete(self.corners, along, axis=1)

    def outline(self, normal: ArrayLike = Y) -> Array:
        """Return the corners; a polygon is its own outline."""
        return self.corners

    def value(self, flat: int) -> list[list[float]]:
        """Return the list of corners."""
        short = not self.corners[:, flat].any()
        return [_written(corner, flat if short else None) for corner in self.corners]


@dataclass(frozen=True, eq=False)
class Capsule:
    """All places within a radius of a segment: a link with round ends."""

    key: ClassVar[str] = "capsule"
    loops: ClassVar[tuple[tuple[int, ...], ...]] = ((0, 1),)
    start: Array
    end: Array
    radius: float

    @property
    def places(self) -> Array:
        """Both ends of the segment, shape (2, 3)."""
        return np.array([self.start, self.end])

    @property
    def parts(self) -> tuple[Part, ...]:
        """The segment with the radius."""
        return (Part(self.places, self.radius),)

    def with_numbers(self, places: Array, radius: Any) -> "Capsule":
        """Return the capsule between two other places."""
        return Capsule(places[0], places[1], radius)

    @staticmethod
    def written(value: Any) -> tuple[Sequence[Sequence[Any]], Any]:
        """Return both ends and the radius."""
        return (value["from"], value["to"]), value["radius"]

    @property
    def fault(self) -> str | None:
        """Fault of a capsule whose two ends are one place."""
        same = np.array_equal(self.start, self.end)
        return "'from' and 'to' are one place: that is a disc" if same else None

    def outline(self, normal: ArrayLike = Y) -> Array:
        """Return two half circles, from `end` to `start`."""
        along = (self.end - self.start) / np.linalg.norm(self.end - self.start)
        side = np.cross(np.asarray(normal, dtype=float), along)
        half = np.linspace(-np.pi / 2, np.pi / 2, 1 + CHORDS // 2)
        bow = self.radius * (np.cos(half)[:, None] * along + np.sin(half)[:, None] * side)
        return np.concatenate([self.end + bow, self.start - bow])

    def value(self, flat: int) -> "CapsuleRow":
        """Return the table of both ends and the radius."""
        start, end = (_written(place, flat) for place in (self.start, self.end))
        return CapsuleRow(start=start, end=end, radius=float(self.radius))


@dataclass(frozen=True, eq=False)
class Disc:
    """A disc in the plane of motion, a sphere in space."""

    key: ClassVar[str] = "disc"
    loops: ClassVar[tuple[tuple[int, ...], ...]] = ((0,),)
    fault: ClassVar[None] = None
    at: Array
    radius: float

    @property
    def places(self) -> Array:
        """The centre, shape (1, 3)."""
        return self.at[None]

    @property
    def parts(self) -> tuple[Part, ...]:
        """The centre with the radius."""
        return (Part(self.places, self.radius),)

    def with_numbers(self, places: Array, radius: Any) -> "Disc":
        """Return the disc about another centre."""
        return Disc(places[0], radius)

    @staticmethod
    def written(value: Any) -> tuple[Sequence[Sequence[Any]], Any]:
        """Return the centre and the radius."""
        return (value["at"],), value["radius"]

    def outline(self, normal: ArrayLike = Y) -> Array:
        """Return a circle."""
        n = np.asarray(normal, dtype=float)
        one = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
        one /= np.linalg.norm(one)
        turn = np.linspace(0, 2 * np.pi, CHORDS, endpoint=False)[:, None]
        other = np.cross(n, one)
        return np.asarray(self.at + self.radius * (np.cos(turn) * one + np.sin(turn) * other))

    def value(self, flat: int) -> "DiscRow":
        """Return the table of centre and radius."""
        return DiscRow(at=_written(self.at, flat), radius=float(self.radius))


Shape = Polygon | Capsule | Disc


@dataclass(frozen=True, eq=False)
class Body:
    """A body fixed in the frame of a link or of the base; an obstacle is a body of the base."""

    name: str
    frame: str
    shape: Shape

    @property
    def parts(self) -> tuple[Part, ...]:
        """Convex parts of its shape."""
        return self.shape.parts


Place = Annotated[
    list[Number],
    Meta(
        min_length=2,
        max_length=3,
        description="a list of 2 numbers in the plane of motion or of 3 in the frame",
    ),
]
"""A place of a body."""


class CapsuleRow(Row, rename={"start": "from", "end": "to"}):
    """The value of the key `capsule`."""

    start: Place
    end: Place
    radius: Size

    def shape(self, flat: int) -> Capsule:
        """Return the capsule."""
        return Capsule(_place(self.start, flat), _place(self.end, flat), self.radius)


class DiscRow(Row):
    """The value of the key `disc`."""

    at: Place
    radius: Size

    def shape(self, flat: int) -> Disc:
        """Return the disc."""
        return Disc(_place(self.at, flat), self.radius)


Corners = Annotated[
    list[Place],
    Meta(min_length=3, max_length=1000, description="a list of 3 to 1000 corners"),
]


class BodyRow(Row, kw_only=True):
    """A table [[body]]."""

    frame: Label
    polygon: Corners | UnsetType = UNSET
    name: Label | UnsetType = UNSET
    capsule: CapsuleRow | UnsetType = UNSET
    disc: DiscRow | UnsetType = UNSET


class ObstacleRow(Row, kw_only=True):
    """A table [[obstacle]]."""

    polygon: Corners | UnsetType = UNSET
    name: Label | UnsetType = UNSET
    capsule: CapsuleRow | UnsetType = UNSET
    disc: DiscRow | UnsetType = UNSET


def row_shape(row: BodyRow | ObstacleRow, flat: int) -> Shape:
    """Return the one shape of a table; places with two numbers have coordinate `flat` 0."""
    if row.polygon is not UNSET:
        return Polygon.of(row.polygon, flat)
    round_one = row.capsule or row.disc
    assert round_one is not UNSET  # `robotcheck` asks for exactly one
    return round_one.shape(flat)


SHAPES = tuple(cls.key for cls in (Polygon, Capsule, Disc))
"""Keys of a body of which exactly one must be there."""


def default_names(frames: Sequence[str]) -> list[str]:
    """Return the name of each body without one: its frame's, then frame/2, frame/3 and so on."""
    earlier = [frames[:i].count(frame) for i, frame in enumerate(frames)]
    return [f"{f}/{k + 1}" if k else f for f, k in zip(frames, earlier, strict=True)]


def _place(numbers: Sequence[float], flat: int) -> Array:
    """Return a place of the frame, shape (3,)."""
    if len(numbers) < 3:
        numbers = [*numbers[:flat], 0.0, *numbers[flat:]]
    return np.array(numbers, dtype=float)


def _written(place: Array, flat: int | None) -> list[float]:
    """Return a place without coordinate `flat` if that is 0, else with all three."""
    if flat is not None and place[flat] == 0:
        place = np.delete(place, flat)
    numbers: list[float] = plain(place)
    return numbers


def _newell(corners: Array) -> Array:
    """Return the normal of a polygon, as long as twice its area."""
    p = corners - corners[0]
    return np.asarray(np.cross(p, np.roll(p, -1, axis=0)).sum(axis=0))
