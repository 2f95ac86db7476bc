"""The geometric workspace of two joints: areas, inverse kinematics, passages between postures.

- `planar`: the arm in its plane: det J, its zeros, inverse kinematics;
- `layers`: the region as intervals of the first joint, laid over each other on the tool's circles;
- `areas`: the workspace, its aspects and areas, and the poses that a region joins.
"""
