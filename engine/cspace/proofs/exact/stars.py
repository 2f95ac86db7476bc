r"""Cells of two joints on which the free configurations are proved to be star-shaped.

A cell is a rectangle, a piece of a line, or a point. It is *blocked* if nothing in it is free,
*open* if all of it is, and a *star* if a free place v in it is proved from which every free place
of the cell can be reached along a straight line that stays free.

A contact is a form f with sides g. Two bodies touch exactly where f = 0 and all g >= 0 for one of
their contacts. If no contact lies in a cell, a pair is apart all over the cell, or nowhere in it.
On the way from q to v the form of a contact at q grows, because by Taylor's formula

.. math:: \nabla f(q) \cdot (v - q) \ge f(v) - f(q) - \tfrac12 \sum_{jk} M_{jk} w_j w_k

with :math:`w` the widest step in the cell and :math:`M` a bound of the second derivatives. So where
f(v) is larger than the last sum, for every contact that the cell can hold, the way to v can only
leave what is forbidden and never enter it: the cell is a star. Bodies that overlap, edges in line
and repeated obstacles do no harm. Only where free places meet in a single point, or a gap has no
width, can no cell around be a star.

The contact of an inner edge, along which a body was cut, only has to change, not to grow (see
`grows`).

All numbers are doubles; a bound of their rounding is subtracted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cspace.arrays import Array, Bools, Floats, Ints
from cspace.forms.factors import FACTORS
from cspace.forms.harmonic import derivatives, size
from cspace.proofs.exact.numbers import above, ball, basis_of_doubles, precision, turns
from cspace.proofs.exact.problem import ExactProblem
from cspace.proofs.subdivide import Rows
from qbound.forms import HarmonicForm, Kind

WHOLE = 2**36
"""Steps across each range: a cell one step wide is given up."""

MOST_CELLS = 20_000
"""Cells at once at which a proof is given up."""

ROUNDING = 2.0**-44
"""Of a sum of nine products of doubles, in parts of its size: cosines err by ``2**-47``,
places by ``2**-50`` of the range, each rounding by ``2**-53``; the rest is room to spare."""

BENT = 0.083
"""How unevenly cells are cut, so that no place of symmetry is a corner of one."""

START = -3.3806
"""Where cells of a joint that turns all the way round begin: any place would do."""

GRID = np.stack(np.meshgrid(*[np.linspace(-1, 1, 5)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
"""Places of a cell that are tried as its v, in half widths from the centre."""

BLOCK = 2**15
"""Forms on cells that are looked at together."""


BITS = 100
"""Precision at which exact numbers are compared with doubles."""


class Undecided(ValueError):
    """Error: a cell became too small, or there are too many cells; the message says where."""


@dataclass(frozen=True, eq=False)
class Bounded:
    """Forms in doubles, with bounds of their rounding and of their second derivatives.

    Attributes
    ----------
    tables : ndarray, shape (m, 3, 9)
        Coefficients of each form and its two derivatives.
    slack : ndarray, shape (m, 3)
        Largest error of a value, also for places that differ from the given one by rounding.
    bend : ndarray, shape (m, 2, 2)
        Bounds of the second derivatives over the whole range.
    """

    tables: Floats
    slack: Floats
    bend: Floats

    @classmethod
    def of(cls, exact: Array, kinds: tuple[Kind, ...], reach: Floats) -> Bounded:
        """Round exact coefficients, shape (m, 3, 3)."""
        table, lost = _rounded(exact)

        def largest(tables: Floats) -> Floats:
            return size(HarmonicForm(tables, kinds), reach.tolist())

        large = np.abs(table) + lost
        first, second = _slopes(large, kinds), _slopes(_slopes(large, kinds), kinds)
        sizes = np.concatenate([large[:, None], first], axis=1)
        further = np.concatenate([first[:, None], second], axis=1)  # each one's two derivatives
        slack = ROUNDING * (largest(sizes) + largest(further) @ reach)
        slack += 2 * (largest(lost) + largest(_slopes(lost, kinds)).sum(axis=1))[:, None]
        slopes = derivatives(HarmonicForm(table, kinds)).coefficients
        tables = np.concatenate([table[:, None], slopes], axis=1).reshape(-1, 3, 9)
        return cls(tables, slack, _magnitude(second, kinds, reach) * (1 + 1e-9))

    def __len__(self) -> int:
        """Return how many forms there are."""
        return len(self.tables)


def _slopes(tables: Floats, kinds: Sequence[Kind]) -> Floats:
    """Bound the coefficients of both derivatives of forms, (m, ..., 3, 3) to (m, 2, ..., 3, 3)."""
    one, other = (np.abs(FACTORS[kind].slope).astype(float) for kind in kinds)
    return np.stack([one.T @ tables, tables @ other], axis=1)


def _magnitude(tables: Floats, kinds: Sequence[Kind], reach: Floats) -> Floats:
    """Bound forms by the sizes of coefficients; cosine and sine of a joint are one unit vector."""
    for axis, (kind, largest) in enumerate(zip(kinds, reach, strict=True), start=-2):
        one, two, three = np.moveaxis(tables, axis, 0)
        if kind == "revolute":
            rows = [one, np.hypot(two, three)]
        else:
            rows = [one, two * largest, three * largest**2]
        tables = np.stack(rows, axis=axis)
    return np.asarray(tables.sum(axis=(-2, -1)))


def _rounded(exact: Array) -> tuple[Floats, Floats]:
    """Return coefficients as doubles, and by how much each may differ from the exact one."""
    table, lost = np.zeros(exact.shape), np.zeros(exact.shape)
    for place in np.argwhere(exact != 0):
        index = tuple(place)
        value = ball(exact[index])
        table[index] = float(value)
        lost[index] = above(abs(value - table[index]))
    if not np.isfinite(table).all():
        raise ValueError("a boundary has coefficients beyond the range of a double")
    return table, lost


@dataclass(frozen=True, eq=False)
class Cells(Rows):
    """Cells that are blocked, open, or a star.

    Attributes
    ----------
    low, high : ndarray of int, shape (k, 2)
        Corners, in steps; equal along a joint across which a cell has no width.
    origin : ndarray of int, shape (k,)
        The given cell that contains each cell.
    blocked, star : ndarray of bool, shape (k,)
        A cell that is neither blocked nor a star is open: all of it is free.
    middle : ndarray, shape (k, 2)
        A free place that straight free segments join to all other free places of the cell;
        meaningless if blocked.
    contacts : ndarray of object, shape (k,)
        The contacts that each cell may hold, as an ndarray of int for each cell.
    """

    low: Ints
    high: Ints
    origin: Ints
    blocked: Bools
    star: Bools
    middle: Floats
    contacts: Array


class Stars:
    """A search that cuts cells of one problem until each is proved blocked, open or a star."""

    def __init__(self, problem: ExactProblem) -> None:
        self.kinds = problem.kinds
        self.circles = [r is None for r in problem.ranges]
        ends = [
            (START, float(ball(START) + turns(1))) if r is None else (float(r[0]), float(r[1]))
            for r in problem.ranges
        ]
        self.first, self.last = np.array(ends).T
        if not (self.first < self.last).all():
            raise Undecided("the range of a joint is empty")
        self.reach = np.maximum(np.abs([self.first, self.last]).max(axis=0), 1e-300)
        alone = list(zip(problem.names, problem.forms.coefficients, strict=True))
        bodies = [pair for pair in problem.bodies if len(pair.starts) > 1]
        for pair in problem.bodies:
            if len(pair.starts) == 1:  # corners above a half-space: each form has to be positive
                alone += [(pair.name, form) for form in pair.forms.coefficients]
        self.names = (*(name for name, _ in alone), *(pair.name for pair in bodies))
        contacts = [_alone(form) for _, form in alone]
        contacts += [pair.contacts.coefficients for pair in bodies]
        self.pair = np.repeat(np.arange(len(self.names)), [len(rows) for rows in contacts])
        self.inner = np.concatenate([np.zeros(len(alone), dtype=bool), *(p.inner for p in bodies)])
        every = np.concatenate([np.zeros((0, 5, 3, 3), dtype=object), *contacts])
        tests = [form[None] for _, form in alone] + [pair.forms.coefficients for pair in bodies]
        self.starts = [np.zeros(1, dtype=np.intp)] * len(alone) + [pair.starts for pair in bodies]
        with precision(BITS):
            self.contacts = Bounded.of(every.reshape(-1, 3, 3), self.kinds, self.reach)
            self.tests = [Bounded.of(test, self.kinds, self.reach) for test in tests]

    # --- places ---------------------------------------------------------------------------------

    def places(self, steps: Ints) -> Floats:
        """Return joint values, shape (..., 2), of steps across the ranges."""
        t = steps / WHOLE
        return np.asarray(self.first + (self.last - self.first) * (t + BENT * t * (1 - t)))

    def monomials(self, q: Floats) -> Floats:
        """Return the nine products of both joints' factors, shape (n, 9)."""
        one, other = map(basis_of_doubles, self.kinds, q.T)
        return np.asarray((one[:, :, None] * other[:, None, :]).reshape(-1, 9))

    def signs(self, q: Floats, pairs: Ints) -> Ints:
        """Tell whether pairs, one for each place, are apart (1) or collide (-1); 0 if undecided."""
        found, products = np.zeros(len(q), dtype=np.int64), self.monomials(q)
        for pair in np.unique(pairs):
            own = np.flatnonzero(pairs == pair)
            test, starts = self.tests[pair], self.starts[pair]
            values = products[own] @ test.tables[:, 0].T
            least = np.minimum.reduceat(values - test.slack[:, 0], starts, axis=1)
            most = np.minimum.reduceat(values + test.slack[:, 0], starts, axis=1)
            found[own] = (least > 0).any(axis=1).astype(int) - (most < 0).all(axis=1)
        return found

    # --- cells ----------------------------------------------------------------------------------

    def plane(self) -> Cells:
        """Cut the whole plane."""
        every = np.arange(len(self.pair))
        return self.cut(np.zeros((1, 2), dtype=np.int64), np.full((1, 2), WHOLE), [every])

    def cut(self, low: Ints, high: Ints, contacts: Sequence[Ints]) -> Cells:
        """Cut cells with their possible contacts; pairs without any are apart all over the cell."""
        origin = np.arange(len(low))
        box = np.repeat(origin, [len(rows) for rows in contacts])
        row = np.concatenate([np.zeros(0, dtype=np.int64), *contacts])
        done: list[Cells] = []
        while len(low) or not done:
            corner, far = self.places(low), self.places(high)
            middle, half = (corner + far) / 2, (far - corner) / 2
            wide = half + ROUNDING * self.reach
            blocked, kept, values = self._left(middle, wide, box, row)
            box, row = box[kept], row[kept]
            held = np.bincount(box, minlength=len(low)) > 0
            found, star = self._centres(middle, half, wide, box, row, values)
            closed = blocked | ~held | star
            lists = _listed(box, row, len(low))
            every = Cells(
                low, high, origin, blocked, star, np.where(star[:, None], found, middle), lists
            )
            done.append(every[closed])
            stuck = np.flatnonzero(~closed & ((high - low).max(axis=1) <= 1))
            if 2 * np.count_nonzero(~closed) > MOST_CELLS:
                stuck = np.flatnonzero(~closed)
            if len(stuck):
                names = sorted({self.names[pair] for pair in self.pair[lists[stuck[0]]]})
                place = ", ".join(f"{x:.9g}" for x in middle[stuck[0]])
                raise Undecided(f"{' and '.join(names)}: not decided near ({place})")
            joint = self._joint(low, high, wide, box, row, values)
            low, high, origin, box, row = _halved(low, high, origin, joint, ~closed, lists)
        return Cells.joined(done)

    def _left(
        self, middle: Floats, half: Floats, box: Ints, row: Ints
    ) -> tuple[Bools, Bools, Floats]:
        """Tell which cells are blocked, which contacts may be held, and their forms at centres."""
        products = self.monomials(middle)
        values, kept = np.zeros((len(box), 3)), np.ones(len(box), dtype=np.bool_)
        for part in (slice(k, k + BLOCK) for k in range(0, len(box), BLOCK)):
            b, rows = box[part], row[part] * 5
            value, spread = self._spread(products[b], half[b], rows)
            values[part] = value
            kept[part] = np.abs(value[:, 0]) <= spread
            for side in range(1, 5):
                left = np.flatnonzero(kept[part])
                g, spread = self._spread(products[b[left]], half[b[left]], rows[left] + side)
                kept[part.start + left] = g[:, 0] + spread >= 0
        count = len(self.names)
        asked = box * count + self.pair[row]  # a pair in a cell
        gone = np.setdiff1d(asked, asked[kept])
        sign = self.signs(middle[gone // count], gone % count)
        blocked = np.zeros(len(middle), dtype=np.bool_)
        blocked[gone[sign < 0] // count] = True
        unsure = np.isin(asked, gone[sign == 0])
        kept = (kept | unsure) & ~blocked[box]
        return blocked, kept, values[kept]

    def _spread(self, products: Floats, half: Floats, rows: Ints) -> tuple[Floats, Floats]:
        """Return forms and their slopes at centres, and how much each form varies in its cell."""
        every = self.contacts
        values = np.einsum("nak,nk->na", every.tables[rows], products)
        slopes = np.abs(values[:, 1:]) + every.slack[rows, 1:]
        bend = 0.5 * np.einsum("njk,nj,nk->n", every.bend[rows], half, half)
        return values, ((slopes * half).sum(axis=1) + bend + every.slack[rows, 0]) * (1 + 1e-12)

    def _joint(
        self, low: Ints, high: Ints, wide: Floats, box: Ints, row: Ints, values: Floats
    ) -> Ints:
        """Return the joint along which the contacts of each cell change most: it is cut there."""
        steps = wide[box]
        bend = np.einsum("njk,nj,nk->nj", self.contacts.bend[row * 5], steps, steps)
        change = np.abs(values[:, 1:]) * steps + 0.5 * bend
        total = [np.bincount(box, change[:, joint], minlength=len(low)) for joint in (0, 1)]
        change = np.where(high - low > 1, np.stack(total, axis=1), -1.0)
        return np.asarray(change.argmax(axis=1))

    def _centres(
        self, middle: Floats, half: Floats, wide: Floats, box: Ints, row: Ints, values: Floats
    ) -> tuple[Floats, Bools]:
        """Return a place of each cell, and whether the cell is proved to be a star about it.

        The search looks for the place where the least of all forms, less their bend, is largest. A
        proof follows.
        """
        star = np.zeros(len(middle), dtype=np.bool_)
        if not len(box):
            return middle, star
        boxes, first = np.unique(box, return_index=True)
        which = np.repeat(np.arange(len(boxes)), np.diff([*first, len(box)]))
        slopes = values[:, 1:] * half[box]
        scale = np.abs(slopes).sum(axis=1) + 1e-300
        bend = self.contacts.bend[row * 5] * wide[box][:, :, None] * wide[box][:, None, :]
        inner = self.inner[row][:, None]
        best, size = np.zeros((len(boxes), 2)), 1.0
        rows = np.arange(len(boxes))
        for _ in range(5):
            tried = np.clip(best[:, None] + size * GRID, -1, 1)  # (boxes, places, 2)
            d = tried[which]
            form = values[:, :1] + np.einsum("nj,npj->np", slopes, d)
            form = np.where(inner, np.abs(form), form)
            step = 1 + np.abs(d)
            spare = form - 0.5 * np.einsum("njk,npj,npk->np", bend, step, step)
            least = np.minimum.reduceat(spare / scale[:, None], first, axis=0)
            best, size = tried[rows, least.argmax(axis=1)], size / 2
        place = middle.copy()
        place[boxes] += best * half[boxes]
        hopeful = boxes[least.max(axis=1) > 0]
        own = np.isin(box, hopeful)
        star[hopeful] = True
        star[box[own][~self.grows(place, wide, middle, box[own], row[own])]] = False
        pairs = np.unique(np.stack([box[own], self.pair[row[own]]]), axis=1)
        star[pairs[0][self.signs(place[pairs[0]], pairs[1]) <= 0]] = False
        return place, star

    def grows(self, place: Floats, wide: Floats, middle: Floats, box: Ints, row: Ints) -> Bools:
        """Tell which contacts are proved to grow on every straight way to a place of the cell.

        For an inner edge of a body without required distance, a change is enough. Around a contact
        of such an edge everything is blocked, unless a corner of the body meets a corner of another
        body. Around that corner the parts lie side by side. If the contact of an inner edge grows
        for the part on one side, it falls for the part on the other side. The first and the last
        part each have an outer edge there, which grows. So, counted from the first part, there is a
        part for which both edges grow. This part is hit until then, and one such part is enough.
        """
        rows = row * 5
        every, step = self.contacts, wide[box] + np.abs(place - middle)[box]
        value = np.einsum("nk,nk->n", every.tables[rows, 0], self.monomials(place)[box])
        value = np.where(self.inner[row], np.abs(value), value) - every.slack[rows, 0]
        bend = 0.5 * np.einsum("njk,nj,nk->n", every.bend[rows], step, step)
        return np.asarray(value > bend * (1 + 1e-12))


def _alone(form: Array) -> Array:
    """Return a form without sides as the only contact of its pair, shape (1, 5, 3, 3)."""
    rows = np.zeros((1, 5, 3, 3), dtype=object)
    rows[0, 0], rows[0, 1:, 0, 0] = form, 1
    return rows


def _listed(box: Ints, row: Ints, count: int) -> Array:
    """Return the rows of each cell; cells ascend."""
    found = np.empty(count, dtype=object)
    for k, (a, b) in enumerate(pairwise(np.searchsorted(box, np.arange(count + 1)))):
        found[k] = row[a:b]
    return found


def _halved(
    low: Ints, high: Ints, origin: Ints, joint: Ints, chosen: Bools, lists: Array
) -> tuple[Ints, Ints, Ints, Ints, Ints]:
    """Cut some cells, each along a joint; both halves keep their rows."""
    low, high, joint = low[chosen], high[chosen], joint[chosen]
    origin = np.repeat(origin[chosen], 2)
    rows = [rows for rows, cut in zip(lists, chosen, strict=True) if cut for _ in (0, 1)]
    k = np.arange(len(low))
    middle = (low[k, joint] + high[k, joint]) // 2
    first, second = high.copy(), low.copy()
    first[k, joint], second[k, joint] = middle, middle
    low, high = (np.stack(x, axis=1).reshape(-1, 2) for x in ((low, second), (first, high)))
    box = np.repeat(np.arange(len(low)), [len(r) for r in rows])
    return low, high, origin, box, np.concatenate([np.zeros(0, dtype=np.int64), *rows])
