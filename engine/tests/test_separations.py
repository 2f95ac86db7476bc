"""Ranges that nothing passes, by hand and by brute force; their certificates: test_disconnected."""

import math
import tomllib

import numpy as np
import pytest

from cspace.arms.separations import separation, separations
from cspace.model.robotfile import parse_robot
from cspace.proofs.subpaving.forbidden import blocked_ranges
from engine_support import brute_force
from engine_support.elbow import CLOSED, SLIDE, arm
from engine_support.robot_files import robot_file

ROUND = ""  # no limits: the elbow turns all the way round


def robot_of(text):
    return parse_robot(tomllib.loads(text))


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "arm.toml"
        path.write_text(text)
        return path

    return write


# --- ranges ---------------------------------------------------------------------------------------


def test_limits_of_two_turns_leave_three_ranges(file):
    _, elbow, _ = separations(file(arm()))
    blocks = [(b.low, b.high) for b in elbow.blocks]
    assert np.allclose(blocks, [(-math.tau + CLOSED, -CLOSED), (CLOSED, math.tau - CLOSED)])
    assert all(low >= CLOSED - 1e-15 for low, _ in blocks[1:])  # rounded inwards
    assert len(elbow.free) == 3
    assert [elbow.part(x) for x in (-6.0, 0.0, 3.1, 6.0)] == [0, 1, None, 2]
    assert elbow.blocks[0].links == ("upper arm, forearm",)


def test_one_block_round_a_joint_separates_nothing(file):
    travels = separations(file(arm(ROUND)))
    assert np.allclose(travels[1].free, [(math.tau - CLOSED, math.tau + CLOSED)])
    assert travels[1].part(0.0) == travels[1].part(-20 * math.tau + 1) == 0
    assert separation(travels, [0, -2, 0], [0, 2, 0]) is None


def test_two_blocks_round_a_joint_do():
    travels = separations("minervabot-v2")
    found = separation(travels, [0, 0], [0, 2.3])
    assert [block.links for block in found.blocks] == [("B3",), ("B4",)]
    assert separation(travels, [0, 0], [0, 2.3 - math.tau]).blocks == found.blocks
    assert separation(travels, [0, 0], [0, math.tau + 0.1]) is None


def test_a_slide_is_blocked_between_the_roots_of_a_quadratic(file):
    slide, arm_of_it = separations(file(SLIDE))
    (block,) = slide.blocks
    assert np.allclose([block.low, block.high], [-0.4, 0.4])
    assert -0.4 <= block.low < block.high <= 0.4
    assert separation((slide, arm_of_it), [-1, 0], [1, 0]).travel.name == "x"


def test_a_ball_off_the_axis_of_another_joint_narrows_the_range(file):
    """The other joint moves the ball by 2 mm: what is left is blocked for all its values."""
    (on_axis,) = (r for r in blocked_of(arm(wrist=1e-12)) if r.joint == 1)
    (off_axis,) = (r for r in blocked_of(arm(wrist=0.002)) if r.joint == 1)
    assert on_axis.low < off_axis.low < off_axis.high < on_axis.high
    assert on_axis.low == pytest.approx(CLOSED, abs=1e-9)


def blocked_of(text):
    robot = robot_of(text)
    return blocked_ranges(robot)


@pytest.mark.parametrize("seed", range(20))
def test_what_is_blocked_is_violated_whatever_the_other_joints_are(seed):
    """By an evaluator that shares no code, over the range, ends included, and the other joints."""
    text = robot_file(seed, 3, "revolute prismatic").replace("clearance = ", "clearance = 1")
    robot, table = robot_of(text), tomllib.loads(text)
    rng = np.random.default_rng(seed)
    for found in blocked_of(text):
        limits = [joint.limits or (-math.pi, math.pi) for joint in robot.joints]
        q = np.stack([rng.uniform(*ends, 400) for ends in limits], axis=1)
        low, high = limits[found.joint] if not robot.joints[found.joint].turns else (-9, 9)
        ends = max(found.low, low), min(found.high, high)
        if ends[0] >= ends[1]:
            continue
        q[:, found.joint] = [*ends, *rng.uniform(*ends, 398)]
        q[:, [j.turns for j in robot.joints]] *= 180 / math.pi
        margins = brute_force.margins(table, {"margin": "0"}, q)[found.boundary]
        assert margins.max() <= 1e-9


def test_the_sampled_robots_do_block_ranges():
    texts = [robot_file(seed, 3, "revolute prismatic") for seed in range(20)]
    wide = [text.replace("clearance = ", "clearance = 1") for text in texts]
    assert sum(bool(blocked_of(text)) for text in wide) > 5


def test_nothing_that_may_be_kept_is_blocked(file):
    """A pair that depends on one joint: outside its range some configuration keeps it."""
    _, elbow, _ = separations(file(arm()))
    table = tomllib.loads(arm())
    for low, high in elbow.free:
        q = np.zeros((50, 3))
        q[:, 1] = np.degrees(np.linspace(low + 1e-9, high - 1e-9, 50))
        assert brute_force.margins(table, {"margin": "0"}, q)["folded"].min() >= 0
