"""Random sampling of joint space: the traditional method, a fair opponent of the exact region.

This module uses boundary functions but no region, so that everything it finds comes from random
draws. The caller may pass a predicate that decides which configurations are feasible.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from cspace.arguments import refuse_type, whole_number
from cspace.arrays import Bools, Floats
from cspace.boundary.balls import judge
from cspace.boundary.compiled import compiled_feasible
from cspace.model.robot import Robot, refuse_no_robot
from qbound.boundary import position

Predicate = Callable[[Robot, Floats], Bools]


@dataclass(frozen=True, eq=False)
class Sample:
    """Random configurations, the tool's positions, and which of them are feasible.

    Attributes
    ----------
    q : ndarray, shape (n, joints)
        rad or length.
    tool : ndarray, shape (n, 3)
        Tool positions seen from the base; length.
    free : ndarray of bool, shape (n,)
        True where the predicate says feasible; by default by the boundaries of the file alone.
    """

    q: Floats
    tool: Floats
    free: Bools

    def __repr__(self) -> str:
        """Show the number of configurations and the feasible fraction on one line."""
        free = f"{self.fraction_free:.4g} +- {self.standard_error:.2g}"
        return f"<Sample: {len(self.q)} configurations, {free} of them feasible>"

    @property
    def fraction_free(self) -> float:
        """Part of the configurations that are feasible."""
        return float(self.free.mean())

    @property
    def standard_error(self) -> float:
        """Standard error of `fraction_free` (binomial)."""
        p = self.fraction_free
        return float(np.sqrt(p * (1 - p) / len(self.free)))


BATCH = 50_000
"""Configurations that are judged at once, enough to be fast."""

NUMBERS = 2**24
"""Products of :math:`3^n` factors that are held at once: 128 MB."""


def sample(
    robot: Robot,
    n: int,
    predicate: Predicate | None = None,
    *,
    seed: int = 0,
    limits: ArrayLike | None = None,
) -> Sample:
    """Draw `n` configurations evenly and decide which are feasible.

    Parameters
    ----------
    predicate : callable, optional
        (robot, q of shape (n, joints)) -> bool of shape (n,): True where feasible; default:
        `keeps_clear`.
    seed : int
        Seed of NumPy's default generator; the same seed draws the same configurations.
    limits : array_like, shape (joints, 2), optional
        Range of each joint; default: its limits, or (-pi, pi) where it turns all the way round.

    Raises
    ------
    ValueError
        If n is less than 1, or the seed is negative.

    Examples
    --------
    >>> from cspace import load_robot
    >>> drawn = sample(load_robot("minervabot-v2"), 1000, seed=1)
    >>> drawn.fraction_free, round(drawn.standard_error, 3)
    (0.667, 0.015)

    The region's exact part of the square is 0.6546; a sample gives it only within its standard
    error.
    """
    refuse_no_robot("sample", robot)
    n, seed = whole_number("n", n, 1), whole_number("seed", seed, 0)
    predicate = keeps_clear if predicate is None else predicate
    if not callable(predicate):
        refuse_type("predicate", predicate, "a function of a robot and configurations")
    low, high = np.asarray(joint_ranges(robot) if limits is None else limits, dtype=float).T
    q = np.random.default_rng(seed).uniform(low, high, (n, len(robot.joints)))
    tool, free = np.empty((n, 3)), np.empty(n, dtype=bool)
    where = position(robot, robot.tool)
    step = max(1, min(BATCH, NUMBERS // 3 ** len(robot.joints)))
    for start in range(0, n, step):
        batch = slice(start, min(start + step, n))
        tool[batch], free[batch] = where(q[batch]), predicate(robot, q[batch])
    return Sample(q, tool, free)


def joint_ranges(robot: Robot) -> Floats:
    """Return the limits of every joint, (-pi, pi) where a joint has none; shape (joints, 2)."""
    return np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])


def keeps_clear(robot: Robot, q: Floats, *, compiled: bool = False, threads: int = 1) -> Bools:
    """Tell which configurations keep every boundary in use; joint limits are not checked.

    Eqs. (11) and (12) without (10): `cspace.violated` and `Region.contains` look at limits too.
    What no boundary of the file keeps apart may overlap (`Robot.unchecked`).

    Parameters
    ----------
    q : array_like, shape (..., joints)
    compiled : bool
        Whether to use machine code (`cspace.boundary.compiled`), which gives the same answers and
        needs Numba.
    threads : int
        Number of threads of the machine code, for many configurations.

    Returns
    -------
    ndarray of bool, shape (...)

    Raises
    ------
    ValueError
        If the last axis has not one value a joint, one is NaN, infinite or masked, or `threads` is
        less than 1.
    ModuleNotFoundError
        If `compiled` is set and Numba is missing.

    Examples
    --------
    A configuration that no boundary forbids counts as clear even beyond a joint's limits:

    >>> from cspace import load_robot, violated
    >>> robot, q = load_robot("ur5"), [7.0, -1.57, 1.57, -1.57, -1.57, 0.0]
    >>> bool(keeps_clear(robot, q)), [name for name, _ in violated(robot, q)]
    (True, ['shoulder_pan_joint.upper'])
    """
    refuse_no_robot("keeps_clear", robot)
    if not isinstance(compiled, bool | np.bool_):
        refuse_type("compiled", compiled, "True or False")
    threads = whole_number("threads", threads, 1)
    if compiled:
        return compiled_feasible(robot, limits=False, threads=threads)(q)
    return judge(robot, limits=False).feasible(q)
