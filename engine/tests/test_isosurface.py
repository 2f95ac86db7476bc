"""Marching cubes against scikit-image's, and as a surface without holes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from skimage.measure import marching_cubes as scikit

from cspace.geometry.isosurface import marching_cubes, table


def walled(seed, size):
    """Random values, negative on the faces of the grid."""
    values = np.random.default_rng(seed).normal(size=(size, size + 1, size + 2))
    for axis in range(3):
        np.moveaxis(values, axis, 0)[[0, -1]] = -1
    return values


def volume(places, triangles):
    a, b, c = np.moveaxis(places[triangles], 1, 0)
    return -float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


@given(st.integers(0, 10**6), st.integers(3, 8))
def test_every_edge_has_one_triangle_on_each_side(seed, size):
    _, triangles = marching_cubes(walled(seed, size))
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    found = set(map(tuple, edges.tolist()))
    assert len(found) == len(edges)
    assert {(b, a) for a, b in found} == found


@pytest.mark.parametrize("steps", [20, 41])
def test_a_smooth_surface_is_that_of_scikit_image(steps):
    x, y, z = np.meshgrid(*[np.linspace(-1, 1, steps)] * 3, indexing="ij")
    values = 0.71 - np.sqrt(x**2 + y**2 + (z * 1.1) ** 2)
    places, triangles = marching_cubes(values)
    other, their_triangles, _, _ = scikit(values, 0.0, gradient_direction="ascent")
    assert len(places) == len(other)
    assert len(triangles) == len(their_triangles)
    ours, theirs = (np.sort(each.round(5), axis=0) for each in (places, other))
    assert np.allclose(ours, theirs, atol=1e-4)
    expected = volume(other, their_triangles)
    assert volume(places, triangles) == pytest.approx(expected, rel=1e-3)


def test_a_plane_through_the_places_of_the_grid_has_no_triangle_without_area():
    values = np.broadcast_to(np.arange(-2.0, 3.0)[:, None, None], (5, 4, 4))
    places, triangles = marching_cubes(values)
    a, b, c = np.moveaxis(places[triangles], 1, 0)
    assert len(triangles) == 18
    assert (np.linalg.norm(np.cross(b - a, c - a), axis=1) > 0).all()
    assert (places[:, 0] == 2).all()


def test_the_table_has_at_most_five_triangles_and_none_where_all_corners_agree():
    assert table().shape == (256, 5, 3)
    assert (table()[[0, 255]] == -1).all()
