"""Polygons of components: against exact areas, shapely, and grids on the torus."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point, Polygon

from cspace import clearance, find_region, load_robot
from cspace.export.outlines import area, polygons
from cspace.model.robotfile import parse_robot
from engine_support.arms import joint, robot_table

MINERVA = load_robot("minervabot-v2")
PILLARS = [
    {"name": "east", "type": "pair", "points": ["o", "t"], "clearance": 0.2},
    {"name": "ring", "type": "pair", "points": ["s", "t"], "clearance": 0.5},
    {"name": "west", "type": "pair", "points": ["u", "t"], "clearance": 0.4},
]


def among_pillars(*names):
    """Two joints that turn all the way round; each pillar is a hole, the ring a band."""
    joints = [
        joint("revolute", "0", "1", [0, 0, 0], [0, 0, 1]),
        joint("revolute", "1", "2", [1.0, 0, 0], [0, 0, 1]),
    ]
    points = [
        {"name": "t", "frame": "2", "at": [0.8, 0, 0]},
        {"name": "o", "frame": "0", "at": [1.2, 0.3, 0]},
        {"name": "s", "frame": "1", "at": [0.1, 0, 0]},
        {"name": "u", "frame": "0", "at": [-1.0, -1, 0]},
    ]
    pillars = [b for b in PILLARS if b["name"] in names]
    return robot_table(joints, {"q1": 0, "q2": 0}, "2", point=points, boundary=pillars)


@pytest.mark.parametrize("deviation", [1e-2, 1e-4])
def test_every_polygon_is_as_near_as_it_says(deviation) -> None:
    """Exact points all along every arc, compared with shapely's polygon."""
    for component in find_region(MINERVA).components:
        pieces, stated = polygons(component, deviation)
        (shape,) = (Polygon(piece.outer, piece.holes) for piece in pieces)
        assert shape.is_valid
        assert stated <= deviation
        for arc in (arc for loop in component.loops for arc in loop):
            places = arc.at(np.linspace(0, 1, 501))
            assert max(shape.exterior.distance(Point(q)) for q in places) <= deviation
        assert area(pieces) == pytest.approx(shape.area)
        length = shape.length
        assert abs(area(pieces) - component.area) <= deviation * length


@pytest.mark.parametrize(
    ("names", "wraps", "holes"),
    [
        ((), (True, True), 0),
        (("east",), (True, True), 2),
        (("ring",), (True, False), 0),
        (("east", "ring"), (True, False), 2),
        (("east", "west"), (True, True), 2),
        (("east", "ring", "west"), (True, False), None),
    ],
)
@pytest.mark.parametrize("start", [-pi, 0.1, 1.3])
def test_a_component_that_goes_round_is_cut_at_the_window(names, wraps, holes, start) -> None:
    robot = parse_robot(among_pillars(*names))
    (component,) = find_region(robot).components
    assert component.wraps == wraps
    window = np.array([[start, start + 2 * pi]] * 2)
    pieces, _ = polygons(component, 1e-4, window)
    assert area(pieces) == pytest.approx(component.area, abs=1e-3)
    shapes = [Polygon(piece.outer, piece.holes) for piece in pieces]
    assert all(shape.is_valid for shape in shapes)
    if holes is not None and start == -pi:
        assert sum(len(piece.holes) for piece in pieces) == holes
    # Every configuration of a grid, moved into the window, is inside just where it is feasible.
    rng = np.random.default_rng(1)
    for q in rng.uniform(-pi, pi, (300, 2)):
        seen = q.copy()
        for j in range(2):
            if wraps[j]:
                seen[j] = start + (q[j] - start) % (2 * pi)
        copies = [seen] if all(wraps) else [seen + np.array([0, 2 * pi * k]) for k in (-1, 0, 1)]
        inside = any(shape.contains(Point(c)) for shape in shapes for c in copies)
        margin = np.abs(find_margin(robot, q))
        if margin > 1e-3:
            assert inside == (find_margin(robot, q) > 0)


def find_margin(robot, q):
    return min([1.0, *(float(clearance(robot, b)(q)) for b in robot.boundaries)])


@settings(max_examples=25, deadline=None)
@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0.05, 0.6))
def test_areas_of_cut_polygons_are_those_of_the_region(x, y, kept) -> None:
    table = among_pillars("east", "west")
    table["point"][1]["at"] = [x, y, 0]
    table["boundary"][0]["clearance"] = kept
    for component in find_region(parse_robot(table)).components:
        pieces, _ = polygons(component, 1e-3)
        rings = [ring for piece in pieces for ring in (piece.outer, *piece.holes)]
        length = sum(np.linalg.norm(np.diff(r, axis=0), axis=1).sum() for r in rings)
        assert abs(area(pieces) - component.area) <= 1e-3 * length + 1e-9
