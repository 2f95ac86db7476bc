"""Regions of arms among obstacles, configuration by configuration against shapely.

`benchmarks/scenes.py` asks the same of many more scenes and configurations.
"""

import numpy as np
import pytest

from qbound.model.robot import Robot
from qbound.region import find_region
from support import scenes


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


@pytest.mark.parametrize("more", [0.05, -0.02])
def test_the_oracle_sees_obstacles_that_are_too_wide_or_too_narrow(more) -> None:
    robot = scenes.random_scene(1)
    region, q = find_region(robot), scenes.configurations(robot, 400)
    assert len(scenes.wrongly_told(scenes.with_clearance(robot, more), region, q)) > 0
