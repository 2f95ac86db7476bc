"""Paths of the arm through a region, and margins along them.

- `traversal`: vertices or arcs in an order, the joint path and the tool's, and the distance of a
  path of the tool from the mirror image of another;
- `encounters`: crossings of a path with itself or with the singular curve, and its margins.
"""
