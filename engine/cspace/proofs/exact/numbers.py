"""Numbers with a proved error: balls.

The balls are Arb's, through python-flint; a `HarmonicForm` takes them as it takes floats. Precision
is global to the process: it is set within a ``with`` only, by `precision`.
"""

import math
from collections.abc import Sequence
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

import numpy as np

from cspace.arrays import Array
from cspace.forms.factors import FACTORS
from qbound.forms import Kind

if TYPE_CHECKING:
    import flint

    arb = flint.arb
else:
    arb = Any  # only for annotations: python-flint is loaded when first called


def precision(bits: int) -> AbstractContextManager[None]:
    """Return python-flint's context in which balls have `bits` bits."""
    from flint import ctx

    context: AbstractContextManager[None] = ctx.workprec(bits)
    return context


def ball(value: Any) -> arb:
    """Return a number as a ball: a double is the binary fraction that it is, not a decimal."""
    from flint import arb

    return value if isinstance(value, arb) else arb(value)


def balls(numbers: Any) -> Array:
    """Return an array of numbers as an array of balls."""
    return np.asarray(np.vectorize(ball, otypes=[object])(numbers))


def pi() -> arb:
    """Return pi at the precision at hand."""
    from flint import arb

    return arb.pi()


def turns(count: int) -> arb:
    """Return `count` full turns, rad."""
    return 2 * count * pi()


def below(value: arb) -> float:
    """Return a double that is certainly not above a ball."""
    return math.nextafter(float(value.lower()), -math.inf)


def above(value: arb) -> float:
    """Return a double that is certainly not below a ball."""
    return math.nextafter(float(value.upper()), math.inf)


def line_roots(kind: Kind, c: Sequence[arb] | Array) -> list[arb] | None:
    """Solve c0 + c1 cos v + c2 sin v = 0, or c0 + c1 v + c2 v² = 0; None if perhaps double."""
    c0, c1, c2 = c
    slides = kind == "prismatic"
    if slides and c2.is_zero():
        return [-c0 / c1] if not c1.contains(0) else ([] if not c0.contains(0) else None)
    square = FACTORS[kind].discriminant(c)
    if square < 0:
        return []
    if not square > 0 or (slides and c2.contains(0)):
        return None
    if slides:
        return [(-c1 + sign * square.sqrt()) / (2 * c2) for sign in (-1, 1)]
    theta, alpha = type(c0).atan2(c2, c1), type(c0).atan2(square.sqrt(), -c0)
    return [theta - alpha, theta + alpha]
