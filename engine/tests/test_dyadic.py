"""Cells and bounds over them: rounding never spoils a bound, in any rounding mode."""

import subprocess
import sys
from itertools import product

import numpy as np
import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from cspace.proofs.exact.bounds import BoxBounds, Cells
from cspace.proofs.exact.numbers import precision
from engine_support.forms import random_form
from qbound.forms import HarmonicForm


def random_bounds(seed: int, joints: int) -> BoxBounds:
    form = random_form(seed, joints)
    rng = np.random.default_rng(seed)
    ends = [tuple(map(arb, np.sort(rng.uniform(-3, 3, 2)))) for _ in range(joints)]
    return BoxBounds(form, ends)


def random_cells(box: BoxBounds, level: int, count: int, seed: int) -> Cells:
    bits = Cells(level, np.zeros((1, len(box.ends)), dtype=np.int64)).bits
    rng = np.random.default_rng(seed)
    return Cells(level, rng.integers(0, 2**bits, (count, len(bits))))


@given(st.integers(0, 10**6), st.integers(1, 3), st.integers(0, 40))
def test_bounds_hold_at_corners_and_inside(seed, joints, level):
    box = random_bounds(seed, joints)
    cells = random_cells(box, level, 6, seed)
    below, above = box.bounds(cells)
    rng = np.random.default_rng(seed)
    with precision(100):
        for k in range(len(cells)):
            sides = zip(cells.bits, cells.index[k], strict=True)
            edges = [box.edge(j, b, i) for j, (b, i) in enumerate(sides)]
            ends = [(low, (low + high) / 2, high) for low, high in edges]
            for weights in rng.uniform(0, 1, (10, joints)):
                point = [a + (c - a) * w for (a, _, c), w in zip(ends, weights, strict=True)]
                assert within(below[k], box.forms(point), above[k])
            for point in product(*ends):
                assert within(below[k], box.forms(point), above[k])


def within(low, balls, high) -> bool:
    return all(arb(a) <= x <= arb(b) for a, x, b in zip(low, balls, high, strict=True))


@given(st.integers(0, 10**6), st.integers(1, 3))
def test_bounds_close_in_on_the_value(seed, joints):
    box = random_bounds(seed, joints)
    low, high = box.bounds(random_cells(box, 20 * joints, 5, seed))
    size = np.abs(box.forms.coefficients).sum() * 10.0**joints
    assert (high - low <= 2e-5 * size).all()


def test_halves_fill_the_cell_and_nothing_else():
    cells = Cells(5, np.array([[3, 1, 0], [2, 2, 1]]))
    halves = cells.halves()
    assert halves.level == 6
    assert halves.bits.tolist() == [2, 2, 2]
    assert np.array_equal(halves.index[:2] // [1, 1, 2], cells.index)
    assert len(np.unique(halves.index, axis=0)) == 4


def test_a_coefficient_that_is_a_wide_ball_counts_from_end_to_end():
    """Its middle alone would prove a cell feasible on which the form may be negative."""
    wide = HarmonicForm(np.array([[arb(0.05, 0.1), arb(0), arb(0.5, 0.25)]]), ("revolute",))
    box = BoxBounds(wide, [(arb(1), arb(1.5))])
    [[low]], [[high]] = box.bounds(box.whole())
    assert low <= -0.05 + 0.25 * np.sin(1)
    assert high >= 0.15 + 0.75 * np.sin(1.5)


def test_bounds_without_forms_bounds_nothing():
    box = BoxBounds(random_form(0, 2)[np.zeros(0, dtype=int)], [(arb(0), arb(1))] * 2)
    low, high = box.bounds(box.whole())
    assert low.shape == high.shape == (1, 0)


ROUNDING = """
import ctypes, ctypes.util
libm = ctypes.CDLL(ctypes.util.find_library("m"))
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.subpaving.paving import pave
from cspace.proofs.subpaving.connection import connection
problem, tiny = exact_problem(exact_robot("minervabot-v2")), float("1e-30")
for mode in (0x000, 0x400, 0x800, 0xC00):  # nearest, down, up, towards zero
    assert libm.fesetround(mode) == 0
    assert (1 + tiny > 1) == (mode == 0x800)  # the mode is on
    inner, outer = pave(problem, 0.02).bracket
    print(inner < 25.84325902943 < outer, connection(problem, [0, 0], [1.6, 4.0]).answer)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="numbers of the rounding modes")
def test_the_answers_are_the_same_in_all_rounding_modes():
    command = [sys.executable, "-c", ROUNDING]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["True", "separated"] * 4
