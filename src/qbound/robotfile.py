"""Robot files: TOML with one table for each joint, point, boundary and outline of a link.

Angles of a file, which are limits and home values of joints that turn, are in degrees unless
``angle_unit`` says "rad". A Robot has radians. The keys are the attributes of the records in
`robot`, with these differences: the kind of a joint or boundary has the key ``type`` ("revolute" or
"prismatic", "pair" or "half-space"), and a ``[[body]]`` is the outline of a link, a polygon of
corners (x, z) or (x, y, z). A joint that ``home`` does not name is at 0. These may be left out:
``schema``, ``angle_unit``, ``home``, the ``limits`` of a joint, ``clearance`` (0) and ``used``
(true) of a boundary, and all tables but the joints. The packaged files in the folder ``robots`` are
longer examples.

Examples
--------
An arm that turns and slides, and whose tip keeps above a floor. To read this text from a file, save
it as ``slide.toml`` and call ``load_robot("slide.toml")``:

>>> import tomllib
>>> from qbound.robotfile import read_robot
>>> text = '''
... name = "My slide"
... length_unit = "cm"
... home = { q1 = 0, q2 = 5 }
... tool = "tip"
...
... [[joint]]
... name = "q1"
... type = "revolute"
... parent = "0"
... frame = "1"
... origin = [0, 0, 20]
... axis = [0, 1, 0]
... limits = [-80, 100]
...
... [[joint]]
... name = "q2"
... type = "prismatic"
... parent = "1"
... frame = "2"
... origin = [10, 0, 0]
... axis = [1, 0, 0]
... limits = [0, 20]
...
... [[point]]
... name = "tip"
... frame = "2"
... at = [5, 0, 0]
...
... [[boundary]]
... name = "floor"
... type = "half-space"
... point = "tip"
... normal = [0, 0, 1]
... offset = 2
... '''
>>> robot = read_robot(tomllib.loads(text))

Its region has an area in rad times cm and five corners. Here is the one at which the slide is
stretched as far as the floor allows:

>>> from qbound import window_region
>>> region = window_region(robot)
>>> round(region.area, 3), len(region.corners)
(46.926, 5)
>>> region.corners[3].q.round(3).tolist(), [bound.label for bound in region.corners[3].bounds]
([0.54, 20.0], ['q2.upper', 'beta_{floor,3,1}'])
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from qbound.arrays import Array
from qbound.robot import Boundary, HalfSpace, Joint, Outline, Pair, Point, Robot

ROBOTS: Final = Path(__file__).parent / "robots"
"""Where the packaged robots are."""

KEYS: Final = {
    "robot": "schema name length_unit angle_unit home tool joint point boundary body",
    "joint": "name type parent frame origin axis limits",
    "point": "name frame at",
    "pair": "name type used points clearance",
    "half-space": "name type used point normal offset",
    "body": "frame polygon",
}
"""The keys of each table of a robot file, one text for each kind of table."""

LARGEST: Final = 1e100
"""A larger number is not finite, or its square soon is not."""

CSPACE_KEYS: Final = {
    "robot": "collisions clearance allowed obstacle",
    "joint": "rpy velocity crank bar",
    "point": "radius",
    "pair": "",
    "half-space": "body",
    "body": "name capsule disc",
}
"""Further keys, which only cspace reads."""


def load_robot(source: str | Path) -> Robot:
    """Read a robot file, or a packaged robot by its name.

    The module's example shows a file. This library draws the outlines of links and checks points
    only.

    Parameters
    ----------
    source : str or Path
        A path that ends in ``.toml``, or a name: ``minervabot-v2`` is the paper's robot,
        ``minervabot-v2-corrected`` has one digit corrected, ``minervabot-v2-symmetric`` is exactly
        symmetric.

    Raises
    ------
    ValueError
        If there is no such packaged robot, or the file is not a robot file that this library
        reads. The message names the file and the key.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> from qbound import load_robot
    >>> robot = load_robot("minervabot-v2")
    >>> robot.name, [joint.name for joint in robot.joints]
    ('MinervaBotV2', ['q1', 'q2'])
    """
    path = Path(source)
    if isinstance(source, str) and path.suffix != ".toml":
        path = ROBOTS / f"{source}.toml"
        if not path.exists():
            known = ", ".join(sorted(file.stem for file in ROBOTS.glob("*.toml")))
            raise ValueError(
                f"no packaged robot {source!r}; there are {known}; a path ends in .toml"
            )
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:  # neither TOML nor UTF-8 text
        raise ValueError(f"{path.name}: not a TOML file: {error}") from None
    return read_robot(table, path.name)


def read_robot(table: Mapping[str, Any], file: str = "robot") -> Robot:
    """Make a robot from the content of a robot file.

    Parameters
    ----------
    table : mapping
        The content, as `tomllib` reads it.
    file : str
        Name of the file, for messages.

    Raises
    ------
    ValueError
        As in `load_robot`.

    Examples
    --------
    The least that a robot needs:

    >>> from qbound.robotfile import read_robot
    >>> joint = {"name": "q1", "type": "revolute", "parent": "0", "frame": "1"}
    >>> joint |= {"origin": [0, 0, 1], "axis": [0, 1, 0]}
    >>> read_robot({"name": "arm", "length_unit": "m", "tool": "1", "joint": [joint]}).kinds
    ('revolute',)
    """
    root = _Table(table, "robot", file)
    if table.get("schema", 1) != 1:
        raise ValueError(f"{file}: schema must be 1, found {table['schema']!r}")
    unit = root.text("angle_unit", "deg")
    if unit not in ("deg", "rad"):
        raise ValueError(f"{file}: angle_unit must be deg or rad, found {unit!r}")
    angle = math.pi / 180 if unit == "deg" else 1.0
    try:
        joints = tuple(_joint(row, angle) for row in root.tables("joint"))
        return Robot(
            name=root.text("name"),
            length_unit=root.text("length_unit"),
            joints=joints,
            points=tuple(
                Point(row.text("name"), row.text("frame"), row.vector("at"))
                for row in root.tables("point")
            ),
            boundaries=tuple(_boundary(row) for row in root.tables("boundary", "type")),
            tool=root.text("tool"),
            home=_home(table.get("home", {}), joints, angle, file),
            outlines=tuple(
                Outline(row.text("frame"), row.polygon()) for row in root.tables("body")
            ),
        )
    except ValueError as error:
        known = str(error).startswith(f"{file}: ")
        raise ValueError(str(error) if known else f"{file}: {error}") from None


class _Table:
    """A table of a robot file. Its methods return the value of a key, or refuse it.

    `kind` is the key of `KEYS` that says which keys the table may have. `label` stands in front of
    every message, such as ``arm.toml: joint 1 (q1)``.
    """

    def __init__(self, content: object, kind: str, label: str) -> None:
        if not isinstance(content, Mapping):
            raise ValueError(f"{label} must be a table, found {content!r}")
        if kind not in KEYS:
            raise ValueError(
                f"{label}: type {kind!r} is not pair or half-space; cspace.load_robot knows more"
            )
        for key in content:
            if key in CSPACE_KEYS[kind].split():
                raise ValueError(
                    f"{label}: {key} is a key of the engine: cspace.load_robot reads this file"
                )
            if key not in KEYS[kind].split():
                known = ", ".join(KEYS[kind].split())
                raise ValueError(f"{label}: unknown key {key!r}; the keys are {known}")
        self.content = content
        self.label = label

    def get(self, key: str, default: Any = None) -> Any:
        value = self.content.get(key, default)
        if value is None:
            raise ValueError(f"{self.label}: {key} is missing")
        return value

    def text(self, key: str, default: str | None = None) -> str:
        value = self.get(key, default)
        if not isinstance(value, str) or not value:
            raise ValueError(f"{self.label}: {key} must be a text, found {value!r}")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        return _number(self.get(key, default), f"{self.label}: {key}")

    def used(self) -> bool:
        value = self.get("used", True)
        if not isinstance(value, bool):
            raise ValueError(f"{self.label}: used must be true or false, found {value!r}")
        return value

    def numbers(self, key: str, counts: tuple[int, ...]) -> list[float]:
        values = self.get(key)
        if not isinstance(values, list) or len(values) not in counts:
            raise ValueError(f"{self.label}: {key} must be {counts[0]} numbers, found {values!r}")
        return [_number(value, f"{self.label}: {key}") for value in values]

    def vector(self, key: str) -> Array:
        return np.array(self.numbers(key, (3,)))

    def polygon(self) -> Array:
        """Return the corners of an outline, written as (x, z) or (x, y, z): shape (m, 3)."""
        rows = self.get("polygon")
        if not isinstance(rows, list) or len(rows) < 3:
            raise ValueError(f"{self.label}: polygon must be three corners or more, found {rows!r}")
        corners = []
        for row in rows:
            corner = _Table({"polygon": row}, "body", self.label).numbers("polygon", (2, 3))
            corners.append(corner if len(corner) == 3 else [corner[0], 0.0, corner[1]])
        return np.array(corners)

    def tables(self, kind: str, kind_key: str = "") -> list[_Table]:
        """Return the tables of a list, such as ``[[joint]]``.

        Their kind is that of the list; with a `kind_key` each table names its own kind there.
        """
        rows = self.content.get(kind, [])
        if not isinstance(rows, list):
            raise ValueError(f"{self.label}: {kind} must be a list of tables, found {rows!r}")
        found = []
        for i, row in enumerate(rows, start=1):
            label, own = f"{self.label}: {kind} {i}", kind
            if isinstance(row, Mapping):
                label += f" ({row['name']})" if isinstance(row.get("name"), str) else ""
                own = str(row.get(kind_key, "")) if kind_key else kind
            found.append(_Table(row, own, label))
        return found


def _number(value: Any, label: str) -> float:
    """Return a finite number; true and false are not numbers."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if not number or not abs(value) <= LARGEST:
        raise ValueError(f"{label} must be a finite number, found {value!r}")
    return float(value)


def _joint(row: _Table, angle: float) -> Joint:
    kind = row.text("type")
    if kind not in ("revolute", "prismatic"):
        raise ValueError(
            f"{row.label}: type {kind!r} is not revolute or prismatic; cspace.load_robot knows more"
        )
    limits = None
    if "limits" in row.content:
        scale = angle if kind == "revolute" else 1.0
        low, high = row.numbers("limits", (2,))
        limits = low * scale, high * scale
    return Joint(
        name=row.text("name"),
        parent=row.text("parent"),
        frame=row.text("frame"),
        origin=row.vector("origin"),
        axis=row.vector("axis"),
        kind=kind,  # type: ignore[arg-type]  # one of the two
        limits=limits,
    )


def _boundary(row: _Table) -> Boundary:
    name = row.text("name")
    if row.text("type") == "half-space":
        normal, offset = row.vector("normal"), row.number("offset")
        return HalfSpace(name, row.text("point"), normal, offset, row.used())
    points = row.get("points")
    names = isinstance(points, list) and all(isinstance(name, str) for name in points)
    if not names or len(points) != 2:
        raise ValueError(f"{row.label}: points must be two names, found {points!r}")
    return Pair(name, (points[0], points[1]), row.number("clearance", 0.0), row.used())


def _home(table: object, joints: tuple[Joint, ...], angle: float, file: str) -> tuple[float, ...]:
    """Return the home pose; a joint that is not named has the value 0."""
    names = [joint.name for joint in joints]
    if not isinstance(table, Mapping):
        raise ValueError(f"{file}: home must be a table, found {table!r}")
    for name in table:
        if name not in names:
            raise ValueError(f"{file}: home: no joint {name!r}; there are {', '.join(names)}")
    home = []
    for joint in joints:
        value = _number(table.get(joint.name, 0.0), f"{file}: home: {joint.name}")
        home.append(value * angle if joint.turns else value)
    return tuple(home)
