"""Robot files: TOML in, a `Robot` out, or one clear error; and a `Robot` back into TOML.

A file is data: it is checked by `robotcheck`, and nothing in it is evaluated.
"""

from __future__ import annotations

import json
import math
import re
import tomllib
import warnings
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qbound.model.frames import roll_pitch_yaw
from qbound.model.robot import Body, HalfSpace, Joint, Pair, Point, Robot
from qbound.model.robotcheck import RobotFileError, Table, check_table
from qbound.model.schema import place
from qbound.tolerances import TANGENT

__all__ = [
    "RobotFileError",
    "load_robot",
    "packaged_robots",
    "parse_robot",
    "robot_text",
    "save_robot",
]

ROWS = ("joint", "point", "boundary", "body")
"""The lists of a file, in the order in which they are written."""


def load_robot(source: str | Path) -> Robot:
    """Read a robot from a file, or a packaged one by its name.

    Parameters
    ----------
    source : str or Path
        A path, or a bare name among `packaged_robots()`. Such a name always means the packaged
        robot; a file that is called just so is reached by ``./name``.

    Raises
    ------
    RobotFileError
        If the file cannot be read or says something that is no robot.

    Warns
    -----
    UserWarning
        If a pair of points has no radius and no clearance: it never bounds anything.
    """
    text, label = robot_text(source)
    try:
        table = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also an integer or a nesting without end
        raise RobotFileError(f"{label}: not TOML: {error}") from None
    return _robot(table, f"{label}: ")


def save_robot(robot: Robot, path: str | Path) -> None:
    """Write a robot file, complete or not at all.

    Angles are written in the robot's angle unit. Read again, every number is the same to one unit
    in its last place; the mount of a joint, written as roll, pitch and yaw, to a few.

    Raises
    ------
    RobotFileError
        If the robot is none that a file may hold (an infinite offset, say); nothing is written.
    """
    table = _table(robot)
    try:
        check_table(table)
    except RobotFileError as error:
        raise RobotFileError(f"{path}: not written: {error}") from None
    text = _toml(table)
    target = Path(path)
    draft = target.with_name(f"{target.name}.part")
    try:
        draft.write_bytes(text.encode())
        draft.replace(target)
    finally:
        draft.unlink(missing_ok=True)


def packaged_robots() -> tuple[str, ...]:
    """Return the names of the robots inside the package."""
    folder = resources.files("qbound") / "robots"
    return tuple(sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith(".toml")))


def parse_robot(table: Table) -> Robot:
    """Turn the content of a robot file into a `Robot`: radians, unit vectors, one length unit."""
    return _robot(table, "")


def _robot(table: Table, label: str) -> Robot:
    try:
        check_table(table)
    except RobotFileError as error:
        raise RobotFileError(f"{label}{error}") from None
    except RecursionError:
        raise RobotFileError(f"{label}tables in tables without end") from None
    robot = _built(table)
    for i, pair in enumerate(robot.boundaries):
        if isinstance(pair, Pair) and robot.required_distance(pair) == 0:
            where = place(table, ("boundary", i))
            text = f"{label}{where}: no radius and no clearance; this pair is never a wall"
            warnings.warn(text, stacklevel=3)  # at the caller of load_robot or parse_robot
    return robot


def robot_text(source: str | Path) -> tuple[str, str]:
    """Return the text of a robot file, or of a packaged one, and the name to call it by."""
    if str(source) in packaged_robots():
        name = f"{source}.toml"
        return (resources.files("qbound") / "robots" / name).read_text(encoding="utf-8"), name
    try:
        return Path(source).read_text(encoding="utf-8-sig"), str(source)
    except (OSError, UnicodeDecodeError) as error:
        known = ", ".join(packaged_robots())
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise RobotFileError(f"{source}: {reason}; packaged robots are {known}") from None


# --- from a table to a robot ---------------------------------------------------------------------


def _built(table: Table) -> Robot:
    angle = _angle(table["angle_unit"])
    joints = tuple(_joint(row, angle) for row in table["joint"])
    points = (
        Point(p["name"], p["frame"], np.array(p["at"], dtype=float), float(p.get("radius", 0)))
        for p in table["point"]
    )
    bodies = (Body(b["frame"], np.array(b["polygon"], dtype=float)) for b in table.get("body", ()))
    return Robot(
        name=table["name"],
        joints=joints,
        points=tuple(points),
        boundaries=tuple(_boundary(row) for row in table.get("boundary", ())),
        home=np.array([table["home"][j.name] * _scale(j.kind, angle) for j in joints]),
        tool=table["tool"],
        length_unit=table["length_unit"],
        angle_unit=table["angle_unit"],
        bodies=tuple(bodies),
    )


def _joint(row: Table, angle: float) -> Joint:
    scale = _scale(row["type"], angle)
    limits = row.get("limits")
    return Joint(
        name=row["name"],
        kind=row["type"],
        parent=row["parent"],
        frame=row["frame"],
        origin=np.array(row["origin"], dtype=float),
        mount=roll_pitch_yaw(*(x * angle for x in row.get("rpy", (0.0, 0.0, 0.0)))),
        axis=_unit(row["axis"]),
        limits=None if limits is None else (limits[0] * scale, limits[1] * scale),
        velocity=row["velocity"] * scale if "velocity" in row else None,
    )


def _boundary(row: Table) -> Pair | HalfSpace:
    used = row.get("used", True)
    if row["type"] == "pair":
        first, second = row["points"]
        return Pair(row["name"], (first, second), float(row.get("clearance", 0)), used)
    return HalfSpace(row["name"], row["point"], _unit(row["normal"]), float(row["offset"]), used)


def _unit(vector: Sequence[float]) -> NDArray[np.float64]:
    """Give a vector the length 1; one that has it but for rounding stays as it is written."""
    if abs(math.hypot(*vector) - 1) <= TANGENT:
        return np.array(vector, dtype=float)
    largest = max(map(abs, vector))
    scaled = np.array(vector, dtype=float) / largest  # so that no square overflows
    return np.asarray(scaled / math.hypot(*scaled))


def _angle(unit: str) -> float:
    """Radians in one of the file's units of angle."""
    return math.radians(1.0) if unit == "deg" else 1.0


def _scale(kind: str, angle: float) -> float:
    """Library units in one of the file's units of a joint's value."""
    return angle if kind == "revolute" else 1.0


# --- from a robot to a table, and to TOML --------------------------------------------------------


def _table(robot: Robot) -> Table:
    """Undo `_built`; what a file may leave out is left out."""
    angle = _angle(robot.angle_unit)
    scales = [_scale(kind, angle) for kind in robot.kinds]
    home = zip(robot.joints, robot.home, scales, strict=True)
    return {
        "schema": 1,
        "name": robot.name,
        "length_unit": robot.length_unit,
        "angle_unit": robot.angle_unit,
        "home": {joint.name: _quotient(value, scale) for joint, value, scale in home},
        "tool": robot.tool,
        "joint": [_joint_row(joint, angle) for joint in robot.joints],
        "point": [_point_row(point) for point in robot.points],
        "boundary": [_boundary_row(boundary) for boundary in robot.boundaries],
        "body": [{"frame": b.frame, "polygon": _floats(b.polygon)} for b in robot.bodies],
    }


def _joint_row(joint: Joint, angle: float) -> Table:
    scale = _scale(joint.kind, angle)
    row: dict[str, Any] = {
        "name": joint.name,
        "type": joint.kind,
        "parent": joint.parent,
        "frame": joint.frame,
        "origin": _floats(joint.origin),
        "axis": _floats(joint.axis),
    }
    if not np.array_equal(joint.mount, np.eye(3)):
        row["rpy"] = [_quotient(x, angle) for x in _rpy(joint.mount)]
    if joint.limits is not None:
        row["limits"] = [_quotient(x, scale) for x in joint.limits]
    if joint.velocity is not None:
        row["velocity"] = _quotient(joint.velocity, scale)
    return row


def _point_row(point: Point) -> Table:
    radius = {"radius": float(point.radius)} if point.radius else {}
    return {"name": point.name, "frame": point.frame, "at": _floats(point.at)} | radius


def _boundary_row(boundary: Pair | HalfSpace) -> Table:
    row: dict[str, Any] = {"name": boundary.name}
    if isinstance(boundary, Pair):
        row |= {"type": "pair", "points": list(boundary.points)}
        row |= {"clearance": float(boundary.clearance)} if boundary.clearance else {}
    else:
        row |= {"type": "half-space", "point": boundary.point}
        row |= {"normal": _floats(boundary.normal), "offset": float(boundary.offset)}
    return row | ({} if boundary.used else {"used": False})


def _rpy(mount: NDArray[Any]) -> tuple[float, float, float]:
    """Find roll, pitch and yaw of a rotation.

    Roll is read after yaw is undone, so that a pitch of a quarter turn needs no case of its own.
    """
    m = np.asarray(mount, dtype=float)
    yaw = math.atan2(m[1, 0], m[0, 0])
    c, s = math.cos(yaw), math.sin(yaw)
    pitch = math.atan2(-m[2, 0], c * m[0, 0] + s * m[1, 0])
    roll = math.atan2(s * m[0, 2] - c * m[1, 2], c * m[1, 1] - s * m[0, 1])
    return roll, pitch, yaw


def _quotient(value: float, scale: float) -> float:
    """Find the number that the reader, multiplying, turns into `value`.

    The short one if there is one (20 degrees stay 20), else one that is right to the last place.
    """
    quotient = float(value) / scale
    short = (float(f"{quotient:.{digits}g}") for digits in (15, 16))
    return next((x for x in short if x * scale == value), quotient)


def _floats(values: NDArray[Any]) -> list[Any]:
    floats: list[Any] = np.asarray(values, dtype=float).tolist()
    return floats


def _toml(table: Table) -> str:
    """Write a table of values and of lists of tables as TOML."""
    parts = [_lines({key: value for key, value in table.items() if key not in ROWS})]
    parts += [f"[[{kind}]]\n{_lines(row)}" for kind in ROWS for row in table[kind]]
    return "\n".join(parts)


def _lines(table: Table) -> str:
    return "".join(f"{key} = {_toml_value(value)}\n" for key, value in table.items())


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):  # JSON's quotes and escapes are TOML's, but for DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return f"[{', '.join(map(_toml_value, value))}]"
    if isinstance(value, Mapping):
        pairs = (f"{_toml_key(key)} = {_toml_value(item)}" for key, item in value.items())
        return f"{{ {', '.join(pairs)} }}"
    return repr(value)


def _toml_key(key: str) -> str:
    return key if re.fullmatch("[A-Za-z0-9_-]+", key) else _toml_value(key)
