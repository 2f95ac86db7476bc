"""The geometric workspace of two joints: inverse kinematics, areas, and what connects."""
