"""The largest safe scale: closed forms, brute force over the paper's polygon, refusals."""

from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from oracles import equation_29

from qbound import clearance, load_robot
from qbound.paper_rule import vertices
from qbound.polygon import along_edges, centroid, scaled
from qbound.scaling import largest_safe_scale, least_along_edges

MINERVA = load_robot("minervabot-v2")
SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def disc(q: np.ndarray) -> np.ndarray:
    """Positive inside the unit circle."""
    return 1 - (q**2).sum(axis=-1)


def below(height: float):
    return lambda q: height - q[..., 1]


def floor(q: np.ndarray) -> np.ndarray:
    """B7 of the paper's robot by hand, cm."""
    return equation_29(*np.moveaxis(q, -1, 0))["beta_{7,3}"]


@pytest.mark.parametrize(
    ("forms", "scale", "edges", "form"),
    [
        ([disc], 1 / sqrt(2), {0, 1, 2, 3}, 0),  # the corners touch
        ([below(0.25)], 0.25, {1, 2, 3}, 0),  # the whole upper edge touches
        ([below(5), disc, below(0.25)], 0.25, {1, 2, 3}, 2),
        ([below(5)], 1.0, {-1}, -1),
        ([], 1.0, {-1}, -1),
    ],
    ids=["corners", "an edge", "the nearest of three", "out of reach", "no form"],
)
def test_largest_safe_scale_in_closed_form(forms, scale, edges, form) -> None:
    found = largest_safe_scale(SQUARE, [0, 0], forms)
    assert found.scale == pytest.approx(scale, abs=1e-12)
    assert found.form == form
    assert found.edge in edges
    if form >= 0:
        assert forms[form](found.q) == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize(
    ("edge", "x", "y"), [(0, 0.2, -1.3), (1, 1.3, 0.2), (2, 0.2, 1.3), (3, -1.3, 0.2)]
)
def test_an_edge_may_bind_between_its_vertices(edge, x, y) -> None:
    """A disc cut out beside the middle of any edge, the closing one too: no vertex touches it."""
    found = largest_safe_scale(SQUARE, [0, 0], [lambda q: ((q - [x, y]) ** 2).sum(-1) - 0.25])
    assert found.scale == pytest.approx(0.8, abs=1e-12)
    assert found.edge == edge
    expected = np.where(np.abs([x, y]) > 1, 0.8 * np.sign([x, y]), 0.2)
    assert_allclose(found.q, expected, atol=1e-6)  # a minimum is flat: half the digits


@settings(max_examples=10)
@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_scaling_about_any_centre_touches_the_nearest_wall(x, y) -> None:
    """Half-plane y <= 0.75: exact for every centre below it."""
    found = largest_safe_scale(SQUARE, [x, y], [below(0.75)])
    assert found.scale == pytest.approx((0.75 - y) / (1 - y), abs=1e-12)


def test_highest_limits_the_search() -> None:
    assert largest_safe_scale(SQUARE, [0, 0], [below(3)], highest=2).scale == 2
    found = largest_safe_scale(SQUARE, [0, 0], [below(3)], highest=4)
    assert found.scale == pytest.approx(3, abs=1e-12)


def test_the_first_crossing_counts_and_not_the_last() -> None:
    """A strip forbidden between 0.5 and 0.6 is not jumped over, though 0.9 would be free."""
    found = largest_safe_scale(SQUARE, [0, 0], [lambda q: (q[..., 1] - 0.5) * (q[..., 1] - 0.6)])
    assert found.scale == pytest.approx(0.5, abs=1e-12)


def test_floor_of_the_papers_polygon_against_brute_force() -> None:
    """Figure 6's remedy for B7: 400 scales, 3000 points an edge, by hand-written beta_{7,3}."""
    p = np.array([vertex.q for vertex in vertices(MINERVA)])
    g = centroid(p)
    found = largest_safe_scale(p, g, [clearance(MINERVA, MINERVA.boundary("B7"))])
    scales = np.linspace(0.95, 0.98, 301)
    edges = along_edges(p, np.linspace(0, 1, 3001)).reshape(-1, 2)
    safe = [bool((floor(scaled(edges, s, g)) >= 0).all()) for s in scales]
    assert safe == sorted(safe, reverse=True)
    assert scales[sum(safe) - 1] <= found.scale + 1e-7
    assert found.scale - scales[sum(safe) - 1] < 1.1e-4
    assert floor(found.q) == pytest.approx(0, abs=1e-11)
    assert least_along_edges(floor, scaled(p, found.scale - 1e-6, g))[0] > 0
    assert least_along_edges(floor, scaled(p, found.scale + 1e-3, g))[0] < 0


def test_straight_edges_of_the_six_vertices_leave_the_region() -> None:
    """'Their respective constraints are not fully satisfied': by cm, on the edges of B7."""
    p = np.array([vertex.q for vertex in vertices(MINERVA)])
    least, q = least_along_edges(clearance(MINERVA, MINERVA.boundary("B7")), p)
    assert least < -1
    assert floor(q) == pytest.approx(least)
    edges = along_edges(p, np.linspace(0, 1, 2001))
    assert floor(edges).min() == pytest.approx(least, abs=1e-12)


@pytest.mark.parametrize("centre", [[2.0, 0.0], [0.0, 1.0]], ids=["outside", "on the boundary"])
def test_a_centre_that_is_not_safe_is_refused(centre) -> None:
    with pytest.raises(ValueError, match="violated at the centre"):
        largest_safe_scale(SQUARE, centre, [disc])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("place", ["vertices", "centre"])
def test_numbers_that_are_not_finite_are_refused(bad, place) -> None:
    """NaN compares as neither safe nor violated, and must not read as safe."""
    p, g = SQUARE.copy(), np.zeros(2)
    (p[0] if place == "vertices" else g)[0] = bad
    with np.errstate(all="ignore"), pytest.raises(ValueError, match=r"finite|centre"):
        largest_safe_scale(p, g, [disc])
