r"""The place of a point beyond a chain of joints as a sum of waves, and its bounds over a cell.

A place r of a frame, seen from a frame before it, is a sum of waves of the joints that turn,
each with at most one joint that slides as a factor:

    r(q) = sum_k A_k exp(i w_k . q) q_s(k)

Waves with the same s and with w and -w are conjugate, so half of them with twice the amplitude and
the real part are enough. Along a step d the second derivative of a wave without a slide is at most
its size times :math:`(w \cdot d)^2`; with a slide it is at most its size times
:math:`|q_s| (w \cdot d)^2 + 2 |d_s| |w \cdot d|`. So value + gradient . d - (half of the sum of
these) bounds from below, and it is concave in d.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property, reduce
from itertools import combinations_with_replacement
from typing import Any

from flint import acb, acb_mat, arb, arb_mat, ctx

from qbound.proofs.second.cells import Cell
from qbound.proofs.second.normal import Form as NormalForm
from qbound.proofs.second.reading import Work, exact

Key = tuple[tuple[int, ...], int | None]
"""The turns of a wave in all joints, and the joint that slides in it."""

Terms = dict[Key, Any]

GUARD = 40
"""Bits of the balls below which, beside the largest, an amplitude is rounding."""

CELL_WORK = 40
"""Microseconds of a cell, however few the waves."""


class Chain:
    """The steps of a robot in balls.

    Attributes
    ----------
    units : list of arb
        Radians or lengths in one unit of the file, for each joint.
    """

    def __init__(self, form: NormalForm, work: Work) -> None:
        degrees = form["angle_unit"] == "deg"
        self.work, self.form = work, form
        self.turns = [joint["turns"] for joint in form["joints"]]
        self.units = [arb.pi() / 180 if turns and degrees else arb(1) for turns in self.turns]
        self.steps = [self._step(step, degrees) for step in form["steps"]]
        self.known: dict[int, list[Terms]] = {}

    def scaled(self, joints: Sequence[int], values: Sequence[Any]) -> list[Any]:
        """Turn values of some joints from the file's units into radians and lengths."""
        return [self.units[j] * x for j, x in zip(joints, values, strict=True)]

    def _step(self, step: Mapping[str, Any], degrees: bool) -> tuple[int, int, list[Any]]:
        """Return the joint of a step, the sense of its value, and the matrices of its motion.

        The matrices are the mount times the constant part, and times the part with exp(i q) or q.
        """
        mount = _affine(_one(), _vector(step["origin"]))
        for axis in (2, 1, 0):
            angle = exact(step["rpy"][axis])
            s, c = arb.sin_cos_pi_fmpq(angle / 180) if degrees else arb(angle).sin_cos()
            turn = [[arb(int(i == k)) for k in range(3)] for i in range(3)]
            i, k = (axis + 1) % 3, (axis + 2) % 3
            turn[i][i], turn[i][k], turn[k][i], turn[k][k] = c, -s, s, c
            mount = mount * _affine(turn, [0, 0, 0])
        x, y, z = _unit(_vector(step["axis"]))
        along = [[a * b for b in (x, y, z)] for a in (x, y, z)]
        if self.turns[step["joint"]]:
            cross = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
            wave = [
                [(acb(int(i == k)) - along[i][k] - acb(0, 1) * cross[i][k]) / 2 for k in range(3)]
                for i in range(3)
            ]
            parts = [_affine(along, [0, 0, 0]), _affine(wave, [0, 0, 0], 0)]
        else:
            parts = [_affine(_one(), [0, 0, 0]), _affine([[0, 0, 0]] * 3, [x, y, z], 0)]
        return step["joint"], int(step["factor"]), [mount * part for part in parts]

    def terms(self, near: int, far: int) -> Terms:
        """Return the waves of the pose of a frame, seen from one before it: 3 x 4 matrices."""
        zero = (tuple(0 for _ in self.turns), None)
        known = self.known.setdefault(near, [{zero: _affine(_one(), [0, 0, 0], 1, rows=3)}])
        while len(known) <= far - near:
            self.work.add(30 * len(known[-1]))
            known.append(self._beyond(known[-1], *self.steps[near + len(known) - 1]))
        return known[far - near]

    def _beyond(self, terms: Terms, j: int, sense: int, parts: Sequence[Any]) -> Terms:
        """Add a step to the waves of the frame before it."""
        found: Terms = {}

        def add(key: Key, value: Any) -> None:
            if any(not x.is_zero() for x in value.entries()):
                found[key] = found[key] + value if key in found else value

        for (turns, slide), pose in terms.items():
            if slide is not None:  # a slide moves the origin: no later step changes that
                add((turns, slide), pose)
                continue
            add((turns, None), pose * parts[0])
            if not self.turns[j]:
                add((turns, j), pose * parts[1] * sense)
                continue
            for way, part in ((sense, parts[1]), (-sense, parts[1].conjugate())):
                k = turns[j] + way
                if abs(k) < 2:  # the two turns of a parallelogram have no other waves
                    add(((*turns[:j], k, *turns[j + 1 :]), None), pose * part)
        return found


def _one() -> list[list[int]]:
    return [[int(i == k) for k in range(3)] for i in range(3)]


def _vector(texts: Sequence[str]) -> list[Any]:
    return [exact(text) for text in texts]


def _unit(vector: Sequence[Any]) -> list[Any]:
    """Give a rational direction the length 1."""
    length = arb(sum(x * x for x in vector)).sqrt()
    return [x / length for x in vector]


def _affine(rotation: Any, shift: Sequence[Any], last: int = 1, rows: int = 4) -> Any:
    """Return a motion as a matrix of four rows, or of three."""
    entries = [[*row, x] for row, x in zip(rotation, shift, strict=True)]
    return acb_mat([*entries, [0, 0, 0, last]][:rows])


# --- one place, or several, of a frame ------------------------------------------------------------


def held(terms: Terms, values: Mapping[int, Any]) -> Terms:
    """Return waves in which some joints have a value, rad or length."""
    found: Terms = {}
    for (turns, slide), value in terms.items():
        angle = sum((k * values[j] for j, k in enumerate(turns) if k and j in values), arb(0))
        factor = acb(0, angle).exp()
        rest = slide
        if slide is not None and slide in values:
            factor, rest = factor * values[slide], None
        key = (tuple(0 if j in values else k for j, k in enumerate(turns)), rest)
        found[key] = found[key] + value * factor if key in found else value * factor
    return found


def halved(terms: Terms, first: Sequence[int]) -> Terms:
    """Return one of every two conjugate waves, with twice the amplitude.

    first : the joints whose turns, if not all 0, decide which wave is kept; else the others decide.
    """
    found: Terms = {}
    for (turns, slide), value in terms.items():
        order = [turns[j] for j in first] + list(turns)
        sign = next((k for k in order if k), 0)
        if sign >= 0:
            found[turns, slide] = value * 2 if sign else value
    return found


def norm(values: Sequence[Any]) -> Any:
    """Return an upper bound of the length of a vector of balls."""
    return sum((arb(x.abs_upper()) ** 2 for x in values), arb(0)).sqrt()


def swing(values: Sequence[Any]) -> Any:
    """Return an upper bound of the length of the real part of exp(i t) v over all t."""
    a, b = norm([z.real for z in values]) ** 2, norm([z.imag for z in values]) ** 2
    c = sum((z.real * z.imag for z in values), arb(0))
    return ((a + b) / 2 + norm([(a - b) / 2, c])).sqrt()


class Form:
    """Real functions of some joints, or a complex vector of them, by their waves.

    Parameters
    ----------
    chain : Chain
    joints : sequence of int
        Joints that the functions depend on.
    terms : dict of Key to acb_mat
        Amplitudes, one row of d entries.
    reach : sequence of arb
        The largest value of each joint that slides.
    together : bool
        Whether the functions are one vector whose length is bounded; if not, each is bounded.
    """

    def __init__(
        self,
        chain: Chain,
        joints: Sequence[int],
        terms: Terms,
        reach: Sequence[Any],
        together: bool = False,
    ) -> None:
        self.chain, self.joints, self.together = chain, list(joints), together
        rows = []
        for (turns, slide), value in terms.items():
            entries = value.entries()
            sizes = [swing(entries)] if together else [swing([z]) for z in entries]
            most = largest(sizes) * (1 if slide is None else reach[slide])
            place = None if slide is None else self.joints.index(slide)
            rows.append(([turns[j] for j in self.joints], place, entries, sizes, most.upper()))
        small = highest([row[4] for row in rows]) * arb(2) ** (GUARD - ctx.prec)
        self.rest = sum((row[4] for row in rows if not row[4] > small), arb(0))
        rows = [row for row in rows if row[4] > small] or rows[:1]
        self.turns, self.slides = [row[0] for row in rows], [row[1] for row in rows]
        self.turn_matrix = arb_mat(len(rows), len(joints), [k for row in self.turns for k in row])
        self.count = len(rows[0][2])
        real, imag = (
            [[z.real for z in row[2]] for row in rows],
            [[z.imag for z in row[2]] for row in rows],
        )
        self.parts = arb_mat([[*x, *y] for x, y in zip(real, imag, strict=True)])
        swapped = [[*[-z for z in y], *x] for x, y in zip(real, imag, strict=True)]
        self.swapped = arb_mat(swapped)
        self.sizes = [row[3] for row in rows]
        own = {s: self.joints[s] for s in self.slides if s is not None}
        self.reach: dict[int | None, float] = {s: float(reach[j]) for s, j in own.items()}
        self.reach[None] = 1.0

    @property
    def size(self) -> int:
        """Upper bound of the number of balls."""
        return len(self.turns) * (len(self.joints) ** 2 + 5 * self.count + 5)

    @property
    def cost(self) -> int:
        """Approximate microseconds for one cell."""
        n, k = len(self.joints), len(self.turns)
        return CELL_WORK + k * (n + 2 + self.count) + (1 << n) * (n * n + 2 * self.count)

    def expanded(self, q: Sequence[Any]) -> Any:
        """Return values and derivatives at joint values, real parts before imaginary ones."""
        real, imag, zero = [], [], arb(0)
        angles = (self.turn_matrix * arb_mat(len(q), 1, list(q))).entries()
        for turns, slide, angle in zip(self.turns, self.slides, angles, strict=True):
            s, c = angle.sin_cos()
            x, y = (c, s) if slide is None else (c * q[slide], s * q[slide])
            of_x, of_y = (zero, -y, y), (zero, x, -x)  # indexed by the turns 0, 1 and -1
            column_x, column_y = [x, *(of_x[k] for k in turns)], [y, *(of_y[k] for k in turns)]
            if slide is not None:
                column_x[1 + slide] += c
                column_y[1 + slide] += s
            real.append(column_x)
            imag.append(column_y)
        return arb_mat(real).transpose() * self.parts + arb_mat(imag).transpose() * self.swapped

    def over(self, cell: Cell) -> tuple[Any, Any]:
        """Return the linear form at the corners of a cell, and how far the functions are from it.

        Two matrices with a row for each corner. The second one has a single column if `together` is
        set.
        """
        self.chain.work.add(self.cost)
        scaled, joints, middle = self.chain.scaled, self.joints, cell.middle
        steps = [scaled(joints, step) for step in cell.steps(joints)]
        q = scaled(joints, [middle[j] for j in joints])
        linear = arb_mat([[1, *step] for step in steps]) * self.expanded(q)
        widths = [largest(column) for column in zip(*steps, strict=True)]
        pairs = [[*(a * b for a, b in combinations_with_replacement(d, 2)), 1] for d in steps]
        return linear, arb_mat(pairs) * self._bending(q, widths)

    def _bending(self, q: Sequence[Any], widths: Sequence[Any]) -> Any:
        """Return the sum of a_k Q_k w_k w_k^T / 2, then the part that does not depend on the step.

        The rows are the pairs of joints, each pair once, and one more row.
        """
        if not any(s is not None for s in self.slides):
            return self._bending_of_turns
        scales, rest = [], [self.rest] * len(self.sizes[0])
        for turns, s, sizes in zip(self.turns, self.slides, self.sizes, strict=True):
            scales.append(arb(1) if s is None else abs(q[s]) + widths[s])
            if s is not None:
                angle = sum((abs(k) * d for k, d in zip(turns, widths, strict=True)), arb(0))
                rest = [x + a * widths[s] * angle for x, a in zip(rest, sizes, strict=True)]
        return self._stacked(scales, rest)

    @cached_property
    def _bending_of_turns(self) -> Any:
        """The bending of a form without slides, which is the same on every cell."""
        return self._stacked([arb(1)] * len(self.sizes), [self.rest] * len(self.sizes[0]))

    def _stacked(self, scales: Sequence[Any], rest: Sequence[Any]) -> Any:
        weights = [[a * x for a in row] for row, x in zip(self.sizes, scales, strict=True)]
        return arb_mat([*(self._squares * arb_mat(weights)).tolist(), list(rest)])

    @cached_property
    def _squares(self) -> Any:
        pairs = list(combinations_with_replacement(range(len(self.joints)), 2))
        halves = [arb(w[i] * w[j]) / (1 + (i == j)) for i, j in pairs for w in self.turns]
        return arb_mat(len(pairs), len(self.turns), halves)

    def best_cut(self, cell: Cell) -> int | None:
        """Return the letter of the cut that reduces the error most; None if there is none."""
        self.chain.work.add(len(self.turns) * (1 + len(self.joints)) ** 2)
        best, found = 0.0, None
        for letter, step in cell.cuts(self.joints):
            d = [abs(float(x)) for x in self.chain.scaled(self.joints, step)]
            loss = 0.0
            for sizes, turns, s in zip(self.sizes, self.turns, self.slides, strict=True):
                angle = sum(abs(k) * x for k, x in zip(turns, d, strict=True))
                slides = 0.0 if s is None or not any(turns) else d[s]
                loss += sum(map(float, sizes)) * (angle**2 * self.reach[s] + slides)
            if loss > best:
                best, found = loss, letter
        return found


def highest(values: Sequence[Any]) -> Any:
    """Return the highest of some numbers, as a ball."""
    return reduce(lambda a, b: a.max(b), map(arb, values))


def largest(values: Sequence[Any]) -> Any:
    """Return the largest size of numbers, as a ball."""
    return highest([abs(x) for x in values])
