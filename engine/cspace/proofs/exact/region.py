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

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from cspace.arrays import Array, Floats
from cspace.forms.factors import FACTORS, whole_turns
from cspace.proofs import Unproved
from cspace.proofs.exact.numbers import arb, ball, balls, line_roots, precision, turns
from cspace.proofs.exact.problem import ExactProblem
from cspace.region import Component, Problem, Region, Vertex
from cspace.region.algebra import HIGH, fold
from cspace.region.cells import Cells, find_cells
from cspace.region.components import find_joins, find_parts
from cspace.region.exact import Exact, Root, TiltedError, UndecidedError
from cspace.region.kinds import FOLD
from cspace.region.outline import outlined
from cspace.region.places import CellMap
from cspace.region.rows import ExactRows
from cspace.region.scene import scene_of
from qbound.forms import Kind

Balls = tuple[arb, arb]

BITS = 128
"""Precision of an area: 38 digits, of which more than 30 are left."""

END_BITS = 512
"""Precision of the lines at which cells begin and end, and of vertices."""

CAUTION = 2.0**20
"""By how much errors of doubles are enlarged, so that they decide next to nothing."""

NEAR = 1e-6
"""Distance (rad or length) of a vertex in doubles from the numbers that are proved for it."""

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

    @property
    def vertices(self) -> tuple[Balls, ...]:
        """Vertices, rad or length, on the turns of `cells.outlines`, and in their order."""
        return tuple(map(self.cells.vertex, self.cells.outlines[self.number].vertices))


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
    problem : ExactProblem
    cells : Cells
    outlines : tuple of Component
        The components in doubles, in an order of their own.
    map : CellMap
        Says which cell belongs to which of `outlines`.
    """

    problem: ExactProblem
    cells: Cells
    outlines: tuple[Component, ...]
    map: CellMap

    def part_of(self, place: Floats) -> int:
        """Return the number of the component that holds a place; -1 if there is none."""
        return next((int(self.map.owner[one.cell]) for one in self.map.placed(place)), -1)

    @cached_property
    def lines(self) -> list[arb]:
        """The first joint's values at which cells begin and end."""
        exact = self.cells.exact
        with precision(END_BITS):
            unit = ball(self.cells.scene.scale[0])
            return [exact.line(k, END_BITS) * unit for k in range(len(exact.best))]

    def vertex(self, vertex: Vertex) -> Balls:
        """Return a vertex of an outline as balls: the line that it is on, and a root over that."""
        problem = self.problem
        circles, names = [kind == "revolute" for kind in problem.kinds], vertex.boundaries
        with precision(END_BITS):
            t = _nearest(self.lines, vertex.q[0], circles[0])
            sides = zip(problem.limits[1], problem.ranges[1] or (), strict=False)
            values = [end for name, end in sides if name in names]
            for k in (k for k, name in enumerate(problem.names) if name in names):
                along = balls(np.stack(problem.forms[k].along(1, np.array([t, t]))))
                values += line_roots(problem.kinds[1], along) or []
            return t, _nearest(values, vertex.q[1], circles[1])

    def integral(self, number: int, weight: Sequence[Any] | Array = (1, 0, 0)) -> arb:
        """Return the integral over a component of a function of the second joint; or its area."""
        total = ball(0)
        with precision(BITS):
            for cell in np.flatnonzero(self.map.owner == number).tolist():
                total += _integral(self.cells, cell, balls(weight))
        return total


def _nearest(values: Sequence[arb], near: float, circle: bool) -> arb:
    """Return the one of some numbers that is near to a double, shifted by full turns to it."""
    if circle:
        values = [x + turns(int(whole_turns(near - float(x)))) for x in values]
    found = min(values, key=lambda x: abs(float(x) - near), default=None)
    if found is None or not abs(float(found) - near) < NEAR:
        raise Unproved(f"nothing that is proved is near {near:.6g}")
    return found


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
                return ExactCells(exact, cells, outlines, own)
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
