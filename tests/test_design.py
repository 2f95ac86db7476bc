"""Numbers of a robot varied: the robot is that of a file with them, the measure its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from qbound import RobotFileError, find_region, load_robot
from qbound.design import varied, vary
from support.arms import three_joints

LENGTH = "joint.q2.origin.0"


def test_a_varied_number_is_that_of_the_robot_and_all_others_stay():
    robot = load_robot("two-links-on-a-table")
    found = varied(
        robot,
        {
            "joint.elbow.origin.0": 0.45,
            "body.upper arm.capsule.to.0": 0.45,  # the file does not spell this body's name
            ("obstacle", "post", "disc", "radius"): 0.05,
            "clearance": 0.01,
        },
    )
    assert found.joints[1].origin.tolist() == [0.45, 0, 0]
    assert [body.shape.radius for body in found.bodies] == [0.04, 0.03]
    assert found.obstacles[0].shape.radius == 0.05
    assert found.clearance == 0.01
    assert found.joints[0] is not robot.joints[0]
    assert_allclose(found.joints[0].origin, robot.joints[0].origin)
    assert robot.joints[1].origin.tolist() == [0.4, 0, 0]


def test_a_clearance_that_the_file_leaves_out_may_be_set():
    robot = load_robot("minervabot-v2")
    assert varied(robot, {"boundary.B1.clearance": 1.5}).boundary("B1").clearance == 1.5


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("joint.q9.origin.0", 1.0, "no joint 'q9'; there are q1, q2"),
        ("joint.q2.origin.3", 1.0, "'3' is none of the 3 entries"),
        ("joint.q2.origin", 1.0, "no number stands there"),
        ("joint.q2.name", 1.0, "no number stands there"),
        ("joint.q2.colour.0", 1.0, "nothing is called 'colour'"),
        ("joint.q2.origin.0", float("nan"), "no finite number"),
        ("planet.earth", 1.0, "nothing is called 'planet'"),
    ],
)
def test_a_number_that_is_none_is_refused_by_its_place(path, value, message):
    with pytest.raises(ValueError, match=message):
        varied(load_robot("minervabot-v2"), {path: value})


@pytest.mark.parametrize(("path", "value"), [("boundary.B1.clearance", -1.0), ("wings", 2.0)])
def test_a_robot_that_is_none_is_refused_as_its_file_would_be(path, value):
    with pytest.raises(RobotFileError, match=path.rsplit(".", maxsplit=1)[-1]):
        varied(load_robot("minervabot-v2"), {path: value})


def test_the_measure_at_each_value_is_that_of_the_robot_with_it():
    robot = load_robot("minervabot-v2")
    values = [10.0, 15.0, 30.0]
    expected = []
    for value in values:
        joint = replace(robot.joints[1], origin=np.array([value, 0.0, robot.joints[1].origin[2]]))
        expected.append(find_region(replace(robot, joints=(robot.joints[0], joint))))
    assert_allclose(vary(robot, LENGTH, values).measures, [r.area for r in expected], rtol=1e-12)
    homes = vary(robot, LENGTH, values, "home area")
    assert_allclose(homes.measures, [r.home.area for r in expected], rtol=1e-12)
    counts = vary(robot, LENGTH, values, lambda region: len(region.components))
    assert counts.measures.tolist() == [len(r.components) for r in expected]
    assert (homes.unit, counts.unit) == ("rad^2", "")


def test_the_workspace_of_a_free_arm_is_its_ring():
    """Two links that nothing bounds reach pi (a + b)^2 less pi (a - b)^2."""
    robot = replace(load_robot("two-links-on-a-table"), obstacles=(), collisions=False)
    found = vary(robot, "point.tip.at.0", [0.2, 0.3], "workspace")
    assert_allclose(found.measures, [4 * np.pi * 0.4 * b for b in (0.2, 0.3)], rtol=1e-9)
    assert (found.unit, found.best) == ("m^2", 0.3)


def test_other_joints_are_held():
    robot = three_joints()
    found = vary(robot, "joint.q3.origin.0", [0.4, 0.5], held={"q3": 0.1})
    assert found.measures[1] == find_region(robot, {"q3": 0.1}).area


def test_what_cannot_be_measured_is_refused():
    robot = load_robot("minervabot-v2")
    with pytest.raises(ValueError, match="no measure 'beauty'; there are area, home area"):
        vary(robot, LENGTH, [1.0], "beauty")
    with pytest.raises(ValueError, match="values in a row"):
        vary(robot, LENGTH, [])
    with pytest.raises(TypeError, match="load_robot"):
        varied("minervabot-v2", {})
