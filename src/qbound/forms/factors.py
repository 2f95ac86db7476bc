"""The factor that one joint puts into a harmonic form: one row of a table for each kind of joint.

All that tells a revolute from a prismatic joint in the algebra of forms stands here, for floats,
SymPy expressions and balls alike; a new kind of joint is a new row.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arrays import Array

Kind = Literal["revolute", "prismatic"]


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
        A row marks functions whose squares add up to 1, or to their bound's square.
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
    """Return cosine and sine by the library that the number comes from; an array's entry by entry.

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
        slope=np.array([[0, 0, 0], [0, 0, -1], [0, 1, 0]]),
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
        slope=np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]]),
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


def basis(kind: Kind, q: ArrayLike) -> Array:
    """Return (1, cos q, sin q) or (1, q, q²), shape (..., 3)."""
    q = np.asarray(q)
    return np.stack([np.ones_like(q), *FACTORS[kind].functions(q)], axis=-1)


def basis_slope(kind: Kind, q: ArrayLike) -> Array:
    """Return the derivative of `basis`, shape (..., 3)."""
    return np.asarray(basis(kind, q) @ FACTORS[kind].slope.T)


def basis_and_slope(kind: Kind, q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return `basis` and `basis_slope` of floats in one array, shape (..., 2, 3)."""
    found = np.empty((*q.shape, 2, 3))
    found[..., 0, 0] = 1.0
    found[..., 0, 1], found[..., 0, 2] = FACTORS[kind].functions(q)
    found[..., 1, :] = found[..., 0, :] @ FACTORS[kind].slope.T
    return found
