"""Regions of arms among obstacles, configuration by configuration against shapely.

`engine/benchmarks/judged.py` has thousands of other scenes judged.
"""

import numpy as np
import pytest

from cspace.model.robot import Robot
from cspace.region import clearance_problem, find_region, solve
from engine_support import scenes


@pytest.mark.parametrize("seed", range(15))
def test_a_random_region_holds_what_shapely_finds_free(seed) -> None:
    check(scenes.random_scene(seed), seed)


@pytest.mark.parametrize("seed", range(15))
def test_a_region_in_whole_numbers_holds_what_shapely_finds_free(seed) -> None:
    check(scenes.drawn_scene(seed), seed)


def check(robot: Robot, seed: int) -> None:
    """Compare at random configurations, and on both sides of the boundary between them."""
    region = find_region(robot)
    q = scenes.configurations(robot, 600, seed)
    near = scenes.near_the_boundary(robot, q[:60])
    wrong = scenes.wrongly_told(robot, region, np.concatenate([q, near]))
    assert len(wrong) == 0, f"{len(wrong)}, such as {wrong[0].tolist()}"
    assert not scenes.touching_in_cells(robot, region, q).any()


TANGENT = {
    16: [1.0832608213156707, -1.5707963279420865],
    132: [1.57079632344419, -0.3949190342588109],
    169: [1.57079632434598, -1.1886775567893495],
    173: [0.8651149766933801, -1.9999999756772293],
    268: [0.0, 0.0],
}
"""Configurations that stood on the wrong side of a line beside a tangent contact."""


@pytest.mark.parametrize("seed", TANGENT)
def test_lines_beside_tangent_contacts_are_right_to_the_last_digits(seed) -> None:
    robot = scenes.drawn_scene(seed)
    problem = clearance_problem(robot)
    first, second = (solve(problem, base=base) for base in (0, 1))
    assert first.area == pytest.approx(second.area, rel=0, abs=1e-11)
    for region in (first, second):
        assert len(scenes.wrongly_told(robot, region, np.array([TANGENT[seed]]))) == 0


@pytest.mark.parametrize("more", [0.05, -0.02])
def test_the_oracle_sees_obstacles_that_are_too_wide_or_too_narrow(more) -> None:
    robot = scenes.random_scene(1)
    region, q = find_region(robot), scenes.configurations(robot, 400)
    assert len(scenes.wrongly_told(scenes.with_clearance(robot, more), region, q)) > 0
