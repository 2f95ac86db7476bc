"""The monomials that forms are made of: sines, cosines and joint values, and their products.

A row of a compiled table is a sum over these, so that a configuration costs one sine and one cosine
a joint and one product a monomial, however many forms there are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from qbound.arrays import Array, Floats
from qbound.forms.factors import FACTORS, Kind

Index = tuple[int, ...]
Function = tuple[Kind, int]

FUNCTIONS: dict[Function, tuple[Callable[[float], float], np.ufunc]] = {
    ("revolute", 1): (math.cos, np.cos),
    ("revolute", 2): (math.sin, np.sin),
    ("prismatic", 1): (float, np.positive),
    ("prismatic", 2): (lambda q: q * q, np.square),
}
"""The functions of `FACTORS` one by one, of a float and of an array."""

VALUE: Function = ("prismatic", 1)
"""The value of a joint itself: what a limit bounds, of a revolute joint too."""


@dataclass(frozen=True)
class Monomials:
    """The constant 1, then functions of one joint each, then products of two earlier ones.

    Attributes
    ----------
    joints : int
    factors : tuple of (joint, function)
        The first monomials after the constant, by their key in `FUNCTIONS`.
    products : tuple of (int, int)
        The two earlier monomials, by index, that each one after the factors is the product of.
    """

    joints: int
    factors: tuple[tuple[int, Function], ...]
    products: tuple[tuple[int, int], ...]

    def __len__(self) -> int:
        """Return how many there are, the constant included."""
        return 1 + len(self.factors) + len(self.products)

    @cached_property
    def _of_floats(self) -> tuple[tuple[int, Callable[[float], float]], ...]:
        return tuple((joint, FUNCTIONS[function][0]) for joint, function in self.factors)

    def of_one(self, q: Sequence[float]) -> list[float]:
        """Return the monomials of one configuration, in floats of Python."""
        row = [1.0]
        row += [function(q[joint]) for joint, function in self._of_floats]
        for i, j in self.products:
            row.append(row[i] * row[j])
        return row

    def of_columns(self, columns: Array) -> Array:
        """Return the monomials of n configurations, shape (joints, n) to (monomials, n)."""
        rows = np.empty((len(self), columns.shape[1]), columns.dtype)
        rows[0] = 1
        for row, (joint, function) in enumerate(self.factors, 1):
            FUNCTIONS[function][1](columns[joint], out=rows[row])
        for row, (i, j) in enumerate(self.products, 1 + len(self.factors)):
            np.multiply(rows[i], rows[j], out=rows[row])
        return rows

    def sizes(self, reach: Sequence[float]) -> list[float]:
        """Return bounds of the absolute values where that of joint j is at most ``reach[j]``."""
        sizes = [1.0]
        sizes += [float(FACTORS[kind].largest(reach[j])[i]) for j, (kind, i) in self.factors]
        for one, other in self.products:
            sizes.append(sizes[one] * sizes[other])
        return sizes


def occurring(
    coefficients: Array, kinds: Sequence[Kind], bounded: Sequence[int]
) -> tuple[Monomials, Mapping[Index, int]]:
    """Return the monomials that occur in forms, and at which place each index stands.

    Parameters
    ----------
    coefficients : ndarray, shape (m, 3, ..., 3)
        Of forms; a monomial is the index of its coefficient, the zeroth of a joint's factors is 1.
    kinds : sequence of {"revolute", "prismatic"}
        One a joint.
    bounded : sequence of int
        Joints whose value itself is wanted too.
    """
    found = np.argwhere((coefficients != 0).any(axis=0)).tolist()
    return _monomials(tuple(map(tuple, found)), tuple(kinds), tuple(bounded))


@lru_cache(maxsize=64)
def _monomials(
    found: Sequence[Index], kinds: Sequence[Kind], bounded: Sequence[int]
) -> tuple[Monomials, Mapping[Index, int]]:
    """Return the same of the indices that occur; slices, and robots of one build, share them."""
    singles, several = _indices(found)
    factors = [(j, (kinds[j], i)) for j, i in map(_last, singles)]
    factors += [(j, VALUE) for j in bounded if (j, VALUE) not in factors]
    place = {(0,) * len(kinds): 0} | {index: row for row, index in enumerate(singles, 1)}
    place |= {index: row for row, index in enumerate(several, 1 + len(factors))}
    products = tuple((place[_head(index)], place[_tail(index)]) for index in several)
    return Monomials(len(kinds), tuple(factors), products), place


def padded(q: Floats, width: int, dtype: type = np.float64) -> Array:
    """Return configurations as columns, with zeros up to a multiple of `width`; (n, joints)."""
    columns: Array = np.empty((q.shape[1], -(-len(q) // width) * width), dtype)
    columns[:, : len(q)] = q.T
    columns[:, len(q) :] = 0
    return columns


def _indices(occurring: Sequence[Index]) -> tuple[list[Index], list[Index]]:
    """Return the monomials that occur, and those they are made from: of one joint, of several."""
    found = set[Index]()
    for occurs in occurring:
        index = occurs
        while any(index):
            found |= {index, _tail(index)}
            index = _head(index)
    one, several = ([i for i in found if (np.count_nonzero(i) > 1) == many] for many in (0, 1))
    return sorted(one), sorted(several, key=lambda i: (np.count_nonzero(i), i))


def _last(index: Index) -> tuple[int, int]:
    """Return the last joint on which a monomial depends, and which of its factors it has."""
    joint = max(j for j, i in enumerate(index) if i)
    return joint, index[joint]


def _head(index: Index) -> Index:
    """Return a monomial without the factor of its last joint."""
    joint, _ = _last(index)
    return (*index[:joint], 0, *index[joint + 1 :])


def _tail(index: Index) -> Index:
    """Return the factor of the last joint alone."""
    joint, factor = _last(index)
    return (*[0] * joint, factor, *[0] * (len(index) - joint - 1))
