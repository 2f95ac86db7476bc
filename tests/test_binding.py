"""Rows that never decide: left out of the screen, and no answer changes."""

import math

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from qbound import load_robot
from qbound.boundary.evaluator import Evaluator, compiled, evaluator
from qbound.boundary.screen import BELOW, CERTAIN, _covered, binding, screen
from qbound.forms.harmonic import HarmonicForm

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
