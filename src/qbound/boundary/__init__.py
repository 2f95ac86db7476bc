"""How far is a configuration from contact? Boundary functions, as named harmonic forms.

- `functions`: from a robot's points and boundaries to forms and margins, one boundary at a time;
- `evaluator`: all of them compiled once, for one configuration or for millions.
"""

from qbound.boundary.functions import (
    clearance,
    closest_approach,
    components,
    geometric_vector,
    margin_function,
    margin_of,
    moving_joints,
    observer,
    pair_vector,
    position,
    squared_distance,
)

__all__ = [
    "clearance",
    "closest_approach",
    "components",
    "geometric_vector",
    "margin_function",
    "margin_of",
    "moving_joints",
    "observer",
    "pair_vector",
    "position",
    "squared_distance",
]
