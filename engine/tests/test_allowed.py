"""Contacts of links over the whole joint space: answers by hand, near misses, and an opponent."""

import json
import math
from dataclasses import replace
from itertools import product
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cspace.arms.allowed import (
    Contact,
    Spheres,
    allowed_collisions,
    apart_everywhere,
    disabling_reason,
    pair_forms,
    srdf_text,
    touching_everywhere,
)
from cspace.arms.links import link_of, link_pair, links
from cspace.cli import main
from cspace.model.robot import Body, Capsule, Pair, Point, Prismatic, Revolute, Robot
from cspace.model.robotfile import save_robot
from cspace.proofs import Verdict
from cspace.proofs.exact.problem import exact_robot
from engine_support.arms import in_metres
from engine_support.ball_arms import arm_of_balls
from engine_support.commands import follows_schema

Z = (0.0, 0.0, 1.0)


def ball(name, frame, at, radius) -> Point:
    return Point(name, frame, np.array(at, dtype=float), radius)


def joint(kind, k, origin=(0, 0, 0), axis=Z, limits=None, mount=None):
    axis = np.array(axis, dtype=float)
    return kind(
        f"q{k}", str(k), str(k + 1), np.array(origin, dtype=float), axis / np.linalg.norm(axis),
        mount=np.eye(3) if mount is None else mount, limits=limits,
    )  # fmt: skip


def arm(joints, balls, boundaries=()) -> Robot:
    home = [0.0 if j.limits is None else sum(j.limits) / 2 for j in joints]
    return in_metres("arm", joints, balls, boundaries, home, balls[-1].name)


def wheel(radius, gap, limits=None) -> Robot:
    """A ball on a wheel of radius 1, and a post that it misses by the gap at q = 0."""
    turn = joint(Revolute, 0, limits=limits)
    post = ball("post/1", "0", (1 + 2 * radius + gap, 0, 0), radius)
    return arm([turn], [post, ball("rim/1", "1", (1, 0, 0), radius)])


def only(robot, **options):
    (found,) = allowed_collisions(robot, **options)
    return found


def centres(robot, q) -> dict[str, np.ndarray]:
    """Find where the balls are, by frames and no form."""
    frames = robot.frames(q)
    return {p.name: frames.position(robot.base, p.name, robot.base) for p in robot.points}


def gap_at(robot, pair, q) -> float:
    return gap_of(robot, pair, centres(robot, q))


def gap_of(robot, pair, at) -> float:
    radii = {p.name: p.radius for p in robot.points}
    one, other = ([p.name for p in robot.points if link_of(p) == name] for name in pair)
    return min(np.linalg.norm(at[a] - at[b]) - radii[a] - radii[b] for a, b in product(one, other))


# --- answers by hand -----------------------------------------------------------------------------


def test_never_with_the_gap_that_geometry_says() -> None:
    found = only(wheel(0.1, 0.25))
    assert (found.spheres, found.joints, found.links) == (Spheres.NEVER, (0,), ("post", "rim"))
    assert found.gap == pytest.approx(0.25, abs=1e-12)
    assert found.proved_gap == pytest.approx(0.125, abs=1e-12)


def test_sometimes_with_two_witnesses() -> None:
    robot = wheel(0.1, -0.05)
    found = only(robot)
    assert found.spheres is Spheres.SOMETIMES
    assert found.gap == pytest.approx(-0.05, abs=1e-12)
    assert gap_at(robot, found.links, found.nearest) < 0 < gap_at(robot, found.links, found.apart)


@pytest.mark.parametrize("length", [0.3, 0.737, 1.234, 51.7])
def test_the_gap_of_two_balls_with_one_middle_is_that_of_their_places(length) -> None:
    """A hand that folds back onto the base: the squared distance cancels to nothing there."""
    elbow = joint(Revolute, 1, origin=(length, 0, 0))
    foot, hand = ball("foot/1", "0", (0, 0, 0), 0.1), ball("hand/1", "2", (length, 0, 0), 0.124)
    robot = arm([joint(Revolute, 0), elbow], [foot, hand])
    found = only(robot)
    assert found.gap == pytest.approx(-0.224, abs=1e-9 * length)
    there = gap_at(robot, found.links, found.nearest)
    assert found.gap == pytest.approx(there, abs=1e-14 * (1 + length))


@pytest.mark.parametrize(
    ("limits", "contact"),
    [
        ((0.5, 3.0), Spheres.NEVER), ((-3.0, 0.5), Spheres.SOMETIMES),
        ((5.0, 12.0), Spheres.SOMETIMES),
    ],
)  # fmt: skip
def test_limits_count_and_more_than_a_turn_is_a_turn(limits, contact) -> None:
    """The ball of radius 0.1 on the rim overlaps the post within 0.2 rad of a whole turn."""
    found = only(wheel(0.1, -0.05, limits))
    assert found.spheres is contact
    assert limits[0] <= found.nearest[0] <= limits[1]


def test_always_by_one_ball_after_the_other() -> None:
    """A ring of posts that the rim's ball never leaves, and the same ring with one post less."""
    posts = [
        ball(f"ring/{k}", "0", (math.cos(k * math.pi / 4), math.sin(k * math.pi / 4), 0), 0.3)
        for k in range(8)
    ]
    rim = ball("rim/1", "1", (1, 0, 0), 0.1)
    whole = only(arm([joint(Revolute, 0)], [*posts, rim]))
    assert (whole.spheres, whole.cells > 8) == (Spheres.ALWAYS, True)
    assert whole.contact is Contact.UNPROVED  # the spheres may stick out of the links
    part = only(arm([joint(Revolute, 0)], [*posts[1:], rim]))
    assert part.spheres is Spheres.SOMETIMES
    assert abs(part.apart[0]) < math.pi / 4


def test_a_slide_that_reaches_and_one_that_does_not() -> None:
    balls = [ball("wall/1", "0", (1, 0, 0), 0.1), ball("rod/1", "1", (0, 0, 0), 0.1)]
    for far, contact in ((0.75, Spheres.NEVER), (0.85, Spheres.SOMETIMES)):
        found = only(arm([joint(Prismatic, 0, axis=(1, 0, 0), limits=(0.0, far))], balls))
        assert found.spheres is contact
        assert found.gap == pytest.approx(0.8 - far, abs=1e-12)


def test_links_of_one_frame_and_balls_about_an_axis_are_constant() -> None:
    """A tool fixed to a hand, and a hub that the hand turns about: no joint matters."""
    balls = [
        ball("hub/1", "0", (0, 0, 0), 0.2), ball("hand/1", "1", (0.25, 0, 0), 0.1),
        ball("tool/1", "1", (0.5, 0, 0), 0.1),
    ]  # fmt: skip
    tilted = Rotation.from_euler("xyz", [0.3, 0.2, 0.1]).as_matrix()
    found = allowed_collisions(arm([joint(Revolute, 0, axis=(0.1, 0.2, 1), mount=tilted)], balls))
    told = {each.links: (each.spheres, each.joints, each.neighbours) for each in found}
    assert told == {
        ("hub", "hand"): (Spheres.ALWAYS, (), True),
        ("hub", "tool"): (Spheres.NEVER, (), True),
        ("hand", "tool"): (Spheres.NEVER, (), True),
    }


@pytest.mark.parametrize(
    ("radii", "contact"),
    [((0.2, 0.1), Contact.ALWAYS), ((0.16, 0.1), Contact.ALWAYS), ((0.14, 0.1), Contact.UNPROVED)],
)
def test_links_always_meet_only_by_a_place_inside_both(radii, contact) -> None:
    """The spheres always meet; balls inside the links do, or leave a gap of a centimetre."""
    balls = [ball("hub/1", "0", (0, 0, 0), 0.2), ball("hand/1", "1", (0.25, 0, 0), 0.1)]
    inside = [replace(each, radius=r) for each, r in zip(balls, radii, strict=True)]
    robot = arm([joint(Revolute, 0)], balls)
    assert only(robot).contact is Contact.UNPROVED
    found = only(robot, inside=inside)
    assert (found.spheres, found.contact) == (Spheres.ALWAYS, contact)


def test_only_joints_between_the_links_count() -> None:
    """Four joints; between shoulder and hand are two, and one of them is the hand's own axis."""
    joints = [
        joint(Revolute, k, origin=(0.5 * (k > 0), 0, 0), axis=(0, k % 2, 1)) for k in range(4)
    ]
    balls = [ball("upper/1", "2", (0, 0, 0), 0.1), ball("hand/1", "4", (0, 0, 0), 0.1)]
    assert only(arm(joints, balls)).joints == (2,)


# --- near misses ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("gap", "contact"), [(1e-6, Spheres.NEVER), (-1e-6, Spheres.SOMETIMES)])
def test_a_near_miss_of_a_wheel(gap, contact) -> None:
    found = only(wheel(0.1, gap))
    assert found.spheres is contact
    assert found.gap == pytest.approx(gap, rel=1e-6)
    assert found.proved_gap is None or 0 < found.proved_gap < 1e-6


@pytest.mark.parametrize(("gap", "contact"), [(1e-6, Spheres.NEVER), (-1e-6, Spheres.SOMETIMES)])
def test_a_near_miss_of_an_arm_of_three_joints_stretched_out(gap, contact) -> None:
    joints = [
        joint(Revolute, k, origin=(0.5 * (k > 0), 0, 0), axis=(0, k == 1, 1)) for k in range(3)
    ]
    post = ball("post/1", "0", (1.25 + 0.2 + gap, 0, 0), 0.1)
    found = only(arm(joints, [post, ball("hand/1", "3", (0.25, 0, 0), 0.1)]))
    assert (found.spheres, len(found.joints)) == (contact, 3)
    assert found.gap == pytest.approx(gap, rel=1e-4)


def test_a_slit_of_a_millionth_is_not_always() -> None:
    """Two posts that leave the rim's ball a slit; closed by as much, it is always in contact."""

    chord = 0.3 + 0.1
    for sign, contact in ((1, Spheres.SOMETIMES), (-1, Spheres.ALWAYS)):
        angle = 2 * math.asin((chord + sign * 1e-6) / 2)  # where a post's ball touches q = 0
        posts = [
            ball(f"ring/{k}", "0", (math.cos(a), math.sin(a), 0), 0.3)
            for k, a in enumerate((angle, -angle))
        ]
        rim = ball("rim/1", "1", (1, 0, 0), 0.1)
        found = only(arm([joint(Revolute, 0, limits=(-0.7, 0.7))], [*posts, rim]))
        assert found.spheres is contact


def test_the_provers_alone_prove_nothing_that_is_false() -> None:
    """Without the search for witnesses, which would find these places first."""
    robot = exact_robot(wheel(0.1, -1e-6, (-3.0, 2.0)))  # in contact off every centre
    pair = pair_forms(robot, *links(robot))
    assert apart_everywhere(pair, 0.0, 100_000).verdict is not Verdict.PROVED
    robot = exact_robot(wheel(0.1, 1e-6))
    pair = pair_forms(robot, *links(robot))
    assert apart_everywhere(pair, 0.0, 100_000).verdict is Verdict.PROVED
    assert apart_everywhere(pair, 2e-6, 100_000).verdict is not Verdict.PROVED
    narrow = exact_robot(wheel(0.6, -1.2, (-1.2, 1.2871)))  # apart from 1.287 rad on
    pair = pair_forms(narrow, *links(narrow))
    assert touching_everywhere(pair, 100_000).verdict is not Verdict.PROVED
    narrow = exact_robot(wheel(0.6, -1.2, (-1.2, 1.2869)))
    assert touching_everywhere(pair_forms(narrow, *links(narrow)), 100_000).verdict is (
        Verdict.PROVED
    )


def test_what_touches_in_one_place_is_neither_never_nor_always() -> None:
    assert only(wheel(0.125, 0.0)).spheres in (Spheres.SOMETIMES, Spheres.UNDECIDED)


def test_a_budget_too_small_decides_nothing() -> None:
    found = only(wheel(0.1, 1e-6), cells=5)
    assert (found.spheres, found.proved_gap) == (Spheres.UNDECIDED, None)
    assert found.cells <= 5


# --- against samples ------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(5))
def test_samples_agree_with_what_is_proved(seed) -> None:
    rng = np.random.default_rng(seed)
    robot = replace(arm_of_balls(seed, 2 + seed % 2), boundaries=())
    ends = np.array([(-math.pi, math.pi) if j.limits is None else j.limits for j in robot.joints])
    poses = ends[:, 0] + (ends[:, 1] - ends[:, 0]) * rng.random((100, len(ends)))
    placed = [centres(robot, q) for q in poses]
    for found in allowed_collisions(robot):
        gaps = np.array([gap_of(robot, found.links, at) for at in placed])
        assert gap_at(robot, found.links, found.nearest) == pytest.approx(found.gap, abs=1e-9)
        if found.spheres is Spheres.NEVER:
            assert gaps.min() >= found.proved_gap > 0
        elif found.spheres is Spheres.ALWAYS:
            assert gaps.max() <= 0
        elif found.spheres is Spheres.SOMETIMES:
            assert found.gap <= gaps.min() + 1e-3
            assert gap_at(robot, found.links, found.apart) > 0 >= found.gap
        for q in (found.nearest, found.apart):
            assert q is None or ((ends[:, 0] <= q) & (q <= ends[:, 1])).all()


# --- links, SRDF and the command ------------------------------------------------------------------


def test_links_by_the_names_of_balls() -> None:
    balls = [ball("5", "0", (0, 0, 0), 0.1), ball("arm/1", "1", (1, 0, 0), 0.1)]
    tip = ball("tip", "1", (2, 0, 0), 0.0)
    pair = Pair("one", ("arm/1", "5"))
    robot = arm([joint(Revolute, 0)], [*balls, tip], (pair,))
    assert [(link.name, len(link.balls)) for link in links(robot)] == [("0", 1), ("arm", 1)]
    assert link_pair(robot, pair) == "one"
    both = [ball("arm/1", "0", (0, 0, 0), 0.1), ball("arm/2", "1", (1, 0, 0), 0.1)]
    with pytest.raises(ValueError, match="link arm stand in several frames: 0, 1"):
        links(arm([joint(Revolute, 0)], both))
    body = Body("blade", "1", Capsule(np.zeros(3), np.ones(3), 0.1))
    with pytest.raises(ValueError, match="these bodies are none: blade"):
        links(replace(robot, bodies=(body,)))


def test_srdf_escapes_names_and_disables_what_is_proved() -> None:
    names = ['a "b" <&>', "ünï/ted", "c"]
    balls = [
        ball(f"{names[0]}/1", "0", (0, 0, 0), 0.2), ball(f"{names[1]}/1", "1", (0.3, 0, 0), 0.2),
        ball(f"{names[2]}/1", "2", (0.5, 0, 0), 0.1),
    ]  # fmt: skip
    joints = [joint(Revolute, 0), joint(Revolute, 1, origin=(0.3, 0, 0))]
    robot = replace(arm(joints, balls), name="<robot>")
    found = allowed_collisions(robot)
    root = ET.fromstring(srdf_text(robot, found))
    assert root.attrib == {"name": "<robot>"}
    rows = {(row.get("link1"), row.get("link2")): row.get("reason") for row in root}
    assert rows == {(names[1], names[2]): "Never"}  # the spheres of the others always meet
    found = allowed_collisions(robot, inside=balls)
    root = ET.fromstring(srdf_text(robot, found))
    rows = {(row.get("link1"), row.get("link2")): row.get("reason") for row in root}
    assert rows == {(names[0], names[1]): "Adjacent", (names[1], names[2]): "Never"}
    for contact, neighbours, reason in (
        (Contact.UNPROVED, True, None), (Contact.UNPROVED, False, None),
        (Contact.ALWAYS, True, "Adjacent"), (Contact.ALWAYS, False, "Always"),
    ):  # fmt: skip
        row = replace(found[1], contact=contact, neighbours=neighbours)
        assert disabling_reason(row) == reason
    with pytest.raises(ValueError, match="a letter that XML cannot hold"):
        srdf_text(replace(robot, name="\x1b[2J"), found)


def test_the_command(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    save_robot(wheel(0.1, 0.25), "wheel.toml")
    assert main(["allowed", "wheel.toml", "--json", "a.json", "--srdf", "a.srdf"]) == 0
    out, err = capsys.readouterr()
    counts, written = out.splitlines()[-2:]
    assert (counts, err) == ("1 pair of links: 1 never in contact", "")
    assert written == "written: a.json, a.srdf"
    assert "0.125 m apart at least (proved); 0.25 m found" in out
    follows_schema(json.loads((tmp_path / "a.json").read_text()), "allowed")
    assert ET.parse("a.srdf").getroot()[0].get("reason") == "Never"
    assert main(["allowed", "wheel.toml", "--cells", "1"]) == 3
    assert "not decided" in capsys.readouterr().out
    assert main(["allowed", "minervabot-v2", "--srdf", "b.srdf"]) == 2
    assert "these bodies are none: 0, 1, 2" in capsys.readouterr().err
    assert not (tmp_path / "b.srdf").exists()
    for line in (["--cells", "0"], ["--srdf", "wheel.toml"]):
        assert main(["allowed", "wheel.toml", *line]) == 2
