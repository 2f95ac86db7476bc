"""Random chains for the property tests, and their kinematics by 4 x 4 matrices."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from qbound import HalfSpace, HarmonicForm, Joint, Pair, Point, Robot

NUMBERS = st.integers(-300, 300).map(lambda k: k / 100)
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS).map(np.array)
ANGLES = st.integers(-314, 314).map(lambda k: k / 100)
DIRECTIONS = VECTORS.filter(lambda v: np.linalg.norm(v) > 0.1)
KINDS = st.sampled_from(["revolute", "prismatic"])
ROTATIONS = st.tuples(ANGLES, ANGLES, ANGLES).map(
    lambda angles: Rotation.from_euler("zyx", angles).as_matrix()
)


@st.composite
def robots(draw):
    """A chain in space of one to three joints with a point on every link and on the base."""
    n = draw(st.integers(1, 3))
    joints = tuple(
        Joint(
            name=f"q{k + 1}",
            parent=str(k),
            frame=str(k + 1),
            origin=draw(VECTORS),
            axis=draw(DIRECTIONS),
            kind=draw(KINDS),
            mount=draw(ROTATIONS),
        )
        for k in range(n)
    )
    points = tuple(Point(f"p{k}", str(k), draw(VECTORS)) for k in range(n + 1))
    boundaries = (
        Pair("B1", ("p0", f"p{n}"), 0.3),
        Pair("B2", (f"p{n}", f"p{n - 1}"), 0.2),
        HalfSpace("B3", f"p{n}", draw(DIRECTIONS), draw(NUMBERS)),
    )
    return Robot("chain", "cm", joints, points, boundaries, f"p{n}", (0.0,) * n)


def configurations(robot, many=False):
    """Joint values of a robot, shape (n,) or (3, n)."""
    one = st.lists(ANGLES, min_size=len(robot.joints), max_size=len(robot.joints))
    return st.lists(one, min_size=3, max_size=3).map(np.array) if many else one.map(np.array)


@st.composite
def forms(draw, n=None, stack=()):
    """A harmonic form of one to three joints, or of n."""
    n = draw(st.integers(1, 3)) if n is None else n
    kinds = tuple(draw(KINDS) for _ in range(n))
    size = int(np.prod(stack, dtype=int)) * 3**n
    values = draw(st.lists(NUMBERS, min_size=size, max_size=size))
    return HarmonicForm(np.reshape(values, stack + (3,) * n), kinds)


def matrix(rotation, origin):
    """Return the 4 x 4 matrix of a rotation and a translation."""
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = rotation, origin
    return found


def pose(robot, frame, q):
    """Return the 4 x 4 matrix of a frame, seen from the base: a product along the chain."""
    found = np.eye(4)
    for joint, value in zip(robot.joints, q, strict=True):
        if int(joint.frame) > int(frame):
            break
        found = found @ matrix(joint.mount, joint.origin)
        if joint.kind == "revolute":
            found = found @ matrix(
                Rotation.from_rotvec(value * joint.axis).as_matrix(), np.zeros(3)
            )
        else:
            found = found @ matrix(np.eye(3), value * joint.axis)
    return found


def position_of(robot, name, q):
    """Return a point, seen from the base."""
    point = robot.point(name)
    return (pose(robot, point.frame, q) @ [*point.at, 1])[:3]
