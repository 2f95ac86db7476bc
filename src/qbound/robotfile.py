"""Robot files: TOML in, a `Robot` out, or one clear error.

A file is data. Types and keys are checked by the JSON Schema that ships with the package, meaning
(references, chain, finite numbers, units) here. Nothing in a file is evaluated.
"""

from __future__ import annotations

import json
import math
import sys
import tomllib
import warnings
from collections.abc import Iterator, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from qbound.boundary import required_distance
from qbound.frames import roll_pitch_yaw
from qbound.robot import Body, HalfSpace, Joint, Pair, Point, Robot

Table = Mapping[str, Any]


class RobotFileError(ValueError):
    """A robot file that is wrong: names the file, the key, what was found, what is allowed."""


def load_robot(source: str | Path) -> Robot:
    """Read a robot from a file, or a packaged one by its name.

    Parameters
    ----------
    source : str or Path
        A path, or a bare name among `packaged_robots()`.

    Raises
    ------
    RobotFileError
        If the file cannot be read or says something that is no robot.
    """
    text, label = _text(source)
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise RobotFileError(f"{label}: not TOML: {error}") from None
    try:
        return parse_robot(table)
    except RobotFileError as error:
        raise RobotFileError(f"{label}: {error}") from None


def packaged_robots() -> tuple[str, ...]:
    """Return the names of the robots inside the package."""
    folder = resources.files("qbound") / "robots"
    return tuple(sorted(f.name[:-5] for f in folder.iterdir() if f.name.endswith(".toml")))


def parse_robot(table: Table) -> Robot:
    """Turn the content of a robot file into a `Robot`: radians, unit vectors, one length unit."""
    for check in (_check_schema, _check_finite, _check_names, _check_chain, _check_references):
        check(table)
    angle = math.radians(1.0) if table["angle_unit"] == "deg" else 1.0
    joints = tuple(_joint(f"joint[{i}]", j, angle) for i, j in enumerate(table["joint"]))
    scales = [angle if joint.kind == "revolute" else 1.0 for joint in joints]
    robot = Robot(
        name=table["name"],
        joints=joints,
        points=tuple(
            Point(p["name"], p["frame"], np.array(p["at"], dtype=float), float(p.get("radius", 0)))
            for p in table["point"]
        ),
        boundaries=tuple(
            _boundary(f"boundary[{i}]", b) for i, b in enumerate(_rows(table, "boundary"))
        ),
        home=np.array([table["home"][j.name] * s for j, s in zip(joints, scales, strict=True)]),
        tool=table["tool"],
        length_unit=table["length_unit"],
        angle_unit=table["angle_unit"],
        bodies=tuple(
            Body(b["frame"], np.array(b["polygon"], dtype=float)) for b in _rows(table, "body")
        ),
    )
    _warn_of_no_walls(robot)
    return robot


def _warn_of_no_walls(robot: Robot) -> None:
    """Warn of pairs of bare points that may come as close as they like."""
    for pair in robot.boundaries:
        if isinstance(pair, Pair) and required_distance(robot, pair) == 0:
            text = f"{pair.name}: no radius and no clearance; this pair is never a wall"
            warnings.warn(text, stacklevel=3)


def _text(source: str | Path) -> tuple[str, str]:
    """Return the text of a file and the name to call it by."""
    if str(source) in packaged_robots():
        name = f"{source}.toml"
        return (resources.files("qbound") / "robots" / name).read_text(encoding="utf-8"), name
    try:
        return Path(source).read_text(encoding="utf-8"), str(source)
    except (OSError, UnicodeDecodeError) as error:
        known = ", ".join(packaged_robots())
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise RobotFileError(f"{source}: {reason}; packaged robots are {known}") from None


def _joint(where: str, table: Table, angle: float) -> Joint:
    revolute = table["type"] == "revolute"
    scale = angle if revolute else 1.0
    limits = table.get("limits")
    if limits is None and not revolute:
        raise RobotFileError(f"{where}.limits: missing; a prismatic joint needs limits")
    if limits is not None and not limits[0] < limits[1]:
        raise RobotFileError(f"{where}.limits: {limits} is not in rising order")
    rpy = [x * angle for x in table.get("rpy", (0.0, 0.0, 0.0))]
    return Joint(
        name=table["name"],
        kind=table["type"],
        parent=table["parent"],
        frame=table["frame"],
        origin=np.array(table["origin"], dtype=float),
        mount=roll_pitch_yaw(*rpy),
        axis=_unit(f"{where}.axis", table["axis"]),
        limits=None if limits is None else (limits[0] * scale, limits[1] * scale),
        velocity=table["velocity"] * scale if "velocity" in table else None,
    )


def _boundary(where: str, table: Table) -> Pair | HalfSpace:
    used = table.get("used", True)
    if table["type"] == "pair":
        first, second = table["points"]
        return Pair(table["name"], (first, second), float(table.get("clearance", 0)), used)
    normal = _unit(f"{where}.normal", table["normal"])
    return HalfSpace(table["name"], table["point"], normal, float(table["offset"]), used)


def _unit(where: str, vector: Sequence[float]) -> np.ndarray:
    largest = max(map(abs, vector))
    if largest == 0:
        raise RobotFileError(f"{where}: [0, 0, 0] has no direction")
    scaled = np.array(vector, dtype=float) / largest  # so that no square overflows
    return np.asarray(scaled / np.linalg.norm(scaled))


def _check_schema(table: Table) -> None:
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import best_match

    text = (resources.files("qbound") / "schemas" / "robot.schema.json").read_text(encoding="utf-8")
    error = best_match(Draft202012Validator(json.loads(text)).iter_errors(table))
    if error is not None:
        raise RobotFileError(f"{_dotted(error.absolute_path)}: {error.message}")


def _check_finite(table: Table) -> None:
    for where, value in _leaves(table):
        if isinstance(value, int | float) and not abs(value) <= sys.float_info.max:
            raise RobotFileError(f"{where}: {value} is not a finite number")


def _check_names(table: Table) -> None:
    for kind in ("joint", "point", "boundary"):
        seen: set[str] = set()
        for i, row in enumerate(_rows(table, kind)):
            if row["name"] in seen:
                raise RobotFileError(f"{kind}[{i}].name: {row['name']!r} is used twice")
            seen.add(row["name"])
    frames = _frames(table)
    for i, point in enumerate(table["point"]):
        if point["name"] in frames:
            raise RobotFileError(f"point[{i}].name: {point['name']!r} is the name of a frame")


def _check_chain(table: Table) -> None:
    """Joints form one chain, given from the base outwards, each frame moved once."""
    frame = table["joint"][0]["parent"]
    seen = {frame}
    for i, joint in enumerate(table["joint"]):
        if joint["parent"] != frame:
            raise RobotFileError(
                f"joint[{i}].parent: {joint['parent']!r} found; the chain is at frame {frame!r}"
            )
        frame = joint["frame"]
        if frame in seen:
            raise RobotFileError(f"joint[{i}].frame: {frame!r} closes a cycle")
        seen.add(frame)


def _check_references(table: Table) -> None:
    frames = _frames(table)
    points = [p["name"] for p in table["point"]]
    joints = [j["name"] for j in table["joint"]]
    _known("tool", table["tool"], points, "point")
    for kind in ("point", "body"):
        for i, row in enumerate(_rows(table, kind)):
            _known(f"{kind}[{i}].frame", row["frame"], frames, "frame")
    for i, row in enumerate(_rows(table, "boundary")):
        for name in row.get("points", [row.get("point")]):
            _known(f"boundary[{i}].point{'s' * ('points' in row)}", name, points, "point")
    for name in table["home"]:
        _known("home", name, joints, "joint")
    for name in joints:
        if name not in table["home"]:
            raise RobotFileError(f"home: joint {name!r} has no value")


def _known(where: str, name: str, names: Sequence[str], what: str) -> None:
    if name not in names:
        raise RobotFileError(f"{where}: no {what} {name!r}; there are {', '.join(names)}")


def _frames(table: Table) -> list[str]:
    return [table["joint"][0]["parent"], *(j["frame"] for j in table["joint"])]


def _rows(table: Table, key: str) -> Sequence[Table]:
    rows: Sequence[Table] = table.get(key, [])
    return rows


def _leaves(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str, Any]]:
    """Every number and text of a file, with its place."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(item, (*path, key))
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from _leaves(item, (*path, i))
    else:
        yield _dotted(path), value


def _dotted(path: Any) -> str:
    """Write a place as a reader would: joint[0].axis."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return text.lstrip(".") or "file"
