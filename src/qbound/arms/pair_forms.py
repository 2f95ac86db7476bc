r"""Forms of all pairs of spheres of two links, in exact numbers and in floats.

The form of spheres i and j is :math:`\beta_{ij} = |B_{ij}|^2 - (r_i + r_j)^2` (eq. 11 without a
clearance) in the joints between both links' frames. If a form does not change with a joint except
by rounding, the joint is left out, and a ball in the constant holds the rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from qbound.arms.links import Link
from qbound.arrays import Floats
from qbound.boundary.evaluator import stacked
from qbound.forms.harmonic import HarmonicForm, add_constant
from qbound.model.robot import Joint, Pair, Robot
from qbound.proofs.exact.bounds import BITS, magnitude
from qbound.proofs.exact.numbers import above, arb, ball, balls, below, pi, precision
from qbound.tolerances import ZERO_AMPLITUDE

Ends = tuple[tuple[arb, arb], ...]


@dataclass(frozen=True, eq=False)
class PairForms:
    """Clearance forms of all pairs of balls of two links.

    Attributes
    ----------
    forms : HarmonicForm, shape (m,)
        Exact coefficients or balls, in the joints that matter.
    joints : tuple of int
        These joints, by index of the robot.
    ends : tuple of (arb, arb)
        Their ranges; of what turns a turn or more, one turn.
    names : tuple of (str, str)
        The balls of each form.
    distances : ndarray, shape (m,)
        Sum of both radii, length.
    """

    forms: HarmonicForm
    joints: tuple[int, ...]
    ends: Ends
    names: tuple[tuple[str, str], ...]
    distances: Floats

    @cached_property
    def floats(self) -> HarmonicForm:
        """The forms in floats."""
        with precision(BITS):
            coefficients = balls(self.forms.coefficients).astype(float)
        return HarmonicForm(coefficients, self.forms.kinds)

    @cached_property
    def box(self) -> tuple[Floats, Floats]:
        """The ranges in floats, rounded inward, shape (n,) each."""
        with precision(BITS):
            low = [above(a) for a, _ in self.ends]
            high = [below(b) for _, b in self.ends]
        return np.array(low), np.array(high)

    def single(self, k: int) -> PairForms:
        """Return one form alone, in the joints that matter to it."""
        one = replace(
            self, forms=self.forms[[k]], names=self.names[k : k + 1], distances=self.distances[[k]]
        )
        return _without_idle(one)

    def values(self, q: Floats) -> Floats:
        """Return the value of every form in floats, shape (N, n) to (N, m)."""
        return np.broadcast_to(self.floats(q), (len(q), len(self.names)))

    def gaps(self, q: Floats) -> Floats:
        """Return the distances between the balls' surfaces, shape (N, n) to (N, m).

        Negative by the depth where balls overlap; length. To search with: see `gap`.
        """
        d = self.distances
        return np.asarray(np.sqrt(np.maximum(self.values(q) + d * d, 0)) - d)

    def gap(self, q: Floats, k: int) -> float:
        """Return the distance between the surfaces of two balls at one configuration; length.

        It is right to the last digits. In floats (`gaps`) that of two balls with one middle is off
        by the square root of rounding, because the terms of the squared distance cancel.
        """
        with precision(BITS):
            place = np.array([ball(x) for x in q.tolist()], dtype=object)
            d = ball(self.distances[k])
            squared = float(np.ravel(balls(self.forms[[k]](place)))[0] + d * d)
        return math.sqrt(max(squared, 0.0)) - float(self.distances[k])

    def exact(self, q: Floats) -> list[arb]:
        """Enclose the value of every form at one configuration, which counts as it is written."""
        with precision(BITS):
            place = np.array([ball(x) for x in q.tolist()], dtype=object)
            return list(np.atleast_1d(balls(self.forms(place))))

    def contains(self, q: Floats) -> bool:
        """Tell whether a configuration is certainly within the ranges."""
        with precision(BITS):
            ends = zip(self.ends, q.tolist(), strict=True)
            return all(bool(low <= ball(x)) and bool(ball(x) <= high) for (low, high), x in ends)


def pair_forms(robot: Robot, one: Link, other: Link) -> PairForms:
    """Return the forms of two links of an exact robot (`proofs.exact.problem.exact_robot`).

    Between two frames only the joints from the one to the other are looked at: the chain is cut
    there, and the form is that of a shorter arm. The bar of a parallelogram sees what its own joint
    carries turn back, so that the cut is before that joint.
    """
    near, far = sorted((one, other), key=lambda link: (link.depth, not _is_bar(robot, link)))
    first = near.depth - (near.frame != far.frame and _is_bar(robot, near))
    joints = robot.joints[first : far.depth]
    pairs = [Pair("", (a.name, b.name), 0) for a in near.balls for b in far.balls]
    if not joints:
        return _at_rest(near, far)
    arm = replace(robot, joints=joints, points=(*near.balls, *far.balls), boundaries=())
    with precision(BITS):
        found = PairForms(
            forms=stacked(arm, pairs),
            joints=tuple(range(first, far.depth)),
            ends=tuple(_ends(joint) for joint in joints),
            names=tuple(pair.points for pair in pairs),
            distances=np.array([float(arm.required_distance(pair)) for pair in pairs]),
        )
    return _without_idle(found)


def _is_bar(robot: Robot, link: Link) -> bool:
    """Tell whether a link turns within a parallelogram, in place of being carried by it."""
    return link.depth > 0 and link.frame != robot.joints[link.depth - 1].frame


def _at_rest(one: Link, other: Link) -> PairForms:
    """Return the forms of two links of one frame: constants."""
    pairs = [(a, b) for a in one.balls for b in other.balls]
    values = [(a.at - b.at) @ (a.at - b.at) - (a.radius + b.radius) ** 2 for a, b in pairs]
    return PairForms(
        forms=HarmonicForm(np.array(values, dtype=object), ()),
        joints=(),
        ends=(),
        names=tuple((a.name, b.name) for a, b in pairs),
        distances=np.array([float(a.radius + b.radius) for a, b in pairs]),
    )


def _ends(joint: Joint) -> tuple[arb, arb]:
    """Return a joint's range; of one that turns a turn or more, one turn within it."""
    if joint.limits is None:
        return -pi(), pi()
    low, high = map(ball, joint.limits)
    if not (joint.turns and high - low >= 2 * pi()):
        return low, high
    return (-pi(), pi()) if low <= -pi() and pi() <= high else (low, low + 2 * pi())


def _without_idle(pair: PairForms) -> PairForms:
    """Leave out joints that change no form by more than rounding; the constants take that in."""
    forms, kept = pair.forms, list(range(len(pair.joints)))
    with precision(BITS):
        reach = [max(above(abs(low)), above(abs(high))) for low, high in pair.ends]
        for j in reversed(range(len(kept))):
            axis = len(forms.shape) + j
            still, moving = np.split(forms.coefficients, [1], axis=axis)
            rest = np.concatenate([0 * still, moving], axis=axis)
            change = magnitude(HarmonicForm(rest, forms.kinds), reach)
            if (change <= ZERO_AMPLITUDE * magnitude(forms, reach)).all():
                kinds = forms.kinds[:j] + forms.kinds[j + 1 :]
                slack = np.array([ball(0).union(x).union(-x) for x in map(ball, change.tolist())])
                forms = HarmonicForm(add_constant(still.squeeze(axis), slack), kinds)
                del kept[j], reach[j]
    return replace(
        pair,
        forms=forms,
        joints=_chosen(pair.joints, kept),
        ends=tuple(pair.ends[j] for j in kept),
    )


def _chosen(items: Sequence[int], which: Sequence[int]) -> tuple[int, ...]:
    return tuple(items[j] for j in which)
