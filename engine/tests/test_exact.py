"""Exact numbers of a robot: decimals, degrees, quarter turns, unit vectors."""

from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from flint import arb, fmpq
from hypothesis import given
from numpy.testing import assert_allclose

from cspace import load_robot, save_robot
from cspace.boundary.evaluator import stacked
from cspace.boundary.functions import clearance
from cspace.forms.harmonic import restrict
from cspace.geometry.convex import doubled_area, exact_parts, in_whole_numbers
from cspace.model.robotfile import parse_robot, robot_text
from cspace.proofs.exact.bounds import magnitude
from cspace.proofs.exact.numbers import balls, precision
from cspace.proofs.exact.problem import ExactProblem, exact_problem, exact_robot
from cspace.region import clearance_problem
from engine_support.oracles import robot_tables
from engine_support.robot_files import robot_file
from engine_support.second_checker import demand_filled
from lizarraga2025.beyond.certainty import exact_windows_problem
from qbound.forms import HarmonicForm
from qbound.windows import window_box


def holds(ball, value: mpmath.mpf) -> bool:
    """Whether a ball holds a number that mpmath knows to 50 digits, but for these digits."""
    with precision(300):
        return bool(abs(ball - arb(mpmath.nstr(value, 50))) < arb("1e-40"))


def written(tmp_path, **changes):
    """A robot file of the paper's robot with other rows."""
    text, _ = robot_text("minervabot-v2")
    for old, new in changes.values():
        assert old in text
        text = text.replace(old, new, 1)
    file = tmp_path / "robot.toml"
    file.write_text(text)
    return file


def test_decimals_of_the_file_are_rationals_and_not_doubles():
    point = exact_robot("minervabot-v2").point("11")
    assert point.at[0] == fmpq(909, 100)
    assert Fraction(9.09) != Fraction(909, 100)
    assert exact_robot("minervabot-v2").boundary("B1").clearance == fmpq(1, 10)


def test_a_robot_of_doubles_counts_each_double_as_the_fraction_that_it_is():
    robot, exact = load_robot("minervabot-v2"), Fraction(9.09)
    assert exact_robot(robot).point("11").at[0] == fmpq(909, 100)  # it knows its file
    point = exact_robot(replace(robot, source=None)).point("11")
    assert point.at[0] == fmpq(exact.numerator, exact.denominator)


def test_degrees_are_rationals_times_pi(tmp_path):
    axis = "axis = [0.0, 1.0, 0.0]"
    file = written(tmp_path, limits=(axis, f"{axis}\nlimits = [-100.1, 20]"))
    low, high = exact_robot(file).joints[0].limits
    with mpmath.workdps(60):
        assert holds(low, -mpmath.pi * 1001 / 1800)
        assert holds(high, mpmath.pi / 9)
    assert low.rel_accuracy_bits() > 500


def test_a_mount_of_quarter_turns_is_whole_and_another_is_a_rotation(tmp_path):
    axis = "axis = [0.0, 1.0, 0.0]"
    quarter = exact_robot(written(tmp_path, rpy=(axis, f"{axis}\nrpy = [90, -90, 180]")))
    assert all(isinstance(x, fmpq) for x in quarter.joints[0].mount.ravel())
    turned = written(tmp_path, rpy=(axis, f"{axis}\nrpy = [10, 20.5, -77]"))
    mount = exact_robot(turned).joints[0].mount
    assert_allclose(mount.astype(float), load_robot(turned).joints[0].mount, atol=1e-15)
    with precision(512):
        rest = mount @ mount.T - np.eye(3, dtype=int)
        assert all(abs(x) < 1e-150 for x in rest.ravel())


@pytest.mark.parametrize(("axis", "rational"), [("[3, 4, 0]", True), ("[1, 1, 0.0]", False)])
def test_an_axis_has_length_1_exactly_or_in_a_ball(tmp_path, axis, rational):
    file = written(tmp_path, axis=("axis = [0.0, 1.0, 0.0]", f"axis = {axis}"))
    unit = exact_robot(file).joints[0].axis
    with precision(512):
        assert (unit @ unit == 1) if rational else abs(unit @ unit - 1) < 1e-150


def test_an_exponent_beyond_all_doubles_is_refused(tmp_path):
    file = written(tmp_path, tiny=("origin = [0.0, 0.0, 22.5]", "origin = [1e-999999999, 0, 22.5]"))
    with pytest.raises(ValueError, match="1e-999999999"):
        exact_robot(file)


@given(robot_tables())
def test_exact_forms_are_the_float_forms_but_for_rounding(table):
    robot = parse_robot(table)
    exact = exact_problem(exact_robot(robot))
    q = np.linspace(-1.3, 2.1, len(robot.joints))
    for boundary, form in zip([b for b in robot.boundaries if b.used], exact.forms, strict=True):
        float_form = clearance(robot, boundary)
        there = form([arb(x) for x in q])
        size = np.abs(float_form.coefficients).sum() * 10
        assert abs(float(there[()]) - float_form(q)) <= 1e-13 * size


def test_a_saved_robot_has_the_numbers_of_the_first(tmp_path):
    save_robot(load_robot("minervabot-v2"), tmp_path / "again.toml")
    one, other = (
        exact_problem(exact_robot(source)) for source in ("minervabot-v2", tmp_path / "again.toml")
    )
    same = one.forms.coefficients == other.forms.coefficients
    assert np.all(same)


def test_windows_of_table_6_are_roots_at_50_digits():
    """The upper bound of q1 is a root of beta_{1,3}, the lower of beta_{2,1}; Table 3's offsets."""
    problem: ExactProblem = exact_windows_problem(
        load_robot("minervabot-v2"), exact_robot("minervabot-v2")
    )
    floats = window_box(load_robot("minervabot-v2"))
    (low1, high1), (low2, high2) = problem.ranges
    assert_allclose([float(low1), float(low2)], floats.lower, atol=1e-14)
    assert_allclose([float(high1), float(high2)], floats.upper, atol=1e-14)
    with mpmath.workdps(60):
        o = {k: mpmath.mpf(v) for k, v in {"x": "11.5", "z": "4.91", "lift": "10"}.items()}
        root = mpmath.findroot(
            lambda q: o["z"] * mpmath.cos(q) - o["x"] * mpmath.sin(q) + o["lift"], 1.33
        )
        assert holds(high1, root)


def test_a_limit_of_the_joint_is_a_side_of_the_papers_box(tmp_path):
    """Home may lie beyond it: the limit does not decide which turn a window takes."""
    row = "origin = [15.0, 0.0, 25.98]\naxis = [0.0, 1.0, 0.0]"
    file = written(tmp_path, limits=(row, f"{row}\nlimits = [30.0, 60.0]"))
    low, high = exact_windows_problem(load_robot(file), exact_robot(file)).ranges[1]
    with mpmath.workdps(60):
        assert holds(low, mpmath.pi / 6)
    assert float(high) == pytest.approx(window_box(load_robot("minervabot-v2")).upper[1])


def test_held_joints_leave_the_others():
    robot = exact_robot("minervabot-v2")
    held = exact_problem(robot, {0: 0.25})
    whole = clearance_problem(load_robot("minervabot-v2")).forms
    assert held.kinds == ("revolute",)
    assert_allclose(held.forms([arb(0.5)]).astype(float), whole([0.25, 0.5]), rtol=1e-13)


@pytest.mark.parametrize("seed", range(3))
def test_forms_of_a_frozen_robot_are_those_of_the_robot_restricted(seed):
    robot = exact_robot(parse_robot(robot_file(seed, 4)))
    held = {0: 0.3, 2: -1.25}
    problem = exact_problem(robot, held)
    with precision(512):
        values = {j: arb(x) for j, x in held.items()}
        restricted = restrict(stacked(robot, robot.used), values).coefficients
        gaps = abs(balls(restricted) - balls(problem.forms.coefficients))
        assert problem.forms.kinds == (robot.kinds[1], robot.kinds[3])
        assert all(gap < arb("1e-140") for gap in gaps.flat)


def test_a_bound_of_coefficients_around_nothing_is_a_number():
    """A mount in radians leaves balls around 0; a power of one is NaN in python-flint."""
    with precision(100):
        around = arb(0, "1e-150")
        form = HarmonicForm(np.array([around, arb(1), around], dtype=object), ("revolute",))
        assert 1.0 <= magnitude(form, [1.0]) < 1.0 + 1e-12


@pytest.mark.parametrize("digits", [2, 4, 17])
def test_parts_fill_outlines_with_corners_that_are_nearly_on_an_edge(digits):
    """Of 17 digits none was filled: floats took the corner for one of the edge."""
    filled = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(4, 12)))
        rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        loop = (rays * rng.uniform(0.5, 2, (len(rays), 1))).round(digits).tolist()
        loop.insert(1, [(a + b) / 2 for a, b in zip(*loop[:2], strict=True)])
        corners = [tuple(Fraction(repr(x)) for x in corner) for corner in loop[:: (-1) ** seed]]
        try:
            found = exact_parts(corners)
        except ValueError:  # the outline crosses itself
            continue
        sense = 1 if doubled_area(in_whole_numbers(corners)) > 0 else -1
        loop = [(sense * x, y) for x, y in corners]
        demand_filled([loop], [[loop[k] for k in part] for part in found])
        filled += 1
    assert filled > 20
