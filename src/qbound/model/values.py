"""Checks of joint values: real, finite, and as many as the robot has joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.arrays import Array
from qbound.model.schema import one_line


def real_numbers(q: ArrayLike) -> NDArray[np.float64]:
    """Return an array of floats, of integers or floats; quick, because all are floats mostly.

    Raises
    ------
    ValueError
        If they are complex numbers, texts, or of no shape.
    """
    if isinstance(q, np.ndarray) and q.dtype == np.float64:
        return q
    found = _array(q, symbols=False)
    if found is None:
        raise ValueError(f"{one_line(repr(q))} is no array of real numbers")
    return found


def joint_values(q: ArrayLike, names: Sequence[str], *, symbols: bool = False) -> Array:
    """Return the values of the joints of those names as floats, shape (..., n).

    Parameters
    ----------
    q : array_like, shape (..., n)
        One value a joint on the last axis; any leading axes.
    names : sequence of str
        What a refusal calls the joints.
    symbols : bool
        Whether an array with SymPy expressions is let through as it is.

    Raises
    ------
    ValueError
        If they are no array of numbers, not one a joint, or one of them is NaN or infinite.
    """
    values = _array(q, symbols)
    if values is None:
        listed = one_line(", ".join(names))
        raise ValueError(f"{one_line(repr(q))} is no array of numbers; wanted: values of {listed}")
    n = len(names)
    if values.shape[-1:] != (n,):
        found = values.shape[-1] if values.ndim else "a bare number"
        raise ValueError(
            f"expected {n} joint value{'s' * (n != 1)} on the last axis, found {found}"
        )
    if values.dtype != object and not np.isfinite(values).all():
        *place, j = np.argwhere(~np.isfinite(values))[0].tolist()
        where = f" in configuration {place}" if place else ""
        raise ValueError(f"joint {names[j]!r} is {values[*place, j]}{where}, not a finite number")
    return values


def _array(q: ArrayLike, symbols: bool) -> Array | None:
    """Make an array of floats, or of symbols; None of what is neither, such as a text."""
    try:
        values = np.asarray(q)
        if values.dtype == object and not any(isinstance(x, str) for x in values.flat):
            symbolic = symbols and any(hasattr(x, "free_symbols") for x in values.flat)
            return values if symbolic else values.astype(float)
        return np.asarray(values, dtype=float) if values.dtype.kind in "iuf" else None
    except (TypeError, ValueError, OverflowError):  # rows of unlike lengths, integers beyond floats
        return None
