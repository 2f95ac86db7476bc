"""The largest safe scale: closed forms, brute force over the paper's polygon, refusals."""

from functools import partial
from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cspace import clearance, load_robot
from cspace.geometry.polygon import along_edges, centroid, scaled
from cspace.measures import scaling
from cspace.measures.scaling import (
    first_exit,
    largest_safe_scale,
    least,
    worst_margins,
)
from engine_support.forms import PP, RR
from engine_support.oracles import equation_29
from qbound import window_region
from qbound.forms import HarmonicForm

MINERVA = load_robot("minervabot-v2")
SQUARE = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def slides(**terms: float) -> HarmonicForm:
    """A polynomial of two slides: x, y, xx, yy, xy and one name their coefficients."""
    places = {"one": (0, 0), "x": (1, 0), "y": (0, 1), "xx": (2, 0), "yy": (0, 2), "xy": (1, 1)}
    table = np.zeros((3, 3))
    for name, value in terms.items():
        table[places[name]] = value
    return HarmonicForm(table, PP)


DISC = slides(one=1, xx=-1, yy=-1)
"""Positive inside the unit circle."""


def below(height: float) -> HarmonicForm:
    return slides(one=height, y=-1)


def outside(x: float, y: float, radius: float) -> HarmonicForm:
    return slides(one=x * x + y * y - radius**2, x=-2 * x, y=-2 * y, xx=1, yy=1)


def stack(*forms: HarmonicForm) -> HarmonicForm:
    """Forms of the same two joints as one stack; of none, of two slides."""
    tables = np.array([form.coefficients for form in forms]).reshape(-1, 3, 3)
    return HarmonicForm(tables, forms[0].kinds if forms else PP)


def floor(q: np.ndarray) -> np.ndarray:
    """B7 of the paper's robot by hand, cm."""
    return equation_29(*np.moveaxis(q, -1, 0))["beta_{7,3}"]


@pytest.mark.parametrize(
    ("forms", "scale", "edges", "form"),
    [
        ([DISC], 1 / sqrt(2), {0, 1, 2, 3}, 0),  # the corners touch
        ([below(0.25)], 0.25, {1, 2, 3}, 0),  # the whole upper edge touches
        ([below(5), DISC, below(0.25)], 0.25, {1, 2, 3}, 2),
        ([below(5)], 1.0, {-1}, -1),
        ([], 1.0, {-1}, -1),
    ],
    ids=["corners", "an edge", "the nearest of three", "out of reach", "no form"],
)
def test_largest_safe_scale_in_closed_form(forms, scale, edges, form) -> None:
    found = largest_safe_scale(SQUARE, [0, 0], stack(*forms))
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
    found = largest_safe_scale(SQUARE, [0, 0], stack(outside(x, y, 0.5)))
    assert found.scale == pytest.approx(0.8, abs=1e-12)
    assert found.edge == edge
    expected = np.where(np.abs([x, y]) > 1, 0.8 * np.sign([x, y]), 0.2)
    assert_allclose(found.q, expected, atol=1e-6)  # a minimum is flat: half the digits


@settings(max_examples=10)
@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_scaling_about_any_centre_touches_the_nearest_wall(x, y) -> None:
    """Half-plane y <= 0.75: exact for every centre below it."""
    found = largest_safe_scale(SQUARE, [x, y], stack(below(0.75)))
    assert found.scale == pytest.approx((0.75 - y) / (1 - y), abs=1e-12)


def test_the_first_crossing_counts_and_not_the_last() -> None:
    """A strip forbidden between 0.5 and 0.6 is not jumped over, though 0.9 would be free."""
    found = largest_safe_scale(SQUARE, [0, 0], stack(slides(one=0.3, y=-1.1, yy=1)))
    assert found.scale == pytest.approx(0.5, abs=1e-12)


def test_floor_of_the_papers_polygon_against_brute_force() -> None:
    """Figure 6's remedy for B7: 400 scales, 3000 points an edge, by hand-written beta_{7,3}."""
    p = window_region(MINERVA).polygon
    g = centroid(p)
    found = largest_safe_scale(p, g, stack(clearance(MINERVA, MINERVA.boundary("B7"))))
    scales = np.linspace(0.95, 0.98, 301)
    edges = along_edges(p, np.linspace(0, 1, 3001)).reshape(-1, 2)
    safe = [bool((floor(scaled(edges, s, g)) >= 0).all()) for s in scales]
    assert safe == sorted(safe, reverse=True)
    assert scales[sum(safe) - 1] <= found.scale + 1e-7
    assert found.scale - scales[sum(safe) - 1] < 1.1e-4
    assert floor(found.q) == pytest.approx(0, abs=1e-11)
    edge = p[(found.edge + 1) % 6] - p[found.edge]
    slope = (floor(found.q + 1e-6 * edge) - floor(found.q - 1e-6 * edge)) / 2e-6
    assert slope == pytest.approx(0, abs=1e-6)
    b7 = clearance(MINERVA, MINERVA.boundary("B7"))
    assert least(b7, scaled(p, found.scale - 1e-6, g), g)[0] > 0
    assert least(b7, scaled(p, found.scale + 1e-6, g), g)[0] < 0


def test_straight_edges_of_the_six_vertices_leave_the_region() -> None:
    """'Their respective constraints are not fully satisfied': by cm, on the edges of B7."""
    p = window_region(MINERVA).polygon
    value, q = least(clearance(MINERVA, MINERVA.boundary("B7")), p, centroid(p))
    assert value < -1
    assert floor(q) == pytest.approx(value)
    edges = along_edges(p, np.linspace(0, 1, 2001))
    assert floor(edges).min() == pytest.approx(value, abs=1e-8)
    assert floor(edges).min() >= value


@pytest.mark.parametrize("centre", [[2.0, 0.0], [0.0, 1.0]], ids=["outside", "on the boundary"])
def test_a_centre_that_is_not_safe_is_refused(centre) -> None:
    with pytest.raises(ValueError, match="violated at the centre"):
        largest_safe_scale(SQUARE, centre, stack(DISC))


def test_a_form_that_only_touches_zero_inside_ends_with_an_error() -> None:
    """(x - 0.5)^2 + (y + 0.3)^2 is zero at one place: no triangle about it is shown to be safe."""
    touching = slides(xx=1, yy=1, one=0.34, x=-1, y=0.6)
    with pytest.raises(ArithmeticError, match="touches zero inside"):
        largest_safe_scale(SQUARE, [0.1, 0.05], stack(touching, below(3)))


def test_a_search_that_finds_ever_smaller_scales_says_so(monkeypatch) -> None:
    """Here the witness stays, whatever the scale: a bound that is not sound."""
    monkeypatch.setattr(scaling, "violation", lambda asked, cells: np.array([0.2, 0.1]))
    with pytest.raises(ArithmeticError, match="smaller ones still do"):
        largest_safe_scale(SQUARE, [0.0, 0.0], stack(DISC))


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e308])
def test_nothing_that_is_not_finite_has_a_least_value(bad) -> None:
    """Not even what is too large on the way: the least of NaN was infinite, and so safe."""
    p = SQUARE.copy()
    p[0, 0] = bad
    for form, corners in ((lambda: DISC, p), (partial(slides, one=1, x=bad, yy=bad), 3 * SQUARE)):
        with np.errstate(all="ignore"):
            for asks in (
                lambda f=form, v=corners: least(f(), v, [0, 0]),
                lambda f=form, v=corners: first_exit(stack(f()), [0, 0], v),
            ):
                with pytest.raises(ValueError, match="finite numbers"):
                    asks()


def test_a_dip_that_no_sample_sees_is_found() -> None:
    """A hole of radius 1e-4 beside the middle of an edge, between any points that one would try."""
    hole = outside(0.4321, 0.7 + 1e-4, 1e-4)
    found = largest_safe_scale(SQUARE, [0, 0], stack(hole))
    assert found.scale == pytest.approx(0.7, abs=1e-9)
    assert found.edge == 2
    assert found.proved < found.scale


@pytest.mark.parametrize("seed", range(12))
def test_nothing_is_violated_at_the_proved_scale_and_something_just_above(seed) -> None:
    """Random forms of two turns: brute force inside, and the touching point itself."""
    rng = np.random.default_rng(seed)
    table = rng.normal(size=(3, 3, 3))
    table[:, 0, 0] = np.abs(table).sum(axis=(1, 2)) * rng.uniform(0.2, 0.5, 3)
    forms = HarmonicForm(table, RR)
    polygon = np.array([[-2.0, -1.5], [2.5, -1], [0.5, 0.2], [1.5, 2], [-1, 1.8]])
    if not (forms(np.zeros(2)) > 0).all():
        return
    found = largest_safe_scale(polygon, [0, 0], forms)
    edges = along_edges(found.proved * polygon, np.linspace(0, 1, 400)).reshape(-1, 2)
    inside = (np.linspace(0, 1, 60)[:, None, None] * edges).reshape(-1, 2)
    assert (forms(inside) > 0).all()
    if found.form >= 0:
        assert forms[found.form](found.q) == pytest.approx(0, abs=1e-10)
        assert forms[found.form](found.q * (1 + 1e-5)) < 0


@pytest.mark.parametrize("seed", range(12))
def test_a_ray_stops_at_the_first_root_of_all(seed) -> None:
    """Against signs on a fine grid along each ray."""
    rng = np.random.default_rng(seed)
    forms = HarmonicForm(rng.normal(size=(2, 3, 3)), RR)
    centre = rng.uniform(-3, 3, 2)
    if not (forms(centre) > 0).all():
        return
    rays = rng.normal(size=(20, 2)) * 3
    found, which = first_exit(forms, centre, rays)
    s = np.linspace(0, 1, 20001)
    for ray, scale, form in zip(rays, found, which, strict=True):
        negative = (forms(centre + s[:, None] * ray) < 0).any(axis=1)
        expected = s[negative.argmax()] if negative.any() else 1.0
        assert scale <= expected + 1e-9
        assert scale >= expected - 6e-5  # a dip between two places of the grid may come first
        if form >= 0:
            assert forms[form](centre + scale * ray) == pytest.approx(0, abs=1e-9)


def test_worst_margins_of_the_papers_polygon_against_forward_kinematics() -> None:
    """Figure 6 at 0.95: heights and distances on a grid of the polygon, by frames."""
    p = window_region(MINERVA).polygon
    g = centroid(p)
    found = worst_margins(MINERVA, scaled(p, 0.95, g), g)
    edges = along_edges(scaled(p, 0.95, g), np.linspace(0, 1, 2001)).reshape(-1, 2)
    frames = MINERVA.frames(edges)
    for name in ("B1", "B2", "B3", "B4"):
        one, other = (frames.position("0", x, "0") for x in MINERVA.boundary(name).points)
        gap = np.linalg.norm(other - one, axis=-1).min()
        assert found[name][0] == pytest.approx(gap - 0.1, abs=1e-4)
        assert found[name][0] <= gap - 0.1 + 1e-9
    height = frames.position("0", "3", "0")[:, 2].min() - 11.32
    assert found["B7"][0] == pytest.approx(height, abs=1e-4)
