"""Ranges that nothing passes, by hand and by brute force; certificates, true and forged."""

import copy
import json
import math
import random
import tomllib
from functools import cache
from importlib import resources

import numpy as np
import pytest
from jsonschema import ValidationError, validate

from qbound import check
from qbound.arms.separations import separation, separations
from qbound.model.robotfile import parse_robot
from qbound.proofs import check_arb
from qbound.proofs.blocked import blocked_ranges
from qbound.proofs.no_path import certify_no_path
from support import brute_force, mutations
from support.certificates import in_robot, put
from support.elbow import CLOSED, SLIDE, arm
from support.robot_files import robot_file

ROUND = ""  # no limits: the elbow turns all the way round


def robot_of(text):
    return parse_robot(tomllib.loads(text))


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "arm.toml"
        path.write_text(text)
        return path

    return write


# --- ranges ---------------------------------------------------------------------------------------


def test_limits_of_two_turns_leave_three_ranges(file):
    _, elbow, _ = separations(file(arm()))
    blocks = [(b.low, b.high) for b in elbow.blocks]
    assert np.allclose(blocks, [(-math.tau + CLOSED, -CLOSED), (CLOSED, math.tau - CLOSED)])
    assert all(low >= CLOSED - 1e-15 for low, _ in blocks[1:])  # rounded inwards
    assert len(elbow.free) == 3
    assert [elbow.part(x) for x in (-6.0, 0.0, 3.1, 6.0)] == [0, 1, None, 2]
    assert elbow.blocks[0].links == ("upper arm, forearm",)


def test_other_joints_are_free(file):
    shoulder, _, wrist = separations(file(arm()))
    assert shoulder.blocks == wrist.blocks == ()
    assert shoulder.free == ((-math.tau, math.tau),)


def test_limits_of_half_a_turn_leave_one_range(file):
    _, elbow, _ = separations(file(arm("limits = [-180, 180]")))
    assert np.allclose(elbow.free, [(-CLOSED, CLOSED)])
    assert elbow.blocks[0].low == -math.pi


def test_one_block_round_a_joint_separates_nothing(file):
    travels = separations(file(arm(ROUND)))
    assert np.allclose(travels[1].free, [(math.tau - CLOSED, math.tau + CLOSED)])
    assert travels[1].part(0.0) == travels[1].part(-20 * math.tau + 1) == 0
    assert separation(travels, [0, -2, 0], [0, 2, 0]) is None


def test_two_blocks_round_a_joint_do():
    travels = separations("minervabot-v2")
    found = separation(travels, [0, 0], [0, 2.3])
    assert [block.links for block in found.blocks] == [("B3",), ("B4",)]
    assert separation(travels, [0, 0], [0, 2.3 - math.tau]).blocks == found.blocks
    assert separation(travels, [0, 0], [0, math.tau + 0.1]) is None


def test_a_slide_is_blocked_between_the_roots_of_a_quadratic(file):
    slide, arm_of_it = separations(file(SLIDE))
    (block,) = slide.blocks
    assert np.allclose([block.low, block.high], [-0.4, 0.4])
    assert -0.4 <= block.low < block.high <= 0.4
    assert separation((slide, arm_of_it), [-1, 0], [1, 0]).travel.name == "x"


def test_a_ball_off_the_axis_of_another_joint_narrows_the_range(file):
    """The other joint moves the ball by 2 mm: what is left is blocked for all its values."""
    (on_axis,) = (r for r in blocked_of(arm(wrist=1e-12)) if r.joint == 1)
    (off_axis,) = (r for r in blocked_of(arm(wrist=0.002)) if r.joint == 1)
    assert on_axis.low < off_axis.low < off_axis.high < on_axis.high
    assert on_axis.low == pytest.approx(CLOSED, abs=1e-9)


def blocked_of(text):
    robot = robot_of(text)
    return blocked_ranges(robot, robot)


@pytest.mark.parametrize("seed", range(20))
def test_what_is_blocked_is_violated_whatever_the_other_joints_are(seed):
    """By an evaluator that shares no code, over the range, ends included, and the other joints."""
    text = robot_file(seed, 3, "revolute prismatic").replace("clearance = ", "clearance = 1")
    robot, table = robot_of(text), tomllib.loads(text)
    rng = np.random.default_rng(seed)
    for found in blocked_of(text):
        limits = [joint.limits or (-math.pi, math.pi) for joint in robot.joints]
        q = np.stack([rng.uniform(*ends, 400) for ends in limits], axis=1)
        low, high = limits[found.joint] if not robot.joints[found.joint].turns else (-9, 9)
        ends = max(found.low, low), min(found.high, high)
        if ends[0] >= ends[1]:
            continue
        q[:, found.joint] = [*ends, *rng.uniform(*ends, 398)]
        q[:, [j.turns for j in robot.joints]] *= 180 / math.pi
        margins = brute_force.margins(table, {"margin": "0"}, q)[found.boundary]
        assert margins.max() <= 1e-9


def test_the_sampled_robots_do_block_ranges():
    texts = [robot_file(seed, 3, "revolute prismatic") for seed in range(20)]
    wide = [text.replace("clearance = ", "clearance = 1") for text in texts]
    assert sum(bool(blocked_of(text)) for text in wide) > 5


def test_nothing_that_may_be_kept_is_blocked(file):
    """A pair that depends on one joint: outside its range some configuration keeps it."""
    _, elbow, _ = separations(file(arm()))
    table = tomllib.loads(arm())
    for low, high in elbow.free:
        q = np.zeros((50, 3))
        q[:, 1] = np.degrees(np.linspace(low + 1e-9, high - 1e-9, 50))
        assert brute_force.margins(table, {"margin": "0"}, q)["folded"].min() >= 0


# --- certificates ---------------------------------------------------------------------------------


@cache
def certificate(elbow="limits = [-360, 360]", goal=4.0, unit="deg"):
    text = arm(elbow, unit=unit)
    ranges = [r for r in blocked_of(text) if r.joint == 1]
    return certify_no_path(text, [0.1, 1.0, 0], [0.2, goal, 0.3], ranges)


@cache
def round_certificate():
    from qbound.model.robotfile import robot_text

    found = separation(separations("minervabot-v2"), [0, 0], [0, 2.3])
    ranges = [block.ranges[0] for block in found.blocks]
    return certify_no_path(robot_text("minervabot-v2")[0], [0, 0], [0, 2.3], ranges)


@cache
def slide_certificate():
    ranges = [r for r in blocked_of(SLIDE) if r.joint == 0 and r.boundary == "passing"]
    return certify_no_path(SLIDE, [-1.0, 0], [1.0, 2.0], ranges)


def radians():
    text = arm(unit="rad").replace("[-360, 360]", "[-6.5, 6.5]").replace("[-180, 180]", "[-3, 3]")
    ranges = [r for r in blocked_of(text) if r.joint == 1]
    return certify_no_path(text, [0.1, 1.0, 0], [0.2, 4.0, 0.3], ranges)


@pytest.mark.parametrize(
    "made", [certificate, round_certificate, slide_certificate, radians], ids=lambda f: f.__name__
)
def test_both_checkers_and_the_schema_accept_it(made):
    found = made()
    assert found.verdict == "proved", found.said
    assert check_arb.verify(found.text) == "proved"
    answer = check.check(found.text)
    assert not answer.refuted
    assert "no path from" in answer.said
    validate(json.loads(found.text), schema())


@cache
def schema():
    file = resources.files("qbound") / "schemas" / "certificate.schema.json"
    return json.loads(file.read_text())


def test_the_schema_knows_what_belongs_to_no_path():
    data = json.loads(certificate().text)
    for wrong in (
        data | {"schema": "qbound/certificate/2"},
        data | {"statement": data["statement"] | {"set": "path"}},
        data | {"proof": {"folded": ["."]}},
    ):
        with pytest.raises(ValidationError):
            validate(wrong, schema())


def test_a_separation_that_is_none_is_not_written():
    text = arm(ROUND)
    (only,) = (r for r in blocked_of(text) if r.joint == 1)
    assert certify_no_path(text, [0, 1, 0], [0, 4, 0], [only]).verdict == "undecided"
    assert certificate(goal=2.0).verdict == "undecided"  # both on one side
    assert certificate(goal=3.1).verdict == "undecided"  # in the range


def refused(data):
    text = json.dumps(data)
    with pytest.raises(check.Refused):
        check.check(text)
    assert not accepted(check_arb.verify, text)


def ends(low, high):
    return lambda data: data["proof"]["blocked"][0].update({"from": low, "to": high})


BLOCK = ("proof", "blocked", 0)
FORGED = {
    "a range that begins too early": put(*BLOCK, "from", "150"),
    "a range that ends too late": put(*BLOCK, "to", "210"),
    "a range of nothing": ends("170", "170"),
    "a range turned round": ends("190", "170"),
    "a range a turn away": ends("-190", "-170"),
    "a range far away": ends("1970", "1990"),
    "another boundary": put(*BLOCK, "boundary", "floor"),
    "a boundary that is not there": put(*BLOCK, "boundary", "wall"),
    "a limit for a boundary": put(*BLOCK, "boundary", "elbow.lower"),
    "another joint": put("proof", "joint", "wrist"),
    "a joint that is not there": put("proof", "joint", "knee"),
    "a joint by its number": put("proof", "joint", 1),
    "both on one side": put("statement", "points", 0, 1, 1, "60"),
    "a goal in the range": put("statement", "points", 0, 1, 1, "180"),
    "a start in the range": put("statement", "points", 0, 0, 1, "170"),
    "a goal beyond a limit": put("statement", "points", 0, 1, 1, "361"),
    "a start beyond a limit": put("statement", "points", 0, 0, 2, "-181"),
    "one configuration": put("statement", "points", 0, lambda points: points[:1]),
    "three configurations": put("statement", "points", 0, lambda points: [*points, points[0]]),
    "a configuration of two values": put("statement", "points", 0, 0, ["0", "0"]),
    "NaN": put("statement", "points", 0, 0, 1, "NaN"),
    "a range from NaN": put(*BLOCK, "from", "NaN"),
    "a range to infinity": put(*BLOCK, "to", "inf"),
    "a bare number": put(*BLOCK, "to", 190),
    "a tree cut short": put(*BLOCK, "tree", "."),
    "a tree that goes on": put(*BLOCK, "tree", lambda tree: tree + "."),
    "a tree without its end": put(*BLOCK, "tree", lambda tree: tree[:-1]),
    "a tree that cuts another joint": put(*BLOCK, "tree", lambda tree: tree.replace("b", "a")),
    "a tree with a feature": put(*BLOCK, "tree", lambda tree: tree[:-1] + "3."),
    "no tree": put(*BLOCK, "tree", ""),
    "no range": put("proof", "blocked", []),
    "two ranges": put("proof", "blocked", lambda rows: rows * 2),
    "a key too many": put(*BLOCK, "note", "x"),
    "a key too few": lambda d: d["proof"]["blocked"][0].pop("tree"),
    "no joint": lambda d: d["proof"].pop("joint"),
    "no proof": lambda d: d.pop("proof"),
    "parts": put("parts", {}),
    "triangles": put("statement", "triangles", []),
    "a larger grammar": put("schema", "qbound/certificate/5"),
    "a smaller grammar": put("schema", "qbound/certificate/3"),
    "another set": put("statement", "set", "path"),
    "the other verdict": put("verdict", "refuted"),
    "another hash": put("sha256", "0" * 64),
    "no limits, so that one may go round": in_robot("axis = [0, 1, 0]\nlimits = [-360, 360]",
                                                    "axis = [0, 1, 0]"),
    "limits that end before the goal": in_robot("[0, 1, 0]\nlimits = [-360, 360]",
                                                "[0, 1, 0]\nlimits = [-360, 200]"),
    "smaller balls": in_robot("radius = 0.1\n", "radius = 0.09\n"),
    "a boundary that is not used": in_robot('name = "folded"', 'name = "folded"\nused = false'),
    "a longer forearm": in_robot('"forearm"\nat = [0.5', '"forearm"\nat = [0.6'),
}  # fmt: skip


@pytest.mark.parametrize("name", FORGED)
def test_a_forged_certificate_proves_nothing(name):
    data = copy.deepcopy(json.loads(certificate().text))
    FORGED[name](data)
    refused(data)


def test_a_margin_widens_what_is_blocked_and_a_true_range_stays_true():
    data = json.loads(certificate().text)
    data["statement"]["margin"] = "0.01"
    assert not check.check(json.dumps(data)).refuted
    assert check_arb.verify(json.dumps(data)) == "proved"


FORGED_ROUND = {
    "one range": put("proof", "blocked", lambda rows: rows[:1]),
    "one range twice": put("proof", "blocked", lambda rows: rows[:1] * 2),
    "ranges turned round": put("proof", "blocked", lambda rows: rows[::-1]),
    "a goal in the start's range": put("statement", "points", 0, 1, 1, "20"),
    "that goal a turn away": put("statement", "points", 0, 1, 1, "380"),
    "a goal in a range": put("statement", "points", 0, 1, 1, "44.5"),
    "a goal in a range, turns away": put("statement", "points", 0, 1, 1, "-1035.5"),
    "a start on the other side": put("statement", "points", 0, 0, 1, "100"),
}


@pytest.mark.parametrize("name", FORGED_ROUND)
def test_round_a_joint_both_ways_are_blocked(name):
    data = copy.deepcopy(json.loads(round_certificate().text))
    FORGED_ROUND[name](data)
    refused(data)


@pytest.mark.parametrize("turns", [-4, -1, 1, 4])
def test_a_goal_may_be_named_by_any_turn(turns):
    data = copy.deepcopy(json.loads(round_certificate().text))
    value = float(data["statement"]["points"][0][1][1]) + 360 * turns
    data["statement"]["points"][0][1][1] = str(value)
    assert not check.check(json.dumps(data)).refuted
    assert check_arb.verify(json.dumps(data)) == "proved"


def accepted(checker, text):
    try:
        checker(text)
    except (ValueError, ArithmeticError, LookupError, TypeError):
        return False
    return True


@pytest.mark.parametrize("seed", range(3))
def test_both_checkers_answer_alike_about_mutants_and_tell_the_truth(seed):
    """Mutants of these certificates; what both accept is judged by brute force."""
    rng = random.Random(seed)
    texts = [made().text for made in (certificate, round_certificate, slide_certificate)]
    for _ in range(60):
        data = json.loads(rng.choice(texts))
        for _ in range(rng.choice((1, 1, 2))):
            rng.choice((*mutations.CHANGES, in_block))(rng, data)
        text = json.dumps(data)
        ours = accepted(check.check, text)
        assert ours == accepted(check_arb.verify, text), text
        assert not ours or is_true(json.loads(text)), text


def in_block(rng, data):
    """Move a range, or change what it says."""
    proof = data.get("proof")
    rows = proof.get("blocked") if isinstance(proof, dict) else None
    if isinstance(rows, list) and rows and isinstance(rows[0], dict):
        row = rng.choice([row for row in rows if isinstance(row, dict)])
        key = rng.choice(("from", "to", "boundary", "tree"))
        if key in ("from", "to") and isinstance(row.get(key), str):
            value = row[key] if mutations.is_decimal(row[key]) else "0"
            row[key] = mutations.moved(rng, value)
        elif key == "boundary":
            row[key] = rng.choice(("B1", "B2", "B3", "folded", "floor", "passing", "arm passing"))
        else:
            row["tree"] = rng.choice((".", "a..", "b..", "c..", "bb...", "b.b.."))


def is_true(data):
    """Judge by samples: violated all over the ranges, and one of them on every way."""
    robot, statement = tomllib.loads(data["robot"]), data["statement"]
    names = [joint["name"] for joint in robot["joint"]]
    j, rng = names.index(data["proof"]["joint"]), np.random.default_rng(0)
    limits = [joint.get("limits", [-180, 180]) for joint in robot["joint"]]
    start, goal = (float(q[j]) for q in statement["points"][0])
    spans = []
    for row in data["proof"]["blocked"]:
        low, high = float(row["from"]), float(row["to"])
        q = np.stack([rng.uniform(*ends, 300) for ends in limits], axis=1)
        q[:, j] = np.linspace(low, high, 300)
        if brute_force.margins(robot, statement, q)[row["boundary"]].max() > 1e-9:
            return False
        spans.append((low, high))
    if "limits" in robot["joint"][j]:
        return any(min(start, goal) < low and high < max(start, goal) for low, high in spans)
    way = np.linspace(0, (goal - start) % 360, 4001)
    up, down = start + way, start - np.linspace(0, (start - goal) % 360, 4001)
    return all(
        any(((x - low) % 360 <= high - low).any() for low, high in spans) for x in (up, down)
    )
