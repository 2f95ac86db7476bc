# ruff: noqa: E501  (rows of robot files, one a line)
"""The second checker: its normal form, its bounds against samples, and what it must refuse."""

import json

import numpy as np
import pytest

pytest.importorskip("flint")

from flint import acb_mat, ctx, fmpq

from qbound import check
from qbound.model.robotfile import packaged_robots, parse_robot, robot_text
from qbound.proofs import Verdict
from qbound.proofs.second import proof, verify
from qbound.proofs.second.cells import Box, Simplex, numbered
from qbound.proofs.second.normal import is_convex, normal_form, text
from qbound.proofs.second.reading import Claim, Work, exact
from qbound.proofs.second.waves import Form, halved
from support import certificates

# --- random robots, and where their places are ----------------------------------------------------


def random_robot(rng, planar=False):
    """A robot file of one to four joints of all kinds, a point on each frame, as text and table."""
    count = rng.integers(1, 4 if planar else 5)
    kinds = rng.choice(["revolute", "prismatic", "parallelogram"], count, p=[0.6, 0.3, 0.1])
    joints, frames = [], ["base"]
    for j, kind in enumerate(kinds):
        turned = rng.random() < 0.5
        joint = {
            "name": f"q{j}",
            "type": str(kind),
            "parent": frames[-1],
            "frame": f"f{j}",
            "origin": rng.uniform(-1, 1, 3).round(3).tolist(),
            "axis": rng.uniform(-1, 1, 3).round(3).tolist(),
            "rpy": rng.uniform(-180, 180, 3).round(1).tolist() if turned else [0, 0, 90],
        }
        if kind == "parallelogram":
            joint |= {"bar": f"b{j}", "crank": rng.uniform(-1, 1, 3).round(3).tolist()}
            frames.append(f"b{j}")
        if kind == "prismatic":
            joint["limits"] = [-0.5, 1]
        frames.append(f"f{j}")
        joints.append(joint)
    points = [
        {"name": f"p{k}", "frame": frame, "at": rng.uniform(-1, 1, 3).round(3).tolist()}
        for k, frame in enumerate(frames)
    ]
    near, far = sorted(rng.choice(len(frames), 2, replace=False).tolist())
    return {
        "schema": 1,
        "name": "random",
        "length_unit": "m",
        "angle_unit": "deg",
        "home": {joint["name"]: 0 for joint in joints},
        "tool": "p0",
        "joint": joints,
        "point": points,
        "boundary": [
            {"name": "pair", "type": "pair", "points": [f"p{far}", f"p{near}"], "clearance": 0.5},
            {
                "name": "wall",
                "type": "half-space",
                "point": f"p{far}",
                "normal": rng.uniform(-1, 1, 3).round(2).tolist(),
                "offset": 0.25,
            },
        ],
    }


def as_text(table):
    import tomlkit

    return tomlkit.dumps(table)


def random_cell(rng, table):
    """A box, segment or triangle within the limits, in decimals of the file."""
    turns = [joint["type"] != "prismatic" for joint in table["joint"]]
    low = [rng.uniform(-180, 180) if t else rng.uniform(-0.5, 0.2) for t in turns]
    wide = [rng.uniform(0, 60) if t else rng.uniform(0, 0.8) for t in turns]
    wide = [w * (rng.random() < 0.8) for w in wide]
    decimals = [[fmpq(round(1000 * x), 1000) for x in row] for row in (low, wide)]
    low, wide = decimals
    if rng.random() < 0.5:
        return Box(tuple(low), tuple(a + w for a, w in zip(low, wide, strict=True)))
    parts = rng.integers(0, 5, (rng.integers(2, 4), len(low))).tolist()
    return Simplex(
        tuple(tuple(a + w * k / 4 for a, w, k in zip(low, wide, row, strict=True)) for row in parts)
    )


def places_in(rng, cell, count):
    """Configurations of a cell, its corners among them, as floats."""
    if isinstance(cell, Box):
        low, high = (np.array([float(x) for x in q]) for q in (cell.low, cell.high))
        part = rng.choice([0, 1, 0.5, rng.random()], (count, len(low)))
        return low + part * (high - low)
    corners = np.array([[float(x) for x in q] for q in cell.corners])
    return rng.dirichlet([0.4] * len(corners), count) @ corners


def in_units(table, q):
    turns = [joint["type"] != "prismatic" for joint in table["joint"]]
    return np.where(turns, np.radians(q), q)


def scene_of(table, joints=()):
    form = normal_form(as_text(table), {})
    zero = tuple(fmpq(0) for _ in table["joint"])
    claim = Claim("box", fmpq(0), [[zero, zero]], [], list(joints))
    return proof.Scene(form, claim, Work())


def seen_in(robot, table, q):
    """The first point of the pair, seen from the frame of the second one; (N, 3)."""
    frames = robot.frames(q)
    far, near = table["boundary"][0]["points"]
    observer = next(p["frame"] for p in table["point"] if p["name"] == near)
    return np.broadcast_to(frames.position(observer, far, observer), (len(q), 3))


@pytest.mark.parametrize("seed", range(60))
def test_a_place_along_a_direction_is_within_the_bound(seed):
    rng = np.random.default_rng(seed)
    table = random_robot(rng)
    cell, u = random_cell(rng, table), rng.integers(-9, 10, 3).tolist()
    with ctx.workprec(192):
        scene = scene_of(table)
        keep = scene.keep[0]
        terms = halved(scene.seen(keep, keep.far.corners), ())
        rows = {key: acb_mat([u]) * value for key, value in terms.items()}
        form = Form(scene.chain, scene.between(keep), rows, scene.reach)
        linear, errors = (matrix.tolist() for matrix in form.over(cell))
    ends = [(float(v[0]), float(e[0])) for v, e in zip(linear, errors, strict=True)]
    q = in_units(table, places_in(rng, cell, 300))
    found = seen_in(parse_robot(table), table, q) @ np.array(u)
    assert min(v - e for v, e in ends) <= found.min() + 1e-12
    assert found.max() - 1e-12 <= max(v + e for v, e in ends)


@pytest.mark.parametrize("seed", range(120))
def test_a_distance_is_within_the_bound_whatever_the_other_joints_are(seed):
    rng = np.random.default_rng(seed)
    table = random_robot(rng)
    cell, count = random_cell(rng, table), len(table["joint"])
    kinds = rng.choice(["moves", "held", "any"], count).tolist()
    weights = {"keep": seed % 2, "near": [] if seed % 2 else ["1"], "far": ["1"]}
    with ctx.workprec(192):
        scene = scene_of(table)
        moving = [j for j in range(count) if kinds[j] == "moves"]
        fixed = [j for j in range(count) if kinds[j] == "held"]
        start = [(cell.low if isinstance(cell, Box) else cell.corners[0])[j] for j in fixed]
        values = dict(zip(fixed, scene.chain.scaled(fixed, start), strict=True))
        bound = float(proof.Place(scene, weights, moving, values).distance(cell)[0])
    places = places_in(rng, cell, 400)
    for j, joint in enumerate(table["joint"]):
        low, high = joint.get("limits", (-180, 180))
        if kinds[j] == "any":
            places[:, j] = rng.uniform(low, high, 400)
    places[:, fixed] = [float(x) for x in start]
    q, robot = in_units(table, places), parse_robot(table)
    if seed % 2:
        wall = robot.boundary("wall")
        found = robot.frames(q).position("base", wall.point, "base") @ wall.normal
    else:
        near = next(p for p in table["point"] if p["name"] == table["boundary"][0]["points"][1])
        found = np.linalg.norm(seen_in(robot, table, q) - near["at"], axis=1)
    assert found.max() <= bound + 1e-12
    if "any" not in kinds and isinstance(cell, Box) and cell.low == cell.high:
        assert found.max() == pytest.approx(bound)


# --- certificates ---------------------------------------------------------------------------------


BOXES = {
    "minervabot-v2": [["-20", "-10"], ["10", "10"]],
    "minervabot-v2-bodies": [["-10", "-10"], ["10", "10"]],
    "pp-portal": [["120", "330"], ["180", "370"]],
    "two-links-on-a-table": [["60", "-10"], ["70", "10"]],
}


@pytest.mark.parametrize("name", packaged_robots())
def test_both_ways_lead_to_one_normal_form(name):
    robot = robot_text(name)[0]
    assert normal_form(robot, {}) == check.normal_form(robot, {})


@pytest.mark.parametrize("seed", range(30))
def test_both_ways_lead_to_one_normal_form_of_random_robots(seed):
    robot = as_text(random_robot(np.random.default_rng(seed)))
    assert normal_form(robot, {}) == check.normal_form(robot, {})


HOLLOW = """schema = 1
name = "hollow"
length_unit = "m"
angle_unit = "rad"
home = { q = 0, s = 0 }
tool = "p"
collisions = "all"
clearance = 1e-2
joint = [
  { name = "q", type = "revolute", parent = "b", frame = "f", origin = [0, 0, 0.50], axis = [0, -2, 0] },
  { name = "s", type = "prismatic", parent = "f", frame = "g", origin = [1e1, 0, 0], rpy = [1.5707963267948966, 0, 0], axis = [1, 0, 0], limits = [-1, 2.50] },
]
point = [
  { name = "p", frame = "g", at = [1, 2, 3] },
]
body = [
  { frame = "g", capsule = { from = [1, 0], to = [2, 0], radius = 0.5 } },
]
obstacle = [
  { name = "hook", polygon = [[-5, -5], [5, -5], [5, 0], [0, 0], [0, 5], [-5, 5]] },
]
"""
PARTS = {"hook": [[0, 1, 2, 3], [0, 3, 4, 5]]}


def test_the_normal_form_names_convex_parts():
    form = normal_form(HOLLOW, PARTS)
    assert form == check.normal_form(HOLLOW, PARTS)
    assert [row["name"] for row in form["keep"]] == ["g, hook"] * 2
    assert form["hulls"][0]["corners"][1] == ["5", "0", "-5"]
    assert (form["keep"][0]["gap"], form["keep"][0]["along"]) == ("0.51", 1)


@pytest.mark.parametrize("name", BOXES)
@pytest.mark.parametrize("kind", ["box", "path", "polygon"])
def test_a_set_is_proved(name, kind):
    (a, b), (c, d) = BOXES[name]
    points = {"box": [BOXES[name]], "path": [BOXES[name]], "polygon": [[[a, b], [c, b], [c, d]]]}
    more = {"triangles": [[0, 1, 2]]} if kind == "polygon" else {}
    claim = {"set": kind, "points": points[kind], **more}
    data = certificates.proved(robot_text(name)[0], claim)
    assert verify(json.dumps(data)) == Verdict.PROVED
    trees = data["proof"]["trees"]
    for k in [k for k, rows in enumerate(trees) if rows]:
        data["proof"]["trees"] = [[*rows] for rows in trees]
        data["proof"]["trees"][k][0] = "a" + trees[k][0]
        with pytest.raises(ValueError, match="tree"):
            verify(json.dumps(data))


# --- pieces ---------------------------------------------------------------------------------------


def test_numbers_are_written_in_full():
    for written in ("0", "-0.5", "12", "0.000125", "-120", "3.14"):
        assert text(exact(written)) == written
    assert text(exact("1.50e-3")) == "0.0015"
    assert text(exact("-0.0")) == "0"


def test_equal_places_have_one_number_whatever_their_hash():
    prime = 2**61 - 1
    points = [(fmpq(k * prime, 10**40), fmpq(0)) for k in (3, 1, 2, 1, 3)]
    assert numbered(points) == [2, 0, 1, 0, 2]


@pytest.mark.parametrize(
    ("corners", "convex"),
    [
        ([(0, 0), (1, 0), (0, 1)], True),
        ([(0, 0), (0, 1), (1, 0)], True),
        ([(0, 0), (1, 0), (2, 0), (0, 1)], True),
        ([(0, 0), (2, 0), (1, 0), (0, 1)], False),
        ([(0, 0), (1, 0), (2, 0)], False),
        ([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2)], False),
        ([(0, 0), (4, 3), (0, 3), (4, 0), (2, 5)], False),
        ([(0, 0), (2, 0), (0, 2)] * 2, False),
        ([(0, 0), (0, 0), (2, 0), (0, 2)], False),
    ],
)
def test_an_outline_is_convex_where_it_turns_one_way_once_round(corners, convex):
    assert is_convex(corners) == convex


def test_a_leaf_is_cut_further_where_its_bound_needs_it(monkeypatch):
    robot = """schema = 1
name = "crank"
length_unit = "m"
angle_unit = "deg"
home = { q = 0 }
tool = "end"
joint = [{ name = "q", type = "revolute", parent = "0", frame = "1", origin = [0, 0, 0], axis = [0, 1, 0] }]
point = [{ name = "end", frame = "1", at = [1, 0, 0] }]
boundary = [{ name = "floor", type = "half-space", point = "end", normal = [0, 0, 1], offset = -0.99 }]
"""
    claim = {"set": "box", "points": [[["-80"], ["80"]]]}
    data = certificates.proved(robot, claim)
    assert len(data["proof"]["trees"][0][0]) > 1
    data["proof"]["trees"] = [["."]]
    assert verify(json.dumps(data)) == Verdict.PROVED
    monkeypatch.setattr(proof, "DEEPEST_HERE", 0)
    with pytest.raises(ValueError, match="not proved on every leaf"):
        verify(json.dumps(data))


def test_work_is_bounded(monkeypatch):
    claim = {"set": "box", "points": [BOXES["pp-portal"]]}
    data = certificates.proved(robot_text("pp-portal")[0], claim)
    monkeypatch.setattr("qbound.proofs.second.reading.MOST_WORK", 100)
    with pytest.raises(ValueError, match="too much work"):
        verify(json.dumps(data))
