"""Theorem 2 and Table 6: every case of the theorem, both roots, the arc, the windows."""

from dataclasses import replace
from math import acos, atan, atan2, hypot, pi, sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from lizarraga2025 import printed
from qbound import Pair, circle_arc, circle_roots, joint_windows, load_robot, pair_vector
from qbound.circle import ALL, TURN, first_from, line_roots, nearest_turn, roots_along
from qbound.forms import JointForm
from qbound.symbols import offset_values
from qbound.windows import LOWER, UPPER, Bound, window_box
from support.chains import NUMBERS, forms

ROBOT = load_robot("minervabot-v2")

# a, b, c -> number of roots, half-width of the arc; None where a cos q + b sin q >= c nowhere.
CASES = {
    "c < -d: every angle, no root": (3, 4, -5.1, 0, pi),
    "c far below -d": (3, 4, -1e300, 0, pi),
    "c = -d: every angle, a double root": (3, 4, -5, 1, pi),
    "-d < c < 0": (3, 4, -2.5, 2, 2 * pi / 3),
    "c = 0": (3, 4, 0, 2, pi / 2),
    "0 < c < d": (3, 4, 2.5, 2, pi / 3),
    "c = d: one angle, a double root": (3, 4, 5, 1, 0),
    "c = d, d irrational": (1, 1, sqrt(2), 1, 0),
    "c > d: none": (3, 4, 5.1, 0, None),
    "d = 0, c < 0: every angle, no root": (0, 0, -1, 0, pi),
    "d = 0, c = 0: every angle is a root": (0, 0, 0, ALL, pi),
    "d = 0, c > 0: none": (0, 0, 1, 0, None),
    "d is rounding beside c": (1e-16, -1e-17, 1, 0, None),
    "a = 0": (0, 2, 1, 2, pi / 3),
    "a < 0": (-2, 0, 1, 2, pi / 3),
    "all of it tiny": (3e-200, 4e-200, 2.5e-200, 2, pi / 3),
    "all of it huge": (3e200, 4e200, 2.5e200, 2, pi / 3),
}


@pytest.mark.parametrize(("a", "b", "c", "count", "half"), CASES.values(), ids=CASES)
def test_every_case_of_theorem_2(a, b, c, count, half):
    roots, arc = circle_roots(a, b, c), circle_arc(a, b, c)
    assert roots.count == count
    assert roots.multiplicity == {2: 1, 1: 2}.get(count, 0)
    assert arc.empty == (half is None)
    assert_allclose(arc.half_width, half or 0, atol=1e-15)
    if count == 2:
        assert_allclose(roots.q, atan2(b, a) + np.array([-half, half]), atol=1e-15)
        assert_array_equal(roots.slope, [1, -1])


@given(NUMBERS, NUMBERS, NUMBERS)
def test_roots_are_where_signs_change(a, b, c):
    q = np.linspace(-pi, pi, 20_001)
    signs = np.sign(a * np.cos(q) + b * np.sin(q) - c)
    changes = q[:-1][signs[:-1] * signs[1:] < 0]
    roots = circle_roots(a, b, c)
    assume(abs(abs(c) - hypot(a, b)) > 1e-3 * hypot(a, b))
    found = np.sort(nearest_turn(roots.q, 0.0)) if roots.count > 0 else np.empty(0)
    inside = found[np.abs(found) < pi - 1e-3]
    assert len(changes) <= len(found)
    for root in inside:
        assert abs(a * np.cos(root) + b * np.sin(root) - c) < 1e-12
    arc = circle_arc(a, b, c)
    share = 0.0 if arc.empty else float(arc.half_width) / pi
    assert_allclose(share, (signs[:-1] >= 0).mean(), atol=1e-3)


@given(NUMBERS, NUMBERS, st.integers(-99, 99))
def test_the_printed_theorem_holds_with_atan2_alone(a, b, percent):
    assume(hypot(a, b) > 0.1 and abs(a) > 0.01)
    d, c = hypot(a, b), percent / 100 * hypot(a, b)
    roots = circle_roots(a, b, c)
    printed_root = atan(b / a) + acos(c / d)
    value = a * np.cos(printed_root) + b * np.sin(printed_root)
    assert_allclose(value, c if a > 0 else -c, atol=1e-12)  # arctan loses the quadrant
    assert_allclose(np.ptp(roots.q), 2 * acos(c / d), atol=1e-12)  # not 2 pi, as eq. (39) has it


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1j])
def test_what_is_not_a_real_number_is_refused(bad):
    for numbers in ((bad, 1, 1), (1, bad, 1), (1, 1, bad)):
        with pytest.raises(ValueError, match="must be"):
            circle_roots(*numbers)


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


def test_limits_cut_the_box():
    limited = replace(ROBOT.joints[1], limits=(-1.0, 2.0))
    box = window_box(replace(ROBOT, joints=(ROBOT.joints[0], limited)))
    assert box.lower[1] == -1.0
    assert box.lower_bounds[1].label == "q2.lower"
    assert box.upper_bounds[1].label == "beta_{3,3,1}"


def test_a_joint_that_slides_keeps_the_values_on_homes_side_of_a_root():
    sliding = replace(ROBOT.joints[1], kind="prismatic", axis=[1, 0, 0], limits=(-3.0, 20.0))
    arm = replace(ROBOT, joints=(ROBOT.joints[0], sliding))
    window = next(w for w in joint_windows(arm) if w.boundary == "B3")
    # x_{1,2} + x_{2,11} + q = x_{1,10}: the x component vanishes at q = 17.82 - 15 - 9.09.
    assert_allclose([window.lower, window.upper], [17.82 - 15 - 9.09, np.inf])
    box = window_box(arm)
    assert_allclose([box.lower[1], box.upper[1]], [-3.0, 20.0])


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
