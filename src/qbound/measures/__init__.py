"""How large is a region, how near its boundary, how far may it grow? Measures on exact arcs.

- `nearest`: moments of a component, the nearest boundary point;
- `conditions`: which forms are positive where bodies are apart;
- `scaling`: the largest safe scale of a polygon; `worst_bodies`: how near two bodies come over it;
- `star`: the largest safe scale of the exact region, and inner polygons;
- `bodies`: outlines of whole links, the gaps between them, first contacts.
"""
