r"""Values of one joint that the arm cannot pass for any values of the other joints, in closed form.

A boundary function is split into the part that depends only on one joint q, and the rest. The rest
is at most R, so the boundary is certainly violated where

.. math::

   a\cos q + b\sin q + c + R < 0,

which Theorem 2 solves: on one arc of the circle, between two roots. (On a slide, a quadratic.) Most
boundaries of neighbouring links depend on one joint only. Then R is 0 and the arc is exact. Numbers
are balls and roots are rounded inwards, so every value in a range is really blocked. Not in the
paper.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cspace.arrays import Floats
from cspace.boundary.evaluator import stacked
from cspace.boundary.functions import clearance
from cspace.boundary.poses import bounds_bodies
from cspace.forms.factors import FACTORS
from cspace.forms.harmonic import waves
from cspace.model.robot import Boundary, Robot
from cspace.proofs.exact.bounds import magnitude
from cspace.proofs.exact.numbers import above, arb, ball, below, line_roots, precision, turns
from cspace.proofs.exact.problem import exact_robot
from qbound.circle import circle_arc
from qbound.forms import HarmonicForm

Alone = tuple[arb, arb, arb]
"""Coefficients of one joint's (1, cos q, sin q) or (1, q, q²)."""

BITS = 100
"""Precision of the balls: roots are rounded to doubles of 53."""

NEARLY = 1e-6
"""Doubles look for what may be blocked: what comes this near to it, in parts, is looked at."""


@dataclass(frozen=True)
class BlockedRange:
    """Values of a joint, ends included, at which a boundary is violated for all others' values.

    Attributes
    ----------
    joint : int
    low, high : float
        rad, low in (-pi, 3 pi) and high less than a turn above it; for a slide a length, infinite
        on a side without an end. Both ends are violated too, because they are rounded inwards.
    boundary : str
    """

    joint: int
    low: float
    high: float
    boundary: str


def blocked_ranges(robot: Robot, groups: Sequence[object] = ()) -> list[BlockedRange]:
    """Return ranges of joints that a boundary of points blocks, each proved.

    Parameters
    ----------
    robot : Robot
        Its numbers are read as `exact_robot` reads them.
    groups : sequence, optional
        One label for each of `robot.used`: a range within another of the same joint and label is
        left out. Without labels, all are one group.

    Returns
    -------
    list of BlockedRange
        By joint, then by low end. A boundary that no configuration keeps gives no range, because
        nothing lies on either side.
    """
    labels = list(groups) or [None] * len(robot.used)
    chosen = [(k, b) for k, b in enumerate(robot.used) if not bounds_bodies(b)]
    found = _widest(
        likely(robot, [b for _, b in chosen]), [labels[k] for k, _ in chosen], robot.kinds
    )
    if not found:
        return []
    exact = exact_robot(robot)
    names = {b.name: b for b in exact.used}
    rows = ((j, names[chosen[i][1].name]) for i, j in found)
    ranges = [_range(exact, j, boundary) for j, boundary in rows]
    return sorted((r for r in ranges if r), key=lambda r: (r.joint, r.low, r.high))


# --- in doubles: what may be blocked --------------------------------------------------------------


def likely(robot: Robot, boundaries: Sequence[Boundary]) -> Iterator[tuple[int, int, Floats]]:
    """Yield boundary, joint and (c, a, b) of forms that may block a range, with R added to c.

    The computation is in doubles and proves nothing.
    """
    terms = waves(stacked(robot, boundaries))
    reach = np.array([joint.farthest for joint in robot.joints])
    sizes = np.abs(terms.amplitudes) * np.prod(reach**terms.powers, axis=1)
    used = (terms.turns != 0) | (terms.powers != 0)
    for j, joint in enumerate(robot.joints):
        others = used.copy()
        others[:, j] = False
        alone, own = ~others.any(axis=1), used[:, j]
        rest = sizes[:, ~alone].sum(axis=1)
        constant = terms.amplitudes[:, ~used.any(axis=1)].real.sum(axis=1) + rest
        if joint.turns:
            z = terms.amplitudes[:, alone & own].sum(axis=1)
            table = np.stack([constant, z.real, -z.imag], axis=1)
            lowest = constant - np.abs(z)
        else:
            powers = [alone & (terms.powers[:, j] == p) for p in (1, 2)]
            linear, square = (terms.amplitudes[:, p].real.sum(axis=1) for p in powers)
            table = np.stack([constant, linear, square], axis=1)
            lowest = constant - np.abs(linear) * reach[j]
        span = FACTORS[robot.kinds[j]].largest(reach[j])
        moves = np.abs(table[:, 1:]) @ span[1:] > NEARLY * sizes.sum(axis=1)
        for i in np.flatnonzero(moves & (lowest < NEARLY * sizes.sum(axis=1))):
            yield int(i), j, table[i]


def _widest(
    likely: Iterator[tuple[int, int, Floats]], labels: Sequence[object], kinds: Sequence[str]
) -> list[tuple[int, int]]:
    """Return boundary and joint of the ranges that lie in no other range of their group."""
    kept, arcs = list[tuple[int, int]](), list[tuple[object, float, float]]()
    rows = []
    for i, j, (c, a, b) in likely:
        if kinds[j] == "revolute":
            arc = circle_arc(-a, -b, c)  # where a cos q + b sin q + c <= 0
            rows.append((i, j, float(arc.centre), float(arc.half_width)))
        else:
            rows.append((i, j, np.nan, np.nan))  # slides are few, so all are kept
    for i, j, centre, half in sorted(rows, key=lambda row: (row[1], -row[3])):
        label = (labels[i], j)
        within = any(
            label == other and abs(np.angle(np.exp(1j * (centre - c)))) + half <= h
            for other, c, h in arcs
        )
        if not within:
            kept.append((i, j))
            arcs.append((label, centre, half))
    return kept


# --- in balls: what is ----------------------------------------------------------------------------


def _range(robot: Robot, j: int, boundary: Boundary) -> BlockedRange | None:
    """Return the range of a joint that a boundary of an exact robot blocks."""
    with precision(BITS):
        form = clearance(robot, boundary)
        alone, rest = _split(form, j, robot)
        c, one, two = alone[0] + ball(rest), alone[1], alone[2]
        solve = _arc if robot.joints[j].turns else _span
        ends = solve(c, one, two, _farthest(robot.joints[j]))
    if ends is None or not ends[0] < ends[1]:
        return None
    return BlockedRange(j, *ends, boundary.name)


def _split(form: HarmonicForm, j: int, robot: Robot) -> tuple[Alone, float]:
    """Return the part that depends only on joint j, and a bound of the rest."""
    n = len(form.kinds)
    left = form.coefficients.copy()
    places = [(*(0,) * j, k, *(0,) * (n - 1 - j)) for k in range(3)]
    c, one, two = (ball(left[place]) for place in places)
    for place in places:
        left[place] = type(left[place])(0)
    reach = [1.0 if joint.turns else _farthest(joint) for joint in robot.joints]
    return (c, one, two), float(magnitude(HarmonicForm(left, form.kinds), reach))


def _farthest(joint: Any) -> float:
    return max(above(abs(ball(end))) for end in joint.limits or (0,))


def _arc(c: arb, a: arb, b: arb, _: float) -> tuple[float, float] | None:
    """Return where ``a cos q + b sin q + c < 0`` on a circle: Theorem 2 in balls."""
    roots = line_roots("revolute", (c, a, b))
    return (above(roots[1]), below(roots[0] + turns(1))) if roots else None


def _span(c: arb, a: arb, b: arb, farthest: float) -> tuple[float, float] | None:
    """Return where ``b q² + a q + c < 0`` on a line: a slide of a pair, or of a half-space."""
    if not b > 0:
        c = c + abs(b) * ball(farthest) ** 2
        if a > 0:
            return -np.inf, below(-c / a)
        return (above(-c / a), np.inf) if a < 0 else None
    roots = line_roots("prismatic", (c, a, b))
    return (above(roots[0]), below(roots[1])) if roots else None
