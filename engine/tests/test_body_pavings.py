"""Pavings and connections of arms with bodies, against the regions and against shapely."""

from dataclasses import replace

import numpy as np
import pytest

from cspace import find_region, load_robot
from cspace.cli import main
from cspace.model.robot import Capsule
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.subpaving.connection import connection
from cspace.proofs.subpaving.paving import Paving, pave
from engine_support import body_scenes
from engine_support.region_judge import read_scene

TABLE = "two-links-on-a-table"


@pytest.fixture(scope="module")
def table():
    return exact_problem(exact_robot(TABLE))


@pytest.mark.parametrize("seed", [2, 12, 22, 32])
def test_brackets_hold_areas_and_cells_are_what_shapely_says(seed):
    text = body_scenes.scene(seed)
    robot, scene = body_scenes.robot(text), read_scene(text)
    paving = pave(exact_problem(exact_robot(robot)), 0.15, most=1000)
    inner, outer = (float(x) for x in paving.bracket)
    assert inner - 1e-9 <= find_region(robot).area <= outer + 1e-9
    for cells, hit in ((paving.feasible, False), (paving.infeasible, True)):
        for own in cells:
            q = within(paving, own, seed) * scene.scale
            assert ((scene.worst(q, 1.0) < 0) == hit).all()


def within(paving: Paving, cells, seed: int) -> np.ndarray:
    """One place of each cell, at random, off its edges."""
    low, high = paving.bounds.places(cells)
    return low + (high - low) * np.random.default_rng(seed).uniform(0.01, 0.99, low.shape)


def test_a_file_and_its_robot_are_paved_alike(table):
    one, other = (pave(p, 0.2) for p in (table, exact_problem(exact_robot(load_robot(TABLE)))))
    assert one.bracket[0].overlaps(other.bracket[0])
    assert one.cells == other.cells


def test_needles_that_keep_no_distance_are_decided_where_they_cross():
    robot = body_scenes.robot(body_scenes.whole(8, "RR", "xz", 1, "deg"))
    bodies = tuple(
        replace(body, shape=Capsule(np.zeros(3), np.array([2.0, 0, 0]), 0.0))
        for body in robot.bodies
    )
    needle = Capsule(np.array([1.0, 0, 0.5]), np.array([1.0, 0, 2.0]), 0.0)
    posts = tuple(replace(post, shape=needle) for post in robot.obstacles[:1])
    robot = replace(robot, bodies=bodies, obstacles=posts, boundaries=(), clearance=0.0)
    paving = pave(exact_problem(exact_robot(robot)), 0.05)
    inner, outer = (float(x) for x in paving.bracket)
    assert paving.infeasible
    assert inner < find_region(robot).area < outer


def test_the_two_regions_of_the_table_are_separated_and_each_is_connected(table):
    region = find_region(load_robot(TABLE))
    home = region.problem.free_home
    places = [home, np.array([-np.pi / 2, 0.2])]
    assert [region.component_of(q) for q in places] == [0, 1]
    assert connection(table, *places).answer == "separated"
    found = connection(table, home, home + 0.2)
    assert found.answer == "connected"
    s = np.linspace(0, 1, 200)[:, None]
    for a, b in zip(found.path, found.path[1:], strict=False):
        assert region.problem.evaluator.feasible(a + s * (b - a)).all()
    assert connection(table, home, [0.46, 0.0]).answer == "infeasible"


def test_a_plane_that_is_only_rounded_is_refused():
    robot = load_robot(TABLE)
    askew = np.eye(3) + 1e-14 * np.array([[0, 0, 1], [0, 0, 0], [-1, 0, 0]])
    joints = (replace(robot.joints[0], mount=askew), *robot.joints[1:])
    with pytest.raises(ValueError, match="plane"):
        exact_problem(exact_robot(replace(robot, joints=joints)))


def test_the_commands_take_bodies(capsys):
    assert main(["connected", TABLE, "100deg", "-60deg", "90deg", "-50deg"]) == 0
    assert main(["connected", TABLE, "100deg", "-60deg", "-90deg", "10deg"]) == 1
    assert "separated" in capsys.readouterr().out
