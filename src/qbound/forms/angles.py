"""Full turns: angles that name one direction, and the one of them that is meant."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Floats

TURN: Final = math.tau
"""A full turn, rad."""


def whole_turns(angle: ArrayLike) -> Floats:
    """Return the number of full turns nearest to an angle, shape (...)."""
    return np.asarray(np.rint(np.asarray(angle, dtype=float) / TURN))


def turns_up_to(low: ArrayLike, q: ArrayLike) -> Floats:
    """Return the least number of full turns that brings q to `low` or above, shape (...)."""
    return np.asarray(np.ceil((np.asarray(low, dtype=float) - np.asarray(q)) / TURN))


def first_from(low: ArrayLike, q: ArrayLike) -> Floats:
    """Return the first of q, modulo full turns, that is not below `low`, shape (...)."""
    q = np.asarray(q, dtype=float)
    return np.asarray(q + TURN * turns_up_to(low, q))


def nearest_turn(q: ArrayLike, centre: ArrayLike) -> Floats:
    """Shift angles by full turns into (centre - pi, centre + pi], shape (...)."""
    q = np.asarray(q, dtype=float)
    return np.asarray(q + TURN * np.floor((np.asarray(centre) - q) / TURN + 0.5))


def turns_within(low: float, high: float, q: ArrayLike) -> range:
    """Return every number k of full turns for which some of q + k TURN lies in [low, high]."""
    q = np.asarray(q, dtype=float)
    least, most = np.fmin.reduce(q, axis=None), np.fmax.reduce(q, axis=None)
    return range(math.ceil((low - most) / TURN), math.floor((high - least) / TURN) + 1)
