"""Runs: pieces of curves of two joints that are graphs of one joint over the other, in balls.

With joint j held at t a form is c0 + c1 cos v + c2 sin v (or c0 + c1 v + c2 v²) in the other
joint. Its derivative along v at a root is w = +- sqrt(P), with P = c1² + c2² - c0² (or c1² - 4
c0 c2), and (cos v, sin v), or v, follows from w without an inverse function. So the graph, its
slope and its integral are analytic as long as P is positive.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cspace.arrays import Array
from cspace.forms.factors import FACTORS, whole_turns
from cspace.forms.harmonic import over
from cspace.proofs.exact.crossings import Balls, line_roots, placed_at, sides
from cspace.proofs.exact.numbers import arb, ball, balls, turns
from cspace.proofs.exact.problem import ExactProblem

NARROWEST = 40
"""Halvings of a run after which it is not proved that its curve goes on."""


@dataclass(frozen=True, eq=False)
class Run:
    """A piece of boundary that is a graph over one joint; not in the paper.

    Attributes
    ----------
    curve : int
        Number of the form; forms first, then the ends of ranges.
    joint : int
        The joint over which the run is a graph.
    start, end : (arb, arb)
        Ends of the run, unrolled.
    ends : tuple of (int or None)
        Index of the crossing at each end; None where the curve only changes its joint.
    sign : int
        Sign of the form's derivative along the other joint, which selects the root; 0 for an end of
        a range.
    middle : (arb, arb)
        A point between the ends.
    """

    curve: int
    joint: int
    start: Balls
    end: Balls
    ends: tuple[int | None, int | None]
    sign: int
    middle: Balls

    @property
    def forwards(self) -> bool:
        """Whether the joint grows along the run."""
        return bool(self.end[self.joint] > self.start[self.joint])

    @property
    def reach(self) -> tuple[arb, arb]:
        """Lower and upper value of the joint."""
        ends = self.start[self.joint], self.end[self.joint]
        return ends if self.forwards else ends[::-1]


class Curve:
    """The form of a run along its other joint, in plain lists for speed: integrals use it often."""

    def __init__(self, problem: ExactProblem, run: Run) -> None:
        table = problem.forms.coefficients[run.curve]
        self.table = balls(table if run.joint == 0 else table.T).tolist()
        self.base, self.lift = (FACTORS[problem.kinds[j]] for j in (run.joint, 1 - run.joint))
        self.slides = problem.kinds[1 - run.joint] == "prismatic"
        self.run = run
        low, high = run.reach
        c1 = self.along((low + high) / 2)[1]
        # The stable one of two formulas for a root: the one in which c1 and w do not cancel.
        self.adds_up = self.slides and c1.mid() * run.sign > 0

    def along(self, t: Any) -> list[Any]:
        """Return (c0, c1, c2) along the other joint at t, a real or a complex ball."""
        one, two = self.base.functions(t)
        return [a + b * one + c * two for a, b, c in zip(*self.table, strict=True)]

    def slopes(self, t: Any) -> list[Any]:
        """Return the derivatives of (c0, c1, c2) by t."""
        functions = (1, *self.base.functions(t))
        _, one, two = (
            sum(int(s) * f for s, f in zip(row, functions, strict=True) if s)
            for row in self.base.slope
        )
        return [b * one + c * two for _, b, c in zip(*self.table, strict=True)]

    def is_graph(self) -> bool:
        """Prove that P is positive all along the run, by halving it."""
        pieces = [(*self.run.reach, 0)]
        while pieces:
            low, high, depth = pieces.pop()
            if not self.lift.discriminant(self.along(low.union(high))) > 0:
                if depth == NARROWEST:
                    return False
                middle = ball(((low + high) / 2).mid())
                pieces += [(low, middle, depth + 1), (middle, high, depth + 1)]
        return True

    def factors(self, c: Sequence[Any], w: Any) -> list[Any]:
        """Return (1, cos v, sin v), or (1, v, v²), of the root whose derivative is w."""
        c0, c1, c2 = c
        if self.slides:
            v = -2 * c0 / (c1 + w) if self.adds_up else (w - c1) / (2 * c2)
            return [1, v, v * v]
        d2 = c1 * c1 + c2 * c2
        return [1, (w * c2 - c0 * c1) / d2, -(c0 * c2 + w * c1) / d2]

    def lifted(self, t: Any, analytic: bool) -> tuple[Any, list[Any]]:
        """Return slope and factors of the graph at a complex ball; not finite if not analytic."""
        c = self.along(t)
        w = self.run.sign * self.lift.discriminant(c).sqrt(analytic=analytic)
        factors = self.factors(c, w)
        pairs = zip(self.slopes(t), factors, strict=True)
        return -sum(x * y for x, y in pairs) / w, factors


def area_under(problem: ExactProblem, run: Run, weight: Sequence[Any] | Array = (1, 0, 0)) -> arb:
    """Return the integral of q1 D(q2) dq2 along a run (Green), as a ball.

    Parameters
    ----------
    weight : sequence of three
        Coefficients of D along the second joint; (1, 0, 0) gives areas.
    """
    from flint import acb

    antiderivative = FACTORS[problem.kinds[1]].antiderivative
    p, q = (q1 * antiderivative(weight, q2) for q1, q2 in (run.start, run.end))
    if run.curve >= len(problem.names):  # an end of a range: one joint stands still
        return q - p if run.joint == 1 else ball(0)
    curve = Curve(problem, run)

    def over_first(t: Any, analytic: bool) -> Any:
        lifted = curve.lifted(t, analytic)
        density = sum(w * f for w, f in zip(weight, lifted[1], strict=True))
        return t * density * lifted[0]

    def over_second(t: Any, analytic: bool) -> Any:
        return antiderivative(weight, t) * curve.lifted(t, analytic)[0]

    integrand = over_first if run.joint == 0 else over_second
    total: arb = acb.integral(integrand, run.start[run.joint], run.end[run.joint]).real
    return total if run.joint == 0 else q - p - total


def on_the_left(problem: ExactProblem, run: Run) -> bool:
    """Tell whether the form is positive, or the range's inside lies, on the left of the run."""
    sign = run.sign if run.curve < len(problem.names) else _inward(problem, run)
    return (sign > 0) == (run.forwards == (run.joint == 0))


def _inward(problem: ExactProblem, run: Run) -> int:
    """Return +1 at the lower end of a range, -1 at the upper."""
    side = sides(problem)[run.curve - len(problem.names)]
    ends = problem.ranges[side.joint]
    return 1 if ends is not None and side.value is ends[0] else -1


def root_near(
    problem: ExactProblem, curve: int, joint: int, sign: int, place: Sequence[float]
) -> Balls | None:
    """Return the point of a curve with the place's value of one joint, on the root of that sign."""
    t, other = ball(place[joint]), 1 - joint
    if curve >= len(problem.names):
        v: arb | None = sides(problem)[curve - len(problem.names)].value
    else:
        c = balls(np.stack(problem.forms[curve].along(other, np.array([t, t]))))
        roots = line_roots(problem.kinds[other], c) or []
        points = (placed_at(joint, t, root) for root in roots)
        right = (q[other] for q in points if sign_along(problem, curve, other, q) == sign)
        v = next(right, None)
        if v is not None and problem.kinds[other] == "revolute":
            v = v + turns(int(whole_turns(place[other] - float(v))))
    return None if v is None else placed_at(joint, t, v)


def sign_along(problem: ExactProblem, curve: int, joint: int, q: Balls) -> int:
    """Return the sign of a form's derivative along a joint; 0 if it is not proved."""
    slope = ball(over(problem.forms[curve].derivative(joint), q))
    return int(slope > 0) - int(slope < 0)


def lies_on(problem: ExactProblem, run: Run, q: Balls) -> bool | None:
    """Tell whether a zero of the run's form lies strictly within the run; None if undecided.

    Parameters
    ----------
    q : (arb, arb)
        A point at which the form vanishes, on any turn of the joints that turn all the way round.
    """
    low, high = run.reach
    other = 1 - run.joint
    found: bool | None = False
    for k in _turns_to(problem, run, q):
        t = q[run.joint] + turns(k)
        if t < low or t > high:
            continue
        if run.curve >= len(problem.names):
            sign = 1
        else:
            sign = run.sign * sign_along(problem, run.curve, other, q)
        if sign > 0 and t > low and t < high:
            return True
        if sign >= 0:
            found = None
    return found


def _turns_to(problem: ExactProblem, run: Run, q: Balls) -> range:
    """Return all counts of full turns that may bring a point into the reach of a run."""
    if problem.ranges[run.joint] is not None:
        return range(1)
    low, high = (float((end - q[run.joint]) / turns(1)) for end in run.reach)
    return range(int(np.floor(low)), int(np.ceil(high)) + 1)
