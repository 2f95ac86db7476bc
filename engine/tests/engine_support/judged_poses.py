"""What judges say of poses that the library calls feasible, of a robot file or an imported arm.

Poses are random ones, and as many at the edge: the last feasible place, found by halving, between a
feasible random pose and one that is not.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cspace import Robot, is_feasible, load_robot
from cspace.urdf.arm import import_urdf
from engine_support import brute_force
from engine_support.urdf_judge import LIBRARY, UrdfJudge

Floats = NDArray[np.float64]

ROUNDING = 1e-10
"""Of a margin, beside the reach of the arm."""

STILL = {"margin": "0"}
"""What is asked beyond the clearances of a file."""

DEEP = {"coal": 1e-6, "fcl": 1e-5}[LIBRARY]
"""How deep two shapes are in each other, m, before the library's own error is ruled out."""

STEPS = 45
"""Of halving: what is left is rounding."""


class Found(NamedTuple):
    """What a judge says of an arm: pairs that are looked at, and counts of poses.

    The least distance or margin (length) is of feasible poses. Wrong are poses that are called
    feasible and are not: joint values, what meets, how deep. Lost are the opposite.
    """

    pairs: int
    left_out: int
    feasible: int
    least: float
    wrong: list[tuple[list[float], str, float]]
    lost: int


def poses(robot: Robot, count: int) -> tuple[Floats, NDArray[np.bool_]]:
    """Return random poses and those at the edge, and which of them the library calls feasible."""
    limits = np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])
    q = np.random.default_rng(0).uniform(*limits.T, (count, len(limits)))
    feasible = is_feasible(robot, q)
    if feasible.all() or not feasible.any():
        return q, feasible
    inner, outer = (np.resize(q[each], q.shape) for each in (feasible, ~feasible))
    for _ in range(STEPS):
        middle = (inner + outer) / 2
        good = is_feasible(robot, middle)[:, None]
        inner, outer = np.where(good, middle, inner), np.where(good, outer, middle)
    q = np.concatenate([q, inner])
    return q, is_feasible(robot, q)


def judged_file(file: Path, count: int) -> Found:
    """Judge a robot file: all margins, and all bodies that are not left out."""
    table, robot = tomllib.loads(file.read_text(encoding="utf-8")), load_robot(file)
    q, feasible = poses(robot, count)
    unchecked = set(map(frozenset, robot.unchecked))
    looked_at = {p: gap for p, gap in gaps(table, q).items() if p not in unchecked}
    kept = brute_force.kept(table, STILL, in_units(table, q))
    everything = {"boundaries": kept} | {" | ".join(sorted(p)): x for p, x in looked_at.items()}
    names, rows = list(everything), np.array([*everything.values()])
    least, rounding = rows.min(axis=0), ROUNDING * brute_force.reach(table)
    wrong = np.flatnonzero(feasible & (least < -rounding))
    said = [(q[k].tolist(), names[rows[:, k].argmin()], float(least[k])) for k in wrong]
    lost = int((~feasible & (kept > rounding)).sum())
    pairs = len(robot.used) if not looked_at else len(looked_at)
    nearest = float(least[feasible].min(initial=np.inf))
    return Found(pairs, len(unchecked), int(feasible.sum()), nearest, said, lost)


def gaps(table: dict[str, Any], q: Floats) -> dict[frozenset[str], Floats]:
    """Return the distance of every two bodies of different frames, negative where they meet."""
    alone = table | {"collisions": "all", "allowed": [], "boundary": [], "clearance": 0}
    at = in_units(table, q)
    return {
        frozenset(row["bodies"]): brute_force.of_bodies(alone, row, at)
        for row in brute_force.boundaries(alone)
    }


def in_units(table: dict[str, Any], q: Floats) -> Floats:
    """Return joint values in the units of a file."""
    turns = np.array([row["type"] != "prismatic" for row in table["joint"]])
    return np.where(turns & (table["angle_unit"] == "deg"), np.degrees(q), q)


def judged_urdf(file: Path, count: int, **options: Any) -> Found:
    """Judge an imported arm by the shapes of its links: all that move and are not left out."""
    robot = import_urdf(file, **options).robot
    judge = UrdfJudge(file)
    q, feasible = poses(robot, count)
    unchecked = set(map(frozenset, robot.unchecked))
    looked_at = [p for p in judge.moving if p not in unchecked and not p & set(robot.left_out)]
    values = {joint.name: x for joint, x in zip(robot.joints, q[feasible].T, strict=True)}
    least, wrong = np.inf, []
    for at, gaps in zip(q[feasible], judge.gaps(values, looked_at), strict=False):
        pair = min(gaps, key=gaps.__getitem__)
        least = min(least, gaps[pair])
        if gaps[pair] < -DEEP:
            wrong.append((at.tolist(), " | ".join(sorted(pair)), gaps[pair]))
    refused = {joint.name: x for joint, x in zip(robot.joints, q[~feasible].T, strict=True)}
    lost = sum(min(gaps.values()) > DEEP for gaps in judge.gaps(refused, looked_at))
    return Found(len(looked_at), len(unchecked), int(feasible.sum()), least, wrong, lost)
