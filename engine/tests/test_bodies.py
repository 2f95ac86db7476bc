"""Bodies against a library that knows nothing of this one, and points against bodies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cspace import clearance, load_robot
from cspace.measures import bodies
from cspace.model.robot import Body, Polygon, Prismatic
from cspace.region import solve, state, window_problem
from engine_support.judged_poses import gaps
from engine_support.oracles import packaged_table
from qbound import window_region
from qbound.windows import window_box

PRINTED, CORRECTED, SYMMETRIC = (
    load_robot(f"minervabot-v2{name}") for name in ("", "-corrected", "-symmetric")
)
SQUARE = np.random.default_rng(17).uniform(-np.pi, np.pi, (4000, 2))


# --- outlines in place ----------------------------------------------------------------------------


@given(st.floats(-4, 4), st.floats(-4, 4))
def test_an_outline_is_where_its_points_are(q1, q2) -> None:
    """Points 7, 9, 10 and 12 are corners of link 1; 11 and 13 of link 2."""
    frames = PRINTED.frames([q1, q2])
    for frame, names in ((1, ("9", "7", "10", "12")), (2, ("11", None, None, "13"))):
        placed = bodies.outline(PRINTED, PRINTED.bodies[frame], [q1, q2])
        for corner, name in zip(placed, names, strict=True):
            if name is not None:
                assert corner == pytest.approx(frames.position("0", name, "0")[[0, 2]])


@pytest.mark.parametrize("name", ["minervabot-v2", "minervabot-v2-symmetric"])
def test_gaps_of_bodies_are_those_of_shapely(name) -> None:
    """In frames that turn the corners one joint after the other."""
    judged = gaps(packaged_table(name), SQUARE)
    for pair, found in bodies.gaps(load_robot(name), SQUARE).items():
        gap = judged[frozenset(pair)]
        assert_allclose(found[gap > 0], gap[gap > 0], atol=1e-9)
        assert (found[gap < -1e-9] < 0).all()
        assert 0 < (gap > 0).sum() < len(gap)


# --- conservative advancement ---------------------------------------------------------------------


@pytest.mark.parametrize("joint", [0, 1])
@pytest.mark.parametrize("robot", [PRINTED, CORRECTED, SYMMETRIC], ids=lambda robot: robot.name)
def test_room_ends_where_two_bodies_touch_and_no_sooner(robot, joint) -> None:
    low, high = bodies.contact_free_interval(robot, joint)
    pair = (robot.joints[joint].parent, robot.joints[joint].frame)

    def apart(values):
        q = np.tile(robot.home, (len(values), 1))
        q[:, joint] = values
        return bodies.gaps(robot, q)[pair]

    assert np.abs(apart(np.array([low, high]))).max() < 1e-11
    assert (apart(np.linspace(low, high, 5001)[1:-1]) > 0).all()
    assert (apart(np.array([low - 1e-6, high + 1e-6])) < 0).all()


def test_room_of_a_slide_is_the_distance_between_the_bodies() -> None:
    box = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    slide = PRINTED.joints[0].as_type(
        Prismatic, axis=np.array([1.0, 0, 0]), origin=np.zeros(3), limits=(-5.0, 5.0)
    )
    robot = replace(
        PRINTED, joints=(slide,), home=np.zeros(1), points=(),
        bodies=(
            Body("0", "0", Polygon.of(box)),
            Body("1", "1", Polygon.of(box + np.array([2.0, 0.5]))),
        ),
    )  # fmt: skip
    assert bodies.contact_free_interval(robot, 0) == pytest.approx((-1.0, 5.0), abs=1e-12)


def test_room_is_a_full_turn_to_either_side_where_nothing_is_in_the_way() -> None:
    shape = Polygon(PRINTED.bodies[0].shape.corners - [0, 0, 500])
    far = replace(PRINTED.bodies[0], shape=shape)
    low, high = bodies.contact_free_interval(replace(PRINTED, bodies=(far, *PRINTED.bodies[1:])), 0)
    assert (low, high) == pytest.approx((-2 * np.pi, 2 * np.pi))


def test_room_needs_both_bodies() -> None:
    with pytest.raises(ValueError, match="no body in frame '2'"):
        bodies.contact_free_interval(replace(PRINTED, bodies=PRINTED.bodies[:2]), 1)


# --- points against bodies ------------------------------------------------------------------------


def region_of_bodies(robot):
    """Joint values at which neighbouring bodies stay apart and the tool above its limit."""
    rooms = [bodies.contact_free_interval(robot, joint) for joint in (0, 1)]
    return solve(state(robot, [robot.boundary("B7")], rooms, [("-", "+")] * 2), robot.home)


def test_on_the_symmetric_robot_points_and_bodies_leave_the_same_region() -> None:
    """Departure: the paper never compares its points with bodies."""
    box = window_box(SYMMETRIC)
    rooms = np.array([bodies.contact_free_interval(SYMMETRIC, joint) for joint in (0, 1)])
    assert rooms == pytest.approx(np.stack([box.lower, box.upper], -1), abs=1e-12)
    points = solve(window_problem(window_region(SYMMETRIC)), SYMMETRIC.home)
    assert region_of_bodies(SYMMETRIC).area == pytest.approx(points.area, abs=1e-12)


def test_with_the_printed_offsets_the_points_only_lose_a_strip() -> None:
    box = window_box(PRINTED)
    rooms = np.array([bodies.contact_free_interval(PRINTED, joint) for joint in (0, 1)])
    assert (rooms[:, 0] <= box.lower + 1e-12).all()
    assert (rooms[:, 1] >= box.upper).all()
    points = window_region(PRINTED)
    lost = region_of_bodies(PRINTED).area - points.area
    by_grid = SQUARE[free_bodies(PRINTED, SQUARE) & ~points.contains(SQUARE)]
    assert 0 < lost < 0.12
    assert len(by_grid) / len(SQUARE) * (2 * np.pi) ** 2 == pytest.approx(lost, abs=0.08)


def free_bodies(robot, q):
    clear = np.all([gap > 0 for gap in bodies.gaps(robot, q).values()], axis=0)
    return clear & (clearance(robot, robot.boundary("B7"))(q) >= 0)


def test_no_pose_that_the_papers_rule_allows_makes_bodies_overlap() -> None:
    q = SQUARE[window_region(PRINTED).contains(SQUARE)]
    assert min(gap.min() for gap in bodies.gaps(PRINTED, q).values()) > 0


def test_the_base_and_link_2_stay_far_apart_in_the_whole_region() -> None:
    """A grid, and a bound on how fast the gap changes between its points, cover the region."""
    half = np.radians(0.5)
    lattice = np.arange(-np.pi + half, np.pi, 2 * half)
    q = np.stack(np.meshgrid(lattice, lattice, indexing="ij"), -1).reshape(-1, 2)
    box, far = window_box(PRINTED), np.hypot(25, 5.25)
    speeds = np.array([np.hypot(15, 25.98) + far, far])  # of link 2's corners, joint by joint
    height = clearance(PRINTED, PRINTED.boundary("B7"))(q)
    near = (q >= box.lower - half).all(-1) & (q <= box.upper + half).all(-1)
    near &= height >= -speeds.sum() * half
    assert bodies.gaps(PRINTED, q[near])[("0", "2")].min() - speeds.sum() * half > 10


# --- overlaps that pictures show ------------------------------------------------------------------


@pytest.mark.parametrize("robot", [PRINTED, load_robot("two-links-on-a-table")], ids=str)
def test_overlaps_are_the_negative_gaps_of_bodies_that_home_keeps_apart(robot) -> None:
    pairs = bodies.overlap_pairs(robot)
    apart_at_home = {pair for pair, gap in bodies.gaps(robot, robot.home).items() if gap >= 0}
    assert set(pairs) == apart_at_home
    for q in SQUARE[:200]:
        every = bodies.gaps(robot, q)
        deep = {pair: -float(every[pair]) for pair in pairs if every[pair] < -1e-9}
        assert bodies.overlaps(robot, q) == pytest.approx(deep)


def test_links_that_share_a_joint_overlap_at_home_and_count_for_nothing() -> None:
    robot = load_robot("two-links-on-a-table")
    links = ("upper arm", "forearm")
    assert bodies.gaps(robot, robot.home)[links] < 0
    assert links not in bodies.overlap_pairs(robot)


def test_an_arm_that_leaves_every_plane_has_no_overlaps_to_show() -> None:
    assert bodies.overlap_pairs(load_robot("ur5")) == []
