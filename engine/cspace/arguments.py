"""Checks of arguments: types, whole numbers, numbers above 0; each error names the argument."""

import math
from operator import index
from typing import NoReturn

from cspace.printable import printable

LONGEST = 60
"""Characters of a value that an error shows."""


def refuse_type(what: str, value: object, wanted: str) -> NoReturn:
    """Raise a TypeError that names an argument of a wrong type.

    Raises
    ------
    TypeError
        Always.
    """
    raise TypeError(f"{what}: wanted {wanted}, found {_shown(value)}")


def whole_number(what: str, value: object, least: int) -> int:
    """Return an argument as an int.

    Raises
    ------
    TypeError
        If the argument is not a whole number.
    ValueError
        If the argument is less than `least`.
    """
    try:
        number = index(value)  # type: ignore[arg-type]  # that is what is tried
    except TypeError:
        refuse_type(what, value, "a whole number")
    if number < least:
        raise ValueError(f"{what}: {number}; {least} or more is wanted")
    return number


def number_above_zero(what: str, value: object) -> float:
    """Return an argument as a float.

    Raises
    ------
    TypeError
        If the argument is not a number.
    ValueError
        If the argument is not finite, or not above 0.
    """
    if isinstance(value, str | bytes):
        refuse_type(what, value, "a number above 0")
    try:
        number = float(value)  # type: ignore[arg-type]  # that is what is tried
    except TypeError:
        refuse_type(what, value, "a number above 0")
    if not 0 < number < math.inf:
        raise ValueError(f"{what}: {number:g} is no finite number above 0")
    return number


def _shown(value: object) -> str:
    text = printable(repr(value))
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."
