r"""Harmonic forms: what every boundary function of a chain of joints is (eq. 29).

A joint that turns enters every coordinate of every point as ``c0 + a cos q + b sin q``, and a joint
that slides enters as ``c0 + a q``. So a coordinate is a sum of products with one factor for each
joint: 1, cos q or sin q of a joint that turns; 1, q or q² of a joint that slides. Such a sum is a
multilinear trigonometric polynomial, here called a harmonic form. The squared distance of two
points is a harmonic form too, because a rotation keeps lengths; only there a q² occurs.

A form is kept as the array of its coefficients, one axis for each joint. Values, slopes and the
a, b, c of Theorem 2 are sums over this array. They work for floats, for SymPy expressions and for
any other numbers that can be added and multiplied.

Examples
--------
The height of the paper's tool over its limit is the last line of eq. (29), with numbers
``11.18 + 25.98 cos q1 - 25 cos q1 sin q2 - 15 sin q1 - 25 sin q1 cos q2``. Rows belong to 1, cos q1
and sin q1, columns to 1, cos q2 and sin q2:

>>> from qbound import clearance, load_robot
>>> robot = load_robot("minervabot-v2")
>>> for row in clearance(robot, robot.boundary("B7")).coefficients.round(2).tolist():
...     print(row)
[11.18, 0.0, 0.0]
[25.98, 0.0, -25.0]
[-15.0, -25.0, 0.0]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Array, cos_sin

Kind = Literal["revolute", "prismatic"]
"""A joint turns or slides."""

DERIVATIVES = {
    "revolute": np.array([[0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "prismatic": np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]]),
}
"""The matrix D with ``e'(q) = D e(q)`` for the basis e of a joint."""


def basis(kind: Kind, q: ArrayLike) -> Array:
    """Return (1, cos q, sin q) of a joint that turns, or (1, q, q²) of a joint that slides.

    Parameters
    ----------
    kind : {"revolute", "prismatic"}
    q : array_like, shape (...)
        Joint values, rad or length, or symbols.

    Returns
    -------
    ndarray, shape (..., 3)

    Examples
    --------
    >>> from qbound.forms import basis
    >>> basis("revolute", np.pi).round(9).tolist(), basis("prismatic", 3.0).tolist()
    ([1.0, -1.0, 0.0], [1.0, 3.0, 9.0])
    """
    q = np.asarray(q)
    first, second = cos_sin(q) if kind == "revolute" else (q, q * q)
    return np.stack([np.ones_like(first), first, second], axis=-1)


class JointForm(NamedTuple):
    """A form in one joint: ``c0 + a cos q + b sin q``, or ``c0 + a q + b q²`` if the joint slides.

    It vanishes where ``a cos q + b sin q = c`` with c = -c0: the equation of Theorem 2 (eq. 30).
    """

    c0: Array
    a: Array
    b: Array


@dataclass(frozen=True, eq=False)
class HarmonicForm:
    r"""A form :math:`\beta(q) = \sum_k C_k \prod_j e_{k_j}(q_j)`, or a stack of such forms.

    C is the array of coefficients and :math:`e_0, e_1, e_2` is the `basis` of a joint. The index k
    has one entry :math:`k_j` for each joint j: 0, 1 or 2.

    Parameters
    ----------
    coefficients : ndarray, shape (*stack, 3, ..., 3)
        The last axes belong to the joints, one each. The axes before them stack forms: the three
        components of a vector have the stack (3,), a single form has the stack ().
    kinds : tuple of {"revolute", "prismatic"}
        Whether each joint turns or slides.

    Raises
    ------
    ValueError
        If the last axes do not fit the joints. Calls and methods raise it if the joint values are
        not one for each joint.

    Examples
    --------
    The form :math:`2 + \cos q_1 - 3\,q_2 \sin q_1` of a joint that turns and one that slides, its
    value and its slopes at (0, 5):

    >>> from qbound import HarmonicForm
    >>> coefficients = np.zeros((3, 3))
    >>> coefficients[0, 0], coefficients[1, 0], coefficients[2, 1] = 2.0, 1.0, -3.0
    >>> form = HarmonicForm(coefficients, ("revolute", "prismatic"))
    >>> float(form([0.0, 5.0])), form.gradient([0.0, 5.0]).tolist()
    (3.0, [-15.0, 0.0])
    """

    coefficients: Array
    kinds: tuple[Kind, ...]

    def __post_init__(self) -> None:
        """Check the shape."""
        n = len(self.kinds)
        if self.coefficients.shape[self.coefficients.ndim - n :] != (3,) * n:
            raise ValueError(
                f"{n} joints need {n} last axes of length 3, found {self.coefficients.shape}"
            )

    @property
    def stack(self) -> tuple[int, ...]:
        """Shape of the stack of forms; ``()`` for a single form."""
        return self.coefficients.shape[: self.coefficients.ndim - len(self.kinds)]

    def __call__(self, q: ArrayLike) -> Array:
        """Return the values at configurations.

        Parameters
        ----------
        q : array_like, shape (..., n)
            Joint values, rad or length, or symbols.

        Returns
        -------
        ndarray, shape (..., *stack)
        """
        values = _joint_values(q, len(self.kinds))
        products = np.ones((*values.shape[:-1], 1), dtype=int)
        for j, kind in enumerate(self.kinds):
            # All products with one factor for each joint so far, in the order of the coefficients:
            # the factor of the last joint changes first.
            factor = basis(kind, values[..., j])
            products = products[..., :, None] * factor[..., None, :]
            products = products.reshape((*values.shape[:-1], 3 ** (j + 1)))
        coefficients = self.coefficients.reshape((prod(self.stack), 3 ** len(self.kinds)))
        return np.asarray(products @ coefficients.T).reshape((*values.shape[:-1], *self.stack))

    def derivative(self, joint: int) -> HarmonicForm:
        """Return the derivative along one joint: a form again.

        Parameters
        ----------
        joint : int
            Number of the joint, from 0.

        Examples
        --------
        >>> from qbound import HarmonicForm
        >>> sine = HarmonicForm(np.array([0.0, 0.0, 1.0]), ("revolute",))
        >>> sine.derivative(0).coefficients.tolist()
        [0.0, 1.0, 0.0]
        """
        axis = len(self.stack) + joint
        matrix = DERIVATIVES[self.kinds[joint]]
        moved = np.tensordot(self.coefficients, matrix, axes=([axis], [0]))
        return HarmonicForm(np.moveaxis(moved, -1, axis), self.kinds)

    def gradient(self, q: ArrayLike) -> Array:
        """Return the derivatives along each joint at configurations, shape ``(..., *stack, n)``.

        Examples
        --------
        >>> from qbound import HarmonicForm
        >>> square = HarmonicForm(np.array([0.0, 0.0, 1.0]), ("prismatic",))
        >>> square.gradient([[1.0], [2.0]]).tolist()
        [[2.0], [4.0]]
        """
        return np.stack([self.derivative(j)(q) for j in range(len(self.kinds))], axis=-1)

    def hessian(self, q: ArrayLike) -> Array:
        """Return the second derivatives at configurations, shape ``(..., *stack, n, n)``.

        Examples
        --------
        >>> from qbound import HarmonicForm
        >>> HarmonicForm(np.array([0.0, 0.0, 1.0]), ("prismatic",)).hessian([5.0]).tolist()
        [[2.0]]
        """
        return np.stack([self.derivative(j).gradient(q) for j in range(len(self.kinds))], axis=-1)

    def along(self, joint: int, q: ArrayLike) -> JointForm:
        """Return the form in one joint, the other joints held: Theorem 2's a, b and -c (eq. 30).

        Parameters
        ----------
        joint : int
            The joint that moves, from 0.
        q : array_like, shape (..., n)
            Values of the joints; the value of the joint that moves is not read.

        Returns
        -------
        JointForm
            c0, a, b, each of shape ``(..., *stack)``.

        Examples
        --------
        The height of the paper's tool over its limit (``beta_{7,3}``) at q1 = 0, as a form in q2:

        >>> from qbound import clearance, load_robot
        >>> robot = load_robot("minervabot-v2")
        >>> c0, a, b = clearance(robot, robot.boundary("B7")).along(1, [0.0, 0.0])
        >>> float(c0.round(9)), float(a), float(b)
        (37.16, 0.0, -25.0)
        """
        others = [j for j in range(len(self.kinds)) if j != joint]
        moved = np.moveaxis(self.coefficients, len(self.stack) + joint, len(self.stack))
        held = HarmonicForm(moved, tuple(self.kinds[j] for j in others))
        found = held(_joint_values(q, len(self.kinds))[..., others])
        return JointForm(found[..., 0], found[..., 1], found[..., 2])

    def joints(self) -> tuple[int, ...]:
        """Return the joints on which the form depends: each has a coefficient that is not zero.

        Examples
        --------
        >>> from qbound import load_robot, pair_vector
        >>> robot = load_robot("minervabot-v2")
        >>> pair_vector(robot, robot.boundary("B3")).joints()
        (1,)
        """
        # One row (k_1, ..., k_n) for each coefficient; k_j is 0 where joint j has the factor 1.
        nonzero = np.argwhere(np.logical_not(self.coefficients == 0))[:, len(self.stack) :]
        return tuple(j for j in range(len(self.kinds)) if np.any(nonzero[:, j]))

    def symbolic(self, q: Sequence[Any]) -> Any:
        """Return the form as a SymPy expression in the joint values; a stack as a list of them.

        Examples
        --------
        >>> from qbound import HarmonicForm
        >>> import sympy
        >>> form = HarmonicForm(np.array([1, 0, 2]), ("revolute",))
        >>> form.symbolic([sympy.Symbol("q")])
        2*sin(q) + 1
        """
        import sympy

        if self.stack:
            return [self[i].symbolic(q) for i in range(self.stack[0])]
        factors = [basis(k, np.array(x, dtype=object)) for k, x in zip(self.kinds, q, strict=True)]
        terms = []
        for index, coefficient in np.ndenumerate(self.coefficients):
            if coefficient != 0:
                parts = [factors[j][i] for j, i in enumerate(index)]
                terms.append(sympy.Mul(coefficient, *parts))
        return sympy.Add(*terms)

    # Forms of the same joints are added, and multiplied by numbers.

    __array_ufunc__ = None  # NumPy leaves ``array + form`` to the form

    def __getitem__(self, index: Any) -> HarmonicForm:
        """Return forms of the stack, such as ``vector[0]``."""
        return HarmonicForm(self.coefficients[index], self.kinds)

    def __neg__(self) -> HarmonicForm:
        """Change the sign."""
        return HarmonicForm(-self.coefficients, self.kinds)

    def __add__(self, other: ArrayLike | HarmonicForm) -> HarmonicForm:
        """Add a form, or a number to each form of the stack."""
        if isinstance(other, HarmonicForm):
            return HarmonicForm(self.coefficients + other.coefficients, self.kinds)
        number = np.asarray(other, dtype=np.result_type(self.coefficients, np.asarray(other)))
        return self + constant(np.broadcast_to(number, self.stack), self.kinds)

    def __sub__(self, other: ArrayLike | HarmonicForm) -> HarmonicForm:
        """Subtract a form, or a number from each form of the stack."""
        return self + (-other if isinstance(other, HarmonicForm) else -np.asarray(other))

    def __mul__(self, factor: Any) -> HarmonicForm:
        """Multiply by a number."""
        return HarmonicForm(self.coefficients * factor, self.kinds)

    __radd__ = __add__
    __rmul__ = __mul__

    def dot(self, matrix: ArrayLike) -> HarmonicForm:
        """Multiply a stack that is a vector: ``matrix @ form``, or ``vector . form``.

        Parameters
        ----------
        matrix : array_like, shape (m,) or (k, m)
            For a form with the stack (m,). The result is a single form, or has the stack (k,).

        Examples
        --------
        >>> from qbound.forms import constant
        >>> constant([1.0, 2.0], ("revolute",)).dot([3.0, 4.0])([0.0]).tolist()
        11.0
        """
        coefficients = np.tensordot(np.asarray(matrix), self.coefficients, axes=1)
        return HarmonicForm(np.asarray(coefficients), self.kinds)


def constant(values: ArrayLike, kinds: tuple[Kind, ...]) -> HarmonicForm:
    """Return forms that are the same at every configuration; the stack has the shape of `values`.

    Examples
    --------
    >>> from qbound.forms import constant
    >>> constant([1.0, 2.0], ("revolute",))([0.3]).tolist()
    [1.0, 2.0]
    """
    array = np.asarray(values)
    coefficients = np.zeros(array.shape + (3,) * len(kinds), dtype=array.dtype)
    coefficients.reshape(*array.shape, -1)[..., 0] = array  # those of the factors 1
    return HarmonicForm(coefficients, kinds)


def combine(joint: int, c0: HarmonicForm, a: HarmonicForm, b: HarmonicForm) -> HarmonicForm:
    """Return ``c0 + a cos q + b sin q``, or ``c0 + a q + b q²``, of three forms.

    Parameters
    ----------
    joint : int
        The joint of q; c0, a and b do not depend on it.

    Examples
    --------
    >>> from qbound.forms import combine, constant
    >>> one, two = (constant(x, ("prismatic",)) for x in (1.0, 2.0))
    >>> float(combine(0, one, two, one)([3.0]))
    16.0
    """
    axis = len(c0.stack) + joint
    # A form that does not depend on q has coefficients of the factor 1 only: index 0 of its axis.
    parts = [np.take(form.coefficients, 0, axis=axis) for form in (c0, a, b)]
    return HarmonicForm(np.stack(parts, axis=axis), c0.kinds)


def stacked(forms: Sequence[HarmonicForm], kinds: tuple[Kind, ...]) -> HarmonicForm:
    """Put single forms of the same joints in one stack, shape (m,); there may be none.

    Examples
    --------
    >>> from qbound.forms import constant, stacked
    >>> one, two = (constant(x, ("revolute",)) for x in (1.0, 2.0))
    >>> stacked([one, two], one.kinds)([0.0]).tolist()
    [1.0, 2.0]
    """
    arrays = np.array([form.coefficients for form in forms])
    return HarmonicForm(arrays.reshape(-1, *(3,) * len(kinds)), kinds)


def _joint_values(q: ArrayLike, n: int) -> Array:
    """Return (..., n) joint values as floats or symbols."""
    values = np.asarray(q)
    if values.shape[-1:] != (n,):
        raise ValueError(f"expected {n} joint values on the last axis, found {values.shape}")
    return values if values.dtype == object else values.astype(float)
