"""The plane in which an arm moves: its axes, and the parts of the robot that leave it.

An arm is planar if the axes of all turning joints are parallel and every slide runs at right
angles to them. A turn about such an axis keeps the direction of the axis. So a property of
directions that holds at all joint values 0 holds at every configuration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Array, cross
from cspace.model.joints import Joint, Step
from cspace.model.schema import one_line
from cspace.order import first_largest
from cspace.tolerances import ZERO_AMPLITUDE
from qbound.frames import Frames

COORDINATES = {0: (1, 2), 1: (0, 2), 2: (0, 1)}
"""The two coordinates of a plane by that of its normal: (y, z), (x, z), (x, y)."""


@dataclass(frozen=True, eq=False)
class PlaneOfMotion:
    """The plane in which a planar arm moves, seen from the base.

    Attributes
    ----------
    across : ndarray, shape (2, 3)
        Its axes, orthonormal: ``across @ r`` are the plane coordinates of a vector of the base;
        (x, z) for a normal along y, (x, y) for z, (y, z) for x.
    normal : ndarray, shape (3,)
        Unit vector, its largest coordinate positive; not always ``cross(*across)``, which is -y
        for the plane of x and z.
    senses : tuple of int
        For each step of the chain: +1 if the joint's value turns the frame from the first axis to
        the second, -1 if back, 0 for a slide.
    frames : Frames
        At all joint values 0.
    chosen : bool
        Whether the joints do not determine the plane, because all slide along one line.
    """

    across: Array
    normal: Array
    senses: tuple[int, ...]
    frames: Frames
    chosen: bool = False

    @property
    def name(self) -> str:
        """The plane in words: by the axes of the base that span it, or by its normal."""
        k = first_largest(np.abs(self.normal))
        if abs(self.normal[k]) < 1 - ZERO_AMPLITUDE:
            return f"the plane at right angles to {self.normal.round(6).tolist()}"
        one, other = ("xyz"[i] for i in COORDINATES[k])
        return f"the plane of {one} and {other}"

    def flat(self, frame: str, corners: ArrayLike) -> Array:
        """Return places of a frame, shape (m, 3), in the plane's axes, shape (m, 2).

        The places are seen from the frame's origin and turned as at all joint values 0. At joint
        values q the pose of the frame is a turn by the sum of ``senses * q`` over the steps before
        it, and a translation.
        """
        rotation = np.asarray(self.frames.rotation(self.frames.base, frame), dtype=float)
        return np.asarray(np.asarray(corners, dtype=float) @ (self.across @ rotation).T)

    def height(self, frame: str, corners: ArrayLike) -> Array:
        """Return how far places of a frame are above the base's origin, along the normal; (m,)."""
        base = self.frames.base
        rotation = np.asarray(self.frames.rotation(base, frame), dtype=float)
        places = np.asarray(corners, dtype=float) @ rotation.T
        return np.asarray((places + self.frames.position(base, frame, base)) @ self.normal)

    def normal_seen_from(self, frame: str) -> Array:
        """Return the normal seen from a frame, shape (3,): at every configuration the same."""
        rotation = np.asarray(self.frames.rotation(self.frames.base, frame), dtype=float)
        return np.asarray(self.normal @ rotation)

    def flat_coordinate(self, frame: str) -> int | None:
        """Return the coordinate of a frame, 0, 1 or 2, that is at right angles to the plane.

        None if the normal is not along an axis of the frame.
        """
        normal = np.abs(self.normal_seen_from(frame))
        second = sorted(normal.tolist())[1]
        return int(np.argmax(normal)) if second <= ZERO_AMPLITUDE else None


class Moving(Protocol):
    """The interface of a robot that `plane_of_motion` needs."""

    @property
    def joints(self) -> tuple[Joint, ...]:
        """Its joints, from the base outwards."""

    @property
    def base(self) -> str:
        """Label of the base frame."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """The motions of its chain, from the base outwards."""

    def frames(self, q: ArrayLike) -> Frames:
        """Return its frames at joint values."""


def plane_of_motion(robot: Moving) -> PlaneOfMotion:
    """Return the plane in which a robot moves.

    If all joints slide along one line, the plane is the first of these that holds the line: x and
    z, x and y, y and z, any other plane.

    Raises
    ------
    ValueError
        If the robot is not planar; the message names the joint that leaves the plane.

    Examples
    --------
    >>> from cspace import load_robot
    >>> plane = load_robot("minervabot-v2").plane
    >>> plane.across.tolist(), plane.senses
    ([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], (-1, -1))
    """
    frames = robot.frames(np.zeros(len(robot.joints)))
    mounts = [frames.rotation(robot.base, j.parent) @ j.mount for j in robot.joints]
    axes = [np.asarray(m @ j.axis, dtype=float) for m, j in zip(mounts, robot.joints, strict=True)]
    normal = _normal(robot.joints, axes)
    for joint, axis in zip(robot.joints, axes, strict=True):
        if joint.turns and np.linalg.norm(cross(axis, normal)) > ZERO_AMPLITUDE:
            fault = "turns about an axis that is not parallel to the others'"
        elif not joint.turns and abs(axis @ normal) > ZERO_AMPLITUDE:
            fault = "slides out of the plane in which the others move"
        else:
            continue
        text = f"joint {one_line(repr(joint.name))} {fault}: there is no plane of motion"
        raise ValueError(text)
    across = _across(normal)
    over = cross(*across)
    ways = [round(float(a @ over)) * j.turns for a, j in zip(axes, robot.joints, strict=True)]
    senses = [ways[step.joint] * step.sense for step in robot.steps]
    along = [np.linalg.norm(cross(axes[0], axis)) <= ZERO_AMPLITUDE for axis in axes]
    chosen = all(along) and not any(joint.turns for joint in robot.joints)
    return PlaneOfMotion(across, normal, tuple(senses), frames, chosen)


def _normal(joints: Sequence[Joint], axes: Sequence[Array]) -> Array:
    """Return the normal that the first deciding joint gives, its largest coordinate positive."""
    turning = [axis for axis, joint in zip(axes, joints, strict=True) if joint.turns]
    candidates = [*turning, *(cross(axes[0], axis) for axis in axes[1:])]
    candidates += [axis for axis in np.eye(3)[[1, 2, 0]] if abs(axis @ axes[0]) <= ZERO_AMPLITUDE]
    candidates.append(cross(axes[0], np.eye(3)[first_largest(1 - np.abs(axes[0]))]))
    normal = next(axis for axis in candidates if np.linalg.norm(axis) > ZERO_AMPLITUDE)
    normal = normal / np.linalg.norm(normal)
    largest = normal[first_largest(np.abs(normal))]
    return np.asarray(normal * np.sign(largest) + 0.0)


def _across(normal: Array) -> Array:
    """Return the plane's axes, shape (2, 3): those of the base if the normal is one of them."""
    one, other = COORDINATES[first_largest(np.abs(normal))]
    first = np.eye(3)[one] - normal[one] * normal
    first /= np.linalg.norm(first)
    second = cross(normal, first)
    second *= np.sign(second[other])
    return np.array([first, second]) + 0.0
