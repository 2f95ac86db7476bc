"""The command: what is promised on standard output, in files and as exit status."""

from __future__ import annotations

import json
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace import packaged_robots
from cspace.__main__ import start
from cspace.model.robotfile import robot_text
from engine_support.commands import follows_schema, run


def test_region_writes_the_promised_json_and_nothing_else(capsys):
    status, out, err = run(capsys, "region", "minervabot-v2", "--json", "-")
    content = json.loads(out)
    assert (status, err) == (0, "")
    follows_schema(content, "region")
    assert content["joints"] == ["q1", "q2"]
    assert content["home"] == {"q": [0.0, 0.0], "feasible": True, "violated": []}
    areas = [component["area"] for component in content["components"]]
    assert content["components"][0]["contains_home"]
    assert areas[1:] == sorted(areas[1:], reverse=True)
    assert_allclose(sum(areas), content["feasible_area"])
    for component in content["components"]:
        for loop in component["loops"]:
            arcs = loop["arcs"]
            for before, arc in zip([arcs[-1], *arcs[:-1]], arcs, strict=True):
                assert_allclose(before["to"], arc["from"], atol=1e-6)


REASONS = "near 0.3: more coincides than 1024 bits tell", "near 0.7: the same"


@pytest.fixture
def unresolved(monkeypatch):
    """Over neither joint a region is found that verifies itself."""
    from cspace.region import region

    monkeypatch.setattr(region, "looked_over", lambda found: ([REASONS[found.base]], []))


@pytest.mark.parametrize(
    "words",
    [
        ["region", "ROBOT", "--svg", "FILE.svg"],
        ["region", "ROBOT", "--geojson", "FILE.json"],
        ["workspace", "ROBOT"],
        ["explore", "ROBOT", "-o", "FILE.html"],
        ["draw", "ROBOT", "-o", "FILE.svg"],
        ["certify", "ROBOT", "--region"],
        ["traverse", "ROBOT", "1", "2"],
    ],
    ids=lambda words: f"{words[0]} {words[2] if len(words) > 2 else ''}",
)
def test_what_needs_the_components_of_an_unresolved_region_is_undecided(
    capsys, tmp_path, unresolved, words
):
    given = {"ROBOT": "minervabot-v2"}
    words = [given.get(w, w.replace("FILE", str(tmp_path / "file"))) for w in words]
    status, out, err = run(capsys, *words)
    assert (status, out, err.count("\n")) == (3, "", 1)
    assert "this region is unresolved" in err
    assert all(reason in err for reason in REASONS)
    assert not list(tmp_path.iterdir())


def test_an_unresolved_region_is_told_and_written(capsys, tmp_path, unresolved):
    target = tmp_path / "region.json"
    status, out, err = run(capsys, "region", "minervabot-v2", "--json", str(target))
    assert (status, err) == (3, "")
    assert out.startswith(f"this region is unresolved: {REASONS[0]}; {REASONS[1]}\n")
    content = json.loads(target.read_text())
    follows_schema(content, "region")
    assert content["unresolved"] == list(REASONS)
    assert (content["components"], content["feasible_area"]) == ([], None)
    assert content["home"] == {"q": [0.0, 0.0], "feasible": True, "violated": []}


def test_a_configuration_of_an_unresolved_region_has_margins(capsys, unresolved):
    status, out, err = run(capsys, "contains", "minervabot-v2", "20deg", "-45deg")
    assert (status, err) == (0, "")
    assert "margin 11.687 cm: B1" in out
    assert f"because the region is unresolved: {REASONS[0]}; {REASONS[1]}" in out
    _, out, _ = run(capsys, "contains", "minervabot-v2", "20deg", "-45deg", "--json", "-")
    follows_schema(json.loads(out), "contains")
    assert run(capsys, "contains", "minervabot-v2", "1.5rad", "0")[0] == 1


def test_why_goes_on_where_the_region_is_unresolved(capsys, unresolved):
    words = ["minervabot-v2", "-2.6rad", "0.2rad", "1.6rad", "-2.3rad"]
    status, out, _ = run(capsys, "why", *words)
    assert status == 1
    assert "a paving of q1, q2" in out


def test_boundaries_that_coincide_are_named_in_an_arc(tmp_path, capsys):
    text, _ = robot_text("minervabot-v2")
    again = (
        'name = "B7 again"\ntype = "half-space"\npoint = "3"\nnormal = [0, 0, 1]\noffset = 11.32'
    )
    arm = tmp_path / "arm.toml"
    arm.write_text(f"{text}\n[[boundary]]\n{again}\n")
    contents = {}
    for command in ("region", "workspace"):
        status, out, _ = run(capsys, command, str(arm), "--json", "-")
        assert status == 0
        contents[command] = json.loads(out)
        follows_schema(contents[command], command)
    loops = [loop for c in contents["region"]["components"] for loop in c["loops"]]
    arcs = [arc for loop in loops for arc in loop["arcs"]]
    named = {arc["boundary"]: arc.get("also") for arc in arcs}
    assert {name for name, also in named.items() if also} == {"B7"}
    assert named["B7"] == [["B7 again", ""]]


@pytest.mark.filterwarnings("ignore:.*turns wide")
def test_contains_does_not_wait_for_a_region_of_many_turns(capsys, tmp_path, monkeypatch):
    text, _ = robot_text("pr-gantry-arm")
    wide = text.replace('type = "revolute"', 'type = "revolute"\nlimits = [-1500, 1500]')
    assert wide != text
    (tmp_path / "arm.toml").write_text(wide)
    words = ("contains", str(tmp_path / "arm.toml"), "0.9", "0")
    assert "nearest boundary: " in run(capsys, *words, "--all")[1]
    monkeypatch.setattr("cspace.export.configuration.find_region", None)
    status, out, _ = run(capsys, *words)
    assert status == 0
    assert "component and nearest boundary are not looked for: limits of " in out


def test_contains_says_component_margins_and_the_nearest_boundary(capsys):
    status, out, _ = run(capsys, "contains", "minervabot-v2", "0", "0")
    lines = out.splitlines()
    assert status == 0
    where = "in component 0 (of 5, counted from 0), with the home pose"
    assert lines[0] == f"feasible by points, {where}"
    margins = [float(line.split()[1]) for line in lines if line.startswith("  margin")]
    assert len(margins) == 5
    assert margins == sorted(margins)
    assert lines[1] == "  at q1 = 0 deg, q2 = 0 deg"
    assert lines[2].endswith("cm: B3")
    assert lines[-3].startswith("nearest boundary: B3 at q1 = ")
    assert lines[-3].endswith("q2 = 43.8598 deg, distance 43.8598 deg")


def test_contains_names_two_bodies_and_their_features(capsys):
    arm = "two-links-on-a-table"
    status, out, _ = run(capsys, "contains", arm, "30deg", "0")
    assert status == 1
    violated, _, beside, *_ = out.splitlines()
    assert violated == (
        "violated: forearm, post, margin -0.0565064 m (edge 0 of forearm overlaps corner 0 of post)"
    )
    assert beside.endswith(
        " m: upper arm, post (corner 1 of upper arm is nearest to corner 0 of post)"
    )
    status, out, _ = run(capsys, "contains", arm, "30deg", "0", "--json", "-")
    deepest = json.loads(out)["margins"][0]
    assert (deepest["between"], deepest["features"]) == (
        ["forearm", "post"],
        ["edge 0", "corner 0"],
    )
    follows_schema(json.loads(out), "contains")
    places = np.array(deepest["places"])
    assert np.linalg.norm(places[1] - places[0]) == pytest.approx(-deepest["distance"])


def test_contains_writes_json(capsys):
    status, out, _ = run(
        capsys, "contains", "rp-telescopic-boom", "-35", "0.1", "--weights", "2", "1", "--json", "-"
    )
    content = json.loads(out)
    follows_schema(content, "contains")
    assert content["units"]["joints"] == ["rad", "m"]
    assert (status, content["feasible"], content["component"]) == (0, True, 0)
    assert content["nearest"]["boundary"] == "slide.lower"
    assert_allclose(content["nearest"]["distance"], 0.1)
    assert content["nearest"]["weights"] == [2.0, 1.0]
    status, out, _ = run(capsys, "contains", "rp-telescopic-boom", "-35", "-0.1", "--json", "-")
    content = json.loads(out)
    follows_schema(content, "contains")
    assert (status, content["feasible"], content["component"]) == (1, False, None)
    assert content["margins"][0] == {"boundary": "slide.lower", "margin": -0.1}


def test_robots_lists_and_shows(capsys):
    assert run(capsys, "robots")[1].split() == list(packaged_robots())
    assert 'name = "MinervaBotV2"' in run(capsys, "robots", "show", "minervabot-v2")[1]


@pytest.fixture
def unsafe(tmp_path):
    """The packaged robot, its home pose below the floor."""
    file = tmp_path / "arm.toml"
    file.write_text(robot_text("minervabot-v2")[0].replace("q1 = 0.0", "q1 = 120.0"))
    return str(file)


def test_an_unsafe_home_pose_is_an_answer_without_a_workspace_and_says_why(capsys, unsafe):
    status, out, _ = run(capsys, "region", unsafe, "--json", "-")
    content = json.loads(out)
    assert status == 1
    assert content["home_component"] is None
    assert [v["boundary"] for v in content["home"]["violated"]] == ["B7"]
    assert len(content["components"]) == 5
    assert content["workspace"] is None
    assert "home pose" in content["workspace_reason"]
    assert run(capsys, "workspace", unsafe)[0] == 1


def test_workspace_writes_the_promised_json_and_nothing_else(capsys):
    status, out, err = run(
        capsys, "workspace", "minervabot-v2", "--at=-45,20", "--go", "0,0", "0,20deg", "--json", "-"
    )
    content = json.loads(out)
    assert (status, err) == (0, "")
    follows_schema(content, "workspace")
    found = content["workspace"]
    assert_allclose(sum(found["sides"].values()), found["area"] + found["covered_twice"])
    assert content["at"][0]["safe_postures"] == 1
    assert content["go"]["possible"]
    region = json.loads(run(capsys, "region", "minervabot-v2", "--json", "-")[1])
    assert region["workspace"] == {key: found[key] for key in ("area", "covered_twice")}


def test_a_place_or_a_passage_that_is_not_safe_is_status_1(capsys):
    assert run(capsys, "workspace", "minervabot-v2", "--at", "0,40")[0] == 1
    status, out, _ = run(capsys, "workspace", "minervabot-v2", "--go", "0,0", "0,170deg")
    assert status == 1
    assert "go: no, from component 0 to component 1" in out
    assert "every path crosses the loop of" in out


def test_the_first_of_several_values_may_follow_an_equals_sign(capsys):
    apart = run(capsys, "workspace", "minervabot-v2", "--go", "-10deg,-20deg", "0,-5deg")
    joined = run(capsys, "workspace", "minervabot-v2", "--go=-10deg,-20deg", "0,-5deg")
    assert joined == apart
    assert "go: yes, from component 0 to component 0" in joined[1]


def test_ctrl_c_while_the_command_is_loaded_is_no_fault_of_ours(capsys, monkeypatch):
    class Stopped:
        """Finds nothing: it is stopped."""

        def find_spec(self, *_):
            raise KeyboardInterrupt

    monkeypatch.delitem(sys.modules, "cspace.cli")
    monkeypatch.setattr(sys, "meta_path", [Stopped()])
    status = start()
    monkeypatch.undo()
    assert (status, capsys.readouterr()) == (130, ("", "cspace: stopped\n"))
    pyproject = Path(__file__).parents[1] / "pyproject.toml"
    scripts = tomllib.loads(pyproject.read_text(encoding="utf-8"))["project"]["scripts"]
    assert scripts == {"cspace": "cspace.__main__:start"}
