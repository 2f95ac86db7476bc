"""Forms that a live figure is told: the page evaluates them to what the library says."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose

from cspace import find_region, load_robot
from cspace.boundary.evaluator import evaluator
from cspace.explorer.data import figure_data
from cspace.explorer.page import ARITHMETIC, figure_text
from cspace.measures.bodies import gaps, overlap_pairs
from cspace.region import find_slices, solve, window_problem
from cspace.workspace.planar import planar_arm, postures
from engine_support import body_scenes
from engine_support.arms import ROBOTS, SPATIAL
from engine_support.javascript import Script
from qbound import window_region
from qbound.circle import circle_arc, circle_roots

POSES = 500
EDGES = [(3, 4, c) for c in (-6, -5, 2, 5, 6)] + [(0, 0, c) for c in (-1, 0, 1)] + [(-1, 0, 0)]


class Arithmetic(Script):
    """The arithmetic of the page, and a robot."""

    def __init__(self, data=None):
        super().__init__(*map(figure_text, ARITHMETIC))
        if data:
            self.read(f"const robot = prepare({json.dumps(data)});")


@cache
def case(name):
    robot, held = (ROBOTS | SPATIAL)[name]()
    region = find_region(robot, held)
    data = figure_data(region)
    return region, data, Arithmetic(data)


@cache
def scene(seed):
    """A scene of capsules, polygons and discs, every fourth of the same two kinds of joints."""
    kinds = ("RR", "RP", "PR", "PP")[seed % 4]
    region = find_region(body_scenes.robot(body_scenes.ordinary(seed, kinds)))
    data = figure_data(region)
    return region, data, Arithmetic(data)


def poses(data, seed=5):
    low, high = (np.array([joint[end] for joint in data["joints"]]) for end in ("low", "high"))
    return np.random.default_rng(seed).uniform(low, high, (POSES, 2))


def whole(region, q):
    """Poses of all joints: the free ones as given, the others as the region holds them."""
    full = np.tile(region.robot.home.astype(float), (len(q), 1))
    full[:, list(region.problem.held)] = list(region.problem.held.values())
    full[:, list(region.problem.joints)] = q
    return full


def judged(script, q):
    """The values of all boundaries in use, and the pairs of bodies that overlap."""
    told = "({ values, overlaps }) => [values.map(({ value }) => value), overlaps]"
    return script(f"all.map((q) => judge(robot, q)).map({told})", all=q.tolist())


def by_library(region, q):
    """Margins by the names of the boundaries in use."""
    found = evaluator(region.robot).margins(whole(region, q))
    return dict(zip(evaluator(region.robot).names, found.T, strict=True))


def assert_margins(region, data, script, q):
    values = np.array([row[0] for row in judged(script, q)]).T
    names = [wall["name"] for wall in data["walls"] if wall["used"]]
    expected = by_library(region, q)
    assert names == [name for name in expected if name in names]
    for name, found in zip(names, values, strict=True):
        apart = np.minimum(found, expected[name]) > 0
        assert_allclose(found[apart], expected[name][apart], atol=1e-9 * data["reach"])
        assert ((found < -1e-9) <= (expected[name] < 0)).all()
        assert ((expected[name] < -1e-9) <= (found < 0)).all()


@pytest.mark.parametrize("name", [*ROBOTS, *SPATIAL])
def test_the_page_has_the_librarys_margins(name):
    region, data, script = case(name)
    assert_margins(region, data, script, poses(data))


@pytest.mark.parametrize("name", [*ROBOTS, *SPATIAL])
def test_the_page_has_the_librarys_regions(name):
    """Each pose is found in its region, so is the inner pose of each; arcs lie on boundaries."""
    region, data, script = case(name)
    q, names = poses(data), [wall["name"] for wall in data["walls"] if wall["used"]]
    values = np.array([row[0] for row in judged(script, q)])
    sure = np.abs(values).min(axis=1) > 1e-3 * data["reach"]
    found = np.array(script("all.map((q) => regionAt(robot, q))", all=q.tolist()))
    assert (found == region.component_of(q))[sure].all()
    centres = [one["centre"] for one in data["regions"]]
    assert list(map(region.component_of, centres)) == list(range(len(region.components)))
    arcs = [arc for one in data["regions"] for loop in one["loops"] for arc in loop]
    for arc in (arc for arc in arcs if arc["wall"] in names):
        on = [row[0][names.index(arc["wall"])] for row in judged(script, np.array(arc["points"]))]
        assert_allclose(on, 0, atol=2e-5 * data["reach"])


@pytest.mark.parametrize("seed", range(12))
def test_the_page_has_the_librarys_margins_among_obstacles(seed):
    region, data, script = scene(seed)
    assert_margins(region, data, script, poses(data))


@pytest.mark.parametrize("name", [*ROBOTS, *SPATIAL])
def test_the_page_places_the_tool_as_the_library(name):
    """A picture keeps lengths in its plane: distances between places of the tool are the same."""
    region, data, script = case(name)
    q = poses(data)
    seen = np.array(
        script(
            "all.map((q) => robot.tool.map((f) => evaluate(f, ...factors(robot, q))))",
            all=q.tolist(),
        )
    )
    placed = np.array(region.robot.forward_kinematics(whole(region, q)))
    apart = np.linalg.norm(np.diff(placed, axis=0), axis=1)
    shown = np.linalg.norm(np.diff(seen, axis=0), axis=1)
    assert (shown <= apart + 1e-9 * data["reach"]).all()
    if name in ROBOTS:
        assert_allclose(shown, apart, atol=1e-9 * data["reach"])


@pytest.mark.parametrize("name", [*ROBOTS])
def test_bodies_overlap_on_the_page_where_they_do_in_the_library(name):
    region, data, script = case(name)
    q, pairs = poses(data), overlap_pairs(region.robot)
    if not pairs:
        assert data["apart"] == []
        return
    names = [body["name"] for body in data["bodies"]]
    found = [
        {tuple(names[i] for i in one["bodies"]) for one in row[1]} for row in judged(script, q)
    ]
    depths = gaps(region.robot, whole(region, q))
    for k, deep in enumerate(found):
        sure = {pair for pair in pairs if abs(depths[pair][k]) > 1e-8 * data["reach"]}
        assert deep & sure == {pair for pair in sure if depths[pair][k] < 0}


def test_the_papers_windows_and_its_polygon_are_told():
    """The box of Table 6 has its ends among the told windows; its pairs ask for no distance."""
    robot = load_robot("minervabot-v2")
    region = window_region(robot)
    data = figure_data(solve(window_problem(region)))
    pairs = [wall for wall in data["walls"] if wall["used"] and wall["line"] is None]
    assert [wall["required"] for wall in pairs] == [0, 0, 0, 0]
    ends = Arithmetic()(
        "all.map(({ a, b, c }) => arcOf(a, b, c)).map(({ middle, half }) => middle + half)",
        all=data["windows"],
    )
    for joint in (0, 1):
        own = [end for end, one in zip(ends, data["windows"], strict=True) if one["joint"] == joint]
        for end in (region.box.lower[joint], region.box.upper[joint]):
            assert min(abs(np.remainder(own - end + np.pi, 2 * np.pi) - np.pi)) < 1e-9
    assert_allclose(data["polygon"]["vertices"], region.polygon, atol=1e-12)
    assert_allclose(data["polygon"]["largest"], 0.9640384935, atol=1e-9)
    told = figure_data(find_region(robot), [(5, 0, 1), (6, 0)])  # there is no seventh vertex
    assert told["polygon"]["walks"] == [[0, 1, 2, 3, 4, 5, 0], [5, 0, 1]]


def test_the_arc_of_theorem_2_is_the_librarys():
    abc = np.vstack([np.random.default_rng(12).uniform(-15, 15, (2000, 3)), EDGES])
    found = Arithmetic()("all.map((x) => arcOf(...x))", all=abc.tolist())
    roots, arc = circle_roots(*abc.T), circle_arc(*abc.T)
    assert [one["roots"] for one in found] == roots.count.tolist()
    assert [one["half"] < 0 for one in found] == arc.empty.tolist()
    some = np.array([one["half"] >= 0 for one in found])
    assert_allclose(np.array([one["middle"] for one in found])[some], arc.centre[some], atol=1e-14)
    assert_allclose(
        np.array([one["half"] for one in found])[some], arc.half_width[some], atol=1e-12
    )


def test_a_slice_of_a_row_is_the_region_at_that_value():
    robot, held = ROBOTS["3R, first held"]()
    [(along, opened)] = held.items()
    values = [opened - 0.1, opened, opened + 0.2]
    row = find_slices(robot, along, values, {})
    data = figure_data(find_region(robot, held), row=row)["row"]
    assert [one["value"] for one in data["slices"]] == values
    for value, one in zip(values, data["slices"], strict=True):
        alone = figure_data(find_region(robot, {along: value}))
        assert one == {"value": value} | {key: alone[key] for key in one if key != "value"}


# --- geometry -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS)
def test_every_posture_at_a_place_is_found(name):
    region, data, script = case(name)
    arm = planar_arm(region.robot, region.problem.held)
    joints = data["joints"]
    wraps = np.array([joint["wraps"] for joint in joints])
    ranges = [None if joint["wraps"] else (joint["low"], joint["high"]) for joint in joints]
    q = poses(data)[:40]
    told = "robot.tool.map((form) => evaluate(form, ...factors(robot, q)))"
    found = script(f"all.map((q) => posesAt(robot, robot.tool, {told}))", all=q.tolist())
    for place, mine in zip(arm.tool(q), found, strict=True):
        theirs = np.array([posture.q for posture in postures(arm, place, ranges)])
        gap = np.array(mine)[:, None] - theirs
        gap -= np.where(wraps, 2 * np.pi * np.round(gap / (2 * np.pi)), 0)
        same = np.abs(gap).max(axis=2) < 1e-4
        assert same.any(axis=0).all()
        assert same.any(axis=1).all()


def test_distances_of_convex_parts_are_shapelys_and_depths_a_way_out():
    rng, overlaps = np.random.default_rng(8), 0
    shapes = {1: lambda c: shapely.Point(c[0]), 2: shapely.LineString}

    def core(corners):
        return shapes.get(len(corners), shapely.Polygon)(corners)

    def convex():
        count = rng.integers(1, 7)
        turns = np.sort(rng.uniform(0, 2 * np.pi, count))
        return np.stack([np.cos(turns), np.sin(turns)], axis=-1) + rng.uniform(-1.2, 1.2, 2)

    for _ in range(300):
        one, other = convex(), convex()
        found = Arithmetic()("gapOf(one, other)", one=one.tolist(), other=other.tolist())
        apart = core(one).distance(core(other))
        if apart > 0:
            assert found["gap"] == pytest.approx(apart, abs=1e-12)
            assert np.hypot(*np.subtract(*found["ends"])) == pytest.approx(apart, abs=1e-12)
        else:
            overlaps += 1
            assert found["gap"] <= 1e-12
    assert 50 < overlaps < 250


@pytest.mark.parametrize("name", ["paper", "RP", "PR", "PP"])
def test_an_arm_that_stops_passes_no_boundary_and_goes_on_where_one_joint_may(name):
    region, data, script = case(name)
    starts = poses(data)
    starts = starts[region.contains(starts)][:60]
    ends = poses(data, 6)[:60]
    slid = script(
        "all.map(([a, b]) => slide(robot, a, b).at)", all=np.stack([starts, ends], axis=1).tolist()
    )
    assert region.contains(np.array(slid)).all()
    assert (region.component_of(np.array(slid)) == region.component_of(starts)).all()
    moved = np.linalg.norm(np.array(slid) - starts, axis=1)
    assert (moved > 0.1).mean() > 0.5
