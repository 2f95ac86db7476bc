# ruff: noqa: E501  (one table, a case a line)
"""Cases at the edge of rounding: take away the guard that a test names, and it fails.

Each guard of the region's engine (its tolerance says why there is one) is needed somewhere; here is
where. Areas are known in closed form.
"""

from fractions import Fraction
from math import asinh, cos, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from cspace import load_robot
from cspace.measures.nearest import moments, nearest_boundary
from cspace.region.region import Region, clearance_problem, solve
from engine_support.forms import EDGES, PP, ROUND, RP, RR, SQUARE, TURN, forms, moved
from engine_support.regions import moved_pieces, pieces, pieces_of, problem_of
from engine_support.robots import drawn_robot, random_robot
from qbound.circle import circle_roots

both_bases = pytest.mark.parametrize("base", [0, 1])


def test_a_tangency_in_decimals_is_one_double_root() -> None:
    """0.21, 0.28, 0.35 is a right triangle, but its doubles miss c = d by a rounding."""
    for triple in ((3, 4, 5), (5, 12, 13), (8, 15, 17), (20, 21, 29)):
        a, b, c = np.array(triple)[:, None] * np.arange(1, 200) / 100
        assert (circle_roots(a, b, c).count == 1).all()
        assert (circle_roots(a, b, -c).count == 1).all()
        assert (np.abs(a * a + b * b - c * c) > 0).any()


@both_bases
def test_wherever_a_form_touches_zero_on_a_fibre_the_fibre_stays_open(base) -> None:
    """(v - b)^2 + 1 - cos q is zero at (0, b) alone: a band less a point is one band.

    Doubles count as exact numbers: where b^2 + 1 is rounded down there is a hole.
    """
    for b in np.arange(-49, 50) / 25:
        touching = forms(RP, {"00": b * b + 1, "01": -2 * b, "02": 1, "10": -1})
        (piece,) = pieces(touching, (None, (-2.0, 2.0)), base)
        hole = Fraction(b * b + 1) < Fraction(b) ** 2 + 1
        assert piece[1:] == ((True, False), 2 + hole), b
        assert_allclose(piece[0], 4 * TURN, rtol=1e-9)


@both_bases
@pytest.mark.parametrize("name", EDGES)
def test_edge_cases_keep_their_pieces_when_joints_are_zeroed_elsewhere(name, base) -> None:
    """Double roots and fibres on which a form vanishes are then so only but for rounding."""
    kinds, ranges, terms, expected = EDGES[name]
    for seed in range(6):
        meant = moved(forms(kinds, *terms), ranges, np.random.default_rng(seed))
        found = moved_pieces(meant, base)
        assert [piece[1:] for piece in found] == [piece[1:] for piece in expected], seed
        areas = [piece[0] * meant.part for piece in expected]
        assert_allclose([piece[0] for piece in found], areas, rtol=1e-7)


@both_bases
@pytest.mark.parametrize("scale", [1e-20, 1e20])
def test_the_unit_of_a_form_does_not_matter(scale, base) -> None:
    for name in ("one curve", "a hole within limits", "a band round the cylinder", "a strip"):
        kinds, ranges, terms, expected = EDGES[name]
        tiny = [{key: scale * value for key, value in term.items()} for term in terms]
        found = pieces(forms(kinds, *tiny), ranges, base)
        assert [piece[1:] for piece in found] == [piece[1:] for piece in expected], name
        assert_allclose([piece[0] for piece in found], [p[0] for p in expected], rtol=1e-8)


@both_bases
def test_squares_that_touch_at_corners_are_two_wherever_they_lie(base) -> None:
    assert [turn for turn in np.arange(-60, 60, 3) / 20 if not two_squares(turn, base)] == []


@both_bases
def test_a_fibre_on_which_a_form_vanishes_but_for_rounding_between_limits(base) -> None:
    """cos q1 + cos(q1 + q2 + a) > 0: zero for every q1 where q2 = pi - a."""
    for a in np.linspace(0.05, 3.1, 12):
        c, s = np.cos(a), np.sin(a)
        term = {"10": 1, "11": c, "12": -s, "21": -s, "22": -c}
        found = pieces_of(solve(problem_of(forms(RR, term), ((-1.5, 1.5), None)), base=base))
        assert_allclose(
            sum(piece[0] for piece in found), 6 * pi - 4.5, rtol=1e-6
        )  # a kink is just missed


def two_squares(turn: float, base: int) -> bool:
    either = ({"11": np.cos(turn), "12": np.sin(turn)}, {"11": np.cos(turn), "21": np.sin(turn)})
    found = [solve(problem_of(forms(RR, term), ROUND), base=base) for term in either]
    shapes = [[(part.wraps, len(part.loops)) for part in one.components] for one in found]
    return shapes == [[((False, False), 1)] * 2] * 2 and {one.base for one in found} == {base}


PINCHED = {
    # 0 > tan(q2 / 2) > cos q1 - 1, and 0 > q2 > cos q1 - 1: closed at q1 = 0 alone.
    "two joints that turn": (RR, ROUND, {"00": -1, "01": 1, "02": -1, "12": 1}, quad(lambda q: 2 * np.arctan(1 - cos(q)), -pi, pi)[0]),
    "one that turns, one that slides": (RP, (None, (-5.0, 5.0)), {"01": -1, "02": -1, "11": 1}, TURN),
    # 0 > y > - x^2 / 2.
    "two that slide": (PP, ((-1.0, 1.0), (-3.0, 3.0)), {"02": -1, "21": -0.5}, 1 / 3),
}  # fmt: skip


@both_bases
@pytest.mark.parametrize("name", PINCHED)
def test_two_curves_that_touch_like_parabolas_pinch_what_lies_between(name, base) -> None:
    """The critical value is a fourfold root: eigenvalues find it to 1e-4, and off the circle."""
    kinds, ranges, term, area = PINCHED[name]
    count = 2 if kinds == PP else 1  # round a joint both ends of the piece meet in the pinch
    assert len(pieces(forms(kinds, term), ranges, base)) == count
    for seed in range(8, 28):
        meant = moved(forms(kinds, term), ranges, np.random.default_rng(seed))
        found = moved_pieces(meant, base)
        assert [piece[1] for piece in found] == [(False, False)] * count, seed
        assert_allclose(sum(piece[0] for piece in found), area * meant.part, rtol=1e-6)


SADDLES = [(gap, base) for base in (0, 1) for gap in (1e-2, 1e-3, 1e-6, 1e-16)]


@pytest.mark.parametrize(("gap", "base"), SADDLES)
def test_areas_beside_a_saddle_that_is_just_missed_are_exact(gap, base) -> None:
    """x^2 - y^2 > gap: from y to y the width nearly has a kink, and 48 nodes leave 1e-5."""
    region = solve(problem_of(forms(PP, {"20": 1, "02": -1, "00": -gap}), SQUARE), (0.9, 0), base)
    height = sqrt(1 - gap)
    exact = height - gap * asinh(height / sqrt(gap))
    assert len(region.components) == 2
    for component in region.components:
        assert component.area == pytest.approx(exact, rel=1e-12)
        assert moments(region.problem, component).area == pytest.approx(exact, rel=1e-12)


@both_bases
def test_a_curve_through_the_corner_where_both_angles_jump_is_like_any_other(base) -> None:
    """Seen a little turned it goes nowhere near pi, and has the same pieces, loops and arcs."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        one, two = rng.uniform(-3, 3, 2)
        through = -np.cos(pi - one) - np.cos(pi - two)
        shapes = [
            shape(wave(one + turn, two - 0.7 * turn, through), base) for turn in (0.0, 0.3, 0.8)
        ]
        assert shapes[0] == shapes[1] == shapes[2], (one, two)


def wave(one: float, two: float, level: float):
    """cos(q1 - one) + cos(q2 - two) + level."""
    term = {"10": np.cos(one), "20": np.sin(one), "01": np.cos(two), "02": np.sin(two)}
    return forms(RR, term | {"00": level})


def shape(stack, base: int) -> list[tuple[float, tuple[bool, bool], list[int]]]:
    """Of each component its area, whether it goes round, and the arcs of its loops."""
    region = solve(problem_of(stack, ROUND), (0.1, 0.2), base)
    return sorted((round(c.area, 7), c.wraps, sorted(map(len, c.loops))) for c in region.components)


@pytest.fixture(scope="module", params=[random_robot, drawn_robot])
def regions(request) -> list[Region]:
    """Regions of 80 robots over either joint."""
    return [
        solve(clearance_problem(robot), robot.home, base)
        for robot in map(request.param, range(80))
        for base in (0, 1)
    ]


def test_a_vertex_is_on_both_its_boundaries_to_rounding(regions) -> None:
    """To 1e-12 divided by the sine of the angle at which the two curves cross."""
    seen = 0
    for region in regions:
        problem = region.problem
        sizes = np.abs(problem.forms.coefficients).max(axis=(1, 2), initial=0)
        for vertex in (vertex for part in region.components for vertex in part.vertices):
            if not {*vertex.boundaries} <= {*problem.names}:
                continue
            rows = [problem.names.index(name) for name in vertex.boundaries]
            both, scale = problem.forms[rows], sizes[rows]
            slopes = both.gradient(vertex.q) / scale[:, None]
            steep = np.linalg.norm(slopes, axis=1)
            sine = abs(np.linalg.det(slopes)) / max(steep.prod(), 1e-300)
            if steep.min() > 1e-3 and sine > 1e-4:
                miss = np.linalg.solve(slopes, both(vertex.q) / scale)
                assert np.abs(miss).max() < 1e-12 / sine
                seen += 1
    assert seen > 50


def test_an_arc_starts_where_the_one_before_it_ends_at_a_fold_too(regions) -> None:
    """The two roots at a fold stop a square root of rounding short of each other."""
    for loop in (loop for region in regions for part in region.components for loop in part.loops):
        starts = np.array([arc.points[0] for arc in loop])
        ends = np.array([arc.points[-1] for arc in loop])
        gaps = starts - np.roll(ends, 1, axis=0)
        assert_allclose(gaps - TURN * np.round(gaps / TURN), 0, atol=1e-13)


@pytest.mark.parametrize("height", [0.3, 0.7, 0.9, 1.5])
def test_the_nearest_point_may_lie_beyond_the_box_of_the_drawn_points(height) -> None:
    """Straight above the top of an ellipse, which is no drawn point; a disc is 1e-4 farther."""
    top, radius = np.array([-1, 2]) / sqrt(3), 2 / sqrt(3)
    above = top[1] + height + sqrt((radius + height + 1e-4) ** 2 - top[0] ** 2)
    ellipse = {"00": -1, "20": 1, "11": 1, "02": 1}
    disc = {"00": above**2 - radius**2, "01": -2 * above, "20": 1, "02": 1}
    region = solve(problem_of(forms(PP, ellipse, disc), ((-4.0, 4.0), (-4.0, 8.0))), (3, 3))
    found = nearest_boundary(region, top + np.array([0, height]))
    assert found.boundary == "f0"
    assert found.distance == pytest.approx(height, abs=1e-12)
    assert_allclose(found.q, top, atol=1e-9)


@both_bases
def test_a_configuration_close_to_a_line_is_in_the_component_behind_it(base) -> None:
    """On the line an obstacle's corner is at the elbow, and the angle of its contact is any."""
    file = Path(__file__).parent / "once_wrong" / "bare-segments-in-line.toml"
    region = solve(clearance_problem(load_robot(file)), base=base)
    for off in 10.0 ** -np.arange(6, 15):
        q = [pi - off, -1.0]
        assert region.contains(q)
        assert region.component_of(q) is not None, off


@both_bases
@pytest.mark.parametrize(("constant", "reach"), [(0.3, 1.0), (0.3, 3.0), (0.5, 1.0), (-0.4, 3.0)])
def test_where_a_quadratic_is_affine_an_arc_is_on_the_root_that_stays(
    constant, reach, base
) -> None:
    """The other root of cos(q1) q2^2 + q2 + constant passes infinity where q1 is a right angle."""
    stack = forms(RP, {"12": 1, "01": 1, "00": constant})
    region = solve(problem_of(stack, (None, (-reach, reach))), base=base)
    assert region.base == base
    for arc in (arc for part in region.components for loop in part.loops for arc in loop):
        if arc.form is not None:
            q = np.concatenate([arc.points, arc.at(np.linspace(0, 1, 97))])
            assert_allclose(arc.form(q), 0, atol=1e-12)


BLANK = {
    # q1^2 (1 - q2) and a form that is zero there too: the resultant has a root five times
    "five at once": (
        PP,
        ((-2.0, 2.0), (-1.0, 3.0)),
        {"00": 1, "01": -2, "02": 1, "10": 2, "12": -1, "20": -1, "21": -1, "22": -2},
        {"20": 1, "21": -1},
    ),
    # sin(q1) (cos(q2) - 1) has a double root all along, so no fold, and vanishes at q1 = 0; so does
    # 2 - 2 cos(q1), which is negative nowhere
    "double all along": (RR, ((-pi, pi), (-pi, pi)), {"20": -1, "21": 1}, {"00": 2, "10": -2}),
    # 2 q1 (1 + 2 q1) (1 + q2), and the same less 1e-12: this leaves the range 1e-13 beside a fibre
    # on which both all but vanish
    "all but blank": (PP, ((-1.0, 3.0), (-1.0, 3.0)), {"10": 2, "11": 2, "20": 4, "21": 4}, {"00": -1e-12, "10": 2, "11": 2, "20": 4, "21": 4}),
    # the same of (cos(q1) + 0.25 sin(q1) - 0.25) (sin(q2) - 0.25)
    "all but blank, of angles": (
        RR,
        ((-1.0, 2.0), (-0.5, 3.0)),
        {"00": 0.0625, "02": -0.25, "10": -0.25, "12": 1, "20": -0.0625, "22": 0.25},
        {"00": 0.0625 - 1e-12, "02": -0.25, "10": -0.25, "12": 1, "20": -0.0625, "22": 0.25},
    ),
}  # fmt: skip


@both_bases
@pytest.mark.parametrize("name", BLANK)
def test_forms_that_vanish_on_a_fibre_or_many_times_have_their_region(name, base) -> None:
    kinds, ranges, *terms = BLANK[name]
    problem = problem_of(forms(kinds, *terms), ranges)
    region = solve(problem, base=base)
    assert region.base == base
    assert not region.unresolved
    for arc in (arc for part in region.components for loop in part.loops for arc in loop):
        if arc.form is not None:
            assert_allclose(arc.form(arc.at(np.linspace(0, 1, 97))), 0, atol=1e-9)
    low, high = np.array(ranges).T
    q = np.random.default_rng(5).uniform(low, high, (200_000, 2))
    drawn = region.contains(q).mean() * np.prod(high - low)
    assert_allclose(region.area, drawn, rtol=0.02)


@both_bases
def test_an_arc_keeps_near_its_end_where_its_form_vanishes_on_the_fibre(base) -> None:
    """To the last digit of the base value; what the form says there is rounding."""
    file = Path(__file__).parent / "once_wrong" / "bare-segments-in-line.toml"
    region = solve(clearance_problem(load_robot(file)), base=base)
    steps = 10.0 ** -np.arange(3, 16)
    for arc in (arc for part in region.components for loop in part.loops for arc in loop):
        assert_allclose(arc.at(steps), np.tile(arc.start, (13, 1)), rtol=0, atol=0.02)
        assert_allclose(arc.at(1 - steps), np.tile(arc.end, (13, 1)), rtol=0, atol=0.02)
