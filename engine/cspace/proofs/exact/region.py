"""Areas and vertices of a region of two joints as balls, and its structure asked of exact numbers.

The region engine decides with doubles what doubles can tell, and asks exact numbers for the rest.
Here the same cells are found with all errors enlarged a million times, so that nearly everything is
asked of exact numbers (`cspace.region.exact`): which zeros of which factor of which polynomial. The
code is the engine's; only its numbers are others. A region that was found by doubles has to agree.

A cell lies between two roots over an interval of the first joint, both ends of which are zeros of
polynomials, known to any number of digits. So its area is the integral of the difference of two
roots (Theorem 2), by Arb's rigorous integration. This is done for points and bodies alike.

A coefficient that is irrational, such as the length of an edge, is a rational one beside it, of 640
bits.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations, pairwise, product
from typing import Any

import numpy as np

from cspace.arrays import Array, Floats
from cspace.forms.factors import FACTORS, whole_turns
from cspace.forms.harmonic import over
from cspace.proofs import Unproved, Verdict
from cspace.proofs.exact.numbers import arb, ball, balls, line_roots, precision, turns
from cspace.proofs.exact.problem import ExactProblem
from cspace.region import Component, Problem, Region
from cspace.region.algebra import HIGH, crossed, fold
from cspace.region.cells import Cells, find_cells
from cspace.region.components import find_joins, find_parts
from cspace.region.exact import INFINITE, Exact, Number, Root, TiltedError, UndecidedError
from cspace.region.kinds import CROSS, FOLD, WALL
from cspace.region.outline import outlined
from cspace.region.places import CellMap
from cspace.region.rows import ExactRows
from cspace.region.scene import scene_of
from qbound.forms import HarmonicForm, Kind

Balls = tuple[arb, arb]

BITS = 128
"""Precision of an area: 38 digits, of which more than 30 are left."""

POINT_BITS = 256
"""Precision of a crossing: 77 digits, of which more than 60 are left."""

END_BITS = 512
"""Precision of the lines at which cells begin and end."""

CAUTION = 2.0**20
"""By how much errors of doubles are enlarged, so that they decide next to nothing."""

NEAR = 1e-6
"""Distance (rad or length) within which a vertex in doubles is looked for among the crossings."""

SAME_AREA = 1e-9
"""Part of the whole area by which an area in doubles may differ; or 1e-5 of the area itself."""


@dataclass(frozen=True, eq=False)
class ProvedComponent:
    """A component of the region, its area a ball.

    Attributes
    ----------
    area : arb
    loops : int
    wraps : tuple of two bool
    contains_home : bool
        As proposed.
    cells : ExactCells
        Of the whole region.
    number : int
        The component's number among them.
    """

    area: arb
    loops: int
    wraps: tuple[bool, bool]
    contains_home: bool
    cells: ExactCells
    number: int

    def integral(self, weight: Sequence[Any] | Array) -> arb:
        """Return the integral of a function of the second joint over the component.

        Parameters
        ----------
        weight : sequence of three
            Coefficients of 1, cos and sin, or of 1, q and q².
        """
        return self.cells.integral(self.number, weight)


@dataclass(frozen=True, eq=False)
class ProvedRegion:
    """All components of a region, in the order in which they were proposed; not in the paper."""

    components: tuple[ProvedComponent, ...]

    @property
    def area(self) -> arb:
        """Area of the whole region."""
        with precision(BITS):
            total: arb = sum((c.area for c in self.components), start=ball(0))
        return total


def prove_region(problem: ExactProblem, region: Region) -> ProvedRegion:
    """Find the cells of a region by exact numbers, compare, and enclose the areas.

    Parameters
    ----------
    problem : ExactProblem
        Of two joints: the forms and ranges of the region's problem in exact numbers. What is about
        bodies comes from the region's robot.
    region : Region
        The result of `solve` for the same problem in floats.

    Raises
    ------
    Unproved
        If the region is unresolved or differs: in the number of components, or for one of them in
        its area, its loops, the joints that it goes round, its vertices.

    Examples
    --------
    >>> from cspace import find_region, load_robot
    >>> from cspace.proofs.exact.problem import exact_problem, exact_robot
    >>> region = find_region(load_robot("minervabot-v2"))
    >>> proved = prove_region(exact_problem(exact_robot("minervabot-v2")), region)
    >>> proved.components[0].area.str(30, radius=False)
    '11.7799583271678516363637052138'
    """
    if region.unresolved:
        raise Unproved(f"it is unresolved: {region.unresolved[0]}")
    if region.problem.blocked and not region.components:
        return ProvedRegion(())
    found = exact_cells(region.inner, problem)
    proposed, areas = region.components, [found.integral(k) for k in range(len(found.outlines))]
    if len(proposed) != len(found.outlines):
        raise Unproved(
            f"{len(proposed)} components are proposed, and there are {len(found.outlines)}"
        )
    numbers = [found.part_of(place) for place in _inside(region)]
    if sorted(numbers) != list(range(len(areas))):
        raise Unproved("two proposed components are one")
    components = []
    for k, component in zip(numbers, proposed, strict=True):
        own = found.outlines[k]
        for what in ("loops", "vertices"):
            one, other = len(getattr(component, what)), len(getattr(own, what))
            if one != other:
                raise Unproved(f"{one} {what} are proposed, and there are {other}")
        if component.wraps != own.wraps:
            raise Unproved("a component does not go round the joints that are proposed")
        if abs(component.area - areas[k]) > SAME_AREA * sum(areas) + 1e-5 * areas[k]:
            raise Unproved(
                f"an area of {component.area:.9g} is proposed, it is {float(areas[k]):.9g}"
            )
        components.append(
            ProvedComponent(areas[k], len(own.loops), own.wraps, component.contains_home, found, k)
        )
    return ProvedRegion(tuple(components))


def _inside(region: Region) -> list[Floats]:
    """Return a place of each component, as base and lift values: in the middle of a wide cell."""
    cells, found = region.cells, []
    areas = cells.moments()[:, 0]
    for k in range(len(region.components)):
        own = np.flatnonzero(cells.owner == k)
        if not len(own):
            raise Unproved("a proposed component has no cells")
        cell = own[[areas[own].argmax()]]
        t = cells.spans(cell).mean(axis=1)
        place = np.array([t[0], cells.interval(cell, t[:, None]).mean()])
        found.append(place if region.base == 0 else place[::-1])
    return found


def proved_vertices(problem: ExactProblem, component: Component) -> tuple[Crossing, ...]:
    """Return the crossings at the vertices of a component, on the same turns.

    Raises
    ------
    Unproved
        If no crossing of the two boundaries is near a vertex.
    """
    points = crossings(problem).crossings
    circles, found = [r is None for r in problem.ranges], []
    for vertex in component.vertices:
        for point in points:
            if set(point.names) == set(vertex.boundaries):
                gap = vertex.q - np.array(point.q).astype(float)
                count = np.where(circles, whole_turns(gap), 0.0)
                if np.abs(gap - 2 * np.pi * count).max() < NEAR:
                    with precision(POINT_BITS):
                        one, other = (
                            x + turns(int(k)) for x, k in zip(point.q, count, strict=True)
                        )
                    found.append(replace(point, q=(one, other)))
                    break
        else:
            names = " and ".join(vertex.boundaries)
            raise Unproved(f"no crossing of {names} near ({vertex.q[0]:.6g}, {vertex.q[1]:.6g})")
    return tuple(found)


# --- cells ----------------------------------------------------------------------------------------


class _Rows(ExactRows):
    """The rows of a problem, those of forms and ranges as an exact problem has them."""

    def __init__(self, problem: Problem, exact: ExactProblem) -> None:
        super().__init__(problem)
        self._names, self._exact = problem.names, exact

    def _form(self, row: int) -> Array:
        form: Array = self._exact.forms.coefficients[self._exact.names.index(self._names[row])]
        return form

    def _range(self, joint: int) -> tuple[Any, Any] | None:
        return self._exact.ranges[joint]


@dataclass(frozen=True, eq=False)
class ExactCells:
    """The cells of a region over the first joint, found by exact numbers.

    Attributes
    ----------
    cells : Cells
    outlines : tuple of Component
        The components in doubles, in an order of their own.
    map : CellMap
        Says which cell belongs to which of `outlines`.
    """

    cells: Cells
    outlines: tuple[Component, ...]
    map: CellMap

    def part_of(self, place: Floats) -> int:
        """Return the number of the component that holds a place; -1 if there is none."""
        return next((int(self.map.owner[one.cell]) for one in self.map.placed(place)), -1)

    def integral(self, number: int, weight: Sequence[Any] | Array = (1, 0, 0)) -> arb:
        """Return the integral over a component of a function of the second joint; or its area."""
        total = ball(0)
        with precision(BITS):
            for cell in np.flatnonzero(self.map.owner == number).tolist():
                total += _integral(self.cells, cell, balls(weight))
        return total


def exact_cells(problem: Problem, exact: ExactProblem) -> ExactCells:
    """Find the cells of a region over its first joint, asking exact numbers whatever can be asked.

    Raises
    ------
    Unproved
        If something is not decided.
    """
    scene = scene_of(problem, 0, CAUTION)
    scene.source.rows = _Rows(problem, exact)
    try:
        while True:
            try:
                cells = find_cells(scene)
                joins = find_joins(cells)
                parts = find_parts(cells, joins)
                outlines, own = outlined(cells, joins, parts, problem, problem, np.zeros(2))
            except TiltedError as error:
                scene = error.scene
            else:
                return ExactCells(cells, outlines, own)
    except UndecidedError as error:
        raise Unproved(f"{error} is not decided") from None


def _integral(cells: Cells, cell: int, weight: Array) -> arb:
    """Return the integral of a weight over a cell: of its antiderivative between two roots."""
    exact, scene = cells.exact, cells.scene
    lines = cells.span[cell].tolist()
    start, end = (exact.line(line, END_BITS) for line in lines)
    base_unit, unit = (ball(x) for x in scene.scale)
    kind: Kind = "revolute" if scene.turns[1] else "prismatic"
    total = ball(0)

    def antiderivative(v: Any) -> Any:
        return FACTORS[kind].antiderivative(weight, v * unit)

    for sign, segment in zip((-1, 1), cells.roots[cell].tolist(), strict=True):
        if segment < 0:
            total += sign * (end - start) * antiderivative(exact.lift_range()[segment == HIGH])
            continue
        curve = _Curve(exact, cells.segments.root(segment))
        middle = ball(((start + end) / 2).mid())
        for way, line, origin in ((1, lines[0], start), (-1, lines[1], end)):
            events = cells.lines.events[cells.lines.line == line]
            at_fold = bool(((events["kind"] == FOLD) & (events["i"] == curve.number)).any())
            root = curve.beside(origin, middle - origin, at_fold=at_fold)
            total += sign * way * root.integral(antiderivative)
    return total * base_unit


class _Curve:
    """A named root, between two lines and within one turn of the lift."""

    def __init__(self, exact: Exact, named: Root) -> None:
        self.number, self.slope, turn = named
        self.base_turns, self.turns = exact.turns
        self.table = [[ball(x) for x in row] for row in exact.table(self.number)]
        low, high = exact.lift_range()
        if self.turns:
            low, high = low + turns(turn), low + turns(turn + 1)
        self.range = low, high
        self.is_double = exact.is_double(self.number)
        self.is_straight = not exact.form(self.number)[2]

    def along(self, t: Any) -> list[Any]:
        """Return the coefficients along the lift at a base value."""
        one, other = (t.cos(), t.sin()) if self.base_turns else (t, t * t)
        return [a + b * one + c * other for a, b, c in zip(*self.table, strict=True)]

    def beside(self, origin: arb, length: arb, *, at_fold: bool) -> _Beside:
        """Return the root from a line on, over a length that may be negative."""
        return _Beside(self, origin, length, at_fold)


class _Beside:
    """A root beside a line, as an analytic function of a complex s: at t = origin + length s².

    The slope w of the form at the root is the square root of P = c1² + c2² - c0², or of c1² - 4
    c0 c2. At a fold P vanishes, and with t - origin is divided out: so w is s times a square root
    that is analytic there.

    Theorem 2 in complex numbers says exp(i v) = -(c0 + i w) / (c1 - i c2). The logarithm is taken
    about an angle that the root is proved to stay within half a turn of.
    """

    def __init__(self, curve: _Curve, origin: arb, length: arb, at_fold: bool) -> None:
        self.curve, self.origin, self.length, self.at_fold = curve, origin, length, at_fold
        self.there = curve.along(origin)

    def integral(self, antiderivative: Any) -> arb:
        """Return the integral of a function of the root, from the line on."""
        from flint import acb

        total = ball(0)
        for low, high, about in self.pieces():

            def density(s: Any, analytic: bool, about: arb = about) -> Any:
                return antiderivative(self.root(s, analytic, about)) * (2 * self.length * s)

            total += acb.integral(density, low, high).real
        return total

    def pieces(self) -> list[tuple[arb, arb, arb]]:
        """Return parts of 0 <= s <= 1, and an angle for each that the root stays near."""
        from flint import acb

        low, high = self.curve.range
        whole = [(ball(0), ball(1), (low + high) / 2)]
        for count in (1, 4, 16) if self.curve.turns else ():
            ends, found = [ball(k) / count for k in range(count + 1)], []
            for a, b in pairwise(ends):
                about = self.root(acb((a + b) / 2), False, whole[0][2]).real.mid()
                off = self.unit(acb(a.union(b)), False) * acb(0, -about).exp()
                if not (off.is_finite() and (off.real > -0.9 or off.imag > 0.1 or off.imag < -0.1)):
                    break
                found.append((a, b, ball(about)))
            else:
                return found
        return whole

    def w(self, s: Any, c: list[Any], analytic: bool) -> Any:
        """Return the slope of the form at the root."""
        curve = self.curve
        if curve.is_double:
            return 0
        if not self.at_fold:
            return curve.slope * fold(c, curve.turns).sqrt(analytic=analytic)
        # (f(t)^2 - f(origin)^2) / (t - origin) is the difference quotient of f times a sum.
        d = self.length * s * s
        one, other = ball(1), self.origin + self.origin + d
        if curve.base_turns:
            half, ratio = self.origin + d / 2, (d / 2).sinc()
            one, other = -half.sin() * ratio, half.cos() * ratio
        quotients = [b * one + c * other for _, b, c in zip(*curve.table, strict=True)]
        both = [x + y for x, y in zip(c, self.there, strict=True)]
        squares = [x * y for x, y in zip(quotients, both, strict=True)]
        if curve.turns:
            rest = squares[1] + squares[2] - squares[0]
        else:
            rest = squares[1] - 2 * (quotients[0] * both[2] + quotients[2] * both[0])
        return curve.slope * s * (self.length * rest).sqrt(analytic=analytic)

    def unit(self, s: Any, analytic: bool) -> Any:
        """Return exp(i v) of a root that is an angle."""
        from flint import acb

        c, i = self.curve.along(self.origin + self.length * s * s), acb(0, 1)
        return -(c[0] + i * self.w(s, c, analytic)) / (c[1] - i * c[2])

    def root(self, s: Any, analytic: bool, about: arb) -> Any:
        """Return the root; where it is not enclosed, its whole range."""
        from flint import acb

        if self.curve.turns:
            off = self.unit(s, analytic) * acb(0, -about).exp()
            v = about - acb(0, 1) * off.log(analytic=analytic)
        else:
            c0, c1, c2 = c = self.curve.along(self.origin + self.length * s * s)
            w = self.w(s, c, analytic)
            v = -2 * c0 / (c1 + w)
            if not (v.is_finite() or self.curve.is_straight):
                v = (w - c1) / (2 * c2)
        low, high = self.curve.range
        return v if v.is_finite() or analytic else acb(low.union(high))


# --- crossings ------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Crossing:
    """A point at which two boundaries vanish, or a fold of one.

    Attributes
    ----------
    q : (arb, arb)
        The point, rad or length, within the ranges.
    names : (str, str)
        The boundaries that vanish there.
    others : Verdict
        Whether all other forms are positive there; refuted if one is negative.
    """

    q: Balls
    names: tuple[str, str]
    others: Verdict


@dataclass(frozen=True, eq=False)
class Crossings:
    """All crossings of a list of curves.

    Attributes
    ----------
    crossings : tuple of Crossing
    undecided : tuple of str
        Pairs of names for which the list is not known to be complete, because they share a piece of
        curve or touch at a limit; empty if it is complete.
    """

    crossings: tuple[Crossing, ...]
    undecided: tuple[str, ...]

    @property
    def feasible(self) -> tuple[Crossing, ...]:
        """Crossings at which every other form is positive: the vertices of the region."""
        return tuple(c for c in self.crossings if c.others is Verdict.PROVED)


def crossings(problem: ExactProblem) -> Crossings:
    """Find all crossings of two forms, of a form and a limit, and of two limits.

    Two forms share a root over the zeros of their resultant, a polynomial: all of its zeros are
    known. Not in the paper, which reads its six points off a picture.

    Raises
    ------
    ValueError
        If the problem does not have two joints.
    """
    if len(problem.kinds) != 2:
        raise ValueError(f"crossings are points of two joints; here are {len(problem.kinds)}")
    with precision(POINT_BITS):
        return _gathered(problem, chain(_of_forms(problem), _at_limits(problem)))


def folds(problem: ExactProblem) -> Crossings:
    """Find all points where a curve turns back in the first joint: its two roots are one."""
    with precision(POINT_BITS):
        return _gathered(problem, _folds(problem))


Found = tuple[tuple[str, str], tuple[int, ...], list[Balls] | None]
"""Two names, the forms among them, and their points on some turn; None if they are not decided."""


def _gathered(problem: ExactProblem, candidates: Iterable[Found]) -> Crossings:
    """Keep the points within the ranges, on every turn, with the signs of all other forms."""
    points, undecided = [], []
    for names, curves, places in candidates:
        turned = [_within(problem, q) for q in places or ()]
        if places is None or None in turned:
            undecided.append(" and ".join(dict.fromkeys(names)))
        for q in chain.from_iterable(own or () for own in turned):
            others = np.delete(balls(over(problem.forms, q)), curves)
            word = Verdict.of(all(x > 0 for x in others), any(x < 0 for x in others))
            points.append(Crossing(q, names, word))
    return Crossings(tuple(points), tuple(undecided))


def _of_forms(problem: ExactProblem) -> Iterator[Found]:
    """Yield the points at which two forms vanish."""
    exact = _asked(problem)
    for i, j in combinations(range(len(problem.names)), 2):
        places: list[Balls] | None = []
        if not any(exact.form(i)[1:]) and not any(exact.form(j)[1:]):  # straight lines
            if {*exact.numbers(WALL, i, 0)} & {*exact.numbers(WALL, j, 0)}:
                places = None
        elif exact.share(i, j):
            places = None
        for number in exact.numbers(CROSS, i, j) if places is not None else ():
            t = _value(exact, number)
            roots = _shared_roots(exact, problem, (i, j), number, t)
            places = (
                None if roots is None or places is None else [*places, *((t, v) for v in roots)]
            )
        yield (problem.names[i], problem.names[j]), (i, j), places


def _shared_roots(
    exact: Exact, problem: ExactProblem, pair: tuple[int, int], number: Number, t: arb
) -> list[arb] | None:
    """Return the roots that two forms share over a zero of their resultant; None if undecided.

    Where the coefficients are not parallel, their cross product is (1, cos v, sin v), or (1, v,
    v²), times a number. Parallel ones share both roots, or one form vanishes along the line.
    """
    a, b = (exact.form(i) for i in pair)
    one, other = (_along(problem, i, t) for i in pair)
    if not _vanish(exact, number, crossed(a, b), 4):
        x, y, z = crossed(one, other)
        if exact.turns[1]:
            return [type(x).atan2(z / x, y / x)] if not x.contains(0) else None
        infinite = _vanish(exact, number, crossed(a, b)[:1], 4)
        return [] if infinite else [y / x] if not x.contains(0) else None
    both = [c for c, p in ((one, a), (other, b)) if not _vanish(exact, number, p, 2)]
    return line_roots(problem.kinds[1], both[0]) if both else None


def _vanish(exact: Exact, number: Number, polynomials: Iterable[Any], degree: int) -> bool:
    """Tell whether polynomials of at most some degree all vanish at a number of the base."""
    if number == INFINITE:
        return all(p.degree() < degree for p in polynomials)
    factor = exact.flint.fmpq_poly(exact.flint.fmpz_poly(list(number[0])))
    return all(not p % factor for p in polynomials)


def _folds(problem: ExactProblem) -> Iterator[Found]:
    """Yield the points at which both roots of a form are one."""
    exact = _asked(problem)
    for i, name in enumerate(problem.names):
        places: list[Balls] | None = None if exact.is_double(i) else []
        if not any(exact.form(i)[1:]):
            places = []  # straight lines
        for number in exact.numbers(FOLD, i, i) if places is not None else ():
            if not _vanish(exact, number, exact.form(i)[1:], 2):
                t = _value(exact, number)
                c0, c1, c2 = _along(problem, i, t)
                v = type(t).atan2(-c0 * c2, -c0 * c1) if exact.turns[1] else -c1 / (2 * c2)
                places = [*(places or ()), (t, v)]
        yield (name, name), (i,), places


def _at_limits(problem: ExactProblem) -> Iterator[Found]:
    """Yield the points at which forms vanish at a limit, and those at which two limits meet."""
    sides = [
        [(value, name) for value, name in zip(ends or (), names, strict=False)]
        for ends, names in zip(problem.ranges, problem.limits, strict=True)
    ]
    for joint, (i, name) in product((0, 1), enumerate(problem.names)):
        for value, side in sides[joint]:
            roots = line_roots(problem.kinds[1 - joint], _along(problem, i, value, 1 - joint))
            pairs = [(value, v) if joint == 0 else (v, value) for v in roots or ()]
            yield (name, side), (i,), None if roots is None else pairs
    for (one, name), (other, side) in product(*sides):
        yield (name, side), (), [(one, other)]


def _along(problem: ExactProblem, form: int, t: arb, joint: int = 1) -> Array:
    """Return the coefficients of a form along a joint, the other one at t."""
    return balls(np.stack(problem.forms[form].along(joint, np.array([t, t]))))


def _value(exact: Exact, number: Number) -> arb:
    """Return a number of the first joint as a ball, rad or length."""
    t: arb = exact.ball(number, 0, POINT_BITS) * ball(exact.scene.scale[0])
    return t


def _within(problem: ExactProblem, q: Balls) -> list[Balls] | None:
    """Return a point on every turn on which it is within the ranges; None if undecided.

    A value that is itself an end of its range is within.
    """
    found: list[list[arb]] = []
    for x, ends, kind in zip(q, problem.ranges, problem.kinds, strict=True):
        if ends is None or any(x is end for end in ends):
            found.append([x])
            continue
        low, high = (float((end - x) / turns(1)) for end in ends)
        tried = range(int(low) - 2, int(high) + 3) if kind == "revolute" else (0,)
        values = [x + turns(k) for k in tried]
        if not all(v < ends[0] or v > ends[1] or ends[0] < v < ends[1] for v in values):
            return None
        found.append([v for v in values if ends[0] < v < ends[1]])
    return [(x, y) for x in found[0] for y in found[1]]


def _asked(problem: ExactProblem) -> Exact:
    """Return exact answers about the forms of a problem over the first joint."""
    forms = HarmonicForm(balls(problem.forms.coefficients).astype(float), problem.kinds)
    ends = [None if r is None else (float(r[0]), float(r[1])) for r in problem.ranges]
    first, second = problem.limits
    floats = Problem(forms, problem.names, (ends[0], ends[1]), (first, second))
    scene = scene_of(floats, 0)
    scene.source.rows = _Rows(floats, problem)
    return Exact(scene)
