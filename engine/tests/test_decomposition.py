"""Forms and cells, without a robot: an edge table, lines, roots in order, and what is exact."""

from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest
from flint import arb, ctx, fmpq, fmpq_poly
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from cspace import load_robot
from cspace.region import clearance_problem, solve
from cspace.region.algebra import lift_roots
from cspace.region.cells import Cells, find_cells
from cspace.region.events import roots_at
from cspace.region.exact import Exact
from cspace.region.kinds import CROSS, FOLD, LIMIT, clusters
from cspace.region.scene import Scene, is_varied, scene_of
from engine_support import body_scenes
from engine_support.forms import BOTH, EDGES, PP, PR, ROUND, RP, RR, SQUARE, TORUS, TURN, forms
from engine_support.regions import exactly, pieces, problem_of
from qbound.forms import HarmonicForm, Kind

BITS = 1280
"""Of what is no rational."""


# --- edge table ----------------------------------------------------------------------------------


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("name", EDGES)
def test_edge_cases_have_the_right_pieces(name, base):
    kinds, ranges, terms, expected = EDGES[name]
    found = pieces(forms(kinds, *terms), ranges, base)
    assert [piece[1:] for piece in found] == [piece[1:] for piece in expected]
    assert_allclose([piece[0] for piece in found], [p[0] for p in expected], rtol=1e-8)


@pytest.mark.parametrize("base", [0, 1])
def test_touching_in_a_point_does_not_cut_the_torus(base):
    # 2 - cos q1 - cos q2 is zero at the origin alone: the closure is the whole torus.
    (piece,) = pieces(forms(RR, {"00": 2, "10": -1, "01": -1}), ROUND, base)
    assert_allclose(piece[0], TORUS, rtol=1e-9)
    assert piece[1] == BOTH


@pytest.mark.parametrize("base", [0, 1])
def test_a_parabola_that_touches_a_line_pinches_what_lies_between(base):
    """x^2 > y > 0 is closed at x = 0 alone, where two curves touch that do not cross."""
    found = pieces(forms(PP, {"20": 1, "01": -1}, {"01": 1}), SQUARE, base)
    assert [piece[1:] for piece in found] == [((False, False), 1)] * 2
    assert_allclose([piece[0] for piece in found], 1 / 3, rtol=1e-9)


# --- lines and roots ------------------------------------------------------------------------------


def random_cells(seed: int, base: int, kinds: tuple[Kind, Kind]) -> Cells:
    rng = np.random.default_rng(seed)
    table = rng.normal(size=(rng.integers(1, 5), 3, 3))
    table *= rng.random(table.shape) < 0.7  # some functions missing
    sides = [None if k == "revolute" and rng.random() < 0.5 else (-1.5, 2.0) for k in kinds]
    return find_cells(scene_of(problem_of(HarmonicForm(table, kinds), tuple(sides)), base))


def order_of_roots(scene: Scene, t: float) -> list[tuple[int, int]]:
    """Form and slope of every root within the range, ascending, by sampling alone."""
    v = np.linspace(*scene.ends[1], 6001)
    values = scene.products(np.full(len(v), t), v) @ scene.table.reshape(-1, 9).T
    change = np.diff(np.sign(values), axis=0)
    where, form = np.nonzero(change)
    return [(int(m), int(np.sign(change[k, m]))) for k, m in zip(where, form, strict=True)]


def rotated(order: list) -> list:
    """One of all rotations, so that a root that passes the cut of the circle does not count."""
    return min((order[k:] + order[:k] for k in range(len(order))), default=order)


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.sampled_from([0, 1]), st.sampled_from([RR, RP, PR, PP]))
def test_the_order_of_roots_is_the_same_all_over_a_slab(seed, base, kinds):
    cells = random_cells(seed, base, kinds)
    scene, t = cells.scene, cells.lines.t
    tidy = rotated if scene.round[1] else list
    for slab in {k for a, b in cells.gaps.span.tolist() for k in range(a, b + 1)}:
        start, end = t[slab : slab + 2]
        if end - start > 0.02:
            places = start + (end - start) * np.array([0.2, 0.5, 0.8])
            first, *others = [tidy(order_of_roots(scene, t)) for t in places]
            assert all(order == first for order in others)


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize(
    ("terms", "expected"),
    [
        ([{"00": 1.5, "10": -1, "01": -1}], [-pi / 3, pi / 3]),  # folds of the disc
        ([{"10": 1, "01": 1}, {"10": 1, "01": -1}], [-pi / 2, pi / 2]),  # crossings
    ],
)
def test_lines_hold_folds_and_crossings(terms, expected, base):
    lines = find_cells(scene_of(problem_of(forms(RR, *terms), ROUND), base)).lines.t
    for value in expected:
        off = lines - value
        assert np.abs(off - TURN * np.round(off / TURN)).min() < 1e-12


def test_intervals_that_reach_over_their_neighbours_are_one_cluster_of_a_group():
    """The first and the last overlap, but neither overlaps the neighbour of the other."""
    middle, error = np.array([0.0, 0.5, 1.5, 2.0]), np.array([1.2, 0.0, 0.0, 1.2])
    low, high = middle - error, middle + error
    assert clusters(low, high).tolist() == [True, False, False, False]
    assert clusters(low, high, np.array([0, 0, 1, 1])).tolist() == [True, False, True, False]
    assert clusters(np.array([0.0, 2.0]), np.array([1.0, 3.0])).tolist() == [True, True]
    assert clusters(np.array([0.0, 1.0]), np.array([1.0, 3.0])).tolist() == [True, False]
    assert clusters(np.zeros(0), np.zeros(0)).tolist() == []


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_the_rising_root_of_a_slide_comes_first_where_the_linear_term_is_a_zero_with_a_sign(zero):
    c = np.array([[-1.0], [zero], [4.0]])
    assert lift_roots(False, c, np.zeros(1, dtype=bool)).ravel().tolist() == [0.5, -0.5]


@settings(max_examples=40)
@given(st.integers(0, 10**6), st.sampled_from([0, 1]), st.sampled_from([RR, RP, PR, PP]))
def test_roots_are_zeros_of_their_forms_within_their_errors(seed, base, kinds):
    """Balls say where the true roots are, and that the form vanishes there."""
    cells = random_cells(seed, base, kinds)
    scene, exact = cells.scene, cells.exact
    places = np.linspace(*scene.ends[0], 9)
    for curve in np.flatnonzero(scene.lifted).tolist():
        found = roots_at(scene, np.full(9, curve), places)
        for k in np.flatnonzero((found.rest > found.doubt) | scene.affine[curve]):
            with ctx.workprec(256):
                t = arb(float(places[k]))
                roots = [exact.root((curve, slope, 0), t) for slope in (1, -1)]
                assert scene.affine[curve] == (None in roots)
                for root, v in zip(roots, found.v[k], strict=True):
                    if root is not None:
                        assert exact.sign(exact.table(curve), t, root) == 0
                        if abs(v) <= 4:  # no root farther out is wanted
                            assert abs(root - float(v)) < float(found.error[k])


@pytest.mark.parametrize("slope", [0, 1])
def test_where_doubles_cannot_tell_two_roots_from_none_they_say_so(slope):
    """1 - cos(q2 - a) has a double root for every q1, in doubles two or none."""
    for a in np.linspace(0.1, 3.0, 40):
        touching = forms(RR, {"00": 1, "01": -np.cos(a), "02": -np.sin(a)})
        found = roots_at(scene_of(problem_of(touching, ROUND), 0), np.array([0]), np.zeros(1))
        assert abs(found.rest[0]) <= found.doubt[0]
        off = found.v[0, slope] - a
        assert abs(off - TURN * round(off / TURN)) <= found.error[0] < 1e-6


# --- exact numbers --------------------------------------------------------------------------------


def rational(text: str) -> fmpq:
    found = Fraction(text)
    return fmpq(found.numerator, found.denominator)


@pytest.mark.parametrize("seed", range(12))
def test_events_of_whole_numbers_have_all_their_zeros_once(seed):
    """The event's polynomial by fractions; its roots by factors."""
    rng = np.random.default_rng(seed)
    tables = rng.integers(-4, 5, (2, 3, 3))
    stack = HarmonicForm(tables.astype(float), PP)
    exact = Exact(scene_of(problem_of(stack, ((-2.0, 2.0), (-2.0, 2.0))), 0))
    a, b = ([fmpq_poly([int(x) for x in own[:, k]]) for k in range(3)] for own in tables)
    one, two, three = (a[i] * b[j] - a[j] * b[i] for i, j in ((2, 0), (0, 1), (1, 2)))
    for kind, i, j, polynomial in (
        (FOLD, 0, 0, a[1] * a[1] - 4 * a[0] * a[2]),
        (CROSS, 0, 1, one * one - three * two),
        (LIMIT, 1, 1, b[0] + 2 * b[1] + 4 * b[2]),
    ):
        roots = polynomial.numer().complex_roots() if polynomial else []
        real = sorted(float(z.real.mid()) for z, _ in roots if z.imag == 0)
        scale = exact.scene.scale[0]
        found = np.sort(exact.zeros(kind, i, j)["t"]) * scale
        assert_allclose(found, [t for t in real if -2 <= t <= 2], atol=1e-12)


def walls(*places, ends=SQUARE):
    """Forms a (x - b) of two slides with b rational, and what says them exactly."""
    exact = np.full((len(places), 3, 3), fmpq(0), dtype=object)
    exact[:, 1, 0] = [fmpq(a) for a, _ in places]
    exact[:, 0, 0] = [-fmpq(a) * b for a, b in places]
    near = np.array([int(x.p) / int(x.q) for x in exact.flat]).reshape(exact.shape)
    with ctx.workprec(BITS):
        off = [abs(arb(x) - arb(y)).upper() for x, y in zip(exact.flat, near.flat, strict=True)]
        sides = [tuple(map(arb, side)) for side in ends]
    errors = np.array([1.001 * float(x) for x in off]).reshape(exact.shape)
    return HarmonicForm(near, PP), (exact, sides, errors)


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("apart", ["1e-3", "1e-16", "1e-30", "1e-200"])
def test_a_strip_of_any_width_is_a_component_and_one_turned_inside_out_is_none(apart, base):
    a = rational("1/3")
    b = a + rational(apart)
    for low, high, count in ((a, b, 1), (b, a, 0), (a, a, 0)):
        stack, exact = walls((1, low), (-1, high))
        with exactly(*exact):
            region = solve(problem_of(stack, SQUARE), base=base)
            assert not region.unresolved
            assert len(region.components) == count, (apart, count)
            assert region.area == pytest.approx(2 * count * float(apart), rel=1e-6, abs=1e-15)


@pytest.mark.parametrize("base", [0, 1])
def test_a_wall_at_the_end_of_the_range_leaves_nothing_and_one_inside_a_strip(base):
    tiny = rational("1e-30")
    for step, count in ((fmpq(0), 0), (tiny, 0), (-tiny, 1)):
        stack, exact = walls((1, fmpq(1) + step))
        with exactly(*exact):
            assert len(solve(problem_of(stack, SQUARE), base=base).components) == count


@pytest.mark.parametrize("base", [0, 1])
def test_a_double_zero_parts_and_two_zeros_that_are_apart_leave_nothing_between(base):
    """(x - a) (x - b) > 0 is a rectangle on both sides; -(x - a)(x - b) > 0 one between."""
    a = rational("1/3")
    for apart in ("0", "1e-25", "1e-3"):
        b = a + rational(apart)
        exact = np.full((1, 3, 3), fmpq(0), dtype=object)
        exact[0, :, 0] = [a * b, -(a + b), fmpq(1)]
        near = np.array([int(x.p) / int(x.q) for x in exact.flat]).reshape(exact.shape)
        errors, ends = np.full(exact.shape, 1e-16), [(arb(-1), arb(1))] * 2
        for sign, count in ((1, 2), (-1, int(apart != "0"))):
            with exactly(sign * exact, ends, errors):
                region = solve(problem_of(HarmonicForm(sign * near, PP), SQUARE), base=base)
                assert not region.unresolved
                assert len(region.components) == count, (apart, sign)


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("name", ["minervabot-v2", "two-joint-arm-with-walls", "pp-portal"])
def test_doubles_of_a_scene_are_within_their_errors_of_the_exact_tables(name, base):
    """Forms and side conditions, base before lift."""
    scene = scene_of(clearance_problem(load_robot(name)), base)
    sides = is_varied(scene.sides)
    rows = [(f, None, scene.table[c], scene.eps[c]) for f, c in enumerate(scene.curve.tolist())]
    rows += [
        (f, s, scene.sides[f, s], scene.side_eps[f, s]) for f, s in np.argwhere(sides).tolist()
    ]
    for f, s, own, error in rows[:: max(1, len(rows) // 300)]:
        exact = np.array(scene.source.feature(f, s)).astype(float)
        largest = np.abs(exact).max()
        if largest:  # which may be off, too
            assert np.abs(own - exact / largest).max() <= 2 * error, (f, s)


# --- names of what coincides ----------------------------------------------------------------------


@pytest.mark.parametrize("base", [0, 1])
def test_forms_that_coincide_along_a_curve_are_one_arc_with_both_names(base):
    disc = {"00": -0.5, "10": 1, "01": 1}
    twice = {key: 700 * value for key, value in disc.items()}
    wall = {"00": 0.25, "01": 1}
    region = solve(problem_of(forms(RR, disc, twice, wall), (None, None)), base=base)
    (component,) = region.components
    both = frozenset([("f0", ""), ("f1", "")])
    assert names(region) == {both, frozenset([("f2", "")])}
    assert len(component.vertices) == 4


@pytest.mark.parametrize("seed", [12, 16])
def test_two_bodies_at_one_place_have_one_arc_with_both_names_over_either_joint(seed):
    """One obstacle stands twice: of each arc of the one the other is named, too."""
    robot = body_scenes.robot(body_scenes.scene(seed))
    one, other = robot.obstacles[0].name, "the same again"
    again = replace(robot.obstacles[0], name=other)
    robot = replace(robot, obstacles=(*robot.obstacles, again))
    over = [names(solve(clearance_problem(robot), base=base)) for base in (0, 1)]
    assert over[0] == over[1]
    twins = [own for own in over[0] if any(name.endswith(other) for name, _ in own)]
    assert twins
    for own in twins:
        features = {(name.replace(other, one), feature) for name, feature in own}
        assert features <= own


def names(region) -> set[frozenset[tuple[str, str]]]:
    """Boundaries and features of each arc, all those that coincide along it together."""
    arcs = (arc for part in region.components for loop in part.loops for arc in loop)
    return {frozenset([arc.label, *arc.also]) for arc in arcs}
