"""Arms whose links overlap: what is said of them, judged by python-fcl on the links' own shapes.

Strangers sent these arms. Each was once called feasible, connected or harmless, and proved.
"""

from __future__ import annotations

import json
import math
import shutil
from pathlib import Path

import pytest

from cspace import check
from cspace.cli import main
from cspace.urdf.arm import import_urdf
from engine_support import second_checker
from engine_support.commands import follows_schema
from engine_support.urdf_judge import depth_or_gap

ARMS = Path(__file__).parent / "overlaps"

FIXED = {  # what is fixed to a neighbour of the joint, and hits the other neighbour
    "camera": ({"srdf": ARMS / "camera.srdf"}, ("camera", "lower"), (0.0, -140.0)),
    "tool": ({}, ("upper", "screwdriver"), (0.0, 160.0)),
    "post": ({}, ("post", "upper"), (52.0, 0.0)),
}


def imported(name: str, **options: object):
    last = {"camera": "lower", "post": "lower"}.get(name)
    return import_urdf(ARMS / f"{name}.urdf", chain=(None, last), **options)


def links_of(boundary) -> frozenset[str]:
    return frozenset(name.rpartition("/")[0] for name in boundary.points)


@pytest.mark.parametrize("name", FIXED)
def test_a_link_that_is_fixed_to_a_neighbour_of_a_joint_is_kept_apart(name) -> None:
    options, pair, degrees = FIXED[name]
    robot = imported(name, **options).robot
    q = [math.radians(x) for x in degrees]
    at = dict(zip((joint.name for joint in robot.joints), q, strict=True))
    assert depth_or_gap(ARMS / f"{name}.urdf", at)[frozenset(pair)] < -0.01
    assert frozenset(pair) in {links_of(boundary) for boundary in robot.boundaries}
    assert frozenset(pair) not in map(frozenset, robot.unchecked)


@pytest.mark.parametrize(
    ("name", "q", "others"),
    [("camera", "0 -140deg", "0 0"), ("tool", "0 160deg", "0 0"), ("post", "52deg 0", "0 0")],
)
def test_every_answer_sees_the_fixed_link_and_repeats_what_it_does_not_look_at(
    tmp_path, monkeypatch, capsys, name, q, others
) -> None:
    for file in ARMS.iterdir():
        shutil.copy(file, tmp_path)
    monkeypatch.chdir(tmp_path)
    last = "" if name == "tool" else "--to lower"
    srdf = "--srdf camera.srdf" if name == "camera" else ""
    assert main(f"import {name}.urdf {last} {srdf} -o arm.toml".split()) == 0
    assert main(f"contains arm.toml {q} --json contains.json".split()) == 1
    assert main(f"why arm.toml {q} {others} --json why.json".split()) == 1
    out = capsys.readouterr().out
    pairs = imported(name, **FIXED[name][0]).robot.unchecked
    repeated = "; ".join(" and ".join(pair) for pair in pairs)
    line = f"not checked, because no boundary keeps them apart: {repeated}"
    assert out.count(line) == 2
    assert "connected" not in out
    assert "feasible" not in out.replace("infeasible", "")
    for file in ("contains", "why"):
        content = json.loads((tmp_path / f"{file}.json").read_text())
        assert content["left_out"] == {"pairs": [list(pair) for pair in pairs], "links": []}
    follows_schema(json.loads((tmp_path / "why.json").read_text()), "why")
    assert main(["certify", "arm.toml", "--box", "q1=0..0.01", "q2=0..0.01", "-o", "c.json"]) == 0
    capsys.readouterr()
    assert main(["check", "c.json", "arm.toml"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    for one, other in pairs:
        assert f"'{one}' and '{other}' apart" in said.partition("not claimed: ")[2]


def test_links_off_the_chain_are_named_by_every_answer(tmp_path, monkeypatch, capsys) -> None:
    """A robot file says which links it does not describe, and a certificate is bound to that."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(ARMS / "tool.urdf", tmp_path)
    text = (tmp_path / "tool.urdf").read_text().replace("</robot>", "")
    lamp = '<link name="lamp"><collision><geometry><sphere radius="0.1"/></geometry></collision>'
    hangs = '<parent link="upper"/><child link="lamp"/><limit lower="-1" upper="1"/></joint>'
    (tmp_path / "lamp.urdf").write_text(
        f'{text}{lamp}</link><joint name="l" type="revolute">{hangs}</robot>'
    )
    assert main(["import", "lamp.urdf", "--to", "screwdriver", "-o", "arm.toml"]) == 0
    assert 'left_out = ["lamp"]' in (tmp_path / "arm.toml").read_text()
    assert main(["contains", "arm.toml", "0", "0", "--json", "a.json"]) == 0
    assert "not checked, because not in the file: lamp" in capsys.readouterr().out
    assert json.loads((tmp_path / "a.json").read_text())["left_out"]["links"] == ["lamp"]
    assert main(["certify", "arm.toml", "--box", "q1=0..0.01", "q2=0..0.01", "-o", "c.json"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "links that the file does not describe: ['lamp']" in said
    bare = (tmp_path / "arm.toml").read_text().replace('left_out = ["lamp"]\n', "")
    (tmp_path / "bare.toml").write_text(bare)
    assert main(["check", "c.json", "arm.toml"]) == 0
    assert main(["check", "c.json", "bare.toml"]) == 2
    text = (tmp_path / "arm.toml").read_text()
    assert check.normal_form(text, {}) == second_checker.normal_form(text, {})
