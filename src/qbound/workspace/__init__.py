"""The geometric workspace of two joints: areas, inverse kinematics, passages between postures.

- `planar`: the arm in its plane: det J, its zeros, inverse kinematics;
- `fibres`: the region as intervals of the first joint, one set for each value of the second;
- `cover`, `layers`: these intervals laid over each other on the circles or lines of the tool;
- `image_crossings`: crossings of the images of two postures' boundaries;
- `areas`: the workspace, its aspects and areas; `passage`: the poses that a region joins;
- `report`: all of these, as they were asked for.
"""

from qbound.workspace.areas import Aspect, Workspace, find_workspace
from qbound.workspace.passage import find_passage
from qbound.workspace.planar import (
    NoPlanarWorkspaceError,
    PlanarArm,
    Posture,
    planar_arm,
    postures,
)
from qbound.workspace.report import workspace_report

__all__ = [
    "Aspect",
    "NoPlanarWorkspaceError",
    "PlanarArm",
    "Posture",
    "Workspace",
    "find_passage",
    "find_workspace",
    "planar_arm",
    "postures",
    "workspace_report",
]
