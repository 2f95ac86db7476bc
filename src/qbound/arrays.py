"""Types of arrays, and the few functions that take numbers and symbols alike.

An array of floats may have leading axes, one entry for each configuration: a shape such as
``(..., 3)`` says so. An array of SymPy expressions has the type ``object``. The same function takes
both, so a formula is written once and a chapter can prove with letters what it shows with numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[Any]
"""Numbers or symbols."""
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def vector(values: ArrayLike, name: str) -> Array:
    """Return three finite numbers, or three symbols, as an array of shape (3,).

    Raises
    ------
    ValueError
        If `values` are not three, or one is NaN or infinite; the message begins with `name`.

    Examples
    --------
    >>> from qbound.arrays import vector
    >>> vector([25, 0, 0], "point 3: at").tolist()
    [25.0, 0.0, 0.0]
    """
    array = np.asarray(values)
    if array.dtype != object:
        array = array.astype(float)
    if array.shape != (3,) or (array.dtype != object and not np.isfinite(array).all()):
        raise ValueError(f"{name} must be three finite numbers, found {array.tolist()}")
    return array


def unit_vector(values: ArrayLike, name: str) -> Array:
    """Return a direction as a vector of length 1, shape (3,); symbols stay as they are.

    Raises
    ------
    ValueError
        As in `vector`, or if all three are zero.

    Examples
    --------
    >>> from qbound.arrays import unit_vector
    >>> unit_vector([0, 3, 4], "axis").tolist()
    [0.0, 0.6, 0.8]
    """
    array = vector(values, name)
    if array.dtype == object:
        return array
    length = np.linalg.norm(array)
    if length == 0:
        raise ValueError(f"{name} must be a direction, found zeros")
    return np.asarray(array / length)


def times(matrix: Array, vector: Array) -> Array:
    """Multiply matrices by vectors over leading axes: (..., 3, 3), (..., 3) to (..., 3)."""
    return np.asarray((matrix @ vector[..., None])[..., 0])


def cross_matrix(k: Array) -> Array:
    """Return the matrix K with ``K u = k x u``, shape (3, 3)."""
    return np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])


def cos_sin(angle: ArrayLike) -> tuple[Array, Array]:
    """Return cosine and sine of floats, of symbols, or of numbers with methods `cos` and `sin`.

    Both have the shape of `angle`, in rad.
    """
    angle = np.asarray(angle)
    if angle.dtype != object:
        return np.cos(angle), np.sin(angle)
    cosine, sine = np.frompyfunc(_cos_sin_of_one, 1, 2)(angle)
    return np.asarray(cosine, dtype=object), np.asarray(sine, dtype=object)


def _cos_sin_of_one(x: Any) -> tuple[Any, Any]:
    if hasattr(x, "cos"):
        return x.cos(), x.sin()
    import sympy

    return sympy.cos(x), sympy.sin(x)


def square_root(squared: Array) -> Array:
    """Return the square root of floats or of symbols."""
    if squared.dtype != object:
        return np.sqrt(squared)
    import sympy

    return np.asarray(np.vectorize(sympy.sqrt, otypes=[object])(squared))


def whole_numbers(values: Array) -> Array:
    """Make entries that are whole up to rounding exact, so that symbols meet no floats."""
    import sympy

    entries = [sympy.Integer(round(x)) if abs(x - round(x)) <= 1e-12 else x for x in values.flat]
    return np.array(entries, dtype=object).reshape(values.shape)
