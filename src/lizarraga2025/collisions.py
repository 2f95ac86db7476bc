"""Four readings of "collision" in Figure 11 that the paper's equations allow.

The paper does not state the test behind its red points. Two more readings belong to the library:
`cspace.sampling.keeps_clear` (eqs. (11) and (12)) and `cspace.region.paper_rule.feasible` (the
windows of Table 6).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from cspace import clearance
from cspace.arrays import Bools, Floats
from cspace.boundary.functions import components
from cspace.model.robot import HalfSpace, Pair, Robot


def misses_points(robot: Robot, q: Floats) -> Bools:
    """No pair of points coincides exactly: eq. (17) to the letter."""
    pairs = [b for b in robot.used if isinstance(b, Pair)]
    return _all_of((np.abs(components(robot, b)(q)).max(axis=-1) > 0 for b in pairs), q)


def keeps_components_positive(robot: Robot, q: Floats) -> Bools:
    """No component of a boundary function in use is negative: eq. (9) to the letter."""
    return _all_of((components(robot, b)(q).min(axis=-1) >= 0 for b in robot.used), q)


def keeps_third_components_positive(robot: Robot, q: Floats) -> Bools:
    """No third (z) component of a boundary function in use is negative: eq. (9) of these alone."""
    return _all_of((components(robot, b)(q)[..., 2] >= 0 for b in robot.used), q)


def keeps_geometric(robot: Robot, q: Floats) -> Bools:
    """Every half-space in use is respected; pairs of points are not looked at: eq. (12) alone."""
    half_spaces = [b for b in robot.used if isinstance(b, HalfSpace)]
    return _all_of((clearance(robot, b)(q) >= 0 for b in half_spaces), q)


def _all_of(conditions: Iterable[Bools], q: Floats) -> Bools:
    """Tell where all conditions hold; everywhere if there are none."""
    return np.asarray(np.all([np.ones(len(q), dtype=bool), *conditions], axis=0))
