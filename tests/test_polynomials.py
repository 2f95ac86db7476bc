"""Roots of stacked polynomials: multiple ones are found once, and to the last digits."""

import numpy as np
import pytest

from qbound.region.polynomials import polynomial_roots


def polynomial(roots) -> np.ndarray:
    """Ascending coefficients, the largest 1, shape (1, d + 1)."""
    c = np.poly(roots)[::-1].astype(complex)
    return c[None] / np.abs(c).max()


@pytest.mark.parametrize("m", [2, 3, 4])
@pytest.mark.parametrize("line", [False, True])
def test_a_multiple_root_is_found_once_and_exactly(m, line):
    rng = np.random.default_rng(m)
    for _ in range(50):
        angles = rng.uniform(-0.4, 0.4) + np.array([0.0, 1.5, 3.1])
        others = np.cos(angles) if line else np.exp(1j * angles)
        _, z = polynomial_roots(polynomial([others[0]] * (m - 1) + others.tolist()))
        gaps = np.abs(z[:, None] - others)
        assert gaps.shape == (3, 3)
        assert gaps.min(axis=0).max() < 1e-12


def test_two_roots_of_one_polynomial_may_be_double():
    _, z = polynomial_roots(polynomial([1j, 1j, -1, -1, 0.6 + 0.8j]))
    assert np.abs(np.sort_complex(z) - [-1, 1j, 0.6 + 0.8j]).max() < 1e-12


@pytest.mark.parametrize("apart", [3e-6, 1e-4, 1e-2])
def test_roots_that_are_apart_remain_two(apart):
    _, z = polynomial_roots(polynomial([0.3, 0.3 + apart, -0.7]))
    assert len(z) == 3
    assert np.abs(np.sort(z.real) - [-0.7, 0.3, 0.3 + apart]).max() < 1e-15 / apart + 1e-13


def test_each_root_stands_with_its_own_polynomial():
    simple, double = [0.1, 0.5, -0.9], [0.2, 0.2, -0.4]
    rows, z = polynomial_roots(np.concatenate([polynomial(simple), polynomial(double)]))
    assert np.sort(z.real[rows == 0]) == pytest.approx(np.sort(simple), abs=1e-13)
    assert np.sort(z.real[rows == 1]) == pytest.approx([-0.4, 0.2], abs=1e-13)


def test_polynomials_of_all_degrees_are_solved_together():
    rng = np.random.default_rng(3)
    roots = [rng.normal(size=(d, 2)) @ [1, 1j] for d in (1, 2, 3, 6, 2)]
    stack = np.zeros((len(roots) + 1, 9), dtype=complex)  # the last is zero everywhere
    for k, own in enumerate(roots):
        low = k % 3  # so many roots at zero
        stack[k, low : low + len(own) + 1] = polynomial(own)[0]
    rows, z = polynomial_roots(stack)
    for k, own in enumerate(roots):
        expected = [*own, 0.0] if k % 3 else own  # zero stands there once
        assert np.sort_complex(z[rows == k]) == pytest.approx(np.sort_complex(expected), abs=1e-12)
    assert len(z) == sum(map(len, roots)) + 3


def test_a_quadratic_loses_no_digits_of_its_smaller_root():
    _, z = polynomial_roots(np.array([[1e-9, -1.0, 1e-3]], dtype=complex))
    assert np.sort(np.abs(z)) == pytest.approx([1e-9, 1e3], rel=1e-11)


def test_ends_that_are_rounding_are_no_roots_at_infinity():
    rows, z = polynomial_roots(np.array([[0, -0.5, 1, 1e-15]], dtype=complex))
    assert rows.tolist() == [0, 0]
    assert np.sort(z.real) == pytest.approx([0, 0.5])
    assert len(polynomial_roots(np.zeros((1, 4), dtype=complex))[1]) == 0
