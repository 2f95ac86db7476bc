"""Triangles that fill polygons, and components cut open, against shapely."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from cspace.export.outlines import assembled
from cspace.geometry import polygon
from cspace.geometry.convex import doubled_area
from cspace.geometry.triangulation import triangulated

SEEDS = st.integers(0, 10**6)
TURN = 360.0


def star(rng, count, centre, radius, step):
    """Corners round a centre, anticlockwise or (step -1) clockwise, in whole numbers."""
    angles = np.sort(rng.random(count)) * 2 * np.pi
    far = radius * (1 - 0.5 * rng.random(count))
    at = centre + far[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    return [(int(x), int(y)) for x, y in np.round(at)][::step]


@given(SEEDS, st.integers(5, 60), st.integers(0, 5), st.sampled_from([30, 10**3, 10**9]))
def test_triangles_are_the_constrained_delaunay_triangulation(seed, count, holes, size):
    rng = np.random.default_rng(seed)
    loops = [star(rng, count, np.zeros(2), size, 1)]
    for k in range(holes):
        angle = 2 * np.pi * k / 5
        centre = 0.3 * size * np.array([np.cos(angle), np.sin(angle)])
        loops.append(star(rng, max(count // 4, 3), centre, 0.12 * size, -1))
    whole = shapely.Polygon(loops[0], loops[1:])
    places = [place for loop in loops for place in loop]
    apart = len(set(places)) == len(places)
    if not whole.is_valid or not apart:
        with pytest.raises(ValueError, match=r"cross|left|inside"):
            triangulated(loops)
        return
    if not shapely.LinearRing(loops[0]).is_ccw or any(
        shapely.LinearRing(hole).is_ccw for hole in loops[1:]
    ):
        return
    triangles = triangulated(loops)
    assert all(doubled_area([places[k] for k in triangle]) > 0 for triangle in triangles)
    covered = sum(doubled_area([places[k] for k in triangle]) for triangle in triangles)
    assert covered == sum(doubled_area(loop) for loop in loops)
    expected = shapely.constrained_delaunay_triangles(whole)
    assert len(triangles) == len(expected.geoms)
    if size > 1000:  # else corners lie on one circle, and more than one is right
        theirs = {frozenset(map(tuple, each.exterior.coords)) for each in expected.geoms}
        assert {frozenset(places[k] for k in triangle) for triangle in triangles} == theirs


@pytest.mark.parametrize(
    ("loops", "says"),
    [
        ([[(0, 0), (2, 2), (2, 0), (0, 2)]], "cross"),
        ([[(0, 0), (4, 0), (2, 0), (2, 2)]], "cross"),
        ([[(0, 0), (0, 2), (2, 0)]], "left"),
        ([[(0, 0), (9, 0), (9, 9)], [(5, 1), (6, 2), (7, 1)], [(20, 1), (20, 2), (21, 1)]], "hole"),
        ([[(0, 0), (9, 0), (9, 9), (0, 9)], [(1, 1), (3, 1), (3, 3)]], "left"),
        ([[(0, 0), (9, 0), (9, 9), (0, 9)], [(0, 3), (3, 6), (6, 3)]], "touch"),
        ([[(0, 0), (9, 0), (5, 5), (9, 9), (0, 9)], [(9, 0), (5, 5), (9, 9)]], "touch"),
        ([[(0, 0), (9, 0), (5, 5), (9, 9), (0, 9)], [(9, 0), (8, 5), (9, 9)]], "hole"),
        ([[(1, 1), (1, 1), (2, 5)]], "touch"),
    ],
)
def test_loops_that_bound_no_polygon_are_refused(loops, says):
    with pytest.raises(ValueError, match=says):
        triangulated(loops)


@pytest.mark.parametrize("where", [(0, 0), (9, 0), (4, 4)])
def test_holes_may_touch_the_outline_and_each_other_in_a_corner(where):
    square = [(0, 0), (9, 0), (9, 9), (0, 9)]
    holes = {
        (0, 0): [[(0, 0), (1, 2), (2, 1)]],
        (9, 0): [[(9, 0), (7, 1), (8, 2)], [(7, 1), (5, 1), (6, 2)]],
        (4, 4): [[(4, 4), (4, 5), (5, 5)], [(4, 4), (3, 2), (2, 3)], [(4, 4), (6, 3), (5, 2)]],
    }[where]
    loops = [square, *holes]
    places = [place for loop in loops for place in loop]
    triangles = triangulated(loops)
    expected = shapely.constrained_delaunay_triangles(shapely.Polygon(square, holes))
    assert len(triangles) == len(expected.geoms)
    covered = sum(doubled_area([places[k] for k in triangle]) for triangle in triangles)
    assert covered == sum(doubled_area(loop) for loop in loops)


def test_corners_on_straight_edges_are_corners_of_triangles():
    square = [(0, 0), (1, 0), (2, 0), (3, 0), (3, 3), (2, 3), (0, 3), (0, 1)]
    triangles = triangulated([square])
    assert len(triangles) == 6
    assert {k for triangle in triangles for k in triangle} == set(range(8))


def islands(rng):
    """Six forbidden islands on a torus of 360 by 360, clockwise."""
    found = []
    for k in range(6):
        centre = np.array([60 + 120 * (k % 3), 90 + 180 * (k // 3)])
        centre = centre + rng.uniform(-10, 10, 2)
        angles, far = np.linspace(0, -2 * np.pi, 13, endpoint=False), rng.uniform(20, 45, 13)
        at = centre + far[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
        found.append(np.vstack([at, at[:1]]))
    return found


@given(SEEDS)
def test_a_torus_with_islands_is_cut_open_as_shapely_cuts_it(seed):
    rng = np.random.default_rng(seed)
    loops, cut = islands(rng), rng.uniform(0, TURN, 2)
    area = TURN**2 + sum(polygon.area(loop) for loop in loops)
    found = assembled(loops, (True, True), np.stack([cut, cut + TURN], axis=1))
    window = shapely.box(*cut, *(cut + TURN))
    steps = [np.array([i, j]) * TURN for i in (-1, 0, 1, 2) for j in (-1, 0, 1, 2)]
    copies = [shapely.Polygon(loop + step) for loop in loops for step in steps]
    expected = window.difference(shapely.union_all(copies))
    ours = shapely.union_all([shapely.Polygon(piece.outer, piece.holes) for piece in found])
    assert all(polygon.area(piece.outer) > 0 for piece in found)
    assert shapely.area(shapely.symmetric_difference(ours, expected)) < 1e-6
    rings = [ring for piece in found for ring in (piece.outer, *piece.holes)]
    assert sum(map(polygon.area, rings)) == pytest.approx(area)
