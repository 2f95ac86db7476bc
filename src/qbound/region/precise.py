"""Decisions in balls (Arb), where doubles cannot decide.

Doubles come with a bound of their error. Where two numbers are nearer to each other than their
errors, they are computed again here: from exact coefficients, at 128 bits, then at 1,024.
Numbers whose balls still overlap then are one number; all others are different, however near.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol

from numpy.typing import NDArray

from qbound.boundary.contacts import SIDES
from qbound.region.plane import HIGHEST, Plane

if TYPE_CHECKING:
    from flint import arb_series

    from qbound.region.problem import Problem

Ball = Any
"""An `arb`."""

LEVELS: Final = (128, 1024)
"""Bits that are tried in turn."""

ORDERS: Final = 12
"""Derivatives that are looked at, above the multiplicity of any zero of an event."""

HALVINGS: Final = 24
"""Times an interval is halved before an event counts as zero all over it."""


class Rows(Protocol):
    """Coefficients of a problem's forms and features, exact."""

    def form(self, row: int) -> NDArray[Any]: ...  # noqa: D102
    def feature(self, k: int) -> tuple[NDArray[Any], NDArray[Any]]: ...  # noqa: D102
    def range(self, joint: int) -> tuple[Ball, Ball] | None: ...  # noqa: D102


class UndecidedError(ArithmeticError):
    """Something about the structure of a region could not be decided; the message says where."""


@contextmanager
def precision(bits: int, orders: int = ORDERS) -> Iterator[None]:
    """Compute with this many bits, and with power series of so many orders."""
    from flint import ctx

    before, cap = ctx.prec, ctx.cap
    ctx.prec, ctx.cap = bits, orders + 1
    try:
        yield
    finally:
        ctx.prec, ctx.cap = before, cap


# --- events ---------------------------------------------------------------------------------------

Product = Callable[[Any, Any], Any]


def _fold_circle(a: Any, _: Any, x: Product) -> Any:
    return x(a[1], a[1]) + x(a[2], a[2]) - x(a[0], a[0])


def _fold_line(a: Any, _: Any, x: Product) -> Any:
    return x(a[1], a[1]) - 4 * x(a[0], a[2])


def _end(a: Any, b: Any, x: Product) -> Any:
    return x(a[0], b[0]) + x(a[1], b[1]) + x(a[2], b[2])


def _determinant(a: Any, b: Any, x: Product) -> Any:
    return x(a[1], b[2]) - x(a[2], b[1])


def _cosine(a: Any, b: Any, x: Product) -> Any:
    return x(a[2], b[0]) - x(a[0], b[2])


def _sine(a: Any, b: Any, x: Product) -> Any:
    return x(a[0], b[1]) - x(a[1], b[0])


def _resultant_circle(a: Any, b: Any, x: Product) -> Any:
    one, other, both = _cosine(a, b, x), _sine(a, b, x), _determinant(a, b, x)
    return x(one, one) + x(other, other) - x(both, both)


def _resultant_line(a: Any, b: Any, x: Product) -> Any:
    q = _cosine(a, b, x)
    return x(q, q) - x(-_determinant(a, b, x), -_sine(a, b, x))


def _under(a: Any, b: Any, x: Product) -> Any:
    """Resultant of a quadratic a and an affine b."""
    return x(x(a[2], b[0]), b[0]) - x(x(a[1], b[0]), b[1]) + x(x(a[0], b[1]), b[1])


def _over(a: Any, b: Any, x: Product) -> Any:
    return _under(b, a, x)


@dataclass(frozen=True)
class EventKind:
    """A function of the base that vanishes where something happens to one form or to two.

    Attributes
    ----------
    formula : callable
        Of both forms' three coefficients along the lift, and of a product: the same for
        polynomials, numbers and power series.
    size : callable
        The same with all signs positive, of bounds of the coefficients.
    degrees : (int, int)
        In the coefficients of the one and of the other.
    """

    formula: Callable[[Any, Any, Product], Any]
    size: Callable[[Any, Any], Any]
    degrees: tuple[int, int]


def _crossed(i: int, j: int) -> Callable[[Any, Any], Any]:
    return lambda a, b: a[i] * b[j] + a[j] * b[i]


_ONE, _TWO, _BOTH = _crossed(2, 0), _crossed(0, 1), _crossed(1, 2)


def _size_under(a: Any, b: Any) -> Any:
    return a[2] * b[0] ** 2 + a[1] * b[0] * b[1] + a[0] * b[1] ** 2


KINDS: Final = {
    "fold circle": EventKind(_fold_circle, lambda a, b: a[0] ** 2 + a[1] ** 2 + a[2] ** 2, (2, 0)),
    "fold line": EventKind(_fold_line, lambda a, b: a[1] ** 2 + 4 * a[0] * a[2], (2, 0)),
    "constant": EventKind(lambda a, b, x: a[0], lambda a, b: a[0], (1, 0)),
    "first": EventKind(lambda a, b, x: a[1], lambda a, b: a[1], (1, 0)),
    "second": EventKind(lambda a, b, x: a[2], lambda a, b: a[2], (1, 0)),
    "lower end": EventKind(_end, lambda a, b: a[0] + a[1] + a[2], (1, 0)),
    "upper end": EventKind(_end, lambda a, b: a[0] + a[1] + a[2], (1, 0)),
    "determinant": EventKind(_determinant, _BOTH, (1, 1)),
    "cosine": EventKind(_cosine, _ONE, (1, 1)),
    "sine": EventKind(_sine, _TWO, (1, 1)),
    "resultant circle": EventKind(
        _resultant_circle,
        lambda a, b: _ONE(a, b) ** 2 + _TWO(a, b) ** 2 + _BOTH(a, b) ** 2,
        (2, 2),
    ),
    "resultant line": EventKind(
        _resultant_line, lambda a, b: _ONE(a, b) ** 2 + _BOTH(a, b) * _TWO(a, b), (2, 2)
    ),
    "under": EventKind(_under, _size_under, (1, 2)),
    "over": EventKind(_over, lambda a, b: _size_under(b, a), (2, 1)),
}
"""What may happen at a base value.

A fold: two roots of a form meet. First, second, constant: that coefficient along the lift vanishes.
An end: a root passes an end of the lift's range. The others: two forms may share a root.
"""

NAMES: Final = tuple(KINDS)
NUMBER: Final = {name: k for k, name in enumerate(NAMES)}


@dataclass(frozen=True, eq=False)
class Zero:
    """A zero of a derivative of an event, isolated.

    Attributes
    ----------
    event : (int, int, int) or None
        Kind, and both rows; None for a fixed number.
    order : int
        Which derivative; above 0 for a zero of several derivatives in turn.
    ball : arb
        Holds it, and no other zero of that derivative.
    """

    event: tuple[int, int, int] | None
    order: int
    ball: Ball


class Precise:
    """What a plane's doubles cannot tell, told from exact coefficients.

    Rows are numbered as in `Plane`: forms, then features; after them the side conditions, those of
    a feature together; -1 and -2 are the ends of the lift's range.
    """

    @classmethod
    def of(cls, problem: Problem, base: int, caution: float = 1.0) -> Precise:
        """Return a problem's plane over a joint with its exact coefficients."""
        from qbound.region.exact import shared_rows

        rows, contacts = shared_rows(problem)
        plane = Plane(problem.forms, problem.ranges, base, contacts, problem.errors, caution)
        return cls(plane, rows)

    def __init__(self, plane: Plane, rows: Rows) -> None:
        self.plane, self.rows = plane, rows
        self.features = plane.count + len(plane.contacts.forms)
        self.decided = 0
        self._tables: dict[tuple[int, int], list[list[Ball]]] = {}
        self._exact: dict[int, NDArray[Any]] = {}
        self._zeros: dict[tuple[Any, ...], list[Zero]] = {}

    # --- coefficients ---------------------------------------------------------------------------

    def table(self, row: int, bits: int) -> list[list[Ball]]:
        """Return coefficients, base before lift, as balls."""
        from flint import arb

        found = self._tables.get((row, bits))
        if found is None:
            exact = self._exact_table(row)
            found = [[arb(x) for x in line] for line in exact]
            self._tables[row, bits] = found
        return found

    def _exact_table(self, row: int) -> NDArray[Any]:
        if row not in self._exact:
            count = self.plane.count
            if row < count:
                self._exact[row] = self._turned(self.rows.form(row))
            elif row < self.features:
                self._exact[row] = self._turned(self.rows.feature(row - count)[0])
            else:
                k, side = divmod(row - self.features, SIDES)
                self._exact[row] = self._turned(self.rows.feature(k)[1][side])
        return self._exact[row]

    def _turned(self, table: NDArray[Any]) -> NDArray[Any]:
        return table if self.plane.base == 0 else table.T

    def is_still(self, row: int) -> bool:
        """Tell whether the base surely does not move a row, or an end of the lift's range."""
        return row < 0 or all(x == 0 for x in self._exact_table(row)[1:].reshape(-1))

    def ends(self, joint: str) -> tuple[Ball, Ball]:
        """Return the exact ends of the range of "base" or "lift"; of a circle those of a turn."""
        from flint import arb

        index = self.plane.base if joint == "base" else 1 - self.plane.base
        found = self.rows.range(index)
        return (-arb.pi(), arb.pi()) if found is None else found

    def along_lift(self, row: int, t: Ball, bits: int) -> list[Ball]:
        """Return a row's three coefficients along the lift over a base value."""
        return _combined(self.table(row, bits), *_factors(self.plane.base_kind, t))

    def series(self, row: int, t: Ball, bits: int) -> list[arb_series]:
        """Return these as power series about a base value."""
        from flint import arb_series, ctx

        if ctx.cap > 2:
            return [arb_series(x) for x in self.along_lift(row, arb_series([t, 1]), bits)]
        # Of a value and a slope nothing is a product of series.
        kind, lines = self.plane.base_kind, self.table(row, bits)
        one, other = _factors(kind, t)
        values = _combined(lines, one, other)
        step = (-other, one) if kind == "revolute" else (1, 2 * t)
        slopes = _combined([_NOTHING, *lines[1:]], *step)
        return [arb_series([*pair]) for pair in zip(values, slopes, strict=True)]

    def value(self, row: int, t: Ball, v: Ball, bits: int) -> Ball:
        """Return the value of a row at base and lift."""
        c, (one, other) = self.along_lift(row, t, bits), _factors(self.plane.lift_kind, v)
        return c[0] + c[1] * one + c[2] * other

    def sign(self, row: int, t: Any, v: Any) -> int:
        """Return the sign of a row at a place; 0 where 1,024 bits do not tell it from zero.

        Base and lift value are numbers, or functions of the number of bits.
        """
        for bits in LEVELS:
            with precision(bits):
                place = _at(v, bits)  # None where so few bits do not tell it
                found = 0 if place is None else _sign(self.value(row, _at(t, bits), place, bits))
            if found:
                return found
        return 0

    def sides(self, row: int, t: Any, v: Any) -> tuple[int, int]:
        """Return the signs of a row just before a base value, and just behind it; as `sign`.

        Where the row vanishes they are those of its first derivative along the base that does not.
        """
        found, second = self.sign(row, t, v), 0
        for bits in LEVELS if not found else ():
            with precision(bits, orders=2):
                place = _at(v, bits)
                if place is None:
                    continue
                c, (one, other) = (
                    self.series(row, _at(t, bits), bits),
                    _factors(self.plane.lift_kind, place),
                )
                # Of degree 2 along the base at most, or 1 in an angle: it has no more derivatives.
                first, second = (_sign(c[0][k] + c[1][k] * one + c[2][k] * other) for k in (1, 2))
            if first:
                return -first, first
        return found or second, found or second

    def holds(self, feature: int, t: Any, v: Any) -> bool:
        """Tell whether no side condition of a feature is negative at a place, as `sign` has it."""
        sides = self.plane.sides[feature]
        for side, constant in enumerate(~sides.reshape(SIDES, 9)[:, 1:].any(axis=1)):
            number = self.features + SIDES * feature + side
            if sides[side, 0, 0] < 0 if constant else self.sign(number, t, v) < 0:
                return False
        return True

    # --- events ---------------------------------------------------------------------------------

    def taylor(self, event: tuple[int, int, int], t: Ball, bits: int, n: int) -> list[Ball]:
        """Return the first n derivatives of an event at t, each over its factorial."""
        from flint import arb, arb_series, ctx

        kind, i, j = event
        name = NAMES[kind]
        cap, ctx.cap = ctx.cap, n
        try:
            a, b = self.series(i, t, bits), None
            if name in ("lower end", "upper end"):
                end = self.ends("lift")[name == "upper end"]
                b = [arb(1), *_factors(self.plane.lift_kind, end)]
            elif KINDS[name].degrees[1]:
                b = self.series(j, t, bits)
            found = KINDS[name].formula(a, b, lambda x, y: x * y)
            found = arb_series(found)
        finally:
            ctx.cap = cap
        return [found[k] for k in range(n)]

    def vanishes(self, event: tuple[int, int, int]) -> bool:
        """Tell whether an event is zero at every base value.

        In each form it is of degree 2 at most along the base, so that it has at most four zeros a
        degree: one value more that is zero shows that all are.
        """
        key = ("vanishes", *event)
        if key not in self._zeros:
            with precision(LEVELS[-1]):
                from flint import arb

                low, high = self.plane.ends
                count = 4 * sum(KINDS[NAMES[event[0]]].degrees) + 1
                places = [arb(low + (high - low) * (k + 0.37) / count) for k in range(count)]
                every = all(self.taylor(event, t, LEVELS[-1], 1)[0].contains(0) for t in places)
            self._zeros[key] = [] if every else [Zero(event, 0, 0)]
        return not self._zeros[key]

    def zeros(
        self, event: tuple[int, int, int], low: float, high: float, bits: int
    ) -> list[Zero] | None:
        """Return the zeros of an event within an interval; None where it is zero all over it."""
        from flint import arb

        self.decided += 1
        with precision(bits):
            whole = arb((low + high) / 2, (high - low) / 2)
            return self._in(event, whole, bits)

    def _in(self, event: tuple[int, int, int], whole: Ball, bits: int) -> list[Zero] | None:
        from flint import arb

        found, open_ = list[Zero](), [(whole, 0)]
        while open_:
            part, depth = open_.pop()
            zeros = self._monotone(event, part, bits)
            if zeros is not None:
                found += [Zero(event, k, ball) for k, ball in zeros]
                continue
            if depth == HALVINGS:
                return None
            middle, half = arb(part.mid()), arb(part.rad()) / 2
            radius = half.upper()
            for side in (middle - half, middle + half):
                open_.append((arb(side.mid(), radius), depth + 1))
        return _apart(found)

    def _monotone(
        self, event: tuple[int, int, int], part: Ball, bits: int
    ) -> list[tuple[int, Ball]] | None:
        """Return the zeros within a ball, by those of its derivatives; None: no derivative helps.

        Between two zeros of its derivative a function is monotone, so its signs there tell whether
        it has a zero between. One whose sign is not known is a zero of both.
        """
        for way in range(3):
            if way < 2:  # most zeros are simple ones
                over = self.taylor(event, part, bits, ORDERS if way else 2)
            else:
                over = self._centred(event, part, bits)
            top = next((k for k, value in enumerate(over) if _sign(value)), None)
            if top is not None:
                break
        else:
            return None
        ends = [part.lower(), part.upper()]
        zeros: list[tuple[int, Ball]] = []
        for k in reversed(range(top)):
            marks = [(k, ends[0]), *zeros, (k, ends[1])]
            signs = [_sign(self.taylor(event, x, bits, k + 1)[k]) for _, x in marks]
            found = [mark for mark, sign in zip(marks[1:-1], signs[1:-1], strict=True) if not sign]
            for (_, a), (_, b), one, other in zip(marks, marks[1:], signs, signs[1:], strict=False):
                if one * other < 0:
                    found.append((k, self._between(event, k, a, b, one, bits)))
            for mark, sign in ((marks[0], signs[0]), (marks[-1], signs[-1])):
                if not sign:
                    found.append(mark)
            zeros = sorted(found, key=lambda item: float(item[1].mid()))
        return zeros

    def _centred(self, event: tuple[int, int, int], part: Ball, bits: int) -> list[Ball]:
        """Return the derivatives over a ball by those at its middle: nothing cancels there twice.

        Taylor's polynomial, its last term with the derivative over the whole ball.
        """
        from flint import arb

        n = 2 * ORDERS
        middle = self.taylor(event, arb(part.mid()), bits, n)
        last = self.taylor(event, part, bits, n + 1)[n]
        step, found = arb(0, part.rad()), []
        for k in range(ORDERS):
            value = last * math.comb(n, k)
            for j in reversed(range(k, n)):
                value = value * step + middle[j] * math.comb(j, k)
            found.append(value)
        return found

    def _between(
        self, event: tuple[int, int, int], k: int, a: Ball, b: Ball, sign: int, bits: int
    ) -> Ball:
        """Return the zero of a monotone derivative between two places of opposite sign."""
        from flint import arb

        low, high = arb(a.upper()), arb(b.lower())
        if low > high:
            low, high = arb(a.mid()), arb(b.mid())
        for _ in range(4 * bits):
            box = low.union(high)
            slope = (k + 1) * self.taylor(event, box, bits, k + 2)[k + 1]
            middle = arb(box.mid())
            value = self.taylor(event, middle, bits, k + 1)[k]
            if _sign(slope):
                new = (
                    (middle - value / slope).intersection(box)
                    if ((middle - value / slope).overlaps(box))
                    else middle
                )
                if arb(new.rad()) * 2 < arb(box.rad()):
                    low, high = arb(new.lower()), arb(new.upper())
                    continue
                if _sign(value) == 0:
                    return new
            here = _sign(value)
            if not here:  # the zero itself, perhaps: look on both sides of it
                off = arb(box.rad()) / 2
                left, right = arb((middle - off).mid()), arb((middle + off).mid())
                begins = _sign(self.taylor(event, left, bits, k + 1)[k]) == sign
                ends = _sign(self.taylor(event, right, bits, k + 1)[k]) == -sign
                if not (begins or ends):
                    return box
                low, high = left if begins else low, right if ends else high
                continue
            low, high = (middle, high) if here == sign else (low, middle)
            if arb(high - low) < arb(2) ** (8 - bits):
                return low.union(high)
        return low.union(high)

    def refined(self, zero: Zero, bits: int) -> Ball:
        """Return a zero to nearly this many bits."""
        from flint import arb

        if zero.event is None:
            with precision(bits):
                return zero.ball() if callable(zero.ball) else arb(zero.ball)
        key = (id(zero), bits)
        if key not in self._zeros:
            known = (self._zeros.get((id(zero), fewer)) for fewer in reversed(LEVELS))
            start = next((found[1] for found in known if found is not None), zero.ball)
            self._zeros[key] = [zero, self._newton(zero, start, bits)]
        return self._zeros[key][1]

    def _newton(self, zero: Zero, start: Ball, bits: int) -> Ball:
        """Return the zero in a ball about it, to nearly so many bits."""
        from flint import arb

        event, k = zero.event, zero.order
        assert event is not None
        with precision(bits + 32):
            box = arb(start)
            least = arb(2) ** -bits * self.plane.base_unit
            for _ in range(200):
                if arb(box.rad()) < least:
                    break
                slope = (k + 1) * self.taylor(event, box, bits + 32, k + 2)[k + 1]
                if not _sign(slope):
                    break
                middle = arb(box.mid())
                step = middle - self.taylor(event, middle, bits + 32, k + 1)[k] / slope
                if not step.overlaps(box):
                    break
                new = step.intersection(box)
                if not arb(new.rad()) * 2 < arb(box.rad()):
                    return new
                box = new
            return box

    # --- roots along the lift -------------------------------------------------------------------

    def root(self, row: int, branch: int, t: Ball, bits: int, side: int = 0) -> Ball | None:
        """Return a root along the lift over a base value, as `Plane.follow` does.

        Parameters
        ----------
        side : int
            -1 or +1: where the row vanishes on the whole fibre the limit from that side is meant.

        Returns
        -------
        arb or None
            None where not even its direction can be told.
        """
        if row < 0:
            return self.ends("lift")[int(row == HIGHEST.form)]
        c = self.along_lift(row, t, bits)
        if side and all(x.contains(0) for x in c):
            series = self.series(row, t, bits)
            for k in range(1, ORDERS):
                c = [x[k] * side**k for x in series]
                if not all(x.contains(0) for x in c):
                    break
        if self.plane.lift_kind == "revolute":
            return self._on_circle(c, branch)
        return self._on_line(c, branch)

    def _on_circle(self, c: Sequence[Ball], branch: int) -> Ball | None:
        from flint import arb

        c0, c1, c2 = c
        square = c1 * c1 + c2 * c2
        if not square > 0:
            return None
        rest = square - c0 * c0
        height = arb(0) if rest < 0 else rest.nonnegative_part().sqrt()
        if rest.contains(0):
            height = _around_root(rest)
        # Beside the negative axis the angle is taken from the other one, which has no cut there.
        theta = arb.atan2(c2, c1) if not c1 < 0 else arb.atan2(-c2, -c1) + _half_turn(c2)
        alpha = arb.atan2(height, -c0) if not c0 > 0 else arb.pi() - arb.atan2(height, c0)
        return theta + branch * alpha

    def _on_line(self, c: Sequence[Ball], branch: int) -> Ball | None:
        c0, c1, c2 = c
        if c2.is_zero():
            return None if c1.contains(0) else -c0 / c1
        if c2.contains(0):
            return None if c1.contains(0) else self._near_line(c0, c1, c2, branch)
        rest = c1 * c1 - 4 * c0 * c2
        root = _around_root(rest) if rest.contains(0) else rest.nonnegative_part().sqrt()
        sign = branch if c2 > 0 else -branch
        return (-c1 + sign * root) / (2 * c2)

    def _near_line(self, c0: Ball, c1: Ball, c2: Ball, branch: int) -> Ball | None:
        """Return the root that stays finite of a quadratic that may be affine."""
        rest = (c1 * c1 - 4 * c0 * c2).nonnegative_part().sqrt()
        half = c1 + (rest if c1 > 0 else -rest)
        return -2 * c0 / half

    def real(self, row: int, t: Any) -> int:
        """Return the sign of the discriminant along the lift: 1 for two roots, 0 for a double."""
        for bits in LEVELS:
            with precision(bits):
                c = self.along_lift(row, _at(t, bits), bits)
                if self.plane.lift_kind == "revolute":
                    rest = c[1] * c[1] + c[2] * c[2] - c[0] * c[0]
                else:
                    rest = c[1] * c[1] - 4 * c[0] * c[2]
                if _sign(rest):
                    return _sign(rest)
        return 0


_NOTHING = (0, 0, 0)


def _combined(lines: Sequence[Sequence[Any]], one: Any, other: Any) -> list[Any]:
    """Return the sums of three lines, with factors 1, `one` and `other`; most numbers are zero."""
    found = []
    for a, b, c in zip(*lines, strict=True):
        value = a if b.is_zero() else a + b * one
        found.append(value if c.is_zero() else value + c * other)
    return found


def _factors(kind: str, t: Any) -> tuple[Any, Any]:
    if kind == "revolute":
        sine, cosine = t.sin_cos()
        return cosine, sine
    return t, t * t


def _at(x: Any, bits: int) -> Ball:
    """Return a number, or a function of the number of bits, as a ball."""
    from flint import arb

    return x(bits) if callable(x) else arb(x)


def _sign(x: Ball) -> int:
    return 1 if x > 0 else -1 if x < 0 else 0


def _half_turn(c2: Ball) -> Ball:
    """Return half a turn, to the side that leaves an angle between minus and plus half a turn."""
    from flint import arb

    return -arb.pi() if c2 < 0 else arb.pi()


def _around_root(rest: Ball) -> Ball:
    """Return the square root of a ball that holds zero: from 0 to that of its upper end."""
    from flint import arb

    top = arb(rest.upper()).nonnegative_part().sqrt()
    return arb(0).union(top)


def _apart(zeros: list[Zero]) -> list[Zero]:
    """Return zeros ascending, one for those that overlap, as at the ends of halves."""
    kept: list[Zero] = []
    for zero in sorted(zeros, key=lambda item: float(item.ball.mid())):
        if kept and kept[-1].ball.overlaps(zero.ball):
            if zero.order < kept[-1].order:
                kept[-1] = zero
            continue
        kept.append(zero)
    return kept


def in_order(
    items: Sequence[Any], ball_of: Callable[[Any, int], Ball], names: Sequence[Any] | None = None
) -> list[tuple[Ball, list[Any]]]:
    """Put items in the order of their numbers; those that 1,024 bits do not part are together.

    Parameters
    ----------
    ball_of : callable
        Of an item and the number of bits.
    names : sequence, optional
        Items with one name have one number, and need not be told apart.

    Returns
    -------
    list of (arb, list)
        Ascending: a ball, and the items whose number it holds.
    """
    names = range(len(items)) if names is None else names
    groups: list[tuple[Ball, list[int]]] = []
    for bits in LEVELS:
        with precision(bits):
            known: dict[Any, Ball] = {}
            for item, name in zip(items, names, strict=True):
                if name not in known:
                    known[name] = ball_of(item, bits)
            order = sorted(range(len(items)), key=lambda k: _Exactly(known[names[k]].mid()))
            groups, vague = [], False
            for k in order:
                ball = known[names[k]]
                if groups and groups[-1][0].overlaps(ball):
                    vague |= any(names[j] != names[k] for j in groups[-1][1])
                    groups[-1] = groups[-1][0].union(ball), [*groups[-1][1], k]
                else:
                    groups.append((ball, [k]))
        if not vague:
            break
    return [(ball, [items[k] for k in own]) for ball, own in groups]


class _Exactly:
    """A key of exact numbers for sorting."""

    def __init__(self, value: Ball) -> None:
        self.value = value

    def __lt__(self, other: _Exactly) -> bool:
        return bool(self.value < other.value)


def midpoint(a: Ball, b: Ball) -> Ball:
    """Return an exact number between two balls."""
    from flint import arb

    return arb(((a + b) / 2).mid())


def to_float(x: Ball) -> float:
    """Return the double nearest to the middle of a ball."""
    return float(x.mid())
