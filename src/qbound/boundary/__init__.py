"""Boundary functions: from a robot to named harmonic forms."""

from qbound.boundary.functions import (
    clearance,
    closest_approach,
    components,
    geometric_vector,
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
    "moving_joints",
    "observer",
    "pair_vector",
    "position",
    "squared_distance",
]
