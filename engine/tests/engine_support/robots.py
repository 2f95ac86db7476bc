"""Planar robots of two joints, at random or in whole numbers, and the same robot otherwise."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import pi

import numpy as np

from cspace import load_robot, packaged_robots
from cspace.model.robot import JOINT_TYPES, BodyPair, HalfSpace, Joint, Pair, Point, Robot
from engine_support.arms import in_metres
from engine_support.forms import PP, PR, RP, RR, TURN

OF_POINTS = [
    name
    for name in packaged_robots()
    if len((robot := load_robot(name)).joints) == 2
    and not any(isinstance(boundary, BodyPair) for boundary in robot.used)
]
"""Packaged robots of two joints whose every boundary has one form."""


def random_robot(seed: int) -> Robot:
    """A planar chain of two joints, eight points, up to four pairs and three walls."""
    rng = np.random.default_rng(seed)
    kinds = (RR, RP, PR, PP)[seed % 4]
    points = [Point(f"p{i}", str(rng.integers(0, 3)), in_plane(rng)) for i in range(8)]
    joints = tuple(random_joint(rng, j, kind) for j, kind in enumerate(kinds))
    boundaries = [random_pair(rng, i, points) for i in range(rng.integers(0, 5))]
    boundaries += [random_wall(rng, i, points) for i in range(rng.integers(0, 4))]
    home = [rng.uniform(*(joint.limits or (-pi, pi))) for joint in joints]
    return in_metres("r", joints, points, boundaries, home, "p0")


def in_plane(rng) -> np.ndarray:
    x, z = rng.uniform(-2, 2, 2)
    return np.array([x, 0, z])


def random_joint(rng, j: int, kind: str) -> Joint:
    angle = rng.uniform(0, TURN)
    low, high = np.sort(rng.uniform(-4, 4, 2)) + np.array([-0.3, 0.3])
    limits = None if kind == "revolute" and rng.random() < 0.6 else (low, high)
    slide = np.array([np.cos(angle), 0, np.sin(angle)])
    axis = np.array([0.0, 1, 0]) if kind == "revolute" else slide
    place = f"q{j + 1}", str(j), str(j + 1), in_plane(rng)
    return JOINT_TYPES[kind](*place, axis, limits=limits)


def random_pair(rng, i: int, points: list[Point]) -> Pair:
    one = points[rng.integers(0, 8)]
    others = [p for p in points if p.frame != one.frame] or [Point("p0", "0", np.zeros(3))]
    other = others[rng.integers(0, len(others))]
    return Pair(f"B{i}", (one.name, other.name), rng.uniform(0.2, 1.5))


def random_wall(rng, i: int, points: list[Point]) -> HalfSpace:
    angle = rng.uniform(0, TURN)
    normal = np.array([np.cos(angle), 0, np.sin(angle)])
    return HalfSpace(f"W{i}", points[rng.integers(0, 8)].name, normal, rng.uniform(-3, 1))


def drawn_robot(seed: int) -> Robot:
    """A robot as an engineer draws it: small whole numbers, points in line, walls along the axes.

    Here curves touch, coincide, are parallel and meet three at a time.
    """
    rng = np.random.default_rng(seed)
    kinds, whole = (RR, RP, PR, PP)[seed % 4], partial(rng.integers, endpoint=True)
    places = [np.array([whole(-2, 2), 0.0, whole(-2, 2) * rng.integers(0, 2)]) for _ in range(8)]
    points = [Point(f"p{i}", str(rng.integers(0, 3)), place) for i, place in enumerate(places)]
    joints = tuple(drawn_joint(rng, j, kind) for j, kind in enumerate(kinds))
    pairs = [random_pair(rng, i, points) for i in range(rng.integers(0, 5))]
    pairs = [replace(pair, clearance=whole(1, 4) / 2) for pair in pairs]
    axes = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 0, 1], [0, 0, -1]])
    walls = [
        HalfSpace(f"W{i}", f"p{rng.integers(0, 8)}", axes[rng.integers(0, 4)], float(whole(-4, 0)))
        for i in range(rng.integers(0, 4))
    ]
    home = [rng.uniform(*(joint.limits or (-pi, pi))) for joint in joints]
    return in_metres("d", joints, points, (*pairs, *walls), home, "p0")


def drawn_joint(rng, j: int, kind: str) -> Joint:
    limits = (-pi / 2, pi / 2) if kind == "revolute" else (-2.0, 2.0)
    if kind == "revolute" and rng.random() < 0.6:
        limits = None
    axis = [0.0, 1, 0] if kind == "revolute" else [[1.0, 0, 0], [0, 0, 1.0]][rng.integers(0, 2)]
    origin = np.array([rng.integers(0, 3), 0.0, rng.integers(0, 2)])
    place = f"q{j + 1}", str(j), str(j + 1), origin
    return JOINT_TYPES[kind](*place, np.array(axis), limits=limits)


# --- the same robot, otherwise -------------------------------------------------------------------

FLIP = np.array([-1.0, 1, 1])


def mirror(robot: Robot) -> Robot:
    """Send x to -x: turns change their sense, slides their axis."""
    points = tuple(replace(p, at=p.at * FLIP) for p in robot.points)
    walls = tuple(
        replace(b, normal=b.normal * FLIP) if isinstance(b, HalfSpace) else b
        for b in robot.boundaries
    )
    joints = tuple(mirrored(joint) for joint in robot.joints)
    return replace(robot, joints=joints, points=points, boundaries=walls)


def mirrored(joint: Joint) -> Joint:
    moved = replace(joint, origin=joint.origin * FLIP)
    if joint.kind == "prismatic":
        return replace(moved, axis=joint.axis * FLIP)
    limits = joint.limits and (-joint.limits[1], -joint.limits[0])
    return replace(moved, limits=limits)


def in_centimetres(robot: Robot) -> Robot:
    points = tuple(replace(p, at=100 * p.at) for p in robot.points)
    boundaries = tuple(
        replace(b, offset=100 * b.offset)
        if isinstance(b, HalfSpace)
        else replace(b, clearance=100 * b.clearance)
        for b in robot.boundaries
    )
    joints = tuple(longer(joint) for joint in robot.joints)
    return replace(robot, joints=joints, points=points, boundaries=boundaries)


def longer(joint: Joint) -> Joint:
    moved = replace(joint, origin=100 * joint.origin)
    if joint.kind == "revolute" or joint.limits is None:
        return moved
    return replace(moved, limits=(100 * joint.limits[0], 100 * joint.limits[1]))


def turned(robot: Robot, j: int, angle: float) -> Robot:
    """Mount joint j turned by an angle about its own axis: what was q is now q - angle."""
    c, s = np.cos(angle), np.sin(angle)
    joint = replace(robot.joints[j], mount=np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]))
    if joint.limits:
        joint = replace(joint, limits=(joint.limits[0] - angle, joint.limits[1] - angle))
    return replace(robot, joints=(*robot.joints[:j], joint, *robot.joints[j + 1 :]))


def as_long_as_turned(robot: Robot, j: int, angle: float) -> Robot:
    """Mount joint j as it is, but as much too long or short as `turned` mounts it by rounding.

    Doubles count as exact numbers: whether what touches still touches hangs on cos^2 + sin^2 - 1.
    """
    length = Fraction(np.cos(angle)) ** 2 + Fraction(np.sin(angle)) ** 2
    rounding = float(np.sign(length - 1)) * np.finfo(float).eps
    joint = replace(robot.joints[j], mount=robot.joints[j].mount * (1 + rounding))
    return replace(robot, joints=(*robot.joints[:j], joint, *robot.joints[j + 1 :]))


def kept_by_kinematics(robot: Robot, q: np.ndarray) -> dict[str, np.ndarray]:
    """Distances of the points of boundaries in use, less what is to be kept."""
    frames, found = robot.frames(q), {}
    for b in robot.used:
        names = (b.point,) if isinstance(b, HalfSpace) else b.points
        places = [frames.position(robot.base, p, robot.base) for p in names]
        radii = sum(robot.point(p).radius for p in names)
        if isinstance(b, HalfSpace):
            found[b.name] = places[0] @ b.normal - b.offset - radii
        else:
            apart = np.linalg.norm(places[1] - places[0], axis=-1)
            found[b.name] = apart - radii - b.clearance
    return found
