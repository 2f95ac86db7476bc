"""Which values of two joints are safe? All of them, as components bounded by exact arcs."""

from qbound.region.problem import Problem, Rule, clearance_problem, state
from qbound.region.region import Component, Region, Vertex, find_region, margins, solve, violated

__all__ = [
    "Component",
    "Problem",
    "Region",
    "Rule",
    "Vertex",
    "clearance_problem",
    "find_region",
    "margins",
    "solve",
    "state",
    "violated",
]
