"""Harmonic forms: every operation against the sum written out, term by term."""

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal

from cspace.forms.harmonic import HarmonicForm, basis, basis_slope
from cspace.geometry.polygon import deviations, flatten
from engine_support.oracles import ANGLES, form_value

KINDS = st.lists(st.sampled_from(["revolute", "prismatic"]), min_size=1, max_size=4).map(tuple)
COEFFICIENTS = st.integers(-40, 40).map(float)


@st.composite
def forms(draw: st.DrawFn, stack: tuple[int, ...] = ()) -> HarmonicForm:
    kinds = draw(KINDS)
    coefficients = draw(arrays(float, (*stack, *(3,) * len(kinds)), elements=COEFFICIENTS))
    return HarmonicForm(coefficients, kinds)


def configuration(data: st.DataObject, form: HarmonicForm) -> np.ndarray:
    return np.array(data.draw(st.lists(ANGLES, min_size=(n := len(form.kinds)), max_size=n)))


def tolerance(form: HarmonicForm) -> dict[str, float]:
    """Rounding of a sum of up to 81 terms of size 40 x 6^8 (prismatic squares)."""
    largest = 40.0 * 3 ** len(form.kinds) * 36.0 ** form.kinds.count("prismatic")
    return {"rtol": 1e-12, "atol": 1e-15 * largest}


@given(forms(), st.data())
def test_value_is_the_sum_of_all_terms(form, data) -> None:
    q = configuration(data, form)
    expected = form_value(form.coefficients, form.kinds, q)
    assert_allclose(form(q), expected, **tolerance(form))


@given(forms(stack=(2, 3)), st.data())
def test_stack_and_batch_keep_their_shapes(form, data) -> None:
    """Shape (...) + stack, and every entry its own form at its own configuration."""
    q = np.array([[configuration(data, form)] for _ in range(4)])
    values, slopes, ones = form(q), form.gradient(q), form.along(0, q)
    n = len(form.kinds)
    assert form.shape == (2, 3)
    assert values.shape == (4, 1, 2, 3)
    assert slopes.shape == (4, 1, 2, 3, n)
    assert ones.shape == (4, 1, 2, 3, 3)
    one = form[1, 2]
    assert_allclose(values[3, 0, 1, 2], one(q[3, 0]), **tolerance(form))
    assert_allclose(slopes[3, 0, 1, 2], one.gradient(q[3, 0]), **tolerance(form))
    assert_allclose(ones[3, 0, 1, 2], one.along(0, q[3, 0]), **tolerance(form))


@given(forms(), st.data())
def test_gradient_is_the_complex_step_derivative(form, data) -> None:
    q = configuration(data, form)
    step = 1e-30
    expected = [
        form_value(form.coefficients, form.kinds, q + 1j * step * e).imag / step
        for e in np.eye(len(q))
    ]
    assert_allclose(form.gradient(q), expected, **tolerance(form))


@given(forms(stack=(3,)), st.data())
def test_along_a_joint_is_the_form_with_the_others_held(form, data) -> None:
    """Theorem 2's a, b and -c (eq. 30) give the form back at every value of that joint."""
    q, other = configuration(data, form), data.draw(ANGLES)
    joint = data.draw(st.integers(0, len(q) - 1))
    one_joint = form.along(joint, q)
    moved = np.where(np.arange(len(q)) == joint, other, q)
    assert_allclose(one_joint @ basis(form.kinds[joint], other), form(moved), **tolerance(form))
    assert_array_equal(form.along(joint, moved), one_joint)  # its own entry is not read


@given(forms(stack=(2,)), st.data())
def test_restriction_holds_joints(form, data) -> None:
    q = configuration(data, form)
    held = data.draw(st.sets(st.integers(0, len(q) - 1), max_size=len(q) - 1))
    restricted = form.restrict({j: q[j] for j in held})
    left = [j for j in range(len(q)) if j not in held]
    assert restricted.kinds == tuple(form.kinds[j] for j in left)
    assert_allclose(restricted(q[left]), form(q), **tolerance(form))


@given(forms(), st.data())
def test_restriction_of_every_joint_leaves_the_value(form, data) -> None:
    q = configuration(data, form)
    left = form.restrict(dict(enumerate(q)))
    assert left.kinds == ()
    assert_allclose(left.coefficients, form(q), **tolerance(form))


@given(forms(), st.data())
def test_symbols_and_numbers_agree(form, data) -> None:
    q = configuration(data, form)
    symbols = sympy.symbols(f"q1:{len(q) + 1}", real=True)
    value = sympy.lambdify(symbols, form.symbolic(symbols))(*q)
    assert_allclose(value, form(q), **tolerance(form))


@settings(max_examples=12)  # SymPy takes a second for a large one
@given(forms(stack=(2,)), st.data())
def test_a_form_takes_symbols_as_it_takes_numbers(form, data) -> None:
    """Value, gradient and restriction of symbols are SymPy's own, with numbers put in."""
    q = configuration(data, form)
    symbols = sympy.symbols(f"q1:{len(q) + 1}", real=True)
    numbers = dict(zip(symbols, q, strict=True))
    value = [e.subs(numbers) for e in map(sympy.sympify, form(symbols))]
    assert_allclose(np.array(value, dtype=float), form(q), **tolerance(form))
    expected = [[sympy.diff(f, s).subs(numbers) for s in symbols] for f in form.symbolic(symbols)]
    assert_allclose(np.array(expected, dtype=float), form.gradient(q), **tolerance(form))
    held = form.restrict(dict(enumerate(symbols))).coefficients
    assert [sympy.expand(x - y) for x, y in zip(held, form(symbols), strict=True)] == [0, 0]


@given(forms(), st.data())
def test_waves_add_up_to_the_form(form, data) -> None:
    q, waves = configuration(data, form), form.waves
    terms = waves.amplitudes * np.exp(1j * waves.turns @ q) * np.prod(q**waves.powers, axis=1)
    assert_allclose(terms.real.sum(), form(q), **tolerance(form))


@given(forms(stack=(2,)), st.data())
def test_size_is_above_the_sum_of_all_terms(form, data) -> None:
    q = configuration(data, form)
    size = form.size(np.abs(q))
    terms = HarmonicForm(np.abs(form.coefficients), form.kinds)
    absolute = terms.combined([np.abs(basis(k, x)) for k, x in zip(form.kinds, q, strict=True)])
    assert (size >= absolute * (1 - 1e-12)).all()
    assert (np.abs(form(q)) <= size * (1 + 1e-12)).all()


def test_symbolic_stack_is_nested_and_exact() -> None:
    """Symbols as coefficients stay symbols: no float enters."""
    a, b, q1, q2 = sympy.symbols("a b q1 q2", real=True)
    coefficients = np.zeros((2, 3, 3), dtype=object)
    coefficients[0, 1, 0], coefficients[1, 0, 2] = a, b
    form = HarmonicForm(coefficients, ("revolute", "prismatic"))
    assert form.symbolic([q1, q2]) == [a * sympy.cos(q1), b * q2**2]
    assert (form - np.array([a, 0])).symbolic([q1, q2])[0] == a * sympy.cos(q1) - a


@given(forms(stack=(3,)), arrays(float, 3, elements=COEFFICIENTS), st.data())
def test_arithmetic_acts_on_values(form, constant, data) -> None:
    q = configuration(data, form)
    value, near = form(q), tolerance(form) | {"atol": 1e-13 * 40 * 36.0 ** len(form.kinds)}
    assert_allclose((form + constant)(q), value + constant, **near)
    assert_allclose((form - constant)(q), value - constant, **near)
    assert_array_equal((-form)(q), -value)
    assert_allclose(form.dot(constant)(q), value @ constant, **near)
    matrix = np.outer(constant, [1, 2, 3])
    assert_allclose(form.dot(matrix)(q), matrix @ value, **near)


def test_adding_a_constant_leaves_the_form_itself_alone() -> None:
    form = HarmonicForm(np.zeros((3, 3)), ("revolute", "revolute"))
    assert (form + 2.5)([1, 2]) == 2.5
    assert form([1, 2]) == 0
    whole = HarmonicForm(np.zeros(3, dtype=int), ("revolute",))
    assert (whole + 0.5)([0.0]) == 0.5  # integers do not cut it off


@given(forms(stack=(2, 3)))
def test_indexing_takes_forms_out_of_the_stack(form) -> None:
    assert_array_equal(form[1].coefficients, form.coefficients[1])
    assert_array_equal(form[1, 2].coefficients, form.coefficients[1, 2])
    assert_array_equal(form[:, 0].coefficients, form.coefficients[:, 0])
    assert (form[1].shape, form[1, 2].shape, form[:, :2].shape) == ((3,), (), (2, 2))


@given(forms(), st.data())
def test_joints_are_those_that_change_the_value(form, data) -> None:
    q, other = configuration(data, form), configuration(data, form)
    for j in set(range(len(q))) - set(form.joints()):
        moved = np.where(np.arange(len(q)) == j, other, q)
        assert_allclose(form(moved), form(q), **tolerance(form))
    for j in form.joints():
        assert np.any(form.coefficients.swapaxes(0, j)[1:])


def test_joints_of_a_stack_are_those_of_any_of_its_forms() -> None:
    coefficients = np.zeros((2, 3, 3, 3))
    coefficients[0, 1, 0, 0] = coefficients[1, 0, 0, 2] = 1
    assert HarmonicForm(coefficients, ("revolute",) * 3).joints() == (0, 2)


def test_a_prismatic_joint_has_a_square() -> None:
    form = HarmonicForm(np.array([5.0, -3.0, 2.0]), ("prismatic",))
    q = np.array([[0.0], [1.0], [-2.0]])
    assert_array_equal(form(q), [5, 4, 19])
    assert_array_equal(form.gradient(q)[:, 0], [-3, 1, -11])
    assert_array_equal(basis("prismatic", 3.0), [1, 3, 9])
    assert_array_equal(basis_slope("prismatic", 3.0), [0, 1, 6])


def test_a_million_configurations_are_one_product() -> None:
    """Row by row the same numbers as one at a time."""
    rng = np.random.default_rng(3)
    form = HarmonicForm(rng.normal(size=(2, 3, 3)), ("revolute", "revolute"))
    q = rng.uniform(-3, 3, (1_000_000, 2))
    values = form(q)
    assert values.shape == (1_000_000, 2)
    for i in (0, 777_777, 999_999):
        assert_allclose(values[i], form(q[i]), rtol=1e-13)


@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (3, 2), (3, 4)])
def test_an_array_without_an_axis_a_joint_is_refused(shape) -> None:
    with pytest.raises(ValueError, match="2 joints need 2 last axes of length 3"):
        HarmonicForm(np.zeros(shape), ("revolute", "revolute"))


@pytest.mark.parametrize(
    ("kinds", "q", "says"),
    [
        (2, [0.2], "expected 2 joint values on the last axis, found 1"),
        (2, [1.0, 2.0, 3.0], "expected 2 joint values on the last axis, found 3"),
        (2, np.zeros((2, 5)), "expected 2 joint values on the last axis, found 5"),
        (2, [], "expected 2 joint values on the last axis, found 0"),
        (2, 0.2, "expected 2 joint values on the last axis, found a bare number"),
        (1, 0.2, "expected 1 joint value on the last axis, found a bare number"),
        (1, [0.2, 0.3], "expected 1 joint value on the last axis, found 2"),
    ],
)
def test_a_wrong_number_of_joint_values_is_refused(kinds, q, says) -> None:
    form = HarmonicForm(np.zeros((3,) * kinds), ("revolute",) * kinds)
    for use in (form, form.gradient, lambda x: form.along(0, x)):
        with pytest.raises(ValueError, match=f"^{says}$"):
            use(q)


# --- polylines of curves --------------------------------------------------------------------------


def circle(radius):
    def at(s):
        return radius * np.stack([np.cos(6 * s), np.sin(6 * s)], axis=-1)

    return at


@given(st.floats(0.01, 100), st.floats(1e-6, 1e-2))
def test_the_curve_is_within_the_tolerance_of_its_polyline(radius, part) -> None:
    """A circle's chord is farthest from it in the middle, by r (1 - cos(half angle))."""
    s, stated = flatten(circle(radius), part * radius)
    exact = radius * (1 - np.cos(6 * np.diff(s).max() / 2))
    assert exact <= stated * (1 + 1e-6) <= part * radius
    assert (s[0], s[-1]) == (0, 1)
    assert (np.diff(s) > 0).all()


def test_a_finer_tolerance_costs_points_by_its_square_root() -> None:
    few, many = (len(flatten(circle(1), d)[0]) for d in (1e-3, 1e-7))
    assert 50 < many / few < 200


def test_a_straight_line_needs_no_more_points_than_it_gets() -> None:
    s, off = flatten(lambda s: np.stack([s, 2 * s], axis=-1), 1e-9, parts=1)
    assert len(s) == 5
    assert off < 1e-15


def test_a_corner_between_the_looks_is_closed_in() -> None:
    """A curve with a corner at 1/3 is refined there until nothing sticks out."""
    s, _ = flatten(lambda s: np.stack([s, np.abs(s - 1 / 3)], axis=-1), 1e-6)
    assert np.abs(s - 1 / 3).min() < 1e-5


def test_deviation_is_that_from_the_piece_and_not_from_its_line() -> None:
    """A curve that runs back over itself: 1 beyond the chord's end."""
    off = deviations(
        lambda s: np.stack([np.where(s < 0.5, 4 * s, 4 - 4 * s), 0 * s], axis=-1),
        np.array([0.0, 1.0]),
    )
    assert off == pytest.approx([2.0])


@pytest.mark.parametrize("bad", [0, -1, np.nan])
def test_a_deviation_is_above_zero(bad) -> None:
    with pytest.raises(ValueError, match="above 0"):
        flatten(circle(1), bad)


def test_what_winds_ever_faster_cannot_be_followed() -> None:
    """Endlessly many turns of a circle on the way to one place."""

    def winding(s):
        angle = 20 * np.log(np.abs(s - 0.3141))
        return np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    with pytest.raises(ValueError, match="not smooth"):
        flatten(winding, 1e-2)
