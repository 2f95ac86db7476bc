# ruff: noqa: E501  (rows of robot files, one a line)
"""The prover: no false proof, and every refutation confirmed by the checker and the oracle."""

import json
import os
import re
import subprocess
import sys
import threading
import tomllib
from fractions import Fraction
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize

from cspace import check, cli, load_robot, save_robot
from cspace.boundary.functions import clearance
from cspace.cli.values import box
from cspace.explorer.data import figure_data
from cspace.geometry import polygon
from cspace.measures.scaling import least
from cspace.model.robotfile import parse_robot, robot_text
from cspace.proofs.certificates import certify as prover
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.certify import bracket_scale, certify, certify_region
from cspace.proofs.certificates.statements import DECIMAL, read_points
from cspace.region import find_region
from engine_support import second_checker
from engine_support.claims import BODIES
from engine_support.robot_files import box_of, robot_file
from engine_support.robots import OF_POINTS, drawn_robot, kept_by_kinematics, random_robot

ROBOTS = int(os.environ.get("QBOUND_CERTIFY_ROBOTS", "14"))
"""Random robots; engine/benchmarks/README.md has a longer run."""

REGIONS = int(os.environ.get("QBOUND_CERTIFY_REGIONS", "24"))
"""Random robots of two joints whose regions are proved; 260 of both kinds were, once."""


@cache
def paper_robot():
    text, _ = robot_text("minervabot-v2")
    return text, parse_robot(tomllib.loads(text))


def robot_of(text):
    return parse_robot(tomllib.loads(text))


def corners_of(statement):
    """Corners of each cell, exact."""
    return [[tuple(map(Fraction, q)) for q in cell] for cell in statements.corners_of(statement)]


def margins(robot, q):
    """Distance kept of each boundary in use, in length, by its definition."""
    found = kept_by_kinematics(robot, q).values()
    return np.stack(np.broadcast_arrays(*found), axis=-1)


def smallest_margin(robot, low, high, seed):
    """Search a box for its smallest margin: at random, then downhill from the lowest places."""
    rng = np.random.default_rng(seed)
    low, high = np.array(low, float), np.array(high, float)
    units = statements.units(robot)
    starts = low + (high - low) * rng.random((300, len(low)))
    starts = np.vstack([starts, list(product(*zip(low, high, strict=True)))])

    def value(q):
        return margins(robot, np.asarray(q) * units).min(axis=-1)

    start = starts[np.argsort(value(starts))[0]]
    bounds = list(zip(low, high, strict=True))
    options = {"xatol": 1e-9, "fatol": 1e-12, "maxiter": 200}
    return float(minimize(value, start, method="Nelder-Mead", bounds=bounds, options=options).fun)


# --- the paper's polygon --------------------------------------------------------------------------


def test_the_scaled_polygon_is_proved_and_the_larger_one_refuted_with_its_depth():
    text, robot = paper_robot()
    proved = certify(text, statements.home_polygon(robot, 0.96))
    assert proved.verdict == "proved"
    assert proved.leaves < 400
    refuted = certify(text, statements.home_polygon(robot, 0.97))
    assert refuted.verdict == "refuted"
    assert refuted.witness.boundary == "B7"
    depth = -margins(robot, np.radians(refuted.witness.q)).min()
    assert refuted.witness.depth == pytest.approx(depth, abs=1e-9)
    corners = np.radians(np.array(statements.home_polygon(robot, 0.97)["points"][0], float))
    floor = clearance(robot, robot.boundary("B7"))
    deepest, _ = least(floor, corners, polygon.centroid(corners), 1e-12)
    assert depth == pytest.approx(-deepest, abs=1e-9)


def test_the_largest_scale_is_enclosed():
    text, robot = paper_robot()
    found = bracket_scale(text, width=1e-5)
    (safe, proof), (unsafe, refutation) = found.safe, found.unsafe
    assert proof.verdict == "proved"
    assert refutation.verdict == "refuted"
    assert 0 < float(unsafe) - float(safe) <= 1e-5
    vertices = statements.home_vertices(robot)
    edges = polygon.along_edges(
        polygon.scaled(vertices, float(safe), polygon.centroid(vertices)), np.linspace(0, 1, 200)
    )
    assert min(margins(robot, q).min() for q in edges.reshape(-1, 2)) >= 0
    assert second_checker.verify(proof.text) == "proved"
    assert second_checker.verify(refutation.text) == "refuted"


def test_the_region_is_proved_but_for_a_strip():
    text, robot = paper_robot()
    statement = statements.inner_polygon(robot, 0.5, per_arc=10)
    answer = certify(text, statement)
    assert answer.verdict == "proved"
    assert second_checker.verify(answer.text) == "proved"
    corners = np.radians(np.array(statement["points"][0], dtype=float))
    exact = find_region(robot).home_component.area
    assert 0.9 * exact < polygon.area(corners) < exact


def region_of(text):
    inset = statements.usual_inset(parse_robot(tomllib.loads(text)))
    answer = certify_region(text, inset)
    if answer.verdict == "proved":
        assert second_checker.verify(answer.text) == "proved"
    return answer.verdict


@pytest.mark.parametrize("name", OF_POINTS)
def test_the_region_of_a_packaged_robot_is_proved_by_default(name):
    assert region_of(robot_text(name)[0]) == "proved"


@pytest.mark.parametrize("draw", [random_robot, drawn_robot])
def test_the_region_of_random_robots_is_proved_by_default(draw, tmp_path):
    """Whose arcs bend either way, and whose limits are decimals of any length."""
    proved = 0
    for seed in range(REGIONS):
        save_robot(draw(seed), tmp_path / "robot.toml")
        try:
            verdict = region_of((tmp_path / "robot.toml").read_text())
        except ValueError as error:
            if re.search("home pose|home's margin", str(error)):
                continue
            raise
        assert verdict == "proved", seed
        proved += 1
    assert proved >= REGIONS / 3


def test_a_margin_comes_on_top_of_the_inset():
    text, _ = robot_text("two-joint-arm-with-walls")
    answer = certify_region(text, 0.02, margin="0.03")
    assert answer.verdict == "proved"


def test_a_polygon_of_too_few_points_is_drawn_through_more(monkeypatch):
    name = "rp-telescopic-boom"
    text, robot = robot_text(name)[0], load_robot(name)
    bound_below = statements.second_order
    monkeypatch.setattr(statements, "second_order", lambda forms, q: np.ones((len(q), 1)))
    few = statements.inner_polygon(robot, statements.usual_inset(robot))
    assert certify(text, few).verdict == "refuted"
    assert region_of(text) == "proved"
    monkeypatch.setattr(statements, "second_order", bound_below)
    more = statements.inner_polygon(robot, statements.usual_inset(robot))
    assert sum(map(len, more["points"])) > sum(map(len, few["points"]))


def test_a_region_is_never_refuted_by_a_polygon_drawn_badly(monkeypatch, capsys):
    bad = statements.box(["0", "0"], ["1200", "500"])
    monkeypatch.setattr(statements, "inner_polygon", lambda *_: bad)
    assert certify(robot_text("pp-portal")[0], bad).verdict == "refuted"
    assert cli.main(["certify", "pp-portal", "--region"]) == 3
    assert "undecided: the polygon" in capsys.readouterr().out


RING = "0,0\n1,0\n1,1\n0,1\n"


def test_a_ring_that_is_closed_is_the_polygon_and_a_corner_twice_is_named(tmp_path, capsys):
    ring = tmp_path / "ring.csv"
    said = []
    for text in (RING, RING + "0.0,0\n"):
        ring.write_text(text, encoding="utf-8")
        assert cli.main(["certify", "minervabot-v2", "--polygon", str(ring)]) == 0
        said.append(capsys.readouterr().out)
    assert said[0] == said[1]
    ring.write_text(RING + "1,0\n0.5,2\n", encoding="utf-8")
    assert cli.main(["certify", "minervabot-v2", "--polygon", str(ring)]) == 2
    assert "corner 5 of a loop stands there twice: ['1', '0']" in capsys.readouterr().err


LONG_CELLS = """
schema = 1
name = "cart"
tool = "tip"
length_unit = "m"
angle_unit = "deg"
home = { cart = 0, arm = 0 }
joint = [
  { name = "cart", type = "prismatic", parent = "0", frame = "1", origin = [0, 0, 0], axis = [1, 0, 0], limits = [-50, 50] },
  { name = "arm", type = "revolute", parent = "1", frame = "2", origin = [0, 0, 0], axis = [0, 1, 0] },
]
point = [{ name = "tip", frame = "2", at = [0.1, 0, 0] }, { name = "post", frame = "0", at = [0, 0, 1] }]
boundary = [{ name = "gap", type = "pair", points = ["tip", "post"], clearance = 0.85 }]
"""


@pytest.mark.parametrize("kind", ["box", "polygon"])
def test_a_long_cell_along_a_slide_is_cut_there(kind):
    """The square of the slide bends upwards and spoils no bound; a tangent of it is far below."""
    low, high = ["-50", "-3"], ["40", "3"]
    ring = [low, [high[0], low[1]], high, [low[0], high[1]]]
    asked = statements.box(low, high) if kind == "box" else statements.filled([ring])
    answer = certify(LONG_CELLS, asked)
    assert answer.verdict == "proved"
    assert answer.leaves < 300


def test_an_outline_with_a_corner_nearly_on_an_edge_has_a_certificate():
    bent = BODIES.replace("[[0.2, -0.9]", "[[0.20000000000000018, -0.9]")
    answer = certify(bent, statements.box(["-1", "-1"], ["1", "1"]))
    assert answer.verdict == "proved"
    assert second_checker.verify(answer.text) == "proved"


# --- random robots --------------------------------------------------------------------------------


def test_no_false_answer_on_random_robots():
    """Boxes whose smallest margin is known from a search: asked for none, less, and a hair more."""
    verdicts = []
    for seed in range(ROBOTS):
        joints = 1 + seed % 7
        text = robot_file(seed, joints)
        low, high = box_of(seed, joints)
        least = smallest_margin(robot_of(text), low, high, seed)
        for margin in (0, least - 0.01, least + 1e-6, least + 0.3):
            if margin < 0:
                continue
            claim = statements.box(low, high, statements.decimal(margin))
            answer = certify(text, claim, most=3000)
            verdicts.append(answer.verdict)
            if answer.verdict != "undecided":
                assert answer.verdict == ("proved" if margin < least else "refuted"), seed
                assert second_checker.verify(answer.text) == answer.verdict, seed
    assert min(map(verdicts.count, ("proved", "refuted"))) > ROBOTS / 4


def test_a_limit_is_kept_and_a_witness_beyond_it_named():
    text = robot_file(3, 2, "prismatic")
    answer = certify(text, statements.box(["0", "-4.5"], ["1", "0"]))
    assert answer.verdict == "refuted"
    assert answer.witness.boundary == "q2.lower"
    assert answer.witness.depth == pytest.approx(0.5)
    assert second_checker.verify(answer.text) == "refuted"


def test_what_is_left_is_said():
    text, robot = paper_robot()
    answer = certify(text, statements.home_polygon(robot, 0.96), most=3)
    assert answer.verdict == "undecided"
    assert "B7" in answer.said
    assert "cells" in answer.said
    assert not answer.text


# --- polygons -------------------------------------------------------------------------------------


AWKWARD = {
    "corners in a row": ["0 0", "1 0", "3 0", "3 1", "3 4", "2 4", "0 4", "0 1"],
    "a slanting row that no double holds": ["0 0", "1 0", "0.3 0.9", "0.2 0.6", "0.1 0.3"],
    "twelve places": ["0 0", "0.000000000001 0", "359.999999999999 0.000000000001", "0 360"],
    "a needle": ["-180 0", "180 0", "180 0.000000000001"],
}


@pytest.mark.parametrize("name", AWKWARD)
def test_awkward_polygons_are_cut_exactly(name):
    loop = [corner.split() for corner in AWKWARD[name]]
    statement = statements.filled([loop])
    cells = corners_of(statement)
    doubled = sum(
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) for a, b, c in cells
    )
    exact = [[Fraction(x) for x in corner] for corner in loop]
    pairs = zip(exact, exact[1:] + exact[:1], strict=True)
    assert doubled == sum(a[0] * b[1] - a[1] * b[0] for a, b in pairs)
    assert len(cells) == len(loop) - 2


@pytest.mark.parametrize(
    ("loops", "says"),
    [
        ([["0 0", "0 4", "4 4", "4 0"]], "inside is not on the left"),
        ([["0 0", "4 0", "4 4"], ["1 0.5", "2 0.5", "2 1"]], "inside is not on the left"),
        ([["0 0", "4 0", "4 4"], ["3 1", "9 9", "9 1"]], "crosses itself"),
        ([["0 0", "1 1"]], "3 corners or more"),
    ],
    ids=["clockwise", "hole anticlockwise", "hole outside", "two corners"],
)
def test_loops_that_bound_no_polygon_are_refused(loops, says):
    with pytest.raises(ValueError, match=says):
        statements.filled([[corner.split() for corner in loop] for loop in loops])


# --- floating point -------------------------------------------------------------------------------

VERDICTS = """
import ctypes
import sys
from cspace.proofs.certificates import statements
from cspace.proofs.certificates.certify import certify
from cspace.model.robotfile import robot_text
text, _ = robot_text("minervabot-v2")
boxes = [(["-20", "-80"], ["30", "-40"], "0"), (["-60", "-140"], ["40", "20"], "0")]
for mode in map(int, sys.argv[1:]):
    ctypes.CDLL("libm.so.6").fesetround(mode)
    print([str(certify(text, statements.box(*box)).verdict) for box in boxes])
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the modes have other numbers elsewhere")
def test_the_verdict_is_the_same_in_all_rounding_modes_and_with_two_threads():
    if os.uname().machine != "x86_64":
        pytest.skip("the modes have other numbers elsewhere")
    found = []
    for threads, modes in (("1", [0x000, 0x400, 0x800, 0xC00]), ("2", [0x000])):
        env = os.environ | {"OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads}
        command = [sys.executable, "-c", VERDICTS, *map(str, modes)]
        done = subprocess.run(command, env=env, check=True, capture_output=True, text=True)
        found += done.stdout.splitlines()
    assert found == ["['proved', 'refuted']"] * 5


# --- z3 -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(8))
def test_z3_agrees_on_rational_boxes(seed):
    """Two slides along the axes: the clearances are polynomials, which z3 decides by itself."""
    z3 = pytest.importorskip("z3")
    rng = np.random.default_rng(seed)
    x, z, r = (str(v / 10) for v in rng.integers([-30, -30, 5], [30, 30, 25]))
    text = f"""
schema = 1
name = "slides"
length_unit = "cm"
angle_unit = "deg"
home = {{ q1 = 0, q2 = 0 }}
tool = "t"
joint = [
  {{ name = "q1", type = "prismatic", parent = "0", frame = "1", origin = [0, 0, 0], axis = [1, 0, 0], limits = [-9, 9] }},
  {{ name = "q2", type = "prismatic", parent = "1", frame = "2", origin = [0.5, 0, 0], axis = [0, 0, 1], limits = [-9, 9] }},
]
point = [ {{ name = "t", frame = "2", at = [0, 0, 0] }}, {{ name = "o", frame = "0", at = [{x}, 0, {z}] }} ]
boundary = [ {{ name = "B", type = "pair", points = ["t", "o"], clearance = {r} }} ]
"""
    low, high = box_of(seed, 2, 20)
    q1, q2 = z3.Reals("q1 q2")
    square = (q1 + z3.Q(1, 2) - z3.RealVal(x)) ** 2 + (q2 - z3.RealVal(z)) ** 2
    solver = z3.Solver()
    for q, a, b in zip((q1, q2), low, high, strict=True):
        solver.add(q >= z3.RealVal(a), q <= z3.RealVal(b))
    solver.add(square < z3.RealVal(r) ** 2)
    answer = certify(text, statements.box(low, high)).verdict
    assert answer == {"unsat": "proved", "sat": "refuted"}[str(solver.check())]


# --- the commands ---------------------------------------------------------------------------------


def test_the_commands_answer_with_their_exit_status(tmp_path, capsys):
    file = str(tmp_path / "cert.json")
    assert cli.main(["certify", "minervabot-v2", "--scale", "0.96", "-o", file]) == 0
    assert cli.main(["check", file, "minervabot-v2"]) == 0
    assert cli.main(["check", file, "minervabot-v2-corrected"]) == 2
    assert cli.main(["certify", "minervabot-v2", "--scale", "0.97", "-o", file]) == 1
    assert "cm" in capsys.readouterr().out
    assert cli.main(["check", file]) == 3
    assert cli.main(["certify", "minervabot-v2", "--box", "q1=-20:30", "q2=-80deg:-40deg"]) == 0
    box = ["--box", "q1=-20..30", "q2=-80deg..-40"]  # as in --strip and --limits
    assert cli.main(["certify", "minervabot-v2", *box]) == 0
    path = tmp_path / "path.csv"
    path.write_text("q1,q2\n0,0\n20,-45\n")
    assert cli.main(["certify", "minervabot-v2", "--path", str(path)]) == 0
    path.write_text("q1,q2\n0,0\n20,here\n")
    assert cli.main(["certify", "minervabot-v2", "--path", str(path)]) == 2
    assert "line 3" in capsys.readouterr().err
    path.write_text("0,0\n-20,-45\n20,-45\n")
    assert cli.main(["certify", "minervabot-v2", "--polygon", str(path)]) == 0


def piped(text):
    """Return a file that can be read once."""
    read, write = os.pipe()
    threading.Thread(target=lambda: os.fdopen(write, "w").write(text), daemon=True).start()
    return f"/dev/fd/{read}"


@pytest.mark.skipif(not Path("/dev/fd").is_dir(), reason="no files of open descriptors")
def test_a_certificate_is_read_once():
    text, robot = paper_robot()
    proof = certify(text, statements.home_polygon(robot, 0.9)).text
    assert cli.main(["check", piped(proof)]) == 0


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("0,0\n20,-45\n", [["0", "0"], ["20", "-45"]]),
        ("q1,q2\n+0.50,0\n\n20deg,-90°\n", [["0.50", "0"], ["20", "-90"]]),
        ("t_s,q2_deg,q1_rad,x_cm\n,1,0,7\n0.5,2,0,8\n", [["0", "1"], ["0", "2"]]),
        ("0,0,1\n", "line 1: 3 values for q1, q2"),
        ("0,0\n1,2,3\n", "line 2: 3 values, and 2 in the lines above"),
        ("t_s,q1,q2\n1,2\n", "line 2: 2 values, and 3 in the lines above"),
        ("0,0\n\n1,nan\n", "line 3: q2: 'nan' is no value"),
        ("0,0\n1,0x4\n", "line 2: q2: '0x4' is no value"),
        ("0,0\n1,3cm\n", "line 2: q2: '3cm' is no value"),
        ("q1,q3\n0,0\n", "line 1: 0 columns of q2; wanted one, q2 or q2_deg or q2_rad"),
        ("q1,q2,q2_rad\n0,0,0\n", "line 1: 2 columns of q2"),
        ("\udcff,2\n", "not UTF-8 text"),
    ],
)
def test_tables_of_joint_values_are_those_that_other_commands_write(tmp_path, text, points):
    (tmp_path / "path.csv").write_bytes(text.encode("utf-8", "surrogateescape"))
    robot = load_robot("minervabot-v2")
    if isinstance(points, list):
        assert read_points(robot, str(tmp_path / "path.csv")) == points
        return
    with pytest.raises(ValueError, match=f"path.csv.*{re.escape(points)}"):
        read_points(robot, str(tmp_path / "path.csv"))


def test_what_traverse_writes_certify_proves(tmp_path):
    path = str(tmp_path / "path.csv")
    words = ["traverse", "minervabot-v2", "1", "2", "3", "--scale", "0.9", "--csv", path]
    assert cli.main(words) == 0
    assert cli.main(["certify", "minervabot-v2", "--path", path]) == 0


@pytest.mark.parametrize(
    ("option", "same"),
    [("--margin", ["0.1", "1mm", "0.1 cm", "1e-3m"]), ("--inset", ["1.3", "13mm", "0.013m"])],
)
def test_lengths_take_any_unit_and_stay_exact(tmp_path, option, same):
    """Both took plain numbers only."""
    written = set()
    for length in same:
        words = ["certify", "minervabot-v2", "--region", "--inset", "1", option, length]
        assert cli.main([*words, "-o", str(tmp_path / "cert.json")]) == 0
        claim = json.loads((tmp_path / "cert.json").read_text())["claim"]
        claim["margin"] = Fraction(claim["margin"])
        written.add(str(claim))
    assert len(written) == 1
    for wrong in ("1kg", "5deg", "1e99m", "cm", "m m"):
        assert cli.main(["certify", "minervabot-v2", "--region", option, wrong]) == 2


# --- the checker as a file of its own -------------------------------------------------------------

SCALED = ["certify", "minervabot-v2", "--scale", "0.96"]


def test_the_checker_that_is_printed_is_check_py_and_runs_alone(tmp_path, capfdbinary):
    assert cli.main([*SCALED, "-o", str(tmp_path / "cert.json")]) == 0
    capfdbinary.readouterr()
    assert cli.main(["check", "--source"]) == 0
    source = capfdbinary.readouterr().out
    assert source == Path(check.__file__).read_bytes()
    (tmp_path / "check.py").write_bytes(source)
    words = [sys.executable, "-I", "check.py", "cert.json"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("robot 'MinervaBotV2'")


# --- on a terminal --------------------------------------------------------------------------------


def test_certify_tells_of_its_way_from_nought_to_one():
    text, robot = paper_robot()
    told = []
    certify(text, statements.home_polygon(robot, 0.96), progress=told.append)
    assert 0 <= told[0] < 0.5
    assert told[-1] == pytest.approx(prover.SEARCHING)
    assert told == sorted(told)


def test_the_page_and_the_proofs_scale_one_polygon():
    """Of features of one pair of bodies, too: the proofs had those of two boundaries alone."""
    text = Path(__file__).with_name("once_wrong").joinpath("corridor-1e-13.toml").read_text("utf-8")
    robot = parse_robot(text)
    region = find_region(robot)
    drawn = figure_data(region)["polygon"]
    vertices = [vertex.q.tolist() for vertex in region.home_component.vertices]
    assert drawn["vertices"] == statements.home_vertices(robot).tolist() == vertices
    assert len(vertices) == 14
    found = bracket_scale(text)
    assert float(found.safe[0]) <= drawn["largest"] <= float(found.unsafe[0])


def test_where_no_scale_is_safe_the_command_says_why_and_what_instead(capsys):
    """It said "scale 0.000000001863: refuted", and no more."""
    assert cli.main(["certify", "rp-telescopic-boom", "--largest-scale"]) == 3
    said = capsys.readouterr().out
    centre = (
        "infeasible itself, at lift = -86.3705 deg, slide = 1.30099 m: it violates bridge by 0.23"
    )
    assert f"no scale is proved: the centroid of home's vertices is {centre}" in said
    assert "--region" in said
    assert "0.00000" not in said


def test_a_scale_that_is_not_decided_says_of_what_and_where(capsys, monkeypatch):
    """It ended with status 3, or as if all were decided, and did not say what was not."""
    words = ["certify", "minervabot-v2", "--largest-scale"]
    monkeypatch.setattr(prover, "FEW_CELLS", 200)
    assert cli.main(words) == 0
    said = capsys.readouterr().out
    halved = (
        r"halving stopped at scale 0\.9\d+, undecided: B7: \d+ cells, \S+ % of the set, as at q1"
    )
    assert re.search(halved, said)
    assert re.search(r"scale 0\.9\d+: refuted", said)
    monkeypatch.setattr(prover, "FEW_CELLS", 0)
    assert cli.main(words) == 3
    said = capsys.readouterr().out
    assert re.search(
        r"stopped at scale 1, undecided: B1: 4 cells, 100 % of the set, as at q1", said
    )
    assert cli.main(["certify", "minervabot-v2", "--scale", "0.96", "-o", "-"]) == 0


def test_a_witness_too_shallow_for_the_checker_is_sought_at_a_larger_scale(monkeypatch):
    """The witness at the largest scale was 1e-10 cm deep, and the answer was "undecided"."""
    text, _ = paper_robot()
    confirmed = prover.Subject.confirmed

    def shallow(subject, claim, verdict, **evidence):
        refused.append(verdict)
        if refused.count("refuted") in (1, 2, 3):
            return prover.Certificate(prover.Verdict.UNDECIDED, "", "not violated there")
        return confirmed(subject, claim, verdict, **evidence)

    refused = []
    monkeypatch.setattr(prover.Subject, "confirmed", shallow)
    found = bracket_scale(text, width=1e-6)
    assert found.unsafe[1].verdict == "refuted"
    wider = float(found.unsafe[0]) - float(found.safe[0])
    assert 4e-6 < wider <= 5e-6  # four widths more, after one and two


def test_a_region_that_takes_too_much_work_is_told_with_figures_and_advice(capsys, monkeypatch):
    """It said "the proof asks for too much work", and no more."""
    monkeypatch.setattr(check.Work, "MOST", 100_000)
    assert cli.main(["certify", "minervabot-v2", "--region"]) == 3
    said = capsys.readouterr().out
    assert "the proof asks for too much work" in said
    assert int(re.search(r"cells that were found feasible: (\d+)", said)[1]) > 100
    inset = statements.usual_inset(load_robot("minervabot-v2"))
    assert f"a set with a larger --inset than {inset:g} cm takes less work" in said


def test_a_large_check_leaves_the_next_proof_its_own_work(monkeypatch):
    """The work of a check stayed counted, so that the next claim could not even be read."""
    monkeypatch.setattr(check.Work, "done", check.Work.MOST)
    text, _ = robot_text("minervabot-v2")
    assert certify(text, statements.box(["-10", "-10"], ["10", "10"])).verdict == "proved"


def test_a_polygon_over_holes_of_the_region_says_so_and_what_to_ask_for(capsys):
    """Without an option the set is a polygon that nobody asked for."""
    assert cli.main(["certify", "two-joint-arm-with-walls"]) == 1
    said = capsys.readouterr().out
    assert "home's component has 1 hole, which the polygon of its vertices covers" in said
    assert "--region" in said


def test_many_balls_are_summed_up_by_links_and_the_verdict_comes_last(tmp_path, capsys):
    """An arm's certificate took 395 lines. Of these a few name the links that were left out."""
    box = "0:1", "-90:-89", "90:91", "-90:-89", "-90:-89", "0:1"
    names = [joint.name for joint in load_robot("ur5").joints]
    ranges = [f"{name}={ends}" for name, ends in zip(names, box, strict=True)]
    file = str(tmp_path / "cert.json")
    assert cli.main(["certify", "ur5", "--box", *ranges, "-o", file]) == 0
    certified = capsys.readouterr().out
    assert cli.main(["check", file, "ur5"]) == 0
    checked = capsys.readouterr().out
    for said in (certified, checked):
        assert len(said.splitlines()) < 30
        rows = re.findall(r"^  '\w+' and '\w+': (\d+) pairs of balls, not overlapping$", said, re.M)
        assert sum(map(int, rows)) == len(load_robot("ur5").boundaries)
    assert checked.splitlines()[0] == checked.splitlines()[-1] == "proved"
    assert cli.main(["check", file, "--all"]) == 0
    assert capsys.readouterr().out.count("not overlapping") == sum(map(int, rows))
    data = json.loads(Path(file).read_text())
    data["proof"]["trees"][0] = []
    Path(file).write_text(json.dumps(data))
    assert cli.main(["check", file]) == 2
    assert capsys.readouterr().out.startswith("not proved: ")


def test_a_long_answer_is_folded_between_points(tmp_path, capsys):
    file = str(tmp_path / "cert.json")
    assert cli.main(["certify", "minervabot-v2", "--region", "-o", file]) == 0
    certified = capsys.readouterr().out.splitlines()
    assert cli.main(["check", file]) == 0
    for lines in (certified, capsys.readouterr().out.splitlines()):
        assert max(map(len, lines)) <= 100
        assert all(line.count("(") == line.count(")") for line in lines)


# --- what no certificate can hold -----------------------------------------------------------------


@pytest.mark.parametrize(
    ("low", "high", "margin", "says"),
    [
        (
            ["-2000", "0"],
            ["0", "0"],
            "0",
            "certificates take angles of at most 1800 deg; q1 is at -2000 deg",
        ),
        (["0", "0"], ["1", "1"], "-1", "margin: a number of 0 or more"),
        (["0", "0"], ["1", "1"], "1e99999", "decimal"),
        (["0"], ["1"], "0", "a list of 2 is wanted"),
    ],
)
def test_a_statement_that_no_certificate_can_hold_is_refused_before_the_search(
    low, high, margin, says
):
    text, _ = paper_robot()
    with pytest.raises(ValueError, match=says):
        certify(text, {"set": "box", "margin": margin, "points": [[low, high]]})


@pytest.mark.parametrize("value", ["+20deg", "20.", ".5", "2_0", "1e1deg", "0.2rad"])
def test_joint_values_as_people_type_them_become_decimals_of_the_grammar(value):
    low, high = [f"q1={value}:30deg", "q2=-60deg:-50deg"], DECIMAL
    ends = box(paper_robot()[1], low)
    assert all(high.fullmatch(text) for end in ends for text in end)
