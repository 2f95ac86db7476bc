"""Arms whose links overlap: what is said of them, judged by python-fcl on the links' own shapes.

Strangers sent these arms. Each was once called feasible, connected or harmless, and proved.
"""

from __future__ import annotations

import json
import math
import re
import shutil
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from cspace import check, load_robot
from cspace.arms.allowed import Contact, Spheres, allowed_collisions
from cspace.arms.fibres import fibres
from cspace.arms.links import lost_poses
from cspace.cli import main
from cspace.sampling import joint_ranges, keeps_clear
from cspace.urdf.arm import balls_inside, import_urdf
from cspace.urdf.covers import inner_depths
from cspace.urdf.document import Cuboid, Sphere, Triangles
from cspace.urdf.xml import Source
from engine_support import second_checker
from engine_support.commands import follows_schema
from engine_support.urdf import ring_mesh
from engine_support.urdf_judge import depth_or_gap

ARMS = Path(__file__).parent / "urdfs"

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
    for file in ARMS.glob("*.?rdf"):
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


# --- neighbours ---------------------------------------------------------------------------------


def meeting_angle(lower: float, higher: float) -> float:
    """Return where thigh and trunk of the torso come to touch, by halving with the judge."""
    pair = frozenset(("thigh", "trunk"))
    while higher - lower > 1e-6:
        middle = (lower + higher) / 2
        at = {"torso_1": 0.0, "torso_2": middle}
        overlap = depth_or_gap(ARMS / "torso.urdf", at)[pair] < 0
        lower, higher = (middle, higher) if overlap else (lower, middle)
    return higher


@pytest.mark.parametrize(
    "options", [{"neighbours": True}, {"srdf": ARMS / "torso.srdf"}], ids=["flag", "SRDF"]
)
def test_neighbours_are_kept_apart_if_asked_for_and_meet_at_their_angle(options) -> None:
    """The trunk folds into the thigh below -1.705 rad, within its limits."""
    true = meeting_angle(-2.618, 0.0)
    assert true == pytest.approx(-1.705, abs=1e-3)
    found = []
    for excess in (0.03, 0.018):
        robot = imported("torso", excess=excess, **options).robot
        assert ("thigh", "trunk") not in robot.unchecked
        (interval,) = fibres(robot, "torso_2", [0.0, 0.0])[0]
        assert {name.rpartition("/")[0] for name in interval.below.split(", ")} == {
            "thigh",
            "trunk",
        }
        found.append(interval.low)
    assert true < found[1] < found[0] < true + 0.35  # on the safe side, and the finer one nearer
    assert ("thigh", "trunk") in imported("torso", excess=0.02).robot.unchecked


def test_links_that_a_locked_joint_holds_in_each_other_are_named(tmp_path, capsys) -> None:
    """The trunk stood in the thigh, the pair was named nowhere, and each pose was feasible."""
    words = ["import", str(ARMS / "torso.urdf"), "-o", str(tmp_path / "arm.toml"), "--force"]
    said = "Not kept apart, because limits lock the joints between them, and balls meet: "
    for value, pairs in (("-150deg", "thigh and trunk."), ("0deg", None)):
        assert main([*words, "--limits", f"torso_2={value}..{value}"]) == 0
        told = [line for line in capsys.readouterr().out.splitlines() if line.startswith(said)]
        assert told == ([] if pairs is None else [said + pairs])


def test_an_srdf_keeps_a_post_and_its_neighbour_apart_and_the_flag_keeps_all(
    tmp_path, monkeypatch, capsys
) -> None:
    robot = imported("post", srdf=ARMS / "en_post.srdf").robot
    assert set(map(frozenset, robot.unchecked)) == {
        frozenset(pair) for pair in [("base", "upper"), ("upper", "lower"), ("base", "lower")]
    }
    monkeypatch.chdir(tmp_path)
    words = ["import", str(ARMS / "torso.urdf"), "--excess", "0.03", "-o", "torso.toml"]
    assert main([*words, "--neighbours"]) == 0
    assert "not kept apart" not in capsys.readouterr().out
    assert main(["contains", "torso.toml", "0", "-2.6rad"]) == 1
    assert "violated: thigh, trunk" in capsys.readouterr().out
    assert main(["contains", "torso.toml", "0", "-1rad"]) == 0
    assert main(words) == 0
    assert main(["contains", "torso.toml", "0", "-2.6rad"]) == 0
    assert "keeps them apart: pelvis and thigh; thigh and trunk" in capsys.readouterr().out
    assert load_robot(ARMS / "torso.urdf", neighbours=True).unchecked == ()


# --- what is proved of links, and what only of the spheres that cover them ------------------------


def judged(name: str, count: int = 80) -> dict[frozenset[str], list[float]]:
    """Return gaps of every two links at random joint values within the limits."""
    joints = imported(name).robot.joints
    rng, gaps = np.random.default_rng(7), dict[frozenset[str], list[float]]()
    for _ in range(count):
        at = {joint.name: rng.uniform(*joint.limits) for joint in joints}
        for pair, gap in depth_or_gap(ARMS / f"{name}.urdf", at).items():
            gaps.setdefault(pair, []).append(gap)
    return gaps


@pytest.mark.parametrize("name", ["peg", "camera", "tool", "post", "torso"])
def test_what_is_proved_of_two_links_holds_for_their_shapes(name) -> None:
    found = imported(name)
    gaps = judged(name)
    for each in allowed_collisions(found.robot, inside=balls_inside(found)):
        if each.contact is Contact.NEVER:
            assert min(gaps[frozenset(each.links)]) > 0
        elif each.contact is Contact.ALWAYS:
            assert max(gaps[frozenset(each.links)]) < 0


def test_a_pair_is_disabled_only_by_a_theorem_about_shapes(tmp_path, monkeypatch, capsys) -> None:
    """A turntable over a plate: its spheres always meet the plate's, its peg does at 7 %."""
    gaps = judged("peg", 361)
    share = np.mean(np.array(gaps[frozenset(("plate", "table"))]) <= 0)
    assert 0.04 < share < 0.1
    monkeypatch.chdir(tmp_path)
    shutil.copy(ARMS / "peg.urdf", tmp_path)
    assert main(["import", "peg.urdf", "-o", "peg.toml"]) == 0
    for file in ("peg.urdf", "peg.toml"):
        assert main(["allowed", file, "--srdf", "found.srdf", "--json", "found.json"]) == 0
        assert list(ET.parse("found.srdf").getroot()) == []
        content = json.loads(Path("found.json").read_text())
        follows_schema(content, "allowed")
        assert {row["contact"] for row in content["pairs"]} == {"not proved"}
        assert "not proved: spheres stick out of the links" in capsys.readouterr().out


def test_neighbours_that_share_a_place_on_the_axis_always_meet() -> None:
    """Five of the six neighbours of the UR5; upper arm and forearm stand 24.7 mm apart."""
    found = import_urdf("ur5.urdf", srdf="ur5.srdf", excess=0.02)
    rows = {r.links: r for r in allowed_collisions(found.robot, inside=balls_inside(found))}
    always = {links for links, row in rows.items() if row.contact is Contact.ALWAYS}
    names = ["base", "shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"]
    neighbours = {(f"{a}_link", f"{b}_link") for a, b in pairwise(names)}
    assert always == neighbours - {("upper_arm_link", "forearm_link")}
    apart = rows["upper_arm_link", "forearm_link"]
    assert (apart.spheres, apart.contact) == (Spheres.ALWAYS, Contact.UNPROVED)


SPHERES = "this is shown for the spheres that cover the links"


@pytest.mark.parametrize(
    ("words", "status", "on_spheres"),
    [
        ("contains arm.toml 0 0", 1, True),  # the plates are 8 mm apart, their spheres overlap
        ("contains arm.toml 2mm 0", 1, False),  # beyond a limit, whatever the spheres do
        ("why arm.toml 0 0 1mm 10deg", 1, True),
        ("why arm.toml 2mm 0 1mm 10deg", 1, False),
        ("certify arm.toml --box lift=0..0.001 turn=0..1", 1, True),
        ("fibre arm.toml turn 0 0", 1, True),
    ],
)
def test_what_spheres_show_is_not_said_of_links(
    tmp_path, monkeypatch, capsys, words, status, on_spheres
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["import", str(ARMS / "peg.urdf"), "--excess", "0.03", "-o", "arm.toml"]) == 0
    assert SPHERES[1:] in capsys.readouterr().out  # home is infeasible of the spheres
    json_too = ["--json", "a.json"] * words.startswith(("contains", "why"))
    assert main([*words.split(), *json_too]) == status
    assert (SPHERES in capsys.readouterr().out.replace("\n  ", " ")) == on_spheres
    if json_too:
        content = json.loads(Path("a.json").read_text())
        assert content.get("spheres_only", False) == on_spheres
        if words.startswith("why"):
            follows_schema(content, "why")


@pytest.mark.parametrize("seed", range(4))
def test_balls_inside_a_link_are_inside(seed) -> None:
    rng = np.random.default_rng(seed)
    found = import_urdf(
        ARMS / f"{['peg', 'camera', 'tool', 'post'][seed]}.urdf",
        chain=(None, [None, "lower", None, "lower"][seed]),
    )
    for point in balls_inside(found):
        directions = rng.normal(size=(200, 3))
        skin = point.at + point.radius * directions / np.linalg.norm(directions, axis=1)[:, None]
        (pose,) = (g[point.covers] for _, _, g in found.chain.rigid() if point.covers in g)
        inside = np.zeros(len(skin), dtype=bool)
        for shape in found.shapes[point.covers]:
            seen = pose.then(shape.pose).inverse().places(skin)
            inside |= inside_of(shape.solid, seen)
        assert inside.all()


def inside_of(solid, p) -> np.ndarray:
    """Tell which places are in a shape: written apart from the package."""
    if isinstance(solid, Sphere):
        return (p**2).sum(axis=1) <= solid.radius**2
    if isinstance(solid, Cuboid):
        return (2 * np.abs(p) <= solid.size).all(axis=1)
    flat = p[:, 0] ** 2 + p[:, 1] ** 2 <= solid.radius**2
    return flat & (2 * np.abs(p[:, 2]) <= solid.length)


def test_balls_inside_a_mesh_stay_below_its_surface() -> None:
    """A tube: in the wall there is room, and none in the bore; an open mesh encloses nothing."""
    tube = ring_mesh(0.08, 0.045, 0.03)
    places = np.random.default_rng(1).uniform(-0.1, 0.1, (2000, 3))
    depths = inner_depths(Triangles(tube, True, Source("", "")), places)
    rho = np.hypot(places[:, 0], places[:, 1])
    wall = np.minimum(np.minimum(0.08 - rho, rho - 0.045), 0.03 - np.abs(places[:, 2]))
    assert (depths[wall <= 0] <= 0).all()
    flat = 0.08 * (1 - np.cos(np.pi / 24))  # how far the sides of the tube are within its circles
    assert np.abs(depths - wall)[wall > flat].max() <= flat
    assert (inner_depths(Triangles(tube, False, Source("", "")), places) <= 0).all()


# --- what spheres cost ----------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["camera", "tool", "post"])
def test_the_share_of_poses_that_is_said_to_be_lost_is_a_bound(name) -> None:
    found = imported(name)
    robot = found.robot
    lost = lost_poses(robot, balls_inside(found))
    low, high = joint_ranges(robot).T
    poses = np.random.default_rng(0).uniform(low, high, (lost.poses, len(low)))  # the same ones
    refused = poses[~keeps_clear(robot, poses)]
    kept = {links_of(boundary) for boundary in robot.used}
    meet = 0
    for q in refused:
        at = dict(zip((joint.name for joint in robot.joints), q.tolist(), strict=True))
        gaps = depth_or_gap(ARMS / f"{name}.urdf", at)
        meet += any(gaps[pair] < 0 for pair in kept)
    assert lost.refused == len(refused)
    assert 0.7 * meet < lost.meet <= meet


def test_the_default_excess_follows_the_size_of_the_links(tmp_path, capsys) -> None:
    """At 2 cm a small arm had no free pose, and at 2 cm a large one has needless balls."""
    text, found = (ARMS / "post.urdf").read_text(), {}
    for scale in (0.1, 1.0, 10.0):

        def scaled(found: re.Match[str], scale: float = scale) -> str:
            numbers = " ".join(repr(scale * float(x)) for x in found[2].split())
            return f'{found[1]}="{numbers}"'

        lengths = r'(?<!axis )(xyz|size|radius)="([^"]*)"'
        larger = re.sub(lengths, scaled, text)
        file = tmp_path / f"{scale}.urdf"
        file.write_text(larger)
        words = ["import", str(file), "-o", str(tmp_path / "arm.toml")]
        assert main(words) == 0
        [said] = re.findall(
            r"balls refuse ([\d.]+) %;.* at most ([\d.]+) % are lost", capsys.readouterr().out
        )
        robot = import_urdf(file)
        found[scale] = (len(robot.robot.points), robot.excess / scale, *map(float, said))
    points, excess, refused, lost = np.array(list(found.values())).T
    assert (points == points[0]).all()
    assert excess == pytest.approx(excess[1], rel=0.05)
    assert np.ptp(refused) < 1
    assert (lost < 6).all()
