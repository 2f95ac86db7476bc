"""Identities that entries rest on: the chain of Theorem 1 in general rotations, Theorem 2 complete.

A rotation that can be any rotation is one of a unit quaternion. Its entries are polynomials, bound
by the unit length alone, so an identity holds for every rotation exactly if dividing by these
conditions leaves no remainder: a decision, not a sample.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from qbound.arrays import Array
from qbound.frames import Frame, Frames, axis_rotation

UNTURNED: Array = np.eye(3, dtype=int)
"""Orientation of a point's frame in its link."""


@dataclass(frozen=True, eq=False)
class General:
    """Two general rotations and four general vectors: the chain 0, a, a+n, b, b+m of Theorem 1.

    Attributes
    ----------
    chain : Frames
        With symbols for everything.
    R_0a, R_ab : ndarray, shape (3, 3)
        Rotations of unit quaternions.
    r_0a, r_ab, r_an, r_bm : ndarray, shape (3,)
        Vectors, each seen from its first index.
    """

    chain: Frames
    R_0a: Array
    R_ab: Array
    r_0a: Array
    r_ab: Array
    r_an: Array
    r_bm: Array

    @property
    def B(self) -> Array:
        """The vector of eq. (16)."""
        return np.asarray(self.r_ab + self.R_ab @ self.r_bm - self.r_an)


@cache
def general() -> General:
    """Return the chain of Theorem 1 with general symbols."""
    R_0a, R_ab = (_rotation(letter) for letter in "ef")
    r_0a, r_ab, r_an, r_bm = (_vector(name) for name in ("0a", "ab", "an", "bm"))
    chain = Frames(
        "0",
        [
            Frame("a", "0", R_0a, r_0a),
            Frame("a+n", "a", UNTURNED, r_an),
            Frame("b", "a", R_ab, r_ab),
            Frame("b+m", "b", UNTURNED, r_bm),
        ],
    )
    return General(chain, R_0a, R_ab, r_0a, r_ab, r_an, r_bm)


VECTORS: Final = {
    "r_ab": ("a", "b"),
    "r_an": ("a", "a+n"),
    "r_bm": ("b", "b+m"),
    "r_0a": ("0", "a"),
    "r_0b": ("0", "b"),
    "r_0an": ("0", "a+n"),
    "r_0bm": ("0", "b+m"),
}
"""From where to where the vectors of `printed.THEOREM_1` run."""

ROTATIONS: Final = {"R_ab": ("a", "b"), "R_0a": ("0", "a"), "R_0b": ("0", "b")}


def right_side(number: int, observer: str = "") -> Array:
    """Work out the printed right side of an equation of Theorem 1 in the general chain.

    Parameters
    ----------
    number : int
    observer : str
        Frame from which every vector is seen; without one each is seen from its first index, as
        a vector is that a rotation transforms from there.
    """
    values = {name: _position(*ab, observer or ab[0]) for name, ab in VECTORS.items()}
    values |= {name: _rotation_between(*ab) for name, ab in ROTATIONS.items()}
    return np.asarray(paper.work_out(paper.THEOREM_1[number], values))


def is_identity(number: int, left: tuple[str, str], seen_from: str, observer: str = "") -> bool:
    """Tell whether an equation of Theorem 1 holds for every rotation and vector.

    Parameters
    ----------
    number : int
    left : tuple of str
        Start and end of the vector on its left side.
    seen_from : str
        Frame from which the left side is seen.
    observer : str
        As in `right_side`.
    """
    return vanishes(_position(*left, seen_from) - right_side(number, observer))


def quarter_turn() -> Frames:
    """Return the smallest chain in which eqs. (15) and (25) differ: a turned, b one unit away."""
    turn = np.rint(axis_rotation([0, 1, 0], np.pi / 2)).astype(int)
    return Frames(
        "0",
        [Frame("a", "0", turn, np.zeros(3, int)), Frame("b", "a", UNTURNED, np.array([1, 0, 0]))],
    )


def vanishes(difference: Any) -> bool:
    """Tell whether every entry is zero for all rotations and vectors of `general`."""
    ring, conditions = _ring()
    entries = (ring.from_expr(sp.sympify(x)) for x in np.ravel(np.asarray(difference)))
    return not any(polynomial.rem(conditions) for polynomial in entries)


@cache
def theorem_2() -> dict[str, bool]:
    r"""Return the steps of the proof of Theorem 2 restated, and whether each is an identity.

    The theorem: for d > 0 and :math:`|c| \le d` the angles with
    :math:`a\cos q + b\sin q \ge c` are those with :math:`|q - \theta| \le \arccos(c / d)` modulo
    full turns, :math:`\theta = \mathrm{atan2}(b, a)`; all for c < -d, none for c > d; for d = 0
    all or none by the sign of c.
    """
    a, b, q, x = sp.symbols("a b q x", real=True)
    t = sp.Symbol("t", nonnegative=True)  # (c / d + 1) / 2, so that c / d runs over [-1, 1]
    d, theta = sp.sqrt(a**2 + b**2), sp.atan2(b, a)
    form = a * sp.cos(q) + b * sp.sin(q)
    other = a * sp.sin(q) - b * sp.cos(q)
    inside = sp.Interval.open(0, sp.pi)
    alpha = sp.acos(2 * t - 1)
    return {
        "a cos q + b sin q = d cos(q - θ), θ = atan2(b, a)": (
            sp.simplify(sp.expand_trig(d * sp.cos(q - theta)) - form) == 0
        ),
        "d² - (a cos q + b sin q)² = (a sin q - b cos q)², so |c| ≤ d at a root": (
            sp.simplify(d**2 - form**2 - other**2) == 0
        ),
        "cos(-x) = cos x, so the set is symmetric about θ": sp.cos(-x) - sp.cos(x) == 0,
        "the slope of cos is negative on (0, π), so cos x ≥ c / d up to arccos(c / d)": (
            sp.solveset(-sp.sin(x) >= 0, x, inside) == sp.EmptySet
            and (sp.cos(0), sp.cos(sp.pi)) == (1, -1)
        ),
        "d cos(± arccos(c / d)) = c: both ends are roots": (
            sp.cos(alpha) == 2 * t - 1 and sp.cos(-alpha) == 2 * t - 1
        ),
        "the slopes at the ends have the squares d² - c²: simple unless |c| = d": (
            sp.simplify(sp.sin(alpha) ** 2 - (1 - (2 * t - 1) ** 2)) == 0
        ),
        "for a = b = 0 the form is 0 at every q": form.subs({a: 0, b: 0}) == 0,
    }


@cache
def mirror() -> dict[str, bool]:
    r"""Return why symmetric offsets have symmetric paths: the steps, and whether each holds.

    The mirror image of a pose of the paper's arm is its point reflection in joint space,
    :math:`q \mapsto c - q` with :math:`c = (-2\gamma, 2\gamma - \pi)`, where :math:`\gamma` is the
    angle of link 1 from the vertical. Scaling about a centroid and straight joint paths commute
    with it. Not in the paper.
    """
    z01, x23, length = sp.symbols("z_01 x_23 l", positive=True)
    gamma, s = sp.symbols("gamma s", real=True)
    q = sp.Matrix(sp.symbols("q1 q2", real=True))
    p, g = (sp.Matrix(sp.symbols(f"{name}1 {name}2", real=True)) for name in "pg")
    c = sp.Matrix([-2 * gamma, 2 * gamma - sp.pi])

    def tool(q: Any) -> Any:
        one, two = q[0] + gamma, q[0] + q[1] + sp.pi / 2  # directions of the links from z to x
        turned = [length * f(one) + x23 * f(two) for f in (sp.sin, sp.cos)]
        return sp.Matrix([turned[0], z01 + turned[1]])

    def singular(q: Any) -> Any:
        return tool(q).jacobian(q).det()

    mirrored = sp.diag(-1, 1) * tool(q)
    scaled = g + s * (p - g)
    straight = p + s * (q - p)
    determinant = sp.simplify(singular(q) + length * x23 * sp.sin(q[1] + sp.pi / 2 - gamma))
    return {
        "tool(c - q) is the mirror image of tool(q)": (
            sp.simplify(sp.expand_trig(tool(c - q) - mirrored)) == sp.zeros(2, 1)
        ),
        "c - q applied twice is q": c - (c - q) == q,
        "scaling commutes: c - (g + s(p - g)) = (c - g) + s((c - p) - (c - g))": (
            sp.expand((c - scaled) - ((c - g) + s * ((c - p) - (c - g)))) == sp.zeros(2, 1)
        ),
        "a straight joint path goes to a straight one": (
            sp.expand((c - straight) - ((c - p) + s * ((c - q) - (c - p)))) == sp.zeros(2, 1)
        ),
        "det J = -l x_23 sin(q2 + π/2 - γ): singular where the links are in line": determinant == 0,
        "the singular line goes through the centre c / 2 of the reflection": (
            sp.simplify(sp.sin((c / 2)[1] + sp.pi / 2 - gamma)) == 0
        ),
    }


@cache
def _position(a: str, b: str, observer: str) -> Array:
    return _reduced(general().chain.position(a, b, observer))


@cache
def _rotation_between(a: str, b: str) -> Array:
    return _reduced(general().chain.rotation(a, b))


def _reduced(array: Array) -> Array:
    """Write every entry in its shortest form under the conditions of unit length."""
    ring, conditions = _ring()
    entries = [ring.from_expr(sp.sympify(x)).rem(conditions).as_expr() for x in array.flat]
    return np.array(entries).reshape(array.shape)


def _rotation(letter: str) -> Array:
    """Return the rotation of the quaternion with entries such as e0, e1, e2, e3."""
    quaternion = sp.Quaternion(*sp.symbols(f"{letter}0:4", real=True), norm=1)
    return np.array(quaternion.to_rotation_matrix())


def _vector(name: str) -> Array:
    return np.array(sp.symbols(f"x_{name} y_{name} z_{name}", real=True))


@cache
def _ring() -> tuple[Any, list[Any]]:
    """Return the polynomials in all symbols, and the conditions of unit length in them."""
    quaternions = [sp.symbols(f"{letter}0:4", real=True) for letter in "ef"]
    vectors = [x for name in ("0a", "ab", "an", "bm") for x in _vector(name)]
    ring = sp.ring([*(x for e in quaternions for x in e), *vectors], sp.QQ)[0]
    return ring, [ring.from_expr(sum(x**2 for x in e) - 1) for e in quaternions]
