"""Scenes of bodies that move or rest on one another: either joint may be the base."""

from dataclasses import replace

import numpy as np
import pytest

from cspace.model.robot import Body, Disc
from cspace.region import clearance_problem, solve
from engine_support import scenes


def test_an_obstacle_that_moves_through_another_changes_the_area_without_a_jump():
    robot = scenes.random_scene(8, 1)
    still = Body("still", "0", Disc(np.array([1.2, 0, 0.4]), 0.25))
    found = []
    for x in np.linspace(0.9, 1.5, 13):
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.2 + [x, 0.4]
        moving = Body("moving", "0", scenes.polygon(square))
        scene = replace(robot, boundaries=(), obstacles=(still, moving))
        areas = [solve(clearance_problem(scene), base=base).area for base in (0, 1)]
        assert areas[0] == pytest.approx(areas[1], abs=1e-9)
        found.append(areas[0])
    steps = np.abs(np.diff(found))
    assert np.ptp(found) > 0.1
    assert steps.max() < 4 * np.median(steps) + 0.05


@pytest.mark.parametrize("seed", [7, 48, 95, 117])
def test_either_joint_may_be_the_base_where_bodies_rest_on_one_another(seed):
    """Slides along edges, corners on edges at the ends of a range: once wrong, one way or other."""
    robot = scenes.drawn_scene(seed)
    regions = [solve(clearance_problem(robot), base=base) for base in (0, 1)]
    q = scenes.configurations(robot, 300, seed)
    for region in regions:
        assert len(scenes.wrongly_told(robot, region, q)) == 0
        assert not scenes.touching_in_cells(robot, region, q).any()
    assert len(regions[0].components) == len(regions[1].components)
    assert regions[0].area == pytest.approx(regions[1].area, abs=1e-6)
