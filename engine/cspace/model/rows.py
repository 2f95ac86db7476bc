"""Types of the values in a robot file; the class of each table is made of these.

The classes stand beside what they describe (joints, shapes, boundaries); the JSON Schema of a robot
file and every refusal are derived from them. A `description` reads on after "is not" and "wanted:".
Modules with such classes do not import `annotations` from `__future__`, because msgspec would then
compile each annotation when the first file is read.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Any, Self

import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

from cspace.tolerances import TANGENT

LARGEST = 1e100
"""Largest number of a file: squares of lengths, and their products, must stay within floats."""

SMALLEST = 1e-100
"""Smallest number of a file but 0, for the same reason."""

Label = Annotated[str, Meta(min_length=1, description="a text of one letter or more")]
Number = Annotated[float, Meta(ge=-LARGEST, le=LARGEST)]
Size = Annotated[float, Meta(ge=0, le=LARGEST)]
Vector = Annotated[
    list[Number], Meta(min_length=3, max_length=3, description="a list of 3 numbers")
]
Direction = Annotated[
    list[float], Meta(min_length=3, max_length=3, description="a list of 3 numbers")
]
"""Of any length but 0."""


class Row(Struct, forbid_unknown_fields=True, omit_defaults=True):
    """A table of a robot file; keys with a default value may be left out, and are not written."""

    @classmethod
    def of(cls, item: Any) -> Self:
        """Return the table of an object whose attributes have the names of the keys."""
        return cls(**{key: plain(getattr(item, key)) for key in cls.__struct_fields__})


def unit_vector(vector: Sequence[float]) -> NDArray[np.float64]:
    """Give a vector the length 1; a vector of length 1 up to rounding is not changed."""
    if abs(math.hypot(*vector) - 1) <= TANGENT:
        return np.array(vector, dtype=float)
    largest = max(map(abs, vector))
    scaled = np.array(vector, dtype=float) / largest  # so that squares do not overflow
    return np.asarray(scaled / math.hypot(*scaled))


def quotient(value: float, scale: float) -> float:
    """Return the number that gives `value` when the reader multiplies it by the unit.

    A short number is taken if there is one (20 degrees stay 20), else one right to the last place.
    """
    exact = float(value) / scale
    short = (float(f"{exact:.{digits}g}") for digits in (15, 16))
    return next((x for x in short if x * scale == value), exact)


def plain(value: Any) -> Any:
    """Return an array as lists of floats, a tuple as a list, a text or truth value unchanged."""
    if isinstance(value, np.ndarray | list):
        return np.asarray(value, dtype=float).tolist()
    if isinstance(value, tuple):
        return list(value)
    return value if isinstance(value, str | bool) else float(value)
