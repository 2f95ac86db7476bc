"""Paths of the arm through a region, and margins along them.

`traversal` has both: vertices or arcs in an order with the joint path and the tool's; and crossings
of a path with itself or with the singular curve, and its margins.
"""
