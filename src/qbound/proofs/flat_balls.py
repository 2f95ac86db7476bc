"""Bodies in the plane of motion, in balls: the functions of their features; for `check_arb`.

At joint values 0 every place of the arm is a complex number, seen along the joints' common axis. A
joint that turns moves what it carries about the place where it then stands, one that slides along
its direction; so no frame but the base's is needed. The functions of a feature are found from their
values, as all others are (`interpolation`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import product
from typing import Any

from qbound.proofs.grammar_robot import Body, Robot
from qbound.proofs.grammar_values import refuse, shown
from qbound.proofs.interpolation import (
    JointKind,
    Waves,
    interpolated,
    kind_of,
    mount,
    unit_vector,
)
from qbound.proofs.parts import check_parts, turns_left

SEEN = {1: (0, 2), 2: (0, 1), 0: (1, 2)}
"""The coordinates that are seen along y, z and x; the first axis that will do is the common one."""

SENSES = {1: -1, 2: 1, 0: 1}
"""How a turn about it turns what is seen: 1 from the first coordinate to the second."""

ROUNDING = (1, 10**9)
"""What rounded mounts may leave of a coordinate that is 0."""

Numbers = Sequence[int]
Places = tuple[Any, ...]

Function = Callable[[Sequence[Any]], Any]
"""From the values of some joints to a ball."""


class FlatArm:
    """The arm at joint values 0, and how its joints move it.

    Raises
    ------
    ValueError
        If the joints do not move it in one plane across a coordinate axis of the base.
    """

    def __init__(self, robot: Robot) -> None:
        from flint import acb, arb_mat

        self.robot = robot
        self.poses = [arb_mat([[int(i == k) for k in range(4)] for i in range(4)])]
        for joint in robot.joints:
            self.poses.append(self.poses[-1] * mount(robot, joint))
        axes = [
            (pose * arb_mat(4, 1, [*unit_vector(joint.axis), 0])).entries()[:3]
            for joint, pose in zip(robot.joints, self.poses[1:], strict=True)
        ]
        self.common = self._common(axes)
        first, second = SEEN[self.common]
        self.centres = [acb(pose[first, 3], pose[second, 3]) for pose in self.poses[1:]]
        self.slides = [acb(axis[first], axis[second]) for axis in axes]
        self.senses = [SENSES[self.common] * (1 if axis[self.common] > 0 else -1) for axis in axes]

    def _common(self, axes: Sequence[Sequence[Any]]) -> int:
        """Return the axis of the base about which joints turn, and across which they slide."""

        def fits(k: int) -> bool:
            gone = [
                axis[i]
                for joint, axis in zip(self.robot.joints, axes, strict=True)
                for i in (SEEN[k] if joint.turns else (k,))
            ]
            return all(map(_is_rounding, gone))

        found = [k for k in SEEN if fits(k)]
        if not found:
            refuse("robot: bodies need joints that move in a plane across x, y or z")
        return found[0]

    def own_axis(self, body: Body) -> int:
        """Return the coordinate of the body's frame that is along the common axis."""
        pose, seen = self.poses[body.frame], SEEN[self.common]
        found = [k for k in range(3) if all(_is_rounding(pose[i, k]) for i in seen)]
        if not found:
            refuse(f"robot: {shown(body.name)}: its frame has no axis along that of the joints")
        return found[0]

    def in_space(self, body: Body) -> list[tuple[Any, ...]]:
        """Return the places of a body as three coordinates of its frame."""
        own = self.own_axis(body)
        return [
            place if len(place) == 3 else (*place[:own], 0, *place[own:]) for place in body.places
        ]

    def outline(self, body: Body) -> list[tuple[Any, ...]]:
        """Return the two coordinates of the corners of an outline."""
        own = self.own_axis(body)
        corners = self.in_space(body)
        if any(corner[own] != corners[0][own] for corner in corners):
            refuse(f"robot: {shown(body.name)}: an outline that is not in one plane")
        return [corner[:own] + corner[own + 1 :] for corner in corners]

    def places(self, body: Body) -> list[Any]:
        """Return the places of a body at joint values 0."""
        from flint import acb, arb_mat, fmpq

        pose, seen = self.poses[body.frame], SEEN[self.common]
        found = []
        for place in self.in_space(body):
            numbers = [fmpq(x.numerator, x.denominator) for x in place]
            column = (pose * arb_mat(4, 1, [*numbers, 1])).entries()
            found.append(acb(*(column[i] for i in seen)))
        return found

    def moved(self, z: Any, joints: range, q: Sequence[Any], *, direction: bool = False) -> Any:
        """Return where some joints bring a place, or a direction; the outermost one moves first."""
        from flint import acb

        for j, value in reversed(list(zip(joints, q, strict=True))):
            if self.robot.joints[j].turns:
                turn = acb(0, self.senses[j] * value).exp()
                z = z * turn if direction else self.centres[j] + (z - self.centres[j]) * turn
            elif not direction:
                z = z + self.slides[j] * value
        return z


def _is_rounding(x: Any) -> bool:
    from flint import fmpq

    return bool(abs(x) <= fmpq(*ROUNDING))


@dataclass(frozen=True, eq=False)
class Core:
    """A convex part: its places at joint values 0, and the outward normals of its edges."""

    body: Body
    places: Places
    normals: Places

    def steps(self, i: int) -> list[Any]:
        """Return the steps from a place to its neighbours."""
        n = len(self.places)
        near = {(i - 1) % n, (i + 1) % n} - {i}
        return [self.places[k] - self.places[i] for k in near]


def cores_of(arm: FlatArm, body: Body, parts: Sequence[Numbers] | None) -> list[Core]:
    """Return the cores of a body; its parts, if it is an outline, are verified."""
    from flint import acb

    places, right = arm.places(body), acb(0, -1)
    if parts is None:
        parts = [range(len(places))]
    else:
        corners = arm.outline(body)
        check_parts(corners, parts, body.name)
        if turns_left(corners) != _seen_left(arm, body):
            right = acb(0, 1)
    cores = []
    for part in parts:
        own = [places[k] for k in part]
        normals = [right * (b - a) for a, b in zip(own, own[1:] + own[:1], strict=True)]
        cores.append(Core(body, tuple(own), tuple(normals) if len(own) > 1 else ()))
    return cores


def _seen_left(arm: FlatArm, body: Body) -> bool:
    """Tell whether what goes anticlockwise in a frame's two coordinates is seen like that."""
    pose, (first, second) = arm.poses[body.frame], SEEN[arm.common]
    a, b = (k for k in range(3) if k != arm.own_axis(body))
    return bool(pose[first, a] * pose[second, b] - pose[first, b] * pose[second, a] > 0)


class Features:
    """What separates two cores by more than `gap`, by its number: edges, edges, pairs of corners.

    Parameters
    ----------
    gap : fmpq
    reach : sequence of arb
        The largest length of each joint.
    """

    def __init__(
        self, arm: FlatArm, one: Core, other: Core, gap: Any, reach: Sequence[Any]
    ) -> None:
        self.arm, self.gap = arm, gap
        self.inner, self.outer = sorted((one, other), key=lambda core: core.body.frame)
        self.one, self.other = one, other
        self.joints = range(self.inner.body.frame, self.outer.body.frame)
        self.reach = [reach[j] for j in self.joints]

    @cached_property
    def kinds(self) -> list[JointKind]:
        """How functions go along each joint between the bodies."""
        return [kind_of(self.arm.robot, j) for j in self.joints]

    @property
    def count(self) -> int:
        """Number of features."""
        pairs = len(self.one.places) * len(self.other.places)
        return len(self.one.normals) + len(self.other.normals) + pairs

    def size(self, number: int) -> int:
        """Return how many values determine the functions of a feature."""
        functions: int = len(self._functions(number))
        return functions * math.prod(len(kind.nodes) for kind in self.kinds)

    def waves(self, number: int) -> list[Waves]:
        """Return the functions of a feature."""
        nodes = list(product(*(kind.nodes for kind in self.kinds)))
        return [
            interpolated(self.joints, self.kinds, [function(q) for q in nodes], self.reach)
            for function in self._functions(number)
        ]

    def _functions(self, number: int) -> list[Function]:
        """Return the functions of a feature, each of the values of the joints in between."""
        first, second = len(self.one.normals), len(self.other.normals)
        if number < first:
            return self._beyond_edge(self.one, number, self.other)
        if number < first + second:
            return self._beyond_edge(self.other, number - first, self.one)
        i, j = divmod(number - first - second, len(self.other.places))
        return self._nearest(i, j)

    def _beyond_edge(self, core: Core, i: int, other: Core) -> list[Function]:
        """Every place of the other core is farther than the gap beyond an edge."""

        def beyond(p: Any, q: Sequence[Any]) -> Any:
            normal = self._direction(core, core.normals[i], q)
            step = self._place(other, p, q) - self._place(core, core.places[i], q)
            return _dot(normal, step) - self.gap * abs(core.normals[i])

        return [partial(beyond, p) for p in other.places]

    def _nearest(self, i: int, j: int) -> list[Function]:
        """Two corners are farther apart than the gap, and nothing of the cores is nearer."""
        p, r = self.one.places[i], self.other.places[j]

        def step(q: Sequence[Any]) -> Any:
            return self._place(self.other, r, q) - self._place(self.one, p, q)

        def square(q: Sequence[Any]) -> Any:
            way = step(q)
            return _dot(way, way) - self.gap * self.gap

        def ahead(core: Core, sign: int, edge: Any, q: Sequence[Any]) -> Any:
            return sign * _dot(self._direction(core, edge, q), step(q))

        behind = [partial(ahead, self.one, -1, edge) for edge in self.one.steps(i)]
        beyond = [partial(ahead, self.other, 1, edge) for edge in self.other.steps(j)]
        return [square, *behind, *beyond]

    def _place(self, core: Core, z: Any, q: Sequence[Any]) -> Any:
        return z if core is self.inner else self.arm.moved(z, self.joints, q)

    def _direction(self, core: Core, z: Any, q: Sequence[Any]) -> Any:
        return z if core is self.inner else self.arm.moved(z, self.joints, q, direction=True)

    def overlap(self, weights: Sequence[Sequence[Any]], q: Sequence[Any]) -> bool:
        """Tell whether two places, means of the cores' corners, show them nearer than the gap.

        They are nearer than that, or one of them is inside the other core; two segments may cross.
        """
        q = [q[j] for j in self.joints]
        places = [
            self._place(core, sum((w * z for w, z in zip(row, core.places, strict=True)), 0), q)
            for row, core in zip(weights, (self.one, self.other), strict=True)
        ]
        way = places[1] - places[0]
        if _dot(way, way) - self.gap * self.gap < 0:
            return True
        inside = self._holds(self.one, places[1], q) or self._holds(self.other, places[0], q)
        return inside or self._crosses(q)

    def _crosses(self, q: Sequence[Any]) -> bool:
        """Tell whether two segments cross: the line of each parts the other's ends."""
        if not len(self.one.places) == len(self.other.places) == 2:
            return False
        for core, far in ((self.one, self.other), (self.other, self.one)):
            normal, start = self._direction(core, core.normals[0], q), core.places[0]
            start = self._place(core, start, q)
            first, second = (_dot(normal, self._place(far, r, q) - start) for r in far.places)
            if not first * second < 0:
                return False
        return True

    def _holds(self, core: Core, place: Any, q: Sequence[Any]) -> bool:
        """Tell whether a place is strictly inside an outline."""
        if len(core.places) < 3:
            return False
        return all(
            _dot(self._direction(core, n, q), place - self._place(core, a, q)) < 0
            for n, a in zip(core.normals, core.places, strict=True)
        )


def _dot(u: Any, v: Any) -> Any:
    return (u.conjugate() * v).real
