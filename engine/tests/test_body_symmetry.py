"""A body that moves through another: either joint may be the base."""

from dataclasses import replace

import numpy as np
import pytest

from cspace.model.robot import Body, Disc
from cspace.region import clearance_problem, solve
from engine_support import body_scenes
from engine_support.arms import in_xz


def test_an_obstacle_that_moves_through_another_changes_the_area_without_a_jump():
    robot = body_scenes.robot(body_scenes.ordinary(8, obstacles=1))
    still = Body("still", robot.base, Disc(np.array([1.2, 0, 0.4]), 0.25))
    found = []
    for x in np.linspace(0.9, 1.5, 13):
        square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.2 + [x, 0.4]
        moving = Body("moving", robot.base, in_xz(square))
        scene = replace(robot, boundaries=(), obstacles=(still, moving))
        areas = [solve(clearance_problem(scene), base=base).area for base in (0, 1)]
        assert areas[0] == pytest.approx(areas[1], abs=1e-9)
        found.append(areas[0])
    steps = np.abs(np.diff(found))
    assert np.ptp(found) > 0.1
    assert steps.max() < 4 * np.median(steps) + 0.05
