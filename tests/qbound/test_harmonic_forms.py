"""Harmonic forms: values, slopes, forms in one joint, arithmetic; by plain sums and SymPy."""

from itertools import product
from math import cos, sin

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from qbound.forms import HarmonicForm, combine, constant, stacked
from support.chains import ANGLES, forms


def by_hand(form, q):
    """Sum the terms of a single form one by one."""
    total = 0.0
    for index in product(range(3), repeat=len(form.kinds)):
        term = form.coefficients[index]
        for kind, value, i in zip(form.kinds, q, index, strict=True):
            turning, sliding = (1, cos(value), sin(value)), (1, value, value**2)
            term *= (turning if kind == "revolute" else sliding)[i]
        total += term
    return total


def values(data, form):
    n = len(form.kinds)
    return np.array(data.draw(st.lists(ANGLES, min_size=n, max_size=n)))


@given(forms(), st.data())
def test_a_value_is_the_sum_of_all_terms(form, data):
    q = values(data, form)
    assert_allclose(form(q), by_hand(form, q), atol=1e-10)


@given(forms(stack=(2,)), st.data())
def test_stack_and_batch_keep_their_shapes(form, data):
    q = np.stack([[values(data, form) for _ in range(3)]] * 4)
    found = form(q)
    assert found.shape == (4, 3, 2)
    assert form.gradient(q).shape == (4, 3, 2, len(form.kinds))
    assert form.hessian(q).shape == (4, 3, 2, len(form.kinds), len(form.kinds))
    assert_allclose(found[1, 2], [form[0](q[1, 2]), form[1](q[1, 2])], atol=1e-12)


@given(forms(), st.data())
def test_derivatives_are_those_of_sympy(form, data):
    q = values(data, form)
    symbols = sp.symbols(f"q1:{len(q) + 1}")
    expression = form.symbolic(symbols)
    at = dict(zip(symbols, q.tolist(), strict=True))
    slopes = [float(sp.diff(expression, x).subs(at)) for x in symbols]
    assert_allclose(form.gradient(q), slopes, atol=1e-9)
    second = [[float(sp.diff(expression, x, y).subs(at)) for x in symbols] for y in symbols]
    assert_allclose(form.hessian(q), second, atol=1e-9)


@given(forms(stack=(2,)), st.data())
def test_the_form_along_a_joint_is_the_form_with_the_others_held(form, data):
    q = values(data, form)
    joint = data.draw(st.integers(0, len(q) - 1))
    c0, a, b = form.along(joint, q)
    x = q[joint]
    turns = form.kinds[joint] == "revolute"
    value = c0 + a * (cos(x) if turns else x) + b * (sin(x) if turns else x * x)
    assert_allclose(value, form(q), atol=1e-10)


@given(forms(n=2, stack=(3,)), forms(n=2, stack=(3,)), st.data())
def test_arithmetic_acts_on_values(one, other, data):
    other = HarmonicForm(other.coefficients, one.kinds)
    q = values(data, one)
    v, w, m = one(q), other(q), np.arange(9.0).reshape(3, 3)
    assert_allclose((2 * one - other + [1, 2, 3])(q), 2 * v - w + [1, 2, 3], atol=1e-9)
    assert_allclose(([1, 2, 3] + -one)(q), [1, 2, 3] - v, atol=1e-9)
    assert_allclose(one.dot(m)(q), m @ v, atol=1e-9)
    assert_allclose(one.dot([1, 2, 3])(q), v @ [1, 2, 3], atol=1e-9)
    assert_allclose(stacked([one[0], other[1]], one.kinds)(q), [v[0], w[1]], atol=1e-12)


def test_combine_makes_a_form_in_one_more_joint():
    kinds = ("revolute", "prismatic")
    form = combine(1, *(constant(x, kinds) for x in (1.0, 2.0, 3.0)))
    assert form([0.3, 5.0]) == 1 + 2 * 5 + 3 * 25
    assert form.joints() == (1,)


def test_a_form_takes_exact_numbers():
    half = sp.Rational(1, 2)
    coefficients = np.array([[sp.Integer(1), half, 0], [0, 0, 0], [0, 0, half]], dtype=object)
    form = HarmonicForm(coefficients, ("revolute", "prismatic"))
    assert form(np.array([sp.pi / 2, half], dtype=object)) == 1 + half * half + half * half**2 * 1
    q1, q2 = sp.symbols("q1 q2")
    assert form.symbolic((q1, q2)) == 1 + q2 / 2 + sp.sin(q1) * q2**2 / 2 - sp.Integer(0)


def test_wrong_shapes_are_refused():
    with pytest.raises(ValueError, match="2 joints need 2 last axes of length 3"):
        HarmonicForm(np.zeros((3, 2)), ("revolute", "revolute"))
    with pytest.raises(ValueError, match="expected 1 joint values"):
        constant(1.0, ("revolute",))([1.0, 2.0])


def test_no_forms_are_a_stack_too():
    assert stacked([], ("revolute",))([[0.1], [0.2]]).shape == (2, 0)
