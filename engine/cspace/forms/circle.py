"""Theorem 2 on the circle: where a cos q + b sin q meets c and where it is above (eqs. 30-39)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Floats, Ints
from cspace.tolerances import TANGENT, ZERO_AMPLITUDE

ALL: Final = -1
"""Count of roots where every angle is one (a = b = c = 0)."""


@dataclass(frozen=True)
class CircleRoots:
    """Roots of ``a cos q + b sin q = c`` within one turn, shape (...) a field.

    Attributes
    ----------
    count : ndarray of int, shape (...)
        Number of different roots: 0, 1 (double), 2, or `ALL`.
    q : ndarray, shape (2, ...)
        ``theta - alpha`` and ``theta + alpha``, rad, not wrapped. Where there is no root both are
        the angle of closest approach; `count` tells.
    slope : ndarray of int, shape (2, ...)
        Sign of the derivative of ``a cos q + b sin q`` at each root: +1, -1; 0 where double.
    theta : ndarray, shape (...)
        Direction of (a, b), rad, in (-pi, pi].
    alpha : ndarray, shape (...)
        Half-width arccos(c / d), rad, in [0, pi].
    """

    count: Ints
    q: Floats
    slope: Ints
    theta: Floats
    alpha: Floats

    @property
    def multiplicity(self) -> Ints:
        """Multiplicity of each root, 2 at a tangency; 0 if no angle or every angle is a root."""
        return np.select([self.count == 2, self.count == 1], [1, 2], 0)


def circle_roots(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> CircleRoots:
    r"""Solve :math:`a\cos q + b\sin q = c` for every entry (Theorem 2, eqs. 30-38).

    Parameters
    ----------
    a, b, c : array_like, shape (...)
        Coefficients in one length unit; broadcast against each other.

    Raises
    ------
    ValueError
        If a coefficient is NaN, infinite or complex.

    Notes
    -----
    ``theta = atan2(b, a)``: the printed arctan(b / a) loses the quadrant when a < 0 and is
    undefined when a = 0. Both signs of the arccos are roots: the printed proof keeps one.

    Examples
    --------
    >>> from cspace.forms.circle import circle_roots
    >>> roots = circle_roots(1.0, 0.0, 0.5)
    >>> int(roots.count), roots.q.round(4).tolist(), roots.slope.tolist()
    (2, [-1.0472, 1.0472], [1, -1])

    `count` tells whether the angles are roots: 1 where the line touches, 0 where it misses:

    >>> circle_roots(1.0, 0.0, [1.0, 2.0]).count.tolist()
    [1, 0]
    """
    given = np.broadcast_arrays(a, b, c)
    if any(map(np.iscomplexobj, given)):
        raise ValueError("a, b and c must be real numbers, found complex ones")
    a, b, c = (np.asarray(x, dtype=float) for x in given)
    if not (np.isfinite(a).all() and np.isfinite(b).all() and np.isfinite(c).all()):
        raise ValueError("a, b and c must be finite numbers")
    theta, alpha, ratio = polar(a, b, c)
    everywhere = (a == 0) & (b == 0) & (c == 0)
    crossing = ~everywhere & (np.abs(ratio) < 1)
    count = np.select([everywhere, np.abs(ratio) == 1, crossing], [ALL, 1, 2], 0)
    # Equal to theta +- pi where double below: one angle modulo a full turn, so both keep +pi.
    q = np.stack([np.where(crossing, theta - alpha, theta + alpha), theta + alpha])
    slope = np.stack([np.where(crossing, 1, 0), np.where(crossing, -1, 0)])
    return CircleRoots(count.astype(np.int64), q, slope, theta, alpha)


def polar(a: Floats, b: Floats, c: Floats) -> tuple[Floats, Floats, Floats]:
    """Return theta, alpha and c / d of Theorem 2 (eqs. 34-36); nothing is checked.

    c / d is exactly 1 or -1 at a tangency. It is huge where the amplitude is 0.
    """
    d = np.hypot(a, b)
    moves = d > ZERO_AMPLITUDE * np.abs(c)
    ratio = np.divide(c, d, out=np.array(np.sign(c) / ZERO_AMPLITUDE), where=moves)
    ratio = np.where(np.abs(np.abs(ratio) - 1) <= TANGENT, np.sign(ratio), ratio)
    return np.arctan2(b, a), np.arccos(np.clip(ratio, -1.0, 1.0)), ratio


@dataclass(frozen=True)
class CircleArc:
    """Where ``a cos q + b sin q >= c``: ``|q - centre| <= half_width`` modulo a full turn.

    Attributes
    ----------
    centre : ndarray, shape (...)
        rad.
    half_width : ndarray, shape (...)
        rad: pi where every angle satisfies the inequality, 0 where one angle does.
    empty : ndarray of bool, shape (...)
        True where no angle satisfies the inequality; `half_width` is 0 there.
    """

    centre: Floats
    half_width: Floats
    empty: NDArray[np.bool_]


def circle_arc(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> CircleArc:
    r"""Solve the inequality :math:`a\cos q + b\sin q \ge c` (Theorem 2, corrected).

    The solution is the closed arc between the two roots around ``theta``, of length
    ``2 arccos(c / d)``; neither the full turn of eq. (39) nor the longer interval of eq. (31).

    Parameters
    ----------
    a, b, c : array_like, shape (...)
        As in `circle_roots`, with its errors.

    Examples
    --------
    >>> from cspace.forms.circle import circle_arc
    >>> arc = circle_arc(-1.0, 0.0, 0.5)
    >>> float(arc.centre.round(4)), float(arc.half_width.round(4))
    (3.1416, 1.0472)

    Where no angle satisfies the inequality the arc is empty; where all do it is a full turn:

    >>> circle_arc(1.0, 0.0, [2.0, -2.0]).empty.tolist()
    [True, False]
    >>> float(circle_arc(1.0, 0.0, -2.0).half_width.round(4))
    3.1416
    """
    roots = circle_roots(a, b, c)
    above = np.broadcast_to(np.asarray(c, dtype=float), roots.theta.shape) > 0
    empty = (roots.count == 0) & above
    half_width = np.where(roots.count == ALL, np.pi, roots.alpha)
    return CircleArc(roots.theta, half_width, empty)
