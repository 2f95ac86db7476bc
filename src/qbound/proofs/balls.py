"""Balls: intervals of numbers, with outward rounding.

The balls are Arb's, through python-flint; a `HarmonicForm` takes them as it takes floats. Precision
is global to the process: it is set within a ``with`` only, by `precision`.
"""

from __future__ import annotations

import math
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any

import numpy as np

from qbound.arrays import Array

if TYPE_CHECKING:
    import flint

    arb = flint.arb
else:
    arb = Any  # for annotations alone: python-flint loads where it is called


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
