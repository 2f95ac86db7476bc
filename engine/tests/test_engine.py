"""The page's arithmetic, module by module, gives what Python gives for the same values."""

from __future__ import annotations

import json
import math
from functools import cache

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose

from cspace import find_region, load_robot
from cspace.boundary.evaluator import evaluator
from cspace.boundary.functions import clearance
from cspace.explorer.data import explorer_data
from cspace.explorer.page import ARITHMETIC, web_text
from cspace.forms.harmonic import restrict
from cspace.measures.scaling import least_along_edges
from cspace.paths.traversal import traverse
from cspace.region import paper_rule, violated
from cspace.workspace.planar import planar_arm, postures
from engine_support import scenes
from engine_support.arms import ROBOTS, SPATIAL
from engine_support.javascript import Script
from qbound import window_region
from qbound.boundary import position
from qbound.circle import circle_arc, circle_roots

POSES = 1000


class Arithmetic(Script):
    """The page's arithmetic, and a robot."""

    def __init__(self, data=None):
        super().__init__(*map(web_text, ARITHMETIC))
        self.data = data
        if data:
            self.read(f"const robot = {json.dumps(data)};")
            self.read("const map = toolMap(robot, robot.q); const arm = armOf(map);")


@cache
def alone():
    """The arithmetic without a robot."""
    return Arithmetic()


@cache
def case(name):
    robot, held = (ROBOTS | SPATIAL)[name]()
    region = find_region(robot, held)
    return robot, held, region, Arithmetic(explorer_data(region))


def poses(data, n=POSES, seed=5):
    """Draw configurations: the free joints within the view, the held ones as they are."""
    low, high = (np.array([v[end] for v in data["views"]]) for end in ("low", "high"))
    q = np.tile(data["q"], (n, 1))
    q[:, data["free"]] = np.random.default_rng(seed).uniform(low, high, (n, 2))
    return q


@cache
def among_obstacles(seed):
    """A scene of capsules, polygons and discs, every fourth of the same two kinds of joints."""
    robot = scenes.random_scene(seed, 3)
    region = find_region(robot)
    return robot, region, Arithmetic(explorer_data(region))


# --- roots ----------------------------------------------------------------------------------------


EDGES = [(3, 4, c) for c in (-6, -5, 2, 5, 6)] + [(0, 0, c) for c in (-1, 0, 1)] + [(-1, 0, 0)]


def test_the_arc_of_theorem_2_is_the_librarys():
    abc = np.vstack([np.random.default_rng(12).uniform(-15, 15, (2000, 3)), EDGES])
    found = alone()("all.map((x) => circleArc(...x))", all=abc.tolist())
    roots, arc = circle_roots(*abc.T), circle_arc(*abc.T)
    assert [one["count"] for one in found] == roots.count.tolist()
    assert [one["empty"] for one in found] == arc.empty.tolist()
    assert_allclose([one["theta"] for one in found], arc.centre, atol=1e-14)
    assert_allclose([one["alpha"] for one in found], arc.half_width, atol=1e-12)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_roots_within_a_range_are_all_places_where_the_sign_changes(kind):
    view = {"low": -4.0, "high": 7.0, "wraps": False}
    forms = np.random.default_rng(3).uniform(-2, 2, (200, 3))
    found = alone()(
        "all.map((form) => rootsWithin(kind, form, view))", kind=kind, all=forms.tolist(), view=view
    )
    q = np.linspace(-4, 7, 100_001)
    factors = [q**0, np.cos(q), np.sin(q)] if kind == "revolute" else [q**0, q, q**2]
    for form, roots in zip(forms, found, strict=True):
        values = form @ factors
        changes = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))
        assert_allclose(np.sort(roots), q[changes], atol=2e-4)


@pytest.mark.parametrize(
    ("kind", "at"),
    [("revolute", [0, math.tau / 3, -math.tau / 3]), ("prismatic", [0, 7, -7])],
)
def test_a_form_of_one_joint_is_settled_by_three_of_its_values(kind, at):
    values = "at.map((q) => dot(form, basis(kind, q)))"
    form = [0.4, -1.5, 0.7]
    found = alone()(f"throughThree(kind, at, {values})", kind=kind, at=at, form=form)
    assert_allclose(found, form, atol=1e-14)


# --- arcs -----------------------------------------------------------------------------------------


def unions(seed, count=40):
    """Draw arcs in no order, some longer than a half turn, some across the cut."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        low = rng.uniform(-7, 7, rng.integers(0, 6))
        yield np.stack([low, low + rng.uniform(0, 4, len(low))], axis=-1)


def test_a_union_of_arcs_holds_what_one_of_them_holds():
    angles = np.linspace(-math.pi, math.pi, 1001)[1:-1]
    for arcs in unions(1):
        union = alone()("onCircle(found, 0.3)", found=arcs.ravel().tolist())
        assert (np.diff(union) >= 0).all()
        held = alone()("all.map((q) => holds(union, q))", union=union, all=angles.tolist())
        turned = np.mod(angles[:, None] + 0.3 - arcs[:, 0], math.tau)
        assert held == (turned < np.diff(arcs).ravel()).any(axis=1).tolist()


def test_what_a_union_leaves_of_an_interval_is_its_complement():
    places = np.linspace(-2, 3, 1001)[1:-1]
    for arcs in unions(2):
        union = alone()("onCircle(found, 0)", found=arcs.ravel().tolist())
        left = alone()("without(-2, 3, union)", union=union)
        inside, covered = (
            ((places[:, None] > ends[:, 0]) & (places[:, None] < ends[:, 1])).any(axis=1)
            for ends in (np.reshape(left, (-1, 2)), np.reshape(union, (-1, 2)))
        )
        assert np.array_equal(inside, ~covered)


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [
        ([0, 1], [0.5, 2], [0]),
        ([0, 1], [1, 2], [-1]),
        ([0, 1, 2, 3], [0.5, 2.5], [-1]),
        ([0, 3], [0, 1, 2, 3], [-1, -1]),
        ([0, 1, 5, 6], [0, 1, 2, 3, 5, 6], [0, -1, 1]),
        ([], [0, 1], [-1]),
    ],
)
def test_an_interval_goes_on_where_two_overlap_one_to_one(a, b, expected):
    assert alone()("goesOn(a, b)", a=a, b=b) == expected


# --- kinematics -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_margins_are_the_librarys(name):
    robot, _, _, script = case(name)
    q = poses(script.data)
    found = script("all.map((q) => margins(robot, q))", all=q.tolist())
    assert len(found) == POSES
    names = [b.name for b in robot.boundaries if b.used]
    for pose, rows in zip(q, found, strict=True):
        safe = {row["name"]: row["value"] for row in rows if row["used"]}
        told = dict(violated(robot, pose))
        below = {n: v for n, v in safe.items() if v < 0}
        assert below.keys() == told.keys()
        assert_allclose([below[n] for n in told], list(told.values()), atol=1e-12)
    for b in [robot.boundary(n) for n in names]:
        values = [next(r["value"] for r in rows if r["name"] == b.name) for rows in found]
        assert np.array_equal(np.array(values) > 0, clearance(robot, b)(q) > 0)


def test_the_papers_rule_gives_the_papers_polygon_and_scale():
    robot = load_robot("minervabot-v2")
    data = explorer_data(find_region(robot, rule="paper"))
    corners = window_region(robot).polygon
    assert_allclose(data["polygon"]["vertices"], corners, atol=1e-12)
    assert_allclose(data["polygon"]["largest"], 0.9640384935, atol=1e-9)
    script = Arithmetic(data)
    q = poses(data)
    safe = script("all.map((q) => isSafe(margins(robot, q)))", all=q.tolist())
    assert np.array_equal(safe, paper_rule.feasible(robot, q))
    turned = q + math.tau * np.array([1, -2])  # a window is one turn of a joint, whichever
    assert script("all.map((q) => isSafe(margins(robot, q)))", all=turned.tolist()) == safe


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_places_of_points_are_the_librarys(name):
    robot, _, _, script = case(name)
    q = poses(script.data)
    found = np.array(script("all.map((q) => pointPlaces(robot, q))", all=q.tolist()))
    for i, point in enumerate(robot.points):
        assert_allclose(found[:, i], position(robot, point.name)(q), atol=1e-11)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_tool_and_its_determinant_are_those_of_the_forms(name):
    robot, _, _, script = case(name)
    q = poses(script.data)
    pairs = q[:, script.data["free"]].tolist()
    tool, axes = position(robot, robot.tool), np.array(script("viewAxes(robot, robot.q)"))
    assert script("map.planar && sweepsAnArea(arm, robot.reach)")
    at = np.array(script("all.map((p) => toolAt(map, p))", all=pairs))
    assert_allclose(at, tool(q) @ axes[:2].T, atol=1e-11)
    jacobian = axes[:2] @ tool.gradient(q)[..., script.data["free"]]
    det = script("all.map((p) => determinant(map, p))", all=pairs)
    assert_allclose(det, np.linalg.det(jacobian), atol=1e-9 * np.abs(det).max())


def test_a_tool_that_leaves_the_plane_is_told_apart():
    assert not case("out of the plane")[3]("map.planar")
    assert case("RR")[3]("map.planar")


# --- contacts -------------------------------------------------------------------------------------


def convex(rng):
    """Draw a point, a segment or a convex polygon."""
    count = rng.integers(1, 7)
    middle = rng.uniform(-1.5, 1.5, 2)
    if count < 3:
        return rng.uniform(-1, 1, (count, 2)) + middle
    turns = np.sort(rng.uniform(0, math.tau, count))[:: rng.choice([-1, 1])]
    return np.stack([np.cos(turns), np.sin(turns)], axis=-1) + middle


def core(corners):
    kinds = {1: lambda c: shapely.Point(c[0]), 2: shapely.LineString}
    return kinds.get(len(corners), shapely.Polygon)(corners)


def test_distances_of_convex_parts_are_shapelys_and_depths_a_way_out():
    rng = np.random.default_rng(8)
    overlaps = 0
    for _ in range(300):
        one, other = convex(rng), convex(rng)
        found = alone()("encounter(one, other)", one=one.tolist(), other=other.tolist())
        distance, places = found["distance"], found["places"]
        assert np.hypot(*np.subtract(*places)) == pytest.approx(abs(distance))
        if distance > 0:
            assert distance == pytest.approx(core(one).distance(core(other)), abs=1e-12)
            continue
        overlaps += 1
        assert core(one).distance(core(other)) == 0
        out = np.subtract(places[1], places[0])
        moved = [core(one + (1 + 1e-9) * way) for way in (out, -out)]
        assert max(each.distance(core(other)) for each in moved) > 0
    assert 50 < overlaps < 250


def test_area_and_inside_of_polygons_are_shapelys():
    rng = np.random.default_rng(4)
    for _ in range(30):
        turns = math.tau * (np.arange(7) + rng.uniform(0, 0.8, 7))[:: rng.choice([-1, 1])] / 7
        corners = np.stack([np.cos(turns), np.sin(turns)], axis=-1) * rng.uniform(0.2, 1, (7, 1))
        places = rng.uniform(-1, 1, (50, 2))
        area = shapely.Polygon(corners).area * (1 if shapely.LinearRing(corners).is_ccw else -1)
        assert alone()("area(c)", c=corners.tolist()) == pytest.approx(area)
        inside = alone()("all.map((p) => isInside(c, p))", c=corners.tolist(), all=places.tolist())
        assert inside == shapely.contains_xy(shapely.Polygon(corners), *places.T).tolist()


@pytest.mark.parametrize("seed", range(4))
def test_margins_of_bodies_are_the_librarys_and_the_nearest_places_show_them(seed):
    robot, _, script = among_obstacles(seed)
    q = poses(script.data, 60)
    compiled = evaluator(robot, limits=False)
    found = script("all.map((q) => margins(robot, q))", all=q.tolist())
    own = {row["name"]: [] for row in found[0]}
    for rows in found:
        for row in rows:
            own[row["name"]].append(row["value"])
    expected = dict(zip(compiled.names, compiled.margins(q).T, strict=True))
    for name, values in expected.items():
        assert_allclose(own[name], values, atol=1e-12)
    places = """all.map((q) => { const placed = placedParts(robot, framesOf(robot, q));
        return robot.boundaries.filter((wall) => wall.kind === "bodies")
            .map((wall) => [wall.name, bodiesEncounter(wall, placed).places]); })"""
    for k, row in enumerate(script(places, all=q.tolist())):
        for name, (one, other) in row:
            asked = robot.boundary(name).clearance
            gap = np.hypot(*np.subtract(one, other)) - asked
            if expected[name][k] + asked > 0:
                assert gap == pytest.approx(expected[name][k], abs=1e-12)


def test_a_free_interval_ends_where_two_bodies_touch():
    robot, _, script = among_obstacles(0)
    script.read("const asked = sliceProblem(robot, robot.q);")
    compiled, count = evaluator(robot), 0
    for first in np.linspace(-3, 3, 9):
        column = script("fibre(asked, first)", first=first)
        for end, by in zip(column["free"], column["by"], strict=True):
            if by >= 0:
                name = script("asked.names[by]", by=by)
                margin = compiled.margins([first, end])[compiled.names.index(name)]
                assert abs(margin) < 1e-8
                count += 1
    assert count > 4


# --- postures -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS)
def test_inverse_kinematics_finds_every_posture(name):
    _, _, _, script = case(name)
    data = script.data
    pairs = poses(data)[:, data["free"]]
    places = np.array(script("all.map((p) => toolAt(map, p))", all=pairs.tolist()))
    found = np.array(script("all.map((t) => postures(arm, t))", all=places.tolist()))
    back = np.array(script("all.map((s) => s.map((p) => toolAt(map, p)))", all=found.tolist()))
    assert_allclose(back, np.broadcast_to(places[:, None], back.shape), atol=1e-6)
    circles = np.array([v["wraps"] for v in data["views"]])
    gap = found - pairs[:, None]
    gap = np.where(circles, gap - math.tau * np.round(gap / math.tau), gap)
    assert np.abs(gap).max(axis=2).min(axis=1).max() < 1e-6  # the pose itself is among them
    if found.shape[1] == 2:  # and the other one is the other posture
        det = np.array(
            script("all.map((s) => s.map((p) => determinant(map, p)))", all=found.tolist())
        )
        assert (np.sign(det[:, 0]) == -np.sign(det[:, 1])).all()


@pytest.mark.parametrize("name", ROBOTS)
def test_the_postures_of_a_place_are_the_librarys(name):
    robot, held, _, script = case(name)
    data = script.data
    low, high = (np.array([v[end] for v in data["views"]]) for end in ("low", "high"))
    circles = np.array([v["wraps"] for v in data["views"]])
    ranges = [None if c else (x, y) for c, x, y in zip(circles, low, high, strict=True)]
    pairs = poses(data, 100)[:, data["free"]]
    seen = script("all.map((p) => toolAt(map, p))", all=pairs.tolist())
    mine = script("all.map((t) => possible(robot, arm, t))", all=seen)
    arm = planar_arm(robot, held)
    for place, found in zip(arm.tool(pairs), mine, strict=True):
        theirs = np.array([p.q for p in postures(arm, place, ranges)])
        gap = np.array(found)[:, None] - theirs
        gap -= np.where(circles, math.tau * np.round(gap / math.tau), 0)
        same = np.abs(gap).max(axis=2) < 1e-6
        assert same.any(axis=0).all()
        assert same.any(axis=1).all()


@pytest.mark.parametrize("name", ROBOTS)
def test_the_singular_curve_is_where_the_posture_changes(name):
    _, _, _, script = case(name)
    pairs = poses(script.data)[:, script.data["free"]]
    det = np.array(script("all.map((p) => determinant(map, p))", all=pairs.tolist()))
    lines = np.sort(script("singularValues(arm)"))
    if len(lines) == 0:
        assert len(set(np.sign(det))) == 1
        return
    band = np.searchsorted(lines, pairs[:, 1]) % 2 if len(lines) == 2 else pairs[:, 1] > lines[0]
    assert len(set(np.sign(det[band == 0]))) == 1
    assert (np.sign(det[band == 0])[0] != np.sign(det[band == 1])).all()


def test_a_place_out_of_reach_gives_the_stretched_pose():
    _, _, _, script = case("paper")
    far = script("postures(arm, [300, 22.5])")
    line = min(script("singularValues(arm)"), key=abs)
    assert_allclose([p[1] for p in far], line, atol=1e-7)
    assert_allclose(script("toolAt(map, p)", p=far[0]), [np.hypot(15, 25.98) + 25, 22.5])


def test_the_mirrored_pose_mirrors_joints_and_tool_and_has_the_other_posture():
    robot, _, _, script = case("paper")
    q = poses(script.data)
    other = np.array(script("all.map((p) => mirroredPose(arm, p))", all=q.tolist()))
    tool = position(robot, robot.tool)
    assert_allclose(tool(other), tool(q) * [-1, 1, 1], atol=1e-11)
    elbows = [robot.frames(p).position("0", "2", "0")[..., [0, 2]] for p in (q, other)]
    assert_allclose(elbows[1], elbows[0] * [-1, 1], atol=1e-11)
    det = np.array(
        script("all.map((p) => determinant(map, p))", all=[*q.tolist(), *other.tolist()])
    )
    assert_allclose(det[:POSES], -det[POSES:], atol=1e-9 * np.abs(det).max())


# --- fibres ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_fibres_are_the_safe_values_of_the_second_joint(name):
    robot, held, _, script = case(name)
    q = poses(script.data, 400)
    first = script.data["free"][0]
    fibres = script(
        "(() => { const p = sliceProblem(robot, robot.q);"
        " return all.map((t) => fibre(p, t).free); })()",
        all=q[:, first].tolist(),
    )
    dense = np.linspace(*(script.data["views"][1][end] for end in ("low", "high")), 400)[1:-1]
    used = [restrict(clearance(robot, b), held) for b in robot.boundaries if b.used]
    for t, intervals in zip(q[:, first], fibres, strict=True):
        pairs = np.stack([np.full(len(dense), t), dense], axis=-1)
        safe = np.all([form(pairs) > 0 for form in used], axis=0)
        edges = np.array(intervals).reshape(-1, 2)
        inside = ((dense[:, None] > edges[:, 0]) & (dense[:, None] < edges[:, 1])).any(axis=1)
        assert np.array_equal(inside, safe)


@pytest.mark.parametrize("seed", range(4))
def test_fibres_of_a_scene_are_free_where_the_library_says(seed):
    _, region, script = among_obstacles(seed)
    pairs = poses(script.data, 50)[:, script.data["free"]]
    script.read("const problem = sliceProblem(robot, robot.q);")
    found = script(
        """all.map(([first, second]) => without(second, second + 1e-12, fibre(problem, first).free)
            .length === 0)""",
        all=pairs.tolist(),
    )
    margin = region.margins(pairs).min(axis=-1)
    clear = np.abs(margin) > 1e-9
    assert np.array_equal(np.array(found)[clear], (margin > 0)[clear])
    assert 2 < np.sum(found) < 48


@pytest.mark.parametrize("name", ROBOTS | SPATIAL)
def test_cells_of_a_slice_are_the_regions_components(name):
    _, _, region, script = case(name)
    cells = script("decompose(sliceProblem(robot, robot.q), 240).cells")
    pieces = {cell["piece"] for cell in cells}
    areas = {
        piece: sum(_area(cell["rows"]) for cell in cells if cell["piece"] == piece)
        for piece in pieces
    }
    assert len(pieces) == len(region.components)
    expected = sorted(component.area for component in region.components)
    assert_allclose(sorted(areas.values()), expected, rtol=2e-3)


def _area(rows):
    t, low, high = np.array(rows).T
    return float(np.trapezoid(high - low, t))


@pytest.mark.parametrize("name", ["paper", "PR", "3R, second held"])
def test_a_pose_lies_in_the_piece_that_the_library_names(name):
    _, _, region, script = case(name)
    pairs = poses(script.data, 500)[:, script.data["free"]]
    script.read("const all = decompose(sliceProblem(robot, robot.q), 240);")
    found = script("q.map((pair) => pieceAt(all.columns, all.of, pair))", q=pairs.tolist())
    clear = np.abs(region.margins(pairs).min(axis=-1)) > 1e-3 * script.data["reach"]
    expected = [region.component_of(pair) for pair in pairs]
    named = {(a, b) for a, b, c in zip(found, expected, clear, strict=True) if c}
    assert len(named) == len({a for a, _ in named}) == len({b for _, b in named})
    assert (None, None) in named
    assert len(named) > 1


def test_a_pose_at_a_limit_belongs_to_the_piece_beside_it():
    _, _, _, script = case("PR")
    script.read("const { columns, of } = decompose(sliceProblem(robot, robot.q), 240);")
    first, home = script.data["views"][0], script.data["q"][0]
    for end in (first["low"], first["high"]):
        near = [[end, 0.4], [0.999 * end + 0.001 * home, 0.4]]
        at, beside = script("near.map((pair) => pieceAt(columns, of, pair))", near=near)
        assert at == beside is not None


@pytest.mark.parametrize("value", [-0.8, 0.1, 1.5])
def test_a_slider_shows_the_slice_that_the_library_finds(value):
    robot, _, _, script = case("3R, second held")
    q = [*script.data["q"]]
    q[1] = value
    cells = script("decompose(sliceProblem(robot, q), 240).cells", q=q)
    expected = [component.area for component in find_region(robot, {1: value}).components]
    areas = [
        sum(_area(cell["rows"]) for cell in cells if cell["piece"] == piece)
        for piece in {cell["piece"] for cell in cells}
    ]
    assert_allclose(sorted(areas), sorted(expected), rtol=2e-3)


@pytest.mark.parametrize("name", ["paper", "RR", "RP", "PR", "PP", "3R, third held"])
def test_images_of_the_postures_have_the_area_that_the_determinant_gives(name):
    robot, _, region, script = case(name)
    images = script(
        "(() => { const p = sliceProblem(robot, robot.q);"
        " const { columns, of, cells } = decompose(p, 240);"
        " const home = pieceAt(columns, of, robot.free.map((j) => robot.q[j]));"
        " return postureImages(map, arm, cells.filter((c) => c.piece === home), p.ranges[1]); })()"
    )
    q = poses(script.data, 60_000)
    at_home = np.all([clearance(robot, b)(q) > 0 for b in robot.boundaries if b.used], axis=0)
    q = q[:, script.data["free"]]
    if len(region.components) > 1:
        outline = np.concatenate([arc.points for arc in region.home.loops[0]])
        at_home &= shapely.contains_xy(shapely.Polygon(outline), *q.T)
    det = np.array(script("all.map((p) => determinant(map, p))", all=q.tolist()))
    size = np.prod([view["high"] - view["low"] for view in script.data["views"]])
    for sign, side in ((1, "positive"), (-1, "negative")):
        union = shapely.union_all([shapely.make_valid(shapely.Polygon(p)) for p in images[side]])
        expected = size * (np.maximum(sign * det, 0) * at_home).mean()
        assert union.area == pytest.approx(expected, rel=0.02, abs=1e-9)


# --- polygons and paths ---------------------------------------------------------------------------


def test_a_path_is_the_librarys_traversal():
    robot, _, _, script = case("paper")
    corners = np.array(script.data["polygon"]["vertices"])
    walk = traverse(robot, corners, closed=True)
    steps = np.abs(np.diff(walk.q, axis=0)).max(axis=1)
    fractions = np.concatenate([[0], np.cumsum(steps)]) / steps.sum()
    found = script(
        "all.map((f) => alongPath(robot, stops, f))",
        all=fractions.tolist(),
        stops=[*corners.tolist(), corners[0].tolist()],
    )
    assert_allclose(found, walk.q, atol=1e-9)


@pytest.mark.parametrize("factor", [0.5, 0.9, 0.9650494, 1.0])
def test_the_smallest_clearance_of_a_scaled_polygon_is_that_of_its_edges(factor):
    robot, _, _, script = case("paper")
    hexagon = script.data["polygon"]
    found = script(
        "smallestClearance(robot, robot.q, p.vertices, f, p.centroid)", p=hexagon, f=factor
    )
    g = np.array(hexagon["centroid"])
    edges = g + factor * (np.array(hexagon["vertices"]) - g)
    values = {}
    for b in robot.boundaries:
        if b.used:
            least, _ = least_along_edges(clearance(robot, b), edges)
            required = getattr(b, "clearance", None)
            values[b.name] = (
                least if required is None else math.sqrt(max(0, least + required**2)) - required
            )
    name = min(values, key=lambda n: values[n])
    assert found["name"] == name
    assert_allclose(found["value"], values[name], atol=0.02)
    assert (found["value"] >= 0) == (factor <= hexagon["largest"])
