"""Base values at which something happens to forms along the lift: the zeros of events.

Every kind of event (`precise.KINDS`) is one polynomial of the base: of z = exp(i t) on a circle, of
t itself on a line. They are solved in stacks, in doubles, each zero with a bound of its error.
Where two of them are nearer than their errors, the order is decided in balls (`Lines`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any

import numpy as np

from qbound.arrays import Bools, Complexes, Floats, Ints
from qbound.forms.angles import TURN, turns_within
from qbound.forms.factors import FACTORS, Kind, basis
from qbound.region.plane import Plane, which
from qbound.region.polynomials import polynomial_roots
from qbound.region.precise import (
    KINDS,
    LEVELS,
    NAMES,
    NUMBER,
    Precise,
    UndecidedError,
    Zero,
    in_order,
    to_float,
)
from qbound.tolerances import UNIT

BLOCK = 2**14
"""Polynomials that are solved at once: fast enough, small enough for any memory."""

FEW = 2**9
"""Polynomials of a kind up to which they are solved with others: one call costs more than they."""


def univariate(plane: Plane, tables: Floats) -> Complexes:
    """Turn scaled (m, 3, 3) coefficients into polynomials of the base, (m, 3 of the lift, 3).

    Ascending powers. Revolute: of z = exp(i q), times z. Prismatic: of q itself.
    """
    return np.asarray(tables.swapaxes(1, 2) @ _by_power(plane.base_kind))


@cache
def _by_power(kind: Kind) -> Complexes:
    """Return the matrix that turns a joint's three coefficients into those of ascending powers."""
    factor = FACTORS[kind]
    return np.asarray(factor.waves[np.argsort(factor.turns + factor.powers)].T, dtype=complex)


# --- events ---------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Events:
    """Base values at which something may happen, one a row.

    Attributes
    ----------
    what : ndarray of int, shape (n, 3)
        Kind of the event, and its one or two rows, as `Precise` numbers them.
    t, radius : ndarray, shape (n,)
        Base value, and a bound of its error.
    crowded : ndarray of bool, shape (n,)
        Whether the same event may have another zero so near.
    key : ndarray of int, shape (n,)
        Events with one key that are as near as their errors are one; -1 for none.
    exact : ndarray of int, shape (n,)
        Which zero in balls it is, in `Finder.zeros`; -1 for none.
    """

    what: Ints
    t: Floats
    radius: Floats
    crowded: Bools
    key: Ints
    exact: Ints

    def __len__(self) -> int:
        """Return their number."""
        return len(self.t)

    def __getitem__(self, rows: Any) -> Events:
        """Return some of them."""
        return Events(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))

    @classmethod
    def joined(cls, parts: Sequence[Events]) -> Events:
        """Return all events of several lists."""
        return cls(
            *(
                np.concatenate([getattr(part, name) for part in parts])
                for name in cls.__dataclass_fields__
            )
        )


NO_EVENTS = Events(
    np.zeros((0, 3), dtype=np.int64),
    np.zeros(0),
    np.zeros(0),
    np.zeros(0, dtype=np.bool_),
    np.zeros(0, dtype=np.int64),
    np.zeros(0, dtype=np.int64),
)


@dataclass(eq=False)
class _Request:
    """Polynomials of one kind: their rows, coefficients and errors."""

    kind: str
    i: Ints
    j: Ints
    stack: Complexes
    errors: Floats

    def __getitem__(self, rows: Any) -> _Request:
        return _Request(self.kind, self.i[rows], self.j[rows], self.stack[rows], self.errors[rows])

    @property
    def blank(self) -> Bools:
        """Whether all coefficients are zero within their errors."""
        return np.asarray((np.abs(self.stack) <= self.errors[:, None]).all(axis=1))


class Finder:
    """Finds the zeros of events of one plane.

    Parameters
    ----------
    plane : Plane
    precise : Precise
        Decides what doubles cannot.
    """

    def __init__(self, plane: Plane, precise: Precise) -> None:
        self.plane, self.precise = plane, precise
        self.zeros: list[Zero] = []
        self._c = univariate(plane, plane.scaled)
        self._size: Floats = np.abs(self._c).sum(axis=2).T
        self._circle = plane.lift_kind == "revolute"

    # --- polynomials ----------------------------------------------------------------------------

    def _rows(self, rows: Ints) -> tuple[Complexes, Floats, Floats]:
        """Return polynomials along the lift, their sizes and errors, of forms or of sides."""
        plane, first_side = self.plane, len(self._c)
        if not (rows >= first_side).any():
            return self._c[rows], self._size[:, rows], plane.eps[rows]
        sides, at = plane.sides.reshape(-1, 3, 3), rows - first_side
        c = univariate(plane, sides[at])
        return c, np.abs(c).sum(axis=2).T, plane.side_eps.reshape(-1)[at]

    def own(self, rows: Ints) -> list[_Request]:
        """Return where roots of forms appear, jump, or pass an end of the lift's range."""
        kinds = ("fold circle", "second") if self._circle else ("fold line", "first", "second")
        found = [self._request(kind, rows, rows) for kind in kinds]
        if self.plane.lift_range is not None:
            found += [self._request(kind, rows, rows) for kind in ("lower end", "upper end")]
        return found

    def fixed(self, rows: Ints) -> list[_Request]:
        """Return where forms without the lift vanish."""
        return [self._request("constant", rows, rows)]

    def quick(self, i: Ints, j: Ints) -> tuple[Ints, Floats]:
        """Return about where paired rows may share a root: the pair's number, and base value."""
        if self._circle:
            requests = [self._request("resultant circle", i, j)]
        else:
            one, other = (np.abs(self._c[rows][:, 2]).max(axis=-1) > 0 for rows in (i, j))
            chosen = {
                "sine": ~one & ~other,
                "resultant line": one & other,
                "under": one & ~other,
                "over": ~one & other,
            }
            requests = [self._request(kind, i[k], j[k]) for kind, k in chosen.items()]
        found = [NO_EVENTS]
        for what, stack, errors in _blocks(requests):
            rows = which((np.abs(stack) > errors[:, None]).any(axis=1))
            found.append(self._of(what[rows], stack[rows], errors[rows]))
        events = Events.joined(found)
        return events.what[:, 1], events.t

    def of_kind(self, kind: str, rows: Ints) -> _Request:
        """Return one kind of event of some rows."""
        return self._request(kind, rows, rows)

    def _request(self, kind: str, i: Ints, j: Ints) -> _Request:
        (a, size_a, eps_a), event = self._rows(i), KINDS[kind]
        a = np.moveaxis(a, 1, 0)
        b: Any = None
        size_b = eps_b = np.zeros((3, len(i)))
        if kind in ("lower end", "upper end"):
            end = self.plane.lift_ends[kind == "upper end"] / self.plane.lift_unit
            b = basis(self.plane.lift_kind, np.asarray(end))
            stack = event.formula(a, b, lambda x, y: x * y)
        else:
            if event.degrees[1]:
                b, size_b, eps_b = self._rows(j)
                b = np.moveaxis(b, 1, 0)
            stack = event.formula(a, b, _times)
        one, other = event.degrees
        doubt = one * eps_a + (other * eps_b if other else 0.0) + 8 * UNIT
        errors = event.size(size_a, size_b) * doubt
        return _Request(kind, i, j, np.asarray(stack), errors)

    def meetings(self, i: Ints, j: Ints) -> list[_Request]:
        """Return where paired rows may share a root along the lift."""
        return self._on_circle(i, j) if self._circle else self._on_line(i, j)

    def _on_circle(self, i: Ints, j: Ints) -> list[_Request]:
        """Resultant of two equations linear in (cos, sin), on the unit circle (Cramer's rule).

        Where the two are parallel for every base value, as for two points on one ray of a link, it
        is the sum of two squares with only double roots; their common roots are then those of each
        term. Where both have no constant part it is the square of the determinant. Two forms that
        share one root for every base value share the other where they are parallel.
        """
        crossed = {kind: self._request(kind, i, j) for kind in ("determinant", "cosine", "sine")}
        resultant = self._request("resultant circle", i, j)
        none = {kind: self._none(found) for kind, found in crossed.items()}
        parallel, plain = none["determinant"], none["cosine"] & none["sine"]
        sharing = self._none(resultant) & ~parallel
        apart = ~parallel & ~plain & ~sharing
        return [
            resultant[apart],
            crossed["cosine"][parallel & ~none["cosine"]],
            crossed["sine"][parallel & ~none["sine"]],
            crossed["determinant"][(sharing | plain) & ~parallel],
        ]

    def _on_line(self, i: Ints, j: Ints) -> list[_Request]:
        """Resultants of polynomials of degree 2 or less at their actual degrees.

        The formal resultant of two affine forms is identically zero, so each pair is taken at its
        own. Two quadratics that share one root for every base value share the other where their
        sums of roots agree; a quadratic of which an affine form has one root, where that form's
        coefficient of the lift vanishes.
        """
        one, other = (np.abs(self._rows(rows)[0][:, 2]).max(axis=-1) > 0 for rows in (i, j))
        affine, both = ~one & ~other, one & other
        resultant = self._request("resultant line", i[both], j[both])
        under = self._request("under", i[one & ~other], j[one & ~other])
        over = self._request("over", i[~one & other], j[~one & other])
        shared, below, above = (self._none(found) for found in (resultant, under, over))
        again = self._request("determinant", i[both][shared], j[both][shared])
        return [
            self._request("sine", i[affine], j[affine]),
            resultant[~shared],
            under[~below],
            over[~above],
            again,
            self._request("first", j[one & ~other][below], j[one & ~other][below]),
            self._request("first", i[~one & other][above], i[~one & other][above]),
        ]

    def _none(self, found: _Request) -> Bools:
        """Tell which polynomials are zero everywhere: doubles propose it, balls decide it."""
        none = found.blank
        for k in which(none & (found.errors > 0)).tolist():
            event = NUMBER[found.kind], int(found.i[k]), int(found.j[k])
            none[k] = self.precise.vanishes(event)
        return none

    # --- zeros ----------------------------------------------------------------------------------

    def events(self, requests: Sequence[_Request]) -> Events:
        """Return the zeros of polynomials within the base's range, or a little beside it."""
        found = [NO_EVENTS]
        for what, stack, errors in _blocks(requests):
            blank = (np.abs(stack) <= errors[:, None]).all(axis=1)
            # Without any term nothing cancels, and it is zero everywhere; else balls are asked.
            doubtful = which(blank & (errors > 0))
            found += [self._all_of(tuple(what[k].tolist())) for k in doubtful.tolist()]
            rows = which(~blank)
            found.append(self._of(what[rows], stack[rows], errors[rows]))
        return Events.joined(found)

    def _of(self, what: Ints, stack: Complexes, errors: Floats) -> Events:
        if not len(what):
            return NO_EVENTS
        plane, circle = self.plane, self.plane.base_kind == "revolute"
        roots = polynomial_roots(stack, errors, circle=circle)
        low, high = plane.ends
        if circle:
            t = np.angle(roots.z)
            radius = 2 * roots.radius + 8 * UNIT
            slack = 1e-6 if plane.base_range is not None else 0.0
            turns = np.array(turns_within(low - slack, high + slack, [-math.pi, math.pi]))
            k, t = np.arange(len(t)).repeat(len(turns)), (t[:, None] + TURN * turns).ravel()
        else:
            t, k = plane.base_unit * roots.z.real, np.arange(len(roots.z))
            radius = plane.base_unit * (2 * roots.radius + 8 * UNIT)
        radius = radius[k]
        inside = (t >= low - radius) & (t <= high + radius)
        k, t, radius = k[inside], t[inside], radius[inside]
        none = np.full(len(k), -1)
        return Events(what[roots.row[k]], t, radius, roots.crowded[k], none, none.copy())

    def _all_of(self, event: tuple[int, int, int]) -> Events:
        """Return all zeros of an event whose doubles say nothing, in balls."""
        if self.precise.vanishes(event):
            return NO_EVENTS
        low, high = self.plane.ends
        zeros = self.precise.zeros(event, low, high, LEVELS[-1])
        if zeros is None:
            raise UndecidedError(f"the zeros of {NAMES[event[0]]} of rows {event[1:]}")
        return self.exact(zeros)

    def exact(self, zeros: Sequence[Zero], key: int = -1) -> Events:
        """Return zeros that are known in balls as events."""
        n = len(zeros)
        first = len(self.zeros)
        self.zeros += zeros
        t = np.array([to_float(zero.ball) for zero in zeros], dtype=float)
        radius = np.array([float(zero.ball.rad()) for zero in zeros], dtype=float)
        return Events(
            np.array([zero.event for zero in zeros], dtype=np.int64).reshape(-1, 3),
            t,
            radius * 1.01 + 2 * UNIT * np.abs(t),
            np.zeros(n, dtype=np.bool_),
            np.full(n, key),
            first + np.arange(n),
        )

    def isolated(self, events: Events, of: Ints | None = None) -> tuple[Ints, Events]:
        """Return the same events, those that are crowded as what they are in balls.

        And for each its number in `of`, by default none.
        """
        of = np.zeros(len(events), dtype=np.int64) if of is None else of
        crowded = which(events.crowded)
        if not len(crowded):
            return of, events
        order = np.lexsort([events.t[crowded], *events.what[crowded].T, of[crowded]])
        crowded = crowded[order]
        what = np.concatenate([events.what[crowded], of[crowded, None]], axis=1)
        low, high = (events.t + sign * events.radius for sign in (-1, 1))
        alone = which(~events.crowded)
        found, owner = [events[alone]], [of[alone]]
        known: dict[Any, Events] = {}
        group: list[int] = []
        for place, k in enumerate(crowded.tolist()):
            group.append(k)
            following = crowded[place + 1] if place + 1 < len(crowded) else None
            same = following is not None and (what[place + 1] == what[place]).all()
            if same and low[following] <= max(high[i] for i in group):
                continue
            name = *what[place, :3].tolist(), float(low[group].min()), float(high[group].max())
            if name not in known:
                zeros = self._settled(events[group[0]], *name[3:])
                known[name] = self.exact(zeros, int(events.key[group[0]]))
            found.append(known[name])
            owner.append(np.full(len(known[name]), of[group[0]]))
            group = []
        return np.concatenate(owner), Events.joined(found)

    def _settled(self, event: Events, low: float, high: float) -> list[Zero]:
        """Return the zeros of an event within an interval, in balls."""
        what: Any = tuple(event.what.tolist())
        for bits in LEVELS:
            zeros = self.precise.zeros(what, low, high, bits)
            if zeros is not None and (bits == LEVELS[-1] or all(z.order == 0 for z in zeros)):
                return zeros
        if self.precise.vanishes(what):
            return []
        raise UndecidedError(f"{NAMES[what[0]]} of rows {what[1:]} near base value {low:.17g}")

    def zero(self, events: Events, k: int) -> Zero | None:
        """Return an event as a zero in balls; None where there is none."""
        if events.exact[k] >= 0:
            return self.zeros[int(events.exact[k])]
        t, radius = float(events.t[k]), float(events.radius[k])
        for wider in (1, 16, 256):
            found = self._settled(events[k], t - wider * radius, t + wider * radius)
            if found:
                near: Zero = min(found, key=lambda zero: abs(to_float(zero.ball) - t))
                return near
        return None


def _times(p: Complexes, q: Complexes) -> Complexes:
    """Multiply stacked polynomials, coefficients on the last axis."""
    m, n = p.shape[-1], q.shape[-1]
    if p.size > FEW:
        product = np.zeros((*p.shape[:-1], m + n - 1), dtype=complex)
        for k in range(m):
            product[..., k : k + n] += p[..., k : k + 1] * q
        return product
    products = (p[..., :, None] * q[..., None, :]).reshape(*p.shape[:-1], m * n)
    return np.asarray(products @ _degrees(m, n))


@cache
def _degrees(m: int, n: int) -> Complexes:
    """Return the matrix that adds up products of coefficients, (m n, m + n - 1), by degree."""
    degree = np.arange(m)[:, None] + np.arange(n)
    return np.asarray(degree.reshape(-1, 1) == np.arange(m + n - 1), dtype=complex)


def _blocks(requests: Sequence[_Request]) -> Any:
    """Yield the same polynomials, few of them together and padded to one length, many in parts."""
    few = [r for r in requests if 0 < len(r.i) <= FEW]
    for request in requests:
        if len(request.i) > FEW:
            what = _what(request)
            for k in range(0, len(what), BLOCK):
                part = slice(k, k + BLOCK)
                yield what[part], request.stack[part], request.errors[part]
    if few:
        longest = max(r.stack.shape[1] for r in few)
        padded = np.zeros((sum(len(r.i) for r in few), longest), dtype=complex)
        at = 0
        for r in few:
            padded[at : at + len(r.i), : r.stack.shape[1]] = r.stack
            at += len(r.i)
        yield (
            np.concatenate([_what(r) for r in few]),
            padded,
            np.concatenate([r.errors for r in few]),
        )


def _what(request: _Request) -> Ints:
    return np.stack([np.full(len(request.i), NUMBER[request.kind]), request.i, request.j], axis=1)


# --- lines ----------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Lines:
    """Critical base values, ascending, both ends of the range first and last.

    Attributes
    ----------
    t, radius : ndarray, shape (n,)
        Base value, and a bound of its error.
    of : ndarray of int, shape (events,)
        The line of each event; -1 for one that is none, or is outside the range.
    events : Events
    members : list of list of int
        The events of each line.
    """

    finder: Finder
    t: Floats
    radius: Floats
    of: Ints
    events: Events
    members: list[list[int]]
    known: dict[int, Zero] = field(default_factory=dict)

    def ball(self, line: int, bits: int) -> Any:
        """Return a line's base value to nearly so many bits."""
        from flint import arb

        precise = self.finder.precise
        if line not in self.known:
            last = len(self.t) - 1
            found = None
            if line in (0, last):
                found = Zero(None, 0, lambda: precise.ends("base")[int(line == last)])
            else:
                members = self.members[line]
                best = sorted(
                    members, key=lambda k: (self.events.exact[k] < 0, self.events.radius[k])
                )
                for k in best:
                    found = self.finder.zero(self.events, k)
                    if found is not None:
                        break
            if found is None:  # no event after all: any place between its neighbours serves
                value = float(self.t[line])
                found = Zero(None, 0, lambda: arb(value))
            self.known[line] = found
        return precise.refined(self.known[line], bits)

    def only(self, kept: Bools) -> Lines:
        """Return some of the lines."""
        number = np.where(kept, kept.cumsum() - 1, -1)
        of = np.where(self.of >= 0, number[self.of], -1)
        members = [own for own, k in zip(self.members, kept.tolist(), strict=True) if k]
        known = {int(number[k]): zero for k, zero in self.known.items() if kept[k]}
        return replace(
            self, t=self.t[kept], radius=self.radius[kept], of=of, members=members, known=known
        )


def find_lines(finder: Finder, events: Events) -> Lines:
    """Put events in order; those that are one, or cannot be told apart, become one line."""
    low, high = finder.plane.ends
    wrapped, n = finder.plane.base_range is None, len(events)
    # The ends of the range are lines, too: the numbers after those of the events.
    t = np.append(events.t, [low, high])
    radius = np.append(events.radius, np.full(2, 4 * UNIT * max(abs(low), abs(high))))
    if wrapped:  # an event at the cut is one, on either side of it
        t[:n] = _about_cut(t[:n], radius[:n], low, high)
    found: list[_Line] = []
    for rows in _clusters(t, radius):
        if len(rows) == 1 or _is_one(events, rows, n):
            best = min(rows, key=lambda k: radius[k])
            found.append(_Line(float(t[best]), float(radius[best]), rows))
        else:
            found += _resolved(finder, events, t, rows, n)
    first, last = (next(k for k, one in enumerate(found) if n + end in one.rows) for end in (0, 1))
    chosen = found[first : last + 1]
    if wrapped:  # what lies below the cut lies a turn on
        turned = [one.turned(finder.precise) for one in found[:first]]
        chosen = [*found[first:last], *turned, found[last]]
    members = [[k for k in one.rows if k < n] for one in chosen]
    if wrapped:
        members[-1] = members[0]
    of = np.full(n, -1)
    for k, own in reversed(list(enumerate(members))):
        of[own] = k
    values = np.array([one.t for one in chosen])
    values[0], values[-1] = low, high
    known = {k: one.zero for k, one in enumerate(chosen[1:-1], start=1) if one.zero is not None}
    radii = np.array([one.radius for one in chosen])
    return Lines(finder, np.maximum.accumulate(values), radii, of, events, members, known)


@dataclass(frozen=True, eq=False)
class _Line:
    """A base value, a bound of its error, the events there, and what it is in balls if known."""

    t: float
    radius: float
    rows: list[int]
    zero: Zero | None = None

    def turned(self, precise: Precise) -> _Line:
        """Return the line a turn later."""
        zero = None if self.zero is None else shifted(precise, self.zero, 1)
        return replace(self, t=self.t + TURN, zero=zero)


def _about_cut(t: Floats, radius: Floats, low: float, high: float) -> Floats:
    """Bring events of a circle into its range; those that may be one with its cut to the low end.

    And so those that may be one with these, though they do not reach the cut themselves.
    """
    t = np.where(t + radius < low, t + TURN, t)
    reach = high
    while (beyond := t + radius >= reach).any():
        t = np.where(beyond, t - TURN, t)
        reach = float((t - radius)[beyond].min()) + TURN
    return t


def _clusters(t: Floats, radius: Floats) -> list[list[int]]:
    """Return base values that may be one, as far as their errors tell, together; ascending."""
    order = np.argsort(t, kind="stable")
    reach = np.maximum.accumulate((t + radius)[order])
    least = np.minimum.accumulate((t - radius)[order][::-1])[::-1]
    cuts = which(least[1:] > reach[:-1]) + 1
    return [rows.tolist() for rows in np.split(order, cuts)]


def shifted(precise: Precise, zero: Zero, turns: int) -> Zero:
    """Return a zero of a circle's base some turns later."""
    from flint import arb, ctx

    return Zero(None, 0, lambda: precise.refined(zero, ctx.prec) + 2 * turns * arb.pi())


def _is_one(events: Events, rows: Sequence[int], n: int) -> bool:
    """Tell whether events are one because they have one key, each event once."""
    if any(k >= n for k in rows):
        return False
    key = events.key[rows[0]]
    if key < 0 or (events.key[rows] != key).any():
        return False
    places = {
        (*what, t)
        for what, t in zip(events.what[rows].tolist(), events.t[rows].tolist(), strict=True)
    }
    return len({place[:3] for place in places}) == len(places)


def _resolved(
    finder: Finder, events: Events, t: Floats, rows: Sequence[int], n: int
) -> list[_Line]:
    """Return the different base values of a cluster, ascending."""
    precise = finder.precise
    owners: list[tuple[list[int], Zero]] = []
    # One of several events that are one because of their key stands for all.
    groups: dict[Any, list[int]] = {}
    for k in rows:
        if k >= n:
            name: Any = ("end", k)
        elif events.exact[k] >= 0:
            name = ("exact", int(events.exact[k]))
        else:
            name = ("key", int(events.key[k])) if events.key[k] >= 0 else ("event", k)
        groups.setdefault(name, []).append(k)
    for name, own in groups.items():
        if name[0] == "key" and not _is_one(events, own, n):
            for k in own:
                owners += _owned(finder, events, t, [k])
        elif name[0] == "end":
            upper = own[0] - n
            owners.append((own, Zero(None, 0, partial(_end_of, precise, upper))))
        else:
            owners += _owned(finder, events, t, own)
    found = []
    for ball, members in in_order(owners, lambda item, bits: precise.refined(item[1], bits)):
        value = to_float(ball)
        error = float(ball.rad()) * 1.01 + 2 * UNIT * abs(value)
        every = [k for own, _ in members for k in own]
        found.append(_Line(value, error, every, members[0][1]))
    return found


def _end_of(precise: Precise, upper: int) -> Any:
    return precise.ends("base")[upper]


def _owned(
    finder: Finder, events: Events, t: Floats, own: list[int]
) -> list[tuple[list[int], Zero]]:
    best = min(own, key=lambda k: (events.exact[k] < 0, events.radius[k]))
    zero = finder.zero(events, best)
    if zero is None:
        return []
    turns = round(float(t[best] - events.t[best]) / TURN)
    if turns:
        zero = shifted(finder.precise, zero, turns)
    return [(own, zero)]
