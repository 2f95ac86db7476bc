"""Workspace, traversals and sampling (Figures 7 to 11), by brute force and printed values."""

from dataclasses import replace
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from shapely import LineString

from qbound import (
    Workspace,
    keeps_clear,
    load_robot,
    planar_arm,
    polygon,
    position,
    sample,
    traverse,
    window_region,
)
from qbound.traversal import asymmetry, neighbour_orders, simple_orders
from support.chains import ANGLES

ROBOT = load_robot("minervabot-v2")
REGION, ARM = window_region(ROBOT), planar_arm(ROBOT)
SHRUNK = polygon.scaled(REGION.polygon, 0.95, polygon.centroid(REGION.polygon))


@given(ANGLES, ANGLES)
def test_postures_bring_the_tool_to_its_point(q1, q2):
    point = ARM.tool([q1, q2])[[0, 2]]
    found = ARM.postures(point)
    assert len(found) in (1, 2)
    assert_allclose(ARM.tool(found)[:, [0, 2]], np.broadcast_to(point, (len(found), 2)), atol=1e-6)
    gap = np.abs(np.exp(1j * found) - np.exp(1j * np.array([q1, q2]))).max(axis=-1)
    assert gap.min() < 1e-6
    other = ARM.other_posture([q1, q2])
    assert_allclose(ARM.tool(other)[[0, 2]], point, atol=1e-10)


def test_the_arm_is_stretched_where_the_jacobian_has_no_inverse():
    assert np.degrees(ARM.stretched) == pytest.approx(-59.9993, abs=1e-4)
    assert np.sqrt(ARM.mean + ARM.swing) == pytest.approx(np.hypot(15, 25.98) + 25, abs=1e-12)
    q = np.stack([np.full(9, 0.3), ARM.stretched + np.linspace(-0.4, 0.4, 9)], axis=-1)
    assert ARM.singular(q).tolist() == [False] * 4 + [True] + [False] * 4
    assert ARM.postures([60.0, 22.5]).shape == (0, 2)


def test_on_the_axis_of_joint_1_every_q1_brings_the_folded_tool_there():
    """One posture was returned, at q1 of no meaning; links of other lengths do not get there."""
    even = replace(ROBOT.point("3"), at=[float(np.hypot(15, 25.98)), 0.0, 0.0])
    points = tuple(even if point.name == "3" else point for point in ROBOT.points)
    with pytest.raises(ValueError, match="axis of joint 1"):
        planar_arm(replace(ROBOT, points=points)).postures([0.0, 22.5])
    assert ARM.postures([0.0, 22.5]).shape == (0, 2)


def test_an_offset_along_the_axes_changes_nothing_in_the_plane():
    aside = replace(ROBOT.point("3"), at=[25.0, 4.0, 0.0])
    points = tuple(aside if point.name == "3" else point for point in ROBOT.points)
    arm = planar_arm(replace(ROBOT, points=points))
    assert_allclose([arm.mean, arm.swing, arm.stretched], [ARM.mean, ARM.swing, ARM.stretched])
    assert_allclose(arm.postures([40.0, 48.48]), ARM.postures([40.0, 48.48]), atol=1e-9)
    assert_allclose(arm.reach([0.3, 0.4]), ARM.reach([0.3, 0.4]))


def test_the_workspace_is_what_random_points_find():
    reached = Workspace(REGION)
    assert reached.area == pytest.approx(3395.370403, abs=1e-5)
    assert reached.covered_twice == pytest.approx(2465.035136, abs=1e-5)
    assert reached.area_error < 1e-9
    assert reached.covered_twice_error < 1e-9
    points = np.random.default_rng(4).uniform([-56, -33.5], [56, 78.5], (4000, 2))
    times = np.array([REGION.contains(shifted(ARM.postures(p))).sum() for p in points])
    for found, least in ((reached.area, 1), (reached.covered_twice, 2)):
        share = (times >= least).mean()
        error = 112**2 * np.sqrt(share * (1 - share) / len(points))
        assert abs(112**2 * share - found) < 4 * error


def shifted(q):
    """Shift configurations by full turns into the box."""
    low = REGION.box.lower
    return low + (q - low) % (2 * np.pi)


def test_the_workspace_of_a_box_that_is_one_turn_is_a_ring():
    free = replace(
        ROBOT,
        boundaries=(),
        joints=tuple(replace(joint, limits=(-np.pi, np.pi)) for joint in ROBOT.joints),
    )
    reached = Workspace(window_region(free))
    bar, link = np.hypot(15, 25.98), 25.0
    ring = np.pi * ((bar + link) ** 2 - (bar - link) ** 2)
    assert_allclose([reached.area, reached.covered_twice], ring, rtol=1e-12)


def test_other_arms_have_no_polar_coordinates():
    for joint in (
        replace(ROBOT.joints[1], axis=[0, 0, 1]),
        replace(ROBOT.joints[1], kind="prismatic", limits=(0.0, 1.0)),
    ):
        with pytest.raises(ValueError, match=r"two joints that turn about y.*cspace"):
            planar_arm(replace(ROBOT, joints=(ROBOT.joints[0], joint)))


# --- traversals


@given(st.lists(st.tuples(ANGLES, ANGLES), min_size=2, max_size=5), st.booleans())
def test_a_path_is_straight_from_stop_to_stop(points, closed):
    path = traverse(ROBOT, points, closed=closed, step=0.05)
    ends = [*points, points[0]] if closed else points
    assert_allclose(path.q[path.stops], ends, atol=1e-12)
    assert np.abs(np.diff(path.q, axis=0)).max() <= 0.05 + 1e-12
    assert_allclose(path.tool, position(ROBOT)(path.q)[:, [0, 2]], atol=1e-12)
    for start, end in pairwise(path.stops):
        step = np.diff(path.q[start : end + 1], axis=0)
        assert_allclose(step, np.broadcast_to(step[0], step.shape), atol=1e-12)


def test_paths_of_figures_7_to_9():
    around = traverse(ROBOT, SHRUNK, closed=True)
    assert len(polygon.self_crossings(around.tool)) > 0  # six points: not structured
    for order in ((5, 0, 1, 2, 3), (2, 3, 4, 5, 0)):
        assert len(polygon.self_crossings(traverse(ROBOT, SHRUNK[list(order)]).tool)) == 0
    assert len(neighbour_orders(6, 5)) == 12


def crossed(p, a, b):
    """Tell whether two segments cross, by the signs of four areas."""

    def side(i, j, k):
        return np.sign(np.linalg.det([p[j] - p[i], p[k] - p[i]]))

    return side(*a, b[0]) * side(*a, b[1]) < 0 and side(*b, a[0]) * side(*b, a[1]) < 0


@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=4, max_size=8))
def test_crossings_are_those_of_pairs_of_segments(points):
    p = np.array(points, dtype=float) + 0.01 * np.sin(np.arange(2 * len(points))).reshape(-1, 2)
    pieces = [(i, i + 1) for i in range(len(p) - 1)]
    pairs = [(a, b) for k, a in enumerate(pieces) for b in pieces[k + 2 :]]
    expected = sum(crossed(p, a, b) for a, b in pairs)
    assert len(polygon.self_crossings(p)) == expected


def test_orders_without_crossing_are_shapelys():
    """Of 360 orders of five of the six points, each once; their tool paths are simple lines."""
    found = simple_orders(ROBOT, SHRUNK, 5)
    expected = [
        order
        for order in permutations(range(6), 5)
        if order[0] < order[-1]
        and LineString(traverse(ROBOT, SHRUNK[list(order)], step=0.03).tool).is_simple
    ]
    assert found == expected
    assert 0 < len(found) < 360


def test_hausdorff_distance_is_that_of_dense_points():
    random = np.random.default_rng(9)
    one, other = random.uniform(-5, 5, (2, 6, 2))
    t = np.linspace(0, 1, 2001)[:, None, None]
    dense = [np.concatenate(p[:-1] + t * np.diff(p, axis=0)) for p in (one, other)]
    found = 0.0
    for corners, path in ((one, dense[1]), (other, dense[0])):
        apart = np.linalg.norm(corners[:, None] - path, axis=-1).min(axis=1)
        found = max(found, apart.max())
    assert polygon.hausdorff(one, other) == pytest.approx(found, abs=0.01)


def test_paths_of_the_symmetric_arm_are_mirror_images_and_the_printed_ones_are_not():
    robots = {name: load_robot(f"minervabot-v2{name}") for name in ("", "-symmetric")}
    found = {}
    for name, robot in robots.items():
        p = window_region(robot).polygon
        p = polygon.scaled(p, 0.95, polygon.centroid(p))
        found[name] = asymmetry(robot, p[[5, 0, 1, 2, 3]], p[[2, 3, 4, 5, 0]])
    assert found["-symmetric"] < 1e-2
    assert found[""] == pytest.approx(0.797, abs=1e-3)


# --- sampling


def test_a_sample_is_even_and_its_fraction_near_the_area():
    def in_region(robot, q):
        return window_region(robot).contains(q)

    drawn = sample(ROBOT, 40_000, in_region, seed=3)
    assert np.abs(drawn.q).max() <= np.pi
    assert_allclose(drawn.q.mean(axis=0), 0, atol=4 * np.pi / np.sqrt(3 * 40_000))
    exact = REGION.area / (2 * np.pi) ** 2
    assert abs(drawn.fraction - exact) < 4 * drawn.standard_error
    again = sample(ROBOT, 40_000, keeps_clear, seed=3)
    assert np.array_equal(again.q, drawn.q)
    assert_allclose(again.tool, position(ROBOT)(again.q))


def test_ranges_are_limits_or_a_turn():
    sliding = replace(ROBOT.joints[1], kind="prismatic", limits=(2.0, 3.0))
    arm = replace(ROBOT, joints=(ROBOT.joints[0], sliding))
    q = sample(arm, 1000, keeps_clear).q
    assert 2.0 <= q[:, 1].min() < 2.1
    assert 2.9 < q[:, 1].max() <= 3.0
    endless = replace(arm, joints=(ROBOT.joints[0], replace(sliding, limits=None)))
    with pytest.raises(ValueError, match="q2 slides and has no limits"):
        sample(endless, 10, keeps_clear)
