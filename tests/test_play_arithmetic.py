"""The arithmetic of the figures that a reader moves in the chapters is the library's."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose

from lizarraga2025 import closed_form
from lizarraga2025 import printed as paper
from qbound import clearance
from qbound.geometry import polygon
from qbound.measures import bodies, scaling
from qbound.region import paper_rule
from qbound.symbols import with_symbols
from support.play import kind

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
    (window,) = (w for w in paper_rule.windows(robot) if (w.boundary, w.component) == ("B2", 1))
    theorem = kind("circleArc(...kind.OPENS)")
    upper = theorem["theta"] + theorem["alpha"]
    assert upper == pytest.approx(window.upper, abs=1e-12)


# --- Figure 4 -------------------------------------------------------------------------------------


@pytest.mark.parametrize("reading", ["arctan", "atan2"])
def test_straight_bounds_are_those_of_table_6(reading):
    robot, kind = case("switches")
    values = with_symbols(robot)[1]
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
    assert np.array_equal(found, paper_rule.feasible(robot, q))


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
    theirs = closed_form.geometric_bounds(robot, boundary, np.stack([first, first], -1))
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
    box = paper_rule.box(robot)
    assert_allclose(
        [[s["value"] for s in pair] for pair in sides], np.transpose([box.lower, box.upper])
    )
    names = [s["by"] for pair in sides for s in pair]
    assert names == ["2,1,2", "1,3,1", "4,1,2", "3,3,1"]


def test_the_six_that_are_switched_on_alone_bound_the_region():
    robot, kind = case("switches")
    labels = {bound.label for vertex in closed_form.vertices(robot) for bound in vertex.bounds}
    assert {f"beta_{{{name}}}" for name in kind("kind.SIX")} == labels


# --- Figure 6 -------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [1.05, 1.0, 0.97, 0.9640384935995477, 0.95, 0.8, 0.3])
@pytest.mark.parametrize("name", ROBOTS)
def test_depths_along_edges_are_the_librarys(name, scale):
    robot, kind = case("scale", name)
    corners = np.array([v.q for v in closed_form.vertices(robot)])
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
    found = kind("all.map((q) => kind.bodyPairs(robot, q))", all=q.tolist())
    areas = kind(
        "all.map((q) => kind.bodyPairs(robot, q).map((p) => area(p.shared)))", all=q.tolist()
    )
    theirs = bodies.gaps(robot, q)
    for i, pose in enumerate(q):
        placed = {b.frame: shapely.Polygon(bodies.outline(robot, b, pose)) for b in robot.bodies}
        for k, frames in enumerate(combinations(placed, 2)):
            one, other = (placed[frame] for frame in frames)
            mine = found[i][k]
            assert [str(f) for f in mine["frames"]] == list(frames)
            assert areas[i][k] == pytest.approx(one.intersection(other).area, abs=1e-7)
            if theirs[frames][i] < 0:
                assert mine["gap"] == pytest.approx(theirs[frames][i], abs=1e-9)
            else:
                assert mine["gap"] == pytest.approx(one.distance(other), abs=1e-9)
