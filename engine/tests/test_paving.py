"""Pavings: every cell is what it is called, and the brackets hold areas known otherwise."""

from fractions import Fraction
from math import pi

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st

from cspace import find_region
from cspace.proofs.exact.numbers import precision
from cspace.proofs.exact.problem import ExactProblem, exact_problem, exact_robot
from cspace.proofs.subpaving.paving import Paving, pave, start
from engine_support.exact import stated
from engine_support.robots import random_robot

PPP = ("prismatic",) * 3


def ball_of_three() -> ExactProblem:
    """1 - x^2 - y^2 - z^2 > 0 within [-1.5, 1.5]^3."""
    sides = tuple((arb(-1.5), arb(1.5)) for _ in PPP)
    disc = stated(PPP[:2], [{"00": 1, "20": -1, "02": -1}])
    table = np.zeros((1, 3, 3, 3), dtype=object)
    table[..., 0] = disc.forms.coefficients
    table[0, 0, 0, 2] = -1
    names = tuple((f"q{j}.lower", f"q{j}.upper") for j in range(3))
    return ExactProblem(type(disc.forms)(table, PPP), ("ball",), sides, names)


@settings(max_examples=12)
@given(st.integers(0, 10**6))
def test_the_bracket_of_a_random_robot_holds_the_float_engine_s_area(seed):
    robot = random_robot(seed)
    paving = pave(exact_problem(exact_robot(robot)), 0.02)
    inner, outer = (float(x) for x in paving.bracket)
    assert inner - 1e-9 <= find_region(robot).area <= outer + 1e-9
    fill = [Fraction(len(c), 2**c.level) for c in (*paving.feasible, *paving.infeasible)]
    assert sum(fill) + paving.undecided_fraction == 1


@settings(max_examples=12)
@given(st.integers(0, 10**6))
def test_cells_are_what_they_are_called_at_their_corners_in_balls(seed):
    paving = pave(exact_problem(exact_robot(random_robot(seed))), 0.05)
    rng = np.random.default_rng(seed)
    with precision(100):
        for cells in (*paving.feasible, *paving.infeasible):
            for k in rng.integers(0, len(cells), 3):
                for place in corners(paving, cells, k):
                    there = paving.problem.forms(place)
                    if cells in paving.feasible:
                        assert all(arb(x) > 0 for x in there)
                    else:
                        assert any(arb(x) < 0 for x in there)


def corners(paving: Paving, cells, k: int):
    one, other = (
        paving.bounds.edge(j, b, i)
        for j, (b, i) in enumerate(zip(cells.bits, cells.index[k], strict=True))
    )
    return [(x, y) for x in one for y in other]


def test_three_joints_are_paved_around_a_known_volume():
    paving = pave(ball_of_three(), 0.03)
    inner, outer = (float(x) for x in paving.bracket)
    assert inner < 4 * pi / 3 < outer
    assert paving.undecided_fraction <= 0.03
    assert abs((outer - inner) - 27 * float(paving.undecided_fraction)) < 1e-9


def test_a_paving_stops_at_the_most_cells_and_says_what_is_undecided():
    paving = pave(exact_problem(exact_robot("minervabot-v2")), 1e-9, most=500)
    assert len(paving.undecided) <= 500
    assert paving.undecided_fraction > 1e-9


@pytest.mark.parametrize("tolerance", [0.0, -1.0, float("nan")])
def test_a_tolerance_that_cannot_be_met_is_refused(tolerance):
    with pytest.raises(ValueError, match="positive"):
        pave(exact_problem(exact_robot("minervabot-v2")), tolerance)


def test_touching_forms_are_never_decided():
    paving = pave(stated(("revolute",) * 2, [{"00": 2, "10": -1, "01": -1}]), 1e-4)
    assert len(paving.undecided)  # 2 - cos q1 - cos q2 is 0 at the origin
    assert not paving.infeasible


def test_cells_pass_on_the_forms_that_may_vanish_and_lose_nothing():
    """Sorted by all forms at once the cells are the same: those that were dropped are positive."""
    problem = exact_problem(exact_robot("two-joint-arm-with-walls"))
    paving = start(problem)
    for _ in range(11):
        cells = paving.undecided.halves()
        low, high = paving.bounds.bounds(cells)
        finer = paving.refined()
        left = cells[~(low > 0).all(axis=1) & ~(high < 0).any(axis=1)]
        assert sum(count for count, _ in finer.runs) == len(finer.undecided) == len(left)
        assert {*map(tuple, finer.undecided.index)} == {*map(tuple, left.index)}
        paving = finer
    assert min(len(forms) for _, forms in paving.runs) < len(problem.names)
