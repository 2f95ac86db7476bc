"""A region of two joints, proved: no piece of its boundary is missing, and its area is a ball.

The float engine proposes loops of arcs, which are not trusted. A loop is cut into runs, each the
graph of one joint over the other along one form (Theorem 2). For each run four facts are proved:
the radicand of the graph stays positive; all other forms are positive at one point of the run; no
proved crossing lies inside the run; the region is on its left. There is no other boundary. Every
piece of boundary holds a crossing or a fold, or goes round a joint and so meets a line of one joint
value. All such points are listed, the lists are proved complete, and every point lies on a run.

The area of a loop is the integral of q1 dq2 along its runs, by Arb's rigorous integration.

Bodies have too many curves for this method. For a region with bodies, `components` proves the
components and the number of loops of each; vertices and areas are not proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from cspace.arrays import Floats
from cspace.forms.factors import whole_turns
from cspace.proofs import Unproved, Verdict
from cspace.proofs.exact.components import dense, prove_structure
from cspace.proofs.exact.crossings import (
    Balls,
    Crossing,
    Crossings,
    Side,
    classify,
    crossings,
    folds,
    placed_at,
    side_roots,
    sides,
)
from cspace.proofs.exact.numbers import arb, ball, precision, turns
from cspace.proofs.exact.problem import ExactProblem
from cspace.proofs.exact.runs import (
    Curve,
    Run,
    area_under,
    lies_on,
    on_the_left,
    root_near,
    sign_along,
)
from cspace.region import Component, Region
from cspace.region.arcs import Arc
from qbound.circle import TURN
from qbound.forms import HarmonicForm

Anchor = tuple[int | None, Balls]

BITS = 128
"""Precision of the area: 38 digits, of which more than 30 are left."""

NEAR = 1e-6
"""Distance (rad or length) within which a proposed vertex is looked for among the proved ones."""

LONGEST = 2.5
"""Reach of a run, rad, on a joint that turns round: a point lies on it on one turn alone."""

LINE = 0.14159
"""Value of a joint that turns round, at which what goes round it is looked for: any would do."""


@dataclass(frozen=True, eq=False)
class ProvedComponent:
    """A component whose boundary is proved.

    Attributes
    ----------
    area : arb or None
        None if the component is a band round both joints, or if there are bodies.
    vertices : tuple of Crossing
        In the order of the loops; none where there are bodies.
    contains_home : bool
        As proposed.
    loops : tuple of tuple of Run
        The boundary, the component on its left; none where there are bodies.
    """

    area: arb | None
    vertices: tuple[Crossing, ...]
    contains_home: bool
    loops: tuple[tuple[Run, ...], ...]


@dataclass(frozen=True, eq=False)
class ProvedRegion:
    """All components of a region, in the order in which they were proposed; not in the paper.

    Attributes
    ----------
    components : tuple of ProvedComponent
    crossings : Crossings
        All crossings in the closed region; none where there are bodies.
    folds : Crossings
        All places in the closed region where a curve turns back in the first joint; also none if
        there are bodies.
    """

    components: tuple[ProvedComponent, ...]
    crossings: Crossings
    folds: Crossings

    @property
    def area(self) -> arb:
        """Area of the whole region.

        Raises
        ------
        ValueError
            If a component is a band that goes round both joints together, or there are bodies.
        """
        areas = [c.area for c in self.components if c.area is not None]
        if len(areas) < len(self.components):
            raise ValueError(
                "a component is a band round both joints, or there are bodies:"
                " its area is not proved"
            )
        with precision(BITS):
            total: arb = sum(areas, start=ball(0))
        return total


def prove_region(problem: ExactProblem, region: Region) -> ProvedRegion:
    """Prove the boundary of a region that the float engine proposes, and enclose its area.

    With bodies, prove only that the region has exactly the proposed components, each with the same
    number of loops and round the same joints (`prove_structure`); areas are None.

    Parameters
    ----------
    problem : ExactProblem
        Of two joints.
    region : Region
        The result of `solve` for the same problem in floats.

    Raises
    ------
    Unproved
        The message names the first thing that is not proved: curves that touch or coincide, a wrong
        vertex, a piece of boundary that was not proposed. The region may still be right. Also if
        the region is unresolved, because then nothing is proposed.
    """
    if region.unresolved:
        raise Unproved(f"it is unresolved: {region.unresolved[0]}")
    if problem.bodies:
        prove_structure(problem, region)
        found = [ProvedComponent(None, (), c.contains_home, ()) for c in region.components]
        return ProvedRegion(tuple(found), Crossings((), ()), Crossings((), ()))
    prover = _Prover(problem)
    with precision(BITS):
        found = [prover.component(component) for component in region.components]
        prover.complete(len(found))
    return ProvedRegion(tuple(found), prover.points, prover.folds)


class _Prover:
    """Proves the loops of one problem, and keeps what the proof of completeness needs."""

    def __init__(self, problem: ExactProblem) -> None:
        self.problem = problem
        self.floats = HarmonicForm(problem.forms.coefficients.astype(float), problem.kinds)
        self.points = crossings(problem, within=True)
        self.folds = folds(problem, within=True)
        self.sides = sides(problem)
        self.runs: list[Run] = []
        self.used: list[int] = []
        for ends, kind in zip(problem.ranges, problem.kinds, strict=True):
            if ends is not None and kind == "revolute" and not ends[1] - ends[0] < turns(1):
                raise Unproved("limits as wide as a turn: a place has two names")

    # --- one component --------------------------------------------------------------------------

    def component(self, component: Component) -> ProvedComponent:
        """Prove the loops of a component."""
        loops = [list(self._loop(loop)) for loop in component.loops]
        for run in (run for runs in loops for run in runs):
            self._prove(run)
            self.runs.append(run)
        corners = [run.ends[0] for runs in loops for run in runs if run.ends[0] is not None]
        self.used += corners
        area = self._area(loops, component.wraps)
        if area is not None and not area > 0:
            raise Unproved("the area of a component is not proved to be positive")
        vertices = tuple(self.points.crossings[k] for k in corners)
        boundary = tuple(map(tuple, loops))
        return ProvedComponent(area, vertices, component.contains_home, boundary)

    def _area(self, loops: Sequence[Sequence[Run]], wraps: tuple[bool, bool]) -> arb | None:
        """Return the area that loops enclose (Green).

        If a component goes round the first joint, the area is the integral of -q2 dq1, which
        differs by the change of q1 q2. If it goes round both, the area is the whole torus less the
        holes.
        """
        total = turns(1) ** 2 if all(wraps) else ball(0)
        for runs in loops:
            (p1, p2), (q1, q2) = runs[0].start, runs[-1].end
            closed = (q1 - p1).contains(0) and (q2 - p2).contains(0)
            if all(wraps) and not closed:
                return None
            total += sum((area_under(self.problem, run) for run in runs), start=ball(0))
            if wraps == (True, False):
                total -= q1 * q2 - p1 * p2
        return total

    def _loop(self, loop: Sequence[Arc]) -> Iterator[Run]:
        """Cut a proposed loop into runs that share their ends."""
        curves = self._curves(loop)
        if len(curves) == 1:
            curves = [(curves[0][0], self._begun_apart(*curves[0]))]
        corners = [
            self._corner(before, curve, points[0])
            for (before, _), (curve, points) in zip([curves[-1], *curves[:-1]], curves, strict=True)
        ]
        last = self._turned(corners[0], curves[-1][1][-1])
        for (curve, points), start, end in zip(curves, corners, [*corners[1:], last], strict=True):
            yield from self._cut(curve, points, start, end)

    def _curves(self, loop: Sequence[Arc]) -> list[tuple[int, Floats]]:
        """Merge neighbouring arcs of one curve, and undo shifts by full turns along the loop."""
        named = [(self._number(arc), arc.points) for arc in loop]
        first = next((i for i in range(len(named)) if named[i][0] != named[i - 1][0]), 0)
        unrolled: list[tuple[int, Floats]] = []
        for curve, points in named[first:] + named[:first]:
            shift = self._shift(unrolled[-1][1][-1] - points[0]) if unrolled else 0
            unrolled.append((curve, dense(points, 16) + TURN * shift))
        return [
            (curve, np.concatenate([points for _, points in group]))
            for curve, group in groupby(unrolled, key=lambda item: item[0])
        ]

    def _begun_apart(self, curve: int, points: Floats) -> Floats:
        """Let a loop without a vertex begin far from the places where it turns back in a joint."""
        if curve >= len(self.problem.names):
            return points
        g = np.abs(self.floats[curve].gradient(points)).min(axis=-1)
        k, shift = int(g.argmax()), points[-1] - points[0]
        return np.concatenate([points[k:], points[1 : k + 1] + shift])

    def _number(self, arc: Arc) -> int:
        """Return the number of an arc's curve: an end of a range, or a form."""
        for k, side in enumerate(self.sides, start=len(self.problem.names)):
            on = np.abs(arc.points[:, side.joint] - float(side.value)).max() < NEAR
            if side.name == arc.boundary and on:
                return k
        return self.problem.names.index(arc.boundary)

    def _shift(self, gap: Floats) -> Floats:
        """Return the number of full turns next to a gap, of joints that turn all the way round."""
        circles = np.array([r is None for r in self.problem.ranges])
        return np.where(circles, whole_turns(gap), 0.0)

    def _corner(self, before: int, after: int, place: Floats) -> Anchor:
        """Return the proved crossing at a proposed vertex, or any point of a loop without one."""
        if before == after:
            q = self._point(after, self._flat(after, place), None, place)
            return None, q
        for k, crossing in enumerate(self.points.crossings):
            if set(crossing.curves) == {before, after}:
                index, q = self._turned((k, crossing.q), place)
                if max(abs(float(x) - y) for x, y in zip(q, place, strict=True)) < NEAR:
                    return index, q
        names = " and ".join(self._name(curve) for curve in (before, after))
        raise Unproved(f"no crossing of {names} is proved near ({place[0]:.6g}, {place[1]:.6g})")

    def _turned(self, anchor: Anchor, place: Floats) -> Anchor:
        """Shift a point by full turns next to a place."""
        index, q = anchor
        one, other = map(int, self._shift(place - np.array(q).astype(float)))
        return index, (q[0] + turns(one), q[1] + turns(other))

    def _name(self, curve: int) -> str:
        m = len(self.problem.names)
        return self.problem.names[curve] if curve < m else self.sides[curve - m].name

    # --- runs -----------------------------------------------------------------------------------

    def _flat(self, curve: int, place: Floats) -> int:
        """Return the joint over which a curve is the flatter graph at a place."""
        if curve >= len(self.problem.names):
            return 1 - self.sides[curve - len(self.problem.names)].joint
        g = np.abs(self.floats[curve].gradient(place))
        return 0 if g[1] >= g[0] else 1

    def _cut(self, curve: int, points: Floats, start: Anchor, end: Anchor) -> Iterator[Run]:
        """Cut a curve where it has to become a graph over the other joint."""
        joint, first = self._flat(curve, points[0]), 0
        for k in range(1, len(points) - 1):
            steep = self._steep(curve, joint, points[k])
            far = abs(points[k, joint] - points[first, joint]) > LONGEST
            if steep or (far and self.problem.ranges[joint] is None):
                q = self._point(curve, joint, start[1], points[k])
                yield self._run(curve, joint, start, (None, q), points[first:k])
                joint, start, first = 1 - joint if steep else joint, (None, q), k
        yield self._run(curve, joint, start, end, points[first:])

    def _steep(self, curve: int, joint: int, place: Floats) -> bool:
        """Tell whether a curve is clearly steeper than a diagonal over a joint."""
        if curve >= len(self.problem.names):
            return False
        g = np.abs(self.floats[curve].gradient(place))
        return bool(g[1 - joint] < 0.6 * g[joint])

    def _point(self, curve: int, joint: int, start: Balls | None, place: Floats) -> Balls:
        """Return the point of a curve at a place's value of one joint, on the root of `start`."""
        sign = 0
        if curve < len(self.problem.names):
            near = start or (ball(place[0]), ball(place[1]))
            sign = sign_along(self.problem, curve, 1 - joint, near)
        q = root_near(self.problem, curve, joint, sign, place.tolist())
        if q is None:
            raise Unproved(f"no point of {self._name(curve)} near ({place[0]:.6g}, {place[1]:.6g})")
        return q

    def _run(self, curve: int, joint: int, start: Anchor, end: Anchor, points: Floats) -> Run:
        ends, sign = (start[1], end[1]), 0
        if curve < len(self.problem.names):
            one, other = (sign_along(self.problem, curve, 1 - joint, q) for q in ends)
            sign = one if one == other else 0
            if not sign:
                raise Unproved(f"{self._name(curve)}: the two ends of a run are on no one graph")
        t = sum(float(q[joint]) for q in ends) / 2
        middle = points[np.abs(points[:, joint] - t).argmin()].copy()
        middle[joint] = t
        point = self._point(curve, joint, start[1], middle)
        run = Run(curve, joint, *ends, (start[0], end[0]), sign, point)
        a, b, c = (q[joint] for q in (ends[0], point, ends[1]))
        if not (a < b < c or a > b > c):
            raise Unproved(f"{self._name(curve)}: a run is too short to tell its direction")
        return run

    def _prove(self, run: Run) -> None:
        """Prove that a run is boundary from end to end, the region on its left."""
        name, problem = self._name(run.curve), self.problem
        if run.sign and not Curve(problem, run).is_graph():
            raise Unproved(f"{name}: a run is not proved to be a graph")
        if classify(problem, run.middle, (name, name), (run.curve,)).others is not Verdict.PROVED:
            raise Unproved(f"{name}: a run is not proved to be feasible")
        if not on_the_left(problem, run):
            raise Unproved(f"{name}: the region is not on the left of a run")
        for k, crossing in enumerate(self.points.crossings):
            apart = k in run.ends or run.curve not in crossing.curves
            if not apart and lies_on(problem, run, crossing.q) is not False:
                raise Unproved(f"{' and '.join(crossing.names)} may cross inside a run")

    # --- nothing else -----------------------------------------------------------------------------

    def complete(self, count: int) -> None:
        """Prove that every piece of boundary lies on the runs.

        If there is no boundary at all, one point decides for the whole plane.
        """
        if not self.runs:
            middle = [sum(ends, start=ball(0)) / 2 + ball(LINE) for ends in self.problem.ends]
            word = classify(self.problem, (middle[0], middle[1]), ("", ""), ()).others
            if word is not (Verdict.PROVED if count else Verdict.REFUTED):
                raise Unproved(f"{count} components without a boundary are proposed")
        for points in (self.points, self.folds):
            hidden = [
                " and ".join(c.names) for c in points.crossings if c.others is Verdict.UNDECIDED
            ]
            if points.undecided or hidden:
                raise Unproved(f"not proved complete: {', '.join([*points.undecided, *hidden])}")
        feasible = [k for k, c in enumerate(self.points.crossings) if c.others is Verdict.PROVED]
        if sorted(self.used) != feasible:
            raise Unproved(f"{len(self.used)} vertices are proposed, {len(feasible)} are proved")
        for fold in self.folds.feasible:
            self._known(fold.curves[0], fold.q)
        for joint, ends in enumerate(self.problem.ranges):
            if ends is None:
                self._line(Side(joint, ball(LINE), f"q{joint + 1} = {LINE}"))

    def _line(self, side: Side) -> None:
        """Prove that every feasible zero on a line of one joint value lies on a run."""
        m = len(self.problem.names)
        for i, name in enumerate(self.problem.names):
            roots = side_roots(self.problem, i, side)
            if roots is None:
                raise Unproved(f"{name}: its zeros on the line {side.name} are not proved simple")
            for q in roots:
                self._known_if_feasible(i, q)
        for k, other in enumerate(self.sides, start=m):
            if other.joint != side.joint:
                self._known_if_feasible(k, placed_at(side.joint, side.value, other.value))

    def _known_if_feasible(self, curve: int, q: Balls) -> None:
        word = classify(self.problem, q, ("", ""), (curve,)).others
        if word is Verdict.UNDECIDED:
            raise Unproved(f"{self._name(curve)}: a point on a line is on two boundaries")
        if word is Verdict.PROVED:
            self._known(curve, q)

    def _known(self, curve: int, q: Balls) -> None:
        """Prove that a point of the boundary lies on a run."""
        if not any(r.curve == curve and lies_on(self.problem, r, q) for r in self.runs):
            place = ", ".join(f"{float(x):.6g}" for x in q)
            raise Unproved(f"{self._name(curve)}: a piece of boundary at ({place}) is not proposed")
