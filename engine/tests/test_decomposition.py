"""Forms and cells, without a robot: critical values, roots in order, and an edge table."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cspace.region.events import find_events
from cspace.region.plane import Plane, Precise, precision
from engine_support.forms import BOTH, EDGES, PP, PR, ROUND, RP, RR, TORUS, TURN, forms
from engine_support.regions import pieces, problem_of
from qbound.forms import HarmonicForm, Kind, basis


def values_at(plane: Plane, t, v) -> np.ndarray:
    """Every form at paired base and lift values, shape (len(t), m)."""
    base, lift = basis(plane.base_kind, t), basis(plane.lift_kind, v)
    return np.einsum("ti,mij,tj->tm", base, plane.table, lift)


def lines_of(precise: Precise):
    """All critical lines of a plane, also those at which nothing changes."""
    lines, _ = find_events(precise)
    return lines


def critical_values(stack, ranges, base: int) -> np.ndarray:
    """Base values of these lines."""
    return lines_of(Precise.of(problem_of(stack, ranges), base)).t


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


def random_plane(seed: int, base: int, kinds: tuple[Kind, Kind]) -> Precise:
    rng = np.random.default_rng(seed)
    table = rng.normal(size=(rng.integers(1, 5), 3, 3))
    table *= rng.random(table.shape) < 0.7  # some functions missing
    sides = [None if k == "revolute" and rng.random() < 0.5 else (-1.5, 2.0) for k in kinds]
    return Precise.of(problem_of(HarmonicForm(table, kinds), tuple(sides)), base)


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
    precise = random_plane(seed, base, kinds)
    plane, lines = precise.plane, lines_of(precise).t
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
    lines = critical_values(forms(RR, *terms), ROUND, base)
    for value in expected:
        assert np.abs(lines - value).min() < 1e-6


@pytest.mark.parametrize("base", [0, 1])
def test_coincident_forms_add_no_critical_values(base):
    disc = {"00": 1.5, "10": -1, "01": -1}
    once, twice = (critical_values(forms(RR, *[disc] * n), ROUND, base) for n in (1, 2))
    assert_allclose(once, twice, atol=1e-9)


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from([0, 1]), st.sampled_from([RR, RP, PR, PP]))
def test_roots_are_zeros_of_their_forms_within_their_errors(seed, base, kinds):
    """Balls say where the true roots are, and that the form vanishes there."""
    precise = random_plane(seed, base, kinds)
    plane, t = precise.plane, np.linspace(*precise.plane.ends, 9)
    every = np.arange(plane.count)
    values, errors, real = plane.roots_and_errors(every, plane.along_lift(t))
    for k, m in np.argwhere(real > 0).tolist():
        for branch in (0, 1):
            if plane.affine[m] and branch:
                continue
            with precision(256):
                at = arb(float(t[k]))
                root = precise.root(m, 2 * branch - 1, at, 256)
                assert precise.value(m, at, root, 256).contains(0)
                off = root - arb(float(values[branch, k, m]))
                turns = round(float(off.mid()) / TURN) if plane.lift_kind == "revolute" else 0
                clipped = 1e6 * plane.lift_unit  # no root farther out is wanted
                if abs(root) < clipped:
                    assert abs(off - 2 * turns * arb.pi()) < arb(float(errors[branch, k, m]))


@pytest.mark.parametrize("branch", [0, 1])
def test_where_doubles_cannot_tell_two_roots_from_none_they_say_so(branch):
    """1 - cos(q2 - a) has a double root for every q1, in doubles two or none."""
    told = set()
    for a in np.linspace(0.1, 3.0, 40):
        touching = forms(RR, {"00": 1, "01": -np.cos(a), "02": -np.sin(a)})
        plane = Plane(touching, ROUND, 0)
        values, errors, real = plane.roots_and_errors(np.array([0]), plane.along_lift(np.zeros(1)))
        told.add(int(real[0, 0]))
        off = values[branch, 0, 0] - a
        assert abs(off - TURN * round(off / TURN)) <= errors[branch, 0, 0] < 1e-6
    assert told == {0}
