"""Measures of a region, from its exact arcs: moments, nearest boundary, largest safe scale.

- `nearest`: moments of a component, the nearest boundary point;
- `conditions`: the forms that are positive where bodies are apart;
- `scaling`: the largest safe scale of a polygon; `worst_bodies`: least distance of two bodies over
  a polygon;
- `star`: the largest safe scale of the exact region, and inner polygons;
- `bodies`: outlines of whole links, the gaps between them, first contacts.
"""
