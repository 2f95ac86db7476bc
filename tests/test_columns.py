"""Pavings by columns: what they prove holds, and they bracket the area."""

import json
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings
from hypothesis import strategies as st

from qbound import find_region, load_robot
from qbound.boundary.functions import clearance
from qbound.cli import main
from qbound.model.robot import HalfSpace, Pair, Point, Revolute, Robot
from qbound.proofs import Verdict
from qbound.proofs.exact.numbers import ERROR, FARTHEST, cosine_sine
from qbound.proofs.exact.problem import exact_problem, exact_robot
from qbound.proofs.subpaving.stacks import ColumnPaving, pave_columns
from support.commands import follows_schema
from support.robots import random_robot

TWO_JOINTS = (
    "minervabot-v2",
    "two-joint-arm-with-walls",
    "pr-gantry-arm",
    "rp-telescopic-boom",
)


@lru_cache(maxsize=32)
def paved(name: str, tolerance: float, **options: int) -> ColumnPaving:
    return pave_columns(exact_problem(exact_robot(name)), tolerance, **options)


def margins(name: str, q: np.ndarray) -> np.ndarray:
    robot = load_robot(name)
    return np.min([clearance(robot, boundary)(q) for boundary in robot.used], axis=0)


def drawn(paving: ColumnPaving, count: int) -> np.ndarray:
    ends = [(float(low), float(high)) for low, high in paving.problem.ends]
    return np.random.default_rng(585).uniform(*np.transpose(ends), (count, len(ends)))


def test_cosine_and_sine_are_within_their_error() -> None:
    rng = np.random.default_rng(1)
    turns = np.arange(-600, 600) * np.pi / 2
    angles = np.concatenate([rng.uniform(-FARTHEST, FARTHEST, 2000), turns, rng.normal(0, 1e-9, 9)])
    for x, c, s in zip(angles, *cosine_sine(angles), strict=True):
        place = arb(float(x))
        assert abs(place.cos() - float(c)) < ERROR / 8
        assert abs(place.sin() - float(s)) < ERROR / 8


@pytest.mark.parametrize("angle", [np.nan, np.inf, 1001.0])
def test_no_cosine_of_what_is_no_angle(angle: float) -> None:
    with pytest.raises(ValueError, match="angle"):
        cosine_sine(np.array([angle]))


@pytest.mark.parametrize("name", TWO_JOINTS)
@pytest.mark.parametrize("tolerance", [0.3, 1e-3])
def test_the_volumes_bracket_the_area_of_the_exact_region(name: str, tolerance: float) -> None:
    paving = paved(name, tolerance)
    inner, outer = paving.bracket
    area = find_region(load_robot(name)).area
    assert paving.undecided_fraction <= tolerance
    assert inner <= area * (1 + 1e-12)
    assert area * (1 - 1e-12) <= outer
    assert (outer - inner) / paving.volume <= tolerance * (1 + 1e-6)


@pytest.mark.parametrize("name", TWO_JOINTS)
@pytest.mark.parametrize("tolerance", [0.3, 1e-3])
def test_what_is_proved_of_a_configuration_is_so(name: str, tolerance: float) -> None:
    paving = paved(name, tolerance)
    q = drawn(paving, 100)
    undecided = 0
    for place, margin in zip(q, margins(name, q), strict=True):
        found = paving.verdicts(place)
        assert found
        assert Verdict.PROVED not in found or margin > 0
        assert Verdict.REFUTED not in found or margin < 0
        undecided += found == {Verdict.UNDECIDED}
    # As many are undecided as the paving says, but for those of which its slabs know more.
    assert undecided <= 100 * paving.undecided_fraction + 4 * np.sqrt(100 * tolerance)


def test_beside_the_boundary_nothing_wrong_is_proved() -> None:
    """Places within a slab's thickness of the arcs, where an error would show."""
    paving = paved("minervabot-v2", 1e-2)
    region = find_region(load_robot("minervabot-v2"))
    loops = [loop for component in region.components for loop in component.loops]
    on = np.concatenate([arc.at(np.linspace(0, 1, 10)) for loop in loops for arc in loop])
    rng = np.random.default_rng(3)
    near = rng.normal(on, 10.0 ** rng.uniform(-5, -2, (len(on), 1)))
    told = {Verdict.PROVED: 0, Verdict.REFUTED: 0}
    near = (near + np.pi) % (2 * np.pi) - np.pi
    for place, margin in zip(near, margins("minervabot-v2", near), strict=True):
        found = paving.verdicts(place)
        for verdict in told:
            told[verdict] += verdict in found
        assert Verdict.PROVED not in found or margin > 0
        assert Verdict.REFUTED not in found or margin < 0
    assert min(told.values()) > 10


def test_either_joint_may_be_solved_for() -> None:
    first, second = (paved("minervabot-v2", 1e-2, lift=joint).bracket for joint in (0, 1))
    assert max(first[0], second[0]) < min(first[1], second[1])


@pytest.mark.parametrize("lift", [1, 2])
def test_more_joints_than_two(lift: int) -> None:
    """Three links with a ball at the tip, between a floor and a post: judged one by one."""
    axis, mount = np.array([0.0, 1.0, 0.0]), np.eye(3)
    frames = ("base", "1", "2", "3")
    joints = tuple(
        Revolute(f"q{j}", frames[j], frames[j + 1], np.array([0.0, 0.0, j > 0]), mount, axis, ends)
        for j, ends in enumerate([(-1.0, 1.5), (-2.0, 2.0), (-2.5, 1.0)])
    )
    points = (
        Point("tip", "3", np.array([0.1, 0.0, 0.7])),
        Point("wrist", "2", np.array([0.0, 0.0, 1.0])),
        Point("post", "base", np.array([0.9, 0.0, 0.8])),
    )
    up = np.array([0.0, 0.0, 1.0])
    bounds = (
        Pair("tip, post", ("post", "tip"), 0.5),
        Pair("wrist, post", ("post", "wrist"), 0.4),
        HalfSpace("floor", "tip", up, 0.2),
    )
    robot = Robot("three", joints, points, bounds, np.zeros(3), "tip", "m", "rad")
    paving = pave_columns(exact_problem(exact_robot(robot)), 0.2, lift=lift)
    assert paving.undecided_fraction <= 0.2
    q = drawn(paving, 250)
    margin = np.min([clearance(robot, boundary)(q) for boundary in bounds], axis=0)
    inner, outer = paving.bracket
    told = [paving.verdicts(place) for place in q]
    assert not any(Verdict.PROVED in found for found in np.array(told)[margin < 0])
    assert not any(Verdict.REFUTED in found for found in np.array(told)[margin > 0])
    part, spread = (margin > 0).mean() * paving.volume, 4 * paving.volume / np.sqrt(4 * len(q))
    assert inner - spread < part < outer + spread
    undecided = sum(found == {Verdict.UNDECIDED} for found in told)
    assert undecided < 75


@settings(max_examples=6)
@given(st.integers(0, 10**6))
def test_random_robots_are_bracketed(seed: int) -> None:
    robot = random_robot(4 * (seed // 4) + seed % 3)  # but for those that only slide
    paving = pave_columns(exact_problem(exact_robot(robot)), 0.02)
    inner, outer = paving.bracket
    assert inner - 1e-7 <= find_region(robot).area <= outer + 1e-7


def test_it_stops_where_cells_run_out() -> None:
    paving = paved("minervabot-v2", 1e-6, most=200)
    assert paving.undecided_fraction > 1e-6
    assert len(paving.columns) < 800


def test_outside_of_the_range_there_is_no_verdict() -> None:
    paving = paved("two-joint-arm-with-walls", 0.1)
    assert paving.verdicts([0.0, 3.0]) == set()
    assert paving.verdicts([3.1, 0.0]) == set()


@pytest.mark.parametrize(
    ("name", "options", "says"),
    [
        ("pp-portal", {}, "one of which turns"),
        ("two-links-on-a-table", {}, "bodies"),
        ("pr-gantry-arm", {"lift": 0}, "does not turn"),
    ],
)
def test_what_columns_are_not_for_is_refused(name: str, options: dict[str, int], says: str) -> None:
    with pytest.raises(ValueError, match=says):
        paved(name, 0.1, **options)


def test_a_tolerance_of_nothing_is_refused() -> None:
    for tolerance in (0.0, -1.0, np.nan):
        with pytest.raises(ValueError, match="tolerance"):
            paved("minervabot-v2", tolerance)


def test_a_joint_that_turns_far_from_zero_is_refused() -> None:
    robot = load_robot("minervabot-v2")
    for far in range(2):
        joints = [
            replace(joint, limits=(1e7, 1e7 + 1)) if k == far else joint
            for k, joint in enumerate(robot.joints)
        ]
        problem = exact_problem(replace(robot, joints=tuple(joints)))
        with pytest.raises(ValueError, match=f"joint {far}: its limits reach beyond"):
            pave_columns(problem, 0.1)


def test_a_robot_without_boundaries_is_feasible_everywhere() -> None:
    problem = exact_problem(replace(load_robot("minervabot-v2"), boundaries=()))
    paving = pave_columns(problem, 1e-3)
    assert paving.bracket[0] == pytest.approx(paving.volume)
    assert paving.verdicts([0.1, 0.2]) == {Verdict.PROVED}


@pytest.mark.parametrize("robot", ["minervabot-v2", "pr-gantry-arm"])
def test_the_command_solves_for_a_joint_and_brackets_the_same_area(
    robot: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["pave", robot, "--columns", "--tolerance", "0.01"]
    assert main([*words, "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    follows_schema(content, "columns")
    volume, columns = content["volume"], content["columns"]
    area = find_region(load_robot(robot)).area
    assert volume["inner"] <= area <= volume["outer"]
    assert content["undecided"] <= 0.01
    base = [name for name in content["joints"] if name != content["lift"]]
    ends = dict(zip(content["joints"], content["range"], strict=True))
    cells = np.array([[c["from"], c["to"]] for c in columns])
    widths = np.prod(cells[:, 1] - cells[:, 0], axis=1)
    assert widths.sum() == pytest.approx(np.prod([np.ptp(ends[name]) for name in base]))
    assert sum(c["feasible"] for c in columns) == pytest.approx(volume["inner"], rel=1e-6)
    assert main(words) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith(f"volume between {volume['inner']:.9g} ")
    assert said[2] == f"{len(columns)} columns"


def test_the_command_says_what_has_no_columns(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["pave", "two-links-on-a-table", "--columns"]) == 2
    assert "bodies" in capsys.readouterr().err


def test_a_held_joint_is_none_of_the_columns(capsys: pytest.CaptureFixture[str]) -> None:
    held = [f"{joint.name}=-40deg" for joint in load_robot("ur5").joints[2:]]
    words = ["pave", "ur5", "--columns", "--tolerance", "0.9", "--json", "-", "--slice", *held]
    assert main(words) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["joints"] == [joint.name for joint in load_robot("ur5").joints[:2]]
    assert content["lift"] == content["joints"][1]


def test_a_paving_tells_how_far_it_is() -> None:
    told: list[float] = []
    pave_columns(exact_problem(exact_robot("minervabot-v2")), 0.01, tell=told.append)
    assert told == sorted(told)
    assert told[0] < 1
    assert told[-1] == 1
