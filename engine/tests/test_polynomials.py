"""Roots of stacked polynomials, each with a bound of its error; mpmath says where roots are."""

import mpmath
import numpy as np
import pytest

from cspace.region.events import FAR, polynomial_roots

ROUNDING = 2.0**-50
CIRCLES = [False, True]


def polynomial(roots) -> np.ndarray:
    """Ascending coefficients, the largest 1, shape (1, d + 1)."""
    c = np.poly(roots)[::-1].astype(complex)
    return c[None] / np.abs(c).max()


def errors_of(stack) -> np.ndarray:
    """What rounding may have done to all coefficients of a polynomial together."""
    return ROUNDING * np.abs(stack).sum(axis=1)


def true_roots(coefficients) -> np.ndarray:
    """Roots of the very doubles, in 60 digits; ends that are zero are left out."""
    kept = np.trim_zeros(coefficients)
    with mpmath.workdps(60):
        found = mpmath.polyroots([mpmath.mpc(c) for c in kept[::-1]], maxsteps=500, extraprec=400)
        return np.array([complex(z) for z in found])


def on_curve(rng, count: int, circle: bool) -> np.ndarray:
    """Places on the unit circle, or on the real line between -1 and 1."""
    return np.exp(1j * rng.uniform(-np.pi, np.pi, count)) if circle else rng.uniform(-1, 1, count)


@pytest.mark.parametrize("circle", CIRCLES)
def test_every_root_lies_within_its_radius_of_a_true_one_and_none_is_missing(circle):
    rng = np.random.default_rng(circle)
    for _ in range(40):
        on = on_curve(rng, rng.integers(1, 5), circle)
        off = rng.normal(size=(rng.integers(0, 4), 2)) @ [1, 1j]
        stack = polynomial([*on, *off])
        found = polynomial_roots(stack, np.zeros(1), circle=circle)
        away = np.abs(found.z[:, None] - true_roots(stack[0]))
        assert (away.min(axis=1) <= found.radius).all()
        for root in on:  # what np.poly rounds moves them by less than 1e-10
            assert (np.abs(found.z - root) <= found.radius + 1e-10).any()


@pytest.mark.parametrize("m", [2, 3, 4])
@pytest.mark.parametrize("circle", CIRCLES)
def test_the_radius_of_a_multiple_root_reaches_it(m, circle):
    """However far off the multiple root its parts are, one is told within its radius."""
    rng = np.random.default_rng(m)
    for _ in range(50):
        angles = rng.uniform(-0.4, 0.4) + np.array([0.0, 1.5, 3.1])
        others = np.exp(1j * angles) if circle else np.cos(angles)
        stack = polynomial([others[0]] * (m - 1) + others.tolist())
        found = polynomial_roots(stack, errors_of(stack), circle=circle)
        away = np.abs(found.z[:, None] - others)
        assert (away <= found.radius[:, None]).any(axis=0).all()
        nearest = away.argmin(axis=1)
        assert (away.min(axis=1)[nearest == 0] <= found.radius[nearest == 0]).all()
        assert found.crowded[nearest == 0].all()
        assert not found.crowded[nearest != 0].any()
        assert (found.radius[nearest != 0] < 1e-11).all()


def test_two_roots_of_one_polynomial_may_be_double():
    stack = polynomial([1j, 1j, -1, -1, 0.6 + 0.8j])
    found = polynomial_roots(stack, errors_of(stack), circle=True)
    double = [z for z, crowded in zip(found.z, found.crowded, strict=True) if crowded]
    assert np.abs(np.subtract.outer(double, [1j, -1])).min(axis=0).max() < 1e-6
    (simple,) = found.z[~found.crowded]
    assert abs(simple - (0.6 + 0.8j)) < 1e-12


@pytest.mark.parametrize("apart", [3e-6, 1e-4, 1e-2])
def test_roots_that_are_apart_remain_two(apart):
    stack = polynomial([0.3, 0.3 + apart, -0.7])
    found = polynomial_roots(stack, errors_of(stack), circle=False)
    assert not found.crowded.any()
    assert np.abs(np.sort(found.z.real) - [-0.7, 0.3, 0.3 + apart]).max() < 1e-15 / apart + 1e-13


def test_roots_that_doubles_cannot_part_are_crowded_and_no_others():
    stack = polynomial([0.3, 0.3 + 1e-12, -0.7])
    found = polynomial_roots(stack, errors_of(stack), circle=False)
    assert (found.crowded == (found.z.real > 0)).all()
    assert found.crowded.any()


def test_errors_of_coefficients_widen_the_radius():
    """A polynomial that is off by its error has its roots within the radius."""
    rng = np.random.default_rng(5)
    stack, error = polynomial([0.3, 0.5, -0.7]), 1e-6
    found = polynomial_roots(stack, np.array([error]), circle=False)
    assert len(found.z) == 3
    for _ in range(20):
        step = rng.normal(size=stack.shape)
        other = true_roots((stack + error * step / np.abs(step).sum())[0])
        assert (np.abs(found.z[:, None] - other).min(axis=1) <= found.radius).all()
    assert (found.radius < 1e-4).all()


def test_each_root_stands_with_its_own_polynomial():
    simple, double = [0.1, 0.5, -0.9], [0.2, 0.2, -0.4]
    stack = np.concatenate([polynomial(simple), polynomial(double)])
    found = polynomial_roots(stack, errors_of(stack), circle=False)
    assert np.sort(found.z.real[found.row == 0]) == pytest.approx(np.sort(simple), abs=1e-13)
    assert found.crowded[found.row == 1].sum() == 2
    second = found.z.real[(found.row == 1) & ~found.crowded]
    assert second == pytest.approx([-0.4], abs=1e-13)


def test_polynomials_of_all_degrees_are_solved_together():
    rng = np.random.default_rng(3)
    roots = [rng.uniform(-1, 1, d) for d in (1, 2, 3, 6, 2)]
    stack = np.zeros((len(roots) + 1, 9), dtype=complex)  # the last is zero everywhere
    for k, own in enumerate(roots):
        stack[k, : len(own) + 1] = polynomial(own)[0]
    found = polynomial_roots(stack, errors_of(stack), circle=False)
    for k, own in enumerate(roots):
        assert np.sort(found.z.real[found.row == k]) == pytest.approx(np.sort(own), abs=1e-11)
    assert len(found.z) == sum(map(len, roots))


@pytest.mark.parametrize("circle", CIRCLES)
def test_what_lies_off_the_curve_or_far_away_is_left_out(circle):
    one = np.exp(0.4j) if circle else 0.4
    stack = polynomial([one, 0.5 + 0.5j, 2 * FAR, 0.9j])
    found = polynomial_roots(stack, errors_of(stack), circle=circle)
    assert found.z == pytest.approx([one], abs=1e-12)


def test_a_root_at_zero_is_one_on_the_line_and_none_on_the_circle():
    stack = polynomial([0.0, 0.0, 1.0])
    found = polynomial_roots(stack, errors_of(stack), circle=False)
    assert (np.abs(found.z[np.abs(found.z) < 0.5]) <= found.radius[np.abs(found.z) < 0.5]).all()
    assert found.crowded.sum() == 2
    assert polynomial_roots(stack, errors_of(stack), circle=True).z == pytest.approx([1.0])


def test_a_quadratic_loses_no_digits_of_its_smaller_root():
    stack = np.array([[1e-9, -1.0, 1.0]], dtype=complex)
    found = polynomial_roots(stack, np.zeros(1), circle=False)
    true = np.sort(true_roots(stack[0]).real)
    assert np.sort(found.z.real) == pytest.approx(true, rel=1e-14)


def test_ends_that_are_rounding_are_no_roots_at_infinity():
    stack = np.array([[0, -0.5, 1, 1e-15]], dtype=complex)
    found = polynomial_roots(stack, np.array([2e-15]), circle=False)
    assert found.row.tolist() == [0, 0]
    assert np.sort(found.z.real) == pytest.approx([0, 0.5])
    assert not found.crowded.any()
    assert len(polynomial_roots(np.zeros((1, 4), dtype=complex), np.zeros(1), circle=False).z) == 0
