"""Boundary functions: eq. (29) derived, Theorem 1 for any chain, clearance, closest approach."""

from dataclasses import replace
from math import degrees, pi

import numpy as np
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import minimize_scalar

from cspace import clearance, load_robot
from cspace.boundary.functions import moving_joints
from cspace.model.robot import HalfSpace, Pair, Point
from cspace.model.robotfile import parse_robot
from engine_support.oracles import (
    ANGLES,
    VECTORS,
    equation_29,
    frame_matrix,
    in_unit,
    packaged_table,
    point_seen_from,
    robot_tables,
    row_of,
)
from lizarraga2025 import printed as paper
from qbound.boundary import (
    closest_approach,
    components,
    half_space_vector,
    observer,
    pair_vector,
    position,
    squared_distance,
)
from qbound.symbols import joint_symbols, with_symbols

MINERVA = load_robot("minervabot-v2")
COMPONENTS = list(paper.EQUATION_29)


def indices(label: str) -> tuple[str, int]:
    """beta_{i,j} -> name of boundary i, position of component j."""
    i, j = label[6:-1].split(",")
    return f"B{i}", int(j) - 1


def values(data: st.DataObject, table: dict) -> np.ndarray:
    n = len(table["joint"])
    return np.array(data.draw(st.lists(ANGLES, min_size=n, max_size=n)))


# --- eq. (29) ------------------------------------------------------------------------------------


@pytest.mark.parametrize("label", COMPONENTS)
def test_derived_component_is_the_printed_one_expanded_by_hand(label) -> None:
    """Eq. (29) at 5000 random configurations of three turns."""
    name, j = indices(label)
    q = np.random.default_rng(29).uniform(-3 * pi, 3 * pi, (5000, 2))
    derived = components(MINERVA, MINERVA.boundary(name))(q)[:, j]
    assert_allclose(derived, equation_29(*q.T)[label], atol=1e-12)


@pytest.mark.parametrize("label", COMPONENTS)
def test_derived_component_is_the_printed_formula_by_identity(label) -> None:
    """Eq. (29) with every offset a symbol: the difference simplifies to 0."""
    robot = with_symbols(MINERVA)
    name, j = indices(label)
    derived = components(robot, robot.boundary(name)).symbolic(joint_symbols(robot))[j]
    printed = paper.expression(paper.EQUATION_29[label])
    assert sympy.expand(sympy.expand_trig(derived - printed)) == 0


def test_components_not_printed_are_zero() -> None:
    """Of 21 components of seven boundaries, 11 are printed; the others vanish identically."""
    printed = {indices(label) for label in COMPONENTS}
    for boundary in MINERVA.boundaries:
        for j in set(range(3)) - {j for name, j in printed if name == boundary.name}:
            assert not components(MINERVA, boundary)[j].coefficients.any()


# --- positions and distances of any chain --------------------------------------------------------


@given(robot_tables(), st.data())
def test_position_is_forward_kinematics_seen_from_any_frame_that_carries_it(table, data) -> None:
    """Table 2, eqs. (20), (21): prismatic joints and mounts too."""
    robot, q = parse_robot(table), values(data, table)
    n = len(table["joint"])
    point = data.draw(st.integers(0, n))
    frame = data.draw(st.integers(0, point))
    seen = point_seen_from(table, f"p{point}", str(frame), q)
    assert_allclose(position(robot, f"p{point}", str(frame))(q), seen, atol=1e-10)


@given(robot_tables(), VECTORS, st.data())
def test_squared_distance_is_the_square_of_the_distance(table, centre, data) -> None:
    """A form without products such as cos^2 is the whole of it, at every configuration."""
    robot = parse_robot(table)
    n = len(table["joint"])
    frame = data.draw(st.integers(0, n))
    q = np.array([values(data, table) for _ in range(3)])
    form = squared_distance(robot, robot.tool, str(frame), centre)
    gaps = [point_seen_from(table, robot.tool, str(frame), x) - centre for x in q]
    assert_allclose(form(q), [gap @ gap for gap in gaps], rtol=1e-11, atol=1e-8)


@given(robot_tables())
def test_only_slides_have_squares(table) -> None:
    """A coordinate is at most affine in a slide; in its squared distance q^2 stands alone."""
    robot = parse_robot(table)
    for j, kind in enumerate(robot.kinds):
        if kind == "prismatic":
            coordinates = position(robot, robot.tool).coefficients
            assert not np.take(coordinates, 2, axis=j + 1).any()
            squares = np.take(squared_distance(robot, robot.tool).coefficients, 2, axis=j)
            assert squares.flat[0] == 1
            assert np.count_nonzero(squares) == 1


def test_an_observer_beyond_the_point_is_refused() -> None:
    for use in (position, squared_distance):
        with pytest.raises(ValueError, match="'2' does not precede '1'"):
            use(MINERVA, "7", "2")
        with pytest.raises(ValueError, match="'9' does not precede '1'; the frames are 0, 1, 2"):
            use(MINERVA, "7", "9")


# --- Theorem 1 -----------------------------------------------------------------------------------


def with_pair(table: dict, first: int, second: int, apart: float = 0.0) -> tuple:
    table["boundary"] = [
        {"name": "B1", "type": "pair", "points": [f"p{first}", f"p{second}"], "clearance": apart}
    ]
    robot = parse_robot(table)
    return robot, robot.boundary("B1")


@given(robot_tables(), st.data())
def test_theorem_1_holds_for_any_chain_and_either_order(table, data) -> None:
    """Eq. (16): B is r_{a+n,b+m} seen from frame a, turned by R_{0,a} it is eq. (25)."""
    n, q = len(table["joint"]), values(data, table)
    first, second = data.draw(st.permutations(range(n + 1)))[:2]
    robot, pair = with_pair(table, first, second, apart=1.0)
    seen_from = str(min(first, second))
    assert observer(robot, pair) == seen_from
    ends = [point_seen_from(table, f"p{i}", "0", q) for i in (first, second)]
    turned = frame_matrix(table, seen_from, q)[:3, :3] @ pair_vector(robot, pair)(q)
    assert_allclose(turned, ends[1] - ends[0], atol=1e-10)


@given(robot_tables(st.integers(2, 4)), st.data())
def test_the_label_of_eqs_15_and_25_is_two_vectors_of_one_length(table, data) -> None:
    """E-15: seen from a and seen from the base; |B| does not care, so (14) is unharmed."""
    robot, pair = with_pair(table, 1, 2, apart=1.0)
    q = values(data, table)
    seen_from_a = pair_vector(robot, pair)(q)
    frames = robot.frames(q)
    seen_from_base = frames.position("p1", "p2", "0")
    assert_allclose(frames.position("p1", "p2", "1"), seen_from_a, atol=1e-10)
    assert_allclose(np.linalg.norm(seen_from_base), np.linalg.norm(seen_from_a), atol=1e-10)


@given(robot_tables(), st.data())
def test_converse_of_theorem_1(table, data) -> None:
    """Points brought together have B = 0; moved apart by any vector, |B| is its length."""
    n, q = len(table["joint"]), values(data, table)
    last = table["point"][n]
    met = np.linalg.inv(frame_matrix(table, last["frame"], q)) @ [*table["point"][0]["at"], 1.0]
    shift = np.array(data.draw(VECTORS))
    last["at"] = [float(x) for x in met[:3] + shift]
    robot, pair = with_pair(table, 0, n, apart=1.0)
    assert_allclose(np.linalg.norm(pair_vector(robot, pair)(q)), np.linalg.norm(shift), atol=1e-9)


@pytest.mark.parametrize("order", [["10", "11"], ["11", "10"]])
def test_order_of_a_pair_is_the_sign_of_b_and_nothing_else(order) -> None:
    """From the first point named to the second, always seen from frame 1."""
    table = packaged_table()
    row_of(table, "boundary", "B3")["points"] = order
    robot = parse_robot(table)
    pair, q = robot.boundary("B3"), [0.3, -0.8]
    sign = 1 if order == ["10", "11"] else -1
    hand = equation_29(*q)
    expected = sign * np.array([hand["beta_{3,1}"], 0, hand["beta_{3,3}"]])
    assert_allclose(pair_vector(robot, pair)(q), expected, atol=1e-13)
    assert observer(robot, pair) == "1"
    same = clearance(MINERVA, MINERVA.boundary("B3"))
    assert_allclose(clearance(robot, pair).coefficients, same.coefficients, atol=1e-12)


def test_points_of_one_frame_keep_their_distance() -> None:
    table = packaged_table()
    row_of(table, "boundary", "B1")["points"] = ["7", "9"]
    robot = parse_robot(table)
    form = clearance(robot, robot.boundary("B1"))
    assert form.joints() == ()
    assert form([1.0, 2.0]) == pytest.approx(13**2 + 7.5**2 - 0.1**2)


# --- clearance, eqs. (9), (11), (12) -------------------------------------------------------------


@given(robot_tables(), st.floats(0, 30), st.floats(0, 5), st.floats(0, 5), st.data())
def test_clearance_of_a_pair_is_positive_exactly_where_it_keeps_apart(
    table, apart, one, other, data
) -> None:
    """Eq. (11): |B|^2 - d_min^2 with d_min both radii and the clearance."""
    n, q = len(table["joint"]), values(data, table)
    table["point"][0]["radius"], table["point"][n]["radius"] = one, other
    assume(apart + one + other > 0)
    robot, pair = with_pair(table, 0, n, apart)
    assert robot.required_distance(pair) == pytest.approx(apart + one + other)
    ends = [point_seen_from(table, f"p{i}", "0", q) for i in (0, n)]
    distance = np.linalg.norm(ends[1] - ends[0])
    expected = distance**2 - (apart + one + other) ** 2
    assert_allclose(clearance(robot, pair)(q), expected, rtol=1e-10, atol=1e-8)


@given(robot_tables(), st.data())
def test_clearance_of_a_half_space_is_the_depth_inside_it(table, data) -> None:
    """Eq. (12) for any normal: n . r - h - radius, a length."""
    n, q = len(table["joint"]), values(data, table)
    table["point"][n]["radius"] = 0.5
    wall = {"name": "W", "type": "half-space", "point": f"p{n}", "normal": [2, -3, 6], "offset": 4}
    table["boundary"] = [wall]
    robot = parse_robot(table)
    seen = point_seen_from(table, f"p{n}", "0", q)
    expected = np.array([2, -3, 6]) @ seen / 7 - 4.5
    assert_allclose(clearance(robot, robot.boundary("W"))(q), expected, atol=1e-10)


@given(robot_tables(), st.data())
def test_selection_by_a_normal_is_n_n_transposed(table, data) -> None:
    """Table 5's S for any unit normal: B = n (n . r - h)."""
    n, q = len(table["joint"]), values(data, table)
    wall = {"name": "W", "type": "half-space", "point": f"p{n}", "normal": [0, 3, -4], "offset": 2}
    table["boundary"] = [wall]
    robot = parse_robot(table)
    normal = np.array([0, 0.6, -0.8])
    depth = normal @ point_seen_from(table, f"p{n}", "0", q) - 2
    assert_allclose(half_space_vector(robot, robot.boundary("W"))(q), depth * normal, atol=1e-10)


@pytest.mark.parametrize(("unit", "scale"), [("mm", 10.0), ("m", 0.01)])
def test_units_of_length_scale_every_form(unit, scale) -> None:
    """Two units: the same file in mm and in m; lengths by the factor, clearances by its square."""
    robot = parse_robot(in_unit(packaged_table(), unit, scale))
    for old, new in zip(MINERVA.boundaries, robot.boundaries, strict=True):
        power = 2 if old.name < "B5" else 1
        expected = scale**power * clearance(MINERVA, old).coefficients
        assert_allclose(clearance(robot, new).coefficients, expected, atol=1e-12 * scale**power)


# --- closest approach ----------------------------------------------------------------------------


def approach(robot, pair) -> tuple[float, float]:
    found = closest_approach(robot, pair)
    return found.q, found.gap


# Least distance of the printed points (cm), to all digits that the print's 0.01 cm can carry.
CLOSEST = {"B1": 0.0043, "B2": 0.0003, "B3": 0.0012, "B4": 0.0802}


@pytest.mark.parametrize(("name", "expected"), CLOSEST.items())
def test_printed_points_never_quite_meet(name, expected) -> None:
    """Departure from the print: B_i = 0 (eq. 28) has no solution; found anew by minimizing."""
    q, distance = approach(MINERVA, MINERVA.boundary(name))
    assert distance == pytest.approx(expected, abs=5e-5)
    joint = 0 if name in ("B1", "B2") else 1

    def gap(x: float) -> float:
        hand = equation_29(x, x)
        return float(np.hypot(hand[f"beta_{{{name[1]},1}}"], hand[f"beta_{{{name[1]},3}}"]))

    found = minimize_scalar(gap, bracket=(q - 0.1, q + 0.1), options={"xtol": 1e-12})
    assert found.fun == pytest.approx(distance, abs=1e-12)
    assert found.x == pytest.approx(q, abs=1e-7)
    grid = np.linspace(-pi, pi, 100_001)
    assert np.sqrt(
        sum(v**2 for k, v in equation_29(grid, grid).items() if k[6] == name[1])
    ).min() > (distance - 1e-12)
    assert clearance(MINERVA, MINERVA.boundary(name)).joints() == (joint,)


def test_joint_values_of_closest_approach() -> None:
    """Degrees: near the bounds that the paper takes for contacts, B4 two degrees off."""
    found = [degrees(closest_approach(MINERVA, MINERVA.boundary(b)).q) for b in CLOSEST]
    assert_allclose(found, [76.25, -136.24, 44.41, -164.14], atol=0.005)


@pytest.mark.parametrize(
    ("name", "largest"), [("minervabot-v2-corrected", 0.0044), ("minervabot-v2-symmetric", 1e-14)]
)
def test_points_of_the_siblings_come_as_close_as_their_digits(name, largest) -> None:
    """Without the misprint every pair closes to the print's rounding; unrounded, all the way."""
    robot = load_robot(name)
    gaps = [closest_approach(robot, robot.boundary(b)).gap for b in CLOSEST]
    assert max(gaps) < largest


@given(robot_tables(st.just(1)))
def test_closest_approach_is_the_least_distance_of_any_turning_pair(table) -> None:
    assume(table["joint"][0]["type"] == "revolute")
    robot, pair = with_pair(table, 0, 1, apart=1.0)
    grid = np.linspace(-pi, pi, 721)[:, None]
    distances = np.linalg.norm(pair_vector(robot, pair)(grid), axis=1)
    assume(np.ptp(distances) > 1e-6)
    q, distance = approach(robot, pair)
    assert -pi <= q <= pi
    assert distance <= distances.min() + 1e-9
    assert distances.min() - distance < 0.01 * (np.ptp(distances) + 1)


def test_a_boundary_names_the_joints_that_move_it() -> None:
    expected = {"B1": (0,), "B2": (0,), "B3": (1,), "B4": (1,)} | dict.fromkeys(
        ["B5", "B6", "B7"], (0, 1)
    )
    assert {b.name: moving_joints(MINERVA, b) for b in MINERVA.boundaries} == expected
    slide = load_robot("pp-portal")
    assert {moving_joints(slide, b) for b in slide.boundaries} <= {(0,), (1,), (0, 1)}


@pytest.mark.parametrize("seed", range(20))
def test_what_turns_about_its_own_axis_moves_no_boundary(seed) -> None:
    """Rounding of an oblique axis is no motion: the numbers of the form are not exactly zero."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    joints = tuple(replace(joint, axis=axis) for joint in MINERVA.joints)
    inner, outer = Point("i", "1", 1.7 * axis), Point("o", "2", 3.3 * axis)
    robot = replace(MINERVA, joints=joints, points=(*MINERVA.points, inner, outer))
    assert moving_joints(robot, HalfSpace("w", "o", axis, 1.0)) == ()
    assert moving_joints(robot, Pair("p", ("6", "i"), 1.0)) == ()
    assert moving_joints(robot, Pair("p", ("7", "o"), 1.0)) == ()
    assert moving_joints(robot, Pair("p", ("6", "7"), 1.0)) == (0,)


def test_contact_is_met_when_the_offsets_close() -> None:
    """With point 6 put where point 7 passes, B_1 = 0 has a solution: rounding took it away."""
    table = packaged_table()
    at = point_seen_from(table, "7", "0", [1.3, 0.0])
    row_of(table, "point", "6")["at"] = at.tolist()
    robot = parse_robot(table)
    q, distance = approach(robot, robot.boundary("B1"))
    assert q == pytest.approx(1.3, abs=1e-9)
    assert distance < 1e-13
    assert_array_equal(clearance(robot, robot.boundary("B1"))([q, 0.0]) < 0, True)
