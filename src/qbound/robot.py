"""A robot as the paper describes one: joints in a chain, points on its links, and boundaries.

Angles are in radians and lengths in the robot's own unit. A change is a new robot:
`dataclasses.replace` puts another joint, point or boundary in place of one.

Examples
--------
A third boundary on link 2: its new point 14 keeps 0.5 cm apart from point 10 of link 1. (A region
of the distances, `region.clearance_region`, reads the 0.5. The windows of Table 6 do not.)

>>> from dataclasses import replace
>>> from qbound import Pair, Point, load_robot
>>> robot = load_robot("minervabot-v2")
>>> robot = replace(
...     robot,
...     points=(*robot.points, Point("14", "2", [25.0, 0.0, -5.25])),
...     boundaries=(*robot.boundaries, Pair("B8", ("10", "14"), clearance=0.5)),
... )
>>> robot.boundary("B8").points
('10', '14')

Or that corner of link 2 keeps above z = 11.32, as the tool does:

>>> from qbound import HalfSpace
>>> wall = HalfSpace("B9", "14", normal=[0, 0, 1], offset=11.32)
>>> replace(robot, boundaries=(*robot.boundaries, wall)).used_half_spaces[-1].point
'14'

A second joint that slides along link 1's x axis instead of turning:

>>> joint = replace(robot.joints[1], kind="prismatic", axis=[1, 0, 0], limits=(0.0, 20.0))
>>> replace(robot, joints=(robot.joints[0], joint)).kinds
('revolute', 'prismatic')
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Array, cross_matrix, unit_vector, vector
from qbound.forms import HarmonicForm, Kind, combine, constant
from qbound.frames import IDENTITY, Frame, Frames, axis_rotation


@dataclass(frozen=True, eq=False)
class PointForms:
    """The position u of a point, seen from some frame, as forms in the joint values.

    Attributes
    ----------
    position : HarmonicForm, stack (3,)
        x, y and z of u.
    squared : HarmonicForm
        The squared length of u. It has no products such as cos² q, because a rotation keeps
        lengths: each joint adds only twice a dot product.
    """

    position: HarmonicForm
    squared: HarmonicForm


@dataclass(frozen=True, eq=False)
class Motion:
    """A frame that one joint moves in its parent frame. Each kind of motion is a class.

    Each class says how the joint moves, once for given joint values (`frame_at`) and once for forms
    in all joint values (`moved`).

    Attributes
    ----------
    joint : int
        Number of the joint in the chain, from 0.
    parent, frame : str
        Labels a and b.
    kinds : tuple of {"revolute", "prismatic"}
        Kinds of all joints of the chain; forms have one axis for each.
    origin : ndarray, shape (3,)
        From a to b at joint value 0, seen from a.
    mount : ndarray, shape (3, 3)
        Rotation of b, seen from a, at joint value 0.
    axis : ndarray, shape (3,)
        Unit vector along the joint's axis, seen from frame b.
    """

    joint: int
    parent: str
    frame: str
    kinds: tuple[Kind, ...]
    origin: Array
    mount: Array
    axis: Array

    def frame_at(self, q: Array) -> Frame:
        """Return the frame at values q of the joint, shape (...) (Table 2)."""
        raise NotImplementedError

    def moved(self, point: PointForms) -> PointForms:
        """Move a point of the frame by the joint; it is then seen from the frame's pose at 0."""
        raise NotImplementedError

    def seen_from_parent(self, point: PointForms) -> PointForms:
        r"""Return the forms of a point of the frame, seen from the parent (eqs. 18, 20).

        .. math:: u_a = r_{a,b} + R\,u, \qquad |u_a|^2 = |u|^2 + 2\,r_{a,b} \cdot R\,u + |r_{a,b}|^2

        Examples
        --------
        The tool, 25 in front of joint 2, seen from frame 1 at the home pose:

        >>> from qbound import load_robot
        >>> from qbound.forms import constant
        >>> from qbound.robot import PointForms
        >>> robot = load_robot("minervabot-v2")
        >>> tool = PointForms(constant([25.0, 0, 0], robot.kinds), constant(625.0, robot.kinds))
        >>> robot.motions["2"].seen_from_parent(tool).position([0.0, 0.0]).tolist()
        [40.0, 0.0, 25.98]
        """
        point = self.moved(point)
        turned = point.position.dot(self.mount)
        squared = point.squared + 2 * turned.dot(self.origin) + self.origin @ self.origin
        return PointForms(turned + self.origin, squared)


class Turn(Motion):
    """A turn about the axis."""

    def frame_at(self, q: Array) -> Frame:
        """Return the frame, turned by q rad."""
        rotation = self.mount @ axis_rotation(self.axis, q)
        return Frame(self.frame, self.parent, rotation, self.origin)

    def moved(self, point: PointForms) -> PointForms:
        """Turn u by Rodrigues' formula: k (k . u) + cos q (u - k (k . u)) + sin q (k x u).

        The length of u stays.
        """
        along = point.position.dot(np.outer(self.axis, self.axis))
        across = point.position - along
        sideways = point.position.dot(cross_matrix(self.axis))
        return PointForms(combine(self.joint, along, across, sideways), point.squared)


class Slide(Motion):
    """A slide along the axis."""

    def frame_at(self, q: Array) -> Frame:
        """Return the frame, moved by the length q."""
        moved = np.asarray(q)[..., None] * (self.mount @ self.axis)
        return Frame(self.frame, self.parent, self.mount, self.origin + moved)

    def moved(self, point: PointForms) -> PointForms:
        r"""Add q times the axis k to u: :math:`|u + q k|^2 = |u|^2 + 2 q\, k \cdot u + q^2`."""
        none, axis = constant(0 * self.axis, self.kinds), constant(self.axis, self.kinds)
        position = combine(self.joint, point.position, axis, none)
        twice, one = 2 * point.position.dot(self.axis), constant(1, self.kinds)
        return PointForms(position, combine(self.joint, point.squared, twice, one))


MOTIONS: dict[Kind, type[Motion]] = {"revolute": Turn, "prismatic": Slide}


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint that turns or slides `frame` relative to `parent`.

    Attributes
    ----------
    name : str
        Such as ``q1``.
    parent, frame : str
        Labels of the frames before and after the joint.
    origin : ndarray, shape (3,)
        From the parent to the frame at joint value 0, seen from the parent (Table 1).
    axis : ndarray, shape (3,)
        Direction of the axis, seen from the joint's frame; it is made a unit vector.
    kind : {"revolute", "prismatic"}
        Whether the joint turns or slides.
    limits : tuple of float, optional
        Lowest and highest value, rad or length (eq. 10).
    mount : ndarray, shape (3, 3)
        Rotation of the frame, seen from the parent, at joint value 0; default: none, as in the
        paper (Table 2).

    Raises
    ------
    ValueError
        If the kind is unknown, the limits do not ascend, the axis is zero or a number is not
        finite.

    Examples
    --------
    >>> from qbound import Joint
    >>> Joint("q1", "0", "1", origin=[0, 0, 22.5], axis=[0, 2, 0]).axis.tolist()
    [0.0, 1.0, 0.0]
    """

    name: str
    parent: str
    frame: str
    origin: Array
    axis: Array
    kind: Kind = "revolute"
    limits: tuple[float, float] | None = None
    mount: Array = field(default_factory=lambda: IDENTITY)

    def __post_init__(self) -> None:
        """Check the kind, the limits and the vectors."""
        if self.kind not in MOTIONS:
            raise ValueError(
                f"joint {self.name}: the kind {self.kind!r} is neither revolute nor prismatic"
            )
        limits = (0, 1) if self.limits is None else self.limits
        if np.shape(limits) != (2,) or not limits[0] < limits[1]:
            raise ValueError(f"joint {self.name}: limits {limits} do not ascend from low to high")
        _set(self, "origin", vector(self.origin, f"joint {self.name}: origin"))
        _set(self, "axis", unit_vector(self.axis, f"joint {self.name}: axis"))

    @property
    def turns(self) -> bool:
        """Whether the joint turns."""
        return self.kind == "revolute"

    @property
    def range(self) -> tuple[float, float]:
        """Lowest and highest value, which are the limits, or without limits -pi and pi.

        Raises
        ------
        ValueError
            If the joint slides and has no limits.
        """
        if self.limits is not None:
            return self.limits
        if not self.turns:
            raise ValueError(f"joint {self.name} slides and has no limits")
        return -np.pi, np.pi

    def motions(self, index: int, kinds: tuple[Kind, ...]) -> Iterator[Motion]:
        """Yield the motion of the joint: `index` is its number, `kinds` are those of the chain."""
        motion = MOTIONS[self.kind]
        yield motion(index, self.parent, self.frame, kinds, self.origin, self.mount, self.axis)


@dataclass(frozen=True, eq=False)
class Point:
    """A point fixed in a frame: its position `at`, shape (3,), seen from that frame.

    Examples
    --------
    >>> from qbound import Point
    >>> Point("7", "1", [11.5, 0, 4.91]).at.tolist()
    [11.5, 0.0, 4.91]
    """

    name: str
    frame: str
    at: Array

    def __post_init__(self) -> None:
        """Check the vector."""
        _set(self, "at", vector(self.at, f"point {self.name}: at"))


@dataclass(frozen=True)
class Pair:
    """Two points that keep at least the distance `clearance` apart, d_min of eq. (11) (Theorem 1).

    A window (Table 6) asks when a component of the vector between the points vanishes. So the
    clearance does not change a window; it changes margins and the region of the distances.

    Attributes
    ----------
    name : str
        Such as ``B1``: boundary i = 1 of the paper.
    points : tuple of str
        Names of the two points, or of frames for their origins. The order is the direction of the
        vector between them.
    clearance : float
        Not negative, in the robot's unit of length.
    used : bool
        False for a boundary that is drawn and does not bound the region.

    Raises
    ------
    ValueError
        If there are not two points, or the clearance is negative or not finite.

    Examples
    --------
    >>> from qbound import Pair
    >>> Pair("B1", ("6", "7"), clearance=0.1).clearance
    0.1
    """

    name: str
    points: tuple[str, str]
    clearance: float = 0.0
    used: bool = True

    def __post_init__(self) -> None:
        """Check that there are two points, and the distance."""
        if np.shape(self.points) != (2,):
            raise ValueError(f"boundary {self.name}: points must be two names: {self.points!r}")
        if not 0 <= self.clearance < np.inf:
            raise ValueError(
                f"boundary {self.name}: clearance must not be negative, and must be finite: "
                f"{self.clearance}"
            )


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """A point whose position r, seen from the base, keeps ``n . r >= o`` (eq. 12, Table 5).

    Attributes
    ----------
    name : str
        Such as ``B7``.
    point : str
        Name of a point, or of a frame for its origin.
    normal : ndarray, shape (3,)
        The vector n, towards the allowed side; it is made a unit vector. An upper limit such as
        ``x <= 40`` has the normal (-1, 0, 0) and the offset -40.
    offset : float
        The length o, in the robot's unit.
    used : bool
        False for a boundary that is drawn and does not bound the region.

    Raises
    ------
    ValueError
        If the normal is zero, or a number is not finite.

    Examples
    --------
    >>> from qbound import HalfSpace
    >>> HalfSpace("B7", "3", normal=[0, 0, 2], offset=11.32).normal.tolist()
    [0.0, 0.0, 1.0]
    """

    name: str
    point: str
    normal: Array
    offset: float
    used: bool = True

    def __post_init__(self) -> None:
        """Check the vector and the offset."""
        _set(self, "normal", unit_vector(self.normal, f"boundary {self.name}: normal"))
        offset = np.asarray(self.offset)
        if offset.dtype != object and not np.isfinite(offset):
            raise ValueError(f"boundary {self.name}: offset must be finite: {self.offset}")


Boundary = Pair | HalfSpace


@dataclass(frozen=True, eq=False)
class Outline:
    """The outline of a link: corners of a polygon, shape (m, 3), seen from its frame."""

    frame: str
    corners: Array


@dataclass(frozen=True, eq=False)
class Robot:
    """A chain of joints with points and boundaries.

    Attributes
    ----------
    length_unit : str
        Such as ``cm``: the unit of every length of the robot.
    joints : tuple of Joint
        From the base on; the parent of the first joint is the base.
    points : tuple of Point
        On the links and on the base.
    boundaries : tuple of Pair or HalfSpace
    tool : str
        Name of the point or frame that works.
    home : tuple of float
        The home pose: joint values, rad or length.
    outlines : tuple of Outline
        Of the links. They are drawn, never checked.

    Raises
    ------
    ValueError
        If a name is used twice or is unknown, or home does not have one finite value for each
        joint. Points and frames share their names; so do joints and boundaries, because both name
        bounds of the region.

    Examples
    --------
    One link of 25 cm that turns about y, 22.5 cm above the base:

    >>> from qbound import Joint, Point, Robot
    >>> link = Joint("q1", "0", "1", origin=[0, 0, 22.5], axis=[0, 1, 0])
    >>> robot = Robot("one link", "cm", (link,), (Point("3", "1", [0, 0, 25]),), (), "3", (0.0,))
    >>> from qbound import position
    >>> position(robot)(robot.home).tolist()
    [0.0, 0.0, 47.5]
    """

    name: str
    length_unit: str
    joints: tuple[Joint, ...]
    points: tuple[Point, ...]
    boundaries: tuple[Boundary, ...]
    tool: str
    home: tuple[float, ...]
    outlines: tuple[Outline, ...] = ()

    def __post_init__(self) -> None:
        """Check the home pose, and that every name is there once."""
        if not self.joints:
            raise ValueError(f"{self.name} has no joint")
        if np.shape(self.home) != (len(self.joints),) or not np.isfinite(self.home).all():
            raise ValueError(f"home must be {len(self.joints)} finite joint values: {self.home}")
        frames = [self.base, *self.motions]
        labels = frames + [point.name for point in self.points]
        for names in (labels, [bounding.name for bounding in (*self.joints, *self.boundaries)]):
            for name in names:
                if names.count(name) > 1:
                    raise ValueError(f"the name {name!r} is used twice")
        # Each name with where it stands and the names that it may be.
        named = [("tool", self.tool, labels)]
        named += [(f"point {point.name}", point.frame, frames) for point in self.points]
        named += [("body", outline.frame, frames) for outline in self.outlines]
        for boundary in self.boundaries:
            what = f"boundary {boundary.name}"
            if isinstance(boundary, Pair):
                named += [(what, name, labels) for name in boundary.points]
            elif isinstance(boundary, HalfSpace):
                named += [(what, boundary.point, labels)]
        for what, name, known in named:
            if name not in known:
                raise ValueError(
                    f"{what}: no point or frame {name!r}; there are {', '.join(known)}"
                )

    @property
    def base(self) -> str:
        """Label of the base frame."""
        return self.joints[0].parent

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """Kind of each joint."""
        return tuple(joint.kind for joint in self.joints)

    @cached_property
    def motions(self) -> dict[str, Motion]:
        """The motions of the chain by the frame that each moves, from the base on."""
        moved: dict[str, Motion] = {}
        for index, joint in enumerate(self.joints):
            for motion in joint.motions(index, self.kinds):
                if motion.parent not in (self.base, *moved):
                    raise ValueError(f"joint {joint.name}: no frame {motion.parent!r} before it")
                if motion.frame in (self.base, *moved):
                    raise ValueError(f"the name {motion.frame!r} is used twice")
                moved[motion.frame] = motion
        return moved

    @property
    def used(self) -> tuple[Boundary, ...]:
        """The boundaries that bound the region; the others are only drawn."""
        return tuple(boundary for boundary in self.boundaries if boundary.used)

    @property
    def used_pairs(self) -> tuple[Pair, ...]:
        """The pairs of points that bound the region."""
        return tuple(boundary for boundary in self.used if isinstance(boundary, Pair))

    @property
    def used_half_spaces(self) -> tuple[HalfSpace, ...]:
        """The half-spaces that bound the region."""
        return tuple(boundary for boundary in self.used if isinstance(boundary, HalfSpace))

    def point(self, name: str) -> Point:
        """Return the point of that name, or the origin of the frame of that name."""
        if name in (self.base, *self.motions):
            return Point(name, name, np.zeros(3))
        found: Point = _named("point", self.points, name)
        return found

    def boundary(self, name: str) -> Any:
        """Return the boundary of that name, a Pair or a HalfSpace."""
        return _named("boundary", self.boundaries, name)

    def chain(self, frame: str, observer: str | None = None) -> list[Motion]:
        """Return the motions from a frame back to an observer that carries it (eq. 5).

        Parameters
        ----------
        frame : str
            Label of the frame; its own motion is the first.
        observer : str, optional
            Label of a frame before it in the chain; default: the base.

        Raises
        ------
        ValueError
            If the observer does not precede the frame.

        Examples
        --------
        >>> from qbound import load_robot
        >>> [motion.frame for motion in load_robot("minervabot-v2").chain("2")]
        ['2', '1']
        """
        found: list[Motion] = []
        here = frame
        while here != (observer or self.base):
            if here not in self.motions:
                known = ", ".join([self.base, *self.motions])
                end = observer or self.base
                raise ValueError(f"{end!r} does not precede {frame!r}; the frames are {known}")
            found.append(self.motions[here])
            here = found[-1].parent
        return found

    def frames(self, q: ArrayLike) -> Frames:
        """Return every joint's frame and every point as a frame: forward kinematics (Table 2).

        Parameters
        ----------
        q : array_like, shape (..., n)
            Joint values, rad or length, or SymPy expressions.

        Examples
        --------
        >>> from qbound import load_robot
        >>> frames = load_robot("minervabot-v2").frames([0.0, 0.0])
        >>> frames.position("0", "3", observer="0").tolist()
        [40.0, 0.0, 48.480000000000004]
        """
        values = np.asarray(q)
        if values.shape[-1:] != (len(self.joints),):
            raise ValueError(f"expected {len(self.joints)} joint values, found {values.shape}")
        moved = [motion.frame_at(values[..., motion.joint]) for motion in self.motions.values()]
        points = [Frame(point.name, point.frame, IDENTITY, point.at) for point in self.points]
        return Frames(self.base, [*moved, *points])


def _named(what: str, items: Sequence[Any], name: str) -> Any:
    """Return the item of that name; `what` it is stands in the message if there is none."""
    for item in items:
        if item.name == name:
            return item
    raise ValueError(f"no {what} {name!r}; there are {', '.join(item.name for item in items)}")


def _set(record: Any, name: str, value: Any) -> None:
    """Set a field of a frozen record while it is made."""
    object.__setattr__(record, name, value)
