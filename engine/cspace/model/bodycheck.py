"""Checks of the bodies that are to keep apart: names, shapes, one plane of motion.

`robotcheck` has checked types and keys; this module checks the robot itself. A table [[body]] with
only a frame and a polygon, and without a boundary, is only drawn, so its outline may be any.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from cspace.model.boundaries import BodyPair, Boundary, HalfSpace
from cspace.model.robot import PlaneOfMotion, Robot
from cspace.model.robotcheck import fault
from cspace.model.schema import JsonPath, shown
from cspace.model.shapes import Body
from cspace.tolerances import ZERO_AMPLITUDE

Table = Mapping[str, Any]

DRAWN = {"frame", "polygon"}
"""Keys of a body as files had it before bodies could keep apart."""


def check_bodies(robot: Robot, table: Table) -> None:
    """Refuse a robot whose bodies do not fulfil what its file asks of them.

    Raises
    ------
    cspace.model.robotcheck.RobotFileError
        The message has the first fault, its place in the table, and what is allowed there.
    """
    _check_names(robot, table)
    part = taking_part(robot)
    for path, body in _placed(robot):
        row = table[path[0]][path[1]]
        told = body.shape.fault if body.name in part or set(row) != DRAWN else None
        if told:
            raise fault(table, (*path, body.shape.key), f"no {body.shape.key}: {told}")
    if part:
        _check_plane(robot, table, part)


def taking_part(robot: Robot) -> dict[str, Boundary]:
    """Return the names of the bodies that boundaries are about, each with its first boundary."""
    found: dict[str, Boundary] = {}
    for boundary in (*robot.boundaries, *robot.used):
        names: Sequence[str] = ()
        if isinstance(boundary, BodyPair):
            names = boundary.bodies
        elif isinstance(boundary, HalfSpace) and boundary.body is not None:
            names = (boundary.body,)
        for name in names:
            found.setdefault(name, boundary)
    return found


def _placed(robot: Robot) -> Iterator[tuple[tuple[str, int], Body]]:
    """Yield every body with its place in a file."""
    for kind, bodies in (("body", robot.bodies), ("obstacle", robot.obstacles)):
        for i, body in enumerate(bodies):
            yield (kind, i), body


def _check_names(robot: Robot, table: Table) -> None:
    """Refuse a pair made by `collisions` whose name something else has already."""
    places: dict[str, JsonPath] = {b.name: ("boundary", i) for i, b in enumerate(robot.boundaries)}
    for boundary in robot.used[sum(b.used for b in robot.boundaries) :]:
        if (path := places.get(boundary.name)) is not None:
            text = f'{shown(boundary.name)} is what collisions = "all" calls a pair of bodies'
            raise fault(table, path, f"{text}; names are unique")
        places[boundary.name] = ("collisions",)


def _check_plane(robot: Robot, table: Table, part: Mapping[str, Boundary]) -> None:
    """Refuse bodies and walls that leave the plane of motion."""
    boundary = next(iter(part.values()))
    try:
        plane = robot.plane
    except ValueError as error:
        where = place_of(robot, boundary)
        raise fault(table, where, f"bodies keep apart in one plane only; {error}") from None
    places = {body.name: path for path, body in _placed(robot)}
    for body, text in off_plane(plane, [robot.body(name) for name in part], robot.length_unit):
        raise fault(table, (*places[body.name], body.shape.key), text)
    for i, wall in enumerate(robot.boundaries):
        if isinstance(wall, HalfSpace) and wall.body and is_oblique(wall, plane):
            normal = shown(table["boundary"][i]["normal"])
            text = f"{normal} leaves the plane in which the arm moves"
            raise fault(table, ("boundary", i, "normal"), text)


def off_plane(
    plane: PlaneOfMotion, bodies: Sequence[Body], unit: str
) -> Iterator[tuple[Body, str]]:
    """Yield each body that lies off the plane of the first one, and say how far."""
    height = plane.height(bodies[0].frame, bodies[0].shape.places)[0]
    rounding = ZERO_AMPLITUDE * _size(plane, bodies)
    cure = "bodies share one plane: change the third number, or the frame's origin"
    if plane.chosen:
        two = "two numbers, or " if np.abs(plane.normal).max() > 1 - ZERO_AMPLITUDE else ""
        cure = "all joints slide along one line, and of the planes that hold it"
        cure += f" {plane.name} was taken: give places {two}three in one plane parallel to it"
    for body in bodies:
        off = np.abs(plane.height(body.frame, body.shape.places) - height)
        if off.max() > rounding:
            place = shown(body.shape.places[np.argmax(off)].tolist())
            far = f"{place} lies {off.max():.6g} {unit} off the plane of body"
            yield body, f"{far} {shown(bodies[0].name)}; {cure}"


def is_oblique(wall: HalfSpace, plane: PlaneOfMotion) -> bool:
    """Tell whether a wall is not at right angles to the plane."""
    return bool(abs(wall.normal @ plane.normal) > ZERO_AMPLITUDE)


def place_of(robot: Robot, boundary: Boundary) -> JsonPath:
    """Return where a file asks for a boundary: in a row of its own, or by `collisions`."""
    if boundary in robot.boundaries:
        return "boundary", robot.boundaries.index(boundary)
    return ("collisions",)


def _size(plane: PlaneOfMotion, bodies: Sequence[Body]) -> float:
    """Return the largest length in a height, for the size of its rounding."""
    base = plane.frames.base
    lengths = [np.abs(plane.frames.position(base, name, base)).max() for name in plane.frames.names]
    return float(max(lengths + [np.abs(body.shape.places).max() for body in bodies]))
