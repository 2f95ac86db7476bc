"""The second checker: its normal form, its bounds against samples, and what it must refuse."""

import copy
import hashlib
import json
import math
from itertools import product

import numpy as np
import pytest

pytest.importorskip("flint")

from flint import arb, ctx, fmpq

from qbound.model.robotfile import packaged_robots, parse_robot, robot_text
from qbound.proofs.second import proof, verify
from qbound.proofs.second.cells import Box, Simplex, numbered
from qbound.proofs.second.normal import canonical, is_convex, normal_form, text
from qbound.proofs.second.reading import Claim, Work, exact
from qbound.proofs.second.waves import Form, halved
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


@pytest.mark.parametrize("seed", range(60))
def test_a_place_along_a_direction_is_within_the_bound(seed):
    rng = np.random.default_rng(seed)
    table = random_robot(rng)
    robot, cell = parse_robot(table), random_cell(rng, table)
    with ctx.workprec(192):
        scene = scene_of(table)
        keep = scene.keep[0]
        terms = halved(scene.seen(keep, keep.far.corners), ())
        u = rng.integers(-9, 10, 3).tolist()
        from flint import acb_mat

        rows = {key: acb_mat([u]) * value for key, value in terms.items()}
        form = Form(scene.chain, scene.between(keep), rows, scene.reach)
        linear, errors = form.over(cell)
        least = min(
            float((v[0] - e[0]).lower())
            for v, e in zip(linear.tolist(), errors.tolist(), strict=True)
        )
        most = max(
            float((v[0] + e[0]).upper())
            for v, e in zip(linear.tolist(), errors.tolist(), strict=True)
        )
    q = in_units(table, places_in(rng, cell, 300))
    frames = robot.frames(q)
    far, near = (frames.names.index(x) for x in table["boundary"][0]["points"])
    names = table["boundary"][0]["points"]
    where = {p["name"]: p["frame"] for p in table["point"]}
    seen = np.broadcast_to(
        frames.position(where[names[1]], names[0], where[names[1]]), (len(q), 3)
    )
    found = seen @ np.array(u)
    assert least <= found.min() + 1e-12
    assert found.max() - 1e-12 <= most
