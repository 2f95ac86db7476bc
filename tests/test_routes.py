"""Routes by number and what they meet, without a command: names, stops, joints that are held."""

import csv
import io
import json
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest
from jsonschema import Draft202012Validator, validate
from numpy.testing import assert_allclose
from shapely.geometry import Polygon

from qbound import find_region, load_robot
from qbound.export.routes import route_csv, route_document, route_lines
from qbound.paths.encounters import report
from qbound.paths.trajectory import lasting
from qbound.paths.traversal import (
    nth_component,
    plan_route,
    reach,
)
from qbound.sampling import keeps_clear

MINERVA = load_robot("minervabot-v2")
REGION = find_region(MINERVA)
ARCS = [arc for loop in REGION.components[0].loops for arc in loop]
CORNERS = np.array([vertex.q for vertex in REGION.components[0].vertices])


def test_a_closed_route_visits_scaled_vertices_and_returns():
    route = plan_route(REGION, [3, 1, 2], closed=True, scale=0.5)
    centre = np.array(Polygon(CORNERS).centroid.coords[0])
    wanted = centre + 0.5 * (CORNERS[[2, 0, 1, 2]] - centre)
    assert_allclose(route.path.q[route.path.stops], wanted, atol=1e-12)
    assert route.stops == ("3", "1", "2", "3")
    assert route.legs == ("3 to 1", "1 to 2", "2 to 3")
    assert (route.order, route.along, route.scale) == ((3, 1, 2), "lines", 0.5)
    assert [route.leg_of(s) for s in (0, 0.9, 1.0, 3.0)] == ["3 to 1", "3 to 1", "1 to 2", "2 to 3"]


def test_arcs_are_run_either_way_and_lines_join_those_that_do_not_meet():
    route = plan_route(REGION, [2, -4], along="arcs", closed=True)
    assert route.legs == ("arc 2", "line to arc 4", "arc 4 backwards", "line to the start")
    assert route.stops == ("1", "2", "3", "4", "5")
    ends = [ARCS[1].points[0], ARCS[1].points[-1], ARCS[3].points[-1], ARCS[3].points[0]]
    assert_allclose(route.path.q[route.path.stops], [*ends, ends[0]], atol=1e-9)


def test_arcs_that_meet_need_no_line():
    whole = range(1, len(ARCS) + 1)
    route = plan_route(REGION, whole, along="arcs", closed=True)
    assert route.legs == tuple(f"arc {k}" for k in whole)


@pytest.mark.parametrize(
    ("order", "more", "words"),
    [
        ([1, 7], {}, "no vertex 7 in component 0: it has 6, numbered from 1"),
        ([-1, 2], {}, "no vertex -1"),
        ([1], {}, "two vertices or more"),
        ([], {"closed": True}, "two vertices or more"),
        ([1, 2], {"scale": 0}, "scale must be above 0, found 0"),
        ([1, 2], {"scale": np.nan}, "scale must be above 0, found nan"),
        ([1, 2], {"deviation": 0}, "deviation must be above 0"),
        ([1, 2], {"component": 5}, "no component 5; there are 5"),
        ([0], {"along": "arcs"}, "no arc 0"),
        ([1, -7], {"along": "arcs"}, "no arc 7"),
        ([], {"along": "arcs"}, "an arc or more"),
        ([1], {"along": "arcs", "component": -1}, "no component -1"),
        ([1], {"along": "roads"}, "no way along 'roads'; there are lines and arcs"),
        ([1], {"along": "arcs", "scale": 0.5}, "a scaled arc is none of the region's"),
    ],
)
def test_a_route_that_is_none_is_refused(order, more, words):
    with pytest.raises(ValueError, match=words):
        plan_route(REGION, order, **more)


def test_a_component_without_vertices_says_so():
    bare = replace(REGION, found=(replace(REGION.components[0], vertices=()),))
    with pytest.raises(ValueError, match="it has no vertex"):
        plan_route(bare, [1, 2])


def test_components_count_from_0():
    assert nth_component(REGION, 4) is REGION.components[4]


def test_the_default_deviation_is_a_ten_thousandth_of_the_stretched_arm():
    route = plan_route(REGION, [1, 2])
    turns = np.random.default_rng(1).uniform(-np.pi, np.pi, (1000, 2))
    places = MINERVA.frames(turns).position("0", "3", "0")
    assert np.linalg.norm(places, axis=1).max() <= MINERVA.stretched(MINERVA.tool)
    assert route.path.deviation <= 1e-4 * MINERVA.stretched(MINERVA.tool)


def test_a_held_joint_stays():
    first, held = replace(MINERVA.joints[0], parent="-1", frame="0"), {0: 0.3}
    three = replace(MINERVA, joints=(first, *MINERVA.joints), home=np.array([0.3, 0, 0]))
    route = plan_route(find_region(three, held), [1, 2])
    assert_allclose(route.path.q[:, 0], 0.3)
    assert np.ptp(route.path.q[:, 1:]) > 0


# --- what it meets --------------------------------------------------------------------------------


def test_a_route_is_feasible_where_every_place_of_it_is():
    """Round the component's corners, by a fine grid and the boundary functions alone."""
    answers = set()
    for k in range(1, 7):
        found = report(plan_route(REGION, [k, k % 6 + 1], scale=0.999))
        q = found.route.path.at(np.linspace(0, 1, 5001))
        assert found.feasible == keeps_clear(MINERVA, q).all()
        answers.add(found.feasible)
    assert answers == {True, False}


def test_the_largest_reach_is_that_of_a_far_finer_path():
    found = report(plan_route(REGION, [1, 4, 2, 6]))
    fine = reach(MINERVA, found.route.path.at(np.linspace(0, 3, 30_001))).max()
    assert fine <= found.largest_reach <= fine + 1e-4
    assert_allclose(reach(MINERVA, found.farthest.q), found.largest_reach)


def test_the_document_follows_its_schema_and_the_lines_say_the_same():
    route = plan_route(REGION, [1, 3, 2, 4], scale=0.9)
    found, times = report(route), lasting(MINERVA, route.path, 12)
    content = json.loads(json.dumps(route_document(found, times)))
    schema = resources.files("qbound") / "schemas" / "traverse.schema.json"
    validate(content, json.loads(schema.read_text(encoding="utf-8")), Draft202012Validator)
    lines = list(route_lines(found, times))
    assert content["order"] == [1, 3, 2, 4]
    assert content["duration"] == 12
    assert "12 s" in lines
    assert lines[0] == "3 legs: 1 to 3, 3 to 2, 2 to 4"
    for margin in content["margins"]:
        (line,) = (x for x in lines if x.startswith(f"smallest margin of {margin['boundary']}:"))
        assert f"{margin['margin']:.6g} {margin['unit']}, on {margin['at']['leg']}" in line
    crossed = [line for line in lines if line.startswith("the tool crosses")]
    assert len(crossed) == len(content["self_crossings"]) > 0
    outside = {line.split()[1] for line in lines if line.startswith("outside:")}
    assert outside == {m["boundary"] for m in content["margins"] if m["leaves"]}


def test_a_route_without_times_has_an_empty_column():
    route = plan_route(REGION, [1, 2], deviation=1.0)
    header, *rows = csv.reader(io.StringIO(route_csv(route)))
    assert header == ["t_s", "q1_rad", "q2_rad", "x_cm", "y_cm", "z_cm"]
    assert {row[0] for row in rows} == {""}
    assert_allclose([[float(x) for x in row[1:3]] for row in rows], route.path.q, rtol=0)
    assert route_document(report(route))["duration"] is None
