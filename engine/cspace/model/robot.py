"""A robot as data: joints, points, boundaries, and its frames at given joint values (Table 2).

An arm is planar if the axes of all turning joints are parallel and every slide runs at right
angles to them. A turn about such an axis keeps the direction of the axis. So a property of
directions that holds at all joint values 0 holds at every configuration.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, fields, is_dataclass
from functools import cached_property
from itertools import combinations, product
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

import qbound
from cspace.arguments import refuse_type
from cspace.arrays import Array
from cspace.model.boundaries import BodyPair, Boundary, HalfSpace, Pair
from cspace.model.joints import JOINT_TYPES, Joint, Parallelogram, Prismatic, Revolute, Step
from cspace.model.schema import one_line
from cspace.model.shapes import Body, Capsule, Disc, Part, Point, Polygon, Shape
from qbound.forms import Kind
from qbound.frames import IDENTITY, Frames
from qbound.robot import Motion, Turn

if TYPE_CHECKING:
    from cspace.model.source import Source

from cspace.arrays import cross
from cspace.order import first_largest
from cspace.tolerances import ZERO_AMPLITUDE

__all__ = [
    "JOINT_TYPES",
    "Body",
    "BodyPair",
    "Boundary",
    "Capsule",
    "Disc",
    "HalfSpace",
    "Held",
    "Joint",
    "Kind",
    "Pair",
    "Parallelogram",
    "Part",
    "PlaneOfMotion",
    "Point",
    "Polygon",
    "Prismatic",
    "Revolute",
    "Robot",
    "Shape",
    "Step",
]

Held = Mapping[int, float] | Mapping[str, float] | Mapping[int | str, float]
"""Values of joints that are held, rad or length, by index or by name."""

Item = TypeVar("Item")


@dataclass(frozen=True, eq=False, repr=False)
class Robot(qbound.Robot):
    """A robot as its file describes it, in the file's length unit and in radians.

    It is a robot of the library, so the functions of `qbound.boundary` take it, with bodies and
    obstacles, and points that may be centres of spheres.

    Examples
    --------
    >>> from cspace import load_robot
    >>> robot = load_robot("pr-gantry-arm")
    >>> [(joint.name, joint.type_name, joint.limits) for joint in robot.joints]
    [('cart', 'prismatic', (-2.0, 2.0)), ('arm', 'revolute', None)]
    >>> robot.length_unit, robot.tool
    ('m', 'hand')

    A robot does not change; `dataclasses.replace` makes another one:

    >>> from dataclasses import replace
    >>> replace(robot, tool="elbow").tool
    'elbow'

    Robots are equal, and have one hash, where their content is the same:

    >>> robot == load_robot("pr-gantry-arm"), robot == replace(robot, tool="elbow")
    (True, False)

    `boundaries` are those that a file names; `used` has all that bound the region, with the pairs
    of bodies that `collisions` makes.

    >>> arm = load_robot("two-links-on-a-table")
    >>> len(arm.boundaries), len(arm.used)
    (0, 8)

    What *feasible* means depends on the file. `feasible_by` names what its boundaries are about,
    and `unchecked` the pairs of links, and of links and obstacles, that no boundary keeps apart.
    `left_out` names links of the arm that the file does not describe. Answers repeat all three.
    Where `whole_links` is true, a feasible configuration is safe.

    >>> minerva = load_robot("minervabot-v2")
    >>> minerva.feasible_by, minerva.unchecked
    ('points', (('0', '1'), ('0', '2'), ('1', '2')))
    >>> whole = load_robot("minervabot-v2-bodies")
    >>> whole.feasible_by, whole.unchecked, whole.whole_links
    ('points and bodies', (), True)

    `source` keeps what the robot was read from, for exact numbers. It is not compared
    (`cspace.model.exact`).
    """

    joints: tuple[Joint, ...]
    points: tuple[Point, ...]
    boundaries: tuple[Boundary, ...]  # type: ignore[assignment]  # pairs of bodies too
    home: Array  # type: ignore[assignment]
    _: KW_ONLY
    angle_unit: str
    bodies: tuple[Body, ...] = ()
    obstacles: tuple[Body, ...] = ()
    collisions: bool = False
    clearance: float = 0.0
    allowed: tuple[frozenset[str], ...] = ()
    left_out: tuple[str, ...] = ()
    source: Source | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        """Check nothing: `robotcheck` has looked at the file."""

    def __repr__(self) -> str:
        """Show name, joints with kinds, number of boundaries and of pairs of bodies on one line."""
        count = len(self.boundaries)
        made = len(self.used) - sum(boundary.used for boundary in self.boundaries)
        joints = one_line(", ".join(f"{joint.name} ({joint.type_name})" for joint in self.joints))
        bounds = [f"{count} boundar{'y' if count == 1 else 'ies'}"] * (count > 0 or not made)
        bounds += [f"{made} pair{'s' * (made != 1)} of bodies"] * (made > 0)
        return f"<Robot {one_line(self.name)}: {joints}; {' and '.join(bounds)}>"

    def __eq__(self, other: object) -> bool:
        """Compare all attributes except `source`."""
        if not isinstance(other, Robot):
            return NotImplemented
        return self is other or self._content == other._content

    def __hash__(self) -> int:
        """Return a number that equal robots share."""
        return self._hash

    def __getstate__(self) -> dict[str, Any]:
        """Leave out cached values, because the hash of a text differs from process to process."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def _content(self) -> Any:
        return _comparable(self)

    @cached_property
    def _hash(self) -> int:
        return hash(self._content)

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The motions of its chain, from the base on; each has a frame of its own."""
        return tuple(step for j, joint in enumerate(self.joints) for step in joint.steps(j))

    def steps_to(self, frame: str) -> int:
        """Count the steps between the base and a frame; ValueError if there is no such frame."""
        return _named("frame", self._steps_to, frame)

    @cached_property
    def _steps_to(self) -> dict[str, int]:
        moved = (step.frame for step in self.steps)
        return {frame: k for k, frame in enumerate((self.base, *moved))}

    @cached_property
    def plane(self) -> PlaneOfMotion:
        """The plane in which the arm moves; ValueError if it leaves every plane."""
        return plane_of_motion(self)

    @cached_property
    def used(self) -> tuple[Boundary, ...]:  # type: ignore[override]  # pairs of bodies too
        """Every boundary that bounds the region.

        Those of the file that are in use, in its order; then, where `collisions` asks for them,
        the pairs of bodies: the body nearer to the base first, obstacles last.
        """
        used = [boundary for boundary in self.boundaries if boundary.used]
        return (*used, *(self._colliding() if self.collisions else ()))

    def _colliding(self) -> Iterator[BodyPair]:
        """Yield a pair for every two bodies that can meet but must not and have no boundary."""
        links = sorted(self.bodies, key=lambda body: self.steps_to(body.frame))
        settled = {frozenset(b.bodies) for b in self.boundaries if isinstance(b, BodyPair)}
        settled |= set(self.allowed)
        for one, other in combinations([*links, *self.obstacles], 2):
            names = (one.name, other.name)
            if one.frame != other.frame and frozenset(names) not in settled:
                yield BodyPair(", ".join(names), names, self.clearance)

    @property
    def feasible_by(self) -> str:
        """What *feasible* looks at: "points", "spheres" that cover links, "bodies", or several.

        The kinds of things that the boundaries in use are about, joined as in "points and bodies";
        "joint limits" if no boundary is in use.
        """
        about = set[str]()
        for boundary in self.used:
            if isinstance(boundary, BodyPair) or (
                isinstance(boundary, HalfSpace) and boundary.body is not None
            ):
                about.add("bodies")
            elif isinstance(boundary, Pair | HalfSpace):
                points = boundary.points if isinstance(boundary, Pair) else [boundary.point]
                about |= {"spheres" if self.point(name).covers else "points" for name in points}
        ordered = [kind for kind in ("points", "spheres", "bodies") if kind in about]
        return " and ".join(ordered) or "joint limits"

    @property
    def whole_links(self) -> bool:
        """Whether a feasible configuration is safe.

        That is: the base and every moving frame have a body, the file leaves no link out, and
        boundaries keep every two links apart, and each link from every obstacle.
        """
        shaped = {body.frame for body in self.bodies}
        described = shaped.issuperset((self.base, *self._moving)) and not self.left_out
        return described and not self.unchecked

    @cached_property
    def unchecked(self) -> tuple[tuple[str, str], ...]:
        """Pairs of links, and of links and obstacles, that boundaries do not keep apart.

        A link is a body, or all balls LINK/k that cover it; such a pair is also named if only some
        of its balls are kept apart. In a file with bodies or obstacles a moving frame without any
        shape is a link too, of that name. Links on one frame are not named, because no joint
        changes their distance.
        """
        links: dict[tuple[str, str], list[Point | Body]] = {}
        for point in self.points:
            if point.covers:
                links.setdefault(("ball", point.covers), []).append(point)
        links |= {("body", body.name): [body] for body in self.bodies}
        if self.bodies or self.obstacles:
            shaped = {thing.frame for things in links.values() for thing in things}
            bare = [frame for frame in self._moving if frame not in shaped]
            links |= {("frame", name): [Point(name, name, np.zeros(3))] for name in bare}
        obstacles = {("body", body.name): [body] for body in self.obstacles}
        kept = {("ball", frozenset(b.points)) for b in self.used if isinstance(b, Pair)}
        kept |= {("body", frozenset(b.bodies)) for b in self.used if isinstance(b, BodyPair)}
        return tuple(
            (one, other)
            for (kind, one), (other_kind, other) in [
                *combinations(links, 2),
                *product(links, obstacles),
            ]
            if any(
                a.frame != b.frame
                and (kind != other_kind or (kind, frozenset((a.name, b.name))) not in kept)
                for a in links[kind, one]
                for b in links.get((other_kind, other)) or obstacles[other_kind, other]
            )
        )

    @property
    def _moving(self) -> list[str]:
        return [step.frame for step in self.steps]

    @property
    def reach(self) -> float:
        """Upper bound of the distance of all points from the base's origin; length."""
        return max((self.stretched(point.name) for point in self.points), default=0.0)

    def stretched(self, point: str) -> float:
        """Return the length of the arm stretched out to a point: links, longest slides, the rest.

        The point is never farther than this from the base.
        """
        links = [float(np.linalg.norm(joint.origin)) for joint in self.joints]
        slides = [joint.farthest for joint in self.joints]
        return sum(links) + sum(slides) + float(np.linalg.norm(self.point(point).at))

    def point(self, name: str) -> Point:
        """Return the point of that name."""
        return _named("point", self._points, name)

    @cached_property
    def _points(self) -> dict[str, Point]:
        return {point.name: point for point in self.points}

    def body(self, name: str) -> Body:
        """Return the body, of a link or an obstacle, of that name."""
        return _named("body", self._bodies, name)

    @cached_property
    def _bodies(self) -> dict[str, Body]:
        return {body.name: body for body in (*self.bodies, *self.obstacles)}

    def boundary(self, name: str) -> Any:
        """Return the boundary of that name, one of the file or a pair of bodies in use."""
        return _named("boundary", {b.name: b for b in (*self.boundaries, *self.used)}, name)

    def required_distance(self, pair: Pair) -> float:
        r"""Return :math:`d_{\min}` of eq. (11): both radii plus the clearance asked for; length."""
        return pair.least_distance(self.point)

    def least_distance(self, boundary: Boundary) -> float | None:
        r"""Return :math:`d_{\min}` of a boundary whose form is a squared length; else None.

        If it is 0, nothing can violate the boundary.
        """
        return boundary.least_distance(self.point)

    def depth(self, frame: str) -> int:
        """Count the joints between the base and a frame; ValueError if there is no such frame."""
        if frame not in self._depths:
            raise ValueError(f"no frame {frame!r}; there are {', '.join(self._depths)}")
        return self._depths[frame]

    @cached_property
    def _depths(self) -> dict[str, int]:
        moved = enumerate(self.joints, start=1)
        return {self.base: 0} | {name: j for j, joint in moved for name in joint.labels}

    def joint_index(self, joint: int | str) -> int:
        """Return the index of a joint that is given by its index or its name."""
        names = [each.name for each in self.joints]
        places: dict[Any, int] = {name: j for j, name in enumerate(names)}
        places |= {j: j for j in range(len(names))}
        if type(joint) in (bool, float) or joint not in places:  # 1.0 == True == 1
            known = ", ".join(f"{j} ({name})" for j, name in enumerate(names))
            raise ValueError(f"no joint {joint!r}; there are {known}")
        return places[joint]

    def held_indices(self, held: Held) -> dict[int, float]:
        """Return the values of held joints by the joints' indices, ascending.

        Parameters
        ----------
        held : mapping of int or str to float
            Values by index or by name, rad or length; both in one mapping are allowed.

        Raises
        ------
        ValueError
            If a joint does not exist or is held twice, or a value is not a finite number.

        Examples
        --------
        >>> from cspace import load_robot
        >>> load_robot("minervabot-v2").held_indices({"q2": 0.5})
        {1: 0.5}
        """
        if not isinstance(held, Mapping):
            refuse_type("held", held, "values by joint, such as {'q3': 0.5}")
        found: dict[int, float] = {}
        for joint, value in held.items():
            index = self.joint_index(joint)
            name = self.joints[index].name
            if index in found:
                raise ValueError(f"joint {name!r} is held twice, by its index and by its name")
            found[index] = joint_values([value], [name]).item()
        return dict(sorted(found.items()))

    def free(self, held: Collection[int] | Collection[str]) -> list[int]:
        """Return the joints that are not held, by index; `held` has indices or names."""
        if isinstance(held, str) or not isinstance(held, Collection):
            refuse_type("held", held, "several joints")
        taken = {self.joint_index(joint) for joint in held}
        return [j for j in range(len(self.joints)) if j not in taken]

    def configuration(self, q: ArrayLike) -> NDArray[np.float64]:
        """Check that joint values are configurations and return them as floats, (..., n).

        Raises
        ------
        ValueError
            If the last axis does not have one value for each joint, or a value is not a finite
            number.
        """
        return joint_values(q, [joint.name for joint in self.joints])

    def with_held(self, q: ArrayLike, held: Held) -> NDArray[np.float64]:
        """Add the held joints' values to those of the free joints, (..., free) to (..., n).

        Raises
        ------
        ValueError
            As `held_indices` and `configuration` do.
        """
        values = self.held_indices(held)
        free = self.free(values)
        moving = joint_values(q, [self.joints[j].name for j in free])
        full = np.empty((*moving.shape[:-1], len(self.joints)))
        full[..., free] = moving
        full[..., list(values)] = list(values.values())
        return full

    def frames(self, q: ArrayLike) -> Frames:
        """Forward kinematics (Table 2): every joint's frame and every point as a frame.

        Parameters
        ----------
        q : array_like, shape (..., n)
            Joint values, or SymPy expressions.

        Raises
        ------
        ValueError
            If the last axis has not one value a joint, or a number is not finite.
        """
        return super().frames(joint_values(q, [joint.name for joint in self.joints], symbols=True))

    def chain(self, frame: str, observer: str | None = None) -> list[Motion]:
        """Return the motions from a frame back to an observer; the bar of a parallelogram is one.

        Seen from the bar, the frame that the bar carries turns back.
        """
        for joint in self.joints:
            if isinstance(joint, Parallelogram) and joint.bar == observer != frame:
                back = joint.frame, self.kinds, joint.crank, IDENTITY, -joint.axis
                index = self.joints.index(joint)
                return [*super().chain(frame, joint.frame), Turn(index, joint.bar, *back)]
        return super().chain(frame, observer)

    def forward_kinematics(self, q: ArrayLike, point: str | None = None) -> NDArray[np.float64]:
        """Return where the tool is, or another point, seen from the base (Table 2).

        Parameters
        ----------
        q : array_like, shape (..., n)
            One configuration or many; rad or length.
        point : str, optional
            Name of a point or a frame; default: the tool.

        Returns
        -------
        ndarray, shape (..., 3)
            Length.

        Raises
        ------
        ValueError
            If `q` is not a configuration of finite numbers, or the point does not exist.

        Examples
        --------
        >>> from cspace import load_robot
        >>> robot = load_robot("two-joint-arm-with-walls")
        >>> robot.forward_kinematics([[0.0, 0.0], [0.5, -1.0]]).round(3).tolist()
        [[0.0, 0.0, 1.1], [0.024, 0.0, 1.008]]
        """
        name = self.tool if point is None else point
        known = [self.base, *(label for joint in self.joints for label in joint.labels)]
        if name not in (*known, *self._points):
            raise ValueError(f"no point or frame {name!r}; there are {', '.join(self._points)}")
        values = self.configuration(q)
        found = self.frames(values).position(self.base, name, self.base)
        return np.array(np.broadcast_to(found, (*values.shape[:-1], 3)), dtype=float)

    def inverse_kinematics(self, place: ArrayLike) -> NDArray[np.float64]:
        """Return every configuration of two joints that brings the tool to a place, in closed form.

        The joints may be of any kinds that move the tool in a plane.

        Parameters
        ----------
        place : array_like, shape (3,)
            Seen from the base; length. A place outside the tool's plane is out of reach.

        Returns
        -------
        ndarray, shape (k, 2)
            Within the joints' limits, feasible or not; a joint without limits in (-pi, pi]. Empty
            where the place is out of reach.

        Raises
        ------
        ValueError
            If the robot does not have two joints, the tool leaves its plane, the place is not
            three finite numbers, or every value of the first joint reaches it.

        Examples
        --------
        >>> from cspace import load_robot
        >>> robot = load_robot("two-joint-arm-with-walls")
        >>> robot.inverse_kinematics([0.5, 0.0, 0.2]).round(3).tolist()
        [[2.597, -1.607], [1.128, 1.607]]
        >>> robot.inverse_kinematics([9.0, 0.0, 0.0]).shape
        (0, 2)
        """
        from cspace.workspace.planar import planar_postures

        return planar_postures(self, place)


def _comparable(value: Any) -> Any:
    """Return data as nested tuples, because arrays do not compare and hash by content."""
    if is_dataclass(value):
        compared = (getattr(value, each.name) for each in fields(value) if each.compare)
        return (type(value), *map(_comparable, compared))
    if isinstance(value, np.ndarray):
        value = value.tolist()
    return tuple(map(_comparable, value)) if isinstance(value, list | tuple) else value


def _named(what: str, items: Mapping[str, Item], name: str) -> Item:
    if name not in items:
        raise ValueError(f"no {what} {name!r}; there are {', '.join(items)}")
    return items[name]


def refuse_no_robot(taker: str, robot: object) -> None:
    """Raise a TypeError if a robot is not a `Robot`, such as a name, which only commands load."""
    if not isinstance(robot, Robot):
        text = f"{taker} takes a Robot, found {one_line(repr(robot))}; load_robot(...) makes one"
        raise TypeError(text)


# --- joint values ---------------------------------------------------------------------------------


def real_numbers(q: ArrayLike) -> NDArray[np.float64]:
    """Return integers or floats as an array of floats; fast for the usual case of floats.

    Raises
    ------
    ValueError
        If they are complex numbers, texts, of no shape, or some of them are masked.
    """
    if isinstance(q, np.ndarray) and q.dtype == np.float64:
        if type(q) is not np.ndarray and np.ma.is_masked(q):
            raise ValueError("a value is masked, and so no joint value; fill it or leave it out")
        return q
    found = _array(q, symbols=False)
    if found is None:
        raise ValueError(f"{one_line(repr(q))} is no array of real numbers")
    return found


def joint_values(q: ArrayLike, names: Sequence[str], *, symbols: bool = False) -> Array:
    """Return the values of the joints of those names as floats, shape (..., n).

    Parameters
    ----------
    q : array_like, shape (..., n)
        One value a joint on the last axis; any leading axes.
    names : sequence of str
        Names of the joints, for the message of an error.
    symbols : bool
        Whether an array with SymPy expressions is returned unchanged.

    Raises
    ------
    ValueError
        If they are not an array of numbers, not one for each joint, or one is NaN or infinite.
    """
    values = _array(q, symbols)
    if values is None:
        listed = one_line(", ".join(names))
        raise ValueError(f"{one_line(repr(q))} is no array of numbers; wanted: values of {listed}")
    n = len(names)
    if values.shape[-1:] != (n,):
        found = values.shape[-1] if values.ndim else "a bare number"
        raise ValueError(
            f"expected {n} joint value{'s' * (n != 1)} on the last axis, found {found}"
        )
    if values.dtype != object and not np.isfinite(values).all():
        *place, j = np.argwhere(~np.isfinite(values))[0].tolist()
        where = f" in configuration {place}" if place else ""
        raise ValueError(f"joint {names[j]!r} is {values[*place, j]}{where}, not a finite number")
    return values


def _array(q: ArrayLike, symbols: bool) -> Array | None:
    """Return an array of floats or of symbols; None for other values, such as a text."""
    try:
        values = np.asarray(q)
        if values.dtype == object and not any(isinstance(x, str) for x in values.flat):
            symbolic = symbols and any(hasattr(x, "free_symbols") for x in values.flat)
            return values if symbolic else values.astype(float)
        return np.asarray(values, dtype=float) if values.dtype.kind in "iuf" else None
    except (TypeError, ValueError, OverflowError):  # rows of unlike lengths, integers beyond floats
        return None


# --- the plane of motion --------------------------------------------------------------------------


COORDINATES = {0: (1, 2), 1: (0, 2), 2: (0, 1)}
"""The two coordinates of a plane by that of its normal: (y, z), (x, z), (x, y)."""


@dataclass(frozen=True, eq=False)
class PlaneOfMotion:
    """The plane in which a planar arm moves, seen from the base.

    Attributes
    ----------
    across : ndarray, shape (2, 3)
        Its axes, orthonormal: ``across @ r`` are the plane coordinates of a vector of the base;
        (x, z) for a normal along y, (x, y) for z, (y, z) for x.
    normal : ndarray, shape (3,)
        Unit vector, its largest coordinate positive; not always ``cross(*across)``, which is -y
        for the plane of x and z.
    senses : tuple of int
        For each step of the chain: +1 if the joint's value turns the frame from the first axis to
        the second, -1 if back, 0 for a slide.
    frames : Frames
        At all joint values 0.
    chosen : bool
        Whether the joints do not determine the plane, because all slide along one line.
    """

    across: Array
    normal: Array
    senses: tuple[int, ...]
    frames: Frames
    chosen: bool = False

    @property
    def name(self) -> str:
        """The plane in words: by the axes of the base that span it, or by its normal."""
        k = first_largest(np.abs(self.normal))
        if abs(self.normal[k]) < 1 - ZERO_AMPLITUDE:
            return f"the plane at right angles to {self.normal.round(6).tolist()}"
        one, other = ("xyz"[i] for i in COORDINATES[k])
        return f"the plane of {one} and {other}"

    def flat(self, frame: str, corners: ArrayLike) -> Array:
        """Return places of a frame, shape (m, 3), in the plane's axes, shape (m, 2).

        The places are seen from the frame's origin and turned as at all joint values 0. At joint
        values q the pose of the frame is a turn by the sum of ``senses * q`` over the steps before
        it, and a translation.
        """
        rotation = np.asarray(self.frames.rotation(self.frames.base, frame), dtype=float)
        return np.asarray(np.asarray(corners, dtype=float) @ (self.across @ rotation).T)

    def height(self, frame: str, corners: ArrayLike) -> Array:
        """Return how far places of a frame are above the base's origin, along the normal; (m,)."""
        base = self.frames.base
        rotation = np.asarray(self.frames.rotation(base, frame), dtype=float)
        places = np.asarray(corners, dtype=float) @ rotation.T
        return np.asarray((places + self.frames.position(base, frame, base)) @ self.normal)

    def normal_seen_from(self, frame: str) -> Array:
        """Return the normal seen from a frame, shape (3,): at every configuration the same."""
        rotation = np.asarray(self.frames.rotation(self.frames.base, frame), dtype=float)
        return np.asarray(self.normal @ rotation)

    def flat_coordinate(self, frame: str) -> int | None:
        """Return the coordinate of a frame, 0, 1 or 2, that is at right angles to the plane.

        None if the normal is not along an axis of the frame.
        """
        normal = np.abs(self.normal_seen_from(frame))
        second = sorted(normal.tolist())[1]
        return int(np.argmax(normal)) if second <= ZERO_AMPLITUDE else None


def plane_of_motion(robot: Robot) -> PlaneOfMotion:
    """Return the plane in which a robot moves.

    If all joints slide along one line, the plane is the first of these that holds the line: x and
    z, x and y, y and z, any other plane.

    Raises
    ------
    ValueError
        If the robot is not planar; the message names the joint that leaves the plane.

    Examples
    --------
    >>> from cspace import load_robot
    >>> plane = load_robot("minervabot-v2").plane
    >>> plane.across.tolist(), plane.senses
    ([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], (-1, -1))
    """
    frames = robot.frames(np.zeros(len(robot.joints)))
    mounts = [frames.rotation(robot.base, j.parent) @ j.mount for j in robot.joints]
    axes = [np.asarray(m @ j.axis, dtype=float) for m, j in zip(mounts, robot.joints, strict=True)]
    normal = _normal(robot.joints, axes)
    for joint, axis in zip(robot.joints, axes, strict=True):
        if joint.turns and np.linalg.norm(cross(axis, normal)) > ZERO_AMPLITUDE:
            fault = "turns about an axis that is not parallel to the others'"
        elif not joint.turns and abs(axis @ normal) > ZERO_AMPLITUDE:
            fault = "slides out of the plane in which the others move"
        else:
            continue
        text = f"joint {one_line(repr(joint.name))} {fault}: there is no plane of motion"
        raise ValueError(text)
    across = _across(normal)
    over = cross(*across)
    ways = [round(float(a @ over)) * j.turns for a, j in zip(axes, robot.joints, strict=True)]
    senses = [ways[step.joint] * step.sense for step in robot.steps]
    along = [np.linalg.norm(cross(axes[0], axis)) <= ZERO_AMPLITUDE for axis in axes]
    chosen = all(along) and not any(joint.turns for joint in robot.joints)
    return PlaneOfMotion(across, normal, tuple(senses), frames, chosen)


def _normal(joints: Sequence[Joint], axes: Sequence[Array]) -> Array:
    """Return the normal that the first deciding joint gives, its largest coordinate positive."""
    turning = [axis for axis, joint in zip(axes, joints, strict=True) if joint.turns]
    candidates = [*turning, *(cross(axes[0], axis) for axis in axes[1:])]
    candidates += [axis for axis in np.eye(3)[[1, 2, 0]] if abs(axis @ axes[0]) <= ZERO_AMPLITUDE]
    candidates.append(cross(axes[0], np.eye(3)[first_largest(1 - np.abs(axes[0]))]))
    normal = next(axis for axis in candidates if np.linalg.norm(axis) > ZERO_AMPLITUDE)
    normal = normal / np.linalg.norm(normal)
    largest = normal[first_largest(np.abs(normal))]
    return np.asarray(normal * np.sign(largest) + 0.0)


def _across(normal: Array) -> Array:
    """Return the plane's axes, shape (2, 3): those of the base if the normal is one of them."""
    one, other = COORDINATES[first_largest(np.abs(normal))]
    first = np.eye(3)[one] - normal[one] * normal
    first /= np.linalg.norm(first)
    second = cross(normal, first)
    second *= np.sign(second[other])
    return np.array([first, second]) + 0.0
