"""The one algebraic object: a sum over products of (1, cos q, sin q) or (1, q, q²), one a joint.

Every coordinate of every point of a serial chain is such a sum, and so is the squared distance of
two points (a rotation keeps lengths). Both columns of the paper's eq. (29) and the clearance
of eq. (11) are therefore arrays of coefficients with one axis a joint, and evaluation, gradient,
restriction and Theorem 2's (a, b, c) are contractions of that array.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.extras import require

if TYPE_CHECKING:
    import sympy

Kind = Literal["revolute", "prismatic"]
Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class HarmonicForm:
    r"""A form :math:`\beta(q) = \sum_k C_k \prod_j e_{k_j}(q_j)`, or a stack of such forms.

    Parameters
    ----------
    coefficients : ndarray, shape (..., 3, ..., 3)
        The last ``len(kinds)`` axes belong to the joints, each of length 3; axes before them stack
        forms (the three components of a vector, say). Floats, or SymPy expressions (dtype object).
    kinds : tuple of {"revolute", "prismatic"}
        The factor of each joint: (1, cos q, sin q) or (1, q, q²).
    """

    coefficients: Array
    kinds: tuple[Kind, ...]

    def __post_init__(self) -> None:
        """Refuse an array whose joint axes do not match the kinds."""
        n = len(self.kinds)
        if self.coefficients.shape[self.coefficients.ndim - n :] != (3,) * n:
            raise ValueError(
                f"{n} joints need {n} last axes of length 3, found {self.coefficients.shape}"
            )

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the stack; ``()`` for one form."""
        return self.coefficients.shape[: self.coefficients.ndim - len(self.kinds)]

    def __getitem__(self, index: Any) -> HarmonicForm:
        """Take forms out of the stack."""
        inside = index if isinstance(index, tuple) else (index,)
        joints = (slice(None),) * len(self.kinds)
        return HarmonicForm(self.coefficients[(*inside, ..., *joints)], self.kinds)

    def __add__(self, constant: ArrayLike) -> HarmonicForm:
        """Add a constant, of the stack's shape, to each form."""
        return HarmonicForm(add_constant(self.coefficients, constant), self.kinds)

    def __sub__(self, constant: ArrayLike) -> HarmonicForm:
        """Subtract a constant, of the stack's shape, from each form."""
        return self + -np.asarray(constant)

    def __neg__(self) -> HarmonicForm:
        """Change the sign of each form."""
        return HarmonicForm(-self.coefficients, self.kinds)

    def dot(self, vector: ArrayLike) -> HarmonicForm:
        """Contract the first axis of the stack with a vector, or with the last axis of a matrix."""
        return HarmonicForm(np.tensordot(np.asarray(vector), self.coefficients, axes=1), self.kinds)

    def __call__(self, q: ArrayLike) -> Array:
        """Evaluate at configurations as one matrix product.

        Parameters
        ----------
        q : array_like, shape (..., n)
            Joint values, rad or length.

        Returns
        -------
        ndarray, shape (...) + self.shape
        """
        columns = self._columns(q)
        return self._combine([basis(kind, x) for kind, x in zip(self.kinds, columns, strict=True)])

    def gradient(self, q: ArrayLike) -> Array:
        """Return the derivatives along each joint, shape (...) + self.shape + (n,)."""
        columns = self._columns(q)
        factors = [basis(kind, x) for kind, x in zip(self.kinds, columns, strict=True)]
        slopes = [basis_slope(kind, x) for kind, x in zip(self.kinds, columns, strict=True)]
        return np.stack(
            [
                self._combine([*factors[:j], slopes[j], *factors[j + 1 :]])
                for j in range(len(self.kinds))
            ],
            axis=-1,
        )

    def along(self, joint: int, q: ArrayLike) -> Array:
        """Return the coefficients of the one-joint form along `joint`, all others held at `q`.

        For a revolute joint these are (c0, a, b) of ``a cos q + b sin q + c0``: Theorem 2's a and
        b, and ``c = -c0`` (eq. 30).

        Returns
        -------
        ndarray, shape (...) + self.shape + (3,)
            Constant first. The entry of `q` for the joint itself is not read.
        """
        columns = self._columns(q)
        factors = [basis(kind, x) for kind, x in zip(self.kinds, columns, strict=True)]
        unit = np.eye(3)
        picks = [np.broadcast_to(unit[i], (*np.shape(columns[0]), 3)) for i in range(3)]
        return np.stack(
            [self._combine([*factors[:joint], pick, *factors[joint + 1 :]]) for pick in picks],
            axis=-1,
        )

    def restrict(self, held: Mapping[int, float]) -> HarmonicForm:
        """Hold some joints at given values: the form in the joints that are left."""
        coefficients = self.coefficients
        first = coefficients.ndim - len(self.kinds)
        for joint in sorted(held, reverse=True):  # from the last, so that earlier axes stay put
            factor = basis(self.kinds[joint], held[joint])
            coefficients = np.tensordot(coefficients, factor, axes=([first + joint], [0]))
        kinds = tuple(kind for j, kind in enumerate(self.kinds) if j not in held)
        return HarmonicForm(coefficients, kinds)

    def joints(self) -> tuple[int, ...]:
        """Return the joints that the form depends on, by non-zero coefficients."""
        nonzero = np.argwhere(self.coefficients != 0)
        first = self.coefficients.ndim - len(self.kinds)
        return tuple(j for j in range(len(self.kinds)) if np.any(nonzero[:, first + j]))

    def symbolic(self, q: Sequence[sympy.Expr]) -> Any:
        """Return the form as a SymPy expression (a list of them, nested as the stack is).

        Parameters
        ----------
        q : sequence of sympy.Expr
            One symbol a joint.
        """
        require("sympy")
        import sympy

        if self.shape:
            return [self[i].symbolic(q) for i in range(self.shape[0])]
        factors = [
            (sympy.S.One, sympy.cos(x), sympy.sin(x)) if kind == "revolute" else (1, x, x**2)
            for kind, x in zip(self.kinds, q, strict=True)
        ]
        return sympy.Add(
            *(
                c * sympy.Mul(*(factor[i] for factor, i in zip(factors, index, strict=True)))
                for index, c in np.ndenumerate(self.coefficients)
                if c != 0
            )
        )

    def _columns(self, q: ArrayLike) -> list[Array]:
        """Split (..., n) joint values into n float arrays of shape (...)."""
        values, n = np.asarray(q, dtype=float), len(self.kinds)
        if values.shape[-1:] != (n,):
            found = values.shape[-1] if values.ndim else "a bare number"
            raise ValueError(
                f"expected {n} joint value{'s' * (n != 1)} on the last axis, found {found}"
            )
        return list(np.moveaxis(values, -1, 0))

    def _combine(self, factors: Sequence[Array]) -> Array:
        """Contract every joint axis with its factor of shape (..., 3)."""
        monomials = reduce(_outer, factors, np.ones(1))
        matrix = self.coefficients.reshape(*self.shape, 3 ** len(self.kinds))
        return np.tensordot(monomials, matrix, axes=([-1], [-1]))


def _outer(left: Array, right: Array) -> Array:
    """Multiply (..., m) by (..., 3) into all products, (..., 3 m)."""
    products = left[..., :, None] * right[..., None, :]
    return products.reshape(*products.shape[:-2], 3 * left.shape[-1])


def add_constant(coefficients: Array, constant: ArrayLike) -> Array:
    """Add to the constant coefficient of each stacked form; `constant` has the stack's shape."""
    constant = np.asarray(constant)
    result = coefficients.astype(np.result_type(coefficients, constant))
    constants: tuple[Any, ...] = (..., *(0,) * (coefficients.ndim - constant.ndim))
    result[constants] += constant
    return result


def basis(kind: Kind, q: ArrayLike) -> Array:
    """Return (1, cos q, sin q) or (1, q, q²), shape (..., 3)."""
    q = np.asarray(q)
    if kind == "revolute":
        return np.stack([np.ones_like(q), np.cos(q), np.sin(q)], axis=-1)
    return np.stack([np.ones_like(q), q, q * q], axis=-1)


def basis_slope(kind: Kind, q: ArrayLike) -> Array:
    """Return the derivative of `basis`, shape (..., 3)."""
    q = np.asarray(q)
    if kind == "revolute":
        return np.stack([np.zeros_like(q), -np.sin(q), np.cos(q)], axis=-1)
    return np.stack([np.zeros_like(q), np.ones_like(q), 2 * q], axis=-1)
