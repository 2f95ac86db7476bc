"""A scene: forms of two joints over a base, and pairs of bodies with the clauses that part them.

Everything that may bound a region is a *feature*: a curve (the zeros of a form) with side
conditions that are not negative where the feature is a contact. A boundary with one form is a
feature without side conditions. A pair of convex parts is free where, in one of its clauses, all
forms are positive.

A slide is measured in a power of two at which its values are at most 1: nothing is rounded, and
tolerances are relative. A joint that turns all the way round is cut open at a place without
symmetry: lines, segments and cells lie in an interval, and `components` glues its ends.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from math import atan, frexp
from typing import Any

import numpy as np

from cspace.arrays import Bools, Floats, Ints
from cspace.boundary.contacts import FAR_APART, SIDES
from cspace.forms.bending import extremes
from cspace.region.algebra import basis, blur, fold
from cspace.region.problem import Problem
from cspace.region.rows import ExactRows
from cspace.tolerances import UNIT
from qbound.circle import TURN

CANCELS = 1e-11
"""Coefficients with larger errors, of terms that cancel, are taken from the exact ones."""

ONCE = 4 * UNIT
"""Bound of the error of coefficients that are rounded once."""

AT_END = 1e-6
"""A root so much below a turn, of a curve with a root at the lift's end, is that root."""

CUT_OPEN = -31.73, -29.37
"""tan of half the angle at which a base, and a lift, is cut open."""


@dataclass(frozen=True, eq=False)
class Clauses:
    """The clauses of a pair of convex parts: it is apart where all forms of one are positive.

    Attributes
    ----------
    forms : ndarray, shape (k, 9)
        The features' forms, then the side conditions of two corners.
    doubt : ndarray, shape (k,)
        A value no farther from zero than this has no sign.
    order, starts : ndarray of int
        Rows of `forms`, clause by clause, and where each clause begins.
    rows : list of (int, int or None)
        Feature and number of the side condition of each row; None for the form itself.
    """

    forms: Floats
    doubt: Floats
    order: Ints
    starts: Ints
    rows: list[tuple[int, int | None]]

    def apart(self, products: Floats) -> tuple[Bools, Bools]:
        """Tell from the nine products (n, 9) of places: surely apart, and maybe apart."""
        values = products @ self.forms.T

        def some_clause(holds: Bools) -> Bools:
            all_of = np.logical_and.reduceat(holds[:, self.order], self.starts, axis=1)
            return np.asarray(np.asarray(all_of).any(axis=1))

        return some_clause(values > self.doubt), some_clause(values > -self.doubt)


@dataclass(frozen=True, eq=False)
class Scene:
    """Curves over a base and the features on them; tables are (..., 3, 3), base before lift.

    Attributes
    ----------
    base : int
        Which free joint is the base.
    turns, round : pair of bool
        Whether base and lift turn, and whether they turn all the way round.
    ends : pair of (low, high)
        Of base and lift, in units of `scale`.
    scale : pair of float
        Powers of two: joint values in one unit here.
    table : ndarray, shape (m, 3, 3)
        The forms of the curves, largest coefficient 1. The first `count` are forms that are
        positive everywhere in the region: boundaries with one form, and heights of corners.
    eps : ndarray, shape (m,)
        Bounds of the errors of their coefficients.
    curve : ndarray of int, shape (f,)
        The curve of each feature. The first `count` features are those of the first forms.
    sides, side_eps : ndarray, shapes (f, 4, 3, 3) and (f, 4)
        Side conditions; the constant 1 stands for a missing one.
    keys : ndarray of int, shape (f, 4)
        Events at which sides vanish on the curve, by name: equal ones at one place are one event.
    tangent : ndarray of int, shape (f, 2)
        Corners at the ends of an edge's line: circles about these corners touch it, without
        crossing.
    corners, live : ndarray of bool, shape (f,)
        Whether the feature is of two corners; whether it can be a contact.
    pair : ndarray of int, shape (f,)
        The pair of parts; negative for a form of its own.
    discs, disc_doubt : ndarray, shapes (pairs, 9) and (pairs,)
        A form for each pair, positive where discs about both parts are apart.
    base_only, idle : ndarray of bool, shape (pairs,)
        Whether a pair does not depend on the lift; whether it may touch anywhere, and is no wall.
    labels : list of (str, str)
        Boundary and feature of each feature.
    double, ending : ndarray of bool, shape (m,)
        Curves whose two roots are one over every base value; of which one is an end of the lift.
    gone : ndarray of bool, shape (m,)
        Curves whose form vanishes on the whole fibre over some base value.
    source : Source
        Exact tables, and clauses of pairs.
    """

    base: int
    turns: tuple[bool, bool]
    round: tuple[bool, bool]
    ends: tuple[tuple[float, float], tuple[float, float]]
    scale: tuple[float, float]
    table: Floats
    eps: Floats
    count: int
    curve: Ints
    sides: Floats
    side_eps: Floats
    keys: Ints
    tangent: Ints
    corners: Bools
    live: Bools
    pair: Ints
    discs: Floats
    disc_doubt: Floats
    base_only: Bools
    idle: Bools
    labels: list[tuple[str, str]]
    source: Source
    double: Bools
    ending: Bools
    gone: Bools

    @cached_property
    def size(self) -> Floats:
        """What no form exceeds, shape (m,); every factor of a form is at most 1."""
        return np.asarray(np.abs(self.table).sum(axis=(1, 2)))

    @cached_property
    def lifted(self) -> Bools:
        """Whether a curve's form depends on the lift, shape (m,)."""
        return np.asarray(self.table[:, :, 1:].any(axis=(1, 2)))

    @cached_property
    def affine(self) -> Bools:
        """Whether a curve has one root over each base value: a form of degree one along a slide."""
        return np.asarray(~(self.turns[1] | self.table[:, :, 2].any(axis=1)))

    @cached_property
    def errors(self) -> Floats:
        """Bounds of the errors of a curve's coefficients along the lift, shape (m,)."""
        return (self.eps + 8 * UNIT) * self.size

    @cached_property
    def fold_errors(self) -> Floats:
        """Bounds of the errors of a curve's fold, shape (m,)."""
        bounds = self.bounds_along(self.table, self.eps)
        return blur(lambda a, minus: fold(a, self.turns[1], minus), bounds)

    def in_turn(self, curve: Ints, v: Floats) -> Floats:
        """Bring roots of curves, angles (..., n), into the first turn of the lift.

        A root that is the lift's end over every base value would jump by a turn with rounding.
        """
        low = self.ends[1][0]
        v = (v - low) % TURN
        return np.asarray(low + v - TURN * (self.ending[curve] & (v > TURN - AT_END)))

    def along(self, tables: Floats, t: Floats) -> Floats:
        """Return the lift's coefficients of tables (n, 3, 3) over base values (n, k): (3, n, k)."""
        _, one, other = basis(self.turns[0], t)
        c = tables.transpose(2, 1, 0)[..., None]
        return np.asarray(c[:, 0] + c[:, 1] * one + c[:, 2] * other)

    def bounds_along(self, tables: Floats, eps: Floats) -> Floats:
        """Return what these coefficients do not exceed, without and with errors: (3, 2, n)."""
        size = np.abs(tables).sum(axis=1).T
        doubt = (eps + 8 * UNIT) * size.sum(axis=0) * (size > 0)
        return np.stack([size, size + doubt], axis=1)

    def products(self, t: Floats, v: Floats) -> Floats:
        """Return the nine products of a form's factors at places, (n, 9)."""
        base, lift = basis(self.turns[0], t), basis(self.turns[1], v)
        return np.asarray((base[:, None] * lift).reshape(9, -1).T)

    def sides_at(self, f: Ints, t: Floats, v: Floats) -> Floats:
        """Return side conditions of features at t (n,) and lift values v (n, 2): (n, 2, 4)."""
        base, lift = basis(self.turns[0], t), basis(self.turns[1], v)
        rows = np.einsum("in,nsij->njs", base, self.sides[f])
        return np.asarray(np.einsum("jnr,njs->nrs", lift, rows))


def is_varied(sides: Floats) -> Bools:
    """Tell which side conditions are not constants, (..., 3, 3) to (...)."""
    return np.asarray(sides.reshape(*sides.shape[:-2], 9)[..., 1:].any(axis=-1))


# --- from a problem -------------------------------------------------------------------------------


class Source:
    """What a scene was made from: exact tables and clauses of pairs, made when they are needed."""

    def __init__(self, problem: Problem, base: int, bits: tuple[int, int], caution: float) -> None:
        self.problem, self.base, self.bits, self.caution = problem, base, bits, caution
        self.rows = ExactRows(problem)
        self.shift: Ints = np.add.outer(np.arange(3) * bits[0], np.arange(3) * bits[1])
        contacts = problem.contacts
        self.points = len(problem.names)
        # A corner above a half-space is one form without side conditions, and discs -1.
        discs = contacts.discs.reshape(-1, 9)
        is_height = ((discs[:, 1:] == 0).all(axis=1) & (discs[:, 0] == -1))[contacts.pair]
        self.heights: Ints = np.flatnonzero(is_height)
        self.used: Ints = np.flatnonzero(~is_height)
        self.count = self.points + len(self.heights)
        self.number, self.pair = np.unique(contacts.pair[self.used], return_inverse=True)
        self.begin: Ints = np.searchsorted(self.pair, np.arange(len(self.number) + 1))
        self.clauses = cache(self._clauses)

    def scaled(self, tables: Floats, errors: Floats) -> tuple[Floats, Floats]:
        """Return tables base before lift, largest coefficient 1, and their errors."""
        if self.base == 1:
            tables, errors = tables.swapaxes(-1, -2), errors.swapaxes(-1, -2)
        tables, errors = tables * 2.0**self.shift, errors * 2.0**self.shift
        size = np.abs(tables).max(axis=(-2, -1), keepdims=True, initial=0.0)
        size = np.where(size > 0, size, 1.0)
        eps = (errors / size).max(axis=(-2, -1), initial=0.0) + 4 * UNIT
        return tables / size, self.caution * eps

    def exact(self, table: Any) -> list[list[Any]]:
        """Return an exact table (3, 3) base before lift, in the scene's units."""
        from flint import ctx, fmpq

        table = table.T if self.base else table
        with ctx.workprec(1280):
            return [
                [x * fmpq(2) ** int(k) if x != 0 else x for x, k in zip(*row, strict=True)]
                for row in zip(table, self.shift, strict=True)
            ]

    def feature(self, f: int, side: int | None = None) -> list[list[Any]]:
        """Return the exact form of a feature, or one of its side conditions."""
        if f < self.points:
            return self.exact(self.rows.form(f))
        form, sides = self.rows.feature(self.row(f) - self.points)
        return self.exact(form if side is None else sides[side])

    def rounded(self, f: int, side: int | None = None) -> Floats:
        """Return the same, each coefficient rounded once, largest coefficient 1."""
        table = np.array([[float(x) for x in row] for row in self.feature(f, side)])
        return table / (np.abs(table).max() or 1.0)

    def row(self, f: int) -> int:
        """Return the row of a feature among the problem's forms and contacts."""
        if f < self.points:
            return f
        at = self.heights[f - self.points] if f < self.count else self.used[f - self.count]
        return self.points + int(at)

    def end(self, j: int, upper: int) -> Any:
        """Return an end of the range of the base (0) or the lift (1) as a ball."""
        from flint import fmpq

        ends = self.rows.range((self.base, 1 - self.base)[j])
        assert ends is not None
        return ends[upper] * fmpq(2) ** -self.bits[j]

    def _clauses(self, n: int) -> Clauses:
        """Return the clauses of a pair."""
        a, b = self.begin[n], self.begin[n + 1]
        rows, contacts = self.used[a:b], self.problem.contacts
        forms, eps = self.scaled(contacts.forms[rows], contacts.errors[rows])
        sides, side_eps = self.scaled(contacts.sides[rows], contacts.side_errors[rows])
        real = is_varied(sides) | (sides[:, :, 0, 0] != 1)
        f, s = np.nonzero(real & contacts.corners[rows][:, None])
        tables = np.concatenate([forms, sides[f, s]])
        size = np.abs(tables).sum(axis=(1, 2))  # a form that is zero in doubles may be tiny
        doubt = 16 * np.concatenate([eps, side_eps[f, s]]) * np.where(size > 0, size, 1.0)
        clause = np.concatenate([contacts.clause[rows], contacts.clause[rows[f]]])
        order = np.argsort(clause, kind="stable")
        starts = np.unique(clause[order], return_index=True)[1]
        first = self.count + int(a)
        names: list[tuple[int, int | None]] = [(first + k, None) for k in range(len(rows))]
        names += [(first + k, side) for k, side in zip(f.tolist(), s.tolist(), strict=True)]
        return Clauses(tables.reshape(-1, 9), doubt, order, starts, names)


def scene_of(problem: Problem, base: int, caution: float = 1.0) -> Scene:
    """Return the scene of a problem over a joint, all errors enlarged by a factor."""
    order, kinds, contacts = (base, 1 - base), problem.forms.kinds, problem.contacts
    turns = kinds[base] == "revolute", kinds[1 - base] == "revolute"
    given = [problem.ranges[j] for j in order]
    angles = [2 * atan(cut) for cut in CUT_OPEN]
    opened = [r or (low, low + TURN) for r, low in zip(given, angles, strict=True)]
    bits = tuple(
        0 if turn else frexp(max(map(abs, own)))[1] for turn, own in zip(turns, opened, strict=True)
    )
    ends = [(a / 2.0**k, b / 2.0**k) for k, (a, b) in zip(bits, opened, strict=True)]
    source = Source(problem, base, (bits[0], bits[1]), caution)
    points, point_eps = source.scaled(problem.forms.coefficients, problem.errors)
    forms, eps = source.scaled(contacts.forms, contacts.errors)
    sides, side_eps = source.scaled(contacts.sides, contacts.side_errors)
    discs, _ = source.scaled(contacts.discs, np.zeros_like(contacts.discs))
    heights, used, count = source.heights, source.used, source.count
    _, first, curve = np.unique(contacts.curves[used], return_index=True, return_inverse=True)
    first = used[first]
    free = np.zeros((count, SIDES, 3, 3))
    free[..., 0, 0] = 1.0
    none = np.full((count, SIDES), -1)
    is_point = np.zeros(count, dtype=np.bool_)
    discs = discs[source.number].reshape(-1, 9)
    scene = Scene(
        base=base,
        turns=turns,
        round=(given[0] is None, given[1] is None),
        ends=(ends[0], ends[1]),
        scale=(2.0 ** bits[0], 2.0 ** bits[1]),
        table=np.concatenate([points, forms[heights], forms[first]]),
        eps=np.concatenate([point_eps, eps[heights], eps[first]]),
        count=count,
        curve=np.concatenate([np.arange(count), count + curve]).astype(np.int64),
        sides=np.concatenate([free, sides[used]]),
        side_eps=np.concatenate([np.zeros((count, SIDES)), side_eps[used]]),
        keys=np.concatenate([none, contacts.keys[used]]).astype(np.int64),
        tangent=np.concatenate([none[:, :2], contacts.ends[used]]).astype(np.int64),
        corners=np.concatenate([is_point, contacts.corners[used]]),
        live=np.concatenate([~is_point, contacts.touching[used]]),
        pair=np.concatenate([-1 - np.arange(count), source.pair]).astype(np.int64),
        discs=discs,
        disc_doubt=FAR_APART * np.abs(discs).sum(axis=1),
        base_only=np.zeros(len(discs), dtype=np.bool_),
        idle=~np.isin(np.arange(len(discs)), source.pair[contacts.touching[used]]),
        labels=[
            *((name, "") for name in problem.names),
            *(
                (contacts.boundaries[contacts.pair[k]], contacts.names[k])
                for k in [*heights.tolist(), *used.tolist()]
            ),
        ],
        source=source,
        double=np.zeros(count + len(first), dtype=np.bool_),
        ending=np.zeros(count + len(first), dtype=np.bool_),
        gone=np.zeros(count + len(first), dtype=np.bool_),
    )
    return _without_cancelling(_with_bounds(scene))


def _with_bounds(scene: Scene) -> Scene:
    """Find out which features can be contacts somewhere, and which pairs never see the lift."""
    forms, eps = scene.table[scene.curve], scene.eps[scene.curve]
    low, high = extremes(forms, scene.turns)
    doubt = 16 * eps * np.abs(forms).sum(axis=(1, 2))
    side_doubt = 16 * scene.side_eps * np.abs(scene.sides).sum(axis=(-2, -1))
    live = scene.live & (low <= doubt) & (high >= -doubt)
    live &= (extremes(scene.sides, scene.turns)[1] >= -side_doubt).all(axis=1)
    moved = np.any(forms[:, :, 1:], axis=(1, 2)) | np.any(scene.sides[..., 1:], axis=(1, 2, 3))
    lifted = np.zeros(len(scene.discs), dtype=np.bool_)
    np.logical_or.at(lifted, scene.pair[scene.count :], moved[scene.count :])
    return replace(scene, live=live, base_only=~lifted)


def _without_cancelling(scene: Scene) -> Scene:
    """Round the coefficients of terms that cancel once, for example of an edge of tiny length."""
    (table, eps), (sides, side_eps) = (
        (x.copy(), y.copy()) for x, y in ((scene.table, scene.eps), (scene.sides, scene.side_eps))
    )
    live, source = np.flatnonzero(scene.live), scene.source
    own, size = eps[scene.curve], np.abs(table[scene.curve]).max(axis=(1, 2), initial=0.0)
    cancels = (own >= size) | (scene.live & (own > source.caution * CANCELS))
    for f in np.flatnonzero(cancels).tolist():
        c = scene.curve[f]
        table[c], eps[c] = source.rounded(f), source.caution * ONCE
    for n, s in np.argwhere(side_eps[live] > source.caution * CANCELS).tolist():
        f = live[n]
        sides[f, s], side_eps[f, s] = source.rounded(f, s), source.caution * ONCE
    return replace(scene, table=table, eps=eps, sides=sides, side_eps=side_eps)
