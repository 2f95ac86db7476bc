"""The exact workspace: random arms against drawn places, polygons and closed forms.

By hand, for many more arms than the suite takes: `python engine/tests/test_workspace.py 1000`.
"""

import sys
from dataclasses import replace
from math import cos, hypot, pi, sin

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from shapely import LineString, Polygon, unary_union

from cspace import load_robot
from cspace.model.robot import JOINT_TYPES, HalfSpace, Joint, Pair, Point, Robot
from cspace.model.robotfile import parse_robot
from cspace.region import (
    NoHomeError,
    Problem,
    UnresolvedError,
    clearance_problem,
    solve,
    window_problem,
)
from cspace.workspace import layers
from cspace.workspace.areas import area_by_green, find_passage, find_workspace, overlap
from cspace.workspace.layers import crossing_distances, find_fibres
from cspace.workspace.planar import (
    AnyTurnError,
    NoPlanarWorkspaceError,
    planar_arm,
    postures,
)
from engine_support import body_scenes
from engine_support.robots import in_centimetres, mirror, random_robot, turned
from qbound import window_region
from qbound.forms import HarmonicForm

MINERVA = load_robot("minervabot-v2")
WINDOWS = window_problem(window_region(MINERVA))
seeds = st.integers(0, 10_000)

# --- random arms ---------------------------------------------------------------------------------


def random_arm(seed: int) -> Robot:
    """A random robot of the region's tests whose tool is on its last link."""
    robot = random_robot(seed)
    tool = replace(robot.points[0], frame="2")
    return replace(robot, points=(tool, *robot.points[1:]))


def box(robot: Robot) -> np.ndarray:
    return np.array([joint.limits or (-pi, pi) for joint in robot.joints])


def places_by_hand(robot: Robot, place: np.ndarray) -> list[np.ndarray]:
    """Every configuration within the limits that brings the tool to a place, by triangles.

    It shares no code with the package: circles and lines are intersected as in a school book.
    """
    one, two = robot.joints
    tool = robot.point(robot.tool).at[[0, 2]]
    start, arm = one.origin[[0, 2]], two.origin[[0, 2]]
    slide = [joint.axis[[0, 2]] for joint in robot.joints]
    found = []
    match robot.kinds:
        case ("revolute", "revolute"):
            found = [
                (q1, q2)
                for q2 in radii(place - start, arm, tool)
                for q1 in [angle(arm + turn(q2) @ tool, place - start)]
            ]
        case ("revolute", "prismatic"):
            inner, d = arm + tool, slide[1]
            roots = np.roots([1, 2 * inner @ d, inner @ inner - (place - start) @ (place - start)])
            found = [
                (angle(inner + q2 * d, place - start), q2) for q2 in roots.real[roots.imag == 0]
            ]
        case ("prismatic", "revolute"):
            d, n = slide[0], np.array([-slide[0][1], slide[0][0]])
            height = n @ (place - start - arm)
            size, lead = hypot(*tool), angle(np.array([1.0, 0.0]), tool)
            wanted = angle(np.array([1.0, 0.0]), n)
            if abs(height) < size:
                for sign in (1, -1):
                    q2 = wanted - lead + sign * np.arccos(height / size)
                    found.append((d @ (place - start - arm - turn(q2) @ tool), q2))
        case _:
            found = [tuple(np.linalg.solve(np.array(slide).T, place - start - arm - tool))]
    return [q for pair in found for q in within(robot, pair)]


def turn(q: float) -> np.ndarray:
    """Rotation about y, seen in x and z."""
    return np.array([[cos(q), sin(q)], [-sin(q), cos(q)]])


def angle(start: np.ndarray, end: np.ndarray) -> float:
    """Angle about y from one vector of the x-z plane to another."""
    return np.arctan2(end[0] * start[1] - end[1] * start[0], start @ end)


def radii(place: np.ndarray, arm: np.ndarray, tool: np.ndarray) -> list[float]:
    """Values of q2 at which |arm + R(q2) tool| is |place|: the cosine rule."""
    cosine = (place @ place - arm @ arm - tool @ tool) / (2 * hypot(*arm) * hypot(*tool))
    return [angle(tool, arm) + s * np.arccos(cosine) for s in (1, -1)] if abs(cosine) < 1 else []


def within(robot: Robot, pair) -> list[np.ndarray]:
    values = [
        [q] if joint.kind == "prismatic" else q + 2 * pi * np.arange(-3, 4)
        for joint, q in zip(robot.joints, pair, strict=True)
    ]
    low, high = box(robot).T
    grid = [np.array([a, b]) for a in values[0] for b in values[1]]
    return [q for q in grid if (q >= low).all() and (q <= high).all()]


@given(seeds)
def test_the_singular_form_is_the_determinant_of_the_jacobian(seed):
    robot = random_arm(seed)
    arm = planar_arm(robot)
    q = np.random.default_rng(seed).uniform(-3, 3, (50, 2))
    h = 1e-6
    steps = [(arm.tool(q + h * e) - arm.tool(q - h * e)) / (2 * h) for e in np.eye(2)]
    expected = steps[0][:, 0] * steps[1][:, 1] - steps[0][:, 1] * steps[1][:, 0]
    assert_allclose(arm.singular(q), expected, atol=1e-7)
    assert arm.singular.joints() in ((1,), ())
    assert_allclose(arm.tool(q), robot.frames(q).position("0", "p0", "0")[:, [0, 2]], atol=1e-12)


@given(seeds)
def test_postures_are_those_of_the_school_book(seed):
    robot = random_arm(seed)
    arm, rng = planar_arm(robot), np.random.default_rng(seed)
    ranges = clearance_problem(robot).ranges
    places = [*arm.tool(rng.uniform(*box(robot).T, (8, 2))), *rng.uniform(-6, 6, (8, 2))]
    for place in places:
        found = sorted(p.q.tolist() for p in postures(arm, place, ranges))
        expected = sorted(q.tolist() for q in places_by_hand(robot, place))
        assert_allclose(found, expected, atol=1e-6)
        for posture in postures(arm, place, ranges):
            assert_allclose(arm.tool(posture.q), place, atol=1e-9)
            assert posture.side * arm.singular(posture.q) >= 0


def check_areas(seed: int, n: int = 2000) -> None:
    """Union, doubly covered part and overlap against drawn places and postures by hand."""
    robot = random_arm(seed)
    arm, problem = planar_arm(robot), clearance_problem(robot)
    rng = np.random.default_rng(seed)
    reach = arm.tool(rng.uniform(*box(robot).T, (2000, 2)))
    low, high = reach.min(axis=0) - 0.2, reach.max(axis=0) + 0.2
    drawn = np.array([covered(robot, problem, p) for p in rng.uniform(low, high, (n, 2))])
    size = (high - low).prod()
    workspace = find_workspace(arm, problem, robot.home, every=True)
    mixed = overlap(arm, problem, robot.home, problem.ranges)
    areas = np.array([workspace.area, workspace.covered_twice, mixed])
    p = areas / size
    assert (np.abs(drawn.mean(axis=0) - p) <= 5 * np.sqrt(p * (1 - p) / n) + 8 / n).all()
    assert_allclose(sum(workspace.sides.values()), areas[0] + areas[1], rtol=1e-10, atol=1e-10)


def covered(robot: Robot, problem: Problem, place: np.ndarray) -> tuple[bool, bool, bool]:
    """Whether a place is reached safely, in two postures, and both safely and not."""
    found = places_by_hand(robot, place)
    safe = [bool((problem.forms(q) > 0).all()) for q in found]
    # Two configurations are one posture if they differ by full turns alone.
    heads = {round(cos(q[1] - found[0][1]), 6) for q, good in zip(found, safe, strict=True) if good}
    if problem.forms.kinds[1] == "prismatic":
        heads = {round(q[1], 6) for q, good in zip(found, safe, strict=True) if good}
    return any(safe), len(heads) > 1, any(safe) and not all(safe)


@pytest.mark.parametrize("seed", range(16))
def test_areas_are_those_of_drawn_places(seed):
    check_areas(seed)


@settings(max_examples=12)
@example(4456)  # the circle must be cut at an end of an interval, not at any place
@given(seeds)
def test_greens_theorem_and_the_integral_of_det_j_agree(seed):
    robot = random_arm(seed)
    arm = planar_arm(robot)
    workspace = find_workspace(arm, clearance_problem(robot), robot.home, every=True)
    for aspect in workspace.aspects:
        green = area_by_green(arm, aspect.region)
        assert_allclose(green, aspect.side * aspect.swept, rtol=1e-9, atol=1e-9)
        assert aspect.image <= aspect.swept * (1 + 1e-10) + 1e-10


@settings(max_examples=12)
@example(1017)  # a whole circle has no end at which to cut it
@given(seeds)
def test_the_workspace_does_not_change_when_seen_otherwise(seed):
    robot = random_arm(seed)
    areas = measured(robot)
    assert_allclose(measured(mirror(robot)), areas, rtol=1e-8, atol=1e-8)
    assert_allclose(measured(in_centimetres(robot)), 1e4 * areas, rtol=1e-8, atol=1e-4)
    for j in (j for j, kind in enumerate(robot.kinds) if kind == "revolute"):
        assert_allclose(measured(turned(robot, j, 0.7)), areas, rtol=1e-8, atol=1e-8)


def measured(robot: Robot) -> np.ndarray:
    found = find_workspace(planar_arm(robot), clearance_problem(robot), robot.home, every=True)
    return np.array([found.area, found.covered_twice])


@settings(max_examples=12)
@given(seeds)
def test_patches_add_up_to_the_areas(seed):
    robot = random_arm(seed)
    found = find_workspace(planar_arm(robot), clearance_problem(robot), robot.home, every=True)
    areas = [(n, abs(shoelace(outline))) for n, outline in found.patches()]
    slack = 2e-3 * (1 + found.area)
    assert abs(sum(area for _, area in areas) - found.area) < slack
    assert abs(sum(area for n, area in areas if n == 2) - found.covered_twice) < slack


def shoelace(outline: np.ndarray) -> float:
    x, z = outline.T
    return float((x * np.roll(z, -1) - np.roll(x, -1) * z).sum() / 2)


# --- the paper's robot ---------------------------------------------------------------------------


@pytest.mark.parametrize("problem", [WINDOWS, clearance_problem(MINERVA)])
def test_the_papers_workspace_is_the_union_of_polygons(problem):
    """Shapely overlays the images of dense outlines, which shares nothing with circles."""
    arm = planar_arm(MINERVA)
    found = find_workspace(arm, problem, MINERVA.home)
    s = np.linspace(0, 1, 4001)
    images = [
        Polygon(np.concatenate([arm.tool(arc.at(s)) for arc in aspect.region.loops[0]]))
        for aspect in found.aspects
    ]
    assert len(images) == 2
    assert_allclose([i.area for i in images], [a.image for a in found.aspects], rtol=1e-6)
    assert_allclose(unary_union(images).area, found.area, rtol=1e-6)
    assert_allclose(images[0].intersection(images[1]).area, found.covered_twice, rtol=1e-6)


def test_safe_postures_of_a_place_are_counted():
    found = find_workspace(planar_arm(MINERVA), WINDOWS, MINERVA.home)
    for place, n in (((0, 70), 2), ((-45, 20), 1), ((45, 20), 1), ((0, 40), 0), ((0, 79), 0)):
        assert found.safe_postures(place) == n


# --- the edge table ------------------------------------------------------------------------------

Y = np.array([0.0, 1, 0])


def chain(*joints: Joint, tool=(1.0, 0, 0), walls=(), points=()) -> Robot:
    places = (Point("tip", joints[-1].frame, np.array(tool)), *points)
    home = np.array([sum(j.limits) / 2 if j.limits else 0.3 for j in joints])
    return Robot(
        name="arm",
        joints=joints,
        points=places,
        boundaries=tuple(walls),
        home=home,
        tool="tip",
        length_unit="m",
        angle_unit="rad",
    )


def joint(n: int, kind: str, axis, *, origin=(0.0, 0, 0), limits=None) -> Joint:
    place = f"q{n}", str(n - 1), str(n), np.array(origin)
    return JOINT_TYPES[kind](*place, np.array(axis), limits=limits)


def solved(robot: Robot, held=None, **options):
    held = held or {}
    home = [q for j, q in enumerate(robot.home) if j not in held]
    problem = clearance_problem(robot, held)
    return find_workspace(planar_arm(robot, held), problem, home, **options)


def two_links(first=None, second=None, l1=2.0, l2=1.0, **rest) -> Robot:
    return chain(
        joint(1, "revolute", Y, limits=first),
        joint(2, "revolute", Y, origin=(l1, 0, 0), limits=second),
        tool=(l2, 0, 0),
        **rest,
    )


def turn_and_slide() -> Robot:
    """RP, the slide 0.5 beside the axis: radius from 0.5 to hypot(0.5, 2), one or two postures."""
    slide = joint(2, "prismatic", (1.0, 0, 0), limits=(-1.0, 2.0))
    return chain(joint(1, "revolute", Y), slide, tool=(0.0, 0, 0.5))


def two_slides(second) -> Robot:
    first = joint(1, "prismatic", (1.0, 0, 0), limits=(0.0, 3.0))
    return chain(first, joint(2, "prismatic", second, limits=(-1.0, 1.0)))


def above_a_wall() -> Robot:
    """A wall is the same for both postures."""
    robot = two_links(walls=(HalfSpace("W", "tip", np.array([0.0, 0, 1]), 1.5),))
    return replace(robot, home=np.array([-pi / 2, 0.2]))


SEGMENT = 9 * np.arccos(0.5) - 1.5 * np.sqrt(9 - 1.5**2)
"""Of the ring's outer circle, above the wall."""
RING = 8 * pi
"""Between the difference and the sum of the two links."""

CLOSED = {
    "links of equal length": (two_links(l1=1.0), 4 * pi, 4 * pi, 2),
    "an elbow on one side": (
        two_links(second=(0.5, 2.5)), 4 * pi * (cos(0.5) - cos(2.5)), 0.0, 1,
    ),
    "an elbow with more on one side": (
        two_links(second=(-2.0, 1.0)), 4 * pi * (1 - cos(2.0)), 4 * pi * (1 - cos(1.0)), 2,
    ),
    "an elbow of more than a turn": (two_links(second=(-4.0, 4.0)), RING, RING, 4),
    "half a turn": (two_links(second=(0.0, pi)), RING, 0.0, 1),
    "a slide that is turned": (turn_and_slide(), 4 * pi, pi, 2),
    # A circle of radius 1 slid over 3; both postures: half discs share 3 - 2 cos on each height.
    "a link that is slid": (
        chain(joint(1, "prismatic", (1.0, 0, 0), limits=(0.0, 3.0)), joint(2, "revolute", Y)),
        6 + pi, 6 - pi, 2,
    ),
    "two slides": (two_slides((0.6, 0, 0.8)), 3 * 2 * 0.8, 0.0, 1),
    "a wall": (above_a_wall(), SEGMENT, SEGMENT, 2),
}  # fmt: skip
"""Area, doubly covered area and number of aspects, by school geometry."""


@pytest.mark.parametrize("first", [None, (-2 * pi, 2 * pi), (-1.0, 2 * pi)])
def test_full_turns_count_once(first):
    found = solved(two_links(first))
    assert_allclose([found.area, found.covered_twice], RING, rtol=1e-12)
    assert len(found.aspects) == 2
    span = 2 * pi if first is None else first[1] - first[0]
    assert_allclose([a.swept for a in found.aspects], 4 * span, rtol=1e-12)


@pytest.mark.parametrize("name", CLOSED)
def test_workspaces_in_closed_form(name):
    robot, area, twice, aspects = CLOSED[name]
    found = solved(robot)
    assert_allclose([found.area, found.covered_twice], [area, twice], rtol=1e-12, atol=1e-12)
    assert len(found.aspects) == aspects
    assert bool(found.singular) == (aspects > 1)


def test_links_of_equal_length_reach_the_centre():
    with pytest.raises(ValueError, match="axis of the first joint"):
        solved(two_links(l1=1.0)).postures((0.0, 0.0))


def test_a_place_on_the_axis_is_reached_by_no_turn_or_by_every_turn():
    """Any turn was told although a limit kept the links from folding."""

    def folding(high, tool=1.0):
        return two_links(second=(0.0, high), l1=1.0, l2=tool)

    assert_allclose(folding(3.0).inverse_kinematics([0, 0, 0]), np.empty((0, 2)))
    assert solved(folding(3.0)).postures((0.0, 0.0)) == []
    assert solved(folding(3.0)).safe_postures((0.0, 0.0)) == 0
    assert solved(folding(3.5, 0.9)).postures((0.0, 0.0)) == []
    for call in (
        lambda: folding(3.5).inverse_kinematics([0, 0, 0]),
        lambda: solved(folding(3.5)).postures((0.0, 0.0)),
    ):
        with pytest.raises(
            AnyTurnError, match=r"axis of the first joint.*second one is at 180 deg"
        ):
            call()
    [(posture, _)] = solved(folding(3.0)).postures((1.0, 0.0))[:1]
    assert_allclose(abs(posture.q[1]), 2 * pi / 3)


def test_slides_of_any_length_move_the_tool_in_a_plane():
    def area(places: int) -> float:
        robot = parse_robot(body_scenes.shifted(body_scenes.scene(60004), places))
        return find_workspace(planar_arm(robot), clearance_problem(robot), robot.home).area

    assert [area(9), area(-9)] == pytest.approx([area(0) * 1e18, area(0) * 1e-18])


def test_a_place_on_the_axis_of_a_slide_that_turns():
    """RP, the slide through the axis: within its limits, or not."""
    for low, high, found in ((-1.0, 2.0, None), (0.5, 2.0, [])):
        slide = joint(2, "prismatic", (1.0, 0, 0), limits=(low, high))
        robot = chain(joint(1, "revolute", Y), slide, tool=(0.0, 0, 0))
        if found is None:
            with pytest.raises(AnyTurnError, match="second one is at 0"):
                solved(robot).postures((0.0, 0.0))
        else:
            assert solved(robot).postures((0.0, 0.0)) == found


@pytest.mark.parametrize("held", [0.0, 0.5, 2.0])
def test_a_slice_has_its_own_plane(held):
    """A waist that is held turns the plane of the arm; its workspace is the same."""
    waist = joint(1, "revolute", (0.0, 0, 1))
    upper, lower = joint(2, "revolute", Y), joint(3, "revolute", Y, origin=(2.0, 0, 0))
    robot = chain(waist, upper, lower)
    found = solved(robot, {0: held})
    assert_allclose([found.area, found.covered_twice], 8 * pi, rtol=1e-12)
    q = np.array([held, 0.4, 1.1])
    place = robot.frames(q).position("0", "tip", "0")
    assert_allclose(found.arm.axes @ place, found.arm.tool(q[1:]), atol=1e-12)
    assert any(np.allclose(p.q, q[1:]) for p, _ in found.postures(found.arm.axes @ place))


@pytest.mark.parametrize(
    ("robot", "words"),
    [
        (chain(joint(1, "revolute", (0.0, 0, 1)), joint(2, "revolute", Y)), "leaves the plane"),
        (
            chain(joint(1, "revolute", Y), joint(2, "prismatic", Y, limits=(0, 1))),
            "leaves the plane",
        ),
        (two_links(l2=0.0), "along a curve"),
        (two_links(l1=0.0), "along a curve"),
        (two_slides((1.0, 0, 0)), "along a line"),
    ],
)
def test_an_arm_without_a_planar_workspace_says_why(robot, words):
    with pytest.raises(NoPlanarWorkspaceError, match=words):
        planar_arm(robot)
    with pytest.raises(ValueError, match="3 joints that are not held"):
        planar_arm(chain(*(joint(n, "revolute", Y) for n in (1, 2, 3))))


def test_fibres_are_those_over_the_second_joint_or_none(monkeypatch):
    """A region that verifies itself over the first joint only has other cells."""
    from cspace.region import region
    from cspace.region.exact import UndecidedError

    over = region._over

    def only_over_the_first(problem, home, base, *caution):
        if base == 1:
            raise UndecidedError("something")
        return over(problem, home, base, *caution)

    monkeypatch.setattr(region, "_over", only_over_the_first)
    problem = clearance_problem(MINERVA)
    assert len(solve(problem, base=1).components) == 5
    with pytest.raises(UnresolvedError, match="second joint"):
        find_fibres(problem, MINERVA.home)


def test_an_empty_region_has_no_workspace():
    robot = two_links(walls=(HalfSpace("W", "tip", np.array([0.0, 0, 1]), 9.0),))
    with pytest.raises(NoHomeError):
        solved(robot)
    found = solved(robot, every=True)
    assert (found.area, found.covered_twice, found.aspects, found.patches()) == (0, 0, (), [])


@pytest.mark.parametrize("place", [(np.nan, 0.0), (np.inf, 1.0)])
def test_a_place_is_two_finite_numbers(place):
    with pytest.raises(ValueError, match="finite"):
        postures(planar_arm(MINERVA), place)


# --- passages ------------------------------------------------------------------------------------


def test_a_passage_is_within_a_component():
    problem = clearance_problem(MINERVA)
    region = find_fibres(problem, MINERVA.home)
    inner = [region.inside(i) for i in range(len(region.components))]
    for i, a in enumerate(inner):
        for j, b in enumerate(inner):
            found = find_passage(region, a, b)
            assert (found.possible, found.start, found.goal) == (i == j, i, j)
            assert bool(found.loops) == (i != j)
            if i != j:
                assert crosses(found, a, b, problem)


def crosses(found, a: np.ndarray, b: np.ndarray, problem: Problem) -> bool:
    """Whether random paths from a to b all cross a loop, with copies a full turn away."""
    rings = [np.concatenate([arc.points for arc in loop]) for loop in found.loops]
    spans = [2 * pi * np.arange(-2, 3) if r is None else [0] for r in problem.ranges]
    shifts = [np.array([x, y]) for x in spans[0] for y in spans[1]]
    lines = unary_union([LineString(ring + shift) for ring in rings for shift in shifts])
    rng = np.random.default_rng(1)
    walks = [np.array([a, *rng.uniform(-3, 3, (3, 2)), b]) for _ in range(20)]
    return all(LineString(walk).intersects(lines) for walk in walks)


def slides(*walls: Pair, points: tuple[Point, ...]) -> Robot:
    """Two slides at right angles: joint space is the plane itself."""
    limits = (-3.0, 3.0)
    first = joint(1, "prismatic", (1.0, 0, 0), limits=limits)
    second = joint(2, "prismatic", (0.0, 0, 1), limits=limits)
    robot = chain(first, second, tool=(0.0, 0, 0), points=points, walls=walls)
    return replace(robot, home=np.array([2.0, 2.0]))


def radii_of(passage) -> np.ndarray:
    (loop,) = passage.loops
    return np.concatenate([np.hypot(*arc.points.T) for arc in loop])


def test_a_ring_of_posts_is_named_as_what_separates():
    """Posts around the middle: from outside the hole's loop is between, from inside the outer."""
    turns = np.arange(8) * pi / 4
    posts = tuple(Point(f"p{i}", "0", np.array([cos(t), 0, sin(t)])) for i, t in enumerate(turns))
    walls = tuple(Pair(f"B{i}", (post.name, "tip"), 0.5) for i, post in enumerate(posts))
    robot = slides(*walls, points=posts)
    problem = clearance_problem(robot)
    region = find_fibres(problem, robot.home)
    assert len(region.components) == 2
    inward = find_passage(region, (2.0, 2.0), (0.0, 0.1))
    outward = find_passage(region, (0.0, 0.1), (2.0, 2.0))
    for passage in (inward, outward):
        assert not passage.possible
        assert set(passage.boundaries) == {wall.name for wall in walls}
    assert radii_of(inward).min() > 1 > radii_of(outward).max()
    assert crosses(inward, np.array([2.0, 2.0]), np.array([0.0, 0.1]), problem)


def test_a_way_round_is_found_where_the_straight_path_leaves():
    post = Point("post", "0", np.zeros(3))
    robot = slides(Pair("ring", ("post", "tip"), 0.5), points=(post,))
    region = find_fibres(clearance_problem(robot), robot.home)
    found = find_passage(region, (2.0, 2.0), (-2.0, -2.0))
    assert found.possible
    assert found.exit is not None
    assert found.exit.boundary == "ring"
    assert_allclose(hypot(*found.exit.q), 0.5, atol=1e-9)
    blocked = find_passage(region, (2.0, 2.0), (0.0, 0.1))
    assert (blocked.possible, blocked.goal, blocked.loops) == (False, None, ())


# --- many boundaries -----------------------------------------------------------------------------


def among_idle_forms(count: int) -> Problem:
    """The paper's robot with forms more that bound nothing: 2 + cos(q1 + phase) cos q2 / 2."""
    problem = clearance_problem(MINERVA)
    table = np.zeros((count, 3, 3))
    table[:, 0, 0] = 2
    phases = np.linspace(0, 2, count)
    table[:, 1, 1], table[:, 2, 1] = np.cos(phases) / 2, np.sin(phases) / 2
    forms = HarmonicForm(np.concatenate([problem.forms.coefficients, table]), problem.forms.kinds)
    return replace(problem, forms=forms, names=(*problem.names, *map(str, range(count))))


def test_boundaries_that_bound_nothing_are_not_crossed_with_each_other(monkeypatch):
    """A seven-joint arm has thousands; each two of them took their part of 15 GB."""
    given = []

    def crossed(arm, forms, *others):
        given.append(len(forms.coefficients))
        return crossing_distances(arm, forms, *others)

    monkeypatch.setattr(layers, "crossing_distances", crossed)
    arm, home = planar_arm(MINERVA), MINERVA.home
    alone, among = (find_workspace(arm, among_idle_forms(n), home) for n in (0, 300))
    assert_allclose([among.area, among.covered_twice], [alone.area, alone.covered_twice])
    assert given[1] <= given[0] <= 8


def test_a_region_with_too_many_boundaries_has_no_workspace_and_says_so(monkeypatch):
    monkeypatch.setattr(layers, "MOST_BOUNDING", 1)
    with pytest.raises(NoPlanarWorkspaceError, match=r"bound the region, .* 1 are"):
        find_workspace(planar_arm(MINERVA), clearance_problem(MINERVA), MINERVA.home)


if __name__ == "__main__":
    for seed in range(int(sys.argv[1])):
        check_areas(seed, 20_000)
