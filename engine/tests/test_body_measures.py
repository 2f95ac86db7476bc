"""Measures, scales, workspaces and exports of regions with bodies, against dense numbers."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace import find_region
from cspace.boundary.separation import nearest_features
from cspace.export.document import region_document
from cspace.geometry import polygon
from cspace.measures.nearest import moments, nearest_boundary
from cspace.measures.scaling import first_exit, largest_safe_scale
from cspace.measures.star import exact_scale, inner_polygon
from cspace.model.robot import Body, Disc
from cspace.model.robotfile import parse_robot
from cspace.paths.traversal import boundaries, least_margin, plan_route, traverse
from cspace.region import clearance_problem
from cspace.workspace.areas import find_passage, find_workspace
from cspace.workspace.layers import find_fibres
from cspace.workspace.planar import planar_arm, postures
from engine_support import body_scenes
from engine_support.commands import follows_schema
from qbound.circle import nearest_turn
from qbound.forms import HarmonicForm

TABLE_FILE = """
schema = 1
name = "Two links on a table"
length_unit = "m"
angle_unit = "deg"
home = { q1 = 90, q2 = 0 }
tool = "hand"
collisions = "all"
allowed = [["upper arm", "forearm"]]
joint = [
  { name = "q1", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, -1, 0], limits = [-20, 200] },
  { name = "q2", type = "revolute", parent = "1", frame = "2", origin = [0.5, 0, 0], axis = [0, -1, 0], limits = [-150, 150] },
]
point = [{ name = "hand", frame = "2", at = [0.4, 0, 0] }]
body = [
  { name = "upper arm", frame = "1", capsule = { from = [0, 0, 0], to = [0.5, 0, 0], radius = 0.02 } },
  { name = "forearm", frame = "2", polygon = [[0, -0.02], [0.4, -0.02], [0.4, 0.02], [0, 0.02]] },
]
obstacle = [
  { name = "disc", disc = { at = [0.5, 0, 0.4], radius = 0.1 } },
  { name = "crate", polygon = [[-0.7, 0.35], [-0.45, 0.35], [-0.45, 0.6], [-0.7, 0.6]] },
]
"""  # noqa: E501

SLIDE_FILE = """
schema = 1
name = "A disc on two slides"
length_unit = "m"
angle_unit = "rad"
home = { x = 2.5, y = 2 }
tool = "tip"
collisions = "all"
joint = [
  { name = "x", type = "prismatic", parent = "base", frame = "1", origin = [0, 0, 0], axis = [1, 0, 0], limits = [0, 5] },
  { name = "y", type = "prismatic", parent = "1", frame = "2", origin = [0, 0, 0], axis = [0, 1, 0], limits = [0, 5] },
]
point = [{ name = "tip", frame = "2", at = [0, 0, 0] }]
body = [{ name = "hand", frame = "2", disc = { at = [0, 0], radius = 0.5 } }]
obstacle = [
  { name = "wall", polygon = [[0, 4], [5, 4], [5, 5], [0, 5]] },
  { name = "post", disc = { at = [4, 1], radius = 0.5 } },
]
"""  # noqa: E501


@pytest.fixture(scope="module")
def region():
    """A table with a disc and a crate: one component, bounded on all sides."""
    return find_region(parse_robot(TABLE_FILE))


def arcs(region):
    """All arcs of a region."""
    return [arc for c in region.components for loop in c.loops for arc in loop]


KINDS = ("RR", "RP", "PR", "PP")
SCENES = [body_scenes.robot(body_scenes.ordinary(32, kinds)) for kinds in KINDS]
"""Bodies alone, of each kind of arm."""


@pytest.mark.parametrize("robot", SCENES, ids=KINDS)
def test_the_form_of_an_arc_vanishes_along_it_and_its_feature_is_what_touches(robot) -> None:
    """Of all four kinds of arms; a corner that two parts share may have either part's name."""
    found = find_region(robot)
    boundaries = {boundary.name: boundary for boundary in robot.used}
    seen = 0
    for arc in arcs(found):
        assert (arc.form is None) == (arc.boundary in found.limited)
        if arc.form is not None:
            assert_allclose(arc.form(arc.at(np.linspace(0, 1, 9))), 0, atol=1e-9)
        if arc.feature and "part" not in arc.feature:
            near = nearest_features(robot, boundaries[arc.boundary], arc.at([0.437])[0])
            wall = near.features[1] == "edge"
            assert arc.feature == (near.features[0] if wall else " on ".join(near.features))
            seen += 1
    assert seen


@pytest.mark.parametrize("robot", SCENES[:3], ids=KINDS[:3])
def test_the_nearest_boundary_point_is_that_of_a_thousand_points_an_arc(robot) -> None:
    found = find_region(robot)
    s = np.linspace(0, 1, 1001)
    places = np.concatenate([arc.at(s) for arc in arcs(found)])
    rounds = [limits is None for limits in found.problem.ranges]
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    for q in np.random.default_rng(1).uniform(*ends.T, (4, 2)):
        point = nearest_boundary(found, q)
        gaps = np.where(rounds, nearest_turn(places - q, 0), places - q)
        dense = np.hypot(*gaps.T).min()
        assert dense - 2e-3 < point.distance <= dense + 1e-12
        assert point.feature or point.boundary in found.limited
        assert abs(found.margins(point.q).min()) < 1e-9


def test_moments_are_those_of_a_grid(region) -> None:
    component = region.home_component
    found = moments(region.problem, component)
    low, high = np.array([joint.limits for joint in region.robot.joints]).T
    n = 300
    axes = [a + (b - a) * (np.arange(n) + 0.5) / n for a, b in zip(low, high, strict=True)]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
    inside = q[region.contains(q)]
    assert len(region.components) == 1
    assert found.area == pytest.approx(component.area, rel=1e-12)
    assert found.area == pytest.approx(len(inside) * np.prod((high - low) / n), rel=5e-3)
    assert_allclose(found.centroid, inside.mean(axis=0), atol=5e-3)
    assert_allclose(found.second / found.area, np.cov(inside.T), atol=5e-3)


CENTRES = ([1.5, 0.0], [0.1, 0.2], [2.6, -1.2])


@pytest.mark.parametrize("centre", CENTRES)
def test_a_ray_stops_at_the_first_contact_of_bodies(region, centre) -> None:
    """Against the sign of the signed distance on a fine grid along each ray."""
    rng, problem = np.random.default_rng(2), region.problem
    angle = rng.uniform(0, 2 * np.pi, 12)
    rays = 2 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    found, which = first_exit(problem.forms, centre, rays, contacts=problem.contacts)
    s = np.linspace(0, 1, 4001)
    bodies = slice(0, len(region.robot.used))
    for ray, scale, pair in zip(rays, found, which, strict=True):
        values = region.margins(centre + s[:, None] * ray)[:, bodies]
        negative = (values < 0).any(axis=1)
        expected = s[negative.argmax()] if negative.any() else 1.0
        assert expected - 3e-4 < scale < expected + 1e-9
        if pair >= 0:
            name = region.boundaries.index(problem.contacts.boundaries[pair])
            assert abs(region.margins(centre + scale * ray)[name]) < 1e-9


def test_bodies_that_overlap_at_the_centre_are_refused(region) -> None:
    (q,) = np.radians([[20.0, 50.0]])
    assert not region.contains(q)
    problem = region.problem
    with pytest.raises(ValueError, match="violated at the centre"):
        largest_safe_scale(q + np.eye(2), q, problem.forms, contacts=problem.contacts)


@pytest.fixture(scope="module", params=SCENES, ids=KINDS)
def kind(request):
    """The region of each scene, and its deepest configuration of a few.

    What turns all the way round gets limits, because what goes round a joint has no centre.
    """
    robot = request.param
    joints = tuple(replace(joint, limits=joint.limits or (-2.5, 2.5)) for joint in robot.joints)
    found = find_region(replace(robot, joints=joints))
    q = np.random.default_rng(0).uniform(*np.transpose(found.problem.ranges), (400, 2))
    return found, q[found.margins(q).min(axis=1).argmax()]


def first_violation(region, centre, places, highest: float) -> float:
    """The least of many scales at which a place, scaled about a centre, breaks a boundary.

    By the signed distances of the bodies alone, without their features; limits do not count.
    """
    s = np.linspace(0, highest, 401)
    margins = region.margins(centre + s[:, None, None] * (places - centre))
    bad = (margins[..., : len(region.robot.used)] < 0).any(axis=(1, 2))
    return float(s[bad.argmax()]) if bad.any() else highest


def around(corners, n: int):
    """Points of the edges of a polygon, n an edge."""
    t = np.linspace(0, 1, n, endpoint=False)[:, None, None]
    return (corners + t * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 2)


def test_the_largest_safe_scale_is_that_of_dense_samples_for_each_kind_of_arm(kind) -> None:
    """A stack of no form says that a joint slides: taken for one that turns, it was far off."""
    region, centre = kind
    corners = centre + 2 * np.array([[-1, -1], [1.2, -1], [1, 1], [-1, 0.5]])
    problem = region.problem
    assert not problem.names
    found = largest_safe_scale(corners, centre, problem.forms, contacts=problem.contacts)
    dense = first_violation(region, centre, around(corners, 60), 1)
    assert found.proved < found.scale < 1
    assert dense - 0.01 < found.scale <= dense + 1e-9
    column = region.boundaries.index(problem.contacts.boundaries[found.form])
    assert abs(region.margins(found.q)[column]) < 1e-9


def test_the_exact_scale_is_that_of_dense_samples_for_each_kind_of_arm(kind) -> None:
    region, centre = kind
    component = region.components[region.component_of(centre)]
    found = exact_scale(region.problem, component, centre)
    places = [arc.at(np.linspace(0, 1, 25)) for loop in component.loops for arc in loop]
    dense = first_violation(region, centre, np.concatenate(places), 1 - 1e-6)
    assert dense - 0.02 < found.scale <= dense + 2e-6
    rings = inner_polygon(region.problem, component, 17)
    assert 0.9 * component.area < sum(map(polygon.area, rings)) < component.area
    for ring in rings:
        assert region.margins(around(ring, 40)).min() > -1e-8


def test_a_rectangle_with_a_post_in_it_is_not_safe() -> None:
    """A disc on two slides, a post of radius 1/2: the rectangle's corner (9/2, 1/2) touches it.

    Scaled by s about (2, 2) the corner is 1 from the post's middle, (4, 1):
    (5 s / 2 - 2)^2 + (1 - 3 s / 2)^2 = 1.
    """
    problem = clearance_problem(parse_robot(SLIDE_FILE))
    corners = [[0.5, 0.5], [4.5, 0.5], [4.5, 3], [0.5, 3]]
    found = largest_safe_scale(corners, [2, 2], problem.forms, contacts=problem.contacts)
    assert found.scale == pytest.approx((13 - np.sqrt(33)) / 17, abs=1e-12)
    assert problem.contacts.boundaries[found.form] == "hand, post"


BOX_FILE = """
schema = 1
name = "A box at an elbow"
length_unit = "m"
angle_unit = "rad"
home = { q1 = 0, q2 = 0 }
tool = "tip"
collisions = "all"
joint = [
  { name = "q1", type = "revolute", parent = "0", frame = "1", origin = [3, 0, 0], axis = [0, 0, -1] },
  { name = "q2", type = "revolute", parent = "1", frame = "2", origin = [3, 0, 0], axis = [0, 0, 1], rpy = [0, 0, 0.7853981633974483] },
]
point = [{ name = "tip", frame = "2", at = [1, 0, 0] }]
body = [{ name = "fore", frame = "2", polygon = [[0, -0.5], [2, -0.5], [2, 0.5], [0, 0.5]] }]
obstacle = [
  { name = "disc", disc = { at = [0, -1], radius = 1 } },
  { name = "bar", capsule = { from = [1, 1], to = [0, 1], radius = 0.25 } },
]
"""  # noqa: E501


def test_triangles_that_are_cut_again_and_again_get_smaller() -> None:
    """A form that falls and rises along the longest side changes more along the others."""
    problem = clearance_problem(parse_robot(BOX_FILE))
    centre = np.array([5.195877124490555, -1.9500802669594774])
    corners = 1.2712039550176283 * np.array([[-1, -1], [1, -1], [1.2, 0.1], [1, 1], [-1, 1]])
    found = largest_safe_scale(centre + corners, centre, problem.forms, contacts=problem.contacts)
    assert found.form == -1
    u, v = np.random.default_rng(0).uniform(size=(2, 2000, 1))
    start = np.arange(2000) % 5
    edge = (1 - u) * corners[start] + u * corners[(start + 1) % 5]
    assert problem.evaluator.feasible(centre + v * edge).all()


def test_forms_that_are_no_stack_are_refused(region) -> None:
    """One form, or a list of none, does not say of what joints the contacts are."""
    problem = region.problem
    three = HarmonicForm(np.zeros((1, 3, 3, 3)), ("revolute",) * 3)
    for forms in (HarmonicForm(np.zeros((3, 3)), problem.forms.kinds), three):
        with pytest.raises(ValueError, match="a stack of forms of two joints"):
            largest_safe_scale(np.eye(2), [0, 0], forms, contacts=problem.contacts)


@pytest.mark.parametrize(("seed", "robot"), [(0, SCENES[0]), (2, SCENES[2])])
def test_a_workspace_is_that_of_drawn_places(seed, robot) -> None:
    """Each place's postures by inverse kinematics and the signed distance alone."""
    problem, arm = clearance_problem(robot), planar_arm(robot)
    found = find_workspace(arm, problem, robot.home, every=True)
    ranges = tuple(joint.limits for joint in robot.joints)
    ends = [limits or (-np.pi, np.pi) for limits in ranges]
    rng = np.random.default_rng(seed)
    tried = np.asarray(arm.tool(rng.uniform(*np.transpose(ends), (500, 2))))
    low, high = tried.min(axis=0), tried.max(axis=0)
    places, count = rng.uniform(low, high, (600, 2)), []
    for k, place in enumerate(places):
        safe = {p.side for p in postures(arm, place, ranges) if problem.evaluator.feasible(p.q)}
        count.append(len(safe))
        if k < 50:
            assert found.safe_postures(place) == len(safe)
    for value, least in ((found.area, 1), (found.covered_twice, 2)):
        share = np.mean(np.array(count) >= least)
        size = np.prod(high - low)
        error = size * np.sqrt(max(share * (1 - share), 1e-3) / len(places))
        assert value == pytest.approx(share * size, abs=4 * error)


def test_a_passage_names_the_bodies_that_the_straight_path_meets(region) -> None:
    start, goal = np.radians([[90.0, 0.0], [20.0, 50.0]])
    found = find_passage(find_fibres(region.problem, region.robot.home), start, goal)
    assert not found.possible
    assert found.exit is not None
    assert found.exit.boundary == "forearm, disc"
    column = region.boundaries.index("forearm, disc")
    assert abs(region.margins(found.exit.q)[column]) < 1e-9


def test_json_says_what_touches(region) -> None:
    document = json.loads(json.dumps(region_document(region)))
    follows_schema(document, "region")
    named = {
        arc["boundary"]: arc.get("feature")
        for c in document["components"]
        for loop in c["loops"]
        for arc in loop["arcs"]
    }
    assert named["q1.lower"] is None
    assert " on " in named["forearm, disc"]


def test_a_needle_between_two_rows_of_a_path_is_met(region) -> None:
    """A disc of 10 micrometres that only the corners of the hand sweep, in a thousandth rad."""
    at = 0.9002 * np.array([np.cos(1.0), 0, np.sin(1.0)])
    needle = Body("needle", "0", Disc(at, 1e-5))
    robot = replace(region.robot, obstacles=(needle,))
    path = traverse(robot, np.radians([[0.0, 0.0], [180.0, 0.0], [180.0, 90.0]]), deviation=1.0)
    met = {b.name: least_margin(path, b) for b in boundaries(find_region(robot))}
    found = met["forearm, needle"]
    assert found.leaves is not None
    # From where a corner at hypot(0.9, 0.02) comes to where the edge x = 0.9 of the hand does.
    assert 1 - np.arcsin(0.02002 / 0.9002) < found.leaves.q[0] < 1 - np.arccos(0.9 / 0.9002)
    assert abs(found.boundary.margin(found.leaves.q[None])[0]) < 2e-9
    before = path.at(np.linspace(0, found.leaves.s, 20001))
    assert found.boundary.margin(before).min() > -2e-9
    everywhere = found.boundary.margin(path.at(np.linspace(0, 2, 40001)))
    assert found.value <= everywhere.min() + 1e-12
    assert found.value == pytest.approx(everywhere.min(), abs=1e-6)
    assert met["upper arm, needle"].leaves is None


@pytest.mark.parametrize("robot", SCENES, ids=KINDS)
def test_the_margin_of_bodies_changes_no_faster_than_its_largest_speed(robot) -> None:
    rng = np.random.default_rng(0)
    ends = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    q = rng.uniform(*ends.T, (500, 2))
    steps = rng.normal(size=q.shape) * 0.05
    for boundary in boundaries(find_region(robot)):
        if boundary.speeds is not None:
            change = np.abs(boundary.margin(q + steps) - boundary.margin(q))
            assert (change <= np.abs(steps) @ boundary.speeds + 1e-12).all()
            assert (change > 0.1 * np.abs(steps) @ boundary.speeds).any()


def test_a_route_along_arcs_of_bodies_keeps_to_them(region) -> None:
    found = plan_route(region, [1, 2, 3], along="arcs", deviation=0.01)
    for boundary in boundaries(region):
        assert least_margin(found.path, boundary).leaves is None
