"""Traversals: straight in joint space, the tool by 4 x 4 matrices, crossings against shapely."""

from itertools import pairwise, permutations

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from lizarraga2025.closed_form import vertices
from qbound import load_robot
from qbound.geometry.polygon import centroid, scaled, self_crossings
from qbound.model.robotfile import parse_robot
from qbound.paths.asymmetry import asymmetry
from qbound.paths.traversal import simple_orders, traverse
from support.oracles import (
    crosses_itself,
    crossing_points,
    frame_matrix,
    packaged_table,
    point_seen_from,
    robot_tables,
)

MINERVA = load_robot("minervabot-v2")
TABLE = packaged_table()
SIX = np.array([vertex.q for vertex in vertices(MINERVA)])
SMALL = scaled(SIX, 0.9, centroid(SIX))
PLACES = st.tuples(st.integers(-50, 50), st.integers(-50, 50))


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
    for q, tool, reach in zip(path.q, path.tool, path.reach, strict=True):
        assert_allclose(tool, point_seen_from(TABLE, "3", "0", q), atol=1e-12)
        assert reach == pytest.approx(np.linalg.norm(tool - [0, 0, 22.5]))


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
    for q, reach in zip(path.q, path.reach, strict=True):
        shoulder = frame_matrix(table, "1", q)[:3, 3]
        tool = point_seen_from(table, robot.tool, "0", q)
        assert reach == pytest.approx(np.linalg.norm(tool - shoulder), abs=1e-9)


def test_stops_that_repeat_cost_no_division_by_zero() -> None:
    path = traverse(MINERVA, [[0, 0], [0, 0], [1, 0]], step=0.5)
    assert_array_equal(path.stops, [0, 1, 3])
    assert_array_equal(path.q, [[0, 0], [0, 0], [0.5, 0], [1, 0]])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_path_through_no_number_is_refused(bad) -> None:
    with np.errstate(all="ignore"), pytest.raises((ValueError, OverflowError)):
        traverse(MINERVA, [[0, 0], [bad, 0]])


# --- crossings -----------------------------------------------------------------------------------


@given(st.lists(PLACES, min_size=4, max_size=12, unique=True))
def test_crossings_are_those_that_shapely_finds(places) -> None:
    """Paths in general position: no three corners in line, so nothing merely touches."""
    p = np.array(places, dtype=float)
    assume(_general(p))
    expected = sorted(crossing_points(p))
    found = sorted(map(tuple, self_crossings(p)))
    assert len(found) == len(expected)
    assert_allclose(found, np.reshape(expected, (-1, 2)).tolist(), atol=1e-9)
    assert bool(found) == crosses_itself(p)


def _general(p: np.ndarray) -> bool:
    a, b, c = (p[list(x)] for x in zip(*_triples(len(p)), strict=True))
    return bool(np.all((b - a)[:, 0] * (c - a)[:, 1] != (b - a)[:, 1] * (c - a)[:, 0]))


def _triples(n: int) -> list[tuple[int, int, int]]:
    return [(i, j, k) for i in range(n) for j in range(i) for k in range(j)]


@pytest.mark.parametrize(
    ("path", "crossings"),
    [
        ([(0, 0), (2, 2), (2, 0), (0, 2)], [(1, 1)]),
        ([(0, 0), (2, 0), (2, 2), (0, 2), (0, 0)], []),
        ([(0, 0), (1, 0)], []),
        ([(0, 0), (4, 0), (4, 2), (2, 0), (0, 2)], []),
        ([(0, 0), (3, 0), (3, 1), (2, 1), (2, -1), (1, -1), (1, 1)], [(2, 0), (1, 0)]),
    ],
    ids=["cross", "closed square", "one piece", "touches from one side", "two"],
)
def test_crossings_of_known_paths(path, crossings) -> None:
    found = self_crossings(path)
    assert found.shape == (len(crossings), 2)
    assert sorted(map(tuple, found)) == sorted(crossings)


def test_a_path_may_be_turned_and_moved() -> None:
    """A figure of eight crosses itself once, in any pose."""
    t = np.linspace(-1.3, 1.5 * np.pi - 0.3, 90)
    eight = np.stack([np.sin(t), np.sin(2 * t)], axis=1)
    (crossing,) = self_crossings(eight)
    assert_allclose(crossing, [0, 0], atol=1e-2)
    for angle in np.linspace(0.1, 3, 7):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        found = self_crossings(eight @ turn.T + [5, -3])
        assert_allclose(found, [turn @ crossing + [5, -3]], atol=1e-12)


def test_orders_without_crossing_are_shapelys() -> None:
    """Of 360 orders of five of the six points, each once; tool paths compared with is_simple."""
    found = simple_orders(MINERVA, SMALL, 5)
    expected = [
        order
        for order in permutations(range(6), 5)
        if order[0] < order[-1]
        and not crosses_itself(traverse(MINERVA, SMALL[list(order)], step=0.03).tool[:, [0, 2]])
    ]
    assert found == expected
    assert 0 < len(found) < 360


def test_orders_of_fewer_points_in_another_plane() -> None:
    """In the plane x, y a planar arm draws on one line: nothing crosses, every order is simple."""
    assert len(simple_orders(MINERVA, SMALL[:4], 3, plane=(0, 1))) == 12


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
    path = traverse(parse_robot(table), [[0.0] * len(end), end], deviation=0.005)
    t = np.linspace(0, 1, 101)[1:-1]
    between = path.at((path.s[:-1, None] + np.diff(path.s)[:, None] * t).ravel())
    tool = np.array([point_seen_from(table, "t", "0", q) for q in between])
    tool = tool.reshape(len(path.s) - 1, len(t), 3) - path.tool[:-1, None]
    chord = np.diff(path.tool, axis=0)[:, None]
    along = (tool * chord).sum(axis=-1, keepdims=True) / (chord**2).sum(axis=-1, keepdims=True)
    exact = np.linalg.norm(tool - along * chord, axis=-1).max()
    assert exact <= path.deviation <= 0.005
    assert path.deviation <= 1.05 * exact


def test_a_finer_deviation_keeps_the_stops() -> None:
    for deviation in (1.0, 0.1, 0.01):
        path = traverse(MINERVA, SIX, closed=True, deviation=deviation)
        assert_array_equal(path.q[path.stops], np.concatenate([SIX, SIX[:1]]))


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan])
def test_a_deviation_that_is_not_above_zero_is_refused(bad) -> None:
    with pytest.raises(ValueError, match="above 0"):
        traverse(MINERVA, SIX, deviation=bad)


def test_one_vertex_is_no_path() -> None:
    with pytest.raises(ValueError, match="two vertices"):
        traverse(MINERVA, SIX[:1])


# --- one path and the mirror image of another -----------------------------------------------------


@pytest.mark.parametrize("error", [0.1, 0.02])
def test_the_asymmetry_is_the_hausdorff_distance_of_dense_polylines(error) -> None:
    right, left = SMALL[[5, 0, 1, 2, 3]], SMALL[[2, 3, 4, 5, 0]]
    one, other = (traverse(MINERVA, q, step=2e-3).tool[:, [0, 2]] for q in (right, left))
    mirrored, line = shapely.LineString(one * [-1, 1]), shapely.LineString(other)
    expected = line.hausdorff_distance(mirrored)  # of the rows, which are a millimetre apart
    assert asymmetry(MINERVA, right, left, error) == pytest.approx(expected, abs=2 * error + 0.05)


def test_paths_of_a_symmetric_arm_are_mirror_images() -> None:
    arm = load_robot("minervabot-v2-symmetric")
    six = np.array([vertex.q for vertex in vertices(arm)])
    assert asymmetry(arm, six[[5, 0, 1, 2, 3]], six[[2, 3, 4, 5, 0]], 0.1) < 0.2


def test_the_asymmetry_of_an_arm_that_slides_is_refused() -> None:
    with pytest.raises(ValueError, match="joints that slide"):
        asymmetry(load_robot("pp-portal"), [[0, 0], [1, 1]], [[0, 0], [1, 1]])
