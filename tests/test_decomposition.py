"""Forms and cells, without a robot: critical values, roots in order, and an edge table."""

from itertools import pairwise, product
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from qbound.forms.harmonic import HarmonicForm, Kind, basis
from qbound.region.decomposition import critical_values
from qbound.region.plane import Plane
from support.forms import BOTH, EDGES, PP, PR, ROUND, RP, RR, TORUS, forms
from support.regions import pieces


def values_at(plane: Plane, t, v) -> np.ndarray:
    """Every form at paired base and lift values, shape (len(t), m)."""
    base, lift = basis(plane.base_kind, t), basis(plane.lift_kind, v)
    return np.einsum("ti,mij,tj->tm", base, plane.table, lift)


# --- edge table ----------------------------------------------------------------------------------


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
