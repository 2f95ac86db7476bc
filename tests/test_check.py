"""The checkers: what they enclose, what they accept, and that nothing else gets through."""

import ast
import copy
import hashlib
import itertools
import json
import math
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
    "another schema": put(("schema",), "qbound/certificate/3"),
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
    "many walls": many_walls,
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_refused_in_bounded_time_and_memory(tmp_path, name):
    file = tmp_path / "hostile.json"
    file.write_text(HOSTILE[name](), encoding="utf-8")

    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (1_000_000_000, 1_000_000_000))
        resource.setrlimit(resource.RLIMIT_CPU, (120, 120))

    command = [sys.executable, str(FILE), str(file)]
    done = subprocess.run(command, preexec_fn=limits, capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "not proved" in done.stdout
    assert not done.stderr


def test_what_a_file_says_cannot_steer_the_terminal(tmp_path, capsys):
    text = paper_robot()[0].replace('"MinervaBotV2"', '"\\u001b[2J proved"')
    statement = statements.path([["0", "0"], ["1", "1"]])
    assert status(tmp_path, certify(text, statement).text) == 0
    assert "\x1b" not in capsys.readouterr().out


def test_versions_of_the_package_and_of_the_file_do_not_mix():
    assert qbound.__version__ not in certificate(0.96).text
    assert math.isclose(float(content()["statement"]["margin"]), 0)
