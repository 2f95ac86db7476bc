"""Exact feasible intervals of one joint: beside dense scans and exact regions, and by command."""

import json
from dataclasses import replace
from math import pi, tau

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cspace import load_robot
from cspace.arms.fibres import fibres
from cspace.boundary.balls import BLOCK, Balls
from cspace.boundary.evaluator import evaluator
from cspace.cli import main
from cspace.geometry.arcs import Intervals, on_circle, on_line
from cspace.model.robotfile import save_robot
from engine_support.ball_arms import arm_of_balls, drawn, with_parallelogram
from engine_support.commands import follows_schema

# --- commands -------------------------------------------------------------------------------------


def test_a_fibre_as_json_follows_its_schema(capsys):
    assert main(["fibre", "minervabot-v2", "q2", "20deg", "0", "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    follows_schema(content, "fibre")
    robot = load_robot("minervabot-v2")
    found = fibres(robot, "q2", content["q"])
    assert [i["low"] for i in content["intervals"]] == found.low.tolist()
    assert content["contains_q"] == Balls.of(robot).feasible(content["q"])


def test_a_joint_may_be_named_by_its_index(tmp_path, capsys):
    assert main(["fibre", "minervabot-v2", "q2"]) == 0
    by_name = capsys.readouterr().out
    assert main(["fibre", "minervabot-v2", "1"]) == 0
    assert capsys.readouterr().out == by_name
    for word in ("2", "-1", "1.0", "9" * 5000):
        assert main(["fibre", "minervabot-v2", "--", word]) == 2
        assert "there are 0 (q1), 1 (q2)" in capsys.readouterr().err
    robot = load_robot("minervabot-v2")
    names = {"q1": "1", "q2": "other"}
    joints = tuple(replace(joint, name=names[joint.name]) for joint in robot.joints)
    save_robot(replace(robot, joints=joints), tmp_path / "arm.toml")
    assert main(["fibre", str(tmp_path / "arm.toml"), "1"]) == 0
    assert "with other" in capsys.readouterr().out  # a name goes before an index


def test_a_fibre_names_what_blocks_it(capsys):
    assert main(["fibre", "pr-gantry-arm", "arm", "3", "0"]) == 1
    assert "violated: cart.upper" in capsys.readouterr().out
    assert main(["fibre", "pr-gantry-arm", "arm", "3"]) == 2
    assert main(["fibre", "minervabot-v2", "q7"]) == 2


# --- feasible intervals of one joint --------------------------------------------------------------


SEEDS = range(8)
ARMS = [*map(arm_of_balls, SEEDS), *map(with_parallelogram, range(4))]
ROWS, STEPS = 8, 400


def scanned(robot, joint: int, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of a joint over its range and a little more, and every configuration with them."""
    low, high = robot.joints[joint].limits or (-2 * pi, 2 * pi)
    values = np.linspace(low - 0.01, high + 0.01, STEPS)
    every = np.repeat(q[:, None], STEPS, axis=1)
    every[..., joint] = values
    return values, every


@pytest.mark.parametrize("seed", range(len(ARMS)))
def test_a_fibre_holds_what_a_dense_scan_calls_feasible(seed):
    robot = ARMS[seed]
    q = drawn(robot, ROWS, seed)
    for j in range(len(robot.joints)):
        values, every = scanned(robot, j, q)
        margins = evaluator(robot).margins(every)
        clear = np.abs(margins).min(axis=-1) > 1e-7
        found = fibres(robot, j, q).contains(np.broadcast_to(values, every.shape[:2]))
        assert_array_equal(found[clear], (margins >= 0).all(axis=-1)[clear])


@pytest.mark.parametrize("seed", SEEDS)
def test_what_ends_an_interval_is_at_zero_there(seed):
    robot = arm_of_balls(seed)
    q, compiled = drawn(robot, 40, seed), evaluator(robot)
    for j, joint in enumerate(robot.joints):
        for row, intervals in zip(q, fibres(robot, j, q), strict=True):
            for low, high, below, above in intervals:
                for value, name in ((low, below), (high, above)):
                    if name is not None:
                        there = np.where(np.arange(len(q[0])) == j, value, row)
                        margin = compiled.margins(there)[compiled.names.index(name)]
                        assert margin == pytest.approx(0, abs=1e-6)
                if below is None or above is None:
                    assert joint.limits is None
                    assert (low, high) == (-pi, pi)


@pytest.mark.parametrize("seed", SEEDS[:6])
def test_intervals_ascend_and_keep_to_the_range(seed):
    robot = arm_of_balls(seed)
    for j, joint in enumerate(robot.joints):
        found = fibres(robot, j, drawn(robot, BLOCK + 5, seed))
        assert len(found) == BLOCK + 5
        assert (found.low <= found.high).all()
        same = found.rows[1:] == found.rows[:-1]
        assert (found.low[1:] > found.high[:-1])[same].all()
        low, high = joint.limits or (-pi, 3 * pi)
        assert (found.low >= low - 1e-12).all()
        assert (found.high <= high + 1e-12).all()
        assert_allclose(found.length, [sum(i.high - i.low for i in row) for row in found])
        if joint.limits is None:
            assert (found.low < pi).all()
            assert (found.length <= tau + 1e-12).all()


def test_outside_another_joint_s_limits_nothing_is_feasible():
    robot = load_robot("pr-gantry-arm")
    low, high = robot.joints[0].limits
    q = [[high + 0.1, 0.0], [high, 0.0], [low - 1.0, 0.0]]
    assert_array_equal(fibres(robot, "arm", q).length[[0, 2]], 0)
    assert fibres(robot, "arm", [low - 1.0, 0.0])[0] == []


@pytest.mark.parametrize("row", [2, -3])
def test_a_row_that_is_not_there_is_an_index_error(row):
    found = fibres(load_robot("minervabot-v2"), 0, np.zeros((2, 2)))
    assert found[-1] == found[1]
    with pytest.raises(IndexError):
        found[row]


def test_bad_input_is_refused():
    robot = load_robot("minervabot-v2")
    with pytest.raises(ValueError, match="no joint 'q9'"):
        fibres(robot, "q9", [0, 0])
    with pytest.raises(ValueError, match="not a finite number"):
        fibres(robot, "q2", [np.nan, 0])
    with pytest.raises(ValueError, match="about bodies"):
        fibres(load_robot("two-links-on-a-table"), 0, [0, 0])
    with pytest.raises(ValueError, match="finite values of 1 rows"):
        fibres(robot, "q2", [0, 0]).contains([0.0, 1.0])
    with pytest.raises(TypeError, match="load_robot"):
        fibres("minervabot-v2", "q2", [0, 0])


def test_no_configuration_has_no_fibre():
    found = fibres(load_robot("minervabot-v2"), "q2", np.empty((0, 2)))
    assert (len(found), list(found), found.length.shape) == (0, [], (0,))


# --- gaps ---------------------------------------------------------------------------------------


def taken(*rows_low_high):
    row, low, high = np.array(rows_low_high, dtype=float).reshape(-1, 3).T
    return Intervals(row.astype(np.intp), low, high)


def listed(gaps):
    return [
        (int(row), round(float(low), 9), round(float(high), 9), int(below), int(above))
        for row, low, high, below, above in zip(*gaps, strict=True)
    ]


def test_gaps_on_a_line_by_hand():
    some = taken((0, 2, 3), (0, 2.5, 4), (0, -1, 1), (2, 0, np.inf), (3, -np.inf, 2), (3, 7, 9))
    assert listed(on_line(some, 5, 5.0)) == [
        (0, 1, 2, 2, 0),
        (0, 4, 5, 1, -1),
        (1, 0, 5, -1, -1),
        (3, 2, 5, 4, -1),
        (4, 0, 5, -1, -1),
    ]


def test_gaps_round_a_circle_by_hand():
    some = taken((0, 1, 2), (0, 6, 6.5), (1, 0, np.inf), (3, -1, 1), (3, 0.5, 2))
    assert listed(on_circle(some, 4, None)) == [
        (0, round(6.5 - tau, 9), 1, 1, 0),
        (0, 2, 6, 0, 1),
        (2, 0, round(tau, 9), -1, -1),
        (3, 2, round(tau - 1, 9), 4, 3),
    ]


def test_gaps_of_two_turns_by_hand():
    some = taken((0, 3, 3.5))
    assert listed(on_circle(some, 1, 2 * tau)) == [
        (0, 0, 3, -1, 0),
        (0, 3.5, round(3 + tau, 9), 0, 0),
        (0, round(3.5 + tau, 9), round(2 * tau, 9), 0, -1),
    ]


@pytest.mark.parametrize("span", [None, 1.0, tau, 8.0, 20.0])
def test_gaps_round_a_circle_are_what_no_interval_holds(span):
    rng = np.random.default_rng(4)
    row, low = rng.integers(0, 60, 150), rng.uniform(-9, 9, 150)
    high = low + rng.uniform(0, 3, 150) ** 2 / 2
    gaps = on_circle(Intervals(row, low, high), 60, span)
    places = rng.uniform(0, tau if span is None else span, 400)
    for r in range(60):
        arcs = [(a, b) for a, b in zip(low[row == r], high[row == r], strict=True)]
        free = [all((x - a) % tau > b - a for a, b in arcs) for x in places]
        mine = [
            (a, b) for a, b in zip(gaps.low[gaps.row == r], gaps.high[gaps.row == r], strict=True)
        ]
        turned = places if span is not None else places[:, None] + [0, tau]
        turned = turned.reshape(len(places), -1)
        held = [any(a <= x <= b for a, b in mine for x in each) for each in turned]
        assert held == free
