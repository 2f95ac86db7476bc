"""The compiled boundaries of a robot: margins of one configuration, of many, by kinematics."""

import math
import tomllib

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from qbound import load_robot
from qbound.boundary.evaluator import BLOCK, Evaluator, compiled, evaluator
from qbound.boundary.functions import clearance, margin_of, position, squared_distance
from qbound.boundary.screen import BELOW, CERTAIN, _covered, binding, screen
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import HalfSpace, Robot
from qbound.model.robotfile import parse_robot
from qbound.region import clearance_problem, find_region
from support.arms import three_joints
from support.robots import random_robot

ROBOTS = [*map(random_robot, range(12)), three_joints(), load_robot("minervabot-v2")]


def configurations(robot: Robot, *shape: int) -> np.ndarray:
    ends = np.array([joint.limits or (-4.0, 4.0) for joint in robot.joints])
    return np.random.default_rng(5).uniform(*(ends.T * 1.2), size=(*shape, len(ends)))


def by_kinematics(robot: Robot, q: np.ndarray) -> dict[str, np.ndarray]:
    """Distances of the points themselves, less what is to be kept; depths inside the limits."""
    frames, found = robot.frames(q), {}
    for b in (b for b in robot.boundaries if b.used):
        names = (b.point,) if isinstance(b, HalfSpace) else b.points
        places = [frames.position(robot.base, p, robot.base) for p in names]
        radii = sum(robot.point(p).radius for p in names)
        if isinstance(b, HalfSpace):
            found[b.name] = places[0] @ b.normal - b.offset - radii
        else:
            apart = np.linalg.norm(places[1] - places[0], axis=-1)
            found[b.name] = apart - radii - b.clearance
    for j, joint in enumerate(robot.joints):
        if joint.limits is not None:
            found[f"{joint.name}.lower"] = q[..., j] - joint.limits[0]
            found[f"{joint.name}.upper"] = joint.limits[1] - q[..., j]
    return found


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_margins_are_those_of_forward_kinematics(robot) -> None:
    q, compiled = configurations(robot, 300), evaluator(robot)
    expected = by_kinematics(robot, q)
    assert list(expected) == list(compiled.names)
    for b in (b for b in robot.boundaries if b.used):
        found = margin_of(robot, b, clearance(robot, b)(q))
        assert_allclose(found, expected[b.name], atol=1e-7, err_msg=b.name)
    for found, name in zip(compiled.margins(q).T, compiled.names, strict=True):
        assert_allclose(found, expected[name], atol=1e-7, err_msg=name)  # a root near distance 0


@pytest.mark.parametrize("robot", ROBOTS[-3:], ids=lambda robot: robot.name)
def test_a_batch_of_any_shape_is_one_configuration_after_the_other(robot) -> None:
    q, compiled = configurations(robot, 2, BLOCK // 2 + 3), evaluator(robot)
    margins, feasible = compiled.margins(q), compiled.feasible(q)
    assert margins.shape == (*q.shape[:-1], len(compiled.names))
    assert_array_equal(feasible.shape, q.shape[:-1])
    for place in ((0, 0), (0, 17), (1, BLOCK // 2 - 4), (1, BLOCK // 2 - 3), (1, BLOCK // 2 + 2)):
        assert_allclose(margins[place], compiled.margins(q[place]), atol=1e-9)
        assert feasible[place] == compiled.feasible(q[place])
    clear = np.abs(margins).min(axis=-1, initial=np.inf) > 1e-9
    assert_array_equal(feasible[clear], (margins >= 0).all(axis=-1)[clear])


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_a_squared_distance_is_from_the_base_unless_a_centre_is_given(robot) -> None:
    q, tool = configurations(robot, 50), robot.tool
    place = position(robot, tool)(q)
    for centre in (np.zeros(3), np.array([0.3, -0.2, 1.1])):
        there = squared_distance(robot, tool, centre=centre)(q)
        assert_allclose(there, ((place - centre) ** 2).sum(axis=-1), rtol=1e-9, atol=1e-9)
    assert_allclose(squared_distance(robot, tool)(q), (place**2).sum(axis=-1), rtol=1e-9, atol=1e-9)


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


# --- rows that never decide -----------------------------------------------------------------------


FULL_TURN = np.linspace(-np.pi, np.pi, 20_001)[:, None]


def of_one_joint(
    seed: int, count: int, limits: tuple[float, float] | None, size: float = 1.0
) -> Evaluator:
    """Forms of a turning joint, negative on an arc each, some short and some long."""
    rng = np.random.default_rng(seed)
    turn, open_to = rng.uniform(-np.pi, np.pi, count), rng.uniform(-1.1, 1.0, count)
    rows = size * np.stack([-open_to, np.cos(turn), np.sin(turn)], axis=1)
    names = [f"B{k}" for k in range(count)]
    ends = ("low", "high")
    return compiled(
        HarmonicForm(rows, ("revolute",)), names, [None] * count, [limits], [ends] * bool(limits)
    )


@pytest.mark.parametrize("limits", [None, (-2.0, 1.5), (-0.3, 0.2), (-7.0, 7.0), (2.5, 4.5)])
@pytest.mark.parametrize("seed", range(12))
def test_a_row_is_left_out_only_where_others_decide(
    seed: int, limits: tuple[float, float] | None
) -> None:
    table = of_one_joint(seed, 3 + 2 * seed, limits)
    scaled = 1e6 * table._lifted
    asked = binding(scaled, table.monomials, table.reach)
    q = FULL_TURN if limits is None else np.linspace(-1, 1, 20_001)[:, None] * table.reach[0]
    values = scaled @ table.monomials.of_columns(q.T.copy())
    others = (values[asked] >= BELOW).all(axis=0)
    assert (values[~asked][:, others] >= CERTAIN).all()
    if limits:
        assert asked[-2:].all()  # a limit is never left out


def asked_of_arcs(*arcs: tuple[float, float], limits: tuple[float, float] | None = None) -> list:
    """Which of some forms are asked, each negative on one arc."""
    rows = [
        [math.cos((b - a) / 2), -math.cos((a + b) / 2), -math.sin((a + b) / 2)] for a, b in arcs
    ]
    forms = HarmonicForm(np.array(rows), ("revolute",))
    names, ends = [f"B{k}" for k in range(len(arcs))], [("low", "high")] * bool(limits)
    table = compiled(forms, names, [None] * len(arcs), [limits], ends)
    asked = binding(1e6 * table._lifted, table.monomials, table.reach)
    return asked[: len(arcs)].tolist()


@pytest.mark.parametrize("gap", [1e-3, 1e-4, 2e-5])
@pytest.mark.parametrize("turn", [0.0, 2.0, -3.0])
def test_an_arc_is_left_out_where_others_meet_within_it_and_not_where_they_leave_a_gap(
    gap: float, turn: float
) -> None:
    for sign in (1, -1):
        arcs = [(0, 1), (1 + sign * gap, 2), (0.5, 1.5)]
        arcs = [(a + turn, b + turn) for a, b in arcs]
        assert asked_of_arcs(*arcs) == [True, True, sign > 0]
        beside = asked_of_arcs((0.5, 1 - sign * gap), (0.9, 1.1), limits=(-1, 1))
        assert beside == [True, sign > 0]
        below = asked_of_arcs((-1 + sign * gap, -0.5), (-1.1, -0.9), limits=(-1, 1))
        assert below == [True, sign > 0]


def test_an_arc_within_an_equal_one_stays_within_what_single_precision_can_tell() -> None:
    """Three units of a millionth here, at a slope of a half."""
    assert asked_of_arcs((0, 1), (4e-6, 1 - 4e-6)) == [True, True]
    assert asked_of_arcs((0, 1), (1e-5, 1 - 1e-5)) == [True, False]


@pytest.mark.parametrize("seed", range(4))
def test_of_many_forms_of_one_joint_few_are_left(seed: int) -> None:
    table = of_one_joint(seed, 60, None)
    kept = screen(table._lifted, table.monomials, table.reach)
    assert kept is not None
    free = table.settled(FULL_TURN)
    ends = np.count_nonzero(free[1:] != free[:-1])
    assert 1 <= len(kept.table) <= max(3, ends + 1)  # an end is that of a row; or three cover all
    feasible, near = kept.judge(FULL_TURN)
    assert_array_equal(feasible[~near], free[~near])
    assert near.mean() < 0.01


def test_the_last_of_equal_rows_stays() -> None:
    forms = HarmonicForm(np.array([[-0.5, 1.0, 0.0]] * 3), ("revolute",))
    table = compiled(forms, ["a", "b", "c"], [None] * 3, [None], [])
    assert binding(1e6 * table._lifted, table.monomials, table.reach).any()
    assert table.feasible(np.zeros((1000, 1))).all()
    assert not table.feasible(np.full((1000, 1), 2.0)).any()


def test_what_is_positive_everywhere_is_not_asked() -> None:
    """In one joint and in two; what is only just so is."""
    rows = np.zeros((3, 3, 3))
    rows[:, 0, 0], rows[:, 1, 0] = [3.0, 3.0, 1.0], 1.0
    rows[1, 1, 1] = 1.0
    forms = HarmonicForm(rows, ("revolute", "revolute"))
    table = compiled(forms, ["a", "b", "c"], [None] * 3, [None] * 2, [])
    asked = binding(1e6 * table._lifted, table.monomials, table.reach)
    assert asked.tolist() == [False, False, True]


def test_an_arm_is_asked_half_as_much() -> None:
    table = evaluator(load_robot("ur5"))
    kept = table.screen()
    assert kept is not None
    assert len(kept.table) < len(table.table) / 2


def test_at_the_ends_of_arcs_answers_are_those_of_double_precision() -> None:
    """Beside every root of every form, left out or not, by an ulp and by more."""
    robot = load_robot("ur5")
    table = evaluator(robot)
    rng = np.random.default_rng(5)
    low, high = np.array([joint.limits for joint in robot.joints]).T
    inside = rng.uniform(low, high, (400, len(low)))
    inside = inside[table.settled(inside)]
    every = []
    for joint in range(len(low)):
        q = np.repeat(inside[:20], 201, axis=0).reshape(-1, 201, len(low))
        q[:, :, joint] = np.linspace(low[joint], high[joint], 201)
        every.append(q.reshape(-1, len(low)))
    q = np.concatenate(every)
    assert_array_equal(table.feasible(q), table.settled(q))
    rows = table.table @ table.monomials.of_columns(q.T.copy())
    row, place = np.nonzero((rows[:, 1:] < 0) != (rows[:, :-1] < 0))
    chosen = rng.permutation(len(row))[:3000]
    a, b = q[place[chosen]], q[place[chosen] + 1]
    of_row = table.table[row[chosen]]
    for _ in range(60):
        middle = (a + b) / 2
        same = (signs(table, of_row, middle) == signs(table, of_row, a))[:, None]
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    for beside in (a, b, a + 1e-12, b - 1e-9, a + 1e-7):
        assert_array_equal(table.feasible(beside), table.settled(beside))


def signs(table: Evaluator, rows: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Whether row k is negative at configuration k."""
    values = table.monomials.of_columns(q.T.copy())
    return np.asarray(np.einsum("km,mk->k", rows, values) < 0)


@pytest.mark.parametrize("seed", range(5))
def test_an_arc_is_covered_where_each_place_of_it_lies_in_another(seed: int) -> None:
    # Of so many some end where rounding leaves the next step less than the last digit of the way.
    rng = np.random.default_rng(seed)
    for _ in range(400):
        count = rng.integers(1, 6)
        starts, lengths = rng.uniform(-6, 3, count), rng.uniform(0, 4, count)
        start, length = rng.uniform(-4, 3), rng.uniform(0, 6)
        places = start + np.linspace(0, length, 2000)
        into = np.mod(places[:, None] - starts, 2 * np.pi)
        within = np.where(into < lengths, lengths - into, -1).max(axis=1)
        if _covered(start, length, starts, lengths):
            assert within.min() > 0
        else:
            assert within.min() < length / 1000
