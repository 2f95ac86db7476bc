"""URDFs: what they say is what the robot does, and what is wrong with one is said with its line."""

from __future__ import annotations

import re
import sys
from importlib import resources
from pathlib import Path

import numpy as np
import pytest
from trimesh.convex import convex_hull
from trimesh.creation import box as mesh_of_a_box

from cspace import RobotFileError, check, load_robot, save_robot
from cspace.arms.links import links
from cspace.cli import main
from cspace.geometry.covering import Cover, few, fewer, uncovered, within
from cspace.geometry.mesh_solids import as_box, convex_solid
from cspace.geometry.solid_covers import box_cover, capsule_cover, cylinder_cover, mesh_cover
from cspace.region import violated
from cspace.urdf.arm import EXCESS_PART, MANY_PAIRS, import_urdf, robot_text
from cspace.urdf.covers import size_of
from engine_support.urdf import (
    BALL,
    joint,
    link,
    ring_mesh,
    rotation,
    three_links,
    transform,
    written,
)

OWN = {"ur5": ("ur5.srdf", 0.01), "panda": ("panda.srdf", None), "scara": ("scara.srdf", None)}


def test_shapes_for_contacts_between_links_are_not_read_and_this_is_said(tmp_path) -> None:
    """Makers of arms write larger capsules there; they were skipped in silence."""
    capsule = "<geometry><capsule radius='0.2' length='0.5'/></geometry>"
    own = f"<self_collision_checking>{capsule}</self_collision_checking>"
    ends = joint("j", "a", "b"), joint("k", "b", "c")
    plain = written(tmp_path, *(link(name, BALL) for name in "abc"), *ends, name="plain.urdf")
    links = link("a", BALL), link("b", BALL + own), link("c", BALL + own)
    with pytest.warns(UserWarning, match=r"<self_collision_checking> of b, c is not read"):
        robot = load_robot(written(tmp_path, *links, *ends))
    assert robot == load_robot(plain)


# --- kinematics -----------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_places_are_those_of_a_chain_of_matrices(tmp_path, seed) -> None:
    rng = np.random.default_rng([520, seed])
    kinds = ["revolute", "fixed", "prismatic", "continuous", "fixed", "revolute"]
    rng.shuffle(kinds)
    parts, steps = [link("l0", BALL)], []
    for i, kind in enumerate(kinds, start=1):
        xyz, rpy, axis = rng.uniform(-0.4, 0.4, (3, 3)) * [[1], [5], [1]]
        texts = [" ".join(map(repr, v.tolist())) for v in (xyz, rpy, axis)]
        more = f"<origin xyz='{texts[0]}' rpy='{texts[1]}'/><axis xyz='{texts[2]}'/>"
        parts += [link(f"l{i}", BALL), joint(f"q{i}", f"l{i - 1}", f"l{i}", kind, more)]
        x, y, z = np.eye(3)
        mount = rotation(z, rpy[2]) @ rotation(y, rpy[1]) @ rotation(x, rpy[0])
        steps.append((kind, transform(mount, xyz), axis))
    robot = load_robot(written(tmp_path, *parts))
    assert [j.name for j in robot.joints] == [
        f"q{i}" for i, kind in enumerate(kinds, start=1) if kind != "fixed"
    ]
    assert [j.limits for j in robot.joints if j.turns].count(None) == 1
    q = rng.uniform(-1, 2, len(robot.joints))
    frames, values, pose = robot.frames(q), iter(q), np.eye(4)
    for i, (kind, mount, axis) in enumerate(steps, start=1):
        pose = pose @ mount
        if kind == "prismatic":
            pose = pose @ transform(np.eye(3), next(values) * axis / np.linalg.norm(axis))
        elif kind != "fixed":
            pose = pose @ transform(rotation(axis, next(values)), np.zeros(3))
        found = frames.position("l0", f"l{i}/1", "l0")
        assert np.abs(found - pose[:3, 3]).max() < 1e-5  # centres are short decimals
        if i == len(steps):
            tool = frames.position("l0", robot.tool, "l0")
            assert np.abs(tool - pose[:3, 3]).max() < 1e-13


@pytest.mark.parametrize("name", OWN)
def test_our_arms_are_feasible_at_home_and_survive_their_file(name, tmp_path) -> None:
    srdf, excess = OWN[name]
    imported = import_urdf(f"{name}.urdf", srdf=srdf, excess=excess)
    robot = imported.robot
    assert violated(robot, robot.home) == []
    solids = [shape.solid for shapes in imported.shapes.values() for shape in shapes]
    assert imported.excess <= (excess or EXCESS_PART * max(map(size_of, solids)))
    file = tmp_path / "arm.toml"
    file.write_text(robot_text(imported), encoding="utf-8")
    assert load_robot(file) == robot


def test_the_packaged_ur5_is_what_the_import_makes() -> None:
    made = robot_text(import_urdf("ur5.urdf", srdf="ur5.srdf", excess=0.01))
    kept = resources.files("cspace") / "robots" / "ur5.toml"
    first, _, text = made.partition("\n")
    assert first.startswith("# Made by cspace import")
    assert kept.read_text(encoding="utf-8").partition("\n")[2] == text  # its first line is older
    assert len(made.splitlines()) < 300


def test_the_ur5_reaches_where_its_published_parameters_say() -> None:
    d1, a2, a3, d4, d5, d6 = 0.089159, -0.425, -0.39225, 0.10915, 0.09465, 0.0823
    robot = load_robot("ur5")
    rng = np.random.default_rng(2)
    for q in rng.uniform(-np.pi, np.pi, (20, 6)):
        pose = np.eye(4)
        table = [(d1, 0, np.pi / 2), (0, a2, 0), (0, a3, 0), (d4, 0, np.pi / 2)]
        table += [(d5, 0, -np.pi / 2), (d6, 0, 0)]
        for theta, (d, a, alpha) in zip(q, table, strict=True):
            pose = pose @ transform(rotation(np.array([0, 0, 1.0]), theta), np.array([0, 0, d]))
            pose = pose @ transform(rotation(np.array([1.0, 0, 0]), alpha), np.array([a, 0, 0]))
        found = robot.frames(q).position("base_link", "tool0", "base_link")
        # The URDF's base is turned by half a turn against that of the published table.
        assert np.abs(found - pose[:3, 3] * [-1, -1, 1]).max() < 1e-12


# --- links, pairs, chains -------------------------------------------------------------------------


def test_pairs_are_those_of_links_that_no_joint_joins_directly(tmp_path) -> None:
    parts = [link(n, BALL) for n in ("a", "b", "c", "d", "hand", "lamp")]
    parts += [joint("j1", "a", "b"), joint("j2", "b", "c"), joint("j3", "c", "d")]
    parts += [joint("h", "d", "hand", "fixed"), joint("l", "a", "lamp", "fixed")]
    robot = load_robot(written(tmp_path, *parts), chain=("a", "hand"))
    pairs = {frozenset(name.rpartition("/")[0] for name in b.points) for b in robot.boundaries}
    far = [("a", "c"), ("a", "d"), ("a", "hand"), ("b", "d"), ("b", "hand"), ("c", "hand")]
    assert pairs == set(map(frozenset, [*far, *(("lamp", x) for x in ("b", "c", "d", "hand"))]))
    assert {p.name: p.frame for p in robot.points}["hand/1"] == "d"
    assert robot.tool == "hand"
    srdf = written(
        tmp_path,
        "<disable_collisions link1='d' link2='a'/><disable_default_collisions link='lamp'/>",
        "<enable_collisions link1='lamp' link2='c'/>",
        "<group_state name='home' group='g'><joint name='j2' value='0.5'/></group_state>",
        name="arm.srdf",
    )
    fewer = load_robot(tmp_path / "arm.urdf", chain=("a", "hand"), srdf=srdf)
    left = {frozenset(name.rpartition("/")[0] for name in b.points) for b in fewer.boundaries}
    assert left == set(map(frozenset, [*far, ("lamp", "c")])) - {frozenset("ad")}
    assert fewer.home.tolist() == [0, 0.5, 0]


def test_pairs_that_are_left_out_are_named_where_they_are_read(tmp_path, capsys) -> None:
    """Neighbours were left out without a word, and links that an SRDF misspells were, too."""
    parts = [link(n, BALL) for n in ("a", "b", "c", "d", "lamp")] + [link("bare")]
    parts += [joint("j1", "a", "b"), joint("j2", "b", "c"), joint("j3", "c", "d")]
    parts += [joint("f", "a", "lamp", "fixed"), joint("g", "d", "bare", "fixed")]
    file = written(tmp_path, *parts)
    pairs = "<disable_collisions link1='d' link2='a'/><disable_collisions link1='a' link2='b'/>"
    more = "<disable_default_collisions link='lamp'/><disable_collisions link1='a' link2='aa'/>"
    srdf = written(tmp_path, pairs, more, name="arm.srdf")
    words = ["import", str(file), "--to", "d", "--srdf", str(srdf)]
    assert main([*words, "-o", str(tmp_path / "arm.toml")]) == 0
    printed, made = capsys.readouterr().out, (tmp_path / "arm.toml").read_text()
    for says in (
        "because one joint connects them: a and b; b and c; c and d.",
        "because the SRDF disables them: a and d; lamp and b; lamp and c; lamp and d.",
        "The SRDF names links that the URDF does not have: aa.",
    ):
        assert says in printed
        assert says in made.replace("\n#  ", "")
    only_states = "<group_state name='home' group='g'><joint name='q9' value='0.5'/></group_state>"
    with pytest.raises(RobotFileError, match=r"of another robot: its joints are q9; the URDF has"):
        load_robot(file, srdf=written(tmp_path, only_states, name="other.srdf"))


@pytest.mark.parametrize(
    ("size", "excess", "most"), [("0.4", 0.02, "2,000"), ("0.7", 0.012, "20,000")]
)
def test_too_many_pairs_name_an_excess_that_makes_few_enough(tmp_path, size, excess, most) -> None:
    """Boxes made 16,000 pairs by default, and every proof refused them later."""
    box = f"<collision><geometry><box size='{size} 0.1 0.3'/></geometry></collision>"
    file = three_links(tmp_path, balls=box)
    try:
        said = import_urdf(file, excess=excess).notes[-1]
    except RobotFileError as error:
        said = str(error)
    assert f"at most {most} are possible" in said or f"certificates take at most {most}" in said
    [(larger, pairs)] = re.findall(r"an excess of (\S+) m makes ([\d,]+)", said)
    fewer = import_urdf(file, excess=float(larger))
    assert len(fewer.robot.boundaries) == int(pairs.replace(",", "")) <= check.MAX_BOUNDARIES
    assert not any("an excess of" in note for note in fewer.notes)
    assert check.MAX_BOUNDARIES == MANY_PAIRS


def test_limits_are_the_files_or_those_asked_for(tmp_path) -> None:
    file = three_links(tmp_path)
    assert load_robot(file).joints[1].limits == (-1, 2)
    turned = load_robot(file, limits={"k": (-7.0, 7.0)})
    assert turned.joints[1].limits == pytest.approx((-7, 7), rel=1e-15)
    assert turned.joints[1].velocity == pytest.approx(3, rel=1e-15)
    high = "<limit lower='0.5' upper='2'/>"
    assert load_robot(three_links(tmp_path, high)).home.tolist() == [0, 0.5]


@pytest.mark.parametrize(
    ("kind", "hard", "soft", "limits"),
    [
        ("revolute", "lower='-2' upper='2'", {"lower": -0.5, "upper": 0.7}, (-0.5, 0.7)),
        ("revolute", "lower='-2' upper='2'", {"lower": -3, "upper": 0.7}, (-2, 0.7)),
        ("revolute", "lower='-2' upper='2'", {"lower": -1}, (-1, 0)),
        ("revolute", "lower='-2' upper='2'", {}, (-2, 2)),
        ("continuous", "velocity='1'", {"lower": -1, "upper": 1}, (-1, 1)),
        ("continuous", "velocity='1'", {"lower": 0, "upper": 0}, None),
        ("prismatic", "lower='0' upper='2'", {"lower": 0.5, "upper": 1}, (0.5, 1)),
    ],
)
def test_soft_limits_bound_a_joint_as_they_bound_a_planner(
    tmp_path, kind, hard, soft, limits
) -> None:
    """They were dropped without a note."""
    ends = " ".join(f"soft_{end}_limit='{x}'" for end, x in soft.items())
    more = f"<limit {hard}/><safety_controller k_velocity='{10 * bool(soft)}' {ends}/>"
    file = three_links(tmp_path, more, kind)
    assert load_robot(file).joints[1].limits == limits
    told = [note for note in import_urdf(file).notes if note.startswith("soft limits")]
    if limits in (None, (-2, 2)):
        assert told == []
    else:
        low, high = limits
        assert told == [f"soft limits in place of the wider hard ones: k {low:g} to {high:g}"]
    wide = import_urdf(file, limits={"k": (-0.25, 1.25)})
    assert wide.robot.joints[1].limits == pytest.approx((-0.25, 1.25))
    assert not any(note.startswith("soft limits") for note in wide.notes)


def test_soft_limits_off_the_hard_ones_are_refused(tmp_path) -> None:
    soft = "<safety_controller soft_lower_limit='3' soft_upper_limit='4'/>"
    with pytest.raises(RobotFileError, match="soft limits 3 to 4: none of them is within"):
        load_robot(three_links(tmp_path, f"<limit lower='-2' upper='2'/>{soft}"))


@pytest.mark.parametrize(
    ("value", "says"),
    [
        ("0.5", ""),
        ("2.0004", ""),
        ("3.3", "home.srdf: state 'home': k = 3.3 is outside of its limits -1 to 2"),
    ],
)
def test_a_state_outside_of_the_limits_is_an_error(tmp_path, value, says) -> None:
    """It was moved to the limit in silence; within a cut digit it still is."""
    state = f"<group_state name='home' group='g'><joint name='k' value='{value}'/></group_state>"
    other = "<group_state name='up' group='g'><joint name='k' value='1'/></group_state>"
    file, srdf = three_links(tmp_path), written(tmp_path, state, other, name="home.srdf")
    if says:
        with pytest.raises(RobotFileError, match=says):
            load_robot(file, srdf=srdf)
    else:
        assert load_robot(file, srdf=srdf).home[1] == pytest.approx(min(float(value), 2))
    assert import_urdf(file, srdf=srdf, home="up").robot.home[1] == 1


def test_joints_that_only_a_state_names_are_named(tmp_path) -> None:
    values = "<joint name='k' value='0.5'/><joint name='qX' value='1'/>"
    state = f"<group_state name='home' group='g'>{values}</group_state>"
    imported = import_urdf(three_links(tmp_path), srdf=written(tmp_path, state, name="a.srdf"))
    assert imported.robot.home.tolist() == pytest.approx([0, 0.5])
    said = "the SRDF's states name joints that the URDF does not have: qX"
    assert said in imported.notes


def test_what_lies_off_the_chain_is_named(tmp_path, capsys) -> None:
    parts = [link(n, BALL) for n in "abcx"]
    parts += [joint("j", "a", "b"), joint("k", "b", "c"), joint("l", "b", "x")]
    file = written(tmp_path, *parts)
    assert main(["import", str(file), "-o", str(tmp_path / "arm.toml")]) == 2
    assert "name it, or one that carries it (--to LINK)" in capsys.readouterr().err
    assert main(["import", str(file), "--to", "c", "-o", str(tmp_path / "arm.toml")]) == 0
    assert "Not in the chain, and not kept clear of: x." in capsys.readouterr().out
    text = (tmp_path / "arm.toml").read_text()
    assert "# Not in the chain, and not kept clear of: x." in text
    assert "SHA-256" in text


# --- what is refused ------------------------------------------------------------------------------

BOMB = """<?xml version="1.0"?>
<!DOCTYPE lolz [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<robot name="&b;"/>"""
ELSEWHERE = """<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/hostname">]><robot name="&x;"/>"""


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (BOMB.encode(), "line 2: <!DOCTYPE> found"),
        (ELSEWHERE.encode(), "line 1: <!DOCTYPE> found"),
        (BOMB.encode("utf-16"), "not UTF-8 text"),
        (b'<?xml version="1.0" encoding="utf-7"?>\n<robot name="+ADw-"></robot>', "no <link>"),
        (b"", "not XML"),
        (b"<robot name='x'><link name='a'></robot>", "not XML"),
        (b"<sdf/>", "<sdf> found; wanted: <robot>"),
        (b"<robot name='x' xmlns:xacro='http://ros.org/xacro'><xacro:a/></robot>", "a xacro macro"),
        (b"\xff\xfe\x00", "not UTF-8 text"),
    ],
)
def test_a_file_that_is_no_urdf_is_refused_unread(tmp_path, content, says) -> None:
    file = tmp_path / "arm.urdf"
    file.write_bytes(content)
    with pytest.raises(RobotFileError) as error:
        load_robot(file)
    assert says in str(error.value)
    assert "arm.urdf" in str(error.value)


TWO = [link("a", BALL), link("b", BALL)]


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([*TWO, link("a"), joint("j", "a", "b")], "line 4: link 'a': the name 'a' is used twice"),
        ([*TWO, joint("j", "a", "b"), joint("k", "a", "b")], "a tree, without closed loops"),
        ([*TWO, joint("j", "a", "b"), joint("k", "b", "a")], "joints run in a circle"),
        ([*TWO, joint("j", "b", "b")], "closes a circle"),
        ([*TWO, link("c"), joint("j", "a", "b")], "2 links hang on no joint: a, c"),
        ([*TWO, joint("j", "a", "z")], "line 4: joint 'j': no link 'z'; there are a, b"),
        ([*TWO, joint("j", "a", "b", "helical")], "type 'helical' is unknown"),
        ([*TWO, joint("j", "a", "b", "floating")], "a floating joint has more than one degree"),
        ([*TWO, joint("j", "a", "b", "fixed")], "no joint moves between 'a' and 'b'"),
        ([*TWO, joint("j", "a", "b", more="<axis xyz='0 0 0'/>")], "0 0 0 has no direction"),
        ([*TWO, joint("j", "a", "b", more="<origin xyz='0 1'/>")], "wanted: 3 finite numbers"),
        ([*TWO, joint("j", "a", "b", more="<origin xyz='0 1_0 0'/>")], "wanted: 3 finite numbers"),
        ([*TWO, joint("j", "a", "b", more="<limit effort='1'/>")], "without limits; give them"),
        ([*TWO, joint("j", "a", "b", more="<limit lower='1' upper='0'/>")], "do not rise"),
        ([*TWO, joint("j", "a", "b", more="<limit lower='1' upper='1'/>")], "no joint moves"),
        ([*TWO, joint("j", "a", "b", more="<mimic joint='z'/>")], "joint 'z' (mimic)"),
        ([link("a", BALL.replace("0.05", "-1")), link("b"), joint("j", "a", "b")], "is no size"),
        ([link("a", BALL.replace("sphere", "cone")), link("b")], "<cone> found; wanted: one of"),
        *(
            ([*TWO, joint("j", "a", "b", more=more)], says)
            for more, says in [
                ("<origin xzy='0 0 1'/>", "attribute 'xzy' is not read"),
                ("<axis xyz='0 1 0' frame='a'/>", "attribute 'frame' is not read"),
                ("<limit lower='-1' uper='1'/>", "attribute 'uper' is not read"),
                ("<mimic joint='k' multiplyer='2'/>", "attribute 'multiplyer' is not read"),
                ("<origin quat_xyzw='0 0 0 1'/>", "quat_xyzw belongs to URDF 1.1"),
                ("<orign xyz='0 0 1'/>", "<orign> is not read here; known are: origin, parent"),
            ]
        ),
        ([link("a", "<colision/>"), TWO[1], joint("j", "a", "b")], "<colision> is not read here"),
        (
            [link("a", BALL.replace("<geometry>", "<origin z='1'/><geometry>")), TWO[1]],
            "line 2: link 'a', <collision>, <origin>: attribute 'z' is not read",
        ),
        (
            [link("a", BALL.replace("<collision>", "<collision xyz='0 0 1'>")), TWO[1]],
            "<collision>: attribute 'xyz' has no meaning here",
        ),
        (
            [link(f"l{i}") for i in range(12)]
            + [joint(f"j{i}", f"l{i}", f"l{i + 1}") for i in range(11)],
            "11 joints move between 'l0' and 'l11'; at most 9 are possible",
        ),
    ],
)
def test_what_no_arm_can_be_is_refused_with_its_place(tmp_path, capsys, parts, says) -> None:
    file = written(tmp_path, *parts)
    with pytest.raises(RobotFileError) as error:
        load_robot(file)
    assert says in str(error.value)
    assert main(["import", str(file), "-o", str(tmp_path / "out.toml")]) == 2
    assert says in capsys.readouterr().err
    assert not (tmp_path / "out.toml").exists()


SEEN = "<visual><geometry><sphere radius='0.05'/></geometry></visual>"


def test_links_without_a_collision_shape_are_named_and_an_arm_without_any_is_refused(
    tmp_path, capsys
) -> None:
    """Of visuals alone: "0 balls, 0 pairs; every shape is covered (proved)", all feasible."""
    joints = [joint("j1", "a", "b"), joint("j2", "b", "c"), joint("f", "c", "tip", "fixed")]
    names = [link("b", SEEN), link("c", BALL), link("tip")]
    file = written(tmp_path, link("a", BALL), *names, *joints)
    assert load_robot(file).left_out == ("b",)  # and not the tip, a frame of c
    assert main(["import", str(file), "-o", str(tmp_path / "arm.toml")]) == 0
    assert "Without a collision shape: b." in capsys.readouterr().out
    assert load_robot(tmp_path / "arm.toml").left_out == ("b",)
    file = written(tmp_path, link("a", SEEN), link("b", SEEN), link("c"), link("tip"), *joints)
    with pytest.raises(RobotFileError, match="no link of the chain has a <collision>"):
        load_robot(file)


VERSION_1_1 = "<robot name='arm' version='1.1'>"


def of_version_1_1(folder: Path, *parts: str, name: str = "new.urdf") -> Path:
    file = written(folder, *parts, name=name)
    file.write_text(file.read_text().replace("<robot name='arm'>", VERSION_1_1))
    return file


@pytest.mark.parametrize("seed", range(4))
def test_a_quaternion_of_urdf_1_1_turns_as_its_axis_and_angle_do(tmp_path, seed) -> None:
    """It was read as no rotation at all, without a word."""
    rng = np.random.default_rng([4, seed])
    axis, angle = rng.normal(size=3), rng.uniform(-3, 3)
    axis /= np.linalg.norm(axis)
    quaternion = [*(np.sin(angle / 2) * axis), np.cos(angle / 2)]
    origin = f"<origin xyz='0.1 0.2 0.3' quat_xyzw='{' '.join(f'{x:.9f}' for x in quaternion)}'/>"
    tilted = BALL.replace("<geometry>", f"{origin}<geometry>").replace(
        "<sphere radius='0.05'/>", "<capsule radius='0.03' length='0.4'/>"
    )
    limits = "<limit lower='-1' upper='2'/>"
    parts = [link("a", tilted), link("b", BALL), joint("j", "a", "b", more=limits + origin)]
    robot = load_robot(of_version_1_1(tmp_path, *parts))
    assert np.abs(robot.joints[0].mount - rotation(axis, angle)).max() < 1e-8
    centres = np.array([point.at for point in robot.points if point.covers == "a"])
    centres -= [0.1, 0.2, 0.3]
    along = rotation(axis, angle) @ [0, 0, 1]
    assert np.abs(centres - np.outer(centres @ along, along)).max() < 1e-4  # short decimals
    for wrong, says in (
        ("<origin quat_xyzw='0 0 0 1' rpy='0 0 0'/>", "both rpy and quat_xyzw"),
        ("<origin quat_xyzw='0 0 0 0'/>", "of length 0; wanted: 1"),
        ("<origin quat_xyzw='0 0 1'/>", "wanted: 4 finite numbers"),
    ):
        file = of_version_1_1(tmp_path, *TWO, joint("j", "a", "b", more=limits + wrong))
        with pytest.raises(RobotFileError, match=says):
            load_robot(file)
    file.write_text(file.read_text().replace("'1.1'", "'2.0'"))
    with pytest.raises(RobotFileError, match=r"version '2.0' is not read; known are: 1.0, 1.1"):
        load_robot(file)


def test_what_places_nothing_may_stand_in_a_urdf(tmp_path) -> None:
    more = "<dynamics damping='1'/><calibration rising='0'/><x:stiff xmlns:x='y' k='1'/>"
    more += "<origin xmlns:x='y' x:note='1'/>"
    inside = (
        "<contact><lateral_friction value='1'/></contact><inertial><mass value='1'/></inertial>"
    )
    parts = [link("a", BALL + inside), TWO[1], joint("j", "a", "b", more=more)]
    extra = "<gazebo reference='a'/><transmission name='t'><joint name='j'/></transmission>"
    assert load_robot(written(tmp_path, *parts, extra)).joints[0].limits == (-1, 2)


def test_chains_and_limits_that_do_not_fit_are_refused(tmp_path) -> None:
    file = three_links(tmp_path)
    for asked, says in [
        ({"chain": ("c", "a")}, "'a' is not carried by 'c'; a chain runs outward"),
        ({"chain": ("a", "z")}, "no link 'z'; there are a, b, c"),
        ({"limits": {"z": (0, 1)}}, "limits of 'z': the chain has j, k"),
        ({"limits": {"k": (1, 0)}}, "do not rise"),
        ({"limits": {"k": (-4000, 4000)}}, "turns wide"),
        ({"excess": float("nan")}, "1e-06 to 1000 m is wanted"),
        ({"srdf": tmp_path / "no.srdf"}, "no.srdf: No such file"),
    ]:
        with pytest.raises(ValueError, match=says):
            load_robot(file, **asked)
    with pytest.raises(ValueError, match="srdf: for a URDF only"):
        load_robot("ur5", srdf="ur5.srdf")
    for wrong in ("k=0..nan", "k=0", "k=0..1..2", "=0..1", "k=0..1kg"):
        assert main(["import", str(file), "--limits", wrong, "-o", "-"]) == 2
    for ends in ("-90deg..90°", "-90deg:90deg"):
        assert main(["import", str(file), "--limits", f"k={ends}", "-o", f"{tmp_path}/a.toml"]) == 0
        assert load_robot(tmp_path / "a.toml").joints[1].limits == pytest.approx(
            (-np.pi / 2, np.pi / 2)
        )
    assert main(["region", str(file), "--json", "-"]) in (0, 1)


# --- the last link, packages, locked joints -------------------------------------------------------

MADE = Path(__file__).parent / "urdfs"


def test_frames_on_the_last_link_count_as_one_and_those_on_the_base_as_none() -> None:
    """The frames of ROS-Industrial: base beside base_link, tool0 on the flange."""
    imported = import_urdf(MADE / "rosi.urdf")
    assert (imported.chain.frames[0], imported.chain.tip) == ("base_link", "tool0")
    assert imported.robot.forward_kinematics([0, 0]) == pytest.approx([0.6, 0, 0.2])
    for tip, place in (("flange", [0.6, 0, 0.2]), ("link_2", [0.3, 0, 0.2])):
        named = load_robot(MADE / "rosi.urdf", chain=(None, tip))
        assert named.forward_kinematics([0, 0]) == pytest.approx(place)


@pytest.mark.parametrize(
    ("more", "tip"),
    [
        ([], "c"),
        ([link("x", BALL), joint("l", "a", "x")], "c"),  # one moving joint, and two before c
        ([link("x"), joint("l", "c", "x", "fixed"), link("y"), joint("m", "c", "y", "fixed")], "x"),
        ([link("x"), joint("l", "c", "x", "fixed"), link("y"), joint("m", "b", "y", "fixed")], "x"),
        ([link("x", BALL), joint("l", "c", "x")], "x"),
        ([link("x", BALL), joint("l", "b", "x")], None),  # c and x: as many joints each
    ],
)
def test_the_last_link_is_the_one_behind_the_most_moving_joints(tmp_path, more, tip) -> None:
    parts = [link(n, BALL) for n in "abc"] + [joint("j", "a", "b"), joint("k", "b", "c"), *more]
    file = written(tmp_path, *parts)
    if tip is None:
        with pytest.raises(RobotFileError, match="2 links could be the last one: c, x; name it"):
            load_robot(file)
    else:
        assert import_urdf(file).chain.tip == tip


PACKAGES = MADE / "arm_description"


@pytest.mark.parametrize(
    ("name", "packages", "says"),
    [
        ("same", ["{}"], ""),  # the folder's own name
        ("same", ["{}/.."], ""),  # a folder that holds it
        ("other", ["{}"], ""),  # package.xml says ARM_V10
        ("other", ["{}/.."], ""),
        ("other", [], "no file .*say where its package is: ARM_V10=FOLDER .--package"),
        ("rel", ["{}"], ""),
        ("rel", [], "outside of the URDF's folder.*name that folder as a package, too"),
        ("case", ["{}"], "is: Arm_Description=FOLDER"),
        ("case", ["Arm_Description={}"], ""),
        ("dotted", ["arm.SLDASM={}"], ""),
        ("dotted", ["arm={}"], "is: arm.SLDASM=FOLDER"),
        ("other", ["arm={}"], "no file"),  # a name that is given is the only one
        ("modelscheme", ["{}"], "nothing is fetched"),
    ],
)
def test_a_package_has_the_name_that_is_given_or_its_own_or_its_folders(
    tmp_path, capsys, name, packages, says
) -> None:
    given = [each.format(PACKAGES) for each in packages]
    file = PACKAGES / "urdf" / f"{name}.urdf"
    words = ["import", str(file), *(["--package", *given] if given else [])]
    assert main([*words, "-o", str(tmp_path / "arm.toml")]) == (2 if says else 0)
    if says:
        assert re.search(says, capsys.readouterr().err)
    else:
        assert len(import_urdf(file, packages=given).sources) == 2


def test_a_damaged_package_file_and_links_out_of_a_package_are_no_way_in(tmp_path) -> None:
    inside = tmp_path / "install"
    inside.mkdir()
    (inside / "package.xml").write_text("<!DOCTYPE x><package><name>p</name></package>")
    (inside / "meshes").symlink_to(PACKAGES / "meshes")
    file = with_mesh(tmp_path / "arm", "package://p/meshes/bar.stl")
    with pytest.raises(RobotFileError, match=r"no file 'package://p/meshes/bar\.stl'"):
        load_robot_of(file, inside)
    with pytest.raises(RobotFileError, match=r"leads outside .* name that folder as a package"):
        load_robot_of(file, f"p={inside}")
    assert load_robot_of(file, f"p={inside}", PACKAGES).points


def load_robot_of(file: Path, *packages: str | Path):
    return import_urdf(file, packages=packages).robot


@pytest.mark.parametrize(
    ("kind", "value"), [("revolute", 0.0), ("revolute", 0.7), ("prismatic", 0.25)]
)
def test_a_joint_that_its_limits_lock_is_fixed_where_they_lock_it(tmp_path, kind, value) -> None:
    """A locked joint was refused: "limits 0 to 0 do not rise"."""
    origin = "<origin xyz='0.3 0 0' rpy='0.1 0.2 0.3'/><axis xyz='0 2 0'/>"
    parts = [link(n, BALL) for n in "abcd"]
    parts += [joint("j", "a", "b"), joint("l", "c", "d", more=origin)]
    limits = f"<limit lower='{value}' upper='{value}'/>"
    locked = written(tmp_path, *parts, joint("k", "b", "c", kind, limits + origin))
    imported = import_urdf(locked)
    assert [each.name for each in imported.robot.joints] == ["j", "l"]
    assert f"fixed, because limits lock them: k at {value:g}" in imported.notes
    assert ("b", "c") not in imported.robot.unchecked  # one rigid link
    free = "<limit lower='-2' upper='2'/>"
    moving = load_robot(
        written(tmp_path, *parts, joint("k", "b", "c", kind, free + origin), name="free.urdf")
    )
    place = moving.forward_kinematics([0.4, value, -0.5])
    assert imported.robot.forward_kinematics([0.4, -0.5]) == pytest.approx(place, abs=1e-12)
    by_hand = import_urdf(tmp_path / "free.urdf", limits={"k": (value, value)}).robot
    assert by_hand.forward_kinematics([0.4, -0.5]) == pytest.approx(place, abs=1e-12)
    unlocked = import_urdf(locked, limits={"k": (-1, 1)}).robot
    assert len(unlocked.joints) == 3


def test_what_follows_a_locked_joint_is_locked_too(tmp_path) -> None:
    parts = [link(n, BALL) for n in "abcd"] + [joint("j", "a", "b")]
    parts += [joint("k", "b", "c", more="<limit lower='0.5' upper='0.5'/>")]
    parts += [joint("l", "c", "d", more="<mimic joint='k' multiplier='2' offset='0.1'/>")]
    imported = import_urdf(written(tmp_path, *parts))
    assert len(imported.robot.joints) == 1
    assert "fixed, because limits lock them: k at 0.5, l at 1.1" in imported.notes


def test_constants_of_xacro_that_nothing_uses_and_boxes_without_size_are_let_be(tmp_path) -> None:
    ns = "xmlns:xacro='http://www.ros.org/wiki/xacro'"
    unused = f"<xacro:property {ns} name='width' value='.2'/>"
    point = "<collision><geometry><box size='0 0 0'/></geometry></collision>"
    flat = "<collision><geometry><box size='0.2 0 0.1'/></geometry></collision>"
    parts = [link("a", point + SEEN), link("b", flat), link("c", BALL)]
    parts += [joint("j", "a", "b"), joint("k", "b", "c"), unused]
    robot = load_robot(written(tmp_path, *parts))
    assert robot.left_out == ("a",)
    balls = [point for point in robot.points if point.covers == "b"]
    edge = np.array([[x, 0, z] for x in np.linspace(-0.1, 0.1, 9) for z in (-0.05, 0, 0.05)])
    gaps = [np.linalg.norm(edge - ball.at, axis=1) - ball.radius for ball in balls]
    assert np.min(gaps, axis=0).max() <= 0
    used = joint("l", "b", "c").replace("name='l'", "name='${width}'")
    for more, says in ((used, "a xacro macro"), ("<box size='-1 0 0'/>", "three numbers of 0 or")):
        bad = [link("z", f"<collision><geometry>{more}</geometry></collision>")] * ("box" in more)
        with pytest.raises(RobotFileError, match=says):
            load_robot(written(tmp_path, *parts, *(bad or [more])))


# --- meshes ---------------------------------------------------------------------------------------

CORNERS = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
TETRAHEDRON = CORNERS[[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]]


def stl(triangles: np.ndarray) -> str:
    lines = ["solid x"]
    for triangle in triangles.tolist():
        corners = "".join(f"vertex {x} {y} {z}\n" for x, y, z in triangle)
        lines.append(f"facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet")
    return "\n".join([*lines, "endsolid x"])


def with_mesh(folder: Path, name: str, more: str = "") -> Path:
    folder.mkdir(exist_ok=True)
    mesh = f"<collision><geometry><mesh filename='{name}' {more}/></geometry></collision>"
    return written(folder, link("a", mesh), link("b"), joint("j", "a", "b"))


@pytest.mark.parametrize(
    "name",
    ["../out.stl", "package://../out.stl", "file:///etc/hostname", "/etc/hostname", "sub/out.stl"],
)
def test_a_mesh_elsewhere_is_not_opened(tmp_path, name) -> None:
    (tmp_path / "out.stl").write_text(stl(TETRAHEDRON))
    file = with_mesh(tmp_path / "arm", name)
    (tmp_path / "arm" / "sub").mkdir()
    (tmp_path / "arm" / "sub" / "out.stl").symlink_to(tmp_path / "out.stl")
    with pytest.raises(RobotFileError, match="leads outside of the URDF's folder"):
        load_robot(file)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("missing.stl", "no file 'missing.stl'"),
        ("package://p/missing.stl", "say where its package is"),
        ("https://example.org/a.stl", "nothing is fetched"),
        ("bad.stl", "not read|triangles|finite"),
        ("nan.stl", "a corner is not a finite number"),
        ("a.step", "unknown ending"),
        ("arm.dae", "unknown ending; wanted: one of .stl, .obj"),
        ("loop.stl", "no place that can be reached|no file"),
    ],
)
def test_a_mesh_that_cannot_be_used_is_named(tmp_path, name, says) -> None:
    (tmp_path / "bad.stl").write_bytes(b"\x00" * 90)
    (tmp_path / "nan.stl").write_text(stl(TETRAHEDRON).replace("0.1", "nan", 1))
    (tmp_path / "a.step").write_text("x")
    (tmp_path / "arm.dae").write_text("<COLLADA/>")
    (tmp_path / "loop.stl").symlink_to(tmp_path / "loop.stl")
    with pytest.raises(RobotFileError, match=says):
        load_robot(with_mesh(tmp_path, name))


def test_a_mesh_of_a_package_is_covered_and_scaled(tmp_path) -> None:
    (tmp_path / "p" / "meshes").mkdir(parents=True)
    (tmp_path / "p" / "meshes" / "a.stl").write_text(stl(TETRAHEDRON))
    file = with_mesh(tmp_path / "arm", "package://p/meshes/a.stl", "scale='1 2 -1'")
    for folder in (tmp_path, tmp_path / "p"):
        imported = import_urdf(file, packages=[folder])
        balls = [point for point in imported.robot.points if point.radius]
        weights = np.random.default_rng(3).dirichlet(np.ones(3), 3000)
        places = (weights @ TETRAHEDRON).reshape(-1, 3) * [1, 2, -1]
        gaps = [np.linalg.norm(places - ball.at, axis=1) - ball.radius for ball in balls]
        assert np.min(gaps, axis=0).max() <= 0
        assert "of a mesh its triangles (what they enclose may not be)" in imported.notes[0]
        assert [source.name for source in imported.sources] == ["arm.urdf", "a.stl"]


@pytest.mark.parametrize("guesses", [True, False], ids=["guesses letters", "guesses none"])
def test_a_mesh_in_letters_of_latin_1_is_read_wherever_it_is(
    tmp_path, monkeypatch, guesses
) -> None:
    """The parser has a library guess letters, if that is there; names of solids are no matter."""
    if not guesses:
        monkeypatch.setitem(sys.modules, "charset_normalizer", None)
        monkeypatch.setitem(sys.modules, "chardet", None)
    plain = tmp_path / "plain.stl"
    plain.write_text(stl(TETRAHEDRON))
    named = stl(TETRAHEDRON).replace("solid x", "solid pièce")
    (tmp_path / "latin.stl").write_bytes(named.encode("latin-1"))
    arms = [import_urdf(with_mesh(tmp_path, name)).robot for name in ("plain.stl", "latin.stl")]
    assert repr(arms[0].points) == repr(arms[1].points)


@pytest.mark.parametrize("kind", ["text", "binary"])
def test_a_mesh_that_is_cut_short_is_refused_as_damaged(tmp_path, kind) -> None:
    whole = stl(TETRAHEDRON).encode()
    if kind == "binary":
        whole = mesh_of_a_box((0.1, 0.1, 0.1)).export(file_type="stl")
        (tmp_path / "whole.stl").write_bytes(whole)
        load_robot(with_mesh(tmp_path, "whole.stl"))
    (tmp_path / "short.stl").write_bytes(whole[: len(whole) * 2 // 3])
    with pytest.raises(RobotFileError, match=r"'short.stl': 0 triangles: damaged, or not STL"):
        load_robot(with_mesh(tmp_path, "short.stl"))


def test_what_is_wrong_with_a_packaged_file_is_said_by_its_name(capsys) -> None:
    for more, says in (
        (["--to", "tool1"], "ur5.urdf: no link 'tool1'"),
        (["--limits", "knee=0..1"], "ur5.urdf: limits of 'knee'"),
        (["--srdf", "panda.urdf"], "panda.urdf: no group, no state"),
        (["--srdf", "panda.srdf"], "panda.srdf is of another robot: its links are panda_link5, "),
        (["--srdf", "ur5.srdf", "--home", "folded"], "no state 'folded'"),
    ):
        assert main(["import", "ur5.urdf", *more, "-o", "-"]) == 2
        said = capsys.readouterr().err
        assert says in said
        assert "/ur5.urdf" not in said


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ("why URDF 0 0 30deg 20deg -o FILE", "connected: "),
        ("certify URDF --box j=0..1 k=0..1 -o FILE", "proved"),
        ("allowed URDF", "a, c"),
        ("contains URDF 0 0", "feasible"),
    ],
)
def test_proofs_take_a_urdf_as_regions_do(tmp_path, capsys, words, says) -> None:
    """They said that it is none of theirs, and not how to make one."""
    file, proof = three_links(tmp_path, "<origin xyz='0.3 0 0'/>"), tmp_path / "proof.json"
    words = words.replace("URDF", str(file)).replace("FILE", str(proof)).split()
    assert main(words) == 0
    assert says in capsys.readouterr().out
    if "-o" in words:
        assert main(["check", str(proof), str(file)]) == 0
        other = three_links(tmp_path, "<origin xyz='0.2 0 0'/>")
        assert main(["check", str(proof), str(other)]) == 2


def test_links_named_like_balls_of_another_keep_names_of_their_own(tmp_path) -> None:
    file = written(
        tmp_path,
        *(link(name, BALL) for name in ("a", "a/1", "a/1/1", "tip", "tip/tool")),
        joint("j1", "a", "a/1"),
        joint("j2", "a/1", "a/1/1"),
        joint("j3", "a/1/1", "tip/tool"),
        joint("j4", "tip/tool", "tip"),
    )
    robot = load_robot(file)
    names = [point.name for point in robot.points]
    assert names == ["tip/tool/tool", "a/2", "a/1/2", "a/1/1/1", "tip/tool/1", "tip/1"]
    assert [link.name for link in links(robot)] == ["a", "a/1", "a/1/1", "tip/tool", "tip"]


def test_a_robot_file_that_somebody_wrote_is_not_replaced(tmp_path, capsys) -> None:
    """README's second part wrote over the reader's own `arm.toml`."""
    own = tmp_path / "arm.toml"
    own.write_text("# my arm\n")
    words = ["import", "scara.urdf", "-o", str(own)]
    assert main(words) == 2
    assert "cspace did not make this file" in capsys.readouterr().err
    with pytest.raises(ValueError, match="did not make this file"):
        save_robot(load_robot("minervabot-v2"), own)
    assert own.read_text() == "# my arm\n"
    assert main([*words, "--force"]) == 0
    assert main(words) == 0  # this one cspace made
    save_robot(load_robot("minervabot-v2"), own)
    assert own.read_text().startswith("# Made by cspace")
    assert load_robot(own).name == load_robot("minervabot-v2").name


# --- balls cover shapes ---------------------------------------------------------------------------


RNG = np.random.default_rng(520)
COUNT = 4000


def capsule_distance(p, radius, length):
    along = np.clip(p[:, 2], -length / 2, length / 2)
    return np.linalg.norm(p - along[:, None] * [0, 0, 1], axis=1) - radius


def cylinder_distance(p, radius, length):
    out = np.stack([np.hypot(p[:, 0], p[:, 1]) - radius, np.abs(p[:, 2]) - length / 2])
    return np.linalg.norm(np.maximum(out, 0), axis=0) + np.minimum(out.max(axis=0), 0)


def box_distance(p, *size):
    out = np.abs(p) - np.array(size) / 2
    return np.linalg.norm(np.maximum(out, 0), axis=1) + np.minimum(out.max(axis=1), 0)


def skin_of(cover: Cover, count: int = COUNT) -> np.ndarray:
    """Places on the balls of a cover."""
    directions = RNG.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    ball = RNG.integers(0, len(cover.radii), count)
    return cover.centres[ball] + cover.radii[ball, None] * directions


def covered(cover: Cover, triangles: np.ndarray, count: int = 5 * COUNT) -> bool:
    """Tell whether places on triangles are all in a ball of a cover."""
    weights = RNG.dirichlet(np.ones(3), count)
    own = triangles[RNG.integers(0, len(triangles), count)]
    places = np.einsum("ni,nij->nj", weights, own)
    return bool(within(places, cover.centres, cover.radii).any(axis=1).all())


SOLIDS = [
    (capsule_cover, capsule_distance, (0.05, 0.4)),
    (capsule_cover, capsule_distance, (0.07, 0.001)),
    (capsule_cover, capsule_distance, (0.01, 0.9)),
    (cylinder_cover, cylinder_distance, (0.06, 0.1)),
    (cylinder_cover, cylinder_distance, (0.1, 0.02)),
    (cylinder_cover, cylinder_distance, (0.02, 0.3)),
    (lambda x, y, z, e: box_cover(np.array([x, y, z]), e), box_distance, (0.1, 0.06, 0.3)),
    (lambda x, y, z, e: box_cover(np.array([x, y, z]), e), box_distance, (0.002, 0.1, 0.1)),
]


@pytest.mark.parametrize("excess", [0.02, 0.011])
@pytest.mark.parametrize(("cover", "distance", "size"), SOLIDS)
def test_a_cover_leaves_nothing_out_and_sticks_out_no_more_than_it_says(
    cover, distance, size, excess
) -> None:
    found = cover(*size, excess)
    centres, radii, reached = found
    assert reached <= excess
    half = np.abs(centres).max(axis=0) + radii.max()
    places = RNG.uniform(-half, half, (20 * COUNT, 3))
    inside = places[distance(places, *size) <= 0]
    assert len(inside) > 50
    assert within(inside, centres, radii).any(axis=1).all()
    assert distance(skin_of(found), *size).max() <= reached


@pytest.mark.parametrize(("radius", "length"), [(0.05, 0.4), (0.03, 0.21), (0.08, 0.01)])
def test_no_fewer_balls_on_its_segment_cover_a_capsule(radius, length) -> None:
    radii = capsule_cover(radius, length, 0.02).radii
    large = radius + 0.02
    fewer = len(radii) - 1
    # Balls on the axis hold its lateral line over 2 sqrt(R^2 - r^2) each, its caps over the excess.
    assert 2 * 0.02 + 2 * (fewer - 1) * np.sqrt(large**2 - radius**2) < length or fewer == 0
    assert radii.max() <= large


def test_the_edges_of_a_solid_are_covered_too() -> None:
    centres, radii, _ = cylinder_cover(0.06, 0.1, 0.02)
    angle = np.linspace(0, 2 * np.pi, 2000)
    rim = np.column_stack([0.06 * np.cos(angle), 0.06 * np.sin(angle), np.full(2000, 0.05)])
    assert within(rim * (1 - 1e-12), centres, radii).any(axis=1).all()
    corners = np.stack(np.meshgrid(*[[-0.05, 0.05]] * 3), axis=-1).reshape(-1, 3)
    cover = box_cover(np.array([0.1, 0.1, 0.1]), 0.02)
    assert within(corners, cover.centres, cover.radii).any(axis=1).all()


def test_a_gap_is_found_however_small() -> None:
    triangle = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    centres = np.array([[0.5, 0.5, 0], [0.0, 0, 0], [0.9, 0.0, 0], [0.0, 0.9, 0]])
    radii = np.array([0.51, 0.45, 0.46, 0.46])
    assert not len(uncovered(triangle, centres, radii))
    for k in range(4):
        less = radii.copy()
        less[k] -= 0.3
        gaps = uncovered(triangle, centres, less)
        assert len(gaps)
        corners = gaps.reshape(-1, 3)
        assert (~within(corners, centres, less).any(axis=1)).any()
    # Tangent from inside in exact numbers is not called covered: rounding has the last word.
    ball = np.zeros((1, 3))
    assert len(uncovered(triangle, ball, np.array([1.0])))
    assert not len(uncovered(triangle, ball, np.array([1.0 + 1e-12])))
    assert len(uncovered(triangle, np.zeros((0, 3)), np.zeros(0)))


def test_a_search_finds_fewer_sets_than_greed_and_loses_no_element() -> None:
    won = 0
    for _ in range(10):
        covers = RNG.random((80, 120)) < 0.1
        greedy = few(covers)
        searched = fewer(covers, greedy, 200)
        assert (covers[searched].any(axis=0) == covers.any(axis=0)).all()
        assert len(np.unique(searched)) == len(searched) <= len(greedy)
        won += len(greedy) - len(searched)
    assert won >= 5
    covers[:, 0] = False  # what no set has is not asked for
    assert len(fewer(covers, few(covers), 50)) <= len(few(covers))


def hull_mesh(corners: np.ndarray) -> np.ndarray:
    """Triangles of a convex hull, outward."""
    return np.array(convex_hull(corners).triangles)


def box_corners(*size: float) -> np.ndarray:
    return np.stack(np.meshgrid(*[[-x / 2, x / 2] for x in size]), axis=-1).reshape(-1, 3)


@pytest.mark.parametrize("size", [(0.1, 0.1, 0.4), (0.4, 0.3, 0.01), (0.3, 0.3, 0.3)])
def test_a_box_as_a_mesh_takes_as_many_balls_as_a_box(size) -> None:
    turn, _ = np.linalg.qr(RNG.normal(size=(3, 3)))
    shift = np.array([0.3, -0.7, 0.2])
    triangles = (hull_mesh(box_corners(*size)) @ turn.T + shift).astype(np.float32).astype(float)
    cover = mesh_cover(triangles, True, 0.02)
    assert cover.excess <= 0.02
    assert len(cover.radii) == len(box_cover(np.array(size), 0.02).radii)
    assert covered(cover, triangles)
    assert box_distance((skin_of(cover) - shift) @ turn, *size).max() <= cover.excess + 1e-7


def test_a_dented_box_is_no_box_and_a_box_inside_out_is_none_inside() -> None:
    corners = box_corners(0.1, 0.1, 0.2)
    whole = hull_mesh(corners)
    assert convex_solid(whole, 1e-6) is not None
    assert convex_solid(whole[:, ::-1], 1e-6) is not None  # the other sense encloses as much
    top = np.array([0.0, 0.0, 0.1])
    far = np.isclose(whole[:, :, 2], 0.1).all(axis=1)
    for dent, convex in ((0.0, True), (0.01, False)):
        fans = [
            [[*t[i]], [*t[(i + 1) % 3]], [*(t.mean(axis=0) - [0, 0, dent])]]
            for t in whole[far]
            for i in range(3)
        ]
        dented = np.concatenate([whole[~far], np.array(fans)])
        found = convex_solid(dented, 1e-6)
        assert (found is not None) is convex
    assert convex_solid(np.concatenate([whole, whole[:, ::-1]]), 1e-6) is None  # goes round nothing
    peaked = convex_solid(hull_mesh(np.vstack([corners, top * 1.2])), 1e-6)
    assert peaked is not None
    assert as_box(peaked, corners, 1e-5) is None


def test_a_prism_takes_few_balls_each_as_deep_as_it_says() -> None:
    angle = 2 * np.pi * np.arange(32) / 32
    ring = np.column_stack([0.06 * np.cos(angle), 0.06 * np.sin(angle)])
    prism = hull_mesh(np.vstack([np.column_stack([ring, 0 * angle + z]) for z in (-0.05, 0.05)]))
    cover = mesh_cover(prism, True, 0.02)
    assert len(cover.radii) <= 1.25 * len(cylinder_cover(0.06, 0.1, 0.02).radii)
    assert cylinder_distance(skin_of(cover), 0.06, 0.1).max() <= cover.excess
    assert covered(cover, prism)


@pytest.mark.parametrize("closed", [True, False])
def test_a_mesh_is_covered_to_its_last_triangle(closed) -> None:
    triangles = ring_mesh(0.08, 0.045, 0.03) + np.array([0.3, -0.2, 0.5])
    cover = mesh_cover(triangles, closed, 0.03)
    assert cover.excess <= 0.03
    assert len(cover.radii) < 40
    assert covered(cover, triangles, 20 * COUNT)
    # The tube is the cylinder without its bore: what sticks out is beyond one of the two.
    skin = skin_of(cover) - [0.3, -0.2, 0.5]
    assert cylinder_distance(skin, 0.08, 0.06).max() <= cover.excess
    if closed:  # the flats of the bore come 0.4 mm nearer to the axis than its corners
        flat = 0.045 * np.cos(np.pi / 24)
        depth = flat - np.hypot(skin[:, 0], skin[:, 1])
        assert depth[np.abs(skin[:, 2]) < 0.03].max() <= cover.excess


def test_what_takes_thousands_of_balls_is_refused() -> None:
    for cover, given in (
        (capsule_cover, (0.05, 0.4, 1e-9)),
        (cylinder_cover, (0.05, 0.4, 1e-9)),
        (mesh_cover, (hull_mesh(box_corners(1, 1, 1)), True, 0.01)),
    ):
        with pytest.raises(ValueError, match="more than 4000 balls"):
            cover(*given)
