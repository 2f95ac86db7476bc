"""Ties made on purpose: rounding decides no order, no first vertex and no nearest place."""

import math
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace import find_region, load_robot
from cspace.measures.nearest import nearest_boundary
from cspace.measures.scaling import largest_safe_scale
from cspace.model.robotfile import parse_robot
from cspace.order import first_largest, ordered_by
from cspace.region import Problem, clearance_problem, outline
from cspace.region.places import CellMap
from cspace.region.region import _over
from engine_support.arms import joint, robot_table
from engine_support.forms import PP, PR, RP, RR, forms
from engine_support.regions import problem_of

# --- numbers with errors --------------------------------------------------------------------------


def test_items_are_put_in_order_by_the_first_number_that_tells_them_apart():
    rows = [(1.0, 3.0), (1.0 + 1e-12, 2.0), (0.5, 9.0), (1.0 - 1e-12, 2.0 + 1e-12)]
    keys = [lambda row: (row[0], 1e-9), lambda row: (row[1], 1e-9)]
    assert ordered_by(rows, keys) == [rows[2], rows[1], rows[3], rows[0]]
    for shuffled in permutations(rows[:3]):
        assert ordered_by(shuffled, keys) == [rows[2], rows[1], rows[0]]
    assert ordered_by([], keys) == []


@pytest.mark.parametrize(("gap", "told"), [(1.9, False), (2.1, True)])
def test_neighbours_are_told_apart_beyond_both_errors(gap, told):
    rows = [("high", gap), ("low", 0.0)]
    ordered = ordered_by(rows, [lambda row: (row[1], 1.0)])
    assert ([name for name, _ in ordered] == ["low", "high"]) == told


def test_of_equal_largest_numbers_the_first_counts():
    assert first_largest(np.array([1.0, 5.0, 5.0 + 1e-14, np.nan])) == 1
    assert first_largest(np.array([[1.0, 5.0], [5.0 + 1e-6, 2.0]])) == 2


# --- scenes with components of equal area ---------------------------------------------------------


def sliding(obstacles, *, scale: float = 1.0, limit: float = 2.0, home=(0.0, 0.0)):
    """A square of half-width 0.2 that slides in a plane among polygons."""
    square = [[-0.2, -0.2], [0.2, -0.2], [0.2, 0.2], [-0.2, 0.2]]

    def scaled(loop):
        return [[x * scale, y * scale] for x, y in loop]

    limits = [-limit * scale, limit * scale]
    joints = [
        joint("prismatic", "base", "beam", [0, 0, 0], [1, 0, 0], limits=limits),
        joint("prismatic", "beam", "box", [0, 0, 0], [0, 1, 0], limits=limits),
    ]
    more = {
        "length_unit": "mm" if scale > 1 else "m",
        "collisions": "all",
        "point": [{"name": "t", "frame": "box", "at": [0, 0, 0]}],
        "boundary": [],
        "body": [{"frame": "box", "polygon": scaled(square)}],
        "obstacle": [{"name": n, "polygon": scaled(p)} for n, p in obstacles.items()],
    }
    at = {"qbeam": home[0] * scale, "qbox": home[1] * scale}
    return parse_robot(robot_table(joints, at, "box", **more))


def block(x0: float, x1: float, y0: float, y1: float) -> list[list[float]]:
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]


CROSS = {"upright": block(-0.1, 0.1, -3, 3), "level": block(-3, 3, -0.1, 0.1)}
"""Four rooms of one area, as a window has."""

FRAME = {
    "left": block(-1.675, -1.2, -1.675, 1.675),
    "right": block(1.2, 1.675, -1.675, 1.675),
    "below": block(-1.675, 1.675, -1.675, -1.2),
    "above": block(-1.675, 1.675, 1.2, 1.675),
}
"""A room inside a ring of the same area, about one centre."""


def rooms(scale: float = 1.0):
    return clearance_problem(sliding(CROSS, scale=scale))


ROOMS = [(-1.15, -1.15), (-1.15, 1.15), (1.15, -1.15), (1.15, 1.15)]
WIDE = (-7.0, 7.0)
APART = {"00": -0.5, "11": -1.0}
"""cos q1 cos q2 < -1/2: two discs, about (0, pi) and (pi, 0), each on a seam."""

SCENES = {
    "rooms": (rooms, ROOMS),
    "rooms in mm": (lambda: rooms(1000.0), [(1000 * x, 1000 * y) for x, y in ROOMS]),
    "seams": (lambda: problem_of(forms(RR, APART), (None, None)), [(0.0, math.pi), (math.pi, 0.0)]),
    "bands round q1": (
        lambda: problem_of(forms(RR, {"00": -0.5, "01": -1.0}), (None, WIDE)),
        [None, None],  # cos q2 < -1/2: about -pi, and about pi
    ),
    "bands round q2": (
        lambda: problem_of(forms(RR, {"00": -0.5, "10": -1.0}), (WIDE, None)),
        [None, None],
    ),
    "strips": (
        lambda: problem_of(forms(PR, {"00": -0.5, "01": -1.0}), ((-1.0, 1.0), WIDE)),
        [(0.0, -math.pi), (0.0, math.pi)],
    ),
    "strips of the other joint": (
        lambda: problem_of(forms(RP, {"00": -0.5, "10": -1.0}), (WIDE, (-1.0, 1.0))),
        [(-math.pi, 0.0), (math.pi, 0.0)],
    ),
    "diagonal bands": (
        lambda: problem_of(forms(RR, {"00": -0.5, "12": -1.0, "21": 1.0}), (None, None)),
        [None],  # sin(q1 - q2) > 1/2
    ),
}


def components(asked: Problem, base: int):
    return _over(
        asked, np.full(2, 50.0) if asked.free_home is None else asked.free_home, base, 1.0
    ).outlined


def lowest_of_bands(found):
    return [min(float(arc.points.min()) for loop in c.loops for arc in loop) for c in found]


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("name", SCENES)
def test_components_of_equal_area_come_by_their_places(name, base, monkeypatch):
    make, wanted = SCENES[name]
    asked = make()
    plain = CellMap.moments
    for seed in range(6):  # as on other processors, whose sums are rounded otherwise
        noise = np.random.default_rng(seed)

        def rounded(cells, noise=noise):
            moments = plain(cells)
            return moments * (1 + 1e-13 * noise.normal(size=moments.shape))

        monkeypatch.setattr(CellMap, "moments", rounded)
        found = [c for c in components(asked, base) if not c.contains_home]
        assert len(found) == len(wanted)
        assert np.ptp([c.area for c in found]) <= 1e-9 * found[0].area
        for component, place in zip(found, wanted, strict=True):
            if place is None:
                assert component.centroid is None
            else:
                size = 1000 if "mm" in name else 1
                assert_allclose(component.centroid, place, atol=1e-9 * size)
        if "bands round" in name:
            low = lowest_of_bands(found)
            assert low == sorted(low)


@pytest.mark.parametrize("scale", [1.0, 1000.0])
@pytest.mark.parametrize("base", [0, 1])
def test_of_components_about_one_centre_that_with_the_lowest_outline_is_first(base, scale):
    asked = clearance_problem(sliding(FRAME, scale=scale, limit=2.125, home=(1.4, 0)))
    found = components(asked, base)
    assert_allclose([c.area for c in found], 4 * scale**2, rtol=1e-9)
    assert [len(c.loops) for c in found] == [2, 1]
    edges = [min(arc.points[:, 0].min() for loop in c.loops for arc in loop) for c in found]
    assert_allclose(edges, [-2.125 * scale, -1.0 * scale], rtol=1e-9)


# --- first vertices -------------------------------------------------------------------------------


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_of_equally_low_vertices_the_loop_begins_at_that_of_the_lower_first_joint(
    base, scale, monkeypatch
):
    lay = outline.lay
    for seed in range(6):
        noise = np.random.default_rng(seed)

        def rounded(*arguments, noise=noise):
            laid = lay(*arguments)
            start = laid.pieces.start
            start *= 1 + 1e-13 * noise.normal(size=start.shape)
            return laid

        monkeypatch.setattr(outline, "lay", rounded)
        for component in components(rooms(scale), base):
            x, y = component.centroid / scale
            first = component.vertices[0].q / scale
            assert_allclose(first, [x - 0.85, y - 0.85], atol=1e-9)
            assert_allclose(component.loops[0][0].start, component.vertices[0].q)


# --- nearest places -------------------------------------------------------------------------------


@pytest.mark.parametrize("off", [0.0, 1e-15, -1e-15])
def test_of_equally_near_places_that_of_the_first_component_and_lowest_joints_is_given(off):
    region = find_region(sliding(CROSS))
    point = nearest_boundary(region, [off, -off])
    assert (point.component, point.boundary) == (0, "box, level")
    assert_allclose(point.q, [-0.3, -0.3], atol=1e-9)
    inside = nearest_boundary(region, [-1.15 + off, -1.15 - off])
    assert_allclose(inside.q, [-2.0, -1.15], atol=1e-9)
    middle = find_region(sliding({"post": block(-0.1, 0.1, -0.1, 0.1)}))
    for turn in ([0, 1], [1, 0], [0, -1], [-1, 0]):
        near = nearest_boundary(middle, np.multiply(turn, 0.3 + 0.85) + off)
        assert near.distance == pytest.approx(0.85)


def test_of_edges_that_touch_at_one_scale_the_first_is_named():
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
    walls = forms(PP, {"00": 0.5, "10": -1.0}, {"00": 0.5, "10": 1.0}, {"00": 0.5, "01": -1.0})
    for off in (0.0, 1e-15, -1e-15):
        found = largest_safe_scale(square * [1 + off, 1 - off], [0.0, 0.0], walls)
        assert found.scale == pytest.approx(0.5)
        assert found.edge == 0


# --- axes -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("slanted", [[1, -1, 0], [-1, 1, 0], [0, -1, 1], [1, 1, -1]])
def test_the_axes_of_a_slanted_plane_do_not_depend_on_the_last_digit_of_its_normal(slanted):
    robot = load_robot("minervabot-v2")
    planes = []
    for nudge in np.concatenate([np.zeros((1, 3)), 2e-16 * np.eye(3), -2e-16 * np.eye(3)]):
        axis = np.array(slanted) / np.linalg.norm(slanted) * (1 + nudge)
        joints = tuple(replace(joint, axis=axis) for joint in robot.joints)
        planes.append(replace(robot, joints=joints).plane)
    for plane in planes:
        assert plane.senses == planes[0].senses
        assert_allclose(plane.across, planes[0].across, atol=1e-12)
