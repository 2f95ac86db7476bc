"""Forms and cells, without a robot: critical values, roots in order, and an edge table."""

from itertools import pairwise, product
from math import acos, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from qbound.forms.harmonic import HarmonicForm, Kind, basis
from qbound.region.cells import Complex
from qbound.region.decomposition import Plane, critical_values, decompose

RR: tuple[Kind, Kind] = ("revolute", "revolute")
RP: tuple[Kind, Kind] = ("revolute", "prismatic")
PR: tuple[Kind, Kind] = ("prismatic", "revolute")
PP: tuple[Kind, Kind] = ("prismatic", "prismatic")
ROUND = (None, None)
SQUARE = ((-1.0, 1.0), (-1.0, 1.0))
TURN = 2 * pi

Piece = tuple[float, tuple[bool, bool], int]
Ranges = tuple[tuple[float, float] | None, tuple[float, float] | None]


def forms(kinds, *terms) -> HarmonicForm:
    """Stack forms given as {"ij": coefficient}, i and j the functions 1, cos, sin or 1, q, q^2."""
    table = np.zeros((len(terms), 3, 3))
    for m, form in enumerate(terms):
        for key, value in form.items():
            table[m, int(key[0]), int(key[1])] = value
    return HarmonicForm(table, kinds)


def pieces(stack: HarmonicForm, ranges: Ranges, base: int) -> list[Piece]:
    """Area, wraps (in the order of the joints) and number of loops, largest area first."""
    cells = Complex(decompose(Plane(stack, ranges, base)))
    found = []
    for sheets, wraps in cells.components():
        area = sum(area_of(cells, k) for k in sheets)
        one, other = wraps if base == 0 else wraps[::-1]
        found.append((area, (bool(one), bool(other)), len(cells.loops(set(sheets)))))
    return sorted(found, reverse=True)


def values_at(plane: Plane, t, v) -> np.ndarray:
    """Every form at paired base and lift values, shape (len(t), m)."""
    base, lift = basis(plane.base_kind, t), basis(plane.lift_kind, v)
    return np.einsum("ti,mij,tj->tm", base, plane.table, lift)


def area_of(cells: Complex, k: int, n: int = 60, panels: int = 12) -> float:
    """Gauss-Legendre, in panels of the angle of t = middle + half sin(angle): no fold spoils it."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    start, end = cells.spans([k])[0]
    edges = np.linspace(-pi / 2, pi / 2, panels + 1)
    angle = (edges[:-1, None] + (nodes + 1) / 2 * pi / panels).ravel()
    t = (start + end) / 2 + (end - start) / 2 * np.sin(angle)
    lower, upper = cells.interval([k], t[None])[:, 0]
    steps = np.tile(weights, panels) * pi / panels / 2 * (end - start) / 2 * np.cos(angle)
    return ((upper - lower) * steps).sum()


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
    "1 - cos q2": (RR, ROUND, [{"00": 1, "01": -1}], [(TORUS, FIRST, 2)]),
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
    "saddle, the other way": (PP, SQUARE, [{"20": -1, "02": 1}], [(1, NO, 1)] * 2),
    "x^2": (PP, SQUARE, [{"20": 1}], [(2, NO, 1)] * 2),  # a double line separates
    "-x^2": (PP, SQUARE, [{"20": -1}], []),
    "(x - y)^2": (PP, SQUARE, [{"20": 1, "11": -2, "02": 1}], [(2, NO, 1)] * 2),
    "1 - cos(q1 - q2)": (RR, ROUND, [{"00": 1, "11": -1, "22": -1}], [(TORUS, DIAGONAL, 2)]),
    # Two forbidden discs that touch: above and below hang together round them, one hole.
    "tangent discs": (
        PP,
        ((-3.0, 3.0), (-2.0, 2.0)),
        [{"20": 1, "10": -2, "02": 1}, {"20": 1, "10": 2, "02": 1}],
        [(24 - 2 * pi, NO, 2)],
    ),
    # A forbidden disc that touches both limits cuts in two.
    "disc between limits": (
        PP,
        ((-1.0, 1.0), (-2.0, 2.0)),
        [{"00": -1, "20": 1, "02": 1}],
        [(4 - pi / 2, NO, 1)] * 2,
    ),
    "disc inside": (PP, SQUARE, [{"00": -0.25, "20": 1, "02": 1}], [(4 - pi / 4, NO, 2)]),
    "disc alone": (PP, SQUARE, [{"00": 0.25, "20": -1, "02": -1}], [(pi / 4, NO, 1)]),
    "one curve": (RR, ROUND, [{"00": -0.5, "10": 1, "01": 1}], [(LENS, NO, 1)]),
    "the same form twice": (RR, ROUND, [{"00": -0.5, "10": 1, "01": 1}] * 2, [(LENS, NO, 1)]),
    "scaled copies": (
        RR,
        ROUND,
        [{"00": -0.5 * k, "10": k, "01": k} for k in (1e-3, 1, 700)],
        [(LENS, NO, 1)],
    ),
    # No open set between a form and its negative.
    "a form and its negative": (
        RR,
        ROUND,
        [{"00": -0.5 * k, "10": k, "01": k} for k in (1, -1)],
        [],
    ),
    "parallel walls": (
        RR,
        ROUND,
        [{"10": 1}, {"00": -0.5, "10": 1}],
        [(TURN**2 / 3, SECOND, 2)],  # the tighter one counts
    ),
    "parallel walls of the lift": (
        RR,
        ROUND,
        [{"01": 1}, {"00": -0.5, "01": 1}],
        [(TURN**2 / 3, FIRST, 2)],
    ),
    "three curves at a point": (
        RR,
        ROUND,
        [{"20": 1}, {"02": 1}, {"20": 1, "02": 1}],
        [(pi**2, NO, 1)],  # the third only touches corners of the square
    ),
    "three lines at a point": (
        PP,
        SQUARE,
        [{"10": 1, "01": 1}, {"10": 1, "01": -1}, {"10": 1}],
        [(1, NO, 1)],
    ),
    "without the second joint": (RR, ROUND, [{"20": 1}], [(TORUS / 2, SECOND, 2)]),  # a band
    "without the first joint": (RR, ROUND, [{"02": 1}], [(TORUS / 2, FIRST, 2)]),
    # The torus less a disc still goes round both ways; its one loop is the disc's.
    "a hole in the torus": (
        RR,
        ROUND,
        [{"00": 1.5, "10": -1, "01": -1}],
        [(TORUS - DISC, BOTH, 1)],
    ),
    "a hole within limits": (
        RR,
        ((-2.0, 2.0), (-2.0, 2.0)),
        [{"00": 1.5, "10": -1, "01": -1}],
        [(16 - DISC, NO, 2)],
    ),
    "a band round the cylinder": (
        RP,
        (None, (-2.0, 2.0)),
        [{"01": 1, "10": -1}],
        [(8 * pi / 2, FIRST, 2)],
    ),
    "a band, joints swapped": (
        PR,
        ((-2.0, 2.0), None),
        [{"10": 1, "01": -1}],
        [(8 * pi / 2, SECOND, 2)],
    ),
    # y cos q > 1: the root runs through infinity at q = pi / 2.
    "a root through infinity": (
        RP,
        (None, (-2.0, 2.0)),
        [{"00": -1, "11": 1}],
        [(HYPERBOLA, NO, 1)] * 2,
    ),
    "limits, no forms": (RR, ((-1.0, 2.0), None), [], [(6 * pi, SECOND, 2)]),
    # On the real line q and q + 2 pi are two places.
    "limits wider than a turn": (RR, ((-4.0, 4.0), (-1.0, 1.0)), [], [(16, NO, 1)]),
    "many turns": (
        RR,
        ((-7.0, 7.0), (-1.0, 1.0)),
        [{"10": 1}],
        [(TURN, NO, 1), (14 - 3 * pi, NO, 1), (14 - 3 * pi, NO, 1)],
    ),
    "a range of no width": (RR, ((0.5, 0.5), None), [], []),  # no open set
    "parallel lines": (
        PP,
        SQUARE,
        [{"00": 0.5, "10": 1, "01": 1}, {"00": -0.5, "10": 1, "01": 1}],
        [(1.125, NO, 1)],
    ),
    "a strip": (
        PP,
        SQUARE,
        [{"10": 1, "01": 1}, {"00": 0.5, "10": -1, "01": -1}],
        [(0.875, NO, 1)],
    ),
    "coincident lines": (PP, SQUARE, [{"10": 1, "01": 1}, {"10": 2, "01": 2}], [(2, NO, 1)]),
    "opposite lines": (PP, SQUARE, [{"10": 1, "01": 1}, {"10": -1, "01": -1}], []),
    "a line through corners": (PP, SQUARE, [{"10": 1, "01": -1}], [(2, NO, 1)]),
    "a line along a limit": (PP, SQUARE, [{"00": 1, "10": 1}], [(4, NO, 1)]),
}


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("name", EDGES)
def test_edge_cases_have_the_right_pieces(name, base):
    kinds, ranges, terms, expected = EDGES[name]
    found = pieces(forms(kinds, *terms), ranges, base)
    assert [piece[1:] for piece in found] == [piece[1:] for piece in expected]
    assert_allclose([piece[0] for piece in found], [p[0] for p in expected], rtol=1e-8)


@pytest.mark.parametrize("base", [0, 1])
def test_touching_in_a_point_does_not_cut_the_torus(base):
    # 2 - cos q1 - cos q2 is zero at the origin alone: the closure is the whole torus.
    (piece,) = pieces(forms(RR, {"00": 2, "10": -1, "01": -1}), ROUND, base)
    assert_allclose(piece[0], TORUS, rtol=1e-9)
    assert piece[1] == BOTH


# --- critical values and roots -------------------------------------------------------------------


def random_plane(seed: int, base: int, kinds: tuple[Kind, Kind]) -> Plane:
    rng = np.random.default_rng(seed)
    table = rng.normal(size=(rng.integers(1, 5), 3, 3))
    table *= rng.random(table.shape) < 0.7  # some functions missing
    sides = [None if k == "revolute" and rng.random() < 0.5 else (-1.5, 2.0) for k in kinds]
    return Plane(HarmonicForm(table, kinds), sides, base)


def order_of_roots(plane: Plane, t: float) -> list[tuple[int, int]]:
    """Form and branch of every root within the range, ascending, by sampling alone."""
    low, high = plane.lift_ends
    v = np.linspace(low, high, 6001)
    values = values_at(plane, np.full(len(v), t), v)
    change = np.diff(np.sign(values), axis=0)
    where, form = np.nonzero(change)
    return [(int(m), int(np.sign(change[k, m]))) for k, m in zip(where, form, strict=True)]


def rotated(order: list) -> list:
    """One of all rotations, so that a root that passes the cut of the circle does not count."""
    return min((order[k:] + order[:k] for k in range(len(order))), default=order)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.sampled_from([0, 1]), st.sampled_from([RR, RP, PR, PP]))
def test_the_order_of_roots_is_the_same_all_over_a_slab(seed, base, kinds):
    plane = random_plane(seed, base, kinds)
    lines = critical_values(plane)
    tidy = rotated if plane.lift_range is None else list
    for start, end in pairwise(lines):
        if end - start > 0.02:
            places = start + (end - start) * np.array([0.2, 0.5, 0.8])
            first, *others = [tidy(order_of_roots(plane, t)) for t in places]
            assert all(order == first for order in others)


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize(
    ("terms", "expected"),
    [
        ([{"00": 1.5, "10": -1, "01": -1}], [-pi / 3, pi / 3]),  # folds of the disc
        ([{"10": 1, "01": 1}, {"10": 1, "01": -1}], [-pi / 2, pi / 2]),  # crossings
        ([{"00": -2, "10": 1, "01": 1}], [0.0]),  # the disc is a point
    ],
)
def test_critical_values_hold_folds_and_crossings(terms, expected, base):
    lines = critical_values(Plane(forms(RR, *terms), ROUND, base))
    for value in expected:
        assert np.abs(lines - value).min() < 1e-6


@pytest.mark.parametrize("base", [0, 1])
def test_coincident_forms_add_no_critical_values(base):
    disc = {"00": 1.5, "10": -1, "01": -1}
    once, twice = (critical_values(Plane(forms(RR, *[disc] * n), ROUND, base)) for n in (1, 2))
    assert_allclose(once, twice, atol=1e-9)


@given(st.integers(0, 10**6), st.sampled_from([0, 1]), st.sampled_from([RR, RP, PR, PP]))
def test_roots_are_zeros_of_their_forms(seed, base, kinds):
    plane = random_plane(seed, base, kinds)
    t = np.linspace(*plane.ends, 17)
    roots = plane.roots(t)
    for branch, m in product((0, 1), range(len(plane.table))):
        v = roots[branch, :, m]
        held = np.isfinite(v) & (np.abs(v) < 100)
        values = values_at(plane, t[held], v[held])[:, m]
        assert_allclose(values / (1 + v[held] ** 2), 0, atol=1e-11)
