"""What a path meets: crossings on the true path, margins against brute force, singular poses."""

import tomllib

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cspace import find_region, load_robot
from cspace.geometry.polygon import centroid, scaled
from cspace.model.robotfile import parse_robot
from cspace.paths.traversal import (
    Leg,
    boundaries,
    follow,
    least_margin,
    plane_of_motion,
    singular_crossings,
    tool_crossings,
    traverse,
)
from cspace.region import solve, window_problem
from engine_support.oracles import packaged_table, point_seen_from, row_of
from qbound import window_region
from qbound.windows import window_box

MINERVA = load_robot("minervabot-v2")
REGION = find_region(MINERVA)
TABLE = packaged_table()
SIX = window_region(MINERVA).polygon
SMALL = scaled(SIX, 0.9, centroid(SIX))
ORDERS = st.permutations(range(6)).flatmap(lambda o: st.integers(3, 6).map(lambda n: o[:n]))
SINGULAR = np.arctan2(-25.98, 15.0)  # link 2 in line with link 1


def tool_by_hand(q):
    return point_seen_from(TABLE, "3", "0", q)


@settings(max_examples=15, deadline=None)
@given(ORDERS)
def test_crossings_are_points_that_the_tool_passes_twice(order) -> None:
    """Each by 4 x 4 matrices to 1e-9 cm; as many as shapely finds on a polyline far finer."""
    walk = traverse(MINERVA, SMALL[order], deviation=0.01)
    found = tool_crossings(MINERVA, walk, (0, 2))
    for crossing in found:
        for place in (crossing.first, crossing.second):
            assert_allclose(tool_by_hand(place.q)[[0, 2]], crossing.point, atol=1e-9)
            assert_allclose(walk.at(place.s)[0], place.q)
    fine = traverse(MINERVA, SMALL[order], step=0.02).tool[:, [0, 2]]
    pieces = shapely.linestrings(np.stack([fine[:-1], fine[1:]], axis=1))
    one, other = shapely.STRtree(pieces).query(pieces, predicate="crosses")
    assert len(found) == (other > one).sum()


def test_the_answer_does_not_depend_on_the_rows() -> None:
    coarse, fine = (
        tool_crossings(MINERVA, traverse(MINERVA, SMALL, closed=True, deviation=d), (0, 2))
        for d in (1.0, 1e-4)
    )
    assert len(coarse) == len(fine) == 1
    assert_allclose(coarse[0].point, fine[0].point, atol=1e-10)


def test_a_path_run_twice_does_not_cross_itself() -> None:
    walk = traverse(MINERVA, SMALL[[0, 2, 0]], deviation=0.1)
    assert tool_crossings(MINERVA, walk, (0, 2)) == []


@settings(max_examples=25, deadline=None)
@given(ORDERS)
def test_singular_crossings_are_where_the_links_are_in_line(order) -> None:
    """One on each leg whose ends lie on both sides of q2 = -60 degrees (the paper's arm)."""
    q = SMALL[order]
    walk = traverse(MINERVA, q, deviation=0.1)
    found = singular_crossings(MINERVA, walk)
    expected = [
        i + (SINGULAR - a) / (b - a)
        for i, (a, b) in enumerate(zip(q[:-1, 1], q[1:, 1], strict=True))
        if (a < SINGULAR) != (b < SINGULAR)
    ]
    assert_allclose([place.s for place in found], expected, atol=1e-10)
    assert_allclose([place.q[1] for place in found], [SINGULAR] * len(expected), atol=1e-10)


def test_an_arm_that_cannot_move_its_tool_two_ways_has_no_singular_curve() -> None:
    table = packaged_table()
    row_of(table, "point", "3")["at"] = [0.0, 0.0, 0.0]
    robot = parse_robot(table)
    walk = traverse(robot, SMALL[:3], deviation=0.1)
    assert singular_crossings(robot, walk) is None


@settings(max_examples=4, deadline=None)
@given(ORDERS)
def test_smallest_margins_are_brute_forces(order) -> None:
    """Pairs by 4 x 4 matrices at many places of the path, the stops among them: none is smaller."""
    walk = traverse(MINERVA, SMALL[order], deviation=0.1)
    dense = walk.at(np.arange(60 * len(walk.legs) + 1) / 60)
    for boundary in boundaries(REGION):
        margin = least_margin(walk, boundary)
        row = row_of(TABLE, "boundary", boundary.name)
        if row["type"] == "pair":
            one, other = (
                np.array([point_seen_from(TABLE, p, "0", q) for q in dense]) for p in row["points"]
            )
            values = np.linalg.norm(one - other, axis=1) - row["clearance"]
        else:
            values = np.array([tool_by_hand(q)[2] for q in dense]) - 11.32
        assert margin.value <= values.min() + 1e-9
        assert margin.value == pytest.approx(values.min(), abs=0.05)
        assert boundary.margin(margin.place.q[None])[0] == pytest.approx(margin.value)


def test_an_edge_of_the_six_points_leaves_the_region_at_the_floor() -> None:
    """The paper's own finding: the straight edge from point 3 to point 4 goes below the floor."""
    walk = traverse(MINERVA, SIX[[2, 3]], deviation=0.01)
    floor = next(b for b in boundaries(REGION) if b.name == "B7")
    margin = least_margin(walk, floor)
    heights = (tool_by_hand(q)[2] for q in walk.at(np.linspace(0, 1, 500)))
    assert margin.value == pytest.approx(min(heights) - 11.32, abs=1e-4)
    assert margin.value < -1
    assert margin.leaves.s == pytest.approx(0, abs=1e-6)


LOOP = """
schema = 1
name = "a ball on a loop"
length_unit = "m"
angle_unit = "rad"
home = {{ a = 0, b = 1 }}
tool = "tip"
joint = [
  {{ name = "a", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 0, 1] }},
  {{ name = "b", type = "revolute", parent = "1", frame = "2", origin = [1, 0, 0], axis = [0, 0, 1] }},
]
point = [
  {{ name = "tip", frame = "2", at = [0.5, 0, 0] }},
  {{ name = "ball", frame = "0", at = [{x!r}, {y!r}, 0], radius = 2e-4 }},
]
boundary = [{{ name = "ball", type = "pair", points = ["ball", "tip"] }}]
"""  # noqa: E501


@pytest.mark.parametrize("s", [0.1774, 0.1779, 0.6081])
def test_a_ball_much_smaller_than_the_rows_are_apart_is_met(s) -> None:
    """The tool's loop passes it twice, once beside it: a margin of 1 mm was told of that pass."""
    q = s * np.array([2.0, 8.0])
    place = np.exp(1j * q[0]) + 0.5 * np.exp(1j * q.sum())
    robot = parse_robot(tomllib.loads(LOOP.format(x=float(place.real), y=float(place.imag))))
    walk = traverse(robot, [[0.0, 0.0], [2.0, 8.0]], deviation=0.01)
    [ball] = boundaries(find_region(robot))
    margin = least_margin(walk, ball)
    assert margin.value == pytest.approx(-2e-4, abs=1e-6)
    assert margin.leaves.s == pytest.approx(s, abs=1e-3)


def test_a_path_along_the_boundary_is_not_outside() -> None:
    component = REGION.components[0]
    legs = [Leg(arc.at, parts=len(arc.pieces)) for arc in component.loops[0]]
    walk = follow(MINERVA, legs, 0.01)
    found = [least_margin(walk, boundary) for boundary in boundaries(REGION)]
    assert all(margin.leaves is None for margin in found)
    assert all(abs(margin.value) < 1e-9 for margin in found)
    (crossing,) = tool_crossings(MINERVA, walk, (0, 2))  # the stops themselves are none
    assert abs(crossing.point[1] - tool_by_hand(crossing.first.q)[2]) < 1e-9
    assert np.abs(walk.q[walk.stops] - crossing.first.q).max(axis=1).min() > 0.01


def test_windows_are_limits_in_radians() -> None:
    found = boundaries(solve(window_problem(window_region(MINERVA))))
    units = {b.name: b.unit for b in found}
    assert units == {"B1": "rad", "B2": "rad", "B3": "rad", "B4": "rad", "B7": "cm"}
    walk = traverse(MINERVA, SIX, deviation=0.1)
    box = window_box(MINERVA)
    outside = traverse(MINERVA, [box.upper - 0.1, box.upper + np.array([0.2, -0.1])], deviation=0.1)
    window = next(b for b in found if b.name == "B1")
    assert least_margin(walk, window).value == pytest.approx(0, abs=1e-12)
    assert least_margin(outside, window).value == pytest.approx(-0.2)
    assert least_margin(outside, window).leaves.s == pytest.approx(1 / 3, abs=1e-6)


def test_limits_of_a_joint_are_margins() -> None:
    table = packaged_table()
    table["joint"][0]["limits"] = [-90, 30]
    found = {b.name: b for b in boundaries(find_region(parse_robot(table)))}
    q = np.array([[0.0, 0.0], [np.pi / 3, 0.0]])
    assert_allclose(found["q1.lower"].margin(q), [np.pi / 2, np.pi * 5 / 6])
    assert_allclose(found["q1.upper"].margin(q), [np.pi / 6, -np.pi / 6])


def test_the_plane_of_motion_is_that_of_the_tool() -> None:
    assert plane_of_motion(MINERVA) == (0, 2)
    table = packaged_table()
    table["joint"][0]["axis"] = [0, 0, 1]
    table["joint"][1]["axis"] = [0, 0, 1]
    assert plane_of_motion(parse_robot(table)) == (0, 1)
    table["joint"][1]["axis"] = [0, 1, 0]
    assert plane_of_motion(parse_robot(table)) is None
