"""Parallelograms: places, distances and files of a joint that carries without turning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cspace import RobotFileError, clearance, find_region, load_robot, margins, save_robot
from cspace.arms.allowed import Spheres, allowed_collisions
from cspace.arms.why import why
from cspace.boundary.evaluator import evaluator
from cspace.cli import main
from cspace.model.robot import Prismatic, Revolute, Robot
from cspace.model.robotfile import parse_robot
from cspace.model.robotfile import robot_table as table_of
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.exact.region import prove_region
from engine_support import second_checker
from engine_support.arms import joint as row
from engine_support.arms import robot_table
from engine_support.ball_arms import parallelogram_arm as arm
from engine_support.urdf import BALL, joint, link, rotation, transform, written
from qbound.boundary import position


@pytest.mark.parametrize("last", [Revolute, Prismatic])
@pytest.mark.parametrize("seed", range(3))
def test_forms_are_what_frames_say(seed, last) -> None:
    robot = arm(seed, last)
    rng = np.random.default_rng(seed)
    compiled = evaluator(robot, limits=False)
    for q in rng.uniform(-1, 1, (4, 3)):
        frames = robot.frames(q)
        gaps = []
        for pair in robot.boundaries:
            distance = np.linalg.norm(frames.position(*pair.points, "0"))
            gaps.append(distance - 0.02)
            assert clearance(robot, pair)(q) == pytest.approx(distance**2 - 0.02**2, abs=1e-12)
        assert compiled.margins(q) == pytest.approx(gaps, abs=1e-12)
        for point in robot.points:
            seen = frames.position("0", point.name, "0")
            assert position(robot, point.name)(q) == pytest.approx(seen, abs=1e-12)
            assert np.linalg.norm(seen) <= robot.stretched(point.name) + 1e-12
        for name in ("pbar", "p2", "p3"):
            seen = frames.position("bar", name, "bar")
            assert position(robot, name, "bar")(q) == pytest.approx(seen, abs=1e-12)
    with pytest.raises(ValueError, match="'2' does not precede 'bar'"):
        position(robot, "pbar", "2")


def test_it_survives_its_file_and_its_exact_forms_hold_the_floats(tmp_path) -> None:
    robot = arm(3)
    save_robot(robot, tmp_path / "arm.toml")
    again = load_robot(tmp_path / "arm.toml")
    assert again.joints[1].bar == "bar"
    assert again.joints[1].crank == pytest.approx(robot.joints[1].crank, rel=1e-15)
    for exact in (exact_robot(robot), exact_robot(tmp_path / "arm.toml")):
        forms = exact_problem(exact).forms.coefficients
        floats = [clearance(robot, pair).coefficients for pair in robot.boundaries]
        wanted = np.stack(floats)
        assert forms.shape == wanted.shape
        assert np.abs(np.vectorize(middle)(forms) - wanted).max() < 1e-12


def middle(number) -> float:
    """The middle of a ball, or a rational as a float."""
    return float(number.mid()) if hasattr(number, "mid") else int(number.p) / int(number.q)


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"crank": None}, "joint[1] (p): crank is missing; a parallelogram needs one"),
        ({"bar": None}, "joint[1] (p): bar is missing; a parallelogram needs one"),
        ({"bar": "1"}, "joint[1].bar (p): '1' closes a cycle"),
        ({"bar": "2"}, "joint[1].frame (p): '2' closes a cycle"),
        ({"type": "revolute"}, "only a parallelogram has one; this joint is revolute"),
        ({"crank": [1, 2]}, "joint[1].crank (p)"),
    ],
)
def test_a_file_that_describes_none_is_refused(changed, says) -> None:
    table = table_of(arm(1))
    for key, value in changed.items():
        table["joint"][1][key] = value
        if value is None:
            del table["joint"][1][key]
    with pytest.raises(RobotFileError) as error:
        parse_robot(table)
    assert says in str(error.value)


def test_a_bar_that_meets_what_it_carries_does_so_sometimes() -> None:
    """It was cut off in front of its own joint, and both took each other for at rest."""
    rows = [row("parallelogram", "0", "1", [0, 0, 0], [0, 0, 1], crank=[1, 0, 0], bar="bar")]
    nose = {"name": "nose/1", "frame": "1", "at": [-0.5, 0, 0], "radius": 0.125}  # on the bar at 0
    bar = {"name": "bar/1", "frame": "bar", "at": [0.5, 0, 0], "radius": 0.125}
    more = {"point": [bar, nose], "tool": "nose/1", "boundary": []}
    (found,) = allowed_collisions(parse_robot(robot_table(rows, {"q1": 0}, "1", **more)))
    assert (found.spheres, found.joints) == (Spheres.SOMETIMES, (0,))


# --- with bodies: an arm of two turns against each other says the same ----------------------------


def in_a_plane(last: str = "revolute", across: str = "[0, 1, 0]") -> str:
    """A parallelogram that carries an angled platform and a finger, between two obstacles."""
    tilted = across != "[0, 1, 0]"

    def at(x: float, z: float) -> str:
        """Write a place of the plane: of x and z, or across [3, 4, 0]."""
        return f"[{x * 0.8:.6g}, {-x * 0.6:.6g}, {z}]" if tilted else f"[{x}, 0, {z}]"

    def loop(*corners: tuple[float, float]) -> str:
        return f"[{', '.join(at(*corner) for corner in corners)}]"

    axis = across if last == "revolute" else at(1, 0)
    limits = {"revolute": "[-170, 170]", "prismatic": "[-0.2, 0.6]"}[last]
    platform = [(-0.05, -0.08), (0.25, -0.08), (0.25, 0.02)]
    platform += [(0.05, 0.02), (0.05, 0.1), (-0.05, 0.1)]
    finger, foot = (
        [(x, -z), (y, -z), (y, z), (x, z)] for x, y, z in ((0, 0.3, 0.02), (-0.1, 0.2, 0.1))
    )
    text = f"""
schema = 1
name = "palletizer"
length_unit = "m"
angle_unit = "deg"
home = {{lift = 0, hand = 0}}
tool = "tip"
collisions = "all"
allowed = [["bar", "platform"], ["bar", "foot"], ["platform", "finger"]]
joint = [
    {{name = "lift", type = "parallelogram", parent = "0", frame = "2", bar = "bar",
      origin = {at(0.1, 0.2)}, axis = {across}, crank = {at(0.5, 0.1)}}},
    {{name = "hand", type = "{last}", parent = "2", frame = "3", origin = {at(0.2, -0.05)},
      axis = {axis}, limits = {limits}}},
]
point = [{{name = "tip", frame = "3", at = {at(0.3, 0)}}}]
body = [
    {{name = "bar", frame = "bar",
      capsule = {{from = {at(0, 0)}, to = {at(0.5, 0.1)}, radius = 0.04}}}},
    {{name = "platform", frame = "2", polygon = {loop(*platform)}}},
    {{name = "finger", frame = "3", polygon = {loop(*finger)}}},
]
obstacle = [
    {{name = "foot", polygon = {loop(*foot)}}},
    {{name = "post", disc = {{at = {at(0.7, 0.75)}, radius = 0.1}}}},
]
"""
    return text.replace(",\n      ", ", ")


SCENES = [("revolute", "[0, 1, 0]"), ("prismatic", "[0, 1, 0]"), ("revolute", "[3, 4, 0]")]


def with_two_turns(robot: Robot) -> Robot:
    """Return the arm of three joints that is the same where the second has the first's value."""
    p = robot.joints[0]
    bar = Revolute("bar", "0", "bar", origin=p.origin, mount=p.mount, axis=p.axis)
    back = Revolute("back", "bar", "2", origin=p.crank, mount=np.eye(3), axis=-p.axis)
    return replace(robot, joints=(bar, back, robot.joints[1]), home=np.zeros(3), source=None)


@pytest.mark.parametrize(("last", "across"), SCENES)
def test_bodies_keep_apart_as_those_of_two_turns_do(last, across) -> None:
    robot = parse_robot(in_a_plane(last, across))
    region, count = find_region(robot), len(robot.used)
    assert not region.unresolved
    ends = robot.joints[1].limits
    q = np.random.default_rng(8).uniform([-3.1, ends[0]], [3.1, ends[1]], (1000, 2))
    found = margins(robot, q)[:, :count]
    wanted = margins(with_two_turns(robot), q[:, [0, 0, 1]])[:, :count]
    assert found == pytest.approx(wanted, abs=1e-12)
    clear = np.abs(wanted).min(axis=1) > 1e-9
    feasible = wanted.min(axis=1) > 0
    assert 100 < feasible.sum() < 900
    assert (region.contains(q) == feasible)[clear].all()
    inside = [region.component_of(x) is not None for x in q[clear][:200]]  # by its arcs
    assert inside == feasible[clear][:200].tolist()


def test_proofs_and_certificates_know_its_bodies(tmp_path) -> None:
    file, proof = tmp_path / "arm.toml", tmp_path / "proof.json"
    file.write_text(in_a_plane())
    region = find_region(load_robot(file))
    proved = prove_region(exact_problem(exact_robot(file)), region)
    assert len(proved.components) == len(region.components) > 2
    box = ["--box", "lift=-5deg:5deg", "hand=-20deg:20deg"]
    assert main(["certify", str(file), *box, "-o", str(proof)]) == 0
    assert main(["check", str(proof), str(file)]) == 0
    assert second_checker.verify(proof.read_text()) == "proved"
    found = why(file, [0.0, 0.0], [0.0, 1.0])
    assert (found.answer, found.certificate.verdict) == ("connected", "proved")


# --- from a URDF ----------------------------------------------------------------------------------


def palletizer(folder, mimic: str, axis: str = "0 1 0", kind: str = "revolute"):
    parts = [link(name, BALL) for name in ("base", "turret", "bar", "head", "hand")]
    parts += [
        joint("turn", "base", "turret", more="<axis xyz='0 0 1'/><origin xyz='0 0 0.4'/>"),
        joint("lift", "turret", "bar", more="<axis xyz='0 1 0'/><origin xyz='0.1 0 0'/>"),
        joint(
            "level", "bar", "head", kind,
            f"<axis xyz='{axis}'/><origin xyz='0 0.05 0.6' rpy='0 0.3 0'/>{mimic}",
        ),
        joint("wrist", "head", "hand", more="<axis xyz='1 0 0'/><origin xyz='0.3 0 0'/>"),
    ]  # fmt: skip
    return written(folder, *parts)


@pytest.mark.parametrize(("axis", "multiplier"), [("0 1 0", -1), ("0 -2 0", 1)])
def test_a_mimic_joint_that_turns_back_is_a_parallelogram(tmp_path, axis, multiplier) -> None:
    mimic = f"<mimic joint='lift' multiplier='{multiplier}' offset='0.2'/>"
    robot = load_robot(palletizer(tmp_path, mimic, axis))
    assert [j.type_name for j in robot.joints] == ["revolute", "parallelogram", "revolute"]
    y = np.array([0, 1.0, 0])
    for q in np.random.default_rng(5).uniform(-0.5, 0.5, (5, 3)):
        turret = transform(rotation(np.array([0, 0, 1.0]), q[0]), np.zeros(3))
        turret = transform(np.eye(3), np.array([0, 0, 0.4])) @ turret
        bar = turret @ transform(np.eye(3), np.array([0.1, 0, 0]))
        bar = bar @ transform(rotation(y, q[1]), np.zeros(3))
        own = np.array([float(x) for x in axis.split()])
        head = bar @ transform(rotation(y, 0.3), np.array([0, 0.05, 0.6]))
        head = head @ transform(rotation(own, multiplier * q[1] + 0.2), np.zeros(3))
        hand = head @ transform(np.eye(3), np.array([0.3, 0, 0]))
        hand = hand @ transform(rotation(np.array([1.0, 0, 0]), q[2]), np.zeros(3))
        frames = robot.frames(q)
        places = {"turret/1": turret, "bar/1": bar, "head/1": head, "hand/1": hand}
        for name, matrix in places.items():
            found = frames.position("base", name, "base")
            assert found == pytest.approx(matrix[:3, 3], abs=2e-5), name
        tool = frames.position("base", robot.tool, "base")
        assert tool == pytest.approx(hand[:3, 3], abs=1e-12)
    # The bar is a neighbour of both its ends, which are no neighbours of each other.
    pairs = {b.name for b in robot.boundaries}
    assert pairs == {
        "base/1, bar/1", "base/1, head/1", "base/1, hand/1",
        "turret/1, head/1", "turret/1, hand/1", "bar/1, hand/1",
    }  # fmt: skip
    # Limits of both joints: lift in [-1, 2]; level, that is +-lift + 0.2, in [-1, 2].
    low, high = sorted(((-1 - 0.2) / multiplier, (2 - 0.2) / multiplier))
    assert robot.joints[1].limits == pytest.approx((max(-1, low), min(2, high)), rel=1e-12)


@pytest.mark.parametrize(
    ("mimic", "axis", "kind"),
    [
        ("<mimic joint='lift' multiplier='1'/>", "0 1 0", "revolute"),
        ("<mimic joint='lift' multiplier='-0.5'/>", "0 1 0", "revolute"),
        ("<mimic joint='lift' multiplier='-1'/>", "0 1 0.001", "revolute"),
        ("<mimic joint='lift' multiplier='-1'/>", "0 1 0", "prismatic"),
        ("<mimic joint='turn' multiplier='-1'/>", "0 1 0", "revolute"),
        ("<mimic joint='wrist' multiplier='-1'/>", "0 1 0", "revolute"),
    ],
)
def test_other_joints_that_follow_one_are_refused_by_name(tmp_path, mimic, axis, kind) -> None:
    with pytest.raises(RobotFileError, match=r"joint 'level': follows joint '\w+' \(mimic\)"):
        load_robot(palletizer(tmp_path, mimic, axis, kind))
