"""A robot as data: joints, points, boundaries, and its frames at given joint values (Table 2)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.extras import require
from qbound.model.frames import Frame, Frames, axis_rotation
from qbound.tolerances import ZERO_AMPLITUDE

if TYPE_CHECKING:
    import sympy

Array = NDArray[Any]
Kind = Literal["revolute", "prismatic"]
Item = TypeVar("Item")


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint that moves `frame` relative to `parent`.

    Attributes
    ----------
    name : str
    kind : {"revolute", "prismatic"}
    parent, frame : str
        Labels of the frames before and after it.
    origin : ndarray, shape (3,)
        From the parent to the frame at joint value 0, seen from the parent; length.
    mount : ndarray, shape (3, 3)
        Fixed rotation between the parent and the joint's own axes.
    axis : ndarray, shape (3,)
        Unit vector, seen from the mount.
    limits : tuple of float, optional
        Lowest and highest value (eq. 10), rad or length. None: turns all the way round.
    velocity : float, optional
        Largest speed, rad/s or length/s.
    """

    name: str
    kind: Kind
    parent: str
    frame: str
    origin: Array
    mount: Array
    axis: Array
    limits: tuple[float, float] | None = None
    velocity: float | None = None


@dataclass(frozen=True, eq=False)
class Point:
    """A point fixed in a frame; with a radius, the centre of a sphere. Lengths."""

    name: str
    frame: str
    at: Array
    radius: float = 0.0


@dataclass(frozen=True)
class Pair:
    """Point boundary function: feasible where the points keep apart (Theorem 1, eq. 11)."""

    name: str
    points: tuple[str, str]
    clearance: float = 0.0
    used: bool = True


@dataclass(frozen=True, eq=False)
class HalfSpace:
    """Geometric boundary function: feasible where normal . r >= offset + radius (eq. 12)."""

    name: str
    point: str
    normal: Array
    offset: float
    used: bool = True


@dataclass(frozen=True, eq=False)
class Body:
    """Outline of a link in the plane of motion, shape (m, 2): x and z seen from its frame."""

    frame: str
    polygon: Array


@dataclass(frozen=True, eq=False)
class Robot:
    """What a robot file says, in its own length unit and in radians."""

    name: str
    joints: tuple[Joint, ...]
    points: tuple[Point, ...]
    boundaries: tuple[Pair | HalfSpace, ...]
    home: Array
    tool: str
    length_unit: str
    angle_unit: str
    bodies: tuple[Body, ...] = field(default=())

    @property
    def base(self) -> str:
        """Label of the base frame."""
        return self.joints[0].parent

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """Kind of each joint."""
        return tuple(joint.kind for joint in self.joints)

    def point(self, name: str) -> Point:
        """Return the point of that name."""
        return _named("point", {p.name: p for p in self.points}, name)

    def boundary(self, name: str) -> Pair | HalfSpace:
        """Return the boundary of that name."""
        return _named("boundary", {b.name: b for b in self.boundaries}, name)

    def required_distance(self, pair: Pair) -> float:
        r"""Return :math:`d_{\min}` of eq. (11): both radii plus the clearance asked for; length."""
        return sum(self.point(name).radius for name in pair.points) + pair.clearance

    def depth(self, frame: str) -> int:
        """Count the joints between the base and a frame; ValueError if there is no such frame."""
        frames = [self.base, *(joint.frame for joint in self.joints)]
        if frame not in frames:
            raise ValueError(f"no frame {frame!r}; there are {', '.join(frames)}")
        return frames.index(frame)

    def free(self, held: Collection[int]) -> list[int]:
        """Return the joints that are not held, by index."""
        return [j for j in range(len(self.joints)) if j not in held]

    def with_held(self, q: ArrayLike, held: Mapping[int, float]) -> NDArray[np.float64]:
        """Put the held joints' values beside those of the free ones, (..., free) to (..., n)."""
        values = np.asarray(q, dtype=float)
        full = np.empty((*values.shape[:-1], len(self.joints)))
        full[..., self.free(held)] = values
        full[..., list(held)] = list(held.values())
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
            If the last axis has not one value a joint.
        """
        values, n = np.asarray(q), len(self.joints)
        if values.shape[-1:] != (n,):
            found = values.shape[-1] if values.ndim else "a bare number"
            raise ValueError(
                f"expected {n} joint value{'s' * (n != 1)} on the last axis, found {found}"
            )
        columns = np.moveaxis(values, -1, 0)
        moved = [_joint_frame(joint, x) for joint, x in zip(self.joints, columns, strict=True)]
        fixed = [Frame(p.name, p.frame, np.eye(3, dtype=int), p.at) for p in self.points]
        return Frames(self.base, [*moved, *fixed])


def joint_symbols(robot: Robot) -> tuple[sympy.Symbol, ...]:
    r"""Return a real SymPy symbol for each joint: :math:`q_1, q_2, \ldots`."""
    require("sympy")
    import sympy

    return tuple(sympy.Symbol(_subscripted(joint.name), real=True) for joint in robot.joints)


def with_symbols(robot: Robot) -> tuple[Robot, dict[sympy.Symbol, float]]:
    r"""Replace every non-zero offset by its label, such as :math:`x_{a,b}` (rule 8 of Section 2).

    The offset of a half-space along an axis becomes :math:`x_{\min,1}, x_{\min,2}, \ldots` as in
    Table 5.

    Returns
    -------
    Robot
        The same robot with SymPy symbols for lengths; its forms are the printed formulas.
    dict
        The value of each symbol, in the robot's length unit.
    """
    require("sympy")
    values: dict[sympy.Symbol, float] = {}
    joints = tuple(
        replace(j, origin=_labelled(j.parent, j.frame, j.origin, values)) for j in robot.joints
    )
    points = tuple(replace(p, at=_labelled(p.frame, p.name, p.at, values)) for p in robot.points)
    exact = tuple(replace(j, axis=_integers(j.axis), mount=_integers(j.mount)) for j in joints)
    walls = _label_walls(robot.boundaries, values)
    return replace(robot, joints=exact, points=points, boundaries=walls), values


def _joint_frame(joint: Joint, q: Any) -> Frame:
    if joint.kind == "revolute":
        turn = joint.mount @ axis_rotation(joint.axis, q)
        return Frame(joint.frame, joint.parent, turn, joint.origin)
    slide = np.asarray(q)[..., None] * (joint.mount @ joint.axis)
    return Frame(joint.frame, joint.parent, joint.mount, joint.origin + slide)


def _labelled(a: str, b: str, vector: Array, values: dict[sympy.Symbol, float]) -> Array:
    import sympy

    result = np.zeros(3, dtype=object)
    for i, (letter, value) in enumerate(zip("xyz", vector, strict=True)):
        if value:
            symbol = sympy.Symbol(f"{letter}_{{{a},{b}}}", real=True)
            result[i], values[symbol] = symbol, float(value)
    return result


def _label_walls(
    boundaries: Sequence[Pair | HalfSpace], values: dict[sympy.Symbol, float]
) -> tuple[Pair | HalfSpace, ...]:
    import sympy

    counts: Counter[str] = Counter()
    result: list[Pair | HalfSpace] = []
    for boundary in boundaries:
        if isinstance(boundary, Pair):
            result.append(boundary)
            continue
        letter = "xyz"[int(np.argmax(np.abs(boundary.normal)))]
        counts[letter] += 1
        symbol = sympy.Symbol(f"{letter}_{{min,{counts[letter]}}}", real=True)
        values[symbol] = boundary.offset
        result.append(replace(boundary, offset=symbol, normal=_integers(boundary.normal)))
    return tuple(result)


def _integers(values: Array) -> Array:
    """Exact copies of entries that are whole numbers but for rounding: symbols meet no floats."""
    import sympy

    whole = np.rint(values).astype(int)
    exact = np.vectorize(sympy.Integer, otypes=[object])(whole)
    return np.where(np.abs(values - whole) <= ZERO_AMPLITUDE, exact, values)


def _subscripted(name: str) -> str:
    letters = name.rstrip("0123456789")
    return f"{letters}_{name[len(letters) :]}" if letters and letters != name else name


def _named(what: str, items: Mapping[str, Item], name: str) -> Item:
    if name not in items:
        raise ValueError(f"no {what} {name!r}; there are {', '.join(items)}")
    return items[name]
