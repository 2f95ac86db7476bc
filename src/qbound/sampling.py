"""Random sampling of joint space: the traditional method that the paper compares (Figure 11)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from qbound.arrays import Bools, Floats
from qbound.boundary import position
from qbound.robot import Robot


@dataclass(frozen=True, eq=False)
class Sample:
    """Random configurations, the tool's positions, and which of them a test allows.

    Attributes
    ----------
    q : ndarray, shape (n, joints)
        Joint values, rad or length.
    tool : ndarray, shape (n, 3)
        x, y, z of the tool, seen from the base, in the robot's unit of length.
    allowed : ndarray of bool, shape (n,)
        Result of the test.
    """

    q: Floats
    tool: Floats
    allowed: Bools

    @property
    def fraction(self) -> float:
        """Share p of the configurations that are allowed, from 0 to 1."""
        return float(self.allowed.mean())

    @property
    def standard_error(self) -> float:
        """Standard error of `fraction`, sqrt(p (1 - p) / n)."""
        return float(np.sqrt(self.fraction * (1 - self.fraction) / len(self.allowed)))


def sample(
    robot: Robot, n: int, test: Callable[[Robot, Floats], Bools], *, seed: int = 0
) -> Sample:
    """Draw `n` configurations evenly within the joints' limits, or one full turn, and test each.

    Parameters
    ----------
    n : int
        Number of configurations; the standard error falls with its square root.
    test : callable
        Takes a robot and configurations, shape (n, joints), to booleans, shape (n,); such as
        `keeps_clear`.
    seed : int
        Seed of NumPy's generator; the same seed gives the same configurations.

    Raises
    ------
    ValueError
        If a joint slides without limits.

    Examples
    --------
    >>> from qbound import keeps_clear, load_robot, sample
    >>> found = sample(load_robot("minervabot-v2"), 1000, keeps_clear, seed=1)
    >>> found.fraction, round(found.standard_error, 3)
    (0.667, 0.015)
    """
    low, high = np.array([joint.range for joint in robot.joints]).T
    q = np.random.default_rng(seed).uniform(low, high, (n, len(robot.joints)))
    return Sample(q, position(robot)(q), test(robot, q))
