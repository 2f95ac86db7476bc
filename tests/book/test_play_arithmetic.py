"""The arithmetic of the figures that a reader moves in the chapters is the library's."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose

from cspace import clearance
from cspace.geometry import polygon
from cspace.measures import bodies, scaling
from cspace.paths.traversal import traverse
from engine_support.javascript import JavaScriptError
from lizarraga2025 import printed as paper
from qbound import joint_windows, window_region
from qbound.boundary import position
from qbound.circle import roots_along
from qbound.symbols import offset_values
from qbound.windows import window_box
from support.play import ROOT, kind

ROBOTS = ("minervabot-v2", "minervabot-v2-symmetric")
RNG = np.random.default_rng(12)


@pytest.fixture(autouse=True)
def same_numbers(monkeypatch):
    """Each test draws the same numbers, whichever ran before it."""
    monkeypatch.setitem(globals(), "RNG", np.random.default_rng(12))


def case(name, robot="minervabot-v2", rule="paper"):
    figure = kind(name, rule, robot)
    return figure.region.robot, figure


# --- Theorem 2 ------------------------------------------------------------------------------------


@pytest.mark.parametrize("reading", ["arctan", "atan2"])
def test_the_printed_interval_is_equation_31(reading):
    import sympy

    _, kind = case("circle")
    abc = RNG.uniform(-15, 15, (300, 3))
    abc = abc[np.abs(abc[:, 2]) < np.hypot(abc[:, 0], abc[:, 1])]
    names = sympy.symbols("a b c k", real=True)
    for struck in (False, True):
        found = kind(
            "all.map((x) => kind.printed(...x, quadrant, struck))",
            all=abc.tolist(),
            quadrant=reading == "atan2",
            struck=struck,
        )
        for column, side in enumerate(("31 lower", "31 upper")):
            formula = paper.expression(paper.THEOREM_2[side], arctan=reading)
            by_name = {symbol.name: symbol for symbol in formula.free_symbols}
            f = sympy.lambdify([by_name.get(n.name, n) for n in names], formula, "numpy")
            expected = f(*abc.T, 0) + 2 * np.pi * (struck and column == 0)
            assert_allclose(np.array(found)[:, column], expected, atol=1e-12)


def test_the_interval_that_opens_is_a_component_of_the_robot():
    robot, kind = case("circle")
    (window,) = (w for w in joint_windows(robot) if (w.boundary, w.component) == ("B2", 1))
    theorem = kind("circleArc(...kind.OPENS)")
    upper = theorem["theta"] + theorem["alpha"]
    assert upper == pytest.approx(window.upper, abs=1e-12)


# --- Figure 4 -------------------------------------------------------------------------------------


@pytest.mark.parametrize("reading", ["arctan", "atan2"])
def test_straight_bounds_are_those_of_table_6(reading):
    robot, kind = case("switches")
    values = offset_values(robot)
    found = kind(f"kind.straightBounds(robot, '{reading}')")
    assert len(found) == 16
    for bound in found:
        label = "beta_{{{},{component},{k}}}".format(bound["boundary"][1:], **bound)
        printed = paper.expression(paper.TABLE_6[label], arctan=reading).subs(values)
        assert bound["value"] == pytest.approx(float(printed), abs=1e-12)


def test_the_third_reading_adds_pi_where_a_is_negative():
    _, kind = case("switches")
    by_reading = [
        np.array([b["value"] for b in kind(f"kind.straightBounds(robot, '{reading}')")])
        for reading in ("atan2", "plus")
    ]
    moved = np.nonzero(np.abs(by_reading[1] - by_reading[0]) > 1e-9)[0]
    names = kind("kind.straightBounds(robot, 'plus').map((b) => b.boundary + b.component)")
    assert {names[i] for i in moved} == {"B33"}
    assert_allclose((by_reading[1] - by_reading[0])[moved], 2 * np.pi)


@pytest.mark.parametrize("name", ROBOTS)
def test_all_bounds_leave_the_region_of_the_papers_rule(name):
    robot, kind = case("switches", name)
    q = RNG.uniform(-np.pi, np.pi, (3000, 2))
    found = kind(
        "((s, w) => all.map((q) => kind.violatedBounds(s, w, q).length === 0))("
        "kind.straightBounds(robot, 'atan2'),"
        "kind.curvedWalls(robot).filter((w) => w.boundary === 'B7'))",
        all=q.tolist(),
    )
    assert np.array_equal(found, window_region(robot).contains(q))


@pytest.mark.parametrize("boundary", ["B5", "B6", "B7"])
def test_both_bounds_of_a_wall_are_the_wall(boundary):
    robot, kind = case("switches")
    q = RNG.uniform(-np.pi, np.pi, (2000, 2))
    found = kind(
        "((w) => all.map((q) => kind.violatedBounds([], w, q)))("
        f"kind.curvedWalls(robot).filter((w) => w.boundary === '{boundary}'))",
        all=q.tolist(),
    )
    form = clearance(robot, robot.boundary(boundary))
    assert [not names for names in found] == (form(q) >= 0).tolist()
    rows = kind(
        f"kind.curveRows(kind.curvedWalls(robot).find((w) => w.boundary === '{boundary}').matrix)"
    )
    first = np.array([row["first"] for row in rows])
    theirs = roots_along(form, 1, np.stack([first, first], -1))
    cuts = np.array([row["cuts"] for row in rows])
    assert (cuts != np.isfinite(theirs[0])).sum() <= 4  # a fold itself, to the last digit
    both = cuts & np.isfinite(theirs[0])
    for sign, root in zip((-1, 1), theirs, strict=True):
        mine = np.array([row["middle"] + sign * row["alpha"] for row in rows])
        assert_allclose(np.sin((mine - root)[both] / 2), 0, atol=1e-7)  # a fold: half the digits
    middles = np.array([row["middle"] for row in rows])
    assert np.abs(np.diff(middles)).max() < 0.1


def test_the_box_has_the_sides_of_the_rule():
    robot, kind = case("switches")
    square = [[-np.pi, np.pi]] * 2
    sides = kind("kind.box(kind.straightBounds(robot, 'atan2'), square)", square=square)
    box = window_box(robot)
    assert_allclose(
        [[s["value"] for s in pair] for pair in sides], np.transpose([box.lower, box.upper])
    )
    names = [s["by"] for pair in sides for s in pair]
    assert names == ["2,1,2", "1,3,1", "4,1,2", "3,3,1"]


def test_the_six_that_are_switched_on_alone_bound_the_region():
    robot, kind = case("switches")
    labels = {bound.label for bound in window_region(robot).bounds}
    assert {f"beta_{{{name}}}" for name in kind("kind.SIX")} == labels


# --- Figure 6 -------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [1.05, 1.0, 0.97, 0.9640384935995477, 0.95, 0.8, 0.3])
@pytest.mark.parametrize("name", ROBOTS)
def test_depths_along_edges_are_the_librarys(name, scale):
    robot, kind = case("scale", name)
    corners = window_region(robot).polygon
    scaled = polygon.scaled(corners, scale, polygon.centroid(corners))
    floor = clearance(robot, robot.boundary("B7"))
    found = kind("kind.edges(kind.floorOf(robot), robot.polygon, scale)", scale=scale)
    for edge, one in zip(np.stack([scaled, np.roll(scaled, -1, axis=0)], 1), found, strict=True):
        value, _ = scaling.least_along_edges(floor, edge)
        assert one["value"] == pytest.approx(value, abs=1e-9)
        assert float(floor(np.array(one["q"]))) == pytest.approx(value, abs=1e-9)


# --- bodies ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ROBOTS)
def test_gaps_and_overlaps_of_bodies_are_those_of_shapely(name):
    robot, kind = case("bodies", name, "clearance")
    q = RNG.uniform(-np.pi, np.pi, (400, 2))
    found = kind(
        "all.map((q) => bodyGaps(robot, placedParts(robot, framesOf(robot, q))))", all=q.tolist()
    )
    names = kind("robot.bodies.map(({ name }) => name)")
    theirs = bodies.gaps(robot, q)
    assert len(found[0]) > 0
    for i, pose in enumerate(q):
        placed = {b.name: shapely.Polygon(bodies.outline(robot, b, pose)) for b in robot.bodies}
        for mine in found[i]:
            pair = tuple(names[k] for k in mine["bodies"])
            one, other = (placed[name] for name in pair)
            assert mine["overlap"] == (one.intersection(other).area > 1e-7)
            if theirs[pair][i] < 0:
                assert mine["gap"] == pytest.approx(theirs[pair][i], abs=1e-9)
            else:
                assert mine["gap"] == pytest.approx(one.distance(other), abs=1e-9)


def numbered(region, pairs):
    """The number of each pair's region by the library's exact arcs; None where it is not safe."""
    found = [region.component_of(pair) for pair in pairs]
    return [None if one is None else one + 1 for one in found]


# --- traversals -----------------------------------------------------------------------------------


def test_the_ways_visit_the_six_points_as_chapter_8_does():
    figure = kind("traversals", "paper")
    ways = {way["name"]: way["stops"] for way in figure("kind.waysOf(robot, 0.95)")}
    vertices = window_region(figure.region.robot).polygon
    points = polygon.scaled(vertices, 0.95, polygon.centroid(vertices))
    for name, order in (("all", "1234561"), ("right", "61234"), ("left", "34561")):
        assert_allclose(ways[name], points[[int(k) - 1 for k in order]], atol=1e-6)


def test_the_mirror_image_has_the_mirrored_tool_and_lies_beyond_the_singular_curve():
    figure = kind("traversals", "paper")
    tool = position(figure.region.robot, figure.region.robot.tool)
    *_, mirror = figure("kind.waysOf(robot, 0.95)")
    start, end = tool(np.array(mirror["stops"]))[:, [0, 2]]
    assert_allclose(end, start * [-1, 1], atol=1e-9)
    sides = figure(
        "mirror.stops.map((pair) => determinant(toolMap(robot, robot.q), pair))", mirror=mirror
    )
    assert sides[0] * sides[1] < 0


@pytest.mark.parametrize("name", ["all", "right", "left"])
def test_the_drawn_path_is_the_tools(name):
    figure = kind("traversals", "paper")
    (way,) = (w for w in figure("kind.waysOf(robot, 0.95)") if w["name"] == name)
    drawn = figure("kind.toolPath(robot, toolMap(robot, robot.q), stops, 1)", stops=way["stops"])
    exact = traverse(figure.region.robot, np.array(way["stops"])).tool[:, [0, 2]]
    apart = np.linalg.norm(np.array(drawn)[:, None] - exact[None], axis=-1)
    assert apart.min(axis=1).max() < 0.3  # cm: two samplings of one curve
    assert_allclose([drawn[0], drawn[-1]], exact[[0, -1]], atol=1e-9)


def test_a_fraction_of_the_way_lies_on_the_leg_between_its_stops():
    figure = kind("traversals", "paper")
    (way,) = (w for w in figure("kind.waysOf(robot, 0.95)") if w["name"] == "all")
    places = figure("stopsAt(robot, stops)", stops=way["stops"])
    assert places[0] == 0
    assert places[-1] == pytest.approx(1)
    for leg, (a, b) in enumerate(pairwise(places)):
        middle = (a + b) / 2
        assert figure("kind.legOf(robot, s, t)", s=way["stops"], t=middle) == leg
        at = figure("alongPath(robot, s, t)", s=way["stops"], t=middle)
        assert_allclose(at, np.mean(way["stops"][leg : leg + 2], axis=0), atol=1e-9)
    assert figure("kind.legOf(robot, s, 1)", s=way["stops"]) == len(way["stops"]) - 2


def test_without_a_polygon_there_is_nothing_to_walk_round():
    figure = kind("traversals", robot="pp-portal")
    if figure("robot.polygon") is None:
        with pytest.raises(JavaScriptError, match="need a region with a polygon"):
            figure("kind.waysOf(robot, 0.95)")


# --- which region ---------------------------------------------------------------------------------


@pytest.mark.parametrize("rule", ["clearance", "paper"])
def test_a_pose_is_in_the_region_that_the_library_names(rule):
    figure = kind("postures", rule)
    pairs = RNG.uniform(-np.pi, np.pi, (600, 2))
    found = figure("all.map((pair) => kind.judge(robot, pair))", all=pairs.tolist())
    expected = numbered(figure.region, pairs)
    assert [one["region"] for one in found] == expected
    assert [one["safe"] for one in found] == figure.region.contains(pairs).tolist()
    assert {1, None} <= set(expected)


@pytest.mark.parametrize("rule", ["clearance", "paper"])
def test_the_other_posture_holds_the_tool_at_the_same_place(rule):
    figure = kind("postures", rule)
    tool = position(figure.region.robot, figure.region.robot.tool)
    pairs = RNG.uniform(-np.pi, np.pi, (300, 2))
    others = figure("all.map((pair) => kind.otherPosture(robot, pair))", all=pairs.tolist())
    assert_allclose(tool(np.array(others)), tool(pairs), atol=1e-9)
    assert np.abs(np.array(others) - pairs).max(axis=1).min() > 1e-6


# --- the arm that stops ---------------------------------------------------------------------------


def inner_pairs(figure, count):
    """Safe pairs, some of every region."""
    pairs = RNG.uniform(-np.pi, np.pi, (40 * count, 2))
    safe = pairs[figure.region.contains(pairs)]
    numbers = np.array(numbered(figure.region, safe))
    chosen = [safe[numbers == k][:count] for k in range(1, len(figure.region.components) + 1)]
    assert all(len(some) > 0 for some in chosen)
    return np.concatenate(chosen)


def test_the_arm_never_leaves_its_region_whatever_the_hand_asks():
    figure = kind("regions")
    starts = inner_pairs(figure, 12)
    goals = RNG.uniform(-np.pi, np.pi, starts.shape)
    moves = np.stack([starts, goals], axis=1).tolist()
    found = figure("all.map(([a, b]) => kind.slide(robot, kind.rulesOf(robot), a, b))", all=moves)
    ends = np.array([one["at"] for one in found])
    assert figure.region.contains(ends).all()
    assert numbered(figure.region, ends) == numbered(figure.region, starts)


def test_a_way_that_nothing_bars_is_gone_to_its_end():
    figure = kind("regions")
    (home,) = (one for one in figure.region.components if one.contains_home)
    starts = RNG.uniform(-0.2, 0.2, (20, 2)) + home.centroid
    for a, b in zip(starts, starts[::-1], strict=True):
        rules = "kind.slide(robot, kind.rulesOf(robot), a, b)"
        found = figure(rules, a=a.tolist(), b=b.tolist())
        assert_allclose(found["at"], b, atol=1e-9)
        assert found["by"] == []


def test_what_stops_the_arm_is_violated_a_step_further_and_named():
    figure = kind("regions")
    centroid = figure.region.components[0].centroid
    for direction, name in (((1, 0), "B7"), ((-1, 0), "B7"), ((0, 1), "B3"), ((0, -1), "B4")):
        goal = np.asarray(centroid) + np.radians(175) * np.array(direction)
        found = figure(
            "kind.slide(robot, kind.rulesOf(robot), a, b)", a=list(centroid), b=goal.tolist()
        )
        (wall, *_) = found["by"]
        beyond = np.array(found["at"]) + np.radians(0.3) * np.array(direction)
        margins = dict(zip(figure.region.boundaries, figure.region.margins(beyond), strict=True))
        assert margins[wall["name"]] < 0
        assert wall["name"] == name


def test_behind_a_wall_lies_the_region_that_the_library_finds_there():
    figure = kind("regions")
    centroid = np.array(figure.region.components[0].centroid)
    goal = [centroid[0], np.radians(120)]
    found = figure("kind.slide(robot, kind.rulesOf(robot), a, b)", a=centroid.tolist(), b=goal)
    next_one = figure(
        "kind.behind(robot, kind.rulesOf(robot), a, b)", a=found["at"], b=found["goal"]
    )
    assert [next_one["region"]] == numbered(figure.region, [next_one["pair"]]) == [2]
    recorded = json.loads((ROOT / "results" / "every_region.json").read_text("utf-8"))["results"]
    width = {entry["id"]: entry["value"] for entry in recorded}["wall.B3.width"]
    assert np.degrees(next_one["width"]) == pytest.approx(width, abs=0.15)
