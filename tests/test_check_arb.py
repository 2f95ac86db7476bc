# ruff: noqa: E501  (tables of faults, one a line)
"""The second checker: what it must refuse, what it encloses, and both grammars.

Certificates are written by hand here, for a robot whose one boundary is far away: any set is proved
by single leaves, so that all that may be wrong is the file.
"""

import copy
import hashlib
import json
import tomllib
from fractions import Fraction
from itertools import permutations, product

import numpy as np
import pytest

from qbound import check
from qbound.boundary.functions import clearance
from qbound.model.robotfile import parse_robot
from qbound.proofs import cells, check_arb, grammar_robot, interpolation, leaves
from support.robot_files import box_of, robot_file

flint = pytest.importorskip("flint")

ROBOT = """schema = 1
name = "arm"
length_unit = "cm"
angle_unit = "deg"
home = { q1 = 0, q2 = 0 }
tool = "tip"

[[joint]]
name = "q1"
type = "revolute"
parent = "0"
frame = "1"
origin = [0, 0, 2]
axis = [0, 1, 0]

[[joint]]
name = "q2"
type = "revolute"
parent = "1"
frame = "2"
origin = [3, 0, 0]
axis = [0, 1, 0]
limits = [-170, 170]

[[point]]
name = "tip"
frame = "2"
at = [2, 0, 0]

[[boundary]]
name = "floor"
type = "half-space"
point = "tip"
normal = [0, 0, 1]
offset = -90
"""

SQUARE = [["0", "0"], ["4", "0"], ["4", "4"], ["0", "4"]]
HALVES = [[0, 1, 2], [0, 2, 3]]


def digest(text):
    return hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest()


def proof_of(statement, cells, grammar=1, robot=ROBOT):
    return {
        "schema": f"qbound/certificate/{grammar}",
        "verdict": "proved",
        "statement": {"margin": "0"} | statement,
        "robot": robot,
        "sha256": digest(robot),
        "proof": {"floor": ["."] * cells},
    }


def polygon(loops, triangles):
    return proof_of({"set": "polygon", "points": loops, "triangles": triangles}, len(triangles))


def path(*lists):
    return proof_of({"set": "path", "points": list(lists)}, sum(len(row) - 1 for row in lists))


def box(low, high, grammar=1):
    cells = 1 if grammar == 2 else len(list(permutations(range(sum(map(np.not_equal, low, high))))))
    return proof_of({"set": "box", "points": [[low, high]]}, cells, grammar)


def with_robot(content, text):
    return content | {"robot": text, "sha256": digest(text)}


def verdict(content):
    return check_arb.verify(content if isinstance(content, str) else json.dumps(content))


# --- what it accepts ------------------------------------------------------------------------------

ACCEPTED = {
    "a path": path(SQUARE),
    "two paths": path(SQUARE, [["0", "0"], ["0", "0"]]),
    "a box": box(["-1", "0"], ["1", "2"]),
    "a box of grammar 2": box(["-1", "0"], ["1", "2"], 2),
    "a box of one joint": box(["-1", "2"], ["1", "2"]),
    "a box of one joint, grammar 2": box(["-1", "2"], ["1", "2"], 2),
    "a box of one place": box(["1", "2"], ["1", "2"]),
    "a box of one place, grammar 2": box(["1", "2"], ["1", "2"], 2),
    "a square": polygon([SQUARE], HALVES),
    "two squares": polygon(
        [SQUARE, [[str(int(x) + 9), y] for x, y in SQUARE]],
        [*HALVES, *([a + 4, b + 4, c + 4] for a, b, c in HALVES)],
    ),
    "decimals with exponents": box(["-1.5e1", "0E0"], ["1e+1", "2.50"], 2),
    "a joint at its limit": box(["0", "-170"], ["1", "170.0"], 2),
}


@pytest.mark.parametrize("name", ACCEPTED)
def test_what_follows_the_grammar_is_proved(name):
    assert verdict(ACCEPTED[name]) == "proved"


def test_cut_cells_are_proved_in_both_grammars():
    one, two = box(["-1", "0"], ["1", "2"]), box(["-1", "0"], ["1", "2"], 2)
    one["proof"]["floor"] = ["ab..c..", "."]
    two["proof"]["floor"] = ["ab..ba..."]
    assert verdict(one) == verdict(two) == "proved"


# --- what it must refuse --------------------------------------------------------------------------


def put(content, *place, value):
    """Put a value into a certificate."""
    content = copy.deepcopy(content)
    *steps, last = place
    inner = content
    for step in steps:
        inner = inner[step]
    inner[last] = value
    return content


CORNER = ("statement", "points", 0, 1, 0)
TALL = [*SQUARE[:2], ["4", "9"], *SQUARE[2:]]
CUBE = ROBOT.replace("q2 = 0 }", "q2 = 0, q3 = 0 }") + (
    '[[joint]]\nname = "q3"\ntype = "prismatic"\nparent = "2"\nframe = "3"\n'
    "origin = [0, 0, 0]\naxis = [1, 0, 0]\nlimits = [0, 1]\n"
)

REFUSED = {
    # numbers
    **{
        f"the decimal {text!r}": put(path(SQUARE), *CORNER, value=text)
        for text in (
            "4 ",
            " 4",
            "4\n",
            "+4",
            ".4",
            "4.",
            "4_0",
            "4e400",
            "4e",
            "nan",
            "inf",
            "",
            "0x4",
            "\uff14",
            "4/1",
            "1" * 41,
            "4e99",
            "2000",
            4,
            4.0,
            True,
            None,
            ["4"],
        )
    },
    "a negative margin": put(path(SQUARE), "statement", "margin", value="-1"),
    "a huge margin": put(path(SQUARE), "statement", "margin", value="1e99"),
    # sets
    "a second box": put(
        box(["0", "0"], ["1", "1"]),
        "statement",
        "points",
        value=[[["0", "0"], ["1", "1"]], [["5", "5"], ["6", "6"]]],
    ),
    "a box of three corners": put(
        box(["0", "0"], ["1", "1"]),
        "statement",
        "points",
        value=[[["0", "0"], ["1", "1"], ["9", "9"]]],
    ),
    "a box upside down": box(["1", "0"], ["0", "1"], 2),
    "a box with a value too many": put(
        box(["0", "0"], ["1", "1"], 2),
        "statement",
        "points",
        value=[[["0", "0", "0"], ["1", "1", "1"]]],
    ),
    "a box with a value too few": put(
        box(["0", "0"], ["1", "1"], 2), "statement", "points", value=[[["0"], ["1"]]]
    ),
    "a path of one point": put(path(SQUARE), "statement", "points", value=[SQUARE, [["0", "0"]]]),
    "no path": path() | {"proof": {"floor": []}},
    "a point that is a text": put(path(SQUARE), "statement", "points", 0, 0, value="00"),
    "a list that is a text": put(path(SQUARE), "statement", "points", 0, value="0000"),
    "an unknown set": put(path(SQUARE), "statement", "set", value="disc"),
    "triangles of a path": put(path(SQUARE), "statement", "triangles", value=HALVES),
    "an unknown key of the statement": put(path(SQUARE), "statement", "note", value="safe"),
    "an unknown key": put(path(SQUARE), "note", value="every configuration of every robot"),
    "a witness beside a proof": put(path(SQUARE), "boundary", value="floor"),
    "an unknown schema": put(path(SQUARE), "schema", value="qbound/certificate/4"),
    "a schema that is a list": put(path(SQUARE), "schema", value=["qbound/certificate/1"]),
    "beyond a limit": box(["0", "-171"], ["1", "170"], 2),
    # polygons
    "a spike": polygon([[*SQUARE, ["0", "9"], ["0", "4"]]], [[0, 1, 2], [0, 2, 3]]),
    "a slit": polygon([[*SQUARE, ["1", "3"], ["0", "4"]]], HALVES),
    "loops that cancel": polygon(
        [SQUARE, [["7", "7"], ["9", "7"], ["9", "9"]], [["7", "7"], ["9", "9"], ["9", "7"]]],
        HALVES,
    ),
    "a loop that goes twice round": polygon([SQUARE + SQUARE], HALVES),
    "a corner in no triangle": polygon([TALL], [[0, 1, 3], [0, 3, 4]]),
    "a triangle left out": polygon([SQUARE], HALVES[:1]),
    "a triangle twice": polygon([SQUARE], [*HALVES, HALVES[0]]),
    "a triangle turned over": polygon([SQUARE], [[0, 2, 1], [0, 2, 3]]),
    "a flat triangle": polygon([SQUARE], [*HALVES, [0, 0, 1]]),
    "a triangle of a corner that is not there": polygon([SQUARE], [[0, 1, 2], [0, 2, 4]]),
    "a triangle of a negative corner": polygon([SQUARE], [[0, 1, 2], [0, 2, -1]]),
    "a triangle of true and false": polygon([SQUARE], [[False, True, 2], [0, 2, 3]]),
    "a clockwise square": polygon([SQUARE[::-1]], HALVES),
    "a square in no plane": polygon([[["0", "0"], ["4", "0"], ["8", "0"]]], [[0, 1, 2]]),
    # proofs
    "a tree that ends early": put(path(SQUARE), "proof", "floor", 0, value="a."),
    "a tree that goes on": put(path(SQUARE), "proof", "floor", 0, value=".."),
    "an empty tree": put(path(SQUARE), "proof", "floor", 0, value=""),
    "an edge that is not there": put(path(SQUARE), "proof", "floor", 0, value="b.."),
    "a held joint cut": put(box(["0", "1"], ["1", "1"], 2), "proof", "floor", 0, value="b.."),
    "a joint that is not there": put(
        box(["0", "0"], ["1", "1"], 2), "proof", "floor", 0, value="c.."
    ),
    "a capital letter": put(path(SQUARE), "proof", "floor", 0, value="A.."),
    "121 cuts on top of each other": put(
        box(["0", "0"], ["1", "1"], 2), "proof", "floor", 0, value="a" * 121 + "." * 122
    ),
    "a tree for a boundary that is not there": put(path(SQUARE), "proof", "roof", value=["."] * 3),
    "a tree too many": put(path(SQUARE), "proof", "floor", value=["."] * 4),
    "a boundary left out": put(path(SQUARE), "proof", value={}),
    "grammar 1 with the cells of grammar 2": box(["0", "0"], ["1", "1"], 2)
    | {"schema": "qbound/certificate/1"},
    # the robot
    **{
        f"a robot with {name}": with_robot(path(SQUARE), ROBOT.replace(old, new, 1))
        for name, old, new in (
            ("an unknown key", "schema = 1", 'schema = 1\nnote = "safe"'),
            ("an unknown key of a joint", "origin", 'colour = "red"\norigin'),
            ("a dotted key", "home = { q1 = 0, q2 = 0 }", "home.q1 = 0\nhome.q2 = 0"),
            ("a string of three quotes", 'name = "arm"', 'name = """arm"""'),
            ("schema true", "schema = 1", "schema = true"),
            ("schema 2", "schema = 1", "schema = 2"),
            ("a number that is a string", "offset = -90", 'offset = "-90"'),
            ("a number that is nan", "offset = -90", "offset = nan"),
            ("a number that is infinite", "offset = -90", "offset = -inf"),
            ("a number that is true", "offset = -90", "offset = true"),
            ("a huge exponent", "offset = -90", "offset = -1e9999"),
            ("a huge number", "offset = -90", "offset = -1e101"),
            ("an origin of two numbers", "[0, 0, 2]", "[0, 2]"),
            ("an axis of zeros", "[0, 1, 0]", "[0, 0.0, 0]"),
            ("no axis", "axis = [0, 1, 0]\n", ""),
            ("a frame that is missing", 'parent = "1"', 'parent = "7"'),
            ("one name for two joints", 'name = "q2"', 'name = "q1"'),
            ("an unknown unit", '"deg"', '"grad"'),
            ("an unknown joint", '"revolute"', '"screw"'),
            ("a tool that is no point", 'tool = "tip"', 'tool = "top"'),
            ("a home without a joint", "q1 = 0, ", ""),
            ("limits turned over", "[-170, 170]", "[170, -170]"),
            ("a boundary named as a limit", 'name = "floor"', 'name = "q2.upper"'),
            ("a used that is a number", "offset", "used = 1\noffset"),
            ("a point that is not there", 'point = "tip"', 'point = "top"'),
            ("a name of 201 letters", '"arm"', '"' + "a" * 201 + '"'),
            ("an empty name", '"arm"', '""'),
            ("a date", "offset = -90", "offset = 1979-05-27"),
            ("no TOML", "schema = 1", "schema = = 1"),
            ("half a character", '"arm"', '"arm\ud800"'),
        )
        if old in ROBOT
    },
    "a joint too many": with_robot(path(SQUARE), CUBE.replace('"2"', '"1"', 3)),
    "another hash": put(path(SQUARE), "sha256", value="0" * 64),
    "a hash in capitals": put(path(SQUARE), "sha256", value="A" * 64),
    # JSON
    "a list": [],
    "a text": '"proved"',
    "not JSON": "{",
    "nothing": "",
    "a byte order mark": "\ufeff" + json.dumps(path(SQUARE)),
    "a key twice": json.dumps(path(SQUARE))[:-1] + ', "verdict": "proved"}',
    "a key twice within": json.dumps(path(SQUARE)).replace('"set"', '"margin": "0", "set"'),
    "deep lists": "[" * 200_000,
    "deep lists in a point": json.dumps(path(SQUARE)).replace('["0", "0"]', "[" * 500 + "]" * 500),
    "half a character in a name": put(path(SQUARE), "proof", value={"floor\ud800": ["."] * 3}),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_leaves_the_grammar_is_refused_in_a_sentence(name):
    """Whatever the fault, it is a `ValueError`, in ASCII, that names no class of Python."""
    with pytest.raises(ValueError, match=r"^[ -~]+$") as refusal:
        verdict(REFUSED[name])
    assert "Error" not in str(refusal.value)


def test_every_change_of_a_robot_was_made():
    assert sum(name.startswith("a robot with") for name in REFUSED) == 30


COSTLY = {
    "a box of nine joints, 859 bytes once took 5.5 GB": lambda: put(
        box(["0", "0"], ["1", "1"]), "statement", "points", value=[[["0"] * 11, ["1"] * 11]]
    ),
    "a key of many dots": lambda: with_robot(path(SQUARE), ROBOT + "a" + ".a" * 100_000 + " = 1\n"),
    "a header of many dots": lambda: with_robot(path(SQUARE), f"{ROBOT}[a{'.a' * 100_000}]\n"),
    "a key of many letters": lambda: with_robot(path(SQUARE), ROBOT + "a" * 400_000 + " = 1\n"),
    "a number of many digits": lambda: with_robot(path(SQUARE), ROBOT.replace("-90", "9" * 400_000)),
    "lists in lists": lambda: with_robot(path(SQUARE), f"{ROBOT}x = {'[' * 99_999}{']' * 99_999}\n"),
    "a robot of 500,001 letters": lambda: with_robot(path(SQUARE), ROBOT + "#" * 500_001),
    "a number of JSON of many digits": lambda: json.dumps(path(SQUARE)).replace(
        '"margin": "0"', f'"margin": {"9" * 1_000_000}'
    ),
    "a file of more than 2 MB": lambda: json.dumps(path(SQUARE)) + " " * 2_000_000,
    "a million leaves": lambda: put(
        box(["0", "0"], ["1", "1"], 2), "proof", "floor", 0, value=full_tree(19)
    ),
    "two thousand boundaries of six joints": lambda: many_boundaries(2000),
}  # fmt: skip


def full_tree(depth):
    tree = "."
    for _ in range(depth):
        tree = "a" + tree + tree
    return tree


def many_boundaries(count):
    text = robot_file(1, 6, "revolute")
    wall = '[[boundary]]\nname = "w{}"\ntype = "pair"\npoints = ["tip", "base"]\nclearance = 0\n'
    text += "".join(wall.format(i) for i in range(count - 3))
    names = [f"w{i}" for i in range(count - 3)] + ["gap", "floor", "other"]
    content = proof_of({"set": "box", "points": [[["0"] * 6, ["0"] * 6]]}, 1, 2, text)
    return content | {"proof": {name: ["."] for name in names}}


@pytest.mark.parametrize("name", COSTLY)
def test_what_would_cost_much_is_refused(name, monkeypatch):
    """Counted, not timed: the work of a check never passes its bound."""
    done = []
    add = leaves.Work.add
    monkeypatch.setattr(leaves.Work, "add", lambda self, n: (done.append(n), add(self, n)))
    with pytest.raises(ValueError, match=r"."):
        verdict(COSTLY[name]())
    assert sum(done[:-1]) <= leaves.MOST_WORK


def hundred_turns(places):
    """Limits of an arm in radians: 200 pi apart, cut off below and above after some places."""
    with flint.ctx.workprec(1000):
        low = int((200 * flint.arb.pi() * flint.arb(10) ** places).floor().unique_fmpz())
    return [f"{str(k)[:3]}.{str(k)[3:]}" for k in (low, low + 1)]


@pytest.mark.parametrize("places", [30, 36, 38, 40, 60, 90])
def test_limits_are_at_most_a_hundred_turns_apart_to_the_last_place(places):
    below, above = hundred_turns(places)
    robot = ROBOT.replace('"deg"', '"rad"').replace("limits = [-170, 170]", "limits = [0, {}]")
    statement = {"set": "path", "points": [[["0", "0"], ["0", "0.1"]]]}
    assert verdict(proof_of(statement, 1, 2, robot.replace("{}", below))) == "proved"
    with pytest.raises(ValueError, match="turns apart"):
        verdict(proof_of(statement, 1, 2, robot.replace("{}", above)))


def test_limits_of_two_long_words_are_told_apart_too():
    below, _ = hundred_turns(185)
    high, low = below[:99], int(below[99:])
    robot = ROBOT.replace('"deg"', '"rad"')
    grammar_robot.read_robot(robot.replace("[-170, 170]", f"[-{low}e-185, {high}]"))
    with pytest.raises(ValueError, match="turns apart"):
        grammar_robot.read_robot(robot.replace("[-170, 170]", f"[-{low + 1}e-185, {high}]"))


# --- witnesses ------------------------------------------------------------------------------------

LOW_ROOF = ROBOT.replace("offset = -90", "offset = 1.999")
"""At (0, 0) the tip is at height 2; turned by 90 degrees it is 5 lower."""


def refutation(content, **evidence):
    content = with_robot(content, LOW_ROOF) | {"verdict": "refuted"} | evidence
    del content["proof"]
    return content


IN_BOX = box(["0", "0"], ["90", "1"], 2)
WITNESSES = {
    "a mean of corners": (
        refutation(polygon([[["0", "0"], ["9", "0"], ["0", "9"]]], [[0, 1, 2]]),
                   boundary="floor", cell=0, weights=["0", "1", "0.0"]),
        {"weights": ["1", "0", "0"]}, {"weights": ["0", "2", "-1"]}, {"weights": ["0", "0.5", "0.4"]},
        {"weights": ["0", "1"]}, {"cell": 1}, {"boundary": "roof"}, {"cell": "0"}, {"at": ["9", "0"]},
    ),
    "a place in a box": (
        refutation(IN_BOX, boundary="floor", at=["90", "0.5"]),
        {"at": ["0", "0"]}, {"at": ["91", "0"]}, {"at": ["90"]}, {"at": ["90", "-0.1"]},
        {"boundary": "q2.upper"}, {"cell": 0, "weights": ["1"]}, {"at": ["90", "0.5", "0"]},
    ),
    "a corner of a box of grammar 1": (
        refutation(box(["0", "0"], ["90", "1"]), boundary="floor", cell=1, weights=["0", "0", "1"]),
        {"at": ["90", "0.5"]}, {"weights": ["1", "0", "0"]}, {"cell": 2},
    ),
    "a place beyond a limit": (
        refutation(box(["0", "0"], ["1", "171"], 2), boundary="q2.upper", at=["0", "170.5"]),
        {"at": ["0", "170"]}, {"boundary": "q2.lower"}, {"boundary": "q1.upper"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WITNESSES)
def test_a_witness_refutes_and_an_altered_one_does_not(name):
    good, *changes = WITNESSES[name]
    assert verdict(good) == "refuted"
    for change in changes:
        with pytest.raises(ValueError, match=r"."):
            verdict(good | change)


def test_a_violation_in_the_thirtieth_digit_is_one():
    """At 0, 0 the tip is at height 2 exactly."""
    for offset, found in (("2." + "0" * 29 + "1", True), ("2", False)):
        text = ROBOT.replace("offset = -90", f"offset = {offset}")
        content = refutation(IN_BOX, boundary="floor", at=["0", "0"])
        content = with_robot(content, text)
        if found:
            assert verdict(content) == "refuted"
        else:
            with pytest.raises(ValueError, match="violates nothing"):
                verdict(content)


# --- what is enclosed -----------------------------------------------------------------------------


def interpolated(text, boundary, margin, low, high):
    from qbound.proofs import grammar_robot, interpolation

    robot = grammar_robot.read_robot(text)
    found = robot.boundaries[boundary]
    reach = interpolation.reach_of(robot, [low, high])
    return robot, found, interpolation.waves_of(robot, found, margin, reach)


@pytest.mark.parametrize("seed", range(12))
def test_interpolated_boundary_functions_are_those_of_the_library(seed):
    from qbound.proofs import interpolation

    joints = 1 + seed % 6
    text = robot_file(seed, joints)
    robot = parse_robot(tomllib.loads(text))
    low, high = ([Fraction(x) for x in end] for end in box_of(seed, joints))
    units = np.array([np.pi / 180 if joint.turns else 1.0 for joint in robot.joints])
    for k, boundary in enumerate(robot.boundaries):
        form = clearance(robot, boundary)
        with flint.ctx.workprec(160):
            exact, found, waves = interpolated(text, k, Fraction(0), low, high)
            q = [interpolation.exact((a + b) / 2) for a, b in zip(low, high, strict=True)]
            scale = interpolation.units(exact)
            value, slope = waves.expanded([scale[j] * q[j] for j in waves.joints])
            wanted = interpolation.boundary_value(exact, found, Fraction(0), q)
            assert abs(value - wanted) < 1e-30
        at = np.array([float(x) for x in q]) * units
        assert float(value) == pytest.approx(float(form(at)), abs=1e-9)
        gradient = form.gradient(at)
        assert [float(g) for g in slope] == pytest.approx(gradient[list(waves.joints)], abs=1e-9)
        others = [j for j in range(joints) if j not in waves.joints]
        assert gradient[others] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_the_bound_of_a_leaf_is_below_the_boundary_function(seed):
    """A leaf is proved only where the form is positive at random places of the box, and is often."""
    from qbound.proofs import cells, interpolation

    joints = 1 + seed % 4
    text = robot_file(seed, joints)
    robot = parse_robot(tomllib.loads(text))
    rng = np.random.default_rng(seed)
    low, high = box_of(seed, joints)
    places = np.array(low, float) + rng.random((400, joints)) * (
        np.array(high, float) - np.array(low, float)
    )
    units = np.array([np.pi / 180 if joint.turns else 1.0 for joint in robot.joints])
    corners = np.array(list(product(*zip(map(float, low), map(float, high), strict=True))))
    ends = [[Fraction(x) for x in end] for end in (low, high)]
    for k, boundary in enumerate(robot.boundaries):
        form = clearance(robot, boundary)
        values = np.concatenate([form(places * units), form(corners * units)])
        with flint.ctx.workprec(160):
            exact, _, waves = interpolated(text, k, Fraction(0), *ends)
            leaf = leaves.Leaf(exact, waves, leaves.Work())
            box = cells.Box(*(tuple(map(interpolation.exact, end)) for end in ends))
            assert values.min() > -1e-9 or not leaf.is_positive(box)
            waves.rest -= 10 * sum(abs(wave.amplitude) for wave in waves.rows)
            assert leaf.is_positive(box)  # or the line above could not fail


def test_no_answer_but_a_sentence_even_where_a_checker_fails(monkeypatch):
    def broken(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(check_arb, "waves_of", broken)
    with pytest.raises(ValueError, match="failed"):
        verdict(path(SQUARE))


# --- what a producer may rely on ------------------------------------------------------------------

LETTERS = {2: 10_000, 3: 10_000, 4: 500, 5: 500, 6: 500}
"""By the number of joints, letters of trees that both checkers follow: the page says so."""


@pytest.mark.parametrize("kinds", ["revolute", "revolute prismatic", "prismatic"])
@pytest.mark.parametrize("cells", [1, 40])
@pytest.mark.parametrize("joints", LETTERS)
def test_both_checkers_follow_as_many_letters_as_the_page_says(joints, cells, kinds, monkeypatch):
    """Counted, not timed: one letter costs no more than its part of the work; leaves cost most."""
    most = min(LETTERS[joints], grammar_robot.MOST_ROWS) if cells == 1 else LETTERS[joints]
    text = robot_file(joints, joints, kinds).replace("offset = ", "offset = -9999 # ")
    text = text.replace("clearance = ", "clearance = 0 # ").replace("radius", "# radius")
    points = [[f"{k}e-9"] * joints for k in range(cells + 1)]
    statement = {"set": "path", "points": [points], "margin": "1e-9"}
    names = ("gap", "floor", "other")
    content = proof_of(statement, cells, 2, text)
    content = json.dumps(content | {"proof": {name: ["."] * cells for name in names}})
    done = []
    monkeypatch.setattr(leaves.Work, "add", lambda _, n: done.append(n))
    assert check_arb.verify(content) == "proved"
    assert sum(done) / (3 * cells) <= leaves.MOST_WORK / most
    assert not check.check(content).refuted
    assert check.Ball.work / (3 * cells) <= check.MAX_WORK / most


def test_many_half_spaces_above_slides_are_proved_by_both():
    kinds = ["prismatic", "revolute"] * 3
    rows = [
        f'[[joint]]\nname = "q{j}"\ntype = "{kind}"\nparent = "{j}"\nframe = "{j + 1}"\n'
        "origin = [1, 0, 0]\naxis = [0, 1, 0]\nlimits = [-1, 1]\n"
        for j, kind in enumerate(kinds)
    ]
    walls = [
        f'[[boundary]]\nname = "w{i}"\ntype = "half-space"\npoint = "tip"\nnormal = [0, 0, 1]\n'
        "offset = -99\n"
        for i in range(600)
    ]
    home = f"home = {{ {', '.join(f'q{j} = 0' for j in range(6))} }}"
    text = ROBOT[: ROBOT.index("[[joint]]")].replace("home = { q1 = 0, q2 = 0 }", home)
    text += "".join(rows) + '[[point]]\nname = "tip"\nframe = "6"\nat = [1, 0, 0]\n'
    text += "".join(walls)
    content = proof_of({"set": "box", "points": [[["0"] * 6, ["0.1"] * 6]]}, 1, 2, text)
    content = json.dumps(content | {"proof": {f"w{i}": ["."] for i in range(600)}})
    assert check_arb.verify(content) == "proved"
    assert not check.check(content).refuted


@pytest.mark.parametrize("seed", range(4))
def test_the_high_corner_of_a_box_stands_for_all_where_slides_bend(seed):
    """All corners of a box in six joints cost minutes, and the work of them was not counted."""
    robot = grammar_robot.read_robot(robot_file(seed, 5, "revolute prismatic"))
    low, high = ((Fraction(x),) * 5 for x in (1, 3))
    cell = cells.Box(low, high)
    gap = next(boundary for boundary in robot.boundaries if boundary.name == "gap")
    with flint.ctx.workprec(check_arb.BITS):
        waves = interpolation.waves_of(robot, gap, Fraction(0), [flint.arb(3)] * 5)
        rows = [[flint.arb(int(x)) for x in step] for step in cell.steps(waves.joints)]
        one = waves._widest(rows[-1:])
        every = waves._widest(rows)
    assert [float(x) for x in one] == pytest.approx([float(x) for x in every])
    assert len(one) == len(waves.slides)
