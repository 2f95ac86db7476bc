"""Certificates, grammar 5: boxes that separate two configurations, other joints held."""

import copy
import hashlib
import itertools
import json
import math
import random
import re
import tomllib
from functools import cache, reduce
from importlib import resources

import numpy as np
import pytest
from jsonschema import ValidationError, validate
from scipy import ndimage

from qbound import check
from qbound.model.robotfile import parse_robot
from qbound.proofs import check_arb
from qbound.proofs.connection import connection
from qbound.proofs.disconnected import certify_disconnected
from qbound.proofs.exact import exact_problem, exact_robot
from qbound.proofs.statements import units
from support import brute_force, mutations, planar
from support.certificates import in_robot, put
from support.elbow import SLIDE

ASKED = {
    "one joint round": (planar.turning("deg"), ["70"], ["-100"], [0]),
    "one joint round, radians": (planar.turning("rad"), ["1.2"], ["-1.9"], [0]),
    "two joints round": (planar.round_both("deg"), ["50", "110"], ["166", "0"], [0, 1]),
    "two joints round, radians": (planar.round_both("rad"), ["0.9", "2"], ["2.9", "0"], [0, 1]),
    "three joints": (planar.caged("deg"), ["0", "110", "0"], ["0", "-110", "10"], [0, 1, 2]),
    "wrist held": (planar.caged("deg"), ["0", "110", "20"], ["9", "-110", "20"], [0, 1]),
    "wrist held, radians": (planar.caged("rad"), ["0", "2", "0.3"], ["0", "-2", "0.3"], [0, 1]),
    "shoulder held": (planar.caged("deg"), ["5", "110", "20"], ["5", "-110", "0"], [1, 2]),
    "slide held": (planar.telescope(), ["0", "-0.3"], ["175", "-0.3"], [0]),
    "turning and sliding": (planar.telescope(), ["0", "-0.3"], ["175", "-0.3"], [0, 1]),
    "sliding, a turn held": (SLIDE, ["-1", "5"], ["1", "5"], [0]),
}
"""Robot, start, goal, joints that move."""


@cache
def certificate(name):
    text, start, goal, free = ASKED[name]
    robot = parse_robot(tomllib.loads(text))
    ends = np.array([start, goal], dtype=float) * units(robot)
    held = {j: ends[0, j] for j in range(len(start)) if j not in free}
    found = connection(exact_problem(exact_robot(robot), held), *ends[:, free])
    assert found.answer == "separated"
    return certify_disconnected(text, *ends, found.paving)


def data_of(name):
    return json.loads(certificate(name).text)


@cache
def schema():
    file = resources.files("qbound") / "schemas" / "certificate.schema.json"
    return json.loads(file.read_text())


def accepted(checker, data):
    try:
        checker(json.dumps(data))
    except ValueError:
        return False
    return True


def answers(data):
    return accepted(check.check, data), accepted(check_arb.verify, data)


# --- what is written ------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ASKED)
def test_both_checkers_the_schema_and_brute_force_accept_it(name):
    found = certificate(name)
    assert found.verdict == "proved", found.said
    assert check_arb.verify(found.text) == "proved"
    said = check.check(found.text).said
    assert "no path from" in said
    validate(json.loads(found.text), schema())
    assert is_true(json.loads(found.text))


def test_the_answer_names_what_is_held_and_what_is_violated():
    said = check.check(certificate("wrist held").text).said
    assert "along which 'wrist' = 20 deg keeps" in said
    assert "all over which 'front' or 'left' or 'right' or 'tip front' is violated" in said
    assert "along which" not in check.check(certificate("three joints").text).said


def test_the_tree_is_small():
    """The paving of the cage has thousands of cells; a wall needs a handful."""
    tree = data_of("three joints")["proof"]["tree"]
    assert len(re.findall("[0-9]+[.]", tree)) < 20


@pytest.mark.parametrize("unit", ["deg", "rad"])
@pytest.mark.parametrize("turns", [-4, -1, 1, 4])
def test_a_configuration_may_be_named_by_any_turn(unit, turns):
    name = "two joints round" + ", radians" * (unit == "rad")
    for end, j in itertools.product((0, 1), repeat=2):
        data = data_of(name)
        point = data["statement"]["points"][0][end]
        point[j] = f"{float(point[j]) + turns * (360 if unit == 'deg' else math.tau):.12f}"
        assert answers(data) == (True, True)
        assert is_true(data)


def test_a_margin_widens_what_is_violated():
    data = data_of("three joints")
    data["statement"]["margin"] = "0.01"
    assert answers(data) == (True, True)


def test_a_real_arm_in_a_cage_cannot_bend_its_elbow_the_other_way():
    """What `qbound why --hold` wrote in four seconds: 41 boxes of base, shoulder and elbow."""
    robot = planar.ur5_in_a_cage()
    points = [["0", "-120", "120", "-90", "-90", "0"], ["0", "-60", "-120", "-90", "-90", "0"]]
    data = data_of("wrist held") | {
        "statement": {"set": "no path", "margin": "0", "points": [points], "free": [0, 1, 2]},
        "robot": robot,
        "sha256": hashlib.sha256(robot.encode()).hexdigest(),
        "proof": {"boundaries": CAGE, "tree": TREE_OF_CAGE},
    }
    assert answers(data) == (True, True)
    assert is_true(data)
    data["proof"]["boundaries"] = [*CAGE[1:], CAGE[0]]
    assert answers(data) == (False, False)


CAGE = [
    "back wrist_3_link/1",
    "back forearm_link/9",
    "back wrist_1_link/1",
    "ceiling wrist_3_link/1",
    "front wrist_3_link/1",
    "front wrist_1_link/1",
    "front forearm_link/9",
]
TREE_OF_CAGE = (
    "cc.c.bbaca.a.b.0.ab0.ab1.bc1.a1.1..1.0.cab.0..b0.a0.2.b.b.c.3.bcb.3.3.cb3.bb3...abb.b.ca4."
    "4.4.4.bb.accb3.4.4.4.cb3.a.a.b3..a4.ca4.ba4..4.4.a4..cccbbb.baaaaab.c3.......3.3.b.ab4.5.a6.bb.4.6...."
)


def test_what_is_joined_is_not_certified():
    text, start, _, free = ASKED["two joints round"]
    robot = parse_robot(tomllib.loads(text))
    ends = np.array([start, ["60", "100"]], dtype=float) * units(robot)
    found = connection(exact_problem(exact_robot(robot)), *ends[:, free])
    assert found.answer == "connected"
    with pytest.raises(ValueError, match="does not separate"):
        certify_disconnected(text, *ends, found.paving)


# --- what is refused ------------------------------------------------------------------------------


def all_of(*changes):
    def change(data):
        for each in changes:
            each(data)

    return change


def without(k):
    """Take the number off the k-th leaf that has one."""

    def change(tree):
        spots = [*re.finditer("[0-9]+", tree)]
        return tree[: spots[k].start()] + tree[spots[k].end() :]

    return put("proof", "tree", change)


START, GOAL = ("statement", "points", 0, 0), ("statement", "points", 0, 1)
TREE, FREE = ("proof", "tree"), ("statement", "free")
HELD = {
    "nothing free": put(*FREE, []),
    "a joint free twice": put(*FREE, [0, 0, 1]),
    "joints turned round": put(*FREE, [1, 0]),
    "more than three": put(*FREE, [0, 1, 2, 3]),
    "a joint that is not there": put(*FREE, [0, 3]),
    "a joint by its name": put(*FREE, ["shoulder", "elbow"]),
    "a truth value": put(*FREE, [False, True]),
    "no list": put(*FREE, 1),
    "one joint too few": put(*FREE, [1]),
    "a joint more": put(*FREE, [0, 1, 2]),
    "held at two values": put(*GOAL, 2, "21"),
    "held beyond a limit": all_of(put(*START, 2, "61"), put(*GOAL, 2, "61")),
    "a start beyond a limit": put(*START, 0, "91"),
    "a start in a violated leaf": put(*START, 1, "0"),
    "a goal in a violated leaf": put(*GOAL, 1, "0"),
    "both on one side": put(*GOAL, 1, "100"),
    "NaN": put(*START, 0, "NaN"),
    "infinity": put(*START, 0, "inf"),
    "a value too large": put(*START, 0, "1e101"),
    "a bare number": put(*START, 0, 0),
    "a boundary that is not there": put("proof", "boundaries", 0, "nothing"),
    "a limit for a boundary": put("proof", "boundaries", 0, "elbow.lower"),
    "boundaries turned round": put("proof", "boundaries", lambda names: names[::-1]),
    "a boundary too few": put("proof", "boundaries", lambda names: names[:-1]),
    "no boundaries": put("proof", "boundaries", []),
    "numbers for boundaries": put("proof", "boundaries", lambda names: [0] * len(names)),
    "no tree": put(*TREE, ""),
    "a tree that is a list": put(*TREE, lambda tree: [tree]),
    "a tree of nothing": put(*TREE, "."),
    "all violated": put(*TREE, "0."),
    "a tree that goes on": put(*TREE, lambda tree: tree + "."),
    "a tree without its end": put(*TREE, lambda tree: tree[:-1]),
    "a tree that cuts a held joint": put(*TREE, lambda tree: "c" + tree + tree),
    "a tree that cuts no joint": put(*TREE, lambda tree: tree.replace("a", "d")),
    "a number with a zero before it": put(*TREE, lambda tree: tree.replace("0.", "00.")),
    "a number in other digits": put(*TREE, lambda tree: tree.replace("0.", "\u0660.")),
    "a number far away": put(*TREE, lambda tree: tree.replace("0.", "999999999.")),
    "too many cuts": put(*TREE, lambda tree: "a" * 121 + tree + "." * 121),
    "a wall too few": without(0),
    "the last wall too few": without(-1),
    "a key too many": put("proof", "note", "x"),
    "a key too few": lambda data: data["proof"].pop("tree"),
    "no free": lambda data: data["statement"].pop("free"),
    "the grammar before": put("schema", "qbound/certificate/4"),
    "the grammar after": put("schema", "qbound/certificate/6"),
    "another set": put("statement", "set", "path"),
    "the other verdict": put("verdict", "refuted"),
    "another hash": put("sha256", "0" * 64),
    "parts": put("parts", {}),
    "triangles": put("statement", "triangles", []),
    "an arm that is shorter": in_robot("origin = [1.0, 0, 0]", "origin = [0.7, 0, 0]"),
    "a cage that is wider": in_robot("offset = -1.2", "offset = -1.6"),
    "a boundary that is not used": in_robot('name = "front"', 'name = "front"\nused = false'),
    "a seam where the shoulder had limits": in_robot("limits = [-90, 90]\n", "\n"),
    "a seam where the elbow had limits": in_robot("limits = [-170, 170]\n", "\n"),
    "wider limits": in_robot("limits = [-90, 90]", "limits = [-180, 90]"),
    "limits beyond all angles": in_robot("limits = [-90, 90]", "limits = [-90, 1801]"),
}


@pytest.mark.parametrize("name", HELD)
def test_a_forged_certificate_proves_nothing(name):
    data = copy.deepcopy(data_of("wrist held"))
    HELD[name](data)
    assert answers(data) == (False, False)


@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_the_ends_of_a_joint_without_limits_are_joined(unit):
    """Only the post in the east is kept: the way over the seam is open."""
    data = data_of("one joint round" + ", radians" * (unit == "rad"))
    k = str(data["proof"]["boundaries"].index("west"))
    data["proof"]["tree"] = data["proof"]["tree"].replace(f"{k}.", ".")
    assert answers(data) == (False, False)
    low, high = ("-180", "180") if unit == "deg" else ("-3.1416", "3.1416")
    in_robot("axis = [0, 0, 1]\n", f"axis = [0, 0, 1]\nlimits = [{low}, {high}]\n")(data)
    assert answers(data) == (True, True)


def test_leaves_that_share_a_corner_are_joined():
    """Four leaves round a place, two of them violated: through the place there may be a path."""
    text, *_ = ASKED["wrist held"]
    data = data_of("wrist held")
    robot = text.replace("limits = [-90, 90]", "limits = [-80, 80]")
    robot = re.sub('(name = "front".*?offset = )-1.2', r"\g<1>5", robot, flags=re.DOTALL)
    data |= {"robot": robot, "sha256": hashlib.sha256(robot.encode()).hexdigest()}
    data["proof"] = {"boundaries": ["front"], "tree": "ab.0.b0.."}
    data["statement"]["points"] = [[["-40", "-90", "20"], ["40", "90", "20"]]]
    assert answers(data) == (False, False)
    data["proof"]["tree"] = "ab.0.b0.b0.."  # they share nothing any more
    assert answers(data) == (True, True)


@pytest.mark.parametrize("end", ["1", "1e-999"])
def test_long_limits_count_as_more_work(end, monkeypatch):
    """Every leaf on one side of a face touches every one on the other side."""
    monkeypatch.setattr("qbound.proofs.leaves.MOST_WORK", 2_000_000)
    robot = planar.planar(*[f"[-1, {end}]"] * 3, posts=planar.wall("far", 1, 0, -99))
    tree = "a" + reduce(lambda t, _: f"b{t}{t}", range(7), ".")
    data = {
        "schema": "qbound/certificate/5",
        "verdict": "proved",
        "statement": {
            "set": "no path",
            "margin": "0",
            "points": [[["-1", "-1", "-1"]] * 2],
            "free": [0, 1, 2],
        },
        "robot": robot,
        "sha256": hashlib.sha256(robot.encode()).hexdigest(),
        "proof": {"boundaries": ["far"], "tree": tree + tree[1:].replace("b", "c")},
    }
    with pytest.raises(ValueError, match="join" if end == "1" else "too much work"):
        check_arb.verify(json.dumps(data))


@pytest.mark.parametrize("seed", range(2))
def test_what_touches_is_what_a_lattice_says(seed):
    """Random trees over a robot that is violated everywhere: all that counts is which leaves touch.

    Values are often those of faces, and joints without limits often have a leaf at the seam.
    """
    rng = random.Random(seed)
    found = [is_as_the_lattice_says(rng) for _ in range(15)]
    assert 2 < sum(found) < 13


def is_as_the_lattice_says(rng):
    unit, count = rng.choice(("deg", "rad")), rng.choice((1, 2, 2, 3))
    size = 180.0 if unit == "deg" else 3.0
    limits = [rng.choice((None, (-size, size))) for _ in range(count)]
    whole = (-180.0, 180.0) if unit == "deg" else (-3.1416, 3.1416)
    robot = planar.planar(
        *("" if ends is None else str([*ends]) for ends in limits),
        unit=unit,
        posts=planar.wall("everywhere", 1, 0, 999),
    )
    free = list(range(count))
    tree = random_tree(rng, count, {1: 5, 2: 7, 3: 8}[count])
    cells = leaves(tree, free, [ends or whole for ends in limits])
    boxes = [(low, high) for low, high, number in cells if not number]
    ends = [place_in(rng, *rng.choice(boxes or [cells[0][:2]])) for _ in range(2)]
    data = {
        "schema": "qbound/certificate/5",
        "verdict": "proved",
        "statement": {"set": "no path", "margin": "0", "points": [ends], "free": free},
        "robot": robot,
        "sha256": hashlib.sha256(robot.encode()).hexdigest(),
        "proof": {"boundaries": ["everywhere"], "tree": tree},
    }
    start, goal = np.array(ends, dtype=float)
    turn = 360.0 if unit == "deg" else math.tau
    held, joined = told_by_lattice(boxes, start, goal, limits, whole, turn, closed=True)
    assert answers(data) == (held and not joined,) * 2, json.dumps(data)
    return held and not joined


def random_tree(rng, count, depth):
    if depth and rng.random() < 0.85:
        first, second = (random_tree(rng, count, depth - 1) for _ in range(2))
        return rng.choice("abc"[:count]) + first + second
    return rng.choice((".", ".", "0.", "0.", "0."))


def place_in(rng, low, high):
    """Return the decimals of a corner of a leaf, or of its middle, or of what lies between."""
    return [
        f"{a + (b - a) * rng.choice((0, 0.5, 0.5, 1)):.12f}" for a, b in zip(low, high, strict=True)
    ]


@pytest.mark.parametrize("unit", ["deg", "rad"])
@pytest.mark.parametrize("swapped", [False, True])
def test_corners_touch_over_two_seams(unit, swapped):
    """Two quarters of both joints, open in opposite corners of the square that is a torus."""
    low, high = "bb.0.0.", "b0.b0.."
    first, last = (high, low) if swapped else (low, high)
    ends = (
        [["-140", "-140"], ["140", "140"]] if unit == "deg" else [["-2.6", "-2.6"], ["2.6", "2.6"]]
    )
    if swapped:
        ends = [[ends[0][0], ends[1][1]], [ends[1][0], ends[0][1]]]
    limit = "[-180, 180]" if unit == "deg" else "[-3.1416, 3.1416]"
    found = []
    for limits in (("", ""), ("", limit), (limit, "")):
        robot = planar.planar(*limits, unit=unit, posts=planar.wall("everywhere", 1, 0, 999))
        data = data_of("two joints round")
        data["statement"]["points"] = [ends]
        data |= {"robot": robot, "sha256": hashlib.sha256(robot.encode()).hexdigest()}
        data["proof"] = {"boundaries": ["everywhere"], "tree": f"aa{first}0.a0.{last}"}
        found.append(answers(data))
    assert found == [(False, False), (True, True), (True, True)]


def test_a_slide_is_held_where_the_statement_says():
    """Drawn in further, the boom passes between the posts."""
    data = data_of("slide held")
    for end in (0, 1):
        data["statement"]["points"][0][end][1] = "-0.65"
    assert answers(data) == (False, False)


def test_a_number_of_a_leaf_that_is_not_violated_is_refused_by_its_name():
    data = data_of("wrist held")
    data["proof"] = {"boundaries": ["front"], "tree": "b0.."}
    with pytest.raises(check.Refused, match="'front' may be kept on a leaf"):
        check.check(json.dumps(data))
    with pytest.raises(ValueError, match="'front': not violated all over a leaf"):
        check_arb.verify(json.dumps(data))


def test_the_schema_knows_what_belongs_to_it():
    data = data_of("wrist held")
    for change in (
        put("schema", "qbound/certificate/4"),
        put(*FREE, [0, 1, 2, 3]),
        lambda data: data["statement"].pop("free"),
        put("proof", {"front": ["."]}),
        put(*TREE, "a0"),
    ):
        wrong = copy.deepcopy(data)
        change(wrong)
        with pytest.raises(ValidationError):
            validate(wrong, schema())


# --- mutants --------------------------------------------------------------------------------------


def in_disconnected(rng, data):
    """Change the tree, its numbers, what they name, what moves, or where it begins."""
    proof, statement = data.get("proof"), data.get("statement")
    if not isinstance(proof, dict) or not isinstance(statement, dict):
        return
    kind = rng.randrange(5)
    tree, names = proof.get("tree"), proof.get("boundaries")
    if kind == 0 and isinstance(tree, str) and tree:
        proof["tree"] = mutations.cut(rng, tree)
    elif kind == 1 and isinstance(tree, str) and (spots := [*re.finditer("[0-9]*[.]", tree)]):
        spot = rng.choice(spots)
        number = rng.choice(("", "", "0", "1", "2", "3"))
        proof["tree"] = f"{tree[: spot.start()]}{number}.{tree[spot.end() :]}"
    elif kind == 2 and isinstance(names, list) and names:
        other = ("front", "left", "right", "north", "south", "west", "passing", "nothing")
        names[rng.randrange(len(names))] = rng.choice(other)
    elif kind == 3:
        statement["free"] = rng.choice(([0], [1], [2], [0, 1], [0, 2], [1, 2], [0, 1, 2]))
    else:
        points = statement.get("points")
        if isinstance(points, list) and points and isinstance(points[0], list):
            point = rng.choice(points[0]) if points[0] else None
            if isinstance(point, list) and point:
                high = 180 if "deg" in str(data.get("robot")) else 3
                point[rng.randrange(len(point))] = f"{rng.uniform(-high, high):.3f}"


def mutant(seed):
    rng = random.Random(seed)
    data = data_of(rng.choice([*ASKED]))
    for _ in range(rng.choice((1, 1, 2))):
        rng.choice(
            (*mutations.CHANGES, in_disconnected, in_disconnected, in_disconnected, in_disconnected)
        )(rng, data)
    return data


def judged(seed):
    """Return whether both checkers accept a mutant; fail where they differ or it is not true."""
    data = mutant(seed)
    first, second = answers(data)
    assert first == second, json.dumps(data)
    assert not first or is_true(data), json.dumps(data)
    return first


@pytest.mark.parametrize("part", range(4))
def test_both_checkers_answer_alike_about_mutants_and_tell_the_truth(part):
    found = [judged(seed) for seed in range(40 * part, 40 * part + 40)]
    assert 0 < sum(found) < 40


# --- the judge ------------------------------------------------------------------------------------


def is_true(data):
    """Judge by samples of each leaf, and by what its boxes leave of a lattice.

    The lattice has all ends of leaves and a place between any two: so its connected parts are those
    of what no leaf with a number holds.
    """
    robot, statement, proof = tomllib.loads(data["robot"]), data["statement"], data["proof"]
    start, goal = (np.array(q, dtype=float) for q in statement["points"][0])
    free, rng = statement["free"], np.random.default_rng(0)
    turn = 360.0 if robot["angle_unit"] == "deg" else math.tau
    limits = [joint.get("limits") for joint in robot["joint"]]
    whole = (-180.0, 180.0) if turn == 360 else (-3.1416, 3.1416)
    names = proof["boundaries"]
    robot["boundary"] = [row for row in robot["boundary"] if row["name"] in names]
    boxes = []
    for low, high, number in leaves(proof["tree"], free, [limits[j] or whole for j in free]):
        if number != "":
            q = np.tile(start, (80, 1))
            q[:, free] = low + rng.choice((0, 1, rng.uniform()), (80, len(free))) * (high - low)
            kept = brute_force.margins(robot, statement, q)[names[int(number)]]
            if kept.max() > 1e-9:
                return False
            boxes.append((low, high))
    places = start[free], goal[free]
    return not told_by_lattice(boxes, *places, [limits[j] for j in free], whole, turn)[1]


def leaves(tree, free, ends):
    """Return low end, high end and number of each leaf."""
    todo, found = [np.array(ends, dtype=float).T], []
    for token in re.findall("[a-z]|[0-9]*[.]", tree):
        low, high = todo.pop()
        if token.endswith("."):
            found.append((low, high, token[:-1]))
            continue
        j = free.index(ord(token) - ord("a"))
        below, above = high.copy(), low.copy()
        below[j] = above[j] = (low[j] + high[j]) / 2
        todo += [np.array([above, high]), np.array([low, below])]
    assert not todo
    return found


def told_by_lattice(boxes, start, goal, limits, whole, turn, *, closed=False):
    """Tell whether both ends lie in what closed boxes leave, or fill, and whether it joins them.

    A joint without limits is a circle.
    """
    axes, wraps = [], []
    for j, ends in enumerate(limits):
        marks = {x for low, high in boxes for x in (low[j], high[j])} | {*(ends or whole)}
        if ends is None:
            marks = {(x - whole[0]) % turn + whole[0] for x in marks | {whole[0] + turn}}
        else:
            marks = {x for x in marks if ends[0] <= x <= ends[1]}
        marks = np.array(sorted(marks))
        marks = marks[np.diff(marks, prepend=-np.inf) > 1e-9]
        nexts = np.append(marks[1:], marks[0] + turn) if ends is None else marks[1:]
        between = (marks[: len(nexts)] + nexts) / 2
        axes.append(np.sort(np.concatenate([marks, between])))
        wraps.append(ends is None)
    filled = np.zeros([len(axis) for axis in axes], dtype=bool)
    for low, high in boxes:
        inside = [
            within(axis, low[j], high[j], turn if wraps[j] else None) for j, axis in enumerate(axes)
        ]
        filled |= reduce(np.logical_and.outer, inside)
    label, _ = ndimage.label(filled if closed else ~filled)
    groups = {k: k for k in range(label.max() + 1)}

    def lead(k):
        while groups[k] != k:
            k = groups[k]
        return k

    for j, wrap in enumerate(wraps):
        first, last = label.take(0, j).ravel(), label.take(-1, j).ravel()
        for a, b in {*zip(first.tolist(), last.tolist(), strict=True)} if wrap else ():
            if a and b:
                groups[lead(a)] = lead(b)
    held = [
        {lead(label[near]) for near in nearest(axes, wraps, q, turn) if label[near]}
        for q in (start, goal)
    ]
    return all(held), bool(held[0] & held[1])


def within(axis, low, high, turn):
    away = 0.0 if turn is None else np.array([[-turn], [0.0], [turn]])
    found = (axis + away >= low - 1e-9) & (axis + away <= high + 1e-9)
    return found if turn is None else found.any(axis=0)


def nearest(axes, wraps, q, turn):
    """Return the place of the lattice that stands for a configuration: on the same mark or gap."""
    place = []
    for axis, wrap, value in zip(axes, wraps, q, strict=True):
        x = (value - axis[0]) % turn + axis[0] if wrap else value
        gaps = np.abs(axis - x)
        k = int(gaps.argmin())
        if gaps[k] > 1e-9:  # marks and middles take turns; marks have even numbers
            k = int(np.searchsorted(axis, x)) - 1
            k += k % 2 == 0
        place.append(min(k, len(axis) - 1))
    return [tuple(place)]
