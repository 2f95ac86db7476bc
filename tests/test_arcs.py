"""Arcs: exact places along them, and integrals that need no polygon."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shapely import LineString, Point

from qbound import find_region, load_robot
from qbound.region.outline import integrate
from support.regions import inside_limits, relative
from support.robots import random_robot

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


@pytest.mark.parametrize("seed", SEEDS)
def test_greens_theorem_on_the_arcs_gives_area_and_centroid(seed):
    """The library integrates cell by cell; the arcs know nothing of cells."""
    for component in find_region(random_robot(seed)).components:
        if any(component.wraps) or component.area < 1e-6:
            continue
        arcs = [arc for loop in component.loops for arc in loop]
        area, first, second = integrate(arcs, greens)
        assert_allclose(area, component.area, rtol=1e-9)
        assert_allclose(np.array([first, second]) / area, component.centroid, atol=1e-8)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_an_integral_takes_as_many_nodes_in_any_unit(scale):
    arcs, asked = arcs_of(find_region(random_robot(21))), []

    def counted(unit):
        def form(q, dq):
            asked.append(len(q))
            return greens(unit * q, unit * dq)

        return form

    own, other = (integrate(arcs, counted(unit)) for unit in (1.0, scale))
    assert asked[: len(asked) // 2] == asked[len(asked) // 2 :]
    assert_allclose(other, own * scale ** np.array([2.0, 3.0, 3.0]), rtol=1e-9)


def greens(q, dq):
    """Integrands of area and first moments: x dy, x^2 / 2 dy, - y^2 / 2 dx."""
    (x, y), (dx, dy) = q.T, dq.T
    return np.stack([x * dy, x**2 / 2 * dy, -(y**2) / 2 * dx], axis=-1)


def test_vertices_are_the_ends_of_arcs():
    component = find_region(load_robot("minervabot-v2")).home
    starts = [arc.points[0] for loop in component.loops for arc in loop]
    ends = [arc.points[-1] for loop in component.loops for arc in loop]
    assert_allclose([v.q for v in component.vertices], starts, atol=0)
    assert_allclose(np.roll(ends, 1, axis=0), starts, atol=1e-12)
