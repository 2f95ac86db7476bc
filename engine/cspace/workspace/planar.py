"""Arms of two joints that move the tool in a plane: det J, its zeros, inverse kinematics.

The first joint moves the tool rigidly: on circles about its axis, or along lines. On a circle (or a
line) only the second joint decides where the tool can be, so det J depends on the second joint
alone, and the two postures of a place lie mirrored at a zero of det J. None of this is in the
paper, whose Section 4 only says that the stretched pose is a singularity.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Complexes, Floats
from cspace.forms import factors
from cspace.forms.factors import FACTORS
from cspace.forms.harmonic import derivatives, restrict, size
from cspace.model.robot import Robot, real_numbers
from cspace.order import first_largest
from cspace.printable import printable
from cspace.tolerances import NEGLIGIBLE, ON_BOUNDARY, ZERO_AMPLITUDE
from qbound.boundary import position
from qbound.circle import TURN, nearest_turn
from qbound.forms import HarmonicForm, Kind, basis

Range = tuple[float, float] | None


class NoPlanarWorkspaceError(ValueError):
    """The tool does not move in a plane, or only along a curve; the message says which."""


class AnyTurnError(ValueError):
    """A place on the first joint's axis is reached with every value of that joint."""


@dataclass(frozen=True, eq=False)
class Posture:
    """One way to reach a place.

    Attributes
    ----------
    q : ndarray, shape (2,)
        Values of the two free joints, rad or length.
    side : int
        Sign of det J there: +1, -1; 0 on the singular curve.
    """

    q: Floats
    side: int


@dataclass(frozen=True, eq=False)
class PlanarArm:
    r"""The tool map of two joints, :math:`q \mapsto (x, z)`, that stays in a plane.

    With places written as complex numbers in the `frame` of the first joint the map is
    :math:`e^{i q_1} v(q_2)` (revolute) or :math:`q_1 + v(q_2)` (prismatic).

    Attributes
    ----------
    tool : HarmonicForm, shape (2,)
        Coordinates of the tool in the plane; length.
    axes : ndarray, shape (2, 3)
        Unit vectors of the two coordinates, seen from the base.
    singular : HarmonicForm, shape ()
        det J of `tool`: a form of the second joint alone.
    centre : complex
        Place of the first joint's axis, x + iz; 0 where the joint is prismatic.
    turn : complex
        Direction of the first joint's slide; 1 where the joint is revolute.
    sense : int
        +1 where the first joint turns from the first coordinate to the second, or slides; -1 where
        it turns the other way.
    v : ndarray of complex, shape (3,)
        Coefficients of v in the second joint.
    """

    tool: HarmonicForm
    axes: Floats
    singular: HarmonicForm
    centre: complex
    turn: complex
    sense: int
    v: Complexes

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """Kinds of the two joints."""
        return self.tool.kinds

    @property
    def period(self) -> float | None:
        """Full turn of the first joint; None where it slides."""
        return math.tau if self.kinds[0] == "revolute" else None

    @cached_property
    def singularity(self) -> tuple[float, float] | None:
        r"""Centre s and slope d of the singularity that mirrors postures; None where none does.

        :math:`\det J = d \sin(q_2 - s)` (second joint revolute, d > 0) or
        :math:`\det J = d (q_2 - s)` (RP). In PP robots det J is constant.
        """
        c0, c1, c2 = self.singular.coefficients[0]
        if self.kinds[1] == "revolute":
            return math.atan2(-c1, c2), math.hypot(c1, c2)
        return None if c1 == 0 else (-c0 / c1, c1)

    @property
    def sides(self) -> tuple[int, ...]:
        """The signs that det J takes, the positive one first."""
        return (1, -1) if self.singularity else (int(np.sign(self.singular.coefficients[0, 0])),)

    def second(self, side: int, u: ArrayLike) -> Any:
        """Return the second joint's value at a distance u >= 0 from the singularity, on a side."""
        if self.singularity is None:
            return np.asarray(u)
        centre, slope = self.singularity
        return centre + side * math.copysign(1, slope) * np.asarray(u)

    def distance_to_singularity(self, q2: ArrayLike) -> Any:
        """Return how far values of the second joint are from the singularity, modulo full turns."""
        if self.singularity is None:
            return np.asarray(q2)
        away = np.asarray(q2) - self.singularity[0]
        return np.abs(nearest_turn(away, 0) if self.kinds[1] == "revolute" else away)

    def abs_det_jacobian(self, u: ArrayLike) -> Any:
        """Return abs(det J) at a distance u from the singularity: the same on both sides."""
        if self.singularity is None:
            return np.full_like(np.asarray(u), abs(self.singular.coefficients[0, 0]))
        slope = abs(self.singularity[1])
        return slope * (np.sin(u) if self.kinds[1] == "revolute" else np.asarray(u))

    def phase(self, q2: ArrayLike) -> Any:
        """Return where on its circle or line the tool is at q1 = 0: an angle, or a length."""
        v = basis(self.kinds[1], q2) @ self.v
        return np.angle(v) if self.period else v.real

    def place(self, q2: ArrayLike, along: ArrayLike) -> Floats:
        """Return the place at `along` on the circle or line of q2, shape (..., 2); length.

        `along` is q1 + `phase`.
        """
        v, along = basis(self.kinds[1], q2) @ self.v, np.asarray(along)
        z = np.abs(v) * np.exp(1j * along) if self.period else along + 1j * v.imag
        w = self.centre + self.turn * (z if self.sense > 0 else z.conj())
        return np.stack([w.real, w.imag], axis=-1)

    def in_frame(self, place: ArrayLike) -> complex:
        """Return a place, shape (2,), as a complex number in the first joint's frame."""
        x, z = np.asarray(place, dtype=float)
        w = (complex(x, z) - self.centre) / self.turn
        return w if self.sense > 0 else w.conjugate()


def planar_arm(robot: Robot, held: Mapping[int, float] | None = None) -> PlanarArm:
    """Return the tool map of the two joints that are not held, in the plane of the tool's motion.

    The plane's coordinates are two axes of the base, projected into it: x and z for a plane that
    holds them, as in the paper.

    Raises
    ------
    NoPlanarWorkspaceError
        If the tool leaves the plane, or det J is zero everywhere.
    ValueError
        If not exactly two joints are left free.
    """
    held = held or {}
    free = len(robot.joints) - len(held)
    if free != 2:
        raise ValueError(f"{printable(robot.name)} has {free} joints that are not held, not two")
    r = restrict(position(robot, robot.tool), held)
    axes = _plane(r)
    tool = r.dot(axes)
    frame = _first_joint(tool)
    singular = _without_rounding(jacobian_determinant(tool), tool)
    if not singular.coefficients.any():
        raise NoPlanarWorkspaceError("det J = 0 everywhere: the tool moves along a curve only")
    return PlanarArm(tool, axes, singular, *frame)


def singular_form(robot: Robot, held: Mapping[int, float] | None = None) -> HarmonicForm:
    r"""Return det J of the tool map in its plane, a form of the second joint alone.

    The form is zero on the singular curve. For the paper's arm it is
    :math:`-x_{2,3} (x_{1,2} \sin q_2 + z_{1,2} \cos q_2)`; arguments and errors as `planar_arm`.
    """
    return planar_arm(robot, held).singular


def postures(
    arm: PlanarArm, place: ArrayLike, ranges: tuple[Range, Range] = (None, None)
) -> list[Posture]:
    """Return the configurations that bring the tool to a place: inverse kinematics, closed form.

    Parameters
    ----------
    place : array_like, shape (2,)
        Coordinates in the arm's plane; length.
    ranges : pair of (low, high) or None
        Range of each joint: every full turn within it is listed. None (a joint that turns all
        the way round, or a slide without end): once, angles in (-pi, pi].

    Returns
    -------
    list of Posture
        Postures with det J > 0 first. Empty if the place is out of reach or no posture is within
        the ranges.

    Raises
    ------
    ValueError
        If a coordinate is not finite, or every value of the first joint brings the tool to the
        place, which is on its axis: an ``AnyTurnError``.
    """
    if not np.isfinite(real_numbers(place)).all():
        raise ValueError("a place needs two finite coordinates")
    z = arm.in_frame(place)
    u, singular = _distance(arm, z)
    found = []
    for side in arm.sides[:1] if singular else arm.sides:
        if u is not None:
            q2 = float(arm.second(side, u))
            first = values_within(arm.kinds[0], _first(arm, z, q2), ranges[0])
            second = values_within(arm.kinds[1], q2, ranges[1])
            if second and arm.period and abs(z) <= ZERO_AMPLITUDE * np.abs(arm.v).max():
                raise AnyTurnError(_any_turn(place, arm.kinds[1], second[0]))
            sign = 0 if singular else side
            found += [Posture(np.array([a, b]), sign) for b in second for a in first]
    return found


def planar_postures(robot: Robot, place: ArrayLike) -> Floats:
    """Return the configurations of `Robot.inverse_kinematics`."""
    at = real_numbers(place)
    if at.shape != (3,) or not np.isfinite(at).all():
        raise ValueError(f"a place needs three finite coordinates, found {at.tolist()}")
    arm = planar_arm(robot)
    away = at - robot.forward_kinematics(robot.home)
    off = away - arm.axes.T @ (arm.axes @ away)
    if np.linalg.norm(off) > ON_BOUNDARY * max(robot.stretched(robot.tool), 1e-300):
        return np.empty((0, 2))
    one, other = (joint.limits for joint in robot.joints)
    found = postures(arm, arm.axes @ at, (one, other))
    return np.array([posture.q for posture in found]).reshape(-1, 2)


def _distance(arm: PlanarArm, z: complex) -> tuple[float | None, bool]:
    """Return the distance u from the singularity at which the tool is on the circle or line of z.

    None if out of reach. Also return whether the place is on the singularity. Along q2 the circle's
    squared radius changes by -2 det J (in the first joint's frame), the line's height by det J.
    """
    centre, slope = arm.singularity or (0.0, float(arm.singular.coefficients[0, 0]))
    v = complex(basis(arm.kinds[1], centre) @ arm.v)
    size = abs(z) + abs(v) + abs(arm.v[0])
    if arm.period:
        wanted, scale = (abs(v) ** 2 - abs(z) ** 2) / 2, size**2
    else:
        wanted, scale = z.imag - v.imag, size
    ratio, slack = arm.sense * wanted / slope, NEGLIGIBLE * scale / abs(slope)
    if arm.singularity is None:
        return ratio, False
    highest = 2.0 if arm.kinds[1] == "revolute" else math.inf
    if not -slack <= ratio <= highest + slack:
        return None, False
    half = min(max(ratio, 0.0), highest) / 2
    u = 2 * math.asin(math.sqrt(half)) if highest == 2 else 2 * math.sqrt(half)
    return u, ratio <= slack or ratio >= highest - slack


def _first(arm: PlanarArm, z: complex, q2: float) -> float:
    """Return the first joint's value that brings the tool to z with the second at q2."""
    if arm.period is None:
        return float(z.real - arm.phase(q2))
    return float(np.angle(z) - arm.phase(q2))


def _any_turn(place: ArrayLike, kind: Kind, q2: float) -> str:
    x, z = np.asarray(place, dtype=float)
    q2 += 0.0  # no negative zero
    at = f"{q2:.6g}" if kind == "prismatic" else f"{math.degrees(q2):.6g} deg"
    return (
        f"the place ({x:g}, {z:g}) is on the axis of the first joint: every value of it brings the"
        f" tool there while the second one is at {at}"
    )


def values_within(kind: Kind, q: float, limits: Range) -> list[float]:
    """Return a value with all its full turns within a range; without a range only the value."""
    if kind == "prismatic":
        return [q] if limits is None or limits[0] <= q <= limits[1] else []
    if limits is None:
        return [float(nearest_turn(q, 0))]
    return [q + TURN * k for k in factors.turns_within(*limits, q)]


def _plane(r: HarmonicForm) -> Floats:
    """Return unit vectors of the plane in which a point moves, shape (2, 3)."""
    # Coefficients of a slide are directions: they count by lengths, as those of a turn do.
    slides = np.add.outer(*(FACTORS[kind].powers for kind in r.kinds))
    reach = float(np.abs(r.coefficients[:, slides == 0]).max()) or 1.0
    moving = np.array(r.coefficients, dtype=float) * reach**slides
    moving[:, 0, 0] = 0.0
    left, sizes, _ = np.linalg.svd(moving.reshape(3, -1))
    rank = int((sizes > ZERO_AMPLITUDE * reach).sum())
    if rank > 2:
        raise NoPlanarWorkspaceError(
            "the tool leaves the plane: the two joints do not move it in parallel planes"
        )
    if rank < 2:
        raise NoPlanarWorkspaceError("det J = 0 everywhere: the tool moves along a line at most")
    normal = left[:, 2]
    i, j = np.delete(np.arange(3), first_largest(np.abs(normal)))
    one = np.eye(3)[i] - normal[i] * normal
    one /= np.linalg.norm(one)
    other = np.cross(normal, one)
    return np.array([one, other * np.sign(other[j])]) + 0.0  # no negative zeros


def _first_joint(tool: HarmonicForm) -> tuple[complex, complex, int, Complexes]:
    """Return centre, turn and sense of the first joint's frame, and v in it."""
    c = tool.coefficients[0] + 1j * tool.coefficients[1]
    if tool.kinds[0] == "prismatic":
        return 0j, complex(c[1, 0]), 1, c[0] / c[1, 0]
    ahead = (c[1].conj() * c[2]).sum().imag  # c[2] is c[1] turned by a right angle
    sense = 1 if ahead >= 0 else -1
    return complex(c[0, 0]), 1 + 0j, sense, c[1] if sense > 0 else c[1].conj()


def jacobian_determinant(tool: HarmonicForm) -> HarmonicForm:
    """Return det J of a tool map of two joints in its plane: a form of the second joint alone.

    The first joint moves the plane rigidly, so its own value does not matter and is set to 0. In
    the products all parts of higher degree cancel.

    Parameters
    ----------
    tool : HarmonicForm, shape (2,)
        Coefficients of any type that can be halved.
    """
    still = basis(tool.kinds[0], 0).astype(int)
    one, other = (
        np.tensordot(still, tool.derivative(j).coefficients, axes=([0], [1])) for j in (0, 1)
    )
    products = np.multiply.outer(one[0], other[1]) - np.multiply.outer(one[1], other[0])
    table = np.zeros((3, 3), dtype=products.dtype)
    table[0] = (FACTORS[tool.kinds[1]].product * products).sum(axis=(1, 2)) / 2
    return HarmonicForm(table, tool.kinds)


def _without_rounding(singular: HarmonicForm, tool: HarmonicForm) -> HarmonicForm:
    """Set det J to zero where it is rounding, relative to the products whose difference it is."""
    reach = [float(np.abs(tool.coefficients).max())] * 2
    length = np.linalg.norm(size(derivatives(tool), reach), axis=0).prod()
    terms = np.abs(singular.coefficients) * FACTORS[tool.kinds[1]].largest(reach[1])
    kept = terms > ZERO_AMPLITUDE * length
    return HarmonicForm(np.where(kept, singular.coefficients, 0.0), tool.kinds)
