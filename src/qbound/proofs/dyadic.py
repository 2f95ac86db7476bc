r"""Dyadic cells of joint space, and bounds of forms over thousands of them that no rounding spoils.

At a cell's centre m, for any displacement d within it,

.. math::

   |\beta(m + d) - \beta(m) - \nabla\beta(m) \cdot d|
   \le \tfrac12 \sum_{jk} M_{jk} |d_j| |d_k|,

with :math:`M_{jk}` a bound of the second derivative over the whole range. The sums are NumPy's
doubles. Cosines and sines are not: NumPy promises nothing about their last digits, so each is
computed as a ball, once for each of the few coordinates that the centres have, and rounded. What is
left are products and sums of doubles; their rounding is bounded beforehand (`Room.slack`) and taken
off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from qbound.forms.harmonic import HarmonicForm
from qbound.proofs.balls import above, ball, derivative, factor, gradient, magnitude, precision

if TYPE_CHECKING:
    from flint import arb

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Ends = Sequence[tuple["arb", "arb"]]

BITS = 100
"""Precision of the balls behind the tables: far above a double's 53."""

DEEPEST = 60
"""Cuts after which an index would no longer fit its integer."""


@dataclass(frozen=True, eq=False)
class Cells:
    """Cells of one size: a range halved `level` times, the joints taking turns.

    Attributes
    ----------
    level : int
    index : ndarray of int, shape (k, n)
        Place of each cell along each joint, from the range's lower end.
    """

    level: int
    index: Ints

    @property
    def bits(self) -> Ints:
        """How often each joint has been halved."""
        n = self.index.shape[1]
        return np.array([(self.level + n - 1 - j) // n for j in range(n)])

    def halves(self) -> Cells:
        """Cut every cell in two, along the joint whose turn it is."""
        joint = self.level % self.index.shape[1]
        low = self.index.copy()
        low[:, joint] *= 2
        high = low.copy()
        high[:, joint] += 1
        return Cells(self.level + 1, np.concatenate([low, high]))

    def __getitem__(self, chosen: Any) -> Cells:
        """Take some of the cells, by a mask or by numbers."""
        return Cells(self.level, self.index[chosen])

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.index)


@dataclass(eq=False)
class Room:
    """Ranges of joints, cut into dyadic cells, with forms to bound over these.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Coefficients exact or balls.
    ends : sequence of (arb, arb)
        Lower and upper end of each joint's range.
    """

    forms: HarmonicForm
    ends: Ends
    _factors: dict[tuple[int, int, int], list[float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Round the coefficients, and bound what that and all later rounding can do."""
        n, m = len(self.forms.kinds), len(self.forms.coefficients)
        with precision(BITS):
            reach = [max(above(abs(low)), above(abs(high))) for low, high in self.ends]
            slopes = gradient(self.forms)
            second = [magnitude(derivative(slopes, j), reach) for j in range(n)]
            self.curvature: Floats = np.stack(second, axis=-1) if m else np.zeros((0, n, n))
            stacked = np.concatenate(
                [self.forms.coefficients[:, None], slopes.coefficients], axis=1
            ).reshape(m * (n + 1), 3**n)
            self.table: Floats = np.vectorize(float, otypes=[float])(
                np.vectorize(ball, otypes=[object])(stacked)
            )
        sizes = reduce(
            _products, [_sizes(k, r) for k, r in zip(self.forms.kinds, reach, strict=True)]
        )
        # Rounded factors, coefficients, products and sums: each errs by 2^-53 of its size; 2^-51
        # leaves room for other rounding modes and for the sizes' own rounding.
        count = 3**n + 2 * n + 4
        self.slack: Floats = (count * 2.0**-51 * (np.abs(self.table) @ sizes)).reshape(m, n + 1)

    def whole(self) -> Cells:
        """Return the one cell that is the whole range."""
        return Cells(0, np.zeros((1, len(self.forms.kinds)), dtype=np.int64))

    def bounds(self, cells: Cells) -> tuple[Floats, Floats]:
        """Bound every form over every closed cell: below and above, shape (k, m) each."""
        n, m = len(self.forms.kinds), len(self.forms.coefficients)
        with precision(BITS):
            h = self._half_widths(cells)
            factors = [self._table(j, b, cells.index[:, j]) for j, b in enumerate(cells.bits)]
        found = (reduce(_products, factors) @ self.table.T).reshape(len(cells), m, n + 1)
        slope = (np.abs(found[..., 1:]) + self.slack[:, 1:]) @ h
        bend = 0.5 * np.einsum("mij,i,j->m", self.curvature, h, h)
        spread = slope + bend + self.slack[:, 0]
        spread += 2.0**-47 * (np.abs(found[..., 0]) + spread)  # the roundings of these two lines
        return found[..., 0] - spread, found[..., 0] + spread

    def box(self, cells: Cells, k: int) -> list[arb]:
        """Return cell k as one ball a joint (at the precision at hand)."""
        edges = (
            self.edge(j, b, i)
            for j, (b, i) in enumerate(zip(cells.bits, cells.index[k], strict=True))
        )
        return [low.union(high) for low, high in edges]

    def edge(self, joint: int, bits: int, index: int) -> tuple[arb, arb]:
        """Return both ends of a cell along a joint."""
        low, high = self.ends[joint]
        step = (high - low) / 2 ** int(bits)
        return low + step * int(index), low + step * (int(index) + 1)

    def places(self, cells: Cells) -> tuple[Floats, Floats]:
        """Return lower and upper corners as doubles, shape (k, n): for drawing, not for proofs."""
        low = np.array([float(a) for a, _ in self.ends])
        step = np.array([float(b - a) for a, b in self.ends]) / 2.0**cells.bits
        return low + step * cells.index, low + step * (cells.index + 1)

    def _half_widths(self, cells: Cells) -> Floats:
        pairs = zip(self.ends, cells.bits, strict=True)
        return np.array([above((high - low) / 2 ** int(b + 1)) for (low, high), b in pairs])

    def _table(self, joint: int, bits: int, index: Ints) -> Floats:
        """Return the rounded factors at the centres of some cells along one joint, shape (k, 3)."""
        different, back = np.unique(index, return_inverse=True)
        rows = np.array([self._factor(joint, int(bits), int(i)) for i in different])
        return np.asarray(rows.reshape(-1, 3)[back])

    def _factor(self, joint: int, bits: int, index: int) -> list[float]:
        key = joint, bits, index
        if key not in self._factors:
            low, high = self.ends[joint]
            centre = low + (high - low) * (2 * index + 1) / 2 ** (bits + 1)
            self._factors[key] = [float(ball(x)) for x in factor(self.forms.kinds[joint], centre)]
        return self._factors[key]


def _products(left: Floats, right: Floats) -> Floats:
    """Multiply (..., a) by (..., b) into all products, (..., a b)."""
    product = left[..., :, None] * right[..., None, :]
    return product.reshape(*product.shape[:-2], -1)


def _sizes(kind: str, reach: float) -> Floats:
    """Bound |(1, cos q, sin q)| or |(1, q, q^2)| over a range."""
    return np.array([1.0, 1.0, 1.0]) if kind == "revolute" else np.array([1.0, reach, reach**2])
