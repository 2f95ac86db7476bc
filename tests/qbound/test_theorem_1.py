"""Chains and boundary functions: eqs. (9)-(29), Tables 1-5, by 4 x 4 matrices and by SymPy."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from lizarraga2025 import printed
from qbound import (
    HalfSpace,
    Joint,
    Pair,
    Point,
    Robot,
    clearance,
    closest_approach,
    components,
    keeps_clear,
    load_robot,
    margins,
    pair_vector,
    position,
)
from qbound.boundary import observer, squared_distance
from qbound.robot import Outline
from qbound.symbols import joint_symbols, offset_values, with_symbols, with_values
from support.chains import VECTORS, configurations, pose, position_of, robots

ROBOT = load_robot("minervabot-v2")


# --- chains


@given(robots(), st.data())
def test_forward_kinematics_are_a_product_of_matrices(robot, data):
    q = data.draw(configurations(robot))
    frames = robot.frames(q)
    for joint in robot.joints:
        expected = pose(robot, joint.frame, q)
        assert_allclose(frames.frame("0", joint.frame), expected[:3], atol=1e-11)
    for point in robot.points:
        expected = position_of(robot, point.name, q)
        assert_allclose(frames.position("0", point.name, "0"), expected, atol=1e-11)


@given(robots(), st.data())
def test_position_forms_are_forward_kinematics_seen_from_any_frame(robot, data):
    q = data.draw(configurations(robot, many=True))
    for observed in range(len(robot.joints)):
        found = position(robot, robot.tool, str(observed))(q)
        for row, one in zip(found, q, strict=True):
            inverse = np.linalg.inv(pose(robot, str(observed), one))
            expected = (inverse @ [*position_of(robot, robot.tool, one), 1])[:3]
            assert_allclose(row, expected, atol=1e-10)


@given(robots(), VECTORS, st.data())
def test_squared_distance_is_the_square_of_the_distance(robot, centre, data):
    q = data.draw(configurations(robot))
    apart = np.linalg.norm(position_of(robot, robot.tool, q) - centre)
    found = squared_distance(robot, robot.tool, "0", centre)
    assert_allclose(found(q), apart**2, atol=1e-9)


def test_direct_kinematics_are_table_2():
    robot = with_symbols(ROBOT)
    frames = robot.frames(np.array(joint_symbols(robot), dtype=object))
    q1, q2 = joint_symbols(robot)
    x12, z01, z12 = (sp.Symbol(n, real=True) for n in ("x_{1,2}", "z_{0,1}", "z_{1,2}"))

    def about_y(q):
        return sp.Matrix([[sp.cos(q), 0, sp.sin(q)], [0, 1, 0], [-sp.sin(q), 0, sp.cos(q)]])

    assert sp.Matrix(frames.rotation("0", "1")) == about_y(q1)
    assert sp.simplify(sp.Matrix(frames.rotation("0", "2")) - about_y(q1 + q2)) == sp.zeros(3, 3)
    r02 = sp.Matrix([0, 0, z01]) + about_y(q1) * sp.Matrix([x12, 0, z12])
    assert sp.expand(sp.Matrix(frames.position("0", "2", "0")) - r02) == sp.zeros(3, 1)


def test_names_are_looked_up():
    assert ROBOT.point("2").frame == "2"  # a frame's origin is a point too
    assert [motion.frame for motion in ROBOT.chain("2")] == ["2", "1"]
    with pytest.raises(ValueError, match="no point '99'; there are 3, 6"):
        ROBOT.point("99")
    with pytest.raises(ValueError, match="'2' does not precede '1'"):
        position(ROBOT, "7", "2")
    with pytest.raises(ValueError, match="no boundary 'B9'"):
        ROBOT.boundary("B9")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"home": (0.0,)}, "home must be 2 finite joint values"),
        ({"home": (0.0, np.nan)}, "home must be 2 finite"),
        ({"tool": "hand"}, "tool: no point or frame 'hand'"),
        ({"joints": ()}, "has no joint"),
        ({"points": (*ROBOT.points, Point("x", "9", [0, 0, 0]))}, "point x: no point or frame '9'"),
        ({"points": (*ROBOT.points, ROBOT.points[0])}, "'3' is used twice"),
        ({"boundaries": (Pair("B1", ("6", "0b")),)}, "boundary B1: no point or frame '0b'"),
        ({"boundaries": (Pair("q1", ("6", "7")),)}, "'q1' is used twice"),
        ({"outlines": (Outline("5", np.zeros((3, 3))),)}, "body: no point or frame '5'"),
    ],
)
def test_a_robot_with_wrong_names_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        replace(ROBOT, **change)


def test_wrong_vectors_and_joints_are_refused():
    with pytest.raises(ValueError, match="point x: at must be three finite numbers"):
        Point("x", "1", [0, np.inf, 0])
    with pytest.raises(ValueError, match="joint q: axis must be a direction"):
        Joint("q", "0", "1", [0, 0, 0], [0, 0, 0])
    with pytest.raises(ValueError, match=r"limits .* do not ascend"):
        Joint("q", "0", "1", [0, 0, 0], [0, 1, 0], limits=(1.0, 0.0))
    for limits in ((0.0, 1.0, 2.0), 1.0, (0.0, np.nan)):
        with pytest.raises(ValueError, match=r"joint q: limits .* do not ascend"):
            Joint("q", "0", "1", [0, 0, 0], [0, 1, 0], limits=limits)
    with pytest.raises(ValueError, match="boundary B8: points must be two names: '10'"):
        Pair("B8", "10", "14")
    for distance in (-0.1, np.nan, np.inf):
        with pytest.raises(ValueError, match="boundary B8: clearance must not be negative"):
            Pair("B8", ("10", "14"), distance)
    with pytest.raises(ValueError, match="boundary B8: offset must be finite: nan"):
        HalfSpace("B8", "3", [0, 0, 1], np.nan)
    with pytest.raises(ValueError, match="kind 'fixed'"):
        Joint("q", "0", "1", [0, 0, 0], [0, 1, 0], kind="fixed")
    joints = tuple(Joint("q", p, f, [0, 0, 0], [0, 1, 0]) for p, f in (("0", "1"), ("9", "2")))
    with pytest.raises(ValueError, match="joint q: no frame '9' before it"):
        Robot("r", "m", joints, (), (), "1", (0.0, 0.0))


# --- Theorem 1


@given(robots(), st.data())
def test_theorem_1_holds_for_any_chain_and_either_order(robot, data):
    q = data.draw(configurations(robot))
    for pair in (robot.boundary("B1"), robot.boundary("B2")):
        one, other = (position_of(robot, name, q) for name in pair.points)
        inverse = pose(robot, observer(robot, pair), q)[:3, :3].T
        assert_allclose(pair_vector(robot, pair)(q), inverse @ (other - one), atol=1e-10)
        expected = (other - one) @ (other - one) - pair.clearance**2
        assert_allclose(clearance(robot, pair)(q), expected, atol=1e-9)
        apart = np.linalg.norm(other - one) - pair.clearance
        assert_allclose(margins(robot, q)[pair.name], apart, atol=1e-6)


@given(robots(), st.data())
def test_a_half_space_has_its_height(robot, data):
    q = data.draw(configurations(robot))
    half_space = robot.boundary("B3")
    height = half_space.normal @ position_of(robot, half_space.point, q) - half_space.offset
    assert_allclose(clearance(robot, half_space)(q), height, atol=1e-10)
    assert_allclose(components(robot, half_space)(q), height * half_space.normal, atol=1e-10)


def test_every_component_of_equation_29_is_derived():
    robot = with_symbols(ROBOT)
    q = joint_symbols(robot)
    derived = {}
    for boundary in robot.boundaries:
        for j, formula in enumerate(components(robot, boundary).symbolic(q), start=1):
            derived[f"beta_{{{boundary.name[1:]},{j}}}"] = formula
    for name, text in printed.EQUATION_29.items():
        assert sp.expand(derived.pop(name) - printed.expression(text)) == 0
    assert set(derived.values()) == {0}  # the components that are not printed


def test_symbols_have_the_printed_values():
    again = with_values(with_symbols(ROBOT), offset_values(ROBOT))
    q = [0.3, -1.0]
    for boundary in ROBOT.boundaries:
        found = clearance(again, again.boundary(boundary.name))(q)
        assert_allclose(found, clearance(ROBOT, boundary)(q), atol=1e-11)


@given(robots(), st.data())
def test_a_robot_of_symbols_is_the_robot(robot, data):
    q = data.draw(configurations(robot))
    again = with_values(with_symbols(robot), offset_values(robot))
    assert_allclose(position(again)(q), position(robot)(q), atol=1e-10)


@pytest.mark.parametrize(
    ("name", "gap", "angle"),
    [
        ("B1", 0.004323, 76.250478),
        ("B2", 0.000324, -136.238179),
        ("B3", 0.001243, 44.405610),
        ("B4", 0.080238, -164.137156),
    ],
)
def test_the_printed_points_never_quite_meet(name, gap, angle):
    found = closest_approach(ROBOT, ROBOT.boundary(name))
    assert_allclose([found.gap, np.degrees(found.q)], [gap, angle], atol=1e-6)
    assert_allclose(abs(found.radii[0] - found.radii[1]), found.gap, atol=1e-12)
    q = np.zeros((3601, 2))
    q[:, found.joint] = np.linspace(-np.pi, np.pi, 3601)
    apart = np.linalg.norm(pair_vector(ROBOT, ROBOT.boundary(name))(q), axis=-1)
    assert found.gap <= apart.min() + 1e-12 <= found.gap + 0.02


def test_closest_approach_needs_one_turn():
    with pytest.raises(ValueError, match=r"2 joints apart.*cspace"):
        closest_approach(ROBOT, Pair("far", ("6", "11")))
    sliding = replace(ROBOT.joints[1], kind="prismatic")
    arm = replace(ROBOT, joints=(ROBOT.joints[0], sliding))
    with pytest.raises(ValueError, match="q2 slides"):
        closest_approach(arm, arm.boundary("B3"))


def test_keeps_clear_is_all_margins_of_points():
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (500, 2))
    kept = keeps_clear(ROBOT, q)
    least = np.min(list(margins(ROBOT, q).values()), axis=0)
    assert np.array_equal(kept, least >= 0)
    assert kept.any()
    assert not kept.all()
    nothing = replace(ROBOT, boundaries=())
    assert keeps_clear(nothing, q).all()


def test_a_boundary_of_another_kind_has_no_form():
    with pytest.raises(TypeError, match="a str has no single boundary function"):
        clearance(ROBOT, "B7")


def test_normals_are_made_unit_vectors_and_offsets_stay():
    wall = HalfSpace("wall", "3", [0, 0, 2], 5.0)
    assert wall.normal.tolist() == [0, 0, 1]
    assert wall.offset == 5.0
