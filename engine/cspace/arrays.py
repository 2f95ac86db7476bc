"""Names of array types, for annotations; ranges of integers, different entries, cross products.

A docstring says the shape and the unit of an array.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Complexes = NDArray[np.complex128]
Ints = NDArray[np.int64]
Indices = NDArray[np.intp]
Bools = NDArray[np.bool_]
Array = NDArray[Any]
"""Numbers of any kind: doubles, or objects such as rationals and balls."""


def ranges(start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """Return index and value of every integer in range(start, end), for each entry in turn."""
    count = np.maximum(end - start, 0).astype(np.intp)  # in 32 bits `repeat` takes nothing wider
    pick = np.arange(len(count)).repeat(count)
    return pick, np.arange(len(pick)) + (start + count - count.cumsum())[pick]


def distinct(x: ArrayLike) -> Array:
    """Return the different entries, ascending, as `np.unique` does without importing `numpy.ma`."""
    found: Array = np.sort(x, axis=None)
    return np.asarray(found[begins(found)])


def begins(*columns: Array) -> Bools:
    """Tell which rows differ from the row before them in some column."""
    new: Bools = np.zeros(len(columns[0]), dtype=np.bool_)
    new[:1] = True
    for x in columns:
        new[1:] |= x[1:] != x[:-1]
    return new


def cross(a: Array, b: Array) -> Array:
    """Return cross products of vectors whose coordinates are the first axis, (3, ...)."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )
