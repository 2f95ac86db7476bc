"""Signed distances of bodies, against shapely and against forward kinematics in space."""

from __future__ import annotations

import tomllib
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cspace.boundary.contacts import body_contacts
from cspace.boundary.evaluator import evaluator
from cspace.boundary.separation import BodyMargins, nearest_features
from cspace.model.robot import Body, BodyPair, Capsule, Disc, HalfSpace, Polygon, Robot
from cspace.model.robotfile import parse_robot
from cspace.region import clearance_problem
from engine_support import body_scenes
from engine_support.arms import in_xz, three_joints

SQUARE = [(0, 0), (2, 0), (2, 2), (0, 2)]

# --- two cores ------------------------------------------------------------------------------------

SLIDES = parse_robot(
    tomllib.loads("""
schema = 1
name = "two slides"
length_unit = "m"
angle_unit = "rad"
home = { x = 0, y = 0 }
tool = "tip"
point = [{ name = "tip", frame = "2", at = [0, 0, 0] }]

[[joint]]
name = "x"
type = "prismatic"
parent = "base"
frame = "1"
origin = [0, 0, 0]
axis = [1, 0, 0]
limits = [-99, 99]

[[joint]]
name = "y"
type = "prismatic"
parent = "1"
frame = "2"
origin = [0, 0, 0]
axis = [0, 1, 0]
limits = [-99, 99]
""")
)


def with_cores(pairs) -> Robot:
    """Two slides that carry the second core of each pair past the first one."""
    bodies, obstacles, boundaries = [], [], []
    for n, (one, other) in enumerate(pairs):
        obstacles.append(Body(f"one {n}", "base", shape(one)))
        bodies.append(Body(f"other {n}", "2", shape(other)))
        names = obstacles[-1].name, bodies[-1].name
        boundaries.append(BodyPair(str(n), names))
    return replace(
        SLIDES, bodies=tuple(bodies), obstacles=tuple(obstacles), boundaries=tuple(boundaries)
    )


def shape(corners) -> Disc | Capsule | Polygon:
    """A core without a radius."""
    places = np.insert(np.asarray(corners, dtype=float), 2, 0.0, axis=1)
    if len(places) > 2:
        return Polygon(places)
    return Disc(places[0], 0.0) if len(places) == 1 else Capsule(*places, 0.0)


def signed_distance(one, other, moved=(0.0, 0.0)) -> np.ndarray:
    """The signed distance of two cores where the second one is moved, shape (..., 2) to (...)."""
    return BodyMargins(with_cores([(one, other)])).margins(moved)[..., 0]


def core(rng: np.random.Generator, whole: bool) -> np.ndarray:
    """A point, a segment or a convex polygon, perhaps in whole numbers, either way round."""
    count = rng.integers(1, 6)
    spread = rng.integers(-3, 4, (3 * count, 2)) if whole else rng.uniform(-3, 3, (3 * count, 2))
    corners = spread.astype(float)
    hull = shapely.MultiPoint(corners).convex_hull
    if count < 3 or hull.geom_type != "Polygon":
        return corners[: min(count, 2)]
    return np.array(hull.exterior.coords)[:-1][:: rng.choice([-1, 1])]


def as_shapely(corners: np.ndarray) -> shapely.Geometry:
    return (shapely.Point, shapely.LineString, shapely.Polygon)[min(len(corners), 3) - 1](
        corners[0] if len(corners) == 1 else corners
    )


def by_shapely(p: np.ndarray, r: np.ndarray) -> float:
    """The distance; of an overlap, that of 0 from the outline of the Minkowski difference."""
    if (distance := shapely.distance(as_shapely(p), as_shapely(r))) > 0:
        return distance
    difference = shapely.MultiPoint((p[:, None] - r[None]).reshape(-1, 2)).convex_hull
    flat = difference.geom_type != "Polygon"
    return 0.0 if flat else -shapely.distance(difference.exterior, shapely.Point(0, 0))


@pytest.mark.parametrize("whole", [False, True])
def test_a_signed_distance_is_what_shapely_finds(whole) -> None:
    rng = np.random.default_rng(7)
    pairs = [(core(rng, whole), core(rng, whole)) for _ in range(600)]
    found = BodyMargins(with_cores(pairs)).margins([0.0, 0.0])
    assert_allclose(found, [by_shapely(p, r) for p, r in pairs], rtol=0, atol=1e-13)
    assert min((found < 0).sum(), (found > 0).sum()) > 120
    assert not whole or (found == 0).sum() > 40


@pytest.mark.parametrize(
    ("one", "other", "distance"),
    [
        pytest.param([(1, 1)], [(1, 1)], 0, id="coincident points"),
        pytest.param([(1, 0)], [(0, 0), (2, 0)], 0, id="a point on a segment"),
        pytest.param([(4, 0)], [(0, 0), (2, 0)], 2, id="a point beyond a segment"),
        pytest.param([(2, 2)], SQUARE, 0, id="a point on a corner"),
        pytest.param([(1.5, 1)], SQUARE, -0.5, id="a point inside"),
        pytest.param([(0, 0), (2, 0)], [(1, 0), (3, 0)], 0, id="segments that share a part"),
        pytest.param([(0, 0), (2, 0)], [(3, 0), (4, 0)], 1, id="segments on one line"),
        pytest.param([(0, 0), (2, 0)], [(1, 3), (4, 3)], 3, id="parallel segments"),
        pytest.param([(-1, 0), (1, 0)], [(0, -2), (0, 2)], -1, id="crossing segments"),
        pytest.param([(1, 1), (1, 1)], [(1, 1), (4, 1)], 0, id="a segment of no length"),
        pytest.param(SQUARE, [(-1, 1), (5, 1)], -1, id="a segment through a square"),
        pytest.param(SQUARE, [(2, 2), (3, 2), (3, 3)], 0, id="touching corners"),
        pytest.param(SQUARE, [(2, 0), (4, 0), (4, 2), (2, 2)], 0, id="edge on edge"),
        pytest.param(SQUARE, [(0, 2), (2, 2), (2, 0), (0, 0)], -2, id="the same square"),
    ],
)
def test_degenerate_places_are_exact(one, other, distance) -> None:
    assert signed_distance(one, other) == distance
    assert signed_distance(other, one) == distance
    robot = with_cores([(one, other)])
    found = nearest_features(robot, robot.boundaries[0], [0.0, 0.0])
    assert found.distance == distance
    apart = found.places[1] - found.places[0]
    assert np.hypot(*apart) == pytest.approx(abs(distance), abs=1e-15)


SEEDS = st.integers(0, 2**31)


@given(SEEDS, st.booleans())
def test_the_way_out_parts_two_cores_and_the_nearest_places_lie_on_them(seed, whole) -> None:
    rng = np.random.default_rng(seed)
    p, r = core(rng, whole), core(rng, whole)
    robot = with_cores([(p, r)])
    found = nearest_features(robot, robot.boundaries[0], [0.0, 0.0])
    both = robot.obstacles[0], robot.bodies[0]
    for body, feature, place in zip(both, found.features, found.places, strict=True):
        corners, (kind, number) = body.parts[0].corners[:, :2], feature.split()
        ends = corners[[int(number), (int(number) + (kind == "edge")) % len(corners)]]
        assert signed_distance(ends, place[None]) == pytest.approx(0, abs=1e-13)
    way = np.diff(found.places, axis=0)[0]
    assert np.hypot(*way) == pytest.approx(abs(found.distance), abs=1e-13)
    if abs(found.distance) < 1e-9:
        return  # touching bodies have no way between their nearest places
    direction = way / found.distance
    away = np.array([0.5, 1.0]) - min(found.distance, 0)
    parted = signed_distance(p, r, away[:, None] * direction)
    assert (parted >= away + min(found.distance, 0) - 1e-13).all()


def test_a_speck_beside_a_thing_that_is_a_billion_times_larger_has_edges() -> None:
    """Each outline is measured by itself: in one stack the speck passed for rounding."""
    large = 900.0 * np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    speck = [0.8, 1.0] + 1e-7 * np.array([[0, 0], [0, 10], [1, 10], [1, 0]])
    places = np.random.default_rng(4).uniform(-2, 2, (50, 2))
    stacked = BodyMargins(with_cores([(large, [(0, 0)]), (speck, [(0, 0)])])).margins(places)
    assert_array_equal(stacked[:, 0], signed_distance(large, [(0, 0)], places))
    assert_array_equal(stacked[:, 1], signed_distance(speck, [(0, 0)], places))
    assert_allclose(stacked[:, 1], [by_shapely(speck, q[None]) for q in places], atol=1e-13)


# --- the bodies of a robot ------------------------------------------------------------------------

SCENES = [body_scenes.robot(body_scenes.scene(k)) for k in (*range(8), *range(12, 20))]


def named(robot: Robot) -> str:
    return robot.name


def poses(robot: Robot, count: int) -> np.ndarray:
    """Configurations at random, within the limits or over a turn."""
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    return np.random.default_rng(0).uniform(*ends.T, (count, 2))


@pytest.mark.parametrize("robot", SCENES[::3], ids=named)
@pytest.mark.parametrize("at_least", [0.0, 0.1, -0.05])
def test_to_be_separated_is_to_have_a_margin_above(robot, at_least) -> None:
    separation = BodyMargins(robot)
    q = poses(robot, 1500).reshape(3, 500, 2)
    margins = separation.margins(q)
    sure = np.abs(margins - at_least) > 1e-12
    found = separation.separated(q, at_least)
    assert_array_equal(found[sure], (margins > at_least)[sure])
    assert_array_equal(separation.all_separated(q, at_least), found.all(axis=-1))
    each = np.where(np.arange(len(separation.names)) % 2, at_least, -1e9)
    assert_array_equal(separation.separated(q, each)[..., 1::2], found[..., 1::2])
    assert separation.separated(q, each)[..., ::2].all()


# --- columns of an evaluator ----------------------------------------------------------------------


def long_arm() -> Robot:
    """Three joints with points, spheres, limits, bodies, an obstacle: boundaries of all types."""
    arm, rod = three_joints(), Capsule(np.zeros(3), np.array([0.8, 0.0, 0.0]), 0.05)
    links = [Body(f"link {j}", joint.frame, rod) for j, joint in enumerate(arm.joints)]
    wall = HalfSpace("floor for all", "", np.array([0.0, 0.0, 1.0]), -0.6, body="link 2")
    pair = BodyPair("link 0, link 2", ("link 2", "link 0"), 0.02)
    first, *rest = arm.boundaries
    return replace(
        arm,
        bodies=tuple(links),
        obstacles=(Body("pillar", arm.base, in_xz([(1, 0), (1.5, 0), (1.2, 2)])),),
        boundaries=(first, wall, *rest, pair),
        collisions=True,
        allowed=(frozenset(("link 0", "link 1")), frozenset(("link 1", "link 2"))),
    )


def test_columns_stand_in_the_order_of_what_is_used_then_limits() -> None:
    robot = long_arm()
    compiled, count = evaluator(robot), len(robot.used)
    assert compiled.names[:count] == tuple(boundary.name for boundary in robot.used)
    assert all(name.endswith(("er",)) for name in compiled.names[count:])
    q = np.random.default_rng(2).uniform(-2, 2, (400, 3))
    margins = compiled.margins(q)
    bodies = BodyMargins(robot)
    expected = dict(zip(bodies.names, bodies.margins(q).T, strict=True))
    points = evaluator(
        replace(long_arm(), bodies=(), obstacles=(), boundaries=three_joints().boundaries)
    )
    expected |= dict(zip(points.names, points.margins(q).T, strict=True))
    assert set(expected) == set(compiled.names)
    for name, column in zip(compiled.names, margins.T, strict=True):
        assert_allclose(column, expected[name], rtol=0, atol=1e-12, err_msg=name)
    assert_allclose(compiled.margins(q[7]), margins[7], rtol=0, atol=1e-13)
    assert_array_equal(compiled.feasible(q), (margins >= 0).all(axis=-1))
    assert 0 < compiled.feasible(q).mean() < 1
    assert compiled.sizes.shape == compiled.margin_rounding.shape == (len(compiled.names),)


# --- the features that are nearest ----------------------------------------------------------------


def test_points_have_no_separation() -> None:
    robot = three_joints()
    with pytest.raises(ValueError, match="it is about points"):
        BodyMargins(robot, boundaries=robot.boundaries)
    with pytest.raises(ValueError, match="it is about points"):
        nearest_features(robot, robot.boundaries[0], robot.home)


@pytest.mark.parametrize("robot", SCENES[::2], ids=named)
def test_the_nearest_features_show_the_margin(robot) -> None:
    separation = BodyMargins(robot)
    for q in poses(robot, 2):
        for boundary, margin in zip(separation.boundaries, separation.margins(q), strict=True):
            found = nearest_features(robot, boundary, q)
            kept = boundary.clearance if isinstance(boundary, BodyPair) else 0.0
            assert found.distance - kept == pytest.approx(margin, abs=1e-12)
            assert np.hypot(*np.diff(found.places, axis=0)[0]) == pytest.approx(
                abs(found.distance), abs=1e-12
            )


def test_features_are_named_with_the_part_where_a_body_has_several() -> None:
    robot = replace(
        body_scenes.robot(body_scenes.whole(0, "RR", "xz", 1, "deg")),
        bodies=(Body("link 1", "L1", Capsule(np.zeros(3), np.array([2.0, 0, 0]), 0.5)),),
        obstacles=(
            Body("box", "base", in_xz([(3, -1), (5, -1), (5, 1), (3, 1)])),
            Body("angle", "base", in_xz([(0, 5), (4, 5), (4, 6), (1, 6), (1, 9), (0, 9)])),
        ),
        boundaries=(HalfSpace("floor", "", np.array([0, 0, 1.0]), -2.0, body="link 1"),),
        allowed=(),
    )
    box, angle, floor = (
        nearest_features(robot, robot.boundary(name), [0.0, 0.0])
        for name in ("link 1, box", "link 1, angle", "floor")
    )
    assert (box.names, box.features) == (("link 1", "box"), ("corner 1", "edge 3"))
    assert (box.distance, box.places.tolist()) == (0.5, [[2.5, 0], [3, 0]])
    assert angle.features[1].startswith("part ")
    assert angle.distance == pytest.approx(4.5)
    assert (floor.names, floor.features[1], floor.distance) == (("link 1", "floor"), "edge", 1.5)


# --- pairs that never meet ------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, 7, 8])
def test_a_region_has_the_features_of_all_pairs_of_parts_but_those_that_never_touch(seed) -> None:
    """Seeds have joints that turn and slide in all four combinations."""
    kinds = ("RR", "RP", "PR", "PP")[seed % 4]
    robot = body_scenes.robot(body_scenes.ordinary(seed, kinds, obstacles=60))
    problem = clearance_problem(robot)
    few, every = problem.contacts, body_contacts(robot, {}, problem.bodies)
    called = [
        list(zip(each.boundaries, map(tuple, each.parts.tolist()), strict=True))
        for each in (few, every)
    ]
    kept = np.array([pair in set(called[0]) for pair in called[1]])
    rows = kept[every.pair]
    assert (np.abs(few.forms - every.forms[rows]) <= few.errors).all()
    assert (np.abs(few.sides - every.sides[rows]) <= few.side_errors).all()
    assert list(few.names) == [every.names[row] for row in np.flatnonzero(rows)]
    gone = [b for b in problem.bodies if b.name not in few.boundaries]
    q = poses(robot, 4000)
    assert gone
    assert BodyMargins(robot, boundaries=gone).margins(q).min() > 0
