"""Polygons of joint space, and paths in a plane, against shapely."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from shapely import LineString, Point, Polygon
from shapely.affinity import scale as shapely_scale

from cspace import find_region
from cspace.geometry.polygon import along_edges, area, centroid, scaled
from engine_support.regions import inside_limits, relative
from engine_support.robots import random_robot

COORDINATES = st.integers(-500, 500).map(lambda k: k / 100)


@st.composite
def polygons(draw: st.DrawFn) -> np.ndarray:
    """Star-shaped about a random place, so simple; anticlockwise; mostly not convex."""
    m = draw(st.integers(3, 9))
    radii = np.array(draw(st.lists(st.integers(5, 300), min_size=m, max_size=m))) / 100
    angles = 2 * np.pi * (np.arange(m) + 0.3 * np.cos(radii)) / m
    middle = np.array([draw(COORDINATES), draw(COORDINATES)])
    return middle + radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)


@given(polygons())
def test_area_and_centroid_are_shapelys(p) -> None:
    shape = Polygon(p)
    assert area(p) == pytest.approx(shape.area)
    assert_allclose(centroid(p), [shape.centroid.x, shape.centroid.y], atol=1e-9)


@given(polygons(), st.floats(0.1, 2))
def test_scaling_about_the_centroid_is_shapelys(p, factor) -> None:
    """The second remedy: the centroid stays, the area goes with the square."""
    g = centroid(p)
    small = scaled(p, factor, g)
    expected = shapely_scale(Polygon(p), factor, factor, origin=Point(*g))
    assert_allclose(small, np.array(expected.exterior.coords)[:-1], atol=1e-9)
    assert area(small) == pytest.approx(factor**2 * area(p))
    assert_allclose(centroid(small), g, atol=1e-8)


@given(polygons(), st.lists(st.floats(0, 1), min_size=1, max_size=4))
def test_points_along_edges_divide_them(p, t) -> None:
    """Fraction t of edge i, from vertex i to the next; the last edge closes the polygon."""
    points = along_edges(p, t)
    assert points.shape == (len(p), len(t), 2)
    for i, row in enumerate(points):
        edge = LineString([p[i], p[(i + 1) % len(p)]])
        for fraction, point in zip(t, row, strict=True):
            expected = edge.interpolate(fraction, normalized=True)
            assert_allclose(point, [expected.x, expected.y], atol=1e-12)


def test_centroid_of_the_area_is_not_that_of_the_vertices() -> None:
    p = np.array([[0, 0], [4, 0], [4, 1], [2, 1], [0, 1]])  # a vertex more on one side
    assert_allclose(centroid(p), [2, 0.5])
    assert p.mean(axis=0)[1] == pytest.approx(0.6)


@pytest.mark.parametrize(
    "p", [[[0, 0], [1, 1], [2, 2]], [[1, 1], [1, 1], [1, 1]], [[0, 0], [1, 0]]],
    ids=["on a line", "one point", "two points"],
)  # fmt: skip
def test_a_polygon_without_area_has_no_centroid(p) -> None:
    assert area(p) == 0
    with pytest.raises(ValueError, match="without area"):
        centroid(p)


# --- arcs -----------------------------------------------------------------------------------------


SEEDS = [3, 8, 13, 21, 34, 36, 44, 55]


def arcs_of(region):
    return [arc for c in region.components for loop in c.loops for arc in loop]


@pytest.mark.parametrize("seed", SEEDS)
def test_every_place_along_an_arc_is_on_its_boundary(seed):
    region = find_region(random_robot(seed))
    for arc in arcs_of(region):
        q = arc.at(np.linspace(0, 1, 57))
        values = relative(region.problem, q)
        assert inside_limits(region.problem, q, 1e-9).all()
        assert (values > -1e-9).all()
        if arc.boundary in region.problem.names:
            assert np.abs(values[:, region.problem.names.index(arc.boundary)]).max() < 1e-9
        else:
            assert np.ptp(q, axis=0).min() < 1e-12  # a limit is straight


@pytest.mark.parametrize("seed", SEEDS)
def test_an_arc_runs_from_its_first_point_to_its_last(seed):
    for arc in arcs_of(find_region(random_robot(seed))):
        assert_allclose(arc.at([0, 1]), arc.points[[0, -1]], atol=1e-12)
        q, dq = arc.nodes(96)
        assert_allclose(dq.sum(axis=0), arc.points[-1] - arc.points[0], atol=1e-9)
        line = LineString(arc.points)
        assert max(line.distance(Point(x)) for x in q) < 0.02
