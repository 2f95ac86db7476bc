"""Exact answers, asked where doubles leave something open (sentence 4).

The questions are the zeros of an event, the order of events, of roots in a fibre, and of two ends
of cells, and signs at a place. The last three are asked of balls, with more and more bits.

The polynomial of an event has rational coefficients: in u = tan(t / 2), or in t itself for a slide.
FLINT splits it into irreducible factors, and a zero is named (factor, number of its real root). Two
zeros are equal exactly if their names are; different ones are told apart by more bits. So
tangencies (a factor squared), concurrent curves (one factor in several polynomials) and coinciding
curves (a polynomial that is zero) are not special cases.

An irrational coefficient, such as the length of an edge or a mount of 20 degrees, becomes a
rational one beside it, of `KEPT` bits. Then polynomials are not split, as rounding parts multiple
roots (`near_roots`), and events that agree to `SAME` bits count as equal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cache, cached_property, partial
from typing import Any, TypeVar

import numpy as np

from cspace.arrays import Array, Floats, Ints
from cspace.model.exact import half_tangent, on_circle, simplest_in
from cspace.region.algebra import HIGH, LOW, along_base, crossed, fold, resultant
from cspace.region.kinds import CROSS, END, FOLD, LIMIT, SHARE, VAGUE, WALL, made
from cspace.region.scene import CUT_OPEN, ONCE, Scene, is_varied
from cspace.tolerances import UNIT
from qbound.circle import TURN

BITS = 128, 512, 4096
"""Precisions that are tried in turn."""

KEPT, SAME = 640, 300
"""Bits of an irrational coefficient, and bits to which events with such coefficients agree."""

ZERO = 600
"""Coefficients of size 1 that are rounded are zero below this power of 1/2."""

NEARER = 30
"""Bits by which two ends are looked at nearer to a line, to see whether they meet there."""

FIBRE = 100
"""Bits below which forms of rounded coefficients vanish on a whole fibre at a rounded event."""

PRECISE, TOUCHES = 800, 500
"""Bits of a root of rounded coefficients, and bits to which a polynomial is zero where it turns."""

Answer = TypeVar("Answer")

Number = Any
"""An exact base value: (factor, number of its real root), or `INFINITE`."""

INFINITE: Number = ((), 0)
"""Half a turn, at which tan(t / 2) is infinite."""

Ball = Any
Root = tuple[int, int, int]
"""A named root: curve, slope and turn; `LOW` and `HIGH` as curves are the ends of the lift."""

Name = int | tuple[int, int | None]
"""A curve; or a feature and its side condition; or a curve and None: its slope along the base."""

Place = tuple[Any, int, int]
"""A root, a line, and the side of it (1 or -1) from which the root comes.

Or what vanishes on the line itself, its slope and the lift value, rounded; the line; and 0."""

Between = float | tuple[Place, Place]
"""A lift value on a line, or the middle between two places on it."""

Spot = tuple[float, float] | tuple[tuple[int, int], Root, Root] | tuple[int, int, Between]
"""A place: (t, v) in doubles; a slab, as two lines, and the roots that bound a gap; or a line, the
side of it on which the place is, and a lift value."""


class UndecidedError(ArithmeticError):
    """Error: exact numbers, or features, do not decide something; the message says what."""


class TiltedError(ArithmeticError):
    """Error: forms that vanish along a line, up to rounding, do not vanish there.

    Attributes
    ----------
    scene : Scene
        The scene in which each coefficient of these forms is rounded once.
    """

    def __init__(self, exact: Exact, curves: Iterable[int]) -> None:
        scene = exact.scene
        tables, eps = scene.table.copy(), scene.eps.copy()
        for c in curves:
            tables[c], eps[c] = scene.source.rounded(exact.feature_of[c]), ONCE
        super().__init__("forms are tilted")
        self.scene = replace(scene, table=tables, eps=eps)


def sign(x: Ball) -> int:
    """Return the sign of a ball; 0 if its bits do not tell."""
    return 1 if x > 0 else -1 if x < 0 else 0


def sure(answer: Answer | None, what: str) -> Answer:
    """Return an answer, or refuse None: not even the most bits decide something."""
    if answer is None:
        raise UndecidedError(what)
    return answer


def near_roots(p: list[Ball]) -> list[Ball]:
    """Return the real roots of a polynomial of rounded coefficients, upwards, multiple ones once.

    Between two roots of its derivative it has one root, or none. Where it turns and is zero but for
    rounding, there is a multiple root: rounding parts such roots, but hardly moves those of the
    derivative. To be called within `PRECISE` bits.
    """
    if len(p) < 3:
        return [-p[0] / p[1]] if len(p) == 2 else []
    turns = near_roots([k * c for k, c in enumerate(p)][1:])
    ratios = (abs(c / p[-1]).root(k) for k, c in enumerate(p[-2::-1], 1))
    bound = 1 + 2 * max(ratios).mid()  # Fujiwara's
    marks = [-bound, *turns, bound]
    found = []
    signs = [_sign_at(p, x) for x in marks]
    for k, (x, s) in enumerate(zip(marks, signs, strict=True)):
        if s == 0:
            found.append(x)
        elif k and s * signs[k - 1] < 0:
            found.append(_between(p, marks[k - 1], x, s))
    return found


def _values(p: list[Ball], x: Ball) -> tuple[Ball, Ball]:
    """Return a polynomial's value and its slope."""
    value = slope = 0 * x
    for c in reversed(p):
        value, slope = value * x + c, slope * x + value
    return value, slope


def _sign_at(p: list[Ball], x: Ball) -> int:
    value, (size, _) = _values(p, x)[0], _values([abs(c) for c in p], abs(x))
    return 0 if abs(value) < size / 2**TOUCHES else sign(value)


def _between(p: list[Ball], low: Ball, high: Ball, rising: int) -> Ball:
    """Return the one root between two places, by Newton's method that never leaves them."""
    x = ((low + high) / 2).mid()
    for _ in range(4 * PRECISE):
        value, slope = _values(p, x)
        side = sign(value)
        if side == 0:
            break
        low, high = (low, x) if side == rising else (x, high)
        new = (x - value / slope).mid() if slope != 0 else low
        if not low < new < high:
            new = ((low + high) / 2).mid()
        if abs(new - x) < (1 + abs(x)) / 2 ** (PRECISE - 150):
            return new
        x = new
    return x


class Exact:
    """Answers about one scene; tables, polynomials and their zeros are made once (sentence 4).

    Attributes
    ----------
    events : structured array
        The events of the lines.
    best : ndarray of int
        An event of each line.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene, self.turns, self.source = scene, scene.turns, scene.source
        self.real: dict[tuple[Any, int], list[Ball]] = {}
        self.near: dict[Any, list[Ball]] = {}
        self.known: dict[tuple[int, int, int, float], tuple[Number, int]] = {}
        self.events: Array = made(END, np.zeros(0), 0.0, 0)
        self.best: Ints = np.zeros(0, dtype=np.int64)
        self.lift_ranges: dict[int, tuple[Ball, Ball]] = {}
        self.rounded = False
        self.table = cache(self._table)
        self.form = cache(self._form)
        self.numbers = cache(self._numbers)
        self.same = cache(self._same)
        first = {int(c): f for f, c in reversed(list(enumerate(scene.curve.tolist())))}
        self.feature_of = first

    def first(
        self, asked: Callable[[int], Answer | None], precisions: Sequence[int] = BITS
    ) -> Answer | None:
        """Ask at ever more bits until there is an answer."""
        for bits in precisions:
            with self.flint.ctx.workprec(bits):
                if (answer := asked(bits)) is not None:
                    return answer
        return None

    # --- numbers ----------------------------------------------------------------------------------

    @cached_property
    def flint(self) -> Any:
        """python-flint; a region without exact questions never imports it."""
        import flint

        return flint

    def rational(self, x: Any) -> Any:
        """Return a coefficient as a rational."""
        if isinstance(x, float | np.floating):
            return self.flint.fmpq(*float(x).as_integer_ratio())
        if not isinstance(x, self.flint.arb):
            return self.flint.fmpq(x)
        if x.contains(0):  # terms that cancel
            return self.flint.fmpq(0)
        with self.flint.ctx.workprec(KEPT):
            self.rounded = True
            return self.centre(x + 0)

    def centre(self, x: Ball) -> Any:
        """Return the middle of a ball as a rational."""
        man, exp = x.mid().man_exp()
        return self.flint.fmpq(man) * self.flint.fmpq(2) ** int(exp)

    def _table(self, name: Name) -> list[list[Any]]:
        """Return the exact coefficients of what has a name, base before lift."""
        if isinstance(name, tuple) and name[1] is None:
            table = np.array([self.table(name[0])], dtype=object)
            return list(along_base(self.turns[0], table)[0])
        f, side = name if isinstance(name, tuple) else (self.feature_of[name], None)
        return [[self.rational(x) for x in row] for row in self.source.feature(f, side)]

    def _form(self, name: Name) -> list[Any]:
        """Return the columns of a table as polynomials: of tan(t / 2), times 1 + tan², or of t.

        They are coefficients along the lift. The table is divided by a power of two: then its
        largest coefficient is about 1 (sentence 4).
        """
        table = self.table(name)
        size = max(abs(x) for row in table for x in row)
        power = self.flint.fmpq(2) ** (int(size.q).bit_length() - int(size.p).bit_length())
        columns: Iterable[Sequence[Any]] = zip(*table, strict=True)
        if self.turns[0]:
            columns = ([a + b, 2 * c, a - b] for a, b, c in columns)
        return [power * self.flint.fmpq_poly(list(column)) for column in columns]

    def is_zero(self, polynomial: Any) -> bool:
        """Tell whether a polynomial is zero, but for the rounding of irrational coefficients."""
        return all(map(self.is_nothing, polynomial.coeffs()))

    def is_nothing(self, x: Any) -> bool:
        """Tell whether a coefficient is zero, but for rounding."""
        return bool(abs(x) <= (self.flint.fmpq(1, 2**ZERO) if self.rounded else 0))

    @cached_property
    def lift_ends(self) -> list[tuple[Any, Any, Any]]:
        """The different ends of the lift as rational points: (1, cos, sin) or (1, v, v²)."""
        if not self.turns[1]:
            return [(1, q, q * q) for q in self.ends[1]]
        return list(dict.fromkeys(map(on_circle, self.ends[1])))

    @cached_property
    def ends(self) -> list[list[Any]]:
        """Both ends of base and lift: rational values, or tan of half an angle; None: infinite."""
        return [[self._end_as_number(j, k) for k in (0, 1)] for j in (0, 1)]

    def _end_as_number(self, j: int, upper: int) -> Any:
        """Return an end as a rational number: the simple one if it is exact, else a rounded one."""
        if not self.turns[j]:
            with self.flint.ctx.workprec(2 * KEPT):
                return simplest_in(self.source.end(j, upper))
        if self.scene.round[j]:
            return self.flint.fmpq(round(100 * CUT_OPEN[j]), 100)
        arb, near = self.flint.arb, half_tangent(self.scene.ends[j][upper])
        with self.flint.ctx.workprec(2 * KEPT):
            end, pi = self.source.end(j, upper), arb.pi()
            angle = pi if near is None else 2 * arb(near).atan()
            off = (end - angle) / (2 * pi)
            if abs(off - round(float(off.mid()))) < arb(2) ** -SAME:
                return near
            return self.rational((end / 2).tan())

    def _numbers(self, kind: int, i: int, j: int) -> list[Number]:
        """Return the zeros of an event's polynomial; TiltedError if a wall's form has the lift."""
        still = kind != WALL or self.scene.lifted[i] or all(map(self.is_zero, self.form(i)[1:]))
        if not still:
            raise TiltedError(self, [i])
        found: list[Number] = []
        p, degree = self.polynomial(kind, i, j)
        while p and self.is_nothing(p[p.degree()]):
            p = self.flint.fmpq_poly(p.coeffs()[:-1])
        if not p:
            return found
        if self.turns[0] and p.degree() < degree:
            found.append(INFINITE)
        if self.rounded:
            key = tuple(map(int, p.numer().coeffs()))
            with self.flint.ctx.workprec(PRECISE):
                self.near[key] = self.near.get(key) or near_roots([self.flint.arb(c) for c in key])
            return found + [(key, n) for n in range(len(self.near[key]))]
        for factor, _ in p.numer().factor()[1]:
            if factor.degree() > 0:
                key = tuple(map(int, factor.coeffs()))
                found += [(key, n) for n in range(len(self._real_roots(key, BITS[0])))]
        return found

    def _real_roots(self, key: Any, bits: int) -> list[Ball]:
        """Return the real roots of an irreducible, or of a rounded, polynomial, upwards."""
        if key in self.near:
            return self.near[key]
        if (key, bits) not in self.real:
            with self.flint.ctx.workprec(bits):
                roots = self.flint.fmpz_poly(list(key)).complex_roots()
                self.real[key, bits] = [root.real for root, _ in roots if root.imag == 0]
        return self.real[key, bits]

    def ball(self, number: Number, turn: int, bits: int) -> Ball:
        """Return an exact number as a ball; to be called within this precision."""
        key, n = number
        if not self.turns[0]:
            return self._real_roots(key, bits)[n]
        angle = 2 * self._real_roots(key, bits)[n].atan() if key else self.flint.arb.pi()
        return angle + 2 * turn * self.flint.arb.pi()

    def double(self, number: Number, turn: int = 0) -> float:
        """Return an exact number as a double."""
        with self.flint.ctx.workprec(BITS[0]):
            return float(self.ball(number, turn, BITS[0]).mid())

    def end_number(self, upper: int) -> tuple[Number, int]:
        """Return an end of the base as an exact number, and by how many turns it is moved."""
        q, end = self.ends[0][upper], self.scene.ends[0][upper]
        number = INFINITE if q is None else ((int(-q.p), int(q.q)), 0)
        return number, round((end - self.double(number)) / TURN) if self.turns[0] else 0

    # --- events -----------------------------------------------------------------------------------

    def polynomial(self, kind: int, i: int, j: int) -> tuple[Any, int]:
        """Return the polynomial of an event, and the degree that it has at most (sentence 2).

        Where two curves coincide, their resultant is zero; then a component of the cross product of
        their coefficients is taken.
        """
        turns = self.turns[1]
        if kind == WALL:
            return self.form(i)[0], 2
        if kind == FOLD:
            return fold(self.form(i), turns), 4
        if kind == LIMIT:
            end = self.lift_ends[min(j, len(self.lift_ends) - 1)]
            return sum(x * y for x, y in zip(end, self.form(i), strict=True)), 2
        a = self.form(i if kind == CROSS else int(self.scene.curve[i]))
        b = self.form(j if kind == CROSS else (i, j))
        p = self.shared(a, b)
        if not self.is_zero(p):
            return p, 8 if turns or a[2] or b[2] else 4
        return next(((x, 4) for x in crossed(a, b) if not self.is_zero(x)), (p, 8))

    def shared(self, a: Any, b: Any) -> Any:
        """Return the polynomial of the base values over which two forms share a root."""
        if not self.turns[1] and not a[2] and not b[2]:
            return crossed(a, b)[2]
        return resultant(a, b, self.turns[1])

    def zeros(self, kind: int, i: int, j: int, key: int = -1) -> Array:
        """Return all zeros of an event within the base as events."""
        low, high = self.scene.ends[0]
        found = []
        for number in self.numbers(kind, i, j):
            t = self.double(number)
            turns = range(int(low - 1e-9 < t < high + 1e-9))
            if self.turns[0]:
                first, last = (low - 1e-9 - t) / TURN, (high + 1e-9 - t) / TURN
                turns = range(math.ceil(first), math.floor(last) + 1)
            found += [self._keep((kind, i, j), t + TURN * n, (number, n)) for n in turns]
        at = np.array(found, dtype=float)
        return made(kind, at, 8 * UNIT * (1 + np.abs(at)), i, j, key)

    def _keep(self, name: tuple[int, int, int], t: float, number: tuple[Number, int]) -> float:
        """Keep the exact number of an event; return its double, the next free one."""
        while self.known.setdefault((*name, t), number) != number:
            t = float(np.nextafter(t, np.inf))  # two zeros with one double
        return t

    def number(self, event: Any) -> tuple[Number, int]:
        """Return the exact number of an event, and by how many turns it is moved (sentence 4)."""
        t, _, kind, i, j, _ = event.tolist()
        if kind == END and (kind, i, j, t) not in self.known:
            self.known[kind, i, j, t] = self.end_number(i)
        if (kind, i, j, t) not in self.known:
            every = []
            for number in self.numbers(kind, i, j):
                x = self.double(number)
                n = round((t - x) / TURN) if self.turns[0] else 0
                every.append((abs(x + TURN * n - t), repr(number), (number, n)))
            self.known[kind, i, j, t] = min(every)[2]
        return self.known[kind, i, j, t]

    def place_of(self, event: Any) -> float:
        """Return the base value of an event, rounded."""
        _, _, kind, i, j, _ = event.tolist()
        number = self.number(event)
        return self._keep((kind, i, j), self.double(*number), number)

    def vanishes(self, event: Any) -> bool:
        """Tell whether the form of a fold or a limit vanishes on the whole fibre of the event.

        Then a wall of the same curve is known to be there.
        """
        number, curve = self.number(event), int(event["i"])
        if self.rounded:
            with self.flint.ctx.workprec(BITS[1]):
                least = max(abs(x) for row in self.table(curve) for x in row) / 2**FIBRE
                along = self.along(curve, self.ball(*number, BITS[1]))
                vanishes = all(abs(x) < least for x in along)
        elif number[0] == INFINITE:
            vanishes = all(p.degree() < 2 for p in self.form(curve))
        else:
            factor = self.flint.fmpq_poly(self.flint.fmpz_poly(list(number[0][0])))
            vanishes = all(not p % factor for p in self.form(curve))
        if vanishes:
            self.known[WALL, curve, 0, float(event["t"])] = number
        return vanishes

    def in_order(self, events: Array) -> list[list[int]]:
        """Put events in order, equal ones together: lists of their numbers (sentence 5)."""
        numbers = [self.number(event) for event in events]
        for bits in BITS:
            with self.flint.ctx.workprec(bits):
                balls = [(self.ball(*number, bits), k) for k, number in enumerate(numbers)]
                groups, vague = self._grouped(balls, lambda j, k: numbers[j] == numbers[k])
                if not vague:
                    break
        if vague and not self.rounded:  # of rounded numbers what 4,096 bits do not part is equal
            raise UndecidedError("the order of two events")
        return groups

    def _grouped(self, balls: list[tuple[Ball, int]], equal: Any) -> tuple[list[list[int]], bool]:
        """Put balls in order, those that overlap together; tell if overlapping ones may differ."""
        least = self.flint.arb(2) ** -SAME if self.rounded else self.flint.arb(0)
        balls = sorted(balls, key=lambda item: self.centre(item[0]))
        groups: list[list[int]] = []
        vague, reach = False, balls[0][0]
        for ball, k in balls:
            if groups and not ball - reach > least:
                apart = bool(reach < ball)  # by less than rounding
                vague |= not apart and not any(equal(j, k) for j in groups[-1])
                groups[-1].append(k)
            else:
                groups.append([k])
            reach = ball
        return groups, vague

    def line(self, k: int, bits: int) -> Ball:
        """Return a line's base value as a ball."""
        return self.ball(*self.number(self.events[self.best[k]]), bits)

    def between(self, a: int, b: int) -> Ball:
        """Return an exact number between two lines: a double, if one surely is (sentence 8)."""
        events = self.events[self.best[[a, b]]]
        (low, high), (one, other) = events["t"].tolist(), events["radius"].tolist()
        if high - low > VAGUE * (one + other):
            return self.flint.arb(low + SHARE * (high - low))

        def middle(bits: int) -> Ball | None:
            x, y = self.line(a, bits), self.line(b, bits)
            found = self.flint.arb(((x + y) / 2).mid())
            return found if x < found < y else None

        return sure(self.first(middle), "the order of two lines")

    def is_equal(self, one: int, other: int) -> bool:
        """Tell whether two curves have the same form, up to a positive factor (sentence 4)."""
        tables = [[x for row in self.table(c) for x in row] for c in (one, other)]
        a, b = (self.flint.fmpq_poly(flat) / max(map(abs, flat)) for flat in tables)
        return self.is_zero(a - b)

    # --- roots ------------------------------------------------------------------------------------

    def lift_range(self) -> tuple[Ball, Ball]:
        """Return the ends of the lift, to any precision, as `lift_ends`."""
        bits = int(self.flint.ctx.prec)
        if bits not in self.lift_ranges:
            low, high = (self._lift_end(q, k) for k, q in enumerate(self.ends[1]))
            self.lift_ranges[bits] = low, high
        return self.lift_ranges[bits]

    def _lift_end(self, q: Any, upper: int) -> Ball:
        arb = self.flint.arb
        if not self.turns[1]:
            return arb(q)
        angle = arb.pi() if q is None else 2 * arb(q).atan()
        turn = round((self.scene.ends[1][upper] - float(angle.mid())) / TURN)
        return angle + 2 * turn * arb.pi()

    def along(self, name: Name, t: Ball) -> list[Ball]:
        """Return the coefficients along the lift over a base value of what has a name."""
        one, other = (t.cos(), t.sin()) if self.turns[0] else (t, t * t)
        a = self.table(name)
        return [self.flint.arb(a[0][j] + a[1][j] * one + a[2][j] * other) for j in range(3)]

    def about(self, curve: int, origin: tuple[float, float]) -> list[list[float]]:
        """Return a curve's coefficients about a place: of (1, cos x - 1, sin x), or (1, x, x²)."""
        arb, shifts = self.flint.arb, []
        with self.flint.ctx.workprec(BITS[1]):
            for turns, value in zip(self.turns, origin, strict=True):
                x = arb(value)
                c, s = x.cos(), x.sin()
                moved = [(1, 0, 0), (x, 1, 0), (x * x, 2 * x, 1)]
                turned = [(1, 0, 0), (c, c, -s), (s, s, c)]
                shifts.append(np.array(turned if turns else moved, dtype=object))
            product = shifts[0].T @ np.array(self.table(curve), dtype=object) @ shifts[1]
            return [[float(arb(x).mid()) for x in row] for row in product]

    def is_double(self, curve: Name) -> bool:
        """Tell whether a curve's two roots are one over every base value (sentence 4)."""
        return self.is_zero(fold(self.form(curve), self.turns[1]))

    def _roots(self, curve: Name, t: Ball) -> tuple[Ball, Ball] | None:
        """Return the rising and the falling root (sentence 1); None: no root, or too few bits."""
        arb = self.flint.arb
        c0, c1, c2 = self.along(curve, t)
        if self.is_double(curve):
            v = arb.atan2(-c0 * c2, -c0 * c1) if self.turns[1] else -c1 / (2 * c2)
            return v, v
        rest = fold((c0, c1, c2), self.turns[1])
        if not rest > 0:
            return None
        root = rest.sqrt()
        if self.turns[1]:
            theta, alpha = arb.atan2(c2, c1), arb.atan2(root, -c0)
            return theta - alpha, theta + alpha
        straight = not self.form(curve)[2]
        rising = -2 * c0 / (c1 + root) if c1 > 0 else None if straight else (root - c1) / (2 * c2)
        falling = 2 * c0 / (root - c1) if c1 < 0 else None if straight else (-c1 - root) / (2 * c2)
        return rising, falling

    def _root(self, root: Any, t: Ball) -> Ball | None:
        """Return a root, in any turn; None if these bits do not tell."""
        try:
            both = self._roots(root[0], t)
        except ZeroDivisionError:
            return None
        v = None if both is None else both[root[1] < 0]
        return v if v is not None and v.is_finite() else None

    def root(self, root: Root, t: Ball) -> Ball | None:
        """Return a named root over a base value; None if these bits do not tell (sentence 1)."""
        curve, _, turn = root
        if curve < 0:
            return self.lift_range()[curve == HIGH]
        v = self._root(root, t)
        if v is None or not self.turns[1]:
            return v
        pi = self.flint.arb.pi()
        ratio = (v - self.lift_range()[0]) / (2 * pi)
        turns = ratio.floor().unique_fmpz()
        if turns is None:
            if not self.same(LOW, curve):
                return None
            turns = round(float(ratio.mid()))  # it is an end of the lift over every base value
        return v - 2 * pi * (int(turns) - turn)

    def exists(self, curve: int, a: int, b: int) -> bool:
        """Tell whether a curve has roots between two lines (sentence 6)."""
        if self.is_double(curve):
            return True
        t = self.between(a, b)
        found = self.first(lambda _: self.beyond(fold(self.along(curve, t), self.turns[1])) or None)
        return found == 1  # none: at a fold that is no event, because it is no contact

    def inside(self, root: Root, a: int, b: int) -> bool:
        """Tell whether a root is strictly within the lift between two lines (sentence 6)."""
        t = self.between(a, b)

        def within(_: int) -> int | None:
            if (v := self.root(root, t)) is None:
                return None
            low, high = self.lift_range()
            return self.beyond(v - low) * self.beyond(high - v) or None

        return self.first(within) == 1  # none: it is an end of the lift, over every base value

    def holds(self, feature: int, root: Root, a: int, b: int) -> bool:
        """Tell whether a root is a contact between two lines: no side condition is negative."""
        t = self.between(a, b)
        return self._lowest(self._sides(feature), lambda _: (t, self.root(root, t))) >= 0

    def covers(self, feature: int, line: int, at: Between) -> bool:
        """Tell whether the wall of a feature covers a place on a line (sentence 10)."""
        return self._lowest(self._sides(feature), lambda bits: self._on_line(line, at, bits)) >= 0

    def slope(self, curve: int, line: int, at: Between) -> int:
        """Return the sign of a form's slope along the base at a place on a line."""
        return self._lowest([self.table((curve, None))], lambda bits: self._on_line(line, at, bits))

    def vanishes_on(self, feature: int, side: int, root: Root, event: Any) -> bool:
        """Tell whether a side condition vanishes on a root at an event (sentence 6)."""

        def place(bits: int) -> tuple[Ball, Ball | None]:
            t = self.ball(*self.number(event), bits)
            return t, self.root(root, t)

        return self._lowest([self.source.feature(feature, side)], place) == 0

    def _sides(self, feature: int) -> list[Any]:
        """Return the side conditions of a feature that are no constants."""
        varied = np.flatnonzero(is_varied(self.scene.sides[feature])).tolist()
        return [self.source.feature(feature, s) for s in varied]

    def _lowest(self, tables: list[Any], place: Callable[[int], tuple[Ball, Ball | None]]) -> int:
        """Return the lowest sign of forms at a place; 0 if one is zero, or the bits do not tell."""

        def lowest(bits: int) -> int | None:
            t, v = place(bits)
            if v is None:
                return None
            return min((self.sign(table, t, v) for table in tables), default=1) or None

        return self.first(lowest) or 0

    def value(self, root: Root, a: int, b: int) -> float:
        """Return the value of a root between two lines, as a double."""
        t = self.between(a, b)
        return float(sure(self.first(lambda _: self.root(root, t)), "the value of a root").mid())

    def ranked(self, roots: Sequence[Root], a: int, b: int) -> tuple[list[list[int]], list[float]]:
        """Put roots between two lines in order, equal ones together (sentence 8).

        Return groups of their numbers, and their values.
        """
        t = self.between(a, b)
        for bits in BITS:
            with self.flint.ctx.workprec(bits):
                values = [self.root(root, t) for root in roots]
                balls = [(v, k) for k, v in enumerate(values) if v is not None]
                if len(balls) < len(roots):
                    continue
                groups, vague = self._grouped(
                    balls,
                    lambda j, k, bits=bits: bits > BITS[0] and self.share(roots[j][0], roots[k][0]),
                )
                if not vague:
                    break
        if len(balls) < len(roots) or (vague and bits < BITS[-1]):
            raise UndecidedError("the order of two roots")
        # What 4,096 bits do not part is one number.
        return groups, [float(v.mid()) for v, _ in balls]

    def share(self, one: int, other: int) -> bool:
        """Tell whether two curves, or ends of the lift, share a root over all base values."""
        return self.same(min(one, other), max(one, other))

    def _same(self, i: int, j: int) -> bool:
        """Tell whether two curves, i <= j, share a root over every base value (sentence 4).

        A curve shares a root with itself if it is double.
        """
        if j < 0:
            return i == j
        if i == j:
            return self.is_double(i)
        if i < 0:
            ends = range(len(self.lift_ends))
            return any(self.is_zero(self.polynomial(LIMIT, j, k)[0]) for k in ends)
        return self.is_zero(self.shared(self.form(i), self.form(j)))

    def beside(self, place: Place, bits: int, part: Any = 1) -> Ball | None:
        """Return a root just beside a line, or at a part of this step; or what vanishes on it."""
        root, line, side = place
        t = self.line(line, bits)
        if side:
            return self.root(root, self.near_line(line, side, bits, part))
        v, pi = self._root(root, t), self.flint.arb.pi()
        if v is None or not self.turns[1]:
            return v
        return v + 2 * pi * round((root[2] - float(v.mid())) / TURN)

    def near_line(self, line: int, side: int, bits: int, part: Any = 1) -> Ball:
        """Return a base value just beside a line, before the next one."""
        t, step = self.line(line, bits), self.step(bits)
        if 0 <= line + side < len(self.best):
            room = abs(self.line(line + side, bits) - t) / 2
            step = room if room < step else step
        return t + side * step * part

    def step(self, bits: int) -> Ball:
        """Return how far beside a line a place is looked at."""
        return self.flint.arb(2) ** -(SAME - 20 if self.rounded else bits // 4)

    def limit(self, place: Place) -> float:
        """Return the limit of a root on a line, as a double (sentence 10)."""
        found = self.first(lambda bits: self.beside(place, bits), BITS[1:])
        return float(sure(found, "the end of a root").mid())

    def compared(self, one: Place, other: Place) -> int:
        """Return the sign of the difference of two ends of cells on their lines (sentence 10).

        The roots are compared just beside their lines. What differs there by less than these bits
        show is equal, and so is what vanishes nowhere but for rounding.
        """
        if one == other:
            return 0

        def order(bits: int) -> int | None:
            a, b = self.beside(one, bits), self.beside(other, bits)
            if a is None or b is None:
                if bits == BITS[-1] and one[2] and other[2]:
                    raise UndecidedError("the order of two ends of cells")
                return None
            rough = self.flint.arb(2) ** -(SAME // 2 - 30 if self.rounded else bits // 10)
            return sign(a - b) if abs(a - b) > rough else None

        return self.first(order, BITS[1:]) or self._parted(one, other)

    def _parted(self, one: Place, other: Place) -> int:
        """Return the same for ends that hardly differ: what meets comes nearer (sentence 10)."""
        bits, arb = BITS[-1], self.flint.arb
        with self.flint.ctx.workprec(bits):
            gaps = []
            for part in (arb(1), arb(2) ** -NEARER):
                ends = [self.beside(place, bits, part) for place in (one, other)]
                if not (one[2] and other[2]) or ends[0] is None or ends[1] is None:
                    return 0
                gaps.append(ends[0] - ends[1])
            meet = 4 * abs(gaps[1]) < abs(gaps[0]) or abs(gaps[1]) < arb(2) ** -(KEPT - 140)
            return 0 if meet else sign(gaps[1])

    def _on_line(self, line: int, at: Between, bits: int) -> tuple[Ball, Ball | None]:
        """Return a place on a line; the lift value is None if these bits do not tell."""
        t = self.line(line, bits)
        if isinstance(at, float):
            return t, self.flint.arb(at)
        low, high = (self.beside(place, bits) for place in at)
        if bits == BITS[0] or low is None or high is None or not low < high:
            return t, None
        return t, self.flint.arb(((low + high) / 2).mid())

    # --- signs ------------------------------------------------------------------------------------

    def sign(self, table: Any, t: Ball, v: Ball) -> int:
        """Return the sign of a form at a place; 0 if the bits do not tell (sentence 9)."""
        turns = self.turns
        base = (1, t.cos(), t.sin()) if turns[0] else (1, t, t * t)
        lift = (1, v.cos(), v.sin()) if turns[1] else (1, v, v * v)
        terms = [
            (self.rational(coefficient), x * y)
            for row, x in zip(table, base, strict=True)
            for coefficient, y in zip(row, lift, strict=True)
            if coefficient != 0
        ]
        value = sum((c * xy for c, xy in terms), self.flint.arb(0))
        return self.beyond(value, sum(abs(c) for c, _ in terms))  # no factor exceeds 1

    def beyond(self, x: Ball, size: Any = 1) -> int:
        """Return the sign of a ball; 0 if its bits do not tell, or if it is rounding of terms."""
        return 0 if self.rounded and abs(x) < self.flint.arb(size) / 2**SAME else sign(x)

    def place(self, spot: Any, share: float) -> tuple[Ball, Ball | None]:
        """Return a place in a gap as balls; the lift value is None if these bits do not tell."""
        arb = self.flint.arb
        if len(spot) == 2:
            return arb(spot[0]), arb(spot[1])
        lines, lower, upper = spot
        if isinstance(lines, int):
            bits = int(self.flint.ctx.prec)
            return self.near_line(lines, lower, bits), self._on_line(lines, upper, bits)[1]
        t = self.between(*lines)
        low, high = self.root(lower, t), self.root(upper, t)
        if low is None or high is None or not low < high:
            return t, None
        return t, arb((low + (high - low) * share).mid())

    def in_doubles(self, spot: Spot) -> tuple[Floats, Floats]:
        """Return a place in a gap rounded: base and lift value, (1,) each."""

        def rounded(_: int) -> tuple[Floats, Floats] | None:
            t, v = self.place(spot, 0.5)
            return None if v is None else (np.array([float(t.mid())]), np.array([float(v.mid())]))

        return sure(self.first(rounded), "a place between two roots")

    def is_apart(self, pair: int, spot: Spot) -> bool:
        """Tell whether a pair is apart at a place in a gap (sentence 9).

        A form that is zero everywhere parts nothing; a side condition that is zero holds.
        """
        own = self.source.clauses(pair)
        clauses = np.split(own.order, own.starts[1:])

        def best(_: int, share: float) -> int | None:
            t, v = self.place(spot, share)
            if v is None:
                return None
            known = np.zeros(len(own.rows))
            if t.rad() < UNIT:  # doubles tell most signs
                near = np.array([[float(x.mid())] for x in (t, v)])
                values = own.forms @ self.scene.products(*near)[0]
                doubt = own.doubt * (1 + np.abs(near).sum())  # the place is rounded too
                known = np.where(np.abs(values) > doubt, np.sign(values), 0.0)

            def least(rows: Ints) -> int:
                if (known[rows] < 0).any():
                    return -1
                asked = rows[known[rows] == 0].tolist()
                return min((self._sign_in_clause(own.rows[k], t, v) for k in asked), default=1)

            return max(map(least, clauses)) or None

        asked = (self.first(partial(best, share=share)) for share in (0.5, 0.37))
        return next(filter(None, asked), -1) == 1  # none: zero along the whole gap, in touch

    def _sign_in_clause(self, row: tuple[int, int | None], t: Ball, v: Ball) -> int:
        table = self.source.feature(*row)
        if all(x == 0 for line in table for x in line):
            return int(row[1] is not None)
        return self.sign(table, t, v)

    def is_positive(self, curve: int, spot: Spot) -> bool:
        """Tell whether a form is positive at a place in a gap (sentence 9)."""
        table = self.source.feature(self.feature_of[curve])
        return self._lowest([table], lambda _: self.place(spot, 0.5)) > 0

    def meet(self, event: Any, roots: Sequence[Root], side: int) -> bool:
        """Tell whether two roots meet at an event (sentence 7).

        Where a form vanishes on the whole fibre, or folds, they are looked at just beside it.
        """
        for bits, step in ((BITS[1], 0), (BITS[2], side * self.step(BITS[2]))):
            with self.flint.ctx.workprec(bits):
                t = self.flint.arb(self.ball(*self.number(event), bits).mid()) + step
                one, other = (self.root(root, t) for root in roots)
                if one is not None and other is not None:
                    return float(abs(one - other).mid()) < 1e-30
        return True
