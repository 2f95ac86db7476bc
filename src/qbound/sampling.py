"""Random sampling of joint space: the traditional method that the paper argues against (Figure 11).

It sees boundary functions only, no region: whatever it finds, it finds by drawing. What "collision"
means for a drawn configuration the paper does not say, so the predicate is a choice.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qbound.boundary.evaluator import evaluator
from qbound.boundary.functions import clearance, components, position
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import Pair, Robot

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Predicate = Callable[[Robot, Floats], Bools]


@dataclass(frozen=True, eq=False)
class Sample:
    """Random configurations, where the tool goes, and which are free of collision.

    Attributes
    ----------
    q : ndarray, shape (n, joints)
        rad or length.
    tool : ndarray, shape (n, 3)
        Tool positions seen from the base; length.
    free : ndarray of bool, shape (n,)
    """

    q: Floats
    tool: Floats
    free: Bools

    @property
    def fraction_free(self) -> float:
        """Part of the configurations that are free."""
        return float(self.free.mean())

    @property
    def standard_error(self) -> float:
        """Standard error of `fraction_free` (binomial)."""
        p = self.fraction_free
        return float(np.sqrt(p * (1 - p) / len(self.free)))


BATCH = 50_000
"""Configurations that are judged at once, enough to be fast, few enough for any memory."""


def sample(
    robot: Robot,
    n: int,
    predicate: Predicate,
    *,
    seed: int,
    limits: ArrayLike | None = None,
    progress: Callable[[int], None] | None = None,
) -> Sample:
    """Draw `n` configurations evenly and judge each (Figure 11).

    Parameters
    ----------
    predicate : callable
        (robot, q of shape (n, joints)) -> bool of shape (n,): True where free of collision.
    seed : int
        Of NumPy's default generator; the same seed draws the same configurations.
    limits : array_like, shape (joints, 2), optional
        Range of each joint; default: its limits, or (-pi, pi) where it turns all the way round.
    progress : callable, optional
        Told, now and then, how many are done.
    """
    low, high = np.asarray(joint_ranges(robot) if limits is None else limits, dtype=float).T
    q = np.random.default_rng(seed).uniform(low, high, (n, len(robot.joints)))
    tool, free = np.empty((n, 3)), np.empty(n, dtype=bool)
    where = position(robot, robot.tool)
    for start in range(0, n, BATCH):
        batch = slice(start, min(start + BATCH, n))
        tool[batch], free[batch] = where(q[batch]), predicate(robot, q[batch])
        if progress is not None:
            progress(batch.stop)
    return Sample(q, tool, free)


def joint_ranges(robot: Robot) -> Floats:
    """Return the limits of every joint, (-pi, pi) where a joint has none; shape (joints, 2)."""
    return np.array([joint.limits or (-np.pi, np.pi) for joint in robot.joints])


def keeps_clear(robot: Robot, q: Floats) -> Bools:
    """Every boundary in use keeps its clearance: eqs. (11) and (12)."""
    return evaluator(robot, limits=False).feasible(q)


def misses_points(robot: Robot, q: Floats) -> Bools:
    """No pair of points coincides exactly: eq. (17) to the letter."""
    pairs = [b for b in robot.boundaries if isinstance(b, Pair) and b.used]
    apart = [(components(robot, pair)(q) != 0).any(axis=-1) for pair in pairs]
    return np.asarray(np.all([np.ones(len(q), dtype=bool), *apart], axis=0))


def keeps_components_positive(robot: Robot, q: Floats) -> Bools:
    """No component of a boundary function in use is negative: eq. (9) to the letter."""
    return _respected((components(robot, b) for b in robot.boundaries if b.used), q)


def keeps_geometric(robot: Robot, q: Floats) -> Bools:
    """Every half-space in use is respected; pairs of points are not looked at: eq. (12) alone."""
    walls = [b for b in robot.boundaries if b.used and not isinstance(b, Pair)]
    return _respected((clearance(robot, wall) for wall in walls), q)


def _respected(forms: Iterable[HarmonicForm], q: Floats) -> Bools:
    """No form of any stack is negative."""
    values = [form(q).reshape(len(q), -1) for form in forms]
    return np.asarray((np.concatenate([np.zeros((len(q), 1)), *values], axis=1) >= 0).all(axis=1))
