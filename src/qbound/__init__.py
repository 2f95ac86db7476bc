"""The mathematics of one paper: boundary functions of a planar arm, and the region that they leave.

J. A. Lizarraga et al., "Defining Feasible Joint and Geometric Workspaces Through Boundary
Functions", Appl. Sci. 2025, 15, 5383. Numbers in parentheses, such as (29), are the paper's.

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
