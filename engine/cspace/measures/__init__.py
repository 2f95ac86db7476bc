"""Measures of a region, from its exact arcs: moments, nearest boundary, largest feasible scale.

- `nearest`: moments of a component, the nearest boundary point;
- `scaling`: the largest feasible scale of a polygon, and least margins over it;
- `star`: the largest feasible scale of the exact region, and inner polygons;
- `bodies`: outlines of whole links, the gaps between them, first contacts.
"""
