"""The second checker: its normal form, its bounds against samples, and what it must refuse."""

import copy
import hashlib
import json
import math
from itertools import product

import numpy as np
import pytest

pytest.importorskip("flint")

from flint import acb_mat, arb, ctx, fmpq

from qbound.model.robotfile import packaged_robots, parse_robot, robot_text
from qbound.proofs.second import proof, verify
from qbound import check
from qbound.proofs.second.cells import HOLDS, Box, Simplex, cells_of, numbered
from qbound.proofs.second.normal import canonical, is_convex, normal_form, text
from qbound.proofs.second.reading import Claim, Work, exact, read_claim
from qbound.proofs.second.waves import Form, halved, held
from qbound.proofs.verdict import Verdict


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
    table = {
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
    return table


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


def sealed(robot, claim, parts=None, **more):
    """A certificate as a table, its hash right."""
    form = normal_form(robot, parts or {})
    digest = hashlib.sha256(canonical(form).encode()).hexdigest()
    start = {"schema": "qbound/certificate/6", "robot": robot, "parts": parts or {}}
    return {**start, "sha256": digest, "claim": {"margin": "0", **claim}, **more}


def scene_and_cells(robot, claim, parts):
    data = sealed(robot, claim, parts)
    form = normal_form(robot, parts or {})
    read = read_claim(data["claim"], form)
    return proof.Scene(form, read, Work()), data


def candidates(scene, keep, cell):
    """Directions that may separate two hulls at the middle of a cell, as three integers."""
    middle = cell.middle
    values = dict(enumerate(scene.chain.scaled(range(len(middle)), middle)))
    [found] = held(scene.seen(keep, keep.far.corners), values).values()
    far = [[float(x.real) for x in row] for row in zip(*found.tolist(), strict=True)]
    near = [[float(x) for x in corner] for corner in keep.near.corners]
    steps = [np.subtract(r, p) for r, p in product(far, near)]
    if keep.along is not None:
        for hull in (near, far):
            for k in range(len(hull) if len(hull) > 1 else 0):
                across = np.cross(np.subtract(hull[k], hull[k - 1]), np.eye(3)[keep.along])
                steps += [across, -across]
    for step in steps:
        if keep.along is not None:
            step[keep.along] = 0
    steps = [s / abs(s).max() for s in steps if abs(s).max() > 1e-9]
    gaps = [min(s @ r for r in far) - max(s @ p for p in near) for s in steps]
    best = [steps[k] for k in np.argsort(np.divide(gaps, np.linalg.norm(steps, axis=1)))[::-1][:3]]
    return [np.rint(1000 * s).astype(int).tolist() for s in best]


def proved(robot, claim, parts=None, deepest=14):
    """A certificate of a set; its search trusts the second checker's own bound."""
    with ctx.workprec(192):
        scene, data = scene_and_cells(robot, claim, parts)
        directions, trees = [], []

        def grown(kept, cell, depth):
            rows = [None] if kept.keep.normal else candidates(scene, kept.keep, cell)
            for row in rows:
                if row is not None:
                    directions.append(row)
                [form], need = kept.form(str(len(directions) - 1) if row is not None else "")
                cut = proof.is_above(form, need, cell)
                if cut == HOLDS:
                    return f"{len(directions) - 1}." if row is not None else "."
                if row is not None:
                    directions.pop()
            assert cut is not None and depth < deepest, kept.keep.name
            halves = [grown(kept, half, depth + 1) for half in cell.halves(cut)]
            return "abcdefg"[cut] + "".join(halves)

        for keep in scene.keep:
            kept, corners = proof._Kept(scene, keep, directions), [*keep.near[1], *keep.far[1]]
            needed = keep.normal or keep.gap != 0 or len(corners) > 3
            cells = cells_of(scene.claim) if needed else []
            trees.append([grown(kept, cell, 0) for cell in cells])
    return {**data, "proof": {"directions": directions, "trees": trees}}


def both(data):
    """The answer of both checkers, which agree; a refusal is None."""
    text, found = json.dumps(data), []
    for checker in (verify, check.check):
        try:
            answer = checker(text)
        except ValueError:
            answer = None
        found.append(answer if answer is None else answer == Verdict.REFUTED)
        if checker is check.check and answer is not None:
            found[-1] = answer.refuted
    assert found[0] == found[1], found
    return None if found[0] is None else ("refuted" if found[0] else "proved")


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

[[joint]]
name = "q"
type = "revolute"
parent = "b"
frame = "f"
origin = [0, 0, 0.50]
axis = [0, -2, 0]

[[joint]]
name = "s"
type = "prismatic"
parent = "f"
frame = "g"
origin = [1e1, 0, 0]
rpy = [1.5707963267948966, 0, 0]
axis = [1, 0, 0]
limits = [-1, 2.50]

[[point]]
name = "p"
frame = "g"
at = [1, 2, 3]

[[body]]
frame = "g"
capsule = { from = [1, 0], to = [2, 0], radius = 0.5 }

[[obstacle]]
name = "hook"
polygon = [[-5, -5], [5, -5], [5, 0], [0, 0], [0, 5], [-5, 5]]
"""
PARTS = {"hook": [[0, 1, 2, 3], [0, 3, 4, 5]]}


def test_the_normal_form_names_convex_parts():
    form = normal_form(HOLLOW, PARTS)
    assert form == check.normal_form(HOLLOW, PARTS)
    assert [row["name"] for row in form["keep"]] == ["g, hook"] * 2
    assert form["hulls"][0]["corners"][1] == ["5", "0", "-5"]
    assert (form["keep"][0]["gap"], form["keep"][0]["along"]) == ("0.51", 1)


@pytest.mark.parametrize(
    "parts",
    [
        {},
        {"hook": [[0, 1, 2, 3, 4, 5]]},
        {"hook": [[0, 1, 2, 3]]},
        {"hook": [[0, 1, 2, 3], [0, 3, 4, 5], [0, 3, 4, 5]]},
        {"hook": [[3, 2, 1, 0], [0, 3, 4, 5]]},
        {"hook": [[0, 1, 2, 3], [0, 3, 4, True]]},
        {"hook": [[0, 1, 2, 3], [0, 3, 4, 6]]},
        {"hook": PARTS["hook"], "g": [[0, 1, 0]]},
        [],
    ],
)
def test_parts_fill_their_outline(parts):
    with pytest.raises(ValueError, match="part"):
        normal_form(HOLLOW, parts)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("1e-2", "1e-101"),
        ("1e-2", "nan"),
        ("1e-2", "inf"),
        ("1e-2", "-0.1"),
        ("1e-2", "0." + "1" * 200),
        ("1e-2", "1e400"),
        ("1.5707963267948966", "31"),
        ("[1, 0], to", "[1, 0, 0.1], to"),
        ("schema = 1", "schema = 1\na.b.c.d.e.f.g.h.i.j = 1"),
        ("schema = 1", "schema = " + "[" * 5000),
        ("schema = 1", "schema = 1\nschema = 1"),
        ('"f"', '"b"'),
    ],
)
def test_a_robot_file_is_read_strictly(old, new):
    with pytest.raises(ValueError, match=r"^[ -~]*$"):
        normal_form(HOLLOW.replace(old, new, 1), PARTS)


@pytest.mark.parametrize("name", BOXES)
@pytest.mark.parametrize("kind", ["box", "path", "polygon"])
def test_a_set_is_proved(name, kind):
    (a, b), (c, d) = BOXES[name]
    points = {"box": [BOXES[name]], "path": [BOXES[name]], "polygon": [[[a, b], [c, b], [c, d]]]}
    more = {"triangles": [[0, 1, 2]]} if kind == "polygon" else {}
    data = proved(robot_text(name)[0], {"set": kind, "points": points[kind], **more})
    assert verify(json.dumps(data)) == Verdict.PROVED
    for k, rows in enumerate(data["proof"]["trees"]):
        if rows:
            wrong = copy.deepcopy(data)
            wrong["proof"]["trees"][k][0] = "a" + wrong["proof"]["trees"][k][0]
            with pytest.raises(ValueError, match="tree"):
                verify(json.dumps(wrong))
