"""A boundary function as a sum of waves, found from its values alone; for `check_arb`.

Along one joint a boundary function is ``a cos q + b sin q + c``, or ``a q^2 + b q + c``: three
values determine it. So the values at 0, 1/3 and 2/3 of a turn of each joint that turns, and at 0, 1
and -1 of each that slides, are enough; the height over a plane has no square, and -1 is left out.
Numbers are balls.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from itertools import product
from typing import Any

from qbound.proofs.grammar import Point
from qbound.proofs.grammar_robot import Body, Boundary, Joint, Place, Robot, Vector

SMALL = 100
"""Waves that are ``2**-SMALL`` of the largest, or less, are put together into one number."""


@dataclass(frozen=True, eq=False)
class Wave:
    """The real part of `amplitude` times exp(i turns . q), times q_j to the powers."""

    amplitude: Any
    turns: tuple[int, ...]
    powers: tuple[int, ...]


class Waves:
    """A boundary function in some of the joints, rad or length.

    Parameters
    ----------
    joints : range
        The joints on which it depends.
    rows : sequence of Wave
    rest : arb
        At least the sum of all that was left out, anywhere in the set.
    """

    def __init__(self, joints: range, rows: Sequence[Wave], rest: Any) -> None:
        from flint import arb, arb_mat

        self.joints, self.rows, self.rest = joints, rows, rest
        self.slides = [wave for wave in rows if any(wave.powers)]
        n = len(joints)
        entries = [arb(0)] * (n * n)
        for wave in rows:
            if not any(wave.powers):
                size = abs(wave.amplitude)
                for i, j in product(range(n), repeat=2):
                    entries[n * i + j] += size * (wave.turns[i] * wave.turns[j])
        self.matrix = arb_mat(n, n, entries)
        turns = [k for wave in self.slides for k in wave.turns]
        self.turns = arb_mat(len(self.slides), n, turns)
        self.sizes = [abs(wave.amplitude) for wave in self.slides]

    def expanded(self, q: Sequence[Any]) -> tuple[Any, list[Any]]:
        """Return a number that is at most the value at q by `rest`, and the gradient there."""
        from flint import acb, arb

        around = [acb(0, x).exp() for x in q]
        value, slope = -self.rest, [arb(0) for _ in q]
        for wave in self.rows:
            z = wave.amplitude
            for e, k in zip(around, wave.turns, strict=True):
                if k:
                    z = z * (e if k > 0 else e.conjugate())
            lengths = [x**p for x, p in zip(q, wave.powers, strict=True) if p]
            length = reduce(lambda a, b: a * b, lengths, arb(1))
            value += z.real * length
            for j, (k, p) in enumerate(zip(wave.turns, wave.powers, strict=True)):
                if k:
                    slope[j] -= k * z.imag * length
                elif p:
                    slope[j] += z.real * self._slope_of_powers(wave.powers, q, j)
        return value, slope

    @staticmethod
    def _slope_of_powers(powers: Sequence[int], q: Sequence[Any], j: int) -> Any:
        """Return the derivative by q_j of the product of powers."""
        others = [x**p for i, (x, p) in enumerate(zip(q, powers, strict=True)) if p and i != j]
        own = 1 if powers[j] == 1 else 2 * q[j]
        return reduce(lambda a, b: a * b, others, own)

    def bending(self, corners: Sequence[Any], steps: Any) -> Any:
        """Bound minus the second derivative of the waves with slides, by the product rule.

        Parameters
        ----------
        corners : sequence of sequence of arb
        steps : sequence of sequence of arb
            From the centre to each corner; of a box to its high corner alone, which bounds all.
        """
        largest = [_largest(column) for column in zip(*corners, strict=True)]
        farthest = [_largest(column) for column in zip(*steps, strict=True)]
        total = 0
        for wave, size, u in zip(self.slides, self.sizes, self._widest(steps), strict=True):
            lone = sum(wave.powers) == max(wave.powers) == 2 and not any(wave.turns)
            if lone and wave.amplitude.real > 0:
                continue  # it bends upwards
            y, slope, bend = 1, u, u * u
            for q, d, power in zip(largest, farthest, wave.powers, strict=True):
                for _ in range(power):
                    y, slope, bend = y * q, slope * q + y * d, bend * q + 2 * slope * d
            total += size * bend
        return total

    def _widest(self, steps: Sequence[Any]) -> list[Any]:
        """Return for each wave with slides the largest of abs(turns . step)."""
        from flint import arb_mat

        if len(steps) == 1:  # of a box: the corner that turns each joint the same way as the wave
            signless = [abs(k) for k in self.turns.entries()]
            turns = arb_mat(self.turns.nrows(), self.turns.ncols(), signless)
            return list((turns * arb_mat(steps).transpose()).entries())
        rows = (self.turns * arb_mat(steps).transpose()).tolist()
        return [_largest(row) for row in rows]


def _largest(values: Sequence[Any]) -> Any:
    """Return the largest absolute value."""
    from flint import arb

    return reduce(lambda a, b: a.max(b), (abs(arb(value)) for value in values))


def exact(value: Fraction) -> Any:
    """Return a rational as Arb's."""
    from flint import fmpq

    return fmpq(value.numerator, value.denominator)


def units(robot: Robot) -> list[Any]:
    """Return radians, or lengths, in one unit of the file, for each joint."""
    from flint import arb

    angle = arb.pi() / 180 if robot.degrees else arb(1)
    return [angle if joint.turns else arb(1) for joint in robot.joints]


def reach_of(robot: Robot, points: Sequence[Point]) -> list[Any]:
    """Return the largest length of each joint that slides; 1 of one that turns."""
    from flint import arb

    columns = zip(*points, strict=True)
    return [
        arb(1) if joint.turns else arb(exact(max(map(abs, column))))
        for joint, column in zip(robot.joints, columns, strict=True)
    ]


# --- kinematics -----------------------------------------------------------------------------------


def joints_of(boundary: Boundary) -> range:
    """Return the joints on which a boundary depends: those between its ends, or below its point."""
    ends: tuple[Place | Body, ...] = (*boundary.places, *boundary.bodies)
    frames = sorted(end.frame for end in ends)
    return range(frames[0] if boundary.normal is None else 0, frames[-1])


def boundary_value(robot: Robot, boundary: Boundary, margin: Fraction, q: Sequence[Any]) -> Any:
    """Return a boundary function at a configuration, in the file's units."""
    joints, scales = joints_of(boundary), units(robot)
    return _values(robot, boundary, margin, [[scales[j] * q[j]] for j in joints])[0]


def _values(robot: Robot, boundary: Boundary, margin: Fraction, nodes: Sequence[Any]) -> list[Any]:
    """Return a boundary function at all combinations of some values of each of its joints.

    The outer point is carried inwards, joint after joint, to the frame of the inner one, or to the
    base. The value of the last joint varies first.
    """
    from flint import arb_mat

    ends = sorted(boundary.places, key=lambda place: place.frame)
    seen = arb_mat(4, 1, [*map(exact, ends[-1].at), 1])
    for j, values in reversed(list(zip(joints_of(boundary), nodes, strict=True))):
        fixed = mount(robot, robot.joints[j])
        parts = [(fixed * _moved(robot.joints[j], value) * seen).tolist() for value in values]
        seen = arb_mat([[x for part in parts for x in part[row]] for row in range(4)])
    least = exact(boundary.least + margin)
    if boundary.normal is not None:
        normal = unit_vector(boundary.normal)
        rows = zip(*seen.tolist()[:3], strict=True)
        return [dot(normal, place) - least for place in rows]
    gaps = [
        [x - y for x in row]
        for row, y in zip(seen.tolist()[:3], map(exact, ends[0].at), strict=True)
    ]
    return [dot(gap, gap) - least * least for gap in zip(*gaps, strict=True)]


def dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    """Return the sum of products."""
    return sum((x * y for x, y in zip(u, v, strict=True)), 0)


def unit_vector(vector: Vector) -> list[Any]:
    """Give a direction the length 1; its numbers may be far from 1."""
    from flint import arb

    length = arb(exact(dot(vector, vector))).sqrt()
    return [exact(x) / length for x in vector]


def mount(robot: Robot, joint: Joint) -> Any:
    """Return the frame in which a joint moves, seen from its parent: origin, then Rz Ry Rx."""
    from flint import arb

    matrix = _shift([exact(x) for x in joint.origin])
    radian = arb.pi() / 180 if robot.degrees else arb(1)
    for axis in (2, 1, 0):
        fixed = [arb(int(axis == k)) for k in range(3)]
        matrix = matrix * _rotation(fixed, exact(joint.rpy[axis]) * radian)
    return matrix


def _moved(joint: Joint, value: Any) -> Any:
    axis = unit_vector(joint.axis)
    return _rotation(axis, value) if joint.turns else _shift([value * x for x in axis])


def _shift(by: Sequence[Any]) -> Any:
    from flint import arb_mat

    x, y, z = by
    return arb_mat([[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]])


def _rotation(axis: Sequence[Any], angle: Any) -> Any:
    """``I + sin K + (1 - cos) K^2``, with ``K`` the matrix of the cross product."""
    from flint import arb, arb_mat

    x, y, z = axis
    k = arb_mat([[0, -z, y, 0], [z, 0, -x, 0], [-y, x, 0, 0], [0, 0, 0, 0]])
    one = arb_mat([[int(i == j) for j in range(4)] for i in range(4)])
    angle = arb(angle)
    return one + k * angle.sin() + k * k * (1 - angle.cos())


# --- from values to waves -------------------------------------------------------------------------


def waves_of(
    robot: Robot,
    boundary: Boundary,
    margin: Fraction,
    reach: Sequence[Any],
    held: Mapping[int, Any] | None = None,
) -> Waves:
    """Return a boundary function as waves.

    Parameters
    ----------
    reach : sequence of arb
        The largest length of each joint.
    held : mapping of int to arb, optional
        Values of joints that stay where they are, rad or length: no wave depends on them.
    """
    joints, straight = joints_of(boundary), boundary.normal is not None
    kinds = [
        held_kind(held[j]) if held and j in held else kind_of(robot, j, straight=straight)
        for j in joints
    ]
    values = _values(robot, boundary, margin, [kind.nodes for kind in kinds])
    return interpolated(joints, kinds, values, [reach[j] for j in joints])


def interpolated(
    joints: range, kinds: Sequence[JointKind], values: Sequence[Any], reach: Sequence[Any]
) -> Waves:
    """Return the function of some joints that has given values: each amplitude is a weighted sum.

    Parameters
    ----------
    values : sequence of arb
        At all combinations of the joints' nodes; that of the last joint varies first.
    reach : sequence of arb
        The largest length of each of these joints.
    """
    from flint import acb, acb_mat

    values = [acb(value) for value in values]
    for kind in kinds:  # each joint in turn comes first, and goes to the end
        along_first = acb_mat(len(kind.nodes), len(values) // len(kind.nodes), values)
        values = (kind.weights * along_first).transpose().entries()
    signs, powers = [kind.turns for kind in kinds], [kind.powers for kind in kinds]
    rows = []
    for turns, lengths, amplitude in zip(product(*signs), product(*powers), values, strict=True):
        first = next((k for k in turns if k), 0)
        if first >= 0:  # the other half are mirror images
            rows.append(Wave(amplitude * (2 if first else 1), turns, lengths))
    return _gathered(joints, rows, reach)


def values_of(robot: Robot, boundary: Boundary) -> int:
    """Return how many values of a boundary function determine it."""
    flat = 2 if boundary.normal is not None else 3
    return math.prod(3 if robot.joints[j].turns else flat for j in joints_of(boundary))


@dataclass(frozen=True, eq=False)
class JointKind:
    """How a function goes along one joint: from values at nodes, by weights, to amplitudes."""

    nodes: Sequence[Any]
    weights: Any
    turns: tuple[int, ...]
    powers: tuple[int, ...]


def kind_of(robot: Robot, j: int, *, straight: bool = False) -> JointKind:
    """Return how boundary functions go along a joint; `straight`: a slide has no square in them."""
    from flint import acb, acb_mat, arb, fmpq

    if robot.joints[j].turns:
        third, root = 2 * arb.pi() / 3, acb(fmpq(2, 3)).exp_pi_i()
        thirds = acb_mat(3, 3, [root ** (-w * k) / 3 for w in (0, 1, -1) for k in range(3)])
        return JointKind([0 * third, third, 2 * third], thirds, (0, 1, -1), (0, 0, 0))
    if straight:
        return JointKind([arb(0), arb(1)], acb_mat(2, 2, [1, 0, -1, 1]), (0, 0), (0, 1))
    half = fmpq(1, 2)
    square = acb_mat(3, 3, [1, 0, 0, 0, half, -half, -1, half, half])
    return JointKind([arb(0), arb(1), arb(-1)], square, (0, 0, 0), (0, 1, 2))


def held_kind(value: Any) -> JointKind:
    """Return the kind of a joint that has one value: its one node is all."""
    from flint import acb_mat

    return JointKind([value], acb_mat(1, 1, [1]), (0,), (0,))


def _gathered(joints: range, rows: Sequence[Wave], reach: Sequence[Any]) -> Waves:
    """Put all waves that are nothing but rounding together into one number."""
    from flint import arb

    sizes = [
        reduce(
            lambda a, b: a * b,
            (x**p for x, p in zip(reach, wave.powers, strict=True) if p),
            abs(wave.amplitude),
        ).upper()
        for wave in rows
    ]
    small = max(sizes) * arb(2) ** -SMALL
    kept = [wave for wave, size in zip(rows, sizes, strict=True) if size > small]
    rest = sum((size for size in sizes if not size > small), arb(0))
    return Waves(joints, kept, rest)
