"""Checks of a robot file's table: types and keys by classes, meaning by hand.

Meaning includes all rules that types cannot express: unique names, one chain, references.
"""

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Annotated, Any, Literal, get_args, get_origin, get_type_hints

import msgspec
from msgspec import UNSET, Meta, UnsetType, field

from cspace.model.boundaries import TWO_BODIES, TWO_POINTS, BoundaryRow
from cspace.model.joints import JOINT_TYPES, JointRow
from cspace.model.rows import LARGEST, SMALLEST, Label, Number, Row, Size
from cspace.model.schema import JsonPath, explained, leaves, one_line, place, shown
from cspace.model.shapes import SHAPES, BodyRow, ObstacleRow, PointRow, default_names
from cspace.printable import printable

Table = Mapping[str, Any]

ANGLE = {"deg": math.radians(1.0), "rad": 1.0}
"""Radians in a file's unit of angle."""

TURN = {"deg": 360.0, "rad": math.tau}

LengthUnit = Literal["m", "cm", "mm"]
AngleUnit = Literal["deg", "rad"]

MOST_BODIES = 1000
"""Bodies, and obstacles, of a file at most: `collisions` pairs each with each."""


class RobotFileError(ValueError):
    """Error of a robot file: names the file, the key, what was found, what is allowed.

    Examples
    --------
    >>> from cspace import RobotFileError, load_robot
    >>> try:
    ...     load_robot("no such file.toml")
    ... except RobotFileError as error:
    ...     print(str(error).partition(";")[0])
    no such file.toml: No such file or directory
    """

    def __init__(self, text: str) -> None:
        """Make the message printable, because names of files and keys come from outside."""
        super().__init__(printable(text))


class RobotFile(Row, kw_only=True):
    """A robot file, schema 1."""

    schema: Literal[1]
    name: Label
    length_unit: LengthUnit
    angle_unit: AngleUnit
    home: Annotated[
        dict[str, Number], Meta(min_length=1, description="a table with a number for each joint")
    ]
    tool: Label
    joint: Annotated[
        list[JointRow], Meta(min_length=1, description="a list of one or more tables [[joint]]")
    ]
    point: Annotated[
        list[PointRow], Meta(min_length=1, description="a list of one or more tables [[point]]")
    ]
    boundary: Annotated[list[BoundaryRow], Meta(description="a list of tables [[boundary]]")] = (
        field(default_factory=list)
    )
    body: Annotated[
        list[BodyRow],
        Meta(max_length=MOST_BODIES, description="a list of at most 1000 tables [[body]]"),
    ] = field(default_factory=list)
    collisions: Literal["all"] | UnsetType = UNSET
    clearance: Size = 0.0
    allowed: Annotated[
        list[Annotated[list[Label], Meta(min_length=2, max_length=2, description=TWO_BODIES)]],
        Meta(description="a list of pairs of names of bodies"),
    ] = field(default_factory=list)
    left_out: Annotated[
        list[Label], Meta(description="a list of names of links that the file does not describe")
    ] = field(default_factory=list)
    obstacle: Annotated[
        list[ObstacleRow],
        Meta(max_length=MOST_BODIES, description="a list of at most 1000 tables [[obstacle]]"),
    ] = field(default_factory=list)


def read_table(table: Table) -> RobotFile:
    """Check the content of a robot file and return it as a `RobotFile`.

    Raises
    ------
    RobotFileError
        The message has the first fault, its place, and what is allowed there.
    """
    try:
        file = msgspec.convert(table, RobotFile)
    except ValueError as error:  # also an integer of more digits than Python prints
        _check_finite(table)
        raise fault(table, *explained(str(error), table, json_schema())) from None
    for check in (
        _check_small,
        _check_names,
        _check_own_keys,
        _check_chain,
        _check_references,
        _check_pairs,
        _check_shapes,
        _check_home,
        _check_directions,
        _check_limits,
    ):
        check(table)
    return file


@cache
def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a robot file; ``schemas/robot.schema.json`` is this."""
    (_,), rows = msgspec.json.schema_components([RobotFile], ref_template="#/$defs/{name}")
    for row in (row for row in rows.values() if "type" in row["properties"]):
        keys = {"name": ...} | row["properties"]  # first, also where the type selects the table
        row["properties"] = {key: row["properties"][key] for key in keys}
        row["required"] = [key for key in keys if key in row["required"]]
    for name, table in (("RobotFile", RobotFile), ("JointRow", JointRow)):
        for key, hint in get_type_hints(table).items():
            if get_origin(hint) is Literal:  # in the order of the class, not of the alphabet
                rows[name]["properties"][key]["enum"] = [*get_args(hint)]
    draft = "https://json-schema.org/draft/2020-12/schema"
    top = rows.pop("RobotFile") | {"title": "qbound robot file, schema 1"}
    return {"$schema": draft, **top, "$defs": rows}


def fault(table: Table, path: JsonPath, text: str) -> RobotFileError:
    """Return the error of a fault at a place of a table."""
    where = place(table, path)
    return RobotFileError(f"{where}: {text}" if where else text)


def _check_finite(table: Table) -> None:
    for path, value in leaves(table):
        if isinstance(value, int | float) and not abs(value) <= sys.float_info.max:
            raise fault(table, path, f"{shown(value)} is not a finite number")
        size = abs(value) if isinstance(value, int | float) else 0
        if size > LARGEST and not {"axis", "normal"} & set(path):  # only their direction counts
            raise fault(table, path, f"{shown(value)} is too large; wanted: at most {LARGEST:g}")


def _check_small(table: Table) -> None:
    """Refuse a number of a shape, but 0, whose square no double holds."""
    for path, value in leaves(table):
        small = isinstance(value, float) and 0 < abs(value) < SMALLEST
        if small and path[0] in {"body", "obstacle", "clearance"}:
            text = f"{shown(value)} is too small; wanted: 0, or at least {SMALLEST:g}"
            raise fault(table, path, text)


def _check_names(table: Table) -> None:
    """Refuse a name that is already used in its list, by a frame or by a joint limit."""
    first: dict[tuple[str, str], int] = {}
    for kind, i, row in _rows(table, "joint", "point", "boundary"):
        if (j := first.setdefault((kind, row["name"]), i)) != i:
            text = f"{shown(row['name'])} is used twice, first by {kind}[{j}]; names are unique"
            raise fault(table, (kind, i, "name"), text)
    named: dict[str, str] = {}
    for kind, i, _, name in _bodies(table):
        if (other := named.setdefault(name, f"{kind}[{i}]")) != f"{kind}[{i}]":
            path = (kind, i, "name") if "name" in table[kind][i] else (kind, i)
            text = f"{shown(name)} is used twice, first by {other}; names of bodies are unique"
            raise fault(table, path, text)
    limits = [f"{j['name']}.{side}" for j in table["joint"] for side in ("lower", "upper")]
    _check_free(table, "point", "frame", _frames(table))
    _check_free(table, "boundary", "joint limit", limits)


def _check_free(table: Table, kind: str, other: str, taken: Sequence[str]) -> None:
    for _, i, row in _rows(table, kind):
        if row["name"] in taken:
            name = shown(row["name"])
            text = f"{name} is the name of a {other}; a {kind} needs a name of its own"
            raise fault(table, (kind, i, "name"), text)


def _check_chain(table: Table) -> None:
    """Refuse joints that do not form one chain from the base outwards, each frame moved once."""
    frame = table["joint"][0]["parent"]
    seen = {frame}
    for i, joint in enumerate(table["joint"]):
        if joint["parent"] != frame:
            found, wanted = shown(joint["parent"]), shown(frame)
            text = f"{found} found, {wanted} wanted; joints form one chain from the base"
            raise fault(table, ("joint", i, "parent"), text)
        frame = joint["frame"]
        for key in ("bar", "frame"):
            if joint.get(key) in seen:
                text = f"{shown(joint[key])} closes a cycle; every joint moves a frame of its own"
                raise fault(table, ("joint", i, key), text)
            seen |= {joint[key]} if key in joint else set()


def _check_own_keys(table: Table) -> None:
    """Refuse a joint that lacks a key of its type, or has a key of another type."""
    owners = {key: kind for kind, cls in JOINT_TYPES.items() for key in cls.own_keys}
    for _, i, joint in _rows(table, "joint"):
        for key, owner in owners.items():
            wanted = key in JOINT_TYPES[joint["type"]].own_keys
            if wanted and key not in joint:
                raise fault(table, ("joint", i), f"{key} is missing; a {joint['type']} needs one")
            if key in joint and not wanted:
                text = f"only a {owner} has one; this joint is {joint['type']}"
                raise fault(table, ("joint", i, key), text)


def _check_references(table: Table) -> None:
    """Refuse an unknown name under a key that names a frame or points."""
    for kind, i, _ in _rows(table, "point", "body"):
        _check_known(table, (kind, i, "frame"), "frame", _frames(table))
    points, bodies = [p["name"] for p in table["point"]], [name for *_, name in _bodies(table)]
    _check_known(table, ("tool",), "point", points)
    for kind, i, row in _rows(table, "boundary"):
        for one, two, known in (("point", "points", points), ("body", "bodies", bodies)):
            places = [(one,)] * (one in row) + [(two, k) for k in range(len(row.get(two, ())))]
            for path in places:
                _check_known(table, (kind, i, *path), one, known)
    for i in range(len(table.get("allowed", ()))):
        for k in range(2):
            _check_known(table, ("allowed", i, k), "body", bodies)


def _check_pairs(table: Table) -> None:
    """Refuse a pair of one thing with itself, and bodies that cannot move against each other."""
    for path, names, wanted in _pairs(table):
        if len(set(names)) < len(names):
            text = f"{shown(names)} names one thing twice; wanted: {wanted}"
            raise fault(table, path, text)
    placed = {name: (frame, kind) for kind, _, frame, name in _bodies(table)}
    for _, i, row in _rows(table, "boundary"):
        if "bodies" not in row:
            continue
        (frame, kind), (other, its) = (placed[name] for name in row["bodies"])
        if frame == other:
            both = "obstacles" if kind == its == "obstacle" else f"fixed in frame {shown(frame)}"
            text = f"{shown(row['bodies'])} are {both}; wanted: two bodies on different frames"
            raise fault(table, ("boundary", i, "bodies"), text)


def _pairs(table: Table) -> Iterator[tuple[JsonPath, Sequence[str], str]]:
    """Yield every pair of names, with its place and what is wanted there."""
    for key, wanted in (("points", TWO_POINTS), ("bodies", TWO_BODIES)):
        for _, i, row in _rows(table, "boundary"):
            if key in row:
                yield ("boundary", i, key), row[key], wanted
    for i, pair in enumerate(table.get("allowed", ())):
        yield ("allowed", i), pair, TWO_BODIES


def _check_shapes(table: Table) -> None:
    """Refuse a body that has not exactly one shape."""
    for kind, i, row in _rows(table, "body", "obstacle", "boundary"):
        wanted = ("point", "body") if kind == "boundary" else SHAPES
        keys = [key for key in wanted if key in row]
        if len(keys) != 1 and row.get("type", "half-space") == "half-space":
            found = " and ".join(keys) or "none"
            text = f"{found} found; wanted: exactly one of {', '.join(wanted)}"
            raise fault(table, (kind, i), text)


def _check_known(table: Table, path: JsonPath, what: str, names: Sequence[str]) -> None:
    name: Any = table
    for step in path:
        name = name[step]
    if name not in names:
        raise fault(table, path, f"no {what} {shown(name)}; there are {_listed(names)}")


def _check_home(table: Table) -> None:
    """Refuse a home that has not one value for each joint."""
    joints = [j["name"] for j in table["joint"]]
    for name in table["home"]:
        if name not in joints:
            text = f"no joint {shown(name)}; there are {_listed(joints)}"
            raise fault(table, ("home", name), text)
    for name in joints:
        if name not in table["home"]:
            raise fault(table, ("home",), f"{shown(name)} is missing; every joint needs a value")


def _check_directions(table: Table) -> None:
    for kind, i, row in _rows(table, "joint", "boundary"):
        key = "axis" if kind == "joint" else "normal"
        vector = row.get(key, (1.0,))
        if not all(map(math.isfinite, vector)):
            _check_finite(table)
        if not any(vector):
            text = f"{shown(vector)} has no direction; one number must not be 0"
            raise fault(table, (kind, i, key), text)


def _check_limits(table: Table) -> None:
    for _, i, row in _rows(table, "joint"):
        joint_type, turn = JOINT_TYPES[row["type"]], TURN[table["angle_unit"]]
        if text := joint_type.limits_fault(row.get("limits"), turn):
            raise fault(table, ("joint", i, "limits"), text)


def _listed(names: Sequence[str]) -> str:
    return ", ".join(map(one_line, names))


def _frames(table: Table) -> list[str]:
    moved = [joint[key] for joint in table["joint"] for key in ("bar", "frame") if key in joint]
    return [table["joint"][0]["parent"], *moved]


def _bodies(table: Table) -> list[tuple[str, int, str, str]]:
    """Return every body and obstacle: its list, its place there, its frame, its name."""
    rows = list(_rows(table, "body", "obstacle"))
    frames = [row.get("frame", table["joint"][0]["parent"]) for *_, row in rows]
    names = zip(rows, frames, default_names(frames), strict=True)
    return [(kind, i, frame, row.get("name", name)) for (kind, i, row), frame, name in names]


def _rows(table: Table, *kinds: str) -> Iterator[tuple[str, int, Table]]:
    """Yield every table of some lists, with its list's name and its place there."""
    return ((kind, i, row) for kind in kinds for i, row in enumerate(table.get(kind, [])))
