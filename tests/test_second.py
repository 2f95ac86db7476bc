# ruff: noqa: E501  (rows of robot files, one a line)
"""The second checker: its normal form, its bounds against samples, and what it must refuse."""

import json

import numpy as np
import pytest

pytest.importorskip("flint")

from flint import acb_mat, ctx, fmpq

from qbound import check
from qbound.model.robotfile import packaged_robots, robot_text
from qbound.proofs import Verdict
from qbound.proofs.second import proof, verify
from qbound.proofs.second.cells import Box, Cell, numbered
from qbound.proofs.second.normal import is_convex, normal_form, text
from qbound.proofs.second.reading import Claim, Work, exact
from qbound.proofs.second.waves import Form, halved
from support import certificates
from support.robot_files import ALL_KINDS, robot_file
from support.samples import Sample

# --- the bounds, against samples ------------------------------------------------------------------


def scene_of(s):
    """Return the scene and the cell of a sample, in rationals."""
    corners = [tuple(fmpq(x.numerator, x.denominator) for x in q) for q in s.corners]
    claim = Claim("box", fmpq(0), [corners], [], [])
    scene = proof.Scene(normal_form(s.draft.text, {}), claim, Work())
    return scene, (Box if isinstance(s.cell, check.Box) else Cell)(tuple(corners))


def ends_of(keep):
    return [[float(x) for x in hull.corners[0]] if hull.corners else [0.0] * 3
            for hull in (keep.near, keep.far)]  # fmt: skip


@pytest.mark.parametrize("seed", range(60))
def test_a_place_along_a_direction_is_within_the_bound(seed):
    s = Sample(seed)
    with ctx.workprec(192):
        scene, cell = scene_of(s)
        for keep in scene.keep:
            u = [s.rng.randint(-9, 9) for _ in "xyz"]
            terms = halved(scene.seen(keep, keep.far.corners), ())
            rows = {key: acb_mat([u]) * value for key, value in terms.items()}
            form = Form(scene.chain, scene.between(keep), rows, scene.reach)
            linear, errors = (matrix.tolist() for matrix in form.over(cell))
            ends = [(float(v[0]), float(e[0])) for v, e in zip(linear, errors, strict=True)]
            found = s.seen(keep.far.frame, ends_of(keep)[1], keep.near.frame) @ np.array(u)
            assert min(v - e for v, e in ends) <= found.min() + 1e-10
            assert found.max() - 1e-10 <= max(v + e for v, e in ends)


@pytest.mark.parametrize("seed", range(120))
def test_a_distance_is_within_the_bound_whatever_the_other_joints_are(seed):
    s = Sample(seed, free_share=0.3)
    with ctx.workprec(192):
        scene, cell = scene_of(s)
        own = [j for j in range(len(scene.limits)) if j not in s.leaf.free]
        fixed = [j for j in own if len({q[j] for q in cell.corners}) == 1]
        start = scene.chain.scaled(fixed, [cell.corners[0][j] for j in fixed])
        values, moving = dict(zip(fixed, start, strict=True)), [j for j in own if j not in fixed]
        spots = [{"keep": k, "near": ["1"] * len(keep.near.corners), "far": ["1"]}
                 for k, keep in enumerate(scene.keep)]  # fmt: skip
        places = [proof.Place(scene, spot, moving, values) for spot in spots]
        for keep, place in zip(scene.keep, places, strict=True):
            bound, (near, far) = float(place.distance(cell)[0]), ends_of(keep)
            found = s.seen(keep.far.frame, far, keep.near.frame) - near
            normal = np.array([float(x) for x in keep.normal])
            found = found @ normal / np.linalg.norm(normal) if len(normal) else found
            found = found if len(normal) else np.linalg.norm(found, axis=1)
            assert found.max() <= bound + 1e-10
            if not moving and not s.leaf.free:
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
    robot = robot_file(seed, 1 + seed % 4, ALL_KINDS)
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
