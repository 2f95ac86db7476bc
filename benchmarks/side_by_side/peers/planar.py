"""What the methods that only ask points have in common: the scene, its start, and outer rings."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from closed_form import PlanarArm
from numpy.typing import NDArray
from scenes import robot

Floats = NDArray[np.float64]

FOUND = 20_000
"""Configurations among which a start is looked for where the scene's home is not feasible."""


@lru_cache(maxsize=8)
def arm(scene: str) -> PlanarArm:
    """Return the closed form of a scene."""
    return PlanarArm(robot(scene))


@lru_cache(maxsize=8)
def start(scene: str) -> tuple[float, float]:
    """Return a scene's home, or, where that is not feasible, a place with a large margin."""
    form, home = arm(scene), robot(scene).home
    if form.of(home[:, None])[0] > 0:
        return float(home[0]), float(home[1])
    drawn = np.random.default_rng(1).uniform(*form.ranges.T, (FOUND, 2)).T
    best = drawn[:, np.argmax(form.of(drawn))]
    return float(best[0]), float(best[1])
