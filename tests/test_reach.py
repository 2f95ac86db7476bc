"""Where the tool gets to: every place in a marked voxel, volumes that are known, directions."""

import json
from dataclasses import replace
from math import pi, tau

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from qbound import load_robot
from qbound.arms.fibres import fibres
from qbound.arms.reach import Grid, Paths, ToolPaths, crossed, enclosed_volume, reach, reach_lines
from qbound.boundary.balls import BLOCK, Balls
from qbound.boundary.evaluator import evaluator
from qbound.boundary.functions import position
from qbound.cli import main
from qbound.geometry.arcs import Intervals, on_circle, on_line
from qbound.model.robotfile import parse_robot, save_robot
from qbound.region import find_region
from support.ball_arms import arm_of_balls, drawn
from support.commands import follows_schema


@pytest.fixture(autouse=True)
def two_rounds(monkeypatch):
    """These arms have three joints at most, and need no more."""
    monkeypatch.setattr("qbound.arms.reach.SPREADS", (0.05, 0.02))


Z, Y, X = [0, 0, 1], [0, 1, 0], [1, 0, 0]


def arm(*joints, floor: float | None = None):
    """A chain of joints (axis, limits): without limits a turn, with them a slide."""
    rows = [
        {
            "name": f"q{k + 1}",
            "type": "revolute" if limits is None else "prismatic",
            "parent": str(k),
            "frame": str(k + 1),
            "origin": [0, 0, 0],
            "axis": axis,
        }
        | ({} if limits is None else {"limits": limits})
        for k, (axis, limits) in enumerate(joints)
    ]
    wall = {"name": "floor", "type": "half-space", "point": "tool", "normal": Z, "offset": floor}
    home = {row["name"]: 0.5 for row in rows}
    return parse_robot(
        {
            "schema": 1,
            "name": "arm",
            "length_unit": "m",
            "angle_unit": "rad",
            "home": home,
            "tool": "tool",
            "joint": rows,
            "point": [{"name": "tool", "frame": str(len(rows)), "at": [0, 0, 0]}],
            "boundary": [] if floor is None else [wall],
        }
    )


def cylinder():
    return arm((Z, None), (Z, [0.1, 0.6]), (X, [0.3, 0.8]))


def ball(floor: float | None = None):
    return arm((Z, None), (Y, None), (X, [0.4, 0.8]), floor=floor)


SHELL = 4 / 3 * pi * (0.8**3 - 0.4**3)
KNOWN = {
    "a ring": (cylinder, pi * (0.8**2 - 0.3**2) * 0.5),
    "a hollow ball": (ball, SHELL),
    "a hollow half ball": (lambda: ball(floor=0.0), SHELL / 2),
}


@pytest.mark.parametrize(("what", "seed"), [(what, seed) for seed, what in enumerate(KNOWN, 3)])
def test_the_volume_is_the_known_one_within_its_error(what, seed):
    make, volume = KNOWN[what]
    found = reach(make(), 0.1, seed=seed, points=256, scrambles=4)
    assert abs(found.volume - volume) < found.error
    assert found.error < 0.25 * volume
    # Chance: Student's t for three degrees of freedom, 3.18 standard errors of the scrambles.
    deviation = found.volumes[:, 0].std(ddof=1)
    assert found.chance == pytest.approx(3.182446 * deviation / 2, rel=1e-6)
    assert found.chance < found.error
    assert found.marked_volume > volume - 1e-9


def test_every_place_of_a_feasible_configuration_is_in_a_marked_voxel():
    robot = ball(floor=0.0)
    found = reach(robot, 0.2, points=512, scrambles=2)
    q = drawn(robot, 3000)
    places = position(robot, "tool")(q[Balls.of(robot).feasible(q)])
    assert found.reached.reshape(-1)[found.grid.flat_index(places.T)].all()


def test_a_marked_voxel_is_reached():
    """Each one holds a place of the known body."""
    found = reach(ball(floor=0.0), 0.1, points=256, scrambles=2)
    corners = found.grid.origin + found.grid.edge * np.argwhere(found.reached)
    nearest = np.clip(0, corners, corners + found.grid.edge)
    farthest = np.where(np.abs(corners) > np.abs(corners + 0.1), corners, corners + 0.1)
    assert (np.linalg.norm(nearest, axis=1) <= 0.8 + 1e-9).all()
    assert (np.linalg.norm(farthest, axis=1) >= 0.4 - 1e-9).all()
    assert (corners[:, 2] + 0.1 >= -1e-9).all()


def test_an_arm_in_a_plane_has_places_and_no_volume():
    found = reach(load_robot("pr-gantry-arm"), 0.1, points=64, scrambles=2)
    assert found.reached.any()
    assert found.volume <= found.error


def test_the_same_seed_gives_the_same_map_whatever_else_is_drawn():
    one, other, third = (reach(cylinder(), 0.1, seed=s, points=64, scrambles=2) for s in (3, 3, 4))
    assert_array_equal(one.reached, other.reached)
    assert_array_equal(one.volumes, other.volumes)
    assert not np.array_equal(one.volumes, third.volumes)


def test_directions_are_those_that_the_tool_has():
    """The tool's x axis looks outward: along the ring it points one way at each place."""
    found = reach(cylinder(), 0.1, points=256, scrambles=2, axis=X)
    assert found.index.shape == found.reached.shape
    assert (found.index[~found.reached] == 0).all()
    assert (found.index[found.reached] >= 1 / 72).all()
    assert found.index.max() <= 4 / 72  # two sectors may meet in a voxel, and two bands at z = 0
    upright = reach(cylinder(), 0.1, points=256, scrambles=2, axis=Z)
    assert_allclose(upright.index[upright.reached], 1 / 72)


def test_without_a_feasible_configuration_nothing_is_reached(capsys):
    found = reach(ball(floor=2.0), 0.2, points=64, scrambles=2)
    assert (found.reached.any(), found.box, found.volume) == (False, None, 0.0)


@pytest.mark.parametrize("seed", range(5))
def test_paths_are_those_of_the_tool_and_of_its_frame(seed):
    robot, axis = arm_of_balls(seed), np.array([0.6, 0.0, 0.8])
    q, paths = drawn(robot, 30, seed), ToolPaths(robot, axis)
    frame = robot.point(robot.tool).frame
    expected = robot.frames(q).rotation(robot.base, frame) @ axis
    for j in range(len(robot.joints)):
        along = paths.along(j, q.T)
        assert_allclose(along.places(q[:, j]).T, position(robot, robot.tool)(q), atol=1e-12)
        directions = np.broadcast_to(expected, (30, 3))
        assert_allclose(along.directions(q[:, j]).T, directions, atol=1e-12)


@pytest.mark.parametrize("turns", [True, False])
def test_a_path_goes_through_the_voxels_that_a_dense_one_meets(turns):
    rng, grid = np.random.default_rng(8), Grid(np.full(3, -4.0), 0.23, (36, 36, 36))
    place = rng.uniform(-1, 1, (3, 3, 20))
    paths = Paths(place, np.zeros_like(place), turns)
    low = rng.uniform(-2, 0, 20)
    high = low + rng.uniform(0, 3, 20)
    found = crossed(grid, paths, low, high)
    for k in range(20):
        dense = np.linspace(low[k], high[k], 20_001)
        one = Paths(np.repeat(place[..., k : k + 1], 20_001, axis=2), paths.direction, turns)
        met = set(grid.flat_index(one.places(dense)).tolist())
        mine = set(found.voxel[found.path == k].tolist())
        assert met <= mine
        assert len(mine) <= len(met) + 1  # a corner that dense steps go past


def test_the_volume_of_voxels_is_unbiased_over_where_the_grid_lies():
    rng, found = np.random.default_rng(1), []
    for shift in rng.uniform(0, 1, (400, 3)):  # a box of 5.3 x 4.1 x 2.6 by voxels of 1
        ends = np.floor(np.array([5.3, 4.1, 2.6]) + shift).astype(int) + 1
        touched = np.zeros((12, 12, 12), dtype=bool)
        touched[tuple(slice(2, 2 + end) for end in ends)] = True
        found.append(enclosed_volume(touched, 1.0))
    squares, cube = 2 * (5.3 * 4.1 + 4.1 * 2.6 + 5.3 * 2.6) / 2, 5.3 * 4.1 * 2.6
    lengths = 5.3 + 4.1 + 2.6
    expected = 2 * (cube + squares + lengths + 1) - (cube + 2 * squares + 4 * lengths + 8)
    assert np.mean(found) == pytest.approx(expected, abs=4 * np.std(found) / 20)


BAD = {
    "points: 100 is no power": {"points": 100},
    "at least 2": {"scrambles": 1},
    "a seed is 0 or above": {"seed": -1},
    "voxels; take a longer": {"voxel": 1e-4},
    "is no finite number above 0": {"voxel": 0.0},
    "three finite numbers": {"axis": [0, 0, 0]},
    "no joint 'q9'": {"joint": "q9"},
}


@pytest.mark.parametrize("reason", BAD)
def test_what_cannot_be_mapped_is_refused(reason):
    with pytest.raises(ValueError, match=reason):
        reach(cylinder(), **BAD[reason])


def test_a_joint_that_does_not_carry_the_tool_and_bodies_are_refused():
    with pytest.raises(ValueError, match="about bodies"):
        reach(load_robot("two-links-on-a-table"))


# --- commands -------------------------------------------------------------------------------------


def test_the_command_writes_what_it_says(tmp_path, capsys):
    svg, npz = tmp_path / "reach.svg", tmp_path / "reach.npz"
    line = ["reach", "pr-gantry-arm", "--voxel", "0.2", "--axis", "1,0,0", "--json", "-"]
    assert main([*line, "--svg", str(svg), "--npz", str(npz)]) == 0
    content = json.loads(capsys.readouterr().out)
    follows_schema(content, "reach")
    arrays = np.load(npz)
    assert arrays["reached"].sum() == content["voxels"]
    assert arrays["index"].max() == pytest.approx(content["index"]["greatest"])
    assert svg.read_text().startswith("<?xml")


@pytest.mark.parametrize(
    "words",
    [["--section", "w=0"], ["--section", "y=inf"], ["--axis", "1,2"], ["--svg", "a.txt"]],
    ids=" ".join,
)
def test_the_command_refuses_bad_words(tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    assert main(["reach", "pr-gantry-arm", *words]) == 2
    assert words[0].removeprefix("--") in capsys.readouterr().err or words[0] == "--svg"
    assert list(tmp_path.iterdir()) == []


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


def test_the_error_of_a_volume_is_called_an_estimate():
    found = reach(load_robot("ur5"), 0.5, points=64, scrambles=2)
    volume, said, *_ = reach_lines(found)
    assert "+-" in volume
    assert "an estimate, no bound" in said


def test_a_tool_that_stays_in_a_plane_has_no_volume():
    said = " ".join(reach_lines(reach(load_robot("pr-gantry-arm"), 0.5, points=64, scrambles=2)))
    assert "stays in a plane" in said
    assert "+-" not in said


def test_a_fibre_names_what_blocks_it(capsys):
    assert main(["fibre", "pr-gantry-arm", "arm", "3", "0"]) == 1
    assert "violated: cart.upper" in capsys.readouterr().out
    assert main(["fibre", "pr-gantry-arm", "arm", "3"]) == 2
    assert main(["fibre", "minervabot-v2", "q7"]) == 2


# --- feasible intervals of one joint --------------------------------------------------------------


SEEDS = range(8)
ROWS, STEPS = 8, 400


def scanned(robot, joint: int, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of a joint over its range and a little more, and every configuration with them."""
    low, high = robot.joints[joint].limits or (-2 * pi, 2 * pi)
    values = np.linspace(low - 0.01, high + 0.01, STEPS)
    every = np.repeat(q[:, None], STEPS, axis=1)
    every[..., joint] = values
    return values, every


@pytest.mark.parametrize("seed", SEEDS)
def test_a_fibre_holds_what_a_dense_scan_calls_feasible(seed):
    robot = arm_of_balls(seed)
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


def test_fibres_of_the_paper_s_robot_are_those_of_its_exact_region():
    robot = load_robot("minervabot-v2")
    q = np.random.default_rng(2).uniform(-pi, pi, (500, 2))
    region = find_region(robot)
    for j in (0, 1):
        inside = fibres(robot, j, q).contains(q[:, j])
        assert_array_equal(inside, region.contains(q))


def test_the_area_by_fibres_is_that_of_the_exact_region():
    robot = load_robot("minervabot-v2")
    first = (np.arange(2000) + 0.5) / 2000 * tau - pi
    q = np.stack([first, np.zeros(2000)], axis=1)
    assert fibres(robot, "q2", q).length.mean() * tau == pytest.approx(
        find_region(robot).area, 2e-4
    )


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
