"""Events as rows of an array, their six kinds, and what is done with rows.

An end of the base; a wall, where a form vanishes along the whole fibre; a fold, where both roots of
a curve are one; a limit, where a curve meets an end of the lift; a side, where a side condition
vanishes on a feature's curve; and a crossing of two curves (sentence 2). A root of a quadratic that
goes to infinity is not an event, because the root passes an end of the lift first.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Self

import numpy as np

from cspace.arrays import Array, Bools, Floats, Ints, ranges

END, WALL, FOLD, LIMIT, SIDE, CROSS = range(6)

EVENT = [("t", float), ("radius", float), ("kind", int), ("i", int), ("j", int), ("key", int)]
"""Base value, its error, and kind of an event; what it is about; and its key.

i is the end of the base (0 or 1), the curve, or of a side the feature; j is the end of the lift,
the side condition, or the other curve. Features whose contacts pass on to each other share a
key."""

SHARE = 0.4657
"""Where between two lines something is asked: at no place of symmetry."""

VAGUE = 16
"""Lines that are no farther apart than so many of their errors are looked at in exact numbers."""


class Columns:
    """Base of dataclasses that hold records in columns: arrays with an entry for each record."""

    def __getitem__(self, chosen: slice | Ints) -> Self:
        """Return some of the records."""
        own = (x[chosen] if isinstance(x, np.ndarray) else x for x in vars(self).values())
        return type(self)(*own)

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Put records one behind the other; what is no column is that of the first part."""
        fields = zip(*(vars(part).values() for part in parts), strict=True)
        return cls(*(np.concatenate(x) if isinstance(x[0], np.ndarray) else x[0] for x in fields))


def made(kind: int, t: Any, radius: Any, i: Any, j: Any = 0, key: Any = -1) -> Array:
    """Return events of one kind."""
    found: Array = np.zeros(len(t), dtype=EVENT)
    values = t, radius, kind, i, j, key
    for name, x in zip(("t", "radius", "kind", "i", "j", "key"), values, strict=True):
        found[name] = x
    return found


def taken(chosen: Array, *arrays: Array) -> Any:
    """Return the chosen entries of several arrays."""
    return tuple(x[chosen] for x in arrays)


def matches(keys: Ints, wanted: Ints) -> tuple[Ints, Ints]:
    """Join two lists: return the places in `wanted` and in `keys` of equal entries."""
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    which, k = ranges(keys.searchsorted(wanted), keys.searchsorted(wanted, "right"))
    return which, order[k]


def clusters(low: Floats, high: Floats, group: Ints | None = None) -> Bools:
    """Tell at which intervals, in the order of their middles, a new cluster begins.

    All from there on lie above all before. Groups are in order, and a cluster is of one group.
    """
    place: Ints = np.unique(np.concatenate([low, high]), return_inverse=True)[1].reshape(2, -1)
    if group is not None:
        place = place + group * 2 * len(low)
    reach, least = np.maximum.accumulate(place[1]), np.minimum.accumulate(place[0][::-1])[::-1]
    return np.append(True, least[1:] > reach[:-1])[: len(low)]


def first_of(parent: Ints | list[int], k: int) -> int:
    """Return the first one of a chain in which each entry names the one before it."""
    while parent[k] != k:
        k = int(parent[k])
    return k
