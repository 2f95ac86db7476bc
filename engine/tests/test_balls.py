"""Ball arithmetic of forms: every ball holds the true value, and precision is put back."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from flint import arb, ctx
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cspace import clearance, load_robot
from cspace.boundary import balls as module
from cspace.boundary.balls import BLOCK, Balls
from cspace.boundary.chain import axis_last
from cspace.boundary.evaluator import evaluator
from cspace.model.robot import Pair, Point
from cspace.proofs.exact.bounds import magnitude
from cspace.proofs.exact.numbers import above, below, precision
from engine_support.ball_arms import arm_of_balls, drawn, with_parallelogram
from engine_support.forms import random_form
from qbound.forms import HarmonicForm


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
        for c, whole in zip(np.stack(form.along(j, q), axis=-1), form(q), strict=True):
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
    found = form(boxes), form.gradient(boxes), np.stack(form.along(0, boxes), axis=-1)
    assert [x.shape for x in found] == [(2, 3, 2), (2, 3, 2, case[1]), (2, 3, 2, 3)]
    one = boxes[1, 2]
    alone = form(one), form.gradient(one), np.stack(form.along(0, one), axis=-1)
    for many, one in zip(found, alone, strict=True):
        assert all(x == y or x.overlaps(y) for x, y in zip(many[1, 2].flat, one.flat, strict=True))
    assert np.allclose(found[0].astype(float), form(q))


def test_a_coefficient_that_may_be_zero_or_not_is_a_dependence():
    table = np.zeros((3, 3), dtype=object)
    table[0, 2], table[0, 1] = arb(0, 1e-9), arb(0)
    assert HarmonicForm(table, ("revolute", "prismatic")).joints() == (1,)


# --- margins by kinematics and distances ----------------------------------------------------------


ARMS = [*map(arm_of_balls, range(7)), *map(with_parallelogram, range(4))]
ARMS += [load_robot("minervabot-v2"), load_robot("pp-portal")]
NAMED = {"argvalues": ARMS, "ids": lambda robot: robot.name}


@pytest.mark.parametrize("robot", **NAMED)
def test_margins_are_those_of_the_compiled_forms(robot):
    q, compiled, balls = drawn(robot, 400), evaluator(robot, limits=False), Balls.of(robot)
    assert balls.names == compiled.names
    assert_allclose(balls.margins(q), compiled.margins(q), atol=1e-7)  # a root near distance 0
    clear = np.abs(compiled.margins(q)).min(axis=1) > 1e-9
    expected = (compiled.margins(q) >= 0).all(axis=1)
    assert_array_equal(balls.feasible(q)[clear], expected[clear])


@pytest.mark.parametrize("robot", **NAMED)
def test_centres_are_those_of_the_frames(robot):
    q = drawn(robot, 2 * BLOCK + 3)
    frames, found = robot.frames(q), Balls.of(robot).centres(q)
    for point, places in zip(robot.points, np.moveaxis(found, 1, 0), strict=True):
        expected = frames.position(robot.base, point.name, robot.base)
        assert_allclose(places, np.broadcast_to(expected, places.shape), atol=1e-13)


@pytest.mark.parametrize("robot", **NAMED)
def test_forms_along_a_joint_are_those_of_the_whole_form(robot):
    q = drawn(robot, 40)
    for j in range(len(robot.joints)):
        found = Balls.of(robot).along(robot.joints[j].name, q)
        for k, boundary in list(enumerate(robot.used))[j % 5 :: 5]:
            expected = np.stack(clearance(robot, boundary).along(j, q), axis=-1)
            size = np.abs(expected).max() + 1
            assert_allclose(found[:, k], expected, atol=1e-13 * size, err_msg=boundary.name)


@pytest.mark.parametrize("robot", **NAMED)
def test_a_pair_on_one_side_of_a_joint_is_constant_along_it(robot):
    balls, q = Balls.of(robot), drawn(robot, 5)
    for j in range(len(robot.joints)):
        moving = {*balls.pairs[balls.across(j)], *balls.walls[balls.beyond(j)]}
        still = [k for k in range(len(balls.names)) if k not in moving]
        assert (balls.along(j, q)[:, still, 1:] == 0).all()


@pytest.mark.parametrize("robot", ARMS[4:7], ids=lambda robot: robot.name)
def test_any_shape_of_configurations_is_one_after_the_other(robot):
    q, balls = drawn(robot, 2 * BLOCK + 2), Balls.of(robot)
    shaped = q.reshape(2, BLOCK + 1, -1)
    for ask in (balls.margins, balls.centres, balls.feasible, lambda q: balls.along(0, q)):
        many = ask(q)
        assert_array_equal(ask(shaped), many.reshape(2, BLOCK + 1, *many.shape[1:]))
        assert_allclose(ask(q[BLOCK]), many[BLOCK], atol=1e-12)
        assert ask(q[:0]).shape == (0, *many.shape[1:])


def test_limits_count_and_what_touches_is_feasible():
    robot = load_robot("pr-gantry-arm")
    balls = Balls.of(robot)
    low, high = robot.joints[0].limits
    inside = drawn(robot, 200)
    q = inside[balls.feasible(inside)][0]
    ends = [[low, q[1]], [high, q[1]], [low - 1e-9, q[1]], [high + 1e-9, q[1]]]
    walls = evaluator(robot, limits=False).feasible(ends)
    assert_array_equal(balls.feasible(ends), walls & [True, True, False, False])


def test_two_balls_that_always_touch_are_feasible():
    """A ball on the axis, another that turns about it: what keeps them apart is rounding alone."""
    robot = load_robot("minervabot-v2")
    radius, at = 0.1, np.array([0.1, 0.2, 0.3])
    points = (
        Point("on the axis", robot.base, robot.joints[0].origin, radius),
        Point("turning", robot.joints[0].frame, at, np.sqrt(0.14) - radius),
    )
    pair = Pair("touching", ("on the axis", "turning"))
    still = replace(robot, points=points, boundaries=(pair,), tool="turning")
    q = np.linspace([-3, 0], [3, 0], 100)
    assert Balls.of(still).feasible(q).all()
    assert_array_equal(Balls.of(still).margins(q).min(), 0.0)


def test_a_boundary_about_bodies_is_refused_by_name():
    with pytest.raises(ValueError, match="about bodies"):
        Balls.of(load_robot("two-links-on-a-table"))


@pytest.mark.parametrize("q", [[0.1], [[0.1, np.nan]], "home"])
def test_what_is_no_configuration_is_refused(q):
    balls = Balls.of(load_robot("minervabot-v2"))
    for ask in (balls.margins, balls.feasible, balls.centres, lambda q: balls.along(0, q)):
        with pytest.raises(ValueError, match=r"joint|numbers"):
            ask(q)


@pytest.mark.parametrize("axis", [[0, 0, 1], [0, -1, 0], [0.6, 0.0, 0.8], [1e-9, 1, 0]])
def test_an_axis_becomes_the_last_column_of_a_rotation(axis):
    axis = np.array(axis, dtype=float) / np.linalg.norm(axis)
    turned = axis_last(axis)
    assert_allclose(turned @ turned.T, np.eye(3), atol=1e-15)
    assert_allclose(turned[:, 2], axis)
    assert np.linalg.det(turned) == pytest.approx(1)


def test_an_arm_without_boundaries_has_no_margins():
    robot = replace(arm_of_balls(3, 3), boundaries=())
    assert Balls.of(robot).margins(np.zeros((4, 3))).shape == (4, 0)


@pytest.mark.parametrize("name", ["minervabot-v2", "rp-telescopic-boom", "ur5", "panda.urdf"])
@pytest.mark.parametrize("limits", [True, False])
def test_spheres_judge_as_forms_do_where_forms_cost_more(name, limits, monkeypatch):
    """An arm of seven joints and 5,472 pairs took 20 ms for one configuration, by its forms."""
    robot = load_robot(name)
    forms = evaluator(robot, limits=limits)
    assert module.judge.__wrapped__(robot, limits=limits) is forms
    monkeypatch.setattr(module, "DEAR", 0)
    spheres = module.judge.__wrapped__(robot, limits=limits)
    assert spheres.names == forms.names
    assert module.judge_bytes(robot) == 0
    q = np.random.default_rng(1).uniform(-3, 3, (300, len(robot.joints)))
    assert_allclose(spheres.margins(q), forms.margins(q), atol=1e-9 * robot.reach)
    count = len(robot.used)
    assert spheres.margin_rounding[:count].max() < 1e-11 * robot.reach
    assert_array_equal(spheres.margin_rounding[count:], forms.margin_rounding[count:])
    assert_array_equal(spheres.feasible(q), forms.feasible(q))
    assert [bool(spheres.feasible(each)) for each in q[:9]] == forms.feasible(q[:9]).tolist()
    least = np.full(len(forms.names), 0.1 * robot.reach)
    assert_array_equal(spheres.at_least(q, least), forms.at_least(q, least))
    with pytest.raises(ValueError, match="NaN or infinite"):
        spheres.margins(np.full(len(robot.joints), np.nan))


def test_an_arm_of_bodies_is_judged_by_bodies(monkeypatch):
    monkeypatch.setattr(module, "DEAR", 0)
    assert not module.takes_spheres(load_robot("two-links-on-a-table"))
