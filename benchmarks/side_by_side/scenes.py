"""The scenes of the comparison: each as a robot of qbound, and as plain numbers for its peers.

Whoever judges a scene reads the same numbers from here: a robot by name (`robot`), what a peer
needs of it in JSON (`plain`), and the same random configurations (`configurations`).
"""

from __future__ import annotations

import sys
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

if (beside := str(Path(__file__).resolve().parents[1])) not in sys.path:
    sys.path.append(beside)

from bodies import among
from regions import many_boundaries

from qbound import load_robot
from qbound.model.robot import Body, Capsule, Disc, HalfSpace, Pair, Point, Polygon, Revolute, Robot

SEED = 15
WALLS_AREA = 3.21682
"""Of the region between the two walls, rad^2, as the literature on IRIS has it by grids."""

FILES = {"paper": "minervabot-v2", "walls": Path(__file__).resolve().parent / "walls.toml"}
"""Robot files of scenes: packaged, or beside this module."""

NAMES = ("paper", "walls", "hundred", "obstacles10", "ur5")


@lru_cache(maxsize=32)
def robot(name: str) -> Robot:
    """Return the robot of a scene: one of `NAMES`, ``boundaries-30``, or ``joints-4``.

    Raises
    ------
    KeyError
        If there is no such scene.
    """
    kind, _, number = name.partition("-")
    if kind == "boundaries" and number.isdecimal():
        return boundaries(int(number))
    if kind == "joints" and number.isdecimal():
        return chain(int(number))
    makers = {
        "paper": lambda: load_robot(FILES["paper"]),
        "walls": lambda: load_robot(FILES["walls"]),
        "hundred": lambda: boundaries(100),
        "obstacles10": lambda: among(10, SEED),
        "ur5": lambda: load_robot("ur5"),
        "three": three,
    }
    return makers[name]()


def boundaries(count: int) -> Robot:
    """Return the planar arm with so many pairs and walls at random places."""
    return many_boundaries(count, SEED)


def three() -> Robot:
    """Return three turning links of 1, 0.8 and 0.5 between two posts, above a floor.

    Balls on elbow, wrist and tip keep off the posts and the floor; every joint within 2.5 rad.
    """
    axis, mount, ends = np.array([0.0, 1.0, 0.0]), np.eye(3), (-2.5, 2.5)
    frames = ("base", "upper", "fore", "hand")
    lengths = (0.0, 1.0, 0.8)
    joints = tuple(
        Revolute(f"q{i + 1}", frames[i], frames[i + 1], np.array([0.0, 0.0, z]), mount, axis, ends)
        for i, z in enumerate(lengths)
    )
    arm = (("elbow", "upper", 1.0), ("wrist", "fore", 0.8), ("tip", "hand", 0.5))
    points = [Point(name, frame, np.array([0.0, 0.0, z]), 0.1) for name, frame, z in arm]
    points += [
        Point("left post", "base", np.array([-0.9, 0.0, 0.6]), 0.25),
        Point("right post", "base", np.array([1.1, 0.0, 0.9]), 0.3),
    ]
    names = ("elbow", "wrist", "tip")
    pairs = [Pair(f"{n}, {post.name}", (post.name, n), 0.0) for n in names for post in points[3:]]
    floor = [HalfSpace(f"{n}, floor", n, np.array([0.0, 0.0, 1.0]), -0.3) for n in names]
    home, bounds = np.zeros(3), (*pairs, *floor)
    return Robot("Three links", joints, tuple(points), bounds, home, "tip", "m", "rad")


def chain(count: int) -> Robot:
    """Return a planar arm of so many equal links, 1 long in all, with a ball at the end of each.

    The balls keep off each other, but for neighbours, and off a floor below the base.
    """
    axis, mount, length = np.array([0.0, 1.0, 0.0]), np.eye(3), 1 / count
    along = np.array([0.0, 0.0, length])
    joints = tuple(
        Revolute(f"q{j + 1}", str(j), str(j + 1), along if j else np.zeros(3), mount, axis)
        for j in range(count)
    )
    points = tuple(
        Point(f"ball {j}", str(j), along if j else np.zeros(3), length / 3)
        for j in range(count + 1)
    )
    apart = tuple(
        Pair(f"{i}, {j}", (f"ball {i}", f"ball {j}"), 0.0)
        for i in range(count - 1)
        for j in range(i + 2, count + 1)
    )
    up = np.array([0.0, 0.0, 1.0])
    floor = tuple(HalfSpace(f"floor, {j}", f"ball {j}", up, -0.3) for j in range(1, count + 1))
    bounds, tool = (*apart, *floor), f"ball {count}"
    return Robot(f"{count} links", joints, points, bounds, np.zeros(count), tool, "m", "rad")


def ends(arm: Robot) -> np.ndarray:
    """Return the lower and upper end of every joint, shape (2, joints), rad; a turn without."""
    return np.array([joint.limits or (-np.pi, np.pi) for joint in arm.joints]).T


def configurations(name: str, count: int, seed: int) -> np.ndarray:
    """Return uniform random configurations of a scene, shape (count, joints)."""
    low, high = ends(robot(name))
    return np.random.default_rng(seed).uniform(low, high, (count, len(low)))


def plain(name: str) -> dict[str, Any]:
    """Return what a peer needs of a scene, in JSON: lengths, radians.

    Every pair of ``pairs`` collides where the centres are nearer than ``distance``, which is the
    sum of the radii of its two ``points``. A wall collides where ``normal . centre < level``.
    """
    arm = robot(name)
    pairs = [b for b in arm.used if isinstance(b, Pair)]
    held = [b for b in arm.used if isinstance(b, HalfSpace)]
    radii = ball_radii(arm, pairs)
    low, high = ends(arm)
    return {
        "scene": name,
        "unit": arm.length_unit,
        "base": arm.base,
        "tool": arm.tool,
        "home": arm.home.tolist(),
        "joints": [
            {
                "name": joint.name,
                "type": joint.type_name,
                "parent": joint.parent,
                "frame": joint.frame,
                "origin": joint.origin.tolist(),
                "mount": np.asarray(joint.mount).tolist(),
                "axis": joint.axis.tolist(),
                "low": float(low[j]),
                "high": float(high[j]),
                "limited": joint.limits is not None,
            }
            for j, joint in enumerate(arm.joints)
        ],
        "points": [
            {
                "name": point.name,
                "frame": point.frame,
                "at": point.at.tolist(),
                "radius": radii.get(point.name, point.radius),
            }
            for point in arm.points
        ],
        "pairs": [
            {"name": b.name, "points": list(b.points), "distance": arm.required_distance(b)}
            for b in pairs
        ],
        "walls": [
            {
                "name": b.name,
                "point": b.point,
                "normal": b.normal.tolist(),
                "level": b.offset + arm.point(b.point).radius,
            }
            for b in held
        ],
        "bodies": [solid(body) for body in arm.bodies] if arm.collisions else [],
        "obstacles": [solid(body) for body in arm.obstacles],
        "allowed": [sorted(names) for names in arm.allowed],
    }


def ball_radii(arm: Robot, pairs: list[Pair]) -> dict[str, float]:
    """Return radii of balls that touch where the points of each pair are as near as they may be.

    Raises
    ------
    ValueError
        If no radii are so for all pairs.
    """
    names = sorted({name for pair in pairs for name in pair.points})
    place = {name: i for i, name in enumerate(names)}
    told = np.zeros((len(pairs), len(names)))
    for row, pair in zip(told, pairs, strict=True):
        row[[place[name] for name in pair.points]] = 1
    wanted = np.array([arm.required_distance(pair) for pair in pairs])
    own = np.array([arm.point(name).radius for name in names])
    radii = own + np.linalg.lstsq(told, wanted - told @ own)[0] if pairs else own
    if not np.allclose(told @ radii, wanted, rtol=0, atol=1e-12) or (radii < 0).any():
        raise ValueError(f"{arm.name}: no balls stand for these pairs")
    return dict(zip(names, radii.tolist(), strict=True))


def solid(body: Body) -> dict[str, Any]:
    """Return a body or an obstacle in JSON: a capsule, a disc or a polygon in its frame."""
    shape, about = body.shape, {"name": body.name, "frame": body.frame}
    if isinstance(shape, Capsule):
        return about | {
            "capsule": np.stack([shape.start, shape.end]).tolist(),
            "radius": shape.radius,
        }
    if isinstance(shape, Disc):
        return about | {"disc": shape.at.tolist(), "radius": shape.radius}
    if isinstance(shape, Polygon):
        return about | {"polygon": np.asarray(shape.corners).tolist()}
    raise ValueError(f"{body.name}: no plain form of a {type(shape).__name__}")
