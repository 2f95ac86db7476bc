r"""The one algebraic object: a sum over products of (1, cos q, sin q) or (1, q, q²), one a joint.

Every coordinate of every point of a serial chain is such a sum, and so is the squared distance of
two points (a rotation keeps lengths). Both columns of the paper's eq. (29) and the clearance
of eq. (11) are therefore arrays of coefficients with one axis a joint, and evaluation, gradient,
restriction and Theorem 2's (a, b, c) are contractions of that array: of floats by one matrix
product, of SymPy expressions and of balls (python-flint) by the same rules entry by entry.

A form can also be written as a sum of waves: amplitudes, wave vectors, powers of sliding joints.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cspace.arguments import refuse_type
from cspace.arrays import Array
from cspace.forms.factors import FACTORS, Kind, basis, basis_slope

if TYPE_CHECKING:
    import sympy

__all__ = ["HarmonicForm", "Kind", "add_constant", "basis", "basis_slope", "times_function"]

NUMBERS = "biufcO"
"""Kinds of arrays that hold numbers: by NumPy's letters, and objects such as balls."""

Values = ArrayLike | Sequence[Any]
"""Joint values: floats, or objects such as balls and symbols."""


@dataclass(frozen=True, eq=False)
class HarmonicForm:
    r"""A form :math:`\beta(q) = \sum_k C_k \prod_j e_{k_j}(q_j)`, or a stack of such forms.

    Parameters
    ----------
    coefficients : ndarray, shape (..., 3, ..., 3)
        The last ``len(kinds)`` axes belong to the joints, each of length 3; axes before them stack
        forms (the three components of a vector, say). Floats; or SymPy expressions, rationals or
        balls (dtype object).
    kinds : tuple of {"revolute", "prismatic"}
        The factor of each joint: (1, cos q, sin q) or (1, q, q²), a row of `factors.FACTORS`.

    Raises
    ------
    ValueError
        If a joint has no axis of its own, a kind is unknown, or a coefficient is NaN, infinite or
        complex; the message names the place.

    Examples
    --------
    The form :math:`2 + \cos q_1 - 3 \sin q_1\, q_2` of a joint that turns and one that slides:

    >>> import numpy as np
    >>> from cspace import HarmonicForm
    >>> coefficients = np.zeros((3, 3))
    >>> coefficients[0, 0], coefficients[1, 0], coefficients[2, 1] = 2.0, 1.0, -3.0
    >>> form = HarmonicForm(coefficients, ("revolute", "prismatic"))
    >>> float(form([0.0, 5.0])), form.gradient([0.0, 5.0]).tolist()
    (3.0, [-15.0, 0.0])

    Forms of the same joints are added, and multiplied and divided by numbers:

    >>> float((2 * form - form / 2 + 1)([0.0, 5.0]))
    5.5

    Configurations are rows and need a column for each joint:

    >>> form([[0.0, 5.0], [np.pi, 5.0]]).round(12).tolist()
    [3.0, 1.0]
    >>> form(0.0)
    Traceback (most recent call last):
    ValueError: expected 2 joint values on the last axis, found a bare number
    """

    coefficients: Array
    kinds: tuple[Kind, ...]

    def __post_init__(self) -> None:
        """Refuse coefficients that cannot be a form's: wrong axes, kinds or numbers."""
        coefficients, kinds = (getattr(self, name) for name in ("coefficients", "kinds"))
        if not isinstance(coefficients, np.ndarray):
            object.__setattr__(self, "coefficients", np.asarray(coefficients))
        if isinstance(kinds, str) or not isinstance(kinds, Sequence):
            refuse_type("kinds", kinds, "one a joint, such as ('revolute', 'revolute')")
        n = len(kinds)
        for j, kind in enumerate(self.kinds):
            if kind not in FACTORS:
                raise ValueError(f"kinds[{j}]: {kind!r} is none of {', '.join(FACTORS)}")
        if self.coefficients.dtype.kind not in NUMBERS:
            refuse_type("coefficients", self.coefficients.tolist(), "numbers")
        if self.coefficients.shape[self._first :] != (3,) * n:
            raise ValueError(
                f"{n} joints need {n} last axes of length 3, found {self.coefficients.shape}"
            )
        if self.coefficients.dtype.kind == "c":
            raise ValueError("coefficients: complex numbers, where real ones are wanted")
        if self.coefficients.dtype.kind == "f" and not np.isfinite(self.coefficients).all():
            place = tuple(np.argwhere(~np.isfinite(self.coefficients))[0].tolist())
            raise ValueError(
                f"coefficients{list(place)} is {self.coefficients[place]}; finite numbers only"
            )

    @property
    def _first(self) -> int:
        """Axis of the first joint."""
        return self.coefficients.ndim - len(self.kinds)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the stack; ``()`` for one form."""
        return self.coefficients.shape[: self._first]

    def __getitem__(self, index: Any) -> HarmonicForm:
        """Take forms out of the stack."""
        inside = index if isinstance(index, tuple) else (index,)
        joints = (slice(None),) * len(self.kinds)
        return HarmonicForm(self.coefficients[(*inside, ..., *joints)], self.kinds)

    __array_ufunc__ = None
    """NumPy leaves ``array + form`` to the form."""

    def __add__(self, other: ArrayLike | HarmonicForm) -> HarmonicForm:
        """Add forms of the same joints, or a constant, one or an array of them, to each form."""
        if not isinstance(other, HarmonicForm):
            if not _is_numbers(other):
                return NotImplemented
            constant = np.broadcast_to(np.asarray(other), self.shape)
            return HarmonicForm(add_constant(self.coefficients, constant), self.kinds)
        if other.kinds != self.kinds:
            raise ValueError(f"forms of {self.kinds} and of {other.kinds} have no sum")
        return HarmonicForm(self.coefficients + other.coefficients, self.kinds)

    __radd__ = __add__

    def __sub__(self, other: ArrayLike | HarmonicForm) -> HarmonicForm:
        """Subtract forms of the same joints, or a constant from each form."""
        if isinstance(other, HarmonicForm):
            return self + -other
        return self + -np.asarray(other) if _is_numbers(other) else NotImplemented

    def __rsub__(self, constant: ArrayLike) -> HarmonicForm:
        """Subtract each form from a constant."""
        return -self + constant

    def __mul__(self, factor: ArrayLike) -> HarmonicForm:
        """Multiply each form by one number, or by its entry of an array of the stack's shape."""
        if isinstance(factor, HarmonicForm):  # cos² is not 1, cos or sin
            raise TypeError("a product of two forms is no harmonic form; multiply their values")
        if not _is_numbers(factor):
            return NotImplemented
        factor = np.asarray(factor)
        axes = (...,) + (None,) * len(self.kinds) * (factor.ndim > 0)
        return HarmonicForm(self.coefficients * factor[axes], self.kinds)

    __rmul__ = __mul__

    def __truediv__(self, divisor: ArrayLike) -> HarmonicForm:
        """Divide each form by one number, or by its entry of an array of the stack's shape."""
        if isinstance(divisor, HarmonicForm):
            raise TypeError("a quotient of two forms is no harmonic form; divide their values")
        if not _is_numbers(divisor):
            return NotImplemented
        if (np.asarray(divisor) == 0).any():
            raise ZeroDivisionError("a form divided by zero")
        return self * (1 / np.asarray(divisor))

    def __neg__(self) -> HarmonicForm:
        """Change the sign of each form."""
        return HarmonicForm(-self.coefficients, self.kinds)

    def dot(self, vector: ArrayLike) -> HarmonicForm:
        """Contract the first axis of the stack with a vector, or with the last axis of a matrix."""
        return HarmonicForm(np.tensordot(np.asarray(vector), self.coefficients, axes=1), self.kinds)

    def __call__(self, q: Values) -> Array:
        """Evaluate at configurations.

        Parameters
        ----------
        q : array_like, shape (..., n)
            Joint values, rad or length. Balls enclose the values over a box of configurations.

        Returns
        -------
        ndarray, shape (...) + self.shape
            Dtype object unless coefficients and joint values are floats.

        Raises
        ------
        ValueError
            If the last axis does not have one value for each joint, or a value is NaN, infinite or
            complex.
        """
        columns = self._columns(q)
        values = np.asarray(q)
        if values.dtype != object and not np.isfinite(values).all():
            raise ValueError("a joint value is NaN or infinite")
        factors = [basis(kind, x) for kind, x in zip(self.kinds, columns, strict=True)]
        return self.combined(factors, np.shape(columns[0]) if columns else ())

    def derivative(self, joint: int) -> HarmonicForm:
        """Return the derivative along a joint: a harmonic form again."""
        axis = self._first + joint
        slope = FACTORS[self.kinds[joint]].slope.T
        moved = np.tensordot(slope, self.coefficients, axes=([1], [axis]))
        return HarmonicForm(np.moveaxis(moved, 0, axis), self.kinds)

    @cached_property
    def derivatives(self) -> HarmonicForm:
        """The derivatives along every joint, a stack of shape self.shape + (n,)."""
        along = [self.derivative(j).coefficients for j in range(len(self.kinds))]
        return HarmonicForm(np.stack(along, axis=self._first), self.kinds)

    @cached_property
    def waves(self) -> Waves:
        """The form as a sum of waves; floats only."""
        return to_waves(self.coefficients, self.kinds)

    def gradient(self, q: Values) -> Array:
        """Return the derivatives along each joint, shape (...) + self.shape + (n,)."""
        return self.derivatives(q)

    def along(self, joint: int, q: Values) -> Array:
        """Return the coefficients of the one-joint form along `joint`, all others held at `q`.

        For a revolute joint these are (c0, a, b) of ``a cos q + b sin q + c0``: Theorem 2's a and
        b, and ``c = -c0`` (eq. 30).

        Returns
        -------
        ndarray, shape (...) + self.shape + (3,)
            Constant first. The entry of `q` for the joint itself is not read.
        """
        columns = self._columns(q)
        moved = np.moveaxis(self.coefficients, self._first + joint, self._first)
        kinds = self.kinds[:joint] + self.kinds[joint + 1 :]
        others = columns[:joint] + columns[joint + 1 :]
        factors = [basis(kind, x) for kind, x in zip(kinds, others, strict=True)]
        return HarmonicForm(moved, kinds).combined(factors, np.shape(columns[joint]))

    def size(self, reach: Sequence[float]) -> Array:
        """Bound the sum of the absolute values of all terms, each joint at most `reach` from 0.

        Rounding is at most a small part of this bound. Floats; shape self.shape.
        """
        factors = [
            np.array(FACTORS[kind].largest(x), dtype=float)
            for kind, x in zip(self.kinds, reach, strict=True)
        ]
        return HarmonicForm(np.abs(self.coefficients), self.kinds).combined(factors)

    def restrict(self, held: Mapping[int, float]) -> HarmonicForm:
        """Hold some joints at given values: the form in the joints that are left."""
        coefficients = self.coefficients
        for joint in sorted(held, reverse=True):  # from the last, so that earlier axes stay put
            factor = basis(self.kinds[joint], held[joint])
            coefficients = np.tensordot(coefficients, factor, axes=([self._first + joint], [0]))
        kinds = tuple(kind for j, kind in enumerate(self.kinds) if j not in held)
        return HarmonicForm(coefficients, kinds)

    def joints(self) -> tuple[int, ...]:
        """Return the joints that the form depends on, by coefficients that are not surely zero."""
        nonzero = np.argwhere(np.logical_not(self.coefficients == 0))
        return tuple(j for j in range(len(self.kinds)) if np.any(nonzero[:, self._first + j]))

    def symbolic(self, q: Sequence[sympy.Expr]) -> Any:
        """Return the form as a SymPy expression (a list of them, nested as the stack is).

        Parameters
        ----------
        q : sequence of sympy.Expr
            One symbol a joint.
        """
        from cspace.extras import require

        require("sympy")
        import sympy

        if self.shape:
            return [self[i].symbolic(q) for i in range(self.shape[0])]
        factors = [
            (sympy.S.One, *FACTORS[kind].functions(x))
            for kind, x in zip(self.kinds, q, strict=True)
        ]
        return sympy.Add(
            *(
                c * prod(factor[i] for factor, i in zip(factors, index, strict=True))
                for index, c in np.ndenumerate(self.coefficients)
                if c != 0
            )
        )

    def combined(self, factors: Sequence[Array], batch: tuple[int, ...] = ()) -> Array:
        """Contract every joint's axis with given values of its factor.

        Parameters
        ----------
        factors : sequence of ndarray, shape (..., 3)
            One a joint, as `basis` gives them.
        batch : tuple of int
            The shape (...) of each factor.

        Returns
        -------
        ndarray, shape (...) + self.shape
        """
        if any(x.dtype == object for x in (self.coefficients, *factors)):
            return self._nested(factors, batch)
        monomials = reduce(_outer, factors) if factors else np.ones((*batch, 1))
        matrix = self.coefficients.reshape(-1, monomials.shape[-1])
        values = monomials.reshape(-1, monomials.shape[-1]) @ matrix.T
        return values.reshape((*batch, *self.shape))

    def _nested(self, factors: Sequence[Array], batch: tuple[int, ...]) -> Array:
        """Contract the last joint first: over a box, nested products are narrower than sums."""
        result = np.broadcast_to(self.coefficients, (*batch, *self.coefficients.shape))
        for factor in reversed(factors):
            between = (1,) * (result.ndim - len(batch) - 1)
            result = (result * factor.reshape(*batch, *between, 3)).sum(axis=-1)
        return result

    def _columns(self, q: Values) -> list[Array]:
        """Split (..., n) joint values into n arrays of shape (...), of floats or of objects."""
        values, n = np.asarray(q), len(self.kinds)
        if values.dtype.kind not in NUMBERS:
            refuse_type("joint values", q, "numbers")
        if values.dtype.kind == "c":
            raise ValueError("joint values are real numbers, found complex ones")
        if values.dtype != object:
            values = values.astype(float)
        if values.shape[-1:] != (n,):
            found = values.shape[-1] if values.ndim else "a bare number"
            raise ValueError(
                f"expected {n} joint value{'s' * (n != 1)} on the last axis, found {found}"
            )
        return list(np.moveaxis(values, -1, 0))


def _is_numbers(value: object) -> bool:
    """Tell whether a value is a number or an array of numbers, balls and symbols included."""
    array = np.asarray(value)
    if array.dtype != object:
        return array.dtype.kind in NUMBERS
    return all(hasattr(x, "__mul__") and not isinstance(x, Sequence) for x in array.flat)


def _outer(left: Array, right: Array) -> Array:
    """Multiply (..., m) by (..., 3) into all products, (..., 3 m)."""
    products = left[..., :, None] * right[..., None, :]
    return products.reshape(*products.shape[:-2], 3 * left.shape[-1])


def times_function(coefficients: Array, axis: int, k: int, kind: Kind | None = None) -> Array:
    r"""Multiply coefficients of a form by one function :math:`e_k` of a joint.

    Parameters
    ----------
    axis : int
        Axis of the joint.
    k : int
        1 or 2.
    kind : {"revolute", "prismatic"}, optional
        Kind of the joint, if the form depends on it. The product must be of the first degree again.
        Parts of higher degree are left out, because they are zero up to rounding.
    """
    parts = np.moveaxis(coefficients, axis, 0)
    product = np.zeros_like(parts) if parts.dtype != object else parts * 0  # zeros of its type
    if kind is None:
        product[k] = parts[0]
    else:
        twice = FACTORS[kind].product[:, :, k]
        for m, i in np.argwhere(twice).tolist():
            product[m] = product[m] + parts[i] * int(twice[m, i]) / 2
    return np.asarray(np.moveaxis(product, 0, axis))


def add_constant(coefficients: Array, constant: ArrayLike) -> Array:
    """Add to the constant coefficient of each stacked form; `constant` has the stack's shape."""
    coefficients, constant = np.asarray(coefficients), np.asarray(constant)  # or one number
    result = coefficients.astype(np.result_type(coefficients, constant))
    constants: tuple[Any, ...] = (..., *(0,) * (coefficients.ndim - constant.ndim))
    result[constants] += constant
    return result


# --- waves ----------------------------------------------------------------------------------------


DROPPED = 1e-15
"""Amplitudes this small beside a form's largest are rounding."""


@dataclass(frozen=True, eq=False)
class Waves:
    r"""Forms as :math:`\sum_k \mathrm{Re}\,A_k e^{i w_k \cdot q} \prod_j q_j^{p_{kj}}`.

    Attributes
    ----------
    amplitudes : ndarray of complex, shape (..., m)
        Axes before the last stack forms.
    turns : ndarray of int, shape (m, n)
        The wave vectors w: -1, 0, 1 for a revolute joint, 0 for a prismatic one.
    powers : ndarray of int, shape (m, n)
        The exponents p: 0, 1, 2 for a prismatic joint, 0 for a revolute one.
    """

    amplitudes: Array
    turns: Array
    powers: Array


def to_waves(coefficients: Array, kinds: Sequence[Kind]) -> Waves:
    """Write forms as waves; of a wave and its complex conjugate one is kept.

    Parameters
    ----------
    coefficients, kinds
        Those of a `HarmonicForm` of floats.
    """
    rows, n = [FACTORS[kind] for kind in kinds], len(kinds)
    first = coefficients.ndim - n
    c = coefficients.astype(complex)
    for axis, row in enumerate(rows, start=first):
        c = np.moveaxis(np.tensordot(row.waves, c, axes=([1], [axis])), 0, axis)
    index = np.indices((3,) * n).reshape(n, -1)
    turns = np.array([row.turns[i] for row, i in zip(rows, index, strict=True)]).T
    powers = np.array([row.powers[i] for row, i in zip(rows, index, strict=True)]).T
    lead = np.array([next((x for x in row if x), 0) for row in turns])
    amplitudes = np.where(lead > 0, 2, 1) * c.reshape(*c.shape[:first], 3**n)
    size = np.abs(amplitudes)
    seen = (size > DROPPED * size.max(axis=-1, keepdims=True)).reshape(-1, len(lead)).any(axis=0)
    kept = (lead >= 0) & seen
    return Waves(amplitudes[..., kept], turns[kept], powers[kept])
