"""What the keys of a robot file may hold. A table of a file is a class that is made of these.

The classes stand beside what they describe (joints, shapes, boundaries); the JSON Schema of a robot
file and every refusal are derived from them. A `description` reads on after "is not" and "wanted:".
Where they stand, annotations are no texts (no `annotations` of the future): msgspec would compile
each, when the first file is read.
"""

import math
from collections.abc import Sequence
from typing import Annotated, Any, Self

import numpy as np
from msgspec import Meta, Struct
from numpy.typing import NDArray

from qbound.tolerances import TANGENT

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
    """A table of a robot file; what has a default may be left out, and is when it is written."""

    @classmethod
    def of(cls, item: Any) -> Self:
        """Return the table of something whose attributes are its keys."""
        return cls(**{key: plain(getattr(item, key)) for key in cls.__struct_fields__})


def unit_vector(vector: Sequence[float]) -> NDArray[np.float64]:
    """Give a vector the length 1; one that has it but for rounding stays as it is written."""
    if abs(math.hypot(*vector) - 1) <= TANGENT:
        return np.array(vector, dtype=float)
    largest = max(map(abs, vector))
    scaled = np.array(vector, dtype=float) / largest  # so that no square overflows
    return np.asarray(scaled / math.hypot(*scaled))


def quotient(value: float, scale: float) -> float:
    """Find the number that the reader, multiplying, turns into `value`.

    The short one if there is one (20 degrees stay 20), else one that is right to the last place.
    """
    exact = float(value) / scale
    short = (float(f"{exact:.{digits}g}") for digits in (15, 16))
    return next((x for x in short if x * scale == value), exact)


def plain(value: Any) -> Any:
    """Write an array as lists of floats, a tuple as a list; leave a text and a truth alone."""
    if isinstance(value, np.ndarray | list):
        return np.asarray(value, dtype=float).tolist()
    if isinstance(value, tuple):
        return list(value)
    return value if isinstance(value, str | bool) else float(value)
