# ruff: noqa: E501  (a table)
"""Checker and oracle on mutants and random robots; what they accept is true by other kinematics."""

import os
import random
import tomllib
from collections import Counter

import numpy as np
import pytest

pytest.importorskip("flint")

from engine_support import body_scenes, brute_force, mutations
from engine_support.certificates import NotFound, no_path, proved, refuted
from engine_support.claims import HALVES, between, box, original, path, polygon
from engine_support.robot_files import ALL_KINDS, robot_file

ROBOTS = int(os.environ.get("QBOUND_CHECK_ROBOTS", "30"))
"""Random robots; set it to 800 for a long run."""


# --- mutants --------------------------------------------------------------------------------------


@pytest.mark.parametrize("first", range(0, 1200, 100))
def test_both_checkers_agree_on_mutants_and_what_they_accept_is_true(first):
    faults = {
        seed: mutations.fault_of(mutations.mutant(seed), seed) for seed in range(first, first + 100)
    }
    assert not {seed: fault for seed, fault in faults.items() if fault}


LIES = {
    "a margin that is not kept": ("box", lambda d: d["claim"].update(margin="3")),
    "a larger box": ("bodies", lambda d: d["claim"]["points"][0].__setitem__(1, ["40", "15"])),
    "a path to the crate": ("bodies, path", lambda d: d["claim"]["points"][0].append(["40", "0"])),
    "a witness that is safe": ("witness", lambda d: d["witness"].update(at=["0", "0"])),
    "a witness beside its set": ("witness", lambda d: d["witness"].update(at=["90", "2"])),
    "a witness of another thing": ("witness", lambda d: d["witness"]["place"].update(keep=1)),
    "a limit that is kept": ("limit", lambda d: d["witness"].update(limit="q2.lower")),
    "a path along one side": ("no path", lambda d: d["claim"].update(points=[[["70"], ["110"]]])),
    "a path over a seam": ("no path, any turn", lambda d: d["claim"].update(points=[[["170", "0"], ["-170", "0"]]])),
}  # fmt: skip


@pytest.mark.parametrize("name", LIES)
def test_the_judge_sees_a_lie(name):
    start, change = LIES[name]
    data = original(start)
    assert brute_force.tells_the_truth(data)
    change(data)
    assert not brute_force.tells_the_truth(data)


# --- random robots --------------------------------------------------------------------------------


def random_robot(seed):
    """Return the text of a robot of points in space, or of bodies in a plane."""
    rng = random.Random(seed)
    unit = rng.choice(("deg", "rad"))
    if seed % 2:
        return robot_file(seed, rng.randint(1, 4), ALL_KINDS, unit)
    kinds = "".join(rng.choice("RRP") for _ in range(rng.randint(1, 3)))
    kinds = kinds if "R" in kinds else "PP"  # which slide in one plane
    return body_scenes.whole(100 + seed, kinds, rng.choice([*body_scenes.PLANES]), 2, unit)


def random_claim(rng, table):
    """Return a box, a path or a square about a random place within the limits."""
    whole = 180 if table["angle_unit"] == "deg" else 3.1
    limits = [row.get("limits", (-whole, whole)) for row in table["joint"]]
    size = rng.choice((0.01, 0.05, 0.15))
    middle = [rng.uniform(a + size * (b - a), b - size * (b - a)) for a, b in limits]
    wide = [size * (b - a) * rng.choice((1, 1, 0)) for a, b in limits]

    def at(*parts):
        rows = zip(middle, wide, parts, strict=True)
        return " ".join(f"{x + w * part:.4f}" for x, w, part in rows)

    count, kind = len(limits), rng.choice(("box", "path", "square"))
    if kind == "square" and sum(w > 0 for w in wide) == 2:
        first = next(j for j, w in enumerate(wide) if w)
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        loop = [at(*(a if j <= first else b for j in range(count))).split() for a, b in corners]
        return polygon([loop], HALVES)
    if kind == "box":
        return box(at(*[-1] * count), at(*[1] * count)) | {"margin": rng.choice(("0", "0.01"))}
    return path(", ".join(at(*(rng.uniform(-1, 1) for _ in range(count))) for _ in range(3)))


def attempts(seed):
    """Yield certificates of claims about a random robot, as far as they are found."""
    rng, text = random.Random(seed), random_robot(seed)
    table = tomllib.loads(text)
    for _ in range(3):
        claim = {"margin": "0"} | random_claim(rng, table)
        q = brute_force.configurations(claim, np.random.default_rng(seed), 300)
        margins = brute_force.kept(table, claim, q)
        try:
            if margins.min() > 0:
                yield proved(text, claim, depth=7)
            elif claim["set"] == "box":
                at = [f"{x:.4f}" for x in q[margins.argmin()]]
                yield refuted(text, claim, at=at)
        except NotFound:
            pass
    joints = [rng.choice(("moves", "held", "any")) for _ in table["joint"]]
    joints[rng.randrange(len(joints))] = "moves"
    claims = [random_claim(rng, table)["points"][0][0] for _ in "ab"]
    goal = [a if kind == "held" else b for a, b, kind in zip(*claims, joints, strict=True)]
    ends = between(" ".join(claims[0]), " ".join(goal), " ".join(joints))
    yield no_path(text, ends, depth=6)


def test_what_is_accepted_of_random_robots_is_true():
    told = Counter()
    for seed in range(ROBOTS):
        for data in attempts(seed):
            one, _ = mutations.answers(data)
            kind = data["claim"]["set"] + " " + one.partition(":")[0]
            told[kind] += 1
            if data["claim"]["set"] != "no path":  # found with the first one's own inequality
                assert not one.startswith("refused"), (seed, one)
            assert mutations.fault_of(data, seed) == "", seed
    assert {"box proved", "path proved", "box refuted", "no path proved", "no path refused"} <= {
        *told
    }, told
