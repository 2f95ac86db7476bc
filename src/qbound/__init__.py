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

__all__ = [
    "HarmonicForm",
    "Region",
    "Robot",
    "RobotFileError",
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


def __getattr__(name: str) -> str:
    if name == "__version__":  # read from the metadata where it is asked for: the search is slow
        from qbound.version import __version__

        return __version__
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
