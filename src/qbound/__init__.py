"""The mathematics of one paper: boundary functions of a planar arm, and the region that they leave.

J. A. Lizarraga et al., "Defining Feasible Joint and Geometric Workspaces Through Boundary
Functions", Appl. Sci. 2025, 15, 5383. Numbers in parentheses, such as (29), are the paper's, and so
are the numbers of sections, tables and figures.

Conventions of all modules:

- Joint values are in rad if the joint turns. They are lengths if it slides, and all lengths are in
  the robot's own unit. Configurations have the shape ``(..., n)``: one value for each of n joints
  on the last axis, and any number of configurations on the axes before it.
- Joints are numbered from 0, so number 0 is the paper's q1. Components are numbered 1, 2, 3 for x,
  y, z, as in the paper. Boundaries, points and frames have names.
- ``beta_{i,j}`` is component j of boundary function i. ``beta_{i,j,k}`` is its bound, the upper one
  for k = 1 and the lower one for k = 2.

Read the modules in this order; each uses only modules before it (`arrays` has a few helpers):

- `frames`: vector labels, eqs. (1)-(8)
- `forms`: what a boundary function is as a function of the joints, eq. (29)
- `robot`: joints, points and boundaries, Tables 1 to 5
- `boundary`: Theorem 1, eqs. (9)-(28)
- `circle`: Theorem 2, eqs. (30)-(39)
- `windows`: Table 6
- `quadrature`, `polygon`: integrals; areas and centroids
- `region`: the feasible joint region, Figures 4 and 5
- `scaling`: Figure 6
- `workspace`: where the tool goes
- `traversal`: Figures 7 to 10
- `sampling`: Figure 11
- `symbols`: the formulas with letters
- `robotfile`, `figures`: robots are read and drawn

Examples
--------
The paper in short: the box of Table 6, the region with its six corners, the largest scale of the
polygon through them, and the area that the tool reaches.

>>> import numpy as np
>>> from qbound import Workspace, clearance, largest_scale, load_robot, polygon, window_region
>>> robot = load_robot("minervabot-v2")
>>> region = window_region(robot)
>>> np.degrees(region.box.upper).round(2).tolist()
[76.22, 44.38]
>>> [bound.label for bound in region.corners[0].bounds]
['beta_{4,1,2}', 'beta_{7,3,2}']
>>> height = clearance(robot, robot.boundary("B7"))
>>> centroid = polygon.centroid(region.polygon)
>>> round(largest_scale(height, region.polygon, centroid).scale, 3)
0.964
>>> round(Workspace(region).area, 1)  # cm²
3395.4
"""

from qbound.boundary import (
    clearance,
    closest_approach,
    components,
    keeps_clear,
    margins,
    pair_vector,
    position,
)
from qbound.circle import circle_arc, circle_roots
from qbound.forms import HarmonicForm
from qbound.frames import Frame, Frames
from qbound.region import Region, clearance_region, window_region
from qbound.robot import HalfSpace, Joint, Pair, Point, Robot
from qbound.robotfile import load_robot
from qbound.sampling import sample
from qbound.scaling import largest_scale
from qbound.traversal import traverse
from qbound.windows import joint_windows
from qbound.workspace import Workspace, planar_arm

__all__ = [
    "Frame",
    "Frames",
    "HalfSpace",
    "HarmonicForm",
    "Joint",
    "Pair",
    "Point",
    "Region",
    "Robot",
    "Workspace",
    "circle_arc",
    "circle_roots",
    "clearance",
    "clearance_region",
    "closest_approach",
    "components",
    "joint_windows",
    "keeps_clear",
    "largest_scale",
    "load_robot",
    "margins",
    "pair_vector",
    "planar_arm",
    "position",
    "sample",
    "traverse",
    "window_region",
]
