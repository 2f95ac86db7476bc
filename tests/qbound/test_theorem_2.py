"""Roots along a joint of any kind, and Table 6: the windows and the box."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from lizarraga2025 import printed
from qbound import Pair, joint_windows, load_robot, pair_vector
from qbound.circle import TURN, first_from, line_roots, nearest_turn, roots_along
from qbound.forms import JointForm
from qbound.symbols import offset_values
from qbound.windows import LOWER, UPPER, Bound, window_box
from support.chains import NUMBERS, forms

ROBOT = load_robot("minervabot-v2")


@given(NUMBERS, NUMBERS, NUMBERS)
def test_line_roots_are_those_of_the_quadratic(c0, a, b):
    rising, falling = line_roots(JointForm(np.array(c0), np.array(a), np.array(b))).tolist()
    for root, sign in ((rising, 1), (falling, -1)):
        if not np.isnan(root):
            assert abs(c0 + a * root + b * root**2) <= 1e-10 * (
                1 + abs(a * root) + abs(b) * root**2
            )
            assert sign * (a + 2 * b * root) > 0
    expected = 2 if b and a * a > 4 * b * c0 else int(b == 0 and a != 0)
    assert sum(not np.isnan(root) for root in (rising, falling)) == expected


@given(forms(), st.data())
def test_roots_along_a_joint_are_zeros_of_the_form(form, data):
    n = len(form.kinds)
    joint, q = data.draw(st.integers(0, n - 1)), np.array(data.draw(st.tuples(*[NUMBERS] * n)))
    for root, sign in zip(roots_along(form, joint, q).tolist(), (1, -1), strict=True):
        if not np.isnan(root) and abs(root) < 1e3:
            q[joint] = root
            size = np.abs(form.coefficients).sum() * (1 + abs(q).max()) ** (2 * n)
            assert abs(form(q)) <= 1e-12 * size
            assert sign * form.derivative(joint)(q) >= -1e-6 * size


@given(NUMBERS, NUMBERS)
def test_full_turns(low, q):
    first = first_from(low, q)
    assert low <= first < low + TURN
    near = nearest_turn(q, low)
    assert low - pi < near <= low + pi + 1e-12
    for moved in (first, near):
        turns = (moved - q) / TURN
        assert_allclose(turns, np.rint(turns), atol=1e-12)


# --- Table 6


def test_the_windows_are_the_sixteen_printed_bounds_of_the_pairs():
    values = offset_values(ROBOT)
    found = {}
    for window in joint_windows(ROBOT):
        found[window.bound(UPPER).label] = window.upper
        found[window.bound(LOWER).label] = window.lower
    names = [name for name in printed.TABLE_6 if printed.indices(name)[0] < 5]
    assert set(found) == set(names)
    for name in names:
        formula = printed.expression(printed.TABLE_6[name], arctan="atan2")
        assert_allclose(found[name], float(formula.subs(values)), atol=1e-12)


def test_every_window_is_one_turn_that_holds_home_between_roots():
    for window in joint_windows(ROBOT):
        assert window.lower <= ROBOT.home[window.joint] <= window.upper
        assert_allclose(window.upper - window.lower, TURN, atol=1e-14)
        vector = pair_vector(ROBOT, ROBOT.boundary(window.boundary))
        for root in (window.lower, window.upper, window.other_root):
            q = np.zeros(2)
            q[window.joint] = root
            assert_allclose(vector(q)[window.component - 1], 0, atol=1e-13)


def test_the_box_is_bounded_as_the_caption_of_figure_4_says_but_for_one_index():
    box = window_box(ROBOT)
    labels = {bound.label for bound in (*box.lower_bounds, *box.upper_bounds)}
    caption = {name for name in printed.FIGURE_4_BOUNDS if printed.indices(name)[0] < 5}
    assert labels - caption == {"beta_{3,3,1}"}
    assert caption - labels == {"beta_{3,3,2}"}
    assert_allclose(np.degrees(box.lower), [-136.239293056278, -162.303209458377], atol=1e-11)
    assert_allclose(np.degrees(box.upper), [76.224073003191, 44.381300390486], atol=1e-11)


def test_labels_of_bounds():
    assert Bound("B1", 3, UPPER).label == "beta_{1,3,1}"
    assert Bound("q2", 0, LOWER).label == "q2.lower"


def test_a_component_across_rounding_has_no_window():
    turned = replace(ROBOT.joints[0], axis=[1e-17, 1.0, 1e-17])
    arm = replace(ROBOT, joints=(turned, ROBOT.joints[1]))
    assert [w.component for w in joint_windows(arm) if w.joint == 0] == [1, 3, 1, 3]


@pytest.mark.parametrize("unit", [1.0, 1e14])
def test_a_joint_that_slides_keeps_the_values_on_homes_side_of_a_root(unit):
    limits = (-3.0 * unit, 20.0 * unit)
    turning, sliding = (replace(j, origin=np.multiply(j.origin, unit)) for j in ROBOT.joints)
    sliding = replace(sliding, kind="prismatic", axis=[1, 0, 0], limits=limits)
    points = tuple(replace(point, at=np.multiply(point.at, unit)) for point in ROBOT.points)
    arm = replace(ROBOT, joints=(turning, sliding), points=points)
    window = next(w for w in joint_windows(arm) if w.boundary == "B3")
    # x_{1,2} + x_{2,11} + q = x_{1,10}: the x component vanishes at q = 17.82 - 15 - 9.09.
    assert_allclose([window.lower, window.upper], [(17.82 - 15 - 9.09) * unit, np.inf])
    box = window_box(arm)
    assert_allclose([box.lower[1], box.upper[1]], limits)


def test_a_component_that_slides_through_zero_at_home_has_no_window():
    sliding = replace(ROBOT.joints[1], kind="prismatic", limits=(-3.0, 20.0))  # along y
    with pytest.raises(ValueError, match="B3: its component y vanishes at home"):
        joint_windows(replace(ROBOT, joints=(ROBOT.joints[0], sliding)))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"boundaries": ()}, "q1: no window and no limit bounds it"),
        ({"boundaries": (Pair("B1", ("6", "11")),)}, "B1: its points are 2 joints apart.*cspace"),
        ({"boundaries": (Pair("B1", ("7", "9")),)}, "B1: its points are 0 joints apart"),
        (
            {"joints": (replace(ROBOT.joints[0], limits=(2.0, 3.0)), ROBOT.joints[1])},
            "q1: no value is left between q1.lower and beta_{1,3,1}",
        ),
        (
            {
                "boundaries": (),
                "joints": tuple(replace(joint, limits=(-4.0, 4.0)) for joint in ROBOT.joints),
            },
            "q1: more than one turn is left.*cspace",
        ),
    ],
)
def test_arms_without_a_box_are_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        window_box(replace(ROBOT, **changes))
