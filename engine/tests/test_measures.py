"""Measures: closed forms, grids, rays, and what must hold of the nearest boundary point."""

from __future__ import annotations

import tomllib
from math import hypot, pi

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace import find_region, load_robot
from cspace.measures.nearest import along, moments, nearest_boundary
from cspace.model.robotfile import parse_robot
from cspace.region import Problem, Region, solve
from engine_support.forms import LIMITS
from engine_support.regions import inside_limits, plate
from engine_support.robots import random_robot
from qbound.forms import HarmonicForm

TURN = 2 * pi


def only(region: Region):
    (component,) = region.components
    return component


# --- moments -------------------------------------------------------------------------------------


def test_moments_of_a_plate_with_a_round_hole_in_closed_form():
    a, b, r, hole = 8.0, 6.0, 1.25, np.array([2.0, 1.5])
    region = solve(plate((*hole, r)), [-2, -1])
    found = moments(region.problem, only(region))
    disc = pi * r**2
    area = a * b - disc
    mean = (a * b * np.array([1.0, 1.0]) - disc * hole) / area
    second = np.diag([a**3 * b / 12, a * b**3 / 12]) + a * b * np.outer(
        [1, 1] - mean, [1, 1] - mean
    )
    second -= np.eye(2) * pi * r**4 / 4 + disc * np.outer(hole - mean, hole - mean)
    assert found.area == pytest.approx(area, rel=1e-13)
    assert_allclose(found.centroid, mean, rtol=1e-13)
    assert_allclose(found.second, second, rtol=1e-12, atol=1e-10)


@pytest.mark.parametrize("seed", range(40))
def test_area_and_centroid_by_arcs_are_those_by_cells(seed):
    """Green on the arcs, and the area by cells."""
    region = find_region(random_robot(seed))
    for component in region.components:
        if any(component.wraps) or component.area < 1e-4:
            continue
        found = moments(region.problem, component)
        assert found.area == pytest.approx(component.area, rel=1e-9)
        assert_allclose(found.centroid, component.centroid, atol=1e-8)


def test_a_band_has_no_moments():
    region = find_region(load_robot("pr-gantry-arm"))
    assert only(region).wraps == (False, True)
    with pytest.raises(ValueError, match="goes round a joint"):
        moments(region.problem, only(region))


# --- which component -----------------------------------------------------------------------------


def copies(q: np.ndarray, problem: Problem, rng) -> np.ndarray:
    """Some other turn of the joints that have no limits."""
    rounds = [side is None for side in problem.ranges]
    return q + TURN * rng.integers(-2, 3, size=2) * rounds


@pytest.mark.parametrize("seed", range(20))
def test_fractions_of_random_configurations_are_the_areas(seed):
    """Uniform configurations fall into each component in the proportion of its area."""
    robot = random_robot(seed)
    region = find_region(robot)
    rng = np.random.default_rng(seed)
    ends = np.array([side or (-pi, pi) for side in region.problem.ranges])
    n = 60
    counts = np.zeros(len(region.components))
    for q in rng.uniform(*ends.T, size=(n, 2)):
        free = bool((region.problem.forms(q) > 0).all())
        where = region.component_of(q)
        assert (where is not None) == free
        assert region.component_of(copies(q, region.problem, rng)) == where
        if where is not None:
            counts[where] += 1
    share = np.array([c.area for c in region.components]) / np.prod(ends[:, 1] - ends[:, 0])
    spread = np.sqrt(np.maximum(share * (1 - share), 0) * n)  # all of it, but for rounding
    assert (np.abs(counts - share * n) <= 5 * spread + 1).all()


@pytest.mark.parametrize("seed", range(16))
def test_a_step_from_an_arc_into_the_region_is_in_its_component(seed):
    region = find_region(random_robot(seed))
    for i, component in enumerate(region.components):
        for arc in (a for loop in component.loops for a in loop):
            q, dq = (x[len(arc.points) // 2 - 1, 0] for x in along(arc, [0.5]))
            left = np.array([-dq[1], dq[0]]) / max(hypot(*dq), 1e-300)
            inside = q + 1e-4 * left
            nearest = nearest_boundary(region, inside)
            if nearest.distance > 0.9e-4:  # nothing else passes within the step
                assert region.component_of(inside) == i


def test_a_free_torus_is_one_component():
    forms = HarmonicForm(np.zeros((0, 3, 3)), ("revolute", "revolute"))
    region = solve(Problem(forms, (), (None, None), LIMITS), [0, 0])
    assert region.component_of([17.0, -40.0]) == 0
    with pytest.raises(ValueError, match="no boundary"):
        nearest_boundary(region, [0, 0])


# --- the nearest boundary point ------------------------------------------------------------------


def test_nearest_points_of_a_plate_in_closed_form():
    region = solve(plate((1.0, 1.0, 1.0)), [-2, -1])
    beside = nearest_boundary(region, [2.5, 1.0])
    assert (beside.boundary, beside.distance) == ("hole 0", pytest.approx(0.5, abs=1e-12))
    assert_allclose(beside.q, [2.0, 1.0], atol=1e-9)
    corner = nearest_boundary(region, [-2.9, -1.7])
    assert (corner.boundary, corner.distance) == ("x.lower", pytest.approx(0.1, abs=1e-12))
    inside_hole = nearest_boundary(region, [1.2, 1.0])
    assert inside_hole.distance == pytest.approx(0.8, abs=1e-12)


SLANTING_FLOOR = """
schema = 1
name = "a tip above a slanting floor"
length_unit = "cm"
angle_unit = "deg"
home = { q1 = 54, q2 = 1 }
tool = "tip"
joint = [
  { name = "q1", type = "revolute", parent = "base", frame = "1", origin = [36.4, 82.9, -87.2], axis = [-0.154, -0.249, -0.647], rpy = [124, 57.7, 62.6] },
  { name = "q2", type = "prismatic", parent = "1", frame = "2", origin = [-17.6, -102.6, -113], axis = [0.625, -0.32, 0.364], limits = [-87.6, 151.8] },
]
point = [{ name = "tip", frame = "2", at = [-0.9, -51.4, -148.4], radius = 13.4 }]
boundary = [{ name = "floor", type = "half-space", point = "tip", normal = [-0.45, -0.208, -0.47], offset = -113 }]
"""  # noqa: E501


@pytest.mark.parametrize("weights", [(1.0, 1.0), (100.0, 1.0), (1.0, 50.0)])
def test_the_nearest_point_is_that_of_dense_arcs_where_a_curve_folds_between_two_points(weights):
    """In rad and cm a curve may turn towards a configuration and away between two of its points."""
    region = find_region(parse_robot(tomllib.loads(SLANTING_FLOOR)))
    arcs = [arc for component in region.components for loop in component.loops for arc in loop]
    dense = np.concatenate([arc.at(np.linspace(0, 1, 60_001)) for arc in arcs])
    places = np.random.default_rng(3).uniform([-3, 80], [3, 110], (5, 2))
    for q in [np.array([3.0458, 90.4295]), *places]:
        gaps = dense - q
        gaps[:, 0] = (gaps[:, 0] + pi) % TURN - pi
        least = np.hypot(*(weights * gaps).T).min()
        found = nearest_boundary(region, q, weights=weights)
        assert least - 1e-5 * max(weights) < found.distance <= least * (1 + 1e-12)
        assert abs(region.margins(found.q).min()) < 1e-9


def test_from_the_middle_of_a_round_hole_every_place_is_the_nearest():
    """No second derivative says which: the search ends all the same."""
    region = solve(plate((2.0, 1.0, 1.0)), [-2, 1])
    assert nearest_boundary(region, [2.0, 1.0]).distance == pytest.approx(1, abs=1e-12)


def test_weights_stretch_the_metric():
    region = solve(plate(), [0, 0])
    assert nearest_boundary(region, [4.5, 3.0]).boundary == "x.upper"
    found = nearest_boundary(region, [4.5, 3.0], weights=(10, 1))
    assert (found.boundary, found.distance) == ("y.upper", pytest.approx(1.0))


@pytest.mark.parametrize("seed", range(20))
def test_within_the_distance_all_is_free_and_at_it_is_the_boundary(seed):
    """A disc of the metric around a safe configuration is safe to its rim, where it touches."""
    robot = random_robot(seed)
    region = find_region(robot)
    problem = region.problem
    rng = np.random.default_rng(seed)
    ends = np.array([side or (-pi, pi) for side in problem.ranges])
    turn = np.linspace(0, TURN, 400, endpoint=False)
    rim = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    for q in rng.uniform(*ends.T, size=(3, 2)):
        w = rng.uniform(0.3, 3, size=2)
        where = region.component_of(q)
        if where is None or not any(c.loops for c in region.components):
            continue
        found = nearest_boundary(region, q, where, w)
        assert found.component == where
        assert np.hypot(*(w * (found.q - q))) == pytest.approx(found.distance, abs=1e-12)
        for part in (0.3, 0.7, 1 - 1e-7):
            disc = q + part * found.distance * rim / w
            assert (problem.forms(disc) > 0).all()
            assert inside_limits(problem, disc).all()
        if found.boundary in problem.names:
            form = problem.forms[problem.names.index(found.boundary)]
            assert abs(form(found.q)) < 1e-8 * max(1, np.abs(form.coefficients).max())
        else:
            assert min(abs(x - found.q[j]) for j in (0, 1) for x in ends[j]) < 1e-12


@pytest.mark.parametrize(
    ("q", "weights", "words"),
    [
        ([np.nan, 0], (1, 1), "finite joint values"),
        ([0, 0, 0], (1, 1), "two finite"),
        ([0, 0], (1, 0), "above zero"),
        ([0, 0], (1, np.inf), "above zero"),
    ],
)
def test_what_is_no_configuration_or_weight_is_refused(q, weights, words):
    with pytest.raises(ValueError, match=words):
        nearest_boundary(solve(plate(), [0, 0]), q, weights=weights)
