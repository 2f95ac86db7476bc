"""Regions: all feasible values of two joints, as components that exact arcs bound.

- `scene`: forms of two joints over a base, features and pairs of bodies; `rows`: the same exactly;
- `algebra`, `zeros`: roots along the lift; zeros of polynomials, in doubles with bounds of errors;
- `exact`: what doubles leave open, asked of factors of polynomials and of balls;
- `kinds`, `events`, `segments`, `cells`: base values at which something changes, pieces of roots
  between them, and the free gaps of the fibres;
- `components`, `outline`: cells that are joined, and the labelled arcs and vertices round them;
- `arcs`, `places`: arcs and cells as data;
- `region`: `find_region` step by step, the resulting `Region`, and its check of itself.
"""

from cspace.region_new.arcs import Component, Vertex
from cspace.region_new.region import NoHomeError, Region, UnresolvedError, find_region, solve

__all__ = [
    "Component",
    "NoHomeError",
    "Region",
    "UnresolvedError",
    "Vertex",
    "find_region",
    "solve",
]
