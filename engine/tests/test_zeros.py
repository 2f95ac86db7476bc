"""Zeros of polynomials on an interval: each within its error, none missing, or said to be open."""

import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from cspace.region import exact
from cspace.region.exact import PRECISE, near_roots
from cspace.region.zeros import isolate

START, END = -0.7, 0.8
ERROR = 1e-15

circles = pytest.mark.parametrize("circle", [False, True])


def product(zeros, circle, t):
    """The polynomial of these zeros; with sin((t - zero) / 2) it is a trigonometric one."""
    return np.prod([np.sin((t - z) / 2) if circle else t - z for z in zeros], axis=0)


def isolated(value, degree, circle, error=ERROR, known=(False, False)):
    """Places and errors of a polynomial's zeros; None where doubles leave them open."""
    ends = [np.array([x]) for x in (START, END, *known)]
    _, t, radius, vague = isolate(
        lambda which, t: value(t),
        lambda which, t: np.full(len(t), error),
        np.array([error]),
        degree,
        *ends[:2],
        circle,
        (ends[2], ends[3]),
    )
    order = np.argsort(t)
    return None if vague else (t[order], radius[order])


@settings(max_examples=200)
@given(st.integers(0, 10**6), st.booleans(), st.integers(1, 4))
def test_every_zero_is_within_its_error_and_none_is_missing(seed, circle, half_degree):
    rng = np.random.default_rng(seed)
    zeros = np.sort(rng.uniform(-2, 2, 2 * half_degree))
    found = isolated(lambda t: product(zeros, circle, t), len(zeros), circle)
    true = zeros[(zeros > START) & (zeros < END)]
    if np.diff(zeros).min() > 0.05 and np.abs(np.subtract.outer(zeros, [START, END])).min() > 0.01:
        assert found is not None
    if found is not None:
        t, radius = found
        assert len(t) == len(true)
        assert (np.abs(t - true) <= radius).all()


@circles
@pytest.mark.parametrize("apart", [0.0, 1e-12, 1e-9])
def test_zeros_that_doubles_do_not_part_are_left_open(circle, apart):
    zeros = [0.3, 0.3 + apart, -1.5, 1.9]
    assert isolated(lambda t: product(zeros, circle, t), 4, circle) is None


@circles
@pytest.mark.parametrize("apart", [1e-3, 1e-2])
def test_zeros_that_are_apart_remain_two(circle, apart):
    zeros = [0.3, 0.3 + apart, -1.5, 1.9]
    found = isolated(lambda t: product(zeros, circle, t), 4, circle)
    assert found is not None
    assert np.abs(found[0] - zeros[:2]).max() < 1e-11


@circles
def test_a_polynomial_that_all_but_vanishes_somewhere_without_a_sign_change_is_left_open(circle):
    """A positive minimum below the error, and a zero everywhere."""
    touching = [0.3, 0.3, -1.5, 1.9]
    assert isolated(lambda t: product(touching, circle, t) - 1e-16, 4, circle) is None
    assert isolated(np.zeros_like, 4, circle) is None


@circles
def test_errors_of_values_widen_the_error_of_a_zero(circle):
    zeros = [0.3, -1.5]
    widths = []
    for error in (1e-15, 1e-12, 1e-9):
        off = 0.9 * error
        found = isolated(lambda t, off=off: product(zeros, circle, t) + off, 2, circle, error)
        assert found is not None
        (t,), (radius,) = found
        assert abs(t - 0.3) <= radius
        widths.append(radius)
    assert widths[2] > 100 * widths[1] > 1000 * widths[0]


@circles
def test_a_zero_that_is_known_at_an_end_is_left_out(circle):
    zeros = [START, 0.3]
    found = isolated(lambda t: product(zeros, circle, t), 2, circle, known=(True, False))
    assert found is not None
    assert found[0] == pytest.approx([0.3])
    assert isolated(lambda t: product(zeros, circle, t), 2, circle) is None


@pytest.mark.parametrize("zeros", [(1, 2, 3), (-1, 0.5, 0.5), (0.25, 0.25, 0.25, 2), (1, 1, 1, 1)])
def test_multiple_zeros_of_rounded_coefficients_are_found_once_and_near_ones_apart(zeros):
    rng = np.random.default_rng(5)
    with ctx.workprec(PRECISE):
        p = [arb(1), arb(0), arb(1)]  # and two that are not real
        for zero in zeros:
            p = [x - zero * y for x, y in zip([arb(0), *p], [*p, arb(0)], strict=True)]
        p = [(c + c * arb(2) ** -640 * int(rng.choice([-1, 1]))).mid() for c in p]
        found = [float(x) for x in near_roots(p)]
    assert found == pytest.approx(sorted({*zeros}), abs=1e-15)


def test_a_power_has_one_zero_and_a_zero_at_an_end_of_newtons_steps_is_told_at_once(monkeypatch):
    """The sign of a value that is only rounding must not lead to halving, bit by bit."""
    asked, values = [], exact._values
    monkeypatch.setattr(exact, "_values", lambda p, x: asked.append(x) or values(p, x))
    with ctx.workprec(PRECISE):
        assert [float(x) for x in near_roots([arb(0), arb(0), arb(0), arb(7)])] == [0.0]
        found = near_roots([arb(-2), arb(-1), arb(3), arb(1), arb(-5), arb(2)])
    assert len(found) % 2 == 1
    assert len(asked) < 40 * (5 + 4 + 3 + 2)
