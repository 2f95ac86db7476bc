"""Figures 7 to 11 and the regions, as a reader moves them: their arithmetic is the library's."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lizarraga2025 import closed_form
from qbound.boundary.functions import position
from qbound.geometry import polygon
from qbound.paths.traversal import traverse
from support.javascript import JavaScriptError
from support.play import ROOT, kind

RNG = np.random.default_rng(12)


@pytest.fixture(autouse=True)
def same_numbers(monkeypatch):
    """Each test draws the same numbers, whichever ran before it."""
    monkeypatch.setitem(globals(), "RNG", np.random.default_rng(12))


def numbered(region, pairs):
    """The number of each pair's region by the library's exact arcs; None where it is not safe."""
    found = [region.component_of(pair) for pair in pairs]
    return [None if one is None else one + 1 for one in found]


# --- traversals -----------------------------------------------------------------------------------


def test_the_ways_visit_the_six_points_as_chapter_8_does():
    figure = kind("traversals", "paper")
    ways = {way["name"]: way["stops"] for way in figure("kind.waysOf(robot, 0.95)")}
    vertices = np.array([corner.q for corner in closed_form.vertices(figure.region.robot)])
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
