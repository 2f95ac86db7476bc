"""Exercises that run: a reader puts a value in place of ``...`` and hears right or wrong."""

from types import EllipsisType
from typing import Any

import numpy as np

UNFILLED = "Not filled in yet: put your answer in place of the three dots and run the cell again."


class Reply(str):
    """What a reader hears: a cell that ends with it shows the words, without quotation marks."""

    __slots__ = ()

    def __repr__(self) -> str:
        """Be the words themselves."""
        return str(self)


def check(answer: Any, expected: Any, *, within: float = 0.0) -> Reply:
    """Say whether an answer is right.

    Parameters
    ----------
    answer : EllipsisType, float, str, bool, array_like or set
        What the reader filled in; ``...`` as long as nothing is.
    expected : float, str, bool, array_like or set
        What the cell computes for comparison.
    within : float
        Largest difference that still counts as right, in the unit of both.

    Returns
    -------
    Reply
        "Right.", or "Not yet" with a hint on what differs: it never gives the answer away.

    Raises
    ------
    ValueError
        If `within` is negative or not finite.

    Examples
    --------
    >>> check(..., 6)
    Not filled in yet: put your answer in place of the three dots and run the cell again.
    >>> check(0.96, 0.964038, within=0.01)
    Right.
    >>> check(7, 6)
    Not yet: too large.
    """
    if not (np.isfinite(within) and within >= 0):
        raise ValueError(f"within: {within} is no tolerance")
    if isinstance(answer, EllipsisType):
        return Reply(UNFILLED)
    if isinstance(expected, str | bool | set | frozenset):
        return Reply("Right." if answer == expected else "Not yet.")
    return Reply(_compared(answer, np.asarray(expected, dtype=float), within))


def _compared(answer: Any, expected: np.ndarray[Any, Any], within: float) -> str:
    try:
        given = np.asarray(answer, dtype=float)
    except (TypeError, ValueError):
        return "Not yet: a number is asked for."
    if np.isnan(given).any():  # None, too
        return "Not yet: a number is asked for."
    if given.shape != expected.shape:
        return f"Not yet: {expected.size} numbers are asked for."
    if np.all(np.abs(given - expected) <= within):
        return "Right."
    if expected.ndim:
        return "Not yet."
    return "Not yet: too large." if given > expected else "Not yet: too small."
