"""Polygons of joint space against shapely."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from shapely import LineString, Point, Polygon
from shapely.affinity import scale as shapely_scale

from qbound.geometry.polygon import along_edges, area, centroid, scaled

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


@given(polygons())
def test_direction_changes_the_sign_of_the_area_alone(p) -> None:
    assert area(p[::-1]) == pytest.approx(-area(p))
    assert_allclose(centroid(p[::-1]), centroid(p), atol=1e-10)


@given(polygons(), st.floats(0.1, 2))
def test_scaling_about_the_centroid_is_shapelys(p, factor) -> None:
    """The second remedy: the centroid stays, the area goes with the square."""
    g = centroid(p)
    small = scaled(p, factor, g)
    expected = shapely_scale(Polygon(p), factor, factor, origin=Point(*g))
    assert_allclose(small, np.array(expected.exterior.coords)[:-1], atol=1e-9)
    assert area(small) == pytest.approx(factor**2 * area(p))
    assert_allclose(centroid(small), g, atol=1e-8)


@given(polygons())
def test_scaling_by_one_and_by_zero(p) -> None:
    assert_allclose(scaled(p, 1.0, [3, 4]), p, atol=1e-14)
    assert_array_equal(scaled(p, 0.0, [3, 4]), np.full_like(p, 1) * [3, 4])


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


@given(polygons(), COORDINATES, COORDINATES)
def test_centroid_moves_with_the_polygon(p, x, y) -> None:
    shift = 1e4 * np.array([x, y])
    assume(shift.any())
    assert_allclose(centroid(p + shift), centroid(p) + shift, atol=1e-7)
