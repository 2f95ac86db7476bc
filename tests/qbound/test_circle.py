"""Theorem 2 on the circle: every case, both roots, the arc where the inequality holds."""

from math import acos, atan, atan2, cos, hypot, pi, sin, sqrt, tau

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from engine_support.oracles import angle_gap, circle_zeros
from qbound.circle import ALL, circle_arc, circle_roots, first_from, nearest_turn

NUMBERS = st.integers(-3000, 3000).map(lambda k: k / 100)

# Section 3 of the mathematics, every case: a, b, c -> number of roots, multiplicity, half-width of
# the arc, None where no angle satisfies a cos q + b sin q >= c.
CASES = {
    "c < -d: every angle, no root": (3, 4, -5.1, 0, 0, pi),
    "c = -d: every angle, a double root": (3, 4, -5, 1, 2, pi),
    "c = -d, d no whole number": (1, 1, -sqrt(2), 1, 2, pi),
    "-d < c < 0": (3, 4, -2.5, 2, 1, 2 * pi / 3),
    "c = 0": (3, 4, 0, 2, 1, pi / 2),
    "0 < c < d": (3, 4, 2.5, 2, 1, pi / 3),
    "c = d: one angle, a double root": (3, 4, 5, 1, 2, 0),
    "c = d, d no whole number": (1, 1, sqrt(2), 1, 2, 0),
    "c > d: none": (3, 4, 5.1, 0, 0, None),
    "d = 0, c < 0: every angle, no root": (0, 0, -1, 0, 0, pi),
    "d = 0, c = 0: every angle is a root": (0, 0, 0, ALL, 0, pi),
    "d = 0, c > 0: none": (0, 0, 1, 0, 0, None),
    "d is rounding beside c < 0": (1e-16, -1e-17, -1, 0, 0, pi),
    "d is rounding beside c > 0": (1e-16, -1e-17, 1, 0, 0, None),
    "d small, c = 0: a form like any other": (1e-16, 0, 0, 2, 1, pi / 2),
    "b = 0": (2, 0, 1, 2, 1, pi / 3),
    "a < 0": (-2, 0, 1, 2, 1, pi / 3),
    "a < 0, tangent": (-2, 0, 2, 1, 2, 0),
    "all of it tiny": (3e-200, 4e-200, 2.5e-200, 2, 1, pi / 3),
    "all of it huge": (3e200, 4e200, 2.5e200, 2, 1, pi / 3),
}


@pytest.mark.parametrize(
    ("a", "b", "c", "count", "multiplicity", "half"), CASES.values(), ids=CASES
)
def test_every_case_of_theorem_2(a, b, c, count, multiplicity, half) -> None:
    roots, arc = circle_roots(a, b, c), circle_arc(a, b, c)
    assert (roots.count, roots.multiplicity) == (count, multiplicity)
    assert arc.empty == (half is None)
    assert_allclose(arc.half_width, 0 if half is None else half, atol=1e-15)
    assert np.isfinite(roots.q).all()
    if count == 2:
        assert_allclose(roots.q, atan2(b, a) + np.array([-half, half]), atol=1e-15)
        assert_array_equal(roots.slope, [1, -1])
        assert_allclose(arc.centre, atan2(b, a))
    else:
        assert_array_equal(roots.slope, 0)
    if count == 1:
        assert_allclose(angle_gap(roots.q, atan2(b, a) + (pi if c < 0 else 0)), 0, atol=1e-15)


@given(NUMBERS, NUMBERS, NUMBERS)
def test_roots_are_those_found_by_bisection(a, b, c) -> None:
    d = hypot(a, b)
    assume(abs(abs(c) - d) > 1e-3 * max(d, 1e-3))
    found = circle_zeros(lambda q: a * np.cos(q) + b * np.sin(q) - c)
    roots = circle_roots(a, b, c)
    assert roots.count == len(found)
    if found:
        gaps = angle_gap(roots.q[:, None], np.array(found))
        assert_allclose(gaps.min(axis=1), 0, atol=1e-9)  # a zero of the sum, known to 1e-16 / slope
        assert_allclose(gaps.min(axis=0), 0, atol=1e-9)


@given(NUMBERS, NUMBERS, st.floats(-0.999, 0.999))
def test_slope_is_the_sign_of_the_derivative(a, b, ratio) -> None:
    assume(hypot(a, b) > 0)
    roots = circle_roots(a, b, ratio * hypot(a, b))
    assert_array_equal(np.sign(b * np.cos(roots.q) - a * np.sin(roots.q)), roots.slope)
    assert roots.q[0] < roots.q[1]
    assert -pi <= roots.theta <= pi


@given(NUMBERS, NUMBERS, NUMBERS)
def test_arc_is_where_the_inequality_holds(a, b, c) -> None:
    """Against 2000 angles over two turns; those within rounding of the boundary say nothing."""
    q = np.linspace(-2 * pi, 2 * pi, 2000)
    margin = a * np.cos(q) + b * np.sin(q) - c
    arc = circle_arc(a, b, c)
    inside = ~arc.empty & (np.abs(nearest_turn(q, arc.centre) - arc.centre) <= arc.half_width)
    clear = np.abs(margin) > 1e-7 * (hypot(a, b) + abs(c))
    assert_array_equal(inside[clear], margin[clear] > 0)


@given(NUMBERS, NUMBERS)
def test_a_tangency_is_one_double_root(a, b) -> None:
    d = hypot(a, b)
    assume(d > 0)
    for c, half_width in ((d, 0), (-d, pi)):
        roots, arc = circle_roots(a, b, c), circle_arc(a, b, c)
        assert (roots.count, roots.multiplicity) == (1, 2)
        assert angle_gap(roots.q[0], roots.q[1]) == 0
        assert (arc.half_width, arc.empty) == (half_width, False)


@pytest.mark.parametrize("epsilon", [1e-14, 1e-12, 1e-9, 1e-6])
@pytest.mark.parametrize("sign", [1, -1])
def test_roots_near_a_tangency_stay_two_and_exact(epsilon, sign) -> None:
    """To the conditioning of the problem: a unit of c moves the root by eps / sqrt(2 epsilon)."""
    a, b = 0.3, -1.7
    c = sign * hypot(a, b) * (1 - epsilon)
    roots = circle_roots(a, b, c)
    assert roots.count == 2
    with mpmath.workdps(50):
        a_, b_, c_ = (mpmath.mpf(x) for x in (a, b, c))
        alpha = mpmath.acos(c_ / mpmath.hypot(a_, b_))
        exact = [float(mpmath.atan2(b_, a_) + s * alpha) for s in (-1, 1)]
    assert_allclose(roots.q, exact, atol=4 * 2.0**-52 / sqrt(2 * epsilon) + 1e-15)


@pytest.mark.parametrize("outside", [1 + 1e-14, 1 + 1e-9])
def test_just_past_a_tangency_there_is_no_root(outside) -> None:
    assert circle_roots(3, 4, 5 * outside).count == 0
    assert circle_arc(3, 4, 5 * outside).empty
    assert circle_arc(3, 4, -5 * outside).half_width == pi


@given(NUMBERS, NUMBERS, NUMBERS, st.integers(-300, 300))
def test_the_unit_of_length_does_not_matter(a, b, c, power) -> None:
    """A power of two scales doubles exactly, so every bit of the roots is the same."""
    one, other = circle_roots(a, b, c), circle_roots(*(np.array([a, b, c]) * 2.0**power))
    assert_array_equal(one.q, other.q)
    assert_array_equal(one.count, other.count)


def test_coefficients_broadcast() -> None:
    a, b, c = np.array([1.0, 3.0, 0.0])[:, None], 4.0, np.array([0.0, 5.0])
    many = circle_roots(a, b, c)
    assert many.q.shape == (2, 3, 2)
    assert many.slope.shape == many.q.shape
    assert many.count.shape == many.multiplicity.shape == circle_arc(a, b, c).empty.shape == (3, 2)
    for i, j in np.ndindex(3, 2):
        one = circle_roots(a[i, 0], b, c[j])
        assert (many.count[i, j], many.theta[i, j]) == (one.count, one.theta)
        assert_array_equal(many.q[:, i, j], one.q)
    assert_array_equal(many.count, [[2, 0], [2, 1], [2, 0]])


@pytest.mark.parametrize("solve", [circle_roots, circle_arc])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_numbers_that_are_not_finite_are_refused(solve, bad, place) -> None:
    """An empty arc from NaN would read as safe."""
    coefficients = [[1.0, 1.0], [1.0, 1.0], [1.0, 1.0]]
    coefficients[place][1] = bad
    with pytest.raises(ValueError, match="finite"):
        solve(*coefficients)


@pytest.mark.parametrize(("a", "b"), [(-3.0, 4.0), (-3.0, -4.0), (-3.0, 0.0)])
def test_printed_arctan_solves_another_equation_when_a_is_negative(a, b) -> None:
    """E-34: eq. (34)'s arctan(b / a) is half a turn off; eq. (38) then misses the root."""
    c = 2.0
    printed = atan(b / a) + acos(c / hypot(a, b))
    assert a * cos(printed) + b * sin(printed) == pytest.approx(-c)
    roots = circle_roots(a, b, c)
    assert_allclose(a * np.cos(roots.q) + b * np.sin(roots.q), c, atol=1e-14)
    assert angle_gap(roots.theta, atan(b / a)) == pytest.approx(pi)


def test_both_roots_are_returned_where_the_proof_keeps_one() -> None:
    """E-37: eq. (37) keeps + arccos; theta - arccos solves (30) as well."""
    kept, dropped = (circle_roots(2, 1, 1).q[i] for i in (1, 0))
    assert kept == pytest.approx(atan2(1, 2) + acos(1 / sqrt(5)))
    assert 2 * cos(dropped) + sin(dropped) == pytest.approx(1)
    assert angle_gap(kept, dropped) > 1


def test_printed_intervals_are_longer_than_the_arc() -> None:
    """Eq. (31) spans 2 arccos(c/d) too much, or a turn in (39); both hold angles that fail."""
    a, b, c = 3.0, 4.0, 2.5
    alpha, arc = acos(c / hypot(a, b)), circle_arc(a, b, c)
    length_31, length_39 = 2 * alpha + 2 * pi, 2 * pi
    assert 2 * arc.half_width == pytest.approx(2 * alpha)
    assert 2 * arc.half_width < length_39 < length_31
    opposite = arc.centre - pi  # in both printed intervals
    assert a * cos(opposite) + b * sin(opposite) < c


@pytest.fixture(scope="module")
def solved() -> dict[str, np.ndarray]:
    """Equations at random with a solution of each, and other angles."""
    a, b, q, other = np.random.default_rng(31).normal(size=(4, 200_000))
    c = a * np.cos(q) + b * np.sin(q)
    return {"a": a, "b": b, "c": c, "q": q, "other": other, "alpha": np.arccos(c / np.hypot(a, b))}


@pytest.mark.parametrize("reading", [np.arctan2, lambda b, a: np.arctan(b / a)])
@pytest.mark.parametrize("angle", ["q", "other"])
@pytest.mark.parametrize("first", [-1, 1], ids=["eq. 31", "eq. 39"])
def test_a_solution_has_a_copy_in_the_printed_interval_and_so_has_any_angle(
    solved, reading, angle, first
) -> None:
    theta = reading(solved["b"], solved["a"])
    low, high = theta + first * solved["alpha"] - 2 * pi, theta + solved["alpha"]
    copy = low + (solved[angle] - low) % (2 * pi)
    assert (copy <= high + 1e-12).all()


def test_without_the_turn_the_interval_is_the_arc_with_atan2_alone(solved) -> None:
    a, b, other = solved["a"], solved["b"], solved["other"]
    reaches = a * np.cos(other) + b * np.sin(other) >= solved["c"]

    def inside(theta: np.ndarray) -> np.ndarray:
        return np.abs((other - theta + pi) % (2 * pi) - pi) <= solved["alpha"]

    assert_array_equal(inside(np.arctan2(b, a)), reaches)
    assert_array_equal(inside(np.arctan(b / a))[a > 0], reaches[a > 0])
    assert (inside(np.arctan(b / a)) != reaches)[a < 0].mean() > 0.1


# --- full turns -----------------------------------------------------------------------------------

ANGLES = st.floats(-100, 100)


def test_an_angle_at_the_bound_is_its_own_first() -> None:
    assert_array_equal(first_from(1.5, [1.5, 1.5 + tau, 1.25]), [1.5, 1.5, 1.25 + tau])


@given(ANGLES, ANGLES)
def test_nearest_turn_moves_by_whole_turns(q, centre) -> None:
    moved = nearest_turn(q, centre)
    turns = (moved - q) / tau
    assert abs(turns - round(float(turns))) < 1e-13
    assert -pi - 1e-12 < moved - centre <= pi + 1e-12


def test_nearest_turn_keeps_the_upper_end() -> None:
    assert_array_equal(nearest_turn([-pi, pi, 0.0], 0.0), [pi, pi, 0.0])
