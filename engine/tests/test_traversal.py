"""Traversals: straight in joint space, the tool by 4 x 4 matrices, crossings against shapely."""

import csv
import io
import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from shapely.geometry import Polygon

from cspace import find_region, load_robot
from cspace.export.routes import route_csv, route_document, route_lines
from cspace.geometry.polygon import centroid, scaled
from cspace.model.robot import Prismatic, Revolute
from cspace.model.robotfile import parse_robot
from cspace.paths.traversal import (
    lowest,
    plan_route,
    reach,
    report,
    traverse,
)
from cspace.proofs.certificates.statements import usual_inset
from cspace.sampling import keeps_clear
from engine_support.ball_arms import parallelogram_arm
from engine_support.commands import follows_schema
from engine_support.oracles import (
    frame_matrix,
    packaged_table,
    point_seen_from,
    robot_tables,
)
from qbound import window_region

MINERVA = load_robot("minervabot-v2")
TABLE = packaged_table()
SIX = window_region(MINERVA).polygon
SMALL = scaled(SIX, 0.9, centroid(SIX))


@pytest.mark.parametrize("closed", [False, True])
def test_joint_path_is_straight_from_stop_to_stop(closed) -> None:
    path = traverse(MINERVA, SIX, closed=closed, step=0.05)
    stops = np.concatenate([SIX, SIX[:1]]) if closed else SIX
    assert_array_equal(path.q[path.stops], stops)
    assert np.abs(np.diff(path.q, axis=0)).max() <= 0.05 + 1e-12
    for (i, j), (a, b) in zip(pairwise(path.stops), pairwise(stops), strict=True):
        t = np.linspace(0, 1, j - i + 1)[:, None]
        assert_allclose(path.q[i : j + 1], a + t * (b - a), atol=1e-13)
    assert_array_equal(path.final_pose, stops[-1])


def test_tool_and_reach_are_forward_kinematics() -> None:
    """Distance from the shoulder, o_1, and not from the base."""
    path = traverse(MINERVA, SMALL, step=0.2)
    for q, tool, far in zip(path.q, path.tool, path.reach, strict=True):
        assert_allclose(tool, point_seen_from(TABLE, "3", "0", q), atol=1e-12)
        assert far == pytest.approx(np.linalg.norm(tool - [0, 0, 22.5]))


def test_reach_is_greatest_with_the_links_in_line() -> None:
    """hypot(15, 25.98) + 25 cm at most, met where q_2 makes them collinear."""
    in_line = np.arctan2(-25.98, 15.0)  # link 2 along link 1
    reach = traverse(MINERVA, [[0.3, in_line - 1], [0.3, in_line], [0.3, in_line + 1]]).reach
    assert reach.max() == pytest.approx(np.hypot(15, 25.98) + 25, abs=1e-9)
    assert reach.argmax() == len(reach) // 2


@settings(max_examples=15)
@given(robot_tables(), st.data())
def test_reach_is_measured_from_the_first_frame_of_any_chain(table, data) -> None:
    """A first joint that slides takes its frame along."""
    robot, n = parse_robot(table), len(table["joint"])
    stops = np.array(
        data.draw(
            st.lists(st.lists(st.integers(-2, 2), min_size=n, max_size=n), min_size=2, max_size=3)
        )
    )
    path = traverse(robot, stops, step=0.5)
    for q, far in zip(path.q, path.reach, strict=True):
        shoulder = frame_matrix(table, "1", q)[:3, 3]
        tool = point_seen_from(table, robot.tool, "0", q)
        assert far == pytest.approx(np.linalg.norm(tool - shoulder), abs=1e-9)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_path_through_no_number_is_refused(bad) -> None:
    with np.errstate(all="ignore"), pytest.raises((ValueError, OverflowError)):
        traverse(MINERVA, [[0, 0], [bad, 0]])


# --- deviation -----------------------------------------------------------------------------------


@settings(max_examples=20, deadline=None)
@given(robot_tables(), st.data())
def test_the_tool_is_nowhere_farther_from_the_polyline_than_is_stated(table, data) -> None:
    """Any chain, revolute and prismatic, askew: dense places against the rows' polyline."""
    robot, n = parse_robot(table), len(table["joint"])
    values = st.lists(st.integers(-20, 20).map(lambda k: k / 10), min_size=n, max_size=n)
    stops = np.array(data.draw(st.lists(values, min_size=2, max_size=3)))
    wanted = data.draw(st.sampled_from([5.0, 0.5, 0.05]))
    path = traverse(robot, stops, deviation=wanted)
    assert path.proved
    assert path.deviation <= wanted
    places = (path.s[:-1, None] + np.diff(path.s)[:, None] * np.linspace(0, 1, 9)).ravel()
    for s, q in zip(places[::23], path.at(places[::23]), strict=True):
        tool = point_seen_from(table, robot.tool, "0", q)
        row = min(np.searchsorted(path.s, s, side="right") - 1, len(path.s) - 2)
        a, b = path.tool[row], path.tool[row + 1]
        chord = (b - a) @ (b - a)
        t = np.clip((tool - a) @ (b - a) / chord, 0, 1) if chord > 0 else 0.0
        assert np.linalg.norm(tool - a - t * (b - a)) <= path.deviation + 1e-9


TURN_ONE = {"origin": [0, 0, 0], "axis": [0, 1, 0], "type": "revolute"}
SLIDE = {"origin": [0, 0, 0], "axis": [1, 0, 0], "type": "prismatic", "limits": [-9, 9]}


@pytest.mark.parametrize(
    ("joints", "tip", "end"),
    [
        ([TURN_ONE], 10.0, [1.0]),
        ([TURN_ONE, TURN_ONE], 10.0, [0.6, 0.4]),  # both turn one link: rates add up
        ([TURN_ONE, TURN_ONE | {"origin": [10.0, 0, 0]}], 0.0, [1.0, 0.4]),  # the first turns it
        ([TURN_ONE, SLIDE], 0.0, [0.02, 8.0]),  # outwards while it turns
    ],
    ids=["one turn", "two turns", "the inner link", "a slide that turns"],
)
def test_the_bound_on_the_deviation_is_no_idle_one(joints, tip, end) -> None:
    """The true deviation, at a hundred places between two rows, is within 5 % of the bound."""
    chain = [
        joint | {"name": f"q{i}", "parent": str(i), "frame": str(i + 1)}
        for i, joint in enumerate(joints)
    ]
    table = packaged_table() | {"joint": chain, "boundary": [], "body": [], "tool": "t"}
    table |= {"home": {joint["name"]: 0.0 for joint in chain}, "angle_unit": "rad"}
    table["point"] = [{"name": "t", "frame": str(len(chain)), "at": [tip, 0.0, 0.0]}]
    robot = parse_robot(table)
    path = traverse(robot, [[0.0] * len(end), end], deviation=0.005)
    exact = farthest_from_rows(robot, path)
    assert exact <= path.deviation <= 0.005
    assert path.deviation <= 1.05 * exact


@pytest.mark.parametrize("frame", ["2", "bar", "3"])
@pytest.mark.parametrize("last", [Revolute, Prismatic])
@pytest.mark.parametrize("seed", range(4))
def test_the_deviation_that_is_stated_for_a_parallelogram_holds_its_crank(seed, last, frame):
    robot = replace(parallelogram_arm(seed, last), tool=f"p{frame}")
    stops = np.random.default_rng(seed).uniform(-1, 1, (4, 3)) * [3, 2, 1]
    for wanted in (1.0, 0.01):
        path = traverse(robot, stops, deviation=wanted)
        assert path.proved
        assert path.deviation <= wanted
        assert farthest_from_rows(robot, path) <= path.deviation + 1e-12


def test_two_parallelograms_go_round_circles_and_not_straight():
    """It stated 0.0 for two rows; the tool was 0.46 away."""
    crank = {"type": "parallelogram", "origin": [0, 0, 0], "axis": [0, 0, 1]}
    one = crank | {"name": "one", "parent": "0", "frame": "a", "crank": [1, 0, 0], "bar": "x"}
    two = crank | {"name": "two", "parent": "a", "frame": "b", "crank": [0.5, 0, 0], "bar": "y"}
    table = packaged_table() | {"joint": [one, two], "boundary": [], "body": [], "tool": "t"}
    table |= {"home": {"one": 0, "two": 0}, "angle_unit": "rad"}
    table["point"] = [{"name": "t", "frame": "b", "at": [0, 0, 0]}]
    robot = parse_robot(table)
    path = traverse(robot, [[0, 0], [2, 0]], deviation=0.01)
    assert 0.9 * path.deviation < farthest_from_rows(robot, path) <= path.deviation <= 0.01
    assert usual_inset(robot) == pytest.approx(0.015)  # a hundredth of both cranks


def farthest_from_rows(robot, path):
    """The farthest that the tool is from the straight line between two rows, at 99 places."""
    t = np.linspace(0, 1, 101)[1:-1]
    between = path.at((path.s[:-1, None] + np.diff(path.s)[:, None] * t).ravel())
    tool = robot.forward_kinematics(between).reshape(len(path.s) - 1, len(t), 3)
    tool -= path.tool[:-1, None]
    chord = np.diff(path.tool, axis=0)[:, None]
    along = (tool * chord).sum(axis=-1, keepdims=True) / (chord**2).sum(axis=-1, keepdims=True)
    return float(np.linalg.norm(tool - along * chord, axis=-1).max())


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan])
def test_a_deviation_that_is_not_above_zero_is_refused(bad) -> None:
    with pytest.raises(ValueError, match="above 0"):
        traverse(MINERVA, SIX, deviation=bad)


def test_one_vertex_is_no_path() -> None:
    with pytest.raises(ValueError, match="two vertices"):
        traverse(MINERVA, SIX[:1])


# --- routes by number and what they meet ----------------------------------------------------------


REGION = find_region(MINERVA)
ARCS = [arc for loop in REGION.components[0].loops for arc in loop]
CORNERS = np.array([vertex.q for vertex in REGION.components[0].vertices])


def test_a_closed_route_visits_scaled_vertices_and_returns():
    route = plan_route(REGION, [3, 1, 2], closed=True, scale=0.5)
    centre = np.array(Polygon(CORNERS).centroid.coords[0])
    wanted = centre + 0.5 * (CORNERS[[2, 0, 1, 2]] - centre)
    assert_allclose(route.path.q[route.path.stops], wanted, atol=1e-12)
    assert route.stops == ("3", "1", "2", "3")
    assert route.legs == ("3 to 1", "1 to 2", "2 to 3")
    assert (route.order, route.along, route.scale) == ((3, 1, 2), "lines", 0.5)
    assert [route.leg_of(s) for s in (0, 0.9, 1.0, 3.0)] == ["3 to 1", "3 to 1", "1 to 2", "2 to 3"]


def test_arcs_are_run_either_way_and_lines_join_those_that_do_not_meet():
    route = plan_route(REGION, [2, -4], along="arcs", closed=True)
    assert route.legs == ("arc 2", "line to arc 4", "arc 4 backwards", "line to the start")
    assert route.stops == ("1", "2", "3", "4", "5")
    ends = [ARCS[1].points[0], ARCS[1].points[-1], ARCS[3].points[-1], ARCS[3].points[0]]
    assert_allclose(route.path.q[route.path.stops], [*ends, ends[0]], atol=1e-9)


@pytest.mark.parametrize(
    ("order", "more", "words"),
    [
        ([1, 7], {}, "no vertex 7 in component 0: it has 6, numbered from 1"),
        ([1], {}, "two vertices or more"),
        ([1, 2], {"scale": 0}, "scale must be above 0, found 0"),
        ([1, 2], {"deviation": 0}, "deviation must be above 0"),
        ([1, 2], {"component": 5}, "no component 5; there are 5"),
        ([0], {"along": "arcs"}, "no arc 0"),
        ([1, -7], {"along": "arcs"}, "no arc 7"),
        ([], {"along": "arcs"}, "an arc or more"),
        ([1], {"along": "roads"}, "no way along 'roads'; there are lines and arcs"),
        ([1], {"along": "arcs", "scale": 0.5}, "a scaled arc is none of the region's"),
    ],
)
def test_a_route_that_is_none_is_refused(order, more, words):
    with pytest.raises(ValueError, match=words):
        plan_route(REGION, order, **more)


def test_a_component_without_vertices_says_so():
    bare = replace(REGION, outlined=(replace(REGION.components[0], vertices=()),))
    with pytest.raises(ValueError, match="it has no vertex"):
        plan_route(bare, [1, 2])


def test_a_held_joint_stays():
    first, held = replace(MINERVA.joints[0], parent="-1", frame="0"), {0: 0.3}
    three = replace(MINERVA, joints=(first, *MINERVA.joints), home=np.array([0.3, 0, 0]))
    route = plan_route(find_region(three, held), [1, 2])
    assert_allclose(route.path.q[:, 0], 0.3)
    assert np.ptp(route.path.q[:, 1:]) > 0


# --- what it meets --------------------------------------------------------------------------------


def test_a_route_is_feasible_where_every_place_of_it_is():
    """Round the component's corners, by a fine grid and the boundary functions alone."""
    answers = set()
    for k in range(1, 7):
        found = report(plan_route(REGION, [k, k % 6 + 1], scale=0.999))
        q = found.route.path.at(np.linspace(0, 1, 5001))
        assert found.feasible == keeps_clear(MINERVA, q).all()
        answers.add(found.feasible)
    assert answers == {True, False}


def test_of_equal_values_the_first_place_is_named_whatever_their_rounding():
    def noisy(q: np.ndarray) -> np.ndarray:
        values = 1 + np.abs(q[:, 0] - SMALL[0, 0])
        values[len(values) // 2 :] -= 2.0**-52
        return values

    value, place = lowest(traverse(MINERVA, SMALL[[0, 1, 0]]), noisy)
    assert (value, place.s) == (pytest.approx(1), pytest.approx(0, abs=1e-9))


def test_the_largest_reach_is_that_of_a_far_finer_path():
    found = report(plan_route(REGION, [1, 4, 2, 6]))
    fine = reach(MINERVA, found.route.path.at(np.linspace(0, 3, 30_001))).max()
    assert fine <= found.largest_reach <= fine + 1e-4
    assert_allclose(reach(MINERVA, found.farthest.q), found.largest_reach)


def test_the_document_follows_its_schema_and_the_lines_say_the_same():
    route = plan_route(REGION, [1, 3, 2, 4], scale=0.9)
    found = report(route)
    content = json.loads(json.dumps(route_document(found)))
    follows_schema(content, "traverse")
    lines = list(route_lines(found))
    assert content["order"] == [1, 3, 2, 4]
    assert lines[0] == "3 legs: 1 to 3, 3 to 2, 2 to 4"
    for margin in content["margins"]:
        (line,) = (x for x in lines if x.startswith(f"smallest margin of {margin['boundary']}:"))
        assert f"{margin['margin']:.6g} {margin['unit']}, on {margin['at']['leg']}" in line
    crossed = [line for line in lines if line.startswith("the tool crosses")]
    assert len(crossed) == len(content["self_crossings"]) > 0
    outside = {line.split()[1] for line in lines if line.startswith("outside:")}
    assert outside == {m["boundary"] for m in content["margins"] if m["leaves"]}


def test_a_route_as_a_table_has_its_rows_with_all_digits():
    route = plan_route(REGION, [1, 2], deviation=1.0)
    header, *rows = csv.reader(io.StringIO(route_csv(route)))
    assert header == ["q1_rad", "q2_rad", "x_cm", "y_cm", "z_cm"]
    assert_allclose([[float(x) for x in row[:2]] for row in rows], route.path.q, rtol=0)
