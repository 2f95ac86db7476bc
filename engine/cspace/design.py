"""Design studies: numbers of a robot varied, and exact measures for each value.

A number is named by its place in the robot's file, such as ``joint.elbow.origin.0``. Not in the
paper.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from cspace.arrays import Floats
from cspace.model.robot import Held, Robot, refuse_no_robot
from cspace.model.robotfile import parse_robot, robot_table
from cspace.order import first_largest
from cspace.printable import printable
from cspace.region import Region, find_region
from cspace.workspace.areas import find_workspace
from cspace.workspace.planar import planar_arm

Path = str | Sequence[str]
"""``joint.elbow.origin.0``; as a sequence where a name has dots in it."""

Measure = Literal["area", "home area", "workspace"]


def workspace_area(region: Region) -> float:
    """Return the area that the tool reaches from the home pose, length squared; 0 without home.

    Raises
    ------
    cspace.workspace.planar.NoPlanarWorkspaceError
        If the tool does not keep to a plane.
    """
    robot, problem = region.robot, region.problem
    arm = planar_arm(robot, problem.held)
    if not region.has_home:
        return 0.0
    return find_workspace(arm, problem, robot.home[list(problem.joints)]).area


MEASURES: Final[dict[Measure, Callable[[Region], float]]] = {
    "area": lambda region: region.area,
    "home area": lambda region: region.home_component.area if region.has_home else 0.0,
    "workspace": workspace_area,
}


TABLES: Final = {
    "joint": "joints",
    "point": "points",
    "boundary": "boundaries",
    "body": "bodies",
    "obstacle": "obstacles",
}
"""Tables of a file whose rows have names, and the robot's attribute for each, in the same order."""


@dataclass(frozen=True, eq=False)
class Design:
    """The result of a design study: a measure of a robot for each value of the varied number.

    Attributes
    ----------
    values : ndarray, shape (k,) or (k, n)
        In the units of the robot's file.
    measures : ndarray, shape (k,)
        Exact at each value; nothing is known between two values.
    unit : str
        Of the measures.
    """

    values: Floats
    measures: Floats
    unit: str

    @property
    def best(self) -> Any:
        """The first of the values with the largest measure: a number, or a list of numbers.

        Measures that differ by less than `TIED` of the largest count as equal.
        """
        return self.values[first_largest(self.measures)].tolist()


def varied(robot: Robot, numbers: Mapping[Path, float]) -> Robot:
    """Return a robot with some numbers of its file changed; the result is checked like a file.

    Parameters
    ----------
    numbers : mapping of str, or of sequence of str, to float
        New numbers by their place in the file, in its units. Entries of a list are named by index,
        rows of the tables ``joint``, ``point``, ``body``, ``boundary`` and ``obstacle`` by name,
        such as ``joint.elbow.origin.0``, ``body.forearm.capsule.radius``,
        ``boundary.B1.clearance``. Numbers that the file leaves out, such as a clearance of 0, may
        be set too.

    Raises
    ------
    ValueError
        If a place does not exist or holds no number, or a value is not a finite number.
    cspace.model.robotcheck.RobotFileError
        If the changed robot is not allowed; the message names the place.

    Examples
    --------
    >>> from cspace import load_robot
    >>> robot = load_robot("two-links-on-a-table")
    >>> robot.joints[1].origin.tolist()
    [0.4, 0.0, 0.0]
    >>> varied(robot, {"joint.elbow.origin.0": 0.5}).joints[1].origin.tolist()
    [0.5, 0.0, 0.0]
    >>> varied(robot, {"joint.wrist.origin.0": 0.5})  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: joint.wrist.origin.0: no joint 'wrist'; there are ...
    """
    refuse_no_robot("varied", robot)
    table = dict(robot_table(robot))
    for path, value in numbers.items():
        _set(robot, table, path.split(".") if isinstance(path, str) else list(path), float(value))
    return replace(parse_robot(table), source=robot.source)


def vary(
    robot: Robot,
    numbers: Path | Sequence[Path],
    values: ArrayLike,
    measure: Measure | Callable[[Region], float] = "area",
    held: Held | None = None,
) -> Design:
    """Measure a robot for each value of one of its numbers, or for several numbers at once.

    Parameters
    ----------
    numbers : str, or sequence of str
        As in `varied`. A link's length is the origin of the next joint and the end of its body.
    values : array_like, shape (k,) or (k, n)
        In the units of the robot's file. Several numbers take the same value, or each its own: then
        a row has a value for each of them.
    measure : {"area", "home area", "workspace"} or callable
        A measure of the region: its area, the area of the component with the home pose, or the area
        that the tool of a planar arm reaches from home. Or a function of a region.
    held : mapping of int or str to float, optional
        Values of all joints but two, rad or length.

    Raises
    ------
    ValueError
        If there are no values, or the measure is unknown. Also as `varied` and `find_region`.

    Examples
    --------
    The farther the second joint is from the first, the more the tool reaches, and the fewer joint
    values are feasible:

    >>> from cspace import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> reached = vary(robot, "joint.q2.origin.0", [10, 20, 30], "workspace")
    >>> reached.measures.round(1).tolist(), reached.unit, reached.best
    ([5497.9, 6276.9, 7330.8], 'cm^2', 30.0)
    >>> vary(robot, "joint.q2.origin.0", [10, 20, 30]).best
    10.0
    >>> longer = ["joint.q2.origin.0", "point.10.at.0"]
    >>> vary(robot, longer, [[10, 12], [10, 15], [12, 15]]).measures.round(3).tolist()
    [26.262, 26.262, 26.094]
    """
    chosen = np.asarray(values, dtype=float)
    paths = [numbers] if isinstance(numbers, str) else list(numbers)
    if not chosen.ndim or chosen.shape[1:] not in ((), (len(paths),)) or not chosen.size:
        raise ValueError(f"values in a row are wanted, found shape {chosen.shape}")
    rows = np.broadcast_to(chosen.T, (len(paths), len(chosen))).T.tolist()
    if isinstance(measure, str) and measure not in MEASURES:
        raise ValueError(f"no measure {measure!r}; there are {', '.join(MEASURES)}")
    found = MEASURES[measure] if isinstance(measure, str) else measure
    regions = (find_region(varied(robot, dict(zip(paths, row, strict=True))), held) for row in rows)
    first = next(regions)
    measures = [found(first), *(found(region) for region in regions)]
    unit = f"{robot.length_unit}^2" if measure == "workspace" else first.area_unit
    return Design(chosen, np.array(measures, dtype=float), unit if isinstance(measure, str) else "")


def _set(robot: Robot, table: dict[str, Any], keys: list[str], value: float) -> None:
    """Set a number at its place in a table."""
    label = printable(".".join(keys))
    if not math.isfinite(value):
        raise ValueError(f"{label}: {value} is no finite number")
    here: Any = table
    for k, key in enumerate(keys[:-1]):
        here = here[_place(robot, here, keys[:k], key, label)]
    last = keys[-1]
    optional = isinstance(here, dict) and last not in here  # a default, or refused later
    place = last if optional else _place(robot, here, keys[:-1], last, label)
    old = 0.0 if optional else here[place]
    if isinstance(old, bool) or not isinstance(old, int | float):
        raise ValueError(f"{label}: no number stands there")
    here[place] = value


def _place(robot: Robot, here: Any, before: Sequence[str], key: str, label: str) -> str | int:
    """Return the key or the index for one part of a path."""
    if isinstance(here, list) and len(before) == 1 and before[0] in TABLES:
        names = [each.name for each in getattr(robot, TABLES[before[0]])]
        if key not in names:  # also of rows that leave their names out
            known = printable(", ".join(names))
            raise ValueError(f"{label}: no {before[0]} {printable(key)!r}; there are {known}")
        return names.index(key)
    if isinstance(here, list):
        if not (key.isascii() and key.isdecimal() and int(key) < len(here)):
            raise ValueError(f"{label}: {key!r} is none of the {len(here)} entries, counted from 0")
        return int(key)
    if not isinstance(here, dict) or key not in here:
        raise ValueError(f"{label}: nothing is called {printable(key)!r} there")
    return key
