"""Feasibility of many: single precision decides what it may, and machine code answers alike."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from qbound import load_robot
from qbound.boundary import compiled as machine
from qbound.boundary.evaluator import COUNT_SCREENED, Evaluator, compiled, evaluator
from qbound.boundary.screen import SINES, TURNS, WIDTH
from qbound.forms.harmonic import HarmonicForm
from qbound.sampling import keeps_clear
from support.arms import three_joints
from support.robots import random_robot

PACKAGED = ("minervabot-v2", "rp-telescopic-boom", "two-joint-arm-with-walls", "pp-portal")
ROBOTS = [*map(random_robot, range(8)), three_joints(), *map(load_robot, PACKAGED)]
BODIES = "minervabot-v2-bodies"
by_name = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


def anywhere(robot, count: int, seed: int = 3) -> np.ndarray:
    """Configurations within the limits, a little outside, and at the ends."""
    ends = np.array([joint.limits or (-7.0, 7.0) for joint in robot.joints])
    rng = np.random.default_rng(seed)
    q = rng.uniform(*(1.1 * ends).T, (count, len(ends)))
    at_end = rng.random(q.shape) < 0.05
    return np.where(at_end, ends[:, 1], q)


def by_rows(table: Evaluator, q: np.ndarray) -> np.ndarray:
    """The sign of every row, summed term by term without rounding: it shares no code."""
    functions = {("revolute", 1): math.cos, ("revolute", 2): math.sin, ("prismatic", 1): float}
    answers = []
    for one in q.tolist():
        terms = [1.0]
        for joint, which in table.monomials.factors:
            terms.append(functions.get(which, lambda x: x * x)(one[joint]))
        terms += [0.0] * len(table.monomials.products)
        for k, (i, j) in enumerate(table.monomials.products, 1 + len(table.monomials.factors)):
            terms[k] = terms[i] * terms[j]
        sums = [math.fsum(map(math.prod, zip(row, terms, strict=True))) for row in table.table]
        answers.append(all(s >= -r for s, r in zip(sums, table.rounding, strict=True)))
    return np.array(answers)


def near_boundaries(table: Evaluator, q: np.ndarray) -> np.ndarray:
    """Configurations between a feasible one and another: neighbours in double precision."""
    inside, outside = q[: len(q) // 2], q[len(q) // 2 :][: len(q) // 2]
    apart = table.settled(inside) != table.settled(outside)
    a, b = inside[apart], outside[apart]
    here = table.settled(a)
    for _ in range(60):
        middle = (a + b) / 2
        same = (table.settled(middle) == here)[:, None]
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    beside = [np.nextafter(a, 9), np.nextafter(np.nextafter(a, -9), -9), a + 1e-12, a - 1e-7]
    return np.concatenate([a, b, *beside])


def crowd(robot) -> np.ndarray:
    q = anywhere(robot, 3000)
    return np.concatenate([q, near_boundaries(evaluator(robot), q[:1200])])


# --- single precision -----------------------------------------------------------------------------


@by_name
def test_what_single_precision_decides_is_the_sign_of_exact_sums(robot) -> None:
    q, table = anywhere(robot, 600), evaluator(robot)
    assert_array_equal(table.feasible(q), by_rows(table, q))


@by_name
def test_many_are_answered_as_in_double_precision_and_as_one_by_one(robot) -> None:
    q, table = crowd(robot), evaluator(robot)
    answers = table.settled(q)
    assert len(q) > COUNT_SCREENED
    assert_array_equal(table.feasible(q), answers)
    some = slice(len(q) - 400, None)
    assert_array_equal([table.feasible(one) for one in q[some]], answers[some])
    assert_array_equal(table.settled(q[::7]), answers[::7])  # whoever is asked beside it


@pytest.mark.parametrize("sines", [SINES, machine.SINES])
@by_name
def test_the_error_of_single_precision_is_below_its_bound(robot, sines, monkeypatch) -> None:
    monkeypatch.setattr("qbound.boundary.screen.binding", lambda table, *_: [True] * len(table))
    table = evaluator(robot)
    screen = table.screen(sines)
    q = np.random.default_rng(1).uniform(-1, 1, (2000, table.joints)) * screen.reach
    single = screen.table @ screen.monomials.of_columns(q.T.astype(np.float32))
    lifted = table.table + np.outer(table.rounding, np.eye(1, len(table.monomials)))
    lifted = lifted[(lifted != 0).any(axis=1)]
    double = lifted @ table.monomials.of_columns(q.T.copy())
    bounds = np.linalg.norm(lifted, axis=1) / np.linalg.norm(screen.table, axis=1)
    assert np.abs(single - double / bounds[:, None]).max(initial=0) < 0.8


@pytest.mark.parametrize("name", PACKAGED)
def test_few_are_too_near_to_say(name) -> None:
    robot = load_robot(name)
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints]).T
    q = np.random.default_rng(2).uniform(*ends, (20 * WIDTH, len(robot.joints)))
    feasible, near = evaluator(robot).screen().judge(q)
    assert near.mean() < 0.005
    assert not (feasible & near).any()


def test_joints_beyond_the_reach_of_single_precision_are_left_to_double() -> None:
    table = evaluator(load_robot("minervabot-v2"))
    q = np.random.default_rng(2).uniform(-1, 1, (4000, 2)) * np.array([2 * TURNS, 1e9])
    assert_array_equal(table.feasible(q), table.settled(q))
    assert table.screen().judge(np.array([[TURNS * 1.01, 0.0]]))[1].all()


@pytest.mark.parametrize("scale", [1e-30, 1e-8, 1e30])
def test_lengths_of_any_unit_are_judged(scale) -> None:
    forms = HarmonicForm(np.array([[1.0, -2.0 / scale, 0.5 / scale**2]]), ("prismatic",))
    ends = (0.0, 4 * scale)
    table = compiled(forms, ["a"], [None], [ends], [("lower", "upper")])
    assert (table.screen() is None) == (scale != 1e-8)
    q = np.linspace(-1, 5, 1000)[:, None] * scale
    x = q[:, 0] / scale
    wanted = (x >= 0) & (x <= 4) & (1 - 2 * x + 0.5 * x * x >= 0)
    assert_array_equal(table.feasible(q), wanted)


@pytest.mark.parametrize("scale", [1e-157, 1e-160, 1e-162])
def test_where_squares_of_lengths_underflow_double_precision_decides(scale) -> None:
    forms = HarmonicForm(
        scale**2 * np.random.default_rng(8).normal(size=(3, 3, 3)), ("revolute", "revolute")
    )
    names = ["a", "b", "c"]
    table = compiled(forms, names, [None] * 3, [None] * 2, [("", "")] * 2)
    q = np.random.default_rng(9).uniform(-3, 3, (2000, 2))
    settled = table.settled(q)
    assert_array_equal(table.feasible(q), settled)
    assert_array_equal([table.feasible(one) for one in q[:300]], settled[:300])


# --- what is no configuration ---------------------------------------------------------------------


def ways(robot):
    yield evaluator(robot).feasible
    if machine_code():
        yield lambda q: keeps_clear(robot, q, compiled=True)


def machine_code() -> bool:
    try:
        machine.machine()
    except ModuleNotFoundError:
        return False
    return True


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("count", [1, 5, 3000])
def test_nan_is_refused_wherever_it_stands(value, count) -> None:
    robot = load_robot("minervabot-v2")
    for ask in ways(robot):
        for place in {0, count // 2, count - 1}:
            for joint in (0, 1):
                q = anywhere(robot, count)
                q[place, joint] = value
                with pytest.raises(ValueError, match="NaN or infinite"):
                    ask(q)
                with pytest.raises(ValueError, match="NaN or infinite"):
                    ask(q[place])


@pytest.mark.parametrize("q", [0.5, [0.5], [0.1, 0.2, 0.3], [[0.1], [0.2]]])
def test_another_number_of_joint_values_is_refused_by_all(q) -> None:
    robot = load_robot("minervabot-v2")
    for ask in (*ways(robot), evaluator(robot).margins):
        with pytest.raises(ValueError, match="expected 2 joint values on the last axis, found"):
            ask(q)


@pytest.mark.parametrize("shape", [(0, 2), (0, 3, 2), (2, 0, 2), (300, 2, 2)])
def test_answers_have_the_shape_of_what_was_asked(shape) -> None:
    for ask in ways(load_robot("minervabot-v2")):
        assert ask(np.zeros(shape)).shape == shape[:-1]


def test_a_robot_without_boundaries_is_feasible_everywhere() -> None:
    robot = replace(load_robot("minervabot-v2"), boundaries=())
    for ask in ways(robot):
        assert ask(np.zeros((1000, 2))).all()
        assert ask([0.1, 0.2])


# --- machine code ---------------------------------------------------------------------------------


@pytest.fixture
def compile_it():
    pytest.importorskip("numba")
    from qbound.boundary.compiled import compiled_feasible

    return compiled_feasible


@by_name
def test_machine_code_answers_as_numpy(robot, compile_it) -> None:
    q, feasible = crowd(robot), compile_it(robot)
    answers = evaluator(robot).settled(q)
    assert_array_equal(feasible(q), answers)
    some = slice(len(q) - 400, None)
    assert_array_equal([feasible(one) for one in q[some]], answers[some])


def test_threads_and_any_memory_answer_alike(compile_it, monkeypatch) -> None:
    monkeypatch.setattr("qbound.boundary.compiled.SHARE", 700)
    robot = load_robot("minervabot-v2")
    q = crowd(robot)
    answers, two = evaluator(robot).feasible(q), compile_it(robot, threads=2)
    assert_array_equal(two(q), answers)
    assert_array_equal(two(np.asfortranarray(q)), answers)
    assert_array_equal(two(np.repeat(q, 2, axis=0)[::2]), answers)
    assert_array_equal(two(q[:12].tolist()), answers[:12])
    q[-5, 1] = math.nan
    with pytest.raises(ValueError, match="NaN"):
        two(q)
    with pytest.raises(ValueError, match="threads: 0"):
        compile_it(robot, threads=0)


def test_bodies_are_told_apart_in_machine_code_too(compile_it) -> None:
    robot = load_robot(BODIES)
    q = anywhere(robot, 500)
    answers = evaluator(robot).feasible(q)
    assert 0 < answers.sum() < len(q)
    assert_array_equal(compile_it(robot)(q), answers)
    assert compile_it(robot)(q[3]) == answers[3]


def test_the_program_read_as_python_is_the_program_compiled(compile_it) -> None:
    robot = three_joints()
    screen = evaluator(robot).screen(machine.SINES)
    q, (judge, judge_one) = anywhere(robot, 40), machine.machine()
    found = []
    for run in (judge, machine.judge):
        safe, near = np.zeros(len(q), np.bool_), np.zeros(len(q), np.int64)
        count = run(q.reshape(-1), *machine.program(screen), safe, near)
        found.append((safe.tolist(), near[:count].tolist()))
    assert found[0] == found[1]
    for run in (judge_one, machine.judge_one):
        one = [run(each, *machine.program(screen)) for each in q]
        assert [x == 1 for x in one] == found[0][0]


def test_sines_of_machine_code_are_within_their_bound() -> None:
    x = np.concatenate(
        [np.random.default_rng(0).uniform(-TURNS, TURNS, 300), np.pi * np.arange(-20, 21) / 2]
    ).astype(np.float32)
    cosine, sine = np.transpose([machine._cos_sin(value) for value in x])
    exact = np.cos(x.astype(float)), np.sin(x.astype(float))
    assert np.abs([cosine - exact[0], sine - exact[1]]).max() < machine.SINES * 2.0**-24 / 2
