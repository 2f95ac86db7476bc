"""Order of things by numbers with errors: rounding never decides which of two comes first.

The same list comes out on every processor, in every unit and by every way to compute the numbers.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import TypeVar

import numpy as np

from cspace.arrays import Floats
from cspace.tolerances import TIED

Item = TypeVar("Item")
Key = Callable[[Item], tuple[float, float]]
"""A number of an item, and a bound of its error."""


def ordered_by(items: Sequence[Item], keys: Sequence[Key[Item]]) -> list[Item]:
    """Put items in rising order of their first key.

    The list is cut where neighbours differ by more than both errors. Items between two cuts may be
    equal: the next key puts them in order. Without a further key they keep the order in which they
    were given.

    Examples
    --------
    >>> keys = [lambda item: (item[0], 1e-9), lambda item: (item[1], 1e-9)]
    >>> ordered_by([(2.0, 5), (1.0, 7), (1.0 + 1e-12, 6)], keys)
    [(1.000000000001, 6), (1.0, 7), (2.0, 5)]
    """
    if len(items) < 2 or not keys:
        return list(items)
    numbers = [keys[0](item) for item in items]
    order = sorted(range(len(items)), key=lambda k: numbers[k][0])
    runs = [[order[0]]]
    for before, k in pairwise(order):
        (low, error), (high, other) = numbers[before], numbers[k]
        if high - low > error + other:
            runs.append([])
        runs[-1].append(k)
    return [item for run in runs for item in ordered_by([items[k] for k in sorted(run)], keys[1:])]


def first_largest(values: Floats) -> int:
    """Return the flat index of the first number that is the largest, up to `TIED` of it.

    Examples
    --------
    >>> import numpy as np
    >>> first_largest(np.array([1.0, np.nan, 3.0, 3.0 + 1e-15]))
    2
    """
    largest = np.nanmax(values)
    return int((values >= largest - TIED * abs(largest)).argmax())
