"""Five readings of "collision" in Figure 11 that the paper's equations allow.

The paper does not state the test behind its red points. One more reading is of the library:
`qbound.keeps_clear` (eqs. (11) and (12)).
"""

import numpy as np

from qbound import clearance, components, window_region
from qbound.arrays import Bools, Floats
from qbound.robot import Robot


def misses_points(robot: Robot, q: Floats) -> Bools:
    """No pair of points coincides exactly: eq. (17) to the letter."""
    apart = [(components(robot, pair)(q) != 0).any(axis=-1) for pair in robot.used_pairs]
    return np.asarray(np.all(apart, axis=0))


def keeps_geometric(robot: Robot, q: Floats) -> Bools:
    """Every half-space in use is respected; pairs of points are not looked at: eq. (12) alone."""
    return np.asarray(
        np.all([clearance(robot, half)(q) >= 0 for half in robot.used_half_spaces], axis=0)
    )


def in_windows(robot: Robot, q: Floats) -> Bools:
    """All windows of Table 6 hold q, and every half-space in use is respected."""
    return window_region(robot).contains(q)


def keeps_components_positive(robot: Robot, q: Floats) -> Bools:
    """No component of a boundary function in use is negative: eq. (9) to the letter."""
    positive = [(components(robot, each)(q) >= 0).all(axis=-1) for each in robot.used]
    return np.asarray(np.all(positive, axis=0))


def keeps_third_components_positive(robot: Robot, q: Floats) -> Bools:
    """No third (z) component of a boundary function in use is negative: eq. (9) of these alone."""
    return np.asarray(np.all([components(robot, each)[2](q) >= 0 for each in robot.used], axis=0))
