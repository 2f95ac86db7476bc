"""Theorem 2 on the circle of a joint's angles: equation and inequality (eqs. 30-39).

The equation ``a cos q + b sin q = c`` asks where a form in one joint vanishes, the inequality
``a cos q + b sin q >= c`` where it is not negative. With the amplitude ``d = sqrt(a² + b²)`` and
the direction theta of (a, b) the left side is ``d cos(q - theta)`` (eq. 33).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Bools, Floats, Ints
from qbound.forms import HarmonicForm, JointForm

TURN: Final = 2 * np.pi
"""A full turn, rad."""

ZERO_AMPLITUDE: Final = 2.0**-40
"""An amplitude d this small, as part of ``|c|``, is taken for 0, because a form that does not
depend on the joint can have such an amplitude by rounding."""

TANGENT: Final = 4.0 * 2.0**-52
"""Relative distance of ``|c|`` from ``d`` under which two roots count as one double root."""

ALL: Final = -1
"""The count of roots where every angle is a root (a = b = c = 0)."""


@dataclass(frozen=True, eq=False)
class CircleRoots:
    """Roots of ``a cos q + b sin q = c`` within one turn, for arrays a, b, c of shape (...).

    Attributes
    ----------
    count : ndarray of int, shape (...)
        Number of different roots: 0, 1 (double), 2, or `ALL`.
    q : ndarray, shape (2, ...)
        ``theta - alpha``, where ``a cos q + b sin q`` rises, and ``theta + alpha``, where it falls;
        rad, not shifted into any turn. Where there is no root (count 0) both are the angle at which
        the two sides of the equation come closest.
    slope : ndarray of int, shape (2, ...)
        Sign of the derivative of ``a cos q + b sin q`` at each root: +1, -1; 0 where double.
    theta : ndarray, shape (...)
        Direction of (a, b), rad, in (-pi, pi] (eq. 34).
    alpha : ndarray, shape (...)
        Half-width arccos(c / d), rad, in [0, pi] (eq. 35).
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

    With :math:`d = \sqrt{a^2 + b^2}` and :math:`\theta = \mathrm{atan2}(b, a)` the roots are
    :math:`q = \theta \pm \arccos(c / d)`.

    Parameters
    ----------
    a, b, c : array_like, shape (...)
        Coefficients in one unit; broadcast against each other.

    Raises
    ------
    ValueError
        If a coefficient is NaN, infinite or complex.

    Notes
    -----
    The arctan(b / a) of eq. (34) loses the quadrant when a < 0 and is undefined when a = 0: atan2
    stands here instead. Both signs of the arccos give roots; eq. (37) keeps only the positive sign.

    Examples
    --------
    ``cos q = 0.5`` has the roots -60° and 60°; the cosine rises at the first:

    >>> from qbound import circle_roots
    >>> roots = circle_roots(1.0, 0.0, 0.5)
    >>> int(roots.count), roots.q.round(4).tolist(), roots.slope.tolist()
    (2, [-1.0472, 1.0472], [1, -1])

    Look at `count` before `q`: ``cos q = 1`` has one double root and ``cos q = 2`` has none:

    >>> circle_roots(1.0, 0.0, [1.0, 2.0]).count.tolist()
    [1, 0]
    """
    if any(np.iscomplexobj(x) for x in (a, b, c)):
        raise ValueError("a, b and c must be real numbers, found complex ones")
    a, b, c = (np.asarray(x, dtype=float) for x in np.broadcast_arrays(a, b, c))
    if not (np.isfinite(a).all() and np.isfinite(b).all() and np.isfinite(c).all()):
        raise ValueError("a, b and c must be finite numbers")
    theta, alpha, ratio = polar(a, b, c)
    everywhere = (a == 0) & (b == 0) & (c == 0)
    crossing = ~everywhere & (np.abs(ratio) < 1)
    count = np.select([everywhere, np.abs(ratio) == 1, crossing], [ALL, 1, 2], 0)
    # A double root is theta or theta + pi: one angle modulo a full turn, so both keep the sum.
    q = np.stack([np.where(crossing, theta - alpha, theta + alpha), theta + alpha])
    slope = np.stack([np.where(crossing, 1, 0), np.where(crossing, -1, 0)])
    return CircleRoots(count.astype(np.int64), q, slope, theta, alpha)


def polar(a: Floats, b: Floats, c: Floats) -> tuple[Floats, Floats, Floats]:
    """Return theta, alpha and c / d of Theorem 2 (eqs. 34-36), shape (...) each.

    c / d is exactly 1 or -1 at a tangency. Where the amplitude d is 0 it is ``2^40`` or ``-2^40``,
    or 0 if c is 0 too. The coefficients are not checked.
    """
    d = np.hypot(a, b)
    moves = d > ZERO_AMPLITUDE * np.abs(c)  # where False, the quotient keeps the value of `out`
    ratio = np.divide(c, d, out=np.array(np.sign(c) / ZERO_AMPLITUDE), where=moves)
    ratio = np.where(np.abs(np.abs(ratio) - 1) <= TANGENT, np.sign(ratio), ratio)
    return np.arctan2(b, a), np.arccos(np.clip(ratio, -1.0, 1.0)), ratio


@dataclass(frozen=True, eq=False)
class CircleArc:
    """Angles with ``a cos q + b sin q >= c``: ``|q - centre| <= half_width`` modulo a full turn.

    Attributes
    ----------
    centre : ndarray, shape (...)
        Middle of the arc: theta of Theorem 2, rad.
    half_width : ndarray, shape (...)
        rad: pi where every angle satisfies the inequality, 0 where one angle does.
    empty : ndarray of bool, shape (...)
        True where no angle satisfies the inequality; `half_width` is 0 there.
    """

    centre: Floats
    half_width: Floats
    empty: Bools


def circle_arc(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> CircleArc:
    r"""Solve the inequality :math:`a\cos q + b\sin q \ge c` (Theorem 2, corrected).

    The solution is the closed arc :math:`|q - \theta| \le \arccos(c / d)` between the two roots. It
    is not the full turn of eq. (39), which excludes no angle, and not the interval of eq. (31),
    which is longer than a turn.

    Parameters
    ----------
    a, b, c : array_like, shape (...)
        As in `circle_roots`, with its errors.

    Examples
    --------
    ``-cos q >= 0.5`` holds within 60° of 180°:

    >>> from qbound import circle_arc
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


# --- roots of a form along one joint --------------------------------------------------------------


def line_roots(form: JointForm) -> Floats:
    """Solve ``c0 + a q + b q² = 0``, the counterpart of Theorem 2 for a joint that slides.

    A component has b = 0 and one root, a squared distance has two roots or none.

    Parameters
    ----------
    form : JointForm
        Its fields c0, a, b of shape (...).

    Returns
    -------
    ndarray, shape (2, ...)
        The root at which the form rises, and the root at which it falls; NaN where there is none.

    Examples
    --------
    ``2 q - 6`` rises through 0 at 3; ``q² - 5 q + 6`` falls at 2 and rises at 3:

    >>> from qbound.forms import JointForm
    >>> from qbound.circle import line_roots
    >>> line_roots(JointForm(np.array(-6.0), np.array(2.0), np.array(0.0))).tolist()
    [3.0, nan]
    >>> line_roots(JointForm(np.array(6.0), np.array(-5.0), np.array(1.0))).tolist()
    [3.0, 2.0]
    """
    c0, a, b = (np.asarray(x, dtype=float) for x in form)
    with np.errstate(divide="ignore", invalid="ignore"):
        width = np.sqrt(a * a - 4 * b * c0)  # NaN where there is no root
        # The textbook formula (-a ± width) / (2 b) cancels for one sign. The root `one` takes the
        # sign that does not cancel, and `other` follows from one * other = c0 / b.
        half = -(a + np.copysign(width, a)) / 2
        one, other = np.where(width > 0, np.stack([half / b, c0 / half]), np.nan)
    # The slope a + 2 b q is `-width` or `width`: at `one` it has the sign of -a.
    found = np.where(np.signbit(a), np.stack([one, other]), np.stack([other, one]))
    return np.where(np.isfinite(found), found, np.nan)


def roots_along(form: HarmonicForm, joint: int, q: ArrayLike) -> Floats:
    """Return where a form vanishes along one joint, the other joints held (Theorem 2).

    Parameters
    ----------
    form : HarmonicForm
    joint : int
        The joint that moves, from 0.
    q : array_like, shape (..., n)
        Values of the joints; the value of the joint that moves is not read.

    Returns
    -------
    ndarray, shape (2, ..., *stack)
        The root at which the form rises (a lower bound, k = 2) and the root at which it falls (an
        upper bound, k = 1); rad, not shifted into any turn, or length. NaN where there is none.

    Examples
    --------
    At q1 = 60° the paper's tool is above its limit between two values of q2:

    >>> from qbound import clearance, load_robot
    >>> from qbound.circle import roots_along
    >>> robot = load_robot("minervabot-v2")
    >>> form = clearance(robot, robot.boundary("B7"))
    >>> np.degrees(roots_along(form, 1, np.radians([60.0, 0.0]))).round(2).tolist()
    [-266.56, -33.44]
    """
    c0, a, b = form.along(joint, q)
    if form.kinds[joint] == "prismatic":
        return line_roots(JointForm(c0, a, b))
    roots = circle_roots(a, b, -c0)
    return np.where(roots.count > 0, roots.q, np.nan)


# --- full turns -----------------------------------------------------------------------------------


def first_from(low: ArrayLike, q: ArrayLike) -> Floats:
    """Return the first of the angles q, modulo full turns, that is not below `low`; rad.

    Examples
    --------
    >>> from qbound.circle import first_from
    >>> first_from(0.0, [-1.0, 7.0]).round(4).tolist()
    [5.2832, 0.7168]
    """
    q = np.asarray(q, dtype=float)
    return np.asarray(q + TURN * np.ceil((np.asarray(low, dtype=float) - q) / TURN))


def nearest_turn(q: ArrayLike, centre: ArrayLike) -> Floats:
    """Shift the angles q by full turns into (centre - pi, centre + pi]; rad.

    Examples
    --------
    >>> from qbound.circle import nearest_turn
    >>> nearest_turn([4.0, -4.0], 0.0).round(4).tolist()
    [-2.2832, 2.2832]
    """
    q = np.asarray(q, dtype=float)
    return np.asarray(q + TURN * np.floor((np.asarray(centre) - q) / TURN + 0.5))
