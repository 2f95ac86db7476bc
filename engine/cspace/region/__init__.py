"""Regions: all feasible values of two joints, as components that exact arcs bound.

- `problem`: the question: forms, ranges, held joints; the forms that matter among many;
- `plane`: forms over a base, their roots and signs: in doubles with bounds of their errors, and in
  balls where these do not decide;
- `events`: base values at which roots may meet, appear or pass an end; contacts of bodies;
- `cells`: feasible cells, and which of them are adjacent;
- `outline`: components, and the labelled arcs and vertices that bound them;
- `region`: `find_region` step by step, the resulting `Region`, and its check of itself;
- `slices`: a row of regions.
"""

from cspace.boundary.evaluator import margins, violated
from cspace.region.outline import Component, Vertex
from cspace.region.problem import Problem, clearance_problem, state, window_problem
from cspace.region.region import NoHomeError, Region, UnresolvedError, find_region, solve
from cspace.region.slices import Slices, find_slices

__all__ = [
    "Component",
    "NoHomeError",
    "Problem",
    "Region",
    "Slices",
    "UnresolvedError",
    "Vertex",
    "clearance_problem",
    "find_region",
    "find_slices",
    "margins",
    "solve",
    "state",
    "violated",
    "window_problem",
]
