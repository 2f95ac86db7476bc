"""The checkers: what they enclose, what they accept, and that nothing else gets through."""

import ast
import copy
import hashlib
import itertools
import json
import math
import re
import resource
import subprocess
import sys
import tomllib
from fractions import Fraction
from functools import cache
from pathlib import Path

import mpmath
import numpy as np
import pytest
from jsonschema import ValidationError, validate

import qbound
from qbound import check, cli
from qbound.boundary.functions import clearance
from qbound.model.robotfile import parse_robot, robot_text
from qbound.proofs import check_arb, grammar, statements
from qbound.proofs.certify import certify
from support import brute_force, certificates, mutations
from support.robot_files import robot_file

FILE = Path(check.__file__)
ONE = 2**check.BITS


@cache
def paper_robot():
    text, _ = robot_text("minervabot-v2")
    return text, parse_robot(tomllib.loads(text))


@cache
def certificate(scale):
    text, robot = paper_robot()
    return certify(text, statements.home_polygon(robot, scale))


def content(scale=0.96):
    return json.loads(certificate(scale).text)


def status(tmp_path, text, *options):
    file = tmp_path / "certificate.json"
    file.write_text(text if isinstance(text, str) else json.dumps(text), encoding="utf-8")
    return check.main([str(file), *options])


# --- a stranger's file ----------------------------------------------------------------------------


def test_the_checker_is_one_file_of_the_standard_library_without_floats():
    text = FILE.read_text(encoding="utf-8")
    tree = ast.walk(ast.parse(text))
    nodes = [node for node in tree if isinstance(node, ast.Import | ast.ImportFrom)]
    names = {alias.name for node in nodes if isinstance(node, ast.Import) for alias in node.names}
    names |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    assert {name.split(".")[0] for name in names} <= set(sys.stdlib_module_names)
    numbers = [n.value for n in ast.walk(ast.parse(text)) if isinstance(n, ast.Constant)]
    assert not [number for number in numbers if isinstance(number, float)]


def test_the_checker_runs_alone_and_knows_the_robot(tmp_path):
    (tmp_path / "check.py").write_bytes(FILE.read_bytes())
    (tmp_path / "cert.json").write_text(certificate(0.96).text)
    text, _ = paper_robot()
    (tmp_path / "robot.toml").write_text(text)
    (tmp_path / "other.toml").write_text(text.replace("22.5", "22.6"))
    digest = hashlib.sha256(text.encode()).hexdigest()

    def run(*options):
        command = [sys.executable, "-I", "check.py", "cert.json", *options]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)

    done = run()
    assert done.returncode == 0
    assert "MinervaBotV2" in done.stdout
    assert digest in done.stdout
    assert "proved" in done.stdout
    assert run("robot.toml").returncode == 0
    assert run("--sha256", digest).returncode == 0
    assert run("other.toml").returncode == 2
    assert run("--sha256", "0" * 64).returncode == 2


NO_PIN = [["--sha256"], ["--sha256", ""], [""], ["minervabot-v2", "--sha256"], ["", "--sha256"]]


@pytest.mark.parametrize("options", NO_PIN)
def test_a_pin_without_a_value_is_an_error(tmp_path, capsys, options):
    """A script whose variable is empty must not get the answer for any robot whatever."""
    assert status(tmp_path, certificate(0.96).text, *options) == 2
    assert "not proved" in capsys.readouterr().out


@pytest.mark.parametrize("options", [[""], ["--sha256", ""], ["--sha256="], ["", "--sha256", ""]])
def test_the_command_too_takes_no_empty_pin(tmp_path, capsys, options):
    file = tmp_path / "certificate.json"
    file.write_text(certificate(0.96).text, encoding="utf-8")
    assert cli.main(["check", str(file)]) == 0
    capsys.readouterr()
    assert cli.main(["check", str(file), *options]) == 2
    assert capsys.readouterr().out == ""


def test_both_checkers_accept_and_the_schema_knows_every_answer():
    schema = json.loads((FILE.parent / "schemas/certificate.schema.json").read_text())
    for scale, verdict in ((0.9, "proved"), (0.96, "proved"), (0.97, "refuted"), (1, "refuted")):
        text = certificate(scale).text
        validate(json.loads(text), schema)
        assert check_arb.verify(text) == certificate(scale).verdict == verdict
        assert check.check(text)[0] == (verdict == "refuted")
    with pytest.raises(ValidationError):
        validate(content() | {"verdict": "refuted"}, schema)


# --- what is enclosed -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "angle", ["0", "1e-20", "0.7", "-1.5707963267948966", "3.2", "-9.9", "31.9"]
)
def test_a_wave_is_enclosed(angle):
    ball = check.exp_i(check.real(Fraction(angle)))
    with mpmath.workprec(300):
        x = mpmath.mpf(Fraction(angle).numerator) / Fraction(angle).denominator
        error = mpmath.hypot(ball.x - ONE * mpmath.cos(x), ball.y - ONE * mpmath.sin(x))
        assert error <= ball.r
    assert ball.r <= 2**16


def test_pi_is_enclosed():
    with mpmath.workprec(400):
        assert abs(mpmath.mpf(check.PI.numerator) / check.PI.denominator - mpmath.pi) < 1e-80


def functions_of(text, margin="0"):
    ours = check.read_robot(text)
    kinematics = check.Kinematics(ours)
    gaps = {boundary: boundary.gap(Fraction(margin)) for boundary in ours.boundaries}
    forms = {b.name: check.boundary_form(kinematics, b, gap) for b, gap in gaps.items()}
    return {name: check.function_of(ours, form) for name, form in forms.items()}


@pytest.mark.parametrize("seed", range(12))
def test_the_boundary_functions_of_a_robot_are_those_of_the_library(seed):
    text = robot_file(seed, joints=1 + seed % 4)
    robot, functions = parse_robot(tomllib.loads(text)), functions_of(text, "0.25")
    table = tomllib.loads(text, parse_float=str)
    rng = np.random.default_rng(seed)
    q = [Fraction(int(x), 10) for x in rng.integers(-40, 40, len(robot.joints))]
    values = np.array(q, dtype=float) * statements.units(robot)
    for wall in table["boundary"]:
        ball, _ = functions[wall["name"]].value_and_slopes(tuple(q))
        wider = statements.with_extra_clearance(robot, 0.25)
        wanted = float(clearance(wider, wider.boundary(wall["name"]))(values))
        assert ball.x / ONE == pytest.approx(wanted, abs=1e-9)
        assert ball.r < 2**80


@pytest.mark.parametrize("seed", range(12))
def test_where_the_bound_is_positive_so_is_the_boundary_function(seed):
    """At random points of random simplices and boxes; small ones are proved wherever it is."""
    joints = 1 + seed % 4
    text = robot_file(seed, joints)
    robot, functions = parse_robot(tomllib.loads(text)), functions_of(text)
    rng = np.random.default_rng(seed)
    proved = 0
    for size in (0.01, 0.1, 2, 20):
        cells = list(random_cells(rng, joints, size))
        for cell, (wall, function) in itertools.product(cells, functions.items()):
            q = inside(cell, rng) * statements.units(robot)
            least = clearance(robot, robot.boundary(wall))(q).min()
            positive = check.is_positive(function, cell)
            proved += positive
            assert least > 0 or not positive
            assert positive or least < 5 or size > 0.1
    assert proved


def random_cells(rng, joints, size):
    middle = rng.integers(-30, 30, joints)
    corners = [
        tuple(Fraction(int(x * 1000), 1000) for x in middle + size * rng.normal(size=joints))
        for _ in range(joints + 1)
    ]
    yield check.Simplex(tuple(corners))
    yield check.Box(*(tuple(map(end, zip(*corners, strict=True))) for end in (min, max)))


def inside(cell, rng):
    """Return many configurations of a cell in floats, its corners among them."""
    if isinstance(cell, check.Box):
        low, high = np.array(cell.corners, dtype=float)
        corners = list(itertools.product((0, 1), repeat=len(low)))
        return low + np.concatenate([rng.random((200, len(low))), corners]) * (high - low)
    corners = np.array(cell.corners, dtype=float)
    return np.concatenate([rng.dirichlet(np.ones(len(corners)), 200) @ corners, corners])


# --- corrupted certificates -----------------------------------------------------------------------


def put(place, value):
    def change(data):
        *steps, last = place
        for step in steps:
            data = data[step]
        data[last] = value(data[last]) if callable(value) else value

    return change


def drop(*place):
    def change(data):
        *steps, last = place
        for step in steps:
            data = data[step]
        del data[last]

    return change


def rehashed(change):
    """A change of the robot, with the hash made to fit."""

    def both(data):
        data["robot"] = change(data["robot"])
        data["sha256"] = hashlib.sha256(data["robot"].encode()).hexdigest()

    return both


LOOP = ("statement", "points", 0)
CORRUPTED = {
    "a corner moved outwards": put((*LOOP, 1, 1), "-165"),
    "a corner that is a number": put((*LOOP, 1, 1), -159.6),
    "a corner that is NaN": put((*LOOP, 1, 1), "NaN"),
    "a corner that is infinite": put((*LOOP, 1, 1), "1e999"),
    "a corner with a huge exponent": put((*LOOP, 1, 1), "1e-99999999"),
    "a corner of one value": put((*LOOP, 1), ["1"]),
    "a corner left out": drop(*LOOP, 2),
    "a loop walked backwards": put(LOOP, lambda loop: loop[::-1]),
    "a loop with a spike": put(LOOP, lambda loop: [*loop, ["0", "-170"], loop[-1]]),
    "a loop of two points": put(LOOP[:2], lambda loops: [*loops, [["0", "0"], ["0", "-170"]]]),
    "no corners": put(LOOP, []),
    "a triangle left out": drop("statement", "triangles", 0),
    "a triangle twice": put(("statement", "triangles"), lambda t: [*t, t[0]]),
    "triangles that overlap": put(("statement", "triangles", 1), [5, 0, 2]),
    "a triangle turned over": put(("statement", "triangles", 0), lambda t: t[::-1]),
    "a triangle of a corner that is not there": put(("statement", "triangles", 0, 0), 99),
    "another kind of set": put(("statement", "set"), "disc"),
    "a larger margin": put(("statement", "margin"), "2.5"),
    "a negative margin": put(("statement", "margin"), "-1"),
    "a leaf left out": put(("proof", "B7", 1), lambda tree: tree[:-1]),
    "a leaf too many": put(("proof", "B7", 1), lambda tree: tree + "."),
    "a tree cut short": put(("proof", "B1", 1), "."),
    "another edge": put(("proof", "B7", 1), lambda tree: "bca"["abc".index(tree[0])] + tree[1:]),
    "an edge that a triangle has not": put(("proof", "B7", 1), lambda tree: "d" + tree[1:]),
    "two trees exchanged": put(("proof", "B7"), lambda trees: trees[::-1]),
    "a tree left out": drop("proof", "B7", 0),
    "a boundary left out": drop("proof", "B7"),
    "no proof": drop("proof"),
    "another hash": put(("sha256",), "0" * 64),
    "another robot": put(("robot",), lambda text: text.replace("22.5", "22.4")),
    "a wall moved": rehashed(lambda text: text.replace("offset = 11.32", "offset = 13.32")),
    "a longer arm": rehashed(lambda text: text.replace("[25.0, 0.0", "[27.0, 0.0")),
    "more clearance": rehashed(lambda text: text.replace("clearance = 0.1", "clearance = 3.1")),
    "a robot of NaN": rehashed(lambda text: text.replace("11.32", "nan")),
    "a limit within": rehashed(
        lambda text: text.replace('name = "q1"', 'name = "q1"\nlimits = [-90, 90]')
    ),
    "two boundaries of a name": rehashed(lambda text: text.replace('"B2"', '"B1"')),
    "another schema": put(("schema",), "qbound/certificate/4"),
    "the schema of bodies": put(("schema",), "qbound/certificate/3"),
    "the other verdict": put(("verdict",), "refuted"),
    "no verdict": put(("verdict",), "maybe"),
}


def test_there_are_twenty_corruptions_and_more():
    assert len(CORRUPTED) >= 20


@pytest.mark.parametrize("name", CORRUPTED)
def test_a_corrupted_certificate_proves_nothing(tmp_path, name):
    data = copy.deepcopy(content())
    CORRUPTED[name](data)
    assert data != content()
    assert status(tmp_path, data) == 2
    with pytest.raises((ValueError, LookupError, TypeError, ArithmeticError)):
        check_arb.verify(json.dumps(data))


REFUTED = {
    "a place that is safe": put(("weights",), ["0.4", "0.3", "0.3"]),
    "weights that sum to 2": put(("weights",), lambda w: [w[0], w[1], str(Fraction(w[2]) + 1)]),
    "a negative weight": put(("weights",), ["2", "-1", "0"]),
    "another boundary": put(("boundary",), "B1"),
    "a boundary that is not used": put(("boundary",), "B5"),
    "a cell that is not there": put(("cell",), 9),
    "a weight for no corner": put(("weights",), lambda w: [*w, "0"]),
    "a corner without a weight": put(("weights",), lambda w: w[1:]),
    "no weights": put(("weights",), []),
}


@pytest.mark.parametrize("name", REFUTED)
def test_a_corrupted_witness_refutes_nothing(tmp_path, name):
    data = copy.deepcopy(content(0.97))
    REFUTED[name](data)
    assert status(tmp_path, data) == 2
    with pytest.raises((ValueError, LookupError)):
        check_arb.verify(json.dumps(data))


def test_a_witness_stays_in_the_set_that_it_is_of(tmp_path):
    """A weight for no corner draws the witness towards the origin, here beyond a limit."""
    limited = paper_robot()[0].replace('name = "q1"', 'name = "q1"\nlimits = [10, 90]')
    proved = json.loads(certify(limited, statements.path([["20", "0"], ["30", "0"]])).text)
    assert status(tmp_path, proved) == 0
    del proved["proof"]
    witness = {"verdict": "refuted", "cell": 0, "boundary": "q1.lower"}
    assert status(tmp_path, proved | witness | {"weights": ["0", "1"]}) == 2
    false = proved | witness | {"weights": ["0", "0", "1"]}
    assert status(tmp_path, false) == 2
    with pytest.raises(ValueError, match="weights"):
        check_arb.verify(json.dumps(false))


SETS = {
    "a lone point of a path": (
        statements.path([["0", "0"], ["1", "1"]]),
        lambda loops: [*loops, [["0", "-170"]]],
    ),
    "a box of two boxes": (
        statements.box(["0", "0"], ["1", "1"]),
        lambda loops: [*loops, [["0", "-170"], ["1", "-169"]]],
    ),
    "a box of three corners": (
        statements.box(["0", "0"], ["1", "1"]),
        lambda loops: [[*loops[0], ["0", "-170"]]],
    ),
    "a corner of a box with a value too many": (
        statements.box(["0", "0"], ["1", "1"]),
        lambda loops: [[loops[0][0], [*loops[0][1], "-170"]]],
    ),
}


@pytest.mark.parametrize("name", SETS)
def test_what_no_cell_covers_is_no_part_of_a_proved_set(tmp_path, name):
    statement, change = SETS[name]
    data = json.loads(certify(paper_robot()[0], statement).text)
    assert status(tmp_path, data) == 0
    data["statement"]["points"] = change(data["statement"]["points"])
    assert status(tmp_path, data) == 2
    with pytest.raises(ValueError, match=r"point|unpack|zip|joint"):
        check_arb.verify(json.dumps(data))


@pytest.mark.parametrize("decimal", ["1.5 ", " 1.5", "1.5\n", "１", "", "nan", True, 1.5])
def test_both_checkers_read_a_decimal_or_refuse_it(decimal):
    """A blank after the digits once made 0.15 of 1.5 in Arb."""
    for read in (check.number, grammar.decimal):
        with pytest.raises(ValueError, match="decimal"):
            read(decimal, "here")


# --- the grammar ----------------------------------------------------------------------------------


def square(**changes):
    """A true certificate of a square, in the paper's own grammar, with changes of its statement."""
    points = [[["0", "0"], ["8", "0"], ["8", "8"], ["0", "8"]]]
    triangles = [[0, 1, 2], [0, 2, 3]]
    statement = {"set": "polygon", "margin": "0", "points": points, "triangles": triangles}
    data = json.loads(certificates.certificate(paper_robot()[0], statement, 1))
    data["statement"] |= changes
    return data


def box_file(number=2, robot=None, low=("0", "0"), high=("8", "8")):
    statement = {"set": "box", "margin": "0", "points": [[list(low), list(high)]]}
    return json.loads(certificates.certificate(robot or paper_robot()[0], statement, number))


def box_witness(boundary="B7", at=("4", "4")):
    statement = {"set": "box", "margin": "100", "points": [[["0", "0"], ["8", "8"]]]}
    robot, _ = paper_robot()
    evidence = {"verdict": "refuted", "boundary": boundary, "at": list(at)}
    return json.loads(certificates.text(robot, statement, 2, **evidence))


def agreed(tmp_path, data):
    """Return the exit status, which is 2 exactly where the other checker refuses, and never 1."""
    found = status(tmp_path, data)
    if found == 2:
        with pytest.raises(ValueError, match=r"\w"):
            check_arb.verify(data if isinstance(data, str) else json.dumps(data))
    else:
        assert check_arb.verify(json.dumps(data)) == {0: "proved", 3: "refuted"}[found]
    return found


SQUARE = [["0", "0"], ["8", "0"], ["8", "8"], ["0", "8"]]
GRAMMAR = {
    "a spike": lambda: square(points=[[*SQUARE, ["0", "-170"], ["0", "8"]]]),
    "a loop that cancels itself": lambda: square(points=[SQUARE, [["0", "-170"], ["8", "-170"]]]),
    "two loops that cancel": lambda: square(
        points=[SQUARE, *([p, q, r] for p, q, r in itertools.permutations(
            [["0", "-170"], ["8", "-170"], ["8", "-160"]]))]),
    "a slit": lambda: square(points=[[*SQUARE[:2], ["4", "4"], ["8", "0"], *SQUARE[2:]]]),
    "an index from the end": lambda: square(triangles=[[0, 1, 2], [0, 2, -1]]),
    "an index that is a truth value": lambda: square(triangles=[[0, True, 2], [0, 2, 3]]),
    "an index that is a decimal": lambda: square(triangles=[[0, "1", 2], [0, 2, 3]]),
    "a triangle of four": lambda: square(triangles=[[0, 1, 2, 3], [0, 2, 3]]),
    "no triangles": lambda: square(triangles=[]),
    "an unknown key of the statement": lambda: square(note="and everything else"),
    "triangles of a box": lambda: square(set="box", points=[[["0", "0"], ["8", "8"]]]),
    "a number with a blank": lambda: square(margin="0 "),
    "a number with an underscore": lambda: square(margin="0_0"),
    "a number with a plus": lambda: square(margin="+0"),
    "a number without a point's digits": lambda: square(margin="0."),
    "a number without quotes": lambda: square(margin=0),
    "an angle of six turns": lambda: box_file() | {
        "statement": box_file()["statement"] | {"points": [[["2160", "0"], ["2168", "8"]]]}},
    "points as texts": lambda: square(points=["00", "80", "88"]),
    "a point as a text": lambda: square(points=[["00", "80", "88", "08"]]),
    "an unknown key": lambda: square() | {"note": "and everything else"},
    "a witness beside a proof": lambda: square() | {"cell": 0},
    "a proof of another boundary too": lambda: square() | {
        "proof": square()["proof"] | {"B5": [".", "."]}},
    "trees as one text": lambda: square() | {"proof": dict.fromkeys(square()["proof"], "..")},
    "an empty tree": lambda: square() | {"proof": square()["proof"] | {"B1": ["", "."]}},
    "a box of grammar 1 called 2": lambda: box_file(1) | {"schema": "qbound/certificate/2"},
    "a box of grammar 2 called 1": lambda: box_file(2) | {"schema": "qbound/certificate/1"},
    "a box with its high corner first": lambda: box_file() | {
        "statement": box_file()["statement"] | {"points": [[["8", "8"], ["0", "0"]]]}},
    "a box cut in no joint of it": lambda: box_file() | {
        "proof": box_file()["proof"] | {"B1": ["c.."]}},
    "a box cut in a held joint": lambda: box_file(high=("8", "0")) | {
        "proof": box_file()["proof"] | {"B1": ["b.."]}},
    "a witness beside the box": lambda: box_witness(at=("9", "4")),
    "a witness of two sorts": lambda: box_witness() | {"cell": 0, "weights": ["1", "0"]},
    "a witness of too many values": lambda: box_witness(at=("4", "4", "4")),
    "a witness of a limit that is kept": lambda: box_witness("q1.lower"),
    "a hash in capitals": lambda: square() | {"sha256": square()["sha256"].upper()},
}  # fmt: skip


@pytest.mark.parametrize("name", GRAMMAR)
def test_what_the_grammar_does_not_list_is_refused_by_both_checkers(tmp_path, name):
    assert agreed(tmp_path, GRAMMAR[name]()) == 2


def test_the_files_that_are_changed_here_are_true(tmp_path):
    assert agreed(tmp_path, square()) == 0
    assert agreed(tmp_path, box_file(1)) == agreed(tmp_path, box_file(2)) == 0
    assert agreed(tmp_path, box_file(high=("8", "0"))) == 0
    assert agreed(tmp_path, box_witness()) == 3


ROBOT_TEXTS = {
    "an unknown key": ("tool =", "note = 1\ntool ="),
    "an unknown table": ("[[joint]]", "[extra]\n[[joint]]"),
    "a point of strings": ("at = [11.5, 0.0, 4.91]", 'at = ["11.5", "0.0", "4.91"]'),
    "a point as a string": ("at = [11.5, 0.0, 4.91]", 'at = "123"'),
    "a number as a string": ("clearance = 0.1", 'clearance = "0.1"'),
    "a negative clearance": ("clearance = 0.1", "clearance = -0.1"),
    "a negative radius": ("at = [11.5, 0.0, 4.91]", "at = [11.5, 0.0, 4.91]\nradius = -40.0"),
    "an infinite offset": ("offset = 11.32", "offset = -inf"),
    "a dotted key": ("tool =", "home.q3 = 0.0\ntool ="),
    "a string on more lines": ('name = "MinervaBotV2"', 'name = """MinervaBotV2"""'),
    "a string that is written with too much": ('"MinervaBotV2"', '"' + r"\n" * 151 + '"'),
    "a date": ("22.5", "1979-05-27"),
    "a used that is no truth value": ("\nused = false", "\nused = 0"),
    "an unused boundary that is wrong": ("\nused = false", "\nused = false\nclearance = -1"),
    "a unit of length that is none": ('length_unit = "cm"', 'length_unit = "in"'),
    "a home without a joint": ("q2 = 0.0", "q3 = 0.0"),
    "a schema that is true": ("schema = 1", "schema = true"),
    "limits that fall": ('name = "q1"\n', 'name = "q1"\nlimits = [90, -90]\n'),
    "a velocity of nothing": ('name = "q1"\n', 'name = "q1"\nvelocity = 0\n'),
    "a name of nothing": ('name = "MinervaBotV2"', 'name = ""'),
    "a body of a frame that is not there": (
        "[[boundary]]", '[[body]]\nframe = "9"\npolygon = [[0, 0], [1, 0], [0, 1]]\n[[boundary]]'),
}  # fmt: skip


@pytest.mark.parametrize("name", ROBOT_TEXTS)
def test_a_robot_that_its_own_grammar_refuses_is_refused_by_both_checkers(tmp_path, name):
    old, new = ROBOT_TEXTS[name]
    text, _ = paper_robot()
    assert old in text
    data = square() | {"robot": text.replace(old, new, 1)}
    data["sha256"] = hashlib.sha256(data["robot"].encode()).hexdigest()
    assert agreed(tmp_path, data) == 2


def test_the_bounds_of_the_page_are_those_of_the_checker():
    page = (Path(__file__).parents[1] / "book/certificate.md").read_text(encoding="utf-8")
    for bound in (check.MAX_FILE, check.MAX_ROBOT, check.MAX_CONFIGURATIONS, check.MAX_WORK):
        assert f"{bound:,}" in page
    assert f"At most {check.MAX_DEPTH} cuts" in page
    assert "1,800 degrees or 30 radians" in page
    assert check.LARGEST_ANGLE == {"deg": 1800, "rad": 30}


# --- the answer -----------------------------------------------------------------------------------


def test_the_answer_is_written_from_what_was_verified():
    sha256 = check.digest(paper_robot()[0])
    data = json.dumps(box_file(low=("-4", "0.50")))
    pinned = check.check(data, sha256).said.splitlines()[0]
    assert pinned == f"robot 'MinervaBotV2', sha256 {sha256}, the robot that was asked for"
    refuted, said = check.check(data)
    assert not refuted
    first, second, *shown = said.splitlines()
    assert first == f"robot 'MinervaBotV2', sha256 {sha256}, compared with no robot file"
    assert second.startswith("proved: every configuration of the set keeps 'B1', 'B2', 'B3', 'B4'")
    assert shown == ["set: box in ('q1' in deg, 'q2' in deg)", "corners: (-4, 0.5) (8, 8)"]
    assert (
        "'B7' with a margin of 100 cm is violated at 'q1' = 4 deg, 'q2' = 4 deg"
        in check.check(json.dumps(box_witness())).said
    )


def test_a_violation_in_the_fortieth_digit_is_a_violation():
    """Two points of the base are 5 apart."""
    text = robot_file(1, 1, "revolute")
    post = '[[point]]\nname = "p{}"\nframe = "0"\nat = [{}, {}, 0]\n'
    wall = '[[boundary]]\nname = "wall"\ntype = "pair"\npoints = ["p0", "p1"]\nclearance = {}\n'
    statement = {"set": "box", "margin": "0", "points": [[["0"], ["1"]]]}
    for distance, verdict in (("5." + "0" * 39 + "1", "refuted"), ("5", "")):
        robot = text + post.format(0, 0, 0) + post.format(1, 3, 4) + wall.format(distance)
        evidence = {"verdict": "refuted", "boundary": "wall", "at": ["0"]}
        file = certificates.text(robot, statement, 2, **evidence)
        assert verdict_of(ours, file) == verdict_of(check_arb.verify, file) == verdict


@pytest.mark.parametrize("high", ["180", "179.999"])
def test_what_goes_all_the_way_round_is_said(high):
    low = [["-180", "0"], [high, "0"], [high, "8"], ["-180", "8"]]
    text = harmless(robot_file(1, 2, "revolute"))
    around = {"set": "polygon", "margin": "0", "points": [low], "triangles": [[0, 1, 2], [0, 2, 3]]}
    said = check.check(certificates.certificate(text, around)).said
    assert ("takes every angle of 'q1'" in said) == (high == "180")
    assert "round 'q2'" not in said


def of_free_robot(**statement):
    """Return what is said of a set of a robot that is safe everywhere."""
    text = harmless(robot_file(1, 2, "revolute"))
    return check.check(certificates.certificate(text, {"margin": "0"} | statement)).said


def test_a_long_path_is_named_by_its_ends_and_a_hash_of_all_its_places():
    """By the ranges alone, two paths had one printed answer, which read as start and end."""
    places = [[str(k % 7), str(k)] for k in range(51)]
    other = [*places[:20], ["5.5", "20"], *places[21:]]
    said, others = (of_free_robot(set="path", points=[path]) for path in (places, other))
    assert "'q1' is between 0 and 6 deg in the set" in said
    assert "path from (0, 0) to (1, 50)" in said
    printed = " ".join(f"({x}, {y})" for x, y in places)
    assert f"sha256 of their text {check.digest(printed)}" in said
    assert "51 configurations, in 1 list(s)" in others
    assert said != others


def test_a_hole_is_not_printed_as_an_island():
    outer = [["0", "0"], ["9", "0"], ["9", "9"], ["0", "9"]]
    inner = [["3", "3"], ["3", "6"], ["6", "6"], ["6", "3"]]  # clockwise
    ring = [[0, 1, 7], [0, 7, 4], [1, 2, 6], [1, 6, 7], [2, 3, 5], [2, 5, 6], [3, 0, 4], [3, 4, 5]]
    said = of_free_robot(set="polygon", points=[outer, inner], triangles=ring).splitlines()
    assert "outline: (0, 0) (9, 0) (9, 9) (0, 9)" in said
    assert "hole: (3, 3) (3, 6) (6, 6) (6, 3)" in said


def harmless(robot):
    """Return a robot whose walls are far away."""
    text = re.sub(r"clearance = .*", "clearance = 0.001", robot)
    return re.sub(r"offset = .*", "offset = -60", text)


def test_six_joints_are_checked_in_seconds():
    """One box cell with 64 corners; ten boundaries, each of all six joints."""
    text = harmless(robot_file(1, 6, "revolute"))
    wall = '[[boundary]]\nname = "w{}"\ntype = "half-space"\npoint = "tip"\nnormal = [{}, 1, 1]\n'
    text += "".join(wall.format(i, i) + "offset = -60\n" for i in range(7))
    data = box_file(2, text, ["-5"] * 6, ["5"] * 6)
    assert check.check(json.dumps(data)).refuted is False
    assert check.Ball.work < check.MAX_WORK / 4
    assert check_arb.verify(json.dumps(data)) == "proved"


def test_a_bound_is_least_at_one_of_all_corners():
    """With opposite signs of a mixed term the low and the high corner are not the least."""
    balls = [check.real(x) for x in (0, 1, 2)]
    zero, one, two = balls
    bend = ((zero, zero - one), (zero - one, zero))
    signs = [*itertools.product((1, -1), repeat=2)]
    least = check.least_of_twice(two, [zero, zero], bend, [one, one], signs)
    assert least == 0  # 2 - 2 |M12|, at (1, -1)


# --- mutants --------------------------------------------------------------------------------------


@pytest.mark.parametrize("first", range(0, 2000, 100))
def test_both_checkers_agree_on_mutants_and_what_they_accept_is_true(first):
    for seed in range(first, first + 100):
        text = mutations.mutant(seed)
        found = [verdict_of(checker, text) for checker in (ours, check_arb.verify)]
        assert found[0] == found[1], f"mutant {seed}"
        assert found[0] == "" or brute_force.tells_the_truth(text, seed), f"mutant {seed}"


def ours(text):
    return ("proved", "refuted")[check.check(text).refuted]


def verdict_of(checker, text):
    try:
        return str(checker(text))
    except ValueError:
        return ""


def test_the_originals_are_accepted_and_the_judge_sees_a_lie():
    for text in mutations.originals():
        verdict = json.loads(text)["verdict"]
        assert ours(text) == check_arb.verify(text) == verdict
        assert brute_force.tells_the_truth(text)
    lie = square()
    lie["statement"]["margin"] = "30"
    assert not brute_force.tells_the_truth(json.dumps(lie))
    assert not brute_force.tells_the_truth(json.dumps(box_witness(at=("9", "9"))))


# --- hostile files --------------------------------------------------------------------------------


def deep_tree():
    data = copy.deepcopy(content())
    data["proof"]["B7"] = ["a" * 500_000] * 4
    return json.dumps(data)


def many_walls():
    """Six joints and thousands of boundaries that turn with all of them."""
    text = robot_file(1, 6, "revolute")
    wall = '[[boundary]]\nname = "w{}"\ntype = "pair"\npoints = ["tip", "base"]\nclearance = 1\n'
    text += "".join(wall.format(i) for i in range(10_000))
    statement = statements.box(["0"] * 6, ["1"] * 6)
    proof = {name: ["."] * 720 for name in ("gap", "floor", "other")}
    digest = hashlib.sha256(text.encode()).hexdigest()
    return json.dumps({"schema": "qbound/certificate/1", "verdict": "proved", "robot": text,
                       "sha256": digest, "statement": statement, "proof": proof})  # fmt: skip


def box_of_many(joints):
    """Once the n! orders of a box were built before anybody asked how many joints there are."""
    statement = {"set": "box", "margin": "0", "points": [[["0"] * joints, ["1"] * joints]]}
    return certificates.text(paper_robot()[0], statement, 1, verdict="proved", proof={})


def with_robot(text):
    statement = {"set": "box", "margin": "0", "points": [[["0"], ["1"]]]}
    digest = {"sha256": "0" * 64} if "\ud800" in text else {}
    robot = "x" if digest else text
    data = json.loads(certificates.text(robot, statement, 2, verdict="proved", proof={}))
    return json.dumps(data | {"robot": text} | digest)


HOSTILE = {
    "not JSON": lambda: "hello",
    "an empty file": lambda: "",
    "a list": lambda: "[]",
    "no text at all": lambda: "\x00" * 1000,
    "deep lists": lambda: "[" * 1_000_000,
    "deep tables": lambda: '{"a":' * 300_000,
    "deep TOML": lambda: json.dumps(content() | {"robot": "a = " + "[" * 100_000}),
    "a huge file": lambda: " " * 30_000_000,
    "a long integer": lambda: (
        json.dumps(content())
        .replace('"cell"', "0")
        .replace('"triangles": [[', '"triangles": [[' + "9" * 100_000)
    ),
    "a long decimal": lambda: json.dumps(content()).replace("-159.", "-159." + "1" * 100_000),
    "a huge exponent in the robot": lambda: json.dumps(
        content() | {"robot": content()["robot"].replace("22.5", "1e999999999")}
    ),
    "NaN": lambda: json.dumps(content()).replace('"margin": "0"', '"margin": NaN'),
    "a key twice": lambda: json.dumps(content())[:-1] + ', "verdict": "proved"}',
    "deep trees": deep_tree,
    "a box of many joints": lambda: box_of_many(11),
    "a box of very many joints": lambda: box_of_many(100_000),
    "a long dotted key": lambda: with_robot("a." * 200_000 + "a = 1"),
    "dotted keys in an inline table": lambda: with_robot("a = {" + "a." * 200_000 + "a = 1}"),
    "a long dotted table": lambda: with_robot("[" + "a." * 200_000 + "a]"),
    "quoted dotted keys": lambda: with_robot("'a'." * 100_000 + "a = 1"),
    "a long key": lambda: with_robot("a" * 400_000 + " = 1"),
    "a long number": lambda: with_robot("a = " + "1" * 400_000),
    "half a character": lambda: with_robot("\ud800"),
    "many walls": many_walls,
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_in_bounded_time_and_memory(tmp_path, name):
    file = tmp_path / "hostile.json"
    file.write_text(HOSTILE[name](), encoding="utf-8")

    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (500_000_000, 500_000_000))
        resource.setrlimit(resource.RLIMIT_CPU, (30, 30))

    command = [sys.executable, str(FILE), str(file)]
    done = subprocess.run(command, preexec_fn=limits, capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "not proved: " in done.stdout
    assert not re.search("Error|Exception|Traceback|fault of the checker", done.stdout)
    assert done.stdout.isascii()
    assert not done.stderr


def run_checker(tmp_path, data, **options):
    file = tmp_path / "certificate.json"
    file.write_text(json.dumps(data), encoding="utf-8")
    command = [sys.executable, "-I", str(FILE), str(file)]
    return subprocess.run(command, check=False, **options)


BESIDE = ["__future__", "fractions", "hashlib", "json", "math", "re", "tomllib", "typing"]


def test_modules_beside_the_checker_do_not_answer_for_it(tmp_path):
    """Python looks for modules in the folder of a script first, unless it runs with -I."""
    for name in BESIDE:
        (tmp_path / f"{name}.py").write_text("import os\nos._exit(0)\n")
    copy = tmp_path / "check.py"
    copy.write_bytes(FILE.read_bytes())
    (tmp_path / "cert.json").write_text(json.dumps(square() | {"verdict": "refuted"}))
    done = subprocess.run(
        [sys.executable, copy, tmp_path / "cert.json"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert done.stdout.startswith("not proved: ")


def test_an_older_python_has_no_answer_and_not_the_status_of_one():
    """It ended with 1, by an exception, when that meant refuted."""
    ast.parse(FILE.read_text(encoding="utf-8"), feature_version=(3, 8))
    older = "import runpy, sys; sys.version_info = (3, 10, 12); runpy.run_path(sys.argv[1])"
    done = subprocess.run(
        [sys.executable, "-I", "-c", older, FILE], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (2, "")
    assert done.stdout == "not proved: check.py needs Python 3.11 or newer\n"
    assert 1 not in (check.PROVED, check.REFUTED, check.NO_ANSWER)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_an_answer_that_cannot_be_printed_is_no_proof(tmp_path):
    with Path("/dev/full").open("w") as full:
        done = run_checker(tmp_path, square(), stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 2
    assert not done.stderr
    command = f"{sys.executable} -I {FILE} {tmp_path / 'certificate.json'} >&-"
    done = subprocess.run(command, shell=True, stderr=subprocess.PIPE, check=False)
    assert done.returncode == 2
    assert not done.stderr


def test_names_in_any_script_reach_any_terminal(tmp_path):
    robot = paper_robot()[0].replace('"MinervaBotV2"', '"Größe \u202e \U0001f916"')
    data = square() | {"robot": robot, "sha256": hashlib.sha256(robot.encode()).hexdigest()}
    env = {"PYTHONIOENCODING": "ascii", "LC_ALL": "C"}
    done = run_checker(tmp_path, data, capture_output=True, env=env)
    assert done.returncode == 0
    assert rb"'Gr\xf6\xdfe \u202e \U0001f916'" in done.stdout
    data["statement"]["set"] = "größe"
    done = run_checker(tmp_path, data, capture_output=True, env=env)
    assert (done.returncode, done.stderr) == (2, b"")


FAULTS = {
    KeyboardInterrupt: 130, RecursionError: 2, MemoryError: 2, ZeroDivisionError: 2, KeyError: 2,
    AssertionError: 2, OverflowError: 2,
}  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS)
def test_whatever_happens_no_crash_is_an_answer(tmp_path, monkeypatch, capsys, fault):
    def crash(*_):
        raise fault("inside")

    data = square()
    monkeypatch.setattr(check, "read_robot", crash)
    assert status(tmp_path, data) == FAULTS[fault]
    said = capsys.readouterr().out
    assert said.startswith("not proved: ")
    assert fault.__name__ not in said


BAD_FILES = {"not there": "nothing.json", "a folder": ".", "of no name": "a\0b"}


@pytest.mark.parametrize("name", BAD_FILES)
def test_a_file_that_cannot_be_read_is_named(tmp_path, monkeypatch, capsys, name):
    monkeypatch.chdir(tmp_path)
    assert check.main([BAD_FILES[name]]) == 2
    assert "cannot be read" in capsys.readouterr().out
    assert status(tmp_path, square(), BAD_FILES[name]) == 2


PINS = [["--sha256", "0" * 63], ["--sha256", "A" * 64], ["--sha256", "0" * 64, "x"], ["a", "b"],
        ["--sha25", "0" * 64], ["--sha256=" + "0" * 64]]  # fmt: skip


@pytest.mark.parametrize("options", PINS)
def test_a_pin_is_a_hash_or_a_file_and_nothing_else(tmp_path, options):
    assert status(tmp_path, square(), *options) == 2


def test_a_pin_is_read_as_the_library_reads_robot_files(tmp_path):
    text, _ = paper_robot()
    (tmp_path / "dos.toml").write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert robot_text(tmp_path / "dos.toml")[0] == text
    assert status(tmp_path, square(), str(tmp_path / "dos.toml")) == 0
    (tmp_path / "huge.toml").write_bytes(b" " * 3_000_000)
    assert status(tmp_path, square(), str(tmp_path / "huge.toml")) == 2


def test_what_a_file_says_cannot_steer_the_terminal(tmp_path, capsys):
    text = paper_robot()[0].replace('"MinervaBotV2"', '"\\u001b[2J proved"')
    statement = statements.path([["0", "0"], ["1", "1"]])
    assert status(tmp_path, certify(text, statement).text) == 0
    assert "\x1b" not in capsys.readouterr().out


def test_versions_of_the_package_and_of_the_file_do_not_mix():
    assert qbound.__version__ not in certificate(0.96).text
    assert math.isclose(float(content()["statement"]["margin"]), 0)
