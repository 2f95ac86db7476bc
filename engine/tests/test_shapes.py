# ruff: noqa: E501  (one table, a case a line)
"""Shapes of bodies, the convex parts they are cut into, and the plane in which they move."""

from __future__ import annotations

import copy
import tomllib
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cspace import RobotFileError, clearance, load_robot, save_robot
from cspace.geometry.convex import convex_parts, polygon_fault
from cspace.measures import bodies
from cspace.model.robot import BodyPair, Capsule, Disc, HalfSpace, Polygon
from cspace.model.robotfile import parse_robot
from cspace.model.rows import LARGEST
from cspace.proofs.certificates.statements import with_extra_clearance
from engine_support.tables import Change, Table, drop, put

# --- cutting into convex parts --------------------------------------------------------------------

WHOLE = st.tuples(st.integers(0, 4), st.integers(0, 4))
"""So few places that corners in line, touching edges and equal areas are common."""


def area(corners: Any) -> Fraction:
    """Twice the signed area, exactly."""
    p = [tuple(map(Fraction, corner)) for corner in np.asarray(corners).tolist()]
    return sum((a[0] * b[1] - a[1] * b[0] for a, b in pairwise([*p, p[0]])), Fraction(0))


def is_strictly_convex(corners: Any) -> bool:
    """Anticlockwise, no corner straight on, once round: every corner left of every edge."""
    p = np.asarray(corners).tolist()
    return all(area([a, b, c]) > 0 for a, b in pairwise([*p, p[0]]) for c in p if c not in (a, b))


def assert_parts_are_the_polygon(corners: np.ndarray) -> None:
    parts = [corners[list(loop)] for loop in convex_parts(corners)]
    assert all(is_strictly_convex(part) for part in parts)
    assert sum(map(area, parts)) == abs(area(corners))
    whole, pieces = shapely.Polygon(corners), [shapely.Polygon(part) for part in parts]
    assert shapely.union_all(pieces).symmetric_difference(whole).area <= 1e-9 * whole.area


@given(st.lists(WHOLE, min_size=3, max_size=9, unique=True))
def test_what_is_simple_is_as_shapely_says_and_is_cut_exactly(places) -> None:
    corners = np.array(places, dtype=float)
    whole = shapely.Polygon(corners)
    simple = bool(whole.is_valid and whole.area > 0)
    assert (polygon_fault(corners) is None) == simple
    if simple:
        assert_parts_are_the_polygon(corners)


@pytest.mark.parametrize("count", [5, 40, 200])
def test_stars_with_many_corners_are_cut_exactly(count) -> None:
    rng = np.random.default_rng(count)
    turn, radius = np.arange(count) * 2 * np.pi / count, rng.uniform(0.2, 1.0, count)
    corners = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    assert_parts_are_the_polygon(corners)
    reflex = sum(area([corners[k - 1], corners[k], corners[(k + 1) % count]]) < 0
                 for k in range(count))  # fmt: skip
    parts = len(convex_parts(corners))
    assert -(-reflex // 2) + 1 <= parts <= 2 * reflex + 1  # the bound of Hertel and Mehlhorn


def test_a_corner_within_rounding_of_its_edge_is_on_it() -> None:
    """2^-38 of the size is 4e-12; beyond that a bend is seen, either way."""
    found = []
    for off in (1e-10, 1e-14, 0.0, -1e-14, -1e-10):
        parts = convex_parts([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0 + off], [0.0, 2.0]])
        found.append([len(part) for part in parts])
    assert found == [[4], [3], [3], [3], [3, 3]]


def test_exact_parts_know_no_rounding() -> None:
    """The last bit of a double decides; a cross product of doubles is 0 here."""
    found = []
    for last in (np.nextafter(2e9, 3e9), 2e9, np.nextafter(2e9, 0)):
        corners = [[0.0, 0.0], [1e9, 1e9], [2e9, last], [0.0, 2e9]]
        found.append([len(part) for part in convex_parts(corners, exact=True)])
    assert found == [[4], [3], [3, 3]]


@given(st.floats(0, 7), st.lists(st.integers(1, 3), min_size=6, max_size=6))
def test_corners_typed_along_turned_edges_leave_no_splinters(angle, counts) -> None:
    """An L with corners on its edges, whose last bits are off where it is turned."""
    ell = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float)
    edges = zip(ell, np.roll(ell, -1, axis=0), counts, strict=True)
    places = [a + t * (b - a) for a, b, n in edges for t in np.linspace(0, 1, n, endpoint=False)]
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    corners = np.array(places) @ turn + [5.0, -3.0]
    parts = [corners[list(loop)] for loop in convex_parts(corners)]
    assert len(parts) == 2
    assert float(sum(map(area, parts))) == pytest.approx(6.0, rel=1e-12)


def test_a_polygon_thinner_than_rounding_is_refused() -> None:
    assert (
        polygon_fault([[0, 0], [1, 0], [1, 1e-13]]) == "it is thinner than rounding beside its size"
    )
    assert polygon_fault([[0, 0], [1, 0], [1, 1e-10]]) is None


@pytest.mark.parametrize("scale", [1e-300, 1e-9, 1.0, LARGEST])
def test_no_size_is_too_large_or_too_small(scale) -> None:
    dart = scale * np.array([[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]])
    assert len(convex_parts(dart)) == 2
    bow = scale * np.array([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])
    assert polygon_fault(bow) == "the edges from corners 0 and 2 cross or touch"


@pytest.mark.parametrize(
    ("corners", "says"),
    [
        ([[0, 0], [2, 2], [2, 0], [0, 2]], "the edges from corners 0 and 2 cross or touch"),
        ([[0, 0], [2, 2], [2, 0], [0, 1]], "the edges from corners 0 and 2 cross or touch"),
        ([[0, 0], [1, 1], [2, 2]], "all corners lie on one line: it has no area"),
        ([[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]], "the edges from corners 0 and 2 cross or touch"),
        ([[0, 0], [2, 0], [2, 2], [0, 0]], "corners 0 and 3 are one place"),
        ([[0, 0], [3, 0], [1, 0], [1, 1]], "it turns back on itself at corner 1"),
        ([[0, 3], [2, -3], [-3, 1], [3, 1], [-2, -3]], "the edges from corners 0 and 2 cross"),
    ],
)  # fmt: skip
def test_what_is_no_polygon_is_told(corners, says) -> None:
    assert (polygon_fault(corners) or "").startswith(says)
    with pytest.raises(ValueError, match="no simple polygon"):
        convex_parts(corners)


# --- shapes ---------------------------------------------------------------------------------------


def test_parts_of_shapes() -> None:
    capsule = Capsule(np.zeros(3), np.array([2.0, 0.0, 0.0]), 0.5)
    (part,) = capsule.parts
    assert_array_equal(part.corners, [[0, 0, 0], [2, 0, 0]])
    assert part.radius == 0.5
    (part,) = Disc(np.array([1.0, 2.0, 3.0]), 0.25).parts
    assert (part.corners.tolist(), part.radius) == ([[1, 2, 3]], 0.25)
    dart = Polygon.of([[0, 0], [2, 0], [0.5, 0.5], [0, 2]])
    assert [part.corners.shape for part in dart.parts] == [(3, 3), (3, 3)]
    assert {part.radius for part in dart.parts} == {0.0}


@pytest.mark.parametrize("axes", [[0, 2], [0, 1], [1, 2]])
def test_an_outline_stays_near_in_every_plane(axes) -> None:
    start, end = np.zeros(3), np.zeros(3)
    start[axes], end[axes] = [1.0, 2.0], [3.0, 1.0]
    normal = np.delete(np.arange(3), axes)
    for shape in (Capsule(start, end, 0.5), Disc(end, 0.5)):
        places = shape.outline(np.eye(3)[normal[0]])
        assert_array_equal(places[:, normal], 0)
        core = shapely.LineString if len(shape.places) > 1 else shapely.Point
        exact = core(shape.places[:, axes]).buffer(0.5, quad_segs=4000)
        drawn = shapely.Polygon(places[:, axes])
        assert drawn.is_valid
        assert drawn.hausdorff_distance(exact) <= 1e-3
        assert drawn.difference(exact).area <= 1e-5


# --- the file -------------------------------------------------------------------------------------


def link(name: str, parent: str, frame: str, **keys: Any) -> Table:
    """A joint about z at the end of a link of 0.4 m."""
    joint = {"name": name, "type": "revolute", "parent": parent, "frame": frame}
    joint |= {"origin": [0.0, 0.0, 0.0] if parent == "base" else [0.4, 0.0, 0.0]}
    return joint | {"axis": [0.0, 0.0, 1.0]} | keys


def table_scene() -> Table:
    """Two links as capsules on a table, seen from above, among three obstacles."""
    capsule = {"from": [0, 0], "to": [0.4, 0, 0], "radius": 0.03}
    return {
        "schema": 1,
        "name": "two links",
        "length_unit": "m",
        "angle_unit": "deg",
        "home": {"q1": 40, "q2": -60},
        "tool": "tip",
        "collisions": "all",
        "clearance": 0.005,
        "allowed": [["link 1", "link 2"]],
        "joint": [link("q1", "base", "link 1"), link("q2", "link 1", "link 2")],
        "point": [{"name": "tip", "frame": "link 2", "at": [0.4, 0, 0]}],
        "body": [
            {"frame": "link 2", "capsule": dict(capsule)},
            {"frame": "link 1", "capsule": dict(capsule)},
        ],
        "obstacle": [
            {"name": "post", "disc": {"at": [0.5, 0.3], "radius": 0.05}},
            {"name": "crate", "polygon": [[0.45, -0.5], [0.7, -0.5], [0.7, -0.25], [0.45, -0.25]]},
            {"polygon": [[-0.6, -0.6], [-0.2, -0.6], [-0.4, -0.5], [-0.6, -0.2]]},
        ],
        "boundary": [
            {"name": "near", "type": "bodies", "bodies": ["crate", "link 2"], "clearance": 0.01},
            {"name": "wall", "type": "half-space", "body": "link 2", "normal": [0, 2, 0],
             "offset": -0.7, "used": False},
        ],
    }  # fmt: skip


def test_pairs_that_collisions_make_come_after_the_files_boundaries_in_chain_order() -> None:
    robot = parse_robot(table_scene())
    assert [b.name for b in robot.used] == [
        "near", "link 1, post", "link 1, crate", "link 1, base/3", "link 2, post",
        "link 2, base/3",
    ]  # fmt: skip
    assert [body.name for body in robot.obstacles] == ["post", "crate", "base/3"]
    assert {b.clearance for b in robot.used} == {0.01, 0.005}
    assert robot.boundary("link 1, post").bodies == ("link 1", "post")
    assert robot.body("crate") is robot.obstacles[1]
    assert repr(robot).endswith("2 boundaries and 5 pairs of bodies>")


def test_a_boundary_that_is_not_used_takes_the_place_of_its_pair() -> None:
    table = table_scene()
    table["boundary"][0]["used"] = False
    names = [b.name for b in parse_robot(table).used]
    assert not {"near", "link 2, crate"} & set(names)


@pytest.mark.parametrize("clearance_in_file", [0.0, 0.25])
def test_extra_clearance_widens_the_pairs_that_collisions_make(clearance_in_file) -> None:
    robot = parse_robot(table_scene() | {"clearance": clearance_in_file})
    wider = with_extra_clearance(robot, 0.125)
    for one, other in zip(robot.used, wider.used, strict=True):
        assert isinstance(other, BodyPair)
        assert other.clearance == pytest.approx(one.clearance + 0.125)


def test_a_robot_with_bodies_is_written_and_read_again(tmp_path: Path) -> None:
    robot = parse_robot(table_scene())
    save_robot(robot, tmp_path / "two.toml")
    again = load_robot(tmp_path / "two.toml")
    assert again == robot
    text = (tmp_path / "two.toml").read_text("utf-8")
    assert 'name = "link 1"' not in text  # a default
    assert "to = [0.4, 0.0]\n" in text


def test_a_body_that_is_only_drawn_may_have_any_outline() -> None:
    """Files from before bodies kept apart mean what they meant."""
    table = table_scene() | {"boundary": [], "obstacle": []}
    for key in ("collisions", "clearance", "allowed"):
        del table[key]
    table["body"] = [{"frame": "base", "polygon": [[0, 0], [0, 0], [1, 0]]}]
    robot = parse_robot(table)
    assert (robot.used, len(robot.bodies)) == ((), 1)
    with pytest.raises(
        RobotFileError, match=r"^body\[0\]\.polygon \(box\): no polygon: corners 0 "
    ):
        parse_robot(table | {"body": [table["body"][0] | {"name": "box"}]})
    table["joint"][1]["axis"] = [0, 1, 1]  # no plane of motion, and nobody asks for one
    assert parse_robot(table).bodies[0].shape.places.tolist()[2] == [1, 0, 0]


POLYGON = "obstacle.1.polygon"
BAD: list[tuple[Change, str]] = [
    (put(POLYGON, [[0, 0], [1, 1], [1, 0], [0, 1]]), "obstacle[1].polygon (crate): no polygon: the edges from corners 0 and 2 cross or touch"),
    (put(POLYGON, [[0, 0]] * 1001), "obstacle[1].polygon (crate): [[0, 0], [0, 0], "),
    (put(f"{POLYGON}.1.1", float("nan")), "obstacle[1].polygon[1][1] (crate): nan is not a finite number"),
    (put("obstacle.1.disc", {"at": [0, 0], "radius": 1}), "obstacle[1] (crate): polygon and disc found; wanted: exactly one of polygon, capsule,"),
    (drop(POLYGON), "obstacle[1] (crate): none found; wanted: exactly one of polygon"),
    (put("body.0.capsule.to", [0, 0, 0]), "body[0].capsule: no capsule: 'from' and 'to' are one place: that is a disc"),
    (put("body.0.capsule.length", 1), "body[0].capsule: unknown key 'length'; allowed: from, to, radius"),
    (put("obstacle.0.disc.at", [1]), "obstacle[0].disc.at (post): [1] has length 1; wanted: a list of 2 numbers in the plane of"),
    (put("body.0.name", "link 1"), "body[1]: 'link 1' is used twice, first by body[0]; names of bodies are unique"),
    (put("obstacle.1.name", "link 1"), "obstacle[1].name: 'link 1' is used twice, first by body[1]; names of bodies are unique"),
    (put("boundary.0.bodies", ["post", "box"]), "boundary[0].bodies[1] (near): no body 'box'; there are link 2, link 1, post, crate, base"),
    (put("boundary.1.body", "box"), "boundary[1].body (wall): no body 'box'; there are link 2"),
    (put("allowed.0.1", "box"), "allowed[0][1]: no body 'box'; there are link 2, link 1, post"),
    (put("allowed.0.1", "link 1"), "allowed[0]: ['link 1', 'link 1'] names one thing twice;"),
    (put("boundary.0.bodies", ["post", "post"]), "boundary[0].bodies (near): ['post', 'post'] names one thing twice; wanted: a list of the"),
    (put("boundary.0.bodies", ["post", "crate"]), "boundary[0].bodies (near): ['post', 'crate'] are obstacles; wanted: two bodies on differ"),
    (put("body.1", {"frame": "link 2", "name": "hand", "disc": {"at": [0, 0], "radius": 1}}), "boundary[0].bodies (near): ['hand', 'link 2'] are fixed in frame 'link 2'; wanted: two"),
    (put("boundary.1.point", "tip"), "boundary[1] (wall): point and body found; wanted: exactly one of point, body"),
    (drop("boundary.1.body"), "boundary[1] (wall): none found; wanted: "),
    (put("boundary.1.normal", [0, 1, 1]), "boundary[1].normal (wall): [0, 1, 1] leaves the plane in which the arm moves"),
    (put("collisions", "some"), "collisions: 'some' is unknown; allowed: all"),
    (put("boundary.1.name", "link 1, post"), "boundary[1] (link 1, post): 'link 1, post' is what collisions = \"all\" calls a pair of"),
    (put("joint.1.axis", [0, 1, 0]), "boundary[0] (near): bodies keep apart in one plane only; joint 'q2' turns about an axis"),
    (put(f"{POLYGON}.2", [0.7, -0.25, 0.1]), "obstacle[1].polygon (crate): [0.7, -0.25, 0.1] lies 0.1 m off the plane of body"),
    (put("joint.1.origin", [0.4, 0, 0.1]), "body[0].capsule: [0.0, 0.0, 0.0] lies 0.1 m off the"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "says"), BAD)
def test_a_wrong_body_is_refused_by_name_and_place(change, says) -> None:
    table = copy.deepcopy(table_scene())
    change(table)
    if says.startswith("boundary[0].bodies (near): ['hand'"):
        table["boundary"][0]["bodies"], table["allowed"] = ["hand", "link 2"], []
    with pytest.raises(RobotFileError) as error:
        parse_robot(table)
    assert str(error.value).startswith(says)


def test_a_slide_that_leaves_the_plane_is_told() -> None:
    table = table_scene()
    table["joint"][1] |= {"type": "prismatic", "limits": [0, 1]}
    with pytest.raises(RobotFileError, match="joint 'q2' slides out of the plane"):
        parse_robot(table)


def test_collisions_are_named_where_no_boundary_asks_for_the_plane() -> None:
    table = table_scene() | {"boundary": []}
    table["joint"][1]["axis"] = [0, 1, 0]
    with pytest.raises(RobotFileError, match=r"^collisions: bodies keep apart in one plane only"):
        parse_robot(table)


def test_two_pairs_of_one_name_are_refused() -> None:
    table = table_scene()
    table["body"][1]["name"], table["allowed"] = "a, b", []
    table["body"] += [{"frame": "link 1", "name": "a", "disc": {"at": [0, 0], "radius": 0.1}}]
    table["obstacle"][:2] = [
        {"name": name, "disc": {"at": [0, 0], "radius": 0.1}} for name in ("c", "b, c")
    ]
    table["boundary"] = []
    with pytest.raises(RobotFileError, match=r"^collisions: 'a, b, c' is what collisions"):
        parse_robot(table)


def test_a_half_space_keeps_a_point_or_a_body() -> None:
    for keys in ({"point": ""}, {"point": "tip", "body": "link 2"}):
        with pytest.raises(ValueError, match="one point or one body"):
            HalfSpace(name="w", normal=np.eye(3)[0], offset=0.0, **keys)


@pytest.mark.parametrize("name", ["near", "wall"])
def test_a_boundary_of_bodies_has_no_single_form(name) -> None:
    robot = parse_robot(table_scene())
    with pytest.raises(ValueError, match=f"{name} is about whole bodies"):
        clearance(robot, robot.boundary(name))


# --- the plane of motion --------------------------------------------------------------------------


def with_axis(axis: list[float]) -> Table:
    table = table_scene() | {"body": [], "obstacle": [], "boundary": [], "allowed": []}
    for joint in table["joint"]:
        joint["axis"] = axis
    table["body"] = [{"frame": "link 2", "polygon": [[1, 2], [3, 2], [3, 5]]}]
    return table


@pytest.mark.parametrize(
    ("axis", "across", "senses"),
    [
        ([0, 1, 0], [[1, 0, 0], [0, 0, 1]], (-1, -1)),
        ([0, -1, 0], [[1, 0, 0], [0, 0, 1]], (1, 1)),
        ([0, 0, 1], [[1, 0, 0], [0, 1, 0]], (1, 1)),
        ([0, 0, -3], [[1, 0, 0], [0, 1, 0]], (-1, -1)),
        ([2, 0, 0], [[0, 1, 0], [0, 0, 1]], (1, 1)),
    ],
)
def test_two_numbers_of_a_corner_are_those_across_the_axis(axis, across, senses) -> None:
    robot = parse_robot(with_axis(axis))
    assert_array_equal(robot.plane.across, across)
    assert robot.plane.senses == senses
    corners = robot.bodies[0].shape.places
    assert_array_equal(corners @ robot.plane.across.T, [[1, 2], [3, 2], [3, 5]])
    assert_array_equal(robot.plane.flat("link 2", corners), [[1, 2], [3, 2], [3, 5]])


@given(st.lists(st.floats(-4, 4), min_size=2, max_size=2), st.sampled_from([0, 1, 2]),
       st.sampled_from([-1, 1]))  # fmt: skip
def test_a_pose_is_a_turn_by_the_sum_of_the_values_and_a_translation(q, along, sign) -> None:
    robot = parse_robot(with_axis((sign * np.eye(3)[along]).tolist()))
    plane, body = robot.plane, robot.bodies[0]
    angle = float(np.dot(plane.senses, q))
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    place = plane.across @ robot.frames(q).position("base", "link 2", "base")
    expected = plane.flat("link 2", body.shape.places) @ turn.T + place
    assert_allclose(bodies.outline(robot, body, q), expected, atol=1e-12)


def test_a_mount_turns_the_axes_of_its_frame() -> None:
    """Seen from a frame that is tipped over, an axis along y of the base is one along z."""
    table = with_axis([0, 1, 0])
    table["joint"][1] |= {"rpy": [-90, 0, 0], "axis": [0, 0, 1]}
    robot = parse_robot(table)
    assert_allclose(robot.plane.normal_seen_from("link 2"), [0, 0, 1], atol=1e-15)
    assert_array_equal(robot.bodies[0].shape.places[:, 2], 0)
    assert_allclose(robot.plane.flat("link 2", [[1, 2, 0]]), [[1, -2]], atol=1e-15)


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3).filter(lambda n: np.linalg.norm(n) > 0.1))
def test_an_oblique_plane_has_orthonormal_axes(axis) -> None:
    table = with_axis(axis)
    del table["collisions"]
    plane = parse_robot(table).plane
    assert_allclose(plane.across @ plane.across.T, np.eye(2), atol=1e-12)
    assert_allclose(plane.across @ plane.normal, 0, atol=1e-12)
    assert all(abs(sense) == 1 for sense in plane.senses)


def test_one_slide_has_the_plane_that_holds_it() -> None:
    table = with_axis([0, 1, 0])
    del table["collisions"]
    table["joint"] = [table["joint"][0] | {"type": "prismatic", "limits": [0, 1]}]
    table["home"], table["body"] = {"q1": 0}, []
    table["point"][0]["frame"] = "link 1"
    assert parse_robot(table).plane.across.tolist() == [[1, 0, 0], [0, 1, 0]]


ONE_LINE = """
schema = 1
name = "two slides along one line"
length_unit = "mm"
angle_unit = "deg"
home = {{ a = 0, b = 0 }}
tool = "tip"
joint = [
  {{ name = "a", type = "prismatic", parent = "0", frame = "1", origin = [0, 0, 0], axis = {axis}, limits = [-9, 9] }},
  {{ name = "b", type = "prismatic", parent = "1", frame = "2", origin = [0, 0, 0], axis = {axis}, limits = [-9, 9] }},
]
point = [{{ name = "tip", frame = "2", at = [0, 0, 0] }}]
body = [{{ name = "hand", frame = "2", disc = {{ at = {hand}, radius = 1 }} }}]
obstacle = [{{ name = "post", disc = {{ at = {post}, radius = 1 }} }}]
boundary = [{{ name = "gap", type = "bodies", bodies = ["hand", "post"] }}]
"""


@pytest.mark.parametrize(
    ("axis", "post", "plane"),
    [
        ([1, 0, 0], [5, 180, 0], "the plane of x and z"),
        ([0, 1, 0], [0, 5, 180], "the plane of x and y"),
        ([1, 1, 1], [5, -175, 0], "the plane at right angles to ["),
    ],
    ids=["x", "y", "oblique"],
)
def test_a_refusal_says_which_plane_was_taken_for_slides_along_one_line(axis, post, plane) -> None:
    text = ONE_LINE.format(axis=axis, hand=[0, 0, 0], post=post)
    with pytest.raises(ValueError, match="off the plane of body 'hand'; all joints slide") as found:
        parse_robot(tomllib.loads(text))
    assert plane in str(found.value)
    assert ("two numbers, or three" in str(found.value)) == (axis != [1, 1, 1])
