"""Five readings of "collision" in Figure 11 that the paper's equations allow.

The paper does not state the test behind its red points. One more reading is of the library:
`qbound.keeps_clear` (eqs. (11) and (12)).
"""

from __future__ import annotations

import numpy as np

from qbound import clearance, components, window_region
from qbound.arrays import Bools, Floats
from qbound.robot import Robot


def misses_points(robot: Robot, q: Floats) -> Bools:
    """No pair of points coincides exactly: eq. (17) to the letter."""
    allowed = np.ones(len(q), dtype=bool)
    for pair in robot.used_pairs:
        allowed &= (components(robot, pair)(q) != 0).any(axis=-1)
    return allowed


def keeps_geometric(robot: Robot, q: Floats) -> Bools:
    """Every half-space in use is respected; pairs of points are not looked at: eq. (12) alone."""
    allowed = np.ones(len(q), dtype=bool)
    for half_space in robot.used_half_spaces:
        allowed &= clearance(robot, half_space)(q) >= 0
    return allowed


def in_windows(robot: Robot, q: Floats) -> Bools:
    """All windows of Table 6 hold q, and every half-space in use is respected."""
    return window_region(robot).contains(q)


def keeps_components_positive(robot: Robot, q: Floats) -> Bools:
    """No component of a boundary function in use is negative: eq. (9) to the letter."""
    allowed = np.ones(len(q), dtype=bool)
    for boundary in robot.used:
        allowed &= (components(robot, boundary)(q) >= 0).all(axis=-1)
    return allowed


def keeps_third_components_positive(robot: Robot, q: Floats) -> Bools:
    """No third (z) component of a boundary function in use is negative: eq. (9) of these alone."""
    allowed = np.ones(len(q), dtype=bool)
    for boundary in robot.used:
        allowed &= components(robot, boundary)[2](q) >= 0
    return allowed
