"""What a search for a proof found: how its cells were cut, and how much is left."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Tell = Callable[[float], None]
"""Is told how far work is, from 0 to 1."""


def silent(part: float) -> None:
    """Tell nobody."""
    del part


@dataclass(frozen=True, eq=False)
class Search:
    """What a search for one boundary found.

    Attributes
    ----------
    trees : tuple of str
        For each cell its cuts in preorder: "." a leaf, a letter the edge, or joint, that is cut.
    leaves : int
        Cells on which the bound is positive.
    left : int
        Cells that are undecided.
    part_left : float
        Their part of the whole set.
    violation : (int, ndarray) or None
        A cell, and a configuration in it where the form is negative; rad or length.
    """

    trees: tuple[str, ...]
    leaves: int
    left: int
    part_left: float
    violation: tuple[int, Floats] | None = None


class Forest:
    """The cuts of all cells, as they are made level by level; written down in preorder."""

    def __init__(self, size: int) -> None:
        self.size, self.letters = size, ["?"] * size
        self.children: dict[int, int] = {}

    def close(
        self, numbers: Sequence[int] | NDArray[Any], leaves: Sequence[str] | None = None
    ) -> None:
        """Note that cells are leaves, each written as a point or in another way."""
        for k, number in enumerate(numbers):
            self.letters[number] = "." if leaves is None else leaves[k]

    def cut(self, numbers: Sequence[int] | NDArray[Any], edges: NDArray[Any]) -> NDArray[Any]:
        """Note the cuts and return the numbers of the halves."""
        first = len(self.letters)
        for k, (number, edge) in enumerate(zip(numbers, edges, strict=True)):
            self.letters[number] = chr(ord("a") + int(edge))
            self.children[int(number)] = first + 2 * k
        self.letters += ["?"] * (2 * len(numbers))
        return np.arange(first, len(self.letters))

    def trees(self) -> tuple[str, ...]:
        """Write the cuts of each cell in preorder."""
        return tuple(self._tree(root) for root in range(self.size))

    def _tree(self, root: int) -> str:
        written, todo = [], [root]
        while todo:
            number = todo.pop()
            written.append(self.letters[number])
            if number in self.children:
                todo += [self.children[number] + 1, self.children[number]]
        return "".join(written)
