"""Types of boundaries, a class for each: pairs of points or bodies, and half-spaces.

A new type needs a class and a table here, and its forms in `boundary.functions`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, Self

from msgspec import UNSET, Meta, UnsetType

import qbound.robot
from cspace.model.rows import Direction, Label, Number, Row, Size, plain, unit_vector
from cspace.model.shapes import Point

Source = Mapping[str, Any]
Convert = Callable[[Any], Any]
Find = Callable[[str], Point]


@dataclass(frozen=True, eq=False)
class Boundary(ABC):
    """The interface of every boundary: a name, whether it is in use, and a clearance form."""

    name: str

    @property
    @abstractmethod
    def used(self) -> bool:
        """Whether the boundary bounds the region; if not, it is only drawn."""

    @abstractmethod
    def least_distance(self, point: Find) -> float | None:
        r"""Return :math:`d_{\min}` if the form is :math:`|B|^2 - d_{\min}^2`; else None.

        If None, the form is the margin itself, a length. `point` finds a point by its name.
        """

    @abstractmethod
    def with_extra_clearance(self, length: float) -> "Boundary":
        """Return the boundary with a larger required distance."""

    @abstractmethod
    def with_numbers(self, source: Source, number: Convert, direction: Convert) -> "Boundary":
        """Return the boundary with its numbers, or those of a table, converted to another kind."""

    @abstractmethod
    def row(self) -> Row:
        """Return its table of a file."""


class Apart(Boundary):
    """Base of the two types that keep two things apart: a clearance."""

    clearance: float

    def with_extra_clearance(self, length: float) -> Self:
        """Return the boundary with a larger clearance."""
        return replace(self, clearance=self.clearance + length)  # type: ignore[call-arg]

    def with_numbers(self, source: Source, number: Convert, direction: Convert) -> Self:
        """Convert the clearance."""
        return replace(self, clearance=number(source.get("clearance", 0)))  # type: ignore[call-arg]


@dataclass(frozen=True)
class Pair(qbound.robot.Pair, Apart):
    """Point boundary function: feasible where the points keep apart (Theorem 1, eq. 11)."""

    def __post_init__(self) -> None:
        """Check nothing: `robotcheck` has looked at the file."""

    def least_distance(self, point: Find) -> float:
        """Return both radii plus the clearance."""
        return sum(point(name).radius for name in self.points) + self.clearance

    def row(self) -> "PairRow":
        """Return its table [[boundary]]."""
        return PairRow.of(self)


@dataclass(frozen=True)
class BodyPair(Apart):
    """Two bodies: feasible where they are at least the clearance apart. It has no single form."""

    bodies: tuple[str, str]
    clearance: float = 0.0
    used: bool = True

    def least_distance(self, point: Find) -> None:
        """Return None: its margin is a length."""

    def row(self) -> "BodyPairRow":
        """Return its table [[boundary]]."""
        return BodyPairRow.of(self)


@dataclass(frozen=True, eq=False)
class HalfSpace(qbound.robot.HalfSpace, Boundary):
    """Geometric boundary function: feasible where normal . r >= offset + radius (eq. 12).

    A half-space keeps a point on its side, or every place of a body. For a body, `body` is its
    name, `point` is empty, and there is no single form.
    """

    body: str | None = None

    def __post_init__(self) -> None:
        """Refuse a half-space that bounds both a point and a body, or neither."""
        if bool(self.point) == (self.body is not None):
            raise ValueError(f"{self.name}: a half-space keeps one point or one body on its side")

    def least_distance(self, point: Find) -> None:
        """Return None: its form is the height over the wall."""

    def with_extra_clearance(self, length: float) -> "HalfSpace":
        """Move the wall inwards."""
        return replace(self, offset=self.offset + length)

    def with_numbers(self, source: Source, number: Convert, direction: Convert) -> "HalfSpace":
        """Convert normal and offset."""
        return replace(self, normal=direction(source["normal"]), offset=number(source["offset"]))

    def row(self) -> "HalfSpaceRow":
        """Return its table [[boundary]]."""
        what = {"point": self.point} if self.body is None else {"body": self.body}
        normal, offset = plain(self.normal), plain(self.offset)
        return HalfSpaceRow(name=self.name, normal=normal, offset=offset, used=self.used, **what)


TWO_POINTS = "a list of the names of 2 different points"
TWO_BODIES = "a list of the names of 2 different bodies"
DIFFERENT = partial(Meta, min_length=2, max_length=2, extra_json_schema={"uniqueItems": True})


class PairRow(Row, kw_only=True, tag_field="type", tag="pair"):
    """A table [[boundary]] of type "pair"."""

    name: Label
    used: bool = True
    points: Annotated[list[Label], DIFFERENT(description=TWO_POINTS)]
    clearance: Size = 0.0

    def boundary(self) -> Pair:
        """Return the boundary."""
        first, second = self.points
        return Pair(self.name, (first, second), self.clearance, self.used)


class HalfSpaceRow(Row, kw_only=True, tag_field="type", tag="half-space"):
    """A table [[boundary]] of type "half-space"."""

    name: Label
    used: bool = True
    point: Label | UnsetType = UNSET
    normal: Direction
    offset: Number
    body: Label | UnsetType = UNSET

    def boundary(self) -> HalfSpace:
        """Return the boundary."""
        normal = unit_vector(self.normal)
        body = None if self.body is UNSET else self.body
        return HalfSpace(self.name, self.point or "", normal, self.offset, self.used, body)


class BodyPairRow(Row, kw_only=True, tag_field="type", tag="bodies"):
    """A table [[boundary]] of type "bodies"."""

    name: Label
    used: bool = True
    bodies: Annotated[list[Label], DIFFERENT(description=TWO_BODIES)]
    clearance: Size = 0.0

    def boundary(self) -> BodyPair:
        """Return the boundary."""
        first, second = self.bodies
        return BodyPair(self.name, (first, second), self.clearance, self.used)


BoundaryRow = PairRow | HalfSpaceRow | BodyPairRow
"""Every table [[boundary]]."""
