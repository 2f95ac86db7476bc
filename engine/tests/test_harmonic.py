"""What the engine asks of harmonic forms, against the sum written out; polylines of curves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal

from cspace.forms.harmonic import add_constant, combined, restrict, size, waves
from cspace.geometry.polygon import deviations, flatten
from engine_support.oracles import ANGLES
from qbound.forms import HarmonicForm, basis

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


@given(forms(stack=(2,)), st.data())
def test_restriction_holds_joints(form, data) -> None:
    q = configuration(data, form)
    held = data.draw(st.sets(st.integers(0, len(q) - 1), max_size=len(q) - 1))
    restricted = restrict(form, {j: q[j] for j in held})
    left = [j for j in range(len(q)) if j not in held]
    assert restricted.kinds == tuple(form.kinds[j] for j in left)
    assert_allclose(restricted(q[left]), form(q), **tolerance(form))


@given(forms(), st.data())
def test_restriction_of_every_joint_leaves_the_value(form, data) -> None:
    q = configuration(data, form)
    left = restrict(form, dict(enumerate(q)))
    assert left.kinds == ()
    assert_allclose(left.coefficients, form(q), **tolerance(form))


@given(forms(), st.data())
def test_waves_add_up_to_the_form(form, data) -> None:
    q, found = configuration(data, form), waves(form)
    terms = found.amplitudes * np.exp(1j * found.turns @ q) * np.prod(q**found.powers, axis=1)
    assert_allclose(terms.real.sum(), form(q), **tolerance(form))


@given(forms(stack=(2,)), st.data())
def test_size_is_above_the_sum_of_all_terms(form, data) -> None:
    q = configuration(data, form)
    largest = size(form, np.abs(q))
    terms = HarmonicForm(np.abs(form.coefficients), form.kinds)
    absolute = combined(terms, [np.abs(basis(k, x)) for k, x in zip(form.kinds, q, strict=True)])
    assert (largest >= absolute * (1 - 1e-12)).all()
    assert (np.abs(form(q)) <= largest * (1 + 1e-12)).all()


def test_adding_a_constant_leaves_the_coefficients_alone() -> None:
    coefficients = np.zeros((3, 3))
    assert add_constant(coefficients, 2.5)[0, 0] == 2.5
    assert not coefficients.any()
    assert add_constant(np.zeros(3, dtype=int), 0.5)[0] == 0.5  # integers do not cut it off


def test_a_prismatic_joint_has_a_square() -> None:
    form = HarmonicForm(np.array([5.0, -3.0, 2.0]), ("prismatic",))
    q = np.array([[0.0], [1.0], [-2.0]])
    assert_array_equal(form(q), [5, 4, 19])
    assert_array_equal(form.gradient(q)[:, 0], [-3, 1, -11])
    assert_array_equal(basis("prismatic", 3.0), [1, 3, 9])


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
