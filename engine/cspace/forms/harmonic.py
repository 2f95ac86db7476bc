"""What the engine asks of harmonic forms, and no chapter of the paper needs.

A form is the library's: `qbound.forms.HarmonicForm`. Here are its restriction to fewer joints, a
bound of its size, its waves (amplitudes, wave vectors, powers of slides), and sums over factors
that are given, such as those of balls.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Array
from cspace.forms.factors import FACTORS
from qbound.forms import HarmonicForm, Kind, basis


def refuse_no_form(form: HarmonicForm) -> None:
    """Raise a ValueError, which names the place, for unknown kinds and for what are no numbers."""
    for j, kind in enumerate(form.kinds):
        if kind not in FACTORS:
            raise ValueError(f"kinds[{j}]: {kind!r} is none of {', '.join(FACTORS)}")
    if form.coefficients.dtype.kind == "c":
        raise ValueError("coefficients: complex numbers, where real ones are wanted")
    if form.coefficients.dtype.kind == "f" and not np.isfinite(form.coefficients).all():
        place = tuple(np.argwhere(~np.isfinite(form.coefficients))[0].tolist())
        text = f"coefficients{list(place)} is {form.coefficients[place]}; finite numbers only"
        raise ValueError(text)


def restrict(form: HarmonicForm, held: Mapping[int, float]) -> HarmonicForm:
    """Hold some joints at given values: the form in the joints that are left.

    Examples
    --------
    >>> from cspace import clearance, load_robot
    >>> restrict(clearance(load_robot("minervabot-v2"), "B7"), {0: 0.0}).coefficients.round(
    ...     2
    ... ).tolist()
    [37.16, 0.0, -25.0]
    """
    coefficients, first = form.coefficients, len(form.stack)
    for joint in sorted(held, reverse=True):  # from the last, so that earlier axes stay put
        factor = basis(form.kinds[joint], held[joint])
        coefficients = np.tensordot(coefficients, factor, axes=([first + joint], [0]))
    kinds = tuple(kind for j, kind in enumerate(form.kinds) if j not in held)
    return HarmonicForm(np.asarray(coefficients), kinds)


_DERIVATIVES: WeakKeyDictionary[HarmonicForm, HarmonicForm] = WeakKeyDictionary()
_WAVES: WeakKeyDictionary[HarmonicForm, Waves] = WeakKeyDictionary()


def derivatives(form: HarmonicForm) -> HarmonicForm:
    """Return the derivatives along every joint, a stack of shape ``(*form.stack, n)``; kept."""
    if form not in _DERIVATIVES:
        along = [form.derivative(j).coefficients for j in range(len(form.kinds))]
        _DERIVATIVES[form] = HarmonicForm(np.stack(along, axis=len(form.stack)), form.kinds)
    return _DERIVATIVES[form]


def size(form: HarmonicForm, reach: Sequence[float]) -> Array:
    """Bound the sum of the absolute values of all terms, each joint at most `reach` from 0.

    Rounding is at most a small part of this bound. Floats; shape ``form.stack``.
    """
    factors = [
        np.array(FACTORS[kind].largest(x), dtype=float)
        for kind, x in zip(form.kinds, reach, strict=True)
    ]
    return combined(HarmonicForm(np.abs(form.coefficients), form.kinds), factors)


def combined(form: HarmonicForm, factors: Sequence[Array], batch: tuple[int, ...] = ()) -> Array:
    """Contract every joint's axis with given values of its factor.

    Parameters
    ----------
    factors : sequence of ndarray, shape (..., 3)
        One a joint, as `qbound.forms.basis` gives them.
    batch : tuple of int
        The shape (...) of each factor.

    Returns
    -------
    ndarray, shape ``(..., *form.stack)``
    """
    if any(x.dtype == object for x in (form.coefficients, *factors)):
        return _nested(form, factors, batch)
    monomials = reduce(_outer, factors) if factors else np.ones((*batch, 1))
    matrix = form.coefficients.reshape(-1, monomials.shape[-1])
    values = monomials.reshape(-1, monomials.shape[-1]) @ matrix.T
    return values.reshape((*batch, *form.stack))


def over(form: HarmonicForm, q: Sequence[Any] | Array) -> Array:
    """Return the values over boxes of balls, shape (..., n): narrower than a plain call's."""
    columns = list(np.moveaxis(np.asarray(q), -1, 0))
    factors = [basis(kind, x) for kind, x in zip(form.kinds, columns, strict=True)]
    return combined(form, factors, np.shape(columns[0]) if columns else ())


def _nested(form: HarmonicForm, factors: Sequence[Array], batch: tuple[int, ...]) -> Array:
    """Contract the last joint first: over a box, nested products are narrower than sums."""
    result = np.broadcast_to(form.coefficients, (*batch, *form.coefficients.shape))
    for factor in reversed(factors):
        between = (1,) * (result.ndim - len(batch) - 1)
        result = (result * factor.reshape(*batch, *between, 3)).sum(axis=-1)
    return result


def _outer(left: Array, right: Array) -> Array:
    """Multiply (..., m) by (..., 3) into all products, (..., 3 m)."""
    products = left[..., :, None] * right[..., None, :]
    return products.reshape(*products.shape[:-2], 3 * left.shape[-1])


def add_constant(coefficients: Array, constant: ArrayLike) -> Array:
    """Add to the constant coefficient of each stacked form; `constant` has the stack's shape."""
    coefficients, constant = np.asarray(coefficients), np.asarray(constant)  # or one number
    result = coefficients.astype(np.result_type(coefficients, constant))
    constants: tuple[Any, ...] = (..., *(0,) * (coefficients.ndim - constant.ndim))
    result[constants] += constant
    return result


# --- waves ----------------------------------------------------------------------------------------


DROPPED = 1e-15
"""Amplitudes this small beside a form's largest of the same unit are rounding."""


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


def waves(form: HarmonicForm) -> Waves:
    """Return a form of floats as waves; of a wave and its complex conjugate one is kept."""
    if form not in _WAVES:
        _WAVES[form] = _to_waves(form.coefficients, form.kinds)
    return _WAVES[form]


def _to_waves(coefficients: Array, kinds: Sequence[Kind]) -> Waves:
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
    alike = np.unique(powers, axis=0, return_inverse=True)[1].reshape(-1)
    largest = np.stack(
        [size[..., alike == k].max(axis=-1) for k in range(alike.max() + 1)], axis=-1
    )
    seen = (size > DROPPED * largest[..., alike]).reshape(-1, len(lead)).any(axis=0)
    kept = (lead >= 0) & seen
    return Waves(amplitudes[..., kept], turns[kept], powers[kept])
