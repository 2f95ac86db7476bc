"""The exact region scaled about a point: closed forms, the region by windows, polygons inside."""

from math import sqrt

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shapely import Polygon

from cspace import find_region, load_robot
from cspace.geometry import polygon
from cspace.measures.star import exact_scale, inner_polygon
from cspace.region import clearance_problem, solve, window_problem
from engine_support.regions import plate
from engine_support.robots import in_centimetres, mirror
from qbound import window_region

MINERVA = load_robot("minervabot-v2")


def test_a_hole_hides_what_is_behind_it() -> None:
    """The wall behind, at x = 5, comes to the near point (1, 1) of the hole at scale 3 / 7."""
    region = solve(plate((2.0, 1.0, 1.0)), [-2, 1])
    found = exact_scale(region.problem, region.components[0], [-2.0, 1.0])
    assert not found.star_shaped
    assert found.scale == pytest.approx(3 / 7, abs=1e-9)
    assert (found.boundary, found.arc.boundary) == ("hole 0", "x.upper")
    assert_allclose(found.q, [1.0, 1.0], atol=1e-6)
    assert {arc.boundary for arc in found.hidden} >= {"hole 0", "x.upper"}


def test_the_papers_regions_are_star_shaped_about_their_centroids() -> None:
    """By windows and by clearances, in every component: each smaller scale is safe."""
    for region in (solve(window_problem(window_region(MINERVA))), find_region(MINERVA)):
        for component in region.components:
            found = exact_scale(region.problem, component, component.centroid)
            assert found.star_shaped
            smaller = np.concatenate([arc.points for arc in component.loops[0]])
            for s in (0.999, 0.9, 0.5):
                q = component.centroid + s * (smaller - component.centroid)
                assert (region.problem.forms(q) > 0).all()


@pytest.mark.parametrize("n", [5, 9, 17])
def test_an_inner_polygon_is_inside_and_comes_close(n) -> None:
    region = find_region(MINERVA)
    for component in region.components:
        (ring,) = inner_polygon(region.problem, component, n)
        shape = Polygon(ring)
        assert shape.is_valid
        assert 0.97 * component.area < shape.area < component.area
        x, y = np.concatenate([arc.points for arc in component.loops[0]]).T
        dense = Polygon(np.stack([x, y], -1)).buffer(2e-2)
        assert dense.contains(shape)
        t = np.linspace(0, 1, 257)
        assert (region.problem.forms(polygon.along_edges(ring, t)) > -1e-9).all()


def test_chords_of_a_disc_and_tangents_of_a_hole_in_closed_form() -> None:
    """The tangents at four points of a circular hole make the square around it."""
    region = solve(plate((1.0, 1.0, 1.0)), [-2, -1])
    component = region.components[0]
    outer, hole = sorted(inner_polygon(region.problem, component, 2), key=polygon.area)[::-1]
    assert polygon.area(outer) == pytest.approx(48)
    assert -polygon.area(hole) == pytest.approx(4, abs=1e-9)
    reach = np.hypot(*(hole - 1).T)
    assert_allclose(reach.max(), sqrt(2), atol=1e-9)
    assert polygon.area(outer) + polygon.area(hole) < component.area


@pytest.mark.parametrize("n", [2, 3, 9])
def test_a_polygon_inside_is_the_same_over_either_joint_mirrored_and_in_any_unit(n) -> None:
    """Arcs end at the folds over a joint; the parts of a polygon do not depend on it."""

    def shares(robot, base=0):
        region = solve(clearance_problem(robot), base=base)
        rings = [inner_polygon(region.problem, part, n)[0] for part in region.components]
        pairs = zip(rings, region.components, strict=True)
        return [polygon.area(ring) / part.area for ring, part in pairs]

    expected = shares(MINERVA)
    assert_allclose(shares(MINERVA, base=1), expected, rtol=1e-11)
    assert_allclose(shares(in_centimetres(MINERVA)), expected, rtol=1e-11)
    assert_allclose(sorted(shares(mirror(MINERVA))), sorted(expected), rtol=1e-11)


def test_too_few_tangents_are_refused() -> None:
    """The square about one hole reaches into the other one; a polygon of more tangents does not."""
    holes = solve(plate((0.0, 0.0, 1.0), (1.5, 1.5, 1.0)), [-2, 1])
    with pytest.raises(ValueError, match="too few"):
        inner_polygon(holes.problem, holes.components[0], 2)
    assert len(inner_polygon(holes.problem, holes.components[0], 9)) == 3
    region = find_region(load_robot("pp-portal"))
    with pytest.raises(ValueError, match="at least its 2 ends"):
        inner_polygon(region.problem, region.components[0], 1)
    rings = inner_polygon(region.problem, region.components[0], 9)
    assert sum(map(polygon.area, rings)) > 0.98 * region.components[0].area


def test_a_band_and_an_unsafe_centre_are_refused() -> None:
    band = find_region(load_robot("pr-gantry-arm"))
    with pytest.raises(ValueError, match="goes round a joint"):
        exact_scale(band.problem, band.components[0], [0.9, 0])
    with pytest.raises(ValueError, match="goes round a joint"):
        inner_polygon(band.problem, band.components[0], 3)
    region = find_region(MINERVA)
    with pytest.raises(ValueError, match="violated at the centre"):
        exact_scale(region.problem, region.components[0], [1.4, 0.0])
