"""Regions: all feasible values of two joints, as components that exact arcs bound.

- `problem`: what is asked: forms, ranges, held joints, rule; `paper_rule`: the windows of Table 6;
- `exact`: the forms of a problem in exact numbers, where floats do not decide;
- `relevant`: of many forms, those that can bound anything here;
- `plane`: forms over a base, their roots and signs;
- `critical`: where roots may meet; `polynomials`: where stacks of them vanish, and how surely;
- `precise`: what doubles do not decide, decided in balls; `exact`: its coefficients;
- `pieces`: where bodies touch, and where such contacts cross;
- `decomposition`: cells in which all is free; `cells`: which of them are adjacent; `halfedges`:
  what goes round them;
- `emptiness`: which boundaries leave no room, where there are none;
- `loops`, `arcs`: the boundary of each component; `components`: what else is known of it;
- `verified`: what is wrong with a region, before it is handed out;
- `region`: the answer, and what it can be asked; `slices`: a row of such answers.
"""

from qbound.boundary.margins import margins, violated
from qbound.region.components import Component, Vertex
from qbound.region.problem import Problem, Rule, clearance_problem, state
from qbound.region.region import NoHomeError, Region, UnresolvedError, find_region, solve
from qbound.region.slices import Slices, find_slices

__all__ = [
    "Component",
    "NoHomeError",
    "Problem",
    "Region",
    "Rule",
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
]
