"""How does the arm go through a region? Paths, what they meet, and when each joint is where.

- `traversal`: vertices or arcs in an order, the joint path and the tool's;
- `encounters`: where a path crosses itself or the singular curve, and its margins;
- `asymmetry`: how far a path of the tool is from the mirror image of another;
- `trajectory`: the path in time;
- `route`: vertices or arcs by number; `report`: what a route meets, gathered.
"""
