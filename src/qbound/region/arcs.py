"""Arcs of a boundary, exact: places along them, and line integrals to machine precision.

An arc runs along roots of one form (or one end of a joint's range), piece by piece between
critical values. Along a piece the base is ``middle + half sin(angle)``: where a root folds back its
square root is smooth in the angle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats, Ints
from qbound.forms.angles import TURN, whole_turns
from qbound.forms.harmonic import HarmonicForm
from qbound.model.values import real_numbers
from qbound.printable import printable
from qbound.region.plane import Plane
from qbound.tolerances import QUADRATURE, SAME_POINT

FIBRE: Final = -3
"""Stands for the form of a root where a piece follows none."""

NODES: Final = (24, 48, 96, 192, 384, 768)
"""Numbers of Gauss-Legendre nodes that are tried in turn."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces of boundary, in the order of the loop.

    Attributes
    ----------
    plane : Plane
    base : int
        Which joint is the base; places are given in the order of the joints.
    roots : ndarray of int, shape (k, 3)
        What each piece follows, as `Root`; its form is `FIBRE` for a piece of a fibre, straight
        along the lift.
    start, end : ndarray, shape (k, 2)
        Base and lift value at both ends.
    turns : ndarray, shape (k, 2)
        What was added to the base and lift values of the plane, rad.
    """

    plane: Plane
    base: int
    roots: Ints
    start: Floats
    end: Floats
    turns: Floats

    def __getitem__(self, chosen: slice | Ints) -> Pieces:
        """Return some of the pieces."""
        return Pieces(
            self.plane,
            self.base,
            self.roots[chosen],
            self.start[chosen],
            self.end[chosen],
            self.turns[chosen],
        )

    def straight(self) -> list[bool]:
        """Tell of each piece whether it is straight: along a fibre, or at an end."""
        found: list[bool] = (self.roots[:, 0] < 0).tolist()
        return found

    def places(self, angle: Floats) -> Floats:
        """Return joint values at angles from -pi/2 (start) to pi/2 (end), shape (k, n, 2)."""
        part = (1 + np.sin(angle))[:, None] / 2
        start, end = self.start[:, None], self.end[:, None]
        q = np.where(part < 1, start + (end - start) * part, end)
        curved = np.flatnonzero(self.roots[:, 0] != FIBRE)
        turns = self.turns[curved][:, None]
        values = (
            self.plane.follow(self.roots[curved], q[curved][..., 0] - turns[..., 0]) + turns[..., 1]
        )
        if self.plane.lift_kind == "revolute":  # an angle may jump by a turn at an end
            reach = SAME_POINT * self.plane.base_unit
            for end in (start[curved], self.end[curved][:, None]):
                off = whole_turns(values - end[..., 1])
                values -= TURN * np.where(np.abs(q[curved][..., 0] - end[..., 0]) <= reach, off, 0)
        inside = np.abs(angle) < math.pi / 2  # the ends are given
        q[curved, :, 1] = np.where(inside, values, q[curved][..., 1])
        return ordered(q, self.base)

    def nodes(self, n: int) -> tuple[Floats, Floats]:
        """Return Gauss-Legendre nodes and steps dq with their weights, both of shape (k, n, 2).

        The steps are those of the polynomial through nodes and ends: no slope, infinite at a fold,
        is asked for, and the steps of a piece add up to its end minus its start.
        """
        x, steps = _steps(n)
        q = self.places(x * math.pi / 2)
        return q[:, 1:-1], steps @ q


@dataclass(frozen=True, eq=False)
class Arc:
    """A piece of boundary on which one form vanishes, or one joint is at its limit.

    Attributes
    ----------
    boundary : str
    branch : int or None
        -1 / +1: the root theta - / + arccos of Theorem 2; None where there is none.
    laid : Pieces
        Pieces of boundary, among them those of the arc, the region on their left.
    span : tuple of two int
        The first of the arc's, and where they end.
    feature : str
        Of two bodies, what touches: "corner 2 on edge 3", the first body's first.
    row : int
        Which form of the pieces' plane vanishes along it; negative at a joint limit.
    also : tuple of (str, str)
        Boundaries and features that vanish all along it, too: they coincide there.
    vague : float
        How far its start may be off, in units of a joint.
    """

    boundary: str
    branch: int | None
    laid: Pieces
    span: tuple[int, int]
    feature: str = ""
    row: int = -1
    also: tuple[tuple[str, str], ...] = ()
    vague: float = 0.0

    def __repr__(self) -> str:
        """Say in a line what it is part of and where it runs."""
        branch = "" if self.branch is None else f" ({self.branch:+d})"
        start, end = (", ".join(f"{x:.6g}" for x in q) for q in (self.start, self.end))
        feature = f": {self.feature}" if self.feature else ""
        return printable(f"<Arc of {self.boundary}{feature}{branch} from ({start}) to ({end})>")

    @property
    def label(self) -> tuple[str, str]:
        """Boundary and feature: where they change is a vertex."""
        return self.boundary, self.feature

    @cached_property
    def pieces(self) -> Pieces:
        """What the arc is made of, the region on its left."""
        return self.laid[slice(*self.span)]

    @property
    def form(self) -> HarmonicForm | None:
        """What vanishes along it, largest coefficient 1; None at a joint limit.

        Of two bodies it is the form of the feature that touches there, which says nothing of the
        bodies elsewhere.
        """
        return self.laid.plane.form(self.row) if self.row >= 0 else None

    @property
    def start(self) -> Floats:
        """Joint values at the start, shape (2,)."""
        return ordered(self.laid.start[self.span[0]], self.laid.base)

    @property
    def end(self) -> Floats:
        """Joint values at the end, shape (2,)."""
        return ordered(self.laid.end[self.span[1] - 1], self.laid.base)

    @cached_property
    def points(self) -> Floats:
        """Joint values along the arc, exact, its two ends first and last, shape (k, 2)."""
        places = self.pieces.places(np.linspace(-math.pi / 2, math.pi / 2, 33))
        ends_suffice = self.pieces.straight()
        parts = [p[[0, -1]] if s else p for p, s in zip(places, ends_suffice, strict=True)]
        line = np.concatenate(parts)
        moves = np.abs(np.diff(line, axis=0)).max(axis=1) > SAME_POINT
        return np.concatenate([line[:1], line[1:-1][moves[:-1]], line[-1:]])

    def at(self, s: ArrayLike) -> Floats:
        """Return joint values at parameters in [0, 1], shape (...) to (..., 2); exact, ends too.

        Pieces between critical values take equal parts of [0, 1]. What is beyond is an end.

        Raises
        ------
        ValueError
            If a parameter is NaN or complex.
        """
        parameters = real_numbers(s)
        if np.isnan(parameters).any():
            raise ValueError("a parameter along an arc is NaN")
        x = np.clip(parameters, 0, 1).reshape(-1) * len(self.pieces.roots)
        piece = np.minimum(x.astype(np.int64), len(self.pieces.roots) - 1)
        q = np.empty((len(x), 2))
        for k in np.unique(piece):
            mine = piece == k
            q[mine] = self.pieces[k : k + 1].places((x[mine] - k - 0.5) * math.pi)[0]
        return q.reshape(*parameters.shape, 2)

    def nodes(self, n: int = 48) -> tuple[Floats, Floats]:
        """Return Gauss-Legendre nodes q and weighted steps dq, each of shape (n pieces, 2).

        The sum of ``P(q) dq_1 + Q(q) dq_2`` is the integral of P dq_1 + Q dq_2 along the arc.
        """
        q, dq = self.pieces.nodes(n)
        return q.reshape(-1, 2), dq.reshape(-1, 2)


def ordered(place: Floats, base: int) -> Floats:
    """Bring places, shape (..., 2), from (base, lift) to the order of the joints, or back."""
    return place if base == 0 else place[..., ::-1]


def integrate(arcs: Sequence[Arc], form: Callable[[Floats, Floats], ArrayLike]) -> Floats:
    """Integrate along arcs, nodes doubled until nothing changes.

    Parameters
    ----------
    form : callable
        (q, dq), both of shape (n, 2) -> the integrand's contributions, shape (n, ...).

    Returns
    -------
    ndarray, shape (...)
        The sum over all arcs. What counts as a change is measured by all contributions, their
        signs left out: joint values and integrands may be in any units.
    """
    if not arcs:
        return np.zeros(())
    rough = [np.abs(form(*arc.nodes(NODES[0]))).sum(axis=0) for arc in arcs]
    smallest = QUADRATURE * np.sum(rough, axis=0)
    found = [converged(partial(_over, arc, form), smallest) for arc in arcs]
    return np.asarray(np.sum(found, axis=0))


def _over(arc: Arc, form: Callable[[Floats, Floats], ArrayLike], n: int) -> Floats:
    return np.asarray(np.asarray(form(*arc.nodes(n))).sum(axis=0))


def converged(sums: Callable[[int], Floats], smallest: Floats | float) -> Floats:
    """Return sums over n nodes, n doubled until they change by no more than `smallest`."""
    before = sums(NODES[0])
    for n in NODES[1:]:
        now = sums(n)
        if (np.abs(now - before) <= smallest).all():
            break
        before = now
    return now


@cache
def legendre(n: int) -> tuple[Floats, Floats]:
    """Return nodes and weights of Gauss-Legendre quadrature on [-1, 1].

    Newton on the angles of the nodes, from Tricomi's: no library is loaded and no matrix solved.
    """
    angle = np.pi * (np.arange(1, (n + 1) // 2 + 1) - 0.25) / (n + 0.5)
    for last in (False, False, False, True):
        x, before = np.cos(angle), np.ones(len(angle))
        value = x
        for k in range(2, n + 1):  # the recurrence of Legendre's polynomials
            before, value = value, ((2 * k - 1) * x * value - (k - 1) * before) / k
        slope = n * (before - x * value)  # times the square of the sine; level at a node
        angle = angle if last else angle + value * np.sin(angle) / slope
    weights = 2 * (np.sin(angle) / slope) ** 2
    mirrored = slice(None, None, -1) if n % 2 == 0 else slice(-2, None, -1)
    return np.concatenate([-x, x[mirrored]]), np.concatenate([weights, weights[mirrored]])


@cache
def _steps(n: int) -> tuple[Floats, Floats]:
    """Return -1, n Gauss-Legendre nodes and 1, and the matrix of weighted steps, (n, n + 2).

    Rows times values at the n + 2 places are the derivatives of the polynomial through them at the
    nodes, times the weights (barycentric form; the factors are 1 / P_n' at the nodes, from the
    quadrature's weights).
    """
    nodes, weights = legendre(n)
    signs = (-1.0) ** np.arange(n + 2)
    inner = np.sqrt(weights / (2 * (1 - nodes**2)))
    factors = signs * np.concatenate([[0.5], inner, [0.5]])
    x = np.concatenate([[-1.0], nodes, [1.0]])
    gaps = x[1:-1, None] - x
    rows, same = np.arange(n), np.arange(1, n + 1)
    gaps[rows, same] = 1
    slopes = factors / factors[1:-1, None] / gaps
    slopes[rows, same] = 0
    slopes[rows, same] = -slopes.sum(axis=1)
    return x, weights[:, None] * slopes
