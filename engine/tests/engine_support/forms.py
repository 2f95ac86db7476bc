# ruff: noqa: E501  (one table, a case a line)
"""Forms of two joints, written as small tables, and the edge cases with what is right for each."""

from dataclasses import dataclass
from math import acos, log, pi, sqrt
from typing import Any

import numpy as np
from flint import arb, ctx
from numpy.typing import NDArray
from scipy.integrate import quad

from qbound.forms import HarmonicForm, Kind

RR: tuple[Kind, Kind] = ("revolute", "revolute")
RP: tuple[Kind, Kind] = ("revolute", "prismatic")
PR: tuple[Kind, Kind] = ("prismatic", "revolute")
PP: tuple[Kind, Kind] = ("prismatic", "prismatic")
ROUND = (None, None)
SQUARE = ((-1.0, 1.0), (-1.0, 1.0))
TURN = 2 * pi
LIMITS = (("q1.lower", "q1.upper"), ("q2.lower", "q2.upper"))

Piece = tuple[float, tuple[bool, bool], int]
Ranges = tuple[tuple[float, float] | None, tuple[float, float] | None]


def forms(kinds, *terms) -> HarmonicForm:
    """Stack forms given as {"ij": coefficient}, i and j the functions 1, cos, sin or 1, q, q^2."""
    table = np.zeros((len(terms), 3, 3))
    for m, form in enumerate(terms):
        for key, value in form.items():
            table[m, int(key[0]), int(key[1])] = value
    return HarmonicForm(table, kinds)


@dataclass(frozen=True, eq=False)
class Moved:
    """Forms with joints zeroed elsewhere and slides in another unit: nothing is whole any more.

    Attributes
    ----------
    forms : HarmonicForm
        The nearest doubles.
    errors : ndarray, shape (m, 3, 3)
        How far these are off.
    ranges : tuple of two (low, high) or None
    exact : ndarray of arb, shape (m, 3, 3)
    ends : tuple of two (arb, arb) or None
        The ranges, exact.
    part : float
        Areas shrink by it.
    """

    forms: HarmonicForm
    errors: NDArray[np.float64]
    ranges: Ranges
    exact: NDArray[Any]
    ends: tuple[Any, Any]
    part: float


def moved(stack: HarmonicForm, ranges: Ranges, rng) -> Moved:
    """What was q is stretch q' + by, in 1,280 bits."""
    matrices, ends, stretched = [], [], 1.0
    with ctx.workprec(1280):
        for kind, side in zip(stack.kinds, ranges, strict=True):
            by, stretch = arb(rng.uniform(-3, 3)), arb(1)
            if kind == "revolute":
                c, s = by.cos(), by.sin()
                matrices.append(np.array([[1, 0, 0], [0, c, -s], [0, s, c]]))
            else:
                stretch = arb(rng.uniform(0.3, 3))
                rows = [[1, 0, 0], [by, stretch, 0], [by**2, 2 * by * stretch, stretch**2]]
                matrices.append(np.array(rows))
            ends.append(side and tuple((arb(x) - by) / stretch for x in side))
            stretched *= float(stretch)
        one, other = matrices
        tables = [one.T @ (own.astype(object) * arb(1)) @ other for own in stack.coefficients]
        exact = np.array(tables, dtype=object).reshape(-1, 3, 3)
        doubles = exact.astype(float)
        off = abs(exact - doubles.astype(object)).astype(float) * (1 + 1e-9)
    sides = tuple(side and tuple(map(float, side)) for side in ends)
    found = HarmonicForm(doubles, stack.kinds)
    return Moved(found, off, sides, exact, tuple(ends), 1 / stretched)


def random_form(seed: int, joints: int) -> HarmonicForm:
    """Two forms of joints of any kind, every coefficient drawn."""
    rng = np.random.default_rng(seed)
    kinds = tuple(RP[k] for k in rng.integers(0, 2, joints))
    return HarmonicForm(rng.normal(size=(2, *(3,) * joints)), kinds)


# --- edge table ----------------------------------------------------------------------------------

LENS = quad(lambda q: 2 * acos(max(0.5 - np.cos(q), -1)), -acos(-0.5), acos(-0.5))[0]
"""Area of cos q1 + cos q2 > 0.5."""
DISC = 4 * quad(lambda q: acos(1.5 - np.cos(q)), 0, acos(0.5))[0]
"""Area of cos q1 + cos q2 > 1.5."""
HYPERBOLA = 4 * pi / 3 - 2 * log(2 + sqrt(3))
"""Area of y cos q > 1, 0 < y < 2."""

# Goes round both joints at once.
DIAGONAL = (True, True)
NO, BOTH, FIRST, SECOND = (False, False), (True, True), (True, False), (False, True)
TORUS = TURN**2

EDGES = {
    # name: (kinds, ranges, forms, pieces); the comment says why the pieces are right
    "no forms": (RR, ROUND, [], [(TORUS, BOTH, 0)]),  # nothing forbids, nothing bounds
    "a positive constant": (RR, ROUND, [{"00": 1}], [(TORUS, BOTH, 0)]),
    "a negative constant": (RR, ROUND, [{"00": -1}], []),
    "identically zero": (RR, ROUND, [{}], []),  # positive nowhere
    "negative everywhere": (RR, ROUND, [{"00": -3, "10": 1, "01": 1}], []),
    # A curve of zeros separates its two sides, though both are feasible.
    "1 - cos q1": (RR, ROUND, [{"00": 1, "10": -1}], [(TORUS, SECOND, 2)]),
    # Negative but for a line, a point.
    "cos q1 - 1": (RR, ROUND, [{"00": -1, "10": 1}], []),
    "cos q1 + cos q2 - 2": (RR, ROUND, [{"00": -2, "10": 1, "01": 1}], []),
    # Squares that touch at their corners stay apart.
    "cos q1 cos q2": (RR, ROUND, [{"11": 1}], [(pi**2, NO, 1)] * 2),
    # A diamond whose corners meet themselves round the torus goes round nothing.
    "cos q1 + cos q2": (RR, ROUND, [{"10": 1, "01": 1}], [(2 * pi**2, NO, 1)]),
    "cos q1 - cos q2": (RR, ROUND, [{"10": 1, "01": -1}], [(2 * pi**2, NO, 1)]),
    # x^2 > y^2: a saddle.
    "two lobes at a saddle": (PP, SQUARE, [{"20": 1, "02": -1}], [(1, NO, 1)] * 2),
    "x^2": (PP, SQUARE, [{"20": 1}], [(2, NO, 1)] * 2),  # a double line separates
    "-x^2": (PP, SQUARE, [{"20": -1}], []),
    "(x - y)^2": (PP, SQUARE, [{"20": 1, "11": -2, "02": 1}], [(2, NO, 1)] * 2),
    "1 - cos(q1 - q2)": (RR, ROUND, [{"00": 1, "11": -1, "22": -1}], [(TORUS, DIAGONAL, 2)]),
    # Two forbidden discs that touch: above and below hang together round them, one hole.
    "tangent discs": (PP, ((-3.0, 3.0), (-2.0, 2.0)), [{"20": 1, "10": -2, "02": 1}, {"20": 1, "10": 2, "02": 1}], [(24 - 2 * pi, NO, 2)]),
    # A forbidden disc that touches both limits cuts in two.
    "disc between limits": (PP, ((-1.0, 1.0), (-2.0, 2.0)), [{"00": -1, "20": 1, "02": 1}], [(4 - pi / 2, NO, 1)] * 2),
    "disc inside": (PP, SQUARE, [{"00": -0.25, "20": 1, "02": 1}], [(4 - pi / 4, NO, 2)]),
    "disc alone": (PP, SQUARE, [{"00": 0.25, "20": -1, "02": -1}], [(pi / 4, NO, 1)]),
    "one curve": (RR, ROUND, [{"00": -0.5, "10": 1, "01": 1}], [(LENS, NO, 1)]),
    "scaled copies": (RR, ROUND, [{"00": -0.5 * k, "10": k, "01": k} for k in (1e-3, 1, 700)], [(LENS, NO, 1)]),
    # No open set between a form and its negative.
    "a form and its negative": (RR, ROUND, [{"00": -0.5 * k, "10": k, "01": k} for k in (1, -1)], []),
    "parallel walls": (RR, ROUND, [{"10": 1}, {"00": -0.5, "10": 1}], [(TURN**2 / 3, SECOND, 2)]),  # the tighter one counts
    "three curves at a point": (
        RR,
        ROUND,
        [{"20": 1}, {"02": 1}, {"20": 1, "02": 1}],
        [(pi**2, NO, 1)],  # the third only touches corners of the square
    ),
    "three lines at a point": (PP, SQUARE, [{"10": 1, "01": 1}, {"10": 1, "01": -1}, {"10": 1}], [(1, NO, 1)]),
    "without the second joint": (RR, ROUND, [{"20": 1}], [(TORUS / 2, SECOND, 2)]),  # a band
    # The torus less a disc still goes round both ways; its one loop is the disc's.
    "a hole in the torus": (RR, ROUND, [{"00": 1.5, "10": -1, "01": -1}], [(TORUS - DISC, BOTH, 1)]),
    "a hole within limits": (RR, ((-2.0, 2.0), (-2.0, 2.0)), [{"00": 1.5, "10": -1, "01": -1}], [(16 - DISC, NO, 2)]),
    "a band round the cylinder": (RP, (None, (-2.0, 2.0)), [{"01": 1, "10": -1}], [(8 * pi / 2, FIRST, 2)]),
    # y cos q > 1: the root runs through infinity at q = pi / 2.
    "a root through infinity": (RP, (None, (-2.0, 2.0)), [{"00": -1, "11": 1}], [(HYPERBOLA, NO, 1)] * 2),
    "limits, no forms": (RR, ((-1.0, 2.0), None), [], [(6 * pi, SECOND, 2)]),
    # On the real line q and q + 2 pi are two places.
    "limits wider than a turn": (RR, ((-4.0, 4.0), (-1.0, 1.0)), [], [(16, NO, 1)]),
    "many turns": (RR, ((-7.0, 7.0), (-1.0, 1.0)), [{"10": 1}], [(TURN, NO, 1), (14 - 3 * pi, NO, 1), (14 - 3 * pi, NO, 1)]),
    "a range of no width": (RR, ((0.5, 0.5), None), [], []),  # no open set
    "parallel lines": (PP, SQUARE, [{"00": 0.5, "10": 1, "01": 1}, {"00": -0.5, "10": 1, "01": 1}], [(1.125, NO, 1)]),
    "a strip": (PP, SQUARE, [{"10": 1, "01": 1}, {"00": 0.5, "10": -1, "01": -1}], [(0.875, NO, 1)]),
    "coincident lines": (PP, SQUARE, [{"10": 1, "01": 1}, {"10": 2, "01": 2}], [(2, NO, 1)]),
    "opposite lines": (PP, SQUARE, [{"10": 1, "01": 1}, {"10": -1, "01": -1}], []),
    "a line through corners": (PP, SQUARE, [{"10": 1, "01": -1}], [(2, NO, 1)]),
    "a line along a limit": (PP, SQUARE, [{"00": 1, "10": 1}], [(4, NO, 1)]),
}  # fmt: skip
