"""qbound: feasible joint and geometric workspaces through boundary functions.

A companion to J. A. Lizarraga et al., Appl. Sci. 2025, 15, 5383. A robot file becomes a robot,
the robot gives boundary functions, and these are harmonic forms.
"""

from qbound.boundary.functions import clearance, components, pair_vector
from qbound.forms.circle import circle_arc, circle_roots
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import Robot
from qbound.model.robotfile import RobotFileError, load_robot, packaged_robots, save_robot
from qbound.region import Region, find_region
from qbound.version import __version__

__all__ = [
    "HarmonicForm",
    "Region",
    "Robot",
    "RobotFileError",
    "__version__",
    "circle_arc",
    "circle_roots",
    "clearance",
    "components",
    "find_region",
    "load_robot",
    "packaged_robots",
    "pair_vector",
    "save_robot",
]
