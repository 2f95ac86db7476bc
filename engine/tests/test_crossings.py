"""Crossings of curves: each is a zero, none is missing, and what is not proved is named."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
import sympy
from flint import arb, fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import root

from cspace import find_region
from cspace.proofs.exact.numbers import precision
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.exact.region import crossings, folds
from engine_support.exact import stated
from engine_support.forms import PP, PR, RP, RR, SQUARE
from engine_support.robots import random_robot
from qbound.forms import HarmonicForm


def places(found) -> np.ndarray:
    return np.array([[float(x) for x in c.q] for c in found]).reshape(-1, 2)


def gap(one, other, kinds) -> float:
    """Distance of two configurations, full turns aside."""
    circle = np.array([kind == "revolute" for kind in kinds])
    d = one - other
    return np.abs(np.where(circle, (d + np.pi) % (2 * np.pi) - np.pi, d)).max(axis=-1)


def test_closed_forms_are_hit_to_60_digits():
    """cos q1 = 1/2 and sin q2 = 3/5: four crossings, by SymPy."""
    problem = stated(RR, [{"00": -0.5, "10": 1}, {"00": -3, "02": 5}])
    crossed = crossings(problem)
    assert not crossed.undecided
    alpha = sympy.asin(sympy.Rational(3, 5))
    expected = [(s * sympy.pi / 3, t) for s in (1, -1) for t in (alpha, sympy.pi - alpha)]
    assert len(crossed.crossings) == 4
    with precision(212):
        for q1, q2 in expected:
            decimals = [arb(str(sympy.N(x, 70))) for x in (q1, q2)]
            hits = [
                c
                for c in crossed.crossings
                if all(abs(a - b) < arb("1e-58") for a, b in zip(c.q, decimals, strict=True))
            ]
            assert len(hits) == 1


def test_numbers_beyond_doubles_are_refused_and_hide_no_crossing():
    """As doubles they are infinite and the bounds NaN: pieces with crossings were dropped."""
    disc = stated(PP, [{"00": 1, "20": -1, "02": -1}, {"10": 1, "01": 2}], SQUARE)
    assert len([c for c in crossings(disc).crossings if c.names == ("f0", "f1")]) == 2
    huge = disc.forms.coefficients * fmpq(10) ** 320
    with pytest.raises(ValueError, match="inf; finite numbers only"):
        crossings(replace(disc, forms=HarmonicForm(huge, PP)))


def test_vertices_of_the_paper_robot_are_zeros_by_hand_at_50_digits():
    """|r - r'| = 0.1 and the floor, from Tables 1 and 3-5, typed again and evaluated by mpmath."""
    crossed = crossings(exact_problem(exact_robot("minervabot-v2")))
    assert not crossed.undecided
    assert len(crossed.crossings) == 32
    assert len(crossed.feasible) == 24

    def values(q1, q2):
        m, cos, sin = mpmath.mpf, mpmath.cos, mpmath.sin
        x1 = m("11.5") * cos(q1) + m("4.91") * sin(q1) - m("7.5")
        z1 = m("4.91") * cos(q1) - m("11.5") * sin(q1) + m("22.5") - m("12.5")
        x4 = m("9") * cos(q2) + m("5.25") * sin(q2) + 15 - m("4.83")
        z4 = m("5.25") * cos(q2) - m("9") * sin(q2) + m("25.98") - m("23.37")
        floor = m("22.5") - 15 * sin(q1) + m("25.98") * cos(q1) - 25 * sin(q1 + q2) - m("11.32")
        d2 = m("0.01")
        return {"B1": x1**2 + z1**2 - d2, "B4": x4**2 + z4**2 - d2, "B7": floor}

    with mpmath.workdps(60):
        for crossing in crossed.crossings:
            q = [mpmath.mpf(x.mid().str(55, radius=False)) for x in crossing.q]
            there = values(*q)
            for name in set(crossing.names) & set(there):
                assert abs(there[name]) < mpmath.mpf(10) ** -45


@pytest.mark.parametrize("seed", range(24))
def test_every_vertex_of_the_float_engine_is_proved_and_no_other_is_feasible(seed):
    robot = random_robot(seed)
    crossed = crossings(exact_problem(exact_robot(robot)))
    assert not crossed.undecided
    proposed = np.array([v.q for c in find_region(robot).components for v in c.vertices])
    proved = places(crossed.feasible)
    for q in proposed.reshape(-1, 2):
        assert gap(proved, q, robot.kinds).min() < 1e-9
    assert len(proved) == len(proposed)


@settings(max_examples=15)
@given(st.integers(0, 10**6), st.sampled_from([RR, RP, PR, PP]))
def test_newton_from_many_starts_finds_no_other_crossing(seed, kinds):
    rng = np.random.default_rng(seed)
    table = rng.normal(size=(2, 3, 3))
    terms = [{f"{i}{j}": c[i, j] for i in range(3) for j in range(3)} for c in table]
    ranges = [None if kind == "revolute" else (-2, 2) for kind in kinds]
    crossed = crossings(stated(kinds, terms, ranges))
    known = places(c for c in crossed.crossings if c.names == ("f0", "f1"))
    form = HarmonicForm(table, kinds)
    for start in rng.uniform(-2, 2, (30, 2)):
        end = root(form, start, tol=1e-13)
        inside = all(r is None or abs(x) < 2 for x, r in zip(end.x, ranges, strict=True))
        if end.success and np.abs(form(end.x)).max() < 1e-11 and inside:
            assert gap(known, end.x, kinds).min() < 1e-6


CURVE = {"00": -0.5, "10": 1, "01": 1}
UNDECIDED = {
    "the same form twice": [CURVE, CURVE],
    "a form and a multiple": [CURVE, {k: 3 * v for k, v in CURVE.items()}],
    "a form and its negative": [CURVE, {k: -v for k, v in CURVE.items()}],
    # cos q1 + cos q2 = 2 at the origin alone, where the other one crosses itself
    "a point and a node": [{"00": -2, "10": 1, "01": 1}, {"10": 1, "01": -1}],
}


@pytest.mark.parametrize("name", UNDECIDED)
def test_curves_that_touch_at_a_fold_or_coincide_are_undecided_by_name(name):
    crossed = crossings(stated(RR, UNDECIDED[name]))
    assert crossed.undecided == ("f0 and f1",)


TWICE = {
    "over one value": (
        [{"00": -1, "20": 4}, {"00": -1, "02": 4}],
        [[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]],
    ),
    "circles": (
        [{"00": -5, "20": 16, "02": 16}, {"00": -1, "20": 4, "10": -4, "02": 4}],
        [[1 / 16, -((79 / 256) ** 0.5)], [1 / 16, (79 / 256) ** 0.5]],
    ),
    "parallel lines": ([{"00": -1, "20": 4}, {"00": -1, "20": 2}], []),
}


@pytest.mark.parametrize("name", TWICE)
def test_forms_may_share_both_roots_over_one_value(name):
    terms, expected = TWICE[name]
    crossed = crossings(stated(PP, terms, SQUARE))
    found = places(c for c in crossed.crossings if c.names == ("f0", "f1"))
    assert_allclose(sorted(map(tuple, found)), expected, atol=1e-14)
    assert "f0 and f1" not in crossed.undecided


def test_forms_that_never_vanish_leave_nothing_undecided():
    crossed = crossings(stated(RR, [{"00": 3, "10": 1}, {"00": 3, "10": 1}, {"00": 1}]))
    assert crossed.crossings == crossed.undecided == ()


def test_a_third_curve_through_a_crossing_is_not_judged():
    lines = [{"10": 1, "01": 1}, {"10": 1, "01": -1}, {"10": 1}]
    crossed = crossings(stated(PP, lines, SQUARE))
    middle = [c for c in crossed.crossings if {*c.names} < {"f0", "f1", "f2"}]
    assert [c.others for c in middle] == ["undecided"] * 3


def test_limits_cross_forms_and_one_another():
    disc = {"00": 1.25, "20": -1, "02": -1}  # radius sqrt 5/4: cuts each side twice
    crossed = crossings(stated(PP, [disc], SQUARE))
    sides = [c for c in crossed.crossings if c.names[0] == "f0"]
    assert_allclose(np.sort(np.abs(places(sides)), axis=1), [[0.5, 1]] * 8, atol=1e-15)
    corners = [c for c in crossed.crossings if c.names[0] != "f0"]
    assert [c.others for c in corners] == ["refuted"] * 4


def test_a_curve_that_touches_a_limit_is_undecided():
    disc = {"00": 1, "20": -1, "02": -1}
    assert len(crossings(stated(PP, [disc], SQUARE)).undecided) == 4


def test_folds_are_where_a_curve_turns_back():
    """cos q1 + cos q2 = 1/2 turns back in q1 at q2 = 0 (q1 = +-120 deg) and nowhere else."""
    crossed = folds(stated(RR, [CURVE]))
    assert not crossed.undecided
    expected = [[-2 * np.pi / 3, 0], [2 * np.pi / 3, 0]]
    assert_allclose(sorted(places(crossed.crossings).tolist()), expected, atol=1e-14)


def test_three_joints_are_refused():
    robot = exact_problem(exact_robot("minervabot-v2"), {0: 0.0})
    with pytest.raises(ValueError, match="two joints"):
        crossings(robot)
