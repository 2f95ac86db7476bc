"""The numbers of a robot as they are written, exact: decimals as rationals, degrees times pi.

A number that cannot be rational (of a normalised axis, of a mount other than quarter turns) becomes
a ball that holds the true value, at the precision that is set. A number that was not changed after
the file was read counts as written there. Any other number counts as its double.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from cspace.arrays import Array
from cspace.model.boundaries import BodyPair, Boundary
from cspace.model.joints import Joint
from cspace.model.robot import Robot
from cspace.model.shapes import Body, Point, default_names
from cspace.tolerances import ROUNDING, TANGENT

if TYPE_CHECKING:
    import flint

    arb = flint.arb

Table = Mapping[str, Any]

NO_ROW: Table = {}


class ExactNumbers:
    """Joints, points, bodies and boundaries of a robot with exact numbers (dtype object).

    Parameters
    ----------
    robot : Robot
    table : mapping
        Content of the file that the robot was read from, decimals as rationals; an empty one: each
        double counts as the binary fraction that it is.
    unit : bool
        Whether directions of the file are brought to length 1. If not, unchanged directions keep
        the length with which they are written, and stay rational.
    """

    def __init__(self, robot: Robot, table: Table, *, unit: bool = True) -> None:
        self._robot, self._table, self._unit = robot, table, unit

    @cached_property
    def _rows(self) -> dict[str, dict[str, Table]]:
        """The tables of the file by kind and name."""
        table = self._table
        rows = {
            kind: {row["name"]: row for row in table.get(kind, ())}
            for kind in ("joint", "point", "boundary")
        }
        bodies = [*table.get("body", ()), *table.get("obstacle", ())]
        base = self._robot.base
        names = default_names([row.get("frame", base) for row in bodies])
        rows["body"] = {row.get("name", name): row for row, name in zip(bodies, names, strict=True)}
        return rows

    @property
    def clearance(self) -> Any:
        """Clearance of the pairs of bodies that no boundary names."""
        return _number(self._table.get("clearance"), self._robot.clearance)

    @property
    def robot(self) -> Robot:
        """The whole robot; its home stays a configuration of doubles."""
        robot = self._robot
        return replace(
            robot,
            joints=tuple(map(self.joint, robot.joints)),
            points=tuple(map(self.point, robot.points)),
            boundaries=tuple(map(self.boundary, robot.boundaries)),
            bodies=tuple(map(self.body, robot.bodies)),
            obstacles=tuple(map(self.body, robot.obstacles)),
            clearance=self.clearance,
        )

    def joint(self, joint: Joint) -> Joint:
        """Return a joint with exact numbers; its limits are balls."""
        row = self._rows["joint"].get(joint.name, NO_ROW)
        degrees = self._table.get("angle_unit") == "deg"
        mount = _mount(row.get("rpy", (0, 0, 0)), degrees) if row else None
        own = {key: getattr(joint, key) for key in joint.own_keys}
        vectors = {key: value for key, value in own.items() if isinstance(value, np.ndarray)}
        more: Any = {key: _numbers(row.get(key), value) for key, value in vectors.items()}
        return replace(
            joint,
            origin=_numbers(row.get("origin"), joint.origin),
            mount=_same(mount, joint.mount),
            axis=self._direction(row.get("axis"), joint.axis),
            limits=_limits(row.get("limits"), joint.limits, degrees=degrees and joint.turns),
            **more,
        )

    def point(self, point: Point) -> Point:
        """Return a point with exact numbers."""
        row = self._rows["point"].get(point.name, NO_ROW)
        at, radius = _numbers(row.get("at"), point.at), _number(row.get("radius"), point.radius)
        return replace(point, at=at, radius=radius)

    def body(self, body: Body) -> Body:
        """Return a body with exact numbers."""
        shape = body.shape
        value = self._rows["body"].get(body.name, NO_ROW).get(shape.key)
        written, radius = (None, None) if value is None else shape.written(value)
        places = _places(written, shape.places)
        own = _number(radius, getattr(shape, "radius", 0))
        return replace(body, shape=shape.with_numbers(places, own))

    def boundary(self, boundary: Boundary) -> Boundary:
        """Return a boundary with exact numbers, also one that the robot makes of two bodies."""
        row = self._rows["boundary"].get(boundary.name, NO_ROW)
        if not row and isinstance(boundary, BodyPair):
            row = {"clearance": self._table.get("clearance")}
        own = vars(boundary)
        written = {key: (row.get(key), value) for key, value in own.items()}
        return boundary.with_numbers(
            written, lambda both: _number(*both), lambda both: self._direction(*both)
        )

    def _direction(self, written: Any, near: Array) -> Array:
        """Return the file's direction if the robot still has it, else the robot's direction."""
        if written is None or _is_kept(written, near):
            return rationals(near)
        unit = _unit(written)
        own = _same(unit, near)
        return own if self._unit or own is not unit else rationals(written)


def written_numbers(robot: Robot, *, unit: bool = True) -> ExactNumbers:
    """Return the numbers of a robot as its file has them, where the robot still has the same.

    A file with a number beyond all doubles, such as 1e-999, counts as its doubles.

    Parameters
    ----------
    robot : Robot
        A robot that was not read from a file has doubles, which are exact binary fractions.
    unit : bool
        As in `ExactNumbers`.
    """
    source = robot.source
    if source is None:
        return ExactNumbers(robot, NO_ROW, unit=unit)
    try:
        return ExactNumbers(robot, source.exact, unit=unit)
    except ValueError:
        return ExactNumbers(robot, source.table, unit=unit)


def frozen(robot: Robot, held: Mapping[int, Any]) -> Robot:
    """Return a robot without some joints, with everything that they carry fixed where they hold it.

    A form of n joints has :math:`3^n` numbers, made one by one: of three joints 27, of six 729.

    Parameters
    ----------
    robot : Robot
        With exact numbers.
    held : mapping of int to number
        Some joints, not all; rationals or balls.
    """
    carried = {robot.base: (robot.base, rationals(np.eye(3, dtype=int)), rationals([0, 0, 0]))}
    joints = []
    for j, joint in enumerate(robot.joints):
        carrier, turn, shift = carried[joint.parent]
        if j in held:
            for motion in joint.motions(0, (joint.kind,)):
                still = motion.frame_at(held[j])
                carried[still.name] = carrier, turn @ still.rotation, shift + turn @ still.origin
        else:
            moved = {"origin": shift + turn @ joint.origin, "mount": turn @ joint.mount}
            joints.append(replace(joint, parent=carrier, **moved))
            plain = rationals(np.eye(3, dtype=int)), rationals([0, 0, 0])
            carried |= {label: (label, *plain) for label in joint.labels}
    points = []
    for point in robot.points:
        carrier, turn, shift = carried[point.frame]
        points.append(replace(point, frame=carrier, at=shift + turn @ point.at))
    home = robot.home[robot.free(held)]
    return replace(robot, joints=tuple(joints), points=tuple(points), home=home)


# --- numbers --------------------------------------------------------------------------------------


def rational(value: Any) -> Any:
    """Return an integer or a double as a rational; return a rational or a ball unchanged."""
    from flint import arb, fmpq

    kept = isinstance(value, fmpq | arb | RationalTurn)
    return value if kept else fmpq(*value.as_integer_ratio())


def rationals(numbers: Any) -> Array:
    """Return an object array of rationals."""
    plain = np.asarray(numbers, dtype=object)
    return np.asarray(np.vectorize(rational, otypes=[object])(plain))


def root(square: Any) -> Any:
    """Return the root of a number that is not negative: rational if possible, else a ball."""
    from flint import arb, fmpq

    if isinstance(square, fmpq) and square >= 0:
        p, q = square.p.isqrt(), square.q.isqrt()
        if p * p == square.p and q * q == square.q:
            return fmpq(p, q)
    return arb(square).sqrt()


@dataclass(frozen=True)
class RationalTurn:
    """An angle whose sine and cosine are rational: the simplest one within a double's rounding.

    So quarter turns are exact, and opposite angles stay opposite (`half_tangent`).

    Attributes
    ----------
    angle : float
        rad.
    times : int
        How often it is turned.
    """

    angle: float
    times: int = 1

    def __mul__(self, n: Any) -> RationalTurn:
        """Turn more often, or back."""
        return RationalTurn(self.angle, self.times * int(n))

    __rmul__ = __mul__

    def sin(self) -> Any:
        """Return the sine."""
        return rational(on_circle(half_tangent(self.angle * self.times))[2])

    def cos(self) -> Any:
        """Return the cosine."""
        return rational(on_circle(half_tangent(self.angle * self.times))[1])

    def sin_cos(self) -> tuple[Any, Any]:
        """Return sine and cosine."""
        return self.sin(), self.cos()


def on_circle(u: Any) -> tuple[Any, Any, Any]:
    """Return (1, cos, sin) of the angle with u = tan(angle / 2); None is infinite."""
    return (1, -1, 0) if u is None else (1, (1 - u * u) / (1 + u * u), 2 * u / (1 + u * u))


@cache
def half_tangent(v: float) -> Any:
    """Return tan(v / 2) as the simplest rational within the rounding of v; None is infinite.

    Examples
    --------
    >>> import math
    >>> half_tangent(math.pi / 2), half_tangent(-math.pi / 2), half_tangent(math.pi)
    (1, -1, None)
    """
    from flint import arb, ctx, fmpq

    if v < 0:
        u = half_tangent(-v)
        return u if u is None else -u
    with ctx.workprec(256):
        rest = arb(v) - 2 * arb.pi() * (arb(v) / (2 * arb.pi())).floor()
        rounding = arb(v) * arb(2) ** -53
        low, high = (rest - rounding) / 2, (rest + rounding) / 2
        half = arb.pi() / 2
        if not low >= 0 or not high <= 2 * half:
            return fmpq(0)
        if not (high < half or low > half):
            return None
        return _simplest(_middle(low.tan()), _middle(high.tan()))


def simplest_in(ball: Any) -> Any:
    """Return the fraction of least denominator in a ball: of a rounded decimal the decimal."""
    from flint import ctx

    with ctx.workprec(4096):
        low, high = _middle(ball.lower()), _middle(ball.upper())
    return low * 0 if low <= 0 <= high else _simplest(low, high)


def _middle(ball: Any) -> Any:
    """Return the middle of a ball as a rational."""
    from flint import fmpq

    man, exp = ball.mid().man_exp()
    return fmpq(man) * fmpq(2) ** int(exp)


def _simplest(low: Any, high: Any) -> Any:
    """Return the fraction of least denominator between two of one sign."""
    if low < 0:
        return -_simplest(-high, -low)
    whole = low.ceil()
    if whole <= high:
        return low * 0 + whole
    whole = low.floor()
    return whole + 1 / _simplest(1 / (high - whole), 1 / (low - whole))


def sine_cosine(angle: Any) -> tuple[Any, Any]:
    """Return sine and cosine of an angle, rad; as whole numbers at quarter turns."""
    from flint import arb

    if isinstance(angle, RationalTurn):
        return angle.sin_cos()
    s, c = arb(angle).sin_cos()
    return _whole(s), _whole(c)


def _whole(value: arb) -> Any:
    """Return a ball that is exactly an integer as that integer."""
    whole: Any = value.unique_fmpz() if value.is_integer() else None
    return value if whole is None else rational(int(whole))


# --- what a file says, if it is what the robot has ------------------------------------------------


def _number(written: Any, near: Any) -> Any:
    """Return a number of the file if the robot's double agrees with it up to rounding."""
    own = rational(near)
    if written is None:
        return own
    exact = rational(written)
    return exact if abs(exact - own) <= rational(TANGENT) * abs(own) else own


def _numbers(written: Sequence[Any] | None, near: Array) -> Array:
    """Return numbers: each one of the file that agrees with the robot's, else the robot's."""
    if written is None or len(written) != len(near):
        return rationals(near)
    return _array(_number(*pair) for pair in zip(written, near.tolist(), strict=True))


def _same(exact: Array | None, near: Array) -> Array:
    """Return a rotation or unit vector of the file if the robot's agrees with it up to rounding."""
    if exact is None:
        return rationals(near)
    away = np.abs(np.asarray(exact, dtype=float) - np.asarray(near, dtype=float))
    return exact if away.max() <= ROUNDING else rationals(near)


def _is_kept(written: Sequence[Any], near: Array) -> bool:
    """Tell whether a direction of doubles has length 1 up to rounding, and so stays unchanged."""
    return all(isinstance(x, int | float) for x in written) and list(written) == near.tolist()


def _limits(written: Any, near: Any, *, degrees: bool) -> Any:
    """Return limits as balls, from the file where the robot still has the same."""
    from flint import arb

    if near is None:
        return None
    own = [arb(rational(x)) for x in near]
    if written is None:
        return tuple(own)
    exact = [arb(rational(x)) for x in written]
    exact = [x * arb.pi() / 180 for x in exact] if degrees else exact
    pairs = zip(exact, own, strict=True)
    return tuple(x if abs(x - o) <= arb(TANGENT) * abs(o) else o for x, o in pairs)


def _places(written: Sequence[Sequence[Any]] | None, near: Array) -> Array:
    """Return places of a frame, from the file where the robot still has the same."""
    if written is None or len(written) != len(near):
        return rationals(near)
    return np.array([_place(*pair) for pair in zip(written, near, strict=True)])


def _place(written: Sequence[Any], near: Array) -> Array:
    """Return a place of the frame; two numbers get the third one, 0, where the robot has it."""
    if len(written) == 3:
        return _numbers(written, near)
    for k in (1, 2, 0):
        rest = np.delete(near, k)
        found = _numbers(written, rest)
        if near[k] == 0 and np.allclose(rest, _floats(written), rtol=TANGENT, atol=0):
            return np.insert(found, k, rational(0))
    return rationals(near)


def _floats(written: Sequence[Any]) -> Array:
    return np.array([float(rational(x)) for x in written])


def _array(numbers: Iterable[Any]) -> Array:
    return np.array(list(numbers), dtype=object)


def _unit(vector: Sequence[Any]) -> Array:
    """Give a vector the length 1: in rationals where its length is one, else in balls."""
    v = rationals(vector)
    return np.asarray(v / root(v @ v))


def _mount(rpy: Sequence[Any], degrees: bool) -> Array:
    """Return Rz(yaw) Ry(pitch) Rx(roll), as in URDF."""
    matrix = rationals(np.eye(3, dtype=int).tolist())
    for axis, angle in zip((0, 1, 2), rpy, strict=True):
        matrix = _turn(axis, rational(angle), degrees) @ matrix
    return matrix


def _turn(axis: int, angle: Any, degrees: bool) -> Array:
    """Return the rotation about a coordinate axis; quarter turns come out in whole numbers."""
    from flint import arb

    s, c = map(_whole, arb.sin_cos_pi_fmpq(angle / 180)) if degrees else sine_cosine(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = rationals(np.eye(3, dtype=int).tolist())
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix
