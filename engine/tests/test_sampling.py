"""Random sampling: the seed, clearances by hand, the fraction against the exact area."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cspace import RobotFileError, find_region, load_robot
from cspace.design import varied, vary
from cspace.model.robotfile import parse_robot
from cspace.sampling import Sample, joint_ranges, keeps_clear, sample
from engine_support.oracles import equation_29, packaged_table

MINERVA = load_robot("minervabot-v2")
USED = {"1": ("1", "3"), "2": ("1", "3"), "3": ("1", "3"), "4": ("1", "3"), "7": ("3",)}


def by_hand(q: np.ndarray) -> dict[str, np.ndarray]:
    """Components of the boundaries in use (B5 and B6 are not)."""
    return {k: v for k, v in equation_29(*q.T).items() if k[6] in USED}


def clear_by_hand(q: np.ndarray) -> np.ndarray:
    hand = by_hand(q)
    apart = [np.hypot(hand[f"beta_{{{i},1}}"], hand[f"beta_{{{i},3}}"]) >= 0.1 for i in "1234"]
    return np.all([*apart, hand["beta_{7,3}"] >= 0], axis=0)


def test_clearance_is_what_its_equations_say() -> None:
    drawn = sample(MINERVA, 40_000, keeps_clear, seed=11)
    assert_array_equal(drawn.free, clear_by_hand(drawn.q))
    assert 0 < drawn.fraction_free < 1


def test_a_seed_draws_the_same_configurations() -> None:
    one, same, other = (sample(MINERVA, 100, keeps_clear, seed=s) for s in (5, 5, 6))
    assert_array_equal(one.q, same.q)
    assert_array_equal(one.free, same.free)
    assert not np.array_equal(one.q, other.q)


def test_batches_draw_what_one_call_draws(monkeypatch) -> None:
    whole = sample(MINERVA, 1000, seed=5)
    monkeypatch.setattr("cspace.sampling.BATCH", 7)
    pieces = sample(MINERVA, 1000, seed=5)
    assert_array_equal(pieces.q, whole.q)
    assert_array_equal(pieces.free, whole.free)
    assert_allclose(pieces.tool, whole.tool, rtol=0, atol=1e-12)  # a product rounds by its size


def test_standard_error_is_binomial() -> None:
    free = np.array([True] * 30 + [False] * 70)
    drawn = Sample(np.zeros((100, 2)), np.zeros((100, 3)), free)
    assert drawn.fraction_free == 0.3
    assert drawn.standard_error == pytest.approx(np.sqrt(0.3 * 0.7 / 100))


def test_ranges_are_the_limits_or_a_full_turn() -> None:
    table = packaged_table()
    table["joint"][0]["limits"] = [-90, 30]
    table["joint"][1] |= {"type": "prismatic", "limits": [0, 4]}
    robot = parse_robot(table)
    assert_allclose(joint_ranges(robot), [[-pi / 2, pi / 6], [0, 4]])
    assert_allclose(joint_ranges(MINERVA), [[-pi, pi]] * 2)
    q = sample(robot, 1000, keeps_clear, seed=1).q
    assert (q >= [-pi / 2, 0]).all()
    assert (q <= [pi / 6, 4]).all()
    assert np.ptp(q, axis=0) == pytest.approx([2 * pi / 3, 4], rel=0.02)


def test_of_many_joints_fewer_configurations_are_judged_at_once(monkeypatch) -> None:
    """Each takes 3^n products: 50,000 of seven joints took more than a gigabyte."""
    monkeypatch.setattr("cspace.sampling.NUMBERS", 3**6 * 100)
    sizes = []

    def judged(robot, q):
        sizes.append(len(q))
        return keeps_clear(robot, q)

    few = sample(load_robot("ur5"), 450, judged, seed=3)
    assert sizes == [100, 100, 100, 100, 50]
    monkeypatch.undo()
    assert_array_equal(few.free, sample(load_robot("ur5"), 450, keeps_clear, seed=3).free)


# --- numbers of a robot varied --------------------------------------------------------------------


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
    assert_allclose(homes.measures, [r.home_component.area for r in expected], rtol=1e-12)
    counts = vary(robot, LENGTH, values, lambda region: len(region.components))
    assert counts.measures.tolist() == [len(r.components) for r in expected]
    assert (homes.unit, counts.unit) == ("rad^2", "")


def test_the_workspace_of_a_free_arm_is_its_ring():
    """Two links that nothing bounds reach pi (a + b)^2 less pi (a - b)^2."""
    robot = replace(load_robot("two-links-on-a-table"), obstacles=(), collisions=False)
    found = vary(robot, "point.tip.at.0", [0.2, 0.3], "workspace")
    assert_allclose(found.measures, [4 * np.pi * 0.4 * b for b in (0.2, 0.3)], rtol=1e-9)
    assert (found.unit, found.best) == ("m^2", 0.3)


def test_what_cannot_be_measured_is_refused():
    robot = load_robot("minervabot-v2")
    with pytest.raises(ValueError, match="no measure 'beauty'; there are area, home area"):
        vary(robot, LENGTH, [1.0], "beauty")
    with pytest.raises(ValueError, match="values in a row"):
        vary(robot, LENGTH, [])
    with pytest.raises(TypeError, match="load_robot"):
        varied("minervabot-v2", {})
