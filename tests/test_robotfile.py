"""Robot files: what a good one means, and one clear error for each way to be wrong."""

import json
import math
import re
from collections.abc import Callable
from importlib import resources
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from oracles import OFFSETS, Table, packaged_table, row_of

from qbound import RobotFileError, load_robot, packaged_robots, paper
from qbound.robot import HalfSpace, Pair, with_symbols
from qbound.robotfile import parse_robot

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
    _, labelled = with_symbols(load_robot("minervabot-v2"))
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


def test_points_6_to_13_are_corners_of_the_bodies() -> None:
    robot = load_robot("minervabot-v2")
    corners = {(body.frame, *corner) for body in robot.bodies for corner in body.polygon.tolist()}
    for name in map(str, range(6, 14)):
        point = robot.point(name)
        assert (point.frame, point.at[0], point.at[2]) in corners


def test_siblings_of_the_packaged_robot_differ_where_they_say() -> None:
    """One digit mended; exact lengths that round to the printed ones, but for that digit."""
    offsets = {}
    for name in ("minervabot-v2", "minervabot-v2-mended", "minervabot-v2-symmetric"):
        _, labelled = with_symbols(load_robot(name))
        offsets[name] = {symbol.name: value for symbol, value in labelled.items()}
    printed, mended, symmetric = offsets.values()
    assert mended == printed | {"x_{2,13}": 9.09}
    assert {label: round(value, 2) for label, value in symmetric.items()} == mended


def test_packaged_robots_are_found_by_their_stem() -> None:
    assert "minervabot-v2" in packaged_robots()
    for name in packaged_robots():
        assert load_robot(name).name


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
    assert parse_robot(table).joints[0].limits == (-120, 480)


def test_normals_and_axes_are_normalised_and_offsets_are_not() -> None:
    table = packaged_table()
    row_of(table, "boundary", "B7")["normal"] = [3, 0, 4]
    table["joint"][0]["axis"] = [0, -2, 0]
    robot = parse_robot(table)
    wall = robot.boundary("B7")
    assert_allclose(wall.normal, [0.6, 0, 0.8])
    assert wall.offset == 11.32
    assert_array_equal(robot.joints[0].axis, [0, -1, 0])


@pytest.mark.parametrize("length", [1.5e308, 1e-200, 1e-310])
def test_an_axis_of_any_length_is_normalised(length) -> None:
    """Neither overflow nor underflow turns a direction into none."""
    table = packaged_table()
    table["joint"][0]["axis"] = row_of(table, "boundary", "B7")["normal"] = [length, 0, -length]
    robot = parse_robot(table)
    for direction in (robot.joints[0].axis, robot.boundary("B7").normal):
        assert_allclose(direction, np.array([1, 0, -1]) / math.sqrt(2))


def test_a_radius_and_a_clearance_are_kept() -> None:
    table = packaged_table()
    row_of(table, "point", "7")["radius"] = 2
    del row_of(table, "boundary", "B1")["clearance"]
    robot = parse_robot(table)
    assert (robot.point("7").radius, robot.boundary("B1").clearance) == (2, 0)


def test_a_pair_that_is_never_a_wall_is_warned_of() -> None:
    """No radius and no clearance: |B| >= 0 always holds."""
    table = packaged_table()
    del row_of(table, "boundary", "B1")["clearance"]
    with pytest.warns(UserWarning, match="B1"):
        parse_robot(table)


# --- bad files -----------------------------------------------------------------------------------

Change = Callable[[Table], Any]


def put(place: str, value: Any) -> Change:
    """A change of one place of the table, written as the error writes it: joint[0].axis."""

    def change(table: Table) -> None:
        *path, last = [int(p) if p.isdigit() else p for p in re.findall(r"\w+", place)]
        for key in path:
            table = table[key]
        table[last] = value

    return change


def drop(place: str) -> Change:
    """Remove one place of the table."""

    def change(table: Table) -> None:
        *path, last = [int(p) if p.isdigit() else p for p in re.findall(r"\w+", place)]
        for key in path:
            table = table[key]
        del table[last]

    return change


BAD: dict[str, tuple[Change, str, str]] = {
    # what is wrong: how to make it so, the place that the error names, what it says of it
    "no schema number": (drop("schema"), "file", "'schema' is a required"),
    "schema of the future": (put("schema", 2), "schema", "1 was expected"),
    "no joint": (put("joint", []), "joint", r"\[\]"),
    "no tool": (drop("tool"), "file", "'tool' is a required"),
    "unknown key of the file": (put("colour", "red"), "file", "'colour' was unexpected"),
    "unknown key of a joint": (put("joint[1].axes", [0, 1, 0]), "joint[1]", "'axes' was unex"),
    "unknown key of a point": (put("point[0].z", 1), "point[0]", "'z' was unexpected"),
    "unknown key of a pair": (put("boundary[0].offset", 1), "boundary[0]", "'offset' was unex"),
    "unknown key of a half-space": (put("boundary[6].margin", 1), "boundary[6]", "'margin' was"),
    "unknown key of a body": (put("body[0].mass", 1), "body[0]", "'mass' was unexpected"),
    "joint without axis": (drop("joint[0].axis"), "joint[0]", "'axis' is a required"),
    "joint of an unknown type": (
        put("joint[0].type", "screw"), "joint[0].type", "'screw' is not one of .*'prismatic'",
    ),
    "boundary of an unknown type": (
        put("boundary[0].type", "wall"), "boundary[0].type", "'wall' is not one of .*'pair'",
    ),
    "unknown unit of length": (put("length_unit", "inch"), "length_unit", "'inch' .*'mm'"),
    "unknown unit of angle": (put("angle_unit", "grad"), "angle_unit", "'grad' .*'rad'"),
    "text for a number": (put("point[0].at[0]", "1"), "point[0].at[0]", "'1' is not of type"),
    "truth for a number": (put("point[0].at[0]", True), "point[0].at[0]", "True is not of type"),
    "formula for a number": (put("home.q1", "pi / 2"), "home.q1", "'pi / 2' is not of type"),
    "number for a label": (put("tool", 3), "tool", "3 is not of type 'string'"),
    "empty label": (put("point[0].name", ""), "point[0].name", "''"),
    "two coordinates": (put("point[2].at", [1, 2]), "point[2].at", r"\[1, 2\] is too short"),
    "four coordinates": (put("joint[0].origin", [1, 2, 3, 4]), "joint[0].origin", "too long"),
    "one limit": (put("joint[0].limits", [1]), "joint[0].limits", "too short"),
    "negative radius": (put("point[0].radius", -1), "point[0].radius", "-1 is less than"),
    "negative clearance": (put("boundary[0].clearance", -0.1), "boundary[0].clearance", "-0.1"),
    "no velocity": (put("joint[0].velocity", 0), "joint[0].velocity", "0 is less than or equal"),
    "point paired with itself": (
        put("boundary[0].points", ["6", "6"]), "boundary[0].points", "non-unique",
    ),
    "body of two corners": (put("body[0].polygon", [[0, 0], [1, 0]]), "body[0].polygon", "short"),
    "NaN": (put("point[1].at[2]", math.nan), "point[1].at[2]", "nan is not a finite number"),
    "infinity": (put("boundary[6].offset", -math.inf), "boundary[6].offset", "-inf is not a fin"),
    "NaN as a limit": (put("joint[0].limits", [math.nan, 1]), "joint[0].limits[0]", "nan is not"),
    "infinite home": (put("home.q2", math.inf), "home.q2", "inf is not a finite number"),
    "integer beyond doubles": (put("point[0].at[0]", 10**400), "point[0].at[0]", "finite"),
    "limit beyond doubles": (put("joint[0].limits", [0, 10**400]), "joint[0].limits[1]", "finite"),
    "zero axis": (put("joint[1].axis", [0, 0, 0]), "joint[1].axis", "no direction"),
    "zero normal": (put("boundary[6].normal", [0, 0.0, 0]), "boundary[6].normal", "no direction"),
    "reversed limits": (put("joint[0].limits", [1, -1]), "joint[0].limits", r"\[1, -1\] .* rising"),
    "equal limits": (put("joint[0].limits", [1, 1]), "joint[0].limits", r"\[1, 1\] .* rising"),
    "slide without limits": (
        put("joint[1].type", "prismatic"), "joint[1].limits", "missing; a prismatic joint needs",
    ),
    "joint twice": (put("joint[1].name", "q1"), "joint[1].name", "'q1' is used twice"),
    "point twice": (put("point[3].name", "7"), "point[3].name", "'7' is used twice"),
    "boundary twice": (put("boundary[1].name", "B1"), "boundary[1].name", "'B1' is used twice"),
    "point named as a frame": (put("point[1].name", "2"), "point[1].name", "'2' is the name of a"),
    "cycle": (put("joint[1].frame", "0"), "joint[1].frame", "'0' closes a cycle"),
    "frame on itself": (put("joint[0].frame", "0"), "joint[0].frame", "'0' closes a cycle"),
    "branch": (put("joint[1].parent", "0"), "joint[1].parent", "'0' found; .* at frame '1'"),
    "parent that is no frame": (put("joint[1].parent", "9"), "joint[1].parent", "'9' found"),
    "point in no frame": (put("point[2].frame", "9"), "point[2].frame", "no frame '9'; .* 0, 1, 2"),
    "body in no frame": (put("body[2].frame", "9"), "body[2].frame", "no frame '9'; .* 0, 1, 2"),
    "tool that is no point": (put("tool", "2"), "tool", "no point '2'; there are 3, 6"),
    "pair of no point": (put("boundary[0].points", ["6", "5"]), "boundary[0].points", "no point"),
    "wall of no point": (put("boundary[6].point", "2"), "boundary[6].point", "no point '2'"),
    "home of no joint": (put("home.q3", 0.0), "home", "no joint 'q3'; there are q1, q2"),
    "joint without home": (drop("home.q2"), "home", "joint 'q2' has no value"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "place", "says"), BAD.values(), ids=BAD)
def test_a_bad_file_has_one_error_that_names_the_place(change, place, says) -> None:
    table = packaged_table()
    change(table)
    with pytest.raises(RobotFileError, match=f"^{re.escape(place)}: .*{says}") as error:
        parse_robot(table)
    assert "\n" not in str(error.value)


def test_the_error_names_the_file(tmp_path: Path) -> None:
    path = tmp_path / "crooked.toml"
    path.write_text(MINIMAL.replace("[0, 0.5]", "[0.5, 0]"), encoding="utf-8")
    with pytest.raises(RobotFileError, match=r"crooked\.toml: joint\[0\]\.limits: \[0\.5, 0\]"):
        load_robot(path)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"schema = ", "not TOML"),
        (b"a = 1\na = 2\n", "not TOML"),
        (b'name = "\xff"', "not UTF-8"),
        (b"", "'schema' is a required"),
    ],
    ids=["cut off", "key twice", "not UTF-8", "empty"],
)
def test_a_file_that_is_no_table_is_named(tmp_path: Path, content, says) -> None:
    path = tmp_path / "broken.toml"
    path.write_bytes(content)
    with pytest.raises(RobotFileError, match=rf"broken\.toml: .*{says}"):
        load_robot(path)


def test_a_file_that_is_missing_says_which_robots_there_are(tmp_path: Path) -> None:
    for source in (tmp_path / "none.toml", tmp_path, "minervabot-v3"):
        with pytest.raises(RobotFileError, match=r": .*; packaged robots are .*minervabot-v2"):
            load_robot(source)


def test_nothing_in_a_file_is_evaluated(tmp_path: Path) -> None:
    """Code as text stays text; where a number belongs it is refused."""
    canary = tmp_path / "canary"
    code = f"__import__('pathlib').Path('{canary}').touch()"
    text = MINIMAL.replace('"minimal"', f'"{code}"').replace('"tip"', f'"{code}"')
    path = tmp_path / "code.toml"
    path.write_text(text, encoding="utf-8")
    robot = load_robot(path)
    assert (robot.name, robot.tool) == (code, code)
    robot.frames(robot.home)
    path.write_text(MINIMAL.replace("[1, 0, 0]", f'["{code}", 0, 0]'), encoding="utf-8")
    with pytest.raises(RobotFileError, match="is not of type 'number'"):
        load_robot(path)
    assert not canary.exists()


def test_schema_is_a_valid_json_schema_that_closes_every_table() -> None:
    from jsonschema import Draft202012Validator

    folder = resources.files("qbound").joinpath("schemas")
    schema = json.loads(folder.joinpath("robot.schema.json").read_text("utf-8"))
    Draft202012Validator.check_schema(schema)
    assert schema["additionalProperties"] is False
    for kind in ("joint", "point", "body"):
        assert schema["$defs"][kind]["additionalProperties"] is False
