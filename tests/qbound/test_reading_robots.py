"""Robot files: what is read, and one clear error that names the file and the key."""

import copy
import tomllib

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lizarraga2025 import printed
from qbound import HalfSpace, Pair, load_robot
from qbound.robotfile import ROBOTS, read_robot
from qbound.symbols import offset_values

TABLE = tomllib.loads((ROBOTS / "minervabot-v2.toml").read_text())


def test_the_packaged_robot_is_printed():
    robot = load_robot("minervabot-v2")
    values = {str(symbol): value for symbol, value in offset_values(robot).items()}
    assert values == printed.offsets_in_cm()
    assert [type(b) for b in robot.boundaries] == [Pair] * 4 + [HalfSpace] * 3
    assert [b.name for b in robot.used] == ["B1", "B2", "B3", "B4", "B7"]
    assert [outline.corners.shape for outline in robot.outlines] == [(4, 3)] * 3
    assert [outline.frame for outline in robot.outlines] == ["0", "1", "2"]
    corrected = load_robot("minervabot-v2-corrected")
    differs = [p.name for p in robot.points if not np.array_equal(p.at, corrected.point(p.name).at)]
    assert differs == ["13"]


def test_a_path_is_a_file_and_a_name_is_a_packaged_robot(tmp_path):
    path = tmp_path / "arm.toml"
    path.write_text((ROBOTS / "minervabot-v2.toml").read_text())
    assert load_robot(path).name == load_robot(str(path)).name == "MinervaBotV2"
    with pytest.raises(ValueError, match=r"no packaged robot 'minerva'; there are minervabot-v2,"):
        load_robot("minerva")
    with pytest.raises(FileNotFoundError):
        load_robot(tmp_path / "none.toml")
    path.write_bytes(b"\xff\xfe = [")
    with pytest.raises(ValueError, match=r"arm.toml: not a TOML file"):
        load_robot(path)


def test_degrees_are_radians_and_lengths_stay():
    table = changed("joint", 0, limits=[-90, 180]) | {"home": {"q1": 45, "q2": 2.5}}
    table["joint"][1] |= {"type": "prismatic", "limits": [0, 9]}
    robot = read_robot(table)
    assert_allclose(robot.joints[0].limits, [-np.pi / 2, np.pi])
    assert robot.joints[1].limits == (0, 9)
    assert_allclose(robot.home, [np.pi / 4, 2.5])
    assert read_robot(table | {"angle_unit": "rad"}).home == (45, 2.5)


def changed(key, number, **values):
    """Return the table with other values in one row; None takes a key away."""
    table = copy.deepcopy(TABLE)
    for name, value in values.items():
        if value is None:
            del table[key][number][name]
        else:
            table[key][number][name] = value
    return table


WRONG = [
    (TABLE | {"schema": 2}, "schema must be 1, found 2"),
    (TABLE | {"angle_unit": "grad"}, "angle_unit must be deg or rad, found 'grad'"),
    (TABLE | {"name": ""}, "name must be a text, found ''"),
    (TABLE | {"jont": []}, "unknown key 'jont'; the keys are schema, name"),
    (TABLE | {"joint": {}}, "joint must be a list of tables"),
    (TABLE | {"point": [3]}, "point 1 must be a table, found 3"),
    (TABLE | {"home": {"q3": 0.0}}, "home: no joint 'q3'; there are q1, q2"),
    (TABLE | {"home": 0}, "home must be a table, found 0"),
    (TABLE | {"home": {"q1": 10**400}}, "home: q1 must be a finite number"),
    (changed("joint", 0, origin=None), r"joint 1 \(q1\): origin is missing"),
    (changed("joint", 0, origin=[0, 0]), "origin must be 3 numbers"),
    (changed("joint", 0, origin=[0, "1", 0]), "origin must be a finite number, found '1'"),
    (changed("joint", 0, axis=[0, 0, 0]), "axis must be a direction"),
    (changed("joint", 1, parent="7"), "no frame '7' before it"),
    (changed("joint", 1, frame="1"), "'1' is used twice"),
    (changed("joint", 1, name="q1") | {"home": {}}, "'q1' is used twice"),
    (changed("boundary", 0, points=["6"]), r"boundary 1 \(B1\): points must be two names"),
    (changed("boundary", 0, used="no"), "used must be true or false, found 'no'"),
    (changed("boundary", 6, normal=[0, 0, 0]), "normal must be a direction"),
    (changed("body", 0, polygon=[[0, 0], [1, 0]]), "polygon must be three corners or more"),
]


@pytest.mark.parametrize(("table", "message"), WRONG, ids=[message for _, message in WRONG])
def test_a_wrong_file_has_one_error_that_names_file_and_key(table, message):
    with pytest.raises(ValueError, match=f"^arm.toml: .*{message}"):
        read_robot(table, "arm.toml")


@pytest.mark.parametrize(
    "table",
    [
        TABLE | {"collisions": "all"},
        TABLE | {"obstacle": []},
        changed("joint", 0, rpy=[0, 0, 0]),
        changed("joint", 0, type="continuous"),
        changed("point", 0, radius=1.0),
        changed("boundary", 0, type="bodies"),
        changed("boundary", 6, body="link 2"),
        changed("body", 0, disc={"at": [0, 0], "radius": 1}),
    ],
)
def test_a_file_of_the_engine_is_refused_in_one_sentence_that_names_its_reader(table):
    with pytest.raises(ValueError, match=r"cspace\.load_robot") as caught:
        read_robot(table, "arm.toml")
    assert str(caught.value).startswith("arm.toml: ")
    assert "\n" not in str(caught.value)
