"""Random arms of balls in space: any joints, pairs and walls, as an imported arm is made."""

from dataclasses import replace
from itertools import combinations
from math import pi

import numpy as np

from cspace.model.robot import (
    JOINT_TYPES,
    HalfSpace,
    Joint,
    Pair,
    Parallelogram,
    Point,
    Prismatic,
    Revolute,
    Robot,
)
from engine_support.arms import in_metres
from qbound.frames import roll_pitch_yaw

REVOLUTE, PRISMATIC = "revolute", "prismatic"
LIMITS = {REVOLUTE: (None, (-2.0, 2.5), (-2 * pi, 2 * pi), (0.3, 9.0)), PRISMATIC: ((-0.4, 0.5),)}


def arm_of_balls(seed: int, joints: int | None = None) -> Robot:
    """One to six joints of either kind, two balls a link, a pair of every two links, two walls."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 7)) if joints is None else joints
    kinds = rng.choice([REVOLUTE, PRISMATIC], count, p=[0.7, 0.3])
    chain = tuple(random_joint(rng, j, kind) for j, kind in enumerate(kinds))
    points = [
        Point(f"{k}/{i}", str(k), rng.normal(0, 0.3, 3), rng.uniform(0.02, 0.12))
        for k in range(count + 1)
        for i in (1, 2)
    ]
    pairs = [
        Pair(f"{one.name}, {other.name}", (one.name, other.name), rng.choice([0.0, 0.03]))
        for one, other in combinations(rng.permutation(points), 2)
        if one.frame != other.frame
    ]
    walls = [random_wall(rng, i, points[int(rng.integers(0, len(points)))]) for i in range(2)]
    home = [0.3 if joint.turns else 0.1 for joint in chain]
    boundaries = (*pairs[::2], *walls, *pairs[1::2])
    return in_metres(f"arm {seed}", chain, points, boundaries, home, f"{count}/1")


def random_joint(rng: np.random.Generator, j: int, kind: str) -> Joint:
    axis = rng.normal(size=3) if rng.random() < 0.5 else rng.permutation([0.0, 0.0, 1.0])
    choice = LIMITS[kind]
    return JOINT_TYPES[kind](
        name=f"q{j + 1}",
        parent=str(j),
        frame=str(j + 1),
        origin=rng.normal(0, 0.4, 3),
        mount=roll_pitch_yaw(*rng.uniform(-pi, pi, 3)),
        axis=axis / np.linalg.norm(axis),
        limits=choice[int(rng.integers(0, len(choice)))],
    )


def random_wall(rng: np.random.Generator, i: int, point: Point) -> HalfSpace:
    normal = rng.normal(size=3)
    return HalfSpace(f"wall {i}", point.name, normal / np.linalg.norm(normal), -1.5)


def parallelogram_arm(seed: int, last: type = Revolute) -> Robot:
    """A turn, a parallelogram and another joint in space, a ball in every frame, all pairs."""
    rng = np.random.default_rng([520, seed])

    def unit():
        vector = rng.normal(size=3)
        return vector / np.linalg.norm(vector)

    turns = [roll_pitch_yaw(*rng.uniform(-3, 3, 3)) for _ in range(3)]
    joints = (
        Revolute("a", "0", "1", origin=unit(), mount=turns[0], axis=unit()),
        Parallelogram(
            "p",
            "1",
            "2",
            origin=unit(),
            mount=turns[1],
            axis=unit(),
            limits=(-2, 2),
            velocity=None,
            crank=unit(),
            bar="bar",
        ),
        last("c", "2", "3", origin=unit(), mount=turns[2], axis=unit(), limits=(-1, 1)),
    )
    points = tuple(Point(f"p{frame}", frame, unit(), 0.01) for frame in ("0", "1", "bar", "2", "3"))
    pairs = [
        Pair(f"{one.name}, {other.name}", (one.name, other.name))
        for one, other in combinations(points, 2)
    ]
    return in_metres("r", joints, points, pairs, np.zeros(3), "p3")


def with_parallelogram(seed: int) -> Robot:
    """A turn, a parallelogram and a turn or a slide; all pairs, and a wall for every ball."""
    robot = parallelogram_arm(seed, (Revolute, Prismatic)[seed % 2])
    rng = np.random.default_rng([600, seed])
    normals = rng.normal(size=(len(robot.points), 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    walls = (
        HalfSpace(f"wall {p.name}", p.name, n, -2.0)
        for p, n in zip(robot.points, normals, strict=True)
    )
    radii = (replace(point, radius=0.3) for point in robot.points)
    return replace(robot, points=tuple(radii), boundaries=(*robot.boundaries, *walls))


def drawn(robot: Robot, n: int, seed: int = 3) -> np.ndarray:
    """Configurations within the limits, or within a turn."""
    ends = np.array([joint.limits or (-pi, pi) for joint in robot.joints])
    return np.random.default_rng(seed).uniform(*ends.T, size=(n, len(ends)))
