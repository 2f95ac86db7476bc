"""qbound: which joint values of a robot arm are safe, and where its tool goes over them.

A robot file becomes a robot, the robot gives boundary functions, and these are harmonic forms;
`find_region` solves them for every component of the safe region. The method is that of
J. A. Lizarraga et al., Appl. Sci. 2025, 15, 5383.

The mathematics: `geometry`, `forms`, `model` (and `urdf`), `boundary`, `region`, `tolerances`.
On top of it: `sampling`, `measures`, `workspace`, `design`, `paths`, `export`, `proofs`, `arms`,
`sweeps`, `figures`, `explorer`, `cli`. Alone: `check`. Beside all: `units`, `symbols`, `files`,
`printable`, `extras`, `version`.
"""

from qbound.boundary.functions import clearance, components, pair_vector
from qbound.forms.circle import circle_arc, circle_roots
from qbound.forms.harmonic import HarmonicForm
from qbound.model.robot import Robot
from qbound.model.robotfile import RobotFileError, load_robot, packaged_robots, save_robot
from qbound.region import Region, find_region, find_slices, margins, violated

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
    "find_slices",
    "load_robot",
    "margins",
    "packaged_robots",
    "pair_vector",
    "save_robot",
    "violated",
]


def __getattr__(name: str) -> str:
    if name == "__version__":  # read from the metadata where it is asked for: the search is slow
        from qbound.version import __version__

        return __version__
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
