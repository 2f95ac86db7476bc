"""What doubles cannot decide: zeros of events, orders and signs in balls, and lines of the base."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx, fmpq, fmpq_poly
from numpy.testing import assert_allclose

from cspace import load_robot
from cspace.boundary.contacts import SIDES
from cspace.region import clearance_problem, solve
from cspace.region.cells import decompose
from cspace.region.events import NO_EVENTS, Events, Finder, find_lines
from cspace.region.plane import LEVELS, NUMBER, Plane, Precise, in_order, precision
from engine_support.forms import PP, RP, RR, SQUARE, forms
from engine_support.regions import problem_of
from engine_support.scenes import drawn_scene
from qbound.forms import HarmonicForm

EXACT = 1280
"""Bits of what is no rational."""


@dataclass(frozen=True, eq=False)
class Given:
    """Rows with coefficients that are no doubles; ranges are."""

    tables: np.ndarray
    ranges: Any

    def form(self, row: int) -> np.ndarray:
        return self.tables[row]

    def range(self, joint: int) -> Any:
        ends = self.ranges[joint]
        return ends and tuple(map(arb, ends))


def exactly(kinds, ranges, *terms, base: int = 0) -> Precise:
    """The plane of forms {"ij": exact coefficient}, its doubles the nearest."""
    tables = np.full((len(terms), 3, 3), fmpq(0), dtype=object)
    for own, term in zip(tables, terms, strict=True):
        for key, value in term.items():
            own[int(key[0]), int(key[1])] = value
    with ctx.workprec(EXACT):
        doubles = np.array([float(arb(x).mid()) for x in tables.flat]).reshape(tables.shape)
        off = [abs(arb(x) - arb(y)).upper() for x, y in zip(tables.flat, doubles.flat, strict=True)]
    errors = np.array([1.001 * float(x) for x in off]).reshape(tables.shape)
    plane = Plane(HarmonicForm(doubles, kinds), ranges, base, errors=errors)
    return Precise(plane, Given(tables, ranges))


def rational(text: str) -> fmpq:
    found = Fraction(text)
    return fmpq(found.numerator, found.denominator)


def through(a, b) -> dict[str, Any]:
    """The form (x - a)(x - b), exact."""
    return {"00": a * b, "10": -(a + b), "20": fmpq(1)}


def zeros_of(precise: Precise, event, bits: int = LEVELS[-1]) -> list[tuple[float, int]]:
    """Middles of the zeros of an event, and how many derivatives vanish there besides."""
    found = precise.zeros(event, *precise.plane.ends, bits)
    assert found is not None
    return [(float(zero.ball.mid()), zero.order) for zero in found]


# --- zeros of events ------------------------------------------------------------------------------


@pytest.mark.parametrize("apart", ["1e-3", "1e-16", "1e-25"])
def test_zeros_that_are_apart_stay_apart(apart):
    a = rational("1/3")
    b = a + rational(apart)
    precise = exactly(PP, SQUARE, through(a, b))
    found = precise.zeros((NUMBER["constant"], 0, 0), -1.0, 1.0, LEVELS[-1])
    assert [zero.order for zero in found] == [0, 0]
    for zero, true in zip(found, (a, b), strict=True):
        with precision(EXACT):
            ball = precise.refined(zero, LEVELS[-1])
            assert ball.contains(true)
            assert ball.rad() < arb("1e-250")


def test_a_double_zero_is_one():
    a = rational("1/3")
    precise = exactly(PP, SQUARE, through(a, a))
    ((t, order),) = zeros_of(precise, (NUMBER["constant"], 0, 0))
    assert t == pytest.approx(1 / 3, abs=1e-16)
    assert order == 1


@pytest.mark.parametrize("half", ["0.4", "1e-8", "1e-16", "0"])
def test_zeros_on_a_circle(half):
    """cos(q - a) = cos d at a - d and a + d; with d = 0 at a, twice."""
    with ctx.workprec(EXACT):
        a, d = arb("0.7"), arb(half)
        term = {"00": -d.cos(), "10": a.cos(), "20": a.sin()}
    precise = exactly(RR, (None, None), term)
    found = precise.zeros((NUMBER["constant"], 0, 0), -np.pi, np.pi, LEVELS[-1])
    if half == "0":
        (zero,) = found
        assert zero.order == 1
        assert zero.ball.overlaps(a)
        return
    assert [zero.order for zero in found] == [0, 0]
    with precision(EXACT):
        for zero, true in zip(found, (a - d, a + d), strict=True):
            assert precise.refined(zero, 512).overlaps(true)
            assert not precise.refined(zero, 512).overlaps(2 * a - true)


@pytest.mark.parametrize("multiplicity", [2, 4])
def test_a_zero_of_a_resultant_has_its_multiplicity(multiplicity):
    """v^2 = p and v^2 = r share both roots where p = r: the resultant is (p - r)^2."""
    a, b = rational("1/3"), rational("1/3" if multiplicity == 4 else "-1/7")
    term = {key: -value for key, value in through(a, b).items()} | {"02": fmpq(1)}
    precise = exactly(PP, SQUARE, term, {"02": fmpq(1)})
    found = zeros_of(precise, (NUMBER["resultant line"], 0, 1))
    places = sorted({float(Fraction(int(x.p), int(x.q))) for x in (a, b)})
    assert [t for t, _ in found] == pytest.approx(places, abs=1e-15)
    assert [order for _, order in found] == [multiplicity - 1] * len(places)


@pytest.mark.parametrize("seed", range(12))
def test_events_of_whole_numbers_have_all_their_zeros_with_multiplicities(seed):
    """The event's polynomial by fractions; its roots and multiplicities by factors."""
    rng = np.random.default_rng(seed)
    tables = rng.integers(-4, 5, (2, 3, 3))
    terms = [{f"{i}{j}": fmpq(int(own[i, j])) for i, j in np.ndindex(3, 3)} for own in tables]
    precise = exactly(PP, ((-2.0, 2.0), (-2.0, 2.0)), *terms)
    a, b = ([fmpq_poly([int(x) for x in own[:, k]]) for k in range(3)] for own in tables)
    one, two, three = (a[i] * b[j] - a[j] * b[i] for i, j in ((2, 0), (0, 1), (1, 2)))
    for kind, rows, polynomial in (
        ("fold line", (0, 0), a[1] * a[1] - 4 * a[0] * a[2]),
        ("resultant line", (0, 1), one * one - three * two),
        ("upper end", (1, 1), b[0] + 2 * b[1] + 4 * b[2]),
    ):
        expected = real_roots(polynomial, -2, 2)
        assert precise.vanishes((NUMBER[kind], *rows)) == (expected is None)
        if expected is not None:
            found = zeros_of(precise, (NUMBER[kind], *rows))
            assert [order + 1 for _, order in found] == [m for _, m in expected]
            assert_allclose([t for t, _ in found], [t for t, _ in expected], atol=1e-12)


def real_roots(polynomial: fmpq_poly, low: float, high: float) -> list[tuple[float, int]] | None:
    """Real roots between two places and their multiplicities, ascending; None of zero."""
    whole = polynomial.numer()
    if whole == 0:
        return None
    every = whole.complex_roots()
    found = [(float(z.real.mid()), multiplicity) for z, multiplicity in every if z.imag == 0]
    return sorted(item for item in found if low <= item[0] <= high)


def test_an_event_that_is_zero_everywhere_has_no_zeros():
    a = rational("1/3")
    precise = exactly(PP, SQUARE, {"01": fmpq(1), "00": -a}, {"01": fmpq(3), "00": -3 * a})
    assert precise.vanishes((NUMBER["sine"], 0, 1))
    assert not precise.vanishes((NUMBER["first"], 0, 0))
    assert precise.zeros((NUMBER["sine"], 0, 1), -1.0, 1.0, LEVELS[0]) is None


# --- signs and orders -----------------------------------------------------------------------------


def test_a_sign_is_told_however_small_and_zero_is_zero():
    tiny = rational("1e-250")
    precise = exactly(PP, SQUARE, {"00": tiny - 1, "10": fmpq(1)}, {"00": fmpq(-1), "20": fmpq(1)})
    assert precise.sign(0, 1, 0.5) == 1
    assert precise.sign(0, lambda bits: 1 - 2 * arb(tiny), 0.5) == -1
    assert precise.sign(1, 1, 0.5) == 0


def test_numbers_are_put_in_order_and_those_that_are_one_are_together():
    numbers = {
        "two": lambda: arb(2),
        "the square of its root": lambda: arb(2).sqrt() ** 2,
        "a little more": lambda: arb(2) + arb("1e-280"),
        "a little less": lambda: arb(2) - arb("1e-20"),
        "one": lambda: arb(1),
    }
    found = in_order([*numbers], lambda name, bits: numbers[name]())
    own = [sorted(names) for _, names in found]
    assert own == [["one"], ["a little less"], ["the square of its root", "two"], ["a little more"]]
    assert all(ball.overlaps(numbers[names[0]]()) for ball, names in found)


def test_what_has_one_name_is_one_without_more_bits():
    asked = []

    def ball(item, bits):
        asked.append(bits)
        return arb(2).sqrt() if item < 2 else arb(3)

    found = in_order([0, 1, 2], ball, names=["root", "root", "three"])
    assert [own for _, own in found] == [[0, 1], [2]]
    assert set(asked) == {LEVELS[0]}


# --- lines ----------------------------------------------------------------------------------------


def walls(*places, kinds=PP, ranges=SQUARE) -> Precise:
    """Forms x - place, or place - x for those that are given with a sign before."""
    return exactly(kinds, ranges, *({"10": s, "00": -s * place} for s, place in places))


def lines_of(precise: Precise):
    finder = Finder(precise.plane, precise)
    every = np.arange(precise.plane.count)
    events = finder.isolated(finder.events(finder.fixed(every)))[1]
    return find_lines(finder, events)


def test_events_at_one_place_are_one_line():
    a = rational("1/3")
    lines = lines_of(walls((fmpq(1), a), (fmpq(-7), a), (fmpq(1), rational("1/2"))))
    assert_allclose(lines.t, [-1, 1 / 3, 1 / 2, 1], atol=1e-15)
    assert [sorted(lines.events.what[own, 1].tolist()) for own in lines.members] == [
        [],
        [0, 1],
        [2],
        [],
    ]


@pytest.mark.parametrize("apart", ["1e-16", "1e-40", "1e-200"])
def test_events_apart_are_two_lines_in_their_order(apart):
    a = rational("1/3")
    lines = lines_of(walls((fmpq(1), a + rational(apart)), (fmpq(1), a)))
    assert [lines.events.what[own, 1].tolist() for own in lines.members] == [[], [1], [0], []]
    assert (np.diff(lines.t) >= 0).all()
    with precision(LEVELS[-1]):
        gap = lines.ball(2, LEVELS[-1]) - lines.ball(1, LEVELS[-1])
        assert gap.overlaps(arb(rational(apart)))
        assert gap > 0


def test_a_strip_of_any_width_is_a_cell_and_one_turned_inside_out_is_none():
    a = rational("1/3")
    for apart in ("1e-3", "1e-30", "1e-200"):
        b = a + rational(apart)
        assert len(decompose(walls((fmpq(1), a), (fmpq(-1), b))).slabs) == 1, apart
        assert len(decompose(walls((fmpq(1), b), (fmpq(-1), a))).slabs) == 0, apart
    assert len(decompose(walls((fmpq(1), a), (fmpq(-1), a))).slabs) == 0


def test_an_event_at_the_end_of_the_range_is_on_it_and_one_beyond_is_none():
    tiny = rational("1e-30")
    on, inside, beyond = (
        lines_of(walls((fmpq(1), fmpq(1) + step))) for step in (fmpq(0), -tiny, tiny)
    )
    assert [len(own) for own in on.members] == [0, 1]
    assert [len(own) for own in inside.members] == [0, 1, 0]
    assert [len(own) for own in beyond.members] == [0, 0]
    assert beyond.of.tolist() == [-1]


def test_events_at_the_cut_of_a_circle_are_one_line_from_either_side():
    """1 + cos q has a double zero at the cut: the first line, and the last, a turn on."""
    precise = exactly(RP, (None, (-1.0, 1.0)), {"00": fmpq(1), "10": fmpq(1)})
    lines = lines_of(precise)
    assert lines.t.tolist() == [-np.pi, np.pi]
    assert lines.members[0] == lines.members[1] != []


def test_without_events_the_ends_are_the_lines():
    precise = exactly(PP, SQUARE, {"00": fmpq(1)})
    lines = find_lines(Finder(precise.plane, precise), NO_EVENTS)
    assert lines.t.tolist() == [-1.0, 1.0]
    assert lines.members == [[], []]
    assert isinstance(lines.events, Events)


# --- exact tables ---------------------------------------------------------------------------------


@pytest.mark.parametrize("base", [0, 1])
@pytest.mark.parametrize("name", ["minervabot-v2", "two-joint-arm-with-walls", "pp-portal"])
def test_doubles_of_a_plane_are_within_their_errors_of_the_exact_tables(name, base):
    """Every row: forms, features, side conditions, base before lift."""
    precise = Precise.of(clearance_problem(load_robot(name)), base)
    plane, contacts = precise.plane, precise.plane.contacts
    rows = [*plane.scaled, *(side for own in plane.sides for side in own)]
    errors = np.concatenate([plane.eps, plane.side_eps.ravel()])
    given = [True] * precise.features + (contacts.keys >= 0).ravel().tolist()
    assert len(rows) == precise.features + SIDES * len(contacts.forms)
    for row in np.flatnonzero(given)[:: max(1, sum(given) // 300)].tolist():
        exact = np.array(precise.table(row, LEVELS[0])).astype(float) * plane.powers
        largest = np.abs(exact).max()
        if largest:
            off = np.abs(rows[row] - exact / largest).max()
            assert off <= 2 * errors[row], row  # the largest coefficient may be off, too


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


@pytest.mark.parametrize("seed", [37, 46])
def test_two_bodies_at_one_place_have_one_arc_with_both_names_over_either_joint(seed):
    """One obstacle stands twice: of each arc of the one the other is named, too."""
    robot = drawn_scene(seed)
    one, other = robot.obstacles[0].name, "the same again"
    assert robot.obstacles[-1].name == other
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
