# ruff: noqa: E501  (one table, a case a line)
"""Proved regions: areas at 30 digits by other means, and proposals that are wrong in one thing."""

from dataclasses import dataclass, replace

import mpmath
import numpy as np
import pytest
from flint import arb
from numpy.testing import assert_allclose

from cspace import find_region, load_robot
from cspace.proofs import Unproved
from cspace.proofs.exact.numbers import precision
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.exact.region import prove_region
from cspace.region import Problem, Region, solve, window_problem
from engine_support.exact import stated
from engine_support.forms import EDGES, LIMITS
from engine_support.robots import random_robot
from lizarraga2025.beyond.certainty import exact_windows_problem
from qbound import window_region

MINERVA = load_robot("minervabot-v2")
EXACT = exact_robot("minervabot-v2")
CLEARANCE = exact_problem(EXACT)
REGION = find_region(MINERVA)


def near(ball: arb, value: mpmath.mpf, digits: int = 30) -> bool:
    with precision(200):
        return bool(abs(ball - arb(mpmath.nstr(value, 45))) < arb(10) ** -digits)


def test_area_within_windows_is_that_of_mpmath_to_30_digits():
    """Table 6's box less two corners under the floor: Theorem 2's roots, by tanh-sinh."""
    problem = exact_windows_problem(MINERVA, EXACT)
    proved = prove_region(problem, solve(window_problem(window_region(MINERVA))))
    with mpmath.workdps(45):
        high1 = zero("4.91", "-11.5", "10", 1.33)  # z of B1
        low1 = zero("-1.5", "12.41", "7.5", -2.378)  # x of B2
        high2 = zero("-5.25", "-9.09", "10.11", 0.775)  # z of B3
        low2 = zero("9", "5.25", "10.17", -2.833)  # x of B4
        left = mpmath.findroot(lambda q1: floor(q1, low2), -1.642)
        right = mpmath.findroot(lambda q1: floor(q1, high2), 0.5885)
        under = mpmath.quad(lambda q1: floor_root(q1, -3, -0.8) - low2, [low1, left])
        above = mpmath.quad(lambda q1: high2 - floor_root(q1, -1.3, 0.8), [right, high1])
        area = (high1 - low1) * (high2 - low2) - under - above
        assert near(proved.area, area)


def zero(a: str, b: str, c: str, start: float) -> mpmath.mpf:
    """Root of a cos q + b sin q + c."""
    m = mpmath.mpf
    return mpmath.findroot(lambda q: m(a) * mpmath.cos(q) + m(b) * mpmath.sin(q) + m(c), start)


def floor(q1, q2):
    """Height of the tool above the floor, from Tables 1 and 5."""
    m, cos, sin = mpmath.mpf, mpmath.cos, mpmath.sin
    return m("11.18") - 15 * sin(q1) + m("25.98") * cos(q1) - 25 * sin(q1 + q2)


def floor_root(q1, low, high):
    """The one root of the floor in q2 between two values."""
    turn = 2 * mpmath.pi
    c = floor(q1, -q1)  # without the last link
    q = mpmath.asin(c / 25) - q1
    other = mpmath.pi - mpmath.asin(c / 25) - q1
    (found,) = [x + k * turn for x in (q, other) for k in (-1, 0, 1) if low < x + k * turn < high]
    return found


def test_areas_of_all_components_agree_with_the_float_engine():
    proved = prove_region(CLEARANCE, REGION)
    areas = [float(c.area) for c in proved.components]
    assert_allclose(areas, [c.area for c in REGION.components], rtol=1e-12)
    assert [len(c.vertices) for c in proved.components] == [6, 6, 6, 3, 3]
    assert all(c.area.rad() < 1e-33 for c in proved.components)


DEGENERATE = {
    "identically zero", "1 - cos q1", "1 - cos q2", "cos q1 - 1", "cos q1 + cos q2 - 2",
    "cos q1 cos q2", "cos q1 + cos q2", "cos q1 - cos q2", "two lobes at a saddle",
    "saddle, the other way", "x^2", "-x^2", "(x - y)^2", "1 - cos(q1 - q2)", "tangent discs",
    "disc between limits", "the same form twice", "scaled copies", "a form and its negative",
    "three curves at a point", "three lines at a point", "limits wider than a turn",
    "many turns", "a range of no width", "coincident lines", "opposite lines",
    "a line through corners", "a line along a limit", "a strip",
}  # fmt: skip
"""Rows of the edge table with curves that touch, coincide or cross themselves, or wide limits."""


@pytest.mark.parametrize("name", EDGES)
def test_edge_cases_are_proved_right_or_refused(name):
    kinds, ranges, terms, expected = EDGES[name]
    exact = stated(kinds, terms, ranges)
    floats = exact.forms.coefficients.astype(float)
    problem = Problem(type(exact.forms)(floats, kinds), exact.names, ranges, LIMITS)
    region = solve(problem, np.array([0.1, 0.2]))
    if name in DEGENERATE:
        with pytest.raises(Unproved):
            prove_region(exact, region)
        return
    areas = [float(c.area) for c in prove_region(exact, region).components]
    assert_allclose(sorted(areas, reverse=True), [area for area, *_ in expected], rtol=1e-9)


@pytest.mark.parametrize("seed", range(300, 316))
def test_random_robots_are_proved_as_the_float_engine_finds_them(seed):
    robot = random_robot(seed)
    region = find_region(robot)
    if any(
        j.limits and j.kind == "revolute" and np.ptp(j.limits) > 2 * np.pi for j in robot.joints
    ):
        with pytest.raises(Unproved, match="as wide as a turn"):
            prove_region(exact_problem(exact_robot(robot)), region)
        return
    proved = prove_region(exact_problem(exact_robot(robot)), region)
    for one, other in zip(proved.components, region.components, strict=True):
        if one.area is not None:
            assert_allclose(float(one.area), other.area, rtol=1e-10, atol=1e-12)


def changed(**fields) -> Region:
    """The region with the home component changed."""
    home, *others = REGION.components
    return replace(REGION, outlined=(replace(home, **fields), *others))


@dataclass(frozen=True)
class Proposed:
    """As much of an arc as a proof reads."""

    boundary: str
    points: np.ndarray


HOME = REGION.components[0]
ARCS = tuple(Proposed(arc.boundary, arc.points) for arc in HOME.loops[0])
FAULTS = {
    "a component is missing": (replace(REGION, outlined=REGION.components[:-1]), "proved"),
    "home is missing": (replace(REGION, outlined=REGION.components[1:]), "proved"),
    "a component comes twice": (replace(REGION, outlined=(*REGION.components, HOME)), "vertices are proposed"),
    "nothing is proposed": (replace(REGION, outlined=()), "proved|without a boundary"),
    "a loop is missing": (changed(loops=()), "vertices are proposed|positive"),
    "an arc is missing": (changed(loops=(ARCS[1:],)), "no crossing|graph|short|run"),
    "the arcs run backwards": (changed(loops=(tuple(replace(a, points=a.points[::-1]) for a in ARCS[::-1]),)), "left"),
    "a boundary has another's name": (changed(loops=((replace(ARCS[0], boundary="B3"), *ARCS[1:]),)), "no crossing|no point|run"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_proposal_that_is_wrong_in_one_thing_is_not_proved(name):
    region, message = FAULTS[name]
    with pytest.raises(Unproved, match=message):
        prove_region(CLEARANCE, region)


def test_a_hole_that_is_not_proposed_is_found():
    disc = {"00": -0.25, "20": 1, "02": 1}
    square = ((-1, 1), (-1, 1))
    exact = stated(("prismatic", "prismatic"), [disc], square)
    problem = Problem(
        type(exact.forms)(exact.forms.coefficients.astype(float), exact.kinds),
        exact.names,
        ((-1.0, 1.0), (-1.0, 1.0)),
        LIMITS,
    )
    region = solve(problem, np.array([0.9, 0.9]))
    assert near(prove_region(exact, region).area, 4 - mpmath.pi / 4, 14)
    (whole,) = region.components
    outer = max(whole.loops, key=lambda loop: max(np.abs(a.points).max() for a in loop))
    with pytest.raises(Unproved, match="not proposed"):
        prove_region(exact, replace(region, outlined=(replace(whole, loops=(outer,)),)))


def test_of_bodies_the_components_are_proved_and_no_area_and_no_place_in_them():
    robot = load_robot("two-links-on-a-table")
    problem = exact_problem(exact_robot(robot))
    proved = prove_region(problem, find_region(robot))
    assert [component.area for component in proved.components] == [None, None]
    with pytest.raises(ValueError, match="bodies"):
        _ = proved.area
