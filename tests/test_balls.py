"""Ball arithmetic of forms: every ball holds the true value, and precision is put back."""

import subprocess
import sys

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st

from qbound.forms.harmonic import HarmonicForm
from qbound.proofs.exact.bounds import magnitude
from qbound.proofs.exact.numbers import above, below, precision
from support.forms import random_form


def by_hand(coefficients, kinds, q):
    """The sum over all products, by mpmath."""
    total = mpmath.mpf(0)
    for index, c in np.ndenumerate(coefficients):
        term = mpmath.mpf(c)
        for i, kind, x in zip(index, kinds, q, strict=True):
            one, two = (mpmath.cos(x), mpmath.sin(x)) if kind == "revolute" else (x, x * x)
            term *= (mpmath.mpf(1), one, two)[i]
        total += term
    return total


def holds(ball: arb, value) -> bool:
    return abs(ball - arb(mpmath.nstr(value, 55))) <= abs(ball.rad()) + arb("1e-50")


numbers = st.tuples(st.integers(0, 10**6), st.integers(1, 3))


@given(numbers)
def test_values_hold_what_mpmath_finds_at_50_digits(case):
    form = random_form(*case)
    q = np.random.default_rng(case[0]).uniform(-4, 4, case[1])
    with precision(250), mpmath.workdps(60):
        there = form([arb(x) for x in q])
        exact = [by_hand(c, form.kinds, list(map(mpmath.mpf, q))) for c in form.coefficients]
        assert all(holds(ball, value) for ball, value in zip(there, exact, strict=True))
        assert all(ball.rel_accuracy_bits() > 200 for ball in there)


@given(numbers)
def test_a_box_holds_the_values_of_its_points(case):
    form = random_form(*case)
    rng = np.random.default_rng(case[0])
    middle, radius = rng.uniform(-4, 4, case[1]), rng.uniform(0, 1, case[1])
    box = [arb(m, r) for m, r in zip(middle, radius, strict=True)]
    enclosures = form(box)
    for point in rng.uniform(middle - radius, middle + radius, (20, case[1])):
        inside = form([arb(x) for x in point])
        assert all(box.contains(x) for box, x in zip(enclosures, inside, strict=True))


@given(numbers)
def test_derivatives_are_those_of_mpmath(case):
    form = random_form(*case)
    q = [mpmath.mpf(x) for x in np.random.default_rng(case[0]).uniform(-4, 4, case[1])]
    with precision(250), mpmath.workdps(60):
        for j in range(case[1]):
            slopes = form.derivative(j)([arb(mpmath.nstr(x, 55)) for x in q])
            for slope, c in zip(slopes, form.coefficients, strict=True):

                def line(x, c=c, j=j):
                    return by_hand(c, form.kinds, [*q[:j], x, *q[j + 1 :]])

                assert abs(slope - arb(mpmath.nstr(mpmath.diff(line, q[j]), 50))) < arb("1e-20")


@settings(max_examples=20)
@given(numbers)
def test_coefficients_along_a_joint_give_the_value_back(case):
    form = random_form(*case)
    q = [arb(x) for x in np.random.default_rng(case[0]).uniform(-4, 4, case[1])]
    for j, kind in enumerate(form.kinds):
        one, two = (q[j].cos(), q[j].sin()) if kind == "revolute" else (q[j], q[j] ** 2)
        for c, whole in zip(form.along(j, q), form(q), strict=True):
            assert (c[0] + c[1] * one + c[2] * two).overlaps(whole)


@given(numbers)
def test_magnitude_bounds_every_value_and_not_by_much(case):
    form = random_form(*case)
    reach = np.full(case[1], 2.0)
    bound = magnitude(form, reach)
    points = np.random.default_rng(0).uniform(-1, 1, (4000, case[1]))
    scale = [np.pi if kind == "revolute" else 2.0 for kind in form.kinds]
    largest = np.abs(form(points * scale)).max(axis=0)
    assert (largest <= bound).all()
    terms = np.abs(form.coefficients).sum(axis=tuple(range(1, case[1] + 1)))
    assert (bound <= terms * 4.01 ** case[1]).all()


def test_precision_is_put_back_even_after_an_error():
    before = ctx.prec
    with pytest.raises(ZeroDivisionError), precision(300):
        1 // (ctx.prec - 300)
    assert ctx.prec == before


def test_decimals_and_doubles_differ():
    with precision(128):
        assert not arb("0.1").overlaps(arb(0.1))


@given(st.floats(-1e10, 1e10), st.floats(0, 1e5))
def test_outward_doubles_lie_outside(middle, radius):
    ball = arb(middle, radius)
    assert arb(below(ball)) < ball < arb(above(ball)) or radius == 0
    assert below(ball) <= middle <= above(ball)


@settings(max_examples=20)
@given(numbers)
def test_many_boxes_at_once_are_each_box_alone(case):
    form = random_form(*case)
    q = np.random.default_rng(case[0]).uniform(-4, 4, (2, 3, case[1]))
    boxes = np.vectorize(arb, otypes=[object])(q)
    found = form(boxes), form.gradient(boxes), form.along(0, boxes)
    assert [x.shape for x in found] == [(2, 3, 2), (2, 3, 2, case[1]), (2, 3, 2, 3)]
    alone = form(boxes[1, 2]), form.gradient(boxes[1, 2]), form.along(0, boxes[1, 2])
    for many, one in zip(found, alone, strict=True):
        assert all(x == y or x.overlaps(y) for x, y in zip(many[1, 2].flat, one.flat, strict=True))
    assert np.allclose(found[0].astype(float), form(q))


def test_a_coefficient_that_may_be_zero_or_not_is_a_dependence():
    table = np.zeros((3, 3), dtype=object)
    table[0, 2], table[0, 1] = arb(0, 1e-9), arb(0)
    assert HarmonicForm(table, ("revolute", "prismatic")).joints() == (1,)


@pytest.mark.parametrize(
    ("module", "command"),
    [
        ("scipy", ["why", "two-joint-arm-with-walls", "20", "60", "-134.26", "-130.08"]),
        ("shapely", ["certify", "minervabot-v2", "--scale", "0.9"]),
    ],
)
def test_a_missing_library_is_named_with_its_extra(module, command):
    code = (
        f"import sys; sys.modules[{module!r}] = None\n"
        f"from qbound.cli import main; sys.exit(main({command}))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert "qbound[proofs]" in run.stderr
    assert run.stderr.count("\n") == 1
