"""Margins and feasibility: kinematics, exact sums, and every fast way beside the plain one."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cspace import find_region, load_robot
from cspace.boundary import compiled as machine
from cspace.boundary.evaluator import BLOCK, Evaluator, compiled, evaluator
from cspace.boundary.functions import clearance, margin_of
from cspace.boundary.screen import BELOW, CERTAIN, SINES, TURNS, WIDTH, binding
from cspace.model.robot import Robot
from cspace.model.robotfile import parse_robot
from cspace.region import clearance_problem
from engine_support.arms import three_joints
from engine_support.robots import kept_by_kinematics, random_robot
from qbound.boundary import position, squared_distance
from qbound.forms import HarmonicForm

PACKAGED = ("minervabot-v2", "rp-telescopic-boom", "two-joint-arm-with-walls", "pp-portal")
ROBOTS = [*map(random_robot, range(12)), three_joints(), *map(load_robot, PACKAGED)]
MINERVA, UR5 = load_robot("minervabot-v2"), load_robot("ur5")
by_name = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


def anywhere(robot: Robot, count: int, seed: int = 3) -> np.ndarray:
    """Configurations within the limits, a little outside, and at the ends."""
    ends = np.array([joint.limits or (-7.0, 7.0) for joint in robot.joints])
    rng = np.random.default_rng(seed)
    q = rng.uniform(*(1.1 * ends).T, (count, len(ends)))
    return np.where(rng.random(q.shape) < 0.05, ends[:, 1], q)


def between(differ, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Configurations beside the place between a and b where an answer changes."""
    here = differ(a)
    for _ in range(60):
        middle = (a + b) / 2
        same = (differ(middle) == here)[:, None]
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    beside = [np.nextafter(a, 9), np.nextafter(np.nextafter(a, -9), -9), a + 1e-12, a - 1e-7]
    return np.concatenate([a, b, b - 1e-9, *beside])


def crowd(table: Evaluator, q: np.ndarray) -> np.ndarray:
    """Configurations anywhere, and beside the ends of every row along each joint's line."""
    settled = table.settled(q)
    inside = q[settled][:12]
    found = [q]
    for joint in range(table.joints):
        line = np.repeat(inside, 201, axis=0).reshape(-1, 201, table.joints)
        line[:, :, joint] = np.linspace(q[:, joint].min(), q[:, joint].max(), 201)
        line = line.reshape(-1, table.joints)
        negative = table.table @ table.monomials.of_columns(line.T.copy()) < 0
        row, at = np.nonzero(negative[:, 1:] != negative[:, :-1])
        chosen = np.random.default_rng(5).permutation(len(row))[:300]
        rows = table.table[row[chosen]]

        def signs(q, rows=rows):
            return np.einsum("km,mk->k", rows, table.monomials.of_columns(q.T.copy())) < 0

        found.append(between(signs, line[at[chosen]], line[at[chosen] + 1]))
    apart = np.concatenate([q[:600], q[600:1200]]).reshape(2, -1, table.joints)
    apart = apart[:, table.settled(apart[0]) != table.settled(apart[1])]
    return np.concatenate([*found, between(table.settled, *apart)])


def by_kinematics(robot: Robot, q: np.ndarray) -> dict[str, np.ndarray]:
    """Distances of the points themselves, less what is to be kept; depths inside the limits."""
    found = kept_by_kinematics(robot, q)
    for j, joint in enumerate(robot.joints):
        if joint.limits is not None:
            found[f"{joint.name}.lower"] = q[..., j] - joint.limits[0]
            found[f"{joint.name}.upper"] = joint.limits[1] - q[..., j]
    return found


def by_rows(table: Evaluator, q: np.ndarray) -> np.ndarray:
    """The sign of every row, summed term by term without rounding: it shares no code."""
    functions = {("revolute", 1): math.cos, ("revolute", 2): math.sin, ("prismatic", 1): float}
    answers = []
    for one in q.tolist():
        terms = [1.0]
        for joint, which in table.monomials.factors:
            terms.append(functions.get(which, lambda x: x * x)(one[joint]))
        for i, j in table.monomials.products:
            terms.append(terms[i] * terms[j])
        sums = [math.fsum(map(math.prod, zip(row, terms, strict=True))) for row in table.table]
        answers.append(all(s >= -r for s, r in zip(sums, table.rounding, strict=True)))
    return np.array(answers)


# --- against kinematics and exact sums ------------------------------------------------------------


@by_name
def test_margins_are_those_of_forward_kinematics(robot) -> None:
    q, table = anywhere(robot, 300), evaluator(robot)
    expected = by_kinematics(robot, q)
    assert list(expected) == list(table.names)
    for b in (b for b in robot.boundaries if b.used):
        found = margin_of(robot, b, clearance(robot, b)(q))
        assert_allclose(found, expected[b.name], atol=1e-7, err_msg=b.name)
    for found, name in zip(table.margins(q).T, table.names, strict=True):
        assert_allclose(found, expected[name], atol=1e-7, err_msg=name)  # a root near distance 0
    place = position(robot, robot.tool)(q)
    for centre in (None, np.array([0.3, -0.2, 1.1])):
        there = squared_distance(
            robot, robot.tool, **({} if centre is None else {"centre": centre})
        )
        away = place if centre is None else place - centre
        assert_allclose(there(q), (away**2).sum(axis=-1), rtol=1e-9, atol=1e-9)


@by_name
def test_feasible_is_the_sign_of_exact_sums_and_of_margins(robot) -> None:
    q, table = anywhere(robot, 600), evaluator(robot)
    assert_array_equal(table.feasible(q), by_rows(table, q))
    margins = table.margins(q)
    clear = np.abs(margins).min(axis=-1, initial=np.inf) > 1e-9
    assert_array_equal(table.feasible(q)[clear], (margins >= 0).all(axis=-1)[clear])


# --- every way to ask -----------------------------------------------------------------------------


def machine_code() -> bool:
    try:
        return bool(machine.machine())
    except ModuleNotFoundError:
        return False


def ways(robot: Robot):
    """Yield every function that tells where a robot is feasible."""
    yield evaluator(robot).feasible
    if machine_code():
        for threads in (1, 2):
            yield machine.compiled_feasible(robot, threads=threads)


@pytest.mark.parametrize("robot", [*ROBOTS, UR5], ids=lambda robot: robot.name)
def test_at_the_ends_of_arcs_answers_are_those_of_double_precision(robot, monkeypatch) -> None:
    """Of every way to ask, beside every root of every form, by an ulp and by more."""
    monkeypatch.setattr("cspace.boundary.compiled.SHARE", 700)
    table = evaluator(robot)
    q = crowd(table, anywhere(robot, 3000))
    answers = table.settled(q)
    assert_array_equal(table.settled(q[::7]), answers[::7])  # whoever is asked beside it
    some = np.r_[0:40, len(q) - 400 : len(q)]
    for feasible in ways(robot):
        assert_array_equal(feasible(q), answers)
        assert_array_equal([feasible(one) for one in q[some]], answers[some])
        assert_array_equal(feasible(np.asfortranarray(q)), answers)
        assert_array_equal(feasible(np.repeat(q, 2, axis=0)[::2]), answers)
        assert_array_equal(feasible(q[:12].tolist()), answers[:12])


@pytest.mark.parametrize("robot", [*ROBOTS[11:14], load_robot("minervabot-v2-bodies")], ids=str)
def test_a_batch_of_any_shape_is_one_configuration_after_the_other(robot) -> None:
    q, table = (
        anywhere(robot, 2 * (BLOCK // 2 + 3)).reshape(2, -1, len(robot.joints)),
        evaluator(robot),
    )
    margins, feasible = table.margins(q), table.feasible(q)
    assert margins.shape == (*q.shape[:-1], len(table.names))
    for ask in ways(robot):
        assert_array_equal(ask(q), feasible)
        for place in ((0, 0), (0, 17), *((1, BLOCK // 2 + k) for k in (-4, -3, 2))):
            assert_allclose(margins[place], table.margins(q[place]), atol=1e-9)
            assert feasible[place] == ask(q[place])
    assert 0 < feasible.sum() < feasible.size


@pytest.mark.parametrize("shape", [(0, 2), (0, 3, 2), (2, 0, 2), (300, 2, 2), (1000, 2), (2,)])
def test_answers_have_the_shape_of_what_was_asked(shape) -> None:
    for ask in ways(replace(MINERVA, boundaries=())):
        assert ask(np.zeros(shape)).shape == shape[:-1]
        assert ask(np.zeros(shape)).all()


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("count", [1, 5, 3000])
def test_nan_is_refused_wherever_it_stands(value, count) -> None:
    for ask in ways(MINERVA):
        for place, joint in np.ndindex(3, 2):
            q = anywhere(MINERVA, count)
            q[place * (count - 1) // 2, joint] = value
            for asked in (q, q[place * (count - 1) // 2]):
                with pytest.raises(ValueError, match="NaN or infinite"):
                    ask(asked)


@pytest.mark.parametrize("q", [0.5, [0.5], [0.1, 0.2, 0.3], [[0.1], [0.2]]])
def test_another_number_of_joint_values_is_refused_by_all(q) -> None:
    for ask in (*ways(MINERVA), evaluator(MINERVA).margins):
        with pytest.raises(ValueError, match="expected 2 joint values on the last axis, found"):
            ask(q)


# --- single precision -----------------------------------------------------------------------------


@pytest.mark.parametrize("sines", [SINES, machine.SINES])
@by_name
def test_the_error_of_single_precision_is_below_its_bound(robot, sines, monkeypatch) -> None:
    monkeypatch.setattr("cspace.boundary.screen.binding", lambda table, *_: [True] * len(table))
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
    table = evaluator(MINERVA)
    q = np.random.default_rng(2).uniform(-1, 1, (4000, 2)) * np.array([2 * TURNS, 1e9])
    assert_array_equal(table.feasible(q), table.settled(q))
    assert table.screen().judge(np.array([[TURNS * 1.01, 0.0]]))[1].all()


@pytest.mark.parametrize("scale", [1e-162, 1e-160, 1e-157, 1e-30, 1e-8, 1e30])
def test_lengths_of_any_unit_are_judged(scale) -> None:
    """Beyond single precision, and where squares underflow, double precision decides."""
    forms = np.random.default_rng(8).normal(size=(3, 3, 3)) * (scale**2 if scale < 1 else scale)
    table = compiled(
        HarmonicForm(forms, ("revolute", "revolute")), [*"abc"], [None] * 3, [None] * 2, []
    )
    q = np.random.default_rng(9).uniform(-3, 3, (2000, 2))
    settled = table.settled(q)
    assert_array_equal(table.feasible(q), settled)
    assert_array_equal([table.feasible(one) for one in q[:300]], settled[:300])
    if scale < 1e-100:
        return
    forms = HarmonicForm(np.array([[1.0, -2.0 / scale, 0.5 / scale**2]]), ("prismatic",))
    table = compiled(forms, ["a"], [None], [(0.0, 4 * scale)], [("lower", "upper")])
    assert (table.screen() is None) == (scale != 1e-8)
    x = np.linspace(-1, 5, 1000)
    wanted = (x >= 0) & (x <= 4) & (1 - 2 * x + 0.5 * x * x >= 0)
    assert_array_equal(table.feasible(x[:, None] * scale), wanted)


@pytest.mark.parametrize("limits", [None, (-2.0, 1.5), (-0.3, 0.2), (-7.0, 7.0), (2.5, 4.5)])
@pytest.mark.parametrize("seed", range(24))
def test_rows_are_left_out_only_where_others_decide_and_few_are_left(seed, limits) -> None:
    """Forms of a joint, negative on an arc each: short, long, equal, and some that nearly meet."""
    rng = np.random.default_rng(seed)
    count = 3 + 3 * seed
    middle, half = rng.uniform(-np.pi, np.pi, count), rng.uniform(0.02, 1.6, count)
    gaps = 10.0 ** rng.uniform(-5, -2, count // 3) * rng.choice([-1, 1], count // 3)
    k = np.arange(count // 3)
    middle[3 * k + 1] = middle[3 * k] + half[3 * k] + half[3 * k + 1] + gaps  # end near an end
    middle[3 * k + 2], half[3 * k + 2] = middle[3 * k] + half[3 * k], 0.02  # over that place
    rows = np.stack([np.cos(half), -np.cos(middle), -np.sin(middle)], axis=1)
    rows = np.concatenate([rows, rows[:1], [[3.0, 1.0, 0.0]]])  # one twice, one always positive
    ends = [("low", "high")] * bool(limits)
    names = [f"B{i}" for i in range(len(rows))]
    table = compiled(HarmonicForm(rows, ("revolute",)), names, [None] * len(rows), [limits], ends)
    far = 7.0 if limits is None else table.reach[0]
    q = crowd(table, np.linspace(-far, far, 40_001)[:, None])
    free, kept = table.settled(q), table.screen()
    assert_array_equal(table.feasible(q), free)
    scaled = 1e6 * table._lifted
    asked = binding(scaled, table.monomials, table.reach)
    values = scaled @ table.monomials.of_columns(q.T.copy())
    others = (values[asked] >= BELOW).all(axis=0)
    assert (values[~asked][:, others] >= CERTAIN).all()
    feasible, near = kept.judge(q)
    assert_array_equal(feasible[~near], free[~near])
    turn = table.settled(np.linspace(-np.pi, np.pi, 40_001)[:, None])
    changes = np.count_nonzero(turn[1:] != turn[:-1])
    assert 1 <= len(kept.table) <= 2 * bool(limits) + max(3, changes + 1 + len(k))


def test_an_arc_within_an_equal_one_stays_within_what_single_precision_can_tell() -> None:
    """Three units of a millionth here, at a slope of a half."""
    for inset, stays in ((4e-6, True), (1e-5, False)):
        arcs = np.array([(0, 1), (inset, 1 - inset)])
        middle, half = arcs.mean(axis=1), np.ptp(arcs, axis=1) / 2
        rows = np.stack([np.cos(half), -np.cos(middle), -np.sin(middle)], axis=1)
        table = compiled(HarmonicForm(rows, ("revolute",)), ["a", "b"], [None] * 2, [None], [])
        asked = binding(1e6 * table._lifted, table.monomials, table.reach)
        assert asked.tolist() == [True, stays]


def test_an_arm_is_asked_half_as_much() -> None:
    assert len(evaluator(UR5).screen().table) < len(evaluator(UR5).table) / 2


# --- ties that only rounding breaks ---------------------------------------------------------------

TIE = """
schema = 1
name = "a tie"
length_unit = "m"
angle_unit = "deg"
home = { a = 10, b = 20 }
tool = "tip"
joint = [
  { name = "a", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 0, 1] },
  { name = "b", type = "revolute", parent = "1", frame = "2", origin = [1, 0, 0], axis = [0, 0, 1] },
]
"""  # noqa: E501
POINTS = """
point = [
  {{ name = "post", frame = "0", at = [0, 0, {low}], radius = {a} }},
  {{ name = "tip", frame = "1", at = [0, 0, {high}], radius = {b} }},
]
boundary = [
  {{ name = "pair", type = "pair", points = ["post", "tip"] }},
  {{ name = "floor", type = "half-space", point = "tip", normal = [0, 0, 1], offset = {level} }},
]
"""
BODIES = """
point = [{{ name = "tip", frame = "1", at = [0, 0, 0] }}]
body = [{{ name = "hub", frame = "1", disc = {{ at = [0, 0], radius = {a} }} }}]
obstacle = [{{ name = "ring", disc = {{ at = [{c}, 0], radius = {b} }} }}]
boundary = [{{ name = "bodies", type = "bodies", bodies = ["hub", "ring"] }}]
"""


@pytest.mark.parametrize("tenths", [0, 77, -1003], ids="from {} tenths".format)
def test_points_that_touch_everywhere_in_decimals_touch_in_floats(tenths) -> None:
    """Radii a and b at the distance a + b, all one-digit decimals: 0.3^2 - (0.1 + 0.2)^2 < 0.

    The coordinates may be far larger than the distance: their rounding is in it, too.
    """
    low, broken = tenths / 10, 0
    for a, b in np.ndindex(9, 9):
        one, other = (a + 1) / 10, (b + 1) / 10
        high, level = (tenths + a + b + 2) / 10, (tenths + a + 1) / 10
        text = POINTS.format(low=low, high=high, a=one, b=other, level=level)
        robot = parse_robot(tomllib.loads(TIE + text))
        broken += float(evaluator(robot).table[0, 0]) < 0
        for table in (evaluator(robot), clearance_problem(robot).evaluator):
            margins = table.margins([0.3, 0.4])
            assert margins.min() >= 0
            assert margins.max() <= 1e-12 * (1 + abs(low)) ** 2 / (one + other)
            assert table.feasible([0.3, 0.4])
        assert clearance_problem(robot).constants == {0: 0.0, 1: 0.0}
    assert broken  # by rounding some forms are negative


def test_bodies_that_touch_everywhere_in_decimals_touch_in_floats() -> None:
    for a, b in np.ndindex(9, 9):
        text = BODIES.format(a=(a + 1) / 10, b=(b + 1) / 10, c=(a + b + 2) / 10)
        robot = parse_robot(tomllib.loads(TIE + text))
        assert 0 <= evaluator(robot).margins([0.3, 0.4])[0] <= 1e-15
        assert evaluator(robot).feasible([0.3, 0.4])


def test_points_that_overlap_by_more_than_rounding_do_not_touch() -> None:
    for low, by in ((0.0, 1e-12), (-100.3, 1e-9)):
        text = POINTS.format(low=low, high=low + 0.3 - by, a=0.1, b=0.2, level=low + 0.1)
        robot = parse_robot(tomllib.loads(TIE + text))
        assert not find_region(robot).contains([0.3, 0.4])
        assert evaluator(robot).margins([0.3, 0.4])[0] == pytest.approx(-by, rel=1e-3)


# --- machine code ---------------------------------------------------------------------------------


def test_machine_code_is_the_program_read_as_python_and_its_sines_keep_their_bound() -> None:
    pytest.importorskip("numba")
    with pytest.raises(ValueError, match="threads: 0"):
        machine.compiled_feasible(MINERVA, threads=0)
    robot = three_joints()
    program, q = machine.program(evaluator(robot).screen(machine.SINES)), anywhere(robot, 40)
    found = []
    for run in (machine.machine()[0], machine.judge):
        safe, near = np.zeros(len(q), np.bool_), np.zeros(len(q), np.int64)
        count = run(q.reshape(-1), *program, safe, near)
        found.append((safe.tolist(), near[:count].tolist()))
    assert found[0] == found[1]
    for run in (machine.machine()[1], machine.judge_one):
        assert [run(each, *program) == 1 for each in q] == found[0][0]
    x = np.random.default_rng(0).uniform(-TURNS, TURNS, 300)
    x = np.concatenate([x, np.pi * np.arange(-20, 21) / 2]).astype(np.float32)
    cosine, sine = np.transpose([machine._cos_sin(value) for value in x])
    exact = np.cos(x.astype(float)), np.sin(x.astype(float))
    assert np.abs([cosine - exact[0], sine - exact[1]]).max() < machine.SINES * 2.0**-24 / 2
