"""The points that the tool reaches: postures, the stretched pose, and the geometric workspace.

For arms of two joints that turn about y. In polar coordinates about joint 1 the second joint alone
decides the tool's distance, and the first joint turns the tool round. A point at a given distance
is reached with two values of q2, one on each side of the stretched pose: two postures (branches of
the inverse kinematics). The paper has no formula for the workspace. It draws the tool's paths in
the plane (Figures 7 to 10), and samples (Figure 11).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from qbound.arrays import Bools, Floats, Ints
from qbound.boundary import position, squared_distance
from qbound.circle import TURN, circle_roots, first_from, nearest_turn
from qbound.forms import HarmonicForm
from qbound.frames import IDENTITY
from qbound.quadrature import Integral, integral
from qbound.region import Region
from qbound.robot import Robot

PLANE = [0, 2]
"""Indices of x and z, the plane of the arm, in a position (x, y, z)."""


@dataclass(frozen=True, eq=False)
class PlanarArm:
    """The tool of an arm with two joints that turn about y, in polar coordinates about joint 1.

    Attributes
    ----------
    robot : Robot
    tool : HarmonicForm, stack (3,)
        Position of the tool, seen from the base.
    stretched : float
        Value of the second joint at which the tool is farthest from joint 1, rad: joint 1, joint 2
        and the tool are in line, a singular pose. (The folded pose, half a turn on, is the other
        one.)
    mean, swing : float
        The squared distance of the tool from the axis of joint 1 is
        ``mean + swing cos(q2 - stretched)``, a length squared.
    """

    robot: Robot = field(repr=False)
    tool: HarmonicForm = field(repr=False)
    stretched: float
    mean: float
    swing: float

    def direction(self, q2: ArrayLike) -> Floats:
        """Return the angle from z towards x at which joint 1 sees the tool at q1 = 0, rad.

        The tool is seen at ``q1 + direction(q2)``, because joint 1 turns from z towards x.

        Examples
        --------
        Stretched at q1 = 0, the arm of the paper leans 30° from upright:

        >>> from qbound import load_robot, planar_arm
        >>> arm = planar_arm(load_robot("minervabot-v2"))
        >>> round(float(np.degrees(arm.direction(arm.stretched))), 2)
        30.0
        """
        q2 = np.asarray(q2, dtype=float)
        seen = self.tool(np.stack([0 * q2, q2], axis=-1)) - self.robot.joints[0].origin
        return np.asarray(np.arctan2(seen[..., 0], seen[..., 2]))

    def reach(self, q: ArrayLike) -> Floats:
        """Return the distance of the tool from the axis of joint 1.

        Parameters
        ----------
        q : array_like, shape (..., 2)
            Joint values, rad.

        Returns
        -------
        ndarray, shape (...)

        Examples
        --------
        >>> from qbound import load_robot, planar_arm
        >>> arm = planar_arm(load_robot("minervabot-v2"))
        >>> round(float(arm.reach([0.3, arm.stretched])), 4)
        54.9993
        """
        seen = self.tool(q) - self.robot.joints[0].origin
        return np.asarray(np.hypot(seen[..., 0], seen[..., 2]))

    def postures(self, point: ArrayLike) -> Floats:
        r"""Return every configuration that brings the tool to (x, z): inverse kinematics.

        The distance r from joint 1 gives q2 by Theorem 2,
        :math:`swing \cos(q_2 - stretched) = r^2 - mean`; the direction then gives q1. Boundaries
        are not asked.

        Parameters
        ----------
        point : array_like, shape (2,)
            x and z, seen from the base.

        Returns
        -------
        ndarray, shape (k, 2)
            Joint values, rad in (-pi, pi]; k is 0, 1 or 2.

        Raises
        ------
        ValueError
            If the point is on the axis of joint 1 and the folded tool is there, for any q1.

        Examples
        --------
        The point of the tool at home is reached in a second posture:

        >>> from qbound import load_robot, planar_arm
        >>> arm = planar_arm(load_robot("minervabot-v2"))
        >>> np.degrees(arm.postures([40.0, 48.48])[0]).round(6).tolist()
        [53.991097, -119.998544]
        """
        x, z = np.asarray(point, dtype=float) - self.robot.joints[0].origin[PLANE]
        roots = circle_roots(self.swing, 0.0, x * x + z * z - self.mean)
        if roots.count <= 0:
            return np.empty((0, 2))
        if x * x + z * z <= 1e-24 * self.swing:
            raise ValueError("the point is on the axis of joint 1: any q1 brings the tool there")
        q2 = self.stretched + np.unique(roots.q)
        q1 = np.arctan2(x, z) - self.direction(q2)
        return nearest_turn(np.stack([q1, q2], axis=-1), 0.0)

    def other_posture(self, q: ArrayLike) -> Floats:
        """Return the configurations with the tool at the same points in the other posture.

        The second joint is mirrored at the stretched pose; shape (..., 2) to (..., 2), rad.

        Examples
        --------
        >>> from qbound import load_robot, planar_arm
        >>> arm = planar_arm(load_robot("minervabot-v2"))
        >>> np.degrees(arm.other_posture([0.0, 0.0])).round(6).tolist()
        [53.991097, -119.998544]
        """
        q1, q2 = np.moveaxis(np.asarray(q, dtype=float), -1, 0)
        mirrored = 2 * self.stretched - q2
        q1 = q1 + self.direction(q2) - self.direction(mirrored)
        return nearest_turn(np.stack([q1, mirrored], axis=-1), 0.0)

    def singular(self, q: ArrayLike) -> Bools:
        """Tell where the Jacobian of the tool in its plane has no inverse: the links are in line.

        The links are stretched or folded then. A determinant below 1e-9 of `swing` counts as zero.

        Parameters
        ----------
        q : array_like, shape (..., 2)
            Joint values, rad.

        Returns
        -------
        ndarray of bool, shape (...)

        Examples
        --------
        >>> from qbound import load_robot, planar_arm
        >>> arm = planar_arm(load_robot("minervabot-v2"))
        >>> arm.singular([[0.3, arm.stretched], [0.3, 0.0]]).tolist()
        [True, False]
        """
        determinant = np.linalg.det(self.tool.gradient(q)[..., PLANE, :])
        return np.asarray(np.abs(determinant) <= 1e-9 * self.swing)


def planar_arm(robot: Robot) -> PlanarArm:
    """Return the tool of an arm in polar coordinates about joint 1.

    Raises
    ------
    ValueError
        If the arm does not have two joints that turn about y.

    Examples
    --------
    The second joint of the paper's robot is at -60° when the arm is stretched:

    >>> from qbound import load_robot, planar_arm
    >>> round(float(np.degrees(planar_arm(load_robot("minervabot-v2")).stretched)), 4)
    -59.9993
    """
    turns_about_y = [
        joint.turns and np.array_equal([joint.axis, *joint.mount], [[0, 1, 0], *IDENTITY])
        for joint in robot.joints
    ]
    if turns_about_y != [True, True]:
        raise ValueError(
            f"{robot.name} does not have two joints that turn about y; cspace handles the "
            "workspaces of other planar arms"
        )
    hinge = robot.joints[0].frame
    mean, a, b = squared_distance(robot, robot.tool, hinge).along(1, robot.home)
    along_axis = position(robot, observer=hinge)(robot.home)[1]  # y of the tool never changes
    stretched, swing = float(np.arctan2(b, a)), float(np.hypot(a, b))
    return PlanarArm(robot, position(robot), stretched, float(mean - along_axis**2), swing)


@dataclass(frozen=True, eq=False)
class Arcs:
    """Circles about joint 1, cut into arcs.

    Attributes
    ----------
    start, end : ndarray, shape (m, k)
        Directions from joint 1, from z towards x, rad.
    postures : ndarray of int, shape (m, k)
        The number of postures in which the tool reaches an arc: 0, 1 or 2.
    """

    start: Floats
    end: Floats
    postures: Ints

    def length(self, postures: int) -> Floats:
        """Return the angle of each circle reached in at least so many postures, shape (m,), rad."""
        reached = self.postures >= postures
        return np.asarray(((self.end - self.start) * reached).sum(axis=-1))


@dataclass(frozen=True, eq=False)
class Workspace:
    """The points that the tool reaches from a region of joint values: the geometric workspace.

    On a circle about joint 1, q2 has one value in each posture. There the tool reaches arcs: the
    pieces of the region's fibre along q1, turned by the direction of the tool. The lengths of these
    arcs are integrated over the circles.

    Raises
    ------
    ValueError
        From its properties, if the arm does not have two joints that turn about y.

    Examples
    --------
    In cm², the area reached, and the part of it that is reached in both postures:

    >>> from qbound import Workspace, load_robot, window_region
    >>> reached = Workspace(window_region(load_robot("minervabot-v2")))
    >>> round(reached.area, 4), round(reached.covered_twice, 4)
    (3395.3704, 2465.0351)
    """

    region: Region

    @cached_property
    def arm(self) -> PlanarArm:
        """The tool in polar coordinates, with the errors of `planar_arm`."""
        return planar_arm(self.region.robot)

    @property
    def area(self) -> float:
        """Area of all points reached; length squared."""
        return float(self._areas.value[0])

    @property
    def area_error(self) -> float:
        """Bound of the numerical error of `area`."""
        return float(self._areas.error[0])

    @property
    def covered_twice(self) -> float:
        """Area of the points reached in both postures; length squared."""
        return float(self._areas.value[1])

    @property
    def covered_twice_error(self) -> float:
        """Bound of the numerical error of `covered_twice`."""
        return float(self._areas.error[1])

    @cached_property
    def _areas(self) -> Integral:
        """Integrals of r times the arcs' angle over r, of one posture or more and of both.

        The variable is the bend, the absolute value of q2 - stretched, from 0 to pi: with
        r² = mean + swing cos(bend), r dr is -swing sin(bend) / 2 times the change of the bend.
        """

        def of_circles(bend: Floats) -> Floats:
            arcs = self.arcs(bend)
            lengths = np.stack([arcs.length(1), arcs.length(2)], axis=-1)
            return np.asarray(self.arm.swing / 2 * np.sin(bend)[:, None] * lengths)

        return integral(of_circles, 0.0, np.pi)

    def arcs(self, bend: ArrayLike) -> Arcs:
        """Cut the circles of the tool, one for each bend, where a posture begins or ends.

        Parameters
        ----------
        bend : array_like, shape (m,)
            Absolute value of q2 - stretched, rad in [0, pi].

        Examples
        --------
        Of the circle on which the tool is at home, 207° are reached:

        >>> from qbound import Workspace, load_robot, window_region
        >>> reached = Workspace(window_region(load_robot("minervabot-v2")))
        >>> np.degrees(reached.arcs([-reached.arm.stretched]).length(1)).round().tolist()
        [207.0]
        """
        # Both postures: their q2, and the direction in which they see the tool at q1 = 0.
        bend = np.asarray(bend, dtype=float)
        low = self.region.box.lower
        values = [first_from(low[1], self.arm.stretched + side * bend) for side in (-1, 1)]
        directions = [self.arm.direction(q2) for q2 in values]
        # Directions at which a posture begins or ends, from 0 to a turn.
        ends = [np.zeros((len(bend), 1)), np.full((len(bend), 1), TURN)]
        for q2, direction in zip(values, directions, strict=True):
            fibres = self.region.fibres(1, q2)
            q1 = np.concatenate([fibres.start, fibres.end[:, -1:]], axis=-1)
            ends.append(first_from(0.0, q1 + direction[:, None]))
        sorted_ends = np.sort(np.concatenate(ends, axis=-1), axis=-1)
        start, end = sorted_ends[:, :-1], sorted_ends[:, 1:]
        # No posture begins or ends within an arc, so its middle decides for all of it.
        postures = np.zeros(start.shape, dtype=int)
        for q2, direction in zip(values, directions, strict=True):
            q1 = first_from(low[0], (start + end) / 2 - direction[:, None])
            q = np.stack([q1, np.broadcast_to(q2[:, None], q1.shape)], axis=-1)
            postures += self.region.contains(q)
        return Arcs(start, end, postures)
