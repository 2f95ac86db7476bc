r"""Dyadic cells of joint space, and rigorous bounds of forms over thousands of cells.

At a cell's centre m, for any displacement d within it,

.. math::

   |\beta(m + d) - \beta(m) - \nabla\beta(m) \cdot d|
   \le \tfrac12 \sum_{jk} M_{jk} |d_j| |d_k|,

with :math:`M_{jk}` a bound of the second derivative over the whole range. The sums are NumPy's
doubles. Cosines and sines are not, because NumPy does not guarantee their last digits. Each is
computed as a ball, once for each of the few coordinates of centres, and then rounded. The rest are
products and sums of doubles. Their rounding is bounded beforehand (`BoxBounds.slack`) and
subtracted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from cspace.arrays import Floats, Ints
from cspace.forms.factors import FACTORS
from cspace.forms.harmonic import combined, derivatives, size
from cspace.proofs.exact.numbers import above, arb, ball, balls, precision
from cspace.proofs.subdivide import Rows
from qbound.forms import HarmonicForm

Ends = Sequence[tuple[arb, arb]]

BITS = 100
"""Precision of the balls behind the tables: far above a double's 53."""

DEEPEST = 60
"""Cuts after which an index would no longer fit its integer."""


@dataclass(frozen=True, eq=False)
class Cells(Rows):
    """Cells of one size: a range halved `level` times, one joint after the other.

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


@dataclass(eq=False)
class BoxBounds:
    """Ranges of joints, cut into dyadic cells, with forms to bound over these.

    Parameters
    ----------
    forms : HarmonicForm, shape (m,)
        Coefficients exact or balls.
    ends : sequence of (arb, arb)
        Lower and upper end of each joint's range.
    rows : dict, optional
        Known factors at centres; bounds of the same ranges may share them.

    Raises
    ------
    ValueError
        If a coefficient is beyond the range of a double, because its bounds would not be numbers.
    """

    forms: HarmonicForm
    ends: Ends
    rows: dict[tuple[int, int, int], list[float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Round the coefficients, and bound the effect of this and all later rounding."""
        n, kinds = len(self.forms.kinds), self.forms.kinds
        with precision(BITS):
            reach = [max(above(abs(low)), above(abs(high))) for low, high in self.ends]
            slopes = derivatives(self.forms)
            self.curvature: Floats = magnitude(derivatives(slopes), reach)
            exact = balls(
                np.concatenate([self.forms.coefficients[:, None], slopes.coefficients], axis=1)
            )
            table = exact.astype(float)
            lost = np.vectorize(above, otypes=[float])(abs(exact - table))
        if not (np.isfinite(table).all() and np.isfinite(self.curvature).all()):
            raise ValueError("a boundary has coefficients beyond the range of a double")
        self.table = HarmonicForm(table, kinds)
        # Rounded factors, products and sums: each errs by 2^-53 of its size; 2^-51 leaves room for
        # other rounding modes and for the sizes' own rounding.
        count = 3**n + 2 * n + 4
        self.slack: Floats = count * 2.0**-51 * size(self.table, reach)
        self.slack += 2 * size(HarmonicForm(lost, kinds), reach)

    def whole(self) -> Cells:
        """Return the one cell that is the whole range."""
        return Cells(0, np.zeros((1, len(self.forms.kinds)), dtype=np.int64))

    def bounds(self, cells: Cells, forms: Ints | None = None) -> tuple[Floats, Floats]:
        """Bound forms over every closed cell from below and above, shape (k, m) each.

        Parameters
        ----------
        cells : Cells
        forms : ndarray of int, optional
            Which forms; default all.
        """
        with precision(BITS):
            h = self._half_widths(cells)
            factors = [self._factor(j, b, cells.index[:, j]) for j, b in enumerate(cells.bits)]
        table, slack, curvature = self.table, self.slack, self.curvature
        if forms is not None and len(forms) < len(slack):
            table, slack, curvature = table[forms], slack[forms], curvature[forms]
        found = combined(table, factors, (len(cells),))
        slope = (np.abs(found[..., 1:]) + slack[:, 1:]) @ h
        bend = 0.5 * np.einsum("mij,i,j->m", curvature, h, h)
        spread = slope + bend + slack[:, 0]
        spread += 2.0**-47 * (np.abs(found[..., 0]) + spread)  # rounding of these two lines
        return found[..., 0] - spread, found[..., 0] + spread

    def box(self, cells: Cells, k: int) -> list[arb]:
        """Return cell k as one ball for each joint, at the precision that is set."""
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

    def _factor(self, joint: int, bits: int, index: Ints) -> Floats:
        """Return the rounded factors at the centres of some cells along one joint, shape (k, 3)."""
        different, back = np.unique(index, return_inverse=True)
        rows = np.array([self._row(joint, int(bits), int(i)) for i in different])
        return np.asarray(rows.reshape(-1, 3)[back])

    def _row(self, joint: int, bits: int, index: int) -> list[float]:
        key = joint, bits, index
        if key not in self.rows:
            low, high = self.ends[joint]
            centre = low + (high - low) * (2 * index + 1) / 2 ** (bits + 1)
            one, two = FACTORS[self.forms.kinds[joint]].functions(centre)
            self.rows[key] = [1.0, float(one), float(two)]
        return self.rows[key]


def magnitude(forms: HarmonicForm, reach: Sequence[float]) -> Floats:
    """Bound the absolute value of each form over whole ranges, from above.

    Cosine and sine of one joint are a unit vector. For unit vectors x and y, x A y is at most the
    Frobenius norm of A.

    Parameters
    ----------
    forms : HarmonicForm
        Coefficients exact, balls or floats.
    reach : sequence of float
        Largest absolute value of each joint.
    """
    first = len(forms.stack)
    coefficients = balls(forms.coefficients)
    blocks = coefficients * coefficients  # `** 2` of a ball with 0 inside is NaN
    for axis, (kind, largest) in enumerate(zip(forms.kinds, reach, strict=True), start=first):
        row = FACTORS[kind]
        squares = row.units * balls(row.largest(ball(largest))) ** 2
        blocks = np.moveaxis(np.tensordot(squares, blocks, axes=([1], [axis])), 0, axis)
    # A negative part in the ball of a square is rounding, so it is dropped.
    roots = np.vectorize(lambda x: x.nonnegative_part().sqrt(), otypes=[object])(blocks)
    total = roots.sum(axis=tuple(range(first, roots.ndim)))
    return np.asarray(np.vectorize(above, otypes=[float])(total))
