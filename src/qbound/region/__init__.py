"""Which values of two joints are safe? All of them, as components bounded by exact arcs."""

from qbound.region.region import (
    Component,
    Problem,
    Region,
    Vertex,
    clearance_problem,
    find_region,
    margins,
    solve,
    state,
    violated,
)

__all__ = [
    "Component",
    "Problem",
    "Region",
    "Vertex",
    "clearance_problem",
    "find_region",
    "margins",
    "solve",
    "state",
    "violated",
]
