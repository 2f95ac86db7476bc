"""What was found, as others read it: outlines, samples, workspaces, proofs; units and words."""

import csv
import io
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from shapely.geometry import shape

from cspace import find_region, load_robot
from cspace.export.document import workspace_document, workspace_lines
from cspace.export.outlines import find_outlines, outlines_csv, outlines_geojson, outlines_npz
from cspace.geometry.arcs import last_before
from cspace.proofs.certificates.statements import joint_decimal, limits_as_decimals
from cspace.region import solve
from cspace.units import file_units, joint_text, joint_units, parse_joint_value
from cspace.workspace.areas import workspace_report
from engine_support.commands import follows_schema
from engine_support.forms import PP, forms
from engine_support.regions import problem_of

MINERVA = load_robot("minervabot-v2")
BOOM = load_robot("rp-telescopic-boom")
REGION = find_region(MINERVA)


# --- units ----------------------------------------------------------------------------------------


def test_units_are_rad_and_length_inside_and_the_files_own_outside():
    assert joint_units(MINERVA) == ["rad", "rad"]
    assert joint_units(BOOM) == ["rad", BOOM.length_unit]
    assert file_units(MINERVA) == [MINERVA.angle_unit] * 2
    assert file_units(BOOM) == [BOOM.angle_unit, BOOM.length_unit]


@given(st.floats(-1e4, 1e4))
def test_a_joint_value_is_read_as_it_is_meant(x):
    assert parse_joint_value(MINERVA, 0, f" {x!r}deg ") == np.radians(x)
    assert parse_joint_value(MINERVA, 0, f"{x!r}rad") == x
    assert parse_joint_value(MINERVA, 0, f"{x!r}") == np.radians(x), "the file's angles are degrees"
    assert parse_joint_value(BOOM, 1, f"{x!r}") == x


@pytest.mark.parametrize(
    "text", ["", "x", "nan", "inf", "1e999", "20degdeg", "20 cm", "__import__"]
)
def test_what_is_no_joint_value_is_refused_by_name(text):
    with pytest.raises(ValueError, match=r"q2: .* is no value"):
        parse_joint_value(MINERVA, 1, text)


def test_joint_values_are_written_in_the_files_units():
    assert joint_text(MINERVA, [np.pi / 6, -1.0]) == "q1 = 30 deg, q2 = -57.2958 deg"
    assert joint_text(BOOM, [0.25], [1]) == f"slide = 0.25 {BOOM.length_unit}"


# --- bisection ------------------------------------------------------------------------------------


@given(st.lists(st.floats(-10, 10), min_size=1, max_size=5))
def test_bisection_ends_on_both_sides_of_each_change(changes):
    places = np.array(changes)
    low, high = last_before(lambda x: x <= places, places - 1, places + 2)
    assert (low <= places).all()
    assert (high > places).all()
    assert_allclose(high, low, rtol=1e-15, atol=1e-14)


def test_bisection_of_nothing_asks_nothing():
    low, high = last_before(lambda _: pytest.fail("asked"), [], [])
    assert len(low) == len(high) == 0


# --- outlines -------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["minervabot-v2", "rp-telescopic-boom", "pr-gantry-arm"])
def test_outlines_have_the_areas_of_their_components_in_each_format(name):
    robot = load_robot(name)
    region = find_region(robot)
    drawn = find_outlines(region, 1e-3)
    features = outlines_geojson(drawn)["features"]
    assert len(features) == len(region.components)
    for feature, component in zip(features, region.components, strict=True):
        outline, told = shape(feature["geometry"]), feature["properties"]
        assert 0 < told["deviation"] <= 1e-3
        assert (told["area"], told["contains_home"]) == (component.area, component.contains_home)
        assert outline.is_valid
        assert abs(outline.area - component.area) <= told["deviation"] * outline.length
        assert told["joints"] == [joint.name for joint in robot.joints]
        assert told["unit"] == joint_units(robot)
        around = [robot.joints[j].name for j in (0, 1) if component.wraps[j]]
        assert told["wraps"] == around
        listed = [each for each in told.values() if isinstance(each, list)]
        assert {type(x) for each in listed for x in each} == {str}  # what GeoPandas reads
    with np.load(io.BytesIO(outlines_npz(drawn)), allow_pickle=False) as arrays:
        rings = [arrays["points"][a:b] for a, b in pairwise(arrays["start"])]
        numbers = np.stack([arrays[key] for key in ("component", "piece", "ring")], axis=1)
    rows = np.array(list(csv.reader(io.StringIO(outlines_csv(drawn))))[1:], dtype=float)
    assert_allclose(rows[:, 3:5], np.concatenate(rings), rtol=0)
    assert_allclose(rows[:, :3], np.repeat(numbers, [len(ring) for ring in rings], axis=0))
    for (c, p, r), ring in zip(numbers, rings, strict=True):
        told = features[c]["geometry"]["coordinates"][p][r]
        assert told[0] == told[-1]
        assert_allclose(told[:-1], ring, rtol=0)


def test_holes_that_touch_along_a_slit_leave_valid_polygons():
    """The component goes round a joint too, and a hole touches the ring about it."""
    region = find_region(load_robot(Path(__file__).with_name("once_wrong") / "slit-and-round.toml"))
    drawn = region.to_shapely(1e-3)
    assert drawn.is_valid
    assert len(drawn.geoms) == 2
    assert drawn.area == pytest.approx(region.area, abs=1e-2)
    (feature,) = outlines_geojson(find_outlines(region))["features"]
    assert shape(feature["geometry"]).area == pytest.approx(region.area, abs=1e-2)


def test_components_that_touch_along_a_line_are_no_valid_polygons_and_it_is_said():
    region = solve(problem_of(forms(PP, {"20": 1}), ((-1.0, 1.0), (-1.0, 1.0))))
    with pytest.warns(UserWarning, match="not valid for shapely: Self-intersection"):
        assert not region.to_shapely().is_valid


# --- workspaces -----------------------------------------------------------------------------------


def test_a_report_on_a_workspace_says_what_was_asked():
    poses = [(0, 0), (0, np.radians(170))]
    found = workspace_report(REGION, [(-45.0, 20.0), (0.0, 40.0)], poses)
    assert [at.safe for at in found.places] == [1, 0]
    assert not found.passage.possible
    assert not found.all_safe
    content, lines = workspace_document(found), list(workspace_lines(found))
    follows_schema(content, "workspace")
    assert "at (-45, 20) cm: 1 posture in home's component" in lines
    assert "go: no, from component 0 to component 1" in lines
    assert len(content["at"][0]["postures"]) == 2
    names = {arc["boundary"] for loop in content["go"]["separated_by"] for arc in loop["arcs"]}
    (walls,) = (line for line in lines if "every path crosses" in line)
    assert set(walls.split(" of ")[1].split(", ")) == names


def test_a_report_without_questions_is_safe():
    found = workspace_report(REGION)
    assert found.all_safe
    assert workspace_document(found)["go"] is None
    assert workspace_report(REGION, poses=[(0, 0), (0, 0.1)]).all_safe


# --- points of statements -------------------------------------------------------------------------


def test_decimals_in_the_files_unit_stay_as_they_are_written():
    assert joint_decimal(MINERVA, 0, " 20.50 ") == "20.50"
    assert joint_decimal(MINERVA, 0, "20.50deg") == "20.50"
    assert joint_decimal(MINERVA, 0, "0.5rad") == "28.647889756541"
    assert limits_as_decimals(BOOM, 1) == ("0", "2.6")
    assert limits_as_decimals(MINERVA, 0) is None
