# ruff: noqa: E501  (one table, a case a line)
"""Proved regions: areas at 30 digits by other means, and proposals that are wrong in one thing."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest
from flint import arb
from numpy.testing import assert_allclose

from cspace import find_region, load_robot
from cspace.model.robotfile import parse_robot
from cspace.proofs import Unproved
from cspace.proofs.exact.numbers import precision
from cspace.proofs.exact.problem import ExactProblem, exact_problem, exact_robot
from cspace.proofs.exact.region import prove_region
from cspace.region import Problem, Region, solve
from engine_support import body_scenes
from engine_support.exact import stated
from engine_support.forms import EDGES, LIMITS
from engine_support.gate import UPPER, gate
from engine_support.robots import random_robot

MINERVA = load_robot("minervabot-v2")
EXACT = exact_robot("minervabot-v2")
CLEARANCE = exact_problem(EXACT)
REGION = find_region(MINERVA)
HOME = REGION.components[0]
PROVED = prove_region(CLEARANCE, REGION)


def near(ball: arb, value: mpmath.mpf, digits: int = 30) -> bool:
    with precision(200):
        return bool(abs(ball - arb(mpmath.nstr(value, 45))) < arb(10) ** -digits)


def in_doubles(exact: ExactProblem, ranges, home) -> Region:
    """The region of an exact problem, by doubles."""
    forms = type(exact.forms)(exact.forms.coefficients.astype(float), exact.kinds)
    return solve(Problem(forms, exact.names, ranges, LIMITS), np.array(home))


def test_the_area_under_a_cosine_is_known_to_30_digits():
    exact = stated(("revolute", "prismatic"), [{"01": -1, "10": 1}], ((0, 2), (-2, 2)))
    proved = prove_region(exact, in_doubles(exact, ((0.0, 2.0), (-2.0, 2.0)), [1.0, -1.0]))
    with mpmath.workdps(45):
        assert near(proved.area, 4 + mpmath.sin(2))


def test_areas_of_all_components_agree_with_the_float_engine():
    proved = prove_region(CLEARANCE, REGION)
    areas = [float(c.area) for c in proved.components]
    assert_allclose(areas, [c.area for c in REGION.components], rtol=1e-12)
    assert all(c.area.rad() < 1e-33 for c in proved.components)


def test_vertices_are_those_of_doubles_with_60_digits():
    for proved, component in zip(PROVED.components, REGION.components, strict=True):
        found = np.array([[float(x) for x in q] for q in proved.vertices])
        for vertex in component.vertices:
            off = (found - vertex.q + np.pi) % (2 * np.pi) - np.pi
            assert np.abs(off).max(axis=1).min() < 1e-11
        assert len(found) == len(component.vertices)
        assert all(x.rad() < 1e-60 for q in proved.vertices for x in q)


def test_vertices_of_the_paper_robot_are_zeros_by_hand_at_50_digits():
    """|r - r'| = 0.1 and the floor, from Tables 1 and 3-5, typed again and evaluated by mpmath."""

    def values(q1, q2):
        m, cos, sin = mpmath.mpf, mpmath.cos, mpmath.sin
        x1 = m("11.5") * cos(q1) + m("4.91") * sin(q1) - m("7.5")
        z1 = m("4.91") * cos(q1) - m("11.5") * sin(q1) + m("22.5") - m("12.5")
        x4 = m("9") * cos(q2) + m("5.25") * sin(q2) + 15 - m("4.83")
        z4 = m("5.25") * cos(q2) - m("9") * sin(q2) + m("25.98") - m("23.37")
        floor = m("22.5") - 15 * sin(q1) + m("25.98") * cos(q1) - 25 * sin(q1 + q2) - m("11.32")
        d2 = m("0.01")
        return {"B1": x1**2 + z1**2 - d2, "B4": x4**2 + z4**2 - d2, "B7": floor}

    seen = []
    with mpmath.workdps(60):
        for component in PROVED.components:
            outline = component.cells.outlines[component.number]
            for q, vertex in zip(component.vertices, outline.vertices, strict=True):
                there = values(*(mpmath.mpf(x.mid().str(55, radius=False)) for x in q))
                for name in {*vertex.boundaries} & {*there}:
                    assert abs(there[name]) < mpmath.mpf(10) ** -45
                    seen.append(name)
    assert {*seen} == {"B1", "B4", "B7"}


def test_a_vertex_of_other_boundaries_is_refused():
    cells = PROVED.components[0].cells
    one, other = HOME.vertices[:2]
    wrong = replace(one, boundaries=tuple({*other.boundaries} - {*one.boundaries}))
    for vertex in (wrong, replace(one, q=one.q + 1e-3)):
        with pytest.raises(Unproved, match="nothing that is proved is near"):
            cells.vertex(vertex)


@pytest.mark.parametrize("name", EDGES)
def test_edge_cases_have_the_area_and_the_loops_of_the_table(name):
    """Also where curves touch, coincide or cross themselves, and limits are wider than a turn."""
    kinds, ranges, terms, expected = EDGES[name]
    exact = stated(kinds, terms, ranges)
    proved = prove_region(exact, in_doubles(exact, ranges, [0.1, 0.2]))
    areas = sorted((float(c.area) for c in proved.components), reverse=True)
    assert_allclose(areas, [area for area, *_ in expected], rtol=1e-9)
    assert all(c.area.rad() <= 1e-30 * abs(c.area).mid() for c in proved.components)


@pytest.mark.parametrize("seed", range(300, 316))
def test_areas_of_random_robots_are_those_of_doubles(seed):
    robot = random_robot(seed)
    region = find_region(robot)
    proved = prove_region(exact_problem(exact_robot(robot)), region)
    assert len(proved.components) == len(region.components)
    for one, other in zip(proved.components, region.components, strict=True):
        assert_allclose(float(one.area), other.area, rtol=1e-10, atol=1e-12)
        outline = one.cells.outlines[one.number]
        for q, vertex in zip(one.vertices, outline.vertices, strict=True):
            assert_allclose([float(x) for x in q], vertex.q, atol=1e-9)


def changed(**fields) -> Region:
    """The region with the home component changed."""
    home, *others = REGION.components
    return replace(REGION, outlined=(replace(home, **fields), *others))


FAULTS = {
    "a component is missing": (replace(REGION, outlined=REGION.components[:-1]), "4 components are proposed, and there are 5"),
    "home is missing": (replace(REGION, outlined=REGION.components[1:]), "4 components"),
    "a component comes twice": (replace(REGION, outlined=(*REGION.components, HOME)), "6 components"),
    "one comes in place of another": (replace(REGION, outlined=(HOME, HOME, *REGION.components[2:])), "an area of 11.77"),
    "nothing is proposed": (replace(REGION, outlined=()), "0 components"),
    "a loop is missing": (changed(loops=()), "0 loops are proposed, and there are 1"),
    "a vertex is missing": (changed(vertices=HOME.vertices[1:]), "5 vertices are proposed, and there are 6"),
    "an area is off": (changed(area=HOME.area + 1e-3), "an area of 11.7809"),
    "it is said to go round": (changed(wraps=(True, False)), "round the joints"),
    "it is unresolved": (replace(REGION, unresolved=("why",)), "why"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_proposal_that_is_wrong_in_one_thing_is_not_proved(name):
    region, message = FAULTS[name]
    with pytest.raises(Unproved, match=message):
        prove_region(CLEARANCE, region)


def test_a_hole_that_is_not_proposed_is_found():
    disc = {"00": -0.25, "20": 1, "02": 1}
    exact = stated(("prismatic", "prismatic"), [disc], ((-1, 1), (-1, 1)))
    region = in_doubles(exact, ((-1.0, 1.0), (-1.0, 1.0)), [0.9, 0.9])
    assert near(prove_region(exact, region).area, 4 - mpmath.pi / 4, 14)
    (whole,) = region.components
    outer = max(whole.loops, key=lambda loop: max(np.abs(a.points).max() for a in loop))
    with pytest.raises(Unproved, match="1 loops are proposed, and there are 2"):
        prove_region(exact, replace(region, outlined=(replace(whole, loops=(outer,)),)))


@pytest.mark.parametrize("name", ["two-links-on-a-table", "two-joint-arm-with-walls"])
def test_areas_of_bodies_are_balls_too(name):
    region = find_region(load_robot(name))
    proved = prove_region(exact_problem(exact_robot(name)), region)
    for one, other in zip(proved.components, region.components, strict=True):
        assert_allclose(float(one.area), other.area, rtol=1e-9)
        assert one.area.rad() < 1e-30


# --- scenes, and what touches ---------------------------------------------------------------------


def loops(region: Region) -> list[tuple[int, tuple[bool, bool]]]:
    return [(len(c.loops), c.wraps) for c in region.components]


@pytest.mark.parametrize("obstacles", [1, 3, 10])
@pytest.mark.parametrize("kinds", ["RR", "RP", "PR", "PP"])
def test_components_amid_obstacles_are_those_of_exact_numbers(kinds, obstacles):
    """Links and obstacles of all shapes. Every plane has its turn."""
    plane = ("xy", "xz", "yz")[obstacles % 3]
    robot = parse_robot(body_scenes.ordinary(4, kinds, plane, obstacles))
    region = find_region(robot)
    proved = prove_region(exact_problem(exact_robot(robot)), region)
    assert [(part.loops, part.wraps) for part in proved.components] == loops(region)
    for part, component in zip(proved.components, region.components, strict=True):
        assert abs(float(part.area) - component.area) < 1e-9 * region.area


@pytest.mark.parametrize("seed", [13, 16, 32, 36])
def test_scenes_in_whole_numbers_are_those_of_exact_numbers(seed):
    """In 13 and 32 no distance is kept but for rounding, and bodies are cut."""
    robot = body_scenes.robot(body_scenes.scene(seed))
    region = find_region(robot)
    proved = prove_region(exact_problem(exact_robot(robot)), region)
    assert [(part.loops, part.wraps) for part in proved.components] == loops(region)


# --- bodies that nearly touch ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("top", "count"), [("2.30000001", 1), ("2.3000000000001", 1), ("2.3", 2), ("2.29999999", 2)]
)
def test_less_than_a_nanometre_decides_whether_a_gate_is_passed(top, count):
    """As wide as the disc it is no gate: what touches joins no components."""
    robot = parse_robot(gate("disc", UPPER.format(top)))
    assert (
        len(prove_region(exact_problem(exact_robot(robot)), find_region(robot)).components) == count
    )
