"""Images of aspects, proved: closed forms, the float workspace, arms that have none."""

from dataclasses import replace

import pytest
from flint import arb
from numpy.testing import assert_allclose

from cspace import load_robot
from cspace.model.robot import Point, Robot
from cspace.model.robotfile import parse_robot
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.region import clearance_problem, window_problem
from cspace.workspace.areas import find_workspace
from cspace.workspace.planar import planar_arm
from engine_support.arms import SIDE, joint, robot_table
from lizarraga2025.beyond.certainty import (
    exact_windows_problem,
    jacobian_determinant,
    proved_images,
)
from qbound import window_region

MINERVA = load_robot("minervabot-v2")
EXACT = exact_robot("minervabot-v2")
ELBOW = {"limits": [0.25, 3.0]}


def two_links(first, second, axis=SIDE) -> Robot:
    """Links of 2 and 1 in the plane of x and z, between limits."""
    rows = [joint("revolute", "0", "1", [0, 0, 0], SIDE, **first)]
    rows += [joint("revolute", "1", "2", [2.0, 0, 0], axis, **second)]
    tool = {"name": "t", "frame": "2", "at": [1.0, 0, 0]}
    return parse_robot(robot_table(rows, {"q1": 0.1, "q2": 0.2}, "2", point=[tool], boundary=[]))


def test_det_j_of_two_links_is_their_product_times_the_sine():
    """J = l1 l2 sin q2 up to the orientation of (x, z): exact whole numbers."""
    table = jacobian_determinant(exact_robot(two_links({}, {}))).coefficients
    assert abs(table[0, 2]) == 2
    assert [c for c in table.ravel() if c != 0] == [table[0, 2]]


@pytest.mark.parametrize(
    ("exact", "problem"),
    [
        (exact_windows_problem(MINERVA, EXACT), window_problem(window_region(MINERVA))),
        (exact_problem(EXACT), clearance_problem(MINERVA)),
    ],
    ids=["windows", "clearances"],
)
def test_images_of_the_paper_robot_are_those_of_the_float_workspace(exact, problem):
    images = proved_images(exact, problem, MINERVA.home, jacobian_determinant(EXACT))
    floats = find_workspace(planar_arm(MINERVA), problem, MINERVA.home, every=True)
    swept = sorted(float(image.swept) for image in images)
    assert_allclose(swept, sorted(a.swept for a in floats.aspects), rtol=1e-11)
    for side in (1, -1):
        total = sum(float(i.part.area) for i in images if i.side == side)
        assert total < sum(float(i.part.area) for i in images)


def test_a_tool_that_leaves_the_plane_is_refused():
    tilted = exact_robot(two_links({}, {}, axis=[1.0, 0.0, 0.0]))
    tip = Point("t", "2", tilted.points[0].at + 1)
    with pytest.raises(ValueError, match="leaves the plane"):
        jacobian_determinant(replace(tilted, points=(tip,)))


def test_what_goes_round_the_first_joint_sweeps_a_whole_turn():
    robot = two_links({}, ELBOW)
    (image,) = proved_images(
        exact_problem(exact_robot(robot)),
        clearance_problem(robot),
        robot.home,
        jacobian_determinant(exact_robot(robot)),
    )
    exact = 2 * arb.pi() * 2 * (arb(0.25).cos() - arb(3).cos())
    assert abs(image.swept - exact) < 1e-13  # of 53 bits
