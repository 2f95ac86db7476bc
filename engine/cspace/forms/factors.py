"""The functions of one joint in a harmonic form: a row of a table for each kind of joint.

In the algebra of forms, revolute and prismatic joints differ only here, for floats, SymPy
expressions and balls alike. A new kind of joint is a new row.

Below the table are functions for full turns (angles of one direction, and the choice of one of
them) and monomials (sines, cosines and joint values, and their products). A row of a compiled table
is a sum over monomials, so that a configuration costs one sine and one cosine a joint and one
product a monomial, however many forms there are.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cspace.arrays import Array, Floats
from qbound.circle import TURN
from qbound.forms import DERIVATIVES, Kind

NUMBERS = np.ndarray, np.generic, float, int
"""Types whose sines are NumPy's; a union of them would be made anew in each call."""


@dataclass(frozen=True, eq=False)
class Factor:
    r"""Three functions :math:`e = (1, e_1, e_2)` of the value q of one joint.

    Attributes
    ----------
    functions : callable
        :math:`e_1, e_2` of a number of any type, or of an array.
    slope : ndarray of int, shape (3, 3)
        :math:`e' = S e`; the second derivative is :math:`S^2 e`.
    largest : callable
        Bounds of the absolute values of e where abs(q) has a bound.
    units : ndarray of int, shape (m, 3)
        Each row marks functions whose squares sum to 1, or to the square of their bound.
    waves : ndarray of complex, shape (3, 3)
        A sum :math:`c \cdot e` is :math:`\sum_k (W c)_k\, e^{i w_k q} q^{p_k}`.
    turns, powers : ndarray of int, shape (3,)
        These w and p.
    product : ndarray of int, shape (3, 3, 3)
        Twice the product :math:`e_i e_j` on e, without its parts of higher degree.
    discriminant : callable
        Of (c0, c1, c2): the squared slope of :math:`c \cdot e` at its roots.
    antiderivative : callable
        Of (c0, c1, c2) and q: an antiderivative of :math:`c \cdot e`.
    """

    functions: Callable[[Any], tuple[Any, Any]]
    slope: Array
    largest: Callable[[Any], tuple[Any, Any, Any]]
    units: Array
    waves: Array
    turns: Array
    powers: Array
    product: Array
    discriminant: Callable[[Sequence[Any] | Array], Any]
    antiderivative: Callable[[Sequence[Any] | Array, Any], Any]


def cos_sin(q: Any) -> tuple[Any, Any]:
    """Return cosine and sine by the library of the number; for an array of objects entry by entry.

    Numbers are floats, real and complex balls (python-flint) and SymPy expressions.
    """
    if isinstance(q, np.ndarray) and q.dtype == object:
        cosine, sine = np.frompyfunc(cos_sin, 1, 2)(q)
        return cosine, sine
    if isinstance(q, NUMBERS):
        return np.cos(q), np.sin(q)
    if hasattr(q, "sin_cos"):
        sine, cosine = q.sin_cos()
        return cosine, sine
    import sympy

    return sympy.cos(q), sympy.sin(q)


FACTORS: Final[dict[Kind, Factor]] = {
    "revolute": Factor(  # (1, cos q, sin q)
        functions=cos_sin,
        slope=DERIVATIVES["revolute"],
        largest=lambda _: (1, 1, 1),
        units=np.array([[1, 0, 0], [0, 1, 1]]),
        waves=np.array([[1, 0, 0], [0, 0.5, -0.5j], [0, 0.5, 0.5j]]),
        turns=np.array([0, 1, -1]),
        powers=np.array([0, 0, 0]),
        product=np.array(
            [
                [[2, 0, 0], [0, 1, 0], [0, 0, 1]],
                [[0, 2, 0], [2, 0, 0], [0, 0, 0]],
                [[0, 0, 2], [0, 0, 0], [2, 0, 0]],
            ]
        ),
        discriminant=lambda c: c[1] * c[1] + c[2] * c[2] - c[0] * c[0],
        antiderivative=lambda c, q: c[0] * q + c[1] * q.sin() - c[2] * q.cos(),
    ),
    "prismatic": Factor(  # (1, q, q^2)
        functions=lambda q: (q, q * q),
        slope=DERIVATIVES["prismatic"],
        largest=lambda reach: (1, reach, reach * reach),
        units=np.eye(3, dtype=int),
        waves=np.eye(3, dtype=complex),
        turns=np.array([0, 0, 0]),
        powers=np.array([0, 1, 2]),
        product=np.array(
            [
                [[2, 0, 0], [0, 0, 0], [0, 0, 0]],
                [[0, 2, 0], [2, 0, 0], [0, 0, 0]],
                [[0, 0, 2], [0, 2, 0], [2, 0, 0]],
            ]
        ),
        discriminant=lambda c: c[1] * c[1] - 4 * c[0] * c[2],
        antiderivative=lambda c, q: c[0] * q + c[1] * q**2 / 2 + c[2] * q**3 / 3,
    ),
}


def basis_and_slope(kind: Kind, q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `basis` and its derivative, of floats, in one array, shape (..., 2, 3)."""
    found = np.empty((*q.shape, 2, 3))
    found[..., 0, 0] = 1.0
    found[..., 0, 1], found[..., 0, 2] = FACTORS[kind].functions(q)
    found[..., 1, :] = found[..., 0, :] @ FACTORS[kind].slope.T
    return found


# --- full turns -----------------------------------------------------------------------------------


def whole_turns(angle: ArrayLike) -> Floats:
    """Return the number of full turns nearest to an angle, shape (...)."""
    return np.asarray(np.rint(np.asarray(angle, dtype=float) / TURN))


def turns_within(low: float, high: float, q: ArrayLike) -> range:
    """Return every number k of full turns for which some of q + k TURN lies in [low, high]."""
    q = np.asarray(q, dtype=float)
    least, most = np.fmin.reduce(q, axis=None), np.fmax.reduce(q, axis=None)
    return range(math.ceil((low - most) / TURN), math.floor((high - least) / TURN) + 1)


# --- monomials ------------------------------------------------------------------------------------


Index = tuple[int, ...]
Function = tuple[Kind, int]


def _squared(q: float) -> float:
    return q * q


FUNCTIONS: dict[Function, tuple[Callable[[float], float], np.ufunc]] = {
    ("revolute", 1): (math.cos, np.cos),
    ("revolute", 2): (math.sin, np.sin),
    ("prismatic", 1): (float, np.positive),
    ("prismatic", 2): (_squared, np.square),
}
"""The functions of `FACTORS` one by one, of a float and of an array."""

VALUE: Function = ("prismatic", 1)
"""The value of a joint itself: what a limit bounds, of a revolute joint too."""


@dataclass(frozen=True)
class Monomials:
    """The constant 1, then functions of one joint each, then products of two earlier ones.

    Attributes
    ----------
    joints : int
    factors : tuple of (joint, function)
        The first monomials after the constant, by their key in `FUNCTIONS`.
    products : tuple of (int, int)
        For each monomial after the factors: the two earlier ones, by index, whose product it is.
    """

    joints: int
    factors: tuple[tuple[int, Function], ...]
    products: tuple[tuple[int, int], ...]

    def __len__(self) -> int:
        """Return the number of monomials, the constant included."""
        return 1 + len(self.factors) + len(self.products)

    @cached_property
    def _of_floats(self) -> tuple[tuple[int, Callable[[float], float]], ...]:
        return tuple((joint, FUNCTIONS[function][0]) for joint, function in self.factors)

    def of_one(self, q: Sequence[float]) -> list[float]:
        """Return the monomials of one configuration, in floats of Python."""
        row = [1.0]
        row += [function(q[joint]) for joint, function in self._of_floats]
        for i, j in self.products:
            row.append(row[i] * row[j])
        return row

    def of_columns(self, columns: Array) -> Array:
        """Return the monomials of n configurations, shape (joints, n) to (monomials, n)."""
        rows = np.empty((len(self), columns.shape[1]), columns.dtype)
        rows[0] = 1
        for row, (joint, function) in enumerate(self.factors, 1):
            FUNCTIONS[function][1](columns[joint], out=rows[row])
        for row, (i, j) in enumerate(self.products, 1 + len(self.factors)):
            np.multiply(rows[i], rows[j], out=rows[row])
        return rows

    def sizes(self, reach: Sequence[float]) -> list[float]:
        """Return bounds of the absolute values, joint j being at most ``reach[j]`` in size."""
        sizes = [1.0]
        sizes += [float(FACTORS[kind].largest(reach[j])[i]) for j, (kind, i) in self.factors]
        for one, other in self.products:
            sizes.append(sizes[one] * sizes[other])
        return sizes


def occurring(
    coefficients: Array, kinds: Sequence[Kind], bounded: Sequence[int]
) -> tuple[Monomials, Mapping[Index, int]]:
    """Return the monomials that occur in forms, and the position of each index among them.

    Parameters
    ----------
    coefficients : ndarray, shape (m, 3, ..., 3)
        Coefficients of forms; a monomial is the index of its coefficient; factor 0 of each joint is
        1.
    kinds : sequence of {"revolute", "prismatic"}
        One a joint.
    bounded : sequence of int
        Joints whose values themselves are needed as monomials too.
    """
    found = np.argwhere((coefficients != 0).any(axis=0)).tolist()
    return _monomials(tuple(map(tuple, found)), tuple(kinds), tuple(bounded))


@lru_cache(maxsize=64)
def _monomials(
    found: Sequence[Index], kinds: Sequence[Kind], bounded: Sequence[int]
) -> tuple[Monomials, Mapping[Index, int]]:
    """Return the same from the indices; slices and robots of one build share the result."""
    singles, several = _indices(found)
    factors = [(j, (kinds[j], i)) for j, i in map(_last, singles)]
    factors += [(j, VALUE) for j in bounded if (j, VALUE) not in factors]
    place = {(0,) * len(kinds): 0} | {index: row for row, index in enumerate(singles, 1)}
    place |= {index: row for row, index in enumerate(several, 1 + len(factors))}
    products = tuple((place[_head(index)], place[_tail(index)]) for index in several)
    return Monomials(len(kinds), tuple(factors), products), place


def padded(q: Floats, width: int, dtype: type = np.float64) -> Array:
    """Return configurations as columns, with zeros up to a multiple of `width`; (n, joints)."""
    columns: Array = np.empty((q.shape[1], -(-len(q) // width) * width), dtype)
    columns[:, : len(q)] = q.T
    columns[:, len(q) :] = 0
    return columns


def _indices(occurring: Sequence[Index]) -> tuple[list[Index], list[Index]]:
    """Return the monomials needed to make those that occur: of one joint, then of several."""
    found = set[Index]()
    for occurs in occurring:
        index = occurs
        while any(index):
            found |= {index, _tail(index)}
            index = _head(index)
    one, several = ([i for i in found if (np.count_nonzero(i) > 1) == many] for many in (0, 1))
    return sorted(one), sorted(several, key=lambda i: (np.count_nonzero(i), i))


def _last(index: Index) -> tuple[int, int]:
    """Return the last joint on which a monomial depends, and which of its factors it has."""
    joint = max(j for j, i in enumerate(index) if i)
    return joint, index[joint]


def _head(index: Index) -> Index:
    """Return a monomial without the factor of its last joint."""
    joint, _ = _last(index)
    return (*index[:joint], 0, *index[joint + 1 :])


def _tail(index: Index) -> Index:
    """Return the factor of the last joint alone."""
    joint, factor = _last(index)
    return (*[0] * joint, factor, *[0] * (len(index) - joint - 1))
