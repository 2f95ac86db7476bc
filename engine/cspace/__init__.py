"""cspace: which joint values of a robot arm are feasible, and where its tool goes over them.

A robot file becomes a robot, the robot gives boundary functions, and these are harmonic forms;
`find_region` solves them for every component of the feasible region. The method is that of
J. A. Lizarraga et al., Appl. Sci. 2025, 15, 5383.

`__all__` has the names that most users need. Everything else is in the subpackages.

The mathematics: `geometry`, `forms`, `model` (and `urdf`), `boundary`, `region`, `tolerances`.
On top of it: `sampling`, `measures`, `workspace`, `design`, `paths`, `export`, `proofs`, `arms`,
`sweeps`, `figures`, `explorer`, `cli`. Alone: `check`. Beside all: `units`, `files`,
`printable`, `extras`, `arguments`, `arrays`, `order`, `version`.
"""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cspace.arms.fibres import fibres
    from cspace.arms.why import why
    from cspace.boundary.evaluator import is_feasible, margins, violated
    from cspace.boundary.functions import clearance
    from cspace.model.robot import Robot
    from cspace.model.robotfile import RobotFileError, load_robot, packaged_robots, save_robot
    from cspace.region import Region, find_region, find_slices
    from cspace.sampling import keeps_clear, sample

    __version__: str

__all__ = [
    "Region",
    "Robot",
    "RobotFileError",
    "clearance",
    "fibres",
    "find_region",
    "find_slices",
    "is_feasible",
    "keeps_clear",
    "load_robot",
    "margins",
    "packaged_robots",
    "sample",
    "save_robot",
    "violated",
    "why",
]

_PLACES = {
    "arms.fibres": ("fibres",),
    "arms.why": ("why",),
    "boundary.functions": ("clearance",),
    "boundary.evaluator": ("is_feasible", "margins", "violated"),
    "model.robot": ("Robot",),
    "model.robotfile": ("RobotFileError", "load_robot", "packaged_robots", "save_robot"),
    "region": ("Region", "find_region", "find_slices"),
    "sampling": ("keeps_clear", "sample"),
    "version": ("__version__",),
}
"""Where each name comes from when it is first asked for: a command loads only what it uses."""

if not TYPE_CHECKING:  # to a type checker an unknown name stays one

    def __getattr__(name: str) -> Any:
        for place, names in _PLACES.items():
            if name in names:
                found = getattr(import_module(f"{__name__}.{place}"), name)
                globals()[name] = found
                return found
        if not name.startswith("_") and find_spec(f"{__name__}.{name}"):  # a subpackage
            return import_module(f"{__name__}.{name}")
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
