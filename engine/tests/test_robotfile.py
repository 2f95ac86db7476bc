# ruff: noqa: E501  (one table, a case a line)
"""Robot files: what a good one means, and one clear error for each way to be wrong."""

from __future__ import annotations

import json
import math
import random
import re
import tomllib
import warnings
from dataclasses import replace
from datetime import date
from importlib import resources
from itertools import permutations, product
from math import pi
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from cspace import RobotFileError, check, find_region, load_robot, margins, packaged_robots
from cspace.arms.why import why
from cspace.cli import main
from cspace.model.robot import HalfSpace, Pair, Robot
from cspace.model.robotcheck import json_schema
from cspace.model.robotfile import parse_robot, robot_text, save_robot
from cspace.model.schema import explained
from engine_support import second_checker
from engine_support.oracles import OFFSETS, packaged_table, robot_tables, row_of
from engine_support.tables import Change, Table, drop, put
from lizarraga2025 import printed as paper
from qbound.frames import roll_pitch_yaw
from qbound.symbols import offset_values

MINIMAL = """
schema = 1
name = "minimal"
length_unit = "m"
angle_unit = "rad"
home = { lift = 0.5 }
tool = "tip"
[[joint]]
name = "lift"
type = "prismatic"
parent = "base"
frame = "carriage"
origin = [0, 0, 1]
axis = [0, 0, 2]
limits = [0, 0.5]
[[point]]
name = "tip"
frame = "carriage"
at = [1, 0, 0]
"""

# --- good files ----------------------------------------------------------------------------------


def test_the_packaged_robot_has_the_printed_offsets() -> None:
    """Tables 1 and 3-5, compared twice: with the printed data and with a second typing of it."""
    labelled = offset_values(load_robot("minervabot-v2"))
    found = {symbol.name: value for symbol, value in labelled.items()}
    assert found == paper.offsets_in_cm()
    assert {re.sub(r"[_{},]", "", label): value for label, value in found.items()} == OFFSETS


def test_the_packaged_robot_has_the_printed_boundaries() -> None:
    robot = load_robot("minervabot-v2")
    pairs = {b.name: b.points for b in robot.boundaries if isinstance(b, Pair)}
    walls = {b.name: (b.point, *b.normal) for b in robot.boundaries if isinstance(b, HalfSpace)}
    assert pairs == {"B1": ("6", "7"), "B2": ("8", "9"), "B3": ("10", "11"), "B4": ("12", "13")}
    assert walls == {"B5": ("3", 1, 0, 0), "B6": ("3", 1, 0, 0), "B7": ("3", 0, 0, 1)}
    assert [b.name for b in robot.boundaries if not b.used] == ["B5", "B6"]
    assert all(tuple(joint.axis) == (0, 1, 0) for joint in robot.joints)
    assert (robot.length_unit, robot.angle_unit, robot.tool) == ("cm", "deg", "3")
    assert_array_equal(robot.home, 0)


def test_the_clearance_of_the_packaged_robot_makes_a_wall_of_every_pair() -> None:
    """0.0802 cm is the largest closest approach; 0.1 cm is above it."""
    robot = load_robot("minervabot-v2")
    assert {b.clearance for b in robot.boundaries if isinstance(b, Pair)} == {0.1}


def test_siblings_of_the_packaged_robot_differ_where_they_say() -> None:
    """One digit mended; exact lengths that round to the printed ones, but for that digit."""
    offsets = {}
    for name in ("minervabot-v2", "minervabot-v2-corrected", "minervabot-v2-symmetric"):
        labelled = offset_values(load_robot(name))
        offsets[name] = {symbol.name: value for symbol, value in labelled.items()}
    printed, mended, symmetric = offsets.values()
    assert mended == printed | {"x_{2,13}": 9.09}
    assert {label: round(value, 2) for label, value in symmetric.items()} == mended


def test_a_minimal_file_has_the_stated_defaults(tmp_path: Path) -> None:
    path = tmp_path / "minimal.toml"
    path.write_text(MINIMAL, encoding="utf-8")
    robot = load_robot(path)
    (joint,) = robot.joints
    assert (joint.kind, joint.limits, joint.velocity) == ("prismatic", (0, 0.5), None)
    assert_array_equal(joint.axis, [0, 0, 1])  # normalised
    assert_array_equal(joint.mount, np.eye(3))
    assert (robot.boundaries, robot.bodies, robot.base) == ((), (), "base")
    assert robot.point("tip").radius == 0
    assert robot.home == [0.5]
    assert load_robot(str(path)).name == "minimal"


def test_units_of_angle_scale_turns_and_not_slides() -> None:
    table = packaged_table()
    table["joint"][0] |= {"limits": [-120, 480], "velocity": 90, "rpy": [0, 0, 180]}
    table["joint"][1] |= {"type": "prismatic", "limits": [-2, 3], "velocity": 4}
    table["home"] = {"q1": 720.0, "q2": 2.5}
    turn, slide = parse_robot(table).joints
    assert_allclose(turn.limits, [-2 * pi / 3, 8 * pi / 3])  # wider than a turn: kept
    assert turn.velocity == pytest.approx(pi / 2)
    assert_allclose(turn.mount, np.diag([-1, -1, 1]), atol=1e-15)
    assert (slide.limits, slide.velocity) == ((-2, 3), 4)
    assert_allclose(parse_robot(table).home, [4 * pi, 2.5])  # home is not wrapped
    table["angle_unit"] = "rad"
    with pytest.warns(UserWarning, match="95 turns wide"):
        assert parse_robot(table).joints[0].limits == (-120, 480)


def test_a_continuous_joint_turns_without_limits(tmp_path: Path) -> None:
    table = packaged_table()
    revolute = parse_robot(table)
    table["joint"][0]["type"] = "continuous"
    robot, q = parse_robot(table), np.random.default_rng(3).uniform(-4, 4, (500, 2))
    assert robot.joints[0].type_name == "continuous"
    assert (find_region(robot).contains(q) == find_region(revolute).contains(q)).all()
    assert_array_equal(margins(robot, q), margins(revolute, q))
    save_robot(robot, tmp_path / "arm.toml")
    assert load_robot(tmp_path / "arm.toml") == robot
    proved = why(tmp_path / "arm.toml", [0.0, 0.0], [0.2, -0.5]).certificate
    assert check.check(proved.text).refuted is False
    assert second_checker.verify(proved.text.encode()) == "proved"


@pytest.mark.parametrize("length", [1.5e308, 1e-200, 1e-310])
def test_an_axis_of_any_length_is_normalised(length) -> None:
    """Neither overflow nor underflow turns a direction into none."""
    table = packaged_table()
    table["joint"][0]["axis"] = row_of(table, "boundary", "B7")["normal"] = [length, 0, -length]
    robot = parse_robot(table)
    for direction in (robot.joints[0].axis, robot.boundary("B7").normal):
        assert_allclose(direction, np.array([1, 0, -1]) / math.sqrt(2))


def test_a_pair_that_is_never_a_wall_is_warned_of(tmp_path: Path) -> None:
    """No radius and no clearance: |B| >= 0 always holds. The warning points at the caller."""
    table = packaged_table()
    row_of(table, "boundary", "B2")["clearance"] = 0
    text = "no radius and no clearance; this pair is never a wall"
    with pytest.warns(UserWarning, match=rf"^boundary\[1\] \(B2\): {text}$") as caught:
        robot = parse_robot(table)
    assert [w.filename for w in caught] == [__file__]
    path = tmp_path / "bare.toml"
    save_robot(robot, path)
    with pytest.warns(UserWarning, match=r"bare\.toml: boundary\[1\] \(B2\): ") as caught:
        load_robot(path)
    assert [w.filename for w in caught] == [__file__]


DOT, LINE = (
    {"disc": {"at": [0, 0], "radius": 0}},
    {"capsule": {"from": [0, 0], "to": [1, 0], "radius": 0}},
)
SQUARE = {"polygon": [[0, 0], [1, 0], [1, 1]]}


@pytest.mark.parametrize(
    ("link", "obstacle", "clearance", "warned"),
    [(DOT, LINE, 0, True), (DOT, DOT, 0, True), (LINE, LINE, 0, False), (DOT, SQUARE, 0, False),
     (DOT, LINE, 0.1, False), (DOT, {"disc": {"at": [0, 0], "radius": 1}}, 0, False)],
)  # fmt: skip
@pytest.mark.parametrize("collisions", [True, False])
def test_bodies_that_are_never_a_wall_are_warned_of(
    link: Any, obstacle: Any, clearance: float, warned: bool, collisions: bool
) -> None:
    """A disc of radius 0 went through a capsule of radius 0 with the words "not overlapping"."""
    table = packaged_table()
    table["body"], table["obstacle"] = (
        [{"frame": "2", "name": "link"} | link],
        [{"name": "post"} | obstacle],
    )
    own = {"name": "own", "type": "bodies", "bodies": ["link", "post"], "clearance": clearance}
    if collisions:
        table |= {"collisions": "all", "clearance": clearance}
    else:
        table["boundary"].append(own)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        parse_robot(table)
    said = [str(each.message) for each in caught]
    assert len(said) == warned
    assert all("no radius and no clearance; it is never a wall" in text for text in said)


@pytest.mark.parametrize(
    ("lowest", "turns"), [(-math.pi, 0), (-4 * math.pi, 0), (-13.0, 4), (-170.0, 54)]
)
def test_limits_of_more_than_four_turns_are_doubted(lowest: float, turns: int) -> None:
    """A user wrote 170 degrees as 170 rad, and waited for two minutes."""
    table = packaged_table() | {"angle_unit": "rad"}
    table["joint"][1]["limits"] = [lowest, -lowest]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        parse_robot(table)
    wanted = f"joint[1] (q2): limits are {turns} turns wide, so answers take long; are they degrees"
    assert [str(w.message)[: len(wanted)] for w in caught] == [wanted] * bool(turns)


def test_a_bare_name_is_the_packaged_robot_and_a_path_is_a_file(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("minervabot-v2").write_text(MINIMAL, encoding="utf-8")
    assert load_robot("minervabot-v2").name == "MinervaBotV2"
    assert load_robot("./minervabot-v2").name == "minimal"
    assert load_robot(tmp_path / "minervabot-v2").name == "minimal"


def test_a_mark_of_byte_order_is_no_fault(tmp_path: Path) -> None:
    """Some editors put it first in every UTF-8 file."""
    path = tmp_path / "marked.toml"
    path.write_text(MINIMAL, encoding="utf-8-sig")
    assert load_robot(path).name == "minimal"


def test_numbers_and_arrays_of_numpy_are_numbers_and_lists() -> None:
    table = packaged_table()
    table["joint"][0]["origin"] = np.array([0, 0, 22.5])
    table["home"]["q1"] = np.float64(0.5)
    table["point"][0]["radius"] = np.int64(2)
    robot = parse_robot(table)
    assert (robot.home[0], robot.point("3").radius) == (math.radians(0.5), 2)
    assert_array_equal(robot.joints[0].origin, [0, 0, 22.5])
    table["home"]["q1"] = np.nan
    with pytest.raises(RobotFileError, match=r"^home\.q1: nan is not a finite number"):
        parse_robot(table)
    table["home"]["q1"] = pi + 1j
    with pytest.raises(RobotFileError, match=r"^home\.q1: .* is not a number"):
        parse_robot(table)


# --- bad files -----------------------------------------------------------------------------------

BAD: list[tuple[Change, str]] = [
    (drop("schema"), "'schema' is missing; needed: schema, name, "),
    (put("schema", 2), "schema: 2 is unknown; allowed: 1"),
    (put("schema", True), "schema: true is unknown; allowed: 1"),
    (put("joint", []), "joint: [] has length 0; wanted: a list of one or more"),
    (put("joint", {"name": "q1"}), "joint: a table is not a list of one or more tables"),
    (put("joint[1]", "q2"), "joint[1]: 'q2' is not a table"),
    (put("colour", "red"), "unknown key 'colour'; allowed: sch"),
    (put("joint[1].axes", [0, 1, 0]), "joint[1] (q2): unknown key 'axes'; allowed: name, type, parent, frame, origin, rpy, axis, limits, veloc"),
    (put("boundary[0].clearence", 1), "boundary[0] (B1): unknown key 'clearence'; allowed: name, type, used, points, clearance"),
    (put("boundary[6].margin", 1), "boundary[6] (B7): unknown key 'margin'; allowed: name, type, used, point, normal, offset"),
    (put("body[0]", {"a": 1, "frame": "0", "b": 2}), "body[0]: unknown keys 'a', 'b'; allowed: frame, polygon"),
    (drop("joint[0].axis"), "joint[0] (q1): 'axis' is missing; needed: name, type, parent, "),
    (put("point[0]", {}), "point[0]: 'name', 'frame', 'at' are missing; needed: name, fr"),
    (drop("boundary[0].type"), "boundary[0] (B1): 'type' is missing; needed: name, type"),
    (put("joint[0].type", "screw"), "joint[0].type (q1): 'screw' is unknown; allowed: revolute, prismatic"),
    (lambda t: t["joint"][0].update(type="continuous", limits=[-10, 10]), "joint[0].limits (q1): [-10, 10] limits a joint that has no limits"),
    (put("boundary[0].type", "wall"), "boundary[0].type (B1): 'wall' is unknown; allowed: pair, half-space"),
    (put("angle_unit", "grad"), "angle_unit: 'grad' is unknown; allowed: deg, rad"),
    (put("point[0].at[0]", "1"), "point[0].at[0] (3): '1' is not a number"),
    (put("point[0].at[0]", True), "point[0].at[0] (3): true is not a number"),
    (put("boundary[0].used", 1), "boundary[0].used (B1): 1 is not true or false"),
    (put("point[0].radius", date(2026, 1, 1)), "point[0].radius (3): 2026-01-01 is not a num"),
    (put("tool", 3), "tool: 3 is not a text of one letter or more"),
    (put("joint[1].axis", "up"), "joint[1].axis (q2): 'up' is not a list of 3 numbers"),
    (put("home", [0, 0]), "home: [0, 0] is not a table with a number for ea"),
    (put("home", {}), "home: a table has length 0; wanted: a table with a number"),
    (put("point[0].name", ""), "point[0].name: '' has length 0; wanted: a text"),
    (put("point[2].at", [1, 2]), "point[2].at (7): [1, 2] has length 2; wanted: a list of 3 numbers"),
    (put("point[0].radius", -1), "point[0].radius (3): -1 is too small; allowed: at least 0"),
    (put("joint[0].velocity", 0), "joint[0].velocity (q1): 0 is too small; allowed: more than 0"),
    (put("boundary[0].points", ["6", "6"]), "boundary[0].points (B1): ['6', '6'] names one thing twice; wanted: a list of the names of 2 different points"),
    (put("body[0].polygon", [[0, 0], [1, 0]]), "body[0].polygon: [[0, 0], [1, 0]] has length 2; wanted: a list of 3 to 1000 corners"),
    (put("body[0].polygon[1]", [0, 0, 0, 0]), "body[0].polygon[1]: [0, 0, 0, 0] has length 4; wanted: a list of 2 numbers in the plane of motion or of 3"),
    (put("point[1].at[2]", math.nan), "point[1].at[2] (6): nan is not a finite number"),
    (put("joint[1].axis", [0, math.nan, 1]), "joint[1].axis[1] (q2): nan is not a finite num"),
    (put("boundary[6].offset", 1e200), "boundary[6].offset (B7): 1e+200 is too large; wanted: at most 1e+100"),
    (put("clearance", 1e-101), "clearance: 1e-101 is too small; wanted: 0, or at least 1e-100"),
    (put("joint[1].limits", [-150000, 150000]), "joint[1].limits (q2): [-150000, 150000] is 833 turns wide; at most 100"),
    (put("point[0].at[0]", 10**400), "point[0].at[0] (3): 0x1b4ec7f91973ff3c"),
    (put("schema", 16**9999), "schema: 0x10000000"),
    (put("joint[1].axis", [0, 0, 0]), "joint[1].axis (q2): [0, 0, 0] has no direction; one number must not be 0"),
    (put("boundary[6].normal", [0, 0.0, -0.0]), "boundary[6].normal (B7): [0, 0.0, -0.0] has no direction"),
    (put("joint[0].limits", [1, -1]), "joint[0].limits (q1): [1, -1] does not rise; wanted: [lowest, highest]"),
    (put("joint[0].limits", [1, 1]), "joint[0].limits (q1): [1, 1] does not rise; wanted: "),
    (put("joint[1].type", "prismatic"), "joint[1].limits (q2): missing; a prismatic joint needs [lowest, highest]"),
    (put("joint[1].name", "q1"), "joint[1].name: 'q1' is used twice, first by joint[0]; names"),
    (put("point[3].name", "7"), "point[3].name: '7' is used twice, first by point[2]; names a"),
    (put("boundary[1].name", "B1"), "boundary[1].name: 'B1' is used twice, first by boundary["),
    (put("point[1].name", "2"), "point[1].name: '2' is the name of a frame; a point needs a name of its own"),
    (put("boundary[1].name", "q2.lower"), "boundary[1].name: 'q2.lower' is the name of a joint limit; a boundary needs a name of its own"),
    (put("joint[1].frame", "0"), "joint[1].frame (q2): '0' closes a cycle; every joint moves a frame of its own"),
    (put("joint[1].parent", "0"), "joint[1].parent (q2): '0' found, '1' wanted; joints form one chain from the base"),
    (put("point[2].frame", "9"), "point[2].frame (7): no frame '9'; there are 0, 1, 2"),
    (put("tool", "2"), "tool: no point '2'; there are 3, 6, 7"),
    (put("boundary[0].points", ["6", "5"]), "boundary[0].points[1] (B1): no point '5'; there are 3, 6, 7"),
    (put("home.q3", 0.0), "home.q3: no joint 'q3'; there are q1, q2"),
    (drop("home.q2"), "home: 'q2' is missing; every joint needs a value"),
    (put("tool", "a\nb"), r"tool: no point 'a\nb'; there are 3, 6, 7"),
    (lambda table: table.update({"a\nb": 1}), r"unknown key 'a\nb'; allowed: schema, name"),
    (put("point[0]", {"name": "a\nb", "frame": "0", "at": 1}), "point[0].at (a\\nb): 1 is not"),
    (put("tool", "a" * 999), "tool: no point 'aaaa"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "says"), BAD)
def test_a_bad_file_has_one_error_that_names_the_place(change, says) -> None:
    table = packaged_table()
    change(table)
    with pytest.raises(RobotFileError) as error:
        parse_robot(table)
    text = str(error.value)
    assert text.startswith(says)
    assert text.isprintable()
    assert len(text) < 200


def test_of_several_errors_the_first_in_the_file_is_told() -> None:
    """Whatever kind each is; a missing key counts where its table ends."""
    table = packaged_table()
    for i in (3, 1, 2):
        table["boundary"][i]["clearence"] = table["boundary"][i].pop("clearance")
    places = []
    for mend in (None, "boundary[1]", "boundary[2]"):
        if mend:
            drop(f"{mend}.clearence")(table)
        with pytest.raises(RobotFileError) as error:
            parse_robot(table)
        places.append(str(error.value).split(" ")[0])
    assert places == ["boundary[1]", "boundary[2]", "boundary[3]"]
    put("point[4].at", [1])(table)
    drop("point[3].at")(table)
    put("point[3].colour", "red")(table)
    with pytest.raises(RobotFileError, match=r"^point\[3\] \(8\): unknown key 'colour'"):
        parse_robot(table)
    drop("point[3].colour")(table)
    with pytest.raises(RobotFileError, match=r"^point\[3\] \(8\): 'at' is missing"):
        parse_robot(table)
    put("tool", 3)(table)
    with pytest.raises(RobotFileError, match=r"^tool: 3 is not a text"):
        parse_robot(table)


def test_a_fault_without_a_sentence_is_told_as_msgspec_tells_it() -> None:
    """Another version of msgspec may find other words: place and value stay."""
    told = "Another word for it - at `$.joint[1].axis`"
    path, text = explained(told, packaged_table(), json_schema())
    assert (list(path), text) == (["joint", 1, "axis"], "[0.0, 1.0, 0.0]: Another word for it")


def test_the_shipped_schema_is_that_of_the_classes() -> None:
    """Written anew by ``json.dumps(json_schema(), indent=2)`` and a line end."""
    file = resources.files("cspace") / "schemas" / "robot.schema.json"
    assert file.read_text("utf-8") == json.dumps(json_schema(), indent=2) + "\n"


def robot_schema() -> Table:
    file = resources.files("cspace") / "schemas" / "robot.schema.json"
    return json.loads(file.read_text("utf-8"))


def test_the_error_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "crooked.toml"
    path.write_text(MINIMAL.replace("[0, 0.5]", "[0.5, 0]"), encoding="utf-8")
    with pytest.raises(
        RobotFileError, match=r"crooked\.toml: joint\[0\]\.limits \(lift\): \[0\.5,"
    ):
        load_robot(path)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"schema = ", "not TOML"),
        (b"a = 1\na = 2\n", "not TOML"),
        (b'name = "\xff"', "not UTF-8"),
        (b"", "'schema', 'name', .* are missing"),
        (b"a = " + b"1" * 5000, "not TOML"),
        (b"a = " + b"[" * 5000, "not TOML"),
        (b"a." * 5000 + b"a = 1", "without end"),
    ],
    ids=["cut off", "key twice", "not UTF-8", "empty", "digits", "lists", "tables"],
)
def test_a_file_that_is_no_table_is_named(tmp_path: Path, content, says) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    with pytest.raises(RobotFileError, match=rf"broken\.toml: .*{says}"):
        load_robot(path)


def test_a_file_that_is_missing_says_which_robots_there_are(tmp_path: Path) -> None:
    for source in (tmp_path / "none.toml", "minervabot-v3"):
        with pytest.raises(RobotFileError, match=r": .*; packaged robots are .*minervabot-v2"):
            load_robot(source)
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe")
    for source, reason in ((tmp_path, "directory"), (tmp_path / "binary.toml", "not UTF-8 text")):
        with pytest.raises(RobotFileError, match=reason) as error:
            load_robot(source)
        assert "packaged" not in str(error.value)


def test_schema_is_a_valid_json_schema_that_closes_every_table() -> None:
    from jsonschema import Draft202012Validator

    schema = robot_schema()
    Draft202012Validator.check_schema(schema)
    closed = [schema, *schema["$defs"].values()]
    assert len(closed) >= 6
    assert all(table["additionalProperties"] is False for table in closed)


# --- files written -------------------------------------------------------------------------------

LENGTHS = st.floats(-1e3, 1e3).filter(lambda x: abs(x) > 1e-9) | st.just(0.0)
SIZES = st.floats(1e-6, 1e3)
STARTS = st.floats(-30, 30).filter(lambda x: abs(x) > 1e-9) | st.just(0.0)
SPANS = st.tuples(STARTS, st.floats(0.01, 30)).map(lambda s: [s[0], s[0] + s[1]])
NAMES = st.text(min_size=1, max_size=5)


@st.composite
def full_tables(draw: st.DrawFn) -> Table:
    """Any chain, with any optional keys, in every unit, under names of any letters."""
    table = draw(robot_tables())
    table["angle_unit"] = draw(st.sampled_from(["deg", "rad"]))
    table["length_unit"] = draw(st.sampled_from(["m", "cm", "mm"]))
    table["name"] = draw(NAMES)
    for joint in table["joint"]:
        joint.update(draw(st.fixed_dictionaries({}, optional={"limits": SPANS, "velocity": SIZES})))
        table["home"][joint["name"]] = draw(LENGTHS)
    for point in table["point"]:
        point.update(draw(st.fixed_dictionaries({}, optional={"radius": SIZES})))
    pair = {"name": draw(NAMES), "type": "pair", "points": ["p0", "p1"], "clearance": draw(SIZES)}
    wall = {
        "name": pair["name"] + "'",
        "type": "half-space",
        "point": "p1",
        "offset": draw(LENGTHS),
    }
    wall |= {"normal": draw(st.lists(LENGTHS, min_size=3, max_size=3).filter(any))}
    table["boundary"] = [pair, wall | draw(st.sampled_from([{}, {"used": False}]))]
    corners = st.lists(st.lists(LENGTHS, min_size=2, max_size=2), min_size=3, max_size=5)
    table["body"] = draw(
        st.lists(st.fixed_dictionaries({"frame": st.just("1"), "polygon": corners}))
    )
    odd = draw(st.dictionaries(st.just("q1"), NAMES.filter(lambda name: name not in table["home"])))
    return renamed(table, odd)


def renamed(table: Table, names: dict[str, str]) -> Table:
    """Call joints otherwise."""
    for joint in table["joint"]:
        joint["name"] = names.get(joint["name"], joint["name"])
    table["home"] = {names.get(name, name): value for name, value in table["home"].items()}
    return table


def everything(robot: Robot) -> tuple[list[Any], list[float], list[float]]:
    """Words, numbers, and the numbers of the mounts, in one order."""
    words: list[Any] = [robot.name, robot.tool, robot.length_unit, robot.angle_unit]
    numbers, mounts = [*robot.home], []
    for j in robot.joints:
        words += [j.name, j.kind, j.parent, j.frame, j.limits is None, j.velocity is None]
        numbers += [*j.origin, *j.axis, *(j.limits or ()), j.velocity or 0]
        mounts += [*j.mount.ravel()]
    for p in robot.points:
        words += [p.name, p.frame]
        numbers += [*p.at, p.radius]
    for b in robot.boundaries:
        words += [b.name, b.used, b.points if isinstance(b, Pair) else b.point]
        numbers += [b.clearance] if isinstance(b, Pair) else [*b.normal, b.offset]
    for body in robot.bodies:
        words += [body.name, body.frame, body.shape.key, len(body.shape.places)]
        numbers += [*body.shape.places.ravel()]
    return words, numbers, mounts


@pytest.mark.filterwarnings("ignore:.*turns wide")
@given(full_tables())
def test_a_robot_written_and_read_is_the_same(table) -> None:
    """Every number to one unit in its last place; a mount goes through three angles."""
    robot = parse_robot(table)
    with TemporaryDirectory() as folder:
        save_robot(robot, Path(folder) / "robot.toml")
        again = load_robot(Path(folder) / "robot.toml")
    words, numbers, mounts = everything(robot)
    words_again, numbers_again, mounts_again = everything(again)
    assert words_again == words
    gaps = np.abs(np.subtract(numbers_again, numbers)) / np.spacing(np.abs(numbers))
    assert np.max(gaps) <= 1
    assert_allclose(mounts_again, mounts, rtol=0, atol=4 * np.finfo(float).eps)


@pytest.mark.parametrize("name", packaged_robots())
def test_a_packaged_robot_is_written_as_it_was_typed(name, tmp_path: Path) -> None:
    path = tmp_path / "again.toml"
    save_robot(load_robot(name), path)
    typed = tomllib.loads(robot_text(name)[0])
    for row in typed.get("boundary", ()):
        if "normal" in row:  # written as a unit vector
            row["normal"] = [x / math.hypot(*row["normal"]) for x in row["normal"]]
    assert tomllib.loads(path.read_text("utf-8")) == typed


def exact_turns() -> list[np.ndarray]:
    """The 24 rotations of a cube: in some, yaw and roll turn about one line."""
    signed = [
        np.diag(signs)[list(order)]
        for order in permutations(range(3))
        for signs in product([1, -1], repeat=3)
    ]
    return [matrix for matrix in signed if np.linalg.det(matrix) > 0]


def test_every_mount_is_kept(tmp_path: Path) -> None:
    """Exact quarter turns, and pitches near one."""
    robot = load_robot("minervabot-v2")
    near = [roll_pitch_yaw(roll, pi / 2 - 1e-9, 0.9) for roll in (0, 0.3, -3)]
    for mount in [*exact_turns(), *near]:
        joints = tuple(replace(joint, mount=mount) for joint in robot.joints)
        save_robot(replace(robot, joints=joints), tmp_path / "arm.toml")
        again = load_robot(tmp_path / "arm.toml").joints[1].mount
        assert_allclose(again, mount, rtol=0, atol=4 * np.finfo(float).eps)


def test_what_is_no_robot_is_not_written(tmp_path: Path) -> None:
    robot = load_robot("minervabot-v2")
    path = tmp_path / "arm.toml"
    path.write_text("kept", encoding="utf-8")
    with pytest.raises(RobotFileError, match=r"arm\.toml: not written: home\.q1: inf is not a fin"):
        save_robot(replace(robot, home=np.array([np.inf, 0])), path, force=True)
    with pytest.raises(RobotFileError, match="no point '99'"):
        save_robot(replace(robot, tool="99"), path, force=True)
    assert path.read_text("utf-8") == "kept"
    assert list(tmp_path.iterdir()) == [path]


# --- the page of the book ------------------------------------------------------------------------

PAGE = (Path(__file__).parents[2] / "book" / "robot_file.md").read_text(encoding="utf-8")


BLOCKS = re.findall(r"^```{code-block} toml\n:.*?\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def test_the_example_of_the_page_is_a_robot_with_the_bodies_of_the_page_or_without() -> None:
    (example,) = re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    keys, tables = BLOCKS[0].split("\n\n", 1)
    names = ["post", "floor", "forearm, lamp", "forearm, floor", "upper arm, lamp"]
    for text, count in ((example, 2), (f"{keys}\n{example}\n{tables}", 5)):
        robot = parse_robot(text)
        assert [b.name for b in robot.used] == names[:count]
        assert all(margin > 0 for _, margin in margins(robot, robot.home))


MARK, KEPT = "at = [0.4067366430758002, 0.0, 0.9135454576426009]", "1.4018185285997018"


@pytest.mark.parametrize(
    ("mark", "kept", "beyond"),
    [(MARK, KEPT, ()), ("at = [1, 0, 0]", repr(2 * math.cos(math.radians(78.5))), (39,))],
    ids=["as the page has it", "narrower, as it warns of"],
)
def test_two_points_limit_a_difference_of_joints_as_the_page_says(mark, kept, beyond) -> None:
    """Of the rectangle of the limits a corner is cut off, the rest of the corner is not real."""
    text = BLOCKS[1].replace(MARK, mark).replace(KEPT, kept)
    assert mark in text
    assert kept in text
    found = find_region(parse_robot(tomllib.loads(text)))
    wanted = [105 * 162 - 85**2 / 2, *(leg**2 / 2 for leg in beyond)]
    assert_allclose([np.degrees(np.degrees(c.area)) for c in found.components], wanted, rtol=1e-9)
    assert [c.contains_home for c in found.components] == [True, *(False for _ in beyond)]


def test_the_tables_of_the_page_hold_every_key_of_the_schema() -> None:
    """And which of them are needed: those without a default."""
    schema = robot_schema()
    rows = schema["$defs"]
    tables = {"": schema, "-pair": rows["PairRow"], "-half-space": rows["HalfSpaceRow"]}
    tables |= {"-joint": rows["JointRow"], "-point": rows["PointRow"], "-body": rows["BodyRow"]}
    tables |= {"-bodies": rows["BodyPairRow"], "-obstacle": rows["ObstacleRow"]}
    for name, rules in tables.items():
        block = PAGE.split(f":name: tab:robot-file{name}\n")[1].split("```")[0]
        rows = re.findall(r"^\* - `(\w+)`\n  -.*\n  -(.*)\n  - .+$", block, re.MULTILINE)
        assert [key for key, _ in rows] == list(rules["properties"])
        assert {key for key, default in rows if not default} == set(rules.get("required", ()))


# --- robot files at random ------------------------------------------------------------------------


# The folder and the captured output serve all examples; on a busy machine nothing is too slow.
UNCHECKED = [HealthCheck.function_scoped_fixture, HealthCheck.too_slow]

FILES = [robot_text(name)[0] for name in packaged_robots()]
LINES = [line for text in FILES for line in text.splitlines()]
TEXTS = [robot_text(name)[0] for name in ("minervabot-v2", "two-links-on-a-table")]
VALUES = [
    "nan", "-inf", "1e400", "0", "-1", "1e-300", "9" * 400, "true", '""', '"q1"', '"\\u0000"',
    "[]", "[0, 0]", "[[0]]", "{}", "1979-05-27", "{ q1 = 0 }", "'''x", "\ufeff", "[0, 0, 0]", '"3"',
]  # fmt: skip


@st.composite
def mutated(draw) -> str:
    """A file of points or bodies; lines changed, doubled, dropped, moved, or from other files."""
    lines = draw(st.sampled_from(TEXTS)).splitlines()
    for _ in range(draw(st.integers(1, 4))):
        i = draw(st.integers(0, len(lines) - 1))
        key = lines[i].partition("=")[0]
        change = draw(st.integers(0, 5))
        if change == 0:
            lines[i] = f"{key}= {draw(st.sampled_from(VALUES))}"
        elif change == 1:
            del lines[i]
        elif change == 2:
            lines.insert(i, draw(st.sampled_from(LINES)))
        elif change == 3:
            lines[i] = draw(st.text(max_size=20))
        elif change == 4:
            number = draw(st.floats(allow_nan=False) | st.integers())
            lines[i] = f"{key}= {number}"
        else:
            random.Random(draw(st.integers())).shuffle(lines)
    return "\n".join(lines)


@pytest.mark.parametrize("command", ["contains {} 0 0", "region {}"])
@settings(max_examples=60, deadline=None, suppress_health_check=UNCHECKED)
@given(text=mutated())
def test_a_mutated_file_is_an_answer_or_one_sentence(command, text, tmp_path, capsys) -> None:
    file = tmp_path / "robot.toml"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # a pair that is never a wall
        status = main(command.format(file).split())
    out, err = capsys.readouterr()
    assert status in (0, 1, 2)
    assert (status == 2) == (out == "") == (err != "")
    assert err == "" or err.count("\n") == 1
    assert err == "" or err.startswith("cspace: ")


@settings(max_examples=100, deadline=None, suppress_health_check=UNCHECKED)
@given(content=st.binary(max_size=300))
def test_any_bytes_are_refused_in_one_sentence(content, tmp_path, capsys) -> None:
    file = tmp_path / "robot.toml"
    file.write_bytes(content)
    assert main(["contains", str(file), "0", "0"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(f"cspace: {file}: ")
    assert err.count("\n") == 1
