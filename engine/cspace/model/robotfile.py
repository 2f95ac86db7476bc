"""Robot files: read TOML into a `Robot` or raise one clear error; write a `Robot` as TOML.

A file is data: it is checked by `robotcheck`, and nothing in it is evaluated.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import replace
from datetime import date, datetime, time
from typing import TYPE_CHECKING, Any, Final

import msgspec
import numpy as np
from msgspec import UNSET

import qbound
from cspace.arguments import refuse_type
from cspace.extras import require
from cspace.files import MADE, read_bytes, refuse_replacing, write_whole
from cspace.model.bodycheck import check_bodies, place_of
from cspace.model.boundaries import BodyPair
from cspace.model.robot import Body, Robot, refuse_no_robot
from cspace.model.robotcheck import (
    ANGLE,
    RobotFile,
    RobotFileError,
    Table,
    read_table,
)
from cspace.model.rows import quotient
from cspace.model.schema import JsonPath, place, shown
from cspace.model.shapes import BodyRow, ObstacleRow, default_names, row_shape
from cspace.model.source import Source
from cspace.printable import printable

if TYPE_CHECKING:
    from pathlib import Path

__all__ = [
    "RobotFileError",
    "as_written",
    "load_robot",
    "packaged_robots",
    "parse_robot",
    "robot_table",
    "robot_text",
    "save_robot",
]

PACKAGES: Final = [os.path.dirname(os.path.dirname(__file__)), os.path.dirname(qbound.__file__)]  # noqa: PTH120
"""Whose folders `robots` hold packaged robots. `importlib.resources` takes 10 ms to load."""


def load_robot(
    source: str | Path,
    *,
    chain: tuple[str | None, str | None] | None = None,
    srdf: str | Path | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    excess: float | None = None,
    neighbours: bool | None = None,
) -> Robot:
    """Read a robot from a file, or a packaged one by its name.

    Parameters
    ----------
    source : str or Path
        A path, or a bare name among `packaged_robots()`. Such a name always means the packaged
        robot; write ``./name`` for a file of the same name. A path that ends in ``.urdf`` is read
        by `cspace.urdf.arm.import_urdf`, and the other parameters are for URDF only. Two links that
        one moving joint joins directly are not kept apart.
    chain : pair of str, optional
        First and last link of a URDF's arm; default: its root and its only leaf.
    srdf : str or Path, optional
        The SRDF beside a URDF: pairs of links that may touch, and the home pose.
    limits : mapping of str to pair of float, optional
        Limits of a URDF's joints in place of its own, rad or m.
    excess : float, optional
        How far a ball may stick out of the link that it covers, m.
    neighbours : bool, optional
        Whether links that one moving joint joins directly are kept apart, too.

    Raises
    ------
    RobotFileError
        If the file cannot be read or does not describe a robot.

    Warns
    -----
    UserWarning
        If a pair of points has no radius and no clearance: it never bounds anything. If a joint
        has limits wider than four turns, because these are often degrees in place of radians.

    Examples
    --------
    >>> from cspace import load_robot
    >>> load_robot("pp-portal")
    <Robot Portal with a gripper: beam (prismatic), column (prismatic); 7 boundaries>

    A URDF is read as a robot too, its links covered by balls:

    >>> arm = load_robot("scara.urdf", srdf="scara.srdf", limits={"elbow": (-2.0, 2.0)})
    >>> arm.joints[1].limits, arm.tool
    ((-2.0, 2.0), 'tool')

    A missing or wrong file raises one error that names the place:

    >>> load_robot("arm.tml")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    cspace.model.robotcheck.RobotFileError: arm.tml: No such file or directory; packaged robots ...
    """
    asked = {"chain": chain, "srdf": srdf, "limits": limits, "excess": excess}
    asked |= {"neighbours": neighbours}
    given = {key: value for key, value in asked.items() if value is not None}
    if not isinstance(source, str | os.PathLike):
        refuse_type("source", source, "a path, or the name of a packaged robot")
    if is_urdf(source):
        from cspace.urdf.arm import import_urdf

        return import_urdf(source, **given).robot  # type: ignore[arg-type]  # by their names
    if given:
        raise ValueError(f"{', '.join(given)}: for a URDF only; {source} is a robot file")
    return _robot(*robot_text(source))


def is_urdf(source: str | Path) -> bool:
    """Tell by its ending whether a path is that of a URDF."""
    return os.path.splitext(source)[1].lower() == ".urdf"  # noqa: PTH122


def save_robot(robot: Robot, path: str | Path, *, force: bool = False) -> None:
    """Write a robot file, complete or not at all.

    An existing file is replaced only if its first line says that cspace made it. Otherwise a file
    written by hand would be lost, with its comments.

    Angles are written in the robot's angle unit. Every number that is read again is the same to one
    unit in its last place. For the mount of a joint, written as roll, pitch and yaw, it is a few
    units.

    Parameters
    ----------
    robot : Robot
    path : str or Path
    force : bool
        Whether to replace any file.

    Raises
    ------
    RobotFileError
        If no file can hold the robot (an infinite offset, say); nothing is written.
    ValueError
        If the file exists and cspace did not make it.
    ModuleNotFoundError
        If tomlkit is missing; it comes with ``cspace[files]``.

    Examples
    --------
    A robot with one number changed:

    >>> from dataclasses import replace
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from cspace import load_robot, save_robot
    >>> robot = replace(load_robot("pp-portal"), home=[600.0, 100.0])
    >>> with TemporaryDirectory() as folder:
    ...     save_robot(robot, Path(folder, "portal.toml"))
    ...     load_robot(Path(folder, "portal.toml")).home.tolist()
    [600.0, 100.0]
    """
    refuse_no_robot("save_robot", robot)
    if not isinstance(path, str | os.PathLike):
        refuse_type("path", path, "the path of a file")
    require("tomlkit")
    import tomlkit

    if not force:
        refuse_replacing(path)
    table = robot_table(robot)
    try:
        check_bodies(_built(read_table(table)), table)
    except RobotFileError as error:
        raise RobotFileError(f"{path}: not written: {error}") from None
    write_whole(path, f"# {MADE} (save_robot).\n{tomlkit.dumps(table)}".encode())


def as_written(robot: Robot) -> Robot:
    """Return the robot as a file has it: the same robot, or one read from the file it would get.

    The `source` of the result has the text of the file.

    Raises
    ------
    ModuleNotFoundError
        If the robot was changed, or not read from a robot file, and tomlkit is missing.
    """
    source = robot.source
    if source is not None and source.text and _built(read_table(source.table)) == robot:
        return robot
    require("tomlkit")
    import tomlkit

    return parse_robot(tomlkit.dumps(robot_table(robot)))


def packaged_robots() -> tuple[str, ...]:
    """Return the names of the robots inside the package.

    Examples
    --------
    >>> from cspace import packaged_robots
    >>> "minervabot-v2" in packaged_robots()
    True
    """
    return tuple(sorted(name.removesuffix(".toml") for name in _packaged()))


def _packaged() -> dict[str, str]:
    """Return the paths of packaged robot files by their names; those of the paper are qbound's."""
    return {
        name: f"{package}/robots/{name}"
        for package in PACKAGES
        for name in os.listdir(f"{package}/robots")  # noqa: PTH208
        if name.endswith(".toml")
    }


def parse_robot(content: str | Table | Source, label: str = "") -> Robot:
    """Turn the content of a robot file into a `Robot`: radians, unit vectors, one length unit.

    Parameters
    ----------
    content : str, mapping or Source
        The text of a file, a table such as `robot_table` makes, or a `Source` of one of them.
    label : str, optional
        Name of the file, for errors.

    Raises
    ------
    RobotFileError
        If the content does not describe a robot.
    """
    return _robot(content, label)


def _source(content: str | Table | Source) -> Source:
    if isinstance(content, Source):
        return content
    return Source.of_text(content) if isinstance(content, str) else Source(_plain(content))


def _plain(table: Table) -> Table:
    """Replace NumPy's numbers and arrays by Python's, because msgspec knows no others."""
    days = (date, datetime, time)  # TOML has dates; a robot has none, so the error shows this one
    plain: Table = msgspec.to_builtins(
        table, enc_hook=lambda x: x.tolist() if hasattr(x, "tolist") else str(x), builtin_types=days
    )
    return plain


def _robot(content: str | Table | Source, label: str) -> Robot:
    label = f"{label}: " if label else ""
    try:
        source = _source(content)
        robot = _built(read_table(table := source.table), source)
        check_bodies(robot, table)
    except RobotFileError as error:
        raise RobotFileError(f"{label}{error}") from None
    except RecursionError:
        raise RobotFileError(f"{label}tables in tables without end") from None
    for where, text in _doubts(robot):
        said = f"{printable(label)}{place(table, where)}: {text}"
        warnings.warn(said, stacklevel=3)  # at the caller of load_robot or parse_robot
    return robot


def _doubts(robot: Robot) -> Iterator[tuple[JsonPath, str]]:
    """Yield each row that is allowed but probably a mistake, with the reason."""
    for i, joint in enumerate(robot.joints):
        if turns := joint.many_turns:
            text = f"limits are {turns:.0f} turns wide, so answers take long"
            yield ("joint", i), f"{text}; are they degrees where radians are wanted?"
    for boundary in dict.fromkeys((*robot.boundaries, *robot.used)):
        if robot.least_distance(boundary) == 0:
            yield place_of(robot, boundary), "no radius and no clearance; this pair is never a wall"
        elif isinstance(boundary, BodyPair) and boundary.clearance == 0:
            parts = [part for name in boundary.bodies for part in robot.body(name).shape.parts]
            if not any(part.radius for part in parts) and sum(len(p.corners) for p in parts) <= 3:
                text = f"{shown(boundary.name)}: no radius and no clearance; it is never a wall"
                yield place_of(robot, boundary), text


def robot_text(source: str | Path) -> tuple[str, str]:
    """Return the text of a robot file, or of a packaged one, and the name to call it by."""
    if is_urdf(source):
        raise RobotFileError(f"{source}: a URDF, not a robot file; cspace import makes one of it")
    name, packaged = f"{source}.toml", _packaged()
    if name in packaged:  # letter by letter, on every system
        return _read(packaged[name], "utf-8"), name
    try:
        return _read(source, "utf-8-sig"), str(source)
    except FileNotFoundError as error:
        known = ", ".join(packaged_robots())
        raise RobotFileError(f"{source}: {error.strerror}; packaged robots are {known}") from None
    except UnicodeDecodeError:
        raise RobotFileError(f"{source}: not UTF-8 text, so no robot file") from None
    except OSError as error:
        raise RobotFileError(f"{source}: {error.strerror}") from None
    except ValueError as error:
        raise RobotFileError(f"{source}: {error}") from None


def _read(path: str | Path, encoding: str) -> str:
    text = read_bytes(path).decode(encoding)
    return text.replace("\r\n", "\n").replace("\r", "\n")


# --- from a table to a robot, and back -----------------------------------------------------------


def _built(file: RobotFile, source: Source | None = None) -> Robot:
    angle = ANGLE[file.angle_unit]
    joints = tuple(row.joint(angle) for row in file.joint)
    robot = Robot(
        name=file.name,
        joints=joints,
        points=tuple(row.point() for row in file.point),
        boundaries=tuple(row.boundary() for row in file.boundary),
        home=np.array([file.home[joint.name] * joint.scale(angle) for joint in joints]),
        tool=file.tool,
        length_unit=file.length_unit,
        angle_unit=file.angle_unit,
        collisions=file.collisions == "all",
        clearance=file.clearance,
        allowed=tuple(frozenset(pair) for pair in file.allowed),
        left_out=tuple(file.left_out),
        source=source,
    )
    rows: list[BodyRow | ObstacleRow] = [*file.body, *file.obstacle]
    frames = [*(row.frame for row in file.body), *(robot.base for _ in file.obstacle)]
    bodies = []
    for row, frame, name in zip(rows, frames, default_names(frames), strict=True):
        shape = row_shape(row, _flat_coordinate(robot, frame))
        bodies.append(Body(name if row.name is UNSET else row.name, frame, shape))
    count = len(file.body)
    whole = replace(robot, bodies=tuple(bodies[:count]), obstacles=tuple(bodies[count:]))
    if "plane" in vars(robot):  # all joints share it, so it is computed once
        vars(whole)["plane"] = robot.plane
    return whole


def _flat_coordinate(robot: Robot, frame: str) -> int:
    """Return the coordinate that two numbers leave out: the one across the plane, else y."""
    try:
        along = robot.plane.flat_coordinate(frame)
    except ValueError:
        along = None
    return 1 if along is None else along


def robot_table(robot: Robot) -> Table:
    """Return the content of a robot's file, the inverse of `parse_robot`; defaults are left out."""
    angle = ANGLE[robot.angle_unit]
    home = zip(robot.joints, robot.home, strict=True)
    file = {
        "schema": 1,
        "name": robot.name,
        "length_unit": robot.length_unit,
        "angle_unit": robot.angle_unit,
        "home": {joint.name: quotient(value, joint.scale(angle)) for joint, value in home},
        "tool": robot.tool,
        **_collisions(robot),
        "left_out": list(robot.left_out),
        "joint": [joint.row(angle) for joint in robot.joints],
        "point": [point.row() for point in robot.points],
        "boundary": [boundary.row() for boundary in robot.boundaries],
        **_bodies(robot),
    }
    file = {key: value for key, value in file.items() if value != []}
    table: Table = msgspec.to_builtins(file)
    return table


def _collisions(robot: Robot) -> dict[str, object]:
    """Return the keys that say which bodies are kept apart."""
    order = [body.name for body in (*robot.bodies, *robot.obstacles)]
    keys = {
        "collisions": "all" if robot.collisions else None,
        "clearance": robot.clearance,
        "allowed": [sorted(pair, key=order.index) for pair in robot.allowed],
    }
    return {key: value for key, value in keys.items() if value}


def _bodies(robot: Robot) -> dict[str, object]:
    """Return the tables of bodies and obstacles; a default name is left out."""
    bodies = [*robot.bodies, *robot.obstacles]
    rows: list[BodyRow | ObstacleRow] = []
    for body, default in zip(bodies, default_names([b.frame for b in bodies]), strict=True):
        keys: dict[str, Any] = {} if body.name == default else {"name": body.name}
        keys[body.shape.key] = body.shape.value(_flat_coordinate(robot, body.frame))
        link = len(rows) < len(robot.bodies)
        rows.append(BodyRow(frame=body.frame, **keys) if link else ObstacleRow(**keys))
    return {"body": rows[: len(robot.bodies)], "obstacle": rows[len(robot.bodies) :]}
