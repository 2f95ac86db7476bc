"""Regions: all feasible values of two joints, as components that exact arcs bound.

- `problem`: the question: forms, ranges, held joints; the forms that matter among many;
- `scene`: forms of two joints over a base, features and pairs of bodies; `rows`: the same exactly;
- `algebra`, `zeros`: roots along the lift; zeros of polynomials, in doubles with bounds of errors;
- `exact`: what doubles leave open, asked of factors of polynomials and of balls;
- `kinds`, `events`, `segments`, `cells`: base values at which something changes, pieces of roots
  between them, and the free gaps of the fibres;
- `components`, `outline`: cells that are joined, and the labelled arcs and vertices round them;
- `arcs`, `places`: arcs and cells as data;
- `region`: `find_region` step by step, the resulting `Region`, and its check of itself;
- `slices`: a row of regions.

"Sentence 3" is the third one of "How a region is found" in docs/ARCHITECTURE.md.
"""

from cspace.boundary.evaluator import margins, violated
from cspace.region.arcs import Component, Vertex
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
