"""The feasible joint region (Figures 4 to 6): corners, area, centroid, scaling; by brute force."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from qbound import (
    HalfSpace,
    Joint,
    Point,
    Robot,
    clearance,
    clearance_region,
    keeps_clear,
    largest_scale,
    load_robot,
    polygon,
    window_region,
)
from qbound.quadrature import integral
from qbound.scaling import least_along, least_on_edges
from qbound.symbols import offset_values, with_symbols, with_values
from qbound.windows import LOWER, UPPER, Bound
from support.plain_judge import Judge

ROBOT = load_robot("minervabot-v2")
HEIGHT = clearance(ROBOT, ROBOT.boundary("B7"))
SYMBOLIC, VALUES = with_symbols(ROBOT), offset_values(ROBOT)


@st.composite
def arms(draw):
    """The paper's arm with every offset moved by up to 0.5 cm."""
    moves = draw(st.lists(st.integers(-50, 50), min_size=len(VALUES), max_size=len(VALUES)))
    moved = {s: x + k / 100 for (s, x), k in zip(VALUES.items(), moves, strict=True)}
    return with_values(SYMBOLIC, moved)


def table(robot):
    """Return what the judge reads of a robot."""
    walls = [
        {"type": "half-space", "point": b.point, "normal": b.normal, "offset": b.offset}
        for b in robot.used_half_spaces
    ]
    pairs = [{"type": "pair", "points": b.points} for b in robot.used_pairs]
    return {
        "joint": [{"origin": joint.origin} for joint in robot.joints],
        "point": [{"name": p.name, "frame": p.frame, "at": p.at} for p in robot.points],
        "boundary": pairs + walls,
        "tool": robot.tool,
    }


def test_six_corners_in_closed_form():
    region = window_region(ROBOT)
    corners = [
        (-94.073421, -162.303209, "beta_{4,1,2}", "beta_{7,3,2}"),
        (76.224073, -162.303209, "beta_{4,1,2}", "beta_{1,3,1}"),
        (76.224073, -69.798108, "beta_{1,3,1}", "beta_{7,3,1}"),
        (33.718698, 44.381300, "beta_{3,3,1}", "beta_{7,3,1}"),
        (-136.239293, 44.381300, "beta_{3,3,1}", "beta_{2,1,2}"),
        (-136.239293, -50.170714, "beta_{2,1,2}", "beta_{7,3,2}"),
    ]
    for corner, (q1, q2, *labels) in zip(region.corners, corners, strict=True):
        assert_allclose(np.degrees(corner.q), [q1, q2], atol=1e-6)
        assert [bound.label for bound in corner.bounds] == labels
    assert len(region.bounds) == 6
    assert polygon.area(region.polygon) == pytest.approx(11.917299095, abs=1e-9)
    assert region.area == pytest.approx(11.75449489116, abs=1e-10)
    assert region.area_error < 1e-12
    assert_allclose(np.degrees(region.centroid), [-30.198086, -59.051246], atol=1e-6)
    assert (np.abs(region.centroid_error) < 1e-12).all()


@given(arms())
def test_corners_lie_on_their_two_bounds_or_are_refused(robot):
    region = window_region(robot)
    try:
        corners = region.corners
    except ValueError:
        with pytest.raises(ValueError, match="cspace"):
            _ = region.corners
        return
    sides = dict(zip(region.box.lower_bounds, region.box.lower, strict=True))
    sides |= dict(zip(region.box.upper_bounds, region.box.upper, strict=True))
    for corner in corners:
        for bound in corner.bounds:
            on_side = bound in sides and min(abs(corner.q - sides[bound])) < 1e-12
            assert on_side or abs(region.forms(corner.q)[0]) < 1e-11
        assert region.contains(corner.q + 1e-7 * (region.centroid - corner.q))
    assert_allclose(region.area_by_nodes(60), region.area, rtol=1e-5)  # slow near a fold


@given(arms())
def test_fibres_along_either_joint_give_one_area(robot):
    region = window_region(robot)
    low, high = region.box.lower[1], region.box.upper[1]
    other = integral(lambda q2: region.fibres(1, q2).length, low, high)
    assert_allclose(region.area, other.value, rtol=1e-12)


def test_a_curve_of_table_6_lies_on_its_form_and_ends_where_it_folds():
    region = window_region(ROBOT)
    q1 = np.linspace(-np.pi, np.pi, 101)
    for k, sign in ((UPPER, -1), (LOWER, 1)):
        q2 = region.curve(Bound("B7", 3, k), q1)
        there = ~np.isnan(q2)
        assert 0 < there.sum() < len(q1)
        q = np.stack([q1, q2], axis=-1)[there]
        assert_allclose(HEIGHT(q), 0, atol=1e-11)
        assert (sign * HEIGHT.derivative(1)(q) >= 0).all()
    with pytest.raises(ValueError, match=r"beta_{1,3,1} is not a bound of a cut"):
        region.curve(Bound("B1", 3, UPPER), 0.0)


def test_points_on_the_curves_lessen_the_depth_and_tangents_keep_the_limit():
    region = window_region(ROBOT)
    depths = [
        -least_on_edges(HEIGHT, region.with_points(n, tangents=False)).value for n in (2, 3, 9)
    ]
    assert_allclose(depths, [3.0230863742, 1.4078378989, 0.2405466721], atol=1e-9)
    for n in (2, 5):
        inner = region.with_points(n, tangents=True)
        assert least_on_edges(HEIGHT, inner).value > -1e-11


def test_a_hole_and_a_fold_inside_the_box_are_refused():
    # The tool stays left of x = 55 (it reaches 54.9993 from joint 1): nothing is cut.
    whole = replace(
        ROBOT, boundaries=(*ROBOT.boundaries[:4], HalfSpace("W", "3", [-1, 0, 0], -55.0))
    )
    region = window_region(whole)
    assert len(region.corners) == 4
    assert_allclose(region.area, np.prod(region.box.upper - region.box.lower), rtol=1e-14)
    # Left of x = 54 a hole opens around the stretched pose, far from the sides of the box.
    hole = window_region(
        replace(ROBOT, boundaries=(*ROBOT.boundaries[:4], HalfSpace("W", "3", [-1, 0, 0], -54.0)))
    )
    assert hole.area < region.area - 0.01
    with pytest.raises(ValueError, match=r"inside the box.*cspace"):
        _ = hole.corners


def test_a_region_without_half_spaces_is_the_box():
    region = window_region(replace(ROBOT, boundaries=ROBOT.boundaries[:4]))
    assert_allclose(region.polygon[[0, 2]], [region.box.lower, region.box.upper])
    assert region.contains(region.box.lower)


def test_an_empty_region_says_so():
    wall = HalfSpace("W", "3", [0, 0, 1], 100.0)  # higher than the tool comes
    region = window_region(replace(ROBOT, boundaries=(*ROBOT.boundaries[:4], wall)))
    assert region.area == 0
    for ask in ("polygon", "centroid"):
        with pytest.raises(ValueError, match="the region is empty: W cut the whole box"):
            getattr(region, ask)


def test_a_third_boundary_on_link_2_cuts_too():
    corner = Point("14", "2", [25.0, 0.0, 5.25])
    wall = HalfSpace("B8", "14", [0, 0, 1], 11.32)
    arm = replace(ROBOT, points=(*ROBOT.points, corner), boundaries=(*ROBOT.boundaries, wall))
    region = window_region(arm)
    q = np.random.default_rng(3).uniform(-1.5 * np.pi, np.pi, (5000, 2))
    assert np.array_equal(region.contains(q), Judge(table(arm)).inside(*q.T))
    assert region.area < window_region(ROBOT).area


def test_a_joint_that_slides_has_a_region():
    sliding = replace(ROBOT.joints[1], kind="prismatic", axis=[1, 0, 0], limits=(-3.0, 20.0))
    arm = replace(ROBOT, joints=(ROBOT.joints[0], sliding))
    region = window_region(arm)
    q1, q2 = (
        np.linspace(low, high, 801)
        for low, high in zip(region.box.lower, region.box.upper, strict=True)
    )
    q = np.stack(np.meshgrid((q1[1:] + q1[:-1]) / 2, (q2[1:] + q2[:-1]) / 2), axis=-1)
    # The tool turns with q1 about (0, 22.5): x forward, z up, by plain sines.
    x, z = 15 + 25 + q[..., 1], 25.98
    height = 22.5 + z * np.cos(q[..., 0]) - x * np.sin(q[..., 0]) - 11.32
    box = np.prod(region.box.upper - region.box.lower)
    assert_allclose(region.area, (height >= 0).mean() * box, rtol=1e-3)
    assert_allclose(region.area_by_nodes(40), region.area, rtol=1e-10)


def test_a_cut_that_enters_and_leaves_through_one_side_has_its_corners():
    # A slide that turns has its tip at z = 20 - (15 + q2) sin q1 and keeps above z = 2.
    turn = Joint("q1", "0", "1", [0, 0, 20], [0, 1, 0], limits=(-1.4, 3.0))
    slide = Joint("q2", "1", "2", [10, 0, 0], [1, 0, 0], "prismatic", limits=(0.0, 20.0))
    floor = HalfSpace("floor", "tip", [0, 0, 1], 2.0)
    tip = Point("tip", "2", [5, 0, 0])
    region = window_region(Robot("s", "cm", (turn, slide), (tip,), (floor,), "tip", (0.0, 5.0)))
    q1 = np.arcsin(18 / 35)
    corners = [(-1.4, 0), (3.0, 0), (3.0, 20), (np.pi - q1, 20), (q1, 20), (-1.4, 20)]
    assert_allclose(region.polygon, corners, atol=1e-12)
    # Without the floor 4.4 x 20; it takes 20 - (18 / sin q1 - 15) where that is positive.
    t = np.linspace(q1, np.pi - q1, 200_001)
    taken = np.trapezoid(35 - 18 / np.sin(t), t)
    assert_allclose(region.area, 4.4 * 20 - taken, rtol=1e-9)
    assert_allclose(region.area_by_nodes(60), region.area, rtol=1e-12)
    assert region.with_points(5, tangents=False).shape == (9, 2)


@pytest.mark.parametrize("held", [-1, 2])
def test_a_fibre_holds_the_first_joint_or_the_second(held):
    with pytest.raises(ValueError, match=f"have the numbers 0 and 1, found {held}"):
        window_region(ROBOT).fibres(held, [0.0])


def test_clearances_cut_one_turn():
    region = clearance_region(ROBOT)
    q = np.random.default_rng(5).uniform(-np.pi, np.pi, (200_000, 2))
    kept = keeps_clear(ROBOT, q)
    assert np.array_equal(region.contains(q), kept)
    share, error = kept.mean(), np.sqrt(kept.mean() * (1 - kept.mean()) / len(q))
    assert abs(region.area / (2 * np.pi) ** 2 - share) < 4 * error
    with pytest.raises(ValueError, match="cspace"):
        _ = region.corners


def test_regions_are_of_two_joints():
    one = replace(
        ROBOT, joints=ROBOT.joints[:1], home=(0.0,), points=(), boundaries=(), tool="1", outlines=()
    )
    for find in (window_region, clearance_region):
        with pytest.raises(ValueError, match=r"has 1 joints.*cspace"):
            find(one)


# --- quadrature, polygons, scaling


@pytest.mark.parametrize(
    ("function", "expected"),
    [
        (np.exp, np.e - 1),
        (lambda x: np.sqrt(np.abs(x - 1 / 3)), 2 / 3 * ((1 / 3) ** 1.5 + (2 / 3) ** 1.5)),
        (lambda x: (x > 0.7071) * 1.0, 1 - 0.7071),
        (lambda x: np.stack([x, 0 * x], axis=-1), [0.5, 0.0]),
    ],
)
def test_integrals_are_within_their_errors(function, expected):
    found = integral(function, 0.0, 1.0)
    assert (np.abs(found.value - expected) <= found.error + 1e-16).all()
    assert (found.error < 1e-12).all()


def test_least_value_along_a_line_is_below_every_point_of_it():
    random = np.random.default_rng(7)
    for _ in range(20):
        start, end = random.uniform(-3, 3, (2, 2))
        least = least_along(HEIGHT, start, end)
        t = np.linspace(0, 1, 20_001)[:, None]
        dense = HEIGHT(start + t * (end - start)).min()
        assert least.value <= dense + 1e-12
        assert least.value == pytest.approx(dense, abs=1e-5)
        assert_allclose(HEIGHT(least.q), least.value)


@pytest.mark.parametrize("scale", [0.96, 0.95, 0.8])
def test_the_largest_scale_parts_feasible_from_infeasible(scale):
    p = window_region(ROBOT).polygon
    centre = polygon.centroid(p)
    found = largest_scale(HEIGHT, p, centre)
    assert found.scale == pytest.approx(0.964038, abs=1e-6)
    assert abs(HEIGHT(found.q)) < 1e-11
    assert least_on_edges(HEIGHT, polygon.scaled(p, scale, centre)).value > 0
    assert least_on_edges(HEIGHT, polygon.scaled(p, found.scale + 1e-6, centre)).value < 0
    assert_allclose(polygon.area(polygon.scaled(p, scale, centre)), scale**2 * polygon.area(p))


@pytest.mark.parametrize("way", range(0, 360, 15))
def test_every_scale_below_the_largest_is_feasible_and_the_next_is_not(way):
    # The tool keeps on one side of a line 20 cm from joint 1, in many directions.
    normal = [np.sin(np.radians(way)), 0, np.cos(np.radians(way))]
    wall = HalfSpace("W", "3", normal, float(22.5 * normal[2] - 20))
    form, p = clearance(ROBOT, wall), window_region(ROBOT).polygon
    centre = polygon.centroid(p)
    if form(centre) <= 0:
        with pytest.raises(ValueError, match="is its centre feasible"):
            largest_scale(form, p, centre)
        return
    found = largest_scale(form, p, centre)
    t = np.linspace(0, 1, 101)[:, None, None]
    edges = (p + t * (np.roll(p, -1, axis=0) - p)).reshape(-1, 2)
    for scale in np.linspace(0, min(found.scale, 3.0), 50):
        assert (form(polygon.scaled(edges, scale, centre)) > -1e-9).all()
    if np.isfinite(found.scale):
        assert abs(form(found.q)) < 1e-11
        assert least_on_edges(form, polygon.scaled(p, found.scale + 1e-6, centre)).value < 0


def test_a_boundary_that_is_never_met_has_an_infinite_scale():
    far = clearance(ROBOT, HalfSpace("W", "3", [0, 0, 1], -100.0))
    found = largest_scale(far, window_region(ROBOT).polygon, [0.0, 0.0])
    assert found.scale == np.inf
    assert np.isnan(found.q).all()


def test_a_centre_that_is_not_feasible_has_no_scale():
    p = window_region(ROBOT).polygon
    with pytest.raises(ValueError, match="is its centre feasible"):
        largest_scale(HEIGHT, p, [1.3, 1.0])
