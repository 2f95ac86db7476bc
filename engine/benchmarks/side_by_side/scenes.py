"""The scenes of the comparison: a robot each, and the same random configurations for everybody."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

if (beside := str(Path(__file__).resolve().parents[1])) not in sys.path:
    sys.path.append(beside)

from bodies import among
from regions import many_boundaries

from cspace import Robot, load_robot
from cspace.model.robot import HalfSpace, Pair

SEED = 15

FILES = {"paper": "minervabot-v2", "walls": Path(__file__).resolve().parent / "walls.toml"}
"""Robot files of scenes: packaged, or beside this module."""

MAKERS = {
    **{name: lambda file=file: load_robot(file) for name, file in FILES.items()},
    "hundred": lambda: many_boundaries(100, SEED),
    "obstacles10": lambda: among(10, SEED),
    "ur5": lambda: load_robot("ur5"),
}
SMALL = 0.1
"""Radius of a ball that stands for a point at a wall: any will do, because the wall gives way."""


class Balls(NamedTuple):
    """What collision libraries need of a robot of points.

    Attributes
    ----------
    radii : dict of str to float
        Radius of the ball at each point that is in a pair or at a wall.
    pairs : list of (str, str)
        Points whose balls may not touch.
    walls : list of (str, ndarray, float)
        Point, normal and level: the ball may not touch where ``normal . x <= level``.
    """

    radii: dict[str, float]
    pairs: list[tuple[str, str]]
    walls: list[tuple[str, np.ndarray, float]]


def robot(name: str) -> Robot:
    """Return the robot of a scene; KeyError if there is no such scene."""
    return MAKERS[name]()


def ends(arm: Robot) -> np.ndarray:
    """Return the lower and upper end of every joint, shape (2, joints), rad; a turn without."""
    return np.array([joint.limits or (-np.pi, np.pi) for joint in arm.joints]).T


def configurations(name: str, count: int, seed: int = SEED) -> np.ndarray:
    """Return uniform random configurations of a scene, shape (count, joints)."""
    low, high = ends(robot(name))
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


def balls(arm: Robot) -> Balls:
    """Return balls that touch where the points of each pair are as near as they may be.

    Raises
    ------
    ValueError
        If no radii are so for all pairs.
    """
    pairs = [b for b in arm.used if isinstance(b, Pair)]
    walls = [b for b in arm.used if isinstance(b, HalfSpace)]
    names = sorted({name for pair in pairs for name in pair.points} | {w.point for w in walls})
    own = {name: arm.point(name).radius for name in names}
    touching = np.array([[float(name in pair.points) for name in names] for pair in pairs])
    wanted = np.array([arm.required_distance(pair) for pair in pairs])
    found = np.array([own[name] for name in names])
    if pairs:
        found = found + np.linalg.lstsq(touching, wanted - touching @ found)[0]
        if not np.allclose(touching @ found, wanted, rtol=0, atol=1e-12) or (found < 0).any():
            raise ValueError(f"{arm.name}: no balls stand for these pairs")
    radii = {name: float(r) or SMALL for name, r in zip(names, found, strict=True)}
    levels = [(w.point, w.normal, w.offset + own[w.point] - radii[w.point]) for w in walls]
    return Balls(radii, [pair.points for pair in pairs], levels)
