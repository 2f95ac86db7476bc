"""Harmonic forms in ball arithmetic: every result is a ball that holds the true value.

The balls are Arb's, through python-flint (extra ``proofs``). Its precision is global to the
process: it is set here and nowhere else, by `precision`, and put back.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qbound.extras import require
from qbound.forms.harmonic import HarmonicForm, Kind

if TYPE_CHECKING:
    from flint import arb

Array = NDArray[Any]


@contextmanager
def precision(bits: int) -> Iterator[None]:
    """Compute with balls of `bits` bits within a ``with``; not in the paper.

    Raises
    ------
    ImportError
        If python-flint is missing.
    """
    require("flint")
    from flint import ctx

    before = ctx.prec
    ctx.prec = bits
    try:
        yield
    finally:
        ctx.prec = before


def ball(value: Any) -> arb:
    """Return a number as a ball: a double is the binary fraction that it is, not a decimal."""
    from flint import arb

    return value if isinstance(value, arb) else arb(value)


def pi() -> arb:
    """Return pi at the precision at hand."""
    from flint import arb

    return arb.pi()


def interval(low: Any, high: Any) -> arb:
    """Return a ball that holds both ends and all between."""
    return ball(low).union(ball(high))


def turns(count: int) -> arb:
    """Return `count` full turns, rad."""
    return 2 * count * pi()


def below(value: arb) -> float:
    """Return a double that is certainly not above a ball."""
    return math.nextafter(float(value.lower()), -math.inf)


def above(value: arb) -> float:
    """Return a double that is certainly not below a ball."""
    return math.nextafter(float(value.upper()), math.inf)


def factor(kind: Kind, q: Any) -> list[Any]:
    """Return (1, cos q, sin q) or (1, q, q²) of a real or a complex ball."""
    return [1, q.cos(), q.sin()] if kind == "revolute" else [1, q, q * q]


def values(forms: HarmonicForm, q: Sequence[Any]) -> Array:
    """Enclose forms over a box, or at a point (eq. 29's sums, term by term).

    Parameters
    ----------
    forms : HarmonicForm, any shape
        Coefficients are rationals, balls or floats.
    q : sequence of arb
        One ball a joint; wide balls are a box.

    Returns
    -------
    ndarray of arb, shape forms.shape
    """
    result = forms.coefficients
    for kind, x in zip(reversed(forms.kinds), reversed(q), strict=True):
        result = np.dot(result, np.array(factor(kind, x), dtype=object))
    return np.asarray(result, dtype=object)


def along(forms: HarmonicForm, joint: int, q: Sequence[Any]) -> Array:
    """Return the coefficients along one joint, others held at `q`: (c0, a, b) of eq. (30).

    Returns
    -------
    ndarray of arb, shape forms.shape + (3,)
        The entry of `q` for the joint itself is not read.
    """
    first = forms.coefficients.ndim - len(forms.kinds)
    moved = np.moveaxis(forms.coefficients, first + joint, first)
    rest = [k for k in range(len(forms.kinds)) if k != joint]
    kinds = tuple(forms.kinds[k] for k in rest)
    return values(HarmonicForm(moved, kinds), [q[k] for k in rest])


def derivative(forms: HarmonicForm, joint: int) -> HarmonicForm:
    """Return the derivative along a joint: a harmonic form again."""
    axis = forms.coefficients.ndim - len(forms.kinds) + joint
    one, two, three = np.moveaxis(forms.coefficients, axis, 0)
    slope = (
        [0 * one, three, -two] if forms.kinds[joint] == "revolute" else [two, 2 * three, 0 * one]
    )
    return HarmonicForm(np.stack(slope, axis=axis), forms.kinds)


def gradient(forms: HarmonicForm) -> HarmonicForm:
    """Return the derivatives along every joint: shape forms.shape + (n,)."""
    slopes = [derivative(forms, j).coefficients for j in range(len(forms.kinds))]
    return HarmonicForm(np.stack(slopes, axis=len(forms.shape)), forms.kinds)


def magnitude(forms: HarmonicForm, reach: Sequence[float]) -> Array:
    """Bound the absolute value of each form over whole ranges, from above; doubles.

    Over all angles x A y with unit vectors x and y is at most the Frobenius norm of A: cosine and
    sine of one joint are one unit vector.

    Parameters
    ----------
    reach : sequence of float
        Largest absolute value of each joint; read for prismatic joints alone.
    """
    first = len(forms.shape)
    blocks = forms.coefficients * forms.coefficients
    for j, kind in enumerate(forms.kinds):
        one, two, three = np.moveaxis(blocks, first + j, 0)
        square = ball(reach[j]) ** 2
        parts = [one, two + three] if kind == "revolute" else [one, two * square, three * square**2]
        blocks = np.stack(parts, axis=first + j)
    roots = np.vectorize(_root, otypes=[object])(blocks)
    total = roots.sum(axis=tuple(range(first, roots.ndim)))
    return np.asarray(np.vectorize(above, otypes=[float])(total))


def _root(square: Any) -> arb:
    """Return the square root of a ball; its negative part is rounding and falls away."""
    return ball(square).nonnegative_part().sqrt()
