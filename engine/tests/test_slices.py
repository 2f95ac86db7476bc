"""A row of slices: each is its own region; the command, the strip of panels, the page's slider."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from cspace import find_region, find_slices, save_robot
from cspace.explorer.data import figure_data
from cspace.figures.pictures import strip_picture
from engine_support.arms import three_joints
from engine_support.commands import follows_schema, run

HELD = {"q3": -0.2}
STRIP = ["--strip", "q3=-1.2..0.8:3"]


@pytest.fixture(scope="module")
def arm():
    return three_joints()


@pytest.fixture(scope="module")
def row(arm):
    return find_slices(arm, "q3", [0.8, -0.2, -1.2])


@pytest.fixture
def file(arm, tmp_path):
    path = tmp_path / "arm.toml"
    save_robot(arm, path)
    return str(path)


def test_every_slice_is_the_region_of_its_value(arm, row):
    expected = [find_region(arm, {2: value}).area for value in (0.8, -0.2, -1.2)]
    assert row.areas.tolist() == expected
    assert [row.holds_home(k) for k in range(3)] == [False, True, False]
    assert repr(row).startswith("<3 slices along 'q3': areas ")


@pytest.mark.parametrize(
    ("along", "values", "held", "message"),
    [
        ("q9", [0.0], {}, "no joint 'q9'"),
        ("q3", [0.0], {"q3": 0.0}, "joint 'q3' is held, and slices go along it"),
        ("q3", [0.0], {"q2": 0.0}, "1 that are not held"),
        ("q3", [float("nan")], {}, "finite"),
        ("q3", [], {}, "1 to 1000 values"),
        ("q3", [[0.0]], {}, r"found shape \(1, 1\)"),
    ],
)
def test_what_cannot_be_cut_is_refused_by_name(arm, along, values, held, message):
    with pytest.raises(ValueError, match=message):
        find_slices(arm, along, values, held)


# --- the command -------------------------------------------------------------------------------


def test_a_strip_is_written_as_its_schema_says(capsys, file, tmp_path, arm):
    target = tmp_path / "strip.json"
    status, out, err = run(capsys, "region", file, *STRIP, "--json", str(target))
    content = json.loads(target.read_text())
    follows_schema(content, "slices")
    assert (status, err) == (0, "")
    assert (content["joints"], content["along"]) == (["q1", "q2"], "q3")
    values = [each["value"] for each in content["slices"]]
    assert_allclose(values, [-1.2, -0.2, 0.8])
    areas = [each["feasible_area"] for each in content["slices"]]
    assert_array_equal(areas, [find_region(arm, {2: value}).area for value in values])
    lines = out.splitlines()
    assert len(lines) == 5
    assert lines[1].endswith(", home lies here")
    assert lines[3].startswith("feasible means allowed by the points of this file")
    assert lines[4] == f"written: {target}"


def test_a_strip_has_a_panel_for_each_slice(row):
    drawn = strip_picture(row)
    assert [drawn.count(f'<g id="axes_{k}">'.encode()) for k in (1, 2, 3, 4)] == [1, 1, 1, 0]


def test_a_strip_of_empty_slices_names_what_leaves_no_room(capsys, arm, tmp_path):
    wrist = replace(arm.joints[2], limits=(-1.0, 1.0))
    save_robot(replace(arm, joints=(*arm.joints[:2], wrist)), tmp_path / "arm.toml")
    status, out, _ = run(capsys, "region", str(tmp_path / "arm.toml"), "--strip", "q3=2..3:2")
    assert status == 1
    assert out.splitlines()[0] == "q3 = 2 rad: no room is left by q3.upper"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--strip", "q3=-1..1"], "wanted NAME=LOW..HIGH:COUNT"),
        (["--strip", "q3=-1..x:3"], "'x' is no value"),
        (["--strip", "q3=1..-1:3"], "the lower end first"),
        (["--strip", "q3=-1..1:1"], "from 2 to 100 values"),
        (["--strip", "q3=-1..1:1000000000"], "from 2 to 100 values"),
        (["--strip", "q8=-1..1:3"], "no joint 'q8'"),
        (["--strip", "q8"], "no joint 'q8'"),
        (["--slice", "q3=0", *STRIP], "'q3' is held by --slice"),
        ([*STRIP, "--csv", "x.csv"], "polygons are of one region"),
    ],
)
def test_a_strip_that_is_not_one_is_refused(capsys, file, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.iterdir())
    status, out, err = run(capsys, "region", file, *words)
    assert (status, out) == (2, "")
    assert message in err
    assert sorted(tmp_path.iterdir()) == before


# --- the page ----------------------------------------------------------------------------------


def test_the_page_is_told_every_slice_by_rising_value(arm, row):
    data = figure_data(find_region(arm, HELD), row=row)["row"]
    assert (data["joint"], data["value"]) == ("q3", HELD["q3"])
    assert [one["value"] for one in data["slices"]] == [-1.2, -0.2, 0.8]
    areas = [sum(c["area"] for c in one["regions"]) for one in data["slices"]]
    assert areas == row.areas[::-1].tolist()


def test_a_row_of_other_slices_is_refused(arm, row):
    with pytest.raises(ValueError, match="none of the slices"):
        figure_data(find_region(arm, {"q3": 0.1}), row=row)
    with pytest.raises(ValueError, match="other joints"):
        figure_data(find_region(arm, {"q1": 0.3}), row=row)
    with pytest.raises(ValueError, match="other joints"):
        figure_data(find_region(replace(arm, clearance=0.5), HELD), row=row)
    assert figure_data(find_region(replace(arm), HELD), row=row)["row"] is not None


def test_explore_opens_at_one_of_the_slices(capsys, file, tmp_path):
    page = tmp_path / "arm.html"
    status, _, err = run(capsys, "explore", file, "--strip", "q3=-1..1:3", "-o", str(page))
    text = page.read_text(encoding="utf-8")
    assert (status, err) == (0, "")
    data = json.loads(text.split('id="robot-data">')[1].split("</script>")[0])
    assert np.allclose([one["value"] for one in data["row"]["slices"]], [-1, -0.2, 0, 1])
    assert data["row"]["value"] == -0.2
