"""The numbers of a robot as they are written, exact: the ground of every proof.

A file's decimals become rationals and its degrees rationals times pi. What cannot be rational (an
axis that is normalised, a mount that is no quarter turn) becomes a ball that holds the true value.
The forms that `boundary` derives from such a robot are exact too: the derivation is the one that
floats use.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.boundary.evaluator import limit_names, stacked
from qbound.boundary.parts import bounds_bodies
from qbound.forms.harmonic import HarmonicForm, Kind
from qbound.model.robot import (
    Body,
    Boundary,
    Capsule,
    Disc,
    Joint,
    Parallelogram,
    Polygon,
    Robot,
    Shape,
)
from qbound.model.robotfile import load_robot, robot_text
from qbound.proofs.balls import arb, ball, pi, precision
from qbound.proofs.exact_bodies import ExactSeparation, exact_separations

Array = NDArray[Any]
Table = Mapping[str, Any]

BITS = 512
"""Precision of what is no rational: far above that of any proof, so that it never shows."""

LARGEST_EXPONENT = 400
"""Powers of ten beyond a double's range; a number with more would need astronomical fractions."""


@dataclass(frozen=True, eq=False)
class ExactProblem:
    """Forms with exact coefficients, and the ranges of their joints as balls.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
        Coefficients (dtype object) are rationals or balls.
    names : tuple of str
        One a form.
    ranges : tuple of (arb, arb) or None
        One a joint; None where it turns all the way round.
    limits : tuple of (str, str)
        Names of the lower and the upper end of each range.
    bodies : tuple of ExactSeparation
        What separates the bodies that are to keep apart.
    """

    forms: HarmonicForm
    names: tuple[str, ...]
    ranges: tuple[tuple[arb, arb] | None, ...]
    limits: tuple[tuple[str, str], ...]
    bodies: tuple[ExactSeparation, ...] = ()

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """Kind of each joint."""
        return self.forms.kinds

    @property
    def ends(self) -> tuple[tuple[arb, arb], ...]:
        """Ranges as pairs of balls; a full turn starts at -pi."""
        return tuple((-pi(), pi()) if r is None else r for r in self.ranges)


def exact_robot(source: str | Path | Robot) -> Robot:
    """Return a robot whose numbers are exact (dtype object); not in the paper.

    Parameters
    ----------
    source : str, Path or Robot
        What `load_robot` takes: each decimal of the file counts as it is written. Or a robot: each
        of its doubles counts as the binary fraction that it is.

    Raises
    ------
    ValueError
        As `load_robot`, and if a number has an exponent that no double could hold.
    """
    with precision(BITS):
        if isinstance(source, Robot):
            return _from_doubles(source)
        robot = load_robot(source)  # says what is wrong with the file, if anything
        return _from_table(robot, tomllib.loads(robot_text(source)[0], parse_float=_decimal))


def exact_problem(robot: Robot, held: Mapping[int, Any] | None = None) -> ExactProblem:
    """State the clearance rule of an exact robot: boundaries in use, and limits (eqs. 10-12).

    Parameters
    ----------
    robot : Robot
        From `exact_robot`.
    held : mapping of int to number, optional
        Values of joints that are held, rad or length: floats or balls.

    Raises
    ------
    ValueError
        If bodies are to keep apart and cannot in a proof, see `exact_separations`.
    """
    held = {j: ball(value) for j, value in (held or {}).items()}
    free = [joint for j, joint in enumerate(robot.joints) if j not in held]
    limits = [limit_names(joint.name) for joint in free]
    formed = [boundary for boundary in robot.used if not bounds_bodies(boundary)]
    problem = exact_state(robot, formed, [joint.limits for joint in free], limits, held)
    with precision(BITS):
        return replace(problem, bodies=exact_separations(robot, robot.used, held))


def paving_bytes(boundaries: int, joints: int) -> int:
    """Estimate the memory of exact forms of many joints with their first and second derivatives.

    Each form has :math:`3^n` coefficients, and so has each derivative: these are measured, about
    250 bytes each.

    Examples
    --------
    >>> paving_bytes(114, 7) // 10**6, paving_bytes(193, 3) // 10**6  # megabytes
    (3552, 16)
    """
    return int(250 * boundaries * 3**joints * (1 + joints + joints**2))


def exact_state(
    robot: Robot,
    used: Sequence[Boundary],
    ranges: Sequence[Any],
    limits: Sequence[tuple[str, str]],
    held: Mapping[int, arb] | None = None,
) -> ExactProblem:
    """Gather the exact clearance forms of some boundaries within given ranges."""
    with precision(BITS):
        forms = stacked(frozen(robot, held) if held else robot, used)
    balls = tuple(None if r is None else (ball(r[0]), ball(r[1])) for r in ranges)
    return ExactProblem(forms, tuple(b.name for b in used), balls, tuple(limits))


def frozen(robot: Robot, held: Mapping[int, Any]) -> Robot:
    """Return a robot without some joints: what they carry stands still where they are held.

    A form of n joints has :math:`3^n` numbers, made one by one: of three joints 27, of six 729.

    Parameters
    ----------
    robot : Robot
        From `exact_robot`.
    held : mapping of int to arb
        Some joints, not all.
    """
    carried = {robot.base: (robot.base, _rationals(np.eye(3, dtype=int)), _rationals([0, 0, 0]))}
    joints = []
    for j, joint in enumerate(robot.joints):
        carrier, turn, shift = carried[joint.parent]
        if j in held:
            still = joint.frame_at(held[j])
            carried[joint.frame] = carrier, turn @ still.rotation, shift + turn @ still.origin
        else:
            moved = {"origin": shift + turn @ joint.origin, "mount": turn @ joint.mount}
            joints.append(replace(joint, parent=carrier, **moved))
            plain = _rationals(np.eye(3, dtype=int)), _rationals([0, 0, 0])
            carried[joint.frame] = joint.frame, *plain
    points = []
    for point in robot.points:
        carrier, turn, shift = carried[point.frame]
        points.append(replace(point, frame=carrier, at=shift + turn @ point.at))
    home = robot.home[robot.free(held)]
    return replace(robot, joints=tuple(joints), points=tuple(points), home=home)


# --- numbers --------------------------------------------------------------------------------------


def _decimal(text: str) -> Any:
    """Read a decimal as a rational."""
    from flint import fmpq

    number = Decimal(text)
    if number and abs(number.adjusted()) > LARGEST_EXPONENT:
        raise ValueError(f"{text}: an exponent this far from 0 cannot be used in a proof")
    return fmpq(*number.as_integer_ratio())


def _rational(value: Any) -> Any:
    """Return an integer or a double as the rational that it is; a rational as it is."""
    from flint import fmpq

    return value if isinstance(value, fmpq) else fmpq(*value.as_integer_ratio())


def _rationals(numbers: Any) -> Array:
    """Return an object array of rationals."""
    plain = np.asarray(numbers, dtype=object)
    return np.asarray(np.vectorize(_rational, otypes=[object])(plain))


def _angle(value: Any, degrees: bool) -> arb:
    """Return an angle, or a length, as a ball."""
    return ball(_rational(value)) * pi() / 180 if degrees else ball(_rational(value))


# --- from a robot of doubles ----------------------------------------------------------------------


def _from_doubles(robot: Robot) -> Robot:
    joints = tuple(
        replace(
            joint,
            origin=_rationals(joint.origin),
            mount=_rationals(joint.mount),
            axis=_rationals(joint.axis),
            **_crank(joint, getattr(joint, "crank", None)),
        )
        for joint in robot.joints
    )
    points = tuple(
        replace(p, at=_rationals(p.at), radius=_rational(p.radius)) for p in robot.points
    )
    boundaries = tuple(b.with_numbers(vars(b), _rational, _rationals) for b in robot.boundaries)
    return replace(
        robot,
        joints=joints,
        points=points,
        boundaries=boundaries,
        bodies=tuple(map(_body, robot.bodies)),
        obstacles=tuple(map(_body, robot.obstacles)),
        clearance=_rational(robot.clearance),
    )


def _body(body: Body) -> Body:
    """Return a body with its doubles as rationals."""
    shape = body.shape
    radius = _rational(getattr(shape, "radius", 0))
    return replace(body, shape=_shape(shape, _rationals(shape.places), radius))


def _shape(shape: Shape, places: Array, radius: Any) -> Shape:
    """Return a shape of the same kind with other numbers."""
    if isinstance(shape, Polygon):
        return Polygon(places)
    if isinstance(shape, Capsule):
        return Capsule(places[0], places[1], radius)
    return Disc(places[0], radius)


# --- from a file ----------------------------------------------------------------------------------


def _from_table(robot: Robot, table: Table) -> Robot:
    """Put the numbers of a table of exact decimals into the robot that was read from it."""
    degrees = table["angle_unit"] == "deg"
    joints = (_joint(*pair, degrees) for pair in zip(robot.joints, table["joint"], strict=True))
    points = (
        replace(p, at=_rationals(row["at"]), radius=_rational(row.get("radius", 0)))
        for p, row in zip(robot.points, table["point"], strict=True)
    )
    rows = zip(robot.boundaries, table.get("boundary", ()), strict=True)
    boundaries = tuple(boundary.with_numbers(row, _rational, _unit) for boundary, row in rows)
    bodies, obstacles = (
        tuple(_body_of_row(*pair) for pair in zip(found, table.get(key, ()), strict=True))
        for found, key in ((robot.bodies, "body"), (robot.obstacles, "obstacle"))
    )
    return replace(
        robot,
        joints=tuple(joints),
        points=tuple(points),
        boundaries=boundaries,
        bodies=bodies,
        obstacles=obstacles,
        clearance=_rational(table.get("clearance", 0)),
    )


def _body_of_row(body: Body, row: Table) -> Body:
    """Return a body with the decimals of its table."""
    shape, value = body.shape, row[body.shape.key]
    if isinstance(shape, Polygon):
        rows, radius = value, 0
    else:
        keys = ("from", "to") if isinstance(shape, Capsule) else ("at",)
        rows, radius = [value[key] for key in keys], value["radius"]
    places = np.array([_place(*pair) for pair in zip(rows, shape.places, strict=True)])
    return replace(body, shape=_shape(shape, places, _rational(radius)))


def _place(numbers: Sequence[Any], near: Array) -> Array:
    """Return a place of the frame; of two numbers, with the 0 where the robot has put it."""
    exact = _rationals(numbers)
    if len(exact) == 3:
        return exact
    zero = next(
        k for k in (1, 2, 0) if not near[k] and np.array_equal(np.delete(near, k), _floats(exact))
    )
    return np.insert(exact, zero, _rational(0))


def _floats(numbers: Array) -> Array:
    return np.array([int(x.p) / int(x.q) for x in numbers])


def _joint(joint: Joint, row: Table, degrees: bool) -> Joint:
    in_degrees = degrees and joint.turns
    limits: Any = row.get("limits")
    if limits is not None:
        limits = tuple(_angle(x, in_degrees) for x in limits)
    return replace(
        joint,
        origin=_rationals(row["origin"]),
        mount=_mount(row.get("rpy", (0, 0, 0)), degrees),
        axis=_unit(row["axis"]),
        limits=limits,
        **_crank(joint, row.get("crank")),
    )


def _crank(joint: Joint, numbers: Any) -> dict[str, Any]:
    """Return what a parallelogram has besides, in rationals."""
    return {"crank": _rationals(numbers)} if isinstance(joint, Parallelogram) else {}


def _unit(vector: Sequence[Any]) -> Array:
    """Give a vector the length 1: in rationals where its length is one, else in balls."""
    v = _rationals(vector)
    square: Any = v @ v
    whole = [abs(n) == abs(n).isqrt() ** 2 for n in (square.p, square.q)]
    if all(whole):
        return np.asarray(v / type(square)(square.p.isqrt(), square.q.isqrt()))
    return np.asarray(v / ball(square).sqrt())


def _mount(rpy: Sequence[Any], degrees: bool) -> Array:
    """Return Rz(yaw) Ry(pitch) Rx(roll), as in URDF."""
    matrix = _rationals(np.eye(3, dtype=int).tolist())
    for axis, angle in zip((0, 1, 2), rpy, strict=True):
        matrix = _turn(axis, _rational(angle), degrees) @ matrix
    return matrix


def _turn(axis: int, angle: Any, degrees: bool) -> Array:
    """Return the rotation about a coordinate axis; quarter turns come out in whole numbers."""
    from flint import arb

    half_turns = angle / 180
    s, c = arb.sin_cos_pi_fmpq(half_turns) if degrees else ball(angle).sin_cos()
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = _rationals(np.eye(3, dtype=int).tolist())
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = map(_whole, (c, -s, s, c))
    return matrix


def _whole(value: arb) -> Any:
    """Return a ball that is exactly an integer as that integer."""
    whole: Any = value.unique_fmpz() if value.is_integer() else None
    return value if whole is None else _rational(int(whole))
