"""A robot as data: forward kinematics against 4 x 4 matrices, labels for the printed formulas."""

from __future__ import annotations

import math
import pickle
import re
import sys
import tomllib
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy
from flint import fmpq
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cspace import find_region, load_robot, packaged_robots
from cspace.arms.why import why
from cspace.model.robotfile import as_written, parse_robot, robot_text
from cspace.model.source import Source
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.certify import Subject, certify
from cspace.region import violated
from engine_support.oracles import (
    ANGLES,
    QUARTER_TURNS,
    UNIT_AXES,
    frame_matrix,
    packaged_table,
    point_seen_from,
    robot_tables,
)
from engine_support.regions import check_arcs, check_grid, check_roles
from engine_support.robot_files import robot_file
from engine_support.robots import OF_POINTS
from lizarraga2025 import printed as paper
from qbound.boundary import position
from qbound.symbols import joint_symbols, offset_values, with_symbols

MINERVA = load_robot("minervabot-v2")


def values(data: st.DataObject, n: int) -> list[float]:
    return data.draw(st.lists(ANGLES, min_size=n, max_size=n))


@given(robot_tables(), st.data())
def test_forward_kinematics_are_a_product_of_matrices(table, data) -> None:
    """Any chain: prismatic joints, mounts, oblique axes, 1 to 4 joints."""
    robot, q = parse_robot(table), values(data, len(table["joint"]))
    frames = robot.frames(q)
    for joint in table["joint"]:
        expected = frame_matrix(table, joint["frame"], q)
        assert_allclose(frames.frame("0", joint["frame"]), expected[:3], atol=1e-10)
    for point in table["point"]:
        seen = point_seen_from(table, point["name"], "0", q)
        assert_allclose(frames.position("0", point["name"], "0"), seen, atol=1e-10)


@pytest.mark.parametrize("row", paper.TABLE_2, ids=[f"r_{{{a},{b}}}" for a, b, *_ in paper.TABLE_2])
def test_direct_kinematics_are_table_2(row) -> None:
    """The chain's own symbols give the printed positions and orientations."""
    a, b, vector, orientation = row
    robot = with_symbols(MINERVA)
    frames = robot.frames(list(joint_symbols(robot)))
    known = _table_2_symbols()
    assert sympy.simplify(sympy.Matrix(frames.rotation(a, b)) - known[orientation]) == sympy.zeros(
        3
    )
    printed = known[vector]
    assert sympy.simplify(sympy.Matrix(frames.position(a, b, a)) - printed) == sympy.zeros(3, 1)


def _table_2_symbols() -> dict[str, sympy.Matrix]:
    """What the printed entries of Table 2 mean, by SymPy's own matrices."""
    q1, q2, z01, x12, z12, x23 = sympy.symbols(
        "q_1 q_2 z_{0\\,1} x_{1\\,2} z_{1\\,2} x_{2\\,3}", real=True
    )
    # R_y(q) takes z to x: SymPy's rot_axis2 turns the other way.
    r01, r12 = sympy.rot_axis2(-q1), sympy.rot_axis2(-q2)
    v01, v12, v23 = (sympy.Matrix(v) for v in ([0, 0, z01], [x12, 0, z12], [x23, 0, 0]))
    return {
        "I": sympy.eye(3), "R_y(q_1)": r01, "R_y(q_2)": r12,
        "R_{0,1}R_{1,2}": r01 * r12, "R_{0,2}R_{2,3}": r01 * r12,
        r"[0\ 0\ 0]^T": sympy.zeros(3, 1), r"[0\ 0\ z_{0,1}]^T": v01,
        r"[x_{1,2}\ 0\ z_{1,2}]^T": v12, r"[x_{2,3}\ 0\ 0]^T": v23,
        r"\mathbf{r}_{0,1} + R_{0,1}\mathbf{r}_{1,2}": v01 + r01 * v12,
        r"\mathbf{r}_{0,2} + R_{0,2}\mathbf{r}_{2,3}": v01 + r01 * v12 + r01 * r12 * v23,
    }  # fmt: skip


def test_home_pose_holds_the_tool_where_the_offsets_add_up() -> None:
    """x: 15 + 25, z: 22.5 + 25.98 (cm)."""
    assert_allclose(MINERVA.frames(MINERVA.home).position("0", "3", "0"), [40, 0, 48.48])


@settings(max_examples=15)
@given(robot_tables(st.integers(1, 3), UNIT_AXES, QUARTER_TURNS))
def test_symbols_stand_for_the_numbers_of_any_chain(table) -> None:
    """Labels replaced by their values give the numeric form again; mounts stay whole numbers."""
    robot = parse_robot(table)
    labelled, known = with_symbols(robot), offset_values(robot)
    form = position(labelled, robot.tool)
    entries = [sympy.sympify(e) for e in form.coefficients.ravel()]
    assert all(e.is_integer for joint in labelled.joints for e in joint.mount.ravel())
    assert not any(e.atoms(sympy.Float) for e in entries)
    expected = position(robot, robot.tool).coefficients.ravel()
    assert_allclose([float(e.subs(known)) for e in entries], expected, atol=1e-10)


def test_oblique_axes_get_symbols_too() -> None:
    """Offsets become labels, the axis stays the number that it is."""
    table = packaged_table()
    table["joint"][1] |= {"axis": [1, 2, -3], "rpy": [10, 20, 30]}
    robot = parse_robot(table)
    labelled, known = with_symbols(robot), offset_values(robot)
    entries = position(labelled, "13").coefficients.ravel()
    expected = position(robot, "13").coefficients.ravel()
    found = [float(sympy.sympify(e).subs(known)) for e in entries]
    assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "symbol"),
    [("q1", "q_1"), ("q12", "q_12"), ("shoulder", "shoulder"), ("7", "7"), ("a1b2", "a1b_2")],
)
def test_joint_symbols_write_the_number_below(name, symbol) -> None:
    table = packaged_table()
    table["joint"][0]["name"] = name
    table["home"] = {name: 0.0, "q2": 0.0}
    assert [s.name for s in joint_symbols(parse_robot(table))] == [symbol, "q_2"]


def test_prismatic_joint_slides_along_its_mounted_axis() -> None:
    """A mount turned by 90 degrees about z: x of the mount is y of the parent."""
    table = packaged_table()
    table["joint"][0] |= {
        "type": "prismatic", "axis": [2, 0, 0], "rpy": [0, 0, 90], "limits": [0, 5]
    }  # fmt: skip
    frames = parse_robot(table).frames([3.0, 0.0])
    assert_allclose(frames.position("0", "1", "0"), [0, 3, 22.5], atol=1e-14)
    assert_allclose(frames.rotation("0", "1") @ [1, 0, 0], [0, 1, 0], atol=1e-15)


def test_lookups_name_what_there_is() -> None:
    assert MINERVA.point("7").frame == "1"
    assert MINERVA.boundary("B7").offset == 11.32
    with pytest.raises(ValueError, match="no point '5'; there are 3, 6, 7"):
        MINERVA.point("5")
    with pytest.raises(ValueError, match="no boundary 'B8'; there are B1, B2"):
        MINERVA.boundary("B8")


# --- public doors: values that no joint can have, joints by index or by name ---------------------


@pytest.mark.parametrize(
    ("q", "says"),
    [
        ([math.nan, 0.0], "joint 'q1' is nan, not a finite number"),
        ([[0.0, 0.0], [0.0, -math.inf]], "joint 'q2' is -inf in configuration [1], not a finite"),
        ([None, 0.0], "joint 'q1' is nan"),
        (["0.3", "0"], "['0.3', '0'] is no array of numbers; wanted: values of q1, q2"),
        ([True, False], "[True, False] is no array of numbers"),
        ([10**400, 0], "is no array of numbers"),
        ([[0.0, 0.0], [0.0]], "is no array of numbers"),
        ([1j, 0], "is no array of numbers"),
        (0.3, "expected 2 joint values on the last axis, found a bare number"),
        ([[0.0], [0.0]], "expected 2 joint values on the last axis, found 1"),
    ],
)
def test_what_is_no_configuration_is_refused_at_every_door(q, says) -> None:
    for door in (MINERVA.configuration, MINERVA.frames, lambda q: MINERVA.with_held(q, {})):
        with pytest.raises(ValueError, match=re.escape(says)) as error:
            door(q)
        assert str(error.value).isprintable()


def test_symbols_are_joint_values_of_frames_alone() -> None:
    q = joint_symbols(MINERVA)
    assert MINERVA.frames(q).position("0", "2", "0")[0].has(q[0])
    with pytest.raises(ValueError, match="is no array of numbers"):
        MINERVA.configuration(q)


def test_fractions_and_whole_numbers_are_joint_values() -> None:
    assert_array_equal(MINERVA.configuration([Fraction(1, 2), 1]), [0.5, 1.0])
    assert MINERVA.configuration(np.zeros((0, 2))).shape == (0, 2)


def test_held_joints_are_given_by_index_or_by_name() -> None:
    robot = parse_robot(tomllib.loads(robot_file(5, joints=3)))
    names = [joint.name for joint in robot.joints]
    by_name = robot.held_indices({names[2]: 1, names[0]: 0.5})
    assert by_name == robot.held_indices({0: 0.5, 2: 1}) == {0: 0.5, 2: 1.0}
    assert list(by_name) == [0, 2]
    assert robot.held_indices({np.int64(2): np.float64(1), names[0]: 0.5}) == by_name
    assert robot.free({names[1]: 0.0}) == robot.free([1]) == [0, 2]
    assert_array_equal(robot.with_held([[0.1, 0.2]], {names[1]: 3}), [[0.1, 3, 0.2]])


@pytest.mark.parametrize(
    ("held", "says"),
    [
        ({2: 0.0}, "no joint 2; there are 0 (q1), 1 (q2)"),
        ({-1: 0.0}, "no joint -1; there are 0 (q1), 1 (q2)"),
        ({"wrist": 0.0}, "no joint 'wrist'; there are 0 (q1), 1 (q2)"),
        ({True: 0.0}, "no joint True"),
        ({1.0: 0.0}, "no joint 1.0"),
        ({None: 0.0}, "no joint None"),
        ({0: 0.0, "q1": 0.0}, "joint 'q1' is held twice, by its index and by its name"),
        ({"q2": math.nan}, "joint 'q2' is nan, not a finite number"),
        ({1: math.inf}, "joint 'q2' is inf, not a finite number"),
        ({1: "0.3"}, "['0.3'] is no array of numbers; wanted: values of q2"),
        ({1: None}, "joint 'q2' is nan"),
        ({1: [0.1, 0.2]}, "expected 1 joint value on the last axis, found 2"),
    ],
)
def test_a_joint_that_cannot_be_held_so_is_named(held, says) -> None:
    for door in (MINERVA.held_indices, lambda held: MINERVA.with_held(np.zeros(1), held)):
        with pytest.raises(ValueError, match=re.escape(says)):
            door(held)


def test_a_robot_shows_itself_on_one_line() -> None:
    assert repr(MINERVA) == "<Robot MinervaBotV2: q1 (revolute), q2 (revolute); 7 boundaries>"
    for name in packaged_robots():
        assert len(repr(load_robot(name))) <= 140
    odd = replace(MINERVA, name="two\nlines" * 99, boundaries=MINERVA.boundaries[:1])
    assert repr(odd).isprintable()
    assert len(repr(odd)) <= 140
    assert repr(odd).endswith("; 1 boundary>")


# --- the packaged robots --------------------------------------------------------------------------


PACKAGED = [name for name in packaged_robots() if len(load_robot(name).joints) == 2]
robots = pytest.mark.parametrize("name", PACKAGED)


@robots
def test_home_is_safe_and_in_the_first_component(name):
    robot = load_robot(name)
    region = find_region(robot)
    assert violated(robot, robot.home) == []
    assert region.components[0].contains_home
    assert region.component_of(robot.home) == 0


@pytest.mark.parametrize("name", [name for name in PACKAGED if name in OF_POINTS])
def test_arcs_grid_and_roles_of_the_joints(name):
    region = find_region(load_robot(name))
    check_arcs(region)
    check_grid(region)
    check_roles(region)


# --- a robot file is read once --------------------------------------------------------------------


@pytest.fixture
def readers(monkeypatch):
    """The modules that parse TOML, one entry for each time."""
    found, loads = [], tomllib.loads

    def counted(*args, **options):
        found.append(sys._getframe(1).f_globals["__name__"])
        return loads(*args, **options)

    monkeypatch.setattr(tomllib, "loads", counted)
    return found


QUESTIONS = {
    "separated by a joint": [0.0, 2.3],
    "connected": [0.2, -0.5],
    "infeasible": [0.0, 3.0],
}


@pytest.mark.parametrize("goal", QUESTIONS.values(), ids=QUESTIONS)
def test_why_parses_its_file_once(readers, goal):
    found = why("minervabot-v2", [0.0, 0.0], goal)
    assert found.certificate is not None
    assert readers.count("cspace.model.source") == 1
    assert set(readers) == {"cspace.model.source", "cspace.check"}  # which shares nothing


def test_a_robot_that_was_read_is_certified_without_a_reader_of_its_own(readers):
    robot = load_robot("minervabot-v2")
    subject = Subject(robot)
    for size in ("10", "5"):
        answer = certify(subject, statements.box([f"-{size}"] * 2, [size] * 2))
        assert answer.verdict == "proved"
    assert readers.count("cspace.model.source") == 1
    assert subject.text == robot_text("minervabot-v2")[0]


def test_a_decimal_is_a_double_and_a_rational():
    source = Source.of_text("a = 0.1\nb = [1, 2.50]\nc = {d = 1e3}\ne = true")
    assert source.table == {"a": 0.1, "b": [1, 2.5], "c": {"d": 1000.0}, "e": True}
    assert {type(x) for x in (source.table["a"], source.table["c"]["d"])} == {float}
    exact = {"a": fmpq(1, 10), "b": [1, fmpq(5, 2)], "c": {"d": fmpq(1000)}, "e": True}
    assert source.exact == exact


def test_a_source_goes_with_its_robot_into_another_process():
    robot = load_robot("minervabot-v2")
    again = pickle.loads(pickle.dumps(robot))
    assert again == robot
    assert again.source.text == robot.source.text
    assert again.source.exact == robot.source.exact


def test_a_robot_that_was_changed_is_written_anew():
    robot = load_robot("pp-portal")
    assert as_written(robot) is robot
    other = replace(robot, name="another portal")
    assert as_written(other) == other
    assert as_written(other).source.text != robot.source.text
    assert parse_robot(as_written(other).source.text) == other
